//! Checks of the runs.

use examples::cracks::{Softening, fastest};
use examples::{Check, largest};

use crate::Run;
use crate::setup::RAYLEIGH;

const PHAST: &str = "phase field, read off a picture [V1]";
const COARSE: &str = "cells wider than half a millimetre";
const OTHER: &str = "references are of 1 MPa";
/// Largest width of cells that are judged, m.
const FINE: f64 = 0.5e-3;

const MET_AHEAD: &str =
    "1000 m/s, and 1.4 to 1.5 km/s for some 5 us where the tip meets faces that parted ahead of it";
const NO_NEIGHBOURS: &str =
    "2.6 J/m2: where many faces of a cell soften it bears nothing, and what it held is booked to the crack";

const LATE: &str =
    "58 us on one set of points, never on another: cells in the cohesive zone keep what they bear";

const NONE: &str =
    "one within the run: cells in the cohesive zone keep what they bear, and cracks branch late";

const BENDS: &str = "from 0.3 to 0.5 MPa both arms bend, and the crack forks towards their edges; under 0.25 MPa none runs in 80 us";

/// Assemble all rows.
pub fn of(runs: &[Run]) -> Vec<Check> {
    let mut rows: Vec<Check> = runs.iter().flat_map(of_run).collect();
    rows.extend(of_sweep(runs));
    let error = largest(runs.iter().map(|run| run.outcome.totals.energy_error.abs()));
    rows.push(Check::at_most("energy error, worst run", error, "-", 1e-3, "conservation"));
    rows
}

fn of_run(run: &Run) -> Vec<Check> {
    let (setup, outcome, branches) = (&run.setup, &run.outcome, &run.branches);
    let name = |what: &str| format!("{}: {what}", setup.words());
    let (fine, usual) = (setup.spacing <= FINE, setup.load == 1e6 && setup.cracks.has_energy());
    let why = if usual { COARSE } else { OTHER };
    let per_area = outcome.dissipated / outcome.area;
    let most =
        Check::unreferenced(name("branches beside each other, at most"), branches.most as f64, "-", "");
    let fastest = fastest(&outcome.parted);
    if !setup.cracks.has_energy() {
        let remark = "follows the width of cells";
        return vec![
            most,
            Check::unreferenced(name("energy of the crack over its area"), per_area, "J/m2", remark),
            Check::unreferenced(name("length of cracks"), 1e3 * outcome.area, "mm", remark),
            Check::unreferenced(name("fastest tip"), fastest, "m/s", "no reference without fracture energy"),
        ];
    }
    let begun = outcome.parted.tips().iter().find(|tip| tip.distance > 2e-3);
    let start = begun.map_or(f64::NAN, |tip| 1e6 * tip.time);
    // Events that did not occur in the run count at its end, the earliest possible time.
    let end = setup.end;
    let within = |what: &str, time: Option<f64>| match time {
        Some(time) => (name(what), 1e6 * time),
        None => (name(&format!("{what} (not within the run)")), 1e6 * end),
    };
    let (first_name, branching) = within("branching", branches.first.map(|b| b.1));
    let (two_name, complete) = within("two branches of 10 mm", branches.complete);
    let taken = outcome.rows.iter().find(|row| row.time >= 75e-6).map_or(f64::NAN, |row| row.dissipated);
    let work = Check::gate(
        name("energy of the crack over its area"),
        per_area,
        "J/m2",
        setup.energy,
        0.1,
        "fracture energy that is given",
    );
    let first = Check::gate(first_name, branching, "us", 33.0, 0.2, PHAST);
    let two = Check::gate(two_name, complete, "us", 60.0, 0.25, PHAST);
    let tip = Check::at_most(name("fastest tip"), fastest, "m/s", 0.6 * RAYLEIGH, "0.6 c_R");
    let mut rows = match setup.softening {
        Softening::Joined => vec![first.known_miss(LATE), two.known_miss(LATE), tip, work],
        Softening::Parted => vec![first, two, tip.known_miss(MET_AHEAD), work.known_miss(NO_NEIGHBOURS)],
    };
    rows = rows.into_iter().map(|row| row.judged_if(fine && usual, why)).collect();
    rows.push(most);
    if usual {
        rows.push(Check::unreferenced(name("start"), start, "us", "about 10 us by phase field"));
        rows.push(Check::unreferenced(
            name("energy of cracks at 75 us"),
            taken,
            "J/m",
            "about 0.5 by phase field",
        ));
    }
    rows.into_iter().filter(|row| row.pass().is_some() || row.value.is_finite()).collect()
}

/// Check for one crack under the smallest load, and more branches under larger ones.
fn of_sweep(runs: &[Run]) -> Vec<Check> {
    let mut swept: Vec<&Run> = runs.iter().filter(|run| run.setup.cracks.has_energy()).collect();
    let Some(first) = swept.first().map(|run| run.setup) else { return Vec::new() };
    swept.retain(|run| run.setup.spacing == first.spacing && run.setup.seed == first.seed);
    swept.sort_by(|a, b| a.setup.load.total_cmp(&b.setup.load));
    let (Some(least), Some(most)) = (swept.first(), swept.last()) else { return Vec::new() };
    if !(least.setup.load < 0.7e6 && most.setup.load >= 1.5e6) {
        return Vec::new();
    }
    let name = |run: &Run, what: &str| format!("{}: {what}", run.setup.words());
    let (fine, source) = (first.spacing <= FINE, "one crack, one branching, many");
    let one = Check::gate(name(least, "branches"), least.branches.most as f64, "-", 1.0, 0.0, source);
    let many = Check::at_least(name(most, "branches"), most.branches.most as f64, "-", 3.0, source);
    let rows = match first.softening {
        Softening::Joined => [one, many.known_miss(NONE)],
        Softening::Parted => [one.known_miss(BENDS), many],
    };
    rows.map(|row| row.judged_if(fine, COARSE)).into()
}
