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
use super::samples::{FINE, Part, Point, Samples, packed, range_of};
use super::series_view::{Buffers, SeriesView};

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
        let (width, height) = film.as_mut().map_or((width, height), |film| film.size((width, height)));
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

        let mut own = Buffers::default();
        let buffers = film.map_or(&mut own, SeriesView::buffers);
        self.fill(snapshot, &coloured.colours, (&frame, factor), &mut buffers.field, &mut picture);
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
    fn fill(
        &self,
        snapshot: &Snapshot,
        colours: &[Rgb],
        (frame, factor): (&Frame, f64),
        samples: &mut Samples,
        picture: &mut Picture,
    ) {
        let columns = (frame.right - frame.left).max(0.0) as usize * FINE;
        let rows = (frame.bottom - frame.top).max(0.0) as usize * FINE;
        let per_metre = factor * columns as f64 / (frame.x.high - frame.x.low);
        let onto = |x: &[f64; 3]| {
            [
                ((x[0] * factor - frame.x.low) / factor * per_metre) as f32,
                ((frame.y.high - x[1] * factor) / factor * per_metre) as f32,
            ]
        };
        let margin = if self.mark == Mark::Cell { self.margin(snapshot, per_metre) } else { 0 };
        let mut points = std::mem::take(&mut samples.points);
        points.clear();
        let [mut copies, mut others] = [Vec::new(), Vec::new()];
        let (mut elements, mut bars) = (Vec::new(), Vec::new());
        for (i, x) in snapshot.positions().iter().enumerate() {
            if !is_place(x) {
                continue;
            }
            if let Some(corners) = element(snapshot, i) {
                let mut outlines: Vec<Vec<[f32; 2]>> = Vec::new();
                for corner in &corners {
                    Mirror::copies(&self.mirrors, *corner, &mut copies);
                    outlines.resize(copies.len(), Vec::new());
                    for (outline, x) in outlines.iter_mut().zip(&copies) {
                        outline.push(onto(x));
                    }
                }
                elements.extend(outlines.into_iter().map(|outline| (outline, colours[i])));
                continue;
            }
            let size = snapshot.size_of(i);
            if let Some(ends) = faces::line(snapshot, i) {
                let along = (0..2).map(|d| (ends[1][d] - ends[0][d]).powi(2)).sum::<f64>().sqrt();
                let section = if along > 0.0 { (size * size / along).min(size) } else { size };
                let half = (0.5 * section * self.scale * per_metre).clamp(1.3 * FINE as f64, 1e4) as f32;
                Mirror::copies(&self.mirrors, ends[0], &mut copies);
                Mirror::copies(&self.mirrors, ends[1], &mut others);
                let lines = copies.iter().zip(&others);
                bars.extend(lines.map(|(from, to)| ([onto(from), onto(to)], half, colours[i])));
                continue;
            }
            let half = (0.5 * size * self.scale * per_metre).max(0.5) as f32;
            // Extended cells overlap their neighbours; the nearest particle wins.
            let reach = if self.mark == Mark::Cell { half + margin as f32 } else { half };
            let farthest = if self.mark == Mark::Disc { half * half } else { f32::INFINITY };
            Mirror::copies(&self.mirrors, *x, &mut copies);
            let colour = packed(colours[i]);
            points.extend(copies.iter().map(|x| Point { centre: onto(x), reach, farthest, colour }));
        }

        let all = [columns, rows];
        let mut part = Part::NONE;
        points.iter().for_each(|point| part.cover(&point.range(all)));
        elements.iter().for_each(|(outline, _)| part.cover(&range_of(outline, 0.0, all)));
        bars.iter().for_each(|(line, half, _)| part.cover(&range_of(line, *half, all)));
        // One sample of background on each side, for the erosion, and whole pixels.
        samples.clear(part.widened(all));
        points.iter().for_each(|point| samples.add_point(point, all));
        samples.points = points;
        elements.iter().for_each(|(outline, colour)| samples.add_element(outline, *colour, all));
        if self.mark == Mark::Cell {
            samples.erode(margin);
        }
        // Lines are drawn last, with a dark border for contrast.
        bars.iter().for_each(|(line, half, colour)| samples.add_bar(line, *half, *colour, all));
        samples.average([frame.left as usize, frame.top as usize], picture);
    }

    /// Extension of cells before the outside is eroded again, samples: by the mean size over the area, where sizes differ.
    fn margin(&self, snapshot: &Snapshot, per_metre: f64) -> usize {
        let [mut areas, mut sizes] = [0.0; 2];
        for size in (0..snapshot.len()).map(|i| snapshot.size_of(i)) {
            areas += size * size;
            sizes += size * size * size;
        }
        let size = if areas > 0.0 { sizes / areas } else { 0.0 };
        (0.6 * size * self.scale * per_metre).round().clamp(0.0, 60.0) as usize
    }
}

/// Corners of the plane element of a particle, m.
fn element(snapshot: &Snapshot, i: usize) -> Option<Vec<[f64; 3]>> {
    let cells = snapshot.cells().filter(|cells| snapshot.dimension() == 2 && cells.of(i).len() > 2)?;
    let corners: Vec<[f64; 3]> = cells.of(i).iter().map(|&n| cells.nodes[n as usize]).collect();
    corners.iter().all(is_place).then_some(corners)
}
