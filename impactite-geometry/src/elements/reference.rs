//! Isoparametric mapping of reference elements: Jacobians, measures, quality.

use super::{ElementKind, ElementMesh, MeshError};
use crate::error::GeometryError;
use crate::shape::Metric;
use crate::vector::{dot, sum};

/// Maximum number of nodes of an element.
pub(super) const MOST_NODES: usize = 8;

/// Signs of the natural coordinates of the nodes of a brick; the first four are those of a quadrilateral, the first two those of a bar.
const SIGNS: [[f64; 3]; MOST_NODES] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

impl ElementKind {
    /// True for a bar, a triangle or a tetrahedron, whose Jacobian is constant.
    #[must_use]
    pub fn is_simplex(self) -> bool {
        self.nodes() == self.dimensions() + 1
    }

    /// Quadrature points and weight of a rule that integrates the Jacobian of the element and r times the Jacobian exactly: two Gauss
    /// points per axis. The Jacobian of a brick is quadratic in every coordinate, r times that of a quadrilateral too; the rule is exact to
    /// degree 3.
    fn rule(self) -> (impl Iterator<Item = [f64; 3]>, f64) {
        let place = 3.0f64.sqrt().recip();
        let (points, scale, middle, weight) = match self {
            ElementKind::Bar2 => (1, 0.0, 0.0, 2.0),
            ElementKind::Triangle3 => (1, 0.0, 1.0 / 3.0, 0.5),
            ElementKind::Tetra4 => (1, 0.0, 0.25, 1.0 / 6.0),
            ElementKind::Quad4 | ElementKind::Hexa8 => (self.nodes(), place, 0.0, 1.0),
        };
        (SIGNS[..points].iter().map(move |s| s.map(|c| scale * c + middle)), weight)
    }

    /// Values of the shape functions of the nodes at the natural coordinates `xi`: -1 to 1 along the axes of bricks, quadrilaterals and
    /// bars; barycentric coordinates of all nodes but the first for triangles and tetrahedra. Entries of unused nodes are zero.
    #[must_use]
    pub fn shape_functions(self, xi: [f64; 3]) -> [f64; MOST_NODES] {
        let (nodes, dimensions) = (self.nodes(), self.dimensions());
        let mut values = [0.0; MOST_NODES];
        for a in 0..nodes {
            values[a] = match self {
                ElementKind::Triangle3 | ElementKind::Tetra4 if a == 0 => {
                    1.0 - xi[..dimensions].iter().sum::<f64>()
                }
                ElementKind::Triangle3 | ElementKind::Tetra4 => xi[a - 1],
                _ => (0..dimensions).map(|i| 0.5 * (1.0 + SIGNS[a][i] * xi[i])).product(),
            };
        }
        values
    }

    /// Derivatives of the [shape functions](Self::shape_functions) with respect to the natural coordinates at `xi`.
    #[must_use]
    pub fn shape_gradients(self, xi: [f64; 3]) -> [[f64; 3]; MOST_NODES] {
        let (nodes, dimensions) = (self.nodes(), self.dimensions());
        let mut gradients = [[0.0; 3]; MOST_NODES];
        for a in 0..nodes {
            for i in 0..dimensions {
                gradients[a][i] = match self {
                    ElementKind::Triangle3 | ElementKind::Tetra4 if a == 0 => -1.0,
                    ElementKind::Triangle3 | ElementKind::Tetra4 => f64::from(u8::from(a == i + 1)),
                    _ => {
                        let others = (0..dimensions).filter(|&j| j != i);
                        let rest: f64 = others.map(|j| 0.5 * (1.0 + SIGNS[a][j] * xi[j])).product();
                        0.5 * SIGNS[a][i] * rest
                    }
                };
            }
        }
        gradients
    }
}

/// Shape functions at one point of a reference element.
struct Point {
    values: [f64; MOST_NODES],
    gradients: [[f64; 3]; MOST_NODES],
}

/// Reference element of a kind: shape functions at the corners and at the quadrature points.
pub(super) struct Reference {
    kind: ElementKind,
    corners: Vec<Point>,
    within: Vec<Point>,
    /// Weight of each quadrature point.
    weight: f64,
}

impl Reference {
    pub fn new(kind: ElementKind) -> Self {
        let point = |xi| Point { values: kind.shape_functions(xi), gradients: kind.shape_gradients(xi) };
        // The Jacobian of a simplex is constant: one corner suffices.
        let corners = if kind.is_simplex() { 1 } else { kind.nodes() };
        let (within, weight) = kind.rule();
        Self {
            kind,
            corners: SIGNS[..corners].iter().map(|&xi| point(xi)).collect(),
            within: within.map(point).collect(),
            weight,
        }
    }

    /// Return an element of the mesh. Its nodes must be in range.
    pub fn element<const D: usize>(&self, mesh: &ElementMesh<D>, nodes: &[u32]) -> Element<'_, D> {
        let mut x = [[0.0; D]; MOST_NODES];
        for (x, &node) in x.iter_mut().zip(nodes) {
            *x = mesh.nodes[node as usize];
        }
        Element { reference: self, x }
    }
}

/// Element with the positions of its nodes.
pub(super) struct Element<'a, const D: usize> {
    reference: &'a Reference,
    x: [[f64; D]; MOST_NODES],
}

/// Jacobian, and scaled Jacobian: the Jacobian over the product of the lengths of its columns.
#[derive(Clone, Copy)]
pub(super) struct Jacobian {
    pub value: f64,
    pub scaled: f64,
}

impl<const D: usize> Element<'_, D> {
    /// Jacobian at a point: the determinant if the element has as many dimensions as space, else the square root of the Gram
    /// determinant, which has no sign.
    fn jacobian(&self, point: &Point) -> Jacobian {
        let kind = self.reference.kind;
        let dimensions = kind.dimensions();
        let mut columns = [[0.0; D]; 3];
        for (gradient, x) in point.gradients[..kind.nodes()].iter().zip(&self.x) {
            for (column, g) in columns.iter_mut().zip(gradient) {
                for d in 0..D {
                    column[d] += g * x[d];
                }
            }
        }
        let value = if dimensions == D {
            determinant(dimensions, |i, j| columns[i][j])
        } else {
            determinant(dimensions, |i, j| dot(columns[i], columns[j])).max(0.0).sqrt()
        };
        let squares: f64 = columns[..dimensions].iter().map(|&c| dot(c, c)).product();
        Jacobian { value, scaled: value / squares.sqrt() }
    }

    /// Jacobians at the corners; one only for a simplex.
    pub fn corners(&self) -> impl Iterator<Item = Jacobian> + '_ {
        self.reference.corners.iter().map(|point| self.jacobian(point))
    }

    /// Jacobians at the quadrature points.
    pub fn within(&self) -> impl Iterator<Item = Jacobian> + '_ {
        self.reference.within.iter().map(|point| self.jacobian(point))
    }

    /// Length, area or volume; per radian in an axisymmetric metric.
    pub fn measure(&self, metric: Metric) -> f64 {
        let terms = self.reference.within.iter().map(|point| {
            let radius = match metric {
                Metric::Cartesian => 1.0,
                Metric::Axisymmetric => point.values.iter().zip(&self.x).map(|(n, x)| n * x[0]).sum(),
            };
            self.reference.weight * radius * self.jacobian(point).value
        });
        terms.sum()
    }
}

/// Determinant of a matrix of one to three rows.
fn determinant(rows: usize, m: impl Fn(usize, usize) -> f64) -> f64 {
    match rows {
        1 => m(0, 0),
        2 => m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0),
        _ => {
            let minor = |i: usize, j: usize| m(1, i) * m(2, j) - m(1, j) * m(2, i);
            m(0, 0) * minor(1, 2) - m(0, 1) * minor(0, 2) + m(0, 2) * minor(0, 1)
        }
    }
}

/// Element quality: the worst values of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Smallest over largest Jacobian at the corners of one element: 1 for parallelepipeds and simplices, zero or negative for an
    /// element that folds over.
    pub jacobian_ratio: f64,
    /// Smallest scaled Jacobian at a corner, the Jacobian over the product of the lengths of its columns: 1 for rectangles, zero for flat
    /// corners. For simplices it is that of the edges of the first node.
    pub scaled_jacobian: f64,
}

impl<const D: usize> ElementMesh<D> {
    /// Evaluate `ask` for all elements, block by block. Node indices must be in range.
    fn each<T>(&self, ask: impl Fn(&Element<D>) -> T) -> Vec<T> {
        let mut found = Vec::with_capacity(self.elements());
        for block in &self.blocks {
            let reference = Reference::new(block.kind);
            found.extend(block.elements().map(|nodes| ask(&reference.element(self, nodes))));
        }
        found
    }

    /// Volume (m3), area (m2) or length (m) of one element, exact to rounding (a warped quadrilateral in space: by four
    /// Gauss points); with [`Metric::Axisymmetric`] the integral of the first coordinate over the element. Negative for inverted elements.
    ///
    /// # Errors
    /// [`MeshError`] if there is no such element, or any element refers to a node that does not exist.
    pub fn measure_of(&self, block: usize, element: usize, metric: Metric) -> Result<f64, GeometryError> {
        self.check_numbers()?;
        let found = self.blocks.get(block).and_then(|b| Some((b.kind, b.elements().nth(element)?)));
        let (kind, nodes) = found.ok_or_else(|| MeshError::NoElement {
            block,
            element,
            allowed: match self.blocks.get(block) {
                Some(b) => format!("elements below {}", b.len()),
                None => format!("blocks below {}", self.blocks.len()),
            },
        })?;
        Ok(Reference::new(kind).element(self, nodes).measure(metric))
    }

    /// Measures of all elements, block by block, as defined by [`measure_of`](Self::measure_of).
    ///
    /// # Errors
    /// [`MeshError`] if an element refers to a node that does not exist.
    pub fn measures(&self, metric: Metric) -> Result<Vec<f64>, GeometryError> {
        self.check_numbers()?;
        Ok(self.each(|e| e.measure(metric)))
    }

    /// Sum of the [`measures`](Self::measures) of all elements, by compensated summation: volume of bricks and tetrahedra (m3), area of
    /// plane elements (m2), length of bars (m), or the sum of these in a mixed mesh.
    ///
    /// # Errors
    /// Errors of [`measures`](Self::measures).
    pub fn measure(&self, metric: Metric) -> Result<f64, GeometryError> {
        Ok(sum(self.measures(metric)?))
    }

    /// Worst element quality of the mesh.
    ///
    /// # Errors
    /// [`MeshError`] if an element refers to a node that does not exist, or if there is no element.
    pub fn quality(&self) -> Result<Quality, GeometryError> {
        self.check_numbers()?;
        let worst = self.each(|e| {
            let (mut low, mut high, mut scaled) = (f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY);
            for j in e.corners() {
                (low, high, scaled) = (low.min(j.value), high.max(j.value), scaled.min(j.scaled));
            }
            // The modulus: if all corners are inverted, the ratio of two negative Jacobians would be positive.
            Quality { jacobian_ratio: low / high.abs(), scaled_jacobian: scaled }
        });
        let least = worst.into_iter().reduce(|a, b| Quality {
            jacobian_ratio: a.jacobian_ratio.min(b.jacobian_ratio),
            scaled_jacobian: a.scaled_jacobian.min(b.scaled_jacobian),
        });
        Ok(least.ok_or(MeshError::Empty { what: "its quality" })?)
    }
}
