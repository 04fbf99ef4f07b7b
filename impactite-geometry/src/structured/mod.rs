//! Structured meshes of simple shapes: boxes, and block-structured round bodies without collapsed elements.
//!
//! | function | body | elements |
//! |---|---|---|
//! | [`box_mesh`] | [`Cuboid`] in one to three dimensions | bars, quadrilaterals, bricks |
//! | [`ball_mesh`] | [`Ball`](crate::Ball): disc, sphere | quadrilaterals, bricks |
//! | [`half_disc_mesh`] | section (r, z) of a ball | quadrilaterals |
//! | [`ring_mesh`], [`tube_mesh`] | [`Ring`](crate::Ring), [`Tube`](crate::Tube) | quadrilaterals, bricks |
//! | [`cylinder_mesh`] | [`Cylinder`](crate::Cylinder) | bricks |
//! | [`ogive_rod_mesh`] | [`OgiveRod`](crate::OgiveRod), also with a hemispherical nose | bricks |
//! | [`ogive_rod_section_mesh`] | section (r, z) of an [`OgiveRod`](crate::OgiveRod) | quadrilaterals |
//! | [`wedge_mesh`] | a triangle | quadrilaterals, triangles |
//!
//! Round bodies have a butterfly mesh ([`Butterfly`], O-grid): a core of squares, and rings of elements around it up to the surface, with
//! all outer nodes on the surface. Chords underestimate area and volume; the error converges with the square of the element size. Split
//! the meshes for simplices ([`split_to_triangles`](crate::ElementMesh::split_to_triangles)), extrude sections
//! ([`extruded`](crate::ElementMesh::extruded)), and join and weld them for other bodies.
//!
//! ```
//! use impactite_geometry::structured::{self, Butterfly};
//! use impactite_geometry::{Metric, OgiveRod, Shape};
//! // The rod of 20 g against aluminium: 7.11 mm x 88.9 mm, calibre-radius-head 3.
//! let rod = OgiveRod::new([0.0; 3], [0.0, 0.0, 1.0], 7.11e-3, 88.9e-3, 3.0)?;
//! let mesh = structured::ogive_rod_mesh(&rod, Butterfly { core: 8, rings: 3 }, 60)?;
//! let (found, exact) = (mesh.measure(Metric::Cartesian)?, rod.measure().unwrap_or(0.0));
//! assert!((found / exact - 1.0).abs() < 0.01);
//! assert!(mesh.quality()?.scaled_jacobian > 0.2);
//! assert!(mesh.node_sets["nose"].iter().all(|&n| rod.signed_distance(mesh.nodes[n as usize]).abs() < 1e-12));
//! # Ok::<(), impactite_geometry::GeometryError>(())
//! ```

mod nose;
mod round;
mod wedge;

pub use nose::{ogive_rod_mesh, ogive_rod_section_mesh};
pub use round::{Butterfly, ball_mesh, cylinder_mesh, half_disc_mesh, ring_mesh, tube_mesh};
pub use wedge::wedge_mesh;

use impactite_simd::memory::{Budget, MOST_BYTES};

use crate::elements::{ElementBlock, ElementKind, ElementMesh, Facet};
use crate::error::{Check, GeometryError};
use crate::primitives::Cuboid;

/// Division of an axis into elements: uniform (a plain number converts) or in a geometric series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing {
    /// Number of elements.
    count: usize,
    /// Growth ratio: length of the last element over that of the first.
    ratio: f64,
}

impl Spacing {
    /// Create `count` elements of equal length.
    #[must_use]
    pub fn uniform(count: usize) -> Self {
        Self { count, ratio: 1.0 }
    }
    /// Create `count` elements in geometric progression, the last one `ratio` times as long as the first.
    #[must_use]
    pub fn graded(count: usize, ratio: f64) -> Self {
        Self { count, ratio }
    }
    /// Number of elements.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }
    /// Check count and ratio.
    fn check(self, owner: &'static str) -> Result<Self, GeometryError> {
        let check = Check(owner);
        check.that(self.count > 0, "count", self.count as f64, "at least 1")?;
        check.that(
            (1e-6..=1e6).contains(&self.ratio),
            "ratio",
            self.ratio,
            "last length over first, from 1e-6 to 1e6",
        )?;
        room(self.count as f64, self.count as f64, 2)?;
        Ok(self)
    }
    /// Return the fraction of the length at node `i`.
    fn fraction(self, i: usize) -> f64 {
        let (i, count) = (i as f64, self.count as f64);
        if self.ratio == 1.0 || self.count == 1 {
            return i / count;
        }
        // Lengths are powers of q = ratio^(1 / (count - 1)); expm1 avoids cancellation for ratios near 1.
        let log = self.ratio.ln() / (count - 1.0);
        (i * log).exp_m1() / (count * log).exp_m1()
    }
    /// Return the node coordinates from `start` to `end`, both exact.
    fn nodes(self, start: f64, end: f64) -> Vec<f64> {
        let at = |i| {
            if i == self.count { end } else { start + self.fraction(i) * (end - start) }
        };
        (0..=self.count).map(at).collect()
    }
}

impl From<usize> for Spacing {
    fn from(count: usize) -> Self {
        Self::uniform(count)
    }
}

/// Check that the mesh can be indexed and that its memory is within the limit.
pub(crate) fn room(nodes: f64, elements: f64, nodes_of_element: usize) -> Result<(), GeometryError> {
    let most = f64::from(Facet::NONE - 1);
    Check("mesh").that(nodes.max(elements) <= most, "nodes", nodes.max(elements), "at most 4294967294")?;
    let budget = Budget { what: "the mesh", allowed: MOST_BYTES, remedy: "ask for fewer elements" };
    budget.holds(24.0 * nodes + 4.0 * nodes_of_element as f64 * elements)?;
    Ok(())
}

/// Mesh a box with bars, quadrilaterals or bricks, `counts` of them along the axes: numbers, or [`Spacing`] for graded meshes. Nodes and
/// elements are numbered along the first axis first. The node sets `x_min`, `x_max`, `y_min`, ... are the faces.
///
/// ```
/// use impactite_geometry::structured::{Spacing, box_mesh};
/// use impactite_geometry::{Cuboid, Metric};
/// // A target in (r, z), fine about the axis: the last element is eight times as long as the first.
/// let target = Cuboid::new([0.0, -0.1], [0.2, 0.0])?;
/// let mesh = box_mesh(&target, [Spacing::graded(30, 8.0), Spacing::uniform(40)])?;
/// assert!((mesh.measure(Metric::Axisymmetric)? - 0.002).abs() < 1e-15);
/// assert_eq!(mesh.node_sets["x_min"].len(), 41);
/// # Ok::<(), impactite_geometry::GeometryError>(())
/// ```
///
/// # Errors
/// [`GeometryError::Parameter`] unless counts are positive, ratios between 1e-6 and 1e6, and there are one to three dimensions;
/// [`GeometryError::Memory`] for too many elements.
pub fn box_mesh<const D: usize>(
    body: &Cuboid<D>,
    counts: [impl Into<Spacing>; D],
) -> Result<ElementMesh<D>, GeometryError> {
    Check("box mesh").that((1..=3).contains(&D), "number of dimensions", D as f64, "1, 2 or 3")?;
    let counts: [Spacing; D] = counts.map(Into::into);
    for spacing in counts {
        spacing.check("box mesh")?;
    }
    let kind = [ElementKind::Bar2, ElementKind::Quad4, ElementKind::Hexa8][D - 1];
    let product = |extra: f64| counts.iter().map(|c| c.count as f64 + extra).product();
    room(product(1.0), product(0.0), kind.nodes())?;

    let (min, max) = (body.min(), body.max());
    let axes: [Vec<f64>; D] = std::array::from_fn(|d| counts[d].nodes(min[d], max[d]));
    let size = counts.map(|c| c.count + 1);
    let nodes = indices(size).map(|i| std::array::from_fn(|d| axes[d][i[d]])).collect();
    let mut strides = [1; D];
    for d in 1..D {
        strides[d] = strides[d - 1] * size[d - 1];
    }
    let number = |i: [usize; D]| (0..D).map(|d| i[d] * strides[d]).sum::<usize>();
    // The nodes of a brick run around each face.
    const CORNERS: [[usize; 3]; 8] =
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let corner = |i, c: &[usize; 3]| number(i) + (0..D).map(|d| c[d] * strides[d]).sum::<usize>();
    let elements = indices(counts.map(|c| c.count))
        .flat_map(|i| CORNERS[..kind.nodes()].iter().map(move |c| corner(i, c) as u32))
        .collect();
    let mut mesh = ElementMesh {
        nodes,
        blocks: vec![ElementBlock { name: String::new(), kind, nodes: elements }],
        ..Default::default()
    };
    for d in 0..D {
        for (side, at) in [("min", 0), ("max", counts[d].count)] {
            let face = indices(size).filter(|i| i[d] == at).map(|i| number(i) as u32).collect();
            mesh.node_sets.insert(format!("{}_{side}", ["x", "y", "z"][d]), face);
        }
    }
    mesh.check()?;
    Ok(mesh)
}

/// Iterate over all tuples below `size`; the first index varies fastest.
fn indices<const D: usize>(size: [usize; D]) -> impl Iterator<Item = [usize; D]> {
    (0..size.iter().product()).map(move |mut n| {
        size.map(|s| {
            let i = n % s;
            n /= s;
            i
        })
    })
}
