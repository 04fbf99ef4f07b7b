//! Constitutive laws for impact, penetration and granular flow.
//!
//! A law lives at one point in three dimensions and knows of no particle, node or element. It maps how the
//! point moves in a step ([`Kinematics`]) and what it remembers ([`State`]) to the new state and the Cauchy
//! stress ([`Constitutive::update`]). Units are SI; stress is tension-positive, pressure compression-positive.

pub mod elastic;
pub mod lane;
pub mod parameter;
pub mod point;
pub mod rate;
pub mod tensor;

pub use elastic::{LinearElastic, Moduli, NeoHookean};
pub use lane::{Lane, Mask, Real, Wide};
pub use parameter::{Check, ParameterError};
pub use point::{
    Breakdown, Constitutive, Fault, Kinematics, Sink, Source, State, Update, lane_of, pointwise, spread,
};
pub use rate::{HughesWinget, Jaumann, ObjectiveRate};
pub use tensor::{Mat3, Sym3};
