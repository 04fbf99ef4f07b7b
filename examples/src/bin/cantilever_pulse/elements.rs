//! Finite elements of the library for the same beam, until the first minimum of the tip: stress at the root, for which no
//! reference values exist.

use std::sync::Arc;

use examples::CaseError;
use fem::{Fem, MeshBody, Technology};
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Cuboid, ElementKind};
use mpm_core::{PlaneStrain, Solver, Team};
use mpm_materials::IntoMaterial;

use crate::scene::{BESIDE, Beam, Entry, HEIGHT, LENGTH, Law, QUARTER, SHEAR, SLENDER};

/// End time, s; the first minimum of the tip is at 0.11 s.
pub const END: f64 = 0.2;
/// Number of steps between two entries.
const EVERY: u64 = 5;

/// Run squares with two quadrature points an axis, `through` of them over the height: a multiple of 24, so that four share
/// a corner at each point of the stress history.
pub fn swing(beam: Beam, through: usize, threads: usize) -> Result<Vec<Entry>, CaseError> {
    beam.with_law(|law| match law {
        Law::Stress(law) => run(law, through, threads),
        Law::Strain(law) => run(law, through, threads),
    })
}

fn run(law: impl IntoMaterial<f64>, through: usize, threads: usize) -> Result<Vec<Entry>, CaseError> {
    let body = Cuboid::new([0.0, -0.5 * HEIGHT], [LENGTH, 0.5 * HEIGHT])?;
    let mut mesh = box_mesh(&body, [SLENDER * through, through])?;
    let h = HEIGHT / through as f64;
    let held = mesh.nodes_where(|x| x[0] < 1e-6 * h);
    mesh.node_sets.insert("held".into(), held);
    let end = mesh.nodes_where(|x| x[0] > LENGTH - 1e-6 * h);
    // Corner nodes bear half the load.
    let corner = |n: u32| mesh.nodes[n as usize][1].abs() > 0.5 * HEIGHT - 1e-6 * h;
    let loads: Vec<(usize, f64)> =
        end.iter().map(|&n| (n as usize, SHEAR * h * if corner(n) { 0.5 } else { 1.0 })).collect();
    let middle = end.iter().copied().find(|&n| mesh.nodes[n as usize][1].abs() < 1e-6 * h);
    let middle = middle.ok_or_else(|| CaseError::Other("no node in the middle of the end".into()))? as usize;
    let body = MeshBody::new("beam", mesh, law).with(ElementKind::Quad4, Technology::Full);
    let mut fem = Fem::new(PlaneStrain);
    fem.add(body)?;
    fem.prescribe(0, "held", Arc::new(|_| [Some(0.0); 3]))?;
    fem.set_team(Team::new(threads)?);
    let mut entries = vec![Entry { time: 0.0, tip: 0.0, stress: [0.0; 2] }];
    while fem.time() < END {
        let dt = fem.next_time_step();
        let mut trial = fem.trial(dt)?;
        for &(node, force) in &loads {
            trial.body_mut(0).add_impulse(node, [0.0, -force * dt]);
        }
        trial.finish()?;
        if fem.clock().steps % EVERY == 0 {
            entries.push(Entry {
                time: fem.time(),
                tip: fem.body(0).nodes()[middle].position[1],
                stress: [1.0, -1.0].map(|side| stress(&fem, side * QUARTER, h)),
            });
        }
    }
    Ok(entries)
}

/// Return the mean axial stress of the elements around a point beside the root at a height, Pa.
fn stress(fem: &Fem<2>, y: f64, h: f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    fem.bodies()[0].for_each(&mut |p| {
        if (p.position[0] - BESIDE).abs() < 0.75 * h && (p.position[1] - y).abs() < 0.75 * h {
            sum += p.stress[0];
            count += 1.0;
        }
    });
    sum / count
}
