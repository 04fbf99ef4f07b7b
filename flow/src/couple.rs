//! Coupling of free rigid bodies to the pressure.
//!
//! The closed part of a face, 1 - alpha, moves with the body, w_f = N_f V, with the velocities V of the body, three in the plane and six in
//! space. The net outflow of cell c through its closed parts is G_c V, and the pressure p, work-conjugate to it, has the impulse
//! rho h^D G^T q on the body, q = p dt / (rho h). With V = V* + rho h^D M^-1 G^T q the pressure equation becomes
//!
//! ```text
//! (A + rho h^D G M^-1 G^T) q = -(D u* + G V*),
//! ```
//!
//! symmetric and positive (semi)definite as A is. Liquid at closed faces has the velocity of the body across its surface: its mass is part
//! of M. What else the body takes from the liquid follows from the change of momentum at the faces near its surface, and acts in the next
//! step.

use crate::blocks::{Blocks, NONE};
use crate::coupled::Column;
use crate::grid::Grid;
use crate::particles::Frame;
use crate::rigid::{Floater, Twist};
use crate::surface::{LIQUID, SOLID, host};
use crate::transfer::face_centre;
use crate::wall::Walls;

/// Distance from the surface of a body, in cells, within which faces share their liquid with it.
pub(crate) const REACH: f64 = 1.25;

/// Depth in a body, in cells, from which faces have no part in its motion.
pub(crate) const DEEP: f64 = 2.0;

/// Face near the surface of a body.
#[derive(Clone, Copy)]
struct Face<const D: usize> {
    axis: usize,
    slot: u32,
    below: u32,
    /// Row of an impulse along the axis.
    row: Twist,
    /// Row of the velocity across the surface, and the component of its normal along the axis.
    across: Twist,
    normal: f64,
}

/// Geometry of a body among the cells.
#[derive(Clone)]
pub(crate) struct Surroundings<const D: usize> {
    /// G: a row of each liquid cell beside the surface.
    rows: Vec<(u32, Twist)>,
    faces: Vec<Face<D>>,
}

/// Coupling of a body in a step.
#[derive(Clone)]
pub(crate) struct Coupling<const D: usize> {
    pub around: Surroundings<D>,
    /// Velocities with forces and contact and without pressure.
    pub free: Twist,
    /// Momentum with forces and without pressure.
    momentum: Twist,
    mass: Cholesky,
}

/// Cholesky factor of the mass matrix of the velocities that are not held.
#[derive(Clone)]
pub(crate) struct Cholesky {
    held: [bool; 6],
    lower: [[f64; 6]; 6],
}

impl Cholesky {
    pub fn new(mass: &[[f64; 6]; 6], held: [bool; 6]) -> Self {
        let mut lower = [[0.0; 6]; 6];
        for i in (0..6).filter(|i| !held[*i]) {
            for j in (0..=i).filter(|j| !held[*j]) {
                let sum: f64 = mass[i][j] - (0..j).map(|k| lower[i][k] * lower[j][k]).sum::<f64>();
                lower[i][j] = if i == j { sum.max(f64::MIN_POSITIVE).sqrt() } else { sum / lower[j][j] };
            }
        }
        Cholesky { held, lower }
    }
    /// L^-1 x.
    pub fn half(&self, x: &Twist) -> Twist {
        let mut y = [0.0; 6];
        for i in (0..6).filter(|i| !self.held[*i]) {
            y[i] = (x[i] - (0..i).map(|k| self.lower[i][k] * y[k]).sum::<f64>()) / self.lower[i][i];
        }
        y
    }
    /// Solution of M y = x; zero for velocities that are held.
    pub fn solve(&self, x: &Twist) -> Twist {
        let mut y = self.half(x);
        for i in (0..6).rev().filter(|i| !self.held[*i]) {
            y[i] = (y[i] - (i + 1..6).map(|k| self.lower[k][i] * y[k]).sum::<f64>()) / self.lower[i][i];
        }
        y
    }
}

/// Mass matrix of a body, kg, kg m, kg m^2.
pub(crate) fn mass_of<const D: usize>(body: &Floater<D>) -> [[f64; 6]; 6] {
    let mut mass = [[0.0; 6]; 6];
    let inertia = body.inertia();
    for i in 0..3 {
        mass[i][i] = body.mass;
        (0..3).for_each(|j| mass[3 + i][3 + j] = inertia[i][j]);
    }
    mass
}

pub(crate) fn product(a: &Twist, b: &Twist) -> f64 {
    (0..6).map(|m| a[m] * b[m]).sum()
}

/// Liquid cell whose pressure a cell has: itself, or that beside a pocket or what is narrower between walls.
pub(crate) fn hosts<'a, const D: usize>(
    grid: &'a Grid<D>,
    frame: &'a Frame<D>,
    walls: &'a Walls<'_, D>,
) -> impl Fn(u32) -> u32 + 'a {
    let (kind, cells) = (&grid.surface.kind, Blocks::<D>::CELLS);
    let narrow = move |cell: usize| {
        let (b, i) = (cell / cells, cell % cells);
        let at = crate::blocks::local::<D>(i).map(|x| x as f64 + 0.5);
        kind[cell] == SOLID && walls.gap(frame.place(&grid.blocks.keys[b], &at)).0 > 0.0
    };
    let pocket = move |cell: usize| grid.pockets.binary_search_by_key(&cell, |p| p.0).is_ok() || narrow(cell);
    move |cell: u32| match kind.get(cell as usize) {
        Some(&LIQUID) => cell,
        Some(_) if pocket(cell as usize) => {
            let of = grid.pockets.binary_search_by_key(&(cell as usize), |p| p.0);
            let first = of.map_or(cell as usize, |n| grid.pockets[n].1);
            host(&grid.blocks, kind, first, &pocket).map_or(NONE, |host| host as u32)
        }
        _ => NONE,
    }
}

impl<const D: usize> Surroundings<D> {
    /// Find the faces and cells near body `number`.
    pub fn new(
        (grid, frame): (&Grid<D>, &Frame<D>),
        walls: &Walls<'_, D>,
        (number, body): (usize, &Floater<D>),
    ) -> Self {
        let cells = Blocks::<D>::CELLS;
        let (mut place, mut rows, mut faces) = (vec![NONE; grid.blocks.cells()], Vec::new(), Vec::new());
        let liquid = hosts(grid, frame, walls);
        for (b, cut) in grid.cuts.iter().enumerate() {
            let Some(cut) = cut else { continue };
            for (i, d) in (0..cells).flat_map(|i| (0..D).map(move |d| (i, d))) {
                let at = face_centre::<D>(i, d);
                let (gap, steep, wall) = cut.sample(&at);
                let slot = b * cells + i;
                let open = grid.open[d][slot];
                if walls.list[wall].body != Some(number) || (gap > REACH && open >= 1.0) || gap < -DEEP {
                    continue;
                }
                let x = frame.place(&grid.blocks.keys[b], &at);
                let mut along = [0.0; D];
                along[d] = 1.0;
                let row = body.row(&x, &along);
                let below = grid.blocks.beside(b, i, d, false).map_or(NONE, |s| s as u32);
                for (cell, sign) in [(slot as u32, -1.0), (below, 1.0)] {
                    let cell = liquid(cell);
                    if open < 1.0 && cell != NONE {
                        let n = &mut place[cell as usize];
                        if *n == NONE {
                            *n = rows.len() as u32;
                            rows.push((cell, [0.0; 6]));
                        }
                        let sum = &mut rows[*n as usize].1;
                        (0..6).for_each(|m| sum[m] += sign * (1.0 - open) * row[m]);
                    }
                }
                // Liquid at closed faces has the velocity of the wall along the slope of the distances at nodes.
                let length = steep.iter().map(|s| s * s).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
                let steep = steep.map(|s| s / length);
                let across = body.row(&x, &steep);
                faces.push(Face { axis: d, slot: slot as u32, below, row, across, normal: steep[d] });
            }
        }
        Surroundings { rows, faces }
    }

    /// Subtract the net outflow of cells by a motion of the body.
    pub fn subtract_outflow(&self, twist: &Twist, right: &mut [f64]) {
        for (cell, row) in &self.rows {
            right[*cell as usize] -= product(row, twist);
        }
    }
}

impl<const D: usize> Coupling<D> {
    /// Find the coupling of a body after `kick` seconds of the body force, with the contacts that hold it. `unit` is rho h^D, kg.
    pub fn new(
        around: Surroundings<D>,
        grid: &Grid<D>,
        body: &Floater<D>,
        contacts: &[Support],
        kick: f64,
        unit: f64,
    ) -> Self {
        let momentum = forced(body, kick);
        let free = body.twist_of(&momentum);
        let mut mass = mass_of(body);
        let mut attached = [0.0; 6];
        let mut add = |across: &Twist, share: f64, by: f64, square: f64| {
            for m in 0..6 {
                attached[m] += share * across[m] * by;
                (0..6).for_each(|n| mass[m][n] += share * square * across[m] * across[n]);
            }
        };
        for face in &around.faces {
            let (d, slot) = (face.axis, face.slot as usize);
            if grid.marks[d][slot] == crate::extrapolate::CLOSED {
                let lag = grid.velocity[d][slot] - product(&face.row, &free);
                add(&face.across, unit * grid.volume[d][slot], face.normal * lag, face.normal.powi(2));
            }
        }
        for support in contacts {
            let lag = support.least - product(&support.row, &free);
            add(&support.row, HOLD * body.mass, lag, 1.0);
        }
        let mass = Cholesky::new(&mass, *body.held());
        let change = mass.solve(&attached);
        let free = std::array::from_fn(|m| free[m] + change[m]);
        Coupling { around, free, momentum, mass }
    }

    /// Columns of the operator, by the places of cells in the system.
    pub fn columns(&self, unit: f64, place: impl Fn(u32) -> Option<u32>, into: &mut Vec<Column>) {
        let scale = unit.sqrt();
        let mut columns: [Column; 6] = std::array::from_fn(|_| Vec::new());
        for (cell, row) in &self.around.rows {
            let Some(at) = place(*cell) else { continue };
            let half = self.mass.half(row);
            for m in (0..6).filter(|m| !self.mass.held[*m]) {
                columns[m].push((at, scale * half[m]));
            }
        }
        into.extend(columns.into_iter().filter(|column| !column.is_empty()));
    }

    /// Impulse of the pressure.
    fn pressed(&self, q: &[f64], unit: f64) -> Twist {
        let mut sum = [0.0; 6];
        for (cell, row) in &self.around.rows {
            (0..6).for_each(|m| sum[m] += unit * q[*cell as usize] * row[m]);
        }
        sum
    }

    /// Velocities with the pressure.
    pub fn solved(&self, q: &[f64], unit: f64) -> Twist {
        let by = self.mass.solve(&self.pressed(q, unit));
        std::array::from_fn(|m| self.free[m] + by[m])
    }

    /// Impulse of the liquid on the body in the step: that of the pressure, and what the liquid at the faces near its surface has gained
    /// beside it.
    pub fn impulse(&self, grid: &Grid<D>, unit: f64) -> Twist {
        let mut sum = self.pressed(&grid.pressure, unit);
        let q = |cell: u32| grid.pressure.get(cell as usize).copied().unwrap_or(0.0);
        for face in &self.around.faces {
            let (d, slot) = (face.axis, face.slot as usize);
            let gained = grid.volume[d][slot] * (grid.velocity[d][slot] - grid.before[d][slot]);
            let pushed = grid.open[d][slot] * (q(face.slot) - q(face.below));
            (0..6).for_each(|m| sum[m] -= unit * (gained + pushed) * face.row[m]);
        }
        sum
    }

    /// Part of the impulse `of` the liquid and of contact that the velocities `solved` do not have yet.
    pub fn pending(&self, body: &Floater<D>, of: &Twist, solved: &Twist) -> Twist {
        let has = body.momentum_of(solved);
        std::array::from_fn(|m| if body.held()[m] { 0.0 } else { self.momentum[m] + of[m] - has[m] })
    }
}

/// Momentum of a body after `kick` seconds of the body force, with the impulse that is pending.
pub(crate) fn forced<const D: usize>(body: &Floater<D>, kick: f64) -> Twist {
    let mut momentum = body.momentum;
    (0..D).for_each(|d| momentum[d] += body.mass * kick * body.force[d]);
    (0..6).for_each(|m| momentum[m] += body.pending[m]);
    momentum
}

/// Mass, over that of the body, that holds it at a contact.
const HOLD: f64 = 1e6;

/// Contact with a wall that holds a body: its velocity along the row is at least `least`, m/s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Support {
    pub row: Twist,
    pub least: f64,
    /// Velocity of the wall along the normal, m/s.
    pub wall: f64,
}

impl Support {
    /// Impulse on a body of the mass `mass`, kg, that has these velocities; negative if it would pull, N s.
    pub fn impulse(&self, mass: f64, twist: &Twist) -> f64 {
        HOLD * mass * (self.least - product(&self.row, twist))
    }
}
