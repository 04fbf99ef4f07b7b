//! Rod as particles, rigid body or finite elements.

use std::f64::consts::FRAC_PI_2;

use examples::CaseError;
use fem::{Fem, MeshBody};
use mpm_core::geometry::{ElementMesh, Seeds};
use mpm_core::{Axisymmetric, Boundary, FullSpace, Mpm, Rigid, Side};
use mpm_materials::{LinearElastic, Moduli};

use crate::setup::{MASS, ROD, Rod, Setup, YOUNG};

/// Particles or mesh of the rod, and its model.
pub struct RodOf<const D: usize> {
    parts: Parts<D>,
    /// Axes of planes of symmetry.
    planes: Vec<usize>,
    /// Constructor of an empty scene of elements.
    empty: fn() -> Fem<D>,
    /// Constraints of a rigid rod.
    held: fn(Rigid<D>) -> Rigid<D>,
}

enum Parts<const D: usize> {
    Particles(Seeds<D>),
    Elements(ElementMesh<D>),
}

impl RodOf<3> {
    /// Build a quarter of the rod between two planes of symmetry.
    pub fn quarter(setup: &Setup) -> Result<Self, CaseError> {
        let tip = [0.0, 0.0, 0.25 * setup.spacing()];
        let parts = if setup.rod == Rod::Fem {
            let quarter = |[across, side, _]: [f64; 3]| across < 0.0 && side > 0.0;
            Parts::Elements(ROD.bricks(tip, 0.0, setup.rod_edge, quarter)?.0)
        } else {
            Parts::Particles(ROD.rings(tip, 0.0, FRAC_PI_2, setup.edge())?.0)
        };
        let held = |rigid: Rigid<3>| rigid.holding([true, true, false]).without_turning();
        Ok(RodOf { parts, planes: vec![0, 1], empty: || Fem::new(FullSpace), held })
    }
}

impl RodOf<2> {
    /// Build the rod in the half plane of revolution.
    pub fn revolved(setup: &Setup) -> Result<Self, CaseError> {
        let tip = 0.25 * setup.spacing();
        let parts = if setup.rod == Rod::Fem {
            Parts::Elements(ROD.quadrilaterals(tip, setup.rod_edge)?)
        } else {
            Parts::Particles(ROD.profile(tip, setup.edge())?)
        };
        Ok(RodOf { parts, planes: vec![0], empty: || Fem::new(Axisymmetric), held: |rigid| rigid })
    }
}

impl<const D: usize> RodOf<D> {
    /// Return the planes of symmetry of the scene.
    pub fn planes(&self) -> impl Iterator<Item = Boundary<D>> {
        self.planes.iter().map(|&axis| Boundary::Symmetry { axis, at: 0.0, side: Side::Above })
    }

    /// Add the rod to a scene, with its impact velocity.
    pub fn add(&self, setup: &Setup, mpm: &mut Mpm<D>) -> Result<(), CaseError> {
        let density = MASS / ROD.volume()?;
        let steel = || LinearElastic::new(density, Moduli::young_poisson(YOUNG, 0.3)?);
        let mut velocity = [0.0; D];
        velocity[D - 1] = -setup.speed;
        match &self.parts {
            Parts::Particles(seeds) if setup.rod == Rod::Rigid => {
                let rigid = (self.held)(Rigid::free(density)?.with_velocity(velocity));
                mpm.add_rigid("rod", &rigid, seeds)?;
            }
            Parts::Particles(seeds) => {
                mpm.add("rod", steel()?, seeds, |_| velocity)?;
            }
            Parts::Elements(mesh) => {
                let mut fem = (self.empty)();
                fem.add(MeshBody::new("rod", mesh.clone(), steel()?).moving(move |_| velocity))?;
                for plane in self.planes() {
                    fem.bound(plane)?;
                }
                mpm.add_client(setup.coupling.elements(fem, setup.friction)?)?;
            }
        }
        Ok(())
    }
}
