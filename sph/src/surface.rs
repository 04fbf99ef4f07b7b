//! Surface of a body: boundary particles, their normals, and surface points half a spacing beyond them.
//!
//! A particle is on the boundary if no neighbour is within a cone about the direction away from its neighbours (the umbrella of
//! \[Marrone2010\]). Its normal is that of the plane through the adjacent boundary particles. If these are on several planes the particle
//! is on an edge: it has a point on each plane and one on the edge. In the total Lagrangian form this detection is in the reference
//! configuration; a surface point is at x + F N h/2 with the normal F^-T N, and moves linearly with the particles.

use mpm_contact::particles::SurfacePoint;
use mpm_contact::vector::wide;

use crate::faces::{Faces, Found};
use crate::form::{Correction as _, Form as _};
use crate::matrix::{determinant, identity, inverse};
use crate::method::Composition;
use crate::solver::Sph;
use crate::sums::BATCH;

/// Radius of the neighbourhood for boundary detection, in spacings: the first ring of a lattice, corners of cubes included.
const RING: f64 = 1.78;
/// Radius of the neighbourhood for the umbrella test, in spacings: layers may be 1.5 spacings apart behind a surface between lattice sites.
const SHADE: f64 = 1.9;
/// Cosine of the half angle of the umbrella.
const UMBRELLA: f64 = 0.65;
/// Smallest length of the mean direction away from the neighbours of a boundary particle.
const SURROUNDED: f64 = 0.05;
/// Largest sine of the angle to the tangent plane between adjacent boundary particles.
const BESIDE: f64 = 0.5;
/// Smallest cosine of the angle between the directions of two boundary particles of one face.
const ALIKE: f64 = 0.65;
/// Largest distance from the plane of a face, in spacings.
const ROUGH: f64 = 0.25;
/// Smallest cosine of the angle between the normals of one face: the normals on a ball of five spacings are such.
const SAME: f64 = 0.5;

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(&a, &a).sqrt();
    (length > 0.0).then(|| a.map(|c| c / length))
}

impl<const D: usize, M: Composition<D>> Sph<D, M> {
    /// Return the particle of a neighbour, or the source of an image, and the signs of the image.
    fn source(&self, j: usize) -> (usize, [f64; 3]) {
        let particles = self.positions.len();
        if j < particles {
            return (j, [1.0; 3]);
        }
        let image = &self.images.all[j - particles];
        let mut flips = [1.0; 3];
        flips[..D].copy_from_slice(&image.flips);
        (image.source as usize, flips)
    }

    /// Visit the neighbours of a particle within `range` spacings: place, distance vector and distance; around an axis also their images.
    fn ring(&self, i: usize, range: f64, mut visit: impl FnMut(usize, [f64; 3], f64)) {
        let own = &self.records.place[i];
        let reach = range * self.local_spacing(i);
        let (index, _) = self.batches[i / BATCH].near.of(i % BATCH);
        let mut see = |j: usize, mirrored: bool| {
            let other = &self.records.place[j];
            let mut apart = [0.0; 3];
            for d in 0..D {
                apart[d] = other[d] - own[d];
            }
            if mirrored {
                apart[0] = -other[0] - own[0];
            }
            let square = dot(&apart, &apart);
            if square <= reach * reach && square > 0.0 {
                visit(j, apart, square.sqrt());
            }
        };
        index.iter().for_each(|&j| see(j as usize, false));
        if Self::HOOP && M::Correction::CORRECTED && own[0] < reach {
            see(i, true);
            index.iter().for_each(|&j| see(j as usize, true));
        }
    }

    /// Particle spacing in the configuration of the kernels, m.
    fn local_spacing(&self, i: usize) -> f64 {
        let batch = &self.batches[i / BATCH];
        if M::Form::TOTAL {
            let before = batch.before.get(i % BATCH).map_or(1.0, |f| determinant(f, D));
            return self.spacing[i] * if D == 2 { before.sqrt() } else { before.cbrt() };
        }
        let ratio = batch.stress[i % BATCH][6];
        self.spacing[i] * if D == 2 && !Self::HOOP { ratio.sqrt() } else { ratio.cbrt() }
    }

    /// Return the direction away from the neighbours of a boundary particle, `None` for an inner particle.
    fn find_open(&self, i: usize) -> Option<[f64; 3]> {
        let mut away = [0.0; 3];
        let mut count = 0;
        let reach = RING * self.local_spacing(i);
        self.ring(i, RING, |_, apart, distance| {
            let weight = (1.0 - (distance / reach).powi(4)) / distance;
            (0..D).for_each(|d| away[d] -= weight * apart[d]);
            count += 1;
        });
        if count == 0 || dot(&away, &away).sqrt() < SURROUNDED * f64::from(count) {
            return None;
        }
        let away = unit(away)?;
        let mut shaded = false;
        self.ring(i, SHADE, |_, apart, distance| shaded |= dot(&apart, &away) > UMBRELLA * distance);
        (!shaded).then_some(away)
    }

    fn open(&mut self, i: usize) -> Option<[f64; 3]> {
        let round = self.skin.round;
        if self.skin.open[i].round != round {
            let what = self.find_open(i);
            self.skin.open[i] = Found { round, what };
        }
        self.skin.open[i].what
    }

    /// Return the normal of a boundary particle within a face.
    fn flat(&mut self, i: usize) -> Option<[f64; 3]> {
        let round = self.skin.round;
        if self.skin.flat[i].round != round {
            let what = self.open(i).and_then(|open| self.find_flat(i, open));
            self.skin.flat[i] = Found { round, what };
        }
        self.skin.flat[i].what
    }

    fn find_flat(&mut self, i: usize, open: [f64; 3]) -> Option<[f64; 3]> {
        let mut around = Vec::new();
        self.ring(i, RING, |j, apart, distance| around.push((j, apart, distance)));
        let mut beside = Vec::new();
        for (j, apart, distance) in around {
            if dot(&apart, &open).abs() > BESIDE * distance {
                continue;
            }
            let (source, flips) = self.source(j);
            let Some(theirs) = self.open(source) else { continue };
            let mut theirs: [f64; 3] = std::array::from_fn(|d| theirs[d] * flips[d]);
            // Neighbour beyond the axis.
            if Self::HOOP && apart[0] < -self.records.place[i][0] {
                theirs[0] = -theirs[0];
            }
            if dot(&theirs, &open) > ALIKE {
                beside.push(apart);
            }
        }
        if beside.len() < 2 * (D - 1) {
            return None;
        }
        beside.push([0.0; 3]);
        // Least-squares fit of linear heights over the tangent plane.
        let spacing = self.local_spacing(i);
        let count = beside.len() as f64;
        let mean: [f64; 3] = std::array::from_fn(|d| beside.iter().map(|x| x[d]).sum::<f64>() / count);
        let high = dot(&mean, &open);
        let tangent = |x: &[f64; 3]| -> [f64; 3] {
            let z = dot(x, &open) - high;
            std::array::from_fn(|d| x[d] - mean[d] - z * open[d])
        };
        let (mut m, mut b, mut trace) = ([[0.0; 3]; 3], [0.0; 3], 0.0);
        for x in &beside {
            let (t, z) = (tangent(x), dot(x, &open) - high);
            trace += dot(&t, &t);
            for a in 0..D {
                b[a] += z * t[a];
                (0..D).for_each(|c| m[a][c] += t[a] * t[c]);
            }
        }
        for a in 0..D {
            (0..D).for_each(|c| m[a][c] += trace * open[a] * open[c]);
        }
        // In space the neighbours must span both axes of the plane.
        if determinant(&m, D) < 0.05 * trace.powi(D as i32) {
            return None;
        }
        let inverse = inverse(&m, D);
        let slope: [f64; 3] = std::array::from_fn(|a| dot(&inverse[a], &b));
        let off = beside
            .iter()
            .map(|x| (dot(x, &open) - high - dot(&slope, &tangent(x))).abs())
            .fold(0.0, f64::max);
        if off > ROUGH * spacing {
            return None;
        }
        unit(std::array::from_fn(|d| open[d] - slope[d]))
    }

    /// Find the faces of a particle.
    fn find_faces(&mut self, i: usize) -> Faces<D> {
        let Some(open) = self.open(i) else { return Faces::default() };
        let mut faces = Faces { count: 1, normals: [[0.0; 3]; 3] };
        if let Some(normal) = self.flat(i) {
            faces.normals[0] = normal;
            return faces;
        }
        let mut around = Vec::new();
        self.ring(i, RING, |j, apart, _| around.push((j, apart)));
        let mut sums = [[0.0; 3]; 3];
        let mut count = 0;
        for (j, apart) in around {
            let (source, flips) = self.source(j);
            let Some(normal) = self.flat(source) else { continue };
            let mut normal: [f64; 3] = std::array::from_fn(|d| normal[d] * flips[d]);
            if Self::HOOP && apart[0] < -self.records.place[i][0] {
                normal[0] = -normal[0];
            }
            // Only normals of faces through the particle.
            if dot(&normal, &open) < 0.2 || dot(&normal, &apart).abs() > 2.0 * ROUGH * self.local_spacing(i) {
                continue;
            }
            let same = (0..count).find(|&k| unit(sums[k]).is_some_and(|n| dot(&n, &normal) > SAME));
            let k = match same {
                Some(k) => k,
                None if count < D => {
                    count += 1;
                    count - 1
                }
                None => continue,
            };
            (0..3).for_each(|d| sums[k][d] += normal[d]);
        }
        if count == 0 {
            faces.normals[0] = open;
            return faces;
        }
        faces.count = count;
        for k in 0..count {
            faces.normals[k] = unit(sums[k]).unwrap_or(open);
        }
        faces
    }

    /// Find the faces of particles.
    pub(crate) fn find_faces_of(&mut self, particles: impl Iterator<Item = usize>) {
        self.skin.begin(self.positions.len());
        if !M::Form::TOTAL {
            self.skin.forget();
        }
        let round = self.skin.round;
        for i in particles {
            if self.skin.faces[i].round != round {
                let what = self.find_faces(i);
                self.skin.faces[i] = Found { round, what };
            }
        }
    }

    /// Append the surface points of a particle whose faces were found.
    pub(crate) fn surface_points(&self, i: usize, out: &mut Vec<SurfacePoint>) {
        let Some(faces) = self.skin.faces.get(i).filter(|f| f.round == self.skin.round) else { return };
        let faces = &faces.what;
        if faces.count == 0 {
            return;
        }
        let f = self.batches[i / BATCH].deformation.get(i % BATCH).copied();
        let f = f.unwrap_or(identity(D));
        let back = inverse(&f, D);
        let (x, half) = (wide(&self.positions[i]), 0.5 * self.surface * self.local_spacing(i));
        let area = self.local_spacing(i).powi(D as i32 - 1) * if Self::HOOP { x[0] } else { 1.0 };
        let mut add = |offset: [f64; 3], normal: [f64; 3], corner: bool| {
            let mut position = x;
            let mut turned = [0.0; 3];
            for a in 0..D {
                for c in 0..D {
                    position[a] += half * f[a][c] * offset[c];
                    // F^-T N.
                    turned[a] += back[c][a] * normal[c];
                }
            }
            let stretched = dot(&turned, &turned).sqrt() * determinant(&f, D);
            if let Some(normal) = unit(turned) {
                let area = if corner { 0.0 } else { area * stretched };
                out.push(SurfacePoint { position, normal, area, corner, reach: 0.0 });
            }
        };
        let normals = &faces.normals[..faces.count];
        normals.iter().for_each(|n| add(*n, *n, false));
        if faces.count > 1 && self.surface > 0.0 {
            // Intersection of all planes: the shortest vector o with o . n = 1 for each; for normals at right angles their sum.
            let sum: [f64; 3] = std::array::from_fn(|d| normals.iter().map(|n| n[d]).sum());
            let least = normals.iter().map(|n| dot(n, &sum)).fold(f64::INFINITY, f64::min);
            if let (Some(normal), true) = (unit(sum), least > 0.5) {
                let share = faces.count as f64 / normals.iter().map(|n| dot(n, &sum)).sum::<f64>();
                add(sum.map(|c| c * share), normal, true);
            }
        }
    }

    /// Visit the particles that move a point at an offset from a particle, v_i + L_i . offset, with their weights.
    pub(crate) fn carriers_of(&self, i: usize, point: &SurfacePoint, visit: &mut dyn FnMut(usize, [f64; 3])) {
        let own = self.numbers[i] as usize;
        let x = wide(&self.positions[i]);
        let offset: [f64; 3] = std::array::from_fn(|d| point.position[d] - x[d]);
        if !M::Correction::CORRECTED || offset == [0.0; 3] {
            return visit(own, [1.0; 3]);
        }
        let batch = &self.batches[i / BATCH];
        let c = &batch.correction[i % BATCH];
        let arm: [f64; 3] = std::array::from_fn(|a| if a < D { dot(&c[a], &offset) } else { 0.0 });
        let (index, slope) = batch.near.of(i % BATCH);
        let place = &self.records.place[i];
        let mut rest = 1.0;
        for (&j, &s) in index.iter().zip(slope) {
            let other = &self.records.place[j as usize];
            let along: f64 = (0..D).map(|d| (other[d] - place[d]) * arm[d]).sum();
            let weight = other[3] * s * along;
            rest -= weight;
            let (source, flips) = self.source(j as usize);
            visit(self.numbers[source] as usize, flips.map(|flip| flip * weight));
        }
        visit(own, [rest; 3]);
    }
}
