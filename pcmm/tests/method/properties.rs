//! Properties of the tessellations and of the method on random scenes.

use crate::common::{block, copper, random, steel, thrown, turning_steel};
use impactite_geometry::{Cuboid, Lattice};
use impactite_scene::Solver as _;
use impactite_scene::{Axisymmetric, FullSpace, PlaneStrain};
use mpm_materials::{
    Constitutive, Elastic, MieGruneisen, NoFailure, NoViscosity, ObjectiveRate, Solid, Sym3,
};
use pcmm::simplex::{overlap, volume};
use pcmm::{
    AzimuthFan, Composition, EndOfStep, LocalDelaunay, Masses, Method, NoRotation, OfElement,
    OverlapWeighted, Packing, ParticleMean, Pcmm, StartOfStep,
};
use proptest::prelude::*;

/// Return the area (volume) of the elements, and the part of it that is covered twice.
fn cover<const D: usize>(solver: &Pcmm<D, impl Composition<D>>) -> (f64, f64) {
    let corners: Vec<[[f64; D]; 4]> = solver
        .element_nodes()
        .chunks_exact(D + 1)
        .map(|nodes| {
            let mut x = [[0.0; D]; 4];
            for (a, &n) in nodes.iter().enumerate() {
                x[a] = solver.particles()[n as usize].position;
            }
            x
        })
        .collect();
    let whole = corners.iter().map(|x| volume(x, false)).sum();
    let mut double = 0.0;
    for (k, x) in corners.iter().enumerate() {
        double += corners[..k].iter().map(|y| overlap(x, y, false)).sum::<f64>();
    }
    (whole, double)
}

fn ours(packing: &Packing<2>, tolerance: f64) -> Pcmm<2, impl Composition<2>> {
    let method = Method::consistent(PlaneStrain, LocalDelaunay::new(tolerance, 2.0).unwrap());
    Pcmm::new(method, steel().compiled(), packing, |_| [0.0; 2], Masses::FromElements).unwrap()
}

#[test]
fn a_square_lattice_is_covered_once_by_ours_and_twice_as_printed() {
    let h = 0.1;
    for (nx, ny) in [(1, 1), (5, 8), (12, 7)] {
        let packing = block([0.3, -0.2], nx, ny, h);
        let area = f64::from(nx * ny) * h * h;
        // Tolerances up to the next but one particle.
        for tolerance in [0.42 * h, 0.6 * h, 1.1 * h] {
            let (whole, double) = cover(&ours(&packing, tolerance));
            assert!((whole / area - 1.0).abs() < 1e-12 && double < 1e-12 * area, "{whole} {double} {area}");
            let method = Method::printed(PlaneStrain, AzimuthFan::new(tolerance).unwrap());
            let printed =
                Pcmm::new(method, steel().compiled(), &packing, |_| [0.0; 2], Masses::FromElements).unwrap();
            let (whole, double) = cover(&printed);
            assert!((whole / area - 2.0).abs() < 1e-12, "{whole} {area}");
            assert!((double / area - 1.0).abs() < 1e-9, "{double} {area}");
            assert!((printed.totals().mass / (7850.0 * area) - 2.0).abs() < 1e-12);
        }
    }
}

#[test]
fn volumes_given_make_up_for_a_double_cover() {
    let h = 0.1;
    let mut packing = block([0.0; 2], 6, 9, h);
    // Corner, edge and inner particles of the lattice.
    let inside = |x: f64, n: f64| if x < 0.5 * h || x > (n - 0.5) * h { 0.5 } else { 1.0 };
    packing.volumes =
        packing.positions.iter().map(|x| h * h * inside(x[0], 6.0) * inside(x[1], 9.0)).collect();
    let method = Method::printed(PlaneStrain, AzimuthFan::new(0.45 * h).unwrap());
    let solver = Pcmm::new(method, steel().compiled(), &packing, |_| [0.0; 2], Masses::FromVolumes).unwrap();
    let (totals, coverage) = (solver.totals(), solver.coverage());
    let mass = 7850.0 * 54.0 * h * h;
    assert!((totals.mass / mass - 1.0).abs() < 1e-12);
    assert!((coverage.mass / mass - 1.0).abs() < 1e-12, "{} {mass}", coverage.mass);
    assert!((coverage.volume / (2.0 * 54.0 * h * h) - 1.0).abs() < 1e-12);
}

#[test]
fn a_cubic_lattice_is_filled_once() {
    let h = 0.1;
    let shape = Cuboid::new([0.0; 3], [3.0 * h, 2.0 * h, 4.0 * h]).unwrap();
    let packing = Packing::on_nodes(&shape, &Lattice::new([0.0; 3], h).unwrap()).unwrap();
    let method = Method::consistent(FullSpace, LocalDelaunay::new(0.75 * h, 2.0).unwrap());
    let solver = Pcmm::new(method, steel().compiled(), &packing, |_| [0.0; 3], Masses::FromElements).unwrap();
    let (whole, double) = cover(&solver);
    assert_eq!(solver.elements(), 6 * 24);
    assert!((whole / (24.0 * h * h * h) - 1.0).abs() < 1e-12 && double < 1e-12, "{whole} {double}");
}

#[test]
fn a_triangular_lattice_is_covered_once_by_both() {
    let h = 0.1;
    let mut positions = Vec::new();
    for j in 0..8 {
        for i in 0..9 {
            positions.push([h * (f64::from(i) + 0.5 * f64::from(j % 2)), h * 0.75f64.sqrt() * f64::from(j)]);
        }
    }
    let radii = vec![0.5 * h; positions.len()];
    let packing = Packing::of_spheres(positions, radii);
    let (whole, double) = cover(&ours(&packing, 0.1 * h));
    let method = Method::printed(PlaneStrain, AzimuthFan::new(0.1 * h).unwrap());
    let printed =
        Pcmm::new(method, steel().compiled(), &packing, |_| [0.0; 2], Masses::FromElements).unwrap();
    let (as_printed, under) = cover(&printed);
    // Seven rows of sixteen triangles; half triangles at alternating ends are missing.
    let area = 7.0 * 16.0 * 0.75f64.sqrt() / 2.0 * h * h;
    for (whole, double) in [(whole, double), (as_printed, under)] {
        assert!((whole / area - 1.0).abs() < 0.08 && double < 1e-12, "{whole} {double} {area}");
    }
    assert!((whole / as_printed - 1.0).abs() < 1e-12, "{whole} {as_printed}");
}

#[test]
fn a_random_packing_has_no_holes_inside() {
    for seed in 0..4 {
        let packing = thrown(seed, 0.015, 0.03, 4000);
        let inside = Cuboid::new([0.1; 2], [0.9; 2]).unwrap();
        let solver = ours(&packing, 0.06);
        let (_, double) = cover(&solver);
        assert!(double < 1e-12, "{double}");
        // Area of the elements within the inner square.
        let square =
            [[[0.1, 0.1], [0.9, 0.1], [0.9, 0.9], [0.0; 2]], [[0.1, 0.1], [0.9, 0.9], [0.1, 0.9], [0.0; 2]]];
        let mut covered = 0.0;
        for nodes in solver.element_nodes().chunks_exact(3) {
            let x = |a: usize| solver.particles()[nodes[a] as usize].position;
            let element = [x(0), x(1), x(2), [0.0; 2]];
            covered += square.iter().map(|s| overlap(s, &element, false)).sum::<f64>();
        }
        let _ = inside;
        assert!((covered / 0.64 - 1.0).abs() < 1e-9, "seed {seed}: {covered} of 0.64 is covered");
    }
}

/// Spin a square as a rigid body with the stresses of its rotation. Return the largest equivalent stress and the energy error.
fn spin(method: impl Composition<2>, law: impl Constitutive<f64>, turns: f64) -> (f64, f64) {
    let h = 1.0e-3;
    let packing = block([-5.0 * h, -5.0 * h], 10, 10, h);
    let omega = 4.0e3;
    let mut body =
        Pcmm::new(method, law.compiled(), &packing, |[x, y]| [-omega * y, omega * x], Masses::FromElements)
            .unwrap();
    body.set_revision_interval(20).unwrap();
    let start = body.totals();
    body.run_until(turns * std::f64::consts::TAU / omega).unwrap();
    let end = body.totals();
    let error = (end.angular_momentum[2] / start.angular_momentum[2] - 1.0).abs();
    assert!(error < 1e-11, "angular momentum is off by {error:e}");
    let strongest = (0..body.elements())
        .filter_map(|e| body.describe_element(e))
        .map(|said| Sym3(said.stress).equivalent())
        .fold(0.0, f64::max);
    (strongest, (end.kinetic + end.internal) / (start.kinetic + start.internal) - 1.0)
}

#[test]
fn without_rotation_of_stress_a_spinning_body_is_wrong() {
    let h = 1.0e-3;
    let ours = || LocalDelaunay::new(0.45 * h, 2.0).unwrap();
    let centrifugal = 7850.0 * (4.0e3f64 * 5.0e-3).powi(2);
    let method = || Method::consistent(PlaneStrain, ours());
    let (turned, energy) = spin(method(), turning_steel(), 1.0);
    assert!(turned < 1.5 * centrifugal && energy.abs() < 1e-5, "{turned:e} {energy:e}");
    let (jaumann, energy) = spin(method(), steel(), 1.0);
    assert!(jaumann < 1.5 * centrifugal && energy.abs() < 1e-5, "{jaumann:e} {energy:e}");
    // Residual stress must rotate with the body to stay in balance.
    let (turned, stuck) = (locked_in(turning_steel()), locked_in(steel().with_rate(NoRotation)));
    assert!(turned < 0.02 && stuck > 0.1, "{turned} {stuck}");
}

type Steel<R> = Solid<Elastic<f64>, MieGruneisen<f64>, NoFailure, NoViscosity, R>;

/// Spin a ring by a quarter turn with residual stress in balance, sigma_r = S 4 (r - a)(b - r) / (b - a)^2 and sigma_t = d(r sigma_r)/dr.
/// Return the deviation of the element stresses from the rotated one, over its size.
fn locked_in<R: ObjectiveRate>(law: Steel<R>) -> f64 {
    let h = 1.0e-3;
    let (inner, outer) = (8.0 * h, 16.0 * h);
    let mut positions = Vec::new();
    for layer in 0..=8 {
        let r = inner + h * f64::from(layer);
        for k in 0..72 {
            let angle = std::f64::consts::TAU * (f64::from(k) + 0.5 * f64::from(layer % 2)) / 72.0;
            positions.push([r * angle.cos(), r * angle.sin()]);
        }
    }
    let radii = vec![0.5 * h; positions.len()];
    let packing = Packing::of_spheres(positions, radii);
    let residual = |[x, y]: [f64; 2]| {
        let r = x.hypot(y);
        let scale = 4.0 * 200e6 / (outer - inner).powi(2);
        let radial = scale * (r - inner) * (outer - r);
        let hoop = radial + r * scale * (inner + outer - 2.0 * r);
        let (c, s) = (x / r, y / r);
        let (xx, yy) = (radial * c * c + hoop * s * s, radial * s * s + hoop * c * c);
        Sym3([xx, yy, 0.0, 0.0, 0.0, (radial - hoop) * c * s])
    };
    let omega = 2.0e3;
    let method = Method::consistent(PlaneStrain, LocalDelaunay::new(h, 2.0).unwrap());
    let spin = |[x, y]: [f64; 2]| [-omega * y, omega * x];
    let mut body = Pcmm::new(method, law.compiled(), &packing, spin, Masses::FromElements).unwrap();
    body.set_revision_interval(100).unwrap();
    body.set_states::<Steel<R>>(|x, mut state| {
        state.stress = residual(x);
        // Volume at which the equation of state has this pressure: K = rho0 c0^2, to first order.
        state.volume_ratio = 1.0 + residual(x).mean() / (7850.0 * 4500.0 * 4500.0);
        state
    })
    .unwrap();
    body.run_until(std::f64::consts::FRAC_PI_2 / omega).unwrap();
    let (mut off, mut size) = (0.0, 0.0);
    for (e, nodes) in body.element_nodes().chunks_exact(3).enumerate() {
        let mut centre = [0.0; 2];
        for &n in nodes {
            for d in 0..2 {
                centre[d] += body.particles()[n as usize].position[d] / 3.0;
            }
        }
        let wanted = residual(centre).deviator();
        let now = Sym3(body.describe_element(e).unwrap().stress).deviator();
        off += (now + wanted * -1.0).equivalent();
        size += wanted.equivalent();
    }
    off / size
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Random circles, random velocities: no double coverage at the start or after a while; mass is that of the particles to the bit;
    /// momentum and angular momentum to rounding; energy within the audit of revisions.
    #[test]
    fn conservation_on_random_packings(seed in 0u64..10_000, speed in 1.0f64..300.0) {
        let packing = thrown(seed, 0.02, 0.04, 600);
        let method = Method::consistent(PlaneStrain, LocalDelaunay::new(0.06, 3.0).unwrap());
        let velocity = |x: [f64; 2]| {
            let place = (x[0] * 1e6) as u64;
            [speed * (random(seed + 1, place) - 0.5), speed * (random(seed + 2, place) - 0.5)]
        };
        let mut volumes = packing.clone();
        volumes.volumes = packing.radii.iter().map(|r| 4.0 * r * r).collect();
        let mut solver = Pcmm::new(method, copper(), &volumes, velocity, Masses::FromVolumes).unwrap();
        let (start, covered) = (solver.totals(), solver.coverage().mass);
        for _ in 0..150 {
            solver.step_towards(1.0).unwrap();
        }
        let end = solver.totals();
        prop_assert_eq!(start.mass, end.mass);
        for d in 0..3 {
            prop_assert!((end.momentum[d] - start.momentum[d]).abs() < 1e-12 * start.momentum_scale);
            let moment = (end.angular_momentum[d] - start.angular_momentum[d]).abs();
            prop_assert!(moment < 1e-12 * start.momentum_scale, "{moment}");
        }
        let (_, double) = cover(&solver);
        prop_assert!(double < 1e-9, "{double} is covered twice");
        // Material is in elements or in stores.
        let audit = solver.audit();
        let whole = solver.coverage().mass + audit.stored_mass - audit.mass_added();
        prop_assert!((whole - covered).abs() < 1e-12 * start.mass, "{whole} of {covered}");
        let error = end.kinetic + end.internal - solver.audit().energy_added() - start.kinetic;
        // Leapfrog: velocities are half a step from stresses; a tenth of the energy may oscillate within a step in this roughest of fields,
        // where every particle moves independently.
        prop_assert!(error.abs() < 0.1 * start.kinetic, "{error} of {}", start.kinetic);
    }

    /// A rigid rotation of any size in one step causes no strain for increments of the start of the step, and strain of second order for
    /// those of its end.
    #[test]
    fn rotation_gives_no_strain(angle in -0.5f64..0.5, seed in 0u64..1000) {
        let h = 1.0e-3;
        let packing = {
            let mut p = block([0.0; 2], 4, 4, h);
            for (n, x) in p.positions.iter_mut().enumerate() {
                for d in 0..2 {
                    x[d] += 0.2 * h * (random(seed, (2 * n + d) as u64) - 0.5);
                }
            }
            p
        };
        // Velocity of every particle along a chord to its rotated place.
        let dt = 1.0e-8;
        let (s, c) = angle.sin_cos();
        let chord = |[x, y]: [f64; 2]| [((c - 1.0) * x - s * y) / dt, (s * x + (c - 1.0) * y) / dt];
        let stress = |start: bool| {
            let delaunay = LocalDelaunay::new(0.8 * h, 2.0).unwrap();
            macro_rules! one {
                ($g:expr) => {{
                    let method = Method::new(PlaneStrain, delaunay, OverlapWeighted, $g, OfElement);
                    let mut body =
                        Pcmm::new(method, turning_steel().compiled(), &packing, chord, Masses::FromElements).unwrap();
                    body.set_time_control(impactite_scene::TimeControl::Fixed(dt)).unwrap();
                    body.step_towards(1.0).unwrap();
                    let of = |e: usize| Sym3(body.describe_element(e).unwrap().stress);
                    (0..body.elements()).map(|e| of(e).equivalent() + of(e).mean().abs()).fold(0.0, f64::max)
                }};
            }
            match start {
                false => one!(EndOfStep),
                true => one!(StartOfStep),
            }
        };
        let modulus = 206e9;
        // Rounding: positions of 1e-3 m to 1e-19, so strains to 1e-15 times a condition number of ten.
        prop_assert!(stress(true) < 1e-13 * modulus, "{}", stress(true));
        // An increment that is not of the start of the step has a strain of the square of the rotation.
        let strain = stress(false) / modulus;
        prop_assert!(strain <= 6.0 * angle * angle, "{strain}");
        prop_assert!(angle.abs() < 0.01 || strain > 0.2 * angle * angle, "{strain}");
    }

    /// Exchanges of diagonals conserve mass, energy and volume.
    #[test]
    fn exchanges_conserve(shear in 0.5f64..2.5, seed in 0u64..1000) {
        let h = 1.0e-3;
        let packing = block([0.0; 2], 6, 6, h);
        let delaunay = LocalDelaunay::new(0.45 * h, 10.0).unwrap();
        let method = Method::new(PlaneStrain, delaunay, OverlapWeighted, StartOfStep, OfElement);
        let rate = 2.0e5;
        let speed = |[_, y]: [f64; 2]| [rate * (y - 3.0 * h) * (1.0 + 0.1 * random(seed, 3)), 0.0];
        let mut body = Pcmm::new(method, copper(), &packing, speed, Masses::FromElements).unwrap();
        let (before, covered) = (body.totals(), body.coverage().mass);
        body.run_until(shear / rate).unwrap();
        let (after, audit) = (body.coverage().mass, body.audit());
        prop_assert!((after / covered - 1.0).abs() < 1e-12, "{after} {covered}");
        prop_assert!(audit.energy_added().abs() < 1e-12 * before.kinetic);
        prop_assert!(audit.mass_added().abs() < 1e-12 * before.mass);
        if shear > 2.0 {
            prop_assert!(audit.removed.elements > 0, "nothing was exchanged at a shear of {shear}");
        }
    }
}

/// The audit equals the changes of internal energy and mass: many steps without a revision, then one alone, in a step too short for other
/// changes.
fn the_audit_closes(method: impl Composition<2>) {
    let packing = block([0.0; 2], 8, 8, 1.0e-3);
    let speed = |[x, y]: [f64; 2]| [60.0 * (3.0e3 * y).sin() + 4.0e4 * x, -150.0 * (2.5e3 * x).cos()];
    let mut body = Pcmm::new(method, copper(), &packing, speed, Masses::FromElements).unwrap();
    body.set_revision_interval(1_000_000).unwrap();
    body.run_until(3.0e-6).unwrap();
    let (before, covered) = (body.totals(), body.coverage().mass);
    body.set_revision_interval(1).unwrap();
    body.set_time_control(impactite_scene::TimeControl::Fixed(1e-20)).unwrap();
    body.step_towards(1.0).unwrap();
    let (after, audit) = (body.totals(), *body.audit());
    assert!(audit.removed.elements > 0 && audit.stored_energy != 0.0, "{audit:?}");
    let energy = after.internal - before.internal - audit.energy_added();
    // Rounding of sums of hundreds of terms.
    assert!(energy.abs() < 1e-12 * before.internal, "{energy} of {}", before.internal);
    assert_eq!(body.coverage().stored, audit.stored_energy);
    let mass = body.coverage().mass + audit.stored_mass - covered - audit.mass_added();
    assert!(mass.abs() < 1e-12 * before.mass, "{mass} of {}", before.mass);
    // No energy without a source, except for shared parts of overlapping elements.
    assert!(audit.energy_added() > -1e-12 * before.internal, "{audit:?}");
}

#[test]
fn the_audit_closes_for_both_tessellations() {
    let h = 1.0e-3;
    the_audit_closes(Method::consistent(PlaneStrain, LocalDelaunay::new(0.45 * h, 1.0).unwrap()));
    the_audit_closes(Method::printed(PlaneStrain, AzimuthFan::new(0.45 * h).unwrap()));
}

#[test]
fn the_mean_of_particles_neither_keeps_mass_nor_energy() {
    // Reason for another rule: the same sheared block with the original inheritance.
    let h = 1.0e-3;
    let packing = block([0.0; 2], 6, 6, h);
    let method = Method::new(
        PlaneStrain,
        LocalDelaunay::new(0.45 * h, 10.0).unwrap(),
        ParticleMean,
        StartOfStep,
        OfElement,
    );
    let rate = 2.0e5;
    let speed = |[_, y]: [f64; 2]| [rate * (y - 3.0 * h), 0.0];
    let mut body = Pcmm::new(method, copper(), &packing, speed, Masses::FromElements).unwrap();
    body.run_until(2.5 / rate).unwrap();
    let audit = body.audit();
    assert!(audit.removed.elements > 0);
    assert!((audit.energy_added() / audit.removed.energy).abs() > 1e-6, "{audit:?}");
}

#[test]
fn a_free_ring_keeps_its_momentum_along_the_axis() {
    let h = 1.0e-3;
    let packing = block([3.0 * h, 0.0], 6, 8, h);
    let method = Method::consistent(Axisymmetric, LocalDelaunay::new(0.45 * h, 3.0).unwrap());
    let speed = |[x, y]: [f64; 2]| [30.0 * (800.0 * y).sin(), 50.0 + 40.0 * (900.0 * x).cos()];
    let mut ring = Pcmm::new(method, copper(), &packing, speed, Masses::FromElements).unwrap();
    let start = ring.totals();
    // Pappus: 2 pi times area times radius of the centroid; here per radian.
    let volume = 48.0 * h * h * 6.0 * h;
    assert!((start.mass / (8930.0 * volume) - 1.0).abs() < 1e-12);
    ring.run_until(5.0e-6).unwrap();
    let end = ring.totals();
    assert!((end.momentum[1] - start.momentum[1]).abs() < 1e-12 * start.momentum_scale);
    let energy = (end.kinetic + end.internal) / start.kinetic - 1.0;
    assert!(energy.abs() < 5e-3, "{energy}");
}
