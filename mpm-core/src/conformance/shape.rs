//! Conformance of shape functions.

use mpm_materials::{Lane, Wide};

use super::{Broken, within};
use crate::dim::Stencil;
use crate::shape::domain::{Corners, MOST_NUMBERS, Table, table};
use crate::shape::{AffineShape, Domain, ShapeFunction, Weights, node_offset};

/// Tested offsets from the bin centre, including the edges of the bin.
fn offsets() -> impl Iterator<Item = f64> {
    // 202 parts, so that hardly any offset but the edges and the centre is a simple fraction.
    (0..=202).map(|i| f64::from(i) / 202.0 - 0.5)
}

/// Tested half sizes, in cells.
const HALVES: [f64; 5] = [0.05, 0.125, 0.25, 0.37, 0.5];

fn at<S: ShapeFunction<f64, D>, const D: usize>(shape: &S, xi: f64, half: f64) -> Weights<f64, S::Extent> {
    shape.weights(xi, half)
}

/// Check that weights are not negative, sum to one and reproduce a linear field; slopes are their derivatives;
/// weights are continuous at the edges of bins; the second moment is that of the weights; domains stay in (0, 1/2];
/// lanes compute the same as single points.
///
/// # Errors
/// The first violated property.
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

/// Compare slopes with the central difference of the weights. Second derivatives may jump: by at most `CURVATURE`.
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
        // A slope that jumps where a box touches a node is between its two one-sided values.
        let sides = [less.slope[a], more.slope[a]];
        let jump = (sides[1] - sides[0]).abs();
        let allowed = 1e-9 + CURVATURE * STEP + if jump > 2.0 * CURVATURE * STEP { jump } else { 0.0 };
        within(S::NAME, "slope = derivative of the weight", error, allowed, || {
            format!("node {a}, xi = {xi}, half size {half}: {} against {difference}", here.slope[a])
        })?;
    }
    Ok(())
}

/// Check that a gather of a nodal vector by coefficients and basis equals the one by weights: value, slope, and slope
/// of the affine fit. The vectors are unit vectors of one node each.
fn basis<S: ShapeFunction<f64, D>, const D: usize>(shape: &S, xi: f64, half: f64) -> Result<(), Broken> {
    let nodes = S::Extent::NODES;
    let w = at(shape, xi, half);
    let mut basis = shape.basis(xi, half, true);
    if S::POLYNOMIAL {
        // The first two functions are not read: they are 1 and xi.
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
        // Shapes without affine transfers need no fit.
        let right = w.value[a] * (node_offset::<S::Extent>(a) - xi) / inertia;
        if inertia > 0.02 && nodes > 2 {
            within(S::NAME, "affine fit of the basis", (fit - right).abs(), 4e-14, place)?;
        }
    }
    Ok(())
}

/// Check that the weights at xi = 1/2 equal those at xi = -1/2 in the next bin.
fn edges<S: ShapeFunction<f64, D>, const D: usize>(shape: &S, half: f64) -> Result<(), Broken> {
    let nodes = S::Extent::NODES;
    let (end, start) = (at(shape, 0.5, half), at(shape, -0.5, half));
    for a in 0..=nodes {
        // Node a of this bin is node a - 1 of the next; a node in reach of only one of them has no weight.
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
        if strain == 0.0 || !S::DOMAIN.carried() {
            within(S::NAME, "a domain that keeps its size at rest", (new - half).abs(), 0.0, place)?;
        }
    }
    Ok(())
}

/// Check that a pack of four offsets yields the weights of each.
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

/// Check that the second moment is bounded away from zero, as APIC requires, and all of [`shape_function`].
///
/// # Errors
/// The first violated property.
pub fn affine_shape<S: ShapeFunction<f64, D> + AffineShape, const D: usize>(shape: &S) -> Result<(), Broken> {
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

/// Check that the slopes are continuous at the edges of bins and inside: no noise when a particle crosses. The linear
/// shape function does not have this property. Also check all of [`shape_function`].
///
/// # Errors
/// The first violated property.
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

/// Check a shape function with convected domains. Weights of domains that are stretched by up to 3, sheared by up to
/// 1 and rotated (and, for [`Domain::Corners`], bent) sum to one and are not negative; they reproduce a linear field
/// at the middle of the domain, and its gradient; those of a box are the products of [`ShapeFunction::weights`];
/// corners of a parallelogram yield the weights of its edges; lanes compute the same as single points.
///
/// # Errors
/// The first violated property.
pub fn convected<S: ShapeFunction<f64, D>, const D: usize>(shape: &S) -> Result<(), Broken> {
    if !S::DOMAIN.convects() {
        let detail = format!("{:?}", S::DOMAIN);
        return Err(Broken { subject: S::NAME.into(), property: "a domain that convects", detail });
    }
    for half in [0.125, 0.25, 0.5] {
        for (n, xi) in offsets().step_by(29).enumerate() {
            let xi = [xi, 0.5 - 0.9 * xi.abs(), -0.7 * xi];
            let start = S::DOMAIN.of_box::<f64, D>([half; 3]);
            product(shape, &xi, half, &table::<f64, f64, S, D>(&xi, &start))?;
            for stretch in [0.4, 1.0, 1.7, 3.0] {
                let domain = deformed::<S, D>(&start, stretch, 0.1 * n as f64, 0.0);
                reproduction::<S, D>(&xi, &domain)?;
                same_for_edges_and_corners::<S, D>(&xi, half, stretch, 0.1 * n as f64)?;
                if S::DOMAIN == Domain::Corners {
                    reproduction::<S, D>(&xi, &deformed::<S, D>(&start, stretch, 0.1 * n as f64, 0.2))?;
                    let mut folded = domain;
                    (0..D).for_each(|d| folded[d] *= -0.6);
                    reproduction::<S, D>(&xi, &folded)?;
                }
            }
        }
    }
    Ok(())
}

/// Return a domain with every vector stretched along the first axis, sheared and rotated; `bend` moves each corner individually.
fn deformed<S: ShapeFunction<f64, D>, const D: usize>(
    start: &[f64; MOST_NUMBERS],
    stretch: f64,
    turn: f64,
    bend: f64,
) -> [f64; MOST_NUMBERS] {
    let mut domain = *start;
    let numbers = S::DOMAIN.numbers(D);
    for (n, vector) in domain[..numbers].chunks_exact_mut(D).enumerate() {
        let (x, y) = (stretch * vector[0] + turn * vector[1], vector[1]);
        vector[0] = turn.cos() * x - turn.sin() * y;
        vector[1] = turn.sin() * x + turn.cos() * y;
        let size = start[0].abs() * bend;
        for (d, x) in vector.iter_mut().enumerate() {
            *x += size * (1.7 * n as f64 + 2.3 * d as f64).sin();
        }
    }
    domain
}

/// Offset of node `s` of a stencil from the bin centre.
fn place<E: Stencil, const D: usize>(s: usize) -> [f64; D] {
    std::array::from_fn(|d| node_offset::<E>(s / E::NODES.pow(d as u32) % E::NODES))
}

fn nodes<E: Stencil>() -> usize {
    E::NODES * E::NODES * E::LAYERS
}

fn product<S: ShapeFunction<f64, D>, const D: usize>(
    shape: &S,
    xi: &[f64; 3],
    half: f64,
    found: &Table<f64, S::Extent>,
) -> Result<(), Broken> {
    let along: Vec<_> = (0..D).map(|d| at(shape, xi[d], half)).collect();
    let count = S::Extent::NODES;
    for s in 0..nodes::<S::Extent>() {
        let a = |d: usize| s / count.pow(d as u32) % count;
        let value: f64 = (0..D).map(|d| along[d].value[a(d)]).product();
        let mut error = (found.value[s] - value).abs();
        for e in 0..D {
            let slope: f64 =
                (0..D).map(|d| if d == e { along[d].slope[a(d)] } else { along[d].value[a(d)] }).product();
            error = error.max((found.slope[e][s] - slope).abs());
        }
        within(S::NAME, "weights of a box = products along the axes", error, 2e-14, || {
            format!("node {s}, xi = {xi:?}, half size {half}")
        })?;
    }
    Ok(())
}

fn reproduction<S: ShapeFunction<f64, D>, const D: usize>(
    xi: &[f64; 3],
    domain: &[f64; MOST_NUMBERS],
) -> Result<(), Broken> {
    let corners = Corners::of::<D>(S::DOMAIN, domain);
    let found = Table::<f64, S::Extent>::of::<D>(&corners, xi);
    let middle = corners.middle::<D>();
    let here = || format!("xi = {xi:?}, domain {:?}", &domain[..S::DOMAIN.numbers(D)]);
    within(S::NAME, "a domain that is not inside out", -corners.volume, 0.0, here)?;
    let (mut sum, mut mean, mut slope, mut linear) = (0.0, [0.0; D], [0.0; D], [[0.0; D]; D]);
    for s in 0..nodes::<S::Extent>() {
        within(S::NAME, "no negative weight", -found.value[s], 1e-15, here)?;
        sum += found.value[s];
        let node = place::<S::Extent, D>(s);
        for d in 0..D {
            mean[d] += found.value[s] * node[d];
            slope[d] += found.slope[d][s];
            for e in 0..D {
                linear[d][e] += found.slope[d][s] * node[e];
            }
        }
    }
    within(S::NAME, "partition of unity", (sum - 1.0f64).abs(), 1e-14, here)?;
    for d in 0..D {
        let error: f64 = mean[d] - xi[d] - middle[d];
        within(S::NAME, "reproduction of a linear field", error.abs(), 1e-14, here)?;
        within(S::NAME, "slopes that sum to zero", slope[d].abs(), 1e-13, here)?;
        for e in 0..D {
            let exact = if d == e { 1.0 } else { 0.0 };
            within(S::NAME, "gradient of a linear field", (linear[d][e] - exact).abs(), 1e-12, here)?;
        }
    }
    // A pack of four yields the weights of each.
    let factors = [1.0, 0.9, 1.1, 0.97];
    let packed = domain.map(|x| Wide(factors.map(|f| f * x)));
    let pack: Table<Wide<f64, 4>, S::Extent> =
        Table::of::<D>(&Corners::of::<D>(S::DOMAIN, &packed), &xi.map(|x| Wide([x; 4])));
    for (lane, f) in factors.into_iter().enumerate() {
        let single = table::<f64, f64, S, D>(xi, &domain.map(|x| f * x));
        for s in 0..nodes::<S::Extent>() {
            let error = (pack.value[s].lane(lane) - single.value[s]).abs();
            within(S::NAME, "lanes = single points", error, 1e-15, here)?;
        }
    }
    Ok(())
}

fn same_for_edges_and_corners<S: ShapeFunction<f64, D>, const D: usize>(
    xi: &[f64; 3],
    half: f64,
    stretch: f64,
    turn: f64,
) -> Result<(), Broken> {
    let [edges, corners] = [Domain::Edges, Domain::Corners].map(|kind| {
        let mut domain = kind.of_box::<f64, D>([half; 3]);
        for vector in domain[..kind.numbers(D)].chunks_exact_mut(D) {
            vector[0] = stretch * vector[0] + turn * vector[1];
        }
        Table::<f64, S::Extent>::of::<D>(&Corners::of::<D>(kind, &domain), xi)
    });
    for s in 0..nodes::<S::Extent>() {
        let slope = (0..D).map(|d| (edges.slope[d][s] - corners.slope[d][s]).abs()).fold(0.0, f64::max);
        let error = slope.max((edges.value[s] - corners.value[s]).abs());
        within(S::NAME, "corners of a parallelogram = its edges", error, 1e-12, || {
            format!("node {s}, xi = {xi:?}, half size {half}, stretch {stretch}, shear {turn}")
        })?;
    }
    Ok(())
}
