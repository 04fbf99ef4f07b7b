//! Method selection study: methods recommended in README and alternatives, in scenes with known failures of methods,
//! on three grids.

use std::f64::consts::TAU;

use mpm_contact::{Coulomb, Frictionless, Pairs, SurfaceDistance};
use mpm_core::geometry::{Ball, Compose, Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::{
    Axisymmetric, BlockGrid, Boundary, CpGimp, Flip, FullSpace, GridContact, Linear, Method, Mpm, Musl,
    PlaneStrain, QuadraticBSpline, Rigid, Scalar, Side, TimeControl, Twist, Watch,
};
use mpm_materials::failure::JohnsonCookDamage;
use mpm_materials::{IntoMaterial, J2, LogarithmicBulk, Moduli, NeoHookean, Solid, library};
use verification::Outcome;
use verification::work::{Stopwatch, Work};

use crate::job::Key;

/// Scene of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scene {
    /// Copper bar, 227 m/s.
    Copper,
    /// 4340 steel bar, 270 m/s.
    Steel,
    /// Spinning disc without load.
    Spin,
    /// Block that slides on another with friction, oblique to the grid.
    Slide,
    /// Bullet through a plate, axisymmetric.
    Plate,
    /// Ball on a plate at 5 km/s, three-dimensional.
    Shot,
}

/// Method of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Linear shape functions, FLIP, MUSL.
    Linear,
    /// cpGIMP, FLIP, MUSL.
    CpGimp,
    /// Quadratic B-splines, FLIP, MUSL.
    Quadratic,
    /// `Method::impact`.
    Impact,
    /// `Method::contact_at_rest`.
    AtRest,
}

impl Scene {
    /// All scenes.
    pub const ALL: [Scene; 6] =
        [Scene::Copper, Scene::Steel, Scene::Spin, Scene::Slide, Scene::Plate, Scene::Shot];
    /// Name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Scene::Copper => "copper bar 227",
            Scene::Steel => "steel bar 270",
            Scene::Spin => "spinning disc 200",
            Scene::Slide => "sliding block",
            Scene::Plate => "plate 400",
            Scene::Shot => "shot 5000",
        }
    }
    /// Resolutions: cells of the radius of the moving body, or of half the height of the sliding block.
    pub const fn grids(self) -> [usize; 3] {
        match self {
            Scene::Copper | Scene::Steel => [8, 16, 32],
            Scene::Spin => [5, 10, 20],
            Scene::Slide => [2, 4, 8],
            Scene::Plate => [4, 8, 16],
            Scene::Shot => [4, 8, 12],
        }
    }
    const fn dimension(self) -> u32 {
        if matches!(self, Scene::Shot) { 3 } else { 2 }
    }
}

impl Way {
    /// All methods.
    pub const ALL: [Way; 5] = [Way::Linear, Way::CpGimp, Way::Quadratic, Way::Impact, Way::AtRest];
    const fn name(self) -> &'static str {
        match self {
            Way::Linear => "linear FLIP-MUSL",
            Way::CpGimp => "cpGIMP FLIP-MUSL",
            Way::Quadratic => "quadratic FLIP-MUSL",
            Way::Impact => "quadratic AFLIP",
            Way::AtRest => "quadratic APIC",
        }
    }
    fn nodes(self, dimension: u32) -> u64 {
        if self == Way::Linear { 2u64.pow(dimension) } else { 3u64.pow(dimension) }
    }
}

macro_rules! kernels {
    ($way:expr, $space:expr) => {
        match $way {
            Way::Linear => mpm_core::IntoKernels::into_kernels(Method::new(Linear, Flip, Musl, $space)),
            Way::CpGimp => mpm_core::IntoKernels::into_kernels(Method::new(CpGimp, Flip, Musl, $space)),
            Way::Quadratic => {
                mpm_core::IntoKernels::into_kernels(Method::new(QuadraticBSpline, Flip, Musl, $space))
            }
            Way::Impact => mpm_core::IntoKernels::into_kernels(Method::impact($space)),
            Way::AtRest => mpm_core::IntoKernels::into_kernels(Method::contact_at_rest($space)),
        }
    };
}

/// Scene, method and grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Study {
    /// Scene to run.
    pub scene: Scene,
    /// Method to run it by.
    pub way: Way,
    /// Number of cells along the length of the scene.
    pub cells: usize,
}

type Made<X> = Result<X, String>;

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

impl Study {
    /// List all runs of a scene, coarse first.
    pub fn all(scene: Scene) -> Vec<Study> {
        let of = |cells| Way::ALL.map(|way| Study { scene, way, cells });
        scene.grids().into_iter().flat_map(of).collect()
    }

    /// Key of the run.
    pub fn key(self) -> Key {
        let control = kernels!(self.way, PlaneStrain).facts().time_control();
        let TimeControl::Courant { factor, .. } = control else { unreachable!("the default of all methods") };
        let (problem, scheme) = (self.scene.name().into(), self.way.name().into());
        Key { problem, scheme, per_axis: 2, cells: self.cells, courant: factor }
    }

    /// Find the run of a key.
    pub fn of(key: &Key) -> Option<Study> {
        let scene = Scene::ALL.into_iter().find(|s| s.name() == key.problem)?;
        let ways = Way::ALL.map(|way| Study { scene, way, cells: key.cells });
        ways.into_iter().find(|s| s.key() == *key)
    }

    /// Scale the run down to the smallest grid.
    pub fn scaled(self) -> Study {
        Study { cells: self.scene.grids()[0], ..self }
    }

    /// Run the scene with default time control and default contact; the watch only warns.
    pub fn run(self) -> Outcome {
        let made = match self.scene {
            Scene::Copper => self.bar([3.2e-3, 32.4e-3], 227.0, 80e-6, [21.42e-3, 7.226e-3], copper()),
            // Reference radii of two sources differ by 1 %: 12.76 and 12.90 mm of diameter.
            Scene::Steel => {
                let law = Ok(library::steel_4340());
                self.bar([3.7975e-3, 37.97e-3], 270.0, 70e-6, [31.185e-3, 6.415e-3], law)
            }
            Scene::Spin => self.spin(),
            Scene::Slide => self.slide(),
            Scene::Plate => self.plate(),
            Scene::Shot => self.shot(),
        };
        made.unwrap_or_else(|why| Outcome { failure: Some(why), ..Outcome::default() })
    }

    fn outcome<const D: usize>(
        self,
        mut mpm: Mpm<D>,
        end: f64,
        judge: impl FnOnce(&Mpm<D>) -> Vec<(&'static str, f64)>,
    ) -> Outcome
    where
        f64: Scalar<D>,
    {
        mpm.set_watch(Watch::default().only_warn());
        let particles = mpm.particles() as u64;
        let watch = Stopwatch::start();
        let made = mpm.run_until(end);
        let work = Work {
            particles,
            steps: mpm.steps(),
            nodes: self.way.nodes(self.scene.dimension()),
            seconds: watch.seconds(),
            bytes: mpm.bytes() as u64,
        };
        match made {
            Ok(()) => Outcome { measures: judge(&mpm), work, failure: None },
            Err(error) => Outcome { measures: Vec::new(), work, failure: Some(error.to_string()) },
        }
    }

    /// Run a bar, `[radius, length]` m, on a frictionless wall, against the final `[length, radius of the foot]`,
    /// m.
    fn bar(
        self,
        [radius, length]: [f64; 2],
        speed: f64,
        end: f64,
        reference: [f64; 2],
        law: Made<impl IntoMaterial<f64>>,
    ) -> Made<Outcome> {
        let h = radius / self.cells as f64;
        let lattice = Lattice::new([0.0; 2], h).map_err(text)?;
        let bar = Cuboid::new([0.0; 2], [radius, length]).map_err(text)?;
        let seeds = fill(&bar, &lattice, 2, &Filling::new().axisymmetric()).map_err(text)?;
        let mut mpm = Mpm::new(kernels!(self.way, Axisymmetric), BlockGrid::new(lattice));
        mpm.add("bar", law?, &seeds, |_| [0.0, -speed]).map_err(text)?;
        for axis in 0..2 {
            mpm.bound(Boundary::Symmetry { axis, at: 0.0, side: Side::Above }).map_err(text)?;
        }
        Ok(self.outcome(mpm, end, |mpm| {
            let (mut top, mut foot) = (0.0f64, 0.0f64);
            // Bar ends: half a particle beyond the outermost one, with the local stretch: none at the rear, that of the radius at the
            // foot.
            mpm.bodies()[0].for_each(&mut |p| {
                top = top.max(p.position[1] + 0.25 * h);
                foot = foot.max(p.position[0] / (1.0 - 0.25 / self.cells as f64));
            });
            vec![
                ("length", top / reference[0] - 1.0),
                ("foot", foot / reference[1] - 1.0),
                ("energy", mpm.account().energy_error()),
            ]
        }))
    }

    /// Run a steel disc of 0.1 m with a rim speed of 200 m/s for two turns.
    fn spin(self) -> Made<Outcome> {
        let radius = 0.1;
        let lattice = Lattice::new([0.003, -0.002], radius / self.cells as f64).map_err(text)?;
        let disc = Ball::new([0.0; 2], radius).map_err(text)?;
        let seeds = fill(&disc, &lattice, 2, &Filling::new()).map_err(text)?;
        let mut mpm = Mpm::new(kernels!(self.way, PlaneStrain), BlockGrid::new(lattice));
        let spin = 200.0 / radius;
        mpm.add("disc", library::steel_4340(), &seeds, |x| [-spin * x[1], spin * x[0]]).map_err(text)?;
        let start = mpm.totals();
        Ok(self.outcome(mpm, 2.0 * TAU / spin, |mpm| {
            let turned = mpm.totals().angular_momentum[2] / start.angular_momentum[2] - 1.0;
            vec![("energy", mpm.account().energy_error()), ("angular momentum", turned)]
        }))
    }

    /// Run a block of 0.4 x 0.2 m on a rigid floor, both at 23 degrees to the grid, 2 m/s, friction 0.2 under 10 m/s^2: the exact
    /// speed after 0.3 s is 1.4 m/s.
    fn slide(self) -> Made<Outcome> {
        let h = 0.1 / self.cells as f64;
        let lattice = Lattice::new([0.0; 2], h).map_err(text)?;
        let angle = 23.0f64.to_radians();
        let (sin, cos) = angle.sin_cos();
        let oblique = |low: [f64; 2], high: [f64; 2]| -> Made<Seeds<2>> {
            let shape = Cuboid::new(low, high).map_err(text)?;
            let turned = shape.rotated(nalgebra::Rotation2::new(angle), [0.0; 2]).map_err(text)?;
            let shape = turned.translated([0.013, 0.007]).map_err(text)?;
            fill(&shape, &lattice, 2, &Filling::new()).map_err(text)
        };
        let rubber = NeoHookean::new(1000.0, Moduli::young_poisson(1e7, 0.3).map_err(text)?).map_err(text)?;
        let friction = Pairs::new(Coulomb::new(0.2).map_err(text)?);
        let contact = GridContact::new(SurfaceDistance::default(), friction);
        let mut mpm = Mpm::with_contact(kernels!(self.way, PlaneStrain), BlockGrid::new(lattice), contact);
        mpm.add("block", rubber, &oblique([0.0, 0.0], [0.4, 0.2])?, |_| [2.0 * cos, 2.0 * sin])
            .map_err(text)?;
        let still = Rigid::prescribed(1000.0, |_| Twist::along([0.0; 2])).map_err(text)?;
        mpm.add_rigid("floor", &still, &oblique([-0.3, -0.3], [1.3, 0.0])?).map_err(text)?;
        mpm.set_body_force(move |_| [10.0 * sin, -10.0 * cos]);
        Ok(self.outcome(mpm, 0.3, |mpm| {
            let block = mpm.bodies()[0].totals();
            let [x, y, _] = block.momentum.map(|p| p / block.mass);
            let [along, off] = [cos * x + sin * y, cos * y - sin * x];
            vec![("speed", along / 1.4 - 1.0), ("lift", off / 2.0)]
        }))
    }

    /// Run a steel bullet, radius 5 mm and length 30 mm, at 400 m/s through 6 mm of aluminium.
    fn plate(self) -> Made<Outcome> {
        let radius = 5e-3;
        let h = radius / self.cells as f64;
        let lattice = Lattice::new([0.0; 2], h).map_err(text)?;
        let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Frictionless));
        let mut mpm = Mpm::with_contact(kernels!(self.way, Axisymmetric), BlockGrid::new(lattice), contact);
        let filling = Filling::new().axisymmetric();
        let seeds = |low: [f64; 2], high: [f64; 2]| -> Made<Seeds<2>> {
            fill(&Cuboid::new(low, high).map_err(text)?, &lattice, 2, &filling).map_err(text)
        };
        mpm.add("bullet", library::steel_4340(), &seeds([0.0, 0.0], [radius, 30e-3])?, |_| [0.0, -400.0])
            .map_err(text)?;
        let aluminium = library::aluminium_6061_t6().with_failure(JohnsonCookDamage::aluminium_6061());
        mpm.add("plate", aluminium, &seeds([0.0, -6e-3], [40e-3, 0.0])?, |_| [0.0; 2]).map_err(text)?;
        mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).map_err(text)?;
        Ok(self.outcome(mpm, 80e-6, |mpm| {
            let bullet = mpm.bodies()[0].totals();
            vec![
                ("energy", mpm.account().energy_error()),
                ("speed", -bullet.momentum[1] / bullet.mass / 400.0),
            ]
        }))
    }

    /// Run an aluminium ball of 2 mm radius (quarter model) on 2 mm of aluminium at 5 km/s.
    fn shot(self) -> Made<Outcome> {
        let r = 2e-3;
        let lattice = Lattice::new([0.0; 3], r / self.cells as f64).map_err(text)?;
        let quarter = Cuboid::new([0.0; 3], [r, r, 2.0 * r]).map_err(text)?;
        let ball = Ball::new([0.0, 0.0, r], r).map_err(text)?.and(quarter);
        let plate = Cuboid::new([0.0, 0.0, -2e-3], [7e-3, 7e-3, 0.0]).map_err(text)?;
        let law = || library::aluminium_6061_t6().with_bulk_viscosity(0.06, 1.5).map_err(text);
        let mut mpm = Mpm::new(kernels!(self.way, FullSpace), BlockGrid::new(lattice));
        let filling = Filling::new();
        let seeds = fill(&ball, &lattice, 2, &filling).map_err(text)?;
        mpm.add("ball", law()?, &seeds, |_| [0.0, 0.0, -5e3]).map_err(text)?;
        let seeds = fill(&plate, &lattice, 2, &filling).map_err(text)?;
        mpm.add("plate", law()?, &seeds, |_| [0.0; 3]).map_err(text)?;
        for axis in 0..2 {
            mpm.bound(Boundary::Symmetry { axis, at: 0.0, side: Side::Above }).map_err(text)?;
        }
        Ok(self.outcome(mpm, 12e-3 / 5e3, |mpm| vec![("energy", mpm.account().energy_error())]))
    }
}

fn copper() -> Made<impl IntoMaterial<f64>> {
    let moduli = Moduli::young_poisson(117e9, 0.35).map_err(text)?;
    let strength = J2::linear(moduli.shear, 400e6, 100e6).map_err(text)?;
    Ok(Solid::new(strength, LogarithmicBulk::new(8930.0, moduli.bulk).map_err(text)?))
}
