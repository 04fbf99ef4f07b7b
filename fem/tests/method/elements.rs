//! Single elements, and patch tests.

use fem::{Fem, Hourglass, MeshBody, Technology};
use impactite_geometry::ElementKind::{self, Bar2, Hexa8, Quad4, Tetra4, Triangle3};
use impactite_geometry::ElementMesh;
use impactite_scene::{Axisymmetric, Body, Embedding, FullSpace, Line, PlaneStrain, Solver};
use nalgebra::DMatrix;

use crate::common::{distorted, elastic, mesh};

const SPRINGS: Technology = Technology::OnePoint(Hourglass::Stiffness(0.05));
const DASHPOTS: Technology = Technology::OnePoint(Hourglass::Viscous(0.1));

/// Scene of one elastic body.
fn scene<const D: usize, E: Embedding<D>>(
    space: E,
    mesh: ElementMesh<D>,
    technology: Technology,
    velocity: impl Fn([f64; D]) -> [f64; D] + Send + Sync + 'static,
) -> Fem<D> {
    let kind = mesh.blocks[0].kind;
    let mut fem = Fem::new(space);
    fem.add(MeshBody::new("body", mesh, elastic(1.0, 1.0, 0.3)).with(kind, technology).moving(velocity))
        .unwrap();
    fem
}

/// Stiffness matrix of a mesh by finite differences of the forces.
fn stiffness<const D: usize, E: Embedding<D>>(
    space: E,
    mesh: &ElementMesh<D>,
    technology: Technology,
) -> DMatrix<f64> {
    let n = mesh.nodes.len() * D;
    let (small, dt) = (1e-6, 1e-3);
    let mut k = DMatrix::zeros(n, n);
    for column in 0..n {
        for sign in [1.0, -1.0] {
            let mut fem = scene(space, mesh.clone(), technology, |_| [0.0; D]);
            let mut trial = fem.trial(dt).unwrap();
            let mass = trial.bodies()[0].nodes()[column / D].mass;
            let mut impulse = [0.0; D];
            impulse[column % D] = sign * mass * small / dt;
            trial.body_mut(0).add_impulse(column / D, impulse);
            trial.finish().unwrap();
            for row in 0..n {
                k[(row, column)] -= 0.5 * sign * fem.body(0).force(row / D)[row % D] / small;
            }
        }
    }
    k
}

fn eigenvalues(k: DMatrix<f64>) -> Vec<f64> {
    let symmetric = (&k + k.transpose()) * 0.5;
    let mut values: Vec<f64> = symmetric.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

#[test]
fn eigenvalues_of_the_unit_square_are_those_of_the_literature() {
    let square = mesh(Quad4, [0.0; 2], [1.0; 2], [1; 2]);
    let hardly = Technology::OnePoint(Hourglass::Stiffness(1e-9));
    let uniform = [0.769231, 0.769231, 1.923077];
    let cases = [
        (hardly, [0.0; 2]),
        (Technology::Full, [0.576923; 2]),
        (Technology::OnePoint(Hourglass::Stiffness(0.05)), [0.1 / 2.6; 2]),
    ];
    for (technology, hourglass) in cases {
        let values = eigenvalues(stiffness(PlaneStrain, &square, technology));
        let mut expected = vec![0.0; 3];
        expected.extend(hourglass);
        expected.extend(uniform);
        expected.sort_by(f64::total_cmp);
        for (value, wanted) in values.iter().zip(&expected) {
            assert!((value - wanted).abs() < 1e-6, "{technology:?}: {values:?}");
        }
        // Row-sum lumping: a quarter of the mass at every corner.
        let largest = (4.0 * values[7]).sqrt();
        assert!((largest - 2.7735).abs() < 1e-4, "{largest}");
    }
}

#[test]
fn the_stable_step_is_two_over_the_highest_frequency_of_a_box_and_never_above() {
    let cases = [(hexa([1.0, 1.0, 1.0]), 0.0), (hexa([1.0, 0.3, 2.0]), 0.0), (hexa([1.0, 1.0, 1.0]), 0.25)];
    for (mut mesh, skew) in cases {
        for x in &mut mesh.nodes {
            x[0] += skew * x[1];
        }
        for technology in [
            Technology::OnePoint(Hourglass::Stiffness(1e-9)),
            SPRINGS,
            Technology::Full,
            Technology::MeanDilatation,
        ] {
            let k = stiffness(FullSpace, &mesh, technology);
            let fem = scene(FullSpace, mesh.clone(), technology, |_| [0.0; 3]);
            let root: Vec<f64> = (0..k.nrows()).map(|i| fem.body(0).nodes()[i / 3].mass.sqrt()).collect();
            let scaled = DMatrix::from_fn(k.nrows(), k.ncols(), |i, j| k[(i, j)] / (root[i] * root[j]));
            let highest = eigenvalues(scaled).last().unwrap().sqrt();
            let part = fem.body(0).stable_step() * highest / 2.0;
            assert!(part < 1.0 + 1e-5 && part > 0.6, "{technology:?}: {part}");
            if skew == 0.0
                && matches!(technology, Technology::OnePoint(Hourglass::Stiffness(k)) if k < 1e-6)
                && mesh.nodes[6] == [1.0; 3]
            {
                assert!(part > 1.0 - 1e-5, "{technology:?}: {part}");
            }
        }
    }
}

fn hexa(edges: [f64; 3]) -> ElementMesh<3> {
    mesh(Hexa8, [0.0; 3], edges, [1; 3])
}

/// Patch test: a linear motion gives distorted elements equal strains, and forces balance at the inner nodes, to rounding.
fn patch<const D: usize, E: Embedding<D>>(
    space: E,
    mesh: &ElementMesh<D>,
    technology: Technology,
    gradient: [[f64; D]; D],
) {
    let dt = 1e-2;
    let field = move |x: [f64; D]| std::array::from_fn(|i| (0..D).map(|j| gradient[i][j] * x[j]).sum());
    let mut fem = scene(space, mesh.clone(), technology, field);
    fem.trial(dt).unwrap().finish().unwrap();
    let points = fem.body(0).points();
    let first = points[0].stress;
    let size = first.iter().map(|s| s.abs()).fold(0.0, f64::max);
    assert!(size > 1e-3, "{size}");
    for p in &points {
        for i in 0..6 {
            assert!(
                (p.stress[i] - first[i]).abs() < 1e-13 * size.max(1.0),
                "{technology:?}: {:?} {first:?}",
                p.stress
            );
        }
    }
    let outside: std::collections::BTreeSet<u32> = mesh.node_sets.values().flatten().copied().collect();
    let force = |n: usize| fem.body(0).force(n).iter().map(|f| f * f).sum::<f64>().sqrt();
    let most = (0..mesh.nodes.len()).map(force).fold(0.0, f64::max);
    let mut inside = 0;
    for n in (0..mesh.nodes.len()).filter(|n| !outside.contains(&(*n as u32))) {
        // Around an axis, hoop and radial stress differ unless u_r = a r.
        assert!(force(n) < 1e-12 * most, "{technology:?}: {} of {most}", force(n));
        inside += 1;
    }
    assert!(inside > 0);
    assert!(fem.body(0).hourglass_energy().abs() < 1e-28);
}

#[test]
fn patches_of_every_kind_pass() {
    let plane = [[0.3, 0.8], [-0.2, -0.5]];
    let space = [[0.3, 0.8, 0.1], [-0.2, -0.5, 0.4], [0.6, -0.1, 0.2]];
    let round = [[0.4, 0.0], [0.0, -0.7]];
    let of = |kind, technologies: &[Technology]| {
        for &technology in technologies {
            patch(
                PlaneStrain,
                &distorted(mesh(kind, [0.0; 2], [1.0; 2], [5; 2]), 0.2, 0.2),
                technology,
                plane,
            );
            patch(
                Axisymmetric,
                &distorted(mesh(kind, [0.0; 2], [1.0; 2], [5; 2]), 0.2, 0.2),
                technology,
                round,
            );
        }
    };
    let blocks = [SPRINGS, DASHPOTS, Technology::Full, Technology::MeanDilatation];
    let simplices = [Technology::Full, Technology::AveragedVolumes];
    of(Quad4, &blocks);
    of(Triangle3, &simplices);
    let of = |kind, technologies: &[Technology]| {
        for &technology in technologies {
            patch(
                FullSpace,
                &distorted(mesh(kind, [0.0; 3], [1.0; 3], [4; 3]), 0.2, 0.25),
                technology,
                space,
            );
        }
    };
    of(Hexa8, &blocks);
    of(Tetra4, &simplices);
    patch(Line, &distorted(mesh(Bar2, [0.0], [1.0], [8]), 0.2, 0.125), Technology::Full, [[0.7]]);
}

#[test]
fn bars_feel_stress_along_them_alone_and_poisson_across() {
    // Bar along a diagonal in space, stretched by 1 %.
    let mesh = ElementMesh {
        nodes: vec![[0.0; 3], [1.0, 2.0, 2.0]],
        blocks: vec![impactite_geometry::ElementBlock { name: String::new(), kind: Bar2, nodes: vec![0, 1] }],
        ..ElementMesh::default()
    };
    let mut fem = scene(FullSpace, mesh, Technology::Full, |x| x.map(|c| 0.01 * c));
    fem.trial(1.0).unwrap().finish().unwrap();
    let point = &fem.body(0).points()[0];
    let strain = 2.0 * 0.01 / 2.01;
    // The Kirchhoff stress is linear in the strain.
    let ratio = point.volume / 3.0;
    assert!((point.stress[0] * ratio - strain).abs() < 1e-9, "{:?}", point.stress);
    assert!(point.stress[1].abs() < 1e-9 && point.stress[2].abs() < 1e-9);
    assert!((ratio.ln() - 0.4 * 1.01f64.ln()).abs() < 1e-6, "{ratio}");
    let pull = fem.body(0).force(0);
    let wanted = strain / 1.01 / 3.0;
    for (d, along) in [1.0, 2.0, 2.0].into_iter().enumerate() {
        assert!((pull[d] - wanted * along).abs() < 1e-9, "{pull:?}");
    }
}

/// Displacement of a rotation by a tenth of a radian about an oblique axis, or in the plane.
fn turned<const D: usize>(x: [f64; D]) -> [f64; D] {
    let mut wide = [0.0; 3];
    wide[..D].copy_from_slice(&x);
    let axis = if D == 3 { [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0] } else { [0.0, 0.0, 1.0] };
    let turn = nalgebra::Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(axis.into()), 0.1);
    let now = turn * nalgebra::Vector3::from(wide);
    std::array::from_fn(|d| now[d] - wide[d])
}

#[test]
fn rotations_strain_nothing() {
    fn of<const D: usize, E: Embedding<D>>(space: E, kind: ElementKind, technologies: &[Technology]) {
        for &technology in technologies {
            let mesh = distorted(mesh(kind, [0.0; D], [1.0; D], [4; D]), 0.2, 0.25);
            let mut fem = scene(space, mesh, technology, turned);
            fem.trial(1.0).unwrap().finish().unwrap();
            for p in fem.body(0).points() {
                assert!(p.stress.iter().all(|s| s.abs() < 2e-14), "{technology:?}: {:?}", p.stress);
            }
            assert!(fem.totals().internal < 1e-26, "{technology:?}");
        }
    }
    of(PlaneStrain, Quad4, &[SPRINGS, DASHPOTS, Technology::Full, Technology::MeanDilatation]);
    of(PlaneStrain, Triangle3, &[Technology::Full, Technology::AveragedVolumes]);
    of(FullSpace, Hexa8, &[SPRINGS, DASHPOTS, Technology::Full, Technology::MeanDilatation]);
    of(FullSpace, Tetra4, &[Technology::Full, Technology::AveragedVolumes]);
}

#[test]
fn technologies_that_a_kind_cannot_have_are_refused_with_the_reason() {
    let refused = |kind, technology| {
        let mut fem = Fem::new(PlaneStrain);
        let body = MeshBody::new("body", mesh(kind, [0.0; 2], [1.0; 2], [2; 2]), elastic(1.0, 1.0, 0.3));
        fem.add(body.with(kind, technology)).expect_err("refused").to_string()
    };
    let said = refused(Triangle3, SPRINGS);
    assert!(said.contains("Triangle3") && said.contains("AveragedVolumes"), "{said}");
    assert!(refused(Quad4, Technology::AveragedVolumes).contains("MeanDilatation"));
    assert!(refused(Triangle3, Technology::MeanDilatation).contains("AveragedVolumes"));
    let said = refused(Quad4, Technology::OnePoint(Hourglass::Stiffness(2.0)));
    assert_eq!(said, "hourglass control: stiffness = 2 is not allowed; it must be in (0, 1]");
}

#[test]
fn meshes_that_cannot_be_are_refused() {
    let law = || elastic(1.0, 1.0, 0.3);
    let square = || mesh(Quad4, [0.0; 2], [1.0; 2], [2; 2]);
    let refused = |mesh| {
        Fem::new(PlaneStrain).add(MeshBody::new("body", mesh, law())).expect_err("refused").to_string()
    };
    let mut inverted = square();
    inverted.blocks[0].nodes.swap(0, 1);
    assert!(refused(inverted).starts_with("body `body`, element 0: volume at an integration point = "));
    let mut lone = square();
    lone.nodes.push([5.0; 2]);
    assert!(refused(lone).contains("it is a node of no element"));
    let mut beyond = square();
    beyond.blocks[0].nodes[5] = 99;
    assert!(refused(beyond).contains("body `body`, element 1: node = 99"));
    assert!(refused(ElementMesh::default()).contains("`body`"));
    let mut nan = square();
    nan.nodes[4][1] = f64::NAN;
    assert!(refused(nan).contains("position of node = NaN"));
    let mut fem = Fem::new(Axisymmetric);
    let behind = mesh(Quad4, [-1.0, 0.0], [1.0; 2], [2; 2]);
    assert!(fem.add(MeshBody::new("body", behind, law())).is_err());
    fem.add(MeshBody::new("body", square(), law())).unwrap();
    assert!(
        fem.add(MeshBody::new("body", square(), law()))
            .unwrap_err()
            .to_string()
            .contains("that of no other body")
    );
}
