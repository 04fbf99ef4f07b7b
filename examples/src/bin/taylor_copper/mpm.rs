//! Taylor bar by the material point method.

use examples::{CaseError, Simulation, Totals};
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::observe::{Ledger, Observer, Pace, Progress};
use mpm_core::{
    Axisymmetric, BlockGrid, Boundary, IntoKernels, Method, Mpm, PlaneStrain, Side, Solver, Team,
};

use crate::beside::{Bar, Outcome, copper};
use crate::scene::{END, Files, LENGTH, RADIUS, Space};

/// Build the bar in front of the wall.
pub fn scene(bar: Bar) -> Result<Mpm<2>, CaseError> {
    Ok(built(bar)?.0)
}

fn built(bar: Bar) -> Result<(Mpm<2>, Seeds<2>), CaseError> {
    let (method, filling) = match bar.space {
        Space::PlaneStrain => (Method::impact(PlaneStrain).into_kernels(), Filling::new()),
        Space::Axisymmetric | Space::Quarter => {
            (Method::impact(Axisymmetric).into_kernels(), Filling::new().axisymmetric())
        }
    };
    let lattice = Lattice::new([0.0; 2], RADIUS / f64::from(bar.cells))?;
    let seeds = fill(&Cuboid::new([0.0; 2], [RADIUS, LENGTH])?, &lattice, 2, &filling)?;
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("bar", copper()?, &seeds, |_| [0.0, -bar.speed])?;
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
    mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    mpm.set_team(Team::new(bar.threads)?);
    Ok((mpm, seeds))
}

/// Run the impact of the bar: [`Method::impact`], two particles per cell and axis. Not available in three dimensions.
pub fn impact(bar: Bar, files: Option<Files>) -> Result<Outcome, CaseError> {
    let (mut mpm, seeds) = built(bar)?;
    let mut ledger = Ledger::new(Pace::interval(1.0e-6)?);
    let mut progress = Progress::new("mpm".to_string());
    let observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut progress];
    let label = format!("mpm_{}", bar.space.name());
    let mut simulation = files.map_or_else(|| Ok(Simulation::alone()), |f| f.restart.scene(label))?;
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
    let sizes = sizes(&seeds, &places);
    Ok(Outcome { method: "mpm", bar, sizes, hourglass: None, broke: None, snapshot, totals })
}

/// Return length and radius of the face. Particles were initially a quarter of a cell inside the surface, and are extrapolated to it
/// linearly from the layer behind. The length starts at the lowest point of the face, whose rim curls up.
fn sizes(seeds: &Seeds<2>, places: &[[f64; 2]]) -> [f64; 2] {
    let size = 2.0 * seeds.half_size[1];
    let layer = |at: f64| -> Vec<usize> {
        let near = |n: &usize| (seeds.positions[*n][1] - at).abs() < 0.25 * size;
        (0..seeds.len()).filter(near).collect()
    };
    let beyond = |first: f64, second: f64| 1.5 * first - 0.5 * second;
    let mean = |list: &[usize]| list.iter().map(|&n| places[n][1]).sum::<f64>() / list.len() as f64;
    let top = beyond(mean(&layer(LENGTH - 0.5 * size)), mean(&layer(LENGTH - 1.5 * size)));
    let foot = [layer(0.5 * size), layer(1.5 * size)];
    // Particle of a layer in a column.
    let of = |layer: &[usize], column: f64| {
        let near = |n: &&usize| (seeds.positions[**n][0] - column).abs() < 0.25 * size;
        layer.iter().find(near).map_or([f64::NAN; 2], |&n| places[n])
    };
    let height = |&n: &usize| beyond(places[n][1], of(&foot[1], seeds.positions[n][0])[1]);
    let bottom = foot[0].iter().map(height).fold(f64::INFINITY, f64::min);
    let edge = |layer: &[usize]| beyond(of(layer, RADIUS - 0.5 * size)[0], of(layer, RADIUS - 1.5 * size)[0]);
    [top - bottom, beyond(edge(&foot[0]), edge(&foot[1]))]
}
