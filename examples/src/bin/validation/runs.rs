//! Cases as child processes, and their results as files.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use examples::{CaseError, Resolution, machine};
use serde_json::Value;

/// Names of all cases; `throughput` is excluded, since it measures speed only.
pub const CASES: [&str; 37] = [
    "taylor_bar",
    "taylor_copper",
    "taylor_4340",
    "expanding_ring",
    "elastic_bar",
    "plate_impact",
    "tnt_slab",
    "tnt_cased",
    "exploding_cylinder",
    "debris_cloud",
    "debris_cloud_2d",
    "debris_cloud_3d",
    "oblique_penetration",
    "concrete_perforation",
    "reinforced_slab",
    "tungsten_bullet",
    "plug_weldox",
    "granular_column",
    "slope_failure",
    "gate_flow",
    "wedge_entry",
    "dam_break",
    "sloshing",
    "floating_box",
    "drop",
    "taylor_green",
    "ring_collision",
    "bouncing_blocks",
    "rolling_cylinder",
    "ball_on_plate",
    "pressed_balls",
    "shaken_discs",
    "kalthoff",
    "glass_branching",
    "pcmm_distortion",
    "wave_plate",
    "cantilever_pulse",
];

const RESOLUTIONS: [(Resolution, &str); 3] =
    [(Resolution::Smoke, "smoke"), (Resolution::Standard, "standard"), (Resolution::Paper, "paper")];

/// Results of a case.
#[derive(Clone, Debug)]
pub struct Run {
    pub case: String,
    pub resolution: String,
    /// JSON object of a completed case.
    pub result: Value,
    /// Reason for a missing result.
    pub broken: Option<String>,
    /// Processor time, s, including start, pictures and files.
    pub core_seconds: f64,
}

fn name_of(resolution: Resolution) -> &'static str {
    RESOLUTIONS.iter().find(|(r, _)| *r == resolution).map_or("smoke", |(_, name)| name)
}

impl Run {
    /// Run the case `name`; its files are written to a folder in `out`.
    ///
    /// # Errors
    /// Missing program, or files that cannot be written.
    pub fn make(
        name: &str,
        resolution: Resolution,
        threads: Option<u16>,
        limit: Duration,
        out: &Path,
    ) -> Result<Run, CaseError> {
        let program = program(name)?;
        let folder = out.join(name_of(resolution)).join(name);
        let failed = |path: &Path| {
            let path = path.to_path_buf();
            move |source| CaseError::File { path, source }
        };
        std::fs::create_dir_all(&folder).map_err(failed(&folder))?;
        // Output to files, so that no full pipe blocks the case.
        let [text, errors] = ["output.txt", "errors.txt"].map(|f| folder.join(f));
        let mut command = Command::new(&program);
        command.args(["--resolution", name_of(resolution), "--json", "--out"]).arg(&folder);
        if let Some(threads) = threads {
            command.args(["--threads", &threads.to_string()]);
        }
        command.stdin(Stdio::null());
        command.stdout(File::create(&text).map_err(failed(&text))?);
        command.stderr(File::create(&errors).map_err(failed(&errors))?);
        let before = machine::children_seconds();
        let start = Instant::now();
        let mut child = command.spawn().map_err(failed(&program))?;
        let mut broken = None;
        loop {
            if child.try_wait().map_err(failed(&program))?.is_some() {
                break;
            }
            if start.elapsed() > limit {
                child.kill().map_err(failed(&program))?;
                child.wait().map_err(failed(&program))?;
                broken = Some(format!("not finished after {:.0} s", limit.as_secs_f64()));
                break;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        let wall = start.elapsed().as_secs_f64();
        let used = machine::children_seconds().zip(before).map(|(now, before)| now - before);
        let output = std::fs::read_to_string(&text).map_err(failed(&text))?;
        let result = output.lines().next_back().and_then(|line| serde_json::from_str::<Value>(line).ok());
        let result = result.filter(|r| r["case"] == name);
        if result.is_none() && broken.is_none() {
            let said = std::fs::read_to_string(&errors).map_err(failed(&errors))?;
            let error = said.lines().rev().find(|l| l.starts_with("error"));
            broken = Some(error.unwrap_or("it ended without a result").to_string());
        }
        Ok(Run {
            case: name.into(),
            resolution: name_of(resolution).into(),
            result: if broken.is_some() { Value::Null } else { result.unwrap_or(Value::Null) },
            broken,
            core_seconds: used.unwrap_or(wall),
        })
    }

    /// Return a line for the terminal.
    pub fn summary(&self) -> String {
        match &self.broken {
            Some(why) => format!("BROKE OFF: {why}"),
            None => {
                let Counts { met, missed, declared, shown, unjudged } = self.counts();
                format!(
                    "{met} of {} met, {missed} missed ({declared} declared); {shown} shown, {unjudged} not judged at this \
                     resolution; {:.1} core-seconds",
                    met + missed,
                    self.core_seconds
                )
            }
        }
    }

    /// Return its checks in the order of the case, failed ones first.
    pub fn checks(&self) -> &[Value] {
        self.result["checks"].as_array().map_or(&[], Vec::as_slice)
    }

    /// Return the checks that the case did not evaluate.
    pub fn unjudged(&self) -> &[Value] {
        self.result["not_judged"].as_array().map_or(&[], Vec::as_slice)
    }

    /// Count the checks by result.
    pub fn counts(&self) -> Counts {
        let count = |of: &dyn Fn(&Value) -> bool| self.checks().iter().filter(|c| of(c)).count();
        Counts {
            met: count(&|c| c["pass"] == true),
            missed: count(&|c| c["pass"] == false),
            declared: count(&|c| c["pass"] == false && c["known"].is_string()),
            shown: count(&|c| c["pass"].is_null()),
            unjudged: self.unjudged().len(),
        }
    }

    /// True if the case completed, and only declared checks failed.
    pub fn passed(&self) -> bool {
        let counts = self.counts();
        self.broken.is_none() && counts.missed == counts.declared
    }
}

/// Numbers of checks of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    pub met: usize,
    /// All failed checks.
    pub missed: usize,
    /// Failed checks with a declared reason.
    pub declared: usize,
    /// Checks from memory, or without a reference.
    pub shown: usize,
    /// Checks not evaluated at this resolution.
    pub unjudged: usize,
}

/// Return the path of the program of a case, in the folder of this one.
fn program(name: &str) -> Result<PathBuf, CaseError> {
    let here = std::env::current_exe().map_err(|e| CaseError::Other(e.to_string()))?;
    let path = here.with_file_name(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    if path.is_file() {
        return Ok(path);
    }
    Err(CaseError::Other(format!("{name} is not built: cargo build --release -p examples --bins")))
}
