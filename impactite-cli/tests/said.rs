//! Messages of the program about scenes, on the terminal and on the page.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("impactite-said-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        Folder(folder)
    }
    fn scene(&self, text: &str) -> PathBuf {
        let path = self.0.join("scene_file.toml");
        std::fs::write(&path, text).expect("written");
        path
    }
    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join("out").join(name)).expect(name)
    }
    fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&self.read(name)).expect("JSON")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn impactite(arguments: &[&str], scene: &Path, out: Option<&Folder>) -> (Output, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_impactite"));
    command.args(arguments).arg(scene).env("NO_COLOR", "1");
    if let Some(folder) = out {
        command.args(["--no-pictures", "--threads", "1", "--out"]).arg(folder.0.join("out"));
    }
    let output = command.output().expect("the program");
    let said = String::from_utf8_lossy(&output.stdout).to_string() + &String::from_utf8_lossy(&output.stderr);
    (output, said)
}

/// Block of lead on a wall, without gravity.
const RESTS: &str = r#"
title = "A block at rest"
description = "Nothing acts on it."
space = "plane strain"
end = "16.7 us"
parameters = { edge = "1 mm", rows = 4 }
method.sph = { spacing = "edge", form = "total_lagrangian" }
materials.lead = { library = "lead", bulk_viscosity = [0.06, 1.5] }
bodies.block = { material = "lead", shape.box = { from = [0, 0], to = ["6 mm", "rows * edge"] }, velocity = [0, 0] }
conditions = [{ wall = { axis = "y", at = 0 } }]
measures = { error = { energy_error = {} }, mass = { mass = { body = "block" } } }
"#;

#[test]
fn of_nothing_no_error_is_said() {
    let folder = Folder::new("rest");
    let (output, said) = impactite(&["run", "--json"], &folder.scene(RESTS), Some(&folder));
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains("no checks;")
            && said.contains("largest energy error none: nothing moves, or the method has no balance"),
        "{said}"
    );
    assert!(
        said.contains("error: 0.000000e0 -") && said.contains(" kg/m\n") && !said.contains("WARN"),
        "{said}"
    );
    assert_eq!(folder.json("result.json")["energy_error"], serde_json::Value::Null);
    assert_eq!(folder.json("run.json")["balances"]["energy_error"], serde_json::Value::Null);
    let page = folder.read("report.html");
    for words in [
        "none: nothing moves, or the method has no balance",
        "<p>Nothing acts on it.</p>",
        "no checks",
        "<td>edge</td><td class=\"name\">0.001 m</td>",
        "<td>rows</td><td class=\"name\">4</td>",
        "beside this page",
    ] {
        assert!(page.contains(words), "the page lacks {words:?}");
    }
}

/// Two steps of a block at a wall that is set in motion.
#[test]
fn an_error_of_few_steps_is_warned_of() {
    let folder = Folder::new("short");
    let scene = folder.scene(RESTS);
    let moving = ["run", "--set", "conditions[0].wall.velocity=[0, 10]", "--set", "end=0.3e-6"];
    let (_, said) = impactite(&moving, &scene, Some(&folder));
    let result = folder.json("result.json");
    let (steps, error) =
        (result["steps"].as_u64().expect("steps"), result["energy_error"].as_f64().expect("motion"));
    assert!(steps < 16 && error.abs() > 0.1, "{result}");
    assert!(said.contains("WARN") && said.contains("the energy balance is off by"), "{said}");
    assert!(said.contains("a later `end` or a smaller `time_step.factor`"), "{said}");
    let page = folder.read("report.html");
    assert!(page.contains("<b>What to do: </b>make more steps, by a later `end`"));
}

#[test]
fn a_plate_is_in_plane_stress() {
    let folder = Folder::new("plate");
    let plate = r#"
title = "strip"
space = "plane stress"
end = "0.5 us"
materials.m.elastic = { density = 2700, young = 7e10, poisson = 0.4 }
bodies.strip = { material = "m", shape.box = { from = [0, 0], to = ["20 mm", "4 mm"] }, velocity = [1, 0] }
"#;
    for method in [
        "fpm = { spacing = \"2 mm\", points = \"lattice\" }",
        "sph = { spacing = \"2 mm\" }",
        "mpm = { cell = \"2 mm\" }",
    ] {
        for (space, other) in [("plane stress", "plane strain"), ("plane strain", "plane stress")] {
            let scene = folder.scene(&(plate.replace("plane stress", space) + "method." + method));
            let (output, said) = impactite(&["check"], &scene, None);
            if method.starts_with("fpm") {
                assert!(output.status.success(), "{said}");
                let (_, said) = impactite(&["run"], &scene, Some(&folder));
                assert!(said.contains(space) && !said.contains(other), "{said}");
                assert!(folder.json("run.json")["method"].as_str().expect("a text").contains(space));
                assert!(!folder.read("report.html").contains(other));
            }
            assert!(!said.contains(other), "{said}");
        }
    }
}

#[test]
fn masses_are_of_what_is_computed() {
    let folder = Folder::new("mass");
    let ball = r#"
title = "ball"
space = "SPACE"
end = "1 us"
method.mpm.cell = "0.5 mm"
materials.copper.library = "copper_taylor"
bodies.ball = { material = "copper", shape.ball = { centre = [0, "2 mm"], radius = "2 mm" } }
"#;
    for (space, unit) in [("axisymmetric", " kg/rad, "), ("plane strain", " kg/m, ")] {
        let (_, said) = impactite(&["check"], &folder.scene(&ball.replace("SPACE", space)), None);
        assert!(said.contains(unit), "{said}");
    }
    let solid = ball.replace("SPACE", "3d").replace("[0, \"2 mm\"]", "[0, 0, 0]");
    let (_, said) = impactite(&["check"], &folder.scene(&solid), None);
    assert!(said.contains(" kg, "), "{said}");
}

/// Control characters of a scene reach neither terminal nor page.
#[test]
fn scenes_do_not_steer_the_terminal() {
    let folder = Folder::new("steer");
    let named = RESTS.replace("A block at rest", "\\u001b[2J\\u0007title").replace("16.7 us", "0.1 us");
    let raw = RESTS.replace("A block at rest", "raw \u{1b}[2J\0");
    let unknown = RESTS.replace("velocity =", "\"vel\\u001bocity\" =");
    let steers = |text: &str| text.chars().any(|c| c.is_control() && c != '\n' && c != '\t');
    for text in [&named, &raw, &unknown] {
        let scene = folder.scene(text);
        for arguments in [&["check"][..], &["run", "--json"]] {
            let out = (arguments[0] == "run").then_some(&folder);
            let (_, said) = impactite(arguments, &scene, out);
            assert!(!steers(&said) && !said.is_empty(), "{said:?}");
        }
    }
    assert!(!steers(&folder.read("report.html")));
}

/// Remedies contain keys of the file and no calls of the library.
#[test]
fn remedies_are_keys() {
    let folder = Folder::new("keys");
    let scene = folder.scene(RESTS);
    let (_, said) =
        impactite(&["check", "--set", "time_step={ gershgorin = { factor = 0.5 } }"], &scene, None);
    assert!(
        said.contains("`time_step.gershgorin` needs the nodes of a grid: take `time_step.factor`"),
        "{said}"
    );
    std::fs::write(folder.0.join("part.msh"), "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n").expect("written");
    let solid = r#"
title = "mesh"
space = "3d"
end = "1 us"
method.mpm.cell = "1 mm"
materials.copper.library = "copper_taylor"
bodies.part = { material = "copper", shape.surface = { file = "FILE", unit = "1 mm" } }
"#;
    let (_, said) = impactite(&["check"], &folder.scene(&solid.replace("FILE", "part.msh")), None);
    assert!(said.contains("a Gmsh file of elements") && said.contains("`bodies.NAME.mesh.gmsh`"), "{said}");
    let (_, said) = impactite(&["check"], &folder.scene(&solid.replace("FILE", "/dev/zero")), None);
    assert!(said.contains("must be a regular file"), "{said}");
}
