//! Speed and memory benchmarks, measured in one run and written to `RESULTS.md` beside this crate.
//!
//! ```text
//! cargo bench -p benchmarks --bench results -- [--quick] [--yardstick PROGRAM] [--native PROGRAM] [--section NAME,..] [--out FILE]
//! cargo bench -p benchmarks --bench results -- --section ways --throughput PROGRAM [--previous PROGRAM] [--quick]
//! cargo bench -p benchmarks --bench results -- --section runs --program PROGRAM [--previous PROGRAM] [--quick]
//! cargo bench -p benchmarks --bench results -- --section compile,tests,ci [--before COMMIT,..]
//! ```
//!
//! Compared programs run in alternation in this process or as child processes, for several rounds; the page shows
//! medians with minimum and maximum. Sections that are not requested keep their text.

mod compile;
mod contact;
mod cycle;
mod elements;
mod fragile;
mod kernels;
mod page;
mod parts;
mod peers;
mod runs;
mod sample;
mod scenes;
mod search;
mod smoothed;
mod water;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use examples::{CaseError, case};

use page::Page;

/// Measure speed and memory, and write them down.
#[derive(Debug, Parser)]
#[command(name = "results", version)]
struct Options {
    /// Small scenes and few rounds: some minutes
    #[arg(long)]
    quick: bool,
    /// Sections, separated by commas [default: all but `compile`, `tests` and `ci`]
    #[arg(long, value_enum, value_delimiter = ',')]
    section: Vec<Section>,
    /// A built yardstick of hand-written kernels to compare with
    #[arg(long, value_name = "PROGRAM")]
    yardstick: Option<PathBuf>,
    /// Our `throughput` built with `-C target-cpu=native`, to be measured beside
    #[arg(long, value_name = "PROGRAM")]
    native: Option<PathBuf>,
    /// Our `throughput` as built now, for the section `ways`
    #[arg(long, value_name = "PROGRAM")]
    throughput: Option<PathBuf>,
    /// Our `impactite` as built now, for the section `runs`
    #[arg(long, value_name = "PROGRAM")]
    program: Option<PathBuf>,
    /// Our `throughput`, or `impactite`, built at another commit, to be measured beside
    #[arg(long, value_name = "PROGRAM")]
    previous: Option<PathBuf>,
    /// Python with the packages of peers
    #[arg(long, value_name = "PROGRAM", default_value = "python3")]
    python: PathBuf,
    /// Python with PySPH
    #[arg(long, value_name = "PROGRAM", default_value = "/usr/bin/python3")]
    pysph: PathBuf,
    /// Commits whose compile times to measure beside those of HEAD, separated by commas
    #[arg(long, value_name = "COMMIT", value_delimiter = ',')]
    before: Vec<String>,
    /// The page
    #[arg(long, value_name = "FILE", default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/RESULTS.md"))]
    out: PathBuf,
    /// The chart of the section `cycle`
    #[arg(long, value_name = "FILE", default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/book/src/pictures/sph_cycle.png"))]
    chart: PathBuf,
    /// What cargo passes
    #[arg(long, hide = true)]
    bench: bool,
}

/// A part of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Section {
    /// The same job twice: what a difference must exceed to be one
    Noise,
    /// Ours against hand-written kernels
    Yardstick,
    /// The law behind a call, and inlined
    Ways,
    /// The program on scene files, with all that it writes
    Runs,
    /// Cost a particle over the number of particles
    Sizes,
    /// Shape functions, transfers, precisions, memory
    Compositions,
    /// Memory and speed of laws
    Laws,
    /// Laws whose parts are chosen at run time
    Parts,
    /// Single against double precision: gain and error
    Single,
    /// What contact and its absence cost
    Contact,
    /// Blocks of nodes against a dense grid
    Sparse,
    /// Programs that others can install
    Peers,
    /// Finite elements beside material points, and contact of them
    Elements,
    /// Smoothed particles, and other programs beside them
    Smoothed,
    /// Fragile points, elements and peridynamics beside them, and what opening a face takes
    Fragile,
    /// Searches for neighbours
    Search,
    /// What a step of smoothed particles is made of
    Cycle,
    /// Incompressible flow: rates, stages, memory, and another program beside it
    Water,
    /// Times of compilers
    Compile,
    /// Time of all tests, compilers included
    Tests,
    /// Time of `.ci/run`
    Ci,
}

fn main() -> ExitCode {
    case::start(run)
}

fn run(options: &Options) -> Result<ExitCode, CaseError> {
    let long = [Section::Compile, Section::Tests, Section::Ci];
    let all = Section::value_variants().iter().filter(|s| !long.contains(s)).copied();
    let wanted: Vec<Section> =
        if options.section.is_empty() { all.collect() } else { options.section.clone() };
    let mut page = Page::open(&options.out)?;
    for section in wanted {
        eprintln!("{section:?} ...");
        let text = match section {
            Section::Noise => kernels::noise(options.quick)?,
            Section::Yardstick => {
                kernels::yardstick(options.quick, options.yardstick.as_deref(), options.native.as_deref())?
            }
            Section::Ways => {
                kernels::ways(options.quick, options.throughput.as_deref(), options.previous.as_deref())?
            }
            Section::Runs => {
                runs::cost(options.quick, options.program.as_deref(), options.previous.as_deref())?
            }
            Section::Sizes => kernels::sizes(options.quick)?,
            Section::Compositions => kernels::compositions(options.quick)?,
            Section::Laws => kernels::laws(options.quick)?,
            Section::Parts => parts::cost(options.quick)?,
            Section::Single => kernels::single(options.quick)?,
            Section::Contact => contact::cost(options.quick, options.yardstick.as_deref())?,
            Section::Sparse => contact::sparse(options.quick)?,
            Section::Peers => peers::compare(options.quick, &options.python)?,
            Section::Elements => elements::cost(options.quick)?,
            Section::Smoothed => smoothed::cost(options.quick, &options.python, &options.pysph)?,
            Section::Fragile => fragile::cost(options.quick, &options.python)?,
            Section::Search => search::times(options.quick)?,
            Section::Cycle => cycle::shares_of_steps(options.quick, &options.chart)?,
            Section::Water => water::cost(options.quick, &options.python)?,
            Section::Compile => compile::times(&options.before)?,
            Section::Tests => compile::tests(false)?,
            Section::Ci => compile::tests(true)?,
        };
        let Some(text) = text else { continue };
        page.put(&format!("{section:?}").to_lowercase(), &text);
        page.save()?;
    }
    println!("{}", options.out.display());
    Ok(ExitCode::SUCCESS)
}
