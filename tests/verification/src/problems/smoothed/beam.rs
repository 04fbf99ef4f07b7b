//! Turek-Hron benchmark CSM3: a beam of 0.35 x 0.02 m swings under gravity of 2 m/s^2.

use mpm_core::geometry::{Cuboid, Filling, Lattice};
use mpm_core::{Boundary, PlaneStrain, Side};
use mpm_materials::{Elastic, LogarithmicBulk, Moduli, Solid};
use sph::Layout;

use super::{By, Setup, outcome, step, text};
use crate::case::Outcome;
use crate::work::Stopwatch;

const SIZE: [f64; 2] = [0.35, 0.02];
const GRAVITY: f64 = 2.0;
/// Minimum displacements of the tip, m, by Turek and Hron.
const LOWEST: [f64; 2] = [-29.30e-3, -129.73e-3];
/// End time, s; the minimum is at 0.46 s.
const END: f64 = 0.6;

/// Run CSM3; "down" and "back" are the errors of the minimum displacements of the tip.
pub fn run(by: By, cells: usize) -> Result<Outcome, String> {
    let moduli = Moduli::young_poisson(1.4e6, 0.4).map_err(text)?;
    let law = Solid::new(
        Elastic::new(moduli.shear).map_err(text)?,
        LogarithmicBulk::new(1000.0, moduli.bulk).map_err(text)?,
    );
    let shape = Cuboid::new([0.0; 2], SIZE).map_err(text)?;
    let lattice = Lattice::new([0.0; 2], SIZE[1] / cells as f64).map_err(text)?;
    // Particle rows on both ends, so that the clamp is at the beam root.
    let layout = Layout::on_faces(&shape, &lattice, [true, false], &Filling::new()).map_err(text)?;
    let boundaries = vec![Boundary::Fixed { axis: 0, at: 0.0, side: Side::Above }];
    let mut march =
        Setup { layout: &layout, velocity: &|_| [0.0; 2], boundaries }.body(by, PlaneStrain, law)?;
    let last = layout.positions.iter().map(|x| x[0]).fold(0.0, f64::max);
    let tip: Vec<usize> = (0..layout.len()).filter(|&n| layout.positions[n][0] > last - 1e-9).collect();
    let watch = Stopwatch::start();
    let mut least = [0.0f64; 2];
    while march.time < END {
        let dt = step(&march);
        march.smoothed_step(dt, Some(&|_| [0.0, -GRAVITY])).map_err(text)?;
        for (d, least) in least.iter_mut().enumerate() {
            let moved = |n: &usize| march.body.particle(*n).position[d] - layout.positions[*n][d];
            *least = least.min(tip.iter().map(moved).sum::<f64>() / tip.len() as f64);
        }
    }
    let [back, down] = [0, 1].map(|d| least[d] / LOWEST[d] - 1.0);
    Ok(outcome(&march, &watch).with("down", down).with("back", back))
}
