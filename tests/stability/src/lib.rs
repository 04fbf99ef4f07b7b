//! Scenes in which methods are known to fail, and the verdict on every scheme in each.
//!
//! A [`Scene`](verdict::Scene) says what goes wrong and why, what is measured, when its criterion holds, and which schemes are
//! expected to meet it. All of them are run, those that must fail too: a scheme that passes where it should fail
//! is reported like one that fails where it should pass, for then the scene may be too weak.
//!
//! | verdict | means |
//! |---|---|
//! | `PASS` | the criterion holds, as expected |
//! | `FAIL-EXPECTED` | it does not, and that is known |
//! | `REGRESSION` | it does not, and should |
//! | `UNEXPECTED-PASS` | it does, and should not |
//!
//! A row that is not as expected may be noted with its cause; then it must stay so until the note is taken back. Tests run
//! the fast set; the binary `verdicts` runs all and writes table and page.
//!
//! Compositions are those of the package `verification`, compiled once, there; a few more are here.

pub mod scenes;
pub mod stage;
pub mod verdict;
