//! Shot by the particle-contact meshfree method.

use std::marker::PhantomData;

use examples::{CaseError, Restart, Totals};
use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
use mpm_core::observe::{Ledger, ObserveError, Observer, Pace, Progress, RunView};
use mpm_core::{
    Archive, Axisymmetric, Boundary, CheckpointError, Embedding, PlaneStrain, Side, Solver, Team, TimeControl,
};
use pcmm::{Bodies, Consistent, Limits, LocalDelaunay, Masses, Method, Packing, Pcmm, pieces};

use crate::scene::{END, Entry, HISTORY, MOMENTS, Outcome, SPEED, Setup, Space, packed};

/// Scene of bullet and target.
type Scene = Bodies<2, SurfaceDistance>;
/// Bullet or target.
type Body<E> = Pcmm<2, Consistent<E>>;

/// Number of steps between two revisions.
const EVERY: u64 = 2;
/// Random displacement of particles, as a fraction of half a spacing.
const JITTER: f64 = 0.5;
/// Smallest angle of an element, degrees.
const KEEP: f64 = 4.0;

/// Delete elements that are much flatter than the limit for new ones earlier than by default: they would shorten every step.
fn tessellation(spacing: f64) -> Result<LocalDelaunay, CaseError> {
    let create = Limits::new(0.8 * spacing, [10.0, 160.0], 0.5)?;
    let keep = Limits::new(2.4 * spacing, [KEEP, 180.0 - 2.0 * KEEP], 0.2)?;
    Ok(LocalDelaunay::new(0.8 * spacing, 3.0)?.with_limits(create, keep))
}

/// Run the shot.
pub fn shoot(setup: &Setup, restart: &Restart) -> Result<Outcome, CaseError> {
    match setup.space {
        Space::PlaneStrain => with_embedding(setup, PlaneStrain, restart),
        Space::Axisymmetric => with_embedding(setup, Axisymmetric, restart),
    }
}

fn with_embedding<E: Embedding<2>>(
    setup: &Setup,
    embedding: E,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let (space, threads) = (setup.space, setup.threads);
    let laws = Pairs::new(Coulomb::new(setup.friction)?);
    let mut scene = Scene::new(SurfaceDistance::default(), laws);
    let seeds = packed(space, setup.spacing, JITTER)?;
    let names = ["bullet", "target"];
    for (b, (law, seeds)) in setup.metals.into_iter().zip(&seeds).enumerate() {
        let method = Method::consistent(embedding, tessellation(2.0 * seeds.half_size[0])?);
        let velocity = space.along(if b == 0 { SPEED } else { 0.0 });
        let packing = Packing::of_seeds(seeds);
        let mut body = Pcmm::new(method, law, &packing, |_| velocity, Masses::FromVolumes)?;
        if space == Space::Axisymmetric {
            body.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
        }
        body.set_revision_interval(EVERY)?;
        scene.add(names[b], body);
    }
    scene.set_team(Team::new(threads)?);
    scene.set_time_control(TimeControl::Courant { factor: 0.3, growth: 1.1 })?;

    let start = scene.totals();
    let mut tip = Tip::<E> {
        pace: Pace::interval(HISTORY)?,
        space,
        start: start.kinetic,
        history: Vec::new(),
        embedding: PhantomData,
    };
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut bar = Progress::new("particle contacts");
    let mut simulation = restart.scene(format!("pcmm_{}", space.name()))?;
    // Snapshots at the times of the pictures.
    for end in MOMENTS.into_iter().chain([END]) {
        let observers: [&mut dyn Observer; 3] = [&mut tip, &mut ledger, &mut bar];
        simulation.until(&mut scene, observers, end)?;
        if end < END {
            simulation.keep(|| scene.snapshot())?;
        }
    }
    let totals = Totals::of(&scene, &simulation.summary(), &ledger);
    let frames = simulation.into_snapshots();
    let added = Some(scene.exchange().conversion / start.kinetic);
    let mass = start.mass / setup.mass();
    Ok(Outcome { method: "pcmm", space, history: tip.history, frames, mass, added, totals })
}

/// Observer of the bullet.
struct Tip<E> {
    pace: Pace,
    space: Space,
    /// Initial kinetic energy, J.
    start: f64,
    history: Vec<Entry>,
    embedding: PhantomData<E>,
}

impl<E: Embedding<2>> Observer for Tip<E> {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let scene = now.solver_as::<Scene>()?;
        let wanted = std::any::type_name::<Body<E>>();
        let bullet = scene.part::<Body<E>>(0).ok_or(ObserveError::OtherSolver { wanted })?;
        let (axis, particles, corners) = (self.space.axis(), bullet.particles(), bullet.element_nodes());
        // Tip of the largest connected piece: others may fly ahead.
        let pieces = pieces::<2>(corners, particles.len());
        let whole = pieces.iter().take(1).flatten().flat_map(|&e| &corners[3 * e as usize..][..3]);
        let reach = |n: &u32| particles[*n as usize].position[axis] + particles[*n as usize].radius;
        let bullet_totals = bullet.totals();
        let given = now.exchange();
        let taken = given.friction + given.impacts - given.conversion;
        self.history.push(Entry {
            time: now.time(),
            tip: whole.map(reach).fold(f64::MIN, f64::max),
            speed: bullet_totals.momentum[axis] / bullet_totals.mass,
            energies: [now.totals().kinetic, now.totals().internal, taken].map(|e| e / self.start),
        });
        Ok(())
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.history, &Entry::default(), |file, entry| entry.archive(file))
    }
}
