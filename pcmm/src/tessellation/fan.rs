//! Triangles in the fans of particles, original formulation.

use super::{Limits, Revision, Tessellation, View, inspect, orient, sorted};
use crate::simplex::distance_squared;
use impactite_scene::SceneError;

/// Triangles of \[Feng2014\] section 2, original formulation (two dimensions).
///
/// The neighbours in contact with a particle are sorted by azimuth. Of two successive ones less than 30 degrees apart the farther is
/// dropped. Each remaining pair of successive neighbours forms a triangle with the particle if the three [`Limits`] hold. A triangle is
/// deleted when any of them fails.
///
/// Triangles of different fans may overlap. A square lattice whose diagonals are in contact is covered twice; its particles then have twice
/// their mass if masses come from the triangles, but wave speeds are correct all the same. Holes are not filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AzimuthFan {
    limits: Limits,
    apart: f64,
}

impl AzimuthFan {
    /// Create fans with the original limits and a contact tolerance delta, m (no value is published).
    ///
    /// # Errors
    /// A negative or non-finite tolerance.
    pub fn new(tolerance: f64) -> Result<Self, SceneError> {
        Ok(AzimuthFan { limits: Limits::printed(tolerance)?, apart: 30f64.to_radians() })
    }

    /// Return the neighbours of `a` that are left after pruning, by azimuth.
    fn spokes(&self, view: &View<'_, 2>, a: usize) -> Vec<u32> {
        let centre = &view.particles[a];
        let mut spokes: Vec<(f64, f64, u32)> = Vec::new();
        for &n in view.neighbours.of(a) {
            let other = &view.particles[n as usize];
            if self.limits.touch(centre, other) {
                let [x, y] = [0, 1].map(|d| other.position[d] - centre.position[d]);
                spokes.push((y.atan2(x), distance_squared(&other.position, &centre.position), n));
            }
        }
        spokes.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.2.cmp(&q.2)));
        // Rounding must not prune a neighbour that is just 30 degrees away, as on a triangular lattice of 12.
        let apart = self.apart * (1.0 - 1e-9);
        let mut k = 0;
        while spokes.len() > 1 && k < spokes.len() {
            let next = (k + 1) % spokes.len();
            let turn = (spokes[next].0 - spokes[k].0).rem_euclid(std::f64::consts::TAU);
            if turn < apart {
                // The next comparison is between the kept one and its new neighbour.
                spokes.remove(if spokes[next].1 >= spokes[k].1 { next } else { k });
                k = k.saturating_sub(1);
            } else {
                k += 1;
            }
        }
        spokes.into_iter().map(|s| s.2).collect()
    }
}

impl Tessellation<2> for AzimuthFan {
    const NAME: &'static str = "azimuth fans as printed";

    fn reach(&self) -> f64 {
        self.limits.tolerance()
    }

    fn revise(&self, view: &View<'_, 2>) -> Revision {
        const CHUNK: usize = 256;
        let mut revision = inspect(view, &self.limits, 1.0).failing;
        let particles = view.particles.len();
        let mut parts: Vec<Vec<([u32; 4], [u32; 3])>> = vec![Vec::new(); particles.div_ceil(CHUNK)];
        view.team.each(&mut parts, |chunk, found| {
            for a in chunk * CHUNK..((chunk + 1) * CHUNK).min(particles) {
                let spokes = self.spokes(view, a);
                for (k, &i) in spokes.iter().enumerate() {
                    let mut nodes = [a as u32, i, spokes[(k + 1) % spokes.len()]];
                    if nodes[1] == nodes[2] {
                        continue;
                    }
                    orient(view.particles, &mut nodes);
                    if self.limits.flaw(view.particles, &nodes).is_none() && !view.has(&nodes) {
                        found.push((sorted(&nodes), nodes));
                    }
                }
            }
        });
        let mut found = parts.concat();
        found.sort_unstable();
        found.dedup_by_key(|f| f.0);
        revision.born = found.into_iter().flat_map(|f| f.1).collect();
        revision
    }
}
