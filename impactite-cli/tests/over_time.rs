//! Measures over time, and ends by measures, for runs that are stopped and resumed.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use impactite_cli::{CliError, Job, Outcome};
use impactite_input::Source;

/// Ball that bounces off a floor, until its centre has risen again.
const SCENE: &str = r#"
title = "bounce"
space = "plane strain"
end = "1 s"
until = [{ measure = "height", above = "11 mm" }, { measure = "height", below = "0 mm" }]
method.mpm.cell = "2 mm"
materials.rubber.neo_hookean = { density = "1 g/cm^3", young = "1 MPa", poisson = 0.4 }
conditions = [{ wall = { axis = "y", at = 0 } }]
[bodies.disc]
material = "rubber"
shape.ball = { centre = [0, "10.5 mm"], radius = "10 mm" }
velocity = [0, "-2 m/s"]
[measures]
height = { centre = { body = "disc", axis = "y" } }
floor = { condition_force = { axis = "y" } }
impulse = { condition_impulse = { axis = "y" } }
momentum = { momentum = { body = "disc", axis = "y" } }
of_forces = { over_time = { of = "floor", take = "integral" } }
peak = { over_time = { of = "floor", take = "largest" } }
when = { over_time = { of = "floor", take = "time_of_largest" } }
lowest = { over_time = { of = "height", take = "smallest" } }
late = { over_time = { of = "height", take = "mean", from = "2 ms", to = "1 s" } }
"#;

fn folder(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("impactite-over-time-{name}-{}", std::process::id()))
}

fn job(name: &str) -> Job {
    let job = Job::new(Source::new("bounce.toml", SCENE), folder(name));
    Job { pictures: false, report: false, threads: Some(1), ..job }
}

fn values(outcome: &Outcome) -> Vec<(&str, u64)> {
    outcome.measures.iter().map(|m| (m.0.as_str(), m.1.to_bits())).collect()
}

fn of(outcome: &Outcome, name: &str) -> f64 {
    outcome.measures.iter().find(|m| m.0 == name).expect("a measure").1
}

#[test]
fn a_run_that_goes_on_has_the_measures_over_time_of_one_that_was_not_stopped() {
    let never = AtomicBool::new(false);
    let whole = job("whole").run(&never).expect("a run");
    // The ball rose again before the end.
    assert!(whole.simulated_seconds < 0.1 && of(&whole, "height") > 0.011, "{} s", whole.simulated_seconds);
    assert!(
        (of(&whole, "of_forces") / of(&whole, "impulse") - 1.0).abs() < 1e-9,
        "forces are means over steps"
    );
    let change = of(&whole, "momentum") + 2.0 * std::f64::consts::PI * 0.01 * 0.01 * 1000.0;
    assert!((of(&whole, "impulse") / change - 1.0).abs() < 2e-3, "{} {change}", of(&whole, "impulse"));
    let (lowest, when) = (of(&whole, "lowest"), of(&whole, "when"));
    assert!(lowest < 0.0095 && when > 0.0 && when < whole.simulated_seconds && of(&whole, "late") > lowest);

    let parted = job("parted");
    let stop = AtomicBool::new(true);
    for step in 0..3 {
        let job = if step == 0 { parted.clone() } else { Job::resume(&parted.folder).expect("a checkpoint") };
        match job.run(&stop) {
            Err(CliError::Run(impactite::scene::RunError::Interrupted { .. })) => {}
            other => panic!("it stops after a step: {other:?}"),
        }
    }
    let resumed = Job { threads: Some(2), ..Job::resume(&parted.folder).expect("a checkpoint") };
    let resumed = resumed.run(&never).expect("a run");
    assert_eq!((values(&resumed), resumed.simulated_seconds), (values(&whole), whole.simulated_seconds));
    let rows = |of: &Path| std::fs::read_to_string(of.join("measures.csv")).expect("a history");
    assert_eq!(rows(&parted.folder), rows(&folder("whole")));
    for name in ["whole", "parted"] {
        std::fs::remove_dir_all(folder(name)).expect("a folder");
    }
}

#[test]
fn what_is_no_measure_over_time_is_refused_with_its_key() {
    let said = |from: &str, to: &str| {
        let text = SCENE.replacen(from, to, 1);
        assert_ne!(text, SCENE);
        let job = Job { source: Source::new("bounce.toml", text), ..job("refused") };
        job.run(&AtomicBool::new(false)).expect_err("refused").to_string()
    };
    for (from, to, wanted) in [
        (
            "of = \"floor\", take = \"integral\"",
            "of = \"ceiling\", take = \"integral\"",
            "measures.of_forces.over_time.of",
        ),
        ("of = \"floor\", take = \"integral\"", "of = \"peak\", take = \"integral\"", "is over time itself"),
        ("from = \"2 ms\"", "from = \"2 s\"", "measures.late.over_time.from"),
        ("to = \"1 s\"", "to = \"1 ms\"", "measures.late.over_time.to"),
        ("measure = \"height\", above", "measure = \"hight\", above", "until[0].measure"),
        ("above = \"11 mm\"", "above = \"11 kg\"", "until[0].above"),
        (", above = \"11 mm\"", "", "needs `below` or `above`"),
        ("conditions = [{ wall = { axis = \"y\", at = 0 } }]", "", "needs `conditions`"),
    ] {
        let said = said(from, to);
        assert!(said.contains(wanted), "{to}: {said}");
    }
}
