//! Field pictures: particles in the plane, true to scale, between axes.

use super::super::{OutputError, Snapshot, is_place};
use super::Sizes;
use super::axis::{FAINT, Frame, INK, PAPER, Scale, axis_title};
use super::camera::{Camera, Mirror};
use super::canvas::{Pen, Picture};
use super::colour::Rgb;
use super::faces;
use super::legend::Legend;
use super::quantity::{Quantity, colours_of};
use super::series_view::SeriesView;

/// Representation of a particle in the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mark {
    /// Voronoi cell: each point belongs to the nearest particle, and gaps up to 1.2 particle sizes
    /// wide between separated neighbours are closed; outlines are those of squares of the particle
    /// size. (Compare with [`Square`](Self::Square) before a conclusion about cracks.)
    #[default]
    Cell,
    /// Square of the particle size.
    Square,
    /// Disc with the particle size as diameter.
    Disc,
}

/// Picture of a two-dimensional snapshot with equal scales along both axes.
///
/// ```no_run
/// # fn main() -> Result<(), impactite_output::OutputError> {
/// # let axisymmetric: impactite_output::Snapshot = todo!();
/// use impactite_output::picture::{ColourMap, FieldPicture, Mirror, Quantity};
/// FieldPicture::new(900, 900)
///     .title("Axisymmetric bar")
///     .colour_by(Quantity::scalar("pressure").unit("GPa", 1.0e-9).map(ColourMap::CoolWarm))
///     .mirrored([Mirror::x(0.0)]) // both halves
///     .axes("r", "z")
///     .draw(&axisymmetric)?
///     .save("bar.png")
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct FieldPicture {
    width: usize,
    height: usize,
    title: String,
    caption: String,
    quantity: Option<Quantity>,
    mirrors: Vec<Mirror>,
    mark: Mark,
    scale: f64,
    axes: [String; 2],
    bounds: Option<[[f64; 2]; 2]>,
    letters: Option<f32>,
    lines: Vec<Lines>,
    sizes: Option<Sizes>,
}

/// Straight lines over a field.
#[derive(Debug, Clone)]
struct Lines {
    /// Both ends of each line, m.
    ends: Vec<[[f64; 2]; 2]>,
    /// Line width, pixels.
    width: f32,
    colour: Rgb,
}

/// Samples per pixel along each side (supersampling).
const FINE: usize = 3;
/// Distance assigned to samples inside an element: less than that of any particle.
const ELEMENT: f32 = -1.0;

impl FieldPicture {
    /// Create a picture of this size in pixels, framed to fit, coloured by body.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            title: String::new(),
            caption: String::new(),
            quantity: None,
            mirrors: Vec::new(),
            mark: Mark::Cell,
            scale: 1.0,
            axes: ["x".to_string(), "y".to_string()],
            bounds: None,
            letters: None,
            lines: Vec::new(),
            sizes: None,
        }
    }

    /// Set the title at the top.
    #[must_use]
    pub fn title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Set the caption at the bottom.
    #[must_use]
    pub fn caption(self, caption: impl Into<String>) -> Self {
        Self { caption: caption.into(), ..self }
    }

    /// Set the quantity shown in colour.
    #[must_use]
    pub fn colour_by(self, quantity: Quantity) -> Self {
        Self { quantity: Some(quantity), ..self }
    }

    /// Mirror the particles across symmetry lines (planes normal to x or y).
    #[must_use]
    pub fn mirrored(self, mirrors: impl IntoIterator<Item = Mirror>) -> Self {
        Self { mirrors: mirrors.into_iter().collect(), ..self }
    }

    /// Set the representation of particles.
    #[must_use]
    pub fn mark(self, mark: Mark) -> Self {
        Self { mark, ..self }
    }

    /// Scale the drawn particles (1e-6 to 1e6).
    #[must_use]
    pub fn particle_scale(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// Set the labels of the axes.
    #[must_use]
    pub fn axes(self, x: impl Into<String>, y: impl Into<String>) -> Self {
        Self { axes: [x.into(), y.into()], ..self }
    }

    /// Show the box between two corners (m), for series of pictures with a fixed view.
    #[must_use]
    pub fn bounds(self, low: [f64; 2], high: [f64; 2]) -> Self {
        Self { bounds: Some([low, high]), ..self }
    }

    /// Set the font size, 1 to 1000 pixels; the default depends on the size of the picture.
    #[must_use]
    pub fn letters(self, size: f32) -> Self {
        Self { letters: Some(size), ..self }
    }

    /// Draw straight lines over the field, each between two points (m), `width` pixels wide (0.1 to 100): outlines, cracks. They are
    /// mirrored across symmetry lines like particles; lines with an end that is not finite are omitted.
    #[must_use]
    pub fn lines(mut self, ends: impl IntoIterator<Item = [[f64; 2]; 2]>, width: f32, colour: Rgb) -> Self {
        self.lines.push(Lines { ends: ends.into_iter().collect(), width: width.clamp(0.1, 100.0), colour });
        self
    }

    /// Fit the size of the picture, pixels, to the scene: the maximum width, or less if the height would exceed its maximum.
    #[must_use]
    pub fn fitted(self, width: [usize; 2], height: [usize; 2]) -> Self {
        Self { sizes: Some(Sizes { width, height }), ..self }
    }

    /// Draw a snapshot with size, window and colour range of a series.
    ///
    /// # Errors
    /// Errors of [`draw`](Self::draw).
    pub fn draw_in(&self, film: &mut SeriesView, snapshot: &Snapshot) -> Result<Picture, OutputError> {
        self.drawn(snapshot, Some(film))
    }

    /// Draw a snapshot.
    ///
    /// # Errors
    /// A three-dimensional snapshot, a field that does not exist, a snapshot without particles at finite positions
    /// (unless bounds are set), invalid bounds, sizes or ranges, or more pixels than fit into
    /// [`MOST_BYTES`](impactite_simd::memory::MOST_BYTES).
    pub fn draw(&self, snapshot: &Snapshot) -> Result<Picture, OutputError> {
        self.drawn(snapshot, None)
    }

    fn drawn(&self, snapshot: &Snapshot, mut film: Option<&mut SeriesView>) -> Result<Picture, OutputError> {
        if snapshot.dimension() != 2 {
            let allowed = "2; a snapshot in space is drawn by ParticlePicture";
            return Err(OutputError::value("dimension", snapshot.dimension(), allowed));
        }
        Mirror::check(&self.mirrors)?;
        if let Some(mirror) = self.mirrors.iter().find(|m| m.axis > 1) {
            return Err(OutputError::value("axis of a mirror", mirror.axis, "0 or 1 in a flat picture"));
        }
        super::check_scale(self.scale)?;
        let quantity = match (&self.quantity, &mut film) {
            (Some(quantity), Some(film)) => Some(quantity.in_film(film, snapshot)?),
            (quantity, _) => quantity.clone(),
        };
        let coloured = colours_of(quantity.as_ref(), snapshot)?;
        let [low, high] = match &mut film {
            Some(film) if self.bounds.is_none() => self.window(film, snapshot)?,
            _ => self.shown(snapshot)?,
        };

        // Margins for titles, axes, the legend and the colour bar.
        let (usual_width, usual_height) =
            self.sizes.map_or((self.width, self.height), |s| (s.width[1], s.width[1] * 3 / 4));
        let size = super::letters(self.letters, 1.0, usual_width, usual_height)?;
        let (unit, factor) = super::length_unit((high[0] - low[0]).max(high[1] - low[1]));
        let scale = |d: usize| Scale::new(low[d] * factor, high[d] * factor, false);
        let (sx, sy) = (scale(0), scale(1));
        let spans = [sx.high - sx.low, sy.high - sy.low];
        let y_ticks = sy.ticks(7);
        let left = 0.9 * size + Frame::left_room(&y_ticks, size);
        let bar_room = coloured.bar.as_ref().map_or(0.0, |bar| bar.room(size) + 0.8 * size);
        let beside = left + 1.1 * size + bar_room;
        let head = if self.title.is_empty() { 0.0 } else { 2.2 * size };
        let foot =
            0.9 * size + Frame::bottom_room(size) + if self.caption.is_empty() { 0.0 } else { 1.7 * size };
        let legend = |width: usize| Legend::of(snapshot, &coloured, width as f32 - 2.2 * size, size);
        let (width, height) = match self.sizes {
            Some(sizes) => sizes.fit(
                spans[1] / spans[0],
                beside,
                1.1 * size + head + legend(sizes.width[1]).height() + foot,
            ),
            None => (self.width, self.height),
        };
        let (width, height) = film.map_or((width, height), |film| film.size((width, height)));
        let samples =
            FINE * FINE * (size_of::<f32>() + size_of::<u8>() + size_of::<u32>()) + size_of::<Rgb>();
        super::budget("a picture of so many pixels", "make the picture smaller")
            .holds(width as f64 * height as f64 * samples as f64)?;
        let mut picture = Picture::new(width, height, PAPER)?;
        let legend = legend(width);
        let (w, h) = (width as f32, height as f32);
        let (title_at, legend_at) = (2.2 * size, 1.1 * size + head);
        let top = legend_at + legend.height() + if legend.height() > 0.0 { 0.3 * size } else { 0.0 };
        let (caption_at, bottom, right) = (h - 1.0 * size, h - foot, w - 1.1 * size - bar_room);

        // Equal scales along both axes, centred in the available area.
        let (room_x, room_y) = ((right - left).max(8.0), (bottom - top).max(8.0));
        let per_unit = (f64::from(room_x) / spans[0]).min(f64::from(room_y) / spans[1]);
        let [across, down] = spans.map(|span| (span * per_unit).round() as f32);
        let x0 = (left + 0.5 * (room_x - across)).round();
        let y0 = (top + 0.5 * (room_y - down)).round();
        let frame = Frame { left: x0, top: y0, right: x0 + across, bottom: y0 + down, x: sx, y: sy };
        let x_ticks = sx.ticks(((across / (4.5 * size)) as usize).clamp(2, 8));
        let y_ticks = if down < 12.0 * size { sy.ticks(3) } else { y_ticks };

        self.fill(snapshot, &coloured.colours, &frame, factor, &mut picture);
        self.draw_lines(&frame, factor, &mut picture);
        let titles =
            [axis_title(&self.axes[0], unit, x_ticks.power), axis_title(&self.axes[1], unit, y_ticks.power)];
        frame.draw(&mut picture, [&x_ticks, &y_ticks], [&titles[0], &titles[1]], size);
        if let Some(bar) = &coloured.bar {
            let middle = 0.5 * (frame.top + frame.bottom);
            let half = (0.5 * down).max(5.0 * size).min(0.5 * (bottom - top));
            bar.draw(&mut picture, frame.right + 1.0 * size, middle - half, middle + half, size);
        }
        let middle = 0.5
            * (frame.left + frame.right + if bar_room > 0.0 { bar_room } else { 0.0 } - left + 1.1 * size);
        let middle = if bar_room > 0.0 { middle } else { 0.5 * (frame.left + frame.right) };
        for (text, y, pen) in [
            (&self.title, title_at, Pen::new(1.3 * size, INK).bold()),
            (&self.caption, caption_at, Pen::new(size, FAINT)),
        ] {
            let pen = pen.fitted(text, w - 0.8 * size).centred();
            let half = 0.5 * pen.width(text) + 0.4 * size;
            picture.text(text, [middle.max(half).min(w - half), y], &pen);
        }
        legend.draw(&mut picture, middle, legend_at);
        Ok(picture)
    }

    fn draw_lines(&self, frame: &Frame, factor: f64, picture: &mut Picture) {
        let clip = Some(([frame.left, frame.top], [frame.right, frame.bottom]));
        let (mut from, mut to) = (Vec::new(), Vec::new());
        for Lines { ends, width, colour } in &self.lines {
            for [a, b] in ends {
                let [a, b] = [a, b].map(|x| [x[0], x[1], 0.0]);
                if !is_place(&a) || !is_place(&b) {
                    continue;
                }
                Mirror::copies(&self.mirrors, a, &mut from);
                Mirror::copies(&self.mirrors, b, &mut to);
                for (a, b) in from.iter().zip(&to) {
                    let line = [a, b].map(|x| frame.at(x[0] * factor, x[1] * factor));
                    picture.polyline(&line, *width, *colour, None, clip);
                }
            }
        }
    }

    /// Bounds of the picture, m.
    fn shown(&self, snapshot: &Snapshot) -> Result<[[f64; 2]; 2], OutputError> {
        if let Some([low, high]) = self.bounds {
            let good = is_place(&[low[0], low[1], 0.0])
                && is_place(&[high[0], high[1], 0.0])
                && (0..2).all(|d| high[d] - low[d] >= 1e-30);
            return if good {
                Ok([low, high])
            } else {
                let given = format!("{low:?} to {high:?}");
                Err(OutputError::value(
                    "bounds of the picture",
                    given,
                    "corners at most 1e30 m from the origin, low < high by 1e-30 m",
                ))
            };
        }
        let Some((low, high)) = snapshot.bounds() else {
            let allowed = "at least 1, at a finite place (or give bounds)";
            return Err(OutputError::value("number of particles to frame", 0, allowed));
        };
        let mut corners = Vec::new();
        let (mut lo, mut hi) = ([low[0], low[1]], [high[0], high[1]]);
        for corner in [low, high] {
            Mirror::copies(&self.mirrors, corner, &mut corners);
            for copy in &corners {
                for d in 0..2 {
                    lo[d] = lo[d].min(copy[d]);
                    hi[d] = hi[d].max(copy[d]);
                }
            }
        }
        let pad = 0.03 * (hi[0] - lo[0]).max(hi[1] - lo[1]);
        Ok([lo.map(|x| x - pad), hi.map(|x| x + pad)])
    }

    /// Window of a series that contains the snapshot, m.
    fn window(&self, film: &mut SeriesView, snapshot: &Snapshot) -> Result<[[f64; 2]; 2], OutputError> {
        // Camera normal to the plane, with the coordinate axes as its directions.
        let (toward, up) = ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
        let of_box = |given: [[f64; 3]; 2]| Camera::extent_of_box(given, &self.mirrors, toward, up);
        let [low, high] = match (film.set_window(), film.foreseen()) {
            (Some(set), _) => set,
            (None, foreseen) => {
                let [mut low, mut high] = Camera::extent(snapshot, &self.mirrors, toward, up)?;
                if let Some(foreseen) = foreseen {
                    let [from, to] = of_box(foreseen)?;
                    for d in 0..2 {
                        (low[d], high[d]) = (low[d].min(from[d]), high[d].max(to[d]));
                    }
                }
                film.cover(low, high)
            }
        };
        Ok([[low[0], low[1]], [high[0], high[1]]])
    }

    /// Rasterize particles and elements at three times the resolution, then average.
    fn fill(&self, snapshot: &Snapshot, colours: &[Rgb], frame: &Frame, factor: f64, picture: &mut Picture) {
        let columns = (frame.right - frame.left).max(0.0) as usize * FINE;
        let rows = (frame.bottom - frame.top).max(0.0) as usize * FINE;
        let mut nearest = vec![f32::INFINITY; columns * rows];
        let mut colour = vec![packed(PAPER); columns * rows];
        let per_metre = factor * columns as f64 / (frame.x.high - frame.x.low);
        let mut copies = Vec::new();
        let mut bars = Vec::new();
        // Extension of cells before the outside is eroded again, samples: by the mean size over the area, where sizes differ.
        let [mut areas, mut sizes] = [0.0; 2];
        for size in (0..snapshot.len()).map(|i| snapshot.size_of(i)) {
            areas += size * size;
            sizes += size * size * size;
        }
        let sizes = if areas > 0.0 { sizes / areas } else { 0.0 };
        let margin = (0.6 * sizes * self.scale * per_metre).round().clamp(0.0, 60.0) as usize;
        for (i, x) in snapshot.positions().iter().enumerate() {
            if !is_place(x) {
                continue;
            }
            let half = (0.5 * snapshot.size_of(i) * self.scale * per_metre).max(0.5) as f32;
            // Extended cells overlap their neighbours; the nearest particle wins.
            let reach = if self.mark == Mark::Cell { half + margin as f32 } else { half };
            if let Some(corners) = element(snapshot, i) {
                let mut outlines: Vec<Vec<[f32; 2]>> = Vec::new();
                for corner in &corners {
                    Mirror::copies(&self.mirrors, *corner, &mut copies);
                    outlines.resize(copies.len(), Vec::new());
                    for (outline, x) in outlines.iter_mut().zip(&copies) {
                        outline.push([
                            ((x[0] * factor - frame.x.low) / factor * per_metre) as f32,
                            ((frame.y.high - x[1] * factor) / factor * per_metre) as f32,
                        ]);
                    }
                }
                for outline in &outlines {
                    let edge = edge_strength(outline);
                    within(outline, columns, rows, &mut |at| {
                        nearest[at] = ELEMENT;
                        colour[at] = packed(colours[i]);
                        if edge > 0.0 {
                            let place = [(at % columns) as f32 + 0.5, (at / columns) as f32 + 0.5];
                            let covered = (EDGE + 0.5 - distance_to(outline, place, true)).clamp(0.0, 1.0);
                            let light = 1.0 - edge * covered;
                            colour[at] = packed(colours[i].map(|c| (f32::from(c) * light) as u8));
                        }
                    });
                }
                continue;
            }
            if let Some(ends) = faces::line(snapshot, i) {
                bars.push((ends, i));
                continue;
            }
            Mirror::copies(&self.mirrors, *x, &mut copies);
            for x in &copies {
                let cx = ((x[0] * factor - frame.x.low) / factor * per_metre) as f32;
                let cy = ((frame.y.high - x[1] * factor) / factor * per_metre) as f32;
                let range = |c: f32, n: usize| {
                    let low = (c - reach + 0.5).floor().max(0.0) as usize;
                    low.min(n)..((c + reach + 0.5).floor().max(0.0) as usize).min(n)
                };
                let farthest = if self.mark == Mark::Disc { half * half } else { f32::INFINITY };
                let (across, own) = (range(cx, columns), packed(colours[i]));
                for y in range(cy, rows) {
                    let dy = y as f32 + 0.5 - cy;
                    let row = y * columns + across.start..y * columns + across.end;
                    // Branch-free, for vectorization over samples.
                    let samples = nearest[row.clone()].iter_mut().zip(&mut colour[row]);
                    for (n, (nearest, colour)) in (across.start as i32..).zip(samples) {
                        let dx = n as f32 + 0.5 - cx;
                        let distance = dx * dx + dy * dy;
                        let wins = (distance < *nearest) & (distance <= farthest);
                        *nearest = if wins { distance } else { *nearest };
                        *colour = if wins { own } else { *colour };
                    }
                }
            }
        }
        if self.mark == Mark::Cell {
            let mut kept: Vec<u8> = nearest.iter().map(|d| u8::from(d.is_finite())).collect();
            shrink(&mut kept, columns, rows, margin);
            for ((colour, kept), nearest) in colour.iter_mut().zip(kept).zip(&nearest) {
                if kept == 0 && *nearest != ELEMENT {
                    *colour = packed(PAPER);
                }
            }
        }
        // Lines are drawn last, with a dark border for contrast.
        for (ends, i) in bars {
            let size = snapshot.size_of(i);
            let along = (0..2).map(|d| (ends[1][d] - ends[0][d]).powi(2)).sum::<f64>().sqrt();
            let section = if along > 0.0 { (size * size / along).min(size) } else { size };
            let half = (0.5 * section * self.scale * per_metre).clamp(1.3 * FINE as f64, 1e4) as f32;
            let [mut from, mut to] = [Vec::new(), Vec::new()];
            Mirror::copies(&self.mirrors, ends[0], &mut from);
            Mirror::copies(&self.mirrors, ends[1], &mut to);
            for ends in from.into_iter().zip(to) {
                let line = [ends.0, ends.1].map(|x| {
                    [
                        ((x[0] * factor - frame.x.low) / factor * per_metre) as f32,
                        ((frame.y.high - x[1] * factor) / factor * per_metre) as f32,
                    ]
                });
                let range = |d: usize, count: usize| {
                    let (low, high) = (line[0][d].min(line[1][d]) - half, line[0][d].max(line[1][d]) + half);
                    low.floor().max(0.0) as usize..(high.ceil().max(0.0) as usize).min(count)
                };
                for y in range(1, rows) {
                    for x in range(0, columns) {
                        let distance = distance_to(&line, [x as f32 + 0.5, y as f32 + 0.5], false);
                        if distance <= half {
                            let light = if distance > half - EDGE { 0.4 } else { 1.0 };
                            colour[y * columns + x] =
                                packed(colours[i].map(|c| (f32::from(c) * light) as u8));
                        }
                    }
                }
            }
        }
        let (left, top) = (frame.left as usize, frame.top as usize);
        let width = picture.width();
        let pixels = picture.pixels_mut();
        for py in 0..rows / FINE {
            for px in 0..columns / FINE {
                let mut sum = [0_u32; 3];
                for y in py * FINE..(py + 1) * FINE {
                    for sample in &colour[y * columns + px * FINE..][..FINE] {
                        for c in 0..3 {
                            sum[c] += sample >> (8 * c) & 0xff;
                        }
                    }
                }
                let all = (FINE * FINE) as u32;
                if let Some(pixel) = pixels.get_mut((top + py) * width + left + px) {
                    *pixel = sum.map(|s| ((s + all / 2) / all) as u8);
                }
            }
        }
    }
}

/// Pack a colour into one number.
fn packed([r, g, b]: Rgb) -> u32 {
    u32::from_le_bytes([r, g, b, 0])
}

/// Half width of the edges of elements, samples.
const EDGE: f32 = 1.0;

/// Opacity of the edges of an element: 0 if edges would cover small elements.
fn edge_strength(outline: &[[f32; 2]]) -> f32 {
    let next = outline.iter().cycle().skip(1);
    let sides = outline.iter().zip(next).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
    let shortest = sides.fold(f32::INFINITY, f32::min) / FINE as f32;
    0.45 * ((shortest - 4.0) / 6.0).clamp(0.0, 1.0)
}

/// Distance of a point from a polyline, closed or open.
fn distance_to(points: &[[f32; 2]], place: [f32; 2], closed: bool) -> f32 {
    let count = if closed { points.len() } else { points.len().saturating_sub(1) };
    let mut nearest = f32::INFINITY;
    for n in 0..count {
        let (a, b) = (points[n], points[(n + 1) % points.len()]);
        let (dx, dy, x, y) = (b[0] - a[0], b[1] - a[1], place[0] - a[0], place[1] - a[1]);
        let along = ((x * dx + y * dy) / (dx * dx + dy * dy).max(1e-12)).clamp(0.0, 1.0);
        nearest = nearest.min((x - along * dx).hypot(y - along * dy));
    }
    nearest
}

/// Corners of the plane element of a particle, m.
fn element(snapshot: &Snapshot, i: usize) -> Option<Vec<[f64; 3]>> {
    let cells = snapshot.cells().filter(|cells| snapshot.dimension() == 2 && cells.of(i).len() > 2)?;
    let corners: Vec<[f64; 3]> = cells.of(i).iter().map(|&n| cells.nodes[n as usize]).collect();
    corners.iter().all(is_place).then_some(corners)
}

/// Visit the samples whose centre is inside a polygon, by counting crossings of a ray to the right with its edges.
fn within(polygon: &[[f32; 2]], columns: usize, rows: usize, visit: &mut dyn FnMut(usize)) {
    let range = |d: usize, count: usize| {
        let (low, high) =
            polygon.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), x| (l.min(x[d]), h.max(x[d])));
        low.floor().max(0.0) as usize..(high.ceil().max(0.0) as usize).min(count)
    };
    for y in range(1, rows) {
        for x in range(0, columns) {
            let at = [x as f32 + 0.5, y as f32 + 0.5];
            let crosses = |n: &usize| {
                let (a, b) = (polygon[*n], polygon[(n + 1) % polygon.len()]);
                (a[1] > at[1]) != (b[1] > at[1])
                    && at[0] < a[0] + (at[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
            };
            if (0..polygon.len()).filter(crosses).count() % 2 == 1 {
                visit(y * columns + x);
            }
        }
    }
}

/// Erode: set to zero all samples within `margin` samples (along rows or columns, 254 at most) of a zero. Samples beyond the edges of the
/// picture do not count as zeros.
fn shrink(kept: &mut [u8], columns: usize, rows: usize, margin: usize) {
    if columns == 0 || rows == 0 {
        return;
    }
    let margin = margin.min(254);
    let next = |row: &[u8], from: usize, what: u8| {
        row[from..].iter().position(|kept| *kept == what).map_or(row.len(), |n| from + n)
    };
    for row in kept.chunks_exact_mut(columns) {
        // Alternate between runs of outside and inside samples.
        let mut from = next(row, 0, 0);
        if from < columns {
            row[from.saturating_sub(margin)..from].fill(0);
        }
        while from < columns {
            let to = next(row, from, 1);
            from = next(row, to, 0);
            row[to..(to + margin).min(from)].fill(0);
            if from < columns {
                row[from.saturating_sub(margin).max(to)..from].fill(0);
            }
        }
    }
    // Distance from the outside above and below in samples, for all columns of a row at once.
    let far = margin as u8 + 1;
    let mut since = vec![far; columns];
    for row in kept.chunks_exact_mut(columns).take(rows) {
        for (kept, since) in row.iter_mut().zip(&mut since) {
            *since = if *kept == 0 { 0 } else { since.saturating_add(1).min(far) };
            *kept = *since;
        }
    }
    since.fill(far);
    for row in kept.chunks_exact_mut(columns).take(rows).rev() {
        for (kept, since) in row.iter_mut().zip(&mut since) {
            *since = if *kept == 0 { 0 } else { since.saturating_add(1).min(far) };
            *kept = u8::from(*kept == far && *since == far);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_near_the_outside_is_taken_away() {
        let mut seed = 5_u64;
        for (columns, rows, margin) in [(1, 1, 0), (7, 5, 1), (40, 23, 3), (31, 17, 60), (12, 300, 60)] {
            let mut next = || {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (seed >> 33) % 60
            };
            let all: Vec<u8> = (0..columns * rows).map(|_| u8::from(next() > 0)).collect();
            let mut kept = all.clone();
            shrink(&mut kept, columns, rows, margin);
            let near =
                |place: usize, count: usize| place.saturating_sub(margin)..(place + margin + 1).min(count);
            for y in 0..rows {
                for x in 0..columns {
                    let inside = near(y, rows).all(|y| near(x, columns).all(|x| all[y * columns + x] == 1));
                    assert_eq!(
                        kept[y * columns + x],
                        u8::from(inside),
                        "{x} {y} of {columns} x {rows}, {margin}"
                    );
                }
            }
        }
    }
}
