//! Picture in memory with anti-aliased lines, fills and text.

use std::path::Path;
use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};

use super::super::{OutputError, write_whole};
use super::colour::Rgb;

/// Finished picture, which can be saved or placed in [`Panels`](super::Panels).
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
}

impl std::fmt::Debug for Picture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Picture({} x {})", self.width, self.height)
    }
}

/// Maximum side of a picture, pixels.
const LARGEST: usize = 16384;

impl Picture {
    /// Create a picture of one colour, `width` by `height` pixels.
    ///
    /// # Errors
    /// A side of 0 or of more than 16384 pixels.
    pub fn new(width: usize, height: usize, colour: Rgb) -> Result<Self, OutputError> {
        for (what, side) in [("picture width", width), ("picture height", height)] {
            if side == 0 || side > LARGEST {
                return Err(OutputError::value(what, side, "1 to 16384 pixels"));
            }
        }
        Ok(Self { width, height, pixels: vec![colour; width * height] })
    }

    /// Width, pixels.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height, pixels.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Colour at column `x` and row `y` from the top left; `None` outside.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> Option<Rgb> {
        if x < self.width { self.pixels.get(y * self.width + x).copied() } else { None }
    }

    /// Write the picture as a PNG file.
    ///
    /// # Errors
    /// A path that is no regular file, or a file that cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), OutputError> {
        let path = path.as_ref();
        let failed = |source| OutputError::Png { path: path.to_path_buf(), source };
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        let mut writer = encoder.write_header().map_err(failed)?;
        writer.write_image_data(self.pixels.as_flattened()).map_err(failed)?;
        writer.finish().map_err(failed)?;
        write_whole(path, bytes)
    }

    pub(crate) fn pixels_mut(&mut self) -> &mut [Rgb] {
        &mut self.pixels
    }

    /// Blend `colour` over a pixel with coverage `cover`.
    pub(crate) fn blend(&mut self, x: i64, y: i64, colour: Rgb, cover: f32) {
        if x >= 0 && y >= 0 && (x as usize) < self.width && (y as usize) < self.height && cover > 0.0 {
            let pixel = &mut self.pixels[y as usize * self.width + x as usize];
            let cover = cover.min(1.0);
            for c in 0..3 {
                let old = f32::from(pixel[c]);
                pixel[c] = (old + (f32::from(colour[c]) - old) * cover + 0.5) as u8;
            }
        }
    }

    /// Rows between two heights; empty for NaN.
    fn rows(&self, from: f32, to: f32) -> std::ops::Range<i64> {
        within(from, to, self.height)
    }

    /// Columns between two positions; empty for NaN.
    fn columns(&self, from: f32, to: f32) -> std::ops::Range<i64> {
        within(from, to, self.width)
    }

    /// Fill a box between two corners.
    pub(crate) fn fill(&mut self, [x0, y0]: [f32; 2], [x1, y1]: [f32; 2], colour: Rgb) {
        let overlap = |i: i64, lo: f32, hi: f32| (hi.min(i as f32 + 1.0) - lo.max(i as f32)).clamp(0.0, 1.0);
        for y in self.rows(y0, y1) {
            for x in self.columns(x0, x1) {
                self.blend(x, y, colour, overlap(x, x0, x1) * overlap(y, y0, y1));
            }
        }
    }

    /// Draw the outline of a box with lines of `width` pixels.
    pub(crate) fn frame(&mut self, a: [f32; 2], b: [f32; 2], width: f32, colour: Rgb) {
        let h = 0.5 * width;
        self.fill([a[0] - h, a[1] - h], [b[0] + h, a[1] + h], colour);
        self.fill([a[0] - h, b[1] - h], [b[0] + h, b[1] + h], colour);
        self.fill([a[0] - h, a[1] + h], [a[0] + h, b[1] - h], colour);
        self.fill([b[0] - h, a[1] + h], [b[0] + h, b[1] - h], colour);
    }

    /// Draw a straight line with round ends.
    pub(crate) fn line(&mut self, a: [f32; 2], b: [f32; 2], width: f32, colour: Rgb) {
        self.polyline(&[a, b], width, colour, None, None);
    }

    /// Draw a polyline with round joints, optionally dashed `(on, off)` and clipped to a box. Each pixel is
    /// blended once, so that joints do not darken.
    pub(crate) fn polyline(
        &mut self,
        points: &[[f32; 2]],
        width: f32,
        colour: Rgb,
        dash: Option<(f32, f32)>,
        clip: Option<([f32; 2], [f32; 2])>,
    ) {
        let half = 0.5 * width;
        let (w, h) = (self.width as f32, self.height as f32);
        let ([cx0, cy0], [cx1, cy1]) = clip.unwrap_or(([0.0, 0.0], [w, h]));
        let mut cover: std::collections::BTreeMap<(i64, i64), f32> = std::collections::BTreeMap::new();
        let mut run = 0.0;
        for pair in points.windows(2) {
            let ([ax, ay], [bx, by]) = (pair[0], pair[1]);
            let (dx, dy) = (bx - ax, by - ay);
            let length = dx.hypot(dy);
            if !length.is_finite() {
                continue;
            }
            let reach = half + 1.0;
            let x_range =
                (ax.min(bx) - reach).max(cx0).floor() as i64..(ax.max(bx) + reach).min(cx1).ceil() as i64;
            for x in x_range {
                // Restrict to the rows near the line in this column.
                let (mut y0, mut y1) = (ay.min(by), ay.max(by));
                if dx.abs() > 1e-3 {
                    let slope = dy / dx;
                    let slack = reach * (1.0 + slope.abs()) + slope.abs();
                    let middle = ay + slope * (x as f32 + 0.5 - ax);
                    y0 = y0.max(middle - slack);
                    y1 = y1.min(middle + slack);
                }
                for y in (y0 - reach).max(cy0).floor() as i64..(y1 + reach).min(cy1).ceil() as i64 {
                    let (px, py) = (x as f32 + 0.5 - ax, y as f32 + 0.5 - ay);
                    let along = if length > 0.0 { (px * dx + py * dy) / length } else { 0.0 };
                    let foot = along.clamp(0.0, length);
                    let unit = if length > 0.0 { [dx / length, dy / length] } else { [0.0, 0.0] };
                    let distance = (px - unit[0] * foot).hypot(py - unit[1] * foot);
                    let mut c = (half - distance + 0.5).clamp(0.0, 1.0).min(width);
                    if let Some((on, off)) = dash {
                        let phase = (run + foot).rem_euclid(on + off);
                        c *= (0.5 + phase).min(on - phase + 0.5).clamp(0.0, 1.0);
                    }
                    if c > 0.0 {
                        let old = cover.entry((y, x)).or_insert(0.0);
                        *old = old.max(c);
                    }
                }
            }
            run += length;
        }
        for ((y, x), c) in cover {
            self.blend(x, y, colour, c);
        }
    }

    /// Fill a convex polygon, the intersection of the half planes of its edges; corners are clockwise on the screen.
    pub(crate) fn polygon(&mut self, corners: &[[f32; 2]], colour: Rgb) {
        let fold =
            |c: usize, f: fn(f32, f32) -> f32, start: f32| corners.iter().fold(start, |m, p| f(m, p[c]));
        let (x0, x1) = (fold(0, f32::min, f32::MAX), fold(0, f32::max, f32::MIN));
        let (y0, y1) = (fold(1, f32::min, f32::MAX), fold(1, f32::max, f32::MIN));
        for y in self.rows(y0 - 1.0, y1 + 1.0) {
            for x in self.columns(x0 - 1.0, x1 + 1.0) {
                let mut cover = 1.0_f32;
                for (i, a) in corners.iter().enumerate() {
                    let b = corners[(i + 1) % corners.len()];
                    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
                    let inside = (dx * (y as f32 + 0.5 - a[1]) - dy * (x as f32 + 0.5 - a[0]))
                        / dx.hypot(dy).max(1e-6);
                    cover = cover.min((inside + 0.5).clamp(0.0, 1.0));
                }
                self.blend(x, y, colour, cover);
            }
        }
    }

    /// Fill a disc.
    pub(crate) fn disc(&mut self, [cx, cy]: [f32; 2], radius: f32, colour: Rgb) {
        for y in self.rows(cy - radius - 1.0, cy + radius + 2.0) {
            for x in self.columns(cx - radius - 1.0, cx + radius + 2.0) {
                let distance = (x as f32 + 0.5 - cx).hypot(y as f32 + 0.5 - cy);
                self.blend(x, y, colour, (radius - distance + 0.5).clamp(0.0, 1.0));
            }
        }
    }

    /// Copy another picture with its top left corner at `(left, top)`.
    pub(crate) fn paste(&mut self, other: &Self, left: usize, top: usize) {
        let columns = other.width.min(self.width.saturating_sub(left));
        for y in 0..other.height.min(self.height.saturating_sub(top)) {
            let to = (top + y) * self.width + left;
            self.pixels[to..to + columns].copy_from_slice(&other.pixels[y * other.width..][..columns]);
        }
    }

    /// Draw `text` from a point on its baseline.
    pub(crate) fn text(&mut self, text: &str, at: [f32; 2], pen: &Pen) {
        let Some(font) = pen.weight.font() else { return };
        // Skip text far outside the picture.
        if !at.iter().all(|c| c.abs() <= 4.0 * LARGEST as f32) {
            return;
        }
        let (glyphs, width) = layout(text, pen.size, font);
        let shift = match pen.align {
            Align::Left => 0.0,
            Align::Centre => -0.5 * width,
            Align::Right => -width,
        };
        // Horizontal text keeps its subpixel position for correct letter spacing; vertical text is rotated
        // about a whole pixel.
        let (ox, oy) = if pen.upward { (at[0].round(), at[1].round()) } else { (0.0, 0.0) };
        for mut glyph in glyphs {
            glyph.position.x += shift + if pen.upward { 0.0 } else { at[0] };
            glyph.position.y += if pen.upward { 0.0 } else { at[1].round() };
            if let Some(outline) = font.outline_glyph(glyph) {
                let corner = outline.px_bounds().min;
                outline.draw(|x, y, cover| {
                    let (x, y) = (corner.x as i64 + i64::from(x), corner.y as i64 + i64::from(y));
                    let (x, y) = if pen.upward { (ox as i64 + y, oy as i64 - x) } else { (x, y) };
                    self.blend(x, y, pen.colour, cover);
                });
            }
        }
    }
}

/// Integers from `from` to `to` that are less than `count`.
fn within(from: f32, to: f32, count: usize) -> std::ops::Range<i64> {
    if from.is_nan() || to.is_nan() {
        return 0..0;
    }
    from.floor().max(0.0) as i64..to.ceil().min(count as f32) as i64
}

/// Font weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weight {
    Regular,
    SemiBold,
}

/// Horizontal alignment of text at its anchor point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Centre,
    Right,
}

/// Text style. `size` is the em size, pixels; `upward` text reads from bottom to top.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pen {
    pub size: f32,
    pub weight: Weight,
    pub align: Align,
    pub upward: bool,
    pub colour: Rgb,
}

impl Pen {
    pub(crate) fn new(size: f32, colour: Rgb) -> Self {
        Self { size, weight: Weight::Regular, align: Align::Left, upward: false, colour }
    }
    pub(crate) fn bold(self) -> Self {
        Self { weight: Weight::SemiBold, ..self }
    }
    pub(crate) fn centred(self) -> Self {
        Self { align: Align::Centre, ..self }
    }
    pub(crate) fn right(self) -> Self {
        Self { align: Align::Right, ..self }
    }
    /// Reduce the font size if a text would be wider than `width` pixels.
    pub(crate) fn fitted(self, text: &str, width: f32) -> Self {
        let needs = self.width(text);
        if needs > width { Self { size: self.size * (width / needs).max(0.1), ..self } } else { self }
    }
    pub(crate) fn upward(self) -> Self {
        Self { upward: true, ..self }
    }
    /// Width of a text, pixels.
    pub(crate) fn width(&self, text: &str) -> f32 {
        self.weight.font().map_or(0.0, |font| layout(text, self.size, font).1)
    }
}

static REGULAR: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(include_bytes!("fonts/Inter-Regular.subset.otf")).ok());
static SEMI_BOLD: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(include_bytes!("fonts/Inter-SemiBold.subset.otf")).ok());

impl Weight {
    fn font(self) -> Option<&'static FontRef<'static>> {
        match self {
            Self::Regular => REGULAR.as_ref(),
            Self::SemiBold => SEMI_BOLD.as_ref(),
        }
    }
}

/// Glyphs of a text with their positions on a baseline from (0, 0), and the width, pixels.
fn layout(text: &str, size: f32, font: &FontRef<'static>) -> (Vec<Glyph>, f32) {
    let em = font.units_per_em().unwrap_or(1000.0);
    let scale = PxScale::from(size * font.height_unscaled() / em);
    let scaled = font.as_scaled(scale);
    let (mut x, mut glyphs, mut before) = (0.0, Vec::new(), None);
    for letter in text.chars() {
        let id = font.glyph_id(letter);
        if let Some(before) = before {
            x += scaled.kern(before, id);
        }
        glyphs.push(id.with_scale_and_position(scale, point(x, 0.0)));
        x += scaled.h_advance(id);
        before = Some(id);
    }
    (glyphs, x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fonts_are_there_and_hold_the_letters_of_physics() {
        for weight in [Weight::Regular, Weight::SemiBold] {
            let font = weight.font().expect("the font is embedded");
            for letter in "Az09 −×·°µ²³⁻⁶₀ερσνθγΔ√≤()[]".chars() {
                assert_ne!(font.glyph_id(letter).0, 0, "no glyph for {letter:?}");
            }
        }
    }

    #[test]
    fn a_stroke_has_its_width_and_does_not_darken_at_joints() {
        let mut picture = Picture::new(30, 9, [255; 3]).expect("small");
        picture.polyline(&[[3.0, 4.5], [15.0, 4.5], [27.0, 4.5]], 3.0, [0; 3], None, None);
        for x in [8, 15, 20] {
            let ink: u32 = (0..9).map(|y| 255 - u32::from(picture.pixel(x, y).expect("inside")[0])).sum();
            assert_eq!(ink, 3 * 255, "column {x}");
        }
    }

    #[test]
    fn boxes_cover_parts_of_pixels() {
        let mut picture = Picture::new(4, 4, [0; 3]).expect("small");
        picture.fill([0.5, 1.0], [2.0, 2.0], [200; 3]);
        assert_eq!(picture.pixel(0, 1), Some([100; 3]));
        assert_eq!(picture.pixel(1, 1), Some([200; 3]));
        assert_eq!(picture.pixel(2, 1), Some([0; 3]));
        assert_eq!(picture.pixel(4, 1), None);
    }
}
