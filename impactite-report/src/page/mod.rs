//! Page of a run: one self-contained file, readable with and without scripts, on screen and on paper.
//!
//! All text of a record is escaped. A missing or unreadable file of the record is reported at its position;
//! the rest of the page is unchanged: an interrupted run has a page, too.

mod balances;
mod chart;
mod checks;
mod convergence;
mod document;
mod head;
mod media;
mod parts;
mod scene;
mod time;
mod warnings;

use std::path::{Path, PathBuf};

use impactite_output::write_whole;
use maud::{PreEscaped, html};

use crate::error::ReportError;
use crate::record::Record;
use chart::Charts;
use document::document;

pub use convergence::write_convergence;
pub use document::FILE;

/// Read the record in `folder` ([`Record::open`]) and write its page, `report.html`, there. Returns its path.
///
/// # Errors
/// Errors of [`Record::open`]; a page that cannot be written.
pub fn write_page(folder: impl AsRef<Path>) -> Result<PathBuf, ReportError> {
    let folder = folder.as_ref();
    let path = folder.join(FILE);
    write_whole(&path, page(&Record::open(folder)?, folder))?;
    Ok(path)
}

const PLOT: &str = include_str!("../../vendor/uplot/uPlot.iife.min.js");
const CHARTS: &str = include_str!("charts.js");
/// Script that stores errors of scripts in the document, for tests.
const WATCH: &str = "addEventListener('error',e=>{document.body.dataset.error=e.message})";

/// Build the page of `record`, whose files are in `folder`.
#[must_use]
pub fn page(record: &Record, folder: &Path) -> String {
    let mut charts = Charts::default();
    let sections = [
        ("", media::pictures(record, folder)),
        ("checks", checks::checks(record)),
        ("histories", media::histories(record, folder, &mut charts)),
        ("balances", balances::balances(record, &mut charts)),
        ("scene", scene::scene(record)),
        ("time", time::timing(record, &mut charts)),
        ("step", time::step(record, &mut charts)),
        ("warnings", warnings::warnings(record)),
        ("files", media::files(folder, FILE)),
    ];
    let titles = |id: &str| match id {
        "checks" => "Checks",
        "histories" => "Histories",
        "balances" => "Balances",
        "scene" => "Scene",
        "time" => "Run time",
        "step" => "Time step",
        "warnings" => "Warnings",
        _ => "Files",
    };
    let there = || sections.iter().filter(|(id, body)| !id.is_empty() && body.is_some());
    let body = html! {
        script { (PreEscaped(WATCH)) }
        main {
            (head::head(record))
            nav { @for (id, _) in there() { a href={ "#" (id) } { (titles(id)) } } }
            @if !charts.is_empty() {
                p.hint.faint hidden { small { "Drag across a chart to zoom, double-click to see all of it, click a name to hide its line." } }
            }
            @for (id, body) in &sections {
                @if let Some(body) = body {
                    @if id.is_empty() { (body) } @else { section id=(id) { h2 { (titles(id)) } (body) } }
                }
            }
        }
        @if !charts.is_empty() {
            script type="application/json" id="charts" { (PreEscaped(charts.json())) }
            script { (PreEscaped(PLOT)) }
            script { (PreEscaped(CHARTS)) }
        }
    };
    document(&record.title, &body)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Balances, Check, Column, Frames};

    fn of(record: &Record) -> String {
        page(record, Path::new("/nowhere/at/all"))
    }

    #[test]
    fn runs_that_were_broken_off_have_a_page() {
        let bare = of(&Record::new("a run"));
        assert!(bare.contains("unknown whether it ended") && bare.contains("no checks"));
        assert!(!bare.contains("id=\"charts\""), "a page without charts needs no script for them");
        assert!(of(&Record::new("a run").unfinished(1.0e-6, 8.0e-5)).contains("at 1 µs of 80 µs"));
        let stopped =
            of(&Record::new("a run").unfinished(1.0e-6, 8.0e-5).stopped(&"step 3: <broken> & gone"));
        assert!(stopped.contains("stopped by an error at 1 µs"));
        assert!(stopped.contains("step 3: &lt;broken&gt; &amp; gone"));
    }

    #[test]
    fn files_that_are_not_there_are_named_at_their_place() {
        let frames = Frames::series("frames", "bar", 3).times([0.0, 1.0, 2.0]);
        let record = Record::new("a run").picture("bar.png", "").picture("bar.tiff", "").frames(frames);
        let page = of(&record.history("Length", "length.csv"));
        for words in [
            "cannot read `bar.png`",
            "`bar.tiff` cannot be used: it must be a PNG, JPEG, WebP or SVG file",
            "cannot read `frames/bar_000000.png`",
            "cannot read `length.csv`",
            "cannot read `/nowhere/at/all`",
        ] {
            assert!(page.contains(words), "the page lacks {words:?}");
        }
    }

    #[test]
    fn a_page_says_what_its_numbers_are() {
        let folder = std::env::temp_dir().join(format!("impactite-page-words-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("pictures")).expect("a folder");
        for name in ["run.json", "pictures/a.png", "pictures/b.png"] {
            std::fs::write(folder.join(name), "").expect("written");
        }
        let mut record = Record::new("a\u{1b}[31m run\0").description("First\nparagraph.\n\n\u{202e}Second.");
        record.dimensions = 2;
        record.part.per = crate::record::Per::Radian;
        let column =
            |name: &str, unit: &str| Column { name: name.into(), unit: unit.into(), values: vec![1.0, 2.0] };
        let mut balances = Balances::errors(0.0, 0.0);
        balances.energy_error = None;
        balances.series = vec![
            column("time", "s"),
            column("kinetic energy", "J"),
            column("momentum x", "kg m/s"),
            column("momentum y", "kg m/s"),
            column("momentum z", "kg m/s"),
        ];
        record.balances = Some(balances);
        let page = page(&record, &folder);
        std::fs::remove_dir_all(&folder).expect("the folder");
        for words in [
            "<p>First paragraph.</p>",
            "a\\u{1b}[31m run\\u{0}",
            "<p>\\u{202e}Second.</p>",
            "none: nothing moves, or the method has no balance",
            "no checks",
            "3 files beside this page",
            "<a href=\"./pictures/\">pictures/</a>, 2 files",
            // The table, the drawing and the data of the script.
            "1 J/rad",
            "[J/rad]",
            "\"unit\":\"J/rad\"",
            "momentum r",
            "1 (kg m/s)/rad",
        ] {
            assert!(page.contains(words), "the page lacks {words:?}");
        }
        assert!(
            !page.contains("momentum x") && !page.contains("momentum y") && !page.contains("momentum across")
        );
        assert!(!page.chars().any(|c| c.is_control() && c != '\n' && c != '\t'));
    }

    /// Values that are NaN, infinite, too large or too small to draw do not prevent a page.
    #[test]
    fn numbers_that_are_none_are_shown() {
        let column = |name: &str, unit: &str, values: &[f64]| Column {
            name: name.into(),
            unit: unit.into(),
            values: values.to_vec(),
        };
        for values in [[f64::NAN; 3], [f64::INFINITY; 3], [f64::MAX, -f64::MAX, 0.0], [5e-324, 0.0, 5e-324]] {
            let mut balances = Balances::errors(values[0], values[1]);
            balances.mass_error = Some(values[0]);
            balances.series = vec![
                column("time", "s", &[0.0, 1.0, 2.0]),
                column("time step", "s", &values),
                column("mass", "kg", &values),
                column("kinetic energy", "J", &values),
                column("energy error", "-", &values),
                column("wall clock", "s", &values),
                column("updates", "-", &values),
            ];
            let mut record = Record::new("a run")
                .check(Check::within("a", values[0], "J", values[1], 0.1, ""))
                .check(Check::shown("b", values[0], "m", ""))
                .setup(values[0]);
            record.balances = Some(balances);
            record.timing.stepping = Some(values[0]);
            record.timing.steps = 3;
            record.machine.started = Some(u64::MAX);
            let page = of(&record);
            assert!(page.contains("energy error") && page.ends_with("</html>"));
        }
        let mut record = Record::new("a run");
        record.balances = Some(Balances::errors(f64::NAN, 0.0));
        assert!(of(&record).contains("<div class=\"bad\"><dt>energy error</dt><dd>NaN %</dd>"));
    }
}
