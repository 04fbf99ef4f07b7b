//! Taylor bars of 4340 steel \[Xiao2015\] by smoothed particles: 7.595 x 37.97 mm, Johnson-Cook with heat, Mie-Grueneisen, 181 m/s.

use examples::CaseError;
use mpm_core::geometry::{Cuboid, Cylinder, Filling, Lattice, fill};
use mpm_core::{Boundary, Embedding, FullSpace, Side};
use mpm_materials::library;
use sph::{Composition, Layout, Method, Sph};

/// Radius and length, m.
pub const SIZE: [f64; 2] = [3.7975e-3, 37.97e-3];
/// Impact speed, m/s.
const SPEED: f64 = 181.0;
/// Particles along the radius as published: 20 x 200, axisymmetric.
pub const PRINTED: usize = 20;
/// End time as published, s.
pub const END: f64 = 60e-6;
/// Linear and quadratic bulk viscosity coefficients of updated forms \[M\].
const BULK_VISCOSITY: [f64; 2] = [0.5, 4.0];

/// Create the three-dimensional bar by the total Lagrangian form.
///
/// # Errors
/// The spacing (m) gives no particles.
pub fn in_space(spacing: f64) -> Result<Sph<3, impl Composition<3>>, CaseError> {
    let [radius, length] = SIZE;
    let shape = Cylinder::new([0.0; 3], [0.0, 0.0, 1.0], length, radius)?;
    let seeds = fill(&shape, &Lattice::new([0.0; 3], spacing)?, 1, &Filling::new())?;
    let (method, layout) = (Method::total_lagrangian(FullSpace), Layout::of_seeds(&seeds));
    let mut bar = Sph::new(method, library::steel_4340(), &layout, |_| [0.0, 0.0, -SPEED])?;
    bar.bound(Boundary::Wall { axis: 2, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    Ok(bar)
}

/// Create half the bar beside the symmetry plane, or the axisymmetric bar, with `cells` spacings along the radius, on a wall of mirror
/// images, by an updated form.
///
/// # Errors
/// The number of cells is zero, or the form is total Lagrangian.
pub fn half<M: Composition<2>>(method: M, cells: usize) -> Result<Sph<2, M>, CaseError> {
    let [radius, length] = SIZE;
    let mut bar = flat(method, [0.0, radius], length, radius / cells as f64)?;
    if !M::Embedding::HOOP {
        bar.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
    }
    bar.mirror_wall(1, 0.0, Side::Above)?;
    Ok(bar)
}

/// Create a whole two-dimensional bar of `columns` and `rows` of particles on a rigid wall.
///
/// # Errors
/// The number of columns or rows is zero, or the spacing (m) is not positive.
pub fn whole<M: Composition<2>>(
    method: M,
    [columns, rows]: [usize; 2],
    spacing: f64,
) -> Result<Sph<2, M>, CaseError> {
    let [width, length] = [columns, rows].map(|count| count as f64 * spacing);
    let mut bar = flat(method, [0.0, width], length, spacing)?;
    bar.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    Ok(bar)
}

fn flat<M: Composition<2>>(
    method: M,
    [left, right]: [f64; 2],
    length: f64,
    spacing: f64,
) -> Result<Sph<2, M>, CaseError> {
    let shape = Cuboid::new([left, 0.0], [right, length])?;
    let filling = Filling::new();
    let filling = if M::Embedding::HOOP { filling.axisymmetric() } else { filling };
    let seeds = fill(&shape, &Lattice::new([left, 0.0], spacing)?, 1, &filling)?;
    let [linear, quadratic] = BULK_VISCOSITY;
    let law = library::steel_4340().with_bulk_viscosity(linear, quadratic)?;
    Ok(Sph::new(method, law, &Layout::of_seeds(&seeds), |_| [0.0, -SPEED])?)
}
