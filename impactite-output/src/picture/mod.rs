//! Pictures as PNG: shaded particles in space, flat fields, line charts, stacked bars, and panels of them.
//!
//! Rendering runs on the CPU: no window, no graphics card, no font files. Glyphs are from the
//! typeface Inter (SIL Open Font License, see `fonts/OFL.txt`).
//!
//! ```
//! use impactite_output::picture::{ColourMap, ParticlePicture, Quantity};
//! use impactite_output::{ParticleSize, Snapshot};
//! # let folder = std::env::temp_dir().join("impactite-doc-picture");
//! # std::fs::create_dir_all(&folder)?;
//! let positions = (0..8).map(|i| [(i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64]).collect();
//! let cube = Snapshot::new(3, 0.0, 0, positions, ParticleSize::Uniform(1.0))?
//!     .with_scalar("temperature", (0..8).map(|i| 300.0 + 10.0 * f64::from(i)).collect())?;
//! ParticlePicture::new(400, 300)
//!     .title("Eight particles")
//!     .colour_by(Quantity::scalar("temperature").unit("K", 1.0).map(ColourMap::Inferno))
//!     .draw(&cube)?
//!     .save(folder.join("cube.png"))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod axis;
mod bars;
mod camera;
mod canvas;
mod chart;
mod colour;
mod faces;
mod field;
mod legend;
mod matter;
mod panels;
mod particles;
mod quantity;
mod raster;
mod samples;
mod series_view;

use super::OutputError;
use impactite_simd::memory::{Budget, MOST_BYTES};

pub use bars::Bars;
pub use camera::{Camera, Cut, Mirror};
pub use canvas::Picture;
pub use chart::{Axis, Chart, Marker, Series, Stroke};
pub use colour::{ColourMap, Rgb, hex, palette};
pub use field::{FieldPicture, Mark};
pub use panels::Panels;
pub use particles::ParticlePicture;
pub use quantity::Quantity;
pub use series_view::SeriesView;

/// Choose the unit of a length (m) for display, and its number per metre.
#[must_use]
pub fn length_unit(length: f64) -> (&'static str, f64) {
    match length.abs() {
        l if l >= 2.0e3 => ("km", 1e-3),
        l if l >= 0.9 => ("m", 1.0),
        l if l >= 1.0e-3 => ("mm", 1e3),
        l if l >= 1.0e-6 => ("µm", 1e6),
        l if l > 0.0 => ("nm", 1e9),
        _ => ("m", 1.0),
    }
}

/// Choose the unit of a time (s) for display, and its number per second.
#[must_use]
pub fn time_unit(time: f64) -> (&'static str, f64) {
    match time.abs() {
        t if t >= 1.0 => ("s", 1.0),
        t if t >= 1.0e-3 => ("ms", 1e3),
        t if t >= 1.0e-6 => ("µs", 1e6),
        t if t > 0.0 => ("ns", 1e9),
        _ => ("s", 1.0),
    }
}

/// Set a list to `count` equal values.
fn refill<T: Copy>(list: &mut Vec<T>, count: usize, value: T) {
    list.clear();
    list.resize(count, value);
}

/// Check a scale factor of particle sizes.
fn check_scale(scale: f64) -> Result<(), OutputError> {
    if (1e-6..=1e6).contains(&scale) {
        Ok(())
    } else {
        Err(OutputError::value("particle scale", scale, "from 1e-6 to 1e6"))
    }
}

/// Allowed sizes of a picture of a [`SeriesView`], pixels; the first picture determines the size.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sizes {
    width: [usize; 2],
    height: [usize; 2],
}

impl Sizes {
    /// Choose width and height for a scene of this aspect ratio (height over width), with margins `beside` and `above` in pixels.
    fn fit(self, aspect: f64, beside: f32, above: f32) -> (usize, usize) {
        let whole =
            |x: f64, [least, most]: [usize; 2]| (x.round().max(1.0) as usize).clamp(least, most.max(least));
        let (beside, above) = (f64::from(beside), f64::from(above));
        let height = whole((self.width[1] as f64 - beside).max(1.0) * aspect + above, self.height);
        let width = whole((height as f64 - above).max(1.0) / aspect + beside, self.width);
        (width, height)
    }
}

/// Memory limit of a picture.
fn budget(what: &'static str, remedy: &'static str) -> Budget {
    Budget { what, allowed: MOST_BYTES, remedy }
}

/// Font size, pixels: the requested one, or `larger` times the default for the size of the picture.
fn letters(asked: Option<f32>, larger: f32, width: usize, height: usize) -> Result<f32, OutputError> {
    match asked {
        Some(size) if (1.0..=1000.0).contains(&size) => Ok(size),
        Some(size) => Err(OutputError::value("size of letters", size, "1 to 1000 pixels")),
        None => Ok(((width as f32 * height as f32).sqrt() / 48.0).clamp(10.0, 60.0) * larger),
    }
}
