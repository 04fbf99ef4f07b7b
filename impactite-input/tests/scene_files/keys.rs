//! The reference of keys: it has all of the schema, its examples are read, its defaults are those of the code, and the page of the book is it.

use std::collections::{BTreeMap, BTreeSet};

use impactite_input::Source;
use impactite_input::keys::{self, Key};
use impactite_input::list::Topic;
use serde_json::Value;

fn by_path() -> BTreeMap<String, Key> {
    keys::all().into_iter().map(|key| (key.path.clone(), key)).collect()
}

/// The types of the schema with their fields and alternatives, found without the reference.
fn of_schema() -> (BTreeSet<(String, String)>, BTreeSet<String>) {
    let schema = impactite_input::schema().to_value();
    let (mut fields, mut words) = (BTreeSet::new(), BTreeSet::new());
    let mut add = |name: &str, of: &Value| {
        for field in of["properties"].as_object().into_iter().flatten() {
            fields.insert((name.to_string(), field.0.clone()));
        }
        for one in of["oneOf"].as_array().into_iter().flatten() {
            words.extend(one["const"].as_str().map(String::from));
            words.extend(
                one["enum"].as_array().into_iter().flatten().filter_map(|w| Some(w.as_str()?.to_string())),
            );
            words.extend(one["properties"].as_object().into_iter().flatten().map(|(word, _)| word.clone()));
        }
    };
    add("SceneFile", &schema);
    for (name, of) in schema["$defs"].as_object().expect("types") {
        add(name, of);
    }
    (fields, words)
}

#[test]
fn every_key_of_the_schema_is_there_once_with_words_and_an_example() {
    let all = keys::all();
    let there: BTreeSet<_> = all.iter().filter_map(|key| key.field.clone()).collect();
    let (fields, words) = of_schema();
    assert_eq!(there, fields);
    let told: BTreeSet<String> = all
        .iter()
        .flat_map(|key| {
            key.words.iter().map(|w| w.0.clone()).chain(key.path.rsplit('.').next().map(String::from))
        })
        .collect();
    let missing: Vec<_> = words.difference(&told).collect();
    assert!(missing.is_empty(), "{missing:?}");
    assert_eq!(by_path().len(), all.len(), "a path is there twice");
    for key in &all {
        assert!(!key.what.is_empty() && !key.example.is_empty(), "{key:?}");
        assert!(!key.value().is_empty() || !key.words.is_empty(), "{}: of no kind", key.path);
    }
}

#[test]
fn every_example_is_read_in_a_scene() {
    for key in keys::all() {
        let source =
            Source::from_json(key.path.clone(), &key.scene.to_string()).unwrap_or_else(|e| panic!("{e}"));
        // The line is the example of that scene.
        let line: toml_edit::DocumentMut =
            key.example.parse().unwrap_or_else(|e| panic!("{}: {e}", key.example));
        assert!(!line.is_empty(), "{}", key.example);
        let scene = source.parse();
        assert!(scene.is_ok(), "{}: {}: {}\n{}", key.path, key.example, scene.unwrap_err(), key.scene);
    }
}

#[test]
fn what_must_be_there_is_missed_and_what_need_not_is_not() {
    let mut missed = 0;
    for key in keys::all().into_iter().filter(|key| key.field.is_some()) {
        let mut scene = key.scene.clone();
        remove(&mut scene, &key.path.split('.').collect::<Vec<_>>());
        let source = Source::from_json("scene.toml", &scene.to_string()).unwrap_or_else(|e| panic!("{e}"));
        let read = source.parse();
        assert_eq!(read.is_err(), key.required, "{}: {:?}", key.path, read.err().map(|e| e.to_string()));
        missed += usize::from(key.required);
    }
    assert!(missed > 50, "{missed}");
}

/// Take away what stands at the end of a path.
fn remove(value: &mut Value, path: &[&str]) {
    let (first, rest) = path.split_first().expect("a path");
    let name = first.trim_end_matches("[]");
    let object = value.as_object_mut().unwrap_or_else(|| panic!("{path:?}: no table"));
    if rest.is_empty() {
        assert!(object.remove(name).is_some(), "{path:?}: not there");
        return;
    }
    // A name of one's own: the only one.
    let name = if name == "NAME" { object.keys().next().expect("a name").clone() } else { name.to_string() };
    let mut inner = object.get_mut(&name).unwrap_or_else(|| panic!("{path:?}: no {name}"));
    if first.ends_with("[]") {
        inner = &mut inner[0];
    }
    remove(inner, rest);
}

/// A scene with a key, and one without: the same steps where the default is what the reference says.
#[test]
fn defaults_are_what_scenes_without_the_key_have() {
    let block = |method: &str, body: &str, more: &str| {
        format!(
            "title = \"t\"\nspace = \"plane strain\"\nend = \"4 us\"\n{method}\n\
             materials.steel = {{ library = \"arne_tool_steel\" }}\nmaterials.tnt = {{ library = \"tnt\" }}\n{more}\n\
             [bodies.body]\nmaterial = \"steel\"\nshape.box = {{ from = [0, 0], to = [\"4 mm\", \"4 mm\"] }}\nvelocity = [\"50 m/s\", 0]\n{body}\n"
        )
    };
    let wall = "conditions = [{ wall = { axis = \"x\", at = \"4 mm\", side = \"below\" } }]";
    let mpm = "method.mpm = { cell = \"1 mm\" }";
    let charge =
        block(mpm, "lit = [{ at = [0, 0] }]", "").replace("material = \"steel\"", "material = \"tnt\"");
    let scenes = [
        ("method.mpm.for", block(mpm, "", wall), "method.mpm.for"),
        ("method.mpm.particles_per_cell", block(mpm, "", wall), "method.mpm.particles_per_cell"),
        (
            "method.fem.subcycles",
            block("method.fem = {}", "mesh.edge = \"1 mm\"", wall),
            "method.fem.subcycles",
        ),
        (
            "bodies.NAME.integration.one_point.stiffness",
            block("method.fem = {}", "mesh.edge = \"1 mm\"\nintegration.one_point = {}", wall),
            "bodies.body.integration.one_point.stiffness",
        ),
        ("method.fpm.penalty", block("method.fpm = { spacing = \"1 mm\" }", "", wall), "method.fpm.penalty"),
        ("method.fpm.seed", block("method.fpm = { spacing = \"1 mm\" }", "", wall), "method.fpm.seed"),
        ("method.fpm.points", block("method.fpm = { spacing = \"1 mm\" }", "", wall), "method.fpm.points"),
        ("method.sph.form", block("method.sph = { spacing = \"1 mm\" }", "", wall), "method.sph.form"),
        (
            "method.pcmm.tolerance",
            block("method.pcmm = { spacing = \"1 mm\" }", "", wall),
            "method.pcmm.tolerance",
        ),
        (
            "method.pcmm.stretch",
            block("method.pcmm = { spacing = \"1 mm\" }", "", wall),
            "method.pcmm.stretch",
        ),
        ("materials.NAME.burn_width", charge.clone(), "materials.tnt.burn_width"),
        ("bodies.NAME.lit[].time", charge, "bodies.body.lit[0].time"),
    ];
    let keys = by_path();
    let state = |source: &Source| {
        let scene = source.parse().unwrap_or_else(|e| panic!("{e}"));
        let mut solver = source.build(&scene).unwrap_or_else(|e| panic!("{e}"));
        for _ in 0..12 {
            solver.step_at_most(f64::INFINITY).unwrap_or_else(|e| panic!("{}: {e}", source.text));
        }
        solver.bodies()[0].points()
    };
    for (path, text, place) in scenes {
        let source = Source::new("scene.toml", text);
        let default = keys[path].default.clone().unwrap_or_else(|| panic!("{path} has no default"));
        let with = source.set(&format!("{place}={default}")).unwrap_or_else(|e| panic!("{e}"));
        assert!(state(&source) == state(&with), "{path} = {default} is another scene than without it");
        // The key does something: another value is another scene.
        let other = match default.parse::<f64>() {
            Ok(x) if path.ends_with("time") => format!("{}", x + 2e-7),
            Ok(x) if x == x.trunc() => format!("{}", x as u64 + 1),
            Ok(x) => format!("{}", 0.9 * x),
            Err(_) => format!("\"{}\"", keys[path].words[1].0),
        };
        // Keys that matter only once bodies subcycle or lattices part.
        if !["method.fem.subcycles", "method.pcmm.stretch", "method.pcmm.tolerance"].contains(&path) {
            let other = source.set(&format!("{place}={other}")).unwrap_or_else(|e| panic!("{e}"));
            assert!(state(&source) != state(&other), "{path} does nothing");
        }
    }
}

#[test]
fn the_page_of_the_book_is_up_to_date() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/book/src/keys.md");
    let Ok(page) = std::fs::read_to_string(path) else { return };
    assert!(
        page == keys::markdown(),
        "docs/book/src/keys.md is of other types: `cargo run --release -- list keys --markdown > docs/book/src/keys.md`"
    );
}

#[test]
fn prefixes_find_keys_below_names_and_lists() {
    for (prefix, first, count) in [
        ("bodies.plate.shape.ball", "bodies.NAME.shape.ball", 3),
        ("bodies.NAME.rigid", "bodies.NAME.rigid", 5),
        ("conditions.periodic", "conditions[].periodic", 4),
        ("checks[0].tolerance", "checks[].tolerance", 1),
        ("space", "space", 1),
        ("nonsense", "", 0),
    ] {
        let found = keys::below(prefix);
        assert_eq!(found.len(), count, "{prefix}: {:?}", found.iter().map(|k| &k.path).collect::<Vec<_>>());
        assert!(found.iter().all(|key| key.path.starts_with(first)), "{prefix}");
    }
    assert_eq!(keys::below("").len(), keys::all().len());
}

#[test]
fn lists_have_the_key_that_takes_a_law_and_what_named_sets_are() {
    let laws = Topic::Laws.lines();
    let names: Vec<&str> = laws.iter().map(|l| l.name.as_str()).collect();
    for name in [
        "elastic",
        "neo_hookean",
        "strength.johnson_cook",
        "failure.johnson_cook",
        "eos.mie_gruneisen",
        "fluid.mie_gruneisen",
    ] {
        assert_eq!(names.iter().filter(|n| **n == name).count(), 1, "{name} in {names:?}");
    }
    let contacts = Topic::Contacts.lines();
    let groups: BTreeSet<&str> = contacts.iter().map(|l| l.group.as_str()).collect();
    assert_eq!(groups, BTreeSet::from(["contact.law", "contact.detector"]));
    let sets = Topic::Materials.lines();
    assert_eq!(sets.len(), impactite_input::model::material::Library::ALL.len());
    for set in &sets {
        assert!(set.what.contains("Source: "), "{}: {}", set.name, set.what);
        let properties = set.fields.join("\n");
        assert!(
            properties.contains("density ") && properties.contains("failure: "),
            "{}: {properties}",
            set.name
        );
    }
    let aluminium = &sets.iter().find(|s| s.name == "aluminium_6061_t6").expect("aluminium").fields;
    assert!(aluminium[0].starts_with("density 2700 kg/m^3, wave speed 6469 m/s, bulk modulus 78.324 GPa, shear modulus 26 GPa, initial yield stress 324 MPa"), "{aluminium:?}");
    let parts = Topic::Parts.lines();
    assert!(parts.iter().any(|l| l.name == "impact" && l.what.contains("quadratic_b_spline, aflip, usl")));
}

/// Choices of `for` agree with the list, and each combination of the list is compiled.
#[test]
fn purposes_and_parts_are_those_of_the_list() {
    let method = |options: &str| {
        let text = format!(
            "title = \"t\"\nspace = \"plane strain\"\nend = 1e-6\nmethod.mpm = {{ cell = \"1 mm\", {options} }}\n\
             materials.steel.library = \"steel_elastic\"\n[bodies.body]\nmaterial = \"steel\"\nshape.ball = {{ centre = [0, 0], radius = \"4 mm\" }}\n"
        );
        let source = Source::new("scene.toml", text);
        let scene = source.parse().unwrap_or_else(|e| panic!("{e}"));
        source.build(&scene).unwrap_or_else(|e| panic!("{options}: {e}")).method()
    };
    let mut compiled = 0;
    for line in Topic::Parts.lines() {
        let options = |parts: &str| {
            let [shape, transfer, update] = parts.split(", ").collect::<Vec<_>>()[..3] else {
                panic!("{parts}")
            };
            let more = if transfer == "blend" { ", relaxation = 1e-6" } else { "" };
            format!(
                "parts = {{ shape_function = \"{shape}\", transfer = \"{transfer}\", stress_update = \"{update}\"{more} }}"
            )
        };
        match line.group.as_str() {
            "method.mpm.for" => {
                let chosen = method(&format!("for = \"{}\"", line.name));
                let frame = if line.what.ends_with("total Lagrangian") { "total" } else { "" };
                assert!(chosen.to_lowercase().contains(frame), "{chosen}");
                // By its parts, where that frame has them.
                if frame.is_empty() {
                    assert_eq!(chosen, method(&options(&line.what)), "{}", line.name);
                }
            }
            "method.mpm.parts" => {
                method(&options(&line.name));
                compiled += 1;
            }
            _ => {}
        }
    }
    assert_eq!(compiled, 9);
}
