//! Closed surfaces of triangles.

use std::collections::{BTreeSet, HashMap};

use super::bounds::Bounds;
use super::error::{Check, GeometryError};
use super::shape::Shape;
use super::vector::{add, along, cross, dot, norm, sub, sum};

/// Triangles in a leaf of the tree.
const LEAF: usize = 4;

/// A solid inside a closed surface of triangles, in 3D. Exact distance, exact volume.
///
/// Points are told apart by counting the crossings of a line along the third axis, in a way that edges and
/// corners cannot confuse; a whole row of points costs one line. The surface must not cross itself, which is
/// not checked. It may have several pieces; a piece inside another is a cavity.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    bounds: Bounds<3>,
    volume: f64,
    centroid: [f64; 3],
    columns: Columns,
    tree: Tree,
}

impl TriangleMesh {
    /// A solid from vertices (m) and triangles, which name their three vertices. Vertices at the same place
    /// are made one, triangles that then lack three different corners are dropped, and the whole is turned
    /// outside out if need be.
    ///
    /// # Errors
    /// [`GeometryError`] if a vertex is missing or not finite, nothing is left, edges are open, neighbouring
    /// triangles disagree about the outside, or no volume is enclosed.
    pub fn new(vertices: &[[f64; 3]], triangles: &[[usize; 3]]) -> Result<Self, GeometryError> {
        let check = Check("TriangleMesh");
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
            // Adding zero makes -0 and 0 one.
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
        let columns = Columns::new(&kept, &proper, &bounds);
        let tree = Tree::new(&kept, &proper);
        Ok(Self { vertices: kept, triangles: proper, bounds, volume, centroid, columns, tree })
    }

    /// A solid from triangles that each bring their own corners (m), as in an STL file.
    ///
    /// # Errors
    /// As [`TriangleMesh::new`].
    pub fn from_soup(triangles: &[[[f64; 3]; 3]]) -> Result<Self, GeometryError> {
        let vertices: Vec<[f64; 3]> = triangles.iter().flatten().copied().collect();
        let indices: Vec<[usize; 3]> = (0..triangles.len()).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Self::new(&vertices, &indices)
    }

    /// Reads an STL file, ASCII or binary: all its solids together, as pieces of one. Coordinates are multiplied by
    /// `unit` (m): 1e-3 for a file in mm. Those of an ASCII file are taken in double precision.
    ///
    /// # Errors
    /// [`GeometryError::File`] if it cannot be read, is cut off, holds anything but solids, or has a coordinate that is not
    /// finite; else as [`TriangleMesh::new`].
    #[cfg(feature = "mesh")]
    pub fn read_stl(path: impl AsRef<std::path::Path>, unit: f64) -> Result<Self, GeometryError> {
        let path = path.as_ref();
        Check("TriangleMesh").positive("unit", unit)?;
        let refuse = |reason: String| GeometryError::File { path: path.display().to_string(), reason };
        let bytes = std::fs::read(path).map_err(|e| refuse(e.to_string()))?;
        let mut soup = super::stl::triangles(&bytes).map_err(|e| refuse(e.to_string()))?;
        drop(bytes);
        for x in soup.as_flattened_mut().as_flattened_mut() {
            *x *= unit;
        }
        Self::from_soup(&soup)
    }

    /// Reads a Wavefront OBJ file: all its groups together, polygons split into triangles. Coordinates are
    /// multiplied by `unit` (m): 1e-3 for a file in mm.
    ///
    /// # Errors
    /// [`GeometryError::File`] if it cannot be read; else as [`TriangleMesh::new`].
    #[cfg(feature = "mesh")]
    pub fn read_obj(path: impl AsRef<std::path::Path>, unit: f64) -> Result<Self, GeometryError> {
        let path = path.as_ref();
        Check("TriangleMesh").positive("unit", unit)?;
        let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
        let (models, _) = tobj::load_obj(path, &options)
            .map_err(|e| GeometryError::File { path: path.display().to_string(), reason: e.to_string() })?;
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for model in models {
            let first = vertices.len();
            vertices
                .extend(model.mesh.positions.chunks_exact(3).map(|x| [x[0], x[1], x[2]].map(|c| c * unit)));
            triangles.extend(
                model.mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|v| first + v as usize)),
            );
        }
        Self::new(&vertices, &triangles)
    }

    /// The vertices (m), each place once.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }
    /// The triangles, seen from outside counter-clockwise.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
    /// Area of the surface (m2).
    pub fn area(&self) -> f64 {
        sum(self.triangles.iter().map(|t| {
            let [a, b, c] = corners(&self.vertices, t);
            0.5 * norm(cross(sub(b, a), sub(c, a)))
        }))
    }
    /// The third coordinate of all crossings of the line through (x, y) with the surface, rising.
    fn crossings(&self, x: f64, y: f64, out: &mut Vec<f64>) {
        out.clear();
        for t in self.columns.at(x, y) {
            out.extend(crossing(&self.vertices, &self.triangles[*t as usize], x, y));
        }
        out.sort_unstable_by(f64::total_cmp);
    }
}

impl Shape<3> for TriangleMesh {
    fn signed_distance(&self, x: [f64; 3]) -> f64 {
        self.signed_distance_within(x, f64::INFINITY)
    }
    fn signed_distance_within(&self, x: [f64; 3], limit: f64) -> f64 {
        let distance = self.tree.distance(&self.vertices, &self.triangles, x, limit);
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
        for t in self.columns.at(x[0], x[1]) {
            if let Some(z) = crossing(&self.vertices, &self.triangles[*t as usize], x[0], x[1]) {
                inside ^= z < x[2];
            }
        }
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

/// Where the line through (x, y) along the third axis crosses a triangle.
///
/// In the plane of the first two coordinates, an edge is passed if a ray from (x, y) along the first axis
/// crosses it; the line crosses the triangle if one edge is passed and another not. Whether an edge is passed
/// depends on nothing but the edge, always looked at from the same end, so the two triangles at an edge agree
/// and a closed surface is crossed an even number of times, rounding or not.
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
        // Never beyond the edge's ends, so that the triangles near (x, y) are all that need to be asked.
        let at = (a[0] + s * (b[0] - a[0])).clamp(a[0].min(b[0]), a[0].max(b[0]));
        passed ^= at > x;
        // A triangle's outline meets the line at this y exactly twice, or never.
        if cuts < 2 {
            cut[cuts] = [at, a[2] + s * (b[2] - a[2])];
        }
        cuts += 1;
    }
    if !passed {
        return None;
    }
    let [p, q] = cut;
    let width = q[0] - p[0];
    let s = if width != 0.0 { ((x - p[0]) / width).clamp(0.0, 1.0) } else { 0.5 };
    Some(p[1] + s * (q[1] - p[1]))
}

/// Refuses surfaces with open or wrongly oriented edges.
fn check_closed(triangles: &[[u32; 3]]) -> Result<(), GeometryError> {
    // How often each edge is used, and how much more often in one direction than in the other.
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

/// Volume and centroid by the divergence theorem, taken about `base`.
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

/// Turns each piece of the surface so that it faces away from the solid: outwards, or into a cavity if it lies
/// within an odd number of other pieces.
fn orient(vertices: &[[f64; 3]], triangles: &mut [[u32; 3]]) {
    // Pieces: vertices joined by triangles, each with the smallest of its vertices as its name.
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
    let pieces: BTreeSet<u32> = piece_of.iter().copied().collect();
    for piece in pieces {
        let base = vertices[piece as usize];
        let own: Vec<[u32; 3]> =
            triangles.iter().zip(&piece_of).filter(|(_, p)| **p == piece).map(|(t, _)| *t).collect();
        // All other pieces are closed, so the parity of their crossings below a vertex of this one says
        // whether it is inside an odd number of them.
        let mut cavity = false;
        for (t, _) in triangles.iter().zip(&piece_of).filter(|(_, p)| **p != piece) {
            if let Some(z) = crossing(vertices, t, base[0], base[1]) {
                cavity ^= z < base[2];
            }
        }
        if (volume(vertices, &own, base).0 < 0.0) != cavity {
            for (t, _) in triangles.iter_mut().zip(&piece_of).filter(|(_, p)| **p == piece) {
                t.swap(1, 2);
            }
        }
    }
}

/// Triangles sorted by the rectangles of the first two coordinates that they reach into.
#[derive(Clone, Debug)]
struct Columns {
    low: [f64; 2],
    /// Rectangles per metre.
    rate: [f64; 2],
    count: [usize; 2],
    /// Where each rectangle's triangles begin.
    start: Vec<u32>,
    triangles: Vec<u32>,
}

impl Columns {
    fn new(vertices: &[[f64; 3]], triangles: &[[u32; 3]], bounds: &Bounds<3>) -> Self {
        let extent = [bounds.max[0] - bounds.min[0], bounds.max[1] - bounds.min[1]];
        // About one rectangle per triangle, nearly square.
        let edge = (extent[0] * extent[1] / triangles.len() as f64).sqrt();
        let count = extent.map(|e| ((e / edge) as usize).clamp(1, 2048));
        let mut rate = [0.0; 2];
        for i in 0..2 {
            rate[i] = count[i] as f64 / extent[i];
        }
        let mut columns = Self {
            low: [bounds.min[0], bounds.min[1]],
            rate,
            count,
            start: Vec::new(),
            triangles: Vec::new(),
        };
        let ranges: Vec<[[usize; 2]; 2]> = triangles
            .iter()
            .map(|t| {
                let b = Bounds::around(corners(vertices, t));
                [columns.index([b.min[0], b.min[1]]), columns.index([b.max[0], b.max[1]])]
            })
            .collect();
        let mut start = vec![0u32; count[0] * count[1] + 1];
        let each = |range: &[[usize; 2]; 2], act: &mut dyn FnMut(usize)| {
            let [low, high] = *range;
            for i in low[0]..=high[0] {
                for j in low[1]..=high[1] {
                    act(i * count[1] + j);
                }
            }
        };
        for range in &ranges {
            each(range, &mut |r| start[r + 1] += 1);
        }
        for r in 0..count[0] * count[1] {
            start[r + 1] += start[r];
        }
        let mut next = start.clone();
        let mut sorted = vec![0u32; start.last().map_or(0, |n| *n as usize)];
        for (t, range) in ranges.iter().enumerate() {
            each(range, &mut |r| {
                sorted[next[r] as usize] = t as u32;
                next[r] += 1;
            });
        }
        columns.start = start;
        columns.triangles = sorted;
        columns
    }
    /// The rectangle of a point. It never falls as a coordinate rises, so a triangle is listed wherever a
    /// point between its smallest and largest coordinates may be sent.
    fn index(&self, x: [f64; 2]) -> [usize; 2] {
        let mut index = [0; 2];
        for i in 0..2 {
            index[i] = (((x[i] - self.low[i]) * self.rate[i]) as usize).min(self.count[i] - 1);
        }
        index
    }
    /// The triangles that may cover (x, y).
    fn at(&self, x: f64, y: f64) -> &[u32] {
        let [i, j] = self.index([x, y]);
        let r = i * self.count[1] + j;
        &self.triangles[self.start[r] as usize..self.start[r + 1] as usize]
    }
}

/// A tree of boxes around triangles, for the nearest one.
#[derive(Clone, Debug)]
struct Tree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds<3>,
    /// Range of triangles.
    range: [u32; 2],
    /// The second child; the first follows its parent. Zero in a leaf.
    second: u32,
}

impl Tree {
    fn new(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Self {
        let centres: Vec<[f64; 3]> = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = corners(vertices, t);
                add(a, add(b, c)).map(|x| x / 3.0)
            })
            .collect();
        let mut tree = Self { nodes: Vec::new(), order: (0..triangles.len() as u32).collect() };
        // Pending ranges, with the node whose second child they are.
        let mut pending = vec![([0, triangles.len()], None)];
        while let Some(([from, to], parent)) = pending.pop() {
            let here = tree.nodes.len();
            if let Some(parent) = parent {
                let parent: usize = parent;
                tree.nodes[parent].second = here as u32;
            }
            let slice = &mut tree.order[from..to];
            let bounds =
                Bounds::around(slice.iter().flat_map(|t| corners(vertices, &triangles[*t as usize])));
            tree.nodes.push(Node { bounds, range: [from as u32, to as u32], second: 0 });
            if to - from > LEAF {
                let spread = Bounds::around(slice.iter().map(|t| centres[*t as usize]));
                let extent = sub(spread.max, spread.min);
                let mut axis = 0;
                for i in 1..3 {
                    if extent[i] > extent[axis] {
                        axis = i;
                    }
                }
                let middle = (to - from) / 2;
                slice.select_nth_unstable_by(middle, |a, b| {
                    let (x, y) = (centres[*a as usize][axis], centres[*b as usize][axis]);
                    x.total_cmp(&y).then(a.cmp(b))
                });
                // The last one pushed is built next and so follows its parent.
                pending.push(([from + middle, to], Some(here)));
                pending.push(([from, from + middle], None));
            }
        }
        tree
    }
    /// Distance from `x` to the nearest triangle, or `limit` if that is less.
    fn distance(&self, vertices: &[[f64; 3]], triangles: &[[u32; 3]], x: [f64; 3], limit: f64) -> f64 {
        let mut best = limit;
        // Depth is at most log2 of 2^32 triangles, and each level leaves one node behind.
        let mut stack = [(0.0, 0u32); 64];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (least, index) = stack[height];
            if least >= best {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.second == 0 {
                for t in &self.order[node.range[0] as usize..node.range[1] as usize] {
                    best = best.min(triangle_distance(x, corners(vertices, &triangles[*t as usize])));
                }
                continue;
            }
            let children = [index + 1, node.second];
            let [a, b] = children.map(|c| (self.nodes[c as usize].bounds.distance(x), c));
            let (near, far) = if a.0 <= b.0 { (a, b) } else { (b, a) };
            for child in [far, near] {
                if child.0 < best && height < stack.len() {
                    stack[height] = child;
                    height += 1;
                }
            }
        }
        best
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
        // A triangle without area is its longest edges.
        use super::primitives::segment_distance;
        segment_distance(p, a, b).min(segment_distance(p, b, c)).min(segment_distance(p, c, a))
    }
}
