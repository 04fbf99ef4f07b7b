//! Scenes of the folder `scenes`: each runs, with cells so coarse that it takes seconds, and passes its checks.

use std::path::Path;
use std::process::Command;

use impactite_cli::templates;

/// Name of a scene, keys for coarser cells or a shorter time, and true if its checks are evaluated with these keys.
const SCENES: &[(&str, &[&str], bool)] = &[
    ("taylor_bar", &["parameters.cells=5"], true),
    ("refined_bar", &[], true),
    ("rings", &[], true),
    ("rolling_cylinder", &[], true),
    ("granular_column", &["parameters.cells=10"], false),
    ("dam_break", &["end=\"0.6 s\""], true),
    ("elastic_gate", &["end=\"0.04 s\""], true),
    ("tnt", &["parameters.cells=200"], true),
    ("elastic_bar", &[], true),
    ("copper_bar", &[], true),
    ("pressed_balls", &["end=\"60 us\""], true),
    ("debris_cloud", &["parameters.layers=4", "end=\"6 us\""], true),
    ("concrete_perforation", &[], true),
    ("reinforced_bar", &[], true),
    ("oblique_penetration", &["parameters.cells=6", "end=\"100 us\""], false),
];

/// Pictures and frames of the start only: unknown fields and colours are errors.
const ONE_PICTURE: [&str; 4] = ["--set", "output.pictures=1e6", "--set", "output.frames=1e6"];

/// Templates, and the largest energy error of each with default options.
const TEMPLATES: &[(&str, f64)] = &[
    ("plate_perforation", 0.05),
    ("rigid_piston", 0.05),
    ("water_column", 0.05),
    ("soil_slope", 0.05),
    ("stl_part", 0.05),
    ("fem_bar", 0.05),
    ("fem_mesh_file", 0.05),
    ("sph_bars", 0.05),
    ("fpm_spall", 0.05),
];

/// Return the names of the scenes of a folder; the program has each as a template.
fn scenes_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder of scenes");
    let mut there: Vec<String> = entries
        .filter_map(|e| e.ok()?.file_name().to_str()?.strip_suffix(".toml").map(String::from))
        .collect();
    there.sort();
    for name in &there {
        assert!(templates::TEMPLATES.iter().any(|t| t.0 == name), "{name} is no template");
    }
    there
}

/// Templates as written by `new`, with default options: without a warning, with a small energy error, every check passed.
#[test]
fn templates_run_as_they_are_without_a_warning_and_pass_their_checks() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/templates");
    let out = std::env::temp_dir().join(format!("impactite-templates-{}", std::process::id()));
    std::fs::create_dir_all(&out).expect("a folder");
    let mut listed: Vec<&str> = TEMPLATES.iter().map(|t| t.0).collect();
    listed.sort_unstable();
    assert_eq!(scenes_in(&root), listed, "every template is tested");
    let program = || Command::new(env!("CARGO_BIN_EXE_impactite"));
    for (name, allowed) in TEMPLATES {
        let scene = out.join(format!("{name}.toml"));
        let made = program().args(["new", name]).arg(&scene).output().expect("the program");
        assert!(made.status.success(), "{name}: {}", String::from_utf8_lossy(&made.stderr));
        let begun = std::time::Instant::now();
        let mut command = program();
        command
            .args(["run", "--json", "-q", "--threads", "1"])
            .args(ONE_PICTURE)
            .arg(&scene)
            .arg("--out")
            .arg(out.join(name));
        let output = command.output().expect("the program");
        let text = String::from_utf8_lossy(&output.stdout).to_string();
        let warnings = String::from_utf8_lossy(&output.stderr).to_string();
        let said = format!("{name}: {text}{warnings}");
        let result: serde_json::Value =
            serde_json::from_str(text.lines().last().unwrap_or_default()).expect(&said);
        println!("{name}: {:.1} s, {}", begun.elapsed().as_secs_f64(), result["checks"]);
        assert!(output.status.success() && result["met"].as_u64() > Some(0), "{said}");
        assert!(warnings.is_empty(), "{said}");
        assert!(result["energy_error"].as_f64().expect(&said).abs() < *allowed, "{said}");
    }
    std::fs::remove_dir_all(out).expect("the folder of the runs");
}

#[test]
fn every_scene_runs_and_meets_what_it_checks() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let out = std::env::temp_dir().join(format!("impactite-scenes-{}", std::process::id()));
    let mut listed: Vec<&str> = SCENES.iter().map(|s| s.0).collect();
    listed.sort_unstable();
    assert_eq!(scenes_in(&root), listed, "every scene is tested");
    for (name, keys, judged) in SCENES {
        let scene = root.join(format!("{name}.toml"));
        let mut command = Command::new(env!("CARGO_BIN_EXE_impactite"));
        command
            .args(["run", "--json", "-q", "--threads", "1"])
            .args(ONE_PICTURE)
            .arg(&scene)
            .arg("--out")
            .arg(out.join(name));
        for key in *keys {
            command.args(["--set", key]);
        }
        let begun = std::time::Instant::now();
        let output = command.output().expect("the program");
        let text = String::from_utf8_lossy(&output.stdout).to_string();
        let said = format!("{name}: {text}{}", String::from_utf8_lossy(&output.stderr));
        let result: serde_json::Value =
            serde_json::from_str(text.lines().last().unwrap_or_default()).expect(&said);
        println!("{name}: {:.1} s, {}", begun.elapsed().as_secs_f64(), result["checks"]);
        let (met, missed) = (result["met"].as_u64().expect(&said), result["missed"].as_u64().expect(&said));
        assert!(met + missed > 0, "{name} checks nothing");
        assert!(!judged || missed == 0, "{said}");
        assert!(result["momentum_error"].as_f64().expect(&said) < 1e-9, "{said}");
        // Transfers may dissipate energy but not generate it.
        assert!(result["energy_error"].as_f64().expect(&said) < 0.05, "{said}");
        assert!(out.join(name).join("report.html").exists());
    }
    std::fs::remove_dir_all(out).expect("the folder of the runs");
}
