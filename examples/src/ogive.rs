//! Ogive rods as rings of particles and as meshes.

use std::f64::consts::PI;

use mpm_core::geometry::structured::{Butterfly, ogive_rod_mesh, ogive_rod_section_mesh};
use mpm_core::geometry::{ElementMesh, GeometryError, Metric, OgiveRod, Seeds, Shape};

/// A ring of a rod, m.
struct Ring {
    low: f64,
    high: f64,
    /// Radius of its particles.
    r: f64,
    /// Distance from the tail.
    s: f64,
    depth: f64,
}

/// Build seeds of these volumes, scaled by one factor to the total volume `exact`.
fn scaled<const D: usize>(
    positions: Vec<[f64; D]>,
    mut volumes: Vec<f64>,
    edge: f64,
    exact: f64,
) -> Seeds<D> {
    let raw: f64 = volumes.iter().sum();
    volumes.iter_mut().for_each(|v| *v *= exact / raw);
    Seeds {
        positions,
        volumes,
        half_size: [0.5 * edge; D],
        raw_measure: raw,
        exact_measure: Some(exact),
        sampled_measure: None,
        correction: exact / raw,
    }
}

/// A rod with a tangent ogive nose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ogive {
    /// Diameter of the shank, m.
    pub diameter: f64,
    /// Length from tail to tip, m.
    pub length: f64,
    /// Calibre-radius-head: radius of the arc over the diameter.
    pub crh: f64,
}

impl Ogive {
    /// Radius of the shank, m.
    pub fn radius(&self) -> f64 {
        0.5 * self.diameter
    }
    /// Length of the nose, m.
    pub fn nose(&self) -> f64 {
        self.radius() * (4.0 * self.crh - 1.0).sqrt()
    }
    /// Radius at the distance `s` from the tail, m; 0 beyond the ends.
    pub fn radius_at(&self, s: f64) -> f64 {
        let past = s - (self.length - self.nose());
        if !(0.0..=self.length).contains(&s) {
            0.0
        } else if past <= 0.0 {
            self.radius()
        } else {
            let arc = self.crh * self.diameter;
            ((arc * arc - past * past).sqrt() - arc + self.radius()).max(0.0)
        }
    }
    /// Volume, m^3.
    ///
    /// # Errors
    /// Invalid dimensions.
    pub fn volume(&self) -> Result<f64, GeometryError> {
        let rod = OgiveRod::new([0.0; 3], [0.0, 0.0, 1.0], self.diameter, self.length, self.crh)?;
        Ok(rod.measure().unwrap_or(f64::NAN))
    }

    /// Fill the rod with layers of concentric rings of particles `edge` apart, m: its surface is smooth, while that of a
    /// lattice has steps on which contact rattles. The outermost ring lies half an `edge` inside the surface, where
    /// particles of that half size touch it.
    ///
    /// The rod flies along (sin `angle`, 0, -cos `angle`), its tip at `tip`. Only the sector from the x-z plane towards y
    /// by `sector` (radians; PI for a half, PI/2 for a quarter) is filled. The second result is the distance of each
    /// particle from the tail, m.
    ///
    /// # Errors
    /// Invalid dimensions.
    pub fn rings(
        &self,
        tip: [f64; 3],
        angle: f64,
        sector: f64,
        edge: f64,
    ) -> Result<(Seeds<3>, Vec<f64>), GeometryError> {
        let (sine, cosine) = angle.sin_cos();
        let (mut positions, mut volumes, mut from_tail) = (Vec::new(), Vec::new(), Vec::new());
        for Ring { low, high, r, s, depth } in self.cut(edge) {
            let around = (sector * r / edge).round().max(1.0);
            for n in 0..around as usize {
                let (sin, cos) = (sector * (n as f64 + 0.5) / around).sin_cos();
                // Coordinates across the rod in the plane of flight, along y, and back from the tip.
                let (across, side, back) = (r * cos, r * sin, self.length - s);
                positions.push([
                    tip[0] + across * cosine - back * sine,
                    tip[1] + side,
                    tip[2] + across * sine + back * cosine,
                ]);
                volumes.push(0.5 * sector * (high * high - low * low) * depth / around);
                from_tail.push(s);
            }
        }
        let exact = self.volume()? * sector / (2.0 * PI);
        let seeds = scaled(positions, volumes, edge, exact);
        Ok((seeds, from_tail))
    }

    /// Mesh the rod with bricks with edges of about `edge`, m; the section is widened to the volume of the rod. `keep`
    /// selects bricks by their centre in coordinates of the rod (across it in the plane of flight, along y, from the tail),
    /// m. The second result is the distance of each brick from the tail, m.
    ///
    /// # Errors
    /// Invalid dimensions or edge.
    pub fn bricks(
        &self,
        tip: [f64; 3],
        angle: f64,
        edge: f64,
        keep: impl Fn([f64; 3]) -> bool,
    ) -> Result<(ElementMesh<3>, Vec<f64>), GeometryError> {
        let rod = OgiveRod::new([0.0; 3], [0.0, 0.0, 1.0], self.diameter, self.length, self.crh)?;
        let whole = ogive_rod_mesh(&rod, Butterfly::of_edge(self.radius(), edge)?, self.along(edge))?;
        // Factor for the section outside the chords between nodes: 4.5 % of it with 12 nodes around.
        let wider = (self.volume()? / whole.measure(Metric::Cartesian)?).sqrt();
        let centre = |nodes: &[u32]| {
            let mut sum = [0.0; 3];
            for &n in nodes {
                (0..3).for_each(|d| sum[d] += whole.nodes[n as usize][d] / nodes.len() as f64);
            }
            sum
        };
        let bricks = whole.part(&|block, element| {
            let size = whole.blocks[block].kind.nodes();
            keep(centre(&whole.blocks[block].nodes[element * size..][..size]))
        })?;
        let own = |nodes: &[u32]| {
            nodes.iter().map(|&n| bricks.nodes[n as usize][2]).sum::<f64>() / nodes.len() as f64
        };
        let from_tail = bricks.blocks.iter().flat_map(|block| block.elements().map(own)).collect();
        let (sine, cosine) = angle.sin_cos();
        let mesh = bricks.mapped(|[across, side, s]| {
            let (across, side, back) = (wider * across, wider * side, self.length - s);
            [tip[0] - across * cosine - back * sine, tip[1] + side, tip[2] - across * sine + back * cosine]
        })?;
        Ok((mesh, from_tail))
    }

    /// Mesh the section of the rod with quadrilaterals with edges of about `edge`, m, in the position of
    /// [`Ogive::profile`]; it is widened to the volume of the rod.
    ///
    /// # Errors
    /// Invalid dimensions or edge.
    pub fn quadrilaterals(&self, tip: f64, edge: f64) -> Result<ElementMesh<2>, GeometryError> {
        let rod = OgiveRod::new([0.0, tip + self.length], [0.0, -1.0], self.diameter, self.length, self.crh)?;
        let mesh = ogive_rod_section_mesh(&rod, Butterfly::of_edge(self.radius(), edge)?, self.along(edge))?;
        let wider = (self.volume()? / (2.0 * PI * mesh.measure(Metric::Axisymmetric)?)).sqrt();
        mesh.mapped(|[r, z]| [wider * r, z])
    }

    /// Return the number of elements of an edge along the shank.
    fn along(&self, edge: f64) -> usize {
        ((self.length - self.nose()) / edge).round().max(1.0) as usize
    }

    /// Fill the rod in the half plane of (r, z), flying along -z on the axis r = 0 with its tip at the height `tip`, m;
    /// volumes are per radian.
    ///
    /// # Errors
    /// Invalid dimensions.
    pub fn profile(&self, tip: f64, edge: f64) -> Result<Seeds<2>, GeometryError> {
        let rings = self.cut(edge);
        let positions = rings.iter().map(|ring| [ring.r, tip + self.length - ring.s]).collect();
        let volume = |ring: &Ring| 0.5 * (ring.high * ring.high - ring.low * ring.low) * ring.depth;
        let volumes = rings.iter().map(volume).collect();
        Ok(scaled(positions, volumes, edge, self.volume()? / (2.0 * PI)))
    }

    /// Cut the rod into layers and these into rings about `edge` wide.
    fn cut(&self, edge: f64) -> Vec<Ring> {
        let layers = (self.length / edge).round().max(1.0);
        let depth = self.length / layers;
        let mut cut = Vec::new();
        for layer in 0..layers as usize {
            let s = (layer as f64 + 0.5) * depth;
            let outer = self.radius_at(s);
            // Rings of equal width inside the outermost ring.
            let inner = (outer - edge).max(0.0);
            let count = (inner / edge).round().max(if inner > 0.25 * edge { 1.0 } else { 0.0 });
            let core = if count > 0.0 { inner } else { 0.0 };
            let r = (outer - 0.5 * edge).max(0.5 * outer);
            cut.push(Ring { low: core, high: outer, r, s, depth });
            for ring in 0..count as usize {
                let (low, high) = (core * ring as f64 / count, core * (ring as f64 + 1.0) / count);
                cut.push(Ring { low, high, r: 0.5 * (low + high), s, depth });
            }
        }
        cut
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROD: Ogive = Ogive { diameter: 12.9e-3, length: 88.9e-3, crh: 3.0 };

    #[test]
    fn nose_and_mass_are_those_of_the_reference() {
        assert!((ROD.nose() - 21.39e-3).abs() < 0.01e-3);
        assert!((ROD.volume().expect("a rod") - 1.0352e-5).abs() < 0.0001e-5);
    }

    #[test]
    fn half_a_rod_of_rings_has_its_volume_its_centroid_and_its_surface() {
        for edge in [1.5e-3, 0.7e-3] {
            let angle = 0.5;
            let (seeds, from_tail) = ROD.rings([0.01, 0.0, 0.02], angle, PI, edge).expect("a rod");
            assert!((seeds.measure() / (0.5 * 1.0352e-5) - 1.0).abs() < 1e-4);
            // The correction is of second order in the layer thickness.
            assert!((seeds.correction - 1.0).abs() < 2e-3, "{}", seeds.correction);
            let direction = [angle.sin(), 0.0, -angle.cos()];
            let tail = [0, 1, 2].map(|d| [0.01, 0.0, 0.02][d] - ROD.length * direction[d]);
            let shape = OgiveRod::new(tail, direction, ROD.diameter, ROD.length, ROD.crh).expect("a rod");
            let mut nearest = f64::NEG_INFINITY;
            for (x, s) in seeds.positions.iter().zip(&from_tail) {
                assert!(x[1] > 0.0 && shape.contains(*x));
                let along: f64 = (0..3).map(|d| (x[d] - tail[d]) * direction[d]).sum();
                assert!((along - s).abs() < 1e-12);
                // Along the shank no particle crosses the surface, and some touch it.
                if *s < ROD.length - ROD.nose() && *s > edge {
                    nearest = nearest.max(shape.signed_distance(*x));
                }
            }
            assert!((nearest / (-0.5 * edge) - 1.0).abs() < 1e-9, "{nearest}");
        }
    }

    #[test]
    fn elements_have_the_volume_of_the_rod() {
        for edge in [3e-3, 1.5e-3] {
            let whole = ROD.volume().expect("a rod");
            let quarter = |[across, side, _]: [f64; 3]| across < 0.0 && side > 0.0;
            let (bricks, from_tail) = ROD.bricks([0.01, 0.0, 0.02], 0.5, edge, quarter).expect("a rod");
            assert!((4.0 * bricks.measure(Metric::Cartesian).expect("volume") / whole - 1.0).abs() < 1e-9);
            assert_eq!(from_tail.len(), bricks.elements());
            let section = ROD.quadrilaterals(0.01, edge).expect("a rod");
            let volume = 2.0 * PI * section.measure(Metric::Axisymmetric).expect("volume");
            assert!((volume / whole - 1.0).abs() < 1e-9);
            let lowest = section.nodes.iter().fold(f64::INFINITY, |z, x| z.min(x[1]));
            assert!((lowest - 0.01).abs() < 1e-12);
        }
    }

    #[test]
    fn the_profile_has_the_mass_of_the_rod_per_radian() {
        let edge = 0.7e-3;
        let seeds = ROD.profile(0.01, edge).expect("a rod");
        assert!((2.0 * PI * seeds.measure() / 1.0352e-5 - 1.0).abs() < 1e-4);
        assert!((seeds.correction - 1.0).abs() < 2e-3, "{}", seeds.correction);
        let (most, lowest) =
            seeds.positions.iter().fold((0.0_f64, f64::INFINITY), |(r, z), x| (r.max(x[0]), z.min(x[1])));
        assert!((most - (ROD.radius() - 0.5 * edge)).abs() < 1e-12, "{most}");
        assert!(lowest > 0.01 && lowest < 0.01 + edge, "{lowest}");
    }
}
