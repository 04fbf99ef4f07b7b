//! A homogeneous cylinder that starts from rest on an incline: rigid, or elastic with the creep of rolling contact.
//!
//! An elastic cylinder that rolls while a force Q acts along the plane sticks in the front part of its contact only.
//! The material of both bodies comes in stretched by mu (a - a') / R, with a the half width of contact, a' that of the
//! part that sticks and R the radius, so that it moves on by v while it turns by omega R = v (1 - xi):
//!
//! xi = mu a / R (1 - sqrt(1 - Q / (mu P)))   \[Carter1926\].
//!
//! It follows from Hertz's contact \[C\]: the traction mu p0 sqrt(1 - x^2/a^2) strains the surfaces by -mu x / R in all,
//! since p0 = E* a / (2 R); one over the part that sticks, a' wide and around d = a - a', less by a'/a, takes
//! -mu (x - d) / R off again, which leaves a uniform mu d / R there, and Q = mu P (1 - (a'/a)^2). Only the sum of the
//! compliances enters, so that it holds for unlike bodies but for what normal traction strains along the surface.

use std::f64::consts::PI;

/// The slope, and how rough it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incline {
    /// Angle to the horizontal, radians.
    pub angle: f64,
    /// Coefficient of friction.
    pub friction: f64,
}

/// What rolls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Radius, m.
    pub radius: f64,
    /// Half width of its contact over the radius; zero: rigid.
    pub contact: f64,
}

impl Cylinder {
    /// One that nothing deforms.
    pub fn rigid(radius: f64) -> Self {
        Cylinder { radius, contact: 0.0 }
    }
    /// One pressed on the plane by its own weight across it: a^2 = 4 P R / (pi E*) with P = rho pi R^2 g cos(angle)
    /// \[Hertz1882\]. Density, kg/m^3; contact modulus E* of both bodies, Pa; gravity across the plane, m/s^2.
    pub fn elastic(radius: f64, density: f64, modulus: f64, across: f64) -> Self {
        let weight = density * PI * radius * radius * across;
        Cylinder { radius, contact: (4.0 * weight / (PI * modulus * radius)).sqrt() }
    }
}

/// Where a cylinder is, and how fast.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Course {
    /// Way of the centre along the incline, m.
    pub way: f64,
    /// Its speed, m/s.
    pub speed: f64,
    /// Angular velocity, rad/s.
    pub spin: f64,
}

/// Longest step of the integration, s: ways and spins are then right to 1e-5.
const STEP: f64 = 1.0e-4;

impl Incline {
    /// Does a rigid cylinder roll without sliding? The friction this takes is a third of the weight along the incline.
    pub fn sticks(&self) -> bool {
        self.angle.tan() <= 3.0 * self.friction
    }
    /// A cylinder at `times` (s, growing), from rest at the first of them, under `gravity` (m/s^2) all of which acts
    /// across the incline and along it the `part` (0 to 1) that belongs to a time. A rigid one with a part of one:
    /// x = a t^2 / 2 with a = 2/3 g sin (rolls) or g (sin - mu cos) (rolls and slides).
    pub fn course(
        &self,
        gravity: f64,
        cylinder: Cylinder,
        part: impl Fn(f64) -> f64,
        times: impl IntoIterator<Item = f64>,
    ) -> Vec<Course> {
        let (sine, cosine) = self.angle.sin_cos();
        let mut now = Course::default();
        let mut times = times.into_iter().peekable();
        let mut time = times.peek().copied().unwrap_or_default();
        let mut all = Vec::new();
        for end in times {
            let count = ((end - time) / STEP).ceil();
            let dt = (end - time) / count;
            for n in 0..count as u32 {
                let along = gravity * sine * part(time + (f64::from(n) + 0.5) * dt);
                let friction = self.traction(&now, cylinder, along, gravity * cosine, dt);
                let a = along - friction;
                now.way += (now.speed + 0.5 * a * dt) * dt;
                now.speed += a * dt;
                now.spin += 2.0 * friction / cylinder.radius * dt;
            }
            time = end;
            all.push(now);
        }
        all
    }
    /// Friction over mass in a step, m/s^2: what the creep at its end asks for.
    fn traction(&self, now: &Course, cylinder: Cylinder, along: f64, across: f64, dt: f64) -> f64 {
        let most = self.friction * across;
        // What leaves no slip at the end of the step; three: of the speed and two of the surface, as I = m R^2 / 2.
        let slip = now.speed + along * dt - now.spin * cylinder.radius;
        let rolls = (slip / (3.0 * dt)).clamp(0.0, most);
        if cylinder.contact == 0.0 {
            return rolls;
        }
        let asked = |q: f64| {
            let speed = now.speed + (along - q) * dt;
            let (slip, sticks) = (slip - 3.0 * q * dt, self.friction * cylinder.contact * speed);
            let part = if slip < sticks { slip.max(0.0) / sticks } else { 1.0 };
            most * (1.0 - (1.0 - part).powi(2))
        };
        // The creep falls as the traction grows: one traction gives the creep that asks for it.
        let (mut low, mut high) = (0.0, rolls);
        for _ in 0..60 {
            let q = 0.5 * (low + high);
            if asked(q) > q { low = q } else { high = q }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRAVITY: f64 = 10.0;
    const RADIUS: f64 = 3.2;

    fn at(friction: f64, cylinder: Cylinder) -> Course {
        let angle = 60.0_f64.to_radians();
        Incline { angle, friction }.course(GRAVITY, cylinder, |_| 1.0, [0.0, 0.7, 1.5])[2]
    }

    #[test]
    fn courses_are_the_known_ones() {
        let angle = 60.0_f64.to_radians();
        let [rolls, slides] = [0.6, 0.3].map(|friction| at(friction, Cylinder::rigid(RADIUS)));
        // 5.774 and 7.160 m/s^2 for these angles and coefficients.
        assert!((rolls.way - GRAVITY * 1.5 * 1.5 * angle.sin() / 3.0).abs() < 1e-9);
        let slide = angle.sin() - 0.3 * angle.cos();
        assert!((slides.way - 0.5 * GRAVITY * 1.5 * 1.5 * slide).abs() < 1e-9);
        assert!((rolls.speed - RADIUS * rolls.spin).abs() < 1e-9, "no slip");
        assert!((slides.spin - 2.0 * 0.3 * GRAVITY * 1.5 * angle.cos() / RADIUS).abs() < 1e-9);
        assert!(Incline { angle, friction: 0.6 }.sticks() && !Incline { angle, friction: 0.3 }.sticks());
    }

    #[test]
    fn elastic_cylinders_creep_where_they_roll() {
        let cylinder = Cylinder { radius: RADIUS, contact: 0.04 };
        let [rolls, slides] = [0.6, 0.3].map(|friction| at(friction, cylinder));
        // The moment of friction is m R^2 / 2 times what turns the cylinder: v and omega R have one ratio throughout.
        let q = 0.5 * rolls.spin * RADIUS / 1.5;
        let creep = 0.6 * 0.04 * (1.0 - (1.0 - q / (0.6 * 5.0)).sqrt());
        assert!((1.0 - rolls.spin * RADIUS / rolls.speed - creep).abs() < 1e-9, "{rolls:?}");
        assert!((0.015..0.025).contains(&creep), "{creep}");
        // Where all of the contact slips there is nothing to creep.
        let rigid = at(0.3, Cylinder::rigid(RADIUS));
        assert!((slides.spin - rigid.spin).abs() < 1e-9 && (slides.way - rigid.way).abs() < 1e-9);
        // Harder ones tend to the rigid one.
        let hard = at(0.6, Cylinder { contact: 4.0e-6, ..cylinder });
        assert!((hard.spin / at(0.6, Cylinder::rigid(RADIUS)).spin - 1.0).abs() < 2e-6);
    }
}
