//! Do two bodies touch at a node?

use impactite_simd::Float;
use mpm_materials::{Check, ParameterError};

use crate::normal::{Gradients, Nodal, NormalRule};
use crate::places::{Places, SurfaceQuantity, each_place};
use crate::separate::SeparatingPlane;
use crate::vector::times;

/// What it follows from whether bodies touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// From their state, stress for example: asked in every step.
    State,
    /// They do wherever they share a node.
    Always,
    /// The gap is at most this, m. It is measured now and then, and followed in between.
    Gap(f64),
}

/// A test whether two bodies touch at the nodes they share. Whether they approach is asked before it
/// ((v_r - v_s) . n > 0, eq. 4 of \[Ma2010\]), unless the law pulls or springs, or a third body is at the node.
pub trait ContactDetector<T: Float, const D: usize>: std::fmt::Debug + Send + Sync + 'static {
    /// What the answer of [`ContactDetector::touching`] follows from, for cells of `spacing`, m.
    fn criterion(&self, _spacing: f64) -> Criterion {
        Criterion::State
    }
    /// Where the normals come from.
    type Normals: NormalRule<T, D>;
    /// The rule for the normals.
    fn normals(&self) -> &Self::Normals;
    /// Of `nodes` (a bit each), those where the pair touches, for these normals from the first field to the
    /// second. Fills in the gaps, m, if it measures them. Must not depend on which field is the first.
    fn touching(
        &self,
        at: &dyn Places<T, D>,
        pair: [usize; 2],
        nodes: u64,
        normals: &Nodal<[T; 3]>,
        gaps: &mut Nodal<Option<T>>,
    ) -> u64;
}

/// Bodies touch where they share a node and approach (eq. 4 of \[Ma2010\]): up to two cells too early, three
/// with quadratic splines.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Approach<N = Gradients>(pub N);
impl<T: Float, const D: usize, N: NormalRule<T, D>> ContactDetector<T, D> for Approach<N> {
    type Normals = N;
    fn criterion(&self, _spacing: f64) -> Criterion {
        Criterion::Always
    }
    fn normals(&self) -> &N {
        &self.0
    }
    fn touching(
        &self,
        _at: &dyn Places<T, D>,
        _pair: [usize; 2],
        nodes: u64,
        _normals: &Nodal<[T; 3]>,
        _gaps: &mut Nodal<Option<T>>,
    ) -> u64 {
        nodes
    }
}

/// Bodies touch where they approach and the mean of their normal tractions, sum_p N_ip m_p n . sigma_p . n over the
/// mass of both, is compressive \[BardenhagenGuilkey2001\]; bodies free of stress touch as with [`Approach`],
/// or they would never begin to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Compression<N = Gradients>(pub N);
impl<T: Float, const D: usize, N: NormalRule<T, D>> ContactDetector<T, D> for Compression<N> {
    type Normals = N;
    fn normals(&self) -> &N {
        &self.0
    }
    fn touching(
        &self,
        at: &dyn Places<T, D>,
        pair: [usize; 2],
        nodes: u64,
        normals: &Nodal<[T; 3]>,
        _gaps: &mut Nodal<Option<T>>,
    ) -> u64 {
        let mut sums: [Nodal<[T; 3]>; 2] = [[[T::of(0.0); 3]; 64]; 2];
        for side in 0..2 {
            at.surface_quantity(pair[side], SurfaceQuantity::Traction, nodes, normals, &mut sums[side]);
        }
        let touches = |n: &usize| sums[0][*n][0] + sums[1][*n][0] <= T::of(0.0);
        each_place(nodes).filter(touches).fold(0, |bits, n| bits | 1 << n)
    }
}

/// Bodies touch where they approach and their surfaces are no further apart than a threshold (eq. 5 of \[Ma2010\]):
/// gap = -max_p \[(x_p - x_i) . n + l_p\] of the first body - the same of the second along -n.
///
/// With l_p the particle's half size the bracket is how far the surface reaches beyond the node, and the
/// threshold is zero. The later form \[Zhang2017\] leaves l_p out and touches at lambda = 0.5 cells: the same for two
/// particles a cell and axis ([`SurfaceDistance::between_centres`]). With both there is a gap of half a cell.
/// Half sizes are those of seeding, or the convected ones of shape functions that carry them; the half size along an
/// oblique normal is that of the ellipsoid in the particle's box.
///
/// The largest reach of all particles around a node may be that of a bulge up to a cell (1.5 with quadratic splines)
/// beside it: a ball on a plane then rests on nodes that it has not reached, stiffer than it is, and is stopped by them where it rolls.
/// The default therefore measures along the line through the node alone ([`SurfaceDistance::locally`]).
///
/// Normals of the [`SeparatingPlane`] do not tilt at edges, as those of [`crate::Gradients`] do, which makes blocks plough and lift off where they
/// slide, and lets oblique surfaces meet up to 0.7 cells early (book, "Detection and normals").
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceDistance<N = SeparatingPlane> {
    normals: N,
    threshold: f64,
    what: SurfaceQuantity,
}
impl Default for SurfaceDistance {
    /// Half sizes, threshold zero, normals of the separating plane, locally.
    fn default() -> Self {
        SurfaceDistance { normals: SeparatingPlane, threshold: 0.0, what: SurfaceQuantity::LocalReach }
    }
}
impl<N> SurfaceDistance<N> {
    /// Surfaces at the particles' half sizes, in contact closer than `threshold` cells (0, or a little more to
    /// touch early).
    ///
    /// # Errors
    /// A threshold that is not finite.
    pub fn new(normals: N, threshold: f64) -> Result<Self, ParameterError> {
        let threshold = Check("surface distance").that(true, "threshold", threshold, "finite")?;
        Ok(SurfaceDistance { normals, threshold, what: SurfaceQuantity::Reach })
    }
    /// The form without half sizes: in contact where particle centres are closer than `lambda` cells along the
    /// normal; 0.5 in \[Zhang2017\].
    ///
    /// # Errors
    /// A lambda that is not positive.
    pub fn between_centres(normals: N, lambda: f64) -> Result<Self, ParameterError> {
        let threshold = Check("surface distance").positive("lambda", lambda)?;
        Ok(SurfaceDistance { normals, threshold, what: SurfaceQuantity::CentreReach })
    }
    /// Measure surfaces at particles' half sizes, and only by particles whose centres lie within half a cell of the
    /// line through the node along the normal; by all particles around the node where there is none of one of the bodies.
    #[must_use]
    pub fn locally(mut self) -> Self {
        self.what = SurfaceQuantity::LocalReach;
        self
    }
}
impl<T: Float, const D: usize, N: NormalRule<T, D>> ContactDetector<T, D> for SurfaceDistance<N> {
    type Normals = N;
    fn criterion(&self, spacing: f64) -> Criterion {
        Criterion::Gap(self.threshold * spacing)
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
        let reach = distances(at, self.what, pair, nodes, normals);
        let threshold = T::of(self.threshold * at.spacing());
        let mut touching = 0;
        for n in each_place(nodes) {
            let gap = -(reach[0][n][0] + reach[1][n][0]);
            gaps[n] = Some(gap);
            if gap <= threshold {
                touching |= 1 << n;
            }
        }
        touching
    }
}

/// How far the surfaces of both fields of a pair reach beyond places, towards the other along the normals, m, in the first components:
/// by all particles around the place where none of a body is near the line that [`SurfaceQuantity::LocalReach`] looks along.
pub(crate) fn distances<T: Float, const D: usize>(
    at: &dyn Places<T, D>,
    what: SurfaceQuantity,
    pair: [usize; 2],
    nodes: u64,
    normals: &Nodal<[T; 3]>,
) -> [Nodal<[T; 3]>; 2] {
    let far = T::of(-1e30);
    let mut reach: [Nodal<[T; 3]>; 2] = [[[far; 3]; 64]; 2];
    let mut opposite = *normals;
    each_place(nodes).for_each(|n| opposite[n] = times(normals[n], T::of(-1.0)));
    let mut ask = |what, nodes| {
        at.surface_quantity(pair[0], what, nodes, normals, &mut reach[0]);
        at.surface_quantity(pair[1], what, nodes, &opposite, &mut reach[1]);
        let missed = |n: &usize| reach.iter().any(|r| r[*n][0] <= far);
        each_place(nodes).filter(missed).fold(0, |bits, n| bits | 1 << n)
    };
    let missed = ask(what, nodes);
    if missed != 0 && what == SurfaceQuantity::LocalReach {
        ask(SurfaceQuantity::Reach, missed);
    }
    reach
}
