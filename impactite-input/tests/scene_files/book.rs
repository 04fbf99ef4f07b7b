//! The scene of the book, and the errors that it shows; every scene of the folder `scenes`.

use impactite_input::Source;

#[test]
fn the_scene_of_the_book_is_one() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/book/src/scene-files.md");
    // The book is not in the package.
    let Ok(page) = std::fs::read_to_string(path) else { return };
    // Others are parts of scenes.
    let blocks = page.split("```toml\n").skip(1).filter_map(|b| b.split("```").next());
    let blocks: Vec<&str> = blocks.filter(|block| block.starts_with("title")).collect();
    assert!(!blocks.is_empty());
    for text in blocks {
        let source = Source::new("bar.toml", text);
        let scene = source.parse().unwrap_or_else(|e| panic!("{e}"));
        let solver = source.build(&scene).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(solver.bodies().len(), 1);

        let wrong = Source::new("bar.toml", text.replace("velocity =", "velocty ="));
        let said = wrong.parse().unwrap_err().to_string();
        let shown = ["bar.toml:20:1", "unknown field `velocty`", "^^^^^^^", "did you mean `velocity`?"];
        assert!(shown.iter().all(|s| said.contains(s) && page.contains(s)), "{said}");
    }
}

#[test]
fn every_scene_can_be_set_up() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let Ok(entries) = std::fs::read_dir(&folder) else { return };
    for entry in entries.chain(std::fs::read_dir(folder.join("templates")).expect("templates")) {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|e| e == "toml") {
            let source = Source::read(&path).unwrap_or_else(|e| panic!("{e}"));
            let scene = source.parse().unwrap_or_else(|e| panic!("{e}"));
            let solver = source.build(&scene).unwrap_or_else(|e| panic!("{e}"));
            assert!(!solver.bodies().is_empty(), "{}", path.display());
            assert!(!scene.description.is_empty(), "{} says nothing of itself", path.display());
        }
    }
}

/// The same scene in Rust and in a file: the same bits.
#[test]
fn a_file_and_a_program_give_the_same_bits() {
    use impactite::prelude::*;
    let text = r#"
title = "bar"
space = "3d"
end = "2 us"
parameters = { radius = "3.8 mm", length = "8 mm" }
method.mpm = { cell = "radius / 4", for = "impact" }
materials.copper = { library = "copper_taylor", bulk_viscosity = [0.06, 1.5] }
conditions = [
    { symmetry = { axis = "x", at = 0 } },
    { symmetry = { axis = "y", at = 0 } },
    { wall = { axis = "z", at = 0 } },
]
[bodies.bar]
material = "copper"
velocity = [0, 0, "-190 m/s"]
shape.intersection = [
    { cylinder = { start = [0, 0, 0], direction = [0, 0, 1], length = "length", radius = "radius" } },
    { box = { from = [0, 0, 0], to = ["radius", "radius", "length"] } },
]
"#;
    let source = Source::new("bar.toml", text);
    let scene = source.parse().expect("a scene");
    let mut of_file = source.build(&scene).expect("a solver");
    of_file.run_until(scene.end.value).expect("a run");

    let (radius, length) = (3.8e-3, 8.0e-3);
    let lattice = Lattice::new([0.0; 3], radius / 4.0).expect("a lattice");
    let bar = Cylinder::new([0.0; 3], [0.0, 0.0, 1.0], length, radius).expect("a cylinder");
    let quarter = bar.and(Cuboid::new([0.0; 3], [radius, radius, length]).expect("a box"));
    let seeds = fill(&quarter, &lattice, 2, &Filling::new()).expect("seeds");
    let seeds = seeds.with_cell_volumes(&quarter, impactite::geometry::Metric::Cartesian);
    let copper =
        Solid::new(JohnsonCook::copper_taylor(), MieGruneisen::copper()).with_bulk_viscosity(0.06, 1.5);
    let mut mpm = Mpm::new(Method::impact(FullSpace), BlockGrid::new(lattice));
    mpm.add("bar", copper.expect("copper"), &seeds, |_| [0.0, 0.0, -190.0]).expect("a bar");
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).expect("a plane");
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).expect("a plane");
    mpm.bound(Boundary::Wall { axis: 2, at: 0.0, side: Side::Above, velocity: 0.0 }).expect("a wall");
    Solver::run_until(&mut mpm, 2.0e-6).expect("a run");

    assert_eq!(of_file.steps(), Solver::steps(&mpm));
    let (a, b) = (of_file.bodies()[0].points(), Solver::bodies(&mpm)[0].points());
    assert_eq!(a.len(), b.len());
    assert!(a.len() > 100 && a.iter().zip(&b).all(|(a, b)| a == b), "other bits");
    // JSON of the same shape is the same scene.
    let json = serde_json::json!({
        "title": "bar", "space": "plane strain", "end": 1e-6,
        "method": { "sph": { "spacing": "1 mm" } },
        "materials": { "steel": { "library": "steel_elastic" } },
        "bodies": { "bar": { "material": "steel", "shape": { "box": { "from": [0, 0], "to": [0.01, 0.004] } }, "speed": 3, "direction": [1, 1] } },
    });
    let source = Source::from_json("bar.json", &json.to_string()).expect("TOML of it");
    let scene = source.parse().expect("a scene");
    let solver = source.build(&scene).expect("a solver");
    let totals = solver.totals();
    assert!((totals.momentum[0] / totals.mass - 3.0 / 2f64.sqrt()).abs() < 1e-12);
}
