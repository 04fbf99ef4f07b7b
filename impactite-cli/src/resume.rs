//! Resumption of sweeps and convergence studies.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use impactite_report::convergence::Convergence;

use crate::converge::conclude;
use crate::sweep::{Point, go_on, reopen, write};
use crate::{CliError, Job};

/// Result of a sweep.
#[derive(Clone, Debug)]
pub enum Swept {
    /// Points of a sweep over lists of values.
    Values(Vec<Point>),
    /// Levels of a convergence study.
    Levels(Convergence),
}

/// Resume the sweep or the convergence study in a folder: finished runs are read, stopped runs are resumed, the others are run.
///
/// # Errors
/// Errors of [`sweep`](crate::sweep::sweep); folder without a plan.
pub fn resume(folder: &Path, how: impl FnOnce(Job) -> Job, stop: &AtomicBool) -> Result<Swept, CliError> {
    let (base, mut plan, _lock) = reopen(folder, how)?;
    let points = go_on(&base, &mut plan, stop)?;
    match (plan.ratio, &plan.keys[..]) {
        (Some(ratio), [factors]) => conclude(&base, factors, ratio, &points).map(Swept::Levels),
        _ => {
            write(folder, &plan.keys, &points)?;
            Ok(Swept::Values(points))
        }
    }
}
