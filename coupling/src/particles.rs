//! Particles of a converted element.

use fem::ConvertedElement;
use impactite_geometry::ElementKind;
use mpm_core::{NewParticle, NewParticles};
use nalgebra::Matrix3;

use crate::conversion::Particles;
use crate::element::{columns, determinant, divided, integration_point, matrix};

/// Maximum number of particles along an axis of an element.
const MOST: u32 = 8;
/// Rounding tolerance, over half a cell.
const ROUNDING: f64 = 0.05;

/// Result of the conversion of an element.
pub(crate) struct Became {
    pub particles: u64,
    pub mass: f64,
    /// Gain of kinetic energy, J.
    pub kinetic: f64,
    /// Gain of internal energy, J, by the energy densities of the states.
    pub internal: f64,
}

/// Number of particles along each axis of an element, on a grid of cells of `spacing`, m.
fn counts<const D: usize>(element: &ConvertedElement<D>, particles: Particles, spacing: f64) -> [u32; 3] {
    let each = match particles {
        Particles::Each(count) => return [count; 3],
        Particles::Points => return if element.volumes.len() > 1 { [2; 3] } else { [1; 3] },
        Particles::HalfCells => {
            |length: f64| (2.0 * length / spacing - ROUNDING).ceil().clamp(1.0, f64::from(MOST)) as u32
        }
    };
    let length = |c: &[f64; D]| c.iter().map(|x| x * x).sum::<f64>().sqrt();
    let simplex = element.kind.is_simplex();
    // An axis of a quadrilateral or brick is twice as long as its column.
    let scale = if simplex { 1.0 } else { 2.0 };
    let slopes = element.kind.shape_gradients([0.0; 3]);
    let slopes = &slopes[..element.nodes.len()];
    let now = columns(slopes, |n| element.positions[n]);
    let rest = columns(slopes, |n| element.rest[n]);
    // Stretched elements have at most twice their number of particles at rest.
    std::array::from_fn(|d| each(scale * length(&now[d])).min(2 * each(scale * length(&rest[d]))))
}

/// Create the particles of an element: mass and momentum to rounding, states of the nearest integration points, velocities and velocity
/// gradients by the shape functions. `energy` returns the internal energy density of a state, J/m^3 of reference volume at `density`.
pub(crate) fn particles_of<const D: usize>(
    element: &ConvertedElement<D>,
    how: (Particles, f64, bool),
    density: f64,
    energy: &dyn Fn(&[f64]) -> f64,
    new: &mut NewParticles<f64, D>,
) -> Became {
    let (particles, spacing, hoop) = how;
    let (kind, nodes) = (element.kind, element.nodes.len());
    let points = element.volumes.len();
    let numbers = element.states.len() / points;
    let by_points = particles == Particles::Points;
    let places: Vec<([f64; 3], f64, [f64; 3])> = if by_points {
        let half = if points > 1 { 0.5 } else { 1.0 };
        let whole: f64 = element.volumes.iter().sum();
        (0..points)
            .map(|p| (integration_point(kind, p, points), element.volumes[p] / whole, [half; 3]))
            .collect()
    } else {
        divided(kind, counts(element, particles, spacing))
    };
    let mass: f64 = element.masses.iter().sum();
    let made: Vec<_> = places
        .iter()
        .map(|(xi, part, half)| {
            let (values, slopes) = (kind.shape_functions(*xi), kind.shape_gradients(*xi));
            let slopes = &slopes[..nodes];
            let of = |list: &[[f64; D]]| -> [f64; D] {
                std::array::from_fn(|d| list.iter().zip(&values).map(|(x, n)| x[d] * n).sum())
            };
            let rest = columns(slopes, |n| element.rest[n]);
            let radius = if hoop { of(&element.rest)[0] } else { 1.0 };
            let weight = if by_points { *part } else { part * determinant(&rest) * radius };
            let now = columns(slopes, |n| element.positions[n]);
            let speeds = columns(slopes, |n| element.velocities[n]);
            let point = nearest(kind, xi, points);
            (weight, of(&element.positions), of(&element.velocities), now, speeds, *half, point)
        })
        .collect();
    let sum: f64 = made.iter().map(|(weight, ..)| weight).sum();
    // Mass shares by volumes at rest reproduce centre of mass and momentum of the nodes up to the skewness of the element: a uniform shift
    // corrects the rest.
    let missing = |nodal: &[[f64; D]], own: &dyn Fn(usize) -> [f64; D]| -> [f64; D] {
        std::array::from_fn(|d| {
            let nodal: f64 = element.masses.iter().zip(nodal).map(|(m, x)| m * x[d]).sum();
            let own: f64 = made.iter().enumerate().map(|(n, (weight, ..))| weight / sum * own(n)[d]).sum();
            nodal / mass - own
        })
    };
    let aside = missing(&element.positions, &|n| made[n].1);
    let slower = missing(&element.velocities, &|n| made[n].2);
    let square = |v: &[f64; D]| v.iter().map(|x| x * x).sum::<f64>();
    let mut became = Became { particles: made.len() as u64, mass, kinetic: 0.0, internal: 0.0 };
    for (m, v) in element.masses.iter().zip(&element.velocities) {
        became.kinetic -= 0.5 * m * square(v);
    }
    for point in 0..points {
        became.internal -= element.volumes[point] * energy(&element.states[point * numbers..][..numbers]);
    }
    for (weight, position, v, now, speeds, half, point) in made {
        let velocity: [f64; D] = std::array::from_fn(|d| v[d] + slower[d]);
        let position = std::array::from_fn(|d| position[d] + aside[d]);
        let mass = mass * weight / sum;
        let state = &element.states[point * numbers..][..numbers];
        became.kinetic += 0.5 * mass * square(&velocity);
        became.internal += mass / density * energy(state);
        new.push(
            NewParticle {
                position,
                velocity,
                gradient: gradient(&now, &speeds),
                mass,
                half_edges: half_edges(kind, &now, &half),
            },
            state,
        );
    }
    became
}

/// Integration point out of `points` whose part of the element contains `xi`.
fn nearest(kind: ElementKind, xi: &[f64; 3], points: usize) -> usize {
    if points == 1 {
        return 0;
    }
    (0..kind.dimensions()).map(|d| usize::from(xi[d] > 0.0) << d).sum()
}

/// Velocity gradient dv/dx from columns dx/dxi and dv/dxi; zero for a flat element.
fn gradient<const D: usize>(now: &[[f64; D]; 3], speeds: &[[f64; D]; 3]) -> [[f64; D]; D] {
    let inverse = matrix(now).try_inverse().unwrap_or_else(Matrix3::zeros);
    let gradient = matrix(speeds) * inverse;
    std::array::from_fn(|c| std::array::from_fn(|d| gradient[(c, d)]))
}

/// Half edges of a part of an element, m: for simplices those of a cube of its volume.
fn half_edges<const D: usize>(kind: ElementKind, now: &[[f64; D]; 3], half: &[f64; 3]) -> [[f64; 3]; 3] {
    let mut edges = [[0.0; 3]; 3];
    if kind.is_simplex() {
        // A simplex has half, or a sixth, of the volume of its columns.
        let whole = determinant(now).abs() / if D == 2 { 2.0 } else { 6.0 };
        let edge = half[0] * whole.powf(1.0 / D as f64);
        (0..D).for_each(|d| edges[d][d] = edge);
        return edges;
    }
    for k in 0..D {
        (0..D).for_each(|d| edges[k][d] = now[k][d] * half[k]);
    }
    edges
}
