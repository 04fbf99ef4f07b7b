//! Laws, boxes and particles that the tests share.

use impactite_geometry::{Cuboid, ElementBlock, ElementKind, ElementMesh, Filling, Lattice, Seeds, fill};
use mpm_materials::{LinearElastic, Moduli};

pub fn elastic(density: f64, young: f64, poisson: f64) -> LinearElastic<f64> {
    LinearElastic::new(density, Moduli::young_poisson(young, poisson).expect("moduli")).expect("law")
}

pub fn boxed<const D: usize>(low: [f64; D], high: [f64; D]) -> Cuboid<D> {
    Cuboid::new(low, high).expect("cuboid")
}

/// Two particles a cell and axis.
pub fn seeds<const D: usize>(cuboid: &Cuboid<D>, lattice: &Lattice<D>) -> Seeds<D> {
    fill(cuboid, lattice, 2, &Filling::new()).expect("seeds")
}

/// Bars between points, `parts` elements each.
#[allow(dead_code, reason = "not all that share this have bars")]
pub fn bars<const D: usize>(ends: &[[[f64; D]; 2]], parts: usize) -> ElementMesh<D> {
    let mut mesh = ElementMesh { nodes: Vec::new(), blocks: Vec::new(), node_sets: Default::default() };
    let mut links = Vec::new();
    for [from, to] in ends {
        for n in 0..=parts {
            let part = n as f64 / parts as f64;
            if n > 0 {
                let last = mesh.nodes.len() as u32;
                links.extend([last - 1, last]);
            }
            mesh.nodes.push(std::array::from_fn(|d| from[d] + part * (to[d] - from[d])));
        }
    }
    mesh.blocks.push(ElementBlock { name: "bars".into(), kind: ElementKind::Bar2, nodes: links });
    mesh
}
