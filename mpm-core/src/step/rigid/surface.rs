//! Surfaces of rigid bodies.

use nalgebra::Vector3;

/// Largest deviation from a ball of the centres of the outermost particles, over the half size of a particle.
const ROUND: f64 = 0.3;
/// Surface of a body, from its particles, in the initial frame about its centre of mass.
#[derive(Clone, Debug)]
pub(in crate::step) struct Surface {
    /// Centres of particles, m.
    pub(in crate::step) points: Vec<Vector3<f64>>,
    /// Indices of particles in corners of the body: those are boxes, all others are round.
    pub(in crate::step) corners: Vec<usize>,
    /// Centre of the bounding box of the points, m.
    pub(in crate::step) middle: Vector3<f64>,
    pub(in crate::step) half: Vector3<f64>,
    /// Largest distance of a point of the surface from the centre of mass, m.
    pub(in crate::step) reach: f64,
    /// Symmetry planes that cut the body, by axis, m.
    pub(in crate::step) cuts: [Option<f64>; 3],
    /// Centre and radius, m, of a body that is a ball, or half of one.
    pub(in crate::step) ball: Option<(Vector3<f64>, f64)>,
}

impl Surface {
    /// Create the surface of particles with these centres, m, and half sizes, m, in `dimension` dimensions; around an axis
    /// with `hoop`.
    pub(in crate::step) fn new(
        points: Vec<Vector3<f64>>,
        half: Vector3<f64>,
        (dimension, hoop): (usize, bool),
    ) -> Self {
        let reach = points.iter().map(|x| x.norm()).fold(0.0, f64::max) + half.norm();
        let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        for x in &points {
            (low, high) = (low.inf(x), high.sup(x));
        }
        let outermost =
            |x: &Vector3<f64>| (0..dimension).all(|d| (x[d] - low[d]).min(high[d] - x[d]) <= 1e-6 * half[d]);
        let corners = (0..points.len()).filter(|&p| outermost(&points[p])).collect();
        let cuts = [hoop.then_some(0.0), None, None];
        let middle = (low + high) * 0.5;
        let mut surface = Surface { points, corners, middle, half, reach, cuts, ball: None };
        surface.ball = surface.as_ball(dimension);
        surface
    }

    /// Return centre and radius if the body, with its images, is a ball: the outermost points are equally far in all
    /// directions.
    pub(in crate::step) fn as_ball(&self, dimension: usize) -> Option<(Vector3<f64>, f64)> {
        let centre = Vector3::from(self.cuts.map(Option::unwrap_or_default));
        let (mut least, mut most, mut mean) = (f64::INFINITY, 0.0f64, 0.0);
        let golden = std::f64::consts::PI * (3.0 - 5.0f64.sqrt());
        let count = if dimension == 2 { 64 } else { 256 };
        for n in 0..count {
            let part = (f64::from(n) + 0.5) / f64::from(count);
            let mut direction = if dimension == 2 {
                let angle = part * std::f64::consts::TAU;
                Vector3::new(angle.cos(), angle.sin(), 0.0)
            } else {
                let (z, angle) = (1.0 - 2.0 * part, golden * f64::from(n));
                let r = (1.0 - z * z).sqrt();
                Vector3::new(r * angle.cos(), r * angle.sin(), z)
            };
            let seen = |x: &Vector3<f64>| {
                let mut x = x - centre;
                for d in (0..3).filter(|&d| self.cuts[d].is_some()) {
                    x[d] = x[d].abs();
                }
                x
            };
            for d in (0..3).filter(|&d| self.cuts[d].is_some()) {
                direction[d] = direction[d].abs();
            }
            let far = self.points.iter().map(|x| direction.dot(&seen(x))).fold(f64::NEG_INFINITY, f64::max);
            (least, most, mean) = (least.min(far), most.max(far), mean + far / f64::from(count));
        }
        let half = self.half.iter().take(dimension).copied().fold(f64::INFINITY, f64::min);
        (most - least <= ROUND * half).then_some((centre, mean + half))
    }

    /// Return the extents of particles from their centres along a direction in their frame, m: in corners, and elsewhere.
    pub(in crate::step) fn reaches(&self, n: &Vector3<f64>) -> [f64; 2] {
        let along = self.half.component_mul(n);
        [along.iter().map(|x| x.abs()).sum(), along.norm()]
    }
}
