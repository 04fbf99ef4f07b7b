//! Time levels of velocities and forces.

/// Leapfrog time levels of a body: velocities are those at the middle of its steps, which may consist of several steps of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pace {
    /// Time from the velocities to the forces at the end of the last step, s.
    lag: f64,
    /// Time from the start of the present step to the velocities, s.
    ahead: f64,
    /// Time since the start of the present step, s.
    elapsed: f64,
    /// Subcycling ratio: steps of the scene in one step of the body; `made`: number of these steps already made.
    pub ratio: u32,
    pub made: u32,
    /// Duration for which forces act in the present step of the scene, s.
    pub kick: f64,
}

impl Pace {
    /// Begin a step of the scene of `dt` seconds, and a step of the body of `ratio` such steps unless one is in progress.
    pub fn begin(&mut self, dt: f64, ratio: u32) {
        self.kick = 0.0;
        if self.made == 0 {
            self.ratio = ratio;
            let half = 0.5 * dt * f64::from(ratio);
            *self = Pace { kick: self.lag + half, ahead: half, elapsed: 0.0, ..*self };
        }
    }
    /// Advance the time of the positions by `dt`, s. Returns the size of the body's step, s, if it ended.
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
    /// Time from the velocities to the present, s.
    pub fn lag(&self) -> f64 {
        if self.made == 0 { self.lag } else { self.elapsed - self.ahead }
    }
    /// Numbers for checkpoints.
    pub fn numbers(&mut self) -> [&mut f64; 4] {
        [&mut self.lag, &mut self.ahead, &mut self.elapsed, &mut self.kick]
    }
}
