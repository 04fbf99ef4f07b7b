//! Surface of a mesh: facets that belong to exactly one element.

use impactite_geometry::{ElementMesh, Facet};

/// Surface facets of the elements for which `there` is true, by number in the mesh, in the order of the elements.
pub(crate) fn surface_of<const D: usize>(mesh: &ElementMesh<D>, there: &dyn Fn(u32) -> bool) -> Vec<Facet> {
    let (mut facets, mut number) = (Vec::new(), 0);
    for (b, block) in mesh.blocks.iter().enumerate() {
        let kinds = if block.kind.dimensions() == D { block.kind.facets() } else { &[] };
        for (e, nodes) in block.elements().enumerate() {
            if there(number) {
                for places in kinds {
                    let mut facet = Facet { nodes: [Facet::NONE; 4], block: b as u32, element: e as u32 };
                    for (to, &place) in facet.nodes.iter_mut().zip(*places) {
                        *to = nodes[place];
                    }
                    facets.push(facet);
                }
            }
            number += 1;
        }
    }
    // Sort facets by their node sets, so that facets of two elements are adjacent.
    let mut keyed: Vec<([u32; 4], usize)> = facets.iter().map(|f| f.nodes).zip(0..).collect();
    for (key, _) in &mut keyed {
        key.sort_unstable();
    }
    keyed.sort_unstable();
    let single = keyed.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1);
    let mut outside: Vec<usize> = single.map(|same| same[0].1).collect();
    outside.sort_unstable();
    outside.into_iter().map(|at| facets[at]).collect()
}
