//! Outline of the bar from particles and their initial positions.
//!
//! Particles are inside the matter, half a particle below its surface, and a surface drawn around them would depend on their spacing. Their
//! initial depths below the undeformed surface are known, however. For each layer of particles (same height z0 in the undeformed bar)
//! straight lines over the depth R - r0 are fitted to the deformed radius and height of the particles next to the surface, and evaluated at
//! depth 0: the outline. Foot and top end are evaluated on a parabola through the three layers next to them, at z0 = 0 and z0 = L.

use mpm_core::geometry::Seeds;
use mpm_core::observe::RunView;

use crate::scene::{LENGTH, RADIUS};

/// Depth below the surface, in cells, up to which particles are fitted.
const DEPTH: f64 = 2.2;
/// Height of the second diameter over the initial length.
pub const WAIST: f64 = 0.2;

/// Circle of the undeformed surface after deformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Initial height, m.
    pub start: f64,
    /// Radius, m.
    pub radius: f64,
    /// Height above the wall, m.
    pub height: f64,
}

/// Deformed mantle of the bar, from foot to top.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline(pub Vec<Ring>);

/// Sizes for comparison with experiment, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Length, from the foot to the top end.
    pub length: f64,
    /// Diameter of the foot.
    pub foot: f64,
    /// Diameter at the height of 0.2 initial lengths above the foot.
    pub waist: f64,
}

/// Sums for the two linear fits of a layer.
#[derive(Clone, Copy, Default)]
struct Fit {
    count: f64,
    d: f64,
    dd: f64,
    r: f64,
    rd: f64,
    z: f64,
    zd: f64,
}

impl Fit {
    fn add(&mut self, d: f64, r: f64, z: f64) {
        self.count += 1.0;
        self.d += d;
        self.dd += d * d;
        self.r += r;
        self.rd += r * d;
        self.z += z;
        self.zd += z * d;
    }

    /// Return radius and height at the surface, d = 0.
    fn at_surface(&self) -> (f64, f64) {
        let det = self.count * self.dd - self.d * self.d;
        let at = |y: f64, yd: f64| (self.dd * y - self.d * yd) / det;
        (at(self.r, self.rd), at(self.z, self.zd))
    }
}

impl Outline {
    /// Return the current outline of a bar seeded with two particles per cell of edge `spacing` (m) along each axis.
    pub fn of<const D: usize>(now: &RunView<'_>, seeds: &Seeds<D>, spacing: f64) -> Outline {
        let step = 0.5 * spacing;
        let place = |x: &[f64]| if D == 3 { (x[0].hypot(x[1]), x[2]) } else { (x[0], x[1]) };
        let mut fits = vec![Fit::default(); (LENGTH / step).round() as usize];
        for body in now.bodies() {
            body.for_each(&mut |p| {
                let Some((r0, z0)) = seeds.positions.get(p.number).map(|x| place(x)) else { return };
                let depth = r0 - RADIUS;
                let layer = (z0 / step - 0.5).round() as usize;
                if let Some(fit) = fits.get_mut(layer)
                    && depth > -DEPTH * spacing
                {
                    let (r, z) = place(&p.position);
                    fit.add(depth, r, z);
                }
            });
        }
        let ring = |(layer, fit): (usize, &Fit)| {
            let (radius, height) = fit.at_surface();
            Ring { start: (layer as f64 + 0.5) * step, radius, height }
        };
        Outline(fits.iter().enumerate().map(ring).collect()).with_ends()
    }

    /// Extrapolate to both ends of the bar.
    fn with_ends(mut self) -> Outline {
        let n = self.0.len();
        if n >= 3 {
            let foot = continued([self.0[0], self.0[1], self.0[2]], 0.0);
            let top = continued([self.0[n - 1], self.0[n - 2], self.0[n - 3]], LENGTH);
            self.0.insert(0, foot);
            // The last layer may be up to half a particle edge above or below the end of the bar.
            self.0.retain(|ring| ring.start < LENGTH);
            self.0.push(top);
        }
        self
    }

    /// Return length and diameters; NaN for missing heights.
    pub fn sizes(&self) -> Sizes {
        let (Some(foot), Some(top)) = (self.0.first(), self.0.last()) else {
            return Sizes { length: f64::NAN, foot: f64::NAN, waist: f64::NAN };
        };
        let waist = self.radius_at(foot.height + WAIST * LENGTH);
        Sizes { length: top.height - foot.height, foot: 2.0 * foot.radius, waist: 2.0 * waist }
    }

    /// Interpolate the radius at a height, m.
    fn radius_at(&self, height: f64) -> f64 {
        for pair in self.0.windows(2) {
            let [low, high] = [pair[0], pair[1]];
            if low.height <= height && height < high.height {
                let part = (height - low.height) / (high.height - low.height);
                return low.radius + part * (high.radius - low.radius);
            }
        }
        f64::NAN
    }
}

/// Evaluate the parabola through three rings at another initial height.
fn continued(rings: [Ring; 3], start: f64) -> Ring {
    let weight = |i: usize| {
        let others = (0..3).filter(|j| *j != i);
        others.map(|j| (start - rings[j].start) / (rings[i].start - rings[j].start)).product::<f64>()
    };
    let w = [weight(0), weight(1), weight(2)];
    let sum = |of: fn(&Ring) -> f64| (0..3).map(|i| w[i] * of(&rings[i])).sum::<f64>();
    Ring { start, radius: sum(|r| r.radius), height: sum(|r| r.height) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_continued_exactly() {
        let f = |s: f64| Ring { start: s, radius: 1.0 - s + 0.5 * s * s, height: 2.0 * s };
        let end = continued([f(0.5), f(1.5), f(2.5)], 0.0);
        assert!((end.radius - 1.0).abs() < 1e-14 && end.height.abs() < 1e-14);
    }

    #[test]
    fn sizes_of_a_cone() {
        let ring = |i: usize| {
            let s = LENGTH * (i as f64 + 0.5) / 10.0;
            Ring { start: s, radius: RADIUS * (2.0 - s / LENGTH), height: 0.5 * s + 1.0e-4 }
        };
        let sizes = Outline((0..10).map(ring).collect()).with_ends().sizes();
        assert!((sizes.length - 0.5 * LENGTH).abs() < 1e-12);
        assert!((sizes.foot - 4.0 * RADIUS).abs() < 1e-12);
        assert!((sizes.waist - 2.0 * RADIUS * 1.6).abs() < 1e-12);
    }
}
