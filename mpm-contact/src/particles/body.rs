//! What contact, and a scene of several bodies, ask of a body of particles.

use std::any::Any;

use impactite_scene::watch::Loss;
use impactite_scene::{Archive, Body, CheckpointError, Exchange, SceneError, StepError};
use impactite_simd::Team;

/// A point of the surface of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfacePoint {
    /// Position, m; zero beyond the dimensions of the scene.
    pub position: [f64; 3],
    /// Unit normal, out of the body.
    pub normal: [f64; 3],
    /// Area that the point stands for, m^2 (per metre of depth, or per radian).
    pub area: f64,
    /// Does it lie on an edge or corner between faces? Then other surfaces do not rest on it: it rests on them.
    pub corner: bool,
    /// Distance of the surface beyond the point in all directions, m: the radius of a ball, else zero.
    pub reach: f64,
}

/// A particle as contact sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactParticle<const D: usize> {
    /// Position of its centre, m.
    pub position: [f64; D],
    /// Velocity, m/s: the one at the start of the step, or between [`ParticleBody::accelerate`] and [`ParticleBody::advance`] the trial
    /// one at its end.
    pub velocity: [f64; D],
    /// Mass, kg: per metre of depth in plane strain, per radian in axisymmetric scenes. Positive.
    pub mass: f64,
    /// Radius, m: half the distance of neighbours in a body at rest. Particles of two bodies face each other where their centres are
    /// less than one and a half times the sum of their radii apart.
    pub radius: f64,
}

/// The surface of a body at one of its particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facing {
    /// Out of the body, as long as the area of surface that the particle stands for, m^2 (per metre of depth, or per radian): the sum
    /// of V grad N over what is around the particle, with elements; minus V_n sum_m V_m grad W_nm, with kernels. Zero within the body.
    pub area: [f64; 3],
    /// Likewise of masses, kg/m: the sum of m grad N, or minus m_n sum_m V_m grad W_nm. Normals by mass take their direction from it,
    /// nothing takes its length.
    pub mass: [f64; 3],
    /// Has it no neighbours in its body? It is a ball then, and faces whatever comes; `area` and `mass` are not looked at.
    pub lone: bool,
}

impl Facing {
    /// Surrounded by its body.
    pub const WITHIN: Facing = Facing { area: [0.0; 3], mass: [0.0; 3], lone: false };
    /// By itself, as a ball.
    pub const LONE: Facing = Facing { lone: true, ..Facing::WITHIN };

    /// Is the particle within the body, others all around it?
    #[must_use]
    pub fn is_within(&self) -> bool {
        !self.lone && self.area == [0.0; 3]
    }
}

/// What a run is told that loses or gains energy ([`impactite_scene::watch`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Advice {
    /// Where energy that is missing most likely went, and what keeps more.
    pub loss: Loss,
    /// What most likely made energy at the fastest particle, and what helps.
    pub gain: &'static str,
}

/// What holds of every method.
impl Default for Advice {
    fn default() -> Self {
        Advice {
            loss: Loss {
                by: "contacts that closed, or what the methods of the bodies do not keep",
                remedy: "take smaller particles, or a smaller Courant factor",
            },
            gain: "the particles there are the fastest; take a smaller Courant factor",
        }
    }
}

/// A body of particles, of any method: what contact with others asks of it ([`Bodies`](crate::particles::Bodies)).
///
/// Its particles are the points of [`Body`], by the same numbers, below [`Body::len`]; how they are kept is the body's affair. Vectors
/// of `D` components are those of the scene, vectors of three have zeros beyond.
///
/// A step of `dt` seconds of all bodies together is
///
/// 1. [`check`](ParticleBody::check): loads and conditions at its times,
/// 2. [`accelerate`](ParticleBody::accelerate): trial velocities at its end, from forces and body force,
/// 3. impulses between bodies, each by [`push`](ParticleBody::push),
/// 4. [`advance`](ParticleBody::advance): conditions on velocities, new positions,
/// 5. [`finish`](ParticleBody::finish): strain, law, forces for the next step; the clock.
///
/// A body that is made to step alone does the same without 3. Contact keeps momentum to rounding and books what it takes of kinetic
/// energy with the mean of the velocities at the start and after 3; what conditions and loads give is booked by the body
/// ([`exchange`](ParticleBody::exchange)).
///
/// Results must be the same bits for any number of threads.
pub trait ParticleBody<const D: usize>: Body + Send + Sync + Any {
    /// Particle `n`. Asked in every step of those near other bodies.
    fn particle(&self, n: usize) -> ContactParticle<D>;

    /// The greatest speed of its particles, m/s.
    fn fastest(&self) -> f64 {
        let square = |n: usize| self.particle(n).velocity.iter().map(|v| v * v).sum::<f64>();
        (0..self.len()).map(square).fold(0.0, f64::max).sqrt()
    }

    /// May particle `n` touch those of other bodies? Asked in every step, before all else, of particles within reach of another body:
    /// where it says no, nothing more is asked of them, so that the inside of a body costs next to nothing. What came through the
    /// surface then meets what says yes alone: a body that others may get into leaves this as it is. Rigid walls hold back every
    /// particle.
    fn may_touch(&self, _n: usize) -> bool {
        true
    }

    /// The surface at particle `n`, which is within reach of another body. On a plane of symmetry without the components across it,
    /// since the other half of the body cancels them.
    fn facing(&self, n: usize) -> Facing;

    /// Do the places of its particles ([`around`](ParticleBody::around)) say better where its surface points than
    /// [`facing`](ParticleBody::facing) does? So it is of kernels, which see an edge of a body as rounded: rules for normals that look at
    /// particles ([`crate::SeparatingPlane`]) then take those. Facets of elements know better.
    fn by_places(&self) -> bool {
        false
    }

    /// How far the surface lies beyond the centre of particle `n`, m: zero of particles on the surface, a radius of those that lie
    /// half a spacing within it.
    fn beyond(&self, n: usize) -> f64;

    /// Call `visit` for the particles that belong to the same piece of surface as particle `n`, itself among them, each once and in an
    /// order that depends on nothing but the body. Normals that look at particles ([`crate::Regression`],
    /// [`crate::SeparatingPlane`]) put their planes between those of both bodies.
    fn around(&self, n: usize, visit: &mut dyn FnMut(usize));

    /// Does the body know its surface as points with normals ([`surface`](ParticleBody::surface))? Then contact is between these points and
    /// the surface interpolated between those of the other body, instead of between pairs of particles.
    fn has_surface(&self) -> bool {
        false
    }

    /// Find the surface points of these particles (ascending), of which [`surface`](ParticleBody::surface) is asked before anything moves.
    fn find_surface(&mut self, _particles: &[usize]) {}

    /// Append the surface points of particle `n`: none within the body, several on edges. After
    /// [`find_surface`](ParticleBody::find_surface).
    fn surface(&self, _n: usize, _out: &mut Vec<SurfacePoint>) {}

    /// Call `visit` with each particle k that moves a surface point of particle `n`, and its weight W_k by axis: the velocity of the point
    /// is sum_k W_k v_k, and an impulse J on it acts on k by W_k J. The weights along an axis add up to 1, or less across a plane of symmetry.
    fn carriers(&self, n: usize, _point: &SurfacePoint, visit: &mut dyn FnMut(usize, [f64; 3])) {
        visit(n, [1.0; 3]);
    }

    /// The axes along which a condition prescribed the velocity of particle `n` in the last step: an impulse does not change it there.
    fn held(&self, _n: usize) -> [bool; 3] {
        [false; 3]
    }

    /// The normal traction n . sigma . n at particle `n`, Pa, tension positive: what [`crate::Compression`] asks for.
    fn traction(&self, n: usize, normal: &[f64; 3]) -> f64;

    /// The Courant rate, 1/s: the step of the scene is at most its factor over the largest of all bodies.
    fn rate(&self) -> f64;

    /// Are its loads and conditions such that a step of `dt` seconds from now can be made? Before anything moves.
    ///
    /// # Errors
    /// One that is not.
    fn check(&self, dt: f64) -> Result<(), SceneError>;

    /// Give all particles the trial velocities at the end of a step of `dt` seconds, from the forces of the last
    /// [`finish`](ParticleBody::finish) and the body force. Put into `start`, which may hold anything, the velocities that they had.
    ///
    /// # Errors
    /// Names body, point, place and cause of what stopped it.
    fn accelerate(&mut self, dt: f64, start: &mut Vec<[f64; D]>) -> Result<(), StepError>;

    /// Add an impulse, N s, to particle `n`: its velocity changes by that over its mass.
    fn push(&mut self, n: usize, impulse: &[f64; 3]);

    /// Conditions on the velocities, and new positions. `start` is what [`accelerate`](ParticleBody::accelerate) put there.
    ///
    /// # Errors
    /// As [`accelerate`](ParticleBody::accelerate).
    fn advance(&mut self, dt: f64, start: &[[f64; D]]) -> Result<(), StepError>;

    /// Strain, law and forces at the new positions; the body's clock goes on by `dt`.
    ///
    /// # Errors
    /// As [`accelerate`](ParticleBody::accelerate).
    fn finish(&mut self, dt: f64) -> Result<(), StepError>;

    /// Its method, in a line of words that are the same in a scene that is resumed: "particle-contact method: plane strain, ...".
    fn describe(&self) -> String;

    /// Are its coordinates (r, z), and its masses per radian?
    fn axisymmetric(&self) -> bool {
        false
    }

    /// What it exchanged with its surroundings since its start, without the impulses of other bodies.
    fn exchange(&self) -> Exchange;

    /// The speed, m/s, of waves and particles in it: motion far below is noise that no balance of energy is judged by.
    fn speed(&self) -> f64;

    /// What is said where energy is lost or gained.
    fn advice(&self) -> Advice {
        Advice::default()
    }

    /// Call it so, in messages and files.
    fn rename(&mut self, name: String);

    /// Run on these threads, or on fewer where that is faster.
    fn set_team(&mut self, team: Team);

    /// What it is made of, to be compared, and all that changes in a run, its clock among it, to a file or from one. As
    /// [`impactite_scene::Solver::archive`], but without a watch: the scene has one of its own.
    ///
    /// # Errors
    /// The file; another body.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;
}
