//! How much memory one call may ask for.
//!
//! What a few numbers can make huge (a box of nodes, a filling, rings, copies in a picture) is counted before anything is allocated, and
//! refused where it goes beyond a limit: [`MOST_BYTES`], unless the caller sets another one (`Filling::memory`,
//! `DenseGrid::within`). The limit is a number and not what the machine has, so that a program is refused
//! the same everywhere; what the system refuses below it is an error as well.

/// Bytes that one call may ask for if nobody says otherwise, 16 GiB: room for 2.6e8 particles that fill a body in space, or for as many
/// nodes of a dense grid in double precision.
pub const MOST_BYTES: u64 = 16 << 30;

/// Why memory is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MemoryError {
    /// More than is allowed.
    #[error("{what} would take {bytes:.4e} bytes of memory; at most {allowed} are allowed; {remedy}")]
    Limit {
        /// What would be held in it.
        what: &'static str,
        /// Bytes that it would take.
        bytes: f64,
        /// Bytes that are allowed.
        allowed: u64,
        /// What to change.
        remedy: &'static str,
    },
    /// More than the system gives.
    #[error("{what} would take {bytes:.4e} bytes of memory, which the system refuses; {remedy}")]
    System {
        /// What would be held in it.
        what: &'static str,
        /// Bytes that it would take.
        bytes: f64,
        /// What to change.
        remedy: &'static str,
    },
}

/// What asks for memory, how much of it is allowed, and what the user can change.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// What would be held in it.
    pub what: &'static str,
    /// Bytes that are allowed.
    pub allowed: u64,
    /// What to change where that is too little.
    pub remedy: &'static str,
}

impl Budget {
    /// Refuses more bytes than are allowed, and what is no number.
    ///
    /// # Errors
    /// [`MemoryError::Limit`].
    pub fn holds(self, bytes: f64) -> Result<(), MemoryError> {
        if bytes <= self.allowed as f64 {
            Ok(())
        } else {
            Err(MemoryError::Limit { what: self.what, bytes, allowed: self.allowed, remedy: self.remedy })
        }
    }
    /// Room for so many values.
    ///
    /// # Errors
    /// More than is allowed, or than the system gives.
    pub fn room<T>(self, count: usize) -> Result<Vec<T>, MemoryError> {
        let bytes = count as f64 * size_of::<T>() as f64;
        self.holds(bytes)?;
        let mut room = Vec::new();
        match room.try_reserve_exact(count) {
            Ok(()) => Ok(room),
            Err(_) => Err(MemoryError::System { what: self.what, bytes, remedy: self.remedy }),
        }
    }
}
