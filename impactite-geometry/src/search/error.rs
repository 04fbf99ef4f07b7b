//! What a search refuses, and why.

/// Why points, a reach or a place is refused by a search.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SearchError {
    /// A coordinate or a radius of one point that no search can use.
    #[error("search: {field} of point {point} = {value} is not allowed; it must be {allowed}")]
    Point {
        /// The coordinate or the radius.
        field: &'static str,
        /// Number of the point.
        point: usize,
        /// What was given (m).
        value: f64,
        /// What is allowed, in words.
        allowed: &'static str,
    },
    /// A number that belongs to no point.
    #[error("search: {field} = {value} is not allowed; it must be {allowed}")]
    Parameter {
        /// The number.
        field: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed, in words.
        allowed: &'static str,
    },
    /// Radii that do not belong to the positions.
    #[error("search: there are {radii} radii for {positions} positions; there must be one a position")]
    Lengths {
        /// Number of positions.
        positions: usize,
        /// Number of radii.
        radii: usize,
    },
    /// More points than a search can number.
    #[error("search: {points} points are too many; at most {} are allowed", super::MOST_POINTS)]
    Points {
        /// Number of points.
        points: usize,
    },
    /// Lists longer than memory should hold.
    #[error(
        "search: {points} points have more than {allowed} neighbours together, the most that lists may hold (a reach too large, or \
         units mixed up?)"
    )]
    Neighbours {
        /// Number of points.
        points: usize,
        /// The most neighbours of all points together.
        allowed: usize,
    },
}

const COORDINATES: [&str; 3] = ["x", "y", "z"];

/// What a coordinate, a radius or a reach may be.
pub(super) fn within_bounds(value: f64, least: f64) -> bool {
    value >= least && value <= super::FARTHEST
}

pub(super) const ALLOWED_COORDINATE: &str = "finite, between -1e150 and 1e150";
pub(super) const ALLOWED_LENGTH: &str = "zero or positive, and at most 1e150";

/// Refuses a place that is not finite.
pub(super) fn check_place<const D: usize>(x: &[f64; D]) -> Result<(), SearchError> {
    for (d, &value) in x.iter().enumerate() {
        if !within_bounds(value, -super::FARTHEST) {
            let field = COORDINATES.get(d).copied().unwrap_or("coordinate");
            return Err(SearchError::Parameter { field, value, allowed: ALLOWED_COORDINATE });
        }
    }
    Ok(())
}

/// Refuses a length that is negative or not finite.
pub(super) fn check_length(field: &'static str, value: f64) -> Result<(), SearchError> {
    if within_bounds(value, 0.0) {
        Ok(())
    } else {
        Err(SearchError::Parameter { field, value, allowed: ALLOWED_LENGTH })
    }
}

/// Refuses the first coordinate that is not finite.
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

/// Refuses the first radius that is negative or not finite.
pub(super) fn check_radii(radii: &[f64]) -> Result<(), SearchError> {
    match radii.iter().position(|&r| !within_bounds(r, 0.0)) {
        None => Ok(()),
        Some(point) => {
            Err(SearchError::Point { field: "radius", point, value: radii[point], allowed: ALLOWED_LENGTH })
        }
    }
}
