//! Objective rates: strain and rotation of a step.

use crate::lane::Lane;
use crate::point::{Increments, Kinematics};
use crate::tensor::{Mat3, Sym3};

/// Objective rate: splits the motion of a step into strain and rotation, and rotates a symmetric tensor.
///
/// ```
/// use mpm_materials::{HughesWinget, Kinematics, Mat3, ObjectiveRate, Sym3};
/// // A quarter turn about z in one step: X = R - I.
/// let increment = Mat3([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 0.0, 0.0]]);
/// let kinematics = Kinematics { increment, dt: 1.0e-6, length: 1.0e-3 };
/// let step = HughesWinget.increments(&kinematics);
/// assert_eq!(step.strain, Sym3::zero());
/// let turned: Sym3<f64> = HughesWinget.rotate(&step, &Sym3([1.0e6, 0.0, 0.0, 0.0, 0.0, 0.0]));
/// assert!((turned.0[1] - 1.0e6).abs() < 1.0e-9 && turned.0[0].abs() < 1.0e-9);
/// ```
pub trait ObjectiveRate: std::fmt::Debug + Copy + Send + Sync + 'static {
    /// Compute strain and spin of a step.
    fn increments<L: Lane>(&self, kinematics: &Kinematics<L>) -> Increments<L>;
    /// Rotate a tensor by the rotation of a step, without strain.
    fn rotate<L: Lane>(&self, step: &Increments<L>, tensor: &Sym3<L>) -> Sym3<L>;
}

/// Jaumann rate, exact for rotations of any size below half a turn per step (\[HughesWinget1980\]): strain e and spin W
/// are midpoint increments ([`Kinematics::increments`]). The tensor becomes Q s Q^T with the orthogonal
/// Q = (I - W/2)^-1 (I + W/2), and the strain e + (W e - e W) / 2, since the midpoint is half a rotation before the
/// end.
///
/// A pure rotation, X = R - I, has no strain and Q = R, to rounding. For combined rotation and strain the error is of
/// second order in the step over a path, and of third order in the angle between increments of stress and strain.
/// Without that half rotation stress increments lag and do work on a body that oscillates while it spins: its energy
/// grows exponentially.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HughesWinget;

impl ObjectiveRate for HughesWinget {
    #[inline(always)]
    fn increments<L: Lane>(&self, kinematics: &Kinematics<L>) -> Increments<L> {
        let middle = kinematics.increments();
        let half = L::of(0.5);
        Increments { strain: swung(middle.spin.map(|w| w * half), &middle.strain), ..middle }
    }
    #[inline(always)]
    fn rotate<L: Lane>(&self, step: &Increments<L>, tensor: &Sym3<L>) -> Sym3<L> {
        rotation(step.spin).congruence(tensor)
    }
}

/// Small-rotation increments: strain and spin are the symmetric and the antisymmetric part of X = dt grad v, with the
/// Jaumann rate to first order, s + W s - s W (eqs. 18 and 19 and section 1.2 of \[Ma2010\]). For bodies with little
/// rotation: some 40 instructions per particle and step fewer with AVX2.
///
/// Limits: a rotation by alpha in a step counts as a strain of -alpha^2/2 normal to the axis and stretches the tensor
/// by alpha^2, so that a spinning body accumulates stress without load. Keep the sum of alpha^2/2 over all steps far
/// below the strains of interest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SmallRotation;

impl ObjectiveRate for SmallRotation {
    #[inline(always)]
    fn increments<L: Lane>(&self, kinematics: &Kinematics<L>) -> Increments<L> {
        Increments {
            strain: kinematics.increment.symmetric(),
            spin: kinematics.increment.axial(),
            volume_factor: kinematics.volume_factor(),
        }
    }
    #[inline(always)]
    fn rotate<L: Lane>(&self, step: &Increments<L>, tensor: &Sym3<L>) -> Sym3<L> {
        swung(step.spin, tensor)
    }
}

/// Rotate a symmetric tensor by the small axial vector `w`: t + W t - t W.
#[inline(always)]
fn swung<L: Lane>(w: [L; 3], tensor: &Sym3<L>) -> Sym3<L> {
    let two = L::of(2.0);
    let [x, y, z] = w;
    let [xx, yy, zz, yz, xz, xy] = tensor.0;
    let (ax, ay, az) = (x * yz, y * xz, z * xy);
    let (dx, dy, dz) = (ay - az, az - ax, ax - ay);
    Sym3([
        dx.mul_add(two, xx),
        dy.mul_add(two, yy),
        dz.mul_add(two, zz),
        x.mul_add(yy - zz, z.mul_add(xz, (-y).mul_add(xy, yz))),
        y.mul_add(zz - xx, x.mul_add(xy, (-z).mul_add(yz, xz))),
        z.mul_add(xx - yy, y.mul_add(yz, (-x).mul_add(xz, xy))),
    ])
}

/// Rotation tensor (I - W/2)^-1 (I + W/2) of axial vector `w`, by 2 atan(|w|/2) about `w`.
#[inline(always)]
pub fn rotation<L: Lane>(w: [L; 3]) -> Mat3<L> {
    turn(w) + Mat3::identity()
}

/// Rotation tensor (I - W/2)^-1 (I + W/2) of axial vector `w` minus the identity, (W + W^2/2) / (1 + w.w/4): the
/// displacement gradient of a rotation step, without the rounding of a difference.
#[inline(always)]
pub fn turn<L: Lane>(w: [L; 3]) -> Mat3<L> {
    let (one, half, quarter) = (L::one(), L::of(0.5), L::of(0.25));
    let [x, y, z] = w;
    let square = x.mul_add(x, y.mul_add(y, z * z));
    let a = square.mul_add(quarter, one).recip();
    let (ax, ay, az) = (a * x, a * y, a * z);
    // W^2 = w w^T - (w.w) I
    let (bx, by, bz) = (ax * half, ay * half, az * half);
    let (xx, yy, zz) = (bx * x, by * y, bz * z);
    let (yz, xz, xy) = (by * z, bx * z, bx * y);
    Mat3([[-(yy + zz), xy - az, xz + ay], [xy + az, -(xx + zz), yz - ax], [xz - ay, yz + ax, -(xx + yy)]])
}
