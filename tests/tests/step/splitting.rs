//! Particle splitting: conservation laws hold, and stretched material develops no numerical fracture.

use std::sync::Arc;

use impactite_tests::scene::block;
use mpm_core::SceneError;
use mpm_core::geometry::{Lattice, Seeds};
use mpm_core::{
    Apic, Axisymmetric, BlockGrid, Boundary, CpGimp, Cpdi, Cpdi2, Deformable, Flip, FullSpace, IntoKernels,
    Linear, Method, Mpm, Musl, OneField, PlaneStrain, PointView, QuadraticBSpline, Side, Splitting, Team,
    TimeControl, Totals, Usf, Usl,
};
use mpm_materials::{Constitutive, IntoMaterial, Material, Moduli, NeoHookean, Stretching};
use proptest::prelude::*;

const H: f64 = 0.1;

fn particles<const D: usize>(mpm: &Mpm<D>) -> Vec<PointView> {
    mpm.bodies()[0].points()
}

/// Return a neo-Hookean law of 1000 kg/m^3 with this wave speed, m/s.
fn soft(speed: f64) -> NeoHookean<f64> {
    let young = 1000.0 * speed * speed;
    NeoHookean::new(1000.0, Moduli::young_poisson(young, 0.0).expect("moduli")).expect("law")
}

/// Advance a block by one step in the velocity field `mean + gradient x`; split its particles by `splitting`.
fn one_step<const D: usize, M: IntoKernels<f64, D>>(
    method: M,
    (mean, gradient): ([f64; 3], [[f64; 3]; 3]),
    splitting: Option<Splitting>,
) -> Mpm<D> {
    let lattice = Lattice::new([0.0; D], H).expect("lattice");
    let seeds: Seeds<D> = block(&lattice, [2; D], [3; D], 2, 0.0);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let velocity = |x: [f64; D]| {
        let mut v = [0.0; D];
        for d in 0..D {
            v[d] = mean[d];
            for e in 0..D {
                v[d] += gradient[d][e] * (x[e] - 3.5 * H);
            }
        }
        v
    };
    // Waves cross a fiftieth of a cell in the step of 1 s, the duration that the gradients need.
    let law = Stretching::new(soft(0.02 * H)).compiled();
    let mut block = Deformable::new("block", law, &seeds).moving(velocity);
    if let Some(splitting) = splitting {
        block = block.with_splitting(splitting);
    }
    mpm.add_body(block).expect("body");
    mpm.set_time_control(TimeControl::Fixed(1.0)).expect("time control");
    mpm.step().expect("step");
    mpm
}

/// Return the largest difference of two totals, each relative to its scale.
fn difference(a: &Totals, b: &Totals, reach: f64) -> f64 {
    let mut worst = ((a.mass - b.mass) / b.mass).abs();
    for d in 0..3 {
        worst = worst.max((a.momentum[d] - b.momentum[d]).abs() / b.momentum_scale);
        let moment = (a.angular_momentum[d] - b.angular_momentum[d]).abs();
        worst = worst.max(moment / (b.momentum_scale * reach));
    }
    worst = worst.max((a.kinetic - b.kinetic).abs() / b.kinetic);
    worst.max((a.internal - b.internal).abs() / b.internal.abs().max(1e-30))
}

fn keeps_the_books<const D: usize, M: IntoKernels<f64, D> + Copy>(
    method: M,
    motion: ([f64; 3], [[f64; 3]; 3]),
) -> Result<(), TestCaseError> {
    let splitting = Splitting::at(1.05).expect("stretch");
    let whole = one_step::<D, M>(method, motion, None);
    let split = one_step::<D, M>(method, motion, Some(splitting));
    let (cuts, seeds) = (split.bodies()[0].division().expect("particles").splits().cuts, whole.particles());
    prop_assert_eq!(split.particles(), seeds + cuts as usize);
    // Tolerance: sums of a few hundred numbers, each rounded a few times.
    let mut totals = split.totals();
    let revealed = split.exchange().conversion;
    prop_assert!(revealed >= 0.0 && revealed < totals.kinetic);
    totals.kinetic -= revealed;
    let error = difference(&totals, &whole.totals(), 10.0 * H);
    prop_assert!(error < 2e-14, "{error:e}, {cuts} cuts");

    // Children inherit the state variables of their parent and have unique numbers.
    let parents = particles(&whole);
    let children = particles(&split);
    let mut numbers: Vec<usize> = children.iter().map(|p| p.number).collect();
    numbers.sort_unstable();
    numbers.dedup();
    prop_assert_eq!(numbers.len(), children.len());
    for p in &parents {
        let own: Vec<&PointView> = children.iter().filter(|c| c.number % seeds == p.number).collect();
        prop_assert_eq!(own.iter().map(|c| c.mass).sum::<f64>(), p.mass);
        for c in &own {
            prop_assert_eq!(&c.state[7..], &p.state[7..]);
            prop_assert_eq!(c.stress, p.stress);
            prop_assert_eq!(c.mass * f64::from(own.len() as u32), p.mass);
        }
        if let [a, b] = own[..] {
            for d in 0..D {
                let middle = 0.5 * (a.position[d] + b.position[d]);
                prop_assert!((middle - p.position[d]).abs() < 1e-15, "{middle}");
                let mean = 0.5 * (a.velocity[d] + b.velocity[d]);
                prop_assert!((mean - p.velocity[d]).abs() < 1e-16, "{mean}");
            }
            // Splitting halves the largest stretch: its square becomes a quarter.
            let trace = |s: &[f64]| (0..D).map(|d| s[d]).sum::<f64>();
            let lost = trace(&p.state) - trace(&a.state);
            let apart: f64 = (0..D).map(|d| (a.position[d] - b.position[d]).powi(2)).sum();
            // Distance of children: L/2 = l lambda, l = a quarter of a cell, and three quarters of lambda squared
            // are lost.
            prop_assert!((apart - (0.25 * H).powi(2) * lost / 0.75).abs() < 1e-12 * H * H, "{apart}");
        }
    }
    Ok(())
}

/// Velocities of some tenths of a cell per step of 1 s, and gradients with stretches up to a half.
fn motion() -> impl Strategy<Value = ([f64; 3], [[f64; 3]; 3])> {
    let gradient = prop::array::uniform3(prop::array::uniform3(-0.2f64..0.2));
    (prop::array::uniform3(-0.03f64..0.03), gradient).prop_map(|(v, mut g)| {
        g[1][1] += 0.15;
        (v, g)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]
    #[test]
    fn books_solid_affine(motion in motion()) {
        keeps_the_books::<3, _>(Method::new(QuadraticBSpline, Apic, Usl, FullSpace), motion)?;
    }
    #[test]
    fn books_plane_domains(motion in motion()) {
        keeps_the_books::<2, _>(Method::new(CpGimp, Flip, Musl, PlaneStrain), motion)?;
    }
    #[test]
    fn books_plane_corners(motion in motion()) {
        keeps_the_books::<2, _>(Method::new(Cpdi2, Flip, Usl, PlaneStrain).compiled(), motion)?;
    }
    #[test]
    fn books_solid_edges(motion in motion()) {
        keeps_the_books::<3, _>(Method::new(Cpdi, Flip, Musl, FullSpace).compiled(), motion)?;
    }
    #[test]
    fn books_revolution(motion in motion()) {
        keeps_the_books::<2, _>(Method::new(Linear, Flip, Usf, Axisymmetric).compiled(), motion)?;
    }
}

const CELLS: usize = 6;
const LENGTH: f64 = CELLS as f64 * H;
/// Initial stretch rate, 1/s.
const RATE: f64 = 1.0;

/// Build a strip between symmetry planes with v = rate x: in free flight its stretch is 1 + rate t. The law is soft
/// enough (waves take 100/rate along the strip) not to affect the motion, so that stress is a record of the strain.
fn stretched<M: IntoKernels<f64, 2>>(
    method: M,
    splitting: Option<Splitting>,
    threads: usize,
    stretch: f64,
) -> Mpm<2> {
    let lattice = Lattice::new([0.0; 2], H).expect("lattice");
    let seeds: Seeds<2> = block(&lattice, [0, 0], [CELLS, 2], 2, 0.0);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let law = soft(0.01 * RATE * LENGTH);
    let velocity = |x: [f64; 2]| [RATE * x[0], 0.0];
    match splitting {
        Some(splitting) => {
            let strip = Deformable::new("strip", Stretching::new(law).compiled(), &seeds).moving(velocity);
            mpm.add_body(strip.with_splitting(splitting)).expect("body")
        }
        None => mpm.add("strip", law, &seeds, velocity).expect("body"),
    }
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).expect("plane");
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).expect("plane");
    mpm.bound(Boundary::Symmetry { axis: 1, at: 2.0 * H, side: Side::Below }).expect("plane");
    mpm.set_time_control(TimeControl::Courant { factor: 0.3, growth: 1.1 }).expect("time control");
    mpm.set_team(Team::new(threads).expect("threads"));
    mpm.run_until((stretch - 1.0) / RATE).expect("run");
    mpm
}

/// Return the number of empty cells along the strip, the mean stretch of the particles without the last tenth of the
/// strip, which ends within a cell, and its coefficient of variation.
fn strip(mpm: &Mpm<2>) -> (usize, f64, f64) {
    let all = particles(mpm);
    let mut cells: Vec<i64> = all.iter().map(|p| (p.position[0] / H).floor() as i64).collect();
    cells.sort_unstable();
    cells.dedup();
    let empty = 1 + cells[cells.len() - 1] - cells[0] - cells.len() as i64;
    let end = all.iter().map(|p| p.position[0]).fold(0.0, f64::max);
    let all: Vec<PointView> = all.into_iter().filter(|p| p.position[0] < 0.9 * end).collect();
    let mass: f64 = all.iter().map(|p| p.mass).sum();
    // Plane strain, fixed sides: the stretch is the volume ratio.
    let stretch = |p: &PointView| p.volume * 1000.0 / p.mass;
    let mean = all.iter().map(|p| p.mass * stretch(p)).sum::<f64>() / mass;
    let variance = all.iter().map(|p| p.mass * (stretch(p) - mean).powi(2)).sum::<f64>() / mass;
    (empty as usize, mean, variance.sqrt() / mean)
}

/// Split at stretch 2: half of the stretch that leaves an empty cell between two particles.
fn at_two() -> Option<Splitting> {
    Some(Splitting::at(2.0).expect("stretch"))
}

/// At ten times its length, the strip has no gaps with particle splitting, and fractures numerically without.
fn stays_whole<M: IntoKernels<f64, 2> + Copy>(method: M) {
    let mpm = stretched(method, None, 1, 10.0);
    let (empty, stretch, variation) = strip(&mpm);
    println!("{}: {empty} empty cells, stretch {stretch:.3}, {variation:.3}", mpm.facts().description);
    assert!(empty > 20 && stretch < 5.0, "no particle is split: {empty} empty cells, stretch {stretch}");
    let mpm = stretched(method, at_two(), 1, 10.0);
    let (empty, stretch, variation) = strip(&mpm);
    println!("split: {empty} empty cells, stretch {stretch:.3}, {variation:.3}, {}", mpm.particles());
    assert_eq!(empty, 0);
    assert!((stretch - 10.0).abs() < 0.3, "stretch {stretch}");
    assert!(variation < 0.05, "coefficient of variation {variation}");
}

#[test]
fn strips_drawn_out_stay_whole() {
    stays_whole(Method::new(Linear, Flip, Musl, PlaneStrain));
    stays_whole(Method::new(CpGimp, Flip, Musl, PlaneStrain));
    stays_whole(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain));
}

#[test]
fn split_particles_do_not_depend_on_threads() {
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let one = particles(&stretched(method, at_two(), 1, 6.0));
    assert!(one.len() > 100);
    for threads in 2..=4 {
        assert_eq!(one, particles(&stretched(method, at_two(), threads, 6.0)), "{threads} threads");
    }
}

#[test]
fn bad_splitting_is_refused() {
    for stretch in [1.0, 4.1, f64::NAN] {
        assert!(Splitting::at(stretch).is_err());
    }
    let splitting = Splitting::at(2.0).expect("stretch");
    assert!(splitting.at_most(0).is_err() && splitting.at_most(17).is_err());
    let lattice = Lattice::new([0.0; 2], H).expect("lattice");
    let mut seeds: Seeds<2> = block(&lattice, [0; 2], [2; 2], 2, 0.0);
    seeds.half_size[1] *= 0.5;
    let method = Method::new(Linear, Flip, Musl, PlaneStrain);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let oblong = Deformable::new("oblong", Stretching::new(soft(1.0)).compiled(), &seeds);
    let refused = mpm.add_body(oblong.with_splitting(splitting));
    assert!(matches!(refused, Err(SceneError::Oblong { axis: 1, .. })), "{refused:?}");
    seeds.half_size[1] *= 2.0;
    // Law without stored stretch; only the scene can detect this.
    let law: Arc<dyn Material<f64>> = soft(1.0).into_material();
    let refused = mpm.add_body(Deformable::new("body", law, &seeds).with_splitting(splitting));
    assert!(matches!(refused, Err(SceneError::NoStretch { .. })), "{refused:?}");
    let mut total = Mpm::new(method.total_lagrangian(), BlockGrid::new(lattice));
    let body = Deformable::new("body", Stretching::new(soft(1.0)).compiled(), &seeds);
    let refused = total.add_body(body.with_splitting(splitting));
    assert!(matches!(refused, Err(SceneError::NotWith { .. })), "{refused:?}");
    // Particle numbers in single precision are exact to 2^24: 16 seeds of 16 generations are 2^20, 64 x 16 are too
    // many.
    let mut single = Mpm::<2, f32>::of(method.compiled(), BlockGrid::new(lattice), OneField);
    let many: Seeds<2> = block(&lattice, [0; 2], [10; 2], 2, 0.0);
    let law = NeoHookean::new(1000.0f32, Moduli::young_poisson(1e6, 0.3).expect("moduli")).expect("law");
    let finest = splitting.at_most(16).expect("generations");
    let many = Deformable::new("many", Stretching::new(law).compiled(), &many);
    let refused = single.add_body(many.with_splitting(finest));
    assert!(matches!(refused, Err(SceneError::TooMany { .. })), "{refused:?}");
}
