//! What contact knows of a body in a step, and of its surface from step to step.

use std::collections::HashMap;

use impactite_geometry::Facet;
use impactite_scene::SceneError;

use crate::vector::{difference, length, sum, times};

/// A body in one step: points of any method, and the facets of its surface if it has a mesh.
#[derive(Clone, Copy, Debug)]
pub struct ContactBody<'a, const D: usize> {
    pub(super) name: &'a str,
    pub(super) positions: &'a [[f64; D]],
    pub(super) velocities: &'a [[f64; D]],
    pub(super) masses: &'a [f64],
    pub(super) half_sizes: &'a [f64],
    pub(super) facets: &'a [Facet],
}

impl<'a, const D: usize> ContactBody<'a, D> {
    /// Points without facets, as particles of MPM, PCMM or SPH: positions at the start of the step, m; trial velocities, those that they
    /// would have at its end without contact, m/s; masses, kg, infinite where motion is prescribed (per metre of depth in plane strain,
    /// per radian in axisymmetric coordinates); half sizes, the distance of the surface from the centre, m.
    pub fn of_points(
        name: &'a str,
        positions: &'a [[f64; D]],
        velocities: &'a [[f64; D]],
        masses: &'a [f64],
        half_sizes: &'a [f64],
    ) -> Self {
        ContactBody { name, positions, velocities, masses, half_sizes, facets: &[] }
    }
    /// A mesh: its nodes as [`ContactBody::of_points`], without half sizes, and the facets of its surface, outward
    /// (`impactite_geometry::ElementKind::facets`): edges in two dimensions, triangles and quadrilaterals in three.
    pub fn of_mesh(
        name: &'a str,
        positions: &'a [[f64; D]],
        velocities: &'a [[f64; D]],
        masses: &'a [f64],
        facets: &'a [Facet],
    ) -> Self {
        ContactBody { name, positions, velocities, masses, half_sizes: &[], facets }
    }
    /// Give the nodes of a mesh half sizes, m, one a node: half the thickness of a shell, of which the facets are the middle surface for
    /// what they touch as points.
    #[must_use]
    pub fn with_half_sizes(mut self, half_sizes: &'a [f64]) -> Self {
        self.half_sizes = half_sizes;
        self
    }

    pub(super) fn half_size(&self, n: usize) -> f64 {
        self.half_sizes.get(n).copied().unwrap_or(0.0)
    }
    pub(super) fn position(&self, n: usize) -> [f64; 3] {
        wide(&self.positions[n])
    }

    /// Refuse what no contact can use.
    pub(super) fn check(&self) -> Result<(), SceneError> {
        let count = self.positions.len();
        let points_alone = self.facets.is_empty();
        let lengths = [
            ("trial velocities", self.velocities.len(), true),
            ("masses", self.masses.len(), true),
            ("half sizes", self.half_sizes.len(), points_alone || !self.half_sizes.is_empty()),
        ];
        for (field, found, needed) in lengths {
            if needed && found != count {
                return Err(SceneError::Length { field, found, particles: count });
            }
        }
        let refuse = |particle, field, value, allowed| {
            Err(SceneError::Seed { body: self.name.into(), particle, field, value, allowed })
        };
        for n in 0..count {
            let mass = self.masses[n];
            if mass.is_nan() || mass <= 0.0 {
                return refuse(n, "mass", mass, "positive, or infinite where motion is prescribed");
            }
            if let Some(v) = self.velocities[n].iter().find(|v| !v.is_finite()) {
                return refuse(n, "trial velocity", *v, "finite");
            }
            if let Some(x) = self.positions[n].iter().find(|x| !x.is_finite()) {
                return refuse(n, "position", *x, "finite");
            }
            if let Some(&half) = self.half_sizes.get(n) {
                let holds = half.is_finite() && (half > 0.0 || (half == 0.0 && !points_alone));
                if !holds {
                    return refuse(n, "half size", half, "positive and finite");
                }
            }
        }
        self.facets.iter().try_for_each(|facet| self.check_facet(facet))
    }

    fn check_facet(&self, facet: &Facet) -> Result<(), SceneError> {
        let parameter = |field, value, allowed| {
            Err(SceneError::Parameter { owner: "contact of meshes", field, value, allowed })
        };
        let nodes = facet.nodes();
        let fits = if D == 2 { nodes.len() == 2 } else { nodes.len() > 2 };
        if !fits {
            let allowed = "2 in two dimensions, 3 or 4 in three";
            return parameter("number of nodes of a facet", nodes.len() as f64, allowed);
        }
        match nodes.iter().find(|&&n| n as usize >= self.positions.len()) {
            Some(&n) => parameter("node of a facet", f64::from(n), "below the number of nodes"),
            None => Ok(()),
        }
    }
}

/// With a third component.
pub(super) fn wide<const D: usize>(x: &[f64; D]) -> [f64; 3] {
    let mut wide = [0.0; 3];
    wide[..D].copy_from_slice(x);
    wide
}

/// What of a body stays while its facets are the same.
#[derive(Clone, Debug, Default)]
pub(super) struct Surface {
    facets: Vec<Facet>,
    points: usize,
    /// The points that touch others: nodes of facets, or all without any.
    pub touching: Vec<u32>,
    /// Mean length of the edges at a node, m; empty without facets.
    edges: Vec<f64>,
    /// Does every edge have facets on both sides?
    pub closed: bool,
}

impl Surface {
    /// Look at a body again. Says whether it is another surface.
    pub fn update<const D: usize>(&mut self, body: &ContactBody<'_, D>) -> bool {
        if self.points == body.positions.len() && self.facets == body.facets && !self.touching.is_empty() {
            return false;
        }
        let count = body.positions.len();
        let (mut sums, mut ends) = (vec![0.0; count], vec![0.0; count]);
        let mut balance: HashMap<[u32; 2], i64> = HashMap::new();
        for facet in body.facets {
            let nodes = facet.nodes();
            // Of the two ends of an edge in the plane as of the edges of a facet in space: each must be left as often as entered.
            let edges = if nodes.len() == 2 { 1 } else { nodes.len() };
            for i in 0..edges {
                let (a, b) = (nodes[i], nodes[(i + 1) % nodes.len()]);
                let edge = length(difference(body.position(a as usize), body.position(b as usize)));
                for n in [a, b] {
                    sums[n as usize] += edge;
                    ends[n as usize] += 1.0;
                }
                if D == 2 {
                    *balance.entry([a, a]).or_default() += 1;
                    *balance.entry([b, b]).or_default() -= 1;
                } else {
                    *balance.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
                }
            }
        }
        let on_surface = |n: &u32| body.facets.is_empty() || ends[*n as usize] > 0.0;
        self.touching = (0..count as u32).filter(on_surface).collect();
        self.closed = !body.facets.is_empty() && balance.values().all(|&sum| sum == 0);
        let mean = |(sum, ends): (&f64, &f64)| if *ends > 0.0 { sum / ends } else { 0.0 };
        self.edges =
            if body.facets.is_empty() { Vec::new() } else { sums.iter().zip(&ends).map(mean).collect() };
        self.facets = body.facets.to_vec();
        self.points = count;
        true
    }

    /// Distance of a point to its neighbours, m: its diameter, or of a node without half size the mean edge at it.
    pub fn spacing<const D: usize>(&self, body: &ContactBody<'_, D>, n: usize) -> f64 {
        let half = body.half_size(n);
        if half > 0.0 { 2.0 * half } else { self.edges.get(n).copied().unwrap_or(0.0) }
    }
}

/// A sphere around a facet that moves and grows within the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    pub centre: [f64; 3],
    /// At the start, m.
    pub radius: f64,
    /// Mean velocity of the nodes, m/s.
    pub velocity: [f64; 3],
    /// How much faster or slower a node may be, m/s.
    pub spread: f64,
}

impl Sphere {
    pub fn of(corners: &[[f64; 3]], velocities: &[[f64; 3]]) -> Self {
        let mean = |all: &[[f64; 3]]| {
            times(all.iter().fold([0.0; 3], |total, x| sum(total, *x)), 1.0 / all.len() as f64)
        };
        let farthest = |all: &[[f64; 3]], from: [f64; 3]| {
            all.iter().map(|x| length(difference(*x, from))).fold(0.0, f64::max)
        };
        let (centre, velocity) = (mean(corners), mean(velocities));
        let (radius, spread) = (farthest(corners, centre), farthest(velocities, velocity));
        Sphere { centre, radius, velocity, spread }
    }
}
