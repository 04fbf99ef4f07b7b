//! Particles: kept by bin, in groups of lanes, in blocks of bins.
//!
//! A **group** is one [`GROUP`](crate::Float::GROUP)-wide set of particles of one bin: a row of storage
//! for each of their numbers. A bin has a list of groups; a [`Block`] is the 4^D bins whose stencils start at
//! the same node block, with all their groups in one piece of memory. Lanes without a particle have
//! mass zero and a virgin state, so that kernels need not look at them. Where all particles of a body have the same mass,
//! none carries it. The numbers by which particles are told lie apart, in 32 bits where that is enough.
//!
//! Only the store moves particles, and it moves all columns at once; a column cannot be forgotten.

mod block;
mod masses;
mod outbox;

pub use block::{Block, Groups, Members, Place, split};
pub use masses::Masses;
pub use outbox::{Outbox, Sent};

/// Where the columns of a particle are: rows of a group, in order.
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
    /// Columns of a body: the numbers of its law's `state`, by name, `domain` numbers of a domain, `load`
    /// numbers of a load, and `frame` of displacement and deformation; with a mass.
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
    /// Numbers of a particle; rows of a group, and its number where that lies apart.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.number() + 1
    }
    /// Rows of a group.
    #[inline(always)]
    pub fn rows(&self) -> usize {
        self.number() + usize::from(!self.short_number)
    }
    /// Bytes that a particle carries.
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
    /// First row of the domain, and how many there are.
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
    /// The same without the mass.
    pub fn without_mass(mut self) -> Self {
        self.mass = 0;
        self
    }
    /// The same with the particle's number apart, in 32 bits.
    pub fn with_short_number(mut self) -> Self {
        self.short_number = true;
        self
    }
    /// Place of the particle's number, by which it can be told all its life: the last one.
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
