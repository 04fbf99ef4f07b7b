//! Bodies of particles in an incompressible liquid.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use flow::{Deformable, NodeImpulse, SurfaceElement};
use impactite_geometry::Facets;
use impactite_scene::{Archive, CheckpointError, Exchange, SceneError, Solver, StepError};
use impactite_solve::least_squares_weights;
use mpm_core::{Hook, HookError, Mpm, StrainNodes, TrialNode, TrialNodes};

use crate::leapfrog::Leapfrog;

/// Longest edge of a facet, in cells, whose ends still have the motion of the matter between them.
const LONGEST: f64 = 2.0;
/// Variance of the places of the nodes around a point, over the square of a cell, below which the velocity is not extrapolated.
const VARIANCE: f64 = 0.05;
/// Name of the hook in errors and checkpoints.
const NAME: &str = "surfaces of particles in a liquid";

/// Bodies of particles that an incompressible liquid moves, for [`flow::Flow::add_deformable`].
///
/// Each body has a closed surface, which moves with its matter. The velocity of a point x of it is the moving least squares fit of the nodal velocities
/// v_i, weighted by the masses m_i and a quadratic B-spline N,
///
/// ```text
/// v(x) = sum w_i v_i,   w_i = N_i m_i (1 / M + (x - c) . S^-1 (x_i - c)),
/// M = sum N_i m_i,   c = sum N_i m_i x_i / M,   S = sum N_i m_i (x_i - c) (x_i - c)^T
/// ```
///
/// and an impulse J on it acts on the nodes as w_i J: momentum and angular momentum are those of J, its work is J . v, and the change of
/// velocity of a node with little mass is bounded. Facets are not divided: a body whose surface is stretched beyond two cells an edge stops the run.
///
/// ```
/// use coupling::ParticlesInLiquid;
/// use flow::{Flow, FlowOptions, Fluid, Wall};
/// use impactite_geometry::{Compose, Cuboid, Facets, Filling, Lattice, fill};
/// use impactite_scene::{PlaneStrain, Solver};
/// use mpm_core::{BlockGrid, Method, Mpm};
/// use mpm_materials::{Moduli, NeoHookean};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // A block of soft rubber, 0.1 m wide and half as dense as water, floats.
/// let rubber = NeoHookean::new(500.0, Moduli::young_poisson(1e5, 0.4)?)?;
/// let block = Cuboid::new([0.15, 0.15], [0.25, 0.25])?;
/// let lattice = Lattice::new([0.0; 2], 0.02)?;
/// let mut mpm = Mpm::new(Method::machine_parts(PlaneStrain), BlockGrid::new(lattice));
/// mpm.add("block", rubber, &fill(&block, &lattice, 2, &Filling::new())?, |_| [0.0; 2])?;
/// mpm.set_body_force(|_| [0.0, -9.81]);
///
/// let mut flow = Flow::new(FlowOptions::new(lattice));
/// flow.add_wall(Wall::container(Cuboid::new([0.0, 0.0], [0.4, 0.6])?))?;
/// let surface = Facets::of(&block, 0.01)?;
/// flow.add_deformable(ParticlesInLiquid::new(mpm, &[surface])?)?;
/// let water = Cuboid::new([0.0, 0.0], [0.4, 0.2])?.minus(block);
/// flow.add_shape("water", Fluid::new(1000.0)?, &water, 2, |_| [0.0; 2])?;
/// flow.set_body_force(|_| [0.0, -9.81]);
/// flow.run_until(0.1)?;
/// let height = flow.bodies()[1].totals().momentum[1];
/// assert!(height.abs() < 0.2);
/// # Ok(())
/// # }
/// ```
pub struct ParticlesInLiquid<const D: usize> {
    mpm: Mpm<D>,
    surface: Arc<Mutex<Surface<D>>>,
}

/// Surfaces of all bodies, shared with the hook of the scene.
struct Surface<const D: usize> {
    facets: Vec<SurfaceElement<D>>,
    nodes: Vec<SurfaceNode<D>>,
    /// Number of the first node of each body.
    first: Vec<usize>,
    /// Names of the bodies.
    names: Vec<String>,
    /// Cell of the particles, m.
    cell: f64,
    given: Exchange,
    /// Work of the present step by trial velocities, J, and impulses that conditions on nodes took from it, N s.
    booked: f64,
    /// Weights of the nodes of the grid at each node in the present step.
    fields: Fields<D>,
    starts: Vec<usize>,
    weights: Vec<(usize, f64)>,
    held: Vec<(usize, usize, f64)>,
}

#[derive(Clone, Debug)]
struct SurfaceNode<const D: usize> {
    body: usize,
    /// Position, m, and velocity, m/s.
    position: [f64; D],
    velocity: [f64; D],
    /// Force in the present step, N, and its impulse, N s.
    force: [f64; D],
    push: [f64; D],
}

impl<const D: usize> ParticlesInLiquid<D> {
    /// Create the bodies of a scene of particles, with the surface of each body at the start, in their order: [`Facets::of`] their shapes with
    /// facets of half a cell.
    ///
    /// # Errors
    /// Another number of surfaces than of bodies, or a surface off its body; facets above two cells; rigid bodies or elements; cells of
    /// several sizes; a transfer that plans its steps ahead (APIC with USL); USF; the total Lagrangian form.
    pub fn new(mut mpm: Mpm<D>, surfaces: &[Facets<D>]) -> Result<Self, SceneError> {
        let refuse = |what: String, why| {
            Err(SceneError::NotWith { what, method: "particles in a liquid".into(), why })
        };
        if mpm.facts().maps_together {
            return refuse(
                format!("the transfer of `{}`", mpm.facts().description),
                "it plans a step before the liquid has its own; take FLIP with MUSL",
            );
        }
        if mpm.facts().before_forces {
            return refuse(
                "stress before the forces (USF)".into(),
                "the surface moves with the strain; take FLIP with MUSL",
            );
        }
        if mpm.facts().total {
            return refuse(
                "the total Lagrangian form".into(),
                "impulses beside prescribed nodes gain energy in it; take FLIP with MUSL in the present configuration",
            );
        }
        if mpm.cell_sizes().len() > 1 {
            return refuse("cells of several sizes".into(), "the surface is of nodes of one size; take one");
        }
        if let Some(body) = mpm.bodies().iter().find(|b| b.rigid().is_some() || b.client().is_some()) {
            return refuse(format!("the body `{}`", body.name()), "bodies of particles alone have a surface");
        }
        if mpm.bodies().len() != surfaces.len() {
            let what = format!("{} surfaces for {} bodies", surfaces.len(), mpm.bodies().len());
            return refuse(what, "each body has a surface, which bounds the liquid");
        }
        let cell = mpm.grid().lattice().spacing();
        let mut surface = Surface {
            facets: Vec::new(),
            nodes: Vec::new(),
            first: Vec::new(),
            names: mpm.bodies().iter().map(|body| body.name().to_owned()).collect(),
            cell,
            given: Exchange::default(),
            booked: 0.0,
            fields: Fields::default(),
            starts: Vec::new(),
            weights: Vec::new(),
            held: Vec::new(),
        };
        for (body, found) in surfaces.iter().enumerate() {
            let facets = found.facets.iter().map(|nodes| SurfaceElement { body: body as u32, nodes: *nodes });
            surface.facets.extend(facets);
            surface.first.push(surface.nodes.len());
            // Velocities of the particles around.
            let mut bins: HashMap<[i32; D], Vec<Motion<D>>> = HashMap::new();
            mpm.bodies()[body].for_each(&mut |p| {
                let [place, velocity] = [&p.position, &p.velocity].map(|x| std::array::from_fn(|d| x[d]));
                bins.entry(nearest(&place, &[0.0; D], cell)).or_default().push((place, p.mass, velocity));
            });
            for &x in &found.nodes {
                let (mut points, mut velocities) = (Points::default(), Vec::new());
                let around = around(nearest(&x, &[0.0; D], cell), 2);
                for (place, mass, velocity) in around.flat_map(|bin| bins.get(&bin).into_iter().flatten()) {
                    points.add(velocities.len(), *place, *mass);
                    velocities.push(*velocity);
                }
                if !points.fit(&x, cell) {
                    return Err(left(&surface.names[body], &x));
                }
                let velocity = sum(points.weights.iter().copied().zip(&velocities));
                surface.nodes.push(SurfaceNode {
                    body,
                    position: x,
                    velocity,
                    force: [0.0; D],
                    push: [0.0; D],
                });
            }
        }
        surface.check_edges()?;
        let surface = Arc::new(Mutex::new(surface));
        mpm.add_hook(Push(surface.clone()));
        Ok(ParticlesInLiquid { mpm, surface })
    }

    /// Scene of the particles.
    pub fn mpm(&self) -> &Mpm<D> {
        &self.mpm
    }

    fn shared(&self) -> MutexGuard<'_, Surface<D>> {
        self.surface.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn left<const D: usize>(body: &str, x: &[f64; D]) -> SceneError {
    SceneError::NotWith {
        what: format!("the surface of `{body}` near {x:?} m, where the body has no particles"),
        method: "particles in a liquid".into(),
        why: "it moves with the matter; a body that breaks is not available: take `mpm` or `sph` for body and liquid",
    }
}

/// Position, m, mass, kg, and velocity, m/s, of a particle.
type Motion<const D: usize> = ([f64; D], f64, [f64; D]);

/// Points with mass around a place.
struct Points<const D: usize> {
    numbers: Vec<usize>,
    places: Vec<[f64; D]>,
    weights: Vec<f64>,
}

impl<const D: usize> Default for Points<D> {
    fn default() -> Self {
        Points { numbers: Vec::new(), places: Vec::new(), weights: Vec::new() }
    }
}

impl<const D: usize> Points<D> {
    fn clear(&mut self) {
        self.numbers.clear();
        self.places.clear();
        self.weights.clear();
    }
    fn add(&mut self, number: usize, place: [f64; D], mass: f64) {
        self.numbers.push(number);
        self.places.push(place);
        self.weights.push(mass);
    }
    /// Find the weights of moving least squares at `x`; false without mass around it.
    fn fit(&mut self, x: &[f64; D], cell: f64) -> bool {
        for (place, weight) in self.places.iter().zip(&mut self.weights) {
            *weight *= (0..D).map(|d| spline((place[d] - x[d]) / cell)).product::<f64>();
        }
        least_squares_weights(x, VARIANCE * cell * cell, &self.places, &mut self.weights)
    }
}

/// Nodes of a step by body and index: each field in the box around its nodes.
struct Fields<const D: usize> {
    boxes: Vec<FieldBox<D>>,
}

/// Numbers of the nodes of a field, with `EMPTY` between them.
#[derive(Clone)]
struct FieldBox<const D: usize> {
    low: [i32; D],
    counts: [i32; D],
    numbers: Vec<u32>,
}

const EMPTY: u32 = u32::MAX;

impl<const D: usize> Default for Fields<D> {
    fn default() -> Self {
        Fields { boxes: Vec::new() }
    }
}

impl<const D: usize> FieldBox<D> {
    fn place(&self, index: &[i32; D]) -> Option<usize> {
        let (mut place, mut stride) = (0, 1);
        for d in 0..D {
            let at = index[d] - self.low[d];
            if at < 0 || at >= self.counts[d] {
                return None;
            }
            place += at as usize * stride;
            stride *= self.counts[d] as usize;
        }
        Some(place)
    }
}

impl<const D: usize> Fields<D> {
    /// Fill with the nodes of a step of so many bodies. The last field is that of all bodies.
    fn fill(&mut self, nodes: &[TrialNode<D>], bodies: usize) {
        let empty = FieldBox { low: [i32::MAX; D], counts: [i32::MIN; D], numbers: Vec::new() };
        self.boxes.resize(bodies + 1, empty);
        for field in &mut self.boxes {
            (field.low, field.counts) = ([i32::MAX; D], [i32::MIN; D]);
        }
        for node in nodes {
            let field = &mut self.boxes[node.body.unwrap_or(bodies)];
            for d in 0..D {
                field.low[d] = field.low[d].min(node.index[d]);
                field.counts[d] = field.counts[d].max(node.index[d]);
            }
        }
        for field in &mut self.boxes {
            for d in 0..D {
                field.counts[d] = field.counts[d].saturating_sub(field.low[d]).saturating_add(1).max(0);
            }
            field.numbers.clear();
            field.numbers.resize(field.counts.iter().map(|n| *n as usize).product(), EMPTY);
        }
        for (number, node) in nodes.iter().enumerate() {
            let field = &mut self.boxes[node.body.unwrap_or(bodies)];
            if let Some(place) = field.place(&node.index) {
                field.numbers[place] = number as u32;
            }
        }
    }

    fn find(&self, body: usize, index: &[i32; D]) -> Option<usize> {
        [body, self.boxes.len() - 1].into_iter().find_map(|field| {
            let field = &self.boxes[field];
            let number = field.numbers[field.place(index)?];
            (number != EMPTY).then_some(number as usize)
        })
    }
}

/// Index of the nearest point of a lattice of this spacing, m, through `origin`.
fn nearest<const D: usize>(x: &[f64; D], origin: &[f64; D], cell: f64) -> [i32; D] {
    std::array::from_fn(|d| ((x[d] - origin[d]) / cell).round() as i32)
}

/// Indices within `reach` of one along each axis.
fn around<const D: usize>(middle: [i32; D], reach: usize) -> impl Iterator<Item = [i32; D]> {
    let width = 2 * reach + 1;
    (0..width.pow(D as u32)).map(move |n| {
        std::array::from_fn(|d| middle[d] - reach as i32 + (n / width.pow(d as u32) % width) as i32)
    })
}

/// Quadratic B-spline at a distance in cells.
fn spline(x: f64) -> f64 {
    let x = x.abs();
    if x < 0.5 {
        0.75 - x * x
    } else if x < 1.5 {
        0.5 * (1.5 - x).powi(2)
    } else {
        0.0
    }
}

/// Weighted sum of vectors.
fn sum<'a, const D: usize>(all: impl Iterator<Item = (f64, &'a [f64; D])>) -> [f64; D] {
    all.fold([0.0; D], |sum, (w, v)| std::array::from_fn(|d| sum[d] + w * v[d]))
}

/// Hook that gives the impulses of the liquid to the nodes, and moves the surface with them.
struct Push<const D: usize>(Arc<Mutex<Surface<D>>>);

impl<const D: usize> Hook<f64, D> for Push<D> {
    fn name(&self) -> &str {
        NAME
    }

    fn trial(&mut self, nodes: &mut TrialNodes<D>, dt: f64) -> Result<(), HookError> {
        let mut surface = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(surface.push(nodes, dt)?)
    }

    fn needs_strain(&self) -> bool {
        true
    }

    fn strain(&mut self, nodes: &mut StrainNodes<D>, dt: f64) -> Result<(), HookError> {
        let mut surface = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(surface.follow(nodes, dt)?)
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let mut surface = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for node in &mut surface.nodes {
            file.reals(node.position.iter_mut().chain(&mut node.velocity))?;
        }
        let given = &mut surface.given;
        file.reals(given.impulse.iter_mut().chain(&mut given.load).chain([&mut given.work]))
    }
}

impl<const D: usize> Surface<D> {
    /// Find the weights of the nodes of the grid at each node of the surfaces.
    fn find_weights(&mut self, nodes: &[TrialNode<D>]) -> Result<(), SceneError> {
        let Some(first) = nodes.first() else { return Err(left(&self.names[0], &self.nodes[0].position)) };
        let cell = self.cell;
        let origin = std::array::from_fn(|d| first.position[d] - cell * f64::from(first.index[d]));
        self.fields.fill(nodes, self.names.len());
        let mut points = Points::default();
        self.starts.clear();
        self.weights.clear();
        for node in &self.nodes {
            let x = &node.position;
            points.clear();
            for index in around(nearest(x, &origin, cell), 1) {
                if let Some(n) = self.fields.find(node.body, &index) {
                    points.add(n, nodes[n].position, nodes[n].mass);
                }
            }
            self.starts.push(self.weights.len());
            if !points.fit(x, cell) {
                return Err(left(&self.names[node.body], x));
            }
            self.weights.extend(points.numbers.iter().copied().zip(points.weights.iter().copied()));
        }
        self.starts.push(self.weights.len());
        Ok(())
    }

    /// Nodes of the grid at a node of the surfaces, with their weights.
    fn at(&self, node: usize) -> &[(usize, f64)] {
        &self.weights[self.starts[node]..self.starts[node + 1]]
    }

    /// Give the impulses of a step to the nodes of the grid.
    fn push(&mut self, nodes: &mut TrialNodes<D>, dt: f64) -> Result<(), SceneError> {
        self.find_weights(nodes.nodes())?;
        let mut impulses = vec![[0.0; D]; nodes.nodes().len()];
        for k in 0..self.nodes.len() {
            let push = self.nodes[k].force.map(|f| f * dt);
            self.nodes[k].push = push;
            for (n, w) in self.at(k) {
                (0..D).for_each(|d| impulses[*n][d] += w * push[d]);
            }
        }
        self.booked = 0.0;
        self.held.clear();
        for (n, impulse) in impulses.iter().enumerate().filter(|(_, impulse)| **impulse != [0.0; D]) {
            let node = nodes.nodes()[n];
            let mut velocity = node.velocity;
            for d in 0..D {
                if node.held[d] {
                    // The condition takes it.
                    self.given.impulse[d] += impulse[d];
                    self.held.push((n, d, impulse[d]));
                    continue;
                }
                velocity[d] += impulse[d] / node.mass;
                self.given.load[d] += impulse[d];
                self.booked += 0.5 * impulse[d] * (node.start[d] + velocity[d]);
            }
            nodes.set_velocity(n, velocity);
        }
        Ok(())
    }

    /// Move with the matter.
    fn follow(&mut self, nodes: &mut StrainNodes<D>, dt: f64) -> Result<(), SceneError> {
        let mut work = 0.0;
        for k in 0..self.nodes.len() {
            let velocity = sum(self.at(k).iter().map(|(n, w)| (*w, &nodes.nodes()[*n].velocity)));
            let node = &mut self.nodes[k];
            let before = std::mem::replace(&mut node.velocity, velocity);
            for d in 0..D {
                node.position[d] += dt * node.velocity[d];
                work += 0.5 * node.push[d] * (before[d] + node.velocity[d]);
            }
        }
        work -= self.held.iter().map(|(n, d, impulse)| impulse * nodes.nodes()[*n].velocity[*d]).sum::<f64>();
        nodes.add_work(work - self.booked);
        self.given.work += work;
        self.check_edges()
    }

    /// Check that no facet is too large for the cells.
    fn check_edges(&self) -> Result<(), SceneError> {
        for facet in &self.facets {
            let first = self.first[facet.body as usize];
            let at = |k: usize| &self.nodes[first + facet.nodes[k % D] as usize].position;
            for k in 0..D {
                let edge = (0..D).map(|d| (at(k)[d] - at(k + 1)[d]).powi(2)).sum::<f64>().sqrt();
                if edge > LONGEST * self.cell {
                    return Err(SceneError::NotWith {
                        what: format!(
                            "the surface of `{}`, which is stretched to {edge:.3e} m from node to node near {:?} m,",
                            self.names[facet.body as usize],
                            at(k)
                        ),
                        method: "particles in a liquid".into(),
                        why: "facets above two cells of the particles do not follow the matter; a body that flows or breaks is of `mpm` or `sph`, with its liquid",
                    });
                }
            }
        }
        Ok(())
    }
}

impl<const D: usize> Deformable<D> for ParticlesInLiquid<D> {
    fn solver(&self) -> &dyn Solver {
        &self.mpm
    }
    fn solver_mut(&mut self) -> &mut dyn Solver {
        &mut self.mpm
    }
    fn surface(&self) -> Vec<SurfaceElement<D>> {
        self.shared().facets.clone()
    }
    fn surface_revision(&self) -> u64 {
        0
    }
    fn node(&self, body: u32, node: u32) -> ([f64; D], [f64; D]) {
        let surface = self.shared();
        let node = &surface.nodes[surface.first[body as usize] + node as usize];
        // In the middle of the last step: see `Leapfrog`.
        let back = 0.5 * self.mpm.clock().last.unwrap_or(0.0);
        (std::array::from_fn(|d| node.position[d] - back * node.velocity[d]), node.velocity)
    }
    fn run_for(&mut self, duration: f64, impulses: &[NodeImpulse<D>]) -> Result<(), StepError> {
        let mut steps = Leapfrog::new(duration, self.mpm.clock().last);
        let mut left = 1.0;
        while let Some((dt, share)) = steps.next(Solver::stable_step(&mut self.mpm)?, self.mpm.clock().last) {
            let mut surface = self.shared();
            surface.nodes.iter_mut().for_each(|node| node.force = [0.0; D]);
            for push in impulses {
                let number = surface.first[push.body as usize] + push.node as usize;
                (0..D).for_each(|d| surface.nodes[number].force[d] += push.impulse[d] * left * share / dt);
            }
            drop(surface);
            let made = self.mpm.step_at_most(dt)?;
            left *= 1.0 - share * (made / dt).min(1.0);
            steps.made(made);
        }
        Ok(())
    }
    fn given(&self) -> Exchange {
        self.shared().given
    }
}
