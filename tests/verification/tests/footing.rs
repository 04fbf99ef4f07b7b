//! V18: a strip footing on weightless soil without drainage, whose limit load is known: q = (2 + pi) c (Prandtl 1920).
//! Plastic flow keeps the volume, and what locks never gets to a limit load.
//!
//! Half a footing of half width b, rough, is pushed slowly into 5 b x 4 b of elastic, ideally plastic soil (von Mises,
//! whose yield stress in plane strain is sqrt 3 c), E 4000 c, nu 0.45, by 0.01 b (at 0.08 b the hole it makes carries 5 %
//! more); local damping. The load is that across a row
//! of cells below. Hats hold the velocity of the footing up to half a cell beside its edge, more or less: the width that
//! carries is b + h/2.

use std::sync::Arc;

use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::{
    BlockGrid, Boundary, Composition, Flip, Linear, Method, Mpm, Musl, PlaneStrain, Side, TimeControl,
};
use mpm_materials::strength::LinearHardening;
use mpm_materials::{J2, LogarithmicBulk, Moduli, Solid};

const COHESION: f64 = 1.0;
const YOUNG: f64 = 4000.0;
const SETTLEMENT: f64 = 0.01;

/// Load over width and cohesion, at each of `looks` settlements up to the last, of a footing `cells` half wide.
fn press<M: Composition<f64, 2>>(method: M, cells: u32, looks: u32) -> Vec<f64> {
    let h = 1.0 / f64::from(cells);
    let lattice = Lattice::new([0.0; 2], h).expect("lattice");
    let soil = Cuboid::new([0.0, -4.0], [5.0, 0.0]).expect("soil");
    let seeds = fill(&soil, &lattice, 2, &Filling::new()).expect("seeds");
    let moduli = Moduli::young_poisson(YOUNG, 0.45).expect("moduli");
    let hardening = LinearHardening::new(3.0_f64.sqrt() * COHESION, 0.0).expect("hardening");
    let strength = J2::new(moduli.shear, hardening).expect("strength");
    let law = Solid::new(strength, LogarithmicBulk::new(1.0, moduli.bulk).expect("bulk"));
    let speed = ((moduli.bulk + moduli.shear * 4.0 / 3.0) / 1.0).sqrt();

    let mut mpm = Mpm::<f64, 2, _, _>::new(method, BlockGrid::new(lattice));
    mpm.add("soil", law, &seeds, |_| [0.0; 2]).expect("body");
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).expect("middle");
    mpm.bound(Boundary::Symmetry { axis: 0, at: 5.0, side: Side::Below }).expect("side");
    mpm.bound(Boundary::Symmetry { axis: 1, at: -4.0, side: Side::Above }).expect("bottom");
    // Shear waves cross the soil some ten times.
    let time = 10.0 * 5.0 / moduli.shear.sqrt();
    let push = -SETTLEMENT / time;
    let footing = Cuboid::new([-h, -0.1 * h], [1.0 + 0.1 * h, h]).expect("footing");
    let velocity = Arc::new(move |_: f64| [Some(0.0), Some(push), None]);
    mpm.bound(Boundary::Prescribed { region: Arc::new(footing), velocity }).expect("footing");
    mpm.set_time_control(TimeControl::Fixed(0.3 * h / speed)).expect("time control");
    mpm.set_local_damping(0.3).expect("damping");

    let mut loads = Vec::new();
    for look in 1..=looks {
        mpm.run_until(time * f64::from(look) / f64::from(looks)).expect("run");
        let mut load = 0.0;
        mpm.bodies()[0].for_each(&mut |p| {
            let start = seeds.positions[p.number];
            if (-3.0..-3.0 + h).contains(&start[1]) {
                load -= p.stress[1] * p.volume / h;
            }
        });
        loads.push(load / (1.0 + 0.5 * h) / COHESION);
    }
    loads
}

#[test]
fn v18_strip_footing() {
    let exact = 2.0 + std::f64::consts::PI;
    let hats = || Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian();
    let own = press(hats(), 4, 4);
    println!("own dilatation, 4 cells: {own:.3?}");
    for cells in [4, 8] {
        let mean = press(hats().mean_dilatation(), cells, 4);
        println!("mean dilatation, {cells} cells: {mean:.3?}, {:.3} of (2 + pi) c", mean[3] / exact);
        assert!((mean[3] / exact - 1.0).abs() < 0.03, "{cells} cells: {mean:?}");
        // A plateau: the last quarter of the way changes nothing much.
        assert!((mean[3] / mean[2] - 1.0).abs() < 0.02, "{cells} cells: {mean:?}");
    }
    assert!(own[3] > 1.1 * exact, "no locking to cure: {own:?}");
}
