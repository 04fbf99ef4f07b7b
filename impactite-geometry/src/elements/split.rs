//! Subdivision of quadrilaterals into triangles and of bricks into tetrahedra.

use super::{ElementBlock, ElementKind, ElementMesh, MeshError};
use crate::error::GeometryError;

impl<const D: usize> ElementMesh<D> {
    /// Replace elements of kind `from` by their subdivision into kind `to`; elements of kind `to` are kept.
    fn split(
        mut self,
        what: &'static str,
        [from, to]: [ElementKind; 2],
        split: impl Fn(&[u32], &mut Vec<u32>),
    ) -> Result<Self, GeometryError> {
        self.check()?;
        let mut counts: Vec<u32> = Vec::new();
        for (b, block) in self.blocks.iter_mut().enumerate() {
            if block.kind == from {
                let mut nodes = Vec::with_capacity(3 * block.nodes.len());
                for element in block.elements() {
                    let before = nodes.len();
                    split(element, &mut nodes);
                    counts.push(((nodes.len() - before) / to.nodes()) as u32);
                }
                *block = ElementBlock { name: std::mem::take(&mut block.name), kind: to, nodes };
            } else if block.kind.dimensions() == D && block.kind != to {
                let (name, kind) = (block.name.clone(), block.kind);
                let allowed = if D == 2 { "quadrilaterals and triangles" } else { "bricks and tetrahedra" };
                return Err(MeshError::Kind { what, block: b, name, kind, allowed }.into());
            } else {
                counts.resize(counts.len() + block.len(), 1);
            }
        }
        self.element_sets = self.element_sets_after(&counts);
        self.check()?;
        Ok(self)
    }
}

impl ElementMesh<2> {
    /// Split every quadrilateral into two triangles by the diagonal through its smallest node number.
    ///
    /// # Errors
    /// Errors of [`check`](Self::check), before and after.
    pub fn split_to_triangles(self) -> Result<Self, GeometryError> {
        let kinds = [ElementKind::Quad4, ElementKind::Triangle3];
        self.split("to split to triangles", kinds, |quad, out| {
            out.extend(halves([quad[0], quad[1], quad[2], quad[3]]).as_flattened());
        })
    }
}

impl ElementMesh<3> {
    /// Split every brick into tetrahedra, conforming: every face is split by the diagonal through its smallest node number, so that
    /// neighbours agree. A brick becomes five tetrahedra where its face diagonals allow that, else six.
    ///
    /// A brick is cut into pyramids from its smallest node to the three faces that do not contain it; each pyramid is two tetrahedra. If
    /// none of the diagonals of these faces ends at the opposite node, two tetrahedra replace the three at that node. After
    /// \[Dompierre1999\].
    ///
    /// ```
    /// use impactite_geometry::{Cuboid, Metric, structured};
    /// let bricks = structured::box_mesh(&Cuboid::new([0.0; 3], [1.0, 2.0, 3.0])?, [2, 3, 4])?;
    /// let tetrahedra = bricks.clone().split_to_tetrahedra()?;
    /// assert_eq!(tetrahedra.elements(), 6 * bricks.elements());
    /// assert_eq!(tetrahedra.surface()?.len(), 2 * bricks.surface()?.len());
    /// # Ok::<(), impactite_geometry::GeometryError>(())
    /// ```
    ///
    /// # Errors
    /// Errors of [`check`](Self::check), before and after: a strongly distorted brick may contain an inverted tetrahedron.
    pub fn split_to_tetrahedra(self) -> Result<Self, GeometryError> {
        let kinds = [ElementKind::Hexa8, ElementKind::Tetra4];
        self.split("to split to tetrahedra", kinds, |brick, out| {
            let tip = *brick.iter().min().expect("a brick has nodes");
            let face = |places: &[usize]| [0, 1, 2, 3].map(|i| brick[places[i]]);
            let far: Vec<[u32; 4]> =
                ElementKind::Hexa8.facets().iter().map(|p| face(p)).filter(|f| !f.contains(&tip)).collect();
            let opposite = far[0].iter().find(|n| far[1].contains(n) && far[2].contains(n));
            let split: Vec<[[u32; 3]; 2]> = far.iter().map(|f| halves(*f)).collect();
            // Triangles at the opposite node, seen from outside, if every face has exactly one there.
            let triangle_at = |halves: &[[u32; 3]; 2]| {
                let mut with = halves.iter().filter(|t| opposite.is_some_and(|o| t.contains(o)));
                with.next().copied().xor(with.next().copied())
            };
            let corner: Option<Vec<[u32; 3]>> = split.iter().map(triangle_at).collect();
            match (corner, opposite) {
                (Some(corner), Some(&opposite)) => {
                    let rest = split.iter().flatten().filter(|t| !t.contains(&opposite));
                    rest.for_each(|t| out.extend(outside(*t, tip)));
                    let base = base(&corner, opposite);
                    out.extend(outside(base, tip));
                    out.extend([base[0], base[1], base[2], opposite]);
                }
                _ => split.iter().flatten().for_each(|t| out.extend(outside(*t, tip))),
            }
        })
    }
}

/// Split a wedge or pyramid into tetrahedra. Facets are counter-clockwise from outside; every quadrilateral is split by the diagonal
/// through its smallest node number, like [`split_to_tetrahedra`](ElementMesh::split_to_tetrahedra).
#[cfg(feature = "mesh")]
pub(super) fn tetrahedra(nodes: &[u32], facets: &[&[usize]]) -> Vec<[u32; 4]> {
    let Some(&tip) = nodes.iter().min() else { return Vec::new() };
    let far = facets.iter().filter(|facet| facet.iter().all(|&place| nodes[place] != tip));
    let split = far.flat_map(|facet| match facet[..] {
        [a, b, c, d] => halves([a, b, c, d].map(|place| nodes[place])).to_vec(),
        _ => vec![[0, 1, 2].map(|corner| nodes[facet[corner]])],
    });
    split.map(|t| outside(t, tip)).collect()
}

/// Return the tetrahedron of a triangle, counter-clockwise from outside, and a tip below it.
fn outside(t: [u32; 3], tip: u32) -> [u32; 4] {
    [t[0], t[2], t[1], tip]
}

/// Return the triangle of the three neighbours of `opposite`, counter-clockwise from there, given the three triangles around it.
fn base(corner: &[[u32; 3]], opposite: u32) -> [u32; 3] {
    // Each triangle around the node runs from one neighbour to the next.
    let edge = |t: &[u32; 3]| {
        let at = t.iter().position(|&n| n == opposite).unwrap_or(0);
        [t[(at + 1) % 3], t[(at + 2) % 3]]
    };
    let [a, b] = edge(&corner[0]);
    let next = corner[1..].iter().map(edge).find(|e| e[0] == b).map_or(a, |e| e[1]);
    [a, b, next]
}

/// Split a quadrilateral by the diagonal through its smallest node.
fn halves(q: [u32; 4]) -> [[u32; 3]; 2] {
    if q[0].min(q[2]) < q[1].min(q[3]) {
        [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]
    } else {
        [[q[0], q[1], q[3]], [q[1], q[2], q[3]]]
    }
}
