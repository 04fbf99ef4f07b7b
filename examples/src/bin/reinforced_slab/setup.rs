//! Geometry and parameters.

use clap::ValueEnum;
use examples::Ogive;
use mpm_core::geometry::Cuboid;
use serde::Serialize;

/// Geometry of the rod, that of `concrete_perforation`.
pub const ROD: Ogive = Ogive { diameter: 25.4e-3, length: 143.7e-3, crh: 3.0 };
/// Mass of the whole rod, kg.
pub const MASS: f64 = 0.50;
/// Density, kg/m^3, of concrete and steel.
pub const DENSITY: [f64; 2] = [2440.0, 7850.0];
/// Young's modulus of concrete \[M\] and steel, Pa.
pub const YOUNG: [f64; 2] = [34e9, 200e9];
/// Poisson's ratio of steel.
pub const POISSON: f64 = 0.3;
/// Yield stress of the bars, Pa.
pub const YIELD: f64 = 500e6;
/// Concrete cover: distance from either face of the slab to the centre of the bars along x; and the offset of the bars along y further
/// inside, the width of a bar of 1 cm^2, m.
const COVER: [f64; 2] = [15e-3, 10e-3];

/// What hits the slab.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Load {
    /// An ogive rod of steel
    Rod,
    /// A pressure on a square in the middle of the front that falls linearly
    Blast,
}

/// Discretisation of bars.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Bars {
    /// Line elements embedded in the particles of the slab.
    Lines,
    /// Particles of steel in place of concrete.
    Particles,
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub load: Load,
    pub bars: Bars,
    /// Impact speed, m/s.
    pub speed: f64,
    /// Blast: pressure, Pa, duration, s, and half edge of the square, m.
    pub blast: [f64; 3],
    /// Section of a bar, m^2; 0 for no bars.
    pub section: f64,
    /// Spacing of bars, m.
    pub spacing: f64,
    /// Half edge of the slab, and its thickness, m.
    pub slab: [f64; 2],
    /// Cells through the slab.
    pub cells: u32,
    /// Factor of the time step.
    pub factor: f64,
    pub threads: usize,
}

impl Setup {
    /// Cell size, m.
    pub fn cell(&self) -> f64 {
        self.slab[1] / f64::from(self.cells)
    }
    /// Return the centre lines of the bars of the quarter: axis x or y, position along the other one, and height, m.
    pub fn bars(&self) -> Vec<(usize, [f64; 2])> {
        if self.section == 0.0 {
            return Vec::new();
        }
        let [half, thickness] = self.slab;
        let [cover, width] = COVER;
        let count = ((half / self.spacing - 0.5).floor() as usize) + 1;
        let across = (0..count).map(|n| (n as f64 + 0.5) * self.spacing).filter(|&y| y < half);
        let layers =
            [(0, -cover), (1, -cover - width), (0, cover - thickness), (1, cover + width - thickness)];
        across.flat_map(|y| layers.map(|(axis, z)| (axis, [y, z]))).collect()
    }
    /// Return the bars as square boxes.
    pub fn boxes(&self) -> Result<Vec<Cuboid<3>>, mpm_core::geometry::GeometryError> {
        let d = 0.5 * self.section.sqrt();
        let of = |(axis, [y, z]): (usize, [f64; 2])| {
            let (low, high) = ([0.0, y - d, z - d], [self.slab[0], y + d, z + d]);
            let turned = |[a, b, c]: [f64; 3]| if axis == 0 { [a, b, c] } else { [b, a, c] };
            Cuboid::new(turned(low), turned(high))
        };
        self.bars().into_iter().map(of).collect()
    }
    /// Return the mass of the bars of the quarter, kg, with this density, kg/m^3.
    pub fn bars_mass(&self, density: f64) -> f64 {
        self.bars().len() as f64 * self.slab[0] * self.section * density
    }
    /// Return the kinetic energy of a quarter of the rod before impact, J.
    pub fn energy(&self) -> f64 {
        0.125 * MASS * self.speed * self.speed
    }
    /// Return the name in file names.
    pub fn name(&self) -> String {
        let load = match self.load {
            Load::Rod => format!("rod_{:.0}", self.speed),
            Load::Blast => "blast".into(),
        };
        let bars = match self.bars {
            _ if self.section == 0.0 => "plain".to_string(),
            Bars::Lines => format!("lines_{:.0}mm2", 1e6 * self.section),
            Bars::Particles => format!("particles_{:.0}mm2", 1e6 * self.section),
        };
        format!("{load}_{bars}_{:.0}mm_{}", 1e3 * self.slab[0], self.cells)
    }
}
