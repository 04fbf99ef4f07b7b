//! Scales, ticks, labels and colour bars.

use super::canvas::{Pen, Picture};
use super::colour::{ColourMap, Rgb, hex};

pub(crate) const INK: Rgb = hex(0x24292f);
pub(crate) const FAINT: Rgb = hex(0x6b7280);
pub(crate) const GRID: Rgb = hex(0xe6e8eb);
pub(crate) const PAPER: Rgb = [255; 3];

/// Maximum magnitude of an axis, and inverse of the minimum of a logarithmic axis: sums and powers must not overflow.
const MOST: f64 = 1e200;

/// Scale of an axis: range, linear or logarithmic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    pub low: f64,
    pub high: f64,
    pub log: bool,
}

/// Positions and labels of ticks. `power` is the power of ten omitted from the labels.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Ticks {
    pub labelled: Vec<(f64, String)>,
    pub small: Vec<f64>,
    pub power: i32,
}

impl Scale {
    /// Create a scale with a range of nonzero width.
    pub(crate) fn new(low: f64, high: f64, log: bool) -> Self {
        let (low, high) = if low.is_finite() && high.is_finite() { (low, high) } else { (0.0, 1.0) };
        let (mut low, mut high) = (low.min(high).clamp(-MOST, MOST), low.max(high).clamp(-MOST, MOST));
        if log {
            high = high.max(1.0 / MOST);
            low = if low > 0.0 { low.max(1.0 / MOST) } else { low };
            low = if low > 0.0 { low } else { high.max(1e-300) * 1e-3 };
            high = high.max(low);
            if high <= low * 1.0001 {
                (low, high) = (low / 2.0, high * 2.0);
            }
        } else {
            let least = 1e-9 * low.abs().max(high.abs());
            if high - low <= least {
                let half = if least > 0.0 { 0.05 * high.abs() } else { 0.5 };
                (low, high) = (low - half, high + half);
            }
        }
        Self { low, high, log }
    }

    /// Normalized position of a number: 0 at the low end, 1 at the high end.
    pub(crate) fn place(&self, x: f64) -> f64 {
        if self.log {
            (x.ln() - self.low.ln()) / (self.high.ln() - self.low.ln())
        } else {
            (x - self.low) / (self.high - self.low)
        }
    }

    /// Extend both ends by a fraction of the span.
    pub(crate) fn padded(self, part: f64) -> Self {
        if self.log {
            let factor = (part * (self.high.ln() - self.low.ln())).exp();
            Self { low: self.low / factor, high: self.high * factor, ..self }
        } else {
            let pad = part * (self.high - self.low);
            Self { low: self.low - pad, high: self.high + pad, ..self }
        }
    }

    /// Choose about `count` ticks at round numbers.
    pub(crate) fn ticks(&self, count: usize) -> Ticks {
        if self.log && self.high / self.low >= 9.0 { self.log_ticks(count) } else { self.linear_ticks(count) }
    }

    fn linear_ticks(&self, count: usize) -> Ticks {
        let span = self.high - self.low;
        let rough = span / count.max(1) as f64;
        let decade = 10.0_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 2.5, 5.0, 10.0].map(|m| m * decade).into_iter().find(|s| *s >= rough * 0.999);
        let step = step.unwrap_or(10.0 * decade);
        let largest = self.low.abs().max(self.high.abs());
        // The power of very large or very small numbers is a multiple of three.
        let power = if !(1.0e-2..1.0e5).contains(&largest) && largest > 0.0 {
            ((largest.log10() / 3.0).floor() * 3.0) as i32
        } else {
            0
        };
        let unit = 10.0_f64.powi(power);
        let shown = step / unit;
        let decimals = (0..12)
            .find(|d| {
                let scaled = shown * 10.0_f64.powi(*d);
                (scaled - scaled.round()).abs() < 1e-6 * scaled.max(1.0)
            })
            .unwrap_or(12) as usize;
        let first = (self.low / step - 1e-6).ceil() as i64;
        let last = (self.high / step + 1e-6).floor() as i64;
        let labelled =
            (first..=last).map(|i| i as f64 * step).map(|x| (x, signed(x / unit, decimals))).collect();
        Ticks { labelled, small: Vec::new(), power }
    }

    fn log_ticks(&self, count: usize) -> Ticks {
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let inside = |x: f64| x >= self.low * 0.9999 && x <= self.high * 1.0001;
        let every = ((last - first) as usize).div_ceil(count.max(1)).max(1) as i32;
        let decades: Vec<i32> = (first..=last).filter(|e| inside(10.0_f64.powi(*e))).collect();
        let plain = self.low >= 0.0099 && self.high <= 2.0e4;
        let mut ticks = Ticks::default();
        for e in first..=last {
            let decade = 10.0_f64.powi(e);
            for m in 1..10 {
                let x = decade * f64::from(m);
                if !inside(x) {
                    continue;
                }
                let few = decades.len() <= 2 && (m == 2 || m == 5);
                if (m == 1 && (e - first) % every == 0) || few {
                    ticks.labelled.push((x, power_label(m, e, plain)));
                } else {
                    ticks.small.push(x);
                }
            }
        }
        ticks
    }
}

/// Format a number with a typographic minus sign.
fn signed(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| c == '0' || c == '.') => zero.to_string(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// Format `m` times ten to the `e`: plain or `2·10⁻⁵`.
fn power_label(m: i32, e: i32, plain: bool) -> String {
    if plain {
        signed(f64::from(m) * 10.0_f64.powi(e), (-e).max(0) as usize)
    } else if m == 1 {
        format!("10{}", superscript(e))
    } else {
        format!("{m}·10{}", superscript(e))
    }
}

/// Format an integer in superscript digits.
pub(crate) fn superscript(n: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let letter = |c: char| c.to_digit(10).map_or('⁻', |d| DIGITS[d as usize]);
    n.to_string().chars().map(letter).collect()
}

/// Format an axis title as `label (unit)`, with the power of ten omitted from the ticks.
pub(crate) fn axis_title(label: &str, unit: &str, power: i32) -> String {
    let unit = if unit == "-" { "" } else { unit };
    match (power, unit) {
        (0, "") => label.to_string(),
        (0, unit) => format!("{label} ({unit})"),
        (p, "") => format!("{label} (10{})", superscript(p)),
        (p, unit) => format!("{label} (10{} {unit})", superscript(p)),
    }
}

/// Frame of a plot with axes on its sides. Rows count downwards: `top < bottom`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    pub left: f32,
    pub top: f32,
    pub right: f32,
    pub bottom: f32,
    pub x: Scale,
    pub y: Scale,
}

impl Frame {
    /// Pixel position of a point.
    pub(crate) fn at(&self, x: f64, y: f64) -> [f32; 2] {
        [
            self.left + self.x.place(x) as f32 * (self.right - self.left),
            self.bottom - self.y.place(y) as f32 * (self.bottom - self.top),
        ]
    }

    /// Width of tick labels and title of the left side, pixels.
    pub(crate) fn left_room(ticks: &Ticks, size: f32) -> f32 {
        widest(ticks, size) + 2.6 * size
    }

    /// Height of tick labels and title of the bottom, pixels.
    pub(crate) fn bottom_room(size: f32) -> f32 {
        3.6 * size
    }

    pub(crate) fn grid(&self, picture: &mut Picture, ticks: [&Ticks; 2]) {
        for (x, _) in &ticks[0].labelled {
            let px = self.at(*x, self.y.low)[0].round();
            picture.fill([px, self.top], [px + 1.0, self.bottom], GRID);
        }
        for (y, _) in &ticks[1].labelled {
            let py = self.at(self.x.low, *y)[1].round();
            picture.fill([self.left, py], [self.right, py + 1.0], GRID);
        }
    }

    /// Draw the frame, its ticks, their labels and the titles of the two axes.
    pub(crate) fn draw(&self, picture: &mut Picture, ticks: [&Ticks; 2], titles: [&str; 2], size: f32) {
        let line = (size / 14.0).max(1.0).round();
        let mark = 0.32 * size;
        let pen = Pen::new(size, INK);
        picture.frame([self.left, self.top], [self.right, self.bottom], line, INK);
        for (list, long) in
            [(ticks[0].labelled.iter().map(|t| t.0).collect::<Vec<_>>(), 1.0), (ticks[0].small.clone(), 0.55)]
        {
            for x in list {
                let px = self.at(x, self.y.low)[0];
                picture.fill(
                    [px - 0.5 * line, self.bottom],
                    [px + 0.5 * line, self.bottom + mark * long],
                    INK,
                );
            }
        }
        for (list, long) in
            [(ticks[1].labelled.iter().map(|t| t.0).collect::<Vec<_>>(), 1.0), (ticks[1].small.clone(), 0.55)]
        {
            for y in list {
                let py = self.at(self.x.low, y)[1];
                picture.fill([self.left - mark * long, py - 0.5 * line], [self.left, py + 0.5 * line], INK);
            }
        }
        let mut free = f32::NEG_INFINITY;
        for (x, label) in &ticks[0].labelled {
            let px = self.at(*x, self.y.low)[0];
            let half = 0.5 * pen.width(label);
            if px - half > free {
                picture.text(label, [px, self.bottom + mark + 1.15 * size], &pen.centred());
                free = px + half + 0.4 * size;
            }
        }
        for (y, label) in &ticks[1].labelled {
            let py = self.at(self.x.low, *y)[1];
            picture.text(label, [self.left - mark - 0.3 * size, py + 0.36 * size], &pen.right());
        }
        let middle = [0.5 * (self.left + self.right), 0.5 * (self.top + self.bottom)];
        picture.text(titles[0], [middle[0], self.bottom + mark + 2.75 * size], &pen.centred());
        let x = self.left - mark - 1.05 * size - widest(ticks[1], size);
        picture.text(titles[1], [x, middle[1]], &pen.centred().upward());
    }
}

fn widest(ticks: &Ticks, size: f32) -> f32 {
    let pen = Pen::new(size, INK);
    ticks.labelled.iter().map(|(_, label)| pen.width(label)).fold(0.0, f32::max)
}

/// Vertical colour bar with ticks and a title that reads upwards.
pub(crate) struct ColourBar {
    pub map: ColourMap,
    pub scale: Scale,
    pub label: String,
    pub unit: String,
}

impl ColourBar {
    fn ticks(&self) -> Ticks {
        self.scale.ticks(5)
    }

    /// Width from the left edge of the bar, labels included, pixels.
    pub(crate) fn room(&self, size: f32) -> f32 {
        widest(&self.ticks(), size) + 4.2 * size
    }

    pub(crate) fn draw(&self, picture: &mut Picture, left: f32, top: f32, bottom: f32, size: f32) {
        let (left, top, bottom) = (left.round(), top.round(), bottom.round());
        let right = left + (1.0 * size).round();
        let line = (size / 18.0).max(1.0).round();
        for y in top as i64..bottom as i64 {
            let t = (f64::from(bottom) - y as f64 - 0.5) / f64::from(bottom - top);
            picture.fill([left, y as f32], [right, y as f32 + 1.0], self.map.at(t));
        }
        picture.frame([left, top], [right, bottom], line, INK);
        let ticks = self.ticks();
        let pen = Pen::new(size, INK);
        let mark = 0.28 * size;
        for (value, label) in &ticks.labelled {
            let y = bottom - self.scale.place(*value) as f32 * (bottom - top);
            picture.fill([right, y - 0.5 * line], [right + mark, y + 0.5 * line], INK);
            picture.text(label, [right + mark + 0.3 * size, y + 0.36 * size], &pen);
        }
        let x = right + mark + 0.3 * size + widest(&ticks, size) + 1.35 * size;
        let title = axis_title(&self.label, &self.unit, ticks.power);
        picture.text(&title, [x, 0.5 * (top + bottom)], &pen.centred().upward());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, log: bool) -> Vec<String> {
        Scale::new(low, high, log).ticks(5).labelled.into_iter().map(|t| t.1).collect()
    }

    #[test]
    fn ticks_are_round_numbers_inside_the_range() {
        assert_eq!(labels(0.0, 1.0, false), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(-3.2, 6.4, false), ["−2", "0", "2", "4", "6"]);
        assert_eq!(labels(1.0e-4, 1.0, true), ["10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
        assert_eq!(labels(10.0, 160.0, true), ["10", "20", "50", "100"]);
    }

    #[test]
    fn large_numbers_leave_out_a_power_of_ten() {
        let ticks = Scale::new(0.0, 2.0e9, false).ticks(5);
        assert_eq!(ticks.power, 9);
        assert_eq!(ticks.labelled[1].1, "0.5");
        assert_eq!(axis_title("pressure", "Pa", 9), "pressure (10⁹ Pa)");
    }

    #[test]
    fn a_range_of_nothing_is_widened() {
        for (low, high) in [(0.0, 0.0), (3.0, 3.0), (f64::NAN, 1.0), (-2.0e9, -2.0e9)] {
            for log in [false, true] {
                let scale = Scale::new(low, high, log);
                assert!(scale.high > scale.low && !scale.ticks(5).labelled.is_empty(), "{low} {high} {log}");
            }
        }
    }
}
