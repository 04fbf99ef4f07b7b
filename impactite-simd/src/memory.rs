//! Memory limit of a call.
//!
//! Memory whose size follows from a few input numbers (a box of nodes, a filling, rings, copies in a picture) is
//! checked before allocation against a limit: [`MOST_BYTES`], unless the caller sets another one (`Filling::memory`,
//! `DenseGrid::within`). The limit does not depend on the machine, so that a program is refused equally everywhere; a
//! refusal by the operating system below it is an error as well.

/// Default memory limit of a call, bytes, 16 GiB: 2.6e8 particles that fill a body in space, or as many nodes of a
/// dense grid in double precision.
pub const MOST_BYTES: u64 = 16 << 30;

/// Error of a refused memory request.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MemoryError {
    /// Request above the limit.
    #[error("{what} would take {bytes:.4e} bytes of memory; at most {allowed} are allowed; {remedy}")]
    Limit {
        /// Purpose of the memory.
        what: &'static str,
        /// Requested bytes.
        bytes: f64,
        /// Allowed bytes.
        allowed: u64,
        /// Remedy: input to change.
        remedy: &'static str,
    },
    /// Request refused by the operating system.
    #[error("{what} would take {bytes:.4e} bytes of memory, which the system refuses; {remedy}")]
    System {
        /// Purpose of the memory.
        what: &'static str,
        /// Requested bytes.
        bytes: f64,
        /// Remedy: input to change.
        remedy: &'static str,
    },
}

/// Memory limit of a request, with its purpose and remedy.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Purpose of the memory.
    pub what: &'static str,
    /// Allowed bytes.
    pub allowed: u64,
    /// Remedy if the limit is too small.
    pub remedy: &'static str,
}

impl Budget {
    /// Check a number of bytes against the limit; NaN is refused.
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
    /// Allocate room for `count` values.
    ///
    /// # Errors
    /// A request above the limit, or refused by the operating system.
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
