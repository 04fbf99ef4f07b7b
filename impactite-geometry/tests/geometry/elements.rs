//! Element meshes: errors, measures, surfaces and mesh operations.

use impactite_geometry::structured::*;
use impactite_geometry::*;
use nalgebra::{Rotation2, Rotation3, Vector3};
use proptest::prelude::*;

fn cube(counts: [usize; 3]) -> ElementMesh<3> {
    box_mesh(&Cuboid::new([0.0; 3], [1.0; 3]).unwrap(), counts).unwrap()
}

fn of<const D: usize>(kind: ElementKind, nodes: &[[f64; D]]) -> ElementMesh<D> {
    ElementMesh {
        nodes: nodes.to_vec(),
        blocks: vec![ElementBlock { name: "body".into(), kind, nodes: (0..kind.nodes() as u32).collect() }],
        ..Default::default()
    }
}

fn said<T>(result: Result<T, GeometryError>) -> String {
    result.err().expect("it is refused").to_string()
}

#[test]
fn what_is_no_mesh_is_refused_by_block_and_element() {
    let sound = cube([2, 1, 1]);
    let broken = |change: &dyn Fn(&mut ElementMesh<3>)| {
        let mut mesh = sound.clone();
        change(&mut mesh);
        said(mesh.check())
    };
    assert_eq!(
        broken(&|m| m.blocks[0].nodes[9] = 12),
        "mesh: element 1 of block 0 `` names node 12; allowed are numbers below 12"
    );
    assert_eq!(
        broken(&|m| m.nodes[3][1] = f64::NAN),
        "mesh: coordinate 1 of node 3 = NaN is not allowed; it must be finite"
    );
    assert!(broken(&|m| m.blocks[0].nodes[9] = 1).contains("element 1 of block 0 `` names node 1 twice"));
    assert!(broken(&|m| m.blocks[0].nodes.truncate(15)).contains("lists 15 nodes; a brick has 8"));
    assert!(broken(&|m| m.blocks[0].nodes.swap(0, 1)).contains("brick 0 of block 0"));
    assert!(broken(&|m| m.nodes[0][0] = 0.6).contains("has a scaled Jacobian of -"));
    assert!(broken(&|m| m.nodes.iter_mut().for_each(|x| x[2] = 0.0)).contains("above 1e-9 is allowed"));
    assert!(broken(&|m| m.nodes.iter_mut().for_each(|x| x[2] *= 1e300)).contains("scaled Jacobian"));
    assert!(
        broken(&|m| drop(m.node_sets.insert("a".into(), vec![12]))).contains("node set `a` names node 12")
    );
    assert!(broken(&|m| drop(m.node_sets.insert("a".into(), vec![2, 2]))).contains("numbers must ascend"));

    let tetra = of(ElementKind::Tetra4, &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    assert!(
        said(tetra.check()).contains("is of kind tetrahedron, of 3 dimensions; in 2 dimensions at most 2")
    );
    let clockwise = of(ElementKind::Triangle3, &[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]);
    assert!(
        said(clockwise.check()).contains("the triangle 0 of block 0 `body` has a scaled Jacobian of -1e0")
    );
    let arrow = of(ElementKind::Quad4, &[[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0]]);
    assert!(said(arrow.check()).contains("at its node 2 (corner 2)"));
    let point = of(ElementKind::Bar2, &[[1.0, 2.0], [1.0, 2.0]]);
    assert!(said(point.check()).contains("the bar 0 of block 0"));
    // Bars and shells in space have no orientation.
    of(ElementKind::Quad4, &[[0.0; 3], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]]).check().unwrap();

    // Invalid node indices cause errors, not panics.
    let mut astray = sound.clone();
    astray.blocks[0].nodes[3] = u32::MAX;
    assert!(astray.surface().is_err() && astray.measure(Metric::Cartesian).is_err());
    assert!(astray.quality().is_err() && astray.edge_lengths().is_err());
    assert!(astray.clone().welded(0.1).is_err() && astray.part(&|_, _| true).is_err());
    assert!(sound.clone().joined(&astray).is_err() && astray.clone().translated([0.0; 3]).is_err());
    assert!(astray.clone().mirrored(0, 0.0).is_err() && astray.split_to_tetrahedra().is_err());
    assert!(said(sound.measure_of(0, 2, Metric::Cartesian)).contains("allowed are elements below 2"));
    assert!(said(sound.measure_of(1, 0, Metric::Cartesian)).contains("allowed are blocks below 1"));
    assert!(said(ElementMesh::<3>::default().edge_lengths()).contains("there is no element"));
}

#[test]
fn measures_of_bent_elements_are_exact() {
    // Trilinear map with a Jacobian of second degree in each coordinate, integrated analytically:
    // x = u, y = v (1 + u w / 2), z = w (1 + u v / 2) over the unit cube.
    let place = |[u, v, w]: [f64; 3]| [u, v * (1.0 + 0.5 * u * w), w * (1.0 + 0.5 * u * v)];
    let brick = cube([1; 3]).mapped(place).unwrap();
    // det = (1 + uw/2)(1 + uv/2) - u^2 v w / 4 = 1 + u (v + w) / 2, whose integral is 1 + 1/4.
    assert!((brick.measure(Metric::Cartesian).unwrap() - 1.25).abs() < 1e-15);

    let quad = of(ElementKind::Quad4, &[[1.0, 0.0], [3.0, 0.5], [2.5, 2.0], [0.5, 1.0]]);
    let triangles = quad.clone().split_to_triangles().unwrap();
    let by_pappus: f64 = triangles.blocks[0]
        .elements()
        .zip(triangles.measures(Metric::Cartesian).unwrap())
        .map(|(t, area)| area * t.iter().map(|&n| quad.nodes[n as usize][0]).sum::<f64>() / 3.0)
        .sum();
    assert!((quad.measure(Metric::Axisymmetric).unwrap() - by_pappus).abs() < 1e-14);
    assert!((triangles.measure(Metric::Axisymmetric).unwrap() - by_pappus).abs() < 1e-14);

    let tetra = of(ElementKind::Tetra4, &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]);
    assert_eq!(tetra.measure(Metric::Cartesian).unwrap(), 1.0);
    let quality = tetra.quality().unwrap();
    assert_eq!((quality.jacobian_ratio, quality.scaled_jacobian), (1.0, 1.0));
}

#[test]
fn surfaces_are_of_the_elements_alive() {
    let mesh = cube([3; 3]);
    let all = mesh.surface().unwrap();
    assert_eq!(all.len(), 54);
    assert!(all.is_sorted_by_key(|f| (f.block, f.element)));
    // Removal of the central element adds a cavity; removal of a corner replaces three faces by three.
    assert_eq!(mesh.surface_of(&|_, e| e != 13).unwrap().len(), 60);
    assert_eq!(mesh.surface_of(&|_, e| e != 0).unwrap().len(), 54);
    assert!(mesh.surface_of(&|_, _| false).unwrap().is_empty());
    let eroded = mesh.part(&|_, e| e != 13).unwrap();
    assert_eq!(eroded.surface().unwrap().len(), 60);
    assert_eq!((eroded.elements(), eroded.nodes.len()), (26, 64));
    assert_eq!(mesh.part(&|_, e| e == 0).unwrap().nodes.len(), 8);

    // A third element on a facet, and two elements on the same side of a facet.
    let mut three = cube([1; 3]);
    three.blocks.push(three.blocks[0].clone());
    assert!(said(three.surface()).contains("belongs to 2 elements, among them (0, 0) and (1, 0)"));
    let mut fan = of(ElementKind::Triangle3, &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, -1.0], [2.0, 1.0]]);
    fan.blocks[0].nodes.extend([1, 0, 3, 0, 1, 4]);
    assert!(said(fan.surface()).contains("the facet of nodes [0, 1] belongs to 3 elements"));
}

#[test]
fn meshes_are_moved_joined_and_welded() {
    let mesh = cube([2; 3]);
    let moved = mesh.clone().translated([1.0, 0.0, 0.0]).unwrap();
    let joined = mesh.clone().joined(&moved).unwrap();
    assert_eq!((joined.nodes.len(), joined.blocks.len()), (54, 2));
    assert_eq!(joined.surface().unwrap().len(), 48);
    let body = joined.clone().welded(1e-9).unwrap();
    assert_eq!((body.nodes.len(), body.surface().unwrap().len()), (45, 40));
    body.check().unwrap();
    // The common face is in the sets of both parts.
    assert_eq!(body.node_sets["x_max"].len(), 18);
    assert_eq!(body.node_sets["y_min"].len(), 15);
    assert!(said(joined.clone().welded(0.6)).contains("twice"));
    assert!(said(joined.welded(-1.0)).contains("welded: tolerance = -1"));
    // A chain of close nodes does not collapse: every node moves by less than the tolerance.
    let row = ElementMesh::<1> {
        nodes: (0..6).map(|i| [0.09 * f64::from(i)]).collect(),
        blocks: vec![ElementBlock { name: String::new(), kind: ElementKind::Bar2, nodes: vec![0, 2, 2, 4] }],
        ..Default::default()
    };
    assert_eq!(row.welded(0.1).unwrap().nodes, [[0.0], [0.18], [0.36]]);

    let turn = Rotation3::from_scaled_axis(Vector3::new(0.3, -0.2, 1.0));
    let turned = mesh.clone().rotated(turn, [0.3; 3]).unwrap().scaled(2.0, [5.0; 3]).unwrap();
    assert!((turned.measure(Metric::Cartesian).unwrap() - 8.0).abs() < 1e-13);
    let mirrored = mesh.clone().mirrored(1, 2.0).unwrap();
    assert_eq!(mirrored.bounds(), Bounds { min: [0.0, 3.0, 0.0], max: [1.0, 4.0, 1.0] });
    assert!((mirrored.measure(Metric::Cartesian).unwrap() - 1.0).abs() < 1e-15);
    assert!(said(mesh.clone().mapped(|[x, y, z]| [-x, y, z])).contains("scaled Jacobian of -"));
    assert!(said(mesh.clone().scaled(-1.0, [0.0; 3])).contains("factor = -1"));
    assert!(said(mesh.clone().translated([f64::NAN; 3])).contains("offset"));
    assert!(said(mesh.clone().mirrored(3, 0.0)).contains("less than the number of dimensions"));
    let shear = Rotation2::from_matrix_unchecked(nalgebra::Matrix2::new(1.0, 0.5, 0.0, 1.0));
    let flat = box_mesh(&Cuboid::new([0.0; 2], [1.0; 2]).unwrap(), [1, 1]).unwrap();
    assert!(said(flat.rotated(shear, [0.0; 2])).contains("an orthogonal, finite matrix"));
}

#[test]
fn nodes_and_edges_are_found() {
    let mesh = box_mesh(&Cuboid::new([0.0; 3], [2.0, 1.0, 0.3]).unwrap(), [2, 2, 3]).unwrap();
    let lengths = mesh.edge_lengths().unwrap();
    assert!((lengths.min - 0.1).abs() < 1e-15 && lengths.max == 1.0);
    // Number of edges: 2 x 3 x 4 of length 1, 3 x 2 x 4 of 0.5, 3 x 3 x 3 of 0.1.
    assert!((lengths.mean - (24.0 + 12.0 + 2.7) / 75.0).abs() < 1e-14);
    let ball = Sphere::new([0.0; 3], 0.5).unwrap();
    assert_eq!(mesh.nodes_in(&ball, 0.0).unwrap().len(), 4 + 1);
    // The column on the axis, the column at y = 0.5, and two nodes at a distance of 1.
    assert_eq!(mesh.nodes_in(&ball, 0.5).unwrap().len(), 4 + 4 + 2);
    assert!(mesh.nodes_in(&ball, -0.1).is_err());
    let top = mesh.nodes_where(|x| x[2] > 0.25);
    assert_eq!(mesh.clone().with_node_set("top", top.clone()).unwrap().node_sets["top"], top);
    assert!(mesh.with_node_set("none", vec![99]).is_err());
}

#[test]
fn bricks_split_to_five_or_six_tetrahedra_that_conform() {
    // A brick numbered alternately from the corners of a tetrahedron splits into five.
    let mut brick = cube([1; 3]);
    let order = [0u32, 4, 1, 5, 6, 2, 7, 3];
    let mut nodes = brick.nodes.clone();
    for (place, &new) in brick.blocks[0].nodes.clone().iter().zip(&order) {
        nodes[new as usize] = brick.nodes[*place as usize];
    }
    brick = ElementMesh { nodes, node_sets: Default::default(), ..brick };
    brick.blocks[0].nodes = order.to_vec();
    brick.check().unwrap();
    let five = brick.split_to_tetrahedra().unwrap();
    assert_eq!(five.elements(), 5);
    assert!((five.measure(Metric::Cartesian).unwrap() - 1.0).abs() < 1e-15);
    assert_eq!(five.surface().unwrap().len(), 12);
    assert_eq!(cube([1; 3]).split_to_tetrahedra().unwrap().elements(), 6);
    assert_eq!(five.clone().split_to_tetrahedra().unwrap(), five, "tetrahedra stay");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Neighbours agree on the diagonals of their faces for any node numbering.
    #[test]
    fn splits_conform_for_any_numbering(order in Just((0u32..36).collect::<Vec<_>>()).prop_shuffle()) {
        let mesh = cube([3, 2, 2]);
        let mut shuffled = mesh.clone();
        shuffled.node_sets.clear();
        for (x, &new) in mesh.nodes.iter().zip(&order) {
            shuffled.nodes[new as usize] = *x;
        }
        shuffled.blocks[0].nodes.iter_mut().for_each(|n| *n = order[*n as usize]);
        let split = shuffled.split_to_tetrahedra().unwrap();
        prop_assert!((split.measure(Metric::Cartesian).unwrap() - 1.0).abs() < 1e-14);
        prop_assert_eq!(split.surface().unwrap().len(), 2 * 32);
        prop_assert!((5 * 12..=6 * 12).contains(&split.elements()));
    }
}
