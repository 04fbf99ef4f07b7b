//! Meshes and laws.

use impactite_geometry::{ElementBlock, ElementKind, ElementMesh};
use mpm_materials::strength::LinearHardening;
use mpm_materials::{
    BulkViscosity, Fluid, Inviscid, J2, LinearElastic, LogarithmicBulk, MieGruneisen, Moduli, NoFailure,
    Solid,
};

/// Pseudorandom number in [-1, 1) from a seed and a place.
pub fn random(seed: u64, place: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ place.wrapping_mul(0xD1B5_4A32_D192_ED03);
    for _ in 0..3 {
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z ^= z >> 27;
    }
    (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Relative difference.
pub fn off(value: f64, wanted: f64) -> f64 {
    (value / wanted - 1.0).abs()
}

/// Mesh of `counts` boxes between two corners, cut into elements of a kind, with the node sets `low x`, `high x` and so on.
pub fn mesh<const D: usize>(
    kind: ElementKind,
    low: [f64; D],
    high: [f64; D],
    counts: [usize; D],
) -> ElementMesh<D> {
    let sites: [usize; D] = counts.map(|n| n + 1);
    let index = |at: [usize; 3]| -> u32 {
        let mut index = 0;
        for d in (0..D).rev() {
            index = index * sites[d] + at[d];
        }
        index as u32
    };
    let place = |mut n: usize, of: [usize; D]| -> [usize; 3] {
        let mut at = [0; 3];
        for d in 0..D {
            (at[d], n) = (n % of[d], n / of[d]);
        }
        at
    };
    let mut nodes = Vec::new();
    let mut node_sets = std::collections::BTreeMap::<String, Vec<u32>>::new();
    for n in 0..sites.iter().product() {
        let at = place(n, sites);
        nodes.push(std::array::from_fn(|d| low[d] + (high[d] - low[d]) * at[d] as f64 / counts[d] as f64));
        for d in 0..D {
            for (end, name) in [(0, "low"), (counts[d], "high")] {
                if at[d] == end {
                    node_sets.entry(format!("{name} {}", ["x", "y", "z"][d])).or_default().push(n as u32);
                }
            }
        }
    }
    let mut list = Vec::new();
    for e in 0..counts.iter().product() {
        let [x, y, z] = place(e, counts);
        let corner = |c: usize| {
            let up = [matches!(c % 4, 1 | 2), c % 4 >= 2, c >= 4].map(usize::from);
            index([x + up[0], y + up[1], z + up[2]])
        };
        let cut: &[&[usize]] = match kind {
            ElementKind::Bar2 => &[&[0, 1]],
            // Diagonals alternate.
            ElementKind::Triangle3 if (x + y) % 2 == 0 => &[&[0, 1, 2], &[0, 2, 3]],
            ElementKind::Triangle3 => &[&[0, 1, 3], &[1, 2, 3]],
            ElementKind::Quad4 => &[&[0, 1, 2, 3]],
            ElementKind::Tetra4 => {
                &[&[0, 1, 2, 6], &[0, 2, 3, 6], &[0, 3, 7, 6], &[0, 7, 4, 6], &[0, 4, 5, 6], &[0, 5, 1, 6]]
            }
            ElementKind::Hexa8 => &[&[0, 1, 2, 3, 4, 5, 6, 7]],
        };
        list.extend(cut.iter().flat_map(|nodes| nodes.iter().map(|&c| corner(c))));
    }
    let blocks = vec![ElementBlock { name: "all".into(), kind, nodes: list }];
    ElementMesh { nodes, blocks, node_sets, ..ElementMesh::default() }
}

/// Distort a mesh: move its inner nodes by up to a part of the spacing.
pub fn distorted<const D: usize>(mut mesh: ElementMesh<D>, part: f64, spacing: f64) -> ElementMesh<D> {
    let outside: std::collections::BTreeSet<u32> = mesh.node_sets.values().flatten().copied().collect();
    for (n, x) in mesh.nodes.iter_mut().enumerate() {
        if !outside.contains(&(n as u32)) {
            for d in 0..D {
                x[d] += part * spacing * random(7, (n * D + d) as u64);
            }
        }
    }
    mesh
}

/// Mesh of a ball of radius `r` on the origin, around the axis: a square bent to a disc, fine at the lower pole.
pub fn ball(r: f64, fine: f64, growth: f64) -> ElementMesh<2> {
    let graded = |length: f64| {
        let (mut list, mut step) = (vec![0.0], fine);
        while list[list.len() - 1] < length {
            list.push(list[list.len() - 1] + step);
            step *= growth;
        }
        let last = list[list.len() - 1];
        list.iter().map(|x| x / last).collect::<Vec<f64>>()
    };
    let (xs, ys) = (graded(r), graded(2.0 * r));
    let (mut nodes, mut list) = (Vec::new(), Vec::new());
    for (j, y) in ys.iter().enumerate() {
        for (i, x) in xs.iter().enumerate() {
            let y = 2.0 * y - 1.0;
            nodes.push([r * x * (1.0 - 0.5 * y * y).sqrt(), r * (1.0 + y * (1.0 - 0.5 * x * x).sqrt())]);
            if i + 1 < xs.len() && j + 1 < ys.len() {
                let n = j * xs.len() + i;
                list.extend([n, n + 1, n + 1 + xs.len(), n + xs.len()].map(|n| n as u32));
            }
        }
    }
    let block = ElementBlock { name: "ball".into(), kind: ElementKind::Quad4, nodes: list };
    ElementMesh { nodes, blocks: vec![block], ..ElementMesh::default() }
}

pub fn elastic(density: f64, young: f64, poisson: f64) -> LinearElastic<f64> {
    LinearElastic::new(density, Moduli::young_poisson(young, poisson).unwrap()).unwrap()
}

/// Ideally plastic metal with bulk viscosity.
pub type Flowing = Solid<J2<f64>, LogarithmicBulk<f64>, NoFailure, BulkViscosity<f64>>;
pub fn flowing(density: f64, young: f64, poisson: f64, strength: f64) -> Flowing {
    let moduli = Moduli::young_poisson(young, poisson).unwrap();
    let j2 = J2::new(moduli.shear, LinearHardening::new(strength, 0.0).unwrap()).unwrap();
    let eos = LogarithmicBulk::new(density, moduli.bulk).unwrap();
    Solid::new(j2, eos).with_bulk_viscosity(0.06, 1.5).unwrap()
}

/// Copper without strength, with its shock equation of state.
pub fn copper_fluid() -> Fluid<MieGruneisen<f64>, Inviscid, BulkViscosity<f64>> {
    let eos = MieGruneisen::new(8930.0, 3940.0, 1.49, 2.0).unwrap();
    Fluid::new(eos).with_bulk_viscosity(0.06, 1.5).unwrap()
}
