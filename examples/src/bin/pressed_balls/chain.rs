//! Chain model of the pack: rigid balls on Hertz contacts under a rigid plate.
//!
//! The rows of a cubic array under a uniform load on frictionless walls all move alike, so that one is enough. The chain neglects two
//! effects that make a pack faster: waves within the balls, and the finite contact area of particles from the start, where balls begin at a
//! point.

/// Elastic ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Diameter, m.
    pub diameter: f64,
    /// Density, kg/m^3.
    pub density: f64,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
}

impl Ball {
    /// Return the speed of the longitudinal wave, m/s.
    pub fn wave_speed(&self) -> f64 {
        let nu = self.poisson;
        (self.young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu) * self.density)).sqrt()
    }

    /// Return the Hertz stiffness, force over approach^(3/2), N/m^1.5, of two balls, of a ball and a plate of the same material, and of a
    /// ball and a rigid wall: 4/3 E* sqrt(R*).
    fn stiffness(&self) -> [f64; 3] {
        let wall = self.young / (1.0 - self.poisson * self.poisson);
        let radius = 0.5 * self.diameter;
        let of = |modulus: f64, radius: f64| 4.0 / 3.0 * modulus * radius.sqrt();
        [of(0.5 * wall, 0.5 * radius), of(0.5 * wall, radius), of(wall, radius)]
    }

    /// Return the reaction of the ground over the load from the time that `pressure` (Pa) starts to act on a plate as thick as a ball, on a
    /// row of `balls`: pairs of time (s) and ratio until `end` (s).
    pub fn chain(&self, balls: usize, pressure: f64, end: f64) -> Vec<[f64; 2]> {
        let [pair, plate, wall] = self.stiffness();
        let cube = self.density * self.diameter.powi(3);
        let load = pressure * self.diameter.powi(2);
        // Indices increase from the ground; the last is the plate.
        let mut down = vec![0.0; balls + 1];
        let mut speeds = vec![0.0; balls + 1];
        let force = |down: &[f64], below: usize| {
            let (k, lower) = match below {
                0 => (wall, 0.0),
                b if b == balls => (plate, down[b - 1]),
                b => (pair, down[b - 1]),
            };
            k * (down[below] - lower).max(0.0).powf(1.5)
        };
        // Time step: a hundredth of the transit time of sound through a ball.
        let dt = 0.01 * self.diameter / self.wave_speed();
        let mut history = Vec::new();
        for step in 0..(end / dt).ceil() as usize {
            let forces: Vec<f64> = (0..=balls).map(|b| force(&down, b)).collect();
            history.push([step as f64 * dt, forces[0] / load]);
            for b in 0..=balls {
                let (mass, above) = if b == balls {
                    (cube, load)
                } else {
                    (cube * std::f64::consts::PI / 6.0, forces[b + 1])
                };
                speeds[b] += dt * (above - forces[b]) / mass;
                down[b] += dt * speeds[b];
            }
        }
        history
    }
}

/// Return the time when a history first reaches `level`; infinite if never.
pub fn arrival(history: &[[f64; 2]], level: f64) -> f64 {
    history.iter().find(|row| row[1] >= level).map_or(f64::INFINITY, |row| row[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALUMINIUM: Ball = Ball { diameter: 0.01, density: 2700.0, young: 70e9, poisson: 0.33 };

    #[test]
    fn a_chain_carries_its_load_in_the_mean() {
        let history = ALUMINIUM.chain(5, 1e7, 4e-3);
        let mean = history.iter().map(|r| r[1]).sum::<f64>() / history.len() as f64;
        // The final momentum of the row corresponds to a few periods of some 1e-4 s in 4e-3 s.
        assert!((mean - 1.0).abs() < 0.03, "{mean}");
    }

    #[test]
    fn a_larger_load_arrives_earlier() {
        let at = |pressure| arrival(&ALUMINIUM.chain(5, pressure, 4e-3), 0.5);
        // Hertz contacts: wave speeds increase with the sixth root of the force.
        let ratio = at(1e6) / at(64e6);
        assert!((ratio - 2.0).abs() < 0.05, "{ratio}");
    }
}
