//! The same bar by the material point method.

use examples::{CaseError, Restart, Totals};
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::observe::{Ledger, Observer, Pace, Progress};
use mpm_core::output::Snapshot;
use mpm_core::{
    Axisymmetric, BlockGrid, Boundary, IntoKernels, Kernels, Method, Mpm, PlaneStrain, Side, Solver, Team,
};
use mpm_materials::Solid;

use crate::scene::{BULK_VISCOSITY, END, LENGTH, RADIUS, SPEED, Space, eos, strength};

/// What came of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub space: Space,
    /// Length and radius of the face, m.
    pub sizes: [f64; 2],
    pub snapshot: Snapshot,
    pub totals: Totals,
}

/// Run the bar into the wall with `cells` cells on the radius: [`Method::impact`], two particles a cell and axis.
pub fn impact(
    space: Space,
    hardening: f64,
    cells: u32,
    threads: usize,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    match space {
        Space::PlaneStrain => {
            let method = Method::impact(PlaneStrain).into_kernels();
            run(space, method, Filling::new(), hardening, cells, threads, restart)
        }
        Space::Axisymmetric | Space::Quarter => {
            let method = Method::impact(Axisymmetric).into_kernels();
            run(space, method, Filling::new().axisymmetric(), hardening, cells, threads, restart)
        }
    }
}

fn run(
    space: Space,
    method: Kernels<f64, 2>,
    filling: Filling,
    hardening: f64,
    cells: u32,
    threads: usize,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let lattice = Lattice::new([0.0; 2], RADIUS / f64::from(cells))?;
    let seeds = fill(&Cuboid::new([0.0; 2], [RADIUS, LENGTH])?, &lattice, 2, &filling)?;
    let [linear, quadratic] = BULK_VISCOSITY;
    let law = Solid::new(strength(hardening)?, eos()?).with_bulk_viscosity(linear, quadratic)?;
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("bar", law, &seeds, |_| [0.0, -SPEED])?;
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
    mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    mpm.set_team(Team::new(threads)?);
    let mut ledger = Ledger::new(Pace::interval(1.0e-6)?);
    let mut bar = Progress::new("mpm".to_string());
    let observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut bar];
    let mut simulation = restart.scene(format!("mpm_{}", space.name()))?;
    simulation.until(&mut mpm, observers, END)?;
    let snapshot = mpm.snapshot()?;
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    let mut places = vec![[f64::NAN; 2]; seeds.len()];
    for body in mpm.bodies() {
        body.for_each(&mut |p| {
            if let Some(place) = places.get_mut(p.number) {
                *place = [p.position[0], p.position[1]];
            }
        });
    }
    Ok(Outcome { space, sizes: sizes(&seeds, &places), snapshot, totals })
}

/// Length and radius of the face: particles lie a quarter of a cell within the surface they had, and are continued to
/// it linearly from the layer behind.
fn sizes(seeds: &Seeds<2>, places: &[[f64; 2]]) -> [f64; 2] {
    let size = 2.0 * seeds.half_size[1];
    let layer = |at: f64, axis: usize| -> Vec<usize> {
        let near = |n: &usize| (seeds.positions[*n][axis] - at).abs() < 0.25 * size;
        (0..seeds.len()).filter(near).collect()
    };
    let mean = |list: &[usize]| list.iter().map(|&n| places[n][1]).sum::<f64>() / list.len() as f64;
    let widest = |list: &[usize], at: f64| {
        let of = list.iter().filter(|&&n| (seeds.positions[n][0] - at).abs() < 0.25 * size);
        of.map(|&n| places[n][0]).fold(f64::NAN, f64::max)
    };
    let beyond = |first: f64, second: f64| 1.5 * first - 0.5 * second;
    let top = beyond(mean(&layer(LENGTH - 0.5 * size, 1)), mean(&layer(LENGTH - 1.5 * size, 1)));
    let foot = [layer(0.5 * size, 1), layer(1.5 * size, 1)];
    let bottom = beyond(mean(&foot[0]), mean(&foot[1]));
    let edge = |list: &[usize]| beyond(widest(list, RADIUS - 0.5 * size), widest(list, RADIUS - 1.5 * size));
    [top - bottom, beyond(edge(&foot[0]), edge(&foot[1]))]
}
