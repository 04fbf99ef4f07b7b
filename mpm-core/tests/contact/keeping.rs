//! Contact data kept from earlier steps.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::{H, WAVE, ball, build, cuboid, particles, plane, three};
use mpm_contact::{
    ContactDetector, Coulomb, Criterion, Frictionless, Nodal, Pairs, Places, SeparatingPlane, SurfaceDistance,
};
use mpm_core::{GridContact, TimeControl, Watch};

/// Detector that counts its evaluations.
#[derive(Debug)]
struct Counted(SurfaceDistance, Arc<AtomicUsize>);

impl ContactDetector<f64, 2> for Counted {
    type Normals = SeparatingPlane;
    fn criterion(&self, spacing: f64) -> Criterion {
        ContactDetector::<f64, 2>::criterion(&self.0, spacing)
    }
    fn normals(&self) -> &SeparatingPlane {
        ContactDetector::<f64, 2>::normals(&self.0)
    }
    fn touching(
        &self,
        at: &dyn Places<f64, 2>,
        pair: [usize; 2],
        nodes: u64,
        normals: &Nodal<[f64; 3]>,
        gaps: &mut Nodal<Option<f64>>,
    ) -> u64 {
        self.1.fetch_add(nodes.count_ones() as usize, Ordering::Relaxed);
        self.0.touching(at, pair, nodes, normals, gaps)
    }
}

/// Return positions after `steps` of approaching discs, in cells, and the number of nodes evaluated by the detector.
fn run(keeps: Option<f64>, speed: f64, steps: usize) -> (Vec<[f64; 2]>, usize) {
    let count = Arc::new(AtomicUsize::new(0));
    let detector = Counted(SurfaceDistance::default(), count.clone());
    let mut contact = GridContact::new(detector, Pairs::new(Coulomb::new(0.3).expect("law")));
    if let Some(cells) = keeps {
        contact = contact.keeping(cells).expect("cells");
    }
    let mut scene = three(speed);
    scene.push((cuboid([-0.4, -0.2], [0.3, 0.1]), [0.0; 2]));
    let mut mpm = build(plane(), contact, &scene);
    mpm.set_time_control(TimeControl::Fixed(0.3 * H / WAVE)).expect("time control");
    // Linear shape functions with FLIP gain energy in collisions.
    mpm.set_watch(Watch::off());
    for _ in 0..steps {
        mpm.step().expect("step");
    }
    assert!(!mpm.contacts().is_empty(), "no contact");
    let list = particles(&mpm).concat();
    (list.iter().map(|p| [p.position[0] / H, p.position[1] / H]).collect(), count.load(Ordering::Relaxed))
}

/// Slow bodies are checked rarely; the result agrees with a check in every step within the displacement allowed in between.
#[test]
fn slow_bodies_are_looked_at_rarely() {
    let speed = 3e-4 * WAVE;
    let (every, often) = run(Some(0.0), speed, 7000);
    let (kept, rarely) = run(None, speed, 7000);
    assert!(rarely * 2 < often, "asked about {rarely} nodes, and {often} in every step");
    let apart = every.iter().zip(&kept).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max);
    assert!(apart < 5e-3, "{apart} cells apart");
    assert!(apart > 0.0, "nothing was kept");
}

/// Fast bodies move further in a step than the distance for which contact is kept.
#[test]
fn fast_bodies_are_looked_at_in_every_step() {
    let speed = 0.1 * WAVE;
    assert_eq!(run(Some(0.0), speed, 100), run(None, speed, 100));
}

/// A body at rest, or at rest again, is checked once.
#[test]
fn bodies_at_rest_are_looked_at_once() {
    let count = Arc::new(AtomicUsize::new(0));
    let detector = Counted(SurfaceDistance::default(), count.clone());
    let contact = GridContact::new(detector, Pairs::new(Frictionless));
    let scene = vec![(ball([0.2, 0.2], 0.2), [0.0; 2]), (ball([0.6, 0.2], 0.2), [0.0; 2])];
    let mut mpm = build(plane(), contact, &scene);
    for _ in 0..3 {
        mpm.step().expect("step");
    }
    let first = count.load(Ordering::Relaxed);
    assert!(first > 0, "the detector was not asked");
    for _ in 0..20 {
        mpm.step().expect("step");
    }
    assert_eq!(count.load(Ordering::Relaxed), first);
}

#[test]
fn keeping_refuses_what_makes_no_sense() {
    for cells in [-1e-3, 0.2, f64::NAN, f64::INFINITY] {
        let contact = GridContact::new(SurfaceDistance::default(), Pairs::<f64>::new(Frictionless));
        let refused = contact.keeping(cells).expect_err("refused").to_string();
        assert!(refused.contains("keeping") && refused.contains("0 to 0.1"), "{refused}");
    }
}
