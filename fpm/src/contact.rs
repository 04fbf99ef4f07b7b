//! Contact interface of a body. Cells have the numbers of their [`Cells`](crate::Cells) here.

use impactite_scene::{Archive, CheckpointError, Exchange, SceneError, Solver, StepError};
use impactite_simd::Team;
use mpm_contact::particles::{Advice, ContactParticle, Facing, ParticleBody, SurfacePoint};
use mpm_contact::vector::{dot as dot3, sum as sum3, times as times3, unit as unit3, wide};

use crate::cells::OuterFace;
use crate::method::Composition;
use crate::rest::PLACES;
use crate::solver::{ADVICE, Fpm, PRESCRIBED, TOUCHED};
use crate::sums::BATCH;
use crate::vector::{along, apply, cofactor, inverse, scaled, with_identity};

/// Smallest cosine of the angle between the normals of faces of a cell that count as one.
const ONE_FACE: f64 = 0.8;

impl<const D: usize, M: Composition<D>> Fpm<D, M> {
    fn place_of(&self, n: usize) -> usize {
        self.places[n] as usize
    }

    /// Return the faces of a cell on the surface.
    fn outer_of(&self, i: usize) -> impl Iterator<Item = &OuterFace<D>> {
        let first = self.surface.partition_point(|f| (f.cell as usize) < i);
        self.surface[first..].iter().take_while(move |f| f.cell as usize == i)
    }

    /// Return the free faces of a cell, on the surface or open: area times outward normal, m^2, and arm from the point of the cell to the
    /// centroid, m, in the reference configuration.
    fn bare_faces(&self, i: usize) -> impl Iterator<Item = ([f64; D], [f64; D])> {
        let way = move |x: &[f64; D]| std::array::from_fn(|d| x[d] - self.reference[i][d]);
        let outer = self.outer_of(i).map(move |f| (scaled(&f.normal, f.area), way(&f.centroid)));
        let open = self.sides.of(i).filter(move |&s| !self.joins(i, s));
        outer.chain(open.map(|s| (self.sides.surface[s].area, self.sides.surface[s].own)))
    }

    /// Return the sum of the free areas of a cell, m^2.
    fn bare(&self, i: usize) -> [f64; D] {
        self.bare_faces(i).fold([0.0; D], |sum, (area, _)| along(&sum, 1.0, &area))
    }

    /// Return the arm from the point of a cell to the intersection of planes with normals and distances: the shortest vector to all of
    /// them.
    fn corner(planes: &[([f64; 3], f64)]) -> Option<[f64; 3]> {
        let cross = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        match *planes {
            [(a, p), (b, q)] => {
                let along = dot3(a, b);
                let det = 1.0 - along * along;
                let (x, y) = ((p - along * q) / det, (q - along * p) / det);
                (det > 0.1).then(|| sum3(times3(a, x), times3(b, y)))
            }
            [(a, p), (b, q), (c, r)] => {
                let volume = dot3(a, cross(b, c));
                let point =
                    sum3(sum3(times3(cross(b, c), p), times3(cross(c, a), q)), times3(cross(a, b), r));
                (volume.abs() > 0.1).then(|| times3(point, 1.0 / volume))
            }
            _ => None,
        }
    }
}

impl<const D: usize, M: Composition<D>> ParticleBody<D> for Fpm<D, M> {
    fn particle(&self, n: usize) -> ContactParticle<D> {
        let i = self.place_of(n);
        ContactParticle {
            position: self.position(i),
            velocity: self.velocity[i],
            mass: self.mass[i],
            radius: 0.5 * self.sizes[i],
        }
    }

    fn may_touch(&self, n: usize) -> bool {
        let i = self.place_of(n);
        self.sides.of(i).any(|s| !self.joins(i, s)) || self.bare(i) != [0.0; D]
    }

    fn facing(&self, n: usize) -> Facing {
        let i = self.place_of(n);
        if !self.sides.of(i).any(|s| self.joins(i, s)) {
            return Facing::LONE;
        }
        // Present area, by Nanson's formula.
        let area = apply(&cofactor(&with_identity(&self.traces[i].h)), &self.bare(i));
        let density = self.mass[i] / (self.volume[i] * self.batches[i / BATCH].said[i % BATCH][6]);
        Facing { area: wide(&area), mass: wide(&scaled(&area, density)), lone: false }
    }

    fn beyond(&self, n: usize) -> f64 {
        let i = self.place_of(n);
        let own = self
            .outer_of(i)
            .map(|f| (0..D).map(|d| (f.centroid[d] - self.reference[i][d]) * f.normal[d]).sum::<f64>());
        own.fold(0.0, f64::max)
    }

    fn around(&self, n: usize, visit: &mut dyn FnMut(usize)) {
        let i = self.place_of(n);
        let mut near: Vec<u32> =
            self.sides.of(i).filter(|&s| self.joins(i, s)).map(|s| self.sides.neighbour[s]).collect();
        near.push(i as u32);
        near.sort_unstable();
        near.dedup();
        near.into_iter().for_each(|j| visit(self.numbers[j as usize] as usize));
    }

    fn has_surface(&self) -> bool {
        true
    }

    /// Append a point at the centroid of each free face, and one at the corner of several.
    fn surface(&self, n: usize, out: &mut Vec<SurfacePoint>) {
        let i = self.place_of(n);
        let f = with_identity(&self.traces[i].h);
        let (turn, x) = (cofactor(&f), self.position(i));
        let mut planes: Vec<([f64; 3], f64)> = Vec::new();
        let mut normals = [0.0; 3];
        let present = |arm: &[f64; D]| wide(&along(&x, 1.0, &apply(&f, arm)));
        for (area, arm) in self.bare_faces(i) {
            let turned = wide(&apply(&turn, &area));
            let (Some(normal), Some(reference)) = (unit3(turned), unit3(wide(&area))) else { continue };
            let area = dot3(turned, normal);
            out.push(SurfacePoint { position: present(&arm), normal, area, corner: false, reach: 0.0 });
            if planes.iter().all(|(other, _)| dot3(*other, reference) < ONE_FACE) {
                planes.push((reference, dot3(reference, wide(&arm))));
                normals = sum3(normals, normal);
            }
        }
        if let (Some(corner), Some(normal)) = (Self::corner(&planes), unit3(normals)) {
            let arm: [f64; D] = std::array::from_fn(|d| corner[d]);
            out.push(SurfacePoint { position: present(&arm), normal, area: 0.0, corner: true, reach: 0.0 });
        }
    }

    fn carriers(&self, n: usize, point: &SurfacePoint, visit: &mut dyn FnMut(usize, [f64; 3])) {
        let i = self.place_of(n);
        let x = self.position(i);
        let offset: [f64; D] = std::array::from_fn(|d| point.position[d] - x[d]);
        let arm = apply(&inverse(&with_identity(&self.traces[i].h)), &offset);
        let mut rest = 1.0;
        for s in self.sides.intact_of(i) {
            let weight: f64 = (0..D).map(|d| self.sides.gradient[s][d] * arm[d]).sum();
            if weight != 0.0 {
                rest -= weight;
                visit(self.numbers[self.sides.neighbour[s] as usize] as usize, [weight; 3]);
            }
        }
        visit(n, [rest; 3]);
    }

    fn held(&self, n: usize) -> [bool; 3] {
        let i = self.place_of(n);
        let bits = self.batches[i / BATCH].held[i % BATCH];
        std::array::from_fn(|d| bits & PRESCRIBED << d != 0)
    }

    fn traction(&self, n: usize, normal: &[f64; 3]) -> f64 {
        let i = self.place_of(n);
        let said = &self.batches[i / BATCH].said[i % BATCH];
        let mut sum = 0.0;
        for a in 0..3 {
            for b in 0..3 {
                sum += normal[a] * said[PLACES[a][b]] * normal[b];
            }
        }
        sum
    }

    fn rate(&self) -> f64 {
        self.rate
    }
    fn check(&self, dt: f64) -> Result<(), SceneError> {
        self.check_loads(dt)
    }
    fn accelerate(&mut self, dt: f64, start: &mut Vec<[f64; D]>) -> Result<(), StepError> {
        start.resize(self.velocity.len(), [0.0; D]);
        for (v, &n) in self.velocity.iter().zip(&self.numbers) {
            start[n as usize] = *v;
        }
        Fpm::accelerate(self, dt);
        Ok(())
    }
    fn push(&mut self, n: usize, impulse: &[f64; 3]) {
        let i = self.place_of(n);
        for d in 0..D {
            self.velocity[i][d] += impulse[d] / self.mass[i];
            if impulse[d] != 0.0 {
                self.batches[i / BATCH].held[i % BATCH] |= TOUCHED << d;
            }
        }
    }
    fn advance(&mut self, dt: f64, _: &[[f64; D]]) -> Result<(), StepError> {
        Fpm::advance(self, dt)
    }
    fn finish(&mut self, dt: f64) -> Result<(), StepError> {
        Fpm::finish(self, dt)
    }
    fn describe(&self) -> String {
        Solver::method(self)
    }
    fn exchange(&self) -> Exchange {
        Solver::exchange(self)
    }
    fn speed(&self) -> f64 {
        self.rest.speed
    }
    fn advice(&self) -> Advice {
        ADVICE
    }
    fn rename(&mut self, name: String) {
        self.name = name;
    }
    fn set_team(&mut self, team: Team) {
        Fpm::set_team(self, team);
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.archive_body(file)
    }
}
