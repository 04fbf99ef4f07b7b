//! Contact laws with memory: slip weakening against the exact motion of a slider, and the lifetime of memory.

use std::sync::{Arc, Mutex};

use crate::common::{H, WAVE, build, cuboid, particles, plane, three};
use mpm_contact::{
    Approach, Contact, ContactLaw, Coulomb, Gradients, Outcome, Pairs, Remembers, SlipWeakening, Stick,
    SurfaceDistance, vector::dot,
};
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::{
    Apic, BlockGrid, DenseGrid, GridContact, Method, Mpm, PlaneStrain, QuadraticBSpline, Rigid, Team,
    TimeControl, Twist, Usl,
};
use mpm_materials::{Moduli, NeoHookean};

const GRAVITY: f64 = 10.0;
const AT_REST: f64 = 0.6;
const SLIDING: f64 = 0.2;
/// More than two cells: the contact memory must move with the block.
const DISTANCE: f64 = 0.12;
/// Impulses on free rigid bodies are found to 1e-10 of the largest, or as far as the relaxation converges: in some
/// steps the block slips by this distance, m. (2e-7 m in 0.3 s were measured with steps of 1 ms.)
const CREEP: f64 = 1e-6;
/// Displacement that counts as motion of the block, m: r tau^3 / 6, with weakening still below a thousandth.
const MOVED: f64 = 1e-5;

fn still(mpm: &mut Mpm<2>, seeds: &Seeds<2>) {
    let rigid = Rigid::prescribed(1000.0, |_| Twist::along([0.0; 2])).expect("rigid");
    mpm.add_rigid("floor", &rigid, seeds).expect("floor");
}

/// Block on a floor, pulled by r t along it since `start`: it starts to slip at t_1 = mu_s g / r, then s'' = r (t -
/// t_1) + lambda^2 s with lambda^2 = (mu_s - mu_k) g / d_c, so s = r / lambda^3 (sinh x - x), x = lambda (t - t_1),
/// until s = d_c; then s'' = r t - mu_k g.
struct Slider {
    rate: f64,
}

impl Slider {
    fn lets_go(&self) -> f64 {
        AT_REST * GRAVITY / self.rate
    }
    fn way(&self, t: f64) -> f64 {
        let lambda = ((AT_REST - SLIDING) * GRAVITY / DISTANCE).sqrt();
        let weakening = |x: f64| self.rate / lambda.powi(3) * (x.sinh() - x);
        let x = lambda * (t - self.lets_go()).max(0.0);
        if weakening(x) < DISTANCE {
            return weakening(x);
        }
        let (mut low, mut high) = (0.0, x);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if weakening(middle) < DISTANCE { low = middle } else { high = middle }
        }
        let (then, speed) = (self.lets_go() + low / lambda, self.rate / lambda.powi(2) * (low.cosh() - 1.0));
        let more = t - then;
        let pull = self.rate * then - SLIDING * GRAVITY;
        DISTANCE + speed * more + 0.5 * pull * more * more + self.rate * more.powi(3) / 6.0
    }
}

fn weakening() -> Pairs<f64> {
    Pairs::new(SlipWeakening::new(AT_REST, SLIDING, DISTANCE).expect("law"))
}

/// Return the delay, s, at which a rigid block has moved by `MOVED`, and its relative error of displacement at the end.
fn rigid_slider(dt: f64, laws: Pairs<f64>) -> [f64; 2] {
    let slider = Slider { rate: 20.0 };
    let contact = GridContact::new(SurfaceDistance::default(), laws);
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(crate::common::lattice()), contact);
    mpm.set_time_control(TimeControl::Fixed(dt)).expect("control");
    let free = Rigid::free(1000.0).expect("rigid");
    mpm.add_rigid("block", &free, &cuboid([0.0, 0.0], [0.4, 0.1])).expect("block");
    still(&mut mpm, &cuboid([-0.3, -0.2], [1.6, 0.0]));
    mpm.set_body_force(move |t| [20.0 * t, -GRAVITY]);
    let way = |mpm: &Mpm<2>| mpm.bodies()[0].rigid().expect("rigid").centre()[0] - 0.2;
    let mut late = f64::NAN;
    while mpm.time() < 0.75 - 0.5 * dt {
        mpm.step().expect("step");
        assert!(mpm.time() > slider.lets_go() || way(&mpm).abs() < CREEP, "it creeps");
        if late.is_nan() && way(&mpm) > MOVED {
            late = mpm.time() - slider.lets_go() - (6.0 * MOVED / slider.rate).cbrt();
        }
    }
    let exact = slider.way(mpm.time());
    assert!(exact > 7.0 * H, "it should go many cells: {exact}");
    [late, way(&mpm) / exact - 1.0]
}

/// Friction is that of the slip at the start of the step, and velocities are between positions: the integration error
/// is some (lambda dt)^2, 3e-5 with the longer steps. The contact of a free rigid body adds its own error, which
/// constant friction shows in the same scene, where s = r (t - t_1)^3 / 6: 2e-4 with the shorter steps.
#[test]
fn a_rigid_block_lets_go_and_runs_away() {
    let slider = Slider { rate: 20.0 };
    for dt in [1e-3, 5e-4] {
        let [late, error] = rigid_slider(dt, weakening());
        assert!(late.abs() < 2.0 * dt, "it lets go {late} s late");
        assert!(error.abs() < 3e-4, "dt {dt}: off by {error:e}");
        let [late, off] = rigid_slider(dt, Pairs::new(Coulomb::new(AT_REST).expect("law")));
        let constant = slider.rate * (0.75 - slider.lets_go()).powi(3) / 6.0;
        let error = (1.0 + off) * slider.way(0.75) / constant - 1.0;
        assert!(late.abs() < 2.0 * dt && error.abs() < 3e-4, "dt {dt}: {late} s late, off by {error:e}");
        assert!(off < -0.2, "what weakens is elsewhere: {off}");
    }
}

/// Block of rubber with faces between nodes; the weight is applied slowly, then the pull.
#[test]
fn a_soft_block_lets_go_and_runs_away() {
    let slider = Slider { rate: 20.0 };
    let lattice = Lattice::new([0.013, 0.007], H).expect("lattice");
    let block = |low: [f64; 2], high: [f64; 2]| {
        fill(&Cuboid::new(low, high).expect("block"), &lattice, 2, &Filling::new()).expect("seeds")
    };
    let contact = GridContact::new(SurfaceDistance::default(), weakening());
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    let rubber = NeoHookean::new(1000.0, Moduli::young_poisson(1e7, 0.3).expect("moduli")).expect("law");
    mpm.add("block", rubber, &block([0.0, 0.0], [0.4, 0.1]), |_| [0.0; 2]).expect("block");
    still(&mut mpm, &block([-0.3, -0.2], [1.6, 0.0]));
    let start = 0.1;
    mpm.set_body_force(move |t| {
        let share = (t / start).min(1.0);
        [20.0 * (t - start).max(0.0), -GRAVITY * share * share * (3.0 - 2.0 * share)]
    });
    let centre = |mpm: &Mpm<2>| {
        let mut sums = [0.0; 2];
        mpm.bodies()[0].for_each(&mut |p| {
            sums[0] += p.mass * p.position[0];
            sums[1] += p.mass;
        });
        sums[0] / sums[1]
    };
    let first = centre(&mpm);
    // It leans by sigma_yy nu / E and the shear of 10 kPa at most, some 1e-5 m; then it moves six cells.
    mpm.run_until(start + 0.28).expect("run");
    let leans = centre(&mpm) - first;
    assert!(leans.abs() < 1e-5, "it leans by {leans} m");
    // Disturbances at the onset by leaning and vibration grow by sinh(lambda t): 0.5 % of the displacement at 0.5 s,
    // 0.2 % at 0.7 s.
    for t in [0.5, 0.6, 0.7] {
        mpm.run_until(start + t).expect("run");
        let (way, exact) = (centre(&mpm) - first, slider.way(t));
        assert!((way / exact - 1.0).abs() < 0.01, "{t} s: {way} m, exact {exact}");
    }
}

/// Time, age and position.
type Seen = (f64, f64, [f64; 3]);

/// Law that records the contacts of another one, and counts the steps of a contact.
#[derive(Clone, Debug)]
struct Witness<L> {
    law: L,
    seen: Arc<Mutex<Vec<Seen>>>,
}
impl<L: ContactLaw<f64>> Witness<L> {
    fn of(law: L) -> Self {
        Witness { law, seen: Arc::default() }
    }
}
impl<L: ContactLaw<f64>> ContactLaw<f64> for Witness<L> {
    fn pulls(&self) -> bool {
        self.law.pulls()
    }
    fn remembers(&self) -> Remembers {
        Remembers::SlipAnd(1)
    }
    fn impulse(&self, contact: &Contact<f64>) -> [f64; 3] {
        assert_eq!((contact.bodies, contact.memory.len()), ([0, 1], 1));
        self.seen.lock().expect("seen").push((contact.time, contact.memory[0], contact.position));
        self.law.impulse(contact)
    }
    fn advance(&self, contact: &Contact<f64>, outcome: &Outcome<f64>, memory: &mut [f64]) {
        assert!(dot(outcome.slid, contact.normal).abs() < 1e-12 && contact.memory[0] == memory[0]);
        memory[0] += 1.0;
    }
}

/// A block lies, is lifted, and lands again: contacts age, are forgotten, and start again, at the nodes of its lower face.
#[test]
fn memory_lasts_as_long_as_the_contact() {
    let law = Witness::of(Coulomb::new(0.5).expect("law"));
    let seen = law.seen.clone();
    let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(law));
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(crate::common::lattice()), contact);
    let dt = 1e-3;
    mpm.set_time_control(TimeControl::Fixed(dt)).expect("control");
    let free = Rigid::free(1000.0).expect("rigid");
    mpm.add_rigid("block", &free, &cuboid([0.0, 0.0], [0.4, 0.1])).expect("block");
    still(&mut mpm, &cuboid([-0.3, -0.2], [0.7, 0.0]));
    // Weight down for 50 ms, up for 20, then down.
    mpm.set_body_force(move |t| [0.0, if (0.05..0.07).contains(&t) { 10.0 } else { -10.0 }]);
    mpm.run_until(0.2).expect("run");
    let seen = seen.lock().expect("seen");
    assert!(seen.iter().all(|s| s.2[1].abs() < 1.5 * H && s.2[0] > -H && s.2[0] < 0.4 + H));
    let oldest = |from: f64, to: f64| {
        seen.iter().filter(|s| s.0 >= from && s.0 < to).map(|s| s.1).fold(f64::NEG_INFINITY, f64::max)
    };
    assert_eq!(oldest(0.0, 0.5 * dt), 0.0, "a first contact is new");
    let lying = oldest(0.0, 0.05);
    assert!((45.0..=50.0).contains(&lying), "{lying}");
    // Up at 0.2 m/s, the block decelerates and falls for 40 ms, and is on the floor after some 0.12 s.
    assert_eq!(oldest(0.075, 0.1), f64::NEG_INFINITY, "nothing touches in the air");
    let again = oldest(0.1, 0.2);
    assert!((10.0..100.0).contains(&again), "the second contact began anew: {again}");
}

/// Two blocks glued together fly through the grid, along their common face and across it: every new node has the age
/// of the contact, and results are bitwise identical for any threads and grid.
#[test]
fn memory_travels_with_a_pair() {
    let run = |threads: usize, dense: bool| {
        let law = Witness::of(Stick);
        let seen = law.seen.clone();
        let contact = GridContact::new(Approach::<Gradients>::default(), Pairs::new(law));
        let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
        let lattice = crate::common::lattice();
        let mut mpm = if dense {
            Mpm::with_contact(method, DenseGrid::new(lattice, [-8; 2], [60; 2]).expect("grid"), contact)
        } else {
            Mpm::with_contact(method, BlockGrid::new(lattice), contact)
        };
        mpm.set_team(Team::new(threads).expect("threads"));
        mpm.set_time_control(TimeControl::Fixed(5e-4)).expect("control");
        let rubber = crate::common::rubber();
        // 0.6 m, 12 cells, in 400 steps.
        mpm.add("left", rubber, &cuboid([0.0, 0.0], [0.3, 0.2]), |_| [3.05, 1.0]).expect("left");
        mpm.add("right", rubber, &cuboid([0.3, 0.0], [0.6, 0.2]), |_| [2.95, 1.0]).expect("right");
        for step in 0..400 {
            mpm.step().expect("step");
            for (time, age, at) in seen.lock().expect("seen").drain(..) {
                assert_eq!(age, f64::from(step), "{time} s, {at:?}");
            }
        }
        assert!(mpm.contacts()[0].places > 2);
        particles(&mpm)
    };
    let one = run(1, false);
    assert!(one == run(2, false) && one == run(1, true), "the same bits");
}

/// Three discs with slip weakening: bitwise identical for any number of threads.
#[test]
fn threads_change_nothing() {
    let run = |threads: usize| {
        let contact = GridContact::new(SurfaceDistance::default(), weakening()).with_strain_corrected();
        let mut mpm = build(plane(), contact, &three(0.05 * WAVE));
        mpm.set_team(Team::new(threads).expect("threads"));
        for _ in 0..150 {
            mpm.step().expect("step");
        }
        (particles(&mpm), mpm.contacts().to_vec())
    };
    let one = run(1);
    assert!(one.1.len() == 3 && one.1.iter().all(|pair| pair.friction > 0.0));
    assert!(one == run(3));
}
