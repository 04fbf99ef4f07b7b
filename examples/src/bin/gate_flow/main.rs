//! Elastic gate opened by the water behind it \[Antoci2007\], static deflection of the gate, and a dam break without gate
//! \[MartinMoyce1952\].

mod checks;
mod figures;
mod scene;
mod setup;
mod theory;
mod track;

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use examples::martin_moyce::FRONT;
use examples::{CaseError, Common, Coupling, Report, Restart, Totals, Transfer, case, within};

use scene::Outcome;
use setup::{Gate, Setup};
use theory::Beam;

/// Water of 0.1 by 0.14 m bends a rubber gate of 79 by 5 mm, clamped above, and leaves under it.
///
/// Water of material points, or incompressible, the gate of finite elements, plane strain. The tip's way is written, and shown beside what is
/// remembered of the experiment; mass, momentum, energy and that no water is in the gate are checked. With --gate stiff the
/// gate's mean bend is held against beams and its load against hydrostatics, with --gate none the front of a column without gate
/// against experiment. The exit code says whether all are within the tolerances.
#[derive(Debug, Parser)]
#[command(name = "gate_flow", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// What the water is behind, one run each
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["elastic", "flow", "stiff", "none"])]
    gate: Vec<Gate>,
    /// How gate and water meet
    #[arg(long, value_enum, default_value = "surface")]
    coupling: Coupling,
    /// How particles take velocities from the grid [default: apic; aflip, which elements on the grid ask for, with --coupling grid]
    #[arg(long, value_enum)]
    transfer: Option<Transfer>,
    /// Cells over the width of the water, 10 to 320 [default: 10; 20; 40 by resolution, twice that without gate; 25, 40, 80 of `flow`]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(10..=320))]
    cells: Option<u32>,
    /// Elements through the gate, 1 to 16 [default: 2 in smoke, 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16))]
    layers: Option<u32>,
    /// Young's modulus of the rubber, MPa, 1 to 1000
    #[arg(long, value_name = "MPA", default_value_t = 12.0, value_parser = within(1.0, 1000.0))]
    young: f64,
    /// Poisson's ratio of the rubber, 0 to 0.49
    #[arg(long, value_name = "NU", default_value_t = 0.4, value_parser = within(0.0, 0.49))]
    poisson: f64,
    /// Let the floor hold the gate's lower end up, whose near corner sinks as it turns
    #[arg(long)]
    seated: bool,
    /// Sound speed of the water over that of free fall from its height, 8 to 40
    #[arg(long, value_name = "TIMES", default_value_t = 15.0, value_parser = within(8.0, 40.0))]
    sound: f64,
    /// End of the run with the elastic gate, s, 0.01 to 2 [default: 0.1 in smoke, 0.4]
    #[arg(long, value_name = "S", value_parser = within(0.01, 2.0))]
    end: Option<f64>,
    /// Write ParaView frames
    #[arg(long)]
    frames: bool,
}

impl Options {
    fn setup(&self, gate: Gate) -> Setup {
        let choose = |smoke, standard, paper| self.common.resolution.choose(smoke, standard, paper);
        // The gate limits the time step; that of the column without a gate is longer.
        let finer = if gate == Gate::None { 2 } else { 1 };
        let cells = self.cells.unwrap_or_else(|| match gate {
            // Cells of incompressible flow are thinner than the gate.
            Gate::Flow => choose(25, 40, 80),
            _ => finer * choose(10, 20, 40),
        });
        let layers = self.layers.unwrap_or_else(|| choose(2, 4, 4));
        let opened = self.end.unwrap_or_else(|| self.common.resolution.choose(0.1, 0.4, 0.4));
        let setup = Setup {
            gate,
            coupling: self.coupling,
            transfer: self.transfer.unwrap_or(match self.coupling {
                Coupling::Surface => Transfer::Apic,
                Coupling::Grid => Transfer::Aflip,
            }),
            cells,
            layers,
            young: 1e6 * self.young,
            poisson: self.poisson,
            seated: self.seated,
            sound: self.sound,
            end: opened,
            threads: self.common.threads(),
        };
        let end = match gate {
            Gate::Elastic | Gate::Flow => opened,
            Gate::Stiff => 2.0 * Beam::of(&setup).period(),
            Gate::None => 1.02 * FRONT[FRONT.len() - 1][0] * setup.second(),
        };
        Setup { end, ..setup }
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("gate_flow")?;
    let mut outcomes = Vec::new();
    for &gate in &options.gate {
        let setup = options.setup(gate);
        let times: Vec<f64> = [0.1, 0.3, 0.6, 1.0].map(|part| part * setup.end).into();
        let files = options.frames.then_some(folder.as_path());
        let outcome = scene::run(&setup, &times, files, restart)?;
        pictures(&outcome, &folder)?;
        outcomes.push(outcome);
    }
    let totals = outcomes.iter().fold(Totals::default(), |sum, o| sum.plus(&o.totals));
    let settings = serde_json::json!({ "runs": outcomes.iter().map(|o| o.setup).collect::<Vec<_>>() });
    let checks = outcomes.iter().flat_map(checks::of).collect();
    Report::new("gate_flow", options.common.resolution, settings, &totals, checks)
        .finish(&options.common, &folder)
}

fn pictures(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let name = outcome.setup.name();
    figures::write(outcome, folder)?;
    figures::water(outcome)?.save(folder.join(format!("water_{name}.png")))?;
    match outcome.setup.gate {
        Gate::None => figures::fronts(outcome)?.save(folder.join(format!("front_{name}.png")))?,
        _ => figures::tip(outcome)?.save(folder.join(format!("tip_{name}.png")))?,
    }
    Ok(())
}
