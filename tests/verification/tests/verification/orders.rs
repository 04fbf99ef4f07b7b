//! Material point cases: errors within 2 % of the stored ones, and orders, limits and failures as in theory.

use verification::stored::{self, Runs, order, series};
use verification::{Case, Kernel, Problem, Scheme, Velocity, fast};

/// Run a problem's cases, print them and compare them with the table.
fn judged(problem: Problem) -> Runs {
    stored::judged(fast::cases().into_iter().filter(|case| case.problem == problem))
}

/// Order of convergence of a scheme over its (at least three) grids.
fn order_of(runs: &Runs, scheme: Scheme, quantity: &str, pick: impl Fn(&Case) -> bool) -> f64 {
    let list = series(runs, quantity, |case| case.scheme == scheme && pick(case));
    assert!(list.len() >= 3, "{}: {} grids", scheme.name(), list.len());
    let order = order(&list);
    println!("{} {quantity}: order {order:.2}, {list:?}", scheme.name());
    order
}

fn value(runs: &Runs, scheme: Scheme, cells: usize, quantity: &str) -> f64 {
    let run = runs.iter().find(|(case, _)| case.scheme == scheme && case.cells == cells);
    run.map_or(f64::NAN, |(_, outcome)| outcome.get(quantity))
}

fn stops(runs: &Runs, scheme: Scheme) -> bool {
    runs.iter().any(|(case, outcome)| case.scheme == scheme && outcome.failure.is_some())
}

/// V1: period errors at 20 cells per half wave as predicted (book, "Properties of stress updates and transfers", finding 9), of second
/// order in the cell size.
#[test]
fn v1_period_of_a_bar() {
    let runs = judged(Problem::Bar);
    let predicted = [
        (Kernel::Linear, Velocity::FlipMusl, 3.3e-3),
        (Kernel::Gimp, Velocity::FlipMusl, 3.3e-3),
        (Kernel::Quadratic, Velocity::FlipMusl, 6.4e-3),
        (Kernel::Cubic, Velocity::FlipMusl, 8.2e-3),
        (Kernel::Quadratic, Velocity::ApicUsl, 3.2e-3),
        (Kernel::Cubic, Velocity::ApicUsl, 4.1e-3),
    ];
    for (kernel, velocity, wanted) in predicted {
        let scheme = Scheme::moving(kernel, velocity);
        let found = value(&runs, scheme, 10, "period");
        assert!((found / wanted - 1.0).abs() < 0.25, "{}: {found} for {wanted}", scheme.name());
    }
    for kernel in [Kernel::Quadratic, Kernel::Cubic] {
        let scheme = Scheme::moving(kernel, Velocity::Fmpm4Usl);
        let found = value(&runs, scheme, 10, "period");
        assert!(found.abs() < 2e-4, "{}: {found}", scheme.name());
    }
    for scheme in Scheme::all() {
        let order = order_of(&runs, scheme, "period", |_| true);
        assert!((order - 2.0).abs() < 0.15, "{}: order {order}", scheme.name());
    }
}

/// V2: after ten periods of drifting through cells the energy is conserved to 5 % (FMPM: 10 %), and to 0.1 % by a
/// scheme without dissipation and cell crossing. Linear shape functions with USL, whose step limit vanishes in
/// almost empty cells, fail.
#[test]
fn v2_energy_of_a_drifting_bar() {
    let runs = judged(Problem::Drift);
    for scheme in Scheme::all() {
        if scheme.kernel == Kernel::Linear && !scheme.total {
            continue;
        }
        let found = value(&runs, scheme, 20, "energy");
        let allowed = if scheme.velocity == Velocity::Fmpm4Usl { 0.10 } else { 0.05 };
        assert!(found.abs() < allowed, "{}: {found}", scheme.name());
        if scheme.total && scheme.velocity == Velocity::FlipMusl {
            assert!(found.abs() < 1e-3, "{}: {found}", scheme.name());
        }
    }
    assert!(stops(&runs, Scheme::moving(Kernel::Linear, Velocity::FlipUsl)));
    assert!(stops(&runs, Scheme::moving(Kernel::Linear, Velocity::Fmpm4Usl)));
}

/// V3: order 2 for tiling domains, none for cell-crossing particles with two per axis; errors of linear shape functions grow.
#[test]
fn v3_axis_aligned_strain() {
    let runs = judged(Problem::Axes);
    let usual = |case: &Case| case.courant == 0.2;
    for scheme in Scheme::all() {
        let order = order_of(&runs, scheme, "u", usual);
        match (scheme.total, scheme.kernel) {
            (true, _) | (_, Kernel::CpGimp | Kernel::Cpdi | Kernel::Cpdi2) => {
                assert!(order >= 1.8, "{}: order {order}", scheme.name())
            }
            (_, Kernel::Linear) => assert!(order < -0.5, "{}: order {order}", scheme.name()),
            (_, Kernel::Gimp | Kernel::Quadratic) => assert!(order < 1.0, "{}: order {order}", scheme.name()),
            _ => {}
        }
    }
    // Stress: first order for linear shape functions, second for splines.
    for (kernel, least) in [(Kernel::Linear, 0.95), (Kernel::Quadratic, 1.9), (Kernel::Cubic, 1.9)] {
        let scheme = Scheme::total(kernel, Velocity::FlipMusl);
        let order = order_of(&runs, scheme, "stress", usual);
        assert!(order >= least, "{}: order {order}", scheme.name());
    }
    // Without the lumped-mass error a cubic spline is of fourth order in space.
    let sharp = Scheme::total(Kernel::Cubic, Velocity::Fmpm4Usl);
    let order = order_of(&runs, sharp, "u", |case| !usual(case));
    assert!(order >= 2.5, "{}: order {order}", sharp.name());
}

/// V3 in three dimensions.
#[test]
fn v3_axis_aligned_strain_in_space() {
    let runs = judged(Problem::Axes3);
    for scheme in verification::formulation::solid_schemes() {
        let order = order_of(&runs, scheme, "u", |_| true);
        assert!(order >= 1.8, "{}: order {order}", scheme.name());
    }
}

/// V4: runs complete in the reference configuration, where shears of 7 cause no fracture, and with CPDI. There the order is
/// 1.5 or more, with errors of 2 % on 64 cells with three particles per axis (four with CPDI), except for the cubic spline
/// with APIC, which dissipates most.
#[test]
fn v4_vortex() {
    let runs = judged(Problem::Vortex);
    for kernel in [Kernel::Quadratic, Kernel::Cubic] {
        for velocity in Velocity::ALL {
            let scheme = Scheme::total(kernel, velocity);
            let order = order_of(&runs, scheme, "u", |_| true);
            let damped = scheme == Scheme::total(Kernel::Cubic, Velocity::ApicUsl);
            assert!(order >= if damped { 1.0 } else { 1.5 }, "{}: order {order}", scheme.name());
        }
    }
    let convected = [Kernel::Cpdi, Kernel::Cpdi2].map(|kernel| Scheme::moving(kernel, Velocity::FlipUsl));
    for scheme in convected {
        let order = order_of(&runs, scheme, "u", |_| true);
        assert!(order >= 1.5, "{}: order {order}", scheme.name());
    }
    for scheme in [
        Scheme::total(Kernel::Quadratic, Velocity::FlipUsl),
        Scheme::total(Kernel::Quadratic, Velocity::Fmpm4Usl),
        Scheme::total(Kernel::Cubic, Velocity::Fmpm4Usl),
    ]
    .into_iter()
    .chain(convected)
    {
        let error = value(&runs, scheme, 64, "u");
        assert!(error <= 0.02, "{}: {error}", scheme.name());
    }
    for kernel in [Kernel::CpGimp, Kernel::Quadratic] {
        let order = order_of(&runs, Scheme::moving(kernel, Velocity::ApicUsl), "u", |_| true);
        assert!(order < 0.5, "{kernel:?}: order {order}");
    }
}

/// V5: better than first order in the mean in the reference configuration, and first order within 0.15 for the
/// worst particle: the rims are cut out of a lattice.
#[test]
fn v5_expanding_ring() {
    let runs = judged(Problem::Ring);
    for kernel in [Kernel::Linear, Kernel::Quadratic, Kernel::Cubic] {
        for velocity in [Velocity::FlipUsl, Velocity::FlipMusl, Velocity::ApicUsl] {
            let scheme = Scheme::total(kernel, velocity);
            if !scheme.is_legal() {
                continue;
            }
            let order = order_of(&runs, scheme, "u", |_| true);
            assert!(order >= 1.0, "{}: order {order}", scheme.name());
            let worst = order_of(&runs, scheme, "u largest", |_| true);
            assert!(worst >= 0.85, "{}: order {worst} of the largest", scheme.name());
        }
    }
}

/// V6: translation at any speed causes no stress with schemes that are stable in almost empty cells; linear shape functions
/// with USL are not.
#[test]
fn v6_flight() {
    let runs = judged(Problem::Flight);
    for scheme in Scheme::all() {
        let stress = value(&runs, scheme, 20, "stress");
        let unsafe_in_empty_cells =
            scheme.kernel == Kernel::Linear && !scheme.total && scheme.velocity != Velocity::FlipMusl;
        if unsafe_in_empty_cells {
            assert!(stress.is_nan() || stress > 1e-13, "{}: {stress}", scheme.name());
        } else {
            // Tolerance: 222 steps of round-off of velocities of 0.3 over cells of 1.
            assert!(stress <= 1e-13, "{}: {stress}", scheme.name());
        }
    }
}

/// V6: rotation. The angular momentum of APIC particles is conserved to 1e-3 (with that of the affine matrices it
/// is exact: `tests/tests/step/conformance.rs`), in both configurations. FMPM(4) dissipates most of it for a disc
/// of four cells.
#[test]
fn v6_turn() {
    let runs = judged(Problem::Turn);
    for total in [false, true] {
        for kernel in [Kernel::Quadratic, Kernel::Cubic] {
            let scheme = Scheme { kernel, velocity: Velocity::ApicUsl, total };
            let spin = value(&runs, scheme, 4, "spin");
            let stress = value(&runs, scheme, 4, "stress");
            assert!(spin <= 1e-3 && stress <= 1e-3, "{}: spin {spin}, stress {stress}", scheme.name());
            let filtered = value(&runs, Scheme { velocity: Velocity::Fmpm4Usl, ..scheme }, 4, "spin");
            assert!(filtered > 0.5, "{kernel:?}: FMPM(4) lost {filtered} alone; what the notes say is old");
        }
    }
}

/// V7: velocity pulse, second order.
#[test]
fn v7_pulse() {
    let runs = judged(Problem::Pulse);
    for scheme in Scheme::all() {
        let order = order_of(&runs, scheme, "v", |_| true);
        assert!(order >= 1.8, "{}: order {order}", scheme.name());
    }
}

/// V13: Sod. A shock permits first order; with two particles per axis only the cubic spline attains it.
#[test]
fn v13_shock_tube() {
    let runs = judged(Problem::Sod);
    let cubic = Scheme::moving(Kernel::Cubic, Velocity::ApicUsl);
    let order = order_of(&runs, cubic, "density", |_| true);
    assert!(order >= 0.7, "order {order}");
    let (pressure, overshoot) = (value(&runs, cubic, 400, "pressure"), value(&runs, cubic, 400, "overshoot"));
    assert!(pressure.abs() < 0.01, "plateau {pressure}");
    assert!(overshoot < 0.03, "overshoot {overshoot}");
}

/// V13 without bulk viscosity: the same plateau with more overshoot.
#[test]
fn v13_shock_tube_without_viscosity() {
    let runs = judged(Problem::SodBare);
    let overshoot = value(&runs, Scheme::moving(Kernel::Cubic, Velocity::ApicUsl), 400, "overshoot");
    assert!(overshoot > 0.1, "overshoot {overshoot}: what is bulk viscosity for?");
}

/// V14: order 0.9 over four grids for tiling domains.
#[test]
fn v14_column() {
    let runs = judged(Problem::Column);
    for scheme in Scheme::all() {
        let used = scheme.velocity == Velocity::FlipMusl || scheme.velocity == Velocity::ApicUsl;
        if used && (scheme.total || scheme.kernel == Kernel::CpGimp) {
            let list = series(&runs, "stress", |case| case.scheme == scheme);
            assert_eq!(list.len(), 4, "{list:?}");
            let order = order_of(&runs, scheme, "stress", |_| true);
            assert!(order >= 0.9, "{}: order {order}", scheme.name());
        }
    }
}

/// V22: vortices decay with viscosity as predicted, within 5 % on 32 cells.
#[test]
fn v22_taylor_green_vortices() {
    let runs = judged(Problem::TaylorGreen);
    for scheme in verification::problems::gas::vortices_schemes() {
        let left = value(&runs, scheme, 32, "left");
        assert!(left.abs() < 0.05, "{}: {left}", scheme.name());
    }
}
