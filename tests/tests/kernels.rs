//! Bitwise equality of kernels wherever they are compiled: law called or inlined into the passes, in the library or in this
//! crate, dispatched at compile time or at run time.

use std::sync::Arc;

use impactite_tests::compare::{fast, particles, surround};
use impactite_tests::scene::{self, block, lattice, metal, rubber, wave_speed};
use mpm_core::geometry::{Ball, Filling, Lattice, fill};
use mpm_core::{
    Apic, Blend, BlockGrid, Composition, Deformable, Flip, FullSpace, GridStorage, IntoKernels, Linear,
    Method, Mpm, Musl, OneField, PlaneStrain, PointView, QuadraticBSpline, Usl,
};
use mpm_core::{ContactAlgorithm, SceneError};
use mpm_materials::{Constitutive, IntoMaterial, JohnsonCook, Material, MieGruneisen, Solid, library};

/// Return the particles of the scene `flow` after its steps, for a law with this sound speed.
fn flown<const D: usize, M, C>(method: M, law: C, sound: f64, inlined: bool) -> Vec<PointView>
where
    M: Composition<f64, D> + IntoKernels<f64, D>,
    C: Constitutive<f64> + IntoMaterial<f64, Law = C>,
{
    let mut scene = scene::flow::<D>();
    let faster = sound / wave_speed();
    scene.dt /= faster;
    let (seeds, velocity) = &scene.bodies[0];
    let mut mpm = Mpm::new(method, BlockGrid::new(scene.lattice));
    let mut body = Deformable::new("block", law, seeds).moving(|x| velocity(x).map(|v| faster * v));
    if inlined {
        body = body.inlined(method);
    }
    mpm.add_body(body).expect("body");
    surround(&mut mpm, &scene);
    for _ in 0..scene.steps {
        mpm.step().expect("step");
    }
    assert_eq!(mpm.steps(), 40);
    particles(&mpm).remove(0)
}

fn bits(particles: &[PointView]) -> Vec<u64> {
    let mut list = vec![];
    for p in particles {
        let numbers = p.position.iter().chain(&p.velocity).chain(&p.stress).chain(&p.state);
        list.extend(numbers.map(|x| x.to_bits()));
    }
    list
}

/// Return the largest stress component.
fn strongest(particles: &[PointView]) -> f64 {
    particles.iter().flat_map(|p| p.stress).fold(0.0, |most, s| most.max(s.abs()))
}

fn alike<const D: usize, M: Composition<f64, D> + IntoKernels<f64, D>>(method: M) {
    let name = method.describe();
    let [called, inlined] = [false, true].map(|inlined| flown(method, metal(), wave_speed(), inlined));
    assert!(strongest(&called) > 0.02 * scene::YOUNG, "{name}: no stress was there: {}", strongest(&called));
    assert!(bits(&called) == bits(&inlined), "{name}, elastic");
    let copper = Solid::new(JohnsonCook::<f64>::copper_taylor(), MieGruneisen::copper());
    let sound = copper.wave_speed(&copper.virgin());
    let [called, inlined] = [false, true].map(|inlined| flown(method, copper, sound, inlined));
    let yielded = called.iter().map(|p| p.state[8]).fold(0.0, f64::max);
    assert!(yielded > 0.01, "{name}: plastic strain {yielded}");
    assert!(bits(&called) == bits(&inlined), "{name}, copper");
}

#[test]
fn inlined_laws_plane_hats() {
    alike::<2, _>(Method::new(Linear, Flip, Musl, PlaneStrain));
}

#[test]
fn inlined_laws_solid_hats() {
    alike::<3, _>(Method::new(Linear, Flip, Musl, FullSpace));
}

#[test]
fn inlined_laws_plane_splines() {
    alike::<2, _>(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain));
}

#[test]
fn inlined_laws_solid_splines() {
    alike::<3, _>(Method::new(QuadraticBSpline, Apic, Usl, FullSpace));
}

/// Vector lanes are independent. Every bin of a squeezed and rotated ball has a different number of particles, so that some
/// groups are alone and some lanes idle; some points yield and others do not.
#[test]
fn inlined_laws_in_any_company() {
    let method = Method::new(Linear, Flip, Musl, FullSpace);
    let h = 0.4e-3;
    let lattice = Lattice::new([0.1e-3, -0.2e-3, 0.05e-3], h).expect("lattice");
    let ball = Ball::new([0.0; 3], 5.0 * h).expect("ball");
    let seeds = fill(&ball, &lattice, 2, &Filling::new()).expect("seeds");
    let [called, inlined] = [false, true].map(|inlined| {
        let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
        let law = library::tungsten_alloy::<f64>();
        let body = Deformable::new("ball", law, &seeds);
        let body = body.moving(|x| [2e4 * x[1] - 3e4 * x[0], 4e4 * x[2], 30.0]);
        mpm.add_body(if inlined { body.inlined(method) } else { body }).expect("body");
        for _ in 0..40 {
            mpm.step().expect("step");
        }
        particles(&mpm).remove(0)
    });
    let flowing = called.iter().filter(|p| p.state[8] > 0.0).count();
    assert!((1..called.len()).contains(&flowing), "{flowing} of {} flow", called.len());
    assert!(bits(&called) == bits(&inlined));
}

/// A library method and law compiled in this crate give the same bits as a scene of trait objects.
#[test]
fn objects_change_nothing() {
    let scene = scene::bar::<2>();
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let grid = || BlockGrid::new(scene.lattice);
    let run = |mut mpm: Mpm<2>| {
        for _ in 0..scene.steps {
            mpm.step().expect("step");
        }
        bits(&particles(&mpm).remove(0))
    };
    let library = run(fast(method, grid(), &scene, &rubber()));
    assert!(library == run(fast(method.compiled(), grid(), &scene, &rubber().compiled())), "compiled here");
    let law: Arc<dyn Material<f64>> = rubber().into_material();
    let grid: Box<dyn GridStorage<f64, 2>> = Box::new(grid());
    let contact: Arc<dyn ContactAlgorithm<f64, 2>> = Arc::new(OneField);
    let mut objects = Mpm::of(method.into_kernels(), grid, contact);
    objects.add("body 0", law, &scene.bodies[0].0, &scene.bodies[0].1).expect("body");
    surround(&mut objects, &scene);
    assert!(library == run(objects), "objects");
}

/// A body is refused if its kernels with an inlined law belong to another method.
#[test]
fn kernels_of_another_method_are_refused() {
    let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice()));
    let seeds = block(&lattice(), [0; 2], [2; 2], 2, 0.0);
    let splines = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let refused = mpm.add_body(Deformable::new("block", metal(), &seeds).inlined(splines));
    assert!(matches!(&refused, Err(SceneError::OtherMethod { body, .. }) if body == "block"), "{refused:?}");
    assert!(mpm.bodies().is_empty(), "a refused body is not there");
    // Same method, with another time constant.
    let blend = |tau| Method::new(Linear, Blend::new(tau).expect("time constant"), Musl, PlaneStrain);
    let mut mpm = Mpm::new(blend(1e-3), BlockGrid::new(lattice()));
    let refused = mpm.add_body(Deformable::new("block", metal(), &seeds).inlined(blend(2e-3)));
    assert!(matches!(&refused, Err(SceneError::OtherMethod { .. })), "{refused:?}");
    mpm.add_body(Deformable::new("block", metal(), &seeds).inlined(blend(1e-3))).expect("its own");
}
