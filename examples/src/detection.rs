//! Contact detector selected at run time, so that a step is compiled once for all detectors.

use clap::ValueEnum;
use mpm_contact::{
    Compression, ContactDetector, Criterion, Gradients, Memory, Nodal, NormalRule, Places, Regression,
    SeparatingPlane, SurfaceDistance,
};
use serde::Serialize;

use crate::CaseError;

/// How contact is detected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Detection {
    /// The default of the library: the distance along the line through the node, normals of the separating plane
    Plane,
    /// Where bodies share a node and approach: the old test
    Approach,
    /// Where they approach and the traction between them is compressive
    Compression,
    /// Where they approach and their surfaces meet: particle half sizes, threshold zero
    Distance,
    /// The same from particle centres, closer than half a cell
    Centres,
    /// The distance along the line through the node
    Local,
    /// The distance along normals by logistic regression
    Regression,
    /// The same along the line through the node
    LocalRegression,
}

impl Detection {
    /// Name on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |v| v.get_name().to_string())
    }

    /// Return the detector of this option, with the normals that it prescribes, otherwise by `gradients`.
    ///
    /// # Errors
    /// None at present: all these settings are valid.
    pub fn detector(self, gradients: Gradients) -> Result<Detector, CaseError> {
        let gradients = Normals::Gradients(gradients);
        let distance = match self {
            Detection::Approach | Detection::Compression | Detection::Distance => {
                SurfaceDistance::new(gradients, 0.0)?
            }
            Detection::Plane => SurfaceDistance::new(Normals::Plane, 0.0)?.locally(),
            Detection::Centres => SurfaceDistance::between_centres(gradients, 0.5)?,
            Detection::Local => SurfaceDistance::new(gradients, 0.0)?.locally(),
            Detection::Regression => SurfaceDistance::new(Normals::Regression, 0.0)?,
            Detection::LocalRegression => SurfaceDistance::new(Normals::Regression, 0.0)?.locally(),
        };
        Ok(match self {
            Detection::Approach => Detector { test: Test::Approach, distance },
            Detection::Compression => Detector { test: Test::Compression(Compression::default()), distance },
            _ => Detector { test: Test::Distance, distance },
        })
    }
}

/// Contact detector of a [`Detection`].
#[derive(Debug)]
pub struct Detector {
    test: Test,
    distance: SurfaceDistance<Normals>,
}

#[derive(Debug)]
enum Test {
    Approach,
    Compression(Compression<Gradients>),
    Distance,
}

impl<const D: usize> ContactDetector<f64, D> for Detector {
    type Normals = Normals;
    fn criterion(&self, spacing: f64) -> Criterion {
        match self.test {
            Test::Approach => Criterion::Always,
            Test::Compression(_) => Criterion::State,
            Test::Distance => ContactDetector::<f64, D>::criterion(&self.distance, spacing),
        }
    }
    fn normals(&self) -> &Normals {
        ContactDetector::<f64, D>::normals(&self.distance)
    }
    fn touching(
        &self,
        at: &dyn Places<f64, D>,
        pair: [usize; 2],
        nodes: u64,
        normals: &Nodal<[f64; 3]>,
        gaps: &mut Nodal<Option<f64>>,
    ) -> u64 {
        match &self.test {
            Test::Approach => nodes,
            Test::Compression(traction) => traction.touching(at, pair, nodes, normals, gaps),
            Test::Distance => self.distance.touching(at, pair, nodes, normals, gaps),
        }
    }
}

/// Rule for the contact normal between two bodies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Normals {
    /// Normal of the separating plane.
    Plane,
    /// Normal from gradients of mass or volume.
    Gradients(Gradients),
    /// Normal by logistic regression.
    Regression,
}

impl<const D: usize> NormalRule<f64, D> for Normals {
    fn prepare(&self, at: &dyn Places<f64, D>, memory: &mut Memory<'_, f64>) {
        match self {
            Normals::Gradients(rule) => rule.prepare(at, memory),
            Normals::Plane => SeparatingPlane.prepare(at, memory),
            Normals::Regression => Regression.prepare(at, memory),
        }
    }
    fn normals(
        &self,
        at: &dyn Places<f64, D>,
        pair: [usize; 2],
        nodes: u64,
        memory: &Memory<'_, f64>,
        normals: &mut Nodal<[f64; 3]>,
    ) -> u64 {
        match self {
            Normals::Gradients(rule) => rule.normals(at, pair, nodes, memory, normals),
            Normals::Plane => NormalRule::normals(&SeparatingPlane, at, pair, nodes, memory, normals),
            Normals::Regression => NormalRule::normals(&Regression, at, pair, nodes, memory, normals),
        }
    }
}
