//! Comparison of the fast step with the plain reference.

use mpm_core::parallel::Float;
use mpm_core::{
    BlockGrid, Boundary, Composition, Dilatation, Frame, GridStorage, IntoKernels, Mpm, OneField, PointView,
    ShapeFunction, TimeControl, Watch,
};
use mpm_materials::{Constitutive, IntoMaterial};

use crate::reference::{Order, Point, Reference, Rule, Space};
use crate::scene::{Scene, YOUNG};

/// Return the particles of all bodies, by body and number.
pub fn particles<T: Float, const D: usize>(mpm: &Mpm<D, T>) -> Vec<Vec<PointView>> {
    let mut bodies = Vec::new();
    for body in mpm.bodies() {
        let list = body.points();
        for (n, p) in list.iter().enumerate() {
            assert_eq!(p.number, n, "particle numbers of body `{}` have a gap or a repetition", body.name());
        }
        bodies.push(list);
    }
    bodies
}

/// Largest differences of particle quantities, each normalised.
#[derive(Clone, Copy, Debug, Default)]
pub struct Difference {
    /// Position difference, in cells.
    pub position: f64,
    /// Velocity difference over the largest speed.
    pub velocity: f64,
    /// Stress difference over the largest stress.
    pub stress: f64,
    /// State difference over Young's modulus, for every state variable.
    pub state: f64,
}

impl Difference {
    /// Return the largest of all differences.
    pub fn worst(&self) -> f64 {
        // `f64::max` would lose a NaN.
        let mut worst = 0.0;
        for x in [self.position, self.velocity, self.stress, self.state] {
            if x.is_nan() || x > worst {
                worst = x;
            }
        }
        worst
    }
}

/// Build a scene of the fast step, bodies of one law.
pub fn fast<T: Float, const D: usize, M, G, C>(method: M, grid: G, scene: &Scene<D>, law: &C) -> Mpm<D, T>
where
    M: IntoKernels<T, D>,
    G: GridStorage<T, D> + 'static,
    C: IntoMaterial<T> + Clone,
{
    let mut mpm = Mpm::of(method, grid, OneField);
    // Energy watch off: the plain reference is the criterion; some of its scenes gain energy as expected.
    mpm.set_watch(Watch::off());
    for (n, (seeds, velocity)) in scene.bodies.iter().enumerate() {
        mpm.add(&format!("body {n}"), law.clone(), seeds, velocity).expect("body");
    }
    surround(&mut mpm, scene);
    mpm
}

/// Apply the boundaries, loads and time step of a scene.
pub fn surround<T: Float, const D: usize>(mpm: &mut Mpm<D, T>, scene: &Scene<D>) {
    for boundary in &scene.boundaries {
        mpm.bound(boundary.clone()).expect("boundary");
    }
    let gravity = scene.gravity;
    if gravity != [0.0; D] {
        mpm.set_body_force(move |_| gravity);
    }
    mpm.set_time_control(TimeControl::Fixed(scene.dt)).expect("time control");
}

/// Build the scene of the reference, without bodies.
pub fn plain<const D: usize, S: ShapeFunction<f64, D>>(
    shape: S,
    rule: Rule,
    order: Order,
    scene: &Scene<D>,
) -> Reference<D, S> {
    let mut reference = Reference::new(shape, rule, order, scene.space, scene.lattice);
    reference.boundaries = scene.boundaries.clone();
    reference.gravity = scene.gravity;
    reference
}

/// Return the differences between fast step and reference.
pub fn difference<const D: usize>(
    fast: &[Vec<PointView>],
    plain: &[Point<D>],
    stresses: &[[f64; 6]],
    leads: &[[f64; D]],
    spacing: f64,
) -> Difference {
    assert_eq!(fast.iter().map(Vec::len).sum::<usize>(), plain.len(), "particles were lost or made");
    let mut speed = 0.0f64;
    let mut strength = 1e-3 * YOUNG;
    for (p, s) in plain.iter().zip(stresses) {
        speed = speed.max(p.v.iter().map(|v| v * v).sum::<f64>().sqrt());
        strength = s.iter().fold(strength, |a, b| a.max(b.abs()));
    }
    let mut found = Difference::default();
    let rise = |worst: &mut f64, error: f64| {
        if error.is_nan() || error > *worst {
            *worst = error;
        }
    };
    for (p, s) in plain.iter().zip(stresses) {
        let q = &fast[p.body][p.number];
        assert_eq!(q.mass, p.mass, "mass of particle {} of body {}", p.number, p.body);
        for d in 0..D {
            rise(
                &mut found.position,
                (q.position[d] + leads[p.body][d] - p.x[d] - p.displacement[d]).abs() / spacing,
            );
            rise(&mut found.velocity, (q.velocity[d] - p.v[d]).abs() / speed);
        }
        for i in 0..6 {
            rise(&mut found.stress, (q.stress[i] - s[i]).abs() / strength);
        }
        assert_eq!(q.state.len(), p.state.len(), "length of the state");
        for (a, b) in q.state.iter().zip(&p.state) {
            rise(&mut found.state, (a - b).abs() / YOUNG);
        }
    }
    found
}

/// Run a scene with both implementations and one law; return the difference at the end.
pub fn compare<const D: usize, M, S, C>(
    method: M,
    shape: S,
    rule: Rule,
    order: Order,
    scene: &Scene<D>,
    law: &C,
) -> Difference
where
    M: Composition<f64, D> + IntoKernels<f64, D>,
    S: ShapeFunction<f64, D>,
    C: Constitutive<f64> + IntoMaterial<f64>,
{
    let mut mpm = fast(method, BlockGrid::new(scene.lattice), scene, law);
    let mut reference = plain(shape, rule, order, scene);
    reference.total = M::Frame::TOTAL;
    reference.mean_dilatation = M::Dilatation::MEAN;
    for (seeds, velocity) in &scene.bodies {
        reference.add(law.clone(), seeds, velocity);
    }
    run_both(&mut mpm, &mut reference, scene)
}

/// Velocities of the centres of mass of bodies, m/s.
fn centres<const D: usize, S>(reference: &Reference<D, S>, bodies: usize) -> Vec<[f64; D]> {
    let mut sums = vec![([0.0; D], 0.0); bodies];
    for p in &reference.points {
        let (momentum, mass) = &mut sums[p.body];
        (0..D).for_each(|d| momentum[d] += p.mass * p.v[d]);
        *mass += p.mass;
    }
    sums.into_iter().map(|(momentum, mass)| momentum.map(|p| p / mass)).collect()
}

/// Position offsets of the body views, m: half a step of the velocity that a body gains by the body force since its `start` velocity, along
/// axes without symmetry planes.
fn leads<const D: usize, S>(
    reference: &Reference<D, S>,
    scene: &Scene<D>,
    start: &[[f64; D]],
) -> Vec<[f64; D]> {
    let of = |(now, start): (&[f64; D], &[f64; D])| {
        std::array::from_fn(|d| {
            let across = |b: &Boundary<D>| matches!(b, Boundary::Symmetry { axis, .. } if *axis == d);
            if scene.boundaries.iter().any(across) || (d == 0 && reference.space == Space::Axisymmetric) {
                return 0.0;
            }
            let fall = scene.gravity[d] * reference.time;
            0.5 * scene.dt * (now[d] - start[d]).clamp(fall.min(0.0), fall.max(0.0))
        })
    };
    centres(reference, start.len()).iter().zip(start).map(of).collect()
}

/// Run both implementations for the scene's steps; return the difference at the end.
pub fn run_both<const D: usize, S>(
    mpm: &mut Mpm<D>,
    reference: &mut Reference<D, S>,
    scene: &Scene<D>,
) -> Difference
where
    S: ShapeFunction<f64, D>,
{
    let start = centres(reference, scene.bodies.len());
    for _ in 0..scene.steps {
        mpm.step().unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        reference.step(scene.dt);
        if std::env::var_os("EACH_STEP").is_some() {
            let stresses: Vec<[f64; 6]> =
                reference.points.iter().map(|p| reference.laws[p.body].stress(&p.state)).collect();
            let now = difference(
                &particles(mpm),
                &reference.points,
                &stresses,
                &leads(reference, scene, &start),
                scene.lattice.spacing(),
            );
            println!("{} step {}: {now:?}", scene.name, mpm.steps());
        }
    }
    let stresses: Vec<[f64; 6]> =
        reference.points.iter().map(|p| reference.laws[p.body].stress(&p.state)).collect();
    let leads = leads(reference, scene, &start);
    difference(&particles(mpm), &reference.points, &stresses, &leads, scene.lattice.spacing())
}
