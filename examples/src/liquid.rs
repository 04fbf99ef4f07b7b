//! Runs of incompressible flow: history, snapshots, balances and pictures.

use std::path::Path;

use clap::ValueEnum;
use flow::{Flow, FlowOptions, SemiStaggered};
use mpm_core::geometry::Lattice;
use mpm_core::observe::{HistoryCsv, Ledger, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::output::picture::{FieldPicture, Mark, Picture, Quantity};
use mpm_core::{Solver, Team};

use crate::{CaseError, Common, Restart, Totals};

/// Scheme of incompressible flow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FlowScheme {
    /// Velocities at faces, second order in time by reflection
    #[default]
    Staggered,
    /// Velocities at faces, without reflection: first order in time
    FirstOrder,
    /// Velocities at nodes, as printed \[Zhang2017\]
    SemiStaggered,
}

impl FlowScheme {
    /// Options of a scene on a lattice.
    pub fn options<const D: usize>(self, lattice: Lattice<D>) -> FlowOptions<D> {
        let options = FlowOptions::new(lattice);
        match self {
            FlowScheme::Staggered => options,
            FlowScheme::FirstOrder => options.without_reflection(),
            FlowScheme::SemiStaggered => options.semi_staggered(SemiStaggered::default()),
        }
    }
}

/// Folder, threads and restart of the runs of a case.
#[derive(Clone, Copy, Debug)]
pub struct FlowRuns<'a> {
    /// Options, for the number of threads.
    pub common: &'a Common,
    /// Folder of histories and frames.
    pub folder: &'a Path,
    /// True to write ParaView frames.
    pub frames: bool,
    /// Checkpoints.
    pub restart: &'a Restart,
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct FlowRun<const N: usize> {
    /// Name in file names.
    pub name: String,
    /// Time, s, and measures.
    pub rows: Vec<(f64, [f64; N])>,
    /// Snapshots at the times of the run.
    pub snapshots: Vec<Snapshot>,
    /// Totals with the largest errors of the balances.
    pub totals: Totals,
}

impl FlowRuns<'_> {
    /// Run a flow to the times of its snapshots, s. Rows of measures follow at the least `interval`, s (0: after every step); they are
    /// also written as `NAME.csv`.
    ///
    /// # Errors
    /// Errors of the run and of files.
    pub fn run<const D: usize, const N: usize>(
        &self,
        name: &str,
        mut flow: Flow<D>,
        times: &[f64],
        interval: f64,
        columns: [(&str, &str); N],
        measure: impl Fn(&Flow<D>) -> [f64; N],
    ) -> Result<FlowRun<N>, CaseError> {
        flow.set_team(Team::new(self.common.threads())?);
        let pace = || if interval > 0.0 { Pace::interval(interval) } else { Ok(Pace::every_step()) };
        let end = times.last().copied().unwrap_or_default();
        let columns = std::iter::once(("time", "s")).chain(columns);
        let mut history = HistoryCsv::create(
            self.folder.join(format!("{name}.csv")),
            columns,
            pace()?,
            |now: &RunView<'_>| {
                let flow = now.solver_as::<Flow<D>>()?;
                Ok(std::iter::once(now.time()).chain(measure(flow)).collect())
            },
        )?;
        let (mut ledger, mut bar) = (Ledger::new(pace()?), Progress::new(name));
        let mut frames = None;
        if self.frames {
            let folder = self.folder.join("paraview");
            frames = Some(VtkSeries::create(folder, name, Pace::interval(end / 40.0)?)?);
        }
        let mut simulation = self.restart.scene(name)?;
        for &time in times {
            let mut observers: Vec<&mut dyn Observer> = vec![&mut history, &mut ledger, &mut bar];
            observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
            simulation.until(&mut flow, observers, time)?;
            simulation.keep(|| flow.snapshot())?;
        }
        let row = |row: &Vec<f64>| (row[0], std::array::from_fn(|n| row[n + 1]));
        Ok(FlowRun {
            name: name.into(),
            rows: history.rows().iter().map(row).collect(),
            totals: Totals::of(&flow, &simulation.summary(), &ledger),
            snapshots: simulation.into_snapshots(),
        })
    }
}

impl<const N: usize> FlowRun<N> {
    /// Times, s, and values of a measure.
    #[must_use]
    pub fn series(&self, measure: usize) -> Vec<[f64; 2]> {
        self.rows.iter().map(|(time, values)| [*time, values[measure]]).collect()
    }
    /// Values of a measure.
    pub fn values(&self, measure: usize) -> impl Iterator<Item = f64> + '_ {
        self.rows.iter().map(move |(_, values)| values[measure])
    }
    /// Times, s.
    #[must_use]
    pub fn times(&self) -> Vec<f64> {
        self.rows.iter().map(|(time, _)| *time).collect()
    }
    /// Last values of the measures; NaN without rows.
    #[must_use]
    pub fn last(&self) -> [f64; N] {
        self.rows.last().map_or([f64::NAN; N], |(_, values)| *values)
    }
    /// Totals without the energy error, in which the energy of the surface is missing.
    #[must_use]
    pub fn without_energy(mut self) -> Self {
        self.totals.energy_error = 0.0;
        self
    }
}

/// Draw a liquid in the plane as a continuous area, with the lines of its walls.
///
/// # Errors
/// Snapshot without the quantity.
pub fn liquid(
    snapshot: &Snapshot,
    quantity: Quantity,
    [low, high]: [[f64; 2]; 2],
    walls: &[[[f64; 2]; 2]],
) -> Result<Picture, CaseError> {
    let picture = FieldPicture::new(760, 520)
        .fitted([420, 760], [180, 620])
        .colour_by(quantity)
        .mark(Mark::Cell)
        .particle_scale(DRAWN)
        .axes("x", "y")
        .bounds(low, high)
        .lines(walls.iter().copied(), 3.0, [60; 3]);
    Ok(picture.draw(snapshot)?)
}

/// Size of a drawn particle over its own: flow stretches the lattice of the particles, and gaps of up to 1.2 drawn sizes are closed.
const DRAWN: f64 = 2.0;
