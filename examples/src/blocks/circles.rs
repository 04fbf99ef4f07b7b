//! Bodies of particles in circles: the outermost ones touch the surface, where a lattice makes stairs.

use std::f64::consts::TAU;

use mpm_core::geometry::Seeds;

/// Which part of a disc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of it.
    Whole,
    /// That at x > 0.
    Half,
    /// That at x > 0, as a ball: volumes are per radian about x = 0.
    Ball,
}

/// A disc with particles about `particle` metres apart.
pub fn disc(centre: [f64; 2], radius: f64, particle: f64, part: Part) -> Seeds<2> {
    let layers = (radius / particle).round();
    let depth = radius / layers;
    let span = if part == Part::Whole { TAU } else { 0.5 * TAU };
    let (mut positions, mut volumes) = (Vec::new(), Vec::new());
    for layer in 0..layers as usize {
        let r = (layer as f64 + 0.5) * depth;
        let around = (span * r / depth).round().max(1.0);
        let area = span * r * depth / around;
        for j in 0..around as usize {
            let angle = span * ((j as f64 + 0.5) / around - 0.5);
            let x = r * angle.cos();
            positions.push([centre[0] + x, centre[1] + r * angle.sin()]);
            volumes.push(if part == Part::Ball { area * x } else { area });
        }
    }
    Seeds::placed(positions, volumes, [0.5 * depth; 2])
}
