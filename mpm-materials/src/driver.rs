//! Single-point driver: response of a law to a prescribed deformation path, without mesh or particles.
//!
//! ```
//! use mpm_materials::driver::{Path, Step, run};
//! use mpm_materials::{Elastic, LogarithmicBulk, Solid};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let steel = Solid::new(Elastic::new(80.0e9)?, LogarithmicBulk::new(7800.0, 160.0e9)?);
//! let table = run(&steel, &Path::UniaxialStress { rate: 1.0e3 }, Step { dt: 1.0e-8, steps: 100 })?;
//! println!("{}", table.to_csv());
//! # Ok(())
//! # }
//! ```

use std::fmt::Write;

use crate::lane::Real;
use crate::point::{Breakdown, Constitutive, Kinematics, State, first_broken, flatten};
use crate::tensor::{Mat3, Sym3};

/// Deformation path of the point.
#[derive(Clone, Debug, PartialEq)]
pub enum Path<T> {
    /// Uniaxial strain: dv_x/dx = rate, 1/s; all else zero.
    UniaxialStrain {
        /// Strain rate, 1/s, positive in extension.
        rate: T,
    },
    /// Simple shear: dv_x/dy = rate, 1/s; all else zero.
    SimpleShear {
        /// Shear rate, 1/s.
        rate: T,
    },
    /// Isotropic deformation: grad v = rate I / 3.
    Isotropic {
        /// Volumetric rate, 1/s, positive in expansion.
        rate: T,
    },
    /// Uniaxial stress: dv_x/dx = rate, lateral strain for zero lateral stress, as in a tension test.
    UniaxialStress {
        /// Strain rate, 1/s, positive in extension.
        rate: T,
    },
    /// Piecewise constant velocity gradients, 1/s, each from its time, s, to the next. Times must increase; the first
    /// and the last entry extend beyond the table.
    Tabulated(Vec<(T, Mat3<T>)>),
}

/// Size and number of the steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<T> {
    /// Time step, s.
    pub dt: T,
    /// Number of steps.
    pub steps: usize,
}

/// State of the point at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Row<T> {
    /// Time, s.
    pub time: T,
    /// Sum of the strain increments: logarithmic strain where the axes do not turn.
    pub strain: Sym3<T>,
    /// Cauchy stress, Pa.
    pub stress: Sym3<T>,
    /// Internal energy per reference volume, J/m^3.
    pub energy: T,
    /// State variables.
    pub state: Vec<T>,
}

/// Time history of a run, with the virgin state first.
#[derive(Clone, Debug, PartialEq)]
pub struct Table<T> {
    /// Names of the state variables.
    pub names: Vec<String>,
    /// One row per time.
    pub rows: Vec<Row<T>>,
}

/// Error of a run.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DriverError {
    /// Breakdown of the law.
    #[error("step {step}: {cause}")]
    Breakdown {
        /// Step number, from 1.
        step: usize,
        /// Cause of the breakdown.
        cause: Breakdown,
    },
    /// Lateral strain for zero lateral stress not found.
    #[error("step {step}: no lateral strain was found for zero lateral stress (still {residual:e} Pa)")]
    LateralStress {
        /// Step number, from 1.
        step: usize,
        /// Residual lateral stress, Pa.
        residual: f64,
    },
    /// Table without entries.
    #[error("the table of velocity gradients is empty")]
    EmptyTable,
}

impl<T: Real> Table<T> {
    /// Return the column of a state variable.
    pub fn column(&self, name: &str) -> Option<Vec<T>> {
        let at = self.names.iter().position(|n| n == name)?;
        Some(self.rows.iter().filter_map(|row| row.state.get(at).copied()).collect())
    }

    /// Format as comma-separated text with a header line: time, strain, stress, energy, state.
    pub fn to_csv(&self) -> String {
        const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "yz", "xz", "xy"];
        let mut header = vec!["time".to_string()];
        header.extend(COMPONENTS.map(|c| format!("strain_{c}")));
        header.extend(COMPONENTS.map(|c| format!("cauchy_{c}")));
        header.push("work".to_string());
        header.extend(self.names.iter().cloned());
        let mut text = header.join(",");
        text.push('\n');
        for row in &self.rows {
            // Writing to a string cannot fail.
            let _ = write!(text, "{:e}", row.time.to_double());
            for value in row.strain.0.iter().chain(&row.stress.0).chain([&row.energy]).chain(&row.state) {
                let _ = write!(text, ",{:e}", value.to_double());
            }
            text.push('\n');
        }
        text
    }
}

/// Drive a virgin point along a path.
///
/// # Errors
/// [`DriverError`], with the step at which the law broke down.
pub fn run<T: Real, M: Constitutive<T>>(
    law: &M,
    path: &Path<T>,
    step: Step<T>,
) -> Result<Table<T>, DriverError> {
    let mut point = Point { law, state: law.virgin(), dt: step.dt };
    let mut strain = Sym3([T::default(); 6]);
    let mut lateral = T::default();
    let mut rows = Vec::with_capacity(step.steps + 1);
    rows.push(point.row(T::default(), strain));
    for k in 1..=step.steps {
        let time = step.dt * T::of(k as f64);
        let increment = match path {
            Path::UniaxialStress { rate } => {
                lateral = point.free_lateral_strain(*rate * step.dt, lateral, k)?;
                diagonal(*rate * step.dt, lateral)
            }
            // The gradient at the middle of the step.
            other => scaled(&gradient(other, time - step.dt * T::of(0.5))?, step.dt),
        };
        point.state = point.step(&increment, k)?;
        for (i, (r, c)) in [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)].into_iter().enumerate() {
            strain.0[i] += (increment.0[r][c] + increment.0[c][r]) * T::of(0.5);
        }
        rows.push(point.row(time, strain));
    }
    let mut names = Vec::new();
    <M::State<T::Single> as State<T::Single>>::names("", &mut names);
    Ok(Table { names, rows })
}

struct Point<'a, T: Real, M: Constitutive<T>> {
    law: &'a M,
    state: M::State<T::Single>,
    dt: T,
}

impl<T: Real, M: Constitutive<T>> Point<'_, T, M> {
    fn row(&self, time: T, strain: Sym3<T>) -> Row<T> {
        Row {
            time,
            strain,
            stress: Sym3(self.law.stress(&self.state).0.map(Into::into)),
            energy: self.law.energy(&self.state).into(),
            state: flatten(&self.state).into_iter().map(Into::into).collect(),
        }
    }

    fn step(&self, increment: &Mat3<T>, step: usize) -> Result<M::State<T::Single>, DriverError> {
        let kinematics = Kinematics {
            increment: Mat3(increment.0.map(|row| row.map(Into::into))),
            dt: self.dt.into(),
            length: T::of(1.0).into(),
        };
        let update = self.law.update(&kinematics, &self.state);
        match first_broken(&update) {
            Some(broken) => Err(DriverError::Breakdown { step, cause: broken.cause }),
            None => Ok(update.state),
        }
    }

    /// Secant iteration for the lateral strain increment, equal in y and z, with sigma_yy = 0.
    fn free_lateral_strain(&self, axial: T, guess: T, step: usize) -> Result<T, DriverError> {
        let lateral_stress = |lateral: T| -> Result<T, DriverError> {
            let state = self.step(&diagonal(axial, lateral), step)?;
            Ok(self.law.stress(&state).0[1].into())
        };
        let speed: T = self.law.wave_speed(&self.state).into();
        let modulus = self.law.density() * speed * speed;
        let tolerance = modulus * axial.abs() * T::default_epsilon() * T::of(1e3)
            + modulus * T::default_epsilon() * T::of(4.0);
        let (mut a, mut b) = (guess, guess - axial * T::of(0.1));
        let (mut at_a, mut at_b) = (lateral_stress(a)?, lateral_stress(b)?);
        for _ in 0..60 {
            if at_b.abs() <= tolerance || at_a == at_b {
                break;
            }
            let next = b - at_b * (b - a) / (at_b - at_a);
            (a, at_a) = (b, at_b);
            (b, at_b) = (next, lateral_stress(next)?);
        }
        if at_b.abs() <= tolerance * T::of(10.0) {
            Ok(b)
        } else {
            Err(DriverError::LateralStress { step, residual: at_b.to_double() })
        }
    }
}

fn gradient<T: Real>(path: &Path<T>, time: T) -> Result<Mat3<T>, DriverError> {
    let zero = T::default();
    Ok(match path {
        Path::UniaxialStrain { rate } | Path::UniaxialStress { rate } => diagonal(*rate, zero),
        Path::SimpleShear { rate } => {
            let mut g = diagonal(zero, zero);
            g.0[0][1] = *rate;
            g
        }
        Path::Isotropic { rate } => {
            let third = *rate * T::of(1.0 / 3.0);
            diagonal(third, third)
        }
        Path::Tabulated(table) => {
            let first = table.first().ok_or(DriverError::EmptyTable)?;
            table.iter().take_while(|(from, _)| *from <= time).last().unwrap_or(first).1
        }
    })
}

fn diagonal<T: Real>(axial: T, lateral: T) -> Mat3<T> {
    let o = T::default();
    Mat3([[axial, o, o], [o, lateral, o], [o, o, lateral]])
}

fn scaled<T: Real>(m: &Mat3<T>, factor: T) -> Mat3<T> {
    Mat3(m.0.map(|row| row.map(|x| x * factor)))
}
