//! Rod by material points or finite elements.

use std::f64::consts::PI;

use examples::CaseError;
use fem::{Fem, MeshBody};
use mpm_core::{BlockGrid, Boundary, Flip, FullSpace, Linear, Method, Mpm, Musl, Side};
use mpm_materials::{LinearElastic, Moduli};

use crate::setup::{ROD, RodFrame, STEEL, Setup};

fn steel() -> Result<LinearElastic<f64>, CaseError> {
    Ok(LinearElastic::new(STEEL, Moduli::young_poisson(206e9, 0.3)?)?)
}

/// Plane of symmetry of the half model.
pub fn symmetry() -> Boundary<3> {
    Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }
}

/// Add the half rod with its tip at a position, m, and its impact velocity. Return the distance of each point from its tail, m.
pub fn add(setup: &Setup, mpm: &mut Mpm<3>, tip: [f64; 3]) -> Result<Vec<f64>, CaseError> {
    let (sine, cosine) = setup.angle.sin_cos();
    let velocity = [setup.speed * sine, 0.0, -setup.speed * cosine];
    if setup.rod == RodFrame::Fem {
        return elements(setup, mpm, tip, velocity);
    }
    let (seeds, from_tail) = ROD.rings(tip, setup.angle, PI, setup.spacing() / f64::from(setup.parts))?;
    if setup.rod == RodFrame::Reference {
        let method = Method::new(Linear, Flip, Musl, FullSpace).total_lagrangian();
        let mut own = Mpm::new(method, BlockGrid::new(*mpm.grid().lattice()));
        own.add("rod", steel()?, &seeds, |_| velocity)?;
        own.bound(symmetry())?;
        mpm.add_total_lagrangian(own)?;
    } else {
        mpm.add("rod", steel()?, &seeds, |_| velocity)?;
    }
    Ok(from_tail)
}

fn elements(
    setup: &Setup,
    mpm: &mut Mpm<3>,
    tip: [f64; 3],
    velocity: [f64; 3],
) -> Result<Vec<f64>, CaseError> {
    let (mesh, from_tail) = ROD.bricks(tip, setup.angle, setup.edge, |[_, side, _]| side > 0.0)?;
    let mut fem = Fem::new(FullSpace);
    fem.add(MeshBody::new("rod", mesh, steel()?).moving(move |_| velocity))?;
    fem.bound(symmetry())?;
    mpm.add_client(setup.coupling.elements(fem, setup.friction)?)?;
    Ok(from_tail)
}
