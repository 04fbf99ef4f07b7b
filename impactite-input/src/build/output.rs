//! Checks of the section `output` against the scene, before a run creates files.

use impactite::output::picture::Quantity;
use impactite::scene::{Solver, snapshot_fields};

use super::wrong::{At, Made, known, wrong};
use crate::model::condition::Condition;
use crate::model::output::Mirror;
use crate::model::{SceneFile, Space};

/// Refuse invalid intervals, fields, windows and mirrors.
pub(super) fn check(scene: &SceneFile, solver: &dyn Solver) -> Made<()> {
    let output = &scene.output;
    let intervals =
        [("histories", output.histories), ("pictures", output.pictures), ("frames", output.frames)];
    for (name, interval) in intervals {
        let Some(interval) = interval.map(|q| q.value) else { continue };
        // An interval longer than the run yields its first and last state.
        if interval <= 0.0 {
            return wrong(
                format!("output.{name}"),
                format!("{interval} s is not allowed; it must be positive"),
            );
        }
    }
    let fields = snapshot_fields(&solver.bodies());
    if let Some(names) = &output.fields {
        for (n, name) in names.iter().enumerate() {
            if names[..n].contains(name) {
                return wrong(format!("output.fields[{n}]"), format!("`{name}` is listed twice"));
            }
            let there = fields.iter().map(|(name, _)| name.as_str()).chain(["displacement"]);
            known(&format!("output.fields[{n}]"), "field", name, there)?;
        }
    }
    if let Some(colour) = &output.colour {
        let names = Quantity::names(fields.iter().map(|(name, kind)| (name.as_str(), *kind)));
        known("output.colour.field", "field", &colour.field, names.iter().map(String::as_str))?;
        if let Some([low, high]) = colour.range.map(|range| range.map(|q| q.value))
            && low >= high
        {
            return wrong("output.colour.range", format!("[{low}, {high}] is not allowed; it must rise"));
        }
    }
    if let Some(from) = output.seen_from {
        if scene.space != Space::Full {
            return wrong(
                "output.seen_from",
                "is for scenes in `3d`; pictures of a plane show x to the right",
            );
        }
        if from.iter().all(|q| q.value == 0.0) {
            return wrong("output.seen_from", "[0, 0, 0] is not allowed; it must be a direction");
        }
    }
    if let Mirror::Axes(axes) = &output.mirror {
        for (n, axis) in axes.iter().enumerate() {
            let key = format!("output.mirror[{n}]");
            scene.space.axis(*axis).at(&key)?;
            let is_across = |c: &Condition| matches!(c, Condition::Symmetry(plane) if plane.axis == *axis);
            if axes[..n].contains(axis) {
                return wrong(key, format!("`{}` is listed twice", axis.name()));
            }
            if !scene.conditions.iter().any(is_across) {
                return wrong(key, format!("no plane of symmetry is across the axis {}", axis.name()));
            }
        }
    }
    if let Some(window) = &output.window {
        let dimensions = scene.space.dimensions();
        for (key, corner) in [("from", &window.from), ("to", &window.to)] {
            if corner.len() != dimensions {
                let message =
                    format!("has {} components; the scene has {dimensions} dimensions", corner.len());
                return wrong(format!("output.window.{key}"), message);
            }
        }
        let mut axes = window.from.iter().zip(&window.to);
        if let Some(n) = axes.position(|(from, to)| from.value >= to.value) {
            let (from, to) = (window.from[n].value, window.to[n].value);
            return wrong(
                format!("output.window.to[{n}]"),
                format!("{to} m is not allowed; it must be above `from`, {from} m"),
            );
        }
    }
    Ok(())
}
