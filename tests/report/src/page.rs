//! Report page: charts, their interpretation, and tables.

use std::fmt::Write;

use serde::{Deserialize, Serialize};

use crate::chart::{draw, escape, legend, percent};
use crate::front::{Cost, cheapest, front, growing, schemes};
use crate::limits::{self, Found};
use crate::map::{self, Row};
use crate::peers::{self, Package};
use crate::record::Record;
use crate::speed::Speed;
use crate::sweep::{Chart, Kind};
use crate::{price, rates};

/// Provenance of the page.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Making {
    /// Date.
    pub date: String,
    /// Processor.
    pub machine: String,
    /// Compiler.
    pub compiler: String,
    /// Number of concurrent runs.
    pub threads: usize,
    /// Timing noise: relative difference of the times of a repeated run.
    pub band: f64,
    /// Name of the sweep.
    pub sweep: String,
    /// Packages of peers; empty if not checked.
    #[serde(default)]
    pub packages: Vec<Package>,
}

/// Data of the page.
pub struct Data<'a> {
    /// Commits of the runs.
    pub commit: String,
    /// Provenance of the runs, if known.
    pub making: Option<Making>,
    /// Charts of the page.
    pub charts: &'a [Chart],
    /// Runs of this library.
    pub records: &'a [Record],
    /// Runs of peers.
    pub peers: &'a [Record],
    /// Throughput.
    pub speeds: Vec<Speed>,
    /// Rows of the stability page.
    pub stability: Vec<Row>,
    /// Stable time step limits.
    pub limits: Vec<Found>,
}

const STYLE: &str = include_str!("page.css");

/// Write the whole page.
pub fn page(data: &Data) -> String {
    let mut out = format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>Impactite: error against work</title><style>{STYLE}</style></head><body><main>\
         <h1>Error against work</h1>\
         <p>Every formulation of the material point method that Impactite has, on problems whose exact solution is known. \
         Down and left is better. A dot is one run; hover or tap it for its settings. A line joins a scheme's own best runs, \
         the broad grey line the best of all (nothing is both cheaper and more accurate). Discs move through the grid \
         (updated Lagrangian), rings stay in the reference configuration (total Lagrangian, TL, and finite elements, FE); so do discs and \
         rings of smoothed particles (SPH), whose kernels are those of the present or of the reference configuration, and which have one \
         particle where material points have about one. Cells of fragile points (FPM) stay in the reference configuration: squares are rings, cells of points at random triangles. \
         A run that stopped, or whose error exceeds 1, is a cross on the top edge: none is left out.</p>"
    );
    contents(&mut out, data);
    choices(&mut out, data);
    for chart in data.charts {
        section(&mut out, chart, data);
    }
    map::section(&mut out, &data.stability);
    limits::section(&mut out, &data.limits);
    prices(&mut out, data);
    rates::section(&mut out, &data.speeds);
    method(&mut out, data);
    out.push_str("</main></body></html>\n");
    out
}

fn contents(out: &mut String, data: &Data) {
    out.push_str("<nav><a href=\"#choose\">What to use</a> ");
    for chart in data.charts {
        let _ = write!(out, "<a href=\"#{}\">{} {}</a> ", chart.id, chart.number, chart.title);
    }
    out.push_str(
        "<a href=\"#c9-stability\">C9 Where schemes fail</a> <a href=\"#c10-limits\">C10 How long a step may be</a> <a href=\"#c11-price\">C11 Price of exactness</a> \
         <a href=\"#c12-throughput\">C12 Throughput</a> <a href=\"#method\">How it was measured</a></nav>",
    );
}

fn of<'a>(chart: &Chart, records: &'a [Record]) -> Vec<&'a Record> {
    records.iter().filter(|r| r.key.problem == chart.problem).collect()
}

/// Select the runs for recommendations and interpretation: of histories the last ones only.
fn judged<'a>(chart: &Chart, runs: &[&'a Record]) -> Vec<&'a Record> {
    let end = runs.iter().map(|r| r.steps).max().unwrap_or_default();
    runs.iter()
        .copied()
        .filter(|r| chart.kind == Kind::Work || r.steps == end || r.failure.is_some())
        .collect()
}

fn choices(out: &mut String, data: &Data) {
    out.push_str(
        "<h2 id=\"choose\">What to use</h2><p>For this kind of problem and this error, use this: the cheapest run of the charts below that \
         stays within the error and whose finer grids do so, too (an error that changes its sign may be small by luck), by work and by time.</p>\
         <div class=\"wide\"><table><tr><th>problem</th><th>error</th><th>least particle-steps × nodes</th><th>least core-seconds</th></tr>",
    );
    for chart in data.charts {
        let runs = judged(chart, &of(chart, data.records));
        if runs.is_empty() {
            continue;
        }
        for (n, &target) in chart.targets.iter().enumerate() {
            let name = |cost: Cost| match cheapest(runs.iter().copied(), chart.error, cost, target) {
                Some(r) => format!(
                    "{} <small>({}; {:.1e}, {} s)</small>",
                    escape(r.scheme()),
                    r.settings(),
                    r.units,
                    round(r.core_seconds)
                ),
                None => "<small>not reached</small>".into(),
            };
            let head = format!("<a href=\"#{}\">{}</a>", chart.id, chart.title);
            let _ = write!(
                out,
                "<tr><td>{}</td><td class=\"number\">{}</td><td>{}</td><td>{}</td></tr>",
                if n == 0 { head } else { String::new() },
                percent(target),
                name(Cost::Units),
                name(Cost::Seconds)
            );
        }
    }
    out.push_str("</table></div>");
}

fn section(out: &mut String, chart: &Chart, data: &Data) {
    let runs = of(chart, data.records);
    let Chart { number, id, title, about, .. } = chart;
    let _ = write!(out, "<section><h2 id=\"{id}\">{number}. {title}</h2><p>{about}</p>");
    if runs.is_empty() {
        out.push_str("<p>No run yet.</p></section>");
        return;
    }
    let theirs = of(chart, data.peers);
    let band = data.making.as_ref().map(|m| m.band);
    let figure = |out: &mut String, cost: Cost| {
        // Peers have no instruction counts.
        let beside = if cost == Cost::Instructions { &[] } else { &theirs[..] };
        let drawing = draw(chart, &runs, beside, cost, band);
        let drawing = drawing.unwrap_or_else(|| "<p>No run that could be drawn.</p>".into());
        let _ = write!(out, "<figure>{drawing}</figure>");
    };
    match chart.kind {
        Kind::Work => {
            out.push_str("<div class=\"pair\">");
            figure(out, Cost::Units);
            figure(out, Cost::Seconds);
            out.push_str("</div>");
        }
        Kind::Time => {
            out.push_str("<div class=\"single\">");
            figure(out, Cost::ParticleSteps);
            out.push_str("</div>");
        }
    }
    let all: Vec<&Record> = runs.iter().chain(&theirs).copied().collect();
    out.push_str(&legend(&all));
    match chart.kind {
        Kind::Work => reading(out, chart, &runs, band.unwrap_or(0.0)),
        Kind::Time => reading_of_time(out, chart, &runs),
    }
    peers::reading(out, chart, &theirs, &runs);
    if chart.kind == Kind::Work {
        out.push_str("<details><summary>Against instructions</summary>");
        if runs.iter().any(|r| r.instructions.is_some()) {
            out.push_str("<div class=\"single\">");
            figure(out, Cost::Instructions);
            out.push_str("</div><p>Instructions a particle and step of the scheme, counted by callgrind on the problem scaled down, times particles and steps.</p>");
        } else {
            out.push_str("<p>Not counted: that needs valgrind, and of bars of metal minutes.</p>");
        }
        out.push_str("</details>");
    }
    verdicts(out, chart, &all);
    foot(out, chart, &runs, band);
    out.push_str("</section>");
}

/// Write settings, commit and data of a chart in one line.
fn foot(out: &mut String, chart: &Chart, runs: &[&Record], band: Option<f64>) {
    let list = |of: &dyn Fn(&Record) -> String| {
        let mut values: Vec<String> = Vec::new();
        for value in runs.iter().map(|r| of(r)) {
            if !values.contains(&value) {
                values.push(value);
            }
        }
        values.join(", ")
    };
    let _ = write!(
        out,
        "<p><small>{} runs: {} cells, {} particles a cell and axis, Courant {}; commit {}; the same run twice differs by {} in time. \
         Data: <a href=\"{id}.csv\">{id}.csv</a>.</small></p>",
        runs.len(),
        list(&|r| r.key.cells.to_string()),
        list(&|r| r.key.per_axis.to_string()),
        list(&|r| r.key.courant.to_string()),
        list(&|r| r.commit.clone()),
        band.map_or("an unknown part".into(), percent),
        id = chart.id
    );
}

/// Write the interpretation of the chart. Times that differ by less than twice the `band` count as equal.
fn reading(out: &mut String, chart: &Chart, runs: &[&Record], band: f64) {
    out.push_str("<p><b>Reading.</b> ");
    // Updated Lagrangian material points.
    let through_the_grid =
        |r: &&Record| !["TL", "SPH", "FPM", "FE", "PCMM"].iter().any(|beside| r.scheme().starts_with(beside));
    for &target in chart.targets {
        let of_all = cheapest(runs.iter().copied(), chart.error, Cost::Seconds, target);
        let moving =
            cheapest(runs.iter().copied().filter(through_the_grid), chart.error, Cost::Seconds, target);
        let (e, Some(first)) = (percent(target), of_all) else {
            let _ = write!(out, "No run stays within {}. ", percent(target));
            continue;
        };
        let _ = write!(
            out,
            "Within {e}, {} is the cheapest: {}, {} core-seconds",
            escape(first.scheme()),
            first.settings(),
            round(first.core_seconds)
        );
        let near = |r: &Record| r.core_seconds <= first.core_seconds * (1.0 + 2.0 * band);
        let own = |name: &str| {
            let own = runs.iter().copied().filter(|r| r.scheme() == name);
            cheapest(own, chart.error, Cost::Seconds, target).filter(|r| near(r))
        };
        let best = schemes(runs).into_iter().filter_map(|name| own(&name));
        let mut others: Vec<String> = best.map(|r| escape(r.scheme())).collect();
        others.retain(|name| *name != escape(first.scheme()));
        others.sort_unstable();
        others.dedup();
        if !others.is_empty() {
            let _ = write!(out, " (within the noise of time also {})", others.join("; "));
        }
        match moving {
            Some(second) if !through_the_grid(&first) => {
                let ratio = second.core_seconds / first.core_seconds;
                let name = escape(second.scheme());
                let _ = write!(
                    out,
                    "; of those that move through the grid {name} at {} times that",
                    round(ratio)
                );
            }
            None if runs.iter().any(through_the_grid) && !through_the_grid(&first) => {
                out.push_str("; none that moves through the grid gets there")
            }
            _ => {}
        }
        out.push_str(". ");
    }
    if let Some(last) = front(runs.iter().copied(), chart.error, Cost::Seconds).last() {
        let e = percent(last.error(chart.error).unwrap_or(f64::NAN));
        let name = escape(last.scheme());
        let _ = write!(out, "The smallest error of all is {e} ({name}, {}). ", last.settings());
    }
    if chart.marks_growth {
        let mut names: Vec<String> =
            growing(runs, chart.error, chart.finest_target()).iter().map(|r| escape(r.scheme())).collect();
        names.sort_unstable();
        names.dedup();
        let list = if names.is_empty() { "none".into() } else { names.join("; ") };
        let _ = write!(out, "Errors that grew under refinement, above the smallest of those: {list}. ");
    }
    lost(out, chart, runs, "runs");
    out.push_str("</p>");
}

/// Describe runs without a valid error.
fn lost(out: &mut String, chart: &Chart, runs: &[&Record], what: &str) {
    let lost: Vec<&&Record> = runs.iter().filter(|r| r.answer(chart.error).is_none()).collect();
    if lost.is_empty() {
        return;
    }
    let mut names: Vec<String> = lost.iter().map(|r| escape(r.scheme())).collect();
    names.sort_unstable();
    names.dedup();
    let count = (lost.len(), runs.len());
    let _ = write!(
        out,
        "{} of {} {what} stopped or are off by more than all: {}.",
        count.0,
        count.1,
        names.join("; ")
    );
}

/// Write the interpretation of a history.
fn reading_of_time(out: &mut String, chart: &Chart, runs: &[&Record]) {
    let ends = judged(chart, runs);
    let steps = ends.iter().map(|r| r.steps).max().unwrap_or_default();
    let _ = write!(out, "<p><b>Reading.</b> After {steps} steps, of {} schemes, ", ends.len());
    for (n, &target) in chart.targets.iter().enumerate() {
        let within = ends.iter().filter(|r| r.error(chart.error).is_some_and(|e| e <= target));
        let names: Vec<String> = within.map(|r| escape(r.scheme())).collect();
        let list = if names.is_empty() { "none".into() } else { names.join(", ") };
        let last = if n + 1 == chart.targets.len() { ". " } else { "; " };
        let _ = write!(out, "{} are within {}: {list}{last}", names.len(), percent(target));
    }
    let known = ends.iter().filter_map(|r| Some((r.error(chart.error)?, r)));
    if let Some((least, best)) = known.clone().min_by(|a, b| a.0.total_cmp(&b.0)) {
        let _ = write!(out, "The least change is that of {}, {}. ", escape(best.scheme()), percent(least));
    }
    let gone: Vec<String> = known.filter(|(e, _)| *e >= 0.5).map(|(_, r)| escape(r.scheme())).collect();
    if !gone.is_empty() {
        let _ = write!(out, "Half of the energy or more has changed with {}. ", gone.join(", "));
    }
    lost(out, chart, &ends, "schemes");
    out.push_str("</p>");
}

/// Format a number with two significant figures.
fn round(x: f64) -> String {
    match x {
        x if x >= 10.0 => format!("{x:.0}"),
        x if x >= 1.0 => format!("{x:.1}"),
        x if x >= 0.01 => format!("{x:.2}"),
        x => format!("{x:.4}"),
    }
}

/// Write errors of all schemes over grids (two particles per cell and axis, or one element per cell, the smallest Courant number of the
/// sweep) or steps, and orders of convergence where theory predicts one.
fn verdicts(out: &mut String, chart: &Chart, runs: &[&Record]) {
    let smallest = |scheme: &str| {
        let own = runs.iter().filter(|r| r.scheme() == scheme);
        own.map(|r| r.key.courant).fold(f64::INFINITY, f64::min)
    };
    let column = |r: &Record| if chart.kind == Kind::Time { r.steps } else { r.key.cells as u64 };
    let plain = |r: &&&Record| r.key.per_axis <= 2 && r.key.courant == smallest(r.scheme());
    let mut columns: Vec<u64> =
        runs.iter().filter(plain).filter(|r| r.failure.is_none()).map(|r| column(r)).collect();
    columns.sort_unstable();
    columns.dedup();
    let wanted =
        chart.wanted.map_or(String::new(), |w| format!(" and orders of convergence (wanted: {})", w.0));
    let _ = write!(
        out,
        "<details><summary>Errors{wanted}</summary><div class=\"wide\"><table><tr><th>scheme</th>"
    );
    let unit = if chart.kind == Kind::Time { "steps" } else { "cells" };
    for value in &columns {
        let _ = write!(out, "<th>{value} {unit}</th>");
    }
    out.push_str(if chart.wanted.is_some() { "<th>order</th><th></th></tr>" } else { "</tr>" });
    for scheme in schemes(runs) {
        let _ = write!(out, "<tr><td>{}</td>", escape(&scheme));
        let mut series = Vec::new();
        let own: Vec<&&Record> = runs.iter().filter(plain).filter(|r| r.scheme() == scheme).collect();
        let stopped = own.iter().find(|r| r.failure.is_some());
        for &value in &columns {
            let run = own.iter().find(|r| column(r) == value);
            // Stopped histories have no later columns.
            let run = run.or(stopped.filter(|r| chart.kind == Kind::Time && r.steps < value));
            match run.map(|r| (r.error(chart.error), &r.failure)) {
                Some((Some(e), _)) => {
                    series.push((value as usize, e));
                    let _ = write!(out, "<td>{e:.2e}</td>");
                }
                Some((None, why)) => {
                    series.push((value as usize, f64::NAN));
                    let why = escape(why.as_deref().unwrap_or_default());
                    let _ = write!(out, "<td title=\"{why}\">stopped</td>");
                }
                None => out.push_str("<td></td>"),
            }
        }
        if let Some((_, least)) = chart.wanted {
            let order = verification::stored::order(&series);
            let (mark, word) = match order {
                _ if series.iter().any(|s| s.1.is_nan()) => ("bad", "breaks"),
                o if o >= least => ("good", "as wanted"),
                o if o >= 0.5 => ("fair", "slowly"),
                o if o >= -0.2 => ("fair", "stalls"),
                _ => ("bad", "grows"),
            };
            let _ = write!(out, "<td>{order:.2}</td><td class=\"{mark}\">{word}</td>");
        }
        out.push_str("</tr>");
    }
    let order = if chart.wanted.is_some() { "; order over the last three grids there are" } else { "" };
    let _ = write!(
        out,
        "</table></div><p>Two particles a cell and axis or one element a cell, the smallest Courant number of each scheme{order}.</p></details>"
    );
}

fn prices(out: &mut String, data: &Data) {
    let _ = write!(
        out,
        "<section><h2 id=\"c11-price\">C11. Price of exactness</h2><p>What each scheme needs to get to an error of {:.0} %, by its best setting, \
         between the two runs of a series of grids that bracket it (the logarithm of the error as straight over that of the work). \
         Bars are logarithmic, short is better; what no run reaches goes to the edge. “≤”: the coarsest run is there already.</p>",
        100.0 * price::TARGET
    );
    for chart in data.charts.iter().filter(|c| ["c1-displacement", "c2-vortex"].contains(&c.id)) {
        let runs = of(chart, data.records);
        if !runs.is_empty() {
            price::table(out, chart, &runs);
        }
    }
    out.push_str("</section>");
}

fn method(out: &mut String, data: &Data) {
    let stopped = data.records.iter().filter(|r| r.failure.is_some()).count();
    let _ = write!(
        out,
        "<h2 id=\"method\">How it was measured</h2><ul><li>{} runs ({stopped} stopped); commit {}.</li>",
        data.records.len(),
        escape(&data.commit)
    );
    if let Some(Making { date, machine, compiler, threads, band, sweep, packages }) = &data.making {
        let _ = write!(
            out,
            "<li>Sweep “{sweep}”, {date}, {threads} runs at a time, each on one thread.</li>\
             <li>{}; {}; double precision.</li>\
             <li>The same run made twice, five times each by turns, with as many runs beside it as the sweep had, differs by {} in its \
             smallest time: smaller differences mean nothing, and less than twice that is no claim.</li>",
            escape(machine),
            escape(compiler),
            percent(*band)
        );
        let (there, absent) = (peers::present(packages), peers::absent(packages));
        let _ = match (there.is_empty(), absent.is_empty()) {
            (true, true) => write!(out, "<li>Peers: not looked for.</li>"),
            (true, false) => write!(out, "<li>Peers: none. {absent}</li>"),
            _ => write!(out, "<li>Peers: {there}. {absent}</li>"),
        };
    }
    out.push_str(
        "<li>Error and time are of the same run. Time is processor time of the steps alone, the force field of the manufactured \
         solutions included, the smaller of repeated runs. In contact (C5) steps are looked at one by one: there it is the processor time of the whole by \
         the share that steps have of the clock.</li>\
         <li>Instructions are those of the steps of the same scheme on the problem scaled down to some hundred particles (callgrind), a particle and step, \
         times particles and steps.</li>\
         <li>Every scheme was run at several grids, those of C1 to C4 at several Courant numbers, and is shown with all of them; no run was ended early, and none writes files.</li>\
         <li>Particle-steps × nodes count neighbours of smoothed particles, of which each pair is summed from both sides. They do not see the three further mappings of FMPM(4), nor the second one of MUSL; instructions and seconds do.</li>\
         <li>Smoothed particles are left out of C5 but for bars that meet (what it charts are tests of contact on a grid), of C6 (they have no mean \
         dilatation, the cure that it is about), of C10 and C12 (eigenvalues of a grid, and programs of its own), and of C13, whose methods are those \
         of README for material points; C14 has its bars of steel by all methods.</li>\
         <li>Not covered: three dimensions (but for C12), several threads (but for C12), FMPM with MUSL, CPDI with other than FLIP and USL, friction, finite elements and particle contacts but for C14, smoothed particles but for C1 to C4, C7 and C14, elements that become particles but for bars of steel in C14. \
         Problems here are smooth, or one shock, or one contact; what breaks in fracture or penetration is another matter.</li>\
         <li>Data: <a href=\"runs.csv\">runs.csv</a>, <a href=\"runs.jsonl\">runs.jsonl</a>, <a href=\"counts.jsonl\">counts.jsonl</a>, \
         <a href=\"speeds.jsonl\">speeds.jsonl</a>, <a href=\"peers.jsonl\">peers.jsonl</a>, <a href=\"stability.json\">stability.json</a>. \
         Made by <code>cargo run --release -p report</code>.</li></ul>",
    );
}
