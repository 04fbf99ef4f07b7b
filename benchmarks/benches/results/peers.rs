//! Comparison with public programs: Taichi and Warp from the Python package registry, and a kernel in C.

use std::path::Path;
use std::process::Command;

use benchmarks::Stepped;
use examples::CaseError;
use examples::peers::{Asked, FOLDER, Peer};
use examples::throughput::{Job, Kernel, Spread, Way, printed, timed};
use mpm_core::{FullSpace, Method, Mls, QuadraticBSpline, Usl};
use mpm_materials::{LinearElastic, Moduli, NeoHookean};

use crate::page::table;
use crate::sample::{Subject, alternate};
use crate::scenes::{blocks, linear_flip};

/// Run another particle program on one thread for `steps` steps at a spacing (mm): `peers/particles.py`.
pub fn of_particles(python: &Path, program: &str, spacing: f64, steps: u64) -> Result<Stepped, CaseError> {
    let mut command = Command::new(python);
    command.arg(format!("{FOLDER}/particles.py")).arg(program);
    command.args(["--spacing", &spacing.to_string(), "--steps", &steps.to_string()]);
    let found = printed(&mut command)?;
    let number = |key: &str| {
        found[key]
            .as_f64()
            .ok_or_else(|| CaseError::Other(format!("{program}: no number `{key}` in {found}")))
    };
    let (points, steps) = (number("particles")? as usize, number("steps")? as u64);
    Ok(Stepped { points, steps, seconds: number("seconds")?, bytes: 0 })
}

/// Run the kernel in C; return the number after "Mpups", its own median of three.
fn rate(command: &mut Command) -> Option<f64> {
    let output = command.output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let after = text.lines().find_map(|line| line.split("Mpups ").nth(1))?;
    after.split_whitespace().next()?.parse().ok()
}

/// Compare with the other programs on two elastic blocks.
pub fn compare(quick: bool, python: &Path) -> Result<Option<String>, CaseError> {
    let steps = if quick { 30 } else { 100 };
    let present: Vec<Peer> = Peer::ALL.into_iter().filter(|p| p.version(python).is_some()).collect();
    let folder = std::env::temp_dir().join(format!("impactite-peers-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|source| CaseError::File { path: folder.clone(), source })?;
    let compiled = folder.join("ref_hat");
    let has_c = Command::new("cc")
        .args(["-O3", "-march=native", "-ffast-math", "-fopenmp", "-DMUSL", "-o"])
        .arg(&compiled)
        .arg(format!("{FOLDER}/ref_hat.c"))
        .arg("-lm")
        .output()
        .is_ok_and(|o| o.status.success());

    let moduli = || Moduli::young_poisson(100.0, 0.3);
    let mut rows = Vec::new();
    let absent = Peer::ALL.into_iter().filter(|p| !present.contains(p));
    let mut missing: Vec<&str> = absent.map(Peer::name).collect();
    for threads in [1, 2] {
        let way = Way::default();
        let job = Job { kernel: Kernel::LinearMuslElastic, particles: 200_000, threads, steps, way };
        let samples = alternate(
            &[
                Subject::new("MUSL, linear shape functions, FLIP, linear elastic", || {
                    timed(&job, blocks(linear_flip(), LinearElastic::new(1.0, moduli()?)?)?)
                }),
                Subject::new("USL, quadratic, APIC, neo-Hookean", || {
                    let method = Method::new(QuadraticBSpline, Mls, Usl, FullSpace);
                    timed(&job, blocks(method, NeoHookean::new(1.0, moduli()?)?)?)
                }),
            ],
            3,
        )?;
        let kernels = [Kernel::LinearMuslElastic, Kernel::QuadraticApicUsl];
        for (kernel, sample) in kernels.into_iter().zip(&samples) {
            let ours = sample.rates();
            let mut add = |who: &str, theirs: Option<f64>| match theirs {
                Some(theirs) => rows.push([
                    sample.name.clone(),
                    threads.to_string(),
                    ours.text(1),
                    who.into(),
                    format!("{theirs:.1}"),
                    format!("{:.1}", ours.median / theirs),
                ]),
                None => eprintln!("{who}: its program failed"),
            };
            for &peer in present.iter().filter(|p| p.most_threads() >= threads) {
                let asked = Asked { kernel, cube: None, threads, steps, repeat: 3 };
                let rates = peer.throughput(python, &asked).map_err(|error| eprintln!("{error}")).ok();
                add(peer.name(), rates.map(|(rates, _)| 1e-6 * Spread::of(rates.into_iter()).median));
            }
            if has_c && kernel == Kernel::LinearMuslElastic {
                let (threads, steps) = (threads.to_string(), steps.to_string());
                let run = || rate(Command::new(&compiled).args([&threads, &steps]));
                let rates: Vec<f64> = (0..3).filter_map(|_| run()).collect();
                add("C, by hand", (!rates.is_empty()).then(|| Spread::of(rates.into_iter()).median));
            }
        }
    }
    if !has_c {
        missing.push("a C compiler with OpenMP");
    }
    let _ = std::fs::remove_dir_all(&folder);
    let absent = if missing.is_empty() {
        String::new()
    } else {
        format!(" Absent on this machine: {}.", missing.join(", "))
    };
    Ok(Some(format!(
        "## Peers\n\nTwo elastic blocks, 200 000 particles, f64, {steps} steps: our programs for packages that anybody \
         can install (`benchmarks/peers`), Taichi and Warp on the processor (Warp runs a kernel on one thread), and a kernel \
         in C written by hand; each the median of three runs. None of them sorts in 2 x 2 x 2 blocks, keeps books or \
         checks for failures.{absent}\n\n{}",
        table(["scheme", "threads", "ours", "peer", "its rate", "ours / its"], &rows)
    )))
}
