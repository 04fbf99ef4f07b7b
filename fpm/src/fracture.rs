//! Opening of faces, and updates of the cells near them.

use crate::crack::{Criterion, FaceStress};
use crate::flux::Flux;
use crate::method::Composition;
use crate::open::OpenFace;
use crate::solver::Fpm;
use crate::step::turned;
use crate::sums::{BATCH, jump};
use crate::vector::{along, apply, cofactor, dot, norm, scaled, subtract, with_identity};

/// Open face, for observers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crack<const D: usize> {
    /// Cells of the face, by number in the [`Cells`](crate::Cells).
    pub cells: [u32; 2],
    /// Present position, m: the middle between both sides.
    pub position: [f64; D],
    /// Position in the reference configuration, m.
    pub reference: [f64; D],
    /// Unit normal in the reference configuration, from the first cell to the second.
    pub normal: [f64; D],
    /// Area in the reference configuration, m^2 (length in the plane, m).
    pub area: f64,
    /// Time of the onset of opening, s; `None` for a notch.
    pub opened: Option<f64>,
    /// Time of the loss of tension, s; `None` for a notch, and for a cohesive face that still carries tension.
    pub parted: Option<f64>,
    /// Opening, m: normal (negative if closed) and tangential.
    pub gap: [f64; 2],
    /// Dissipated part of the work of a cohesive face; one if the face carries only pressure.
    pub damage: f64,
}

impl<const D: usize, M: Composition<D>> Fpm<D, M> {
    /// Fit the gradients of all cells.
    pub(crate) fn fit_all(&mut self) {
        for cell in 0..self.reference.len() {
            self.fit(cell);
        }
        (0..self.reference.len()).for_each(|cell| self.sides.tell(cell));
    }

    /// Fit the gradient of a cell; a cell with too few neighbours for a gradient keeps its rotation.
    fn fit(&mut self, cell: usize) {
        let faces = &self.faces;
        self.sides.sort(cell, |face| faces[face as usize].open);
        let size = self.sizes[cell];
        if self.sides.fit(cell, size) {
            return;
        }
        let batch = &mut self.batches[cell / BATCH];
        if batch.rigid(cell % BATCH).is_none() {
            batch.rigid.push(((cell % BATCH) as u32, turned(&self.traces[cell].h)));
        }
    }

    /// Register an open face.
    pub(crate) fn note_crack(&mut self, crack: OpenFace<D>) {
        let number = self.cracks.len() as u32;
        for (end, cell) in crack.cells.iter().enumerate() {
            let (to, n) = (&mut self.batches[*cell as usize / BATCH].cracks, (*cell as usize % BATCH) as u32);
            to.insert(to.partition_point(|c| c.0 <= n), (n, number, end as u8));
        }
        self.cracks.push(crack);
    }

    /// Initialise the forces of open faces.
    pub(crate) fn begin_cracks(&mut self) {
        for crack in &mut self.cracks {
            let [a, b] = crack.cells.map(|c| &self.traces[c as usize]);
            crack.resume([a, b]);
        }
    }

    /// Open the candidate faces that fail by the criterion at `time`, s, and part softened faces whose cells rotated away from each other.
    /// The cost does not grow with the size of the body, except for the search for candidates.
    pub(crate) fn open_faces(&mut self, time: f64) {
        let mut failed: Vec<(u32, [f64; D])> = Vec::new();
        for batch in &self.batches {
            for &face in &batch.report.candidates {
                if self.softens(face) {
                    continue;
                }
                let (force, stress) = self.judged(face);
                if self.method.criterion().utilisation(stress) >= 1.0 {
                    failed.push((face, force));
                }
            }
        }
        failed.sort_by_key(|(face, _)| *face);
        let (work, joined) = (self.method.criterion().work(), self.method.criterion().stays_joined());
        let began = work.filter(|_| joined && !failed.is_empty());
        if let Some(work) = began {
            let modulus = self.contact_modulus();
            for (face, force) in failed.drain(..) {
                let cells = self.faces[face as usize].cells;
                let surface = self.sides.surface[self.side_of(face, cells[0])];
                let [a, b] = cells.map(|c| &self.traces[c as usize]);
                let crack = OpenFace::notch(face, cells, surface, modulus).begins(time, &force, [a, b], work);
                self.begin_softening(self.cracks.len() as u32);
                self.note_crack(crack);
            }
        }
        let strayed = |&n: &u32| {
            let crack = &self.cracks[n as usize];
            crack.strayed(crack.cells.map(|c| &self.traces[c as usize]))
        };
        let parted: Vec<u32> = self.softening.cracks.iter().copied().filter(strayed).collect();
        if failed.is_empty() && parted.is_empty() {
            if began.is_some() {
                self.renew_softening(&[]);
            }
            return;
        }
        let faces = || {
            failed.iter().map(|(face, _)| *face).chain(parted.iter().map(|&n| self.cracks[n as usize].face))
        };
        let faces: Vec<u32> = faces().collect();
        let cells = sorted(faces.iter().flat_map(|&face| self.faces[face as usize].cells));
        let around = self.ring(&cells);
        let batches = sorted(around.iter().map(|c| c / BATCH as u32));
        let mut given = 0.0;
        let penalty =
            |fpm: &Self| batches.iter().map(|&b| fpm.batches[b as usize].report.penalty).sum::<f64>();
        let before = penalty(self);
        for &face in &faces {
            self.faces[face as usize].open = true;
        }
        for &crack in &parted {
            self.cracks[crack as usize].softens = false;
        }
        cells.iter().for_each(|&c| self.fit(c as usize));
        for &c in &cells {
            self.sides.tell(c as usize);
            self.traces[c as usize] = self.trace_of(c as usize);
        }
        // Update adjacent cracks for the new trial functions.
        let beside = |&c: &u32| self.cracks_of(c as usize).map(|(crack, _)| crack);
        for n in sorted(cells.iter().flat_map(beside)) {
            let crack = &mut self.cracks[n as usize];
            if crack.softens || parted.binary_search(&n).is_ok() {
                continue;
            }
            let stored = crack.stored;
            crack.renew(crack.cells.map(|c| &self.traces[c as usize]), self.friction);
            given += crack.stored - stored;
        }
        let modulus = self.contact_modulus();
        for (face, force) in &failed {
            let cells = self.faces[*face as usize].cells;
            let surface = self.sides.surface[self.side_of(*face, cells[0])];
            let [a, b] = cells.map(|c| &self.traces[c as usize]);
            let crack = OpenFace::notch(*face, cells, surface, modulus).opens(time, force, [a, b], work);
            given += crack.stored;
            self.note_crack(crack);
        }
        for &crack in &parted {
            let crack = &mut self.cracks[crack as usize];
            let stored = crack.stored;
            crack.parts(time, crack.cells.map(|c| &self.traces[c as usize]));
            given += crack.stored - stored;
        }
        if !parted.is_empty() {
            self.renew_softening(&cells);
        }
        self.note_jumps(if M::Flux::LIFTED { &around } else { &cells });
        batches.iter().for_each(|&b| self.tractions_of(b as usize));
        given += penalty(self) - before;
        let farther = self.ring(&around);
        // A jump of forces changes velocities half a step from now, and so the staggered kinetic energy.
        given -= self.kinetic_of_forces(&farther);
        sorted(farther.iter().map(|c| c / BATCH as u32)).iter().for_each(|&b| self.forces_of(b as usize));
        given += self.kinetic_of_forces(&farther);
        self.exchange.conversion += given;
        self.dissipated -= given;
        farther.iter().for_each(|&c| self.renew_rate(c as usize));
        self.find_rate();
    }

    /// Return the force-dependent part of the staggered kinetic energy of some cells, J.
    fn kinetic_of_forces(&self, cells: &[u32]) -> f64 {
        cells.iter().map(|&c| self.forced(c as usize)).sum()
    }

    /// Return these cells and their neighbours, also across open faces.
    pub(crate) fn ring(&self, cells: &[u32]) -> Vec<u32> {
        let near = |&c: &u32| self.sides.of(c as usize).map(|s| self.sides.neighbour[s]);
        sorted(cells.iter().copied().chain(cells.iter().flat_map(near)))
    }

    /// Register changes of gradients by a change of neighbours, which laws receive with the next step.
    fn note_jumps(&mut self, cells: &[u32]) {
        for &c in cells {
            let (cell, n) = (c as usize, c as usize % BATCH);
            let mut change = self.seen_of(cell);
            let batch = &mut self.batches[cell / BATCH];
            subtract(&mut change, 1.0, &batch.gradient[n]);
            batch.jumps.push((n as u32, change));
        }
    }

    /// Return the force on the first cell of a face, N, and the true traction for the criterion. For a cohesive face with joined cells it
    /// is the whole force between them, which the face will carry.
    fn judged(&self, face: u32) -> ([f64; D], FaceStress) {
        let [a, b] = self.faces[face as usize].cells;
        let mut force = self.face_force(face);
        let criterion = self.method.criterion();
        if criterion.work().is_some() && criterion.stays_joined() {
            force = self.force_between(face, &force);
        }
        let surface = &self.sides.surface[self.side_of(face, a)];
        let (mut h, other) = (self.traces[a as usize].h, &self.traces[b as usize].h);
        for i in 0..D {
            for j in 0..D {
                h[i][j] = 0.5 * (h[i][j] + other[i][j]);
            }
        }
        let area = apply(&cofactor(&with_identity(&h)), &surface.area);
        let size = norm(&area);
        let normal = scaled(&area, 1.0 / size);
        let across = dot(&force, &normal);
        let shear = norm(&along(&force, -across, &normal)) / size;
        (force, FaceStress { normal: across / size, shear })
    }

    /// Return the force by the traction on a face on its first cell, N.
    fn face_force(&self, face: u32) -> [f64; D] {
        let [a, b] = self.faces[face as usize].cells;
        let surface = &self.sides.surface[self.side_of(face, a)];
        let [own, other] = [a, b].map(|c| &self.traces[c as usize]);
        let mut p = self.stress[a as usize];
        for i in 0..D {
            for j in 0..D {
                p[i][j] = 0.5 * (p[i][j] + self.stress[b as usize][i][j]);
            }
        }
        along(&apply(&p, &surface.area), -surface.stiffness, &jump(own, other, surface))
    }

    /// Largest utilisation of intact faces by the criterion, traction over strength, and its place, m; `None` without faces.
    pub fn utilisation(&self) -> Option<(f64, [f64; D])> {
        let intact = (0..self.faces.len()).filter(|&f| !self.faces[f].open && !self.softens(f as u32));
        let of = |f: usize| {
            let (_, stress) = self.judged(f as u32);
            (self.method.criterion().utilisation(stress), self.faces[f].centroid)
        };
        intact.map(of).max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// All open faces in the order in which they opened, notches first.
    pub fn cracks(&self) -> Vec<Crack<D>> {
        let of = |crack: &OpenFace<D>| {
            let surface = &crack.surface;
            let [a, b] = crack.cells.map(|c| &self.traces[c as usize]);
            let (here, there) = (a.at(&surface.own), b.at(&surface.other));
            let reference = along(&self.reference[crack.cells[0] as usize], 1.0, &surface.own);
            let area = norm(&surface.area);
            Crack {
                cells: crack.cells.map(|c| self.numbers[c as usize]),
                position: std::array::from_fn(|d| reference[d] + 0.5 * (here[d] + there[d])),
                reference,
                normal: scaled(&surface.area, 1.0 / area),
                area,
                opened: (crack.opened >= 0.0).then_some(crack.opened),
                parted: (crack.parted >= 0.0).then_some(crack.parted),
                gap: crack.gap(),
                damage: crack.damage(),
            }
        };
        self.cracks.iter().map(of).collect()
    }

    /// Area of faces that opened, m^2 (length in the plane, m), each weighted by its damage.
    pub fn crack_area(&self) -> f64 {
        let opened = self.cracks.iter().filter(|c| c.opened >= 0.0);
        opened.map(|c| c.damage() * norm(&c.surface.area)).sum()
    }

    /// Energy dissipated by cracks, J: in cohesive faces, and energy that cells lost when faces opened. Friction is separate
    /// ([`Exchange::friction`](impactite_scene::Exchange::friction)).
    pub fn dissipated(&self) -> f64 {
        self.dissipated
    }

    /// Fragments, pieces not joined by a face that carries tension: number of cells of each, the largest first.
    pub fn fragments(&self) -> Vec<usize> {
        let mut parent: Vec<u32> = (0..self.reference.len() as u32).collect();
        fn root(parent: &mut [u32], mut c: u32) -> u32 {
            while parent[c as usize] != c {
                parent[c as usize] = parent[parent[c as usize] as usize];
                c = parent[c as usize];
            }
            c
        }
        let mut broken = vec![false; self.faces.len()];
        self.cracks.iter().for_each(|c| broken[c.face as usize] = c.broken());
        for [a, b] in self.faces.iter().zip(broken).filter(|(_, broken)| !broken).map(|(f, _)| f.cells) {
            let (a, b) = (root(&mut parent, a), root(&mut parent, b));
            parent[a.max(b) as usize] = a.min(b);
        }
        let mut sizes = vec![0usize; parent.len()];
        for c in 0..parent.len() as u32 {
            sizes[root(&mut parent, c) as usize] += 1;
        }
        sizes.retain(|&size| size > 0);
        sizes.sort_unstable_by(|a, b| b.cmp(a));
        sizes
    }
}

/// Return each number once, in order.
fn sorted(numbers: impl IntoIterator<Item = u32>) -> Vec<u32> {
    let mut list: Vec<u32> = numbers.into_iter().collect();
    list.sort_unstable();
    list.dedup();
    list
}
