//! Run folders: one run at a time, without results of earlier runs, and resumable from any directory.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Rubber disc that falls on a floor.
const DISC: &str = r#"
title = "A disc on a floor"
space = "plane strain"
end = "2 ms"
method.mpm = { cell = "2 mm" }
materials.rubber.neo_hookean = { density = "1 g/cm^3", young = "1 MPa", poisson = 0.4 }
conditions = [{ wall = { axis = "y", at = 0 } }]
[parameters]
speed = "2 m/s"
[bodies.disc]
material = "rubber"
shape.ball = { centre = [0, "11 mm"], radius = "10 mm" }
velocity = [0, "-speed"]
[measures]
height = { centre = { body = "disc", axis = "y" } }
"#;

/// Setting that stops the run: steps beyond the stable time step.
const STOPS: &str = "time_step.fixed=\"80 us\"";

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
    let folder = std::env::temp_dir().join(format!("impactite-folders-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("disc.toml"), DISC).expect("a file");
    folder
}

fn read(path: impl AsRef<Path>) -> String {
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.as_ref().display()))
}

#[test]
fn a_run_that_fails_leaves_no_results_of_an_earlier_one() {
    let at = folder("stale");
    let long = impactite(&at, &["run", "disc.toml", "--out", "r"]);
    assert!(long.status.success(), "{}", said(&long));
    std::fs::write(at.join("r/mine.txt"), "kept").unwrap();
    std::fs::write(at.join("r/pictures/scene_000099.png.1-1.part"), "half").unwrap();
    let output = impactite(&at, &["run", "disc.toml", "--out", "r", "--json", "--set", STOPS]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    let last: serde_json::Value =
        serde_json::from_str(String::from_utf8_lossy(&output.stdout).lines().last().unwrap_or_default())
            .expect("JSON");
    assert!(last["error"].as_str().is_some_and(|e| e.contains("disc")), "{last}");
    assert!(!at.join("r/result.json").exists() && read(at.join("r/run.json")).contains("\"stopped\""));
    assert!(
        !at.join("r/pictures/scene_000040.png").exists()
            && !at.join("r/pictures/scene_000099.png.1-1.part").exists()
    );
    assert_eq!(read(at.join("r/mine.txt")), "kept");
    // A refused scene leaves all files.
    let again = impactite(&at, &["run", "disc.toml", "--out", "r2"]);
    assert!(again.status.success());
    let refused = impactite(&at, &["run", "disc.toml", "--out", "r2", "--set", "method.mpm.cell=0"]);
    assert!(!refused.status.success() && at.join("r2/result.json").exists());
    std::fs::remove_dir_all(at).unwrap();
}

#[cfg(unix)]
#[test]
fn two_runs_do_not_share_a_folder() {
    let at = folder("lock");
    let slow = [
        "run",
        "disc.toml",
        "--out",
        "r",
        "--no-pictures",
        "--set",
        "method.mpm.cell=\"0.2 mm\"",
        "--checkpoint",
        "0",
    ];
    let mut first = Command::new(env!("CARGO_BIN_EXE_impactite"))
        .current_dir(&at)
        .args(slow)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program");
    while !at.join("r/run.checkpoint").exists() {
        assert!(first.try_wait().expect("its state").is_none(), "it ended");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let number = first.id().to_string();
    for arguments in [
        &["run", "disc.toml", "--out", "r"][..],
        &["resume", "r"],
        &["sweep", "disc.toml", "--out", "r", "--over", "end=1 ms"],
    ] {
        let second = impactite(&at, arguments);
        let said = said(&second);
        assert_eq!(second.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains("another run") && said.contains(&number), "{arguments:?}: {said}");
    }
    first.kill().expect("its end");
    first.wait().expect("its end");
    // The lock of a killed run is released.
    let resumed = impactite(&at, &["resume", "r", "--set", "end=1e-5"]);
    assert!(!said(&resumed).contains("another run"), "{}", said(&resumed));
    std::fs::remove_dir_all(at).unwrap();
}

/// Lengthen a run of a scene with a surface file beside it, from another directory.
#[cfg(unix)]
#[test]
fn a_run_is_lengthened_from_anywhere_as_if_it_had_been_so_long() {
    let at = folder("lengthened");
    // Cube of 20 mm.
    let mut stl = String::from("solid cube\n");
    for axis in 0..3 {
        for (side, order) in [(0.0, [0, 2, 1, 0, 3, 2]), (20.0, [0, 1, 2, 0, 2, 3])] {
            let corner = |n: usize| {
                let (u, v) = [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)][n];
                let mut x = [0.0; 3];
                (x[axis], x[(axis + 1) % 3], x[(axis + 2) % 3]) = (side, u, v);
                x
            };
            for t in order.chunks(3) {
                stl += "facet normal 0 0 0\nouter loop\n";
                for &n in t {
                    let [x, y, z] = corner(n);
                    stl += &format!("vertex {x} {y} {z}\n");
                }
                stl += "endloop\nendfacet\n";
            }
        }
    }
    std::fs::create_dir_all(at.join("b")).unwrap();
    std::fs::write(at.join("b/cube.stl"), stl + "endsolid cube\n").unwrap();
    let scene = DISC
        .replace("plane strain", "3d")
        .replace("cell = \"2 mm\"", "cell = \"4 mm\"")
        .replace(
            "ball = { centre = [0, \"11 mm\"], radius = \"10 mm\" }",
            "surface = { file = \"cube.stl\", unit = \"1 mm\" }",
        )
        .replace("[0, \"-speed\"]", "[0, \"-speed\", 0]");
    std::fs::write(at.join("b/cube.toml"), &scene).unwrap();
    let paces =
        ["--set", "output.histories=1e-5", "--set", "output.pictures=0.5e-3", "--set", "output.frames=1e-3"];
    let run = |out: &str, rest: &[&str]| {
        let output = impactite(&at, &[&["run", "b/cube.toml", "--out", out][..], &paces, rest].concat());
        assert!(output.status.success(), "{}", said(&output));
    };
    run("long", &["--set", "end=\"3 ms\""]);
    run("kept", &["--keep-checkpoint"]);
    // The last step was shortened to reach the end exactly.
    let longer =
        impactite(Path::new("/"), &["resume", at.join("kept").to_str().unwrap(), "--set", "end=\"3 ms\""]);
    assert!(longer.status.success(), "{}", said(&longer));
    assert!(read(at.join("kept/scene.toml")).contains(at.join("b/cube.stl").to_str().unwrap()));
    let rows = |folder: &str| read(at.join(folder).join("measures.csv")).lines().count();
    // The lengthened run has at most one additional row, at its earlier end.
    assert!((0..2).contains(&(rows("kept") - rows("long"))));
    // The scene file in the run folder is valid there.
    let again = impactite(Path::new("/"), &["check", at.join("kept/scene.toml").to_str().unwrap()]);
    assert!(again.status.success(), "{}", said(&again));

    let cut =
        [&["run", "b/cube.toml", "--out", "cut", "--checkpoint", "0", "--no-pictures"][..], &paces].concat();
    let mut first = Command::new(env!("CARGO_BIN_EXE_impactite"))
        .current_dir(&at)
        .args(cut)
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !at.join("cut/run.checkpoint").exists() {
        std::thread::yield_now();
    }
    first.kill().unwrap();
    first.wait().unwrap();
    // An edited scene is not silently replaced.
    let kept = read(at.join("cut/scene.toml"));
    std::fs::write(at.join("cut/scene.toml"), kept.replace("2 m/s", "3 m/s")).unwrap();
    let edited = impactite(&at, &["resume", "cut"]);
    assert!(edited.status.code() == Some(2) && said(&edited).contains("was changed"), "{}", said(&edited));
    assert!(read(at.join("cut/scene.toml")).contains("3 m/s"));
    std::fs::write(at.join("cut/scene.toml"), kept).unwrap();
    let other = impactite(&at, &["resume", "cut", "--set", "parameters.speed=\"3 m/s\""]);
    assert!(said(&other).contains("keeps its scene"), "{}", said(&other));
    let longer =
        impactite(Path::new("/"), &["resume", at.join("cut").to_str().unwrap(), "--set", "end=\"3 ms\""]);
    assert!(longer.status.success(), "{}", said(&longer));
    // A run stopped before its end, then lengthened, equals the longer run to the bit.
    assert_eq!(read(at.join("cut/measures.csv")), read(at.join("long/measures.csv")));
    let ended = impactite(&at, &["resume", "cut"]);
    assert!(ended.status.code() == Some(2) && said(&ended).contains("has ended"), "{}", said(&ended));
    std::fs::remove_dir_all(at).unwrap();
}

/// State after a kill between the last step and the result.
#[test]
fn a_run_with_nothing_left_to_do_ends_as_finished() {
    let at = folder("nothing");
    let run = impactite(&at, &["run", "disc.toml", "--out", "r", "--no-pictures", "--keep-checkpoint"]);
    assert!(run.status.success(), "{}", said(&run));
    let result = read(at.join("r/result.json"));
    std::fs::remove_file(at.join("r/result.json")).unwrap();
    let resumed = impactite(&at, &["resume", "r"]);
    assert!(resumed.status.success(), "{}", said(&resumed));
    let (before, after): (serde_json::Value, serde_json::Value) = (
        serde_json::from_str(&result).unwrap(),
        serde_json::from_str(&read(at.join("r/result.json"))).unwrap(),
    );
    for key in ["steps", "measures", "energy_error", "momentum_error", "simulated_seconds"] {
        assert_eq!(before[key], after[key], "{key}");
    }
    assert!(read(at.join("r/run.json")).contains("\"finished\""));
    std::fs::remove_dir_all(at).unwrap();
}

#[test]
fn a_sweep_goes_on_where_it_was_stopped() {
    let at = folder("sweep");
    let over = [
        "sweep",
        "disc.toml",
        "--out",
        "s",
        "--no-pictures",
        "--no-report",
        "--over",
        "time_step.fixed=10 us,80 us,20 us",
    ];
    let output = impactite(&at, &over);
    assert_eq!(output.status.code(), Some(2), "one of its runs fails: {}", said(&output));
    assert!(said(&output).contains("80 us: failed"), "{}", said(&output));
    let table = read(at.join("s/sweep.csv"));
    let rows: Vec<&str> = table.lines().collect();
    assert!(rows.len() == 4 && rows[2].to_lowercase().contains("nan"), "{table}");
    assert!(read(at.join("s/sweep.json")).contains("disc"), "the reason is kept");
    // State after a kill in the third run.
    let first = std::fs::metadata(at.join("s/001/result.json")).unwrap().modified().unwrap();
    std::fs::remove_file(at.join("s/003/result.json")).unwrap();
    std::fs::remove_file(at.join("s/sweep.csv")).unwrap();
    let again = impactite(Path::new("/"), &["resume", at.join("s").to_str().unwrap()]);
    assert_eq!(again.status.code(), Some(2), "{}", said(&again));
    assert_eq!(
        std::fs::metadata(at.join("s/001/result.json")).unwrap().modified().unwrap(),
        first,
        "it ran again"
    );
    let without_time = |table: &str| {
        table.lines().map(|l| l.rsplit_once(',').unwrap_or_default().0.to_string()).collect::<Vec<_>>()
    };
    assert_eq!(without_time(&read(at.join("s/sweep.csv"))), without_time(&table));
    // A shorter sweep removes the runs of a longer one.
    let shorter = impactite(
        &at,
        &[
            "sweep",
            "disc.toml",
            "--out",
            "s",
            "--no-pictures",
            "--no-report",
            "--over",
            "time_step.fixed=20 us",
        ],
    );
    assert!(shorter.status.success() && !at.join("s/003/run.json").exists(), "{}", said(&shorter));
    std::fs::remove_dir_all(at).unwrap();
}

#[cfg(unix)]
#[test]
fn closed_pipes_full_disks_and_limits_of_files_are_no_panics() {
    let at = folder("pipes");
    let program = env!("CARGO_BIN_EXE_impactite");
    let shell = |line: &str| {
        let line = line.replace("IMPACTITE", program);
        Command::new("bash").current_dir(&at).args(["-c", &line]).output().expect("a shell")
    };
    for line in
        ["IMPACTITE schema | head -c 10", "IMPACTITE list shapes | true", "IMPACTITE check disc.toml | true"]
    {
        let output = shell(&format!("set -o pipefail; {line}"));
        assert!(output.status.success() && output.stderr.is_empty(), "{line}: {}", said(&output));
    }
    let output =
        shell("IMPACTITE run disc.toml --out logged --log-every 0 2>&1 | head -1; exit ${PIPESTATUS[0]}");
    assert!(output.status.success() && at.join("logged/result.json").exists(), "{}", said(&output));
    if Path::new("/dev/zero").exists() {
        let output = shell("IMPACTITE check /dev/zero");
        assert!(
            output.status.code() == Some(2) && said(&output).contains("larger than"),
            "{}",
            said(&output)
        );
    }
    if Path::new("/dev/full").exists() {
        let output = shell("IMPACTITE run disc.toml --out r --no-pictures --no-report --json > /dev/full");
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(
            said(&output).contains("standard output") && !said(&output).contains("panicked"),
            "{}",
            said(&output)
        );
    }
    let output = shell("ulimit -f 8; IMPACTITE run disc.toml --out limited");
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("error:") && !said(&output).contains("panicked"), "{}", said(&output));
    std::fs::remove_dir_all(at).unwrap();
}

#[test]
fn check_looks_ahead() {
    let at = folder("ahead");
    let output = impactite(&at, &["check", "disc.toml"]);
    let text = said(&output);
    assert!(output.status.success(), "{text}");
    for word in [
        "points",
        "kg/m",
        "speed of sound",
        "volume factor",
        "memory:",
        "first step:",
        "limited by",
        "steps: about",
    ] {
        assert!(text.contains(word), "no `{word}` in\n{text}");
    }
    assert!(!at.join("out").exists(), "it writes nothing");
    std::fs::remove_dir_all(at).unwrap();
}
