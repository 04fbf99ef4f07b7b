//! Contact of free rigid bodies with walls and with each other: plastic, without friction.

use crate::couple::{Cholesky, Support, forced, mass_of, product};
use crate::rigid::{Floater, Twist, slope};
use crate::wall::Walls;

/// Sweeps over all contacts.
const SWEEPS: usize = 30;
/// Share of a penetration that a step removes.
const REMOVED: f64 = 0.2;

/// Visitor of a point: place, normal, least relative velocity, m/s.
type Visit<'a, const D: usize> = dyn FnMut(&[f64; D], &[f64; D], f64) + 'a;

/// Point of a body near a wall.
struct Contact {
    body: usize,
    /// Free body that the wall is of.
    other: Option<usize>,
    /// Velocities of both that make the velocity along the normal, away from the wall.
    rows: [Twist; 2],
    /// Change of the velocities of both by a unit of impulse.
    answers: [Twist; 2],
    /// Velocity of a wall that is no free body, along the normal, m/s.
    wall: f64,
    /// Least relative velocity along the normal, m/s.
    least: f64,
    impulse: f64,
}

/// What contact of a step did.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Done {
    /// Impulse of walls on the bodies, N s.
    pub impulse: [f64; 3],
    /// Work of walls on the bodies, J.
    pub work: f64,
    /// Kinetic energy lost, beside this work, J.
    pub lost: f64,
}

/// Change the velocities of the bodies so that no point of a surface is within a wall or another body after `dt` seconds. `h` is the width
/// of a cell.
pub(crate) fn resolve<const D: usize>(
    bodies: &mut [Floater<D>],
    walls: &Walls<'_, D>,
    dt: f64,
    h: f64,
) -> Done {
    let mut contacts = Vec::new();
    for body in 0..bodies.len() {
        find(bodies, body, walls, (dt, h), &mut contacts);
    }
    if contacts.is_empty() {
        return Done::default();
    }
    let mut twists: Vec<Twist> = bodies.iter().map(|body| body.twist).collect();
    let along = product;
    for _ in 0..SWEEPS {
        for c in &mut contacts {
            let theirs = c.other.map_or(c.wall, |other| -along(&c.rows[1], &twists[other]));
            let speed = along(&c.rows[0], &twists[c.body]) - theirs;
            let answer = along(&c.rows[0], &c.answers[0]) + along(&c.rows[1], &c.answers[1]);
            if answer <= 0.0 {
                continue;
            }
            let impulse = (c.impulse + (c.least - speed) / answer).max(0.0);
            let by = impulse - c.impulse;
            c.impulse = impulse;
            for (which, answer) in [Some(c.body), c.other].into_iter().zip(&c.answers) {
                if let Some(which) = which {
                    (0..6).for_each(|m| twists[which][m] += by * answer[m]);
                }
            }
        }
    }
    let mut done = Done::default();
    for c in contacts.iter().filter(|c| c.impulse > 0.0) {
        for (which, row) in [Some(c.body), c.other].into_iter().zip(&c.rows) {
            let Some(which) = which else { continue };
            let old = bodies[which].start;
            let mean: Twist = std::array::from_fn(|m| 0.5 * (old[m] + twists[which][m]));
            done.lost -= c.impulse * along(row, &mean);
            (0..3).for_each(|d| bodies[which].acted.impulse[d] += c.impulse * row[d]);
        }
        if c.other.is_none() {
            (0..3).for_each(|d| done.impulse[d] += c.impulse * c.rows[0][d]);
            done.work += c.impulse * c.wall;
        }
    }
    for (body, twist) in bodies.iter_mut().zip(twists) {
        body.twist = twist;
        body.momentum = body.momentum_of(&twist);
    }
    done.lost += done.work;
    done
}

/// Find the contacts with walls, other than free bodies, that a body has after `dt` seconds of its free motion, with the body force over
/// `kick` seconds. `h` is the width of a cell.
pub(crate) fn supports<const D: usize>(
    body: &Floater<D>,
    walls: &Walls<'_, D>,
    (dt, kick): (f64, f64),
    h: f64,
) -> Vec<Support> {
    let mut free = body.clone();
    free.twist = body.twist_of(&forced(body, kick));
    let mut found = Vec::new();
    for n in (0..walls.list.len()).filter(|n| walls.list[*n].body.is_none()) {
        points_near(&free, n, walls, (dt, h), 0.0, &mut |x, normal, least| {
            let wall = (0..D).map(|d| walls.motions[n].component(x, d) * normal[d]).sum::<f64>();
            found.push(Support { row: free.row(x, normal), least: least + wall, wall });
        });
    }
    found
}

/// Find the points of a body that are within a wall or another body after `dt` seconds.
fn find<const D: usize>(
    bodies: &[Floater<D>],
    number: usize,
    walls: &Walls<'_, D>,
    (dt, h): (f64, f64),
    contacts: &mut Vec<Contact>,
) {
    let body = &bodies[number];
    let invert = |body: &Floater<D>| Cholesky::new(&mass_of(body), *body.held());
    let own = invert(body);
    for n in (0..walls.list.len()).filter(|n| walls.list[*n].body != Some(number)) {
        let other = walls.list[n].body;
        let theirs = other.map_or(0.0, |k| bodies[k].speed() * dt);
        points_near(body, n, walls, (dt, h), theirs, &mut |x, normal, least| {
            let wall = (0..D).map(|d| walls.motions[n].component(x, d) * normal[d]).sum::<f64>();
            let away = normal.map(|n| -n);
            let rows = [body.row(x, normal), other.map_or([0.0; 6], |k| bodies[k].row(x, &away))];
            let answer = |k: usize| invert(&bodies[k]).solve(&rows[1]);
            let answers = [own.solve(&rows[0]), other.map_or([0.0; 6], answer)];
            contacts.push(Contact { body: number, other, rows, answers, wall, least, impulse: 0.0 });
        });
    }
}

/// Visit the points of a body that are within wall `n` after `dt` seconds: place, normal, and least relative velocity along it, m/s.
/// `theirs` is how far the wall itself moves, m.
fn points_near<const D: usize>(
    body: &Floater<D>,
    n: usize,
    walls: &Walls<'_, D>,
    (dt, h): (f64, f64),
    theirs: f64,
    visit: &mut Visit<'_, D>,
) {
    let (pose, motion) = (body.pose(), body.motion());
    let way = body.speed() * dt;
    if walls.gap_of(n, &body.centre) > way + body.radius + theirs + h {
        return;
    }
    for point in body.surface.iter() {
        let x = pose.there(point);
        let gap = walls.gap_of(n, &x);
        if gap > 2.0 * (way + theirs) + h {
            continue;
        }
        let steep = slope(&|x| walls.gap_of(n, &x), &x, 1e-4 * h);
        let length = steep.iter().map(|s| s * s).sum::<f64>().sqrt();
        if length < 0.1 {
            continue;
        }
        let normal: [f64; D] = std::array::from_fn(|d| steep[d] / length);
        let speed: f64 =
            (0..D).map(|d| (motion.component(&x, d) - walls.motions[n].component(&x, d)) * normal[d]).sum();
        let least = if gap > 0.0 { -gap / dt } else { -REMOVED * gap / dt };
        if speed < least {
            visit(&x, &normal, least);
        }
    }
}
