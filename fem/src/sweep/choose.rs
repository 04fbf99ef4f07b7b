//! Sweep of a kind of element.

use impactite_geometry::ElementKind;

use super::bar::Bar;
use super::rule::{Averaged, Full, MeanDilatation, OnePoint, Solid};
use super::work::Sweep;
use crate::shape::{Hexa, Quad, Shape, Simplex};
use crate::technology::Technology;

/// Create the sweep of a kind of element. The technology is already checked.
pub(crate) fn sweep_of(
    kind: ElementKind,
    technology: Technology,
    hoop: bool,
    section: f64,
) -> Box<dyn Sweep> {
    match kind {
        ElementKind::Bar2 => Box::new(Bar { section }),
        ElementKind::Triangle3 if hoop => simplex::<2, true>(technology),
        ElementKind::Triangle3 => simplex::<2, false>(technology),
        ElementKind::Tetra4 => simplex::<3, false>(technology),
        ElementKind::Quad4 if hoop => block::<Quad, true>(technology),
        ElementKind::Quad4 => block::<Quad, false>(technology),
        ElementKind::Hexa8 => block::<Hexa, false>(technology),
    }
}

fn simplex<const D: usize, const HOOP: bool>(technology: Technology) -> Box<dyn Sweep> {
    match technology {
        Technology::AveragedVolumes => Box::new(Solid::<Simplex<D>, Averaged, HOOP>::new()),
        _ => Box::new(Solid::<Simplex<D>, Full, HOOP>::new()),
    }
}

fn block<S: Shape, const HOOP: bool>(technology: Technology) -> Box<dyn Sweep> {
    match technology {
        Technology::OnePoint(_) => Box::new(Solid::<S, OnePoint, HOOP>::new()),
        Technology::MeanDilatation => Box::new(Solid::<S, MeanDilatation, HOOP>::new()),
        _ => Box::new(Solid::<S, Full, HOOP>::new()),
    }
}
