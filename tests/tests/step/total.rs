//! Total Lagrangian steps: they equal the plain reference within round-off and keep the properties of the reference
//! configuration.

use std::sync::Arc;

use impactite_tests::compare::{compare, fast, particles, plain, run_both, surround};
use impactite_tests::reference::{Order, Rule};
use impactite_tests::scene::{self, Scene, block, metal, moduli, rubber};
use mpm_core::geometry::Lattice;
use mpm_core::{
    Apic, Axisymmetric, BlockGrid, Boundary, BoundaryModified, Composition, CubicBSpline, Deformable,
    FieldForce, Flip, Fmpm, FullSpace, Gimp, IntoKernels, Linear, Method, Mls, Mpm, Musl, Pic, PlaneStrain,
    QuadraticBSpline, Side, Team, TimeControl, Usf, Usl,
};
use mpm_materials::{JohnsonCook, MieGruneisen, NeoHookean, Solid};

/// Allowed difference: as for updated Lagrangian steps (`reference_2d.rs`).
const TOLERANCE: f64 = 1e-11;

/// Return the scene with fixed planes instead of walls, and its end clamped there.
fn clamped<const D: usize>(mut scene: Scene<D>) -> Scene<D> {
    for boundary in &mut scene.boundaries {
        if let Boundary::Wall { axis, at, side, .. } = *boundary {
            *boundary = Boundary::Fixed { axis, at, side };
        }
    }
    scene
}

macro_rules! table {
    ($($name:ident: $shape:expr, $transfer:expr, $rule:expr, $order:ident, $space:ident, $(.$compiled:ident(),)? [$($scene:expr),*], $law:expr;)*) => {$(
        #[test]
        fn $name() {
            let method = Method::new($shape, $transfer, $order, $space).total_lagrangian()$(.$compiled())?;
            $(
                let scene = clamped($scene);
                let found = compare(method, $shape, $rule, Order::$order, &scene, &$law);
                println!("{}: {found:?}", scene.name);
                assert!(found.worst() < TOLERANCE, "{}: {found:?}", scene.name);
            )*
        }
    )*};
}

table! {
    linear_flip_musl: Linear, Flip, Rule::Flip, Musl, PlaneStrain, [scene::flow(), scene::bar(), scene::collision()], rubber();
    gimp_flip_usf: Gimp, Flip, Rule::Flip, Usf, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], metal();
    quadratic_apic_usl: QuadraticBSpline, Apic, Rule::Apic, Usl, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], rubber();
    quadratic_mls_usl: QuadraticBSpline, Mls, Rule::Mls, Usl, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], rubber();
    quadratic_pic_usf: QuadraticBSpline, Pic, Rule::Pic, Usf, PlaneStrain, .compiled(), [scene::flow()], metal();
    modified_quadratic_flip_usl: BoundaryModified(QuadraticBSpline), Flip, Rule::Flip, Usl, PlaneStrain, .compiled(), [scene::bar(), scene::collision()], metal();
    cubic_fmpm4_usl: CubicBSpline, Fmpm::<4>, Rule::Fmpm(4), Usl, PlaneStrain, .compiled(), [scene::flow(), scene::bar()], rubber();
    axisymmetric_linear_flip_musl: Linear, Flip, Rule::Flip, Musl, Axisymmetric, [scene::cylinder()], rubber();
    axisymmetric_quadratic_apic_usl: QuadraticBSpline, Apic, Rule::Apic, Usl, Axisymmetric, .compiled(), [scene::cylinder()], metal();
    solid_linear_flip_usl: Linear, Flip, Rule::Flip, Usl, FullSpace, .compiled(), [scene::flow(), scene::bar(), scene::collision()], rubber();
    solid_quadratic_fmpm2_usl: QuadraticBSpline, Fmpm::<2>, Rule::Fmpm(2), Usl, FullSpace, .compiled(), [scene::flow(), scene::bar()], metal();
    solid_cubic_flip_musl: CubicBSpline, Flip, Rule::Flip, Musl, FullSpace, .compiled(), [scene::flow()], rubber();
}

/// Law with history and equation of state: the rate form uses the strain increment of the motion.
#[test]
fn copper_yields_in_both_configurations_alike() {
    let law = Solid::new(JohnsonCook::<f64>::copper_taylor(), MieGruneisen::copper());
    let lattice = Lattice::new([0.0; 2], 1e-3).expect("lattice");
    let seeds = block(&lattice, [1, 1], [4, 4], 2, 0.0);
    // Uniform simple shear and compression: all points are equivalent, so that both configurations have the same
    // solution except for moving weights at the free rim.
    let dt = 2e-9;
    let v = |x: [f64; 2]| [2e4 * (x[1] - 3e-3), -1e4 * (x[1] - 3e-3)];
    let mut still = Mpm::new(
        Method::new(Linear, Flip, Usl, PlaneStrain).total_lagrangian().compiled(),
        BlockGrid::new(lattice),
    );
    let mut moving =
        Mpm::new(Method::new(Linear, Flip, Usl, PlaneStrain).compiled(), BlockGrid::new(lattice));
    still.add("copper", law, &seeds, v).expect("body");
    moving.add("copper", law, &seeds, v).expect("body");
    still.set_time_control(TimeControl::Fixed(dt)).expect("control");
    moving.set_time_control(TimeControl::Fixed(dt)).expect("control");
    still.step().expect("step");
    moving.step().expect("step");
    // The first step is equal: the configurations still coincide.
    for (a, b) in particles(&still)[0].iter().zip(&particles(&moving)[0]) {
        for (x, y) in a.state.iter().zip(&b.state) {
            assert!((x - y).abs() <= 1e-12 * x.abs().max(1.0), "{:?} {:?}", a.state, b.state);
        }
    }
    for _ in 0..300 {
        still.step().expect("step");
        moving.step().expect("step");
    }
    let yielded = particles(&still)[0].iter().map(|p| p.state[8]).fold(0.0, f64::max);
    assert!(yielded > 5e-3, "plastic strain {yielded}");
    for (a, b) in particles(&still)[0].iter().zip(&particles(&moving)[0]) {
        let inside = (0..2).all(|d| (seeds.positions[a.number][d] - 3e-3).abs() < 1e-3);
        if inside {
            // Positions differ by the motion of quadrature points at 0.8 % of strain: squares of that, in stress 2
            // %.
            assert!((a.state[8] - b.state[8]).abs() < 0.05 * yielded, "{:?} {:?}", a.state, b.state);
        }
    }
}

/// Rigid translation: no cell crossing, and no stress.
#[test]
fn a_block_flies_without_stress() {
    let lattice = scene::lattice::<3>();
    let seeds = block(&lattice, [0; 3], [3; 3], 2, 0.4);
    let method = Method::new(QuadraticBSpline, Flip, Usl, FullSpace).total_lagrangian().compiled();
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("block", rubber(), &seeds, |_| [3.0, -1.0, 0.5]).expect("body");
    mpm.set_time_control(TimeControl::Fixed(0.01)).expect("control");
    mpm.run_until(5.0).expect("run");
    for p in &particles(&mpm)[0] {
        for (d, v) in [3.0, -1.0, 0.5].into_iter().enumerate() {
            let error = p.position[d] - seeds.positions[p.number][d] - 5.0 * v;
            // Tolerance: 500 additions with round-off of 150 cells.
            assert!(error.abs() < 1e-11, "{p:?}");
        }
        // Tolerance: round-off of velocities of 3 over a cell of 0.1, 500 times: 500 x 1e-16 x 30 x dt of strain.
        assert!(p.stress.iter().all(|s| s.abs() < 1e-12 * scene::YOUNG), "{p:?}");
    }
}

/// Compare a force field by initial particle position with the plain reference, in both configurations.
fn driven<M: Composition<f64, 2> + IntoKernels<f64, 2>>(method: M) {
    use mpm_core::Frame;
    let scene = scene::flow::<2>();
    let field = |x: &[f64; 2], t: f64| [0.7 * (9.0 * x[1]).sin() + t, 2.0 * x[0] * (30.0 * t).cos()];
    let mut mpm = Mpm::new(method, BlockGrid::new(scene.lattice));
    let mut reference = plain(QuadraticBSpline, Rule::Apic, Order::Usl, &scene);
    reference.total = M::Frame::TOTAL;
    reference.field = Some(Box::new(field));
    for (seeds, velocity) in &scene.bodies {
        let force = FieldForce { acceleration: Arc::new(field) };
        mpm.add_body(Deformable::new("block", rubber(), seeds).moving(velocity).with_field_force(force))
            .expect("body");
        reference.add(rubber(), seeds, velocity);
    }
    surround(&mut mpm, &scene);
    let before = mpm.totals();
    let found = run_both(&mut mpm, &mut reference, &scene);
    assert!(found.worst() < TOLERANCE, "{found:?}");
    let (after, ledger) = (mpm.totals(), mpm.exchange());
    for d in 0..2 {
        let gained = after.momentum[d] - before.momentum[d] - ledger.load[d];
        assert!(gained.abs() < 1e-12 * after.momentum_scale, "component {d}: momentum error {gained:e}");
    }
}

#[test]
fn a_force_field_on_moving_particles() {
    driven(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain));
}

#[test]
fn a_force_field_in_the_reference_configuration() {
    driven(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain).total_lagrangian().compiled());
}

/// Bitwise equality for any number of threads.
#[test]
fn threads_change_nothing() {
    let run = |threads: usize| {
        let scene = clamped(scene::bar::<3>());
        let method = Method::new(CubicBSpline, Fmpm::<2>, Usl, FullSpace).total_lagrangian().compiled();
        let mut mpm = fast::<f64, 3, _, _, _>(method, BlockGrid::new(scene.lattice), &scene, &rubber());
        mpm.set_team(Team::new(threads).expect("team"));
        for _ in 0..scene.steps {
            mpm.step().expect("step");
        }
        particles(&mpm)
    };
    let one = run(1);
    for threads in 2..=4 {
        assert_eq!(one, run(threads), "{threads} threads");
    }
}

/// The default time step follows the compression of the reference cells: at a third of the length along x, waves
/// faster than at rest cross a cell in a third of the time.
#[test]
fn the_step_shrinks_with_the_cells() {
    let lattice = Lattice::new([0.0; 2], 0.1).expect("lattice");
    let law = NeoHookean::new(scene::DENSITY, moduli()).expect("law");
    let seeds = block(&lattice, [0, 0], [4, 4], 2, 0.0);
    let method = Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian();
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("block", law, &seeds, |x| [-1e3 * x[0], 0.0]).expect("body");
    mpm.set_time_control(TimeControl::Fixed(6.666e-4)).expect("control");
    mpm.step().expect("step");
    let rate = mpm.bodies()[0].rate(0.1);
    let squeezed = 1.0 - 1e3 * 6.666e-4;
    // Point in the middle; at the rim, the lumped-mass map does not reproduce the velocity.
    let all = particles(&mpm);
    let middle = |p: &&mpm_core::PointView| (0..2).all(|d| (seeds.positions[p.number][d] - 0.2).abs() < 0.1);
    let p = all[0].iter().find(middle).expect("a particle in the middle");
    assert!((p.state[0] - squeezed).abs() < 1e-9, "{p:?}");
    // P-wave modulus rho c^2 = [lambda (1 - ln J) + 2 G] / J along x of a neo-Hookean point compressed to J, of
    // density rho0 / J; wave speed in reference cells sqrt([lambda (1 - ln J) + 2 G] / rho0) / J. The bound of the
    // law is never below it.
    let m = moduli();
    let exact =
        ((m.lambda() * (1.0 - squeezed.ln()) + 2.0 * m.shear) / scene::DENSITY).sqrt() / squeezed / 0.1;
    // Bound of the largest stretch (1) from the invariants of b: (4 - J^2) / 3, or 2.9 % more speed.
    assert!(rate > exact * (1.0 - 1e-9) && rate < 1.03 * exact, "{rate} {exact}");
}

#[test]
fn a_wall_is_refused() {
    let method = Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian();
    let mut mpm = Mpm::new(method, BlockGrid::new(Lattice::new([0.0; 2], 0.1).expect("lattice")));
    let wall = Boundary::Wall { axis: 0, at: 0.0, side: Side::Above, velocity: 0.0 };
    let error = mpm.bound(wall).expect_err("refused").to_string();
    assert!(error.contains("wall") && error.contains("prescribed velocity"), "{error}");
}
