//! Errors of neighbour searches.

/// Error of a neighbour search: invalid points, reach or position.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SearchError {
    /// Invalid coordinate or radius of a point.
    #[error("search: {field} of point {point} = {value} is not allowed; it must be {allowed}")]
    Point {
        /// Name of the coordinate or the radius.
        field: &'static str,
        /// Point index.
        point: usize,
        /// Value (m).
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// Invalid parameter of a search.
    #[error("search: {field} = {value} is not allowed; it must be {allowed}")]
    Parameter {
        /// Name of the parameter.
        field: &'static str,
        /// Value of the parameter.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// Different numbers of positions and radii.
    #[error("search: there are {radii} radii for {positions} positions; there must be one a position")]
    Lengths {
        /// Number of positions.
        positions: usize,
        /// Number of radii.
        radii: usize,
    },
    /// Too many points.
    #[error("search: {points} points are too many; at most {} are allowed", super::MOST_POINTS)]
    Points {
        /// Number of points.
        points: usize,
    },
    /// Neighbour lists above the memory limit.
    #[error(
        "search: {points} points have more than {allowed} neighbours together, the most that lists may hold (a reach too large, or \
         units mixed up?)"
    )]
    Neighbours {
        /// Number of points.
        points: usize,
        /// Maximum number of neighbours of all points together.
        allowed: usize,
    },
}

const COORDINATES: [&str; 3] = ["x", "y", "z"];

/// True if a coordinate, a radius or a reach is at least `least` and at most [`FARTHEST`](super::FARTHEST).
pub(super) fn within_bounds(value: f64, least: f64) -> bool {
    value >= least && value <= super::FARTHEST
}

pub(super) const ALLOWED_COORDINATE: &str = "finite, between -1e150 and 1e150";
pub(super) const ALLOWED_LENGTH: &str = "zero or positive, and at most 1e150";

/// Check that a position is finite and within the allowed range.
pub(super) fn check_place<const D: usize>(x: &[f64; D]) -> Result<(), SearchError> {
    for (d, &value) in x.iter().enumerate() {
        if !within_bounds(value, -super::FARTHEST) {
            let field = COORDINATES.get(d).copied().unwrap_or("coordinate");
            return Err(SearchError::Parameter { field, value, allowed: ALLOWED_COORDINATE });
        }
    }
    Ok(())
}

/// Check that a length is finite, not negative and within the allowed range.
pub(super) fn check_length(field: &'static str, value: f64) -> Result<(), SearchError> {
    if within_bounds(value, 0.0) {
        Ok(())
    } else {
        Err(SearchError::Parameter { field, value, allowed: ALLOWED_LENGTH })
    }
}

/// Check all coordinates; the error names the first invalid point.
pub(super) fn check_positions<const D: usize>(positions: &[[f64; D]]) -> Result<(), SearchError> {
    for (point, x) in positions.iter().enumerate() {
        for (d, &value) in x.iter().enumerate() {
            if !within_bounds(value, -super::FARTHEST) {
                let field = COORDINATES.get(d).copied().unwrap_or("coordinate");
                return Err(SearchError::Point { field, point, value, allowed: ALLOWED_COORDINATE });
            }
        }
    }
    Ok(())
}

/// Check all radii; the error names the first invalid point.
pub(super) fn check_radii(radii: &[f64]) -> Result<(), SearchError> {
    match radii.iter().position(|&r| !within_bounds(r, 0.0)) {
        None => Ok(()),
        Some(point) => {
            Err(SearchError::Point { field: "radius", point, value: radii[point], allowed: ALLOWED_LENGTH })
        }
    }
}
