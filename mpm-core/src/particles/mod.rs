//! Particle storage: by bin, in groups of lanes, in blocks of bins.
//!
//! A **group** is one [`GROUP`](crate::Float::GROUP)-wide set of particles of one bin: a row of storage for each of
//! their values. A bin has a list of groups; a [`Block`] contains the 4^D bins whose stencils start at the same node
//! block, with all their groups in one array. Lanes without a particle have mass zero and a virgin state, so that
//! kernels need not exclude them. Equal masses of the particles of a body are stored once. The numbers that identify
//! particles are stored apart, in 32 bits where that is enough.
//!
//! Only this storage moves particles, all columns at once: no column can be forgotten.

mod block;
mod masses;
mod outbox;

pub use block::{Block, Groups, Members, Place, split};
pub use masses::Masses;
pub use outbox::{Outbox, Sent};

/// Layout of the columns of a particle: rows of a group, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns {
    dimension: usize,
    state: usize,
    domain: usize,
    load: usize,
    frame: usize,
    mass: usize,
    short_number: bool,
    names: Vec<String>,
}

impl Columns {
    /// Create the columns of a body: the values of its law's `state`, by name, `domain` values of a domain, `load`
    /// values of a load, and `frame` values of displacement and deformation; with a mass.
    pub fn new(dimension: usize, state: Vec<String>, domain: usize, load: usize, frame: usize) -> Self {
        Columns {
            dimension,
            state: state.len(),
            domain,
            load,
            frame,
            mass: 1,
            short_number: false,
            names: state,
        }
    }
    /// Number of values of a particle: rows of a group, plus the particle number where that is stored apart.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.number() + 1
    }
    /// Rows of a group.
    #[inline(always)]
    pub fn rows(&self) -> usize {
        self.number() + usize::from(!self.short_number)
    }
    /// Bytes per particle.
    pub fn bytes<T>(&self) -> usize {
        self.rows() * size_of::<T>() + if self.short_number { size_of::<u32>() } else { 0 }
    }
    /// First row of the position: offset from the bin's centre in units of h.
    #[inline(always)]
    pub const fn position() -> usize {
        0
    }
    /// First row of the velocity, m/s.
    #[inline(always)]
    pub const fn velocity(dimension: usize) -> usize {
        dimension
    }
    /// First row of the law's state.
    #[inline(always)]
    pub const fn state(dimension: usize) -> usize {
        2 * dimension
    }
    /// First row of the domain, in units of h (if carried).
    #[inline(always)]
    pub fn domain(&self) -> usize {
        Self::state(self.dimension) + self.state
    }
    /// First row of the domain, and number of its rows.
    pub fn domains(&self) -> (usize, usize) {
        (self.domain(), self.domain)
    }
    /// First row of a load, if one is carried: loaded area, m^2, or acceleration, m/s^2.
    #[inline(always)]
    pub fn load(&self) -> usize {
        self.domain() + self.domain
    }
    /// Row of the mass, kg, if it is carried.
    #[inline(always)]
    pub fn mass(&self) -> usize {
        self.frame() + self.frame
    }
    /// Return the columns without the mass.
    pub fn without_mass(mut self) -> Self {
        self.mass = 0;
        self
    }
    /// Return the columns with the particle number apart, in 32 bits.
    pub fn with_short_number(mut self) -> Self {
        self.short_number = true;
        self
    }
    /// Index of the particle number, which identifies the particle for its lifetime: the last one.
    #[inline(always)]
    pub fn number(&self) -> usize {
        self.mass() + self.mass
    }
    /// First row of displacement (in units of h) and deformation gradient (if carried).
    #[inline(always)]
    pub fn frame(&self) -> usize {
        self.load() + self.load
    }
    /// Names of the law's state columns.
    pub fn state_names(&self) -> &[String] {
        &self.names
    }
}
