//! By the particle-contact meshfree method.

use examples::CaseError;
use examples::march::March;
use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
use mpm_core::{Axisymmetric, Boundary, Embedding, PlaneStrain, Side, Team, TimeControl};
use pcmm::{Bodies, Limits, LocalDelaunay, Masses, Method, Packing, Pcmm, pieces};

use crate::scene::{END, Entry, HISTORY, MOMENTS, Outcome, SPEED, Setup, Space, packed};

/// Steps between two revisions.
const EVERY: u64 = 2;
/// Every particle is moved at random by up to this part of half a spacing.
const JITTER: f64 = 0.5;
/// Smallest angle of an element, degrees.
const KEEP: f64 = 4.0;

/// Elements flatter than those that new ones may be by much go sooner than by default: they would shorten every step.
fn tessellation(spacing: f64) -> Result<LocalDelaunay, CaseError> {
    let create = Limits::new(0.8 * spacing, [10.0, 160.0], 0.5)?;
    let keep = Limits::new(2.4 * spacing, [KEEP, 180.0 - 2.0 * KEEP], 0.2)?;
    Ok(LocalDelaunay::new(0.8 * spacing, 3.0)?.with_limits(create, keep))
}

/// Shoot.
pub fn shoot(setup: &Setup) -> Result<Outcome, CaseError> {
    match setup.space {
        Space::PlaneStrain => with_embedding(setup, PlaneStrain),
        Space::Axisymmetric => with_embedding(setup, Axisymmetric),
    }
}

fn with_embedding<E: Embedding<2>>(setup: &Setup, embedding: E) -> Result<Outcome, CaseError> {
    let (space, threads) = (setup.space, setup.threads);
    let laws = Pairs::new(Coulomb::new(setup.friction)?);
    let mut scene = Bodies::<2, _>::new(SurfaceDistance::default(), laws);
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
    let particles = seeds.iter().map(|s| s.len()).sum();
    let (mut history, mut frames) = (Vec::new(), Vec::new());
    let run = March { name: "particle contacts", particles, end: END, history: HISTORY };
    let (totals, broken) = run.run(
        &mut scene,
        |scene| {
            let (now, added) = (scene.totals(), scene.audit().energy_added());
            let taken = scene.taken() - added;
            let all = (now.kinetic + now.internal + taken) / start.kinetic;
            // Around an axis, the momentum across it is not one.
            let axes = match space {
                Space::PlaneStrain => 0..2,
                Space::Axisymmetric => 1..2,
            };
            let missing = axes.map(|d| (now.momentum[d] - start.momentum[d]).powi(2)).sum::<f64>().sqrt();
            let particles = scene.particles(0);
            let reach =
                |n: &u32| particles[*n as usize].position[space.axis()] + particles[*n as usize].radius;
            // Of the largest piece that hangs together: others may fly ahead.
            let corners = scene.element_nodes(0);
            let pieces = pieces::<2>(corners, particles.len());
            let bullet = pieces.iter().take(1).flatten().flat_map(|&e| &corners[3 * e as usize..][..3]);
            let tip = bullet.map(reach).fold(f64::MIN, f64::max);
            let bullet = scene.totals_of(0).unwrap_or_default();
            let speed = bullet.momentum[space.axis()] / bullet.mass;
            let energies = [now.kinetic, now.internal, taken].map(|e| e / start.kinetic);
            history.push(Entry { time: scene.time(), tip, speed, energies });
            Ok([all - 1.0, missing / start.momentum_scale])
        },
        |scene| {
            if frames.len() < MOMENTS.len() && scene.time() >= MOMENTS[frames.len()] {
                frames.push(scene.snapshot()?);
            }
            // Pictures are of their moments.
            Ok(MOMENTS.get(frames.len()).copied().unwrap_or(END))
        },
    )?;
    broken?;
    let added = Some(scene.audit().energy_added() / start.kinetic);
    let mass = start.mass / setup.mass();
    Ok(Outcome { method: "pcmm", space, history, frames, mass, added, totals })
}
