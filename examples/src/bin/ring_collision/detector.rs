//! A detector that is chosen at run time, so that the step is compiled once for all of them.

use examples::{CaseError, Normals};
use mpm_contact::{ContactDetector, Gradients, Nodal, Places, SurfaceDistance};

use crate::setup::Detection;

/// A test of contact.
pub struct Chosen {
    /// Look at the distance of the surfaces, too?
    measures: bool,
    distance: SurfaceDistance<Normals>,
}

impl Detection {
    /// The detector of this name.
    pub fn detector(self) -> Result<Chosen, CaseError> {
        let gradients = || Normals::Gradients(Gradients::default());
        let distance = match self {
            Detection::Velocity | Detection::Distance => SurfaceDistance::new(gradients(), 0.0)?,
            Detection::Centres => SurfaceDistance::between_centres(gradients(), 0.5)?,
            Detection::Local => SurfaceDistance::new(gradients(), 0.0)?.locally(),
            Detection::Regression => SurfaceDistance::new(Normals::Regression, 0.0)?,
        };
        Ok(Chosen { measures: self != Detection::Velocity, distance })
    }
}

impl ContactDetector<f64, 2> for Chosen {
    type Normals = Normals;
    fn normals(&self) -> &Normals {
        ContactDetector::<f64, 2>::normals(&self.distance)
    }
    fn touching(
        &self,
        at: &dyn Places<f64, 2>,
        pair: [usize; 2],
        nodes: u64,
        normals: &Nodal<[f64; 3]>,
        gaps: &mut Nodal<Option<f64>>,
    ) -> u64 {
        if self.measures { self.distance.touching(at, pair, nodes, normals, gaps) } else { nodes }
    }
}
