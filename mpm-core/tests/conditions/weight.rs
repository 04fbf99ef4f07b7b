//! Weight of all material across planes of symmetry: it acts like a body force on every particle.

use std::sync::Arc;

use mpm_core::{
    Aflip, Apic, Blend, BlockGrid, Boundary, CpGimp, CubicBSpline, Deformable, FieldForce, Flip, Fmpm,
    IntoKernels, Linear, Method, Mls, Mpm, Musl, PlaneStrain, QuadraticBSpline, Side, TimeControl, Usf, Usl,
};

use crate::{DENSITY, block, law, longitudinal};

const H: f64 = 0.1;

/// Create a column between planes of symmetry with its weight towards and along them: by `set_body_force`, or by particle.
fn column(method: impl IntoKernels<f64, 2>, axis: usize, side: Side, by_particle: bool) -> Mpm<2> {
    let (mut low, mut high) = ([0.0; 2], [0.0; 2]);
    (low[axis], high[axis]) = if side == Side::Above { (0.0, 10.0 * H) } else { (-10.0 * H, 0.0) };
    high[1 - axis] = 4.0 * H;
    let (lattice, seeds) = block(low, high, H);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.set_time_control(TimeControl::Fixed(0.2 * H / longitudinal())).expect("control");
    let mut gravity = [-3.0; 2];
    gravity[axis] = if side == Side::Above { -10.0 } else { 10.0 };
    let body = Deformable::new("column", law(), &seeds);
    if by_particle {
        let acceleration = Arc::new(move |_: &[f64; 2], _| gravity);
        mpm.add_body(body.with_field_force(FieldForce { acceleration })).expect("column");
    } else {
        mpm.add_body(body).expect("column");
        mpm.set_body_force(move |_| gravity);
    }
    mpm.bound(Boundary::Symmetry { axis, at: 0.0, side }).expect("plane");
    mpm.bound(Boundary::Symmetry { axis: 1 - axis, at: 0.0, side: Side::Above }).expect("plane");
    mpm
}

fn agrees<M: IntoKernels<f64, 2>>(name: &str, method: impl Fn() -> M) {
    for (axis, side) in [(1, Side::Above), (0, Side::Below)] {
        let run = |by_particle| {
            let mut mpm = column(method(), axis, side, by_particle);
            let start = mpm.totals();
            for _ in 0..400 {
                mpm.step().expect("step");
            }
            let (end, books) = (mpm.totals(), mpm.exchange());
            for d in 0..2 {
                let missing = end.momentum[d] - start.momentum[d] - books.impulse[d] - books.load[d];
                let scale = end.momentum_scale + books.load[d].abs();
                assert!(missing.abs() < 1e-10 * scale, "{name}, axis {axis}: momentum {d} {missing:e}");
            }
            (mpm.bodies()[0].points(), end.kinetic + end.internal, books.work)
        };
        let ((a, energy, work), (b, _, of_particles)) = (run(false), run(true));
        let stress = DENSITY * 10.0 * 10.0 * H;
        for (a, b) in a.iter().zip(&b) {
            for d in 0..2 {
                assert!((a.position[d] - b.position[d]).abs() < 1e-9 * H, "{name}, axis {axis}: {a:?} {b:?}");
            }
            assert!((a.stress[axis] - b.stress[axis]).abs() < 1e-7 * stress, "{name}, axis {axis}");
        }
        // The difference is at most half a step of work.
        let off = (work - of_particles).abs() / energy.max(work.abs());
        println!("{name}, axis {axis}: work {work:e}, of particles {of_particles:e}, energy {energy:e} J");
        assert!(off < 0.02, "{name}, axis {axis}: work {work} J and {of_particles} J");
    }
}

#[test]
fn the_weight_is_a_force_on_every_particle() {
    agrees("linear", || Method::new(Linear, Flip, Musl, PlaneStrain));
    agrees("cpGIMP, USL", || Method::new(CpGimp, Flip, Usl, PlaneStrain));
    agrees("cpGIMP, USF", || Method::new(CpGimp, Flip, Usf, PlaneStrain).compiled());
    agrees("quadratic, MUSL", || Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain));
    agrees("quadratic, USF", || Method::new(QuadraticBSpline, Flip, Usf, PlaneStrain).compiled());
    agrees("quadratic, AFLIP", || Method::new(QuadraticBSpline, Aflip::default(), Usl, PlaneStrain));
    agrees("quadratic, APIC", || Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain));
    agrees("cubic, MLS", || Method::new(CubicBSpline, Mls, Usl, PlaneStrain).compiled());
    agrees("quadratic, FMPM", || Method::new(QuadraticBSpline, Fmpm::<2>, Usl, PlaneStrain).compiled());
    agrees("total", || Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain).total_lagrangian().compiled());
    agrees("blend", || {
        Method::new(QuadraticBSpline, Blend::new(0.01).expect("blend"), Musl, PlaneStrain).compiled()
    });
}
