//! Detection of bodies at small strain, for which finite elements suffice.

use std::fmt;

use impactite_geometry::search::{NeighbourLists, NeighbourSearch, Points, Reach, SortedCells};
use impactite_simd::Team;
use nalgebra::Matrix3;

use super::{ObserveError, Observer, Pace, RunView};
use crate::archive::{Archive, CheckpointError};
use crate::body::Body;

/// Radius of the neighbour search at the start, in point widths: it includes diagonal neighbours of a lattice.
const NEAR: f64 = 1.8;
/// Share of the points of a body at small strain from which on finite elements suffice: the rest may be oscillating particles, as at the
/// tip of a rod.
const ALL: f64 = 0.95;

/// Observer of the strain of each body, which reports at the end of a run the bodies that stayed at small strain: finite elements are
/// cheaper and more accurate there (`impactite::fem`).
///
/// The strain of a point is the Frobenius norm of the Green-Lagrange strain E = (F^T F - I) / 2, in axisymmetric scenes combined with the
/// hoop strain. The deformation gradient F is the least-squares fit of the neighbours' positions to those at the start. So the strain
/// applies to any law and method, and is invariant under rotations. Oscillations of particles within a cell add about 0.01.
///
/// ```
/// use impactite_scene::observe::{Pace, SmallStrain};
/// let strain = SmallStrain::new(Pace::interval(1.0e-6)?, 0.05);
/// // ... after a run: for body in strain.report() { println!("{body}"); }
/// assert!(strain.report().is_empty());
/// # Ok::<(), impactite_scene::observe::ObserveError>(())
/// ```
pub struct SmallStrain {
    pace: Pace,
    threshold: f64,
    bodies: Vec<Followed>,
}

/// Initial state of a body, and the largest strains of its points.
#[derive(Clone, Debug, Default)]
struct Followed {
    name: String,
    start: Vec<[f64; 3]>,
    widths: Vec<f64>,
    neighbours: NeighbourLists,
    largest: Vec<f64>,
    /// True for bodies of elements, without a law, or with a changed number of points, which are excluded.
    left_out: bool,
}

/// Strain statistics of a body over a run.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyStrain {
    /// Name of the body.
    pub body: String,
    /// Number of points.
    pub points: usize,
    /// Share of the points whose strain stayed below the threshold.
    pub small: f64,
    /// Strain threshold.
    pub threshold: f64,
    /// Points of this body as a share of all points of the scene: the share of point updates that finite elements would replace.
    pub of_all: f64,
}

impl BodyStrain {
    /// True if finite elements suffice for this body: all but 5 % of its points stay below the threshold.
    #[must_use]
    pub fn elements_would_do(&self) -> bool {
        self.small >= ALL
    }
}

impl fmt::Display for BodyStrain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let BodyStrain { body, points, small, threshold, of_all } = self;
        write!(
            f,
            "body `{body}`: {:.1} % of its {points} points stayed below a strain of {threshold}",
            100.0 * small
        )?;
        if self.elements_would_do() {
            write!(
                f,
                "; finite elements would do, and save up to {:.0} % of the point updates",
                100.0 * of_all
            )?;
        }
        Ok(())
    }
}

impl SmallStrain {
    /// Create the observer with a pace and a threshold of small strain: 0.05 is usual.
    #[must_use]
    pub fn new(pace: Pace, threshold: f64) -> Self {
        SmallStrain { pace, threshold, bodies: Vec::new() }
    }

    /// Return the statistics so far, one row for each body of points whose number did not change.
    #[must_use]
    pub fn report(&self) -> Vec<BodyStrain> {
        let all: usize = self.bodies.iter().map(|body| body.start.len()).sum();
        let followed = self.bodies.iter().filter(|body| !body.left_out);
        followed
            .map(|body| {
                let small = body.largest.iter().filter(|strain| **strain < self.threshold).count();
                BodyStrain {
                    body: body.name.clone(),
                    points: body.start.len(),
                    small: small as f64 / body.start.len() as f64,
                    threshold: self.threshold,
                    of_all: body.start.len() as f64 / all as f64,
                }
            })
            .collect()
    }
}

impl Followed {
    fn new(body: &dyn Body, dimensions: usize, axisymmetric: bool) -> Self {
        let points = body.points();
        let elements = points.iter().any(|p| !p.corners.is_empty());
        let mut followed = Followed {
            name: body.name().into(),
            start: points.iter().map(|p| p.position).collect(),
            widths: points.iter().map(|p| p.drawn_width(dimensions, axisymmetric)).collect(),
            neighbours: NeighbourLists::new(),
            largest: vec![0.0; points.len()],
            left_out: elements || body.law().is_empty() || points.is_empty(),
        };
        followed.find_neighbours();
        followed
    }

    fn find_neighbours(&mut self) {
        if self.left_out {
            return;
        }
        let reaches: Vec<f64> = self.widths.iter().map(|w| NEAR * w).collect();
        let found = Points::new(&self.start, &reaches)
            .and_then(|points| SortedCells::new(&points, Reach::larger(0.0)))
            .and_then(|search| search.neighbours_into(&Team::one(), &mut self.neighbours));
        // A body whose points the neighbour search rejects is excluded.
        self.left_out |= found.is_err();
    }

    fn look(&mut self, body: &dyn Body, dimensions: usize, axisymmetric: bool) {
        if self.left_out {
            return;
        }
        if body.len() != self.start.len() {
            self.left_out = true;
            return;
        }
        let points = body.points();
        for (n, (point, largest)) in points.iter().zip(&mut self.largest).enumerate() {
            let pairs = self.neighbours.of(n).iter().map(|&m| {
                let d = |a: &[f64; 3], b: &[f64; 3]| nalgebra::Vector3::from_fn(|i, _| a[i] - b[i]);
                (d(&self.start[m as usize], &self.start[n]), d(&points[m as usize].position, &point.position))
            });
            let (mut now, mut then) = (Matrix3::zeros(), Matrix3::zeros());
            for (start, at) in pairs {
                now += at * start.transpose();
                then += start * start.transpose();
            }
            let hoop = if axisymmetric {
                let stretch = point.position[0] / self.start[n][0];
                0.5 * (stretch * stretch - 1.0)
            } else {
                0.0
            };
            let strain = strain(&now, then, self.widths[n], dimensions).hypot(hoop);
            *largest = if point.failed { f64::INFINITY } else { largest.max(strain) };
        }
    }
}

/// Return the norm of the strain from these sums over neighbours, without unit; 0 if the neighbours do not span the space.
fn strain(now: &Matrix3<f64>, mut then: Matrix3<f64>, width: f64, dimensions: usize) -> f64 {
    let mut now = *now;
    for d in dimensions..3 {
        (then[(d, d)], now[(d, d)]) = (width * width, width * width);
    }
    // A thin row of points spans its line only.
    let volume = then.diagonal().iter().product::<f64>();
    match then.try_inverse() {
        Some(inverse) if then.determinant() > 1e-6 * volume => {
            let gradient = now * inverse;
            (0.5 * (gradient.transpose() * gradient - Matrix3::identity())).norm()
        }
        _ => 0.0,
    }
}

impl Observer for SmallStrain {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let (dimensions, axisymmetric) = (now.solver().dimensions(), now.solver().axisymmetric());
        let bodies = now.bodies();
        if self.bodies.len() != bodies.len() {
            self.bodies = bodies.iter().map(|body| Followed::new(*body, dimensions, axisymmetric)).collect();
        }
        for (followed, body) in self.bodies.iter_mut().zip(bodies) {
            followed.look(body, dimensions, axisymmetric);
        }
        Ok(())
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.bodies, &Followed::default(), |file, body| {
            file.text(&mut body.name)?;
            file.list(&mut body.start, &[0.0; 3], |file, x| file.reals(x))?;
            file.list(&mut body.widths, &0.0, Archive::real)?;
            file.list(&mut body.largest, &0.0, Archive::real)?;
            file.flag(&mut body.left_out)?;
            if file.reads() {
                let count = body.start.len();
                if body.widths.len() != count || body.largest.len() != count {
                    return Err(file.damaged("strains of other points than there are"));
                }
                body.find_neighbours();
            }
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sums(f: Matrix3<f64>, dimensions: usize) -> f64 {
        let (mut now, mut then) = (Matrix3::zeros(), Matrix3::zeros());
        for i in 0..27 {
            let x = nalgebra::Vector3::from_fn(|d, _| {
                if d < dimensions { f64::from(i / 3i32.pow(d as u32) % 3 - 1) } else { 0.0 }
            });
            now += (f * x) * x.transpose();
            then += x * x.transpose();
        }
        strain(&now, then, 1.0, dimensions)
    }

    #[test]
    fn strain_is_that_of_the_gradient_and_blind_to_rotations() {
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -1.1, 2.0);
        let stretch = Matrix3::from_diagonal(&nalgebra::Vector3::new(1.2, 1.0, 1.0));
        assert!((sums(turn * stretch, 3) - 0.5 * (1.44 - 1.0)).abs() < 1e-12);
        let about_z = nalgebra::Rotation3::from_euler_angles(0.0, 0.0, 0.7);
        assert!((sums(about_z * stretch, 2) - 0.22).abs() < 1e-12);
        assert!(sums(turn.into_inner(), 3) < 1e-12);
        // A row of points defines no strain.
        assert_eq!(
            strain(&Matrix3::zeros(), Matrix3::from_diagonal(&nalgebra::Vector3::new(2.0, 0.0, 0.0)), 1.0, 2),
            0.0
        );
    }
}
