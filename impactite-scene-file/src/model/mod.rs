//! What a scene file holds, as types. Every key is checked where it is read; the [schema](crate::schema) is generated from these types.

pub mod body;
pub mod condition;
pub mod contact;
pub mod material;
pub mod measure;
pub mod method;
pub mod output;
pub mod over_time;
mod parts;
mod scene;
mod several;
pub mod shape;
mod space;

pub use scene::{Parameter, SceneFile};
pub use several::Several;
pub use space::{Axis, Space, Vector, fixed, formulas};
