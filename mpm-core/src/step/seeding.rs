//! How a body gets its particles: from seeds, or from a body of another scene.

use std::collections::BTreeMap;

use mpm_materials::{Constitutive, State};

use super::body::Body;
use super::contact::Contact;
use super::load::{Load, Loading, Unloaded};
use super::merging::MergeBook;
use super::particle_body::ParticleBody;
use super::rigid::Rigid;
use super::rigid_body::RigidBody;
use super::scene::SceneError;
use super::solver::Mpm;
use super::splitting::{SplitBook, Splitter, Splitting};
use super::sweep::ExtentOf;
use super::total;
use crate::dim::BLOCK;
use crate::embedding::Embedding;
use crate::frame::Frame;
use crate::geometry::{Lattice, Seeds};
use crate::grid::GridStorage;
use crate::method::Composition;
use crate::parallel::Float;
use crate::particles::{Columns, Masses, split};
use crate::shape::domain::MOST_NUMBERS;
use crate::shape::{Domain, ShapeFunction, bin_centre};

/// A law's state by position, m.
pub(super) type InitialState<'a, T, const D: usize, C> =
    dyn Fn([f64; D]) -> <C as Constitutive<T>>::State<<T as mpm_materials::Real>::Single> + 'a;

impl<T, const D: usize, C, M, L> ParticleBody<T, D, C, M, L>
where
    T: Float,
    C: Constitutive<T>,
    M: Composition<T, D>,
    L: Load<D>,
{
    /// What of its domain a particle carries.
    const DOMAIN: Domain = <M::Shape as ShapeFunction<T, D>>::DOMAIN;
    /// Numbers a particle carries for a load.
    const LOADS: usize = if L::FIELD {
        D
    } else if L::ACTS {
        1
    } else {
        0
    };

    /// A body of particles of these half sizes, m, without them.
    pub fn empty(name: &str, law: C, method: M, lattice: Lattice<D>, half_size: &[f64; D], load: L) -> Self {
        let mut names = Vec::new();
        C::State::<T::Single>::names("state", &mut names);
        let (loads, frame) = (Self::LOADS, total::rows::<T, D, M>());
        let columns = Columns::new(D, names, Self::DOMAIN.numbers(D), loads, frame);
        let virgin: Vec<T> =
            mpm_materials::point::flatten(&law.virgin()).into_iter().map(|x: T::Single| x.into()).collect();
        let mut half = [T::of(0.5); 3];
        for d in 0..D {
            half[d] = T::of(half_size[d] / lattice.spacing());
        }
        // What a lane without a particle holds.
        let mut dummy = vec![T::default(); Columns::state(D)];
        dummy.extend_from_slice(&virgin);
        let domain = Self::DOMAIN.of_box::<T::Single, D>(half.map(T::Single::from));
        dummy.extend(domain[..Self::DOMAIN.numbers(D)].iter().map(|&x| -> T { x.into() }));
        dummy.resize(dummy.len() + loads, T::default());
        dummy.extend(total::undeformed::<T, D, M>());
        dummy.resize(columns.count(), T::default());
        let masses = Masses::Each(columns.mass());
        ParticleBody {
            name: name.into(),
            law,
            method,
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
            load,
            loaded_area: 0.0,
            loading: Loading::default(),
            splitter: Splitter::default(),
            splits: SplitBook::default(),
            merges: MergeBook::default(),
            starts: Vec::new(),
            dummy: dummy.into(),
            resting: None,
        }
    }

    /// Make particles at `seeds`, with a velocity (m/s) and, if not virgin, a state by position (m).
    pub fn seed(
        &mut self,
        seeds: &Seeds<D>,
        velocity: impl Fn([f64; D]) -> [f64; D],
        state: Option<&InitialState<'_, T, D, C>>,
    ) {
        let density = self.law.density();
        if state.is_none() && self.load.splitting().is_none() {
            self.share_mass(seeds.volumes.iter().map(|&volume| density * T::of(volume)));
        }
        self.shorten_numbers(seeds.positions.len());
        let mut index = BTreeMap::new();
        let mut numbers = self.dummy.to_vec();
        if L::FIELD {
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
                let first = Columns::state(D);
                for (number, x) in numbers[first..].iter_mut().zip(mpm_materials::point::flatten(&state)) {
                    let x: T::Single = x;
                    *number = x.into();
                }
                let ratio: T = self.law.volume_ratio(&state).into();
                mass /= ratio;
            }
            let parts = self.load.splitting().map_or(1.0, Splitting::lightest);
            self.lightest = self.lightest.min(mass * T::of(parts));
            if let Masses::Each(row) = self.masses {
                numbers[row] = mass;
            }
            if L::ACTS {
                let area = self.load.area(&x, &seeds.half_size);
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
        if self.load.splitting().is_none() && u32::try_from(bound).is_ok() {
            self.columns = self.columns.clone().with_short_number();
        }
    }

    /// Put a particle with these numbers at `x`, m.
    pub(super) fn put(&mut self, index: &mut BTreeMap<[i32; D], usize>, x: &[f64; D], numbers: &mut [T]) {
        let centre = bin_centre::<ExtentOf<M, T, D>>();
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
        if M::Frame::TOTAL {
            let f = total::gradient::<T, D, M>(&numbers[self.columns.frame()..]);
            for (k, edge) in edges.iter_mut().enumerate().take(D) {
                let half = edge[k];
                for d in 0..D {
                    let x: T = f.0[d][k].into();
                    edge[d] = x.to_double() * half;
                }
            }
        } else if Self::DOMAIN.carried() {
            let (first, count) = self.columns.domains();
            let mut carried = [0.0; MOST_NUMBERS];
            for (x, number) in carried.iter_mut().zip(&numbers[first..first + count]) {
                *x = number.to_double() * h;
            }
            edges = Self::DOMAIN.half_edges::<f64, D>(&carried);
        }
        edges
    }

    /// Take the particles of a body of this law over.
    fn adopt(&mut self, body: &dyn Body<T, D>) {
        let h = self.lattice.spacing();
        let (mut masses, mut last) = (Vec::with_capacity(body.len()), 0);
        body.for_each(&mut |p| {
            masses.push(T::of(p.mass));
            last = last.max(p.number);
        });
        if self.load.splitting().is_none() {
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
            let mut carried = Self::DOMAIN.of_edges::<f64, D>(&p.half_edges.map(|e| e.map(|x| x / h)));
            if Self::DOMAIN == Domain::Axes {
                // Within what the shape function bears.
                for x in &mut carried[..D] {
                    let kept: T = self
                        .method
                        .shape()
                        .stretch(T::Single::from(T::of(*x)), T::Single::from(T::default()))
                        .into();
                    *x = kept.to_double();
                }
            }
            for (number, x) in numbers[domain..].iter_mut().zip(&carried[..Self::DOMAIN.numbers(D)]) {
                *number = T::of(*x);
            }
            numbers[self.columns.number()] = T::of(p.number as f64);
            let x = std::array::from_fn(|d| p.position[d]);
            self.put(&mut index, &x, &mut numbers);
        });
        self.settle();
    }
}

impl<T, const D: usize, M, G, K> Mpm<T, D, M, G, K>
where
    T: Float,
    M: Composition<T, D>,
    G: GridStorage<T, D>,
    K: Contact<T, D>,
{
    /// Add a body of one law, its particles at `seeds` with an initial velocity (m/s) by position (m).
    ///
    /// # Errors
    /// No particles, particles larger than a cell, or outside the grid.
    pub fn add<C: Constitutive<T>>(
        &mut self,
        name: &str,
        law: C,
        seeds: &Seeds<D>,
        velocity: impl Fn([f64; D]) -> [f64; D],
    ) -> Result<(), SceneError> {
        self.add_loaded(name, law, seeds, velocity, Unloaded)
    }

    /// Add a body as [`Mpm::add`] does, with a surface load such as a [`super::Traction`].
    ///
    /// # Errors
    /// As [`Mpm::add`].
    pub fn add_loaded<C: Constitutive<T>, L: Load<D>>(
        &mut self,
        name: &str,
        law: C,
        seeds: &Seeds<D>,
        velocity: impl Fn([f64; D]) -> [f64; D],
        load: L,
    ) -> Result<(), SceneError> {
        self.insert(name, law, seeds, velocity, load, None)
    }

    /// Add a body as [`Mpm::add`] does, its points in the law's `state` by position (m) instead of virgin: stressed
    /// by their own weight, or to be lit when a detonation wave arrives. A seed's volume is that of the state.
    ///
    /// # Errors
    /// As [`Mpm::add`]; a state with a number that is not finite, or whose volume ratio is not positive.
    pub fn add_in_state<C: Constitutive<T>>(
        &mut self,
        name: &str,
        law: C,
        seeds: &Seeds<D>,
        velocity: impl Fn([f64; D]) -> [f64; D],
        state: impl Fn([f64; D]) -> C::State<T::Single>,
    ) -> Result<(), SceneError> {
        self.check_states(name, &law, seeds, &state)?;
        self.insert(name, law, seeds, velocity, Unloaded, Some(&state))
    }

    /// Add a rigid body, its particles at `seeds`. It meets others through the contact algorithm, which must keep
    /// bodies apart.
    ///
    /// # Errors
    /// As [`Mpm::add`]; a motion that is not finite or that the coordinates do not have.
    pub fn add_rigid(&mut self, name: &str, rigid: &Rigid<D>, seeds: &Seeds<D>) -> Result<(), SceneError> {
        const { assert!(K::SEPARATES, "a rigid body needs a contact algorithm: `Mpm::with_contact`") };
        self.check_seeds(name, seeds)?;
        self.check_numbers(name, seeds, |_| [0.0; D])?;
        if self.calm.is_some() && !rigid.is_prescribed() {
            return Err(SceneError::RestOfFree(name.into()));
        }
        let body = RigidBody::<T, D, M>::new(name, rigid, self.method, *self.grid.lattice(), seeds)?;
        self.enter(name, Box::new(body))?;
        self.rigid.push(self.bodies.len() - 1);
        Ok(())
    }

    pub(super) fn check_states<C: Constitutive<T>>(
        &self,
        name: &str,
        law: &C,
        seeds: &Seeds<D>,
        state: impl Fn([f64; D]) -> C::State<T::Single>,
    ) -> Result<(), SceneError> {
        for (particle, &x) in seeds.positions.iter().enumerate() {
            let refuse = |field, value: T, allowed| {
                let value = value.to_double();
                Err(SceneError::Seed { body: name.into(), particle, field, value, allowed })
            };
            let state = state(x);
            for number in mpm_materials::point::flatten::<T::Single, _>(&state) {
                let number: T = number.into();
                if !number.to_double().is_finite() {
                    return refuse("number of the initial state", number, "finite");
                }
            }
            let ratio: T = law.volume_ratio(&state).into();
            if ratio <= T::default() {
                return refuse("volume ratio of the initial state", ratio, "positive");
            }
        }
        Ok(())
    }

    fn insert<C: Constitutive<T>, L: Load<D>>(
        &mut self,
        name: &str,
        law: C,
        seeds: &Seeds<D>,
        velocity: impl Fn([f64; D]) -> [f64; D],
        load: L,
        state: Option<&InitialState<'_, T, D, C>>,
    ) -> Result<(), SceneError> {
        self.check_seeds(name, seeds)?;
        self.check_numbers(name, seeds, &velocity)?;
        let lattice = *self.grid.lattice();
        let mut body =
            ParticleBody::<T, D, C, M, L>::empty(name, law, self.method, lattice, &seeds.half_size, load);
        body.seed(seeds, velocity, state);
        self.enter(name, Box::new(body))
    }

    pub(super) fn enter(&mut self, name: &str, body: Box<dyn Body<T, D>>) -> Result<(), SceneError> {
        self.bodies.push(body);
        self.mapped = false;
        self.arrange().map_err(|outside| {
            self.bodies.pop();
            // As it was, which there is room for.
            let _ = self.arrange();
            SceneError::Outside(name.into(), outside)
        })
    }

    pub(super) fn check_seeds(&self, name: &str, seeds: &Seeds<D>) -> Result<(), SceneError> {
        let body = name.to_string();
        let count = seeds.positions.len();
        let most = if size_of::<T>() == 4 { 1 << 24 } else { 1 << 53 };
        if count == 0 {
            return Err(SceneError::Empty(body));
        }
        if count > most {
            return Err(SceneError::TooMany { body, count, most });
        }
        self.check_half_sizes(name, &seeds.half_size)?;
        if <M::Embedding as crate::Embedding<D>>::HOOP
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
        velocity: impl Fn([f64; D]) -> [f64; D],
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
    /// let mut early = Mpm::<f64, 2, _, _>::new(reference, BlockGrid::new(lattice));
    /// early.add("strip", law, &seeds, |x| [0.2 * x[0], 0.0])?;
    /// // Until a particle is half as long again as at the start.
    /// let longest = |mpm: &Mpm<f64, 2, _, _>| {
    ///     let mut half = 0.0f64;
    ///     mpm.bodies()[0].for_each(&mut |p| half = half.max(p.half_edges[0][0]));
    ///     half / seeds.half_size[0]
    /// };
    /// while longest(&early) < 1.5 && !early.reached(2.0) {
    ///     early.step_towards(2.0)?;
    /// }
    /// let mut late = Mpm::<f64, 2, _, _>::new(Method::new(CpGimp, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
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
    /// as loads do, and velocities that vary within particles (APIC) begin anew. A method in the reference configuration takes nothing
    /// over, since that would be another one:
    ///
    /// ```compile_fail
    /// # use mpm_core::{BlockGrid, Flip, Linear, Method, Mpm, Musl, PlaneStrain, geometry::*};
    /// # use mpm_materials::{LinearElastic, Moduli};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let lattice = Lattice::new([0.0; 2], 0.25)?;
    /// # let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.3)?)?;
    /// let reference = Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian();
    /// let mut mpm = Mpm::<f64, 2, _, _>::new(reference, BlockGrid::new(lattice));
    /// # let other = Mpm::<f64, 2, _, _>::new(reference, BlockGrid::new(lattice));
    /// mpm.take_over(law, &*other.bodies()[0])?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Another law; other coordinates (plane, of revolution); particles that were larger at the start than a cell of this grid, that are
    /// outside it or behind the axis.
    pub fn take_over<C: Constitutive<T>>(&mut self, law: C, body: &dyn Body<T, D>) -> Result<(), SceneError> {
        const { assert!(!M::Frame::TOTAL, "a method in the reference configuration takes nothing over") };
        let name = body.name();
        let here = <M::Embedding as Embedding<D>>::NAME;
        if body.embedding() != here {
            return Err(SceneError::OtherSpace { body: name.into(), there: body.embedding(), here });
        }
        let mut states = Vec::new();
        C::State::<T::Single>::names("state", &mut states);
        if body.law() != law.name() || body.state_names() != states {
            return Err(SceneError::OtherLaw {
                body: name.into(),
                there: format!("{} ({})", body.law(), body.state_names().join(", ")),
                here: format!("{} ({})", law.name(), states.join(", ")),
            });
        }
        self.check_half_sizes(name, &body.half_size())?;
        let lattice = *self.grid.lattice();
        let mut taken =
            ParticleBody::<T, D, C, M>::empty(name, law, self.method, lattice, &body.half_size(), Unloaded);
        taken.adopt(body);
        self.enter(name, Box::new(taken))
    }

    /// Let the clock of a scene that made no step stand at `time`, s: when it takes over bodies of a run.
    ///
    /// # Errors
    /// A time that is not finite, or steps made.
    pub fn set_time(&mut self, time: f64) -> Result<(), SceneError> {
        if !time.is_finite() || self.steps > 0 {
            return Err(SceneError::Clock { time, steps: self.steps });
        }
        self.time = time;
        self.mapped = false;
        Ok(())
    }
}
