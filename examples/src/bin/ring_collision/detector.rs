//! A detector that is chosen at run time, so that the step is compiled once for all of them.

use examples::CaseError;
use mpm_contact::{
    Approach, ContactDetector, Gradients, Memory, Nodal, NormalRule, Regression, SurfaceDistance,
};
use mpm_core::step::contact::SharedNodes;

use crate::setup::Detection;

/// A test of contact, with the normals that belong to it.
pub struct Chosen {
    test: Test,
    normals: Normals,
}

enum Test {
    Velocity(Approach<Gradients>),
    Distance(SurfaceDistance<Gradients>),
    Regression,
}

/// Its normals.
pub enum Normals {
    Gradients(Gradients),
    Regression,
}

impl Detection {
    /// The detector of this name.
    pub fn detector(self) -> Result<Chosen, CaseError> {
        let gradients = Gradients::default;
        let (test, normals) = match self {
            Detection::Velocity => (Test::Velocity(Approach::default()), Normals::Gradients(gradients())),
            Detection::Distance => {
                (Test::Distance(SurfaceDistance::new(gradients(), 0.0)?), Normals::Gradients(gradients()))
            }
            Detection::Centres => (
                Test::Distance(SurfaceDistance::between_centres(gradients(), 0.5)?),
                Normals::Gradients(gradients()),
            ),
            Detection::Regression => (Test::Regression, Normals::Regression),
        };
        Ok(Chosen { test, normals })
    }
}

impl NormalRule<f64, 2> for Normals {
    fn prepare(&self, at: &SharedNodes<'_, f64, 2>, memory: &mut Memory<'_, f64>) {
        match self {
            Normals::Gradients(rule) => rule.prepare(at, memory),
            Normals::Regression => Regression.prepare(at, memory),
        }
    }
    fn normals(
        &self,
        at: &SharedNodes<'_, f64, 2>,
        pair: [usize; 2],
        nodes: u64,
        memory: &Memory<'_, f64>,
        normals: &mut Nodal<[f64; 3]>,
    ) -> u64 {
        match self {
            Normals::Gradients(rule) => rule.normals(at, pair, nodes, memory, normals),
            Normals::Regression => NormalRule::normals(&Regression, at, pair, nodes, memory, normals),
        }
    }
}

impl ContactDetector<f64, 2> for Chosen {
    type Normals = Normals;
    fn normals(&self) -> &Normals {
        &self.normals
    }
    fn touching(
        &self,
        at: &SharedNodes<'_, f64, 2>,
        pair: [usize; 2],
        nodes: u64,
        normals: &Nodal<[f64; 3]>,
        gaps: &mut Nodal<Option<f64>>,
    ) -> u64 {
        match &self.test {
            Test::Velocity(test) => test.touching(at, pair, nodes, normals, gaps),
            Test::Distance(test) => test.touching(at, pair, nodes, normals, gaps),
            Test::Regression => Regression.touching(at, pair, nodes, normals, gaps),
        }
    }
}
