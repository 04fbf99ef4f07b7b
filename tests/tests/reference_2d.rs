//! Comparison of the fast step with the plain reference within round-off: two dimensions.

use impactite_tests::compare::{compare, plain, run_both, surround};
use impactite_tests::reference::{Order, Rule};
use impactite_tests::scene::{self, metal, rubber, wave_speed};
use mpm_core::{
    Aflip, Apic, Axisymmetric, Blend, BlockGrid, BoundaryModified, CpGimp, Cpdi, Cpdi2, CubicBSpline, Flip,
    Fmpm, Gimp, Linear, Method, Mls, Mpm, Musl, Pic, PlaneStrain, QuadraticBSpline, Usf, Usl,
};

/// Allowed difference after 30 to 40 steps. Round-off of one step is 1e-16 times a few hundred operations;
/// it grows with the number of steps and with the ratio of the smallest to the largest nodal mass.
const TOLERANCE: f64 = 1e-11;

macro_rules! table {
    ($($name:ident: $shape:expr, $transfer:expr, $rule:expr, $order:ident, $space:ident, $(.$compiled:ident(),)? [$($scene:expr),*], $law:expr;)*) => {$(
        #[test]
        fn $name() {
            let method = Method::new($shape, $transfer, $order, $space)$(.$compiled())?;
            $(
                let scene = $scene;
                let found = compare(method, $shape, $rule, Order::$order, &scene, &$law);
                println!("{}: {found:?}", scene.name);
                assert!(found.worst() < TOLERANCE, "{}: {found:?}", scene.name);
            )*
        }
    )*};
}

fn tau() -> Blend<f64> {
    Blend::new(0.3).expect("time constant")
}

table! {
    linear_flip_musl: Linear, Flip, Rule::Flip, Musl, PlaneStrain, [scene::flow(), scene::slide(), scene::bar(), scene::train(), scene::collision()], rubber();
    quadratic_mls_usl: QuadraticBSpline, Mls, Rule::Mls, Usl, PlaneStrain, [scene::flow(), scene::slide(), scene::bar(), scene::collision()], rubber();
    modified_quadratic_flip_usl: BoundaryModified(QuadraticBSpline), Flip, Rule::Flip, Usl, PlaneStrain, .compiled(), [scene::flow(), scene::bar(), scene::collision()], rubber();
    linear_flip_usf: Linear, Flip, Rule::Flip, Usf, PlaneStrain, .compiled(), [scene::flow(), scene::slide(), scene::bar()], metal();
    linear_blend_musl: Linear, tau(), Rule::Blend(0.3), Musl, PlaneStrain, [scene::flow(), scene::slide(), scene::bar()], metal();
    gimp_flip_usl: Gimp, Flip, Rule::Flip, Usl, PlaneStrain, .compiled(), [scene::flow(), scene::bar(), scene::collision()], metal();
    gimp_flip_musl: Gimp, Flip, Rule::Flip, Musl, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], rubber();
    gimp_fmpm3_usl: Gimp, Fmpm::<3>, Rule::Fmpm(3), Usl, PlaneStrain, .compiled(), [scene::flow(), scene::slide(), scene::bar(), scene::collision()], rubber();
    cpgimp_flip_usl: CpGimp, Flip, Rule::Flip, Usl, PlaneStrain, .compiled(), [scene::flow(), scene::bar(), scene::collision()], rubber();
    cpgimp_flip_musl: CpGimp, Flip, Rule::Flip, Musl, PlaneStrain, [scene::flow(), scene::bar()], metal();
    cpgimp_flip_usf: CpGimp, Flip, Rule::Flip, Usf, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], metal();
    cpgimp_apic_usl: CpGimp, Apic, Rule::Apic, Usl, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], rubber();
    cpdi_flip_musl: Cpdi, Flip, Rule::Flip, Musl, PlaneStrain, .compiled(), [scene::flow(), scene::bar(), scene::collision()], rubber();
    cpdi_flip_usf: Cpdi, Flip, Rule::Flip, Usf, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], metal();
    cpdi_fmpm2_usl: Cpdi, Fmpm::<2>, Rule::Fmpm(2), Usl, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], rubber();
    cpdi2_flip_usl: Cpdi2, Flip, Rule::Flip, Usl, PlaneStrain, .compiled(), [scene::flow(), scene::bar(), scene::collision()], rubber();
    cpdi2_flip_musl: Cpdi2, Flip, Rule::Flip, Musl, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], metal();
    quadratic_flip_usf: QuadraticBSpline, Flip, Rule::Flip, Usf, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], rubber();
    quadratic_flip_musl: QuadraticBSpline, Flip, Rule::Flip, Musl, PlaneStrain, [scene::flow(), scene::slide(), scene::bar()], rubber();
    quadratic_apic_usl: QuadraticBSpline, Apic, Rule::Apic, Usl, PlaneStrain, [scene::flow(), scene::slide(), scene::bar(), scene::collision()], rubber();
    quadratic_aflip_usl: QuadraticBSpline, Aflip::default(), Rule::Aflip(0.01), Usl, PlaneStrain, [scene::flow(), scene::slide(), scene::bar(), scene::collision()], metal();
    quadratic_apic_usf: QuadraticBSpline, Apic, Rule::Apic, Usf, PlaneStrain, .compiled(), [scene::flow(), scene::slide(), scene::bar()], rubber();
    quadratic_pic_usl: QuadraticBSpline, Pic, Rule::Pic, Usl, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], metal();
    quadratic_fmpm2_usl: QuadraticBSpline, Fmpm::<2>, Rule::Fmpm(2), Usl, PlaneStrain, .compiled(), [scene::flow(), scene::bar(), scene::train()], rubber();
    quadratic_fmpm2_usf: QuadraticBSpline, Fmpm::<2>, Rule::Fmpm(2), Usf, PlaneStrain, .compiled(), [scene::flow(), scene::slide(), scene::bar()], rubber();
    cubic_flip_musl: CubicBSpline, Flip, Rule::Flip, Musl, PlaneStrain, .compiled(), [scene::flow(), scene::slide(), scene::bar(), scene::collision()], rubber();
    cubic_apic_usl: CubicBSpline, Apic, Rule::Apic, Usl, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], rubber();

    axisymmetric_linear_flip_musl: Linear, Flip, Rule::Flip, Musl, Axisymmetric, [scene::cylinder()], rubber();
    axisymmetric_modified_gimp_flip_musl: BoundaryModified(Gimp), Flip, Rule::Flip, Musl, Axisymmetric, .compiled(), [scene::cylinder()], rubber();
    axisymmetric_cpgimp_flip_usl: CpGimp, Flip, Rule::Flip, Usl, Axisymmetric, .compiled(), [scene::cylinder()], metal();
    axisymmetric_cpdi2_flip_musl: Cpdi2, Flip, Rule::Flip, Musl, Axisymmetric, .compiled(), [scene::cylinder()], metal();
    axisymmetric_quadratic_apic_usl: QuadraticBSpline, Apic, Rule::Apic, Usl, Axisymmetric, [scene::cylinder()], rubber();
    axisymmetric_quadratic_aflip_usl: QuadraticBSpline, Aflip::default(), Rule::Aflip(0.01), Usl, Axisymmetric, [scene::cylinder()], rubber();
    axisymmetric_quadratic_flip_usf: QuadraticBSpline, Flip, Rule::Flip, Usf, Axisymmetric, .compiled(), [scene::cylinder()], rubber();
    axisymmetric_cubic_fmpm2_usl: CubicBSpline, Fmpm::<2>, Rule::Fmpm(2), Usl, Axisymmetric, .compiled(), [scene::cylinder()], rubber();
}

#[test]
fn two_laws() {
    let scene = scene::collision::<2>();
    let method = Method::new(Gimp, Flip, Usl, PlaneStrain).compiled();
    let mut mpm = Mpm::new(method, BlockGrid::new(scene.lattice));
    let mut reference = plain(Gimp, Rule::Flip, Order::Usl, &scene);
    let [(a, va), (b, vb)] = &scene.bodies[..] else { panic!("two bodies") };
    mpm.add("rubber", rubber(), a, va).expect("body");
    mpm.add("metal", metal(), b, vb).expect("body");
    reference.add(rubber(), a, va);
    reference.add(metal(), b, vb);
    surround(&mut mpm, &scene);
    let found = run_both(&mut mpm, &mut reference, &scene);
    assert!(found.worst() < TOLERANCE, "{found:?}");
}

/// Friction accounting: frictional heat and wall impulse equal those of the plain reference.
#[test]
fn friction_is_booked_as_it_is_made() {
    let scene = scene::slide::<2>();
    let (seeds, velocity) = &scene.bodies[0];
    let check = |mut mpm: Mpm<2>, rule, order, shape_is_hat: bool| {
        mpm.add("block", rubber(), seeds, velocity).expect("body");
        mpm.set_watch(mpm_core::Watch::off());
        surround(&mut mpm, &scene);
        let (heat, impulse) = if shape_is_hat {
            let mut reference = plain(Linear, rule, order, &scene);
            reference.add(rubber(), seeds, velocity);
            run_both(&mut mpm, &mut reference, &scene);
            (reference.heat, reference.wall_impulse)
        } else {
            let mut reference = plain(QuadraticBSpline, rule, order, &scene);
            reference.add(rubber(), seeds, velocity);
            run_both(&mut mpm, &mut reference, &scene);
            (reference.heat, reference.wall_impulse)
        };
        let given = mpm.exchange();
        println!("heat {} and {heat} J, impulse {:?} and {impulse:?} N s", given.friction, given.impulse);
        // Scale: order of the initial kinetic energy. Agreement to round-off of some thousand sums.
        let scale = mpm.totals().mass * wave_speed().powi(2) * 0.01;
        assert!(heat > 0.01 * scale && (given.friction - heat).abs() < 1e-11 * scale, "{heat} J");
        (0..2).for_each(|d| assert!((given.impulse[d] - impulse[d]).abs() < 1e-11 * impulse[d].abs()));
    };
    let grid = || BlockGrid::new(scene.lattice);
    let hats = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), grid());
    check(hats, Rule::Flip, Order::Musl, true);
    let splines = Mpm::new(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), grid());
    check(splines, Rule::Apic, Order::Usl, false);
}

/// Random particle clouds with random boundaries.
mod clouds {
    use impactite_tests::scene::{Flow, Scene, seeds, wave_speed};
    use mpm_core::{Boundary, Side};
    use proptest::prelude::*;
    use proptest::test_runner::{Config, RngSeed};

    use super::*;

    fn cloud() -> impl Strategy<Value = Scene<2>> {
        let particle = (0.0..6.0, 0.0..6.0, 0.2..2.0, -0.1..0.1, -0.1..0.1);
        let particles = proptest::collection::vec(particle, 1..40);
        (particles, 0..4usize, -3i64..4, -0.2..0.2).prop_map(|(particles, kind, shift, wall)| {
            let lattice = scene::lattice::<2>();
            let corner = lattice.node([shift, -2 * shift]);
            let at = |u: f64, v: f64| [corner[0] + 0.1 * u, corner[1] + 0.1 * v];
            let positions: Vec<[f64; 2]> = particles.iter().map(|p| at(p.0, p.1)).collect();
            let mut seeds = seeds(positions.clone(), 0.0025, 0.025);
            let speeds: Vec<[f64; 2]> =
                particles.iter().map(|p| [p.3 * wave_speed(), p.4 * wave_speed()]).collect();
            for (volume, p) in seeds.volumes.iter_mut().zip(&particles) {
                *volume *= p.2;
            }
            let flow: Flow<2> =
                Box::new(move |x| speeds[positions.iter().position(|y| *y == x).expect("one of the seeds")]);
            let [x, y] = corner;
            let boundaries = match kind {
                0 => vec![],
                1 => vec![Boundary::Symmetry { axis: 0, at: x, side: Side::Above }],
                2 => vec![
                    Boundary::Symmetry { axis: 1, at: y, side: Side::Above },
                    Boundary::Wall { axis: 0, at: x + 0.6, side: Side::Below, velocity: wall },
                ],
                _ => vec![Boundary::Fixed { axis: 1, at: y + 0.6, side: Side::Below }],
            };
            Scene {
                name: "cloud",
                lattice,
                bodies: vec![(seeds, flow)],
                boundaries,
                gravity: [0.0; 2],
                dt: 0.1 * 0.1 / wave_speed(),
                steps: 8,
                space: impactite_tests::reference::Space::Cartesian,
            }
        })
    }

    fn config() -> Config {
        Config { cases: 60, rng_seed: RngSeed::Fixed(20), failure_persistence: None, ..Config::default() }
    }

    proptest! {
        #![proptest_config(config())]
        #[test]
        fn hat(scene in cloud()) {
            let method = Method::new(Linear, Flip, Musl, PlaneStrain);
            let found = compare(method, Linear, Rule::Flip, Order::Musl, &scene, &rubber());
            prop_assert!(found.worst() < TOLERANCE, "{found:?}");
        }
        #[test]
        fn spline(scene in cloud()) {
            let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
            let found = compare(method, QuadraticBSpline, Rule::Apic, Order::Usl, &scene, &rubber());
            prop_assert!(found.worst() < TOLERANCE, "{found:?}");
        }
        #[test]
        fn modified_spline(scene in cloud()) {
            let shape = BoundaryModified(QuadraticBSpline);
            let method = Method::new(shape, Flip, Usl, PlaneStrain).compiled();
            let found = compare(method, shape, Rule::Flip, Order::Usl, &scene, &rubber());
            prop_assert!(found.worst() < TOLERANCE, "{found:?}");
        }
    }
}
