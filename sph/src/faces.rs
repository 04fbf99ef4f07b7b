//! Surface detection: boundary particles and their normals.

/// Surface normals of a boundary particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Faces<const D: usize> {
    pub count: usize,
    pub normals: [[f64; 3]; 3],
}

/// Cached result of a particle, valid in the round in which it was computed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Found<X> {
    pub round: u32,
    pub what: X,
}

/// Cached results of the surface detection.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surface<const D: usize> {
    pub round: u32,
    pub open: Vec<Found<Option<[f64; 3]>>>,
    pub flat: Vec<Found<Option<[f64; 3]>>>,
    pub faces: Vec<Found<Faces<D>>>,
}

impl<const D: usize> Surface<D> {
    /// Invalidate the results after a change of neighbours.
    pub fn forget(&mut self) {
        self.round += 1;
    }

    pub fn begin(&mut self, particles: usize) {
        if self.open.len() != particles {
            self.open = vec![Found::default(); particles];
            self.flat = vec![Found::default(); particles];
            self.faces = vec![Found::default(); particles];
            self.round = 1;
        }
    }

    pub fn bytes(&self) -> usize {
        self.open.capacity() * size_of::<Found<Option<[f64; 3]>>>() * 2
            + self.faces.capacity() * size_of::<Found<Faces<D>>>()
    }
}
