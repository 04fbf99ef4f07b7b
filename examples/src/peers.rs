//! Programs of ours for packages that anybody can install (`benchmarks/peers`), run as children.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::CaseError;
use crate::throughput::Kernel;

/// Where the programs are.
pub const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../benchmarks/peers");

/// A package of Python that can run a scene of ours on the processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Peer {
    /// Taichi.
    Taichi,
    /// NVIDIA Warp, whose processor backend runs a kernel on one thread.
    Warp,
}

impl Peer {
    /// All.
    pub const ALL: [Peer; 2] = [Peer::Taichi, Peer::Warp];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Peer::Taichi => "Taichi",
            Peer::Warp => "Warp",
        }
    }

    /// How Python imports it, and the beginning of its programs' names.
    fn module(self) -> &'static str {
        match self {
            Peer::Taichi => "taichi",
            Peer::Warp => "warp",
        }
    }

    /// What brings it.
    pub fn remedy(self) -> &'static str {
        match self {
            Peer::Taichi => "pip install taichi numpy",
            Peer::Warp => "pip install warp-lang numpy",
        }
    }

    /// The most threads that it runs a kernel on.
    pub fn most_threads(self) -> usize {
        match self {
            Peer::Taichi => usize::MAX,
            Peer::Warp => 1,
        }
    }

    /// Its version; none, with a message on standard error, if Python or the package is absent.
    pub fn version(self, python: &Path) -> Option<String> {
        let module = self.module();
        let script = format!(
            "import numpy, {module}; v = {module}.__version__; print(v if isinstance(v, str) else '.'.join(map(str, v)))"
        );
        let output = Command::new(python).args(["-c", &script]).output().ok().filter(|o| o.status.success());
        let said = output.map(|o| String::from_utf8_lossy(&o.stdout).into_owned());
        // Taichi greets before.
        let version = said.and_then(|text| text.lines().last().map(|line| line.trim().to_string()));
        if version.is_none() {
            let (name, python, remedy) = (self.name(), python.display(), self.remedy());
            eprintln!("{name} is left out: `{python}` does not have it; `{remedy}` brings it");
        }
        version
    }

    /// Run one of its programs, `throughput` or `axes`, and hand every object that it prints to `each`.
    ///
    /// # Errors
    /// A program that does not run or fails, and the first error of `each`, which ends the program.
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
        // Beside the other one, so that neither pipe fills.
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

    /// Particle updates a second of its own program for a kernel, each repeat: on a cube of about so many particles
    /// ([`crate::throughput::cube`]), or on two blocks. And all else that the program says.
    ///
    /// # Errors
    /// As [`Peer::run`]; a kernel that it has no program for; a program that prints no rates.
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

/// What a program of throughput is asked for; in double precision.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// What a step computes.
    pub kernel: Kernel,
    /// About so many particles in a cube; two blocks of 200 000 where there is none.
    pub cube: Option<u64>,
    /// Threads.
    pub threads: usize,
    /// Steps that are timed.
    pub steps: u64,
    /// Runs.
    pub repeat: u32,
}

/// The object that a line holds; none of what packages say of themselves.
pub fn object(line: &str) -> Option<Value> {
    serde_json::from_str::<Value>(line).ok().filter(Value::is_object)
}
