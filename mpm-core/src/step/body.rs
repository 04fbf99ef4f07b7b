//! Bodies as the solver sees them: dynamic between bodies, static inside the loops.

use super::checkpoint::{Archive, CheckpointError, Constant};
use super::fields::Claim;
use super::footprint::Footprint;
use super::layout::{Layout, Nodes};
use super::load::Loading;
use super::merging::MergeBook;
use super::reference_body::{InReference, Shade};
use super::rest::Stilled;
use super::rigid::RigidState;
use super::scene::SceneError;
use super::splitting::SplitBook;
use super::survey::{Near, Survey};
use super::sweep::Cause;
use super::tile::Sums;
use crate::grid::Node;
use crate::parallel::{Float, Team};

/// Which pass of a method to make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The map at the start of a run.
    Map,
    /// The map anew with the affine field of the nodes.
    Refit,
    /// The first of a step.
    First,
    /// The second of a step.
    Second,
    /// A smoothing of FMPM.
    Smooth,
    /// To where particles were placed.
    Follow,
}

/// The time step, and the one after it, s.
#[derive(Clone, Copy, Debug)]
pub struct Steps<T> {
    /// This step.
    pub this: T,
    /// The next.
    pub next: T,
    /// Do later steps follow the wave speeds?
    pub adapt: bool,
    /// Time at which the forces act that a pass maps, s.
    pub force_time: f64,
}

/// Totals over the particles of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Particles.
    pub particles: usize,
    /// Mass, kg.
    pub mass: f64,
    /// Momentum, kg m/s.
    pub momentum: [f64; 3],
    /// Angular momentum about the origin, kg m^2/s.
    pub angular_momentum: [f64; 3],
    /// Sum of m |v|, kg m/s: the scale for errors of the momentum.
    pub momentum_scale: f64,
    /// Kinetic energy of the particles, J.
    pub kinetic: f64,
    /// Internal energy, J.
    pub internal: f64,
}

impl Totals {
    /// Sum with another body's.
    pub fn plus(mut self, o: &Totals) -> Totals {
        self.particles += o.particles;
        self.mass += o.mass;
        for d in 0..3 {
            self.momentum[d] += o.momentum[d];
            self.angular_momentum[d] += o.angular_momentum[d];
        }
        self.momentum_scale += o.momentum_scale;
        self.kinetic += o.kinetic;
        self.internal += o.internal;
        self
    }
}

/// A particle as others see it, in SI units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particle {
    /// Its number in the body, by the order of seeding; [`Splitting`](super::splitting::Splitting) tells those of split ones.
    pub number: usize,
    /// Position, m.
    pub position: [f64; 3],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Mass, kg.
    pub mass: f64,
    /// Volume, m^3 (per radian or metre of depth in two dimensions).
    pub volume: f64,
    /// Half edges of its domain, m: of the box along the axes that it started with, stretched (cpGIMP), sheared and turned
    /// (CPDI, and all in the reference configuration) as its method has it.
    pub half_edges: [[f64; 3]; 3],
    /// Cauchy stress xx, yy, zz, yz, xz, xy, Pa.
    pub stress: [f64; 6],
    /// Is it within the range of the data of its law? False of one so dense that its equation of state is continued.
    pub in_range: bool,
    /// Has it failed ([`mpm_materials::Constitutive::failed`])?
    pub failed: bool,
    /// The law's state, by [`Body::state_names`].
    pub state: Vec<f64>,
}

impl Particle {
    /// Pressure, compression positive: -tr(sigma) / 3, Pa.
    #[must_use]
    pub fn pressure(&self) -> f64 {
        -(self.stress[0] + self.stress[1] + self.stress[2]) / 3.0
    }

    /// Von Mises equivalent stress, Pa.
    #[must_use]
    pub fn von_mises(&self) -> f64 {
        let (s, mean) = (&self.stress, -self.pressure());
        let d = [s[0] - mean, s[1] - mean, s[2] - mean];
        let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        let shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
        (1.5 * (square + 2.0 * shear)).sqrt()
    }
}

/// What broke in a body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyTrouble {
    /// Number of the particle.
    pub particle: usize,
    /// Its position, m.
    pub position: [f64; 3],
    /// What happened.
    pub cause: Cause,
}

/// How a body is present among the nodes of a scene: which blocks it takes, what it maps to them, what is near them.
pub trait Presence<T: Float, const D: usize>: Send + Sync {
    /// Append the node blocks that the particles reach or may come to, as claims of body `number`; to look `ahead`, those
    /// that they reach from a cell beside as well.
    fn claims(&mut self, number: u32, ahead: bool, list: &mut Vec<Claim<D>>);
    /// Did a particle come to where the body has no node?
    fn reaches_further(&mut self, layout: &Layout) -> bool;
    /// Does a particle reach this block of the body's own list?
    fn reaches(&self, block: usize) -> bool;
    /// Note where the node blocks are now, and append their places: this is the body's own list of blocks.
    fn link(&mut self, find: &dyn Fn(&[i32; D]) -> Option<usize>, places: &mut Vec<u32>);
    /// Add what this body's particles map to the nodes of a block, by its place in the body's own list.
    fn add_tiles(&self, block: usize, sums: Sums, nodes: &mut [Node<T>]);
    /// What contact wants to know of the particles near some nodes of a block of the body's own list; `nodes`
    /// has a bit for each. Adds to `out`, one entry a node ([`Survey::Reach`]: the larger one), for the unit
    /// vectors in `normals`, one a node, where the survey needs them.
    fn survey(&self, block: usize, what: Survey, nodes: u64, normals: &[[T; 3]], out: &mut [[T; 3]]);
    /// Call `visit` for every particle near some nodes of a block, a bit each, with those of them that it has in its
    /// stencil; particles in order of place, those of a bin one behind the other.
    fn near(&self, block: usize, nodes: u64, visit: &mut dyn FnMut(u64, &Near<T>));
}

/// A body as the solver and observers see it.
pub trait Body<T: Float, const D: usize>: Send + Sync {
    /// The body's name.
    fn name(&self) -> &str;
    /// Its law's name.
    fn law(&self) -> &'static str;
    /// What it is made of, in words; functions of time by what they give at these, s.
    fn constants(&self, times: [f64; 2]) -> Vec<Constant>;
    /// Number of particles.
    fn len(&self) -> usize;
    /// Has it no particles?
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Names of the numbers in [`Particle::state`].
    fn state_names(&self) -> Vec<String>;
    /// How its coordinates lie in space: the name of the embedding.
    fn embedding(&self) -> &'static str;
    /// Half sizes of the particles at the start, m.
    fn half_size(&self) -> [f64; D];
    /// Smallest particle mass, kg.
    fn lightest(&self) -> T;
    /// Its presence among the nodes: that of its particles, or of what stands for them.
    fn presence(&self) -> &dyn Presence<T, D>;
    /// The same, to be arranged anew.
    fn presence_mut(&mut self) -> &mut dyn Presence<T, D>;
    /// Place and motion, if the body is rigid.
    fn rigid(&self) -> Option<&RigidState<D>> {
        None
    }
    /// The same, to be moved.
    fn rigid_mut(&mut self) -> Option<&mut RigidState<D>> {
        None
    }

    /// The parts of a step of its own, if the body is mapped in its reference configuration.
    fn in_reference(&self) -> Option<&dyn InReference<T, D>> {
        None
    }
    /// The same, to be made.
    fn in_reference_mut(&mut self) -> Option<&mut dyn InReference<T, D>> {
        None
    }

    /// Rest until it is woken ([`Mpm::let_rest`](super::Mpm::let_rest)), tried with a step of `longest` seconds; its node
    /// blocks are arranged next.
    ///
    /// # Errors
    /// A body that cannot rest, or does not.
    fn let_rest(&mut self, longest: T, team: &Team) -> Result<(), SceneError>;
    /// Rest no longer, with what the last pass would have mapped; node blocks are arranged next.
    fn wake(&mut self, team: &Team);
    /// The node blocks that it would have, sorted, if it rests and has none.
    fn rests_at(&self) -> Option<&[[i32; D]]>;
    /// Does it rest ([`Mpm::let_rest`](super::Mpm::let_rest))?
    fn rests(&self) -> bool {
        self.rests_at().is_some()
    }

    /// Largest (c + |v|) / h of the particles as they stand, 1/s, for cells of `spacing`, m.
    fn rate(&self, spacing: f64) -> T;

    /// One pass over the particles. Returns the largest (c + |v|) / h seen, 1/s.
    ///
    /// # Errors
    /// The first particle that cannot go on.
    fn pass(
        &mut self,
        which: Which,
        nodes: Nodes<'_, T>,
        dt: Steps<T>,
        team: &Team,
    ) -> Result<T, BodyTrouble>;
    /// Force of the load that was mapped last, and power of the one that acted in the step.
    fn loading(&self) -> Loading;
    /// Bring particles that left their bins to the new ones, and make blocks where they come to; `prune`
    /// blocks that are empty. Returns whether the set of blocks changed.
    fn locate(&mut self, which: Which, prune: bool, team: &Team) -> bool;

    /// Totals over the particles.
    fn totals(&self) -> Totals;
    /// The same, found on these threads; `parts` is memory to work in.
    fn totals_on(&self, team: &Team, parts: &mut Vec<Totals>) -> Totals {
        let _ = (team, parts);
        self.totals()
    }
    /// Does its law bear shear and tension, so that it is one piece of matter?
    fn coheres(&self) -> bool {
        false
    }
    /// Call `visit` for every particle, blocks in order of coordinates.
    fn for_each(&self, visit: &mut dyn FnMut(&Particle));
    /// All particles, by number.
    fn particles(&self) -> Vec<Particle> {
        let mut all = Vec::with_capacity(self.len());
        self.for_each(&mut |p| all.push(p.clone()));
        all.sort_by_key(|p| p.number);
        all
    }
    /// Call `visit` with number and velocity, m/s, of every particle; it may change the velocity.
    fn each_velocity(&mut self, visit: &mut dyn FnMut(usize, &mut [T; 3]));
    /// Note, by number, what a shadow of every particle is like. `numbers` is memory to work in.
    fn cast(&self, numbers: &mut Vec<T>, shapes: &mut [Shade]);
    /// Bytes of memory held, all scratch included.
    fn bytes(&self) -> usize;
    /// Bytes that a particle carries.
    fn particle_bytes(&self) -> usize;
    /// How its particles were split since the start.
    fn splits(&self) -> SplitBook {
        SplitBook::default()
    }
    /// How its particles were merged since the start, if they are to be.
    fn merges(&self) -> Option<MergeBook> {
        None
    }

    /// Take all that changes in a run to a file, or from one.
    ///
    /// # Errors
    /// The file.
    fn exchange(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;

    /// Stop all particles.
    fn still(&mut self) -> Stilled;
    /// Take out of the velocities what the nodes of a cell do not see; the kinetic energy of that, J.
    fn filter(&mut self, team: &Team) -> f64;
    /// Merge particles, if it is time to after so many steps; were any?
    fn merge(&mut self, _steps: u64, _team: &Team) -> bool {
        false
    }
    /// Show every particle as its nodes see it, loads as they are at `time`, s.
    fn footprints(&self, time: f64, visit: &mut dyn FnMut(&Footprint<'_, D>));
}
