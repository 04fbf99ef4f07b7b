//! Fields at nodes, and scratch memory of the semi-staggered scheme.

/// Fields at nodes, which are the lower corners of cells.
#[derive(Clone, Debug)]
pub(crate) struct Nodes<const D: usize> {
    /// Liquid volume over that of a cell.
    pub volume: Vec<f64>,
    /// Velocity, m/s.
    pub velocity: Vec<[f64; D]>,
    /// Velocity that particles brought; then the change of velocity in the step, m/s.
    pub change: Vec<[f64; D]>,
    /// Components that walls hold, one bit each.
    pub held: Vec<u8>,
    /// Copy of the velocity, for passes that read neighbours.
    pub spare: Vec<[f64; D]>,
    pub balls: Balls,
    pub scratch: Scratch<D>,
}

impl<const D: usize> Default for Nodes<D> {
    fn default() -> Self {
        Nodes {
            volume: Vec::new(),
            velocity: Vec::new(),
            change: Vec::new(),
            held: Vec::new(),
            spare: Vec::new(),
            balls: Balls::default(),
            scratch: Scratch::default(),
        }
    }
}

impl<const D: usize> Nodes<D> {
    /// Allocated memory, bytes.
    pub fn bytes(&self) -> usize {
        let vectors = self.velocity.capacity() + self.change.capacity() + self.spare.capacity();
        8 * (self.volume.capacity() + D * vectors)
            + self.held.capacity()
            + self.balls.bytes()
            + self.scratch.bytes()
    }

    /// Set the components that walls hold to zero, and return volume times change of velocity, in cells times m/s.
    pub fn hold(&mut self) -> [f64; D] {
        let mut sum = [0.0; D];
        for (slot, held) in self.held.iter().enumerate().filter(|(_, held)| **held != 0) {
            for d in (0..D).filter(|d| held >> d & 1 == 1) {
                sum[d] -= self.volume[slot] * self.velocity[slot][d];
                self.velocity[slot][d] = 0.0;
            }
        }
        sum
    }
}

/// Scratch memory of the transfer.
#[derive(Clone, Debug)]
pub(crate) struct Scratch<const D: usize> {
    /// Volume and volume times velocity at the nodes that the particles of a block reach, block by block; then forces.
    pub records: Vec<(f64, [f64; D])>,
    /// Place of the records of each block; [`NONE`] without particles.
    pub place: Vec<u32>,
    /// Blocks with particles.
    pub occupied: Vec<usize>,
}

impl<const D: usize> Default for Scratch<D> {
    fn default() -> Self {
        Scratch { records: Vec::new(), place: Vec::new(), occupied: Vec::new() }
    }
}

impl<const D: usize> Scratch<D> {
    pub fn bytes(&self) -> usize {
        self.records.capacity() * size_of::<(f64, [f64; D])>()
            + 4 * self.place.capacity()
            + 8 * self.occupied.capacity()
    }
}

/// Scratch memory of the sweep.
#[derive(Clone, Debug, Default)]
pub(crate) struct Balls {
    /// Levels before a round.
    pub before: Vec<f64>,
    /// Cells that keep their level.
    pub frozen: Vec<bool>,
}

impl Balls {
    pub fn bytes(&self) -> usize {
        8 * self.before.capacity() + self.frozen.capacity()
    }
}
