//! Map of scenes against schemes.

use std::fmt::Write;

use stability::verdict::{SIGNS, Scene, escape, rank, scheme_of};
use verification::Scheme;

use crate::record::Record;

/// Write the map.
pub fn map(out: &mut String, scenes: &[Scene], records: &[Record]) {
    let mut names: Vec<String> = Scheme::all().iter().map(|s| s.name()).collect();
    names.retain(|n| records.iter().any(|r| scheme_of(&r.scheme, std::slice::from_ref(n)).is_some()));
    out.push_str("<div class=\"wide\"><table class=\"map\"><tr><th></th>");
    for name in &names {
        let _ = write!(out, "<th><span>{}</span></th>", escape(name));
    }
    out.push_str("</tr>");
    for scene in scenes {
        let rows: Vec<&Record> = records.iter().filter(|r| r.scene == scene.id).collect();
        if !rows.iter().any(|r| scheme_of(&r.scheme, &names).is_some()) {
            continue;
        }
        let _ = write!(out, "<tr><td><a href=\"#{0}\">{0} {1}</a></td>", scene.id, escape(scene.name));
        for k in 0..names.len() {
            let here: Vec<&&Record> =
                rows.iter().filter(|r| scheme_of(&r.scheme, &names) == Some(k)).collect();
            let Some(worst) = here.iter().map(|r| rank(r.verdict)).max() else {
                out.push_str("<td></td>");
                continue;
            };
            let hints: Vec<String> = here
                .iter()
                .map(|r| format!("{}: {} ({}), {}", r.scheme, r.found(), r.limit, r.verdict))
                .collect();
            let (_, class, sign, _) = SIGNS[worst];
            let _ = write!(out, "<td class=\"{class}\" title=\"{}\">{sign}</td>", escape(&hints.join("\n")));
        }
        out.push_str("</tr>");
    }
    out.push_str("</table></div>");
}

/// Draw a value on a scale of ten decades about its limit; the criterion is met left of the middle.
pub fn gauge(record: &Record) -> String {
    let (width, height) = (150.0, 14.0);
    let middle = 0.5 * width;
    let class = SIGNS[rank(record.verdict)].1;
    let mut svg = format!(
        "<svg class=\"gauge\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\"><path class=\"grid\" \
         d=\"M0 {0}H{width}M{middle} 0V{height}\"/>",
        0.5 * height
    );
    let at = match record.share {
        Some(share) if share > 0.0 => middle * (1.0 + share.log10().clamp(-5.0, 5.0) / 5.4),
        Some(_) => middle * (1.0 - 5.0 / 5.4),
        None => middle * (1.0 + 5.0 / 5.4),
    };
    let _ =
        write!(svg, "<circle class=\"{class}\" cx=\"{at:.1}\" cy=\"{:.1}\" r=\"4\"/></svg>", 0.5 * height);
    svg
}
