//! What the cases of this crate share: the options every binary understands, the table of checks it prints,
//! and the JSON object it ends with.
//!
//! | binary | case |
//! |---|---|
//! | `taylor_bar` | a copper cylinder hits a wall: final shape against finite elements and experiment |
//! | `pressed_balls` | a loaded plate on a thousand balls: stress waves through contacts, and what contact costs |
//! | `rolling_cylinder` | a cylinder rolls or slides down an incline: way and spin against a rigid one |
//! | `throughput` | particle updates a second on fixed scenes |

pub mod case;

pub use case::{CaseError, Check, Common, Report, Resolution, Totals};
