//! Periodic planes: waves and bodies that cross them.

use super::*;
use mpm_core::{
    Aflip, Apic, CpGimp, Flip, FullSpace, Linear, Method, Musl, PlaneStrain, QuadraticBSpline, Usl,
};

/// Cells of 1/64 m: coordinates are exact.
const H: f64 = 1.0 / 64.0;

fn methods() -> Vec<Made> {
    vec![
        (
            "linear shape functions",
            Box::new(|l| Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(l))),
        ),
        (
            "splines",
            Box::new(|l| Mpm::new(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), BlockGrid::new(l))),
        ),
        (
            "affine",
            Box::new(|l| {
                Mpm::new(Method::new(QuadraticBSpline, Aflip::default(), Usl, PlaneStrain), BlockGrid::new(l))
            }),
        ),
        ("domains", Box::new(|l| Mpm::new(Method::new(CpGimp, Flip, Musl, PlaneStrain), BlockGrid::new(l)))),
    ]
}

fn periodic(axis: usize, low: f64, high: f64) -> Boundary<2> {
    Boundary::Periodic { axis, low, high }
}

#[test]
fn a_standing_shear_wave_has_its_frequency() {
    // v_y = A sin(k x) cos(c_s k t): the first zero after a quarter of a period.
    for (name, make) in methods() {
        let (lattice, seeds) = block([0.0, 0.0], [1.0, 4.0 * H], H);
        let mut mpm = make(lattice);
        mpm.bound(periodic(0, 0.0, 1.0)).expect("periodic");
        mpm.bound(periodic(1, 0.0, 4.0 * H)).expect("periodic");
        let k = 2.0 * std::f64::consts::PI;
        mpm.add("wave", law(), &seeds, |x| [0.0, 1e-3 * (k * x[0]).sin()]).expect("wave");
        let exact = 0.5 * std::f64::consts::PI / (shear() * k);
        let amplitude = |mpm: &Mpm<2>| {
            let points = mpm.bodies()[0].points();
            points.iter().map(|p| p.velocity[1] * (k * p.position[0]).sin()).sum::<f64>()
        };
        let dt = exact / 80.0;
        mpm.set_time_control(TimeControl::Fixed(dt)).expect("step");
        let mut last = (0.0, amplitude(&mpm));
        // Five quarters further, to measure the frequency without the start.
        let mut zeros = Vec::new();
        for _ in 0..480 {
            mpm.step().expect("a step");
            let now = (mpm.time(), amplitude(&mpm));
            if now.1 * last.1 <= 0.0 {
                zeros.push(last.0 + (now.0 - last.0) * last.1 / (last.1 - now.1));
            }
            last = now;
        }
        let quarter = (zeros[2] - zeros[0]) / 4.0;
        println!(
            "{name}: quarter period {quarter:.6e}, exact {exact:.6e}, error {:.2e}",
            quarter / exact - 1.0
        );
        assert!((quarter / exact - 1.0).abs() < 2e-3, "{name}: {quarter} s, exact {exact} s");
        let account = mpm.account();
        assert!(account.missing() < 1e-13 * account.momentum_scale, "{name}: {}", account.missing());
        assert!(mpm.exchange().impulse == [0.0; 3], "no plane pushes");
    }
}

/// Run a finite block that flies and vibrates, in a periodic box from `low` if there is one.
fn flight(make: &dyn Fn(Lattice<2>) -> Mpm<2>, low: Option<f64>, threads: usize) -> Mpm<2> {
    let (lattice, seeds) = block([6.0 * H, 0.0], [12.0 * H, 5.0 * H], H);
    let mut mpm = make(lattice);
    if let Some(low) = low {
        mpm.bound(periodic(0, low, low + 16.0 * H)).expect("periodic");
    }
    mpm.set_team(impactite_simd::Team::new(threads).expect("threads"));
    let shake = |x: f64, y: f64| 0.3 * ((40.0 * x).sin() + (70.0 * y).cos());
    mpm.add("block", law(), &seeds, |x| [9.0 + shake(x[0], x[1]), shake(x[1], x[0])]).expect("block");
    mpm.set_time_control(TimeControl::Fixed(0.25 * H / longitudinal())).expect("step");
    for _ in 0..240 {
        mpm.step().expect("a step");
    }
    mpm
}

#[test]
fn a_block_goes_through_the_planes_unchanged() {
    for (name, make) in methods() {
        let free = flight(&*make, None, 1);
        let flown =
            free.bodies()[0].points().iter().map(|p| p.position[0]).sum::<f64>() / free.particles() as f64;
        // The whole block has crossed the plane at 16 h.
        assert!(flown > 16.0 * H + 3.0 * H, "{name}: flew to {flown}");
        for (low, threads) in [(0.0, 1), (4.0 * H, 2), (-3.0 * H, 3), (0.0, 4)] {
            let through = flight(&*make, Some(low), threads);
            assert!(bits(&free) == bits(&through), "{name}: a box from {low} with {threads} threads");
            let (a, b) = (free.totals(), through.totals());
            assert!((a.kinetic / b.kinetic - 1.0).abs() < 1e-14 && a.particles == b.particles);
        }
    }
}

#[test]
fn a_wave_passes_the_planes_as_the_middle() {
    for (name, make) in methods() {
        let run = |middle: f64| {
            let (lattice, seeds) = block([0.0, 0.0], [32.0 * H, 4.0 * H], H);
            let mut mpm = make(lattice);
            mpm.bound(periodic(0, 0.0, 32.0 * H)).expect("periodic");
            mpm.bound(periodic(1, 0.0, 4.0 * H)).expect("periodic");
            // Distance to the middle around the periodic box.
            let way = |x: f64| (x - middle + 48.0 * H).rem_euclid(32.0 * H) - 16.0 * H;
            mpm.add("wave", law(), &seeds, |x| [0.1 * (-(way(x[0]) / (4.0 * H)).powi(2)).exp(), 0.0])
                .expect("wave");
            mpm.set_time_control(TimeControl::Fixed(0.25 * H / longitudinal())).expect("step");
            for _ in 0..100 {
                mpm.step().expect("a step");
            }
            let mut points = mpm.bodies()[0].points();
            for p in &mut points {
                p.position[0] = way(p.position[0]);
            }
            points.sort_by(|a, b| {
                a.position[0].total_cmp(&b.position[0]).then(a.position[1].total_cmp(&b.position[1]))
            });
            points.iter().map(|p| (p.velocity, p.stress)).collect::<Vec<_>>()
        };
        let (middle, plane) = (run(16.0 * H), run(0.0));
        let same = middle.iter().zip(&plane).filter(|(a, b)| a == b).count();
        println!("{name}: {same} of {} particles the same", middle.len());
        // In bins around a node on the plane, particles and therefore their sums have another order.
        assert!(name != "linear shape functions" || same == middle.len(), "{name}");
        for (a, b) in middle.iter().zip(&plane) {
            let off = (0..3).map(|d| (a.0[d] - b.0[d]).abs()).fold(0.0, f64::max);
            let force = (0..6).map(|d| (a.1[d] - b.1[d]).abs()).fold(0.0, f64::max);
            assert!(
                off < 1e-12 * 0.1 && force < 1e-12 * 0.1 * DENSITY * longitudinal(),
                "{name}: {off} {force}"
            );
        }
    }
}

#[test]
fn a_box_that_shears_keeps_its_shear() {
    // All three axes, one of them two blocks wide: v_x is periodic in z alone, v_y and v_z are uniform; nothing
    // breaks the symmetry.
    let (lattice, seeds) = block([0.0; 3], [4.0 * H, 4.0 * H, 8.0 * H], H);
    let mut mpm = Mpm::new(Method::contact_at_rest(FullSpace), BlockGrid::new(lattice));
    for (axis, cells) in [4.0, 4.0, 8.0].into_iter().enumerate() {
        mpm.bound(Boundary::Periodic { axis, low: 0.0, high: cells * H }).expect("periodic");
    }
    let k = 2.0 * std::f64::consts::PI / (8.0 * H);
    mpm.add("box", law(), &seeds, |x| [5.0 + 0.1 * (k * x[2]).sin(), 3.0, -4.0]).expect("box");
    let before = mpm.totals();
    mpm.run_until(0.02).expect("a run");
    let (after, account) = (mpm.totals(), mpm.account());
    for d in 0..3 {
        let off = (after.momentum[d] - before.momentum[d]).abs();
        assert!(off < 1e-13 * before.momentum_scale, "momentum along {d} off by {off}");
    }
    assert!(account.energy_error().abs() < 1e-2, "{}", account.energy_error());
    assert_eq!(after.particles, before.particles);
    // Diagnostics include nodes across the planes, too: every node has the mass of a cell full of material.
    let mut nodes = std::collections::HashMap::new();
    mpm.for_each_footprint(&mut |p| {
        p.nodes.iter().for_each(|w| *nodes.entry(w.node).or_insert(0.0) += w.value * p.mass);
    });
    assert_eq!(nodes.len(), 4 * 4 * 8);
    assert!(nodes.values().all(|m| (m / (DENSITY * H.powi(3)) - 1.0).abs() < 0.2));
}

#[test]
fn planes_that_cannot_be_are_refused() {
    let (lattice, seeds) = block([0.0, 0.0], [8.0 * H, 4.0 * H], H);
    let empty = || Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    let refused = |mut mpm: Mpm<2>, boundary| mpm.bound(boundary).expect_err("planes").to_string();
    let message = |why: &str| format!("periodic planes across axis 0 are not allowed {why}");
    assert_eq!(
        refused(empty(), periodic(0, 0.0, 6.0 * H)),
        message("at this distance; it must be a whole number of blocks of four cells")
    );
    let off = refused(empty(), periodic(0, 0.5 * H, 4.5 * H));
    assert!(off.starts_with("lower periodic plane at = 0.0078125 m is not allowed"), "{off}");
    let mut walled = empty();
    walled.bound(Boundary::Fixed { axis: 0, at: 0.0, side: Side::Above }).expect("plane");
    assert_eq!(
        refused(walled, periodic(0, 0.0, 8.0 * H)),
        message("beside another plane across it; there must be no other")
    );
    let mut filled = empty();
    filled.add("block", law(), &seeds, |_| [0.0; 2]).expect("block");
    assert_eq!(
        refused(filled, periodic(0, 0.0, 8.0 * H)),
        message("once there are bodies; they must be given before")
    );
    let mut small = empty();
    small.bound(periodic(0, 0.0, 4.0 * H)).expect("periodic");
    let outside = small.add("block", law(), &seeds, |_| [0.0; 2]).expect_err("outside").to_string();
    assert!(outside.contains("between the periodic planes"), "{outside}");
}
