//! The times of velocities and forces.

/// How velocities of a body follow its forces (leap-frog): they belong to the middle of its steps, which may be made of several steps of
/// the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pace {
    /// From the time of the velocities to that of the forces at the end of the last step, s.
    lag: f64,
    /// From the start of the present step to the time of the velocities, s.
    ahead: f64,
    /// Since the start of the present step, s.
    elapsed: f64,
    /// Steps of the scene in one of the body's, and those made of it.
    pub ratio: u32,
    pub made: u32,
    /// The time that forces act for in the present step of the scene, s.
    pub kick: f64,
}

impl Pace {
    /// A step of the scene of `dt` seconds begins, and with it one of the body of `ratio` such, unless that goes on.
    pub fn begin(&mut self, dt: f64, ratio: u32) {
        self.kick = 0.0;
        if self.made == 0 {
            self.ratio = ratio;
            let half = 0.5 * dt * f64::from(ratio);
            *self = Pace { kick: self.lag + half, ahead: half, elapsed: 0.0, ..*self };
        }
    }
    /// Positions moved on. The length of the body's step if that ended, s.
    pub fn moved(&mut self, dt: f64) -> Option<f64> {
        self.elapsed += dt;
        self.made += 1;
        let ended = self.made >= self.ratio || self.elapsed >= 2.0 * self.ahead - 0.5 * dt;
        if !ended {
            return None;
        }
        self.made = 0;
        self.lag = self.elapsed - self.ahead;
        Some(self.elapsed)
    }
    /// From the time of the velocities to now, s.
    pub fn lag(&self) -> f64 {
        if self.made == 0 { self.lag } else { self.elapsed - self.ahead }
    }
    /// All of it, for checkpoints.
    pub fn numbers(&mut self) -> [&mut f64; 4] {
        [&mut self.lag, &mut self.ahead, &mut self.elapsed, &mut self.kick]
    }
}
