//! Every case runs at smoke size, ends with the agreed JSON object, and passes its own checks; bad input is
//! refused by name.

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::Value;

/// A folder of its own for each test.
fn folder(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("impactite-{name}-{}", std::process::id()))
}

fn run(program: &str, arguments: &[&str], name: &str) -> Output {
    let out = folder(name);
    let output = Command::new(program)
        .args(arguments)
        .arg("--out")
        .arg(&out)
        .output()
        .unwrap_or_else(|e| panic!("{program} does not start: {e}"));
    assert!(output.status.code().is_some(), "{program} was killed");
    output
}

/// The object on the last line, after a look at its keys.
fn result(output: &Output, case: &str) -> Value {
    let text = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{case} fails:\n{text}\n{errors}");
    let last = text.lines().next_back().expect("some output");
    let value: Value = serde_json::from_str(last).expect("the last line is JSON");
    assert_eq!(value["case"], case);
    assert_eq!(value["resolution"], "smoke");
    assert!(value["settings"].is_object());
    let numbers = [
        "particles",
        "steps",
        "simulated_seconds",
        "wall_seconds",
        "particle_updates_per_second",
        "peak_memory_bytes",
        "energy_error",
        "momentum_error",
    ];
    for key in numbers {
        assert!(value[key].is_number(), "{key} of {last}");
    }
    assert_eq!(value.as_object().map(|o| o.len()), Some(3 + numbers.len() + 1), "no other keys: {last}");
    for check in value["checks"].as_array().expect("checks") {
        for key in ["name", "unit", "source"] {
            assert!(check[key].is_string(), "{key} of {check}");
        }
        assert!(check["value"].is_number(), "{check}");
        assert_ne!(check["pass"], false, "{check}");
        if check["source"].as_str().is_some_and(|s| s.contains("[M]")) {
            assert!(check["pass"].is_null(), "what is from memory never decides: {check}");
        }
    }
    value
}

#[test]
fn taylor_bar() {
    let name = "taylor";
    let output = run(env!("CARGO_BIN_EXE_taylor_bar"), &["--resolution", "smoke", "--json"], name);
    let value = result(&output, "taylor_bar");
    let checks = value["checks"].as_array().expect("checks");
    let gates = checks.iter().filter(|c| c["pass"] == true).count();
    assert!(gates > 4 * 5 + 2 * 3, "{gates} checks decide");
    let out = folder(name);
    for file in [
        "bar_taylor.png",
        "energy_standard.png",
        "profile_taylor.png",
        "profile_3d_taylor.csv",
        "ledger_axisymmetric_standard.csv",
        "sizes_3d_standard.csv",
        "paraview/3d_taylor.pvd",
        "paraview/axisymmetric_standard_000008.vtp",
        "result.json",
    ] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn elastic_bar() {
    let name = "elastic";
    let output = run(env!("CARGO_BIN_EXE_elastic_bar"), &["--resolution", "smoke", "--json"], name);
    let value = result(&output, "elastic_bar");
    let gates = value["checks"].as_array().expect("checks").iter().filter(|c| c["pass"] == true).count();
    // Two fronts (one in two ways), two plateaus, mass, energy, momentum, elements; as printed and ours.
    assert_eq!(gates, 2 * 9);
    let out = folder(name);
    for file in ["bar.png", "history_printed.csv", "paraview/consistent.pvd", "result.json"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn taylor_copper() {
    let name = "copper";
    let output = run(env!("CARGO_BIN_EXE_taylor_copper"), &["--resolution", "smoke", "--json"], name);
    let value = result(&output, "taylor_copper");
    let gates = value["checks"].as_array().expect("checks").iter().filter(|c| c["pass"] == true).count();
    // Length, radius, cover, energy (twice) and momentum, axisymmetric and in plane strain.
    assert_eq!(gates, 2 * 6);
    let out = folder(name);
    for file in ["bars.png", "history_plane strain.csv", "paraview/axisymmetric.pvd", "result.json"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn debris_cloud_2d() {
    let name = "debris";
    let output = run(env!("CARGO_BIN_EXE_debris_cloud_2d"), &["--resolution", "smoke", "--json"], name);
    let value = result(&output, "debris_cloud_2d");
    let gates = value["checks"].as_array().expect("checks").iter().filter(|c| c["pass"] == true).count();
    // The shock's arrival, the front from above and below, mass, momentum, energy, and what revisions add to it.
    assert_eq!(gates, 7);
    let out = folder(name);
    for file in ["cloud.png", "history.csv", "paraview/cloud.pvd", "result.json"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn debris_cloud() {
    let name = "cloud";
    let program = env!("CARGO_BIN_EXE_debris_cloud");
    let value = result(&run(program, &["--resolution", "smoke", "--json"], name), "debris_cloud");
    let checks = value["checks"].as_array().expect("checks");
    // Pressure and density at impact; front, mass, momentum, energy of both clouds.
    assert_eq!(checks.iter().filter(|c| c["pass"] == true).count(), 2 + 2 * 4);
    // Splitting is what keeps the cloud together.
    let alone = |how: &str| {
        let of = |c: &&Value| c["name"] == format!("{how}: cells of the cloud that touch no other");
        checks.iter().find(of).and_then(|c| c["value"].as_f64()).expect("cells")
    };
    assert!(alone("split") < 0.5 * alone("not split"));
    let out = folder(name);
    for file in ["cloud_split.png", "cloud_whole.png", "front.png", "plane.png", "cloud_split.csv"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn pcmm_distortion() {
    let name = "distortion";
    let output = run(env!("CARGO_BIN_EXE_pcmm_distortion"), &["--resolution", "smoke", "--json"], name);
    let value = result(&output, "pcmm_distortion");
    let checks = value["checks"].as_array().expect("checks");
    // Four figures of three scenes, what is asked of each and of the strip, six of the packings; ours alone decide.
    assert_eq!(checks.iter().filter(|c| c["pass"] == true).count(), 3 * 4 + 3 + 2 + 6);
    // What the printed rules fail at: matter lost in shear, strips that part, stress that does not turn, holes.
    let printed = |what: &str| {
        let of =
            |c: &&Value| c["name"].as_str().is_some_and(|n| n.starts_with("printed") && n.contains(what));
        checks.iter().find(of).and_then(|c| c["value"].as_f64()).expect(what)
    };
    assert!(printed("shear flow: mass") < 0.9 && printed("parts") < 2.0);
    assert!(printed("turned") > 0.3 && printed("uncovered") > 0.05 && printed("twice") > 0.05);
    let out = folder(name);
    for file in ["ends.png", "result.json"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn tungsten_bullet() {
    let name = "tungsten";
    let output = run(env!("CARGO_BIN_EXE_tungsten_bullet"), &["--resolution", "smoke", "--json"], name);
    let value = result(&output, "tungsten_bullet");
    let gates = value["checks"].as_array().expect("checks").iter().filter(|c| c["pass"] == true).count();
    // Mass, momentum and energy of two methods in two spaces, revisions of one method; bounds in the plane but the lower one of
    // MPM, which two cells across do not reach; its time to perforation.
    assert_eq!(gates, 4 * 3 + 2 + 3 + 1);
    let out = folder(name);
    for file in ["bullet_plane.png", "bullet_round.png", "tip.png", "history_mpm_round.csv", "result.json"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn validation() {
    let name = "validation";
    let out = folder(name);
    let docs = out.join("page");
    let arguments = ["--resolution", "smoke", "--cases", "elastic_bar", "--docs"];
    let arguments = [&arguments[..], &[docs.to_str().expect("a name")]].concat();
    let output = run(env!("CARGO_BIN_EXE_validation"), &arguments, name);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(docs.join("validation.md")).expect("a page");
    assert!(page.contains("| [elastic_bar](#elastic_bar) | smoke | 18 of 18 | **2** |"), "{page}");
    let table = std::fs::read_to_string(docs.join("validation.csv")).expect("a table");
    assert!(table.lines().skip(1).all(|l| l.starts_with("elastic_bar,smoke,\"")), "{table}");
    // A case that takes too long is on the page, and is a failure.
    let arguments = ["--at-most", "1", "--resolution", "paper", "--cases", "shaken_discs", "--docs"];
    let arguments = [&arguments[..], &[docs.to_str().expect("a name")]].concat();
    let output = run(env!("CARGO_BIN_EXE_validation"), &arguments, name);
    assert!(!output.status.success());
    let page = std::fs::read_to_string(docs.join("validation.md")).expect("a page");
    assert!(page.contains("broke off: not finished after 1 s"), "{page}");
    let output = run(env!("CARGO_BIN_EXE_validation"), &["--cases", "nothing"], name);
    assert!(String::from_utf8_lossy(&output.stderr).contains("case = nothing is not allowed"));
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn taylor_bar_does_not_depend_on_threads() {
    let sizes = |threads: &str| {
        let name = format!("threads-{threads}");
        let arguments = ["--resolution", "smoke", "--json", "--constants", "standard", "--model", "3d"];
        let more = ["--threads", threads, "--frames", "0", "--cells", "4"];
        let output = run(env!("CARGO_BIN_EXE_taylor_bar"), &[&arguments[..], &more].concat(), &name);
        std::fs::remove_dir_all(folder(&name)).expect("removed");
        let text = String::from_utf8_lossy(&output.stdout).to_string();
        let value: Value = serde_json::from_str(text.lines().next_back().expect("output")).expect("JSON");
        value["checks"].as_array().expect("checks").iter().map(|c| c["value"].to_string()).collect::<Vec<_>>()
    };
    assert_eq!(sizes("1"), sizes("2"));
}

#[test]
fn taylor_bar_convergence() {
    let name = "convergence";
    let arguments = [
        "--resolution",
        "smoke",
        "--json",
        "--convergence",
        "--constants",
        "taylor",
        "--model",
        "axisymmetric",
    ];
    result(&run(env!("CARGO_BIN_EXE_taylor_bar"), &arguments, name), "taylor_bar");
    let table = std::fs::read_to_string(folder(name).join("convergence_taylor.csv")).expect("a table");
    assert_eq!(table.lines().count(), 1 + 3 * 3, "three methods at three spacings:\n{table}");
    assert!(folder(name).join("convergence_taylor.png").is_file());
    std::fs::remove_dir_all(folder(name)).expect("removed");
}

#[test]
fn tnt_slab() {
    let name = "tnt";
    let output = run(env!("CARGO_BIN_EXE_tnt_slab"), &["--resolution", "smoke", "--json"], name);
    let value = result(&output, "tnt_slab");
    let gates = value["checks"].as_array().expect("checks").iter().filter(|c| c["pass"] == true).count();
    assert_eq!(gates, 3 * 3 + 1 + 2 + 2, "checks decide");
    for file in
        ["taylor_wave.png", "gauges.png", "gauges.csv", "profile.csv", "ledger.csv", "paraview/slab.pvd"]
    {
        assert!(folder(name).join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(folder(name)).expect("removed");
}

#[test]
fn tnt_cased() {
    let name = "cased";
    let program = env!("CARGO_BIN_EXE_tnt_cased");
    let value = result(&run(program, &["--resolution", "smoke", "--json"], name), "tnt_cased");
    let checks = value["checks"].as_array().expect("checks");
    // Speed of the cylinder's case twice, and that it is round; masses, energy and momentum of both forms.
    assert_eq!(checks.iter().filter(|c| c["pass"] == true).count(), 3 + 2 * 4);
    let out = folder(name);
    for file in ["section_cylinder.png", "section_cube.png", "speed_cylinder.png", "case_cube.csv"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn plate_impact() {
    let name = "plates";
    let output = run(env!("CARGO_BIN_EXE_plate_impact"), &["--resolution", "smoke", "--json"], name);
    let value = result(&output, "plate_impact");
    let gates = value["checks"].as_array().expect("checks").iter().filter(|c| c["pass"] == true).count();
    // Lines and states but for the energy of seven metals, the shock on three grids, spall on three, conservation.
    assert!(gates >= 7 * 5 + 3 * 2 + 1 + 3 * 4 + 2, "{gates} checks decide");
    let out = folder(name);
    for file in [
        "lines.png",
        "shock.png",
        "spall.png",
        "line_lead.csv",
        "profile_150.csv",
        "surface_100.csv",
        "ledger_spall_100.csv",
        "paraview/spall_25.pvd",
        "result.json",
    ] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn ring_collision() {
    let name = "rings";
    let output = run(env!("CARGO_BIN_EXE_ring_collision"), &["--resolution", "smoke", "--json"], name);
    let value = result(&output, "ring_collision");
    let gates = value["checks"].as_array().expect("checks").iter().filter(|c| c["pass"] == true).count();
    assert!(gates >= 4 * 2 + 2, "{gates} checks decide");
    let out = folder(name);
    for file in [
        "closest_approach.png",
        "contact.png",
        "energy_error.csv",
        "energy_error.png",
        "force.png",
        "history_cpgimp_musl_distance_2000um.csv",
        "paraview/cpgimp_musl_distance_2000um.pvd",
        "rings.png",
    ] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn bouncing_blocks() {
    let name = "blocks";
    let output = run(env!("CARGO_BIN_EXE_bouncing_blocks"), &["--resolution", "smoke", "--json"], name);
    let value = result(&output, "bouncing_blocks");
    let checks = value["checks"].as_array().expect("checks");
    let gates = checks.iter().filter(|c| c["pass"] == true).count();
    // Bars, joint, discs, incline, balls and cylinders.
    assert_eq!(gates, 11 + 3 + 5 + 4 + 6);
    let out = folder(name);
    for file in [
        "discs.png",
        "discs_1.csv",
        "discs_energy.png",
        "hertz.png",
        "hertz_balls.csv",
        "impact.png",
        "impact_equal_bars.csv",
        "incline.png",
        "paraview/discs_1.pvd",
        "wave.png",
    ] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn rolling_cylinder() {
    let name = "rolling";
    let output = run(env!("CARGO_BIN_EXE_rolling_cylinder"), &["--resolution", "smoke", "--json"], name);
    let value = result(&output, "rolling_cylinder");
    let checks = value["checks"].as_array().expect("checks");
    let gates = checks.iter().filter(|c| c["pass"] == true).count();
    // Two of the way, gap, overlap and momentum of two coefficients in two and three dimensions; spread over the spacings.
    assert_eq!(gates, 4 * 5 + 2);
    let out = folder(name);
    for file in [
        "cylinder_2d.png",
        "cylinder_3d.png",
        "histories_3d.png",
        "spacings.png",
        "spacings.csv",
        "cylinder_2d_local_030_12.csv",
        "cylinder_3d_local_060_8.csv",
        "paraview/3d_local_060_8.pvd",
        "result.json",
    ] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn oblique_penetration() {
    let name = "oblique";
    let program = env!("CARGO_BIN_EXE_oblique_penetration");
    let value = result(&run(program, &["--resolution", "smoke", "--json"], name), "oblique_penetration");
    let checks = value["checks"].as_array().expect("checks");
    // Energy, momentum and interpenetration; the speed of so coarse a rod is shown only.
    assert!(checks.iter().filter(|c| c["pass"] == true).count() >= 3);
    let out = folder(name);
    for file in ["cuts.png", "speed.png", "rod_575_30deg_8.csv", "result.json"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn concrete_perforation() {
    let name = "concrete";
    let program = env!("CARGO_BIN_EXE_concrete_perforation");
    let value = result(&run(program, &["--resolution", "smoke", "--json"], name), "concrete_perforation");
    let checks = value["checks"].as_array().expect("checks");
    // A faster rod comes out faster; energy, momentum, interpenetration. The experiment is from memory.
    assert_eq!(checks.iter().filter(|c| c["pass"] == true).count(), 4);
    let out = folder(name);
    for file in ["curve.png", "speed.png", "cuts.png", "cracks.png", "curve.csv", "rod_quarter_1058_12.csv"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn granular_column() {
    let name = "granular";
    let program = env!("CARGO_BIN_EXE_granular_column");
    let value = result(&run(program, &["--resolution", "smoke", "--json"], name), "granular_column");
    let checks = value["checks"].as_array().expect("checks");
    // Run-out of four columns of bars from below, of three of sand from both sides; area, rest, energy, momentum.
    assert_eq!(checks.iter().filter(|c| c["pass"] == true).count(), 4 + 3 * 2 + 4);
    let out = folder(name);
    for file in ["column.png", "deposits.png", "fronts.png", "front_0.5_19.8deg_20.csv"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn slope_failure() {
    let name = "slope";
    let program = env!("CARGO_BIN_EXE_slope_failure");
    let value = result(&run(program, &["--resolution", "smoke", "--json"], name), "slope_failure");
    let checks = value["checks"].as_array().expect("checks");
    // Area, momentum, rest; the strength at failure from below.
    assert!(checks.iter().filter(|c| c["pass"] == true).count() >= 3);
    let out = folder(name);
    for file in ["slope.png", "slip.png", "run_out.png", "slip_2500mm.csv", "history_2500mm.csv"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn pressed_balls() {
    let name = "balls";
    let program = env!("CARGO_BIN_EXE_pressed_balls");
    let value = result(&run(program, &["--resolution", "smoke", "--json"], name), "pressed_balls");
    let checks = value["checks"].as_array().expect("checks");
    assert_eq!(checks.iter().filter(|c| c["pass"] == true).count(), 5);
    let out = folder(name);
    for file in ["waves.png", "reaction.png", "reaction.csv", "paraview/balls.pvd", "result.json"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn shaken_discs() {
    let name = "discs";
    let program = env!("CARGO_BIN_EXE_shaken_discs");
    let value = result(&run(program, &["--resolution", "smoke", "--json"], name), "shaken_discs");
    let checks = value["checks"].as_array().expect("checks");
    assert_eq!(checks.iter().filter(|c| c["pass"] == true).count(), 4);
    let out = folder(name);
    for file in ["discs.png", "histories.png", "discs.csv", "ledger.csv", "paraview/discs.pvd", "result.json"]
    {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
}

#[test]
fn throughput() {
    let name = "throughput";
    let output = run(env!("CARGO_BIN_EXE_throughput"), &["--resolution", "smoke", "--json"], name);
    let value = result(&output, "throughput");
    let runs = value["settings"]["runs"].as_array().expect("runs");
    assert_eq!(runs.len(), 3 * 2);
    for pair in runs.chunks(2) {
        assert_eq!(pair[0]["checksum"], pair[1]["checksum"], "one and two threads differ");
    }
    std::fs::remove_dir_all(folder(name)).expect("removed");
}

#[test]
fn bad_input_is_refused_by_name() {
    let said = |program: &str, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).output().expect("it starts");
        assert!(!output.status.success(), "{arguments:?} was accepted");
        String::from_utf8_lossy(&output.stderr).to_string()
    };
    let (bar, speed) = (env!("CARGO_BIN_EXE_taylor_bar"), env!("CARGO_BIN_EXE_throughput"));
    let cells = said(bar, &["--cells", "0"]);
    assert!(cells.contains("'0' for '--cells <N>'") && cells.contains("2..=200"), "{cells}");
    let method = said(bar, &["--method", "magic"]);
    assert!(method.contains("'magic'") && method.contains("gimp-usl"), "{method}");
    let spacings = said(env!("CARGO_BIN_EXE_elastic_bar"), &["--cells", "1"]);
    assert!(spacings.contains("'1' for '--cells <N>'") && spacings.contains("2..=100"), "{spacings}");
    let threads = said(bar, &["--threads", "0"]);
    assert!(threads.contains("'0' for '--threads <N>'") && threads.contains("1..=1024"), "{threads}");
    let rolling = env!("CARGO_BIN_EXE_rolling_cylinder");
    let angle = said(rolling, &["--angle", "90"]);
    assert!(angle.contains("'90' for '--angle <DEGREES>'") && angle.contains("from 1 to 80"), "{angle}");
    let oblique = said(env!("CARGO_BIN_EXE_oblique_penetration"), &["--angle", "46"]);
    assert!(
        oblique.contains("'46' for '--angle <DEGREES>'") && oblique.contains("from 0 to 45"),
        "{oblique}"
    );
    let concrete = said(env!("CARGO_BIN_EXE_concrete_perforation"), &["--speed", "606,20"]);
    assert!(concrete.contains("'20' for '--speed <M/S,M/S>'"), "{concrete}");
    let column = said(env!("CARGO_BIN_EXE_granular_column"), &["--friction", "60"]);
    assert!(column.contains("'60' for '--friction <DEGREES>'"), "{column}");
    let slope = said(env!("CARGO_BIN_EXE_slope_failure"), &["--spacing", "9"]);
    assert!(slope.contains("'9' for '--spacing <M,M>'"), "{slope}");
    let friction = said(rolling, &["--friction", "0.3,-1"]);
    assert!(friction.contains("'-1' for '--friction <MU>'"), "{friction}");
    let folder = said(bar, &["--resolution", "smoke", "--out", "/dev/null/here"]);
    assert!(folder.contains("/dev/null/here"), "{folder}");
    let steps = said(speed, &["--steps", "0"]);
    assert!(steps.contains("'0' for '--steps <N>'"), "{steps}");
    let against = said(speed, &["--resolution", "smoke", "--against", "/nowhere/yardstick"]);
    assert!(against.contains("/nowhere/yardstick"), "{against}");
}
