//! Conformance tests of our own laws, and of broken ones.

#![cfg(feature = "conformance")]
#![allow(missing_docs)]

use mpm_contact::conformance::{Broken, law};
use mpm_contact::vector::{dot, length, sum, times};
use mpm_contact::{
    Adhesion, Contact, ContactLaw, Coulomb, Frictionless, Gradients, Outcome, Penalty, Remembers,
    SlipWeakening, Stick, SurfaceDistance,
};

#[test]
fn laws() -> Result<(), Broken> {
    law(&Frictionless)?;
    for friction in [0.0, 0.1, 2.0] {
        law(&Coulomb::new(friction).expect("law"))?;
    }
    law(&Stick)?;
    for restitution in [1.0, 0.8, 0.1] {
        law(&Penalty::new(300.0, restitution, 0.3).expect("law"))?;
    }
    law(&Adhesion::new(10.0, 5.0, 0.3).expect("law"))?;
    // Slip of 1e-3 m per step: before, within and after weakening.
    for distance in [1e-5, 2e-3, 1.0] {
        law(&SlipWeakening::new(0.6, 0.2, distance).expect("law"))?;
    }
    law(&Spring { stiffness: 1e-3, friction: 0.4 })
}

/// Tangential spring limited by friction (Cundall and Strack): its memory is a vector.
#[derive(Debug)]
struct Spring {
    stiffness: f64,
    friction: f64,
}
impl ContactLaw<f64> for Spring {
    fn springs(&self) -> bool {
        true
    }
    fn remembers(&self) -> Remembers {
        Remembers::SlipAnd(3)
    }
    fn impulse(&self, contact: &Contact<f64>) -> [f64; 3] {
        let push = Penalty::new(300.0, 1.0, 0.0).expect("law").impulse(contact);
        let stretch = [contact.memory[0], contact.memory[1], contact.memory[2]];
        let limit = self.friction * length(push) / (self.stiffness * contact.dt);
        let share = if length(stretch) > limit { limit / length(stretch) } else { 1.0 };
        sum(push, times(stretch, share * self.stiffness * contact.dt))
    }
    fn advance(&self, _: &Contact<f64>, outcome: &Outcome<f64>, memory: &mut [f64]) {
        (0..3).for_each(|d| memory[d] += outcome.slid[d]);
    }
}

/// Broken law that ignores masses.
#[derive(Debug)]
struct Massless;
impl ContactLaw<f64> for Massless {
    fn impulse(&self, contact: &Contact<f64>) -> [f64; 3] {
        contact.normal.map(|n| n * contact.approach().max(0.0))
    }
}
/// Broken law that stops half of the approach.
#[derive(Debug)]
struct Half;
impl ContactLaw<f64> for Half {
    fn impulse(&self, contact: &Contact<f64>) -> [f64; 3] {
        Frictionless.impulse(contact).map(|j| 0.5 * j)
    }
}
/// Broken law with a wrong sign of friction.
#[derive(Debug)]
struct Driving;
impl ContactLaw<f64> for Driving {
    fn impulse(&self, contact: &Contact<f64>) -> [f64; 3] {
        let along = Frictionless.impulse(contact);
        let stuck = Stick.impulse(contact);
        let mut n = 0.0;
        for d in 0..3 {
            n += stuck[d] * contact.normal[d];
        }
        let mut sum = along;
        for d in 0..3 {
            sum[d] -= stuck[d] - n * contact.normal[d];
        }
        sum
    }
}

/// Broken spring that pushes harder at separation.
#[derive(Debug)]
struct Ratchet(Penalty<f64>);
impl ContactLaw<f64> for Ratchet {
    fn springs(&self) -> bool {
        true
    }
    fn impulse(&self, contact: &Contact<f64>) -> [f64; 3] {
        self.0.impulse(contact).map(|j| if contact.approach() < 0.0 { 1.1 * j } else { j })
    }
}

/// Broken law with memory of the slip direction of the first body alone.
#[derive(Debug)]
struct Hardening;
impl ContactLaw<f64> for Hardening {
    fn remembers(&self) -> Remembers {
        Remembers::SlipAnd(1)
    }
    fn impulse(&self, contact: &Contact<f64>) -> [f64; 3] {
        let approach = contact.approach().max(0.0);
        contact.braking(approach, approach * (0.5 + contact.memory[0]).clamp(0.0, 1.0))
    }
    fn advance(&self, _: &Contact<f64>, outcome: &Outcome<f64>, memory: &mut [f64]) {
        memory[0] += dot(outcome.slid, [100.0, 0.0, 0.0]);
    }
}

#[test]
fn the_battery_finds_broken_laws() {
    let spring = Penalty::new(300.0, 1.0, 0.3).expect("law");
    assert_eq!(law(&Ratchet(spring)).expect_err("a ratchet").property, "no energy gained");
    assert_eq!(law(&Massless).expect_err("massless").property, "no energy gained");
    assert_eq!(law(&Half).expect_err("half").property, "no approach left");
    assert_eq!(law(&Driving).expect_err("driving").property, "no energy gained");
    let refused = law(&Hardening).expect_err("memory of one side").property;
    assert_eq!(refused, "symmetry in the bodies");
    // An absurd strength is perfect adhesion, which conserves momentum and takes energy.
    law(&Adhesion::new(1e300, 1e-300, 0.0).expect("law")).expect("adhesion");
}

#[test]
fn bad_numbers_are_refused() {
    let message = Coulomb::new(-0.1).expect_err("negative").to_string();
    assert_eq!(message, "Coulomb friction: coefficient mu = -0.1 is not allowed; it must be not negative");
    assert!(Coulomb::new(f64::NAN).is_err());
    assert!(Adhesion::new(0.0, 1.0, 0.0).is_err());
    assert!(Penalty::new(0.0, 1.0, 0.0).is_err());
    let message = Penalty::new(1.0, 1.5, 0.0).expect_err("too much").to_string();
    assert_eq!(message, "penalty contact: restitution e = 1.5 is not allowed; it must be 0.1 to 1");
    let soft = Penalty::of_cells(0.05, [100.0, 0.1], 0.8, 0.0).expect_err("soft").to_string();
    assert_eq!(soft, "penalty contact: frequency over c / h = 0.05 is not allowed; it must be 0.1 to 2");
    let message = SlipWeakening::new(0.1, 0.2, 1.0).expect_err("rising").to_string();
    let rising = "slip weakening: static coefficient mu_s = 0.1 is not allowed; it must be no less than the kinetic one";
    assert_eq!(message, rising);
    assert!(SlipWeakening::new(0.2, 0.1, 0.0).is_err() && SlipWeakening::new(0.2, f64::NAN, 1.0).is_err());
    assert!(SurfaceDistance::between_centres(Gradients::default(), 0.0).is_err());
    assert!(SurfaceDistance::new(Gradients::default(), f64::NAN).is_err());
}
