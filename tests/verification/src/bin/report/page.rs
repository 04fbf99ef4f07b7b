//! The page: charts, what they say in words, tables.

use std::fmt::Write;

use crate::chart::{draw, escape, legend};
use crate::front::{Cost, cheapest, front, schemes};
use crate::record::Record;
use crate::sweep::Chart;

/// What a page says of its making.
pub struct Making {
    /// Commit.
    pub commit: String,
    /// Date.
    pub date: String,
    /// Processor.
    pub machine: String,
    /// Compiler.
    pub compiler: String,
    /// Relative difference of times of the same run, made twice.
    pub band: f64,
    /// The sweep.
    pub sweep: &'static str,
}

const STYLE: &str = include_str!("page.css");

/// The whole page.
pub fn page(charts: &[Chart], records: &[Record], making: &Making) -> String {
    let mut out = format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>Impactite: error against work</title><style>{STYLE}</style></head><body><main>\
         <h1>Error against work</h1>\
         <p>Every formulation of the material point method that Impactite has, on problems whose exact solution is known. \
         Down and left is better. A dot is one run; hover or tap it for its settings. A line joins a scheme's own best runs, \
         the broad grey line the best of all (nothing is both cheaper and more accurate). Discs move through the grid \
         (updated Lagrangian), rings stay in the reference configuration (total Lagrangian, TL). \
         A run that stopped, or whose error exceeds 1, is a cross on the top edge: none is left out. \
         Where methods fail is another page: <a href=\"stability.html\">stability</a>.</p>"
    );
    choices(&mut out, charts, records);
    for chart in charts {
        section(&mut out, chart, records);
    }
    method(&mut out, making, records);
    out.push_str("</main></body></html>\n");
    out
}

fn of<'a>(chart: &Chart, records: &'a [Record]) -> Vec<&'a Record> {
    records.iter().filter(|r| r.problem == chart.problem.name()).collect()
}

/// Errors in words.
fn percent(e: f64) -> String {
    if e >= 0.1 {
        format!("{:.0} %", 100.0 * e)
    } else if e >= 0.001 {
        format!("{:.1} %", 100.0 * e)
    } else {
        format!("{e:.1e}")
    }
}

fn choices(out: &mut String, charts: &[Chart], records: &[Record]) {
    out.push_str(
        "<h2 id=\"choose\">What to use</h2><p>The cheapest run of the charts below that stays within an error: by work, and by time.</p>\
         <div class=\"wide\"><table><tr><th>problem</th><th>error</th><th>least particle-steps × nodes</th><th>least core-seconds</th></tr>",
    );
    for chart in charts {
        let runs = of(chart, records);
        for target in chart.targets {
            let name = |cost: Cost| match cheapest(runs.iter().copied(), chart.error, cost, target) {
                Some(r) => format!(
                    "{} <small>({}; {:.1e}, {} s)</small>",
                    r.scheme,
                    r.settings(),
                    r.units,
                    round(r.core_seconds)
                ),
                None => "not reached".into(),
            };
            let _ = write!(
                out,
                "<tr><td><a href=\"#{}\">{}</a></td><td>{}</td><td>{}</td><td>{}</td></tr>",
                chart.id,
                chart.title,
                percent(target),
                name(Cost::Units),
                name(Cost::Seconds)
            );
        }
    }
    out.push_str("</table></div>");
}

fn section(out: &mut String, chart: &Chart, records: &[Record]) {
    let runs = of(chart, records);
    let _ = write!(out, "<section><h2 id=\"{}\">{}</h2><p>{}</p>", chart.id, chart.title, chart.about);
    out.push_str("<div class=\"pair\">");
    for cost in [Cost::Units, Cost::Seconds] {
        let drawing =
            draw(&runs, chart.error, chart.label, cost).unwrap_or_else(|| "<p>No run yet.</p>".into());
        let _ = write!(out, "<figure>{drawing}</figure>");
    }
    out.push_str("</div>");
    out.push_str(&legend(&runs));
    reading(out, chart, &runs);
    verdicts(out, chart, &runs);
    out.push_str("</section>");
}

/// The chart in words.
fn reading(out: &mut String, chart: &Chart, runs: &[&Record]) {
    out.push_str("<p><b>Reading.</b> ");
    let best = front(runs.iter().copied(), chart.error, Cost::Seconds);
    let total = |r: &&Record| r.scheme.starts_with("TL");
    for target in chart.targets {
        let of_all = cheapest(runs.iter().copied(), chart.error, Cost::Seconds, target);
        let moving = cheapest(runs.iter().copied().filter(|r| !total(r)), chart.error, Cost::Seconds, target);
        let (e, Some(first)) = (percent(target), of_all) else {
            let _ = write!(out, "No run stays within {}. ", percent(target));
            continue;
        };
        let _ = write!(
            out,
            "Within {e}, {} is the cheapest: {}, {} core-seconds",
            first.scheme,
            first.settings(),
            round(first.core_seconds)
        );
        match moving {
            Some(second) if total(&first) => {
                let ratio = second.core_seconds / first.core_seconds;
                let _ = write!(
                    out,
                    "; of those that move through the grid {} at {} times that",
                    second.scheme,
                    round(ratio)
                );
            }
            None if total(&first) => out.push_str("; none that moves through the grid gets there"),
            _ => {}
        }
        out.push_str(". ");
    }
    if let Some(last) = best.last() {
        let e = last.error(chart.error).unwrap_or(f64::NAN);
        let _ = write!(
            out,
            "The smallest error of all is {} ({}, {}). ",
            percent(e),
            last.scheme,
            last.settings()
        );
    }
    let lost: Vec<&&Record> = runs.iter().filter(|r| r.error(chart.error).is_none_or(|e| e > 1.0)).collect();
    if !lost.is_empty() {
        let mut names: Vec<&str> = lost.iter().map(|r| r.scheme.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        let _ = write!(
            out,
            "{} of {} runs stopped or are off by more than all: {}.",
            lost.len(),
            runs.len(),
            names.join(", ")
        );
    }
    out.push_str("</p>");
}

/// A number with two figures.
fn round(x: f64) -> String {
    match x {
        x if x >= 10.0 => format!("{x:.0}"),
        x if x >= 1.0 => format!("{x:.1}"),
        x if x >= 0.01 => format!("{x:.2}"),
        x => format!("{x:.4}"),
    }
}

/// Orders of convergence at two particles a cell and axis and the smallest Courant number of the sweep.
fn verdicts(out: &mut String, chart: &Chart, runs: &[&Record]) {
    let smallest = runs.iter().map(|r| r.courant).fold(f64::INFINITY, f64::min);
    let mut grids: Vec<usize> = runs.iter().map(|r| r.cells).collect();
    grids.sort_unstable();
    grids.dedup();
    let _ = write!(
        out,
        "<details><summary>Errors and orders of convergence (wanted: {})</summary><div class=\"wide\"><table><tr><th>scheme</th>",
        chart.wanted.0
    );
    for cells in &grids {
        let _ = write!(out, "<th>{cells} cells</th>");
    }
    out.push_str("<th>order</th><th></th></tr>");
    for scheme in schemes(runs) {
        let _ = write!(out, "<tr><td>{scheme}</td>");
        let mut series = Vec::new();
        for &cells in &grids {
            let run = runs
                .iter()
                .find(|r| (r.cells, r.per_axis, r.courant) == (cells, 2, smallest) && r.scheme == scheme);
            match run.map(|r| (r.error(chart.error), &r.failure)) {
                Some((Some(e), _)) => {
                    series.push((cells, e));
                    let _ = write!(out, "<td>{e:.2e}</td>");
                }
                Some((None, why)) => {
                    series.push((cells, f64::NAN));
                    let why = escape(why.as_deref().unwrap_or_default());
                    let _ = write!(out, "<td title=\"{why}\">stopped</td>");
                }
                None => out.push_str("<td></td>"),
            }
        }
        let order = verification::stored::order(&series);
        let (mark, word) = match order {
            _ if series.iter().any(|s| s.1.is_nan()) => ("bad", "breaks"),
            o if o >= chart.wanted.1 => ("good", "as wanted"),
            o if o >= 0.5 => ("fair", "slowly"),
            o if o >= -0.2 => ("fair", "stalls"),
            _ => ("bad", "grows"),
        };
        let _ = write!(out, "<td>{order:.2}</td><td class=\"{mark}\">{word}</td></tr>");
    }
    let _ = write!(
        out,
        "</table></div><p>Two particles a cell and axis, Courant number {smallest}; order over the last three grids.</p></details>"
    );
}

fn method(out: &mut String, making: &Making, records: &[Record]) {
    let Making { commit, date, machine, compiler, band, sweep } = making;
    let stopped = records.iter().filter(|r| r.failure.is_some()).count();
    let _ = write!(
        out,
        "<h2>How it was measured</h2><ul>\
         <li>{} runs ({stopped} stopped), sweep “{sweep}”; commit {commit}, {date}.</li>\
         <li>{machine}; {compiler}; double precision; one thread.</li>\
         <li>Error and time are of the same run. Time is processor time of the steps alone, the force field of the manufactured \
         solutions included, the smaller of repeated runs. The same run made twice differs by {:.1} % here: \
         smaller differences mean nothing.</li>\
         <li>Every scheme was run at several grids and Courant numbers and is shown with all of them; no run was ended early, and none writes files.</li>\
         <li>Particle-steps × nodes do not see the three further mappings of FMPM(4), nor the second one of MUSL; seconds do.</li>\
         <li>Not covered: three dimensions, more threads, single precision, contact, FMPM with MUSL, CPDI. \
         Problems here are smooth or one shock; what breaks in fracture or penetration is another matter.</li>\
         <li>Data: <a href=\"runs.csv\">runs.csv</a>, <a href=\"runs.jsonl\">runs.jsonl</a>. \
         Made by <code>cargo run --release -p verification --bin report</code>.</li></ul>",
        records.len(),
        100.0 * band
    );
}
