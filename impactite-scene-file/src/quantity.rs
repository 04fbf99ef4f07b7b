//! Quantities: numbers with units, parameters and arithmetic.

use std::cell::RefCell;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use fend_core::{Context, Interrupt};
use indexmap::IndexMap;
use serde::de::{Deserialize, Deserializer, Error, Visitor};

use crate::table::Table;

/// Physical dimension of a quantity.
pub trait Measure: Copy + Default + 'static {
    /// Name of the dimension.
    const NAME: &'static str;
    /// SI unit as written in files; empty for plain numbers.
    const UNIT: &'static str;
}

macro_rules! measures {
    ($($(#[$doc:meta])* $name:ident: $words:literal, $unit:literal;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $name;
        impl Measure for $name {
            const NAME: &'static str = $words;
            const UNIT: &'static str = $unit;
        }
    )*
        /// All dimensions: name and SI unit.
        pub const MEASURES: &[(&str, &str)] = &[$(($words, $unit)),*];
    };
}

measures! {
    /// Plain number.
    Plain: "number", "";
    /// Length, m.
    Length: "length", "m";
    /// Area, m^2.
    Area: "area", "m^2";
    /// Time, s.
    Time: "time", "s";
    /// Speed, m/s.
    Speed: "speed", "m/s";
    /// Acceleration, m/s^2.
    Acceleration: "acceleration", "m/s^2";
    /// Angular velocity, rad/s.
    Spin: "angular velocity", "rad/s";
    /// Angle, rad.
    Angle: "angle", "rad";
    /// Mass, kg.
    Mass: "mass", "kg";
    /// Density, kg/m^3.
    Density: "density", "kg/m^3";
    /// Pressure or stress, Pa.
    Pressure: "pressure", "Pa";
    /// Dynamic viscosity, Pa s.
    Viscosity: "viscosity", "Pa s";
    /// Rate, 1/s.
    Rate: "rate", "1/s";
    /// Temperature, K.
    Temperature: "temperature", "K";
    /// Reciprocal pressure, 1/Pa.
    PerPressure: "per pressure", "1/Pa";
    /// Reciprocal temperature, 1/K.
    PerTemperature: "per temperature", "1/K";
    /// Specific heat capacity, J/(kg K).
    HeatCapacity: "heat capacity", "J/(kg K)";
    /// Energy per area, J/m^2.
    SurfaceEnergy: "energy of an area", "J/m^2";
    /// Surface tension, N/m.
    SurfaceTension: "surface tension", "N/m";
    /// Energy per volume, J/m^3.
    EnergyDensity: "energy of a volume", "J/m^3";
    /// Energy, J.
    Energy: "energy", "J";
    /// Force, N.
    Force: "force", "N";
    /// Momentum, kg m/s.
    Momentum: "momentum", "kg m/s";
}

/// Number in SI units. In files it is a number in SI units, or a text with a unit: `"7.6 mm"`, `"190 m/s"`, `"48 MPa"`, or arithmetic with
/// units and the file's parameters: `"2 * radius / 10"`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quantity<U> {
    /// Value in SI units.
    pub value: f64,
    measure: PhantomData<U>,
}

impl<U: Measure> Quantity<U> {
    /// Create a quantity from a value in SI units.
    #[must_use]
    pub fn new(value: f64) -> Self {
        Quantity { value, measure: PhantomData }
    }
}

thread_local! {
    /// Parameters of the file under reading.
    static PARAMETERS: RefCell<Parameters> = RefCell::new(Parameters::default());
}

/// Named values of a file, for use in its quantities.
#[derive(Clone)]
pub struct Parameters {
    /// Values with their units, by name. Clones share them: [`define`](Self::define) copies them if another clone exists, and evaluation of
    /// a quantity changes no name.
    context: Arc<Mutex<Context>>,
    /// Values in SI units, by name.
    numbers: IndexMap<String, f64>,
    /// SI units of `numbers`, in the same order; empty for plain numbers.
    units: Vec<&'static str>,
    /// Tables over time, by name.
    tables: IndexMap<String, Arc<Table>>,
}

impl Default for Parameters {
    fn default() -> Self {
        let context = Arc::new(Mutex::new(context()));
        Parameters { context, numbers: IndexMap::new(), units: Vec::new(), tables: IndexMap::new() }
    }
}

/// Exponential function by the hyperbolic tangent, ((1 + t) / (1 - t))^256 with t = tanh(x / 512), within 1e-13 for |x| up to 700: the
/// library's own takes roots of rational numbers, which fails for most arguments.
const EXP: &str = "exp = x: ((1 + tanh(x / 512)) / (1 - tanh(x / 512)))^256";

/// Create a context without parameters.
fn context() -> Context {
    let mut context = Context::new();
    // On failure the library's own function stays.
    let _ = evaluate(EXP, &mut context);
    context
}

impl std::fmt::Debug for Parameters {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.numbers.fmt(f)
    }
}

impl Parameters {
    /// Define a parameter: its name, and a number or a text with a unit, which may contain earlier parameters.
    ///
    /// # Errors
    /// Invalid name, or name of a unit or of a variable of formulas; invalid quantity.
    pub fn define(&mut self, name: &str, value: &str) -> Result<(), String> {
        named(name)?;
        let mut context = self.unshared();
        evaluate(&format!("{name} = ({})", checked(value)?), &mut context)?;
        let (_, unit, number) = in_any_unit(name, &mut context)?;
        drop(context);
        let (place, _) = self.numbers.insert_full(name.into(), number);
        self.units.resize(self.numbers.len(), unit);
        self.units[place] = unit;
        Ok(())
    }

    /// Define a table, for formulas.
    ///
    /// # Errors
    /// Invalid name, or name with another meaning.
    pub fn define_table(&mut self, name: &str, table: Table) -> Result<(), String> {
        named(name)?;
        if self.numbers.contains_key(name) {
            return Err(format!("`{name}` is a parameter, too; call one of them otherwise"));
        }
        self.tables.insert(name.into(), Arc::new(table));
        Ok(())
    }

    /// Return the tables over time, by name.
    #[must_use]
    pub fn tables(&self) -> &IndexMap<String, Arc<Table>> {
        &self.tables
    }

    /// Evaluate a quantity of any known dimension, in SI units.
    ///
    /// # Errors
    /// Invalid quantity.
    pub fn of_any_measure(&self, text: &str) -> Result<f64, String> {
        let mut context = self.context.lock().unwrap_or_else(PoisonError::into_inner);
        in_any_unit(text, &mut context).map(|(_, _, value)| value)
    }

    /// Return the context, copied first if it is shared.
    fn unshared(&mut self) -> std::sync::MutexGuard<'_, Context> {
        if Arc::get_mut(&mut self.context).is_none() {
            let copy = self.context.lock().unwrap_or_else(PoisonError::into_inner).clone();
            self.context = Arc::new(Mutex::new(copy));
        }
        self.context.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Return the values in SI units, by name.
    #[must_use]
    pub fn numbers(&self) -> &IndexMap<String, f64> {
        &self.numbers
    }

    /// Return the SI unit of a parameter; empty for plain numbers and unknown names.
    #[must_use]
    pub fn unit(&self, name: &str) -> &'static str {
        let place = self.numbers.get_index_of(name);
        place.and_then(|place| self.units.get(place)).copied().unwrap_or_default()
    }

    /// Evaluate a quantity in the SI unit `unit` (empty: a plain number).
    ///
    /// # Errors
    /// Invalid quantity; other dimension.
    pub fn quantity(&self, text: &str, unit: &str) -> Result<f64, String> {
        let mut context = self.context.lock().unwrap_or_else(PoisonError::into_inner);
        convert(text, unit, &mut context)
    }

    /// Return name and SI unit of the dimension of a text.
    ///
    /// # Errors
    /// Text that is no quantity of any known dimension.
    pub fn measure(&self, text: &str) -> Result<(&'static str, &'static str), String> {
        let mut context = self.context.lock().unwrap_or_else(PoisonError::into_inner);
        in_any_unit(text, &mut context).map(|(name, unit, _)| (name, unit))
    }

    /// Call `read` with these parameters: quantities and formulas deserialized on this thread may contain them.
    pub fn during<R>(&self, read: impl FnOnce() -> R) -> R {
        let before = PARAMETERS.replace(self.clone());
        let made = read();
        PARAMETERS.set(before);
        made
    }
}

/// Evaluate a quantity in the SI unit `unit` (empty: a plain number).
fn convert(text: &str, unit: &str, context: &mut Context) -> Result<f64, String> {
    let checked = checked(text)?;
    let asked = if unit.is_empty() { checked } else { format!("({checked}) to ({unit})") };
    let said = evaluate(&format!("({asked}) to 17 sf"), context)?;
    let plain = said.strip_prefix("approx. ").unwrap_or(&said);
    let (number, rest) = plain.split_once(' ').unwrap_or((plain, ""));
    if unit.is_empty() && !rest.is_empty() {
        return Err(format!("`{text}` is {plain}, and a number without a unit is asked for"));
    }
    match number.replace(',', "").parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("`{text}` is too large")),
        Err(_) => Err(format!("`{text}` is {plain}, which is no number")),
    }
}

/// Return name and SI unit of the dimension of a text, and its value in that unit.
fn in_any_unit(text: &str, context: &mut Context) -> Result<(&'static str, &'static str, f64), String> {
    let mut first = None;
    for &(name, unit) in MEASURES {
        match convert(text, unit, context) {
            Ok(value) => return Ok((name, unit, value)),
            Err(why) => first = first.or(Some(why)),
        }
    }
    // The error for a value of unknown dimension is that of a plain number.
    Err(first.unwrap_or_default())
}

/// Maximum length of a quantity or formula, characters.
const LONGEST: usize = 1000;
/// Maximum depth of nested parentheses: the work of the evaluator's parser grows up to fourfold with each.
const GROUPS: usize = 8;
/// Maximum depth of nested signs, powers and functions, for the stack of a thread of 1 MiB.
const DEEPEST: usize = 40;

/// Check that the evaluator needs bounded memory and time for a text; replace `in` by inches.
///
/// # Errors
/// Text that is too long or too deeply nested; assignment; name of the last result.
fn checked(text: &str) -> Result<String, String> {
    bounded(text)?;
    if let Some(sign) = text.chars().find(|c| "=:;@#!\\\n".contains(*c)) {
        return Err(format!("`{}` is not allowed in an expression", sign.escape_debug()));
    }
    // The evaluator skips commas as separators of thousands: `3,8 m` would be 38 m.
    if text.contains(',') {
        return Err(format!("`,` is not allowed in an expression; write `{}`", text.replace(',', ".")));
    }
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    if let Some(word) = words.into_iter().find(|w| ["ans", "_", "log"].contains(w)) {
        return Err(match word {
            "log" => "`log` has two meanings; write `ln` or `log10`".into(),
            _ => format!("`{word}` stands for no value"),
        });
    }
    Ok(inches(text))
}

/// Check length and nesting of a text, so that no parser overflows its stack.
pub(crate) fn bounded(text: &str) -> Result<(), String> {
    let length = text.chars().count();
    if length > LONGEST {
        return Err(format!("has {length} characters; at most {LONGEST} are allowed"));
    }
    // Upper bound of the recursion depth: one level for each open group, sign, power and application. A binary operator closes all levels
    // of its group but its own.
    let (mut groups, mut level, mut depth, mut operand) = (Vec::new(), 0, 0, false);
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            c if c.is_whitespace() => {}
            '+' | '-' | '*' | '/' | ',' if operand => {
                level = groups.last().copied().unwrap_or(0);
                operand = false;
            }
            ')' => {
                level = groups.pop().map_or(0, |base: usize| base.saturating_sub(1));
                operand = true;
            }
            c if c.is_alphanumeric() || c == '_' || c == '.' => {
                level += usize::from(operand);
                while letters.next_if(|&c| c.is_alphanumeric() || c == '_' || c == '.').is_some() {}
                operand = true;
            }
            c => {
                level += 1;
                operand = false;
                if c == '(' {
                    groups.push(level);
                }
            }
        }
        depth = depth.max(level);
        if groups.len() > GROUPS {
            return Err(format!("has more than {GROUPS} levels of parentheses, which are allowed"));
        }
    }
    if depth > DEEPEST {
        return Err(format!("has {depth} nested signs, powers and functions; at most {DEEPEST} are allowed"));
    }
    Ok(())
}

/// Replace `in` by inches: the library parses `in` as a conversion, which quantities do not need.
fn inches(text: &str) -> String {
    let within = |c: char| c.is_alphanumeric() || c == '_';
    let mut out = String::with_capacity(text.len() + 4);
    let mut rest = text;
    while let Some(at) = rest.find("in") {
        let (before, after) = (&rest[..at], &rest[at + 2..]);
        out += before;
        let alone = !out.ends_with(within) && !after.starts_with(within);
        // A number may precede it without a blank: `3in`.
        let number = out.ends_with(|c: char| c.is_ascii_digit()) && !after.starts_with(within) && {
            let word = out.rsplit(|c: char| !within(c)).next().unwrap_or_default();
            word.starts_with(|c: char| c.is_ascii_digit())
        };
        out += if alone || number { "inch" } else { "in" };
        rest = after;
    }
    out + rest
}

/// Names of three letters and more that keep their usual meaning.
const USUAL: &[&str] = &[
    "rad", "deg", "rpm", "min", "day", "Hz", "kHz", "MHz", "kPa", "MPa", "GPa", "bar", "psi", "ksi", "atm",
    "inch", "lbf", "mile", "mph", "ton", "tonne", "cal", "kcal", "percent", "sqrt", "cbrt", "abs", "exp",
    "log", "log2", "log10", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "floor",
    "ceil", "round", "mod", "per", "and",
];

/// Reserved words of quantities.
const WORDS: &[&str] = &["in", "to", "of", "per", "and", "or", "mod", "xor", "not"];

/// Check that a name can name a value of the file.
fn named(name: &str) -> Result<(), String> {
    let letters = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !letters || !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return Err(format!("`{name}` is no name: a letter, then letters, digits and `_`"));
    }
    taken(name).map_or(Ok(()), Err)
}

/// Return an error if the name has a meaning already.
fn taken(name: &str) -> Option<String> {
    if WORDS.contains(&name) {
        return Some(format!("`{name}` is a word of quantities and cannot name a parameter"));
    }
    if crate::expression::reserved().any(|reserved| reserved == name) {
        return Some(format!("`{name}` is a function or constant of formulas and cannot name a parameter"));
    }
    // Longer names are reserved only if scenes commonly use them: a parameter `section` never means the square mile.
    if name.len() > 2 && !USUAL.contains(&name) {
        return None;
    }
    let other = "take a word, as `mass` or `radius`";
    if ["x", "y", "z", "r", "t"].contains(&name) {
        return Some(format!("`{name}` is a variable of formulas and cannot name a parameter; {other}"));
    }
    let known = evaluate(name, &mut Context::new()).ok()?;
    // The value of a unit contains its name, `1 meter`; a constant or function has a number or itself.
    let unit = known.strip_prefix("1 ").map_or(String::new(), |unit| format!(" ({unit})"));
    Some(format!("`{name}` is a unit or a constant{unit} and cannot name a parameter; {other}"))
}

/// Maximum number of interruption points of the evaluator: a quantity passes about 50, `3.7^1.2345` 38 000.
const WORK: u64 = 100_000;

/// Error message for a text that is too costly.
const TOO_MUCH: &str =
    "takes too many operations to evaluate, as powers of many digits do; write `exp(b * ln(a))` for `a^b`";

/// Evaluate a text within a bounded number of operations. The bound counts operations and not time, so that the result does not depend on
/// the load of the machine.
fn evaluate(text: &str, context: &mut Context) -> Result<String, String> {
    /// Interrupt for evaluations that would not end: `"10^10^10"`.
    #[derive(Default)]
    struct Budget(AtomicU64);
    impl Interrupt for Budget {
        fn should_interrupt(&self) -> bool {
            self.0.fetch_add(1, Ordering::Relaxed) >= WORK
        }
    }
    match fend_core::evaluate_with_interrupt(text, context, &Budget::default()) {
        Ok(value) => Ok(value.get_main_result().to_string()),
        Err(why) if why == "interrupted" => Err(TOO_MUCH.into()),
        Err(why) => Err(why),
    }
}

/// Call `read` with the parameters of the file under reading.
pub(crate) fn with_parameters<R>(read: impl FnOnce(&Parameters) -> R) -> R {
    PARAMETERS.with_borrow(read)
}

impl<'de, U: Measure> Deserialize<'de> for Quantity<U> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Reads<U>(PhantomData<U>);
        impl<U: Measure> Visitor<'_> for Reads<U> {
            type Value = Quantity<U>;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                match U::UNIT {
                    "" => write!(f, "a number"),
                    unit => {
                        write!(f, "a {}: a number in {unit}, or a text with a unit as \"3 {unit}\"", U::NAME)
                    }
                }
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
                if value.is_finite() {
                    Ok(Quantity::new(value))
                } else {
                    Err(E::custom(format!("{value} is not finite")))
                }
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
                Ok(Quantity::new(value as f64))
            }
            fn visit_u64<E: Error>(self, value: u64) -> Result<Self::Value, E> {
                Ok(Quantity::new(value as f64))
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                let value = with_parameters(|p| p.quantity(text, U::UNIT));
                value.map(Quantity::new).map_err(|why| {
                    let unit = if U::UNIT.is_empty() { String::new() } else { format!(" in {}", U::UNIT) };
                    E::custom(format!("`{text}` is no {}{unit}: {why}", U::NAME))
                })
            }
        }
        from.deserialize_any(Reads(PhantomData))
    }
}

/// Serialise as a number in SI units, for defaults in the schema.
impl<U> serde::Serialize for Quantity<U> {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_f64(self.value)
    }
}

impl<U: Measure> schemars::JsonSchema for Quantity<U> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        let words: String = U::NAME.split(' ').map(capital).collect();
        words.into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let unit = if U::UNIT.is_empty() { "1" } else { U::UNIT };
        schemars::json_schema!({
            "description": format!("A {} in {unit}, or a text with a unit, or arithmetic with the file's parameters", U::NAME),
            "type": ["number", "string"],
        })
    }
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or(String::new(), |c| c.to_uppercase().collect::<String>() + letters.as_str())
}
