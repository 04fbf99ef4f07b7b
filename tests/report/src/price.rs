//! Price of exactness: cost of each scheme to reach a given error, interpolated between the runs that bracket it.

use std::fmt::Write;

use crate::chart::escape;
use crate::front::{Cost, schemes};
use crate::record::Record;
use crate::sweep::Chart;

/// Target error.
pub const TARGET: f64 = 0.01;

/// Required cost of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Need {
    /// Interpolated cost.
    Is(f64),
    /// Upper bound of the cost: the coarsest run is within the error already.
    AtMost(f64),
    /// Error not reached by any run.
    Unreachable,
    /// Cost not counted.
    Unknown,
}

impl Need {
    fn value(self) -> Option<f64> {
        match self {
            Need::Is(x) | Need::AtMost(x) => Some(x),
            _ => None,
        }
    }
}

/// Interpolate the cost of one series, coarse grid first: pairs of cost and error. The target is interpolated log-log
/// between the runs at which the error permanently falls below it.
pub fn needed(series: &[(Option<f64>, Option<f64>)], target: f64) -> Need {
    let within = |e: &Option<f64>| e.is_some_and(|e| e <= target);
    let at = series.iter().rposition(|(_, e)| !within(e)).map_or(0, |last| last + 1);
    let Some(&(cost, error)) = series.get(at) else { return Need::Unreachable };
    let (Some(cost), Some(error)) = (cost, error) else { return Need::Unknown };
    let Some((before, worse)) = at.checked_sub(1).and_then(|n| series[n].0.zip(series[n].1)) else {
        return Need::AtMost(cost);
    };
    let share = (worse / target).ln() / (worse / error).ln();
    Need::Is(before * (cost / before).powf(share))
}

/// Cost of a scheme: minimum over its series of equal particles per cell and Courant number.
pub fn of_scheme(runs: &[&Record], error: &str, cost: impl Fn(&Record) -> Option<f64>) -> Need {
    let mut kinds: Vec<(usize, f64)> = runs.iter().map(|r| (r.key.per_axis, r.key.courant)).collect();
    kinds.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    kinds.dedup();
    let mut best = Need::Unreachable;
    for kind in kinds {
        let mut own: Vec<&&Record> =
            runs.iter().filter(|r| (r.key.per_axis, r.key.courant) == kind).collect();
        own.sort_by_key(|r| r.key.cells);
        let series: Vec<_> = own.iter().map(|r| (cost(r), r.error(error))).collect();
        let need = needed(&series, TARGET);
        best = match (best, need) {
            (Need::Unreachable, new) => new,
            (old, Need::Unreachable) => old,
            (Need::Unknown, new) => new,
            (old, Need::Unknown) => old,
            (old, new) => {
                if new.value() < old.value() {
                    new
                } else {
                    old
                }
            }
        };
    }
    best
}

type Column = (&'static str, fn(&Record) -> Option<f64>);

const COLUMNS: [Column; 4] = [
    ("particle-steps × nodes", |r| Cost::Units.of(r)),
    ("instructions", |r| Cost::Instructions.of(r)),
    ("core-seconds", |r| Cost::Seconds.of(r)),
    ("memory, bytes", |r| (r.bytes > 0).then_some(r.bytes as f64)),
];

/// Write bars of all schemes for one chart.
pub fn table(out: &mut String, chart: &Chart, runs: &[&Record]) {
    let _ = write!(
        out,
        "<h3>{}: {} of {:.0} %</h3><div class=\"wide\"><table class=\"bars\"><tr><th>scheme</th>",
        chart.title,
        escape(chart.label),
        100.0 * TARGET
    );
    for (name, _) in COLUMNS {
        let _ = write!(out, "<th>{name}</th>");
    }
    out.push_str("<th>bytes a particle</th></tr>");
    let names = schemes(runs);
    let own = |name: &str| runs.iter().copied().filter(|r| r.scheme() == name).collect::<Vec<_>>();
    let mut rows: Vec<(String, Vec<Need>, Option<f64>)> = names
        .iter()
        .map(|name| {
            let own = own(name);
            let needs = COLUMNS.iter().map(|(_, cost)| of_scheme(&own, chart.error, cost)).collect();
            // Memory per particle of the finest run, on which the grid margins have least effect.
            let finest = own.iter().filter(|r| r.error(chart.error).is_some()).max_by_key(|r| r.particles);
            (name.clone(), needs, finest.and_then(|r| r.bytes_a_particle()))
        })
        .collect();
    let first = |row: &(String, Vec<Need>, Option<f64>)| row.1[0].value().unwrap_or(f64::INFINITY);
    rows.sort_by(|a, b| first(a).total_cmp(&first(b)));
    let span = |column: usize| {
        let known = rows.iter().filter_map(|r| r.1[column].value());
        known.fold((f64::INFINITY, 0.0_f64), |s, x| (s.0.min(x), s.1.max(x)))
    };
    let spans: Vec<(f64, f64)> = (0..COLUMNS.len()).map(span).collect();
    for (name, needs, bytes) in &rows {
        let _ = write!(out, "<tr><td>{}</td>", escape(name));
        for (need, span) in needs.iter().zip(&spans) {
            out.push_str(&bar(*need, *span));
        }
        let bytes = bytes.map_or(String::new(), |b| format!("{b:.0}"));
        let _ = write!(out, "<td>{bytes}</td></tr>");
    }
    out.push_str("</table></div>");
    reading(out, &rows);
}

/// Format a table cell with a bar, logarithmic from a tenth of the width for the minimum to nine tenths for the maximum; the
/// bar of an unreachable target extends to the edge.
fn bar(need: Need, (least, most): (f64, f64)) -> String {
    let wide = |x: f64| {
        let share = if most > least { (x / least).ln() / (most / least).ln() } else { 0.0 };
        10.0 + 78.0 * share
    };
    let (width, class, text) = match need {
        Need::Is(x) => (wide(x), "bar", format!("{x:.1e}")),
        Need::AtMost(x) => (wide(x), "bar", format!("≤ {x:.1e}")),
        Need::Unreachable => (100.0, "bar never", "unreachable".into()),
        Need::Unknown => (0.0, "bar", "not counted".into()),
    };
    format!("<td><div class=\"{class}\" style=\"width:{width:.0}%\"></div>{text}</td>")
}

fn reading(out: &mut String, rows: &[(String, Vec<Need>, Option<f64>)]) {
    let there: Vec<_> = rows.iter().filter(|r| r.1[0].value().is_some()).collect();
    let never = rows.len() - there.len();
    out.push_str("<p><b>Reading.</b> ");
    let (Some(best), Some(last)) = (there.first(), there.last()) else {
        out.push_str("No scheme of this sweep gets there.</p>");
        return;
    };
    let _ =
        write!(out, "{} of {} schemes get there; {never} do not in this sweep. ", there.len(), rows.len());
    if let (Some(low), Some(high)) = (best.1[0].value(), last.1[0].value()) {
        let _ = write!(
            out,
            "The least particle-steps × nodes are those of {}, the most of those that arrive are {:.0} times that ({}). ",
            escape(&best.0),
            high / low,
            escape(&last.0)
        );
    }
    let fastest = there.iter().filter_map(|r| Some((r.1[2].value()?, &r.0)));
    if let Some((seconds, name)) = fastest.min_by(|a, b| a.0.total_cmp(&b.0)) {
        let _ = write!(out, "The least time is that of {}: {seconds:.2e} core-seconds.", escape(name));
    }
    out.push_str("</p>");
}
