//! Local damping of unbalanced forces, for any method.

use crate::error::SceneError;

/// Local damping (Cundall 1987): the unbalanced force f of a point, contact and boundary forces included, is reduced by alpha |f| while it
/// accelerates the point and increased by alpha |f| while it decelerates it, f <- f - alpha |f| sign(v), for each axis.
///
/// Balanced forces are not damped, so that a state of rest is the exact one and bodies at rest press with their full weight. Damping never
/// reverses a velocity: a point that stops against another one stays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LocalDamping {
    coefficient: f64,
}

impl LocalDamping {
    /// Create local damping with the coefficient alpha: 0.05 for slow processes, 0.7 for the fastest approach to rest, 0 for none.
    ///
    /// # Errors
    /// A coefficient outside \[0, 1).
    pub fn new(coefficient: f64) -> Result<Self, SceneError> {
        let allowed = (0.0..1.0).contains(&coefficient);
        if allowed { Ok(LocalDamping { coefficient }) } else { Err(SceneError::Damping(coefficient)) }
    }

    /// The coefficient alpha.
    #[must_use]
    pub fn coefficient(&self) -> f64 {
        self.coefficient
    }

    /// True if the coefficient is positive.
    #[must_use]
    pub fn acts(&self) -> bool {
        self.coefficient > 0.0
    }

    /// Return the damped velocity at the end of a step along an axis, m/s. `start` is the velocity before all forces of the step, `end` the
    /// velocity that these forces result in.
    ///
    /// ```
    /// use impactite_scene::LocalDamping;
    /// let damping = LocalDamping::new(0.5)?;
    /// assert_eq!(damping.slowed(2.0, 3.0), 2.5);
    /// assert_eq!(damping.slowed(2.0, 1.5), 1.25);
    /// assert_eq!(damping.slowed(2.0, 0.0), 0.0);
    /// assert_eq!(damping.slowed(2.0, 2.0), 2.0);
    /// # Ok::<(), impactite_scene::SceneError>(())
    /// ```
    #[inline]
    #[must_use]
    pub fn slowed(&self, start: f64, end: f64) -> f64 {
        let against = self.coefficient * (end - start).abs();
        if start > 0.0 && end > 0.0 {
            (end - against).max(0.0)
        } else if start < 0.0 && end < 0.0 {
            (end + against).min(0.0)
        } else {
            end
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damping_takes_energy_and_never_reverses() {
        let damping = LocalDamping::new(0.7).expect("a coefficient");
        for start in [-3.0, -0.1, 0.0, 0.2, 5.0] {
            for end in [-4.0, -0.3, 0.0, 0.1, 6.0] {
                let slowed = damping.slowed(start, end);
                assert!(slowed.abs() <= f64::abs(end) && slowed * end >= 0.0, "{start} {end} {slowed}");
                assert_eq!(damping.slowed(-start, -end), -slowed);
                assert_eq!(LocalDamping::default().slowed(start, end), end);
            }
            assert_eq!(damping.slowed(start, start), start, "balanced forces are left alone");
        }
        for bad in [-0.1, 1.0, f64::NAN, f64::INFINITY] {
            assert!(LocalDamping::new(bad).is_err());
        }
    }
}
