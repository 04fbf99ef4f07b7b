//! V18: strip footing on weightless, undrained soil, with limit load q = (2 + pi) c (Prandtl 1920). Plastic flow is
//! isochoric; a method that locks does not reach the limit load.
//!
//! Half a rough footing of half width b is pushed slowly into 5 b x 4 b of elastic, perfectly plastic soil (von Mises with yield stress
//! sqrt 3 c in plane strain), E 4000 c, nu 0.45, by 0.01 b (at 0.08 b the indentation carries 5 % more), with local damping. The load is
//! that across a row of cells below. Linear shape functions extend the footing velocity by about half a cell beyond its edge: the loaded
//! width is b + h/2.
//!
//! The function is generic over the method, so that each program compiles only the compositions it runs.

use std::sync::Arc;

use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::{BlockGrid, Boundary, IntoKernels, Mpm, Side, TimeControl};
use mpm_materials::strength::LinearHardening;
use mpm_materials::{J2, LogarithmicBulk, Moduli, Solid};

use crate::work::{Stopwatch, Work};

const COHESION: f64 = 1.0;
const YOUNG: f64 = 4000.0;
const SETTLEMENT: f64 = 0.01;

/// Limit load over width and cohesion.
pub const EXACT: f64 = 2.0 + std::f64::consts::PI;
/// Courant number: time step times wave speed over cell size.
pub const COURANT: f64 = 0.3;

/// Result of a footing run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pressed {
    /// Load over width and cohesion, at equal settlement intervals up to the last.
    pub loads: Vec<f64>,
    /// Work; the caller sets the number of nodes per particle.
    pub work: Work,
    /// Failure message of a stopped run.
    pub failure: Option<String>,
}

/// Press a footing of half width `cells` cells and sample the load `looks` times.
///
/// # Errors
/// Errors of the scene.
pub fn press(method: impl IntoKernels<f64, 2>, cells: u32, looks: u32) -> Result<Pressed, String> {
    let h = 1.0 / f64::from(cells);
    let lattice = Lattice::new([0.0; 2], h).map_err(text)?;
    let soil = Cuboid::new([0.0, -4.0], [5.0, 0.0]).map_err(text)?;
    let seeds = fill(&soil, &lattice, 2, &Filling::new()).map_err(text)?;
    let moduli = Moduli::young_poisson(YOUNG, 0.45).map_err(text)?;
    let hardening = LinearHardening::new(3.0_f64.sqrt() * COHESION, 0.0).map_err(text)?;
    let strength = J2::new(moduli.shear, hardening).map_err(text)?;
    let law = Solid::new(strength, LogarithmicBulk::new(1.0, moduli.bulk).map_err(text)?);
    let speed = ((moduli.bulk + moduli.shear * 4.0 / 3.0) / 1.0).sqrt();

    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("soil", law, &seeds, |_| [0.0; 2]).map_err(text)?;
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).map_err(text)?;
    mpm.bound(Boundary::Symmetry { axis: 0, at: 5.0, side: Side::Below }).map_err(text)?;
    mpm.bound(Boundary::Symmetry { axis: 1, at: -4.0, side: Side::Above }).map_err(text)?;
    // Duration: shear waves cross the soil some ten times.
    let time = 10.0 * 5.0 / moduli.shear.sqrt();
    let push = -SETTLEMENT / time;
    let footing = Cuboid::new([-h, -0.1 * h], [1.0 + 0.1 * h, h]).map_err(text)?;
    let velocity = Arc::new(move |_: f64| [Some(0.0), Some(push), None]);
    mpm.bound(Boundary::Prescribed { region: Arc::new(footing), velocity }).map_err(text)?;
    mpm.set_time_control(TimeControl::Fixed(COURANT * h / speed)).map_err(text)?;
    mpm.set_local_damping(0.3).map_err(text)?;

    let mut pressed = Pressed::default();
    pressed.work.particles = seeds.positions.len() as u64;
    for look in 1..=looks {
        let watch = Stopwatch::start();
        let made = mpm.run_until(time * f64::from(look) / f64::from(looks));
        pressed.work.seconds += watch.seconds();
        pressed.work.steps = mpm.steps();
        pressed.work.bytes = mpm.bytes() as u64;
        if let Err(error) = made {
            pressed.failure = Some(error.to_string());
            return Ok(pressed);
        }
        let mut load = 0.0;
        mpm.bodies()[0].for_each(&mut |p| {
            let start = seeds.positions[p.number];
            if (-3.0..-3.0 + h).contains(&start[1]) {
                load -= p.stress[1] * p.volume / h;
            }
        });
        pressed.loads.push(load / (1.0 + 0.5 * h) / COHESION);
    }
    Ok(pressed)
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}
