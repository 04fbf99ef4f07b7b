//! Verdict page and Markdown table.

use std::fmt::Write;

use stability::scenes::{ELSEWHERE, MISSING};
use stability::verdict::{SIGNS, Scene, Verdict, escape};

use crate::map::{gauge, map};
use crate::record::Record;

/// Provenance of the page.
pub struct Making {
    /// Commit.
    pub commit: String,
    /// Date.
    pub date: String,
    /// Name of the set of scenes.
    pub set: &'static str,
}

/// Style sheet of the error-work charts, so that the two pages look alike.
const STYLE: &str = include_str!("../../../../report/src/page.css");

const OWN: &str = ".map td,.map th{text-align:center;padding:.1rem .3rem}.map td:first-child{text-align:left;white-space:nowrap}\
.map th span{writing-mode:vertical-rl;transform:rotate(180deg);font-weight:400;white-space:nowrap}\
.odd{color:var(--c4)}svg .good{fill:var(--good)}svg .bad{fill:var(--bad)}svg .fair{fill:var(--fair)}svg .odd{fill:var(--c4)}\
.gauge{vertical-align:middle}";

/// Convert Markdown code marks to HTML.
fn code(text: &str) -> String {
    let mut out = String::new();
    for (n, part) in escape(text).split('`').enumerate() {
        out.push_str(if n == 0 {
            ""
        } else if n % 2 == 1 {
            "<code>"
        } else {
            "</code>"
        });
        out.push_str(part);
    }
    out
}

fn count(records: &[Record], verdict: Verdict) -> usize {
    records.iter().filter(|r| r.verdict == verdict.name()).count()
}

/// Count the verdicts of each kind.
fn summary(records: &[Record]) -> String {
    let all = [Verdict::Pass, Verdict::FailExpected, Verdict::Regression, Verdict::UnexpectedPass];
    let parts: Vec<String> = all.iter().map(|&v| format!("{} {}", count(records, v), v.name())).collect();
    let unknown = records.iter().filter(|r| !r.known).count();
    format!("{} rows: {}; {unknown} neither as expected nor noted", records.len(), parts.join(", "))
}

/// Write the whole page.
pub fn page(scenes: &[Scene], records: &[Record], making: &Making) -> String {
    let mut out = format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>Impactite: stability</title><style>{STYLE}{OWN}</style></head><body><main>\
         <h1>Stability</h1>\
         <p>Scenes in which material point methods are known to fail, each with the schemes that should fail and those that should hold. \
         All of them are run; a scheme that holds where it should fail is reported like one that fails where it should hold. \
         Lengths in cells, speeds in wave speeds c of a bar. <a href=\"index.html\">Error against work</a> is another page.</p>\
         <p>{}. Set: {}. Commit {}, {}. Data: <a href=\"stability.csv\">stability.csv</a>, <a href=\"stability.json\">stability.json</a>. Made by \
         <code>cargo run --release -p stability --bin verdicts</code>.</p><h2 id=\"map\">Map</h2><p>",
        summary(records),
        making.set,
        escape(&making.commit),
        making.date
    );
    for (name, class, sign, meaning) in SIGNS {
        let _ = write!(out, "<span class=\"{class}\">{sign}</span> {name}: {meaning}. ");
    }
    out.push_str("The gravest of a scheme's rows; hover for numbers.</p>");
    map(&mut out, scenes, records);
    for scene in scenes {
        section(&mut out, scene, records);
    }
    out.push_str("<h2 id=\"elsewhere\">Run elsewhere</h2><ul>");
    for (id, what, place) in ELSEWHERE {
        let _ = write!(out, "<li>{id}, {what}: {}</li>", code(place));
    }
    out.push_str("</ul><h2 id=\"missing\">Left out</h2><p>Scenes of the list for what is not there.</p><ul>");
    for (id, what, lacking) in MISSING {
        let _ = write!(out, "<li>{id}, {what}: {lacking}</li>");
    }
    out.push_str("</ul></main></body></html>\n");
    out
}

fn section(out: &mut String, scene: &Scene, records: &[Record]) {
    let rows: Vec<&Record> = records.iter().filter(|r| r.scene == scene.id).collect();
    let _ = write!(
        out,
        "<section><h2 id=\"{0}\">{0}: {1}</h2><p>{2}</p><p><b>Measured:</b> {3}; {4} asked.</p><div class=\"wide\"><table>\
         <tr><th>scheme</th><th>should</th><th>measured</th><th>over limit</th><th>verdict</th><th></th></tr>",
        scene.id,
        escape(scene.name),
        escape(scene.fails),
        escape(scene.metric),
        escape(&scene.limit.text())
    );
    for r in rows {
        let sign = SIGNS.iter().find(|s| s.0 == r.verdict).unwrap_or(&SIGNS[3]);
        let limit =
            if r.limit == scene.limit.text() { String::new() } else { format!(" ({})", escape(&r.limit)) };
        let _ = write!(
            out,
            "<tr><td>{}</td><td>{} <small>{}</small></td><td>{}{limit}</td><td>{}</td><td class=\"{}\">{}&nbsp;{}</td><td><small>{}</small></td></tr>",
            escape(&r.scheme),
            r.expected,
            escape(&r.source),
            escape(&r.found()),
            gauge(r),
            sign.1,
            sign.2,
            r.verdict,
            escape(
                &[r.said.as_deref(), r.noted.as_deref()]
                    .into_iter()
                    .flatten()
                    .collect::<Vec<_>>()
                    .join(". Note: ")
            )
        );
    }
    out.push_str("</table></div></section>");
}

/// Write the Markdown table, one line per row.
pub fn markdown(scenes: &[Scene], records: &[Record]) -> String {
    let mut out = format!("{}.\n\n", summary(records));
    out.push_str("| scene | scheme | should | measured | asked | verdict |\n|---|---|---|---|---|---|\n");
    for scene in scenes {
        for r in records.iter().filter(|r| r.scene == scene.id) {
            let _ = writeln!(
                out,
                "| {} {} | {} | {} | {} | {} | {} |",
                scene.id,
                scene.name,
                r.scheme,
                r.expected,
                r.found(),
                r.limit,
                r.verdict
            );
        }
    }
    out.push_str("\nNot as expected, and why:\n\n");
    for r in records.iter().filter(|r| r.noted.is_some()) {
        let _ = writeln!(out, "- {}, {}: {}", r.scene, r.scheme, r.noted.as_deref().unwrap_or_default());
    }
    out
}
