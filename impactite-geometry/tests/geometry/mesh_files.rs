//! Gmsh and Abaqus readers: supported content, error messages, and no panic for corrupted files.

use impactite_geometry::*;
use proptest::prelude::*;

/// Two unit cubes in a row, with a physical volume `rod`, one face `impact`, and an arc centre that no element uses.
const GMSH: &str = r#"$MeshFormat
4.1 0 8
$EndMeshFormat
$Comments
two bricks, $Nodes that are none
$EndComments
$PhysicalNames
2
2 4 "impact face"
3 7 "rod"
$EndPhysicalNames
$Entities
1 0 1 1
9 5 5 5 0
3 0 0 0 0 1 1 1 4 0
1 0 0 0 2 1 1 1 7 1 3
$EndEntities
$Nodes
3 13 1 30
2 3 0 4
1
2
3
4
0 0 0
0 1 0
0 1 1
0 0 1
3 1 0 8
11
12
13
14
21
22
23
24
1 0 0
1 1 0
1 1 1
1 0 1
2 0 0
2 1 0
2 1 1
2 0 1
0 9 0 1
30
5 5 5
$EndNodes
$Elements
2 3 1 3
2 3 3 1
1 1 2 3 4
3 1 5 2
2 1 2 3 4 11 12 13 14
3 11 12 13 14 21 22 23 24
$EndElements
"#;

const ABAQUS: &str = "*HEADING
 a part of two bricks and a bar
** a comment
*PART, NAME=Rod
*Node, nset=All
1, 0., 0., 0.
2, 0., 1.0, 0
3, 0., 1., 1.D0
4, 0, 0, 1
11, 1, 0, 0
12, 1, 1, 0
13, 1, 1, 1
14, 1, 0, 1,
21, 2, 0, 0
22, 2, 1, 0
23, 2, 1, 1
24, 2, 0, 1
*Element, type=C3D8R
1, 1, 2, 3, 4, 11,
   12, 13, 14
2, 11, 12, 13, 14, 21, 22, 23, 24
*ELEMENT, TYPE=T3D2, ELSET=BARS
7, 1, 23
*Nset, nset=Left, generate
1, 4, 1
*NSET, NSET=Both
left, 24
*Elset, elset=Core, generate
1, 2
*Elset, elset=Second
2
*END PART
*MATERIAL, NAME=STEEL
*DENSITY
7850.,
";

fn gmsh(text: &str) -> Result<ElementMesh<3>, GeometryError> {
    ElementMesh::from_gmsh("test.msh", text.as_bytes(), 1.0)
}

fn abaqus(text: &str) -> Result<ElementMesh<3>, GeometryError> {
    ElementMesh::from_abaqus("test.inp", text.as_bytes(), 1.0)
}

#[test]
fn a_gmsh_file_becomes_blocks_and_sets() {
    let mesh = gmsh(GMSH).unwrap();
    assert_eq!(mesh.nodes.len(), 12, "the centre of an arc is dropped");
    assert_eq!(mesh.blocks.len(), 1);
    assert_eq!((mesh.blocks[0].name.as_str(), mesh.blocks[0].kind), ("rod", ElementKind::Hexa8));
    assert_eq!(mesh.node_sets["impact face"], [0, 1, 2, 3]);
    assert_eq!(mesh.node_sets["rod"].len(), 12);
    assert!((mesh.measure(Metric::Cartesian).unwrap() - 2.0).abs() < 1e-15);
    assert_eq!(mesh.surface().unwrap().len(), 10);
    let millimetres = ElementMesh::<3>::from_gmsh("test.msh", GMSH.as_bytes(), 1e-3).unwrap();
    assert!((millimetres.measure(Metric::Cartesian).unwrap() - 2e-9).abs() < 1e-23);
    assert_eq!(gmsh(&GMSH.replace('\n', "\r\n")).unwrap(), mesh);
    // Groups without names, and no groups at all.
    let (names, entities) = (GMSH.find("$PhysicalNames").unwrap(), GMSH.find("$Entities").unwrap());
    let nameless = gmsh(&format!("{}{}", &GMSH[..names], &GMSH[entities..])).unwrap();
    assert_eq!(nameless.blocks[0].name, "physical 7");
    assert_eq!(nameless.node_sets["physical 4"], [0, 1, 2, 3]);
    let nodes = GMSH.find("$Nodes\n").unwrap();
    let groupless = gmsh(&format!("{}{}", &GMSH[..names], &GMSH[nodes..])).unwrap();
    assert_eq!((groupless.blocks[0].name.as_str(), groupless.node_sets.len()), ("", 0));
    // Nodes with parametric coordinates, an option of Gmsh.
    let parametric = GMSH
        .replace("2 3 0 4", "2 3 1 4")
        .replace("0 0 0\n0 1 0\n0 1 1\n0 0 1\n", "0 0 0 .1 .2\n0 1 0 .1 .2\n0 1 1 .1 .2\n0 0 1 .1 .2\n");
    assert_eq!(gmsh(&parametric).unwrap(), mesh);
}

/// The mesh of `GMSH` in version 2.2, text or binary: nodes and elements one by one, with physical and elementary tags.
fn version_two(binary: bool) -> Vec<u8> {
    let nodes: [(i32, [f64; 3]); 13] = [
        (1, [0.0, 0.0, 0.0]),
        (2, [0.0, 1.0, 0.0]),
        (3, [0.0, 1.0, 1.0]),
        (4, [0.0, 0.0, 1.0]),
        (11, [1.0, 0.0, 0.0]),
        (12, [1.0, 1.0, 0.0]),
        (13, [1.0, 1.0, 1.0]),
        (14, [1.0, 0.0, 1.0]),
        (21, [2.0, 0.0, 0.0]),
        (22, [2.0, 1.0, 0.0]),
        (23, [2.0, 1.0, 1.0]),
        (24, [2.0, 0.0, 1.0]),
        (30, [5.0; 3]),
    ];
    let elements: [(i32, i32, &[i32]); 3] = [
        (3, 4, &[1, 2, 3, 4]),
        (5, 7, &[1, 2, 3, 4, 11, 12, 13, 14]),
        (5, 7, &[11, 12, 13, 14, 21, 22, 23, 24]),
    ];
    let mut out = format!("$MeshFormat\n2.2 {} 8\n", i32::from(binary)).into_bytes();
    if binary {
        out.extend(1i32.to_le_bytes());
        out.push(b'\n');
    }
    out.extend(b"$EndMeshFormat\n$PhysicalNames\n2\n2 4 \"impact face\"\n3 7 \"rod\"\n$EndPhysicalNames\n$Nodes\n13\n");
    for (tag, x) in nodes {
        if binary {
            out.extend(tag.to_le_bytes());
            x.iter().for_each(|c| out.extend(c.to_le_bytes()));
        } else {
            out.extend(format!("{tag} {} {} {}\n", x[0], x[1], x[2]).bytes());
        }
    }
    out.extend(b"$EndNodes\n$Elements\n3\n");
    for (n, (kind, group, corners)) in elements.into_iter().enumerate() {
        let number = n as i32 + 1;
        if binary {
            for word in [kind, 1, 2, number, group, 1].iter().chain(corners) {
                out.extend(word.to_le_bytes());
            }
        } else {
            let corners: Vec<String> = corners.iter().map(i32::to_string).collect();
            out.extend(format!("{number} {kind} 2 {group} 1 {}\n", corners.join(" ")).bytes());
        }
    }
    out.extend(b"$EndElements\n");
    out
}

/// All format versions of Gmsh give the same mesh.
#[test]
fn versions_of_gmsh_are_read_alike() {
    let newest = gmsh(GMSH).unwrap();
    for binary in [false, true] {
        let mesh = ElementMesh::<3>::from_gmsh("2.msh", &version_two(binary), 1.0).unwrap();
        assert_eq!(mesh, newest, "binary: {binary}");
    }
    // Version 4.0: tags of entities before dimensions, no smallest and largest tags, the tag of a node before its coordinates.
    let nodes = "$Nodes\n3 13\n3 2 0 4\n1 0 0 0\n2 0 1 0\n3 0 1 1\n4 0 0 1\n1 3 0 8\n11 1 0 0\n12 1 1 0\n13 1 1 1\n14 1 0 1\n\
                 21 2 0 0\n22 2 1 0\n23 2 1 1\n24 2 0 1\n9 0 0 1\n30 5 5 5\n$EndNodes\n";
    let elements = "$Elements\n2 3\n3 2 3 1\n1 1 2 3 4\n1 3 5 2\n2 1 2 3 4 11 12 13 14\n3 11 12 13 14 21 22 23 24\n$EndElements\n";
    let head = GMSH[..GMSH.find("$Nodes\n").unwrap()]
        .replace("4.1 0 8", "4 0 8")
        .replace("9 5 5 5 0", "9 5 5 5 5 5 5 0");
    let four = gmsh(&format!("{head}{nodes}{elements}")).unwrap();
    assert_eq!(four, newest);
    // Binary form of version 4.0: `s` is a size_t, `i` an int, `d` a double.
    let (start, entities) = head.split_at(head.find("$Entities\n").unwrap());
    let mut bytes = start.replace("4 0 8\n", "4 1 8\n@\n").into_bytes();
    let at = bytes.iter().position(|b| *b == b'@').unwrap();
    bytes.splice(at..=at, 1i32.to_le_bytes());
    let nodes_of = |count: usize| format!("iiis{}", "iddd".repeat(count));
    for (section, kinds) in [
        (entities, "ssss idddddds iddddddsis iddddddsisi".to_string()),
        (nodes, format!("ss{}{}{}", nodes_of(4), nodes_of(8), nodes_of(1))),
        (elements, format!("ss iiis iiiii iiis {}", "i".repeat(18))),
    ] {
        let (name, rest) = section.split_once('\n').unwrap();
        let (numbers, end) = rest.split_at(rest.find("$End").unwrap());
        bytes.extend(format!("{name}\n").bytes());
        let kinds = kinds.replace(' ', "");
        assert_eq!(numbers.split_whitespace().count(), kinds.len(), "{name}");
        for (kind, word) in kinds.chars().zip(numbers.split_whitespace()) {
            match kind {
                's' => bytes.extend(word.parse::<u64>().unwrap().to_le_bytes()),
                'i' => bytes.extend(word.parse::<i32>().unwrap().to_le_bytes()),
                _ => bytes.extend(word.parse::<f64>().unwrap().to_le_bytes()),
            }
        }
        bytes.extend(format!("\n{end}").bytes());
    }
    assert_eq!(ElementMesh::<3>::from_gmsh("4.msh", &bytes, 1.0).unwrap(), newest);
}

/// Version 2 repeats an element for every physical group: it is read once, for the first group, and its nodes are in all groups.
#[test]
fn elements_of_several_groups_are_read_once() {
    let file = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"all\"\n2 2 \"left\"\n$EndPhysicalNames\n\
                $Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 1 1 0\n$EndNodes\n\
                $Elements\n3\n1 2 2 1 1 1 2 3\n2 2 2 2 1 1 2 3\n3 2 2 1 1 2 4 3\n$EndElements\n";
    let mesh = ElementMesh::<2>::from_gmsh("groups.msh", file.as_bytes(), 1.0).unwrap();
    assert_eq!(mesh.measure(Metric::Cartesian).unwrap(), 1.0);
    assert_eq!((mesh.blocks.len(), mesh.blocks[0].name.as_str()), (1, "all"));
    assert_eq!((mesh.node_sets["all"].len(), mesh.node_sets["left"].len()), (4, 3));
}

/// Elements in several physical groups are in the element set of each, by their entity in version 4 and by repetition in version 2.
#[test]
fn an_element_is_in_every_physical_group_that_has_it() {
    let two = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"all\"\n2 2 \"left\"\n1 3 \"rim\"\n$EndPhysicalNames\n\
               $Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 1 1 0\n$EndNodes\n\
               $Elements\n4\n1 1 2 3 9 1 2\n2 2 2 2 1 1 2 3\n3 2 2 1 1 1 2 3\n4 2 2 1 1 2 4 3\n$EndElements\n";
    let four = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"all\"\n2 2 \"left\"\n1 3 \"rim\"\n$EndPhysicalNames\n\
                $Entities\n0 1 2 0\n5 0 0 0 1 0 0 1 3 0\n1 0 0 0 1 1 0 2 2 1 0\n2 0 0 0 1 1 0 1 1 0\n$EndEntities\n\
                $Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n$EndNodes\n\
                $Elements\n3 3 1 3\n1 5 1 1\n1 1 2\n2 1 2 1\n2 1 2 3\n2 2 2 1\n3 2 4 3\n$EndElements\n";
    for file in [two, four] {
        let mesh = ElementMesh::<2>::from_gmsh("groups.msh", file.as_bytes(), 1.0).unwrap();
        let groups: Vec<_> = mesh.groups().into_iter().collect();
        assert_eq!(groups, [("all", 2), ("left", 1)]);
        let left = mesh.only_groups(&["left"]).unwrap();
        assert_eq!((left.nodes.len(), left.measure(Metric::Cartesian).unwrap()), (3, 0.5));
        assert_eq!(left.bounds(), Bounds { min: [0.0; 2], max: [1.0; 2] });
        assert_eq!(left.node_sets["rim"], [0, 1]);
        let all = mesh.only_groups(&["all"]).unwrap();
        assert_eq!((all.elements(), all.measure(Metric::Cartesian).unwrap()), (2, 1.0));
    }
}

/// A prism, and a pyramid on one of its quadrilaterals, of first and second order.
#[test]
fn prisms_and_pyramids_become_tetrahedra() {
    for (prism, pyramid, more) in [(6, 7, [0, 0]), (13, 14, [12, 9]), (18, 19, [9, 8])] {
        let own = |corners: &str, more: usize| format!("{corners}{}", " 1".repeat(more));
        let file = format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n7\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 0 1\n6 0 1 1\n7 .5 -1 .5\n$EndNodes\n\
             $Elements\n2\n1 {prism} 0 {}\n2 {pyramid} 0 {}\n$EndElements\n",
            own("1 2 3 4 5 6", more[0]),
            own("1 4 5 2 7", more[1])
        );
        let mesh = gmsh(&file);
        let mesh = mesh.unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((mesh.elements(), mesh.blocks[0].kind), (5, ElementKind::Tetra4));
        assert!((mesh.measure(Metric::Cartesian).unwrap() - (0.5 + 1.0 / 3.0)).abs() < 1e-15);
        // Two triangles and two quadrilaterals of the prism, four triangles of the pyramid.
        assert_eq!(mesh.surface().unwrap().len(), 2 + 4 + 4);
    }
}

/// Second-order elements are read by their corners.
#[test]
fn second_order_is_read_by_corners() {
    let file = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 .5 0 0\n6 .5 .5 0\n7 0 .5 0\n\
                8 0 0 .5\n9 .5 0 .5\n10 0 .5 .5\n$EndNodes\n$Elements\n1\n1 11 2 7 1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n";
    let mesh = gmsh(file).unwrap();
    assert_eq!((mesh.nodes.len(), mesh.blocks[0].kind), (4, ElementKind::Tetra4));
    assert!((mesh.measure(Metric::Cartesian).unwrap() - 1.0 / 6.0).abs() < 1e-15);
}

/// A plane mesh may have third coordinates of rounding magnitude; a mesh that is not plane is an error.
#[test]
fn third_coordinates_of_rounding_are_none() {
    let file = |z: &str| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 {z}\n2 2 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n1 2 0 1 2 3\n$EndElements\n"
        )
    };
    let read = |z: &str| ElementMesh::<2>::from_gmsh("z.msh", file(z).as_bytes(), 1.0);
    assert_eq!(read("1e-17").unwrap().measure(Metric::Cartesian).unwrap(), 1.0);
    assert!(read("1e-6").unwrap_err().to_string().contains("beyond the 2"));
}

/// The file `GMSH` in binary form.
fn binary(big_endian: bool, long: bool) -> Vec<u8> {
    let mut out = Vec::new();
    let mut sections = GMSH.split_inclusive('\n').peekable();
    let put = |out: &mut Vec<u8>, bytes: &[u8]| {
        let mut bytes = bytes.to_vec();
        if big_endian {
            bytes.reverse();
        }
        out.extend(bytes);
    };
    // `s`: size_t, `i`: int, `d`: double.
    let encode = |out: &mut Vec<u8>, kinds: &str, words: &mut dyn Iterator<Item = &str>| {
        for kind in kinds.chars() {
            let word = words.next().unwrap();
            match kind {
                's' if long => put(out, &word.parse::<u64>().unwrap().to_le_bytes()),
                's' => put(out, &word.parse::<u32>().unwrap().to_le_bytes()),
                'i' => put(out, &word.parse::<i32>().unwrap().to_le_bytes()),
                _ => put(out, &word.parse::<f64>().unwrap().to_le_bytes()),
            }
        }
    };
    while let Some(line) = sections.next() {
        let kinds: Option<String> = match line.trim() {
            "4.1 0 8" => {
                out.extend(format!("4.1 1 {}\n", if long { 8 } else { 4 }).bytes());
                put(&mut out, &1i32.to_le_bytes());
                out.push(b'\n');
                continue;
            }
            // One point, one surface without bounding curves, one volume in a group with a bounding surface.
            "$Entities" => Some("ssss iddds iddddddsis iddddddsisi".into()),
            "$Nodes" => {
                Some(format!("ssss iiis ssss {} iiis ssssssss {} iiis s ddd", "d".repeat(12), "d".repeat(24)))
            }
            "$Elements" => Some(format!("ssss iiis sssss iiis {}", "s".repeat(18))),
            _ => None,
        };
        out.extend(line.bytes());
        if let Some(kinds) = kinds {
            let mut text = String::new();
            while sections.peek().is_some_and(|l| !l.starts_with("$End")) {
                text.push_str(sections.next().unwrap());
            }
            let kinds = kinds.replace(' ', "");
            encode(&mut out, &kinds, &mut text.split_whitespace());
            assert_eq!(text.split_whitespace().count(), kinds.len());
            out.push(b'\n');
        }
    }
    out
}

#[test]
fn binary_gmsh_files_are_read_alike() {
    let text = gmsh(GMSH).unwrap();
    for big_endian in [false, true] {
        for long in [false, true] {
            let bytes = binary(big_endian, long);
            assert_eq!(ElementMesh::<3>::from_gmsh("b.msh", &bytes, 1.0).unwrap(), text);
            for length in 0..bytes.len() - 1 {
                let cut = ElementMesh::<3>::from_gmsh("b.msh", &bytes[..length], 1.0);
                assert!(cut.is_err() || length + 12 > bytes.len(), "cut at {length}");
            }
        }
    }
}

#[test]
fn an_abaqus_file_becomes_blocks_and_sets() {
    let mesh = abaqus(ABAQUS).unwrap();
    let blocks: Vec<_> = mesh.blocks.iter().map(|b| (b.name.as_str(), b.kind, b.len())).collect();
    assert_eq!(blocks, [("Core", ElementKind::Hexa8, 2), ("BARS", ElementKind::Bar2, 1)]);
    assert_eq!(mesh.node_sets["Left"], [0, 1, 2, 3]);
    assert_eq!(mesh.node_sets["Both"], [0, 1, 2, 3, 11]);
    assert_eq!(mesh.node_sets["BARS"], [0, 10]);
    assert_eq!(mesh.node_sets["Second"].len(), 8);
    assert_eq!(mesh.node_sets["All"].len(), 12);
    assert!((mesh.measure_of(0, 1, Metric::Cartesian).unwrap() - 1.0).abs() < 1e-15);
    assert!((mesh.measure_of(1, 0, Metric::Cartesian).unwrap() - 6f64.sqrt()).abs() < 1e-15);
    assert_eq!(abaqus(&ABAQUS.replace('\n', "\r\n")).unwrap(), mesh);

    // Style of Abaqus/CAE: an assembly of one instance, sets that name the instance, and keywords that continue in the next line.
    let assembly = "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=Rod-1, PART=Rod\n*END INSTANCE\n\
        *NSET, NSET=Right,\n INSTANCE=Rod-1, INTERNAL\n21, 22, 23, 24,\n*END ASSEMBLY\n";
    let assembled = abaqus(&ABAQUS.replace("*END PART\n", &format!("*END PART\n{assembly}"))).unwrap();
    assert_eq!(assembled.node_sets["Right"], [8, 9, 10, 11]);
    assert_eq!(assembled.blocks, mesh.blocks);
    // A sparse range is read without a loop over all missing numbers.
    let sparse = ABAQUS.replace("24, 2, 0, 1\n", "24, 2, 0, 1\n18446744073709551611, 0, 0, 9\n");
    let sparse = abaqus(&sparse.replace("1, 4, 1\n", "1, 18446744073709551611, 10\n")).unwrap();
    assert_eq!(sparse.node_sets["Left"], [0, 4, 8], "1, 11, 21, and one that no element uses");
}

#[test]
fn plane_elements_of_either_sense_are_read_in_the_plane() {
    let nodes = "*NODE\n1, 0, 0\n2, 2, 0\n3, 2, 1\n4, 0, 1\n5, 3, 1\n";
    let elements = "*ELEMENT, TYPE=CAX4, ELSET=A\n1, 4, 3, 2, 1\n*ELEMENT, TYPE=CAX3, ELSET=A\n2, 2, 5, 3\n";
    let text = format!("{nodes}{elements}");
    let mesh = ElementMesh::<2>::from_abaqus("a.inp", text.as_bytes(), 1.0).unwrap();
    assert_eq!(mesh.measures(Metric::Cartesian).unwrap(), [2.0, 0.5]);
    assert_eq!(mesh.blocks.len(), 2);
    let lifted = text.replace("5, 3, 1", "5, 3, 1, 0.5");
    let said = ElementMesh::<2>::from_abaqus("a.inp", lifted.as_bytes(), 1.0).unwrap_err().to_string();
    assert_eq!(
        said,
        "cannot read a.inp: node 5 at [3.0, 1.0, 0.5] has a coordinate 0.5 beyond the 2 of the mesh; allowed is 0, to rounding"
    );
}

#[test]
fn bad_gmsh_files_are_refused_by_line_and_key() {
    let cases = [
        ("4.1 0 8", "1.0 0 8", "line 2: version = `1.0` is not allowed; allowed is 2.0 to 2.2, 4.0 or 4.1"),
        ("4.1 0 8", "4.1 3 8", "line 2: file type = `3`"),
        ("4.1 0 8", "4.1 0 2", "line 2: data size = `2`"),
        ("$MeshFormat\n", "", "line 1: word = `4.1` is not allowed; allowed is $MeshFormat"),
        ("2 4 \"impact face\"", "2 4 impact", "line 9: physical name = `impact`"),
        (
            "3 13 1 30",
            "3 14 1 30",
            "line 19: number of blocks and nodes = `14` is not allowed; allowed is 13",
        ),
        ("3 13 1 30", "4 13 1 30", "the dimension of an entity = `$EndNodes`"),
        ("2 3 0 4", "2 3 0 5", "line 25: tag of a node = `0` is not allowed; allowed is 1 or more"),
        ("\n21\n", "\n14\n", "tag of a node = `14` is not allowed; allowed is each tag once"),
        (
            "0 1 0\n",
            "0 nan 0\n",
            "line 26: a coordinate of a node = `NaN` is not allowed; allowed is a finite number",
        ),
        ("0 1 0\n", "0 1e999 0\n", "a coordinate of a node = `inf`"),
        ("0 1 0\n", "0 x 0\n", "line 26: a coordinate of a node = `x`"),
        (
            "3 1 5 2",
            "3 1 99 2",
            "line 54: type of elements = `99` is not allowed; allowed is points, lines, triangles",
        ),
        ("3 1 5 2", "3 1 3 2", "allowed is one of 3 dimensions"),
        ("3 1 5 2", "3 1 5 18446744073709551615", "the tag of an element = `$EndElements`"),
        (
            "1 1 2 3 4\n",
            "1 1 2 3 99\n",
            "line 53: node of an element = `99` is not allowed; allowed is the tag of a node",
        ),
        ("2 3 1 3\n2", "2 4 1 3\n2", "number of blocks and elements = `4` is not allowed; allowed is 3"),
        ("$Comments", "$PartitionedEntities", "a mesh that is not partitioned"),
        ("$Comments", "Comments", "line 4: section = `Comments`"),
        ("$EndComments", "$EndComment", "the file ends where $EndComments was expected"),
        ("$Nodes\n3", "$Elements\n3", "allowed is $Nodes before it"),
        (
            "11 12 13 14 21 22 23 24",
            "11 12 13 14 21 22 23 23",
            "element 1 of block 0 `rod` names node 10 twice",
        ),
        ("2 1 1\n", "1 1 1\n", "scaled Jacobian"),
    ];
    for (from, to, expected) in cases {
        assert!(GMSH.contains(from), "{from}");
        let said = gmsh(&GMSH.replacen(from, to, 1)).map(|_| ()).unwrap_err().to_string();
        assert!(said.starts_with("cannot read test.msh: "), "{said}");
        assert!(said.contains(expected), "{from:?} -> {to:?}: {said}\nexpected {expected}");
    }
    let nothing = gmsh("").unwrap_err().to_string();
    assert_eq!(nothing, "cannot read test.msh: line 1: the file ends where $MeshFormat was expected");
    let elements = GMSH.find("$Elements").unwrap();
    let said = gmsh(&GMSH[..elements]).unwrap_err().to_string();
    assert!(said.contains("there is no section $Elements"), "{said}");
    let said = ElementMesh::<2>::from_gmsh("a.msh", GMSH.as_bytes(), 1.0).unwrap_err().to_string();
    assert!(said.contains("beyond the 2 of the mesh"), "{said}");
    let said = ElementMesh::<3>::from_gmsh("a.msh", GMSH.as_bytes(), 0.0).unwrap_err().to_string();
    assert!(said.contains("unit = 0 is not allowed"), "{said}");
    let said = ElementMesh::<3>::read_gmsh("no such file.msh", 1.0).unwrap_err().to_string();
    assert!(said.starts_with("cannot read no such file.msh: "), "{said}");
}

#[test]
fn bad_abaqus_files_are_refused_by_line_and_key() {
    let cases = [
        (
            "type=C3D8R",
            "type=AC3D8",
            "line 18: TYPE of *ELEMENT = `AC3D8` is not allowed; allowed is one of C3D4, C3D5, C3D6, C3D8",
        ),
        ("type=C3D8R", "type=C3D27", "TYPE of *ELEMENT = `C3D27`"),
        (
            "type=C3D8R",
            "type=C3D20R",
            "line 21: the file ends where node 18 of element 1 (C3D20R) was expected",
        ),
        (", type=C3D8R", "", "line 18: *ELEMENT = `` is not allowed; allowed is a parameter TYPE=..."),
        (
            "nset=All",
            "system=S",
            "line 5: SYSTEM of *NODE = `S` is not allowed; allowed is R (rectangular) or C (cylindrical)",
        ),
        (
            "nset=All",
            "csys=C",
            "line 5: parameter of *NODE = `CSYS` is not allowed; allowed is one of NSET, SYSTEM, INPUT",
        ),
        (
            "2, 0., 1.0, 0",
            "1, 0., 1.0, 0",
            "line 7: node number = `1` is not allowed; allowed is each number once",
        ),
        ("2, 0., 1.0, 0", "2, 0., nan, 0", "line 7: coordinate = `nan`"),
        ("2, 0., 1.0, 0", "2, 0., 1.0x, 0", "line 7: coordinate = `1.0x`"),
        ("2, 0., 1.0, 0", "2", "line 7: number of coordinates = `0`"),
        ("2, 0., 1.0, 0", "-2, 0., 1.0, 0", "line 7: node number = `-2`"),
        ("   12, 13, 14", "   12, 13", "line 21: nodes of element 1 = `11` is not allowed"),
        (
            "   12, 13, 14",
            "   12, 13, 14, 21",
            "line 20: nodes of element 1 = `21` is not allowed; allowed is the 8 nodes of a C3D8R",
        ),
        ("7, 1, 23", "7, 1", "line 23: the file ends where node 2 of element 7 (T3D2) was expected"),
        ("7, 1, 23", "7, 1, 99", "line 23: node of an element = `99`"),
        ("7, 1, 23", "2, 1, 23", "line 23: element number = `2` is not allowed; allowed is each number once"),
        (
            "1, 4, 1",
            "1, 99, 1",
            "line 25: GENERATE = `99` is not allowed; allowed is a number that was defined",
        ),
        ("1, 4, 1", "4, 1, 1", "line 25: GENERATE = `4, 1, 1` is not allowed; allowed is first <= last"),
        ("1, 4, 1", "1, 4, 0", "an increment of at least 1"),
        ("left, 24", "right, 24", "line 27: member of *NSET = `right`"),
        (
            "*Elset, elset=Second",
            "*Elset",
            "line 30: *ELSET = `` is not allowed; allowed is a parameter ELSET=...",
        ),
        ("*END PART", "*NGEN", "line 32: keyword = `*NGEN`"),
        (
            "*END PART",
            "*PART, NAME=B",
            "line 32: keyword = `*PART` is not allowed; allowed is *END PART of `Rod` before it",
        ),
        ("*END PART", "*INSTANCE, NAME=I, PART=Rod\n", "allowed is *END PART of `Rod` before it"),
        ("*END PART", "**", "line 4: the file ends where *END PART of `Rod`, which begins in this line, was"),
        (
            "*END PART",
            "*END INSTANCE",
            "line 32: keyword = `*ENDINSTANCE` is not allowed; allowed is *INSTANCE",
        ),
        ("*END PART", "*END PART\n*PART, NAME=rod\n*END PART", "line 33: NAME of *PART = `rod`"),
        ("*END PART", "*END PART\n*PART, NAME=B\n*END PART", "the parts B, ROD have no *INSTANCE"),
        (
            "*END PART",
            "*END PART\n*INSTANCE, NAME=I, PART=B\n*END INSTANCE",
            "line 33: PART of *INSTANCE = `B` is not allowed; allowed is the name of a *PART before it",
        ),
        (
            "*END PART",
            "*END PART\n*INSTANCE, NAME=I, PART=Rod\n1, 2, 3, 4\n*END INSTANCE",
            "line 34: translation of *INSTANCE = `1, 2, 3, 4` is not allowed; allowed is three numbers",
        ),
        (
            "*END PART",
            "*END PART\n*INSTANCE, NAME=I, PART=Rod\n1, 2\n0,0,0, 0,0,0, 90\n*END INSTANCE",
            "line 35: rotation of *INSTANCE = `0,0,0, 0,0,0, 90` is not allowed; allowed is two different points",
        ),
        (
            "*END PART",
            "*END PART\n*NSET, NSET=A, INSTANCE=I\n1",
            "line 33: INSTANCE of *NSET = `I` is not allowed; allowed is the name of an *INSTANCE before it",
        ),
        ("*END PART", "*END PART\n*INCLUDE, INPUT=a.inp", "line 33: `a.inp` cannot be included: these bytes"),
        ("*HEADING\n a part of two bricks and a bar\n", "x", "line 1: first line = `x** a comment`"),
    ];
    for (from, to, expected) in cases {
        assert!(ABAQUS.contains(from), "{from}");
        let said = abaqus(&ABAQUS.replacen(from, to, 1)).map(|_| ()).unwrap_err().to_string();
        assert!(said.starts_with("cannot read test.inp: "), "{said}");
        assert!(said.contains(expected), "{from:?} -> {to:?}: {said}\nexpected {expected}");
    }
    assert!(abaqus("").unwrap_err().to_string().contains("the file has no element"));
}

/// Replace, remove or repeat bytes at given positions.
fn mutilate(bytes: &[u8], changes: &[(u16, u8, u8)]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for &(place, what, value) in changes {
        if bytes.is_empty() {
            break;
        }
        let place = place as usize % bytes.len();
        match what % 5 {
            0 => bytes[place] = value,
            1 => drop(bytes.remove(place)),
            2 => bytes.insert(place, value),
            3 => bytes[place] = b"0123456789-.,\n*$ "[value as usize % 17],
            _ => bytes.truncate(place.max(bytes.len() / 2)),
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn mutilated_files_never_panic(changes in proptest::collection::vec(any::<(u16, u8, u8)>(), 1..6)) {
        let newest = [GMSH.as_bytes().to_vec(), binary(false, true), binary(true, false)];
        let files = newest.into_iter().chain([version_two(false), version_two(true)]);
        for file in files {
            if let Ok(mesh) = ElementMesh::<3>::from_gmsh("m.msh", &mutilate(&file, &changes), 1.0) {
                prop_assert!(mesh.check().is_ok());
            }
        }
        let assembly = format!(
            "{ABAQUS}*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=Rod\n1,2\n0,0,0,0,0,1,90\n*NODE,SYSTEM=C\n5,1,30,2\n*END INSTANCE\n\
             *INSTANCE, NAME=J, PART=Rod\n*ELEMENT, TYPE=C3D6\n9,1,2,4,11,12,14\n*END INSTANCE\n*NSET, NSET=N, INSTANCE=J\nLeft, 3\n\
             *ELSET, ELSET=E\nI.Core, J.9\n*END ASSEMBLY\n"
        );
        for text in [ABAQUS, &assembly] {
            if let Ok(mesh) = ElementMesh::<3>::from_abaqus("m.inp", &mutilate(text.as_bytes(), &changes), 1.0) {
                prop_assert!(mesh.check().is_ok());
                for group in mesh.groups().keys() {
                    prop_assert!(mesh.only_groups(&[group]).is_ok_and(|part| part.check().is_ok()));
                }
            }
        }
    }

    #[test]
    fn any_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(ElementMesh::<3>::from_gmsh("m.msh", &bytes, 1.0).is_err());
        prop_assert!(ElementMesh::<2>::from_abaqus("m.inp", &bytes, 1.0).is_err());
        prop_assert!(TriangleMesh::from_stl("m.stl", &bytes, 1.0).is_err());
        prop_assert!(TriangleMesh::from_obj("m.obj", &bytes, 1.0).is_err());
        prop_assert!(TriangleMesh::from_ply("m.ply", &bytes, 1.0).is_err());
    }
}

/// Files written by Gmsh 4.15.2: a block of 2 x 1 x 3 m of bricks, with entities, physical groups of volume, face and point; a disc of
/// triangles with parametric coordinates of nodes on its rim.
#[test]
fn files_of_gmsh_itself_are_read() {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/");
    let read = |name: &str| ElementMesh::<3>::read_gmsh(format!("{data}{name}.msh"), 1.0).unwrap();
    let bricks = read("bricks");
    assert_eq!(read("bricks_binary"), bricks);
    let blocks: Vec<_> = bricks.blocks.iter().map(|b| (b.name.as_str(), b.kind, b.len())).collect();
    assert_eq!(blocks, [("block", ElementKind::Hexa8, 12)]);
    assert!((bricks.measure(Metric::Cartesian).unwrap() - 6.0).abs() < 1e-12);
    assert_eq!(bricks.surface().unwrap().len(), 2 * (4 + 6 + 6));
    assert_eq!(bricks.node_sets["corner"].len(), 1);
    assert_eq!(bricks.node_sets["bottom face"], bricks.nodes_where(|x| x[2] == 0.0));

    let disc = ElementMesh::<2>::read_gmsh(format!("{data}disc.msh"), 1.0).unwrap();
    let rim = disc.node_sets["rim"].len();
    // Area of the polygon of the rim nodes.
    let polygon = 0.5 * rim as f64 * (std::f64::consts::TAU / rim as f64).sin();
    assert!((disc.measure(Metric::Cartesian).unwrap() - polygon).abs() < 1e-10);
    assert_eq!(disc.surface().unwrap().len(), rim);
    // Gmsh writes 16 digits in text.
    let binary = ElementMesh::<2>::read_gmsh(format!("{data}disc_binary.msh"), 1.0).unwrap();
    assert_eq!((binary.blocks, binary.node_sets), (disc.blocks, disc.node_sets));
    for (a, b) in binary.nodes.as_flattened().iter().zip(disc.nodes.as_flattened()) {
        assert!((a - b).abs() < 1e-15);
    }
}

/// Error message of each reader for a file at `path`.
fn said(path: &std::path::Path) -> [String; 5] {
    fn said<X>(read: Result<X, GeometryError>) -> String {
        read.err().expect("refused").to_string()
    }
    [
        said(TriangleMesh::read_stl(path, 1.0)),
        said(TriangleMesh::read_obj(path, 1.0)),
        said(TriangleMesh::read_ply(path, 1.0)),
        said(ElementMesh::<3>::read_gmsh(path, 1.0)),
        said(ElementMesh::<3>::read_abaqus(path, 1.0)),
    ]
}

#[test]
fn a_file_of_another_kind_is_named_with_its_reader() {
    let folder = std::env::temp_dir().join(format!("impactite-kinds-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let kinds = [
        ("solid cube\nendsolid cube\n", "an STL file", "`TriangleMesh::read_stl`"),
        ("# cube\no cube\nv 0 0 0\n", "an OBJ file", "`TriangleMesh::read_obj`"),
        ("ply\nformat ascii 1.0\n", "a PLY file", "`TriangleMesh::read_ply`"),
        (GMSH, "a Gmsh file of elements", "`ElementMesh::read_gmsh`"),
        ("** cube\n*NODE\n1, 0., 0., 0.\n", "an Abaqus file of elements", "`ElementMesh::read_abaqus`"),
    ];
    for (n, (text, kind, reader)) in kinds.iter().enumerate() {
        let path = folder.join("file");
        std::fs::write(&path, text).unwrap();
        // The Gmsh reader accepts the Gmsh file and finds no mesh in the others.
        let names_kind = |path: &std::path::Path, k: usize| match k {
            0 => TriangleMesh::read_stl(path, 1.0).err(),
            1 => TriangleMesh::read_obj(path, 1.0).err(),
            2 => TriangleMesh::read_ply(path, 1.0).err(),
            3 => ElementMesh::<3>::read_gmsh(path, 1.0).err(),
            _ => ElementMesh::<3>::read_abaqus(path, 1.0).err(),
        };
        for k in 0..5 {
            let said = names_kind(&path, k).map_or(String::new(), |e| e.to_string());
            assert_eq!(said.contains(kind) && said.contains(reader), k != n, "{k}: {said}");
        }
    }
    std::fs::write(folder.join("file"), "ISO-10303-21;\n").unwrap();
    assert!(said(&folder.join("file")).iter().all(|s| s.contains("it is a STEP file")));
    assert!(said(&folder).iter().all(|s| s.contains("it is a folder; it must be a regular file")));
    std::fs::remove_dir_all(folder).unwrap();
}

/// Pipes and devices are not opened: they may be endless or block.
#[cfg(target_os = "linux")]
#[test]
fn pipes_and_devices_are_refused() {
    let pipe = std::env::temp_dir().join(format!("impactite-pipe-{}", std::process::id()));
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for path in [&pipe, std::path::Path::new("/dev/zero")] {
        let said = said(path);
        assert!(
            said.iter().all(|s| s.contains("it is a pipe or device; it must be a regular file")),
            "{said:?}"
        );
    }
    std::fs::remove_file(pipe).unwrap();
}
