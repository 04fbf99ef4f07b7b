//! Inertia of runs with scaled masses.

use impactite::scene::Solver;
use impactite_input::SceneFile;

/// Largest kinetic over internal energy of a slow process.
const SLOW: f64 = 0.05;

/// Report the kinetic over the internal energy at the end of a run with scaled masses; warn where inertia matters.
pub(crate) fn report(scene: &SceneFile, solver: &dyn Solver) {
    let Some(factor) = scene.mass_scaling else { return };
    let totals = solver.totals();
    let share = totals.kinetic_now() / totals.internal;
    if !share.is_finite() {
        return;
    }
    let said = format!(
        "with {} times the mass the kinetic energy is {:.2} % of the internal energy at the end",
        factor.value,
        100.0 * share
    );
    if share > SLOW {
        tracing::warn!(
            "{said}; above {} % inertia matters: take a smaller `mass_scaling`, or load more slowly",
            100.0 * SLOW
        );
    } else {
        tracing::info!("{said}");
    }
}
