//! Laws behind one call for many points: what every method hands its points to.
//!
//! A [`Constitutive`] law is generic text for one point. [`Compiled`] makes a [`Material`] of it: an object whose kernels take
//! some tens of points at once, compiled once a law and kind of vectors, whatever methods use it. So the compile time of a
//! program is the sum of that of its laws and of that of its methods, and not their product, and a law can be chosen at run time.
//!
//! Points come in **groups** of [`Float::GROUP`], a 32-byte row for each of their numbers, wherever the method keeps them: a
//! [`States`] says where. A group that has fewer points than lanes holds virgin states in the others, which do not move.
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

use std::sync::Arc;

use impactite_simd::{Arch, Float, Kernel, Lane, Mask, Pack, RowPair, Vectors};

use crate::capability::Stretches;
use crate::point::{Breakdown, CompiledHere, Constitutive, Fault, Kinematics, Sink, Source, State, flatten};
use crate::tensor::{Mat3, Sym3};

/// A place in a list of groups that none takes.
pub const NO_GROUP: u32 = u32::MAX;

/// How the points of two groups deform that come one behind the other in a list: the first one in an even place.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deformation<R> {
    /// Nine numbers a point, by rows: a gradient of the velocity.
    pub gradient: [RowPair<R>; 9],
    /// What they are multiplied by to make increments of the displacement gradient, dt grad v; zero without a point.
    pub step: RowPair<R>,
}

/// How points move in a step.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a, T: Float> {
    /// How they deform, two groups of the list in each.
    pub deformation: &'a [Deformation<T::Row>],
    /// Time step, s.
    pub dt: T,
    /// Size of the cell or element a point stands in, m.
    pub length: Length<'a, T>,
}

/// Sizes of the cells or elements that points stand in, m.
#[derive(Clone, Copy, Debug)]
pub enum Length<'a, T: Float> {
    /// One for all.
    Same(T),
    /// Each its own, a row a group of the list.
    Each(&'a [T::Row]),
}

/// Where the states of groups of points are: number `k` of group `n` is the row `groups[n] * stride + first + k`.
#[derive(Clone, Copy, Debug)]
pub struct States<'a, T: Float> {
    /// All rows of the store.
    pub all: &'a [T::Row],
    /// Rows of a group in the store.
    pub stride: usize,
    /// First row of the state among them.
    pub first: usize,
    /// The groups, by place in the store, or [`NO_GROUP`].
    pub groups: &'a [u32],
}

/// [`States`] that change. A group comes once at most.
#[derive(Debug)]
pub struct StatesMut<'a, T: Float> {
    /// All rows of the store.
    pub all: &'a mut [T::Row],
    /// Rows of a group in the store.
    pub stride: usize,
    /// First row of the state among them.
    pub first: usize,
    /// The groups, by place in the store, or [`NO_GROUP`].
    pub groups: &'a [u32],
}

/// What a law says of the points of two groups that come one behind the other in a list.
#[derive(Clone, Copy, Debug, Default)]
pub struct PairOutput<R> {
    /// Cauchy stress xx, yy, zz, yz, xz, xy, Pa, tension positive.
    pub stress: [RowPair<R>; 6],
    /// Volume over reference volume, J.
    pub volume_ratio: RowPair<R>,
    /// [`Constitutive::step_speed`], m/s, if asked for.
    pub step_speed: RowPair<R>,
}

/// A point whose law broke down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BrokenPoint {
    /// Its group, by place in the list given.
    pub group: usize,
    /// Its lane.
    pub lane: usize,
    /// Why.
    pub cause: Breakdown,
}

/// What a law says of groups of points: memory that a thread keeps.
#[derive(Clone, Debug)]
pub struct Response<T: Float> {
    outputs: Vec<PairOutput<T::Row>>,
    groups: usize,
    faults: Vec<BrokenPoint>,
    /// Rows of a state, of a group that is not there.
    spare: Vec<T::Row>,
}

impl<T: Float> Default for Response<T> {
    fn default() -> Self {
        Response { outputs: Vec::new(), groups: 0, faults: Vec::new(), spare: Vec::new() }
    }
}

impl<T: Float> Response<T> {
    /// Of all groups of the list given, two in each.
    #[inline(always)]
    pub fn outputs(&self) -> &[PairOutput<T::Row>] {
        &self.outputs[..self.groups.div_ceil(2)]
    }
    /// The same of so many groups, of which none broke down.
    pub fn fill(&mut self, groups: usize, output: PairOutput<T::Row>) {
        self.have(groups);
        self.outputs.fill(output);
    }
    /// The points that broke down, in the same order. Lanes without a point may be among them.
    #[inline(always)]
    pub fn faults(&self) -> &[BrokenPoint] {
        &self.faults
    }
    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        self.outputs.capacity() * size_of::<PairOutput<T::Row>>()
            + self.faults.capacity() * size_of::<BrokenPoint>()
            + self.spare.capacity() * size_of::<T::Row>()
    }
    /// Have so many groups, of which nothing is known.
    #[inline(always)]
    fn have(&mut self, groups: usize) {
        if self.outputs.len() < groups.div_ceil(2) {
            self.outputs.resize(groups.div_ceil(2), PairOutput::default());
        }
        self.groups = groups;
        self.faults.clear();
    }
}

/// What a law says of one state.
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
    /// Is the state within the range of the law's data? [`Constitutive::in_range`].
    pub in_range: bool,
    /// Has the point failed? [`Constitutive::failed`].
    pub failed: bool,
}

/// A law as methods see it, compiled. [`Compiled`] makes one of a [`Constitutive`] law; nothing else needs to.
pub trait Material<T: Float>: Send + Sync {
    /// The law's name, for messages.
    fn name(&self) -> &'static str;
    /// Reference density rho0, kg/m^3.
    fn density(&self) -> T;
    /// The law with all its constants, as its `Debug` shows them.
    fn constants(&self) -> String;
    /// How many numbers a state has.
    fn numbers(&self) -> usize;
    /// Their names, in order.
    fn state_names(&self) -> Vec<String>;
    /// The state of a stress-free point at reference density.
    fn virgin(&self) -> Vec<T>;
    /// One step of groups of points: new states in place of the old ones, stress and volume ratio, and wave speeds if
    /// `speeds` asks for them. What comes of points that broke down means nothing.
    ///
    /// # Panics
    /// A group that is not within the store, or comes twice.
    fn advance(
        &self,
        motion: &Motion<'_, T>,
        states: StatesMut<'_, T>,
        speeds: bool,
        response: &mut Response<T>,
    );
    /// Stress, volume ratio and the speed that steps are held by in cells of `length`, m, of states as they stand.
    fn describe(&self, states: States<'_, T>, length: T, response: &mut Response<T>);
    /// Volume ratios alone, a row a group of the list.
    fn volume_ratios(&self, states: States<'_, T>, ratios: &mut [T::Row]);
    /// All that it says of one state; nothing unless it has [`Material::numbers`] numbers.
    fn describe_point(&self, state: &[T]) -> Option<Described<T>>;
    /// [`Constitutive::step_speed`] of one state, m/s; nothing unless it has [`Material::numbers`] numbers.
    fn step_speed(&self, state: &[T], length: T) -> Option<T>;
    /// [`Constitutive::volume_ratio`] of one state; nothing unless it has [`Material::numbers`] numbers.
    fn volume_ratio_of(&self, state: &[T]) -> Option<T> {
        self.describe_point(state).map(|said| said.volume_ratio)
    }
    /// Internal energy per reference volume of one state, J/m^3; nothing unless it has [`Material::numbers`] numbers.
    fn energy_of(&self, state: &[T]) -> Option<T>;
    /// Heat of viscosity per reference volume of one state, J/m^3, which is part of its energy; zero unless the law knows it and the state has
    /// [`Material::numbers`] numbers.
    fn viscous_heat_of(&self, state: &[T]) -> T {
        let _ = state;
        T::default()
    }
    /// One state for points that become one, each with its mass, kg: [`Constitutive::merged`].
    fn merged(&self, points: &[(f64, &[T])]) -> Option<Vec<T>>;
    /// Where a state keeps the accumulated stretch, if it does: [`Constitutive::stretch_place`].
    fn stretch_place(&self) -> Option<usize>;
    /// What bulk viscosity stiffens a closing point by: [`Constitutive::shock_viscosity`].
    fn shock_viscosity(&self) -> [T; 2] {
        [T::default(); 2]
    }
    /// Is the stress across the plane zero? [`Constitutive::is_plane_stress`].
    fn is_plane_stress(&self) -> bool {
        false
    }
}

/// What a scene takes for the law of a body: a law of this library, whose kernels are compiled here; or what
/// [`Constitutive::compiled`] makes of any other one; or a material that is there already.
#[diagnostic::on_unimplemented(
    message = "the kernels of the law `{Self}` are not compiled in `mpm-materials`",
    note = "compile them in your crate, once, for some seconds: `law.compiled()`"
)]
pub trait IntoMaterial<T: Float> {
    /// The law, or [`AnyLaw`] where its type is not known.
    type Law;
    /// A copy of the law.
    fn law(&self) -> Self::Law;
    /// The law as an object.
    fn into_material(self) -> Arc<dyn Material<T>>;
}

/// A law of which the type is not known.
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
        Arc::new(Compiled { law: self.0 })
    }
}

/// A law whose particles may be split: it keeps their stretch ([`Stretches`]), or nobody knows and the scene asks it.
#[diagnostic::on_unimplemented(
    message = "particles of the law `{Self}` cannot be split: they do not keep their accumulated stretch",
    note = "wrap the law: `Stretching::new(law)`"
)]
pub trait MaySplit<T> {}
impl<C: Stretches<f64>> MaySplit<f64> for C {}
impl<C: Stretches<f32>> MaySplit<f32> for C {}
impl MaySplit<f64> for AnyLaw {}
impl MaySplit<f32> for AnyLaw {}

/// The [`Material`] of a law.
#[derive(Clone, Debug)]
pub struct Compiled<C> {
    law: C,
}

impl<C> Compiled<C> {
    /// Of this law.
    pub fn new(law: C) -> Self {
        Compiled { law }
    }
    /// The law.
    pub fn law(&self) -> &C {
        &self.law
    }
}

/// A law of plain numbers, as a copy that no write to memory can change: it can stay in vectors. Others stay where they are.
#[inline(always)]
fn local<C: Clone>(law: &C) -> Option<C> {
    if const { std::mem::needs_drop::<C>() } { None } else { Some(law.clone()) }
}

/// Numbers of states in the rows of the groups that a pack takes.
pub(crate) struct Reader<'a, T: Float> {
    rows: [&'a [T::Row]; 2],
    lane: usize,
    at: usize,
}

impl<T: Float, P: Pack<T>> Source<P> for Reader<'_, T> {
    #[inline(always)]
    fn take(&mut self) -> P {
        self.at += 1;
        let second = if P::GROUPS == 1 { 0 } else { 1 };
        P::from_rows([&self.rows[0][self.at - 1], &self.rows[second][self.at - 1]], self.lane)
    }
}

/// Where they go.
pub(crate) struct Writer<'a, T: Float> {
    rows: [&'a mut [T::Row]; 2],
    lane: usize,
    at: usize,
}

impl<T: Float, P: Pack<T>> Sink<P> for Writer<'_, T> {
    #[inline(always)]
    fn put(&mut self, value: P) {
        value.to_row(0, &mut self.rows[0][self.at], self.lane);
        if P::GROUPS > 1 {
            value.to_row(1, &mut self.rows[1][self.at], self.lane);
        }
        self.at += 1;
    }
}

struct Advance<'a, T: Float, C> {
    law: &'a C,
    motion: &'a Motion<'a, T>,
    states: StatesMut<'a, T>,
    speeds: bool,
    outputs: &'a mut [PairOutput<T::Row>],
    faults: &'a mut Vec<BrokenPoint>,
    /// Rows of a state.
    spare: &'a mut [T::Row],
}

impl<T: Float, C: Constitutive<T>> Kernel<T> for Advance<'_, T, C> {
    const VECTORS: Vectors = Vectors::Avx512;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let Advance { law, motion, states, speeds, outputs, faults, spare } = self;
        let own = local(law);
        let law = own.as_ref().unwrap_or(law);
        let StatesMut { all, stride, first, groups } = states;
        let length = <C::State<A::Batch> as State<A::Batch>>::LEN;
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
                    // The second half of the vector holds the same again, which goes to where nobody looks.
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
                let old = C::State::<A::Batch>::read(&mut Reader { rows: from, lane, at: 0 });
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
                new.state.write(&mut Writer { rows: [one_rows, two_rows], lane, at: 0 });
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

/// Note the points that broke down.
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
        let (numbers, length) = (<C::State<A::Pack> as State<A::Pack>>::LEN, A::Pack::splat(length));
        for (n, &group) in groups.iter().enumerate().filter(|(_, group)| **group != NO_GROUP) {
            let (outputs, half) = (&mut outputs[n / 2], n % 2);
            let rows = &all[group as usize * stride + first..][..numbers];
            for lane in (0..T::GROUP).step_by(A::Pack::WIDTH) {
                let now = C::State::<A::Pack>::read(&mut Reader { rows: [rows; 2], lane, at: 0 });
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

/// Numbers of the state of one lane.
struct Lanes<'a, T: Float> {
    rows: &'a [T::Row],
    lane: usize,
    at: usize,
}

impl<T: Float> Source<T::Single> for Lanes<'_, T> {
    #[inline(always)]
    fn take(&mut self) -> T::Single {
        self.at += 1;
        self.rows[self.at - 1].as_ref()[self.lane].into()
    }
}

/// The states of a group's lanes.
fn lanes<'a, T: Float, C: Constitutive<T>>(
    states: &States<'a, T>,
    group: u32,
) -> impl Iterator<Item = (usize, C::State<T::Single>)> + use<'a, T, C> {
    let length = <C::State<T::Single> as State<T::Single>>::LEN;
    let rows = &states.all[group as usize * states.stride + states.first..][..length];
    (0..T::GROUP).map(move |lane| (lane, State::read(&mut Lanes::<T> { rows, lane, at: 0 })))
}

/// A state of these numbers.
fn single<T: Float, C: Constitutive<T>>(numbers: &[T]) -> Option<C::State<T::Single>> {
    let length = <C::State<T::Single> as State<T::Single>>::LEN;
    (numbers.len() == length).then(|| C::State::read(&mut Numbers { left: numbers.iter() }))
}

/// The numbers of one state.
struct Numbers<'a, T> {
    left: std::slice::Iter<'a, T>,
}

impl<T: Float> Source<T::Single> for Numbers<'_, T> {
    #[inline(always)]
    fn take(&mut self) -> T::Single {
        T::Single::from(self.left.next().copied().unwrap_or_default())
    }
}

impl<T: Float, C: Constitutive<T>> Material<T> for Compiled<C> {
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
        <C::State<T::Single> as State<T::Single>>::LEN
    }
    fn state_names(&self) -> Vec<String> {
        let mut names = Vec::new();
        C::State::<T::Single>::names("state", &mut names);
        names
    }
    fn virgin(&self) -> Vec<T> {
        flatten(&self.law.virgin()).into_iter().map(|x: T::Single| x.into()).collect()
    }
    fn advance(
        &self,
        motion: &Motion<'_, T>,
        states: StatesMut<'_, T>,
        speeds: bool,
        response: &mut Response<T>,
    ) {
        response.have(states.groups.len());
        response.spare.resize(<C::State<T::Single> as State<T::Single>>::LEN, T::Row::default());
        let (law, outputs, faults) = (&self.law, &mut response.outputs[..], &mut response.faults);
        let spare = &mut response.spare[..];
        T::dispatch(Advance { law, motion, states, speeds, outputs, faults, spare });
    }
    fn describe(&self, states: States<'_, T>, length: T, response: &mut Response<T>) {
        response.have(states.groups.len());
        T::dispatch(Describe { law: &self.law, states, length, outputs: &mut response.outputs[..] });
    }
    fn volume_ratios(&self, states: States<'_, T>, ratios: &mut [T::Row]) {
        let groups = states.groups.iter().zip(ratios);
        for (&group, ratio) in groups.filter(|(group, _)| **group != NO_GROUP) {
            for (lane, now) in lanes::<T, C>(&states, group) {
                ratio.as_mut()[lane] = self.law.volume_ratio(&now).into();
            }
        }
    }
    fn describe_point(&self, state: &[T]) -> Option<Described<T>> {
        let now = single::<T, C>(state)?;
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
        Some(self.law.volume_ratio(&single::<T, C>(state)?).into())
    }
    fn step_speed(&self, state: &[T], length: T) -> Option<T> {
        Some(self.law.step_speed(&single::<T, C>(state)?, T::Single::from(length)).into())
    }
    fn energy_of(&self, state: &[T]) -> Option<T> {
        Some(self.law.energy(&single::<T, C>(state)?).into())
    }
    fn viscous_heat_of(&self, state: &[T]) -> T {
        let heats = self.law.has_viscous_heat();
        let now = if heats { single::<T, C>(state) } else { None };
        now.map_or(T::default(), |now| self.law.viscous_heat(&now).into())
    }
    fn merged(&self, points: &[(f64, &[T])]) -> Option<Vec<T>> {
        let states: Option<Vec<_>> =
            points.iter().map(|&(mass, numbers)| Some((mass, single::<T, C>(numbers)?))).collect();
        let merged = self.law.merged(&states?)?;
        Some(flatten(&merged).into_iter().map(|x: T::Single| x.into()).collect())
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
