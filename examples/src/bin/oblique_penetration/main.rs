//! Penetration of an aluminium plate by an ogive steel rod, normal or oblique \[Ma2010\], \[Piekutowski1996\]: residual speed against
//! experiment, and its dependence on the grid.

mod cells;
mod checks;
mod curve;
mod estimate;
mod figures;
mod flight;
mod plate;
mod rod;
mod scene;
mod setup;
mod track;

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Check, Common, Coupling, Law, Report, Restart, Totals, case, within};

use scene::Outcome;
use setup::{Criterion, Detection, Kernel, ROD, RodFrame, Setup, THICKNESS, Target};

/// A 4340 rod of 12.9 by 88.9 mm with an ogive nose through 26.3 mm of 6061-T651.
///
/// The shot of the paper, 575 m/s at 30 degrees, on three grids (one in smoke), half of it behind a plane of symmetry.
/// Momentum, energy and interpenetration are checked, and for that shot the residual speed; the exit code says whether
/// they are within the tolerances. Writes pictures, CSV histories and ParaView files.
#[derive(Debug, Parser)]
#[command(name = "oblique_penetration", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Impact speed, m/s, 300 to 1000
    #[arg(long, value_name = "M/S", default_value_t = 575.0, value_parser = within(300.0, 1000.0))]
    speed: f64,
    /// Between the rod's way and the plate's normal, 0 to 45
    #[arg(long, value_name = "DEGREES", default_value_t = 30.0, value_parser = within(0.0, 45.0))]
    angle: f64,
    /// Cells through the plate, one run each, 4 to 64 [default: 8 in smoke, 12,16,20 in standard, 20,24,28 in paper]
    #[arg(long, value_name = "N,N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(4..=64))]
    cells: Vec<u32>,
    /// Half the edge of the square plate, diameters of the rod, 2 to 20
    #[arg(long, value_name = "DIAMETERS", default_value_t = 3.0, value_parser = within(2.0, 20.0))]
    width: f64,
    /// Coefficient of friction between rod and plate, 0 to 0.5
    #[arg(long, value_name = "MU", default_value_t = 0.0, value_parser = within(0.0, 0.5))]
    friction: f64,
    /// When a point of the plate is taken out: its mass and momentum go on, free
    #[arg(long, value_enum, default_value = "strain")]
    failure: Criterion,
    /// Plastic strain at which it does with --failure strain, 0.1 to 10
    #[arg(long, value_name = "STRAIN", default_value_t = 3.0, value_parser = within(0.1, 10.0))]
    failure_strain: f64,
    /// Shape function
    #[arg(long, value_enum, default_value = "impact")]
    kernel: Kernel,
    /// FLIP forgets what the nodes do not see while sound crosses this many cells, 1 to 1e9
    #[arg(long, value_name = "CELLS", default_value_t = 1e6, value_parser = within(1.0, 1e9))]
    memory: f64,
    /// How contact is found
    #[arg(long, value_enum, default_value = "plane")]
    detection: Detection,
    /// Where the forces of the rod are computed
    #[arg(long, value_enum, default_value = "current")]
    rod: RodFrame,
    /// What the plate is made of; with afemp each run is followed by one of particles, which it is compared with
    #[arg(long, value_enum, default_value = "particles")]
    target: Target,
    /// How a rod of finite elements meets the plate
    #[arg(long, value_enum, default_value = "surface")]
    coupling: Coupling,
    /// Edge of the elements of the rod, 0.3 to 6; a cell at most on the grid [default: a cell, half of one on the grid, 2 at most]
    #[arg(long, value_name = "MM", value_parser = within(0.3, 6.0))]
    edge: Option<f64>,
    /// What rod and plate do to each other
    #[arg(long, value_enum, default_value = "coulomb")]
    law: Law,
    /// Way that the rod flies before it meets the plate, 0 to 200
    #[arg(long, value_name = "THICKNESSES", default_value_t = 0.0, value_parser = within(0.0, 200.0))]
    stand_off: f64,
    /// Compute the plate while the rod flies, too: the same bits, later
    #[arg(long)]
    no_rest: bool,
    /// Of the time step, 0.05 to 1
    #[arg(long, value_name = "FACTOR", default_value_t = 0.5, value_parser = within(0.05, 1.0))]
    factor: f64,
    /// Shoot at 350 to 850 m/s, straight and at --angle, on the coarsest of the grids instead
    #[arg(long)]
    curve: bool,
    /// Write ParaView frames of the finest run
    #[arg(long)]
    frames: bool,
}

/// Residual speed of the experiment, m/s \[Ma2010\].
pub const EXPERIMENT: f64 = 455.0;
/// Residual speed of MPM3Dpp, m/s \[Ma2010\].
pub const PAPER: f64 = 441.0;

/// Largest default edge of the rod's elements, m: three per radius. On finer grids the default is a cell.
const EDGE: f64 = 2.0e-3;

impl Options {
    /// Return the edge of the rod's elements for this cell size, m.
    fn edge_in(&self, cell: f64) -> f64 {
        self.edge.map_or(EDGE.min(self.coupling.edge(cell)), |edge| 1e-3 * edge)
    }

    fn setups(&self) -> Vec<Setup> {
        let mut cells = self.cells.clone();
        if cells.is_empty() {
            cells = self.common.resolution.choose(vec![8], vec![12, 16, 20], vec![20, 24, 28]);
        }
        cells.sort_unstable();
        cells.dedup();
        let setup = |cells| Setup {
            speed: self.speed,
            angle: self.angle.to_radians(),
            cells,
            parts: 2,
            half_width: self.width * ROD.diameter,
            friction: self.friction,
            criterion: self.failure,
            failure_strain: self.failure_strain,
            kernel: self.kernel,
            memory: self.memory,
            detection: self.detection,
            rod: self.rod,
            target: self.target,
            coupling: self.coupling,
            edge: self.edge_in(THICKNESS / f64::from(cells)),
            law: self.law,
            stand_off: self.stand_off,
            rest: !self.no_rest,
            factor: self.factor,
            threads: self.common.threads(),
        };
        cells.into_iter().map(setup).collect()
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("oblique_penetration")?;
    let setups = options.setups();
    let (outcomes, checks) = if options.curve {
        let (points, outcomes) = curve::shoot(&setups[0], &folder, restart)?;
        figures::curve(&points)?.save(folder.join("curve.png"))?;
        (outcomes, checks::of_curve(&points, setups[0].cells))
    } else {
        let (outcomes, beside) = grids(&setups, &folder, options.frames, restart)?;
        let mut checks = checks::of_grids(&outcomes)?;
        checks.extend(beside);
        (outcomes, checks)
    };
    let totals = outcomes.iter().fold(Totals::default(), |sum, o| sum.plus(&o.totals));
    let settings = serde_json::json!({
        "runs": setups,
        "curve": options.curve,
        "residual_speeds": outcomes.iter().map(Outcome::residual).collect::<Vec<_>>(),
        "flights": outcomes.iter().filter_map(|o| o.flight.as_ref()).collect::<Vec<_>>(),
    });
    Report::new("oblique_penetration", options.common.resolution, settings, &totals, checks)
        .finish(&options.common, &folder)
}

/// Run one shot on successively finer grids; draw the finest.
fn grids(
    setups: &[Setup],
    folder: &Path,
    frames: bool,
    restart: &Restart,
) -> Result<(Vec<Outcome>, Vec<Check>), CaseError> {
    let (mut outcomes, mut beside) = (Vec::new(), Vec::new());
    for (n, setup) in setups.iter().enumerate() {
        let finest = n + 1 == setups.len();
        // Positions of the tip along the axis: within the plate, through it, shank within it, and nearly out.
        let ways = [0.4, 0.8, 1.2, 1.8, 2.6, 3.4].map(|part| part * setup.way());
        let ways = if finest { &ways[..] } else { &[] };
        let files = (finest && frames).then_some(folder);
        let outcome = scene::shoot(setup, ways, files, restart)?;
        figures::write(&outcome, folder)?;
        if setup.target == Target::Afemp {
            let particles = Setup { target: Target::Particles, ..*setup };
            beside.push(checks::of_target(&outcome, &scene::shoot(&particles, &[], None, restart)?));
        }
        if finest {
            figures::cuts(&outcome)?.save(folder.join("cuts.png"))?;
        }
        outcomes.push(outcome);
    }
    let all: Vec<&Outcome> = outcomes.iter().collect();
    figures::histories(&all)?.save(folder.join("speed.png"))?;
    if let Some(limit) = checks::limit(&outcomes)
        && setups[0].is_the_paper_s()
    {
        figures::convergence(&all, limit)?.save(folder.join("convergence.png"))?;
    }
    Ok((outcomes, beside.concat()))
}
