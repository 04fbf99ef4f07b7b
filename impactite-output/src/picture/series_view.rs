//! View settings shared by the pictures of a series, for a steady film.

use super::super::{FARTHEST, OutputError, is_place};
use super::{raster, samples};

/// View of a series of pictures: constant size, and a window and colour range that change rarely.
///
/// Size and window are those of the first picture, with a margin. Where matter leaves the window, that side moves to a tenth of the
/// window beyond the matter; where values leave the colour range, the range extends to the next round number. A series thus has few
/// jumps, and none if [`SeriesView::with_window`] and [`Quantity::range`](super::Quantity::range) are set.
///
/// ```
/// use impactite_output::picture::{FieldPicture, SeriesView};
/// # use impactite_output::{OutputError, ParticleSize, Snapshot};
/// # fn draw(snapshots: &[Snapshot]) -> Result<(), OutputError> {
/// let mut film = SeriesView::new();
/// for (n, snapshot) in snapshots.iter().enumerate() {
///     let picture = FieldPicture::new(1000, 750).draw_in(&mut film, snapshot)?;
///     picture.save(format!("film_{n:03}.png"))?;
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesView {
    /// Width and height, pixels; NaN before the first picture, like `window` and `range`.
    size: [f64; 2],
    /// Two corners of the window, m: in coordinates of the plane, or in space along the directions of the camera.
    window: [f64; 6],
    /// Minimum and maximum of the colour range, SI units.
    range: [f64; 2],
    set: Option<[[f64; 3]; 2]>,
    foreseen: Option<[[f64; 3]; 2]>,
    buffers: Buffers,
}

/// Memory of a picture while it is drawn, kept for the next one of the series: the operating system takes as long to hand it out
/// as a picture takes to draw. It is no part of the view: clones begin without it, and comparisons ignore it.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    pub(super) field: samples::Samples,
    pub(super) space: raster::Buffers,
}

impl Clone for Buffers {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for Buffers {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// Margin around matter in the first picture over the longest side.
const MARGIN: f64 = 0.08;
/// Margin of a moved side beyond the matter over the window's extent along that axis.
const STEP: f64 = 0.1;
/// Minimum extent along an axis for that margin over the longest side.
const LEAST: f64 = 0.3;

impl Default for SeriesView {
    fn default() -> Self {
        Self::new()
    }
}

impl SeriesView {
    /// Create the view before the first picture.
    #[must_use]
    pub fn new() -> Self {
        Self {
            size: [f64::NAN; 2],
            window: [f64::NAN; 6],
            range: [f64::NAN; 2],
            set: None,
            foreseen: None,
            buffers: Buffers::default(),
        }
    }

    /// Show the box between two corners (m; z is ignored in the plane) in all pictures.
    ///
    /// # Errors
    /// Corners that are not finite, or sides of zero length.
    pub fn with_window(self, low: [f64; 3], high: [f64; 3], dimension: usize) -> Result<Self, OutputError> {
        let good = (0..dimension.min(3)).all(|d| {
            low[d].abs() <= FARTHEST && high[d].abs() <= FARTHEST && high[d] - low[d] >= 1.0 / FARTHEST
        });
        if !good {
            let given = format!("{low:?} to {high:?}");
            return Err(OutputError::value(
                "window",
                given,
                "corners at most 1e30 m from the origin, from < to",
            ));
        }
        Ok(Self { set: Some([low, high]), ..self })
    }

    /// Mutable state that changes from picture to picture: numbers for a checkpoint.
    pub fn numbers(&mut self) -> impl Iterator<Item = &mut f64> {
        self.size.iter_mut().chain(&mut self.window).chain(&mut self.range)
    }

    /// Memory of the pictures of the series.
    pub(super) fn buffers(&mut self) -> &mut Buffers {
        &mut self.buffers
    }

    /// Fixed window, if set, m.
    pub(super) fn set_window(&self) -> Option<[[f64; 3]; 2]> {
        self.set
    }

    /// True after the first picture.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        !self.size[0].is_nan()
    }

    /// Include the box between two corners (m) in the first window, in addition to the matter of the first picture: the expected extent.
    #[must_use]
    pub fn with_foreseen(self, low: [f64; 3], high: [f64; 3]) -> Self {
        Self { foreseen: Some([low, high]), ..self }
    }

    /// Expected window, before the first picture, m.
    pub(super) fn foreseen(&self) -> Option<[[f64; 3]; 2]> {
        self.foreseen.filter(|[low, high]| !self.has_begun() && is_place(low) && is_place(high))
    }

    /// Extend the window to include this box, in the coordinates of the picture.
    pub(super) fn cover(&mut self, low: [f64; 3], high: [f64; 3]) -> [[f64; 3]; 2] {
        let longest = |low: &[f64; 3], high: &[f64; 3]| (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        if self.window[0].is_nan() {
            let margin = MARGIN * longest(&low, &high);
            for d in 0..3 {
                (self.window[d], self.window[3 + d]) = (low[d] - margin, high[d] + margin);
            }
        } else {
            let [from, to] = self.window();
            let least = LEAST * longest(&from, &to);
            for d in 0..3 {
                let step = STEP * (to[d] - from[d]).max(least);
                if low[d] < from[d] {
                    self.window[d] = low[d] - step;
                }
                if high[d] > to[d] {
                    self.window[3 + d] = high[d] + step;
                }
            }
        }
        self.window()
    }

    fn window(&self) -> [[f64; 3]; 2] {
        let [a, b, c, d, e, f] = self.window;
        [[a, b, c], [d, e, f]]
    }

    /// Extend the colour range to values from `low` to `high`; `None` while all values are equal.
    pub(super) fn colours(&mut self, low: f64, high: f64, from_zero: bool) -> Option<(f64, f64)> {
        let [from, to] = self.range;
        let (low, high) = if from_zero && low >= 0.0 { (0.0, high) } else { (low, high) };
        let same = high - low <= 1e-9 * low.abs().max(high.abs());
        if from.is_nan() {
            if same {
                return None;
            }
            self.range = round(low, high).into();
        } else if low < from || high > to {
            let (low, high) = round(low.min(from), high.max(to));
            // Sides that are not exceeded stay.
            self.range = [if low < from { low } else { from }, if high > to { high } else { to }];
        }
        Some((self.range[0], self.range[1]))
    }

    /// Width and height of all pictures: those of the first one.
    pub(super) fn size(&mut self, first: (usize, usize)) -> (usize, usize) {
        if self.size[0].is_nan() {
            self.size = [first.0 as f64, first.1 as f64];
        }
        (self.size[0] as usize, self.size[1] as usize)
    }
}

/// Return the next range with round ends that contains this one; includes 0 if it is near.
fn round(low: f64, high: f64) -> (f64, f64) {
    let up = |x: f64| {
        let decade = 10.0_f64.powf(x.log10().floor());
        let most = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0].map(|m| m * decade);
        most.into_iter().find(|m| *m >= x * (1.0 - 1e-12)).unwrap_or(x)
    };
    let outward = |x: f64| if x == 0.0 { 0.0 } else { x.signum() * up(x.abs()) };
    let (least, most) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
    let (low, high) = if low < 0.0 && high > 0.0 {
        // One rounding step for both ends.
        let (span, part) = (up(most), up(most) / 10.0);
        ((low / part).floor().max(-span / part) * part, (high / part).ceil().min(span / part) * part)
    } else if least < 0.5 * most {
        if high > 0.0 { (0.0, outward(high)) } else { (outward(low), 0.0) }
    } else {
        let step = (high - low) / 5.0;
        let decade = 10.0_f64.powf(step.log10().floor());
        let step =
            [1.0, 2.0, 5.0].map(|m| m * decade).into_iter().find(|m| *m >= step).unwrap_or(10.0 * decade);
        ((low / step).floor() * step, (high / step).ceil() * step)
    };
    if low.is_finite() && high.is_finite() && low < high { (low, high) } else { (-FARTHEST, FARTHEST) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_grow_in_few_round_steps() {
        let mut film = SeriesView::new();
        assert_eq!(film.colours(0.0, 0.0, true), None);
        assert_eq!(film.colours(0.0, 8.7e7, true), Some((0.0, 1e8)));
        assert_eq!(film.colours(1e6, 9.9e7, true), Some((0.0, 1e8)));
        assert_eq!(film.colours(0.0, 1.01e8, true), Some((0.0, 1.5e8)));
        let mut ratio = SeriesView::new();
        assert_eq!(ratio.colours(0.981, 1.012, false), Some((0.98, 1.02)));
        let mut signed = SeriesView::new();
        assert_eq!(signed.colours(-3.1e6, 4.4e8, false), Some((-5e7, 4.5e8)));
        // A hundred growing values cause few changes of the range.
        let mut growing = SeriesView::new();
        let ranges: Vec<_> = (1..=100).map(|n| growing.colours(0.0, f64::from(n), true)).collect();
        assert!(ranges.windows(2).filter(|w| w[0] != w[1]).count() <= 18);
        for (low, high) in [(f64::MIN, f64::MAX), (1e-320, 2e-320), (-1e-300, 1e300), (5.0, 5.0 + 1e-14)] {
            let (from, to) = round(low, high);
            assert!(from < to && from.is_finite() && to.is_finite(), "{low} {high}");
        }
    }

    #[test]
    fn a_window_stays_until_matter_leaves_it() {
        let mut film = SeriesView::new();
        let first = film.cover([0.0; 3], [1.0, 2.0, 0.0]);
        assert_eq!(first, [[-0.16, -0.16, -0.16], [1.16, 2.16, 0.16]]);
        assert_eq!(film.cover([-0.1; 3], [1.1, 0.0, 0.0]), first);
        let [low, high] = film.cover([0.0; 3], [1.2, 0.0, 0.0]);
        assert_eq!((low, high[1]), (first[0], first[1][1]));
        assert!((high[0] - (1.2 + 0.1 * 1.32)).abs() < 1e-12);
        let mut again = SeriesView::new();
        for (to, from) in again.numbers().zip(film.clone().numbers()) {
            *to = *from;
        }
        assert_eq!(again.cover([0.0; 3], [1.2, 0.0, 0.0]), film.cover([0.0; 3], [1.2, 0.0, 0.0]));
    }
}
