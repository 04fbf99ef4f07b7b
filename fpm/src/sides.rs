//! Sides of cells: faces and neighbours as seen from each cell, and gradients by generalised finite differences.

use crate::cells::Face;
use crate::vector::{add_dyad, cofactor, difference, dot, norm, scaled, zero};

/// Largest sum of the magnitudes of the vectors b of a cell, times its size: above it neighbours are too few, or in a line or plane; two on
/// a square lattice.
const MOST: f64 = 6.0;

/// Face as seen from one of its cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface<const D: usize> {
    /// Area times normal, out of the cell.
    pub area: [f64; D],
    /// Arm from the point of the cell to the centroid of the face, m, and arm from the point of its neighbour.
    pub own: [f64; D],
    pub other: [f64; D],
    /// Penalty stiffness, area times eta / l, N/m.
    pub stiffness: f64,
}

impl<const D: usize> Surface<D> {
    /// Return the distance of the two points across the face, m.
    pub fn apart(&self) -> f64 {
        (dot(&self.own, &self.area) - dot(&self.other, &self.area)).abs() / norm(&self.area)
    }
}

/// Sides of all cells in sequence: for each cell the intact ones first, then the open ones, both in the order of faces.
#[derive(Clone, Debug)]
pub(crate) struct Sides<const D: usize> {
    pub starts: Vec<u32>,
    /// End of the intact sides of each cell.
    pub intact: Vec<u32>,
    pub neighbour: Vec<u32>,
    pub face: Vec<u32>,
    /// Vectors b of grad u = sum (u_m - u) (x) b_m, 1/m, and the vector b of the neighbour for the cell. Zero across open faces.
    pub gradient: Vec<[f64; D]>,
    pub back: Vec<[f64; D]>,
    pub surface: Vec<Surface<D>>,
}

impl<const D: usize> Sides<D> {
    /// Create the sides of faces, with penalties of `modulus` (eta, Pa); gradients are yet to be [fitted](Sides::fit).
    pub fn new(points: &[[f64; D]], faces: &[Face<D>], modulus: f64) -> Self {
        let mut starts = vec![0u32; points.len() + 1];
        for face in faces {
            face.cells.iter().for_each(|&c| starts[c as usize + 1] += 1);
        }
        for i in 0..points.len() {
            starts[i + 1] += starts[i];
        }
        let count = 2 * faces.len();
        let blank = Surface { area: [0.0; D], own: [0.0; D], other: [0.0; D], stiffness: 0.0 };
        let mut sides = Sides {
            intact: starts[1..].to_vec(),
            neighbour: vec![0; count],
            face: vec![0; count],
            gradient: vec![[0.0; D]; count],
            back: vec![[0.0; D]; count],
            surface: vec![blank; count],
            starts,
        };
        let mut next = sides.starts.clone();
        for (number, face) in faces.iter().enumerate() {
            let arms = face.cells.map(|c| difference(&face.centroid, &points[c as usize]));
            // Distance of the points across the face.
            let apart = (dot(&arms[0], &face.normal) - dot(&arms[1], &face.normal)).abs();
            for end in 0..2 {
                let s = next[face.cells[end] as usize] as usize;
                next[face.cells[end] as usize] += 1;
                sides.neighbour[s] = face.cells[1 - end];
                sides.face[s] = number as u32;
                sides.surface[s] = Surface {
                    area: scaled(&face.normal, if end == 0 { face.area } else { -face.area }),
                    own: arms[end],
                    other: arms[1 - end],
                    stiffness: face.area * modulus / apart,
                };
            }
        }
        sides
    }

    /// Return the range of the intact sides of a cell.
    #[inline(always)]
    pub fn intact_of(&self, cell: usize) -> std::ops::Range<usize> {
        self.starts[cell] as usize..self.intact[cell] as usize
    }
    /// Return the range of all sides of a cell.
    #[inline(always)]
    pub fn of(&self, cell: usize) -> std::ops::Range<usize> {
        self.starts[cell] as usize..self.starts[cell + 1] as usize
    }

    /// Sort the sides of a cell: those of intact faces first.
    pub fn sort(&mut self, cell: usize, open: impl Fn(u32) -> bool) {
        let range = self.of(cell);
        let mut order: Vec<usize> = range.clone().collect();
        order.sort_by_key(|&s| (open(self.face[s]), self.face[s]));
        let intact = order.iter().filter(|&&s| !open(self.face[s])).count();
        self.intact[cell] = (range.start + intact) as u32;
        fn permute<X: Copy>(list: &mut [X], start: usize, order: &[usize]) {
            let sorted: Vec<X> = order.iter().map(|&s| list[s]).collect();
            list[start..start + sorted.len()].copy_from_slice(&sorted);
        }
        permute(&mut self.neighbour, range.start, &order);
        permute(&mut self.face, range.start, &order);
        permute(&mut self.gradient, range.start, &order);
        permute(&mut self.back, range.start, &order);
        permute(&mut self.surface, range.start, &order);
    }

    /// Fit the gradient of a cell by generalised finite differences over its intact sides: b = (A^T W A)^-1 A^T W with rows x_m - x of A,
    /// exact for linear fields. Weights are areas over distances, so that a neighbour with a tiny face hardly counts; on lattices any
    /// uniform weights are equivalent. Return false, with b = 0, if neighbours are too few or in a line or plane.
    pub fn fit(&mut self, cell: usize, size: f64) -> bool {
        let (intact, all) = (self.intact_of(cell), self.of(cell));
        let arm = |s: usize| {
            let x = difference(&self.surface[s].own, &self.surface[s].other);
            (x, norm(&self.surface[s].area) / norm(&x))
        };
        let mut moments = zero::<D>();
        for (x, weight) in intact.clone().map(arm) {
            add_dyad(&mut moments, weight, &x, &x);
        }
        let c = cofactor(&moments);
        let det = dot(&moments[0], &c[0]);
        let fitted: Vec<[f64; D]> = intact
            .clone()
            .map(|s| {
                let (x, weight) = arm(s);
                // Moments are symmetric, and so are their cofactors.
                std::array::from_fn(|d| weight * dot(&c[d], &x) / det)
            })
            .collect();
        let most: f64 = fitted.iter().map(norm).sum::<f64>() * size;
        let sound = most <= MOST && intact.len() >= D;
        self.gradient[all.start..all.end].fill([0.0; D]);
        if sound {
            self.gradient[intact.start..intact.end].copy_from_slice(&fitted);
        }
        sound
    }

    /// Copy the vectors b of a cell to its neighbours.
    pub fn tell(&mut self, cell: usize) {
        for s in self.of(cell) {
            let (face, gradient) = (self.face[s], self.gradient[s]);
            let there = self.of(self.neighbour[s] as usize).find(|&t| self.face[t] == face);
            if let Some(t) = there {
                self.back[t] = gradient;
            }
        }
    }

    pub fn bytes(&self) -> usize {
        4 * (self.starts.capacity()
            + self.intact.capacity()
            + self.neighbour.capacity()
            + self.face.capacity())
            + 8 * D * (self.gradient.capacity() + self.back.capacity())
            + self.surface.capacity() * size_of::<Surface<D>>()
    }
}
