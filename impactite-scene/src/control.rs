//! The time step.

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
    /// frequency by the circles of Gershgorin (`Mpm::frequency_bound` of mpm-core); at most
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
