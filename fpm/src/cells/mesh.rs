//! Cells from the elements of a mesh.

use std::collections::HashMap;

use impactite_geometry::ElementMesh;

use super::error::{CellsError, parameter};
use super::polytope::{Beyond, Facet, Polytope};
use super::{Cells, Parts};
use crate::vector::{along, difference, dot, norm};

/// Flatness tolerance of a facet of four nodes: distance of a node from its plane over its size.
const FLAT: f64 = 1e-9;

impl<const D: usize> Cells<D> {
    /// Create cells from elements: triangles and quadrilaterals in the plane, tetrahedra and bricks in space, from
    /// [`structured`](impactite_geometry::structured), from a file of Gmsh or Abaqus, or from one's own mesh. Faces of bricks that are not
    /// flat are split into two triangles.
    ///
    /// # Errors
    /// An invalid mesh ([`ElementMesh::check`]), a mesh without elements, or elements of fewer dimensions than space.
    pub fn of_mesh(mesh: &ElementMesh<D>) -> Result<Self, CellsError> {
        mesh.check()?;
        let elements: usize = mesh.blocks.iter().map(|b| b.len()).sum();
        parameter(elements > 0, "cells of a mesh", "elements", elements as f64, "at least one")?;
        let mut parts = Parts::default();
        // Facets with only one cell so far, by their nodes: cell, area and centroid.
        let mut single: HashMap<Vec<u32>, (usize, [f64; D], [f64; D])> = HashMap::new();
        for block in &mesh.blocks {
            let dimensions = block.kind.dimensions();
            let (field, allowed) = ("dimensions of an element", "those of space");
            parameter(dimensions == D, "cells of a mesh", field, dimensions as f64, allowed)?;
            for nodes in block.elements() {
                let cell = parts.points.len();
                let place = |n: u32| mesh.nodes[n as usize];
                let mut facets = Vec::new();
                for facet in block.kind.facets() {
                    let ring: Vec<u32> = facet.iter().map(|&k| nodes[k]).collect();
                    facets.extend(flat(ring, &place));
                }
                let of = |ring: &Vec<u32>| Facet {
                    beyond: Beyond::Cell(0),
                    corners: ring.iter().map(|&n| place(n)).collect(),
                };
                let polytope = Polytope { facets: facets.iter().map(of).collect() };
                let mut middle = [0.0; D];
                nodes.iter().for_each(|&n| middle = along(&middle, 1.0 / nodes.len() as f64, &place(n)));
                let (volume, centroid) = polytope.volume_and_centroid(&middle);
                parts.points.push(centroid);
                parts.volumes.push(volume);
                parts.corners.push(nodes.iter().map(|&n| place(n)).collect());
                for (mut ring, facet) in facets.into_iter().zip(&polytope.facets) {
                    ring.sort_unstable();
                    let (area, centroid) = facet.measure();
                    match single.remove(&ring) {
                        Some((other, area, centroid)) => parts.between([other, cell], area, centroid),
                        None => {
                            single.insert(ring, (cell, area, centroid));
                        }
                    }
                }
            }
        }
        let mut left: Vec<_> = single.into_iter().collect();
        left.sort_unstable_by(|a, b| (a.1.0, &a.0).cmp(&(b.1.0, &b.0)));
        left.into_iter().for_each(|(_, (cell, area, centroid))| parts.outside(cell, area, centroid));
        parts.finish()
    }
}

/// Return a facet, or two triangles of a facet that is not flat, divided in the same way from both sides.
fn flat<const D: usize>(ring: Vec<u32>, place: &impl Fn(u32) -> [f64; D]) -> Vec<Vec<u32>> {
    if ring.len() < 4 {
        return vec![ring];
    }
    let corners: Vec<[f64; D]> = ring.iter().map(|&n| place(n)).collect();
    let (area, centroid) = super::polytope::measure(&corners);
    let height = |c: &[f64; D]| dot(&difference(c, &centroid), &area).abs();
    let size = norm(&area).powf(1.5);
    if corners.iter().all(|c| height(c) <= FLAT * size) {
        return vec![ring];
    }
    let least = (0..4).min_by_key(|&k| ring[k]).unwrap_or(0);
    let at = |k: usize| ring[(least + k) % 4];
    vec![vec![at(0), at(1), at(2)], vec![at(0), at(2), at(3)]]
}
