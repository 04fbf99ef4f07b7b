//! Method-specific parts of the gates.

use std::sync::Arc;

use fem::Fem;
use fpm::{Cells, Domain, Fpm, OuterFace};
use mpm_core::geometry::{Cuboid, Filling, Lattice};
use mpm_core::{Boundary, Mpm, PlaneStrain, Solver, StepError};
use mpm_materials::IntoMaterial;
use pcmm::Pcmm;
use sph::{Layout, Sph};

use super::matter::{Load, Setup};
use crate::fragile::{Flux, Fragile};
use crate::work::Work;

pub fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Refuse a load for methods without tractions.
pub fn unloaded(setup: &Setup) -> Result<(), String> {
    if setup.load.is_some() { Err("no tractions act on it".into()) } else { Ok(()) }
}

/// Method-specific part of a body.
pub trait Solved {
    fn solver(&mut self) -> &mut dyn Solver;
    /// Advance to time `end`, s.
    fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        self.solver().run_until(end)
    }
    /// Visit mass, position and velocity of every particle or node, with its initial index; no call for bodies whose points have none.
    fn each(&self, visit: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2]));
    /// Height and largest radius, m, of a body whose points have no initial position.
    fn outer_sizes(&self) -> Option<[f64; 2]> {
        None
    }
    /// Correct the counts of particles and nodes for a variable number of points.
    fn weigh(&self, _work: &mut Work) {}
}

impl Solved for Mpm<2> {
    fn solver(&mut self) -> &mut dyn Solver {
        self
    }
    fn each(&self, visit: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2])) {
        let plane = |x: [f64; 3]| [x[0], x[1]];
        self.bodies()[0].for_each(&mut |p| visit(p.number, p.mass, plane(p.position), plane(p.velocity)));
    }
}

impl Solved for Fem<2> {
    fn solver(&mut self) -> &mut dyn Solver {
        self
    }
    fn each(&self, visit: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2])) {
        let nodes = self.body(0).nodes().iter().enumerate();
        nodes.for_each(|(n, node)| visit(n, node.mass, node.position, node.velocity));
    }
}

impl<M: pcmm::Composition<2>> Solved for Pcmm<2, M> {
    fn solver(&mut self) -> &mut dyn Solver {
        self
    }
    fn each(&self, visit: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2])) {
        self.particles().iter().enumerate().for_each(|(n, p)| visit(n, p.mass, p.position, p.velocity));
    }
}

impl<M: sph::Composition<2>> Solved for Sph<2, M> {
    fn solver(&mut self) -> &mut dyn Solver {
        self
    }
    fn each(&self, visit: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2])) {
        for (i, &n) in self.numbers().iter().enumerate() {
            visit(n as usize, self.mass(i), self.positions()[i], self.velocity(i));
        }
    }
}

/// Body with the initial positions of its points.
pub type Rested = (Vec<[f64; 2]>, Box<dyn Solved>);

/// Build smoothed particles in a box: rows on both ends, where walls and clamps are, and half a spacing within its
/// sides.
pub fn smoothed<M: sph::Composition<2>>(
    method: M,
    setup: Setup,
    law: impl IntoMaterial<f64>,
    (shape, lattice, filling): (&Cuboid<2>, &Lattice<2>, &Filling),
) -> Result<Rested, String> {
    unloaded(&setup)?;
    let upright = setup.size[1] > setup.size[0];
    let layout = Layout::on_faces(shape, lattice, [!upright, upright], filling).map_err(text)?;
    let velocity = setup.velocity;
    let mut body = Sph::new(method, law, &layout, |x| velocity(x)).map_err(text)?;
    for boundary in setup.boundaries {
        body.bound(boundary).map_err(text)?;
    }
    Ok((layout.positions, Box::new(body)))
}

impl<M: fpm::Composition<2>> Solved for Fpm<2, M> {
    fn solver(&mut self) -> &mut dyn Solver {
        self
    }
    fn each(&self, visit: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2])) {
        for (i, &n) in self.numbers().iter().enumerate() {
            visit(n as usize, self.masses()[i], self.position(i), self.velocities()[i]);
        }
    }
}

/// Build fragile points in the box.
pub fn fragile(way: Fragile, setup: Setup, law: impl IntoMaterial<f64>) -> Result<Rested, String> {
    let h = setup.size[0] / setup.cells[0] as f64;
    let domain = Domain::cuboid([0.0; 2], setup.size).map_err(text)?;
    let cells = way.cells(&domain, setup.cells, h).map_err(text)?;
    let law = law.into_material();
    let solved = match way.flux {
        Flux::Incomplete => joined(fpm::Method::printed(PlaneStrain), setup, law, &cells)?,
        Flux::Symmetric => joined(fpm::Method::symmetric(PlaneStrain), setup, law, &cells)?,
    };
    Ok((cells.points().to_vec(), solved))
}

/// Build cells with the flux of the method. Fixed boundaries become face conditions, since no point is on these planes.
fn joined<M: fpm::Composition<2>>(
    method: M,
    setup: Setup,
    law: impl IntoMaterial<f64>,
    cells: &Cells<2>,
) -> Result<Box<dyn Solved>, String> {
    let (velocity, length) = (setup.velocity, setup.size[0]);
    let mut body = Fpm::new(method, law, cells, |x| velocity(x)).map_err(text)?;
    let lies = |face: &OuterFace<2>, axis: usize, at: f64| {
        (face.centroid[axis] - at).abs() < 1e-9 * length && face.normal[axis].abs() > 0.999
    };
    for boundary in setup.boundaries {
        match boundary {
            Boundary::Fixed { axis, at, .. } => {
                body.hold_faces(|face| lies(face, axis, at), Arc::new(|_| [Some(0.0); 2])).map_err(text)?;
            }
            other => body.bound(other).map_err(text)?,
        }
    }
    if let Some(load) = setup.load {
        body.load_faces(|face| lies(face, 0, length), load).map_err(text)?;
    }
    Ok(Box::new(body))
}

/// Finite elements under a traction on the nodes of an end.
pub struct Loaded {
    fem: Fem<2>,
    /// Nodes and their tributary lengths of the end, m.
    ends: Vec<(usize, f64)>,
    load: Load,
}

impl Loaded {
    /// Apply the load at the end `length` m along x.
    pub fn new(fem: Fem<2>, length: f64, load: Load) -> Self {
        let nodes = fem.body(0).nodes().iter().enumerate();
        let at_end = nodes.filter(|(_, node)| node.position[0] > (1.0 - 1e-9) * length);
        let mut places: Vec<(usize, f64)> = at_end.map(|(n, node)| (n, node.position[1])).collect();
        places.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut ends: Vec<(usize, f64)> = places.iter().map(|&(n, _)| (n, 0.0)).collect();
        for (k, pair) in places.windows(2).enumerate() {
            let half = 0.5 * (pair[1].1 - pair[0].1);
            ends[k].1 += half;
            ends[k + 1].1 += half;
        }
        Loaded { fem, ends, load }
    }

    /// Advance one step of at most `left` s. Leapfrog velocities are at mid-step: the first force acts for half a
    /// step.
    ///
    /// Never inlined, so that its instructions can be counted.
    #[inline(never)]
    fn step_at_most_loaded(&mut self, left: f64) -> Result<(), StepError> {
        let clock = *self.fem.clock();
        let dt = clock.step_within(self.fem.next_time_step(), left)?;
        let last = clock.last.unwrap_or(0.0);
        let traction = (self.load)(clock.time);
        let mut trial = self.fem.trial(dt)?;
        for &(node, share) in &self.ends {
            trial.body_mut(0).add_impulse(node, traction.map(|t| 0.5 * (last + dt) * share * t));
        }
        trial.finish()
    }
}

impl Solved for Loaded {
    fn solver(&mut self) -> &mut dyn Solver {
        &mut self.fem
    }
    fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        while self.fem.clock().time < end {
            self.step_at_most_loaded(end - self.fem.clock().time)?;
        }
        Ok(())
    }
    fn each(&self, visit: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2])) {
        self.fem.each(visit);
    }
}
