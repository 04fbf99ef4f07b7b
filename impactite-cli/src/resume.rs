//! Sweeps and studies of convergence that go on.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use impactite_report::convergence::Convergence;

use crate::converge::conclude;
use crate::sweep::{Point, go_on, reopen, write};
use crate::{CliError, Job};

/// Result of a sweep.
#[derive(Clone, Debug)]
pub enum Swept {
    /// Runs over lists of values.
    Values(Vec<Point>),
    /// Runs of a study of convergence.
    Levels(Convergence),
}

/// Go on with the sweep or the study of convergence in a folder: runs that have ended are read, runs that were stopped are resumed, the
/// others are made.
///
/// # Errors
/// [`sweep`](crate::sweep::sweep) in a folder without a plan.
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
