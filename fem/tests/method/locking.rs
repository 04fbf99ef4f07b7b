//! Volumetric locking and hourglass modes.

use fem::{Fem, Hourglass, MeshBody, Technology};
use impactite_geometry::ElementKind::{self, Hexa8, Quad4, Tetra4, Triangle3};
use impactite_scene::{Finding, FullSpace, PlaneStrain, Solver};
use nalgebra::DMatrix;

use crate::common::{elastic, mesh};
use crate::gates::beam_frequency;

const SPRINGS: Technology = Technology::OnePoint(Hourglass::Stiffness(0.05));

/// Frequency of the beam of problem C: proportional to sqrt(E / (1 - nu^2)) (Euler and Bernoulli), 3.9210 Hz at nu = 0.3975.
#[test]
fn beams_that_keep_their_volume_do_not_lock() {
    for (kind, technology, counts, nu, most) in [
        (Quad4, SPRINGS, [20, 4], 0.4999, 0.04),
        (Quad4, Technology::MeanDilatation, [20, 4], 0.4999, 0.04),
        (Triangle3, Technology::AveragedVolumes, [40, 8], 0.49, 0.06),
    ] {
        let f = 3.9210 * ((1.0 - 0.3975f64.powi(2)) / (1.0 - f64::powi(nu, 2))).sqrt();
        let found = beam_frequency(kind, technology, counts, nu, f);
        println!(
            "nu {nu}: {kind:?} {technology:?}: {found:.4} of {f:.4} Hz, {:+.2} %",
            100.0 * (found / f - 1.0)
        );
        assert!((found / f - 1.0).abs() < most, "{kind:?} {technology:?}: {found}");
    }
}

/// Number of stiff (volume-changing) modes of a cube of 2 x 2 x 2 boxes at nu = 0.49999.
fn constraints(kind: ElementKind, technology: Technology) -> usize {
    let cube = mesh(kind, [0.0; 3], [2.0; 3], [2; 3]);
    let n = cube.nodes.len() * 3;
    let (small, dt) = (1e-6, 1e-3);
    let mut k = DMatrix::zeros(n, n);
    for column in 0..n {
        let mut fem = Fem::new(FullSpace);
        fem.add(MeshBody::new("cube", cube.clone(), elastic(1.0, 1.0, 0.49999)).with(kind, technology))
            .unwrap();
        let mut trial = fem.trial(dt).unwrap();
        let mut impulse = [0.0; 3];
        impulse[column % 3] = trial.bodies()[0].nodes()[column / 3].mass * small / dt;
        trial.body_mut(0).add_impulse(column / 3, impulse);
        trial.finish().unwrap();
        for row in 0..n {
            k[(row, column)] = -fem.body(0).force(row / 3)[row % 3] / small;
        }
    }
    let symmetric = (&k + k.transpose()) * 0.5;
    // Shear moduli are of order 1, bulk moduli of order 1e4.
    symmetric.symmetric_eigenvalues().iter().filter(|x| **x > 30.0).count()
}

#[test]
fn volumes_hold_no_more_motions_than_there_are_elements_or_nodes() {
    let counts = [
        constraints(Hexa8, SPRINGS),
        constraints(Hexa8, Technology::MeanDilatation),
        constraints(Tetra4, Technology::AveragedVolumes),
        constraints(Hexa8, Technology::Full),
        constraints(Tetra4, Technology::Full),
    ];
    println!("stiff motions of 81: {counts:?}");
    assert!(counts[0] <= 8 && counts[1] <= 8 && counts[2] <= 27, "{counts:?}");
    // Locking elements: more than a third of all modes are stiff.
    assert!(counts[3] > 27 && counts[4] > 27, "{counts:?}");
}

/// Plate with a load on one node, which excites hourglass modes.
fn point_load(hourglass: Hourglass) -> (f64, f64, Vec<String>) {
    let mut fem = Fem::new(PlaneStrain);
    let plate = mesh(Quad4, [0.0; 2], [10.0, 5.0], [20, 10]);
    let top = (10 * 21 + 10) as u32;
    let body =
        MeshBody::new("plate", plate, elastic(1.0, 1.0, 0.3)).with(Quad4, Technology::OnePoint(hourglass));
    fem.add(body).unwrap();
    fem.prescribe(0, "low y", std::sync::Arc::new(|_| [Some(0.0); 3])).unwrap();
    let dt = 0.5 * fem.next_time_step();
    while fem.time() < 40.0 {
        let mut trial = fem.trial(dt).unwrap();
        trial.body_mut(0).add_impulse(top as usize, [0.0, -1e-5 * dt]);
        trial.finish().unwrap();
    }
    assert!(fem.account().energy_error().abs() < 1e-3, "{:?}", fem.account());
    let said = fem.warnings().iter().map(ToString::to_string).collect();
    assert!(fem.warnings().iter().all(|w| matches!(w.finding, Finding::Hourglass { .. })));
    (fem.body(0).hourglass_energy(), fem.body(0).internal_energy(), said)
}

#[test]
fn a_point_load_is_held_by_hourglass_forces_which_is_said() {
    for hourglass in [Hourglass::Stiffness(0.05), Hourglass::Stiffness(0.5), Hourglass::Viscous(0.1)] {
        let (held, internal, said) = point_load(hourglass);
        println!("point load, {hourglass:?}: {:.1} % of the internal energy", 100.0 * held / internal);
        assert!(held > 0.05 * internal, "{held} of {internal}");
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(
            said[0].contains("hourglass forces of body `plate`") && said[0].contains("MeanDilatation"),
            "{said:?}"
        );
    }
}
