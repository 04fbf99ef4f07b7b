//! Closed triangle meshes: volume, inside test, distance, files and errors.

use std::f64::consts::PI;

use impactite_geometry::*;

struct Points(u64);

impl Points {
    fn within(&mut self, b: &Bounds<3>, margin: f64) -> [f64; 3] {
        let mut x = [0.0; 3];
        for i in 0..3 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            let u = (self.0 >> 11) as f64 / (1u64 << 53) as f64;
            let extent = b.max[i] - b.min[i];
            x[i] = b.min[i] - margin * extent + u * (1.0 + 2.0 * margin) * extent;
        }
        x
    }
}

type Raw = (Vec<[f64; 3]>, Vec<[usize; 3]>);

/// Triangulate a box by twelve triangles.
fn raw_box(min: [f64; 3], max: [f64; 3]) -> Raw {
    let corners = Bounds { min, max }.corners().collect();
    // Bit i of the index of a corner is set if coordinate i is the larger one.
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    (corners, triangles)
}

/// Triangulate the surface of revolution of a profile (z, r) about the third axis, first and last point on the axis.
fn raw_revolved(profile: &[[f64; 2]], around: usize) -> Raw {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for [z, r] in profile {
        for k in 0..around {
            let a = 2.0 * PI * k as f64 / around as f64;
            vertices.push([r * a.cos(), r * a.sin(), *z]);
        }
    }
    for i in 0..profile.len() - 1 {
        for k in 0..around {
            let (p, q) = (i * around + k, i * around + (k + 1) % around);
            // At zero radius one of the two triangles is degenerate and is dropped.
            triangles.push([p, q, q + around]);
            triangles.push([p, q + around, p + around]);
        }
    }
    (vertices, triangles)
}

fn sphere_profile(n: usize) -> Vec<[f64; 2]> {
    (0..=n)
        .map(|i| {
            let a = PI * i as f64 / n as f64;
            [-a.cos(), if i == 0 || i == n { 0.0 } else { a.sin() }]
        })
        .collect()
}

/// Separate small tetrahedra in a cube.
fn raw_tetrahedra(count: usize) -> Raw {
    let side = (count as f64).cbrt().ceil() as usize;
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for k in 0..count {
        let at = [k / (side * side), k / side % side, k % side].map(|i| 2.0 * i as f64);
        let first = vertices.len();
        vertices.push(at);
        for axis in 0..3 {
            let mut x = at;
            x[axis] += 1.0;
            vertices.push(x);
        }
        // Every second tetrahedron is inside out.
        for [a, b, c] in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]] {
            triangles.push(if k % 2 == 0 { [a, b, c] } else { [a, c, b] }.map(|i| first + i));
        }
    }
    (vertices, triangles)
}

fn mesh((vertices, triangles): Raw) -> TriangleMesh {
    TriangleMesh::new(&vertices, &triangles).unwrap()
}

#[test]
fn a_box_of_triangles_is_the_box() {
    let (min, max) = ([0.1, -0.2, 0.3], [1.1, 0.3, 0.9]);
    let solid = mesh(raw_box(min, max));
    let exact = Cuboid::new(min, max).unwrap();
    assert_eq!(solid.triangles().len(), 12);
    assert!((solid.measure().unwrap() - 0.3).abs() < 1e-15);
    assert!((solid.area() - 2.0 * (0.5 + 0.6 + 0.3)).abs() < 1e-14);
    let c = solid.centroid().unwrap();
    assert!((0..3).all(|i| (c[i] - exact.centroid().unwrap()[i]).abs() < 1e-15));
    assert_eq!(solid.bounds(), exact.bounds());
    let mut points = Points(1);
    for _ in 0..20000 {
        let x = points.within(&exact.bounds(), 0.4);
        assert_eq!(solid.contains(x), exact.contains(x));
        assert!((solid.signed_distance(x) - exact.signed_distance(x)).abs() < 1e-15);
    }
}

#[test]
fn lines_through_edges_and_corners_do_no_harm() {
    // Every line of the lattice passes through edges, diagonals, corners or faces.
    let solid = mesh(raw_box([0.0; 3], [1.0; 3]));
    let last: Vec<f64> = (0..=40).map(|k| -0.5 + k as f64 * 0.05).collect();
    let mut inside = vec![false; last.len()];
    let mut count = 0;
    for i in 0..=8 {
        for j in 0..=8 {
            let first = [i as f64 * 0.25 - 0.5, j as f64 * 0.25 - 0.5, 0.0];
            solid.contains_row(first, &last, &mut inside);
            assert!(!inside[0] && !inside[40]);
            for (z, i) in last.iter().zip(&inside) {
                assert_eq!(*i, solid.contains([first[0], first[1], *z]));
                assert!(!i || (0.0..=1.0 + 1e-15).contains(z));
            }
            count += usize::from(inside.iter().any(|i| *i));
        }
    }
    // Points on faces count on one side only: four of five lines along each axis.
    assert_eq!(count, 16);
    // Pole of a sphere, where dozens of triangles share a vertex, and its meridians.
    let globe = mesh(raw_revolved(&sphere_profile(24), 48));
    for x in [[0.0; 3], [0.0, 0.0, 0.99], [0.0, 0.0, -0.99], [0.5, 0.0, 0.0], [0.0, -0.7, 0.3]] {
        assert!(globe.contains(x), "{x:?}");
    }
    for x in [[0.0, 0.0, 1.01], [0.0, 0.0, -1.01], [1.0001, 0.0, 0.0], [0.0, 1.0001, 0.0]] {
        assert!(!globe.contains(x), "{x:?}");
    }
}

#[test]
fn a_fine_sphere_and_rod_agree_with_the_analytic_ones() {
    let globe = mesh(raw_revolved(&sphere_profile(100), 200));
    let ball = Sphere::new([0.0; 3], 1.0).unwrap();
    assert!((globe.measure().unwrap() / ball.measure().unwrap() - 1.0).abs() < 1e-3);
    let (d, length, crh) = (12.9e-3, 88.9e-3, 3.0);
    let rod = OgiveRod::new([0.0; 3], [0.0, 0.0, 1.0], d, length, crh).unwrap();
    let shank = length - rod.nose_length();
    let mut profile = vec![[0.0, 0.0], [0.0, d / 2.0]];
    for i in 0..=150 {
        let s = rod.nose_length() * i as f64 / 150.0;
        let r = ((crh * d).powi(2) - s * s).sqrt() - (crh - 0.5) * d;
        profile.push([shank + s, if i == 150 { 0.0 } else { r }]);
    }
    let ogive = mesh(raw_revolved(&profile, 200));
    assert!((ogive.measure().unwrap() - 1.0352e-5).abs() < 3e-9);
    assert!((ogive.measure().unwrap() / rod.measure().unwrap() - 1.0).abs() < 3e-4);
    let pairs: [(&TriangleMesh, &dyn Shape<3>, f64); 2] = [(&globe, &ball, 6e-4), (&ogive, &rod, 3e-6)];
    for (solid, exact, gap) in pairs {
        let c = [solid.centroid().unwrap(), exact.centroid().unwrap()];
        assert!((0..3).all(|i| (c[0][i] - c[1][i]).abs() < gap));
        let mut points = Points(5);
        for _ in 0..10000 {
            let x = points.within(&exact.bounds(), 0.3);
            let (a, b) = (solid.signed_distance(x), exact.signed_distance(x));
            assert!((a - b).abs() < gap, "{a} {b} at {x:?}");
            if b.abs() > gap {
                assert_eq!(solid.contains(x), b < 0.0);
            }
            let near = solid.signed_distance_within(x, 3.0 * gap);
            assert_eq!(near, a.clamp(-3.0 * gap, 3.0 * gap));
            // Lipschitz condition: the surface is not nearer than the distance.
            let y = points.within(&exact.bounds(), 0.3);
            let between = (0..3).map(|i| (x[i] - y[i]).powi(2)).sum::<f64>().sqrt();
            assert!((a - solid.signed_distance(y)).abs() <= between * (1.0 + 1e-12));
        }
    }
}

#[test]
fn a_mesh_is_filled_like_the_shape_it_stands_for() {
    let (min, max) = ([0.1, -0.2, 0.3], [1.1, 0.3, 0.9]);
    let lattice = Lattice::new([0.013, 0.02, 0.0], 0.07).unwrap();
    let knife = HalfSpace::new([0.6, 0.0, 0.6], [1.0, 0.3, -0.5]).unwrap();
    for filling in [Filling::new(), Filling::new().partial(4, 0.1), Filling::new().jittered(1, 1.0)] {
        let a = fill(&mesh(raw_box(min, max)), &lattice, 2, &filling).unwrap();
        let b = fill(&Cuboid::new(min, max).unwrap(), &lattice, 2, &filling).unwrap();
        assert_eq!(a.positions, b.positions);
        assert!((a.measure() / 0.3 - 1.0).abs() < 1e-12);
        assert!(a.volumes.iter().zip(&b.volumes).all(|(x, y)| (x / y - 1.0).abs() < 1e-12));
        let a = fill(&mesh(raw_box(min, max)).and(knife), &lattice, 2, &filling).unwrap();
        let b = fill(&Cuboid::new(min, max).unwrap().and(knife), &lattice, 2, &filling).unwrap();
        assert_eq!(a.positions, b.positions);
        assert!((a.correction / b.correction - 1.0).abs() < 1e-9);
    }
}

#[test]
fn pieces_and_cavities_are_told_apart() {
    let join = |parts: &[Raw]| {
        let (mut vertices, mut triangles): Raw = (Vec::new(), Vec::new());
        for (v, t) in parts {
            let first = vertices.len();
            triangles.extend(t.iter().map(|t| t.map(|i| first + i)));
            vertices.extend(v);
        }
        (vertices, triangles)
    };
    let inside_out = |(v, t): Raw| (v, t.into_iter().map(|[a, b, c]| [a, c, b]).collect());
    let outer = raw_box([0.0; 3], [3.0; 3]);
    let cavity = raw_box([1.0; 3], [2.0; 3]);
    let core = raw_box([1.4; 3], [1.6; 3]);
    let aside = raw_box([5.0; 3], [6.0; 3]);
    // The result does not depend on the orientation of the pieces.
    for parts in [
        [outer.clone(), cavity.clone(), core.clone(), aside.clone()],
        [inside_out(outer.clone()), cavity.clone(), inside_out(core.clone()), inside_out(aside.clone())],
    ] {
        let solid = mesh(join(&parts));
        assert!((solid.measure().unwrap() - (27.0 - 1.0 + 0.008 + 1.0)).abs() < 1e-12);
        for (x, inside) in [([0.5; 3], true), ([1.2; 3], false), ([1.5; 3], true), ([5.5; 3], true)] {
            assert_eq!(solid.contains(x), inside);
        }
        assert!((solid.signed_distance([1.2, 1.5, 1.5]) - 0.2).abs() < 1e-15);
    }
}

#[test]
fn bad_meshes_are_refused() {
    let (vertices, mut triangles) = raw_box([0.0; 3], [1.0; 3]);
    let build = |t: &[[usize; 3]]| TriangleMesh::new(&vertices, t).unwrap_err();
    assert_eq!(build(&triangles[1..]), GeometryError::OpenMesh { open_edges: 3 });
    assert_eq!(build(&triangles[2..]), GeometryError::OpenMesh { open_edges: 4 });
    let text = build(&triangles[2..]).to_string();
    assert!(text.contains("4 of its edges"), "{text}");
    assert_eq!(build(&[]), GeometryError::EmptyMesh);
    assert_eq!(build(&[[0, 0, 1]]), GeometryError::EmptyMesh);
    assert_eq!(build(&[[0, 1, 8]]), GeometryError::VertexOutOfRange { triangle: 0, vertex: 8, vertices: 8 });
    triangles[3].swap(0, 1);
    assert_eq!(build(&triangles), GeometryError::InconsistentMesh { edges: 3 });
    let flat = build(&[[0, 1, 2], [0, 2, 1]]);
    assert!(matches!(flat, GeometryError::NoVolume { .. }), "{flat}");
    let nan = TriangleMesh::from_soup(&[[[0.0, 0.0, f64::NAN]; 3]]).unwrap_err();
    assert!(matches!(nan, GeometryError::Parameter { field: "vertices", .. }));
}

#[cfg(feature = "mesh")]
mod files {
    use super::*;
    use std::fmt::Write;
    use std::path::PathBuf;

    fn file(name: &str, content: &[u8]) -> PathBuf {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::write(&path, content).unwrap();
        path
    }

    #[test]
    fn stl_files_of_all_kinds_are_read() {
        let (v, t) = raw_box([0.0; 3], [2.0, 3.0, 4.0]);
        let mut ascii = String::from("solid\n");
        let mut binary = vec![0u8; 80];
        binary[..6].copy_from_slice(b"solid ");
        binary.extend((t.len() as u32).to_le_bytes());
        for corners in &t {
            ascii.push_str(" facet normal 0 0 0\n  outer loop\n");
            binary.extend([0u8; 12]);
            for c in corners {
                let x = v[*c];
                writeln!(ascii, "   vertex {} {} {}", x[0], x[1], x[2]).unwrap();
                binary.extend(x.iter().flat_map(|c| (*c as f32).to_le_bytes()));
            }
            ascii.push_str("  endloop\n endfacet\n");
            binary.extend([0u8; 2]);
        }
        ascii.push_str("endsolid\n");
        let named = ascii.replace("solid\n", "solid a box\n");
        for (name, content) in [
            ("nameless.stl", ascii.as_bytes()),
            ("named.stl", named.as_bytes()),
            ("binary.stl", binary.as_slice()),
        ] {
            let solid = TriangleMesh::read_stl(file(name, content), 1e-3).unwrap();
            assert_eq!((solid.vertices().len(), solid.triangles().len()), (8, 12), "{name}");
            assert!((solid.measure().unwrap() / 24e-9 - 1.0).abs() < 1e-12, "{name}");
        }
        for (name, content) in [("short.stl", &binary[..300]), ("text.stl", b"hello"), ("none.stl", b"")] {
            let refused = TriangleMesh::read_stl(file(name, content), 1.0);
            assert!(matches!(refused, Err(GeometryError::File { .. })), "{name}: {refused:?}");
        }
        let missing = TriangleMesh::read_stl("/nowhere/at/all.stl", 1.0).unwrap_err();
        assert!(missing.to_string().starts_with("cannot read /nowhere/at/all.stl: "));
        let unit = TriangleMesh::read_stl("any", 0.0).unwrap_err();
        assert!(matches!(unit, GeometryError::Parameter { field: "unit", .. }));
    }

    /// Write a box as the facets of an ASCII file.
    fn facets(min: [f64; 3], max: [f64; 3]) -> String {
        let (v, t) = raw_box(min, max);
        let mut text = String::new();
        for corners in &t {
            text.push_str(" facet normal 0 0 0\n  outer loop\n");
            for x in corners.map(|c| v[c]) {
                writeln!(text, "   vertex {:e} {} {}", x[0], x[1], x[2]).unwrap();
            }
            text.push_str("  endloop\n endfacet\n");
        }
        text
    }

    #[test]
    fn all_solids_of_an_ascii_file_are_read() {
        let [one, two] = [facets([0.0; 3], [2.0, 3.0, 4.0]), facets([0.1, 0.1, 7.0], [1.1, 1.1, 8.0])];
        let plain = format!("solid one\n{one}endsolid one\nsolid two\n{two}endsolid two\n");
        let texts = [
            plain.clone(),
            plain.to_uppercase(),
            plain.replace('\n', "\r\n"),
            plain.replace('\n', "\r"),
            format!("solid\n{one}endsolid\nsolid\n{two}endsolid"),
            format!("\u{feff}solid\n{one}endsolid\n \n\t solid \n{two}endsolid \n"),
            format!("\n \r\n  {}\n\n \t\n", plain.replace('\n', " \n\n")),
            plain.replace("solid one", "solid facet normal endsolid (größer), \u{1F980}"),
            plain.replace("normal 0 0 0", "normal nan -inf 1e99"),
            format!("solid empty\nendsolid empty\n{plain}"),
        ];
        for (i, text) in texts.iter().enumerate() {
            let solid =
                TriangleMesh::read_stl(file(&format!("solids_{i}.stl"), text.as_bytes()), 1.0).unwrap();
            assert_eq!((solid.vertices().len(), solid.triangles().len()), (16, 24), "text {i}");
            assert!((solid.measure().unwrap() / 25.0 - 1.0).abs() < 1e-14, "text {i}");
            // Read in double precision: 0.1 is not the single-precision value.
            assert!(solid.vertices().iter().any(|x| x[0] == 0.1), "text {i}");
            assert!(solid.contains([0.5, 0.5, 7.5]) && !solid.contains([0.5, 0.5, 5.0]));
        }
    }

    #[test]
    fn stl_files_that_are_not_whole_are_refused() {
        let said = |name: &str, content: &[u8]| {
            TriangleMesh::read_stl(file(name, content), 1.0).unwrap_err().to_string()
        };
        let text = format!("solid a\n{}endsolid a\n", facets([0.0; 3], [1.0; 3]));
        let refused = [
            (format!("{text}rest"), "line 87: expected `solid` or the end of the file, found `rest`"),
            (text.replace("endsolid a\n", ""), "ends in line 85, where `facet` or `endsolid` was expected"),
            (
                text.replacen("vertex 0e0 0 0", "vertex 0e0 0 nan", 1),
                "expected a finite coordinate, found `NaN`",
            ),
            (
                text.replacen("vertex 0e0 0 0", "vertex 0e0 1e999 0", 1),
                "line 4: expected a finite coordinate",
            ),
            (
                text.replacen("vertex 0e0 0 0", "vertex 0e0 0,5 0", 1),
                "line 4: expected a finite coordinate, found `0,5`",
            ),
            (
                text.replacen("vertex 0e0 0 0", "vertex 0e0 0", 1),
                "line 5: expected a finite coordinate, found `vertex`",
            ),
            (
                text.replacen("normal 0 0 0", "normal 0 zero 0", 1),
                "line 2: expected a number of the normal, found `zero`",
            ),
            (
                text.replacen("  endloop", "   vertex 0 0 0\n  endloop", 1),
                "line 7: expected endloop, found `vertex`",
            ),
            (text.replacen("outer", "inner", 1), "line 3: expected outer, found `inner`"),
        ];
        for (i, (text, reason)) in refused.iter().enumerate() {
            let error = said(&format!("refused_{i}.stl"), text.as_bytes());
            assert!(error.contains(reason), "text {i}: {error}");
        }
        let (v, t) = raw_box([0.0; 3], [1.0; 3]);
        let mut binary = b"solid".to_vec();
        binary.resize(80, b' ');
        binary.extend((t.len() as u32).to_le_bytes());
        for corners in &t {
            binary.extend([0u8; 12]);
            binary.extend(corners.iter().flat_map(|c| v[*c]).flat_map(|c| (c as f32).to_le_bytes()));
            binary.extend([0u8; 2]);
        }
        assert!(TriangleMesh::read_stl(file("whole.stl", &binary), 1.0).is_ok());
        for (name, content, found) in [
            ("cut.stl", &binary[..600], 600),
            ("long.stl", &[&binary[..], &[0; 50]].concat()[..], 734),
            ("twice.stl", &[&binary[..], &binary[84..]].concat()[..], 1284),
        ] {
            let error = said(name, content);
            let reason = format!("of 12 triangles has 684 bytes, but {found} were found");
            assert!(error.contains(&reason), "{error}");
        }
        // Fewer bytes than those of a triangle may follow.
        assert!(TriangleMesh::read_stl(file("more.stl", &[&binary[..], &[7; 49]].concat()), 1.0).is_ok());
        binary[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
        let error = said("nan.stl", &binary);
        assert!(error.contains("triangle 1 (counted from 0): coordinate NaN"), "{error}");
        assert!(said("short.stl", b"hello").contains("at least 84 bytes (found 5)"));
    }

    #[test]
    fn obj_files_with_quads_and_groups_are_read() {
        let (v, _) = raw_box([0.0; 3], [2.0, 3.0, 4.0]);
        let mut text = String::from("# a box\n");
        for x in &v {
            writeln!(text, "v {} {} {}", x[0], x[1], x[2]).unwrap();
        }
        text.push_str("vn 0 0 1\ng bottom\nf 1//1 3//1 4//1 2//1\ng rest\nf 5 6 8 7\nf 1 2 6 5\n");
        text.push_str("f 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
        let solid = TriangleMesh::read_obj(file("box.obj", text.as_bytes()), 1e-3).unwrap();
        assert_eq!((solid.vertices().len(), solid.triangles().len()), (8, 12));
        assert!((solid.measure().unwrap() / 24e-9 - 1.0).abs() < 1e-12);
        let open = text.replace("f 2 4 8 6\n", "");
        let refused = TriangleMesh::read_obj(file("open.obj", open.as_bytes()), 1.0).unwrap_err();
        assert_eq!(refused, GeometryError::OpenMesh { open_edges: 4 });
        let bad = TriangleMesh::read_obj(file("bad.obj", b"v 1 2\nf 1 2 3\n"), 1.0);
        assert!(matches!(bad, Err(GeometryError::File { .. })));
    }
}

/// Benchmark: three million particles in a mesh. `cargo test --release -- --ignored`.
#[test]
#[ignore = "a measurement of seconds, which a busy machine fails"]
fn three_million_particles_are_quick_in_a_mesh() {
    let start = std::time::Instant::now();
    let globe = mesh(raw_revolved(&sphere_profile(200), 400));
    println!("{} triangles prepared in {:?}", globe.triangles().len(), start.elapsed());
    let lattice = Lattice::new([0.001, 0.002, 0.0], 2.0 / 90.0).unwrap();
    let knife = HalfSpace::new([0.3, 0.0, 0.6], [1.0, 0.3, -0.5]).unwrap();
    for filling in [Filling::new(), Filling::new().partial(4, 0.1), Filling::new().jittered(1, 1.0)] {
        for shape in [&globe as &dyn Shape<3>, &(&globe).and(knife)] {
            let start = std::time::Instant::now();
            let seeds = fill(shape, &lattice, 2, &filling).unwrap();
            println!("{} particles in {:?}: {filling:?}", seeds.len(), start.elapsed());
        }
    }
}

/// A fan of thin triangles, many pieces, many triangles: volumes and inside tests agree with the exact shapes.
#[test]
fn large_meshes_are_what_they_stand_for() {
    let solid = mesh(raw_revolved(&[[0.0, 0.0], [0.0, 1.0], [1.5, 0.0]], 40_000));
    assert!((solid.measure().unwrap() / (0.5 * PI) - 1.0).abs() < 1e-8);
    let lattice = Lattice::new([0.013, 0.007, 0.0], 0.1).unwrap();
    let cone = Frustum::new([0.0; 3], [0.0, 0.0, 1.0], 1.5, [1.0, 0.0]).unwrap();
    let filled =
        |filling: Filling| [&solid as &dyn Shape<3>, &cone].map(|s| fill(s, &lattice, 2, &filling).unwrap());
    let [a, b] = filled(Filling::new().at_sites());
    assert_eq!(a.positions, b.positions);
    // Fitted to the surface: results may differ by rounding only at the rim and the tip.
    let [a, b] = filled(Filling::new());
    let far = |(x, y): (&[f64; 3], &[f64; 3])| (0..3).map(|i| (x[i] - y[i]).abs()).fold(0.0, f64::max);
    let others = a.positions.iter().zip(&b.positions).map(far).filter(|d| *d > 1e-6).count();
    assert!(others * 50 < a.len(), "{others} of {}", a.len());

    let globe = mesh(raw_revolved(&sphere_profile(200), 500));
    let ball = Sphere::new([0.0; 3], 1.0).unwrap();
    let [a, b] =
        [&globe as &dyn Shape<3>, &ball].map(|s| fill(s, &lattice, 2, &Filling::new().at_sites()).unwrap());
    assert!((globe.measure().unwrap() / ball.measure().unwrap() - 1.0).abs() < 2e-4);
    assert!(a.len().abs_diff(b.len()) < 10, "{} {}", a.len(), b.len());

    let solid = mesh(raw_tetrahedra(50_000));
    assert_eq!(solid.triangles().len(), 200_000);
    assert!((solid.measure().unwrap() / (50_000.0 / 6.0) - 1.0).abs() < 1e-12);
    // Each tetrahedron contains one of the eight sites of its cell; the other seven are beyond its face.
    let lattice = Lattice::new([0.0; 3], 1.0).unwrap();
    let filling = Filling::new().at_sites().uncorrected();
    assert_eq!(fill(&solid, &lattice, 2, &filling).unwrap().len(), 50_000);
}

/// Benchmark of large meshes: `cargo test --release -- --ignored --nocapture large_meshes`.
#[test]
#[ignore = "a measurement of seconds, which a busy machine fails"]
fn large_meshes_are_quick() {
    let tetrahedra = raw_tetrahedra(50_000);
    let meshes = [
        ("cone of 40000 sides", raw_revolved(&[[0.0, 0.0], [0.0, 1.0], [1.5, 0.0]], 40_000), 0.05),
        ("sphere of a million", raw_revolved(&sphere_profile(500), 1000), 0.05),
        ("50000 tetrahedra", tetrahedra, 0.5),
    ];
    for (name, raw, spacing) in meshes {
        let start = std::time::Instant::now();
        let solid = mesh(raw);
        println!("{name}: {} triangles prepared in {:?}", solid.triangles().len(), start.elapsed());
        let lattice = Lattice::new([0.001, 0.002, 0.0], spacing).unwrap();
        for filling in [Filling::new().at_sites(), Filling::new()] {
            let start = std::time::Instant::now();
            let seeds = fill(&solid, &lattice, 2, &filling).unwrap();
            println!("{} particles in {:?}", seeds.len(), start.elapsed());
        }
    }
}
