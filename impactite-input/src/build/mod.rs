//! Solvers from scene files.

mod common;
pub(crate) mod conditions;
pub(crate) mod describe;
mod fem;
mod flow;
mod fpm;
pub(crate) mod kernels;
mod kinds;
pub(crate) mod liquid;
pub(crate) mod material;
pub(crate) mod mesh;
mod mpm;
mod output;
mod particles;
mod placement;
mod seeds;
pub(crate) mod shape;
pub(crate) mod size;
mod smoothed;
mod solid;
mod stressed;
pub(crate) mod wrong;

use std::path::PathBuf;

use impactite::mpm::{Axisymmetric, FullSpace, PlaneStrain};
use impactite::output::Format;
use impactite::scene::Solver;

use crate::document::Source;
use crate::error::InputError;
use crate::model::method::Method;
use crate::model::output::FrameFormat;
use crate::model::{SceneFile, Space};
use kernels::Setting;
use wrong::{At, Folder, Made, Wrong, wrong};

impl Source {
    /// Build the solver of a scene. The result equals that of a program with the same parts, bit for bit.
    ///
    /// Further files of the scene are relative to its own folder.
    ///
    /// # Errors
    /// Invalid scene, with its key: invalid values, and errors of the solvers.
    pub fn build(&self, scene: &SceneFile) -> Result<Box<dyn Solver>, InputError> {
        let solver = build(scene, &Folder(self.folder())).map_err(|w| self.refused(w))?;
        output::check(scene, &*solver).map_err(|w| self.refused(w))?;
        Ok(solver)
    }

    /// Return the folder of the scene file, to which file names are relative.
    pub(crate) fn folder(&self) -> PathBuf {
        std::path::Path::new(&self.name).parent().map(PathBuf::from).unwrap_or_default()
    }

    /// Return the file format of the frames for ParaView.
    ///
    /// # Errors
    /// VTKHDF without the feature `hdf5`.
    pub fn frame_format(&self, scene: &SceneFile) -> Result<Format, InputError> {
        frame_format(scene).map_err(|w| self.refused(w))
    }

    fn refused(&self, w: Wrong) -> InputError {
        Box::new(self.fault_at(&w.key, w.message, w.help)).into()
    }
}

fn frame_format(scene: &SceneFile) -> Made<Format> {
    match scene.output.format {
        #[cfg(feature = "hdf5")]
        FrameFormat::Vtkhdf => Ok(Format::Hdf),
        #[cfg(not(feature = "hdf5"))]
        FrameFormat::Vtkhdf => wrong(
            "output.format",
            "`vtkhdf` is of programs that were built with the feature `hdf5` (`--features hdf5`), which this one was not; it has `xml`",
        ),
        _ => Ok(Format::Xml),
    }
}

fn build(scene: &SceneFile, folder: &Folder) -> Made<Box<dyn Solver>> {
    if scene.bodies.is_empty() {
        return wrong("bodies", "a scene needs at least one body");
    }
    if scene.end.value <= 0.0 {
        return wrong("end", format!("{} s is not allowed; it must be positive", scene.end.value));
    }
    for (name, spec) in &scene.tables {
        spec.table(&folder.0).at(format!("tables.{name}"))?;
    }
    common::check(scene)?;
    frame_format(scene)?;
    match scene.space {
        Space::Full => checked(&common::World::<3>::new(scene, folder), |world| match &scene.method {
            Method::Fpm(options) => fpm::build(FullSpace, world, options),
            Method::Flow(options) => flow::build(FullSpace, world, options),
            _ => in_space(FullSpace, world),
        }),
        Space::PlaneStrain | Space::PlaneStress => {
            checked(&common::World::<2>::new(scene, folder), |world| match &scene.method {
                Method::Fpm(options) => fpm::build(PlaneStrain, world, options),
                Method::Flow(options) if scene.space == Space::PlaneStrain => {
                    flow::build(PlaneStrain, world, options)
                }
                _ => in_space(PlaneStrain, world),
            })
        }
        Space::Axisymmetric => {
            checked(&common::World::<2>::new(scene, folder), |world| in_space(Axisymmetric, world))
        }
    }
}

/// Build the solver; check the scene's size before and the placement of bodies after.
fn checked<const D: usize>(
    world: &common::World<'_, D>,
    build: impl FnOnce(&common::World<'_, D>) -> Made<Box<dyn Solver>>,
) -> Made<Box<dyn Solver>> {
    world.check()?;
    size::check(world)?;
    let solver = build(world)?;
    placement::check(world, &*solver)?;
    Ok(solver)
}

fn in_space<E: Setting<D>, const D: usize>(
    embedding: E,
    world: &common::World<'_, D>,
) -> Made<Box<dyn Solver>> {
    match &world.scene.method {
        Method::Mpm(options) => mpm::build(embedding, world, options),
        Method::Fem(options) => fem::build(embedding, world, options),
        Method::Sph(options) => particles::sph(embedding, world, options),
        Method::Fpm(_) => wrong("space", "fragile points are of `3d`, `plane strain` or `plane stress`"),
        Method::Pcmm(options) => particles::pcmm(embedding, world, options),
        Method::Flow(_) => wrong("space", "incompressible flow is in `plane strain` or `3d`"),
    }
}
