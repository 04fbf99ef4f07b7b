//! Bodies in a contact step, and surface data kept from step to step.

use std::collections::HashMap;

use impactite_geometry::Facet;
use impactite_scene::{Archive, CheckpointError, SceneError};

use super::closest::cross;
use crate::vector::{difference, length, sum, times, unit, wide};

/// Search margin beyond the gaps that close in the step, over the spacing of the points.
pub(super) const BESIDE: f64 = 0.1;

/// Body in one step: points of any method, and the facets of its surface if it has a mesh.
#[derive(Clone, Copy, Debug)]
pub struct ContactBody<'a, const D: usize> {
    pub(super) name: &'a str,
    pub(super) positions: &'a [[f64; D]],
    pub(super) velocities: &'a [[f64; D]],
    pub(super) masses: &'a [f64],
    pub(super) half_sizes: &'a [f64],
    pub(super) facets: &'a [Facet],
    pub(super) carriers: Option<Carriers<'a, D>>,
    pub(super) labels: &'a [u64],
}

/// Nodes that carry points, as those of a grid carry its particles: a point moves with v_p = sum_i N_ip v_i, and an impulse J on it is N_ip
/// J on node i. Points with common nodes are coupled, which the solution of all contacts takes into account.
#[derive(Clone, Copy, Debug)]
pub struct Carriers<'a, const D: usize> {
    /// Offsets of the weights of each point; one more than the number of points.
    pub starts: &'a [usize],
    /// Nodes of each point, every one once, with the weight in each direction.
    pub weights: &'a [(u32, [f64; D])],
    /// Trial velocities of the nodes, m/s.
    pub velocities: &'a [[f64; D]],
    /// Masses of the nodes, kg.
    pub masses: &'a [f64],
}

impl<'a, const D: usize> Carriers<'a, D> {
    /// Nodes and weights of a point.
    pub(super) fn of(&self, point: usize) -> &'a [(u32, [f64; D])] {
        &self.weights[self.starts[point]..self.starts[point + 1]]
    }

    /// Interpolate the velocities of all points, m/s, from those of the nodes.
    pub(super) fn carried(&self, nodes: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let velocity = |point| {
            let mut v = [0.0; 3];
            for (node, weight) in self.of(point) {
                (0..D).for_each(|d| v[d] += weight[d] * nodes[*node as usize][d]);
            }
            v
        };
        (0..self.starts.len() - 1).map(velocity).collect()
    }
}

impl<'a, const D: usize> ContactBody<'a, D> {
    /// Create a body of points without facets, such as particles of MPM, PCMM or SPH: positions at the start of the step, m; trial
    /// velocities, those at its end without contact, m/s; masses, kg, infinite for prescribed motion (per metre of depth in plane strain,
    /// per radian in axisymmetric coordinates); half sizes, the distance of the surface from the centre, m.
    pub fn of_points(
        name: &'a str,
        positions: &'a [[f64; D]],
        velocities: &'a [[f64; D]],
        masses: &'a [f64],
        half_sizes: &'a [f64],
    ) -> Self {
        ContactBody {
            name,
            positions,
            velocities,
            masses,
            half_sizes,
            facets: &[],
            carriers: None,
            labels: &[],
        }
    }
    /// Create a body of carried points without facets: like [`ContactBody::of_points`], with the velocities interpolated from their nodes,
    /// without masses of their own.
    pub fn of_carried_points(
        name: &'a str,
        positions: &'a [[f64; D]],
        velocities: &'a [[f64; D]],
        half_sizes: &'a [f64],
        carriers: Carriers<'a, D>,
    ) -> Self {
        let carriers = Some(carriers);
        ContactBody {
            name,
            positions,
            velocities,
            masses: &[],
            half_sizes,
            facets: &[],
            carriers,
            labels: &[],
        }
    }
    /// Create a mesh: nodes like [`ContactBody::of_points`], without half sizes, and the facets of its surface, outward
    /// (`impactite_geometry::ElementKind::facets`): edges in two dimensions, triangles and quadrilaterals in three.
    pub fn of_mesh(
        name: &'a str,
        positions: &'a [[f64; D]],
        velocities: &'a [[f64; D]],
        masses: &'a [f64],
        facets: &'a [Facet],
    ) -> Self {
        ContactBody {
            name,
            positions,
            velocities,
            masses,
            half_sizes: &[],
            facets,
            carriers: None,
            labels: &[],
        }
    }
    /// Set unique labels of the points, which identify them if numbers change from step to step.
    #[must_use]
    pub fn with_labels(mut self, labels: &'a [u64]) -> Self {
        self.labels = labels;
        self
    }
    /// Set half sizes of the nodes of a mesh, m, one a node: half the thickness of a shell, whose facets are the middle surface for contact
    /// of its nodes.
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
    /// True if the motion of a point is prescribed.
    pub(super) fn is_prescribed(&self, n: usize) -> bool {
        self.masses.get(n).is_some_and(|mass| mass.is_infinite())
    }
    /// Velocities and masses on which impulses act: of the nodes that carry points, or of the points.
    pub(super) fn movers(&self) -> (&'a [[f64; D]], &'a [f64]) {
        match self.carriers {
            Some(carriers) => (carriers.velocities, carriers.masses),
            None => (self.velocities, self.masses),
        }
    }

    /// Check the input.
    pub(super) fn check(&self) -> Result<(), SceneError> {
        let count = self.positions.len();
        let points_alone = self.facets.is_empty();
        let lengths = [
            ("trial velocities", self.velocities.len(), true),
            ("masses", self.masses.len(), self.carriers.is_none()),
            ("labels", self.labels.len(), !self.labels.is_empty()),
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
            let mass = self.masses.get(n).copied().unwrap_or(1.0);
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
        self.check_carriers()?;
        self.facets.iter().try_for_each(|facet| self.check_facet(facet))
    }

    fn check_carriers(&self) -> Result<(), SceneError> {
        let Some(Carriers { starts, weights, velocities, masses }) = self.carriers else { return Ok(()) };
        let parameter = |field, value, allowed| {
            Err(SceneError::Parameter { owner: "contact of points that nodes carry", field, value, allowed })
        };
        let ascending =
            starts.is_sorted() && starts.first() == Some(&0) && starts.last() == Some(&weights.len());
        if starts.len() != self.positions.len() + 1 || !ascending {
            return parameter(
                "starts of the weights",
                starts.len() as f64,
                "one more than points, from none to all weights",
            );
        }
        if velocities.len() != masses.len() {
            return parameter("velocities of nodes", velocities.len() as f64, "as many as masses");
        }
        if let Some((n, _)) = weights.iter().find(|(n, _)| *n as usize >= masses.len()) {
            return parameter("node of a point", f64::from(*n), "below the number of nodes");
        }
        if let Some(w) = weights.iter().flat_map(|(_, w)| w).find(|w| !w.is_finite()) {
            return parameter("weight", *w, "finite");
        }
        if let Some(mass) = masses.iter().find(|m| !(**m > 0.0 && m.is_finite())) {
            return parameter("mass of a node", *mass, "positive and finite");
        }
        match velocities.iter().flatten().find(|v| !v.is_finite()) {
            Some(v) => parameter("velocity of a node", *v, "finite"),
            None => Ok(()),
        }
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

/// Surface data of a body, valid while its facets are the same.
#[derive(Clone, Debug, Default)]
pub(super) struct Surface {
    facets: Vec<Facet>,
    points: usize,
    /// Points of possible contact: nodes of facets, or all points without facets.
    pub touching: Vec<u32>,
    /// Mean edge length at each node when the surface was built, m; empty without facets.
    edges: Vec<f64>,
    /// True if the edges are from a checkpoint, before the surface is built.
    kept: bool,
    /// True if every edge has facets on both sides.
    pub closed: bool,
    /// Nodal normals in this step; empty without facets.
    pub normals: Vec<[f64; 3]>,
}

impl Surface {
    /// Rebuild the surface if the body changed. Returns true if it did.
    pub fn update<const D: usize>(&mut self, body: &ContactBody<'_, D>) -> bool {
        if self.points == body.positions.len() && self.facets == body.facets && !self.touching.is_empty() {
            return false;
        }
        let count = body.positions.len();
        let (mut sums, mut ends) = (vec![0.0; count], vec![0.0; count]);
        let mut balance: HashMap<[u32; 2], i64> = HashMap::new();
        for facet in body.facets {
            let nodes = facet.nodes();
            // A closed surface leaves each edge of its facets, in the plane each node, as often as it enters it.
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
        let kept = std::mem::take(&mut self.kept) && self.edges.len() == count && !body.facets.is_empty();
        if !kept {
            self.edges =
                if body.facets.is_empty() { Vec::new() } else { sums.iter().zip(&ends).map(mean).collect() };
        }
        self.facets = body.facets.to_vec();
        self.points = count;
        true
    }

    /// Compute nodal normals: means of the facet normals, weighted by area.
    pub fn find_normals<const D: usize>(&mut self, body: &ContactBody<'_, D>) {
        self.normals.clear();
        self.normals.resize(if body.facets.is_empty() { 0 } else { body.positions.len() }, [0.0; 3]);
        for facet in body.facets {
            let nodes = facet.nodes();
            let x = |i: usize| wide(&body.positions[nodes[i] as usize]);
            let area = match nodes.len() {
                2 => {
                    let along = difference(x(1), x(0));
                    [along[1], -along[0], 0.0]
                }
                3 => cross(difference(x(1), x(0)), difference(x(2), x(0))),
                _ => cross(difference(x(2), x(0)), difference(x(3), x(1))),
            };
            for &n in nodes {
                self.normals[n as usize] = sum(self.normals[n as usize], area);
            }
        }
        for normal in &mut self.normals {
            *normal = unit(*normal).unwrap_or([0.0; 3]);
        }
    }

    /// Bounding box, by its corners, of the points of possible contact in a step of `dt`, s, with the search margin.
    pub fn swept_box<const D: usize>(
        &self,
        body: &ContactBody<'_, D>,
        velocities: &[[f64; 3]],
        dt: f64,
    ) -> [[f64; 3]; 2] {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for n in self.touching.iter().map(|&n| n as usize) {
            let beside = body.half_size(n) + BESIDE * self.spacing(body, n);
            let (x, way) = (body.position(n), times(velocities[n], dt));
            for d in 0..3 {
                low[d] = low[d].min(x[d] + way[d].min(0.0) - beside);
                high[d] = high[d].max(x[d] + way[d].max(0.0) + beside);
            }
        }
        [low, high]
    }

    /// Store or load the checkpoint data: the surface is rebuilt after loading, but with its original edges.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.edges, &0.0, Archive::real)?;
        if file.reads() {
            *self = Surface { edges: std::mem::take(&mut self.edges), kept: true, ..Surface::default() };
        }
        Ok(())
    }

    pub fn bytes(&self) -> usize {
        self.facets.capacity() * size_of::<Facet>()
            + self.touching.capacity() * 4
            + self.edges.capacity() * 8
            + self.normals.capacity() * size_of::<[f64; 3]>()
    }

    /// Spacing of a point, m: its diameter, or for a node without half size the mean edge at it.
    pub fn spacing<const D: usize>(&self, body: &ContactBody<'_, D>, n: usize) -> f64 {
        let half = body.half_size(n);
        if half > 0.0 { 2.0 * half } else { self.edges.get(n).copied().unwrap_or(0.0) }
    }
}

/// Bounding sphere of a facet, which moves and grows within the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    pub centre: [f64; 3],
    /// Radius at the start, m.
    pub radius: f64,
    /// Mean velocity of the nodes, m/s.
    pub velocity: [f64; 3],
    /// Largest deviation of a nodal velocity, m/s.
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
