//! Scenes in addition to those of `throughput`.

use std::f64::consts::PI;

use examples::throughput::lattice_points;
use examples::{CaseError, Ogive};
use mpm_contact::{Coulomb, Gradients, Pairs, SurfaceDistance};
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::{
    BlockGrid, Boundary, ContactAlgorithm, DenseGrid, Flip, FullSpace, GridContact, GridStorage, IntoKernels,
    Linear, Method, Mpm, Musl, Side, TimeControl,
};
use mpm_materials::{IntoMaterial, LinearElastic, Moduli, library};

/// Three-dimensional method with linear shape functions, FLIP and MUSL.
pub type LinearFlip = Method<Linear, Flip, Musl, FullSpace>;

/// Create a [`LinearFlip`] method.
pub fn linear_flip() -> LinearFlip {
    Method::new(Linear, Flip, Musl, FullSpace)
}

/// Coulomb contact detected by the surface distance.
pub fn contact(friction: f64) -> Result<impl ContactAlgorithm<f64, 3> + use<>, CaseError> {
    let detector = SurfaceDistance::new(Gradients::default(), 0.0)?;
    Ok(GridContact::new(detector, Pairs::new(Coulomb::new(friction)?)))
}

/// Build W1: head-on collision of two elastic blocks of 25 x 25 x 20 cells with eight particles per cell, h = 1,
/// rho = 1, E = 100, nu = 0.3, v = 0.3, dt = 0.3 h / c.
pub fn blocks(method: impl IntoKernels<f64, 3>, law: impl IntoMaterial<f64>) -> Result<Mpm<3>, CaseError> {
    let mut mpm = Mpm::new(method, BlockGrid::new(Lattice::new([0.0; 3], 1.0)?));
    // Peers begin at 3.5 and 24.5: half a cell off the nodes along z.
    let mut seeds = lattice_points([3, 3, 3], [28, 28, 23], 1.0, |_| true);
    seeds.positions.iter_mut().for_each(|x| x[2] += 0.5);
    let mut upper = lattice_points([3, 3, 24], [28, 28, 44], 1.0, |_| true);
    upper.positions.iter_mut().for_each(|x| x[2] += 0.5);
    seeds.positions.extend(upper.positions);
    seeds.volumes.extend(upper.volumes);
    seeds.raw_measure += upper.raw_measure;
    let speed = |x: [f64; 3]| [0.0, 0.0, if x[2] < 24.0 { 0.3 } else { -0.3 }];
    mpm.add("blocks", law, &seeds, speed)?;
    let c = (100.0_f64 * (1.0 - 0.3) / ((1.0 + 0.3) * (1.0 - 2.0 * 0.3))).sqrt();
    mpm.set_time_control(TimeControl::Fixed(0.3 / c))?;
    Ok(mpm)
}

/// Build S3: off-centre collision of two balls of about `particles` particles in total, with a gap of 0.1 cells; dt
/// = 0.19. They are two bodies, or one.
pub fn balls(
    particles: usize,
    two: bool,
    contact: impl ContactAlgorithm<f64, 3>,
) -> Result<Mpm<3>, CaseError> {
    let radius = (particles as f64 / 8.0 / (8.0 * PI / 3.0)).cbrt();
    let (around, off) = (radius.ceil(), 0.3 * radius);
    let far = ((2.0 * radius + 0.1).powi(2) - off * off).sqrt();
    let ball = |b: f64| -> Seeds<3> {
        let centre = [8.0 + around + b * far, 8.0 + around, 8.0 + around + b * off];
        let low = centre.map(|c| c as i64 - around as i64 - 1);
        let high = centre.map(|c| c as i64 + around as i64 + 2);
        let from = |x: [f64; 3]| (0..3).map(|d| (x[d] - centre[d]).powi(2)).sum::<f64>();
        lattice_points(low, high, 1.0, |x| from(x) < radius * radius)
    };
    let middle = 8.0 + around + 0.5 * far;
    let speed = move |x: [f64; 3]| {
        let s = if x[0] < middle { 0.05 } else { -0.05 };
        [s, 0.005, 0.05 * s]
    };
    let law = LinearElastic::new(1.0, Moduli::bulk_shear(1.0 + 1.6 / 3.0, 0.8)?)?;
    let mut mpm = Mpm::with_contact(linear_flip(), BlockGrid::new(Lattice::new([0.0; 3], 1.0)?), contact);
    let (mut one, other) = (ball(0.0), ball(1.0));
    if two {
        mpm.add("left", law, &one, speed)?;
        mpm.add("right", law, &other, speed)?;
    } else {
        one.positions.extend(other.positions);
        one.volumes.extend(other.volumes);
        one.raw_measure += other.raw_measure;
        mpm.add("both", law, &one, speed)?;
    }
    mpm.set_time_control(TimeControl::Fixed(0.19))?;
    Ok(mpm)
}

/// Oblique penetration of the size of \[Ma2010\]: half an ogive rod, 12.9 x 88.9 mm, in front of half a plate of 26.3
/// mm, at 575 m/s and 30 degrees.
pub struct Penetration {
    spacing: f64,
    rod: Seeds<3>,
    plate: Seeds<3>,
}

const ROD: Ogive = Ogive { diameter: 12.9e-3, length: 88.9e-3, crh: 3.0 };
const THICKNESS: f64 = 26.3e-3;
const HALF_WIDTH: f64 = 63.0e-3;
const ANGLE: f64 = PI / 6.0;
const SPEED: f64 = 575.0;

impl Penetration {
    /// Create the scene with about this number of particles.
    pub fn new(particles: usize) -> Result<Self, CaseError> {
        let volume = THICKNESS * 2.0 * HALF_WIDTH * HALF_WIDTH + 0.5 * ROD.volume()?;
        let cells = (THICKNESS / (8.0 * volume / particles as f64).cbrt()).round().max(2.0);
        let h = THICKNESS / cells;
        let lattice = Lattice::new([0.0; 3], h)?;
        let tip = [-0.25 * h * ANGLE.sin(), 0.0, 0.25 * h * ANGLE.cos()];
        let (rod, _) = ROD.rings(tip, ANGLE, PI, 0.5 * h)?;
        let middle = 0.5 * THICKNESS * ANGLE.tan();
        let plate =
            Cuboid::new([middle - HALF_WIDTH, 0.0, -THICKNESS], [middle + HALF_WIDTH, HALF_WIDTH, 0.0])?;
        let plate = fill(&plate, &lattice, 2, &Filling::new())?;
        Ok(Penetration { spacing: h, rod, plate })
    }

    /// Create the solver on a grid with a contact algorithm.
    pub fn solver(
        &self,
        grid: impl GridStorage<f64, 3> + 'static,
        contact: impl ContactAlgorithm<f64, 3>,
    ) -> Result<Mpm<3>, CaseError> {
        let mut mpm = Mpm::with_contact(linear_flip(), grid, contact);
        let steel = LinearElastic::new(7830.0, Moduli::young_poisson(206e9, 0.3)?)?;
        let aluminium = library::aluminium_6061_t6().with_bulk_viscosity(0.06, 1.5)?;
        let velocity = [SPEED * ANGLE.sin(), 0.0, -SPEED * ANGLE.cos()];
        mpm.add("rod", steel, &self.rod, |_| velocity)?;
        mpm.add("plate", aluminium, &self.plate, |_| [0.0; 3])?;
        mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above })?;
        mpm.set_time_control(TimeControl::Fixed(0.25 * self.spacing / 6400.0))?;
        Ok(mpm)
    }

    /// Create a block grid.
    pub fn blocks(&self) -> Result<BlockGrid<f64, 3>, CaseError> {
        Ok(BlockGrid::new(Lattice::new([0.0; 3], self.spacing)?))
    }

    /// Create a dense grid over the bounding box of the whole flight, the rod's path in front of and behind the
    /// plate; return it with its number of cells.
    pub fn dense(&self) -> Result<(DenseGrid<f64, 3>, usize), CaseError> {
        let flight = ROD.length * ANGLE.cos();
        let low = [-2.0 * HALF_WIDTH, 0.0, -THICKNESS - 1.2 * flight];
        let high = [2.0 * HALF_WIDTH, HALF_WIDTH, 1.2 * flight];
        let node = |x: f64| (x / self.spacing).round() as i32;
        let (low, high) = (low.map(|x| node(x) - 2), high.map(|x| node(x) + 2));
        let cells = (0..3).map(|d| (high[d] - low[d]) as usize).product();
        let lattice = Lattice::new([0.0; 3], self.spacing)?;
        let grid = DenseGrid::new(lattice, low, high).map_err(|e| CaseError::Other(e.to_string()))?;
        Ok((grid, cells))
    }
}
