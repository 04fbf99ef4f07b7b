//! Convergence studies by the program.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Undeformed block under a gravity that grows linearly with time: velocity 2e6 t^2, 2 m/s after 1 ms. Its mass does not depend on the
/// resolution.
const BLOCK: &str = r#"
title = "A block in a <growing> field"
space = "plane strain"
end = "1 ms"
gravity = [0, "= 4e6 * t"]

[parameters]
side = "4 mm"
cells = 2

[method.mpm]
cell = "side / cells" # of the coarsest level

[time_step]
fixed = "50 us"

[materials.rubber.neo_hookean]
density = "1 g/cm^3"
young = "10 kPa"
poisson = 0.4

[bodies.block]
material = "rubber"
shape.box = { from = [0, 0], to = ["side", "side"] }

[measures]
speed = { mean_velocity = { body = "block", axis = "y" } }
mass = { mass = { body = "block" } }

[[checks]]
measure = "speed"
reference = "2 m/s"
tolerance = 0.02
source = "integral of the acceleration"
"#;

fn impactite(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_impactite"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("the program")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).to_string() + &String::from_utf8_lossy(&output.stderr)
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("impactite-converge-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("block.toml"), BLOCK).expect("a file");
    folder
}

fn read(path: impl AsRef<Path>) -> String {
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.as_ref().display()))
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}:\n{text}"))
}

/// The velocity is integrated with a fixed step, whose error is of first order and exactly linear for a force linear in time.
#[test]
fn a_study_finds_order_and_limit() {
    let at = folder("order");
    let output = impactite(&at, &["converge", "block.toml", "--no-pictures", "--json"]);
    let text = said(&output);
    println!("{text}");
    assert!(output.status.success(), "{text}");
    let out = at.join("out/block-converge");
    let last = String::from_utf8_lossy(&output.stdout).lines().last().unwrap_or_default().to_string();
    assert_eq!(read(out.join("converge.json")), last.clone() + "\n");
    let study = json(&last);
    let [speed, mass] = [0, 1].map(|n| &study["measures"][n]);
    // Tolerance: rounding of a difference of a hundredth of the values, in forty steps.
    let close = |x: &serde_json::Value, to: f64| (x.as_f64().expect("a number") - to).abs() < 1e-9;
    assert!(close(&speed["order"], 1.0) && close(&speed["extrapolated"], 2.0), "{speed}");
    let finest = speed["values"][2].as_f64().expect("a number");
    assert!(close(&speed["band"], 1.25 * (finest - 2.0).abs()), "{speed}");
    assert_eq!((&mass["trend"], mass["order"].is_null()), (&"unchanged".into(), true));
    assert_eq!(study["checks"][0]["extrapolated"], "passed");
    // The step scales with the cell.
    let keys: Vec<&str> =
        study["refined"].as_array().expect("keys").iter().filter_map(|k| k["key"].as_str()).collect();
    assert_eq!(keys, ["method.mpm.cell", "time_step.fixed"]);
    assert_eq!(study["refined"][0]["values"], serde_json::json!([0.002, 0.001, 0.0005]));
    let steps: Vec<u64> =
        study["levels"].as_array().expect("levels").iter().filter_map(|l| l["steps"].as_u64()).collect();
    assert!((19..=21).contains(&steps[0]) && (79..=81).contains(&steps[2]), "{steps:?}");

    for words in
        ["level 3 of 3", "points", "steps: about", "unchanged within rounding", "check speed: finest passed"]
    {
        assert!(text.contains(words), "no {words:?} in\n{text}");
    }
    let table = read(out.join("converge.csv"));
    assert!(table.starts_with("measure,unit,level 1,level 2,level 3,order,extrapolated,band,convergence\nmethod.mpm.cell,m,0.002,"), "{table}");
    let page = read(out.join("converge.html"));
    assert!(
        page.contains("A block in a &lt;growing&gt; field")
            && page.contains("./003/report.html")
            && page.contains("data:image/png")
    );
    assert!(out.join("converge.png").exists() && !out.join("sweep.csv").exists());
    // The coarsest run equals the scene as written, to the bit.
    let alone = impactite(&at, &["run", "block.toml", "--no-pictures", "--no-report", "--out", "alone"]);
    let measures = |path: PathBuf| json(&read(path))["measures"].clone();
    assert_eq!(
        measures(at.join("alone/result.json")),
        measures(out.join("001/result.json")),
        "{}",
        said(&alone)
    );

    // `--coarser` with two threads: the scene is the finest of two levels, which have no order.
    let coarser = [
        "converge",
        "block.toml",
        "--no-pictures",
        "--no-report",
        "--levels",
        "2",
        "--coarser",
        "--ratio",
        "1.5",
        "--threads",
        "2",
        "--out",
        "c",
    ];
    let output = impactite(&at, &[&coarser[..], &["--set", "parameters.cells=3"]].concat());
    let text = said(&output);
    assert!(text.contains("order unknown: two levels") && text.contains("extrapolated unknown"), "{text}");
    let study = json(&read(at.join("c/converge.json")));
    assert_eq!(study["levels"][0]["factor"], 1.5);
    assert_eq!(study["refined"][1]["values"][1], 5e-5);
    assert!(!at.join("c/converge.html").exists());
    std::fs::remove_dir_all(at).unwrap();
}

#[test]
fn exit_codes_tell_checks_from_errors() {
    let at = folder("codes");
    let run = |arguments: &[&str]| {
        let options = ["converge", "block.toml", "--no-pictures", "--no-report"];
        let output = impactite(&at, &[&options[..], arguments].concat());
        (output.status.code(), said(&output))
    };
    let (code, text) = run(&["--set", "checks[0].reference=\"3 m/s\""]);
    assert!(
        code == Some(1) && text.contains("finest FAILED") && text.contains("extrapolated FAILED"),
        "{text}"
    );
    // The tolerance limit lies within the error band of the finest level.
    let (code, text) = run(&["--set", "checks[0].tolerance=0.01"]);
    assert!(code == Some(1) && text.contains("undecided"), "{text}");
    for (arguments, words) in [
        (&["--ratio", "1.1"][..], "from 1.2 to 10"),
        (&["--levels", "1"], "2..=8"),
        (&["--set", "measures={}", "--set", "checks=[]"], "no measures"),
        (&["--refine", "method.mpm.cel"], "no such key"),
        // Refinement of one size only.
        (
            &["--refine", "method.mpm.cell"],
            "time_step.fixed: is 5.000000e-5 s at level 2; it must be 2.500000e-5 s",
        ),
        (&["--set", "bodies.block.mesh={ gmsh = { file = \"a.msh\", unit = 1 } }"], "bodies.block.mesh.gmsh"),
    ] {
        let (code, text) = run(arguments);
        assert!(code == Some(2) && text.contains(words), "{arguments:?}: {text}");
    }
    // A file in the place of its folder lets one level fail; the other levels have values.
    std::fs::create_dir_all(at.join("f")).unwrap();
    std::fs::write(at.join("f/003"), "").unwrap();
    let (code, text) = run(&["--out", "f"]);
    assert!(
        code == Some(2) && text.contains("a level has no value") && text.contains("003 failed: "),
        "{text}"
    );
    let study = json(&read(at.join("f/converge.json")));
    assert!(study["measures"][0]["values"][1].is_number() && study["measures"][0]["values"][2].is_null());
    std::fs::remove_dir_all(at).unwrap();
}

/// Kill the study in one of its runs.
#[cfg(unix)]
#[test]
fn a_study_goes_on_where_it_was_stopped() {
    let at = folder("resumed");
    let options = [
        "converge",
        "block.toml",
        "--no-pictures",
        "--set",
        "parameters.cells=8",
        "--set",
        "time_step.fixed=\"10 us\"",
    ];
    let whole = impactite(&at, &[&options[..], &["--out", "whole"]].concat());
    assert!(whole.status.success(), "{}", said(&whole));
    let mut child = Command::new(env!("CARGO_BIN_EXE_impactite"))
        .current_dir(&at)
        .args([&options[..], &["--out", "cut", "--checkpoint", "0"]].concat())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program");
    let begun = Instant::now();
    while !at.join("cut/003/run.checkpoint").exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "no checkpoint");
        assert!(child.try_wait().expect("its state").is_none(), "it ended");
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().expect("its end");
    child.wait().expect("its end");
    assert!(!at.join("cut/converge.json").exists(), "it was over before");
    let first = |folder: &str| {
        std::fs::metadata(at.join(folder).join("001/result.json")).unwrap().modified().unwrap()
    };
    let before = first("cut");
    let resumed = impactite(Path::new("/"), &["resume", at.join("cut").to_str().unwrap(), "--json"]);
    assert!(resumed.status.success(), "{}", said(&resumed));
    assert_eq!(first("cut"), before, "a run that had ended was made again");
    for file in ["converge.csv", "converge.png"] {
        let bytes = |folder: &str| std::fs::read(at.join(folder).join(file)).unwrap();
        assert!(bytes("whole") == bytes("cut"), "another {file}");
    }
    let last = String::from_utf8_lossy(&resumed.stdout).lines().last().unwrap_or_default().to_string();
    assert_eq!(json(&last)["measures"], json(&read(at.join("whole/converge.json")))["measures"]);
    assert!(at.join("cut/converge.html").exists());
    // A sweep in the same folder removes the files of the study.
    let sweep = [
        "sweep",
        "block.toml",
        "--no-pictures",
        "--no-report",
        "--out",
        "cut",
        "--over",
        "parameters.cells=2",
    ];
    let output = impactite(&at, &sweep);
    assert!(output.status.success() && !at.join("cut/converge.json").exists(), "{}", said(&output));
    std::fs::remove_dir_all(at).unwrap();
}
