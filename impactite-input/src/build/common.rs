//! Set-up common to all methods: velocities, conditions, loads, contact, time control.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use impactite::contact::{Adhesion, Coulomb, Frictionless, Pairs, Penalty, SlipWeakening, Stick};
use impactite::geometry::{Filling, Metric, Shape};
use impactite::materials::MassScaled;
use impactite::mpm::{TimeControl, Watch};
use impactite::scene::boundary::BodyForce;

use super::material::{self, Velocity};
use super::wrong::{At, Folder, Made, Wrong, known, wrong};
use super::{describe, kinds, shape};
use crate::measured::profile;
use crate::model::body::{Body, MeetBy};
use crate::model::contact::{Detector, Law, PENALTY_FREQUENCY, PENALTY_RESTITUTION, Pair};
use crate::model::method::{Method, TimeStep};
use crate::model::shape::Shape as Spec;
use crate::model::{SceneFile, Space, fixed, formulas};

/// Acceleration by place, m, and time, s, m/s^2.
pub(super) type Acting<const D: usize> = Arc<dyn Fn(&[f64; D], f64) -> [f64; D] + Send + Sync>;

/// Scene file with its folder, in `D` dimensions.
pub(crate) struct World<'a, const D: usize> {
    pub scene: &'a SceneFile,
    pub folder: &'a Folder,
    /// Shapes of bodies by key, cached so that each surface file is read once.
    shapes: RefCell<BTreeMap<String, Arc<dyn Shape<D>>>>,
}

/// Check names and incompatible keys, independently of the method.
pub(super) fn check(scene: &SceneFile) -> Made<()> {
    for (name, body) in &scene.bodies {
        let key = format!("bodies.{name}");
        kinds::check(scene, name, body)?;
        if body.material.is_none() && body.rigid.is_none() {
            return wrong(key, "needs a `material`, or is `rigid`");
        }
        if let Some(material) = &body.material {
            let names = scene.materials.keys().map(String::as_str);
            known(&format!("{key}.material"), "material", material, names)?;
        }
        if body.velocity.is_some() && (body.speed.is_some() || body.direction.is_some()) {
            return wrong(format!("{key}.velocity"), "either `velocity`, or `speed` with `direction`");
        }
        if body.speed.is_some() != body.direction.is_some() {
            return wrong(key, "`speed` and `direction` go together");
        }
    }
    let scales = scene.mass_scaling.map(|factor| factor.value);
    if let Some(factor) = scales.filter(|factor| *factor < 1.0) {
        return wrong("mass_scaling", format!("{factor} is not allowed; it must be at least 1"));
    }
    profile::check(scene)?;
    for (name, measure) in &scene.measures {
        describe::check(scene, &format!("measures.{name}"), measure)?;
    }
    describe::ends(scene)?;
    for (n, check) in scene.checks.iter().enumerate() {
        known(
            &format!("checks[{n}].measure"),
            "measure",
            &check.measure,
            scene.measures.keys().map(String::as_str),
        )?;
        if check.tolerance.value <= 0.0 {
            return wrong(
                format!("checks[{n}].tolerance"),
                format!("{} is not allowed; it must be positive", check.tolerance.value),
            );
        }
        describe::reference(scene, n)?;
    }
    Ok(())
}

impl<'a, const D: usize> World<'a, D> {
    pub fn new(scene: &'a SceneFile, folder: &'a Folder) -> Self {
        World { scene, folder, shapes: RefCell::default() }
    }
    pub fn space(&self) -> Space {
        self.scene.space
    }
    pub fn revolved(&self) -> bool {
        self.space() == Space::Axisymmetric
    }
    /// Return the metric of volumes.
    pub fn metric(&self) -> Metric {
        if self.revolved() { Metric::Axisymmetric } else { Metric::Cartesian }
    }
    pub fn filling(&self) -> Filling {
        Filling::new().metric(self.metric())
    }

    /// Return the constitutive law of a deformable body.
    pub fn law(&self, key: &str, body: &Body) -> Made<material::Law> {
        let Some(name) = &body.material else {
            return wrong(key, "needs a `material`");
        };
        let Some(spec) = self.scene.materials.get(name) else {
            return wrong(format!("{key}.material"), format!("no material has the name `{name}`"));
        };
        let law = material::build(&format!("materials.{name}"), spec, self.space() == Space::PlaneStress)?;
        let Some(factor) = self.scene.mass_scaling else { return Ok(law) };
        if law.explosive.is_some() {
            return wrong("mass_scaling", "is not with explosives, whose detonation is a matter of inertia");
        }
        let material = MassScaled::new(law.material, factor.value).at("mass_scaling")?;
        Ok(material::Law { material: Arc::new(material), explosive: None })
    }

    /// Factor on masses.
    pub fn mass_factor(&self) -> f64 {
        self.scene.mass_scaling.map_or(1.0, |factor| factor.value)
    }

    /// Return the shape of a body.
    pub fn shape(&self, key: &str, body: &Body) -> Made<Arc<dyn Shape<D>>> {
        let Some(spec) = &body.shape else { return wrong(key, "needs a `shape`") };
        if let Some(shape) = self.shapes.borrow().get(key) {
            return Ok(shape.clone());
        }
        let shape = shape::build(&format!("{key}.shape"), spec, self.folder)?;
        self.shapes.borrow_mut().insert(key.into(), shape.clone());
        Ok(shape)
    }

    /// Build the region of a key.
    pub fn region(&self, key: &str, spec: &Spec) -> Made<Arc<dyn Shape<D>>> {
        shape::build(key, spec, self.folder)
    }

    /// Body force of a body by place and time, m/s^2; none without a `body_force`.
    pub fn body_force(&self, key: &str, body: &Body) -> Made<Option<Acting<D>>> {
        let Some(list) = &body.body_force else { return Ok(None) };
        let key = format!("{key}.body_force");
        let list: [_; D] = formulas(list).at(&key)?;
        for (n, formula) in list.iter().enumerate() {
            formula.check(self.space().coordinates(), true, true).at(format!("{key}[{n}]"))?;
        }
        // Forces stay, whatever the factor on masses.
        let (revolved, factor) = (self.revolved(), self.mass_factor());
        Ok(Some(Arc::new(move |x, t| std::array::from_fn(|d| list[d].at(x, revolved, t) / factor))))
    }

    /// Return the initial velocity field of a body, whose spin is about the centre of mass: `centre`, called if the body spins.
    pub fn velocity(
        &self,
        key: &str,
        body: &Body,
        centre: impl FnOnce() -> Made<[f64; D]>,
    ) -> Made<Velocity<D>> {
        let spin = self.spin(key, body)?;
        let centre = if spin == [0.0; 3] { [0.0; D] } else { centre()? };
        let turning = move |x: &[f64; D]| {
            let arm: [f64; 3] = std::array::from_fn(|d| if d < D { x[d] - centre[d] } else { 0.0 });
            let v = [
                spin[1] * arm[2] - spin[2] * arm[1],
                spin[2] * arm[0] - spin[0] * arm[2],
                spin[0] * arm[1] - spin[1] * arm[0],
            ];
            std::array::from_fn::<f64, D, _>(|d| v[d])
        };
        let turns = spin != [0.0; 3];
        if let (Some(speed), Some(direction)) = (&body.speed, &body.direction) {
            let key = format!("{key}.direction");
            let direction: [f64; D] = fixed(direction).at(&key)?;
            let length = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
            if !(length > 0.0 && length.is_finite()) {
                return wrong(key, "needs a length");
            }
            let v = direction.map(|c| c / length * speed.value);
            return Ok(if turns { Arc::new(move |x| sum(v, turning(&x))) } else { Arc::new(move |_| v) });
        }
        let Some(list) = &body.velocity else {
            return Ok(if turns { Arc::new(move |x| turning(&x)) } else { Arc::new(|_| [0.0; D]) });
        };
        let key = format!("{key}.velocity");
        let formulas: [_; D] = formulas(list).at(&key)?;
        for (n, formula) in formulas.iter().enumerate() {
            formula.check(self.space().coordinates(), true, false).at(format!("{key}[{n}]"))?;
        }
        let revolved = self.revolved();
        let at =
            move |x: [f64; D]| -> [f64; D] { std::array::from_fn(|d| formulas[d].at(&x, revolved, 0.0)) };
        Ok(if turns { Arc::new(move |x| sum(at(x), turning(&x))) } else { Arc::new(at) })
    }

    /// Return the initial angular velocity of a body.
    pub fn spin(&self, key: &str, body: &Body) -> Made<[f64; 3]> {
        let Some(list) = &body.spin else { return Ok([0.0; 3]) };
        let key = format!("{key}.spin");
        if self.revolved() {
            return wrong(key, "around an axis nothing spins");
        }
        match (self.space().dimensions(), &list[..]) {
            (2, [about]) => Ok([0.0, 0.0, about.value]),
            (3, [x, y, z]) => Ok([x.value, y.value, z.value]),
            (2, _) => wrong(key, "in the plane it is one number, `[\"30 rad/s\"]`"),
            _ => wrong(key, "in space it is three numbers"),
        }
    }

    /// Return the acceleration of gravity.
    pub fn gravity(&self) -> Made<Option<BodyForce<D>>> {
        let Some(list) = &self.scene.gravity else { return Ok(None) };
        let list: [_; D] = formulas(list).at("gravity")?;
        for (n, formula) in list.iter().enumerate() {
            formula.check(self.space().coordinates(), false, true).at(format!("gravity[{n}]"))?;
        }
        // Weights stay, whatever the factor on masses.
        let factor = self.mass_factor();
        Ok(Some(Arc::new(move |t| std::array::from_fn(|d| list[d].at(&[0.0; D], false, t) / factor))))
    }

    /// Return the time control of the scene, or `None` for the default of the method.
    pub fn time_control(&self) -> Option<TimeControl> {
        Some(match self.scene.time_step.as_ref()? {
            TimeStep::Factor(factor) => TimeControl::Courant { factor: factor.value, growth: 1.1 },
            TimeStep::Fixed(step) => TimeControl::Fixed(step.value),
            TimeStep::Gershgorin(g) => {
                TimeControl::Gershgorin { factor: g.factor.value, growth: 1.1, every: g.every }
            }
        })
    }

    /// Refuse errors that no solver would find before its first step, and invalid constants of materials without a body.
    pub fn check(&self) -> Made<()> {
        let factor = match &self.scene.time_step {
            Some(TimeStep::Factor(factor)) => Some(("time_step.factor", factor.value)),
            Some(TimeStep::Gershgorin(g)) => Some(("time_step.gershgorin.factor", g.factor.value)),
            Some(TimeStep::Fixed(_)) | None => None,
        };
        if let Some((key, factor)) = factor
            && !(1e-6..=1.0).contains(&factor)
        {
            let message =
                format!("{factor} is not allowed; this part of the stable step must be from 1e-6 to 1");
            return wrong(key, message);
        }
        for (name, spec) in &self.scene.materials {
            let used = self.scene.bodies.values().any(|b| b.material.as_ref() == Some(name));
            if !used {
                material::build(&format!("materials.{name}"), spec, self.space() == Space::PlaneStress)?;
            }
        }
        self.check_contact()
    }

    /// Refuse contact that the method does not support, and several bodies without contact.
    fn check_contact(&self) -> Made<()> {
        let (scene, bodies) = (self.scene, &self.scene.expanded);
        let apart = bodies.values().filter(|b| b.elements.as_ref().is_none_or(|e| e.within.is_none()));
        let mpm = matches!(scene.method, Method::Mpm(_));
        // The liquid of a scene needs none, nor does what bounds it.
        let flow = matches!(scene.method, Method::Flow(_));
        let apart = apart.filter(|b| !flow || b.mesh.is_some() || kinds::is_solid(scene, b));
        if scene.contact.is_none() && apart.count() > 1 {
            let help =
                if mpm { "; without contact, in one velocity field: `contact = \"none\"`" } else { "" };
            return Err(Wrong {
                key: "contact".into(),
                message: "several bodies need a `contact`".into(),
                help: Some(format!("`contact.law.friction = 0` for contact without friction{help}")),
            });
        }
        if !mpm && scene.contact.is_some() && scene.contact().is_none() && bodies.len() > 1 {
            return wrong(
                "contact",
                "`\"none\"` is for the method `mpm` alone, where bodies then share one velocity field",
            );
        }
        let Some(contact) = scene.contact() else { return Ok(()) };
        let laws = contact
            .pairs
            .iter()
            .enumerate()
            .map(|(n, pair)| (format!("contact.pairs[{n}].law"), pair, &pair.law));
        let by_surface = |name: &str| {
            bodies
                .get(name)
                .and_then(|b| b.elements.as_ref())
                .is_some_and(|e| e.within.is_none() && e.by == MeetBy::Surface)
        };
        let remembers = |law: &Law| matches!(law, Law::SlipWeakening(_) | Law::Penalty(_));
        let without = |key: String| {
            wrong(
                key,
                "`slip_weakening` and `penalty` are for particles on the grid (`mpm`) alone; use `friction`, or `stick`",
            )
        };
        let springs = |law: &Law| matches!(law, Law::Penalty(_));
        let no_gap = matches!(contact.detector, Detector::Approach | Detector::Compression);
        if no_gap && (springs(&contact.law) || contact.pairs.iter().any(|pair| springs(&pair.law))) {
            return wrong(
                "contact.detector",
                "`penalty` needs a detector of distances: `surface_distance`, or others that measure a distance",
            );
        }
        for (key, pair, law) in laws {
            let elements = !mpm || pair.between.iter().any(|name| by_surface(name));
            if remembers(law) && elements && bodies.len() > 1 {
                return without(key);
            }
        }
        let elements = !mpm || bodies.keys().any(|name| by_surface(name));
        if remembers(&contact.law) && elements && bodies.len() > 1 {
            return without("contact.law".into());
        }
        Ok(())
    }

    /// Return the energy watch of the run.
    pub fn watch(&self) -> Watch {
        if self.scene.only_warn { Watch::default().only_warn() } else { Watch::default() }
    }

    /// Return the contact laws of pairs of bodies, which are numbered in the order of `names`.
    pub fn laws(&self, names: &[&str]) -> Made<Option<Pairs<f64>>> {
        let Some(contact) = self.scene.contact() else { return Ok(None) };
        let mut pairs =
            of_law("contact.law", &contact.law, None, Pairs::new(Frictionless), || self.spring(names))?;
        if matches!(contact.law, Law::Penalty(_)) {
            for one in 0..names.len() {
                for other in one + 1..names.len() {
                    let spring = || self.spring(&[names[one], names[other]]);
                    pairs = of_law("contact.law", &contact.law, Some([one, other]), pairs, spring)?;
                }
            }
        }
        for (n, Pair { between, law, .. }) in contact.pairs.iter().enumerate() {
            let key = format!("contact.pairs[{n}]");
            let place =
                |k: usize| known(&format!("{key}.between[{k}]"), "body", &between[k], names.iter().copied());
            let (one, other) = (place(0)?, place(1)?);
            if one == other {
                return wrong(format!("{key}.between"), "must be two bodies");
            }
            let spring = || self.spring(&[names[one], names[other]]);
            pairs = of_law(&format!("{key}.law"), law, Some([one, other]), pairs, spring)?;
        }
        Ok(Some(pairs))
    }

    /// Return the smallest wave speed of the deformable ones among these bodies, m/s, and the cell, m: the scale of springs in contact.
    fn spring(&self, names: &[&str]) -> Made<[f64; 2]> {
        let Method::Mpm(options) = &self.scene.method else {
            return wrong("contact", "`penalty` is for particles on the grid (`mpm`) alone");
        };
        let mut slowest = f64::INFINITY;
        for name in names {
            let Some(body) = self.scene.expanded.get(*name).filter(|body| body.rigid.is_none()) else {
                continue;
            };
            let material = self.law(&format!("bodies.{name}"), body)?.material;
            let speed = material.step_speed(&material.virgin(), options.cell.value).unwrap_or(f64::INFINITY);
            slowest = slowest.min(speed);
        }
        // Two rigid bodies do not deform: the speed has no effect, if it is positive.
        Ok([if slowest.is_finite() { slowest } else { 1.0 }, options.cell.value])
    }
}

/// Add this law to the pairs for two bodies, or as the law of all; `spring` returns the scale of springs: wave speed, m/s, and cell, m.
fn of_law(
    key: &str,
    law: &Law,
    pair: Option<[usize; 2]>,
    pairs: Pairs<f64>,
    spring: impl FnOnce() -> Made<[f64; 2]>,
) -> Made<Pairs<f64>> {
    macro_rules! with {
        ($law:expr) => {{
            let law = $law;
            match pair {
                Some([one, other]) => pairs.with(one, other, law),
                None => Pairs::new(law),
            }
        }};
    }
    Ok(match law {
        Law::Friction(mu) if mu.value == 0.0 => with!(Frictionless),
        Law::Friction(mu) => with!(Coulomb::new(mu.value).at(key)?),
        Law::SlipWeakening(w) => {
            with!(SlipWeakening::new(w.at_rest.value, w.sliding.value, w.distance.value).at(key)?)
        }
        Law::Penalty(p) => {
            let frequency = p.frequency.map_or(PENALTY_FREQUENCY, |q| q.value);
            let restitution = p.restitution.map_or(PENALTY_RESTITUTION, |q| q.value);
            with!(Penalty::of_cells(frequency, spring()?, restitution, p.friction.value).at(key)?)
        }
        Law::Stick(_) => with!(Stick),
        Law::Adhesion(a) => with!(Adhesion::new(a.strength.value, a.shear.value, a.friction.value).at(key)?),
    })
}

fn sum<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|d| a[d] + b[d])
}

/// Return the centre of mass of points with their positions, m, and masses, in any unit.
pub(super) fn centre_of_mass<const D: usize>(points: impl Iterator<Item = ([f64; D], f64)>) -> [f64; D] {
    let (mut sum, mut mass) = ([0.0; D], 0.0);
    for (x, m) in points {
        (0..D).for_each(|d| sum[d] += m * x[d]);
        mass += m;
    }
    sum.map(|s| s / mass)
}
