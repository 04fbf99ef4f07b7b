//! Conformance tests for the detectors of the library, and for a custom one that checks pairs one by one.

use mpm_contact::{
    Approach, Choice, Compression, ContactDetector, Coulomb, Criterion, Gradients, Pairs, Penalty,
    Regression, SurfaceDistance, Weight, conformance::FRICTION,
};
use mpm_contact::{EachPair, PairDetector, SlipWeakening, SurfacePair};
use mpm_core::GridContact;
use mpm_core::conformance::{Broken, detector, detector_and_law};

use crate::common::{WAVE, build, particles, plane, three};

/// Detector of surfaces that overlap, or will in the step.
#[derive(Clone, Debug)]
struct Foreseen(f64);
impl PairDetector for Foreseen {
    fn touches(&self, pair: &SurfacePair) -> bool {
        pair.gap() - pair.approach() * self.0 <= 0.0
    }
}

/// Equivalent of the default detector, pair by pair.
#[derive(Clone, Debug)]
struct Overlap;
impl PairDetector for Overlap {
    fn touches(&self, pair: &SurfacePair) -> bool {
        assert!(pair.bodies[0] < pair.bodies[1] && pair.masses.iter().all(|&m| m > 0.0));
        pair.gap() <= 0.0
    }
    fn criterion(&self, _spacing: f64) -> Criterion {
        Criterion::Gap(0.0)
    }
}

#[test]
fn detectors_of_pairs() -> Result<(), Broken> {
    detector(|| EachPair::new(Foreseen(2.5e-4)))?;
    detector(|| EachPair::new(Overlap).with_normals(Gradients::default()))?;
    detector_and_law(|| EachPair::new(Overlap), &SlipWeakening::new(FRICTION, 0.1, 1e-3).expect("law"))
}

/// The batched detector is equivalent, bit for bit.
#[test]
fn a_detector_of_pairs_is_the_batched_one() {
    fn run(detector: impl ContactDetector<f64, 2>) -> Vec<Vec<mpm_core::PointView>> {
        let laws = Pairs::new(Coulomb::new(0.3).expect("law"));
        let mut mpm = build(plane(), GridContact::new(detector, laws), &three(0.05 * WAVE));
        (0..120).for_each(|_| assert!(mpm.step().is_ok()));
        assert_eq!(mpm.contacts().len(), 3);
        particles(&mpm)
    }
    assert!(run(EachPair::new(Overlap)) == run(SurfaceDistance::default()));
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
    // Gaps along gradients are cells off at the rims, where a particle on the face of a cell decides: springs should
    // not follow them.
    detector_and_law(|| Regression, &Penalty::new(500.0, 0.8, FRICTION).expect("law"))
}
