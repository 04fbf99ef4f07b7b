//! Where particles are at the start, and how they are refused.

use impactite_geometry::Seeds;
use impactite_scene::SceneError;
use impactite_scene::error::parameter;

/// Most particles.
const MOST: f64 = (1u32 << 29) as f64;

/// What a body starts from: positions, volumes and spacings of its particles.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout<const D: usize> {
    /// Positions, m.
    pub positions: Vec<[f64; D]>,
    /// Volumes, one a particle: m^3 (m^2 in plane strain, m^3 per radian around an axis).
    pub volumes: Vec<f64>,
    /// Spacings, m, one a particle: the smoothing length is the kernel's ratio times this, the surface half of it beyond the particle.
    /// They may differ within a body; what is next to each other should be alike (by some per cent).
    pub spacings: Vec<f64>,
    /// How far the surface of the body lies beyond its outermost particles, in half spacings: where walls and other bodies meet it. 1 for
    /// particles that fill their cells, 0 for such as lie on the surface.
    pub surface: f64,
}

impl<const D: usize> Layout<D> {
    /// Seeds of a shape, one spacing, the edge of a particle: the surface lies half of it beyond the outermost ones.
    pub fn of_seeds(seeds: &Seeds<D>) -> Self {
        let volume: f64 = seeds.half_size.iter().map(|h| 2.0 * h).product();
        let spacing = volume.powf(1.0 / D as f64);
        Layout {
            positions: seeds.positions.clone(),
            volumes: seeds.volumes.clone(),
            spacings: vec![spacing; seeds.len()],
            surface: 1.0,
        }
    }

    /// Another layout beside this one, in one body.
    #[must_use]
    pub fn and(mut self, other: Layout<D>) -> Self {
        self.positions.extend(other.positions);
        self.volumes.extend(other.volumes);
        self.spacings.extend(other.spacings);
        self
    }

    /// How many particles.
    pub fn len(&self) -> usize {
        self.positions.len()
    }
    /// Are there none?
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Refuse what cannot be.
    pub(crate) fn check(&self, hoop: bool) -> Result<(), SceneError> {
        let particles = self.len();
        if particles == 0 {
            return Err(SceneError::Empty(BODY.into()));
        }
        if particles as f64 >= MOST {
            return Err(SceneError::TooMany { body: BODY.into(), count: particles, most: MOST as usize - 1 });
        }
        for (field, found) in [("volumes", self.volumes.len()), ("spacings", self.spacings.len())] {
            if found != particles {
                return Err(SceneError::Length { field, found, particles });
            }
        }
        let allowed = "zero or positive, and finite";
        parameter(
            self.surface >= 0.0,
            "layout",
            "surface beyond particles in half spacings",
            self.surface,
            allowed,
        )?;
        for (n, x) in self.positions.iter().enumerate() {
            for &value in x {
                number(value.is_finite(), "position", n, value, "finite")?;
            }
            if hoop {
                number(x[0] > 0.0, "distance from the axis", n, x[0], "positive")?;
            }
        }
        for (field, list) in [("volume", &self.volumes), ("spacing", &self.spacings)] {
            for (n, &value) in list.iter().enumerate() {
                number(value > 0.0 && value.is_finite(), field, n, value, "positive and finite")?;
            }
        }
        Ok(())
    }

    /// Particles sorted along a curve that fills space (Morton's), in cells of a few spacings: neighbours in space are so in memory. For each
    /// place the number it had.
    pub(crate) fn order(&self) -> Vec<u32> {
        let (mut low, mut cell) = ([f64::INFINITY; D], 0.0);
        for (x, spacing) in self.positions.iter().zip(&self.spacings) {
            for d in 0..D {
                low[d] = low[d].min(x[d]);
            }
            cell += 4.0 * spacing / self.len() as f64;
        }
        let key = |n: &u32| {
            let mut key = 0u64;
            for d in 0..D {
                // What is beyond the range of an integer saturates.
                let along = ((self.positions[*n as usize][d] - low[d]) / cell) as u64;
                for bit in 0..20 {
                    key |= (along >> bit & 1) << (bit * D + d);
                }
            }
            (key, *n)
        };
        let mut order: Vec<u32> = (0..self.len() as u32).collect();
        order.sort_by_cached_key(key);
        order
    }
}

/// What a body is called that has no name.
pub(crate) const BODY: &str = "body";

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
