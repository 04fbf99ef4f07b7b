//! Invalid numbers: refused on input or in the step in which they arise, with their name; no run hangs.

use crate::common::{H, WAVE, ball, build, cuboid, lattice, plane, rubber};
use mpm_contact::{Coulomb, Frictionless, Pairs, SurfaceDistance};
use mpm_core::geometry::{Cuboid, Seeds};
use mpm_core::{
    BlockGrid, Boundary, CheckpointError, Flip, GridContact, Linear, Method, Mpm, Musl, OneField,
    PlaneStrain, Rigid, Side, Stopped, TimeControl, Traction, Twist,
};
use mpm_materials::{Moduli, NeoHookean};
use std::sync::Arc;

fn contact() -> GridContact<SurfaceDistance, f64> {
    GridContact::new(SurfaceDistance::default(), Pairs::new(Frictionless))
}

fn with_disc(rigid: &Rigid<2>) -> Result<Mpm<2>, String> {
    let mut mpm = Mpm::with_contact(plane(), BlockGrid::new(lattice()), contact());
    mpm.set_time_control(TimeControl::Fixed(1e-3)).expect("control");
    mpm.add_rigid("disc", rigid, &ball([0.3, 0.3], 0.15)).map_err(|e| e.to_string())?;
    mpm.add("block", rubber(), &cuboid([0.4, 0.0], [0.6, 0.2]), |_| [0.0; 2]).expect("block");
    Ok(mpm)
}

fn ends_with(mpm: &mut Mpm<2>, words: &[&str]) {
    let stopped = (0..400).find_map(|_| mpm.step().err()).expect("it must stop").to_string();
    assert!(words.iter().all(|w| stopped.contains(w)), "{stopped}");
}

#[test]
fn rigid_bodies_that_move_as_none_can() {
    let free = |density| Rigid::<2>::free(density).expect("rigid");
    let refused = with_disc(&free(1e-310)).err().expect("a density");
    assert!(refused.contains("`disc`: density"), "{refused}");
    // A body this light is moved by any contact, or stops the run, which used to hang.
    let mut light = with_disc(&free(1e-300).with_velocity([5.0, -5.0])).expect("normal numbers");
    drop((0..400).find_map(|_| light.step().err()));
    let refused = with_disc(&free(1e3).with_spin([0.0, 0.0, 1e300])).err().expect("a spin");
    assert!(refused.contains("velocity or spin"), "{refused}");
    let mut fast = with_disc(&free(1e3).with_spin([0.0, 0.0, 1e10])).expect("finite");
    ends_with(&mut fast, &["rigid body `disc`: turn", "below pi"]);
    for bad in [f64::NAN, f64::INFINITY] {
        let mut mpm = with_disc(&free(1e3)).expect("scene");
        mpm.set_body_force(move |t| [0.0, if t > 0.01 { bad } else { -1.0 }]);
        ends_with(&mut mpm, &["body force", "must be finite"]);
        let mut mpm = with_disc(&free(1e3)).expect("scene");
        let region = Arc::new(Cuboid::new([0.0; 2], [0.6, 0.6]).expect("region"));
        let velocity = Arc::new(move |t: f64| [None, Some(if t > 0.01 { bad } else { 0.0 }), None]);
        mpm.bound(Boundary::Prescribed { region, velocity }).expect("boundary");
        ends_with(&mut mpm, &["velocity prescribed by boundary 0", "must be finite"]);
        let turns = Rigid::prescribed(1e3, move |t| Twist {
            velocity: [0.0; 2],
            spin: [0.0, 0.0, if t > 0.01 { bad } else { 1.0 }],
        });
        ends_with(&mut with_disc(&turns.expect("rigid")).expect("scene"), &["rigid body `disc`: spin"]);
    }
}

/// A checkpoint with altered bits is refused or continues; it neither hangs nor panics.
#[test]
fn altered_checkpoints() {
    let file = std::env::temp_dir().join(format!("impactite-{}-altered", std::process::id()));
    let scene = || {
        with_disc(&Rigid::free(1e3).expect("rigid").with_velocity([1.0, -1.0]).with_spin([0.0, 0.0, 3.0]))
            .expect("scene")
    };
    let mut mpm = scene();
    for _ in 0..20 {
        mpm.step().expect("step");
    }
    mpm.save(&file).expect("checkpoint");
    let gz = std::fs::read(&file).expect("file");
    // The words are stored uncompressed in blocks of gzip, whose checksum detects alterations.
    let mut refused = 0;
    for n in 0..200 {
        let mut bytes = gz.clone();
        let at = 20 + n * (bytes.len() - 40) / 200;
        bytes[at] ^= 1 << (n % 8);
        std::fs::write(&file, &bytes).expect("file");
        match scene().resumed(&file) {
            Ok(mut mpm) => drop(mpm.run_until(mpm.time() + 0.01)),
            Err(_) => refused += 1,
        }
    }
    std::fs::remove_file(&file).expect("file");
    assert_eq!(refused, 200);
}

#[test]
fn clocks() {
    let scene = || build(plane(), OneField, &vec![(ball([0.3, 0.3], 0.15), [0.1, 0.0])]);
    let mut mpm = scene();
    for end in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0] {
        assert!(matches!(mpm.run_until(end).expect_err("no end").what, Stopped::Clock { .. }), "{end}");
        assert!(matches!(mpm.step_towards(end).expect_err("no end").what, Stopped::Clock { .. }), "{end}");
    }
    for left in [f64::NAN, 0.0, -1.0, f64::NEG_INFINITY] {
        let told = mpm.step_at_most(left).expect_err("no step").to_string();
        assert!(told.contains("left") && told.contains("positive"), "{told}");
    }
    assert_eq!((mpm.steps(), mpm.time()), (0, 0.0));
    mpm.run_until(0.01).expect("none of it stopped the run");
    assert_eq!(mpm.time(), 0.01);
    let steps = mpm.steps();
    mpm.run_until(0.01).expect("there");
    assert!(
        mpm.step_towards(0.01).is_err() && mpm.step_towards(0.005).is_err() && mpm.run_until(0.005).is_err()
    );
    assert_eq!(mpm.steps(), steps);
    // Clocks that start before zero, and far from it.
    for start in [-0.02, 1e6] {
        let mut mpm = scene();
        mpm.set_time(start).expect("clock");
        mpm.run_until(start + 0.01).expect("run");
        assert_eq!(mpm.time(), start + 0.01);
        assert!(
            (mpm.steps() as f64 / steps as f64 - 1.0).abs() < 0.02,
            "{} steps from {start} s",
            mpm.steps()
        );
    }
    let mut mpm = scene();
    mpm.set_time(1e13).expect("clock");
    let told = mpm.run_until(1e13 + 1.0).expect_err("a step that is lost").to_string();
    assert!(told.contains("time step") && told.contains("move the clock"), "{told}");
    let told = Mpm::new(plane(), BlockGrid::new(lattice())).step().expect_err("nothing there").to_string();
    assert!(told.contains("no body"), "{told}");
}

#[test]
fn names_and_places() {
    let mut mpm = build(plane(), contact(), &vec![(ball([0.3, 0.3], 0.15), [0.0; 2])]);
    let seeds = ball([0.9, 0.3], 0.15);
    for name in ["", "  ", "body 0"] {
        let told = mpm.add(name, rubber(), &seeds, |_| [0.0; 2]).expect_err("a name").to_string();
        assert!(told.contains("body name") && told.contains(name), "{told}");
        let rigid = Rigid::free(1e3).expect("rigid");
        assert!(mpm.add_rigid(name, &rigid, &seeds).is_err());
    }
    assert_eq!(mpm.bodies().len(), 1);
    let plane_at = |at| Boundary::Symmetry { axis: 0, at, side: Side::Above };
    let told = mpm.bound(plane_at(6.0 * H)).expect_err("half of it is behind").to_string();
    assert!(
        told.contains("`body 0`: particle ") && told.contains("behind the plane of symmetry on axis 0"),
        "{told}"
    );
    mpm.bound(plane_at(3.0 * H)).expect("all of it is in front");
    let behind: Seeds<2> = ball([-0.3, 0.3], 0.15);
    let told = mpm.add("other", rubber(), &behind, |_| [0.0; 2]).expect_err("behind").to_string();
    assert!(told.contains("`other`: particle 0 is"), "{told}");
    let rigid = Rigid::prescribed(1e3, |_| Twist::along([0.0; 2])).expect("rigid");
    assert!(mpm.add_rigid("other", &rigid, &behind).is_err());
}

/// A checkpoint is accepted by its own scene, and refused by a scene with another constant, which the error names.
#[test]
fn checkpoints_of_other_scenes() {
    let file = std::env::temp_dir().join(format!("impactite-{}-constants", std::process::id()));
    #[derive(Clone, Copy)]
    struct Scene {
        young: f64,
        friction: f64,
        weight: f64,
        wall: f64,
        pull: f64,
        swing: f64,
        damping: f64,
    }
    let scene = |s: Scene| {
        let laws = Pairs::new(Coulomb::new(s.friction).expect("law"));
        let contact = GridContact::new(SurfaceDistance::default(), laws);
        let method = Method::new(Linear, Flip, Musl, PlaneStrain);
        let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice()), contact);
        let law = NeoHookean::new(1000.0, Moduli::young_poisson(s.young, 0.3).expect("moduli")).expect("law");
        let seeds = cuboid([0.3, 0.1], [0.5, 0.3]);
        let region = Arc::new(Cuboid::new([0.3, 0.275], [0.5, 0.3]).expect("region"));
        let traction =
            Traction { region, axis: 1, history: Arc::new(move |_| [0.0, s.pull]), revolved: false };
        mpm.add_body(mpm_core::Deformable::new("block", law, &seeds).with_traction(traction)).expect("block");
        let swing = Rigid::prescribed(1e3, move |t| Twist::along([s.swing * t, 0.0])).expect("rigid");
        mpm.add_rigid("plate", &swing, &cuboid([0.0, -0.1], [1.0, 0.1])).expect("plate");
        mpm.set_body_force(move |_| [0.0, s.weight]);
        mpm.set_local_damping(s.damping).expect("damping");
        mpm.bound(Boundary::Wall { axis: 0, at: s.wall, side: Side::Above, velocity: 0.0 }).expect("wall");
        mpm
    };
    let one =
        Scene { young: 1e6, friction: 0.2, weight: -9.81, wall: 0.2, pull: 10.0, swing: 1.0, damping: 0.0 };
    let mut mpm = scene(one);
    mpm.run_until(20.0 * H / WAVE).expect("run");
    mpm.save(&file).expect("checkpoint");
    scene(one).resumed(&file).expect("the same");
    let others = [
        (Scene { young: 1.1e6, ..one }, "constants of the law of body `block`"),
        (Scene { friction: 0.3, ..one }, "contact"),
        (Scene { weight: -9.82, ..one }, "body force"),
        (Scene { wall: 0.25, ..one }, "boundary 0"),
        (Scene { pull: 11.0, ..one }, "loads of body `block`"),
        (Scene { swing: 2.0, ..one }, "prescribed motion of body `plate`"),
        (Scene { damping: 0.1, ..one }, "local damping"),
    ];
    for (other, what) in others {
        let Err(error) = scene(other).resumed(&file) else { panic!("{what} is not compared") };
        let CheckpointError::OtherScene { what: named, saved, here } = error else { panic!("{error}") };
        assert!(named.contains(what) && saved != here, "{named} for {what}: {saved}, {here}");
    }
    std::fs::remove_file(&file).expect("file");
}

/// Critical numbers, drawn at random for every input of a scene: it is refused, makes steps, or stops with an error.
#[test]
fn any_numbers() {
    const DRAWN: [f64; 16] = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        0.0,
        -0.0,
        -1.0,
        1.0,
        0.3,
        1e-310,
        1e-300,
        1e-30,
        1e10,
        1e30,
        1e300,
        -1e300,
        f64::MAX,
    ];
    // splitmix64.
    let mut state = 34u64;
    let mut draw = |sane: f64| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        // Mostly valid numbers, so that invalid ones reach all stages.
        if z.is_multiple_of(4) { DRAWN[(z >> 32) as usize % DRAWN.len()] } else { sane }
    };
    let (mut refused, mut stopped, mut ran) = (0, 0, 0);
    for _ in 0..2000 {
        let density = draw(1e3);
        let motion = [draw(1.0), draw(-1.0), draw(3.0)];
        let about = [draw(0.3), draw(0.3)];
        let prescribed = draw(1.0) > 0.5;
        let (weight, wall, wall_speed, region_speed) = (draw(-10.0), draw(0.0), draw(0.1), draw(0.2));
        let (factor, growth, damping) = (draw(0.5), draw(1.1), draw(0.1));
        let (friction, start, length, left) = (draw(0.3), draw(0.0), draw(1e-2), draw(1e-3));
        let scene = || -> Result<Mpm<2>, String> {
            let text = |e: &dyn std::fmt::Display| e.to_string();
            let laws = Pairs::new(Coulomb::new(friction).map_err(|e| text(&e))?);
            let contact = GridContact::new(SurfaceDistance::default(), laws);
            let mut mpm = Mpm::with_contact(plane(), BlockGrid::new(lattice()), contact);
            let rigid = if prescribed {
                let twist = Twist { velocity: [motion[0], motion[1]], spin: [0.0, 0.0, motion[2]] };
                Rigid::prescribed(density, move |_| twist).map_err(|e| text(&e))?.about(about)
            } else {
                let rigid = Rigid::free(density).map_err(|e| text(&e))?;
                rigid.with_velocity([motion[0], motion[1]]).with_spin([0.0, 0.0, motion[2]])
            };
            mpm.add_rigid("disc", &rigid, &ball([0.3, 0.3], 0.15)).map_err(|e| text(&e))?;
            mpm.add("block", rubber(), &cuboid([0.4, 0.0], [0.6, 0.2]), |_| [motion[0], 0.0])
                .map_err(|e| text(&e))?;
            mpm.set_body_force(move |_| [0.0, weight]);
            let side = Side::Above;
            mpm.bound(Boundary::Wall { axis: 1, at: wall, side, velocity: wall_speed })
                .map_err(|e| text(&e))?;
            let region = Arc::new(Cuboid::new([0.5, 0.0], [0.6, 0.1]).map_err(|e| text(&e))?);
            let velocity = Arc::new(move |_| [Some(region_speed), None, None]);
            mpm.bound(Boundary::Prescribed { region, velocity }).map_err(|e| text(&e))?;
            mpm.set_time_control(TimeControl::Courant { factor, growth }).map_err(|e| text(&e))?;
            mpm.set_local_damping(damping).map_err(|e| text(&e))?;
            mpm.set_time(start).map_err(|e| text(&e))?;
            Ok(mpm)
        };
        let Ok(mut mpm) = scene() else {
            refused += 1;
            continue;
        };
        let mut made = mpm.step_at_most(left).map(|_| ());
        let end = mpm.time() + length;
        for _ in 0..20 {
            if made.is_ok() && !mpm.reached(end) {
                made = mpm.step_towards(end).map(|_| ());
            }
        }
        if made.is_err() {
            stopped += 1;
        } else {
            ran += 1;
        }
        let finite = mpm.totals().momentum.iter().all(|p| p.is_finite());
        assert!(finite || made.is_err(), "{:?}", mpm.totals());
    }
    println!("{refused} refused, {stopped} stopped, {ran} ran");
    assert!(refused > 500 && stopped > 100 && ran > 20);
}
