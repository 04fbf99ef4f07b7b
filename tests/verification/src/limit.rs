//! Stable time step limit: measured in runs, from eigenvalues of the update matrix, and from Gershgorin circles.
//!
//! A free elastic bar at small strain, of unit modulus, density and cell size, in one row of particles between two
//! symmetry planes: one-dimensional, but with the step of the library. Its matrices are assembled from the library's
//! weights. The update of velocities and strains at frozen positions is a matrix; the step is unstable if an eigenvalue
//! exceeds one in magnitude (book, "The stable time step").

use faer::{Mat, Side};
use mpm_core::{Boundary, PlaneStrain};

use crate::problems::{box_of_planes, lattice, rubber};
use crate::scene::{Moment, Run, Scene, block};
use crate::scheme::{Kernel, Scheme, Velocity, kernels};

/// Number of cells of the bar.
const CELLS: usize = 8;

/// Limits of dt c / h for one arrangement of particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Numerical scheme.
    pub scheme: Scheme,
    /// Particles per cell.
    pub per_cell: usize,
    /// Offset of the bar's end behind a node, in cells.
    pub offset: f64,
    /// Largest step at which noise in a run of the library does not grow.
    pub measured: f64,
    /// Largest step whose update matrix has no eigenvalue beyond one.
    pub predicted: f64,
    /// Eigenvalue estimate: sqrt(2) / omega with USL, 2 / omega with MUSL, omega the highest nodal frequency with
    /// lumped masses.
    pub eigenvalue: f64,
    /// Gershgorin estimate: the same with the bound of omega by Gershgorin circles, as used by the time control.
    pub gershgorin: f64,
}

/// Node index, weight and gradient.
type Reach = (i32, f64, f64);

/// Weights and gradients of particles at the nodes along the bar.
struct Bar {
    masses: Vec<f64>,
    lumped: Vec<f64>,
    /// Matrix of particles (rows) by nodes.
    weights: Mat<f64>,
    slopes: Mat<f64>,
    /// Node position minus particle position.
    arms: Mat<f64>,
    /// Frequency bound of the library.
    bound: f64,
}

impl Bar {
    fn of(moment: &Moment<'_, 2>) -> Option<Self> {
        let grid = moment.grid()?;
        // Weight, gradient and arm per node of every particle; nodes across the bar move together.
        let mut rows: Vec<(f64, Vec<Reach>)> = Vec::new();
        grid.bodies()[0].footprints(moment.time, &mut |p| {
            rows.push((p.mass, p.nodes.iter().map(|w| (w.node[0], w.value, w.gradient[0])).collect()));
        });
        let nodes = || rows.iter().flat_map(|row| row.1.iter().filter(|w| w.1 != 0.0).map(|w| w.0));
        let (low, high) = (nodes().min().unwrap_or(0), nodes().max().unwrap_or(0));
        let (n, p) = ((high - low + 1) as usize, rows.len());
        let mut bar = Bar {
            masses: rows.iter().map(|row| row.0).collect(),
            lumped: vec![0.0; n],
            weights: Mat::zeros(p, n),
            slopes: Mat::zeros(p, n),
            arms: Mat::zeros(p, n),
            bound: grid.frequency_bound().bound,
        };
        for (k, (mass, weights)) in rows.iter().enumerate() {
            for &(node, value, slope) in weights.iter().filter(|w| (low..=high).contains(&w.0)) {
                let i = (node - low) as usize;
                bar.weights[(k, i)] += value;
                bar.slopes[(k, i)] += slope;
                bar.lumped[i] += mass * value;
            }
            let x: f64 = (0..n).map(|i| bar.weights[(k, i)] * i as f64).sum();
            (0..n).for_each(|i| bar.arms[(k, i)] = i as f64 - x);
        }
        Some(bar)
    }

    /// Iterate over nodes with mass.
    fn nodes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.lumped.len()).filter(|&i| self.lumped[i] > 1e-14)
    }

    /// Return the highest nodal frequency with lumped masses, from K x = omega^2 M x in symmetric form.
    fn frequency(&self) -> Result<f64, String> {
        let nodes: Vec<usize> = self.nodes().collect();
        let scaled = Mat::from_fn(nodes.len(), nodes.len(), |a, b| {
            let (i, j) = (nodes[a], nodes[b]);
            // Stiffness with modulus 1; the volume equals the mass.
            let k: f64 = (0..self.masses.len())
                .map(|p| self.masses[p] * self.slopes[(p, i)] * self.slopes[(p, j)])
                .sum();
            k / (self.lumped[i] * self.lumped[j]).sqrt()
        });
        let values = scaled.self_adjoint_eigenvalues(Side::Lower).map_err(|e| format!("{e:?}"))?;
        Ok(values.iter().fold(0.0f64, |most, &x| most.max(x)).sqrt())
    }

    /// Return the limit of FLIP with MUSL, 2 / sqrt(lambda_max(A K)) with A = M^-1 Mc M^-1 and Mc the consistent mass (book, "Properties of
    /// stress updates and transfers", finding 1), in the symmetric form of the particles.
    fn symplectic(&self) -> Result<f64, String> {
        let p = self.masses.len();
        // Strain at a particle due to the momentum of another, scaled by the square roots of mass.
        let strain = Mat::from_fn(p, p, |a, b| {
            let sum: f64 =
                self.nodes().map(|i| self.slopes[(a, i)] * self.weights[(b, i)] / self.lumped[i]).sum();
            sum * (self.masses[a] * self.masses[b]).sqrt()
        });
        let square = strain.transpose() * &strain;
        let values = square.self_adjoint_eigenvalues(Side::Lower).map_err(|e| format!("{e:?}"))?;
        Ok(2.0 / values.iter().fold(0.0f64, |most, &x| most.max(x)).sqrt())
    }

    /// Return the update matrix of a step `dt` for velocities, strains and (APIC) affine velocities of the
    /// particles.
    fn step(&self, velocity: Velocity, dt: f64) -> Mat<f64> {
        let p = self.masses.len();
        let size = if velocity == Velocity::ApicUsl { 3 * p } else { 2 * p };
        let mut matrix = Mat::zeros(size, size);
        for column in 0..size {
            let mut state = vec![0.0; size];
            state[column] = 1.0;
            self.advance(velocity, dt, &mut state);
            (0..size).for_each(|row| matrix[(row, column)] = state[row]);
        }
        matrix
    }

    /// Return the nodal velocities mapped from the particles.
    fn mapped(&self, v: &[f64], affine: &[f64]) -> Vec<f64> {
        let mut nodes = vec![0.0; self.lumped.len()];
        for i in self.nodes() {
            for p in 0..self.masses.len() {
                let at = v[p] + affine.get(p).map_or(0.0, |b| b * self.arms[(p, i)]);
                nodes[i] += self.weights[(p, i)] * self.masses[p] * at / self.lumped[i];
            }
        }
        nodes
    }

    fn advance(&self, velocity: Velocity, dt: f64, state: &mut [f64]) {
        let p = self.masses.len();
        let (v, rest) = state.split_at_mut(p);
        let (strain, affine) = rest.split_at_mut(p);
        let before = self.mapped(v, affine);
        let mut gain = vec![0.0; before.len()];
        for i in self.nodes() {
            let pull: f64 = (0..p).map(|k| self.masses[k] * strain[k] * self.slopes[(k, i)]).sum();
            gain[i] = -dt * pull / self.lumped[i];
        }
        let at = |nodes: &[f64], k: usize, of: &Mat<f64>| -> f64 {
            self.nodes().map(|i| of[(k, i)] * nodes[i]).sum()
        };
        let mut after: Vec<f64> = before.iter().zip(&gain).map(|(a, b)| a + b).collect();
        for k in 0..p {
            v[k] = match velocity {
                Velocity::ApicUsl => at(&after, k, &self.weights),
                _ => v[k] + at(&gain, k, &self.weights),
            };
        }
        for (k, affine) in affine.iter_mut().enumerate() {
            let moment = |power: i32| -> f64 {
                let of = |i: usize| self.weights[(k, i)] * self.arms[(k, i)].powi(power);
                self.nodes().map(|i| of(i) * if power == 1 { after[i] } else { 1.0 }).sum()
            };
            *affine = moment(1) / moment(2);
        }
        if velocity == Velocity::FlipMusl {
            after = self.mapped(v, &[]);
        }
        for k in 0..p {
            strain[k] += dt * at(&after, k, &self.slopes);
        }
    }

    /// Return the largest step without an eigenvalue beyond one.
    fn limit(&self, velocity: Velocity) -> Result<f64, String> {
        bisect(|dt| {
            let values = self.step(velocity, dt).eigenvalues().map_err(|e| format!("{e:?}"))?;
            // Rigid motion with zero strain is a double eigenvalue of one, accurate to the square root of
            // round-off.
            Ok(values.iter().all(|z| z.re.hypot(z.im) < 1.0 + 1e-6))
        })
    }
}

/// Find the largest number up to 4 that satisfies a monotonic condition, to 0.2 %, by bisection.
fn bisect(holds: impl Fn(f64) -> Result<bool, String>) -> Result<f64, String> {
    let (mut low, mut high) = (0.0, 4.0);
    while high - low > 0.002 * high {
        let middle = 0.5 * (low + high);
        if holds(middle)? {
            low = middle;
        } else {
            high = middle;
        }
        if high < 1e-3 {
            return Ok(0.0);
        }
    }
    Ok(0.5 * (low + high))
}

/// Return a pseudo-random number in -1 .. 1.
fn noise(k: usize) -> f64 {
    let mut z = (k as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Run the bar from velocity noise of 1e-9 c; return the failure message, if any.
fn run(
    scheme: Scheme,
    per_cell: usize,
    offset: f64,
    (dt, steps): (f64, u64),
    look: &mut dyn FnMut(&Moment<'_, 2>),
) -> Result<Option<String>, String> {
    let mut seeds = block(&lattice([0.0; 2], 1.0)?, [0; 2], [CELLS * per_cell, 1], 1);
    let width = 1.0 / per_cell as f64;
    for x in &mut seeds.positions {
        x[0] = x[0] * width + offset;
    }
    seeds.volumes.fill(width);
    seeds.half_size = [0.5 * width, 0.5];
    let boundaries: Vec<Boundary<2>> = box_of_planes(1..2, 0.0, 1.0);
    let scene = Scene {
        lattice: lattice([0.0; 2], 1.0)?,
        seeds,
        law: rubber(1.0, 1.0, 0.0)?,
        velocity: Box::new(move |x| [1e-9 * noise((x[0] / width) as usize), 0.0]),
        field: None,
        boundaries,
        dt,
        steps,
        every: steps,
    };
    let method = kernels::<PlaneStrain, 2>(scheme).ok_or("no such composition")?;
    Ok(Run { scene: &scene, look }.with(method).1)
}

/// Return true if noise grows less than a thousandfold in 500 steps.
fn stable(scheme: Scheme, per_cell: usize, offset: f64, dt: f64) -> Result<bool, String> {
    let mut speed = f64::NAN;
    let stopped = run(scheme, per_cell, offset, (dt, 500), &mut |moment| {
        let totals = moment.totals();
        speed = (2.0 * totals.kinetic / totals.mass).sqrt();
    })?;
    Ok(stopped.is_none() && speed < 1e-6)
}

fn bar(scheme: Scheme, per_cell: usize, offset: f64) -> Result<Bar, String> {
    let mut bar = None;
    run(scheme, per_cell, offset, (1e-6, 1), &mut |moment| bar = Bar::of(moment))?;
    bar.ok_or("the bar did not make a step".into())
}

/// Return the limits of the worst of some offsets: the one of the highest frequency, or with MUSL of the smallest
/// step.
///
/// # Errors
/// As [`limit`].
pub fn worst(scheme: Scheme, per_cell: usize, offsets: &[f64]) -> Result<Limit, String> {
    let (mut least, mut at) = (f64::INFINITY, 0.0);
    for &offset in offsets {
        let bar = bar(scheme, per_cell, offset)?;
        let step = match scheme.velocity {
            Velocity::FlipMusl => bar.symplectic()?,
            _ => 1.0 / bar.frequency()?,
        };
        if step < least {
            (least, at) = (step, offset);
        }
    }
    limit(scheme, per_cell, at)
}

/// Return the limits of an arrangement of particles.
///
/// # Errors
/// The scheme is not compiled, or the eigenvalue computation fails.
pub fn limit(scheme: Scheme, per_cell: usize, offset: f64) -> Result<Limit, String> {
    let bar = bar(scheme, per_cell, offset)?;
    let per_omega = if scheme.velocity == Velocity::FlipMusl { 2.0 } else { 2f64.sqrt() };
    Ok(Limit {
        scheme,
        per_cell,
        offset,
        measured: bisect(|dt| stable(scheme, per_cell, offset, dt))?,
        predicted: bar.limit(scheme.velocity)?,
        eigenvalue: per_omega / bar.frequency()?,
        gershgorin: per_omega / bar.bound,
    })
}

/// List the schemes with known limits.
pub fn schemes() -> Vec<Scheme> {
    let mut list = Vec::new();
    for kernel in [Kernel::Linear, Kernel::Gimp, Kernel::Quadratic, Kernel::Cubic] {
        for velocity in [Velocity::FlipUsl, Velocity::FlipMusl, Velocity::ApicUsl] {
            let scheme = Scheme::moving(kernel, velocity);
            if scheme.is_legal() {
                list.push(scheme);
            }
        }
    }
    list
}

/// Format limits as CSV lines under a header.
pub fn csv(limits: &[Limit]) -> String {
    let mut text = String::from("scheme,particles a cell,offset,measured,predicted,eigenvalue,Gershgorin\n");
    for l in limits {
        let numbers =
            [l.offset, l.measured, l.predicted, l.eigenvalue, l.gershgorin].map(|x| format!("{x:.4}"));
        text += &format!("{},{},{}\n", l.scheme.name(), l.per_cell, numbers.join(","));
    }
    text
}
