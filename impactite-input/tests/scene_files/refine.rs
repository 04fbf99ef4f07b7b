//! Refinement of scenes: which sizes there are, and that all of them shrink together.

use impactite_input::{Size, Source};

fn scene(method: &str, body: &str) -> Source {
    Source::new(
        "scene.toml",
        format!(
            "title = \"b\"\nspace = \"plane strain\"\nend = \"1 us\"\n{method}\nmaterials.copper.library = \"copper_taylor\"\n\
             [bodies.b]\nmaterial = \"copper\"\nshape.box = {{ from = [0, 0], to = [0.1, 0.1] }}\n{body}\n"
        ),
    )
}

fn sizes(source: &Source) -> Vec<Size> {
    let scene = source.parse().unwrap_or_else(|e| panic!("{e}"));
    source.sizes(&scene).unwrap_or_else(|e| panic!("{e}"))
}

fn keys(sizes: &[Size]) -> Vec<String> {
    sizes.iter().map(|size| size.key.clone()).collect()
}

fn refused(source: &Source) -> String {
    let scene = source.parse().unwrap_or_else(|e| panic!("{e}"));
    source.sizes(&scene).expect_err("refused").to_string()
}

#[test]
fn all_sizes_of_a_scene_shrink_together() {
    for (method, body, expected) in [
        ("method.mpm.cell = \"2 mm\"", "", vec!["method.mpm.cell"]),
        ("method.sph.spacing = 0.002", "", vec!["method.sph.spacing"]),
        ("method.pcmm.spacing = 1e-3", "", vec!["method.pcmm.spacing"]),
        (
            "parameters = { rows = 10 }\nmethod.fpm = { spacing = \"0.1 m / rows\" }",
            "",
            vec!["method.fpm.spacing"],
        ),
        (
            "parameters.edge = \"5 mm\"\ntime_step.fixed = 1e-8\nmethod.fem = {}",
            "mesh.edge = \"2 edge\" # of elements\nerosion.step = \"1 ns\"",
            vec!["bodies.b.mesh.edge", "bodies.b.erosion.step", "time_step.fixed"],
        ),
        (
            "method.mpm.cell = \"2 mm\"\ntime_step.fixed = \"10 ns\"",
            "mesh.bars = { lines = [[[0, 0], [\"1 m\", 0]]], edge = \"25 mm\", section = \"1 cm^2\" }\nelements.within = \"c\"",
            vec!["method.mpm.cell", "bodies.b.mesh.bars.edge", "time_step.fixed"],
        ),
        ("method.mpm.cell = \"2 mm\"\ntime_step.factor = 0.5", "", vec!["method.mpm.cell"]),
        // The name is taken.
        (
            "parameters = { size_factor = 2 }\nmethod.mpm.cell = \"size_factor * 1 mm\"",
            "",
            vec!["method.mpm.cell"],
        ),
    ] {
        let source = scene(method, body);
        let before = sizes(&source);
        assert_eq!(keys(&before), expected);
        let (scaled, name) = source.scaled(&before, &keys(&before)).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(sizes(&scaled), before, "the factor is 1 at first");
        for factor in [0.5, 1.5, 0.6666666666666666] {
            let scaled = scaled.set(&format!("parameters.{name}={factor}")).unwrap_or_else(|e| panic!("{e}"));
            for (after, before) in sizes(&scaled).iter().zip(&before) {
                // Rounding of a product.
                let off = after.value / (factor * before.value) - 1.0;
                assert!(off.abs() <= 2.0 * f64::EPSILON, "{} {factor}: {off}\n{}", before.key, scaled.text);
            }
        }
        assert_eq!(body.contains('#'), scaled.text.contains("# of elements"), "comments stay");
    }
}

#[test]
fn scenes_in_json_are_refined() {
    let json = r#"{"title": "b", "space": "plane strain", "end": "1 us", "parameters": {"edge": "2 mm"}, "method": {"mpm": {"cell": "edge"}},
        "materials": {"copper": {"library": "copper_taylor"}}, "bodies": {"b": {"material": "copper", "shape": {"ball": {"centre": [0, 0], "radius": "1 cm"}}}}}"#;
    let source = Source::from_json("scene.json", json).unwrap_or_else(|e| panic!("{e}"));
    let before = sizes(&source);
    // By the parameter that the cell is.
    let (scaled, name) =
        source.scaled(&before, &["parameters.edge".into()]).unwrap_or_else(|e| panic!("{e}"));
    let half = scaled.set(&format!("parameters.{name}=0.5")).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(sizes(&half)[0].value, 0.001);
}

#[test]
fn what_cannot_be_refined_is_refused_with_its_key() {
    let file = scene("method.fem = {}", "mesh.gmsh = { file = \"part.msh\", unit = \"1 mm\" }");
    let said = refused(&file);
    for words in ["scene.toml:", "bodies.b.mesh.gmsh", "cannot be refined", "`mesh.edge`", "impactite sweep"]
    {
        assert!(said.contains(words), "no {words:?} in\n{said}");
    }
    let among = scene(
        "method.mpm.cell = \"2 mm\"",
        "mesh.abaqus = { file = \"part.inp\", unit = \"1 mm\" }\nelements.by = \"surface\"",
    );
    assert!(refused(&among).contains("bodies.b.mesh.abaqus"));
    assert!(refused(&scene("method.fem = {}", "")).contains("no size"));

    let source =
        scene("parameters.cells = 10\nmethod.mpm.cell = \"0.1 m / cells\"", "velocity = [0, \"= 2 * x\"]");
    let before = sizes(&source);
    for (key, words) in [
        ("method.mpm.cel", "no such key"),
        ("bodies.b.shape", "only a number"),
        ("bodies.b.velocity[1]", "a formula"),
        ("bodies.b.velocity[0]", "without a unit"),
        ("bodies.b.velocity[7]", "no such key"),
    ] {
        let error = source.scaled(&before, &[key.into()]).expect_err("refused").to_string();
        assert!(error.contains(words) && error.contains(key.split('[').next().unwrap_or(key)), "{error}");
    }
}

#[test]
fn parameters_of_the_resolution_that_others_use_are_found() {
    let source = scene(
        "parameters = { length = \"0.1 m\", cells = 10, spacing = \"length / cells\", half = \"spacing / 2\" }\n\
         output.histories = \"cells * 10 ns\"\nmethod.mpm.cell = \"spacing\"",
        "velocity = [\"= 3 * cells\", 0]\ntraction = { region.box = { from = [0, \"length - spacing\"], to = [\"length\", \"length\"] }, normal = \"y\", traction = [0, 0] }",
    );
    let parsed = source.parse().unwrap_or_else(|e| panic!("{e}"));
    let shared = source.shared_parameters(&parsed, &["method.mpm.cell".into()]);
    let users = ["parameters.half", "bodies.b.traction.region.box.from[1]"].map(String::from);
    assert_eq!(shared, [("spacing".to_string(), users.to_vec())]);
    // A length in the expression is that of a body; a number in it is one of cells.
    let source = scene(
        "parameters = { length = \"0.1 m\", cells = 10 }\nmethod.mpm.cell = \"length / cells\"",
        "velocity = [\"= 3 * length\", \"= 3 * cells\"]",
    );
    let parsed = source.parse().unwrap_or_else(|e| panic!("{e}"));
    let shared = source.shared_parameters(&parsed, &["method.mpm.cell".into()]);
    assert_eq!(shared, [("cells".to_string(), vec!["bodies.b.velocity[1]".to_string()])]);
}
