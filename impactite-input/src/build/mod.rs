//! Scenes from files.

mod common;
pub(crate) mod describe;
mod fem;
mod fpm;
mod kernels;
mod material;
mod mesh;
mod mpm;
mod output;
mod particles;
mod shape;
mod wrong;

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
use wrong::{Folder, Made, Wrong, wrong};

impl Source {
    /// The scene, ready to run: as a program would set it up with the same parts, bit for bit.
    ///
    /// Files that it names are beside the scene's own.
    ///
    /// # Errors
    /// What is wrong with it, at its place: what the scene is made of, and what a program would be refused for.
    pub fn build(&self, scene: &SceneFile) -> Result<Box<dyn Solver>, InputError> {
        let folder = std::path::Path::new(&self.name).parent().map(PathBuf::from).unwrap_or_default();
        let solver = build(scene, &Folder(folder)).map_err(|w| self.refused(w))?;
        output::check(scene, &*solver).map_err(|w| self.refused(w))?;
        Ok(solver)
    }

    /// What files the frames for ParaView are to be.
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
    common::check(scene)?;
    frame_format(scene)?;
    if let Method::Fpm(options) = &scene.method {
        match scene.space {
            Space::Full => return fpm::build(FullSpace, &common::World::<3>::new(scene, folder), options),
            Space::PlaneStrain | Space::PlaneStress => {
                return fpm::build(PlaneStrain, &common::World::<2>::new(scene, folder), options);
            }
            Space::Axisymmetric => {}
        }
    }
    match scene.space {
        Space::Full => in_space(FullSpace, scene, folder),
        Space::PlaneStrain | Space::PlaneStress => in_space(PlaneStrain, scene, folder),
        Space::Axisymmetric => in_space(Axisymmetric, scene, folder),
    }
}

fn in_space<E: Setting<D>, const D: usize>(
    embedding: E,
    scene: &SceneFile,
    folder: &Folder,
) -> Made<Box<dyn Solver>> {
    let world = common::World::<D>::new(scene, folder);
    match &scene.method {
        Method::Mpm(options) => mpm::build(embedding, &world, options),
        Method::Fem(options) => fem::build(embedding, &world, options),
        Method::Sph(options) => particles::sph(embedding, &world, options),
        Method::Fpm(_) => wrong("space", "fragile points are of `3d`, `plane strain` or `plane stress`"),
        Method::Pcmm(options) => particles::pcmm(embedding, &world, options),
    }
}
