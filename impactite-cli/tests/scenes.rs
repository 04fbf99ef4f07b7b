//! The scenes of the folder `scenes`: each runs, with cells so coarse that it takes seconds, and meets what it checks.

use std::process::Command;

/// Name of a scene, keys for coarser cells or a shorter time, and whether its checks are judged with these.
const SCENES: &[(&str, &[&str], bool)] = &[
    ("taylor_bar", &["parameters.cells=5"], true),
    ("rings", &[], true),
    ("rolling_cylinder", &[], true),
    ("granular_column", &["parameters.cells=10"], false),
    ("tnt", &["parameters.cells=200"], true),
    ("elastic_bar", &[], true),
    ("copper_bar", &[], true),
    ("pressed_balls", &["end=\"60 us\""], true),
    ("debris_cloud", &["parameters.layers=4", "end=\"6 us\""], true),
    ("concrete_perforation", &[], true),
    ("reinforced_bar", &[], true),
    ("oblique_penetration", &["parameters.cells=6", "end=\"100 us\""], false),
];

#[test]
fn every_scene_runs_and_meets_what_it_checks() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let out = std::env::temp_dir().join(format!("impactite-scenes-{}", std::process::id()));
    let mut there: Vec<String> = std::fs::read_dir(&root)
        .expect("the folder `scenes`")
        .filter_map(|e| e.ok()?.file_name().to_str()?.strip_suffix(".toml").map(String::from))
        .collect();
    there.sort();
    let mut listed: Vec<&str> = SCENES.iter().map(|s| s.0).collect();
    listed.sort_unstable();
    assert_eq!(there, listed, "every scene is tested");
    for (name, keys, judged) in SCENES {
        let scene = root.join(format!("{name}.toml"));
        let mut command = Command::new(env!("CARGO_BIN_EXE_impactite"));
        command.args(["run", "--json", "--no-pictures", "-q"]).arg(&scene).arg("--out").arg(out.join(name));
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
        // What a transfer filters is lost; nothing is gained.
        assert!(result["energy_error"].as_f64().expect(&said) < 0.05, "{said}");
        assert!(out.join(name).join("report.html").exists());
    }
    std::fs::remove_dir_all(out).expect("the folder of the runs");
}
