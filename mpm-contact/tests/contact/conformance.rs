//! The batteries for our own laws and detectors, and for broken ones.

use mpm_contact::conformance::{Broken, FRICTION, detector, detector_and_law, law};
use mpm_contact::{
    Adhesion, Approach, Choice, Compression, Contact, ContactLaw, Coulomb, Frictionless, Gradients, Penalty,
    Regression, Stick, SurfaceDistance, Weight,
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
    law(&Adhesion::new(10.0, 5.0, 0.3).expect("law"))
}

#[test]
fn detectors() -> Result<(), Broken> {
    detector(SurfaceDistance::default)?;
    detector(|| SurfaceDistance::default().locally())?;
    detector(Approach::<Gradients>::default)?;
    detector(Compression::<Gradients>::default)?;
    detector(|| Regression)?;
    detector(|| SurfaceDistance::new(Regression, 0.1).expect("detector"))?;
    detector(|| Approach(Gradients::new(Weight::Volume, Choice::Difference)))?;
    // Along gradients gaps are cells off at the rims, where a particle that lies on a cell's face decides: nothing that
    // a spring should follow.
    detector_and_law(|| Regression, &Penalty::new(500.0, 0.8, FRICTION).expect("law"))
}

/// A spring instead of a law: it ignores masses.
#[derive(Debug)]
struct Spring;
impl ContactLaw<f64> for Spring {
    fn impulse(&self, contact: &Contact<f64>, _: [f64; 2], [v, w]: [[f64; 3]; 2], _: f64) -> [f64; 3] {
        let mut approach = 0.0;
        for d in 0..3 {
            approach += (v[d] - w[d]) * contact.normal[d];
        }
        contact.normal.map(|n| n * approach.max(0.0))
    }
}
/// Stops half of the approach.
#[derive(Debug)]
struct Half;
impl ContactLaw<f64> for Half {
    fn impulse(&self, contact: &Contact<f64>, m: [f64; 2], v: [[f64; 3]; 2], dt: f64) -> [f64; 3] {
        Frictionless.impulse(contact, m, v, dt).map(|j| 0.5 * j)
    }
}
/// Half friction, half forgotten sign.
#[derive(Debug)]
struct Driving;
impl ContactLaw<f64> for Driving {
    fn impulse(&self, contact: &Contact<f64>, m: [f64; 2], v: [[f64; 3]; 2], dt: f64) -> [f64; 3] {
        let along = Frictionless.impulse(contact, m, v, dt);
        let stuck = Stick.impulse(contact, m, v, dt);
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

/// A spring that pushes harder on the way back.
#[derive(Debug)]
struct Ratchet(Penalty<f64>);
impl ContactLaw<f64> for Ratchet {
    fn springs(&self) -> bool {
        true
    }
    fn impulse(&self, contact: &Contact<f64>, m: [f64; 2], v: [[f64; 3]; 2], dt: f64) -> [f64; 3] {
        let closing: f64 = (0..3).map(|d| (v[0][d] - v[1][d]) * contact.normal[d]).sum();
        self.0.impulse(contact, m, v, dt).map(|j| if closing < 0.0 { 1.1 * j } else { j })
    }
}

#[test]
fn the_battery_finds_broken_laws() {
    let spring = Penalty::new(300.0, 1.0, 0.3).expect("law");
    assert_eq!(law(&Ratchet(spring)).expect_err("a ratchet").property, "no energy gained");
    assert_eq!(law(&Spring).expect_err("a spring").property, "no energy gained");
    assert_eq!(law(&Half).expect_err("half").property, "no approach left");
    assert_eq!(law(&Driving).expect_err("driving").property, "no energy gained");
    // An absurd strength is glue, which conserves momentum and takes energy.
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
    assert!(SurfaceDistance::between_centres(Gradients::default(), 0.0).is_err());
    assert!(SurfaceDistance::new(Gradients::default(), f64::NAN).is_err());
}
