//! Hooks: operations of a user in the step.

use std::sync::{Arc, Mutex};

use mpm_contact::{Frictionless, Pairs, SurfaceDistance};
use mpm_core::scene::{Archive, CheckpointError, Solver};
use mpm_core::{
    Axisymmetric, Boundary, CpGimp, Deformable, Flip, GridContact, Hook, HookError, Linear, Method, Musl,
    PlaneStrain, Side, StepView, StrainNodes, Team, TrialNodes,
};

use super::{BlockGrid, Made, Mpm, bits, block, law};

fn methods() -> [Made; 4] {
    [
        ("impact", Box::new(|l| Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(l)))),
        ("contact at rest", Box::new(|l| Mpm::new(Method::contact_at_rest(PlaneStrain), BlockGrid::new(l)))),
        ("MUSL", Box::new(|l| Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(l)))),
        (
            "GIMP, axis",
            Box::new(|l| Mpm::new(Method::new(CpGimp, Flip, Musl, Axisymmetric), BlockGrid::new(l))),
        ),
    ]
}

/// Block that moves and deforms.
fn scene(make: &Made) -> Mpm<2> {
    let (lattice, seeds) = block([0.2, 0.2], [0.8, 0.6], 0.1);
    let mut mpm = (make.1)(lattice);
    mpm.add_body(Deformable::new("block", law(), &seeds).moving(|x| [2.0 * x[1], -x[0]])).expect("a body");
    mpm
}

/// Acceleration of all nodes, m/s^2.
struct Push([f64; 2]);

impl Hook<f64, 2> for Push {
    fn name(&self) -> &str {
        "push"
    }
    fn trial(&mut self, nodes: &mut TrialNodes<2>, dt: f64) -> Result<(), HookError> {
        for n in 0..nodes.nodes().len() {
            let v = nodes.nodes()[n].velocity;
            nodes.set_velocity(n, [v[0] + dt * self.0[0], v[1] + dt * self.0[1]]);
        }
        Ok(())
    }
}

#[test]
fn velocities_set_to_what_they_are_keep_all_bits() {
    for make in methods() {
        let (mut plain, mut hooked) = (scene(&make), scene(&make));
        hooked.add_hook(Push([0.0; 2]));
        for _ in 0..40 {
            plain.step().expect("a step");
            hooked.step().expect("a step");
        }
        assert_eq!(bits(&plain), bits(&hooked), "{}", make.0);
        assert_eq!(plain.exchange().work, hooked.exchange().work);
    }
}

#[test]
fn a_push_of_all_nodes_is_a_body_force_with_its_books() {
    for make in &methods()[..3] {
        let (mut heavy, mut pushed) = (scene(make), scene(make));
        heavy.set_body_force(|_| [3.0, -9.81]);
        pushed.add_hook(Push([3.0, -9.81]));
        let before = pushed.totals();
        for _ in 0..60 {
            heavy.step().expect("a step");
            pushed.step().expect("a step");
        }
        for (a, b) in bits(&heavy).iter().zip(bits(&pushed)) {
            for d in 0..2 {
                assert!((a[d] - b[d]).abs() < 1e-9, "{}: {} and {}", make.0, a[d], b[d]);
            }
        }
        let (one, other) = (heavy.exchange(), pushed.exchange());
        let scale = pushed.totals().kinetic;
        assert!((one.work - other.work).abs() < 1e-9 * scale, "{}: {} and {}", make.0, one.work, other.work);
        let gained = pushed.totals().momentum[1] - before.momentum[1];
        assert!((gained - other.load[1]).abs() < 1e-12 * gained.abs(), "{gained} and {:?}", other.load);
    }
}

#[test]
fn held_directions_stay_and_results_are_equal_for_any_number_of_threads() {
    let mut seen = Vec::new();
    for threads in [1, 2, 3] {
        let (lattice, seeds) = block([0.0, 0.0], [0.8, 0.6], 0.05);
        let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
        mpm.set_team(Team::new(threads).expect("a team"));
        mpm.add_body(Deformable::new("block", law(), &seeds)).expect("a body");
        mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).expect("a plane");
        mpm.add_hook(Push([0.0, -100.0]));
        for _ in 0..60 {
            mpm.step().expect("a step");
        }
        let lowest = mpm.bodies()[0].points().iter().map(|p| p.position[1]).fold(f64::INFINITY, f64::min);
        assert!(lowest > 0.01, "{lowest}");
        seen.push(bits(&mpm));
    }
    assert!(seen.windows(2).all(|pair| pair[0] == pair[1]));
}

/// Masses (kg) and velocities (m/s) of the nodes.
type Nodes = Vec<(f64, [f64; 2])>;

/// Masses and velocities of the nodes at the trial and at the strain of the last step.
#[derive(Clone, Default)]
struct Velocities {
    asks: bool,
    seen: Arc<Mutex<[Nodes; 2]>>,
}

impl Hook<f64, 2> for Velocities {
    fn name(&self) -> &str {
        "velocities"
    }
    fn trial(&mut self, nodes: &mut TrialNodes<2>, _: f64) -> Result<(), HookError> {
        self.seen.lock().map_err(|_| "poisoned")?[0] =
            nodes.nodes().iter().map(|n| (n.mass, n.velocity)).collect();
        Ok(())
    }
    fn needs_strain(&self) -> bool {
        self.asks
    }
    fn strain(&mut self, nodes: &mut StrainNodes<2>, _: f64) -> Result<(), HookError> {
        self.seen.lock().map_err(|_| "poisoned")?[1] =
            nodes.nodes().iter().map(|n| (n.mass, n.velocity)).collect();
        nodes.add_work(1.0);
        Ok(())
    }
}

#[test]
fn the_velocities_of_strain_are_those_of_the_trial_or_of_the_second_map() {
    for make in methods() {
        let hook = Velocities { asks: true, ..Velocities::default() };
        let mut mpm = scene(&make);
        mpm.add_hook(hook.clone());
        for _ in 0..5 {
            mpm.step().expect("a step");
        }
        let [trial, strain] = hook.seen.lock().expect("velocities").clone();
        let momentum = |list: &[(f64, [f64; 2])]| list.iter().map(|(m, v)| m * v[0]).sum::<f64>();
        assert_eq!(trial.len(), strain.len(), "{}", make.0);
        if mpm.facts().remap {
            assert_ne!(trial, strain, "{}", make.0);
            let (own, due) = (momentum(&strain), mpm.totals().momentum[0]);
            assert!((own - due).abs() < 1e-12 * due.abs(), "{}: {own} {due}", make.0);
        } else {
            assert_eq!(trial, strain, "{}", make.0);
        }
        assert!((mpm.exchange().work - 5.0).abs() < 1e-9, "{}: {}", make.0, mpm.exchange().work);
    }
    let hook = Velocities::default();
    let mut mpm = scene(&methods()[0]);
    mpm.add_hook(hook.clone());
    mpm.step().expect("a step");
    assert!(hook.seen.lock().expect("velocities")[1].is_empty(), "not asked for");
}

/// Error at a step.
struct Fails(u64);

impl Hook<f64, 2> for Fails {
    fn name(&self) -> &str {
        "deepest point"
    }
    fn needs_nodes(&self) -> bool {
        false
    }
    fn after_step(&mut self, step: &StepView<'_, 2>) -> Result<(), HookError> {
        if step.steps == self.0 { Err("it is too deep".into()) } else { Ok(()) }
    }
}

#[test]
fn an_error_stops_the_run_with_the_name_of_the_hook() {
    let mut mpm = scene(&methods()[0]);
    mpm.add_hook(Fails(3));
    let stopped = mpm.run_until(1.0).expect_err("an error");
    assert!(stopped.to_string().contains("hook `deepest point`: it is too deep"), "{stopped}");
    assert_eq!(mpm.clock().steps, 3);
    assert_eq!(mpm.step().err(), Some(stopped));

    let mut mpm = scene(&methods()[0]);
    mpm.add_hook(Push([f64::NAN, 0.0]));
    let stopped = mpm.step().expect_err("a velocity that is none").to_string();
    assert!(stopped.contains("hook `push`: velocity") && stopped.contains("node at"), "{stopped}");
}

/// Count of steps that goes into checkpoints.
struct Counts(&'static str, Arc<Mutex<u64>>);

impl Hook<f64, 2> for Counts {
    fn name(&self) -> &str {
        self.0
    }
    fn needs_nodes(&self) -> bool {
        false
    }
    fn before_step(&mut self, step: &StepView<'_, 2>) -> Result<(), HookError> {
        let mut count = self.1.lock().map_err(|_| "poisoned")?;
        assert_eq!((step.bodies.len(), step.steps), (1, *count));
        *count += 1;
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let mut count = self.1.lock().expect("a count");
        file.word(&mut count)
    }
}

#[test]
fn hooks_go_on_in_a_resumed_run() {
    let folder = std::env::temp_dir().join(format!("hooks-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("checkpoint");
    let made = |name| {
        let count = Arc::new(Mutex::new(0));
        let mut mpm = scene(&methods()[0]);
        mpm.add_hook(Counts(name, count.clone()));
        (mpm, count)
    };
    let (mut mpm, _) = made("counts");
    for _ in 0..7 {
        mpm.step().expect("a step");
    }
    mpm.save(&path).expect("a checkpoint");
    let (mut resumed, count) = made("counts");
    resumed.resume(&path).expect("the scene");
    assert_eq!(*count.lock().expect("a count"), 7);
    resumed.step().expect("a step");
    mpm.step().expect("a step");
    assert_eq!(bits(&mpm), bits(&resumed));
    let refused = made("others").0.resume(&path).expect_err("other hooks").to_string();
    assert!(refused.contains("hooks"), "{refused}");
    let _ = std::fs::remove_dir_all(&folder);
}

#[test]
fn a_body_in_its_reference_configuration_has_no_hooks_of_its_own() {
    let (lattice, seeds) = block([0.2, 0.2], [0.8, 0.6], 0.1);
    let mut own = Mpm::new(Method::large_elastic(PlaneStrain), BlockGrid::new(lattice));
    own.add_body(Deformable::new("block", law(), &seeds)).expect("a body");
    own.add_hook(Push([0.0; 2]));
    let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    let mut mpm = Mpm::with_contact(Method::impact(PlaneStrain), BlockGrid::new(lattice), contact);
    let refused = mpm.add_total_lagrangian(own).expect_err("hooks that nothing would call").to_string();
    assert!(refused.contains("hooks"), "{refused}");
}
