//! Conversion of elements to particles: too late, at a contact, in a zone that is too small, and with bars across its
//! border.

use std::f64::consts::PI;

use coupling::{Conversion, Elements};
use fem::{Fem, MeshBody};
use impactite_geometry::structured::box_mesh;
use impactite_geometry::{Cuboid, ElementBlock, ElementKind, ElementMesh, Lattice};
use impactite_scene::Solver;
use mpm_contact::{Coulomb, Pairs, SeparatingPlane, SurfaceDistance};
use mpm_core::{BlockGrid, Boundary, GridContact, Method, Mpm, PlaneStrain, Side};
use mpm_materials::{LinearElastic, Moduli, library};
use verification::problems::rubber;

use crate::stage::text;
use crate::verdict::{Limit, Measured, Scene, Size, Stop};

/// Half width and length of the bar, m, and number of cells of the half width.
const BAR: [f64; 2] = [5e-3, 35e-3];
const ACROSS: usize = 6;
const SPEED: f64 = 400.0;
const END: f64 = 80e-6;

/// Build half a copper bar of elements.
fn bar() -> Result<Fem<2>, String> {
    let counts = [ACROSS, (ACROSS as f64 * BAR[1] / BAR[0]).round() as usize];
    let mesh = box_mesh(&Cuboid::new([0.0; 2], BAR).map_err(text)?, counts).map_err(text)?;
    let mut fem = Fem::new(PlaneStrain);
    let body = MeshBody::new("bar", mesh, library::copper_feng_2014()).moving(|_| [0.0, -SPEED]);
    fem.add(body).map_err(text)?;
    Ok(fem)
}

fn planes() -> [Boundary<2>; 2] {
    [
        Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above },
        Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 },
    ]
}

/// Measure the smallest step over the first one.
fn shortest(solver: &mut dyn Solver) -> Measured {
    let (mut first, mut shortest, mut steps) = (0.0, f64::INFINITY, 0);
    while !solver.reached(END) {
        match solver.step_at_most(f64::INFINITY) {
            Ok(step) => {
                first = if steps == 0 { step } else { first };
                shortest = shortest.min(step);
                steps += 1;
            }
            Err(e) => {
                let stop = Stop { step: e.step, what: e.to_string() };
                return Measured::new(shortest / first, steps).stopped(Some(stop));
            }
        }
        if steps > 200_000 {
            break;
        }
    }
    Measured::new(shortest / first, steps)
}

fn converted(conversion: fn() -> Result<Conversion<2>, String>) -> impl Fn(Size) -> Result<Measured, String> {
    move |_| {
        let (elements, _) = Elements::converting(bar()?, "foot", conversion()?).map_err(text)?;
        let lattice = Lattice::new([0.0; 2], BAR[0] / ACROSS as f64).map_err(text)?;
        let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
        mpm.add_client(elements).map_err(text)?;
        planes().into_iter().try_for_each(|plane| mpm.bound(plane)).map_err(text)?;
        Ok(shortest(&mut mpm))
    }
}

/// T22: conversion of elements to particles, too late.
pub fn too_late() -> Scene {
    fn alone(_: Size) -> Result<Measured, String> {
        let mut fem = bar()?;
        planes().into_iter().try_for_each(|plane| fem.bound(plane)).map_err(text)?;
        Ok(shortest(&mut fem))
    }
    fn late() -> Result<Conversion<2>, String> {
        Ok(Conversion::adaptive().when_distorted(0.01, 0.01).when_step_falls_to(0.02))
    }
    Scene {
        id: "T22",
        name: "elements become particles too late",
        fails: "Half a copper bar, 10 by 35 mm in plane strain, runs at 400 m/s into a wall. Elements of the foot become flat: their stable \
                step falls without end, or they turn inside out and the run stops.",
        metric: "shortest step over the first",
        limit: Limit::AtLeast(0.3),
        rows: Vec::new(),
    }
    .fails("elements", "list T22, of plain elements", alone)
    .fails("particles at a Jacobian of 0.01 and a fiftieth of the step", "list T22, too late", converted(late))
    .holds("Conversion::adaptive", "own", converted(|| Ok(Conversion::adaptive())))
}

/// Run the collision of two elastic blocks; measure the velocity ratio of the left one, after over before.
fn after(touching: bool) -> Result<Measured, String> {
    const SPEED: f64 = 1.0;
    let block = |left: f64, speed: f64| -> Result<MeshBody<2>, String> {
        let shape = Cuboid::new([left, 0.0], [left + 16.0, 8.0]).map_err(text)?;
        let name = if left < 0.0 { "left" } else { "right" };
        Ok(MeshBody::new(name, box_mesh(&shape, [16, 8]).map_err(text)?, rubber(1.0, 400.0, 0.3)?)
            .moving(move |_| [speed, 0.0]))
    };
    let end = 16.0;
    let (left, right) = (block(-20.0, SPEED)?, block(4.0, -SPEED)?);
    let speed = |solver: &dyn Solver| {
        let own = solver.bodies().into_iter().filter(|b| b.name().starts_with("left"));
        let (mass, momentum) = own.fold((0.0, 0.0), |sum, b| {
            let totals = b.totals();
            (sum.0 + totals.mass, sum.1 + totals.momentum[0])
        });
        momentum / mass / SPEED
    };
    if !touching {
        let mut fem = Fem::new(PlaneStrain);
        fem.add(left).map_err(text)?;
        fem.add(right).map_err(text)?;
        fem.run_until(end).map_err(text)?;
        return Ok(Measured::new(speed(&fem), fem.clock().steps));
    }
    let lattice = Lattice::new([0.0; 2], 1.0).map_err(text)?;
    let surfaces = SurfaceDistance::new(SeparatingPlane, 0.0).map_err(text)?.locally();
    let contact = GridContact::new(surfaces, Pairs::new(Coulomb::new(0.3).map_err(text)?));
    let mut mpm = Mpm::with_contact(Method::impact(PlaneStrain), BlockGrid::new(lattice), contact);
    for (body, into) in [(left, "left, particles"), (right, "right, particles")] {
        let mut fem = Fem::new(PlaneStrain);
        fem.add(body).map_err(text)?;
        let (elements, _) = Elements::converting(fem, into, Conversion::adaptive()).map_err(text)?;
        mpm.add_client(elements).map_err(text)?;
    }
    mpm.run_until(end).map_err(text)?;
    Ok(Measured::new(speed(&mpm), Solver::clock(&mpm).steps))
}

/// C1: conversion of elements to particles at a contact.
pub fn at_a_contact() -> Scene {
    Scene {
        id: "C1",
        name: "elements become particles where bodies meet",
        fails: "Two blocks of elements of different scenes run into each other. What is not on the grid is not felt there, and they would pass \
                through each other: elements that matter of others comes near become particles before.",
        metric: "speed of the left block after it over that before",
        limit: Limit::AtMost(-0.5),
        rows: Vec::new(),
    }
    .fails("elements, no contact", "what happens without", |_| after(false))
    .holds("Conversion::adaptive", "own", |_| after(true))
}

/// C2: conversion in a zone that is too small for the flow.
pub fn at_the_border() -> Scene {
    fn foot() -> Result<Conversion<2>, String> {
        let region = Cuboid::new([-1.0, -1.0], [0.5 * BAR[0] + 1e-6, 0.5 * BAR[0] + 1e-6]).map_err(text)?;
        Ok(Conversion::within(region))
    }
    Scene {
        id: "C2",
        name: "flow reaches the border of a converted zone",
        fails: "The bar of T22, of which half the width is particles at the foot. What flows from there comes to the elements beside, which \
                become flat as all of them do without particles.",
        metric: "shortest step over the first",
        limit: Limit::AtLeast(0.5),
        rows: Vec::new(),
    }
    .fails("Conversion::within", "own", converted(foot))
    .holds("and where elements are distorted", "own", converted(|| Ok(foot()?.when_distorted(0.4, 0.25).when_step_falls_to(0.5))))
}

/// Run a concrete strip, one half particles and one half elements, with steel bars (a tenth of the height) over a part of its length, in
/// its first longitudinal mode; measure the error of the period against that with full-length bars.
fn reinforced(bars_from: f64) -> Result<Measured, String> {
    const H: f64 = 0.025;
    const CELLS: [usize; 2] = [40, 4];
    let mode = |x: [f64; 2]| [1e-2 * (PI * x[0]).cos(), 0.0];
    let law = |density: f64, young: f64| -> Result<LinearElastic<f64>, String> {
        LinearElastic::new(density, Moduli::young_poisson(young, 0.0).map_err(text)?).map_err(text)
    };
    let size = CELLS.map(|n| n as f64 * H);
    let mesh = box_mesh(&Cuboid::new([0.0; 2], size).map_err(text)?, CELLS.map(|n| 2 * n)).map_err(text)?;
    let mut fem = Fem::new(PlaneStrain);
    fem.add(MeshBody::new("elements", mesh, law(2440.0, 34e9)?).moving(mode)).map_err(text)?;
    let half = Cuboid::new([0.5 * size[0] - 1e-6, -1.0], [2.0, 1.0]).map_err(text)?;
    let (concrete, _) = Elements::converting(fem, "concrete", Conversion::within(half)).map_err(text)?;
    let (mut nodes, mut links) = (Vec::new(), Vec::new());
    for row in 0..CELLS[1] {
        let first = (bars_from / H).round() as usize;
        for n in first..=CELLS[0] {
            if n > first {
                links.extend([nodes.len() as u32 - 1, nodes.len() as u32]);
            }
            nodes.push([n as f64 * H, (row as f64 + 0.5) * H]);
        }
    }
    let block = ElementBlock { name: "bars".into(), kind: ElementKind::Bar2, nodes: links };
    let mesh = ElementMesh { nodes, blocks: vec![block], ..ElementMesh::default() };
    let mut steel = Fem::new(PlaneStrain);
    steel
        .add(MeshBody::new("bars", mesh, law(7850.0, 200e9)?).section(0.1 * H).moving(mode))
        .map_err(text)?;
    let lattice = Lattice::new([0.0; 2], H).map_err(text)?;
    let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
    mpm.add_client(concrete).map_err(text)?;
    mpm.add_client(Elements::within(steel, "concrete").map_err(text)?).map_err(text)?;
    let amplitude = |mpm: &Mpm<2>| {
        let mut sum = 0.0;
        for body in mpm.bodies() {
            body.for_each(&mut |p| sum += p.mass * p.velocity[0] * (PI * p.position[0]).cos());
        }
        sum
    };
    let expected = 2.0 * f64::sqrt((2440.0 + 785.0) / (34e9 + 20e9));
    let (mut last, mut crossings) = ((0.0, amplitude(&mpm)), Vec::new());
    while crossings.len() < 3 && mpm.time() < 4.0 * expected {
        mpm.step().map_err(text)?;
        let now = (mpm.time(), amplitude(&mpm));
        if now.1 * last.1 < 0.0 {
            crossings.push(last.0 + (now.0 - last.0) * last.1 / (last.1 - now.1));
        }
        last = now;
    }
    let [first, _, third] = crossings[..] else { return Err("it does not sway".into()) };
    Ok(Measured::new(((third - first) / expected - 1.0).abs(), Solver::clock(&mpm).steps))
}

/// C3: bars across the border of particles and elements.
pub fn bars_across() -> Scene {
    Scene {
        id: "C3",
        name: "bars across the border of particles and elements",
        fails: "A strip of concrete, of which one half is particles and the other elements, sways with bars along it. Bars that elements do not \
                feel hold one half alone.",
        metric: "error of the period of the first mode",
        limit: Limit::AtMost(0.005),
        rows: Vec::new(),
    }
    .fails("bars in the particles alone", "own", |_| reinforced(0.5))
    .holds("bars across the border", "own", |_| reinforced(0.0))
}
