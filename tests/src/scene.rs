//! Test scenes of a few hundred particles that cross cells and blocks.

use mpm_core::geometry::{Lattice, Seeds};
use mpm_core::{Boundary, Side};
use mpm_materials::{LinearElastic, Moduli, NeoHookean};

use crate::reference::Space;

/// Initial velocity field: velocity as a function of position.
pub type Flow<const D: usize> = Box<dyn Fn([f64; D]) -> [f64; D]>;

/// Bodies, boundaries, gravity and time stepping of a test.
pub struct Scene<const D: usize> {
    /// Name in messages.
    pub name: &'static str,
    /// Background grid.
    pub lattice: Lattice<D>,
    /// Particle seeds and initial velocity of each body.
    pub bodies: Vec<(Seeds<D>, Flow<D>)>,
    /// Boundaries.
    pub boundaries: Vec<Boundary<D>>,
    /// Gravitational acceleration of all material.
    pub gravity: [f64; D],
    /// Time step.
    pub dt: f64,
    /// Number of steps.
    pub steps: usize,
    /// Coordinate system: Cartesian or axisymmetric.
    pub space: Space,
}

impl<const D: usize> std::fmt::Debug for Scene<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {:?}", self.name, self.boundaries)?;
        for (seeds, velocity) in &self.bodies {
            for x in &seeds.positions {
                write!(f, "\n  at {x:?} moving {:?}", velocity(*x))?;
            }
        }
        Ok(())
    }
}

/// Young's modulus of the test laws.
pub const YOUNG: f64 = 3.0;
/// Density of the test laws.
pub const DENSITY: f64 = 2.0;

/// Elastic moduli with Poisson's ratio 0.3.
pub fn moduli() -> Moduli<f64> {
    Moduli::young_poisson(YOUNG, 0.3).expect("moduli")
}
/// Return the hyperelastic test law (neo-Hookean).
pub fn rubber() -> NeoHookean<f64> {
    NeoHookean::new(DENSITY, moduli()).expect("law")
}
/// Return the hypoelastic test law (linear elastic).
pub fn metal() -> LinearElastic<f64> {
    LinearElastic::new(DENSITY, moduli()).expect("law")
}
/// P-wave speed at rest.
pub fn wave_speed() -> f64 {
    (moduli().p_wave() / DENSITY).sqrt()
}

/// Pseudo-random number generator (SplitMix64) for -1 .. 1; equal `start` values yield equal sequences.
pub struct Numbers(u64);

impl Numbers {
    /// Seed the generator.
    pub fn new(start: u64) -> Self {
        Numbers(start.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5DEE_CE66_D1CE_4E5B)
    }
    /// Return the next number.
    pub fn draw(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Return seeds at the given positions with equal volumes.
pub fn seeds<const D: usize>(positions: Vec<[f64; D]>, volume: f64, half_size: f64) -> Seeds<D> {
    let volumes = vec![volume; positions.len()];
    Seeds::placed(positions, volumes, [half_size; D])
}

/// Return a block of `cells` cells from node `low` with `per_axis` particles per axis and cell. Each particle is
/// displaced by up to `jitter` times half its size; volumes vary likewise.
pub fn block<const D: usize>(
    lattice: &Lattice<D>,
    low: [i64; D],
    cells: [usize; D],
    per_axis: usize,
    jitter: f64,
) -> Seeds<D> {
    let h = lattice.spacing();
    let mut random = Numbers::new(cells.iter().sum::<usize>() as u64 + 17);
    let counts = cells.map(|c| c * per_axis);
    let mut positions = Vec::new();
    for mut rest in 0..counts.iter().product() {
        let mut x = lattice.node(low);
        for d in 0..D {
            let at = (rest % counts[d]) as f64 + 0.5 + 0.5 * jitter * random.draw();
            x[d] += at / per_axis as f64 * h;
            rest /= counts[d];
        }
        positions.push(x);
    }
    let volume = (h / per_axis as f64).powi(D as i32);
    let mut seeds = seeds(positions, volume, 0.5 * h / per_axis as f64);
    for v in &mut seeds.volumes {
        *v *= 1.0 + 0.3 * jitter * random.draw();
    }
    seeds
}

/// Return a lattice with an arbitrary origin.
pub fn lattice<const D: usize>() -> Lattice<D> {
    let mut origin = [0.0; D];
    origin.copy_from_slice(&[-0.37, 0.21, 0.083][..D]);
    Lattice::new(origin, 0.1).expect("lattice")
}

/// Return a free block in translation, shear, rotation and dilatation; its particles cross cells and blocks.
pub fn flow<const D: usize>() -> Scene<D> {
    let lattice = lattice::<D>();
    let cells = if D == 2 { [5; D] } else { [3; D] };
    let seeds = block(&lattice, [-2; D], cells, 2, 0.7);
    let (c, centre) = (wave_speed(), lattice.node([0; D]));
    let velocity = move |x: [f64; D]| {
        let mut v = [0.0; D];
        for d in 0..D {
            let (r, s) = (x[d] - centre[d], x[(d + 1) % D] - centre[(d + 1) % D]);
            let turn = if d % 2 == 0 { -1.0 } else { 1.0 };
            v[d] = c * (0.35 - 0.1 * d as f64 + 0.4 * turn * s - 0.3 * r + 0.2 * (9.0 * s).sin() * r);
        }
        v
    };
    Scene {
        name: "flow",
        lattice,
        bodies: vec![(seeds, Box::new(velocity))],
        boundaries: vec![],
        gravity: [0.0; D],
        dt: 0.2 * 0.1 / c,
        steps: 40,
        space: Space::Cartesian,
    }
}

/// Return a quarter (2D: half) of a bar that hits a moving wall, with symmetry planes and gravity.
pub fn bar<const D: usize>() -> Scene<D> {
    let lattice = lattice::<D>();
    let cells = if D == 2 { [3, 6, 0] } else { [2, 2, 4] };
    let mut size = [0; D];
    size.copy_from_slice(&cells[..D]);
    let plane = lattice.node([1; D]);
    let seeds = block(&lattice, [1; D], size, 2, 0.5);
    let c = wave_speed();
    let velocity = move |_: [f64; D]| {
        let mut v = [0.0; D];
        v[D - 1] = -0.3 * c;
        v
    };
    let mut boundaries = vec![];
    for axis in 0..D - 1 {
        boundaries.push(Boundary::Symmetry { axis, at: plane[axis], side: Side::Above });
    }
    boundaries.push(Boundary::Wall {
        axis: D - 1,
        at: plane[D - 1] - 0.013,
        side: Side::Above,
        velocity: 0.02 * c,
    });
    let mut gravity = [0.0; D];
    gravity[D - 1] = -0.4;
    Scene {
        name: "bar",
        lattice,
        bodies: vec![(seeds, Box::new(velocity))],
        boundaries,
        gravity,
        dt: 0.2 * 0.1 / c,
        steps: 40,
        space: Space::Cartesian,
    }
}

/// Return a block that slides and tumbles on a moving rough floor into a rough wall.
pub fn slide<const D: usize>() -> Scene<D> {
    let lattice = lattice::<D>();
    let cells = if D == 2 { [5; D] } else { [3; D] };
    let seeds = block(&lattice, [1; D], cells, 2, 0.5);
    let (c, corner) = (wave_speed(), lattice.node([1; D]));
    let velocity = move |x: [f64; D]| {
        let mut v = [0.0; D];
        v[0] = c * (-0.1 + 0.5 * (x[D - 1] - corner[D - 1]));
        v[D - 1] = c * (-0.1 - 0.3 * (x[0] - corner[0]));
        v
    };
    let mut moving = [0.0; D];
    (moving[0], moving[D - 1]) = (0.03 * c, 0.01 * c);
    let rough = |axis, velocity, friction| {
        let at = corner[axis] - 0.013;
        Boundary::FrictionWall { axis, at, side: Side::Above, velocity, friction }
    };
    let mut gravity = [0.0; D];
    (gravity[0], gravity[D - 1]) = (-0.2, -0.8);
    Scene {
        name: "slide",
        lattice,
        bodies: vec![(seeds, Box::new(velocity))],
        boundaries: vec![rough(D - 1, moving, 0.4), rough(0, [0.0; D], 0.7)],
        gravity,
        dt: 0.2 * 0.1 / c,
        steps: 60,
        space: Space::Cartesian,
    }
}

/// Return [`bar`] in a moving frame: bar and wall fall 3 m/s faster. Tests Galilean invariance.
pub fn train<const D: usize>() -> Scene<D> {
    let mut scene = bar::<D>();
    scene.name = "train";
    let along = scene.bodies[0].1([0.0; D]);
    let faster = move |_: [f64; D]| {
        let mut v = along;
        v[D - 1] -= 3.0;
        v
    };
    scene.bodies[0].1 = Box::new(faster);
    for boundary in &mut scene.boundaries {
        if let Boundary::Wall { velocity, .. } = boundary {
            *velocity -= 3.0;
        }
    }
    scene
}

/// Return an oblique collision of two blocks above a fixed floor.
pub fn collision<const D: usize>() -> Scene<D> {
    let lattice = lattice::<D>();
    let cells = if D == 2 { [3; D] } else { [2; D] };
    let mut right = [3; D];
    right[1] = 1;
    let (a, b) = (block(&lattice, [0; D], cells, 2, 0.3), block(&lattice, right, cells, 2, 0.8));
    let c = wave_speed();
    let towards = move |speed: f64| {
        move |_: [f64; D]| {
            let mut v = [0.0; D];
            v[0] = speed * c;
            v[1] = -0.1 * c;
            v
        }
    };
    let floor = lattice.node([0; D])[1];
    Scene {
        name: "collision",
        lattice,
        bodies: vec![(a, Box::new(towards(0.2))), (b, Box::new(towards(-0.25)))],
        boundaries: vec![Boundary::Fixed { axis: 1, at: floor, side: Side::Above }],
        gravity: [0.0; D],
        dt: 0.2 * 0.1 / c,
        steps: 30,
        space: Space::Cartesian,
    }
}

/// Return an axisymmetric cylinder (r, z) that hits a wall.
pub fn cylinder() -> Scene<2> {
    let lattice = Lattice::new([0.0, -0.14], 0.1).expect("lattice");
    let mut seeds = block(&lattice, [0, 1], [3, 5], 2, 0.5);
    for (v, x) in seeds.volumes.iter_mut().zip(&seeds.positions) {
        *v *= x[0];
    }
    let wall = lattice.node([0, 1])[1];
    let c = wave_speed();
    Scene {
        name: "cylinder",
        lattice,
        bodies: vec![(seeds, Box::new(move |x| [0.05 * c * x[0], -0.25 * c]))],
        boundaries: vec![
            Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above },
            Boundary::Wall { axis: 1, at: wall, side: Side::Above, velocity: 0.0 },
        ],
        gravity: [0.0, -0.3],
        dt: 0.2 * 0.1 / c,
        steps: 40,
        space: Space::Axisymmetric,
    }
}
