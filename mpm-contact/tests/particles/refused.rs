//! Invalid scenes.

use mpm_contact::conformance::Balls;
use mpm_contact::{Frictionless, SlipWeakening};

use crate::{block, scene};

#[test]
fn scenes_that_cannot_be_are_refused_by_name() {
    let message = scene::<2>(Frictionless).run_until(1.0).unwrap_err().to_string();
    assert!(message.contains("bod"), "{message}");

    let mut remembers = scene(SlipWeakening::new(0.5, 0.2, 1.0e-3).unwrap());
    remembers.add("block", block([0.0, 0.0], [2, 2]));
    let message = remembers.run_until(1.0).unwrap_err().to_string();
    assert!(message.contains("a contact law that remembers is not allowed"), "{message}");

    let mut both = scene(Frictionless);
    both.add("plane", block([0.0, 0.0], [2, 2]));
    both.add("round", Balls::new(vec![[1.0, 1.0]], 0.1, 1.0).around_an_axis());
    let message = both.run_until(1.0).unwrap_err().to_string();
    assert!(message.contains("beside `plane` in the plane") && message.contains("per radian"), "{message}");
    assert_eq!(both.steps(), 0);

    for (radius, mass) in [(0.0, 1.0), (f64::NAN, 1.0), (1.0, 0.0), (1.0, f64::INFINITY)] {
        let mut empty = scene(Frictionless);
        empty.add("good", Balls::new(vec![[1.0, 1.0]], 0.1, 1.0));
        empty.add("bad", Balls::new(vec![[5.0, 1.0]], radius, mass));
        let message = empty.run_until(1.0).unwrap_err().to_string();
        let named = format!("particle 0 of body `bad` at [5.0, 1.0] m with a mass of {mass} kg");
        assert!(message.contains(&named) && message.contains("positive and finite"), "{message}");
    }
}
