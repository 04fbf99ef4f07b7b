//! Objective rates: how a stress turns with the material during a step.

use crate::lane::Lane;
use crate::point::Kinematics;
use crate::tensor::{Mat3, Sym3};

/// Turns a symmetric tensor with the spin of a step.
pub trait ObjectiveRate: Copy + Send + Sync + 'static {
    /// The tensor after the rotation of this step, before any straining.
    fn rotate<L: Lane>(&self, kinematics: &Kinematics<L>, tensor: &Sym3<L>) -> Sym3<L>;
}

/// Jaumann rate to first order: s + W s - s W with the spin increment W (\[Ma2010\] section 1.2).
/// Stretches the tensor by |W|^2 a step: keep |W| below 0.05.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jaumann;

impl ObjectiveRate for Jaumann {
    #[inline(always)]
    fn rotate<L: Lane>(&self, kinematics: &Kinematics<L>, tensor: &Sym3<L>) -> Sym3<L> {
        let two = L::of(2.0);
        let [x, y, z] = kinematics.spin();
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
}

/// The same rate integrated exactly as a rotation (Hughes and Winget 1980): Q s Q^T with
/// Q = (I - W/2)^-1 (I + W/2), orthogonal for every size of step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HughesWinget;

impl ObjectiveRate for HughesWinget {
    #[inline(always)]
    fn rotate<L: Lane>(&self, kinematics: &Kinematics<L>, tensor: &Sym3<L>) -> Sym3<L> {
        rotation(kinematics.spin()).congruence(tensor)
    }
}

/// The rotation (I - W/2)^-1 (I + W/2) of axial vector `w`: I + (W + W^2/2) / (1 + w.w/4).
#[inline(always)]
pub fn rotation<L: Lane>(w: [L; 3]) -> Mat3<L> {
    let (one, half) = (L::one(), L::of(0.5));
    let [x, y, z] = w;
    let square = x * x + y * y + z * z;
    let a = (one + square * L::of(0.25)).recip();
    let b = half * a;
    // W^2 = w w^T - (w.w) I
    let d = one - b * square;
    Mat3([
        [d + b * x * x, b * x * y - a * z, b * x * z + a * y],
        [b * x * y + a * z, d + b * y * y, b * y * z - a * x],
        [b * x * z - a * y, b * y * z + a * x, d + b * z * z],
    ])
}
