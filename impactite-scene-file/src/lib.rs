//! What scene files of Impactite hold: [`model`], of [`quantity`] and [`formula`].
//!
//! The crate `impactite-input` makes solvers of it. This one knows none, and is compiled for size of code rather than for speed: reading a
//! scene is no work beside running it.

pub mod formula;
pub mod model;
pub mod quantity;
pub mod remedy;
pub mod table;

pub use model::SceneFile;

/// The JSON Schema of scene files: editors that know TOML check and complete by it.
#[must_use]
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(SceneFile)
}

/// A scene that cannot be read: the key, and the error of the deserializer, which knows the place.
pub type ReadError = serde_path_to_error::Error<toml_edit::de::Error>;

/// The scene of a document, with its parameters.
///
/// # Errors
/// Keys that there are not, values of other kinds, quantities of other measures.
pub fn read(
    document: toml_edit::Document<&str>,
    parameters: &quantity::Parameters,
) -> Result<SceneFile, ReadError> {
    let mut scene: SceneFile = parameters
        .during(|| serde_path_to_error::deserialize(toml_edit::de::Deserializer::from(document)))?;
    scene.known = parameters.clone();
    Ok(scene)
}
