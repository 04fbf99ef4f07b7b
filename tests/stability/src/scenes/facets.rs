//! Contact of coarse facets with fine particles.

use coupling::Elements;
use fem::{Fem, MeshBody};
use impactite_geometry::structured::box_mesh;
use impactite_geometry::{Cuboid, Filling, fill};
use mpm_contact::{Frictionless, Pairs, SeparatingPlane, SurfaceDistance};
use mpm_core::{
    BlockGrid, Boundary, Flip, GridContact, Linear, Method, Mpm, Musl, PlaneStrain, Side, TimeControl,
};
use mpm_materials::{Fluid, MieGruneisen};
use verification::problems::rubber;

use crate::stage::{cells, text};
use crate::verdict::{Limit, Measured, Scene, Size, Stop};

#[derive(Clone, Copy, PartialEq)]
enum Way {
    Grid,
    Surface,
}

/// Edge lengths of the block of elements, in cells of the grid.
const BLOCK: [usize; 2] = [16, 8];

/// Build a stiff block of elements of `size` cells that falls into a pool of particles between walls.
fn pool(way: Way, size: usize) -> Result<Mpm<2>, String> {
    let lattice = cells()?;
    let low = [16.0, 12.05];
    let high = [low[0] + BLOCK[0] as f64, low[1] + BLOCK[1] as f64];
    let mesh = box_mesh(&Cuboid::new(low, high).map_err(text)?, BLOCK.map(|n| n / size)).map_err(text)?;
    let mut fem = Fem::new(PlaneStrain);
    let body = MeshBody::new("block", mesh, rubber(4.0, 4e4, 0.3)?).moving(|_| [0.0, -1.0]);
    fem.add(body).map_err(text)?;
    let client = match way {
        Way::Grid => Elements::on_the_grid(fem),
        Way::Surface => Elements::by_surface(fem, Frictionless),
    };
    let surfaces = SurfaceDistance::new(SeparatingPlane, 0.0).map_err(text)?.locally();
    let contact = GridContact::new(surfaces, Pairs::new(Frictionless));
    let method = Method::new(Linear, Flip, Musl, PlaneStrain);
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    // Sound speed of 10 m/s.
    let water = Fluid::new(MieGruneisen::new(1.0, 10.0, 1.5, 2.0).map_err(text)?);
    let water = water.with_bulk_viscosity(0.06, 1.5).map_err(text)?;
    let filled = Cuboid::new([0.0; 2], [48.0, 12.0]).map_err(text)?;
    let seeds = fill(&filled, &lattice, 2, &Filling::new()).map_err(text)?;
    mpm.add("water", water, &seeds, |_| [0.0; 2]).map_err(text)?;
    mpm.add_client(client.map_err(text)?).map_err(text)?;
    for (axis, at, side) in [(0, 0.0, Side::Above), (0, 48.0, Side::Below), (1, 0.0, Side::Above)] {
        mpm.bound(Boundary::Symmetry { axis, at, side }).map_err(text)?;
    }
    mpm.set_time_control(TimeControl::Courant { factor: 0.4, growth: 1.1 }).map_err(text)?;
    Ok(mpm)
}

/// Penetration depth of a point in a quadrilateral with these corners, counter-clockwise: distance to its nearest side, m; negative
/// outside.
fn depth(x: [f64; 3], corners: &[[f64; 3]]) -> f64 {
    let mut least = f64::INFINITY;
    for (k, a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        let along = [b[0] - a[0], b[1] - a[1]];
        let across = along[0] * (x[1] - a[1]) - along[1] * (x[0] - a[0]);
        least = least.min(across / along[0].hypot(along[1]));
    }
    least
}

/// Number of particles inside elements, and their largest penetration depth.
fn inside(mpm: &Mpm<2>) -> (usize, f64) {
    let elements: Vec<_> = mpm.bodies()[1].points();
    let (mut count, mut deepest) = (0, 0.0f64);
    mpm.bodies()[0].for_each(&mut |p| {
        let most = elements.iter().map(|e| depth(p.position, &e.corners)).fold(f64::NEG_INFINITY, f64::max);
        count += usize::from(most > 0.0);
        deepest = deepest.max(most);
    });
    (count, deepest)
}

/// T23: leaks of particles through coarse facets.
pub fn leaks() -> Scene {
    fn trial(way: Way, size: usize) -> impl Fn(Size) -> Result<Measured, String> {
        move |run| {
            let mut mpm = pool(way, size)?;
            let end = if run == Size::Fast { 3.0 } else { 8.0 };
            let (mut most, mut deepest, mut steps) = (0, 0.0f64, 0u64);
            while !mpm.reached(end) {
                if let Err(e) = mpm.step_towards(end) {
                    let stop = Stop { step: e.step, what: e.to_string() };
                    return Ok(Measured::new(f64::NAN, steps).stopped(Some(stop)));
                }
                steps += 1;
                if steps.is_multiple_of(10) {
                    let (count, depth) = inside(&mpm);
                    (most, deepest) = (most.max(count), deepest.max(depth));
                }
            }
            let said = format!("of {} particles; deepest {deepest:.2} cells", mpm.bodies()[0].len());
            Ok(Measured::new(most as f64, steps).since(Some(said)))
        }
    }
    let scene = Scene {
        id: "T23",
        name: "coarse facets against fine particles",
        fails: "A block of elements, 16 by 8 cells, falls into water of four particles a cell at a tenth of its wave speed. Elements on the grid act \
                at their nodes: between them, where edges are longer than cells, water flows in. Facets keep it out at any size.",
        metric: "most particles inside of elements",
        limit: Limit::AtMost(0.0),
        rows: Vec::new(),
    };
    let row = |way, size: usize| {
        let name = if way == Way::Grid { "on the grid" } else { "by surface" };
        let edges = if size == 1 { "edges of a cell".into() } else { format!("edges of {size} cells") };
        (format!("{name}, {edges}"), trial(way, size))
    };
    let scene = [2, 4, 8].into_iter().fold(scene, |scene, size| {
        let (name, trial) = row(Way::Grid, size);
        scene.fails(name, "list T23", trial)
    });
    [1, 2, 4, 8].into_iter().fold(scene, |scene, size| {
        let (name, trial) = row(Way::Surface, size);
        scene.holds(name, "list T23", trial)
    })
}
