//! Summary of the stability page: failing schemes by scene.

use std::fmt::Write;
use std::path::Path;

use serde::Deserialize;

use stability::verdict::{SIGNS, escape, rank, scheme_of};

/// Row of the stability data.
#[derive(Clone, Debug, Deserialize)]
pub struct Row {
    scene: String,
    scheme: String,
    verdict: String,
}

/// Read the stability data beside the page, or else those of the repository.
///
/// # Errors
/// The file is invalid.
pub fn read(out: &Path) -> Result<Vec<Row>, Box<dyn std::error::Error>> {
    let own = out.join("stability.json");
    let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/report/stability.json");
    let file = if own.exists() { own } else { stored };
    if !file.exists() {
        return Ok(Vec::new());
    }
    Ok(serde_json::from_str(&std::fs::read_to_string(file)?)?)
}

/// Write the map with its scenes along the top, and its interpretation.
pub fn section(out: &mut String, rows: &[Row]) {
    out.push_str("<section><h2 id=\"c9-stability\">C9. Where schemes fail</h2>");
    if rows.is_empty() {
        out.push_str("<p>No data: <code>cargo run --release -p stability --bin verdicts</code> makes it.</p></section>");
        return;
    }
    let names: Vec<String> = verification::Scheme::all().iter().map(|s| s.name()).collect();
    let mut scenes: Vec<&str> = Vec::new();
    for row in rows.iter().filter(|r| scheme_of(&r.scheme, &names).is_some()) {
        if !scenes.contains(&row.scene.as_str()) {
            scenes.push(&row.scene);
        }
    }
    out.push_str(
        "<p>Scenes in which material point methods are known to fail, by scheme; of several rows the gravest. \
         <a href=\"stability.html\">The page of stability</a> has what was measured, what was asked, and why.</p><p>",
    );
    for (_, class, sign, meaning) in SIGNS {
        let _ = write!(out, "<span class=\"{class}\">{sign}</span> {meaning}. ");
    }
    out.push_str("</p><div class=\"wide\"><table class=\"map\"><tr><th></th>");
    for scene in &scenes {
        let _ = write!(out, "<th><a href=\"stability.html#{0}\">{0}</a></th>", escape(scene));
    }
    out.push_str("</tr>");
    for (n, name) in names.iter().enumerate() {
        let own: Vec<&Row> = rows.iter().filter(|r| scheme_of(&r.scheme, &names) == Some(n)).collect();
        if own.is_empty() {
            continue;
        }
        let _ = write!(out, "<tr><td>{}</td>", escape(name));
        for scene in &scenes {
            let here = own.iter().filter(|r| r.scene == *scene);
            match here.map(|r| rank(&r.verdict)).max() {
                Some(worst) => {
                    let (verdict, class, sign, _) = SIGNS[worst];
                    let tip = format!("{name}, {scene}: {verdict}");
                    let _ = write!(out, "<td class=\"{class}\" title=\"{}\">{sign}</td>", escape(&tip));
                }
                None => out.push_str("<td></td>"),
            }
        }
        out.push_str("</tr>");
    }
    out.push_str("</table></div>");
    reading(out, rows, &names);
    out.push_str("</section>");
}

fn reading(out: &mut String, rows: &[Row], names: &[String]) {
    let count = |verdict: &str| rows.iter().filter(|r| r.verdict == verdict).count();
    let _ = write!(
        out,
        "<p><b>Reading.</b> Of {} rows {} hold and {} fail as expected, {} fail that should hold, {} hold that should fail. ",
        rows.len(),
        count("PASS"),
        count("FAIL-EXPECTED"),
        count("REGRESSION"),
        count("UNEXPECTED-PASS")
    );
    // Numbers of scenes in which a scheme was run, and of those without a failed row.
    let mut shares: Vec<(f64, usize, usize, &String)> = Vec::new();
    for (n, name) in names.iter().enumerate() {
        let own: Vec<&Row> = rows.iter().filter(|r| scheme_of(&r.scheme, names) == Some(n)).collect();
        let mut scenes: Vec<&str> = own.iter().map(|r| r.scene.as_str()).collect();
        scenes.dedup();
        let fails = |r: &Row| ["FAIL-EXPECTED", "REGRESSION"].contains(&r.verdict.as_str());
        let held = scenes.iter().filter(|s| !own.iter().any(|r| r.scene == **s && fails(r))).count();
        if scenes.len() >= 4 {
            shares.push((held as f64 / scenes.len() as f64, held, scenes.len(), name));
        }
    }
    shares.sort_by(|a, b| b.0.total_cmp(&a.0));
    let say = |(_, held, of, name): &(f64, usize, usize, &String)| format!("{name} ({held} of {of})");
    if shares.len() >= 4 {
        let best: Vec<String> = shares.iter().take(3).map(say).collect();
        let worst: Vec<String> = shares.iter().rev().take(2).map(say).collect();
        let _ = write!(
            out,
            "Of schemes in four scenes and more, {} hold in the largest part of theirs, {} in the smallest. \
             Schemes stand in different scenes, so this ranks nothing.",
            best.join(", "),
            worst.join(" and ")
        );
    }
    out.push_str("</p>");
}
