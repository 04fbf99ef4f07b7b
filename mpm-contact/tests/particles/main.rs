//! Contact between bodies of particles of a foreign method: balls on springs.

#![cfg(feature = "conformance")]
#![allow(missing_docs)]

mod bodies;
mod impacts;
mod refused;

use mpm_contact::conformance::Balls;
use mpm_contact::particles::Bodies;
use mpm_contact::{ContactLaw, Pairs, SurfaceDistance};

/// Radius of the balls of blocks, m.
const R: f64 = 0.5e-3;

/// Scene with one law.
fn scene<const D: usize>(law: impl ContactLaw<f64> + 'static) -> Bodies<D, SurfaceDistance> {
    Bodies::new(SurfaceDistance::default(), Pairs::new(law))
}

/// Block of bonded balls, 1 g each, with its first ball at `corner`.
fn block(corner: [f64; 2], counts: [u32; 2]) -> Balls<2> {
    let site = |i: u32, j: u32| [corner[0] + 2.0 * R * f64::from(i), corner[1] + 2.0 * R * f64::from(j)];
    let sites = (0..counts[1]).flat_map(|j| (0..counts[0]).map(move |i| site(i, j)));
    Balls::new(sites.collect(), R, 1.0e-3).bonded(1.0e6)
}
