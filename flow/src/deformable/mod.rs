//! Deformable bodies in a liquid.
//!
//! Another solver moves the bodies: a flow calls it several times in a step. The unknowns are the mean velocities W of the nodes of
//! their surfaces in a step. The liquid answers with the impulses J(W) of its pressure, the bodies with the mean velocities S(J), and the
//! equation S(J(W)) = W is solved by a quasi-Newton method ([`newton`]).
//!
//! Impulses J of the liquid belong to the times of the positions, and change its velocities from the middle of one step to that of the next one.
//! They act on the bodies over the same time, at a constant rate: from the places Y' in the middle of the last step to Y in that of this one. The
//! surface that the liquid has goes from x to x' with the velocity W = (x' - x) / dt. With x' = 2 Y - x, the work J (W + W') / 2 of the liquid
//! is the work J (Y - Y') / dt on the body. This conserves energy for all frequencies and masses, but errors alternate. A tenth of it and nine of
//! x' = Y + (Y - Y') / 2 damp them: an oscillator of 20 steps a period loses at most 0.1 % of its amplitude in a step, and none gains energy, by the
//! eigenvalues of a step of an oscillator beside liquid (test `oscillators_are_stable_with_any_mass_of_liquid`). With half of each, blocks of elements of
//! a cell of the liquid gained energy at some sizes of the step (test `meshes_finer_than_the_cells_come_to_rest` of `coupling`).
//!
//! Forces at a constant rate from the start of a step to its end damp in first order; predictions of the place at the end by the present force
//! are unstable with 2 and less steps a period.
//!
//! The liquid has the motion of the surfaces averaged over two of its cells ([`smooth`]).

pub(crate) mod loads;
pub(crate) mod newton;
pub(crate) mod skin;
mod smooth;
mod step;

use std::fmt;

use impactite_scene::{Archive, CheckpointError, Exchange, Solver, StepError};

use skin::Skin;
use smooth::Smoothing;

/// Share of the sums of a step that the next one keeps.
const KEPT: f64 = 0.9;

/// Facet of a surface: body and nodes, in the order in which the matter is to the left (plane), or in which they turn counter-clockwise seen
/// from outside (space).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceElement<const D: usize> {
    /// Number of the body.
    pub body: u32,
    /// Nodes: two in the plane, three in space.
    pub nodes: [u32; D],
}

/// Impulse on a node of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeImpulse<const D: usize> {
    /// Number of the body.
    pub body: u32,
    /// Node of the body.
    pub node: u32,
    /// Impulse, N s.
    pub impulse: [f64; D],
}

/// Deformable bodies that a liquid moves: a solver with closed surfaces of facets. [`Flow::add_deformable`](crate::Flow::add_deformable)
/// takes one; the crate `coupling` has it for finite elements.
///
/// The solver has its own body force, conditions and contact between its bodies. A flow repeats its steps: before, the state is saved by
/// [`Deformable::archive`], which has to restore it to equal bits.
pub trait Deformable<const D: usize>: Send + Sync {
    /// Solver of the bodies.
    fn solver(&self) -> &dyn Solver;
    /// Solver of the bodies.
    fn solver_mut(&mut self) -> &mut dyn Solver;
    /// Facets of the surfaces of all bodies, body by body. They have to be closed.
    fn surface(&self) -> Vec<SurfaceElement<D>>;
    /// Number of changes of the list of facets.
    fn surface_revision(&self) -> u64;
    /// Position, m, and velocity, m/s, of a node of a body at the end of the runs so far. The work of impulses of a run is to be that on these
    /// positions: those of a leapfrog are in the middle of its last step, where its velocities are.
    fn node(&self, body: u32, node: u32) -> ([f64; D], [f64; D]);
    /// Run for `duration` seconds under impulses, N s, that act at a constant rate over it.
    ///
    /// # Errors
    /// Failure of the bodies.
    fn run_for(&mut self, duration: f64, impulses: &[NodeImpulse<D>]) -> Result<(), StepError>;
    /// Write or read the state of the bodies.
    ///
    /// # Errors
    /// Those of the archive.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.solver_mut().archive(file)
    }
    /// Exchange of the bodies by the impulses of [`Deformable::run_for`]: in `impulse` and `load`, as the solver has them in its own exchange.
    fn given(&self) -> Exchange;
}

/// Deformable bodies of a scene, with the state of their coupling.
pub(crate) struct Solids<const D: usize> {
    pub of: Box<dyn Deformable<D>>,
    /// Node of a body at each node of the surfaces.
    pub nodes: Vec<(u32, u32)>,
    /// Surface of each body, with the first of its nodes among all.
    pub skins: Vec<(Skin<D>, usize)>,
    revision: u64,
    /// Places of the nodes of the bodies at the start, m, and the averages by which the liquid has the surfaces.
    rest: Vec<[f64; D]>,
    smoothing: Smoothing,
    /// Stable step of the bodies at the start, s.
    pub first_step: f64,
    /// Places of the nodes for the liquid at the present time, and those of the bodies in the middle of the last step, m.
    pub places: Vec<[f64; D]>,
    pub middles: Vec<[f64; D]>,
    /// Mean velocities of the nodes in the last step, m/s.
    pub velocities: Vec<[f64; D]>,
    /// Mean velocities in the step before the last one, m/s, and the sizes of both, s; zero before them.
    pub before: Vec<[f64; D]>,
    pub steps: [f64; 2],
    /// Sums for the frequency of the surfaces, with weights that decay: -change of acceleration times displacement, m^2/s^2, and the square
    /// of the displacement, m^2.
    pub pace: [f64; 2],
    /// Impulse of the liquid that the nodes have not taken yet, N s.
    pub carry: Vec<[f64; D]>,
    /// State of the bodies in the middle of the last step; none before the first one.
    pub middle: Option<Archive>,
    /// Impulses of the present step, N s.
    pub given: Vec<[f64; D]>,
    /// Iterations of the last step.
    pub iterations: usize,
    /// Faces near the surfaces in the present step.
    pub wetted: loads::Wetted<D>,
    /// Impulse of the liquid in the last step, and since the start, N s.
    pub passed: [f64; D],
    pub taken: [f64; D],
}

impl<const D: usize> fmt::Debug for Solids<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "deformable bodies: {} with {} nodes of surfaces", self.skins.len(), self.nodes.len())
    }
}

impl<const D: usize> Solids<D> {
    /// Create the coupling with a liquid of cells of this size, m.
    ///
    /// # Errors
    /// Name of a body whose surface is not closed.
    pub fn new(of: Box<dyn Deformable<D>>, cell: f64) -> Result<Self, String> {
        let mut solids = Solids {
            of,
            nodes: Vec::new(),
            skins: Vec::new(),
            revision: 0,
            rest: Vec::new(),
            smoothing: Smoothing::default(),
            first_step: f64::INFINITY,
            places: Vec::new(),
            middles: Vec::new(),
            velocities: Vec::new(),
            before: Vec::new(),
            steps: [0.0; 2],
            pace: [0.0; 2],
            carry: Vec::new(),
            middle: None,
            given: Vec::new(),
            iterations: 0,
            wetted: loads::Wetted::default(),
            passed: [0.0; D],
            taken: [0.0; D],
        };
        solids.find_surfaces()?;
        // A solver without a stable step says so in its first one.
        solids.first_step = solids.of.solver_mut().stable_step().unwrap_or(f64::INFINITY);
        solids.rest = solids.nodes.iter().map(|(body, node)| solids.of.node(*body, *node).0).collect();
        solids.smoothing = Smoothing::new(&solids.skins, smooth::RADIUS * cell);
        let velocities: Vec<_> =
            solids.nodes.iter().map(|(body, node)| solids.of.node(*body, *node).1).collect();
        solids.velocities = solids.smoothing.average(&velocities);
        solids.places = solids.nodes_now();
        solids.middles.clone_from(&solids.places);
        solids.before.clone_from(&solids.velocities);
        solids.carry = vec![[0.0; D]; solids.nodes.len()];
        Ok(solids)
    }

    /// Find the surfaces and their nodes.
    fn find_surfaces(&mut self) -> Result<(), String> {
        self.revision = self.of.surface_revision();
        let all = self.of.surface();
        self.nodes.clear();
        self.skins.clear();
        let bodies = self.of.solver().bodies().len();
        for body in 0..bodies as u32 {
            let first = self.nodes.len();
            let mine = || all.iter().filter(|f| f.body == body);
            let mut nodes: Vec<u32> = mine().flat_map(|f| f.nodes).collect();
            nodes.sort_unstable();
            nodes.dedup();
            let number = |n: u32| nodes.partition_point(|x| *x < n) as u32;
            let facets = mine().map(|f| f.nodes.map(number)).collect();
            let places = nodes.iter().map(|n| self.of.node(body, *n).0).collect();
            let skin = Skin::new(facets, places).filter(|_| !nodes.is_empty());
            let Some(skin) = skin else {
                return Err(self.of.solver().bodies()[body as usize].name().into());
            };
            self.skins.push((skin, first));
            self.nodes.extend(nodes.into_iter().map(|n| (body, n)));
        }
        Ok(())
    }

    /// Surfaces at the places of the nodes.
    pub fn moved(&self, mut skins: Vec<(Skin<D>, usize)>) -> Vec<(Skin<D>, usize)> {
        for (skin, first) in &mut skins {
            let count = skin.places().len();
            skin.place(self.places[*first..*first + count].to_vec());
        }
        skins
    }

    /// Largest speed of a node in the last step, m/s.
    pub fn speed(&self) -> f64 {
        let square = |v: &[f64; D]| v.iter().map(|v| v * v).sum::<f64>();
        self.velocities.iter().map(square).fold(0.0, f64::max).sqrt()
    }

    /// Angular frequency of the present motion of the surfaces, rad/s, by the changes of the velocities W over steps dt: \[Bergan1985\]
    /// ```text
    /// w^2 = -sum (a - a') . W' dt' / sum (W' dt')^2,    a = 2 (W - W') / (dt + dt')
    /// ```
    /// with decaying weights over some ten steps. Motion slower than `floor`, m/s, counts as one of this speed without acceleration.
    pub fn frequency(&self) -> f64 {
        if self.pace[1] > 0.0 { (self.pace[0] / self.pace[1]).max(0.0).sqrt() } else { 0.0 }
    }

    /// Take the velocities of a step of `dt` seconds.
    pub fn note(&mut self, velocities: Vec<[f64; D]>, dt: f64, floor: f64) {
        let [last, first] = self.steps;
        if first > 0.0 {
            let (mut bend, mut way) = (0.0, 0.0);
            for ((new, now), old) in velocities.iter().zip(&self.velocities).zip(&self.before) {
                for d in 0..D {
                    let (a, b) =
                        (2.0 * (new[d] - now[d]) / (dt + last), 2.0 * (now[d] - old[d]) / (last + first));
                    bend -= (a - b) * now[d] * last;
                    way += (now[d] * last).powi(2);
                }
            }
            way = way.max((floor * last).powi(2) * velocities.len() as f64);
            self.pace = [KEPT * self.pace[0] + bend, KEPT * self.pace[1] + way];
        }
        self.before = std::mem::replace(&mut self.velocities, velocities);
        self.steps = [dt, last];
    }

    /// Exchange with what is neither liquid nor body. Impulses that the bodies have at the time of the positions, and that the liquid gives
    /// after the middle of the step, are booked as dropped.
    pub fn exchange(&self) -> Exchange {
        let (mut sum, given) = (self.of.solver().exchange(), self.of.given());
        (0..D).for_each(|d| sum.dropped[d] += given.impulse[d] + given.load[d] - self.taken[d]);
        for d in 0..3 {
            sum.impulse[d] -= given.impulse[d];
            sum.load[d] -= given.load[d];
        }
        sum.work -= given.work;
        sum
    }

    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let mut begun = self.middle.is_some();
        file.flag(&mut begun)?;
        if begun && file.reads() {
            self.of.archive(file)?;
            self.middle = Some(self.save()?);
        } else if let Some(middle) = self.middle.take() {
            let now = self.save()?;
            self.middle = Some(self.load(middle)?);
            self.of.archive(file)?;
            self.load(now)?;
        }
        self.of.archive(file)?;
        let velocities = [&mut self.velocities, &mut self.before, &mut self.carry];
        for list in [&mut self.places, &mut self.middles].into_iter().chain(velocities) {
            file.list(list, &[0.0; D], |file, x| file.reals(x))?;
            if list.len() != self.nodes.len() {
                return Err(file.damaged("it has velocities of another surface"));
            }
        }
        file.reals(self.taken.iter_mut().chain(&mut self.steps).chain(&mut self.pace))?;
        if file.reads() {
            let skins = std::mem::take(&mut self.skins);
            self.skins = self.moved(skins);
        }
        Ok(())
    }

    pub fn bytes(&self) -> usize {
        let nodes = self.nodes.capacity() * (size_of::<(u32, u32)>() + 4 * size_of::<[f64; D]>());
        nodes
            + self.smoothing.bytes()
            + self.skins.iter().map(|s| s.0.bytes()).sum::<usize>()
            + self.of.solver().bytes()
    }
}
