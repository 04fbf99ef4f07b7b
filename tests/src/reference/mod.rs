//! Reference implementation of the material point method after the flow chart of \[Ma2010\]: plain, slow and
//! scalar.
//!
//! One loop per stage, particles in a list, nodes in a map by their indices, global coordinates, every sum in
//! particle order. It shares only the one-dimensional weights ([`ShapeFunction::weights`]) and the constitutive
//! laws with the fast step. Numbers in brackets are equation numbers of \[Ma2010\].
//!
//! Mirror images model symmetry planes: every particle has an image behind each plane, with mirrored velocity,
//! affine matrix and stress, so that half a model equals the whole one by construction.

mod boundaries;
mod matrices;
mod walls;
mod weights;

use std::collections::{BTreeMap, BTreeSet};

use boundaries::{constrain, held};
use matrices::{inverse, times, transpose};
use mpm_core::dim::Stencil;
use mpm_core::geometry::{Lattice, Seeds};
use mpm_core::{Boundary, MeanDilatation, ShapeFunction};
use mpm_materials::point::{flatten, unflatten};
use mpm_materials::{Constitutive, Kinematics, Mat3};
use weights::side;

/// Order of the stress update in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Update stress first.
    Usf,
    /// Update stress last.
    Usl,
    /// Update modified stress last: from momentum mapped again.
    Musl,
}

/// Velocity update of particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// v + dt sum N a.
    Flip,
    /// sum N v.
    Pic,
    /// FLIP relaxed towards PIC with a time constant, s.
    Blend(f64),
    /// FLIP with a PIC fraction per step, and the affine matrix.
    Aflip(f64),
    /// PIC with the affine matrix.
    Apic,
    /// APIC with the affine (moving least squares) fit as the gradient of the weights.
    Mls,
    /// FMPM: PIC of this order (number of terms).
    Fmpm(usize),
}

/// Coordinate system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// Cartesian: three dimensions, or plane strain in two.
    Cartesian,
    /// (r, z), per radian.
    Axisymmetric,
}

/// Constitutive law with its state variables as a list of numbers.
pub trait Law {
    /// Reference density, kg/m^3.
    fn density(&self) -> f64;
    /// Initial state.
    fn virgin(&self) -> Vec<f64>;
    /// Update the state by a strain increment; return the new state and stress.
    fn update(&self, increment: [[f64; 3]; 3], dt: f64, length: f64, state: &[f64]) -> (Vec<f64>, [f64; 6]);
    /// Stress of a state, Pa.
    fn stress(&self, state: &[f64]) -> [f64; 6];
    /// Volume ratio: current over reference volume.
    fn volume_ratio(&self, state: &[f64]) -> f64;
    /// Wave speed, m/s: of the fastest wave.
    fn wave_speed(&self, state: &[f64]) -> f64;
}

impl<C: Constitutive<f64>> Law for C {
    fn density(&self) -> f64 {
        Constitutive::density(self)
    }
    fn virgin(&self) -> Vec<f64> {
        flatten(&Constitutive::virgin(self))
    }
    fn update(&self, increment: [[f64; 3]; 3], dt: f64, length: f64, state: &[f64]) -> (Vec<f64>, [f64; 6]) {
        let old: C::State<f64> = unflatten(state).expect("length of the state");
        let new = Constitutive::update(self, &Kinematics { increment: Mat3(increment), dt, length }, &old);
        assert!(!new.fault.any(), "the law broke down in the reference");
        (flatten(&new.state), new.stress.0)
    }
    fn stress(&self, state: &[f64]) -> [f64; 6] {
        Constitutive::stress(self, &unflatten(state).expect("length of the state")).0
    }
    fn volume_ratio(&self, state: &[f64]) -> f64 {
        Constitutive::volume_ratio(self, &unflatten(state).expect("length of the state"))
    }
    fn wave_speed(&self, state: &[f64]) -> f64 {
        Constitutive::wave_speed(self, &unflatten::<f64, C::State<f64>>(state).expect("length of the state"))
    }
}

/// Material point.
#[derive(Clone, Debug)]
pub struct Point<const D: usize> {
    /// Body index.
    pub body: usize,
    /// Particle number in its body.
    pub number: usize,
    /// Position, m.
    pub x: [f64; D],
    /// Velocity, m/s.
    pub v: [f64; D],
    /// Mass, kg.
    pub mass: f64,
    /// State variables of its law.
    pub state: Vec<f64>,
    /// Half sizes of its domain, in cells.
    pub half: [f64; D],
    /// Corners of a convected domain relative to its position, in cells; bit d of the index selects the side along
    /// axis d.
    pub corners: Vec<[f64; D]>,
    /// Affine matrix of APIC, 1/s.
    pub affine: [[f64; D]; D],
    /// Displacement since the start, m, if the grid is in the reference configuration (else `x` moves).
    pub displacement: [f64; D],
    /// Deformation gradient, if the grid is in the reference configuration.
    pub deformation: [[f64; 3]; 3],
    /// Initial position, m.
    pub start: [f64; D],
}

/// Grid node.
#[derive(Clone, Debug)]
struct Node<const D: usize> {
    mass: f64,
    momentum: [f64; D],
    force: [f64; D],
    velocity: [f64; D],
    acceleration: [f64; D],
    remapped: [f64; D],
}

impl<const D: usize> Default for Node<D> {
    fn default() -> Self {
        let o = [0.0; D];
        Node { mass: 0.0, momentum: o, force: o, velocity: o, acceleration: o, remapped: o }
    }
}

type Index<const D: usize> = [i64; D];

/// Acceleration field, m/s^2: function of position and time.
pub type Field<const D: usize> = Box<dyn Fn(&[f64; D], f64) -> [f64; D]>;

/// Shape function value and gradient of a particle at a node.
#[derive(Clone, Copy, Debug)]
struct Weight<const D: usize> {
    node: Index<D>,
    value: f64,
    gradient: [f64; D],
}

/// Mirror image of a particle (or the particle itself): signs of its components, and its weights.
struct Image<const D: usize> {
    /// Position at the start of the step, m.
    x: [f64; D],
    sign: [f64; D],
    weights: Vec<Weight<D>>,
}

/// Reference method with its scene.
pub struct Reference<const D: usize, S> {
    /// Shape function of the particles.
    pub shape: S,
    /// Velocity update of the particles.
    pub rule: Rule,
    /// Order of the stress update.
    pub order: Order,
    /// Coordinate system.
    pub space: Space,
    /// Background grid.
    pub lattice: Lattice<D>,
    /// Constitutive laws of the bodies.
    pub laws: Vec<Box<dyn Law>>,
    /// Particles of all bodies.
    pub points: Vec<Point<D>>,
    /// Boundary conditions.
    pub boundaries: Vec<Boundary<D>>,
    /// Gravitational acceleration of all material.
    pub gravity: [f64; D],
    /// Acceleration field: function of initial particle position and time.
    pub field: Option<Field<D>>,
    /// Total Lagrangian grid: it is in the reference configuration, and `x` of a point does not change.
    pub total: bool,
    /// Mean dilatation: laws use that of the particles of a body in a cell.
    pub mean_dilatation: bool,
    /// Time, s.
    pub time: f64,
    nodes: BTreeMap<Index<D>, Node<D>>,
    /// Pairs of wall number and particle number whose surfaces were in contact in the step before.
    pressed: BTreeSet<(usize, usize)>,
    /// Particle surfaces at every wall in this step.
    touches: Vec<walls::AtWall<D>>,
    /// Frictional heat at walls so far, J.
    pub heat: f64,
    /// Wall impulse so far, N s.
    pub wall_impulse: [f64; D],
    /// Images of every particle; the first is the particle itself.
    images: Vec<Vec<Image<D>>>,
    /// Cell of every particle at the positions of its weights.
    cells: Vec<Index<D>>,
}

impl<const D: usize, S: ShapeFunction<f64, D>> Reference<D, S> {
    /// Create an empty scene.
    pub fn new(shape: S, rule: Rule, order: Order, space: Space, lattice: Lattice<D>) -> Self {
        Reference {
            shape,
            rule,
            order,
            space,
            lattice,
            laws: Vec::new(),
            points: Vec::new(),
            boundaries: Vec::new(),
            gravity: [0.0; D],
            field: None,
            total: false,
            mean_dilatation: false,
            time: 0.0,
            nodes: BTreeMap::new(),
            pressed: BTreeSet::new(),
            touches: Vec::new(),
            heat: 0.0,
            wall_impulse: [0.0; D],
            images: Vec::new(),
            cells: Vec::new(),
        }
    }

    /// Add a body to the scene.
    pub fn add(
        &mut self,
        law: impl Law + 'static,
        seeds: &Seeds<D>,
        velocity: impl Fn([f64; D]) -> [f64; D],
    ) {
        let body = self.laws.len();
        for (number, (&x, volume)) in seeds.positions.iter().zip(&seeds.volumes).enumerate() {
            self.points.push(Point {
                body,
                number,
                x,
                v: velocity(x),
                mass: law.density() * volume,
                state: law.virgin(),
                half: seeds.half_size.map(|half| half / self.lattice.spacing()),
                corners: (0..1 << D)
                    .map(|c| {
                        std::array::from_fn(|d| side(c, d) * seeds.half_size[d] / self.lattice.spacing())
                    })
                    .collect(),
                affine: [[0.0; D]; D],
                displacement: [0.0; D],
                deformation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                start: x,
            });
        }
        self.laws.push(Box::new(law));
    }

    /// Advance by one step of size `dt`.
    pub fn step(&mut self, dt: f64) {
        self.weights();
        self.mass_and_momentum(); // (2), (3)
        if self.time == 0.0 && self.is_affine() {
            self.first_affine_fields();
        }
        match self.order {
            Order::Usf => {
                self.nodal_velocity();
                self.hold_mapped(dt);
                self.update_stress(dt, |node| node.velocity);
                self.forces();
                self.integrate_momentum(dt);
                self.meet_walls(dt);
                self.sharpen_velocity(dt);
                self.particle_velocities(dt);
                self.move_particles(dt);
                self.stretch_domains(dt, |node| node.velocity);
            }
            Order::Usl => {
                self.forces();
                self.nodal_velocity();
                self.integrate_momentum(dt);
                self.meet_walls(dt);
                self.sharpen_velocity(dt);
                self.particle_velocities(dt);
                self.move_particles(dt);
                self.update_stress(dt, |node| node.velocity);
                self.stretch_domains(dt, |node| node.velocity);
            }
            Order::Musl => {
                self.forces();
                self.nodal_velocity();
                self.integrate_momentum(dt);
                self.meet_walls(dt);
                self.particle_velocities(dt);
                self.move_particles(dt);
                self.map_momentum_again(dt);
                self.update_stress(dt, |node| node.remapped);
                self.stretch_domains(dt, |node| node.remapped);
            }
        }
        self.time += dt;
    }

    fn mass_and_momentum(&mut self) {
        self.nodes.clear();
        for (point, images) in self.points.iter().zip(&self.images) {
            for image in images {
                for w in &image.weights {
                    let xi = self.lattice.node(w.node);
                    // Node position mirrored into the frame of the particle.
                    let mut from = [0.0; D];
                    for d in 0..D {
                        let plane = self.mirrored(xi[d], d, image.sign[d]);
                        from[d] = plane - point.x[d];
                    }
                    let node = self.nodes.entry(w.node).or_default();
                    node.mass += w.value * point.mass;
                    for c in 0..D {
                        let mut v = point.v[c];
                        for d in 0..D {
                            v += point.affine[c][d] * from[d];
                        }
                        node.momentum[c] += w.value * point.mass * image.sign[c] * v;
                    }
                }
            }
        }
    }

    /// Return coordinate `x` along axis `d`, mirrored at the symmetry plane if `sign` is negative.
    fn mirrored(&self, x: f64, d: usize, sign: f64) -> f64 {
        if sign > 0.0 {
            return x;
        }
        for boundary in &self.boundaries {
            if let Boundary::Symmetry { axis, at, .. } = *boundary
                && axis == d
            {
                return 2.0 * at - x;
            }
        }
        x
    }

    /// Compute internal forces (9), with the hoop stress in axisymmetry.
    fn forces(&mut self) {
        for (point, images) in self.points.iter().zip(&self.images) {
            let law = &self.laws[point.body];
            let [xx, yy, zz, yz, xz, xy] = law.stress(&point.state);
            let mut stress = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            if self.total {
                stress = times(&stress, &transpose(&inverse(&point.deformation)));
            }
            let field = self.field.as_ref().map_or([0.0; D], |f| f(&point.start, self.time));
            let volume = point.mass / law.density() * law.volume_ratio(&point.state);
            for image in images {
                for w in &image.weights {
                    let node = self.nodes.entry(w.node).or_default();
                    for c in 0..D {
                        for d in 0..D {
                            let mirrored = image.sign[c] * stress[c][d] * image.sign[d];
                            node.force[c] -= volume * mirrored * w.gradient[d];
                        }
                    }
                    if self.space == Space::Axisymmetric {
                        let r = image.sign[0] * point.x[0];
                        node.force[0] -= volume * stress[2][2] / r * w.value;
                    }
                    for c in 0..D {
                        node.force[c] += image.sign[c] * point.mass * field[c] * w.value;
                    }
                }
            }
        }
    }

    fn lightest(&self) -> f64 {
        (64.0 * f64::EPSILON).powi(2) * self.points.iter().map(|p| p.mass).fold(f64::INFINITY, f64::min)
    }

    /// Compute nodal velocities v = p / m. USF applies the boundary conditions here, since its strain uses this
    /// velocity.
    fn nodal_velocity(&mut self) {
        let (light, at_start) = (self.lightest(), self.order == Order::Usf);
        let (boundaries, lattice, time) = (&self.boundaries, &self.lattice, self.time);
        for (index, node) in &mut self.nodes {
            node.velocity = [0.0; D];
            if node.mass > light {
                node.velocity = node.momentum.map(|p| p / node.mass);
                if at_start {
                    constrain(boundaries, lattice, &lattice.node(*index), &mut node.velocity, time);
                }
            }
        }
    }

    /// Update nodal velocities (8) with loads and boundary conditions.
    fn integrate_momentum(&mut self, dt: f64) {
        let light = self.lightest();
        let (boundaries, lattice, end) = (&self.boundaries, &self.lattice, self.time + dt);
        for (index, node) in &mut self.nodes {
            let old = node.velocity;
            if node.mass > light {
                for d in 0..D {
                    node.velocity[d] = old[d] + dt * (node.force[d] / node.mass + self.gravity[d]);
                }
                constrain(boundaries, lattice, &lattice.node(*index), &mut node.velocity, end);
            }
            for d in 0..D {
                node.acceleration[d] = (node.velocity[d] - old[d]) / dt;
            }
        }
    }

    /// Apply FMPM: v <- sum of (I - S~)^j v for j below the order, where S~ maps to the particles and back.
    fn sharpen_velocity(&mut self, dt: f64) {
        let Rule::Fmpm(order) = self.rule else { return };
        let light = self.lightest();
        let mut term: BTreeMap<Index<D>, [f64; D]> =
            self.nodes.iter().map(|(index, node)| (*index, node.velocity)).collect();
        for _ in 1..order {
            let mut smooth: BTreeMap<Index<D>, [f64; D]> = BTreeMap::new();
            for (point, images) in self.points.iter().zip(&self.images) {
                let v = interpolate(&images[0].weights, |index| term[index]);
                for image in images {
                    for w in &image.weights {
                        let sum = smooth.entry(w.node).or_insert([0.0; D]);
                        for d in 0..D {
                            sum[d] += w.value * point.mass * image.sign[d] * v[d];
                        }
                    }
                }
            }
            for (index, node) in &mut self.nodes {
                if node.mass <= light {
                    continue;
                }
                let x = self.lattice.node(*index);
                let d = term.entry(*index).or_insert([0.0; D]);
                for c in 0..D {
                    let held = held(&self.boundaries, &self.lattice, &x, c, self.time + dt);
                    d[c] = if held { 0.0 } else { d[c] - smooth[index][c] / node.mass };
                    node.velocity[c] += d[c];
                }
            }
        }
        if order > 1 {
            self.hold_again(|node| &mut node.velocity, true, dt);
        }
    }

    /// Update particle velocities (17) with FLIP, PIC or a blend, and the affine matrix.
    fn particle_velocities(&mut self, dt: f64) {
        for (point, images) in self.points.iter_mut().zip(&self.images) {
            let weights = &images[0].weights;
            let pic = interpolate(weights, |index| self.nodes[index].velocity);
            let rise = interpolate(weights, |index| self.nodes[index].acceleration);
            for d in 0..D {
                let flip = point.v[d] + dt * rise[d];
                point.v[d] = match self.rule {
                    Rule::Flip => flip,
                    Rule::Pic | Rule::Apic | Rule::Mls | Rule::Fmpm(_) => pic[d],
                    Rule::Aflip(share) => flip + share * (pic[d] - flip),
                    Rule::Blend(tau) => flip + (dt / tau).min(1.0) * (pic[d] - flip),
                };
            }
        }
        if self.is_affine() {
            self.fit_affine();
        }
    }

    fn is_affine(&self) -> bool {
        matches!(self.rule, Rule::Aflip(_) | Rule::Apic | Rule::Mls)
    }

    /// Fit the affine matrix of APIC to the nodal velocities.
    fn fit_affine(&mut self) {
        for (point, images) in self.points.iter_mut().zip(&self.images) {
            for d in 0..D {
                let mut second = 0.0;
                let mut first = [0.0; D];
                for w in &images[0].weights {
                    let r = self.lattice.node(w.node)[d] - point.x[d];
                    second += w.value * r * r;
                    for c in 0..D {
                        first[c] += w.value * r * self.nodes[&w.node].velocity[c];
                    }
                }
                for c in 0..D {
                    point.affine[c][d] = first[c] / second;
                }
            }
        }
    }

    /// Initialise the affine matrices of particles from nodal velocities in eight iterations.
    fn first_affine_fields(&mut self) {
        let light = self.lightest();
        for _ in 0..8 {
            for node in self.nodes.values_mut() {
                let per_mass = if node.mass > light { 1.0 / node.mass } else { 0.0 };
                node.velocity = node.momentum.map(|p| p * per_mass);
            }
            self.fit_affine();
            self.mass_and_momentum();
        }
    }

    /// Update particle positions (16) with the updated nodal velocity.
    fn move_particles(&mut self, dt: f64) {
        for (point, images) in self.points.iter_mut().zip(&self.images) {
            let v = interpolate(&images[0].weights, |index| self.nodes[index].velocity);
            for d in 0..D {
                if self.total {
                    point.displacement[d] += dt * v[d];
                } else {
                    point.x[d] += dt * v[d];
                }
            }
        }
    }

    /// Map momentum again (3) with the new particle velocities.
    fn map_momentum_again(&mut self, dt: f64) {
        let light = self.lightest();
        let mut momentum: BTreeMap<Index<D>, [f64; D]> = BTreeMap::new();
        for (point, images) in self.points.iter().zip(&self.images) {
            for image in images {
                for w in &image.weights {
                    let sum = momentum.entry(w.node).or_insert([0.0; D]);
                    for d in 0..D {
                        sum[d] += w.value * point.mass * image.sign[d] * point.v[d];
                    }
                }
            }
        }
        let (boundaries, lattice, end) = (&self.boundaries, &self.lattice, self.time + dt);
        for (index, node) in &mut self.nodes {
            node.remapped = [0.0; D];
            if node.mass > light {
                node.remapped = momentum[index].map(|p| p / node.mass);
                constrain(boundaries, lattice, &lattice.node(*index), &mut node.remapped, end);
            }
        }
        self.hold_again(|node| &mut node.remapped, false, dt);
    }

    /// Update strain (18), (19) and stress by the constitutive law.
    fn update_stress(&mut self, dt: f64, velocity: impl Fn(&Node<D>) -> [f64; D]) {
        let h = self.lattice.spacing();
        let mut increments = Vec::new();
        for (point, images) in self.points.iter_mut().zip(&self.images) {
            let mut increment = [[0.0; 3]; 3];
            let mut hoop = 0.0;
            for w in &images[0].weights {
                let v = velocity(&self.nodes[&w.node]);
                for c in 0..D {
                    for d in 0..D {
                        increment[c][d] += dt * v[c] * w.gradient[d];
                    }
                }
                hoop += dt * v[0] * w.value;
            }
            if self.space == Space::Axisymmetric {
                // Radius at the start of the step, like the weights.
                increment[2][2] = hoop / images[0].x[0];
            }
            if self.total {
                let before = point.deformation;
                for c in 0..3 {
                    for d in 0..3 {
                        point.deformation[c][d] += increment[c][d];
                    }
                }
                increment = times(&increment, &inverse(&before));
            }
            increments.push(increment);
        }
        if self.mean_dilatation {
            self.share_dilatation(&mut increments);
        }
        for (point, increment) in self.points.iter_mut().zip(increments) {
            (point.state, _) = self.laws[point.body].update(increment, dt, h, &point.state);
        }
    }

    /// Cell of a position. Particles of a cell share a stencil: cells are centred on nodes for stencils with an odd
    /// number of nodes along an axis, between nodes otherwise.
    fn cell(&self, x: &[f64; D]) -> Index<D> {
        let (origin, h) = (self.lattice.origin(), self.lattice.spacing());
        std::array::from_fn(|d| {
            let at = (x[d] - origin[d]) / h;
            if <S::Extent as Stencil>::NODES % 2 == 1 { (at + 0.5).floor() as i64 } else { at.floor() as i64 }
        })
    }

    /// Replace the traces of the increments of a body's particles in a cell by their mass-weighted mean, plus a relaxation
    /// towards the mean volume ratio.
    fn share_dilatation(&self, increments: &mut [[[f64; 3]; 3]]) {
        let mut sums: BTreeMap<(usize, Index<D>), [f64; 3]> = BTreeMap::new();
        for ((point, cell), dl) in self.points.iter().zip(&self.cells).zip(&*increments) {
            let sum = sums.entry((point.body, *cell)).or_default();
            sum[0] += point.mass * (dl[0][0] + dl[1][1] + dl[2][2]);
            sum[1] += point.mass;
            sum[2] += point.mass * self.laws[point.body].volume_ratio(&point.state);
        }
        let axes = if D == 2 && self.space != Space::Axisymmetric { 2 } else { 3 };
        for ((point, cell), dl) in self.points.iter().zip(&self.cells).zip(increments) {
            let [trace, mass, volume] = sums[&(point.body, *cell)];
            let back = volume / mass / self.laws[point.body].volume_ratio(&point.state) - 1.0;
            let wanted = trace / mass + MeanDilatation::RETURN * back;
            let more = (wanted - (dl[0][0] + dl[1][1] + dl[2][2])) / axes as f64;
            for d in 0..axes {
                dl[d][d] += more;
            }
        }
    }
}

/// Interpolate nodal values: sum N v.
fn interpolate<const D: usize>(weights: &[Weight<D>], of: impl Fn(&Index<D>) -> [f64; D]) -> [f64; D] {
    let mut sum = [0.0; D];
    for w in weights {
        let v = of(&w.node);
        for d in 0..D {
            sum[d] += w.value * v[d];
        }
    }
    sum
}
