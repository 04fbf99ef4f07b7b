//! Throughput: particle-steps per second, by the program `throughput` of the examples, which provides the scenes.

use std::path::{Path, PathBuf};
use std::process::Command;

use clap::ValueEnum;
use examples::peers::{self, Peer};
use examples::throughput::Kernel;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Kernels of `throughput`.
pub const KERNELS: [&str; 3] = ["linear-musl-elastic", "linear-musl-johnson-cook", "quadratic-apic-usl"];

/// Requested throughput run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// Peer whose program runs; none for this library.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peer: Option<Peer>,
    /// Kernel: computation of a step.
    pub kernel: String,
    /// Approximate number of particles.
    pub particles: u64,
    /// Number of threads.
    pub threads: usize,
    /// Floating-point precision, bits.
    pub bits: u32,
}

/// Measured throughput.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Speed {
    /// Requested run.
    #[serde(flatten)]
    pub asked: Asked,
    /// Actual number of particles.
    pub count: u64,
    /// Number of timed steps.
    pub steps: u64,
    /// Particle-steps per second of every repeat, wall-clock time.
    pub rates: Vec<f64>,
    /// Memory per particle including grid and scratch, bytes.
    pub bytes: f64,
    /// Commit of the program.
    pub commit: String,
}

impl Asked {
    /// List all kernels in both precisions on one and more threads, with these particle numbers.
    pub fn all(sizes: &[u64]) -> Vec<Asked> {
        let mut list = Vec::new();
        for &particles in sizes {
            for kernel in KERNELS {
                for bits in [64, 32] {
                    for threads in [1, 2] {
                        list.push(Asked { peer: None, kernel: kernel.into(), particles, threads, bits });
                    }
                }
            }
        }
        list
    }

    /// List the kernels with a program of a peer, in double precision on the numbers of threads that both support.
    pub fn of_peer(peer: Peer, sizes: &[u64]) -> Vec<Asked> {
        let ours = Asked::all(sizes).into_iter().filter(|a| a.bits == 64 && a.threads <= peer.most_threads());
        let known = ours.filter(|a| a.kernel != Kernel::LinearMuslJohnsonCook.name());
        known.map(|asked| Asked { peer: Some(peer), ..asked }).collect()
    }

    /// Name of its line.
    pub fn name(&self) -> String {
        let name = format!("{}, f{}", self.kernel, self.bits);
        self.peer.map_or(name.clone(), |peer| format!("{}: {name}", peer.name()))
    }

    /// Number of steps for about `particle_steps`.
    fn steps(&self, particle_steps: u64) -> u64 {
        (particle_steps / self.particles).clamp(4, 1000)
    }

    /// Run the program `repeats` times.
    ///
    /// # Errors
    /// The program does not run.
    pub fn make(
        &self,
        program: &Path,
        folder: &Path,
        repeats: u32,
        commit: &str,
    ) -> Result<Speed, Box<dyn std::error::Error>> {
        let steps = self.steps(4_000_000);
        let output = Command::new(program)
            .args(["--kernel", &self.kernel, "--particles", &self.particles.to_string()])
            .args(["--threads", &self.threads.to_string(), "--steps", &steps.to_string()])
            .args(["--precision", &format!("f{}", self.bits), "--repeat", &repeats.to_string(), "--out"])
            .arg(folder)
            .output()?;
        let text = String::from_utf8_lossy(&output.stdout);
        let runs = text.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
        let runs: Vec<Value> = runs.filter(|v| v["particle_updates_per_second"].is_number()).collect();
        let first = runs
            .first()
            .ok_or_else(|| format!("{}: {}", program.display(), String::from_utf8_lossy(&output.stderr)))?;
        Ok(Speed {
            asked: self.clone(),
            count: first["particles"].as_u64().unwrap_or_default(),
            steps,
            rates: runs.iter().filter_map(|v| v["particle_updates_per_second"].as_f64()).collect(),
            bytes: first["total_bytes_per_particle"].as_f64().unwrap_or(f64::NAN),
            commit: commit.into(),
        })
    }
}

/// Run a peer's program `repeats` times, each for about `particle_steps`.
///
/// # Errors
/// The program fails, or the peer has none for the kernel.
pub fn of_peer(
    (peer, asked): (Peer, &Asked),
    python: &Path,
    (repeats, particle_steps): (u32, u64),
    commit: &str,
) -> Result<Speed, Box<dyn std::error::Error>> {
    let steps = asked.steps(particle_steps);
    let wanted = peers::Asked {
        kernel: Kernel::from_str(&asked.kernel, false)?,
        cube: Some(asked.particles),
        threads: asked.threads,
        steps,
        repeat: repeats,
    };
    let (rates, said) = peer.throughput(python, &wanted)?;
    Ok(Speed {
        asked: asked.clone(),
        count: said["particles"].as_u64().unwrap_or_default(),
        steps,
        rates,
        bytes: said["total_bytes_per_particle"].as_f64().unwrap_or(f64::NAN),
        commit: commit.into(),
    })
}

impl Speed {
    /// Best rate of the repeats.
    pub fn best(&self) -> f64 {
        self.rates.iter().copied().fold(f64::NAN, f64::max)
    }
    /// Timing noise: relative difference of the best even and the best odd repeat.
    pub fn band(&self) -> Option<f64> {
        let best = |odd: usize| self.rates.iter().skip(odd).step_by(2).copied().reduce(f64::max);
        Some((best(0)? / best(1)? - 1.0).abs())
    }
}

/// Path of the program `throughput` beside this one; builds it if necessary.
///
/// # Errors
/// The build fails.
pub fn program() -> Result<PathBuf, Box<dyn std::error::Error>> {
    let own = std::env::current_exe()?;
    let there = own.with_file_name(format!("throughput{}", std::env::consts::EXE_SUFFIX));
    // Rebuild if files have changed, so that both programs are of one commit.
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let built = Command::new(cargo)
        .args(["build", "--quiet", "--release", "-p", "examples", "--bin", "throughput"])
        .status();
    let built = built.is_ok_and(|status| status.success());
    if !built && !there.exists() {
        return Err(format!("{} is not there and cannot be built", there.display()).into());
    }
    Ok(there)
}
