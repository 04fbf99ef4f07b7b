//! Wall-clock times, and causes of the time step limit.

use maud::{Markup, html};

use super::chart::{Chart, Charts};
use super::parts::{bars, bytes, duration, quantity};
use crate::number::significant;
use crate::record::{Column, Record, Timing};

pub(super) fn timing(record: &Record, all: &mut Charts) -> Option<Markup> {
    let timing = &record.timing;
    let parts = [
        ("set-up", timing.setup),
        ("steps", timing.stepping),
        ("observers, files, checkpoints", timing.observers),
    ];
    let rows: Vec<(String, f64, String)> =
        parts.into_iter().filter_map(|(name, s)| s.map(|s| (name.to_string(), s, duration(s)))).collect();
    let of_stages = stages(timing);
    if rows.is_empty() {
        return None;
    }
    let mut facts = vec![("steps", timing.steps.to_string())];
    if let Some(rate) = timing.rate() {
        facts.push(("point updates a second", format!("{} million", significant(1e-6 * rate, 3))));
    }
    if let Some(seconds) = timing.stepping.filter(|_| timing.steps > 0) {
        facts.push(("a step", quantity(seconds / timing.steps as f64, "s")));
    }
    if let Some(size) = timing.bytes {
        facts.push(("memory", bytes(size as u64)));
    }
    let rate = record.balances.as_ref().and_then(|balances| {
        let [time, wall, updates] = ["time", "wall clock", "updates"].map(|name| balances.column(name));
        let (time, wall, updates) = (time?, &wall?.values, &updates?.values);
        // Rate between two rows, assigned to the later row.
        let between = |n: usize| {
            let seconds = wall[n] - wall[n - 1];
            if seconds > 0.0 { 1e-6 * (updates[n] - updates[n - 1]) / seconds } else { f64::NAN }
        };
        let values = (0..time.values.len()).map(|n| if n == 0 { f64::NAN } else { between(n) }).collect();
        let rate = Column { name: "million updates a second".into(), unit: "-".into(), values };
        all.figures(&[Chart::new("Rate over the run".into(), time, &[&rate])])
    });
    Some(html! {
        (bars(&rows))
        @if !of_stages.is_empty() { p { "Stages of the steps:" } (bars(&of_stages)) }
        br;
        div.wide { table { @for (name, value) in &facts { tr { td { (name) } td.number { (value) } } } } }
        @if let Some(rate) = &rate { br; (rate) }
    })
}

/// Return the times of the stages of the steps, the remaining ones included.
fn stages(timing: &Timing) -> Vec<(String, f64, String)> {
    let Some(steps) = timing.stepping.filter(|_| !timing.stages.is_empty()) else { return Vec::new() };
    let rest = steps - timing.stages.iter().map(|(_, seconds)| seconds).sum::<f64>();
    let rest = ("nodes and conditions".to_string(), rest.max(0.0));
    timing.stages.iter().chain([&rest]).map(|(name, s)| (name.clone(), *s, duration(*s))).collect()
}

pub(super) fn step(record: &Record, all: &mut Charts) -> Option<Markup> {
    let total: u64 = record.limits.iter().map(|limit| limit.looks).sum();
    let limits: Vec<(String, f64, String)> = record
        .limits
        .iter()
        .map(|l| (l.cause.clone(), l.looks as f64, format!("{} of {total} looks", l.looks)))
        .collect();
    let history = record.balances.as_ref().and_then(|b| Some((b.column("time")?, b.column("time step")?)));
    let extremes = history.and_then(|(time, steps)| {
        let pairs = || time.values.iter().zip(&steps.values).filter(|(_, dt)| dt.is_finite());
        let (at_least, least) = pairs().min_by(|a, b| a.1.total_cmp(b.1))?;
        let (at_most, most) = pairs().max_by(|a, b| a.1.total_cmp(b.1))?;
        let said = |dt: &f64, at: &f64| format!("{} (at t = {})", quantity(*dt, "s"), quantity(*at, "s"));
        // Equal steps may differ by rounding.
        if most - least <= 1e-6 * most {
            return Some(format!("All steps seen: {}.", quantity(*most, "s")));
        }
        Some(format!("Smallest step seen: {}; largest: {}.", said(least, at_least), said(most, at_most)))
    });
    if limits.is_empty() && extremes.is_none() {
        return None;
    }
    let figure =
        history.and_then(|(time, steps)| all.figures(&[Chart::new("Time step".into(), time, &[steps])]));
    let bodies: Vec<_> = record.bodies.iter().filter(|body| body.smallest.is_finite()).collect();
    Some(html! {
        @if let Some(seen) = &extremes { p { (seen) } }
        @if limits.is_empty() {
            p.faint { "The method does not record which body limited the step. A stable step is proportional to the size of a point or cell over wave speed plus point speed: small points and fast ones are the first suspects." }
        } @else { (bars(&limits)) }
        @if let Some(figure) = &figure { (figure) }
        @if limits.is_empty() && !bodies.is_empty() {
            br;
            div.wide {
                table {
                    caption { "Bodies at the time of the record" }
                    thead { tr { th { "body" } th.number { "smallest point" } th.number { "fastest point" } } }
                    @for body in bodies { tr { td.name { (body.name) } td.number { (quantity(body.smallest, "m")) } td.number { (quantity(body.fastest, "m/s")) } } }
                }
            }
        }
    })
}
