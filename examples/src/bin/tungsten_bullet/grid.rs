//! By the material point method.

use examples::{CaseError, Totals};
use mpm_contact::{Coulomb, GridContact, Pairs, SurfaceDistance};
use mpm_core::observe::{Ledger, Observer, Pace, Progress, RunSummary};
use mpm_core::{
    Axisymmetric, BlockGrid, Boundary, CpGimp, Flip, IntoKernels, Method, Mpm, Musl, PlaneStrain, Side, Team,
};

use crate::scene::{END, Entry, HISTORY, MOMENTS, Outcome, SPEED, Setup, Space, celled};

/// Shoot with cpGIMP, MUSL and FLIP: with hats metal that flows round the axis locks until a particle breaks down.
pub fn shoot(setup: &Setup) -> Result<Outcome, CaseError> {
    match setup.space {
        Space::PlaneStrain => with_method(setup, Method::new(CpGimp, Flip, Musl, PlaneStrain)),
        Space::Axisymmetric => with_method(setup, Method::new(CpGimp, Flip, Musl, Axisymmetric)),
    }
}

fn with_method(setup: &Setup, method: impl IntoKernels<f64, 2>) -> Result<Outcome, CaseError> {
    let (space, threads) = (setup.space, setup.threads);
    let (lattice, seeds) = celled(space, setup.spacing)?;
    let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(setup.friction)?));
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    let names = ["bullet", "target"];
    for (b, (law, seeds)) in setup.metals.into_iter().zip(&seeds).enumerate() {
        let velocity = space.along(if b == 0 { SPEED } else { 0.0 });
        mpm.add(names[b], law, seeds, |_| velocity)?;
    }
    if space == Space::Axisymmetric {
        mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
    }
    mpm.set_team(Team::new(threads)?);

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
            summary += run;
        }
        let mut tip = f64::MIN;
        let bullet = mpm.bodies()[0].totals();
        mpm.bodies()[0].for_each(&mut |p| tip = tip.max(p.position[space.axis()] + 0.25 * lattice.spacing()));
        let now = mpm.totals();
        let energies = [now.kinetic, now.internal, start.kinetic - now.kinetic - now.internal];
        let speed = bullet.momentum[space.axis()] / bullet.mass;
        history.push(Entry { time, tip, speed, energies: energies.map(|e| e / start.kinetic) });
        if frames.len() < MOMENTS.len() && time >= MOMENTS[frames.len()] * (1.0 - 1e-9) {
            frames.push(mpm.snapshot()?);
        }
    }
    let totals = Totals::of(&mpm, &summary, &ledger);
    let mass = start.mass / setup.mass();
    Ok(Outcome { method: "mpm", space, history, frames, mass, added: None, totals })
}
