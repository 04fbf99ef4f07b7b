//! Description of a deformable body for a scene.

use std::sync::Arc;

use mpm_materials::point::flatten;
use mpm_materials::{Constitutive, IntoMaterial, Material, MaySplit};

use super::load::{FieldForce, Loads, Traction};
use crate::step::between_steps::splitting::Splitting;
use crate::step::passes::kernels::MethodKernels;
use impactite_geometry::Seeds;
use impactite_simd::Float;

/// Velocity as a function of position, m/s and m.
pub(in crate::step) type Velocity<'a, const D: usize> = dyn Fn([f64; D]) -> [f64; D] + 'a;

/// State variables of a law as a function of position, m.
pub(in crate::step) type InitialState<'a, T, const D: usize> = dyn Fn([f64; D]) -> Vec<T> + 'a;

/// Deformable body for a scene: law, particles, velocity, and in any combination an initial state, loads and splitting.
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
    pub(crate) law: L,
    seeds: &'a Seeds<D>,
    velocity: Box<Velocity<'a, D>>,
    state: Option<Box<InitialState<'a, T, D>>>,
    loads: Loads<D>,
    splitting: Option<Splitting>,
    renewed: bool,
    pub(crate) kernels: Option<Arc<dyn MethodKernels<T, D>>>,
}

impl<'a, const D: usize, L: IntoMaterial<T>, T: Float> Deformable<'a, D, L, T> {
    /// Create a body of this law with particles at `seeds`, at rest.
    pub fn new(name: &str, law: L, seeds: &'a Seeds<D>) -> Self {
        let velocity = Box::new(|_| [0.0; D]);
        let (name, loads) = (name.to_string(), Loads::default());
        Deformable {
            name,
            law,
            seeds,
            velocity,
            state: None,
            loads,
            splitting: None,
            renewed: false,
            kernels: None,
        }
    }
    /// Set the velocity as a function of position, m/s and m.
    #[must_use]
    pub fn moving(mut self, velocity: impl Fn([f64; D]) -> [f64; D] + 'a) -> Self {
        self.velocity = Box::new(velocity);
        self
    }
    /// Add a surface load.
    #[must_use]
    pub fn with_traction(mut self, traction: Traction<D>) -> Self {
        self.loads.tractions.push(traction);
        self
    }
    /// Set a force on all particles.
    #[must_use]
    pub fn with_field_force(mut self, field: FieldForce<D>) -> Self {
        self.loads.field = Some(field);
        self
    }
    /// Set the law's `state` as a function of position (m), instead of the virgin one: stressed by their own weight,
    /// or to be ignited when a detonation wave arrives. The volume of a seed is that of the state.
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
    /// Set the initial state by its values, in the order of [`Material::state_names`], for a law that is an object.
    #[must_use]
    pub fn in_numbers(mut self, state: impl Fn([f64; D]) -> Vec<T> + 'a) -> Self {
        self.state = Some(Box::new(state));
        self
    }
    /// Split particles that are stretched too far.
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
    /// Renew the density from the positions of the particles: the treatment of a weakly compressible liquid, with quadratic
    /// B-splines and [`Apic`](crate::Apic) ([`Method::contact_at_rest`](crate::Method::contact_at_rest); book, "Weakly
    /// compressible water").
    ///
    /// Laws then receive the mean dilatation of a cell, and every ten steps volume ratios are moved towards a linear fit over
    /// their surroundings and towards the space that the particles occupy between planes and other bodies. Without it, volumes
    /// drift from the space that they occupy: the centre of mass of a tank that sloshes falls by percents in a few periods. The
    /// change of energy is booked as numerical viscosity.
    ///
    /// Adding the body fails if its law is not a fluid whose pressure depends on the volume alone, such as `Fluid::new(Tait)`, or
    /// the method has other parts.
    #[must_use]
    pub fn with_renewed_density(mut self) -> Self {
        self.renewed = true;
        self
    }
    /// Convert the law to an object.
    pub(crate) fn prepared(self) -> Prepared<'a, T, D> {
        let Deformable { name, law, seeds, velocity, state, loads, splitting, renewed, kernels } = self;
        let material = law.into_material();
        Prepared { name, material, seeds, velocity, state, loads, splitting, renewed, kernels }
    }
}

/// Description of a [`Deformable`] whose law is an object.
pub struct Prepared<'a, T: Float, const D: usize> {
    pub(in crate::step) name: String,
    pub(in crate::step) material: Arc<dyn Material<T>>,
    pub(in crate::step) seeds: &'a Seeds<D>,
    pub(in crate::step) velocity: Box<Velocity<'a, D>>,
    pub(in crate::step) state: Option<Box<InitialState<'a, T, D>>>,
    pub(in crate::step) loads: Loads<D>,
    pub(in crate::step) splitting: Option<Splitting>,
    pub(in crate::step) renewed: bool,
    pub(in crate::step) kernels: Option<Arc<dyn MethodKernels<T, D>>>,
}
