//! Abaqus and CalculiX input files in practice: element types, parts, sets, included files.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use impactite_geometry::*;

fn read<const D: usize>(text: &str) -> Result<ElementMesh<D>, GeometryError> {
    ElementMesh::from_abaqus("test.inp", text.as_bytes(), 1.0)
}

fn solid(text: &str) -> ElementMesh<3> {
    read(text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn said<const D: usize>(text: &str) -> String {
    read::<D>(text).err().unwrap_or_else(|| panic!("it is read:\n{text}")).to_string()
}

fn volume<const D: usize>(mesh: &ElementMesh<D>) -> f64 {
    mesh.measure(Metric::Cartesian).unwrap()
}

/// One element of a type: its corners, then remote mid-side nodes, eight numbers per line.
fn one(kind: &str, corners: &[[f64; 3]], nodes: usize) -> String {
    let mut text = String::from("*NODE\n");
    for n in 0..nodes {
        let [x, y, z] = corners.get(n).copied().unwrap_or([50.0, 50.0, 0.0]);
        writeln!(text, "{}, {x}, {y}, {z}", 10 * n + 1).unwrap();
    }
    write!(text, "*ELEMENT, TYPE={kind}\n7").unwrap();
    for n in 0..nodes {
        text.push_str(if n % 8 == 7 { ",\n" } else { ", " });
        write!(text, "{}", 10 * n + 1).unwrap();
    }
    text + "\n"
}

const CUBE: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];

/// Every type with its volume or area and its number of elements. All are sums of few products of zeros and ones.
#[test]
fn types_of_elements_are_read_by_their_corners() {
    let tetra = [CUBE[0], CUBE[1], CUBE[3], CUBE[4]];
    let wedge = [CUBE[0], CUBE[1], CUBE[3], CUBE[4], CUBE[5], CUBE[7]];
    let pyramid = [CUBE[0], CUBE[1], CUBE[2], CUBE[3], CUBE[6]];
    type Case<'a> = (&'a [&'a str], &'a [[f64; 3]], usize, f64, usize);
    let solids: [Case; 7] = [
        (&["C3D4", "C3D4H", "c3d4t"], &tetra, 4, 1.0 / 6.0, 1),
        (&["C3D10", "C3D10M", "C3D10MH", "C3D10HS", "C3D10T"], &tetra, 10, 1.0 / 6.0, 1),
        (&["C3D8", "C3D8R", "C3D8I", "C3D8H", "C3D8RH", "C3D8RT", "C3D8P"], &CUBE, 8, 1.0, 1),
        (&["C3D20", "C3D20R", "C3D20RH"], &CUBE, 20, 1.0, 1),
        (&["C3D6", "C3D6H"], &wedge, 6, 0.5, 3),
        (&["C3D15", "C3D15H"], &wedge, 15, 0.5, 3),
        (&["C3D5"], &pyramid, 5, 1.0 / 3.0, 2),
    ];
    for (kinds, corners, nodes, exact, count) in solids {
        for kind in kinds {
            let mesh = solid(&one(kind, corners, nodes));
            assert_eq!((mesh.nodes.len(), mesh.elements()), (corners.len(), count), "{kind}");
            assert!((volume(&mesh) - exact).abs() < 1e-15, "{kind}");
        }
    }
    let triangle = [CUBE[0], CUBE[1], CUBE[3]];
    for stem in ["CPS", "CPE", "CAX", "S", "M3D"] {
        for (number, corners, exact) in
            [(3, &triangle[..], 0.5), (4, &CUBE[..4], 1.0), (6, &triangle[..], 0.5), (8, &CUBE[..4], 1.0)]
        {
            for letters in ["", "R", "H", "T", "RHT"] {
                let mesh: ElementMesh<2> =
                    read(&one(&format!("{stem}{number}{letters}"), corners, number)).unwrap();
                assert_eq!((mesh.elements(), volume(&mesh)), (1, exact), "{stem}{number}{letters}");
            }
        }
    }
    for kind in ["T2D2", "T3D2", "T3D2H", "B21", "B31", "B31R", "B31H"] {
        let bar: ElementMesh<2> = read(&one(kind, &CUBE[..2], 2)).unwrap();
        assert_eq!((bar.blocks[0].kind, volume(&bar)), (ElementKind::Bar2, 1.0), "{kind}");
    }
    // A beam may have a third node for its orientation.
    let beams = "*NODE\n1, 0, 0\n2, 1, 0\n3, 2, 0\n9, 0, 1\n*ELEMENT, TYPE=B31\n1, 1, 2, 9\n2, 2, 3\n";
    assert_eq!(read::<2>(beams).unwrap().blocks[0].nodes, [0, 1, 1, 2]);
    for kind in ["C3D27", "AC3D8", "DC3D8", "CGAX4", "C3D8X", "C3D", "MASS", "B32", "T3D3", "SC8R", "EC3D8R"]
    {
        let text = one(kind, &CUBE, 8);
        let expected =
            format!("line 10: TYPE of *ELEMENT = `{kind}` is not allowed; allowed is one of C3D4, C3D5");
        assert!(said::<3>(&text).contains(&expected), "{}", said::<3>(&text));
    }
}

/// Next number of a fixed pseudorandom sequence.
fn random(state: &mut u64) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 33) as usize
}

/// Columns of wedges with any node numbering: the tetrahedra fill the column and have no internal free face.
#[test]
fn wedges_and_pyramids_become_tetrahedra_that_conform() {
    let mut state = 5;
    for _ in 0..200 {
        // Node numbering of three levels of a square.
        let mut order: Vec<usize> = (0..12).collect();
        for n in (1..12).rev() {
            order.swap(n, random(&mut state) % (n + 1));
        }
        let mut text = String::from("*NODE\n");
        for &n in &order {
            let [x, y, _] = CUBE[n % 4];
            writeln!(text, "{}, {x}, {y}, {}", n + 1, n / 4).unwrap();
        }
        text.push_str("*ELEMENT, TYPE=C3D6, ELSET=COLUMN\n");
        let mut number = 0;
        for level in [0, 4] {
            for corners in [[0, 1, 2], [0, 2, 3]] {
                // Random first corner, and random order of the two triangles.
                let turn = random(&mut state) % 3;
                let mut lower = [0, 1, 2].map(|i| corners[(i + turn) % 3] + level + 1);
                let mut upper = lower.map(|n| n + 4);
                if random(&mut state).is_multiple_of(2) {
                    (lower, upper) = (upper, lower);
                    (lower, upper) = ([lower[0], lower[2], lower[1]], [upper[0], upper[2], upper[1]]);
                }
                number += 1;
                let nodes: Vec<String> = lower.iter().chain(&upper).map(ToString::to_string).collect();
                writeln!(text, "{number}, {}", nodes.join(", ")).unwrap();
            }
        }
        let mesh = solid(&text);
        assert_eq!((mesh.elements(), mesh.element_sets["COLUMN"].len()), (12, 12));
        assert!((volume(&mesh) - 2.0).abs() < 1e-14, "sum of twelve volumes");
        assert_eq!(mesh.surface().unwrap().len(), 2 * 2 + 2 * 8, "{text}");
    }
    // Six pyramids with their tips at the centre of a cube.
    let mut text = String::from("*NODE\n9, 0.5, 0.5, 0.5\n");
    for (n, [x, y, z]) in CUBE.iter().enumerate() {
        writeln!(text, "{}, {x}, {y}, {z}", n + 1).unwrap();
    }
    text.push_str("*ELEMENT, TYPE=C3D5\n");
    for (n, face) in ElementKind::Hexa8.facets().iter().enumerate() {
        writeln!(text, "{n}, {}, {}, {}, {}, 9", face[3] + 1, face[2] + 1, face[1] + 1, face[0] + 1).unwrap();
    }
    let mesh = solid(&text);
    assert!((volume(&mesh) - 1.0).abs() < 1e-14, "sum of twelve volumes");
    assert_eq!((mesh.elements(), mesh.surface().unwrap().len()), (12, 12));
}

#[test]
fn wedges_beside_bricks_and_folded_wedges_are_refused() {
    let mut text = String::from("*NODE\n");
    for (n, [x, y, z]) in CUBE.iter().chain(&[[2.0, 0.0, 0.0], [2.0, 0.0, 1.0]]).enumerate() {
        writeln!(text, "{}, {x}, {y}, {z}", n + 1).unwrap();
    }
    let brick = "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n";
    let beside = format!("{text}{brick}*ELEMENT, TYPE=C3D6\n2, 2, 9, 3, 6, 10, 7\n");
    assert!(
        said::<3>(&beside).contains("a brick and a wedge or pyramid share the face of nodes 2, 3, 7, 6; "),
        "{}",
        said::<3>(&beside)
    );
    let folded = format!("{text}*ELEMENT, TYPE=C3D6\n2, 2, 9, 3, 6, 1, 7\n");
    assert!(said::<3>(&folded).contains("the wedge or pyramid of nodes 2, 9, 3, 6, 1, 7 is flat or folded"));
    let collapsed = format!("{text}*ELEMENT, TYPE=C3D6\n2, 2, 9, 9, 6, 10, 7\n");
    assert!(said::<3>(&collapsed).contains("is flat or folded"));
}

/// Two unit cubes in a row along x.
const ROW: &str = "*NODE, NSET=ALL\n1, 0, 0, 0\n2, 1, 0, 0\n3, 2, 0, 0\n4, 0, 1, 0\n5, 1, 1, 0\n6, 2, 1, 0\n\
    11, 0, 0, 1\n12, 1, 0, 1\n13, 2, 0, 1\n14, 0, 1, 1\n15, 1, 1, 1\n16, 2, 1, 1\n\
    *ELEMENT, TYPE=C3D8R, ELSET=STEEL\n1, 1, 2, 5, 4, 11, 12, 15, 14\n\
    *ELEMENT, TYPE=C3D8R, ELSET=RUBBER\n2, 2, 3, 6, 5, 12, 13, 16, 15\n";

/// Syntax variants of one file give the same mesh.
#[test]
fn dialects_are_read_alike() {
    let plain = solid(ROW);
    assert_eq!((plain.nodes.len(), plain.elements()), (12, 2));
    let latin: Vec<u8> = format!("** Stahl und Gummi, gepr@ft\n{ROW}")
        .replace('@', "\u{fc}")
        .chars()
        .map(|c| c as u8)
        .collect();
    assert!(std::str::from_utf8(&latin).is_err());
    assert_eq!(ElementMesh::from_abaqus("latin.inp", &latin, 1.0).unwrap(), plain);
    let dialects = [
        ("carriage return and line feed", ROW.replace('\n', "\r\n")),
        ("carriage return", ROW.replace('\n', "\r")),
        ("byte order mark", format!("\u{feff}{ROW}")),
        ("no end of the last line", ROW.trim_end().into()),
        ("small letters", ROW.replace("*NODE", "*node").replace("*ELEMENT, TYPE", "*Element, type")),
        ("blanks in keywords", ROW.replace("*NODE,", "  * NODE ,").replace("TYPE=", "TYPE = ")),
        ("tabs", ROW.replace(", ", ",\t")),
        ("abbreviations", ROW.replace("*ELEMENT", "*ELEM").replace("ELSET", "ELS")),
        ("continued keywords", ROW.replace("*ELEMENT, ", "*ELEMENT,\n** between\n  ")),
        ("a comma too many after a keyword", ROW.replace("=ALL\n", "=ALL,\n").replace("L\n1,", "L,\n1,")),
        ("continued elements", ROW.replace("5, 4, 11, ", "5, 4,\n11, ")),
        ("commas at ends of lines", ROW.replace("\n2,", ",\n2,")),
        (
            "comments and empty lines",
            ROW.replace("\n*EL", "\n\n**\n ** \n*EL").replace("\n3,", "\n** third\n\n3,"),
        ),
        ("numbers of Fortran", ROW.replace("3, 2, 0, 0", "3, 2.0D+00, 0.d0, 0")),
        ("coordinates left out", ROW.replace("3, 2, 0, 0", "3, 2,,").replace("4, 0, 1, 0", "4, , 1")),
        ("normals of nodes", ROW.replace("4, 0, 1, 0\n", "4, 0, 1, 0, 0., 0., 1.\n")),
        ("quotes", ROW.replace("=STEEL", "=\"STEEL\"").replace("=ALL", " = \" ALL \"")),
        ("a heading", format!("*HEADING\n a row, of 2\n 1, 2, 3\n{ROW}")),
        (
            "other keywords",
            format!(
                "{ROW}*SOLID SECTION, ELSET=STEEL, MATERIAL=S\n,\n*MATERIAL, NAME=S\n*ELASTIC\n2E11, 0.3\n*NODE PRINT, NSET=ALL\nU\n*ELEMENT OUTPUT\nS\n*STEP\n*STATIC\n0.1, 1.\n*END STEP\n"
            ),
        ),
        ("elements of one set in two blocks", ROW.replace("\n12,", "\n*NODE, NSET=all\n12,")),
        ("a node twice at one place", ROW.replace("\n12,", "\n3, 2, 0, 0\n12,")),
        ("cylindrical coordinates", ROW.replace("4, 0, 1, 0\n", "*NODE, SYSTEM=R, NSET=ALL\n4, 0, 1, 0\n")),
        ("one part", format!("*PART, NAME=P\n{ROW}*END PART\n")),
    ];
    for (what, text) in dialects {
        assert_eq!(read(&text).unwrap_or_else(|e| panic!("{what}: {e}\n{text}")), plain, "{what}");
    }
    // Quarter of a ring: angles in degrees.
    let ring = "*NODE, SYSTEM=C\n1, 1, 0\n2, 2, 0\n3, 2, 90\n4, 1, 90\n*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4\n";
    let ring = read::<2>(ring).unwrap();
    // Two triangles between the axes; the cosine of 90 degrees is round-off.
    assert!((volume(&ring) - (2.0 - 0.5)).abs() < 1e-15);
    assert!(ring.nodes[2][0].abs() < 2e-16 && ring.nodes[2][1] == 2.0);
}

/// Element sets that share elements, defined by numbers, ranges and other sets.
#[test]
fn an_element_is_in_every_set_that_names_it() {
    let sets = "*ELSET, ELSET=BOTH, GENERATE\n1, 2\n*ELSET, ELSET=Second\n2,\n*ELSET, ELSET=TWICE\nsecond, 1, Second\n\
        *NSET, NSET=ends, GEN\n1, 11, 10\n3, 13, 10\n*NSET, NSET=ends\n4, 14\n*NSET, NSET=OF_ELEMENTS, ELSET=RUBBER\n";
    let mesh = solid(&format!("{ROW}{sets}"));
    let blocks: Vec<_> = mesh.blocks.iter().map(|b| (b.name.as_str(), b.len())).collect();
    assert_eq!(blocks, [("STEEL", 1), ("RUBBER", 1)]);
    let of = |name: &str| mesh.element_sets[name].as_slice();
    assert_eq!((of("STEEL"), of("RUBBER"), of("BOTH")), (&[0][..], &[1][..], &[0, 1][..]));
    assert_eq!((of("Second"), of("TWICE")), (&[1][..], &[0, 1][..]));
    assert_eq!(mesh.node_sets["ends"], [0, 2, 3, 6, 8, 9]);
    assert_eq!(mesh.node_sets["OF_ELEMENTS"], mesh.node_sets["Second"]);

    let rubber = mesh.only_groups(&["rubber"]).unwrap();
    rubber.check().unwrap();
    assert_eq!((rubber.nodes.len(), rubber.blocks.len()), (8, 1));
    // Round-off of eight quadrature points.
    assert!((volume(&rubber) - 1.0).abs() < 1e-15);
    assert_eq!(rubber.bounds(), Bounds { min: [1.0, 0.0, 0.0], max: [2.0, 1.0, 1.0] });
    // The second cube contains nodes 3 and 13 of the set 1, 3, 4, 11, 13 and 14.
    let ends: Vec<[f64; 3]> = rubber.node_sets["ends"].iter().map(|&n| rubber.nodes[n as usize]).collect();
    assert_eq!(ends, [[2.0, 0.0, 0.0], [2.0, 0.0, 1.0]]);
    assert_eq!(rubber.element_sets.keys().collect::<Vec<_>>(), ["BOTH", "RUBBER", "Second", "TWICE"]);
    assert!(rubber.element_sets.values().all(|set| set == &[0]));
    assert_eq!(mesh.only_groups(&["Second"]).unwrap(), rubber);
    assert_eq!(mesh.only_groups(&["STEEL", "Second", "BOTH"]).unwrap(), mesh);
    let said = mesh.only_groups(&["STEEL", "wood"]).unwrap_err().to_string();
    let expected =
        "mesh: no group of elements has the name `wood`; there are BOTH, RUBBER, STEEL, Second, TWICE";
    assert_eq!(said, expected);
    let none: [&str; 0] = [];
    let said = mesh.only_groups(&none).unwrap_err().to_string();
    assert_eq!(said, "mesh: there is no element; a choice of groups needs one at least");
}

/// Surfaces by faces of elements and by node sets become node sets.
#[test]
fn surfaces_are_sets_of_nodes() {
    for (line, at) in [
        ("STEEL, S6", (0, 0.0)),
        ("2, s4", (0, 2.0)),
        ("STEEL, S1\nRUBBER, S1", (2, 0.0)),
        ("STEEL, S2\n2, S2", (2, 1.0)),
        ("STEEL, S3\nRUBBER, S3", (1, 0.0)),
        ("1, S5\n2, S5", (1, 1.0)),
    ] {
        let mesh = solid(&format!("{ROW}*SURFACE, NAME=LOADED, TYPE=ELEMENT\n{line}\n"));
        let (axis, place) = at;
        assert_eq!(mesh.node_sets["LOADED"], mesh.nodes_where(|x| x[axis] == place), "{line}");
    }
    let mesh =
        solid(&format!("{ROW}*NSET, NSET=ENDS\n1, 4\n*SURFACE, NAME=LINE, TYPE=NODE\nENDS, 1.\n11,\n"));
    assert_eq!(mesh.node_sets["LINE"], [0, 3, 6]);
    // A surface without faces, and one that has the name of a node set.
    let others = solid(&format!("{ROW}*SURFACE, NAME=FREE\nSTEEL,\n*SURFACE, NAME=ALL\nSTEEL, S1\n"));
    assert!(!others.node_sets.contains_key("FREE") && others.node_sets["ALL"].len() == 12);
    let tetra = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4, ELSET=TIP\n1, 1, 2, 3, 4\n";
    for (face, nodes) in [("S1", [0, 1, 2]), ("S2", [0, 1, 3]), ("S3", [1, 2, 3]), ("S4", [0, 2, 3])] {
        let mesh = solid(&format!("{tetra}*SURFACE, NAME=F\nTIP, {face}\n"));
        assert_eq!(mesh.node_sets["F"], nodes, "{face}");
    }
}

/// Surface elements of shells, membranes and rigid bodies in a file of bricks become node sets.
#[test]
fn surface_elements_of_a_volume_mesh_are_sets_of_nodes() {
    for kind in ["S4", "S4R", "M3D4", "R3D4", "CPS4", "SFM3D4R"] {
        let mesh = solid(&format!("{ROW}*ELEMENT, TYPE={kind}, ELSET=IMPACT\n5, 1, 4, 14, 11\n"));
        assert_eq!((mesh.elements(), mesh.blocks.len()), (2, 2), "{kind}");
        assert_eq!(mesh.node_sets["IMPACT"], mesh.nodes_where(|x| x[0] == 0.0), "{kind}");
        assert!(!mesh.element_sets.contains_key("IMPACT"));
        let said = mesh.only_groups(&["IMPACT"]).unwrap_err().to_string();
        assert!(said.contains("there are RUBBER, STEEL"), "{said}");
    }
    // Bars remain as reinforcement.
    let bar = solid(&format!("{ROW}*ELEMENT, TYPE=T3D2, ELSET=BARS\n5, 1, 16\n"));
    assert_eq!((bar.elements(), bar.element_sets["BARS"].as_slice()), (3, &[2][..]));
}

/// Assembly of three instances of two parts, one instance with a mesh of its own.
fn assembly() -> String {
    let tip = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4, ELSET=TIP\n1, 1, 2, 3, 4\n";
    format!(
        "*HEADING\n*PART, NAME=Row\n{ROW}*NSET, NSET=Left, GENERATE\n1, 11, 10\n*SOLID SECTION, ELSET=STEEL, MATERIAL=M\n,\n*END PART\n\
         *Part, name=Empty\n*End Part\n\
         *ASSEMBLY, NAME=Assembly\n\
         *INSTANCE, NAME=Row-1, PART=ROW\n*END INSTANCE\n\
         *INSTANCE, NAME=Row-2, PART=Row\n10., 0.\n10., 0., 0., 10., 0., 1., 90.\n*END INSTANCE\n\
         *INSTANCE, NAME=Tip, PART=Empty\n0., 0., -5.\n{tip}*END INSTANCE\n\
         *NODE\n1, 100., 100., 100.\n*NSET, NSET=Reference\n1,\n\
         *NSET, NSET=Fixed, INSTANCE=Row-2\nLeft, 14\n*NSET, NSET=Fixed, INSTANCE=Tip\n1\n\
         *NSET, NSET=More\nFixed, row-1.left, Row-1.16\n\
         *ELSET, ELSET=Soft, INSTANCE=Row-1, INTERNAL\nrubber\n*ELSET, ELSET=Soft, INSTANCE=Row-2, GENERATE\n2, 2\n\
         *ELSET, ELSET=Mix\nTip.1, Soft, Row-2.STEEL\n\
         *END ASSEMBLY\n*MATERIAL, NAME=M\n*DENSITY\n7850.,\n"
    )
}

/// Translation precedes rotation; sets belong to parts, instances and the assembly.
#[test]
fn parts_are_read_where_their_instances_are() {
    let mesh = solid(&assembly());
    assert_eq!(
        (mesh.nodes.len(), mesh.elements()),
        (2 * 12 + 4, 2 * 2 + 1),
        "the reference point is dropped"
    );
    // Sum of unit volumes, with round-off of a rotation.
    assert!((volume(&mesh) - (4.0 + 1.0 / 6.0)).abs() < 1e-14);
    let bounds = |group: &str| mesh.only_groups(&[group]).unwrap_or_else(|e| panic!("{e}")).bounds();
    let close = |group: &str, min: [f64; 3], max: [f64; 3]| {
        let found = bounds(group);
        for (found, exact) in found.min.iter().chain(&found.max).zip(min.iter().chain(&max)) {
            // Round-off at coordinates of order ten.
            assert!((found - exact).abs() < 1e-14, "{group}: {:?}", bounds(group));
        }
    };
    close("Row-1", [0.0; 3], [2.0, 1.0, 1.0]);
    close("row-2", [9.0, 0.0, 0.0], [10.0, 2.0, 1.0]);
    close("Tip", [0.0, 0.0, -5.0], [1.0, 1.0, -4.0]);
    close("Row-1.RUBBER", [1.0, 0.0, 0.0], [2.0, 1.0, 1.0]);
    close("Row-2.RUBBER", [9.0, 1.0, 0.0], [10.0, 2.0, 1.0]);
    close("Soft", [1.0, 0.0, 0.0], [10.0, 2.0, 1.0]);
    let groups: Vec<_> = mesh.groups().into_iter().collect();
    let expected = [
        ("Mix", 4),
        ("Row-1", 2),
        ("Row-1.RUBBER", 1),
        ("Row-1.STEEL", 1),
        ("Row-2", 2),
        ("Row-2.RUBBER", 1),
        ("Row-2.STEEL", 1),
        ("Soft", 2),
        ("TIP", 1),
    ];
    assert_eq!(groups, expected);
    let places = |set: &str| -> Vec<[f64; 3]> {
        mesh.node_sets[set].iter().map(|&n| mesh.nodes[n as usize].map(f64::round)).collect()
    };
    assert_eq!(places("Fixed"), [[10., 0., 0.], [10., 0., 1.], [9., 0., 1.], [0., 0., -5.]]);
    assert_eq!(places("Row-1.Left"), [[0.0; 3], [0., 0., 1.]]);
    assert_eq!(mesh.node_sets["More"].len(), 4 + 2 + 1);
    assert!(mesh.node_sets["Reference"].is_empty());
    // A set with a unique name needs no instance prefix.
    let one = format!(
        "*PART, NAME=P\n{ROW}*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*END ASSEMBLY\n"
    );
    assert_eq!(solid(&one).element_sets.keys().collect::<Vec<_>>(), ["I", "RUBBER", "STEEL"]);
}

#[test]
fn what_an_assembly_lacks_is_refused() {
    let whole = assembly();
    let cases = [
        (
            "row-1.left",
            "row-3.left",
            "member of *NSET = `row-3.left` is not allowed; allowed is a number or a set",
        ),
        ("Row-1.16", "Row-1.17", "member of *NSET = `Row-1.17`"),
        ("Tip.1, Soft", "Tip.1, 1", "member of *ELSET = `1`"),
        ("NAME=Row-2", "NAME=ROW-1", "NAME of *INSTANCE = `ROW-1` is not allowed; allowed is each name once"),
        ("PART=ROW", "LIBRARY=x, PART=ROW", "parameter of *INSTANCE = `LIBRARY` is not allowed"),
        ("10., 0., 1., 90.", "10., 0., 1., 90., 1.", "rotation of *INSTANCE = "),
        ("10., 0., 1., 90.", "10., 0., 1.", "rotation of *INSTANCE = "),
        ("10., 0., 1., 90.\n", "10., 0., 1., 90.\n1, 2, 3\n", "data of *INSTANCE = `1, 2, 3`"),
        (
            "10., 0.\n",
            "10., up\n",
            "translation of *INSTANCE = `up` is not allowed; allowed is a finite number",
        ),
    ];
    for (from, to, expected) in cases {
        assert!(whole.contains(from), "{from}");
        let text = whole.replacen(from, to, 1);
        assert!(said::<3>(&text).contains(expected), "{from:?} -> {to:?}: {}", said::<3>(&text));
    }
}

/// Temporary folder of files, removed on drop.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, files: &[(&str, &str)]) -> Self {
        let folder = std::env::temp_dir().join(format!("impactite-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        for (file, text) in files {
            let path = folder.join(file);
            std::fs::create_dir_all(path.parent().unwrap_or(Path::new("."))).unwrap();
            std::fs::write(path, text).unwrap();
        }
        Self(folder)
    }

    fn read(&self, file: &str) -> Result<ElementMesh<3>, GeometryError> {
        ElementMesh::read_abaqus(self.0.join(file), 1.0)
    }

    fn said(&self, file: &str) -> String {
        let said = self.read(file).expect_err("it is refused").to_string();
        said.replace(&format!("{}/", std::fs::canonicalize(&self.0).unwrap().display()), "")
            .replace(&format!("{}/", self.0.display()), "")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn included_files_are_read_in_their_place() {
    let (nodes, elements) = ROW.split_at(ROW.find("*ELEMENT").unwrap());
    let (_, places) = nodes.split_once('\n').unwrap();
    let (first, second) = elements.split_at(elements.rfind("*ELEMENT").unwrap());
    let (head, lines) = second.split_once('\n').unwrap();
    let folder = Folder::new(
        "include",
        &[
            ("whole.inp", ROW),
            ("main.inp", "*HEADING\n*INCLUDE, INPUT=parts/mesh.inp\n*NSET, NSET=LEFT\n1, 4\n"),
            (
                "parts/mesh.inp",
                &format!(
                    "*NODE, NSET=ALL\n*INCLUDE,\n INPUT=nodes.txt\n{first}*include, input=main/more.inp\n"
                ),
            ),
            ("parts/nodes.txt", places),
            // In the folder of the main file, not of the including file.
            ("main/more.inp", &format!("{head}, INPUT=../parts/last.txt\n")),
            ("parts/last.txt", lines),
            ("windows.inp", "*INCLUDE, INPUT=\"parts\\mesh.inp\"\n*NSET, NSET=LEFT\n1, 4\n"),
            ("data.inp", &format!("*NODE, INPUT=parts/nodes.txt, NSET=ALL\n{elements}")),
        ],
    );
    let plain = solid(ROW);
    assert_eq!(folder.read("whole.inp").unwrap(), plain);
    assert_eq!(folder.read("data.inp").unwrap(), plain);
    for file in ["main.inp", "windows.inp"] {
        let mut mesh = folder.read(file).unwrap();
        assert_eq!(mesh.node_sets.remove("LEFT").unwrap(), [0, 3]);
        assert_eq!(mesh, plain, "{file}");
    }
}

#[test]
fn included_files_that_are_not_there_or_have_no_end_are_refused() {
    let deep: Vec<(String, String)> =
        (0..20).map(|n| (format!("deep{n}.inp"), format!("*INCLUDE, INPUT=deep{}.inp\n", n + 1))).collect();
    let mut files: Vec<(&str, &str)> =
        deep.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    files.extend([
        ("none.inp", "*HEADING\n*INCLUDE, INPUT=gone.inp\n"),
        ("empty.inp", "*INCLUDE\n"),
        ("self.inp", "** self\n*INCLUDE, INPUT=./self.inp\n"),
        ("a.inp", "*INCLUDE, INPUT=b/b.inp\n"),
        ("b/b.inp", "** back\n*INCLUDE, INPUT=../a.inp\n"),
        ("wrong.inp", "*HEADING\n*INCLUDE, INPUT=b/nodes.inp\n"),
        ("b/nodes.inp", "*NODE\n1, 0, 0, 0\n2, 0, x, 0\n"),
        ("cut.inp", "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=T3D2\n*INCLUDE, INPUT=b/element.txt\n"),
        ("b/element.txt", "1, 1\n"),
        ("folder.inp", "*INCLUDE, INPUT=b\n"),
        ("gmsh.inp", "*INCLUDE, INPUT=b/mesh.msh\n"),
        ("b/mesh.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"),
        ("password.inp", "*INCLUDE, INPUT=b/nodes.inp, PASSWORD=x\n"),
        ("data.inp", "*INCLUDE, INPUT=b/element.txt\n"),
    ]);
    let folder = Folder::new("refused", &files);
    for (file, expected) in [
        ("none.inp", "cannot read none.inp: line 2: `gone.inp` cannot be included: gone.inp: No such file"),
        ("empty.inp", "line 1: *INCLUDE = `` is not allowed; allowed is a parameter INPUT=..."),
        ("self.inp", "line 2: `./self.inp` cannot be included: it includes itself: self.inp -> self.inp"),
        (
            "a.inp",
            "b/b.inp, line 2: `../a.inp` cannot be included: it includes itself: a.inp -> b/b.inp -> a.inp",
        ),
        ("wrong.inp", "cannot read wrong.inp: b/nodes.inp, line 3: coordinate = `x` is not allowed"),
        ("cut.inp", "b/element.txt, line 1: the file ends where node 2 of element 1 (T3D2) was expected"),
        ("folder.inp", "`b` cannot be included: b: it is a folder; it must be a regular file"),
        ("gmsh.inp", "b/mesh.msh: it is a Gmsh file of elements; read it by `ElementMesh::read_gmsh`"),
        ("password.inp", "parameter of *INCLUDE = `PASSWORD` is not allowed; allowed is one of INPUT"),
        ("data.inp", "b/element.txt, line 1: first line = `1, 1` is not allowed"),
        (
            "deep0.inp",
            "deep16.inp, line 1: `deep17.inp` cannot be included: at most 16 files may include each other",
        ),
    ] {
        let said = folder.said(file);
        assert!(said.contains(expected), "{said}\nexpected {expected}");
    }
    let of_bytes = said::<3>("*INCLUDE, INPUT=a.inp\n");
    assert!(
        of_bytes
            .ends_with("`a.inp` cannot be included: these bytes are of no folder; read the file by its path")
    );
}

/// Element sets follow their elements through mesh operations.
#[test]
fn element_sets_follow_the_elements() {
    let mesh = solid(&format!("{ROW}*ELSET, ELSET=BOTH\n1, 2\n"));
    let tetrahedra = mesh.clone().split_to_tetrahedra().unwrap();
    let rubber = tetrahedra.only_groups(&["RUBBER"]).unwrap();
    assert!((volume(&rubber) - 1.0).abs() < 1e-15 && rubber.bounds().min[0] == 1.0);
    assert_eq!(tetrahedra.element_sets["BOTH"].len(), tetrahedra.elements());
    let other = mesh.clone().translated([5.0, 0.0, 0.0]).unwrap();
    let both = mesh.joined(&other).unwrap();
    assert_eq!(both.element_sets["RUBBER"], [1, 3]);
    assert_eq!(
        both.only_groups(&["RUBBER"]).unwrap().bounds(),
        Bounds { min: [1., 0., 0.], max: [7., 1., 1.] }
    );
    let right = both.part(&|block, _| block == 3).unwrap();
    assert_eq!((right.element_sets["RUBBER"].as_slice(), right.element_sets["STEEL"].len()), (&[0][..], 0));

    let plane = "*NODE\n1, 0, 0\n2, 1, 0\n3, 3, 0\n4, 0, 1\n5, 1, 1\n6, 3, 1\n7, 6, 0\n8, 6, 1\n\
        *ELEMENT, TYPE=CPS4, ELSET=A\n1, 1, 2, 5, 4\n2, 2, 3, 6, 5\n*ELEMENT, TYPE=CPS4, ELSET=B\n3, 3, 7, 8, 6\n*ELSET, ELSET=C\n2, 3\n";
    let plane = read::<2>(plane).unwrap();
    let drawn = plane.extruded(&[0.0, 1.0, 3.0]).unwrap();
    for (group, exact) in [("A", 9.0), ("B", 9.0), ("C", 15.0)] {
        let part = drawn.only_groups(&[group]).unwrap();
        assert!((volume(&part) - exact).abs() < 1e-14, "{group}: sum of six volumes");
    }
    let triangles = plane.clone().split_to_triangles().unwrap();
    assert!((volume(&triangles.only_groups(&["C"]).unwrap()) - 5.0).abs() < 1e-15);

    let wrong = plane.clone().with_element_set("D", vec![3]).unwrap_err().to_string();
    assert_eq!(wrong, "mesh: element set `D` names element 3; allowed are numbers below 3");
    let wrong = plane.with_element_set("D", vec![1, 1]).unwrap_err().to_string();
    assert_eq!(
        wrong,
        "mesh: element set `D` has element 1 after element 1; numbers must ascend, each one once"
    );
}
