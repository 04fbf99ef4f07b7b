//! Estimate of size and cost of a scene after set-up: points, mass, memory, first step, number of steps, time.

use impactite::materials::material::{Material, Response, States};
use impactite::parallel::Float;
use impactite::scene::embedding::unit_of_part;
use impactite::scene::{Solver, StepLimit};

use crate::build::{liquid, material, mesh, shape, size, wrong};
use crate::document::Source;
use crate::error::InputError;
use crate::model::body::Body;
use crate::model::condition::{Condition, Wall};
use crate::model::method::{Flow, Method, Purpose, ShapeFunction, Sph, SphForm, TimeStep};
use crate::model::shape::Shape;
use crate::model::{SceneFile, Space};

/// Maximum expected number of steps: some months for the smallest scene.
const MOST_STEPS: f64 = 1e11;

/// Upper bound of wave speeds, m/s: diamond has 18 000.
const FASTEST_WAVES: f64 = 50_000.0;

/// Run time from which a scene is reported as long, s.
const DAYS: f64 = 2.0 * 86_400.0;

/// Courant number c dt / h above which a fixed step is refused: no explicit method here is stable above it.
const UNSTABLE: f64 = 2.0;

/// Content of a scene at its start, and expected cost of its run.
#[derive(Clone, Debug)]
pub struct SceneEstimate {
    /// Bodies.
    pub bodies: Vec<BodyEstimate>,
    /// Memory of bodies and scratch, bytes.
    pub bytes: usize,
    /// First time step, s.
    pub step: f64,
    /// Criterion that limits the step, in words.
    pub limit: String,
    /// Number of steps until the end, if all are as long as the first.
    pub steps: f64,
    /// Unit of masses: of the whole body, per radian, or per metre of depth.
    pub mass_unit: String,
    /// What the scene has by default for its materials, with the keys that choose otherwise.
    pub choices: Vec<String>,
    /// Warnings: allowed values that are probably unintended.
    pub notes: Vec<String>,
}

/// Body at the start.
#[derive(Clone, Debug)]
pub struct BodyEstimate {
    /// Name.
    pub name: String,
    /// Name of the constitutive law.
    pub law: &'static str,
    /// Number of points.
    pub points: usize,
    /// Mass, in the scene's unit of mass.
    pub mass: f64,
    /// Lower and upper corner of the bounding box of the points with their half widths, m.
    pub bounds: [Vec<f64>; 2],
    /// Volume ratio. Particles of a lattice (`mpm`, `sph`): volume of the points over that of as many lattice cells. Other points: volume
    /// over that of the shape, if known, which is the represented fraction of the mass.
    pub volume_factor: Option<f64>,
    /// True for particles of a lattice, whose volumes are scaled to that of the shape.
    pub lattice: bool,
    /// Cell width, m: cell of the grid, or smallest width of a point or element.
    pub width: Option<f64>,
    /// Speed of longitudinal waves at rest, m/s; `None` for a rigid body.
    pub wave_speed: Option<f64>,
    /// Largest speed of the points, m/s.
    pub fastest: f64,
}

impl Source {
    /// Estimate size and cost of a scene that was built from this text and has made no step.
    ///
    /// # Errors
    /// Step too short for a run to end; wave speeds without a finite step; unknown field.
    pub fn estimate(&self, scene: &SceneFile, solver: &mut dyn Solver) -> Result<SceneEstimate, InputError> {
        let at = |key: &str, message: String, help: &str| {
            InputError::from(Box::new(self.fault_at(key, message, Some(help.into()))))
        };
        let step = solver
            .stable_step()
            .map_err(|e| at("method", e.to_string(), "look at materials and `time_step`"))?;
        let limited = solver.limited_by();
        let flow = matches!(scene.method, Method::Flow(_));
        let (dimensions, revolved) = (solver.dimensions(), solver.axisymmetric());
        let mut bodies = Vec::new();
        for body in solver.bodies() {
            let (mut low, mut high) = (vec![f64::INFINITY; dimensions], vec![f64::NEG_INFINITY; dimensions]);
            let (mut volume, mut radii, mut fastest) = (0.0, 0.0, 0.0f64);
            let mut narrowest = f64::INFINITY;
            body.for_each(&mut |p| {
                narrowest = narrowest.min(p.drawn_width(dimensions, revolved));
                radii += if revolved { p.position[0] } else { 1.0 };
                fastest = fastest.max(p.velocity.iter().map(|v| v * v).sum::<f64>().sqrt());
                let half = if p.corners.is_empty() { 0.5 * p.drawn_width(dimensions, revolved) } else { 0.0 };
                let corners = p.corners.iter().chain(p.corners.is_empty().then_some(&p.position));
                for x in corners {
                    for d in 0..dimensions {
                        (low[d], high[d]) = (low[d].min(x[d] - half), high[d].max(x[d] + half));
                    }
                }
                volume += p.volume;
            });
            let spec = scene.expanded.get(body.name());
            let spacing = spec.and_then(|b| size::spacing(scene, b));
            // Particles of a lattice have equal volumes, scaled by one factor to that of the shape; other points have individual volumes.
            let lattice = match &scene.method {
                Method::Mpm(_) => spec.is_some_and(|b| b.elements.is_none()),
                Method::Sph(_) => true,
                Method::Flow(_) => spec.is_some_and(|b| b.mesh.is_none()),
                _ => false,
            };
            // Boxes are divided to fit.
            let scaled = lattice && !spec.and_then(|b| b.shape.as_ref()).is_some_and(is_box);
            let whole = match (scaled, spec, spacing) {
                (true, _, Some(spacing)) => Some(radii * spacing.powi(dimensions as i32)),
                (false, Some(spec), _) => self.measure(scene, spec),
                _ => None,
            };
            let width = match &scene.method {
                Method::Mpm(m) if lattice => m.cell.value,
                _ => narrowest,
            };
            bodies.push(BodyEstimate {
                name: body.name().into(),
                law: body.law(),
                points: body.len(),
                mass: body.totals().mass,
                volume_factor: whole.map(|whole| volume / whole).filter(|f| f.is_finite()),
                lattice: scaled,
                width: Some(width).filter(|w| *w > 0.0 && w.is_finite()),
                bounds: [low, high],
                wave_speed: wave_speed(scene, body.name()).filter(|_| !flow),
                fastest,
            });
        }
        let limit = match limited {
            Some(StepLimit::Body(_)) if flow => "speed, gravity or surface tension".into(),
            Some(StepLimit::Body(n)) => {
                bodies.get(n).map_or("a body".into(), |b| format!("waves in `{}`", b.name))
            }
            Some(StepLimit::Nodes) => "the highest frequency of the nodes".into(),
            Some(StepLimit::Growth) => "the growth of steps".into(),
            Some(StepLimit::Fixed) => "`time_step.fixed`".into(),
            _ => "the method".into(),
        };
        let steps = scene.end.value / step;
        if steps.is_nan() || steps > MOST_STEPS {
            let message = format!(
                "{:.3e} s are {steps:.1e} steps of {step:.1e} s, limited by {limit}; at most {MOST_STEPS:.0e} are allowed",
                scene.end.value
            );
            return Err(at(
                "end",
                message,
                "look at the units of `end`, of the cells or spacing, and of density and moduli",
            ));
        }
        let mut notes = self.notes(scene, &bodies);
        if matches!(scene.time_step, Some(TimeStep::Fixed(_))) {
            let courant = bodies
                .iter()
                .filter_map(|b| Some((step * (b.wave_speed? + b.fastest) / b.width?, b.name.as_str())));
            let largest = courant.max_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((courant, name)) = largest.filter(|c| c.0 > 1.0) {
                let message = format!(
                    "{step:.3e} s is {courant:.1} times the time in which a wave crosses a cell of `{name}`"
                );
                if courant > UNSTABLE {
                    return Err(at(
                        "time_step.fixed",
                        message,
                        "leave `time_step` out, or take a shorter step",
                    ));
                }
                notes.push(format!("time_step.fixed: {message}; it may be unstable"));
            }
        }
        Ok(SceneEstimate {
            bodies,
            bytes: solver.bytes(),
            step,
            limit,
            steps,
            mass_unit: unit_of_part("kg", dimensions, revolved),
            choices: Self::choices(scene),
            notes,
        })
    }

    /// Return the measure of a body's shape, m^3 (per radian or metre of depth), if known.
    fn measure(&self, scene: &SceneFile, body: &Body) -> Option<f64> {
        use impactite::geometry::Shape;
        let (spec, folder) = (body.shape.as_ref()?, wrong::Folder(self.folder()));
        match scene.space {
            Space::Full => shape::build::<3>("", spec, &folder).ok()?.measure(),
            Space::Axisymmetric => shape::build::<2>("", spec, &folder).ok()?.revolved_measure(),
            Space::PlaneStrain | Space::PlaneStress => shape::build::<2>("", spec, &folder).ok()?.measure(),
        }
    }

    /// Return what the scene has by default for its materials.
    fn choices(scene: &SceneFile) -> Vec<String> {
        if let Method::Sph(options) = &scene.method {
            let flows = options.form != Some(SphForm::TotalLagrangian);
            let first = scene.bodies.iter().find(|(_, body)| flows && liquid::smoothed(scene, body));
            let said = first.map(|(name, _)| {
                format!(
                    "bodies.{name}: a liquid: present configuration, scaled gradients, viscosity of pairs, diffusion of density, and walls of mirror images, along \
                     which it slips and from which it does not part"
                )
            });
            return said.into_iter().collect();
        }
        let Method::Mpm(options) = &scene.method else { return Vec::new() };
        let liquid = |body: &Body| liquid::renewed(scene, options, body).is_some();
        let first = scene.bodies.iter().find(|(_, body)| liquid(body));
        let said = first.map(|(name, _)| {
            format!(
                "bodies.{name}: a weakly compressible liquid: quadratic B-splines, APIC, mean dilatation of cells, density renewed from positions, and \
                 walls at rest on nodes as planes of symmetry, from which it does not part; `method.mpm.for` or `parts` instead choose otherwise"
            )
        });
        said.into_iter().collect()
    }

    fn notes(&self, scene: &SceneFile, bodies: &[BodyEstimate]) -> Vec<String> {
        let mut notes = Vec::new();
        for name in scene.materials.keys() {
            if !scene.bodies.values().any(|b| b.material.as_ref() == Some(name)) {
                notes.push(format!("materials.{name}: no body uses this material"));
            }
        }
        for (name, body) in &scene.bodies {
            let folder = wrong::Folder(self.folder());
            let divided = body.mesh.as_ref().and_then(|spec| match scene.space {
                Space::Full => mesh::divided::<3>(&folder, spec),
                Space::Axisymmetric | Space::PlaneStrain | Space::PlaneStress => {
                    mesh::divided::<2>(&folder, spec)
                }
            });
            if let Some((word, groups)) = divided {
                notes.push(format!(
                    "bodies.{name}.mesh.{word}: the file has the groups `{}`; the body takes all of them as one material; `groups = [...]` \
                     takes some",
                    groups.join("`, `")
                ));
            }
        }
        let weighed = scene.gravity.is_some();
        if let Method::Mpm(options) = &scene.method {
            for wall in liquid::poor_walls(scene, options) {
                notes.push(format!(
                    "{wall}: beside fixed planes, rigid bodies, and walls with friction, that move, lie between nodes, or are of a scene with other bodies, the \
                     pressure of the outermost rows of a weakly compressible liquid is wrong by up to that at the floor; `method.flow` has it right"
                ));
            }
            if let Some(why) = liquid::without_pressure(scene, options) {
                notes.push(without_pressure(why));
            }
        }
        if let Method::Flow(Flow { semi_staggered: Some(_), .. }) = &scene.method {
            notes.push(
                "method.flow.semi_staggered: for comparison; the surface is up to half a cell too high, waves lower than a cell are wrong, velocities have \
                 divergence, and the share of PIC in each step is a viscosity; leave it out for the staggered scheme"
                    .into(),
            );
        }
        if let Method::Sph(options) = &scene.method {
            notes_of_liquids(scene, options, &mut notes);
        }
        if let (Method::Mpm(options), true) = (&scene.method, weighed) {
            let splines = match &options.parts {
                Some(parts) => parts.shape_function == ShapeFunction::QuadraticBSpline,
                None => options.purpose != Some(Purpose::LargeElastic),
            };
            let fluid = |body: &&Body| {
                let material = body.material.as_ref().and_then(|name| scene.materials.get(name));
                material.is_some_and(|m| m.fluid.is_some())
            };
            let liquid = |body: &Body| liquid::renewed(scene, options, body).is_some();
            if splines && scene.bodies.values().any(|b| fluid(&b) && !liquid(b)) {
                notes.push(
                    "method.mpm: quadratic B-splines stir a fluid at rest; a liquid with a free surface is at rest with `method.flow`, or with `parts = { shape_function = \"cpgimp\", transfer = \"flip\", \
                     stress_update = \"musl\" }` instead of `for` keeps it at rest"
                        .into(),
                );
            }
        }
        for body in bodies {
            if let Some(speed) = body.wave_speed.filter(|c| *c > FASTEST_WAVES || body.fastest > 30.0 * c) {
                notes.push(format!(
                    "bodies.{}: the speed of sound of its material is {speed:.3} m/s at a speed of the body of {:.3} m/s; is a unit missing?",
                    body.name, body.fastest
                ));
            }
            let Some(factor) = body.volume_factor else { continue };
            if body.lattice && (factor - 1.0).abs() > 0.1 {
                notes.push(format!(
                    "bodies.{}: volumes of its points are scaled by {factor:.3} to fill its shape; smaller cells or spacing fit it better",
                    body.name
                ));
            }
            if !body.lattice && (factor - 1.0).abs() > 0.01 {
                notes.push(format!(
                    "bodies.{}: its points have {:.1} % of the volume of its shape, and of its mass; a smaller spacing fits it better",
                    body.name,
                    100.0 * factor
                ));
            }
        }
        notes
    }
}

/// Add the notes on liquids of smoothed particles.
fn notes_of_liquids(scene: &SceneFile, options: &Sph, notes: &mut Vec<String>) {
    let Some((name, _)) = scene.bodies.iter().find(|(_, body)| liquid::smoothed(scene, body)) else { return };
    if options.form == Some(SphForm::TotalLagrangian) {
        notes.push(
            "method.sph.form: with `total_lagrangian` neighbours never change, which is right for sound in a liquid and wrong for its flow; leave it out"
                .into(),
        );
    } else {
        for (n, condition) in scene.conditions.iter().enumerate() {
            if let Condition::Wall(Wall { friction: Some(friction), .. }) = condition
                && friction.value > 0.0
            {
                notes.push(format!(
                    "conditions[{n}].wall.friction: does not act on the liquid `{name}`, which slips along walls; it sticks to a `fixed` plane"
                ));
            }
        }
    }
    if let Some(why) = liquid::smoothed_without_pressure(scene) {
        notes.push(without_pressure(why));
    }
}

/// Note on liquids that start without pressure.
fn without_pressure(why: &str) -> String {
    format!(
        "gravity: the pressure at the start is not computed for liquids {why}; they start without it and ring with the period 4 H / c; \
         `initial_stress` gives one"
    )
}

impl BodyEstimate {
    /// True if the other body is a repetition of the same body.
    fn is_repeated_as(&self, other: &BodyEstimate) -> bool {
        let stem = |name: &str| name.trim_end_matches(|c: char| c.is_ascii_digit()).to_string();
        stem(&self.name).ends_with(' ') && stem(&self.name) == stem(&other.name) && self.law == other.law
    }
}

/// Format the corners of a box; coordinates of rounding size are zero.
fn box_of([low, high]: &[Vec<f64>; 2]) -> String {
    let largest = low.iter().zip(high).map(|(l, h)| h - l).fold(0.0, f64::max);
    let list = |x: &[f64]| {
        let shown = x.iter().map(|&x| if x.abs() < 1e-3 * largest { "0".into() } else { format!("{x:.4}") });
        let small = |&x: &f64| if x.abs() < 1e-3 * largest { "0".into() } else { format!("{x:.3e}") };
        let texts: Vec<String> = if largest < 0.1 { x.iter().map(small).collect() } else { shown.collect() };
        texts.join(", ")
    };
    format!("from [{}] to [{}]", list(low), list(high))
}

impl SceneEstimate {
    /// Return the memory of bodies and scratch with its unit.
    #[must_use]
    pub fn memory(&self) -> String {
        size::size(self.bytes as f64)
    }

    /// Return the number of steps, and their time on this machine: `about 2488; about 16.7 s here`. `seconds` is the measured time per
    /// step.
    #[must_use]
    pub fn cost(&self, seconds: Option<f64>) -> String {
        let time = seconds.map_or(String::new(), |s| format!("; about {} here", duration(s * self.steps)));
        format!("about {:.0}{time}", self.steps.ceil())
    }

    /// Return lines for people; `seconds` is the measured time per step on this machine.
    #[must_use]
    pub fn lines(&self, seconds: Option<f64>) -> Vec<String> {
        let unit = &self.mass_unit;
        let mut lines = Vec::new();
        let mut rest = &self.bodies[..];
        while let Some(first) = rest.first() {
            // Repeated bodies, `ball 1` and so on, share a line.
            let alike = rest.iter().take_while(|b| first.is_repeated_as(b)).count();
            let (all, after) = rest.split_at(alike.max(1));
            rest = after;
            let sum = |of: fn(&BodyEstimate) -> f64| all.iter().map(of).sum::<f64>();
            let bounds = all.iter().fold(first.bounds.clone(), |[low, high], b| {
                let with = |x: Vec<f64>, y: &[f64], pick: fn(f64, f64) -> f64| {
                    x.iter().zip(y).map(|(x, y)| pick(*x, *y)).collect()
                };
                [with(low, &b.bounds[0], f64::min), with(high, &b.bounds[1], f64::max)]
            });
            let name = match all {
                [one] => one.name.clone(),
                _ => format!("{} to {} ({} bodies)", first.name, all[all.len() - 1].name, all.len()),
            };
            let waves = first.wave_speed.map_or(String::new(), |c| format!(", speed of sound {c:.0} m/s"));
            let factor = first.volume_factor.map_or(String::new(), |f| format!(", volume factor {f:.4}"));
            let law = if first.law.is_empty() { "rigid" } else { first.law };
            let points: usize = all.iter().map(|b| b.points).sum();
            lines.push(format!(
                "{name}: {points} points, {:.4e} {unit}, {law}{waves}; {} m{factor}",
                sum(|b| b.mass),
                box_of(&bounds)
            ));
        }
        lines.push(format!("memory: {}", self.memory()));
        lines.push(format!("first step: {:.3e} s, limited by {}", self.step, self.limit));
        lines.push(format!("steps: {}", self.cost(seconds)));
        if let Some(all) = seconds.map(|s| s * self.steps).filter(|all| *all > DAYS) {
            lines.push(format!(
                "note: {} are long; larger cells or spacings shorten the run by their third to fourth power. Or is a unit wrong, of `end`, of lengths, of densities or moduli?",
                duration(all)
            ));
        }
        lines.extend(self.choices.iter().chain(&self.notes).map(|note| format!("note: {note}")));
        lines
    }
}

/// Return the speed of longitudinal waves in the material of a body at rest, m/s.
fn wave_speed(scene: &SceneFile, body: &str) -> Option<f64> {
    let name = scene.expanded.get(body)?.material.as_ref()?;
    let plates = scene.space == Space::PlaneStress;
    let law = material::build(name, scene.materials.get(name)?, plates).ok()?.material;
    let material: &dyn Material<f64> = &*law;
    let row = |x: f64| {
        let mut row = <f64 as Float>::Row::default();
        row.as_mut().fill(x);
        row
    };
    let rows: Vec<_> = material.virgin().into_iter().map(row).collect();
    let mut response = Response::default();
    let states = States { all: &rows, stride: material.numbers(), first: 0, groups: &[0] };
    material.describe(states, f64::INFINITY, &mut response);
    Some(response.outputs().first()?.step_speed.0[0].as_ref()[0])
}

/// Format a duration with a suitable unit.
fn duration(seconds: f64) -> String {
    let (unit, factor) = match seconds {
        s if s < 90.0 => ("s", 1.0),
        s if s < 5400.0 => ("min", 60.0),
        s if s < 172_800.0 => ("h", 3600.0),
        _ => ("days", 86400.0),
    };
    format!("{:.1} {unit}", seconds / factor)
}

/// True for a box, moved or not.
fn is_box(shape: &Shape) -> bool {
    match shape {
        Shape::Box(_) => true,
        Shape::Moved(moved) => is_box(&moved.shape),
        _ => false,
    }
}
