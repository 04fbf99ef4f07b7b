//! Shape functions.

use mpm_materials::{Lane, Wide};

use super::{Broken, within};
use crate::dim::Stencil;
use crate::shape::{AffineShape, ShapeFunction, Weights, node_offset};

/// Offsets from the bin's centre that are tried, its edges among them.
fn offsets() -> impl Iterator<Item = f64> {
    // A prime number of parts, so that no offset but the edges and the centre is a simple fraction.
    (0..=202).map(|i| f64::from(i) / 202.0 - 0.5)
}

/// Half sizes that are tried, in cells.
const HALVES: [f64; 5] = [0.05, 0.125, 0.25, 0.37, 0.5];

fn at<S: ShapeFunction<f64, D>, const D: usize>(shape: &S, xi: f64, half: f64) -> Weights<f64, S::Extent> {
    shape.weights(xi, half)
}

/// Weights are not negative and sum to one; they reproduce a linear field; slopes are their derivatives; they
/// go over into each other at the edges of bins; the second moment is that of the weights; domains stay in
/// (0, 1/2]; lanes compute what single points do.
///
/// # Errors
/// The first property that does not hold.
pub fn shape_function<S: ShapeFunction<f64, D>, const D: usize>(shape: &S) -> Result<(), Broken> {
    let nodes = S::Extent::NODES;
    for half in HALVES {
        for xi in offsets() {
            let w = at(shape, xi, half);
            let place = || format!("xi = {xi}, half size {half}");
            let (mut sum, mut mean, mut second, mut slope, mut linear) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for a in 0..nodes {
                let node = node_offset::<S::Extent>(a);
                within(S::NAME, "no negative weight", -w.value[a], 1e-15, place)?;
                sum += w.value[a];
                mean += w.value[a] * node;
                second += w.value[a] * (node - xi) * (node - xi);
                slope += w.slope[a];
                linear += w.slope[a] * node;
            }
            within(S::NAME, "partition of unity", (sum - 1.0f64).abs(), 4e-15, place)?;
            within(S::NAME, "reproduction of a linear field", (mean - xi).abs(), 4e-15, place)?;
            within(S::NAME, "slopes that sum to zero", slope.abs(), 1e-14, place)?;
            within(S::NAME, "gradient of a linear field", (linear - 1.0f64).abs(), 1e-14, place)?;
            let inertia = (shape.inertia(xi, half) - second).abs();
            within(S::NAME, "second moment of the weights", inertia, 4e-15, place)?;
            slopes(shape, xi, half)?;
            lanes(shape, xi, half)?;
            basis(shape, xi, half)?;
        }
        edges(shape, half)?;
        domain(shape, half)?;
    }
    Ok(())
}

/// Central difference of the weights. Second derivatives may jump: by at most `CURVATURE`.
fn slopes<S: ShapeFunction<f64, D>, const D: usize>(shape: &S, xi: f64, half: f64) -> Result<(), Broken> {
    const STEP: f64 = 1e-6;
    const CURVATURE: f64 = 40.0;
    if xi.abs() > 0.5 - 2.0 * STEP {
        return Ok(());
    }
    let (less, here, more) = (at(shape, xi - STEP, half), at(shape, xi, half), at(shape, xi + STEP, half));
    for a in 0..S::Extent::NODES {
        let difference = (more.value[a] - less.value[a]) / (2.0 * STEP);
        let error = (difference - here.slope[a]).abs();
        // A slope that jumps where a box meets a node lies between its two sides.
        let sides = [less.slope[a], more.slope[a]];
        let jump = (sides[1] - sides[0]).abs();
        let allowed = 1e-9 + CURVATURE * STEP + if jump > 2.0 * CURVATURE * STEP { jump } else { 0.0 };
        within(S::NAME, "slope = derivative of the weight", error, allowed, || {
            format!("node {a}, xi = {xi}, half size {half}: {} against {difference}", here.slope[a])
        })?;
    }
    Ok(())
}

/// What a gather makes of a nodal vector by coefficients and basis is what the weights make of it: the value,
/// the slope, and the slope of the affine fit. Unit vectors, a node at a time.
fn basis<S: ShapeFunction<f64, D>, const D: usize>(shape: &S, xi: f64, half: f64) -> Result<(), Broken> {
    let nodes = S::Extent::NODES;
    let w = at(shape, xi, half);
    let mut basis = shape.basis(xi, half, true);
    if S::POLYNOMIAL {
        // Not read: the first function is 1, the second xi.
        (basis.value[0], basis.slope[0], basis.fit[0]) = (1.0, 0.0, 0.0);
        (basis.value[1], basis.slope[1], basis.fit[1]) = (xi, 1.0, 1.0);
    }
    let inertia: f64 = shape.inertia(xi, half);
    for a in 0..nodes {
        let mut unit = w.value;
        for b in 0..nodes {
            unit[b] = f64::from(u8::from(a == b));
        }
        let c = if S::POLYNOMIAL { S::coefficients(unit) } else { unit };
        let (mut value, mut slope, mut fit) = (0.0, 0.0, 0.0);
        for b in 0..nodes {
            value += c[b] * basis.value[b];
            slope += c[b] * basis.slope[b];
            fit += c[b] * basis.fit[b];
        }
        let place = || format!("node {a}, xi = {xi}, half size {half}");
        within(S::NAME, "basis = weights", (value - w.value[a]).abs(), 4e-15, place)?;
        within(
            S::NAME,
            "slope of the basis = that of the weights",
            (slope - w.slope[a]).abs(),
            4e-14,
            place,
        )?;
        // A shape for which no affine transfer is allowed need not have a fit.
        let right = w.value[a] * (node_offset::<S::Extent>(a) - xi) / inertia;
        if inertia > 0.02 && nodes > 2 {
            within(S::NAME, "affine fit of the basis", (fit - right).abs(), 4e-14, place)?;
        }
    }
    Ok(())
}

/// At xi = 1/2 the weights are those of xi = -1/2 in the next bin.
fn edges<S: ShapeFunction<f64, D>, const D: usize>(shape: &S, half: f64) -> Result<(), Broken> {
    let nodes = S::Extent::NODES;
    let (end, start) = (at(shape, 0.5, half), at(shape, -0.5, half));
    for a in 0..=nodes {
        // Node a of this bin is node a - 1 of the next; what only one of them reaches has no weight.
        let here = if a < nodes { end.value[a] } else { 0.0 };
        let next = if a > 0 { start.value[a - 1] } else { 0.0 };
        within(S::NAME, "continuity across bins", (here - next).abs(), 4e-15, || {
            format!("node {a}, half size {half}: {here} against {next}")
        })?;
    }
    Ok(())
}

fn domain<S: ShapeFunction<f64, D>, const D: usize>(shape: &S, half: f64) -> Result<(), Broken> {
    for strain in [-0.9, -0.3, 0.0, 0.4, 3.0] {
        let new: f64 = shape.stretch(half, strain);
        let place = || format!("half size {half}, strain {strain}: {new}");
        within(S::NAME, "a domain of at most half a cell", new, 0.5, place)?;
        within(S::NAME, "a domain larger than zero", -new, -1e-3, place)?;
        if strain == 0.0 || !S::CARRIES_DOMAIN {
            within(S::NAME, "a domain that keeps its size at rest", (new - half).abs(), 0.0, place)?;
        }
    }
    Ok(())
}

/// A pack of four offsets gives the weights of each.
fn lanes<S: ShapeFunction<f64, D>, const D: usize>(shape: &S, xi: f64, half: f64) -> Result<(), Broken> {
    let others = [xi, -xi, 0.5 * xi, 0.25 - 0.5 * xi];
    let pack: Weights<Wide<f64, 4>, S::Extent> = shape.weights(Wide(others), Wide([half; 4]));
    for (lane, &xi) in others.iter().enumerate() {
        let single = at(shape, xi, half);
        for a in 0..S::Extent::NODES {
            let value = (pack.value[a].lane(lane) - single.value[a]).abs();
            let slope = (pack.slope[a].lane(lane) - single.slope[a]).abs();
            within(S::NAME, "lanes = single points", value.max(slope), 1e-15, || {
                format!("lane {lane}, node {a}, xi = {xi}")
            })?;
        }
    }
    Ok(())
}

/// The second moment stays away from zero, as APIC needs it; and all of [`shape_function`].
///
/// # Errors
/// The first property that does not hold.
pub fn affine_shape<S: AffineShape<f64, D>, const D: usize>(shape: &S) -> Result<(), Broken> {
    shape_function(shape)?;
    for half in HALVES {
        for xi in offsets() {
            let inertia = shape.inertia(xi, half);
            within(S::NAME, "a second moment above 0.02 h^2", 0.02 - inertia, 0.0, || {
                format!("xi = {xi}, half size {half}: {inertia}")
            })?;
        }
    }
    Ok(())
}

/// The slopes go over into each other at the edges of bins and do not jump inside: no noise when a particle
/// crosses. The hat does not have this. And all of [`shape_function`].
///
/// # Errors
/// The first property that does not hold.
pub fn smooth<S: ShapeFunction<f64, D>, const D: usize>(shape: &S) -> Result<(), Broken> {
    shape_function(shape)?;
    let nodes = S::Extent::NODES;
    for half in HALVES {
        let (end, start) = (at(shape, 0.5, half), at(shape, -0.5, half));
        for a in 0..=nodes {
            let here = if a < nodes { end.slope[a] } else { 0.0 };
            let next = if a > 0 { start.slope[a - 1] } else { 0.0 };
            within(S::NAME, "continuity of the slope across bins", (here - next).abs(), 1e-14, || {
                format!("node {a}, half size {half}: {here} against {next}")
            })?;
        }
        for xi in offsets().filter(|xi| xi.abs() < 0.4999) {
            let (less, more) = (at(shape, xi - 1e-9, half), at(shape, xi + 1e-9, half));
            for a in 0..nodes {
                let jump = (more.slope[a] - less.slope[a]).abs();
                within(S::NAME, "a continuous slope", jump, 1e-7, || format!("node {a}, xi = {xi}"))?;
            }
        }
    }
    Ok(())
}
