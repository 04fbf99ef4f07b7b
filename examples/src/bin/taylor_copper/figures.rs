//! Pictures of the bars.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{ColourMap, FieldPicture, Mirror, Panels, Picture, Quantity};
use mpm_core::output::{OutputError, ParticleSize, Snapshot};

use crate::scene::{LENGTH, Outcome, Parts, RADIUS, Space};
use crate::{beside, coupled, points};

/// Draw the feet of all bars side by side.
pub fn draw(
    bars: &[Outcome],
    beside: &[beside::Outcome],
    speed: f64,
    folder: &Path,
) -> Result<(), CaseError> {
    let title = format!("Copper bar, 10 mm x 70 mm, {speed} m/s: 260 µs after impact");
    let mut panels = Panels::new(4).title(title);
    // The quarter in three dimensions is for ParaView only.
    for bar in bars.iter().filter(|b| b.setup.space != Space::Quarter) {
        let half = bar.setup.space == Space::Axisymmetric || bar.setup.parts != Parts::Printed;
        let title = format!("{}, {} particles", bar.setup.name, bar.totals.particles);
        panels = panels.panel(title, foot(&bar.snapshot, Some(gaps(bar.setup.spacing())), half)?);
    }
    for outcome in beside.iter().filter(|b| b.bar.space != Space::Quarter) {
        let snapshot = &outcome.snapshot;
        let (size, what) = if outcome.method == points::NAME {
            (None, "cells")
        } else if snapshot.cells().is_some() {
            // Enlarge the elements, which are flat at the face.
            let size = |n: usize| 1.5 * snapshot.size_of(n);
            (Some(ParticleSize::Each((0..snapshot.len()).map(size).collect())), "elements")
        } else {
            (Some(gaps(snapshot.size_of(0))), "particles")
        };
        let title = format!("{}, {} {what}", outcome.name(), outcome.totals.particles);
        panels = panels.panel(title, foot(snapshot, size, true)?);
    }
    panels.compose()?.save(folder.join("bars.png"))?;
    Ok(())
}

/// Draw the feet of bars of converting elements, with enlarged elements and particles.
pub fn coupled(all: &[coupled::Outcome], folder: &Path) -> Result<(), CaseError> {
    let mut panels =
        Panels::new(4).title("Copper bar, 10 mm x 70 mm, 260 µs after impact: elements and particles");
    for outcome in all {
        let snapshot = &outcome.snapshot;
        let size = |n: usize| 1.3 * snapshot.size_of(n);
        let size = ParticleSize::Each((0..snapshot.len()).map(size).collect());
        panels = panels.panel(outcome.name(), foot(snapshot, Some(size), true)?);
    }
    panels.compose()?.save(folder.join("coupled.png"))?;
    Ok(())
}

/// Return particles as large as the gaps at the face, so that the matter looks closed.
fn gaps(spacing: f64) -> ParticleSize {
    ParticleSize::Uniform(1.7 * spacing)
}

/// Draw a foot by particles of the given size, or by its cells.
fn foot(snapshot: &Snapshot, size: Option<ParticleSize>, half: bool) -> Result<Picture, OutputError> {
    let strain =
        Quantity::scalar("plastic_strain").label("plastic strain").range(0.0, 2.0).map(ColourMap::Viridis);
    let s = match size {
        Some(size) => {
            Snapshot::new(2, snapshot.time(), snapshot.step(), snapshot.positions().to_vec(), size)?
                .with_scalar("plastic_strain", snapshot.scalar("plastic_strain")?.to_vec())?
        }
        None => snapshot.clone(),
    };
    let mut picture = FieldPicture::new(420, 560)
        .colour_by(strain)
        .bounds([-3.8 * RADIUS, -0.02 * LENGTH], [3.8 * RADIUS, 0.82 * LENGTH]);
    if half {
        picture = picture.mirrored([Mirror::x(0.0)]);
    }
    picture.draw(&s)
}
