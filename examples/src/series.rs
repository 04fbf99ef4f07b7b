//! Analysis of time series and of errors over resolutions.

/// Linear interpolation of the second number at the first place where the first one reaches `x`; NaN if it does not.
#[must_use]
pub fn interpolate(rows: impl IntoIterator<Item = [f64; 2]>, x: f64) -> f64 {
    let mut before: Option<[f64; 2]> = None;
    for [at, value] in rows {
        if at >= x {
            let [from, start] = before.unwrap_or([at, value]);
            let part = if at > from { (x - from) / (at - from) } else { 0.0 };
            return start + part * (value - start);
        }
        before = Some([at, value]);
    }
    f64::NAN
}

/// Times at which a series crosses zero, by linear interpolation.
#[must_use]
pub fn crossings(series: &[[f64; 2]]) -> Vec<f64> {
    let pairs = series.windows(2).filter(|w| w[0][1] * w[1][1] < 0.0);
    pairs.map(|w| w[0][0] + (w[1][0] - w[0][0]) * w[0][1] / (w[0][1] - w[1][1])).collect()
}

/// Mean period of a series, from its first to its last zero crossing; NaN with less than two.
#[must_use]
pub fn period(series: &[[f64; 2]]) -> f64 {
    match &crossings(series)[..] {
        [first, .., last] => 2.0 * (last - first) / (crossings(series).len() as f64 - 1.0),
        _ => f64::NAN,
    }
}

/// Times and magnitudes of the extrema within a series, by the parabola through the three rows around each.
#[must_use]
pub fn extrema(series: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let parabola = |w: &[[f64; 2]]| {
        let [[t0, a], [t, b], [t1, c]] = [w[0], w[1], w[2]];
        let (down, up) = ((b - a) / (t - t0), (c - b) / (t1 - t));
        let (curvature, slope) =
            ((up - down) / (0.5 * (t1 - t0)), (down * (t1 - t) + up * (t - t0)) / (t1 - t0));
        [t - slope / curvature, (b - 0.5 * slope * slope / curvature).abs()]
    };
    let outermost = |w: &&[[f64; 2]]| {
        let [a, b, c] = [w[0], w[1], w[2]].map(|row| row[1] * w[1][1].signum());
        b > a && b >= c && b > 0.0
    };
    series.windows(3).filter(outermost).map(parabola).collect()
}

/// Rate of decay, 1/s: least-squares line through the logarithms of the extrema of a series; NaN with less than two.
#[must_use]
pub fn decay(series: &[[f64; 2]]) -> f64 {
    let peaks = extrema(series);
    let count = peaks.len() as f64;
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| peaks.iter().map(of).sum::<f64>() / count;
    let (time, level) = (mean(&|p| p[0]), mean(&|p| p[1].ln()));
    let product = mean(&|p| (p[0] - time) * (p[1].ln() - level));
    -product / mean(&|p| (p[0] - time).powi(2))
}

/// Observed order of errors from cells of width `h`: between the first and the last.
#[must_use]
pub fn order(errors: &[[f64; 2]]) -> f64 {
    let [[h, e], .., [fine, last]] = errors else { return f64::NAN };
    (e / last).abs().ln() / (h / fine).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damped_oscillation_has_its_period_and_rate() {
        let (omega, rate) = (3.0, 0.2);
        let at = |n: i32| {
            let t = 0.02 * f64::from(n);
            [t, (-rate * t).exp() * (omega * t).cos()]
        };
        let series: Vec<_> = (0..700).map(at).collect();
        assert!((period(&series) * omega / std::f64::consts::TAU - 1.0).abs() < 1e-4);
        assert!((decay(&series) / rate - 1.0).abs() < 1e-4, "{}", decay(&series));
        assert!((interpolate(series.iter().copied(), 0.01) - 0.5 * (1.0 + series[1][1])).abs() < 1e-12);
    }

    #[test]
    fn an_order_is_that_of_the_errors() {
        assert!((order(&[[0.1, 0.01], [0.05, -0.0025], [0.025, 0.000_625]]) - 2.0).abs() < 1e-12);
        assert!(order(&[[0.1, 0.01]]).is_nan());
    }
}
