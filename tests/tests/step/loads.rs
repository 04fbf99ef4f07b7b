//! Surface loads and prescribed velocities: impulse accounting to round-off, and energy balance with their work.
//! Damping and relaxation: accounting of dissipated energy, and convergence to the static state. Null-space filter:
//! removal of only those velocities that the nodes do not see. Frequency bounds: agreement with the step control.

use std::sync::Arc;

use impactite_tests::compare::{fast, particles};
use impactite_tests::scene::{Numbers, block, rubber};
use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::{
    Apic, Blend, BlockGrid, Boundary, CpGimp, Deformable, Flip, FullSpace, IntoKernels, Linear, Method, Mls,
    Mpm, Musl, PlaneStrain, QuadraticBSpline, Rest, Side, Splitting, Team, TimeControl, Traction, Usf, Usl,
};
use mpm_materials::{Constitutive, LinearElastic, Moduli, Stretching};

/// Pull a free block at its top face by a ramped traction, then by a step load.
fn pull<M: IntoKernels<f64, 3> + Copy>(method: M, allowed: f64) {
    // Impulse of 4 m^2 times the traction over time; error of one step at the ends of the ramp.
    pull_by(method, |t| [0.02 * t, 0.0, 0.1 * t.min(1.0)], [4.0 * 0.02 * 2.0, 0.0, 4.0 * 0.1 * 1.5], allowed);
    pull_by(method, |_| [0.0, 0.0, 0.1], [0.0, 0.0, 4.0 * 0.1 * 2.0], allowed);
}

/// Compare the momentum and energy with the ledger.
fn pull_by<M: IntoKernels<f64, 3>>(
    method: M,
    history: impl Fn(f64) -> [f64; 3] + Send + Sync + 'static,
    exact: [f64; 3],
    allowed: f64,
) {
    let lattice = Lattice::new([0.0; 3], 0.5).unwrap();
    let block = Cuboid::new([0.0; 3], [2.0, 2.0, 4.0]).unwrap();
    let seeds = fill(&block, &lattice, 2, &Filling::new()).unwrap();
    let law = LinearElastic::new(1.0, Moduli::young_poisson(100.0, 0.3).unwrap()).unwrap();
    let top = Cuboid::new([0.0, 0.0, 3.75], [2.0, 2.0, 4.0]).unwrap();
    let load = Traction { region: Arc::new(top), axis: 2, history: Arc::new(history), revolved: false };
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let name = mpm.facts().description.clone();
    mpm.add_body(Deformable::new("block", law, &seeds).with_traction(load)).unwrap();
    mpm.set_time_control(TimeControl::Fixed(0.02)).unwrap();
    mpm.run_until(2.0).unwrap();
    let (totals, ledger) = (mpm.totals(), mpm.exchange());
    for d in 0..3 {
        let error = totals.momentum[d] - ledger.load[d];
        assert!(error.abs() < 1e-12 * totals.momentum_scale, "component {d}: momentum error {error:e}");
    }
    for d in 0..3 {
        assert!((totals.momentum[d] - exact[d]).abs() < 0.02, "component {d}: {:?}", totals.momentum);
    }
    let energy = totals.kinetic + totals.internal;
    let gained = energy / ledger.work - 1.0;
    assert!((-allowed..2e-3).contains(&gained), "{name}: energy {energy}, work {}", ledger.work);
}

#[test]
fn a_pulled_block_with_musl() {
    pull(Method::new(Linear, Flip, Musl, FullSpace), 5e-3);
}

#[test]
fn a_pulled_block_with_usl() {
    pull(Method::new(CpGimp, Flip, Usl, FullSpace), 5e-3);
}

#[test]
fn a_pulled_block_with_usf() {
    pull(Method::new(QuadraticBSpline, Flip, Usf, FullSpace).compiled(), 5e-3);
}

#[test]
fn a_pulled_block_with_momentum_and_impulse_together() {
    // Dissipation of the transfer is not work.
    pull(Method::new(QuadraticBSpline, Mls, Usl, FullSpace), 1e-2);
}

/// Law that stores its stretch.
type Soft = mpm_materials::CompiledHere<Stretching<LinearElastic<f64>>>;

/// Build an elongating block under a step traction at its top face, with further options `more`.
fn drawn<M: IntoKernels<f64, 3>>(
    method: M,
    more: impl Fn(Deformable<'_, 3, Soft>) -> Deformable<'_, 3, Soft>,
) -> Mpm<3> {
    let lattice = Lattice::new([0.0; 3], 0.5).unwrap();
    let block = Cuboid::new([0.0; 3], [2.0, 2.0, 4.0]).unwrap();
    let seeds = fill(&block, &lattice, 2, &Filling::new()).unwrap();
    let top = Cuboid::new([0.0, 0.0, 3.75], [2.0, 2.0, 4.0]).unwrap();
    let history = Arc::new(|_: f64| [0.02, 0.0, 0.1]);
    let load = Traction { region: Arc::new(top), axis: 2, history, revolved: false };
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let block = Deformable::new("block", soft().compiled(), &seeds).moving(|x| [0.0, 0.0, 0.05 * x[2]]);
    mpm.add_body(more(block.with_traction(load))).unwrap();
    mpm.set_time_control(TimeControl::Fixed(0.02)).unwrap();
    mpm
}

fn soft() -> Stretching<LinearElastic<f64>> {
    Stretching::new(LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.3).unwrap()).unwrap())
}

/// The impulse of a traction is complete for split particles, for initially stressed particles, and for both.
#[test]
fn what_is_pulled_may_be_split_and_start_stressed() {
    fn check<M: IntoKernels<f64, 3> + Copy>(method: M) {
        let splitting = Splitting::at(1.05).unwrap();
        let stressed = |x: [f64; 3]| {
            let mut state = soft().virgin();
            state.law.stress.0 = [1e-3, -2e-3, 3e-3 * x[2], 0.0, 5e-4 * x[0], 0.0];
            state.law.volume_ratio = 0.99;
            state
        };
        let scenes = [
            ("split", drawn(method, |block| block.with_splitting(splitting))),
            ("stressed", drawn(method, |block| block.in_state(stressed))),
            ("both", drawn(method, |block| block.in_state(stressed).with_splitting(splitting))),
        ];
        for (what, mut mpm) in scenes {
            let what = format!("{what}, {}", mpm.facts().description);
            let (before, seeds) = (mpm.totals(), mpm.particles());
            let start = particles(&mpm).remove(0);
            // Seed of a particle: remainder of its number by the number of seeds.
            let loaded = |mpm: &Mpm<3>| {
                mpm.bodies()[0].points().iter().filter(|p| start[p.number % seeds].position[2] > 3.75).count()
            };
            assert_eq!(loaded(&mpm), 64);
            mpm.run_until(2.0).unwrap();
            let (after, ledger, cuts) =
                (mpm.totals(), mpm.exchange(), mpm.bodies()[0].division().expect("particles").splits().cuts);
            for d in 0..3 {
                let error = after.momentum[d] - before.momentum[d] - ledger.load[d];
                assert!(error.abs() < 1e-12 * after.momentum_scale, "{what}, component {d}: {error:e}");
            }
            // Traction on 4 m^2 for 2 s, independent of the number of particles that share the area.
            for (d, exact) in [4.0 * 0.02 * 2.0, 0.0, 4.0 * 0.1 * 2.0].into_iter().enumerate() {
                assert!((ledger.load[d] - exact).abs() < 1e-12, "{what}, component {d}: {:?}", ledger.load);
            }
            println!("{what}: {cuts} cuts, {} particles carry the load", loaded(&mpm));
            assert_eq!(mpm.particles(), seeds + cuts as usize);
            assert_eq!(loaded(&mpm) > 64, !what.starts_with("stressed"), "{what}: {cuts} cuts");
        }
    }
    check(Method::new(Linear, Flip, Musl, FullSpace));
    check(Method::new(CpGimp, Flip, Usl, FullSpace));
    check(Method::new(QuadraticBSpline, Flip, Usf, FullSpace).compiled());
    check(Method::new(QuadraticBSpline, Mls, Usl, FullSpace));
}

/// A splitting stretch that no particle reaches changes no bit of the results.
#[test]
fn splitting_that_is_not_reached_changes_nothing() {
    fn check<M: IntoKernels<f64, 3> + Copy>(method: M) {
        let mut whole = drawn(method, |block| block);
        let mut split = drawn(method, |block| block.with_splitting(Splitting::at(4.0).unwrap()));
        for _ in 0..100 {
            whole.step().unwrap();
            split.step().unwrap();
        }
        let name = &whole.facts().description;
        assert_eq!(split.bodies()[0].division().expect("particles").splits().cuts, 0, "{name}");
        assert!(whole.exchange().load[2] > 0.7, "{name}: no load");
        assert_eq!(format!("{:?}", whole.exchange()), format!("{:?}", split.exchange()), "{name}");
        assert!(particles(&whole) == particles(&split), "{name}");
    }
    check(Method::new(Linear, Flip, Musl, FullSpace));
    check(Method::new(CpGimp, Flip, Usl, FullSpace));
    check(Method::new(QuadraticBSpline, Flip, Usf, FullSpace).compiled());
    check(Method::new(QuadraticBSpline, Mls, Usl, FullSpace));
}

#[test]
fn a_dragged_block_takes_the_prescribed_velocity() {
    let lattice = Lattice::new([0.0; 3], 0.5).unwrap();
    let block = Cuboid::new([0.0; 3], [2.0, 2.0, 4.0]).unwrap();
    let seeds = fill(&block, &lattice, 2, &Filling::new()).unwrap();
    let law = LinearElastic::new(1.0, Moduli::young_poisson(100.0, 0.3).unwrap()).unwrap();
    let method = Method::new(Linear, Flip, Musl, FullSpace);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("block", law, &seeds, |_| [0.0, 0.02, 0.0]).unwrap();
    // Lower half: prescribed velocity along x and z, free along y.
    let region = Arc::new(Cuboid::new([-1.0, -1.0, -1.0], [9.0, 3.0, 2.0]).unwrap());
    let velocity = Arc::new(|_: f64| [Some(0.05), None, Some(0.0)]);
    mpm.bound(Boundary::Prescribed { region, velocity }).unwrap();
    mpm.run_until(0.5).unwrap();
    let mut dragged = 0;
    mpm.bodies()[0].for_each(&mut |p| {
        if p.position[2] < 1.5 {
            dragged += 1;
            // Positions follow the nodes exactly; FLIP velocities keep the part of waves that nodes do not see.
            let moved = p.position[0] - seeds.positions[p.number][0];
            assert!((moved - 0.05 * 0.5).abs() < 1e-12, "{p:?}");
            assert!((p.velocity[0] - 0.05).abs() < 5e-3, "{p:?}");
        }
    });
    assert!(dragged > 100);
    let (totals, ledger) = (mpm.totals(), mpm.exchange());
    let given = totals.momentum[0] - ledger.impulse[0];
    assert!(given.abs() < 1e-12 * totals.momentum_scale, "momentum error {given:e}");
    assert!(ledger.work > 0.0);
}

/// Local damping: its dissipation is accounted for, and a column under its weight comes to rest under the static
/// stress.
#[test]
fn a_damped_column_comes_to_rest() {
    fn column<M: IntoKernels<f64, 2>>(method: M, filters: bool) {
        let (h, cells, gravity) = (0.1, 10, 0.01);
        let lattice = Lattice::new([0.0; 2], h).unwrap();
        let length = f64::from(cells) * h;
        let seeds = fill(&Cuboid::new([0.0; 2], [h, length]).unwrap(), &lattice, 2, &Filling::new()).unwrap();
        let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.0).unwrap()).unwrap();
        let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
        mpm.add("column", law, &seeds, |_| [0.0; 2]).unwrap();
        mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
        mpm.bound(Boundary::Symmetry { axis: 0, at: h, side: Side::Below }).unwrap();
        mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).unwrap();
        mpm.set_body_force(move |_| [0.0, -gravity]);
        mpm.set_time_control(TimeControl::Fixed(0.3 * h)).unwrap();
        mpm.set_local_damping(0.5).unwrap();
        let mut largest: f64 = 0.0;
        for _ in 0..1500 {
            mpm.step().unwrap();
            largest = largest.max(mpm.totals().kinetic);
        }
        let (totals, ledger) = (mpm.totals(), mpm.exchange());
        for d in 0..2 {
            let error = totals.momentum[d] - ledger.load[d] - ledger.impulse[d];
            assert!(error.abs() < 1e-12 * gravity * 45.0, "{}: {error:e}", mpm.facts().description);
        }
        let energy = totals.kinetic + totals.internal;
        assert!(ledger.damping > 0.0, "{}", ledger.damping);
        let gained = (energy + ledger.damping - ledger.work) / energy;
        assert!(gained < 0.02, "energy {energy}, work {}", ledger.work);
        // The dissipation of the FLIP/PIC blend is not accounted for.
        assert!(filters || gained > -0.02, "energy {energy}, work {}", ledger.work);
        // Nodal forces cannot damp particle velocities in the null space of the map; the blend damps them.
        let still = if filters { 5e-3 } else { 1e-6 };
        assert!(totals.kinetic < still * largest, "{} of {largest} is left", totals.kinetic);
        mpm.bodies()[0].for_each(&mut |p| {
            let start = seeds.positions[p.number];
            // Linear shape functions give the cell mean of the stress, a quarter of a cell away; the strain is 1 %.
            let exact = -gravity * (length - start[1]);
            assert!(
                (p.stress[1] - exact).abs() < (0.25 * h + 0.02 * length) * gravity,
                "{} for {exact}",
                p.stress[1]
            );
        });
    }
    column(Method::new(Linear, Flip, Musl, PlaneStrain), false);
    // The blend dissipates energy itself. With FLIP alone, null-space noise of the particles would persist.
    let blend = Blend::new(1.0).unwrap();
    column(Method::new(QuadraticBSpline, blend, Usf, PlaneStrain).compiled(), true);
    column(Method::new(Linear, Flip, Usl, PlaneStrain).total_lagrangian().compiled(), false);
}

#[test]
fn damping_that_cannot_be_is_refused() {
    let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
    let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    for bad in [-0.1, 1.0, f64::NAN] {
        let error = mpm.set_local_damping(bad).unwrap_err().to_string();
        assert!(error.contains("[0, 1)"), "{error}");
    }
    let method = Method::new(QuadraticBSpline, Mls, Usl, PlaneStrain);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let error = mpm.set_local_damping(0.5).unwrap_err().to_string();
    assert!(error.contains("forces of the nodes"), "{error}");
}

/// Kinetic damping: a column under its weight comes to rest under the static stress for every stress update order, and the
/// dissipation is accounted for.
#[test]
fn a_column_comes_to_rest_by_kinetic_damping() {
    fn column<M: IntoKernels<f64, 2>>(method: M) {
        let (h, cells, gravity) = (0.1, 10, 0.01);
        let length = f64::from(cells) * h;
        let mut mpm = Mpm::new(method, BlockGrid::new(Lattice::new([0.0; 2], h).unwrap()));
        let name = mpm.facts().description.clone();
        let seeds = block(mpm.grid().lattice(), [0; 2], [1, 10], 2, 0.0);
        let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.0).unwrap()).unwrap();
        mpm.add("column", law, &seeds, |_| [0.0; 2]).unwrap();
        mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
        mpm.bound(Boundary::Symmetry { axis: 0, at: h, side: Side::Below }).unwrap();
        mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).unwrap();
        mpm.set_body_force(move |_| [0.0, -gravity]);
        mpm.set_time_control(TimeControl::Fixed(0.3 * h)).unwrap();
        mpm.set_kinetic_damping(true).unwrap();
        // The oscillation period of the column is 4 s.
        let rested = mpm.run_to_rest(&Rest::new(1e-4, 1e-6, 4.0).unwrap(), 200.0).unwrap();
        println!("{name}: {rested:?} after {} s, {} stops", mpm.time(), mpm.stops());
        assert!(rested.reached && mpm.stops() > 0, "{name}: {rested:?}");
        let (totals, ledger) = (mpm.totals(), mpm.exchange());
        for d in 0..2 {
            let error = totals.momentum[d] - ledger.load[d] - ledger.impulse[d];
            assert!(error.abs() < 1e-12 * gravity * 45.0, "{name}: {error:e}");
        }
        let energy = totals.kinetic + totals.internal;
        // Every stop leaves an error of first order in the step: 4.3 %, and 2.0 % at half the step.
        let closes = (energy + ledger.damping - ledger.work).abs() < 0.05 * energy;
        assert!(closes, "{name}: energy {energy}, work {}", ledger.work);
        mpm.bodies()[0].for_each(&mut |p| {
            let exact = -gravity * (length - seeds.positions[p.number][1]);
            // Linear shape functions give the cell mean of the stress, a quarter of a cell away; the strain is 1 %.
            let allowed = (0.25 * h + 0.02 * length) * gravity;
            assert!((p.stress[1] - exact).abs() < allowed, "{name}: {} for {exact}", p.stress[1]);
        });
    }
    column(Method::new(Linear, Flip, Musl, PlaneStrain));
    column(Method::new(Linear, Flip, Usl, PlaneStrain).total_lagrangian().compiled());
    column(Method::new(Linear, Flip, Usf, PlaneStrain).compiled());
}

/// A traction stretches a block to the static solution, and the momentum removed by stops is accounted for.
#[test]
fn a_pulled_block_comes_to_rest() {
    // The energy balance of stops is of first order in the step.
    let books = [0.02, 0.01].map(pulled_to_rest);
    assert!(books[0] < 0.08 && books[1] < 0.55 * books[0], "{books:?}");
}

/// Relative error of the energy balance of a block pulled to rest.
fn pulled_to_rest(dt: f64) -> f64 {
    let lattice = Lattice::new([0.0; 2], 0.5).unwrap();
    let seeds = block(&lattice, [0; 2], [4, 8], 2, 0.0);
    let law = LinearElastic::new(1.0, Moduli::young_poisson(100.0, 0.3).unwrap()).unwrap();
    let top = Cuboid::new([0.0, 3.75], [2.0, 4.0]).unwrap();
    let (region, history) = (Arc::new(top), Arc::new(|_: f64| [0.0, 0.1]));
    let load = Traction { region, axis: 1, history, revolved: false };
    let method = Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian();
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add_body(Deformable::new("block", law, &seeds).with_traction(load)).unwrap();
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).unwrap();
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    mpm.set_time_control(TimeControl::Fixed(dt)).unwrap();
    mpm.set_kinetic_damping(true).unwrap();
    let rested = mpm.run_to_rest(&Rest::new(1e-6, 1e-9, 2.0).unwrap(), 100.0).unwrap();
    assert!(rested.reached, "{rested:?}");
    // Loaded layer: a quarter of a cell below the top, so that the last row of cells carries three quarters of 0.1
    // Pa. The area is 2 m^2 per metre of depth, and the plane strain modulus is E / (1 - nu^2).
    let exact = 0.5 * 0.1f64.powi(2) / (100.0 / 0.91) * 2.0 * (3.5 + 0.5 * 0.75f64.powi(2));
    let energy = rested.balance.internal;
    // The strain of 1e-3 changes lengths, and the corners of the loaded row are stretched unevenly.
    assert!((energy / exact - 1.0).abs() < 2e-3, "energy {energy:e} for {exact:e}");
    let (totals, ledger) = (mpm.totals(), mpm.exchange());
    for d in 0..2 {
        let error = totals.momentum[d] - ledger.load[d] - ledger.impulse[d];
        // Scale: impulse of the load over the run time.
        assert!(error.abs() < 1e-12 * 0.2 * mpm.time(), "{error:e}");
    }
    ((energy + ledger.damping - ledger.work) / energy).abs()
}

/// Kinetic damping and filters do not depend on the number of threads.
#[test]
fn ways_to_rest_do_not_depend_on_threads() {
    let run = |threads: usize| {
        let mut scene = impactite_tests::scene::flow::<2>();
        scene.bodies.truncate(1);
        let method = Method::new(Linear, Flip, Musl, PlaneStrain);
        let mut mpm = fast(method, BlockGrid::new(scene.lattice), &scene, &rubber());
        mpm.set_team(Team::new(threads).unwrap());
        mpm.set_kinetic_damping(true).unwrap();
        mpm.set_null_space_filter(3).unwrap();
        for _ in 0..60 {
            mpm.step().unwrap();
        }
        assert!(mpm.stops() > 0, "nothing was stopped");
        (particles(&mpm), mpm.exchange().work.to_bits(), mpm.balance().unbalanced.to_bits())
    };
    let one = run(1);
    for threads in 2..=4 {
        assert!(one == run(threads), "{threads} threads");
    }
}

/// Build a block with velocity noise, `per_axis` particles per cell and axis.
fn noisy<M: IntoKernels<f64, 2>>(method: M, per_axis: usize) -> Mpm<2> {
    let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
    let seeds = block(&lattice, [0; 2], [5, 3], per_axis, 0.3);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let velocity = |x: [f64; 2]| {
        let mut random = Numbers::new((1e6 * (x[0] + 10.0 * x[1])) as u64);
        [1e-3 * random.draw(), 1e-3 * random.draw()]
    };
    mpm.add("block", rubber(), &seeds, velocity).unwrap();
    mpm.set_time_control(TimeControl::Fixed(0.01)).unwrap();
    mpm
}

/// The null-space filter keeps the velocities that nodes see, and nodes do not see its action: in the reference
/// configuration, where weights are constant, stresses and positions are the same with and without it.
#[test]
fn the_null_space_filter_takes_what_nodes_do_not_see() {
    let method = || Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian();
    let run = |filter: bool, per_axis: usize| {
        let mut mpm = noisy(method(), per_axis);
        let start = mpm.totals().kinetic;
        if filter {
            mpm.set_null_space_filter(1).unwrap();
        }
        for _ in 0..40 {
            mpm.step().unwrap();
        }
        let (totals, ledger) = (mpm.totals(), mpm.exchange());
        let books = totals.kinetic + totals.internal + ledger.damping - ledger.work - start;
        (particles(&mpm).remove(0), totals.kinetic, books, mpm)
    };
    let (with, kinetic, books, filtered) = run(true, 3);
    let (without, noise, as_ever, _) = run(false, 3);
    // Null space of a cell: five of nine directions, with half of the noise or more.
    println!("kinetic {kinetic:e} with, {noise:e} without; books {books:e}, {as_ever:e}");
    assert!(kinetic < 0.6 * noise, "{kinetic:e} of {noise:e} is left");
    // Round-off of singular vectors is some 1e-12 for cells whose particles are nearly collinear.
    assert!((books - as_ever).abs() < 1e-10 * noise, "books {books:e}, {as_ever:e}");
    for (a, b) in with.iter().zip(&without) {
        for d in 0..2 {
            assert!((a.position[d] - b.position[d]).abs() < 1e-13, "{a:?} for {b:?}");
        }
        for i in 0..6 {
            assert!((a.stress[i] - b.stress[i]).abs() < 1e-11, "{a:?} for {b:?}");
        }
    }
    // The filtered velocity of a cell is bilinear in position: a mass-weighted least-squares fit leaves no
    // residual.
    let mut cells = std::collections::BTreeMap::<[i64; 2], Vec<[f64; 4]>>::new();
    filtered.for_each_footprint(&mut |p| {
        let low = p.nodes.iter().map(|w| w.node).min().unwrap();
        let at = |node: [i32; 2]| p.nodes.iter().find(|w| w.node == node).map_or(0.0, |w| w.value);
        let x = at([low[0] + 1, low[1]]) + at([low[0] + 1, low[1] + 1]);
        let y = at([low[0], low[1] + 1]) + at([low[0] + 1, low[1] + 1]);
        cells.entry(low.map(i64::from)).or_default().push([p.mass, x, y, p.velocity[0]]);
    });
    assert_eq!(cells.len(), 15);
    for (cell, rows) in &cells {
        let left = misfit(rows);
        assert!(left < 1e-12, "cell {cell:?}: {left:e} m/s is not bilinear");
    }
    // Two particles per axis: cells have no null space, and the filter changes only round-off.
    let (with, kinetic, ..) = run(true, 2);
    let (without, noise, ..) = run(false, 2);
    assert!((kinetic / noise - 1.0).abs() < 1e-12 && with.len() == without.len());
}

/// Return the largest residual of [mass, x, y, v] from the bilinear fit by normal equations.
fn misfit(rows: &[[f64; 4]]) -> f64 {
    let basis = |r: &[f64; 4]| [1.0, r[1], r[2], r[1] * r[2]];
    let mut a = [[0.0; 5]; 4];
    for r in rows {
        let b = basis(r);
        for i in 0..4 {
            for j in 0..4 {
                a[i][j] += r[0] * b[i] * b[j];
            }
            a[i][4] += r[0] * b[i] * r[3];
        }
    }
    for i in 0..4 {
        for k in (0..4).filter(|&k| k != i) {
            let share = a[k][i] / a[i][i];
            for j in i..5 {
                a[k][j] -= share * a[i][j];
            }
        }
    }
    let fit = |r: &[f64; 4]| {
        basis(r).iter().zip(&a).enumerate().map(|(i, (b, row))| b * row[4] / row[i]).sum::<f64>()
    };
    rows.iter().map(|r| (r[3] - fit(r)).abs()).fold(0.0, f64::max)
}

/// Half a body at a symmetry plane has the frequency bound and the balance of the whole body.
#[test]
fn diagnostics_know_planes_of_symmetry() {
    let model = |low: i64, cells: usize| {
        let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
        let seeds = block(&lattice, [low, 0], [cells, 3], 2, 0.0);
        let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
        let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
        mpm.add("block", rubber(), &seeds, |x| [0.01 * x[0], 0.02 * x[0] * x[0]]).unwrap();
        if low == 0 {
            mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
        }
        mpm.set_body_force(|_| [0.0, -1e-3]);
        mpm.set_time_control(TimeControl::Fixed(0.02)).unwrap();
        for _ in 0..10 {
            mpm.step().unwrap();
        }
        (mpm.frequency_bound(), mpm.balance())
    };
    let ((whole, all), (half, part)) = (model(-4, 8), model(0, 4));
    assert!((half.bound / whole.bound - 1.0).abs() < 1e-12, "{half:?} for {whole:?}");
    assert!((part.unbalanced.powi(2) / all.unbalanced.powi(2) - 0.5).abs() < 1e-9, "{part:?} for {all:?}");
}

/// The time step limit by Gershgorin circles equals the bound, and decreases with USL in an almost empty cell.
#[test]
fn the_sharp_step_follows_the_bound() {
    fn first<M: IntoKernels<f64, 2>>(method: M, behind: f64) -> (f64, f64) {
        let lattice = Lattice::new([0.0; 2], 1.0).unwrap();
        let mut seeds = block(&lattice, [0; 2], [4, 1], 2, 0.0);
        seeds.positions.iter_mut().for_each(|x| x[0] += 0.25 + behind);
        let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
        mpm.add("bar", rubber(), &seeds, |_| [0.0; 2]).unwrap();
        mpm.set_time_control(TimeControl::Gershgorin { factor: 0.9, growth: 1.1, every: 5 }).unwrap();
        let bound = mpm.frequency_bound().bound;
        (mpm.step().unwrap(), bound)
    }
    for behind in [0.25, 0.01] {
        let (dt, bound) = first(Method::new(Linear, Flip, Usl, PlaneStrain).compiled(), behind);
        assert!((dt * bound / (0.9 * 2f64.sqrt()) - 1.0).abs() < 1e-12, "{dt} for {bound}");
        let (dt, bound) = first(Method::new(Linear, Flip, Musl, PlaneStrain), behind);
        assert!((dt * bound / (0.9 * 2.0) - 1.0).abs() < 1e-12, "{dt} for {bound}");
    }
    let usl = || Method::new(Linear, Flip, Usl, PlaneStrain).compiled();
    let shrinks = first(usl(), 1e-4).0 / first(usl(), 1e-2).0;
    // The limit scales with the square root of the filled part of the cell.
    assert!((shrinks / 0.1 - 1.0).abs() < 0.05, "{shrinks}");
    let splines = || Method::new(QuadraticBSpline, Flip, Usl, PlaneStrain).compiled();
    let keeps = first(splines(), 1e-4).0 / first(splines(), 1e-2).0;
    assert!(keeps > 0.9, "{keeps}");
}

#[test]
fn ways_to_rest_that_cannot_be_are_refused() {
    let mut mpm = noisy(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), 2);
    let says = |error: mpm_core::SceneError, words: &str| {
        assert!(error.to_string().contains(words), "{error}");
    };
    says(mpm.set_kinetic_damping(true).unwrap_err(), "maps momentum and impulse together");
    says(mpm.set_null_space_filter(1).unwrap_err(), "whose velocities come from the nodes");
    says(Rest::new(0.0, 1e-6, 1.0).unwrap_err(), "force ratio = 0");
    says(Rest::new(1e-4, f64::NAN, 1.0).unwrap_err(), "energy ratio = NaN");
    says(Rest::new(1e-4, 1e-6, -1.0).unwrap_err(), "time to last = -1");
    says(Rest::new(1e-4, 1e-6, 1.0).unwrap().every(0).unwrap_err(), "steps between looks = 0");
    let control = TimeControl::Gershgorin { factor: 0.9, growth: 1.1, every: 0 };
    says(mpm.set_time_control(control).unwrap_err(), "every = 0");
    let mut mpm = noisy(Method::new(Linear, Flip, Musl, PlaneStrain), 2);
    says(mpm.set_null_space_filter(0).unwrap_err(), "steps = 0");
}
