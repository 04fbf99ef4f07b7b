//! Laws, boxes and particles that the tests share.

use impactite_geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_materials::{LinearElastic, Moduli};

pub fn elastic(density: f64, young: f64, poisson: f64) -> LinearElastic<f64> {
    LinearElastic::new(density, Moduli::young_poisson(young, poisson).expect("moduli")).expect("law")
}

pub fn boxed<const D: usize>(low: [f64; D], high: [f64; D]) -> Cuboid<D> {
    Cuboid::new(low, high).expect("cuboid")
}

/// Two particles a cell and axis.
pub fn seeds<const D: usize>(cuboid: &Cuboid<D>, lattice: &Lattice<D>) -> Seeds<D> {
    fill(cuboid, lattice, 2, &Filling::new()).expect("seeds")
}
