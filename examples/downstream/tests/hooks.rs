//! Hooks of this crate in scenes with known answers.

use downstream::{Deepest, Diffusion};
use impactite::prelude::*;

const PI: f64 = std::f64::consts::PI;

/// Shear flow cos(pi y / H) in a soft square of side H = 1 m with viscosity 2 m^2/s times its density.
fn sheared(cells: usize) -> Result<Mpm<2>, Box<dyn std::error::Error>> {
    let lattice = Lattice::new([0.0; 2], 1.0 / cells as f64)?;
    let seeds = fill(&Cuboid::new([0.0; 2], [1.0, 1.0])?, &lattice, 2, &Filling::new())?;
    let jelly = LinearElastic::new(100.0, Moduli::young_poisson(1e-3, 0.0)?)?;
    let mut mpm = Mpm::new(Method::contact_at_rest(PlaneStrain), BlockGrid::new(lattice));
    mpm.add("jelly", jelly, &seeds, |x| [(PI * x[1]).cos(), 0.0])?;
    // Twenty times the limit of an explicit step, h^2 / (4 nu), at 16 cells.
    mpm.set_time_control(TimeControl::Fixed(20.0 * (1.0_f64 / 16.0).powi(2) / 8.0 / 40.0))?;
    Ok(mpm)
}

#[test]
fn a_shear_flow_decays_as_diffusion_says() -> Result<(), Box<dyn std::error::Error>> {
    let mut mpm = sheared(16)?;
    mpm.add_hook(Diffusion::new(200.0, 100.0));
    let before = mpm.totals();
    let end = 0.05;
    mpm.run_until(end)?;
    let after = mpm.totals();
    // Kinetic energy of the mode decays with twice nu (pi / H)^2.
    let due = before.kinetic * (-2.0 * 2.0 * PI * PI * end).exp();
    assert!((after.kinetic / due - 1.0).abs() < 0.03, "{} J of {due} J", after.kinetic);
    assert!((after.momentum[0] - before.momentum[0]).abs() < 1e-9 * after.mass, "{:?}", after.momentum);
    // All that is lost is work of the hook.
    let lost = before.kinetic - after.kinetic;
    assert!((lost + mpm.exchange().work).abs() < 0.03 * lost, "{lost} J, work {} J", mpm.exchange().work);
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
