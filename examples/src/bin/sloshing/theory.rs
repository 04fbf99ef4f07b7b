//! Linear theory of a liquid in a tank of length L and depth H, walls without friction.
//!
//! Mode n has the elevation a_n cos(k x), k = n pi / L, and the frequency w^2 = g k tanh(k H).
//!
//! **Sway.** A tank that moves by x(t) from rest: a_n'' + w_n^2 a_n = 4 / (k L) tanh(k H) x''(t) for odd n, 0 for even n. With
//! x = A (1 - cos(w t)): a_n = A f / (w_n^2 - w^2) (cos(w t) - cos(w_n t)), f = 4 / (k L) tanh(k H) w^2. The centre of mass moves by
//! -sum of 2 a_n / (k^2 L H) in the frame of the tank.
//!
//! **Viscous decay** \[Lamb1932\]. Potential cosh(k y) cos(k x) and stream function sinh(m y) sin(k x), m^2 = k^2 + s / nu; no stress at the
//! surface, no shear stress at floor and walls. The exponent s of exp(s t) is a root of
//! ```text
//! (s + 2 nu k^2)^2 + w^2 = 4 nu^2 k^3 m tanh(k H) / tanh(m H)
//! ```
//! -2 nu k^2 +- i w for small viscosity. Without the normal viscous stress at the surface, whose work is half of the dissipation, the rate is
//! that of s (s + 2 nu k^2) + w^2 = 0: nu k^2.

use std::f64::consts::PI;

use crate::setup::{GRAVITY, Setup};

/// Mode of the tank.
#[derive(Clone, Copy, Debug)]
pub struct Mode {
    /// Wave number k, 1/m.
    pub wave_number: f64,
    /// tanh(k H).
    pub depth: f64,
}

impl Mode {
    pub fn new(n: u32, setup: &Setup) -> Self {
        let wave_number = f64::from(n) * PI / setup.length;
        Mode { wave_number, depth: (wave_number * setup.depth).tanh() }
    }
    /// Frequency w, rad/s.
    pub fn frequency(self) -> f64 {
        (GRAVITY * self.wave_number * self.depth).sqrt()
    }
    /// Period, s.
    pub fn period(self) -> f64 {
        2.0 * PI / self.frequency()
    }
    /// Amplitude of an odd mode over A in a tank that sways by A (1 - cos(w t)).
    pub fn swayed(self, w: f64, t: f64, length: f64) -> f64 {
        let own = self.frequency();
        let force = 4.0 / (self.wave_number * length) * self.depth * w * w;
        force / (own * own - w * w) * ((w * t).cos() - (own * t).cos())
    }
    /// Rate of decay of the amplitude with the kinematic viscosity `nu`, m^2/s: the root by Newton's method in complex numbers.
    pub fn decay(self, nu: f64, height: f64) -> f64 {
        let (k, w) = (self.wave_number, self.frequency());
        let residual = |s: Complex| {
            let m = s.times(1.0 / nu).plus(Complex(k * k, 0.0)).sqrt();
            // tanh(m H) is 1 within exp(-2 m H), m of the inverse of a boundary layer.
            let e = m.times(-2.0 * height).exp();
            let tanh = Complex(1.0, 0.0).plus(e.times(-1.0)).over(Complex(1.0, 0.0).plus(e));
            let shifted = s.plus(Complex(2.0 * nu * k * k, 0.0));
            let right = m.over(tanh).times(4.0 * nu * nu * k.powi(3) * self.depth);
            shifted.by(shifted).plus(Complex(w * w, 0.0)).plus(right.times(-1.0))
        };
        let mut s = Complex(-2.0 * nu * k * k, w);
        for _ in 0..30 {
            let step = Complex(1e-6 * w, 0.0);
            let slope = residual(s.plus(step)).plus(residual(s).times(-1.0)).times(1e6 / w);
            s = s.plus(residual(s).over(slope).times(-1.0));
        }
        -s.0
    }
}

/// Shift of the centre of mass over A in a tank that sways by A (1 - cos(w t)).
pub fn shift(setup: &Setup, w: f64, t: f64) -> f64 {
    let term = |n: u32| {
        let mode = Mode::new(n, setup);
        -2.0 * mode.swayed(w, t, setup.length) / (mode.wave_number.powi(2) * setup.length * setup.depth)
    };
    (1..200).step_by(2).map(term).sum()
}

/// Complex number.
#[derive(Clone, Copy, Debug)]
struct Complex(f64, f64);

impl Complex {
    fn plus(self, o: Self) -> Self {
        Complex(self.0 + o.0, self.1 + o.1)
    }
    fn times(self, by: f64) -> Self {
        Complex(self.0 * by, self.1 * by)
    }
    fn by(self, o: Self) -> Self {
        Complex(self.0 * o.0 - self.1 * o.1, self.0 * o.1 + self.1 * o.0)
    }
    fn over(self, o: Self) -> Self {
        self.by(Complex(o.0, -o.1)).times(1.0 / (o.0 * o.0 + o.1 * o.1))
    }
    fn exp(self) -> Self {
        Complex(self.1.cos(), self.1.sin()).times(self.0.exp())
    }
    /// Root with a positive real part.
    fn sqrt(self) -> Self {
        let size = self.0.hypot(self.1);
        let real = (0.5 * (size + self.0)).sqrt();
        Complex(real, 0.5 * self.1 / real)
    }
}
