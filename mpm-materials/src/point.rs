//! One material point: how it moves in a step, what it remembers, what a law makes of it, and how it breaks.

use std::fmt;

use crate::lane::{Lane, Mask, Real};
use crate::tensor::{Mat3, Sym3};

/// How a point moves during one step.
#[derive(Clone, Copy, Debug)]
pub struct Kinematics<L> {
    /// Displacement-gradient increment, dt grad v (dimensionless): row `i`, column `j` is dt dv_i/dx_j.
    pub increment: Mat3<L>,
    /// Time step dt > 0, s. (A lane that must not change has `increment` zero.)
    pub dt: L,
    /// Size of the element or cell the point stands in, m: the length in bulk viscosity and in the
    /// regularisation of softening.
    pub length: L,
}

impl<L: Lane> Kinematics<L> {
    /// Change of volume, strain and spin increment: symmetric and antisymmetric part of A = X (I + X/2)^-1, with X the `increment`. A is
    /// the displacement gradient with respect to the configuration half way through the step, and exactly
    /// antisymmetric for a rotation, X = R - I (\[HughesWinget1980\]). At small X it is X - X^2/2.
    ///
    /// NaN where det(I + X/2) <= 0, the way through the step being inside out half way: laws report
    /// [`Breakdown::NotFinite`], if not [`Breakdown::InvertedVolume`]. A half turn in one step is such a motion.
    #[inline(always)]
    pub fn increments(&self) -> Increments<L> {
        // With H = X/2 = S + W: A = 2 [H - adj H + (tr adj H + det H) I] / det(I + H), a sum of terms of the size of
        // what they make, by the theorem of Cayley and Hamilton; adj H = adj S + w w^T - (S w cross).
        let (half, quarter) = (L::of(0.5), L::of(0.25));
        let x = &self.increment.0;
        let (xx, yy, zz) = (x[0][0] * half, x[1][1] * half, x[2][2] * half);
        let yz = (x[1][2] + x[2][1]) * quarter;
        let xz = (x[0][2] + x[2][0]) * quarter;
        let xy = (x[0][1] + x[1][0]) * quarter;
        let wx = (x[2][1] - x[1][2]) * quarter;
        let wy = (x[0][2] - x[2][0]) * quarter;
        let wz = (x[1][0] - x[0][1]) * quarter;
        // S w.
        let sx = xx.mul_add(wx, xy.mul_add(wy, xz * wz));
        let sy = xy.mul_add(wx, yy.mul_add(wy, yz * wz));
        let sz = xz.mul_add(wx, yz.mul_add(wy, zz * wz));
        // adj S, and the symmetric part of adj H.
        let (axx, axy, axz) = (minor(yy, yz, yz, zz), minor(xz, xy, zz, yz), minor(xy, xz, yy, yz));
        let bxx = wx.mul_add(wx, axx);
        let byy = wy.mul_add(wy, minor(xx, xz, xz, zz));
        let bzz = wz.mul_add(wz, minor(xx, xy, xy, yy));
        let byz = wy.mul_add(wz, minor(xy, xx, yz, xz));
        let bxz = wx.mul_add(wz, axz);
        let bxy = wx.mul_add(wy, axy);
        let turning = wx.mul_add(sx, wy.mul_add(sy, wz * sz));
        let determinant = xx.mul_add(axx, xy.mul_add(axy, xz.mul_add(axz, turning)));
        let (trace, minors) = (xx + yy + zz, bxx + byy + bzz);
        let isotropic = minors + determinant;
        let half_way = L::one() + (trace + isotropic);
        let scale = L::select(half_way.gt(L::zero()), L::of(2.0) / half_way, L::of(f64::NAN));
        // det(I + 2 H).
        let change = L::of(8.0).mul_add(determinant, L::of(4.0).mul_add(minors, trace + trace));
        Increments {
            strain: Sym3([
                (xx + (isotropic - bxx)) * scale,
                (yy + (isotropic - byy)) * scale,
                (zz + (isotropic - bzz)) * scale,
                (yz - byz) * scale,
                (xz - bxz) * scale,
                (xy - bxy) * scale,
            ]),
            spin: [(wx + sx) * scale, (wy + sy) * scale, (wz + sz) * scale],
            volume_factor: L::one() + change,
        }
    }
    /// Strain increment of the middle of the step: [`Kinematics::increments`].
    #[inline(always)]
    pub fn strain(&self) -> Sym3<L> {
        self.increments().strain
    }
    /// Axial vector of the spin increment of the middle of the step: [`Kinematics::increments`].
    #[inline(always)]
    pub fn spin(&self) -> [L; 3] {
        self.increments().spin
    }
    /// Relative change of volume, exact for the increment: det(I + increment). Positive unless the step turns
    /// the point inside out.
    #[inline(always)]
    pub fn volume_factor(&self) -> L {
        // Off the diagonal there is nothing to add: additions of zero would be made.
        let mut gradient = self.increment;
        for i in 0..3 {
            gradient.0[i][i] = gradient.0[i][i] + L::one();
        }
        gradient.determinant()
    }
}

/// The increment of a displacement gradient scaled so that det(I + increment) = `ratio`, which it nearly is: for methods that take the
/// change of volume from elsewhere.
#[inline(always)]
pub fn with_volume<L: Lane>(increment: &Mat3<L>, ratio: L) -> Mat3<L> {
    let whole = *increment + Mat3::identity();
    let wanted = ratio / whole.determinant();
    // Cube root of a number near one: three steps of Newton's method from the first-order value.
    let third = L::of(1.0 / 3.0);
    let mut root = (wanted - L::one()).mul_add(third, L::one());
    for _ in 0..3 {
        let square = root * root;
        root = root - (root * square - wanted) / (square + square + square);
    }
    let mut scaled = whole * root;
    for i in 0..3 {
        scaled.0[i][i] = scaled.0[i][i] - L::one();
    }
    scaled
}

/// a d - b c.
#[inline(always)]
fn minor<L: Lane>(a: L, b: L, c: L, d: L) -> L {
    (-b).mul_add(c, a * d)
}

/// What a point remembers between steps: a fixed list of numbers with names.
///
/// Implemented for a single number, [`Sym3`], [`Mat3`], a [`Pair`], and [`Nothing`], which takes no memory at all; the
/// [`state!`](crate::state) macro makes a named record of these.
pub trait State<L: Lane>: Copy + fmt::Debug {
    /// How many numbers.
    const LEN: usize;
    /// Read all numbers, in order.
    fn read(from: &mut impl Source<L>) -> Self;
    /// Write all numbers, in the same order.
    fn write(&self, to: &mut impl Sink<L>);
    /// Append the `LEN` names, in the same order, to `list`; `name` is what the owner calls this part.
    fn names(name: &str, list: &mut Vec<String>);
}

/// Where a [`State`] is read from.
pub trait Source<L> {
    /// The next number.
    fn take(&mut self) -> L;
}

/// Where a [`State`] is written to.
pub trait Sink<L> {
    /// Append a number.
    fn put(&mut self, value: L);
}

/// What a part of a law remembers that remembers nothing: no number, no memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Nothing;

impl<L: Lane> State<L> for Nothing {
    const LEN: usize = 0;
    #[inline(always)]
    fn read(_: &mut impl Source<L>) -> Self {
        Nothing
    }
    #[inline(always)]
    fn write(&self, _: &mut impl Sink<L>) {}
    fn names(_: &str, _: &mut Vec<String>) {}
}

impl<L: Lane> State<L> for L {
    const LEN: usize = 1;
    #[inline(always)]
    fn read(from: &mut impl Source<L>) -> Self {
        from.take()
    }
    #[inline(always)]
    fn write(&self, to: &mut impl Sink<L>) {
        to.put(*self);
    }
    fn names(name: &str, list: &mut Vec<String>) {
        list.push(name.into());
    }
}

impl<L: Lane> State<L> for Sym3<L> {
    const LEN: usize = 6;
    #[inline(always)]
    fn read(from: &mut impl Source<L>) -> Self {
        Sym3([from.take(), from.take(), from.take(), from.take(), from.take(), from.take()])
    }
    #[inline(always)]
    fn write(&self, to: &mut impl Sink<L>) {
        for i in 0..6 {
            to.put(self.0[i]);
        }
    }
    fn names(name: &str, list: &mut Vec<String>) {
        list.extend(["xx", "yy", "zz", "yz", "xz", "xy"].map(|c| format!("{name}_{c}")));
    }
}

impl<L: Lane> State<L> for Mat3<L> {
    const LEN: usize = 9;
    #[inline(always)]
    fn read(from: &mut impl Source<L>) -> Self {
        Mat3([
            [from.take(), from.take(), from.take()],
            [from.take(), from.take(), from.take()],
            [from.take(), from.take(), from.take()],
        ])
    }
    #[inline(always)]
    fn write(&self, to: &mut impl Sink<L>) {
        for i in 0..3 {
            for j in 0..3 {
                to.put(self.0[i][j]);
            }
        }
    }
    fn names(name: &str, list: &mut Vec<String>) {
        for i in ["x", "y", "z"] {
            list.extend(["x", "y", "z"].map(|j| format!("{name}_{i}{j}")));
        }
    }
}

/// Two parts of a state, one behind the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pair<A, B>(
    /// The first.
    pub A,
    /// The second.
    pub B,
);

impl<L: Lane, A: State<L>, B: State<L>> State<L> for Pair<A, B> {
    const LEN: usize = A::LEN + B::LEN;
    #[inline(always)]
    fn read(from: &mut impl Source<L>) -> Self {
        let a = A::read(from);
        Pair(a, B::read(from))
    }
    #[inline(always)]
    fn write(&self, to: &mut impl Sink<L>) {
        self.0.write(to);
        self.1.write(to);
    }
    fn names(name: &str, list: &mut Vec<String>) {
        A::names(name, list);
        B::names(name, list);
    }
}

/// Declare what a law remembers: a record of parts that are themselves [`State`]s, generic over the lane `L`.
///
/// ```
/// use mpm_materials::{Sym3, state};
/// state! {
///     /// State of a hardening solid.
///     pub struct Hardening<L> {
///         /// Cauchy stress, Pa.
///         pub stress: Sym3<L>,
///         /// Accumulated plastic strain.
///         pub plastic_strain: L,
///     }
/// }
/// ```
#[macro_export]
macro_rules! state {
    ($(#[$meta:meta])* $vis:vis struct $name:ident<$l:ident $(, $g:ident)*> {
        $($(#[$fmeta:meta])* $fvis:vis $field:ident: $t:ty),* $(,)?
    }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $vis struct $name<$l $(, $g)*> { $($(#[$fmeta])* $fvis $field: $t),* }
        impl<$l: $crate::Lane $(, $g: $crate::State<$l>)*> $crate::State<$l> for $name<$l $(, $g)*> {
            const LEN: usize = 0 $(+ <$t as $crate::State<$l>>::LEN)*;
            #[inline(always)]
            fn read(from: &mut impl $crate::Source<$l>) -> Self {
                // Fields of a struct expression are evaluated in the order written.
                Self { $($field: <$t as $crate::State<$l>>::read(from)),* }
            }
            #[inline(always)]
            fn write(&self, to: &mut impl $crate::Sink<$l>) {
                $(<$t as $crate::State<$l>>::write(&self.$field, to);)*
            }
            fn names(_: &str, list: &mut Vec<String>) {
                $(<$t as $crate::State<$l>>::names(stringify!($field), list);)*
            }
        }
    };
}

/// Why a point can no longer be computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[repr(u8)]
pub enum Breakdown {
    /// The step turns the point inside out: det(I + dt grad v) <= 0, or det F <= 0.
    #[error("the volume became zero or negative")]
    InvertedVolume = 1,
    /// A stress, energy or velocity is infinite or not a number.
    #[error("a value became infinite or not a number")]
    NotFinite = 2,
    /// The squared sound speed is negative: the state is unstable.
    #[error("the squared sound speed became negative")]
    NoSoundSpeed = 3,
    /// A law's own iteration found no solution.
    #[error("the law's iteration did not converge")]
    NotConverged = 4,
    /// A cause that belongs to one law; its documentation says which.
    #[error("the law reported a breakdown of its own")]
    Law = 5,
}

impl Breakdown {
    const ALL: [Breakdown; 5] = [
        Breakdown::InvertedVolume,
        Breakdown::NotFinite,
        Breakdown::NoSoundSpeed,
        Breakdown::NotConverged,
        Breakdown::Law,
    ];
}

/// The first [`Breakdown`] of each lane, if any. Costs one selection a check and no branch.
#[derive(Clone, Copy, Debug)]
pub struct Fault<L>(L);

impl<L: Lane> Fault<L> {
    /// No breakdown in any lane.
    #[inline(always)]
    pub fn none() -> Self {
        Fault(L::zero())
    }
    /// `cause` in the lanes where `holds` is false and nothing broke before. Write the condition so that it is
    /// false for a value that is not a number.
    #[inline(always)]
    pub fn require(self, holds: L::Mask, cause: Breakdown) -> Self {
        let first = L::select(self.0.gt(L::zero()), self.0, L::of(cause as u8 as f64));
        Fault(L::select(holds, self.0, first))
    }
    /// The earlier fault where there is one, else `later`.
    #[inline(always)]
    pub fn or(self, later: Self) -> Self {
        Fault(L::select(self.0.gt(L::zero()), self.0, later.0))
    }
    /// Did some lane break?
    #[inline(always)]
    pub fn any(self) -> bool {
        self.0.gt(L::zero()).any()
    }
    /// What broke in lane `i`.
    pub fn cause(self, i: usize) -> Option<Breakdown> {
        let code = self.0.lane(i).to_double() as usize;
        Breakdown::ALL.get(code.wrapping_sub(1)).copied()
    }
}

/// The result of a law at a point: what it now remembers, and the Cauchy stress that goes into the forces.
#[derive(Clone, Copy, Debug)]
pub struct Update<L, S> {
    /// The new state.
    pub state: S,
    /// Cauchy stress, Pa, tension positive.
    pub stress: Sym3<L>,
    /// The lanes that broke down; their state and stress mean nothing.
    pub fault: Fault<L>,
}

/// A constitutive law: pure, three-dimensional, one point at a time.
///
/// `update` maps (law, kinematics, old state) to the new state and stress. It keeps nothing and reads nothing
/// else, so that the same call gives the same bits, and a step can be tried and rejected. What the law needs
/// to remember is its own typed [`State`]: a hypoelastic law keeps the stress and the volume ratio, a
/// hyperelastic one the deformation gradient. A number that is not one must be reported ([`Fault`]) in the motion and wherever the
/// law reads it in the old state; what a state only holds for others to see may be anything.
///
/// Its `Debug` shows all its constants: checkpoints compare them.
pub trait Constitutive<T: Real>: std::fmt::Debug + Clone + Send + Sync + 'static {
    /// What a point remembers.
    type State<L: Lane<Real = T>>: State<L>;

    /// The law's name, for messages.
    fn name(&self) -> &'static str;

    /// Reference density rho0, kg/m^3; a point of mass `m` has reference volume `m / rho0`.
    fn density(&self) -> T;

    /// The state of a stress-free point at reference density.
    fn virgin(&self) -> Self::State<T::Single>;

    /// One step.
    fn update<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
    ) -> Update<L, Self::State<L>>;

    /// Cauchy stress of a state, Pa.
    fn stress<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> Sym3<L>;

    /// Volume over reference volume, J = rho0 / rho.
    fn volume_ratio<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L;

    /// Speed of the fastest (longitudinal) wave, m/s.
    fn wave_speed<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L;

    /// The speed that the time step is held by in a cell or element of `length`, m: dt below about length over it, m/s. That of waves,
    /// of laws that do not say. A law whose stress follows the rate of strain adds what diffuses, 8 nu / (3 length) for the
    /// kinematic viscosity nu: explicit steps are stable below 3 length^2 / (8 nu), by its longitudinal part, 4/3 nu.
    #[inline(always)]
    fn step_speed<L: Lane<Real = T>>(&self, now: &Self::State<L>, length: L) -> L {
        let _ = length;
        self.wave_speed(now)
    }

    /// Internal energy per reference volume, J/m^3: stored and dissipated work since the virgin state.
    fn energy<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L;

    /// Is the state within the range of the data that the law was made for? False where its equation of state is
    /// continued, at densities beyond [`Eos::smallest_volume_ratio`](crate::Eos::smallest_volume_ratio), so that a run can
    /// tell how many points are there. True of laws that do not say.
    #[inline(always)]
    fn in_range<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L::Mask {
        let _ = now;
        L::zero().le(L::zero())
    }

    /// Where has the point failed, so that it no longer carries what it did? Nowhere, of laws that do not say.
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L::Mask {
        let _ = now;
        L::Mask::splat(false)
    }

    /// One state for points that become one, each with its mass, kg; none where they are too unlike, or where the law
    /// has no such state. Volume ratio and internal energy of what is returned are the means by mass, to rounding: no
    /// volume and no energy is lost. A law that does not say so never merges.
    fn merged(&self, points: &[(f64, Self::State<T::Single>)]) -> Option<Self::State<T::Single>> {
        let _ = points;
        None
    }

    /// Does the law know the heat of its viscosity apart from the rest of its energy? [`Constitutive::viscous_heat`] is zero otherwise.
    fn has_viscous_heat(&self) -> bool {
        false
    }

    /// Heat of viscosity per reference volume, J/m^3, which is part of [`Constitutive::energy`].
    #[inline(always)]
    fn viscous_heat<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        let _ = now;
        L::zero()
    }

    /// What bulk viscosity stiffens a closing point by, \[b1 c in m/s, b0\]
    /// ([`ShockViscosity::coefficients`](crate::ShockViscosity::coefficients)); zeros of laws without.
    fn shock_viscosity(&self) -> [T; 2] {
        [T::default(); 2]
    }

    /// Is the stress across the plane zero, as of [`PlaneStress`](crate::PlaneStress)? Methods are named by it.
    fn is_plane_stress(&self) -> bool {
        false
    }

    /// Where a state keeps the accumulated stretch, if it does, as [`Stretches`](crate::Stretches) says.
    fn stretch_place(&self) -> Option<usize> {
        None
    }

    /// The law with kernels that are compiled where this is written, for some seconds: what scenes take of a law whose kernels
    /// are not compiled in this crate ([`IntoMaterial`](crate::IntoMaterial)).
    fn compiled(self) -> CompiledHere<Self> {
        CompiledHere(self)
    }
}

/// The result of a law written for a single point.
pub type PointResult<T, S> = Result<(S, Sym3<T>), Breakdown>;

/// Run a law's single-point text on every lane in turn: what `update` calls in a law whose branches or
/// iterations cannot be written with [`Lane::select`].
///
/// `one` gets the kinematics and state of one point and returns the new state and stress, or what broke.
pub fn pointwise<T, L, S1, SL>(
    kinematics: &Kinematics<L>,
    old: &SL,
    mut one: impl FnMut(&Kinematics<T::Single>, &S1) -> PointResult<T::Single, S1>,
) -> Update<L, SL>
where
    T: Real,
    L: Lane<Real = T>,
    S1: State<T::Single>,
    SL: State<L>,
{
    let mut state = Buffer { values: flatten(old), at: 0 };
    let mut stress: Sym3<L> = Sym3::zero();
    let mut fault = Fault::none();
    for i in 0..L::WIDTH {
        let increment = Mat3(std::array::from_fn(|r| {
            std::array::from_fn(|c| kinematics.increment.0[r][c].lane(i).into())
        }));
        let point = Kinematics {
            increment,
            dt: kinematics.dt.lane(i).into(),
            length: kinematics.length.lane(i).into(),
        };
        match one(&point, &lane_of(old, i)) {
            Ok((new, sigma)) => {
                let numbers: Vec<T::Single> = flatten(&new);
                for (k, v) in numbers.into_iter().enumerate() {
                    state.values[k] = state.values[k].with_lane(i, v.into());
                }
                for k in 0..6 {
                    stress.0[k] = stress.0[k].with_lane(i, sigma.0[k].into());
                }
            }
            Err(cause) => {
                let healthy = L::one().with_lane(i, T::default());
                fault = fault.require(healthy.gt(L::zero()), cause);
            }
        }
    }
    Update { state: SL::read(&mut state), stress, fault }
}

/// The state of lane `i`.
pub fn lane_of<T, L, S1, SL>(state: &SL, i: usize) -> S1
where
    T: Real,
    L: Lane<Real = T>,
    S1: State<T::Single>,
    SL: State<L>,
{
    let values = flatten(state).into_iter().map(|v| v.lane(i).into()).collect();
    S1::read(&mut Buffer { values, at: 0 })
}

/// The same single-point state in every lane.
pub fn spread<T, L, S1, SL>(state: &S1) -> SL
where
    T: Real,
    L: Lane<Real = T>,
    S1: State<T::Single>,
    SL: State<L>,
{
    let values = flatten(state).into_iter().map(|v: T::Single| L::splat(v.into())).collect();
    SL::read(&mut Buffer { values, at: 0 })
}

/// The numbers of a state, in order.
pub fn flatten<L: Lane, S: State<L>>(state: &S) -> Vec<L> {
    let mut list = Buffer { values: Vec::with_capacity(S::LEN), at: 0 };
    state.write(&mut list);
    list.values
}

/// The state with these numbers; `values` must hold `S::LEN` of them.
///
/// # Errors
/// The number of values given, if it is not `S::LEN`.
pub fn unflatten<L: Lane, S: State<L>>(values: &[L]) -> Result<S, usize> {
    if values.len() != S::LEN {
        return Err(values.len());
    }
    Ok(S::read(&mut Buffer { values: values.to_vec(), at: 0 }))
}

/// Number by number the mean of states, each with its weight.
pub fn mean<T: Real, S: State<T::Single>>(points: impl Iterator<Item = (f64, S)>) -> S {
    let mut sums = vec![0.0; S::LEN];
    let mut weights = 0.0;
    for (weight, state) in points {
        weights += weight;
        for (sum, x) in sums.iter_mut().zip(flatten::<T::Single, S>(&state)) {
            let x: T = x.into();
            *sum += weight * x.to_double();
        }
    }
    // Equal numbers stay what they are where weights and sums are exact: flags do.
    let values = sums.into_iter().map(|sum| T::of(sum / weights).into()).collect();
    S::read(&mut Buffer { values, at: 0 })
}

/// Are all of these within `within` of `middle`?
pub(crate) fn alike(mut numbers: impl Iterator<Item = f64>, middle: f64, within: f64) -> bool {
    numbers.all(|x| (x - middle).abs() <= within)
}

struct Buffer<L> {
    values: Vec<L>,
    at: usize,
}
impl<L: Lane> Source<L> for Buffer<L> {
    fn take(&mut self) -> L {
        self.at += 1;
        self.values[self.at - 1]
    }
}
impl<L> Sink<L> for Buffer<L> {
    fn put(&mut self, value: L) {
        self.values.push(value);
    }
}

/// A point whose law broke down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Broken {
    /// Which lane.
    pub lane: usize,
    /// Why.
    pub cause: Breakdown,
}

/// The first broken lane of an update, if any.
pub fn first_broken<L: Lane, S>(update: &Update<L, S>) -> Option<Broken> {
    (0..L::WIDTH).find_map(|lane| update.fault.cause(lane).map(|cause| Broken { lane, cause }))
}

/// Is every component of the stress a finite number?
#[inline(always)]
pub fn finite_stress<L: Lane>(stress: &Sym3<L>) -> L::Mask {
    // One infinity or NaN spoils the sum.
    let s = &stress.0;
    (s[0] + s[1] + s[2] + s[3] + s[4] + s[5]).is_finite()
}

/// Is every number of the state finite?
#[inline(always)]
pub fn finite_state<L: Lane, S: State<L>>(state: &S) -> L::Mask {
    // One infinity or NaN spoils the sum. Two of them side by side, which wait half as long.
    let mut sums = Sums { one: L::zero(), other: L::zero() };
    state.write(&mut sums);
    (sums.one + sums.other).is_finite()
}

/// Sums of every other number.
struct Sums<L> {
    one: L,
    other: L,
}

impl<L: Lane> Sink<L> for Sums<L> {
    #[inline(always)]
    fn put(&mut self, value: L) {
        (self.one, self.other) = (self.other, self.one + value);
    }
}

/// The number of a state that bears this name, see [`State::names`].
pub fn named<L: Lane, S: State<L>>(state: &S, name: &str) -> Option<L> {
    let mut names = Vec::with_capacity(S::LEN);
    S::names("", &mut names);
    let at = names.iter().position(|n| n == name)?;
    flatten(state).get(at).copied()
}

/// Strain, spin and change of volume of a step.
#[derive(Clone, Copy, Debug)]
pub struct Increments<L> {
    /// Strain increment, dimensionless.
    pub strain: Sym3<L>,
    /// Axial vector of the spin increment W, dimensionless: `W x = spin cross x`.
    pub spin: [L; 3],
    /// Change of volume, det(I + X): [`Kinematics::volume_factor`].
    pub volume_factor: L,
}

/// A law whose kernels are compiled where it is used: [`Constitutive::compiled`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompiledHere<C>(pub(crate) C);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_volume_is_met_to_rounding() {
        let increment = Mat3([[0.01, -0.05, 0.0], [0.05, -0.02, 0.0], [0.0, 0.0, 0.003]]);
        for ratio in [0.9, 1.0, 1.1] {
            let det = (with_volume(&increment, ratio) + Mat3::identity()).determinant();
            // The first-order root is off by e^2/9, and each step of Newton's method squares that.
            assert!((det - ratio).abs() < 1e-15, "{det} for {ratio}");
        }
    }
}
