//! Places of possible contact of two bodies, for any method.

use impactite_simd::Float;

/// Quantities of a body's surface at a place, for detectors and normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceQuantity {
    /// Mass gradient sum_p m_p grad N_ip, kg/m; it points out of the body \[Zhang2017\].
    MassGradient,
    /// Volume gradient sum_p V_p grad N_ip, m^2; it points out of the body \[BardenhagenGuilkey2001\].
    VolumeGradient,
    /// Reach of the surface beyond the place along its normal n, m: max_p [(x_p - x_i) . n + l_p], with l_p the particle's half size (eq. 5
    /// of \[Ma2010\]). First component; start from a large negative number.
    Reach,
    /// Local reach: [`SurfaceQuantity::Reach`] of the particles whose centres are within half a cell of the line through the place along
    /// its normal, or whose domains the line passes through, without bulges beside it.
    LocalReach,
    /// Reach of the centres: [`SurfaceQuantity::Reach`] without l_p.
    CentreReach,
    /// Traction sum_p N_ip m_p n . sigma_p . n, Pa kg: over the mass at the place the normal traction \[BardenhagenGuilkey2001\], tension
    /// positive. First component.
    Traction,
}

/// Particle near places of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearPoint<T> {
    /// Position relative to the first place (of a block of nodes: its first node), m.
    pub offset: [T; 3],
    /// Half sizes, m.
    pub half: [T; 3],
    /// Bound of the half size in any direction, m.
    pub radius: T,
    /// Mass, kg.
    pub mass: T,
}

/// Up to 64 places of possible contact, by number: nodes of a block of a grid, or pairs of particles of a method without grid. Normal rules
/// and detectors use nothing else, and thus serve all methods.
///
/// Bodies are *fields* here, numbered from 0 among those at these places.
pub trait Places<T: Float, const D: usize> {
    /// Number of the body of a field.
    fn body(&self, field: usize) -> usize;
    /// Spacing: distance of nodes, or mean diameter of particles, m: the unit of thresholds.
    fn spacing(&self) -> f64;
    /// True if the places are nodes, with particles of both bodies around them. Otherwise they are pairs of particles, each with its own
    /// surface.
    fn around_nodes(&self) -> bool {
        true
    }
    /// Position of place `n`, m.
    fn position(&self, n: usize) -> [f64; D];
    /// Mass of a field at a place, kg; infinite for prescribed motion.
    fn mass(&self, field: usize, n: usize) -> T;
    /// Trial velocity of a field at a place, m/s: the one at the end of the step without contact.
    fn velocity(&self, field: usize, n: usize) -> [T; 3];
    /// Evaluate a quantity of a field's surface at some places (bit set), with the normals where they are needed: vectors are added to
    /// `out`, lengths replace smaller ones there. For pairs of particles the field has one particle there, and sums over particles p are
    /// over the elements at it.
    fn surface_quantity(
        &self,
        field: usize,
        quantity: SurfaceQuantity,
        places: u64,
        normals: &[[T; 3]],
        out: &mut [[T; 3]],
    );
    /// Call `visit` for every particle of a field near some places (bit set), with those of them that it is near to.
    fn near_points(&self, field: usize, places: u64, visit: &mut dyn FnMut(u64, &NearPoint<T>));
}

/// Iterate over the places of a bit set, in order.
///
/// ```
/// assert!(mpm_contact::each_place(0b1010).eq([1, 3]));
/// ```
pub fn each_place(mut places: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = places.trailing_zeros() as usize;
        places &= places.wrapping_sub(1);
        (place < 64).then_some(place)
    })
}
