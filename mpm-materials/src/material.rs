//! Compiled material laws: one call updates many points, for all numerical methods.
//!
//! A [`Constitutive`] law is generic code for one point. [`Compiled`] turns it into a [`Material`]: an object whose
//! kernels process some tens of points per call, compiled once per law and vector instruction set, whatever methods use
//! it. The compile time of a program is thus that of its laws plus that of its methods, not their product, and a law
//! can be chosen at run time.
//!
//! Points are stored in **groups** of [`Float::GROUP`], with a 32-byte row per state variable, in the memory of the
//! method; a [`States`] describes the layout. Unused lanes of a group store virgin states and do not move.
//!
//! ```
//! use mpm_materials::material::{Deformation, IntoMaterial, Length, Motion, Response, StatesMut};
//! use mpm_materials::{LinearElastic, Moduli};
//!
//! # fn main() -> Result<(), mpm_materials::ParameterError> {
//! let steel = LinearElastic::new(7850.0, Moduli::young_poisson(206e9, 0.3)?)?.into_material();
//! // One group of four points, drawn out along x by 1e-3 in a step of 1 us.
//! let mut rows: Vec<_> = steel.virgin().iter().map(|&x| row(x)).collect();
//! let mut deformation = [Deformation::default()];
//! deformation[0].gradient[0].0[0] = row(1e3);
//! deformation[0].step.0[0] = row(1e-6);
//! let motion = Motion { deformation: &deformation, dt: 1e-6, length: Length::Same(1e-3) };
//! let mut response = Response::default();
//! let states = StatesMut { all: &mut rows, stride: steel.numbers(), first: 0, groups: &[0] };
//! steel.advance(&motion, states, true, &mut response);
//! assert!(response.faults().is_empty());
//! let stress = response.outputs()[0].stress[0].0[0].as_ref()[3];
//! assert!((stress / (steel.density() * 5.9e3f64.powi(2) * 1e-3) - 1.0).abs() < 0.02);
//! # Ok(())
//! # }
//! # fn row(x: f64) -> impactite_simd::Row<f64, 4> {
//! #     let mut row = impactite_simd::Row::default();
//! #     row.as_mut().fill(x);
//! #     row
//! # }
//! # use impactite_simd::Float;
//! ```

use std::marker::PhantomData;
use std::sync::Arc;

use impactite_simd::{Arch, Float, Kernel, Lane, Mask, Pack, Real, RowPair, Vectors};

use crate::capability::Stretches;
use crate::point::{Breakdown, CompiledHere, Constitutive, Fault, Kinematics, Sink, Source, State, flatten};
use crate::tensor::{Mat3, Sym3};

/// Empty entry of a list of groups.
pub const NO_GROUP: u32 = u32::MAX;

/// Velocity gradients of two consecutive groups of a list, the first at an even index.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deformation<R> {
    /// Velocity gradient, nine components per point, row by row.
    pub gradient: [RowPair<R>; 9],
    /// Factor from `gradient` to the displacement-gradient increment dt grad v; zero in lanes without a point.
    pub step: RowPair<R>,
}

/// Motion of points in a step.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a, T: Float> {
    /// Velocity gradients, two groups of the list per entry.
    pub deformation: &'a [Deformation<T::Row>],
    /// Time step, s.
    pub dt: T,
    /// Size of the cell or element of each point, m.
    pub length: Length<'a, T>,
}

/// Sizes of the cells or elements of points, m.
#[derive(Clone, Copy, Debug)]
pub enum Length<'a, T: Float> {
    /// One size for all points.
    Same(T),
    /// One size per point, a row per group of the list.
    Each(&'a [T::Row]),
}

/// Memory layout of states of groups of points: number `k` of group `n` is the row `groups[n] * stride + first + k`.
#[derive(Clone, Copy, Debug)]
pub struct States<'a, T: Float> {
    /// All rows of the store.
    pub all: &'a [T::Row],
    /// Number of rows per group in the store.
    pub stride: usize,
    /// Index of the first state row within a group.
    pub first: usize,
    /// Indices of the groups in the store, or [`NO_GROUP`].
    pub groups: &'a [u32],
}

/// Mutable [`States`]. Each group occurs at most once.
#[derive(Debug)]
pub struct StatesMut<'a, T: Float> {
    /// All rows of the store.
    pub all: &'a mut [T::Row],
    /// Number of rows per group in the store.
    pub stride: usize,
    /// Index of the first state row within a group.
    pub first: usize,
    /// Indices of the groups in the store, or [`NO_GROUP`].
    pub groups: &'a [u32],
}

/// Response of a law at the points of two consecutive groups of a list.
#[derive(Clone, Copy, Debug, Default)]
pub struct PairOutput<R> {
    /// Cauchy stress xx, yy, zz, yz, xz, xy, Pa, tension positive.
    pub stress: [RowPair<R>; 6],
    /// Volume over reference volume, J.
    pub volume_ratio: RowPair<R>,
    /// [`Constitutive::step_speed`], m/s, if requested.
    pub step_speed: RowPair<R>,
}

/// A point whose law broke down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BrokenPoint {
    /// Index of its group in the list of the call.
    pub group: usize,
    /// Lane within the group.
    pub lane: usize,
    /// Cause of the breakdown.
    pub cause: Breakdown,
}

/// Response of a law at groups of points: buffers that a thread reuses.
#[derive(Clone, Debug)]
pub struct Response<T: Float> {
    outputs: Vec<PairOutput<T::Row>>,
    groups: usize,
    faults: Vec<BrokenPoint>,
    /// State rows of a dummy group.
    spare: Vec<T::Row>,
}

impl<T: Float> Default for Response<T> {
    fn default() -> Self {
        Response { outputs: Vec::new(), groups: 0, faults: Vec::new(), spare: Vec::new() }
    }
}

impl<T: Float> Response<T> {
    /// Return the responses of all groups of the list, two groups per entry.
    #[inline(always)]
    pub fn outputs(&self) -> &[PairOutput<T::Row>] {
        &self.outputs[..self.groups.div_ceil(2)]
    }
    /// Set the response of `groups` groups to `output`, without breakdowns.
    pub fn fill(&mut self, groups: usize, output: PairOutput<T::Row>) {
        self.have(groups);
        self.outputs.fill(output);
    }
    /// Multiply the step speeds by a factor.
    pub fn scale_speeds(&mut self, factor: T) {
        let outputs = &mut self.outputs[..self.groups.div_ceil(2)];
        for row in outputs.iter_mut().flat_map(|out| &mut out.step_speed.0) {
            row.as_mut().iter_mut().for_each(|speed| *speed *= factor);
        }
    }
    /// Return the points that broke down, in the order of the list. Lanes without a point may be included.
    #[inline(always)]
    pub fn faults(&self) -> &[BrokenPoint] {
        &self.faults
    }
    /// Remove the breakdowns and return them.
    pub(crate) fn take_faults(&mut self) -> Vec<BrokenPoint> {
        std::mem::take(&mut self.faults)
    }
    /// Add breakdowns of points that have none yet.
    pub(crate) fn add_faults(&mut self, faults: Vec<BrokenPoint>) {
        if faults.is_empty() {
            return;
        }
        self.faults.extend(faults);
        self.faults.sort_by_key(|point| (point.group, point.lane));
        self.faults.dedup_by_key(|point| (point.group, point.lane));
    }
    /// Return the memory of the buffers, bytes.
    pub fn bytes(&self) -> usize {
        self.outputs.capacity() * size_of::<PairOutput<T::Row>>()
            + self.faults.capacity() * size_of::<BrokenPoint>()
            + self.spare.capacity() * size_of::<T::Row>()
    }
    /// Resize to `groups` groups with unspecified responses and clear the breakdowns.
    #[inline(always)]
    fn have(&mut self, groups: usize) {
        if self.outputs.len() < groups.div_ceil(2) {
            self.outputs.resize(groups.div_ceil(2), PairOutput::default());
        }
        self.groups = groups;
        self.faults.clear();
    }
}

/// Response of a law at one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Described<T> {
    /// Cauchy stress xx, yy, zz, yz, xz, xy, Pa, tension positive.
    pub stress: [T; 6],
    /// Volume over reference volume, J.
    pub volume_ratio: T,
    /// Speed of the fastest wave, m/s.
    pub wave_speed: T,
    /// Internal energy per reference volume, J/m^3.
    pub energy: T,
    /// True if the state is within the data range of the law: [`Constitutive::in_range`].
    pub in_range: bool,
    /// True if the point has failed: [`Constitutive::failed`].
    pub failed: bool,
}

/// Compiled material law, the interface to the methods. [`Compiled`] implements it for every [`Constitutive`] law.
pub trait Material<T: Float>: Send + Sync {
    /// The law's name, for messages.
    fn name(&self) -> &'static str;
    /// Reference density rho0, kg/m^3.
    fn density(&self) -> T;
    /// Constants of the law, in its `Debug` format.
    fn constants(&self) -> String;
    /// Number of state variables of a point.
    fn numbers(&self) -> usize;
    /// Names of the state variables, in order.
    fn state_names(&self) -> Vec<String>;
    /// Return the state of a virgin point at reference density.
    fn virgin(&self) -> Vec<T>;
    /// Update the states of groups of points in place by one step, and return stress, volume ratio and, if `speeds`,
    /// step speed in `response`. Results of points that broke down are meaningless.
    ///
    /// # Panics
    /// A group outside the store, or listed twice.
    fn advance(
        &self,
        motion: &Motion<'_, T>,
        states: StatesMut<'_, T>,
        speeds: bool,
        response: &mut Response<T>,
    );
    /// Compute stress, volume ratio and [`Constitutive::step_speed`] of states without a step, in cells of `length`,
    /// m.
    fn describe(&self, states: States<'_, T>, length: T, response: &mut Response<T>);
    /// Compute volume ratios only, a row per group of the list.
    fn volume_ratios(&self, states: States<'_, T>, ratios: &mut [T::Row]);
    /// Compute internal energies and the heats of viscosity that are part of them, J/m^3 of reference volume, a row each per
    /// group of the list: [`Material::energy_of`], [`Material::viscous_heat_of`].
    fn energies(&self, states: States<'_, T>, energies: &mut [T::Row], heats: &mut [T::Row]);
    /// Return the response at one state; `None` unless it has [`Material::numbers`] numbers.
    fn describe_point(&self, state: &[T]) -> Option<Described<T>>;
    /// Return [`Constitutive::step_speed`] of one state, m/s; `None` unless it has [`Material::numbers`] numbers.
    fn step_speed(&self, state: &[T], length: T) -> Option<T>;
    /// Return [`Constitutive::volume_ratio`] of one state; `None` unless it has [`Material::numbers`] numbers.
    fn volume_ratio_of(&self, state: &[T]) -> Option<T> {
        self.describe_point(state).map(|said| said.volume_ratio)
    }
    /// Internal energy per reference volume of one state, J/m^3; `None` unless it has [`Material::numbers`] numbers.
    fn energy_of(&self, state: &[T]) -> Option<T>;
    /// Viscous heat per reference volume of one state, J/m^3, a part of its energy; zero unless the law tracks it and
    /// the state has [`Material::numbers`] numbers.
    fn viscous_heat_of(&self, state: &[T]) -> T {
        let _ = state;
        T::default()
    }
    /// Merge the states of points, each with its mass, kg, into one: [`Constitutive::merged`].
    fn merged(&self, points: &[(f64, &[T])]) -> Option<Vec<T>>;
    /// Index of the accumulated stretch in a state, if stored: [`Constitutive::stretch_place`].
    fn stretch_place(&self) -> Option<usize>;
    /// Bulk viscosity coefficients for the time step limit: [`Constitutive::shock_viscosity`].
    fn shock_viscosity(&self) -> [T; 2] {
        [T::default(); 2]
    }
    /// True if the out-of-plane stress is zero: [`Constitutive::is_plane_stress`].
    fn is_plane_stress(&self) -> bool {
        false
    }
}

/// Conversion of a law for a scene into a [`Material`]: of a law of this library, whose kernels are compiled here, of
/// any other law after [`Constitutive::compiled`], or of an existing material.
#[diagnostic::on_unimplemented(
    message = "the kernels of the law `{Self}` are not compiled in `mpm-materials`",
    note = "compile them in your crate, once, for some seconds: `law.compiled()`"
)]
pub trait IntoMaterial<T: Float> {
    /// Type of the law, or [`AnyLaw`] if it is unknown.
    type Law;
    /// Return a copy of the law.
    fn law(&self) -> Self::Law;
    /// Convert the law into an object.
    fn into_material(self) -> Arc<dyn Material<T>>;
}

/// Law of unknown type.
#[derive(Clone, Copy, Debug)]
pub struct AnyLaw;

impl<T: Float> IntoMaterial<T> for Arc<dyn Material<T>> {
    type Law = AnyLaw;
    fn law(&self) -> AnyLaw {
        AnyLaw
    }
    fn into_material(self) -> Arc<dyn Material<T>> {
        self
    }
}

impl<T: Float, C: Constitutive<T>> IntoMaterial<T> for CompiledHere<C> {
    type Law = C;
    fn law(&self) -> C {
        self.0.clone()
    }
    fn into_material(self) -> Arc<dyn Material<T>> {
        Arc::new(Compiled::new(self.0))
    }
}

/// Law whose particles may be split: it stores their stretch ([`Stretches`]), or its type is unknown and the scene
/// checks it.
#[diagnostic::on_unimplemented(
    message = "particles of the law `{Self}` cannot be split: they do not keep their accumulated stretch",
    note = "wrap the law: `Stretching::new(law)`"
)]
pub trait MaySplit<T> {}
impl<C: Stretches<f64>> MaySplit<f64> for C {}
impl<C: Stretches<f32>> MaySplit<f32> for C {}
impl MaySplit<f64> for AnyLaw {}
impl MaySplit<f32> for AnyLaw {}

/// The [`Material`] of a law. Kernels have AVX-512 where `WIDE`, else at most AVX2, for laws of much code that are rarely used.
#[derive(Clone, Debug)]
pub struct Compiled<C, const WIDE: bool = true> {
    law: C,
}

impl<C> Compiled<C> {
    /// Wrap a law.
    pub fn new(law: C) -> Self {
        Compiled { law }
    }
}

impl<C> Compiled<C, false> {
    /// Wrap a law, with kernels of AVX2 at most.
    pub fn narrow(law: C) -> Self {
        Compiled { law }
    }
}

impl<C, const WIDE: bool> Compiled<C, WIDE> {
    /// The law.
    pub fn law(&self) -> &C {
        &self.law
    }
}

/// Copy a law of plain numbers, which no write to memory can change, so that it stays in registers; `None` for other
/// laws.
#[inline(always)]
fn local<C: Clone>(law: &C) -> Option<C> {
    if const { std::mem::needs_drop::<C>() } { None } else { Some(law.clone()) }
}

/// Bit mask of the stored state variables of a law, and their position.
#[derive(Clone, Copy)]
struct Stored {
    mask: u64,
    /// Index of the next state variable.
    next: usize,
    /// Number of stored variables before it.
    at: usize,
}

impl Stored {
    #[inline(always)]
    fn of<T: Real, C: Constitutive<T>>(law: &C) -> Self {
        Stored { mask: law.stored(), next: 0, at: 0 }
    }
    /// Number of stored state variables of a law.
    #[inline(always)]
    fn count<T: Real, C: Constitutive<T>>(law: &C) -> usize {
        let all = <C::State<T::Single> as State<T::Single>>::LEN;
        let mask = law.stored();
        // A state of more than 64 variables is stored as a whole.
        if mask == u64::MAX { all } else { (0..all).filter(|k| mask >> k & 1 != 0).count() }
    }
    /// Return the place of the next state variable; `None` if it is not stored.
    #[inline(always)]
    fn place(&mut self) -> Option<usize> {
        let there = self.mask == u64::MAX || self.mask >> self.next & 1 != 0;
        self.next += 1;
        if !there {
            return None;
        }
        self.at += 1;
        Some(self.at - 1)
    }
}

/// Reader of state variables from the rows of the groups of a pack.
struct Reader<'a, T: Float> {
    rows: [&'a [T::Row]; 2],
    lane: usize,
    stored: Stored,
}

impl<T: Float, P: Pack<T>> Source<P> for Reader<'_, T> {
    #[inline(always)]
    fn take(&mut self) -> P {
        let Some(at) = self.stored.place() else { return P::zero() };
        let second = if P::GROUPS == 1 { 0 } else { 1 };
        P::from_rows([&self.rows[0][at], &self.rows[second][at]], self.lane)
    }
}

/// Writer of state variables to the rows of the groups of a pack.
struct Writer<'a, T: Float> {
    rows: [&'a mut [T::Row]; 2],
    lane: usize,
    stored: Stored,
}

impl<T: Float, P: Pack<T>> Sink<P> for Writer<'_, T> {
    #[inline(always)]
    fn put(&mut self, value: P) {
        let Some(at) = self.stored.place() else { return };
        value.to_row(0, &mut self.rows[0][at], self.lane);
        if P::GROUPS > 1 {
            value.to_row(1, &mut self.rows[1][at], self.lane);
        }
    }
}

struct Advance<'a, T: Float, C, const WIDE: bool> {
    law: &'a C,
    motion: &'a Motion<'a, T>,
    states: StatesMut<'a, T>,
    speeds: bool,
    outputs: &'a mut [PairOutput<T::Row>],
    faults: &'a mut Vec<BrokenPoint>,
    /// State rows of a dummy group.
    spare: &'a mut [T::Row],
}

impl<T: Float, C: Constitutive<T>, const WIDE: bool> Kernel<T> for Advance<'_, T, C, WIDE> {
    const VECTORS: Vectors = if WIDE { Vectors::Avx512 } else { Vectors::Avx2 };
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let Advance { law, motion, states, speeds, outputs, faults, spare } = self;
        let own = local(law);
        let law = own.as_ref().unwrap_or(law);
        let StatesMut { all, stride, first, groups } = states;
        let (length, stored) = (Stored::count::<T, C>(law), Stored::of(law));
        let count = groups.len();
        let (deformation, outputs) =
            (&motion.deformation[..count.div_ceil(2)], &mut outputs[..count.div_ceil(2)]);
        let spare = &mut spare[..length];
        let dt = A::Batch::splat(motion.dt);
        for n in (0..count).step_by(A::Batch::GROUPS) {
            let place = |group: u32| {
                let place = group as usize * stride + first;
                place..place + length
            };
            let group = groups[n];
            let beside = if A::Batch::GROUPS == 2 && n + 1 < count { groups[n + 1] } else { NO_GROUP };
            if group == NO_GROUP {
                continue;
            }
            let mut rows: [&mut [T::Row]; 2] = if beside == NO_GROUP {
                let rows = &mut all[place(group)];
                if A::Batch::GROUPS == 2 {
                    // The second half of the vector repeats the group; its results go to the dummy group.
                    spare.copy_from_slice(rows);
                }
                [rows, &mut *spare]
            } else {
                all.get_disjoint_mut([place(group), place(beside)])
                    .expect("groups are within the store, each once")
            };
            let (deformation, outputs, half) = (&deformation[n / 2], &mut outputs[n / 2], n % 2);
            for lane in (0..T::GROUP).step_by(A::Batch::WIDTH.min(T::GROUP)) {
                let from = [&*rows[0], &*rows[1]];
                let old = C::State::<A::Batch>::read(&mut Reader { rows: from, lane, stored });
                let step = A::Batch::from_pair(&deformation.step, half, lane);
                let mut increment = Mat3::<A::Batch>::zero();
                for i in 0..3 {
                    for j in 0..3 {
                        let gradient = A::Batch::from_pair(&deformation.gradient[3 * i + j], half, lane);
                        increment.0[i][j] = gradient * step;
                    }
                }
                let cell = match motion.length {
                    Length::Same(length) => A::Batch::splat(length),
                    Length::Each(rows) => {
                        A::Batch::from_rows([&rows[n], rows.get(n + 1).unwrap_or(&rows[n])], lane)
                    }
                };
                let new = law.update(&Kinematics { increment, dt, length: cell }, &old);
                let [one_rows, two_rows] = &mut rows;
                new.state.write(&mut Writer { rows: [one_rows, two_rows], lane, stored });
                for i in 0..6 {
                    new.stress.0[i].to_pair(&mut outputs.stress[i], half, lane);
                }
                law.volume_ratio(&new.state).to_pair(&mut outputs.volume_ratio, half, lane);
                if speeds {
                    law.step_speed(&new.state, cell).to_pair(&mut outputs.step_speed, half, lane);
                }
                if new.fault.any() {
                    note::<T, A::Batch>(faults, n, lane, &new.fault);
                }
            }
        }
    }
}

/// Record the points that broke down.
#[cold]
#[inline(never)]
fn note<T: Float, P: Pack<T>>(faults: &mut Vec<BrokenPoint>, group: usize, first: usize, fault: &Fault<P>) {
    for lane in 0..P::WIDTH {
        if let Some(cause) = fault.cause(lane) {
            faults.push(BrokenPoint { group: group + lane / T::GROUP, lane: first + lane % T::GROUP, cause });
        }
    }
}

struct Describe<'a, T: Float, C> {
    law: &'a C,
    states: States<'a, T>,
    length: T,
    outputs: &'a mut [PairOutput<T::Row>],
}

impl<T: Float, C: Constitutive<T>> Kernel<T> for Describe<'_, T, C> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let Describe { law, states: States { all, stride, first, groups }, length, outputs } = self;
        let (numbers, stored) = (Stored::count::<T, C>(law), Stored::of(law));
        let length = A::Pack::splat(length);
        for (n, &group) in groups.iter().enumerate().filter(|(_, group)| **group != NO_GROUP) {
            let (outputs, half) = (&mut outputs[n / 2], n % 2);
            let rows = &all[group as usize * stride + first..][..numbers];
            for lane in (0..T::GROUP).step_by(A::Pack::WIDTH) {
                let now = C::State::<A::Pack>::read(&mut Reader { rows: [rows; 2], lane, stored });
                let Sym3(stress) = law.stress(&now);
                for i in 0..6 {
                    stress[i].to_pair(&mut outputs.stress[i], half, lane);
                }
                law.volume_ratio(&now).to_pair(&mut outputs.volume_ratio, half, lane);
                law.step_speed(&now, length).to_pair(&mut outputs.step_speed, half, lane);
            }
        }
    }
}

/// Reader of the state variables of one point, in order.
struct Numbers<T, I> {
    left: I,
    stored: Stored,
    real: PhantomData<T>,
}

impl<T: Float, I: Iterator<Item = T>> Source<T::Single> for Numbers<T, I> {
    #[inline(always)]
    fn take(&mut self) -> T::Single {
        let there = self.stored.place().and_then(|_| self.left.next());
        there.unwrap_or_default().into()
    }
}

impl<C, const WIDE: bool> Compiled<C, WIDE> {
    /// Read a state from its stored numbers.
    fn read<T: Float>(&self, numbers: impl Iterator<Item = T>) -> C::State<T::Single>
    where
        C: Constitutive<T>,
    {
        State::read(&mut Numbers { left: numbers, stored: Stored::of(&self.law), real: PhantomData })
    }
    /// Build a state from its stored numbers; `None` for a wrong count.
    fn single<T: Float>(&self, numbers: &[T]) -> Option<C::State<T::Single>>
    where
        C: Constitutive<T>,
    {
        (numbers.len() == Stored::count::<T, C>(&self.law)).then(|| self.read(numbers.iter().copied()))
    }
    /// Visit the state of every lane of the groups: position of the group in the list, lane and state.
    fn each_state<T: Float>(
        &self,
        states: &States<'_, T>,
        mut visit: impl FnMut(usize, usize, C::State<T::Single>),
    ) where
        C: Constitutive<T>,
    {
        let numbers = Stored::count::<T, C>(&self.law);
        for (n, &group) in states.groups.iter().enumerate().filter(|(_, group)| **group != NO_GROUP) {
            let rows = &states.all[group as usize * states.stride + states.first..][..numbers];
            for lane in 0..T::GROUP {
                visit(n, lane, self.read(rows.iter().map(|row| row.as_ref()[lane])));
            }
        }
    }
    /// Return the stored numbers of a state, or what belongs to them.
    fn stored<T: Float, X>(&self, all: impl IntoIterator<Item = X>) -> Vec<X>
    where
        C: Constitutive<T>,
    {
        let mut stored = Stored::of(&self.law);
        all.into_iter().filter(|_| stored.place().is_some()).collect()
    }
    fn numbers<T: Float>(&self, state: &C::State<T::Single>) -> Vec<T>
    where
        C: Constitutive<T>,
    {
        self.stored(flatten(state).into_iter().map(|x: T::Single| x.into()))
    }
}

impl<T: Float, C: Constitutive<T>, const WIDE: bool> Material<T> for Compiled<C, WIDE> {
    fn name(&self) -> &'static str {
        self.law.name()
    }
    fn density(&self) -> T {
        self.law.density()
    }
    fn constants(&self) -> String {
        format!("{:?}", self.law)
    }
    fn numbers(&self) -> usize {
        Stored::count::<T, C>(&self.law)
    }
    fn state_names(&self) -> Vec<String> {
        let mut names = Vec::new();
        C::State::<T::Single>::names("state", &mut names);
        self.stored(names)
    }
    fn virgin(&self) -> Vec<T> {
        self.numbers(&self.law.virgin())
    }
    fn advance(
        &self,
        motion: &Motion<'_, T>,
        states: StatesMut<'_, T>,
        speeds: bool,
        response: &mut Response<T>,
    ) {
        response.have(states.groups.len());
        response.spare.resize(Stored::count::<T, C>(&self.law), T::Row::default());
        let (law, outputs, faults) = (&self.law, &mut response.outputs[..], &mut response.faults);
        let spare = &mut response.spare[..];
        T::dispatch(Advance::<_, _, WIDE> { law, motion, states, speeds, outputs, faults, spare });
    }
    fn describe(&self, states: States<'_, T>, length: T, response: &mut Response<T>) {
        response.have(states.groups.len());
        T::dispatch(Describe { law: &self.law, states, length, outputs: &mut response.outputs[..] });
    }
    fn volume_ratios(&self, states: States<'_, T>, ratios: &mut [T::Row]) {
        self.each_state(&states, |n, lane, now| {
            ratios[n].as_mut()[lane] = self.law.volume_ratio(&now).into();
        });
    }
    fn energies(&self, states: States<'_, T>, energies: &mut [T::Row], heats: &mut [T::Row]) {
        let heated = self.law.has_viscous_heat();
        self.each_state(&states, |n, lane, now| {
            energies[n].as_mut()[lane] = self.law.energy(&now).into();
            let heat = if heated { self.law.viscous_heat(&now).into() } else { T::default() };
            heats[n].as_mut()[lane] = heat;
        });
    }
    fn describe_point(&self, state: &[T]) -> Option<Described<T>> {
        let now = self.single(state)?;
        let Sym3(stress) = self.law.stress(&now);
        Some(Described {
            stress: stress.map(Into::into),
            volume_ratio: self.law.volume_ratio(&now).into(),
            wave_speed: self.law.wave_speed(&now).into(),
            energy: self.law.energy(&now).into(),
            in_range: Mask::all(self.law.in_range(&now)),
            failed: self.law.failed(&now).any(),
        })
    }
    fn volume_ratio_of(&self, state: &[T]) -> Option<T> {
        Some(self.law.volume_ratio(&self.single(state)?).into())
    }
    fn step_speed(&self, state: &[T], length: T) -> Option<T> {
        Some(self.law.step_speed(&self.single(state)?, T::Single::from(length)).into())
    }
    fn energy_of(&self, state: &[T]) -> Option<T> {
        Some(self.law.energy(&self.single(state)?).into())
    }
    fn viscous_heat_of(&self, state: &[T]) -> T {
        let heats = self.law.has_viscous_heat();
        let now = if heats { self.single(state) } else { None };
        now.map_or(T::default(), |now| self.law.viscous_heat(&now).into())
    }
    fn merged(&self, points: &[(f64, &[T])]) -> Option<Vec<T>> {
        let states: Option<Vec<_>> =
            points.iter().map(|&(mass, numbers)| Some((mass, self.single(numbers)?))).collect();
        Some(self.numbers(&self.law.merged(&states?)?))
    }
    fn stretch_place(&self) -> Option<usize> {
        self.law.stretch_place()
    }
    fn shock_viscosity(&self) -> [T; 2] {
        self.law.shock_viscosity()
    }
    fn is_plane_stress(&self) -> bool {
        self.law.is_plane_stress()
    }
}
