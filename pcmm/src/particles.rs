//! Particles, and checks of packings.

use impactite_geometry::{Lattice, Seeds, Shape};
use impactite_scene::SceneError;
use impactite_scene::error::parameter;

/// Particle: position, velocity, mass and contact radius. Strain, stress and history are stored in the elements between particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Velocity, m/s.
    pub velocity: [f64; D],
    /// Mass, kg: per metre of depth in plane strain, per radian in axisymmetric scenes.
    pub mass: f64,
    /// Contact radius R, m.
    pub radius: f64,
}

/// Initial state of a body: positions and radii, and the volume of each particle if known.
#[derive(Clone, Debug, PartialEq)]
pub struct Packing<const D: usize> {
    /// Positions, m.
    pub positions: Vec<[f64; D]>,
    /// Radii, m, one per particle.
    pub radii: Vec<f64>,
    /// Volumes, m^3 (m^2 in plane strain, m^3 per radian in axisymmetric scenes), one per particle or none at all.
    pub volumes: Vec<f64>,
    /// Distance from the centres of the outermost particles to the surface of the body, in radii. Other bodies are in contact with this
    /// surface. 0 for particles on the surface, 1 for particles half a spacing within it.
    pub surface: f64,
}

/// Upper bound of the number of particles (excluded).
pub(crate) const MOST: f64 = (1u32 << 29) as f64;
/// Distance of a node from the surface of a shape, in spacings, below which it is on it.
const ON_SURFACE: f64 = 1e-6;

impl<const D: usize> Packing<D> {
    /// Create a particle at every lattice node in the shape or on its surface, with a radius of half the spacing and no volume of its own.
    /// The elements between them end at the surface of the shape (as far as it follows the lattice), and determine the masses of the
    /// particles.
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

    /// Create particles in contact from the seeds of a shape: the radius is half the edge of a particle, the volumes are those of the
    /// seeds. The surface of the elements is at the outermost centres, half a spacing within that of the shape.
    pub fn of_seeds(seeds: &Seeds<D>) -> Self {
        let radius = seeds.half_size.iter().fold(f64::INFINITY, |m, h| m.min(*h));
        Packing {
            positions: seeds.positions.clone(),
            radii: vec![radius; seeds.len()],
            volumes: seeds.volumes.clone(),
            surface: 1.0,
        }
    }

    /// Create a packing of spheres (circles) of known radii.
    pub fn of_spheres(positions: Vec<[f64; D]>, radii: Vec<f64>) -> Self {
        Packing { positions, radii, volumes: Vec::new(), surface: 1.0 }
    }

    /// Check the number of particles, the lengths of the lists and the ranges of the values.
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

/// Default name of a body.
pub(crate) const BODY: &str = "body";

pub(crate) fn too_many(count: usize) -> SceneError {
    SceneError::TooMany { body: BODY.into(), count, most: MOST as usize - 1 }
}

/// Refuse a particle's number unless `holds`.
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
