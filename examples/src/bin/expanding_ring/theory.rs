//! Theory of a thin ring, in which only the hoop stress sigma acts: rho r'' = -sigma / r.

use crate::setup::{Metal, POISSON};

/// Radius and time of a ring at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Radius, m.
    pub radius: f64,
    /// Time, s.
    pub time: f64,
}

/// Compute the rest of a rigid, perfectly plastic ring: r_f = r0 exp(rho v^2 / (2 Y)), since the kinetic energy rho v^2 / 2
/// goes into Y ln(r / r0); the time is the integral of dr / sqrt(v^2 - (2 Y / rho) ln(r / r0)).
pub fn rigid(metal: &Metal, radius: f64) -> Rest {
    // Integrate over the speed w: ln(r / r0) = rho (v^2 - w^2) / (2 Y), and dt = -(rho / Y) r dw.
    const STEPS: usize = 20_000;
    let stretch = |w: f64| metal.density * (metal.speed * metal.speed - w * w) / (2.0 * metal.yields);
    let dw = metal.speed / STEPS as f64;
    let middle = |n: usize| radius * stretch((n as f64 + 0.5) * dw).exp();
    let time = (0..STEPS).map(middle).sum::<f64>() * dw * metal.density / metal.yields;
    Rest { radius: radius * stretch(0.0).exp(), time }
}

/// Compute the rest of an elastic, perfectly plastic ring: sigma = E eps up to Y, with the strain eps = ln(r / r0) less the
/// plastic strain; the section follows the volume ratio exp((1 - 2 nu) sigma / E). Midpoint rule.
pub fn elastic(metal: &Metal, radius: f64) -> Rest {
    let (from, to) = course(metal, radius);
    let part = from[2] / (from[2] - to[2]);
    let time = part * (to[0] - from[0]);
    Rest { radius: from[1] + 0.5 * time * from[2], time: from[0] + time }
}

/// Integrate the elastic ring: last time at which it moves outwards, s, radius, m, and speed, m/s, and those a step later.
fn course(metal: &Metal, radius: f64) -> ([f64; 3], [f64; 3]) {
    const STEPS: f64 = 200_000.0;
    let dt = rigid(metal, radius).time / STEPS;
    let pull = |r: f64, plastic: f64| {
        let sigma = (metal.young * ((r / radius).ln() - plastic)).min(metal.yields);
        -sigma * ((1.0 - 2.0 * POISSON) * sigma / metal.young).exp() / (metal.density * r)
    };
    let (mut now, mut plastic) = ([0.0, radius, metal.speed], 0.0);
    loop {
        let [t, r, v] = now;
        let half = [r + 0.5 * dt * v, v + 0.5 * dt * pull(r, plastic)];
        let next = [t + dt, r + dt * half[1], v + dt * pull(half[0], plastic)];
        if next[2] <= 0.0 {
            return (now, next);
        }
        now = next;
        plastic = f64::max(plastic, (now[1] / radius).ln() - metal.yields / metal.young);
    }
}

/// Mean length of fragments by Mott, m, at the hoop rate v / r, 1/s: 1.5 sqrt(2 Y / (rho g)) / rate \[M\].
pub fn mott(metal: &Metal, scatter: f64, rate: f64) -> f64 {
    1.5 * (2.0 * metal.yields / (metal.density * scatter)).sqrt() / rate
}
