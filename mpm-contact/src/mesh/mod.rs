//! Contact of points with the facets of meshes, whatever the methods: point to surface.
//!
//! Points are particles of MPM, PCMM or SPH, or nodes of a mesh; surfaces are edges in two dimensions (axisymmetric ones with masses per
//! radian), triangles and quadrilaterals in three ([`ContactBody`]). Sizes are free: a facet may be many times larger or smaller than the
//! points. Two meshes touch both ways, nodes of each at facets of the other; a mesh may touch itself. This is the principle of
//! particle-to-surface contact in the improved coupled finite element material point method \[Chen2015\], of which no numbers are
//! printed in the review that describes it \[Zhang2017\]; gates of our own judge it.
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
//! # A step
//! All methods have their trial velocities v*; contact gives impulses, and positions go on with v = v* + J / m.
//!
//! 1. *Search.* Of bodies whose boxes have a place in common in the step: spheres around points and facets that hold their motion, on
//!    the shared neighbour search, with a skin (`impactite_geometry::search::VerletListsBetween`); any ratio of sizes.
//! 2. *Features.* The distance of a point to a surface has its least values at faces, edges and corners; each of them is a contact. So a
//!    point beyond a convex edge has the edge's direction, one in a concave corner touches both sides, and one above a flat mesh a single
//!    facet. On quadrilaterals it is the closest point of the bilinear surface: smooth, with no diagonal, and fitting its neighbours. A
//!    point is inside where the facet nearest to it says so; which facet it touched last is remembered, and goes before. At a convex
//!    edge a node of a mesh meets the side that its own normal opposes, not the one turned away, however near: so faces of one outline
//!    meet flat, and an edge slides over the nodes below it.
//! 3. *Impulses.* With the weights N_a of the closest point x_c = sum N_a x_a, gap g = (x_p - x_c) . n - r_p and relative velocity
//!    u = v_p - sum N_a v_a, J is on the point and -N_a J on the nodes, so that the effective mass is
//!    1 / (1/m_p + sum N_a^2 / m_a). Along the normal: g + u_n dt >= 0, J_n >= 0, one of them zero: plastic impact at a point that
//!    closes, and rest where it lies. Across it, the law of the pair. All contacts together by projected Gauss-Seidel, each island of
//!    contacts that share masses by itself.
//! 4. *A look at the end.* Where a point would lie deeper than 0.04 of the spacing, or flies by more than half a facet, its way is
//!    followed to where it first comes through; that facet becomes a contact, and impulses are found again.
//!
//! # What holds
//! - Momentum to rounding. Angular momentum too, about positions at the start of the step (with which it is constant in free flight), for
//!   the normal parts of contacts found there: J_n lies along x_p - x_c. *Friction has a lever:* it acts at the surface, while the point's
//!   mass is its half size (and the gap that closes in the step) above it, and a point has no spin to take the couple up. That couple, and
//!   that of contacts found on the way, is [`MeshStep::couple`]: the change of angular momentum to rounding.
//! - Kinetic energy after = before + work of prescribed bodies - friction - impacts, to rounding ([`MeshStep::exchange`]); friction is the
//!   work on the slip left at the end of the step. Contact adds no energy but where a step begins deeper than 0.02 of the spacing: a
//!   tenth of what is deeper, at most 0.01 of the spacing, is mended in each step.
//! - No point lies deeper than 0.05 of its spacing (the diameter of a point; of a node without half size the mean edge there) at the end
//!   of a step that did not begin so; [`MeshStep::depth`] says how deep the deepest is.
//! - The same bits for any number of threads.
//!
//! # Limits
//! - Nodes are tested against facets, not edges against edges: two meshes in space may cross along edges between their nodes, by about
//!   half of the smaller edge at a sharp angle.
//! - Half sizes are along the normal: a point is a ball at edges and corners.
//! - Laws that remember are refused: a point that slides changes its facet, and no memory follows it yet. A law that springs
//!   ([`crate::Penalty`]) lets points in and is not followed along the way.
//! - A mesh with an open edge is a sheet with one side that pushes. A point further behind it than a tenth of the spacing, that did not
//!   touch it before, is not pulled through; nor does it push from behind.
//! - Self-contact: a node does not touch facets of which it is a node, nor those its own normal says are of the same sheet (less than 60
//!   degrees). Parts thinner than a tenth of an edge are not told from what came through.
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

/// Most rounds of a step: a point at speed may meet one facet after the other.
const ROUNDS: usize = 32;

/// Contact among bodies of which some have meshes: who may touch whom, by which laws, and what must last from step to step. See the
/// [module](self).
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

/// Have two boxes, by their corners, a place in common?
fn overlap(a: &[[f64; 3]; 2], b: &[[f64; 3]; 2]) -> bool {
    (0..3).all(|d| a[0][d] <= b[1][d] && b[0][d] <= a[1][d])
}

impl<const D: usize> MeshContact<D> {
    /// No contacts yet; this law in all, or the laws of pairs.
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
    /// Another law between two bodies, by number; twice the same one for a body with itself.
    #[must_use]
    pub fn with(mut self, one: usize, other: usize, law: impl ContactLaw<f64>) -> Self {
        self.laws = self.laws.with(one, other, law);
        self
    }
    /// Contact between two bodies, by number: points of each at facets of the other.
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
    /// Contact of a body's nodes with its own facets.
    #[must_use]
    pub fn within(mut self, body: usize) -> Self {
        if self.pairs.iter().all(|pair| pair.bodies != [body; 2]) {
            self.pairs.push(PairContact::new([body; 2]));
            self.sides.push(Facing::new([body; 2]));
        }
        self
    }
    /// Positions are (r, z), masses and impulses per radian: areas that laws ask for are too.
    #[must_use]
    pub fn axisymmetric(mut self) -> Self {
        self.axisymmetric = true;
        self
    }

    /// Find the impulses of a step `dt` (s) at `time` (s). Bodies are those numbered in [`MeshContact::between`]; numbers of points and
    /// facets may change from step to step, which takes another search and forgets what was touched.
    ///
    /// # Errors
    /// A law that remembers; a pair without facets, or a body that is not there; lists of unequal lengths; masses, positions, velocities,
    /// half sizes or facets that no contact can use; points that no search can. Nothing has changed then.
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
            // Nobody is there to meet where every element of a body has left.
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

    /// See which surfaces are new.
    fn look_at(&mut self, bodies: &[ContactBody<'_, D>]) {
        self.surfaces.resize(bodies.len(), Surface::default());
        self.impulses.resize(bodies.len(), Vec::new());
        for (n, body) in bodies.iter().enumerate() {
            if self.surfaces[n].update(body) {
                let of_this = self.sides.iter_mut().filter(|side| side.bodies.contains(&n));
                // What an archive held is of this surface.
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

    /// The laws.
    pub fn laws(&self) -> &Pairs<f64> {
        &self.laws
    }
    /// The impulses on points of a body in the last step, ascending by point.
    pub fn impulses(&self, body: usize) -> &[PointImpulse<D>] {
        self.impulses.get(body).map_or(&[], Vec::as_slice)
    }
    /// Each pair of bodies in the last step, in the order they were named; of a body with itself the force is zero.
    pub fn pairs(&self) -> &[PairContact] {
        &self.pairs
    }
    /// Where bodies touched in the last step, with gaps at its end.
    pub fn places(&self) -> &[ContactPoint] {
        &self.places
    }
    /// Searches for neighbours since the start.
    pub fn searches(&self) -> u64 {
        self.sides.iter().map(Facing::searches).sum()
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.surfaces.iter().map(Surface::bytes).sum::<usize>()
            + self.sides.iter().map(|side| side.bytes() + size_of::<Facing<D>>()).sum::<usize>()
            + self.impulses.iter().map(|list| list.capacity() * size_of::<PointImpulse<D>>()).sum::<usize>()
            + self.places.capacity() * size_of::<ContactPoint>()
            + self.pairs.capacity() * size_of::<PairContact>()
    }

    /// What must last, to a file or from one: which facets points touch, and what pairs took. Lists of neighbours are found again, and
    /// change nothing.
    ///
    /// # Errors
    /// The file; other laws or pairs than the ones saved.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.same("contact of meshes", &format!("{:?}", self.laws))?;
        let pairs: Vec<_> = self.pairs.iter().map(|pair| pair.bodies).collect();
        file.same("pairs in contact of meshes", &format!("{pairs:?}"))?;
        self.pairs.iter_mut().try_for_each(|pair| pair.archive(file))?;
        file.list(&mut self.surfaces, &Surface::default(), |file, surface| surface.archive(file))?;
        self.sides.iter_mut().try_for_each(|side| side.archive(file))
    }
}
