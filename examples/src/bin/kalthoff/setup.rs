//! Plate, steel and loading.

use std::sync::Arc;

use examples::CaseError;
use examples::cracks::{CrackOption, Load, Plane, Softening, Torn, random_cells};
use examples::fragile::Joint;
use fpm::{Cells, Domain, Notch};
use mpm_materials::strength::{Adiabatic, Heat, Logarithmic};
use mpm_materials::{
    IntoMaterial, JohnsonCook, JohnsonCookDamage, LinearElastic, Material, MieGruneisen, Moduli, Solid,
};
use serde::Serialize;

/// Edge length of the half model, length of the notch, and height of the notch above the plane of symmetry, m.
pub const EDGE: f64 = 0.1;
pub const NOTCH: f64 = 0.05;
pub const HEIGHT: f64 = 0.025;
/// Notch tip.
pub const TIP: [f64; 2] = [NOTCH, HEIGHT];
pub const YOUNG: f64 = 190e9;
pub const POISSON: f64 = 0.3;
pub const DENSITY: f64 = 8000.0;
/// Rise time of the velocity of the struck edge, s.
const RAMP: f64 = 1e-6;

/// Johnson-Cook strength of a maraging steel, **from memory of the literature**: A, B, Pa, n, C, and thermal constants: a yield stress of 2
/// GPa with little hardening.
const YIELD: f64 = 2000e6;
const HARDENING: f64 = 100e6;
const EXPONENT: f64 = 0.3;
const RATE: f64 = 0.005;
const HEAT: Heat<f64> =
    Heat { room: ROOM, melt: 1700.0, exponent: 0.8, heat_capacity: 450.0, taylor_quinney: 0.9 };
/// Slope of the shock line and Grueneisen's gamma, those of 4340 steel.
const SHOCK: [f64; 2] = [1.92, 1.69];
/// Initial temperature, K.
pub const ROOM: f64 = 294.0;

/// Steel of the plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Steel {
    Elastic,
    /// Johnson-Cook with thermal softening; loses its shear strength at a plastic strain.
    Yielding,
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub steel: Steel,
    pub flux: Joint,
    pub cracks: CrackOption,
    pub softening: Softening,
    pub plane: Plane,
    /// Requested number of points; points along the notch replace others.
    pub points: u32,
    pub seed: u64,
    /// Projectile speed, m/s: the edge moves at half of it.
    pub speed: f64,
    /// Tensile strength and shear strength, Pa, and fracture energy, J/m^2.
    pub strength: f64,
    pub shear_strength: f64,
    pub energy: f64,
    pub eta: f64,
    pub friction: f64,
    /// Plastic strain at which a yielding steel loses its shear strength: marks a shear band.
    pub collapse: f64,
    /// Width of the notch, m.
    pub gap: f64,
    /// End of the run, s.
    pub end: f64,
    #[serde(skip)]
    pub threads: usize,
}

impl Setup {
    /// Return the label, and name in files.
    pub fn name(&self) -> String {
        let Setup { points, seed, speed, .. } = self;
        let steel = if self.steel == Steel::Yielding { "yielding_" } else { "" };
        let words = format!("{} {} {}", self.flux.name(), self.cracks.words(), self.plane.words());
        format!("{steel}{}_{points}_{seed}_{speed}", words.replace(' ', "_"))
    }

    /// Return the name in tables.
    pub fn words(&self) -> String {
        let (flux, cracks, plane) = (self.flux.name(), self.cracks.words(), self.plane.words());
        let Setup { points, seed, speed, .. } = self;
        match self.steel {
            Steel::Elastic => format!("{flux}, {cracks}, {plane}, {points} points, seed {seed}"),
            Steel::Yielding => format!("yielding, {speed} m/s, {cracks}, {points} points, seed {seed}"),
        }
    }

    /// True if strength and fracture energy are those of the references.
    pub fn is_printed_steel(&self) -> bool {
        self.strength == 1773e6 && (!self.cracks.has_energy() || (self.energy - 22.13e3).abs() < 1.0)
    }

    /// Return the Rayleigh wave speed by Viktorov's fit, as in the paper, m/s.
    pub fn rayleigh(&self) -> f64 {
        let shear = (YOUNG / (2.0 * (1.0 + POISSON) * DENSITY)).sqrt();
        shear * (0.862 + 1.14 * POISSON) / (1.0 + POISSON)
    }

    /// Return the smallest cell width, m.
    pub fn spacing(&self) -> f64 {
        // Number of cells of unit width, by the midpoint rule on small squares.
        const SQUARES: usize = 200;
        let edge = EDGE / SQUARES as f64;
        let place = |k: usize| (k as f64 + 0.5) * edge;
        let squares = (0..SQUARES).flat_map(|i| (0..SQUARES).map(move |j| [place(i), place(j)]));
        let count: f64 = squares.map(|x| (edge / self.grading(x)).powi(2)).sum();
        (count / f64::from(self.points)).sqrt()
    }

    /// Generate random cells, smallest along the expected crack path.
    pub fn cells(&self) -> Result<Cells<2>, CaseError> {
        let refused = |e: fpm::CellsError| CaseError::Other(e.to_string());
        let domain = Domain::cuboid([0.0; 2], [EDGE; 2]).map_err(refused)?;
        let notch = Notch::segment([0.0, HEIGHT], TIP).and_then(|n| n.with_gap(self.gap)).map_err(refused)?;
        let h = self.spacing();
        random_cells(&domain, &notch, self.seed, |x| h * self.grading(x), h)
    }

    /// Return the cell width over the smallest one: dense at the upper right along the crack, as in the paper, or dense ahead of the notch
    /// for a shear band.
    fn grading(&self, [x, y]: [f64; 2]) -> f64 {
        if self.steel == Steel::Yielding {
            let (along, across) =
                ((NOTCH - 0.003 - x).max(x - NOTCH - 0.03).max(0.0), (y - HEIGHT).abs() - 0.004);
            return (1.0 + along.hypot(across.max(0.0)) / 0.006).min(6.0);
        }
        let outside = (NOTCH - 0.005 - x).max(0.0).hypot((HEIGHT - 0.01 - y).max(0.0));
        (1.0 + outside / 0.02).min(2.5)
    }

    fn law(&self) -> Result<Arc<dyn Material<f64>>, CaseError> {
        let moduli = Moduli::young_poisson(YOUNG, POISSON)?;
        match self.steel {
            Steel::Elastic => Ok(self.plane.elastic(LinearElastic::new(DENSITY, moduli)?)),
            Steel::Yielding => {
                let (shear, bulk) = (YOUNG / (2.0 * (1.0 + POISSON)), YOUNG / (3.0 * (1.0 - 2.0 * POISSON)));
                let strength = JohnsonCook::new(shear, YIELD, HARDENING, EXPONENT)?
                    .with_rate(Logarithmic::new(RATE, 1.0)?)
                    .with_heat(Adiabatic::new(HEAT)?);
                let [slope, gruneisen] = SHOCK;
                let pressure = MieGruneisen::new(DENSITY, (bulk / DENSITY).sqrt(), slope, gruneisen)?;
                let collapse = JohnsonCookDamage::new([self.collapse, 0.0, 0.0, 0.0, 0.0], 1.0)?;
                Ok(Solid::new(strength, pressure).with_failure(collapse).into_material())
            }
        }
    }

    /// Build the plate of these cells.
    pub fn torn<'a>(&self, cells: &'a Cells<2>, files: &Files<'a>) -> Result<Torn<'a>, CaseError> {
        let edge = 0.5 * self.speed;
        let strike = move |t: f64| [Some(edge * (t / RAMP).min(1.0)), None];
        Ok(Torn {
            name: self.name(),
            words: self.words(),
            cells,
            law: self.law()?,
            flux: self.flux,
            eta: self.eta,
            criterion: self.cracks.criterion(
                self.strength,
                self.shear_strength,
                self.energy,
                self.softening,
            )?,
            friction: self.friction,
            loads: vec![
                Load::Velocity(|f| f.normal[0] < -0.5 && f.centroid[1] < HEIGHT, Arc::new(strike)),
                Load::Symmetry(1, 0.0),
            ],
            tip: TIP,
            end: self.end,
            threads: self.threads,
            folder: files.folder,
            frames: files.frames,
        })
    }
}

/// Output folder and number of frames.
#[derive(Clone, Copy, Debug)]
pub struct Files<'a> {
    pub folder: &'a std::path::Path,
    pub frames: u32,
}
