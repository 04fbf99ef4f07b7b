//! Point-to-surface contact of points with the facets of meshes, for any method.
//!
//! Points are particles of MPM, PCMM or SPH, or nodes of a mesh; surfaces are edges in two dimensions (axisymmetric ones with masses per
//! radian), triangles and quadrilaterals in three ([`ContactBody`]). Any ratio of sizes is permitted: a facet may be many times larger or
//! smaller than the points. Contact of two meshes is two-way, nodes of each against facets of the other; self-contact is possible. This is
//! the principle of particle-to-surface contact in the improved coupled finite element material point method \[Chen2015\]; the review that
//! describes it \[Zhang2017\] prints no numbers, so that acceptance tests of our own apply.
//!
//! ```
//! use impactite_geometry::Facet;
//! use impactite_simd::Team;
//! use mpm_contact::Coulomb;
//! use mpm_contact::mesh::{ContactBody, MeshContact};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A floor of one edge that rests, seen from above: its element is on the left of the edge, below.
//! let floor = [[1.0, 0.0], [-1.0, 0.0]];
//! let facets = [Facet { nodes: [0, 1, Facet::NONE, Facet::NONE], block: 0, element: 0 }];
//! let still = [[0.0, 0.0]; 2];
//! // A particle of 2 kg and 10 mm, 1 mm above it, that falls at 3 m/s and slides at 5 m/s.
//! let (place, mut velocity) = ([[0.2, 0.006]], [[5.0, -3.0]]);
//!
//! let mut contact = MeshContact::<2>::new(Coulomb::new(0.5)?).between(0, 1);
//! let bodies = [
//!     ContactBody::of_points("grain", &place, &velocity, &[2.0], &[0.005]),
//!     ContactBody::of_mesh("floor", &floor, &still, &[f64::INFINITY; 2], &facets),
//! ];
//! let step = contact.step(&bodies, 0.0, 1.0e-3, &Team::one())?;
//! // In this step of 1 ms the gap of 1 mm is closed, by 1 m/s; 2 m/s are taken, and friction takes half of that from the slip.
//! for push in contact.impulses(0) {
//!     for d in 0..2 {
//!         velocity[push.point as usize][d] += push.impulse[d] / 2.0;
//!     }
//! }
//! assert!((velocity[0][0] - 4.0).abs() < 1e-12 && (velocity[0][1] + 1.0).abs() < 1e-12);
//! let before = 0.5 * 2.0 * (5.0 * 5.0 + 3.0 * 3.0);
//! let after = 0.5 * 2.0 * (4.0 * 4.0 + 1.0 * 1.0);
//! assert!((before - after - step.exchange.friction - step.exchange.impacts).abs() < 1e-9);
//! # Ok(())
//! # }
//! ```
//!
//! # Time step
//! All methods have their trial velocities v*; contact computes impulses, and positions are updated with v = v* + J / m.
//!
//! 1. *Search.* Between bodies whose bounding boxes overlap in the step: spheres around points and facets that contain their motion, by the
//!    shared neighbour search, with a skin (`impactite_geometry::search::VerletListsBetween`); any ratio of sizes.
//! 2. *Features.* The distance of a point to a surface has minima at faces, edges and corners; each of them is a contact. A point beyond a
//!    convex edge thus has the edge's direction, one in a concave corner touches both sides, and one above a flat mesh a single facet. On
//!    quadrilaterals the closest point of the bilinear surface is used: smooth, without a diagonal, and compatible with neighbours. A point
//!    is inside if it is behind its nearest facet; the facet of its last contact is remembered, and has priority. At a convex edge a node
//!    of a mesh is in contact with the side that its own normal opposes, not the one turned away, however near: faces of one outline meet
//!    flat, and an edge slides over the nodes below it.
//! 3. *Impulses.* With the weights N_a of the closest point x_c = sum N_a x_a, gap g = (x_p - x_c) . n - r_p and relative velocity u =
//!    v_p - sum N_a v_a, J acts on the point and -N_a J on the nodes, so that the effective mass is 1 / (1/m_p + sum N_a^2 / m_a). Normal
//!    direction: g + u_n dt >= 0, J_n >= 0, one of them zero: plastic impact of a closing point, and static contact. Tangential direction:
//!    the law of the pair. All contacts are solved together by projected Gauss-Seidel, each island of contacts that share masses by itself.
//! 4. *Check at the end.* If a point would be deeper than 0.04 of the spacing, or flies by more than half a facet, its path is followed to
//!    its first passage; that facet becomes a contact, and impulses are solved for again.
//!
//! # Properties
//! - Momentum is conserved to rounding. Angular momentum too, about positions at the start of the step (with which it is constant in free
//!   flight), for the normal parts of contacts found there: J_n is along x_p - x_c. *Friction has a lever:* it acts at the surface, while
//!   the point's mass is its half size (and the gap that closes in the step) above it, and a point has no spin to take the couple up. That
//!   couple, and that of contacts found on the path, is [`MeshStep::couple`]: the change of angular momentum to rounding.
//! - Kinetic energy after = before + work of prescribed bodies - friction - impacts, to rounding ([`MeshStep::exchange`]); friction is the
//!   work on the slip left at the end of the step. Contact adds no energy unless a step begins deeper than 0.02 of the spacing: a tenth of
//!   the excess, at most 0.01 of the spacing, is corrected in each step.
//! - Penetration is at most 0.05 of the spacing of a point (its diameter; for a node without half size the mean edge there) at the end of a
//!   step that did not begin deeper; [`MeshStep::depth`] is the largest one.
//! - Results are bitwise equal for any number of threads.
//!
//! # Limits
//! - Nodes are tested against facets, not edges against edges: two meshes in space may cross along edges between their nodes, by about half
//!   of the smaller edge at a sharp angle.
//! - Half sizes act along the normal: a point is a ball at edges and corners.
//! - Laws with memory are refused: a sliding point changes its facet, and no memory follows it yet. A law that springs ([`crate::Penalty`])
//!   permits penetration, and its points are not followed along the path.
//! - Meshes with an open edge are sheets with contact on one side. A point further behind it than a tenth of the spacing, without contact
//!   before, is not pulled through; nor does it push from behind.
//! - Self-contact excludes facets of which the node is a node, and those of the same sheet by its own normal (less than 60 degrees). Parts
//!   thinner than a tenth of an edge are not distinguished from penetrations.
//! - The solution of one island runs on one thread.

mod body;
mod books;
mod closest;
mod detect;
mod features;
mod side;
mod solve;

use impactite_geometry::Facet;
use impactite_scene::{Archive, CheckpointError, ContactPoint, PairContact, SceneError};
use impactite_simd::Team;

use crate::law::{ContactLaw, Pairs};
use crate::vector::wide;
use body::Surface;
use books::Books;
use detect::{Touch, View};
use side::Facing;
use solve::World;

pub use body::{Carriers, ContactBody};
pub use books::{MeshStep, PointImpulse};

/// Maximum number of rounds of a step: a fast point may be in contact with one facet after the other.
const ROUNDS: usize = 32;

/// Contact between bodies of which some have meshes: pairs, laws, and data kept from step to step. See the [module](self).
#[derive(Clone, Debug)]
pub struct MeshContact<const D: usize> {
    laws: Pairs<f64>,
    sides: Vec<Facing<D>>,
    surfaces: Vec<Surface>,
    axisymmetric: bool,
    pairs: Vec<PairContact>,
    places: Vec<ContactPoint>,
    impulses: Vec<Vec<PointImpulse<D>>>,
}

/// True if two boxes, by their corners, overlap.
fn overlap(a: &[[f64; 3]; 2], b: &[[f64; 3]; 2]) -> bool {
    (0..3).all(|d| a[0][d] <= b[1][d] && b[0][d] <= a[1][d])
}

impl<const D: usize> MeshContact<D> {
    /// Create without pairs; one law for all contacts, or the laws of pairs.
    pub fn new(laws: impl Into<Pairs<f64>>) -> Self {
        MeshContact {
            laws: laws.into(),
            sides: Vec::new(),
            surfaces: Vec::new(),
            axisymmetric: false,
            pairs: Vec::new(),
            places: Vec::new(),
            impulses: Vec::new(),
        }
    }
    /// Set another law between two bodies, by number; twice the same one for self-contact.
    #[must_use]
    pub fn with(mut self, one: usize, other: usize, law: impl ContactLaw<f64>) -> Self {
        self.laws = self.laws.with(one, other, law);
        self
    }
    /// Add contact between two bodies, by number: points of each against facets of the other.
    #[must_use]
    pub fn between(mut self, one: usize, other: usize) -> Self {
        let bodies = [one.min(other), one.max(other)];
        if one == other {
            return self.within(one);
        }
        if self.pairs.iter().all(|pair| pair.bodies != bodies) {
            self.pairs.push(PairContact::new(bodies));
            self.sides.extend([[one, other], [other, one]].map(Facing::new));
        }
        self
    }
    /// Add self-contact of a body: its nodes against its own facets.
    #[must_use]
    pub fn within(mut self, body: usize) -> Self {
        if self.pairs.iter().all(|pair| pair.bodies != [body; 2]) {
            self.pairs.push(PairContact::new([body; 2]));
            self.sides.push(Facing::new([body; 2]));
        }
        self
    }
    /// Use axisymmetric coordinates (r, z): masses, impulses and areas for laws are per radian.
    #[must_use]
    pub fn axisymmetric(mut self) -> Self {
        self.axisymmetric = true;
        self
    }

    /// Solve for the impulses of a step `dt` (s) at `time` (s). Bodies are those numbered in [`MeshContact::between`]; numbers of points
    /// and facets may change from step to step, which causes another search and clears the last contacts.
    ///
    /// # Errors
    /// A law with memory; a pair without facets, or a body that does not exist; lists of unequal lengths; invalid masses, positions,
    /// velocities, half sizes or facets; points beyond the range of the search. Nothing is changed then.
    pub fn step(
        &mut self,
        bodies: &[ContactBody<'_, D>],
        time: f64,
        dt: f64,
        team: &Team,
    ) -> Result<MeshStep, SceneError> {
        self.check(bodies, dt)?;
        self.look_at(bodies);
        let mut velocities: Vec<Vec<[f64; 3]>> =
            bodies.iter().map(|body| body.velocities.iter().map(wide).collect()).collect();
        let carrying = |body: &ContactBody<'_, D>| {
            body.carriers.map_or(Vec::new(), |carriers| carriers.velocities.iter().map(wide).collect())
        };
        let mut carrying: Vec<Vec<[f64; 3]>> = bodies.iter().map(carrying).collect();
        let mut step = MeshStep::default();
        let mut touches: Vec<Touch> = Vec::new();
        for round in 0..ROUNDS {
            let known = touches.len();
            self.search(bodies, &velocities, dt, team)?;
            if round == 0 {
                touches =
                    self.views(bodies, &velocities, dt).flat_map(|view| view.at_the_start(team)).collect();
            } else {
                let mut more = Vec::new();
                step.depth = 0.0;
                for view in self.views(bodies, &velocities, dt) {
                    let (found, depth) = view.at_the_end(team);
                    step.depth = step.depth.max(depth);
                    let [one, other] = view.side.bodies;
                    if !self.laws.law(one, other).springs() {
                        more.extend(found);
                    }
                }
                if more.is_empty() {
                    break;
                }
                touches.extend(more);
            }
            if touches.is_empty() {
                continue;
            }
            let mut world = World {
                bodies,
                velocities: &mut velocities,
                carrying: &mut carrying,
                sides: &self.sides,
                laws: &self.laws,
                time,
                dt,
                axisymmetric: self.axisymmetric,
            };
            let found = world.solve(&mut touches, known, team);
            step.rounds += 1;
            step.sweeps = step.sweeps.max(found.sweeps);
            step.residual = found.residual;
        }
        step.contacts = touches.len();
        let (impulses, places, pairs) = (&mut self.impulses, &mut self.places, &mut self.pairs);
        let mut world = World {
            bodies,
            velocities: &mut velocities,
            carrying: &mut carrying,
            sides: &self.sides,
            laws: &self.laws,
            time,
            dt,
            axisymmetric: self.axisymmetric,
        };
        Books { impulses, places, pairs }.enter(&mut world, &touches, &mut step);
        self.remember(&touches);
        Ok(step)
    }

    fn check(&self, bodies: &[ContactBody<'_, D>], dt: f64) -> Result<(), SceneError> {
        if self.laws.remembered_numbers() > 0 {
            return Err(SceneError::NotWith {
                what: "a contact law that remembers".into(),
                method: "contact of meshes".into(),
                why: "a point that slides changes its facet, and no memory follows it: take a law without (`Coulomb`)",
            });
        }
        let parameter = |field, value, allowed| {
            Err(SceneError::Parameter { owner: "contact of meshes", field, value, allowed })
        };
        if dt <= 0.0 || !dt.is_finite() {
            return parameter("time step", dt, "positive and finite");
        }
        if D != 2 && D != 3 {
            return parameter("dimensions", D as f64, "2 or 3");
        }
        for pair in &self.pairs {
            let [a, b] = pair.bodies;
            let Some(last) = bodies.get(b) else {
                return parameter("number of a body in contact", b as f64, "below the number of bodies");
            };
            let one = &bodies[a];
            // A body without elements has no contact.
            let is_one_gone = one.positions.is_empty() || last.positions.is_empty();
            if one.facets.is_empty() && last.facets.is_empty() && !is_one_gone {
                return Err(SceneError::NotWith {
                    what: format!("contact of `{}` and `{}`, which have no facets,", one.name, last.name),
                    method: "contact of meshes".into(),
                    why: "one of them must be a mesh; bodies of particles alone touch by their own method",
                });
            }
        }
        bodies.iter().try_for_each(ContactBody::check)
    }

    /// Update the surfaces that changed.
    fn look_at(&mut self, bodies: &[ContactBody<'_, D>]) {
        self.surfaces.resize(bodies.len(), Surface::default());
        self.impulses.resize(bodies.len(), Vec::new());
        for (n, body) in bodies.iter().enumerate() {
            if self.surfaces[n].update(body) {
                let of_this = self.sides.iter_mut().filter(|side| side.bodies.contains(&n));
                // Data from an archive belong to this surface.
                of_this.for_each(|side| side.is_of(n, body));
            }
        }
        for side in &mut self.sides {
            side.follow(bodies[side.bodies[0]].labels);
        }
        for (surface, body) in self.surfaces.iter_mut().zip(bodies) {
            surface.find_normals(body);
        }
    }

    fn search(
        &mut self,
        bodies: &[ContactBody<'_, D>],
        velocities: &[Vec<[f64; 3]>],
        dt: f64,
        team: &Team,
    ) -> Result<(), SceneError> {
        let boxes: Vec<_> = bodies
            .iter()
            .zip(velocities)
            .zip(&self.surfaces)
            .map(|((body, velocities), surface)| surface.swept_box(body, velocities, dt))
            .collect();
        for side in &mut self.sides {
            let [a, b] = side.bodies;
            side.near = !bodies[b].facets.is_empty() && overlap(&boxes[a], &boxes[b]);
            if side.near {
                let of = [&velocities[a][..], &velocities[b]];
                side.update(&bodies[a], &bodies[b], &self.surfaces[a], of, dt, team)?;
            }
        }
        Ok(())
    }

    fn views<'a>(
        &'a self,
        bodies: &'a [ContactBody<'a, D>],
        velocities: &'a [Vec<[f64; 3]>],
        dt: f64,
    ) -> impl Iterator<Item = View<'a, D>> {
        let near = self.sides.iter().enumerate().filter(|(_, side)| side.near);
        near.map(move |(number, side)| {
            let [a, b] = side.bodies;
            View {
                number: number as u32,
                side,
                points: &bodies[a],
                facets: &bodies[b],
                surfaces: [&self.surfaces[a], &self.surfaces[b]],
                velocities: [&velocities[a], &velocities[b]],
                dt,
            }
        })
    }

    fn remember(&mut self, touches: &[Touch]) {
        for side in &mut self.sides {
            side.held.fill(Facet::NONE);
        }
        for touch in touches.iter().filter(|touch| touch.impulse != [0.0; 3] || touch.gap <= 0.0) {
            self.sides[touch.side as usize].held[touch.point as usize] = touch.facet;
        }
    }

    /// Contact laws.
    pub fn laws(&self) -> &Pairs<f64> {
        &self.laws
    }
    /// Impulses on points of a body in the last step, ascending by point.
    pub fn impulses(&self, body: usize) -> &[PointImpulse<D>] {
        self.impulses.get(body).map_or(&[], Vec::as_slice)
    }
    /// Pairs of bodies in the last step, in the order of definition; the force of self-contact is zero.
    pub fn pairs(&self) -> &[PairContact] {
        &self.pairs
    }
    /// Contact points in the last step, with gaps at its end.
    pub fn places(&self) -> &[ContactPoint] {
        &self.places
    }
    /// Number of neighbour searches since the start.
    pub fn searches(&self) -> u64 {
        self.sides.iter().map(Facing::searches).sum()
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        self.surfaces.iter().map(Surface::bytes).sum::<usize>()
            + self.sides.iter().map(|side| side.bytes() + size_of::<Facing<D>>()).sum::<usize>()
            + self.impulses.iter().map(|list| list.capacity() * size_of::<PointImpulse<D>>()).sum::<usize>()
            + self.places.capacity() * size_of::<ContactPoint>()
            + self.pairs.capacity() * size_of::<PairContact>()
    }

    /// Store or load the checkpoint data: last contacts of points, and energies of pairs. Neighbour lists are rebuilt, without effect on
    /// results.
    ///
    /// # Errors
    /// File errors; other laws or pairs than the ones saved.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.same("contact of meshes", &format!("{:?}", self.laws))?;
        let pairs: Vec<_> = self.pairs.iter().map(|pair| pair.bodies).collect();
        file.same("pairs in contact of meshes", &format!("{pairs:?}"))?;
        self.pairs.iter_mut().try_for_each(|pair| pair.archive(file))?;
        file.list(&mut self.surfaces, &Surface::default(), |file, surface| surface.archive(file))?;
        self.sides.iter_mut().try_for_each(|side| side.archive(file))
    }
}
