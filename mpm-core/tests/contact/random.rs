//! Four hundred random scenes of bodies in contact: mass and momentum are conserved, and every energy gain is reported.

use mpm_contact::{Coulomb, Frictionless, Pairs, Stick, SurfaceDistance};
use mpm_core::geometry::{Ball, Cuboid, Filling, Lattice, Seeds, Shape, fill};
use mpm_core::{
    BlockGrid, Boundary, CpGimp, Deformable, Finding, Flip, FullSpace, IntoKernels, Kernels, Linear, Method,
    Mpm, Musl, PlaneStrain, QuadraticBSpline, Rigid, Scalar, Side, Splitting, Stopped, Twist, Watch,
};
use mpm_core::{GridContact, SceneError};
use mpm_materials::{Constitutive, Moduli, NeoHookean, Stretching, library};
use std::sync::Arc;

/// splitmix64.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }
    fn once_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }
}

macro_rules! method {
    ($n:expr, $space:expr) => {
        match $n {
            0 => Method::new(Linear, Flip, Musl, $space).into_kernels(),
            1 => Method::new(CpGimp, Flip, Musl, $space).into_kernels(),
            2 => Method::new(CpGimp, Flip, mpm_core::Usl, $space).into_kernels(),
            3 => Method::new(QuadraticBSpline, Flip, Musl, $space).into_kernels(),
            4 => Method::impact($space).into_kernels(),
            _ => Method::contact_at_rest($space).into_kernels(),
        }
    };
}

const H: f64 = 1e-3;

/// Create a ball or a box of 2 to 4 cells at a random position in a site of 10 cells.
fn body<const D: usize>(dice: &mut Dice, lattice: &Lattice<D>, site: [f64; D]) -> Seeds<D> {
    let centre: [f64; D] = std::array::from_fn(|d| site[d] + dice.within(4.2, 5.8) * H);
    let half: [f64; D] = std::array::from_fn(|_| dice.within(2.0, 4.0) * H);
    let shape: Box<dyn Shape<D>> = if dice.once_in(2) {
        Box::new(Ball::new(centre, half[0]).expect("ball"))
    } else {
        let corner = |sign: f64| std::array::from_fn(|d| centre[d] + sign * half[d]);
        Box::new(Cuboid::new(corner(-1.0), corner(1.0)).expect("box"))
    };
    fill(&*shape, lattice, 2, &Filling::new()).expect("seeds")
}

/// Result of a scene.
enum Ending {
    Well,
    /// Stopped, with the reason.
    Stopped(String),
    /// Energy gain that no warning reports.
    Gain(String),
}

/// Run the scene of a random seed.
fn scene<const D: usize>(seed: u64, kernels: Kernels<f64, D>) -> Ending
where
    f64: Scalar<D>,
{
    let mut dice = Dice(seed);
    let origin: [f64; D] = std::array::from_fn(|_| dice.within(-0.5, 0.5) * H);
    let lattice = Lattice::new(origin, H).expect("lattice");
    let mut laws = match dice.below(3) {
        0 => Pairs::new(Frictionless),
        1 => Pairs::new(Coulomb::new(dice.within(0.0, 1.0)).expect("friction")),
        _ => Pairs::new(Stick),
    };
    if dice.once_in(3) {
        laws = laws.with(0, 1, Stick);
    }
    let mut mpm = Mpm::with_contact(
        kernels,
        BlockGrid::new(lattice),
        GridContact::new(SurfaceDistance::default(), laws),
    );
    let speed = dice.within(1.0, 60.0);
    let bodies = 2 + dice.below(2);
    let (mut free, mut prescribed) = (0, 0);
    for n in 0..bodies {
        let site: [f64; D] =
            std::array::from_fn(|d| origin[d] + if d == 0 { 10.0 * n as f64 * H } else { 0.0 });
        let seeds = body(&mut dice, &lattice, site);
        let mut velocity: [f64; D] = std::array::from_fn(|_| dice.within(-0.3, 0.3) * speed);
        velocity[0] = if n == 0 { speed } else { -speed * dice.within(0.0, 1.0) };
        let turn = dice.within(-0.2, 0.2) * speed / (4.0 * H);
        let field = move |x: [f64; D]| -> [f64; D] {
            let mut v = velocity;
            v[0] -= turn * (x[1] - site[1] - 5.0 * H);
            v[1] += turn * (x[0] - site[0] - 5.0 * H);
            v
        };
        let name = format!("body {n}");
        match dice.below(6) {
            0 => {
                free += 1;
                let rigid =
                    Rigid::free(2000.0).expect("rigid").with_velocity(velocity).with_spin([0.0, 0.0, turn]);
                mpm.add_rigid(&name, &rigid, &seeds).expect("rigid");
            }
            1 => {
                prescribed += 1;
                let push = Rigid::prescribed(2000.0, move |_| Twist::along(velocity)).expect("rigid");
                mpm.add_rigid(&name, &push, &seeds).expect("rigid");
            }
            2 => {
                let lead = Stretching::new(library::lead()).compiled();
                let body = Deformable::new(&name, lead, &seeds).moving(field);
                mpm.add_body(body.with_splitting(Splitting::at(1.5).expect("splitting"))).expect("lead");
            }
            3 => mpm.add(&name, library::steel_4340(), &seeds, field).expect("steel"),
            _ => {
                let moduli =
                    Moduli::young_poisson(dice.within(1e7, 1e9), dice.within(0.0, 0.45)).expect("moduli");
                let rubber = NeoHookean::new(dice.within(500.0, 3000.0), moduli).expect("rubber");
                mpm.add(&name, rubber, &seeds, field).expect("rubber");
            }
        }
    }
    if dice.once_in(2) {
        let weight: [f64; D] = std::array::from_fn(|_| dice.within(-1e4, 1e4));
        mpm.set_body_force(move |_| weight);
    }
    // Planes below all bodies, above, and to the left.
    for (axis, at, side) in [(1, 0.0, Side::Above), (1, 10.0, Side::Below), (0, 0.0, Side::Above)] {
        let node = origin[axis] + at * H;
        match dice.below(6) {
            0 => mpm.bound(Boundary::Symmetry { axis, at: node, side }).expect("plane"),
            1 => {
                let into = if side == Side::Above { 1.0 } else { -1.0 };
                let velocity = if dice.once_in(2) { 0.0 } else { into * dice.within(0.0, 0.5) * speed };
                mpm.bound(Boundary::Wall { axis, at: node, side, velocity }).expect("wall");
            }
            2 => mpm.bound(Boundary::Fixed { axis, at: node, side }).expect("plane"),
            3 => {
                let low = std::array::from_fn(|d| origin[d] - 4.0 * H);
                let region = Arc::new(Cuboid::new(low, low.map(|x| x + 5.0 * H)).expect("region"));
                let velocity = Arc::new(move |t: f64| [Some(0.1 * speed * (1e5 * t).cos()), None, None]);
                mpm.bound(Boundary::Prescribed { region, velocity }).expect("boundary");
            }
            _ => {}
        }
    }

    // Runs are short: check often enough to find the cause of a gain.
    mpm.set_watch(Watch::default().every(16).expect("watch"));
    let start = mpm.totals();
    let steps = 50 + dice.below(151);
    for _ in 0..steps {
        if let Err(error) = mpm.step() {
            // Allowed stops: material between a moving boundary and another, a law or a free rigid body is crushed; a
            // plane of symmetry does not stop a rigid body.
            let named = matches!(
                error.what,
                Stopped::Watch(_)
                    | Stopped::Point { .. }
                    | Stopped::Scene(SceneError::Rigid { .. } | SceneError::BehindSymmetry { .. })
            );
            assert!(named, "scene {seed}: {error}");
            return Ending::Stopped(format!("scene {seed}: {error}"));
        }
    }
    let now = mpm.totals();
    assert!(
        (now.mass - start.mass).abs() <= 1e-12 * start.mass,
        "scene {seed}: mass {:e} of {:e}",
        now.mass,
        start.mass
    );
    let given = mpm.exchange();
    for d in 0..D {
        let left = now.momentum[d] - start.momentum[d] - given.impulse[d] - given.load[d] + given.dropped[d];
        let scale = start.momentum_scale.max(now.momentum_scale);
        assert!(left.abs() <= 1e-9 * scale, "scene {seed}: momentum {d} is {:e} of {scale:e}", left);
    }
    for body in mpm.bodies() {
        body.for_each(&mut |p| {
            let numbers = p.position.iter().chain(&p.velocity).chain(&p.stress);
            assert!(numbers.into_iter().all(|x| x.is_finite()), "scene {seed}: particle {}", p.number);
        });
    }
    let gain = mpm.account().energy_error();
    let named = mpm.warnings().iter().any(|w| matches!(w.finding, Finding::EnergyGain { .. }));
    if gain > 0.02 && !named {
        let method = &mpm.facts().description;
        return Ending::Gain(format!(
            "scene {seed} ({method}; {free} free, {prescribed} prescribed): energy +{gain}"
        ));
    }
    Ending::Well
}

fn all<const D: usize>(count: u64, kernels: impl Fn(u64) -> Kernels<f64, D>)
where
    f64: Scalar<D>,
{
    let (mut stopped, mut gains) = (0, Vec::new());
    for n in 0..count {
        match scene(1000 * D as u64 + n, kernels(n % 6)) {
            Ending::Well => {}
            Ending::Stopped(why) => {
                stopped += 1;
                println!("{why}");
            }
            Ending::Gain(what) => gains.push(what),
        }
    }
    assert!(gains.is_empty(), "{}", gains.join("\n"));
    assert!(stopped <= count / 20, "{stopped} of {count} stop");
}

#[test]
fn in_the_plane() {
    all::<2>(300, |n| method!(n, PlaneStrain));
}

#[test]
fn in_space() {
    all::<3>(100, |n| method!(n, FullSpace));
}
