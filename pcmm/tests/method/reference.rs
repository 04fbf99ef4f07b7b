//! The solver against the plain method, and bitwise identical results for any number of threads.

use crate::common::{Plain, block, copper, every_pair, random, steel};
use impactite_geometry::{Cuboid, Lattice};
use impactite_scene::Solver as _;
use impactite_scene::{Axisymmetric, Boundary, FullSpace, PlaneStrain, Side, TimeControl};
use impactite_simd::Team;
use mpm_materials::Constitutive;
use pcmm::{
    AzimuthFan, Composition, EndOfStep, LocalDelaunay, Masses, Method, Neighbours, OfElement, OfParticles,
    OverlapWeighted, Packing, Particle, ParticleMean, Pcmm, SMALL, StartOfStep,
};

/// Compare positions, velocities and energies of both methods after some steps from a rough velocity field.
fn compare<const D: usize>(method: impl Composition<D>, law: impl Constitutive<f64>, packing: &Packing<D>) {
    let name = method.describe();
    let speed = |x: [f64; D]| {
        let mut v = [0.0; D];
        for d in 0..D {
            v[d] = 40.0 * (3.0e3 * x[(d + 1) % D] + d as f64).sin();
        }
        v
    };
    let mut fast = Pcmm::new(method, law.clone().compiled(), packing, speed, Masses::FromElements).unwrap();
    let mut plain = Plain::of(&fast, law);
    let dt = 0.5 * fast.next_time_step();
    fast.set_time_control(TimeControl::Fixed(dt)).unwrap();
    fast.set_revision_interval(1000).unwrap();
    let steps = 20;
    for n in 1..=steps {
        plain.step(dt);
        fast.step_towards(if n == steps { dt * f64::from(steps) } else { 1.0 }).unwrap();
    }
    assert_eq!(fast.steps(), u64::from(steps as u32), "{name}");
    for (a, b) in fast.particles().iter().zip(&plain.particles) {
        for d in 0..D {
            // Round-off of a few hundred operations a step, with and without fused multiplication.
            let (x, v) = (1e-13 * 1e-2, 1e-9 * 40.0);
            assert!(
                (a.position[d] - b.position[d]).abs() < x,
                "{name}: position off by {:e}",
                a.position[d] - b.position[d]
            );
            assert!((a.velocity[d] - b.velocity[d]).abs() < v, "{name}: {} {}", a.velocity[d], b.velocity[d]);
        }
    }
    let energy: f64 = plain.states.iter().zip(&plain.reference).map(|(s, v)| v * plain.law.energy(s)).sum();
    let internal = fast.totals().internal;
    assert!(energy > 0.0 && (internal / energy - 1.0).abs() < 1e-9, "{name}: {internal} {energy}");
}

#[test]
fn the_fast_step_is_the_plain_one() {
    let h = 1.0e-3;
    let flat = block([0.0; 2], 7, 9, h);
    let ring = block([2.0e-3, 0.0], 7, 9, h);
    let fan = || AzimuthFan::new(0.45 * h).unwrap();
    let delaunay = || LocalDelaunay::new(0.45 * h, 2.0).unwrap();
    compare(Method::printed(PlaneStrain, fan()), copper(), &flat);
    compare(Method::consistent(PlaneStrain, delaunay()), copper(), &flat);
    compare(Method::consistent(Axisymmetric, delaunay()), steel(), &ring);
    compare(Method::new(Axisymmetric, delaunay(), OverlapWeighted, StartOfStep, OfElement), copper(), &ring);
    compare(Method::new(PlaneStrain, delaunay(), ParticleMean, StartOfStep, OfElement), steel(), &flat);
    compare(Method::new(PlaneStrain, fan(), ParticleMean, EndOfStep, OfParticles), steel(), &flat);
    let shape = Cuboid::new([0.0; 3], [3.0 * h, 3.0 * h, 4.0 * h]).unwrap();
    let space = Packing::on_nodes(&shape, &Lattice::new([0.0; 3], h).unwrap()).unwrap();
    let wide = || LocalDelaunay::new(0.75 * h, 2.0).unwrap();
    compare(Method::consistent(FullSpace, wide()), copper(), &space);
    compare(Method::new(FullSpace, wide(), OverlapWeighted, StartOfStep, OfElement), steel(), &space);
}

/// Compare neighbour lists with all pairs while particles wander. Lists include all in range, and none beyond two skins.
fn neighbours_of_wanderers<const D: usize>(particles: usize) {
    let (reach, skin) = (0.02, 0.03);
    let mut list: Vec<Particle<D>> = (0..particles)
        .map(|n| {
            let mut position = [0.0; D];
            for d in 0..D {
                position[d] = random(7, (n * D + d) as u64);
            }
            Particle { position, velocity: [0.0; D], mass: 1.0, radius: 0.01 + 0.03 * random(8, n as u64) }
        })
        .collect();
    let mut neighbours = Neighbours::new(reach, skin);
    for step in 0..40 {
        neighbours.update(&list, &Team::one());
        let (near, far) = (every_pair(&list, reach), every_pair(&list, reach + 2.0 * skin));
        for i in 0..particles {
            let found = neighbours.of(i);
            assert!(found.is_sorted());
            assert!(near[i].iter().all(|j| found.contains(j)), "step {step}: a neighbour of {i} is missing");
            assert!(found.iter().all(|j| far[i].contains(j)), "step {step}: {i} has one out of range");
        }
        for (n, p) in list.iter_mut().enumerate() {
            for d in 0..D {
                // One particle flies off, so that the cells must grow.
                let speed = if n == 0 { 3.0 } else { 0.004 };
                p.position[d] += speed * (random(step, (n * D + d) as u64) - 0.5);
            }
        }
    }
    let searches = neighbours.searches();
    assert!(searches > 1, "{searches} searches");
}

#[test]
fn the_search_finds_every_pair() {
    neighbours_of_wanderers::<2>(300);
    neighbours_of_wanderers::<3>(300);
}

#[test]
fn lists_are_kept_while_nothing_moves_far() {
    let at = |x: f64| Particle { position: [x, 0.0], velocity: [0.0; 2], mass: 1.0, radius: 0.5 };
    let mut neighbours = Neighbours::new(0.0, 0.2);
    for step in 0..20 {
        neighbours.update(&[at(0.0), at(0.9), at(1.9 + 0.02 * f64::from(step))], &Team::one());
    }
    // Half the skin is 0.1: a search at the start and one after every seven steps of 0.02, of which a third is the mean motion of all.
    assert_eq!(neighbours.searches(), 3);
}

#[test]
fn particles_that_no_search_can_use_have_no_neighbours_and_a_reason() {
    let at = |x: f64| Particle { position: [x, 0.0], velocity: [0.0; 2], mass: 1.0, radius: 0.5 };
    let mut neighbours = Neighbours::new(0.1, 0.2);
    let mut update = |x: f64| {
        neighbours.update(&[at(0.0), at(1.0), at(x)], &Team::one());
        (neighbours.of(0).len(), neighbours.refused().map(|e| e.to_string()))
    };
    assert_eq!(update(5.0), (1, None));
    let said = "search: x of point 2 = NaN is not allowed; it must be finite, between -1e150 and 1e150";
    assert_eq!(update(f64::NAN), (0, Some(said.into())));
    assert_eq!(update(5.0), (1, None));
    let mut none = Neighbours::new(-1.0, 0.2);
    none.update(&[at(0.0), at(0.1)], &Team::one());
    assert!(none.of(0).is_empty() && none.refused().is_some());
}

/// Run a bar that hits a wall, with revisions. Return the bits of all particles after some steps.
fn bits(threads: usize, printed: bool) -> Vec<u64> {
    let h = 1.0e-4;
    let packing = block([0.0; 2], 24, 119, h);
    assert!(packing.positions.len() >= SMALL, "too few particles for threads");
    let wall = Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 };
    fn run<M: Composition<2>>(
        method: M,
        packing: &Packing<2>,
        wall: Boundary<2>,
        threads: usize,
    ) -> Vec<u64> {
        let mut bar = Pcmm::new(method, copper(), packing, |_| [30.0, -900.0], Masses::FromElements).unwrap();
        bar.bound(wall).unwrap();
        bar.set_team(Team::new(threads).unwrap());
        bar.set_revision_interval(5).unwrap();
        for _ in 0..200 {
            bar.step_towards(1.0).unwrap();
        }
        assert!(bar.audit().created.elements > 20, "{:?}", bar.audit());
        let mut list: Vec<u64> = bar
            .particles()
            .iter()
            .flat_map(|p| p.position.into_iter().chain(p.velocity))
            .map(f64::to_bits)
            .collect();
        list.extend(bar.element_nodes().iter().map(|&n| u64::from(n)));
        list.extend([bar.totals().internal.to_bits(), bar.exchange().impulse[1].to_bits()]);
        list
    }
    if printed {
        run(Method::printed(PlaneStrain, AzimuthFan::new(h).unwrap()), &packing, wall, threads)
    } else {
        run(
            Method::consistent(PlaneStrain, LocalDelaunay::new(0.45 * h, 10.0).unwrap()),
            &packing,
            wall,
            threads,
        )
    }
}

#[test]
fn equal_bits_for_any_number_of_threads() {
    for printed in [true, false] {
        let one = bits(1, printed);
        for threads in 2..=4 {
            assert_eq!(one, bits(threads, printed), "{threads} threads, printed {printed}");
        }
    }
}
