//! Tables of values over time.

use std::fmt::{Formatter, Result as Written};
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::{Deserializer, Error, Visitor};

use super::parts::parts;
use crate::quantity::{Quantity, Time, with_parameters};
use crate::table::Table;

parts! {
    /// Values over time, linear between points and constant before the first and after the last one: as `points`, or from a `file`.
    TableSpec {
        /// Points, each a time and a value.
        #[serde(default)]
        #[schemars(example = (("0 us", "0 MPa"), ("5 us", "80 MPa")))]
        points: Option<Vec<[Any; 2]>>,
        /// Path of a text file with a row a line (CSV), relative to the folder of the scene file.
        #[serde(default)]
        #[schemars(example = "pulse.csv")]
        file: Option<PathBuf>,
        /// Columns of time and value in the file, counted from 1; the first two if not given.
        #[serde(default)]
        #[schemars(example = (1, 3))]
        columns: Option<[u32; 2]>,
        /// Unit of the times in the file; seconds if not given.
        #[serde(default)]
        #[schemars(example = "1 us")]
        time: Option<Quantity<Time>>,
        /// Unit of the values in the file; that of SI if not given.
        #[serde(default)]
        #[schemars(example = "1 MPa")]
        value: Option<Any>,
    }
}

impl TableSpec {
    /// Build the table; files are relative to `folder`.
    ///
    /// # Errors
    /// Neither points nor a file, or both; file that cannot be read or lacks the columns; invalid points.
    pub fn table(&self, folder: &Path) -> Result<Table, String> {
        match (&self.points, &self.file) {
            (Some(points), None) => {
                let of_file = [self.columns.is_some(), self.time.is_some(), self.value.is_some()];
                if of_file.contains(&true) {
                    return Err(
                        "`columns`, `time` and `value` are of a `file`; points have units of their own"
                            .into(),
                    );
                }
                Table::new(points.iter().map(|[time, value]| (time.0, value.0)))
            }
            (None, Some(file)) => {
                let path = folder.join(file);
                let text =
                    std::fs::read_to_string(&path).map_err(|e| format!("`{}`: {e}", path.display()))?;
                let columns = self.columns.unwrap_or([1, 2]).map(|n| n as usize);
                let units = [self.time.map_or(1.0, |q| q.value), self.value.map_or(1.0, |any| any.0)];
                Table::of_columns(&text, columns, units).map_err(|why| format!("`{}`: {why}", path.display()))
            }
            _ => Err("needs `points` or a `file`, and not both".into()),
        }
    }
}

/// Quantity of any dimension, in SI units: a number, or a text with a unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Any(pub f64);

impl<'de> Deserialize<'de> for Any {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Reads;
        impl Visitor<'_> for Reads {
            type Value = Any;
            fn expecting(&self, f: &mut Formatter<'_>) -> Written {
                write!(f, "a number in SI units, or a text with a unit")
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Any, E> {
                Ok(Any(value))
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<Any, E> {
                Ok(Any(value as f64))
            }
            fn visit_u64<E: Error>(self, value: u64) -> Result<Any, E> {
                Ok(Any(value as f64))
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Any, E> {
                let value = with_parameters(|p| p.of_any_measure(text));
                value.map(Any).map_err(|why| E::custom(format!("`{text}` is no quantity: {why}")))
            }
        }
        from.deserialize_any(Reads)
    }
}

impl JsonSchema for Any {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "AnyMeasure".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "description": "A number in SI units, or a text with a unit", "type": ["number", "string"] })
    }
}
