//! Detectors for one pair of bodies at one place.

use impactite_simd::Float;

use crate::detect::{ContactDetector, Criterion, distances};
use crate::normal::{Nodal, NormalRule};
use crate::places::{Places, SurfaceQuantity, each_place};
use crate::separate::SeparatingPlane;
use crate::vector::{difference, dot};

/// Surfaces of two bodies at a place of possible contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePair {
    /// Numbers of the bodies; the smaller first.
    pub bodies: [usize; 2],
    /// Position of the place, m: a node, or half way between two particles.
    pub position: [f64; 3],
    /// Spacing: distance of nodes, or mean diameter of particles, m.
    pub spacing: f64,
    /// Unit normal, from the first body to the second.
    pub normal: [f64; 3],
    /// Reach of the surface of each body beyond the place, towards the other along the normal, m; negative if it ends short of it.
    pub reaches: [f64; 2],
    /// Masses at the place, kg; infinite for a body of prescribed motion.
    pub masses: [f64; 2],
    /// Trial velocities, m/s: those at the end of the step without contact.
    pub velocities: [[f64; 3]; 2],
}

impl SurfacePair {
    /// Gap: distance of the surfaces along the normal, m; negative for overlap.
    #[must_use]
    pub fn gap(&self) -> f64 {
        -(self.reaches[0] + self.reaches[1])
    }
    /// Approach velocity along the normal, m/s; negative at separation.
    #[must_use]
    pub fn approach(&self) -> f64 {
        dot(difference(self.velocities[0], self.velocities[1]), self.normal)
    }
}

/// Detector by one function of one pair at one place. [`EachPair`] makes a [`ContactDetector`] of it, in two dimensions and three, for
/// grids and pairs of particles, in single and double precision.
///
/// ```
/// use mpm_contact::{EachPair, PairDetector, SurfacePair};
///
/// /// Surfaces touch that will overlap at the end of the step.
/// #[derive(Clone, Debug)]
/// struct Foreseen {
///     dt: f64,
/// }
/// impl PairDetector for Foreseen {
///     fn touches(&self, pair: &SurfacePair) -> bool {
///         pair.gap() - pair.approach() * self.dt <= 0.0
///     }
/// }
/// let detector = EachPair::new(Foreseen { dt: 1e-4 });
/// # let _ = detector;
/// ```
pub trait PairDetector: std::fmt::Debug + Send + Sync + 'static {
    /// True if the bodies are in contact there. The result must not depend on their order. (Approach is checked separately, as for every
    /// [`ContactDetector`].)
    fn touches(&self, pair: &SurfacePair) -> bool;
    /// Basis of the detection, for cells of `spacing`, m. By default it is evaluated in every step; [`Criterion::Gap`] of a number means
    /// contact if [`SurfacePair::gap`] is at most that, which is measured from time to time, at a fraction of the cost.
    fn criterion(&self, _spacing: f64) -> Criterion {
        Criterion::State
    }
}

/// Contact detector of a [`PairDetector`], with a normal rule. Surfaces are at particles' half sizes, along the line through the place
/// ([`crate::SurfaceDistance::locally`]).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EachPair<P, N = SeparatingPlane> {
    detector: P,
    normals: N,
}

impl<P> EachPair<P> {
    /// Create with normals of the [`SeparatingPlane`].
    pub fn new(detector: P) -> Self {
        EachPair { detector, normals: SeparatingPlane }
    }
}
impl<P, N> EachPair<P, N> {
    /// Set another normal rule.
    pub fn with_normals<M>(self, normals: M) -> EachPair<P, M> {
        EachPair { detector: self.detector, normals }
    }
}

impl<T: Float, const D: usize, P: PairDetector, N: NormalRule<T, D>> ContactDetector<T, D>
    for EachPair<P, N>
{
    type Normals = N;
    fn criterion(&self, spacing: f64) -> Criterion {
        self.detector.criterion(spacing)
    }
    fn measures_surfaces(&self) -> bool {
        true
    }
    fn normals(&self) -> &N {
        &self.normals
    }
    fn touching(
        &self,
        at: &dyn Places<T, D>,
        pair: [usize; 2],
        nodes: u64,
        normals: &Nodal<[T; 3]>,
        gaps: &mut Nodal<Option<T>>,
    ) -> u64 {
        let reach = distances(at, SurfaceQuantity::LocalReach, pair, nodes, normals);
        let bodies = pair.map(|field| at.body(field));
        let mut touching = 0;
        for n in each_place(nodes) {
            let mut position = [0.0; 3];
            position[..D].copy_from_slice(&at.position(n));
            let seen = SurfacePair {
                bodies,
                position,
                spacing: at.spacing(),
                normal: normals[n].map(T::to_double),
                reaches: [reach[0][n][0].to_double(), reach[1][n][0].to_double()],
                masses: pair.map(|field| at.mass(field, n).to_double()),
                velocities: pair.map(|field| at.velocity(field, n).map(T::to_double)),
            };
            gaps[n] = Some(T::of(seen.gap()));
            touching |= u64::from(self.detector.touches(&seen)) << n;
        }
        touching
    }
}
