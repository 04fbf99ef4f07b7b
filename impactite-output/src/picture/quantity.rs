//! Which number gives the colour.

use super::super::{OutputError, Snapshot};
use super::axis::Scale;
use super::colour::{ColourMap, Rgb};

/// What is shown in colour: a field of the snapshot, how it is called, its unit, its range and its colours.
///
/// ```
/// use impactite_output::picture::{ColourMap, Quantity};
/// let stress = Quantity::scalar("mises").label("von Mises stress").unit("MPa", 1.0e-6).range(0.0, 400.0e6);
/// let speed = Quantity::magnitude("velocity").label("speed").unit("m/s", 1.0).map(ColourMap::Inferno);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    field: String,
    component: Component,
    label: String,
    unit: String,
    factor: f64,
    range: Option<(f64, f64)>,
    log: bool,
    map: ColourMap,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Component {
    Scalar,
    Magnitude,
    Axis(usize),
}

impl Quantity {
    fn new(field: String, component: Component) -> Self {
        let label = field.replace('_', " ");
        Self {
            field,
            component,
            label,
            unit: String::new(),
            factor: 1.0,
            range: None,
            log: false,
            map: ColourMap::Viridis,
        }
    }

    /// A scalar field, by name; the label is the name until [`label`](Self::label) says better.
    #[must_use]
    pub fn scalar(field: impl Into<String>) -> Self {
        Self::new(field.into(), Component::Scalar)
    }

    /// The length of a vector field, by name.
    #[must_use]
    pub fn magnitude(field: impl Into<String>) -> Self {
        Self::new(field.into(), Component::Magnitude)
    }

    /// One component of a vector field, by name: 0 is x, 1 is y, 2 (and more) z.
    #[must_use]
    pub fn component(field: impl Into<String>, axis: usize) -> Self {
        Self::new(field.into(), Component::Axis(axis.min(2)))
    }

    /// What people call it.
    #[must_use]
    pub fn label(self, label: impl Into<String>) -> Self {
        Self { label: label.into(), ..self }
    }

    /// The unit shown, and how many of it make one SI unit: `("MPa", 1e-6)`.
    #[must_use]
    pub fn unit(self, unit: impl Into<String>, factor: f64) -> Self {
        Self { unit: unit.into(), factor, ..self }
    }

    /// Colours run from `low` to `high` (SI units); without this, from the smallest value to the largest.
    #[must_use]
    pub fn range(self, low: f64, high: f64) -> Self {
        Self { range: Some((low, high)), ..self }
    }

    /// Colours follow the logarithm.
    #[must_use]
    pub fn logarithmic(self) -> Self {
        Self { log: true, ..self }
    }

    /// The colours.
    #[must_use]
    pub fn map(self, map: ColourMap) -> Self {
        Self { map, ..self }
    }

    /// Colour every particle of a snapshot.
    pub(crate) fn colours(&self, snapshot: &Snapshot) -> Result<Coloured, OutputError> {
        if !self.factor.is_finite() || self.factor == 0.0 {
            let what = format!("unit factor of {:?}", self.field);
            return Err(OutputError::value(what, self.factor, "finite and not 0"));
        }
        let mut values: Vec<f64> = match self.component {
            Component::Scalar => snapshot.scalar(&self.field)?.to_vec(),
            Component::Magnitude => snapshot
                .vector(&self.field)?
                .iter()
                .map(|v| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt())
                .collect(),
            Component::Axis(d) => snapshot.vector(&self.field)?.iter().map(|v| v[d]).collect(),
        };
        for value in &mut values {
            *value *= self.factor;
        }
        let (low, high) = match self.range {
            Some((low, high))
                if low.is_finite() && high.is_finite() && low < high && (!self.log || low > 0.0) =>
            {
                (low * self.factor, high * self.factor)
            }
            Some((low, high)) => {
                let allowed = "low < high, both finite, and low > 0 if logarithmic";
                return Err(OutputError::value(
                    format!("range of {:?}", self.field),
                    format!("{low} to {high}"),
                    allowed,
                ));
            }
            None => {
                let usable = values.iter().filter(|v| v.is_finite() && (!self.log || **v > 0.0));
                let (low, high) =
                    usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
                if self.map == ColourMap::CoolWarm && !self.log {
                    let most = low.abs().max(high.abs());
                    (-most, most)
                } else {
                    (low, high)
                }
            }
        };
        let scale = Scale::new(low, high, self.log);
        let table: Vec<Rgb> = (0..1024).map(|i| self.map.at(f64::from(i) / 1023.0)).collect();
        let of = |value: &f64| {
            let place = scale.place(if self.log { value.max(0.0) } else { *value });
            if place.is_nan() {
                super::colour::NO_VALUE
            } else {
                table[(place.clamp(0.0, 1.0) * 1023.0).round() as usize]
            }
        };
        Ok(Coloured { colours: values.iter().map(of).collect(), scale })
    }

    pub(crate) fn bar(&self, scale: Scale) -> super::axis::ColourBar<'_> {
        super::axis::ColourBar { map: self.map, scale, label: &self.label, unit: &self.unit }
    }
}

/// The colour of every particle and the scale of the colour bar, in the unit shown.
pub(crate) struct Coloured {
    pub colours: Vec<Rgb>,
    pub scale: Scale,
}

/// Colours by quantity, or by body if there is none.
pub(crate) fn colours_of(
    quantity: Option<&Quantity>,
    snapshot: &Snapshot,
) -> Result<(Vec<Rgb>, Option<Scale>), OutputError> {
    match quantity {
        Some(quantity) => quantity.colours(snapshot).map(|c| (c.colours, Some(c.scale))),
        None => Ok((snapshot.bodies().iter().map(|b| super::colour::palette(*b as usize)).collect(), None)),
    }
}
