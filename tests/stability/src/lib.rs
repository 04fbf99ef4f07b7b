//! Scenes with known failures of methods, and the verdict on every scheme in each.
//!
//! A [`Scene`](verdict::Scene) defines the failure and its cause, the measure, the limit of its criterion, and the expectation
//! for every scheme. All schemes are run, including those expected to fail: a scheme that passes where it should fail is
//! reported like one that fails where it should pass, since the scene may be too weak.
//!
//! | verdict | meaning |
//! |---|---|
//! | `PASS` | the criterion is met, as expected |
//! | `FAIL-EXPECTED` | the criterion is not met, as expected |
//! | `REGRESSION` | the criterion is not met, but should be |
//! | `UNEXPECTED-PASS` | the criterion is met, but should not be |
//!
//! An unexpected row may be noted with its cause; it must then stay so until the note is removed. Tests run the fast set;
//! the binary `verdicts` runs all scenes and writes table and page.
//!
//! Compositions are those of the package `verification`, compiled once there, and a few more here.

pub mod scenes;
pub mod stage;
pub mod verdict;
