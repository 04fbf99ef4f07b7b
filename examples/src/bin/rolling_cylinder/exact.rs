//! A rigid homogeneous cylinder that starts from rest on an incline.

/// The slope, and how rough it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incline {
    /// Angle to the horizontal, radians.
    pub angle: f64,
    /// Coefficient of friction.
    pub friction: f64,
}

/// Where a rigid cylinder is, and how fast.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Course {
    /// Way of the centre along the incline, m.
    pub way: f64,
    /// Its speed, m/s.
    pub speed: f64,
    /// Angular velocity, rad/s.
    pub spin: f64,
}

impl Incline {
    /// Does it roll without sliding? The friction this takes is a third of the weight along the incline.
    pub fn sticks(&self) -> bool {
        self.angle.tan() <= 3.0 * self.friction
    }
    /// Acceleration of the centre, m/s^2, and angular acceleration times radius, m/s^2, under gravity (m/s^2) of
    /// which `part` (0 to 1) acts along the incline and all across it.
    pub fn accelerations(&self, gravity: f64, part: f64) -> [f64; 2] {
        let (sine, cosine) = self.angle.sin_cos();
        let along = gravity * sine * part;
        let friction = (along / 3.0).min(self.friction * gravity * cosine);
        [along - friction, 2.0 * friction]
    }
    /// A rigid cylinder of that radius (m) at `times` (s, growing), from rest at the first of them, with the
    /// `part` of gravity along the incline a function of time. With a part of one: x = a t^2 / 2 with a = 2/3 g
    /// sin (rolls) or g (sin - mu cos) (rolls and slides). Integrated by parabolas in 1 ms or less, which is exact
    /// to 1e-6 for parts that vary over 0.1 s.
    pub fn course(
        &self,
        gravity: f64,
        radius: f64,
        part: impl Fn(f64) -> f64,
        times: impl IntoIterator<Item = f64>,
    ) -> Vec<Course> {
        let mut now = Course::default();
        let mut times = times.into_iter().peekable();
        let mut time = times.peek().copied().unwrap_or_default();
        let mut all = Vec::new();
        for end in times {
            let count = ((end - time) / 1.0e-3).ceil().max(1.0);
            let dt = (end - time) / count;
            for n in 0..count as u32 {
                let [a, w] = self.accelerations(gravity, part(time + (f64::from(n) + 0.5) * dt));
                now.way += (now.speed + 0.5 * a * dt) * dt;
                now.speed += a * dt;
                now.spin += w / radius * dt;
            }
            time = end;
            all.push(now);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn courses_are_the_known_ones() {
        let (g, r, angle) = (10.0, 3.2, 60.0_f64.to_radians());
        let at = |friction| Incline { angle, friction }.course(g, r, |_| 1.0, [0.0, 0.7, 1.5])[2];
        let (rolls, slides) = (at(0.6), at(0.3));
        // 5.774 and 7.160 m/s^2 for these angles and coefficients.
        assert!((rolls.way - g * 1.5 * 1.5 * angle.sin() / 3.0).abs() < 1e-12);
        assert!((slides.way - 0.5 * g * 1.5 * 1.5 * (angle.sin() - 0.3 * angle.cos())).abs() < 1e-12);
        assert!((rolls.speed - r * rolls.spin).abs() < 1e-12, "no slip");
        assert!((slides.spin - 2.0 * 0.3 * g * 1.5 * angle.cos() / r).abs() < 1e-12);
        assert!(Incline { angle, friction: 0.6 }.sticks() && !Incline { angle, friction: 0.3 }.sticks());
    }
}
