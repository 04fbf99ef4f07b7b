//! Line charts: curves between linear or logarithmic axes.

use super::super::OutputError;
use super::axis::{FAINT, Frame, INK, PAPER, Scale, axis_title};
use super::canvas::{Pen, Picture};
use super::colour::{Rgb, palette};

/// Axis: label, unit, scale and range.
///
/// ```
/// use impactite_output::picture::Axis;
/// let time = Axis::new("time").unit("µs", 1.0e6); // the curves are given in seconds
/// let error = Axis::new("relative error").logarithmic();
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    pub(super) label: String,
    pub(super) unit: String,
    pub(super) factor: f64,
    pub(super) log: bool,
    range: Option<(f64, f64)>,
}

impl Axis {
    /// Create a linear axis called `label`, without a unit.
    #[must_use]
    pub fn new(label: impl Into<String>) -> Self {
        Self { label: label.into(), unit: String::new(), factor: 1.0, log: false, range: None }
    }

    /// Set the displayed unit and its number per unit of the data: `("µs", 1e6)`.
    #[must_use]
    pub fn unit(self, unit: impl Into<String>, factor: f64) -> Self {
        Self { unit: unit.into(), factor, ..self }
    }

    /// Use a logarithmic scale; points that are not positive are omitted.
    #[must_use]
    pub fn logarithmic(self) -> Self {
        Self { log: true, ..self }
    }

    /// Set the range from `low` to `high` (in the unit of the data).
    #[must_use]
    pub fn range(self, low: f64, high: f64) -> Self {
        Self { range: Some((low, high)), ..self }
    }

    pub(super) fn shown(&self, values: impl Iterator<Item = f64>) -> Result<Scale, OutputError> {
        if !self.factor.is_finite() || self.factor == 0.0 {
            let what = format!("unit factor of axis {:?}", self.label);
            return Err(OutputError::value(what, self.factor, "finite and not 0"));
        }
        if let Some((low, high)) = self.range {
            if !(low.is_finite() && high.is_finite() && low < high && (!self.log || low > 0.0)) {
                let allowed = "low < high, both finite, and low > 0 if logarithmic";
                let what = format!("range of axis {:?}", self.label);
                return Err(OutputError::value(what, format!("{low} to {high}"), allowed));
            }
            return Ok(Scale::new(low * self.factor, high * self.factor, self.log));
        }
        let usable = values.filter(|v| v.is_finite() && (!self.log || *v > 0.0));
        let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        Ok(Scale::new(low, high, self.log))
    }
}

/// Line style of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// Solid line.
    Solid,
    /// Dashed line.
    Dashed,
    /// Dotted line.
    Dotted,
    /// No line: markers only.
    None,
}

/// Marker of the points of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// Disc.
    Circle,
    /// Square.
    Square,
    /// Triangle on its base.
    Triangle,
    /// Diamond: a square on its corner.
    Diamond,
}

/// Curve: points, name in the legend, and style.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    name: String,
    points: Vec<[f64; 2]>,
    stroke: Stroke,
    marker: Option<Marker>,
    colour: Option<Rgb>,
    width: f32,
}

impl Series {
    /// Create a curve through `(x, y)` points in order; the name "" omits it from the legend. Points that are not finite interrupt
    /// the line.
    ///
    /// # Errors
    /// Lists of different lengths.
    pub fn new(name: impl Into<String>, x: &[f64], y: &[f64]) -> Result<Self, OutputError> {
        let name = name.into();
        if x.len() != y.len() {
            let what = format!("y of curve {name:?}");
            return Err(OutputError::Length { what, found: y.len(), expected: x.len() });
        }
        let points = x.iter().zip(y).map(|(x, y)| [*x, *y]).collect();
        Ok(Self { name, points, stroke: Stroke::Solid, marker: None, colour: None, width: 1.0 })
    }

    /// Create the line y = `at.1` (x / `at.0`)^`order` over a range of x: a convergence slope on logarithmic axes, thin,
    /// grey and dashed.
    #[must_use]
    pub fn slope(name: impl Into<String>, order: f64, at: (f64, f64), x: (f64, f64)) -> Self {
        let point = |x: f64| [x, at.1 * (x / at.0).powf(order)];
        Self {
            name: name.into(),
            points: vec![point(x.0), point(x.1)],
            stroke: Stroke::Dashed,
            marker: None,
            colour: Some(FAINT),
            width: 0.7,
        }
    }

    /// Set the line style.
    #[must_use]
    pub fn stroke(self, stroke: Stroke) -> Self {
        Self { stroke, ..self }
    }

    /// Set the marker of the points.
    #[must_use]
    pub fn marker(self, marker: Marker) -> Self {
        Self { marker: Some(marker), ..self }
    }

    /// Set the colour; the default is the next of the palette.
    #[must_use]
    pub fn colour(self, colour: Rgb) -> Self {
        Self { colour: Some(colour), ..self }
    }

    /// Set the line width relative to the default.
    #[must_use]
    pub fn width(self, width: f32) -> Self {
        Self { width: if width.is_finite() { width.clamp(0.1, 20.0) } else { 1.0 }, ..self }
    }
}

/// Line chart of curves over common axes, with a legend at the emptiest position.
///
/// ```
/// use impactite_output::picture::{Axis, Chart, Marker, Series};
/// let (h, error) = ([0.1, 0.05, 0.025], [1.0e-2, 2.6e-3, 6.4e-4]);
/// let picture = Chart::new(800, 600)
///     .title("Convergence")
///     .x(Axis::new("cell size").unit("mm", 1.0e3).logarithmic())
///     .y(Axis::new("relative error").logarithmic())
///     .series(Series::new("GIMP", &h, &error)?.marker(Marker::Circle))
///     .series(Series::slope("second order", 2.0, (0.1, 1.0e-2), (0.025, 0.1)))
///     .draw()?;
/// # Ok::<(), impactite_output::OutputError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Chart {
    width: usize,
    height: usize,
    title: String,
    x: Axis,
    y: Axis,
    series: Vec<Series>,
    letters: Option<f32>,
}

impl Chart {
    /// Create an empty chart of this size in pixels.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        let (x, y) = (Axis::new("x"), Axis::new("y"));
        Self { width, height, title: String::new(), x, y, series: Vec::new(), letters: None }
    }

    /// Set the title at the top.
    #[must_use]
    pub fn title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Set the axis along the bottom.
    #[must_use]
    pub fn x(self, axis: Axis) -> Self {
        Self { x: axis, ..self }
    }

    /// Set the axis along the left.
    #[must_use]
    pub fn y(self, axis: Axis) -> Self {
        Self { y: axis, ..self }
    }

    /// Add a curve.
    #[must_use]
    pub fn series(mut self, series: Series) -> Self {
        self.series.push(series);
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
    /// Invalid sizes, factors or ranges.
    pub fn draw(&self) -> Result<Picture, OutputError> {
        let mut picture = Picture::new(self.width, self.height, PAPER)?;
        let size = super::letters(self.letters, 1.15, self.width, self.height)?;
        let (w, h) = (self.width as f32, self.height as f32);
        let all = || self.series.iter().flat_map(|s| &s.points);
        let scale = |axis: &Axis, d: usize, pad: f64| {
            let values = all().map(move |p| p[d] * axis.factor);
            axis.shown(values).map(|scale| if axis.range.is_some() { scale } else { scale.padded(pad) })
        };
        let (x, y) = (scale(&self.x, 0, 0.03)?, scale(&self.y, 1, 0.06)?);
        let mut top = 1.2 * size;
        if !self.title.is_empty() {
            top += 1.9 * size;
        }
        let y_ticks = y.ticks(6);
        let left = (0.9 * size + Frame::left_room(&y_ticks, size)).round();
        let right = (w - 1.5 * size).max(left + 1.0).round();
        let bottom = (h - 0.8 * size - Frame::bottom_room(size)).max(top + 1.0).round();
        let frame = Frame { left, top: top.round(), right, bottom, x, y };
        let x_ticks = x.ticks((((right - left) / (5.0 * size)) as usize).clamp(2, 8));
        frame.grid(&mut picture, [&x_ticks, &y_ticks]);

        let mut next = 0;
        let colours: Vec<Rgb> = self
            .series
            .iter()
            .map(|series| {
                series.colour.unwrap_or_else(|| {
                    next += 1;
                    palette(next - 1)
                })
            })
            .collect();
        let line = (size / 8.0).max(1.4);
        let clip = Some(([frame.left, frame.top], [frame.right, frame.bottom]));
        let mut drawn: Vec<[f32; 2]> = Vec::new();
        for (series, colour) in self.series.iter().zip(&colours) {
            let place = |p: &[f64; 2]| {
                let (px, py) = (p[0] * self.x.factor, p[1] * self.y.factor);
                let at = frame.at(px, py);
                let far = 1.0e5;
                (at[0].is_finite() && at[1].is_finite()).then(|| at.map(|c| c.clamp(-far, far)))
            };
            let dash = match series.stroke {
                Stroke::Dashed => Some((0.55 * size, 0.38 * size)),
                Stroke::Dotted => Some((0.02 * size, 0.32 * size)),
                Stroke::Solid | Stroke::None => None,
            };
            let places: Vec<Option<[f32; 2]>> = series.points.iter().map(place).collect();
            if series.stroke != Stroke::None {
                for run in places.split(Option::is_none) {
                    let run: Vec<[f32; 2]> = run.iter().copied().flatten().collect();
                    picture.polyline(&run, line * series.width, *colour, dash, clip);
                }
            }
            for pair in places.windows(2) {
                if let [Some(a), Some(b)] = pair {
                    drawn.extend((0..=16).map(|i| {
                        let t = i as f32 / 16.0;
                        [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
                    }));
                }
            }
            let inside = |p: &&[f32; 2]| {
                p[0] >= left - 1.0 && p[0] <= right + 1.0 && p[1] >= frame.top - 1.0 && p[1] <= bottom + 1.0
            };
            let points: Vec<[f32; 2]> = places.iter().flatten().filter(inside).copied().collect();
            if let Some(marker) = series.marker {
                for p in &points {
                    mark(&mut picture, marker, *p, 0.34 * size, *colour);
                }
            }
            drawn.extend(points);
        }
        let titles = [
            axis_title(&self.x.label, &self.x.unit, x_ticks.power),
            axis_title(&self.y.label, &self.y.unit, y_ticks.power),
        ];
        frame.draw(&mut picture, [&x_ticks, &y_ticks], [&titles[0], &titles[1]], size);
        if !self.title.is_empty() {
            let pen = Pen::new(1.25 * size, INK).bold().centred();
            picture.text(&self.title, [0.5 * (left + right), 0.5 * size + 1.7 * size], &pen);
        }
        self.legend(&mut picture, &frame, &colours, &drawn, size, line);
        Ok(picture)
    }

    /// Draw the legend in the corner (or middle of a side) with the fewest points.
    fn legend(
        &self,
        picture: &mut Picture,
        frame: &Frame,
        colours: &[Rgb],
        drawn: &[[f32; 2]],
        size: f32,
        line: f32,
    ) {
        let named: Vec<(&Series, Rgb)> = self
            .series
            .iter()
            .zip(colours.iter().copied())
            .filter(|(series, _)| !series.name.is_empty())
            .collect();
        if named.is_empty() {
            return;
        }
        let pen = Pen::new(size, INK);
        let sample = 2.4 * size;
        let widest = named.iter().map(|(s, _)| pen.width(&s.name)).fold(0.0, f32::max);
        let (width, height) = (widest + sample + 1.9 * size, (1.45 * named.len() as f32 + 0.7) * size);
        let gap = 0.7 * size;
        let xs = [frame.right - gap - width, frame.left + gap, 0.5 * (frame.left + frame.right - width)];
        let ys = [frame.top + gap, frame.bottom - gap - height, 0.5 * (frame.top + frame.bottom - height)];
        let mut best = (usize::MAX, [xs[0], ys[0]]);
        for y in ys {
            for x in xs {
                let hidden = drawn
                    .iter()
                    .filter(|p| {
                        p[0] > x - gap && p[0] < x + width + gap && p[1] > y - gap && p[1] < y + height + gap
                    })
                    .count();
                if hidden < best.0 {
                    best = (hidden, [x, y]);
                }
            }
        }
        let [x, y] = best.1.map(f32::round);
        picture.fill([x, y], [x + width, y + height], PAPER);
        picture.frame([x, y], [x + width, y + height], 1.0, super::colour::hex(0xc9ced6));
        for (i, (series, colour)) in named.iter().enumerate() {
            let row = y + (1.45 * i as f32 + 1.08) * size;
            let (a, b) = ([x + 0.6 * size, row], [x + 0.6 * size + sample, row]);
            let dash = match series.stroke {
                Stroke::Dashed => Some((0.55 * size, 0.38 * size)),
                Stroke::Dotted => Some((0.02 * size, 0.32 * size)),
                Stroke::Solid | Stroke::None => None,
            };
            if series.stroke != Stroke::None {
                picture.polyline(&[a, b], line * series.width, *colour, dash, None);
            }
            if let Some(marker) = series.marker {
                mark(picture, marker, [0.5 * (a[0] + b[0]), row], 0.34 * size, *colour);
            }
            picture.text(&series.name, [b[0] + 0.6 * size, row + 0.36 * size], &pen);
        }
    }
}

/// Draw a marker with a white rim for contrast with lines.
fn mark(picture: &mut Picture, marker: Marker, [x, y]: [f32; 2], r: f32, colour: Rgb) {
    for (r, colour) in [(r * 1.3, PAPER), (r, colour)] {
        match marker {
            Marker::Circle => picture.disc([x, y], r, colour),
            Marker::Square => {
                let s = 0.88 * r;
                picture.fill([x - s, y - s], [x + s, y + s], colour);
            }
            Marker::Triangle => {
                let (a, b) = (1.12 * r, 0.97 * r);
                picture.polygon(&[[x, y - a], [x + b, y + 0.56 * r], [x - b, y + 0.56 * r]], colour);
            }
            Marker::Diamond => {
                let s = 1.2 * r;
                picture.polygon(&[[x, y - s], [x + s, y], [x, y + s], [x - s, y]], colour);
            }
        }
    }
}
