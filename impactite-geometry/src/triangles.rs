//! Triangles as files of surfaces have them.

/// Vertices, and triangles that name them.
pub(super) type Triangles = (Vec<[f64; 3]>, Vec<[usize; 3]>);

/// Adds the triangles of a polygon about its first corner.
pub(super) fn fan(polygon: &[usize], triangles: &mut Vec<[usize; 3]>) {
    if let [first, rest @ ..] = polygon {
        triangles.extend(rest.windows(2).map(|edge| [*first, edge[0], edge[1]]));
    }
}
