//! Dam breaks of incompressible water: first pressure of a column against its series, shallow flow against \[Ritter1892\], front and pressure at
//! a wall against experiments \[MartinMoyce1952\], \[Buchner2002\].

mod checks;
mod cost;
mod figures;
mod scene;
mod setup;
mod theory;

use std::process::ExitCode;

use clap::Parser;
use examples::martin_moyce::FRONT;
use examples::{CaseError, Common, FlowRuns, FlowScheme, Report, Resolution, Restart, Totals, case, within};

use scene::Outcome;
use setup::{COLUMN, Setup, Study};

/// Dam breaks of incompressible water: the first pressure of a column, shallow flow, a front and the pressure at a wall.
///
/// Corner pressure and wall force of columns at their release are compared with a series, and their errors over three grids; a long
/// reservoir with Ritter's shallow flow; front and pressure at a far wall with experiments; volume, energy and momentum are checked. The exit
/// code says whether all are within the tolerances.
#[derive(Debug, Parser)]
#[command(name = "dam_break", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Dam breaks to compute [default: all; without cost at smoke]
    #[arg(long, value_enum, value_delimiter = ',')]
    study: Vec<Study>,
    /// Widths of the released columns over their height, 0.25 to 4
    #[arg(long, value_name = "A/H", value_delimiter = ',', default_values = ["0.5", "1", "2"], value_parser = within(0.25, 4.0))]
    aspect: Vec<f64>,
    /// Cells over the height, 8 to 400: of the tank; half of it for shallow flow [default: 24; 48; 96 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(8..=400))]
    cells: Option<u32>,
    /// Height of the column in the tank, m, 0.05 to 50; the tank is similar
    #[arg(long, value_name = "M", default_value_t = 0.6, value_parser = within(0.05, 50.0))]
    height: f64,
    /// Dynamic viscosity of the water, Pa s, 0 to 100; walls are without friction
    #[arg(long, value_name = "PA S", default_value_t = 0.0, value_parser = within(0.0, 100.0))]
    viscosity: f64,
    /// End of the runs in the tank over sqrt(H / g), 1 to 100
    #[arg(long, value_name = "TIMES", default_value_t = 7.0, value_parser = within(1.0, 100.0))]
    end: f64,
    /// Scheme of the flow
    #[arg(long, value_enum, default_value_t)]
    scheme: FlowScheme,
    /// Cells over the depth of the reservoir of the runs of the cost, one run each and method, 4 to 100
    #[arg(long, value_name = "N", value_delimiter = ',', default_values = ["4", "8", "16"], value_parser = clap::value_parser!(u32).range(4..=100))]
    compared: Vec<u32>,
    /// Write ParaView frames
    #[arg(long)]
    frames: bool,
}

impl Options {
    fn studies(&self) -> Vec<Study> {
        let all = [Study::Release, Study::Shallow, Study::Column, Study::Tank, Study::Cost];
        match (&self.study[..], self.common.resolution) {
            ([], Resolution::Smoke) => all[..4].into(),
            ([], _) => all.into(),
            (given, _) => given.into(),
        }
    }
    fn setups(&self, study: Study) -> Vec<Setup> {
        let cells = self.cells.unwrap_or_else(|| self.common.resolution.choose(24, 48, 96));
        let (viscosity, scheme) = (self.viscosity, self.scheme);
        let tank = Setup { study, height: self.height, aspect: 2.0, cells, viscosity, end: self.end, scheme };
        match study {
            // One step, in which no particle moves.
            Study::Release => {
                let grids = self.aspect.iter().flat_map(|a| [8, 16, 32].map(|cells| (a, cells)));
                let grid =
                    |(a, cells): (&f64, u32)| Setup { aspect: *a, cells, end: 1e-6, viscosity: 0.0, ..tank };
                grids.map(grid).collect()
            }
            Study::Shallow | Study::Cost => {
                vec![Setup { aspect: SHALLOW + 1.0, cells: cells / 2, end: SHALLOW, ..tank }]
            }
            Study::Column => {
                // From sqrt(a / (2 g)) to sqrt(H / g), H = 2 a.
                let end = 0.5 * 1.02 * FRONT[FRONT.len() - 1][0];
                vec![Setup { height: COLUMN, aspect: 0.5, end, ..tank }]
            }
            Study::Tank => vec![tank],
        }
    }
}

/// End of shallow flow over sqrt(H / g); its waves do not reach the end of the reservoir.
const SHALLOW: f64 = 8.0;

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("dam_break")?;
    let runs = FlowRuns { common: &options.common, folder: &folder, frames: options.frames, restart };
    let (mut outcomes, mut costs) = (Vec::new(), Vec::new());
    for study in options.studies() {
        if study == Study::Cost {
            for setup in options.setups(study) {
                costs.extend(cost::compare(&setup, &options.compared, &runs)?);
            }
            examples::cost::chart(&costs, "mean error of depths over H")?.save(folder.join("cost.png"))?;
            continue;
        }
        let shares: &[f64] = match study {
            Study::Release => &[1.0],
            Study::Tank => &[0.2, 0.35, 0.5, 0.65, 0.85, 1.0],
            _ => &[0.25, 0.5, 0.75, 1.0],
        };
        let first = outcomes.len();
        for setup in options.setups(study) {
            outcomes.push(scene::run(&setup, shares, &runs)?);
        }
        let done: Vec<&Outcome> = outcomes[first..].iter().collect();
        let finest: Vec<&Outcome> =
            done.iter().copied().filter(|o| study != Study::Release || o.setup.cells == 32).collect();
        let columns = if study == Study::Release { 3 } else { 2 };
        figures::water(&finest, columns)?.save(folder.join(format!("water_{}.png", study.name())))?;
        match study {
            Study::Release | Study::Cost => {}
            Study::Shallow => figures::profile(done[0])?.save(folder.join("profile.png"))?,
            Study::Column => figures::front(done[0])?.save(folder.join("front.png"))?,
            Study::Tank => figures::wall(done[0])?.save(folder.join("wall.png"))?,
        }
    }
    let of_runs = outcomes.iter().map(|o| &o.run.totals).chain(costs.iter().map(|c| &c.totals));
    let totals = of_runs.fold(Totals::default(), |sum, totals| sum.plus(totals));
    let settings =
        serde_json::json!({ "runs": outcomes.iter().map(|o| o.setup).collect::<Vec<_>>(), "costs": costs });
    let mut rows = checks::of(&outcomes);
    rows.extend(examples::cost::rows(&costs, "depths deeper than H / 10, shallow flow, Ritter [C]", 0.02));
    Report::new("dam_break", options.common.resolution, settings, &totals, rows)
        .finish(&options.common, &folder)
}
