//! Three-component vectors, for laws and detectors.

use mpm_materials::Real;

/// Dot product a . b.
pub fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
/// Sum a + b.
pub fn sum<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
/// Difference a - b.
pub fn difference<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
/// Product f a.
pub fn times<T: Real>(a: [T; 3], f: T) -> [T; 3] {
    [a[0] * f, a[1] * f, a[2] * f]
}
/// Length |a|.
pub fn length<T: Real>(a: [T; 3]) -> T {
    dot(a, a).sqrt()
}
/// Unit vector; `None` for a zero vector.
pub fn unit<T: Real>(a: [T; 3]) -> Option<[T; 3]> {
    let length = length(a);
    (length > T::of(0.0)).then(|| times(a, T::of(1.0) / length))
}
/// Pad a vector of `D` components with zeros to three.
pub fn wide<const D: usize>(a: &[f64; D]) -> [f64; 3] {
    let mut wide = [0.0; 3];
    wide[..D].copy_from_slice(a);
    wide
}
