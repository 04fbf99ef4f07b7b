//! Formulas of position and time.

use std::marker::PhantomData;
use std::sync::Arc;

use serde::de::{Deserialize, Deserializer, Error, Visitor};

use crate::expression::Expression;
use crate::quantity::{Measure, Quantity, bounded, with_parameters};
use crate::table::Table;

/// Quantity that may depend on position and time: a number, a text with a unit, or a formula in SI units that begins with `=`: `"= -190 *
/// (1 - z / 0.0254)"`. Variables are `x`, `y`, `z`, in axisymmetric scenes `r` and `z` (m), and `t` (s); parameters of the file are numbers
/// in SI units, and names of its tables have their values at time `t`.
#[derive(Clone, Debug)]
pub struct Formula<U> {
    what: What,
    measure: PhantomData<U>,
}

#[derive(Clone, Debug)]
enum What {
    Constant(f64),
    Varies(Arc<Varies>),
}

#[derive(Debug)]
struct Varies {
    text: String,
    formula: Expression,
    /// Meanings of the variables, in their order.
    variables: Vec<Variable>,
}

#[derive(Clone, Debug, PartialEq)]
enum Variable {
    X,
    Y,
    Z,
    /// Distance from the axis of revolution: the first coordinate.
    R,
    T,
    Number(f64),
    /// Table over time.
    Table(Arc<Table>),
}

/// Coordinate system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinates {
    /// Three dimensions: x, y, z.
    Space,
    /// Plane: x, y.
    Plane,
    /// Axisymmetric: r, z.
    Revolved,
}

impl<U: Measure> Formula<U> {
    /// Create a constant.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Formula { what: What::Constant(value), measure: PhantomData }
    }

    /// True if both are the same number, or the same text with the same variables.
    pub fn is_same(&self, other: &Self) -> bool {
        match (&self.what, &other.what) {
            (What::Constant(a), What::Constant(b)) => a == b,
            (What::Varies(a), What::Varies(b)) => a.text == b.text && a.variables == b.variables,
            _ => false,
        }
    }

    /// Return the value if it is constant.
    #[must_use]
    pub fn as_constant(&self) -> Option<f64> {
        match self.what {
            What::Constant(value) => Some(value),
            What::Varies(_) => None,
        }
    }

    /// Check the variables: refuse unknown coordinates, position unless `place`, and time unless `time`.
    ///
    /// # Errors
    /// Invalid variable, by name.
    pub fn check(&self, coordinates: Coordinates, place: bool, time: bool) -> Result<(), String> {
        let What::Varies(varies) = &self.what else { return Ok(()) };
        for (variable, name) in varies.variables.iter().zip(varies.formula.names()) {
            let here = match variable {
                Variable::Number(_) => true,
                Variable::T | Variable::Table(_) => time,
                Variable::X => place && coordinates != Coordinates::Revolved,
                Variable::Y => place && coordinates != Coordinates::Revolved,
                Variable::Z => place && coordinates != Coordinates::Plane,
                Variable::R => place && coordinates == Coordinates::Revolved,
            };
            if !here {
                let there = match coordinates {
                    _ if !place => "",
                    Coordinates::Space => "x, y, z",
                    Coordinates::Plane => "x, y",
                    Coordinates::Revolved => "r, z",
                };
                let list: Vec<&str> =
                    [there, if time { "t" } else { "" }].into_iter().filter(|s| !s.is_empty()).collect();
                return Err(format!(
                    "`{}` cannot depend on `{name}`; it may on {}",
                    varies.text,
                    list.join(", ")
                ));
            }
        }
        Ok(())
    }

    /// Evaluate at a position (m) and time (s). NaN where the formula is undefined.
    #[must_use]
    pub fn at<const D: usize>(&self, x: &[f64; D], revolved: bool, time: f64) -> f64 {
        let varies = match &self.what {
            What::Constant(value) => return *value,
            What::Varies(varies) => varies,
        };
        let along = |d: usize| x.get(d).copied().unwrap_or(f64::NAN);
        let values: Vec<f64> = varies
            .variables
            .iter()
            .map(|variable| match variable {
                Variable::X | Variable::R => along(0),
                Variable::Y => along(1),
                Variable::Z if revolved => along(1),
                Variable::Z => along(2),
                Variable::T => time,
                Variable::Number(number) => *number,
                Variable::Table(table) => table.at(time),
            })
            .collect();
        varies.formula.value(&values)
    }

    fn of(text: &str) -> Result<Self, String> {
        bounded(text)?;
        let formula = Expression::parse(text)
            .map_err(|why| format!("{why} (formulas are in SI units and take no units: `= 200 * x`)"))?;
        let variables = formula.names().iter().map(|name| {
            Ok(match name.as_str() {
                "x" => Variable::X,
                "y" => Variable::Y,
                "z" => Variable::Z,
                "r" => Variable::R,
                "t" => Variable::T,
                other => with_parameters(|p| {
                    let number = p.numbers().get(other).map(|number| Variable::Number(*number));
                    number.or_else(|| p.tables().get(other).cloned().map(Variable::Table)).ok_or_else(|| {
                        let names: Vec<&str> = p.numbers().keys().chain(p.tables().keys()).map(String::as_str).collect();
                        let known = if names.is_empty() { "none".into() } else { names.join(", ") };
                        format!("`{other}` is neither a coordinate (x, y, z, r), nor the time t, nor a parameter or table (the file has {known})")
                    })
                })?,
            })
        });
        let variables = variables.collect::<Result<Vec<_>, String>>()?;
        let what = What::Varies(Arc::new(Varies { text: text.trim().into(), formula, variables }));
        Ok(Formula { what, measure: PhantomData })
    }
}

impl<U: Measure> From<Quantity<U>> for Formula<U> {
    fn from(quantity: Quantity<U>) -> Self {
        Formula::constant(quantity.value)
    }
}

impl<'de, U: Measure> Deserialize<'de> for Formula<U> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Reads<U>(PhantomData<U>);
        impl<U: Measure> Visitor<'_> for Reads<U> {
            type Value = Formula<U>;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(
                    f,
                    "a {}: a number in {unit}, a text with a unit, or a formula of place and time in {unit}, \"= ...\"",
                    U::NAME,
                    unit = if U::UNIT.is_empty() { "1" } else { U::UNIT }
                )
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
                if value.is_finite() {
                    Ok(Formula::constant(value))
                } else {
                    Err(E::custom(format!("{value} is not finite")))
                }
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
                Ok(Formula::constant(value as f64))
            }
            fn visit_u64<E: Error>(self, value: u64) -> Result<Self::Value, E> {
                Ok(Formula::constant(value as f64))
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                match text.trim_start().strip_prefix('=') {
                    Some(formula) => Formula::of(formula)
                        .map_err(|why| E::custom(format!("`{text}` is no formula: {why}"))),
                    None => {
                        let value = with_parameters(|p| p.quantity(text, U::UNIT));
                        value.map(Formula::constant).map_err(|why| {
                            let unit =
                                if U::UNIT.is_empty() { String::new() } else { format!(" in {}", U::UNIT) };
                            E::custom(format!("`{text}` is no {}{unit}: {why}", U::NAME))
                        })
                    }
                }
            }
        }
        from.deserialize_any(Reads(PhantomData))
    }
}

impl<U: Measure> schemars::JsonSchema for Formula<U> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("{}Formula", <Quantity<U> as schemars::JsonSchema>::schema_name()).into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let unit = if U::UNIT.is_empty() { "1" } else { U::UNIT };
        schemars::json_schema!({
            "description": format!("A {} in {unit}, a text with a unit, or a formula in SI units of x, y, z (r, z) and t: \"= ...\"", U::NAME),
            "type": ["number", "string"],
        })
    }
}
