//! Profile of the particle-contact method: element updates per second, and time shares of neighbour search and
//! revisions.

use std::time::Instant;

use clap::Parser;
use mpm_core::Solver as _;
use mpm_core::geometry::{Ball, Compose, Cuboid, Filling, Lattice, fill};
use mpm_core::{Axisymmetric, Boundary, PlaneStrain, Side, Team, TimeControl};
use mpm_materials::{Elastic, LogarithmicBulk, Moduli, Solid, TensilePressure, library};
use pcmm::{Composition, LocalDelaunay, Masses, Method, Neighbours, Packing, Pcmm};

/// Elements updated a second on one thread, and parts of the time, in three scenes: an elastic bar, where nothing
/// changes, a copper bar that flows, a cloud of debris. Revisions are driven from outside to be timed.
#[derive(Debug, Parser)]
#[command(name = "pcmm_cost", version)]
struct Options {
    /// Finer by this factor, 1 to 8
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=8))]
    refine: u32,
}

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let refine = f64::from(Options::parse().refine);
    println!(
        "{:<28} {:>9} {:>9} {:>7} {:>9} {:>11} {:>10} {:>9} {:>9}",
        "scene", "particles", "elements", "steps", "s", "M updates/s", "revisions", "search", "searches"
    );
    let h = 0.1e-3 / refine;
    let moduli = Moduli::young_poisson(206e9, 0.3)?;
    let steel = Solid::new(Elastic::new(moduli.shear)?, LogarithmicBulk::new(7850.0, moduli.bulk)?)
        .with_bulk_viscosity(0.06, 1.5)?;
    let packing = Packing::on_nodes(&Cuboid::new([0.0; 2], [1e-3, 20e-3])?, &Lattice::new([0.0; 2], h)?)?;
    let method = Method::consistent(PlaneStrain, LocalDelaunay::new(0.45 * h, 2.0)?);
    let mut bar = Pcmm::new(method, steel, &packing, |_| [0.0, -50.0], Masses::FromElements)?;
    bar.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    measure("elastic bar, every step", bar, 9.0e-6, 1, 0.45 * h)?;

    let h = 0.5e-3 / refine;
    let copper = library::copper_feng_2014().with_bulk_viscosity(0.06, 1.5)?;
    let packing = Packing::on_nodes(&Cuboid::new([0.0; 2], [5e-3, 70e-3])?, &Lattice::new([0.0; 2], h)?)?;
    let method = Method::consistent(Axisymmetric, LocalDelaunay::new(0.45 * h, 20.0)?);
    let mut bar = Pcmm::new(method, copper, &packing, |_| [0.0, -165.0], Masses::FromElements)?;
    bar.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
    bar.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    measure("copper bar, every 10 steps", bar, 120.0e-6, 10, 0.45 * h)?;

    let h = 1.0e-3 / (8.0 * refine);
    let aluminium = library::aluminium_feng_2014()
        .with_failure(TensilePressure::new(1.2e9)?)
        .with_bulk_viscosity(0.1, 1.5)?;
    let plate = Cuboid::new([0.0, -8e-3], [1e-3, 8e-3])?;
    let both = plate.or(Ball::new([-1e-3, 0.0], 1e-3)?);
    let packing =
        Packing::of_seeds(&fill(&both, &Lattice::new([0.0; 2], h)?, 1, &Filling::new().jittered(14, 0.5))?);
    let method = Method::consistent(PlaneStrain, LocalDelaunay::new(0.8 * h, 3.0)?);
    let velocity = |x: [f64; 2]| [if x[0] < 0.0 { 5000.0 } else { 0.0 }, 0.0];
    let mut cloud = Pcmm::new(method, aluminium, &packing, velocity, Masses::FromVolumes)?;
    cloud.set_time_control(TimeControl::Courant { factor: 0.3, growth: 1.1 })?;
    measure("cloud, every 2 steps", cloud, 1.0e-6, 2, 0.8 * h)
}

/// Run to the end time. Measures revisions by wall-clock time, and searches by a second copy of the lists.
fn measure<M: Composition<2>>(
    name: &str,
    mut body: Pcmm<2, M>,
    end: f64,
    every: u64,
    reach: f64,
) -> Result<(), Failure> {
    body.set_revision_interval(u64::MAX)?;
    let smallest = body.particles().iter().fold(f64::INFINITY, |m, p| m.min(p.radius));
    let mut lists = Neighbours::new(reach, 0.6 * smallest);
    let team = Team::one();
    let (mut steps, mut revisions, mut searches, mut updates) = (0.0, 0.0, 0.0, 0.0);
    let elements = body.elements();
    while body.time() < end {
        let clock = Instant::now();
        body.step_towards(end)?;
        steps += clock.elapsed().as_secs_f64();
        updates += body.elements() as f64;
        if body.steps().is_multiple_of(every) {
            let clock = Instant::now();
            lists.update(body.particles(), &team);
            searches += clock.elapsed().as_secs_f64();
            let clock = Instant::now();
            body.revise()?;
            revisions += clock.elapsed().as_secs_f64();
        }
    }
    let all = steps + revisions;
    println!(
        "{name:<28} {:>9} {elements:>9} {:>7} {all:>9.2} {:>11.2} {:>8.1} % {:>7.1} % {:>9}",
        body.particles().len(),
        body.steps(),
        1e-6 * updates / all,
        100.0 * revisions / all,
        100.0 * searches / all,
        lists.searches(),
    );
    Ok(())
}
