//! Scenes and measures.

use flow::{Flow, FlowOptions, Fluid, Wall};
use impactite_geometry::{Cuboid, Lattice, Seeds};
use impactite_scene::{PointView, Solver};

use crate::gates::Scheme;

pub const GRAVITY: f64 = 9.81;

/// Lattice of particles, `per` along an axis of a cell of width `h`, in a box.
pub fn box_of_particles<const D: usize>(low: [f64; D], high: [f64; D], h: f64, per: usize) -> Seeds<D> {
    let counts: [usize; D] = std::array::from_fn(|d| ((high[d] - low[d]) / h * per as f64).round() as usize);
    let steps: [f64; D] = std::array::from_fn(|d| (high[d] - low[d]) / counts[d] as f64);
    let mut positions = Vec::new();
    for n in 0..counts.iter().product() {
        let mut rest: usize = n;
        positions.push(std::array::from_fn(|d| {
            let at = rest % counts[d];
            rest /= counts[d];
            low[d] + (at as f64 + 0.5) * steps[d]
        }));
    }
    let volumes = vec![steps.iter().product(); positions.len()];
    Seeds::placed(positions, volumes, steps.map(|s| 0.5 * s))
}

/// Tank of length `length` with water of depth `depth` and the surface depth + surface(x), `cells` along it, with gravity.
pub fn tank(scheme: Scheme, length: f64, depth: f64, cells: usize, surface: impl Fn(f64) -> f64) -> Flow<2> {
    viscous_tank(scheme, length, depth, cells, 0.0, surface)
}

/// [`tank`] of a liquid of this viscosity, Pa s, and a density of 1000 kg/m^3.
pub fn viscous_tank(
    scheme: Scheme,
    length: f64,
    depth: f64,
    cells: usize,
    viscosity: f64,
    surface: impl Fn(f64) -> f64,
) -> Flow<2> {
    let h = length / cells as f64;
    let mut flow = Flow::new(scheme(FlowOptions::new(Lattice::new([0.0; 2], h).unwrap())));
    flow.add_wall(Wall::container(Cuboid::new([0.0; 2], [length, 2.0 * depth]).unwrap())).unwrap();
    let mut seeds = box_of_particles([0.0; 2], [length, depth], h, 2);
    for (x, volume) in seeds.positions.iter_mut().zip(&mut seeds.volumes) {
        let stretch = 1.0 + surface(x[0]) / depth;
        (x[1], *volume) = (x[1] * stretch, *volume * stretch);
    }
    let fluid = Fluid::new(1000.0).unwrap().with_viscosity(viscosity).unwrap();
    flow.add_fluid("water", fluid, &seeds, |_| [0.0; 2]).unwrap();
    flow.set_body_force(|_| [0.0, -GRAVITY]);
    flow
}

/// Centroid of the particles.
pub fn centroid(points: &[PointView]) -> [f64; 3] {
    let volume: f64 = points.iter().map(|p| p.volume).sum();
    std::array::from_fn(|d| points.iter().map(|p| p.volume * p.position[d]).sum::<f64>() / volume)
}

/// Mechanical energy: kinetic energy and that of constant gravity, J.
pub fn energy<const D: usize>(flow: &Flow<D>) -> f64 {
    let totals = flow.totals();
    totals.kinetic + GRAVITY * totals.mass * centroid(&flow.points())[1]
}
