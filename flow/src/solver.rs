//! Scene of incompressible flow: data, set-up, and the interface to the run loop.

use std::sync::Arc;

use impactite_geometry::{Filling, Seeds, Shape, fill};
use impactite_scene::boundary::BodyForce;
use impactite_scene::constants::over;
use impactite_scene::control::ControlError;
use impactite_scene::watch::{Look, Loss, Watcher, gain_at_the_fastest, not_finite};
use impactite_scene::{
    Account, Archive, Body, CheckpointError, Clock, Exchange, SceneError, Solver, StepError, StepLimit,
    Stopped, TimeControl, Totals, Warning, Watch,
};
use impactite_simd::Team;

use crate::couple::{Coupling, Surroundings};
use crate::deformable::Solids;
use crate::deformable::skin::Skin;
use crate::error::FluidError;
use crate::grid::Grid;
use crate::nodal::nodes::Nodes;
use crate::options::{FlowOptions, Fluid, ForceField, parameter};
use crate::particles::{Frame, Liquid, Particle};
use crate::rigid::Floater;
use crate::surface::Profile;
use crate::view::wide;
use crate::wall::{Wall, Walls};

/// Default share of the Courant limit.
const COURANT: f64 = 0.5;
/// Phase, rad, of a vibration of deformable bodies in a step of the default factor.
const PHASE: f64 = 0.1;
/// Largest rate for a vibration, over that of the fastest particle and of a wave of one cell. The transfer between particles and grid makes
/// errors of velocity in each step, whose pressures are the larger the shorter the step is; they drive vibrations that would shorten it again.
const MOST_OF_FLOW: f64 = 2.0;
const MOST_OF_WAVES: f64 = 40.0;
/// Stable steps of deformable bodies in the first step.
const FIRST: f64 = 4.0;
/// Default largest ratio of a step to the last one.
const GROWTH: f64 = 1.1;
/// Largest number of walls.
const MOST_WALLS: usize = 1 << 15;

/// Scene of incompressible free-surface flow in `D` = 2 or 3 dimensions.
///
/// ```
/// use flow::{Flow, FlowOptions, Fluid, Wall};
/// use impactite_geometry::{Cuboid, Lattice};
/// let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0, 0.0], 0.05)?));
/// flow.add_wall(Wall::container(Cuboid::new([0.0, 0.0], [2.0, 1.0])?))?;
/// flow.add_shape("water", Fluid::new(1000.0)?, &Cuboid::new([0.0, 0.0], [0.5, 0.5])?, 2, |_| [0.0; 2])?;
/// flow.set_body_force(|_| [0.0, -9.81]);
/// flow.run_until(0.1)?;
/// assert!(flow.points().iter().all(|p| p.position[1] > 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Flow<const D: usize> {
    pub(crate) options: FlowOptions<D>,
    pub(crate) frame: Frame<D>,
    pub(crate) fluid: Option<Fluid>,
    pub(crate) liquids: Vec<Liquid<D>>,
    pub(crate) walls: Vec<Wall<D>>,
    pub(crate) rigid: Vec<Floater<D>>,
    /// Coupling of the rigid bodies in the present step.
    pub(crate) couplings: Vec<Coupling<D>>,
    /// Cells and faces near the rigid bodies in the present step.
    pub(crate) around: Vec<Surroundings<D>>,
    /// Deformable bodies; boxed, because most scenes have none.
    pub(crate) solids: Option<Box<Solids<D>>>,
    /// Net outflow of cells by the motion of the deformable bodies, in areas of a face times m/s.
    pub(crate) swept: Vec<(u32, f64)>,
    pub(crate) body_force: Option<BodyForce<D>>,
    pub(crate) field: Option<ForceField<D>>,
    pub(crate) grid: Grid<D>,
    /// Fields at nodes of the semi-staggered scheme; none in the staggered one.
    pub(crate) nodes: Option<Box<Nodes<D>>>,
    pub(crate) team: Team,
    pub(crate) control: TimeControl,
    pub(crate) clock: Clock,
    /// Time from the velocities to the positions, s.
    pub(crate) lag: f64,
    /// Largest speed of a particle, m/s.
    pub(crate) speed: f64,
    pub(crate) exchange: Exchange,
    /// Impulse of the walls at the end of the last step, N s.
    pub(crate) booked_walls: [f64; 3],
    pub(crate) watcher: Watcher,
    /// Warnings of the flow and of the solver of its deformable bodies; empty without the latter.
    warned: Vec<Warning>,
    /// Wall times of the stages, if measured.
    pub(crate) times: Option<StepTimes>,
}

/// Wall times of the stages of steps, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTimes {
    /// Sort of the particles, blocks, cut cells.
    pub sort: f64,
    /// Transfer of the particles to faces.
    pub scatter: f64,
    /// Liquid fraction, level set, kinds of cells.
    pub surface: f64,
    /// Body force, viscosity, surface tension, and impulses of walls.
    pub forces: f64,
    /// Pressure: matrix, solve and projection.
    pub pressure: f64,
    /// Density correction.
    pub density: f64,
    /// Velocities beyond the liquid.
    pub extrapolation: f64,
    /// Transfer to the particles, and their motion.
    pub gather: f64,
}

impl<const D: usize> Flow<D> {
    const PLANE_OR_SPACE: () = assert!(D == 2 || D == 3, "flow is in the plane or in space");

    /// Create a scene without liquid and walls. It runs on the caller's thread, with half of the largest time step.
    pub fn new(options: FlowOptions<D>) -> Self {
        let () = Self::PLANE_OR_SPACE;
        Flow {
            frame: Frame::new(&options.lattice, options.period),
            options,
            fluid: None,
            liquids: Vec::new(),
            walls: Vec::new(),
            rigid: Vec::new(),
            couplings: Vec::new(),
            around: Vec::new(),
            solids: None,
            swept: Vec::new(),
            body_force: None,
            field: None,
            grid: Grid::default(),
            nodes: None,
            team: Team::one(),
            control: TimeControl::Courant { factor: COURANT, growth: GROWTH },
            clock: Clock::default(),
            lag: 0.0,
            speed: 0.0,
            exchange: Exchange::default(),
            booked_walls: [0.0; 3],
            watcher: Watcher::default(),
            warned: Vec::new(),
            times: None,
        }
    }

    /// Add a body of liquid from particles, with the velocity (m/s) at a position (m), and return its number. Four particles a cell in the
    /// plane and eight in space are usual.
    ///
    /// # Errors
    /// A name that is empty or in use; no particle; positions, volumes or velocities that are not finite, or not positive volumes; a fluid
    /// that differs from that of the other bodies, since the liquid of a scene is one.
    pub fn add_fluid(
        &mut self,
        name: impl Into<String>,
        fluid: Fluid,
        seeds: &Seeds<D>,
        velocity: impl Fn([f64; D]) -> [f64; D],
    ) -> Result<usize, SceneError> {
        let name = name.into();
        self.check_name(&name)?;
        if let Some(other) = self.fluid.filter(|other| *other != fluid) {
            return Err(SceneError::NotWith {
                what: format!("a fluid {fluid:?} beside {other:?}"),
                method: self.method(),
                why: "the liquid of a scene is one; take the same constants",
            });
        }
        parameter(!seeds.is_empty(), "particles", 0.0, "at least 1")?;
        parameter(seeds.len() < u32::MAX as usize, "particles", seeds.len() as f64, "below 2^32")?;
        let mut particles = Vec::with_capacity(seeds.len());
        for (n, (&x, &volume)) in seeds.positions.iter().zip(&seeds.volumes).enumerate() {
            let mut p =
                Particle { x, v: velocity(x), c: [[0.0; D]; D], volume, pressure: 0.0, number: n as u32 };
            for d in 0..D {
                parameter(x[d].is_finite(), "position", x[d], "finite")?;
                parameter(p.v[d].is_finite(), "velocity", p.v[d], "finite")?;
            }
            parameter(volume > 0.0 && volume.is_finite(), "volume", volume, "positive and finite")?;
            p.c = affine(&velocity, x, self.frame.h);
            self.frame.wrap(&mut p.x);
            self.speed = self.speed.max(p.v.iter().map(|v| v * v).sum::<f64>().sqrt());
            particles.push(p);
        }
        let mut liquid = Liquid::new(name, fluid.density, particles);
        liquid.force = self.force(self.clock.time);
        self.liquids.push(liquid);
        self.fluid = Some(fluid);
        self.set_profile();
        self.watcher.reopen();
        Ok(self.liquids.len() - 1)
    }

    /// Add a body of liquid that fills a shape, with `per_axis` particles along an edge of a cell, usually 2, and return its number.
    ///
    /// # Errors
    /// A shape that cannot be filled; errors of [`Flow::add_fluid`].
    pub fn add_shape(
        &mut self,
        name: impl Into<String>,
        fluid: Fluid,
        shape: &(impl Shape<D> + ?Sized),
        per_axis: usize,
        velocity: impl Fn([f64; D]) -> [f64; D],
    ) -> Result<usize, FluidError> {
        let seeds = fill(shape, &self.options.lattice, per_axis, &Filling::new())?;
        Ok(self.add_fluid(name, fluid, &seeds, velocity)?)
    }

    /// Set the profile of the surface, by the mean volume of the particles.
    fn set_profile(&mut self) {
        let count: usize = self.liquids.iter().map(|l| l.particles.len()).sum();
        let volume: f64 = self.liquids.iter().flat_map(|l| &l.particles).map(|p| p.volume).sum();
        let spacing = (volume / count as f64).powf(1.0 / D as f64) / self.frame.h;
        self.grid.profile = Profile::new(D, spacing.clamp(0.05, 1.0));
    }

    pub(crate) fn check_name(&self, name: &str) -> Result<(), SceneError> {
        let refuse = |allowed| Err(SceneError::Name { name: name.into(), allowed });
        if name.is_empty() {
            return refuse("not empty");
        }
        if self.bodies().iter().any(|body| body.name() == name) {
            return refuse("unique in the scene");
        }
        Ok(())
    }

    /// Add a wall.
    ///
    /// # Errors
    /// Too many walls; a displacement that is not finite at the present time.
    pub fn add_wall(&mut self, wall: Wall<D>) -> Result<(), SceneError> {
        parameter(self.walls.len() < MOST_WALLS, "walls", self.walls.len() as f64 + 1.0, "at most 32768")?;
        for value in wall.displacement(self.clock.time) {
            parameter(value.is_finite(), "displacement of a wall", value, "finite")?;
        }
        self.walls.push(wall);
        // Cuts by the walls that were there are of no use.
        self.grid = Grid { profile: self.grid.profile.clone(), ..Grid::default() };
        Ok(())
    }

    /// Set the body force of all liquid over time, m/s^2: gravity, less the acceleration of the frame of a moving tank.
    pub fn set_body_force(&mut self, force: impl Fn(f64) -> [f64; D] + Send + Sync + 'static) {
        self.body_force = Some(Arc::new(force));
        let now = self.force(self.clock.time);
        self.liquids.iter_mut().for_each(|l| l.force = now);
        self.rigid.iter_mut().for_each(|b| b.force = now);
    }

    pub(crate) fn force(&self, time: f64) -> [f64; D] {
        self.body_force.as_ref().map_or([0.0; D], |force| force(time))
    }

    /// Mean of the body forces at both ends of a step, N/kg.
    pub(crate) fn mean_force(&self, dt: f64) -> [f64; D] {
        let (start, end) = (self.force(self.clock.time), self.force(self.clock.time + dt));
        std::array::from_fn(|d| 0.5 * (start[d] + end[d]))
    }

    /// Set the time step control: a Courant factor of 1 is a displacement of one cell in a step, or the stability limit of surface tension.
    ///
    /// # Errors
    /// An invalid time step control, or one for grids of another method.
    pub fn set_time_control(&mut self, control: TimeControl) -> Result<(), ControlError> {
        control.check_without_grid()?;
        self.control = control;
        Ok(())
    }

    /// Set the run checks: [`Watch`]. A run that a check stopped may be continued after this.
    pub fn set_watch(&mut self, watch: Watch) {
        self.watcher.set(watch);
    }

    /// Step until the time `end` (s), which is reached exactly.
    ///
    /// # Errors
    /// Errors of [`Solver::run_until`].
    pub fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        Solver::run_until(self, end)
    }

    /// All particles, body by body, sorted by number.
    pub fn points(&self) -> Vec<impactite_scene::PointView> {
        self.liquids.iter().flat_map(|l| l.points()).collect()
    }

    /// Allocated memory, bytes: of the particles, which are there twice to be sorted, and of the grid.
    pub fn memory(&self) -> [usize; 2] {
        let nodes = self.nodes.iter().map(|nodes| nodes.bytes()).sum::<usize>();
        [self.liquids.iter().map(Liquid::bytes).sum(), self.grid.bytes() + nodes]
    }

    /// Number of liquid cells in the last step.
    pub fn liquid_cells(&self) -> usize {
        self.grid.system.unknowns
    }

    /// Time from the velocities to the positions, s: velocities are those of the middle of the last step.
    pub fn velocity_lag(&self) -> f64 {
        self.lag
    }

    /// Rate of the Courant condition, 1/s: speed over cell, gravity and surface tension.
    fn rate(&self) -> f64 {
        let flow = self.rate_of_flow();
        let Some(solids) = &self.solids else { return flow };
        let gravity = self.gravity();
        let most =
            (MOST_OF_FLOW * self.speed / self.frame.h).max(MOST_OF_WAVES * (gravity / self.frame.h).sqrt());
        flow.max((COURANT / PHASE * solids.frequency()).min(most))
    }

    /// Rate without that of the vibration of deformable bodies, 1/s.
    fn rate_of_flow(&self) -> f64 {
        let h = self.frame.h;
        let gravity = self.gravity();
        let turning = self.walls.iter().map(Wall::turning_speed).fold(self.speed, f64::max);
        let mut rate = turning / h;
        // Liquid between bodies that meet is faster than they are.
        rate = self.rigid.iter().fold(rate, |rate, body| rate.max(2.0 * body.speed() / h));
        rate = self.solids.iter().fold(rate, |rate, solids| rate.max(2.0 * solids.speed() / h));
        rate = rate.max((gravity / h).sqrt());
        rate = rate.max(self.rate_of_explicit_stress());
        self.limit_of_tension().map_or(rate, |limit| rate.max(1.0 / limit))
    }

    /// Rate of the viscous stress of particles in the semi-staggered scheme, 4 D nu / h^2, 1/s: its inverse is half of the stability
    /// limit of hat functions with equal masses.
    fn rate_of_explicit_stress(&self) -> f64 {
        let viscosity = self.fluid.map_or(0.0, |fluid| fluid.viscosity / fluid.density);
        let explicit = if self.options.semi_staggered.is_some() { 4.0 * D as f64 } else { 0.0 };
        explicit * viscosity / (self.frame.h * self.frame.h)
    }

    /// Scheme, as messages name it.
    pub(crate) fn method_of_scheme(&self) -> &'static str {
        match self.options.semi_staggered {
            None => "incompressible free-surface flow: affine particle-in-cell on a staggered grid",
            Some(_) => "incompressible free-surface flow: FLIP and PIC on a semi-staggered grid",
        }
    }

    /// Longest step by surface tension, s \[Brackbill1992\]; none without it.
    fn limit_of_tension(&self) -> Option<f64> {
        let fluid = self.fluid.filter(|fluid| fluid.tension > 0.0)?;
        let square = fluid.density * self.frame.h.powi(3) / (4.0 * std::f64::consts::PI * fluid.tension);
        Some(square.sqrt())
    }

    /// Share of the density error that a step of `dt` seconds removes: in steps that are short because of the vibration of deformable bodies
    /// no more than in a step of the flow alone.
    pub(crate) fn correction(&self, dt: f64) -> f64 {
        let part = if self.solids.is_some() { (dt * self.rate_of_flow() / COURANT).min(1.0) } else { 1.0 };
        self.options.correction * part
    }

    /// Speed, m/s, of which a millionth has the energy below which the liquid is at rest: its weight over the height by which the place
    /// of the surface is uncertain, and the energy of the surface of a ball of the liquid, which is in no balance.
    fn speed_of_rest(&self) -> f64 {
        let weight = if self.solids.is_some() { REST_AT_CUTS } else { REST } * self.gravity() * self.frame.h;
        let volume: f64 = self.liquids.iter().flat_map(|l| &l.particles).map(|p| p.volume).sum();
        // Surface over the volume to the power (D - 1) / D: of a disc, of a ball.
        let shape =
            if D == 2 { 2.0 * std::f64::consts::PI.sqrt() } else { (36.0 * std::f64::consts::PI).cbrt() };
        let surface = self
            .fluid
            .map_or(0.0, |fluid| fluid.tension / fluid.density * shape * volume.powf(-1.0 / D as f64));
        (1e6 * (2.0 * (weight + surface)).sqrt()).max(f64::MIN_POSITIVE)
    }

    /// Largest magnitude of the body force, N/kg.
    fn gravity(&self) -> f64 {
        self.force(self.clock.time).iter().map(|g| g * g).sum::<f64>().sqrt() + self.strength_of_field()
    }

    fn look(&mut self) -> Result<(), StepError> {
        let (totals, exchange, clock) = (self.totals(), Solver::exchange(self), self.clock);
        let loss = if self.options.semi_staggered.is_some() { LOSS_AT_NODES } else { LOSS };
        let at = Look {
            // The energy of the surface is in no balance.
            energy: self.fluid.is_none_or(|fluid| fluid.tension == 0.0),
            uncertain: totals.mass * self.gravity() * UNCERTAIN * self.frame.h,
            ..Look::new(&clock, &exchange, self.speed.max(self.speed_of_rest()), loss)
        };
        let mut watcher = std::mem::take(&mut self.watcher);
        let bodies = self.bodies();
        let gain_by = if self.options.semi_staggered.is_some() { GAIN_AT_NODES } else { GAIN };
        let gain = gain_at_the_fastest(&bodies, |_| gain_by);
        let looked = watcher.look(&totals, false, &at, || not_finite(&bodies), gain);
        self.watcher = watcher;
        looked
    }

    fn make_step(&mut self, left: f64) -> Result<f64, StepError> {
        let dt = self.clock.step_within(self.step_ahead(left), left)?;
        self.check(dt).map_err(|error| self.clock.stopped(Stopped::Scene(error)))?;
        if self.watcher.opens() {
            let (totals, exchange) = (self.totals(), Solver::exchange(self));
            self.watcher.open(self.clock.steps, &totals, &exchange, false);
        }
        self.step(dt)?;
        let looked = if self.watcher.due(self.clock.steps).is_some() { self.look() } else { Ok(()) };
        self.collect_warnings();
        looked.map(|()| dt)
    }

    /// Collect the warnings of the flow and of its deformable bodies.
    fn collect_warnings(&mut self) {
        if let Some(solids) = &self.solids {
            let theirs = solids.of.solver().warnings();
            if self.warned.len() != theirs.len() + self.watcher.warnings().len() {
                self.warned = self.watcher.warnings().iter().chain(theirs).cloned().collect();
            }
        }
    }

    /// Size of the next step, s. A scene without motion and forces has no limit.
    fn next_step(&self) -> f64 {
        let next = self.control.next(self.rate(), self.clock.last);
        match &self.solids {
            // Growth finds the step that the bodies need.
            Some(solids) if self.clock.steps == 0 => next.min(FIRST * solids.first_step),
            _ => next,
        }
    }

    /// Size of the next step, s, of `left` seconds at most, in which neither the body force nor a wall gets much faster than at its start: from
    /// rest, with a force that grows from zero, the state at the start has no limit.
    fn step_ahead(&self, left: f64) -> f64 {
        let mut dt = self.next_step().min(left);
        if let TimeControl::Courant { factor, .. } = self.control {
            while dt.is_finite() && dt * self.rate_ahead(dt) > AHEAD * factor {
                dt *= 0.5;
            }
        }
        dt
    }

    /// Largest rate of the Courant condition by the body force and the motion of walls within the next `dt` seconds, 1/s.
    fn rate_ahead(&self, dt: f64) -> f64 {
        let (start, h) = (self.clock.time, self.frame.h);
        let norm = |v: [f64; D]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut rate = 0.0f64;
        let mut before = 0.0;
        for share in SAMPLES {
            let (from, to) = (start + before * dt, start + share * dt);
            rate = rate.max(((norm(self.force(to)) + self.strength_ahead(to)) / h).sqrt());
            for wall in self.walls.iter().filter(|wall| wall.is_moving()) {
                let (a, b) = (wall.displacement(from), wall.displacement(to));
                let way = norm(std::array::from_fn(|d| b[d] - a[d]));
                rate = rate.max(way / (h * (share - before) * dt));
            }
            before = share;
        }
        rate
    }

    /// Check that forces and walls are finite in a step.
    fn check(&self, dt: f64) -> Result<(), SceneError> {
        if self.liquids.is_empty() {
            return Err(SceneError::NoBodies);
        }
        self.check_scheme()?;
        if self.clock.steps == 0 {
            self.check_force_field()?;
        }
        if self.moves_bodies() && self.fluid.is_some_and(|fluid| fluid.tension > 0.0) {
            return Err(SceneError::NotWith {
                what: "a body that the liquid moves beside surface tension".into(),
                method: self.method(),
                why: "the liquid has no angle at its surface; take a liquid without surface tension",
            });
        }
        let finite = |what: &str, values: [f64; D], time: f64| {
            let wrong = values.into_iter().find(|x| !x.is_finite());
            wrong.map_or(Ok(()), |value| Err(SceneError::NotFinite { what: what.into(), value, time }))
        };
        let stress = self.rate_of_explicit_stress();
        if matches!(self.control, TimeControl::Fixed(_)) && dt * stress > 1.0 + 1e-9 {
            let limit = 1.0 / stress;
            return Err(SceneError::NotWith {
                what: format!(
                    "a fixed time step of {dt:.3e} s beyond the limit of the viscous stress, {limit:.3e} s,"
                ),
                method: self.method(),
                why: "the stress of particles is explicit; take a shorter step, or `time_step.factor`",
            });
        }
        if let (TimeControl::Fixed(_), Some(limit)) = (self.control, self.limit_of_tension())
            && dt > limit * (1.0 + 1e-9)
        {
            return Err(SceneError::NotWith {
                what: format!(
                    "a fixed time step of {dt:.3e} s beyond the limit of surface tension, {limit:.3e} s,"
                ),
                method: self.method(),
                why: "surface waves of a cell grow; take a shorter step, or `time_step.factor`",
            });
        }
        if self.clock.steps == 0 {
            self.check_particles_and_walls()?;
        }
        let time = self.clock.time;
        finite("body force", self.force(time), time)?;
        self.walls
            .iter()
            .try_for_each(|w| finite("displacement of a wall", w.displacement(time + dt), time + dt))
    }

    /// Surfaces of deformable bodies.
    pub(crate) fn skins(&self) -> &[(Skin<D>, usize)] {
        self.solids.as_ref().map_or(&[], |solids| &solids.skins)
    }

    /// Check that no particle starts in a wall, more than half a cell from open space.
    fn check_particles_and_walls(&self) -> Result<(), SceneError> {
        let walls = Walls::at(&self.walls, (&self.rigid, self.skins()), self.clock.time, 0.0);
        if walls.list.is_empty() {
            return Ok(());
        }
        for p in self.liquids.iter().flat_map(|l| &l.particles) {
            let gap = walls.gap(p.x).0 / self.frame.h;
            let allowed = "above -0.5 cells: take the liquid out of the walls";
            parameter(gap > -0.5, "distance of a particle from the walls, in cells", gap, allowed)?;
        }
        Ok(())
    }

    fn archive_constants(&self, file: &mut Archive) -> Result<(), CheckpointError> {
        let times = [0.0, self.clock.time];
        file.same("options", &format!("{:?}", self.options))?;
        file.same("fluid", &format!("{:?}", self.fluid))?;
        let force = self.body_force.as_ref().map(|force| over(times, |t| force(t)));
        file.same("body force", &force.unwrap_or_default())?;
        file.same("number of walls", &self.walls.len().to_string())?;
        for (n, wall) in self.walls.iter().enumerate() {
            let motion = over(times, |t| wall.displacement(t));
            file.same(&format!("wall {n}"), &format!("{wall:?} {motion} m"))?;
        }
        if !self.rigid.is_empty() {
            let bodies: Vec<_> = self.rigid.iter().map(|body| format!("{:?}", body.body)).collect();
            file.same("rigid bodies", &bodies.join("; "))?;
        }
        file.same("number of bodies", &self.liquids.len().to_string())
    }
}

/// Affine matrix h dv_d/dx_e of a velocity by central differences over a thousandth of a cell; exact for affine velocities up to rounding.
fn affine<const D: usize>(velocity: &impl Fn([f64; D]) -> [f64; D], x: [f64; D], h: f64) -> [[f64; D]; D] {
    let mut c = [[0.0; D]; D];
    for e in 0..D {
        let at = |by: f64| {
            let mut place = x;
            place[e] += by * h;
            velocity(place)
        };
        let (up, low) = (at(5e-4), at(-5e-4));
        for d in 0..D {
            let slope = (up[d] - low[d]) / 1e-3;
            c[d][e] = if slope.is_finite() { slope } else { 0.0 };
        }
    }
    c
}

/// Excess of the rate within a step over that at its start, from which the step is halved.
const AHEAD: f64 = 1.5;
/// Places in a step at which forces and walls are looked at: at no common fraction, at which those that swing may vanish.
const SAMPLES: [f64; 5] = [0.17, 0.38, 0.61, 0.83, 1.0];
/// Height, in cells, by which the surface is uncertain.
const REST: f64 = 0.02;
/// Uncertain height, in cells, beside deformable bodies, whose surfaces cut cells.
const REST_AT_CUTS: f64 = 0.1;
/// Way of the centroid, in cells, between the ends of the range in which particles leave it uncertain; a gain of its energy warns and stops no
/// run. Liquid in a tank of 24 cells that is shaken for long has volumes within 1 % to both sides (`examples/long.rs`).
const UNCERTAIN: f64 = 0.2;
/// Likely sinks of energy.
const LOSS: Loss = Loss {
    by: "the transfer between particles and grid (APIC), or liquid that collided",
    remedy: "take smaller cells; a splash or impact of an incompressible liquid loses energy by its nature",
};
/// Likely sinks of energy in the semi-staggered scheme.
const LOSS_AT_NODES: Loss = Loss {
    by: "the share of PIC in each step, or liquid that collided",
    remedy: "take the staggered scheme, or a smaller share of PIC",
};
/// Likely source of energy in the semi-staggered scheme.
const GAIN_AT_NODES: &str =
    "the particles there are the fastest; take the staggered scheme, or a smaller Courant factor";
/// Likely source of energy.
const GAIN: &str = "the particles there are the fastest, or the density correction lifts coarse liquid; take smaller cells, a smaller Courant factor, or a smaller density correction";

impl<const D: usize> Solver for Flow<D> {
    fn method(&self) -> String {
        self.method_of_scheme().into()
    }
    fn dimensions(&self) -> usize {
        D
    }
    fn clock(&self) -> &Clock {
        &self.clock
    }
    fn clock_mut(&mut self) -> &mut Clock {
        &mut self.clock
    }
    fn stable_step(&mut self) -> Result<f64, StepError> {
        Ok(self.next_step())
    }
    fn limited_by(&self) -> Option<StepLimit> {
        Some(self.control.limit(self.rate(), self.clock.last, 0))
    }
    #[inline(never)]
    fn step_at_most(&mut self, left: f64) -> Result<f64, StepError> {
        self.watcher.may_go_on()?;
        let made = self.make_step(left);
        self.watcher.note(made)
    }
    fn set_team(&mut self, team: Team) {
        if let Some(solids) = &mut self.solids {
            solids.of.solver_mut().set_team(team.clone());
        }
        self.team = team;
    }
    fn bodies(&self) -> Vec<&dyn Body> {
        let liquids = self.liquids.iter().map(|l| l as &dyn Body);
        let solids = self.solids.iter().flat_map(|solids| solids.of.solver().bodies());
        liquids.chain(self.rigid.iter().map(|b| b as &dyn Body)).chain(solids).collect()
    }
    fn exchange(&self) -> Exchange {
        self.solids.iter().fold(self.exchange, |sum, solids| sum.plus(&solids.exchange()))
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.clock.archive(file)?;
        self.archive_constants(file)?;
        let has_field = self.field.is_some();
        file.same("body force by place", if has_field { "yes" } else { "no" })?;
        file.reals(self.strongest_of_field())?;
        file.reals([&mut self.lag, &mut self.speed])?;
        for liquid in &mut self.liquids {
            file.same("name of a body", &liquid.name)?;
            let count = liquid.particles.len();
            file.same(&format!("number of particles of body `{}`", liquid.name), &count.to_string())?;
            for p in &mut liquid.particles {
                file.index(&mut p.number, count)?;
                file.reals(p.x.iter_mut().chain(&mut p.v).chain(p.c.iter_mut().flatten()))?;
                file.reals([&mut p.volume, &mut p.pressure])?;
            }
            file.reals([&mut liquid.lag, &mut liquid.heat, &mut liquid.acceleration])?;
            file.reals(has_field.then_some(&mut liquid.power))?;
            file.reals(liquid.force.iter_mut().chain(&mut liquid.momentum_rate))?;
        }
        self.rigid.iter_mut().try_for_each(|body| body.archive(file))?;
        if let Some(solids) = &mut self.solids {
            solids.archive(file)?;
        }
        self.exchange.archive(file)?;
        self.booked_walls = self.exchange.impulse;
        self.watcher.archive(file)
    }
    fn stopped_by(&self) -> Option<&StepError> {
        self.watcher.stopped_by()
    }
    fn look_at_the_end(&mut self) -> Result<(), StepError> {
        if let Some(solids) = &mut self.solids {
            let looked = solids.of.solver_mut().look_at_the_end();
            self.watcher.note(looked)?;
        }
        let looked = if self.watcher.due_at_the_end(self.clock.steps) { self.look() } else { Ok(()) };
        self.collect_warnings();
        self.watcher.note(looked)
    }
    fn warnings(&self) -> &[Warning] {
        if self.warned.is_empty() { self.watcher.warnings() } else { &self.warned }
    }
    fn account_of(&self, totals: &Totals) -> Account {
        self.watcher.account(totals, &Solver::exchange(self), false)
    }
    fn bytes(&self) -> usize {
        self.memory().iter().sum::<usize>()
            + self.rigid.iter().map(Body::bytes).sum::<usize>()
            + self.solids.iter().map(|solids| solids.bytes()).sum::<usize>()
    }
}

/// Vector of the exchange.
pub(crate) fn add_to<const D: usize>(sum: &mut [f64; 3], by: &[f64; D]) {
    wide(by).iter().zip(sum).for_each(|(by, sum)| *sum += by);
}
