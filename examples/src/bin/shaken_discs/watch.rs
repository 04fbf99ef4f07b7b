//! Positions and overlaps of the discs over time.

use mpm_core::observe::{ObserveError, Observer, Pace, RunView};
use mpm_core::{Archive, CheckpointError};

use crate::layout::Layout;
use crate::scene::MATERIAL;

/// State of the discs at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Mean height of the centres of the large discs, and of the small ones, above the floor, m.
    pub heights: [f64; 2],
    /// Largest overlap of the surfaces of two discs, or of a disc and the container, m.
    pub overlap: f64,
    /// Bodies of that overlap: discs by number, the container after all discs.
    pub pair: [usize; 2],
    /// Kinetic energy, J/m.
    pub kinetic: f64,
    /// Number of particles.
    pub particles: usize,
}

/// Observer of the discs.
pub struct Watch {
    pace: Pace,
    inside: [f64; 2],
    radii: Vec<f64>,
    large: usize,
    /// Half size of a particle, m.
    half: f64,
    density: f64,
    pub rows: Vec<Row>,
}

impl Watch {
    /// Create the observer of this layout, with particles of half size `half` (m).
    pub fn new(pace: Pace, layout: &Layout, half: f64) -> Self {
        let radii = layout.discs.iter().map(|d| d.radius).collect();
        Watch {
            pace,
            inside: layout.inside,
            radii,
            large: layout.large,
            half,
            density: MATERIAL[0],
            rows: Vec::new(),
        }
    }

    /// Return the largest overlap of surfaces and its bodies: between discs along the line of centres from the particles near it, at the
    /// container from any particle.
    fn overlap(&self, discs: &[Cloud]) -> (f64, [usize; 2]) {
        let mut deepest = (f64::NEG_INFINITY, [0; 2]);
        let mut note = |overlap: f64, pair| {
            if overlap > deepest.0 {
                deepest = (overlap, pair);
            }
        };
        for (n, (disc, r)) in discs.iter().zip(&self.radii).enumerate() {
            for x in &disc.particles {
                for d in 0..2 {
                    note((x[2] - x[d]).max(x[d] + x[2] - self.inside[d]), [n, discs.len()]);
                }
            }
            for (m, (other, s)) in discs.iter().zip(&self.radii).enumerate().skip(n + 1) {
                let way = [0, 1].map(|d| other.centre[d] - disc.centre[d]);
                let distance = way[0].hypot(way[1]);
                if distance < r + s + 2.0 * self.half {
                    let normal = way.map(|x| x / distance);
                    let reach = disc.reach(normal, self.half) + other.reach(normal.map(|x| -x), self.half);
                    note(reach - distance, [n, m]);
                }
            }
        }
        deepest
    }
}

/// Particles of a disc.
struct Cloud {
    centre: [f64; 2],
    /// Positions and half sizes, m.
    particles: Vec<[f64; 3]>,
}

impl Cloud {
    /// Return the distance of the surface from the centre along a unit vector, from the particles of half size `half` within one particle
    /// size of the line.
    fn reach(&self, normal: [f64; 2], half: f64) -> f64 {
        let from = |x: &[f64; 3]| [x[0] - self.centre[0], x[1] - self.centre[1], x[2]];
        let near = self
            .particles
            .iter()
            .map(from)
            .filter(|r| (r[0] * normal[1] - r[1] * normal[0]).abs() < half * 2.0);
        near.map(|r| r[0] * normal[0] + r[1] * normal[1] + r[2]).fold(f64::NEG_INFINITY, f64::max)
    }
}

impl Observer for Watch {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let mut discs = Vec::with_capacity(self.radii.len());
        for body in &now.bodies()[1..] {
            let (mut mass, mut place) = (0.0, [0.0; 2]);
            let mut particles = Vec::with_capacity(body.len());
            body.for_each(&mut |p| {
                mass += p.mass;
                (0..2).for_each(|d| place[d] += p.mass * p.position[d]);
                // Half size along the contact normal: a particle in contact is flattened by its volume ratio.
                let half = self.half * p.volume * self.density / p.mass;
                particles.push([p.position[0], p.position[1], half]);
            });
            discs.push(Cloud { centre: place.map(|x| x / mass), particles });
        }
        let (overlap, pair) = self.overlap(&discs);
        let mean = |of: &[Cloud]| of.iter().map(|c| c.centre[1]).sum::<f64>() / of.len() as f64;
        let (large, small) = discs.split_at(self.large);
        self.rows.push(Row {
            time: now.time(),
            heights: [mean(large), mean(small)],
            overlap,
            pair,
            kinetic: now.totals().kinetic,
            particles: discs.iter().map(|d| d.particles.len()).sum(),
        });
        Ok(())
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.rows, &Row::default(), |file, row| {
            let Row { time, heights, overlap, pair, kinetic, particles } = row;
            file.reals([time, overlap, kinetic].into_iter().chain(heights))?;
            pair.iter_mut().chain([particles]).try_for_each(|n| file.count(n))
        })
    }
}
