//! Displacements: where points are, less where they were first seen.

use impactite_output::{OutputError, Snapshot};

use crate::archive::{Archive, CheckpointError};

/// Where each point of a run was first seen, by body and number: in that order, so that points are found by bisection and a
/// checkpoint does not depend on the order of points in memory.
#[derive(Default)]
pub(super) struct FirstSeen(Vec<Seen>);

#[derive(Clone, Default)]
struct Seen {
    body: u32,
    number: u64,
    /// m.
    position: [f64; 3],
}

impl Seen {
    fn key(&self) -> (u32, u64) {
        (self.body, self.number)
    }
}

impl FirstSeen {
    /// The displacements of the points of a snapshot, m: 0 of those that were not seen before, which count from here on.
    ///
    /// # Errors
    /// A snapshot without the field `particle`.
    pub fn displacements(&mut self, now: &Snapshot) -> Result<Vec<[f64; 3]>, OutputError> {
        let numbers = now.scalar("particle")?.iter().map(|&number| number as u64);
        let keys = now.bodies().iter().copied().zip(numbers);
        let mut new = Vec::new();
        let mut displacements = Vec::with_capacity(now.len());
        for ((body, number), &position) in keys.zip(now.positions()) {
            displacements.push(match self.0.binary_search_by_key(&(body, number), Seen::key) {
                Ok(place) => {
                    let first = &self.0[place].position;
                    [0, 1, 2].map(|d| position[d] - first[d])
                }
                Err(_) => {
                    new.push(Seen { body, number, position });
                    [0.0; 3]
                }
            });
        }
        if !new.is_empty() {
            self.0.append(&mut new);
            self.0.sort_by_key(Seen::key);
            // A number that two points have would be a body's mistake; the first of them stays.
            self.0.dedup_by_key(|seen| seen.key());
        }
        Ok(displacements)
    }

    /// To a checkpoint or from one.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.0, &Seen::default(), |file, seen| {
            file.index(&mut seen.body, usize::MAX)?;
            file.word(&mut seen.number)?;
            file.reals(&mut seen.position)
        })?;
        match self.0.is_sorted_by(|a, b| a.key() < b.key()) {
            true => Ok(()),
            false => Err(file.damaged("points of frames that are not in order")),
        }
    }
}
