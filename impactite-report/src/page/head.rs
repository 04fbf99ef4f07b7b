//! Title, what part of the whole it is, and the verdict.

use maud::{Markup, html};

use super::parts::{duration, quantity};
use crate::number::{percent, significant};
use crate::record::{Progress, Record};

/// Shares of an energy gained and lost that are remarkable, and bad: where the watch of a run warns and stops by default.
const REMARKABLE: f64 = 0.02;

const BAD: f64 = 0.10;

/// Title, what part of the whole it is, verdict.
pub(super) fn head(record: &Record) -> Markup {
    let dimensions = match record.dimensions {
        0 => String::new(),
        1 => "one dimension".into(),
        2 => "two dimensions".into(),
        _ => "three dimensions".into(),
    };
    let lead: Vec<&str> = [&*record.method, &*dimensions].into_iter().filter(|t| !t.is_empty()).collect();
    html! {
        header {
            h1 { (record.title) }
            @if !lead.is_empty() { p.lead { (lead.join(", ")) } }
            @if let Some(note) = record.part.note() { p.note { (note) } }
            (verdict(record))
            @if let Progress::Stopped { error, .. } = &record.progress { p.note { b.bad { "Stopped: " } (error) } }
        }
    }
}

/// A line of the verdict: what, how, in words.
type Said = (&'static str, &'static str, String);

fn verdict(record: &Record) -> Markup {
    let mut said: Vec<Said> = Vec::new();
    let at = |time: &Option<f64>| time.map_or(String::new(), |time| format!(" at {}", quantity(time, "s")));
    said.push(match &record.progress {
        Progress::Unknown => ("run", "", "not told whether it ended".into()),
        Progress::Finished { time } => ("run", "good", format!("finished{}", at(time))),
        Progress::Stopped { time, .. } => ("run", "bad", format!("stopped by an error{}", at(time))),
        Progress::Interrupted { time, end } => {
            ("run", "fair", format!("at {} of {}", quantity(*time, "s"), quantity(*end, "s")))
        }
    });
    let [met, judged] = record.met();
    said.push(match (met, judged) {
        (_, 0) => ("checks", "", "none is judged".into()),
        (met, judged) if met == judged => ("checks", "good", format!("{met} of {judged} met")),
        (met, judged) => ("checks", "bad", format!("{met} of {judged} met")),
    });
    if let Some(balances) = &record.balances {
        let e = balances.energy_error;
        let rank = match e {
            e if e.is_nan() || e > BAD => "bad",
            e if (-BAD..=REMARKABLE).contains(&e) => "good",
            _ => "fair",
        };
        said.push(("energy error", rank, percent(e)));
        let p = balances.momentum_error;
        // More than rounding: a boundary or contact that is no pair of forces.
        let rank = if p <= f64::EPSILON.sqrt() { "good" } else { "fair" };
        said.push(("momentum error", rank, significant(p, 2)));
    }
    if let Some(seconds) = record.timing.stepping {
        let threads = match record.machine.threads {
            0 => String::new(),
            1 => ", 1 thread".into(),
            n => format!(", {n} threads"),
        };
        said.push(("time in steps", "", duration(seconds) + &threads));
    }
    if !record.warnings.is_empty() {
        said.push(("warnings", "fair", record.warnings.len().to_string()));
    }
    html! { dl.verdict { @for (what, rank, words) in said { div class=(rank) { dt { (what) } dd { (words) } } } } }
}
