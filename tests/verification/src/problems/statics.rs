//! Static solutions of elastic bodies in the reference configuration by kinetic damping (dynamic relaxation): V15
//! and V17.

use std::sync::Arc;

use mpm_core::geometry::{Cuboid, Lattice, Seeds};
use mpm_core::{
    BlockGrid, Boundary, Deformable, Flip, IntoKernels, Linear, Method, Mpm, Musl, PlaneStrain,
    QuadraticBSpline, Rest, Rested, Side, TimeControl, Traction,
};
use mpm_materials::{IntoMaterial, LinearElastic, Moduli};

use crate::problems::rubber;

/// Static solution.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Displacement of the requested point, m.
    pub displacement: [f64; 2],
    /// Convergence to rest.
    pub rested: Rested,
    /// Number of stops of kinetic damping.
    pub stops: u64,
    /// Number of steps.
    pub steps: u64,
    /// Number of particles.
    pub particles: usize,
}

/// Static problem: body, load, boundary conditions and convergence criterion.
struct Statics<C> {
    lattice: Lattice<2>,
    seeds: Seeds<2>,
    law: C,
    /// Region of particles that carry the traction.
    loaded: Cuboid<2>,
    /// Traction, Pa, on a face normal to x.
    traction: [f64; 2],
    held: Vec<Boundary<2>>,
    dt: f64,
    rest: Rest,
    end: f64,
}

fn said(error: impl std::fmt::Display) -> String {
    error.to_string()
}

impl<C: IntoMaterial<f64>> Statics<C> {
    /// Apply the load suddenly and relax to rest; return displacements by particle.
    fn rest(self, method: impl IntoKernels<f64, 2>) -> Result<(State, Vec<[f64; 2]>), String> {
        let Statics { lattice, seeds, law, loaded, traction, held, dt, rest, end } = self;
        let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
        let load = Traction {
            region: Arc::new(loaded),
            axis: 0,
            history: Arc::new(move |_| traction),
            revolved: false,
        };
        mpm.add_body(Deformable::new("body", law, &seeds).with_traction(load)).map_err(said)?;
        for boundary in held {
            mpm.bound(boundary).map_err(said)?;
        }
        mpm.set_time_control(TimeControl::Fixed(dt)).map_err(said)?;
        mpm.set_kinetic_damping(true).map_err(said)?;
        let rested = mpm.run_to_rest(&rest, end).map_err(said)?;
        let mut moved = vec![[0.0; 2]; seeds.positions.len()];
        mpm.bodies()[0].for_each(&mut |p| {
            let start = seeds.positions[p.number];
            moved[p.number] = [p.position[0] - start[0], p.position[1] - start[1]];
        });
        let state = State {
            displacement: [0.0; 2],
            rested,
            stops: mpm.stops(),
            steps: mpm.steps(),
            particles: moved.len(),
        };
        Ok((state, moved))
    }
}

/// Fill the quadrilateral with corners at (0, 0), (1, 0), (1, 1), (0, 1) of `map` by rows of `counts` particles, each with
/// the volume of its cell; `half` is their half size.
fn mapped(map: impl Fn(f64, f64) -> [f64; 2], counts: [usize; 2], half: [f64; 2]) -> Seeds<2> {
    let (mut positions, mut volumes) = (Vec::new(), Vec::new());
    let step = counts.map(|n| 1.0 / n as f64);
    for j in 0..counts[1] {
        for i in 0..counts[0] {
            let corner = |a: f64, b: f64| map((i as f64 + a) * step[0], (j as f64 + b) * step[1]);
            let [p, q, r, s] = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
            positions.push(corner(0.5, 0.5));
            // Cell area: half the cross product of the diagonals.
            volumes.push(0.5 * ((r[0] - p[0]) * (s[1] - q[1]) - (r[1] - p[1]) * (s[0] - q[0])));
        }
    }
    Seeds::placed(positions, volumes, half)
}

/// Run V17, Cook's membrane: (0, 0), (48, 44), (48, 60), (0, 44) m, fixed at x = 0, total shear load of 1 N per metre of depth at x = 48,
/// plane stress, E 1 Pa, nu 1/3: the middle of the right side moves up by 23.96 m in linear elasticity \[V\].
///
/// The load is 1e-4 of that, and the returned displacement is divided by 1e-4. Plane strain with E (1 + 2 nu) / (1 + nu)^2 and nu / (1 +
/// nu) equals plane stress with E and nu. Linear shape functions, `cells` over the 48 m, two rows of particles per cell aligned with the
/// quadrilateral.
///
/// # Errors
/// Error that stopped the run.
pub fn cook(cells: usize) -> Result<State, String> {
    let (young, nu, share) = (1.0, 1.0 / 3.0, 1e-4);
    let h = 48.0 / cells as f64;
    let moduli = Moduli::young_poisson(young * (1.0 + 2.0 * nu) / (1.0f64 + nu).powi(2), nu / (1.0 + nu));
    let moduli = moduli.map_err(said)?;
    let law = LinearElastic::new(1.0, moduli).map_err(said)?;
    let c = moduli.p_wave().sqrt();
    // Row heights: at x = 48 they are 16 / 44 of those at x = 0, half a cell.
    let counts = [2 * cells, (2.0 * 44.0 / h).round() as usize];
    let (width, height) = (0.5 * h, 16.0 / counts[1] as f64);
    let corners = |a: f64, b: f64| [48.0 * a, 44.0 * a + b * (44.0 - 28.0 * a)];
    let seeds = mapped(corners, counts, [0.5 * width, 0.5 * height]);
    let statics = Statics {
        lattice: Lattice::new([0.0; 2], h).map_err(said)?,
        seeds: seeds.clone(),
        law,
        loaded: Cuboid::new([48.0 - width, 0.0], [48.0, 60.0]).map_err(said)?,
        traction: [0.0, share / 16.0],
        held: vec![Boundary::Fixed { axis: 0, at: 0.0, side: Side::Above }],
        dt: 0.5 * h / c,
        rest: Rest::new(1e-3, 1e-6, 100.0).map_err(said)?.every(50).map_err(said)?,
        end: 2e4,
    };
    let method = Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian();
    let (mut state, moved) = statics.rest(method)?;
    // Displacement of the middle of the right side, extrapolated from the two columns at half and one and a half
    // particles.
    let column = |back: usize| {
        let rows = (0..counts[1]).map(|j| moved[j * counts[0] + counts[0] - 1 - back]);
        rows.fold([0.0; 2], |sum, u| [sum[0] + u[0], sum[1] + u[1]]).map(|x| x / counts[1] as f64)
    };
    let (last, before) = (column(0), column(1));
    for d in 0..2 {
        state.displacement[d] = (last[d] + 0.5 * (last[d] - before[d])) / share;
    }
    Ok(state)
}

/// Slenderness: length over height of the cantilever.
pub const SLENDERNESS: f64 = 20.0;

/// Run V15, a cantilever of height 1 m and length 20 m under a dead load P at its end, P L^2 / (E I) = `load`, nu = 0:
/// displacement of the end over the length. Quadratic splines, `cells` over the height, two rows of particles per cell.
/// The root is a symmetry plane whose nodes are fixed vertically, so that it neither rotates nor resists lateral strain.
///
/// # Errors
/// Error that stopped the run.
pub fn cantilever(cells: usize, load: f64) -> Result<State, String> {
    let (young, length) = (12.0, SLENDERNESS);
    let h = 1.0 / cells as f64;
    let lattice = Lattice::new([0.0; 2], h).map_err(said)?;
    let counts = [2 * cells * SLENDERNESS as usize, 2 * cells];
    let seeds = mapped(|a, b| [length * a, b], counts, [0.25 * h; 2]);
    // Load from P L^2 / (E I) with I = 1 / 12.
    let force = load * young / 12.0 / length.powi(2);
    let c = young.sqrt();
    let plane = Cuboid::new([-0.1 * h, -10.0], [0.1 * h, 11.0]).map_err(said)?;
    let period = 1.787 * length * length * 12f64.sqrt() / c;
    let statics = Statics {
        lattice,
        seeds: seeds.clone(),
        law: rubber(1.0, young, 0.0)?,
        loaded: Cuboid::new([length - 0.5 * h, 0.0], [length, 1.0]).map_err(said)?,
        traction: [0.0, force],
        held: vec![
            Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above },
            Boundary::Prescribed { region: Arc::new(plane), velocity: Arc::new(|_| [None, Some(0.0), None]) },
        ],
        dt: 0.6 * h / c,
        rest: Rest::new(1e-3, 1e-6, 0.1 * period).map_err(said)?.every(200).map_err(said)?,
        end: 10.0 * period,
    };
    let method = Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain).total_lagrangian().compiled();
    let (mut state, moved) = statics.rest(method)?;
    // Displacements of the middle line at root and end, each from the two adjacent columns.
    let column = |i: usize| {
        let rows = (0..counts[1]).map(|j| moved[j * counts[0] + i]);
        rows.fold([0.0; 2], |sum, u| [sum[0] + u[0], sum[1] + u[1]]).map(|x| x / counts[1] as f64)
    };
    let n = counts[0];
    let (end, before) = (column(n - 1), column(n - 2));
    for d in 0..2 {
        // Even symmetry in x at the root: its two columns are equally accurate.
        let root = if d == 1 { column(0)[1] } else { 0.0 };
        state.displacement[d] = (end[d] + 0.5 * (end[d] - before[d]) - root) / length;
    }
    Ok(state)
}

/// Displacement of the end of a beam over its length, [back, aside], under a transverse dead load P, P L^2 / (E I)
/// = `load`: theta' = M / (E I). With `stretch` = I / (A L^2) and `shear` = E I / (k G A L^2) non-zero, the centre
/// line also stretches and shears (Reissner 1972). With both zero it is Euler's elastica.
///
/// With s over L, moments over E I / L: theta'' = -load (x'), x' = (1 + n stretch) cos theta - q shear sin theta,
/// y' = (1 + n stretch) sin theta + q shear cos theta, n = load sin theta, q = load cos theta. Integration by the
/// fourth-order Runge-Kutta method with 4000 steps from the root; bisection finds the root moment for zero moment
/// at the end.
pub fn beam(load: f64, stretch: f64, shear: f64) -> [f64; 2] {
    // State vector: theta, theta', x, y.
    let slope = |z: [f64; 4]| {
        let (sin, cos) = z[0].sin_cos();
        let (along, across) = (1.0 + load * sin * stretch, load * cos * shear);
        let x = along * cos - across * sin;
        [z[1], -load * x, x, along * sin + across * cos]
    };
    let end = |moment: f64| {
        let (steps, mut z) = (4000, [0.0, moment, 0.0, 0.0]);
        let ds = 1.0 / f64::from(steps);
        let ahead = |z: [f64; 4], k: [f64; 4], by: f64| std::array::from_fn(|i| z[i] + by * k[i]);
        for _ in 0..steps {
            let a = slope(z);
            let b = slope(ahead(z, a, 0.5 * ds));
            let c = slope(ahead(z, b, 0.5 * ds));
            let d = slope(ahead(z, c, ds));
            z = std::array::from_fn(|i| z[i] + ds / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        z
    };
    // Bracket of the root moment: zero, and that of a rigid beam.
    let (mut low, mut high) = (0.0, load);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if end(middle)[1] > 0.0 { high = middle } else { low = middle }
    }
    let z = end(0.5 * (low + high));
    [1.0 - z[2], z[3]]
}
