//! The sweeps over elements: steps 1 to 10 of \[Feng2014\], on vectors of elements.

use std::marker::PhantomData;

use mpm_core::Embedding;
use mpm_core::parallel::{Arch, Kernel, Pack};
use mpm_materials::{Breakdown, Constitutive, Fault, Kinematics, Lane, Mat3, Sink, Source, State, Sym3};

use crate::elements::{Batch, GROUP, Report, Row};
use crate::kinematics::{Configuration, Dilatation, with_volume};
use crate::method::Composition;
use crate::particles::Particle;
use crate::simplex::Slopes;

/// Reads a state from the rows of a group.
struct Rows<'a> {
    rows: &'a [Row],
    at: usize,
}
impl<P: Pack<f64, Numbers = Row>> Source<P> for Rows<'_> {
    #[inline(always)]
    fn take(&mut self) -> P {
        self.at += 1;
        P::load(&self.rows[self.at - 1])
    }
}
/// Writes a state to the rows of a group.
struct RowsMut<'a> {
    rows: &'a mut [Row],
    at: usize,
}
impl<P: Pack<f64, Numbers = Row>> Sink<P> for RowsMut<'_> {
    #[inline(always)]
    fn put(&mut self, value: P) {
        value.store(&mut self.rows[self.at]);
        self.at += 1;
    }
}

/// What a sweep does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// Changes of volume, to be averaged over particles.
    Stretch,
    /// Velocity gradient, law; then nodal forces or, where pressures are averaged, Kirchhoff mean stresses.
    Stress,
    /// Kirchhoff mean stresses of the states as they are.
    Pressure,
    /// Nodal forces of the states as they are.
    Force,
}

/// A sweep over a batch of elements.
pub(crate) struct Sweep<'a, const D: usize, C, M> {
    pub pass: Pass,
    pub law: &'a C,
    pub particles: &'a [Particle<D>],
    /// Of this batch.
    pub nodes: &'a [u32],
    /// Of this batch.
    pub reference: &'a [f64],
    /// Averages at the particles: of volume factors in [`Pass::Stress`], of Kirchhoff mean stresses in
    /// [`Pass::Force`].
    pub averages: &'a [f64],
    pub dt: f64,
    pub batch: &'a mut Batch,
    pub output: Output<'a, D>,
    pub method: PhantomData<M>,
}

/// Where the results of a sweep go.
pub(crate) enum Output<'a, const D: usize> {
    /// Forces of the corners, N.
    Forces(&'a mut [[f64; D]]),
    /// One number an element.
    Scalars(&'a mut [f64]),
}

/// Positions and velocities of the corners of a group.
#[derive(Clone, Copy)]
struct Corner<P> {
    x: [P; 3],
    v: [P; 3],
}

impl<const D: usize, C, M> Sweep<'_, D, C, M> {
    /// The corners of a group. Lanes without an element get a simplex at rest.
    #[inline(always)]
    fn corners<P: Pack<f64, Numbers = Row>>(&self, group: usize) -> [Corner<P>; 4] {
        let zero = P::zero();
        let mut corners = [Corner { x: [zero; 3], v: [zero; 3] }; 4];
        for a in 0..=D {
            let mut x = [Row::default(); D];
            let mut v = [Row::default(); D];
            for lane in 0..GROUP {
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
                corners[a].x[d] = P::load(&x[d]);
                corners[a].v[d] = P::load(&v[d]);
            }
        }
        corners
    }

    /// The mean over the corners of a group of a number at the particles; `idle` without an element.
    #[inline(always)]
    fn mean_at_corners<P: Pack<f64, Numbers = Row>>(&self, group: usize, idle: f64) -> P {
        let mut sum = Row::default();
        for lane in 0..GROUP {
            let e = group * GROUP + lane;
            let mut mean = idle;
            if e < self.reference.len() {
                let nodes = &self.nodes[e * (D + 1)..(e + 1) * (D + 1)];
                mean = nodes.iter().map(|&n| self.averages[n as usize]).sum::<f64>() / (D + 1) as f64;
            }
            sum.as_mut()[lane] = mean;
        }
        P::load(&sum)
    }

    #[inline(always)]
    fn reference<P: Pack<f64, Numbers = Row>>(&self, group: usize) -> P {
        let mut row = Row::default();
        for lane in 0..GROUP {
            row.as_mut()[lane] = self.reference.get(group * GROUP + lane).copied().unwrap_or(0.0);
        }
        P::load(&row)
    }
}

/// Corners a part of the step back.
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

/// Mean of the first coordinate.
#[inline(always)]
fn radius<P: Lane>(x: &[[P; 3]; 4], d: usize) -> P {
    let mut sum = x[0][0];
    for a in 1..=d {
        sum = sum + x[a][0];
    }
    sum * P::of(1.0 / (d + 1) as f64)
}

/// Step 1: the velocity gradient, and the hoop rate around an axis.
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

/// Volume over that before the step.
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

/// The edge of the square (cube) that the element is half (a sixth) of.
#[inline(always)]
fn length<P: Lane>(measure: P, d: usize) -> P {
    let measure = measure.abs();
    if d == 2 {
        (measure + measure).sqrt()
    } else {
        (measure * P::of(6.0)).max(P::of(f64::MIN_POSITIVE)).powf(P::of(1.0 / 3.0))
    }
}

/// Step 10: minus V sigma grad N at each corner, and the hoop stress's push along the radius. `volume` is that of the
/// element's mass, V0 J.
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

impl<const D: usize, C, M> Kernel<f64> for Sweep<'_, D, C, M>
where
    C: Constitutive<f64>,
    M: Composition<D>,
{
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(mut self) {
        let hoop = M::Embedding::HOOP;
        let averaged = M::Dilatation::AVERAGED;
        let numbers = <C::State<A::Pack> as State<A::Pack>>::LEN;
        let elements = self.reference.len();
        let dt = A::Pack::splat(self.dt);
        let back = A::Pack::splat(self.dt * M::Configuration::BACK);
        let mut report = Report::default();
        for group in 0..elements.div_ceil(GROUP) {
            let corners = self.corners::<A::Pack>(group);
            let now = positions(&corners, D, A::Pack::zero());
            let slopes = Slopes::of(&now, D);
            let alive = (elements - group * GROUP).min(GROUP);
            if self.pass == Pass::Stretch {
                let ratio = volume_ratio(&corners, &now, slopes.measure, dt, D, hoop);
                put::<A::Pack, D>(&mut self.output, group, alive, ratio);
                continue;
            }
            let rows = group * numbers..(group + 1) * numbers;
            let mut source = Rows { rows: &self.batch.rows[rows.clone()], at: 0 };
            let mut state = <C::State<A::Pack> as State<A::Pack>>::read(&mut source);
            let mut stress = self.law.stress(&state);

            if self.pass == Pass::Stress {
                let at = positions(&corners, D, back);
                let middle = Slopes::of(&at, D);
                let mut increment = velocity_gradient(&corners, &at, &middle, D, hoop) * dt;
                if averaged {
                    increment = with_volume(&increment, self.mean_at_corners(group, 1.0));
                } else if M::Configuration::KEEPS_VOLUME {
                    let ratio = volume_ratio(&corners, &now, slopes.measure, dt, D, hoop);
                    increment = with_volume(&increment, ratio);
                }
                // Steps 2 to 9: strain, split, deviator, pressure, yield, viscosity, total stress.
                let kinematics = Kinematics { increment, dt, length: length(slopes.measure, D) };
                let update = self.law.update(&kinematics, &state);
                state = update.state;
                stress = update.stress;
                let upright = slopes.measure.gt(A::Pack::zero());
                let fault = update.fault.or(Fault::none().require(upright, Breakdown::InvertedVolume));
                if fault.any() && report.trouble.is_none() {
                    for lane in 0..alive {
                        if let (None, Some(cause)) = (report.trouble, fault.cause(lane)) {
                            report.trouble = Some((group * GROUP + lane, cause));
                        }
                    }
                }
                let mut sink = RowsMut { rows: &mut self.batch.rows[rows], at: 0 };
                state.write(&mut sink);
            }
            if self.pass != Pass::Pressure {
                let rate = self.law.wave_speed(&state) * slopes.steepest(D);
                for lane in 0..alive {
                    report.rate = report.rate.max(rate.lane(lane));
                }
            }
            let j = self.law.volume_ratio(&state);
            if averaged && self.pass != Pass::Force {
                put::<A::Pack, D>(&mut self.output, group, alive, stress.mean() * j);
                continue;
            }
            if averaged {
                let mean = self.mean_at_corners::<A::Pack>(group, 0.0) / j;
                stress = stress.plus_isotropic(mean - stress.mean());
            }
            let volume = self.reference::<A::Pack>(group) * j;
            let at_radius = if hoop { Some(radius(&now, D)) } else { None };
            let force = nodal_forces(&stress, &slopes, volume, at_radius, D);
            if let Output::Forces(forces) = &mut self.output {
                for lane in 0..alive {
                    for a in 0..=D {
                        let out = &mut forces[(group * GROUP + lane) * (D + 1) + a];
                        for d in 0..D {
                            out[d] = force[a][d].lane(lane);
                        }
                    }
                }
            }
        }
        self.batch.report = report;
    }
}

/// One number an element.
#[inline(always)]
fn put<P: Lane<Real = f64>, const D: usize>(output: &mut Output<'_, D>, group: usize, alive: usize, x: P) {
    if let Output::Scalars(list) = output {
        for lane in 0..alive {
            list[group * GROUP + lane] = x.lane(lane);
        }
    }
}
