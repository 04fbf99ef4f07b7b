//! Elastic bar: steel, 1 mm x 20 mm, 50 m/s on a rigid wall, between planes: with free sides, lateral inertia would
//! dominate the error of every method.

use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::{BlockGrid, Boundary, Flip, Gimp, IntoKernels, Linear, Method, Mpm, Musl, PlaneStrain, Side};
use mpm_materials::{Elastic, LogarithmicBulk, Moduli, Solid};
use pcmm::{LocalDelaunay, Masses, Packing, Pcmm};

use crate::{Failure, Way};

const SIZE: [f64; 2] = [1.0e-3, 20.0e-3];
const SPEED: f64 = 50.0;
const END: f64 = 9.0e-6;
/// Number of entries of a history.
const ENTRIES: usize = 450;

/// Mean of |v - exact| over 9 microseconds at half the length, over the impact speed. Laterally confined, the bar obeys the
/// wave equation with c^2 = E (1 - nu) / ((1 + nu) (1 - 2 nu) rho).
pub fn error(way: Way, cells: u32) -> Result<f64, Failure> {
    let h = SIZE[0] / f64::from(cells);
    let moduli = Moduli::young_poisson(206e9, 0.3)?;
    // Common law of all methods.
    let steel = Solid::new(Elastic::new(moduli.shear)?, LogarithmicBulk::new(7850.0, moduli.bulk)?)
        .with_bulk_viscosity(0.06, 1.5)?;
    let shape = Cuboid::new([0.0; 2], SIZE)?;
    let lattice = Lattice::new([0.0; 2], h)?;
    let boundaries = [
        Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 },
        Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above },
        Boundary::Symmetry { axis: 0, at: SIZE[0], side: Side::Below },
    ];
    let transit = SIZE[1] / (206e9 * 0.7 / (1.3 * 0.4 * 7850.0f64)).sqrt();
    let exact = |t: f64| match t / transit {
        x if x < 0.5 => SPEED,
        x if x < 1.5 => 0.0,
        _ => -SPEED,
    };
    let mut sum = 0.0;
    let mut note = |time: f64, velocity: f64| sum += (velocity - exact(time)).abs() / SPEED / ENTRIES as f64;
    let times = (1..=ENTRIES).map(|n| END * n as f64 / ENTRIES as f64);
    match way {
        Way::Contacts => {
            let packing = Packing::on_nodes(&shape, &lattice)?;
            let method = pcmm::Method::consistent(PlaneStrain, LocalDelaunay::new(0.45 * h, 2.0)?);
            let mut bar = Pcmm::new(method, steel, &packing, |_| [0.0, -SPEED], Masses::FromElements)?;
            boundaries.into_iter().try_for_each(|b| bar.bound(b))?;
            bar.set_revision_interval(10)?;
            let middle: Vec<usize> = (0..packing.positions.len())
                .filter(|&n| (packing.positions[n][1] - 0.5 * SIZE[1]).abs() < 0.75 * h)
                .collect();
            for time in times {
                bar.run_until(time)?;
                let all: f64 = middle.iter().map(|&n| -bar.particles()[n].velocity[1]).sum();
                note(time, all / middle.len() as f64);
            }
        }
        Way::Linear => {
            let method = Method::new(Linear, Flip, Musl, PlaneStrain);
            points(method, steel, &shape, lattice, boundaries, times, note)?;
        }
        Way::Gimp => {
            let method = Method::new(Gimp, Flip, Musl, PlaneStrain).compiled();
            points(method, steel, &shape, lattice, boundaries, times, note)?;
        }
    }
    Ok(sum)
}

type Steel =
    Solid<Elastic<f64>, LogarithmicBulk<f64>, mpm_materials::NoFailure, mpm_materials::BulkViscosity<f64>>;

fn points(
    method: impl IntoKernels<f64, 2>,
    steel: Steel,
    shape: &Cuboid<2>,
    lattice: Lattice<2>,
    boundaries: [Boundary<2>; 3],
    times: impl Iterator<Item = f64>,
    mut note: impl FnMut(f64, f64),
) -> Result<(), Failure> {
    let seeds = fill(shape, &lattice, 2, &Filling::new())?;
    let mut bar = Mpm::new(method, BlockGrid::new(lattice));
    bar.add("bar", steel, &seeds, |_| [0.0, -SPEED])?;
    for boundary in boundaries {
        bar.bound(boundary)?;
    }
    let near = |y: f64| (y - 0.5 * SIZE[1]).abs() < 0.51 * lattice.spacing();
    let is_middle: Vec<bool> = seeds.positions.iter().map(|x| near(x[1])).collect();
    let count = is_middle.iter().filter(|m| **m).count() as f64;
    for time in times {
        bar.run_until(time)?;
        let mut all = 0.0;
        bar.bodies()[0].for_each(&mut |p| {
            if is_middle[p.number] {
                all -= p.velocity[1];
            }
        });
        note(time, all / count);
    }
    Ok(())
}
