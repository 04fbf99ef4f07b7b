//! Solids bounded by closed triangle meshes.

use std::collections::HashMap;

use super::bounds::Bounds;
use super::error::{Check, GeometryError};
use super::shape::Shape;
use super::tree::Tree;
use super::vector::{add, along, cross, dot, norm, sub, sum};

/// Solid bounded by a closed triangle mesh in 3D. Exact distance, exact volume.
///
/// The inside test counts crossings of a line along the third axis and is robust at edges and corners; a row of points shares one
/// line. The surface must not intersect itself, which is not checked. It may have several pieces; a piece inside another is a cavity.
///
/// Cost: memory proportional to the number of triangles (some 60 to 120 bytes each, 200 during construction), time slightly more than
/// proportional. A bounding volume tree restricts line and distance queries to nearby triangles.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    bounds: Bounds<3>,
    volume: f64,
    centroid: [f64; 3],
    tree: Tree,
}

impl TriangleMesh {
    /// Build a solid from vertices (m) and triangles of vertex indices. Coincident vertices are merged, triangles without
    /// three different corners are removed, and triangles are oriented outwards.
    ///
    /// # Errors
    /// [`GeometryError`] if a vertex is missing or not finite, no triangle is left, edges are open, neighbouring
    /// triangles have inconsistent orientations, or no volume is enclosed.
    pub fn new(vertices: &[[f64; 3]], triangles: &[[usize; 3]]) -> Result<Self, GeometryError> {
        let check = Check("triangle mesh");
        check.that(
            vertices.len() < u32::MAX as usize && triangles.len() < u32::MAX as usize,
            "number of vertices or triangles",
            vertices.len().max(triangles.len()) as f64,
            "less than 2^32",
        )?;
        let mut seen: HashMap<[u64; 3], u32> = HashMap::with_capacity(vertices.len());
        let mut kept = Vec::new();
        let mut number = Vec::with_capacity(vertices.len());
        for x in vertices {
            check.point("vertices", *x)?;
            // Adding zero merges -0 and 0.
            let key = x.map(|c| (c + 0.0).to_bits());
            number.push(*seen.entry(key).or_insert_with(|| {
                kept.push(x.map(|c| c + 0.0));
                (kept.len() - 1) as u32
            }));
        }
        let mut proper = Vec::with_capacity(triangles.len());
        for (index, t) in triangles.iter().enumerate() {
            let mut corners = [0; 3];
            for i in 0..3 {
                corners[i] = *number.get(t[i]).ok_or(GeometryError::VertexOutOfRange {
                    triangle: index,
                    vertex: t[i],
                    vertices: vertices.len(),
                })?;
            }
            if corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0] {
                proper.push(corners);
            }
        }
        if proper.is_empty() {
            return Err(GeometryError::EmptyMesh);
        }
        check_closed(&proper)?;
        orient(&kept, &mut proper);

        let used = proper.iter().flatten().map(|v| kept[*v as usize]);
        let bounds = Bounds::around(used);
        let middle = add(bounds.min, sub(bounds.max, bounds.min).map(|c| 0.5 * c));
        let (volume, centroid) = volume(&kept, &proper, middle);
        let size = norm(sub(bounds.max, bounds.min));
        if volume.is_nan() || volume <= 1e-15 * size * size * size {
            return Err(GeometryError::NoVolume { volume });
        }
        let tree = Tree::of_triangles(proper.len(), |t| corners(&kept, &proper[t as usize]));
        Ok(Self { vertices: kept, triangles: proper, bounds, volume, centroid, tree })
    }

    /// Build a solid from triangles with corners of their own (m), as in an STL file.
    ///
    /// # Errors
    /// Errors of [`TriangleMesh::new`].
    pub fn from_soup(triangles: &[[[f64; 3]; 3]]) -> Result<Self, GeometryError> {
        let vertices: Vec<[f64; 3]> = triangles.iter().flatten().copied().collect();
        let indices: Vec<[usize; 3]> = (0..triangles.len()).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Self::new(&vertices, &indices)
    }

    /// Vertices (m), without duplicates.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }
    /// Triangles by vertex index, counter-clockwise from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
    /// Surface area (m2).
    pub fn area(&self) -> f64 {
        sum(self.triangles.iter().map(|t| {
            let [a, b, c] = corners(&self.vertices, t);
            0.5 * norm(cross(sub(b, a), sub(c, a)))
        }))
    }
    /// Third coordinates of all crossings of the line through (x, y) with the surface, ascending.
    fn crossings(&self, x: f64, y: f64, out: &mut Vec<f64>) {
        out.clear();
        self.tree.column([x, y], [f64::NEG_INFINITY, f64::INFINITY], |t| {
            out.extend(crossing(&self.vertices, &self.triangles[t as usize], x, y));
        });
        out.sort_unstable_by(f64::total_cmp);
    }
}

impl Shape<3> for TriangleMesh {
    fn signed_distance(&self, x: [f64; 3]) -> f64 {
        self.signed_distance_within(x, f64::INFINITY)
    }
    fn signed_distance_within(&self, x: [f64; 3], limit: f64) -> f64 {
        let distance = self.tree.distance(x, limit, |t| {
            triangle_distance(x, corners(&self.vertices, &self.triangles[t as usize]))
        });
        if self.contains(x) { -distance } else { distance }
    }
    fn bounds(&self) -> Bounds<3> {
        self.bounds
    }
    fn exact_distance(&self) -> bool {
        true
    }
    fn measure(&self) -> Option<f64> {
        Some(self.volume)
    }
    fn centroid(&self) -> Option<[f64; 3]> {
        Some(self.centroid)
    }
    fn contains(&self, x: [f64; 3]) -> bool {
        if !self.bounds.contains(x) {
            return false;
        }
        let mut inside = false;
        // The total number of crossings of a line is even, so that the crossings below and above have the same parity: count the shorter
        // side. Crossings are within the height range of their triangles, so that triangles beyond that side need no test.
        let below = x[2] - self.bounds.min[2] < self.bounds.max[2] - x[2];
        let way = if below { [f64::NEG_INFINITY, x[2]] } else { [x[2], f64::INFINITY] };
        self.tree.column([x[0], x[1]], way, |t| {
            if let Some(z) = crossing(&self.vertices, &self.triangles[t as usize], x[0], x[1]) {
                inside ^= (z < x[2]) == below;
            }
        });
        inside
    }
    fn contains_row(&self, first: [f64; 3], last: &[f64], inside: &mut [bool]) {
        let mut crossings = Vec::new();
        self.crossings(first[0], first[1], &mut crossings);
        let mut below = 0;
        for (z, i) in last.iter().zip(inside) {
            while below < crossings.len() && crossings[below] < *z {
                below += 1;
            }
            *i = below % 2 == 1;
        }
    }
}

fn corners(vertices: &[[f64; 3]], t: &[u32; 3]) -> [[f64; 3]; 3] {
    t.map(|v| vertices[v as usize])
}

/// Height at which the line through (x, y) along the third axis crosses a triangle, if it does.
///
/// In the plane of the first two coordinates, an edge is passed if a ray from (x, y) along the first axis
/// crosses it; the line crosses the triangle if exactly one of its edges is passed. The test of an edge
/// depends on the edge alone, with its ends in a fixed order, so that both triangles at an edge agree
/// and a closed surface is crossed an even number of times in spite of rounding.
fn crossing(vertices: &[[f64; 3]], t: &[u32; 3], x: f64, y: f64) -> Option<f64> {
    let mut cut = [[0.0; 2]; 2];
    let (mut cuts, mut passed) = (0, false);
    for i in 0..3 {
        let (a, b) = (t[i].min(t[(i + 1) % 3]), t[i].max(t[(i + 1) % 3]));
        let (a, b) = (vertices[a as usize], vertices[b as usize]);
        if (a[1] > y) == (b[1] > y) {
            continue;
        }
        let s = (y - a[1]) / (b[1] - a[1]);
        // Clamp to the ends of the edge, so that only triangles whose boxes contain the point need a test.
        let [at, _, height] = [0, 1, 2].map(|i| between(a[i] + s * (b[i] - a[i]), a[i], b[i]));
        passed ^= at > x;
        // The outline of a triangle crosses the line at this y exactly twice, or never.
        if cuts < 2 {
            cut[cuts] = [at, height];
        }
        cuts += 1;
    }
    if !passed {
        return None;
    }
    let [p, q] = cut;
    let width = q[0] - p[0];
    let s = if width != 0.0 { ((x - p[0]) / width).clamp(0.0, 1.0) } else { 0.5 };
    Some(between(p[1] + s * (q[1] - p[1]), p[1], q[1]))
}

/// Clamp `x` to the interval between `a` and `b`.
fn between(x: f64, a: f64, b: f64) -> f64 {
    x.max(a.min(b)).min(a.max(b))
}

/// Check for open or inconsistently oriented edges.
fn check_closed(triangles: &[[u32; 3]]) -> Result<(), GeometryError> {
    // Number of uses of each edge, and the difference between uses in its two directions.
    let mut edges: HashMap<[u32; 2], (u32, i32)> = HashMap::with_capacity(triangles.len() * 3 / 2);
    for t in triangles {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            let entry = edges.entry([a.min(b), a.max(b)]).or_default();
            entry.0 += 1;
            entry.1 += if a < b { 1 } else { -1 };
        }
    }
    let open_edges = edges.values().filter(|(uses, _)| uses % 2 == 1).count();
    if open_edges > 0 {
        return Err(GeometryError::OpenMesh { open_edges });
    }
    let wrong = edges.values().filter(|(_, balance)| *balance != 0).count();
    if wrong > 0 {
        return Err(GeometryError::InconsistentMesh { edges: wrong });
    }
    Ok(())
}

/// Volume and centroid by the divergence theorem about the point `base`.
fn volume(vertices: &[[f64; 3]], triangles: &[[u32; 3]], base: [f64; 3]) -> (f64, [f64; 3]) {
    let tetrahedra = || {
        triangles.iter().map(|t| {
            let [a, b, c] = corners(vertices, t).map(|x| sub(x, base));
            (dot(a, cross(b, c)) / 6.0, add(a, add(b, c)))
        })
    };
    let volume = sum(tetrahedra().map(|(v, _)| v));
    let mut centroid = base;
    for i in 0..3 {
        centroid[i] += sum(tetrahedra().map(|(v, corners)| 0.25 * v * corners[i])) / volume;
    }
    (volume, centroid)
}

/// Orient each piece of the surface away from the solid: outwards, or into a cavity if it is
/// inside an odd number of other pieces.
fn orient(vertices: &[[f64; 3]], triangles: &mut [[u32; 3]]) {
    // Connected components: vertices joined by triangles, each labelled by its smallest vertex.
    let mut parent: Vec<u32> = (0..vertices.len() as u32).collect();
    fn root(parent: &mut [u32], mut v: u32) -> u32 {
        while parent[v as usize] != v {
            parent[v as usize] = parent[parent[v as usize] as usize];
            v = parent[v as usize];
        }
        v
    }
    for t in triangles.iter() {
        for i in 1..3 {
            let (a, b) = (root(&mut parent, t[0]), root(&mut parent, t[i]));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    let piece_of: Vec<u32> = triangles.iter().map(|t| root(&mut parent, t[0])).collect();
    let mut by_piece: Vec<u32> = (0..triangles.len() as u32).collect();
    by_piece.sort_unstable_by_key(|t| (piece_of[*t as usize], *t));
    // Height range of each piece, by label.
    let mut heights = vec![[f64::INFINITY, f64::NEG_INFINITY]; vertices.len()];
    for (t, piece) in triangles.iter().zip(&piece_of) {
        let [low, high] = &mut heights[*piece as usize];
        for x in corners(vertices, t) {
            (*low, *high) = (low.min(x[2]), high.max(x[2]));
        }
    }
    // A piece is crossed an odd number of times only below points within its height range: never below all of it, an even number above.
    // The boxes of triangles have the height range of their piece, so that stacked pieces cost no more than pieces side by side.
    let several = piece_of.iter().any(|p| *p != piece_of[0]);
    let tree = several.then(|| {
        Tree::of_boxes(triangles.len(), |t| {
            let mut own = Bounds::around(corners(vertices, &triangles[t as usize]));
            [own.min[2], own.max[2]] = heights[piece_of[t as usize] as usize];
            own
        })
    });
    let mut turned = Vec::new();
    for members in by_piece.chunk_by(|a, b| piece_of[*a as usize] == piece_of[*b as usize]) {
        let piece = piece_of[members[0] as usize];
        let base = vertices[piece as usize];
        // All other pieces are closed, so the parity of their crossings below a vertex of this one determines
        // whether it is inside an odd number of them.
        let mut cavity = false;
        if let Some(tree) = &tree {
            tree.column([base[0], base[1]], [base[2]; 2], |t| {
                let other = piece_of[t as usize];
                let [low, high] = heights[other as usize];
                if other != piece
                    && low <= base[2]
                    && base[2] <= high
                    && let Some(z) = crossing(vertices, &triangles[t as usize], base[0], base[1])
                {
                    cavity ^= z < base[2];
                }
            });
        }
        let own: Vec<[u32; 3]> = members.iter().map(|t| triangles[*t as usize]).collect();
        if (volume(vertices, &own, base).0 < 0.0) != cavity {
            turned.extend_from_slice(members);
        }
    }
    for t in turned {
        triangles[t as usize].swap(1, 2);
    }
}

/// Distance from `p` to a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
fn triangle_distance(p: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> f64 {
    let (ab, ac, ap) = (sub(b, a), sub(c, a), sub(p, a));
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return norm(ap);
    }
    let bp = sub(p, b);
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return norm(bp);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
        return norm(along(ap, -d1 / (d1 - d3), ab));
    }
    let cp = sub(p, c);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return norm(cp);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
        return norm(along(ap, -d2 / (d2 - d6), ac));
    }
    let va = d3 * d6 - d5 * d4;
    let (on_bc, beyond) = (d4 - d3, d5 - d6);
    if va <= 0.0 && on_bc >= 0.0 && beyond >= 0.0 && on_bc + beyond > 0.0 {
        return norm(along(bp, -on_bc / (on_bc + beyond), sub(c, b)));
    }
    let total = va + vb + vc;
    if total > 0.0 {
        norm(along(along(ap, -vb / total, ab), -vc / total, ac))
    } else {
        // Degenerate triangle: use the distance to its edges.
        use super::primitives::segment_distance;
        segment_distance(p, a, b).min(segment_distance(p, b, c)).min(segment_distance(p, c, a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Double cone of very thin triangles about an axis; its two tips are far from the centre of its rim.
    fn fans(sides: usize, axis: [f64; 3]) -> TriangleMesh {
        let axis = axis.map(|c| c / norm(axis));
        let other = cross(axis, [0.3, 0.9, -0.1]);
        let first = other.map(|c| c / norm(other));
        let second = cross(axis, first);
        let mut vertices = vec![axis, along([0.2; 3], -0.5, axis)];
        let mut triangles = Vec::new();
        for k in 0..sides {
            let angle = std::f64::consts::TAU * k as f64 / sides as f64;
            vertices.push(along(first.map(|c| c * angle.cos()), angle.sin(), second));
            let (a, b) = (2 + k, 2 + (k + 1) % sides);
            triangles.extend([[0, a, b], [1, b, a]]);
        }
        TriangleMesh::new(&vertices, &triangles).expect("closed")
    }

    /// Sample points in and around the bounding box, some of them directly above vertices.
    fn places(mesh: &TriangleMesh, count: usize) -> Vec<[f64; 3]> {
        let mut state = 1u64;
        let mut draw = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let Bounds { min, max } = mesh.bounds;
        (0..count)
            .map(|n| {
                let mut x = [0, 1, 2].map(|i| min[i] + (1.1 * draw() - 0.05) * (max[i] - min[i]));
                if n % 4 == 0 {
                    let v = mesh.vertices[(draw() * mesh.vertices.len() as f64) as usize];
                    [x[0], x[1]] = [v[0], v[1]];
                }
                x
            })
            .collect()
    }

    const AXES: [[f64; 3]; 4] = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.3, 0.4, 0.8], [1.0, 1.0, 0.01]];

    #[test]
    fn the_tree_passes_over_nothing_that_counts() {
        for axis in AXES {
            let mesh = fans(300, axis);
            for x in places(&mesh, 2000) {
                let crossed = |t: &[u32; 3]| crossing(&mesh.vertices, t, x[0], x[1]);
                let mut all: Vec<f64> = mesh.triangles.iter().filter_map(crossed).collect();
                all.sort_unstable_by(f64::total_cmp);
                let mut found = Vec::new();
                mesh.crossings(x[0], x[1], &mut found);
                assert_eq!(all, found, "at {x:?}");
                assert_eq!(all.len() % 2, 0, "at {x:?}");
                let below = all.iter().filter(|z| **z < x[2]).count();
                assert_eq!(mesh.contains(x), below % 2 == 1, "at {x:?}");
                let of = |t: &[u32; 3]| triangle_distance(x, corners(&mesh.vertices, t));
                let nearest = mesh.triangles.iter().map(of).fold(f64::INFINITY, f64::min);
                assert_eq!(mesh.signed_distance(x).abs(), nearest, "at {x:?}");
            }
        }
    }

    /// Ten times as many triangles must not need ten times as many tests, although their boxes overlap.
    #[test]
    fn thin_triangles_are_asked_where_they_are() {
        for axis in AXES {
            let asked = [2000, 20000].map(|sides| {
                let mesh = fans(sides, axis);
                let places = places(&mesh, 500);
                let (mut crossed, mut distances) = (0, 0);
                for x in &places {
                    mesh.tree.column([x[0], x[1]], [f64::NEG_INFINITY, f64::INFINITY], |_| crossed += 1);
                    mesh.tree.distance(*x, f64::INFINITY, |t| {
                        distances += 1;
                        triangle_distance(*x, corners(&mesh.vertices, &mesh.triangles[t as usize]))
                    });
                }
                [crossed, distances].map(|n| n as f64 / places.len() as f64)
            });
            // One in a thousand for lines, one in forty for distances: many triangles are almost nearest close to the axis of the fan.
            assert!(asked[1][0] < 40.0 && asked[1][1] < 1000.0, "{axis:?}: {asked:?}");
        }
    }

    #[test]
    fn pieces_in_piles_and_nests_ask_little() {
        // Plates in a stack, each within the column of all, every fourth with a cavity.
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        let mut add_box = |low: [f64; 3], high: [f64; 3]| {
            let first = vertices.len();
            vertices.extend(Bounds { min: low, max: high }.corners());
            let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            triangles.extend(
                quads.iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]].map(|t| t.map(|v| first + v))),
            );
        };
        for k in 0..4000 {
            let z = f64::from(k);
            add_box([0.0, 0.0, z], [1.0, 1.0, z + 0.5]);
            if k % 4 == 0 {
                add_box([0.25, 0.25, z + 0.125], [0.75, 0.75, z + 0.375]);
            }
        }
        let mesh = TriangleMesh::new(&vertices, &triangles).expect("closed");
        let exact = 4000.0 * 0.5 - 1000.0 * 0.0625;
        assert!((mesh.volume / exact - 1.0).abs() < 1e-13, "{} {exact}", mesh.volume);
        assert!(mesh.contains([0.1, 0.5, 400.25]) && !mesh.contains([0.5, 0.5, 400.25]));
    }
}
