//! Quantities for colouring.

use super::super::{FieldKind, OutputError, Snapshot};
use super::axis::{ColourBar, Scale};
use super::colour::{ColourMap, Rgb};
use super::series_view::SeriesView;

/// Quantity shown in colour: a field of the snapshot with label, unit, range and colour map.
///
/// Labels and units of the fields of the solvers (`pressure`, `von_mises`, `velocity`, `temperature`, ...) are predefined; pressures,
/// stresses and energies have an SI prefix that suits their range, such as MPa.
///
/// ```
/// use impactite_output::picture::{ColourMap, Quantity};
/// let stress = Quantity::scalar("mises").label("von Mises stress").unit("MPa", 1.0e-6).range(0.0, 400.0e6);
/// let speed = Quantity::magnitude("velocity").map(ColourMap::Inferno);
/// let shear = Quantity::named("stress_xy");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    field: String,
    component: Component,
    label: String,
    unit: String,
    factor: f64,
    /// True for a unit with an SI prefix chosen by the range.
    prefixed: bool,
    range: Option<(f64, f64)>,
    log: bool,
    map: ColourMap,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Component {
    Scalar,
    Magnitude,
    Axis(usize),
    Tensor(usize),
    /// Resolved by the name of a field or of a component.
    Named,
}

/// Components of a symmetric tensor in the order of [`FieldValues::Tensor`](crate::FieldValues::Tensor).
const TENSOR: [&str; 6] = ["xx", "yy", "zz", "yz", "xz", "xy"];
const VECTOR: [&str; 3] = ["x", "y", "z"];

/// Label and SI unit of the solver fields, and true if the unit accepts a prefix.
fn known(field: &str) -> Option<(String, &'static str, bool)> {
    let (label, unit, prefixed) = match field {
        "velocity" | "speed" => ("speed", "m/s", false),
        "displacement" => ("displacement", "m", true),
        "pressure" => ("pressure", "Pa", true),
        "von_mises" => ("von Mises stress", "Pa", true),
        "viscous_pressure" => ("viscous pressure", "Pa", true),
        "energy" => ("internal energy", "J/m³", true),
        "temperature" => ("temperature", "K", false),
        "time_to_light" => ("time to detonation", "s", true),
        _ => {
            let (vector, component) = field.rsplit_once('_')?;
            let unit = match vector {
                "stress" | "viscous_stress" if TENSOR.contains(&component) => "Pa",
                "velocity" if VECTOR.contains(&component) => "m/s",
                "displacement" if VECTOR.contains(&component) => "m",
                _ => return None,
            };
            return Some((format!("{} {component}", vector.replace('_', " ")), unit, unit != "m/s"));
        }
    };
    Some((label.to_string(), unit, prefixed))
}

/// SI prefix for numbers up to `largest`, and the conversion factor to the prefixed unit.
fn prefix(largest: f64) -> (&'static str, f64) {
    match largest {
        x if x >= 0.999e9 => ("G", 1e-9),
        x if x >= 0.999e6 => ("M", 1e-6),
        x if x >= 0.999e3 => ("k", 1e-3),
        x if x >= 0.999 || x == 0.0 || x.is_nan() => ("", 1.0),
        x if x >= 0.999e-3 => ("m", 1e3),
        x if x >= 0.999e-6 => ("µ", 1e6),
        _ => ("n", 1e9),
    }
}

impl Quantity {
    fn new(field: String, component: Component) -> Self {
        let (label, unit, prefixed) = known(&field).unwrap_or((field.replace('_', " "), "", false));
        let label = match component {
            Component::Axis(axis) => format!("{} {}", field.replace('_', " "), VECTOR[axis.min(2)]),
            _ => label,
        };
        Self {
            field,
            component,
            label,
            unit: unit.to_string(),
            factor: 1.0,
            prefixed,
            range: None,
            log: false,
            map: ColourMap::Viridis,
        }
    }

    /// Create a quantity from a scalar field, by name; the default label is the name, see [`label`](Self::label).
    #[must_use]
    pub fn scalar(field: impl Into<String>) -> Self {
        Self::new(field.into(), Component::Scalar)
    }

    /// Create a quantity from the magnitude of a vector field, by name.
    #[must_use]
    pub fn magnitude(field: impl Into<String>) -> Self {
        Self::new(field.into(), Component::Magnitude)
    }

    /// Create a quantity from one component of a vector field, by name: 0 is x, 1 is y, 2 (and more) z.
    #[must_use]
    pub fn component(field: impl Into<String>, axis: usize) -> Self {
        Self::new(field.into(), Component::Axis(axis.min(2)))
    }

    /// Create a quantity by name: a scalar field, the magnitude of a vector field, `speed` for that of `velocity`, a component of a vector
    /// (`velocity_x`) or of a tensor (`stress_xy`). [`Quantity::names`] lists the names.
    #[must_use]
    pub fn named(name: impl Into<String>) -> Self {
        Self::new(name.into(), Component::Named)
    }

    /// List all names that [`Quantity::named`] resolves for these fields.
    pub fn names<'a>(fields: impl IntoIterator<Item = (&'a str, FieldKind)>) -> Vec<String> {
        let mut names = Vec::new();
        for (field, kind) in fields {
            match kind {
                FieldKind::Scalar => names.push(field.to_string()),
                FieldKind::Vector => {
                    names.extend((field == "velocity").then(|| "speed".to_string()));
                    names.push(field.to_string());
                    names.extend(VECTOR.map(|c| format!("{field}_{c}")));
                }
                FieldKind::Tensor => names.extend(TENSOR.map(|c| format!("{field}_{c}"))),
            }
        }
        names
    }

    /// Resolve field and component in a snapshot.
    fn resolved<'a>(&'a self, snapshot: &Snapshot) -> Result<(&'a str, Component), OutputError> {
        let name = self.field.as_str();
        if self.component != Component::Named {
            return Ok((name, self.component));
        }
        let kind = |field: &str| snapshot.fields().find(|(n, _)| *n == field).map(|(_, v)| v.kind());
        match (kind(name), name.rsplit_once('_')) {
            (Some(FieldKind::Scalar), _) => return Ok((name, Component::Scalar)),
            (Some(FieldKind::Vector), _) => return Ok((name, Component::Magnitude)),
            (None, None) if name == "speed" && kind("velocity") == Some(FieldKind::Vector) => {
                return Ok(("velocity", Component::Magnitude));
            }
            (None, Some((field, component))) => match kind(field) {
                Some(FieldKind::Vector) => {
                    if let Some(axis) = VECTOR.iter().position(|c| *c == component) {
                        return Ok((field, Component::Axis(axis)));
                    }
                }
                Some(FieldKind::Tensor) => {
                    if let Some(place) = TENSOR.iter().position(|c| *c == component) {
                        return Ok((field, Component::Tensor(place)));
                    }
                }
                _ => {}
            },
            _ => {}
        }
        let available = Self::names(snapshot.fields().map(|(name, values)| (name, values.kind())));
        let available = available.iter().map(|n| format!("{n:?}")).collect::<Vec<_>>().join(", ");
        Err(OutputError::NoSuchField { kind: "colour", name: name.to_string(), available })
    }

    /// Values of all particles, SI units.
    fn values(&self, snapshot: &Snapshot) -> Result<Vec<f64>, OutputError> {
        let (field, component) = self.resolved(snapshot)?;
        Ok(match component {
            Component::Scalar | Component::Named => snapshot.scalar(field)?.to_vec(),
            Component::Magnitude => snapshot
                .vector(field)?
                .iter()
                .map(|v| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt())
                .collect(),
            Component::Axis(d) => snapshot.vector(field)?.iter().map(|v| v[d]).collect(),
            Component::Tensor(c) => snapshot.tensor(field)?.iter().map(|t| t[c]).collect(),
        })
    }

    /// Set the label.
    #[must_use]
    pub fn label(self, label: impl Into<String>) -> Self {
        Self { label: label.into(), ..self }
    }

    /// Set the displayed unit and its number per SI unit: `("MPa", 1e-6)`.
    #[must_use]
    pub fn unit(self, unit: impl Into<String>, factor: f64) -> Self {
        Self { unit: unit.into(), factor, prefixed: false, ..self }
    }

    /// Set the colour range from `low` to `high` (SI units); the default is the range of the values.
    #[must_use]
    pub fn range(self, low: f64, high: f64) -> Self {
        Self { range: Some((low, high)), ..self }
    }

    /// Use a logarithmic colour scale.
    #[must_use]
    pub fn logarithmic(self) -> Self {
        Self { log: true, ..self }
    }

    /// Set the colour map.
    #[must_use]
    pub fn map(self, map: ColourMap) -> Self {
        Self { map, ..self }
    }

    /// Map the values of all particles of a snapshot to colours.
    pub(crate) fn colours(&self, snapshot: &Snapshot) -> Result<Coloured, OutputError> {
        if !self.factor.is_finite() || self.factor == 0.0 {
            let what = format!("unit factor of {:?}", self.field);
            return Err(OutputError::value(what, self.factor, "finite and not 0"));
        }
        let mut values = self.values(snapshot)?;
        let (low, high) = match self.range {
            Some((low, high))
                if low.is_finite() && high.is_finite() && low < high && (!self.log || low > 0.0) =>
            {
                (low, high)
            }
            Some((low, high)) => {
                let allowed = "low < high, both finite, and low > 0 if logarithmic";
                return Err(OutputError::value(
                    format!("range of {:?}", self.field),
                    format!("{low} to {high}"),
                    allowed,
                ));
            }
            None => self.extent(&values),
        };
        let (prefix, factor) = match self.prefixed {
            true => prefix(low.abs().max(high.abs())),
            false => ("", self.factor),
        };
        for value in &mut values {
            *value *= factor;
        }
        let scale = Scale::new(low * factor, high * factor, self.log);
        let table: Vec<Rgb> = (0..1024).map(|i| self.map.at(f64::from(i) / 1023.0)).collect();
        let of = |value: &f64| {
            let place = scale.place(if self.log { value.max(0.0) } else { *value });
            if place.is_nan() {
                super::colour::NO_VALUE
            } else {
                table[(place.clamp(0.0, 1.0) * 1023.0).round() as usize]
            }
        };
        let valued = values.iter().map(|value| !value.is_nan()).collect();
        let bar = ColourBar {
            map: self.map,
            scale,
            label: self.label.clone(),
            unit: format!("{prefix}{}", self.unit),
        };
        Ok(Coloured { colours: values.iter().map(of).collect(), bar: Some(bar), valued })
    }

    /// Minimum and maximum of the values that can be shown in colour.
    fn extent(&self, values: &[f64]) -> (f64, f64) {
        let usable = values.iter().filter(|v| v.is_finite() && (!self.log || **v > 0.0));
        let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        if self.map == ColourMap::CoolWarm && !self.log {
            let most = low.abs().max(high.abs());
            (-most, most)
        } else {
            (low, high)
        }
    }

    /// Return the quantity with the range of a series, unless a range is set; logarithmic scales use the range of each picture.
    pub(crate) fn in_film(&self, film: &mut SeriesView, snapshot: &Snapshot) -> Result<Self, OutputError> {
        if self.range.is_some() || self.log {
            return Ok(self.clone());
        }
        let (low, high) = self.extent(&self.values(snapshot)?);
        let from_zero = ["von_mises", "plastic_strain", "damage"].contains(&self.field.as_str())
            || self.resolved(snapshot)?.1 == Component::Magnitude;
        let range = if low <= high { film.colours(low, high, from_zero) } else { None };
        Ok(range.map_or_else(|| self.clone(), |(low, high)| self.clone().range(low, high)))
    }
}

/// Colour of every particle, colour bar of the quantity, and flags of the particles with a value.
pub(crate) struct Coloured {
    pub colours: Vec<Rgb>,
    pub bar: Option<ColourBar>,
    /// True for particles with a value; empty for colouring by body.
    pub valued: Vec<bool>,
}

/// Colour by quantity, or by body without one.
pub(crate) fn colours_of(quantity: Option<&Quantity>, snapshot: &Snapshot) -> Result<Coloured, OutputError> {
    match quantity {
        Some(quantity) => quantity.colours(snapshot),
        None => {
            let colours = snapshot.bodies().iter().map(|b| super::colour::palette(*b as usize)).collect();
            Ok(Coloured { colours, bar: None, valued: Vec::new() })
        }
    }
}
