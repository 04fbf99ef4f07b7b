//! How elements are integrated.

use impactite_geometry::ElementKind;
use impactite_scene::SceneError;

/// What holds the deformations that one point of integration does not see (\[FlanaganBelytschko1981\]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hourglass {
    /// Springs, with the stiffness kappa G tr(B B^T) / V of each hourglass mode, G the shear modulus of the law at rest (of a law without
    /// one a hundredth of its bulk modulus): kappa = 1 makes them as stiff as the shear of the element. In `(0, 1]`. They turn with the
    /// element; what they store is internal energy.
    Stiffness(f64),
    /// Dashpots: kappa times mass times c sqrt(tr(B B^T)) / V. In `(0, 0.25]`. What they take is internal energy.
    Viscous(f64),
}

/// How elements of a kind are integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Technology {
    /// Quadrilaterals and bricks: one point with the mean gradient over the element, and hourglass control.
    OnePoint(Hourglass),
    /// 2 points along each axis. Simplices and bars have constant strain and one point. Locks where the volume must be kept, and
    /// quadrilaterals and bricks also where thin parts bend.
    Full,
    /// Quadrilaterals and bricks: 2 points along each axis, each with the mean rate of dilatation of the element (B-bar in rate form,
    /// \[Hughes1980\]): does not lock where the volume must be kept.
    MeanDilatation,
    /// Simplices: constant strain, with the change of volume and the mean stress averaged over the nodes (\[BonetBurton1998\]): does not
    /// lock where the volume must be kept. Three passes over the elements.
    AveragedVolumes,
}

impl Technology {
    /// What elements of a kind have unless told otherwise: one point with springs of 0.05, but around an axis mean dilatation, where one
    /// point was seen to gain energy at the usual step (a ball that strikes a wall); averaged volumes of simplices.
    #[must_use]
    pub fn default_of(kind: ElementKind, axisymmetric: bool) -> Self {
        match kind {
            ElementKind::Bar2 => Technology::Full,
            ElementKind::Triangle3 | ElementKind::Tetra4 => Technology::AveragedVolumes,
            ElementKind::Quad4 if axisymmetric => Technology::MeanDilatation,
            ElementKind::Quad4 | ElementKind::Hexa8 => Technology::OnePoint(Hourglass::Stiffness(0.05)),
        }
    }

    /// Refuse what a kind of element cannot do.
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

    /// Its name in messages.
    fn name(self) -> &'static str {
        match self {
            Technology::OnePoint(_) => "one-point integration with hourglass control",
            Technology::Full => "full integration",
            Technology::MeanDilatation => "mean dilatation",
            Technology::AveragedVolumes => "averaged nodal volumes",
        }
    }
}
