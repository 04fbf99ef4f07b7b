//! Sections of a page; none where there is nothing to say.

use std::path::Path;
use std::time::{Duration, SystemTime};

use maud::{Markup, html};

use super::chart::{Chart, Charts, charts};
use super::parts::{address, bars, bytes, data_uri, duration, missing, picture};
use crate::animation::animated_png;
use crate::folder::{history, names};
use crate::number::{is_energy_error, percent, significant};
use crate::record::{Balances, Check, Column, Frames, Progress, Record};

/// A number with its unit, to four digits.
fn quantity(x: f64, unit: &str) -> String {
    crate::number::quantity(x, unit, 4)
}

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

/// The main picture and the animation, then the other pictures.
pub(super) fn pictures(record: &Record, folder: &Path) -> Option<Markup> {
    let shown = |file: &str, caption: &str| match picture(folder, file, caption) {
        Ok(image) => html! { figure { (image) figcaption { (caption) } } },
        Err(error) => missing(&error, folder),
    };
    let mut pictures = record.pictures.iter().map(|p| shown(&p.file, &p.caption));
    let main = pictures.next();
    let moving = record.animation.as_ref().filter(|frames| !frames.files.is_empty());
    if main.is_none() && moving.is_none() {
        return None;
    }
    let rest: Vec<Markup> = pictures.collect();
    Some(html! {
        div.pair {
            @if let Some(main) = main { (main) }
            @if let Some(frames) = moving { (animation(frames, folder)) }
        }
        @if !rest.is_empty() { details open[rest.len() <= 4] { summary { "More pictures (" (rest.len()) ")" } div.pair { @for picture in rest { (picture) } } } }
    })
}

fn animation(frames: &Frames, folder: &Path) -> Markup {
    let all: Vec<_> = frames.files.iter().map(|file| folder.join(file)).collect();
    // A run that was broken off left the first ones.
    let there = all.iter().take_while(|path| path.is_file()).count();
    let made = animated_png(&all[..there]).and_then(|moving| {
        let still = animated_png(&all[there - 1..there])?;
        Ok((moving, still))
    });
    let until = match (frames.times.first(), there.checked_sub(1).and_then(|n| frames.times.get(n))) {
        (Some(&from), Some(&to)) => format!(" From {} to {}.", quantity(from, "s"), quantity(to, "s")),
        _ => String::new(),
    };
    let left_out = match all.len() - there {
        0 => String::new(),
        n => format!(" {n} of {} frames are not there.", all.len()),
    };
    match made {
        Err(error) => missing(&error, folder),
        Ok((moving, still)) => {
            html! {
                figure {
                    img.moving src=(data_uri("image/png", &moving)) alt=(frames.caption);
                    img.moving.still src=(data_uri("image/png", &still)) alt="";
                    figcaption { (frames.caption) (until) (left_out) }
                }
            }
        }
    }
}

/// Numbers beside what they should be, those that are missed first.
pub(super) fn checks(record: &Record) -> Option<Markup> {
    if record.checks.is_empty() {
        return None;
    }
    let mut rows: Vec<&Check> = record.checks.iter().collect();
    rows.sort_by_key(|check| check.rank());
    Some(html! {
        div.wide {
            table.full {
                thead { tr { th { "quantity" } th { "met?" } th.number { "this run" } th.number { "reference" } th.number { "difference" } th.number { "allowed" } th.source { "source" } } }
                @for check in rows {
                    tr {
                        td.name { (check.name) }
                        td { (met(check)) }
                        td.number { (of_check(check, check.value)) }
                        td.number { @if let Some(r) = check.reference { (of_check(check, r)) } }
                        td.number { (difference(check)) }
                        td.number { (allowed(check)) }
                        td.source { small { (check.source) @if let Some(reason) = &check.known { br; "declared as missed: " (reason) } } }
                    }
                }
            }
        }
    })
}

/// A number of a check with its unit.
fn of_check(check: &Check, x: f64) -> String {
    if is_energy_error(&check.name, &check.unit) { percent(x) } else { quantity(x, &check.unit) }
}

/// In per cent of the reference, or in the unit where that is 0.
fn difference(check: &Check) -> String {
    match check.reference {
        Some(0.0) => of_check(check, check.value),
        Some(r) => {
            let share = check.value / r - 1.0;
            if share.is_finite() { format!("{:+.2} %", 100.0 * share) } else { String::new() }
        }
        None => String::new(),
    }
}

fn allowed(check: &Check) -> String {
    match (check.tolerance, check.reference) {
        (Some(t), Some(0.0)) => format!("± {}", of_check(check, t).trim_start_matches('+')),
        (Some(t), _) => format!("± {} %", significant(100.0 * t, 3)),
        _ => String::new(),
    }
}

fn met(check: &Check) -> Markup {
    match check.pass {
        Some(true) => html! { span.good { "met" } },
        Some(false) => html! { b.bad { "missed" } },
        None => html! { span.faint { "shown" } },
    }
}

pub(super) fn histories(record: &Record, folder: &Path, all: &mut Charts) -> Option<Markup> {
    if record.histories.is_empty() {
        return None;
    }
    let mut shown = Vec::new();
    for history_of in &record.histories {
        let read = history(&folder.join(&history_of.file)).map(|columns| {
            let chosen = |(n, c): &(usize, Column)| {
                *n == 0 || history_of.columns.is_empty() || history_of.columns.contains(&c.name)
            };
            let columns: Vec<Column> =
                columns.into_iter().enumerate().filter(chosen).map(|(_, c)| c).collect();
            charts(&history_of.title, &columns)
        });
        shown.push(match read {
            Err(error) => missing(&error, folder),
            Ok(charts) => all.figures(&charts).unwrap_or_else(|| {
                html! { p.faint { (history_of.title) ": " code { (history_of.file) } " has no two rows of numbers yet." } }
            }),
        });
    }
    Some(html! { @for figures in &shown { div.history { (figures) } } })
}

/// Columns of the balances by their names.
fn columns<'a>(balances: &'a Balances, names: &[&str]) -> Vec<&'a Column> {
    names.iter().filter_map(|name| balances.column(name)).collect()
}

fn first_and_last(column: &Column) -> Option<[f64; 2]> {
    Some([*column.values.first()?, *column.values.last()?])
}

pub(super) fn balances(record: &Record, all: &mut Charts) -> Option<Markup> {
    let balances = record.balances.as_ref()?;
    let unit = |unit: &str| record.part.unit(unit);
    let errors = [
        ("mass", balances.mass_error.map(percent), None, Balances::MASS_ERROR),
        (
            "momentum",
            Some(significant(balances.momentum_error, 3)),
            balances.momentum_scale.map(|s| quantity(s, &unit("kg m/s"))),
            Balances::MOMENTUM_ERROR,
        ),
        (
            "energy",
            Some(percent(balances.energy_error)),
            balances.energy_scale.map(|s| quantity(s, &unit("J"))),
            Balances::ENERGY_ERROR,
        ),
    ];
    let entries = ["mass", "momentum x", "momentum y", "momentum z", "kinetic energy", "internal energy"];
    let given = ["work", "friction", "impacts", "conversion", "total"];
    let row = |column: &Column| {
        let [first, last] = first_and_last(column)?;
        let shown = |x: f64| quantity(x, &unit(&column.unit));
        Some(
            html! { tr { td { (column.name) } td.number { (shown(first)) } td.number { (shown(last)) } td.number { (shown(last - first)) } } },
        )
    };
    let named = [&entries[..], &given[..]].concat();
    let rows: Vec<Markup> = columns(balances, &named).into_iter().filter_map(row).collect();
    let figures = balances.column("time").and_then(|time| {
        let is_zero = |c: &Column| c.values.iter().all(|v| *v == 0.0);
        let mut energies = columns(balances, &["kinetic energy", "internal energy", "total"]);
        energies.extend(columns(balances, &given[..4]).into_iter().filter(|c| !is_zero(c)));
        let momenta = columns(balances, &entries[1..4]);
        let list = [
            ("Energy", energies),
            ("Energy error", columns(balances, &["energy error"])),
            ("Momentum", momenta.into_iter().filter(|c| !is_zero(c)).collect()),
            ("Momentum error", columns(balances, &["momentum error"])),
        ];
        let mut list: Vec<(&str, Vec<&Column>)> = list.into_iter().filter(|(_, c)| !c.is_empty()).collect();
        if balances.mass_error.is_some_and(|e| e != 0.0) {
            list.push(("Mass", columns(balances, &["mass"])));
        }
        let charts: Vec<Chart> = list.into_iter().map(|(t, c)| Chart::new(t.into(), time, &c)).collect();
        all.figures(&charts)
    });
    Some(html! {
        @if let Some(note) = record.part.note() { p { (note) } }
        div.wide {
            table {
                caption { "Errors: the worst of the run" }
                thead { tr { th { "balance" } th.number { "error" } th.number { "largest of the run" } } }
                @for (what, error, scale, _) in &errors {
                    @if let Some(error) = error {
                        tr { td { (what) } td.number { (error) } td.number { @if let Some(scale) = scale { (scale) } } }
                    }
                }
            }
        }
        @if !rows.is_empty() {
            br;
            div.wide {
                table {
                    thead { tr { th { "of all bodies" } th.number { "first" } th.number { "last" } th.number { "change" } } }
                    @for row in &rows { (row) }
                }
            }
        }
        @if let Some(figures) = &figures { br; (figures) }
        details {
            summary { "What the errors are" }
            dl.definitions {
                @for (what, error, _, meaning) in &errors { @if error.is_some() { dt { (what) " error" } dd { (meaning) "." } } }
            }
        }
    })
}

pub(super) fn scene(record: &Record) -> Option<Markup> {
    let machine = &record.machine;
    let date = |seconds: Option<u64>| {
        // Until the year 9999, beyond which there is no such date.
        let seconds = seconds.filter(|s| *s < 253_402_300_800)?;
        let time = SystemTime::UNIX_EPOCH + Duration::from_secs(seconds);
        Some(humantime::format_rfc3339_seconds(time).to_string().replace('T', " ").replace('Z', " UTC"))
    };
    let versions = machine.versions.iter().map(|[name, version]| format!("{name} {version}"));
    let ran = [
        ("versions", versions.collect::<Vec<_>>().join(", ")),
        ("processor", machine.features.clone()),
        ("threads", if machine.threads > 0 { machine.threads.to_string() } else { String::new() }),
        ("started", date(machine.started).unwrap_or_default()),
        ("ended", date(machine.ended).unwrap_or_default()),
    ];
    let ran: Vec<_> = ran.into_iter().filter(|(_, value)| !value.is_empty()).collect();
    if record.scene.is_empty() && record.bodies.is_empty() && record.settings.is_empty() && ran.is_empty() {
        return None;
    }
    let mass_unit = record.part.unit("kg");
    Some(html! {
        @if !record.bodies.is_empty() {
            div.wide {
                table.full {
                    caption { "Bodies at the time of the record" @if let Some(share) = record.part.share() { ", " (share) } }
                    thead { tr { th { "body" } th { "law" } th.number { "points" } th.number { "mass" } } }
                    @for body in &record.bodies {
                        tr { td.name { (body.name) } td.name { (body.material) } td.number { (body.points) } td.number { (quantity(body.mass, &mass_unit)) } }
                    }
                }
            }
        }
        @if !record.settings.is_empty() {
            h3 { "Settings" }
            div.wide { table { @for s in &record.settings { tr { td { (s.name) } td.name { (s.value) @if !s.unit.is_empty() { " " (s.unit) } } } } } }
        }
        @if !record.scene.is_empty() {
            h3 { "As it was written" }
            pre { code { (record.scene) } }
        }
        @if !ran.is_empty() {
            h3 { "The run" }
            div.wide { table { @for (name, value) in &ran { tr { td { (name) } td.name { (value) } } } } }
        }
    })
}

pub(super) fn timing(record: &Record, all: &mut Charts) -> Option<Markup> {
    let timing = &record.timing;
    let parts = [
        ("set-up", timing.setup),
        ("steps", timing.stepping),
        ("observers, files, checkpoints", timing.observers),
    ];
    let rows: Vec<(String, f64, String)> =
        parts.into_iter().filter_map(|(name, s)| s.map(|s| (name.to_string(), s, duration(s)))).collect();
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
        // Between one row and the next, at the later one.
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
        br;
        div.wide { table { @for (name, value) in &facts { tr { td { (name) } td.number { (value) } } } } }
        @if let Some(rate) = &rate { br; (rate) }
    })
}

pub(super) fn step(record: &Record, all: &mut Charts) -> Option<Markup> {
    let total: u64 = record.limits.iter().map(|limit| limit.steps).sum();
    let limits: Vec<(String, f64, String)> = record
        .limits
        .iter()
        .map(|l| (l.cause.clone(), l.steps as f64, format!("{} of {total} steps", l.steps)))
        .collect();
    let history = record.balances.as_ref().and_then(|b| Some((b.column("time")?, b.column("time step")?)));
    let extremes = history.and_then(|(time, steps)| {
        let pairs = || time.values.iter().zip(&steps.values).filter(|(_, dt)| dt.is_finite());
        let (at_least, least) = pairs().min_by(|a, b| a.1.total_cmp(b.1))?;
        let (at_most, most) = pairs().max_by(|a, b| a.1.total_cmp(b.1))?;
        let said = |dt: &f64, at: &f64| format!("{} (at t = {})", quantity(*dt, "s"), quantity(*at, "s"));
        // Rounding makes steps differ that are all the same.
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
            p.faint { "Which body or condition limited each step is not recorded. A stable step is proportional to the size of a point or cell over wave speed plus point speed: small points and fast ones are the first suspects." }
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

pub(super) fn warnings(record: &Record) -> Option<Markup> {
    if record.warnings.is_empty() {
        return None;
    }
    Some(html! {
        @for w in &record.warnings {
            div.warning {
                p { b { (w.title) } " " small { "after step " (w.step) ", t = " (quantity(w.time, "s")) } }
                p { (w.found) "." }
                @if !w.remedy.is_empty() { p { b { "What to do: " } (w.remedy) "." } }
            }
        }
    })
}

/// The files of the folder but for `page`.
pub(super) fn files(folder: &Path, page: &str) -> Option<Markup> {
    let names = match names(folder) {
        Ok(names) => names,
        Err(error) => return Some(missing(&error, folder)),
    };
    let names: Vec<&String> = names.iter().filter(|name| *name != page).collect();
    if names.is_empty() {
        return None;
    }
    let size =
        |name: &str| std::fs::metadata(folder.join(name)).map_or(String::new(), |data| bytes(data.len()));
    Some(html! {
        details open[names.len() <= 20] {
            summary { (names.len()) " files beside this page" }
            div.wide { table { @for name in names { tr { td.name { a href={ "./" (address(name)) } { (name) } } td.number { (size(name)) } } } } }
        }
    })
}
