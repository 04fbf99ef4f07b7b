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
    /// Velocity along the axis, m/s.
    pub speed: f64,
    /// Place at the last search for images, m.
    pub searched: f64,
    /// Number of the condition that the mirror stands for, if it follows one.
    pub condition: Option<usize>,
}

impl Mirror {
    /// Create a mirror at rest.
    pub fn new(axis: usize, at: f64, sign: f64, kind: MirrorKind) -> Self {
        Mirror { axis, at, sign, kind, speed: 0.0, searched: at, condition: None }
    }
    /// Return the wall as a boundary condition on particles.
    pub fn wall<const D: usize>(&self) -> Boundary<D> {
        let side = if self.sign > 0.0 { Side::Above } else { Side::Below };
        Boundary::Wall { axis: self.axis, at: self.at, side, velocity: 0.0 }
    }
}

/// Kind of a mirror plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum MirrorKind {
    /// A plane of symmetry.
    Symmetry,
    /// The axis of a body of revolution: images have a negative radius.
    Axis,
    /// A rigid wall in compression only.
    Wall,
    /// A wall along which a liquid slips.
    Slip,
    /// A wall to which a viscous liquid sticks: images have the opposite velocity in shear rates, and its shear stress.
    Stick,
    /// One of two periodic planes: images are translated by this length, m.
    Period(f64),
}

impl MirrorKind {
    /// True for the walls of liquids.
    pub fn bounds_liquid(self) -> bool {
        matches!(self, MirrorKind::Slip | MirrorKind::Stick)
    }
}

/// Mirror image of a particle at one or several planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image<const D: usize> {
    pub source: u32,
    /// Twice the position of the mirror plane across each coordinate, m, or zero.
    twice: [f64; D],
    /// Sign of each coordinate, 1 or -1.
    pub flips: [f64; D],
    /// Velocity that walls that move add, m/s.
    gains: [f64; D],
    /// Axes across which the liquid sticks to the mirror.
    pub sticks: [bool; D],
    /// Mirrors across each axis: their number and one, or zero.
    pub mirrors: [u16; D],
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
    /// Mirror a velocity.
    pub fn velocity(&self, v: &[f64; 4]) -> [f64; 4] {
        let mut turned = *v;
        (0..D).for_each(|d| turned[d] = self.flips[d].mul_add(v[d], self.gains[d]));
        turned
    }
    /// Mirror a gradient.
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
                // The shear stress that acts along a wall to which a liquid sticks is the same on both sides.
                let along = if self.sticks[c] && d != c { -1.0 } else { 1.0 };
                column[d] *= self.flips[d] * self.flips[c] * along * if d == 0 { self.radial } else { 1.0 };
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
        for (number, mirror) in mirrors.iter().enumerate() {
            let axis = mirror.axis;
            let across = |image: &mut Image<D>| {
                image.mirrors[axis] = number as u16 + 1;
                if let MirrorKind::Period(by) = mirror.kind {
                    image.twice[axis] = by;
                    return;
                }
                (image.flips[axis], image.twice[axis]) = (-1.0, 2.0 * mirror.at);
                image.sticks[axis] = mirror.kind == MirrorKind::Stick;
            };
            let near = |source: usize| {
                (places[source][axis] - mirror.at) * mirror.sign <= smoothing[source] + largest + skin
            };
            let radial = if mirror.kind == MirrorKind::Axis { -1.0 } else { 1.0 };
            let wall = (mirror.kind == MirrorKind::Wall).then_some(axis);
            let images = all.len();
            for n in (0..places.len()).filter(|&n| near(n)) {
                let one = [1.0; D];
                let mut image = Image {
                    source: n as u32,
                    twice: [0.0; D],
                    flips: one,
                    gains: [0.0; D],
                    sticks: [false; D],
                    mirrors: [0; D],
                    radial,
                    wall,
                };
                across(&mut image);
                all.push(image);
            }
            // Mirror the images once more at planes normal to other axes.
            for n in 0..images {
                let mut image = all[n];
                if image.mirrors[axis] == 0 && near(image.source as usize) {
                    across(&mut image);
                    image.radial *= radial;
                    image.wall = wall.or(image.wall);
                    all.push(image);
                }
            }
        }
        let mut images = Images { all };
        images.follow(mirrors);
        images
    }

    /// Move the images with mirrors that follow a condition.
    pub fn follow(&mut self, mirrors: &[Mirror]) {
        if mirrors.iter().all(|mirror| mirror.condition.is_none()) {
            return;
        }
        for image in &mut self.all {
            for d in 0..D {
                let number = usize::from(image.mirrors[d]);
                let mirror = number.checked_sub(1).and_then(|n| mirrors.get(n));
                let Some(mirror) = mirror.filter(|mirror| mirror.kind.bounds_liquid()) else { continue };
                image.twice[d] = 2.0 * mirror.at;
                image.gains[d] = if mirror.kind == MirrorKind::Slip { 2.0 * mirror.speed } else { 0.0 };
            }
        }
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
            records.velocity[particles + n] = image.velocity(&records.velocity[image.source as usize]);
        }
    }
    /// Fill the densities of images and the density gradients.
    pub fn fill_densities(&self, records: &mut Records<D>) {
        let particles = records.particles;
        for (n, image) in self.all.iter().enumerate() {
            let source = image.source as usize;
            records.density[particles + n] = image.turn(&records.density[source]);
            records.diffuses[particles + n] = records.diffuses[source];
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
