//! Recorder: rows, errors and resumption of runs.

mod block;

use block::{Block, Folder, run};
use impactite_report::recorder::{MOST_ROWS, Row};
use impactite_report::{Record, Recorder};
use impactite_scene::observe::{Ledger, ObserveError, Observer, Pace, RunView};
use impactite_scene::{Archive, CheckpointError, Run, RunError};

const END: f64 = 5.0e-3;

/// Bits of all values of a row except wall-clock times.
fn bits(row: &Row) -> Vec<u64> {
    let Row { time, step, dt, points, mass, kinetic, internal, work, friction, impacts, .. } = *row;
    let Row { conversion, unexplained, energy_error, momentum: [x, y, z], momentum_error, .. } = *row;
    let reals = [time, dt, mass, kinetic, internal, work, friction, impacts, conversion, unexplained];
    let reals = reals.into_iter().chain([energy_error, x, y, z, momentum_error, row.updates]);
    [step, points as u64].into_iter().chain(reals.map(f64::to_bits)).collect()
}

#[test]
fn errors_are_those_of_the_ledger() {
    let (mut recorder, mut ledger) = (Recorder::new(Pace::every_step()), Ledger::new(Pace::every_step()));
    run(&mut Block::new("block"), END, vec![&mut recorder, &mut ledger]);
    let rows = recorder.rows();
    assert_eq!(rows.len(), ledger.entries().len());
    for (row, entry) in rows.iter().zip(ledger.entries()) {
        assert_eq!(row.energy_error.to_bits(), entry.energy_error.to_bits());
        assert_eq!(row.momentum_error.to_bits(), entry.momentum_error.to_bits());
        assert_eq!((row.time, row.step, row.total()), (entry.time, entry.step, entry.total));
    }
    // The ledger computes the change of sums, the recorder the sum of changes: equal up to rounding of energies.
    let [here, there] = [recorder.worst_energy_error(), ledger.worst_energy_error()];
    assert!(here != 0.0 && (here - there).abs() < 8.0 * f64::EPSILON, "{here:e} {there:e}");
    assert_eq!(recorder.worst_momentum_error().to_bits(), ledger.worst_momentum_error().to_bits());
    assert_eq!(recorder.worst_mass_error(), 0.0);
    assert!(recorder.reached());
}

/// A run with more looks than rows kept has rows at equal intervals, the first and the last state, and the worst errors of all looks.
#[test]
fn long_runs_are_thinned() {
    let end = 50.0e-3;
    let (mut recorder, mut ledger) = (Recorder::new(Pace::every_step()), Ledger::new(Pace::every_step()));
    let summary = run(&mut Block::new("block"), end, vec![&mut recorder, &mut ledger]);
    assert!(summary.steps > 2 * MOST_ROWS as u64, "{} steps", summary.steps);
    let rows = recorder.rows();
    assert!(rows.len() > MOST_ROWS / 2 && rows.len() <= MOST_ROWS + 1, "{} rows", rows.len());
    assert_eq!((rows[0].step, rows[rows.len() - 1].step), (0, summary.steps));
    assert_eq!(rows[rows.len() - 1].time, end);
    let apart: Vec<u64> = rows.windows(2).map(|w| w[1].step - w[0].step).collect();
    assert!(apart[..apart.len() - 1].iter().all(|&d| d == apart[0]), "{:?}", &apart[..5]);
    // Kept rows equal the ledger entries.
    for row in &rows {
        assert_eq!(row.kinetic.to_bits(), ledger.entries()[row.step as usize].kinetic.to_bits());
    }
    let worst = ledger.entries().iter().map(|e| e.total - ledger.entries()[0].total);
    let worst = worst.fold(0.0, |w: f64, e| if e.abs() > w.abs() { e } else { w });
    let scale = recorder.scales()[0];
    assert!((recorder.worst_energy_error() - worst / scale).abs() < 8.0 * f64::EPSILON);
}

/// Observer that stops a run after a step, as if the process was killed.
struct Kill(Pace, u64);

impl Observer for Kill {
    fn pace(&mut self) -> &mut Pace {
        &mut self.0
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        if now.step() < self.1 { Ok(()) } else { Err(ObserveError::Other("killed".into())) }
    }
    fn archive(&mut self, _: &mut Archive) -> Result<(), CheckpointError> {
        Ok(())
    }
}

#[test]
fn a_run_that_is_resumed_has_one_history() {
    let folder = Folder::new("resume");
    let checkpoint = folder.0.join("run.checkpoint");
    // Longer than the rows kept, so that the sampling state is saved, too; killed after and before thinning.
    let end = 30.0e-3;
    let mut whole = Recorder::new(Pace::every_step());
    run(&mut Block::new("block"), end, vec![&mut whole, &mut Kill(Pace::every_step(), u64::MAX)]);
    for (killed, every) in [(5321, 700), (2000, 900)] {
        let (mut block, mut first) = (Block::new("block"), Recorder::new(Pace::every_step()));
        let mut kill = Kill(Pace::every_step(), killed);
        let stopped = Run::new(&mut block)
            .observe(&mut first)
            .observe(&mut kill)
            .checkpoint(&checkpoint, Pace::steps(every).expect("a pace"))
            .until(end);
        assert!(matches!(stopped, Err(RunError::Observe { .. })), "{stopped:?}");
        assert!(!first.reached());

        let (mut block, mut again) = (Block::new("block"), Recorder::new(Pace::every_step()));
        let mut kill = Kill(Pace::every_step(), u64::MAX);
        let mut resumed =
            Run::new(&mut block).observe(&mut again).observe(&mut kill).resume(&checkpoint).expect("read");
        resumed.until(end).expect("the rest");
        let (here, there) = (again.rows(), whole.rows());
        assert_eq!(here.len(), there.len());
        for (a, b) in here.iter().zip(&there) {
            assert_eq!(bits(a), bits(b), "{a:?} {b:?}");
        }
        let errors = |r: &Recorder| {
            [r.worst_energy_error(), r.worst_momentum_error(), r.worst_mass_error()].map(f64::to_bits)
        };
        assert_eq!(errors(&again), errors(&whole));
        assert_eq!(again.warnings(), whole.warnings());
        assert_eq!(again.scales(), whole.scales());
        assert!(again.reached());
    }
}

#[test]
fn warnings_say_what_to_do() {
    let mut recorder = Recorder::new(Pace::every_step());
    run(&mut Block::new("a; b"), END, vec![&mut recorder]);
    let [warned] = recorder.warnings() else { panic!("{:?}", recorder.warnings()) };
    assert_eq!(warned.title, "body torn: a; b");
    assert!(warned.found.starts_with("body `a; b` is in 2 parts"), "{}", warned.found);
    assert!(warned.found.ends_with("share no node"), "{}", warned.found);
    assert!(warned.remedy.starts_with("give it a failure criterion"), "{}", warned.remedy);
}

#[test]
fn a_record_comes_back_as_it_was_saved() {
    let folder = Folder::new("record");
    let (mut block, mut recorder) = (Block::new("block"), Recorder::new(Pace::every_step()));
    let summary = run(&mut block, END, vec![&mut recorder]);
    let record = Record::new("block")
        .bodies_of(&block)
        .balances(&recorder)
        .summary(&summary, 2)
        .setup(0.1)
        .stopped(&"for a test");
    record.save(&folder.0).expect("saved");
    let read = Record::open(&folder.0).expect("read");
    // Each look except the one before the first step.
    let looks = recorder.rows().len() as u64 - 1;
    assert_eq!(recorder.limits(), [("waves and velocities in block".to_string(), looks)]);
    assert_eq!((read.limits[0].looks, read.limits.len()), (looks, 1));
    // The size of the step before the first is NaN, which equals nothing: compare texts.
    let text = |record: &Record| serde_json::to_string(record).expect("JSON");
    assert_eq!(text(&read), text(&record));
    let [here, there] = [&read, &record].map(|r| r.balances.as_ref().expect("balances"));
    for (a, b) in here.series.iter().zip(&there.series) {
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&a.values), bits(&b.values), "{}", a.name);
    }
    assert_eq!(there.column("kinetic energy").map(|c| c.values.len()), Some(recorder.rows().len()));
}
