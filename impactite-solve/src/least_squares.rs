//! Moving least squares with linear functions.

use nalgebra::SMatrix;

/// Replace the weights of points around `x` by the weights of their values in the moving least squares fit with linear functions at `x`:
/// \[Lancaster1981\]
/// ```text
/// w_i <- w_i (1 / W + (x - c) . S^-1 (x_i - c)),
/// W = sum w_i,   c = sum w_i x_i / W,   S = sum w_i (x_i - c) (x_i - c)^T
/// ```
/// The new weights have the sum one and the first moment x, so that the values of a linear function are fitted exactly. In directions in which
/// the variance S / W is below `least`, m^2, the function is taken as nearly constant: these fit neither x nor the slope. Returns false, with the
/// weights as they were, unless their sum is positive.
///
/// ```
/// use impactite_solve::least_squares_weights;
/// let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
/// let mut weights = [1.0, 0.5, 0.25];
/// assert!(least_squares_weights(&[0.2, 0.3], 1e-6, &points, &mut weights));
/// let linear = |x: &[f64; 2]| 2.0 - 3.0 * x[0] + 5.0 * x[1];
/// let fitted: f64 = points.iter().zip(weights).map(|(x, w)| w * linear(x)).sum();
/// assert!((fitted - linear(&[0.2, 0.3])).abs() < 1e-12);
/// ```
pub fn least_squares_weights<const D: usize>(
    x: &[f64; D],
    least: f64,
    points: &[[f64; D]],
    weights: &mut [f64],
) -> bool {
    let sum: f64 = weights.iter().sum();
    if sum.is_nan() || sum <= 0.0 {
        return false;
    }
    let mut centre = [0.0; D];
    for (point, weight) in points.iter().zip(&*weights) {
        (0..D).for_each(|d| centre[d] += weight / sum * point[d]);
    }
    let arm = |y: &[f64; D]| -> [f64; D] { std::array::from_fn(|d| y[d] - centre[d]) };
    let mut spread = SMatrix::<f64, 3, 3>::zeros();
    for (point, weight) in points.iter().zip(&*weights) {
        let r = arm(point);
        for a in 0..D {
            (0..D).for_each(|b| spread[(a, b)] += weight / sum * r[a] * r[b]);
        }
    }
    let slope = slope(&spread, &arm(x), least);
    for (point, weight) in points.iter().zip(weights) {
        let r = arm(point);
        *weight *= (1.0 + (0..D).map(|d| slope[d] * r[d]).sum::<f64>()) / sum;
    }
    true
}

/// Product of the inverse of a variance with a vector, by which directions of a variance below `least` are left out.
fn slope<const D: usize>(spread: &SMatrix<f64, 3, 3>, out: &[f64; D], least: f64) -> [f64; D] {
    let mut slope = [0.0; D];
    // Unused directions have the variance one.
    let mut whole = *spread;
    (D..3).for_each(|d| whole[(d, d)] = 1.0);
    // The product of two variances is at most the square of half of their sum.
    let trace: f64 = (0..D).map(|d| spread[(d, d)]).sum();
    let bound = if D == 3 { 0.25 * trace * trace } else { trace };
    if whole.determinant() > least * bound
        && let Some(inverse) = whole.try_inverse()
    {
        (0..D).for_each(|a| slope[a] = (0..D).map(|b| inverse[(a, b)] * out[b]).sum());
        return slope;
    }
    let eigen = spread.symmetric_eigen();
    for (value, axis) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        let inverse = if *value >= least { 1.0 / value } else { value.max(0.0) / (least * least) };
        let along: f64 = (0..D).map(|d| axis[d] * out[d]).sum();
        (0..D).for_each(|d| slope[d] += inverse * along * axis[d]);
    }
    slope
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thin_directions_are_not_extrapolated() {
        // Almost on a line: the value beyond it is that of the line.
        let points = [[0.0, 0.0, 0.0], [1.0, 1e-5, 0.0], [0.0, 0.0, 1.0]];
        let mut weights = [1.0; 3];
        assert!(least_squares_weights(&[0.25, 3.0, 0.25], 1e-3, &points, &mut weights));
        let sum: f64 = weights.iter().sum();
        let first: f64 = points.iter().zip(weights).map(|(x, w)| w * x[0]).sum();
        assert!((sum - 1.0).abs() < 1e-12 && (first - 0.25).abs() < 1e-4, "{weights:?}");
        let mut none = [0.0; 3];
        assert!(!least_squares_weights(&[0.0; 3], 1e-3, &points, &mut none));
    }
}
