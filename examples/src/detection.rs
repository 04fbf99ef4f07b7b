//! Contact detector selected at run time, so that a step is compiled once for all detectors.

use clap::ValueEnum;
use mpm_contact::{AnyDetector, AnyNormals, Gradients, SurfaceDistance};
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
    pub fn detector(self, gradients: Gradients) -> Result<AnyDetector, CaseError> {
        let normals = AnyNormals::Gradients(gradients.clone());
        Ok(AnyDetector::by_distance(match self {
            Detection::Approach => return Ok(AnyDetector::by_approach(gradients)),
            Detection::Compression => return Ok(AnyDetector::by_compression(gradients)),
            Detection::Distance => SurfaceDistance::new(normals, 0.0)?,
            Detection::Plane => SurfaceDistance::new(AnyNormals::Plane, 0.0)?.locally(),
            Detection::Centres => SurfaceDistance::between_centres(normals, 0.5)?,
            Detection::Local => SurfaceDistance::new(normals, 0.0)?.locally(),
            Detection::Regression => SurfaceDistance::new(AnyNormals::Regression, 0.0)?,
            Detection::LocalRegression => SurfaceDistance::new(AnyNormals::Regression, 0.0)?.locally(),
        }))
    }
}
