//! Shot by the material point method.

use examples::{CaseError, Restart, Totals};
use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
use mpm_core::GridContact;
use mpm_core::observe::{Ledger, Observer, Pace, Progress};
use mpm_core::{
    Axisymmetric, BlockGrid, Boundary, CpGimp, Flip, IntoKernels, Method, Mpm, Musl, PlaneStrain, Side,
    Solver, Team,
};

use crate::scene::{END, Entry, HISTORY, MOMENTS, Outcome, SPEED, Setup, Space, celled};

/// Run with cpGIMP, MUSL and FLIP: with linear shape functions, metal that flows around the axis locks until a particle fails.
pub fn shoot(setup: &Setup, restart: &Restart) -> Result<Outcome, CaseError> {
    match setup.space {
        Space::PlaneStrain => with_method(setup, Method::new(CpGimp, Flip, Musl, PlaneStrain), restart),
        Space::Axisymmetric => with_method(setup, Method::new(CpGimp, Flip, Musl, Axisymmetric), restart),
    }
}

fn with_method(
    setup: &Setup,
    method: impl IntoKernels<f64, 2>,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
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
    let mut simulation = restart.scene(format!("mpm_{}", space.name()))?;
    let mut history = Vec::new();
    for entry in 0..=(END / HISTORY).round() as usize {
        let time = entry as f64 * HISTORY;
        if entry > 0 {
            let observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut bar];
            simulation.until(&mut mpm, observers, time)?;
        }
        let [tip, speed, kinetic, internal] = simulation.note(|| {
            let mut tip = f64::MIN;
            let bullet = mpm.bodies()[0].totals();
            let surface = 0.25 * lattice.spacing();
            mpm.bodies()[0].for_each(&mut |p| tip = tip.max(p.position[space.axis()] + surface));
            let now = mpm.totals();
            Ok([tip, bullet.momentum[space.axis()] / bullet.mass, now.kinetic, now.internal])
        })?;
        let energies = [kinetic, internal, start.kinetic - kinetic - internal];
        history.push(Entry { time, tip, speed, energies: energies.map(|e| e / start.kinetic) });
        if MOMENTS.get(simulation.snapshots().len()).is_some_and(|moment| time >= moment * (1.0 - 1e-9)) {
            simulation.keep(|| mpm.snapshot())?;
        }
    }
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    let frames = simulation.into_snapshots();
    let mass = start.mass / setup.mass();
    Ok(Outcome { method: "mpm", space, history, frames, mass, added: None, totals })
}
