//! Compiler messages for invalid methods: one error, at the line of the combination, that names the parts and
//! alternatives. Programs are checked as by `cargo check`, without code generation, with the compiler and libraries
//! of this test.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::SystemTime;

/// Program with a method of `$dimensions` and a scene that uses it; the method is in line 8, the scene in line 9.
const PROGRAM: &str = r#"#![allow(unused)]
use mpm_core::geometry::*;
use mpm_core::*;
use mpm_materials::*;
fn run(law: NeoHookean<f64>) -> Result<(), Box<dyn std::error::Error>> {
    let lattice = Lattice::new([0.0; $dimensions], 0.1)?;
    let seeds = fill(&Cuboid::new([0.0; $dimensions], [1.0; $dimensions])?, &lattice, 2, &Filling::new())?;
    let method = $method;
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.set_body_force(|_| [0.0; $dimensions]);
    mpm.bound(Boundary::Fixed { axis: 0, at: 0.0, side: Side::Above })?;
    mpm.add("block", law, &seeds, |x| x)?;
    mpm.run_until(1.0)?;
    println!("{} {:?}", mpm.time(), mpm.totals());
    Ok(())
}
"#;

/// Return the libraries of a name in a folder, the newest first.
fn built(folder: &Path, name: &str) -> Vec<PathBuf> {
    let files =
        std::fs::read_dir(folder).expect("the folder of this test").flatten().map(|entry| entry.path());
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

/// Return the newest two libraries that were built for each other, with any set of features: those with which a valid
/// program compiles.
fn libraries(folder: &Path) -> &'static [PathBuf; 2] {
    static FOUND: OnceLock<[PathBuf; 2]> = OnceLock::new();
    FOUND.get_or_init(|| {
        let sound = program("Method::new(Linear, Flip, Musl, PlaneStrain)", 2);
        let materials = built(folder, "mpm_materials");
        let pairs = built(folder, "mpm_core")
            .into_iter()
            .flat_map(|core| materials.clone().into_iter().map(move |law| [core.clone(), law]));
        let mut pairs = pairs.filter(|pair| said("sound", &sound, folder, pair).is_empty());
        pairs.next().unwrap_or_else(|| {
            panic!("no libraries of which a sound program compiles in {}", folder.display())
        })
    })
}

fn program(method: &str, dimensions: usize) -> String {
    PROGRAM.replace("$dimensions", &dimensions.to_string()).replace("$method", method)
}

/// Return the compiler output for a program.
fn checked(name: &str, program: &str) -> String {
    let test = std::env::current_exe().expect("this test");
    let folder = test.parent().expect("its folder");
    said(name, program, folder, libraries(folder))
}

fn said(name: &str, program: &str, folder: &Path, libraries: &[PathBuf; 2]) -> String {
    let scratch = std::env::temp_dir().join(format!("impactite-messages-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&scratch).expect("a folder");
    let source = scratch.join(format!("{name}.rs"));
    std::fs::write(&source, program).expect("written");
    let mut rustc = Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
    rustc.args(["--edition=2024", "--crate-type=lib", "--emit=metadata", "--color=never"]);
    for (name, library) in ["mpm_core", "mpm_materials"].into_iter().zip(libraries) {
        rustc.arg("--extern").arg(format!("{name}={}", library.display()));
    }
    rustc.arg("-L").arg(format!("dependency={}", folder.display()));
    // Long names of types go to files beside the output.
    rustc.arg("--out-dir").arg(&scratch).arg(&source);
    let said = rustc.output().expect("the compiler runs");
    let _ = std::fs::remove_dir_all(&scratch);
    // Paths are removed from names.
    String::from_utf8_lossy(&said.stderr).replace("mpm_core::", "")
}

/// Check that an invalid method causes one error, at this line, with this message and this advice.
fn refused(name: &str, dimensions: usize, method: &str, line: usize, message: &str, advice: &str) {
    let said = checked(name, &program(method, dimensions));
    let errors = said.lines().filter(|l| l.starts_with("error") && !l.starts_with("error: aborting"));
    let errors: Vec<&str> = errors.collect();
    assert_eq!(errors.len(), 1, "{method}: errors {errors:#?} in\n{said}");
    assert!(errors[0].contains(message), "{method}: `{message}` is not said, but\n{said}");
    assert!(
        said.lines().any(|l| l.contains("= note:") && l.contains(advice)),
        "{method}: no `{advice}` in\n{said}"
    );
    let place = said.lines().find(|l| l.trim_start().starts_with("-->")).unwrap_or_default();
    assert!(place.contains(&format!("{name}.rs:{line}:")), "{method}: reported at {place}");
}

#[test]
fn methods_that_can_be_compile() {
    for (name, dimensions, method) in [
        ("linear", 3, "Method::new(Linear, Flip, Musl, FullSpace)"),
        ("impact", 2, "Method::impact(Axisymmetric)"),
        ("elastic", 2, "Method::large_elastic(PlaneStrain)"),
        ("cpdi", 2, "Method::new(Cpdi, Flip, Usf, PlaneStrain).compiled()"),
        ("fmpm", 2, "Method::new(CubicBSpline, Fmpm::<16>, Usf, PlaneStrain).total_lagrangian().compiled()"),
        (
            "edge",
            2,
            "Method::new(BoundaryModified(Gimp), Flip, Usl, PlaneStrain).total_lagrangian().compiled()",
        ),
        ("blend", 3, "Method::new(CpGimp, Blend::new(1.0)?, Musl, FullSpace)"),
        ("mls", 3, "Method::new(QuadraticBSpline, Mls, Usl, FullSpace).mean_dilatation().compiled()"),
    ] {
        let said = checked(name, &program(method, dimensions));
        assert!(said.is_empty(), "{method}: {said}");
    }
}

#[test]
fn reference_configuration_refuses_domains_that_follow_the_strain() {
    let advice = "take `Gimp` for `CpGimp`, `Linear` or a B-spline for `Cpdi` and `Cpdi2`";
    for (n, shape) in ["Cpdi", "Cpdi2", "CpGimp", "BoundaryModified(CpGimp)"].into_iter().enumerate() {
        for (compiled, call) in ["", ".compiled()"].into_iter().enumerate() {
            let method = format!("Method::new({shape}, Flip, Musl, PlaneStrain).total_lagrangian(){call}");
            let named = shape.replace('(', "<").replace(')', ">");
            let message = format!("`.total_lagrangian()` cannot be used with the shape function `{named}`");
            refused(&format!("total_{n}_{compiled}"), 2, &method, 8, &message, advice);
        }
    }
}

#[test]
fn embeddings_of_other_dimensions_are_named() {
    let advice = "in two take `PlaneStrain` or `Axisymmetric`, in three `FullSpace`";
    for (name, dimensions, space) in
        [("flat", 2, "FullSpace"), ("deep", 3, "PlaneStrain"), ("round", 3, "Axisymmetric")]
    {
        let method = format!("Method::new(Linear, Flip, Musl, {space})");
        let message = format!("a scene of {dimensions} dimensions cannot have the method");
        refused(name, dimensions, &method, 9, &message, advice);
        let message = format!("`{space}` is not an embedding of {dimensions} dimensions");
        refused(
            &format!("{name}_compiled"),
            dimensions,
            &format!("{method}.compiled()"),
            9,
            &message,
            advice,
        );
    }
    refused(
        "impact",
        2,
        "Method::impact(FullSpace)",
        9,
        "a scene of 2 dimensions cannot have the method",
        advice,
    );
}

#[test]
fn stress_updates_and_transfers_that_do_not_go_together_are_named() {
    let mls = "`Mls` maps force and momentum together, which needs the stress of the same pass";
    let twice =
        "what filters the velocity (`Pic`, `Apic`, `Aflip`, `Mls`, `Fmpm`) would do so twice in a step";
    for (n, (update, transfer, advice)) in [
        ("Usf", "Mls", mls),
        ("Musl", "Mls", mls),
        ("Musl", "Mls", "take `Usl`, which goes with every transfer"),
        ("Musl", "Apic", twice),
        ("Musl", "Pic", twice),
        ("Musl", "Fmpm::<2>", twice),
    ]
    .into_iter()
    .enumerate()
    {
        let method = format!("Method::new(QuadraticBSpline, {transfer}, {update}, PlaneStrain)");
        let named = transfer.replace("::", "");
        let message =
            format!("`{update}` is not a stress update that can be used with the transfer `{named}`");
        refused(&format!("update_{n}"), 2, &method, 8, &message, advice);
        refused(&format!("update_{n}_compiled"), 2, &format!("{method}.compiled()"), 8, &message, advice);
    }
}

#[test]
fn shape_functions_and_transfers_that_do_not_go_together_are_named() {
    let affine = "take `QuadraticBSpline`, `CubicBSpline`, `Gimp` or `CpGimp`, or the transfer `Flip`";
    let order = "the order K of `Fmpm::<K>` must be 1 to 16";
    for (n, (shape, transfer, advice)) in [
        ("Linear", "Apic", affine),
        ("Linear", "Mls", affine),
        ("Cpdi", "Apic", affine),
        ("BoundaryModified(QuadraticBSpline)", "Apic", affine),
        ("QuadraticBSpline", "Fmpm::<0>", order),
        ("QuadraticBSpline", "Fmpm::<17>", order),
    ]
    .into_iter()
    .enumerate()
    {
        let method = format!("Method::new({shape}, {transfer}, Usl, PlaneStrain)");
        let [shape, transfer] =
            [shape, transfer].map(|text| text.replace("::", "").replace('(', "<").replace(')', ">"));
        let message =
            format!("`{transfer}` is not a transfer that can be used with the shape function `{shape}`");
        refused(&format!("shape_{n}"), 2, &method, 8, &message, advice);
        refused(&format!("shape_{n}_compiled"), 2, &format!("{method}.compiled()"), 8, &message, advice);
    }
}

#[test]
fn methods_that_are_not_compiled_say_how() {
    let method = "Method::new(CubicBSpline, Flip, Usl, PlaneStrain)";
    let message = "its kernels are not compiled in `mpm-core`";
    refused(
        "compile",
        2,
        method,
        9,
        message,
        "compile the kernels in your crate, once, for some seconds: `method.compiled()`",
    );
}
