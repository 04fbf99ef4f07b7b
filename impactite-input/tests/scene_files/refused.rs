//! Scenes that `check` refuses, with the key that helps.

use impactite_input::Source;

/// Two blocks of which the right one hits the left one.
fn blocks(method: &str, contact: &str, rest: &str) -> String {
    let mesh = if method.contains("fem") { "mesh.edge = \"2 mm\"" } else { "" };
    format!(
        r#"
title = "two blocks"
space = "plane strain"
end = "1 us"
{method}
{contact}
{rest}
materials.steel.elastic = {{ density = 7800, young = "200 GPa", poisson = 0.3 }}
[bodies.left]
material = "steel"
shape.box = {{ from = [0, 0], to = ["10 mm", "10 mm"] }}
{mesh}
[bodies.right]
material = "steel"
shape.box = {{ from = ["20 mm", 0], to = ["30 mm", "10 mm"] }}
velocity = ["-1 m/s", 0]
{mesh}
"#
    )
}

const METHODS: [&str; 5] = [
    "method.mpm = { cell = \"2 mm\" }",
    "method.fem = {}",
    "method.sph = { spacing = \"2 mm\" }",
    "method.fpm = { spacing = \"2 mm\" }",
    "method.pcmm = { spacing = \"2 mm\" }",
];
const FRICTION: &str = "contact.law.friction = 0.2";

/// Error of a scene; none of one that is set up.
fn said(text: &str) -> Option<String> {
    let source = Source::new("scene.toml", text);
    let built = source.parse().and_then(|scene| {
        let mut solver = source.build(&scene)?;
        source.estimate(&scene, &mut *solver)
    });
    built.err().map(|e| e.to_string())
}

fn refused(text: &str, words: &[&str]) {
    let said = said(text).unwrap_or_else(|| panic!("not refused:\n{text}"));
    for word in words {
        assert!(said.contains(word), "no `{word}` in:\n{said}\nof:\n{text}");
    }
}

#[test]
fn several_bodies_need_a_contact_in_every_method() {
    for method in METHODS {
        refused(
            &blocks(method, "", ""),
            &["contact: several bodies need a `contact`", "contact.law.friction = 0"],
        );
        assert_eq!(said(&blocks(method, FRICTION, "")), None, "{method}");
        let none = blocks(method, "contact = \"none\"", "");
        if method.contains("mpm") {
            assert_eq!(said(&none), None);
        } else {
            refused(&none, &["contact", "`mpm` alone"]);
        }
    }
    refused(&blocks(METHODS[0], "contact = \"nothing\"", ""), &["contact", "or \"none\""]);
    refused(
        &blocks(METHODS[0], "contact.law.frction = 0.2", ""),
        &["contact.law", "did you mean `friction`?"],
    );
    // One body needs none.
    let one = blocks(METHODS[0], "", "").split("[bodies.right]").next().map(String::from);
    assert_eq!(one.and_then(|text| said(&text)), None);
}

/// `side` is above if it is not given, which a body below a wall at its right is not.
#[test]
fn bodies_behind_planes_are_refused_in_every_method() {
    for method in METHODS {
        for (word, rest) in [
            ("wall", ""),
            ("symmetry", ""),
            ("absorbing", ", longitudinal = 6000, shear = 3000"),
            ("wall", ", friction = 0.3"),
        ] {
            let plane = |side: &str| {
                format!("conditions = [{{ {word} = {{ axis = \"x\", at = \"36 mm\"{rest}{side} }} }}]")
            };
            refused(&blocks(method, FRICTION, &plane("")), &["conditions[0]", "side"]);
            // Fragile points have planes other than walls at faces alone.
            if word == "wall" || !method.contains("fpm") {
                assert_eq!(
                    said(&blocks(method, FRICTION, &plane(", side = \"below\""))),
                    None,
                    "{method} {word}"
                );
            }
            // A plane through a body.
            let through = plane("").replace("36 mm", "6 mm");
            refused(&blocks(method, FRICTION, &through), &["conditions[0]"]);
        }
        let fixed = |at: &str| format!("conditions = [{{ fixed = {{ axis = \"x\", at = \"{at}\" }} }}]");
        refused(&blocks(method, FRICTION, &fixed("36 mm")), &["conditions[0].fixed", "side = \"below\""]);
        // Behind it stands what it is to hold.
        // Also where the plane is a face of the body.
        let one = blocks(method, FRICTION, &fixed("10 mm"));
        refused(
            one.split("[bodies.right]").next().unwrap_or_default(),
            &["conditions[0].fixed", "nothing moves"],
        );
        if !method.contains("fpm") {
            assert_eq!(said(&blocks(method, FRICTION, &fixed("16 mm"))), None, "{method}");
        }
    }
}

#[test]
fn bodies_within_bodies_are_refused_in_every_method() {
    for method in METHODS {
        let text = blocks(method, FRICTION, "");
        let at = |left: &str, right: &str| {
            text.replace("[\"20 mm\", 0], to = [\"30 mm\"", &format!("[\"{left}\", 0], to = [\"{right}\""))
        };
        // By four tenths of its width, and by one spacing.
        for [left, right] in [["6 mm", "16 mm"], ["8 mm", "18 mm"]] {
            refused(&at(left, right), &["bodies.", "points lie in the shape of"]);
        }
        // Faces that touch are no overlap, nor is a gap.
        for [left, right] in [["10 mm", "20 mm"], ["10.1 mm", "20.1 mm"]] {
            assert_eq!(said(&at(left, right)), None, "{method}");
        }
    }
}

/// Bodies one spacing thick that touch: all of their points lie by the common face.
#[test]
fn thin_bodies_that_touch_do_not_overlap() {
    for method in METHODS.iter().filter(|m| !m.contains("pcmm")) {
        let thin = blocks(method, FRICTION, "")
            .replace("to = [\"10 mm\", \"10 mm\"]", "to = [\"2 mm\", \"10 mm\"]")
            .replace("[\"20 mm\", 0], to = [\"30 mm\"", "[\"2 mm\", 0], to = [\"4 mm\"");
        assert_eq!(said(&thin), None, "{method}");
    }
}

#[test]
fn steps_speeds_and_materials_that_cannot_be_are_refused() {
    let text = |rest: &str| blocks(METHODS[0], FRICTION, rest);
    for factor in ["2", "1.01", "0", "-1", "1e-30"] {
        refused(&text(&format!("time_step.factor = {factor}")), &["time_step.factor", "from 1e-6 to 1"]);
    }
    for method in METHODS {
        refused(
            &blocks(method, FRICTION, "time_step.fixed = \"10 us\""),
            &["time_step.fixed", "times the time in which a wave crosses"],
        );
        assert_eq!(said(&blocks(method, FRICTION, "time_step.fixed = \"10 ns\"")), None, "{method}");
    }
    refused(&text("time_step.gershgorin = { factor = 3 }"), &["time_step.gershgorin.factor"]);
    refused(&text("").replace("\"1 us\"", "\"1e9 s\""), &["end:", "steps"]);
    refused(&text("").replace("density = 7800", "density = 1e-20"), &["steps"]);
    refused(&text("").replace("\"-1 m/s\"", "\"-400000 km/s\""), &["bodies.right", "light"]);
    let unused = "materials.spare.elastic = { density = -1.2, young = \"1 GPa\", poisson = 0.3 }";
    refused(&text(unused), &["materials.spare", "-1.2"]);
    let note = "materials.spare.elastic = { density = 1.2, young = \"1 GPa\", poisson = 0.3 }";
    let source = Source::new("scene.toml", text(note));
    let scene = source.parse().unwrap();
    let mut solver = source.build(&scene).unwrap();
    let ahead = source.estimate(&scene, &mut *solver).unwrap();
    assert!(ahead.notes.iter().any(|n| n.contains("materials.spare")), "{:?}", ahead.notes);
}

#[test]
fn contact_that_remembers_is_refused_where_it_is_not_available() {
    let law = "contact.law.slip_weakening = { at_rest = 0.6, sliding = 0.3, distance = \"1 mm\" }";
    for method in METHODS {
        let text = blocks(method, law, "");
        if method.contains("mpm") {
            assert_eq!(said(&text), None);
        } else {
            refused(&text, &["contact.law", "slip_weakening"]);
        }
        let pair = "[contact]\nlaw.friction = 0.2\n[[contact.pairs]]\nbetween = [\"left\", \"right\"]\nlaw.slip_weakening = { at_rest = 0.6, sliding = 0.3, distance = \"1 mm\" }\n";
        let paired = blocks(method, "", "") + pair;
        assert_eq!(
            said(&paired).is_some_and(|s| s.contains("contact.pairs[0].law")),
            !method.contains("mpm"),
            "{method}"
        );
    }
    let beside = |by: &str| {
        blocks(METHODS[0], law, "").replace(
            "velocity = [\"-1 m/s\", 0]",
            &format!("velocity = [\"-1 m/s\", 0]\nmesh.edge = \"2 mm\"\nelements.by = \"{by}\""),
        )
    };
    refused(&beside("surface"), &["contact.law", "slip_weakening"]);
}

#[test]
fn gravity_beside_elements_on_the_grid_is_refused() {
    let text = |by: &str| {
        blocks(METHODS[0], FRICTION, "gravity = [0, -10]")
            .replace("velocity = [\"-1 m/s\", 0]", &format!("mesh.edge = \"2 mm\"\nelements.by = \"{by}\""))
    };
    refused(&text("grid"), &["gravity", "`right`", "bodies.right.elements.by = \"surface\""]);
    assert_eq!(said(&text("surface")), None);
}

/// Elements that meet particles by their surface report no forces between bodies.
#[test]
fn contact_forces_that_nobody_measures_are_refused() {
    let measure =
        "\n[measures]\nforce = { contact_force = { between = [\"left\", \"right\"], axis = \"x\" } }\n";
    let text = |contact: &str, body: &str| {
        blocks(METHODS[0], contact, "").replace("velocity = [\"-1 m/s\", 0]", body) + measure
    };
    let by = |way: &str| format!("mesh.edge = \"2 mm\"\nelements.by = \"{way}\"");
    refused(&text(FRICTION, &by("surface")), &["measures.force.contact_force", "`right`", "grid"]);
    refused(&text("contact = \"none\"", ""), &["measures.force.contact_force", "needs a `contact`"]);
    assert_eq!(said(&text(FRICTION, &by("grid"))), None);
    assert_eq!(said(&text(FRICTION, "")), None);
}

#[test]
fn units_that_are_missing_and_fluids_that_are_stirred_are_noted() {
    let notes = |text: &str| {
        let source = Source::new("scene.toml", text);
        let scene = source.parse().unwrap_or_else(|e| panic!("{e}"));
        let mut solver = source.build(&scene).unwrap_or_else(|e| panic!("{e}"));
        let ahead = source.estimate(&scene, &mut *solver).unwrap_or_else(|e| panic!("{e}"));
        [ahead.choices, ahead.notes].concat().join("; ")
    };
    let sound = blocks(METHODS[0], FRICTION, "");
    assert_eq!(notes(&sound), "");
    assert!(notes(&sound.replace("\"200 GPa\"", "2")).contains("is a unit missing?"));
    assert!(notes(&sound.replace("7800", "7.85")).contains("is a unit missing?"));
    let steel = "elastic = { density = 7800, young = \"200 GPa\", poisson = 0.3 }";
    let water = |method: &str| {
        blocks(method, FRICTION, "gravity = [0, -10]")
            .replace(steel, "fluid.tait = { density = 1000, sound_speed = 30 }")
    };
    let impact = "method.mpm = { cell = \"2 mm\", for = \"impact\" }";
    assert!(notes(&water(impact)).contains("cpgimp"));
    let own = notes(&water("method.mpm = { cell = \"2 mm\" }"));
    assert!(own.contains("density renewed from positions") && !own.contains("cpgimp"), "{own}");
    let parts = "method.mpm = { cell = \"2 mm\", parts = { shape_function = \"cpgimp\", transfer = \"flip\", stress_update = \"musl\" } }";
    assert_eq!(notes(&water(parts)), "");
}

/// Before any point is made.
#[test]
fn scenes_that_memory_does_not_hold_are_refused() {
    for (method, key) in [
        ("method.mpm = { cell = \"20 nm\" }", "method.mpm.cell"),
        ("method.sph = { spacing = \"10 nm\" }", "method.sph.spacing"),
        ("method.fpm = { spacing = \"10 nm\" }", "method.fpm.spacing"),
        ("method.pcmm = { spacing = \"10 nm\" }", "method.pcmm.spacing"),
    ] {
        refused(&blocks(method, FRICTION, ""), &[key, "of memory or more", "times larger"]);
    }
    let fem = blocks(METHODS[1], FRICTION, "").replace("\"2 mm\"", "\"10 nm\"");
    refused(&fem, &[".mesh.edge", "of memory or more"]);
    let notch = "notches = [{ corners = [[0, \"5 mm\"], [1e9, \"5 mm\"]] }]";
    let notched = blocks(METHODS[3], FRICTION, "").replace("velocity = [\"-1 m/s\", 0]", notch);
    refused(&notched, &["bodies.right.notches[0].corners", "spacings"]);
    // A shape whose measure is sampled.
    let hollow = blocks(METHODS[0], FRICTION, "").replace("2 mm", "10 nm").replace(
        "shape.box = { from = [0, 0], to = [\"10 mm\", \"10 mm\"] }",
        "shape.difference = [{ box = { from = [0, 0], to = [\"10 mm\", \"10 mm\"] } }, { ball = { centre = [0, 0], radius = \"5 mm\" } }]",
    );
    refused(&hollow, &["method.mpm.cell"]);
}

#[test]
fn a_parameter_keeps_what_it_measures() {
    let text = blocks(METHODS[0], FRICTION, "").replace("\"-1 m/s\"", "\"-speed\"")
        + "[parameters]\nspeed = \"1 m/s\"\ncells = 4\n";
    let source = Source::new("scene.toml", text);
    for (set, words) in [
        ("parameters.speed=800", ["the parameter is a speed (m/s)", "`800` is a number without a unit"]),
        ("parameters.speed=3 mm", ["speed (m/s)", "length (m)"]),
        ("parameters.cells=3 mm", ["number without a unit", "length"]),
    ] {
        let said = source.set(set).unwrap_err().to_string();
        assert!(words.iter().all(|w| said.contains(w)), "{said}");
    }
    for set in ["parameters.speed=2 km/s", "parameters.speed=2 speed", "parameters.cells=10"] {
        assert!(source.set(set).is_ok_and(|s| s.parse().is_ok()) || set.contains("2 speed"), "{set}");
    }
}

#[test]
fn errors_of_json_have_their_places_in_the_json() {
    let one_line = r#"{"title": "a", "space": "plane strain", "end": 1, "method": {"mpm": {"cell": "3 mmm"}}, "materials": {}, "bodies": {}}"#;
    let source = Source::from_json("scene.json", one_line).unwrap();
    let said = source.parse().unwrap_err().to_string();
    let column = one_line.find("\"3 mmm\"").unwrap() + 1;
    assert!(said.starts_with(&format!("scene.json:1:{column}: method.mpm.cell")), "{said}");
    assert!(said.contains(one_line) && said.contains("^"), "{said}");
    for (text, words) in [
        ("{\n \"title\": \"a\",\n \"end\": null\n}", ["scene.json:3:9: end:", "leave the key out"]),
        ("{\"title\": \"a\",\n \"title\": \"b\"}", ["scene.json:2:11: title:", "stands twice"]),
        ("{\"bodies\": {\"b\": {\"velocity\": [1, null]}}}", ["bodies.b.velocity[1]", "leave the key out"]),
        ("[1, 2]", ["scene.json:1:1", "a scene is an object"]),
        ("{\"title\": }", ["scene.json:1:11", "invalid JSON"]),
    ] {
        let said = Source::from_json("scene.json", text).unwrap_err().to_string();
        assert!(words.iter().all(|w| said.contains(w)), "{said}");
    }
}

/// A scene means the same in another folder.
#[test]
fn files_of_a_scene_are_found_from_anywhere() {
    let text = blocks(METHODS[0], FRICTION, "")
        + "[bodies.third]\nmaterial = \"steel\"\nshape.moved = { shape = { surface = { file = \"a.stl\", unit = \"1 mm\" } }, by = [1, 1] }\n\
           [bodies.fourth]\nmaterial = \"steel\"\nshape.union = [{ surface = { file = \"/b.stl\", unit = 1 } }, { surface = { file = \"c/d.stl\", unit = 1 } }]\n";
    let source = Source::new("/somewhere/scene.toml", text);
    let anchored = source.anchored().text;
    for path in ["\"/somewhere/a.stl\"", "\"/b.stl\"", "\"/somewhere/c/d.stl\""] {
        assert!(anchored.contains(path), "{path} in\n{anchored}");
    }
    // Only what changes no step may differ in a run that goes on.
    for (set, same) in [
        ("end=5", true),
        ("title=other", true),
        ("description=other", true),
        ("bodies.left.velocity=[3, 0]", false),
        ("method.mpm.cell=\"1 mm\"", false),
    ] {
        assert_eq!(source.resumes_as(&source.set(set).unwrap()), same, "{set}");
    }
    assert!(source.resumes_as(&source.anchored()) && source.anchored().resumes_as(&source));
}

/// A body has the groups of its mesh file that it names; one that names none of several is told of them.
#[test]
fn groups_of_mesh_files_are_chosen_by_name() {
    let folder = std::env::temp_dir().join(format!("impactite-groups-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mesh = "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n5, 3, 0\n6, 3, 1\n\
        *ELEMENT, TYPE=CPE4, ELSET=STEEL\n1, 1, 2, 3, 4\n*ELEMENT, TYPE=CPE4, ELSET=RUBBER\n2, 2, 5, 6, 3\n";
    std::fs::write(folder.join("two.inp"), mesh).unwrap();
    let one = "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n*ELEMENT, TYPE=CPE4, ELSET=ALL\n1, 1, 2, 3, 4\n";
    std::fs::write(folder.join("one.inp"), one).unwrap();
    let ahead = |file: &str, groups: &str| {
        let text = format!(
            "title = \"groups\"\nspace = \"plane strain\"\nend = \"1 us\"\nmethod.fem = {{}}\n\
             materials.m.elastic = {{ density = 1000, young = \"1 GPa\", poisson = 0.3 }}\n\
             [bodies.b]\nmaterial = \"m\"\nmesh.abaqus = {{ file = \"{file}\", unit = \"1 mm\"{groups} }}\n"
        );
        let source = Source::new(folder.join("scene.toml").display().to_string(), text);
        let scene = source.parse().unwrap_or_else(|e| panic!("{e}"));
        let mut solver = source.build(&scene)?;
        source.estimate(&scene, &mut *solver)
    };
    for (groups, area, noted) in [
        ("", 3e-6, true),
        (", groups = [\"steel\"]", 1e-6, false),
        (", groups = [\"RUBBER\"]", 2e-6, false),
        (", groups = [\"STEEL\", \"RUBBER\"]", 3e-6, false),
    ] {
        let ahead = ahead("two.inp", groups).unwrap_or_else(|e| panic!("{e}"));
        // Round-off of a sum of eight points of integration.
        assert!((ahead.bodies[0].mass / (1000.0 * area) - 1.0).abs() < 1e-14, "{groups}");
        let note = "bodies.b.mesh.abaqus: the file has the groups `RUBBER`, `STEEL`; the body takes all of them as one material";
        assert_eq!(ahead.notes.iter().any(|n| n.starts_with(note)), noted, "{groups}: {:?}", ahead.notes);
    }
    assert_eq!(ahead("one.inp", "").unwrap_or_else(|e| panic!("{e}")).notes, Vec::<String>::new());
    for (groups, expected) in [
        (", groups = [\"wood\"]", "no group of elements has the name `wood`; there are RUBBER, STEEL"),
        (", groups = []", "needs the name of a group"),
    ] {
        let said = ahead("two.inp", groups).err().map(|e| e.to_string()).unwrap_or_default();
        assert!(said.contains("bodies.b.mesh.abaqus.groups") && said.contains(expected), "{said}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// A block of a material with more keys.
fn block(space: &str, material: &str, body: &str, rest: &str) -> String {
    let corner = if space == "3d" { "[1, 1, 1]" } else { "[1, 1]" };
    let from = if space == "3d" { "[0, 0, 0]" } else { "[0, 0]" };
    format!(
        r#"
title = "block"
space = "{space}"
end = "1 ms"
method.mpm.cell = "0.25 m"
{rest}
materials.m.{material}
[bodies.block]
material = "m"
shape.box = {{ from = {from}, to = {corner} }}
{body}
"#
    )
}

#[test]
fn initial_stresses_that_cannot_be_are_refused() {
    let elastic = r#"elastic = { density = 2000, young = "50 MPa", poisson = 0.3 }"#;
    let soil = r#"ground.drucker_prager = { density = 2000, young = "50 MPa", poisson = 0.3, friction = "35 deg", cone = "plane_strain" }"#;
    for (space, material, stress, words) in [
        ("plane strain", elastic, r#"{ rr = "1 kPa" }"#, ["initial_stress.rr", "xx, yy, zz, xy"]),
        ("axisymmetric", elastic, r#"{ xx = "1 kPa" }"#, ["initial_stress.xx", "rr, zz, tt, rz"]),
        ("plane strain", elastic, r#"{ yz = "1 kPa" }"#, ["initial_stress.yz", "xx, yy, zz, xy"]),
        ("3d", elastic, r#"{ xx = "= 1e3 * t" }"#, ["initial_stress.xx", "cannot depend on `t`"]),
        ("plane strain", elastic, r#"{ xx = "= 1 / (x - x)" }"#, ["initial_stress", "not finite"]),
        // Without cohesion: tension, and a shear stress that the pressure does not bear.
        (
            "plane strain",
            soil,
            r#"{ xx = "1 MPa", yy = "1 MPa", zz = "1 MPa" }"#,
            ["initial_stress", "beyond its strength"],
        ),
        (
            "plane strain",
            soil,
            r#"{ xx = "-1 kPa", yy = "-1 kPa", zz = "-1 kPa", xy = "5 MPa" }"#,
            ["initial_stress", "beyond its strength"],
        ),
    ] {
        refused(&block(space, material, &format!("initial_stress = {stress}"), ""), &words);
    }
    let bearable = r#"initial_stress = { xx = "-90 kPa", yy = "-100 kPa", zz = "-90 kPa", xy = "5 kPa" }"#;
    assert_eq!(said(&block("plane strain", soil, bearable, "")), None);
}

#[test]
fn tables_and_shapes_of_bodies_that_are_not_there_are_refused() {
    let elastic = r#"elastic = { density = 2000, young = "50 MPa", poisson = 0.3 }"#;
    let load = r#"traction = { region.box = { from = [0, 0.7], to = [1, 1] }, normal = "y", traction = [0, "= -2 * pulse"] }"#;
    let with = |table: &str| block("plane strain", elastic, load, table);
    assert_eq!(said(&with(r#"tables.pulse.points = [[0, 0], ["1 ms", "10 kPa"]]"#)), None);
    refused(&with(""), &["traction", "`pulse` is neither a coordinate"]);
    refused(&with("tables.pulse.points = [[0, 1]]"), &["tables.pulse", "at least 2"]);
    refused(&with("tables.pulse.points = [[1, 1], [1, 2]]"), &["tables.pulse", "times must rise"]);
    refused(&with("tables.pulse = {}"), &["tables.pulse", "needs `points` or a `file`"]);
    refused(&with("tables.pulse.file = \"none.csv\""), &["tables.pulse", "none.csv"]);
    refused(
        &with("tables.pulse = { points = [[0, 1], [1, 2]], columns = [1, 2] }"),
        &["tables.pulse", "are of a `file`"],
    );
    refused(&with("tables.t.points = [[0, 1], [1, 2]]"), &["tables.t", "variable of formulas"]);
    refused(
        &with("parameters.pulse = 1\ntables.pulse.points = [[0, 1], [1, 2]]"),
        &["tables.pulse", "is a parameter, too"],
    );
    let cut = |of: &str| {
        let text = block("plane strain", elastic, "", "");
        let shape = format!(
            "shape.difference = [{{ box = {{ from = [0, 0], to = [1, 1] }} }}, {{ body = \"{of}\" }}]"
        );
        text.replace("shape.box = { from = [0, 0], to = [1, 1] }", &shape)
    };
    refused(&cut("rod"), &["bodies.block.shape", "no body has the name `rod`"]);
    refused(&cut("block"), &["bodies.block.shape", "a shape that is not its own"]);
}

#[test]
fn a_key_that_stands_elsewhere_is_named() {
    let text =
        block("plane strain", r#"elastic = { density = 2000, young = "50 MPa", poisson = 0.3 }"#, "", "");
    refused(&format!("{text}\n[[conditions]]\ntraction = 1\n"), &["conditions[", "`bodies.NAME.traction`"]);
}

/// Two blocks of the material point method, of which the left one is of another kind.
fn of_kind(kind: &str, key: &str) -> String {
    let method = match kind {
        "rigid" | "elements" | "mpm" => METHODS[0],
        "fem" => METHODS[1],
        "sph" => METHODS[2],
        "fpm" => METHODS[3],
        _ => METHODS[4],
    };
    let text = blocks(method, FRICTION, "");
    let body = match kind {
        "rigid" => "rigid = { density = 7800 }",
        "elements" => "material = \"steel\"\nelements = {}\nmesh.edge = \"2 mm\"",
        _ => "material = \"steel\"",
    };
    text.replacen("material = \"steel\"", &format!("{body}\n{key}"), 1)
}

#[test]
fn keys_that_a_kind_of_body_does_not_read_are_refused() {
    const ALL: [&str; 7] = ["mpm", "rigid", "elements", "pcmm", "sph", "fpm", "fem"];
    let traction =
        "traction = { region.box = { from = [-1, -1], to = [1, 1] }, normal = \"x\", traction = [1, 0] }";
    let notch = "notches = [{ corners = [[0, \"5 mm\"], [\"4 mm\", \"5 mm\"]] }]";
    // Keys, and the kinds that read each.
    let keys: [(&str, &str, &[&str]); 8] = [
        ("body_force", "body_force = [1, 0]", &["mpm"]),
        ("lit", "lit = [{ at = [0, 0] }]", &[]),
        ("deactivated", "deactivated = true", &["mpm"]),
        ("initial_stress", "initial_stress = { xx = \"-1 Pa\" }", &["mpm", "sph"]),
        ("traction", traction, &["mpm", "sph", "fpm", "fem"]),
        ("notches", notch, &["fpm"]),
        ("integration", "integration = \"full\"", &["fem", "elements"]),
        ("erosion", "erosion = { volume = 0.1 }", &["fem", "elements"]),
    ];
    for (key, value, kinds) in keys {
        for kind in ALL {
            let text = of_kind(kind, value);
            if kinds.contains(&kind) {
                assert_eq!(said(&text), None, "{kind} reads `{key}`:\n{text}");
            } else {
                refused(&text, &[&format!("bodies.left.{key}")]);
            }
        }
    }
    let two = of_kind("elements", "rigid = { density = 1 }");
    refused(&two, &["bodies.left.rigid"]);
}

#[test]
fn elements_meet_all_particles_by_one_law() {
    let pairs = "[contact]\nlaw.friction = 0\npairs = [{ between = [\"left\", \"right\"], law = { friction = 0.8 } }]";
    let third = "[bodies.third]\nmaterial = \"steel\"\nshape.box = { from = [\"40 mm\", 0], to = [\"50 mm\", \"10 mm\"] }\n";
    let elements = of_kind("elements", "").replace(FRICTION, "");
    let two = format!("{elements}\n{pairs}");
    assert_eq!(said(&two), None);
    refused(&format!("{elements}\n{third}{pairs}"), &["contact.law", "`left`", "by = \"grid\""]);
}

#[test]
fn motions_of_conditions_that_cannot_be_are_refused() {
    let with = |condition: &str| blocks(METHODS[1], FRICTION, &format!("conditions = [{{ {condition} }}]"));
    let wall = |keys: &str| with(&format!("wall = {{ axis = \"y\", at = 0, {keys} }}"));
    refused(
        &wall("position = \"= 1 + t\""),
        &["conditions[0].wall.position", "is 1 m at the start", "`at`, 0 m"],
    );
    let both = "velocity = [0, 1], position = \"= t\"";
    refused(&wall(both), &["conditions[0].wall.position", "either `velocity` or `position`"]);
    refused(&wall("velocity = [\"= t\", 0]"), &["conditions[0].wall.velocity", "drags nothing along"]);
    refused(&wall("velocity = [0, \"= x\"]"), &["conditions[0].wall.velocity[1]", "cannot depend on `x`"]);
    assert_eq!(said(&wall("velocity = [\"= t\", \"= -t\"], friction = 0.3")), None);
    assert_eq!(said(&wall("position = \"= -0.1 * t\"")), None);
}

#[test]
fn measures_name_conditions_that_exist() {
    let scene = |method: &str, measure: &str| {
        let planes = [
            "{ wall = { axis = \"y\", at = 0, name = \"floor\" } }",
            "{ symmetry = { axis = \"x\", at = 0 } }",
            "{ symmetry = { axis = \"x\", at = \"30 mm\", side = \"below\" } }",
        ];
        let rest = format!("conditions = [{}]\nmeasures.force = {{ {measure} }}", planes.join(", "));
        blocks(method, FRICTION, &rest)
    };
    let force = |of: &str| format!("condition_force = {{ axis = \"y\", condition = {of} }}");
    for method in METHODS {
        let key = "measures.force.condition_force.condition";
        refused(
            &scene(method, &force("\"flor\"")),
            &[key, "`flor`", "floor, symmetry, wall", "did you mean `floor`"],
        );
        refused(&scene(method, &force("3")), &[key, "no condition has the place 3; there are 3, from 0"]);
        for of in ["\"floor\"", "\"wall\"", "0"] {
            assert_eq!(said(&scene(method, &force(of))), None, "{method}");
        }
        // On a grid the impulse of planes is that along their axis.
        let told = !(method.contains("mpm") || method.contains("sph"));
        assert_eq!(said(&scene(method, &force("\"symmetry\""))).is_none(), told, "{method}");
    }
}

#[test]
fn loads_profiles_and_masses_that_cannot_be_are_refused() {
    let load = |method: &str, keys: &str| {
        let text = blocks(method, FRICTION, "");
        text.replacen("[bodies.right]", &format!("traction = {{ {keys} }}\n[bodies.right]"), 1)
    };
    let region = "region.box = { from = [\"-1 mm\", \"-1 mm\"], to = [\"1 mm\", \"11 mm\"] }";
    let pressure = format!("{region}, pressure = \"1 MPa\"");
    for method in METHODS {
        match said(&load(method, &pressure)) {
            None => assert!(method.contains("fem") || method.contains("fpm"), "{method}"),
            Some(said) => assert!(said.contains("bodies.left.traction"), "{said}"),
        }
    }
    let fem = METHODS[1];
    refused(
        &load(fem, &format!("{pressure}, traction = [0, 0]")),
        &["a `traction` or a `pressure`, and not both"],
    );
    refused(&load(fem, "pressure = 1"), &["a `region` or a `surface`, and not both"]);
    refused(&load(fem, "surface = \"top\", pressure = 1"), &["bodies.left.traction.surface", "`top`"]);
    refused(&load(fem, &format!("{region}, traction = [0, 0]")), &["needs the axis `normal`"]);
    let with = |rest: &str| blocks(fem, FRICTION, rest);
    refused(&with("mass_scaling = 0.5"), &["mass_scaling", "0.5 is not allowed; it must be at least 1"]);
    let profile = |keys: &str, rest: &str| {
        let line = "body = \"left\", field = \"speed\", from = [0, 0]";
        with(&format!("profiles.p = {{ {line}, {keys} }}\n{rest}"))
    };
    refused(&profile("to = [0, 0], bins = 3", ""), &["profiles.p.to", "needs a length"]);
    refused(&profile("to = [1, 0], bins = 0", ""), &["profiles.p.bins", "1 to 1000"]);
    refused(&profile("to = [1, 0, 0], bins = 3", ""), &["profiles.p.to", "has 3 components"]);
    let measure = "measures.x = { profile = { of = \"p\", bin = 4 } }";
    let bin = profile("to = [1, 0], bins = 3", measure);
    refused(&bin, &["measures.x.profile.bin", "4 is not allowed; it must be 1 to 3"]);
}
