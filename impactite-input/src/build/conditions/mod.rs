//! Boundary conditions and loads from scene files.

pub(crate) mod accounts;
pub(super) mod loads;

use std::sync::Arc;

use impactite::mpm::{Boundary, Side};
use impactite::scene::BoundaryEntry;
use impactite::scene::boundary::VelocityHistory;

use crate::build::common::World;
use crate::build::shape;
use crate::build::wrong::{At, Made, wrong};
use crate::formula::Formula;
use crate::model::condition::{self, Condition, Prescribed, Wall};
use crate::model::formulas;
use crate::quantity::Speed;

impl<const D: usize> World<'_, D> {
    /// Return the boundary conditions, each with its key.
    pub fn conditions(&self) -> Made<Vec<(String, BoundaryEntry<D>)>> {
        let accounts = accounts::of(self.scene);
        let list = self.scene.conditions.iter().enumerate();
        list.map(|(n, condition)| {
            let key = format!("conditions[{n}]");
            let mut entry = self.condition(&key, condition)?;
            if let Ok(account) = accounts.binary_search(&n) {
                entry = entry.with_account(account).at(&key)?;
            }
            Ok((key, entry))
        })
        .collect()
    }

    fn condition(&self, key: &str, condition: &Condition) -> Made<BoundaryEntry<D>> {
        let axis = |axis, word: &str| self.space().axis(axis).at(format!("{key}.{word}.axis"));
        let boundary = match condition {
            Condition::Symmetry(plane) => Boundary::Symmetry {
                axis: axis(plane.axis, "symmetry")?,
                at: plane.at.value,
                side: side(plane.side),
            },
            Condition::Fixed(plane) => Boundary::Fixed {
                axis: axis(plane.axis, "fixed")?,
                at: plane.at.value,
                side: side(plane.side),
            },
            Condition::Wall(wall) => return self.wall(&format!("{key}.wall"), wall),
            Condition::Absorbing(plane) => {
                if self.scene.mass_scaling.is_some() {
                    let message =
                        "has dashpots of the waves of the unscaled masses; it is not with `mass_scaling`";
                    return wrong(format!("{key}.absorbing"), message);
                }
                Boundary::Absorbing {
                    axis: axis(plane.axis, "absorbing")?,
                    at: plane.at.value,
                    side: side(plane.side),
                    longitudinal: plane.longitudinal.value,
                    shear: plane.shear.value,
                }
            }
            Condition::Periodic(period) => Boundary::Periodic {
                axis: axis(period.axis, "periodic")?,
                low: period.low.value,
                high: period.high.value,
            },
            Condition::Prescribed(prescribed) => {
                return self.prescribed(&format!("{key}.prescribed"), prescribed);
            }
        };
        Ok(boundary.into())
    }

    /// Return a wall, which moves by its `velocity` or `position`.
    fn wall(&self, key: &str, wall: &Wall) -> Made<BoundaryEntry<D>> {
        let axis = self.space().axis(wall.axis).at(format!("{key}.axis"))?;
        let (at, side) = (wall.at.value, side(wall.side));
        let list: [Formula<Speed>; D] = match &wall.velocity {
            Some(_) if wall.position.is_some() => {
                return wrong(format!("{key}.position"), "either `velocity` or `position`");
            }
            Some(list) => formulas(list).at(format!("{key}.velocity"))?,
            None => std::array::from_fn(|_| Formula::constant(0.0)),
        };
        for (n, formula) in list.iter().enumerate() {
            let key = format!("{key}.velocity[{n}]");
            formula.check(self.space().coordinates(), false, true).at(key)?;
        }
        let constant = list.each_ref().map(Formula::as_constant);
        let velocity = constant.map(|v| v.unwrap_or(0.0));
        let drags = (0..D).any(|d| d != axis && constant[d] != Some(0.0));
        let boundary = match &wall.friction {
            Some(friction) => Boundary::FrictionWall { axis, at, side, velocity, friction: friction.value },
            None if drags => {
                let message = "a wall without `friction` drags nothing along";
                return wrong(format!("{key}.velocity"), message);
            }
            None => Boundary::Wall { axis, at, side, velocity: velocity[axis] },
        };
        let entry = BoundaryEntry::from(boundary);
        if wall.position.is_some() {
            let position = self.wall_position(key, wall)?;
            return entry.with_position(Arc::new(position)).at(format!("{key}.position"));
        }
        if constant.iter().all(Option::is_some) {
            return Ok(entry);
        }
        let velocity = move |t: f64| -> [f64; D] { std::array::from_fn(|d| list[d].at(&[0.0; D], false, t)) };
        entry.with_velocity(Arc::new(velocity)).at(format!("{key}.velocity"))
    }

    /// Return the position of a wall over time, m, which begins at its place; the place itself without a `position`.
    pub fn wall_position(&self, key: &str, wall: &Wall) -> Made<impl Fn(f64) -> f64 + Send + Sync + use<D>> {
        let (key, at) = (format!("{key}.position"), wall.at.value);
        let position = wall.position.clone();
        if let Some(formula) = &position {
            formula.check(self.space().coordinates(), false, true).at(&key)?;
        }
        let place = move |t: f64| position.as_ref().map_or(at, |x| x.at(&[0.0; D], false, t));
        let start = place(0.0);
        // False for a position that is no number.
        let begins = (start - at).abs() <= 1e-9 * at.abs().max(start.abs());
        if begins {
            Ok(place)
        } else {
            wrong(key, format!("is {start} m at the start; it must begin at `at`, {at} m"))
        }
    }

    /// Return a prescribed velocity.
    fn prescribed(&self, key: &str, prescribed: &Prescribed) -> Made<BoundaryEntry<D>> {
        let list = &prescribed.velocity;
        if list.len() != D {
            let message = format!("has {} components; the scene has {D} dimensions", list.len());
            return wrong(format!("{key}.velocity"), message);
        }
        for (n, part) in list.iter().enumerate() {
            if let Some(formula) = &part.0 {
                let key = format!("{key}.velocity[{n}]");
                formula.check(self.space().coordinates(), false, true).at(key)?;
            }
        }
        let list = list.clone();
        let velocity: VelocityHistory = Arc::new(move |t| {
            std::array::from_fn(|d| Some(list.get(d)?.0.as_ref()?.at(&[0.0; D], false, t)))
        });
        let region = shape::build(&format!("{key}.region"), &prescribed.region, self.folder)?;
        let entry = BoundaryEntry::from(Boundary::Prescribed { region, velocity });
        if prescribed.follows { entry.following().at(format!("{key}.follows")) } else { Ok(entry) }
    }
}

fn side(side: condition::Side) -> Side {
    match side {
        condition::Side::Above => Side::Above,
        condition::Side::Below => Side::Below,
    }
}
