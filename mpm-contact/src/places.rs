//! Where two bodies may touch, whatever the method.

use impactite_simd::Float;

/// What detectors and normals ask of a body's surface at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceQuantity {
    /// sum_p m_p grad N_ip, kg/m; it points out of the body \[Zhang2017\].
    MassGradient,
    /// sum_p V_p grad N_ip, m^2; likewise \[BardenhagenGuilkey2001\].
    VolumeGradient,
    /// max_p [(x_p - x_i) . n + l_p], m, with n the place's normal and l_p the particle's half size: how far the
    /// surface reaches beyond the place along n (eq. 5 of \[Ma2010\]). First component; start from a large
    /// negative number.
    Reach,
    /// [`SurfaceQuantity::Reach`] of the particles whose centres lie within half a cell of the line through the place along
    /// its normal: how far the surface reaches there, and not where it bulges beside it.
    LocalReach,
    /// [`SurfaceQuantity::Reach`] without l_p: how far the centres reach.
    CentreReach,
    /// sum_p N_ip m_p n . sigma_p . n, Pa kg: over the mass at the place the normal traction
    /// \[BardenhagenGuilkey2001\], tension positive. First component.
    Traction,
}

/// A particle near places of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearPoint<T> {
    /// Its position less that of the first place (of a block of nodes: its first node), m.
    pub offset: [T; 3],
    /// Its half sizes, m.
    pub half: [T; 3],
    /// Its mass, kg.
    pub mass: T,
}

/// Up to 64 places where bodies may touch, by number: nodes of a block of a grid, or pairs of particles
/// of a method without grid. Normal rules and detectors ask nothing else, and so serve all of them.
///
/// Bodies are *fields* here, numbered from 0 among those at these places.
pub trait Places<T: Float, const D: usize> {
    /// Number of a field's body.
    fn body(&self, field: usize) -> usize;
    /// Distance of nodes, or mean diameter of particles, m: the length that thresholds are in.
    fn spacing(&self) -> f64;
    /// Are the places nodes, around which particles of both bodies lie? Else they are pairs of particles, each with its own surface.
    fn around_nodes(&self) -> bool {
        true
    }
    /// Where place `n` is, m.
    fn position(&self, n: usize) -> [f64; D];
    /// Mass of a field at a place, kg; infinite if the body's motion is prescribed.
    fn mass(&self, field: usize, n: usize) -> T;
    /// Its trial velocity there, m/s: the one at the end of the step without contact.
    fn velocity(&self, field: usize, n: usize) -> [T; 3];
    /// A quantity of a field's surface at some places, a bit each, with the normals of those that need one: vectors are added to
    /// `out`, lengths replace smaller ones there. With pairs of particles the field is there with one particle, and sums over
    /// particles p are over the elements at it.
    fn surface_quantity(
        &self,
        field: usize,
        quantity: SurfaceQuantity,
        places: u64,
        normals: &[[T; 3]],
        out: &mut [[T; 3]],
    );
    /// Call `visit` for every particle of a field near some places, a bit each, with those of them that it is near to.
    fn near_points(&self, field: usize, places: u64, visit: &mut dyn FnMut(u64, &NearPoint<T>));
}

/// The places of a set, a bit each, in order.
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
