//! What the compiler says of failure criteria that do not go together, or not into a law: one error, at the line where they are handed to
//! it, that names them and what to take instead. Programs are checked as `cargo check` does, without code generation, by the compiler and
//! with the library that this test was built with.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

/// A program that makes a law with a criterion in line 24, and goes on with it; before, functions of any criterion.
const PROGRAM: &str = r#"#![allow(unused)]
use mpm_materials::failure::OneCrack;
use mpm_materials::*;
use std::sync::Arc;
type Spall = CohesiveSpall<f64>;
type Limit = PlasticStrainLimit<f64>;
fn judged<F: Failure<f64>>(failure: F) {}
fn copper<F: Failure<f64>>(failure: F) -> impl Constitutive<f64> {
    library::copper_ofhc().with_failure(failure)
}
fn pair<A: Failure<f64>, B: Failure<f64>>(a: A, b: B) -> impl Constitutive<f64>
where
    A::Cracks: OneCrack<B::Cracks>,
{
    library::copper_ofhc().with_failure((a, b))
}
fn beside<A: Failure<f64>>(a: A, limit: Limit) -> (impl Constitutive<f64>, impl Constitutive<f64>) {
    (copper((limit, a.clone())), library::copper_ofhc().with_failure((a, limit)))
}
fn sand<F: Failure<f64, Cracks = NoCrack>>(failure: F) -> impl Constitutive<f64> {
    library::dry_sand().with_failure(LosesShear(failure))
}
fn run(spall: Spall, limit: Limit, tension: TensilePressure<f64>) -> Result<(), Box<dyn std::error::Error>> {
    let law = $law;
    let law = law.with_bulk_viscosity(0.06, 1.5)?.with_rate(SmallRotation);
    println!("{} {:?}", law.name(), law.virgin());
    println!("{}", law.wave_speed(&law.virgin()));
    let material: Arc<dyn Material<f64>> = law.compiled().into_material();
    println!("{:?}", material.constants());
    Ok(())
}
"#;

/// The line of the law.
const LINE: usize = 24;

/// The library, as it was built last: cargo builds it for this test.
fn library(folder: &Path) -> PathBuf {
    let files =
        std::fs::read_dir(folder).expect("the folder of this test").flatten().map(|entry| entry.path());
    let built =
        |file: &PathBuf| file.metadata().and_then(|about| about.modified()).unwrap_or(SystemTime::UNIX_EPOCH);
    let named = |file: &PathBuf| {
        let file = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        file.starts_with("libmpm_materials-") && file.ends_with(".rlib")
    };
    files.filter(named).max_by_key(built).unwrap_or_else(|| panic!("no library in {}", folder.display()))
}

/// What the compiler says of the program with this law.
fn checked(name: &str, law: &str) -> String {
    let test = std::env::current_exe().expect("this test");
    let folder = test.parent().expect("its folder");
    let scratch = std::env::temp_dir().join(format!("impactite-failures-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&scratch).expect("a folder");
    let source = scratch.join("program.rs");
    std::fs::write(&source, PROGRAM.replace("$law", law)).expect("written");
    let mut rustc = Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
    rustc.args(["--edition=2024", "--crate-type=lib", "--emit=metadata", "--color=never"]);
    rustc.arg("--extern").arg(format!("mpm_materials={}", library(folder).display()));
    rustc.arg("-L").arg(format!("dependency={}", folder.display()));
    // Long names of types go to files beside the output.
    let said = rustc.arg("--out-dir").arg(&scratch).arg(&source).output().expect("the compiler runs");
    let _ = std::fs::remove_dir_all(&scratch);
    // Names as a reader takes them.
    let said = String::from_utf8_lossy(&said.stderr).replace("mpm_materials::", "");
    assert!(!said.contains("can't find crate") && !said.contains("incompatible version"), "{said}");
    said
}

/// What is refused is reported once, at its line, in these words, with this advice.
fn refused(name: &str, law: &str, message: &str, advice: &str) {
    let said = checked(name, law);
    let errors = said.lines().filter(|l| l.starts_with("error") && !l.starts_with("error: aborting"));
    let errors: Vec<&str> = errors.collect();
    assert_eq!(errors.len(), 1, "{law}: errors {errors:#?} in\n{said}");
    assert!(errors[0].contains(message), "{law}: `{message}` is not said, but\n{said}");
    assert!(
        said.lines().any(|l| l.contains("= note:") && l.contains(advice)),
        "{law}: no `{advice}` in\n{said}"
    );
    let place = said.lines().find(|l| l.trim_start().starts_with("-->")).unwrap_or_default();
    assert!(place.contains(&format!("program.rs:{LINE}:")), "{law}: reported at {place}");
}

/// A criterion in a solid.
fn solid(criterion: &str) -> String {
    format!("library::copper_ofhc().with_failure({criterion})")
}
/// A criterion in ground.
fn ground(criterion: &str) -> String {
    format!("library::concrete_48().with_failure({criterion})")
}

#[test]
fn criteria_that_go_together_compile() {
    let laws = [
        solid("NoFailure"),
        solid("spall"),
        solid("(spall, limit)"),
        solid("(limit, spall)"),
        solid("(NoFailure, (spall, (limit, tension)))"),
        solid("LosesTension((spall, limit))"),
        solid("Removed(spall)"),
        solid("LosesShear((limit, tension))"),
        solid("(LosesShear(limit), spall)"),
        solid("PlasticStrainLimit::new(0.5)?"),
        ground("tension"),
        ground("NoFailure"),
        ground("(LosesShear(limit), Removed(tension))"),
        ground("DamageLimit::new(1.0)?"),
        "Solid::new(Elastic::new(26e9)?, LogarithmicBulk::new(2700.0, 74e9)?)\
            .with_failure(CohesiveSpall::new(1e9, 1e-5)?)"
            .into(),
    ];
    for (n, law) in laws.iter().enumerate() {
        let said = checked(&format!("allowed_{n}"), law);
        assert!(said.is_empty(), "{law}: {said}");
    }
}

#[test]
fn two_cracks_in_a_point_are_refused() {
    let advice = "of the two criteria of a pair one at most opens one, as `CohesiveSpall` does; take `TensilePressure` or `PrincipalStress`";
    for (n, (criterion, named)) in [
        ("(spall, spall)", "(CohesiveSpall<f64>, CohesiveSpall<f64>)"),
        ("((spall, limit), spall)", "((CohesiveSpall<f64>, PlasticStrainLimit<f64>), CohesiveSpall<f64>)"),
        (
            "Removed((spall, LosesTension(spall)))",
            "Removed<(CohesiveSpall<f64>, LosesTension<CohesiveSpall<f64>>)>",
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let message = format!("`{named}` is not a failure criterion that a solid can have");
        refused(&format!("pair_{n}"), &solid(criterion), &message, advice);
    }
}

#[test]
fn cracks_that_keep_tension_are_refused() {
    let advice = "take what opens one without it, or in `LosesTension` or `Removed`";
    for (n, (criterion, named)) in [
        ("LosesShear(spall)", "LosesShear<CohesiveSpall<f64>>"),
        ("LosesShear((limit, spall))", "LosesShear<(PlasticStrainLimit<f64>, CohesiveSpall<f64>)>"),
        ("(limit, LosesShear(spall))", "(PlasticStrainLimit<f64>, LosesShear<CohesiveSpall<f64>>)"),
    ]
    .into_iter()
    .enumerate()
    {
        let message = format!("`{named}` is not a failure criterion that a solid can have");
        refused(&format!("shear_{n}"), &solid(criterion), &message, advice);
    }
}

#[test]
fn cracks_in_ground_are_refused() {
    let advice = "`Ground` has a pressure of its own: take `TensilePressure` or `PrincipalStress`";
    for (n, (criterion, named)) in [
        ("spall", "CohesiveSpall<f64>"),
        ("CohesiveSpall::new(1e9, 1e-5)?", "CohesiveSpall<{float}>"),
        ("(spall, limit)", "(CohesiveSpall<f64>, PlasticStrainLimit<f64>)"),
        ("Removed(spall)", "Removed<CohesiveSpall<f64>>"),
    ]
    .into_iter()
    .enumerate()
    {
        let message = format!("`{named}` is not a failure criterion that ground can have");
        refused(&format!("ground_{n}"), &ground(criterion), &message, advice);
    }
}

#[test]
fn what_is_no_criterion_is_refused() {
    let advice = "a criterion of one's own implements `Failure`";
    refused("solid", &solid("0.5"), "is not a failure criterion that a solid can have", advice);
    refused("ground", &ground("0.5"), "is not a failure criterion that ground can have", advice);
}

#[test]
fn functions_of_criteria_say_what_they_miss() {
    let own = |call: &str| format!("{{ {call}; library::copper_ofhc() }}");
    let pair = "two criteria of a pair open a crack, and a point has one";
    let advice = "take one that opens none for one of them, such as `TensilePressure` or `PrincipalStress`";
    refused("own_pair", &own("judged((spall, spall))"), pair, advice);
    let shear = "`LosesShear` keeps tension, which what a crack has opened in does not bear";
    refused("own_shear", &own("judged(LosesShear(spall))"), shear, "in `LosesTension` or `Removed`");
    let number = "`{float}` is not a failure criterion";
    refused(
        "own_number",
        &own("judged(0.5)"),
        number,
        "with `type Cracks = NoCrack` unless a crack opens in it",
    );
    let fits = "(copper((spall, limit)), beside(spall, limit), pair(spall, limit), sand(limit))";
    let said = checked("own", &own(&format!("let laws = {fits}")));
    assert!(said.is_empty(), "{said}");
}
