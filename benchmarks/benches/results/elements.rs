//! Explicit finite elements compared with material points of the same law, and cost of element contact.

use std::f64::consts::PI;

use benchmarks::{Stepped, stepped};
use examples::CaseError;
use fem::{Fem, Hourglass, MeshBody, Technology};
use mpm_contact::Coulomb;
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Cuboid, ElementMesh, Filling, Lattice, fill};
use mpm_core::{
    BlockGrid, Embedding, Flip, FullSpace, IntoKernels, Linear, Method, Mpm, Musl, PlaneStrain, Solver,
};
use mpm_materials::{IntoMaterial, LinearElastic, Moduli, library};

use crate::page::{asked, table};
use crate::sample::{Run, Sample, Subject, alternate};

/// Edge length of a brick or quadrilateral, and particle spacing, m.
const EDGE: f64 = 1e-3;
/// Velocity amplitude of waves and speed of colliding blocks, m/s: its strain is beyond the yield of the steel.
const SPEED: f64 = 60.0;
/// Wavelength, m.
const WAVE: f64 = 20.0 * EDGE;
/// Minimum number of steps of a run, within which velocity waves turn into stress waves.
const STEPS: usize = 20;
/// Required rate of one-point bricks, million updates per second on one thread.
const RATE: f64 = 12.0;
/// Maximum share of contact in a step.
const SHARE: f64 = 0.1;

const ONE_POINT: Technology = Technology::OnePoint(Hourglass::Stiffness(0.05));
const BRICKS: &str = "bricks, one point";

/// Square or cube with `cells` edges along each axis.
#[derive(Clone, Copy)]
struct Block<const D: usize> {
    cells: usize,
}

impl<const D: usize> Block<D> {
    /// Create a block of about this number of elements, an even number along each axis.
    fn of(elements: f64) -> Self {
        Block { cells: 2 * (0.5 * elements.powf(1.0 / D as f64)).round() as usize }
    }

    fn shape(self, low: [f64; D]) -> Result<Cuboid<D>, CaseError> {
        Ok(Cuboid::new(low, low.map(|x| x + self.cells as f64 * EDGE))?)
    }

    fn mesh(self, low: [f64; D]) -> Result<ElementMesh<D>, CaseError> {
        Ok(box_mesh(&self.shape(low)?, [self.cells; D])?)
    }

    fn elements(
        self,
        space: impl Embedding<D>,
        mesh: ElementMesh<D>,
        technology: Technology,
        law: impl IntoMaterial<f64>,
    ) -> Result<Scene, CaseError> {
        let kind = mesh.blocks[0].kind;
        let mut fem = Fem::new(space);
        fem.add(MeshBody::new("block", mesh, law).with(kind, technology).moving(swing))?;
        Ok(Scene { nodes: Some(fem.body(0).nodes().len()), solver: Box::new(fem) })
    }

    /// Build the same number of particles, two along the edge of a cell.
    fn particles(
        self,
        method: impl IntoKernels<f64, D>,
        law: impl IntoMaterial<f64>,
    ) -> Result<Scene, CaseError> {
        let lattice = Lattice::new([0.0; D], 2.0 * EDGE)?;
        let seeds = fill(&self.shape([0.0; D])?, &lattice, 2, &Filling::new())?;
        let mut mpm = Mpm::<D>::new(method, BlockGrid::new(lattice));
        mpm.add("block", law, &seeds, swing)?;
        Ok(Scene { nodes: None, solver: Box::new(mpm) })
    }

    /// Build two blocks in head-on collision, laterally displaced by half an edge; without `touch` they pass
    /// through each other.
    fn pair(
        self,
        space: impl Embedding<D>,
        touch: bool,
        law: impl IntoMaterial<f64> + Copy,
    ) -> Result<Fem<D>, CaseError> {
        let mut fem = Fem::new(space);
        let mut beside = [0.5 * EDGE; D];
        beside[0] = self.cells as f64 * EDGE;
        for (name, low, speed) in [("left", [0.0; D], SPEED), ("right", beside, -SPEED)] {
            let towards = move |_: [f64; D]| std::array::from_fn(|d| if d == 0 { speed } else { 0.0 });
            fem.add(MeshBody::new(name, self.mesh(low)?, law).moving(towards))?;
        }
        if touch {
            fem.touch(Coulomb::new(0.3)?)?;
        }
        Ok(fem)
    }
}

/// Velocity waves along every axis.
fn swing<const D: usize>(x: [f64; D]) -> [f64; D] {
    x.map(|x| SPEED * (2.0 * PI * x / WAVE).sin())
}

/// Scene to run.
struct Scene {
    solver: Box<dyn Solver>,
    /// Number of nodes of the mesh, if any.
    nodes: Option<usize>,
}

/// Result of a run.
struct Measured {
    run: Stepped,
    nodes: Option<usize>,
}

impl Run for Measured {
    fn rate(&self) -> f64 {
        self.run.updates_per_second()
    }
}

/// Number of steps for about this number of updates.
fn steps(updates: usize, points: usize) -> u64 {
    (updates / points).max(STEPS) as u64
}

fn measure(mut scene: Scene, threads: usize, updates: usize) -> Result<Measured, CaseError> {
    let steps = steps(updates, scene.solver.moving_points());
    let run = stepped(&mut *scene.solver, threads, steps)?;
    let bodies = scene.solver.bodies();
    let plastic = bodies[0].state_names().iter().position(|name| name == "plastic_strain");
    if let Some(place) = plastic {
        let mut flows = false;
        bodies[0].for_each(&mut |p| flows |= p.state[place] > 0.0);
        if !flows {
            return Err(CaseError::Other("elements: no point of the steel flows".into()));
        }
    }
    Ok(Measured { run, nodes: scene.nodes })
}

type Make = Box<dyn Fn() -> Result<Scene, CaseError>>;

/// List scenes of elements and particles of a law, of about equal size.
fn scenes<L: IntoMaterial<f64> + Copy + 'static>(law: L, elements: f64) -> Vec<(&'static str, Make)> {
    let (solid, plane) = (Block::<3>::of(elements), Block::<2>::of(elements));
    // Six tetrahedra per brick.
    let coarse = Block::<3>::of(elements / 6.0);
    let bricks = move |technology| -> Make {
        Box::new(move || solid.elements(FullSpace, solid.mesh([0.0; 3])?, technology, law))
    };
    let squares = move |technology| -> Make {
        Box::new(move || plane.elements(PlaneStrain, plane.mesh([0.0; 2])?, technology, law))
    };
    let tetrahedra: Make = Box::new(move || {
        let mesh = coarse.mesh([0.0; 3])?.split_to_tetrahedra()?;
        coarse.elements(FullSpace, mesh, Technology::AveragedVolumes, law)
    });
    let in_space: Make = Box::new(move || solid.particles(Method::new(Linear, Flip, Musl, FullSpace), law));
    let in_plane: Make = Box::new(move || plane.particles(Method::new(Linear, Flip, Musl, PlaneStrain), law));
    vec![
        (BRICKS, bricks(ONE_POINT)),
        ("bricks, mean dilatation", bricks(Technology::MeanDilatation)),
        ("tetrahedra, averaged volumes", tetrahedra),
        ("particles in space", in_space),
        ("quadrilaterals, one point", squares(ONE_POINT)),
        ("quadrilaterals, mean dilatation", squares(Technology::MeanDilatation)),
        ("particles in plane strain", in_plane),
    ]
}

/// Rounds, and point updates per run.
#[derive(Clone, Copy)]
struct Effort {
    rounds: usize,
    updates: usize,
}

/// Measure the rows of a law, and the minimum rate of one-point bricks on one thread.
fn rows<L: IntoMaterial<f64> + Copy + 'static>(
    name: &str,
    law: L,
    elements: f64,
    effort: Effort,
) -> Result<(Vec<[String; 8]>, f64), CaseError> {
    let scenes = scenes(law, elements);
    let mut subjects = Vec::new();
    for (what, make) in &scenes {
        for threads in [1, 2] {
            subjects.push(Subject::new(*what, move || measure(make()?, threads, effort.updates)));
        }
    }
    let samples = alternate(&subjects, effort.rounds)?;
    let (mut rows, mut least) = (Vec::new(), f64::INFINITY);
    for pair in samples.chunks_exact(2) {
        let (one, Measured { run, nodes }) = (pair[0].rates(), pair[0].first());
        let is_asked = pair[0].name == BRICKS;
        if is_asked {
            least = least.min(one.median);
        }
        rows.push([
            name.into(),
            pair[0].name.clone(),
            run.points.to_string(),
            one.text(1),
            if is_asked { asked(RATE, one.median >= RATE) } else { "-".into() },
            pair[1].rates().text(1),
            format!("{:.0}", run.bytes_per_point()),
            nodes.map_or("-".into(), |nodes| format!("{:.0}", run.bytes as f64 / nodes as f64)),
        ]);
    }
    Ok((rows, least))
}

/// Measure two blocks with and without contact.
fn contact<const D: usize, L: IntoMaterial<f64> + Copy>(
    name: &str,
    (space, law): (impl Embedding<D>, L),
    elements: f64,
    effort: Effort,
) -> Result<Vec<[String; 6]>, CaseError> {
    let block = Block::<D>::of(0.5 * elements);
    let run = |touch: bool, threads: usize| {
        let mut fem = block.pair(space, touch, law)?;
        let steps = steps(effort.updates, fem.moving_points());
        let run = stepped(&mut fem, threads, steps)?;
        if touch && fem.contacts().is_empty() {
            return Err(CaseError::Other(format!("{name}: the blocks do not meet")));
        }
        Ok(run)
    };
    let mut rows = Vec::new();
    for threads in [1, 2] {
        let samples: Vec<Sample<Stepped>> = alternate(
            &[Subject::new("off", || run(false, threads)), Subject::new("on", || run(true, threads))],
            effort.rounds,
        )?;
        let longer = samples[0].over(&samples[1]);
        let share = 1.0 - 1.0 / longer.median;
        rows.push([
            name.into(),
            samples[1].first().points.to_string(),
            threads.to_string(),
            longer.text(2),
            format!("{:.1} %", 100.0 * share),
            asked(format!("{:.0} %", 100.0 * SHARE), share <= SHARE),
        ]);
    }
    Ok(rows)
}

/// Measure rates and memory of elements, and the share of contact.
pub fn cost(quick: bool) -> Result<Option<String>, CaseError> {
    let (effort, sizes) = if quick {
        (Effort { rounds: 3, updates: 1_000_000 }, &[50e3][..])
    } else {
        (Effort { rounds: 5, updates: 4_000_000 }, &[50e3, 200e3][..])
    };
    let elastic = LinearElastic::new(7830.0, Moduli::young_poisson(200e9, 0.29)?)?;
    let steel = library::steel_4340().with_bulk_viscosity(0.06, 1.5)?;
    let (mut all, mut touching, mut least) = (Vec::new(), Vec::new(), f64::INFINITY);
    for &elements in sizes {
        let (of_elastic, one) = rows("linear elastic", elastic, elements, effort)?;
        let (of_steel, other) = rows("Johnson-Cook", steel, elements, effort)?;
        all.extend(of_elastic);
        all.extend(of_steel);
        least = least.min(one).min(other);
        touching.extend(contact("bricks", (FullSpace, steel), elements, effort)?);
        touching.extend(contact("quadrilaterals", (PlaneStrain, steel), elements, effort)?);
    }
    let verdict = if least >= RATE { "met" } else { "missed" };
    Ok(Some(format!(
        "## Finite elements\n\nA cube or square of steel with waves along all axes, as elements and as particles (FLIP, MUSL, linear \
         shape functions) of the same law value, linear elastic or Johnson-Cook with heat, bulk viscosity and Mie-Grueneisen: as many \
         particles as bricks or quadrilaterals, at the distance of an edge. One point means with springs against hourglass modes. \
         Million updates of elements or particles a second; on one thread by its processor time, on two by the clock. Bytes are those \
         of the solver with all scratch, over elements or particles and over nodes. The slowest one-point bricks on one thread make \
         {least:.1} M/s; {RATE:.0} are asked of all: {verdict}.\n\n{}\n\
         Two blocks of one-point elements of Johnson-Cook steel meet head-on, half an edge beside each other, with friction; without \
         contact they pass through each other. Contact's share is that of a step with it; {:.0} % are asked.\n\n{}",
        table(
            ["law", "elements", "number", "one thread", "asked", "two threads", "bytes each", "bytes a node"],
            &all
        ),
        100.0 * SHARE,
        table(["elements", "number", "threads", "time on / off", "share", "asked"], &touching),
    )))
}
