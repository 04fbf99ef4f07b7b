//! Fast set of the stability scenes: every scene is as expected, or as noted.

use stability::scenes;
use stability::verdict::{Expect, Size, Verdict};

fn judged(ids: &[&str]) {
    let all = scenes::all();
    let mut off = Vec::new();
    for id in ids {
        let scene = all.iter().find(|s| s.id == *id).unwrap_or_else(|| panic!("no scene {id}"));
        for judged in scene.run(Size::Fast) {
            println!("{}", judged.line());
            if !judged.known() {
                off.push(judged.line());
            }
        }
    }
    assert!(off.is_empty(), "not as expected, nor as noted:\n{}", off.join("\n"));
}

macro_rules! scenes {
    ($($(#[$doc:meta])* $name:ident: $($id:literal)*;)*) => {
        $($(#[$doc])* #[test] fn $name() { judged(&[$($id),*]); })*

        /// Completeness: every scene is in one of the tests.
        #[test]
        fn none_is_left_out() {
            let mut tested = vec![$($($id),*),*];
            let mut there: Vec<_> = scenes::all().iter().map(|s| s.id).collect();
            tested.sort_unstable();
            there.sort_unstable();
            assert_eq!(tested, there);
        }
    };
}

scenes! {
    /// Cell crossing.
    particles_cross_cells: "T1" "T2" "H1" "J1" "B1";
    /// Time step limits.
    steps_are_as_long_as_they_may_be: "T3" "T4" "F1";
    /// Large tension.
    bodies_are_pulled_apart: "T5" "T28" "T12";
    /// Null-space noise.
    the_grid_does_not_see_all: "T9" "T9g" "T10";
    /// Volumetric locking.
    volume_locks: "T11" "T11p";
    /// Large compression.
    bodies_are_crushed: "T13" "T13g";
    /// Breakdowns and their messages.
    what_breaks_is_named: "T14" "T21" "T16" "T16d";
    /// Mass and stiffness ratios.
    masses_and_stiffnesses_differ: "T15" "T20" "M1";
    /// Long runs.
    runs_are_long: "T17";
    /// Large rotation.
    bodies_turn: "T19" "O1" "O2";
    /// Strong shocks.
    shocks_are_strong: "T26n" "T26" "T26h";
    /// Particles on nodes, and threads.
    ties_and_threads: "T29" "T30";
    /// Finite elements.
    elements_fold_and_lock_and_turn: "E1" "T11e" "T14e";
    /// Contact of finite elements.
    elements_touch: "E2";
    /// Finite elements in contact with particles.
    facets_are_coarse: "T23";
    /// Conversion of elements to particles.
    elements_become_particles: "T22" "C1" "C2" "C3";
    /// Smoothed particles.
    particles_are_smoothed: "S1" "S2" "S3" "S4" "S5" "S6" "S7" "S8" "S9";
    /// Fragile points.
    cells_are_fragile: "P1" "P2" "P3" "P3c" "T11f" "T11w" "P5" "P5f" "P6";
}

/// Every scene has an expected failure, otherwise it proves nothing.
#[test]
fn every_scene_has_what_fails() {
    for scene in scenes::all() {
        let fails = scene.rows.iter().any(|r| r.expect == Expect::Fails);
        let noted = scene.rows.iter().any(|r| r.noted.is_some());
        assert!(fails || noted, "{}: nothing is expected to fail", scene.id);
    }
}

/// Verdicts by expectation and value; NaN never meets the criterion.
#[test]
fn verdicts() {
    use stability::verdict::{Limit, Measured, Scene, Stop};
    let scene = |value: f64, stopped: bool| {
        let trial = move |_| {
            let stop = stopped.then(|| Stop { step: 3, what: "broken".into() });
            Ok(Measured::new(value, 10).stopped(stop))
        };
        let empty =
            Scene { id: "-", name: "", fails: "", metric: "", limit: Limit::AtMost(1.0), rows: vec![] };
        empty.holds("a", "", trial).fails("b", "", trial)
    };
    let verdicts =
        |value, stopped| scene(value, stopped).run(Size::Fast).iter().map(|j| j.verdict).collect::<Vec<_>>();
    assert_eq!(verdicts(0.5, false), [Verdict::Pass, Verdict::UnexpectedPass]);
    assert_eq!(verdicts(2.0, false), [Verdict::Regression, Verdict::FailExpected]);
    assert_eq!(verdicts(f64::NAN, false), [Verdict::Regression, Verdict::FailExpected]);
    assert_eq!(verdicts(0.5, true), [Verdict::Regression, Verdict::FailExpected]);
}
