//! Solver: data and set-up.

use std::sync::{Arc, Mutex};

use impactite_scene::boundaries::check_at;
use impactite_scene::boundary::BodyForce;
use impactite_scene::control::ControlError;
use impactite_scene::embedding::described;
use impactite_scene::error::parameter;
use impactite_scene::watch::{Look, Loss, Watcher, gain_at_the_fastest, not_finite};
use impactite_scene::{
    Account, Archive, Body, Boundaries, Boundary, BoundaryEntry, CheckpointError, Clock, Exchange,
    LocalDamping, SceneError, Solver, StepError, StepLimit, Stopped, TimeControl, Totals, Warning, Watch,
};
use impactite_simd::Team;
use mpm_contact::particles::Advice;
use mpm_materials::material::{Deformation, Response};
use mpm_materials::point::{flatten, unflatten};
use mpm_materials::{Constitutive, IntoMaterial, Material, State};

use crate::cells::{Cells, Face, OuterFace};
use crate::flux::Flux;
use crate::loads::{FaceHistory, FaceLoad, PressureHistory, TractionHistory};
use crate::method::Composition;
use crate::open::OpenFace;
use crate::rest::Rest;
use crate::sides::Sides;
use crate::softening::Softening;
use crate::sums::{BATCH, Batch, GROUP, Load, Outer, Row, Trace};
use crate::vector::{Tensor, dot, scaled, zero};

/// Default safety factor of the time step.
const COURANT: f64 = 0.9;
/// Smallest number of cells of a body for more than one thread.
pub const SMALL: usize = 1000;
/// Default name of a body.
const BODY: &str = "body";

/// Bit of the first direction: moved by a boundary condition in the last step.
pub(crate) const HELD: u16 = 1;
/// Bit of the first direction: moved by contact with other bodies.
pub(crate) const TOUCHED: u16 = 8;
/// Bit of the first direction: moved by a boundary condition other than a wall.
pub(crate) const PRESCRIBED: u16 = 64;

/// Body of cells of one constitutive law in `D` dimensions, with the ingredients of `M`.
///
/// Total Lagrangian: gradients, faces and areas are those of the reference configuration. The law receives increments of the present
/// configuration, so that strains and rotations may be large, with any law of [`mpm_materials`]. Cells are sorted in space; they keep the
/// numbers of their [`Cells`].
#[derive(Clone)]
pub struct Fpm<const D: usize, M> {
    pub(crate) method: M,
    pub(crate) material: Arc<dyn Material<f64>>,
    pub(crate) virgin: Vec<f64>,
    pub(crate) rest: Rest<D>,
    pub(crate) name: String,
    /// Cell number of each place.
    pub(crate) numbers: Vec<u32>,
    /// Place of each cell number.
    pub(crate) places: Vec<u32>,
    /// Reference positions of the points, m, volumes, m^3, and masses, kg.
    pub(crate) reference: Vec<[f64; D]>,
    pub(crate) volume: Vec<f64>,
    pub(crate) mass: Vec<f64>,
    /// Cell sizes: edges of squares or cubes of these volumes, m.
    pub(crate) sizes: Vec<f64>,
    /// Faces between cells, by place, and those on the surface.
    pub(crate) faces: Vec<Face<D>>,
    pub(crate) surface: Vec<OuterFace<D>>,
    /// Corners of cells by place, m, if known.
    pub(crate) corners: Vec<Vec<[f64; D]>>,
    pub(crate) sides: Sides<D>,
    pub(crate) displacement: Vec<[f64; D]>,
    pub(crate) velocity: Vec<[f64; D]>,
    /// Acceleration by faces for the next velocity update, m/s^2; without body force.
    pub(crate) acceleration: Vec<[f64; D]>,
    pub(crate) traces: Vec<Trace<D>>,
    /// First Piola-Kirchhoff stress P, Pa.
    pub(crate) stress: Vec<Tensor<D>>,
    pub(crate) loads: Vec<Load<D>>,
    pub(crate) batches: Vec<Batch<D>>,
    pub(crate) acting: Vec<FaceLoad<D>>,
    /// Open faces in the order in which they opened.
    pub(crate) cracks: Vec<OpenFace<D>>,
    /// Softening faces.
    pub(crate) softening: Softening<D>,
    pub(crate) friction: f64,
    pub(crate) boundaries: Boundaries<D>,
    pub(crate) body_force: Option<BodyForce<D>>,
    pub(crate) damping: LocalDamping,
    pub(crate) team: Team,
    pub(crate) control: TimeControl,
    pub(crate) clock: Clock,
    /// Courant rate, half the highest frequency, 1/s, and its ratio to the bound by rows ([`crate::pace`]).
    pub(crate) rate: f64,
    pub(crate) sharpness: f64,
    /// Offset of the leapfrog velocities: time from the velocities to the displacements, s.
    pub(crate) lag: f64,
    pub(crate) exchange: Exchange,
    /// Energy dissipated by cracks, J.
    pub(crate) dissipated: f64,
    watcher: Watcher,
    /// Scratch memory of each thread.
    pub(crate) memory: Arc<Vec<Mutex<Scratch<D>>>>,
}

/// Scratch memory of the constitutive update.
#[derive(Debug, Default)]
pub(crate) struct Scratch<const D: usize> {
    pub seen: Vec<Tensor<D>>,
    pub deformations: Vec<Deformation<Row>>,
    pub lengths: Vec<Row>,
    pub response: Response<f64>,
}

impl<const D: usize, M: Composition<D>> Fpm<D, M> {
    /// Create a body of cells of a law, with the velocity (m/s) at a position (m). It runs on the caller's thread, with 0.9 of the stable
    /// time step.
    ///
    /// # Errors
    /// A non-finite velocity; a law without a density.
    pub fn new(
        method: M,
        law: impl IntoMaterial<f64>,
        cells: &Cells<D>,
        velocity: impl Fn([f64; D]) -> [f64; D],
    ) -> Result<Self, SceneError> {
        let material = law.into_material();
        let rest = Rest::of(&*material)?;
        let numbers = order(cells);
        let (count, virgin) = (numbers.len(), material.virgin());
        let mut places = vec![0u32; count];
        numbers.iter().enumerate().for_each(|(i, &n)| places[n as usize] = i as u32);
        let reference: Vec<[f64; D]> = numbers.iter().map(|&n| cells.points()[n as usize]).collect();
        let volume: Vec<f64> = numbers.iter().map(|&n| cells.volumes()[n as usize]).collect();
        let mut velocities = Vec::with_capacity(count);
        for (i, &x) in reference.iter().enumerate() {
            let v = velocity(x);
            if let Some(&value) = v.iter().find(|x| !x.is_finite()) {
                let (field, allowed) = ("velocity", "finite");
                let element = numbers[i] as usize;
                return Err(SceneError::Element { body: BODY.into(), element, field, value, allowed });
            }
            velocities.push(v);
        }
        let faces = placed(cells.faces(), &places);
        let mut surface = cells.outer().to_vec();
        surface.iter_mut().for_each(|f| f.cell = places[f.cell as usize]);
        surface.sort_by_key(|f| f.cell);
        let corners = numbers.iter().map(|&n| cells.corners(n as usize).to_vec()).collect();
        let mut solver = Fpm {
            sides: Sides::new(&reference, &faces, method.penalty().eta() * rest.modulus),
            mass: volume.iter().map(|v| rest.density * v).collect(),
            sizes: volume.iter().map(|v| v.powf(1.0 / D as f64)).collect(),
            method,
            virgin,
            rest,
            name: BODY.into(),
            displacement: vec![[0.0; D]; count],
            velocity: velocities,
            acceleration: vec![[0.0; D]; count],
            traces: vec![Trace::default(); count],
            stress: vec![zero(); count],
            loads: vec![Load::default(); count],
            batches: Vec::new(),
            acting: Vec::new(),
            cracks: Vec::new(),
            softening: Softening::default(),
            friction: 0.0,
            boundaries: Boundaries::default(),
            body_force: None,
            damping: LocalDamping::default(),
            team: Team::one(),
            control: TimeControl::Courant { factor: COURANT, growth: 1.1 },
            clock: Clock::default(),
            rate: 0.0,
            sharpness: 1.0,
            lag: 0.0,
            exchange: Exchange::default(),
            dissipated: 0.0,
            watcher: Watcher::default(),
            memory: Arc::new(vec![Mutex::default()]),
            material,
            reference,
            volume,
            faces,
            surface,
            corners,
            numbers,
            places,
        };
        solver.make_batches();
        solver.open_notches();
        solver.fit_all();
        solver.find_rows();
        solver.begin();
        solver.find_rates();
        Ok(solver)
    }

    fn make_batches(&mut self) {
        let (count, numbers) = (self.reference.len(), self.virgin.len());
        self.batches = (0..count.div_ceil(BATCH))
            .map(|b| {
                let here = (count - b * BATCH).min(BATCH);
                let mut batch =
                    Batch { rows: vec![Row::default(); here.div_ceil(GROUP) * numbers], ..Batch::default() };
                for (at, row) in batch.rows.iter_mut().enumerate() {
                    row.as_mut().fill(self.virgin[at % numbers]);
                }
                batch.gradient.resize(here, zero());
                batch.lifting.resize(here, zero());
                if !M::Flux::LIFTED {
                    batch.before.resize(here, [zero(); 2]);
                }
                batch.said.resize(here, [0.0; 8]);
                batch.rates.resize(here, [0.0; 2]);
                batch.start.resize(here, [0.0; D]);
                batch.held.resize(here, 0);
                batch
            })
            .collect();
    }

    /// Open the faces of notches.
    fn open_notches(&mut self) {
        let modulus = self.contact_modulus();
        for face in 0..self.faces.len() {
            if self.faces[face].open {
                let cells = self.faces[face].cells;
                let surface = self.sides.surface[self.side_of(face as u32, cells[0])];
                let gap = self.faces[face].gap;
                self.note_crack(OpenFace::notch(face as u32, cells, surface, modulus).with_gap(gap));
            }
        }
    }

    /// Return the contact modulus of closed cracks, Pa.
    pub(crate) fn contact_modulus(&self) -> f64 {
        self.method.penalty().eta().max(1.0) * self.rest.modulus
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

    /// Set the thread pool. Results are bitwise identical for any number of threads. Below [`SMALL`] cells one thread is used: it is faster
    /// than waking more.
    pub fn set_team(&mut self, team: Team) {
        self.team = if self.reference.len() < SMALL { Team::one() } else { team };
        self.memory = Arc::new((0..self.team.threads()).map(|_| Mutex::default()).collect());
    }

    /// Set the time step control. The Courant rate is half the highest frequency of the cells: a factor of 1 is the stability limit of a
    /// body at small strain.
    ///
    /// # Errors
    /// An invalid time step control.
    pub fn set_time_control(&mut self, control: TimeControl) -> Result<(), ControlError> {
        control.check_without_grid()?;
        self.control = control;
        Ok(())
    }

    /// Set local damping towards rest ([`LocalDamping`]): a part of the unbalanced force of every point, contact and conditions included,
    /// is removed while it accelerates the point, and added while it decelerates it. States at rest are unchanged. The energy is booked as
    /// damping.
    ///
    /// # Errors
    /// A coefficient outside \[0, 1).
    pub fn set_local_damping(&mut self, coefficient: f64) -> Result<(), SceneError> {
        self.damping = LocalDamping::new(coefficient)?;
        Ok(())
    }

    /// Set the Coulomb friction of closed cracks; zero by default.
    ///
    /// # Errors
    /// A negative or non-finite coefficient.
    pub fn set_friction(&mut self, coefficient: f64) -> Result<(), SceneError> {
        let allowed = "zero or positive, and finite";
        self.friction = parameter(coefficient >= 0.0, "cracks", "friction", coefficient, allowed)?;
        Ok(())
    }

    /// Add a boundary condition on points; [`Boundary::hold`](Boundary::check_moving) describes its effect. Walls keep the surface in front
    /// of them. A plane of symmetry is enforced on the faces in it ([`Fpm::hold_faces`]): their normal displacement is zero. A prescribed
    /// region that contains faces of the surface, but no point, drives these faces.
    ///
    /// # Errors
    /// Invalid numbers of a condition; periodic planes; a plane of symmetry that cuts the body, or has all of it behind.
    pub fn bound(&mut self, boundary: impl Into<BoundaryEntry<D>>) -> Result<(), SceneError> {
        let entry = boundary.into();
        let (boundary, account) = (entry.boundary(), entry.account());
        boundary.check_moving("with cells that keep their neighbours; take planes of symmetry")?;
        if let Boundary::Symmetry { axis, at, side } = *boundary {
            let on = |f: &OuterFace<D>| {
                (f.centroid[axis] - at).abs() <= 1e-6 * f.area.powf(1.0 / (D as f64 - 1.0))
            };
            let in_front = |x: &[f64; D]| (x[axis] - at) * side.sign() > 0.0;
            if !self.surface.iter().any(on) && self.reference.iter().all(in_front) {
                // The body may reach the plane later.
                self.boundaries.add(entry);
                return Ok(());
            }
            let across = move |_| std::array::from_fn(|d| (d == axis).then_some(0.0));
            let on = |f: &OuterFace<D>| on(f) && f.normal[axis].abs() > 0.999;
            let load = |faces| FaceLoad::displacement(Arc::new(across), faces).booked_to(account);
            return self.act(on, load).map(|_| ());
        }
        if let Boundary::Fixed { axis, at, side } = *boundary {
            let behind = |x: &[f64; D]| (x[axis] - at) * side.sign() <= 0.0;
            let on = |f: &OuterFace<D>| {
                (f.centroid[axis] - at).abs() <= 1e-6 * f.area.powf(1.0 / (D as f64 - 1.0))
                    && f.normal[axis].abs() > 0.999
            };
            if !self.reference.iter().any(behind) && self.surface.iter().any(on) {
                let still = Arc::new(|_| [Some(0.0); D]);
                let load = |faces| FaceLoad::displacement(still, faces).booked_to(account);
                return self.act(on, load).map(|_| ());
            }
        }
        if let Boundary::Prescribed { region, velocity } = boundary {
            let on = |f: &OuterFace<D>| region.contains(f.centroid);
            if !self.reference.iter().any(|x| region.contains(*x)) && self.surface.iter().any(on) {
                let (region, velocity) = (region.clone(), velocity.clone());
                let along = move |time: f64| {
                    let v = velocity(time);
                    std::array::from_fn(|d| v[d])
                };
                let load = |faces| FaceLoad::velocity(Arc::new(along), faces).booked_to(account);
                return self.act(|f| region.contains(f.centroid), load).map(|_| ());
            }
        }
        self.boundaries.add(entry);
        Ok(())
    }

    /// Apply a traction to the faces of the surface selected by `on`, Pa over time: force per area of the reference configuration, in fixed
    /// directions. Return the number of faces.
    ///
    /// # Errors
    /// No such face; a traction that is not finite at the start.
    pub fn load_faces(
        &mut self,
        on: impl Fn(&OuterFace<D>) -> bool,
        traction: TractionHistory<D>,
    ) -> Result<usize, SceneError> {
        self.act(on, |faces| FaceLoad::traction(traction, faces))
    }

    /// Apply a pressure to the faces of the surface selected by `on`, Pa over time, compression positive: along the present normals on the
    /// present areas, by the deformation gradient of the cell of each face. Return the number of faces.
    ///
    /// # Errors
    /// No such face; a pressure that is not finite at the start.
    pub fn press_faces(
        &mut self,
        on: impl Fn(&OuterFace<D>) -> bool,
        pressure: PressureHistory,
    ) -> Result<usize, SceneError> {
        self.act(on, |faces| FaceLoad::pressure(pressure, faces))
    }

    /// Prescribe the displacement of the faces of the surface selected by `on`, m over time, weakly by the flux that joins cells:
    /// t* = P N - eta / l (u - u_held). Components that are `None` are free. Return the number of faces.
    ///
    /// # Errors
    /// No such face; a displacement that is not finite at the start.
    pub fn hold_faces(
        &mut self,
        on: impl Fn(&OuterFace<D>) -> bool,
        displacement: FaceHistory<D>,
    ) -> Result<usize, SceneError> {
        self.act(on, |faces| FaceLoad::displacement(displacement, faces))
    }

    /// Prescribe the velocity of the faces of the surface selected by `on`, m/s over time, as [`Fpm::hold_faces`] the displacement.
    ///
    /// # Errors
    /// Errors of [`Fpm::hold_faces`].
    pub fn drive_faces(
        &mut self,
        on: impl Fn(&OuterFace<D>) -> bool,
        velocity: FaceHistory<D>,
    ) -> Result<usize, SceneError> {
        self.act(on, |faces| FaceLoad::velocity(velocity, faces))
    }

    fn act(
        &mut self,
        on: impl Fn(&OuterFace<D>) -> bool,
        load: impl FnOnce(String) -> FaceLoad<D>,
    ) -> Result<usize, SceneError> {
        let chosen: Vec<OuterFace<D>> = self.surface.iter().filter(|f| on(f)).copied().collect();
        let none = "at least one: no face of the surface is where the rule says";
        parameter(!chosen.is_empty(), "faces of the surface", "number chosen", chosen.len() as f64, none)?;
        let sum = chosen.iter().fold([0.0; D], |sum, f| crate::vector::along(&sum, f.area, &f.centroid));
        let load = load(format!("{} faces, {sum:?}", chosen.len()));
        load.check(self.clock.time, 0.0)?;
        let stiffness = self.method.penalty().eta() * self.rest.modulus;
        for face in &chosen {
            let cell = face.cell as usize;
            let arm = crate::vector::difference(&face.centroid, &self.reference[cell]);
            let outer = Outer {
                cell: (cell % BATCH) as u32,
                load: self.acting.len() as u32,
                area: scaled(&face.normal, face.area),
                arm,
                // Distance of the point to its mirror image beyond the face.
                stiffness: face.area * stiffness / (2.0 * dot(&arm, &face.normal)).abs(),
                force: [0.0; D],
                moved: self.traces[cell].at(&arm),
            };
            self.batches[cell / BATCH].outer.push(outer);
        }
        let holds = load.holds();
        self.acting.push(load);
        self.begin();
        if holds {
            let mut cells: Vec<u32> = chosen.iter().map(|f| f.cell).collect();
            cells.dedup();
            self.ring(&self.ring(&cells)).iter().for_each(|&c| self.renew_rate(c as usize));
            self.find_rates();
        }
        Ok(chosen.len())
    }

    /// Set the acceleration of all points over time, m/s^2.
    pub fn set_body_force(&mut self, acceleration: BodyForce<D>) {
        self.body_force = Some(acceleration);
    }

    /// Set the state of every cell by `change`, from the position of its point (m) and its state of the law `C`, which must be the body's;
    /// for initial stresses.
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
        let mut state = vec![0.0; self.virgin.len()];
        for i in 0..self.reference.len() {
            let batch = &mut self.batches[i / BATCH];
            batch.read(i % BATCH, &mut state);
            if let Ok(old) = unflatten::<f64, C::State<f64>>(&state) {
                state.copy_from_slice(&flatten(&change(self.reference[i], old)));
            }
            if let Some(&value) = state.iter().find(|x| !x.is_finite()) {
                let (body, element) = (self.name.clone(), self.numbers[i] as usize);
                return Err(SceneError::Element { body, element, field: "state", value, allowed: "finite" });
            }
            batch.write(i % BATCH, &state);
        }
        self.begin();
        Ok(())
    }

    /// Return the side of a cell at a face.
    pub(crate) fn side_of(&self, face: u32, cell: u32) -> usize {
        let side = self.sides.of(cell as usize).find(|&s| self.sides.face[s] == face);
        side.unwrap_or_else(|| unreachable!("a face is a side of both its cells"))
    }

    /// Number of each cell in the [`Cells`], in sorted order.
    pub fn numbers(&self) -> &[u32] {
        &self.numbers
    }
    /// Reference positions of the points, m, in sorted order.
    pub fn reference(&self) -> &[[f64; D]] {
        &self.reference
    }
    /// Displacements of the points, m.
    pub fn displacements(&self) -> &[[f64; D]] {
        &self.displacement
    }
    /// Position of a point, m.
    ///
    /// # Panics
    /// There is no such cell.
    pub fn position(&self, i: usize) -> [f64; D] {
        crate::vector::along(&self.reference[i], 1.0, &self.displacement[i])
    }
    /// Velocities of the points in the middle of the last step, m/s.
    pub fn velocities(&self) -> &[[f64; D]] {
        &self.velocity
    }
    /// Accelerations of the points by faces, m/s^2; without body force.
    pub fn accelerations(&self) -> &[[f64; D]] {
        &self.acceleration
    }
    /// Masses, kg: per metre of depth in the plane.
    pub fn masses(&self) -> &[f64] {
        &self.mass
    }
    /// First Piola-Kirchhoff stresses, Pa.
    pub fn nominal_stresses(&self) -> &[[[f64; D]; D]] {
        &self.stress
    }
    /// Constitutive law.
    pub fn material(&self) -> &dyn Material<f64> {
        &*self.material
    }
    /// Return the names of the ingredients of the method in one line.
    pub fn describe(&self) -> String {
        self.method.describe()
    }
    /// Number of rigid cells, whose neighbours are too few, or in a line or plane.
    pub fn rigid_cells(&self) -> usize {
        self.batches.iter().map(|b| b.rigid.len()).sum()
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
    /// Largest stable time step at small strain, s: two over the highest frequency.
    pub fn critical_time_step(&self) -> f64 {
        1.0 / self.rate
    }

    /// Step until the time `end` (s), which is reached exactly.
    ///
    /// # Errors
    /// Errors of [`Solver::run_until`].
    pub fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        Solver::run_until(self, end)
    }

    fn look(&mut self) -> Result<(), StepError> {
        let (totals, exchange, clock) = (self.totals(), Solver::exchange(self), self.clock);
        let (speed, loss) = (self.rest.speed, ADVICE.loss);
        let at = Look::new(&clock, &exchange, speed, loss);
        let mut watcher = std::mem::take(&mut self.watcher);
        let bodies: [&dyn Body; 1] = [self];
        let gain = gain_at_the_fastest(&bodies, |_| ADVICE.gain);
        let looked = watcher.look(&totals, false, &at, || not_finite(&bodies), gain);
        watcher.look_at_fields(&clock, &bodies, (D, false), None);
        self.watcher = watcher;
        looked
    }

    fn make_step(&mut self, left: f64) -> Result<f64, StepError> {
        let dt = self.clock.step_within(self.next_time_step(), left)?;
        self.check_loads(dt).map_err(|error| self.clock.stopped(Stopped::Scene(error)))?;
        if self.watcher.opens() {
            let (totals, exchange) = (self.totals(), Solver::exchange(self));
            self.watcher.open(self.clock.steps, &totals, &exchange, false);
        }
        self.step(dt)?;
        if self.watcher.due(self.clock.steps).is_some() {
            self.look()?;
        }
        Ok(dt)
    }

    pub(crate) fn check_loads(&self, dt: f64) -> Result<(), SceneError> {
        let time = self.clock.time;
        check_at(self.body_force.as_ref(), &self.boundaries, time, &[time, time + dt])?;
        self.acting.iter().try_for_each(|load| load.check(time, dt))
    }
}

/// Advice in messages on energy loss and gain.
pub(crate) const ADVICE: Advice = Advice {
    loss: Loss {
        by: "contacts that closed, or a law that does not keep it",
        remedy: "take smaller cells, a smaller Courant factor, or `Method::symmetric`",
    },
    gain: "the cells there are the fastest; take a smaller Courant factor, a larger penalty, or `Method::symmetric`",
};

/// Return the faces of cells at these places, in sorted order.
fn placed<const D: usize>(faces: &[Face<D>], places: &[u32]) -> Vec<Face<D>> {
    let of = |f: &Face<D>| {
        let [a, b] = f.cells.map(|c| places[c as usize]);
        let turn = a > b;
        let normal = if turn { scaled(&f.normal, -1.0) } else { f.normal };
        Face { cells: [a.min(b), a.max(b)], normal, ..*f }
    };
    let mut faces: Vec<Face<D>> = faces.iter().map(of).collect();
    faces.sort_by_key(|f| f.cells);
    faces
}

/// Sort cells along a space-filling curve (Morton order) in boxes of a few cell sizes, for memory locality. Return the cell number of each
/// place.
fn order<const D: usize>(cells: &Cells<D>) -> Vec<u32> {
    let low = cells.bounds().min;
    let count = cells.len() as f64;
    let edge = 2.0 * cells.volumes().iter().map(|v| v.powf(1.0 / D as f64) / count).sum::<f64>();
    let key = |n: &u32| {
        let mut key = 0u64;
        for d in 0..D {
            // Values beyond the range of an integer saturate.
            let along = ((cells.points()[*n as usize][d] - low[d]) / edge) as u64;
            for bit in 0..20 {
                key |= (along >> bit & 1) << (bit * D + d);
            }
        }
        (key, *n)
    };
    let mut order: Vec<u32> = (0..cells.len() as u32).collect();
    order.sort_by_cached_key(key);
    order
}

/// Single body as a scene.
impl<const D: usize, M: Composition<D>> Solver for Fpm<D, M> {
    fn method(&self) -> String {
        described(&format!("fragile points: {}", self.method.describe()), &[self])
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
        Fpm::set_team(self, team);
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
        self.watcher.account(totals, &Solver::exchange(self), false)
    }
}
