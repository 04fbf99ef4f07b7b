//! Measures and checks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::contact::Nothing;
use super::parts::parts;
use super::shape::Shape;
use super::{Axis, Vector};
use crate::quantity::{Length, Plain, Quantity, Time};

/// A measured number of the scene. `measures.csv` has it over time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Measurement {
    /// Extent of a body along an axis, between the surfaces of its outermost points, m.
    Extent(OfBody),
    /// Largest coordinate of the centres of a body's points, m; with `share` the coordinate beyond which this share of its mass is.
    Highest(Outermost),
    /// Smallest coordinate of the centres of a body's points, m; with `share` the coordinate below which this share of its mass is.
    Lowest(Outermost),
    /// Coordinate of the centre of mass, m.
    Centre(OfBody),
    /// Mean velocity: momentum over mass, m/s.
    MeanVelocity(OfBody),
    /// Momentum, kg m/s.
    Momentum(OfBody),
    /// Angular momentum about a place, kg m^2/s; around an axis that along it.
    AngularMomentum(AngularMomentum),
    /// Kinetic energy, J.
    Kinetic(Whole),
    /// Internal energy, J.
    Internal(Whole),
    /// Mass, kg.
    Mass(Part),
    /// Volume, m^3.
    Volume(Part),
    /// Largest value of a field over the points of a body.
    Largest(Field),
    /// Smallest value of a field over the points of a body.
    Smallest(Field),
    /// Mean value of a field, by mass.
    Mean(Field),
    /// Coordinate of the point of a body that was nearest to a place at the start, m; no number once the point is gone.
    PositionAt(AtPlace),
    /// Velocity of the point of a body that was nearest to a place at the start, m/s.
    VelocityAt(AtPlace),
    /// Value of a field at the point of a body that was nearest to a place at the start.
    ValueAt(FieldAtPlace),
    /// Contact force along an axis on the second of two bodies, mean of the last step, N.
    ContactForce(Between),
    /// Force along an axis of boundary conditions on the bodies, mean of the last step, N.
    ConditionForce(Along),
    /// Impulse along an axis of boundary conditions on the bodies since the start, N s.
    ConditionImpulse(Along),
    /// Work of boundary conditions on the bodies since the start, J: of walls impulse times velocity of the wall.
    ConditionWork(OfCondition),
    /// Area of the surface of a body of elements or cells (`fem`, `fpm`, `pcmm`, elements in `mpm`), m^2; in the plane its perimeter per
    /// metre of depth. Faces on planes of symmetry count.
    SurfaceArea(Whole),
    /// Value of a profile in one of its bins.
    Profile(InProfile),
    /// Kinetic over internal energy of all bodies; small where a process is slow, as with `mass_scaling`.
    KineticShare(Nothing),
    /// Failed points over all points of the body.
    FailedShare(Part),
    /// Part of the balance of energy of the scene since the start, J.
    Balance(Entry),
    /// Energy error: change of the total energy that nothing explains, over the largest energy so far. Negative: lost.
    EnergyError(Nothing),
    /// Another measure over time, taken after every step.
    OverTime(OverTime),
}

impl Measurement {
    /// Return the region that restricts the points.
    #[must_use]
    pub fn region(&self) -> Option<&Shape> {
        match self {
            Measurement::Mass(of) | Measurement::Volume(of) | Measurement::FailedShare(of) => {
                of.region.as_ref()
            }
            Measurement::Largest(of) | Measurement::Smallest(of) | Measurement::Mean(of) => {
                of.region.as_ref()
            }
            _ => None,
        }
    }

    /// Return the region for modification.
    pub(crate) fn region_mut(&mut self) -> Option<&mut Shape> {
        match self {
            Measurement::Mass(of) | Measurement::Volume(of) | Measurement::FailedShare(of) => {
                of.region.as_mut()
            }
            Measurement::Largest(of) | Measurement::Smallest(of) | Measurement::Mean(of) => {
                of.region.as_mut()
            }
            _ => None,
        }
    }
}

/// A part of the balance of energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Entry {
    /// Kinetic energy of all bodies.
    Kinetic,
    /// Internal energy of all bodies.
    Internal,
    /// Work of boundary conditions, loads and gravity on the bodies.
    Work,
    /// Work of friction.
    Friction,
    /// Energy that plastic impacts of points took.
    Impacts,
    /// Energy that damping took.
    Damping,
    /// Energy that numerical viscosity took.
    Viscosity,
    /// Heat of the viscosity of laws, which is part of the internal energy.
    ViscousHeat,
    /// Change of the total energy that nothing explains.
    Unexplained,
}

/// What is made of a measure over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Statistic {
    /// Largest value.
    Largest,
    /// Smallest value.
    Smallest,
    /// Mean over time.
    Mean,
    /// Integral over time: of a force the impulse, of a velocity the way.
    Integral,
    /// Time of the largest value, s.
    TimeOfLargest,
    /// Time of the smallest value, s.
    TimeOfSmallest,
}

parts! {
    /// Of a body, along an axis.
    OfBody {
        /// Name of the body.
        #[schemars(example = &"body")]
        body: String,
        /// The axis.
        #[schemars(example = &"y")]
        axis: Axis,
    }
    /// Outermost points of a body along an axis.
    Outermost {
        /// Name of the body.
        #[schemars(example = &"body")]
        body: String,
        /// The axis.
        #[schemars(example = &"y")]
        axis: Axis,
        /// Share of the mass of the body that is farther out: 0.01 is the front of a flow without its last grains. The outermost point if not given.
        #[serde(default)]
        #[schemars(example = 0.01, extend("minimum" = 0, "maximum" = 1))]
        share: Option<Quantity<Plain>>,
    }
    /// Boundary conditions, along an axis.
    Along {
        /// The axis.
        #[schemars(example = &"y")]
        axis: Axis,
        /// Name of the condition, its kind (`wall`, `fixed`, ...), or its place in the list, from 0; all conditions if not given.
        #[serde(default)]
        #[schemars(example = &"floor")]
        condition: Option<ConditionName>,
    }
    /// Boundary conditions.
    OfCondition {
        /// Name of the condition, its kind (`wall`, `fixed`, ...), or its place in the list, from 0.
        #[schemars(example = &"floor")]
        condition: ConditionName,
    }
    /// A bin of a profile.
    InProfile {
        /// Name of the profile, of the table `profiles`.
        #[schemars(example = &"along the bar")]
        of: String,
        /// Number of the bin, from 1.
        #[schemars(example = 3, extend("minimum" = 1))]
        bin: u32,
    }
    /// Of a body.
    Whole {
        /// Name of the body.
        #[schemars(example = &"body")]
        body: String,
    }
    /// Of a body, or of the part of it that is in a region.
    Part {
        /// Name of the body.
        #[schemars(example = &"body")]
        body: String,
        /// Region, fixed in space: points alone that are in it at the time of the measure.
        #[serde(default)]
        region: Option<Shape>,
    }
    /// The angular momentum of a body.
    AngularMomentum {
        /// Name of the body.
        #[schemars(example = &"body")]
        body: String,
        /// Place about which; the centre of mass if not given.
        #[serde(default)]
        #[schemars(example = (0, 0))]
        about: Option<Vector<Length>>,
        /// The axis, in three dimensions.
        #[serde(default)]
        #[schemars(example = &"z")]
        axis: Option<Axis>,
    }
    /// Of the point of a body that was nearest to a place at the start, along an axis.
    AtPlace {
        /// Name of the body.
        #[schemars(example = &"body")]
        body: String,
        /// Place at the start.
        #[schemars(example = (0, "5 mm"))]
        at: Vector<Length>,
        /// The axis.
        #[schemars(example = &"y")]
        axis: Axis,
    }
    /// A field at the point of a body that was nearest to a place at the start.
    FieldAtPlace {
        /// Name of the body.
        #[schemars(example = &"body")]
        body: String,
        /// Place at the start.
        #[schemars(example = (0, "5 mm"))]
        at: Vector<Length>,
        /// The field: `pressure`, `von_mises`, `speed`, `density`, a component as `velocity_x`, `position_x` and `stress_xy`, or a state
        /// variable of the law, as `plastic_strain`, `temperature`, `damage`.
        #[schemars(example = &"von_mises")]
        field: String,
    }
    /// Of two bodies, along an axis.
    Between {
        /// Names of the two bodies.
        #[schemars(example = ("rod", "plate"))]
        between: [String; 2],
        /// The axis.
        #[schemars(example = &"y")]
        axis: Axis,
    }
    /// A field of a body, or of the part of it that is in a region.
    Field {
        /// Name of the body.
        #[schemars(example = &"body")]
        body: String,
        /// The field: `pressure`, `von_mises`, `speed`, `density`, a component as `velocity_x`, `position_x` and `stress_xy`, or a state
        /// variable of the law, as `plastic_strain`, `temperature`, `damage`.
        #[schemars(example = &"von_mises")]
        field: String,
        /// Region, fixed in space: points alone that are in it at the time of the measure; no number while there are none.
        #[serde(default)]
        region: Option<Shape>,
    }
    /// Another measure over time.
    OverTime {
        /// Name of the other measure.
        #[schemars(example = &"force")]
        of: String,
        /// What is made of it.
        take: Statistic,
        /// Time from which on; the start if not given.
        #[serde(default)]
        #[schemars(example = "1 ms")]
        from: Option<Quantity<Time>>,
        /// Time until which; the end if not given.
        #[serde(default)]
        #[schemars(example = "2 ms")]
        to: Option<Quantity<Time>>,
    }
}

/// Boundary condition by name, kind or place in the list.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ConditionName {
    /// Place in the list, from 0.
    Place(u32),
    /// Name, or kind.
    Name(String),
}

/// Values of a field along a line: means over the points of a body in bins, over time in `profiles/NAME.csv`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// Name of the body.
    #[schemars(example = &"body")]
    pub body: String,
    /// The field, as of measures; also `density`, and `position_x` and its like, whose largest value is a height.
    #[schemars(example = &"velocity_x")]
    pub field: String,
    /// Start of the line, fixed in space.
    #[schemars(example = (0, 0))]
    pub from: Vector<Length>,
    /// End of the line. Bins are layers across it.
    #[schemars(example = ("100 mm", 0))]
    pub to: Vector<Length>,
    /// Number of bins of equal length, 1 to 1000.
    #[schemars(example = 20, extend("minimum" = 1, "maximum" = 1000))]
    pub bins: u32,
    /// Distance from the line within which points count; all if not given.
    #[serde(default)]
    #[schemars(example = "2 mm")]
    pub radius: Option<Quantity<Length>>,
    /// Statistic of the points of a bin: mean by mass, largest or smallest value.
    #[serde(default)]
    pub take: TakenOfBin,
    /// Time between rows; a fortieth of `end` if not given.
    #[serde(default)]
    #[schemars(example = "10 us")]
    pub every: Option<Quantity<Time>>,
}

/// Value of a bin of a profile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TakenOfBin {
    /// Mean by mass; of the density mass over volume.
    #[default]
    Mean,
    /// Largest value.
    Largest,
    /// Smallest value.
    Smallest,
}

/// End of a run when a measure passes a value.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Until {
    /// Name of the measure.
    #[schemars(example = &"speed")]
    pub measure: String,
    /// The run ends after the step at whose end the measure is below this value: a number in SI units, or a text with a unit.
    #[serde(default)]
    #[schemars(example = "1 m/s")]
    pub below: Option<Reference>,
    /// The run ends after the step at whose end the measure is above this value.
    #[serde(default)]
    #[schemars(example = "1 m/s")]
    pub above: Option<Reference>,
}

/// A comparison of a measure at the end with a reference. A failed check makes the exit code 1.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// Name of the measure.
    #[schemars(example = &"length")]
    pub measure: String,
    /// Reference value: a number in SI units, or a text with a unit.
    #[schemars(example = "16.28 mm")]
    pub reference: Reference,
    /// Allowed difference over the reference; absolute where the reference is 0.
    #[schemars(example = 0.02, extend("exclusiveMinimum" = 0))]
    pub tolerance: Quantity<Plain>,
    /// Source of the reference.
    #[schemars(example = "finite elements with the same law")]
    pub source: String,
}

/// A number in the measure's SI unit, or a text with a unit.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Reference {
    /// In SI units.
    Number(f64),
    /// With a unit.
    Text(String),
}
