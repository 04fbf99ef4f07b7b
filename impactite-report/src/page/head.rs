//! Title, modelled fraction of the body, and verdict.

use maud::{Markup, html};

use super::parts::{duration, quantity};
use crate::number::{checks_passed, energy_error, significant};
use crate::record::{Progress, Record};

/// Limits of the relative energy gain for a warning and a stop by default, and of the loss for a warning.
const GAINED: f64 = 0.02;
const BAD: f64 = 0.10;
const LOST: f64 = 0.03;

/// Show title, modelled fraction of the body, and verdict.
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
            @for paragraph in paragraphs(&record.description) { p { (paragraph) } }
            @if let Some(note) = record.part.note() { p.note { (note) } }
            (verdict(record))
            @if let Progress::Stopped { error, .. } = &record.progress { p.note { b.bad { "Stopped: " } (error) } }
        }
    }
}

/// Split a text into paragraphs at empty lines.
fn paragraphs(text: &str) -> impl Iterator<Item = String> {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let parts = lines.split(|line| line.is_empty()).map(|part| part.join(" "));
    parts.filter(|part| !part.is_empty()).collect::<Vec<_>>().into_iter()
}

/// Line of the verdict: quantity, rank, text.
type Said = (&'static str, &'static str, String);

fn verdict(record: &Record) -> Markup {
    let mut said: Vec<Said> = Vec::new();
    let at = |time: &Option<f64>| time.map_or(String::new(), |time| format!(" at {}", quantity(time, "s")));
    said.push(match &record.progress {
        Progress::Unknown => ("run", "", "unknown whether it ended".into()),
        Progress::Finished { time } => ("run", "good", format!("finished{}", at(time))),
        Progress::Stopped { time, .. } => ("run", "bad", format!("stopped by an error{}", at(time))),
        Progress::Interrupted { time, end } => {
            ("run", "fair", format!("at {} of {}", quantity(*time, "s"), quantity(*end, "s")))
        }
    });
    let [passed, judged] = record.met();
    let rank = match judged {
        0 => "",
        _ if passed == judged => "good",
        _ => "bad",
    };
    let words = checks_passed([passed, judged]);
    said.push((
        "checks",
        rank,
        words.replace(" checks passed", " passed").replace(" check passed", " passed"),
    ));
    if let Some(balances) = &record.balances {
        let rank = match balances.energy_error {
            None => "good",
            Some(e) if e.is_nan() || e > BAD => "bad",
            Some(e) if (-LOST..=GAINED).contains(&e) => "good",
            Some(_) => "fair",
        };
        said.push(("energy error", rank, energy_error(balances.energy_error)));
        let p = balances.momentum_error;
        // Above rounding: a boundary force or contact force without reaction.
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
