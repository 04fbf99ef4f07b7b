//! Time step limit and time step control: Courant number, growth, fixed steps.

/// Time step control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeControl {
    /// Courant condition: dt = factor * min over particles of h / (c + |v|), with the current wave speed c; at most `growth` times the last
    /// step (book, "The stable time step").
    Courant {
        /// Safety factor.
        factor: f64,
        /// Largest ratio of a step to the last one.
        growth: f64,
    },
    /// Frequency bound: dt = factor * sqrt(2) / omega with USL, factor * 2 / omega with MUSL and USF, omega the bound of the highest
    /// frequency by Gershgorin circles (`Mpm::frequency_bound` of mpm-core). The step is at most `growth` times the last one, and no
    /// particle moves further than factor times half a cell. It accounts for almost empty cells, where [`TimeControl::Courant`] uses an
    /// empirical factor of the shape function: a factor near 1 is safe at small strain. With FLIP and MUSL, whose limit no empty cell
    /// lowers, it is smaller than necessary.
    Gershgorin {
        /// Safety factor.
        factor: f64,
        /// Largest ratio of a step to the last one.
        growth: f64,
        /// Number of steps for which a bound is reused. Its computation costs some ten steps.
        every: u64,
    },
    /// Constant time step, s.
    Fixed(f64),
}

/// Limit of a time step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum StepLimit {
    /// Courant limit of a body: its index in the scene.
    Body(usize),
    /// Frequency bound of the grid nodes ([`TimeControl::Gershgorin`]).
    Nodes,
    /// Growth limit relative to the last step.
    Growth,
    /// Prescribed step.
    Fixed,
}

/// Return the index and the value of the largest rate, 1/s; the first of equal ones.
pub fn largest(rates: impl IntoIterator<Item = f64>) -> (usize, f64) {
    let more = |best: (usize, f64), next: (usize, f64)| if next.1 > best.1 { next } else { best };
    rates.into_iter().enumerate().fold((0, 0.0), more)
}

/// Invalid time step control.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("time control: {field} = {value} is not allowed; it must be {allowed}")]
pub struct ControlError {
    field: &'static str,
    value: f64,
    allowed: &'static str,
}

impl TimeControl {
    /// Check the parameters.
    ///
    /// # Errors
    /// A factor or step that is not positive, a growth not above 1, or a bound reused for 0 steps.
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

    /// Check the parameters for a gridless method, which has no nodes for a frequency bound.
    ///
    /// # Errors
    /// Invalid parameters, and [`TimeControl::Gershgorin`].
    pub fn check_without_grid(&self) -> Result<(), ControlError> {
        if let TimeControl::Gershgorin { every, .. } = *self {
            let allowed = "left out, as `Gershgorin` needs the nodes of a grid: take `Courant`";
            return Err(ControlError { field: "every", value: every as f64, allowed });
        }
        self.check()
    }

    /// Return the limit of the step that [`next`](TimeControl::next) returns, if `body` has the largest rate.
    pub fn limit(&self, rate: f64, last: Option<f64>, body: usize) -> StepLimit {
        let growing = |factor: f64, growth: f64| last.is_some_and(|last| growth * last < factor / rate);
        match *self {
            TimeControl::Fixed(_) => StepLimit::Fixed,
            TimeControl::Courant { factor, growth } | TimeControl::Gershgorin { factor, growth, .. }
                if growing(factor, growth) =>
            {
                StepLimit::Growth
            }
            TimeControl::Courant { .. } => StepLimit::Body(body),
            TimeControl::Gershgorin { .. } => StepLimit::Nodes,
        }
    }

    /// Return the next step, s, from the largest (c + |v|) / h of the particles or an equivalent rate, 1/s, and the last step, s.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_limits_a_step_is_what_makes_it_so_long() {
        let courant = TimeControl::Courant { factor: 0.5, growth: 1.1 };
        // Courant limit 0.5 / 100 s, growth limit 1.1 times the last step.
        assert_eq!(courant.limit(100.0, None, 3), StepLimit::Body(3));
        assert_eq!(courant.limit(100.0, Some(4.6e-3), 3), StepLimit::Body(3));
        assert_eq!(courant.limit(100.0, Some(4.5e-3), 3), StepLimit::Growth);
        assert!(courant.next(100.0, Some(4.5e-3)) < courant.next(100.0, None));
        let gershgorin = TimeControl::Gershgorin { factor: 0.5, growth: 1.1, every: 5 };
        assert_eq!(gershgorin.limit(100.0, None, 3), StepLimit::Nodes);
        assert_eq!(TimeControl::Fixed(1.0).limit(100.0, Some(0.1), 3), StepLimit::Fixed);
        assert_eq!(largest([1.0, 3.0, 3.0, 2.0]), (1, 3.0));
    }
}
