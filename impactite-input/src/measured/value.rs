//! Values of measures at one time.

use std::cell::RefCell;

use impactite::observe::RunView;
use impactite::scene::{Account, Body, Parts, PointView, Solver, Totals};

use super::profile::Bins;
use super::{Taken, find};
use crate::model::Space;
use crate::model::measure::{AngularMomentum, Entry, Measurement, Profile};

/// Cached quantities of bodies, by name.
type Known<'a, X> = RefCell<Vec<(&'a str, X)>>;
/// Lower and upper corner, m; `None` for an empty body.
type Corners = Option<[[f64; 3]; 2]>;

/// Scene at one time, with cached quantities that several measures use.
pub(super) struct Now<'a> {
    space: Space,
    view: &'a RunView<'a>,
    bodies: Vec<&'a dyn Body>,
    totals: Known<'a, Totals>,
    bounds: Known<'a, Corners>,
}

impl<'a> Now<'a> {
    pub(super) fn new(space: Space, view: &'a RunView<'a>) -> Self {
        Now { space, view, bodies: view.bodies(), totals: RefCell::default(), bounds: RefCell::default() }
    }
    fn find(&self, name: &str) -> Result<&'a dyn Body, String> {
        find(&self.bodies, name)
    }
    /// Solver of the scene.
    fn solver(&self) -> &'a dyn Solver {
        self.view.solver()
    }
    fn totals(&self, body: &'a dyn Body) -> Totals {
        // Totals of the scene, computed once for all observers.
        if self.bodies.len() == 1 {
            return *self.view.totals();
        }
        once(&self.totals, body.name(), || body.totals())
    }
    fn bounds(&self, body: &'a dyn Body) -> Corners {
        let revolved = self.space == Space::Axisymmetric;
        once(&self.bounds, body.name(), || body.bounds(self.space.dimensions(), revolved))
    }
}

/// Return the cached quantity of a name, or compute it once.
fn once<'a, X: Copy>(known: &Known<'a, X>, name: &'a str, find: impl FnOnce() -> X) -> X {
    let before = known.borrow().iter().find(|(other, _)| *other == name).map(|(_, x)| *x);
    before.unwrap_or_else(|| {
        let found = find();
        known.borrow_mut().push((name, found));
        found
    })
}

/// Largest `sign` times a coordinate, m, without the outermost points of this share of the mass; negative infinity without a point.
fn farthest(body: &dyn Body, axis: usize, sign: f64, share: f64) -> f64 {
    if share <= 0.0 {
        let mut most = f64::NEG_INFINITY;
        body.for_each_with(Parts::NONE, &mut |p| most = most.max(sign * p.position[axis]));
        return most;
    }
    let mut points: Vec<(f64, f64)> = Vec::with_capacity(body.len());
    body.for_each_with(Parts::MASS, &mut |p| points.push((sign * p.position[axis], p.mass)));
    points.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut left = share * points.iter().map(|(_, mass)| mass).sum::<f64>();
    let place = points.iter().find(|(_, mass)| {
        left -= mass;
        left <= 0.0
    });
    place.or(points.last()).map_or(f64::NEG_INFINITY, |(x, _)| *x)
}

/// Evaluate an instantaneous measure.
pub(super) fn of(now: &Now<'_>, taken: &Taken) -> Result<f64, String> {
    use Measurement as M;
    let (space, solver) = (now.space, now.solver());
    let (find, measure) = (|name: &str| now.find(name), &taken.what);
    // Evaluate a quantity at the point of a body; NaN once the point is removed.
    let at_point = |body: &str, ask: &dyn Fn(&PointView) -> f64| {
        let mut value = f64::NAN;
        find(body)?.for_each_with(Parts::NONE, &mut |p| {
            if Some(p.number) == taken.point {
                value = ask(p);
            }
        });
        Ok::<f64, String>(value)
    };
    let revolved = space == Space::Axisymmetric;
    // True for points in the region of the measure, or without a region.
    let within = |p: &PointView| taken.region.as_ref().is_none_or(|region| region.contains(&p.position));
    Ok(match measure {
        M::Extent(m) => {
            let axis = space.axis(m.axis)?;
            let none = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
            let [low, high] = now.bounds(find(&m.body)?).unwrap_or(none).map(|corner| corner[axis]);
            // Matter of a body of revolution does not cross its axis.
            high - if revolved && axis == 0 { low.max(0.0) } else { low }
        }
        M::Highest(m) | M::Lowest(m) => {
            let axis = space.axis(m.axis)?;
            let sign = if matches!(measure, M::Highest(_)) { 1.0 } else { -1.0 };
            sign * farthest(find(&m.body)?, axis, sign, m.share.map_or(0.0, |share| share.value))
        }
        M::Centre(m) => {
            let axis = space.axis(m.axis)?;
            let (mut mass, mut sum) = (0.0, 0.0);
            find(&m.body)?.for_each_with(Parts::MASS, &mut |p| {
                mass += p.mass;
                sum += p.mass * p.position[axis];
            });
            sum / mass
        }
        M::MeanVelocity(m) => {
            let totals = moving(now, find(&m.body)?);
            totals.momentum_now()[space.axis(m.axis)?] / totals.mass
        }
        M::Momentum(m) => moving(now, find(&m.body)?).momentum_now()[space.axis(m.axis)?],
        M::Kinetic(m) => moving(now, find(&m.body)?).kinetic_now(),
        M::Internal(m) => now.totals(find(&m.body)?).internal,
        M::AngularMomentum(m) => angular_momentum(now, find(&m.body)?, m)?,
        M::Mass(m) if taken.region.is_none() => moving(now, find(&m.body)?).mass,
        M::Mass(m) => summed(find(&m.body)?, Parts::MASS, &|p| if within(p) { p.mass } else { 0.0 }),
        M::Volume(m) => summed(find(&m.body)?, Parts::SIZE, &|p| if within(p) { p.volume } else { 0.0 }),
        M::FailedShare(m) => {
            let (mut failed, mut all) = (0usize, 0usize);
            find(&m.body)?.for_each(&mut |p| {
                let counts = within(p);
                all += usize::from(counts);
                failed += usize::from(counts && p.failed);
            });
            failed as f64 / all.max(1) as f64
        }
        M::Largest(m) | M::Smallest(m) => {
            let sign = if matches!(measure, M::Largest(_)) { 1.0 } else { -1.0 };
            let mut most = f64::NAN;
            each(space, find(&m.body)?, &m.field, &mut |p, value| {
                if within(p) {
                    most = most.max(sign * value(p));
                }
            })?;
            sign * most
        }
        M::Mean(m) => {
            let (mut mass, mut sum) = (0.0, 0.0);
            each(space, find(&m.body)?, &m.field, &mut |p, value| {
                if within(p) {
                    mass += p.mass;
                    sum += p.mass * value(p);
                }
            })?;
            sum / mass
        }
        M::PositionAt(m) => {
            let axis = space.axis(m.axis)?;
            at_point(&m.body, &|p| p.position[axis])?
        }
        M::VelocityAt(m) => {
            let axis = space.axis(m.axis)?;
            at_point(&m.body, &|p| p.velocity[axis])?
        }
        M::ValueAt(m) => {
            let mut there = f64::NAN;
            each(space, find(&m.body)?, &m.field, &mut |p, value| {
                if Some(p.number) == taken.point {
                    there = value(p);
                }
            })?;
            there
        }
        M::ContactForce(m) => {
            let axis = space.axis(m.axis)?;
            let number = |name: &String| {
                let body = find(name)?;
                Ok::<_, String>(now.bodies.iter().position(|b| b.name() == body.name()).unwrap_or(usize::MAX))
            };
            let (first, second) = (number(&m.between[0])?, number(&m.between[1])?);
            let contacts = solver.contacts();
            let pair = contacts.iter().find(|pair| pair.bodies == [first.min(second), first.max(second)]);
            // The pair stores the force on the body of the larger number.
            let sign = if second > first { 1.0 } else { -1.0 };
            pair.map_or(0.0, |pair| sign * pair.force[axis])
        }
        M::ConditionForce(_) => taken.past.force(),
        M::ConditionImpulse(m) => impulse(solver, taken, space.axis(m.axis)?),
        M::ConditionWork(_) => {
            let exchange = solver.exchange();
            taken.accounts.iter().flatten().map(|&account| exchange.accounts[account].work).sum()
        }
        M::SurfaceArea(m) => {
            let body = find(&m.body)?;
            body.surface_area().ok_or_else(|| {
                let why = "has no faces: particles have a `volume` and an `extent`; bodies of `fem`, `fpm` and `pcmm` have a surface";
                format!("`{}` {why}", body.name())
            })?
        }
        M::Profile(m) => {
            let profile = taken.profile.as_ref().ok_or_else(|| format!("there is no profile `{}`", m.of))?;
            let values = profile_values(now, profile)?;
            values.get((m.bin as usize).wrapping_sub(1)).copied().unwrap_or(f64::NAN)
        }
        M::KineticShare(_) => {
            let totals = now.view.totals();
            totals.kinetic_now() / totals.internal
        }
        M::Balance(entry) => balance(&now.view.account(), *entry),
        M::EnergyError(_) => now.view.account().energy_error(),
        M::OverTime(m) => taken.past.value(m),
    })
}

/// Evaluate a profile: a value a bin; NaN for a bin without points.
pub(super) fn profile_values(now: &Now<'_>, profile: &Profile) -> Result<Vec<f64>, String> {
    let mut bins = Bins::new(profile);
    each(now.space, now.find(&profile.body)?, &profile.field, &mut |p, value| bins.add(p, value(p)))?;
    Ok(bins.values())
}

/// Return the impulse of the conditions of a measure along an axis, N s.
pub(super) fn impulse(solver: &dyn Solver, taken: &Taken, axis: usize) -> f64 {
    let exchange = solver.exchange();
    match &taken.accounts {
        None => exchange.impulse[axis],
        Some(list) => list.iter().map(|&account| exchange.accounts[account].impulse[axis]).sum(),
    }
}

/// Sum a quantity over the points of a body.
fn summed(body: &dyn Body, parts: Parts, number: &dyn Fn(&PointView) -> f64) -> f64 {
    let mut sum = 0.0;
    body.for_each_with(parts, &mut |p| sum += number(p));
    sum
}

/// Return a term of the energy balance, J.
fn balance(account: &Account, entry: Entry) -> f64 {
    match entry {
        Entry::Kinetic => account.kinetic + account.staggered,
        Entry::Internal => account.internal,
        Entry::Work => account.work,
        Entry::Friction => account.friction,
        Entry::Impacts => account.impacts,
        Entry::Damping => account.damping,
        Entry::Viscosity => account.viscosity,
        Entry::ViscousHeat => account.viscous_heat,
        Entry::Unexplained => account.unexplained,
    }
}

/// Angular momentum about a position c, L = L_0 - c x p with L_0 about the origin, kg m^2/s.
fn angular_momentum<'a>(now: &Now<'a>, body: &'a dyn Body, of: &AngularMomentum) -> Result<f64, String> {
    let (space, totals) = (now.space, moving(now, body));
    let mut centre = [0.0; 3];
    match &of.about {
        Some(about) => about.iter().zip(&mut centre).for_each(|(at, c)| *c = at.value),
        None => body.for_each_with(Parts::MASS, &mut |p| {
            (0..3).for_each(|d| centre[d] += p.mass * p.position[d] / totals.mass);
        }),
    }
    // Balanced momentum, consistent with the angular momentum about the origin.
    let axis = of.axis.map_or(Ok(2), |axis| space.axis(axis))?;
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let carried = centre[i] * totals.momentum[j] - centre[j] * totals.momentum[i];
    Ok(totals.angular_momentum[axis] - carried)
}

/// Return mass, momentum, angular momentum and kinetic energy of a body. A body of prescribed motion, which is in no balance, has them
/// summed over its points.
fn moving<'a>(now: &Now<'a>, body: &'a dyn Body) -> Totals {
    let mut totals = now.totals(body);
    if totals.mass == 0.0 {
        body.for_each_with(Parts::MASS, &mut |p| {
            let (x, v) = (p.position, p.velocity);
            totals.mass += p.mass;
            for d in 0..3 {
                let (i, j) = ((d + 1) % 3, (d + 2) % 3);
                totals.momentum[d] += p.mass * v[d];
                totals.angular_momentum[d] += p.mass * (x[i] * v[j] - x[j] * v[i]);
                totals.kinetic += 0.5 * p.mass * v[d] * v[d];
            }
        });
    }
    totals
}

/// Quantity of a point.
type OfPoint<'a> = dyn Fn(&PointView) -> f64 + 'a;

/// Component of a vector or tensor of a point.
#[derive(Clone, Copy)]
enum Component {
    Velocity(usize),
    Position(usize),
    Stress(usize),
}

/// Parse a component name such as `velocity_x` or `stress_xy`; in axisymmetric scenes with the letters r, z and t (hoop).
fn component(space: Space, field: &str) -> Option<Component> {
    let letters = if space == Space::Axisymmetric { "rzt" } else { "xyz" };
    let places = |word: &str| word.chars().map(|c| letters.find(c)).collect::<Option<Vec<usize>>>();
    let (name, word) = field.rsplit_once('_')?;
    match (name, &places(word)?[..]) {
        ("velocity", &[d]) if d < space.dimensions() => Some(Component::Velocity(d)),
        ("position", &[d]) if d < space.dimensions() => Some(Component::Position(d)),
        ("stress", &[i, j]) => Some(Component::Stress(if i == j { i } else { 6 - i - j })),
        _ => None,
    }
}

/// Fields of the points of every law.
const PLAIN: [&str; 4] = ["pressure", "von_mises", "speed", "density"];

/// Visit every point of a body with the value of a field.
fn each(
    space: Space,
    body: &dyn Body,
    field: &str,
    visit: &mut dyn FnMut(&PointView, &OfPoint<'_>),
) -> Result<(), String> {
    let names = body.state_names();
    let (place, component) = (names.iter().position(|n| n == field), component(space, field));
    if place.is_none() && component.is_none() && !PLAIN.contains(&field) {
        let kept = if names.is_empty() { "no state".into() } else { names.join(", ") };
        let components = match space {
            Space::Axisymmetric => "velocity_r, stress_rz",
            _ => "velocity_x, stress_xy",
        };
        return Err(format!(
            "the law of `{}` keeps no `{field}`; there are {}, components as {components}, {kept}",
            body.name(),
            PLAIN.join(", ")
        ));
    }
    let value = |p: &PointView| match (component, place, field) {
        (Some(Component::Velocity(d)), ..) => p.velocity[d],
        (Some(Component::Position(d)), ..) => p.position[d],
        (Some(Component::Stress(n)), ..) => p.stress[n],
        (None, Some(n), _) => p.state[n],
        (None, None, "pressure") => p.pressure(),
        (None, None, "von_mises") => p.von_mises(),
        (None, None, "density") => p.mass / p.volume,
        (None, None, _) => p.velocity.iter().map(|v| v * v).sum::<f64>().sqrt(),
    };
    // Mean values are mass-weighted.
    let moves = component.is_some_and(|c| !matches!(c, Component::Stress(_)));
    let parts = match field {
        _ if moves || place.is_none() && field == "speed" => Parts::MASS,
        "density" if place.is_none() => Parts { law: false, ..Parts::ALL },
        _ => Parts { size: false, ..Parts::ALL },
    };
    body.for_each_with(parts, &mut |p| visit(p, &value));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_have_the_letters_of_the_space() {
        let stress = |space, name: &str| match component(space, name) {
            Some(Component::Stress(n)) => n,
            _ => usize::MAX,
        };
        for (n, name) in ["xx", "yy", "zz", "yz", "xz", "xy"].iter().enumerate() {
            assert_eq!(stress(Space::Full, &format!("stress_{name}")), n);
        }
        for (n, name) in ["rr", "zz", "tt", "zt", "rt", "zr"].iter().enumerate() {
            assert_eq!(stress(Space::Axisymmetric, &format!("stress_{name}")), n);
        }
        assert!(component(Space::PlaneStrain, "velocity_z").is_none(), "no motion across the plane");
        assert!(
            component(Space::Full, "velocity_r").is_none() && component(Space::Full, "stress_x").is_none()
        );
    }
}
