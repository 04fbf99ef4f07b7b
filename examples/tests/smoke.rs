//! Smoke tests of all cases: each runs at smoke size, ends with the specified JSON object, and fails no check but known
//! misses. Invalid input is refused by name.

use std::io::Write;
use std::ops::{RangeBounds, RangeInclusive};
use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::Value;

/// Return a separate folder for each test.
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

/// Parse the object on the last line and check its keys.
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
        "met",
        "missed",
        "shown",
        "energy_error",
        "momentum_error",
    ];
    for key in numbers {
        assert!(value[key].is_number(), "{key} of {last}");
    }
    assert_eq!(value.as_object().map(|o| o.len()), Some(3 + numbers.len() + 2), "no other keys: {last}");
    let checks = value["checks"].as_array().expect("checks");
    for check in checks {
        for key in ["name", "unit", "source"] {
            assert!(check[key].is_string(), "{key} of {check}");
        }
        assert!(check["value"].is_number(), "{check}");
        let memory = check["source"].as_str().is_some_and(|s| s.contains("[M]"));
        let judged = check["reference"].is_number() && !memory;
        assert_eq!(check["pass"].is_boolean(), judged, "all with a reference, and none from memory: {check}");
        if check["pass"] == false {
            assert!(check["known"].is_string(), "missed and not declared: {check}");
        }
        // A known miss that passes does not fail the test, since rounding of another processor may decide; it is reported
        // here and in the table.
        if check["pass"] == true && check["known"].is_string() {
            // Write past the output capture, which hides the output of passing tests.
            let _ = writeln!(std::io::stderr(), "{case}: met, though declared as missed: {check}");
        }
    }
    let count = |pass: Value| checks.iter().filter(|c| c["pass"] == pass).count();
    for (key, pass) in [("met", true.into()), ("missed", false.into()), ("shown", Value::Null)] {
        assert_eq!(value[key], count(pass), "{key}");
    }
    let order = checks.iter().map(|c| c["pass"].as_bool().map_or(2, u8::from));
    assert!(order.is_sorted(), "missed ones first, then met ones, then shown ones");
    for row in value["not_judged"].as_array().expect("rows that are not judged") {
        assert!(row["name"].is_string() && row["reason"].is_string(), "{row}");
    }
    let counts = format!(
        "{} of {} met, {} missed",
        count(true.into()),
        count(true.into()) + count(false.into()),
        count(false.into())
    );
    assert!(text.contains(&counts), "{counts} is not in\n{text}");
    value
}

/// Run a case at smoke size; check the number of judged rows and the files written.
macro_rules! smoke {
    ($case:ident, $judged:expr, [$($file:expr),*]) => {
        passes(env!(concat!("CARGO_BIN_EXE_", stringify!($case))), stringify!($case), $judged, &[$($file),*])
    };
}

fn passes(program: &str, case: &str, expected: impl RangeBounds<usize>, files: &[&str]) -> Value {
    let value = result(&run(program, &["--resolution", "smoke", "--json"], case), case);
    let checks = value["checks"].as_array().expect("checks");
    let judged = checks.iter().filter(|c| c["pass"].is_boolean()).count();
    assert!(expected.contains(&judged), "{judged} rows are judged");
    let out = folder(case);
    for file in files.iter().chain(&["result.json"]) {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    std::fs::remove_dir_all(out).expect("removed");
    value
}

/// Return the range of this number alone.
fn only(gates: usize) -> RangeInclusive<usize> {
    gates..=gates
}

/// Return the value of the first check whose name matches.
fn of(value: &Value, named: impl Fn(&str) -> bool) -> f64 {
    let checks = value["checks"].as_array().expect("checks");
    let found = checks.iter().find(|c| c["name"].as_str().is_some_and(&named));
    found.and_then(|c| c["value"].as_f64()).expect("such a check")
}

#[test]
fn taylor_bar() {
    smoke!(
        taylor_bar,
        4 * 5 + 2 * 3 + 1..,
        [
            "bar_taylor.png",
            "energy_standard.png",
            "profile_taylor.png",
            "profile_3d_taylor.csv",
            "ledger_axisymmetric_standard.csv",
            "sizes_3d_standard.csv",
            "paraview/3d_taylor.pvd",
            "paraview/axisymmetric_standard_000008.vtp"
        ]
    );
}

#[test]
fn elastic_bar() {
    // Two fronts (one in three ways, one in two), two plateaus, rebound, mass, energy, momentum, elements; original method and ours.
    smoke!(elastic_bar, only(2 * 12), ["bar.png", "history_printed.csv", "paraview/consistent.pvd"]);
}

#[test]
fn taylor_copper() {
    // Length, radius, cover, energy (twice) and momentum, axisymmetric and in plane strain; the first four of three runs
    // with defects, except one radius; length and radius by material points in two spaces; these with hourglass energy,
    // energy and momentum by finite elements; these with energy, momentum and a bound of the radius by fragile points.
    smoke!(
        taylor_copper,
        only(2 * 6 + 3 * 4 - 1 + 2 * 2 + 2 * 5 + 5),
        [
            "bars.png",
            "history_plane strain.csv",
            "history_fem_axisymmetric.csv",
            "paraview/axisymmetric.pvd",
            "paraview/fem_plane_strain.pvd"
        ]
    );
}

/// Elements that become particles continue where elements alone fail.
#[test]
fn taylor_copper_of_elements_that_become_particles() {
    for method in ["mpfem", "afemp"] {
        let name = format!("copper_{method}");
        let options = [
            "--resolution",
            "smoke",
            "--json",
            "--speed",
            "400",
            "--frames",
            "0",
            "--cells",
            "10",
            "--method",
            method,
        ];
        let value = result(&run(env!("CARGO_BIN_EXE_taylor_copper"), &options, &name), "taylor_copper");
        // Length, step, energy twice, momentum; with adaptive conversion (AFEMP) the least Jacobian.
        assert_eq!(
            (&value["missed"], &value["met"]),
            (&0.into(), &(5 + usize::from(method == "afemp")).into())
        );
        assert!(folder(&name).join("coupled.png").is_file());
        std::fs::remove_dir_all(folder(&name)).expect("removed");
    }
}

/// At 400 m/s elements of the impact face become flat or inverted; the error suggests remedies. Material points continue.
#[test]
fn taylor_copper_is_too_fast_for_elements_at_400() {
    let name = "fast_elements";
    let options =
        ["--resolution", "smoke", "--json", "--speed", "400", "--frames", "0", "--cells", "10", "--method"];
    let fast = |method| run(env!("CARGO_BIN_EXE_taylor_copper"), &[&options[..], &[method]].concat(), name);
    let output = fast("fem");
    assert!(!output.status.success());
    let said = String::from_utf8_lossy(&output.stderr);
    for part in
        ["element ", "body `bar`", "MeshBody::eroding(Erosion::", "material point method", "finer mesh"]
    {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(said.contains("inside out") || said.contains("so flat that"), "{said}");
    result(&fast("mpm"), "taylor_copper");
    std::fs::remove_dir_all(folder(name)).expect("removed");
}

/// Errors and costs of elements, material points and their coupling at a speed without a reference.
#[test]
fn taylor_copper_convergence() {
    let name = "copper_convergence";
    let options = ["--resolution", "smoke", "--json", "--convergence", "--speed", "190"];
    result(&run(env!("CARGO_BIN_EXE_taylor_copper"), &options, name), "taylor_copper");
    let table = std::fs::read_to_string(folder(name).join("convergence.csv")).expect("a table");
    assert_eq!(table.lines().count(), 1 + 4 * 3, "four methods with three sizes of cells:\n{table}");
    assert!(folder(name).join("convergence.png").is_file());
    std::fs::remove_dir_all(folder(name)).expect("removed");
}

#[test]
fn taylor_4340() {
    // At three speeds: length of the original and the total Lagrangian form, and energy twice of the latter; momentum and mass.
    smoke!(
        taylor_4340,
        only(3 * (2 + 2) + 2),
        [
            "temperature.png",
            "plastic_strain.png",
            "failure_damage.png",
            "energy.png",
            "history_printed_181.csv",
            "paraview/updated_224.pvd",
            "paraview/total_270_000008.vtp"
        ]
    );
}

/// Total Lagrangian form at one speed; also in three dimensions, and with three spacings.
#[test]
fn taylor_4340_in_space_and_over_spacings() {
    let name = "taylor_4340_space";
    let options = ["--resolution", "smoke", "--json", "--speed", "224", "--form", "total", "--cells", "6"];
    let more = ["--space", "--convergence", "--frames", "0", "--failing"];
    let value =
        result(&run(env!("CARGO_BIN_EXE_taylor_4340"), &[&options[..], &more].concat(), name), "taylor_4340");
    let length = |of: &str| self::of(&value, |n| n == format!("224 m/s, total Lagrangian{of}: length"));
    assert!((length(" in 3D") / length("") - 1.0).abs() < 5e-3, "a quarter of it is as long: {value}");
    let table = std::fs::read_to_string(folder(name).join("convergence.csv")).expect("a table");
    assert_eq!(table.lines().count(), 1 + 3, "three spacings:\n{table}");
    assert!(folder(name).join("convergence.png").is_file());
    std::fs::remove_dir_all(folder(name)).expect("removed");
}

/// The particles are many enough to be shared among threads.
#[test]
fn taylor_4340_does_not_depend_on_threads() {
    let left = |threads: &str| {
        let name = format!("taylor_4340-{threads}");
        let arguments = ["--resolution", "smoke", "--json", "--speed", "300", "--form", "printed,total"];
        let more = ["--threads", threads, "--frames", "0", "--cells", "10"];
        let program = env!("CARGO_BIN_EXE_taylor_4340");
        let value = result(&run(program, &[&arguments[..], &more].concat(), &name), "taylor_4340");
        let history = std::fs::read(folder(&name).join("history_printed_300.csv")).expect("a history");
        std::fs::remove_dir_all(folder(&name)).expect("removed");
        (value["checks"].clone(), history)
    };
    assert_eq!(left("1"), left("2"));
}

#[test]
fn ball_on_plate() {
    // Energy of both runs. Force, approach and duration are not judged on so coarse a grid.
    smoke!(
        ball_on_plate,
        only(2),
        [
            "force.png",
            "pressure.png",
            "history_elements_on_particles.csv",
            "history_particles_on_elements.csv",
            "paraview/elements_on_particles.pvd"
        ]
    );
}

#[test]
fn debris_cloud_2d() {
    // Arrival of the shock, front from above and below, mean velocity, mass, momentum, energy, energy added by revisions.
    smoke!(debris_cloud_2d, only(8), ["cloud.png", "history.csv", "paraview/cloud.pvd"]);
}

#[test]
fn debris_cloud() {
    // Pressure and density at impact; front, speed, mass (twice), momentum, energy of both clouds; ratio of the clouds.
    let value = smoke!(
        debris_cloud,
        only(2 + 2 * 6 + 1),
        ["cloud_split.png", "cloud_whole.png", "front.png", "plane.png", "cloud_split.csv"]
    );
    // Splitting keeps the cloud together.
    let alone =
        |how: &str| of(&value, |name| name == format!("{how}: cells of the cloud that touch no other"));
    assert!(alone("split") < 0.5 * alone("not split"));
}

#[test]
fn debris_cloud_of_a_plate_of_elements() {
    let options = ["--resolution", "smoke", "--json", "--method", "afemp"];
    let value =
        result(&run(env!("CARGO_BIN_EXE_debris_cloud"), &options, "cloud_of_elements"), "debris_cloud");
    assert_eq!(value["missed"], 0, "{}", value["checks"]);
    assert!(folder("cloud_of_elements").join("cloud_afemp.png").is_file());
    std::fs::remove_dir_all(folder("cloud_of_elements")).expect("removed");
}

#[test]
fn debris_cloud_3d() {
    // Front, speed, mass, momentum, energy of both clouds; speed, mass, front and energy of one cloud against the other.
    smoke!(debris_cloud_3d, only(2 * 5 + 4), ["clouds.png", "history_afemp_at_5000_m_s.csv"]);
}

#[test]
fn oblique_penetration_of_a_plate_of_elements() {
    let options = ["--resolution", "smoke", "--json", "--rod", "fem", "--target", "afemp"];
    let output = run(env!("CARGO_BIN_EXE_oblique_penetration"), &options, "plate_of_elements");
    let value = result(&output, "oblique_penetration");
    std::fs::remove_dir_all(folder("plate_of_elements")).expect("removed");
    assert_eq!(value["missed"], 0, "{}", value["checks"]);
}

#[test]
fn pcmm_distortion() {
    // Four figures of three scenes, one requirement of each and two of the strip, six of the packings; original rules and ours.
    let value = smoke!(pcmm_distortion, only(2 * (3 * 4 + 3 + 2 + 6)), ["ends.png"]);
    // Failures of the original rules: matter lost in shear, strips that separate, stress that does not rotate, holes.
    let printed = |what: &str| of(&value, |name| name.starts_with("printed") && name.contains(what));
    assert!(printed("shear flow: mass") < 0.9 && printed("parts") < 2.0);
    assert!(printed("turned") > 0.3 && printed("uncovered") > 0.05 && printed("twice") > 0.05);
}

#[test]
fn tungsten_bullet() {
    // Mass, momentum and energy of two methods in two spaces, revisions of one method. Speeds, times and depths are not
    // judged at half the paper's size.
    smoke!(
        tungsten_bullet,
        only(4 * 3 + 2),
        ["bullet_plane.png", "bullet_round.png", "tip.png", "history_mpm_round.csv"]
    );
}

#[test]
fn plug_weldox() {
    // Shape of the projectile, balances and energy of artificial stress, with two sets of constants. At 1 mm spacing the
    // plate is not perforated.
    let value = smoke!(
        plug_weldox,
        only(2 * 6),
        ["plug_2001.png", "plug_later.png", "velocities.png", "history_later.csv"]
    );
    assert!(of(&value, |name| name == "2001: residual velocity") < 100.0);
}

#[test]
fn kalthoff() {
    // Energy alone is judged: references are of finer points. The crack runs upwards, the shear band forwards.
    let value = smoke!(kalthoff, only(1), ["cracks.png", "modes.png", "speed.png"]);
    let first = "symmetric, cohesive, plane stress, 2500 points, seed 2: angle of the first 10 mm";
    assert!((50.0..85.0).contains(&of(&value, |name| name == first)));
    let band = of(&value, |name| name.ends_with("direction of the band"));
    assert!((-25.0..10.0).contains(&band), "{band}");
}

#[test]
fn glass_branching() {
    let value = smoke!(glass_branching, only(1), ["cracks.png", "speed.png", "energy.png"]);
    let branches = |load: &str| {
        let start = format!("cohesive, {load} MPa");
        of(&value, |name| name.starts_with(&start) && name.ends_with("branches beside each other, at most"))
    };
    assert!(branches("1") >= 2.0 && branches("1.5") >= 2.0);
}

#[test]
fn validation() {
    let name = "validation";
    let (out, tree) = (folder(name), folder("validation-tree"));
    std::fs::create_dir_all(&tree).expect("a folder");
    let git = |arguments: &[&str]| {
        let who =
            ["-c", "user.name=nobody", "-c", "user.email=nobody@localhost", "-c", "commit.gpgsign=false"];
        let output = Command::new("git").current_dir(&tree).args(who).args(arguments).output();
        output
            .ok()
            .filter(|o| o.status.success())
            .map(|o| String::from_utf8_lossy(&o.stdout).trim().to_string())
    };
    if git(&["init"]).is_none() {
        eprintln!("no git: the page is not tried");
        return;
    }
    git(&["commit", "--allow-empty", "--message", "One"]).expect("a commit");
    let head = git(&["rev-parse", "HEAD"]).expect("a commit");
    let docs = out.join("page");
    // Run cases as built by the test, in a separate tree that may be changed.
    let made = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_validation"))
            .current_dir(&tree)
            .args([
                "--as-built",
                "--docs",
                docs.to_str().expect("a name"),
                "--out",
                out.to_str().expect("a name"),
            ])
            .args(arguments)
            .output()
            .expect("it starts")
    };
    let page = || std::fs::read_to_string(docs.join("validation.md"));
    // A tree with a new file is refused before any run.
    std::fs::write(tree.join("new.txt"), "new").expect("written");
    let output = made(&["--cases", "elastic_bar"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && said.contains("working tree = new.txt is not allowed"), "{said}");
    assert!(page().is_err(), "no page is written");
    std::fs::remove_file(tree.join("new.txt")).expect("removed");

    let output = made(&["--resolution", "smoke", "--cases", "elastic_bar"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = page().expect("a page");
    assert_eq!(text.matches(&head).count(), 1, "the commit, once: {text}");
    assert!(text.contains("| [elastic_bar](#elastic_bar) | smoke | 20 of 24 | **4** | 4 |"), "{text}");
    let table = std::fs::read_to_string(docs.join("validation.csv")).expect("a table");
    assert!(table.lines().skip(1).all(|l| l.starts_with("elastic_bar,smoke,\"")), "{table}");
    // A case that exceeds the time limit is on the page as a failure; results of an earlier run are not.
    let output = made(&["--at-most", "1", "--resolution", "paper", "--cases", "shaken_discs"]);
    assert!(!output.status.success());
    let text = page().expect("a page");
    assert!(text.contains("broke off: not finished after 1 s") && !text.contains("elastic_bar"), "{text}");
    let output = made(&["--cases", "nothing"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("case = nothing is not allowed"));
    for folder in [out, tree] {
        std::fs::remove_dir_all(folder).expect("removed");
    }
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
    smoke!(
        tnt_slab,
        only(3 * 3 + 2 + 1 + 2 + 2),
        ["taylor_wave.png", "gauges.png", "gauges.csv", "profile.csv", "ledger.csv", "paraview/slab.pvd"]
    );
}

#[test]
fn tnt_cased() {
    // Speed of the cylinder's case twice, its roundness, reference speed; masses, energies and momentum of both shapes.
    smoke!(
        tnt_cased,
        only(4 + 2 * 5),
        ["section_cylinder.png", "section_cube.png", "speed_cylinder.png", "case_cube.csv"]
    );
}

#[test]
fn exploding_cylinder() {
    // Speed twice, reference speed and balances, of three mass ratios with two initiations; pieces twice and balances of a
    // breaking case.
    let value = smoke!(
        exploding_cylinder,
        only(2 * 3 * (3 + 4) + 2 + 4),
        [
            "speeds.png",
            "ratios.png",
            "pieces.png",
            "case_1000um_axis_16.csv",
            "case_4000um_axis_16_breaks.csv"
        ]
    );
    let speeds: Vec<f64> =
        value["settings"]["speeds"].as_array().expect("speeds").iter().filter_map(Value::as_f64).collect();
    assert!(speeds[0] > speeds[1] && speeds[1] > speeds[2], "the heavier the slower: {speeds:?}");
}

#[test]
fn plate_impact() {
    // Lines and states except the energy of seven metals, the shock on three grids, finite differences, spall on three
    // grids and all quantities on the finest, conservation.
    smoke!(
        plate_impact,
        only(7 * 5 + 3 * 2 + 1 + 2 + 3 * 3 + 7 + 2),
        [
            "lines.png",
            "shock.png",
            "spall.png",
            "line_lead.csv",
            "profile_150.csv",
            "surface_100.csv",
            "ledger_spall_100.csv",
            "paraview/spall_25.pvd"
        ]
    );
}

#[test]
fn expanding_ring() {
    // Seven at rest and two of a soft ring, of two metals by two methods; methods against each other; five of a breaking ring.
    let value = smoke!(
        expanding_ring,
        only(2 * 2 * (7 + 2) + 2 + 5),
        [
            "radius.png",
            "thickness.png",
            "pieces_300.png",
            "ring_heavy_mpm_1000um_8_1000gpa.csv",
            "ring_light_fem_500um_8_1000gpa.csv",
            "break_300_2.csv",
            "break_300_2_masses.csv"
        ]
    );
    assert!(value["settings"]["pieces"][0].as_u64().expect("pieces") > 5);
}

#[test]
fn ring_collision() {
    smoke!(
        ring_collision,
        only(4 * 2 + 2 * 4 + 1),
        [
            "closest_approach.png",
            "contact.png",
            "energy_error.csv",
            "energy_error.png",
            "force.png",
            "history_cpgimp_musl_distance_2000um.csv",
            "paraview/cpgimp_musl_distance_2000um.pvd",
            "rings.png"
        ]
    );
}

#[test]
fn bouncing_blocks() {
    // Bars, joint, discs, incline, balls and cylinders.
    smoke!(
        bouncing_blocks,
        only(11 + 4 + 5 + 4 + 9),
        [
            "discs.png",
            "discs_1.csv",
            "discs_energy.png",
            "hertz.png",
            "hertz_balls.csv",
            "impact.png",
            "impact_equal_bars.csv",
            "incline.png",
            "paraview/discs_1.pvd",
            "wave.png"
        ]
    );
}

#[test]
fn rolling_cylinder() {
    // Distance twice, gap, overlap and momentum of two coefficients in two and three dimensions; spread over the spacings.
    smoke!(
        rolling_cylinder,
        only(4 * 5 + 2),
        [
            "cylinder_2d.png",
            "cylinder_3d.png",
            "histories_3d.png",
            "spacings.png",
            "spacings.csv",
            "cylinder_2d_plane_030_12.csv",
            "cylinder_3d_plane_060_8.csv",
            "paraview/3d_plane_060_8.pvd"
        ]
    );
}

#[test]
fn oblique_penetration() {
    // Energy lost and gained, momentum, interpenetration. The speed of so coarse a rod and the memory of so small a scene
    // are not judged.
    smoke!(oblique_penetration, only(4), ["cuts.png", "speed.png", "rod_575_30deg_8.csv"]);
}

/// A plate fifty thicknesses away from the rod may be deactivated until contact: only the cost changes.
#[test]
fn oblique_penetration_from_afar() {
    let shot = |name: &str, option: &[&str]| {
        let options = [&["--resolution", "smoke", "--json", "--stand-off", "50"], option].concat();
        let value =
            result(&run(env!("CARGO_BIN_EXE_oblique_penetration"), &options, name), "oblique_penetration");
        std::fs::remove_dir_all(folder(name)).expect("removed");
        value
    };
    let (resting, plain) = (shot("flight_resting", &[]), shot("flight_plain", &["--no-rest"]));
    let flight = |value: &Value, key: &str| value["settings"]["flights"][0][key].clone();
    assert!(flight(&plain, "fingerprint").is_string());
    for key in ["fingerprint", "steps", "particles"] {
        assert_eq!(flight(&resting, key), flight(&plain, key), "{key}");
    }
    for key in ["energy_error", "momentum_error", "simulated_seconds"] {
        assert_eq!(resting[key], plain[key], "{key}");
    }
    assert_eq!(resting["settings"]["residual_speeds"], plain["settings"]["residual_speeds"]);
    let updates = [&resting, &plain].map(|v| flight(v, "updates").as_f64().expect("updates"));
    // The rod has 6.4 % of the particles; the plate is reactivated in the last blocks of the flight, at most two of fifty thicknesses.
    assert!(updates[0] < (0.064 + 2.0 / 50.0) * updates[1], "{updates:?}");
}

/// A rod of elements, with its surface in contact with the particles of the plate, has a residual speed closer to the
/// experiment than one of particles on so coarse a grid, and conserves momentum to rounding.
#[test]
fn oblique_penetration_of_a_rod_of_elements() {
    let options = ["--resolution", "smoke", "--json", "--rod", "fem"];
    let output = run(env!("CARGO_BIN_EXE_oblique_penetration"), &options, "rod_of_elements");
    let value = result(&output, "oblique_penetration");
    std::fs::remove_dir_all(folder("rod_of_elements")).expect("removed");
    let number = |v: &Value| v.as_f64().expect("a number");
    let residual = number(&value["settings"]["residual_speeds"][0]);
    assert!(residual > 360.0 && residual < 460.0, "{residual} m/s");
    assert!(number(&value["momentum_error"]).abs() < 1e-12, "{}", value["momentum_error"]);
    assert!(number(&value["energy_error"]).abs() < 0.12, "{}", value["energy_error"]);
    let rows = value["checks"].as_array().expect("rows");
    let inside = rows.iter().find(|row| row["name"].as_str().expect("name").starts_with("plate inside"));
    assert_eq!(inside.expect("the row")["value"], 0.0);
}

/// Axisymmetric, on a grid fine enough for the residual speed: no particle penetrates the surface of a rod of elements.
#[test]
fn concrete_perforation_of_a_rod_of_elements() {
    let options = ["--rod", "fem", "--model", "axisymmetric", "--cells", "26", "--speed", "1058"];
    let options = [&["--resolution", "smoke", "--json"][..], &options].concat();
    let output = run(env!("CARGO_BIN_EXE_concrete_perforation"), &options, "concrete_rod_of_elements");
    let value = result(&output, "concrete_perforation");
    std::fs::remove_dir_all(folder("concrete_rod_of_elements")).expect("removed");
    let number = |v: &Value| v.as_f64().expect("a number");
    let residual = number(&value["settings"]["residual_speeds"][0]);
    assert!(residual > 860.0 && residual < 910.0, "{residual} m/s");
    assert!(number(&value["momentum_error"]).abs() < 1e-12, "{}", value["momentum_error"]);
    assert!(number(&value["energy_error"]).abs() < 0.11, "{}", value["energy_error"]);
    let rows = value["checks"].as_array().expect("rows");
    let inside = rows.iter().find(|row| row["name"].as_str().expect("name").starts_with("slab inside"));
    assert_eq!(inside.expect("the row")["value"], 0.0);
}

#[test]
fn concrete_perforation() {
    // No reference decides (known miss), residual speed rises with impact speed and stays below it; energy, momentum,
    // interpenetration.
    smoke!(
        concrete_perforation,
        only(6),
        ["curve.png", "speed.png", "cuts.png", "cracks.png", "curve.csv", "rod_quarter_1058_12.csv"]
    );
}

#[test]
fn reinforced_slab() {
    // Mass of bars and effect of bars, under a rod and a blast; a small slab with lines and with particles; energy and momentum.
    let value = smoke!(
        reinforced_slab,
        only(2 * 2 + 3 + 2),
        [
            "damage_rod.png",
            "damage_blast.png",
            "rod.png",
            "blast.png",
            "small_blast.png",
            "rod_250_lines_100mm2_200mm_6.csv",
            "blast_particles_100mm2_125mm_6.csv"
        ]
    );
    // Bars of lines and of particles are the same bars: their effects agree within a third.
    let held =
        of(&value, |name| name == "small slab, deflection: what lines hold back over what particles do");
    assert!(held > 0.67 && held < 1.5, "{held}");
}

#[test]
fn granular_column() {
    // Run-out of three columns of bars and three of sand, bounded on both sides, of a coarse one from below; area, rest,
    // energy, momentum.
    smoke!(
        granular_column,
        only((3 + 3) * 2 + 1 + 4),
        ["column.png", "deposits.png", "fronts.png", "front_0.5_19.8deg_20.csv"]
    );
}

#[test]
fn slope_failure() {
    // Area, momentum, speed at the end; lower bound of the factor of safety.
    smoke!(
        slope_failure,
        only(3 + 1),
        ["slope.png", "slip.png", "run_out.png", "slip_2500mm.csv", "history_2500mm.csv"]
    );
}

#[test]
fn gate_flow() {
    // Penetration into the gate (twice), mass, momentum, energy; that of incompressible flow once, and balances; penetration, balances, pressure
    // and density at rest; fronts, shifted clock, speed, balances.
    let value = smoke!(
        gate_flow,
        only(5 + 4 + 7 + 15 + 2 + 3),
        [
            "water_elastic_surface_10.png",
            "tip_elastic_surface_10.png",
            "tip_elastic_surface_10.csv",
            "tip_flow_25.png",
            "tip_stiff_surface_10.csv",
            "front_none_20.csv",
            "front_none_20.png"
        ]
    );
    // The gate opens, and at least 5 % of the water is through.
    assert!(of(&value, |name| name.starts_with("elastic") && name.contains("way of the tip across")) > 30.0);
    assert!(of(&value, |name| name.contains("water through")) > 0.05);
}

#[test]
fn wedge_entry() {
    // Penetration into the wedge (twice) and energy, for elements of four sizes; equality of forces; momentum; penetration, force (twice) and
    // energy of incompressible flow.
    smoke!(
        wedge_entry,
        only(3 * 4 + 2 + 4),
        [
            "pressure.png",
            "force.png",
            "profile.png",
            "force_rigid_surface_1.csv",
            "force_rigid_surface_8.csv",
            "force_flow.csv"
        ]
    );
}

/// Elements on the grid that are wider than cells leak particles; elements in surface contact, elastic or not (above), do not.
#[test]
fn wedge_entry_leaks_on_the_grid() {
    let program = env!("CARGO_BIN_EXE_wedge_entry");
    let ran = |name: &str, options: &[&str]| {
        let output = run(program, &[&["--resolution", "smoke", "--json"], options].concat(), name);
        std::fs::remove_dir_all(folder(name)).expect("removed");
        result(&output, "wedge_entry")
    };
    let value = ran("leaks", &["--coupling", "grid"]);
    let inside = |edge: &str| {
        of(&value, |name| name == format!("rigid_grid_{edge}: particles with their centre in the wedge"))
    };
    assert_eq!(inside("1"), 0.0);
    assert!(inside("4") > 10.0 && inside("8") > 10.0, "{} {}", inside("4"), inside("8"));
    // No row fails: no particle penetrates a surface.
    let value = ran("elastic", &["--elastic", "--young", "5"]);
    assert_eq!(value["missed"], 0);
    assert!(of(&value, |name| name == "elastic_surface_1: keel bent up by") > 1.0, "it bends");
}

#[test]
fn dam_break() {
    // Corner, force and order of three columns; depths, front and discharge of shallow flow; front of the column, twice, and its speed;
    // alternation of the pressure in the tank; volume and energy of the last three; momentum.
    smoke!(
        dam_break,
        only(3 * 3 + 4 + 3 + 1 + 3 * 2 + 1),
        [
            "water_release.png",
            "water_tank.png",
            "profile.png",
            "front.png",
            "wall.png",
            "tank.csv",
            "release_0.5_32.csv"
        ]
    );
}

#[test]
fn sloshing() {
    // Period, except of the third, amplitude and centre of mass of three modes; centre of mass and elevation of the sway at five times; rate of decay; energy;
    // volumes; momentum.
    smoke!(
        sloshing,
        only(3 * 3 - 1 + 2 * 5 + 1 + 1 + 6 + 1),
        ["history_mode_1.png", "history_decay.png", "surface.png", "sway.csv", "long.csv"]
    );
}

#[test]
fn floating_box() {
    // Level, depth, period, growth, energy and momentum of two boxes; the same without a period in space; depth, turn, energy and momentum of the light
    // box; turn, energy and momentum of the one that rolls over; momentum, way and turn of the fall.
    smoke!(
        floating_box,
        only(2 * 6 + 5 + 4 + 3 + 3),
        ["heave.png", "turn.png", "water_roll.png", "heave_500_40.csv", "space_20.csv"]
    );
}

#[test]
fn drop() {
    // Axes at four times, energy and pressure, twice, of the ellipse; three periods; axis, fourth moment and pressure of the square and the
    // cube, whose error is compared with a published one; pressure of two drops at rest and the ratio of their speeds; momentum.
    smoke!(
        drop,
        only(2 * 4 + 3 + 3 + 2 * 3 + 1 + 3 + 1),
        ["shape_elliptic.png", "shape_cube.png", "period_rayleigh.png", "rest_16.csv"]
    );
}

#[test]
fn taylor_green() {
    // Amplitude and order of vortices; error and order of two channel flows at three times; momentum.
    smoke!(
        taylor_green,
        only(2 + 2 * 3 * 2 + 1),
        ["vortices.png", "poiseuille.png", "couette.png", "order.png", "vortices_32.csv"]
    );
}

#[test]
fn pressed_balls() {
    smoke!(pressed_balls, only(5), ["waves.png", "reaction.png", "reaction.csv", "paraview/balls.pvd"]);
}

#[test]
fn shaken_discs() {
    smoke!(
        shaken_discs,
        only(4),
        ["discs.png", "histories.png", "discs.csv", "ledger.csv", "paraview/discs.pvd"]
    );
}

#[test]
fn wave_plate() {
    // Peaks, speed of waves and energy, of two fluxes: jumps, half a sine with its first periods, a ramp.
    smoke!(
        wave_plate,
        only(2 * (2 * (2 + 2) + (6 + 2) + (4 + 2))),
        ["waves.png", "plate.png", "history_half-sine_symmetric.csv", "paraview/step_incomplete.pvd"]
    );
}

#[test]
fn cantilever_pulse() {
    // Lowest position and its time; lowest position and stresses above and below against elements; mean under the load,
    // energy; two fluxes.
    smoke!(
        cantilever_pulse,
        only(2 * (2 + 3 + 1 + 1)),
        ["swing.png", "beam.png", "history_symmetric.csv", "paraview/incomplete.pvd"]
    );
}

#[test]
fn throughput() {
    let value = smoke!(throughput, .., []);
    let runs = value["settings"]["runs"].as_array().expect("runs");
    assert_eq!(runs.len(), 3 * 2);
    for pair in runs.chunks(2) {
        assert_eq!(pair[0]["checksum"], pair[1]["checksum"], "one and two threads differ");
    }
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
    let ball = said(env!("CARGO_BIN_EXE_ball_on_plate"), &["--ball", "elements", "--plate", "elements"]);
    assert!(ball.contains("--plate elements is not allowed"), "{ball}");
    let copper = said(env!("CARGO_BIN_EXE_taylor_copper"), &["--speed", "5"]);
    assert!(copper.contains("'5' for '--speed <V>'") && copper.contains("from 10 to 1000"), "{copper}");
    let steel = said(env!("CARGO_BIN_EXE_taylor_4340"), &["--form", "printed,magic"]);
    assert!(steel.contains("'magic' for '--form <FORM,FORM>'") && steel.contains("updated"), "{steel}");
    let concrete = said(env!("CARGO_BIN_EXE_concrete_perforation"), &["--speed", "606,20"]);
    assert!(concrete.contains("'20' for '--speed <M/S,M/S>'"), "{concrete}");
    let column = said(env!("CARGO_BIN_EXE_granular_column"), &["--friction", "60"]);
    assert!(column.contains("'60' for '--friction <DEGREES>'"), "{column}");
    let slope = said(env!("CARGO_BIN_EXE_slope_failure"), &["--spacing", "9"]);
    assert!(slope.contains("'9' for '--spacing <M,M>'"), "{slope}");
    let friction = said(rolling, &["--friction", "0.3,-1"]);
    assert!(friction.contains("'-1' for '--friction <MU>'"), "{friction}");
    // Negative numbers are values, not options.
    let gap = said(env!("CARGO_BIN_EXE_kalthoff"), &["--gap", "-1"]);
    assert!(gap.contains("'-1' for '--gap <MM>'") && gap.contains("from 0 to 10"), "{gap}");
    let load = said(env!("CARGO_BIN_EXE_glass_branching"), &["--strength", "-3.08"]);
    assert!(load.contains("'-3.08' for '--strength <MPA>'") && load.contains("from 0.1"), "{load}");
    let points = said(env!("CARGO_BIN_EXE_wave_plate"), &["--points", "-1"]);
    assert!(points.contains("'-1' for '--points"), "{points}");
    let poisson = said(env!("CARGO_BIN_EXE_cantilever_pulse"), &["--nu", "-0.3"]);
    assert!(poisson.contains("'-0.3' for '--nu <NU>'") && poisson.contains("from 0 to"), "{poisson}");
    let folder = said(bar, &["--resolution", "smoke", "--out", "/dev/null/here"]);
    assert!(folder.contains("/dev/null/here"), "{folder}");
    let steps = said(speed, &["--steps", "0"]);
    assert!(steps.contains("'0' for '--steps <N>'"), "{steps}");
    let against = said(speed, &["--resolution", "smoke", "--against", "/nowhere/yardstick"]);
    assert!(against.contains("/nowhere/yardstick"), "{against}");
}
