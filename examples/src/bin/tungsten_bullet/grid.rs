//! By the material point method.

use examples::{CaseError, Totals};
use mpm_contact::{Coulomb, GridContact, Pairs, SurfaceDistance};
use mpm_core::geometry::Lattice;
use mpm_core::observe::{Ledger, Observer, Pace, Progress, RunSummary};
use mpm_core::{BlockGrid, Flip, Linear, Method, Mpm, Musl, PlaneStrain, Team};

use crate::scene::{BULLET, END, Entry, HISTORY, MOMENTS, Metal, Outcome, SPEED, TARGET, bodies};

/// Shoot with particles this far apart, m, two a cell and axis: hats, MUSL, FLIP; `metals` are the laws of bullet and
/// target.
pub fn shoot(metals: [Metal; 2], spacing: f64, friction: f64, threads: usize) -> Result<Outcome, CaseError> {
    let lattice = Lattice::new([0.0; 2], 2.0 * spacing)?;
    let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(friction)?));
    let method = Method::new(Linear, Flip, Musl, PlaneStrain);
    let mut mpm = Mpm::<f64, 2, _, _, _>::with_contact(method, BlockGrid::new(lattice), contact);
    let seeds = bodies(&lattice, 2, 0.0)?;
    let mut exact = 0.0;
    let (names, sizes) = (["bullet", "target"], [BULLET, TARGET]);
    for (b, (law, seeds)) in metals.into_iter().zip(&seeds).enumerate() {
        exact += mpm_materials::Constitutive::<f64>::density(&law) * sizes[b][0] * sizes[b][1];
        let velocity = if b == 0 { SPEED } else { 0.0 };
        mpm.add(names[b], law, seeds, |_| [velocity, 0.0])?;
    }
    mpm.set_team(Team::new(threads).map_err(|e| CaseError::Other(e.to_string()))?);

    let start = mpm.totals();
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut bar = Progress::new("material points".to_string());
    let mut summary = RunSummary::default();
    let (mut history, mut frames) = (Vec::new(), Vec::new());
    for entry in 0..=(END / HISTORY).round() as usize {
        let time = entry as f64 * HISTORY;
        if entry > 0 {
            let mut observers: Vec<&mut dyn Observer<f64, 2>> = vec![&mut ledger, &mut bar];
            let run = mpm.run_observed(time, &mut observers)?;
            summary.steps += run.steps;
            summary.wall_seconds += run.wall_seconds;
            summary.updates += run.updates;
        }
        let mut tip = f64::MIN;
        let bullet = mpm.bodies()[0].totals();
        mpm.bodies()[0].for_each(&mut |p| tip = tip.max(p.position[0] + 0.5 * spacing));
        let now = mpm.totals();
        let energies = [now.kinetic, now.internal, start.kinetic - now.kinetic - now.internal];
        let speed = bullet.momentum[0] / bullet.mass;
        history.push(Entry { time, tip, speed, energies: energies.map(|e| e / start.kinetic) });
        if frames.len() < MOMENTS.len() && time >= MOMENTS[frames.len()] * (1.0 - 1e-9) {
            frames.push(mpm.snapshot()?);
        }
    }
    let totals = Totals::of(&mpm, &summary, &ledger);
    Ok(Outcome { name: "mpm", history, frames, mass: start.mass / exact, added: None, totals })
}
