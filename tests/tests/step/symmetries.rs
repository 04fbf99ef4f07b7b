//! Invariance of results under rotation, translation, reflection, change of dimension, grid, number of threads and
//! precision.

use impactite_tests::compare::{fast, particles, surround};
use impactite_tests::laws::Prestressed;
use impactite_tests::scene::{self, Flow, Scene, YOUNG, block, metal, rubber, wave_speed};
use mpm_core::dim::{BLOCK, block_nodes};
use mpm_core::geometry::{Lattice, Seeds};
use mpm_core::{
    Apic, Axisymmetric, BlockGrid, Boundary, CompiledHere, DenseGrid, Flip, FullSpace, Gimp, IntoKernels,
    Linear, Method, Mpm, Musl, PlaneStrain, PointView, QuadraticBSpline, Side, Team, TimeControl, Usl,
};
use mpm_materials::{Constitutive, Moduli, NeoHookean};

/// Allowed difference: round-off of 40 steps; see the tests against the reference.
const TOLERANCE: f64 = 1e-11;

type LinearFlip<E> = Method<Linear, Flip, Musl, E>;
type Spline<E> = Method<QuadraticBSpline, Apic, Usl, E>;
type Box2 = CompiledHere<Method<Gimp, Flip, Usl, PlaneStrain>>;

fn run<const D: usize, M: IntoKernels<f64, D>>(method: M, scene: &Scene<D>) -> Vec<PointView> {
    let mut mpm = fast(method, BlockGrid::new(scene.lattice), scene, &rubber());
    for _ in 0..scene.steps {
        mpm.step().unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    }
    particles(&mpm).into_iter().flatten().collect()
}

/// Assert that `q` is `p` with vectors mapped by `map` (a signed permutation) and positions by `place`.
fn assert_mapped(
    p: &PointView,
    q: &PointView,
    map: impl Fn([f64; 3]) -> [f64; 3],
    place: impl Fn([f64; 3]) -> [f64; 3],
) {
    let (x, v) = (place(p.position), map(p.velocity));
    for d in 0..3 {
        assert!((q.position[d] - x[d]).abs() < TOLERANCE, "position {:?} against {x:?}", q.position);
        assert!(
            (q.velocity[d] - v[d]).abs() < TOLERANCE * wave_speed(),
            "velocity {:?} against {v:?}",
            q.velocity
        );
    }
    // Map of the stress: columns, then rows.
    let matrix = |s: [f64; 6]| [[s[0], s[5], s[4]], [s[5], s[1], s[3]], [s[4], s[3], s[2]]];
    let (a, b) = (matrix(p.stress), matrix(q.stress));
    let mut half = [[0.0; 3]; 3];
    for i in 0..3 {
        half[i] = map(a[i]);
    }
    for j in 0..3 {
        let column = map([half[0][j], half[1][j], half[2][j]]);
        for i in 0..3 {
            assert!((b[i][j] - column[i]).abs() < TOLERANCE * YOUNG, "stress {b:?}");
        }
    }
}

/// Return the scene `flow` on a lattice with origin zero, and the scene with mapped seeds and velocities.
fn mapped_flow<const D: usize>(
    place: impl Fn([f64; D]) -> [f64; D],
    map: impl Fn([f64; D]) -> [f64; D] + Clone + 'static,
) -> (Scene<D>, Scene<D>) {
    let lattice = Lattice::new([0.0; D], 0.1).expect("lattice");
    let centred = || {
        let mut scene = scene::flow::<D>();
        let origin = scene.lattice.origin();
        for x in &mut scene.bodies[0].0.positions {
            for d in 0..D {
                x[d] -= origin[d];
            }
        }
        scene.lattice = lattice;
        scene
    };
    let speed = |x: [f64; D]| {
        let mut v = [0.0; D];
        for d in 0..D {
            v[d] = 0.3 * (1.0 + 5.0 * x[(d + 1) % D] - (3.0 + d as f64) * x[d]);
        }
        v
    };
    let (mut one, mut other) = (centred(), centred());
    let table: Vec<([f64; D], [f64; D])> =
        one.bodies[0].0.positions.iter().map(|x| (place(*x), map(speed(*x)))).collect();
    one.bodies[0].1 = Box::new(speed);
    other.bodies[0].0.positions = table.iter().map(|t| t.0).collect();
    other.bodies[0].1 = Box::new(move |x| table.iter().find(|t| t.0 == x).expect("a seed").1);
    (one, other)
}

fn assert_turned<const D: usize, M: IntoKernels<f64, D> + Copy>(
    method: M,
    turn: impl Fn([f64; 3]) -> [f64; 3] + Clone + 'static,
) {
    let inner = turn.clone();
    let short = move |x: [f64; D]| {
        let mut long = [0.0; 3];
        long[..D].copy_from_slice(&x);
        let mut r = [0.0; D];
        r.copy_from_slice(&inner(long)[..D]);
        r
    };
    let (one, other) = mapped_flow(short.clone(), short);
    for (p, q) in run(method, &one).iter().zip(&run(method, &other)) {
        assert_mapped(p, q, &turn, &turn);
    }
}

#[test]
fn turned_by_a_right_angle() {
    let quarter = |[x, y, z]: [f64; 3]| [-y, x, z];
    assert_turned::<2, LinearFlip<PlaneStrain>>(Default::default(), quarter);
    assert_turned::<2, Spline<PlaneStrain>>(Default::default(), quarter);
    assert_turned::<2, Box2>(Default::default(), quarter);
    assert_turned::<3, Spline<FullSpace>>(Default::default(), |[x, y, z]| [x, -z, y]);
    assert_turned::<3, LinearFlip<FullSpace>>(Default::default(), |[x, y, z]| [z, x, y]);
}

#[test]
fn mirrored() {
    let mirror = |[x, y, z]: [f64; 3]| [-x, y, z];
    assert_turned::<2, LinearFlip<PlaneStrain>>(Default::default(), mirror);
    assert_turned::<3, Spline<FullSpace>>(Default::default(), mirror);
}

#[test]
fn shifted_by_whole_cells() {
    fn check<M: IntoKernels<f64, 2> + Copy>(method: M) {
        let by = |x: [f64; 2]| [x[0] + 0.7, x[1] - 1.3];
        let (one, other) = mapped_flow(by, |v| v);
        for (p, q) in run(method, &one).iter().zip(&run(method, &other)) {
            assert_mapped(p, q, |v| v, |x| [x[0] + 0.7, x[1] - 1.3, 0.0]);
        }
    }
    check(LinearFlip::<PlaneStrain>::default());
    check(Spline::<PlaneStrain>::default());
}

/// Half a body at a symmetry plane moves like half of the whole body.
fn half_is_whole<const D: usize, M: IntoKernels<f64, D> + Copy>(method: M, planes: usize) {
    let lattice = scene::lattice::<D>();
    let mut cells = [3; D];
    cells[0] = 2;
    let at = lattice.node([1; D]);
    let half = block(&lattice, [1; D], cells, 2, 0.5);
    let speed: fn(&[f64]) -> f64 = |r| 0.4 * r[0] - 0.9 * r[0] * r[1];
    // Velocity odd across the plane in its normal direction, even in the others.
    let velocity = move |x: [f64; D]| {
        let mut r = [0.0; D];
        for d in 0..D {
            r[d] = x[d] - at[d];
        }
        let mut v = [0.0; D];
        for d in 0..D {
            v[d] = if d < planes {
                let mut folded = r;
                for (e, f) in folded.iter_mut().enumerate() {
                    if e < planes {
                        *f = f.abs();
                    }
                }
                folded.swap(0, d);
                r[d].signum() * -2.0 * speed(&folded)
            } else {
                0.5 - 0.7 * r[d]
            };
        }
        v
    };
    let scene = |seeds: Seeds<D>, boundaries| Scene {
        name: "half and whole",
        lattice,
        bodies: vec![(seeds, Box::new(velocity) as Flow<D>)],
        boundaries,
        gravity: [0.0; D],
        dt: 0.2 * 0.1 / wave_speed(),
        steps: 30,
        space: impactite_tests::reference::Space::Cartesian,
    };
    let mut whole = half.clone();
    for axis in 0..planes {
        for n in 0..whole.positions.len() {
            let mut x = whole.positions[n];
            x[axis] = 2.0 * at[axis] - x[axis];
            whole.positions.push(x);
            whole.volumes.push(whole.volumes[n]);
        }
    }
    let bounds = (0..planes).map(|axis| Boundary::Symmetry { axis, at: at[axis], side: Side::Above });
    let parts = run(method, &scene(half, bounds.collect()));
    let wholes = run(method, &scene(whole, vec![]));
    for (p, q) in parts.iter().zip(&wholes) {
        assert_mapped(p, q, |v| v, |x| x);
    }
}

#[test]
fn half_a_body_is_the_whole_one() {
    half_is_whole::<2, LinearFlip<PlaneStrain>>(Default::default(), 1);
    half_is_whole::<2, Spline<PlaneStrain>>(Default::default(), 1);
    half_is_whole::<2, Spline<PlaneStrain>>(Default::default(), 2);
    half_is_whole::<2, Box2>(Default::default(), 2);
    half_is_whole::<3, Spline<FullSpace>>(Default::default(), 2);
    half_is_whole::<3, LinearFlip<FullSpace>>(Default::default(), 2);
}

/// The impulse of a symmetry plane is accounted for.
#[test]
fn impulse_of_a_symmetry_plane_is_booked() {
    fn check<M: IntoKernels<f64, 2>>(method: M) {
        let scene = scene::bar::<2>();
        let mut mpm = fast(method, BlockGrid::new(scene.lattice), &scene, &rubber());
        let before = mpm.totals();
        for _ in 0..scene.steps {
            mpm.step().expect("step");
        }
        let (after, ledger) = (mpm.totals(), mpm.exchange());
        for d in 0..2 {
            let given = ledger.impulse[d] + ledger.load[d] + ledger.dropped[d];
            let error = (after.momentum[d] - before.momentum[d] - given).abs() / before.momentum_scale;
            assert!(error < 1e-12, "{} axis {d}: {error}; given {given}", mpm.facts().description);
        }
    }
    check(LinearFlip::<PlaneStrain>::default());
    check(Spline::<PlaneStrain>::default());
    check(Box2::default());
}

/// Return particles in plane strain, and in a slice of one cell between symmetry planes, in front of a wall or on a
/// fixed plane.
fn slice<M2: IntoKernels<f64, 2>, M3: IntoKernels<f64, 3>>(
    flat: M2,
    solid: M3,
    wall: bool,
) -> (Vec<PointView>, Vec<PointView>) {
    let mut scene2 = scene::bar::<2>();
    for boundary in &mut scene2.boundaries {
        if let (false, Boundary::Wall { axis, at, side, .. }) = (wall, &*boundary) {
            *boundary = Boundary::Fixed { axis: *axis, at: *at, side: *side };
        }
    }
    let origin = scene2.lattice.origin();
    let lattice3 = Lattice::new([origin[0], origin[1], 0.3], 0.1).expect("lattice");
    let seeds2 = &scene2.bodies[0].0;
    let mut seeds3 = scene::seeds(vec![], 1.0, 0.025);
    for z in [0.325, 0.375] {
        for (x, volume) in seeds2.positions.iter().zip(&seeds2.volumes) {
            seeds3.positions.push([x[0], x[1], z]);
            // Volume per metre of depth in 2D; 0.1 m in two layers in 3D.
            seeds3.volumes.push(volume * 0.05);
        }
    }
    let mut boundaries = vec![
        Boundary::Symmetry { axis: 2, at: 0.3, side: Side::Above },
        Boundary::Symmetry { axis: 2, at: 0.4, side: Side::Below },
    ];
    for boundary in &scene2.boundaries {
        boundaries.push(match *boundary {
            Boundary::Symmetry { axis, at, side } => Boundary::Symmetry { axis, at, side },
            Boundary::Wall { axis, at, side, velocity } => Boundary::Wall { axis, at, side, velocity },
            Boundary::Fixed { axis, at, side } => Boundary::Fixed { axis, at, side },
            _ => panic!("not in this scene"),
        });
    }
    let along = scene2.bodies[0].1([0.0; 2]);
    let scene3 = Scene {
        name: "slice",
        lattice: lattice3,
        bodies: vec![(seeds3, Box::new(move |_| [along[0], along[1], 0.0]))],
        boundaries,
        gravity: [scene2.gravity[0], scene2.gravity[1], 0.0],
        dt: scene2.dt,
        steps: scene2.steps,
        space: impactite_tests::reference::Space::Cartesian,
    };
    (run(flat, &scene2), run(solid, &scene3))
}

#[test]
fn plane_strain_is_a_slice_of_space() {
    let linear = |wall| slice(LinearFlip::<PlaneStrain>::default(), LinearFlip::<FullSpace>::default(), wall);
    let spline = |wall| slice(Spline::<PlaneStrain>::default(), Spline::<FullSpace>::default(), wall);
    for (thin, thick) in [linear(false), spline(false)] {
        for (n, q) in thick.iter().enumerate() {
            let p = &thin[n % thin.len()];
            assert_mapped(p, q, |v| v, |x| [x[0], x[1], if n < thin.len() { 0.325 } else { 0.375 }]);
        }
    }
    // In 3D twice as many surfaces are in contact with the wall and may share the force arbitrarily: contact sweeps end at another
    // solution.
    for (thin, thick) in [linear(true), spline(true)] {
        let apart = |(n, q): (usize, &PointView)| {
            let p = &thin[n % thin.len()];
            (0..2).map(|d| (q.position[d] - p.position[d]).abs()).fold(0.0, f64::max)
        };
        let worst = thick.iter().enumerate().map(apart).fold(0.0, f64::max);
        println!("{worst} m apart, cells of 0.1 m");
        assert!(worst < 1e-3, "{worst} m");
    }
}

fn bits<const D: usize>(mut mpm: Mpm<D>) -> Vec<u64> {
    for _ in 0..40 {
        mpm.step().expect("step");
    }
    let mut list = vec![];
    for p in particles(&mpm).into_iter().flatten() {
        let numbers = p.position.iter().chain(&p.velocity).chain(&p.stress).chain(&p.state);
        list.extend(numbers.map(|x| x.to_bits()));
    }
    list
}

/// Return a scene of many blocks with boundaries.
fn wide<const D: usize>() -> Scene<D> {
    let mut scene = scene::bar::<D>();
    let mut cells = [9; D];
    cells[D - 1] = 7;
    if D == 2 {
        cells = [20; D];
    }
    scene.bodies[0].0 = block(&scene.lattice, [1; D], cells, 2, 0.5);
    scene
}

#[test]
fn threads_do_not_change_a_bit() {
    fn check<const D: usize, M: IntoKernels<f64, D> + Copy>(method: M) {
        let scene = wide::<D>();
        let run = |threads| {
            let mut mpm = fast(method, BlockGrid::new(scene.lattice), &scene, &rubber());
            mpm.set_team(Team::new(threads).expect("threads"));
            bits(mpm)
        };
        let one = run(1);
        assert!(one == run(2), "2 threads");
        assert!(one == run(4), "4 threads");
    }
    check::<2, Spline<PlaneStrain>>(Default::default());
    check::<3, LinearFlip<FullSpace>>(Default::default());
}

#[test]
fn grids_do_not_change_a_bit() {
    let scene = wide::<2>();
    let sparse = fast(Spline::<PlaneStrain>::default(), BlockGrid::new(scene.lattice), &scene, &rubber());
    let dense = DenseGrid::new(scene.lattice, [-9, -17], [47, 40]).expect("box");
    let dense = fast(Spline::<PlaneStrain>::default(), dense, &scene, &rubber());
    assert!(bits(sparse) == bits(dense));
}

#[test]
fn single_precision_is_near_double() {
    let scene = scene::bar::<2>();
    let double = run(Spline::<PlaneStrain>::default(), &scene);
    let moduli = Moduli::young_poisson(YOUNG as f32, 0.3).expect("moduli");
    let law = NeoHookean::<f32>::new(scene::DENSITY as f32, moduli).expect("law");
    let method = Spline::<PlaneStrain>::default().compiled();
    let mut mpm = fast(method, BlockGrid::<f32, 2>::new(scene.lattice), &scene, &law);
    for _ in 0..scene.steps {
        mpm.step().expect("step");
    }
    for (p, q) in particles(&mpm)[0].iter().zip(&double) {
        for d in 0..2 {
            // Tolerance: 40 steps of rounding to 6e-8, positions relative to a cell of 0.1.
            assert!((p.position[d] - q.position[d]).abs() < 1e-6, "{p:?} against {q:?}");
            assert!((p.velocity[d] - q.velocity[d]).abs() < 2e-5, "{p:?} against {q:?}");
        }
        for i in 0..6 {
            assert!((p.stress[i] - q.stress[i]).abs() < 1e-4 * YOUNG, "{p:?} against {q:?}");
        }
    }
}

/// Equal radial and hoop stresses of a body of revolution are in equilibrium: zero force on inner nodes. Two
/// particles per cell integrate r dN/dr + N exactly unless the shape function crosses the axis; for the first node
/// of the spline, the kink of |r| leaves 1/32 of p h^2.
#[test]
fn uniform_stress_of_revolution_is_in_equilibrium() {
    fn check<M: IntoKernels<f64, 2>>(method: M, at_axis: f64) {
        let h = 0.1;
        let lattice = Lattice::new([0.0; 2], h).expect("lattice");
        let mut seeds = block(&lattice, [0, 0], [6, 6], 2, 0.0);
        for (v, x) in seeds.volumes.iter_mut().zip(&seeds.positions) {
            *v *= x[0];
        }
        let (p, q) = (1.7, -0.6);
        let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
        mpm.add("disc", Prestressed::new([p, q, p, 0.0, 0.0, 0.0]).compiled(), &seeds, |_| [0.0; 2])
            .expect("body");
        mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).expect("boundary");
        mpm.set_time_control(TimeControl::Fixed(1e-4)).expect("time control");
        mpm.step().expect("step");
        let (mut first, mut inner, mut edge) = (0.0f64, 0.0f64, 0.0f64);
        for (b, c) in mpm.grid().blocks().iter().enumerate() {
            for (n, node) in mpm.grid().nodes()[b * block_nodes(2)..][..block_nodes(2)].iter().enumerate() {
                let i = c[0] * BLOCK as i32 + (n % BLOCK) as i32;
                let j = c[1] * BLOCK as i32 + (n / BLOCK) as i32;
                // Force: momentum after one step from rest over the step size.
                let force = node.first[0] * node.first[1].abs().max(node.first[2].abs()) / 1e-4;
                let relative = force / (p * h * h);
                if i == 1 && (2..=4).contains(&j) {
                    first = first.max(relative);
                } else if (2..=4).contains(&i) && (2..=4).contains(&j) {
                    inner = inner.max(relative);
                }
                edge = edge.max(force);
            }
        }
        let name = &mpm.facts().description;
        assert!(inner <= 1e-12, "{name}: {inner:e}");
        assert!((first - at_axis).abs() <= 1e-12, "{name}: next to the axis {first:e}");
        assert!(edge > 0.01 * p * h, "{name}: no stress was there");
    }
    check(LinearFlip::<Axisymmetric>::default(), 0.0);
    check(Spline::<Axisymmetric>::default(), 1.0 / 32.0);
}

/// Objective stress rate: hyperelastic and hypoelastic (Jaumann) laws that agree at small strain agree in rotation.
#[test]
fn stress_turns_with_the_body() {
    let lattice = scene::lattice::<2>();
    let c = wave_speed();
    let h = lattice.spacing();
    let seeds = block(&lattice, [0, 0], [5, 3], 2, 0.0);
    let centre = [lattice.node([0, 0])[0] + 2.5 * h, lattice.node([0, 0])[1] + 1.5 * h];
    let dt = 0.2 * h / c;
    let steps = 400;
    let rate = std::f64::consts::FRAC_PI_2 / (f64::from(steps) * dt);
    let velocity = move |x: [f64; 2]| {
        let r = [x[0] - centre[0], x[1] - centre[1]];
        [-rate * r[1] + 0.02 * c * r[0] / h / 2.5, rate * r[0]]
    };
    let scene = Scene {
        name: "turning bar",
        lattice,
        bodies: vec![(seeds, Box::new(velocity))],
        boundaries: vec![],
        gravity: [0.0; 2],
        dt,
        steps: steps as usize,
        space: impactite_tests::reference::Space::Cartesian,
    };
    let mut hypo = fast(Spline::<PlaneStrain>::default(), BlockGrid::new(lattice), &scene, &metal());
    let mut hyper = fast(Spline::<PlaneStrain>::default(), BlockGrid::new(lattice), &scene, &rubber());
    let (mut largest, mut apart) = (0.0f64, 0.0f64);
    for _ in 0..steps {
        hypo.step().expect("step");
        hyper.step().expect("step");
        for (p, q) in particles(&hypo)[0].iter().zip(&particles(&hyper)[0]) {
            for i in 0..6 {
                largest = largest.max(q.stress[i].abs());
                apart = apart.max((p.stress[i] - q.stress[i]).abs());
            }
        }
    }
    println!("largest stress {largest}, difference {apart}");
    assert!(largest > 0.01 * YOUNG, "no stress was there");
    // Tolerance: strains reach 2 %, and the laws differ by about that fraction of the stress (measured 1.1 %).
    assert!(apart < 0.03 * largest, "{apart} of {largest}");
    let angle = {
        let all = particles(&hypo);
        let (a, b) = (&all[0][0].position, &all[0][9].position);
        (b[1] - a[1]).atan2(b[0] - a[0])
    };
    assert!(angle > 1.2, "it turned by {angle}");
}

/// Check of `surround`, which the rotation scene uses: under gravity the centre of mass is in free fall.
#[test]
fn a_stone_falls() {
    let lattice = scene::lattice::<2>();
    let seeds = block(&lattice, [0, 0], [2, 2], 2, 0.3);
    let scene = Scene {
        name: "stone",
        lattice,
        bodies: vec![(seeds.clone(), Box::new(|_| [0.1, 0.0]))],
        boundaries: vec![],
        gravity: [0.0, -2.0],
        dt: 0.01,
        steps: 50,
        space: impactite_tests::reference::Space::Cartesian,
    };
    let mut mpm = Mpm::new(Box2::default(), BlockGrid::new(lattice));
    mpm.add("stone", metal(), &seeds, |_| [0.1, 0.0]).expect("body");
    surround(&mut mpm, &scene);
    for _ in 0..50 {
        mpm.step().expect("step");
    }
    for (p, x) in particles(&mpm)[0].iter().zip(&seeds.positions) {
        assert!((p.velocity[1] + 1.0).abs() < 1e-12 && (p.velocity[0] - 0.1).abs() < 1e-12);
        assert!((p.position[1] - (x[1] - 0.5 * 0.5)).abs() < 1e-12);
        assert!(p.stress.iter().all(|s| s.abs() < 1e-13 * YOUNG), "{:?}", p.stress);
    }
}

/// Particles exactly on a cell face: the far node of the linear shape function has zero weight but non-zero
/// gradient.
#[test]
fn a_particle_on_a_cell_face_feels_nothing() {
    let lattice = Lattice::new([0.0; 2], 1.0).expect("lattice");
    let seeds = block(&lattice, [0, 0], [2, 2], 2, 0.0);
    let mut mpm = Mpm::new(LinearFlip::<PlaneStrain>::default(), BlockGrid::new(lattice));
    mpm.add("block", metal(), &seeds, |_| [2.0, 1.0]).expect("body");
    mpm.set_time_control(TimeControl::Fixed(0.125)).expect("time control");
    for _ in 0..20 {
        mpm.step().expect("step");
        for p in &particles(&mpm)[0] {
            assert!(p.stress.iter().all(|s| s.abs() < 1e-13 * YOUNG), "{p:?}");
        }
    }
}

/// Rigid translation causes no stress at any particle position, also at tiny weights.
#[test]
fn rigid_flight_makes_no_stress() {
    fn check<const D: usize, M: IntoKernels<f64, D>>(method: M, steps: usize) {
        let lattice = scene::lattice::<D>();
        let seeds = block(&lattice, [0; D], [3; D], 2, 0.8);
        let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
        let mut v = [0.0; D];
        for d in 0..D {
            v[d] = 0.5 * (1.0 - 0.3 * d as f64);
        }
        mpm.add("block", rubber(), &seeds, |_| v).expect("body");
        mpm.set_time_control(TimeControl::Fixed(0.3 * 0.1 / wave_speed())).expect("time control");
        for _ in 0..steps {
            mpm.step().expect("step");
        }
        let worst = particles(&mpm)[0].iter().flat_map(|p| p.stress).fold(0.0f64, |a, s| a.max(s.abs()));
        assert!(worst < 1e-13 * YOUNG, "{}: {worst:e}", mpm.facts().description);
    }
    check::<3, Spline<FullSpace>>(Default::default(), 300);
    check::<3, LinearFlip<FullSpace>>(Default::default(), 300);
    check::<2, Box2>(Default::default(), 300);
}
