//! Element technology: integration and hourglass control.

use impactite_geometry::ElementKind;
use impactite_scene::SceneError;

/// Hourglass control of one-point elements (\[FlanaganBelytschko1981\]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hourglass {
    /// Stiffness form (springs): kappa G tr(B B^T) / V for each hourglass mode, G the initial shear modulus of the law (a hundredth of the
    /// bulk modulus for a law without one). kappa = 1 makes the springs as stiff as the element in shear. In `(0, 1]`. The forces rotate
    /// with the element; the stored energy is internal energy.
    Stiffness(f64),
    /// Viscous form (dashpots): kappa times mass times c sqrt(tr(B B^T)) / V. In `(0, 0.25]`. The dissipated energy is internal energy.
    Viscous(f64),
}

/// Integration technology of a kind of element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Technology {
    /// One-point integration of quadrilaterals and bricks, with the mean gradient over the element, and hourglass control.
    OnePoint(Hourglass),
    /// Full integration: 2 points along each axis; simplices and bars have constant strain and one point. Elements lock in nearly
    /// incompressible deformation (volumetric locking), quadrilaterals and bricks also in bending of thin parts (shear locking).
    Full,
    /// Mean dilatation (B-bar in rate form, \[Hughes1980\]) of quadrilaterals and bricks: 2 points along each axis, each with the mean rate
    /// of dilatation of the element. No volumetric locking.
    MeanDilatation,
    /// Averaged nodal volumes (\[BonetBurton1998\]) of simplices: constant strain, with volume change and mean stress averaged over the
    /// nodes. No volumetric locking. Three passes over the elements.
    AveragedVolumes,
}

impl Technology {
    /// Default technology of a kind of element: one point with springs of 0.05, for simplices averaged volumes, for bars full integration.
    /// Axisymmetric quadrilaterals have mean dilatation, because one point was observed to gain energy at the default time step (a ball
    /// that strikes a wall).
    #[must_use]
    pub fn default_of(kind: ElementKind, axisymmetric: bool) -> Self {
        match kind {
            ElementKind::Bar2 => Technology::Full,
            ElementKind::Triangle3 | ElementKind::Tetra4 => Technology::AveragedVolumes,
            ElementKind::Quad4 if axisymmetric => Technology::MeanDilatation,
            ElementKind::Quad4 | ElementKind::Hexa8 => Technology::OnePoint(Hourglass::Stiffness(0.05)),
        }
    }

    /// Check that a kind of element supports the technology, and its hourglass coefficient.
    pub(crate) fn check(self, kind: ElementKind) -> Result<(), SceneError> {
        let simplex = matches!(kind, ElementKind::Triangle3 | ElementKind::Tetra4);
        let why = match self {
            Technology::Full => None,
            _ if kind == ElementKind::Bar2 => Some("a bar has one strain: take `Technology::Full`"),
            Technology::OnePoint(_) if simplex => Some(
                "its strain is constant and there are no hourglass modes: take `AveragedVolumes`, or `Full`",
            ),
            Technology::MeanDilatation if simplex => {
                Some("its dilatation is constant, and its mean changes nothing: take `AveragedVolumes`")
            }
            Technology::AveragedVolumes if !simplex => {
                Some("volumes are averaged over the nodes of simplices: take `MeanDilatation` or `OnePoint`")
            }
            _ => None,
        };
        if let Some(why) = why {
            return Err(SceneError::NotWith { what: self.name().into(), method: format!("{kind:?}"), why });
        }
        let number = |field, value: f64, most: f64, allowed| {
            let holds = value > 0.0 && value <= most;
            impactite_scene::error::parameter(holds, "hourglass control", field, value, allowed).map(|_| ())
        };
        match self {
            Technology::OnePoint(Hourglass::Stiffness(k)) => number("stiffness", k, 1.0, "in (0, 1]"),
            Technology::OnePoint(Hourglass::Viscous(k)) => number("viscosity", k, 0.25, "in (0, 0.25]"),
            _ => Ok(()),
        }
    }

    /// Name in messages.
    fn name(self) -> &'static str {
        match self {
            Technology::OnePoint(_) => "one-point integration with hourglass control",
            Technology::Full => "full integration",
            Technology::MeanDilatation => "mean dilatation",
            Technology::AveragedVolumes => "averaged nodal volumes",
        }
    }
}
