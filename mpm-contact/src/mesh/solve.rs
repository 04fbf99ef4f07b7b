//! Solution for the impulses of all contacts: projected Gauss-Seidel with the laws as local solvers.
//!
//! A contact of a point p with the place x_c = sum N_a x_a of a facet changes their relative velocity by (1/m_p + sum N_a^2 / m_a) J, the
//! same in all directions: the law, called with the masses m_p and 1 / sum(N_a^2 / m_a) and with both velocities without J, solves it
//! exactly. For a carried point ([`super::Carriers`]) 1/m_p is sum_i N_ip^2 / m_i in the direction where that is largest: near planes of
//! symmetry it differs by direction, and too large a value only takes more sweeps. The normal velocity passed to the law is reduced by the
//! closure of the gap, (gap - target) / dt, so that its rule for bodies in contact applies at the end of the step.
//!
//! For frictionless contacts each of these steps optimises the dual of |v - v*|^2 (masses as weights) under the constraints gap + u_n dt >=
//! target; the dual rises from zero, so that the kinetic energy after any number of sweeps is at most that before if no gap is below its
//! target \[Moreau1999\], \[JourdanAlartJean1998\].

use impactite_geometry::Facet;
use impactite_simd::Team;

use super::body::ContactBody;
use super::detect::Touch;
use super::side::Facing;
use crate::law::{Contact, ContactLaw, Pairs};
use crate::vector::{difference, dot, length, sum, times, wide};

type Vector = [f64; 3];

/// Maximum number of sweeps of a solution.
pub(super) const SWEEPS: usize = 200;
/// Convergence tolerance: change of velocity in a sweep, over the largest change by contact.
const FOUND: f64 = 1e-6;
/// Rounding tolerance: change of velocity, over the velocities in contact.
const ROUNDING: f64 = 1e-14;
/// Gap up to which a law that pulls acts, over the spacing.
const HOLDS: f64 = 1e-3;
/// Least number of contacts per task, if there are as many: whole islands of coupled contacts.
const BATCH: usize = 128;

/// State on which the contacts act.
pub(super) struct World<'a, const D: usize> {
    pub bodies: &'a [ContactBody<'a, D>],
    /// Velocities of all points of each body, m/s.
    pub velocities: &'a mut [Vec<Vector>],
    /// Velocities of the nodes that carry points of a body, m/s; empty for other bodies.
    pub carrying: &'a mut [Vec<Vector>],
    pub sides: &'a [Facing<D>],
    pub laws: &'a Pairs<f64>,
    pub time: f64,
    pub dt: f64,
    pub axisymmetric: bool,
}

/// Convergence of a solution.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Found {
    pub sweeps: usize,
    /// Last change of a velocity, times the step, m.
    pub residual: f64,
}

/// Local problem of one contact in a batch.
struct Local<'a> {
    law: &'a dyn ContactLaw<f64>,
    contact: Contact<'static, f64>,
    /// True if the point's body is the first of the contact.
    point_first: bool,
    pulls: bool,
    normal: Vector,
    /// Reduction of the approach velocity, m/s.
    shift: f64,
    held: bool,
    /// Bounds of its links in the batch: those of the point, then those of the facet's nodes.
    links: [usize; 3],
    /// Inverse masses 1/m_p and sum N_a^2 / m_a, 1/kg.
    inverse: [f64; 2],
    impulse: Vector,
}

/// Link of a contact to a mover: the relative velocity is the sum of shares times velocities, by direction, and impulses change the mover's
/// by gains.
#[derive(Clone, Copy)]
struct Link {
    mover: usize,
    share: Vector,
    gain: Vector,
}

#[derive(Default)]
struct Batch {
    contacts: Vec<u32>,
    /// Number of contacts of each island, in order.
    lengths: Vec<usize>,
    movers: Vec<u32>,
    velocities: Vec<Vector>,
    impulses: Vec<Vector>,
    found: Found,
}

impl<const D: usize> World<'_, D> {
    /// Point, and nodes with their weights: body, number, share of the relative velocity.
    pub fn shares(&self, touch: &Touch) -> impl Iterator<Item = (usize, usize, f64)> {
        let [of_point, of_facet] = self.sides[touch.side as usize].bodies;
        let nodes = touch.nodes.into_iter().zip(touch.weights);
        let nodes = nodes.filter(|(n, w)| *n != Facet::NONE && *w > 0.0);
        std::iter::once((of_point, touch.point as usize, 1.0))
            .chain(nodes.map(move |(n, w)| (of_facet, n as usize, -w)))
    }

    /// Movers of a contact: the point or the nodes that carry it, and the facet's nodes: body, number, share of the relative velocity in
    /// each direction.
    fn movers(&self, touch: &Touch) -> impl Iterator<Item = (usize, usize, Vector)> {
        let [of_point, _] = self.sides[touch.side as usize].bodies;
        let carriers = self.bodies[of_point].carriers;
        let carrying = carriers.map_or(&[][..], |carriers| carriers.of(touch.point as usize));
        let carrying = carrying.iter().map(move |(node, weight)| (of_point, *node as usize, wide(weight)));
        let itself = usize::from(carriers.is_some());
        carrying.chain(self.shares(touch).skip(itself).map(|(body, n, share)| (body, n, [share; 3])))
    }

    fn starts(&self) -> Vec<usize> {
        let mut starts = vec![0];
        for body in self.bodies {
            starts.push(starts[starts.len() - 1] + body.movers().1.len());
        }
        starts
    }

    fn of_movers(&mut self, body: usize) -> &mut Vec<Vector> {
        if self.bodies[body].carriers.is_some() {
            &mut self.carrying[body]
        } else {
            &mut self.velocities[body]
        }
    }

    /// Solve for the impulses of all contacts, and update velocities by them; islands without contacts from number `first` on are
    /// unchanged.
    pub fn solve(&mut self, touches: &mut [Touch], first: usize, team: &Team) -> Found {
        let starts = self.starts();
        let mut batches = self.batches(touches, first, &starts);
        let world = &*self;
        team.each(&mut batches, |_, batch| world.sweep(touches, &starts, batch));
        let mut found = Found::default();
        for batch in &batches {
            found.sweeps = found.sweeps.max(batch.found.sweeps);
            found.residual = found.residual.max(batch.found.residual);
            for (&c, impulse) in batch.contacts.iter().zip(&batch.impulses) {
                touches[c as usize].impulse = *impulse;
            }
            for (&mover, v) in batch.movers.iter().zip(&batch.velocities) {
                let (body, n) = place(&starts, mover);
                self.of_movers(body)[n] = *v;
            }
        }
        for (n, body) in self.bodies.iter().enumerate() {
            if let Some(carriers) = body.carriers {
                self.velocities[n] = carriers.carried(&self.carrying[n]);
            }
        }
        found
    }

    /// Group contacts into batches without a common movable mass.
    fn batches(&self, touches: &[Touch], first: usize, starts: &[usize]) -> Vec<Batch> {
        const FREE: u32 = u32::MAX;
        let mut parents: Vec<u32> = vec![FREE; starts[starts.len() - 1]];
        fn root(parents: &mut [u32], mut n: u32) -> u32 {
            while parents[n as usize] != n {
                parents[n as usize] = parents[parents[n as usize] as usize];
                n = parents[n as usize];
            }
            n
        }
        let mut firsts = Vec::with_capacity(touches.len());
        for touch in touches {
            let mut joined = FREE;
            for (body, n, _) in self.movers(touch) {
                if self.bodies[body].movers().1[n].is_infinite() {
                    continue;
                }
                let mover = (starts[body] + n) as u32;
                if parents[mover as usize] == FREE {
                    parents[mover as usize] = mover;
                }
                let here = root(&mut parents, mover);
                if joined != FREE {
                    parents[joined.max(here) as usize] = joined.min(here);
                }
                joined = joined.min(here);
            }
            firsts.push(joined);
        }
        // Islands in the order of their first contact.
        let mut islands: Vec<Vec<u32>> = Vec::new();
        let mut numbers = vec![FREE; parents.len()];
        for (c, &mover) in firsts.iter().enumerate().filter(|(_, mover)| **mover != FREE) {
            let root = root(&mut parents, mover);
            if numbers[root as usize] == FREE {
                numbers[root as usize] = islands.len() as u32;
                islands.push(Vec::new());
            }
            islands[numbers[root as usize] as usize].push(c as u32);
        }
        let mut batches: Vec<Batch> = Vec::new();
        let is_new = |contacts: &Vec<u32>| contacts.last().is_some_and(|&c| c as usize >= first);
        for contacts in islands.into_iter().filter(is_new) {
            let length = contacts.len();
            match batches.last_mut().filter(|batch| batch.contacts.len() < BATCH) {
                Some(batch) => {
                    batch.contacts.extend(contacts);
                    batch.lengths.push(length);
                }
                None => batches.push(Batch { contacts, lengths: vec![length], ..Batch::default() }),
            }
        }
        batches
    }

    fn local(&self, touch: &Touch, starts: &[usize], movers: &[u32], links: &mut Vec<Link>) -> Local<'_> {
        let [of_point, of_facet] = self.sides[touch.side as usize].bodies;
        let law = self.laws.law(of_point, of_facet);
        let point_first = of_point <= of_facet;
        let (mut inverse, mut position) = ([[0.0; 3]; 2], [0.0; 3]);
        let mut ends = [links.len(); 3];
        let of_point_alone = self.bodies[of_point].carriers.map_or(1, |c| c.of(touch.point as usize).len());
        for (k, (body, n, share)) in self.movers(touch).enumerate() {
            let mover = (starts[body] + n) as u32;
            let mover = movers.binary_search(&mover).unwrap_or(0);
            let gain = times(share, 1.0 / self.bodies[body].movers().1[n]);
            links.push(Link { mover, share, gain });
            let side = usize::from(k >= of_point_alone);
            (0..3).for_each(|d| inverse[side][d] += share[d] * gain[d]);
            if side == 0 {
                ends[1] = links.len();
            } else {
                position = difference(position, times(self.bodies[body].position(n), share[0]));
            }
        }
        ends[2] = links.len();
        let inverse = inverse.map(|by_axis| by_axis.into_iter().fold(0.0, f64::max));
        let area = if D == 2 { touch.spacing } else { touch.spacing * touch.spacing };
        let area = if self.axisymmetric { area * position[0].abs() } else { area };
        let masses = inverse.map(|i| 1.0 / i);
        let ordered = |[p, s]: [f64; 2]| if point_first { [p, s] } else { [s, p] };
        let contact = Contact {
            bodies: [of_point.min(of_facet), of_point.max(of_facet)],
            position,
            time: self.time,
            dt: self.dt,
            normal: if point_first { times(touch.normal, -1.0) } else { touch.normal },
            gap: Some(touch.gap),
            area,
            masses: ordered(masses),
            velocities: [[0.0; 3]; 2],
            slip: 0.0,
            memory: &[],
        };
        let shift = if law.springs() { 0.0 } else { (touch.gap - touch.target) / self.dt };
        Local {
            law,
            contact,
            point_first,
            pulls: law.pulls(),
            normal: touch.normal,
            shift,
            held: touch.gap <= HOLDS * touch.spacing,
            links: ends,
            inverse,
            impulse: touch.impulse,
        }
    }

    fn sweep(&self, touches: &[Touch], starts: &[usize], batch: &mut Batch) {
        let of = |c: &u32| &touches[*c as usize];
        let mover = |(body, n, _): (usize, usize, Vector)| (starts[body] + n) as u32;
        batch.movers = batch.contacts.iter().flat_map(|c| self.movers(of(c)).map(mover)).collect();
        batch.movers.sort_unstable();
        batch.movers.dedup();
        let velocity = |&mover: &u32| {
            let (body, n) = place(starts, mover);
            if self.bodies[body].carriers.is_some() {
                self.carrying[body][n]
            } else {
                self.velocities[body][n]
            }
        };
        batch.velocities = batch.movers.iter().map(velocity).collect();
        let mut links = Vec::with_capacity(5 * batch.contacts.len());
        let local = |c| self.local(of(c), starts, &batch.movers, &mut links);
        let mut locals: Vec<_> = batch.contacts.iter().map(local).collect();
        let mut rest = &mut locals[..];
        for &length in &batch.lengths {
            let (island, others) = rest.split_at_mut(length);
            let found = relax(island, &links, &mut batch.velocities, self.dt);
            batch.found.sweeps = batch.found.sweeps.max(found.sweeps);
            batch.found.residual = batch.found.residual.max(found.residual);
            rest = others;
        }
        batch.impulses = locals.iter().map(|local| local.impulse).collect();
    }
}

/// Sweep over an island until convergence.
fn relax(island: &mut [Local<'_>], links: &[Link], velocities: &mut [Vector], dt: f64) -> Found {
    let mut residual = 0.0;
    for sweep in 1..=SWEEPS {
        let (mut change, mut enough) = (0.0_f64, 0.0_f64);
        let mut take = |local: &mut Local<'_>| {
            let [step, whole, speed] = local.relax(links, velocities);
            change = change.max(step);
            enough = enough.max(FOUND * whole + ROUNDING * speed);
        };
        // Alternate directions, so that a change at one end of a row reaches the other.
        match sweep % 2 {
            1 => island.iter_mut().for_each(&mut take),
            _ => island.iter_mut().rev().for_each(&mut take),
        }
        if change <= enough {
            return Found { sweeps: sweep, residual: 0.0 };
        }
        residual = change * dt;
    }
    Found { sweeps: SWEEPS, residual }
}

impl Local<'_> {
    /// Update the impulse of this contact by its law, with all others fixed. Returns the change of the relative velocity, its change by the
    /// whole impulse, and the magnitude of velocities, m/s.
    fn relax(&mut self, links: &[Link], velocities: &mut [Vector]) -> [f64; 3] {
        let [first, middle, end] = self.links;
        let carried = |links: &[Link]| {
            links.iter().fold([0.0; 3], |total, link| sum(total, product(velocities[link.mover], link.share)))
        };
        let (mut point, mut place) = (carried(&links[first..middle]), carried(&links[middle..end]));
        place = times(place, -1.0);
        let speed = length(point) + length(place);
        // Remove its own impulse.
        point = difference(point, times(self.impulse, self.inverse[0]));
        place = sum(place, times(self.impulse, self.inverse[1]));
        let parting = dot(difference(point, place), self.normal);
        let wanted = if self.pulls && !self.held && parting + self.shift > 0.0 {
            [0.0; 3]
        } else {
            point = sum(point, times(self.normal, self.shift));
            let velocities = if self.point_first { [point, place] } else { [place, point] };
            let on_second = self.law.impulse(&Contact { velocities, ..self.contact });
            times(on_second, if self.point_first { -1.0 } else { 1.0 })
        };
        let step = difference(wanted, self.impulse);
        if step != [0.0; 3] {
            for link in &links[first..end] {
                velocities[link.mover] = sum(velocities[link.mover], product(step, link.gain));
            }
            self.impulse = wanted;
        }
        let whole = self.inverse[0] + self.inverse[1];
        [length(step) * whole, length(wanted) * whole, speed]
    }
}

fn product(a: Vector, b: Vector) -> Vector {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

/// Body and number of a mover.
fn place(starts: &[usize], mover: u32) -> (usize, usize) {
    let body = starts.partition_point(|&start| start <= mover as usize) - 1;
    (body, mover as usize - starts[body])
}
