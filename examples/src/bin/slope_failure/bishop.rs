//! Limit equilibrium of a slope by Bishop's simplified method of slices \[Bishop1955\], independent of particle methods.
//!
//! A mass above a circle of radius R, in slices of width b and weight W on bases inclined by alpha towards the toe, slides when its
//! strength, c and tan(phi) over the factor of safety F, is exceeded:
//!
//! F = sum \[c b + W tan(phi)\] / m / sum W sin(alpha), m = cos(alpha) + sin(alpha) tan(phi) / F.
//!
//! The factor of safety of the slope is the smallest F of all circles from crest to toe.

use crate::setup::{BASE, CREST, HEIGHT, SHOULDER, TOE};

/// Number of slices of a mass.
const SLICES: usize = 80;

/// Mohr-Coulomb strength: cohesion, Pa, and tan(phi).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    pub cohesion: f64,
    pub tangent: f64,
}

/// Slip circle through two points of the surface, and its factor of safety.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Exit points on the crest and before the toe, m.
    pub ends: [f64; 2],
    pub centre: [f64; 2],
    pub radius: f64,
    pub factor: f64,
}

impl Circle {
    /// Return the height of the slip surface at x, m, if it is below the ground.
    pub fn height(&self, x: f64) -> Option<f64> {
        let across = x - self.centre[0];
        let inside = x > self.ends[0] && x < self.ends[1];
        inside.then(|| self.centre[1] - (self.radius * self.radius - across * across).max(0.0).sqrt())
    }
}

/// Return the height of the ground at x, m.
pub fn surface(x: f64) -> f64 {
    HEIGHT * ((TOE - x) / (TOE - SHOULDER)).clamp(0.0, 1.0)
}

/// Return the circle through two surface points with an arc of sag `sag` below its chord, m.
fn circle(ends: [f64; 2], sag: f64) -> Option<Circle> {
    let [a, b] = ends.map(|x| [x, surface(x)]);
    let (along, up) = (b[0] - a[0], b[1] - a[1]);
    let length = along.hypot(up);
    let radius = (0.25 * length * length + sag * sag) / (2.0 * sag);
    let rise = radius - sag;
    let centre = [0.5 * (a[0] + b[0]) - rise * up / length, 0.5 * (a[1] + b[1]) + rise * along / length];
    // The slip surface must neither overhang nor leave the model.
    let hangs = [a, b].iter().any(|p| p[1] > centre[1]);
    (!hangs && centre[1] - radius > BASE).then_some(Circle { ends, centre, radius, factor: f64::INFINITY })
}

/// Return the factor of safety of a circle for a soil of this strength and weight, N/m^3.
fn factor(circle: &Circle, strength: &Strength, weight: f64) -> f64 {
    let width = (circle.ends[1] - circle.ends[0]) / SLICES as f64;
    let mut slices = [[0.0; 3]; SLICES];
    let mut driving = 0.0;
    for (n, slice) in slices.iter_mut().enumerate() {
        let x = circle.ends[0] + (n as f64 + 0.5) * width;
        let Some(base) = circle.height(x) else { continue };
        let load = weight * width * (surface(x) - base).max(0.0);
        let sine = (circle.centre[0] - x) / circle.radius;
        *slice = [load, sine, (1.0 - sine * sine).max(0.0).sqrt()];
        driving += load * sine;
    }
    if driving <= 0.0 {
        return f64::INFINITY;
    }
    let mut factor = 1.0;
    for _ in 0..50 {
        let held = |[load, sine, cosine]: &[f64; 3]| {
            let m = cosine + sine * strength.tangent / factor;
            // At a steep toe m tends to zero; the bound avoids a division by zero, and such circles are not critical.
            (strength.cohesion * width + load * strength.tangent) / m.max(0.1)
        };
        let next = slices.iter().map(held).sum::<f64>() / driving;
        let done = (next - factor).abs() < 1e-6;
        factor = next;
        if done {
            break;
        }
    }
    factor
}

/// Return the circle with the smallest factor of safety.
pub fn critical(strength: &Strength, weight: f64) -> Circle {
    // Search variables: exit points of the circle, and its sag over the chord length.
    let mut low = [CREST + 2.0, SHOULDER + 5.0, 0.05];
    let mut high = [SHOULDER - 0.5, TOE + 15.0, 0.5];
    let mut best: Option<([f64; 3], Circle)> = None;
    for _ in 0..6 {
        for n in 0..17 * 17 * 17 {
            let part = [n % 17, n / 17 % 17, n / 289].map(|k| f64::from(k) / 16.0);
            let [a, b, sag] = [0, 1, 2].map(|d| low[d] + part[d] * (high[d] - low[d]));
            let length = (b - a).hypot(surface(a) - surface(b));
            let Some(mut c) = circle([a, b], sag * length) else { continue };
            c.factor = factor(&c, strength, weight);
            if best.is_none_or(|(_, found)| c.factor < found.factor) {
                best = Some(([a, b, sag], c));
            }
        }
        let Some((at, _)) = best else { break };
        for d in 0..3 {
            let reach = 0.2 * (high[d] - low[d]);
            (low[d], high[d]) = (at[d] - reach, at[d] + reach);
        }
        low[0] = low[0].max(CREST + 0.1);
        high[0] = high[0].min(SHOULDER);
        low[2] = low[2].max(0.01);
    }
    best.map_or(
        Circle { ends: [SHOULDER, TOE], centre: [0.0; 2], radius: 0.0, factor: f64::NAN },
        |(_, circle)| circle,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_friction_the_factor_is_that_of_moments() {
        // phi = 0: F = c R (arc length) / sum W (arm), exact for a circle.
        let strength = Strength { cohesion: 50e3, tangent: 0.0 };
        let c = circle([20.0, 55.0], 8.0).expect("a circle");
        let found = factor(&c, &strength, 20e3);
        let [a, b] = c.ends.map(|x| ((x - c.centre[0]) / c.radius).asin());
        let steps = 20_000;
        let width = (c.ends[1] - c.ends[0]) / f64::from(steps);
        let moment: f64 = (0..steps)
            .map(|n| c.ends[0] + (f64::from(n) + 0.5) * width)
            .map(|x| 20e3 * width * (surface(x) - c.height(x).expect("inside")).max(0.0) * (c.centre[0] - x))
            .sum();
        let exact = 50e3 * c.radius * c.radius * (b - a) / moment;
        assert!((found / exact - 1.0).abs() < 5e-3, "{found} for {exact}");
    }

    #[test]
    fn frictionless_and_steep_the_chart_of_taylor_is_met() {
        // Stability number c/(gamma H F) of 1 : 1 slopes without friction: 0.164 for toe circles, at most 0.181 for deep circles (Taylor
        // 1937 [M]); circles here reach at most 15 m below the toe, three quarters of the height.
        let found = critical(&Strength { cohesion: 50e3, tangent: 0.0 }, 20e3);
        let number = 50e3 / (20e3 * HEIGHT * found.factor);
        assert!((0.160..0.185).contains(&number), "{number}");
    }
}
