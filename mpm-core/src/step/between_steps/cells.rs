//! Analysis of a body cell by cell: fragments, unresolved motion, alternating pressure, isolated failures.

use std::collections::HashMap;

use nalgebra::SMatrix;

use impactite_scene::PointView;

/// Sums over the particles of a cell, about its corner.
#[derive(Clone, Copy, Debug)]
struct Cell<const D: usize> {
    particles: u32,
    failed: u32,
    mass: f64,
    momentum: [f64; D],
    /// Twice the kinetic energy, J.
    square: f64,
    /// Sum of m x, kg m.
    first: [f64; D],
    /// Sum of m x x^T, kg m^2.
    second: [[f64; D]; D],
    /// Sum of m v x^T, kg m^2/s.
    turned: [[f64; D]; D],
    /// Mass times pressure, and times von Mises stress, kg Pa.
    pressure: f64,
    von_mises: f64,
    /// Part of the body that contains the cell.
    part: u32,
}

impl<const D: usize> Cell<D> {
    const EMPTY: Self = Cell {
        particles: 0,
        failed: 0,
        mass: 0.0,
        momentum: [0.0; D],
        square: 0.0,
        first: [0.0; D],
        second: [[0.0; D]; D],
        turned: [[0.0; D]; D],
        pressure: 0.0,
        von_mises: 0.0,
        part: u32::MAX,
    };

    /// Kinetic energy of the motion within the cell beyond a linear field, J; zero for too few particles.
    fn unseen(&self) -> f64 {
        if self.particles as usize <= D + 1 {
            return 0.0;
        }
        let centre = self.first.map(|x| x / self.mass);
        let velocity = self.momentum.map(|p| p / self.mass);
        let mut inertia = SMatrix::<f64, D, D>::zeros();
        let mut turned = SMatrix::<f64, D, D>::zeros();
        let mut about = self.square;
        for c in 0..D {
            about -= self.momentum[c] * velocity[c];
            for d in 0..D {
                inertia[(c, d)] = self.second[c][d] - self.first[c] * centre[d];
                turned[(c, d)] = self.turned[c][d] - self.momentum[c] * centre[d];
            }
        }
        let Some(inverse) = inertia.try_inverse() else { return 0.0 };
        let affine = (turned * inverse * turned.transpose()).trace();
        // Differences below rounding count as zero.
        let left = about - affine;
        if left > 1e-12 * self.square { 0.5 * left } else { 0.0 }
    }
}

/// Analysis of a body cell by cell, with memory that is reused.
#[derive(Clone, Debug)]
pub struct Cells<const D: usize> {
    spacing: f64,
    /// Period along each axis, in cells; zero without one.
    period: [i32; D],
    places: HashMap<[i32; D], u32>,
    cells: Vec<([i32; D], Cell<D>)>,
    /// Cells still to be visited.
    stack: Vec<u32>,
    /// Numbers of cells, particles and failed particles of each part.
    parts: Vec<[u64; 3]>,
    /// Largest energy of motion beyond a linear field in a cell, J, and its position, m.
    noisiest: (f64, [f64; 3]),
}

/// Fragmentation and failure of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Wholeness {
    /// Number of parts: sets of cells between which no node is shared.
    pub(crate) parts: usize,
    /// Parts without a failed particle, except the largest part.
    pub(crate) whole_parts: usize,
    /// Fraction of the particles in parts without a failed particle, except the largest part.
    pub(crate) share: f64,
    /// Failed particles.
    pub(crate) failed: u64,
    /// Failed particles without another in the surrounding cells.
    pub(crate) alone: u64,
    /// Position of an isolated failed particle, m.
    pub(crate) position: [f64; 3],
}

/// Alternation of the pressure of a body from cell to cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Alternation {
    /// Root mean square of the pressure component that changes sign from cell to cell, Pa.
    pub(crate) pressure: f64,
    /// Root mean square of the pressure about its mean, Pa.
    pub(crate) whole: f64,
    /// Root mean square of the von Mises stress, Pa.
    pub(crate) von_mises: f64,
}

impl<const D: usize> Cells<D> {
    pub(crate) fn new(spacing: f64, period: [i32; D]) -> Self {
        Cells {
            spacing,
            period,
            places: HashMap::new(),
            cells: Vec::new(),
            stack: Vec::new(),
            parts: Vec::new(),
            noisiest: (0.0, [0.0; 3]),
        }
    }

    /// Memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.places.capacity() * size_of::<([i32; D], u32)>()
            + self.cells.capacity() * size_of::<([i32; D], Cell<D>)>()
            + self.stack.capacity() * size_of::<u32>()
            + self.parts.capacity() * size_of::<[u64; 3]>()
    }

    /// Return the index of the cell within a period.
    fn wrapped(&self, mut index: [i32; D]) -> [i32; D] {
        for (i, &period) in index.iter_mut().zip(&self.period) {
            *i = if period > 0 { i.rem_euclid(period) } else { *i };
        }
        index
    }

    pub(crate) fn clear(&mut self) {
        self.places.clear();
        self.cells.clear();
    }

    pub(crate) fn add(&mut self, p: &PointView) {
        let index: [i32; D] = std::array::from_fn(|d| (p.position[d] / self.spacing).floor() as i32);
        let wrapped = self.wrapped(index);
        let cells = &mut self.cells;
        let place = *self.places.entry(wrapped).or_insert_with(|| {
            cells.push((wrapped, Cell::EMPTY));
            cells.len() as u32 - 1
        });
        let cell = &mut self.cells[place as usize].1;
        cell.particles += 1;
        cell.failed += u32::from(p.failed);
        cell.mass += p.mass;
        let at: [f64; D] = std::array::from_fn(|d| p.position[d] - self.spacing * f64::from(index[d]));
        for c in 0..D {
            let momentum = p.mass * p.velocity[c];
            cell.momentum[c] += momentum;
            cell.square += momentum * p.velocity[c];
            cell.first[c] += p.mass * at[c];
            for d in 0..D {
                cell.second[c][d] += p.mass * at[c] * at[d];
                cell.turned[c][d] += momentum * at[d];
            }
        }
        cell.pressure += p.mass * p.pressure();
        cell.von_mises += p.mass * p.von_mises();
    }

    /// Kinetic energy of the motion beyond a linear field in each cell, J, and position of its maximum, m.
    pub(crate) fn unseen(&mut self) -> (f64, [f64; 3]) {
        let (mut sum, mut most) = (0.0, (0.0, [0.0; 3]));
        for (_, cell) in &self.cells {
            sum += cell.unseen();
        }
        for (index, cell) in &self.cells {
            // Position of the largest kinetic energy, where all motion is resolved.
            let energy = if sum > 0.0 { cell.unseen() } else { 0.5 * cell.square };
            if energy > most.0 {
                most = (energy, self.middle(index));
            }
        }
        self.noisiest = most;
        (sum, most.1)
    }

    /// Energy, J, and position, m, of the last call of [`Cells::unseen`].
    pub(crate) fn noisiest(&self) -> (f64, [f64; 3]) {
        self.noisiest
    }

    fn middle(&self, index: &[i32; D]) -> [f64; 3] {
        let mut x = [0.0; 3];
        for d in 0..D {
            x[d] = self.spacing * (f64::from(index[d]) + 0.5);
        }
        x
    }

    /// Call `visit` for the cells at most `reach` cells away along every axis.
    fn around(&self, index: &[i32; D], reach: i32, mut visit: impl FnMut(u32)) {
        let width = (2 * reach + 1) as usize;
        for n in 0..width.pow(D as u32) {
            let mut at = *index;
            let mut rest = n;
            for x in &mut at {
                *x += (rest % width) as i32 - reach;
                rest /= width;
            }
            if let Some(&place) = self.places.get(&self.wrapped(at)) {
                visit(place);
            }
        }
    }

    /// Find the parts and isolated failures, where particles share nodes up to `reach` cells apart.
    pub(crate) fn wholeness(&mut self, reach: i32) -> Wholeness {
        self.parts.clear();
        let mut stack = std::mem::take(&mut self.stack);
        for first in 0..self.cells.len() as u32 {
            if self.cells[first as usize].1.part != u32::MAX {
                continue;
            }
            let part = self.parts.len() as u32;
            self.parts.push([0; 3]);
            self.cells[first as usize].1.part = part;
            stack.push(first);
            while let Some(place) = stack.pop() {
                let (index, cell) = self.cells[place as usize];
                let sums = &mut self.parts[part as usize];
                sums[0] += 1;
                sums[1] += u64::from(cell.particles);
                sums[2] += u64::from(cell.failed);
                let before = stack.len();
                self.around(&index, reach, |other| stack.push(other));
                // Cells not yet reached stay on the stack.
                let mut kept = before;
                for n in before..stack.len() {
                    let other = &mut self.cells[stack[n] as usize].1;
                    if other.part == u32::MAX {
                        other.part = part;
                        stack[kept] = stack[n];
                        kept += 1;
                    }
                }
                stack.truncate(kept);
            }
        }
        self.stack = stack;
        let largest = self.parts.iter().map(|p| p[1]).max().unwrap_or(0);
        let particles: u64 = self.parts.iter().map(|p| p[1]).sum();
        let main = self.parts.iter().position(|p| p[1] == largest);
        let torn = || {
            let parts = self.parts.iter().enumerate().filter(|(n, p)| Some(*n) != main && p[2] == 0);
            parts.map(|(_, p)| p)
        };
        let mut found = Wholeness {
            parts: self.parts.len(),
            whole_parts: torn().count(),
            share: torn().map(|p| p[1]).sum::<u64>() as f64 / particles.max(1) as f64,
            failed: self.parts.iter().map(|p| p[2]).sum(),
            ..Wholeness::default()
        };
        for (index, cell) in self.cells.iter().filter(|c| c.1.failed > 0) {
            let mut near = 0;
            self.around(index, 1, |other| near += self.cells[other as usize].1.failed);
            if near == cell.failed {
                found.alone += u64::from(near);
                found.position = self.middle(index);
            }
        }
        found
    }

    /// Measure the alternation of the pressure from cell to cell.
    pub(crate) fn alternation(&self) -> Alternation {
        let (mut mass, mut mean, mut square, mut von_mises) = (0.0, 0.0, 0.0, 0.0);
        for (_, cell) in &self.cells {
            mass += cell.mass;
            mean += cell.pressure;
            square += cell.pressure * (cell.pressure / cell.mass);
            von_mises += cell.von_mises * (cell.von_mises / cell.mass);
        }
        mean /= mass;
        let (mut rows, mut saw) = (0.0, 0.0);
        for (index, _) in &self.cells {
            for axis in 0..D {
                let pressure = |offset: i32| {
                    let mut at = *index;
                    at[axis] += offset;
                    let &place = self.places.get(&self.wrapped(at))?;
                    let cell = &self.cells[place as usize].1;
                    Some(cell.pressure / cell.mass)
                };
                let row = (pressure(0), pressure(1), pressure(2), pressure(3));
                if let (Some(a), Some(b), Some(c), Some(d)) = row {
                    // Third difference over eight: amplitude of the alternating component, zero for linear and quadratic fields.
                    let amplitude = (a - 3.0 * b + 3.0 * c - d) / 8.0;
                    rows += 1.0;
                    saw += amplitude * amplitude;
                }
            }
        }
        if rows == 0.0 || mass == 0.0 {
            return Alternation::default();
        }
        Alternation {
            pressure: (saw / rows).sqrt(),
            whole: (square / mass - mean * mean).max(0.0).sqrt(),
            von_mises: (von_mises / mass).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn particle(position: [f64; 3], velocity: [f64; 3]) -> PointView {
        PointView {
            number: 0,
            position,
            velocity,
            mass: 2.0,
            volume: 1.0,
            in_range: true,
            ..PointView::default()
        }
    }

    /// Create a row of cells with four particles each.
    fn row(cells: impl Iterator<Item = i32>, mut give: impl FnMut(i32, &mut PointView)) -> Cells<2> {
        let mut list = Cells::new(0.5, [0; 2]);
        for cell in cells {
            for (x, y) in [(0.125, 0.125), (0.375, 0.125), (0.125, 0.375), (0.375, 0.375)] {
                let mut p = particle([0.5 * f64::from(cell) + x, y, 0.0], [0.0; 3]);
                give(cell, &mut p);
                list.add(&p);
            }
        }
        list
    }

    #[test]
    fn a_linear_velocity_field_is_seen_and_an_hourglass_is_not() {
        let linear = |_, p: &mut PointView| {
            let [x, y, _] = p.position;
            p.velocity = [3.0 + 2.0 * x - 5.0 * y, -1.0 + 4.0 * x + y, 0.0];
        };
        assert_eq!(row(-2..4, linear).unseen().0, 0.0);
        // An hourglass of amplitude 1 in one cell of six: m v^2 / 2 of four particles.
        let hourglass = |cell, p: &mut PointView| {
            linear(cell, p);
            let [x, y, _] = p.position.map(|x| (x / 0.25).floor());
            p.velocity[0] += if cell == 1 { (-1.0f64).powf(x + y) } else { 0.0 };
        };
        let (energy, place) = row(-2..4, hourglass).unseen();
        assert!((energy - 4.0).abs() < 1e-9, "{energy}");
        assert_eq!(place, [0.75, 0.25, 0.0]);
    }

    #[test]
    fn parts_are_counted_by_the_nodes_they_share() {
        let cells = || (0..4).chain(5..7).chain(9..10);
        let mut list = row(cells(), |_, _| ());
        assert_eq!(list.wholeness(1).parts, 3);
        assert_eq!(row(cells(), |_, _| ()).wholeness(2).parts, 2);
        let found = row(cells(), |_, _| ()).wholeness(1);
        assert_eq!((found.whole_parts, found.failed), (2, 0));
        assert!((found.share - 3.0 / 7.0).abs() < 1e-15);
        // A part with a failed particle is a fragment; a particle that failed alone is counted.
        let mut done = false;
        let found =
            row(cells(), |cell, p| p.failed = cell == 9 && !std::mem::replace(&mut done, true)).wholeness(1);
        assert_eq!((found.whole_parts, found.failed, found.alone), (1, 1, 1));
        let found = row(cells(), |cell, p| p.failed = cell == 9).wholeness(1);
        assert_eq!((found.failed, found.alone), (4, 4));
        let found = row(cells(), |cell, p| p.failed = cell < 2).wholeness(1);
        assert_eq!((found.failed, found.alone), (8, 0));
    }

    #[test]
    fn a_checkerboard_is_told_from_a_smooth_pressure() {
        let pressure = |f: fn(f64) -> f64| {
            move |cell: i32, p: &mut PointView| {
                let q = f(f64::from(cell));
                p.stress = [-q + 2.0, -q - 1.0, -q - 1.0, 0.0, 0.0, 0.0];
            }
        };
        let smooth = row(0..20, pressure(|x| 7.0 + x * x)).alternation();
        assert!(smooth.pressure < 1e-12 && smooth.whole > 50.0);
        let saw = row(0..20, pressure(|x| 7.0 + 5.0 * (-1.0f64).powf(x))).alternation();
        assert!((saw.pressure - 5.0).abs() < 1e-12 && (saw.whole - 5.0).abs() < 1e-12);
        assert!((saw.von_mises - 3.0).abs() < 1e-12);
    }
}
