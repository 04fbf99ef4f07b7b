//! Conformance of transfers and composed methods.

use mpm_materials::elastic::HypoelasticState;
use mpm_materials::{Constitutive, Kinematics, Lane, LinearElastic, Moduli, Sym3, Update};

use super::{Broken, within};
use crate::dim::Stencil;
use crate::grid::DenseGrid;
use crate::kernels::IntoKernels;
use crate::method::{Composition, Method};
use crate::scheme::Allows;
use crate::scheme::Usl;
use crate::shape::{QuadraticBSpline, ShapeFunction, bin_centre, node_offset};
use crate::step::Mpm;
use crate::transfer::{Suits, Transfer};
use impactite_geometry::{Lattice, Seeds};
use impactite_scene::TimeControl;
use impactite_scene::embedding::{Embedding, PlaneStrain};

/// Linear elastic law with Young's modulus 1, density 1, Poisson's ratio 0.25, and an initial stress.
#[derive(Clone, Debug)]
pub(super) struct Probe {
    elastic: LinearElastic<f64>,
    stress: [f64; 6],
}

impl Probe {
    #[allow(clippy::expect_used)]
    pub(super) fn new(stress: [f64; 6]) -> Self {
        let moduli = Moduli::young_poisson(1.0, 0.25).expect("constants that are allowed");
        Probe { elastic: LinearElastic::new(1.0, moduli).expect("constants that are allowed"), stress }
    }
}

impl Constitutive<f64> for Probe {
    type State<L: Lane<Real = f64>> = HypoelasticState<L>;
    fn name(&self) -> &'static str {
        "linear elastic with initial stress"
    }
    fn density(&self) -> f64 {
        1.0
    }
    fn virgin(&self) -> HypoelasticState<f64> {
        HypoelasticState { stress: Sym3(self.stress), volume_ratio: 1.0 }
    }
    #[inline(always)]
    fn update<L: Lane<Real = f64>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &HypoelasticState<L>,
    ) -> Update<L, HypoelasticState<L>> {
        self.elastic.update(kinematics, old)
    }
    #[inline(always)]
    fn stress<L: Lane<Real = f64>>(&self, now: &HypoelasticState<L>) -> Sym3<L> {
        self.elastic.stress(now)
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = f64>>(&self, now: &HypoelasticState<L>) -> L {
        self.elastic.volume_ratio(now)
    }
    #[inline(always)]
    fn wave_speed<L: Lane<Real = f64>>(&self, now: &HypoelasticState<L>) -> L {
        self.elastic.wave_speed(now)
    }
    #[inline(always)]
    fn energy<L: Lane<Real = f64>>(&self, now: &HypoelasticState<L>) -> L {
        self.elastic.energy(now)
    }
}

/// Body of irregularly placed particles.
pub(super) struct Body<const D: usize> {
    pub(super) seeds: Seeds<D>,
    centre: [f64; D],
    spacing: f64,
}

impl<const D: usize> Body<D> {
    /// Create `cells` cells from node `low` along every axis, with two displaced particles an axis and cell.
    pub(super) fn new(lattice: Lattice<D>, low: i64, cells: usize) -> Self {
        let h = lattice.spacing();
        let count = 2 * cells;
        let mut positions = Vec::new();
        let mut volumes = Vec::new();
        for n in 0..count.pow(D as u32) {
            let mut rest = n;
            let mut x = lattice.node([low; D]);
            for d in 0..D {
                // Irrational steps: irregular but reproducible.
                let off = 0.8 * (((n * (d + 2) + d) as f64 * 0.618_033_988_75).fract() - 0.5);
                x[d] += ((rest % count) as f64 + 0.5 + off) * 0.5 * h;
                rest /= count;
            }
            positions.push(x);
            volumes.push((0.5 * h).powi(D as i32) * (0.8 + 0.4 * (n as f64 * 0.414_213_562_37).fract()));
        }
        let mut centre = lattice.node([low; D]);
        for x in &mut centre {
            *x += 0.5 * cells as f64 * h;
        }
        let seeds = Seeds::placed(positions, volumes, [0.25 * h; D]);
        Body { seeds, centre, spacing: h }
    }

    /// Return the velocity of a flight at `speed`, cells a second, and a rotation in the xy plane at `rate`, 1/s.
    pub(super) fn velocity(&self, x: [f64; D], speed: f64, rate: f64) -> [f64; D] {
        let mut v = [0.0; D];
        for d in 0..D {
            v[d] = speed * self.spacing * (1.0 - 0.3 * d as f64);
        }
        v[0] -= rate * (x[1] - self.centre[1]);
        v[1] += rate * (x[0] - self.centre[0]);
        v
    }
}

/// Check that the transfer preserves a uniform velocity and works in a method: [`method`] with a quadratic B-spline,
/// USL and plane strain.
///
/// # Errors
/// The first violated property.
pub fn transfer<X: Transfer<f64>>(transfer: X) -> Result<(), Broken>
where
    QuadraticBSpline: Suits<X>,
    Usl: Allows<X>,
{
    for (v, dt) in [(0.0, 1.0), (-3.5, 1e-3), (17.0, 1e-9)] {
        let new: f64 = transfer.velocity(v, v, 0.0, dt);
        within(X::NAME, "a uniform velocity is left alone", (new - v).abs(), 0.0, || format!("v = {v}"))?;
    }
    method::<_, 2>(Method::new(QuadraticBSpline, transfer, Usl, PlaneStrain).compiled())
}

/// Check the method: a body in free flight conserves mass, momentum and, with an affine transfer that adopts the
/// nodal velocity (APIC) and a shape function of constant second moment (B-splines), angular momentum; rigid flight
/// causes no stress; a body at rest stays at rest; forces do the virtual work of the stresses (where a step leaves
/// forces on the grid: not with FMPM). Cartesian embeddings only. For a method without kernels in this crate:
/// `method(yours.compiled())`.
///
/// # Errors
/// The first violated property.
pub fn method<M: Composition<f64, D> + IntoKernels<f64, D>, const D: usize>(method: M) -> Result<(), Broken> {
    let name = method.describe();
    if M::Embedding::HOOP {
        let detail = "it is axisymmetric; this suite is for Cartesian embeddings".into();
        return Err(Broken { subject: name, property: "a Cartesian embedding", detail });
    }
    free_flight(method, &name)?;
    rigid(method, &name)?;
    if M::Transfer::ORDER < 2 {
        virtual_work(method, &name)?;
    }
    Ok(())
}

fn failed(name: &str, e: &dyn std::fmt::Display) -> Broken {
    Broken { subject: name.into(), property: "a run without breakdown", detail: e.to_string() }
}

fn scene<M: IntoKernels<f64, D>, const D: usize>(
    method: M,
    name: &str,
    stresses: &[[f64; 6]],
    dt: f64,
    speed: f64,
    rate: f64,
) -> Result<(Mpm<D>, Body<D>), Broken> {
    let lattice = Lattice::new([0.3; D], 0.5).map_err(|e| failed(name, &e))?;
    let body = Body::<D>::new(lattice, -2, 3);
    // This grid keeps its nodes when particles reach new ones: the tests read nodes after a step.
    let grid = DenseGrid::new(lattice, [-8; D], [15; D]).map_err(|e| failed(name, &e))?;
    let mut mpm = Mpm::new(method, grid);
    mpm.set_time_control(TimeControl::Fixed(dt)).map_err(|e| failed(name, &e))?;
    for (n, stress) in stresses.iter().enumerate() {
        let block = format!("block {n}");
        mpm.add(&block, Probe::new(*stress).compiled(), &body.seeds, |x| body.velocity(x, speed, rate))
            .map_err(|e| failed(name, &e))?;
    }
    Ok((mpm, body))
}

fn free_flight<M: Composition<f64, D> + IntoKernels<f64, D>, const D: usize>(
    method: M,
    name: &str,
) -> Result<(), Broken> {
    let (mut mpm, _) = scene(method, name, &[[0.0; 6]], 0.1, 0.9, 0.3)?;
    let before = mpm.totals();
    for _ in 0..30 {
        mpm.step().map_err(|e| failed(name, &e))?;
    }
    let after = mpm.totals();
    let lost = before.particles.abs_diff(after.particles) as f64;
    within(name, "conservation of the number of particles", lost, 0.0, String::new)?;
    let mass = (after.mass / before.mass - 1.0).abs();
    within(name, "conservation of mass", mass, 1e-14, || "30 steps of free flight".into())?;
    for d in 0..3 {
        let error = (after.momentum[d] - before.momentum[d]).abs() / before.momentum_scale;
        within(name, "conservation of momentum", error, 1e-13, || format!("component {d}, 30 steps"))?;
    }
    // With a FLIP fraction, the velocity of a particle is not the one of its affine matrix.
    if M::Transfer::AFFINE && !M::Transfer::READS_INCREMENT && even_inertia(&method) {
        // Part of the angular momentum is in the affine matrices, which the totals of particles omit.
        affine_momentum(&mut mpm, name)?;
    }
    Ok(())
}

/// True if the second moment of the weights is constant. Where it is not (GIMP), the affine transfer preserves affine
/// velocity fields but loses some angular momentum.
fn even_inertia<M: Composition<f64, D>, const D: usize>(method: &M) -> bool {
    let at = |xi: f64| -> f64 { method.shape().inertia(xi, 0.25) };
    (at(0.0) - at(0.37)).abs() < 1e-12
}

/// Check that the angular momentum on the grid is constant.
fn affine_momentum<const D: usize>(mpm: &mut Mpm<D>, name: &str) -> Result<(), Broken> {
    let mut first = None;
    for _ in 0..10 {
        mpm.step().map_err(|e| failed(name, &e))?;
        let (mut spin, mut scale) = (0.0, 0.0);
        each_node(mpm, |x, node| {
            let (m, v) = (node.first[0], &node.first[1..]);
            spin += m * (x[0] * v[1] - x[1] * v[0]);
            scale += m * (x[0].abs() + x[1].abs()) * (v[0].abs() + v[1].abs());
        });
        let start = *first.get_or_insert(spin);
        let error = (spin - start).abs() / scale;
        within(name, "conservation of angular momentum", error, 1e-13, || format!("step {}", mpm.steps()))?;
    }
    Ok(())
}

fn rigid<M: Composition<f64, D> + IntoKernels<f64, D>, const D: usize>(
    method: M,
    name: &str,
) -> Result<(), Broken> {
    for speed in [0.0, 1.7] {
        let (mut mpm, body) = scene(method, name, &[[0.0; 6]], 0.2, speed, 0.0)?;
        for _ in 0..20 {
            mpm.step().map_err(|e| failed(name, &e))?;
        }
        let (mut stress, mut place) = (0.0f64, 0.0f64);
        let time = mpm.time();
        mpm.bodies()[0].for_each(&mut |p| {
            let start = body.seeds.positions[p.number];
            let v = body.velocity(start, speed, 0.0);
            for s in p.stress {
                stress = if s.is_nan() { s } else { stress.max(s.abs()) };
            }
            for d in 0..D {
                place = place.max((p.position[d] - start[d] - v[d] * time).abs());
            }
        });
        let at = || format!("speed {speed} cells a second, 20 steps; Young's modulus 1");
        within(name, "no stress in rigid translation", stress, 1e-13, at)?;
        within(name, "the path of rigid translation", place, 1e-13, at)?;
    }
    Ok(())
}

/// Check sum_i f_i . w_i = -sum_p V sigma : grad w(x_p) for any nodal field w; hence no net force and moment.
fn virtual_work<M: Composition<f64, D> + IntoKernels<f64, D>, const D: usize>(
    method: M,
    name: &str,
) -> Result<(), Broken> {
    let stresses = [[1.0, 0.3, -0.4, 0.2, 0.5, -0.7], [-0.6, 0.9, 0.1, -0.3, 0.2, 0.4]];
    // The body is at rest: the velocity after one step is the impulse of the forces over the mass. With USF the
    // stress is updated first, from a velocity of zero.
    let dt = 1e-3;
    let (mut mpm, body) = scene(method, name, &stresses, dt, 0.0, 0.0)?;
    mpm.step().map_err(|e| failed(name, &e))?;
    let field = |x: &[f64; D], c: usize| {
        let mut phase = 1.0 + c as f64;
        for d in 0..D {
            phase += x[d] * (1.7 + 0.9 * (d + c) as f64);
        }
        phase.sin()
    };
    let (mut work, mut scale, mut net) = (0.0, 0.0, [0.0; D]);
    let (mut moment, mut mass) = (0.0, 0.0);
    each_node(&mpm, |x, node| {
        let m = node.first[0];
        mass += m;
        for c in 0..D {
            let force = m * node.first[c + 1] / dt;
            net[c] += force;
            work += force * field(x, c);
            scale += force.abs();
        }
        moment += m * (x[0] * node.first[2] - x[1] * node.first[1]) / dt;
    });
    let mut stress_work = 0.0;
    let lattice = *mpm.grid().lattice();
    for s in &stresses {
        let s = Sym3(*s);
        for (x, volume) in body.seeds.positions.iter().zip(&body.seeds.volumes) {
            for (node, gradient) in gradients::<M, D>(&method, &lattice, x, &body.seeds.half_size) {
                for c in 0..D {
                    for d in 0..D {
                        stress_work -= volume * s.at(c, d) * gradient[d] * field(&node, c);
                    }
                }
            }
        }
    }
    let total = stresses.len() as f64 * body.seeds.volumes.iter().sum::<f64>();
    within(
        name,
        "the mass of the nodes is that of the particles",
        (mass / total - 1.0).abs(),
        1e-13,
        String::new,
    )?;
    for c in 0..D {
        within(name, "internal forces without a net force", net[c].abs() / scale, 1e-13, || {
            format!("{net:?}")
        })?;
    }
    within(name, "internal forces without a net moment", moment.abs() / scale, 1e-13, String::new)?;
    let error = (work - stress_work).abs() / scale;
    within(name, "virtual work of forces = that of stresses", error, 1e-12, || {
        format!("{work} against {stress_work}")
    })
}

/// Return the nodes around a particle and the gradients of their weights.
fn gradients<M: Composition<f64, D>, const D: usize>(
    method: &M,
    lattice: &Lattice<D>,
    x: &[f64; D],
    half: &[f64; D],
) -> Vec<([f64; D], [f64; D])> {
    type Of<M, const D: usize> = <<M as Composition<f64, D>>::Shape as ShapeFunction<f64, D>>::Extent;
    let h = lattice.spacing();
    let mut list = vec![([0.0; D], [1.0; D])];
    for d in 0..D {
        let u = (x[d] - lattice.origin()[d]) / h - bin_centre::<Of<M, D>>();
        let bin = (u + 0.5).floor();
        let w = method.shape().weights(u - bin, half[d] / h);
        let mut longer = Vec::new();
        for (node, gradient) in &list {
            for a in 0..Of::<M, D>::NODES {
                let (mut node, mut gradient) = (*node, *gradient);
                let at = bin + bin_centre::<Of<M, D>>() + node_offset::<Of<M, D>>(a);
                node[d] = lattice.origin()[d] + h * at;
                // The affine fit of MLS has its own gradient.
                let inertia: f64 = method.shape().inertia(u - bin, half[d] / h);
                let offset = node_offset::<Of<M, D>>(a) - (u - bin);
                let fit = w.value[a] * offset / inertia;
                let slope = if M::Transfer::LEAST_SQUARES { fit } else { w.slope[a] };
                for e in 0..D {
                    gradient[e] *= if e == d { slope / h } else { w.value[a] };
                }
                longer.push((node, gradient));
            }
        }
        list = longer;
    }
    list
}

/// Visit all nodes with mass, and their positions.
fn each_node<const D: usize>(mpm: &Mpm<D>, mut visit: impl FnMut(&[f64; D], &crate::grid::Node<f64>)) {
    let (grid, block) = (mpm.grid(), crate::dim::BLOCK);
    let lattice = grid.lattice();
    let size = crate::dim::block_nodes(D);
    for (b, coordinates) in grid.blocks().iter().enumerate() {
        for (n, node) in grid.nodes()[b * size..][..size].iter().enumerate() {
            let mut rest = n;
            let mut index = [0; D];
            for d in 0..D {
                index[d] = i64::from(coordinates[d]) * block as i64 + (rest % block) as i64;
                rest /= block;
            }
            if node.first[0] > 0.0 {
                visit(&lattice.node(index), node);
            }
        }
    }
}
