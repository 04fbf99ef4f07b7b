//! Particle merging: conservation laws hold, and particles split in stretching are merged again in compression.

use std::sync::Arc;

use impactite_tests::scene::{Numbers, block};
use mpm_core::SceneError;
use mpm_core::geometry::{Cuboid, Lattice, Seeds};
use mpm_core::{
    Apic, Axisymmetric, BlockGrid, Boundary, CpGimp, Cpdi, Deformable, Flip, FullSpace, IntoKernels, Linear,
    Merging, Method, Mpm, Musl, PlaneStrain, PointView, QuadraticBSpline, Splitting, Team, TimeControl,
    Totals, Usf, Usl,
};
use mpm_materials::eos::KeepEnergy;
use mpm_materials::{
    Constitutive, Elastic, Fluid, Kinematics, LinearDensity, Mat3, Moduli, NeoHookean, PlasticStrainLimit,
    Removed, Solid, Stretching, Tait, library,
};
use proptest::prelude::*;

const H: f64 = 0.1;

/// Return an elastic solid of 1000 kg/m^3 with this sound speed, m/s, and low shear stiffness.
fn soft(speed: f64) -> Solid<Elastic<f64>, LinearDensity<f64>> {
    let shear = 0.1 * 1000.0 * speed * speed;
    Solid::new(
        Elastic::new(shear).expect("strength"),
        LinearDensity::new(1000.0, speed).expect("equation of state"),
    )
}

fn particles<const D: usize>(mpm: &Mpm<D>) -> Vec<PointView> {
    mpm.bodies()[0].points()
}

/// Return randomly displaced seeds of unequal mass, four per axis and cell.
fn scattered<const D: usize>(lattice: &Lattice<D>, start: u64) -> Seeds<D> {
    let mut seeds: Seeds<D> = block(lattice, [2; D], [2; D], 4, 0.0);
    let mut numbers = Numbers::new(start);
    for (x, volume) in seeds.positions.iter_mut().zip(&mut seeds.volumes) {
        x.iter_mut().for_each(|x| *x += 0.1 * H * numbers.draw());
        *volume *= 1.0 + 0.2 * numbers.draw();
    }
    seeds
}

/// Advance scattered particles by one step in the velocity field `mean + gradient x` with relative velocities.
fn one_step<const D: usize, M: IntoKernels<f64, D>>(
    method: M,
    (mean, gradient, start): ([f64; 3], [[f64; 3]; 3], u64),
    merging: bool,
) -> Mpm<D> {
    let lattice = Lattice::new([0.0; D], H).expect("lattice");
    let seeds: Seeds<D> = scattered(&lattice, start);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let velocity = |x: [f64; D]| {
        let mut v = [0.0; D];
        for d in 0..D {
            v[d] = mean[d] + 0.002 * (1e4 * x[d]).sin();
            for e in 0..D {
                v[d] += gradient[d][e] * (x[e] - 3.0 * H);
            }
        }
        v
    };
    let law = Stretching::new(soft(0.02 * H)).compiled();
    // Splitting stretch out of reach, so that only merging changes the body.
    let mut splitting = Splitting::at(4.0).expect("stretch");
    if merging {
        splitting = splitting.with_merging(Merging::above(4).expect("count").every(1).expect("steps"));
    }
    let block = Deformable::new("block", law, &seeds).moving(velocity);
    mpm.add_body(block.with_splitting(splitting)).expect("body");
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
    worst.max((a.internal - b.internal).abs() / b.internal.abs())
}

fn sums<const D: usize>(particles: &[PointView]) -> (f64, f64, [f64; D]) {
    let (mut volume, mut domains, mut centre) = (0.0, 0.0, [0.0; D]);
    for p in particles {
        volume += p.volume;
        domains += (0..D).map(|d| p.half_edges[d][d] / H).product::<f64>();
        for d in 0..D {
            centre[d] += p.mass * p.position[d];
        }
    }
    (volume, domains, centre)
}

fn keeps_the_books<const D: usize, M: IntoKernels<f64, D> + Copy>(
    method: M,
    motion: ([f64; 3], [[f64; 3]; 3], u64),
    carried: bool,
) -> Result<(), TestCaseError> {
    let apart = one_step::<D, M>(method, motion, false);
    let merged = one_step::<D, M>(method, motion, true);
    let book = merged.bodies()[0].division().expect("particles").merges().unwrap_or_default();
    prop_assert_eq!(apart.bodies()[0].division().expect("particles").merges(), None);
    prop_assert!(book.merges > 5, "{book:?}");
    prop_assert_eq!(merged.particles() + book.removed as usize, apart.particles());
    // Tolerance: sums of a few hundred numbers, each rounded a few times.
    let error = difference(&merged.totals(), &apart.totals(), 10.0 * H);
    prop_assert!(error < 2e-14, "{error:e}, {book:?}");
    let (before, after) = (particles(&apart), particles(&merged));
    let ((volume, domains, centre), now) = (sums::<D>(&before), sums::<D>(&after));
    prop_assert!((now.0 / volume - 1.0).abs() < 1e-14, "{}", now.0 / volume);
    if carried {
        prop_assert!((now.1 / domains - 1.0).abs() < 1e-13, "{}", now.1 / domains);
    }
    for d in 0..D {
        prop_assert!((now.2[d] - centre[d]).abs() < 1e-14 * centre[d]);
    }

    let mut numbers: Vec<usize> = after.iter().map(|p| p.number).collect();
    numbers.dedup();
    prop_assert_eq!(numbers.len(), after.len());
    // Particle masses: none below the limit of splitting, and only heavier particles.
    let lightest = |all: &[PointView]| all.iter().map(|p| p.mass).fold(f64::INFINITY, f64::min);
    prop_assert!(lightest(&after) >= lightest(&before));
    Ok(())
}

/// Velocities of some tenths of a cell per step of 1 s, and stretching gradients.
fn motion() -> impl Strategy<Value = ([f64; 3], [[f64; 3]; 3], u64)> {
    let gradient = prop::array::uniform3(prop::array::uniform3(-0.1f64..0.1));
    (prop::array::uniform3(-0.03f64..0.03), gradient, 1..1_000_000u64)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]
    #[test]
    fn books_plane(motion in motion()) {
        keeps_the_books::<2, _>(Method::new(Linear, Flip, Usl, PlaneStrain).compiled(), motion, false)?;
    }
    #[test]
    fn books_plane_domains(motion in motion()) {
        keeps_the_books::<2, _>(Method::new(CpGimp, Flip, Musl, PlaneStrain), motion, true)?;
    }
    #[test]
    fn books_solid(motion in motion()) {
        keeps_the_books::<3, _>(Method::new(QuadraticBSpline, Flip, Musl, FullSpace), motion, false)?;
    }
    #[test]
    fn books_solid_domains(motion in motion()) {
        keeps_the_books::<3, _>(Method::new(CpGimp, Flip, Usl, FullSpace), motion, true)?;
    }
    #[test]
    fn books_revolution(motion in motion()) {
        keeps_the_books::<2, _>(Method::new(Linear, Flip, Usf, Axisymmetric).compiled(), motion, false)?;
    }
}

const CELLS: usize = 6;
const LENGTH: f64 = CELLS as f64 * H;
/// Stretch rate, 1/s: length ratio eight after a second.
const RATE: f64 = 2.0794415416798357;
const DRAWN: f64 = 8.0;

/// Build a strip stretched by prescribed nodal velocities in each odd second, and compressed in each even one. The law
/// is soft, so that stress is a record of the strain.
fn strip<M: IntoKernels<f64, 2>>(method: M, merging: Option<Merging>, threads: usize) -> Mpm<2> {
    let lattice = Lattice::new([0.0; 2], H).expect("lattice");
    let seeds: Seeds<2> = block(&lattice, [0, 0], [CELLS, 2], 2, 0.0);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let mut splitting = Splitting::at(2.0).expect("stretch");
    if let Some(merging) = merging {
        splitting = splitting.with_merging(merging);
    }
    let velocity = |x: [f64; 2]| [RATE * x[0], 0.0];
    let law = Stretching::new(soft(0.01 * LENGTH)).compiled();
    let strip = Deformable::new("strip", law, &seeds).moving(velocity);
    mpm.add_body(strip.with_splitting(splitting)).expect("body");
    for node in -3..=(DRAWN as i32 * CELLS as i32 + 4) {
        let x = f64::from(node) * H;
        let region = Cuboid::new([x - 0.1 * H, -10.0 * H], [x + 0.1 * H, 10.0 * H]).expect("box");
        let velocity = move |time: f64| {
            let outward = (time.floor() as i64) % 2 == 0;
            [Some(if outward { RATE * x } else { -RATE * x }), Some(0.0), None]
        };
        let boundary = Boundary::Prescribed { region: Arc::new(region), velocity: Arc::new(velocity) };
        mpm.bound(boundary).expect("region");
    }
    mpm.set_time_control(TimeControl::Fixed(0.002)).expect("time control");
    mpm.set_team(Team::new(threads).expect("threads"));
    mpm
}

/// Return the number of empty cell columns along the strip and the largest number of particles per cell.
fn cells(all: &[PointView]) -> (usize, usize) {
    let mut cells: Vec<[i64; 2]> =
        all.iter().map(|p| [0, 1].map(|d| (p.position[d] / H).floor() as i64)).collect();
    cells.sort_unstable();
    let most = cells.chunk_by(|a, b| a == b).map(<[_]>::len).max().unwrap_or(0);
    let mut columns: Vec<i64> = cells.iter().map(|c| c[0]).collect();
    columns.dedup();
    let empty = columns[columns.len() - 1] - columns[0] + 1 - columns.len() as i64;
    (empty as usize, most)
}

/// A strip stretched to eight times its length and compressed three times has no gaps. After every compression it has few
/// particles, whereas without merging it has four times the initial number.
fn closes_again<M: IntoKernels<f64, 2> + Copy>(method: M, above: usize) {
    let mut apart = strip(method, None, 1);
    apart.run_until(2.0).expect("run");
    let (apart, (_, crowd)) = (apart.particles(), cells(&particles(&apart)));
    let mut mpm = strip(method, Some(Merging::above(above).expect("count")), 1);
    let seeds = mpm.particles();
    for second in 1..=6 {
        mpm.run_until(f64::from(second)).expect("run");
        let all = particles(&mpm);
        let (empty, most) = cells(&all);
        let book = mpm.bodies()[0].division().expect("particles").merges();
        println!("{} {second}: {} particles, {empty} {most}, {book:?}", mpm.facts().description, all.len());
        assert_eq!(empty, 0, "after {second} s");
        let mut numbers: Vec<usize> = all.iter().map(|p| p.number).collect();
        numbers.dedup();
        assert_eq!(numbers.len(), all.len(), "numbers are unique");
        let mass: f64 = all.iter().map(|p| p.mass).sum();
        assert!((mass / (1000.0 * LENGTH * 2.0 * H) - 1.0).abs() < 1e-13, "{mass}");
        if second % 2 == 0 {
            assert!(2 * all.len() <= apart, "{} of {apart}", all.len());
            assert!(most < crowd, "{most} in a cell, {crowd} unmerged");
        } else {
            assert!(all.len() > 3 * seeds, "{}", all.len());
        }
    }
}

#[test]
fn strips_drawn_out_and_pushed_together_stay_whole() {
    closes_again(Method::new(Linear, Flip, Musl, PlaneStrain), 8);
    // Stencils of three nodes: cells are centred on nodes and have half as many particles at the edges.
    closes_again(Method::new(CpGimp, Flip, Musl, PlaneStrain), 4);
    closes_again(Method::new(QuadraticBSpline, Flip, Usl, PlaneStrain).compiled(), 4);
}

/// Build a block in translation that elongates at unit rate and thins: part of a jet.
fn jet<M: IntoKernels<f64, 2>>(method: M, merging: Option<Merging>, threads: usize) -> Mpm<2> {
    let lattice = Lattice::new([0.0; 2], H).expect("lattice");
    let seeds: Seeds<2> = block(&lattice, [-3, -3], [6, 6], 2, 0.0);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let mut splitting = Splitting::at(2.0).expect("stretch");
    if let Some(merging) = merging {
        splitting = splitting.with_merging(merging);
    }
    let velocity = |x: [f64; 2]| [0.5 + x[0], 0.3 - 0.12 * x[1]];
    let law = Stretching::new(soft(0.01 * LENGTH)).compiled();
    let jet = Deformable::new("jet", law, &seeds).moving(velocity);
    mpm.add_body(jet.with_splitting(splitting)).expect("body");
    mpm.set_time_control(TimeControl::Courant { factor: 0.3, growth: 1.1 }).expect("time control");
    mpm.set_team(Team::new(threads).expect("threads"));
    mpm
}

#[test]
fn what_flies_apart_keeps_momentum_and_energy() {
    let method = Method::new(CpGimp, Flip, Musl, PlaneStrain);
    let run = |merging| {
        let mut mpm = jet(method, merging, 1);
        let start = mpm.totals();
        let mut most = 0;
        while !mpm.reached(6.0) {
            mpm.step_towards(6.0).expect("step");
            most = most.max(mpm.particles());
        }
        let (end, split) = (mpm.totals(), mpm.exchange().conversion);
        // Tolerance: round-off of some thousand steps.
        let scale = start.momentum_scale;
        for d in 0..2 {
            assert!((end.momentum[d] - start.momentum[d]).abs() < 1e-13 * scale, "{d}");
        }
        assert!((end.mass / start.mass - 1.0).abs() < 1e-13);
        let energy = (end.kinetic + end.internal - split) / (start.kinetic + start.internal);
        let moment = (end.angular_momentum[2] - start.angular_momentum[2]) / (scale * LENGTH);
        println!(
            "{most} {}: {energy}, {moment:e}, {:?}",
            end.particles,
            mpm.bodies()[0].division().expect("particles").merges()
        );
        (most, end.particles, energy, moment)
    };
    let apart = run(None);
    let merged = run(Some(Merging::above(6).expect("count")));
    assert!(merged.0 < apart.0 && 6 * merged.1 < 5 * apart.1, "{} of {} particles", merged.1, apart.1);
    // The grid's errors of energy and angular momentum are far below this limit, and merging adds none.
    assert!((apart.2 - 1.0).abs() < 2e-6 && (merged.2 - apart.2).abs() < 2e-8, "{} {}", apart.2, merged.2);
    assert!(merged.3.abs() < 2e-8, "{:e}", merged.3);
}

#[test]
fn merged_particles_do_not_depend_on_threads() {
    let method = Method::new(CpGimp, Flip, Musl, PlaneStrain);
    let run = |threads| {
        let mut mpm = strip(method, Some(Merging::above(4).expect("count")), threads);
        mpm.run_until(2.5).expect("run");
        (particles(&mpm), mpm.bodies()[0].division().expect("particles").merges())
    };
    let one = run(1);
    assert!(one.1.is_some_and(|book| book.merges > 50), "{:?}", one.1);
    for threads in 2..=3 {
        assert_eq!(one, run(threads), "{threads} threads");
    }
}

/// A run resumed from a checkpoint after merges continues bit for bit.
#[test]
fn resumed_runs_merge_alike() {
    let method = Method::new(Linear, Flip, Musl, PlaneStrain);
    let scene = || strip(method, Some(Merging::above(4).expect("count")), 1);
    let path = std::env::temp_dir().join(format!("impactite-merging-{}", std::process::id()));
    let mut whole = scene();
    // At 0.002 s per step: after a tenth step, when tiles are due for remapping.
    whole.run_until(1.7).expect("run");
    assert!(whole.bodies()[0].division().expect("particles").merges().is_some_and(|book| book.merges > 0));
    whole.save(&path).expect("checkpoint");
    let resumed = scene().resumed(&path);
    let _ = std::fs::remove_file(&path);
    let mut resumed = resumed.expect("the scene");
    for mpm in [&mut whole, &mut resumed] {
        mpm.run_until(2.1).expect("run");
    }
    assert_eq!(particles(&whole), particles(&resumed));
    assert_eq!(
        whole.bodies()[0].division().expect("particles").merges(),
        resumed.bodies()[0].division().expect("particles").merges()
    );
}

type StateOf<C> = <C as Constitutive<f64>>::State<f64>;

/// Merge material points of a law, each strained by one of `strains` along x.
fn merged<C: Constitutive<f64>>(law: &C, strains: &[f64]) -> Option<(Vec<StateOf<C>>, StateOf<C>)> {
    let strained = |&strain: &f64| {
        let mut kinematics = Kinematics { increment: Mat3::zero(), dt: 1e-6, length: 1e-3 };
        kinematics.increment.0[0][0] = strain;
        law.update(&kinematics, &law.virgin()).state
    };
    let states: Vec<_> = strains.iter().map(strained).collect();
    let points: Vec<_> = states.iter().enumerate().map(|(n, state)| (1.0 + n as f64, *state)).collect();
    law.merged(&points).map(|one| (states, one))
}

#[test]
fn laws_keep_volume_and_energy() {
    let strains = [1e-3, 2e-2, -1e-2, 5e-3];
    fn check<C: Constitutive<f64>>(law: &C, strains: &[f64]) {
        let (states, one) = merged(law, strains).expect("alike");
        let (mut volume, mut energy, mut mass) = (0.0, 0.0, 0.0);
        for (n, state) in states.iter().enumerate() {
            let m = 1.0 + n as f64;
            volume += m * law.volume_ratio(state);
            energy += m * law.energy(state);
            mass += m;
        }
        // Tolerance: ten roundings.
        assert!((law.volume_ratio(&one) * mass / volume - 1.0).abs() < 1e-15);
        assert!((law.energy(&one) * mass / energy - 1.0).abs() < 1e-14);
        // Refuse volumes too far apart, and non-finite values.
        assert!(merged(law, &[0.1, -0.1]).is_none());
        assert!(merged(law, &[f64::NAN, 0.0]).is_none());
    }
    check(&soft(1000.0), &strains);
    check(&library::lead(), &strains);
    check(&Fluid::new(KeepEnergy(Tait::new(1000.0, 1500.0).expect("water"))), &strains);
    // Two of the points have strains beyond failure.
    let limit = PlasticStrainLimit::new(5e-3).expect("limit");
    let failing = library::lead().with_failure(limit);
    assert!(merged(&failing, &strains).is_none());
    assert!(merged(&failing, &[1e-4, 2e-4]).is_some() && merged(&failing, &[2e-2, 2.1e-2]).is_some());
    // Refuse laws whose state variables have no conservative mean, and deleted points.
    assert!(merged(&Fluid::new(Tait::new(1000.0, 1500.0).expect("water")), &[0.0, 0.0]).is_none());
    assert!(merged(&library::lead().with_failure(Removed(limit)), &[0.0, 0.0]).is_none());
    let moduli = Moduli::young_poisson(1e6, 0.3).expect("moduli");
    assert!(merged(&NeoHookean::new(1000.0, moduli).expect("law"), &[0.0, 0.0]).is_none());
}

fn refused<M: IntoKernels<f64, 2>, C: Constitutive<f64>>(method: M, law: C) -> Result<(), SceneError> {
    let lattice = Lattice::new([0.0; 2], H).expect("lattice");
    let seeds: Seeds<2> = block(&lattice, [0; 2], [2; 2], 2, 0.0);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let splitting = Splitting::at(2.0).expect("stretch").with_merging(Merging::above(8).expect("count"));
    mpm.add_body(Deformable::new("body", Stretching::new(law).compiled(), &seeds).with_splitting(splitting))
}

#[test]
fn bad_merging_is_refused() {
    assert!(Merging::above(1).is_err());
    assert!(Merging::above(8).expect("count").every(0).is_err());
    let names = |refused: Result<(), SceneError>, what: &str| {
        let error = refused.expect_err(what);
        assert!(matches!(error, SceneError::NoMerging { .. }) && error.to_string().contains(what), "{error}");
    };
    let law = soft(1.0);
    names(refused(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), law), "APIC");
    names(refused(Method::new(Cpdi, Flip, Usl, PlaneStrain).compiled(), law), "CPDI");
    let moduli = Moduli::young_poisson(1e6, 0.3).expect("moduli");
    let rubber = NeoHookean::new(1000.0, moduli).expect("law");
    names(refused(Method::new(Linear, Flip, Usl, PlaneStrain).compiled(), rubber), "Hookean");
    refused(Method::new(Linear, Flip, Usl, PlaneStrain).compiled(), law).expect("body");
}
