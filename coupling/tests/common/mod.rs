//! Shared laws, boxes and particles of the tests.

use impactite_geometry::{Cuboid, ElementBlock, ElementKind, ElementMesh, Filling, Lattice, Seeds, fill};
use mpm_core::Mpm;
use mpm_materials::{LinearElastic, Moduli};

pub fn elastic(density: f64, young: f64, poisson: f64) -> LinearElastic<f64> {
    LinearElastic::new(density, Moduli::young_poisson(young, poisson).expect("moduli")).expect("law")
}

pub fn boxed<const D: usize>(low: [f64; D], high: [f64; D]) -> Cuboid<D> {
    Cuboid::new(low, high).expect("cuboid")
}

/// Seeds of two particles per cell and axis.
pub fn seeds<const D: usize>(cuboid: &Cuboid<D>, lattice: &Lattice<D>) -> Seeds<D> {
    fill(cuboid, lattice, 2, &Filling::new()).expect("seeds")
}

/// Bars between pairs of points, with `parts` elements each.
#[allow(dead_code, reason = "not all that share this have bars")]
pub fn bars<const D: usize>(ends: &[[[f64; D]; 2]], parts: usize) -> ElementMesh<D> {
    let mut mesh = ElementMesh { nodes: Vec::new(), blocks: Vec::new(), ..ElementMesh::default() };
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

/// Half period, s, of the first mode of a bar of this length, m, from six zero crossings, at a quarter and at three quarters of a period.
/// They must occur before `latest`, s.
#[allow(dead_code, reason = "not all that share this sway")]
pub fn half_period(mpm: &mut Mpm<2>, length: f64, latest: f64) -> f64 {
    let amplitude = |mpm: &Mpm<2>| {
        let mut sum = 0.0;
        for body in mpm.bodies() {
            body.for_each(&mut |p| {
                sum += p.mass * p.velocity[0] * (std::f64::consts::PI * p.position[0] / length).cos();
            });
        }
        sum
    };
    let (mut last, mut crossings) = ((0.0, amplitude(mpm)), Vec::new());
    while crossings.len() < 6 {
        mpm.step().expect("step");
        let now = (mpm.time(), amplitude(mpm));
        if now.1 * last.1 < 0.0 {
            crossings.push(last.0 + (now.0 - last.0) * last.1 / (last.1 - now.1));
        }
        last = now;
        assert!(mpm.time() < latest, "it does not sway");
    }
    (crossings[5] - crossings[0]) / 5.0
}
