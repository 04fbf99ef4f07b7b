//! Quantities, formulas, keys and lists.

use std::time::{Duration, Instant};

use impactite_input::Source;
use impactite_input::formula::{Coordinates, Formula};
use impactite_input::list::Topic;
use impactite_input::quantity::{Parameters, Speed};
use serde::Deserialize;
use serde::de::value::{Error, StrDeserializer};

fn length(text: &str) -> Result<f64, String> {
    Parameters::default().quantity(text, "m")
}

/// The bits of a literal in a program: decimal units are exact until the last step.
#[test]
fn units_are_exact() {
    assert_eq!(length("7.6 mm"), Ok(7.6e-3));
    assert_eq!(length("3.8mm"), Ok(3.8e-3));
    assert_eq!(length("25.4 mm"), Ok(25.4e-3));
    for inches in ["1 inch", "1 in", "1in", "(0.5 + 0.5) in"] {
        assert_eq!(length(inches), Ok(0.0254), "{inches}");
    }
    let p = Parameters::default();
    assert_eq!(p.quantity("80 us", "s"), Ok(80e-6));
    assert_eq!(p.quantity("2 min", "s"), Ok(120.0));
    assert_eq!(p.quantity("100 in/s^2", "m/s^2"), Ok(2.54));
    assert_eq!(p.quantity("sin(30 deg)", ""), Ok(0.5));
    assert_eq!(p.quantity("80 µs", "s"), Ok(80e-6));
    assert_eq!(p.quantity("-190 m/s", "m/s"), Ok(-190.0));
    assert_eq!(p.quantity("8.96 g/cm^3", "kg/m^3"), Ok(8960.0));
    assert_eq!(p.quantity("48 MPa", "Pa"), Ok(48e6));
    assert_eq!(p.quantity("383 J/(kg K)", "J/(kg K)"), Ok(383.0));
    assert_eq!(p.quantity("1/4", ""), Ok(0.25));
    assert!((p.quantity("30 deg", "rad").unwrap_or(0.0) - std::f64::consts::FRAC_PI_6).abs() < 2e-16);
    assert!((p.quantity("60 rpm", "rad/s").unwrap_or(0.0) - std::f64::consts::TAU).abs() < 1e-14);
}

#[test]
fn another_measure_is_refused_with_both() {
    let why = length("190 m/s").unwrap_err();
    assert!(why.contains("meter / second") && why.contains("meter"), "{why}");
    let why = length("7.6").unwrap_err();
    assert!(why.contains("unitless"), "{why}");
    assert!(Parameters::default().quantity("3 m", "").is_err());
}

#[test]
fn what_never_ends_is_refused_in_time() {
    let start = Instant::now();
    for text in ["10^10^10 m", "(1e9)! m", "1e999999999 m", "0/0 m", "1/0 m", "", "m m m (", "sin m"] {
        assert!(length(text).is_err(), "{text}");
    }
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
}

#[test]
fn parameters_go_into_quantities_in_order() {
    let mut p = Parameters::default();
    p.define("radius", "3.8 mm").unwrap();
    p.define("cells", "10").unwrap();
    p.define("spacing", "radius / cells").unwrap();
    assert_eq!(p.quantity("spacing", "m"), Ok(0.38e-3));
    assert_eq!(p.numbers()["spacing"], 0.38e-3);
    // Units that nobody means; those that everybody means keep their names.
    for (name, value) in
        [("section", "2 cm^2"), ("half", "3 cm^2"), ("span", "4 cm^2"), ("rod", "5 cm^2"), ("link", "6 cm^2")]
    {
        p.define(name, value).unwrap_or_else(|why| panic!("{name}: {why}"));
        let number = p.quantity(value, "m^2");
        assert_eq!(p.quantity(name, "m^2"), number, "{name}");
        assert_eq!(p.quantity(&format!("2 * {name} / 2"), "m^2"), number, "{name}");
    }
    for name in ["mm", "MPa", "deg", "in", "inch", "sqrt", "m", "h", "x", "pi", "e"] {
        assert!(p.define(name, "1").is_err(), "{name}");
    }
    assert_eq!(p.quantity("2 * cells", ""), Ok(20.0));
    for (name, value) in
        [("m", "3"), ("x", "3"), ("2x", "3"), ("a-b", "3"), ("fine", "nonsense nobody knows")]
    {
        assert!(p.define(name, value).is_err(), "{name} = {value}");
    }
}

fn formula(text: &str) -> Result<Formula<Speed>, String> {
    let text = format!("= {text}");
    Formula::deserialize(StrDeserializer::<Error>::new(&text)).map_err(|e| e.to_string())
}

#[test]
fn formulas_see_place_time_and_parameters() {
    let mut p = Parameters::default();
    p.define("length", "25.4 mm").unwrap();
    let f = p.during(|| formula("-190 * (1 - z / length) + 0*t")).unwrap();
    assert_eq!(f.at(&[0.0, 0.0, 0.0127], false, 0.0), -95.0);
    assert_eq!(f.at(&[0.0, 0.0127], true, 0.0), -95.0);
    assert!(f.check(Coordinates::Space, true, true).is_ok());
    assert!(f.check(Coordinates::Plane, true, true).unwrap_err().contains("`z`"));
    assert!(f.check(Coordinates::Space, true, false).unwrap_err().contains("`t`"));
    assert!(f.check(Coordinates::Space, false, true).unwrap_err().contains("`z`"));
    let value = |text: &str| formula(text).map(|f| f.at(&[2.0, 3.0], false, 0.5));
    assert_eq!(value("3.2e6 * min(t / 2.5e-1, 1)"), Ok(3.2e6));
    assert_eq!(value("1E-3*x + .5 + 2.*y"), Ok(6.502));
    let why = formula("3 * speed").unwrap_err();
    assert!(why.contains("`speed`"), "{why}");
    assert!(formula("3 *").is_err());
    assert!(formula("").is_err());
}

#[test]
fn keys_are_set_in_tables_lists_and_where_there_were_none() {
    let source = Source::new("t", "a = 1\n[b]\nc = [1, 2]\n[[d]]\ne = 1\n");
    let set = |s: &str| source.set(s).map(|s| s.text);
    assert!(set("a=2").unwrap().contains("a = 2"));
    assert!(set("b.c[1]=\"3 m\"").unwrap().contains("c = [1, \"3 m\"]"));
    assert!(set("b.c[1]=3 m").unwrap().contains("\"3 m\""));
    assert!(set("d[0].e=5").unwrap().contains("e = 5"));
    let made = set("new.deep.key=600").unwrap();
    assert_eq!(made.parse::<toml_edit::DocumentMut>().unwrap()["new"]["deep"]["key"].as_integer(), Some(600));
    for (bad, why) in [
        ("a", "KEY=VALUE"),
        ("=3", "empty"),
        ("a.b=3", "no table"),
        ("b.c[7]=1", "list of 2"),
        ("a[0]=1", "no list"),
    ] {
        let said = source.set(bad).unwrap_err().to_string();
        assert!(said.contains(why), "{bad}: {said}");
    }
}

#[test]
fn every_list_has_lines_with_words() {
    for (topic, word) in Topic::ALL {
        let lines = topic.lines();
        assert!(lines.len() >= 3, "{word}: {lines:?}");
        assert!(lines.iter().all(|l| !l.what.is_empty()), "{word}: {lines:?}");
    }
    let friction = Topic::Conditions.lines().into_iter().find(|l| l.name == "wall").unwrap();
    assert_eq!(friction.fields, ["axis", "at", "side?", "velocity?", "friction?"]);
}

/// Parameters are written with those before them, and bodies are added as they stand there.
#[test]
fn keys_of_json_keep_their_order() {
    let json =
        r#"{"parameters": {"width": "2 m", "spacing": "width / 2"}, "bodies": {"second": {}, "first": {}}}"#;
    let text = Source::from_json("t", json).unwrap().text;
    let place = |word: &str| text.find(word).unwrap();
    assert!(place("width") < place("spacing") && place("second") < place("first"), "{text}");
}
