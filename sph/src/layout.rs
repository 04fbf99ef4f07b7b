//! Initial particle layout, and its checks.

use impactite_geometry::{Filling, GeometryError, Lattice, Seeds, Shape, fill};
use impactite_scene::error::parameter;
use impactite_scene::{Embedding, SceneError};

/// Upper bound of the number of particles (excluded).
const MOST: f64 = (1u32 << 29) as f64;

/// Sampling points per axis for the part of a cell within a shape; a part below `SLIVER` is merged into a neighbour. The part in a corner
/// of three faces is an eighth.
const SUBSAMPLES: usize = 8;
const SLIVER: f64 = 0.1;

/// Initial state of a body: positions, volumes and spacings of its particles.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout<const D: usize> {
    /// Positions, m.
    pub positions: Vec<[f64; D]>,
    /// Particle volumes: m^3 (m^2 in plane strain, m^3 per radian around an axis).
    pub volumes: Vec<f64>,
    /// Particle spacings, m: the smoothing length is the kernel's ratio times the spacing, and the surface is half a spacing beyond the
    /// particle. They may vary within a body; those of neighbours should be similar (within some per cent).
    pub spacings: Vec<f64>,
    /// Distance from the outermost particles to the surface of the body, in half spacings. Walls and other bodies are in contact with this
    /// surface. 1 for particles that fill their cells, 0 for particles on the surface.
    pub surface: f64,
}

impl<const D: usize> Layout<D> {
    /// Create a layout from the seeds of a shape. The spacing is the edge of a particle; the surface is half of it beyond the outermost
    /// ones.
    pub fn of_seeds(seeds: &Seeds<D>) -> Self {
        let volume: f64 = seeds.half_size.iter().map(|h| 2.0 * h).product();
        let spacing = volume.powf(1.0 / D as f64);
        Layout {
            positions: seeds.positions.clone(),
            volumes: seeds.volumes.clone(),
            spacings: vec![spacing; seeds.len()],
            surface: 1.0,
        }
    }

    /// Fill a shape with rows of particles on its faces. Along the axes that are `on`, particles are at lattice nodes, and so should the
    /// faces be; along the others they are in the middle of cells. A particle represents the cell around it and has the volume of the part
    /// of the cell within the shape: half a cell on a face, a quarter on an edge of two. The surface is at the particles.
    ///
    /// Measurements at such a face, and contact with it, are at particles. For particles within their cells the face is half a spacing
    /// beyond them: a first-order error in the spacing. Planes of symmetry must not go through particles: leave out the axes across them.
    /// Other bodies in contact with a face along an axis that is not `on` come half a spacing too close.
    ///
    /// `filling` selects whether volumes are per radian, and whether they are corrected to the measure of the shape.
    ///
    /// ```
    /// use impactite_geometry::{Cuboid, Filling, Lattice};
    /// use sph::Layout;
    /// // A bar around its axis (r, z) with rows of particles on both ends.
    /// let (bar, lattice) = (Cuboid::new([0.0; 2], [4.0e-3, 20.0e-3])?, Lattice::new([0.0; 2], 1.0e-3)?);
    /// let layout = Layout::on_faces(&bar, &lattice, [false, true], &Filling::new().axisymmetric())?;
    /// assert_eq!(layout.len(), 4 * 21);
    /// # Ok::<(), impactite_geometry::GeometryError>(())
    /// ```
    ///
    /// # Errors
    /// Errors of [`fill`].
    pub fn on_faces(
        shape: &(impl Shape<D> + ?Sized),
        lattice: &Lattice<D>,
        on: [bool; D],
        filling: &Filling,
    ) -> Result<Self, GeometryError> {
        let mut origin = lattice.origin();
        for (x, _) in origin.iter_mut().zip(on).filter(|(_, on)| *on) {
            *x -= 0.5 * lattice.spacing();
        }
        let cells = Lattice::new(origin, lattice.spacing())?;
        let seeds = fill(shape, &cells, 1, &filling.partial(SUBSAMPLES, SLIVER))?;
        Ok(Layout { surface: 0.0, ..Self::of_seeds(&seeds) })
    }

    /// Append another layout, for the same body.
    #[must_use]
    pub fn and(mut self, other: Layout<D>) -> Self {
        self.positions.extend(other.positions);
        self.volumes.extend(other.volumes);
        self.spacings.extend(other.spacings);
        self
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.positions.len()
    }
    /// True if there are no particles.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Check the number of particles, the lengths of the lists and the ranges of the values.
    pub(crate) fn check(&self, hoop: bool) -> Result<(), SceneError> {
        let particles = self.len();
        if particles == 0 {
            return Err(SceneError::Empty(BODY.into()));
        }
        if particles as f64 >= MOST {
            return Err(SceneError::TooMany { body: BODY.into(), count: particles, most: MOST as usize - 1 });
        }
        for (field, found) in [("volumes", self.volumes.len()), ("spacings", self.spacings.len())] {
            if found != particles {
                return Err(SceneError::Length { field, found, particles });
            }
        }
        let allowed = "zero or positive, and finite";
        parameter(
            self.surface >= 0.0,
            "layout",
            "surface beyond particles in half spacings",
            self.surface,
            allowed,
        )?;
        for (n, x) in self.positions.iter().enumerate() {
            for &value in x {
                number(value.is_finite(), "position", n, value, "finite")?;
            }
            if hoop {
                number(x[0] > 0.0, "distance from the axis", n, x[0], "positive")?;
            }
        }
        for (field, list) in [("volume", &self.volumes), ("spacing", &self.spacings)] {
            for (n, &value) in list.iter().enumerate() {
                number(value > 0.0 && value.is_finite(), field, n, value, "positive and finite")?;
            }
        }
        Ok(())
    }

    /// Sort particles along a space-filling curve (Morton order) in cells of a few spacings, for memory locality. Return the layout number
    /// of each place.
    pub(crate) fn order(&self) -> Vec<u32> {
        let (mut low, mut cell) = ([f64::INFINITY; D], 0.0);
        for (x, spacing) in self.positions.iter().zip(&self.spacings) {
            for d in 0..D {
                low[d] = low[d].min(x[d]);
            }
            cell += 4.0 * spacing / self.len() as f64;
        }
        let key = |n: &u32| {
            let mut key = 0u64;
            for d in 0..D {
                // Values beyond the range of an integer saturate.
                let along = ((self.positions[*n as usize][d] - low[d]) / cell) as u64;
                for bit in 0..20 {
                    key |= (along >> bit & 1) << (bit * D + d);
                }
            }
            (key, *n)
        };
        let mut order: Vec<u32> = (0..self.len() as u32).collect();
        order.sort_by_cached_key(key);
        order
    }
}

impl Layout<2> {
    /// Create a rectangle of columns between the rising `edges` along the first axis. Each column has nearly square cells from `low` to
    /// `high` along the second axis, with a particle in the middle of each, so that spacings may grow along a body. Volumes are exact.
    ///
    /// # Errors
    /// Fewer than two edges; edges or ends that do not rise or are not finite; around an axis, a negative edge.
    pub fn of_columns<E: Embedding<2>>(
        _embedding: E,
        edges: &[f64],
        [low, high]: [f64; 2],
    ) -> Result<Layout<2>, SceneError> {
        let height = high - low;
        let rising = "finite, and above the one before";
        parameter(
            height > 0.0 && height.is_finite(),
            "layout of columns",
            "end along the second axis",
            high,
            rising,
        )?;
        let first = edges.first().copied().unwrap_or(f64::NAN);
        let inside = first.is_finite() && (!E::HOOP || first >= 0.0);
        parameter(inside, "layout of columns", "first edge", first, "finite, not negative around an axis")?;
        let mut layout =
            Layout { positions: Vec::new(), volumes: Vec::new(), spacings: Vec::new(), surface: 1.0 };
        for pair in edges.windows(2) {
            let (width, middle) = (pair[1] - pair[0], 0.5 * (pair[0] + pair[1]));
            parameter(width > 0.0 && width.is_finite(), "layout of columns", "edge", pair[1], rising)?;
            let cells = (height / width).round().max(1.0);
            let area = width * height / cells;
            for cell in 0..cells as usize {
                layout.positions.push([middle, low + (cell as f64 + 0.5) * height / cells]);
                layout.volumes.push(if E::HOOP { area * middle } else { area });
                layout.spacings.push(area.sqrt());
            }
        }
        if layout.is_empty() { Err(SceneError::Empty(BODY.into())) } else { Ok(layout) }
    }
}

/// Default name of a body.
pub(crate) const BODY: &str = "body";

/// Refuse a particle's number unless `holds`.
pub(crate) fn number(
    holds: bool,
    field: &'static str,
    particle: usize,
    value: f64,
    allowed: &'static str,
) -> Result<(), SceneError> {
    let body = || BODY.to_string();
    if holds { Ok(()) } else { Err(SceneError::Seed { body: body(), field, particle, value, allowed }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impactite_geometry::{Cuboid, Cylinder};
    use impactite_scene::{Axisymmetric, PlaneStrain};

    const H: f64 = 0.5e-3;

    #[test]
    fn rows_lie_on_the_faces_with_half_their_cells() {
        let size = [4.0 * H, 10.0 * H];
        let bar = Cuboid::new([0.0; 2], size).unwrap();
        let lattice = Lattice::new([0.0; 2], H).unwrap();
        let layout = Layout::on_faces(&bar, &lattice, [false, true], &Filling::new().axisymmetric()).unwrap();
        assert_eq!((layout.len(), layout.surface), (4 * 11, 0.0));
        for (n, &[r, z]) in layout.positions.iter().enumerate() {
            let at_end = [0.0, size[1]].iter().any(|end| (z - end).abs() < 1e-12 * H);
            assert!(at_end || (z > 0.9 * H && z < size[1] - 0.9 * H), "{z}");
            let share = if at_end { 0.5 } else { 1.0 };
            assert!((layout.volumes[n] / (share * H * H * r) - 1.0).abs() < 1e-12);
            assert_eq!(layout.spacings[n], H);
        }
        let measure: f64 = layout.volumes.iter().sum();
        assert!((measure / (0.5 * size[0].powi(2) * size[1]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn edges_and_corners_have_their_parts() {
        let block = Cuboid::new([0.0; 3], [3.0 * H; 3]).unwrap();
        let lattice = Lattice::new([0.0; 3], H).unwrap();
        let layout = Layout::on_faces(&block, &lattice, [true; 3], &Filling::new()).unwrap();
        assert_eq!(layout.len(), 4 * 4 * 4);
        for (x, volume) in layout.positions.iter().zip(&layout.volumes) {
            let faces = x.iter().filter(|x| **x < 0.1 * H || **x > 2.9 * H).count();
            assert!((volume / (0.5f64.powi(faces as i32) * H.powi(3)) - 1.0).abs() < 1e-12);
        }
    }

    /// Curved faces have no rows of particles, but the volume is exact.
    #[test]
    fn the_volume_of_a_curved_shape_is_its_own() {
        let rod = Cylinder::new([0.0; 3], [0.0, 0.0, 1.0], 8.0 * H, 4.0 * H).unwrap();
        let lattice = Lattice::new([0.0; 3], H).unwrap();
        let layout = Layout::on_faces(&rod, &lattice, [false, false, true], &Filling::new()).unwrap();
        let measure: f64 = layout.volumes.iter().sum();
        assert!((measure / rod.measure().unwrap() - 1.0).abs() < 1e-12);
        assert!(layout.positions.iter().any(|x| x[2].abs() < 1e-12 * H));
    }

    #[test]
    fn a_shape_smaller_than_a_cell_is_refused() {
        let lattice = Lattice::new([0.0; 2], H).unwrap();
        let speck = Cuboid::new([0.3 * H; 2], [0.31 * H; 2]).unwrap();
        assert!(Layout::on_faces(&speck, &lattice, [false; 2], &Filling::new()).is_err());
    }

    #[test]
    fn columns_fill_a_rectangle_exactly() {
        let edges = [0.0, 0.1, 0.2, 0.35, 0.7];
        let disc = Layout::of_columns(Axisymmetric, &edges, [1.0, 1.8]).expect("a layout");
        // Columns of 8, 8, 5 and 2 cells.
        assert_eq!(disc.len(), 23);
        let volume: f64 = disc.volumes.iter().sum();
        assert!((volume - 0.8 * 0.7 * 0.7 / 2.0).abs() < 1e-15, "{volume}");
        assert!((disc.spacings[0] - 0.1).abs() < 1e-15 && (disc.spacings[22] - 0.14f64.sqrt()).abs() < 1e-15);
        let [r, z] = disc.positions[22];
        assert!((r - 0.525).abs() < 1e-15 && (z - 1.6).abs() < 1e-15);
        let plate = Layout::of_columns(PlaneStrain, &edges, [1.0, 1.8]).expect("a layout");
        let area: f64 = plate.volumes.iter().sum();
        assert!((area - 0.8 * 0.7).abs() < 1e-15, "{area}");
        assert_eq!(plate.positions, disc.positions);
    }

    #[test]
    fn columns_that_cannot_be_are_refused() {
        for (edges, ends, said) in [
            (&[0.0, 0.2, 0.1][..], [0.0, 1.0], "edge = 0.1"),
            (&[-0.1, 0.2], [0.0, 1.0], "first edge = -0.1"),
            (&[0.0, 0.2], [1.0, 1.0], "end along the second axis = 1"),
            (&[0.0, f64::NAN], [0.0, 1.0], "edge = NaN"),
            (&[], [0.0, 1.0], "first edge = NaN"),
            (&[0.0], [0.0, 1.0], "no particle"),
        ] {
            let error = Layout::of_columns(Axisymmetric, edges, ends).expect_err(said).to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
