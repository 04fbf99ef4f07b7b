//! What a scene is made of, in words, for a checkpoint to compare: constants as types show them (`Debug`), functions of time and
//! place by what they give at some.

use std::fmt::Debug;

use impactite_geometry::Shape;

/// What is compared, and what it is.
pub type Constant = (String, String);

/// A region by its bounds and how deep their corners and their middle are.
pub fn region<const D: usize>(shape: &dyn Shape<D>) -> String {
    let bounds = shape.bounds();
    let middle: [f64; D] = std::array::from_fn(|d| 0.5 * (bounds.min[d] + bounds.max[d]));
    let depths = [bounds.min, middle, bounds.max].map(|x| shape.signed_distance(x));
    format!("within {:?} .. {:?} m, {depths:?} m from its surface", bounds.min, bounds.max)
}

/// A function of time by what it gives at these, s: the start and now.
pub fn over<X: Debug>(times: [f64; 2], of: impl Fn(f64) -> X) -> String {
    format!("{:?}", times.map(of))
}
