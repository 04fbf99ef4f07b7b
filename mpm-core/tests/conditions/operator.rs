//! Operators through the particles: against exact gradients, their own transposes, and the forces of the step.

use std::sync::{Arc, Mutex};

use mpm_contact::{Frictionless, Pairs, SurfaceDistance};
use mpm_core::{
    Axisymmetric, BlockGrid, Boundary, CpGimp, Cpdi, Deformable, Flip, FullSpace, GridContact, Hook,
    HookError, Linear, Method, Mpm, Musl, PlaneStrain, PointOperator, Side, TrialNode, TrialNodes,
};

use super::{block, law};

/// Operator and nodes of the last step, and its size, s.
type Seen<const D: usize> = Arc<Mutex<Option<(Arc<PointOperator<D>>, Vec<TrialNode<D>>, f64)>>>;

#[derive(Clone, Default)]
struct Collect<const D: usize>(Seen<D>);

impl<const D: usize> Hook<f64, D> for Collect<D> {
    fn name(&self) -> &str {
        "collect"
    }
    fn needs_points(&self) -> bool {
        true
    }
    fn trial(&mut self, nodes: &mut TrialNodes<D>, dt: f64) -> Result<(), HookError> {
        let points = nodes.points().ok_or("no points")?;
        *self.0.lock().map_err(|_| "poisoned")? = Some((points, nodes.nodes().to_vec(), dt));
        Ok(())
    }
}

/// Operator, nodes and size of step 10 of a scene.
fn tenth<const D: usize>(mut mpm: Mpm<D>) -> (Arc<PointOperator<D>>, Vec<TrialNode<D>>, f64) {
    let collect = Collect::default();
    mpm.add_hook(collect.clone());
    for _ in 0..10 {
        mpm.step().expect("a step");
    }
    let seen = collect.0.lock().expect("a lock").take();
    seen.expect("a trial")
}

fn empty_scenes(lattice: mpm_core::geometry::Lattice<2>) -> Vec<(&'static str, Mpm<2>)> {
    let grid = || BlockGrid::new(lattice);
    vec![
        ("impact", Mpm::new(Method::impact(PlaneStrain), grid())),
        ("hats", Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), grid())),
        ("GIMP, axis", Mpm::new(Method::new(CpGimp, Flip, Musl, Axisymmetric), grid())),
        ("CPDI", Mpm::new(Method::new(Cpdi, Flip, Musl, PlaneStrain).compiled(), grid())),
        ("total Lagrangian", Mpm::new(Method::large_elastic(PlaneStrain), grid())),
    ]
}

/// Block off the lattice that moves and deforms.
fn scenes() -> Vec<(&'static str, Mpm<2>)> {
    let (lattice, seeds) = block([0.23, 0.21], [0.83, 0.61], 0.1);
    let mut scenes = empty_scenes(lattice);
    for (_, mpm) in &mut scenes {
        mpm.add_body(Deformable::new("block", law(), &seeds).moving(|x| [2.0 * x[1], -x[0]]))
            .expect("a body");
    }
    scenes
}

/// Numbers from -1 to 1.
fn noise(n: usize) -> f64 {
    2.0 * ((n as f64 + 1.0) * 0.754_877_666_246_692_7).fract() - 1.0
}

#[test]
fn gradients_of_affine_fields_are_exact() {
    let a = [[0.3, -1.1], [0.7, 0.4]];
    for (name, mpm) in scenes() {
        let axis = name.ends_with("axis");
        let (operator, nodes, _) = tenth(mpm);
        // About the axis a velocity is proportional to the radius.
        let u: Vec<[f64; 2]> = nodes
            .iter()
            .map(|node| {
                let x = node.position;
                let shear = if axis { 0.0 } else { a[0][1] * x[1] };
                [a[0][0] * x[0] + shear, a[1][0] * x[0] + a[1][1] * x[1]]
            })
            .collect();
        assert_eq!(operator.nodes(), nodes.len());
        assert!(operator.points().len() > 90, "{name}: {} points", operator.points().len());
        for (l, divergence) in operator.gradient(&u).iter().zip(operator.divergence(&u)) {
            let shear = if axis { 0.0 } else { a[0][1] };
            let hoop = if axis { a[0][0] } else { 0.0 };
            let exact = [[a[0][0], shear, 0.0], [a[1][0], a[1][1], 0.0], [0.0, 0.0, hoop]];
            for c in 0..3 {
                for d in 0..3 {
                    assert!((l[c][d] - exact[c][d]).abs() < 1e-11, "{name}: {l:?} and {exact:?}");
                }
            }
            assert!((divergence - a[0][0] - a[1][1] - hoop).abs() < 1e-11, "{name}: {divergence}");
        }
    }
}

#[test]
fn transposes_are_transposes() {
    for (name, mpm) in scenes() {
        let (operator, nodes, _) = tenth(mpm);
        let u: Vec<[f64; 2]> = (0..nodes.len()).map(|n| [noise(2 * n), noise(2 * n + 1)]).collect();
        let s: Vec<[[f64; 3]; 3]> = (0..operator.points().len())
            .map(|p| std::array::from_fn(|c| std::array::from_fn(|d| noise(9 * p + 3 * c + d))))
            .collect();
        let f: Vec<[f64; 2]> = s.iter().map(|s| [s[0][0], s[1][1]]).collect();
        let (mut y, mut z) = (vec![[0.0; 2]; nodes.len()], vec![[0.0; 2]; nodes.len()]);
        operator.transposed_gradient(&s, &mut y);
        operator.spread(&f, &mut z);
        let at_nodes = |y: &[[f64; 2]]| u.iter().zip(y).map(|(u, y)| u[0] * y[0] + u[1] * y[1]).sum::<f64>();
        let power: f64 = operator
            .gradient(&u)
            .iter()
            .zip(&s)
            .map(|(l, s)| (0..9).map(|n| l[n / 3][n % 3] * s[n / 3][n % 3]).sum::<f64>())
            .sum();
        let work: f64 = operator.interpolate(&u).iter().zip(&f).map(|(v, f)| v[0] * f[0] + v[1] * f[1]).sum();
        assert!((at_nodes(&y) - power).abs() < 1e-10 * power.abs().max(1.0), "{name}: {power}");
        assert!((at_nodes(&z) - work).abs() < 1e-11 * work.abs().max(1.0), "{name}: {work}");

        // The product with the stiffness, its symmetry, and its diagonal.
        let law = |p: usize, l: &[[f64; 3]; 3]| -> [[f64; 3]; 3] {
            let volume = operator.points()[p].volume;
            std::array::from_fn(|c| std::array::from_fn(|d| 3.0 * volume * (l[c][d] + l[d][c])))
        };
        let diagonal = operator.diagonal(law);
        for (n, c) in [(0, 0), (nodes.len() / 2, 1), (nodes.len() - 1, 0)] {
            let mut unit = vec![[0.0; 2]; nodes.len()];
            unit[n][c] = 1.0;
            let (mut column, mut row) = (vec![[0.0; 2]; nodes.len()], vec![[0.0; 2]; nodes.len()]);
            operator.stiffness(law, &unit, &mut column);
            operator.stiffness(law, &u, &mut row);
            assert!((row[n][c] - at_nodes(&column)).abs() < 1e-10, "{name}: symmetry");
            assert!((column[n][c] - diagonal[n][c]).abs() < 1e-12, "{name}: diagonal");
            assert!(diagonal[n][c] > 0.0);
        }
    }
}

/// Mass times acceleration of each node, N, against the force of the stresses of the points, and masses.
fn assert_forces_of_the_step<const D: usize>(name: &str, mpm: Mpm<D>) {
    let (operator, nodes, dt) = tenth(mpm);
    let stresses: Vec<_> = operator.points().iter().map(|p| p.stress).collect();
    let mut force = vec![[0.0; D]; nodes.len()];
    operator.transposed_gradient(&stresses, &mut force);
    let largest = force.iter().flatten().fold(0.0, |m: f64, f| m.max(f.abs()));
    assert!(largest > 1.0, "{name}: forces {largest} N");
    for ((node, force), mass) in nodes.iter().zip(&force).zip(operator.mass()) {
        assert!((mass - node.mass).abs() < 1e-11 * node.mass.max(1.0), "{name}: mass {mass}");
        for d in (0..D).filter(|d| !node.held[*d]) {
            let due = node.mass * (node.velocity[d] - node.start[d]) / dt;
            let found = -force[d];
            assert!(
                (found - due).abs() < 1e-8 * largest,
                "{name}: {found} and {due} N at {:?}",
                node.position
            );
        }
    }
}

#[test]
fn stresses_give_the_forces_of_the_step() {
    for (name, mpm) in scenes() {
        assert_forces_of_the_step(name, mpm);
    }
    // In space, and two bodies with velocity fields of their own.
    let (lattice, seeds) = block([0.23, 0.21, 0.27], [0.63, 0.61, 0.57], 0.1);
    let mut mpm = Mpm::new(Method::impact(FullSpace), BlockGrid::new(lattice));
    let moving = |x: [f64; 3]| [x[1], -2.0 * x[2], x[0]];
    mpm.add_body(Deformable::new("block", law(), &seeds).moving(moving)).expect("a body");
    assert_forces_of_the_step("space", mpm);
}

#[test]
fn nodes_at_a_plane_of_symmetry_stand_for_their_images() {
    let (lattice, seeds) = block([0.2, 0.0], [0.8, 0.4], 0.1);
    for (name, mut mpm) in empty_scenes(lattice) {
        mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).expect("a plane");
        mpm.add_body(Deformable::new("block", law(), &seeds).moving(|x| [x[0], -2.0 * x[1]]))
            .expect("a body");
        let (operator, nodes, _) = tenth(mpm);
        let u: Vec<[f64; 2]> = nodes.iter().map(|n| [0.5 * n.position[0], -3.0 * n.position[1]]).collect();
        for l in operator.gradient(&u) {
            assert!((l[0][0] - 0.5).abs() < 1e-11 && (l[1][1] + 3.0).abs() < 1e-11, "{name}: {l:?}");
        }
    }
}

#[test]
fn each_body_has_the_nodes_of_its_own_field() {
    let (lattice, left) = block([0.2, 0.2], [0.5, 0.5], 0.1);
    let (_, right) = block([0.5, 0.2], [0.8, 0.5], 0.1);
    let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    let mut mpm = Mpm::with_contact(Method::impact(PlaneStrain), BlockGrid::new(lattice), contact);
    mpm.add_body(Deformable::new("left", law(), &left)).expect("a body");
    mpm.add_body(Deformable::new("right", law(), &right)).expect("a body");
    let (operator, nodes, _) = tenth(mpm);
    for (p, point) in operator.points().iter().enumerate() {
        assert!(operator.weights(p).iter().all(|w| nodes[w.node].body == Some(point.body)));
        let sum: f64 = operator.weights(p).iter().map(|w| w.value).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }
}
