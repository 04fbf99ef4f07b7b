//! Outer surface of a ring, and closest approach of two surfaces.
//!
//! Particles are inside the matter. The surface point next to a particle, x + F (X_s - X), follows from its initial position X, its
//! deformation gradient F and the point X_s of the initial circle in the direction of X. The points of one ring in order of angle form a
//! polygon; the closest approach is the smallest distance of a point of one polygon from the other, negative for penetration.

use std::f64::consts::FRAC_PI_2;

use mpm_core::Body;
use mpm_core::geometry::Seeds;

use crate::scene::OUTER;

/// Surface particles of a ring on the side of the other ring.
#[derive(Clone, Debug)]
pub struct Surface {
    /// For each particle: index in the polygon, and vector from it to the circle in the undeformed ring, m.
    next_to: Vec<Option<(usize, [f64; 2])>>,
    length: usize,
}

impl Surface {
    /// Select the half of a ring about `centre` (m) in the direction `side` (+1 or -1) along x, with particles of size `particle`, m.
    pub fn new(seeds: &Seeds<2>, centre: [f64; 2], side: f64, particle: f64) -> Surface {
        let mut angles: Vec<(f64, usize)> = Vec::new();
        let mut next_to = vec![None; seeds.len()];
        for (number, x) in seeds.positions.iter().enumerate() {
            let [u, v] = [x[0] - centre[0], x[1] - centre[1]];
            let radius = u.hypot(v);
            // The outside is to the right of the polygon's direction for both rings.
            let angle = side * v.atan2(side * u);
            if radius > OUTER - particle && angle.abs() < FRAC_PI_2 {
                let out = OUTER / radius - 1.0;
                next_to[number] = Some((0, [u * out, v * out]));
                angles.push((angle, number));
            }
        }
        angles.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (place, &(_, number)) in angles.iter().enumerate() {
            if let Some(entry) = &mut next_to[number] {
                entry.0 = place;
            }
        }
        Surface { next_to, length: angles.len() }
    }

    /// Return the current polygon, m. `body` stores its deformation gradient.
    pub fn now(&self, body: &dyn Body) -> Vec<[f64; 2]> {
        let names = body.state_names();
        let at = |name: &str| names.iter().position(|n| n == name);
        let f = ["deformation_xx", "deformation_xy", "deformation_yx", "deformation_yy"].map(at);
        let mut polygon = vec![[f64::NAN; 2]; self.length];
        body.for_each(&mut |p| {
            if let Some((place, [u, v])) = self.next_to[p.number] {
                let [xx, xy, yx, yy] = f.map(|i| i.map_or(f64::NAN, |i| p.state[i]));
                polygon[place] = [p.position[0] + xx * u + xy * v, p.position[1] + yx * u + yy * v];
            }
        });
        polygon
    }
}

/// Return the smallest signed distance between two polygons whose outside is on the right, m.
pub fn closest(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let least = |points: &[[f64; 2]], line: &[[f64; 2]]| {
        points.iter().map(|p| distance(p, line)).fold(f64::INFINITY, f64::min)
    };
    least(a, b).min(least(b, a))
}

/// Return the signed distance of a point from a polygon, m.
fn distance(p: &[f64; 2], line: &[[f64; 2]]) -> f64 {
    let (mut least, mut sign) = (f64::INFINITY, 1.0);
    for edge in line.windows(2) {
        let [a, b] = [edge[0], edge[1]];
        let (e, w) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        let part = ((w[0] * e[0] + w[1] * e[1]) / (e[0] * e[0] + e[1] * e[1])).clamp(0.0, 1.0);
        let d = (w[0] - part * e[0]).hypot(w[1] - part * e[1]);
        if d < least {
            least = d;
            sign = if e[0] * w[1] - e[1] * w[0] <= 0.0 { 1.0 } else { -1.0 };
        }
    }
    sign * least
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outside_is_positive_and_inside_negative() {
        // Two arcs of the unit circle that face each other along x.
        let arc = |centre: f64, side: f64| -> Vec<[f64; 2]> {
            let at = |a: f64| [centre + side * a.cos(), side * a.sin()];
            (-150..=150).map(|i| at(0.01 * f64::from(i))).collect()
        };
        for gap in [0.3, 0.01, -0.05] {
            let (left, right) = (arc(0.0, 1.0), arc(2.0 + gap, -1.0));
            assert!((closest(&left, &right) - gap).abs() < 1e-4, "{} of {gap}", closest(&left, &right));
        }
    }
}
