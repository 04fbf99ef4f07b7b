//! Two plates in a row of cells between planes of symmetry: a flyer hits a target at rest.
//!
//! One velocity field carries both plates, which bonds them at the interface; that is exact under compression. Contiguous-particle GIMP
//! with a FLIP-PIC blend of a hundred cell transits: a shock at 1 km/s carries the particles through the grid, as in `tnt_slab`, which
//! causes noise with uGIMP and splines.

use std::path::Path;
use std::sync::Arc;

use examples::{CaseError, Restart, Totals};
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::observe::{Ledger, Observer, Pace, Probe, ProbeRow, Probes, Quantity, VtkSeries};
use mpm_core::{Blend, BlockGrid, Boundary, CpGimp, Method, Mpm, Musl, PlaneStrain, Side, TimeControl};
use mpm_materials::Material;

/// Time constant of the FLIP-PIC blend, in transits of a cell by sound.
const FADING: f64 = 100.0;
/// Courant number; it allows for the bulk viscosity, which stiffens the shocked metal.
const TIME_FACTOR: f64 = 0.3;
/// Samples of the gauges per transit of a cell by sound.
const LOOKS: f64 = 4.0;
/// Particles per cell along each axis.
const PER_SIDE: usize = 2;

/// Parameters of an impact.
#[derive(Clone, Debug)]
pub struct Plates {
    /// Cells along the flyer.
    pub flyer: u32,
    /// Cells along the target.
    pub target: u32,
    /// Node spacing h, m.
    pub spacing: f64,
    /// Speed of the flyer, m/s.
    pub speed: f64,
    /// Bulk sound speed c0 of the metal, m/s.
    pub sound_speed: f64,
    /// Target cells with gauges, counted from the plane of impact.
    pub gauges: Vec<u32>,
    /// End of the run, s.
    pub end: f64,
}

/// Sample of a gauge.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Time, s.
    pub time: f64,
    /// Velocity, m/s.
    pub speed: f64,
    /// Pressure including bulk viscosity, Pa.
    pub pressure: f64,
}

/// Particle of the target at the end.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Initial distance from the plane of impact, m.
    pub x: f64,
    /// Velocity, m/s.
    pub speed: f64,
    /// Pressure including bulk viscosity, Pa.
    pub pressure: f64,
    /// Compression mu = rho/rho0 - 1.
    pub compression: f64,
    /// Internal energy per reference volume, J/m^3.
    pub energy: f64,
    /// True if it has failed.
    pub failed: bool,
    /// Reference thickness of the metal that the particle represents, m.
    pub thickness: f64,
}

/// Results of an impact.
pub struct Outcome {
    /// Histories of the gauges: means over their cells.
    pub gauges: Vec<Vec<Look>>,
    /// Target at the end, by position.
    pub target: Vec<Point>,
    /// Totals of the run.
    pub totals: Totals,
}

/// Output of a run.
#[derive(Clone, Debug)]
pub struct Files<'a> {
    /// Folder.
    pub folder: &'a Path,
    /// Name of the run.
    pub name: String,
    /// Number of frames for ParaView.
    pub frames: u32,
    /// Checkpoints.
    pub restart: &'a Restart,
}

/// Run the impact of the flyer, x < 0, on the target, both of one metal.
pub fn collide(law: Arc<dyn Material<f64>>, plates: &Plates, files: Files) -> Result<Outcome, CaseError> {
    let (h, end, density) = (plates.spacing, plates.end, law.density());
    let lattice = Lattice::new([0.0; 2], h)?;
    let row = |from: f64, to: f64| -> Result<Seeds<2>, CaseError> {
        Ok(fill(&Cuboid::new([from * h, 0.0], [to * h, h])?, &lattice, PER_SIDE, &Filling::new())?)
    };
    let target = row(0.0, f64::from(plates.target))?;
    let method = Method::new(CpGimp, Blend::new(FADING * h / plates.sound_speed)?, Musl, PlaneStrain);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("target", law.clone(), &target, |_| [0.0; 2])?;
    mpm.add("flyer", law, &row(-f64::from(plates.flyer), 0.0)?, |_| [plates.speed, 0.0])?;
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above })?;
    mpm.bound(Boundary::Symmetry { axis: 1, at: h, side: Side::Below })?;
    mpm.set_time_control(TimeControl::Courant { factor: TIME_FACTOR, growth: 1.1 })?;

    let cells: Vec<Vec<usize>> = plates.gauges.iter().map(|&cell| in_cell(&target, cell, h)).collect();
    let probes = cells.iter().flatten().flat_map(|&particle| {
        [Quantity::Velocity(0), Quantity::Pressure].map(|what| Probe::new(0, particle, what))
    });
    let mut probes = Probes::new(probes, Pace::interval(h / (LOOKS * plates.sound_speed))?);
    let mut ledger = Ledger::new(Pace::interval(end / 100.0)?)
        .with_csv(files.folder.join(format!("ledger_{}.csv", files.name)))?;
    let mut series = None;
    if files.frames > 0 {
        let pace = Pace::interval(end / f64::from(files.frames))?;
        series = Some(VtkSeries::create(files.folder.join("paraview"), files.name.clone(), pace)?);
    }
    let mut observers: Vec<&mut dyn Observer> = vec![&mut probes, &mut ledger];
    observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
    let mut simulation = files.restart.scene(files.name)?;
    simulation.until(&mut mpm, observers, end)?;

    let body = &mpm.bodies()[0];
    let names = body.state_names();
    let place = |word: &str| names.iter().position(|n| n.contains(word));
    let (energy, failed) = (place("energy"), place("crack_damage"));
    let mut points = Vec::with_capacity(body.len());
    body.for_each(&mut |p| {
        let state = |at: Option<usize>| at.and_then(|i| p.state.get(i).copied()).unwrap_or(0.0);
        points.push(Point {
            x: p.position[0],
            speed: p.velocity[0],
            pressure: p.pressure(),
            compression: p.mass / (p.volume * density) - 1.0,
            energy: state(energy),
            failed: state(failed) >= 1.0,
            thickness: p.mass / (density * h),
        });
    });
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    Ok(Outcome { gauges: histories(&cells, probes.rows()), target: points, totals })
}

/// Return the indices of the seeds in a cell: behind a front their states differ slightly.
fn in_cell(seeds: &Seeds<2>, cell: u32, h: f64) -> Vec<usize> {
    let numbered = seeds.positions.iter().enumerate();
    numbered.filter(|(_, x)| (x[0] / h).floor() == f64::from(cell)).map(|(n, _)| n).collect()
}

/// Average over the particles of each cell; a particle has two columns, velocity and pressure.
fn histories(cells: &[Vec<usize>], rows: &[ProbeRow]) -> Vec<Vec<Look>> {
    let mut first = 0;
    let of = |cell: &Vec<usize>| {
        let own = first..first + 2 * cell.len();
        first = own.end;
        let mean = |row: &ProbeRow, column: usize| {
            row.values[own.clone()].iter().skip(column).step_by(2).sum::<f64>() / cell.len() as f64
        };
        rows.iter().map(|r| Look { time: r.time, speed: mean(r, 0), pressure: mean(r, 1) }).collect()
    };
    cells.iter().map(of).collect()
}
