//! Finite elements: hourglass modes of one-point integration, locking, and inverted elements.

use fem::{Fem, Hourglass, MeshBody, Technology};
use impactite_geometry::structured::box_mesh;
use impactite_geometry::{Cuboid, ElementKind, ElementMesh};
use impactite_scene::{Finding, PlaneStrain, PointKind, Solver, Stopped, TimeControl};
use verification::problems::rubber;

use super::locking::{LENGTH, THICK, frequency, shape};
use crate::stage::text;
use crate::verdict::{Limit, Measured, Scene, Size};

/// Element kind and integration technology.
#[derive(Clone, Copy)]
struct How(ElementKind, Technology);

const FREE: How = one_point(Hourglass::Stiffness(1e-9));
const SPRINGS: How = one_point(Hourglass::Stiffness(0.05));
const STIFF: How = one_point(Hourglass::Stiffness(0.5));
const DASHPOTS: How = one_point(Hourglass::Viscous(0.1));
const MEAN: How = How(ElementKind::Quad4, Technology::MeanDilatation);
const FULL: How = How(ElementKind::Quad4, Technology::Full);
const AVERAGED: How = How(ElementKind::Triangle3, Technology::AveragedVolumes);
const TRIANGLES: How = How(ElementKind::Triangle3, Technology::Full);

const fn one_point(control: Hourglass) -> How {
    How(ElementKind::Quad4, Technology::OnePoint(control))
}

impl How {
    /// Mesh a box from the origin with this number of squares per axis, or twice as many triangles.
    fn mesh(self, high: [f64; 2], counts: [usize; 2]) -> Result<ElementMesh<2>, String> {
        let squares = box_mesh(&Cuboid::new([0.0; 2], high).map_err(text)?, counts).map_err(text)?;
        match self.0 {
            ElementKind::Triangle3 => squares.split_to_triangles().map_err(text),
            _ => Ok(squares),
        }
    }

    /// Build a scene of one body with E = rho = 1.
    fn scene(
        self,
        name: &str,
        mesh: ElementMesh<2>,
        nu: f64,
        velocity: impl Fn([f64; 2]) -> [f64; 2] + Send + Sync + 'static,
    ) -> Result<Fem<2>, String> {
        let mut fem = Fem::new(PlaneStrain);
        let body = MeshBody::new(name, mesh, rubber(1.0, 1.0, nu)?).with(self.0, self.1);
        fem.add(body.moving(velocity)).map_err(text)?;
        Ok(fem)
    }
}

/// Largest displacement of the loaded node in the middle of the upper side, m, within a time, s; number of steps, and a
/// remark on hourglass energy.
fn pressed(how: How, time: f64) -> Result<(f64, u64, String), String> {
    let mut mesh = how.mesh([10.0, 5.0], [20, 10])?;
    let loaded = mesh.nodes_where(|x| (x[0] - 5.0).abs() < 1e-9 && x[1] > 4.99)[0] as usize;
    let foot = mesh.nodes_where(|x| x[1] < 1e-9);
    mesh.node_sets.insert("foot".into(), foot);
    let mut fem = how.scene("plate", mesh, 0.3, |_| [0.0; 2])?;
    fem.prescribe(0, "foot", std::sync::Arc::new(|_| [Some(0.0); 3])).map_err(text)?;
    let dt = 0.5 * fem.next_time_step();
    let mut most = 0.0f64;
    while fem.time() < time {
        let mut trial = fem.trial(dt).map_err(text)?;
        trial.body_mut(0).add_impulse(loaded, [0.0, -1e-4 * dt]);
        trial.finish().map_err(text)?;
        most = most.max(5.0 - fem.body(0).nodes()[loaded].position[1]);
    }
    let body = fem.body(0);
    let share = body.hourglass_energy() / (body.internal_energy() + body.hourglass_energy());
    let warned = fem.warnings().iter().any(|w| matches!(w.finding, Finding::Hourglass { .. }));
    let said = format!(
        "{:.2} % of the internal energy in hourglass forces, {}",
        100.0 * share,
        if warned { "warned of" } else { "not warned of" }
    );
    Ok((most, fem.clock().steps, said))
}

/// E1: point load on one node.
pub fn point_load() -> Scene {
    fn trial(how: How) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let time = 40.0;
            let ((found, steps, said), (wanted, ..)) = (pressed(how, time)?, pressed(FULL, time)?);
            Ok(Measured::new(found / wanted - 1.0, steps).since(Some(said)))
        }
    }
    Scene {
        id: "E1",
        name: "a load on one node",
        fails: "A plate of 20 by 10 elements, held below, with a sudden load on one node for eight runs of a wave through it. One point of \
                integration sees no hourglass modes: without control the elements around the node fold, and it sinks. What control \
                holds instead is in its energy, and is warned of above 5 %.",
        metric: "largest way of the node over that with full integration, less 1",
        limit: Limit::AtMost(0.5),
        rows: Vec::new(),
    }
    .fails("one point, control of 1e-9", "list T10, of elements", trial(FREE))
    .holds("one point, springs of 0.05", "own", trial(SPRINGS))
    .holds("one point, springs of 0.5", "own", trial(STIFF))
    .fails("one point, dashpots of 0.1", "they slow folds down, and hold none", trial(DASHPOTS))
    .holds("mean dilatation", "own", trial(MEAN))
    .holds("triangles, averaged volumes", "own", trial(AVERAGED))
}

/// Run the beam of T11 with elements; measure (frequency / theory)^2 by the time of a quarter of its first period.
fn swing(how: How, counts: [usize; 2], nu: f64) -> Result<(f64, u64), String> {
    let mesh = how.mesh([LENGTH as f64, THICK as f64], counts)?;
    let rest = mesh.nodes.clone();
    let mut fem = how.scene("beam", mesh, nu, |x| [0.0, 1e-5 * shape(x[0] / LENGTH as f64)])?;
    let quarter = 0.5 * std::f64::consts::PI / frequency(nu);
    let part = |fem: &Fem<2>| -> f64 {
        let all = fem.body(0).nodes().iter().zip(&rest);
        all.map(|(n, x)| n.mass * n.velocity[1] * shape(x[0] / LENGTH as f64)).sum()
    };
    let mut before = (0.0, part(&fem));
    while fem.time() < 2.5 * quarter {
        fem.step_at_most(f64::INFINITY).map_err(text)?;
        let now = (fem.time(), part(&fem));
        if now.1 <= 0.0 {
            let zero = before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1);
            return Ok(((quarter / zero).powi(2), fem.clock().steps));
        }
        before = now;
    }
    Ok((0.0, fem.clock().steps))
}

/// T11 with elements: near-incompressible bending.
pub fn beam() -> Scene {
    fn trial(how: How, nu: f64) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let (stiffness, steps) = swing(how, [LENGTH, THICK], nu)?;
            Ok(Measured::new((stiffness - 1.0).abs(), steps))
        }
    }
    const NU: f64 = 0.4999;
    Scene {
        id: "T11e",
        name: "near-incompressible bending of elements",
        fails: "The free beam of T11 of 32 by 4 squares, or of twice as many triangles, at nu = 0.4999. Where every point of integration asks its \
                volume to stay, there are more conditions than the mesh has freedom, and it is too stiff. One point asks once an element, \
                as mean dilatation does; averages over nodes ask once a node.",
        metric: "stiffness over that of theory, less 1 (by the frequency)",
        limit: Limit::AtMost(0.20),
        rows: Vec::new(),
    }
    .holds("full, nu 0.3", "control", trial(FULL, 0.3))
    .fails("full", "list T11", trial(FULL, NU))
    .fails("triangles, full", "list T11", trial(TRIANGLES, NU))
    .holds("one point, springs of 0.05", "list T11", trial(SPRINGS, NU))
    .holds("mean dilatation", "list T11", trial(MEAN, NU))
    .holds("triangles, averaged volumes", "list T11", trial(AVERAGED, NU))
}

/// T14 with elements: inverted elements.
pub fn inverted() -> Scene {
    fn trial(how: How, speed: f64) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            // Collision of two halves of a row of squares; the middle elements invert in the first step.
            let middle = 5.5;
            let halves = move |x: [f64; 2]| [if x[0] < middle { speed } else { -speed }, 0.0];
            let mut fem = how.scene("row", how.mesh([11.0, 1.0], [11, 1])?, 0.3, halves)?;
            fem.set_time_control(TimeControl::Fixed(0.3)).map_err(text)?;
            let Some(error) = (0..3).find_map(|_| fem.step_at_most(f64::INFINITY).err()) else {
                let said = Some("it did not stop".into());
                return Ok(Measured::new(0.0, 3).since(said));
            };
            let what = error.to_string();
            let named = match &error.what {
                Stopped::Point { kind: PointKind::Element, body, number, position, .. } => {
                    // Element numbers increase along the row; each square has two triangles.
                    let squares = if how.0 == ElementKind::Triangle3 { number / 2 } else { *number };
                    // Nodal averages also affect neighbour elements.
                    let beside = usize::from(matches!(how.1, Technology::AveragedVolumes));
                    body == "row" && squares.abs_diff(5) <= beside && (position[0] - middle).abs() < 0.5
                }
                _ => false,
            };
            let cause = what.contains("inside out");
            let remedy = ["eroding", "particles", "finer mesh"].iter().all(|way| what.contains(way));
            let good = named && cause && remedy && error.step == 1;
            Ok(Measured::new(f64::from(good), error.step).since(Some(what)))
        }
    }
    Scene {
        id: "T14e",
        name: "elements turned inside out",
        fails: "Two halves of a row of eleven squares run into each other with 0.9 squares a step. That in the middle gets a negative volume; what \
                goes on computes with its mirror image.",
        metric: "stops in the same step and names body, element, place, cause and remedies (1) or not (0)",
        limit: Limit::AtLeast(1.0),
        rows: Vec::new(),
    }
    .fails("control: a tenth of the speed", "control", trial(SPRINGS, 0.3))
    .holds("one point, springs of 0.05", "list T14", trial(SPRINGS, 3.0))
    .holds("mean dilatation", "list T14", trial(MEAN, 3.0))
    .holds("full", "list T14", trial(FULL, 3.0))
    .holds("triangles, averaged volumes", "list T14", trial(AVERAGED, 3.0))
    .holds("triangles, full", "list T14", trial(TRIANGLES, 3.0))
}
