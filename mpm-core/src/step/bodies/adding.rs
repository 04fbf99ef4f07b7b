//! Addition of bodies to a scene.

use std::sync::Arc;

use mpm_materials::{IntoMaterial, Material};

use super::body::GridBody;
use super::deformable::{Deformable, InitialState, Prepared, Velocity};
use super::densities::volume_place;
use super::load::Loads;
use super::particle_body::ParticleBody;
use crate::step::between_steps::splitting::{Splitter, Splitting};
use crate::step::mpm::Mpm;
use crate::step::rigid::motion::{Rigid, RigidState};
use crate::step::rigid::proxies::RigidBody;
use impactite_geometry::Seeds;
use impactite_scene::Boundary;
use impactite_scene::error::SceneError;
use impactite_simd::Float;

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Add a body of one law with particles at `seeds` and an initial velocity (m/s) as a function of position (m).
    ///
    /// # Errors
    /// No particles; particles larger than a cell, or outside the grid.
    pub fn add(
        &mut self,
        name: &str,
        law: impl IntoMaterial<T>,
        seeds: &Seeds<D>,
        velocity: impl Fn([f64; D]) -> [f64; D],
    ) -> Result<(), SceneError> {
        self.add_body(Deformable::new(name, law, seeds).moving(velocity))
    }

    /// Add a body with its initial state, loads and splitting ([`Deformable`]).
    ///
    /// # Errors
    /// Errors of [`Mpm::add`]. With an initial state: a value that is not finite, or a volume ratio that is not
    /// positive. With splitting: particles with unequal lengths along the axes, more particles than can be numbered,
    /// a law that does not store the stretch, and a method in the reference configuration. With
    /// [`Merging`](crate::step::Merging) also: an affine transfer (APIC), domains that are not boxes (CPDI), a law
    /// without mean states ([`Constitutive::merged`](mpm_materials::Constitutive::merged)), bodies in their reference
    /// configuration.
    pub fn add_body<L: IntoMaterial<T>>(&mut self, body: Deformable<'_, D, L, T>) -> Result<(), SceneError> {
        self.insert(body.prepared())
    }

    /// Add bodies by `add`, and arrange node blocks once for all of them. The work is that of the bodies, whereas
    /// each single addition also arranges the blocks of all earlier bodies.
    ///
    /// ```
    /// # use mpm_core::{BlockGrid, Flip, Linear, Method, Mpm, Musl, PlaneStrain, geometry::*};
    /// # use mpm_materials::{LinearElastic, Moduli};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let lattice = Lattice::new([0.0; 2], 0.25)?;
    /// # let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.3)?)?;
    /// let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    /// mpm.add_together(|mpm| {
    ///     (0..100).try_for_each(|n| {
    ///         let disc = Ball::new([f64::from(n), 0.0], 0.5)?;
    ///         let seeds = fill(&disc, &lattice, 2, &Filling::new())?;
    ///         mpm.add(&format!("disc {n}"), law, &seeds, |_| [0.0; 2])?;
    ///         Ok::<_, Box<dyn std::error::Error>>(())
    ///     })
    /// })?;
    /// # assert_eq!(mpm.bodies().len(), 100);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Errors of `add`; a body outside the grid. The scene must not be used afterwards.
    pub fn add_together<X, E: From<SceneError>>(
        &mut self,
        add: impl FnOnce(&mut Self) -> Result<X, E>,
    ) -> Result<X, E> {
        if self.together.is_some() {
            return add(self);
        }
        self.together = Some(self.scene.bodies.iter().map(|body| body.name().to_string()).collect());
        let added = add(self);
        self.together = None;
        let added = added?;
        self.arrange_together()?;
        Ok(added)
    }

    /// Arrange the node blocks of all bodies, or name the first one that is outside the grid.
    fn arrange_together(&mut self) -> Result<(), SceneError> {
        let Err(mut outside) = self.arrange() else { return Ok(()) };
        let mut bodies = std::mem::take(&mut self.scene.bodies);
        // Bisection: the first `inside` bodies fit on the grid, the first `not` do not.
        let (mut inside, mut not) = (0, bodies.len());
        while not - inside > 1 {
            let middle = inside + (not - inside) / 2;
            let rest = bodies.split_off(middle);
            self.scene.bodies = bodies;
            let arranged = self.arrange();
            bodies = std::mem::take(&mut self.scene.bodies);
            bodies.extend(rest);
            match arranged {
                Ok(()) => inside = middle,
                Err(error) => (not, outside) = (middle, error),
            }
        }
        self.scene.bodies = bodies;
        let name = self.scene.bodies.get(inside).map_or(String::new(), |body| body.name().into());
        Err(SceneError::Outside(name, outside))
    }

    /// Add a rigid body with particles at `seeds`. It interacts with other bodies through the contact algorithm,
    /// which must separate bodies.
    ///
    /// # Errors
    /// Errors of [`Mpm::add`]; a scene without contact; a motion that is not finite or not available in these coordinates.
    pub fn add_rigid(&mut self, name: &str, rigid: &Rigid<D>, seeds: &Seeds<D>) -> Result<(), SceneError> {
        self.work.add_rigid(self, name, rigid, seeds)
    }

    pub(in crate::step) fn add_rigid_here(
        &mut self,
        name: &str,
        rigid: &Rigid<D>,
        seeds: &Seeds<D>,
    ) -> Result<(), SceneError> {
        if !self.scene.contact.separates() {
            return Err(SceneError::NoContact("a rigid body"));
        }
        self.check_seeds(name, seeds)?;
        self.check_numbers(name, seeds, &|_| [0.0; D])?;
        if self.between_steps.kinetic_damping.is_some() && !rigid.is_prescribed() {
            return Err(SceneError::RestOfFree(name.into()));
        }
        let body = {
            let cells = (*self.grid.lattice(), self.grid.fields.levels());
            RigidBody::<T, D>::new(name, rigid, self.kernels.clone(), cells, seeds)?
        };
        self.check_rigid_levels(body.rigid().is_some_and(RigidState::is_prescribed))?;
        // Registered as rigid first: the arrangement of nodes at planes depends on it.
        self.scene.rigid.push(self.scene.bodies.len());
        let entered = self.enter(name, Box::new(body));
        if entered.is_err() {
            self.scene.rigid.pop();
        } else {
            self.halve_rigid();
        }
        entered
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

    /// Check the requirements of splitting for a body, and return its parameters.
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
        // With merging, particles are cut as long as there are unused numbers.
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

    /// Refuse a feature that is not available in the reference configuration.
    pub(in crate::step) fn check_frame(&self, what: &str, why: &'static str) -> Result<(), SceneError> {
        if self.facts().total {
            let (what, method) = (what.into(), self.facts().description.clone());
            return Err(SceneError::NotWith { what, method, why });
        }
        Ok(())
    }

    pub(crate) fn insert(&mut self, body: Prepared<'_, T, D>) -> Result<(), SceneError> {
        self.work.insert(self, body)
    }

    pub(in crate::step) fn insert_here(&mut self, body: Prepared<'_, T, D>) -> Result<(), SceneError> {
        let Prepared { name, material, seeds, velocity, state, loads, splitting, renewed, kernels } = body;
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
        // In a step shorter than any time constant the PIC fraction depends on that constant; in longer ones it may be 1 for all.
        let moment = T::of(1e-20);
        if here != there || kernels.taken(moment) != self.kernels.taken(moment) {
            let (there, here) = (there.description.clone(), here.description.clone());
            return Err(SceneError::OtherMethod { body: name, there, here });
        }
        if renewed {
            self.check_renewed(&name, volume_place(&*material))?;
        }
        if splitting.is_some() {
            self.check_levels("splitting of stretched particles")?;
        }
        if renewed {
            self.check_levels("a renewed density")?;
        }
        let (lattice, more) = (*self.grid.lattice(), (loads, splitting));
        let mut body = ParticleBody::<T, D>::empty(&name, material, kernels, lattice, &seeds.half_size, more);
        if renewed {
            let virgin = body.material.virgin();
            body.renewed = body.material.describe_point(&virgin).map(|said| said.wave_speed.to_double());
        }
        body.wrap = self.wrap()?;
        body.lattices = self.grid.fields.lattices();
        body.levels = self.grid.fields.levels().cloned();
        if let Some(splitter) = splitter {
            let (domain, mass) = (body.columns.domains(), body.columns.mass());
            let areas = body.loads.rows(body.columns.load()).areas;
            body.splitter = Splitter { domain, mass, areas, ..splitter };
        }
        body.seed(seeds, &*velocity, state.as_deref());
        self.enter(&name, Box::new(body))
    }

    pub(in crate::step) fn enter(
        &mut self,
        name: &str,
        body: Box<dyn GridBody<T, D>>,
    ) -> Result<(), SceneError> {
        self.check_name(name)?;
        self.scene.bodies.push(body);
        self.stepper.mapped = false;
        self.looks.reopen();
        if let Some(names) = &mut self.together {
            names.insert(name.into());
            return Ok(());
        }
        self.arrange().map_err(|outside| {
            self.scene.bodies.pop();
            // Restore the former arrangement, for which the grid has space.
            let _ = self.arrange();
            SceneError::Outside(name.into(), outside)
        })
    }

    /// Check that the name is not empty and unique: errors, tables and observers identify bodies by name.
    pub(in crate::step) fn check_name(&self, name: &str) -> Result<(), SceneError> {
        let refuse = |allowed| Err(SceneError::Name { name: name.into(), allowed });
        if name.trim().is_empty() {
            return refuse("a word or more");
        }
        let taken = match &self.together {
            Some(names) => names.contains(name),
            None => self.scene.bodies.iter().any(|b| b.name() == name),
        };
        if taken {
            return refuse("another one than those of the bodies in the scene");
        }
        Ok(())
    }

    pub(in crate::step) fn check_seeds(&self, name: &str, seeds: &Seeds<D>) -> Result<(), SceneError> {
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

    pub(in crate::step) fn check_half_sizes(
        &self,
        name: &str,
        half_size: &[f64; D],
    ) -> Result<(), SceneError> {
        for axis in 0..D {
            let half = half_size[axis] / self.grid.lattice().spacing();
            let rounding = 1e-12f64.max(4.0 * T::default_epsilon().to_double());
            if !(half > 0.0 && half <= 0.5 + rounding) {
                return Err(SceneError::HalfSize { body: name.into(), axis, half });
            }
        }
        Ok(())
    }

    pub(in crate::step) fn check_numbers(
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
        let finest = lattice.spacing() / self.all_cell_sizes().last().copied().unwrap_or(1.0);
        let leveled = self.grid.fields.levels().is_some();
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
                if leveled && cells.abs() * finest > f64::from(1 << 26) {
                    let allowed = "within 2^26 of the smallest cells of the lattice's origin";
                    return refuse("position", x[d], allowed);
                }
            }
            let behind = self
                .scene
                .conditions
                .boundaries
                .iter()
                .find_map(|b| self.behind_symmetry(b, name, particle, x));
            behind.map_or(Ok(()), Err)?;
            for boundary in &self.scene.conditions.boundaries {
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

    /// Add a body in its present state in another scene of another method, grid or contact algorithm: positions,
    /// velocities, masses, domains, states and numbers of its particles are copied, and with them all its momentum
    /// and energy. `law` must be its law in that scene. Loads are not copied.
    ///
    /// A body that was mapped in the reference configuration can thus continue in the current one
    /// ([`crate::UpdatedLagrangian`]) when it breaks or comes into contact with another:
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
    /// Domains along the axes (cpGIMP) start with the root sum of squares of the copied edges along each axis;
    /// parallelograms (CPDI) are copied; corners (CPDI-2) are those of the parallelogram, which coincide with those
    /// of neighbours only where both deformed alike. Splitting and loads are not copied, and velocity variations
    /// within particles (APIC) start from zero.
    ///
    /// # Errors
    /// A method in the reference configuration, which would be a different one; another law; other coordinates
    /// (plane, axisymmetric); particles that were larger at the start than a cell of this grid, or are outside it or
    /// behind the axis.
    pub fn take_over(
        &mut self,
        law: impl IntoMaterial<T>,
        body: &dyn GridBody<T, D>,
    ) -> Result<(), SceneError> {
        self.work.adopt(self, law.into_material(), body)
    }

    pub(in crate::step) fn adopt_here(
        &mut self,
        law: Arc<dyn Material<T>>,
        body: &dyn GridBody<T, D>,
    ) -> Result<(), SceneError> {
        self.check_method()?;
        self.check_frame("taking a body over", "its reference configuration would be another one")?;
        self.check_levels("a body of another scene")?;
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
            let all = &self.scene.conditions.boundaries;
            let found = || all.iter().find_map(|b| self.behind_symmetry(b, name, p.number, &x));
            behind = behind.take().or_else(found);
        });
        behind.map_or(Ok(()), Err)?;
        taken.adopt(body);
        self.enter(name, Box::new(taken))
    }

    /// Set the clock of a scene without steps to `time`, s: for a scene that takes over bodies of a run.
    ///
    /// # Errors
    /// A time that is not finite; a scene that made steps.
    pub fn set_time(&mut self, time: f64) -> Result<(), SceneError> {
        if !time.is_finite() || self.clock.steps > 0 {
            return Err(SceneError::Clock { time, steps: self.clock.steps });
        }
        self.clock.time = time;
        self.stepper.mapped = false;
        Ok(())
    }
}
