//! The time step.

use super::kernels::Facts;

/// How the time step is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeControl {
    /// dt = factor * min over particles of h / (c + |v|), with the current wave speed c; at most `growth`
    /// times the last step (book, "The stable time step").
    Courant {
        /// Safety factor.
        factor: f64,
        /// Largest ratio of one step to the last.
        growth: f64,
    },
    /// dt = factor * sqrt(2) / omega with USL, factor * 2 / omega with MUSL and USF, omega the bound of the highest
    /// frequency by the circles of Gershgorin ([`Mpm::frequency_bound`](crate::Mpm::frequency_bound)); at most
    /// `growth` times the last step, and no particle further than factor times half a cell. It sees what almost empty
    /// cells do to the step, where [`TimeControl::Courant`] goes by a rule of thumb for the shape function: a factor near
    /// 1 is safe at small strain. With FLIP and MUSL, whose limit no empty cell lowers, it asks for more than is needed.
    Gershgorin {
        /// Safety factor.
        factor: f64,
        /// Largest ratio of one step to the last.
        growth: f64,
        /// Steps for which a bound is kept. To find it costs some ten steps.
        every: u64,
    },
    /// The same dt always, s.
    Fixed(f64),
}

/// A control that no run can use.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("time control: {field} = {value} is not allowed; it must be {allowed}")]
pub struct ControlError {
    field: &'static str,
    value: f64,
    allowed: &'static str,
}

impl TimeControl {
    /// The default for a method: half of h / (c + |v|) for MUSL and USF, whose limit is 1.4 and more; for
    /// USL 0.7 of the smallest limit measured in three dimensions for the shape function (book, "The stable time step").
    /// Chart C10 (docs/report/index.html) has the limits of 704 arrangements of particles, and left these factors as they
    /// are. A third or half of the step changes the errors of charts C1 and C2 by less than a quarter, up or down, but those of the
    /// cubic spline with FMPM(4), which has next to none from the grid.
    pub fn default_for(method: &Facts) -> Self {
        let factor = if method.symplectic() { 0.5 } else { 0.7 * method.usl_limit };
        TimeControl::Courant { factor, growth: 1.1 }
    }

    /// Refuse what cannot be.
    ///
    /// # Errors
    /// A factor or step that is not positive, or a growth not above 1.
    pub fn check(&self) -> Result<(), ControlError> {
        match *self {
            TimeControl::Fixed(dt) if !(dt > 0.0 && dt.is_finite()) => {
                Err(ControlError { field: "dt", value: dt, allowed: "positive and finite" })
            }
            TimeControl::Gershgorin { every: 0, .. } => {
                Err(ControlError { field: "every", value: 0.0, allowed: "at least 1" })
            }
            TimeControl::Courant { factor, .. } | TimeControl::Gershgorin { factor, .. }
                if !(factor > 0.0 && factor.is_finite()) =>
            {
                Err(ControlError { field: "factor", value: factor, allowed: "positive and finite" })
            }
            TimeControl::Courant { growth, .. } | TimeControl::Gershgorin { growth, .. }
                if growth.is_nan() || growth <= 1.0 =>
            {
                Err(ControlError { field: "growth", value: growth, allowed: "above 1" })
            }
            _ => Ok(()),
        }
    }

    /// The same for a method without a grid, which has no nodes to bound the frequency of.
    ///
    /// # Errors
    /// A control that no run can use, and [`TimeControl::Gershgorin`].
    pub fn check_without_grid(&self) -> Result<(), ControlError> {
        if let TimeControl::Gershgorin { every, .. } = *self {
            let allowed = "left out, as `Gershgorin` needs the nodes of a grid: take `Courant`";
            return Err(ControlError { field: "every", value: every as f64, allowed });
        }
        self.check()
    }

    /// The step, from the largest (c + |v|) / h of the particles, 1/s, or what stands for it, and the last step, s.
    pub fn next(&self, rate: f64, last: Option<f64>) -> f64 {
        match *self {
            TimeControl::Fixed(dt) => dt,
            TimeControl::Courant { factor, growth } | TimeControl::Gershgorin { factor, growth, .. } => {
                let dt = factor / rate;
                last.map_or(dt, |last| dt.min(growth * last))
            }
        }
    }
}
