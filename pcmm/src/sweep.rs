//! Sweeps over elements: steps 1 to 10 of \[Feng2014\], on vectors of elements.

use std::marker::PhantomData;

use impactite_scene::Embedding;
use impactite_simd::{Arch, Float, Kernel, Pack, Vectors};
use mpm_materials::material::{Deformation, Length, Material, Motion, Response, States, StatesMut};
use mpm_materials::{Breakdown, Lane, Mask, Mat3, Sym3, with_volume};

use crate::elements::{BATCH, Batch, GROUP, Report, Row};
use crate::kinematics::{Configuration, Dilatation};
use crate::method::Composition;
use crate::particles::Particle;
use crate::simplex::Slopes;

/// Scratch memory of a thread for the constitutive update of a batch.
#[derive(Debug, Default)]
pub(crate) struct Waiting {
    deformations: Vec<Deformation<Row>>,
    /// Sizes of the elements, m.
    lengths: Vec<Row>,
    response: Response<f64>,
}

/// Indices of the groups of a batch, which are contiguous.
const GROUPS: [u32; BATCH / GROUP] = {
    let mut groups = [0; BATCH / GROUP];
    let mut n = 0;
    while n < groups.len() {
        groups[n] = n as u32;
        n += 1;
    }
    groups
};

/// Pass of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// Volume changes, to be averaged over particles.
    Stretch,
    /// Velocity gradient, law; then nodal forces or, with averaged pressures, Kirchhoff mean stresses.
    Stress,
    /// Kirchhoff mean stresses of the present states.
    Pressure,
    /// Nodal forces of the present states.
    Force,
}

/// Elements of a batch.
#[derive(Clone, Copy)]
pub(crate) struct Of<'a, const D: usize> {
    pub particles: &'a [Particle<D>],
    pub nodes: &'a [u32],
    pub reference: &'a [f64],
    /// Averages at the particles: of volume factors in [`Pass::Stress`], of Kirchhoff mean stresses in
    /// [`Pass::Force`].
    pub averages: &'a [f64],
    pub dt: f64,
}

/// Sweep over a batch of elements of a law with this number of state variables.
pub(crate) fn sweep<const D: usize, M: Composition<D>>(
    pass: Pass,
    of: &Of<'_, D>,
    (material, numbers): (&dyn Material<f64>, usize),
    batch: &mut Batch,
    waiting: &mut Waiting,
    output: Output<'_, D>,
) {
    let groups = &GROUPS[..of.reference.len().div_ceil(GROUP)];
    let (method, mut report) = (PhantomData::<M>, Report::default());
    match pass {
        Pass::Stretch => {
            batch.report = report;
            return f64::dispatch(Stretch { of, output, method });
        }
        Pass::Stress => {
            waiting.deformations.resize(groups.len().div_ceil(2), Deformation::default());
            waiting.lengths.resize(groups.len(), Row::default());
            let (deformations, lengths) = (&mut waiting.deformations[..], &mut waiting.lengths[..]);
            let inverted = f64::dispatch(Strain { of, deformations, lengths, method });
            // Steps 2 to 9: strain, split, deviator, pressure, yield, viscosity, total stress.
            let length = Length::Each(&waiting.lengths);
            let motion = Motion { deformation: &waiting.deformations, dt: of.dt, length };
            let states = StatesMut { all: &mut batch.rows, stride: numbers, first: 0, groups };
            material.advance(&motion, states, true, &mut waiting.response);
            let here = |e: &usize| *e < of.reference.len();
            let broken = waiting.response.faults().iter().map(|f| (f.group * GROUP + f.lane, f.cause));
            let broken = broken.filter(|(e, _)| here(e)).min_by_key(|(e, _)| *e);
            let inverted = inverted.map(|e| (e, Breakdown::InvertedVolume));
            // For the same element the law's own cause precedes inversion.
            report.trouble = broken.into_iter().chain(inverted).min_by_key(|(e, _)| *e);
        }
        Pass::Pressure | Pass::Force => {
            let states = States { all: &batch.rows, stride: numbers, first: 0, groups };
            // Viscous stresses, which limit the time step by the size of elements, come with the first strain.
            material.describe(states, f64::INFINITY, &mut waiting.response);
        }
    }
    let response = &waiting.response;
    report.rate = f64::dispatch(Give { pass, of, response, output, method });
    batch.report = report;
}

/// Volume changes, to be averaged over particles.
struct Stretch<'a, const D: usize, M> {
    of: &'a Of<'a, D>,
    output: Output<'a, D>,
    method: PhantomData<M>,
}

/// Step 1: deformations of elements, and their sizes. Returns the first inverted element.
struct Strain<'a, const D: usize, M> {
    of: &'a Of<'a, D>,
    deformations: &'a mut [Deformation<Row>],
    lengths: &'a mut [Row],
    method: PhantomData<M>,
}

/// Step 10: nodal forces or, with averaged pressures, Kirchhoff mean stresses. Returns the largest wave speed over smallest altitude, 1/s,
/// except in [`Pass::Pressure`].
struct Give<'a, const D: usize, M> {
    pass: Pass,
    of: &'a Of<'a, D>,
    response: &'a Response<f64>,
    output: Output<'a, D>,
    method: PhantomData<M>,
}

/// Output of a sweep.
pub(crate) enum Output<'a, const D: usize> {
    /// Forces on the corners, N.
    Forces(&'a mut [[f64; D]]),
    /// One number per element.
    Scalars(&'a mut [f64]),
}

/// Positions and velocities of the corners of a group.
#[derive(Clone, Copy)]
struct Corner<P> {
    x: [P; 3],
    v: [P; 3],
}

impl<const D: usize> Of<'_, D> {
    /// Load the corners of the elements in some lanes of a group. Lanes without an element have a simplex at rest.
    #[inline(always)]
    fn corners<P: Pack<f64>>(&self, group: usize, first: usize) -> [Corner<P>; 4] {
        let zero = P::zero();
        let mut corners = [Corner { x: [zero; 3], v: [zero; 3] }; 4];
        for a in 0..=D {
            let mut x = [Row::default(); D];
            let mut v = [Row::default(); D];
            for lane in first..first + P::WIDTH.min(GROUP) {
                let e = group * GROUP + lane;
                if e < self.reference.len() {
                    let p = &self.particles[self.nodes[e * (D + 1) + a] as usize];
                    for d in 0..D {
                        x[d].as_mut()[lane] = p.position[d];
                        v[d].as_mut()[lane] = p.velocity[d];
                    }
                } else if a > 0 {
                    x[a - 1].as_mut()[lane] = 1.0;
                }
            }
            for d in 0..D {
                corners[a].x[d] = of_row(&x[d], first);
                corners[a].v[d] = of_row(&v[d], first);
            }
        }
        corners
    }

    /// Return the mean over the corners of elements of a number at the particles; `idle` without an element.
    #[inline(always)]
    fn mean_at_corners<P: Pack<f64>>(&self, group: usize, first: usize, idle: f64) -> P {
        let mut sum = Row::default();
        for lane in first..first + P::WIDTH.min(GROUP) {
            let e = group * GROUP + lane;
            let mut mean = idle;
            if e < self.reference.len() {
                let nodes = &self.nodes[e * (D + 1)..(e + 1) * (D + 1)];
                mean = nodes.iter().map(|&n| self.averages[n as usize]).sum::<f64>() / (D + 1) as f64;
            }
            sum.as_mut()[lane] = mean;
        }
        of_row(&sum, first)
    }

    #[inline(always)]
    fn reference<P: Pack<f64>>(&self, group: usize, first: usize) -> P {
        let mut row = Row::default();
        for lane in first..first + P::WIDTH.min(GROUP) {
            row.as_mut()[lane] = self.reference.get(group * GROUP + lane).copied().unwrap_or(0.0);
        }
        of_row(&row, first)
    }

    /// Return the number of elements in the lanes of a pack that begins at a lane of a group.
    #[inline(always)]
    fn alive<P: Pack<f64>>(&self, group: usize, first: usize) -> usize {
        self.reference.len().saturating_sub(group * GROUP + first).min(P::WIDTH)
    }
}

/// Load the numbers of a row.
#[inline(always)]
fn of_row<P: Pack<f64>>(row: &Row, lane: usize) -> P {
    P::from_rows([row, row], lane)
}

/// Return the positions of corners `back` seconds ago.
#[inline(always)]
fn positions<P: Lane>(corners: &[Corner<P>; 4], d: usize, back: P) -> [[P; 3]; 4] {
    let mut x = [[P::zero(); 3]; 4];
    for a in 0..=d {
        for i in 0..d {
            x[a][i] = corners[a].x[i] - corners[a].v[i] * back;
        }
    }
    x
}

/// Return the mean of the first coordinate.
#[inline(always)]
fn radius<P: Lane>(x: &[[P; 3]; 4], d: usize) -> P {
    let mut sum = x[0][0];
    for a in 1..=d {
        sum = sum + x[a][0];
    }
    sum * P::of(1.0 / (d + 1) as f64)
}

/// Step 1: velocity gradient, and hoop rate around an axis.
#[inline(always)]
fn velocity_gradient<P: Lane>(
    corners: &[Corner<P>; 4],
    x: &[[P; 3]; 4],
    slopes: &Slopes<P>,
    d: usize,
    hoop: bool,
) -> Mat3<P> {
    let mut gradient = Mat3::zero();
    for a in 0..=d {
        for i in 0..d {
            for j in 0..d {
                gradient.0[i][j] = corners[a].v[i].mul_add(slopes.of[a][j], gradient.0[i][j]);
            }
        }
    }
    if hoop {
        let mut sum = corners[0].v[0];
        for a in 1..=d {
            sum = sum + corners[a].v[0];
        }
        gradient.0[2][2] = sum * P::of(1.0 / (d + 1) as f64) / radius(x, d);
    }
    gradient
}

/// Return the volume over that before the step.
#[inline(always)]
fn volume_ratio<P: Lane>(
    corners: &[Corner<P>; 4],
    now: &[[P; 3]; 4],
    measure: P,
    dt: P,
    d: usize,
    hoop: bool,
) -> P {
    let before = positions(corners, d, dt);
    let ratio = measure / Slopes::of(&before, d).measure;
    if hoop { ratio * radius(now, d) / radius(&before, d) } else { ratio }
}

/// Element size: edge of the square (cube) that the element is half (a sixth) of.
#[inline(always)]
fn length<P: Lane>(measure: P, d: usize) -> P {
    let measure = measure.abs();
    if d == 2 {
        (measure + measure).sqrt()
    } else {
        (measure * P::of(6.0)).max(P::of(f64::MIN_POSITIVE)).powf(P::of(1.0 / 3.0))
    }
}

/// Step 10: nodal forces, minus V sigma grad N at each corner, and the radial force of the hoop stress. `volume` is that of the element's
/// mass, V0 J.
#[inline(always)]
fn nodal_forces<P: Lane>(
    stress: &Sym3<P>,
    slopes: &Slopes<P>,
    volume: P,
    radius: Option<P>,
    d: usize,
) -> [[P; 3]; 4] {
    let mut force = [[P::zero(); 3]; 4];
    for a in 0..=d {
        for i in 0..d {
            let mut sum = P::zero();
            for j in 0..d {
                sum = stress.at(i, j).mul_add(slopes.of[a][j], sum);
            }
            force[a][i] = -(sum * volume);
        }
        if let Some(r) = radius {
            let push = stress.0[2] * volume * P::of(1.0 / (d + 1) as f64) / r;
            force[a][0] = force[a][0] - push;
        }
    }
    force
}

impl<const D: usize, M: Composition<D>> Kernel<f64> for Stretch<'_, D, M> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let Stretch { of, mut output, .. } = self;
        let dt = A::Pack::splat(of.dt);
        for group in 0..of.reference.len().div_ceil(GROUP) {
            for lane in (0..GROUP).step_by(A::Pack::WIDTH) {
                let corners = of.corners::<A::Pack>(group, lane);
                let now = positions(&corners, D, A::Pack::zero());
                let measure = Slopes::of(&now, D).measure;
                let ratio = volume_ratio(&corners, &now, measure, dt, D, M::Embedding::HOOP);
                let alive = of.alive::<A::Pack>(group, lane);
                put::<A::Pack, D>(&mut output, group * GROUP + lane, alive, ratio);
            }
        }
    }
}

impl<const D: usize, M: Composition<D>> Kernel<f64> for Strain<'_, D, M> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = Option<usize>;

    #[inline(always)]
    fn run<A: Arch<f64>>(self) -> Option<usize> {
        let Strain { of, deformations, lengths, .. } = self;
        let hoop = M::Embedding::HOOP;
        let dt = A::Pack::splat(of.dt);
        let back = A::Pack::splat(of.dt * M::Configuration::BACK);
        let mut inverted = None;
        for group in 0..of.reference.len().div_ceil(GROUP) {
            for lane in (0..GROUP).step_by(A::Pack::WIDTH) {
                let corners = of.corners::<A::Pack>(group, lane);
                let now = positions(&corners, D, A::Pack::zero());
                let slopes = Slopes::of(&now, D);
                let at = positions(&corners, D, back);
                let middle = Slopes::of(&at, D);
                let mut increment = velocity_gradient(&corners, &at, &middle, D, hoop) * dt;
                if M::Dilatation::AVERAGED {
                    increment = with_volume(&increment, of.mean_at_corners(group, lane, 1.0));
                }
                // The gradient is the increment itself, with a step of one.
                let to = &mut deformations[group / 2];
                A::Pack::one().to_pair(&mut to.step, group % 2, lane);
                for i in 0..3 {
                    for j in 0..3 {
                        increment.0[i][j].to_pair(&mut to.gradient[3 * i + j], group % 2, lane);
                    }
                }
                length(slopes.measure, D).to_row(0, &mut lengths[group], lane);
                let upright = slopes.measure.gt(A::Pack::zero());
                if !upright.all() && inverted.is_none() {
                    let alive = of.alive::<A::Pack>(group, lane);
                    inverted = (0..alive).find(|&k| !upright.lane(k)).map(|k| group * GROUP + lane + k);
                }
            }
        }
        inverted
    }
}

impl<const D: usize, M: Composition<D>> Kernel<f64> for Give<'_, D, M> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = f64;

    #[inline(always)]
    fn run<A: Arch<f64>>(self) -> f64 {
        let Give { pass, of, response, mut output, .. } = self;
        let hoop = M::Embedding::HOOP;
        let averaged = M::Dilatation::AVERAGED;
        let mut fastest: f64 = 0.0;
        for group in 0..of.reference.len().div_ceil(GROUP) {
            let (said, half) = (&response.outputs()[group / 2], group % 2);
            for lane in (0..GROUP).step_by(A::Pack::WIDTH) {
                let alive = of.alive::<A::Pack>(group, lane);
                let element = group * GROUP + lane;
                let corners = of.corners::<A::Pack>(group, lane);
                let now = positions(&corners, D, A::Pack::zero());
                let slopes = Slopes::of(&now, D);
                if pass != Pass::Pressure {
                    let rate = A::Pack::from_pair(&said.step_speed, half, lane) * slopes.steepest(D);
                    for k in 0..alive {
                        fastest = fastest.max(rate.lane(k));
                    }
                }
                let mut stress = Sym3::<A::Pack>::zero();
                for i in 0..6 {
                    stress.0[i] = A::Pack::from_pair(&said.stress[i], half, lane);
                }
                let j = A::Pack::from_pair(&said.volume_ratio, half, lane);
                if averaged && pass != Pass::Force {
                    put::<A::Pack, D>(&mut output, element, alive, stress.mean() * j);
                    continue;
                }
                if averaged {
                    let mean = of.mean_at_corners::<A::Pack>(group, lane, 0.0) / j;
                    stress = stress.plus_isotropic(mean - stress.mean());
                }
                let volume = of.reference::<A::Pack>(group, lane) * j;
                let at_radius = if hoop { Some(radius(&now, D)) } else { None };
                let force = nodal_forces(&stress, &slopes, volume, at_radius, D);
                if let Output::Forces(forces) = &mut output {
                    for k in 0..alive {
                        for a in 0..=D {
                            let out = &mut forces[(element + k) * (D + 1) + a];
                            for d in 0..D {
                                out[d] = force[a][d].lane(k);
                            }
                        }
                    }
                }
            }
        }
        fastest
    }
}

/// Store one number per element, from `element` on.
#[inline(always)]
fn put<P: Lane<Real = f64>, const D: usize>(output: &mut Output<'_, D>, element: usize, alive: usize, x: P) {
    if let Output::Scalars(list) = output {
        for lane in 0..alive {
            list[element + lane] = x.lane(lane);
        }
    }
}
