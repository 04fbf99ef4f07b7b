//! Conformance of material point method scenes to the `Solver` interface.

use mpm_core::geometry::{Ball, Cuboid, Filling, Lattice, fill};
use mpm_core::scene::solver_conforms;
use mpm_core::{
    Axisymmetric, BlockGrid, Boundary, FullSpace, Method, Mpm, PlaneStrain, Side, Solver, TimeControl,
};
use mpm_materials::{JohnsonCook, MieGruneisen, Moduli, NeoHookean, Solid};

/// Build an axisymmetric copper bar that hits a wall.
fn bar() -> impl Solver {
    let lattice = Lattice::new([0.0; 2], 0.8e-3).unwrap();
    let seeds =
        fill(&Cuboid::new([0.0; 2], [3.2e-3, 12.8e-3]).unwrap(), &lattice, 2, &Filling::new()).unwrap();
    let copper = Solid::new(JohnsonCook::copper_taylor(), MieGruneisen::copper());
    let mut mpm = Mpm::new(Method::impact(Axisymmetric), BlockGrid::new(lattice));
    mpm.add("bar", copper, &seeds, |_| [0.0, -190.0]).unwrap();
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
    mpm
}

fn rubber(stiffness: f64) -> NeoHookean<f64> {
    NeoHookean::new(1000.0, Moduli::young_poisson(stiffness, 0.3).unwrap()).unwrap()
}

/// Build rubber discs that collide under gravity.
fn discs() -> impl Solver {
    let lattice = Lattice::new([0.0; 2], 0.05).unwrap();
    let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
    mpm.set_body_force(|_| [0.0, -10.0]);
    for (name, x, v) in [("left", -0.25, 1.0), ("right", 0.25, -1.0)] {
        let seeds = fill(&Ball::new([x, 0.0], 0.2).unwrap(), &lattice, 2, &Filling::new()).unwrap();
        mpm.add(name, rubber(1.0e6), &seeds, |_| [v, 0.0]).unwrap();
    }
    mpm
}

/// Build a spinning rubber ball in free flight.
fn ball() -> impl Solver {
    let lattice = Lattice::new([0.0; 3], 0.1).unwrap();
    let seeds = fill(&Ball::new([0.0; 3], 0.3).unwrap(), &lattice, 2, &Filling::new()).unwrap();
    let mut mpm = Mpm::new(Method::impact(FullSpace), BlockGrid::new(lattice));
    mpm.add("ball", rubber(1.0e6), &seeds, |[x, y, _]| [-5.0 * y, 5.0 * x, 1.0]).unwrap();
    mpm
}

/// Build rubber halves that collide so fast that a particle crosses more than a cell per step.
fn crushed() -> impl Solver {
    let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
    let seeds = fill(&Cuboid::new([0.0; 2], [1.0; 2]).unwrap(), &lattice, 2, &Filling::new()).unwrap();
    let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
    mpm.add("block", rubber(1.0e6), &seeds, |[x, _]| [if x < 0.5 { 900.0 } else { -900.0 }, 0.0]).unwrap();
    mpm.set_time_control(TimeControl::Fixed(2.0e-4)).unwrap();
    mpm
}

solver_conforms! {
    copper_bar: super::bar, SolverTests::until(5.0e-6).energy_within(0.1).breaking(0.1, super::crushed);
    rubber_discs: super::discs, SolverTests::until(0.02).energy_within(0.02);
    spinning_ball: super::ball, SolverTests::until(0.05).energy_within(0.02);
}
