//! Element updates a second of one core, and bytes an element and node:
//! `cargo run --release -p fem --example throughput [elements along an edge]`.
//!
//! Time is that of the processor where the system tells it (Linux): others may be using the machine.

use std::time::Instant;

use fem::{Fem, Hourglass, MeshBody, Technology};
use impactite_geometry::{ElementBlock, ElementKind, ElementMesh};
use impactite_scene::{Body as _, FullSpace, Solver as _, Watch};
use mpm_materials::strength::LinearHardening;
use mpm_materials::{J2, LogarithmicBulk, Moduli, Solid};

/// A cube of `n` bricks along an edge.
fn cube(n: usize) -> ElementMesh<3> {
    let at = |i: usize, j: usize, k: usize| ((k * (n + 1) + j) * (n + 1) + i) as u32;
    let (mut nodes, mut list) = (Vec::new(), Vec::new());
    for k in 0..=n {
        for j in 0..=n {
            for i in 0..=n {
                nodes.push([i, j, k].map(|c| 1e-3 * c as f64));
                if i < n && j < n && k < n {
                    let corner = |c: usize| {
                        at(i + usize::from(matches!(c % 4, 1 | 2)), j + usize::from(c % 4 >= 2), k + c / 4)
                    };
                    list.extend((0..8).map(corner));
                }
            }
        }
    }
    let block = ElementBlock { name: "cube".into(), kind: ElementKind::Hexa8, nodes: list };
    ElementMesh { nodes, blocks: vec![block], ..ElementMesh::default() }
}

/// Time of the processor, or of the clock, s.
fn processor(start: &Instant) -> f64 {
    let read = std::fs::read_to_string("/proc/self/schedstat").ok();
    let nanoseconds = read.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| start.elapsed().as_secs_f64(), |n| 1e-9 * n)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let sizes: Vec<usize> = std::env::args().skip(1).map(|n| n.parse()).collect::<Result<_, _>>()?;
    let sizes = if sizes.is_empty() { vec![20, 40, 64] } else { sizes };
    let moduli = Moduli::young_poisson(200e9, 0.3)?;
    let steel = Solid::new(
        J2::new(moduli.shear, LinearHardening::new(400e6, 1e9)?)?,
        LogarithmicBulk::new(7850.0, moduli.bulk)?,
    );
    let technologies = [
        Technology::OnePoint(Hourglass::Stiffness(0.05)),
        Technology::OnePoint(Hourglass::Viscous(0.1)),
        Technology::Full,
        Technology::MeanDilatation,
    ];
    println!(
        "edge  elements  technology                                  M updates/s  bytes/element  bytes/node"
    );
    for n in sizes {
        for technology in technologies {
            let mut fem = Fem::new(FullSpace);
            // Waves in all directions, beyond yield.
            let swing = |x: [f64; 3]| x.map(|c| 40.0 * (c * 700.0).sin());
            fem.add(
                MeshBody::new("cube", cube(n), steel).with(ElementKind::Hexa8, technology).moving(swing),
            )?;
            fem.set_watch(Watch::off());
            let elements = n * n * n;
            let steps = (1_000_000 / elements).max(2);
            for _ in 0..2 {
                fem.step_at_most(f64::INFINITY)?;
            }
            // The best of twelve, as others may be using the machine.
            let mut best = f64::INFINITY;
            for _ in 0..12 {
                let clock = Instant::now();
                let start = processor(&clock);
                for _ in 0..steps {
                    fem.step_at_most(f64::INFINITY)?;
                }
                best = best.min(processor(&clock) - start);
            }
            let rate = (elements * steps) as f64 / best / 1e6;
            let (bytes, nodes) = (fem.body(0).bytes(), fem.body(0).nodes().len());
            let flows = fem.body(0).points().iter().filter(|p| p.state.iter().any(|x| *x > 0.0)).count();
            assert!(flows > 0);
            println!(
                "{n:4}  {elements:8}  {:42}  {rate:11.2}  {:13.0}  {:10.0}",
                format!("{technology:?}"),
                bytes as f64 / elements as f64,
                bytes as f64 / nodes as f64
            );
        }
    }
    Ok(())
}
