//! Conformance of contact detectors and contact laws on the grid.

use mpm_contact::conformance::{self as of_contact, Collision, DISC, FRICTION, collision, disc};
use mpm_contact::vector::{difference, length};
use mpm_contact::{ContactDetector, ContactLaw, Coulomb, Pairs};
use mpm_materials::{Moduli, NeoHookean};

use super::Broken;
use crate::contact::GridContact;
use crate::grid::BlockGrid;
use crate::method::Method;
use crate::scheme::Musl;
use crate::shape::Linear;
use crate::step::Mpm;
use crate::transfer::Flip;
use impactite_geometry::{Ball, Filling, Lattice, fill};
use impactite_scene::{PlaneStrain, TimeControl};
use impactite_simd::Team;

/// Check the properties of [`collision`] for the material point method with the detector that `make` creates.
///
/// ```
/// use mpm_contact::{Approach, Gradients};
/// mpm_core::conformance::detector(Approach::<Gradients>::default)?;
///
/// // One's own: a thousandth of a cell is near enough.
/// use mpm_contact::{EachPair, PairDetector, SurfacePair};
/// #[derive(Debug)]
/// struct Near;
/// impl PairDetector for Near {
///     fn touches(&self, pair: &SurfacePair) -> bool {
///         pair.gap() <= 1e-3 * pair.spacing
///     }
/// }
/// mpm_core::conformance::detector(|| EachPair::new(Near))?;
/// # Ok::<(), mpm_core::conformance::Broken>(())
/// ```
///
/// # Errors
/// The first violated property.
pub fn detector<S: ContactDetector<f64, 2>>(make: impl Fn() -> S) -> Result<(), Broken> {
    let friction = Coulomb::new(FRICTION).map_err(|e| broken(stop(e)))?;
    detector_and_law(make, &friction)
}

/// Check the properties of [`collision`] with a contact law of the friction coefficient [`FRICTION`].
///
/// # Errors
/// The first violated property.
pub fn detector_and_law<S: ContactDetector<f64, 2>>(
    make: impl Fn() -> S,
    law: &(impl ContactLaw<f64> + Clone),
) -> Result<(), Broken> {
    collision(|order, threads| run(make(), law.clone(), order, threads)).map_err(broken)
}

fn broken(broken: of_contact::Broken) -> Broken {
    Broken { subject: "contact on the grid".into(), property: broken.property, detail: broken.detail }
}

fn stop(why: impl std::fmt::Display) -> of_contact::Broken {
    of_contact::Broken { property: "a run", detail: why.to_string() }
}

fn run<S: ContactDetector<f64, 2>>(
    detector: S,
    law: impl ContactLaw<f64>,
    order: &[usize],
    threads: usize,
) -> Result<Collision, of_contact::Broken> {
    let lattice = Lattice::new([0.0; 2], 0.05).map_err(stop)?;
    let moduli = Moduli::young_poisson(1.0e6, 0.3).map_err(stop)?;
    let rubber = NeoHookean::new(1000.0, moduli).map_err(stop)?;
    let contact = GridContact::new(detector, Pairs::new(law));
    let method = Method::new(Linear, Flip, Musl, PlaneStrain);
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    for &n in order {
        let (centre, velocity) = disc(n, order.len());
        let ball = Ball::new(centre, DISC).map_err(stop)?;
        let seeds = fill(&ball, &lattice, 2, &Filling::new()).map_err(stop)?;
        mpm.add(&format!("disc {n}"), rubber, &seeds, |_| velocity).map_err(stop)?;
    }
    mpm.set_team(Team::new(threads).map_err(stop)?);
    mpm.set_time_control(TimeControl::Fixed(2.5e-4)).map_err(stop)?;
    let start = mpm.totals();
    let mut all = Collision::default();
    for _ in 0..80 {
        mpm.step().map_err(stop)?;
        let drift = length(difference(mpm.totals().momentum, start.momentum));
        all.drift = all.drift.max(drift / start.momentum_scale);
        all.contacts.extend(mpm.contact_points().iter().map(|n| [n.normal, n.impulse]));
    }
    for body in mpm.bodies() {
        let mut list = vec![[0.0; 3]; body.len()];
        body.for_each(&mut |p| list[p.number] = p.position);
        all.positions.push(list);
    }
    Ok(all)
}
