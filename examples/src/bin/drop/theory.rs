//! References of free drops without gravity.
//!
//! **Elliptic drop** \[C\]. A circle of radius R with the velocity A (x, -y) remains an ellipse of semi-axes a and b, and the velocity linear:
//! ```text
//! a' = A a,    b' = -A b,    A' = A^2 (b^2 - a^2) / (a^2 + b^2),    p = rho A^2 a^2 b^2 / (a^2 + b^2) (1 - x^2/a^2 - y^2/b^2)
//! ```
//!
//! **Oscillation.** Small deformations of mode n = 2 by surface tension sigma: w^2 = n (n^2 - 1) sigma / (rho R^3) in the plane
//! \[Rayleigh1879\], n (n - 1) (n + 2) sigma / (rho R^3) in space; small viscosity damps them by the rate 2 n (n - 1) nu / R^2, or
//! (n - 1) (2 n + 1) nu / R^2 \[Lamb1932\].
//!
//! **Rest.** The pressure is sigma / R in the plane and 2 sigma / R in space.

use std::f64::consts::PI;

/// Elliptic drop: semi-axes over R, rate A over that at the start, and pressure in the middle over rho A0^2 R^2.
#[derive(Clone, Copy, Debug)]
pub struct Ellipse {
    pub axes: [f64; 2],
    pub rate: f64,
    pub pressure: f64,
}

/// Elliptic drop after A0 t: the equations by the classical Runge-Kutta method; its error is of 1e-12.
pub fn ellipse(time: f64) -> Ellipse {
    let slope =
        |[a, b, rate]: [f64; 3]| [rate * a, -rate * b, rate * rate * (b * b - a * a) / (a * a + b * b)];
    let (mut y, steps) = ([1.0, 1.0, 1.0], 1000);
    let dt = time / f64::from(steps);
    for _ in 0..steps {
        let moved = |by: [f64; 3], dt: f64| std::array::from_fn(|d| y[d] + dt * by[d]);
        let k1 = slope(y);
        let k2 = slope(moved(k1, 0.5 * dt));
        let k3 = slope(moved(k2, 0.5 * dt));
        let k4 = slope(moved(k3, dt));
        y = std::array::from_fn(|d| y[d] + dt / 6.0 * (k1[d] + 2.0 * k2[d] + 2.0 * k3[d] + k4[d]));
    }
    let [a, b, rate] = y;
    Ellipse { axes: [a, b], rate, pressure: (rate * a * b).powi(2) / (a * a + b * b) }
}

impl Ellipse {
    /// Kinetic energy over that at the start.
    pub fn energy(self) -> f64 {
        let [a, b] = self.axes;
        0.5 * self.rate.powi(2) * (a * a + b * b)
    }
}

/// Drop under surface tension.
#[derive(Clone, Copy, Debug)]
pub struct Drop {
    /// 2 or 3.
    pub dimensions: usize,
    /// Radius R, m.
    pub radius: f64,
    /// Surface tension sigma, N/m.
    pub tension: f64,
    /// Density rho, kg/m^3.
    pub density: f64,
}

impl Drop {
    /// Pressure at rest, Pa.
    pub fn pressure(&self) -> f64 {
        (self.dimensions as f64 - 1.0) * self.tension / self.radius
    }
    /// Period of the mode 2, s.
    pub fn period(&self) -> f64 {
        let factor = if self.dimensions == 2 { 6.0 } else { 8.0 };
        2.0 * PI / (factor * self.tension / (self.density * self.radius.powi(3))).sqrt()
    }
    /// Rate of decay of the mode 2 with the kinematic viscosity `nu`, 1/s.
    pub fn decay(&self, nu: f64) -> f64 {
        let factor = if self.dimensions == 2 { 4.0 } else { 5.0 };
        factor * nu / self.radius.powi(2)
    }
}

/// Pressure at the end of a cubic drop of 10 mm, cells of 1 mm, eight particles a cell, over 2 sigma / R, and its root-mean-square error
/// \[Zhang2017b\]: an incompressible material point method.
pub const CUBE: [f64; 2] = [1.0091, 1.06e-2];
