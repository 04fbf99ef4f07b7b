//! Water entry of a wedge of finite elements into material points, with elements of one to eight cells, and of a rigid wedge into incompressible
//! flow: penetration of particles, and force against theory \[Wagner1932\], \[ZhaoFaltinsen1993\].

mod checks;
mod figures;
mod scene;
mod setup;
mod theory;
mod track;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, Coupling, Report, Restart, Totals, Transfer, case, within};

use setup::{Method, Setup};

/// A wedge of 0.5 m breadth enters a pool at constant speed, without gravity; half of it behind a plane of symmetry.
///
/// With --coupling surface no particle may be in the wedge, whatever the size of its elements; with grid those that are in it are counted.
/// The force of a rigid wedge is held between theories that are too small and too large, and shown beside a similarity solution from
/// memory; momentum and energy are checked. The exit code says whether all are within the tolerances.
#[derive(Debug, Parser)]
#[command(name = "wedge_entry", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Methods of the water; incompressible flow is computed for rigid wedges
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["mpm", "flow"])]
    method: Vec<Method>,
    /// How wedge and water of material points meet
    #[arg(long, value_enum, default_value = "surface")]
    coupling: Coupling,
    /// How particles take velocities from the grid [default: apic; aflip, which elements on the grid ask for, with --coupling grid]
    #[arg(long, value_enum)]
    transfer: Option<Transfer>,
    /// Edge of the elements on the wetted side, cells, one run each, 0.5 to 16
    #[arg(long, value_name = "CELLS", value_delimiter = ',', default_values = ["1", "2", "4", "8"], value_parser = within(0.5, 16.0))]
    edge: Vec<f64>,
    /// Deadrise angle, 5 to 60
    #[arg(long, value_name = "DEGREES", default_value_t = 30.0, value_parser = within(5.0, 60.0))]
    deadrise: f64,
    /// Speed of entry, m/s, 0.1 to 20
    #[arg(long, value_name = "M/S", default_value_t = 6.15, value_parser = within(0.1, 20.0))]
    speed: f64,
    /// Cells over half the breadth of the wedge, 8 to 400 [default: 16; 40; 80 by resolution, 32; 40; 80 for incompressible flow]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(8..=400))]
    cells: Option<u32>,
    /// An elastic wedge, held at its deck, in place of a rigid one
    #[arg(long)]
    elastic: bool,
    /// Young's modulus of an elastic wedge, MPa, 1 to 300000
    #[arg(long, value_name = "MPA", default_value_t = 50.0, value_parser = within(1.0, 3.0e5))]
    young: f64,
    /// Sound speed of the water over that of the jet, pi V / tan(deadrise), 5 to 40
    #[arg(long, value_name = "TIMES", default_value_t = 10.0, value_parser = within(5.0, 40.0))]
    sound: f64,
    /// Wetted part of the breadth at the end, by Wagner, 0.1 to 0.95
    #[arg(long, value_name = "PART", default_value_t = 0.6, value_parser = within(0.1, 0.95))]
    wetted: f64,
    /// Write ParaView frames
    #[arg(long)]
    frames: bool,
}

impl Options {
    fn setup(&self, method: Method, edge: f64) -> Setup {
        let coarse = if method == Method::Flow { 32 } else { 16 };
        Setup {
            method,
            coupling: self.coupling,
            transfer: self.transfer.unwrap_or(match self.coupling {
                Coupling::Surface => Transfer::Apic,
                Coupling::Grid => Transfer::Aflip,
            }),
            deadrise: self.deadrise.to_radians(),
            speed: self.speed,
            cells: self.cells.unwrap_or_else(|| self.common.resolution.choose(coarse, 40, 80)),
            edge,
            young: self.elastic.then_some(1e6 * self.young),
            sound: self.sound,
            wetted: self.wetted,
            threads: self.common.threads(),
        }
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("wedge_entry")?;
    let mut outcomes = Vec::new();
    let mut setups = Vec::new();
    for &method in &options.method {
        match method {
            Method::Mpm => setups.extend(options.edge.iter().map(|edge| options.setup(method, *edge))),
            Method::Flow if !options.elastic => setups.push(options.setup(method, 1.0)),
            Method::Flow => {}
        }
    }
    for setup in &setups {
        let files = options.frames.then_some(folder.as_path());
        let outcome = scene::enter(setup, files, restart)?;
        figures::write(&outcome, &folder)?;
        outcomes.push(outcome);
    }
    figures::pressure(&outcomes)?.save(folder.join("pressure.png"))?;
    figures::forces(&outcomes)?.save(folder.join("force.png"))?;
    figures::profiles(&outcomes)?.save(folder.join("profile.png"))?;
    let totals = outcomes.iter().fold(Totals::default(), |sum, o| sum.plus(&o.totals));
    let settings = serde_json::json!({
        "runs": outcomes.iter().map(|o| o.setup).collect::<Vec<_>>(),
        "inside": outcomes.iter().map(|o| o.inside()).collect::<Vec<_>>(),
        "factors": outcomes.iter().map(|o| o.factor()).collect::<Vec<_>>(),
    });
    Report::new("wedge_entry", options.common.resolution, settings, &totals, checks::of(&outcomes))
        .finish(&options.common, &folder)
}
