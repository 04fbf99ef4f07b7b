//! V6: rigid motion causes no stress.

use std::f64::consts::PI;

use mpm_core::geometry::{Ball, Filling, fill};

use crate::case::{Case, Outcome};
use crate::formulation::Formulation;
use crate::problems::{lattice, rubber};
use crate::scene::{Scene, block, worse};

/// Run V6, translation: a block of 4 cells moves obliquely at 0.3 c through `cells` cells. Measured is the largest
/// stress over E.
pub(crate) fn flight<S: Formulation>(case: &Case<S>) -> Result<Outcome, String> {
    let lattice = lattice([0.0; 2], 1.0)?;
    let dt = case.courant;
    let scene = Scene {
        lattice,
        seeds: block(&lattice, [0; 2], [4; 2], case.per_axis),
        law: rubber(1.0, 1.0, 0.3)?,
        velocity: Box::new(|_| [0.3, -0.17]),
        field: None,
        boundaries: Vec::new(),
        dt,
        steps: (case.cells as f64 / (0.3 * dt)).round() as u64,
        every: 10,
    };
    let mut largest = 0.0;
    let outcome = case.scheme.plane(&scene, &mut |moment| {
        moment.for_each(&mut |p| {
            for s in p.stress {
                largest = worse(largest, s.abs());
            }
        });
    });
    Ok(outcome.with("stress", largest))
}

/// Run V6, rotation: a disc with a radius of `cells` cells rotates once, its rim at 0.02 c. Measured are the change
/// of the angular momentum of the particles from a fiftieth of the turn on (before, that of APIC is transferred
/// from particles to their affine matrices), and the largest stress over E; the centrifugal stress is below (omega
/// R / c)^2 = 4e-4.
pub(crate) fn turn<S: Formulation>(case: &Case<S>) -> Result<Outcome, String> {
    let radius = case.cells as f64;
    let omega = 0.02 / radius;
    let lattice = lattice([0.0; 2], 1.0)?;
    let disc = Ball::new([0.0; 2], radius).map_err(|e| e.to_string())?;
    let dt = case.courant;
    let steps = (2.0 * PI / (omega * dt)).round() as u64;
    let scene = Scene {
        lattice,
        seeds: fill(&disc, &lattice, case.per_axis, &Filling::new()).map_err(|e| e.to_string())?,
        law: rubber(1.0, 1.0, 0.3)?,
        velocity: Box::new(move |x| [-omega * x[1], omega * x[0]]),
        field: None,
        boundaries: Vec::new(),
        dt,
        steps,
        every: (steps / 50).max(1),
    };
    let (mut start, mut lost, mut largest) = (None, 0.0, 0.0);
    let outcome = case.scheme.plane(&scene, &mut |moment| {
        let now = moment.totals().angular_momentum[2];
        lost = worse(lost, (now / *start.get_or_insert(now) - 1.0).abs());
        moment.for_each(&mut |p| {
            for s in p.stress {
                largest = worse(largest, s.abs());
            }
        });
    });
    Ok(outcome.with("spin", lost).with("stress", largest))
}
