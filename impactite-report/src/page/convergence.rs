//! Page of a convergence study.

use std::path::{Path, PathBuf};

use impactite_output::write_whole;
use maud::{Markup, html};

use super::checks::allowed;
use super::document::{FILE, document};
use super::media;
use super::parts::{address, duration, missing, picture, quantity};
use crate::convergence::{CHART, Convergence, PAGE, Verdict};
use crate::error::ReportError;
use crate::number::significant;

/// Write the page of `study`, whose files are in `folder`. Returns its path.
///
/// # Errors
/// A page that cannot be written.
pub fn write_convergence(study: &Convergence, folder: impl AsRef<Path>) -> Result<PathBuf, ReportError> {
    let folder = folder.as_ref();
    let path = folder.join(PAGE);
    write_whole(&path, convergence(study, folder))?;
    Ok(path)
}

/// Build the page of `study`, whose files are in `folder`.
fn convergence(study: &Convergence, folder: &Path) -> String {
    let keys: Vec<&str> = study.refined.iter().map(|key| key.key.as_str()).collect();
    let title = format!("Convergence: {}", study.case);
    let body = html! {
        main {
            h1 { (title) }
            p.lead { (study.levels.len()) " levels, ratio " (significant(study.ratio, 4)) "; refined: " (keys.join(", ")) }
            (measures(study))
            @if folder.join(CHART).is_file() { (chart(folder)) }
            @if !study.checks.is_empty() { section id="checks" { h2 { "Checks" } (checks(study)) } }
            section id="levels" { h2 { "Levels" } (levels(study, folder)) }
            section id="words" { h2 { "Words" } (words()) }
            @if let Some(files) = media::files(folder, PAGE) { section id="files" { h2 { "Files" } (files) } }
        }
    };
    document(&title, &body)
}

fn chart(folder: &Path) -> Markup {
    match picture(folder, CHART, "Measures over the size, with their extrapolated values") {
        Ok(image) => html! {
            figure {
                (image)
                figcaption { "Measures over the size; dashed: to the extrapolated value at size zero, with its band." }
            }
        },
        Err(error) => missing(&error, folder),
    }
}

fn measures(study: &Convergence) -> Markup {
    let (head, rows) = study.table();
    let last = head.len() - 1;
    html! {
        div.wide {
            table.full {
                thead { tr { @for (n, cell) in head.iter().enumerate() { th.number[(2..last).contains(&n)] { (cell) } } } }
                @for row in &rows {
                    tr { @for (n, cell) in row.iter().enumerate() { td.name[n == 0] .number[(2..last).contains(&n)] { (cell) } } }
                }
            }
        }
        @for note in study.notes() { p.note { (note) } }
    }
}

fn checks(study: &Convergence) -> Markup {
    html! {
        div.wide {
            table.full {
                thead { tr { th { "quantity" } th { "finest level" } th { "extrapolated" } th.number { "reference" } th.number { "allowed" } th.source { "source" } } }
                @for judged in &study.checks {
                    @let check = &judged.check;
                    tr {
                        td.name { (check.name) }
                        td { @if check.pass == Some(true) { span.good { "passed" } } @else { b.bad { "failed" } } }
                        td { span.good[judged.extrapolated == Verdict::Passed].bad[judged.extrapolated == Verdict::Failed] { (judged.extrapolated.words().to_lowercase()) } }
                        td.number { @if let Some(reference) = check.reference { (quantity(reference, &check.unit)) } }
                        td.number { (allowed(check)) }
                        td.source { small { (check.source) } }
                    }
                }
            }
        }
    }
}

fn levels(study: &Convergence, folder: &Path) -> Markup {
    html! {
        div.wide {
            table.full {
                thead { tr { th { "run" } th.number { "factor" } @for key in &study.refined { th.number { (key.key) } } th.number { "points" } th.number { "steps" } th.number { "time in steps" } } }
                @for (n, level) in study.levels.iter().enumerate() {
                    @let report = format!("{}/{}", level.folder, FILE);
                    tr {
                        td { @if folder.join(&report).is_file() { a href={ "./" (address(&report)) } { (level.folder) } } @else { (level.folder) } }
                        td.number { (significant(level.factor, 4)) }
                        @for key in &study.refined { td.number { (quantity(key.values[n], &key.unit)) } }
                        td.number { @if let Some(points) = level.particles { (points) } }
                        td.number { @if let Some(steps) = level.steps { (steps) } }
                        td.number { @if let Some(seconds) = level.wall_seconds { (duration(seconds)) } }
                    }
                }
            }
        }
        @for level in &study.levels { @if let Some(error) = &level.error { p.note { b.bad { (level.folder) " failed: " } (error) } } }
    }
}

fn words() -> Markup {
    html! {
        dl.definitions {
            dt { "order" } dd { "Observed order p of the three finest levels: the difference between levels falls by the factor r^p, with the ratio r of the sizes." }
            dt { "extrapolated" } dd { "Richardson extrapolation to size zero, f1 + (f1 - f2) / (r^p - 1), with the value f1 of the finest level." }
            dt { "band" } dd { "Grid convergence index as an absolute value, 1.25 |f1 - f2| / (r^p - 1): an estimate of the discretisation error, and no bound." }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convergence::{CheckConvergence, Level, MeasureConvergence, RefinedKey};
    use crate::record::Check;

    #[test]
    fn a_study_has_a_page() {
        let measures = ["length", "depth"].into_iter().zip([[1.4, 1.2, 1.1], [1.0, 2.0, 4.0]]);
        let measures: Vec<MeasureConvergence> =
            measures.map(|(name, f)| MeasureConvergence::new(name, "m", f.to_vec(), 2.0)).collect();
        let check = Check::within("length", 1.1, "m", 1.0, 0.05, "exact");
        let level = |n: usize| Level { folder: format!("00{n}"), factor: 1.0 / n as f64, ..Level::default() };
        let key =
            RefinedKey { key: "method.mpm.cell".into(), unit: "m".into(), values: vec![0.004, 0.002, 0.001] };
        let mut study = Convergence {
            case: "A <bar>".into(),
            ratio: 2.0,
            refined: vec![key],
            levels: [1, 2, 4].map(level).to_vec(),
            checks: vec![CheckConvergence::new(check, &measures)],
            measures,
        };
        study.levels[2].error = Some("step 3: <broken>".into());
        let page = convergence(&study, Path::new("/nowhere/at/all"));
        for words in [
            "<h1>Convergence: A &lt;bar&gt;</h1>",
            "method.mpm.cell",
            "<th class=\"number\">4 mm</th>",
            "does not converge: ",
            "004 failed: </b>step 3: &lt;broken&gt;",
            "undecided: the band crosses the tolerance",
            "± 5 %",
        ] {
            assert!(page.contains(words), "the page lacks {words:?}");
        }
    }
}
