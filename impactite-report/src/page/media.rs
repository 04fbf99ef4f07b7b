//! Media and files of a run: pictures, an animation, histories, and a list of all files.

use std::path::Path;

use maud::{Markup, html};

use super::chart::{Charts, charts};
use super::parts::{address, bytes, data_uri, missing, picture, quantity};
use crate::animation::animated_png;
use crate::folder::{history, names};
use crate::record::{Column, Frames, Record};

/// Show the main picture and the animation, then the other pictures.
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
    // An interrupted run has the first frames only; without any, the first is reported as missing.
    let there = all.iter().take_while(|path| path.is_file()).count().max(1);
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

/// List the files of the folder except `page`; subfolders have one row each.
pub(super) fn files(folder: &Path, page: &str) -> Option<Markup> {
    let names = match names(folder) {
        Ok(names) => names,
        Err(error) => return Some(missing(&error, folder)),
    };
    let size = |path: &Path| std::fs::metadata(path).map_or(0, |data| data.len());
    let mut rows: Vec<(String, usize, u64)> = names
        .into_iter()
        .filter(|name| name != page)
        .map(|name| (name.clone(), 1, size(&folder.join(&name))))
        .collect();
    for inner in folders(folder) {
        let path = folder.join(&inner);
        let of = crate::folder::names(&path).unwrap_or_default();
        let bytes = of.iter().map(|name| size(&path.join(name))).sum();
        rows.push((format!("{inner}/"), of.len(), bytes));
    }
    rows.retain(|(_, count, _)| *count > 0);
    let count: usize = rows.iter().map(|row| row.1).sum();
    let total: u64 = rows.iter().map(|row| row.2).sum();
    (count > 0).then(|| {
        html! {
            details open[rows.len() <= 20] {
                summary { (count) @if count == 1 { " file" } @else { " files" } " beside this page, " (bytes(total)) }
                div.wide {
                    table {
                        @for (name, count, size) in &rows {
                            tr {
                                td.name { a href={ "./" (address(name)) } { (name) } @if name.ends_with('/') { ", " (count) @if *count == 1 { " file" } @else { " files" } } }
                                td.number { (bytes(*size)) }
                            }
                        }
                    }
                }
            }
        }
    })
}

/// List the subfolders of a folder, sorted.
fn folders(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let inner = entries.filter(|e| e.path().is_dir()).filter_map(|e| e.file_name().into_string().ok());
    let mut inner: Vec<String> = inner.collect();
    inner.sort();
    inner
}
