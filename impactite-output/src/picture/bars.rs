//! Stacked bar charts: contributions to several totals.

use super::super::OutputError;
use super::axis::{Frame, INK, PAPER, Scale, Ticks, axis_title};
use super::canvas::{Pen, Picture};
use super::chart::Axis;
use super::colour::palette;

/// Horizontal stacked bar chart: every bar is the sum of the same parts. The name of a bar is to its left, the legend of the parts in
/// a row above.
///
/// ```
/// use impactite_output::picture::{Axis, Bars};
/// let picture = Bars::new(700, 260, ["search", "sums", "law"])
///     .title("A step")
///     .x(Axis::new("share").unit("%", 100.0).range(0.0, 1.0))
///     .bar("tree", &[0.6, 0.3, 0.1])
///     .bar("cells", &[0.2, 0.6, 0.2])
///     .draw()?;
/// # Ok::<(), impactite_output::OutputError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Bars {
    width: usize,
    height: usize,
    title: String,
    x: Axis,
    parts: Vec<String>,
    bars: Vec<(String, Vec<f64>)>,
    letters: Option<f32>,
}

/// Thickness of a bar over its spacing.
const FILLED: f64 = 0.7;

impl Bars {
    /// Create a chart of this size in pixels with these parts and no bars.
    #[must_use]
    pub fn new(width: usize, height: usize, parts: impl IntoIterator<Item = impl Into<String>>) -> Self {
        let parts = parts.into_iter().map(Into::into).collect();
        Self { width, height, title: String::new(), x: Axis::new(""), parts, bars: Vec::new(), letters: None }
    }

    /// Set the title at the top.
    #[must_use]
    pub fn title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Set the axis along the bottom, which must be linear.
    #[must_use]
    pub fn x(self, axis: Axis) -> Self {
        Self { x: axis, ..self }
    }

    /// Add a bar below the others, with the length of each part.
    #[must_use]
    pub fn bar(mut self, name: impl Into<String>, lengths: &[f64]) -> Self {
        self.bars.push((name.into(), lengths.to_vec()));
        self
    }

    /// Set the font size, 1 to 1000 pixels; the default depends on the size of the picture.
    #[must_use]
    pub fn letters(self, size: f32) -> Self {
        Self { letters: Some(size), ..self }
    }

    /// Draw the chart.
    ///
    /// # Errors
    /// A bar with another number of parts, or with a length that is negative or not finite; a logarithmic axis; invalid sizes, factors or
    /// ranges.
    pub fn draw(&self) -> Result<Picture, OutputError> {
        self.check()?;
        let mut picture = Picture::new(self.width, self.height, PAPER)?;
        let size = super::letters(self.letters, 1.15, self.width, self.height)?;
        let factor = self.x.factor;
        let wholes = self.bars.iter().map(|(_, parts)| parts.iter().sum::<f64>() * factor);
        let x = self.x.shown(wholes.chain([0.0]))?;
        let y = Scale::new(0.0, self.bars.len().max(1) as f64, false);
        // The first bar is at the top.
        let middle = |n: usize| (self.bars.len() - n) as f64 - 0.5;
        let names = self.bars.iter().enumerate().map(|(n, (name, _))| (middle(n), name.clone())).collect();
        let y_ticks = Ticks { labelled: names, ..Ticks::default() };
        let title = if self.title.is_empty() { 0.0 } else { 1.9 * size };
        let left = Frame::left_room(&y_ticks, size).round();
        let right = (self.width as f32 - 1.8 * size).max(left + 1.0).round();
        let top = (title + 2.6 * size).round();
        let bottom = (self.height as f32 - 0.8 * size - Frame::bottom_room(size)).max(top + 1.0).round();
        let frame = Frame { left, top, right, bottom, x, y };
        let x_ticks = x.ticks((((right - left) / (5.0 * size)) as usize).clamp(2, 8));
        frame.grid(&mut picture, [&x_ticks, &Ticks::default()]);
        for (n, (_, parts)) in self.bars.iter().enumerate() {
            let (mut from, half) = (0.0, 0.5 * FILLED);
            for (part, length) in parts.iter().enumerate() {
                let to = from + length * factor;
                let [start, end] = [from, to].map(|at| at.clamp(x.low, x.high));
                let (a, b) = (frame.at(start, middle(n) + half), frame.at(end, middle(n) - half));
                picture.fill(a, b, palette(part));
                from = to;
            }
        }
        let across = axis_title(&self.x.label, &self.x.unit, x_ticks.power);
        frame.draw(&mut picture, [&x_ticks, &y_ticks], [&across, ""], size);
        if !self.title.is_empty() {
            let pen = Pen::new(1.25 * size, INK).bold().centred();
            picture.text(&self.title, [0.5 * (left + right), 2.2 * size], &pen);
        }
        self.legend(&mut picture, [left, title + 1.5 * size], size);
        Ok(picture)
    }

    fn check(&self) -> Result<(), OutputError> {
        if self.x.log {
            return Err(OutputError::value("axis of bars", "logarithmic", "linear: bars begin at zero"));
        }
        for (name, parts) in &self.bars {
            if parts.len() != self.parts.len() {
                let what = format!("parts of bar {name:?}");
                return Err(OutputError::Length { what, found: parts.len(), expected: self.parts.len() });
            }
            if let Some(length) = parts.iter().find(|l| !(l.is_finite() && **l >= 0.0)) {
                let what = format!("part of bar {name:?}");
                return Err(OutputError::value(what, length, "finite and not negative"));
            }
        }
        Ok(())
    }

    /// Draw the legend of the parts in a row from a start point (mid-height of the letters) to the right.
    fn legend(&self, picture: &mut Picture, [mut x, y]: [f32; 2], size: f32) {
        let pen = Pen::new(size, INK);
        for (part, name) in self.parts.iter().enumerate() {
            picture.fill([x, y - 0.4 * size], [x + 1.2 * size, y + 0.4 * size], palette(part));
            picture.text(name, [x + 1.6 * size, y + 0.36 * size], &pen);
            x += 2.9 * size + pen.width(name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Longest run of a colour in a row of the picture, pixels.
    fn longest(picture: &Picture, colour: [u8; 3]) -> usize {
        let run = |y: usize| {
            let (mut best, mut now) = (0, 0);
            for x in 0..picture.width() {
                now = if picture.pixel(x, y) == Some(colour) { now + 1 } else { 0 };
                best = best.max(now);
            }
            best
        };
        (0..picture.height()).map(run).max().unwrap_or(0)
    }

    #[test]
    fn parts_are_as_long_as_they_should_be() {
        let axis = Axis::new("share").unit("%", 100.0).range(0.0, 1.0);
        let bars = Bars::new(640, 240, ["a", "b", "c"])
            .x(axis)
            .bar("one", &[0.5, 0.3, 0.2])
            .bar("two", &[0.0, 0.1, 0.0]);
        let picture = bars.draw().expect("a picture");
        let [a, b, c] = [0, 1, 2].map(|part| longest(&picture, palette(part)) as f64);
        // Edges are accurate to one pixel.
        assert!(a > 200.0 && (b / a - 0.6).abs() < 2.0 / a && (c / a - 0.4).abs() < 2.0 / a, "{a} {b} {c}");
    }

    #[test]
    fn what_is_no_bar_is_refused() {
        let of = |lengths: &[f64]| Bars::new(300, 200, ["a", "b"]).bar("one", lengths);
        for (bars, said) in [
            (of(&[1.0]), "parts of bar"),
            (of(&[1.0, -1.0]), "not negative"),
            (of(&[f64::NAN, 1.0]), "not negative"),
            (of(&[1.0, 1.0]).x(Axis::new("x").logarithmic()), "linear"),
        ] {
            let error = bars.draw().expect_err(said).to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
