//! Division of a body into cells, each with one point, and the faces between them.

mod domain;
mod error;
mod mesh;
mod notch;
mod polytope;
mod scatter;
mod voronoi;

pub use domain::Domain;
pub use error::CellsError;
pub use notch::Notch;
pub use scatter::{relaxed, scattered};

use impactite_geometry::Bounds;
use polytope::{Beyond, Polytope};

use crate::vector::{Tensor, add_dyad, along, difference, norm, scaled, zero};
use voronoi::{refused, tessellate};

/// Face between two cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face<const D: usize> {
    /// Cells of the face, the smaller number first.
    pub cells: [u32; 2],
    /// Area, m^2 (length in the plane, m).
    pub area: f64,
    /// Unit normal from the first cell to the second.
    pub normal: [f64; D],
    /// Centroid, m.
    pub centroid: [f64; D],
    /// True if the face is open from the start, as a part of a notch.
    pub open: bool,
    /// Gap of a notch: approach of its sides before they are in contact, m.
    pub gap: f64,
}

/// Face on the surface of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OuterFace<const D: usize> {
    /// Cell of the face.
    pub cell: u32,
    /// Area, m^2 (length in the plane, m).
    pub area: f64,
    /// Unit normal, outwards.
    pub normal: [f64; D],
    /// Centroid, m.
    pub centroid: [f64; D],
}

/// Cells that fill a body without overlap, in the plane or in space: Voronoi cells of points in a convex [`Domain`] ([`Cells::voronoi`]),
/// or elements of a mesh ([`Cells::of_mesh`]).
///
/// Every cell has one point, its centroid, so that its mass has the correct angular momentum. Cells are neighbours by the points that were
/// given.
///
/// ```
/// use fpm::{Cells, Domain, Notch, relaxed, scattered};
/// // A plate of 100 mm x 100 mm with a notch, of cells of about 2 mm from the seed 7, finer in one corner.
/// let plate = Domain::cuboid([0.0, 0.0], [0.1, 0.1])?;
/// let spacing = |[x, y]: [f64; 2]| if x > 0.05 && y > 0.05 { 2e-3 } else { 4e-3 };
/// let points = relaxed(scattered(&plate, 7, spacing)?, &plate, 5)?;
/// let cells = Cells::voronoi(&points, &plate)?.with_notch(&Notch::segment([0.0, 0.025], [0.05, 0.025])?)?;
/// let volume: f64 = cells.volumes().iter().sum();
/// assert!((volume - 0.01).abs() < 1e-14);
/// assert!(cells.faces().iter().any(|f| f.open));
/// # Ok::<(), fpm::CellsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Cells<const D: usize> {
    points: Vec<[f64; D]>,
    volumes: Vec<f64>,
    faces: Vec<Face<D>>,
    outer: Vec<OuterFace<D>>,
    /// Corners of all cells in sequence, and the end of those of each cell; empty if they are not stored.
    corners: Vec<[f64; D]>,
    ends: Vec<u32>,
}

/// Smallest area of a face over V^((D - 1)/D) of both cells.
const SLIVER: f64 = 1e-12;
/// Tolerance of the closure of a cell by its faces, over its surface.
const CLOSED: f64 = 1e-9;

impl<const D: usize> Cells<D> {
    /// Create the Voronoi cells of `points` (m) in a domain.
    ///
    /// Cells are cut by the bisecting planes of neighbours from the neighbour search: the algorithm is the same for plane and space and for
    /// any convex domain, and facets know their side of the domain.
    ///
    /// # Errors
    /// No point; a point outside; a duplicate point.
    pub fn voronoi(points: &[[f64; D]], domain: &Domain<D>) -> Result<Self, CellsError> {
        error::parameter(!points.is_empty(), "cells", "points", points.len() as f64, "at least one")?;
        let polytopes = tessellate(points, domain)?;
        let mut parts = Parts::default();
        for (i, (polytope, x)) in polytopes.iter().zip(points).enumerate() {
            let (volume, centroid) = polytope.volume_and_centroid(x);
            parts.points.push(centroid);
            parts.volumes.push(volume);
            let least = SLIVER * volume.abs().powf((D as f64 - 1.0) / D as f64);
            for facet in &polytope.facets {
                let (area, centroid) = facet.measure();
                match facet.beyond {
                    Beyond::Outside(_) => parts.outside(i, area, centroid),
                    // A face needs a facet of both cells.
                    Beyond::Cell(j) if (j as usize) > i && norm(&area) > least => {
                        let back = polytopes[j as usize].facets.iter();
                        let meets = |f: &&polytope::Facet<D>| {
                            f.beyond == Beyond::Cell(i as u32) && norm(&f.measure().0) > least
                        };
                        if back.filter(meets).count() > 0 {
                            parts.between([i, j as usize], area, centroid);
                        }
                    }
                    Beyond::Cell(_) => {}
                }
            }
            parts.corners.push(if D == 2 { ring(polytope) } else { Vec::new() });
        }
        parts.finish()
    }

    /// Points, the centroids of the cells, m.
    #[must_use]
    pub fn points(&self) -> &[[f64; D]] {
        &self.points
    }
    /// Volumes of the cells, m^3 (areas in the plane, m^2).
    #[must_use]
    pub fn volumes(&self) -> &[f64] {
        &self.volumes
    }
    /// Faces between cells.
    #[must_use]
    pub fn faces(&self) -> &[Face<D>] {
        &self.faces
    }
    /// Faces on the surface.
    #[must_use]
    pub fn outer(&self) -> &[OuterFace<D>] {
        &self.outer
    }
    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.points.len()
    }
    /// True if there are no cells.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
    /// Corners of a cell, m: of an element in the order of the VTK file format; of a Voronoi cell in the plane counter-clockwise; none of a
    /// Voronoi cell in space.
    ///
    /// # Panics
    /// There is no such cell.
    #[must_use]
    pub fn corners(&self, cell: usize) -> &[[f64; D]] {
        let start = if cell == 0 { 0 } else { self.ends[cell - 1] };
        &self.corners[start as usize..self.ends[cell] as usize]
    }
    /// Bounding box of the points.
    #[must_use]
    pub fn bounds(&self) -> Bounds<D> {
        Bounds::around(self.points.iter().copied())
    }

    /// Open the faces between points on different sides of a notch.
    ///
    /// # Errors
    /// A notch that separates no points.
    pub fn with_notch(mut self, notch: &Notch<D>) -> Result<Self, CellsError> {
        let mut count = 0;
        for face in &mut self.faces {
            let [a, b] = face.cells.map(|c| &self.points[c as usize]);
            if notch.crosses(a, b) {
                (face.open, face.gap) = (true, notch.gap());
                count += 1;
            }
        }
        let allowed = "at least one: it must reach into the body by more than half a cell";
        error::parameter(count > 0, "notch", "faces that it opens", 0.0, allowed)?;
        Ok(self)
    }
}

/// Corners of a polygon in order.
fn ring<const D: usize>(polytope: &Polytope<D>) -> Vec<[f64; D]> {
    polytope.facets.iter().map(|f| f.corners[0]).collect()
}

/// Cells under construction.
#[derive(Default)]
struct Parts<const D: usize> {
    points: Vec<[f64; D]>,
    volumes: Vec<f64>,
    faces: Vec<Face<D>>,
    outer: Vec<OuterFace<D>>,
    corners: Vec<Vec<[f64; D]>>,
}

impl<const D: usize> Parts<D> {
    fn outside(&mut self, cell: usize, area: [f64; D], centroid: [f64; D]) {
        let size = norm(&area);
        if size > 0.0 {
            let normal = scaled(&area, 1.0 / size);
            self.outer.push(OuterFace { cell: cell as u32, area: size, normal, centroid });
        }
    }

    /// Add a face between two cells; `area` points out of the first one.
    fn between(&mut self, [a, b]: [usize; 2], area: [f64; D], centroid: [f64; D]) {
        let size = norm(&area);
        let normal = scaled(&area, if a < b { 1.0 } else { -1.0 } / size);
        let cells = [a.min(b) as u32, a.max(b) as u32];
        self.faces.push(Face { cells, area: size, normal, centroid, open: false, gap: 0.0 });
    }

    /// Check the parts and create the cells.
    fn finish(self) -> Result<Cells<D>, CellsError> {
        let Parts { points, volumes, mut faces, outer, corners } = self;
        faces.sort_by_key(|f| f.cells);
        check(&points, &volumes, &faces, &outer)?;
        let mut end = 0;
        let ends = corners.iter().map(|c| {
            end += c.len() as u32;
            end
        });
        let ends = ends.collect();
        Ok(Cells { points, volumes, faces, outer, corners: corners.concat(), ends })
    }
}

/// Check volumes, and the closure of surfaces, sum A n = 0 and sum A n (x) (x - X) = V I, on which the consistency of the method depends.
fn check<const D: usize>(
    points: &[[f64; D]],
    volumes: &[f64],
    faces: &[Face<D>],
    outer: &[OuterFace<D>],
) -> Result<(), CellsError> {
    let mut surface = vec![(0.0, [0.0; D], zero::<D>()); points.len()];
    let mut add = |cell: u32, area: f64, normal: &[f64; D], centroid: &[f64; D]| {
        let (all, sum, moment): &mut (f64, [f64; D], Tensor<D>) = &mut surface[cell as usize];
        *all += area;
        *sum = along(sum, area, normal);
        add_dyad(moment, area, normal, &difference(centroid, &points[cell as usize]));
    };
    for Face { cells: [a, b], area, normal, centroid, .. } in faces {
        add(*a, *area, normal, centroid);
        add(*b, *area, &scaled(normal, -1.0), centroid);
    }
    outer.iter().for_each(|f| add(f.cell, f.area, &f.normal, &f.centroid));
    for (i, (area, sum, moment)) in surface.iter().enumerate() {
        let (x, volume) = (&points[i], volumes[i]);
        if !(volume > 0.0 && volume.is_finite()) {
            return Err(refused(i, x, "volume", volume, "positive and finite"));
        }
        let mut left = norm(sum) / area;
        for a in 0..D {
            for b in 0..D {
                let wanted = if a == b { volume } else { 0.0 };
                left = left.max((moment[a][b] - wanted).abs() / volume);
            }
        }
        if left.is_nan() || left > CLOSED {
            let allowed = "zero: its faces must close it";
            return Err(refused(i, x, "what its faces leave open, over all", left, allowed));
        }
    }
    Ok(())
}
