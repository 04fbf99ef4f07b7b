//! Hooks of this crate in scenes with known answers.

use downstream::{Deepest, Diffusion};
use impactite::prelude::*;

const PI: f64 = std::f64::consts::PI;
/// Step, s: ten times the limit of an explicit one, h^2 / (4 nu), with 16 cells and nu = 2 m^2/s, forty times with 32.
const STEP: f64 = 0.005;
/// End, s.
const END: f64 = 0.05;

/// Share of the kinetic energy of a shear flow of half a wave over 1 m that implicit Euler steps leave.
fn left() -> f64 {
    (1.0 + 2.0 * PI * PI * STEP).powf(-2.0 * END / STEP)
}

/// Soft square of side H = 1 m, of a density of 100 kg/m^3, with these velocities.
fn jelly(
    cells: usize,
    periodic: bool,
    velocity: fn([f64; 2]) -> [f64; 2],
) -> Result<Mpm<2>, Box<dyn std::error::Error>> {
    let lattice = Lattice::new([0.0; 2], 1.0 / cells as f64)?;
    let seeds = fill(&Cuboid::new([0.0; 2], [1.0, 1.0])?, &lattice, 2, &Filling::new())?;
    let jelly = LinearElastic::new(100.0, Moduli::young_poisson(1e-3, 0.0)?)?;
    let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
    if periodic {
        mpm.bound(Boundary::Periodic { axis: 0, low: 0.0, high: 1.0 })?;
    }
    mpm.add("jelly", jelly, &seeds, velocity)?;
    mpm.set_time_control(TimeControl::Fixed(STEP))?;
    Ok(mpm)
}

#[test]
fn a_shear_flow_decays_as_diffusion_says() -> Result<(), Box<dyn std::error::Error>> {
    let mut mpm = jelly(16, true, |x| [(PI * x[1]).cos(), 0.0])?;
    mpm.add_hook(Diffusion::new(200.0));
    let before = mpm.totals();
    mpm.run_until(END)?;
    let after = mpm.totals();
    let due = before.kinetic * left();
    println!("{} J of {due} J", after.kinetic);
    assert!((after.kinetic / due - 1.0).abs() < 0.03, "{} J of {due} J", after.kinetic);
    assert!((after.momentum[0] - before.momentum[0]).abs() < 1e-9 * after.mass, "{:?}", after.momentum);
    // All that is lost is work of the hook.
    let lost = before.kinetic - after.kinetic;
    assert!((lost + mpm.exchange().work).abs() < 0.03 * lost, "{lost} J, work {} J", mpm.exchange().work);
    Ok(())
}

#[test]
fn walls_and_rotation() -> Result<(), Box<dyn std::error::Error>> {
    // A square that turns has no viscous stress, wherever its surface is.
    let mut mpm = jelly(16, false, |x| [0.5 - x[1], x[0] - 0.5])?;
    mpm.add_hook(Diffusion::new(200.0));
    let before = mpm.totals();
    mpm.run_until(END)?;
    assert!(mpm.exchange().work.abs() < 1e-3 * before.kinetic, "{} J", mpm.exchange().work);
    // Between two clamps: sin(pi y / H) decays as cos does between free surfaces. Clamps of quadratic splines are soft by a part of a cell: of first order.
    let mut errors = Vec::new();
    for cells in [16, 32] {
        let mut mpm = jelly(cells, true, |x| [(PI * x[1]).sin(), 0.0])?;
        mpm.bound(Boundary::Fixed { axis: 1, at: 0.0, side: Side::Above })?;
        mpm.bound(Boundary::Fixed { axis: 1, at: 1.0, side: Side::Below })?;
        mpm.add_hook(Diffusion::new(200.0));
        let before = mpm.totals();
        mpm.run_until(END)?;
        let due = before.kinetic * left();
        errors.push((mpm.totals().kinetic / due - 1.0).abs());
    }
    println!("errors at clamps {errors:?}");
    assert!(errors[0] < 0.16 && errors[1] < 0.6 * errors[0], "{errors:?}");
    Ok(())
}

#[test]
fn the_deepest_place_of_a_bounce_is_found() -> Result<(), Box<dyn std::error::Error>> {
    let lattice = Lattice::new([0.0; 2], 0.01)?;
    let disk = fill(&Ball::new([0.0, 0.06], 0.05)?, &lattice, 2, &Filling::new())?;
    let rubber = LinearElastic::new(1000.0, Moduli::young_poisson(1e6, 0.3)?)?;
    let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
    mpm.add("disk", rubber, &disk, |_| [0.0, -2.0])?;
    mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    let hook = Deepest::new(0, 1);
    let found = hook.found.clone();
    mpm.add_hook(hook);
    mpm.run_until(0.02)?;
    let [place, time] = *found.lock().expect("the result");
    // The rim begins at 10 mm above the wall, half a particle below the lowest point.
    assert!(place > 0.0 && place < 0.006, "{place} m");
    assert!(time > 0.004 && time < 0.02, "{time} s");
    Ok(())
}
