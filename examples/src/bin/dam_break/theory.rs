//! References of a dam break.
//!
//! **Release.** A column of width a and height H between a wall, a floor and a face that has just been released. Pressure is zero at the face and
//! the top, its gradient is that of hydrostatics at the floor and zero at the wall, and it is harmonic:
//! ```text
//! p = rho g [H - y - sum over odd n of 8 H / (n pi)^2 cos(k y) cosh(k x) / cosh(k a)],    k = n pi / (2 H)
//! ```
//! with x from the wall and y from the floor. At the corner, and for the force on the wall, the sum has cosh(k x) = 1 and converges as exp(-k a).
//!
//! **Shallow flow.** Depth over a dry bed, of a reservoir of depth H left of x = 0 \[Ritter1892\]: h = (2 c - x/t)^2 / (9 g) with c = sqrt(g H),
//! between x = -c t and 2 c t. A depth of s^2 H moves with (2 - 3 s) c; the discharge at the dam is 8/27 H c, the depth there 4/9 H.

use std::f64::consts::PI;

/// Terms of the series; the last one is of 1e-16 a quarter of the width from the face for a = H / 2.
const TERMS: u32 = 100;

/// Column at its release: width over height, lengths over the height.
#[derive(Clone, Copy, Debug)]
pub struct Release {
    pub width: f64,
}

impl Release {
    /// Sum over odd n of 8 / (n pi)^2 f(k) cosh(k x) / cosh(k a).
    fn sum(self, x: f64, of: impl Fn(f64) -> f64) -> f64 {
        let term = |m: u32| {
            let n = f64::from(2 * m + 1);
            let k = 0.5 * n * PI;
            // cosh(k x) / cosh(k a) without overflow.
            let decay = (k * (x - self.width)).exp() * (1.0 + (-2.0 * k * x).exp())
                / (1.0 + (-2.0 * k * self.width).exp());
            8.0 / (n * PI).powi(2) * of(k) * decay
        };
        (0..TERMS).map(term).sum()
    }
    /// Pressure over rho g H.
    pub fn pressure(self, [x, y]: [f64; 2]) -> f64 {
        1.0 - y - self.sum(x, |k| (k * y).cos())
    }
    /// Force on the wall over rho g H^2 / 2.
    pub fn force(self) -> f64 {
        1.0 - 2.0 * self.sum(0.0, |k| k.sin() / k)
    }
}

/// Depth over H in shallow flow at x / (c t).
pub fn depth(place: f64) -> f64 {
    match place {
        x if x <= -1.0 => 1.0,
        x if x >= 2.0 => 0.0,
        x => (2.0 - x).powi(2) / 9.0,
    }
}

/// Speed over c of the place where the depth is `depth` H.
pub fn speed(depth: f64) -> f64 {
    2.0 - 3.0 * depth.sqrt()
}

/// Discharge at the dam over H c.
pub const DISCHARGE: f64 = 8.0 / 27.0;

/// Experiment in a tank 3.22 m long, a column 1.2 m long and 0.6 m high, pressure at 160 mm on the far wall: times t sqrt(g / H), pressures over
/// rho g H \[Buchner2002\], as digitised by a public code \[V\].
pub const WALL: [[f64; 2]; 24] = [
    [2.168, 0.011],
    [2.272, 0.010],
    [2.426, -0.015],
    [2.473, 0.077],
    [2.491, 0.154],
    [2.553, 0.265],
    [2.616, 0.371],
    [2.623, 0.463],
    [2.650, 0.562],
    [2.672, 0.605],
    [2.689, 0.662],
    [2.774, 0.687],
    [2.903, 0.661],
    [3.022, 0.643],
    [3.132, 0.579],
    [3.231, 0.546],
    [3.520, 0.545],
    [3.905, 0.544],
    [4.223, 0.558],
    [4.453, 0.551],
    [4.720, 0.538],
    [4.917, 0.513],
    [5.159, 0.514],
    [5.304, 0.526],
];
