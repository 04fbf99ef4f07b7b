//! Checkpoint and restart: a resumed run continues bit for bit; checkpoints that cannot be resumed are refused.

use std::path::PathBuf;

use impactite_tests::compare::fast;
use impactite_tests::scene::{self, lattice, metal, rubber, wave_speed};
use mpm_core::{
    Apic, BlockGrid, CheckpointError, Cpdi2, Deformable, DenseGrid, Flip, FullSpace, IntoKernels, Linear,
    Method, Mpm, Musl, PlaneStrain, QuadraticBSpline, Splitting, Team, TimeControl, Usf, Usl,
};
use mpm_materials::{Constitutive, Stretching};

const STEPS: usize = 25;

type Spline = Method<QuadraticBSpline, Apic, Usl, PlaneStrain>;

/// Temporary file of one test, deleted on drop.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        Scratch(std::env::temp_dir().join(format!("impactite-{}-{name}", std::process::id())))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Return all particles with all bits.
fn seen<const D: usize>(mpm: &Mpm<D>) -> String {
    let all: Vec<_> = mpm.bodies().iter().map(|b| b.points()).collect();
    format!("{} {:?} {all:?}", mpm.steps(), mpm.time())
}

/// Return all results of a run.
fn told<const D: usize>(mpm: &Mpm<D>) -> String {
    let splits: Vec<_> = mpm.bodies().iter().map(|b| b.division().map(|b| b.splits())).collect();
    format!("{} {:?} {:?} {splits:?} {}", seen(mpm), mpm.totals(), mpm.exchange(), mpm.stops())
}

fn advance<const D: usize>(mpm: &mut Mpm<D>) {
    for _ in 0..STEPS {
        mpm.step().expect("step");
    }
}

/// Compare three runs of the scene: uninterrupted, continued after saving, and resumed by another scene with two
/// threads.
fn continues<const D: usize>(name: &str, scene: impl Fn() -> Mpm<D>) {
    let file = Scratch::new(name);
    let mut whole = scene();
    advance(&mut whole);
    advance(&mut whole);
    let mut saved = scene();
    advance(&mut saved);
    saved.save(&file.0).expect("checkpoint");
    let mut resumed = scene().resumed(&file.0).expect("the scene");
    assert!(told(&saved) == told(&resumed), "{name}: not as it was saved");
    resumed.set_team(Team::new(2).expect("threads"));
    advance(&mut saved);
    advance(&mut resumed);
    assert!(told(&whole) == told(&saved), "{name}: saving changes what follows");
    assert!(told(&whole) == told(&resumed), "{name}: resumed it goes elsewhere");
}

#[test]
fn methods() {
    fn check<const D: usize, M: IntoKernels<f64, D> + Copy>(name: &str, method: M) {
        let scene = scene::flow::<D>();
        continues(name, || fast(method, BlockGrid::new(scene.lattice), &scene, &rubber()));
    }
    check("usf", Method::new(Linear, Flip, Usf, PlaneStrain).compiled());
    check("space", Method::new(Linear, Flip, Musl, FullSpace));
    check("cpdi", Method::new(Cpdi2, Flip, Usl, PlaneStrain).compiled());
    check("total", Method::new(Linear, Flip, Usl, PlaneStrain).total_lagrangian().compiled());
}

/// Walls, gravity, Courant time steps and kinetic damping.
#[test]
fn surroundings() {
    fn check<M: IntoKernels<f64, 2> + Copy>(name: &str, method: M, damped: bool) {
        let scene = scene::bar::<2>();
        continues(name, || {
            let mut mpm = fast(method, BlockGrid::new(scene.lattice), &scene, &rubber());
            mpm.set_time_control(TimeControl::Courant { factor: 0.3, growth: 1.02 }).expect("control");
            mpm.set_kinetic_damping(damped).expect("damping");
            if damped {
                mpm.set_null_space_filter(7).expect("filter");
                let bound = TimeControl::Gershgorin { factor: 0.8, growth: 1.02, every: 10 };
                mpm.set_time_control(bound).expect("control");
            }
            mpm
        });
    }
    check("affine", Spline::default(), false);
    check("damped", Method::new(Linear, Flip, Musl, PlaneStrain), true);
}

/// A checkpoint of one grid resumes on another grid.
#[test]
fn on_another_grid() {
    let (file, scene) = (Scratch::new("grid"), scene::bar::<2>());
    let mut sparse = fast(Spline::default(), BlockGrid::new(scene.lattice), &scene, &rubber());
    advance(&mut sparse);
    sparse.save(&file.0).expect("checkpoint");
    let grid = DenseGrid::new(scene.lattice, [-25; 2], [50; 2]).expect("box");
    let mut dense = fast(Spline::default(), grid, &scene, &rubber()).resumed(&file.0).expect("the scene");
    advance(&mut sparse);
    advance(&mut dense);
    assert!(seen(&sparse) == seen(&dense));
}

/// Split particles: more of them than initial seeds.
#[test]
fn splitting() {
    let scene = || {
        let mut mpm = Mpm::new(Spline::default(), BlockGrid::new(lattice()));
        let seeds = scene::block(&lattice(), [2; 2], [4; 2], 2, 0.0);
        let splitting = Splitting::at(1.05).expect("stretch");
        let speed = wave_speed();
        let apart = |x: [f64; 2]| [0.5 * speed * x[0], 0.0];
        let strip = Deformable::new("strip", Stretching::new(rubber()).compiled(), &seeds).moving(apart);
        mpm.add_body(strip.with_splitting(splitting)).expect("body");
        mpm
    };
    let mut started = scene();
    advance(&mut started);
    assert!(started.bodies()[0].division().expect("particles").splits().cuts > 0, "nothing was split");
    continues("splitting", scene);
}

fn refusal(scene: Mpm<2>, file: &Scratch) -> CheckpointError {
    match scene.resumed(&file.0) {
        Ok(_) => panic!("resumed"),
        Err(error) => error,
    }
}

fn block(law_of_metal: bool, name: &str) -> Mpm<2> {
    let mut mpm = Mpm::new(Spline::default(), BlockGrid::new(lattice()));
    let seeds = scene::block(&lattice(), [0; 2], [3; 2], 2, 0.2);
    let still = |_| [0.1, 0.0];
    if law_of_metal {
        mpm.add(name, metal(), &seeds, still).expect("body");
    } else {
        mpm.add(name, rubber(), &seeds, still).expect("body");
    }
    mpm
}

#[test]
fn another_scene_is_refused() {
    let file = Scratch::new("other");
    let mut mpm = block(false, "block");
    advance(&mut mpm);
    mpm.save(&file.0).expect("checkpoint");
    assert!(block(false, "block").resumed(&file.0).is_ok());

    let message = refusal(block(false, "brick"), &file).to_string();
    assert!(message.contains("name of body 0 is `block` there and `brick` here"), "{message}");
    let mut fine = Mpm::new(Spline::default(), BlockGrid::new(lattice()));
    let seeds = scene::block(&lattice(), [0; 2], [3; 2], 3, 0.2);
    fine.add("block", rubber(), &seeds, |_| [0.1, 0.0]).expect("body");
    let message = refusal(fine, &file).to_string();
    assert!(message.contains("size of particles of body `block`"), "{message}");
    let message = refusal(block(true, "block"), &file).to_string();
    assert!(message.contains("law of body `block`"), "{message}");
    let mut two = block(false, "block");
    two.add("more", rubber(), &scene::block(&lattice(), [9; 2], [2; 2], 2, 0.0), |_| [0.0; 2]).expect("body");
    let message = refusal(two, &file).to_string();
    assert!(message.contains("number of bodies is `1` there and `2` here"), "{message}");

    let hats = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice()));
    let message = hats.resumed(&file.0).err().expect("refused").to_string();
    assert!(message.contains("method is"), "{message}");
    let mut small = Mpm::new(Spline::default(), DenseGrid::new(lattice(), [-1; 2], [5; 2]).expect("box"));
    let seeds = scene::block(&lattice(), [0; 2], [3; 2], 2, 0.2);
    small.add("block", rubber(), &seeds, |_| [0.0; 2]).expect("body");
    let mut far = block(false, "block");
    far.run_until(6.0).expect("run");
    far.save(&file.0).expect("checkpoint");
    assert!(matches!(small.resumed(&file.0), Err(CheckpointError::NoRoom(_))));
}

#[test]
fn a_damaged_file_is_refused() {
    let file = Scratch::new("damaged");
    let mut mpm = block(false, "block");
    advance(&mut mpm);
    mpm.save(&file.0).expect("checkpoint");
    let whole = std::fs::read(&file.0).expect("file");
    let damaged = |bytes: &[u8]| {
        std::fs::write(&file.0, bytes).expect("file");
        refusal(block(false, "block"), &file)
    };
    for place in (30..whole.len()).step_by(whole.len() / 23) {
        let mut bytes = whole.clone();
        bytes[place] ^= 0x10;
        let error = damaged(&bytes);
        let named = matches!(
            error,
            CheckpointError::Damaged { .. } | CheckpointError::OtherScene { .. } | CheckpointError::NoRoom(_)
        );
        assert!(named, "byte {place}: {error}");
    }
    for end in [0, 5, whole.len() / 2, whole.len() - 4] {
        let error = damaged(&whole[..end]);
        assert!(matches!(error, CheckpointError::Damaged { .. }), "cut at {end}: {error}");
    }
    let longer = [&whole[..], b"more"].concat();
    assert!(matches!(damaged(&longer), CheckpointError::Damaged { .. }));
    assert!(matches!(damaged(b"a letter, say"), CheckpointError::Damaged { .. }));
    std::fs::remove_file(&file.0).expect("file");
    assert!(matches!(refusal(block(false, "block"), &file), CheckpointError::File(_)));
}

/// A run stopped by an error has no state to save.
#[test]
fn a_stopped_run_is_not_saved() {
    let file = Scratch::new("stopped");
    let mut mpm = Mpm::new(Spline::default(), DenseGrid::new(lattice(), [-1; 2], [5; 2]).expect("box"));
    let seeds = scene::block(&lattice(), [0; 2], [3; 2], 2, 0.2);
    mpm.add("block", rubber(), &seeds, |_| [1.0, 0.0]).expect("body");
    mpm.run_until(10.0).expect_err("it leaves the grid");
    assert!(matches!(mpm.save(&file.0), Err(CheckpointError::Stopped(_))));
    assert!(!file.0.exists());
}
