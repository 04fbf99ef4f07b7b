//! Perforation of a slab of concrete by an ogive rod of steel \[Ma2010\], \[Hanchak1992\]: residual speed against
//! experiment, and cracks of the slab.

mod checks;
mod figures;
mod rod;
mod scene;
mod setup;
mod track;

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, Coupling, Report, Restart, Totals, case, within};

use scene::Outcome;
use setup::{Detection, HALF_WIDTH, Kernel, Model, Rod, SHOTS, Setup, THICKNESS};

/// A steel rod of 25.4 mm and 0.50 kg with an ogive nose through 178 mm of concrete of 48 MPa.
///
/// The seven shots of the experiment, 301 to 1058 m/s, on a quarter of the slab; and the fastest on three grids.
/// Momentum, energy and interpenetration are checked; the residual speeds of the experiment are from memory of the
/// literature and shown. Writes pictures, CSV histories and ParaView files.
#[derive(Debug, Parser)]
#[command(name = "concrete_perforation", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Impact speeds, m/s, 200 to 1500 [default: those of the experiment; 606,1058 in smoke]
    #[arg(long, value_name = "M/S,M/S", value_delimiter = ',', value_parser = within(200.0, 1500.0))]
    speed: Vec<f64>,
    /// Cells through the slab, 6 to 200 [default: 12, 26, 50 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(6..=200))]
    cells: Option<u32>,
    /// Shoot at the fastest of the speeds on these grids, too [default: none; 16,20; none]
    #[arg(long, value_name = "N,N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(6..=200))]
    convergence: Option<Vec<u32>>,
    /// How the slab lies in space
    #[arg(long, value_enum, default_value = "quarter")]
    model: Model,
    /// What the rod is made of
    #[arg(long, value_enum, default_value = "elastic")]
    rod: Rod,
    /// How a rod of finite elements meets the slab
    #[arg(long, value_enum, default_value = "surface")]
    coupling: Coupling,
    /// Edge of the elements of the rod, 0.5 to 12; a cell at most on the grid [default: a cell, half of one on the grid, 4 at most]
    #[arg(long, value_name = "MM", value_parser = within(0.5, 12.0))]
    edge: Option<f64>,
    /// Half the edge of the slab, m, 0.1 to 1
    #[arg(long, value_name = "M", default_value_t = HALF_WIDTH, value_parser = within(0.1, 1.0))]
    half_width: f64,
    /// Particles a cell along each axis, 1 to 4
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=4))]
    parts: u32,
    /// Coefficient of friction between rod and slab, 0 to 0.5
    #[arg(long, value_name = "MU", default_value_t = 0.0, value_parser = within(0.0, 0.5))]
    friction: f64,
    /// Shape function; with linear shape functions and FLIP the elastic rod gains energy as it flies on, which stops the run
    #[arg(long, value_enum, default_value = "impact")]
    kernel: Kernel,
    /// FLIP forgets what the nodes do not see while sound crosses this many cells, 1 to 1e9
    #[arg(long, value_name = "CELLS", default_value_t = 40.0, value_parser = within(1.0, 1e9))]
    memory: f64,
    /// Where contact takes its normals from
    #[arg(long, value_enum, default_value = "rod")]
    normals: Detection,
    /// Of the time step, 0.05 to 1
    #[arg(long, value_name = "FACTOR", default_value_t = 0.5, value_parser = within(0.05, 1.0))]
    factor: f64,
    /// Write ParaView frames and the ledger of the fastest shot
    #[arg(long)]
    frames: bool,
}

/// Upper limit of the default edge of the rod's elements (a cell), m: three elements on the radius.
const EDGE: f64 = 4.0e-3;

impl Options {
    fn setup(&self, speed: f64, cells: u32) -> Setup {
        Setup {
            speed,
            model: self.model,
            rod: self.rod,
            coupling: self.coupling,
            rod_edge: self
                .edge
                .map_or(EDGE.min(self.coupling.edge(THICKNESS / f64::from(cells))), |edge| 1e-3 * edge),
            cells,
            parts: self.parts,
            half_width: self.half_width,
            friction: self.friction,
            kernel: self.kernel,
            memory: self.memory,
            detection: self.normals,
            factor: self.factor,
            threads: self.common.threads(),
        }
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("concrete_perforation")?;
    let resolution = options.common.resolution;
    let all = SHOTS.map(|s| s[0]).to_vec();
    let mut speeds = options.speed.clone();
    if speeds.is_empty() {
        speeds = resolution.choose(vec![606.0, 1058.0], all.clone(), all);
    }
    let fastest = speeds.iter().copied().fold(0.0, f64::max);
    let cells = options.cells.unwrap_or(resolution.choose(12, 26, 50));
    let mut outcomes = Vec::new();
    for speed in speeds {
        let setup = options.setup(speed, cells);
        outcomes.push(shot(&setup, &folder, speed == fastest, options.frames, restart)?);
    }
    let mut grids = options.convergence.clone().unwrap_or(resolution.choose(vec![], vec![16, 20], vec![]));
    grids.retain(|&n| n != cells);
    grids.sort_unstable();
    let mut others = Vec::new();
    for cells in grids {
        others.push(shot(&options.setup(fastest, cells), &folder, false, false, restart)?);
    }

    figures::curve(&outcomes)?.save(folder.join("curve.png"))?;
    figures::write_curve(&outcomes, &folder)?;
    figures::histories(&outcomes)?.save(folder.join("speed.png"))?;
    let mut found = checks::of_curve(&outcomes);
    let books: Vec<&Outcome> = outcomes.iter().chain(&others).collect();
    found.extend(checks::of_books(&books));
    let totals = books.iter().fold(Totals::default(), |sum, o| sum.plus(&o.totals));
    let settings = serde_json::json!({
        "runs": books.iter().map(|o| o.setup).collect::<Vec<_>>(),
        "residual_speeds": books.iter().map(|o| o.residual()).collect::<Vec<_>>(),
        "stepping_seconds": books.iter().map(|o| o.totals.wall_seconds).collect::<Vec<_>>(),
    });
    if !others.is_empty() {
        let at = outcomes.iter().position(|o| o.setup.speed == fastest).unwrap_or(0);
        others.push(outcomes.swap_remove(at));
        others.sort_by_key(|o| o.setup.cells);
        figures::histories(&others)?.save(folder.join("grids.png"))?;
        found.extend(checks::of_grids(&others));
    }
    Report::new("concrete_perforation", resolution, settings, &totals, found).finish(&options.common, &folder)
}

/// Run one shot; write pictures of the slab if it is to be shown.
fn shot(
    setup: &Setup,
    folder: &Path,
    shown: bool,
    frames: bool,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    // Travel of the tip of an undecelerated rod: in the slab, through most of it, and out.
    let ways = [0.3, 0.7, 1.2].map(|part| part * THICKNESS);
    let ways = if shown { &ways[..] } else { &[] };
    let outcome = scene::shoot(setup, ways, (shown && frames).then_some(folder), restart)?;
    figures::write(&outcome, folder)?;
    if shown {
        figures::cuts(&outcome)?.save(folder.join("cuts.png"))?;
        if let Some(picture) = figures::cracks(&outcome)? {
            picture.save(folder.join("cracks.png"))?;
        }
    }
    Ok(outcome)
}
