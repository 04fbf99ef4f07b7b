//! Motion of a homogeneous cylinder from rest on an incline: rigid, or elastic with the creep of rolling contact.
//!
//! An elastic cylinder that rolls under a tangential force Q sticks only in the leading part of its contact. The material of both bodies
//! enters the contact stretched by mu (a - a') / R, with a the half width of contact, a' that of the stick zone and R the radius, so that
//! the velocity v exceeds omega R = v (1 - xi):
//!
//! xi = mu a / R (1 - sqrt(1 - Q / (mu P)))   \[Carter1926\].
//!
//! Derivation from Hertz contact \[C\]: the traction mu p0 sqrt(1 - x^2/a^2) strains the surfaces by -mu x / R in total, since p0 = E* a /
//! (2 R); a second one over the stick zone of half width a' around d = a - a', smaller by a'/a, subtracts -mu (x - d) / R, which leaves a
//! uniform mu d / R there, and Q = mu P (1 - (a'/a)^2). Only the sum of the compliances enters, so that the formula holds for dissimilar
//! bodies, except for the strain along the surface from normal traction.

use std::f64::consts::PI;

/// Incline with its friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incline {
    /// Angle to the horizontal, rad.
    pub angle: f64,
    /// Coefficient of friction.
    pub friction: f64,
}

/// Rolling cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Radius, m.
    pub radius: f64,
    /// Half width of the contact over the radius; zero for a rigid cylinder.
    pub contact: f64,
}

impl Cylinder {
    /// Create a rigid cylinder.
    pub fn rigid(radius: f64) -> Self {
        Cylinder { radius, contact: 0.0 }
    }
    /// Create an elastic cylinder pressed on the plane by the normal component of its weight: a^2 = 4 P R / (pi E*) with P = rho pi R^2 g
    /// cos(angle) \[Hertz1882\]. Density, kg/m^3; contact modulus E* of both bodies, Pa; gravity normal to the plane, m/s^2.
    pub fn elastic(radius: f64, density: f64, modulus: f64, across: f64) -> Self {
        let weight = density * PI * radius * radius * across;
        Cylinder { radius, contact: (4.0 * weight / (PI * modulus * radius)).sqrt() }
    }
}

/// Position and velocity of a cylinder.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Course {
    /// Distance travelled by the centre along the incline, m.
    pub way: f64,
    /// Speed of the centre, m/s.
    pub speed: f64,
    /// Angular velocity, rad/s.
    pub spin: f64,
}

/// Largest step of the integration, s: distances and spins are accurate to 1e-5.
const STEP: f64 = 1.0e-4;

impl Incline {
    /// True if a rigid cylinder rolls without sliding: the required friction is a third of the weight along the incline.
    pub fn sticks(&self) -> bool {
        self.angle.tan() <= 3.0 * self.friction
    }
    /// Integrate the motion of a cylinder at `times` (s, increasing), from rest at the first of them, under `gravity` (m/s^2): the full
    /// normal component, and the fraction `part` (0 to 1) of the tangential component. A rigid cylinder with a fraction of one: x = a t^2 /
    /// 2 with a = 2/3 g sin (rolling) or g (sin - mu cos) (rolling and sliding).
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
    /// Return the friction force per mass in a step, m/s^2, consistent with the creep at its end.
    fn traction(&self, now: &Course, cylinder: Cylinder, along: f64, across: f64, dt: f64) -> f64 {
        let most = self.friction * across;
        // Friction for zero slip at the end of the step; factor three: one from the speed and two from the surface, as I = m R^2 / 2.
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
        // The required traction decreases with the applied one: bisection for the unique solution.
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
        // Accelerations of 5.774 and 7.160 m/s^2 for these angles and coefficients.
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
        // Friction is the only moment about the axis, I = m R^2 / 2; the ratio of v and omega R is constant.
        let q = 0.5 * rolls.spin * RADIUS / 1.5;
        let creep = 0.6 * 0.04 * (1.0 - (1.0 - q / (0.6 * 5.0)).sqrt());
        assert!((1.0 - rolls.spin * RADIUS / rolls.speed - creep).abs() < 1e-9, "{rolls:?}");
        assert!((0.015..0.025).contains(&creep), "{creep}");
        // Full slip: no effect of creep.
        let rigid = at(0.3, Cylinder::rigid(RADIUS));
        assert!((slides.spin - rigid.spin).abs() < 1e-9 && (slides.way - rigid.way).abs() < 1e-9);
        // Stiff cylinders converge to the rigid one.
        let hard = at(0.6, Cylinder { contact: 4.0e-6, ..cylinder });
        assert!((hard.spin / at(0.6, Cylinder::rigid(RADIUS)).spin - 1.0).abs() < 2e-6);
    }
}
