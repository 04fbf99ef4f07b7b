//! Particles, and how they are refused.

use impactite_geometry::{Lattice, Seeds, Shape};
use impactite_scene::SceneError;
use impactite_scene::error::parameter;

/// A particle: a place, a velocity, a mass and a radius of contact. Strain, stress and history live in the elements
/// between particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Velocity, m/s.
    pub velocity: [f64; D],
    /// Mass, kg: per metre of depth in plane strain, per radian in axisymmetric scenes.
    pub mass: f64,
    /// Radius of contact R, m.
    pub radius: f64,
}

/// What a solver starts from: positions and radii, and the volume each particle stands for where it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Packing<const D: usize> {
    /// Positions, m.
    pub positions: Vec<[f64; D]>,
    /// Radii, m, one a particle.
    pub radii: Vec<f64>,
    /// Volumes, m^3 (m^2 in plane strain, m^3 per radian in axisymmetric scenes), one a particle or none at all.
    pub volumes: Vec<f64>,
    /// How far the surface of the body lies beyond the centres of its outermost particles, in their radii: where other
    /// bodies meet it. 0 for particles on the surface, 1 for such as lie half a spacing within it.
    pub surface: f64,
}

/// Most particles.
const MOST: f64 = (1u32 << 29) as f64;
/// A node this near to the surface of a shape, in spacings, lies on it.
const ON_SURFACE: f64 = 1e-6;

impl<const D: usize> Packing<D> {
    /// A particle at every node of the lattice that lies in the shape or on its surface, with a radius of half the
    /// spacing and no volume of its own. The elements between them then end where the shape does (as far as its surface
    /// follows the lattice), and give the particles their masses.
    ///
    /// # Errors
    /// More than 2^29 nodes in the bounds of the shape.
    pub fn on_nodes(shape: &(impl Shape<D> + ?Sized), lattice: &Lattice<D>) -> Result<Self, SceneError> {
        let bounds = shape.bounds();
        let h = lattice.spacing();
        let (mut first, mut counts) = ([0i64; D], [0i64; D]);
        for d in 0..D {
            let index = |x: f64| (x - lattice.origin()[d]) / h;
            let low = (index(bounds.min[d]) - ON_SURFACE).ceil();
            let high = (index(bounds.max[d]) + ON_SURFACE).floor();
            first[d] = low as i64;
            counts[d] = (high - low + 1.0).max(0.0) as i64;
        }
        let sites = counts.iter().fold(1.0, |n, &c| n * c as f64);
        if sites >= MOST {
            return Err(too_many(sites as usize));
        }
        let mut positions = Vec::new();
        for site in 0..sites as i64 {
            let (mut node, mut rest) = (first, site);
            for d in (0..D).rev() {
                node[d] += rest % counts[d];
                rest /= counts[d];
            }
            let x = lattice.node(node);
            if shape.signed_distance(x) <= ON_SURFACE * h {
                positions.push(x);
            }
        }
        let radii = vec![0.5 * h; positions.len()];
        Ok(Packing { positions, radii, volumes: Vec::new(), surface: 0.0 })
    }

    /// Seeds of a shape, touching: the radius is half the edge of a particle, the volumes are the seeds'. The surface of
    /// the elements is that of the outermost centres, half a spacing within the shape's.
    pub fn of_seeds(seeds: &Seeds<D>) -> Self {
        let radius = seeds.half_size.iter().fold(f64::INFINITY, |m, h| m.min(*h));
        Packing {
            positions: seeds.positions.clone(),
            radii: vec![radius; seeds.len()],
            volumes: seeds.volumes.clone(),
            surface: 1.0,
        }
    }

    /// Spheres (circles) of known radii.
    pub fn of_spheres(positions: Vec<[f64; D]>, radii: Vec<f64>) -> Self {
        Packing { positions, radii, volumes: Vec::new(), surface: 1.0 }
    }

    /// Refuse what cannot be.
    pub(crate) fn check(&self) -> Result<(), SceneError> {
        let particles = self.positions.len();
        if particles == 0 {
            return Err(SceneError::Empty(BODY.into()));
        }
        if particles as f64 >= MOST {
            return Err(too_many(particles));
        }
        let lengths = [("radii", self.radii.len(), false), ("volumes", self.volumes.len(), true)];
        for (field, found, may_lack) in lengths {
            if found != particles && !(may_lack && found == 0) {
                return Err(SceneError::Length { field, found, particles });
            }
        }
        let allowed = "zero or positive, and finite";
        parameter(self.surface >= 0.0, "packing", "surface beyond centres in radii", self.surface, allowed)?;
        for (particle, x) in self.positions.iter().enumerate() {
            for value in *x {
                number(value.is_finite(), "position", particle, value, "finite")?;
            }
        }
        for (field, list) in [("radius", &self.radii), ("volume", &self.volumes)] {
            for (particle, &value) in list.iter().enumerate() {
                number(value > 0.0 && value.is_finite(), field, particle, value, "positive and finite")?;
            }
        }
        Ok(())
    }
}

/// What a body is called that has no name.
pub(crate) const BODY: &str = "body";

fn too_many(count: usize) -> SceneError {
    SceneError::TooMany { body: BODY.into(), count, most: MOST as usize - 1 }
}

/// Refuse a number of a particle unless `holds`.
pub(crate) fn number(
    holds: bool,
    field: &'static str,
    particle: usize,
    value: f64,
    allowed: &'static str,
) -> Result<(), SceneError> {
    let body = || BODY.to_string();
    if holds { Ok(()) } else { Err(SceneError::Seed { body: body(), field, particle, value, allowed }) }
}
