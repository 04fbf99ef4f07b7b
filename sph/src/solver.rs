//! Solver: data and set-up.

use std::sync::{Arc, Mutex};

use impactite_geometry::search::{Reach, SearchMethod, VerletLists};
use impactite_scene::boundaries::check_at;
use impactite_scene::boundary::BodyForce;
use impactite_scene::constants::over;
use impactite_scene::control::ControlError;
use impactite_scene::embedding::described;
use impactite_scene::watch::{Look, Loss, Watcher, gain_at_the_fastest, not_finite};
use impactite_scene::{
    Account, Archive, Body, Boundaries, Boundary, BoundaryEntry, CheckpointError, Clock, Condition,
    Embedding, Exchange, LocalDamping, SceneError, Side, Solver, StepError, StepLimit, Stopped, TimeControl,
    Totals, Warning, Watch,
};
use impactite_simd::Team;
use mpm_contact::particles::Advice;
use mpm_materials::material::{Deformation, Response};
use mpm_materials::point::{flatten, unflatten};
use mpm_materials::{Constitutive, IntoMaterial, Material, State};

use crate::faces::Surface;
use crate::form::{Correction as _, Form};
use crate::images::{Images, Mirror, MirrorKind};
use crate::kernel::{Kernel as _, lattice_scale};
use crate::layout::{BODY, Layout, number};
use crate::load::{SurfaceLoad, TractionHistory};
use crate::matrix::identity;
use crate::method::Composition;
use crate::records::{Has, Records};
use crate::stabilisation::Stabilisation;
use crate::sums::{BATCH, Batch, GROUP, Row};

/// Default safety factor of the time step.
const COURANT: f64 = 0.7;
/// Smallest number of particles of a body for more than one thread.
pub const SMALL: usize = 1000;
/// Default skin of the neighbour lists over the smallest spacing.
const SKIN: f64 = 0.4;

/// Bit of the first direction: moved by a boundary condition.
pub(crate) const HELD: u16 = 1;
/// Bit of the first direction: moved by contact with other bodies.
pub(crate) const TOUCHED: u16 = 8;
/// Bit of the first direction: moved by a boundary condition other than a wall.
pub(crate) const PRESCRIBED: u16 = 64;

/// Body of smoothed particles of one constitutive law in `D` dimensions, with the ingredients of `M`.
///
/// A single body is a scene; several are a scene in [`mpm_contact::particles::Bodies`]. Particles are sorted in space; they keep the
/// numbers of their layout.
#[derive(Clone)]
pub struct Sph<const D: usize, M> {
    pub(crate) method: M,
    pub(crate) material: Arc<dyn Material<f64>>,
    pub(crate) virgin: Vec<f64>,
    pub(crate) name: String,
    /// Layout number of each place.
    pub(crate) numbers: Vec<u32>,
    /// Place of each layout number.
    pub(crate) places: Vec<u32>,
    pub(crate) positions: Vec<[f64; D]>,
    /// Volume at reference density, m^3 (per metre of depth or radian).
    pub(crate) reference: Vec<f64>,
    pub(crate) spacing: Vec<f64>,
    /// Distance from the outermost particles to the surface, in half spacings.
    pub(crate) surface: f64,
    /// Factor of gradients that are not corrected.
    pub(crate) scale: f64,
    /// Coefficients of the pair viscosity.
    pub(crate) viscosity: [f64; 2],
    pub(crate) records: Records<D>,
    pub(crate) batches: Vec<Batch>,
    /// Acceleration by neighbours and hoop stress for the next velocity update, m/s^2; without body force and loads.
    pub(crate) acceleration: Vec<[f64; 4]>,
    /// Directions in which conditions or contact moved a particle in the last step, one bit each: [`HELD`], [`TOUCHED`], [`PRESCRIBED`].
    pub(crate) held: Vec<u16>,
    /// Boundary particles and their normals.
    pub(crate) skin: Surface<D>,
    pub(crate) lists: VerletLists<D>,
    pub(crate) search: SearchMethod,
    /// Wall times of the parts of steps, if measured.
    pub(crate) times: Option<StepTimes>,
    /// Positions of particles and images, input of the neighbour search.
    pub(crate) points: Vec<[f64; D]>,
    pub(crate) images: Images<D>,
    pub(crate) mirrors: Vec<Mirror>,
    pub(crate) boundaries: Boundaries<D>,
    pub(crate) body_force: Option<BodyForce<D>>,
    pub(crate) loads: Vec<SurfaceLoad<D>>,
    pub(crate) damping: LocalDamping,
    pub(crate) team: Team,
    pub(crate) control: TimeControl,
    pub(crate) clock: Clock,
    /// Largest Courant rate, 1/s.
    pub(crate) rate: f64,
    /// Offset of the leapfrog velocities: time from the velocities to the positions, s.
    pub(crate) lag: f64,
    /// Longitudinal modulus at rest, density times squared wave speed, Pa; wave speed at rest, m/s.
    pub(crate) modulus: f64,
    pub(crate) speed_at_rest: f64,
    pub(crate) exchange: Exchange,
    /// Number of updates of the reference configuration.
    pub(crate) renewals: u64,
    watcher: Watcher,
    /// Scratch memory of each thread.
    pub(crate) memory: Arc<Vec<Mutex<Scratch>>>,
}

/// Wall times of the parts of steps, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTimes {
    /// Neighbour lists: validity check and search.
    pub search: f64,
    /// Neighbours within reach, and their kernels.
    pub kernels: f64,
    /// Sums over neighbours: gradients and forces.
    pub sums: f64,
    /// Constitutive laws, with velocity gradients from sums.
    pub law: f64,
    /// Velocity update, boundary conditions and position update.
    pub motion: f64,
}

impl StepTimes {
    /// Total of a step, s, without the contact between bodies of a scene.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.search + self.kernels + self.sums + self.law + self.motion
    }
}

/// Scratch memory of the constitutive update.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    pub deformations: Vec<Deformation<Row>>,
    pub lengths: Vec<Row>,
    pub response: Response<f64>,
}

impl<const D: usize, M: Composition<D>> Sph<D, M> {
    pub(crate) const HOOP: bool = M::Embedding::HOOP;
    pub(crate) const HAS: Has = Has {
        penalty: M::Stabilisation::PENALTY,
        stress: M::Stabilisation::STRESS,
        balance: M::Stabilisation::BALANCE,
        viscosity: M::Stabilisation::VISCOSITY,
        diffusion: M::Stabilisation::DIFFUSION,
    };

    /// Create a body of particles of a law in a layout, with the velocity (m/s) at a position (m). It runs on the caller's thread, with 0.7
    /// of the stable time step.
    ///
    /// # Errors
    /// No particle; an invalid position, volume, spacing or velocity; a law without a density.
    pub fn new(
        method: M,
        law: impl IntoMaterial<f64>,
        layout: &Layout<D>,
        velocity: impl Fn([f64; D]) -> [f64; D],
    ) -> Result<Self, SceneError> {
        layout.check(Self::HOOP)?;
        if M::Correction::SCALED && Self::HOOP {
            return Err(SceneError::NotWith {
                what: "a liquid".into(),
                method: "axisymmetric smoothed particles".into(),
                why: "images beyond the axis give energy: take a sector in space, or the material point method",
            });
        }
        let material = law.into_material();
        let density = material.density();
        if !(density > 0.0 && density.is_finite()) {
            return Err(SceneError::Density { law: material.name(), density });
        }
        let numbers = layout.order();
        let (count, virgin) = (numbers.len(), material.virgin());
        let mut places = vec![0; count];
        numbers.iter().enumerate().for_each(|(i, &n)| places[n as usize] = i as u32);
        let pick = |list: &[f64]| -> Vec<f64> { numbers.iter().map(|&n| list[n as usize]).collect() };
        let positions: Vec<[f64; D]> = numbers.iter().map(|&n| layout.positions[n as usize]).collect();
        let (reference, spacing) = (pick(&layout.volumes), pick(&layout.spacings));
        let mut records = Records { particles: count, ..Records::default() };
        records.resize(0, Self::HAS);
        for (i, &x) in positions.iter().enumerate() {
            let v = velocity(x);
            for value in v {
                number(value.is_finite(), "velocity", numbers[i] as usize, value, "finite")?;
            }
            records.velocity[i][..D].copy_from_slice(&v);
            records.velocity[i][3] = density * reference[i];
            records.smoothing[i] = method.kernel().ratio() * spacing[i];
        }
        let smallest = spacing.iter().fold(f64::INFINITY, |m, s| m.min(*s));
        let lists = VerletLists::new(Reach::sum(0.0), SKIN * smallest).map_err(SceneError::Search)?;
        let speed = material.describe_point(&virgin).map_or(0.0, |said| said.wave_speed);
        let mut solver = Sph {
            method,
            virgin,
            name: BODY.into(),
            positions,
            reference,
            spacing,
            surface: layout.surface,
            scale: if M::Correction::SCALED { lattice_scale(method.kernel(), D) } else { 1.0 },
            viscosity: method.stabilisation().viscosity(),
            records,
            batches: Vec::new(),
            acceleration: vec![[0.0; 4]; count],
            held: vec![0; count],
            skin: Surface::default(),
            lists,
            search: SearchMethod::default(),
            times: None,
            points: Vec::new(),
            images: Images::default(),
            mirrors: Vec::new(),
            boundaries: Boundaries::default(),
            body_force: None,
            loads: Vec::new(),
            damping: LocalDamping::default(),
            team: Team::one(),
            control: TimeControl::Courant { factor: COURANT, growth: 1.1 },
            clock: Clock::default(),
            rate: 0.0,
            lag: 0.0,
            modulus: density * speed * speed,
            speed_at_rest: speed,
            exchange: Exchange::default(),
            renewals: 0,
            watcher: Watcher::default(),
            memory: Arc::new(vec![Mutex::default()]),
            material,
            places,
            numbers,
        };
        // Corrected gradients need no images: an axis is a surface for them, and the radius that weights stresses is zero there. The work
        // of images would not be conjugate to their gradients.
        if Self::HOOP && !M::Correction::CORRECTED {
            solver.mirrors.push(Mirror::new(0, 0.0, 1.0, MirrorKind::Axis));
        }
        if M::Correction::SCALED {
            solver.reduce_pair_viscosity();
        }
        solver.make_batches();
        solver.begin_anew_with(|_| ())?;
        Ok(solver)
    }

    fn make_batches(&mut self) {
        let (count, numbers) = (self.positions.len(), self.virgin.len());
        self.batches = (0..count.div_ceil(BATCH))
            .map(|b| {
                let here = (count - b * BATCH).min(BATCH);
                let mut batch =
                    Batch { rows: vec![Row::default(); here.div_ceil(GROUP) * numbers], ..Batch::default() };
                for (at, row) in batch.rows.iter_mut().enumerate() {
                    row.as_mut().fill(self.virgin[at % numbers]);
                }
                for list in [&mut batch.moments, &mut batch.correction] {
                    list.resize(here, [[0.0; 3]; 3]);
                }
                if M::Form::TOTAL {
                    batch.first.resize(here, [[0.0; 3]; 3]);
                    batch.deformation.resize(here, identity(D));
                }
                batch.stress.resize(here, [0.0; 8]);
                batch.start.resize(here, [0.0; 4]);
                if Self::HAS.stress {
                    batch.spin.resize(here, [0.0; 3]);
                }
                if Self::HAS.stress || Self::HAS.viscosity {
                    batch.stabilising.resize(here, [0.0; 4]);
                }
                if Self::HAS.diffusion {
                    batch.diffusing.resize(here, 0.0);
                    if !M::Correction::CORRECTED {
                        batch.of_density.resize(here, identity(D));
                        batch.surrounded.resize(here, true);
                    }
                }
                batch
            })
            .collect();
    }

    /// Set the name of the body in messages and files.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Set the run checks: [`Watch`]. A run that a check stopped may be continued after this.
    pub fn set_watch(&mut self, watch: Watch) {
        self.watcher.set(watch);
    }

    /// Set the thread pool. Results are bitwise identical for any number of threads. Below [`SMALL`] particles one thread is used: it is
    /// faster than waking more.
    pub fn set_team(&mut self, team: Team) {
        self.team = if self.positions.len() < SMALL { Team::one() } else { team };
        self.memory = Arc::new((0..self.team.threads()).map(|_| Mutex::default()).collect());
    }

    /// Set the time step control. The Courant rate is the stability limit of waves that alternate from particle to particle: a factor of 1
    /// is about the limit of a body at rest.
    ///
    /// # Errors
    /// An invalid time step control.
    pub fn set_time_control(&mut self, control: TimeControl) -> Result<(), ControlError> {
        control.check_without_grid()?;
        self.control = control;
        Ok(())
    }

    /// Set the neighbour search method and the skin, in smallest spacings. Lists include pairs out of reach by up to the skin, and are
    /// reused until a particle moved half of it. By default sorted cells, with a skin of 0.4; with 0 every step searches. Results are
    /// bitwise identical.
    ///
    /// # Errors
    /// A skin that is negative or not finite; positions that cannot be searched.
    pub fn set_search(&mut self, method: SearchMethod, skin: f64) -> Result<(), SceneError> {
        let smallest = self.spacing.iter().fold(f64::INFINITY, |m, s| m.min(*s));
        self.lists = VerletLists::new(Reach::sum(0.0), skin * smallest).map_err(SceneError::Search)?;
        self.search = method;
        self.go_on().map_err(SceneError::Search)
    }

    /// Start to measure the wall times of the parts of steps.
    pub fn measure_steps(&mut self) {
        self.times = Some(StepTimes::default());
    }
    /// Return the wall times of the parts of steps since [`Sph::measure_steps`].
    pub fn step_times(&self) -> StepTimes {
        self.times.unwrap_or_default()
    }

    /// Add a boundary condition; [`Boundary::hold`](Boundary::check_moving) describes its effect on particles. For liquids
    /// ([`ScaledGradients`](crate::ScaledGradients)) walls, fixed planes and planes of symmetry are mirrors, which carry the weight of the
    /// liquid: it slips along walls, with or without friction, sticks to fixed planes, and parts from none. Beyond a plane of symmetry
    /// particles have mirror images as neighbours; beyond an axis of revolution they have images only without gradient correction. Walls
    /// keep the surface ([`Layout::surface`]) in front of them. Their order is that of [`Boundaries::add`].
    ///
    /// # Errors
    /// Invalid numbers of a condition; periodic planes but for liquids, which need a period of five smoothing lengths; a particle behind a
    /// plane of symmetry; walls of a liquid that are nearer to each other than particles reach.
    pub fn bound(&mut self, boundary: impl Into<BoundaryEntry<D>>) -> Result<(), SceneError> {
        let entry = boundary.into();
        if M::Correction::SCALED {
            Condition::check(entry.boundary())?;
            if self.bound_liquid(entry.clone())? {
                return Ok(());
            }
        }
        entry
            .boundary()
            .check_moving("with smoothed particles; take planes of symmetry, or the material point method")?;
        if let Boundary::Symmetry { axis, at, side } = *entry.boundary() {
            let is_axis = Self::HOOP && axis == 0 && at == 0.0;
            self.boundaries.add(entry);
            if !is_axis {
                return self.mirror(axis, at, side, MirrorKind::Symmetry);
            }
            return Ok(());
        }
        let points = self.positions.iter().zip(&self.spacing).map(|(x, s)| (*x, 0.5 * self.surface * s));
        let entry = entry.map(|boundary| boundary.on_face(points));
        self.boundaries.add(entry);
        Ok(())
    }

    /// Add a rigid wall at rest by mirror images of the particles, as in the original formulation \[Xiao2015\]: it has no friction and acts
    /// in compression only. Particles that penetrate nevertheless are stopped at it.
    ///
    /// # Errors
    /// Errors of [`Sph::bound`]; the total Lagrangian form, whose neighbours never change: use [`Boundary::Wall`] instead.
    pub fn mirror_wall(&mut self, axis: usize, at: f64, side: Side) -> Result<(), SceneError> {
        if M::Form::TOTAL {
            return Err(SceneError::NotWith {
                what: "a wall of mirror images".into(),
                method: M::Form::NAME.into(),
                why: "its neighbours never change: take `Boundary::Wall`",
            });
        }
        let wall = Boundary::<D>::Wall { axis, at, side, velocity: 0.0 };
        wall.check_moving("with smoothed particles")?;
        self.mirror(axis, at, side, MirrorKind::Wall)
    }

    fn mirror(&mut self, axis: usize, at: f64, side: Side, kind: MirrorKind) -> Result<(), SceneError> {
        let sign = side.sign();
        for (i, x) in self.positions.iter().enumerate() {
            let allowed = "in front of the plane that mirrors";
            number((x[axis] - at) * sign > 0.0, "position", self.numbers[i] as usize, x[axis], allowed)?;
        }
        self.lists.forget();
        self.begin_anew_with(|sph| sph.mirrors.push(Mirror::new(axis, at, sign, kind)))
    }

    /// Set the acceleration of all particles over time, m/s^2.
    pub fn set_body_force(&mut self, acceleration: BodyForce<D>) {
        self.body_force = Some(acceleration);
        if M::Correction::SCALED {
            // Images have the weight of the liquid.
            self.push();
        }
    }

    /// Apply a traction history to particles: `areas` of their faces by layout number, m^2 (per metre of depth or per radian). Several
    /// loads add up.
    ///
    /// # Errors
    /// A number of areas other than that of particles; no positive area; a negative or non-finite area.
    pub fn load(&mut self, areas: Vec<f64>, history: TractionHistory<D>) -> Result<(), SceneError> {
        let refuse = |why| {
            let (what, method) = ("a traction".into(), format!("body `{}`", self.name));
            Err(SceneError::NotWith { what, method, why })
        };
        if areas.len() != self.positions.len() {
            return refuse("it has not as many areas as the body has particles");
        }
        if !areas.iter().all(|area| area.is_finite() && *area >= 0.0) {
            return refuse("an area is negative or no number");
        }
        if areas.iter().all(|area| *area == 0.0) {
            return refuse("it loads no particle");
        }
        self.loads.push(SurfaceLoad { areas, history });
        Ok(())
    }

    /// Set local damping towards rest ([`LocalDamping`]): a part of the unbalanced force of every particle, contact and conditions
    /// included, is removed while it accelerates the particle, and added while it decelerates it. States at rest are unchanged. The energy
    /// is booked as damping.
    ///
    /// # Errors
    /// A coefficient outside \[0, 1).
    pub fn set_local_damping(&mut self, coefficient: f64) -> Result<(), SceneError> {
        self.damping = LocalDamping::new(coefficient)?;
        Ok(())
    }

    /// Set the state of every particle by `change`, from its position (m) and its state of the law `C`, which must be the body's; for
    /// initial stresses.
    ///
    /// # Errors
    /// Another law; a non-finite number.
    pub fn set_states<C: Constitutive<f64>>(
        &mut self,
        mut change: impl FnMut([f64; D], C::State<f64>) -> C::State<f64>,
    ) -> Result<(), SceneError> {
        let mut names = Vec::new();
        C::State::<f64>::names("state", &mut names);
        if names != self.material.state_names() {
            return Err(SceneError::OtherState { law: self.material.name(), there: names.join(", ") });
        }
        self.set_numbers(|x, state| {
            if let Ok(old) = unflatten::<f64, C::State<f64>>(state) {
                state.copy_from_slice(&flatten(&change(x, old)));
            }
        })
    }

    /// Set the state of every particle by its numbers, in the order of [`Material::state_names`]; for a law that is an object. Masses stay.
    ///
    /// # Errors
    /// A non-finite number.
    pub fn set_numbers(&mut self, mut change: impl FnMut([f64; D], &mut [f64])) -> Result<(), SceneError> {
        let mut state = vec![0.0; self.virgin.len()];
        for i in 0..self.positions.len() {
            let batch = &mut self.batches[i / BATCH];
            batch.read(i % BATCH, &mut state);
            change(self.positions[i], &mut state);
            let broken = state.iter().find(|x| !x.is_finite()).copied();
            number(broken.is_none(), "state", self.numbers[i] as usize, broken.unwrap_or(0.0), "finite")?;
            batch.write(i % BATCH, &state);
        }
        self.begin_anew_with(|_| ())
    }

    /// Positions of the particles, m, sorted in space; [`Sph::numbers`] are their layout numbers.
    pub fn positions(&self) -> &[[f64; D]] {
        &self.positions
    }
    /// Layout number of each particle.
    pub fn numbers(&self) -> &[u32] {
        &self.numbers
    }
    /// Velocity of a particle in the middle of the last step, m/s.
    ///
    /// # Panics
    /// There is no such particle.
    pub fn velocity(&self, i: usize) -> [f64; D] {
        std::array::from_fn(|d| self.records.velocity[i][d])
    }
    /// Mass of a particle, kg: per metre of depth in plane strain, per radian around an axis.
    ///
    /// # Panics
    /// There is no such particle.
    pub fn mass(&self, i: usize) -> f64 {
        self.records.velocity[i][3]
    }
    /// Acceleration of a particle by its neighbours and hoop stress, m/s^2; without body force and loads.
    ///
    /// # Panics
    /// There is no such particle.
    pub fn acceleration(&self, i: usize) -> [f64; D] {
        std::array::from_fn(|d| self.acceleration[i][d])
    }
    /// Constitutive law.
    pub fn material(&self) -> &dyn Material<f64> {
        &*self.material
    }
    /// Return the names of the ingredients of the method in one line.
    pub fn describe(&self) -> String {
        self.method.describe()
    }
    /// Number of neighbour pairs of particles and images.
    pub fn pairs(&self) -> usize {
        self.batches.iter().map(|b| b.near.pairs()).sum()
    }
    /// Number of neighbour searches.
    pub fn searches(&self) -> u64 {
        self.lists.searches()
    }
    /// Number of updates of the reference configuration ([`TotalLagrangian::renewed`](crate::TotalLagrangian::renewed)).
    pub fn renewals(&self) -> u64 {
        self.renewals
    }
    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.clock.time
    }
    /// Number of steps.
    pub fn steps(&self) -> u64 {
        self.clock.steps
    }
    /// Size of the next step by the time step control, s.
    pub fn next_time_step(&self) -> f64 {
        self.control.next(self.rate, self.clock.last)
    }

    /// Step until the time `end` (s), which is reached exactly.
    ///
    /// # Errors
    /// Errors of [`Solver::run_until`].
    pub fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        Solver::run_until(self, end)
    }

    /// Store the body in a checkpoint, or load it: method, law, conditions and state; as [`Solver::archive`], but without the watch.
    pub(crate) fn archive_body(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let name = self.name.clone();
        let of = |what: &str| format!("{what} of body `{name}`");
        file.same(&of("method"), &self.method.describe())?;
        file.same(&of("ingredients"), &format!("{:?}", self.method))?;
        file.same(&of("law"), self.material.name())?;
        file.same(&of("constants of the law"), &self.material.constants())?;
        file.same(&of("number of particles"), &self.positions.len().to_string())?;
        let own: Vec<_> = self.mirrors.iter().filter(|mirror| mirror.condition.is_none()).collect();
        file.same(&of("mirrors"), &format!("{own:?}"))?;
        self.clock.archive(file)?;
        let times = [0.0, self.clock.time];
        let force = self.body_force.as_ref().map(|force| over(times, |t| force(t)));
        file.same(&of("body force"), &force.unwrap_or_default())?;
        for load in &self.loads {
            let history = over(times, |t| (load.history)(t));
            file.same(&of("traction"), &format!("{history} Pa on {:?} m^2", load.area()))?;
        }
        file.same(&of("local damping"), &format!("{:?}", self.damping.coefficient()))?;
        self.boundaries.archive(file, times, &of)?;
        let particles = self.positions.len();
        file.reals(self.positions.iter_mut().flatten())?;
        file.reals(self.records.velocity[..particles].iter_mut().flatten())?;
        file.reals(self.records.place[..particles].iter_mut().flatten())?;
        for batch in &mut self.batches {
            for row in &mut batch.rows {
                file.reals(row.as_mut())?;
            }
            file.reals(batch.stress.iter_mut().flatten())?;
            file.reals(batch.deformation.iter_mut().flatten().flatten())?;
            file.list(&mut batch.before, &[[0.0; 3]; 3], |file, f| file.reals(f.iter_mut().flatten()))?;
        }
        file.reals(self.records.artificial.iter_mut().take(particles).flatten().flatten())?;
        for held in &mut self.held {
            let mut bits = u64::from(*held);
            file.word(&mut bits)?;
            *held = bits as u16;
        }
        file.word(&mut self.renewals)?;
        file.reals([&mut self.rate, &mut self.lag])?;
        for mirror in self.mirrors.iter_mut().filter(|mirror| mirror.condition.is_some()) {
            file.reals([&mut mirror.at, &mut mirror.speed])?;
        }
        self.exchange.archive(file)?;
        if file.reads() {
            self.lists.forget();
            let resumed = self.go_on();
            resumed.map_err(|_| file.damaged("particles that have no neighbours"))?;
        }
        Ok(())
    }

    fn look(&mut self) -> Result<(), StepError> {
        let (totals, exchange, clock) = (self.totals(), Solver::exchange(self), self.clock);
        let (speed, loss) = (self.speed_at_rest, Self::ADVICE.loss);
        let at = Look::new(&clock, &exchange, speed, loss);
        let mut watcher = std::mem::take(&mut self.watcher);
        let bodies: [&dyn Body; 1] = [self];
        let gain = gain_at_the_fastest(&bodies, |_| Self::ADVICE.gain);
        let looked = watcher.look(&totals, Self::HOOP, &at, || not_finite(&bodies), gain);
        watcher.look_at_fields(&clock, &bodies, (D, Self::HOOP), None);
        self.watcher = watcher;
        looked
    }

    fn make_step(&mut self, left: f64) -> Result<f64, StepError> {
        let dt = self.clock.step_within(self.next_time_step(), left)?;
        self.check_loads(dt).map_err(|error| self.clock.stopped(Stopped::Scene(error)))?;
        if self.watcher.opens() {
            let (totals, exchange) = (self.totals(), Solver::exchange(self));
            self.watcher.open(self.clock.steps, &totals, &exchange, Self::HOOP);
        }
        self.step(dt)?;
        if self.watcher.due(self.clock.steps).is_some() {
            self.look()?;
        }
        Ok(dt)
    }

    pub(crate) fn check_loads(&self, dt: f64) -> Result<(), SceneError> {
        let time = self.clock.time;
        check_at(self.body_force.as_ref(), &self.boundaries, time, &[time, time + dt])
    }
}

/// Advice in messages on energy loss and gain.
const ADVICE: Advice = Advice {
    loss: Loss {
        by: "contacts that closed, walls of mirror images, or a reference that was renewed",
        remedy: "take `Method::total_lagrangian`, or smaller particles",
    },
    gain: "the particles there are the fastest; take a smaller Courant factor, a law with bulk viscosity, or `Method::total_lagrangian` \
           for what stays whole",
};

/// The same for liquids.
const ADVICE_OF_LIQUIDS: Advice = Advice {
    loss: Loss {
        by: "liquid that collided, or the viscosity of pairs",
        remedy: "take smaller particles; a splash or impact of a liquid loses energy by its nature",
    },
    gain: "the particles there are the fastest; take a smaller Courant factor, or a larger speed of sound of the liquid",
};

impl<const D: usize, M: Composition<D>> Sph<D, M> {
    /// Advice in messages on energy loss and gain.
    pub(crate) const ADVICE: Advice = if M::Correction::SCALED { ADVICE_OF_LIQUIDS } else { ADVICE };
}

/// Single body as a scene.
impl<const D: usize, M: Composition<D>> Solver for Sph<D, M> {
    fn method(&self) -> String {
        described(&format!("smoothed particles: {}", self.method.describe()), &[self])
    }
    fn dimensions(&self) -> usize {
        D
    }
    fn axisymmetric(&self) -> bool {
        Self::HOOP
    }
    fn clock(&self) -> &Clock {
        &self.clock
    }
    fn clock_mut(&mut self) -> &mut Clock {
        &mut self.clock
    }
    fn stable_step(&mut self) -> Result<f64, StepError> {
        Ok(self.next_time_step())
    }
    fn limited_by(&self) -> Option<StepLimit> {
        Some(self.control.limit(self.rate, self.clock.last, 0))
    }
    // Never inlined, so that profilers (callgrind) separate steps from observers.
    #[inline(never)]
    fn step_at_most(&mut self, left: f64) -> Result<f64, StepError> {
        self.watcher.may_go_on()?;
        let made = self.make_step(left);
        self.watcher.note(made)
    }
    fn set_team(&mut self, team: Team) {
        Sph::set_team(self, team);
    }
    fn bodies(&self) -> Vec<&dyn Body> {
        vec![self]
    }
    fn exchange(&self) -> Exchange {
        self.exchange
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.archive_body(file)?;
        self.watcher.archive(file)
    }
    fn stopped_by(&self) -> Option<&StepError> {
        self.watcher.stopped_by()
    }
    fn look_at_the_end(&mut self) -> Result<(), StepError> {
        if !self.watcher.due_at_the_end(self.clock.steps) {
            return Ok(());
        }
        let looked = self.look();
        self.watcher.note(looked)
    }
    fn warnings(&self) -> &[Warning] {
        self.watcher.warnings()
    }
    fn account_of(&self, totals: &Totals) -> Account {
        self.watcher.account(totals, &Solver::exchange(self), Self::HOOP)
    }
}
