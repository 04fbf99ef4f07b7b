//! Surface loads and prescribed velocities: the impulse they give is booked to round-off, and their work closes
//! the ledger.

use std::sync::Arc;

use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::{
    Blend, BlockGrid, Boundary, Composition, CpGimp, Flip, FullSpace, Linear, Method, Mls, Mpm, Musl,
    PlaneStrain, QuadraticBSpline, Side, TimeControl, Traction, Usf, Usl,
};
use mpm_materials::{LinearElastic, Moduli};

/// A free block pulled at its top face by a traction that is ramped up: momentum and energy against the ledger.
fn pull<M: Composition<f64, 3>>(method: M) {
    let lattice = Lattice::new([0.0; 3], 0.5).unwrap();
    let block = Cuboid::new([0.0; 3], [2.0, 2.0, 4.0]).unwrap();
    let seeds = fill(&block, &lattice, 2, &Filling::new()).unwrap();
    let law = LinearElastic::new(1.0, Moduli::young_poisson(100.0, 0.3).unwrap()).unwrap();
    let top = Cuboid::new([0.0, 0.0, 3.75], [2.0, 2.0, 4.0]).unwrap();
    let load = Traction {
        region: Arc::new(top),
        axis: 2,
        history: Arc::new(|t: f64| [0.02 * t, 0.0, 0.1 * t.min(1.0)]),
        revolved: false,
    };
    let mut mpm = Mpm::<f64, 3, _, _>::new(method, BlockGrid::new(lattice));
    mpm.add_loaded("block", law, &seeds, |_| [0.0; 3], load).unwrap();
    mpm.set_time_control(TimeControl::Fixed(0.02)).unwrap();
    mpm.run_until(2.0).unwrap();
    let (totals, ledger) = (mpm.totals(), mpm.ledger());
    for d in 0..3 {
        let error = totals.momentum[d] - ledger.load[d];
        assert!(error.abs() < 1e-12 * totals.momentum_scale, "component {d}: momentum error {error:e}");
    }
    // The impulse of 4 m^2 times the traction over time; one step off at the ends of the ramp.
    let exact = [4.0 * 0.02 * 2.0, 0.0, 4.0 * 0.1 * 1.5];
    for d in 0..3 {
        assert!((totals.momentum[d] - exact[d]).abs() < 0.02, "component {d}: {:?}", totals.momentum);
    }
    let energy = totals.kinetic + totals.internal;
    assert!((energy - ledger.work).abs() < 0.03 * ledger.work, "energy {energy}, work {}", ledger.work);
}

#[test]
fn a_pulled_block_with_musl() {
    pull(Method::new(Linear, Flip, Musl, FullSpace));
}

#[test]
fn a_pulled_block_with_usl() {
    pull(Method::new(CpGimp, Flip, Usl, FullSpace));
}

#[test]
fn a_pulled_block_with_usf() {
    pull(Method::new(QuadraticBSpline, Flip, Usf, FullSpace));
}

#[test]
fn a_pulled_block_with_momentum_and_impulse_together() {
    pull(Method::new(QuadraticBSpline, Mls, Usl, FullSpace));
}

#[test]
fn a_dragged_block_takes_the_prescribed_velocity() {
    let lattice = Lattice::new([0.0; 3], 0.5).unwrap();
    let block = Cuboid::new([0.0; 3], [2.0, 2.0, 4.0]).unwrap();
    let seeds = fill(&block, &lattice, 2, &Filling::new()).unwrap();
    let law = LinearElastic::new(1.0, Moduli::young_poisson(100.0, 0.3).unwrap()).unwrap();
    let method = Method::new(Linear, Flip, Musl, FullSpace);
    let mut mpm = Mpm::<f64, 3, _, _>::new(method, BlockGrid::new(lattice));
    mpm.add("block", law, &seeds, |_| [0.0, 0.02, 0.0]).unwrap();
    // The lower half is dragged along x; y is left free there.
    let region = Arc::new(Cuboid::new([-1.0, -1.0, -1.0], [9.0, 3.0, 2.0]).unwrap());
    let velocity = Arc::new(|_: f64| [Some(0.05), None, Some(0.0)]);
    mpm.bound(Boundary::Prescribed { region, velocity }).unwrap();
    mpm.run_until(0.5).unwrap();
    let mut dragged = 0;
    mpm.bodies()[0].for_each(&mut |p| {
        if p.position[2] < 1.5 {
            dragged += 1;
            // Places follow the nodes exactly; velocities (FLIP) keep what waves leave between the nodes.
            let moved = p.position[0] - seeds.positions[p.number][0];
            assert!((moved - 0.05 * 0.5).abs() < 1e-12, "{p:?}");
            assert!((p.velocity[0] - 0.05).abs() < 5e-3, "{p:?}");
        }
    });
    assert!(dragged > 100);
    let (totals, ledger) = (mpm.totals(), mpm.ledger());
    let given = totals.momentum[0] - ledger.impulse[0];
    assert!(given.abs() < 1e-12 * totals.momentum_scale, "momentum error {given:e}");
    assert!(ledger.work > 0.0);
}

/// Local damping: what it takes is booked, and a column under its weight comes to rest under the static stress.
#[test]
fn a_damped_column_comes_to_rest() {
    fn column<M: Composition<f64, 2>>(method: M, filters: bool) {
        let (h, cells, gravity) = (0.1, 10, 0.01);
        let lattice = Lattice::new([0.0; 2], h).unwrap();
        let length = f64::from(cells) * h;
        let seeds = fill(&Cuboid::new([0.0; 2], [h, length]).unwrap(), &lattice, 2, &Filling::new()).unwrap();
        let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.0).unwrap()).unwrap();
        let mut mpm = Mpm::<f64, 2, _, _>::new(method, BlockGrid::new(lattice));
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
        let (totals, ledger) = (mpm.totals(), mpm.ledger());
        for d in 0..2 {
            let error = totals.momentum[d] - ledger.load[d] - ledger.impulse[d];
            assert!(error.abs() < 1e-12 * gravity * 45.0, "{}: {error:e}", mpm.method().describe());
        }
        let energy = totals.kinetic + totals.internal;
        let closes = (energy - ledger.work).abs() < 0.02 * energy;
        assert!(closes || filters, "energy {energy}, work {}", ledger.work);
        // What nodes do not see of the particles' velocities, no force of theirs can damp; the blend forgets it.
        let still = if filters { 5e-3 } else { 1e-6 };
        assert!(totals.kinetic < still * largest, "{} of {largest} is left", totals.kinetic);
        mpm.bodies()[0].for_each(&mut |p| {
            let start = seeds.positions[p.number];
            // Hats hold the mean of a cell, a quarter of a cell away, and the strain is 1 %.
            let exact = -gravity * (length - start[1]);
            assert!(
                (p.stress[1] - exact).abs() < (0.25 * h + 0.02 * length) * gravity,
                "{} for {exact}",
                p.stress[1]
            );
        });
    }
    column(Method::new(Linear, Flip, Musl, PlaneStrain), false);
    // The blend takes some energy of its own. With FLIP alone particles would go on trembling, unseen by the nodes.
    let blend = Blend::new(1.0).unwrap();
    column(Method::new(QuadraticBSpline, blend, Usf, PlaneStrain), true);
    column(Method::new(Linear, Flip, Usl, PlaneStrain).total_lagrangian(), false);
}

#[test]
fn damping_that_cannot_be_is_refused() {
    let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
    let mut mpm =
        Mpm::<f64, 2, _, _>::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    for bad in [-0.1, 1.0, f64::NAN] {
        let error = mpm.set_local_damping(bad).unwrap_err().to_string();
        assert!(error.contains("[0, 1)"), "{error}");
    }
    let method = Method::new(QuadraticBSpline, Mls, Usl, PlaneStrain);
    let mut mpm = Mpm::<f64, 2, _, _>::new(method, BlockGrid::new(lattice));
    let error = mpm.set_local_damping(0.5).unwrap_err().to_string();
    assert!(error.contains("forces of the nodes"), "{error}");
}
