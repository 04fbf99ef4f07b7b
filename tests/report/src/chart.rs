//! Error-work charts with two logarithmic axes, as inline SVG in the colours of the page.

use std::fmt::Write;

use examples::peers::Peer;

use crate::contact::DETECTIONS;
use crate::front::{Cost, front, growing, schemes};
use crate::peers;
use crate::record::Record;
use crate::sweep::{Chart, Kind};

/// Size of the drawing and of its plot area.
const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 440.0;
const LEFT: f64 = 66.0;
const RIGHT: f64 = 498.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 384.0;

/// Logarithmic scale: maps decades to drawing coordinates.
pub struct Scale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Scale {
    fn around(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Option<Self> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for v in values.filter(|v| *v > 0.0 && v.is_finite()) {
            low = low.min(v.log10());
            high = high.max(v.log10());
        }
        let (low, high) = (low.floor(), high.ceil());
        (low.is_finite() && high.is_finite()).then(|| Scale { low, high: high.max(low + 1.0), from, to })
    }
    /// Create a horizontal scale around these values, with whole decades.
    pub fn across(values: impl Iterator<Item = f64>) -> Option<Self> {
        Self::around(values, LEFT, RIGHT)
    }
    /// Create a vertical scale around these values.
    pub fn up(values: impl Iterator<Item = f64>) -> Option<Self> {
        Self::around(values, BOTTOM, TOP)
    }
    /// Drawing coordinate of a value.
    pub fn at(&self, value: f64) -> f64 {
        let share = (value.log10() - self.low) / (self.high - self.low);
        self.from + share.clamp(-0.02, 1.02) * (self.to - self.from)
    }
    fn decades(&self) -> impl Iterator<Item = i32> + use<> {
        self.low as i32..=self.high as i32
    }
}

/// Marker shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Updated Lagrangian runs.
    Disc,
    /// Total Lagrangian runs, or runs in single precision.
    Ring,
    /// Cells of random points; elements converted to particles.
    Triangle,
    /// Runs of Taichi.
    Square,
    /// Runs of Warp.
    Diamond,
}

impl Mark {
    /// Select the marker of a peer's run, or a ring or disc for a run of this library.
    pub fn of(peer: Option<Peer>, ring: bool) -> Mark {
        match peer {
            Some(Peer::Taichi) => Mark::Square,
            Some(Peer::Warp) => Mark::Diamond,
            None if ring => Mark::Ring,
            None => Mark::Disc,
        }
    }

    /// Draw the marker with its colour number, and a tooltip unless empty. Markers of peers are hollow and larger, so that
    /// coincident markers of this library remain visible.
    pub fn draw(self, out: &mut String, colour: usize, (x, y): (f64, f64), size: f64, tip: &str) {
        let title = if tip.is_empty() { String::new() } else { format!("<title>{tip}</title>") };
        let _ = match self {
            Mark::Disc | Mark::Ring => {
                let kind = if self == Mark::Ring { "ring" } else { "disc" };
                write!(
                    out,
                    "<circle class=\"{kind} c{colour}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{size}\">{title}</circle>"
                )
            }
            Mark::Triangle => {
                let (half, high) = (size + 0.5, 1.8 * size);
                write!(
                    out,
                    "<path class=\"peer c{colour}\" d=\"M{x:.1} {:.1}l{half} {high}h-{:.1}z\">{title}</path>",
                    y - 0.6 * high,
                    2.0 * half
                )
            }
            Mark::Square => {
                let (low, wide) = (size + 0.5, 2.0 * size + 1.0);
                write!(
                    out,
                    "<path class=\"peer c{colour}\" d=\"M{:.1} {:.1}h{wide}v{wide}h-{wide}z\">{title}</path>",
                    x - low,
                    y - low
                )
            }
            Mark::Diamond => {
                let r = size + 1.5;
                write!(
                    out,
                    "<path class=\"peer c{colour}\" d=\"M{:.1} {y:.1}l{r} -{r}l{r} {r}l-{r} {r}z\">{title}</path>",
                    x - r
                )
            }
        };
    }
}

/// Line style of a scheme: colour number, dash and marker.
struct Style {
    colour: usize,
    dash: &'static str,
    mark: Mark,
}

impl Style {
    /// Select the style: its colour is that of the contact detection for contact, of the dilatation for footings,
    /// else of the kernel.
    fn of(scheme: &str) -> Style {
        let (peer, scheme) = peers::split(scheme);
        let (method, variant) = scheme.split_once(", ").unwrap_or((scheme, ""));
        if let Some(test) = DETECTIONS.iter().position(|d| d.name() == variant) {
            let ring = method.contains("quadratic");
            return Style {
                colour: test + 1,
                dash: if ring { "7 4" } else { "none" },
                mark: Mark::of(peer, ring),
            };
        }
        // Methods other than material points.
        let beside = [
            ("PCMM", 2, false),
            ("SPH total Lagrangian", 8, true),
            ("SPH updated", 8, false),
            ("FE one point", 3, true),
            ("FE mean dilatation", 5, true),
            ("FE averaged triangles", 6, true),
        ];
        if let Some((_, colour, ring)) = beside.into_iter().find(|(name, ..)| method == *name) {
            return Style { colour, dash: "none", mark: Mark::of(peer, ring) };
        }
        if ["MPFEM", "AFEMP"].contains(&method) {
            let dash = if method == "MPFEM" { "2 4" } else { "none" };
            return Style { colour: 7, dash, mark: Mark::Triangle };
        }
        if let Some(cells) = method.strip_prefix("FPM ") {
            let colour = if cells.starts_with("strength") { 1 } else { 7 };
            let broken = cells.starts_with("printed") || cells.ends_with("second set");
            let squares = ["printed", "symmetric"].contains(&cells);
            let mark = if squares { Mark::Ring } else { Mark::Triangle };
            return Style { colour, dash: if broken { "7 4" } else { "none" }, mark };
        }
        let ring = method.starts_with("TL");
        if !variant.is_empty() {
            let colour = if variant.starts_with("mean") { 3 } else { 1 };
            return Style { colour, dash: if ring { "7 4" } else { "none" }, mark: Mark::of(peer, ring) };
        }
        let kernel = ["linear", "uGIMP", "cpGIMP", "quadratic", "cubic", "CPDI-2", "CPDI"];
        let colour = kernel.iter().position(|k| method.contains(k)).unwrap_or(0) + 1;
        let dash = if method.contains("AFLIP") {
            "none"
        } else if method.contains("MUSL") {
            "7 4"
        } else if method.contains("APIC") {
            "2 4"
        } else if method.contains("FMPM") {
            "9 3 2 3"
        } else {
            "none"
        };
        Style { colour, dash, mark: Mark::of(peer, ring) }
    }
}

fn tip(record: &Record, error: &str) -> String {
    let value = match (record.error(error), &record.failure) {
        (Some(e), _) => format!("error {e:.2e}"),
        (None, Some(failure)) => format!("stopped: {}", escape(failure)),
        (None, None) => "no error".into(),
    };
    let Record { units, core_seconds, steps, .. } = record;
    let instructions = record.instructions.map_or(String::new(), |i| format!(", {i:.1e} instructions"));
    let scheme = escape(record.scheme());
    format!(
        "{scheme}: {value}; {}, {steps} steps; {units:.1e} units{instructions}, {core_seconds:.3} core-s",
        record.settings()
    )
}

pub use stability::verdict::escape;

/// Open the SVG element of a drawing.
pub fn open(about: &str) -> String {
    format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">", escape(about))
}

/// Draw the chart of some runs. A line joins the Pareto front of a scheme; its other runs are faint. Runs that stopped or
/// whose error is above the top are crosses on the top edge. The broad line is the Pareto front of all runs of this
/// library. `theirs` are the runs of peers. `band` is the timing noise, drawn for charts against time.
pub fn draw(
    chart: &Chart,
    runs: &[&Record],
    theirs: &[&Record],
    cost: Cost,
    band: Option<f64>,
) -> Option<String> {
    let error = chart.error;
    let drawn: Vec<&Record> = runs.iter().chain(theirs).copied().collect();
    let x = Scale::across(drawn.iter().filter_map(|r| cost.of(r)))?;
    // Errors above one are crosses on the edge, like failures.
    let inside = |r: &Record| r.answer(error).is_some();
    let y = Scale::up(drawn.iter().filter_map(|r| r.answer(error)))?;
    let mut out = open(&format!("{} against {}", chart.label, cost.label()));
    let what = if chart.kind == Kind::Time {
        "× stopped, or change above 1"
    } else if chart.marks_growth {
        "× stopped, or error above 1; ○ error grew under refinement"
    } else {
        "× stopped, or error above 1"
    };
    axes(&mut out, (&x, &y), cost.label(), chart.label, what);
    if chart.kind == Kind::Work {
        let all = front(runs.iter().copied().filter(|r| inside(r)), error, cost);
        path(&mut out, &all, error, cost, (&x, &y), "class=\"front\"");
    }
    if chart.marks_growth {
        for record in growing(runs, error, chart.finest_target()) {
            if let (Some(cost), Some(e)) = (cost.of(record), record.answer(error)) {
                let _ = write!(
                    out,
                    "<circle class=\"grows\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"9\"/>",
                    x.at(cost),
                    y.at(e.max(1e-300))
                );
            }
        }
    }
    for scheme in schemes(&drawn) {
        let own: Vec<&Record> = drawn.iter().copied().filter(|r| r.scheme() == scheme).collect();
        let good = own.iter().copied().filter(|r| inside(r));
        let line: Vec<&Record> =
            if chart.kind == Kind::Time { good.collect() } else { front(good, error, cost) };
        let Style { colour, dash, mark } = Style::of(&scheme);
        let how = format!("class=\"line c{colour}\" stroke-dasharray=\"{dash}\"");
        path(&mut out, &line, error, cost, (&x, &y), &how);
        for record in own {
            // Runs that stopped before the first step are at the left end.
            let at = x.at(cost.of(record).unwrap_or(1e-300));
            match record.answer(error) {
                Some(_) if cost.of(record).is_none() => {}
                Some(e) => {
                    let size = if line.iter().any(|r| std::ptr::eq(*r, record)) { 4.0 } else { 1.8 };
                    mark.draw(&mut out, colour, (at, y.at(e.max(1e-300))), size, &tip(record, error));
                }
                None => {
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
    if let Some(band) = band.filter(|_| cost == Cost::Seconds) {
        noise(&mut out, &x, band);
    }
    out.push_str("</svg>");
    Some(out)
}

/// Draw the timing noise as a bar in the scale of the axis.
fn noise(out: &mut String, x: &Scale, band: f64) {
    let wide = (x.to - x.from) / (x.high - x.low) * (1.0 + band).log10();
    let (at, high) = (LEFT + 10.0, BOTTOM - 14.0);
    let _ = write!(
        out,
        "<path class=\"noise\" d=\"M{at:.1} {:.1}v10m{wide:.2} 0v-10m0 5h-{wide:.2}\"/>\
         <text class=\"faint\" x=\"{:.1}\" y=\"{:.1}\">noise of time, {}</text>",
        high - 5.0,
        at + wide + 6.0,
        high + 5.0,
        percent(band)
    );
}

/// Format a fraction as a percentage with two significant figures, without trailing zeros.
pub fn percent(e: f64) -> String {
    if e >= 0.1 {
        format!("{:.0} %", 100.0 * e)
    } else if e >= 0.001 {
        format!("{:.1} %", 100.0 * e).replace(".0 %", " %")
    } else {
        format!("{e:.1e}")
    }
}

fn path(out: &mut String, runs: &[&Record], error: &str, cost: Cost, (x, y): (&Scale, &Scale), how: &str) {
    let mut d = String::new();
    for r in runs {
        let (Some(cost), Some(e)) = (cost.of(r), r.error(error)) else { continue };
        let letter = if d.is_empty() { "M" } else { "L" };
        let _ = write!(d, "{letter}{:.1} {:.1}", x.at(cost), y.at(e.max(1e-300)));
    }
    if !d.is_empty() {
        let _ = write!(out, "<path {how} d=\"{d}\"/>");
    }
}

/// Draw axes with decades and labels, and a remark at the top.
pub fn axes(out: &mut String, (x, y): (&Scale, &Scale), along: &str, up: &str, remark: &str) {
    let power = |n: i32| format!("10<tspan dy=\"-6\" font-size=\"11\">{n}</tspan>");
    let skip = ((x.high - x.low) / 6.0).ceil() as i32;
    for n in x.decades() {
        let at = x.at(10f64.powi(n));
        let _ = write!(out, "<path class=\"grid\" d=\"M{at:.1} {TOP}V{BOTTOM}\"/>");
        if (n - x.low as i32) % skip.max(1) == 0 {
            let low = BOTTOM + 20.0;
            let _ =
                write!(out, "<text x=\"{at:.1}\" y=\"{low:.1}\" text-anchor=\"middle\">{}</text>", power(n));
        }
    }
    if y.high - y.low < 2.5 {
        for (n, part) in
            y.decades().flat_map(|n| [(n, 2.0), (n, 5.0)]).filter(|(n, _)| f64::from(*n) < y.high)
        {
            let (left, at) = (LEFT - 8.0, y.at(part * 10f64.powi(n)));
            let _ = write!(
                out,
                "<path class=\"grid\" d=\"M{LEFT} {at:.1}H{RIGHT}\"/>\
                 <text class=\"faint\" x=\"{left:.1}\" y=\"{:.1}\" text-anchor=\"end\">{part}</text>",
                at + 4.0
            );
        }
    }
    let skip = ((y.high - y.low) / 7.0).ceil() as i32;
    for n in y.decades() {
        let at = y.at(10f64.powi(n));
        let _ = write!(out, "<path class=\"grid\" d=\"M{LEFT} {at:.1}H{RIGHT}\"/>");
        if (n - y.low as i32) % skip.max(1) == 0 {
            let (left, low) = (LEFT - 8.0, at + 5.0);
            let _ =
                write!(out, "<text x=\"{left:.1}\" y=\"{low:.1}\" text-anchor=\"end\">{}</text>", power(n));
        }
    }
    let _ = write!(
        out,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{along}</text>\
         <text transform=\"translate(16 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>\
         <text class=\"faint\" x=\"{LEFT}\" y=\"16\">{remark}</text>",
        0.5 * (LEFT + RIGHT),
        HEIGHT - 12.0,
        0.5 * (TOP + BOTTOM),
        escape(up)
    );
}

/// Format the legend: one entry per scheme.
pub fn legend(runs: &[&Record]) -> String {
    let mut out = String::from("<p class=\"legend\">");
    for scheme in schemes(runs) {
        let Style { colour, dash, mark } = Style::of(&scheme);
        let _ = write!(
            out,
            "<span><svg viewBox=\"0 0 34 12\"><path class=\"line c{colour}\" stroke-dasharray=\"{dash}\" d=\"M0 6H34\"/>"
        );
        mark.draw(&mut out, colour, (17.0, 6.0), 4.0, &escape(&scheme));
        let _ = write!(out, "</svg>{}</span> ", escape(&scheme));
    }
    out.push_str("</p>");
    out
}
