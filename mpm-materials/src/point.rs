//! Material point: strain increment and strain rate of a step, state variables, result of a law, breakdown.

use std::fmt;

use crate::lane::{Lane, Mask, Real};
use crate::tensor::{Mat3, Sym3};

/// Kinematics of a point in one step.
#[derive(Clone, Copy, Debug)]
pub struct Kinematics<L> {
    /// Displacement-gradient increment, dt grad v (dimensionless): row `i`, column `j` is dt dv_i/dx_j.
    pub increment: Mat3<L>,
    /// Time step dt > 0, s. (A lane that must not change has `increment` zero.)
    pub dt: L,
    /// Size of the element or cell of the point, m: the length in bulk viscosity and in the regularisation of
    /// softening.
    pub length: L,
}

impl<L: Lane> Kinematics<L> {
    /// Return volume factor, strain increment and spin increment: determinant of I + X, and symmetric and antisymmetric
    /// part of A = X (I + X/2)^-1, with X the `increment`. A is the displacement gradient with respect to the midpoint
    /// configuration and exactly antisymmetric for a rotation, X = R - I (\[HughesWinget1980\]). At small X it is
    /// X - X^2/2.
    ///
    /// NaN if det(I + X/2) <= 0, an inverted midpoint configuration: laws report [`Breakdown::NotFinite`], if not
    /// [`Breakdown::InvertedVolume`]. A half turn in one step is such a motion.
    #[inline(always)]
    pub fn increments(&self) -> Increments<L> {
        // With H = X/2 = S + W: A = 2 [H - adj H + (tr adj H + det H) I] / det(I + H), by the Cayley-Hamilton theorem,
        // a sum without cancellation; adj H = adj S + w w^T - (S w cross).
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
    /// Midpoint strain increment: [`Kinematics::increments`].
    #[inline(always)]
    pub fn strain(&self) -> Sym3<L> {
        self.increments().strain
    }
    /// Axial vector of the midpoint spin increment: [`Kinematics::increments`].
    #[inline(always)]
    pub fn spin(&self) -> [L; 3] {
        self.increments().spin
    }
    /// Volume factor of the step, exact for the increment: det(I + increment). Positive unless the step inverts the
    /// point.
    #[inline(always)]
    pub fn volume_factor(&self) -> L {
        // Add to the diagonal only: additions of zero are not optimised away.
        let mut gradient = self.increment;
        for i in 0..3 {
            gradient.0[i][i] = gradient.0[i][i] + L::one();
        }
        gradient.determinant()
    }
}

/// Scale a displacement-gradient increment so that det(I + increment) = `ratio`, which must be close to its
/// determinant: for methods that compute the volume change separately.
#[inline(always)]
pub fn with_volume<L: Lane>(increment: &Mat3<L>, ratio: L) -> Mat3<L> {
    let whole = *increment + Mat3::identity();
    let wanted = ratio / whole.determinant();
    // Cube root of a number near one: three Newton steps from the first-order value.
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

/// Determinant a d - b c.
#[inline(always)]
fn minor<L: Lane>(a: L, b: L, c: L, d: L) -> L {
    (-b).mul_add(c, a * d)
}

/// State variables of a material point: a fixed list of named numbers.
///
/// Implemented for a single number, [`Sym3`], [`Mat3`], a [`Pair`], and [`Nothing`], which needs no memory; the
/// [`state!`](crate::state) macro defines a named record of these.
pub trait State<L: Lane>: Copy + fmt::Debug {
    /// Number of state variables.
    const LEN: usize;
    /// Read all numbers, in order.
    fn read(from: &mut impl Source<L>) -> Self;
    /// Write all numbers, in the same order.
    fn write(&self, to: &mut impl Sink<L>);
    /// Append the `LEN` names, in the same order, to `list`; `name` is the name of this part in its owner.
    fn names(name: &str, list: &mut Vec<String>);
}

/// Source from which a [`State`] is read.
pub trait Source<L> {
    /// Read the next number.
    fn take(&mut self) -> L;
}

/// Sink to which a [`State`] is written.
pub trait Sink<L> {
    /// Append a number.
    fn put(&mut self, value: L);
}

/// Empty state: no number, no memory.
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

/// Two consecutive parts of a state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pair<A, B>(
    /// First part.
    pub A,
    /// Second part.
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

/// Declare the state variables of a law: a record of parts that implement [`State`], generic over the lane `L`.
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

/// Cause of a breakdown, after which a point can no longer be computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[repr(u8)]
pub enum Breakdown {
    /// Inverted volume: det(I + dt grad v) <= 0, or det F <= 0.
    #[error("the volume became zero or negative")]
    InvertedVolume = 1,
    /// Infinite or NaN stress, energy or velocity.
    #[error("a value became infinite or not a number")]
    NotFinite = 2,
    /// Negative squared sound speed: the state is unstable.
    #[error("the squared sound speed became negative")]
    NoSoundSpeed = 3,
    /// Iteration of a law without convergence.
    #[error("the law's iteration did not converge")]
    NotConverged = 4,
    /// Cause specific to one law, given in its documentation.
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

/// First [`Breakdown`] of each lane, if any. A check costs one selection and no branch.
#[derive(Clone, Copy, Debug)]
pub struct Fault<L>(L);

impl<L: Lane> Fault<L> {
    /// No breakdown in any lane.
    #[inline(always)]
    pub fn none() -> Self {
        Fault(L::zero())
    }
    /// Set `cause` in the lanes where `holds` is false and that have no earlier fault. Write the condition so that it
    /// is false for NaN.
    #[inline(always)]
    pub fn require(self, holds: L::Mask, cause: Breakdown) -> Self {
        let first = L::select(self.0.gt(L::zero()), self.0, L::of(cause as u8 as f64));
        Fault(L::select(holds, self.0, first))
    }
    /// Keep the earlier fault of each lane, if any, else take `later`.
    #[inline(always)]
    pub fn or(self, later: Self) -> Self {
        Fault(L::select(self.0.gt(L::zero()), self.0, later.0))
    }
    /// True if any lane broke down.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.0.gt(L::zero()).any()
    }
    /// Return the breakdown of lane `i`, if any.
    pub fn cause(self, i: usize) -> Option<Breakdown> {
        let code = self.0.lane(i).to_double() as usize;
        Breakdown::ALL.get(code.wrapping_sub(1)).copied()
    }
}

/// Result of a law at a point: new state variables and the Cauchy stress for the internal force.
#[derive(Clone, Copy, Debug)]
pub struct Update<L, S> {
    /// The new state.
    pub state: S,
    /// Cauchy stress, Pa, tension positive.
    pub stress: Sym3<L>,
    /// Lanes that broke down; their state and stress are meaningless.
    pub fault: Fault<L>,
}

/// Constitutive law: a pure function of one point in three dimensions.
///
/// `update` maps (law, kinematics, old state) to the new state and stress. It has no other input and no side effect:
/// the same call returns the same bits, and a step can be tried and rejected. The state variables of a law are its own
/// typed [`State`]: stress and volume ratio of a hypoelastic law, deformation gradient of a hyperelastic one. A law
/// must report NaN ([`Fault`]) in the motion and in every state variable that it reads; variables for output only may
/// be anything.
///
/// Its `Debug` shows all its constants: checkpoints compare them.
pub trait Constitutive<T: Real>: std::fmt::Debug + Clone + Send + Sync + 'static {
    /// State variables of a point.
    type State<L: Lane<Real = T>>: State<L>;

    /// The law's name, for messages.
    fn name(&self) -> &'static str;

    /// Reference density rho0, kg/m^3; a point of mass `m` has reference volume `m / rho0`.
    fn density(&self) -> T;

    /// Return the state of a virgin point at reference density.
    fn virgin(&self) -> Self::State<T::Single>;

    /// Update the state by one step.
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

    /// Speed for the time step limit in a cell or element of `length`, m: dt below about length over it, m/s. Default:
    /// [`Constitutive::wave_speed`]. A law with viscous stress adds the diffusion speed 8 nu / (3 length) for the
    /// kinematic viscosity nu: explicit steps are stable below 3 length^2 / (8 nu), by the longitudinal viscosity,
    /// 4/3 nu.
    #[inline(always)]
    fn step_speed<L: Lane<Real = T>>(&self, now: &Self::State<L>, length: L) -> L {
        let _ = length;
        self.wave_speed(now)
    }

    /// Internal energy per reference volume, J/m^3: stored and dissipated work since the virgin state.
    fn energy<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L;

    /// True if the state is within the data range of the law. False where the equation of state is extrapolated, at
    /// densities beyond [`Eos::smallest_volume_ratio`](crate::Eos::smallest_volume_ratio), so that a run can count such
    /// points. Default: true.
    #[inline(always)]
    fn in_range<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L::Mask {
        let _ = now;
        L::zero().le(L::zero())
    }

    /// True if the point has failed and lost load capacity. Default: false.
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L::Mask {
        let _ = now;
        L::Mask::splat(false)
    }

    /// Merge the states of points, each with its mass, kg, into one; `None` if they differ too much, or if the law has
    /// no merged state. Volume ratio and internal energy of the result are mass-weighted means, to rounding, so that
    /// volume and energy are conserved. Default: `None`.
    fn merged(&self, points: &[(f64, Self::State<T::Single>)]) -> Option<Self::State<T::Single>> {
        let _ = points;
        None
    }

    /// Bit mask of the state variables that are stored, the first in the lowest bit; the others are zero at all times. All
    /// are stored unless the parts of a law are chosen at run time ([`AnySolid`](crate::AnySolid)).
    #[inline(always)]
    fn stored(&self) -> u64 {
        u64::MAX
    }

    /// True if the law tracks viscous heat separately; [`Constitutive::viscous_heat`] is zero otherwise.
    fn has_viscous_heat(&self) -> bool {
        false
    }

    /// Viscous heat per reference volume, J/m^3, a part of [`Constitutive::energy`].
    #[inline(always)]
    fn viscous_heat<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        let _ = now;
        L::zero()
    }

    /// Bulk viscosity coefficients for the time step limit, \[b1 c in m/s, b0\]
    /// ([`ShockViscosity::coefficients`](crate::ShockViscosity::coefficients)); zeros without bulk viscosity.
    fn shock_viscosity(&self) -> [T; 2] {
        [T::default(); 2]
    }

    /// True if the out-of-plane stress is zero, as of [`PlaneStress`](crate::PlaneStress); names of methods depend on
    /// it.
    fn is_plane_stress(&self) -> bool {
        false
    }

    /// Index of the accumulated stretch in a state, if stored; see [`Stretches`](crate::Stretches).
    fn stretch_place(&self) -> Option<usize> {
        None
    }

    /// Mark the law for compilation of its kernels in the calling crate, some seconds: required in scenes for a law
    /// whose kernels are not compiled in this crate ([`IntoMaterial`](crate::IntoMaterial)).
    fn compiled(self) -> CompiledHere<Self> {
        CompiledHere(self)
    }
}

/// Result of a law written for a single point.
pub type PointResult<T, S> = Result<(S, Sym3<T>), Breakdown>;

/// Run single-point code on every lane in turn, for the `update` of a law whose branches or iterations cannot be
/// written with [`Lane::select`].
///
/// `one` maps the kinematics and state of one point to the new state and stress, or to the breakdown.
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

/// Return the state of lane `i`.
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

/// Broadcast a single-point state to every lane.
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

/// Return the numbers of a state, in order.
pub fn flatten<L: Lane, S: State<L>>(state: &S) -> Vec<L> {
    let mut list = Buffer { values: Vec::with_capacity(S::LEN), at: 0 };
    state.write(&mut list);
    list.values
}

/// Build a state from its `S::LEN` numbers.
///
/// # Errors
/// The number of values, if it is not `S::LEN`.
pub fn unflatten<L: Lane, S: State<L>>(values: &[L]) -> Result<S, usize> {
    if values.len() != S::LEN {
        return Err(values.len());
    }
    Ok(S::read(&mut Buffer { values: values.to_vec(), at: 0 }))
}

/// Weighted mean of states, number by number.
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
    // The mean of equal numbers, such as flags, is exact if weights and sums are exact.
    let values = sums.into_iter().map(|sum| T::of(sum / weights).into()).collect();
    S::read(&mut Buffer { values, at: 0 })
}

/// True if all numbers are within `within` of `middle`.
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
    /// Lane of the point.
    pub lane: usize,
    /// Cause of the breakdown.
    pub cause: Breakdown,
}

/// Return the first broken lane of an update, if any.
pub fn first_broken<L: Lane, S>(update: &Update<L, S>) -> Option<Broken> {
    (0..L::WIDTH).find_map(|lane| update.fault.cause(lane).map(|cause| Broken { lane, cause }))
}

/// True if every stress component is finite.
#[inline(always)]
pub fn finite_stress<L: Lane>(stress: &Sym3<L>) -> L::Mask {
    // The sum is not finite if any term is infinite or NaN.
    let s = &stress.0;
    (s[0] + s[1] + s[2] + s[3] + s[4] + s[5]).is_finite()
}

/// True if every number of the state is finite.
#[inline(always)]
pub fn finite_state<L: Lane, S: State<L>>(state: &S) -> L::Mask {
    // The sum is not finite if any term is infinite or NaN. Two interleaved sums halve the latency.
    let mut sums = Sums { one: L::zero(), other: L::zero() };
    state.write(&mut sums);
    (sums.one + sums.other).is_finite()
}

/// Two interleaved sums.
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

/// Return the number of a state by name, see [`State::names`].
pub fn named<L: Lane, S: State<L>>(state: &S, name: &str) -> Option<L> {
    let mut names = Vec::with_capacity(S::LEN);
    S::names("", &mut names);
    let at = names.iter().position(|n| n == name)?;
    flatten(state).get(at).copied()
}

/// Strain increment, spin increment and volume factor of a step.
#[derive(Clone, Copy, Debug)]
pub struct Increments<L> {
    /// Strain increment, dimensionless.
    pub strain: Sym3<L>,
    /// Axial vector of the spin increment W, dimensionless: `W x = spin cross x`.
    pub spin: [L; 3],
    /// Volume factor, det(I + X): [`Kinematics::volume_factor`].
    pub volume_factor: L,
}

/// Law whose kernels are compiled in the calling crate: [`Constitutive::compiled`].
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
            // The error of the first-order root is e^2/9, and each Newton step squares it.
            assert!((det - ratio).abs() < 1e-15, "{det} for {ratio}");
        }
    }
}
