//! How a body gets its particles: from seeds, or from a body of another scene.

use std::collections::BTreeMap;
use std::sync::Arc;

use mpm_materials::material::{Deformation, Length, Motion, Response, StatesMut};
use mpm_materials::point::flatten;
use mpm_materials::{Constitutive, IntoMaterial, Material, MaySplit};

use super::body::GridBody;
use super::kernels::MethodKernels;
use super::load::{FieldForce, Loading, Loads, Traction};
use super::merging::MergeBook;
use super::particle_body::ParticleBody;
use super::rigid::Rigid;
use super::rigid_body::RigidBody;
use super::solver::Mpm;
use super::splitting::{SplitBook, Splitter, Splitting};
use super::total;
use super::wrap::Wrap;
use crate::dim::BLOCK;
use crate::geometry::{Lattice, Seeds};
use crate::method::{Composition, IntoKernels};
use crate::parallel::Float;
use crate::particles::{Columns, Masses, split};
use crate::shape::Domain;
use crate::shape::domain::MOST_NUMBERS;
use impactite_scene::Boundary;
use impactite_scene::error::SceneError;

/// A velocity by position, m and m/s.
type Velocity<'a, const D: usize> = dyn Fn([f64; D]) -> [f64; D] + 'a;
/// The numbers of a law's state by position, m.
type InitialState<'a, T, const D: usize> = dyn Fn([f64; D]) -> Vec<T> + 'a;

/// A deformable body for a scene: a law, particles, how they move, and what else is to be said of them. All of that combines.
///
/// ```
/// # use mpm_core::{BlockGrid, Deformable, Flip, Linear, Method, Mpm, Musl, PlaneStrain, Splitting, Traction, geometry::*};
/// # use mpm_materials::{Constitutive, Stretching, library};
/// # use std::sync::Arc;
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let lattice = Lattice::new([0.0; 2], 1e-3)?;
/// # let seeds = fill(&Cuboid::new([0.0; 2], [4e-3, 2e-3])?, &lattice, 2, &Filling::new())?;
/// # let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
/// let pull = Traction {
///     region: Arc::new(Cuboid::new([3.5e-3, 0.0], [4e-3, 2e-3])?),
///     axis: 0,
///     history: Arc::new(|_| [1e6, 0.0]),
///     revolved: false,
/// };
/// let strip = Deformable::new("strip", Stretching::new(library::lead()).compiled(), &seeds)
///     .moving(|x| [10.0 * x[0], 0.0])
///     .with_traction(pull)
///     .with_splitting(Splitting::at(2.0)?);
/// mpm.add_body(strip)?;
/// # mpm.run_until(1e-7)?;
/// # Ok(())
/// # }
/// ```
pub struct Deformable<'a, const D: usize, L, T: Float = f64> {
    name: String,
    law: L,
    seeds: &'a Seeds<D>,
    velocity: Box<Velocity<'a, D>>,
    state: Option<Box<InitialState<'a, T, D>>>,
    loads: Loads<D>,
    splitting: Option<Splitting>,
    kernels: Option<Arc<dyn MethodKernels<T, D>>>,
}

impl<'a, const D: usize, L: IntoMaterial<T>, T: Float> Deformable<'a, D, L, T> {
    /// A body of this law with particles at `seeds`, at rest.
    pub fn new(name: &str, law: L, seeds: &'a Seeds<D>) -> Self {
        let velocity = Box::new(|_| [0.0; D]);
        let (name, loads) = (name.to_string(), Loads::default());
        Deformable { name, law, seeds, velocity, state: None, loads, splitting: None, kernels: None }
    }
    /// With a velocity by position, m/s by m.
    #[must_use]
    pub fn moving(mut self, velocity: impl Fn([f64; D]) -> [f64; D] + 'a) -> Self {
        self.velocity = Box::new(velocity);
        self
    }
    /// With a surface load.
    #[must_use]
    pub fn with_traction(mut self, traction: Traction<D>) -> Self {
        self.loads.traction = Some(traction);
        self
    }
    /// With a force on all particles.
    #[must_use]
    pub fn with_field_force(mut self, field: FieldForce<D>) -> Self {
        self.loads.field = Some(field);
        self
    }
    /// With points in the law's `state` by position (m) instead of virgin: stressed by their own weight, or to be lit when a
    /// detonation wave arrives. A seed's volume is that of the state.
    #[must_use]
    pub fn in_state<C>(mut self, state: impl Fn([f64; D]) -> C::State<T::Single> + 'a) -> Self
    where
        L: IntoMaterial<T, Law = C>,
        C: Constitutive<T>,
    {
        let numbers = move |x| flatten(&state(x)).into_iter().map(|x: T::Single| x.into()).collect();
        self.state = Some(Box::new(numbers));
        self
    }
    /// With particles that are split where they are stretched too far.
    ///
    /// ```compile_fail
    /// # use mpm_core::{Deformable, Splitting, geometry::Seeds};
    /// # use mpm_materials::library;
    /// # fn split(seeds: &Seeds<2>) {
    /// let lead = library::lead::<f64>(); // remembers no stretch
    /// Deformable::<2, _>::new("ball", lead, seeds).with_splitting(Splitting::at(2.0).unwrap());
    /// # }
    /// ```
    #[must_use]
    pub fn with_splitting(mut self, splitting: Splitting) -> Self
    where
        L::Law: MaySplit<T>,
    {
        self.splitting = Some(splitting);
        self
    }
    /// With passes that have the law as part of them, compiled where this is written: the last per cent of speed for one
    /// composition, at the price of compiling the passes once more for this law. `method` must be that of the scene.
    #[must_use]
    pub fn inlined<M, C>(mut self, method: M) -> Self
    where
        L: IntoMaterial<T, Law = C>,
        M: Composition<T, D> + IntoKernels<T, D>,
        C: Constitutive<T>,
    {
        self.kernels = Some(super::kernels::inlined(method, self.law.law()));
        self
    }

    /// The same, whatever the type of its law.
    pub(crate) fn prepared(self) -> Prepared<'a, T, D> {
        let Deformable { name, law, seeds, velocity, state, loads, splitting, kernels } = self;
        let material = law.into_material();
        Prepared { name, material, seeds, velocity, state, loads, splitting, kernels }
    }
}

/// A [`Deformable`] of a law that is an object.
pub struct Prepared<'a, T: Float, const D: usize> {
    name: String,
    material: Arc<dyn Material<T>>,
    seeds: &'a Seeds<D>,
    velocity: Box<Velocity<'a, D>>,
    state: Option<Box<InitialState<'a, T, D>>>,
    loads: Loads<D>,
    splitting: Option<Splitting>,
    kernels: Option<Arc<dyn MethodKernels<T, D>>>,
}

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// A body of particles of these half sizes, m, without them.
    pub(super) fn empty(
        name: &str,
        material: Arc<dyn Material<T>>,
        kernels: Arc<dyn MethodKernels<T, D>>,
        lattice: Lattice<D>,
        half_size: &[f64; D],
        (loads, splitting): (Loads<D>, Option<Splitting>),
    ) -> Self {
        let facts = kernels.facts();
        let (carried, frame) = (facts.domain.numbers(D), total::rows(facts.total, facts.hoop, D));
        let columns = Columns::new(D, material.state_names(), carried, loads.numbers(), frame);
        let mut half = [T::of(0.5); 3];
        for d in 0..D {
            half[d] = T::of(half_size[d] / lattice.spacing());
        }
        // What a lane without a particle holds.
        let mut dummy = vec![T::default(); Columns::state(D)];
        dummy.extend_from_slice(&material.virgin());
        let domain = facts.domain.of_box::<T::Single, D>(half.map(T::Single::from));
        dummy.extend(domain[..carried].iter().map(|&x| -> T { x.into() }));
        dummy.resize(dummy.len() + loads.numbers(), T::default());
        dummy.extend(total::undeformed::<T>(facts.total, facts.hoop, D));
        dummy.resize(columns.count(), T::default());
        let masses = Masses::Each(columns.mass());
        let coheres = bears_shear_and_tension(&*material);
        ParticleBody {
            name: name.into(),
            coheres,
            material,
            kernels,
            lattice,
            columns,
            slots: Vec::new(),
            spare: Vec::new(),
            index: Vec::new(),
            wanted: Vec::new(),
            links: Vec::new(),
            sent: Vec::new(),
            outboxes: Vec::new(),
            outlines: Vec::new(),
            scratch: Vec::new(),
            nodes_around: Vec::new(),
            contributors: Vec::new(),
            half,
            lightest: T::of(f64::MAX),
            masses,
            loads,
            loaded_area: 0.0,
            loading: Loading::default(),
            unloaded: None,
            mapped_at: 0.0,
            powers: Vec::new(),
            forces: Vec::new(),
            splitting,
            splitter: Splitter::default(),
            splits: SplitBook::default(),
            merges: MergeBook::default(),
            starts: Vec::new(),
            dummy: dummy.into(),
            wrap: Wrap::default(),
            resting: None,
        }
    }

    /// Make particles at `seeds`, with a velocity (m/s) and, if not virgin, a state by position (m).
    pub(super) fn seed(
        &mut self,
        seeds: &Seeds<D>,
        velocity: &Velocity<'_, D>,
        state: Option<&InitialState<'_, T, D>>,
    ) {
        let density = self.material.density();
        if state.is_none() && self.splitting.is_none() {
            self.share_mass(seeds.volumes.iter().map(|&volume| density * T::of(volume)));
        }
        self.shorten_numbers(seeds.positions.len());
        let mut index = BTreeMap::new();
        let mut numbers = self.dummy.to_vec();
        if self.loads.field.is_some() {
            self.starts.extend_from_slice(&seeds.positions);
        }
        for (n, (&x, &volume)) in seeds.positions.iter().zip(&seeds.volumes).enumerate() {
            let v = velocity(x);
            for d in 0..D {
                numbers[Columns::velocity(D) + d] = T::of(v[d]);
            }
            let mut mass = density * T::of(volume);
            if let Some(state) = state {
                let state = state(x);
                let said = self.material.describe_point(&state);
                numbers[Columns::state(D)..self.columns.domain()].copy_from_slice(&state);
                mass /= said.map_or(T::of(1.0), |said| said.volume_ratio);
            }
            let parts = self.splitting.map_or(1.0, Splitting::lightest);
            self.lightest = self.lightest.min(mass * T::of(parts));
            if let Masses::Each(row) = self.masses {
                numbers[row] = mass;
            }
            if let Some(traction) = &self.loads.traction {
                let area = traction.area(&x, &seeds.half_size);
                self.loaded_area += area;
                numbers[self.columns.load()] = T::of(area);
            }
            numbers[self.columns.number()] = T::of(n as f64);
            self.put(&mut index, &x, &mut numbers);
        }
        self.settle();
    }

    /// Where particles yet to come all have the same mass, let none carry it.
    fn share_mass(&mut self, mut masses: impl Iterator<Item = T>) {
        let Some(first) = masses.next() else { return };
        if masses.all(|mass| mass == first) {
            let mut dummy = self.dummy.to_vec();
            dummy.remove(self.columns.mass());
            self.dummy = dummy.into();
            self.columns = self.columns.clone().without_mass();
            self.masses = Masses::Equal(first);
        }
    }

    /// Keep the numbers of particles yet to come, none above `bound`, in 32 bits if that is enough: splitting makes
    /// larger ones.
    fn shorten_numbers(&mut self, bound: usize) {
        if self.splitting.is_none() && u32::try_from(bound).is_ok() {
            self.columns = self.columns.clone().with_short_number();
        }
    }

    /// Put a particle with these numbers at `x`, m.
    pub(super) fn put(&mut self, index: &mut BTreeMap<[i32; D], usize>, x: &[f64; D], numbers: &mut [T]) {
        let centre = self.bin_centre();
        let (mut block, mut bin, mut stride) = ([0; D], 0, 1);
        for d in 0..D {
            let u = (x[d] - self.lattice.origin()[d]) / self.lattice.spacing() - centre;
            let nearest = (u + 0.5).floor();
            let (b, place) = split(nearest as i32);
            block[d] = b;
            bin += place * stride;
            stride *= BLOCK;
            numbers[Columns::position() + d] = T::of(u - nearest);
        }
        let block = self.wrap.block(block);
        let slot = *index.entry(block).or_insert_with(|| {
            self.slots.push(self.empty_slot(block));
            self.slots.len() - 1
        });
        self.slots[slot].block.push(bin, numbers);
    }

    /// All particles are there.
    pub(super) fn settle(&mut self) {
        for slot in &mut self.slots {
            slot.block.pack();
        }
        self.slots.sort_by_key(|s| s.block.coordinates);
        self.link_slots();
    }

    /// Half edges of the domain of a particle with these numbers, m.
    pub(super) fn half_edges(&self, numbers: &[T]) -> [[f64; 3]; 3] {
        let h = self.lattice.spacing();
        let mut edges = [[0.0; 3]; 3];
        for d in 0..D {
            edges[d][d] = self.half[d].to_double() * h;
        }
        let facts = self.facts();
        if facts.total {
            let f = total::gradient::<T, D>(&numbers[self.columns.frame()..], facts.hoop);
            for (k, edge) in edges.iter_mut().enumerate().take(D) {
                let half = edge[k];
                for d in 0..D {
                    let x: T = f.0[d][k].into();
                    edge[d] = x.to_double() * half;
                }
            }
        } else if facts.domain.carried() {
            let (first, count) = self.columns.domains();
            let mut carried = [0.0; MOST_NUMBERS];
            for (x, number) in carried.iter_mut().zip(&numbers[first..first + count]) {
                *x = number.to_double() * h;
            }
            edges = facts.domain.half_edges::<f64, D>(&carried);
        }
        edges
    }

    /// Take the particles of a body of this law over.
    fn adopt(&mut self, body: &dyn GridBody<T, D>) {
        let h = self.lattice.spacing();
        let (mut masses, mut last) = (Vec::with_capacity(body.len()), 0);
        body.for_each(&mut |p| {
            masses.push(T::of(p.mass));
            last = last.max(p.number);
        });
        if self.splitting.is_none() {
            self.share_mass(masses.into_iter());
        }
        self.shorten_numbers(last);
        let mut index = BTreeMap::new();
        let mut numbers = self.dummy.to_vec();
        let (state, domain) = (Columns::state(D), self.columns.domain());
        body.for_each(&mut |p| {
            for d in 0..D {
                numbers[Columns::velocity(D) + d] = T::of(p.velocity[d]);
            }
            if let Masses::Each(row) = self.masses {
                numbers[row] = T::of(p.mass);
            }
            self.lightest = self.lightest.min(T::of(p.mass));
            for (number, x) in numbers[state..domain].iter_mut().zip(&p.state) {
                *number = T::of(*x);
            }
            let kind = self.facts().domain;
            let mut carried = kind.of_edges::<f64, D>(&p.half_edges.map(|e| e.map(|x| x / h)));
            if kind == Domain::Axes {
                // Within what the shape function bears.
                for x in &mut carried[..D] {
                    *x = self.kernels.shape().stretch(T::of(*x), T::default()).to_double();
                }
            }
            for (number, x) in numbers[domain..].iter_mut().zip(&carried[..kind.numbers(D)]) {
                *number = T::of(*x);
            }
            numbers[self.columns.number()] = T::of(p.number as f64);
            let x = std::array::from_fn(|d| p.position[d]);
            self.put(&mut index, &x, &mut numbers);
        });
        self.settle();
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Add a body of one law, its particles at `seeds` with an initial velocity (m/s) by position (m).
    ///
    /// # Errors
    /// No particles, particles larger than a cell, or outside the grid.
    pub fn add(
        &mut self,
        name: &str,
        law: impl IntoMaterial<T>,
        seeds: &Seeds<D>,
        velocity: impl Fn([f64; D]) -> [f64; D],
    ) -> Result<(), SceneError> {
        self.add_body(Deformable::new(name, law, seeds).moving(velocity))
    }

    /// Add a body of which more is to be said.
    ///
    /// # Errors
    /// As [`Mpm::add`]. With an initial state also one with a number that is not finite, or whose volume ratio is not positive. With
    /// splitting also particles that are not as long as they are wide, more of them than can be numbered, a law that does not keep the
    /// stretch, and a method in the reference configuration; with [`Merging`](super::Merging) also an affine transfer (APIC), domains
    /// that are not boxes (CPDI), a law whose states have no mean ([`Constitutive::merged`]), bodies in their reference configuration.
    pub fn add_body<L: IntoMaterial<T>>(&mut self, body: Deformable<'_, D, L, T>) -> Result<(), SceneError> {
        self.insert(body.prepared())
    }

    /// Add a rigid body, its particles at `seeds`. It meets others through the contact algorithm, which must keep
    /// bodies apart.
    ///
    /// # Errors
    /// As [`Mpm::add`]; a scene without contact; a motion that is not finite or that the coordinates do not have.
    pub fn add_rigid(&mut self, name: &str, rigid: &Rigid<D>, seeds: &Seeds<D>) -> Result<(), SceneError> {
        self.work.add_rigid(self, name, rigid, seeds)
    }

    pub(super) fn add_rigid_here(
        &mut self,
        name: &str,
        rigid: &Rigid<D>,
        seeds: &Seeds<D>,
    ) -> Result<(), SceneError> {
        if !self.contact.separates() {
            return Err(SceneError::NoContact("a rigid body"));
        }
        self.check_seeds(name, seeds)?;
        self.check_numbers(name, seeds, &|_| [0.0; D])?;
        if self.kinetic_damping.is_some() && !rigid.is_prescribed() {
            return Err(SceneError::RestOfFree(name.into()));
        }
        let body = RigidBody::<T, D>::new(name, rigid, self.kernels.clone(), *self.grid.lattice(), seeds)?;
        self.enter(name, Box::new(body))?;
        self.rigid.push(self.bodies.len() - 1);
        Ok(())
    }

    fn check_states(
        &self,
        name: &str,
        law: &dyn Material<T>,
        seeds: &Seeds<D>,
        state: &InitialState<'_, T, D>,
    ) -> Result<(), SceneError> {
        for (particle, &x) in seeds.positions.iter().enumerate() {
            let refuse = |field, value: T, allowed| {
                let value = value.to_double();
                Err(SceneError::Seed { body: name.into(), particle, field, value, allowed })
            };
            let state = state(x);
            for &number in &state {
                if !number.to_double().is_finite() {
                    return refuse("number of the initial state", number, "finite");
                }
            }
            let ratio = law.describe_point(&state).map_or(T::default(), |said| said.volume_ratio);
            if ratio <= T::default() {
                return refuse("volume ratio of the initial state", ratio, "positive");
            }
        }
        Ok(())
    }

    /// What splitting asks of a body.
    fn check_splitting(
        &self,
        name: &str,
        law: &dyn Material<T>,
        seeds: &Seeds<D>,
        splitting: Splitting,
    ) -> Result<Splitter<T>, SceneError> {
        self.check_frame("splitting", "particles mapped in the reference configuration never part")?;
        let body = || name.to_string();
        let Some(place) = law.stretch_place() else {
            return Err(SceneError::NoStretch { body: body(), law: law.name() });
        };
        let spacing = self.grid.lattice().spacing();
        for (axis, &half) in seeds.half_size.iter().enumerate() {
            if (half / seeds.half_size[0] - 1.0).abs() > 1e-9 {
                let [half, first] = [half, seeds.half_size[0]].map(|x| x / spacing);
                return Err(SceneError::Oblong { body: body(), axis, half, first });
            }
        }
        if splitting.merging().is_some() {
            self.check_merging(name, law)?;
        }
        let most = if size_of::<T>() == 4 { 1 << 24 } else { 1usize << 53 };
        let count = seeds.positions.len() << splitting.generations();
        if count > most {
            return Err(SceneError::TooMany { body: body(), count, most });
        }
        // Where particles merge, numbers are given as long as there are any.
        let generations = match splitting.merging() {
            Some(_) => (most / seeds.positions.len()).ilog2().min(Splitting::DEEPEST),
            None => splitting.generations(),
        };
        Ok(Splitter {
            on: true,
            place,
            square: T::of(splitting.stretch() * splitting.stretch()),
            generations: T::of(f64::from(generations)),
            finest: splitting.merging().map(|_| 2.0f64.powf(f64::from(splitting.generations()) - 0.5)),
            seeds: T::of(seeds.positions.len() as f64),
            half: T::of(seeds.half_size[0] / spacing),
            spacing: T::of(spacing),
            hoop: self.facts().hoop,
            ..Splitter::default()
        })
    }

    /// Refuse what a method in the reference configuration cannot do.
    pub(super) fn check_frame(&self, what: &str, why: &'static str) -> Result<(), SceneError> {
        if self.facts().total {
            let (what, method) = (what.into(), self.facts().description.clone());
            return Err(SceneError::NotWith { what, method, why });
        }
        Ok(())
    }

    pub(crate) fn insert(&mut self, body: Prepared<'_, T, D>) -> Result<(), SceneError> {
        self.work.insert(self, body)
    }

    pub(super) fn insert_here(&mut self, body: Prepared<'_, T, D>) -> Result<(), SceneError> {
        let Prepared { name, material, seeds, velocity, state, loads, splitting, kernels } = body;
        self.check_seeds(&name, seeds)?;
        self.check_numbers(&name, seeds, &*velocity)?;
        if let Some(state) = &state {
            self.check_states(&name, &*material, seeds, &**state)?;
        }
        let splitter = splitting
            .map(|splitting| self.check_splitting(&name, &*material, seeds, splitting))
            .transpose()?;
        let kernels = kernels.unwrap_or_else(|| self.kernels.clone());
        let (here, there) = (self.facts(), kernels.facts());
        // A step so short that no time constant is: what is taken is then its share, and not all, whatever the constant.
        let moment = T::of(1e-20);
        if here != there || kernels.taken(moment) != self.kernels.taken(moment) {
            let (there, here) = (there.description.clone(), here.description.clone());
            return Err(SceneError::OtherMethod { body: name, there, here });
        }
        let (lattice, more) = (*self.grid.lattice(), (loads, splitting));
        let mut body = ParticleBody::<T, D>::empty(&name, material, kernels, lattice, &seeds.half_size, more);
        body.wrap = self.wrap()?;
        if let Some(splitter) = splitter {
            let (domain, mass) = (body.columns.domains(), body.columns.mass());
            let area = body.loads.rows(body.columns.load()).area;
            body.splitter = Splitter { domain, mass, area, ..splitter };
        }
        body.seed(seeds, &*velocity, state.as_deref());
        self.enter(&name, Box::new(body))
    }

    pub(super) fn enter(&mut self, name: &str, body: Box<dyn GridBody<T, D>>) -> Result<(), SceneError> {
        self.check_name(name)?;
        self.bodies.push(body);
        self.mapped = false;
        self.looks.reopen();
        self.arrange().map_err(|outside| {
            self.bodies.pop();
            // As it was, which there is room for.
            let _ = self.arrange();
            SceneError::Outside(name.into(), outside)
        })
    }

    /// Errors, tables and observers tell bodies apart by their names.
    fn check_name(&self, name: &str) -> Result<(), SceneError> {
        let refuse = |allowed| Err(SceneError::Name { name: name.into(), allowed });
        if name.trim().is_empty() {
            return refuse("a word or more");
        }
        if self.bodies.iter().any(|b| b.name() == name) {
            return refuse("another one than those of the bodies in the scene");
        }
        Ok(())
    }

    pub(super) fn check_seeds(&self, name: &str, seeds: &Seeds<D>) -> Result<(), SceneError> {
        self.check_name(name)?;
        let body = name.to_string();
        self.check_method()?;
        let count = seeds.positions.len();
        let most = if size_of::<T>() == 4 { 1 << 24 } else { 1 << 53 };
        if count == 0 {
            return Err(SceneError::Empty(body));
        }
        if count > most {
            return Err(SceneError::TooMany { body, count, most });
        }
        self.check_half_sizes(name, &seeds.half_size)?;
        if self.facts().hoop
            && let Some(x) = seeds.positions.iter().find(|x| x[0] <= 0.0)
        {
            return Err(SceneError::BehindAxis { body, r: x[0] });
        }
        Ok(())
    }

    pub(super) fn check_half_sizes(&self, name: &str, half_size: &[f64; D]) -> Result<(), SceneError> {
        for axis in 0..D {
            let half = half_size[axis] / self.grid.lattice().spacing();
            let rounding = 1e-12f64.max(4.0 * T::default_epsilon().to_double());
            if !(half > 0.0 && half <= 0.5 + rounding) {
                return Err(SceneError::HalfSize { body: name.into(), axis, half });
            }
        }
        Ok(())
    }

    pub(super) fn check_numbers(
        &self,
        name: &str,
        seeds: &Seeds<D>,
        velocity: &Velocity<'_, D>,
    ) -> Result<(), SceneError> {
        let (positions, volumes) = (seeds.positions.len(), seeds.volumes.len());
        if positions != volumes {
            return Err(SceneError::Unequal { body: name.into(), positions, volumes });
        }
        let lattice = self.grid.lattice();
        for (particle, (x, &volume)) in seeds.positions.iter().zip(&seeds.volumes).enumerate() {
            let refuse = |field, value, allowed| {
                Err(SceneError::Seed { body: name.into(), particle, field, value, allowed })
            };
            if !(volume > 0.0 && volume.is_finite()) {
                return refuse("volume", volume, "positive and finite");
            }
            for d in 0..D {
                // Cells are counted by 32-bit integers, with room to move.
                let cells = (x[d] - lattice.origin()[d]) / lattice.spacing();
                let countable = cells.abs() < f64::from(1 << 30); // false for a value that is not a number
                if !countable {
                    return refuse("position", x[d], "finite and within 2^30 cells of the lattice's origin");
                }
            }
            let behind =
                self.conditions.boundaries.iter().find_map(|b| self.behind_symmetry(b, name, particle, x));
            behind.map_or(Ok(()), Err)?;
            for boundary in &self.conditions.boundaries {
                if let Boundary::Periodic { axis, low, high } = *boundary
                    && !(low..=high).contains(&x[axis])
                {
                    return refuse("position", x[axis], "between the periodic planes");
                }
            }
            if let Some(&v) = velocity(*x).iter().find(|v| !v.is_finite()) {
                return refuse("velocity", v, "finite");
            }
        }
        Ok(())
    }

    /// Add a body as it stands in another scene, of another method, grid or contact algorithm: with the positions,
    /// velocities, masses, domains, states and numbers of its particles, and so with all its momentum and energy. `law` must be
    /// the law that it has there. Its loads stay behind.
    ///
    /// So a body goes on in the current configuration ([`crate::UpdatedLagrangian`]) that was mapped in the reference one as
    /// long as it neither broke nor met another:
    ///
    /// ```
    /// # use mpm_core::{BlockGrid, Flip, Linear, Method, Mpm, Musl, PlaneStrain, geometry::*};
    /// # use mpm_core::{CpGimp, Usl};
    /// # use mpm_materials::{LinearElastic, Moduli};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let lattice = Lattice::new([0.0; 2], 0.25)?;
    /// # let seeds = fill(&Cuboid::new([0.0; 2], [1.0, 1.0])?, &lattice, 2, &Filling::new())?;
    /// # let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.3)?)?;
    /// let reference = Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian();
    /// let mut early = Mpm::new(reference, BlockGrid::new(lattice));
    /// early.add("strip", law, &seeds, |x| [0.2 * x[0], 0.0])?;
    /// // Until a particle is half as long again as at the start.
    /// let longest = |mpm: &Mpm<2>| {
    ///     let mut half = 0.0f64;
    ///     mpm.bodies()[0].for_each(&mut |p| half = half.max(p.half_edges[0][0]));
    ///     half / seeds.half_size[0]
    /// };
    /// while longest(&early) < 1.5 && !early.reached(2.0) {
    ///     early.step_towards(2.0)?;
    /// }
    /// let mut late = Mpm::new(Method::new(CpGimp, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    /// late.take_over(law, &*early.bodies()[0])?;
    /// late.set_time(early.time())?;
    /// late.run_until(3.0)?;
    /// # assert_eq!(late.totals().particles, 64);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// Domains along the axes (cpGIMP) begin as long as the edges of the one taken over, taken together; parallelograms (CPDI) are that;
    /// corners (CPDI-2) those of the parallelogram, which those of neighbours meet only where both deformed alike. Splitting stays behind
    /// as loads do, and velocities that vary within particles (APIC) begin anew.
    ///
    /// # Errors
    /// A method in the reference configuration, since that would be another one; another law; other coordinates (plane, of
    /// revolution); particles that were larger at the start than a cell of this grid, that are outside it or behind the axis.
    pub fn take_over(
        &mut self,
        law: impl IntoMaterial<T>,
        body: &dyn GridBody<T, D>,
    ) -> Result<(), SceneError> {
        self.work.adopt(self, law.into_material(), body)
    }

    pub(super) fn adopt_here(
        &mut self,
        law: Arc<dyn Material<T>>,
        body: &dyn GridBody<T, D>,
    ) -> Result<(), SceneError> {
        self.check_method()?;
        self.check_frame("taking a body over", "its reference configuration would be another one")?;
        let name = body.name();
        let here = self.facts().embedding;
        if body.embedding() != here {
            return Err(SceneError::OtherSpace { body: name.into(), there: body.embedding(), here });
        }
        let states = law.state_names();
        if body.law() != law.name() || body.state_names() != states {
            return Err(SceneError::OtherLaw {
                body: name.into(),
                there: format!("{} ({})", body.law(), body.state_names().join(", ")),
                here: format!("{} ({})", law.name(), states.join(", ")),
            });
        }
        self.check_half_sizes(name, &body.half_size())?;
        let lattice = *self.grid.lattice();
        let (kernels, none) = (self.kernels.clone(), (Loads::default(), None));
        let mut taken = ParticleBody::<T, D>::empty(name, law, kernels, lattice, &body.half_size(), none);
        taken.wrap = self.wrap()?;
        let mut behind = None;
        body.for_each(&mut |p| {
            let x = std::array::from_fn(|d| p.position[d]);
            let all = &self.conditions.boundaries;
            let found = || all.iter().find_map(|b| self.behind_symmetry(b, name, p.number, &x));
            behind = behind.take().or_else(found);
        });
        behind.map_or(Ok(()), Err)?;
        taken.adopt(body);
        self.enter(name, Box::new(taken))
    }

    /// Let the clock of a scene that made no step stand at `time`, s: when it takes over bodies of a run.
    ///
    /// # Errors
    /// A time that is not finite, or steps made.
    pub fn set_time(&mut self, time: f64) -> Result<(), SceneError> {
        if !time.is_finite() || self.clock.steps > 0 {
            return Err(SceneError::Clock { time, steps: self.clock.steps });
        }
        self.clock.time = time;
        self.mapped = false;
        Ok(())
    }
}

/// Does a virgin point of the law resist being drawn out along one axis by a small strain, with shear and with tension?
fn bears_shear_and_tension<T: Float>(law: &dyn Material<T>) -> bool {
    let row = |x: T| {
        let mut row = T::Row::default();
        row.as_mut().fill(x);
        row
    };
    let strain = T::of(1e-6);
    let mut rows: Vec<T::Row> = law.virgin().into_iter().map(row).collect();
    let mut deformation = [Deformation::default()];
    deformation[0].gradient[0].0[0] = row(T::of(1.0));
    deformation[0].step.0[0] = row(strain);
    let motion = Motion { deformation: &deformation, dt: strain, length: Length::Same(T::of(1.0)) };
    let mut response = Response::default();
    let states = StatesMut { all: &mut rows, stride: law.numbers(), first: 0, groups: &[0] };
    law.advance(&motion, states, false, &mut response);
    let Some(output) = response.outputs().first() else { return false };
    let [along, across] = [0, 1].map(|n| output.stress[n].0[0].as_ref()[0].to_double());
    response.faults().is_empty() && along + 2.0 * across > 0.0 && along - across > 1e-3 * along.abs()
}
