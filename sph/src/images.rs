//! Mirror images of particles at planes of symmetry, at an axis of revolution and at rigid walls.

use impactite_scene::{Boundary, Side};

use crate::records::Records;

/// Mirror plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mirror {
    pub axis: usize,
    pub at: f64,
    /// Side of the material: 1 above, -1 below.
    pub sign: f64,
    pub kind: MirrorKind,
}

impl Mirror {
    /// Return the wall as a boundary condition on particles.
    pub fn wall<const D: usize>(&self) -> Boundary<D> {
        let side = if self.sign > 0.0 { Side::Above } else { Side::Below };
        Boundary::Wall { axis: self.axis, at: self.at, side, velocity: 0.0 }
    }
}

/// Kind of a mirror plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MirrorKind {
    /// A plane of symmetry.
    Symmetry,
    /// The axis of a body of revolution: images have a negative radius.
    Axis,
    /// A rigid wall in compression only.
    Wall,
}

/// Mirror image of a particle at one or several planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image<const D: usize> {
    pub source: u32,
    /// Twice the position of the mirror plane across each coordinate, m, or zero.
    twice: [f64; D],
    /// Sign of each coordinate, 1 or -1.
    pub flips: [f64; D],
    /// Factor of radius times stress in radial forces, -1 beyond an axis: the product is zero at the axis, and a uniform stress does not
    /// accelerate. Axial forces use its magnitude, so that a pair and its image conserve momentum.
    pub radial: f64,
    /// Axis normal to the mirror wall, if any.
    pub wall: Option<usize>,
}

impl<const D: usize> Image<D> {
    pub fn place(&self, x: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|d| self.flips[d].mul_add(x[d], self.twice[d]))
    }
    pub fn turn(&self, v: &[f64; 4]) -> [f64; 4] {
        let mut turned = *v;
        (0..D).for_each(|d| turned[d] *= self.flips[d]);
        turned
    }
    /// Mirror a tensor, given by columns; in the plane each column stores two tensors side by side.
    pub fn tensor(&self, of: &[[f64; 4]; D]) -> [[f64; 4]; D] {
        let mut turned = *of;
        for (c, column) in turned.iter_mut().enumerate() {
            for d in 0..D {
                column[d] *= self.flips[d] * self.flips[c] * if d == 0 { self.radial } else { 1.0 };
                if D == 2 {
                    column[2 + d] *= self.flips[d] * self.flips[c];
                }
            }
        }
        turned
    }
}

/// Mirror images of all particles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Images<const D: usize> {
    pub all: Vec<Image<D>>,
}

impl<const D: usize> Images<D> {
    /// Find the images of the particles at `places` that may be within reach of a particle, now or after displacements of up to half a
    /// `skin` each. `smoothing` is half the reach of each particle.
    pub fn find(mirrors: &[Mirror], places: &[[f64; D]], smoothing: &[f64], skin: f64) -> Self {
        let largest = smoothing.iter().fold(0.0f64, |m, h| m.max(*h));
        let mut all: Vec<Image<D>> = Vec::new();
        for mirror in mirrors {
            let axis = mirror.axis;
            let near = |source: usize| {
                (places[source][axis] - mirror.at) * mirror.sign <= smoothing[source] + largest + skin
            };
            let radial = if mirror.kind == MirrorKind::Axis { -1.0 } else { 1.0 };
            let wall = (mirror.kind == MirrorKind::Wall).then_some(axis);
            let images = all.len();
            for n in (0..places.len()).filter(|&n| near(n)) {
                let (mut flips, mut twice) = ([1.0; D], [0.0; D]);
                (flips[axis], twice[axis]) = (-1.0, 2.0 * mirror.at);
                all.push(Image { source: n as u32, twice, flips, radial, wall });
            }
            // Mirror the images once more at planes normal to other axes.
            for n in 0..images {
                let mut image = all[n];
                if image.flips[axis] == 1.0 && near(image.source as usize) {
                    (image.flips[axis], image.twice[axis]) = (-1.0, 2.0 * mirror.at);
                    image.radial *= radial;
                    image.wall = wall.or(image.wall);
                    all.push(image);
                }
            }
        }
        Images { all }
    }

    pub fn bytes(&self) -> usize {
        self.all.capacity() * size_of::<Image<D>>()
    }

    /// Fill the places and smoothing lengths of images from those of their particles.
    pub fn fill_places(&self, records: &mut Records<D>) {
        let particles = records.particles;
        for (n, image) in self.all.iter().enumerate() {
            let (from, to) = (image.source as usize, particles + n);
            let place = records.place[from];
            let x: [f64; D] = std::array::from_fn(|d| place[d]);
            records.place[to] = place;
            records.place[to][..D].copy_from_slice(&image.place(&x));
            records.smoothing[to] = records.smoothing[from];
        }
    }
    /// Fill the velocities of images.
    pub fn fill_velocities(&self, records: &mut Records<D>) {
        let particles = records.particles;
        for (n, image) in self.all.iter().enumerate() {
            records.velocity[particles + n] = image.turn(&records.velocity[image.source as usize]);
        }
    }
    /// Fill the densities of images and the density gradients.
    pub fn fill_densities(&self, records: &mut Records<D>) {
        let particles = records.particles;
        for (n, image) in self.all.iter().enumerate() {
            records.density[particles + n] = image.turn(&records.density[image.source as usize]);
        }
    }
    /// Fill the stresses of images and the records of stabilisations.
    pub fn fill_tensors(&self, records: &mut Records<D>) {
        let particles = records.particles;
        for (n, image) in self.all.iter().enumerate() {
            let (from, to) = (image.source as usize, particles + n);
            records.tensor[to] = image.tensor(&records.tensor[from]);
            if !records.artificial.is_empty() {
                records.artificial[to] = image.tensor(&records.artificial[from]);
            }
            if !records.balance.is_empty() {
                records.balance[to] = image.tensor(&records.balance[from]);
            }
            if !records.fluid.is_empty() {
                records.fluid[to] = records.fluid[from];
            }
            if !records.bias.is_empty() {
                records.bias[to] = records.bias[from];
                let now = records.now[from];
                let first = if D == 2 { 2 } else { 0 };
                let x: [f64; D] = std::array::from_fn(|d| now[first + d]);
                records.now[to][first..first + D].copy_from_slice(&image.place(&x));
            }
        }
    }
}
