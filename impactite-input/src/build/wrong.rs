//! Invalid scenes: errors by key, and the folder of scene files.

use std::path::PathBuf;

use impactite::scene::SceneError;
use impactite_scene_file::remedy::in_scene_files;

use crate::hint::near;

/// Error of a scene, at a key.
#[derive(Debug)]
pub(crate) struct Wrong {
    pub key: String,
    pub message: String,
    pub help: Option<String>,
}

pub(crate) type Made<T> = Result<T, Wrong>;

/// Return an error at this key.
pub(crate) fn wrong<T>(key: impl Into<String>, message: impl Into<String>) -> Made<T> {
    Err(Wrong { key: key.into(), message: message.into(), help: None })
}

/// Conversion of errors to scene errors with a key.
pub(crate) trait At<T> {
    /// Attach this key to the error.
    fn at(self, key: impl Into<String>) -> Made<T>;
}
impl<T, E: std::fmt::Display> At<T> for Result<T, E> {
    fn at(self, key: impl Into<String>) -> Made<T> {
        self.map_err(|e| Wrong { key: key.into(), message: in_scene_files(&e.to_string()), help: None })
    }
}

/// Return the index of a name among the existing ones.
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

/// Folder to which the file names of a scene are relative.
#[derive(Clone, Debug, Default)]
pub struct Folder(pub PathBuf);

/// Convert the error of a solver for a body.
pub(super) fn of_body(key: &str, error: SceneError) -> Wrong {
    Wrong { key: key.into(), message: in_scene_files(&error.to_string()), help: None }
}

impl From<SceneError> for Wrong {
    /// Convert the error, with the key of the body that it names.
    fn from(error: SceneError) -> Self {
        let key = match &error {
            SceneError::Outside(name, _) => format!("bodies.{name}"),
            _ => "bodies".into(),
        };
        of_body(&key, error)
    }
}
