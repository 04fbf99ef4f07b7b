//! Smoothed particles: errors within 2 % of the stored ones, and orders, limits and failures as in theory.

use verification::problems::smoothed::{By, Question, Trial, stored};
use verification::smoothed::Smoothed;
use verification::stored::{self as table, Runs, Stored, order, series};
use verification::{Case, Problem, fast};

const TOTAL: Smoothed = Smoothed::TotalLagrangian;
const UPDATED: Smoothed = Smoothed::Updated;

fn trials(question: Question) -> Runs<Trial> {
    table::judged(stored(question))
}

fn cases(problem: Problem) -> Runs<Case<Smoothed>> {
    table::judged(fast::smoothed().into_iter().filter(|case| case.problem == problem))
}

/// Measure over the grids of selected runs, coarse first, and its order.
fn over_grids<R: Stored>(runs: &Runs<R>, quantity: &str, pick: impl Fn(&R) -> bool) -> (Vec<f64>, f64) {
    let list = series(runs, quantity, pick);
    let order = order(&list);
    println!("{quantity}: order {order:.2}, {list:?}");
    (list.iter().map(|s| s.1).collect(), order)
}

/// Patch test: exact to round-off with corrected gradients on a disordered set; the original formulation has half the
/// strain at faces.
#[test]
fn linear_fields_are_strained_uniformly() {
    let runs = trials(Question::Patch);
    let spread = |by| over_grids(&runs, "spread", |trial| trial.by == by).0[0];
    for smoothed in Smoothed::ALL {
        assert!(spread(By::Charted(smoothed)) < 1e-13, "{smoothed:?}");
    }
    assert!(spread(By::Printed) > 0.3, "why are gradients corrected?");
}

/// Uniform stress at the axis: images beyond the axis leave the kernel's quadrature error on a lattice, 1.4 % everywhere. Corrected
/// gradients use no images, for energy conservation: errors are a quarter in the first two rows, and 3e-5 from the fourth on.
#[test]
fn a_uniform_stress_at_the_axis() {
    let runs = trials(Question::Axis);
    let of = |by, row: &str| over_grids(&runs, row, |trial| trial.by == by).0[0];
    for row in ["first row", "second row", "third row", "beyond"] {
        assert!(of(By::Printed, row) < 0.02, "{row}");
    }
    for smoothed in Smoothed::ALL {
        let by = By::Charted(smoothed);
        assert!(of(by, "first row") < 0.26 && of(by, "second row") < 0.26, "{smoothed:?}");
        assert!(of(by, "third row") < 0.08 && of(by, "beyond") < 0.02, "{smoothed:?}");
    }
    assert!(of(By::Charted(TOTAL), "beyond") < 1e-4);
}

/// Breathing modes: second order, errors within 0.3 % with 40 particles on the radius, and energy conserved to 1e-3 in two periods.
/// Balanced artificial stress dissipates 0.2 % of it.
#[test]
fn spheres_and_cylinders_breathe() {
    let total = |trial: &Trial| trial.by == By::Charted(TOTAL);
    for question in [Question::Sphere, Question::Eighth, Question::Cylinder] {
        let runs = trials(question);
        let (error, order) = over_grids(&runs, "frequency", total);
        assert!(over_grids(&runs, "energy", total).0.iter().all(|e| *e < 1e-3), "{question:?}");
        match question {
            // Grids of ten particles on the radius at most.
            Question::Eighth => assert!(error[2] < 0.04 && error[2] < error[0], "{error:?}"),
            Question::Sphere => assert!(error[2] < 3e-3 && order > 1.7, "{order} {error:?}"),
            _ => assert!(error.iter().all(|e| *e < 5e-4), "{question:?}: {error:?}"),
        }
    }
    let runs = trials(Question::Sphere);
    let bare = over_grids(&runs, "frequency", |trial| trial.by == By::Bare).0;
    assert!(bare[2] < 3e-3, "{bare:?}");
    let updated = over_grids(&runs, "energy", |trial| trial.by == By::Charted(UPDATED)).0;
    assert!(updated[2] < 2e-3 && updated[2] < updated[0], "artificial stress takes {updated:?}");
}

/// Lame's tube: first order of the hoop stress at the bore, within 1.5 % with 40 particles through the wall; bore displacement within
/// 0.2 %.
#[test]
fn a_tube_under_pressure() {
    let total = |trial: &Trial| trial.by == By::Charted(TOTAL);
    for question in [Question::Tube, Question::Quarter] {
        let runs = trials(question);
        let (hoop, order) = over_grids(&runs, "hoop", total);
        assert!(hoop[2] < 0.015 && order > 0.7, "{question:?}: {order} {hoop:?}");
        let bore = over_grids(&runs, "bore", total).0;
        assert!(bore[2] < 2e-3, "{question:?}: {bore:?}");
        let (profile, order) = over_grids(&runs, "profile", total);
        assert!(profile[2] < 5e-3 && order > 0.9, "{question:?}: {order} {profile:?}");
    }
}

/// CSM3: displacements within 3 % down and 6 % back with 12 particles through the beam, of second order.
#[test]
fn a_beam_swings_as_far_as_turek_and_hron_say() {
    let runs = trials(Question::Beam);
    for (quantity, allowed) in [("down", 0.03), ("back", 0.06)] {
        let (error, order) = over_grids(&runs, quantity, |_| true);
        assert!(error[2] < allowed && order > 1.8, "{quantity}: {order} {error:?}");
    }
}

/// V1, V3, V5, V7, V13 and V14 in the reference configuration: second order for smooth solutions, better than first order at rims cut
/// out of a lattice, first order at a shock.
#[test]
fn orders_of_the_v_problems() {
    for (problem, quantity, least, finest) in [
        (Problem::Bar, "period", 1.8, 3e-4),
        (Problem::Axes, "u", 1.9, 5e-3),
        (Problem::Axes, "stress", 1.9, 9e-3),
        (Problem::Axes3, "u", 1.8, 0.05),
        (Problem::Ring, "u", 1.2, 1.2e-3),
        (Problem::Ring, "u largest", 1.0, 1e-2),
        (Problem::Pulse, "v", 1.9, 5e-4),
        (Problem::Sod, "density", 0.95, 2e-3),
        (Problem::Column, "stress", 1.5, 1e-3),
    ] {
        let runs = cases(problem);
        let (error, order) = over_grids(&runs, quantity, |case| case.scheme == TOTAL);
        assert!(order >= least && error[2] < finest, "{}: {order} {error:?}", problem.name());
    }
}

/// V4: the reference configuration tolerates shears of 7. The body force jumps at the rims of the annulus, which lattice particles
/// sample unevenly: no order.
#[test]
fn v4_vortex() {
    let error = over_grids(&cases(Problem::Vortex), "u", |_| true).0;
    assert!(error[2] < 0.04 && error[2] < 0.5 * error[0], "{error:?}");
}

/// V2 and V6: energy of a drifting bar conserved to 1e-6, and angular momentum of a rotating disc to round-off. Artificial stress
/// dissipates most of the first and half a per cent of the second.
#[test]
fn what_is_kept() {
    let of = |runs: &Runs<Case<Smoothed>>, quantity: &str, scheme| {
        over_grids(runs, quantity, |case| case.scheme == scheme).0[0]
    };
    let drift = cases(Problem::Drift);
    assert!(of(&drift, "energy", TOTAL) < 1e-6 && of(&drift, "energy", UPDATED) > 0.1);
    let turn = cases(Problem::Turn);
    assert!(of(&turn, "spin", TOTAL) < 1e-9 && of(&turn, "stress", TOTAL) < 1e-3);
    assert!(of(&turn, "spin", UPDATED) < 0.01);
}
