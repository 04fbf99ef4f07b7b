//! Pictures of the bars.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{ColourMap, FieldPicture, Mirror, Panels, Picture, Quantity};
use mpm_core::output::{OutputError, ParticleSize, Snapshot};

use crate::mpm;
use crate::scene::{LENGTH, Outcome, Parts, RADIUS, Space};

/// Draw the feet of all bars side by side.
pub fn draw(bars: &[Outcome], beside: &[mpm::Outcome], folder: &Path) -> Result<(), CaseError> {
    let mut panels = Panels::new(4).title("Copper bar, 10 mm x 70 mm, 165 m/s: 260 µs after impact");
    // The quarter in space is for ParaView.
    for bar in bars.iter().filter(|b| b.setup.space != Space::Quarter) {
        let half = bar.setup.space == Space::Axisymmetric || bar.setup.parts != Parts::Printed;
        let title = format!("{}, {} particles", bar.setup.name, bar.totals.particles);
        panels = panels.panel(title, foot(&bar.snapshot, bar.setup.spacing(), half)?);
    }
    for bar in beside {
        let name = match bar.space {
            Space::PlaneStrain => "plane strain",
            Space::Axisymmetric | Space::Quarter => "axisymmetric",
        };
        let spacing = bar.snapshot.size_of(0);
        let title = format!("mpm, {name}, {} particles", bar.totals.particles);
        panels = panels.panel(title, foot(&bar.snapshot, spacing, true)?);
    }
    panels.compose()?.save(folder.join("bars.png"))?;
    Ok(())
}

fn foot(snapshot: &Snapshot, spacing: f64, half: bool) -> Result<Picture, OutputError> {
    let strain =
        Quantity::scalar("plastic_strain").label("plastic strain").range(0.0, 2.0).map(ColourMap::Viridis);
    // As large as the gaps at the face, so that matter looks closed.
    let size = ParticleSize::Uniform(1.7 * spacing);
    let s = Snapshot::new(2, snapshot.time(), snapshot.step(), snapshot.positions().to_vec(), size)?
        .with_scalar("plastic_strain", snapshot.scalar("plastic_strain")?.to_vec())?;
    let mut picture = FieldPicture::new(420, 560)
        .colour_by(strain)
        .bounds([-3.8 * RADIUS, -0.02 * LENGTH], [3.8 * RADIUS, 0.82 * LENGTH]);
    if half {
        picture = picture.mirrored([Mirror::x(0.0)]);
    }
    picture.draw(&s)
}
