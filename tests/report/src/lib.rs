//! Error-work charts: runs the sweeps and writes a page.
//!
//! A [`job`] is a run with a key; a [`sweep`] is the jobs of a chart. [`record`]s are lines of a file, so that a stopped sweep can be
//! resumed. [`counts`] has instructions by callgrind, [`speed`] throughput, [`map`] the verdicts of the stability scenes, [`study`] the
//! methods recommended in README in scenes with known failures, [`price`] the cost of an error of one per cent, [`peers`] runs of programs
//! for Taichi and Warp. [`page`] assembles the page.

pub mod chart;
pub mod contact;
pub mod counts;
pub mod front;
pub mod gates;
pub mod job;
pub mod limits;
pub mod long;
pub mod map;
pub mod page;
pub mod peers;
pub mod pool;
pub mod price;
pub mod rates;
pub mod record;
pub mod soil;
pub mod speed;
pub mod study;
pub mod sweep;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use examples::peers::Peer;
use examples::{CaseError, machine};
use verification::origin::said_by;
use verification::problems::gates::Gate;
use verification::stored;

use counts::Count;
use job::{Job, Key};
use peers::Package;
use record::Record;
use speed::Speed;

/// Error against work: runs problems of known solution with every scheme, and writes a page of charts with its data.
///
/// Runs are written down one by one; stopped and started again, the sweep goes on where it was.
#[derive(Debug, Parser)]
#[command(name = "report", version)]
struct Options {
    /// A sweep of some minutes instead of one for the night
    #[arg(long)]
    quick: bool,
    /// Charts to make runs for, as C1,C5 [default: all]
    #[arg(long, value_name = "C", value_delimiter = ',')]
    charts: Vec<String>,
    /// Runs at a time, each on one thread [default: one a processor]
    #[arg(long, value_name = "N")]
    threads: Option<std::num::NonZeroUsize>,
    /// Python with the packages of peers, Taichi and Warp; what is absent is left out
    #[arg(long, value_name = "PROGRAM", default_value = "python3")]
    python: PathBuf,
    /// Folder for page and data
    #[arg(long, value_name = "DIR", default_value = "out/report")]
    out: PathBuf,
    /// Keep runs that programs of other commits made, and make only what is not there at all
    #[arg(long)]
    keep: bool,
    /// Write the page from the runs there are, without new ones
    #[arg(long)]
    draw: bool,
    /// Instead of all this: run the stored cases and print their table (tests/verification/data/errors.csv)
    #[arg(long)]
    store: bool,
    /// Instead of all this: run one job, for callgrind
    #[arg(long, hide = true)]
    count: Option<String>,
}

type Made<T> = Result<T, Box<dyn std::error::Error>>;

/// Run the program.
pub fn start() -> ExitCode {
    let options = Options::parse();
    match run(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Charts without runs of their own, or with other runs.
const OTHERS: [&str; 4] = ["C9", "C10", "C11", "C12"];

fn run(options: &Options) -> Made<()> {
    if let Some(text) = &options.count {
        let key: Key = serde_json::from_str(text)?;
        println!("{}", Job::of(&key).map_or(0.0, |job| job.scaled().particle_steps()));
        return Ok(());
    }
    if options.store {
        print!("{}", stored::table());
        return Ok(());
    }
    let charts = sweep::charts();
    let known = |c: &str| OTHERS.contains(&c) || charts.iter().any(|chart| chart.number == c);
    if let Some(wrong) = options.charts.iter().find(|c| !known(c)) {
        let mut list: Vec<&str> = charts.iter().map(|c| c.number).chain(OTHERS).collect();
        list.dedup();
        return Err(format!("--charts {wrong} is not allowed; it must be of {}", list.join(", ")).into());
    }
    fs::create_dir_all(&options.out)?;
    let commit = machine::commit();
    let files = Files::new(&options.out);
    if !options.draw {
        let sweeper = Sweeper { options, commit: &commit, files: &files, start: Instant::now() };
        let packages = Package::all(&options.python);
        sweeper.runs(&charts)?;
        sweeper.limits()?;
        sweeper.speeds()?;
        sweeper.peers(&packages)?;
        sweeper.counts(&charts)?;
        sweeper.band(packages)?;
        println!("swept in {:.1} min", sweeper.minutes());
    }
    let mut records = record::read(&files.runs)?;
    records.retain(|r| Job::of(&r.key).is_some());
    counts::attach(&mut records, &record::lines::<Count>(&files.counts)?);
    let mut of_peers = record::read(&files.peers)?;
    of_peers.retain(|r| peers::is_known(&r.key));
    let mut commits: Vec<&str> = records.iter().map(|r| r.commit.as_str()).collect();
    commits.sort_unstable();
    commits.dedup();
    let data = page::Data {
        commit: if commits.is_empty() { commit.clone() } else { commits.join(", ") },
        speeds: read_speeds(&files.speeds)?,
        limits: limits::read(&files.limits)?,
        stability: map::read(&options.out)?,
        making: files.making()?,
        charts: &charts,
        records: &records,
        peers: &of_peers,
    };
    let all = || records.iter().chain(&of_peers);
    record::write_csv(&options.out.join("runs.csv"), all())?;
    for chart in &charts {
        let file = options.out.join(format!("{}.csv", chart.id));
        record::write_csv(&file, all().filter(|r| r.key.problem == chart.problem))?;
    }
    limits::write_csv(&options.out.join("c10-limits.csv"), &data.limits)?;
    rates::write_csv(&options.out.join("c12-throughput.csv"), &data.speeds)?;
    let page = options.out.join("index.html");
    fs::write(&page, page::page(&data))?;
    println!("{} runs, {}", records.len(), page.display());
    Ok(())
}

/// Read stored speeds; the later one of the same job replaces the earlier one.
fn read_speeds(path: &Path) -> std::io::Result<Vec<Speed>> {
    let mut list: Vec<Speed> = Vec::new();
    for speed in record::lines::<Speed>(path)? {
        match list.iter().position(|s| s.asked == speed.asked) {
            Some(at) => list[at] = speed,
            None => list.push(speed),
        }
    }
    Ok(list)
}

/// Paths of the data files.
struct Files {
    runs: PathBuf,
    counts: PathBuf,
    speeds: PathBuf,
    peers: PathBuf,
    limits: PathBuf,
    making: PathBuf,
}

impl Files {
    fn new(out: &Path) -> Self {
        let [runs, counts, speeds, peers, limits, making] =
            ["runs.jsonl", "counts.jsonl", "speeds.jsonl", "peers.jsonl", "limits.jsonl", "making.json"]
                .map(|f| out.join(f));
        Files { runs, counts, speeds, peers, limits, making }
    }

    /// Read the provenance of the runs, if known.
    fn making(&self) -> Made<Option<page::Making>> {
        Ok(if self.making.exists() {
            serde_json::from_str(&fs::read_to_string(&self.making)?)?
        } else {
            None
        })
    }
}

/// Runner of missing jobs.
struct Sweeper<'a> {
    options: &'a Options,
    commit: &'a str,
    files: &'a Files,
    start: Instant,
}

impl Sweeper<'_> {
    fn minutes(&self) -> f64 {
        self.start.elapsed().as_secs_f64() / 60.0
    }

    fn threads(&self) -> usize {
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        self.options.threads.map_or_else(all, usize::from)
    }

    /// Number of timing repeats, and run time above which fewer are needed, s; the minimum time counts.
    fn repeats(&self) -> (u32, f64) {
        if self.options.quick { (2, 0.1) } else { (5, 3.0) }
    }

    /// Commit whose runs are reused; none if all runs are kept.
    fn asked(&self) -> Option<&str> {
        (!self.options.keep).then_some(self.commit)
    }

    fn wants(&self, number: &str) -> bool {
        self.options.charts.is_empty() || self.options.charts.iter().any(|c| c == number)
    }

    /// List all jobs of the requested charts.
    fn jobs(&self, charts: &[sweep::Chart]) -> Vec<Job> {
        // C11, the price of exactness, uses the runs of C1 and C2.
        let priced = |number: &str| self.wants("C11") && ["C1", "C2"].contains(&number);
        let wanted = charts.iter().filter(|c| self.wants(c.number) || priced(c.number));
        let mut problems: Vec<&str> = wanted.map(|c| c.problem).collect();
        problems.dedup();
        problems.into_iter().flat_map(|p| sweep::jobs(p, self.options.quick)).collect()
    }

    fn runs(&self, charts: &[sweep::Chart]) -> Made<()> {
        let there = record::read(&self.files.runs)?;
        let jobs = self.jobs(charts);
        let is_there = |job: &Job| there.iter().any(|r| r.is_of(job, self.asked()));
        let missing: Vec<Job> = jobs.iter().filter(|j| !is_there(j)).copied().collect();
        println!("{} runs, {} of them there", jobs.len(), jobs.len() - missing.len());
        let (repeats, brief) = self.repeats();
        let work = |job: &Job| {
            let mut outcomes = job.run();
            for _ in 1..repeats {
                if outcomes.last().is_some_and(|o| o.work.seconds < brief) {
                    for (kept, again) in outcomes.iter_mut().zip(job.run()) {
                        kept.work.seconds = kept.work.seconds.min(again.work.seconds);
                    }
                }
            }
            outcomes
        };
        pool::each(self.threads(), &missing, work, |count, job, outcomes| {
            let key = job.key();
            let new = |o| Record::new(key.clone(), o, self.commit);
            let list: Vec<Record> = outcomes.into_iter().map(new).collect();
            record::append(&self.files.runs, &list)?;
            let last = list.last();
            let note = last.and_then(|r| r.failure.as_deref()).map_or("", |_| ", stopped");
            let name = format!("{}, {}, {} cells", key.problem, key.scheme, key.cells);
            println!("run {count}/{} at {:.1} min: {name}{note}", missing.len(), self.minutes());
            Ok::<_, std::io::Error>(())
        })?;
        Ok(())
    }

    fn counts(&self, charts: &[sweep::Chart]) -> Made<()> {
        if !counts::possible() {
            println!("no valgrind: instructions are not counted");
            return Ok(());
        }
        let there: Vec<Count> = record::lines(&self.files.counts)?;
        let mut missing: Vec<Job> = Vec::new();
        // Exclude the study, the steel bars and Kalthoff's plate: they take minutes under callgrind and give no further information.
        let short = |job: &Job| match job {
            Job::Study(_) => false,
            Job::Passage(passage) => !matches!(passage.gate, Gate::Taylor | Gate::Kalthoff),
            _ => true,
        };
        for job in self.jobs(charts).into_iter().filter(short) {
            let key = job.scaled().key();
            let known =
                there.iter().any(|c| c.is_of(&key) && self.asked().is_none_or(|asked| c.commit == asked));
            if !known && !missing.iter().any(|m| m.scaled().key() == key) {
                missing.push(job);
            }
        }
        let folder = self.options.out.join("callgrind");
        fs::create_dir_all(&folder)?;
        let work = |job: &Job| Count::make(job, &folder, self.commit).map_err(|e| e.to_string());
        pool::each(self.threads(), &missing, work, |count, job, made| {
            let key = job.key();
            let made = made?;
            record::append(&self.files.counts, &[&made]).map_err(|e| e.to_string())?;
            let each = made.instructions.map_or("none".into(), |n| format!("{n:.0}"));
            let name = format!("{}, {}", key.problem, key.scheme);
            println!(
                "count {count}/{} at {:.1} min: {name}: {each} instructions",
                missing.len(),
                self.minutes()
            );
            Ok::<_, String>(())
        })?;
        fs::remove_dir_all(folder)?;
        Ok(())
    }

    fn limits(&self) -> Made<()> {
        if !self.wants("C10") {
            return Ok(());
        }
        let there = limits::read(&self.files.limits)?;
        let is_there = |a: &limits::Asked| there.iter().any(|f| f.is_of(a) && f.commit == self.commit);
        let mut missing = limits::Asked::all(self.options.quick);
        missing.retain(|a| !is_there(a));
        pool::each(
            self.threads(),
            &missing,
            |asked| asked.make(self.commit),
            |count, asked, found| {
                record::append(&self.files.limits, &[found?]).map_err(|e| e.to_string())?;
                if count % 32 == 0 || count == missing.len() {
                    let name = asked.scheme.name();
                    println!("limit {count}/{} at {:.1} min: {name}", missing.len(), self.minutes());
                }
                Ok::<_, String>(())
            },
        )?;
        Ok(())
    }

    /// Measure throughput, one run at a time, since the number of threads is part of the measurement.
    fn speeds(&self) -> Made<()> {
        if !self.wants("C12") {
            return Ok(());
        }
        let there = read_speeds(&self.files.speeds)?;
        let mut all = speed::Asked::all(sweep::sizes(self.options.quick));
        all.retain(|a| !there.iter().any(|s| s.asked == *a && s.commit == self.commit));
        if all.is_empty() {
            return Ok(());
        }
        let program = speed::program()?;
        let folder = self.options.out.join("throughput");
        fs::create_dir_all(&folder)?;
        let repeats = if self.options.quick { 2 } else { 6 };
        for (n, asked) in all.iter().enumerate() {
            let speed = asked.make(&program, &folder, repeats, self.commit)?;
            record::append(&self.files.speeds, &[&speed])?;
            let rate = 1e-6 * speed.best();
            let name = format!("{}, {} particles, {} threads", asked.name(), asked.particles, asked.threads);
            println!(
                "speed {}/{} at {:.1} min: {name}: {rate:.1} million/s",
                n + 1,
                all.len(),
                self.minutes()
            );
        }
        fs::remove_dir_all(folder)?;
        Ok(())
    }

    /// Run V3 and throughput by the installed packages, one run at a time. A failing program is skipped with a message: it
    /// must not prevent the page.
    fn peers(&self, packages: &[Package]) -> Made<()> {
        for peer in packages.iter().filter(|p| p.version.is_some()).map(|p| p.peer) {
            let made = self.runs_of(peer).and_then(|()| self.speeds_of(peer));
            if let Err(error) = made {
                eprintln!("{} is left out: {error}", peer.name());
            }
        }
        Ok(())
    }

    fn runs_of(&self, peer: Peer) -> Made<()> {
        if !self.wants("C1") {
            return Ok(());
        }
        let there = record::read(&self.files.peers)?;
        let mut missing = peers::cases(self.options.quick);
        missing.retain(|c| !there.iter().any(|r| r.key == peers::key(peer, c) && r.commit == self.commit));
        if missing.is_empty() {
            return Ok(());
        }
        let mut count = 0;
        peers::run(peer, &self.options.python, &missing, self.repeats(), self.commit, &mut |record| {
            record::append(&self.files.peers, &[&record])
                .map_err(|source| CaseError::File { path: self.files.peers.clone(), source })?;
            count += 1;
            let name = format!("{}, {}, {} cells", record.key.problem, record.scheme(), record.key.cells);
            println!("peer {count}/{} at {:.1} min: {name}", missing.len(), self.minutes());
            Ok(())
        })?;
        Ok(())
    }

    fn speeds_of(&self, peer: Peer) -> Made<()> {
        if !self.wants("C12") {
            return Ok(());
        }
        let there = read_speeds(&self.files.speeds)?;
        let quick = self.options.quick;
        // Fewer sizes: starting Python and compiling take seconds for each.
        let sizes = if quick { &[10_000, 100_000] } else { sweep::sizes(false) };
        let much = if quick { (2, 1_000_000) } else { (6, 4_000_000) };
        for asked in speed::Asked::of_peer(peer, sizes) {
            if there.iter().any(|s| s.asked == asked && s.commit == self.commit) {
                continue;
            }
            let speed = speed::of_peer((peer, &asked), &self.options.python, much, self.commit)?;
            record::append(&self.files.speeds, &[&speed])?;
            let name = format!("{}, {} particles, {} threads", asked.name(), asked.particles, asked.threads);
            println!("speed at {:.1} min: {name}: {:.1} million/s", self.minutes(), 1e-6 * speed.best());
        }
        Ok(())
    }

    /// Measure the timing noise of a run: two alternating series of five, on as many threads as the sweep. Store it
    /// with the provenance of the page.
    fn band(&self, packages: Vec<Package>) -> Made<()> {
        let series = |_: &()| {
            let (case, mut best) = (sweep::control(), [f64::INFINITY; 2]);
            for n in 0..10 {
                best[n % 2] = best[n % 2].min(case.run().work.seconds);
            }
            (best[0] / best[1] - 1.0).abs()
        };
        let mut band = 0.0_f64;
        pool::each(self.threads(), &vec![(); self.threads()], series, |_, _, found| {
            band = band.max(found);
            Ok::<_, ()>(())
        })
        .map_err(|()| "the control failed")?;
        // Kept runs keep their timing noise.
        let kept = self.files.making()?.filter(|_| self.options.keep);
        let band = kept.as_ref().map_or(band, |before| band.max(before.band));
        // Times are comparable within a chart, whose runs are of one machine each.
        let machine = match kept.map(|before| before.machine) {
            Some(before) if before.contains(&machine::class()) => before,
            Some(before) => format!("{before}; runs that were added: {}", machine::class()),
            None => machine::class(),
        };
        let making = page::Making {
            date: said_by("date", &["+%Y-%m-%d"]),
            machine,
            compiler: said_by("rustc", &["--version"]),
            threads: self.threads(),
            band,
            sweep: if self.options.quick { "quick".into() } else { "full".into() },
            packages,
        };
        fs::write(&self.files.making, serde_json::to_string_pretty(&making)?)?;
        Ok(())
    }
}
