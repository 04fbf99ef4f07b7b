//! Pictures of a scene during its run.

use impactite::observe::Draw;
use impactite::output::picture::{FieldPicture, Mirror, ParticlePicture, Picture, Quantity, SeriesView};
use impactite::output::{OutputError, Snapshot};
use impactite::scene::{Archive, CheckpointError};
use impactite_input::SceneFile;
use impactite_input::model::Space;
use impactite_input::model::condition::{Condition, Side};
use impactite_input::model::output::Mirror as Mirrors;

/// Ranges of picture width and height, pixels: chosen once per run so that the scene fills the picture.
const WIDTHS: [usize; 2] = [640, 1000];
const HEIGHTS: [usize; 2] = [350, 750];
/// Largest flight distance that the first window covers beyond the bodies, as a fraction of the longest side of their bounding box.
const FORESIGHT: f64 = 0.5;

/// Renderer of snapshots of a scene.
pub struct Draws {
    title: String,
    space: Space,
    end: f64,
    colour: Option<Quantity>,
    mirrors: Vec<Mirror>,
    seen_from: Option<[f64; 3]>,
    /// Planes that confine matter to one side: axis, position (m), side.
    planes: Vec<(usize, f64, Side)>,
    film: SeriesView,
}

impl Draws {
    /// Create the renderer for a scene file; mirrored at an axis with one plane of symmetry, so that a quarter model is drawn whole.
    #[must_use]
    pub fn new(scene: &SceneFile) -> Self {
        let (output, space) = (&scene.output, scene.space);
        let colour = output.colour.as_ref().map(|colour| {
            let quantity = Quantity::named(&colour.field);
            match colour.range {
                Some([low, high]) => quantity.range(low.value, high.value),
                None => quantity,
            }
        });
        let mut planes = Vec::new();
        for condition in &scene.conditions {
            let (axis, at, side) = match condition {
                Condition::Symmetry(plane) | Condition::Fixed(plane) => {
                    (plane.axis, plane.at.value, plane.side)
                }
                Condition::Wall(wall) => (wall.axis, wall.at.value, wall.side),
                _ => continue,
            };
            planes.extend(space.axis(axis).map(|axis| (axis, at, side)));
        }
        let mut film = SeriesView::new();
        if let Some(window) = &output.window {
            let corner = |list: &[impactite_input::quantity::Quantity<_>]| {
                [0, 1, 2]
                    .map(|d| list.get(d).map_or(0.0, |q: &impactite_input::quantity::Quantity<_>| q.value))
            };
            let set = film.clone().with_window(corner(&window.from), corner(&window.to), space.dimensions());
            film = set.unwrap_or(film);
        }
        Draws {
            title: scene.title.clone(),
            space,
            end: scene.end.value,
            colour,
            mirrors: mirrors(scene),
            seen_from: output.seen_from.map(|v| v.map(|q| q.value)),
            planes,
            film,
        }
    }

    /// Return the mirror planes of the pictures.
    #[must_use]
    pub fn mirrors(&self) -> &[Mirror] {
        &self.mirrors
    }

    /// Return the bounding box of the bodies now and along their flight until the end, limited by walls and [`FORESIGHT`].
    fn foreseen(&self, snapshot: &Snapshot) -> Option<[[f64; 3]; 2]> {
        let (low, high) = snapshot.bounds()?;
        let velocities = snapshot.vector("velocity").ok()?;
        let farthest = FORESIGHT * (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        let count = snapshot.bodies().iter().max().map_or(0, |&body| body as usize + 1);
        // Lower and upper corner, sum of velocities and number of points of each body.
        let mut bodies = vec![([f64::INFINITY; 3], [f64::NEG_INFINITY; 3], [0.0; 3], 0.0); count];
        for ((body, x), v) in snapshot.bodies().iter().zip(snapshot.positions()).zip(velocities) {
            let (low, high, sum, points) = &mut bodies[*body as usize];
            for d in 0..3 {
                (low[d], high[d]) = (low[d].min(x[d]), high[d].max(x[d]));
                sum[d] += v[d];
            }
            *points += 1.0;
        }
        let (mut from, mut to) = (low, high);
        for (low, high, sum, points) in bodies {
            for d in 0..3 {
                let shift = sum[d] / points * self.end;
                if !(shift.is_finite() && low[d].is_finite() && high[d].is_finite()) {
                    continue;
                }
                let shift = shift.clamp(-farthest, farthest);
                let (mut lowest, mut highest) = (low[d] + shift, high[d] + shift);
                for (_, at, side) in self.planes.iter().filter(|(axis, ..)| *axis == d) {
                    match side {
                        Side::Above if low[d] >= *at => lowest = lowest.max(*at),
                        Side::Below if high[d] <= *at => highest = highest.min(*at),
                        _ => {}
                    }
                }
                (from[d], to[d]) = (from[d].min(lowest), to[d].max(highest));
            }
        }
        Some([from, to])
    }
}

/// Return the mirror planes: planes of symmetry as selected in the scene file.
fn mirrors(scene: &SceneFile) -> Vec<Mirror> {
    let mut mirrors: Vec<Mirror> = Vec::new();
    let mut of_axes = Vec::new();
    for condition in &scene.conditions {
        let Condition::Symmetry(plane) = condition else { continue };
        let Ok(axis) = scene.space.axis(plane.axis) else { continue };
        let mirror = Mirror { axis, at: plane.at.value };
        if !mirrors.contains(&mirror) {
            mirrors.push(mirror);
            of_axes.push(plane.axis);
        }
    }
    // A symmetry plane normal to gravity is a floor.
    let weighs = |axis: usize| {
        let along = scene.gravity.as_ref().and_then(|list| list.get(axis));
        along.is_some_and(|formula| formula.as_constant() != Some(0.0))
    };
    let is_chosen = |n: usize| match &scene.output.mirror {
        Mirrors::Single(chosen) => {
            let alone = of_axes.iter().filter(|axis| **axis == of_axes[n]).count() == 1;
            *chosen && alone && !weighs(mirrors[n].axis)
        }
        Mirrors::Axes(axes) => axes.contains(&of_axes[n]),
    };
    mirrors.iter().enumerate().filter(|(n, _)| is_chosen(*n)).map(|(_, mirror)| *mirror).collect()
}

impl Draw for Draws {
    fn draw(&mut self, snapshot: &Snapshot) -> Result<Picture, OutputError> {
        if !self.film.has_begun()
            && let Some([low, high]) = self.foreseen(snapshot)
        {
            self.film = self.film.clone().with_foreseen(low, high);
        }
        let caption = format!("t = {}", moment(snapshot.time()));
        if self.space == Space::Full {
            let mut picture = ParticlePicture::new(WIDTHS[1], HEIGHTS[1])
                .fitted(WIDTHS, HEIGHTS)
                .title(&self.title)
                .caption(caption)
                .mirrored(self.mirrors.clone());
            if let Some(colour) = &self.colour {
                picture = picture.colour_by(colour.clone());
            }
            if let Some(from) = self.seen_from {
                let up = if from[0] == 0.0 && from[1] == 0.0 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
                picture = picture.seen_from(from, up);
            }
            return picture.draw_in(&mut self.film, snapshot);
        }
        let mut picture = FieldPicture::new(WIDTHS[1], HEIGHTS[1])
            .fitted(WIDTHS, HEIGHTS)
            .title(&self.title)
            .caption(caption)
            .mirrored(self.mirrors.clone());
        if let Some(colour) = &self.colour {
            picture = picture.colour_by(colour.clone());
        }
        if self.space == Space::Axisymmetric {
            picture = picture.axes("r", "z");
        }
        picture.draw_in(&mut self.film, snapshot)
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.reals(self.film.numbers())
    }
}

/// Format a time with a suitable unit.
#[must_use]
pub fn moment(seconds: f64) -> String {
    let (unit, factor) = impactite::output::picture::time_unit(seconds);
    format!("{:.4} {unit}", seconds * factor)
}
