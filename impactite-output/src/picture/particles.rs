//! Shaded rendering of particles and elements in space.
//!
//! Elements are drawn by their outer faces, with thin edges if these are large enough. Each particle is a small ball. A z-buffer at twice
//! the resolution resolves visibility per pixel; shading uses a mixture of the normal of the ball and that of the surface of the body, the
//! gradient of the smoothed particle density. The same density, smoothed wider, gives the ambient occlusion of corners. Particles
//! surrounded by matter are not drawn. Gaps between balls of a surface that are narrower than a ball are closed.

use super::super::{OutputError, Snapshot, is_place};
use super::Sizes;
use super::axis::{FAINT, INK, PAPER};
use super::camera::{Camera, Cut, Mirror, dot, sub};
use super::canvas::{Pen, Picture};
use super::colour::Rgb;
use super::faces::{Face, has_faces, line, outer};
use super::legend::Legend;
use super::matter::Ball;
use super::quantity::{Quantity, colours_of};
use super::raster::{FINE, Flat, Seen, Shapes, Viewport};
use super::series_view::{Buffers, SeriesView};

/// Picture of particles in space, coloured by a field or by body.
///
/// ```no_run
/// # fn main() -> Result<(), impactite_output::OutputError> {
/// # let quarter: impactite_output::Snapshot = todo!();
/// use impactite_output::picture::{Cut, Mirror, ParticlePicture, Quantity};
/// ParticlePicture::new(1200, 900)
///     .title("Taylor bar, copper, 190 m/s")
///     .caption("80 µs after impact")
///     .colour_by(Quantity::scalar("plastic_strain"))
///     .mirrored([Mirror::x(0.0), Mirror::y(0.0)]) // a quarter becomes the whole
///     .cut(Cut { normal: [1.0, -1.0, 0.0], through: [0.0; 3] }) // and is cut open
///     .seen_from([1.0, -1.6, 0.7], [0.0, 0.0, 1.0])
///     .draw(&quarter)?
///     .save("bar.png")
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct ParticlePicture {
    width: usize,
    height: usize,
    title: String,
    caption: String,
    quantity: Option<Quantity>,
    view: View,
    perspective: bool,
    mirrors: Vec<Mirror>,
    cuts: Vec<Cut>,
    revolved: Option<f64>,
    scale: f64,
    letters: Option<f32>,
    marks: bool,
    sizes: Option<Sizes>,
}

#[derive(Debug, Clone)]
enum View {
    Fit { toward: [f64; 3], up: [f64; 3] },
    Fixed(Camera),
}

impl ParticlePicture {
    /// Create a picture of this size in pixels, seen obliquely from above (from the front in two dimensions), framed to
    /// fit, coloured by body.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            title: String::new(),
            caption: String::new(),
            quantity: None,
            view: View::Fit { toward: [1.0, -1.7, 0.8], up: [0.0, 0.0, 1.0] },
            perspective: false,
            mirrors: Vec::new(),
            cuts: Vec::new(),
            revolved: None,
            scale: 1.0,
            letters: None,
            marks: true,
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

    /// Set the view direction `toward` (from the matter to the eye), with `up` upwards, framed to fit.
    #[must_use]
    pub fn seen_from(self, toward: [f64; 3], up: [f64; 3]) -> Self {
        Self { view: View::Fit { toward, up }, ..self }
    }

    /// Set a camera (for series of pictures with a fixed view).
    #[must_use]
    pub fn camera(self, camera: Camera) -> Self {
        Self { view: View::Fixed(camera), ..self }
    }

    /// Use perspective projection (in the framed view; for a camera see [`Camera::with_perspective`]). There is no scale bar then.
    #[must_use]
    pub fn perspective(self) -> Self {
        Self { perspective: true, ..self }
    }

    /// Mirror the particles across symmetry planes, one after the other: two planes make four copies.
    #[must_use]
    pub fn mirrored(self, mirrors: impl IntoIterator<Item = Mirror>) -> Self {
        Self { mirrors: mirrors.into_iter().collect(), ..self }
    }

    /// Remove matter beyond a plane; with several planes, matter beyond all of them (a wedge).
    #[must_use]
    pub fn cut(mut self, cut: Cut) -> Self {
        self.cuts.push(cut);
        self
    }

    /// Revolve an axisymmetric snapshot (x is the radius, y the axis) about its axis through `degrees`; the axis
    /// becomes z. Particles are repeated at a spacing of their size.
    #[must_use]
    pub fn revolved(self, degrees: f64) -> Self {
        Self { revolved: Some(degrees), ..self }
    }

    /// Scale the drawn balls (1e-6 to 1e6, default 1: large enough to close the surface of a lattice).
    #[must_use]
    pub fn particle_scale(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// Set the font size, 1 to 1000 pixels; the default depends on the size of the picture.
    #[must_use]
    pub fn letters(self, size: f32) -> Self {
        Self { letters: Some(size), ..self }
    }

    /// Omit the scale bar and the coordinate axes.
    #[must_use]
    pub fn without_marks(self) -> Self {
        Self { marks: false, ..self }
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
    /// A field that does not exist, a snapshot without particles at finite positions (unless a camera is set),
    /// invalid sizes, directions or ranges, or more pixels and copies of particles than fit into
    /// [`MOST_BYTES`](impactite_simd::memory::MOST_BYTES).
    pub fn draw(&self, snapshot: &Snapshot) -> Result<Picture, OutputError> {
        self.drawn(snapshot, None)
    }

    fn drawn(&self, snapshot: &Snapshot, mut film: Option<&mut SeriesView>) -> Result<Picture, OutputError> {
        Mirror::check(&self.mirrors)?;
        super::check_scale(self.scale)?;
        let turned;
        let snapshot = match self.revolved {
            Some(degrees) => {
                turned = revolved(snapshot, degrees, self.quantity.as_ref())?;
                &turned
            }
            None => snapshot,
        };
        let quantity = match (&self.quantity, &mut film) {
            (Some(quantity), Some(film)) => Some(quantity.in_film(film, snapshot)?),
            (quantity, _) => quantity.clone(),
        };
        let coloured = colours_of(quantity.as_ref(), snapshot)?;
        let camera = match &self.view {
            View::Fixed(camera) => *camera,
            View::Fit { toward, up } => {
                let flat = snapshot.dimension() == 2;
                let (toward, up) = if flat { ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]) } else { (*toward, *up) };
                let fit = match &mut film {
                    Some(film) => {
                        let [low, high] = self.window(film, snapshot, toward, up)?;
                        Camera::framing(low, high, toward, up)?
                    }
                    None => Camera::fit(snapshot, &self.mirrors, toward, up)?,
                };
                if self.perspective { fit.with_perspective().zoomed(0.85) } else { fit }
            }
        };

        let (usual_width, usual_height) =
            self.sizes.map_or((self.width, self.height), |s| (s.width[1], s.width[1] * 3 / 4));
        let size = super::letters(self.letters, 1.0, usual_width, usual_height)?;
        let pad = 1.1 * size;
        let bar_room = coloured.bar.as_ref().map_or(0.0, |bar| bar.room(size));
        let legend =
            |width: usize| Legend::of(snapshot, &coloured, width as f32 - 2.0 * pad - bar_room, size);
        let head = if self.title.is_empty() { 0.0 } else { 2.0 * size };
        let foot = if self.caption.is_empty() { 0.0 } else { 1.6 * size };
        let (width, height) = match self.sizes {
            Some(sizes) => {
                let above = 2.0 * pad + head + legend(sizes.width[1]).height() + foot;
                sizes.fit(camera.aspect(), 2.0 * pad + bar_room, above)
            }
            None => (self.width, self.height),
        };
        let (width, height) = film.as_mut().map_or((width, height), |film| film.size((width, height)));
        let samples = FINE * FINE * (size_of::<f32>() + size_of::<u32>()) + size_of::<Rgb>();
        super::budget("a picture of so many pixels", "make the picture smaller")
            .holds(width as f64 * height as f64 * samples as f64)?;
        let mut picture = Picture::new(width, height, PAPER)?;

        let (w, h) = (width as f32, height as f32);
        let mut top = pad;
        let mut bottom = h - pad;
        let (title_at, caption_at) = (top + 1.1 * size, bottom - 0.2 * size);
        top += head;
        bottom -= foot;
        let mut right = w - pad;
        if let Some(bar) = &coloured.bar {
            right -= bar_room;
            let middle = 0.5 * (top + bottom);
            let half = (0.36 * (bottom - top)).max(2.0 * size).min(0.5 * (bottom - top));
            bar.draw(&mut picture, right + 0.6 * size, middle - half, middle + half, size);
        }
        // Title and caption are centred above the scene, if they fit there.
        let mut centred = |text: &str, y: f32, pen: Pen| {
            let pen = pen.fitted(text, w - 0.8 * size);
            let half = 0.5 * pen.width(text) + 0.4 * size;
            picture.text(text, [(0.5 * (pad + right)).max(half).min(w - half), y], &pen.centred());
        };
        centred(&self.title, title_at, Pen::new(1.3 * size, INK).bold());
        centred(&self.caption, caption_at, Pen::new(size, FAINT));
        let legend = legend(width);
        legend.draw(&mut picture, 0.5 * (pad + right), top);
        top += legend.height();
        let (width, height) = ((right - pad).max(1.0), (bottom - top).max(1.0));
        let pixels_per_metre = 0.97 * camera.pixels_per_metre(f64::from(width), f64::from(height));
        if !(pixels_per_metre.is_normal() && pixels_per_metre > 0.0) {
            let allowed = "positive and finite; the camera's width was zoomed to nothing or everything";
            return Err(OutputError::value("pixels a metre", pixels_per_metre, allowed));
        }
        let view = Viewport { left: pad, top, width, height, camera, pixels_per_metre };
        let matter = self.matter(snapshot, &coloured.colours)?;
        let mut own = Buffers::default();
        let buffers = film.map_or(&mut own, SeriesView::buffers);
        view.render(&matter, &mut buffers.space, &mut picture);
        if self.marks {
            view.marks(&mut picture, size, snapshot.dimension());
        }
        Ok(picture)
    }

    /// Window of a series that contains the snapshot, along the directions of the camera.
    fn window(
        &self,
        film: &mut SeriesView,
        snapshot: &Snapshot,
        toward: [f64; 3],
        up: [f64; 3],
    ) -> Result<[[f64; 3]; 2], OutputError> {
        let of_box = |given: [[f64; 3]; 2]| Camera::extent_of_box(given, &self.mirrors, toward, up);
        if let Some(set) = film.set_window() {
            return of_box(set);
        }
        let [mut low, mut high] = Camera::extent(snapshot, &self.mirrors, toward, up)?;
        if let Some(foreseen) = film.foreseen() {
            let [from, to] = of_box(foreseen)?;
            for d in 0..3 {
                (low[d], high[d]) = (low[d].min(from[d]), high[d].max(to[d]));
            }
        }
        Ok(film.cover(low, high))
    }

    /// Collect all balls and faces to draw, mirrored and cut.
    fn matter(&self, snapshot: &Snapshot, colours: &[Rgb]) -> Result<Shapes, OutputError> {
        let (radius, flat) = (0.75 * self.scale, snapshot.dimension() == 2);
        // Memory per particle: a ball or the faces of an element, its projection, and its sorted position.
        let each = (size_of::<Ball>() + size_of::<Seen>() + 32).max(if snapshot.cells().is_some() {
            6 * (size_of::<Face>() + size_of::<Flat>() + 32)
        } else {
            0
        });
        let most = snapshot.len() as f64 * f64::from(1_u32 << self.mirrors.len().min(6));
        super::budget("a picture of so many particles", "use fewer mirrors or particles")
            .holds(most * each as f64)?;
        let mut balls = Vec::with_capacity(snapshot.len() << self.mirrors.len().min(3));
        let mut beads = Vec::new();
        let mut copies = Vec::new();
        for (i, x) in snapshot.positions().iter().enumerate() {
            if !is_place(x) || has_faces(snapshot, i) {
                continue;
            }
            let (colour, size) = (colours[i], snapshot.size_of(i));
            let mut put = |x: [f64; 3], radius: f64, list: &mut Vec<Ball>| {
                Mirror::copies(&self.mirrors, x, &mut copies);
                for x in &copies {
                    if self.cuts.is_empty() || !self.cuts.iter().all(|cut| cut.removes(*x)) {
                        list.push(Ball { x: *x, radius, colour });
                    }
                }
            };
            let Some([a, b]) = line(snapshot, i) else {
                put(*x, radius * size, &mut balls);
                continue;
            };
            // A line element is a row of beads of its cross section.
            let along = sub(b, a);
            let length = dot(along, along).sqrt().max(1e-3 * size);
            let section = if flat { size * size / length } else { (size * size * size / length).sqrt() };
            let radius = 0.56 * section.min(size) * self.scale;
            let count = (length / radius).ceil().clamp(1.0, MOST_BEADS) as usize;
            for n in 0..count {
                let part = (n as f64 + 0.5) / count as f64;
                put([0, 1, 2].map(|d| a[d] + part * along[d]), radius, &mut beads);
            }
        }
        let faces = outer(snapshot, colours, &self.mirrors, &self.cuts);
        Ok(Shapes { balls, beads, faces })
    }
}

/// Maximum number of beads of a line element.
const MOST_BEADS: f64 = 32.0;

/// Repeat the particles of an axisymmetric snapshot around its axis, with their fields if a quantity gives the colour.
fn revolved(snapshot: &Snapshot, degrees: f64, quantity: Option<&Quantity>) -> Result<Snapshot, OutputError> {
    if snapshot.dimension() != 2 {
        let allowed = "2: only axisymmetric snapshots can be revolved";
        return Err(OutputError::value("dimension", snapshot.dimension(), allowed));
    }
    if !(degrees > 0.0 && degrees <= 360.0) {
        return Err(OutputError::value(
            "angle of revolution",
            degrees,
            "more than 0 and at most 360 degrees",
        ));
    }
    let angle = degrees.to_radians();
    // Limit the number of copies for particles far from the axis.
    let copies = |i: usize, x: &[f64; 3]| {
        if is_place(x) { (angle * x[0].abs() / snapshot.size_of(i)).ceil().clamp(1.0, 4096.0) } else { 0.0 }
    };
    let all: f64 = snapshot.positions().iter().enumerate().map(|(i, x)| copies(i, x)).sum();
    // Memory per copy: position, size, index and body, doubled for growing lists; the field and its projection.
    let each =
        2 * size_of::<([f64; 3], f64, usize, u32)>() + size_of::<[f64; 3]>() + size_of::<(Ball, Seen)>();
    super::budget(
        "a picture of so many particles turned about the axis",
        "turn it by a smaller angle or draw fewer particles",
    )
    .holds(all * each as f64)?;
    let (mut positions, mut sizes, mut from) = (Vec::new(), Vec::new(), Vec::new());
    for (i, x) in snapshot.positions().iter().enumerate() {
        let (r, size, count) = (x[0].abs(), snapshot.size_of(i), copies(i, x));
        for k in 0..count as usize {
            let phi = angle * (k as f64 + 0.5) / count;
            positions.push([r * phi.cos(), r * phi.sin(), x[1]]);
            sizes.push(size);
            from.push(i);
        }
    }
    let bodies = from.iter().map(|i| snapshot.bodies()[*i]).collect();
    let mut turned = Snapshot::new(
        3,
        snapshot.time(),
        snapshot.step(),
        positions,
        super::super::ParticleSize::Each(sizes),
    )?
    .with_bodies(bodies)?
    .with_body_names(snapshot.body_names());
    if quantity.is_some() {
        for (name, values) in snapshot.fields() {
            use super::super::FieldValues::{Scalar, Tensor, Vector};
            match values {
                Scalar(v) => turned = turned.with_scalar(name, from.iter().map(|i| v[*i]).collect())?,
                Vector(v) => turned = turned.with_vector(name, from.iter().map(|i| v[*i]).collect())?,
                Tensor(v) => turned = turned.with_tensor(name, from.iter().map(|i| v[*i]).collect())?,
            }
        }
    }
    Ok(turned)
}
