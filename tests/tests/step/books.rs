//! Momentum balance at intersecting symmetry planes, in corners and in slices one or two cells thick, and at
//! intersections with planes that fix the material.

use impactite_tests::laws::Prestressed;
use impactite_tests::scene::{YOUNG, block, rubber, wave_speed};
use mpm_core::Run;
use mpm_core::geometry::{Lattice, Seeds};
use mpm_core::observe::{Ledger, Observer, Pace};
use mpm_core::scheme::Allows;
use mpm_core::transfer::Suits;
use mpm_core::{
    Apic, Blend, BlockGrid, Boundary, Composition, CpGimp, CubicBSpline, Flip, Fmpm, FullSpace, IntoKernels,
    Linear, Method, Mpm, Musl, Pic, PlaneStrain, QuadraticBSpline, Side, TimeControl, Usf, Usl,
};
use mpm_materials::{Constitutive, IntoMaterial};

const H: f64 = 0.1;

/// Return the momentum balance error of a body between symmetry planes `thick` cells apart (or one plane only)
/// along every axis. A single plane of the first axis faces a moving wall; with `held`, fixed boundaries replace
/// the planes of the first axis.
fn error<const D: usize, M: IntoKernels<f64, D>, C>(
    method: M,
    law: C,
    thick: [Option<usize>; D],
    held: bool,
) -> f64
where
    C: IntoMaterial<f64>,
{
    let lattice = Lattice::new([0.0; D], H).expect("lattice");
    let seeds: Seeds<D> = block(&lattice, [0; D], thick.map(|t| t.unwrap_or(3)), 2, 0.0);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    // Velocities towards the planes and rotation, so that the planes exert impulses.
    let speed = 0.02 * wave_speed();
    let velocity = |x: [f64; D]| std::array::from_fn(|d| speed * (8.0 * x[(d + 1) % D] * x[d] - 1.0));
    mpm.add("body", law, &seeds, velocity).expect("body");
    for (axis, thick) in thick.iter().enumerate() {
        if held && axis == 0 {
            mpm.bound(Boundary::Fixed { axis, at: 0.0, side: Side::Above }).expect("held plane");
            continue;
        }
        mpm.bound(Boundary::Symmetry { axis, at: 0.0, side: Side::Above }).expect("plane");
        if let Some(cells) = thick {
            let at = *cells as f64 * H;
            mpm.bound(Boundary::Symmetry { axis, at, side: Side::Below }).expect("plane");
        }
    }
    if thick[0].is_none() && !held {
        mpm.bound(Boundary::Wall { axis: 0, at: 3.0 * H, side: Side::Below, velocity: -speed })
            .expect("wall");
    }
    let dt = 0.2 * H / wave_speed();
    mpm.set_time_control(TimeControl::Fixed(dt)).expect("time control");
    let mut ledger = Ledger::new(Pace::every_step());
    let observers: [&mut dyn Observer; 1] = [&mut ledger];
    Run::new(&mut mpm).observe_all(observers).until(40.0 * dt).expect("run");
    ledger.worst_momentum_error()
}

fn closes<M2, M3>(flat: impl Fn() -> M2, solid: impl Fn() -> M3)
where
    M2: Composition<f64, 2> + IntoKernels<f64, 2>,
    M3: Composition<f64, 3> + IntoKernels<f64, 3>,
{
    for thick in [None, Some(1), Some(2), Some(3)] {
        for other in [None, Some(1)] {
            let e = error(flat(), rubber(), [other, thick], false);
            assert!(e < 1e-12, "{} in a slice of {other:?} x {thick:?} cells: {e:e}", flat().describe());
        }
        let e = error(
            flat(),
            Prestressed::new([-1e-3, -2e-3, 5e-4, 3e-4, 0.0, 0.0].map(|s| s * YOUNG)).compiled(),
            [None, thick],
            false,
        );
        assert!(e < 1e-12, "{}, prestressed, {thick:?} cells: {e:e}", flat().describe());
        let e = error(solid(), rubber(), [None, None, thick], false);
        assert!(e < 1e-12, "{} in a corner of {thick:?} cells: {e:e}", solid().describe());
        let e = error(flat(), rubber(), [None, thick], true);
        assert!(e < 1e-12, "{}, held, {thick:?} cells: {e:e}", flat().describe());
        let e = error(solid(), rubber(), [None, None, thick], true);
        assert!(e < 1e-12, "{}, held in a corner of {thick:?} cells: {e:e}", solid().describe());
    }
}

fn method<S: Suits<X>, X, U: Allows<X>, E>(shape: S, transfer: X, stress: U, space: E) -> Method<S, X, U, E> {
    Method::new(shape, transfer, stress, space)
}

macro_rules! methods {
    ($($name:ident: $shape:expr, $transfer:expr, $update:expr $(, .$compiled:ident())?;)*) => {$(
        #[test]
        fn $name() {
            closes(
                || method($shape, $transfer, $update, PlaneStrain)$(.$compiled())?,
                || method($shape, $transfer, $update, FullSpace)$(.$compiled())?,
            );
        }
    )*};
}
methods! {
    linear_flip_musl: Linear, Flip, Musl;
    linear_flip_usf: Linear, Flip, Usf, .compiled();
    linear_fmpm_usl: Linear, Fmpm::<3>, Usl, .compiled();
    linear_blend_musl: Linear, Blend::new(1e-3).expect("blend"), Musl;
    contiguous_gimp_flip_musl: CpGimp, Flip, Musl;
    contiguous_gimp_pic_usf: CpGimp, Pic, Usf, .compiled();
    quadratic_apic_usl: QuadraticBSpline, Apic, Usl;
    quadratic_blend_usf: QuadraticBSpline, Blend::new(1e-3).expect("blend"), Usf, .compiled();
    cubic_fmpm_usl: CubicBSpline, Fmpm::<2>, Usl, .compiled();
    cubic_fmpm_usf: CubicBSpline, Fmpm::<2>, Usf, .compiled();
}
