//! Scenes from files.

mod common;
mod fem;
mod fpm;
mod material;
mod mesh;
mod mpm;
mod particles;
mod shape;

use std::path::PathBuf;

use impactite::mpm::{Axisymmetric, FullSpace, PlaneStrain};
use impactite::scene::Solver;

use crate::document::{Source, near};
use crate::error::InputError;
use crate::model::method::Method;
use crate::model::{SceneFile, Space};
use common::Setting;
pub(crate) use common::describe;

/// What is wrong with a scene, at a key.
#[derive(Debug)]
pub(crate) struct Wrong {
    key: String,
    message: String,
    help: Option<String>,
}

pub(crate) type Made<T> = Result<T, Wrong>;

/// What is wrong, at this key.
pub(crate) fn wrong<T>(key: impl Into<String>, message: impl Into<String>) -> Made<T> {
    Err(Wrong { key: key.into(), message: message.into(), help: None })
}

/// Errors with their key.
pub(crate) trait At<T> {
    /// At this key.
    fn at(self, key: impl Into<String>) -> Made<T>;
}
impl<T, E: std::fmt::Display> At<T> for Result<T, E> {
    fn at(self, key: impl Into<String>) -> Made<T> {
        self.map_err(|e| Wrong { key: key.into(), message: e.to_string(), help: None })
    }
}

/// The name that a key holds, among those there are.
pub(crate) fn known<'a>(
    key: &str,
    what: &str,
    name: &str,
    names: impl IntoIterator<Item = &'a str>,
) -> Made<usize> {
    let names: Vec<&str> = names.into_iter().collect();
    if let Some(place) = names.iter().position(|n| *n == name) {
        return Ok(place);
    }
    let help = near(name, names.iter().copied()).map(|n| format!("did you mean `{n}`?"));
    let there =
        if names.is_empty() { "there is none".into() } else { format!("there are {}", names.join(", ")) };
    Err(Wrong { key: key.into(), message: format!("no {what} has the name `{name}`; {there}"), help })
}

/// Where files that a scene names are.
#[derive(Clone, Debug, Default)]
pub struct Folder(pub PathBuf);

impl Source {
    /// The scene, ready to run: as a program would set it up with the same parts, bit for bit.
    ///
    /// Files that it names are beside the scene's own.
    ///
    /// # Errors
    /// What is wrong with it, at its place: what the scene is made of, and what a program would be refused for.
    pub fn build(&self, scene: &SceneFile) -> Result<Box<dyn Solver>, InputError> {
        let folder = std::path::Path::new(&self.name).parent().map(PathBuf::from).unwrap_or_default();
        build(scene, &Folder(folder)).map_err(|w| Box::new(self.fault_at(&w.key, w.message, w.help)).into())
    }
}

fn build(scene: &SceneFile, folder: &Folder) -> Made<Box<dyn Solver>> {
    if scene.bodies.is_empty() {
        return wrong("bodies", "a scene needs at least one body");
    }
    if !(scene.end.value > 0.0) {
        return wrong("end", format!("{} s is not allowed; it must be positive", scene.end.value));
    }
    common::check(scene)?;
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
        Method::Fpm(options) => E::fpm(embedding, &world, options),
        Method::Pcmm(options) => particles::pcmm(embedding, &world, options),
    }
}
