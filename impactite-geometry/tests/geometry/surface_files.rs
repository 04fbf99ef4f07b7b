//! STL, OBJ and PLY readers: variants of the formats in practice.

use impactite_geometry::*;
use proptest::prelude::*;

/// Check the box of 1 x 2 x 3 of the files below, four of whose faces are quadrilaterals: volume and centroid are exact.
fn assert_box(what: &str, mesh: Result<TriangleMesh, GeometryError>, triangles: usize) {
    let mesh = mesh.unwrap_or_else(|e| panic!("{what}: {e}"));
    assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (8, triangles), "{what}");
    assert_eq!(mesh.bounds(), Bounds { min: [0.0; 3], max: [1.0, 2.0, 3.0] }, "{what}");
    // Rounding of a sum of twelve volumes of up to two.
    assert!((mesh.measure().unwrap() - 6.0).abs() < 1e-14, "{what}");
}

const CORNERS: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 2.0, 0.0],
    [0.0, 2.0, 0.0],
    [0.0, 0.0, 3.0],
    [1.0, 0.0, 3.0],
    [1.0, 2.0, 3.0],
    [0.0, 2.0, 3.0],
];

/// Faces of the box, oriented outwards; two quadrilaterals are already split into triangles.
const FACES: [&[usize]; 8] = [
    &[0, 3, 2, 1],
    &[4, 5, 6, 7],
    &[0, 1, 5, 4],
    &[1, 2, 6, 5],
    &[2, 3, 7],
    &[2, 7, 6],
    &[3, 0, 4],
    &[3, 4, 7],
];

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nv 0 0 3\nv 1 0 3\nv 1 2 3\nv 0 2 3\n\
    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";

#[test]
fn dialects_of_obj_are_read_alike() {
    let dialects = [
        ("plain", OBJ.to_string()),
        ("byte order mark", format!("\u{feff}{OBJ}")),
        ("carriage returns alone", OBJ.replace('\n', "\r")),
        ("carriage return and line feed", OBJ.replace('\n', "\r\n")),
        ("continued lines", OBJ.replace("f 1 4 3 2", "f 1 4 \\\n 3 2").replace("v 1 0 3", "v 1 \\\n0 \\\n3")),
        ("continued lines of Windows", OBJ.replace("f 1 4 3 2", "f 1 4 \\\n 3 2").replace('\n', "\r\n")),
        ("a last line that goes on", format!("{}\\", OBJ.trim_end())),
        ("a last line without an end", OBJ.trim_end().to_string()),
        ("comments", OBJ.replace("v 1 0 0", "v 1 0 0 # 2").replace("f 4 1 5", "f 4 1 5 # 3")),
        ("materials without name", format!("mtllib\nusemtl\n{OBJ}usemtl \n")),
        ("weights", OBJ.replace("v 1 0 0", "v 1 0 0 1.0")),
        ("colours", OBJ.replace("v 1 0 0", "v 1 0 0 0.5 0.5 0.5")),
        ("textures and normals that are not there", OBJ.replace("f 3 4 8\n", "f 3/7/9 4//9 8/7\n")),
        ("numbers from the end", OBJ.replace("f 1 4 3 2", "f -8 -5 -6 -7")),
        ("numbers from the end, with textures", OBJ.replace("f 1 4 3 2", "f -8/-1/-1 -5//-1 -6/1 -7")),
        (
            "groups, smoothing, points, lines",
            format!("o a\ng b c\ns off\n{OBJ}p 1\nl 1 2\nvn 0 0 1\nvt 0 0\nvp 1\n"),
        ),
        ("faces before vertices", {
            let (vertices, faces) = OBJ.split_at(OBJ.find('f').unwrap());
            format!("{faces}{vertices}")
        }),
        ("blanks and exponents", OBJ.replace("v 1 0 0", "  v\t+1.E0   -0.0 0e5  ")),
    ];
    for (what, text) in dialects {
        assert_box(what, TriangleMesh::from_obj("box.obj", text.as_bytes(), 1.0), 12);
    }
    // Prism on a hexagon: two polygons of six corners.
    let mut prism = String::new();
    for z in [0, 1] {
        for [x, y] in [[2, 0], [4, 0], [6, 2], [4, 4], [2, 4], [0, 2]] {
            prism.push_str(&format!("v {x} {y} {z}\n"));
        }
    }
    prism.push_str("f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n");
    (1..=6).for_each(|n| prism.push_str(&format!("f {n} {} {} {}\n", n % 6 + 1, n % 6 + 7, n + 6)));
    let prism = TriangleMesh::from_obj("prism.obj", prism.as_bytes(), 0.5).unwrap();
    assert_eq!((prism.triangles().len(), prism.measure()), (20, Some(16.0 * 0.125)));
}

#[test]
fn bad_obj_files_are_refused_by_line() {
    for (from, to, expected) in [
        (
            "v 1 0 3",
            "v 1 0",
            "line 6: coordinate of a vertex = `` is not allowed; allowed is a finite number",
        ),
        ("v 1 0 3", "v 1 0,5 3", "line 6: coordinate of a vertex = `0,5`"),
        ("v 1 0 3", "v 1 nan 3", "line 6: coordinate of a vertex = `nan`"),
        ("v 1 0 3", "v 1 1e999 3", "line 6: coordinate of a vertex = `1e999`"),
        (
            "f 3 4 8",
            "f 3 4",
            "line 13: face = `2 vertices` is not allowed; allowed is three vertices or more",
        ),
        (
            "f 3 4 8",
            "f 3 0 8",
            "line 13: vertex of a face = `0` is not allowed; allowed is the number of a vertex",
        ),
        ("f 3 4 8", "f 3 x/1 8", "line 13: vertex of a face = `x/1`"),
        ("f 3 4 8", "f 3 -9 8", "line 13: vertex of a face = `-9`"),
        ("f 3 4 8", "f 3 -9223372036854775808 8", "line 13: vertex of a face = `-9223372036854775808`"),
        (
            "f 3 4 8",
            "f 3 9 8",
            "line 13: vertex of a face = `9` is not allowed; allowed is at most 8, the number of",
        ),
        ("f 3 4 8", "f 3 9223372036854775807 8", "vertex of a face = `9223372036854775807`"),
        ("v 1 0 3", "v 1 \\\n 0 \\\n z", "line 6: coordinate of a vertex = `z`"),
    ] {
        let said =
            TriangleMesh::from_obj("box.obj", OBJ.replace(from, to).as_bytes(), 1.0).unwrap_err().to_string();
        assert!(
            said.starts_with("cannot read box.obj: ") && said.contains(expected),
            "{said}\nexpected {expected}"
        );
    }
    assert_eq!(TriangleMesh::from_obj("none.obj", b"", 1.0).unwrap_err(), GeometryError::EmptyMesh);
}

/// Number types of a PLY file.
struct Types {
    coordinate: &'static str,
    length: &'static str,
    corner: &'static str,
}

/// Append a number of a type, in the byte order of the file.
fn put(out: &mut Vec<u8>, kind: &str, value: f64, big_endian: bool) {
    let mut bytes = match kind {
        "char" | "int8" => (value as i8).to_le_bytes().to_vec(),
        "uchar" | "uint8" => (value as u8).to_le_bytes().to_vec(),
        "short" | "int16" => (value as i16).to_le_bytes().to_vec(),
        "ushort" | "uint16" => (value as u16).to_le_bytes().to_vec(),
        "int" | "int32" => (value as i32).to_le_bytes().to_vec(),
        "uint" | "uint32" => (value as u32).to_le_bytes().to_vec(),
        "float" | "float32" => (value as f32).to_le_bytes().to_vec(),
        "double" | "float64" => value.to_le_bytes().to_vec(),
        other => panic!("{other}"),
    };
    if big_endian {
        bytes.reverse();
    }
    out.extend(bytes);
}

/// Write the box as a PLY file with additional elements and properties; `end` is the line ending.
fn ply(format: &str, types: &Types, end: &str) -> Vec<u8> {
    let Types { coordinate, length, corner } = types;
    let header = format!(
        "ply\nformat {format} 1.0\ncomment made by hand, element vertex 3\nobj_info 12\n\
         element camera 1\nproperty float focus\nproperty list uchar double lens\n\
         element vertex 8\nproperty {coordinate} z\nproperty uchar red\nproperty {coordinate} x\nproperty {coordinate} y\n\
         property list ushort short tags\n\
         element face 8\nproperty short material\nproperty list {length} {corner} vertex_indices\nproperty float quality\n\
         element edge 2\nproperty int vertex1\nproperty int vertex2\nelement nothing 3\nend_header\n"
    );
    let mut out = header.replace('\n', end).into_bytes();
    // Numbers with their types, one row per element.
    let mut rows: Vec<Vec<(&str, f64)>> =
        vec![vec![("float", f64::NAN), ("uchar", 2.0), ("double", 1.5), ("double", -1e99)]];
    for (n, [x, y, z]) in CORNERS.iter().enumerate() {
        let place = [(*coordinate, *z), ("uchar", 255.0), (coordinate, *x), (coordinate, *y)];
        let tags = vec![("short", -7.0); n % 3];
        rows.push(place.into_iter().chain([("ushort", tags.len() as f64)]).chain(tags).collect());
    }
    for face in FACES {
        let corners = face.iter().map(|&n| (*corner, n as f64));
        let row = [("short", -1.0), (*length, face.len() as f64)].into_iter().chain(corners);
        rows.push(row.chain([("float", 0.25)]).collect());
    }
    rows.extend([vec![("int", 0.0), ("int", 1.0)], vec![("int", 1.0), ("int", 2.0)]]);
    for row in rows {
        if format == "ascii" {
            let words: Vec<String> = row.iter().map(|(_, value)| value.to_string()).collect();
            out.extend(format!("{}{end}", words.join(" ")).bytes());
        } else {
            row.iter().for_each(|(kind, value)| put(&mut out, kind, *value, format == "binary_big_endian"));
        }
    }
    out
}

const FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];
const FLOATS: Types = Types { coordinate: "float", length: "uchar", corner: "int" };

#[test]
fn dialects_of_ply_are_read_alike() {
    let all = [
        FLOATS,
        Types { coordinate: "double", length: "uint8", corner: "uint32" },
        Types { coordinate: "float32", length: "int", corner: "ushort" },
        Types { coordinate: "float64", length: "char", corner: "int8" },
        Types { coordinate: "short", length: "uint16", corner: "uchar" },
        Types { coordinate: "int16", length: "short", corner: "int16" },
        Types { coordinate: "int8", length: "uint", corner: "uint16" },
        Types { coordinate: "uint8", length: "int32", corner: "short" },
    ];
    for format in FORMATS {
        for types in &all {
            for end in ["\n", "\r\n", "\r"] {
                let what = format!("{format}, {} {end:?}", types.coordinate);
                let bytes = ply(format, types, end);
                assert_box(&what, TriangleMesh::from_ply("box.ply", &bytes, 1.0), 12);
                // A line feed, or zeros, at the end.
                assert_box(
                    &what,
                    TriangleMesh::from_ply("box.ply", &[&bytes[..], b"\n \n"].concat(), 1.0),
                    12,
                );
                assert_box(
                    &what,
                    TriangleMesh::from_ply("box.ply", &[&bytes[..], &[0; 5]].concat(), 1.0),
                    12,
                );
                // Alternative name of the list of vertex indices.
                let other = String::from_utf8_lossy(&bytes).find("vertex_indices").unwrap();
                let renamed = [&bytes[..other], b"vertex_index", &bytes[other + 14..]].concat();
                assert_box(&what, TriangleMesh::from_ply("box.ply", &renamed, 1.0), 12);
            }
        }
    }
    // Text is read in double precision, whatever type the header declares.
    let text = String::from_utf8(ply("ascii", &FLOATS, "\n")).unwrap().replace("3 255 0 2 ", "3.1 255 0 2 ");
    let mesh = TriangleMesh::from_ply("box.ply", text.as_bytes(), 1.0).unwrap();
    assert!(mesh.vertices().contains(&[0.0, 2.0, 3.1]));
}

#[test]
fn bad_ply_files_are_refused_by_line_or_byte() {
    let text = String::from_utf8(ply("ascii", &FLOATS, "\n")).unwrap();
    for (from, to, expected) in [
        ("ply\n", "polygon\n", "line 1: first line = `polygon` is not allowed; allowed is ply"),
        ("format ascii 1.0\n", "", "the header has no line format; allowed is format ascii 1.0"),
        ("ascii 1.0", "ascii 2.0", "line 2: format = `format ascii 2.0` is not allowed"),
        ("ascii", "middle_endian", "allowed is format ascii, binary_little_endian or binary_big_endian 1.0"),
        ("element vertex 8", "element vertex many", "line 8: element = `element vertex many`"),
        (
            "element edge",
            "element face",
            "line 18: element = `element face 2` is not allowed; allowed is each element once",
        ),
        (
            "property float z",
            "property half z",
            "line 9: property = `property half z` is not allowed; allowed is property TYPE",
        ),
        ("property float z", "property list float z", "line 9: property = `property list float z`"),
        (
            "property float z",
            "property float w",
            "the vertices have no places; allowed is element vertex with properties x, y",
        ),
        ("element vertex 8", "element point 8", "the vertices have no places"),
        (
            "vertex_indices",
            "corners",
            "the faces have no corners; allowed is element face with a list vertex_indices",
        ),
        (
            "element camera 1\n",
            "",
            "line 5: property = `property float focus` is not allowed; allowed is an element before it",
        ),
        ("end_header\n", "", "line of the header = "),
        ("obj_info 12", "information 12", "line 4: line of the header = `information 12`"),
        (
            "0 255 1 2 ",
            "0 255 one 2 ",
            "property x of element vertex = `one` is not allowed; allowed is a number",
        ),
        (
            "0 255 1 2 ",
            "0 255 inf 2 ",
            "line 26: coordinate of a vertex = `inf` is not allowed; allowed is a finite number",
        ),
        ("0 255 1 2 2", "0 255 1 2 -2", "length of property tags of element vertex = `-2`"),
        ("0 255 1 2 2", "0 255 1 2 3", "the file ends where property tags of element vertex was expected"),
        (
            "0 255 1 2 2",
            "0 255 1 2 1",
            "line of element vertex = `-7` is not allowed; allowed is the numbers of its properties",
        ),
        (
            "-1 4 0 3 2 1",
            "-1 4 0 3 8 1",
            "line 32: vertex of a face = `8` is not allowed; allowed is a whole number from 0, less than 8",
        ),
        ("-1 4 0 3 2 1", "-1 4 0 3 0.5 1", "vertex of a face = `0.5`"),
        (
            "-1 4 0 3 2 1",
            "-1 2 0 3",
            "line 32: face = `2 vertices` is not allowed; allowed is three vertices or more",
        ),
        ("element edge 2", "element edge 3", "the file ends where element edge was expected"),
        (
            "element edge 2",
            "element edge 1",
            "rest of the file = `1 2` is not allowed; allowed is nothing after",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let said = TriangleMesh::from_ply("box.ply", text.replacen(from, to, 1).as_bytes(), 1.0);
        let said = said.err().unwrap_or_else(|| panic!("{from:?} -> {to:?} is read")).to_string();
        assert!(
            said.starts_with("cannot read box.ply: ") && said.contains(expected),
            "{said}\nexpected {expected}"
        );
    }
    for format in FORMATS {
        let bytes = ply(format, &FLOATS, "\n");
        for length in 0..bytes.len() {
            let cut = TriangleMesh::from_ply("box.ply", &bytes[..length], 1.0);
            // The last line of a text file needs no line ending.
            assert!(cut.is_err() || (format == "ascii" && length + 1 >= bytes.len()), "{format}, {length}");
        }
    }
    let said =
        TriangleMesh::from_ply("a.ply", &ply(FORMATS[1], &FLOATS, "\n")[..600], 1.0).unwrap_err().to_string();
    assert!(said.contains("byte 600: the file ends where property"), "{said}");
}

/// Write the box as an STL file.
fn stl(binary: bool) -> Vec<u8> {
    let triangles = FACES.iter().flat_map(|f| f.windows(2).skip(1).map(|edge| [f[0], edge[0], edge[1]]));
    let mut out = Vec::new();
    if binary {
        // The binary header begins with the keyword of text files.
        out.extend(b"solid made by hand");
        out.resize(80, b' ');
        out.extend(12u32.to_le_bytes());
    } else {
        out.extend(b"solid made by hand\n");
    }
    for triangle in triangles {
        let corners = triangle.map(|n| CORNERS[n]);
        if binary {
            out.extend([0; 12]);
            out.extend(corners.as_flattened().iter().flat_map(|c| (*c as f32).to_le_bytes()));
            out.extend([0x41, 0x80]);
        } else {
            out.extend(b"facet normal 0 0 0\nouter loop\n");
            corners.iter().for_each(|[x, y, z]| out.extend(format!("vertex {x} {y} {z}\n").bytes()));
            out.extend(b"endloop\nendfacet\n");
        }
    }
    if !binary {
        out.extend(b"endsolid made by hand\n");
    }
    out
}

#[test]
fn dialects_of_stl_are_read_alike() {
    let (text, binary) = (String::from_utf8(stl(false)).unwrap(), stl(true));
    let half = text.match_indices("facet normal").nth(6).unwrap().0;
    let texts = [
        ("plain", text.clone()),
        ("capitals", text.to_uppercase()),
        (
            "capital words",
            text.replace("solid", "Solid").replace("facet", "Facet").replace("vertex", "Vertex"),
        ),
        ("carriage returns alone", text.replace('\n', "\r")),
        ("several solids", format!("{}endsolid\nsolid again\n{}", &text[..half], &text[half..])),
        ("blank lines", text.replace('\n', "\n\n \t")),
    ];
    for (what, text) in texts {
        assert_box(what, TriangleMesh::from_stl("box.stl", text.as_bytes(), 1.0), 12);
    }
    for more in [0, 1, 2, 49] {
        let bytes = [&binary[..], &vec![b'x'; more]].concat();
        assert_box("trailing bytes", TriangleMesh::from_stl("box.stl", &bytes, 1.0), 12);
    }
    let said =
        TriangleMesh::from_stl("box.stl", &[&binary[..], &[0; 50]].concat(), 1.0).unwrap_err().to_string();
    assert!(said.contains("of 12 triangles has 684 bytes, but 734 were found"), "{said}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn mutilated_files_never_panic(changes in proptest::collection::vec(any::<(u16, u8, u8)>(), 1..6)) {
        let changed = |mut bytes: Vec<u8>| {
            for &(place, what, value) in &changes {
                let place = place as usize % bytes.len().max(1);
                match what % 5 {
                    _ if bytes.is_empty() => {}
                    0 => bytes[place] = value,
                    1 => drop(bytes.remove(place)),
                    2 => bytes.insert(place, value),
                    3 => bytes[place] = b"0123456789-.,\n/\\ "[value as usize % 17],
                    _ => bytes.truncate(place.max(bytes.len() / 2)),
                }
            }
            bytes
        };
        for format in FORMATS {
            let _ = TriangleMesh::from_ply("m.ply", &changed(ply(format, &FLOATS, "\n")), 1.0);
        }
        for binary in [false, true] {
            let _ = TriangleMesh::from_stl("m.stl", &changed(stl(binary)), 1.0);
        }
        let _ = TriangleMesh::from_obj("m.obj", &changed(OBJ.as_bytes().to_vec()), 1.0);
    }
}
