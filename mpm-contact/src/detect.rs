//! Contact detection at nodes that two bodies share.

use impactite_simd::Float;
use mpm_materials::{Check, ParameterError};

use crate::normal::{Gradients, Nodal, NormalRule};
use crate::places::{Places, SurfaceQuantity, each_place};
use crate::separate::SeparatingPlane;
use crate::vector::times;

/// Basis of contact detection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// State of the bodies, stress for example: evaluated in every step.
    State,
    /// Contact wherever the bodies share a node.
    Always,
    /// Gap of at most this, m. It is measured from time to time, and extrapolated in between.
    Gap(f64),
}

/// Contact detector for two bodies at the nodes they share. Their approach, (v_r - v_s) . n > 0 (eq. 4 of \[Ma2010\]), is checked before,
/// unless the law pulls or springs, or a third body is at the node.
pub trait ContactDetector<T: Float, const D: usize>: std::fmt::Debug + Send + Sync + 'static {
    /// Basis of [`ContactDetector::touching`], for cells of `spacing`, m.
    fn criterion(&self, _spacing: f64) -> Criterion {
        Criterion::State
    }
    /// True if no gap is smaller than the distance of the particles' surfaces along the normal, as with [`SurfaceQuantity::Reach`]. With
    /// [`Criterion::Gap`] normals are then omitted where the particles of a pair are farther apart ([`NormalRule::normals_within`]).
    fn measures_surfaces(&self) -> bool {
        false
    }
    /// Type of the normal rule.
    type Normals: NormalRule<T, D>;
    /// Normal rule.
    fn normals(&self) -> &Self::Normals;
    /// Select those of `nodes` (bit set) where the pair is in contact, for these normals from the first field to the second. Writes the
    /// gaps, m, if it measures them. The result must not depend on the order of the fields.
    fn touching(
        &self,
        at: &dyn Places<T, D>,
        pair: [usize; 2],
        nodes: u64,
        normals: &Nodal<[T; 3]>,
        gaps: &mut Nodal<Option<T>>,
    ) -> u64;
}

/// Detection by approach: contact where bodies share a node and approach (eq. 4 of \[Ma2010\]): up to two cells too early, three with
/// quadratic splines.
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

/// Detection by compression: contact where bodies approach and the mean of their normal tractions, sum_p N_ip m_p n . sigma_p . n over the
/// mass of both, is compressive \[BardenhagenGuilkey2001\]. Stress-free bodies are in contact as with [`Approach`], or contact would never
/// begin.
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

/// Detection by surface distance: contact where bodies approach and their gap is at most a threshold (eq. 5 of \[Ma2010\]): gap = -max_p
/// \[(x_p - x_i) . n + l_p\] of the first body - the same of the second along -n.
///
/// With l_p the particle's half size, the bracket is the reach of the surface beyond the node, and the threshold is zero. The later form
/// \[Zhang2017\] omits l_p and uses lambda = 0.5 cells: the same for two particles per cell and axis
/// ([`SurfaceDistance::between_centres`]). With both there is a gap of half a cell. Half sizes are those of seeding, or the convected ones
/// of shape functions that carry them; the half size along an oblique normal is that of the ellipsoid in the particle's box.
///
/// The largest reach of all particles around a node may be that of a bulge up to a cell (1.5 with quadratic splines) beside it: a ball on a
/// plane is then supported by nodes that it has not reached, is too stiff, and is stopped by them when it rolls. The default therefore
/// measures along the line through the node alone ([`SurfaceDistance::locally`]).
///
/// Normals of the [`SeparatingPlane`] do not tilt at edges. Those of [`crate::Gradients`] do: sliding blocks plough and lift off, and
/// oblique surfaces are in contact up to 0.7 cells early (book, "Detection and normals").
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceDistance<N = SeparatingPlane> {
    normals: N,
    threshold: f64,
    what: SurfaceQuantity,
}
impl Default for SurfaceDistance {
    /// Use half sizes, threshold zero, local reach and normals of the separating plane.
    fn default() -> Self {
        SurfaceDistance { normals: SeparatingPlane, threshold: 0.0, what: SurfaceQuantity::LocalReach }
    }
}
impl<N> SurfaceDistance<N> {
    /// Create with surfaces that touch at the particles' half sizes.
    pub(crate) fn touching_along(normals: N) -> Self {
        SurfaceDistance { normals, threshold: 0.0, what: SurfaceQuantity::Reach }
    }
    /// Create with surfaces at the particles' half sizes, in contact closer than `threshold` cells (0, or a little more for early contact).
    ///
    /// # Errors
    /// A threshold that is not finite.
    pub fn new(normals: N, threshold: f64) -> Result<Self, ParameterError> {
        let threshold = Check("surface distance").that(true, "threshold", threshold, "finite")?;
        Ok(SurfaceDistance { normals, threshold, what: SurfaceQuantity::Reach })
    }
    /// Create the form without half sizes: contact where particle centres are closer than `lambda` cells along the normal; 0.5 in
    /// \[Zhang2017\].
    ///
    /// # Errors
    /// A lambda that is not positive.
    pub fn between_centres(normals: N, lambda: f64) -> Result<Self, ParameterError> {
        let threshold = Check("surface distance").positive("lambda", lambda)?;
        Ok(SurfaceDistance { normals, threshold, what: SurfaceQuantity::CentreReach })
    }
    /// Measure surfaces at the particles' half sizes, only by particles whose centres are within half a cell of the line through the node
    /// along the normal, or whose domains the line passes through.
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

/// Reach of the surfaces of both fields of a pair beyond places, towards the other along the normals, m, in the first components; a large
/// negative number for a body without particles near the line of [`SurfaceQuantity::LocalReach`].
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
    for ((field, normals), reach) in pair.into_iter().zip([normals, &opposite]).zip(&mut reach) {
        at.surface_quantity(field, what, nodes, normals, reach);
    }
    reach
}
