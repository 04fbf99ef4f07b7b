//! Compiler errors for a method of other dimensions than its packing: one error, at the line of the body, with the remedy. The program is
//! checked as `cargo check` does, with the libraries of this test's build.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::SystemTime;

/// Program with a body in line 7, and uses of it.
const PROGRAM: &str = r#"#![allow(unused)]
use impactite_scene::{Axisymmetric, FullSpace, PlaneStrain};
use mpm_materials::NeoHookean;
use pcmm::*;
fn run(law: NeoHookean<f64>, packing: &Packing<$dimensions>, delaunay: LocalDelaunay) -> Result<(), Box<dyn std::error::Error>> {
    let method = Method::consistent($space, delaunay);
    let mut bar = Pcmm::new(method, law, packing, |_| [0.0; $dimensions], Masses::FromElements)?;
    bar.set_time_control(impactite_scene::TimeControl::Fixed(1.0))?;
    bar.run_until(1.0)?;
    println!("{:?}", bar.audit());
    Ok(())
}
"#;

/// Return the libraries of a name in a folder, the last built first.
fn built(folder: &Path, name: &str) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder).expect("the folder of this test").flatten().map(|e| e.path());
    let when =
        |file: &PathBuf| file.metadata().and_then(|about| about.modified()).unwrap_or(SystemTime::UNIX_EPOCH);
    let named = |file: &PathBuf| {
        let file = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        file.starts_with(&format!("lib{name}-")) && file.ends_with(".rlib")
    };
    let mut found: Vec<PathBuf> = files.filter(named).collect();
    found.sort_by_key(|file| std::cmp::Reverse(when(file)));
    found
}

const LIBRARIES: [&str; 3] = ["pcmm", "mpm_materials", "impactite_scene"];

/// Return libraries that were built for each other: of those built with different sets of features, the last with which a sound program
/// compiles.
fn libraries(folder: &Path) -> &'static [PathBuf; 3] {
    static FOUND: OnceLock<[PathBuf; 3]> = OnceLock::new();
    FOUND.get_or_init(|| {
        let sound = program("PlaneStrain", 2);
        let [methods, laws, scenes] = LIBRARIES.map(|name| built(folder, name));
        let sets = methods.iter().flat_map(|method| {
            let of_laws = laws.iter().flat_map(|law| scenes.iter().map(move |scene| (law, scene)));
            of_laws.map(move |(law, scene)| [method, law, scene].map(PathBuf::clone))
        });
        let mut sets = sets.filter(|set| said("sound", &sound, folder, set).is_empty());
        sets.next().unwrap_or_else(|| {
            panic!("no libraries of which a sound program compiles in {}", folder.display())
        })
    })
}

fn program(space: &str, dimensions: usize) -> String {
    PROGRAM.replace("$dimensions", &dimensions.to_string()).replace("$space", space)
}

fn checked(space: &str, dimensions: usize) -> String {
    let test = std::env::current_exe().expect("this test");
    let folder = test.parent().expect("its folder");
    let name = format!("{space}-{dimensions}");
    said(&name, &program(space, dimensions), folder, libraries(folder))
}

fn said(name: &str, program: &str, folder: &Path, libraries: &[PathBuf; 3]) -> String {
    let scratch = std::env::temp_dir().join(format!("impactite-pcmm-messages-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&scratch).expect("a folder");
    let source = scratch.join("program.rs");
    std::fs::write(&source, program).expect("written");
    let mut rustc = Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
    rustc.args(["--edition=2024", "--crate-type=lib", "--emit=metadata", "--color=never"]);
    for (name, library) in LIBRARIES.into_iter().zip(libraries) {
        rustc.arg("--extern").arg(format!("{name}={}", library.display()));
    }
    rustc.arg("-L").arg(format!("dependency={}", folder.display()));
    let said = rustc.arg("--out-dir").arg(&scratch).arg(&source).output().expect("the compiler runs");
    let _ = std::fs::remove_dir_all(&scratch);
    String::from_utf8_lossy(&said.stderr).into_owned()
}

#[test]
fn a_method_of_other_dimensions_than_its_packing_is_one_error() {
    for (space, dimensions) in [("PlaneStrain", 2), ("Axisymmetric", 2), ("FullSpace", 3)] {
        let said = checked(space, dimensions);
        assert!(said.is_empty(), "{said}");
    }
    for (space, dimensions) in [("PlaneStrain", 3), ("Axisymmetric", 3), ("FullSpace", 2)] {
        let said = checked(space, dimensions);
        let errors = said.lines().filter(|l| l.starts_with("error") && !l.starts_with("error: aborting"));
        let errors: Vec<&str> = errors.collect();
        assert_eq!(errors.len(), 1, "{said}");
        assert!(
            errors[0].contains(&format!("has other dimensions than `pcmm::Packing<{dimensions}>`")),
            "{said}"
        );
        assert!(errors[0].contains(space) && said.contains("program.rs:7:"), "{said}");
        assert!(said.contains("in two take `PlaneStrain` or `Axisymmetric`, in three `FullSpace`"), "{said}");
    }
}
