//! List of the boundary conditions of a scene: order of application, motion over time, and accounts of single conditions.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use impactite_geometry::{Bounds, Shape};

use crate::archive::{Archive, CheckpointError};
use crate::boundary::{BodyForce, Boundary, BoundaryError};
use crate::condition::Condition;
use crate::constants::over;
use crate::error::SceneError;
use crate::exchange::{ACCOUNTS, Exchange};
use crate::moving::MovingPoint;

/// Velocity history of a wall, m/s at time t in s: the component across the wall moves it, the others drag the matter.
pub type WallVelocity<const D: usize> = Arc<dyn Fn(f64) -> [f64; D] + Send + Sync>;
/// Position history of a wall along its normal axis, m at time t in s.
pub type WallPosition = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// Motion of a boundary condition over time.
#[derive(Clone)]
enum Course<const D: usize> {
    /// Motion of the condition itself: none, or the constant velocity of a wall.
    Own,
    Velocity(WallVelocity<D>),
    Position(WallPosition),
    /// Translation of a region of prescribed velocity with the matter in it.
    Followed,
}

/// Boundary condition, with its motion over time and the account to which its impulse and work are booked. A [`Boundary`] converts to an
/// entry without either.
///
/// ```
/// use std::sync::Arc;
/// use impactite_scene::boundary::{Boundary, Side};
/// use impactite_scene::boundaries::{Boundaries, BoundaryEntry};
///
/// let wall = Boundary::<2>::Wall { axis: 1, at: 0.1, side: Side::Below, velocity: 0.0 };
/// let press = BoundaryEntry::from(wall).with_velocity(Arc::new(|t| [0.0, -3.0 * t]))?.with_account(0)?;
/// let mut list = Boundaries::default();
/// list.add(press);
/// list.advance(2.0, 0.5);
/// // The wall of a step moves on the secant of the path: here by the integral of -3 t from 2 s to 2.5 s.
/// assert!(matches!(list[0], Boundary::Wall { velocity, .. } if (velocity + 6.75).abs() < 1e-12));
/// # Ok::<(), impactite_scene::boundary::BoundaryError>(())
/// ```
#[derive(Clone)]
pub struct BoundaryEntry<const D: usize> {
    boundary: Boundary<D>,
    course: Course<D>,
    account: Option<usize>,
}

impl<const D: usize> From<Boundary<D>> for BoundaryEntry<D> {
    fn from(boundary: Boundary<D>) -> Self {
        BoundaryEntry { boundary, course: Course::Own, account: None }
    }
}

impl<const D: usize> fmt::Debug for BoundaryEntry<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let course = match self.course {
            Course::Own => "",
            Course::Velocity(_) => " with a velocity over time",
            Course::Position(_) => " with a position over time",
            Course::Followed => " that follows its matter",
        };
        write!(f, "{:?}{course}", self.boundary)
    }
}

impl<const D: usize> BoundaryEntry<D> {
    /// Set the velocity of a wall over time, m/s. Its path is the integral by Simpson's rule over each step, exact for polynomials up to
    /// the third degree; in a step it moves on the secant.
    ///
    /// # Errors
    /// A condition that is no wall. Components along a wall without friction have no effect.
    pub fn with_velocity(mut self, velocity: WallVelocity<D>) -> Result<Self, BoundaryError> {
        self.require_wall("a velocity over time")?;
        self.course = Course::Velocity(velocity);
        Ok(self)
    }

    /// Set the position of a wall along its axis over time, m. In a step the wall moves on the secant.
    ///
    /// # Errors
    /// A condition that is no wall.
    pub fn with_position(mut self, position: WallPosition) -> Result<Self, BoundaryError> {
        self.require_wall("a position over time")?;
        self.course = Course::Position(position);
        Ok(self)
    }

    /// Let the region of a prescribed velocity move with that velocity, so that matter that starts in it stays in it. Along free axes the
    /// region stays where it is.
    ///
    /// # Errors
    /// A condition that is no prescribed velocity.
    pub fn following(mut self) -> Result<Self, BoundaryError> {
        if !matches!(self.boundary, Boundary::Prescribed { .. }) {
            return Err(BoundaryError::Course {
                course: "a region that follows its matter",
                allowed: "of a prescribed velocity",
            });
        }
        self.course = Course::Followed;
        Ok(self)
    }

    /// Book impulse and work of the condition to an account of [`Exchange::accounts`], beside those of all conditions. Conditions with the
    /// same account are added up.
    ///
    /// # Errors
    /// An account beyond [`ACCOUNTS`].
    pub fn with_account(mut self, account: usize) -> Result<Self, BoundaryError> {
        if account >= ACCOUNTS {
            return Err(BoundaryError::Account { account, count: ACCOUNTS });
        }
        self.account = Some(account);
        Ok(self)
    }

    /// Boundary condition at the start.
    #[must_use]
    pub fn boundary(&self) -> &Boundary<D> {
        &self.boundary
    }
    /// Account of the condition, if it has one.
    #[must_use]
    pub fn account(&self) -> Option<usize> {
        self.account
    }
    /// True if the region of the condition follows its matter.
    #[must_use]
    pub fn follows(&self) -> bool {
        matches!(self.course, Course::Followed)
    }

    /// Replace the boundary condition; motion and account stay.
    #[must_use]
    pub fn map(mut self, change: impl FnOnce(Boundary<D>) -> Boundary<D>) -> Self {
        self.boundary = change(self.boundary);
        self
    }

    /// Let the condition stay in place, for methods whose positions are those of the reference configuration, where matter stays in place.
    #[must_use]
    pub fn in_reference(mut self) -> Self {
        if self.follows() {
            self.course = Course::Own;
        }
        self
    }

    /// Replace a wall without friction that never moves by a plane of symmetry, which does not let go of matter: for liquids, whose
    /// pressure beside it is then that of the liquid and its mirror image.
    #[must_use]
    pub fn as_symmetry(mut self) -> Self {
        if let (&Boundary::Wall { axis, at, side, velocity: 0.0 }, Course::Own) =
            (&self.boundary, &self.course)
        {
            self.boundary = Boundary::Symmetry { axis, at, side };
        }
        self
    }

    fn require_wall(&self, course: &'static str) -> Result<(), BoundaryError> {
        let allowed = "of a wall, with or without friction";
        if self.boundary.is_wall() { Ok(()) } else { Err(BoundaryError::Course { course, allowed }) }
    }

    /// Return the axis of a wall and its position at the start, m.
    fn wall(&self) -> Option<(usize, f64)> {
        match self.boundary {
            Boundary::Wall { axis, at, .. } | Boundary::FrictionWall { axis, at, .. } => Some((axis, at)),
            _ => None,
        }
    }

    /// Return the displacement in the step of `dt` from `time`, s, after the displacement `before`, m.
    fn displacement_after(&self, before: [f64; D], time: f64, dt: f64) -> [f64; D] {
        match &self.course {
            Course::Own => before,
            Course::Velocity(v) => {
                let [a, b, c] = [time, time + 0.5 * dt, time + dt].map(|t| v(t));
                std::array::from_fn(|d| before[d] + dt / 6.0 * (a[d] + 4.0 * b[d] + c[d]))
            }
            Course::Position(position) => {
                let mut after = [0.0; D];
                if let Some((axis, at)) = self.wall() {
                    after[axis] = position(time + dt) - at;
                }
                after
            }
            Course::Followed => {
                // Matter moves with the velocity at the end of the step.
                let Boundary::Prescribed { velocity, .. } = &self.boundary else { return before };
                let v = velocity(time + dt);
                std::array::from_fn(|d| before[d] + dt * v[d].unwrap_or(0.0))
            }
        }
    }

    /// Return the condition of the step of `dt` from `time`, s, with the displacements at its start and its end, m.
    fn in_step(&self, [start, end]: [[f64; D]; 2], time: f64, dt: f64) -> Boundary<D> {
        let rate: [f64; D] = std::array::from_fn(|d| nonzero((end[d] - start[d]) / dt));
        // A wall at `at` + `velocity` t is at its displacement at both ends of the step.
        match self.boundary {
            Boundary::Wall { axis, at, side, .. } => {
                let velocity = rate[axis];
                Boundary::Wall { axis, at: at + start[axis] - velocity * time, side, velocity }
            }
            Boundary::FrictionWall { axis, at, side, friction, velocity } => {
                let mut along = if matches!(self.course, Course::Position(_)) { velocity } else { rate };
                along[axis] = rate[axis];
                let at = at + start[axis] - rate[axis] * time;
                Boundary::FrictionWall { axis, at, side, velocity: along, friction }
            }
            Boundary::Prescribed { ref region, ref velocity } => Boundary::Prescribed {
                region: Arc::new(Shifted { region: region.clone(), by: start }),
                velocity: velocity.clone(),
            },
            ref other => other.clone(),
        }
    }

    /// Describe the condition for comparison with checkpoints.
    fn constants(&self, times: [f64; 2]) -> String {
        let course = match &self.course {
            Course::Own => String::new(),
            Course::Velocity(v) => format!(" with the velocity {} m/s", over(times, |t| v(t))),
            Course::Position(x) => format!(" at {} m", over(times, |t| x(t))),
            Course::Followed => " that follows its matter".into(),
        };
        let account = self.account.map_or(String::new(), |n| format!(" in account {n}"));
        format!("{}{course}{account}", Condition::constants(&self.boundary, times))
    }
}

/// Return a velocity, m/s, that is not zero: methods treat walls of zero velocity as ones at rest.
fn nonzero(velocity: f64) -> f64 {
    if velocity == 0.0 { f64::MIN_POSITIVE } else { velocity }
}

/// Region at a displacement, m.
struct Shifted<const D: usize> {
    region: Arc<dyn Shape<D>>,
    by: [f64; D],
}

impl<const D: usize> Shape<D> for Shifted<D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        self.region.signed_distance(std::array::from_fn(|d| x[d] - self.by[d]))
    }
    fn bounds(&self) -> Bounds<D> {
        let Bounds { min, max } = self.region.bounds();
        Bounds {
            min: std::array::from_fn(|d| min[d] + self.by[d]),
            max: std::array::from_fn(|d| max[d] + self.by[d]),
        }
    }
}

/// Boundary conditions of a scene in the order in which they act ([`Boundaries::add`]). As a slice they are those of the present step.
#[derive(Clone, Debug, Default)]
pub struct Boundaries<const D: usize> {
    /// Conditions of the present step.
    list: Vec<Boundary<D>>,
    entries: Vec<BoundaryEntry<D>>,
    /// Displacements at the end of the last step, m.
    displacements: Vec<[f64; D]>,
}

impl<const D: usize> Deref for Boundaries<D> {
    type Target = [Boundary<D>];
    fn deref(&self) -> &[Boundary<D>] {
        &self.list
    }
}

impl<'a, const D: usize> IntoIterator for &'a Boundaries<D> {
    type Item = &'a Boundary<D>;
    type IntoIter = std::slice::Iter<'a, Boundary<D>>;
    fn into_iter(self) -> Self::IntoIter {
        self.list.iter()
    }
}

impl<const D: usize> Boundaries<D> {
    /// Entries of the conditions, as they were added, in their order.
    #[must_use]
    pub fn entries(&self) -> &[BoundaryEntry<D>] {
        &self.entries
    }

    /// Add a condition at its place in the order: planes of symmetry and walls, fixed planes, prescribed velocities, then those that react
    /// (friction, dashpots, custom conditions), each in the order of addition. Where conditions overlap, prescribed velocities thus prevail
    /// over fixed ones, and friction acts on the constrained motion.
    pub fn add(&mut self, entry: impl Into<BoundaryEntry<D>>) {
        let entry = entry.into();
        let place = entry.boundary.place_in(&self.list);
        let mut first = entry.boundary.clone();
        if !matches!(entry.course, Course::Own | Course::Followed) {
            first = entry.in_step([[0.0; D]; 2], 0.0, 1.0);
        }
        self.list.insert(place, first);
        self.entries.insert(place, entry);
        self.displacements.insert(place, [0.0; D]);
    }

    /// Move the conditions through the step of `dt` from `time`, s. Call it once in every step, before any condition is applied.
    pub fn advance(&mut self, time: f64, dt: f64) {
        for (n, entry) in self.entries.iter().enumerate() {
            if matches!(entry.course, Course::Own) {
                continue;
            }
            let start = match entry.course {
                Course::Position(_) => entry.displacement_after([0.0; D], time, 0.0),
                _ => self.displacements[n],
            };
            let end = entry.displacement_after(start, time, dt);
            self.list[n] = entry.in_step([start, end], time, dt);
            self.displacements[n] = end;
        }
    }

    /// Check that the motion of walls is finite at `times`, s.
    fn check_courses(&self, times: &[f64]) -> Result<(), SceneError> {
        for (n, entry) in self.entries.iter().enumerate() {
            for &time in times {
                let values = match &entry.course {
                    Course::Velocity(v) => v(time),
                    Course::Position(x) => [x(time); D],
                    Course::Own | Course::Followed => continue,
                };
                if let Some(&value) = values.iter().find(|x| !x.is_finite()) {
                    let what = format!("motion of the wall of boundary {n}");
                    return Err(SceneError::NotFinite { what, value, time });
                }
            }
        }
        Ok(())
    }

    /// True if any condition has an account.
    #[must_use]
    pub fn has_accounts(&self) -> bool {
        self.entries.iter().any(|entry| entry.account.is_some())
    }

    /// Account of the condition `n` of the list.
    #[must_use]
    pub fn account(&self, n: usize) -> Option<usize> {
        self.entries.get(n)?.account
    }

    /// Place of the wall `n` of the list along its axis at `time`, s, m; for a motion over time that at the end of the last step.
    #[must_use]
    pub fn wall_at(&self, n: usize, time: f64) -> Option<f64> {
        let entry = self.entries.get(n)?;
        let (axis, at) = entry.wall()?;
        match (&entry.course, &entry.boundary) {
            (Course::Own, Boundary::Wall { velocity, .. }) => Some(at + velocity * time),
            (Course::Own, Boundary::FrictionWall { velocity, .. }) => Some(at + velocity[axis] * time),
            _ => Some(at + self.displacements.get(n)?[axis]),
        }
    }

    /// Account of the first plane of symmetry across an axis.
    #[must_use]
    pub fn symmetry_account(&self, across: usize) -> Option<usize> {
        let is = |b: &Boundary<D>| matches!(*b, Boundary::Symmetry { axis, .. } if axis == across);
        self.account(self.list.iter().position(is)?)
    }

    /// Book an impulse of planes of symmetry, N s, to their accounts, by the axes across them.
    pub fn book_symmetry(&self, impulse: &[f64; 3], given: &mut Exchange) {
        if !self.has_accounts() {
            return;
        }
        for (d, part) in impulse.iter().enumerate() {
            if let Some(account) = self.symmetry_account(d) {
                given.accounts[account].impulse[d] += part;
            }
        }
    }

    /// Apply the condition `n` to a point, as [`Boundary::hold`], and book it to its account, too.
    #[inline]
    pub fn hold(&self, n: usize, p: &mut MovingPoint<D>, step: (f64, f64), given: &mut Exchange) {
        let Some(account) = self.entries[n].account else { return self.list[n].hold(p, step, given) };
        let (before, work) = (p.velocity, given.work);
        self.list[n].hold(p, step, given);
        let booking = &mut given.accounts[account];
        (0..D).for_each(|d| booking.impulse[d] += p.mass * (p.velocity[d] - before[d]));
        booking.work += given.work - work;
    }

    /// Apply the constraints of the conditions selected by `acts` to the velocity of a grid node at `x`, as [`Boundary::constrain`], and
    /// book impulse and work of each to its account. `mass`, kg, is that of the node, times the share that particles receive. The sums of
    /// all conditions are left to the caller.
    pub fn constrain(
        &self,
        acts: impl Fn(usize, &Boundary<D>) -> bool,
        x: &[f64; D],
        v: &mut [f64; 3],
        (time, tolerance, copies): (f64, f64, f64),
        mass: f64,
        given: &mut Exchange,
    ) {
        for (n, (boundary, entry)) in self.list.iter().zip(&self.entries).enumerate() {
            if !acts(n, boundary) {
                continue;
            }
            let before = *v;
            boundary.constrain(x, v, time, tolerance, copies);
            let Some(account) = entry.account else { continue };
            let booking = &mut given.accounts[account];
            for d in 0..3 {
                let impulse = mass * (v[d] - before[d]);
                booking.impulse[d] += impulse;
                booking.work += impulse * v[d];
            }
        }
    }

    /// Return the accounts of the conditions that determine the velocity of a grid node at `x` along each axis.
    pub fn constraining(
        &self,
        x: &[f64; D],
        (time, tolerance, copies): (f64, f64, f64),
    ) -> [Option<usize>; 3] {
        let mut accounts = [None; 3];
        if !self.has_accounts() {
            return accounts;
        }
        for (boundary, entry) in self.list.iter().zip(&self.entries).filter(|(b, _)| !b.is_wall()) {
            let probe = [f64::MAX; 3];
            let mut v = probe;
            boundary.constrain(x, &mut v, time, tolerance, copies);
            (0..3).filter(|&d| v[d] != probe[d]).for_each(|d| accounts[d] = entry.account);
        }
        accounts
    }

    /// Write or read what changes in a run, and store or compare the constants; `times` are the start and now, s, `of` completes the name
    /// of a constant.
    ///
    /// # Errors
    /// I/O error; damaged file; other conditions.
    pub fn archive(
        &mut self,
        file: &mut Archive,
        times: [f64; 2],
        of: &dyn Fn(&str) -> String,
    ) -> Result<(), CheckpointError> {
        file.same(&of("number of boundaries"), &self.entries.len().to_string())?;
        for (n, entry) in self.entries.iter().enumerate() {
            file.same(&of(&format!("boundary {n}")), &entry.constants(times))?;
        }
        self.displacements.iter_mut().try_for_each(|x| file.reals(x))
    }
}

/// Check that a body force at `time`, s, and prescribed velocities and motions of walls at `times`, s, are finite.
///
/// # Errors
/// [`SceneError::NotFinite`].
pub fn check_at<const D: usize>(
    body_force: Option<&BodyForce<D>>,
    boundaries: &Boundaries<D>,
    time: f64,
    times: &[f64],
) -> Result<(), SceneError> {
    let check = |what: &dyn Fn() -> String, values: &[f64], time: f64| {
        let wrong = values.iter().find(|x| !x.is_finite());
        wrong.map_or(Ok(()), |&value| Err(SceneError::NotFinite { what: what(), value, time }))
    };
    if let Some(force) = body_force {
        check(&|| "body force".into(), &force(time), time)?;
    }
    for (n, boundary) in boundaries.iter().enumerate() {
        let Boundary::Prescribed { velocity, .. } = boundary else { continue };
        for &time in times {
            let prescribed = velocity(time).map(|v| v.unwrap_or_default());
            check(&|| format!("velocity prescribed by boundary {n}"), &prescribed, time)?;
        }
    }
    boundaries.check_courses(times)
}

#[cfg(test)]
mod tests {
    use impactite_geometry::Cuboid;

    use super::*;
    use crate::condition::Side;

    fn wall() -> Boundary<2> {
        Boundary::Wall { axis: 0, at: 2.0, side: Side::Above, velocity: 0.0 }
    }

    /// Position of the wall of the list at a time, m.
    fn position(list: &Boundaries<2>, time: f64) -> f64 {
        match list[0] {
            Boundary::Wall { at, velocity, .. } => at + velocity * time,
            _ => f64::NAN,
        }
    }

    #[test]
    fn walls_follow_their_velocity_and_their_position() {
        let velocity = BoundaryEntry::from(wall()).with_velocity(Arc::new(|t| [3.0 * t * t, 0.0]));
        let place = BoundaryEntry::from(wall()).with_position(Arc::new(|t| 2.0 + t * t * t));
        for entry in [velocity, place] {
            let mut list = Boundaries::default();
            list.add(entry.expect("a wall"));
            assert!(
                list[0].edge(&impactite_geometry::Lattice::new([0.0; 2], 1.0).expect("a lattice")).is_none()
            );
            let mut time = 0.0f64;
            for dt in [0.5, 0.125, 1.0] {
                list.advance(time, dt);
                // Both ends of the secant are on the path; rounding of a handful of operations.
                for t in [time, time + dt] {
                    assert!((position(&list, t) - (2.0 + t * t * t)).abs() < 1e-14, "at {t}");
                }
                time += dt;
            }
        }
    }

    #[test]
    fn a_region_follows_the_matter_that_it_moves() {
        let region = Arc::new(Cuboid::new([0.0, 0.0], [1.0, 1.0]).expect("a box"));
        let velocity: crate::boundary::VelocityHistory = Arc::new(|t| [Some(4.0 * t), None, None]);
        let grip =
            BoundaryEntry::from(Boundary::Prescribed { region, velocity }).following().expect("a grip");
        let mut list = Boundaries::default();
        list.add(grip.with_account(3).expect("an account"));
        let mut point = MovingPoint {
            position: [0.999, 0.5],
            mass: 2.0,
            start: [0.0; 2],
            velocity: [0.0; 2],
            size: 1.0,
            depth: 0.5,
            tolerance: 1e-6,
        };
        let (mut time, dt, mut given) = (0.0, 0.25, Exchange::default());
        for _ in 0..40 {
            list.advance(time, dt);
            point.start = point.velocity;
            list.hold(0, &mut point, (time, dt), &mut given);
            (0..2).for_each(|d| point.position[d] += dt * point.velocity[d]);
            time += dt;
        }
        assert_eq!(point.velocity, [40.0, 0.0], "the point left its grip");
        assert_eq!(given.accounts[3].impulse, [80.0, 0.0, 0.0]);
        assert_eq!((given.impulse, given.accounts[2].impulse), ([80.0, 0.0, 0.0], [0.0; 3]));
        // All work became kinetic energy: the numbers are sums of powers of two.
        assert_eq!((given.accounts[3].work, given.work), (1600.0, 1600.0));
    }

    #[test]
    fn motions_and_accounts_that_do_not_exist_are_refused() {
        let fixed = || BoundaryEntry::from(Boundary::<2>::Fixed { axis: 0, at: 0.0, side: Side::Above });
        assert!(matches!(fixed().with_velocity(Arc::new(|_| [0.0; 2])), Err(BoundaryError::Course { .. })));
        assert!(matches!(fixed().with_position(Arc::new(|_| 0.0)), Err(BoundaryError::Course { .. })));
        assert!(matches!(fixed().following(), Err(BoundaryError::Course { .. })));
        let beyond = fixed().with_account(ACCOUNTS);
        assert!(matches!(beyond, Err(BoundaryError::Account { account: ACCOUNTS, count: ACCOUNTS })));
    }
}
