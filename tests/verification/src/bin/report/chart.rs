//! A chart of error against work, both logarithmic, as inline SVG that follows the colours of the page.

use std::fmt::Write;

use crate::front::{Cost, front, schemes};
use crate::record::Record;

/// Size of the drawing and of its plot area.
const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 440.0;
const LEFT: f64 = 66.0;
const RIGHT: f64 = 508.0;
const TOP: f64 = 28.0;
const BOTTOM: f64 = 384.0;

/// A scale from decades to the drawing.
struct Scale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Scale {
    /// Around these values, with room to whole decades.
    fn around(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Option<Self> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for v in values.filter(|v| *v > 0.0 && v.is_finite()) {
            low = low.min(v.log10());
            high = high.max(v.log10());
        }
        let (low, high) = (low.floor(), high.ceil());
        (low.is_finite() && high.is_finite()).then(|| Scale { low, high: high.max(low + 1.0), from, to })
    }
    fn at(&self, value: f64) -> f64 {
        let share = (value.log10() - self.low) / (self.high - self.low);
        self.from + share.clamp(-0.02, 1.02) * (self.to - self.from)
    }
    fn decades(&self) -> impl Iterator<Item = i32> {
        self.low as i32..=self.high as i32
    }
}

/// The number of a scheme's colour and whether its line is dashed.
fn style(scheme: &str) -> (usize, &'static str) {
    let kernel = ["linear", "uGIMP", "cpGIMP", "quadratic", "cubic"];
    let colour = kernel.iter().position(|k| scheme.contains(k)).unwrap_or(0);
    let dash = if scheme.contains("MUSL") {
        "7 4"
    } else if scheme.contains("APIC") {
        "2 4"
    } else if scheme.contains("FMPM") {
        "9 3 2 3"
    } else {
        "none"
    };
    (colour + 1, dash)
}

/// A marker of a scheme: rings in the reference configuration, discs that move with the material.
fn marker(out: &mut String, scheme: &str, x: f64, y: f64, size: f64, tip: &str) {
    let (colour, _) = style(scheme);
    let kind = if scheme.starts_with("TL") { "ring" } else { "disc" };
    let _ = write!(
        out,
        "<circle class=\"{kind} c{colour}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{size}\"><title>{tip}</title></circle>"
    );
}

fn tip(record: &Record, error: &str) -> String {
    let value = match (record.error(error), &record.failure) {
        (Some(e), _) => format!("error {e:.2e}"),
        (None, Some(failure)) => format!("stopped: {}", escape(failure)),
        (None, None) => "no error".into(),
    };
    let Record { scheme, units, core_seconds, .. } = record;
    format!("{scheme}: {value}; {}; {units:.2e} units, {core_seconds:.3} core-s", record.settings())
}

/// Text that may stand in markup.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The chart of some runs. A line is a scheme's own unbeaten runs; the others of the scheme are faint; runs that
/// stopped
/// or whose error is above the top are crosses on the top edge; the broad line joins the unbeaten of all.
pub fn draw(runs: &[&Record], error: &str, error_label: &str, cost: Cost) -> Option<String> {
    let x = Scale::around(runs.iter().map(|r| cost.of(r)), LEFT, RIGHT)?;
    // Errors above one are no answers: they are crosses on the edge, as failures are.
    let inside = |r: &&&Record| r.error(error).is_some_and(|e| e <= 1.0);
    let y = Scale::around(runs.iter().filter(inside).filter_map(|r| r.error(error)), BOTTOM, TOP)?;
    let mut out = format!(
        "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{error_label} against {}\">",
        cost.label()
    );
    axes(&mut out, &x, &y, error_label, cost);
    let all = front(runs.iter().copied(), error, cost);
    path(&mut out, &all, error, cost, (&x, &y), "class=\"front\"");
    for scheme in schemes(runs) {
        let own: Vec<&Record> = runs.iter().copied().filter(|r| r.scheme == scheme).collect();
        let line: Vec<&Record> =
            front(own.iter().copied(), error, cost).into_iter().filter(|r| inside(&r)).collect();
        let (colour, dash) = style(&scheme);
        path(
            &mut out,
            &line,
            error,
            cost,
            (&x, &y),
            &format!("class=\"line c{colour}\" stroke-dasharray=\"{dash}\""),
        );
        for record in own {
            let at = x.at(cost.of(record).max(1e-300));
            match record.error(error) {
                Some(e) if e <= 1.0 => {
                    let on_line = line.iter().any(|r| std::ptr::eq(*r, record));
                    marker(
                        &mut out,
                        &scheme,
                        at,
                        y.at(e),
                        if on_line { 4.0 } else { 1.8 },
                        &tip(record, error),
                    );
                }
                _ => {
                    let _ = write!(
                        out,
                        "<path class=\"cross c{colour}\" d=\"M{:.1} {:.1}l8 8m0 -8l-8 8\"><title>{}</title></path>",
                        at - 4.0,
                        TOP - 4.0,
                        tip(record, error)
                    );
                }
            }
        }
    }
    out.push_str("</svg>");
    Some(out)
}

fn path(out: &mut String, runs: &[&Record], error: &str, cost: Cost, (x, y): (&Scale, &Scale), how: &str) {
    let mut d = String::new();
    for r in runs {
        let Some(e) = r.error(error).filter(|e| *e <= 1.0) else { continue };
        let _ = write!(d, "{}{:.1} {:.1}", if d.is_empty() { "M" } else { "L" }, x.at(cost.of(r)), y.at(e));
    }
    if !d.is_empty() {
        let _ = write!(out, "<path {how} d=\"{d}\"/>");
    }
}

fn axes(out: &mut String, x: &Scale, y: &Scale, error_label: &str, cost: Cost) {
    let power = |n: i32| format!("10<tspan dy=\"-6\" font-size=\"11\">{n}</tspan>");
    let skip = ((x.high - x.low) / 6.0).ceil() as i32;
    for n in x.decades() {
        let at = x.at(10f64.powi(n));
        let _ = write!(out, "<path class=\"grid\" d=\"M{at:.1} {TOP}V{BOTTOM}\"/>");
        if (n - x.low as i32) % skip.max(1) == 0 {
            let _ = write!(
                out,
                "<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                BOTTOM + 20.0,
                power(n)
            );
        }
    }
    for n in y.decades() {
        let at = y.at(10f64.powi(n));
        let _ = write!(
            out,
            "<path class=\"grid\" d=\"M{LEFT} {at:.1}H{RIGHT}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            LEFT - 8.0,
            at + 5.0,
            power(n)
        );
    }
    let _ = write!(
        out,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\
         <text transform=\"translate(16 {:.1}) rotate(-90)\" text-anchor=\"middle\">{error_label}</text>\
         <text class=\"faint\" x=\"{LEFT}\" y=\"14\">× stopped, or error above 1</text>",
        0.5 * (LEFT + RIGHT),
        HEIGHT - 12.0,
        cost.label(),
        0.5 * (TOP + BOTTOM)
    );
}

/// The legend: one entry a scheme.
pub fn legend(runs: &[&Record]) -> String {
    let mut out = String::from("<p class=\"legend\">");
    for scheme in schemes(runs) {
        let (colour, dash) = style(&scheme);
        let _ = write!(
            out,
            "<span><svg viewBox=\"0 0 34 12\"><path class=\"line c{colour}\" stroke-dasharray=\"{dash}\" d=\"M0 6H34\"/>"
        );
        marker(&mut out, &scheme, 17.0, 6.0, 4.0, &scheme);
        let _ = write!(out, "</svg>{scheme}</span> ");
    }
    out.push_str("</p>");
    out
}
