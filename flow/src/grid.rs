//! Grid of a step: blocks near the liquid, and fields at faces and cells.

use crate::blocks::{Blocks, faces};
use crate::cuts::{Cuts, Moments};
use crate::extrapolate;
use crate::pressure::System;
use crate::surface::{Profile, Surface};
use crate::tension::Tension;
use crate::transfer::Scratch;

/// A list for each axis.
pub(crate) type Faces<const D: usize> = [Vec<f64>; D];

/// Fields of a step. Faces are those at the lower end of each cell.
#[derive(Clone, Debug)]
pub(crate) struct Grid<const D: usize> {
    pub blocks: Blocks<D>,
    pub cuts: Cuts<D>,
    /// Open fraction of faces and cells.
    pub open: Faces<D>,
    pub open_cell: Vec<f64>,
    /// Part of the open share of kernels by cut cells whose open part is to one side; empty without.
    pub uneven: Vec<Moments>,
    /// Liquid volume at faces over that of a cell.
    pub volume: Faces<D>,
    /// Velocity at faces, m/s.
    pub velocity: Faces<D>,
    /// Velocity at faces before the projection, m/s.
    pub before: Faces<D>,
    /// Displacement at faces by the density correction, in cells.
    pub shift: Faces<D>,
    /// Velocity of moving walls at faces, m/s.
    pub wall: Faces<D>,
    /// Velocity of moving walls at faces in the last step, m/s.
    pub wall_before: Faces<D>,
    /// State of the velocity at faces.
    pub marks: [Vec<u8>; D],
    pub surface: Surface,
    /// Cells of pockets between rigid bodies and walls, sorted, and the first cell of their pocket.
    pub pockets: Vec<(usize, usize)>,
    pub tension: Tension,
    /// Value of q at the surface, near each cell; empty without surface tension.
    pub jump: Vec<f64>,
    pub profile: Profile,
    pub system: System<D>,
    /// Unknown of the pressure equation, p dt / (rho h), m/s; then the pressure, Pa.
    pub pressure: Vec<f64>,
    /// Unknown of the density correction.
    pub potential: Vec<f64>,
    pub right: Vec<f64>,
    /// Part of the right-hand side by the reflection; empty without.
    pub advected: Vec<f64>,
    pub scratch: GridScratch<D>,
}

/// Scratch memory of a step.
#[derive(Clone, Debug)]
pub(crate) struct GridScratch<const D: usize> {
    pub transfer: Scratch,
    pub extrapolate: [extrapolate::Scratch; D],
    pub held: Vec<extrapolate::Held<D>>,
    pub marks: [Vec<u8>; D],
}

impl<const D: usize> Default for Grid<D> {
    fn default() -> Self {
        Grid {
            blocks: Blocks::default(),
            cuts: Vec::new(),
            open: faces(),
            open_cell: Vec::new(),
            uneven: Vec::new(),
            volume: faces(),
            velocity: faces(),
            before: faces(),
            shift: faces(),
            wall: faces(),
            wall_before: faces(),
            marks: faces(),
            surface: Surface::default(),
            pockets: Vec::new(),
            tension: Tension::default(),
            jump: Vec::new(),
            profile: Profile::new(D, 0.5),
            system: System::default(),
            pressure: Vec::new(),
            potential: Vec::new(),
            right: Vec::new(),
            advected: Vec::new(),
            scratch: GridScratch {
                transfer: Scratch::default(),
                extrapolate: std::array::from_fn(|_| extrapolate::Scratch::default()),
                held: Vec::new(),
                marks: faces(),
            },
        }
    }
}

impl<const D: usize> Grid<D> {
    /// Allocated memory, bytes, without the vectors of the iterations of a solve.
    pub fn bytes(&self) -> usize {
        let faces = [&self.open, &self.volume, &self.velocity, &self.before, &self.shift, &self.wall];
        let cells = [&self.open_cell, &self.pressure, &self.potential, &self.right];
        let reals: usize = faces.into_iter().flatten().chain(cells).map(|list| list.capacity()).sum();
        self.blocks.bytes()
            + self.tension.bytes()
            + self.system.bytes()
            + 8 * (reals + 4 * self.uneven.capacity())
    }
}
