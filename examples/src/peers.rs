//! Benchmark programs of this project for public packages (`benchmarks/peers`), run as child processes.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::CaseError;
use crate::throughput::Kernel;

/// Folder of the programs.
pub const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../benchmarks/peers");

/// Python package that can run a scene of this project on the processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Peer {
    /// Taichi.
    Taichi,
    /// NVIDIA Warp, whose processor backend runs a kernel on one thread.
    Warp,
}

impl Peer {
    /// All packages.
    pub const ALL: [Peer; 2] = [Peer::Taichi, Peer::Warp];

    /// Name of the package.
    pub fn name(self) -> &'static str {
        match self {
            Peer::Taichi => "Taichi",
            Peer::Warp => "Warp",
        }
    }

    /// Name of the Python module, and prefix of its programs.
    fn module(self) -> &'static str {
        match self {
            Peer::Taichi => "taichi",
            Peer::Warp => "warp",
        }
    }

    /// Command that installs the package.
    pub fn remedy(self) -> &'static str {
        match self {
            Peer::Taichi => "pip install taichi numpy",
            Peer::Warp => "pip install warp-lang numpy",
        }
    }

    /// Maximum number of threads of a kernel.
    pub fn most_threads(self) -> usize {
        match self {
            Peer::Taichi => usize::MAX,
            Peer::Warp => 1,
        }
    }

    /// Return the version; `None`, with a message on standard error, if Python or the package is absent.
    pub fn version(self, python: &Path) -> Option<String> {
        let module = self.module();
        let script = format!(
            "import numpy, {module}; v = {module}.__version__; print(v if isinstance(v, str) else '.'.join(map(str, v)))"
        );
        let output = Command::new(python).args(["-c", &script]).output().ok().filter(|o| o.status.success());
        let said = output.map(|o| String::from_utf8_lossy(&o.stdout).into_owned());
        // Taichi prints a greeting first.
        let version = said.and_then(|text| text.lines().last().map(|line| line.trim().to_string()));
        if version.is_none() {
            let (name, python, remedy) = (self.name(), python.display(), self.remedy());
            eprintln!("{name} is left out: `{python}` does not have it; `{remedy}` brings it");
        }
        version
    }

    /// Run a program of the package, `throughput` or `axes`, and pass each object that it prints to `each`.
    ///
    /// # Errors
    /// Program that does not run or fails; first error of `each`, which stops the program.
    pub fn run(
        self,
        python: &Path,
        program: &str,
        arguments: &[String],
        each: &mut dyn FnMut(Value) -> Result<(), CaseError>,
    ) -> Result<(), CaseError> {
        let file = format!("{FOLDER}/{}_{program}.py", self.module());
        let fail = |what: &str| CaseError::Other(format!("{} {file}: {what}", python.display()));
        let mut child = Command::new(python)
            .arg(&file)
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|e| fail(&e.to_string()))?;
        let (Some(said), Some(mut trouble)) = (child.stdout.take(), child.stderr.take()) else {
            return Err(fail("its output cannot be read"));
        };
        // Read in a thread of its own, so that neither pipe fills.
        let trouble = std::thread::spawn(move || {
            let mut text = Vec::new();
            let _ = trouble.read_to_end(&mut text);
            String::from_utf8_lossy(&text).trim().to_string()
        });
        for line in BufReader::new(said).lines() {
            let taken =
                line.map_err(|e| fail(&e.to_string())).and_then(|l| object(&l).map_or(Ok(()), &mut *each));
            if let Err(error) = taken {
                let _ = child.kill();
                let _ = child.wait();
                return Err(error);
            }
        }
        let ended = child.wait().map_err(|e| fail(&e.to_string()))?;
        if ended.success() { Ok(()) } else { Err(fail(&trouble.join().unwrap_or_default())) }
    }

    /// Measure the particle updates a second of the package's program for a kernel, for each repeat: on a cube of about so many particles
    /// ([`crate::throughput::cube`]), or on two blocks. The second result is the object that the program prints.
    ///
    /// # Errors
    /// Errors of [`Peer::run`]; kernel without a program; program that prints no rates.
    pub fn throughput(self, python: &Path, asked: &Asked) -> Result<(Vec<f64>, Value), CaseError> {
        let scheme = match asked.kernel {
            Kernel::LinearMuslElastic => "musl",
            Kernel::QuadraticApicUsl => "mls",
            Kernel::LinearMuslJohnsonCook => {
                let name = asked.kernel.name();
                return Err(CaseError::Other(format!("{}: there is no program for {name}", self.name())));
            }
        };
        let mut arguments = vec![scheme.to_string()];
        let mut option = |name: &str, value: u64| arguments.extend([format!("--{name}"), value.to_string()]);
        option("threads", asked.threads as u64);
        option("steps", asked.steps);
        option("repeat", u64::from(asked.repeat));
        if let Some(particles) = asked.cube {
            option("cube", particles);
        }
        let mut last = None;
        self.run(python, "throughput", &arguments, &mut |line| {
            last = Some(line);
            Ok(())
        })?;
        let rates = last.as_ref().and_then(|line| line["particle_updates_per_second"].as_array());
        let rates: Vec<f64> = rates.into_iter().flatten().filter_map(Value::as_f64).collect();
        match last {
            Some(line) if !rates.is_empty() => Ok((rates, line)),
            _ => Err(CaseError::Other(format!("{}: the program printed no rates", self.name()))),
        }
    }
}

/// Options of a throughput program, in double precision.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// Kernel of a step.
    pub kernel: Kernel,
    /// Approximate number of particles in a cube; two blocks of 200 000 together if `None`.
    pub cube: Option<u64>,
    /// Number of threads.
    pub threads: usize,
    /// Number of timed steps.
    pub steps: u64,
    /// Number of runs.
    pub repeat: u32,
}

/// Parse the object in a line; `None` for other output of packages.
pub fn object(line: &str) -> Option<Value> {
    serde_json::from_str::<Value>(line).ok().filter(Value::is_object)
}
