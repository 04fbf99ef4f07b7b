//! Several pictures in one.

use super::super::OutputError;
use super::axis::{INK, PAPER};
use super::canvas::{Pen, Picture};

/// Grid of pictures, each with a title above it.
///
/// ```
/// use impactite_output::picture::{Panels, Picture};
/// let [left, right] = [Picture::new(200, 150, [240; 3])?, Picture::new(100, 150, [220; 3])?];
/// let both = Panels::new(2).title("Two ways").panel("(a) three dimensions", left).panel("(b) axisymmetric", right).compose()?;
/// assert!(both.width() >= 300 && both.height() > 150);
/// # Ok::<(), impactite_output::OutputError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Panels {
    columns: usize,
    title: String,
    panels: Vec<(String, Picture)>,
}

impl Panels {
    /// Create panels in rows of `columns` (at least 1).
    #[must_use]
    pub fn new(columns: usize) -> Self {
        Self { columns: columns.max(1), title: String::new(), panels: Vec::new() }
    }

    /// Set the title above all panels.
    #[must_use]
    pub fn title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Add a picture with its title ("" for none), row by row.
    #[must_use]
    pub fn panel(mut self, title: impl Into<String>, picture: Picture) -> Self {
        self.panels.push((title.into(), picture));
        self
    }

    /// Compose the picture. Columns are as wide as their widest picture, rows as high as their highest.
    ///
    /// # Errors
    /// [`OutputError::Value`] for no panel, or a total size above the limit of a picture.
    pub fn compose(&self) -> Result<Picture, OutputError> {
        if self.panels.is_empty() {
            return Err(OutputError::value("number of panels", 0, "at least 1"));
        }
        let columns = self.columns.min(self.panels.len());
        let rows = self.panels.len().div_ceil(columns);
        let mut widths = vec![0; columns];
        let mut heights = vec![0; rows];
        let mut size = 0.0_f32;
        for (i, (_, picture)) in self.panels.iter().enumerate() {
            widths[i % columns] = picture.width().max(widths[i % columns]);
            heights[i / columns] = picture.height().max(heights[i / columns]);
            size = size.max(picture.height() as f32 / 40.0);
        }
        let size = size.clamp(11.0, 60.0);
        let above = |titled: bool, room: f32| if titled { (room * size) as usize } else { 0 };
        let head = above(!self.title.is_empty(), 2.7);
        let band = above(self.panels.iter().any(|(title, _)| !title.is_empty()), 2.1);
        let height = head + heights.iter().sum::<usize>() + rows * band;
        let mut whole = Picture::new(widths.iter().sum(), height, PAPER)?;
        let pen = Pen::new(size, INK).bold().centred();
        let middle = 0.5 * whole.width() as f32;
        whole.text(&self.title, [middle, 1.9 * size], &Pen { size: 1.3 * size, ..pen });
        let mut top = head;
        for (row, height) in heights.iter().enumerate() {
            let mut left = 0;
            for (column, width) in widths.iter().enumerate() {
                if let Some((title, picture)) = self.panels.get(row * columns + column) {
                    let centre = left as f32 + 0.5 * *width as f32;
                    whole.text(title, [centre, top as f32 + 1.55 * size], &pen);
                    let x = left + (width - picture.width()) / 2;
                    whole.paste(picture, x, top + band + (height - picture.height()) / 2);
                }
                left += width;
            }
            top += height + band;
        }
        Ok(whole)
    }
}
