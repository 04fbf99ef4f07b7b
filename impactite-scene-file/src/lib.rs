//! Types of Impactite scene files: [`model`], built from [`quantity`] and [`formula`].
//!
//! The crate `impactite-input` builds solvers from them. This crate does not depend on solvers, and is compiled for code size rather than
//! speed: parsing a scene is negligible beside running it.

pub mod expression;
pub mod formula;
pub mod model;
pub mod quantity;
pub mod remedy;
pub mod table;

pub use model::SceneFile;

/// Return the JSON Schema of scene files: editors check and complete TOML with it.
#[must_use]
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(SceneFile)
}

/// Error of reading a scene: the key, and the error of the deserializer with its position.
pub type ReadError = serde_path_to_error::Error<toml_edit::de::Error>;

/// Parse the scene of a document, with its parameters.
///
/// # Errors
/// Unknown keys, values of wrong types, quantities of wrong dimensions.
pub fn read(
    document: toml_edit::Document<&str>,
    parameters: &quantity::Parameters,
) -> Result<SceneFile, ReadError> {
    let mut scene: SceneFile = parameters
        .during(|| serde_path_to_error::deserialize(toml_edit::de::Deserializer::from(document)))?;
    scene.known = parameters.clone();
    Ok(scene)
}
