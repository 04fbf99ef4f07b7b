//! Particle surfaces at a wall, and their contact constraints ([`super::meet_walls`]).

use crate::step::clients::near_particles::{FOUND, NearParticles, SWEEPS};

/// Ratio of surface mass acting on a node behind a wall to nodal mass, above which the node is tied to the one in front.
const THIN: f64 = 10.0;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::boundary::{Boundary, Side};
use impactite_simd::{Arch, Float, Kernel};

/// Wall at the start of a step.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Plane<const D: usize> {
    pub(in crate::step) axis: usize,
    /// Direction of the wall force: +1 along the axis, else -1.
    pub(in crate::step) sign: f64,
    /// Position, m.
    pub(in crate::step) at: f64,
    /// Velocity, m/s; only its normal component for a frictionless wall.
    pub(in crate::step) velocity: [f64; D],
    pub(in crate::step) friction: f64,
    /// Account of the wall ([`impactite_scene::BoundaryEntry::with_account`]).
    pub(in crate::step) account: Option<usize>,
}

impl<const D: usize> Plane<D> {
    pub(in crate::step) fn of(boundary: &Boundary<D>, time: f64) -> Option<Self> {
        let (axis, at, side, velocity, friction) = match *boundary {
            Boundary::Wall { axis, at, side, velocity } => {
                let mut drag = [0.0; D];
                drag[axis] = velocity;
                (axis, at, side, drag, 0.0)
            }
            Boundary::FrictionWall { axis, at, side, velocity, friction } => {
                (axis, at, side, velocity, friction)
            }
            _ => return None,
        };
        let sign = if side == Side::Above { 1.0 } else { -1.0 };
        Some(Plane { axis, sign, at: at + velocity[axis] * time, velocity, friction, account: None })
    }
    /// Return the distance of a point in front of the wall, m.
    pub(in crate::step) fn distance(&self, x: &[f64; D]) -> f64 {
        (x[self.axis] - self.at) * self.sign
    }
}

/// State of a wall, kept from step to step, and the particles near it in the current step.
#[derive(Clone, Debug, Default)]
pub(in crate::step) struct AtWall<const D: usize> {
    /// Body and number of the particles in active contact, sorted.
    pub(in crate::step) pressing: Vec<(u32, usize)>,
    /// Particles whose surfaces may reach the wall, with weights at their surfaces.
    pub(in crate::step) near: NearParticles<D>,
    pub(in crate::step) surfaces: Vec<Surface>,
    /// Inverse effective masses of the nodes, 1/kg; zero for nodes that a condition constrains along the axis of the wall.
    pub(in crate::step) shown: Vec<f64>,
    /// Particles sorted by number, so that results do not depend on their storage.
    pub(in crate::step) order: Vec<usize>,
    /// Weights of the particles of `order` along the axis of the wall.
    pub(in crate::step) rows: Rows,
    /// Indices of nodes of almost no mass in the grid, which move with the wall.
    pub(in crate::step) light: Vec<u32>,
    /// Light nodes behind the wall, each with the node in front to which it is tied, by index in `near`.
    pub(in crate::step) tied: Vec<(u32, u32)>,
}

/// Surface of a particle at a wall.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Surface {
    /// Gap to the wall at the start of the step, m.
    pub(in crate::step) gap: f64,
    /// True if the contact was active in the previous step.
    pub(in crate::step) pressed: bool,
    /// True if the contact is active in this step.
    pub(in crate::step) presses: bool,
    /// Inverse of the effective mass of its nodes, 1/kg.
    pub(in crate::step) give: f64,
    /// Impulses of the wall force over the step (`force`) and of the velocity constraint (`stop`), N s, with effective
    /// masses.
    pub(in crate::step) force: f64,
    pub(in crate::step) stop: f64,
    /// Fractions of these impulses on unconstrained nodes.
    pub(in crate::step) passes: [f64; 2],
}

impl Surface {
    /// Return the impulse on unconstrained nodes, N s; particles receive the fraction `takes` of that of the velocity
    /// constraint.
    pub(in crate::step) fn given(&self, takes: f64) -> f64 {
        self.passes[0] * self.force + takes * self.passes[1] * self.stop
    }
}

/// Interpolate nodal values `of`, with the components of `weights` along an axis.
fn along<const D: usize>(weights: &[(u32, [f64; D])], axis: usize, of: &[f64]) -> f64 {
    weights.iter().map(|(node, weight)| weight[axis] * of[*node as usize]).sum()
}

/// Number of nodes to which rows of weights are extended, by zeros: a whole number of these.
const WIDTH: usize = 8;

/// Particles in order, in groups that act on the same nodes, with their weights along an axis.
#[derive(Clone, Debug, Default)]
pub(in crate::step) struct Rows {
    groups: Vec<Group>,
    /// Nodes of each group.
    nodes: Vec<u32>,
    /// Weights of each particle of a group on its nodes.
    weights: Vec<f64>,
    /// Values and effective masses at the nodes of a group.
    values: Vec<f64>,
    shown: Vec<f64>,
}

/// Group of particles with the same nodes: ranges of particles in order, of nodes, and start of the weights.
#[derive(Clone, Copy, Debug)]
struct Group {
    particles: [usize; 2],
    nodes: [usize; 2],
    weights: usize,
}

/// Weights of a particle, with the values at its nodes.
pub(in crate::step) struct Row<'a> {
    weights: &'a [f64],
    values: &'a mut [f64],
    shown: &'a [f64],
}

impl Row<'_> {
    /// Interpolate the values.
    #[inline(always)]
    fn sum(&self) -> f64 {
        let mut sums = [0.0; WIDTH];
        for (w, v) in self.weights.chunks_exact(WIDTH).zip(self.values.chunks_exact(WIDTH)) {
            (0..WIDTH).for_each(|i| sums[i] += w[i] * v[i]);
        }
        let four: [f64; 4] = std::array::from_fn(|i| sums[i] + sums[i + 4]);
        (four[0] + four[2]) + (four[1] + four[3])
    }
    /// Add an impulse of this size over the effective masses of the nodes.
    #[inline(always)]
    fn add(&mut self, size: f64) {
        if size != 0.0 {
            for ((value, weight), shown) in self.values.iter_mut().zip(self.weights).zip(self.shown) {
                *value += size * weight * shown;
            }
        }
    }
}

impl Rows {
    /// Arrange the weights of particles in this order along an axis.
    pub(in crate::step) fn arrange<const D: usize>(
        &mut self,
        near: &NearParticles<D>,
        order: &[usize],
        axis: usize,
    ) {
        self.groups.clear();
        self.nodes.clear();
        self.weights.clear();
        let mut before: &[(u32, [f64; D])] = &[];
        for (n, &p) in order.iter().enumerate() {
            let weights = near.weights(p);
            let same = weights.len() == before.len() && weights.iter().zip(before).all(|(a, b)| a.0 == b.0);
            match self.groups.last_mut().filter(|_| same) {
                Some(group) => group.particles[1] = n + 1,
                None => {
                    let nodes = [self.nodes.len(), self.nodes.len() + weights.len()];
                    self.groups.push(Group { particles: [n, n + 1], nodes, weights: self.weights.len() });
                    self.nodes.extend(weights.iter().map(|(node, _)| *node));
                }
            }
            self.weights.extend(weights.iter().map(|(_, weight)| weight[axis]));
            self.weights.resize(self.weights.len().next_multiple_of(WIDTH), 0.0);
            before = weights;
        }
    }

    /// Visit every particle of `order`, with its row of `values`, which it may change; `shown` are the inverse effective masses of the nodes.
    fn each(
        &mut self,
        (order, shown): (&[usize], &[f64]),
        values: &mut [f64],
        visit: impl FnMut(usize, &mut Row<'_>),
    ) {
        f64::dispatch(Sweep { rows: self, order, shown, values, visit });
    }

    /// Allocated memory, bytes.
    fn bytes(&self) -> usize {
        self.groups.capacity() * size_of::<Group>()
            + self.nodes.capacity() * size_of::<u32>()
            + (self.weights.capacity() + self.values.capacity() + self.shown.capacity()) * size_of::<f64>()
    }
}

/// Visit of all rows.
struct Sweep<'a, F> {
    rows: &'a mut Rows,
    order: &'a [usize],
    shown: &'a [f64],
    values: &'a mut [f64],
    visit: F,
}

impl<F: FnMut(usize, &mut Row<'_>)> Kernel<f64> for Sweep<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let Sweep { rows, order, shown, values, mut visit } = self;
        let Rows { groups, nodes, weights, values: of_group, shown: shown_of_group } = rows;
        for group in groups {
            let nodes = &nodes[group.nodes[0]..group.nodes[1]];
            of_group.clear();
            of_group.extend(nodes.iter().map(|node| values[*node as usize]));
            shown_of_group.clear();
            shown_of_group.extend(nodes.iter().map(|node| shown[*node as usize]));
            let width = nodes.len().next_multiple_of(WIDTH);
            of_group.resize(width, 0.0);
            shown_of_group.resize(width, 0.0);
            let particles = &order[group.particles[0]..group.particles[1]];
            for (n, &p) in particles.iter().enumerate() {
                let row = &weights[group.weights + n * width..][..width];
                visit(p, &mut Row { weights: row, values: of_group, shown: shown_of_group });
            }
            for (node, value) in nodes.iter().zip(&*of_group) {
                values[*node as usize] = *value;
            }
        }
    }
}

impl<const D: usize> AtWall<D> {
    /// Correct normal nodal velocities until active surfaces move with the wall, and others do not penetrate it within the
    /// step.
    pub(in crate::step) fn hold(&mut self, wall: &Plane<D>, velocities: &mut [f64], step: f64) {
        let drag = wall.velocity[wall.axis];
        self.surfaces.iter_mut().for_each(|surface| surface.stop = 0.0);
        for _ in 0..SWEEPS {
            let (mut changed, mut largest) = (0.0f64, 0.0f64);
            self.rows.each((&self.order, &self.shown), velocities, |p, row| {
                let surface = &mut self.surfaces[p];
                let gap = if surface.presses { 0.0 } else { surface.gap.max(0.0) };
                let excess = wall.sign * (row.sum() - drag) + gap / step;
                let wanted = surface.stop - excess / surface.give;
                let wanted = if surface.presses { wanted } else { wanted.max(0.0) };
                let more = wanted - surface.stop;
                surface.stop = wanted;
                (changed, largest) = (changed.max(more.abs()), largest.max(wanted.abs()));
                row.add(wall.sign * more);
            });
            if changed <= FOUND * largest {
                break;
            }
        }
    }

    /// Balance nodal accelerations (forces over effective masses) at active surfaces, and find the active ones.
    pub(in crate::step) fn bear(
        &mut self,
        wall: &Plane<D>,
        velocities: &[f64],
        accelerations: &mut [f64],
        step: f64,
    ) {
        let (axis, drag) = (wall.axis, wall.velocity[wall.axis]);
        for (p, surface) in self.surfaces.iter_mut().enumerate() {
            let closing = wall.sign * (along(self.near.weights(p), axis, velocities) - drag) < 0.0;
            surface.presses = surface.pressed || surface.gap <= 0.0 && closing;
        }
        for _ in 0..SWEEPS {
            let (mut changed, mut largest) = (0.0f64, 0.0f64);
            self.rows.each((&self.order, &self.shown), accelerations, |p, row| {
                let surface = &mut self.surfaces[p];
                if !surface.presses {
                    return;
                }
                let excess = wall.sign * row.sum() * step;
                let wanted = (surface.force - excess / surface.give).max(0.0);
                let more = wanted - surface.force;
                surface.force = wanted;
                (changed, largest) = (changed.max(more.abs()), largest.max(wanted.abs()));
                row.add(wall.sign * more / step);
            });
            if changed <= FOUND * largest {
                break;
            }
        }
        // Smaller forces are below the solver tolerance.
        let least = FOUND * self.surfaces.iter().fold(0.0, |most: f64, surface| most.max(surface.force));
        self.surfaces.iter_mut().for_each(|surface| surface.presses &= surface.force > least);
    }

    /// Return the tolerance of the impulses of the velocity constraint, N s.
    pub(in crate::step) fn least_stop(&self) -> f64 {
        FOUND * self.surfaces.iter().fold(0.0, |most: f64, surface| most.max(surface.stop))
    }

    /// Store the active surfaces, and those that reached the wall in this step: they are active from the next step on.
    pub(in crate::step) fn note(&mut self) {
        self.pressing.clear();
        let (bodies, numbers) = (self.near.bodies(), self.near.numbers());
        let least = self.least_stop();
        let presses = |surface: &Surface| surface.presses || surface.stop > least;
        let pressing = self.order.iter().filter(|p| presses(&self.surfaces[**p]));
        self.pressing.extend(pressing.map(|&p| (bodies[p], numbers[p])));
        self.pressing.sort_unstable();
    }

    /// Tie nodes behind a wall to those in front, one cell of `spacing`, m, away, if their mass is small relative to that
    /// of the surfaces acting on them; `masses` are those of the particles. The wall force acts at surfaces, half a
    /// particle in front of the nodal mass, and would strongly accelerate a node that particles have just reached. Both
    /// nodes then act as one, with the sums of masses and momenta, until [`AtWall::part`].
    pub(in crate::step) fn tie(&mut self, wall: &Plane<D>, masses: &[f64], spacing: f64) {
        self.tied.clear();
        let (axis, near) = (wall.axis, &mut self.near);
        let behind = |x: &[f64; D]| wall.distance(x) < -1e-6 * spacing;
        if !near.nodes.iter().any(|node| behind(&node.position)) {
            return;
        }
        let mut acting = vec![0.0; near.nodes.len()];
        for (p, mass) in masses.iter().enumerate() {
            near.weights(p).iter().for_each(|(node, w)| acting[*node as usize] += w[axis].abs() * mass);
        }
        let thin: Vec<bool> = near
            .nodes
            .iter()
            .zip(&acting)
            .map(|(node, acting)| behind(&node.position) && *acting > THIN * node.mass)
            .collect();
        let fronts = near.fronts(&thin, (axis, wall.sign * spacing));
        near.fold_to(&fronts);
        let tied = fronts.iter().enumerate().filter_map(|(node, front)| Some((node as u32, (*front)?)));
        self.tied.extend(tied);
        for &(node, front) in &self.tied {
            let (thin, front) = (near.nodes[node as usize], &mut near.nodes[front as usize]);
            let mass = front.mass + thin.mass;
            let mean = |a: f64, b: f64| (front.mass * a + thin.mass * b) / mass;
            let velocity: [f64; D] = std::array::from_fn(|d| mean(front.velocity[d], thin.velocity[d]));
            let start = front.start.zip(thin.start).map(|(a, b)| std::array::from_fn(|d| mean(a[d], b[d])));
            (0..D).for_each(|d| front.change[d] += velocity[d] - front.velocity[d]);
            (front.velocity, front.start, front.mass) = (velocity, start.or(front.start), mass);
        }
    }

    /// Set tied nodes to the velocities of those in front, whose own masses are restored.
    pub(in crate::step) fn part(&mut self) {
        let nodes = &mut self.near.nodes;
        for &(node, front) in &self.tied {
            let velocity = nodes[front as usize].velocity;
            nodes[front as usize].mass -= nodes[node as usize].mass;
            let thin = &mut nodes[node as usize];
            (0..D).for_each(|d| thin.change[d] += velocity[d] - thin.velocity[d]);
            thin.velocity = velocity;
        }
    }

    /// Set tied nodes and those in front to their mass-weighted mean normal velocity.
    pub(in crate::step) fn join(&self, velocities: &mut [f64]) {
        if self.tied.is_empty() {
            return;
        }
        let nodes = &self.near.nodes;
        let mut masses: Vec<f64> = nodes.iter().map(|node| node.mass).collect();
        for &(node, front) in &self.tied {
            let (node, front) = (node as usize, front as usize);
            let mass = masses[front] + masses[node];
            velocities[front] = (masses[front] * velocities[front] + masses[node] * velocities[node]) / mass;
            masses[front] = mass;
        }
        self.follow(velocities);
    }

    /// Copy the normal velocities of the nodes in front to tied nodes.
    pub(in crate::step) fn follow(&self, velocities: &mut [f64]) {
        self.tied.iter().for_each(|(node, front)| velocities[*node as usize] = velocities[*front as usize]);
    }

    /// Allocated memory, bytes.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.near.bytes()
            + self.pressing.capacity() * size_of::<(u32, usize)>()
            + self.surfaces.capacity() * size_of::<Surface>()
            + self.shown.capacity() * size_of::<f64>()
            + self.order.capacity() * size_of::<usize>()
            + self.rows.bytes()
            + self.light.capacity() * size_of::<u32>()
            + self.tied.capacity() * size_of::<(u32, u32)>()
    }

    /// Save or restore the state that is kept from step to step.
    pub(in crate::step) fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.pressing, &(0, 0), |file, (body, number)| {
            let mut word = u64::from(*body);
            file.word(&mut word)?;
            *body = u32::try_from(word).map_err(|_| file.damaged(format!("{word:#x} is no body")))?;
            file.count(number)
        })
    }
}
