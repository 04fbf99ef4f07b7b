//! Interface of a body of particles to contact, and to a scene of several bodies.

use std::any::Any;

use impactite_scene::watch::Loss;
use impactite_scene::{Archive, Body, CheckpointError, Exchange, SceneError, StepError};
use impactite_simd::Team;

/// Point of the surface of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfacePoint {
    /// Position, m; zero beyond the dimensions of the scene.
    pub position: [f64; 3],
    /// Outward unit normal.
    pub normal: [f64; 3],
    /// Area of the point, m^2 (per metre of depth, or per radian).
    pub area: f64,
    /// True on an edge or corner between faces: the point is then supported by other surfaces, and does not support them.
    pub corner: bool,
    /// Distance of the surface beyond the point in all directions, m: the radius of a ball, else zero.
    pub reach: f64,
}

/// Particle data for contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactParticle<const D: usize> {
    /// Position of the centre, m.
    pub position: [f64; D],
    /// Velocity, m/s: at the start of the step, or between [`ParticleBody::accelerate`] and [`ParticleBody::advance`] the trial velocity at
    /// its end.
    pub velocity: [f64; D],
    /// Mass, kg: per metre of depth in plane strain, per radian in axisymmetric scenes. Positive.
    pub mass: f64,
    /// Radius, m: half the distance of neighbours in a body at rest. Particles of two bodies face each other if their centres are less than
    /// one and a half times the sum of their radii apart.
    pub radius: f64,
}

/// Surface of a body at one of its particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facing {
    /// Outward area vector of the surface at the particle, m^2 (per metre of depth, or per radian): the sum of V grad N over what is around
    /// the particle, with elements; minus V_n sum_m V_m grad W_nm, with kernels. Zero within the body.
    pub area: [f64; 3],
    /// Mass gradient, kg/m: the sum of m grad N, or minus m_n sum_m V_m grad W_nm. Normals by mass use its direction; its length is not
    /// used.
    pub mass: [f64; 3],
    /// True without neighbours in its body: the particle is then a ball that faces every direction; `area` and `mass` are not used.
    pub lone: bool,
}

impl Facing {
    /// Particle surrounded by its body.
    pub const WITHIN: Facing = Facing { area: [0.0; 3], mass: [0.0; 3], lone: false };
    /// Lone particle, a ball.
    pub const LONE: Facing = Facing { lone: true, ..Facing::WITHIN };

    /// True if the particle is within the body, surrounded by others.
    #[must_use]
    pub fn is_within(&self) -> bool {
        !self.lone && self.area == [0.0; 3]
    }
}

/// Advice for a run that loses or gains energy ([`impactite_scene::watch`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Advice {
    /// Most likely cause of an energy loss, and its remedy.
    pub loss: Loss,
    /// Most likely cause of an energy gain at the fastest particle, and its remedy.
    pub gain: &'static str,
}

/// Advice for any method.
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

/// Body of particles, of any method: interface for contact with others ([`Bodies`](crate::particles::Bodies)).
///
/// Particles are the points of [`Body`], by the same numbers, below [`Body::len`]; their storage is up to the body. Vectors of `D`
/// components are those of the scene, vectors of three have zeros beyond.
///
/// Sequence of a step of `dt` seconds of all bodies together:
///
/// 1. [`check`](ParticleBody::check): loads and conditions at its times,
/// 2. [`accelerate`](ParticleBody::accelerate): trial velocities at its end, from forces and body force,
/// 3. impulses between bodies, each by [`push`](ParticleBody::push),
/// 4. [`advance`](ParticleBody::advance): conditions on velocities, new positions,
/// 5. [`finish`](ParticleBody::finish): strain, law, forces for the next step; the clock.
///
/// A body that steps alone makes the same sequence without 3. Contact conserves momentum to rounding, and books the kinetic energy it takes
/// with the mean of the velocities at the start and after 3; the exchange by conditions and loads is booked by the body
/// ([`exchange`](ParticleBody::exchange)).
///
/// Results must be bitwise equal for any number of threads.
pub trait ParticleBody<const D: usize>: Body + Send + Sync + Any {
    /// Particle `n`. Called in every step for those near other bodies.
    fn particle(&self, n: usize) -> ContactParticle<D>;

    /// Greatest speed of the particles, m/s.
    fn fastest(&self) -> f64 {
        let square = |n: usize| self.particle(n).velocity.iter().map(|v| v * v).sum::<f64>();
        (0..self.len()).map(square).fold(0.0, f64::max).sqrt()
    }

    /// True if particle `n` may be in contact with other bodies. Called in every step, before all else, for particles within reach of
    /// another body: excluded particles need no further calls, so that the inside of a body costs next to nothing. Particles that passed
    /// through the surface are then in contact only with those permitted: a body that others may enter keeps the default. Rigid walls act
    /// on every particle.
    fn may_touch(&self, _n: usize) -> bool {
        true
    }

    /// Surface at particle `n`, which is within reach of another body. On a plane of symmetry it has no components across the plane, since
    /// the other half of the body cancels them.
    fn facing(&self, n: usize) -> Facing;

    /// True if the positions of the particles ([`around`](ParticleBody::around)) define the surface normal better than
    /// [`facing`](ParticleBody::facing). This is so for kernels, which round an edge of a body: normal rules by particles
    /// ([`crate::SeparatingPlane`]) then use the positions. Facets of elements are more accurate.
    fn by_places(&self) -> bool {
        false
    }

    /// Distance of the surface beyond the centre of particle `n`, m: zero for particles on the surface, a radius for those half a spacing
    /// within it.
    fn beyond(&self, n: usize) -> f64;

    /// Call `visit` for the particles of the same piece of surface as particle `n`, itself included, each once and in an order that depends
    /// on the body alone. Normals by particles ([`crate::Regression`], [`crate::SeparatingPlane`]) place their planes between those of both
    /// bodies.
    fn around(&self, n: usize, visit: &mut dyn FnMut(usize));

    /// True if the body has surface points with normals ([`surface`](ParticleBody::surface)). Contact is then between these points and the
    /// surface interpolated between those of the other body, instead of between pairs of particles.
    fn has_surface(&self) -> bool {
        false
    }

    /// Find the surface points of these particles (ascending), for calls of [`surface`](ParticleBody::surface) before anything moves.
    fn find_surface(&mut self, _particles: &[usize]) {}

    /// Append the surface points of particle `n`: none within the body, several on edges. After
    /// [`find_surface`](ParticleBody::find_surface).
    fn surface(&self, _n: usize, _out: &mut Vec<SurfacePoint>) {}

    /// Call `visit` with each particle k that moves a surface point of particle `n`, and its weight W_k by axis: the velocity of the point
    /// is sum_k W_k v_k, and an impulse J on it acts on k by W_k J. The weights along an axis add up to 1, or less across a plane of symmetry.
    fn carriers(&self, n: usize, _point: &SurfacePoint, visit: &mut dyn FnMut(usize, [f64; 3])) {
        visit(n, [1.0; 3]);
    }

    /// Axes along which a condition prescribed the velocity of particle `n` in the last step: an impulse does not change it there.
    fn held(&self, _n: usize) -> [bool; 3] {
        [false; 3]
    }

    /// Normal traction n . sigma . n at particle `n`, Pa, tension positive, for [`crate::Compression`].
    fn traction(&self, n: usize, normal: &[f64; 3]) -> f64;

    /// Courant rate, 1/s: the step of the scene is at most its factor over the largest of all bodies.
    fn rate(&self) -> f64;

    /// Check that loads and conditions permit a step of `dt` seconds from now. Called before anything moves.
    ///
    /// # Errors
    /// Invalid load or condition.
    fn check(&self, dt: f64) -> Result<(), SceneError>;

    /// Set the trial velocities of all particles at the end of a step of `dt` seconds, from the forces of the last
    /// [`finish`](ParticleBody::finish) and the body force. Store their previous velocities in `start`, whatever its content.
    ///
    /// # Errors
    /// Failure, with body, point, position and cause.
    fn accelerate(&mut self, dt: f64, start: &mut Vec<[f64; D]>) -> Result<(), StepError>;

    /// Add an impulse, N s, to particle `n`: its velocity changes by impulse over mass.
    fn push(&mut self, n: usize, impulse: &[f64; 3]);

    /// Apply conditions to the velocities, and update positions. `start` is as stored by [`accelerate`](ParticleBody::accelerate).
    ///
    /// # Errors
    /// Errors of [`accelerate`](ParticleBody::accelerate).
    fn advance(&mut self, dt: f64, start: &[[f64; D]]) -> Result<(), StepError>;

    /// Update strains, stresses and forces at the new positions, and advance the body's clock by `dt`.
    ///
    /// # Errors
    /// Errors of [`accelerate`](ParticleBody::accelerate).
    fn finish(&mut self, dt: f64) -> Result<(), StepError>;

    /// Description of the method in one line, the same in a resumed scene: "particle-contact method: plane strain, ...".
    fn describe(&self) -> String;

    /// True for coordinates (r, z), with masses per radian.
    fn axisymmetric(&self) -> bool {
        false
    }

    /// Exchange with the surroundings since the start, without the impulses of other bodies.
    fn exchange(&self) -> Exchange;

    /// Speed scale of waves and particles, m/s: motion far below it is noise, which no energy balance judges.
    fn speed(&self) -> f64;

    /// Advice on energy loss or gain.
    fn advice(&self) -> Advice {
        Advice::default()
    }

    /// Set the name for messages and files.
    fn rename(&mut self, name: String);

    /// Set the thread pool; the body may use fewer threads where that is faster.
    fn set_team(&mut self, team: Team);

    /// Store or load the checkpoint data: the definition, to be compared, and all that changes in a run, the clock included. Like
    /// [`impactite_scene::Solver::archive`], but without a watch: the scene has one of its own.
    ///
    /// # Errors
    /// File errors; another body.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;
}
