//! Structured meshes: valid elements for many parameters, closed surfaces, nodes on the shape, convergence of measures.

use impactite_geometry::structured::*;
use impactite_geometry::*;
use proptest::prelude::*;

fn volume_by_surface<const D: usize>(mesh: &ElementMesh<D>) -> (f64, [f64; D]) {
    // Divergence theorem: the integral of x . n over the surface is D times the volume. Quadrilaterals: bilinear map, 2 x 2 points.
    let (mut flux, mut normals) = (0.0, [0.0; D]);
    for facet in mesh.surface().unwrap() {
        let x: Vec<[f64; D]> = facet.nodes().iter().map(|&n| mesh.nodes[n as usize]).collect();
        let points: Vec<([f64; D], [f64; D])> = match x.len() {
            2 => {
                let normal = std::array::from_fn(|d| [x[1][1] - x[0][1], x[0][0] - x[1][0]][d]);
                vec![(x[0], normal)]
            }
            3 => vec![(x[0], cross(&x, [-1.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 1.0, 0.0]).map(|c| 0.5 * c))],
            _ => {
                let g = 0.5 / 3f64.sqrt();
                let place = [[0.5 - g, 0.5 - g], [0.5 + g, 0.5 - g], [0.5 - g, 0.5 + g], [0.5 + g, 0.5 + g]];
                let at = |[u, v]: [f64; 2]| {
                    let n = [(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v];
                    let along = cross(&x, [v - 1.0, 1.0 - v, v, -v], [u - 1.0, -u, u, 1.0 - u]);
                    let point = std::array::from_fn(|d| (0..4).map(|a| n[a] * x[a][d]).sum());
                    (point, along.map(|c| 0.25 * c))
                };
                place.into_iter().map(at).collect()
            }
        };
        for (point, normal) in points {
            for d in 0..D {
                flux += point[d] * normal[d];
                normals[d] += normal[d];
            }
        }
    }
    (flux / D as f64, normals)
}

/// Cross product of two linear combinations of corners.
fn cross<const D: usize>(x: &[[f64; D]], a: [f64; 4], b: [f64; 4]) -> [f64; D] {
    let sum =
        |w: [f64; 4]| -> [f64; D] { std::array::from_fn(|d| x.iter().zip(w).map(|(x, w)| w * x[d]).sum()) };
    let (a, b) = (sum(a), sum(b));
    std::array::from_fn(|d| a[(d + 1) % D] * b[(d + 2) % D] - a[(d + 2) % D] * b[(d + 1) % D])
}

/// Check that a mesh is valid and closed, and return its volume, which must equal the enclosed volume.
fn holds<const D: usize>(mesh: &ElementMesh<D>) -> f64 {
    mesh.check().unwrap();
    let volume = mesh.measure(Metric::Cartesian).unwrap();
    let (enclosed, normals) = volume_by_surface(mesh);
    assert!((enclosed - volume).abs() < 1e-12 * volume, "{enclosed} {volume}");
    let size = volume.powf((D as f64 - 1.0) / D as f64);
    assert!(normals.iter().all(|n| n.abs() < 1e-11 * size), "{normals:?}");
    closed(mesh);
    let used: std::collections::BTreeSet<u32> =
        mesh.blocks.iter().flat_map(|b| b.nodes.iter().copied()).collect();
    assert_eq!(used.len(), mesh.nodes.len(), "every node belongs to an element");
    // No nodes remain to be welded.
    let shortest = mesh.edge_lengths().unwrap().min;
    assert_eq!(mesh.clone().welded(1e-4 * shortest).unwrap().nodes.len(), mesh.nodes.len());
    volume
}

/// Check that every edge of a surface in space belongs to two facets of opposite direction, and in the plane every node to two edges.
fn closed<const D: usize>(mesh: &ElementMesh<D>) {
    let mut sides = std::collections::HashMap::new();
    for facet in mesh.surface().unwrap() {
        let nodes = facet.nodes();
        if D == 2 {
            *sides.entry([nodes[0]; 2]).or_insert(0) += 1;
            *sides.entry([nodes[1]; 2]).or_insert(0) -= 1;
        } else {
            for (i, &a) in nodes.iter().enumerate() {
                let b = nodes[(i + 1) % nodes.len()];
                let side = sides.entry([a.min(b), a.max(b)]).or_insert(0);
                // Opposite directions add to 1001, equal directions to 2 or 2000.
                *side += if a < b { 1 } else { 1000 };
            }
        }
    }
    let expected = if D == 2 { 0 } else { 1001 };
    assert!(sides.values().all(|&s| s == expected));
}

fn on_surface<const D: usize>(mesh: &ElementMesh<D>, shape: &impl Shape<D>, skip_axis: bool) {
    for facet in mesh.surface().unwrap() {
        if skip_axis && facet.nodes().iter().all(|&n| mesh.nodes[n as usize][0] == 0.0) {
            continue;
        }
        for &n in facet.nodes() {
            let x = mesh.nodes[n as usize];
            assert!(shape.signed_distance(x).abs() < 1e-12, "{x:?} {}", shape.signed_distance(x));
        }
    }
}

#[test]
fn boxes_have_exact_measures_and_named_faces() {
    let bars = box_mesh(&Cuboid::new([1.0], [3.0]).unwrap(), [Spacing::graded(5, 4.0)]).unwrap();
    assert!((bars.measure(Metric::Cartesian).unwrap() - 2.0).abs() < 1e-15);
    let lengths = bars.measures(Metric::Cartesian).unwrap();
    assert!((lengths[4] / lengths[0] - 4.0).abs() < 1e-12);
    assert_eq!(bars.node_sets["x_max"], [5]);
    assert_eq!(bars.nodes[5], [3.0]);

    let quads = box_mesh(&Cuboid::new([1.0, 0.0], [3.0, 5.0]).unwrap(), [4, 3]).unwrap();
    assert!((holds(&quads) - 10.0).abs() < 1e-14);
    assert!((quads.measure(Metric::Axisymmetric).unwrap() - 0.5 * 8.0 * 5.0).abs() < 1e-13);
    assert_eq!(quads.surface().unwrap().len(), 14);

    let body = Cuboid::new([0.0, -1.0, 2.0], [1.0, 1.0, 5.0]).unwrap();
    let bricks =
        box_mesh(&body, [Spacing::graded(3, 0.2), Spacing::uniform(2), Spacing::graded(4, 7.0)]).unwrap();
    assert!((holds(&bricks) - 6.0).abs() < 1e-14);
    on_surface(&bricks, &body, false);
    assert_eq!(bricks.surface().unwrap().len(), 2 * (6 + 12 + 8));
    assert_eq!(bricks.node_sets["y_min"].len(), 4 * 5);
    assert!(bricks.node_sets["y_min"].iter().all(|&n| bricks.nodes[n as usize][1] == -1.0));
}

#[test]
fn refusals_name_what_is_allowed() {
    let cube = Cuboid::new([0.0; 3], [1.0; 3]).unwrap();
    let said = |e: Result<ElementMesh<3>, GeometryError>| e.unwrap_err().to_string();
    assert_eq!(said(box_mesh(&cube, [3, 0, 1])), "box mesh: count = 0 is not allowed; it must be at least 1");
    assert!(
        said(box_mesh(&cube, [Spacing::graded(2, f64::NAN); 3]))
            .contains("last length over first, from 1e-6")
    );
    assert!(said(box_mesh(&cube, [2000; 3])).contains("at most 4294967294"));
    assert!(said(box_mesh(&cube, [1500, 1000, 1000])).contains("ask for fewer elements"));
    let rod = OgiveRod::new([0.0; 3], [0.0, 0.0, 1.0], 1.0, 5.0, 3.0).unwrap();
    assert_eq!(
        said(ogive_rod_mesh(&rod, Butterfly { core: 3, rings: 1 }, 4)),
        "ogive rod mesh: core = 3 is not allowed; it must be even, and at least 2"
    );
    assert!(
        said(ogive_rod_mesh(&rod, Butterfly { core: 4, rings: 0 }, 4)).contains("rings = 0 is not allowed")
    );
    let leaning = OgiveRod::new([0.0, 0.0], [0.1, 1.0], 1.0, 5.0, 3.0).unwrap();
    assert!(ogive_rod_section_mesh(&leaning, Butterfly { core: 4, rings: 1 }, 4).is_err());
    assert!(half_disc_mesh(&Disc::new([0.1, 0.0], 1.0).unwrap(), Butterfly { core: 4, rings: 1 }).is_err());
    assert!(wedge_mesh([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], 2, ElementKind::Quad4).is_err());
    assert!(wedge_mesh([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 2, ElementKind::Hexa8).is_err());
}

/// Check second-order convergence: the error of the measure must fall by four at each of two refinements by two.
fn converges(name: &str, exact: f64, measure: impl Fn(usize) -> f64) {
    let errors = [1, 2, 4].map(|fine| 1.0 - measure(fine) / exact);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.85..2.2).contains(&order), "{name}: {errors:?}, order {order}");
    }
    assert!(errors[1] > 0.0 && errors[1] < 0.01, "{name}: {errors:?}");
}

#[test]
fn round_bodies_converge_with_the_square_of_the_edge() {
    let section = |fine| Butterfly { core: 4 * fine, rings: 2 * fine };
    let disc = Disc::new([0.3, -0.2], 0.7).unwrap();
    converges("disc", disc.measure().unwrap(), |fine| {
        let mesh = ball_mesh(&disc, section(fine)).unwrap();
        on_surface(&mesh, &disc, false);
        holds(&mesh)
    });
    let sphere = Sphere::new([0.3, -0.2, 0.1], 0.7).unwrap();
    converges("sphere", sphere.measure().unwrap(), |fine| {
        let mesh = ball_mesh(&sphere, Butterfly { core: 6 * fine, rings: fine }).unwrap();
        on_surface(&mesh, &sphere, false);
        holds(&mesh)
    });
    let on_axis = Disc::new([0.0, 0.2], 0.7).unwrap();
    converges("half disc, revolved", on_axis.revolved_measure().unwrap(), |fine| {
        let mesh = half_disc_mesh(&on_axis, section(fine)).unwrap();
        on_surface(&mesh, &on_axis, true);
        assert_eq!(mesh.node_sets["axis"].len(), 4 * fine + 1 + 2 * 2 * fine);
        holds(&mesh);
        mesh.measure(Metric::Axisymmetric).unwrap()
    });
    let cylinder = Cylinder::new([0.1, 0.2, 0.3], [1.0, -2.0, 0.5], 2.0, 0.4).unwrap();
    converges("cylinder", cylinder.measure().unwrap(), |fine| {
        let mesh = cylinder_mesh(&cylinder, section(fine), 4).unwrap();
        on_surface(&mesh, &cylinder, false);
        holds(&mesh)
    });
    let tube = Tube::new([0.1, 0.2, 0.3], [0.0, 1.0, 0.0], 2.0, 0.3, 0.4).unwrap();
    converges("tube", tube.measure().unwrap(), |fine| {
        let mesh = tube_mesh(&tube, [2, 16 * fine], 3).unwrap();
        on_surface(&mesh, &tube, false);
        holds(&mesh)
    });
}

#[test]
fn ogive_rods_follow_their_surface_and_converge() {
    for crh in [0.5, 1.0, 3.0, 4.25] {
        let section = |fine| Butterfly { core: 4 * fine, rings: 2 * fine };
        let rod = OgiveRod::new([0.1, 0.0, -0.3], [0.0, -1.0, 3.0], 0.7, 3.0, crh).unwrap();
        converges(&format!("rod, crh {crh}"), rod.measure().unwrap(), |fine| {
            let mesh = ogive_rod_mesh(&rod, section(fine), Spacing::graded(4 * fine, 0.5)).unwrap();
            on_surface(&mesh, &rod, false);
            let tip = mesh.nodes.iter().filter(|x| norm(**x, rod.tip()) < 1e-12).count();
            assert_eq!(tip, 1, "a node at the tip");
            let quality = mesh.quality().unwrap();
            assert!(quality.jacobian_ratio > [0.2, 0.4, 0.6][fine / 2], "crh {crh}, {fine}: {quality:?}");
            holds(&mesh)
        });
        for forward in [1.0, -1.0] {
            let rod = OgiveRod::new([0.0, 0.4], [0.0, forward], 0.7, 3.0, crh).unwrap();
            converges(&format!("section, crh {crh}"), rod.revolved_measure().unwrap(), |fine| {
                let mesh = ogive_rod_section_mesh(&rod, section(fine), 4 * fine).unwrap();
                on_surface(&mesh, &rod, true);
                let quality = mesh.quality().unwrap();
                assert!(quality.jacobian_ratio > 0.3 && quality.scaled_jacobian > 0.3, "{quality:?}");
                holds(&mesh);
                mesh.measure(Metric::Axisymmetric).unwrap()
            });
        }
    }
}

fn norm<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
}

#[test]
fn a_rod_that_is_all_nose_has_a_tail() {
    let nose = OgiveRod::new([0.0; 3], [0.0, 0.0, 1.0], 1.0, 0.5, 0.5).unwrap();
    let mesh = ogive_rod_mesh(&nose, Butterfly { core: 4, rings: 2 }, 7).unwrap();
    holds(&mesh);
    assert!(mesh.node_sets["start"].iter().all(|&n| mesh.nodes[n as usize][2].abs() < 1e-15));
    assert_eq!(mesh.node_sets["start"].len(), 25 + 2 * 16);
}

#[test]
fn simplices_conform_and_keep_the_volume() {
    let rod = OgiveRod::new([0.0; 3], [0.0, 0.0, 1.0], 0.7, 3.0, 3.0).unwrap();
    let bricks = ogive_rod_mesh(&rod, Butterfly { core: 4, rings: 2 }, 6).unwrap();
    let split = bricks.clone().split_to_tetrahedra().unwrap();
    let volume = holds(&split);
    assert!((volume / bricks.measure(Metric::Cartesian).unwrap() - 1.0).abs() < 0.01);
    assert_eq!(split.surface().unwrap().len(), 2 * bricks.surface().unwrap().len());

    let disc = ball_mesh(&Disc::new([0.0; 2], 1.0).unwrap(), Butterfly { core: 4, rings: 2 }).unwrap();
    let triangles = disc.clone().split_to_triangles().unwrap();
    assert!((holds(&triangles) - disc.measure(Metric::Cartesian).unwrap()).abs() < 1e-14);
    assert_eq!(triangles.elements(), 2 * disc.elements());
}

#[test]
fn wedges_of_either_kind_have_their_area() {
    let corners = [[0.0, 0.0], [-0.5, 0.3], [0.6, 0.3]];
    for (kind, elements) in [(ElementKind::Triangle3, 64), (ElementKind::Quad4, 48)] {
        let mesh = wedge_mesh(corners, 8, kind).unwrap();
        assert!((holds(&mesh) - 0.5 * 1.1 * 0.3).abs() < 1e-14);
        assert_eq!(mesh.elements(), elements);
        for side in 0..3 {
            assert_eq!(mesh.node_sets[&format!("side_{side}")].len(), 9);
        }
        assert!(mesh.node_sets["side_1"].iter().all(|&n| (mesh.nodes[n as usize][1] - 0.3).abs() < 1e-15));
    }
}

#[test]
fn shapes_of_elements_do_not_fall_below_a_bound_with_resolution() {
    let mut worst = [f64::INFINITY; 4];
    for core in 1..=16 {
        for rings in [1, 2, 5, 10] {
            let section = Butterfly { core, rings };
            let disc = ball_mesh(&Disc::new([0.0; 2], 1.0).unwrap(), section).unwrap();
            let disc = disc.quality().unwrap();
            worst[0] = worst[0].min(disc.jacobian_ratio);
            worst[1] = worst[1].min(disc.scaled_jacobian);
        }
    }
    for core in 3..=9 {
        for rings in [2, 3] {
            let ball = ball_mesh(&Sphere::new([0.0; 3], 1.0).unwrap(), Butterfly { core, rings }).unwrap();
            let ball = ball.quality().unwrap();
            worst[2] = worst[2].min(ball.jacobian_ratio);
            worst[3] = worst[3].min(ball.scaled_jacobian);
        }
    }
    assert!(worst[0] > 0.3, "Jacobian ratio of discs and cylinders {}", worst[0]);
    assert!(worst[1] > 0.5, "scaled Jacobian of discs and cylinders {}", worst[1]);
    assert!(worst[2] > 0.25, "Jacobian ratio of balls {}", worst[2]);
    assert!(worst[3] > 0.4, "scaled Jacobian of balls {}", worst[3]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn rods_of_any_shape_are_sound(
        half_core in 1usize..5, rings in 1usize..5, shank in 1usize..6, crh in 0.5f64..8.0,
        slender in 0.0f64..10.0, ratio in 0.1f64..10.0, radius in 1e-4f64..10.0,
    ) {
        let section = Butterfly { core: 2 * half_core, rings };
        let length = radius * ((4.0 * crh - 1.0f64).sqrt() + slender);
        let rod = OgiveRod::new([0.0; 3], [0.3, -0.4, 1.0], 2.0 * radius, length, crh).unwrap();
        let mesh = ogive_rod_mesh(&rod, section, Spacing::graded(shank, ratio)).unwrap();
        holds(&mesh);
        prop_assert!(mesh.quality().unwrap().scaled_jacobian > 0.05, "{:?}", mesh.quality());
        let rod = OgiveRod::new([0.0; 2], [0.0, 1.0], 2.0 * radius, length, crh).unwrap();
        let section_mesh = ogive_rod_section_mesh(&rod, section, Spacing::graded(shank, ratio)).unwrap();
        holds(&section_mesh);
        prop_assert!(section_mesh.quality().unwrap().scaled_jacobian > 0.1);
    }

    #[test]
    fn other_bodies_of_any_shape_are_sound(
        core in 1usize..9, rings in 1usize..6, around in 3usize..40, radius in 1e-6f64..1e3,
        thickness in 0.01f64..3.0, counts in [1usize..6, 1usize..6, 1usize..6], ratio in 1e-3f64..1e3,
    ) {
        let section = Butterfly { core, rings };
        holds(&ball_mesh(&Sphere::new([0.0; 3], radius).unwrap(), section).unwrap());
        let cylinder = Cylinder::new([radius; 3], [0.0, -1.0, 0.1], radius, radius).unwrap();
        holds(&cylinder_mesh(&cylinder, section, Spacing::graded(counts[0], ratio)).unwrap());
        let even = Butterfly { core: 2 * core, rings };
        holds(&half_disc_mesh(&Disc::new([0.0, radius], radius).unwrap(), even).unwrap());
        let tube = Tube::new([0.0; 3], [1.0, 0.0, 0.0], radius, radius, radius * (1.0 + thickness)).unwrap();
        holds(&tube_mesh(&tube, [rings, around], counts[1]).unwrap());
        let cuboid = Cuboid::new([0.0; 3], [radius, 2.0 * radius, 0.1 * radius]).unwrap();
        let bricks = box_mesh(&cuboid, counts.map(|c| Spacing::graded(c, ratio))).unwrap();
        holds(&bricks);
        holds(&bricks.split_to_tetrahedra().unwrap());
    }

    #[test]
    fn butterflies_of_an_edge_have_elements_of_about_that_edge(radius in 1e-3f64..1.0, fine in 2.0f64..12.0) {
        let edge = radius / fine;
        let section = Butterfly::of_edge(radius, edge).unwrap();
        let lengths = ball_mesh(&Disc::new([0.0; 2], radius).unwrap(), section).unwrap().edge_lengths().unwrap();
        prop_assert!((lengths.mean / edge - 1.0).abs() < 0.35, "{lengths:?} {edge}");
    }
}
