//! Description of a scene's constants for comparison with checkpoints: values by their `Debug` output, functions of time and place by
//! samples.

use std::fmt::Debug;

use impactite_geometry::Shape;

/// Name of a constant, and its description.
pub type Constant = (String, String);

/// Describe a region by its bounds and the signed distances at their corners and centre.
pub fn region<const D: usize>(shape: &dyn Shape<D>) -> String {
    let bounds = shape.bounds();
    let middle: [f64; D] = std::array::from_fn(|d| 0.5 * (bounds.min[d] + bounds.max[d]));
    let depths = [bounds.min, middle, bounds.max].map(|x| shape.signed_distance(x));
    format!("within {:?} .. {:?} m, {depths:?} m from its surface", bounds.min, bounds.max)
}

/// Describe a function of time by its values at `times`, s: the start and now.
pub fn over<X: Debug>(times: [f64; 2], of: impl Fn(f64) -> X) -> String {
    format!("{:?}", times.map(of))
}
