//! Pictures of a scene as it goes.

use impactite::output::picture::{FieldPicture, Mirror, ParticlePicture, Picture, Quantity};
use impactite::output::{OutputError, Snapshot};
use impactite_input::SceneFile;
use impactite_input::model::condition::Condition;
use impactite_input::model::{Axis, Space};

/// Size of pictures, pixels.
const SIZE: (usize, usize) = (1000, 750);

/// Draws snapshots of a scene.
pub struct Draws {
    title: String,
    space: Space,
    colour: Option<Quantity>,
    mirrors: Vec<Mirror>,
    seen_from: Option<[f64; 3]>,
}

impl Draws {
    /// As a scene file says; mirrored where it has planes of symmetry, so that a quarter is drawn whole.
    #[must_use]
    pub fn new(scene: &SceneFile) -> Self {
        let mut mirrors = Vec::new();
        for condition in &scene.conditions {
            let Condition::Symmetry(plane) = condition else { continue };
            mirrors.push(match plane.axis {
                Axis::X | Axis::R => Mirror::x(plane.at.value),
                Axis::Z if scene.space == Space::Full => Mirror::z(plane.at.value),
                _ => Mirror::y(plane.at.value),
            });
        }
        let colour = scene.output.colour.as_ref().map(|colour| {
            let quantity = match colour.field.as_str() {
                "velocity" | "speed" => Quantity::magnitude("velocity"),
                field => Quantity::scalar(field),
            };
            match colour.range {
                Some([low, high]) => quantity.range(low.value, high.value),
                None => quantity,
            }
        });
        Draws {
            title: scene.title.clone(),
            space: scene.space,
            colour,
            mirrors,
            seen_from: scene.output.seen_from.map(|v| v.map(|q| q.value)),
        }
    }

    /// A picture of a moment.
    ///
    /// # Errors
    /// A field that the scene has not.
    pub fn draw(&self, snapshot: &Snapshot) -> Result<Picture, OutputError> {
        let (width, height) = SIZE;
        let caption = format!("t = {}", moment(snapshot.time()));
        if self.space == Space::Full {
            let mut picture = ParticlePicture::new(width, height)
                .title(&self.title)
                .caption(caption)
                .mirrored(self.mirrors.clone());
            if let Some(colour) = &self.colour {
                picture = picture.colour_by(colour.clone());
            }
            if let Some(from) = self.seen_from {
                picture = picture.seen_from(from, [0.0, 0.0, 1.0]);
            }
            return picture.draw(snapshot);
        }
        let mut picture = FieldPicture::new(width, height)
            .title(&self.title)
            .caption(caption)
            .mirrored(self.mirrors.clone());
        if let Some(colour) = &self.colour {
            picture = picture.colour_by(colour.clone());
        }
        if self.space == Space::Axisymmetric {
            picture = picture.axes("r", "z");
        }
        picture.draw(snapshot)
    }
}

/// A time in the unit that suits it.
#[must_use]
pub fn moment(seconds: f64) -> String {
    let (unit, factor) = impactite::output::picture::time_unit(seconds);
    format!("{:.4} {unit}", seconds * factor)
}
