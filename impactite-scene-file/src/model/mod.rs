//! Types of a scene file. Every key is checked on reading; the [schema](crate::schema) is generated from these types.

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
