//! Triangles of a surface file.

/// Vertices, and triangles by vertex index.
pub(super) type Triangles = (Vec<[f64; 3]>, Vec<[usize; 3]>);

/// Append the triangle fan of a polygon about its first corner.
pub(super) fn fan(polygon: &[usize], triangles: &mut Vec<[usize; 3]>) {
    if let [first, rest @ ..] = polygon {
        triangles.extend(rest.windows(2).map(|edge| [*first, edge[0], edge[1]]));
    }
}
