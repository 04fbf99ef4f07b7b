//! Hertz's impact of an elastic ball on a half space of the same material, in closed form.

use std::f64::consts::PI;

/// Ball that hits a plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Radius of the ball, m.
    pub radius: f64,
    /// Speed, m/s.
    pub speed: f64,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density, kg/m^3.
    pub density: f64,
}

/// Factor of the duration d / v: twice the integral of 1 / sqrt(1 - x^(5/2)) from 0 to 1.
const DURATION: f64 = 2.943_275;

impl Impact {
    /// Mass of the ball, kg.
    pub fn mass(&self) -> f64 {
        4.0 / 3.0 * PI * self.radius.powi(3) * self.density
    }

    /// Effective modulus E*, Pa: 1/E* = 2 (1 - nu^2) / E, for two deformable bodies.
    fn stiffness(&self) -> f64 {
        0.5 * self.young / (1.0 - self.poisson * self.poisson)
    }

    /// Largest approach of points far from the contact, m: (15 m v^2 / (16 E* sqrt R))^(2/5).
    pub fn approach(&self) -> f64 {
        let energy = self.mass() * self.speed * self.speed;
        (15.0 * energy / (16.0 * self.stiffness() * self.radius.sqrt())).powf(0.4)
    }

    /// Largest force, N: 4/3 E* sqrt R d^(3/2).
    pub fn force(&self) -> f64 {
        4.0 / 3.0 * self.stiffness() * self.radius.sqrt() * self.approach().powf(1.5)
    }

    /// Contact duration, s: 2.943 d / v.
    pub fn duration(&self) -> f64 {
        DURATION * self.approach() / self.speed
    }

    /// Largest contact radius, m.
    pub fn contact(&self) -> f64 {
        (self.radius * self.approach()).sqrt()
    }

    /// Integrate d'' = -F / m by velocity Verlet: time, s, and approach, m, in `steps` equal steps over the duration.
    pub fn history(&self, steps: usize) -> Vec<[f64; 2]> {
        let stiff = 4.0 / 3.0 * self.stiffness() * self.radius.sqrt() / self.mass();
        let pull = |d: f64| -stiff * d.max(0.0).powf(1.5);
        let dt = self.duration() / steps as f64;
        let (mut d, mut v) = (0.0, self.speed);
        let mut rows = vec![[0.0, 0.0]];
        for step in 1..=steps {
            let half = v + 0.5 * dt * pull(d);
            d += dt * half;
            v = half + 0.5 * dt * pull(d);
            rows.push([dt * step as f64, d]);
        }
        rows
    }

    /// Force at an approach, N.
    pub fn force_at(&self, approach: f64) -> f64 {
        self.force() * (approach.max(0.0) / self.approach()).powf(1.5)
    }

    /// Time for which the force exceeds a `part` of its maximum, s.
    pub fn lasts_above(&self, part: f64) -> f64 {
        const STEPS: usize = 20_000;
        let rows = self.history(STEPS);
        let above = rows.iter().filter(|row| self.force_at(row[1]) > part * self.force()).count();
        self.duration() * above as f64 / STEPS as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Impact = Impact { radius: 5e-3, speed: 1.0, young: 200e9, poisson: 0.3, density: 7850.0 };

    /// Gate I is a rigid wall: 566.3 N, 9.073 um, 26.70 us. Half of E has twice the compliance.
    #[test]
    fn a_plate_as_soft_as_the_ball_doubles_the_compliance() {
        let rigid = Impact { young: 2.0 * STEEL.young, ..STEEL };
        let near =
            |value: f64, known: f64| assert!((value / known - 1.0).abs() < 2e-4, "{value} for {known}");
        near(rigid.force(), 566.3);
        near(rigid.approach(), 9.073e-6);
        near(rigid.duration(), 26.70e-6);
        near(STEEL.approach() / rigid.approach(), 2f64.powf(0.4));
        near(STEEL.force() / rigid.force(), 2f64.powf(-0.4));
    }

    #[test]
    fn the_history_ends_where_it_began() {
        let rows = STEEL.history(2000);
        let most = rows.iter().map(|r| r[1]).fold(0.0, f64::max);
        assert!((most / STEEL.approach() - 1.0).abs() < 1e-4, "{most}");
        assert!(rows[2000][1].abs() < 2e-3 * most, "{:?}", rows[2000]);
        let above = STEEL.lasts_above(0.05) / STEEL.duration();
        assert!(above > 0.8 && above < 0.95, "{above}");
    }
}
