//! Program runs from the command line.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Small scene: a rubber disc falls on a floor.
const DISC: &str = r#"
title = "Disc <on> a floor"
space = "plane strain"
end = "2 ms"
method.mpm = { cell = "2 mm" }
materials.rubber.neo_hookean = { density = "1 g/cm^3", young = "1 MPa", poisson = 0.4 }
conditions = [{ wall = { axis = "y", at = 0 } }]

[parameters]
radius = "10 mm"
speed = "2 m/s"

[bodies.disc]
material = "rubber"
shape.ball = { centre = [0, "radius + 1 mm"], radius = "radius" }
velocity = [0, "-speed"]

[measures]
height = { centre = { body = "disc", axis = "y" } }
velocity = { mean_velocity = { body = "disc", axis = "y" } }

[[checks]]
measure = "height"
reference = "9.52 mm"
tolerance = 0.02
source = "this program: a check to be printed, not a test of physics"
"#;

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_impactite"))
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("impactite-program-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn scene(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("scene.toml");
    std::fs::write(&path, text).expect("a file");
    path
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).to_string() + &String::from_utf8_lossy(&output.stderr)
}

fn run(arguments: &[&str]) -> Output {
    program().args(arguments).output().expect("the program")
}

#[test]
fn a_run_leaves_its_page_its_numbers_and_the_same_bits_for_any_number_of_threads() {
    let folder = folder("run");
    let path = scene(&folder, DISC);
    let mut results = Vec::new();
    for threads in ["1", "2"] {
        let out = folder.join(threads);
        let output = run(&[
            "run",
            path.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
            "--threads",
            threads,
            "--json",
            "--log-every",
            "0",
        ]);
        assert!(output.status.success(), "{}", said(&output));
        // Without a terminal the log contains lines of progress.
        let log = String::from_utf8_lossy(&output.stderr);
        assert!(log.contains("end expected") && log.contains("energy error"), "{log}");
        let text = String::from_utf8_lossy(&output.stdout).to_string();
        let last: serde_json::Value =
            serde_json::from_str(text.lines().last().unwrap()).expect("JSON on the last line");
        assert_eq!((&last["met"], &last["missed"]), (&1.into(), &0.into()));
        // Energy error of USL at a wall: 8 % of the energy of a disc of ten cells (book, "Walls and floors").
        assert!(last["energy_error"].as_f64().unwrap().abs() < 0.1, "{last}");
        for file in
            ["report.html", "run.json", "result.json", "measures.csv", "scene.toml", "paraview/scene.pvd"]
        {
            assert!(out.join(file).exists(), "{file}");
        }
        let page = std::fs::read_to_string(out.join("report.html")).unwrap();
        assert!(page.contains("Disc &lt;on&gt; a floor") && !page.contains("Disc <on>"));
        results.push((last["measures"].clone(), std::fs::read(out.join("measures.csv")).unwrap()));
    }
    assert_eq!(results[0], results[1]);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_run_has_no_more_threads_than_processors() {
    let folder = folder("threads");
    let path = scene(&folder, DISC);
    let all = std::thread::available_parallelism().expect("a number of processors").get();
    let out = folder.join("out");
    let arguments = ["run", path.to_str().unwrap(), "--out", out.to_str().unwrap(), "--no-pictures"];
    let asked = [&arguments[..], &["--threads", "1024"]].concat();
    let check = |output: Output, processors: usize| {
        let text = said(&output);
        assert!(output.status.success(), "{text}");
        assert!(text.contains(&format!("{processors} of 1024 threads")), "{text}");
        let run: serde_json::Value =
            serde_json::from_slice(&std::fs::read(out.join("run.json")).unwrap()).expect("run.json");
        assert_eq!(run["machine"]["threads"], serde_json::json!(processors));
    };
    check(run(&asked), all);
    // The same on one processor, where the system has `taskset` and lends the first processor to this process.
    let alone = |of: &[&str]| Command::new("taskset").args(["-c", "0"]).args(of).output();
    if alone(&["true"]).is_ok_and(|output| output.status.success()) {
        let output = alone(&[&[env!("CARGO_BIN_EXE_impactite")], &asked[..]].concat());
        check(output.expect("the program"), 1);
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_is_wrong_is_told_with_its_place() {
    let folder = folder("wrong");
    let cases: &[(&str, &str, &[&str])] = &[
        ("\"-speed\"", "\"-speeed\"", &["bodies.disc.velocity[1]", "speeed"]),
        ("radius = \"radius\"", "radius = \"-radius\"", &["bodies.disc", "radius", "positive"]),
        ("radius = \"radius\"", "radios = \"radius\"", &["radios", "did you mean `radius`?"]),
        ("\"rubber\"", "\"rubbr\"", &["bodies.disc.material", "did you mean `rubber`?"]),
        ("axis = \"y\", at", "axis = \"r\", at", &["conditions[0].wall.axis", "the axes are x, y"]),
        ("\"1 MPa\"", "\"1 mm\"", &["materials.rubber", "pressure", "1 mm"]),
        ("poisson = 0.4", "poisson = 0.6", &["materials.rubber.neo_hookean", "0.6"]),
        ("cell = \"2 mm\"", "cell = 0", &["method.mpm.cell", "0"]),
        ("measure = \"height\"", "measure = \"heigt\"", &["checks[0].measure", "did you mean `height`?"]),
    ];
    for (from, to, words) in cases {
        assert!(DISC.contains(from), "{from}");
        let path = scene(&folder, &DISC.replacen(from, to, 1));
        let output = run(&["check", path.to_str().unwrap()]);
        let text = said(&output);
        assert!(!output.status.success(), "{to}: {text}");
        for word in *words {
            assert!(text.contains(word), "{to}: no `{word}` in\n{text}");
        }
        assert!(text.contains("scene.toml:") && text.contains("^"), "{to}: no place in\n{text}");
    }
    for (arguments, word) in [
        (vec!["run", "nowhere.toml"], "nowhere.toml"),
        (vec!["new", "nothing"], "taylor_bar"),
        (vec!["report", "nowhere"], "nowhere"),
        (vec!["resume", "nowhere"], "nowhere"),
    ] {
        let output = run(&arguments);
        assert!(!output.status.success() && said(&output).contains(word), "{arguments:?}: {}", said(&output));
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn frames_have_the_fields_and_the_format_that_the_file_says() {
    let folder = folder("frames");
    let path = scene(&folder, DISC);
    let out = folder.join("out");
    let frames = |set: &[&str]| {
        let mut all = vec!["run", path.to_str().unwrap(), "--out", out.to_str().unwrap()];
        set.iter().for_each(|assignment| all.extend(["--set", assignment]));
        let _ = std::fs::remove_dir_all(&out);
        run(&all)
    };
    for (fields, velocity, displacement) in
        [(None, true, true), (Some("[\"velocity\"]"), true, false), (Some("[\"displacement\"]"), false, true)]
    {
        let set = fields.map(|fields| format!("output.fields={fields}"));
        let output = frames(set.as_deref().as_slice());
        assert!(output.status.success(), "{}", said(&output));
        let last = std::fs::read(out.join("paraview/scene_000008.vtp")).expect("the last frame");
        let has = |name: &str| {
            let name = format!("Name=\"{name}\"");
            last.windows(name.len()).any(|w| w == name.as_bytes())
        };
        assert_eq!((has("velocity"), has("displacement")), (velocity, displacement), "{fields:?}");
    }
    let output = frames(&["output.format=\"vtkhdf\""]);
    let text = said(&output);
    if cfg!(feature = "hdf5") {
        assert!(output.status.success(), "{text}");
        let list = std::fs::read_to_string(out.join("paraview/scene.vtkhdf.series")).expect("the list");
        assert!(
            list.contains("\"scene_000008.vtkhdf\"") && out.join("paraview/scene_000008.vtkhdf").is_file()
        );
        assert!(!out.join("paraview/scene.pvd").exists());
    } else {
        assert!(!output.status.success() && !out.exists(), "{text}");
        assert!(text.contains("output.format: `vtkhdf`") && text.contains("feature `hdf5`"), "{text}");
    }
    let output = frames(&["output.format=\"vtk\""]);
    assert!(said(&output).contains("expected `xml` or `vtkhdf`"), "{}", said(&output));
    std::fs::remove_dir_all(folder).unwrap();
}

/// Invalid pictures and frames are refused before a run, with the key.
#[test]
fn keys_of_output_are_checked() {
    let folder = folder("output");
    let path = scene(
        &folder,
        &DISC.replace("[parameters]", "[output]\ncolour = { field = \"speed\" }\n\n[parameters]"),
    );
    let path = path.to_str().unwrap();
    let wrong: &[(&str, &[&str])] = &[
        ("output.colour.field=von_misses", &["output.colour.field", "did you mean `von_mises`?"]),
        ("output.colour.field=plastic_strain", &["output.colour.field", "velocity_x", "stress_xy"]),
        ("output.colour.range=[2, 1]", &["output.colour.range", "[2, 1]"]),
        ("output.fields=[\"displacement\", \"presure\"]", &["output.fields[1]", "did you mean `pressure`?"]),
        ("output.pictures=0", &["output.pictures", "0 s", "positive"]),
        ("output.frames=\"-1 us\"", &["output.frames", "positive"]),
        ("output.histories=\"-3 ms\"", &["output.histories", "positive"]),
        ("output.mirror=[\"x\"]", &["output.mirror[0]", "no plane of symmetry"]),
        ("output.mirror=1", &["output.mirror", "true, false, or a list of axes"]),
        ("output.window={ from = [0, 0], to = [\"1 mm\", 0] }", &["output.window.to[1]", "above `from`"]),
        ("output.window={ from = [0, 0, 0], to = [1, 1] }", &["output.window.from", "3 components"]),
        ("output.seen_from=[1, 0, 0]", &["output.seen_from", "`3d`"]),
    ];
    for (set, words) in wrong {
        let output = run(&["check", path, "--set", set]);
        let text = said(&output);
        assert!(!output.status.success(), "{set}: {text}");
        for word in *words {
            assert!(text.contains(word), "{set}: no `{word}` in\n{text}");
        }
    }
    for set in [
        "output.colour.field=stress_xx",
        "output.colour.field=velocity",
        "output.fields=[\"stress\", \"displacement\"]",
        "output.mirror=false",
        "output.window={ from = [0, 0], to = [\"1 mm\", \"1 mm\"] }",
    ] {
        let output = run(&["check", path, "--set", set]);
        assert!(output.status.success(), "{set}: {}", said(&output));
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// Planes of symmetry mirror pictures at an axis with one plane, or as selected in the file.
#[test]
fn pictures_are_mirrored_as_the_file_says() {
    use impactite_cli::pictures::Draws;
    use impactite_input::Source;
    let two = r#"
        title = "A slope between two rollers"
        space = "plane strain"
        end = "1 ms"
        method.mpm = { cell = "1 m" }
        materials.rock.elastic = { density = "2 g/cm^3", young = "1 MPa", poisson = 0.3 }
        bodies.slope = { material = "rock", shape.box = { from = [0, 0], to = [25, 10] } }
        conditions = [
            { symmetry = { axis = "x", at = 0 } },
            { symmetry = { axis = "x", at = 25, side = "below" } },
            { symmetry = { axis = "y", at = 0 } },
        ]
        [output]
        mirror = true
    "#;
    for (mirror, expected) in
        [("true", vec![(1, 0.0)]), ("false", vec![]), ("[\"x\"]", vec![(0, 0.0), (0, 25.0)])]
    {
        let text = two.replace("mirror = true", &format!("mirror = {mirror}"));
        let scene = Source::new("slope.toml", text).parse().expect("a scene");
        let mirrors: Vec<_> = Draws::new(&scene).mirrors().iter().map(|m| (m.axis, m.at)).collect();
        assert_eq!(mirrors, expected, "{mirror}");
    }
}

/// A run interrupted by a signal or killed, then resumed, equals an uninterrupted run to the bit.
#[cfg(unix)]
#[test]
fn interrupted_or_killed_it_goes_on_to_the_same_bits() {
    let folder = folder("resume");
    // The tolerance is opened, since the check is for coarser cells.
    let fine = ["--set", "method.mpm.cell=\"0.25 mm\"", "--set", "checks[0].tolerance=1", "--no-pictures"];
    breaks_off(&folder, &scene(&folder, DISC), &fine);
}

/// Resumption with contact, perforated plates and pictures. Tolerances are opened, since the checks are for finer cells and the whole
/// flight.
#[cfg(unix)]
#[test]
fn a_perforation_that_was_broken_off_goes_on_to_the_same_bits() {
    let folder = folder("perforation");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/oblique_penetration.toml");
    let coarse =
        ["cells=4", "half_width=\"30 mm\"", "speed=\"900 m/s\""].map(|set| format!("parameters.{set}"));
    let mut options =
        vec!["--set", "end=\"60 us\"", "--set", "checks[0].tolerance=10", "--set", "checks[1].tolerance=10"];
    // Window and colour range grow before and after the run is resumed.
    options.extend(["--set", "output.colour={ field = \"von_mises\" }"]);
    coarse.iter().for_each(|set| options.extend(["--set", set]));
    breaks_off(&folder, &path, &options);
}

#[cfg(unix)]
fn breaks_off(folder: &Path, path: &Path, options: &[&str]) {
    let pictures = !options.contains(&"--no-pictures");
    let start = |out: &Path| {
        let mut command = program();
        command
            .args(["run", path.to_str().unwrap(), "--out", out.to_str().unwrap(), "--checkpoint", "0.05"])
            .args(options);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command
    };
    let whole = folder.join("whole");
    assert!(start(&whole).status().expect("the program").success());
    for signal in ["INT", "KILL"] {
        let out = folder.join(signal);
        let mut child = start(&out).spawn().expect("the program");
        let begun = Instant::now();
        while !out.join("run.checkpoint").exists() {
            assert!(begun.elapsed() < Duration::from_secs(60), "no checkpoint");
            std::thread::sleep(Duration::from_millis(5));
        }
        let kill =
            Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status().expect("kill");
        assert!(kill.success());
        let status = child.wait().expect("the program's end");
        assert!(!status.success(), "{signal}: it was over before");
        if signal == "INT" {
            assert_eq!(status.code(), Some(130));
            let page = std::fs::read_to_string(out.join("report.html")).expect("a page of what there is");
            assert!(page.contains("asked to stop"));
        }
        let output = run(&["resume", out.to_str().unwrap()]);
        assert!(output.status.success(), "{signal}: {}", said(&output));
        let same =
            |file: &str| std::fs::read(whole.join(file)).unwrap() == std::fs::read(out.join(file)).unwrap();
        assert!(same("measures.csv"), "{signal}: another history");
        if pictures {
            let all = (0..=40).map(|n| format!("pictures/scene_{n:06}.png"));
            for file in all.chain(["paraview/scene_000008.vtp".into()]) {
                assert!(same(&file), "{signal}: another {file}");
            }
        }
        let numbers = |of: &Path| -> serde_json::Value {
            let text = std::fs::read_to_string(of.join("result.json")).unwrap();
            let all: serde_json::Value = serde_json::from_str(&text).unwrap();
            serde_json::json!([all["measures"], all["steps"], all["energy_error"], all["momentum_error"]])
        };
        assert_eq!(numbers(&whole), numbers(&out), "{signal}");
        assert!(!out.join("run.checkpoint").exists());
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_sweep_has_a_table_and_a_chart() {
    let folder = folder("sweep");
    let path = scene(&folder, DISC);
    let out = folder.join("out");
    let output = run(&[
        "sweep",
        path.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
        "--over",
        "parameters.speed=1 m/s,2 m/s,3 m/s",
        "--no-pictures",
    ]);
    assert!(output.status.success(), "{}", said(&output));
    let table = std::fs::read_to_string(out.join("sweep.csv")).unwrap();
    assert!(table.starts_with("parameters.speed [m/s],"), "{table}");
    assert_eq!(table.lines().count(), 4, "{table}");
    let rows: Vec<Vec<f64>> =
        table.lines().skip(1).map(|l| l.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    assert_eq!(rows.iter().map(|r| r[0]).collect::<Vec<_>>(), [1.0, 2.0, 3.0]);
    // The fastest disc rebounds with the highest velocity.
    assert!(rows[0][2] < rows[2][2], "{table}");
    assert!(out.join("sweep.png").exists() && out.join("001/report.html").exists());
    let output = run(&["sweep", path.to_str().unwrap(), "--over", "parameters.sped=1,2"]);
    assert!(!output.status.success() && said(&output).contains("did you mean `speed`?"), "{}", said(&output));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn lists_schema_and_templates() {
    // Without a topic, `list` prints the topics, each of which is a list.
    let topics = said(&run(&["list"]));
    let topics: Vec<&str> =
        topics.lines().skip(1).filter_map(|line| line.split_whitespace().next()).collect();
    assert!(topics.len() >= 14, "{topics:?}");
    for topic in topics {
        let output = run(&["list", topic]);
        assert!(output.status.success() && output.stdout.len() > 100, "{topic}: {}", said(&output));
    }
    let keys = said(&run(&["list", "keys", "bodies.plate.rigid"]));
    assert!(keys.contains("bodies.NAME.rigid.density") && keys.contains("7850 kg/m^3"), "{keys}");
    for (arguments, word) in [
        (vec!["list", "keys", "bodys"], "no key begins with `bodys`"),
        (vec!["list", "laws", "--markdown"], "`keys`"),
        (vec!["list", "laws", "strength"], "prefix"),
    ] {
        let output = run(&arguments);
        assert!(!output.status.success() && said(&output).contains(word), "{arguments:?}: {}", said(&output));
    }
    let schema: serde_json::Value = serde_json::from_slice(&run(&["schema"]).stdout).expect("JSON");
    assert!(schema["properties"]["bodies"].is_object());
    let folder = folder("new");
    let path = folder.join("bar.toml");
    let made = run(&["new", "taylor_bar", path.to_str().unwrap()]);
    assert!(made.status.success(), "{}", said(&made));
    let checked = run(&["check", path.to_str().unwrap()]);
    assert!(checked.status.success(), "{}", said(&checked));
    assert!(!run(&["new", "taylor_bar", path.to_str().unwrap()]).status.success(), "it writes over a file");
    // Template with a further file, which is not overwritten either.
    let path = folder.join("beam.toml");
    std::fs::write(folder.join("beam.msh"), "mine").unwrap();
    let refused = run(&["new", "fem_mesh_file", path.to_str().unwrap()]);
    assert!(!refused.status.success() && said(&refused).contains("beam.msh") && !path.exists());
    std::fs::remove_file(folder.join("beam.msh")).unwrap();
    let made = run(&["new", "fem_mesh_file", path.to_str().unwrap()]);
    assert!(made.status.success() && said(&made).contains("beam.msh"), "{}", said(&made));
    assert!(run(&["check", path.to_str().unwrap()]).status.success());
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn values_are_lists_or_ranges() {
    let parse = |s: &str| s.parse::<impactite_cli::sweep::Values>();
    assert_eq!(parse("a.b=1,2 m").unwrap().list, ["1", "2 m"]);
    assert_eq!(parse("speed=100..200/3").unwrap().list, ["100", "150", "200"]);
    assert_eq!(parse("speed=1.5..2/2 km/s").unwrap().list, ["1.5 km/s", "2 km/s"]);
    for bad in [
        "speed",
        "=1,2",
        "speed=",
        "speed=1,,2",
        "speed=1..x/3",
        "speed=1..2/1",
        "speed=1..2",
        "speed=1 m..2 m/3",
    ] {
        assert!(parse(bad).is_err(), "{bad}");
    }
}
