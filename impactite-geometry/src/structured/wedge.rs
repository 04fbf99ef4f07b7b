//! Meshes of wedges: triangles in the plane.

use super::room;
use super::round::between;
use crate::elements::{ElementBlock, ElementKind, ElementMesh};
use crate::error::{Check, GeometryError};
use crate::vector::sub;

/// Mesh a wedge, a triangle in the plane, by [`ElementKind::Triangle3`] or [`ElementKind::Quad4`] with `count` elements along each side.
/// Quadrilaterals need an even count and form three blocks that join at the centroid. The corners may have either orientation. Node
/// sets: `side_0` from the first corner to the second, `side_1`, `side_2`.
///
/// ```
/// use impactite_geometry::structured::wedge_mesh;
/// use impactite_geometry::{ElementKind, Metric};
/// // A wedge 1 m wide with a deadrise angle of 30 degrees, apex down.
/// let rise = 0.5 * 30f64.to_radians().tan();
/// let wedge = wedge_mesh([[0.0, 0.0], [0.5, rise], [-0.5, rise]], 8, ElementKind::Quad4)?;
/// assert_eq!(wedge.elements(), 3 * 16);
/// assert!((wedge.measure(Metric::Cartesian)? - 0.5 * rise).abs() < 1e-12);
/// # Ok::<(), impactite_geometry::GeometryError>(())
/// ```
///
/// # Errors
/// [`GeometryError::Parameter`] unless corners are finite and the count is allowed, [`GeometryError::Memory`] for too many elements,
/// [`MeshError`](crate::MeshError) for collinear corners and for other element types.
pub fn wedge_mesh(
    corners: [[f64; 2]; 3],
    count: usize,
    kind: ElementKind,
) -> Result<ElementMesh<2>, GeometryError> {
    let check = Check("wedge mesh");
    for corner in corners {
        check.point("corners", corner)?;
    }
    check.that(count > 0, "count", count as f64, "at least 1")?;
    room((count as f64 + 1.0).powi(2), (count as f64).powi(2), 4)?;
    let [a, b] = [sub(corners[1], corners[0]), sub(corners[2], corners[0])];
    let clockwise = a[0] * b[1] - a[1] * b[0] < 0.0;
    let turned = if clockwise { [corners[0], corners[2], corners[1]] } else { corners };
    let mut mesh = match kind {
        ElementKind::Triangle3 => triangles(turned, count),
        ElementKind::Quad4 => {
            let even = count.is_multiple_of(2);
            check.that(even, "count", count as f64, "even, and at least 2, for quadrilaterals")?;
            quadrilaterals(turned, count / 2)?
        }
        _ => {
            let (what, allowed) = ("a wedge", "triangles and quadrilaterals");
            let name = String::new();
            return Err(crate::MeshError::Kind { what, block: 0, name, kind, allowed }.into());
        }
    };
    mesh.check()?;
    for side in 0..3 {
        let [from, to] = [corners[side], corners[(side + 1) % 3]];
        let edge = sub(to, from);
        let square = edge[0] * edge[0] + edge[1] * edge[1];
        let on = |x: [f64; 2]| {
            let d = sub(x, from);
            (edge[0] * d[1] - edge[1] * d[0]).abs() <= 1e-9 / count as f64 * square
        };
        mesh.node_sets.insert(format!("side_{side}"), mesh.nodes_where(on));
    }
    Ok(mesh)
}

/// Mesh a triangle by `count` times `count` congruent triangles.
fn triangles([a, b, c]: [[f64; 2]; 3], count: usize) -> ElementMesh<2> {
    let n = count as f64;
    // Rows parallel to the first side; each is one node shorter than the previous one.
    let row = |j: usize| j * (count + 1) - j * j.saturating_sub(1) / 2;
    let number = |i: usize, j: usize| (row(j) + i) as u32;
    let mut mesh = ElementMesh::default();
    let mut nodes = Vec::new();
    for j in 0..=count {
        for i in 0..=count - j {
            let (u, v) = (i as f64 / n, j as f64 / n);
            mesh.nodes.push(std::array::from_fn(|d| (1.0 - u - v) * a[d] + u * b[d] + v * c[d]));
            if i + j < count {
                nodes.extend([number(i, j), number(i + 1, j), number(i, j + 1)]);
            }
            if i + j + 1 < count {
                nodes.extend([number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]);
            }
        }
    }
    mesh.blocks.push(ElementBlock { name: String::new(), kind: ElementKind::Triangle3, nodes });
    mesh
}

/// Mesh three blocks of `half` times `half` quadrilaterals, each between a corner, the midpoints of its sides, and the centroid.
fn quadrilaterals(corners: [[f64; 2]; 3], half: usize) -> Result<ElementMesh<2>, GeometryError> {
    let centroid = std::array::from_fn(|d| (corners[0][d] + corners[1][d] + corners[2][d]) / 3.0);
    let middle = |i: usize| between(corners[i % 3], corners[(i + 1) % 3], 0.5);
    let n = half as f64;
    let mut mesh = ElementMesh::<2>::default();
    let mut shortest = f64::INFINITY;
    for corner in 0..3 {
        let (start, end) = (middle(corner), middle(corner + 2));
        let first = mesh.nodes.len();
        let number = |i: usize, j: usize| (first + j * (half + 1) + i) as u32;
        let mut block = ElementMesh::default();
        let mut nodes = Vec::new();
        for j in 0..=half {
            for i in 0..=half {
                let (u, v) = (i as f64 / n, j as f64 / n);
                block.nodes.push(between(between(corners[corner], start, u), between(end, centroid, u), v));
                if i < half && j < half {
                    nodes.extend([number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]);
                }
            }
        }
        mesh.nodes.extend(block.nodes);
        mesh.blocks.push(ElementBlock { name: String::new(), kind: ElementKind::Quad4, nodes });
        mesh.check()?;
        shortest = shortest.min(mesh.edge_lengths()?.min);
    }
    let mut mesh = mesh.welded(1e-6 * shortest)?;
    let others = mesh.blocks.split_off(1);
    mesh.blocks[0].nodes.extend(others.into_iter().flat_map(|b| b.nodes));
    Ok(mesh)
}
