//! Contact detector of the grid chosen at run time, so that a step is compiled once for all detectors.

use crate::detect::{Compression, ContactDetector, Criterion, SurfaceDistance};
use crate::normal::{Gradients, Memory, Nodal, NormalNodes, NormalRule};
use crate::places::Places;
use crate::regression::Regression;
use crate::separate::SeparatingPlane;

/// Contact detector of the grid chosen at run time: by distance of surfaces, by approach, or by approach under compression.
#[derive(Clone, Debug, PartialEq)]
pub struct AnyDetector {
    test: Test,
    distance: SurfaceDistance<AnyNormals>,
}

#[derive(Clone, Debug, PartialEq)]
enum Test {
    Approach,
    Compression(Compression<Gradients>),
    Regression,
    Distance,
}

impl AnyDetector {
    /// Create a detector by the distance of surfaces along any normals.
    pub fn by_distance(distance: SurfaceDistance<AnyNormals>) -> Self {
        AnyDetector { test: Test::Distance, distance }
    }
    /// Create a detector by approach at shared nodes.
    pub fn by_approach(gradients: Gradients) -> Self {
        AnyDetector {
            test: Test::Approach,
            distance: SurfaceDistance::touching_along(AnyNormals::Gradients(gradients)),
        }
    }
    /// Create the detector by the margin of the plane of logistic regression, [`Regression`].
    pub fn by_regression() -> Self {
        AnyDetector {
            test: Test::Regression,
            distance: SurfaceDistance::touching_along(AnyNormals::Regression),
        }
    }
    /// Create a detector by approach at shared nodes whose traction is compressive.
    pub fn by_compression(gradients: Gradients) -> Self {
        let distance = SurfaceDistance::touching_along(AnyNormals::Gradients(gradients));
        AnyDetector { test: Test::Compression(Compression::default()), distance }
    }
}

impl<const D: usize> ContactDetector<f64, D> for AnyDetector {
    type Normals = AnyNormals;
    fn criterion(&self, spacing: f64) -> Criterion {
        match self.test {
            Test::Approach => Criterion::Always,
            Test::Compression(_) => Criterion::State,
            Test::Regression => ContactDetector::<f64, D>::criterion(&Regression, spacing),
            Test::Distance => ContactDetector::<f64, D>::criterion(&self.distance, spacing),
        }
    }
    fn measures_surfaces(&self) -> bool {
        self.test == Test::Distance
    }
    fn normals(&self) -> &AnyNormals {
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
            Test::Regression => Regression.touching(at, pair, nodes, normals, gaps),
            Test::Distance => self.distance.touching(at, pair, nodes, normals, gaps),
        }
    }
}

/// Rule for the contact normal between two bodies, chosen at run time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AnyNormals {
    /// Normal of the separating plane.
    Plane,
    /// Normal from gradients of mass or volume.
    Gradients(Gradients),
    /// Normal by logistic regression.
    Regression,
}

impl<const D: usize> NormalRule<f64, D> for AnyNormals {
    fn prepare(&self, at: &dyn Places<f64, D>, memory: &mut Memory<'_, f64>) {
        match self {
            AnyNormals::Gradients(rule) => rule.prepare(at, memory),
            AnyNormals::Plane => SeparatingPlane.prepare(at, memory),
            AnyNormals::Regression => Regression.prepare(at, memory),
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
            AnyNormals::Gradients(rule) => rule.normals(at, pair, nodes, memory, normals),
            AnyNormals::Plane => NormalRule::normals(&SeparatingPlane, at, pair, nodes, memory, normals),
            AnyNormals::Regression => NormalRule::normals(&Regression, at, pair, nodes, memory, normals),
        }
    }
    fn normals_within(
        &self,
        at: &dyn Places<f64, D>,
        pair: [usize; 2],
        nodes: u64,
        gap: f64,
        memory: &Memory<'_, f64>,
        normals: &mut Nodal<[f64; 3]>,
    ) -> NormalNodes {
        match self {
            AnyNormals::Plane => SeparatingPlane.normals_within(at, pair, nodes, gap, memory, normals),
            AnyNormals::Gradients(_) | AnyNormals::Regression => {
                NormalNodes { found: self.normals(at, pair, nodes, memory, normals), apart: 0 }
            }
        }
    }
}
