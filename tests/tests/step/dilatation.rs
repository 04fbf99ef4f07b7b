//! Mean dilatation of cells (B-bar): steps equal the plain reference within round-off. A uniform dilatation is
//! unchanged, the mean volume is conserved, and nearly incompressible material does not lock.

use impactite_tests::compare::{compare, fast, particles};
use impactite_tests::reference::{Order, Rule};
use impactite_tests::scene::{self, block, metal, moduli, rubber};
use mpm_core::geometry::Lattice;
use mpm_core::{
    Apic, Axisymmetric, BlockGrid, Boundary, CpGimp, Cpdi, CubicBSpline, Flip, Fmpm, FullSpace, IntoKernels,
    Linear, Method, Mls, Mpm, Musl, PlaneStrain, PointView, QuadraticBSpline, Side, Team, TimeControl, Usf,
    Usl,
};
use mpm_materials::{Moduli, NeoHookean};

/// Allowed difference: as for steps with the dilatation of each particle (`reference_2d.rs`).
const TOLERANCE: f64 = 1e-11;

/// Return the scene with fixed planes instead of walls: the total Lagrangian grid has no walls.
fn clamped<const D: usize>(mut scene: scene::Scene<D>) -> scene::Scene<D> {
    for boundary in &mut scene.boundaries {
        if let Boundary::Wall { axis, at, side, .. } = *boundary {
            *boundary = Boundary::Fixed { axis, at, side };
        }
    }
    scene
}

macro_rules! table {
    ($($name:ident: $method:expr, $shape:expr, $rule:expr, $order:ident, [$($scene:expr),*], $law:expr;)*) => {$(
        #[test]
        fn $name() {
            $(
                let scene = $scene;
                let found = compare($method.mean_dilatation().compiled(), $shape, $rule, Order::$order, &scene, &$law);
                println!("{}: {found:?}", scene.name);
                assert!(found.worst() < TOLERANCE, "{}: {found:?}", scene.name);
            )*
        }
    )*};
}
table! {
    linear_flip_musl: Method::new(Linear, Flip, Musl, PlaneStrain), Linear, Rule::Flip, Musl, [scene::flow(), scene::bar()], rubber();
    contiguous_gimp_flip_usf: Method::new(CpGimp, Flip, Usf, PlaneStrain), CpGimp, Rule::Flip, Usf, [scene::flow()], metal();
    cpdi_flip_usl: Method::new(Cpdi, Flip, Usl, PlaneStrain), Cpdi, Rule::Flip, Usl, [scene::flow()], metal();
    quadratic_mls_usl: Method::new(QuadraticBSpline, Mls, Usl, PlaneStrain), QuadraticBSpline, Rule::Mls, Usl, [scene::bar()], rubber();
    cubic_fmpm2_usl: Method::new(CubicBSpline, Fmpm::<2>, Usl, PlaneStrain), CubicBSpline, Rule::Fmpm(2), Usl, [scene::flow()], rubber();
    axisymmetric_linear_flip_musl: Method::new(Linear, Flip, Musl, Axisymmetric), Linear, Rule::Flip, Musl, [scene::cylinder()], metal();
    total_axisymmetric_quadratic_apic: Method::new(QuadraticBSpline, Apic, Usl, Axisymmetric).total_lagrangian(), QuadraticBSpline, Rule::Apic, Usl, [clamped(scene::cylinder())], rubber();
    solid_linear_flip_musl: Method::new(Linear, Flip, Musl, FullSpace), Linear, Rule::Flip, Musl, [scene::flow(), scene::bar()], metal();
}

const H: f64 = 0.1;
const RHO: f64 = 1000.0;

/// Run a cantilever of `cells` cells across, eight times as long, under suddenly applied gravity; return its largest
/// deflection, m.
fn deflection<M: IntoKernels<f64, 2>>(method: M, law: NeoHookean<f64>, cells: usize) -> f64 {
    let lattice = Lattice::new([0.0; 2], H / cells as f64).expect("lattice");
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let seeds = block(&lattice, [0; 2], [8 * cells, cells], 2, 0.0);
    mpm.add("beam", law, &seeds, |_| [0.0; 2]).expect("body");
    mpm.bound(Boundary::Fixed { axis: 0, at: 0.0, side: Side::Above }).expect("clamp");
    mpm.set_body_force(|_| [0.0, -0.1]);
    mpm.set_time_control(TimeControl::Courant { factor: 0.5, growth: 1.1 }).expect("time control");
    let (mut deepest, length) = (0.0_f64, 8.0 * H);
    let period = 2.0 * std::f64::consts::PI / 1.875_f64.powi(2)
        * length.powi(2)
        * (12.0 * RHO * (1.0 - 0.25) / YOUNG).sqrt()
        / H;
    // Half of the exact period, longer than that of a locking beam.
    for n in 1..=20 {
        mpm.run_until(0.03 * f64::from(n) * period).expect("run");
        let all = particles(&mpm);
        let tip = all[0].iter().filter(|p| p.position[0] > 0.97 * length);
        let heights: Vec<f64> = tip.map(|p| p.position[1]).collect();
        deepest = deepest.max(0.5 * H - heights.iter().sum::<f64>() / heights.len() as f64);
    }
    deepest
}
const YOUNG: f64 = 1.0e5;

/// A clamped rubber beam under its weight oscillates to twice its static deflection, w = rho g A L^4 / (8 E' I) with E' = E / (1 - nu^2)
/// in plane strain (Timoshenko and Goodier). With linear shape functions and the dilatation of each particle it locks as nu approaches
/// 1/2; with the mean dilatation of a cell it does not.
#[test]
fn what_keeps_its_volume_does_not_lock() {
    let swing = |method: bool, nu: f64| {
        let law = NeoHookean::new(RHO, Moduli::young_poisson(YOUNG, nu).expect("moduli")).expect("law");
        let hats = Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian();
        let found = if method {
            deflection(hats.mean_dilatation().compiled(), law, 2)
        } else {
            deflection(hats, law, 2)
        };
        let bending = YOUNG / (1.0 - nu * nu) * H.powi(3) / 12.0;
        found / (2.0 * RHO * 0.1 * H * (8.0 * H).powi(4) / (8.0 * bending))
    };
    let [own, mean] = [false, true].map(|mean| swing(mean, 0.49));
    println!("own {own:.3}, mean {mean:.3} of the exact swing");
    assert!(own < 0.6, "no locking to cure: {own}");
    assert!((mean - 1.0).abs() < 0.1, "{mean}");
}

/// Mean dilatation does not change a uniform dilatation.
#[test]
fn a_uniform_dilatation_is_not_changed() {
    fn swell<M: IntoKernels<f64, 3>>(method: M) -> Vec<[f64; 6]> {
        let lattice = Lattice::new([0.0; 3], H).expect("lattice");
        let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
        let seeds = block(&lattice, [0; 3], [8; 3], 2, 0.0);
        mpm.add("cube", rubber(), &seeds, |x| x.map(|x| x - 0.4)).expect("body");
        mpm.set_time_control(TimeControl::Fixed(1e-4)).expect("time control");
        mpm.step().expect("step");
        // Inner particles only: at the rim, nodes do not reproduce the field.
        let inside = |p: &&PointView| p.position.iter().all(|x| (x - 0.4).abs() < 0.15);
        particles(&mpm)[0].iter().filter(inside).map(|p| p.stress).collect()
    }
    let method = Method::new(QuadraticBSpline, Flip, Musl, FullSpace);
    let scale = moduli().bulk;
    for (a, b) in swell(method).iter().zip(swell(method.mean_dilatation().compiled())) {
        for i in 0..6 {
            assert!((a[i] - b[i]).abs() < 1e-13 * scale, "{a:?} {b:?}");
        }
    }
}

/// Bitwise equality for any number of threads: cells are averaged within a block.
#[test]
fn threads_do_not_matter() {
    let run = |threads: usize| {
        let scene = scene::flow::<3>();
        let method = Method::new(Linear, Flip, Musl, FullSpace).mean_dilatation().compiled();
        let mut mpm = fast(method, BlockGrid::new(scene.lattice), &scene, &metal());
        mpm.set_team(Team::new(threads).expect("threads"));
        for _ in 0..scene.steps {
            mpm.step().expect("step");
        }
        particles(&mpm)
    };
    let one = run(1);
    for threads in [2, 3, 4] {
        assert_eq!(one, run(threads), "{threads} threads");
    }
}
