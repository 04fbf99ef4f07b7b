//! Points on cells of each size.

use impactite::scene::Solver;

/// Report the points on cells of each size at the end of a run; warn if a scene with a range of cells used its largest ones alone.
pub(crate) fn report(solver: &dyn Solver) {
    let cells = solver.points_by_cell();
    let [(largest, _), smaller @ ..] = &cells[..] else { return };
    if smaller.is_empty() {
        return;
    }
    if smaller.iter().all(|(_, points)| *points == 0) {
        tracing::warn!(
            "all points are on cells of {largest:.3e} m at the end: with a range of cells, none came within four of its cells of a wall or of another body; with \
             regions, none is in one (`method.mpm.refine`)"
        );
        return;
    }
    let listed: Vec<String> =
        cells.iter().map(|(size, points)| format!("{points} on cells of {size:.3e} m")).collect();
    tracing::info!("points at the end: {}", listed.join(", "));
}
