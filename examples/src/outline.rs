//! Outline of a body of elements in the plane, and depth of points in it.

use std::collections::BTreeMap;

use mpm_core::scene::Body;

/// Present outline of a body of elements in the plane: edges of a single element, with the body on their left.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    edges: Vec<[[f64; 2]; 2]>,
    low: [f64; 2],
    high: [f64; 2],
    /// True if x = 0 is a line of symmetry, which is no surface.
    symmetric: bool,
}

impl Outline {
    /// Build the outline of a body of elements. Edges on a line of symmetry x = 0 are no surface.
    pub fn of(body: &dyn Body, symmetric: bool) -> Self {
        // Elements share nodes, so that their coordinates are equal bit by bit.
        let mut seen: BTreeMap<[u64; 4], ([[f64; 2]; 2], u32)> = BTreeMap::new();
        body.for_each(&mut |element| {
            let corners = &element.corners;
            for (n, a) in corners.iter().enumerate() {
                let b = corners[(n + 1) % corners.len()];
                let edge = [[a[0], a[1]], [b[0], b[1]]];
                let mut ends = edge.map(|x| x.map(f64::to_bits));
                ends.sort_unstable();
                let [[p, q], [r, s]] = ends;
                seen.entry([p, q, r, s]).or_insert((edge, 0)).1 += 1;
            }
        });
        let edges: Vec<_> =
            seen.into_values().filter(|(_, times)| *times == 1).map(|(edge, _)| edge).collect();
        let ends = || edges.iter().flatten();
        let low = [0, 1].map(|d| ends().map(|x| x[d]).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|d| ends().map(|x| x[d]).fold(f64::NEG_INFINITY, f64::max));
        Outline { edges, low, high, symmetric }
    }

    /// Build the outline of a polygon, its corners anticlockwise.
    pub fn polygon(corners: &[[f64; 2]]) -> Self {
        let edges = (0..corners.len()).map(|n| [corners[n], corners[(n + 1) % corners.len()]]).collect();
        let low = [0, 1].map(|d| corners.iter().map(|x| x[d]).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|d| corners.iter().map(|x| x[d]).fold(f64::NEG_INFINITY, f64::max));
        Outline { edges, low, high, symmetric: false }
    }

    /// Return the depth of a point inside, m: distance from the surface, negative outside; an upper bound if the point is
    /// more than `near`, m, outside.
    pub fn depth(&self, x: [f64; 2], near: f64) -> f64 {
        let apart = [0, 1].map(|d| (self.low[d] - x[d]).max(x[d] - self.high[d]).max(0.0));
        let apart = apart[0].hypot(apart[1]);
        if apart > near {
            return -apart;
        }
        let surface = self.edges.iter().filter(|edge| !(self.symmetric && edge.iter().all(|x| x[0] == 0.0)));
        let distance = surface.map(|edge| distance(edge, x)).fold(f64::INFINITY, f64::min);
        if self.holds(x) { distance } else { -distance }
    }

    /// True if a point is inside: a line to the right crosses an odd number of edges.
    fn holds(&self, x: [f64; 2]) -> bool {
        let crosses = |[a, b]: &&[[f64; 2]; 2]| {
            (a[1] > x[1]) != (b[1] > x[1]) && x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        };
        self.edges.iter().filter(crosses).count() % 2 == 1
    }
}

/// Return the distance from an edge to a point, m.
fn distance([a, b]: &[[f64; 2]; 2], x: [f64; 2]) -> f64 {
    let [along, to] = [[b[0] - a[0], b[1] - a[1]], [x[0] - a[0], x[1] - a[1]]];
    let square = along[0] * along[0] + along[1] * along[1];
    let part = ((along[0] * to[0] + along[1] * to[1]) / square).clamp(0.0, 1.0);
    (to[0] - part * along[0]).hypot(to[1] - part * along[1])
}

/// Penetration of particles into a body of elements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inside {
    /// Number of particles with their centre inside.
    pub count: usize,
    /// Depth of the deepest centre, m; if none is inside, the negative distance of the nearest one.
    pub deepest: f64,
}

impl Inside {
    /// Measure the penetration of particles into an outline; beyond `near`, m, distances are bounds only.
    pub fn of(particles: &dyn Body, outline: &Outline, near: f64) -> Self {
        let mut inside = Inside { count: 0, deepest: f64::NEG_INFINITY };
        particles.for_each(&mut |p| {
            let depth = outline.depth([p.position[0], p.position[1]], near);
            inside.count += usize::from(depth > 0.0);
            inside.deepest = inside.deepest.max(depth);
        });
        inside
    }
}

#[cfg(test)]
mod tests {
    use fem::{Fem, MeshBody};
    use mpm_core::PlaneStrain;
    use mpm_core::geometry::{Cuboid, structured::box_mesh};
    use mpm_materials::{LinearElastic, Moduli};

    use super::*;

    #[test]
    fn depths_of_a_block_are_those_of_its_sides() {
        let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.0).expect("moduli")).expect("law");
        let mesh = box_mesh(&Cuboid::new([0.0; 2], [2.0, 1.0]).expect("cuboid"), [4, 3]).expect("mesh");
        let mut fem = Fem::new(PlaneStrain);
        fem.add(MeshBody::new("block", mesh, law)).expect("body");
        let outline = |symmetric| Outline::of(fem.body(0), symmetric);
        assert_eq!(outline(false).edges.len(), 2 * (4 + 3));
        for (x, depth, halved) in [
            ([0.1, 0.5], 0.1, 0.5),
            ([1.0, 0.3], 0.3, 0.3),
            ([1.9, 0.9], 0.1, 0.1),
            ([1.0, 1.25], -0.25, -0.25),
            ([2.3, 1.4], -0.5, -0.5),
        ] {
            for (symmetric, depth) in [(false, depth), (true, halved)] {
                let found: f64 = outline(symmetric).depth(x, 1.0);
                assert!((found - depth).abs() < 1e-12, "{x:?}: {found}");
            }
        }
        assert!(outline(false).depth([9.0, 0.5], 1.0) <= -1.0, "a bound");
        let polygon = Outline::polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]);
        for x in [[0.1, 0.5], [1.9, 0.9], [1.0, 1.25], [2.3, 1.4]] {
            assert!((polygon.depth(x, 1.0) - outline(false).depth(x, 1.0)).abs() < 1e-12, "{x:?}");
        }
    }
}
