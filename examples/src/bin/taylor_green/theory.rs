//! Exact viscous flows.

use std::f64::consts::PI;

/// Taylor-Green vortices of unit speed and period \[TaylorGreen1937\]; they decay by exp(-2 nu k^2 t) with k = 2 pi.
pub fn vortices([x, y]: [f64; 2]) -> [f64; 2] {
    let k = 2.0 * PI;
    [(k * x).sin() * (k * y).cos(), -(k * x).cos() * (k * y).sin()]
}

/// Amplitude of the vortices at nu t, for a unit period.
pub fn amplitude(time: f64) -> f64 {
    (-8.0 * PI * PI * time).exp()
}

/// Speed of a channel flow from rest over its final maximum at y / H and nu t / H^2, by a constant pressure gradient (Poiseuille).
pub fn poiseuille(y: f64, time: f64) -> f64 {
    let term = |m: u32| {
        let n = f64::from(2 * m + 1) * PI;
        32.0 / n.powi(3) * (n * y).sin() * (-n * n * time).exp()
    };
    4.0 * y * (1.0 - y) - (0..TERMS).map(term).sum::<f64>()
}

/// Speed of a channel flow from rest over that of its upper wall at y / H and nu t / H^2 (Couette).
pub fn couette(y: f64, time: f64) -> f64 {
    let term = |n: u32| {
        let sign = if n.is_multiple_of(2) { 1.0 } else { -1.0 };
        let n = f64::from(n) * PI;
        2.0 * sign / n * (n * y).sin() * (-n * n * time).exp()
    };
    y + (1..TERMS).map(term).sum::<f64>()
}

/// Terms of the series: exact to rounding from nu t / H^2 = 0.01 on.
const TERMS: u32 = 40;
