//! Where two bodies may meet, whatever the method.

use mpm_core::parallel::Float;
use mpm_core::step::contact::SharedNodes;
use mpm_core::step::survey::{Near, Survey};

/// Up to 64 places where bodies may meet, by number: nodes of a block of the grid ([`SharedNodes`]), or pairs of particles
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
    /// Ask a field about some places, a bit each: vectors are added to `out`, lengths replace smaller ones there. With
    /// pairs of particles the field is there with one particle, and sums over particles p are over the elements at it.
    fn survey(&self, field: usize, what: Survey, places: u64, normals: &[[T; 3]], out: &mut [[T; 3]]);
    /// Call `visit` for every particle of a field near some places, a bit each, with those of them that it is near to.
    fn near(&self, field: usize, places: u64, visit: &mut dyn FnMut(u64, &Near<T>));
}

impl<T: Float, const D: usize> Places<T, D> for SharedNodes<'_, T, D> {
    fn body(&self, field: usize) -> usize {
        SharedNodes::body(self, field)
    }
    fn spacing(&self) -> f64 {
        SharedNodes::spacing(self)
    }
    fn position(&self, n: usize) -> [f64; D] {
        SharedNodes::position(self, n)
    }
    fn survey(&self, field: usize, what: Survey, places: u64, normals: &[[T; 3]], out: &mut [[T; 3]]) {
        SharedNodes::survey(self, field, what, places, normals, out);
    }
    fn near(&self, field: usize, places: u64, visit: &mut dyn FnMut(u64, &Near<T>)) {
        SharedNodes::near(self, field, places, visit);
    }
}
