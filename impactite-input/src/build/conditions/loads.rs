//! Tractions and pressures on surfaces from scene files.

use std::sync::Arc;

use impactite::geometry::Shape;
use impactite::mpm::Traction as OnParticles;

use crate::build::common::World;
use crate::build::shape;
use crate::build::wrong::{At, Made, Wrong, wrong};
use crate::formula::Formula;
use crate::model::body::Traction;
use crate::model::formulas;
use crate::quantity::Pressure;

/// Load on a part of a surface.
pub(in crate::build) struct Surface<const D: usize> {
    pub part: Part<D>,
    /// Axis normal to the loaded faces; any if `None`.
    pub axis: Option<usize>,
    pub load: Load<D>,
}

/// Loaded part of a surface.
pub(in crate::build) enum Part<const D: usize> {
    /// Region that contains the loaded points or faces initially.
    Region(Arc<dyn Shape<D>>),
    /// Name of a set of the mesh.
    Named(String),
}

/// Load over time, s.
pub(in crate::build) enum Load<const D: usize> {
    /// Traction vector, Pa.
    Traction(Arc<dyn Fn(f64) -> [f64; D] + Send + Sync>),
    /// Pressure, Pa.
    Pressure(Arc<dyn Fn(f64) -> f64 + Send + Sync>),
}

impl<const D: usize> World<'_, D> {
    /// Return the load on a part of a surface.
    pub fn load(&self, key: &str, load: &Traction) -> Made<Surface<D>> {
        let check = |formula: &Formula<Pressure>, key: String| {
            formula.check(self.space().coordinates(), false, true).at(key)
        };
        let part = match (&load.region, &load.surface) {
            (Some(region), None) => {
                Part::Region(shape::build(&format!("{key}.region"), region, self.folder)?)
            }
            (None, Some(name)) => Part::Named(name.clone()),
            _ => return wrong(key, "needs a `region` or a `surface`, and not both"),
        };
        let axis = load.normal.map(|axis| self.space().axis(axis).at(format!("{key}.normal"))).transpose()?;
        let load = match (&load.traction, &load.pressure) {
            (Some(list), None) => {
                if axis.is_none() && matches!(part, Part::Region(_)) {
                    return wrong(
                        key,
                        "a `traction` on a `region` needs the axis `normal` to the loaded faces",
                    );
                }
                let list: [_; D] = formulas(list).at(format!("{key}.traction"))?;
                for (n, formula) in list.iter().enumerate() {
                    check(formula, format!("{key}.traction[{n}]"))?;
                }
                Load::Traction(Arc::new(move |t| std::array::from_fn(|d| list[d].at(&[0.0; D], false, t))))
            }
            (None, Some(formula)) => {
                check(formula, format!("{key}.pressure"))?;
                let formula = formula.clone();
                Load::Pressure(Arc::new(move |t| formula.at(&[0.0; D], false, t)))
            }
            _ => return wrong(key, "needs a `traction` or a `pressure`, and not both"),
        };
        Ok(Surface { part, axis, load })
    }

    /// Return a traction on particles, which have no faces.
    pub fn traction_on_particles(&self, key: &str, load: &Traction) -> Made<OnParticles<D>> {
        if load.surface.is_some() {
            return wrong(
                format!("{key}.surface"),
                "is of meshes, of the method `fem`; particles have a `region`",
            );
        }
        if load.pressure.is_some() {
            let message = "is of faces, of the methods `fem` and `fpm`; particles have a `traction`";
            return wrong(format!("{key}.pressure"), message);
        }
        match self.load(key, load)? {
            Surface { part: Part::Region(region), axis: Some(axis), load: Load::Traction(history) } => {
                Ok(OnParticles { region, axis, history, revolved: self.revolved() })
            }
            _ => wrong(key, "needs a `region`, a `normal` and a `traction`"),
        }
    }
}

/// Refuse a load whose region contains no particle.
pub(in crate::build) fn loaded<const D: usize>(
    key: &str,
    load: &OnParticles<D>,
    particles: &[[f64; D]],
) -> Made<()> {
    if particles.iter().any(|x| load.region.contains(*x)) {
        return Ok(());
    }
    let bounds = load.region.bounds();
    let outside = |x: &[f64; D], d: usize| (bounds.min[d] - x[d]).max(x[d] - bounds.max[d]).max(0.0);
    let square = |x: &[f64; D]| (0..D).map(|d| outside(x, d).powi(2)).sum::<f64>();
    let distance = particles.iter().map(square).fold(f64::INFINITY, f64::min).sqrt();
    Err(Wrong {
        key: key.into(),
        message: format!("selects no particle; the nearest one is {distance:.3e} m away"),
        help: Some("enlarge it by that, so that it holds the outermost layer of particles".into()),
    })
}
