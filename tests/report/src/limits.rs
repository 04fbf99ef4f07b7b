//! Map of the stable time step limit over the position of a bar's end in its cell, compared with eigenvalues and Gershgorin
//! circles.

use std::fmt::Write;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};
use verification::limit::{self, Limit};
use verification::{Kernel, Scheme, Velocity};

use crate::chart::escape;
use crate::record::lines;

/// Time step limits of one arrangement of particles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// Scheme.
    pub scheme: String,
    /// Particles per cell.
    pub per_cell: usize,
    /// Offset of the bar's end behind a node, in cells.
    pub offset: f64,
    /// Largest step dt c / h at which noise of a run does not grow.
    pub measured: f64,
    /// Largest step whose update matrix has no eigenvalue beyond one.
    pub predicted: f64,
    /// Eigenvalue estimate of the limit: from the highest nodal frequency.
    pub eigenvalue: f64,
    /// Gershgorin estimate of the limit: from the frequency bound by Gershgorin circles.
    pub gershgorin: f64,
    /// Commit of the program.
    pub commit: String,
}

/// Requested arrangement of particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asked {
    /// Scheme.
    pub scheme: Scheme,
    /// Particles per cell.
    pub per_cell: usize,
    /// Offset of the bar's end behind a node, in cells.
    pub offset: f64,
}

impl Asked {
    /// List all schemes at evenly spaced offsets of the bar, none with a particle on a cell face.
    pub fn all(quick: bool) -> Vec<Asked> {
        let offsets = if quick { 16 } else { 64 };
        let mut list = Vec::new();
        for scheme in limit::schemes() {
            for per_cell in 1..=4 {
                let at = |n: usize| (n as f64 + 0.3) / offsets as f64;
                list.extend((0..offsets).map(|n| Asked { scheme, per_cell, offset: at(n) }));
            }
        }
        list
    }

    /// Compute the limits.
    ///
    /// # Errors
    /// As [`limit::limit`].
    pub fn make(&self, commit: &str) -> Result<Found, String> {
        let Limit { scheme, per_cell, offset, measured, predicted, eigenvalue, gershgorin } =
            limit::limit(self.scheme, self.per_cell, self.offset)?;
        let (scheme, commit) = (scheme.name(), commit.into());
        Ok(Found { scheme, per_cell, offset, measured, predicted, eigenvalue, gershgorin, commit })
    }
}

impl Found {
    /// Return true if the limits belong to the request.
    pub fn is_of(&self, asked: &Asked) -> bool {
        (self.scheme.as_str(), self.per_cell, self.offset)
            == (asked.scheme.name().as_str(), asked.per_cell, asked.offset)
    }
}

/// Read stored limits; the later ones of the same arrangement replace the earlier ones.
///
/// # Errors
/// The file cannot be read.
pub fn read(path: &Path) -> io::Result<Vec<Found>> {
    let mut list: Vec<Found> = Vec::new();
    let key = |f: &Found| (f.scheme.clone(), f.per_cell, f.offset);
    for found in lines::<Found>(path)? {
        match list.iter().position(|f| key(f) == key(&found)) {
            Some(at) => list[at] = found,
            None => list.push(found),
        }
    }
    list.sort_by(|a, b| {
        (&a.scheme, a.per_cell).cmp(&(&b.scheme, b.per_cell)).then(a.offset.total_cmp(&b.offset))
    });
    Ok(list)
}

/// Write all limits as a CSV table.
///
/// # Errors
/// The file cannot be written.
pub fn write_csv(path: &Path, list: &[Found]) -> io::Result<()> {
    let mut text =
        String::from("scheme,particles a cell,offset,measured,predicted,eigenvalue,Gershgorin,commit\n");
    for f in list {
        let numbers = [f.offset, f.measured, f.predicted, f.eigenvalue, f.gershgorin];
        let numbers = numbers.map(|x| format!("{x:.4}")).join(",");
        text += &format!("{},{},{numbers},{}\n", f.scheme, f.per_cell, f.commit);
    }
    std::fs::write(path, text)
}

/// Particles per cell of the drawings.
const DRAWN: usize = 2;
/// Upper limit of the drawings.
const HIGH: f64 = 3.0;
/// Plot area of a drawing.
const LEFT: f64 = 66.0;
const RIGHT: f64 = 498.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 304.0;

/// Transfers of the chart, by colour.
const VELOCITIES: [(Velocity, &str); 3] =
    [(Velocity::FlipUsl, "FLIP, USL"), (Velocity::FlipMusl, "FLIP, MUSL"), (Velocity::ApicUsl, "APIC, USL")];
const KERNELS: [(Kernel, &str); 4] = [
    (Kernel::Linear, "linear shape functions"),
    (Kernel::Gimp, "uGIMP"),
    (Kernel::Quadratic, "quadratic splines"),
    (Kernel::Cubic, "cubic splines"),
];

/// Select the limits of a scheme and a number of particles per cell, by offset.
fn of(list: &[Found], scheme: Scheme, per_cell: usize) -> Vec<&Found> {
    let name = scheme.name();
    let mut own: Vec<&Found> = list.iter().filter(|f| f.scheme == name && f.per_cell == per_cell).collect();
    own.sort_by(|a, b| a.offset.total_cmp(&b.offset));
    own
}

fn drawing(list: &[Found], kernel: Kernel, title: &str) -> Option<String> {
    let mut out = format!("<svg viewBox=\"0 0 520 360\" role=\"img\" aria-label=\"{}\">", escape(title));
    let x = |offset: f64| LEFT + offset * (RIGHT - LEFT);
    let y = |limit: f64| BOTTOM - limit.min(HIGH) / HIGH * (BOTTOM - TOP);
    for n in 0..=4 {
        let part = 0.25 * f64::from(n);
        let limit = part * HIGH;
        let (across, up) = (x(part), y(limit));
        let _ = write!(
            out,
            "<path class=\"grid\" d=\"M{across:.1} {TOP}V{BOTTOM}M{LEFT} {up:.1}H{RIGHT}\"/>\
             <text x=\"{across:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{part}</text>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{limit}</text>",
            BOTTOM + 20.0,
            LEFT - 8.0,
            up + 5.0
        );
    }
    let _ = write!(
        out,
        "<text x=\"{:.1}\" y=\"348\" text-anchor=\"middle\">end of the bar behind a node, cells</text>\
         <text transform=\"translate(16 {:.1}) rotate(-90)\" text-anchor=\"middle\">longest step, dt c / h</text>\
         <text class=\"faint\" x=\"{LEFT}\" y=\"16\">{title}, {DRAWN} particles a cell</text>",
        0.5 * (LEFT + RIGHT),
        0.5 * (TOP + BOTTOM)
    );
    let mut any = false;
    for (colour, (velocity, name)) in VELOCITIES.into_iter().enumerate() {
        let own = of(list, Scheme::moving(kernel, velocity), DRAWN);
        any |= !own.is_empty();
        for (of, dash) in [
            (&(|f: &Found| f.predicted) as &dyn Fn(&Found) -> f64, "none"),
            (&|f: &Found| f.gershgorin, "2 4"),
        ] {
            let mut d = String::new();
            for f in &own {
                let letter = if d.is_empty() { "M" } else { "L" };
                let _ = write!(d, "{letter}{:.1} {:.1}", x(f.offset), y(of(f)));
            }
            let _ =
                write!(out, "<path class=\"line c{}\" stroke-dasharray=\"{dash}\" d=\"{d}\"/>", colour + 1);
        }
        for f in own {
            let tip = format!(
                "{name}: {:.3} measured, {:.3} by eigenvalues of the step, {:.3} by circles",
                f.measured, f.predicted, f.gershgorin
            );
            let _ = write!(
                out,
                "<circle class=\"disc c{}\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"4\"><title>{}</title></circle>",
                colour + 1,
                x(f.offset),
                y(f.measured),
                escape(&tip)
            );
        }
    }
    out.push_str("</svg>");
    any.then_some(out)
}

/// Write the section of the page.
pub fn section(out: &mut String, list: &[Found]) {
    out.push_str(
        "<section><h2 id=\"c10-limits\">C10. How long a step may be</h2><p>A free elastic bar of eight cells; its end stands \
         anywhere in a cell. Discs: the longest step at which noise in a run of 500 steps does not grow. Lines: the longest \
         whose matrix has no eigenvalue beyond one. Dotted: what the circles of Gershgorin around the \
         nodes allow, as <code>TimeControl::Gershgorin</code> uses them (book, \"The stable time step\"). What never ends, and what ends above 3, is drawn at 3.</p>",
    );
    if list.is_empty() {
        out.push_str("<p>No run yet.</p></section>");
        return;
    }
    out.push_str("<div class=\"pair\">");
    for (kernel, title) in KERNELS {
        if let Some(drawing) = drawing(list, kernel, title) {
            let _ = write!(out, "<figure>{drawing}</figure>");
        }
    }
    out.push_str("</div><p class=\"legend\">");
    for (colour, (_, name)) in VELOCITIES.into_iter().enumerate() {
        let _ = write!(
            out,
            "<span><svg viewBox=\"0 0 34 12\"><path class=\"line c{0}\" d=\"M0 6H34\"/>\
             <circle class=\"disc c{0}\" cx=\"17\" cy=\"6\" r=\"4\"/></svg>{name}</span> ",
            colour + 1
        );
    }
    out.push_str("</p>");
    reading(out, list);
    table(out, list);
    out.push_str("<p><small>Data: <a href=\"c10-limits.csv\">c10-limits.csv</a>.</small></p></section>");
}

/// Minimum of a limit.
fn least(own: &[&Found], of: impl Fn(&Found) -> f64) -> f64 {
    own.iter().map(|f| of(f)).fold(f64::INFINITY, f64::min)
}

fn reading(out: &mut String, list: &[Found]) {
    // Arrangements with a finite limit: noise that grows by less than a thousand is not detected.
    let told: Vec<&Found> = list.iter().filter(|f| f.measured > 0.0 && f.predicted > 0.0).collect();
    let apart = |f: &&Found| (f.predicted / f.measured - 1.0).abs();
    let near = told.iter().filter(|f| apart(f) < 0.05).count();
    let over = told.iter().filter(|f| f.gershgorin > 1.02 * f.measured).count();
    let _ = write!(
        out,
        "<p><b>Reading.</b> Of {} arrangements {} measured limits lie within 5 % of that of the eigenvalues. The circles allow \
         more than was measured in {over} of {}. ",
        told.len(),
        near,
        told.len()
    );
    for (velocity, name) in VELOCITIES {
        let least: Vec<String> = KERNELS
            .into_iter()
            .filter_map(|(kernel, title)| {
                let own = of(list, Scheme::moving(kernel, velocity), DRAWN);
                (!own.is_empty()).then(|| format!("{:.2} with {title}", least(&own, |f| f.measured)))
            })
            .collect();
        if !least.is_empty() {
            let _ = write!(out, "{name}: at worst {}. ", least.join(", "));
        }
    }
    out.push_str("</p>");
}

fn table(out: &mut String, list: &[Found]) {
    out.push_str(
        "<details><summary>The least over all places of the bar</summary><div class=\"wide\"><table><tr><th>scheme</th><th>particles a \
         cell</th><th>measured</th><th>eigenvalues of the step</th><th>highest frequency</th><th>circles</th></tr>",
    );
    let mut groups: Vec<(&str, usize)> = Vec::new();
    for f in list {
        let group = (f.scheme.as_str(), f.per_cell);
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    for (scheme, per_cell) in groups {
        let own: Vec<&Found> = list.iter().filter(|f| f.scheme == scheme && f.per_cell == per_cell).collect();
        let _ = write!(
            out,
            "<tr><td>{}</td><td>{per_cell}</td><td>{:.3}</td><td>{:.3}</td><td>{:.3}</td><td>{:.3}</td></tr>",
            escape(scheme),
            least(&own, |f| f.measured),
            least(&own, |f| f.predicted),
            least(&own, |f| f.eigenvalue),
            least(&own, |f| f.gershgorin)
        );
    }
    out.push_str("</table></div></details>");
}
