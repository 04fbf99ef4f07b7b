//! Pairs of particles as places for detectors and normal rules.

use super::body::{Facing, ParticleBody};
use super::member::{Member, Place};
use crate::places::{NearPoint, Places, SurfaceQuantity, each_place};
use crate::vector::{difference, dot, wide};

/// Particle, or the foot of one on a wall, as one side of a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side<const D: usize> {
    pub place: Place,
    pub position: [f64; D],
    /// Mass, kg; infinite for a wall.
    pub mass: f64,
    /// Outward surface; for a lone particle, and beside a wall, towards the other side.
    pub facing: Facing,
    pub radius: f64,
    /// Distance of the surface beyond the position, m.
    pub beyond: f64,
}

/// Pair whose surfaces face each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct FacingPair<const D: usize> {
    pub sides: [Side<D>; 2],
}

impl<const D: usize> FacingPair<D> {
    /// Vector from the first to the second, m.
    pub fn apart(&self) -> [f64; 3] {
        let [a, b] = &self.sides;
        difference(wide(&b.position), wide(&a.position))
    }
}

/// Up to 64 pairs of two bodies.
pub(super) struct PairPlaces<'a, const D: usize> {
    pub pairs: &'a [FacingPair<D>],
    pub members: &'a [Member<D>],
    pub spacing: f64,
}

impl<'a, const D: usize> PairPlaces<'a, D> {
    fn part(&self, side: &Side<D>) -> Option<&'a dyn ParticleBody<D>> {
        self.members[side.place.body as usize].part()
    }
}

impl<const D: usize> Places<f64, D> for PairPlaces<'_, D> {
    fn body(&self, field: usize) -> usize {
        self.pairs[0].sides[field].place.body as usize
    }
    fn spacing(&self) -> f64 {
        self.spacing
    }
    /// True for pairs without a wall, whose normal is known, if a body defines normals by positions.
    fn around_nodes(&self) -> bool {
        let parts = self.pairs[0].sides.iter().map(|side| self.part(side));
        parts.clone().all(|part| part.is_some()) && parts.flatten().any(|part| part.by_places())
    }
    fn position(&self, n: usize) -> [f64; D] {
        let [a, b] = &self.pairs[n].sides;
        let mut middle = a.position;
        for d in 0..D {
            middle[d] += 0.5 * (b.position[d] - a.position[d]);
        }
        middle
    }

    fn mass(&self, field: usize, n: usize) -> f64 {
        self.pairs[n].sides[field].mass
    }
    fn velocity(&self, field: usize, n: usize) -> [f64; 3] {
        let place = self.pairs[n].sides[field].place;
        match &self.members[place.body as usize] {
            Member::Body { part, .. } => wide(&part.particle(place.particle as usize).velocity),
            Member::Wall { wall } => wall.velocity(),
        }
    }
    fn surface_quantity(
        &self,
        field: usize,
        quantity: SurfaceQuantity,
        places: u64,
        normals: &[[f64; 3]],
        out: &mut [[f64; 3]],
    ) {
        for n in each_place(places) {
            let side = &self.pairs[n].sides[field];
            let vector = match quantity {
                SurfaceQuantity::MassGradient => side.facing.mass,
                SurfaceQuantity::VolumeGradient => side.facing.area,
                SurfaceQuantity::Reach | SurfaceQuantity::LocalReach | SurfaceQuantity::CentreReach => {
                    let along = dot(difference(wide(&side.position), wide(&self.position(n))), normals[n]);
                    let half = if quantity == SurfaceQuantity::CentreReach { 0.0 } else { side.beyond };
                    out[n][0] = out[n][0].max(along + half);
                    continue;
                }
                SurfaceQuantity::Traction => {
                    let particle = side.place.particle as usize;
                    if let Some(part) = self.part(side) {
                        out[n][0] += side.mass * part.traction(particle, &normals[n]);
                    }
                    continue;
                }
            };
            for d in 0..3 {
                out[n][d] += vector[d];
            }
        }
    }

    /// Visit the particle of the pair and those of its piece of surface; for a wall, the foot of the other side.
    fn near_points(&self, field: usize, places: u64, visit: &mut dyn FnMut(u64, &NearPoint<f64>)) {
        let origin = self.position(0);
        for n in each_place(places) {
            let side = &self.pairs[n].sides[field];
            let mut show = |x: &[f64; D], mass: f64, half: f64| {
                let offset: [f64; 3] = std::array::from_fn(|d| if d < D { x[d] - origin[d] } else { 0.0 });
                let mut halves = [0.0; 3];
                halves[..D].fill(half);
                visit(1 << n, &NearPoint { offset, half: halves, radius: half, mass });
            };
            match self.part(side) {
                None => show(&side.position, side.mass, side.beyond),
                Some(part) => part.around(side.place.particle as usize, &mut |m| {
                    let p = part.particle(m);
                    show(&p.position, p.mass, part.beyond(m));
                }),
            }
        }
    }
}
