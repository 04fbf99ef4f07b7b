//! Balances of mass, momentum and energy over a run, and definitions of their errors.

use serde::{Deserialize, Serialize};

use crate::number::{maybe, real, reals};
use crate::recorder::{Recorder, Row};

/// Time series in columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Name of the quantity.
    pub name: String,
    /// Unit; "-" if dimensionless.
    pub unit: String,
    /// Values.
    #[serde(with = "reals")]
    pub values: Vec<f64>,
}

/// Balances of mass, momentum and energy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Balances {
    /// Time series of equal length; empty if only the errors are known.
    pub series: Vec<Column>,
    /// [`Recorder::worst_mass_error`].
    #[serde(default, with = "maybe")]
    pub mass_error: Option<f64>,
    /// [`Recorder::worst_momentum_error`].
    #[serde(with = "real")]
    pub momentum_error: f64,
    /// [`Recorder::energy_error`]: `None` if nothing moves.
    #[serde(default, with = "maybe")]
    pub energy_error: Option<f64>,
    /// Momentum scale: largest sum of m |v| of the run, kg m/s.
    #[serde(default, with = "maybe")]
    pub momentum_scale: Option<f64>,
    /// Energy scale: largest energy of the run, J: kinetic, kinetic and internal, or work of damping or viscosity.
    #[serde(default, with = "maybe")]
    pub energy_scale: Option<f64>,
}

impl Balances {
    /// Definition of the mass error.
    pub const MASS_ERROR: &str = "change of the mass of all bodies since the start, over the mass at the start; negative: lost. Mass goes with points that are removed";
    /// Definition of the momentum error.
    pub const MOMENTUM_ERROR: &str = "amount of the change of momentum since the start that no impulse of boundaries, loads and body forces explains, over the largest sum of m |v| so far; around an axis along that alone";
    /// Definition of the energy error.
    pub const ENERGY_ERROR: &str = "change since the start of kinetic − staggering + internal energy − work + friction + impacts + damping + viscosity − conversion, over the largest energy so far: kinetic, kinetic and internal, or work of damping or viscosity; negative: energy was lost. Of energies that are rounding, where nothing moves, there is none";

    /// Return the column of this name, if it exists.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.series.iter().find(|column| column.name == name)
    }

    /// Create balances with errors only.
    pub(crate) fn errors(energy_error: f64, momentum_error: f64) -> Self {
        Balances {
            series: Vec::new(),
            mass_error: None,
            momentum_error,
            energy_error: Some(energy_error),
            momentum_scale: None,
            energy_scale: None,
        }
    }

    pub(crate) fn of(recorder: &Recorder) -> Self {
        let (rows, rests) = (recorder.rows(), recorder.energy_error().is_none());
        let column = |name: &str, unit: &str, of: &dyn Fn(&Row) -> f64| Column {
            name: name.into(),
            unit: unit.into(),
            values: rows.iter().map(of).collect(),
        };
        let series = vec![
            column("time", "s", &|r| r.time),
            column("step", "-", &|r| r.step as f64),
            column("time step", "s", &|r| r.dt),
            column("points", "-", &|r| r.points as f64),
            column("mass", "kg", &|r| r.mass),
            column("kinetic energy", "J", &|r| r.kinetic),
            column("internal energy", "J", &|r| r.internal),
            column("work", "J", &|r| r.work),
            column("friction", "J", &|r| r.friction),
            column("impacts", "J", &|r| r.impacts),
            column("damping", "J", &|r| r.damping),
            column("viscosity", "J", &|r| r.viscosity),
            column("viscous heat", "J", &|r| r.viscous_heat),
            column("staggering", "J", &|r| r.staggered),
            column("conversion", "J", &|r| r.conversion),
            column("total", "J", &Row::total),
            // The energy error at rest is not known before a check of the watch.
            column("energy error", "-", &|r| if rests { 0.0 } else { r.energy_error }),
            column("momentum x", "kg m/s", &|r| r.momentum[0]),
            column("momentum y", "kg m/s", &|r| r.momentum[1]),
            column("momentum z", "kg m/s", &|r| r.momentum[2]),
            column("momentum error", "-", &|r| r.momentum_error),
            column("wall clock", "s", &|r| r.wall_seconds),
            column("updates", "-", &|r| r.updates),
        ];
        let [energy_scale, momentum_scale] = recorder.scales();
        Balances {
            series,
            mass_error: Some(recorder.worst_mass_error()),
            momentum_error: recorder.worst_momentum_error(),
            energy_error: recorder.energy_error(),
            momentum_scale: Some(momentum_scale),
            energy_scale: Some(energy_scale),
        }
    }
}
