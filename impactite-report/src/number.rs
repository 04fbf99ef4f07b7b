//! Format of numbers in files and on the page.
//!
//! JSON has no infinities and no NaN: they are stored as the texts `"inf"`, `"-inf"` and `"NaN"`, so that a record of a diverged run is
//! read back unchanged. `null`, which other programs write for all three, is read as NaN.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Representation of a number in JSON.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Json {
    Number(f64),
    Text(String),
    Nothing(()),
}

impl From<f64> for Json {
    fn from(x: f64) -> Self {
        if x.is_finite() { Json::Number(x) } else { Json::Text(x.to_string()) }
    }
}

impl Json {
    fn read<E: serde::de::Error>(self) -> Result<f64, E> {
        match self {
            Json::Number(x) => Ok(x),
            Json::Nothing(()) => Ok(f64::NAN),
            Json::Text(text) => {
                let x = text.parse::<f64>().ok().filter(|x| !x.is_finite());
                x.ok_or_else(|| E::custom(format!("{text:?} is no number")))
            }
        }
    }
}

/// `#[serde(with = "real")]`: a number.
pub(crate) mod real {
    use super::{Deserialize, Deserializer, Json, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer>(x: &f64, to: S) -> Result<S::Ok, S::Error> {
        Json::from(*x).serialize(to)
    }
    pub(crate) fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<f64, D::Error> {
        Json::deserialize(from)?.read()
    }
}

/// `#[serde(with = "reals")]`: a list of numbers.
pub(crate) mod reals {
    use super::{Deserialize, Deserializer, Json, Serializer};

    pub(crate) fn serialize<S: Serializer>(list: &[f64], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(list.iter().map(|x| Json::from(*x)))
    }
    pub(crate) fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<Vec<f64>, D::Error> {
        Vec::<Json>::deserialize(from)?.into_iter().map(Json::read).collect()
    }
}

/// `#[serde(with = "maybe")]`: a number, or `null` for `None`.
pub(crate) mod maybe {
    use super::{Deserialize, Deserializer, Json, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer>(x: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
        x.map(Json::from).serialize(to)
    }
    pub(crate) fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<Option<f64>, D::Error> {
        Option::<Json>::deserialize(from)?.map(Json::read).transpose()
    }
}

/// Format a fraction as per cent with its sign: `-1.23 %`. Used for every energy error; negative: energy was lost.
///
/// ```
/// use impactite_report::percent;
/// assert_eq!(percent(-0.01234), "-1.23 %");
/// assert_eq!(percent(2.0e-9), "+2.0e-7 %");
/// ```
#[must_use]
pub fn percent(share: f64) -> String {
    let x = 100.0 * share;
    match x.abs() {
        0.0 => "0 %".into(),
        a if (0.01..1e4).contains(&a) => format!("{x:+.2} %"),
        _ => format!("{x:+.1e} %"),
    }
}

/// Format the largest energy error of a run, for pages and terminals: [`percent`], or a note that nothing moves.
///
/// ```
/// use impactite_report::energy_error;
/// assert_eq!(energy_error(Some(0.01)), "+1.00 %");
/// assert_eq!(energy_error(None), "none: nothing moves, or the method has no balance");
/// ```
#[must_use]
pub fn energy_error(error: Option<f64>) -> String {
    error.map_or_else(|| "none: nothing moves, or the method has no balance".into(), percent)
}

/// Format the numbers of checks passed and judged, in words.
///
/// ```
/// use impactite_report::checks_passed;
/// assert_eq!(checks_passed([1, 3]), "1 of 3 checks passed");
/// assert_eq!(checks_passed([0, 0]), "no checks");
/// ```
#[must_use]
pub fn checks_passed([passed, judged]: [usize; 2]) -> String {
    match judged {
        0 => "no checks".into(),
        1 => format!("{passed} of 1 check passed"),
        _ => format!("{passed} of {judged} checks passed"),
    }
}

/// True for a relative energy error, which is shown by [`percent`].
pub(crate) fn is_energy_error(name: &str, unit: &str) -> bool {
    (name.contains("energy error") || name.contains("energy_error")) && unit == "-"
}

/// Format a number with `digits` significant digits, without trailing zeros.
pub(crate) fn significant(x: f64, digits: usize) -> String {
    let size = x.abs();
    if x == 0.0 {
        return "0".into();
    }
    if !x.is_finite() {
        return x.to_string();
    }
    // Exponent after rounding: 9.996 to three digits is 10.0.
    let scientific = format!("{x:.*e}", digits.saturating_sub(1));
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    let power: i32 = exponent.parse().unwrap_or(0);
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text.to_string(),
    };
    if size >= 1e-3 && power < 6 {
        let decimals = (digits as i32 - 1 - power).max(0) as usize;
        trimmed(&format!("{x:.decimals$}"))
    } else {
        format!("{}e{power}", trimmed(mantissa))
    }
}

/// Units that accept prefixes, so that 8e-5 s is shown as 80 µs.
const PREFIXED: [&str; 6] = ["s", "m", "J", "N", "Pa", "W"];
const PREFIXES: [(f64, &str); 9] = [
    (1e12, "T"),
    (1e9, "G"),
    (1e6, "M"),
    (1e3, "k"),
    (1.0, ""),
    (1e-3, "m"),
    (1e-6, "µ"),
    (1e-9, "n"),
    (1e-12, "p"),
];

/// Choose the unit with a prefix for numbers up to `largest` in `unit`, and its number per `unit`.
pub(crate) fn readable(largest: f64, unit: &str) -> (String, f64) {
    let size = largest.abs();
    // The first word is the base unit of quantities per radian or metre of depth.
    let (first, rest) = unit.split_at(unit.find([' ', '/']).unwrap_or(unit.len()));
    // No prefix for units per second or per metre of seconds or metres, such as mm/s.
    if rest.starts_with('/') && ["s", "m"].contains(&first) {
        return (unit.into(), 1.0);
    }
    if !(PREFIXED.contains(&first) && size > 0.0 && size.is_finite()) {
        return (unit.into(), 1.0);
    }
    // Seconds and metres have no prefix above one.
    let most = if ["s", "m"].contains(&first) { 1.0 } else { f64::INFINITY };
    let fits = |&&(one, _): &&(f64, &str)| size >= one * 0.999_999 && one <= most;
    let (one, prefix) = PREFIXES.iter().find(fits).unwrap_or(&(1e-12, "p"));
    (format!("{prefix}{first}{rest}"), 1.0 / one)
}

/// Format a number with its unit and prefix, to `digits` digits: `80 µs`.
pub(crate) fn quantity(x: f64, unit: &str, digits: usize) -> String {
    let (unit, factor) = readable(x, unit);
    let number = significant(x * factor, digits);
    if unit.is_empty() || unit == "-" { number } else { format!("{number} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize, Deserialize)]
    struct Held {
        #[serde(with = "real")]
        one: f64,
        #[serde(with = "reals")]
        all: Vec<f64>,
    }

    #[test]
    fn every_number_comes_back_from_json_by_its_bits() {
        let all = vec![0.1, -0.0, 1.0 / 3.0, f64::MIN_POSITIVE, f64::MAX, f64::INFINITY, f64::NEG_INFINITY];
        let text = serde_json::to_string(&Held { one: f64::NAN, all: all.clone() }).expect("JSON");
        let back: Held = serde_json::from_str(&text).expect("the same");
        assert!(back.one.is_nan());
        let bits = |list: &[f64]| list.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back.all), bits(&all));
        assert!(serde_json::from_str::<Held>(r#"{"one": null, "all": []}"#).expect("null").one.is_nan());
        assert!(serde_json::from_str::<Held>(r#"{"one": "12", "all": []}"#).is_err());
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(significant(0.031_264, 4), "0.03126");
        assert_eq!(significant(123_456.0, 4), "123456");
        assert_eq!(significant(9.9996, 4), "10");
        assert_eq!(significant(-2.5e-13, 4), "-2.5e-13");
        assert_eq!(significant(1e7, 4), "1e7");
        assert_eq!(quantity(8.0e-5, "s", 4), "80 µs");
        assert_eq!(quantity(3600.0, "s", 4), "3600 s");
        assert_eq!(quantity(-2.5e9, "Pa", 4), "-2.5 GPa");
        assert_eq!(quantity(1200.0, "J per radian", 4), "1.2 kJ per radian");
        assert_eq!(quantity(8.9, "-", 4), "8.9");
        assert_eq!(quantity(0.0, "J", 4), "0 J");
        assert_eq!(quantity(2500.0, "m", 4), "2500 m");
        assert_eq!(quantity(2500.0, "J/rad", 4), "2.5 kJ/rad");
        assert_eq!(quantity(0.0025, "m/s", 4), "0.0025 m/s");
        assert_eq!(percent(f64::NAN), "NaN %");
    }
}
