//! Vectors of three numbers, for laws and detectors.

use mpm_materials::Real;

/// a . b.
pub fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
/// a + b.
pub fn sum<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
/// a - b.
pub fn difference<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
/// f a.
pub fn times<T: Real>(a: [T; 3], f: T) -> [T; 3] {
    [a[0] * f, a[1] * f, a[2] * f]
}
/// |a|.
pub fn length<T: Real>(a: [T; 3]) -> T {
    dot(a, a).sqrt()
}
/// The vector over its length; `None` if it has none.
pub fn unit<T: Real>(a: [T; 3]) -> Option<[T; 3]> {
    let length = length(a);
    (length > T::of(0.0)).then(|| times(a, T::of(1.0) / length))
}
/// A vector of `D` components as one of three.
pub fn wide<const D: usize>(a: &[f64; D]) -> [f64; 3] {
    let mut wide = [0.0; 3];
    wide[..D].copy_from_slice(a);
    wide
}
