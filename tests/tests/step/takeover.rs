//! Transfer of a body to another scene: the state is preserved and the motion continues.

use impactite_tests::scene::{block, lattice, metal, rubber, wave_speed};
use mpm_core::SceneError;
use mpm_core::geometry::{Lattice, Seeds};
use mpm_core::{
    Apic, Axisymmetric, BlockGrid, CpGimp, Cpdi2, DenseGrid, Flip, IntoKernels, Linear, Method, Mpm, Musl,
    PlaneStrain, PointView, QuadraticBSpline, TimeControl, Usl,
};

const H: f64 = 0.1;

fn particles(mpm: &Mpm<2>) -> Vec<PointView> {
    mpm.bodies()[0].points()
}

fn seeds() -> Seeds<2> {
    block(&lattice(), [0; 2], [8; 2], 3, 0.0)
}

/// Build a block with shear, rotation and stretch of some tenths over a few dozen steps.
fn sheared<M: IntoKernels<f64, 2>>(method: M) -> Mpm<2> {
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice()));
    let flow = |x: [f64; 2]| [0.2 * x[1] + 0.1 * x[0], -0.1 * x[0]].map(|v| v * wave_speed());
    mpm.add("block", rubber(), &seeds(), flow).expect("body");
    mpm.set_time_control(TimeControl::Fixed(0.1 * H / wave_speed())).expect("control");
    mpm
}

fn advance(mpm: &mut Mpm<2>, steps: usize) {
    for _ in 0..steps {
        mpm.step().expect("step");
    }
}

fn total() -> Mpm<2> {
    sheared(Method::new(Linear, Flip, Usl, PlaneStrain).total_lagrangian().compiled())
}

#[test]
fn all_of_it_is_kept() {
    fn check<M: IntoKernels<f64, 2>>(method: M) {
        let mut from = total();
        advance(&mut from, 100);
        let mut to = Mpm::new(method, BlockGrid::new(lattice()));
        to.take_over(rubber(), &*from.bodies()[0]).expect("body");
        to.set_time(from.time()).expect("time");
        assert_eq!((to.time(), to.steps()), (from.time(), 0));
        for (p, q) in particles(&from).iter().zip(&particles(&to)) {
            let of = |p: &PointView| (p.number, p.velocity, p.mass, p.volume, p.stress, p.state.clone());
            assert_eq!(of(p), of(q));
            for d in 0..2 {
                assert!((p.position[d] - q.position[d]).abs() < 1e-15, "{p:?} {q:?}");
            }
        }
        let (a, b) = (from.totals(), to.totals());
        assert!(
            (a.kinetic - b.kinetic).abs() < 1e-14 * a.kinetic
                && (a.internal - b.internal).abs() < 1e-14 * a.internal
        );
        advance(&mut to, 20);
    }
    check(Method::new(Linear, Flip, Musl, PlaneStrain));
    check(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain));
}

/// Particle domains are the initial ones mapped by the deformation; axis-aligned boxes approximate them.
#[test]
fn domains_go_on() {
    let mut from = total();
    advance(&mut from, 100);
    let mut convected =
        Mpm::new(Method::new(Cpdi2, Flip, Usl, PlaneStrain).compiled(), BlockGrid::new(lattice()));
    convected.take_over(rubber(), &*from.bodies()[0]).expect("body");
    let mut boxed = Mpm::new(Method::new(CpGimp, Flip, Usl, PlaneStrain), BlockGrid::new(lattice()));
    boxed.take_over(rubber(), &*from.bodies()[0]).expect("body");
    let mut sheared = 0.0f64;
    for ((p, q), r) in particles(&from).iter().zip(&particles(&convected)).zip(&particles(&boxed)) {
        for k in 0..2 {
            let along = p.half_edges[0][k].hypot(p.half_edges[1][k]);
            assert!((r.half_edges[k][k] - along).abs() < 1e-15);
            for d in 0..2 {
                assert!((q.half_edges[k][d] - p.half_edges[k][d]).abs() < 1e-15);
            }
        }
        sheared = sheared.max(p.half_edges[1][0].abs());
        // The domain area equals the volume within the integration error of F and of the law.
        let [[a, b, _], [c, d, _], _] = q.half_edges;
        assert!((4.0 * (a * d - b * c) / q.volume - 1.0).abs() < 1e-9, "{q:?}");
    }
    assert!(sheared > 0.1 * H / 6.0, "no shear");
}

/// With CPDI-2, the run continues as in the reference configuration.
#[test]
fn the_run_goes_on() {
    let mut whole = total();
    advance(&mut whole, 100);
    let mut moved =
        Mpm::new(Method::new(Cpdi2, Flip, Usl, PlaneStrain).compiled(), BlockGrid::new(lattice()));
    moved.take_over(rubber(), &*whole.bodies()[0]).expect("body");
    moved.set_time_control(TimeControl::Fixed(0.1 * H / wave_speed())).expect("control");
    let before = particles(&whole);
    advance(&mut whole, 60);
    advance(&mut moved, 60);
    let (mut error, mut way) = (0.0, 0.0);
    for ((p, q), start) in particles(&whole).iter().zip(&particles(&moved)).zip(&before) {
        for d in 0..2 {
            error += (p.position[d] - q.position[d]).powi(2);
            way += (p.position[d] - start.position[d]).powi(2);
        }
    }
    let part = f64::sqrt(error / way);
    assert!(part < 0.01, "parted by {part} of the way");
    let energy = |t: mpm_core::Totals| t.kinetic + t.internal;
    let (a, b) = (energy(whole.totals()), energy(moved.totals()));
    assert!((a - b).abs() < 0.005 * a, "{a} {b}");
}

/// Axis-aligned domains of a rotated square keep their size at any angle.
#[test]
fn boxes_of_what_turned() {
    let mut from = Mpm::new(
        Method::new(Linear, Flip, Usl, PlaneStrain).total_lagrangian().compiled(),
        BlockGrid::new(lattice()),
    );
    let seeds = block(&lattice(), [0; 2], [2; 2], 2, 0.0);
    let centre = lattice::<2>().node([1, 1]);
    let spin = |x: [f64; 2]| [x[1] - centre[1], centre[0] - x[0]].map(|v| 0.3 * v);
    from.add("block", rubber(), &seeds, spin).expect("body");
    from.set_time_control(TimeControl::Fixed(0.1 * H / wave_speed())).expect("control");
    // Rotation by a quarter turn.
    while particles(&from)[0].half_edges[0][0] > 0.05 * seeds.half_size[0] {
        from.step().expect("step");
        assert!(from.steps() < 2000, "it does not turn");
    }
    let mut to = Mpm::new(Method::new(CpGimp, Flip, Usl, PlaneStrain), BlockGrid::new(lattice()));
    to.take_over(rubber(), &*from.bodies()[0]).expect("body");
    for p in particles(&to) {
        for d in 0..2 {
            assert!((p.half_edges[d][d] / seeds.half_size[d] - 1.0).abs() < 0.05, "{p:?}");
        }
    }
}

#[test]
fn what_cannot_be_taken_over_is_refused() {
    let from = total();
    let body = &*from.bodies()[0];
    let method = Method::new(Linear, Flip, Musl, PlaneStrain);
    let mut to = Mpm::new(method, BlockGrid::new(lattice()));
    let error = to.take_over(metal(), body).expect_err("another law");
    assert!(error.to_string().contains("neo-Hookean"), "{error}");
    assert!(to.bodies().is_empty());
    let fine = Lattice::new([0.0; 2], 0.2 * H).expect("lattice");
    let error = Mpm::new(method, BlockGrid::new(fine)).take_over(rubber(), body);
    assert!(matches!(error, Err(SceneError::HalfSize { .. })), "{error:?}");
    let small = DenseGrid::new(lattice(), [0; 2], [4; 2]).expect("box");
    let error = Mpm::new(method, small).take_over(rubber(), body);
    assert!(matches!(error, Err(SceneError::Outside(..))), "{error:?}");
    let round = Method::new(CpGimp, Flip, Usl, Axisymmetric);
    let error = Mpm::new(round, BlockGrid::new(lattice())).take_over(rubber(), body);
    assert!(matches!(error, Err(SceneError::OtherSpace { .. })), "{error:?}");
    assert!(matches!(to.set_time(f64::NAN), Err(SceneError::Clock { .. })));
    to.take_over(rubber(), body).expect("body");
    to.step().expect("step");
    assert!(matches!(to.set_time(1.0), Err(SceneError::Clock { steps: 1, .. })));
}
