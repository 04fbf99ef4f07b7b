//! Copper bar: 10 mm x 70 mm, 165 m/s on a rigid wall, axisymmetric.

use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::{Axisymmetric, BlockGrid, Boundary, Flip, Gimp, IntoKernels, Linear, Method, Mpm, Musl, Side};
use mpm_materials::{IntoMaterial, library};
use pcmm::{LocalDelaunay, Masses, Packing, Pcmm};

use crate::{Failure, Way};

const SIZE: [f64; 2] = [5.0e-3, 70.0e-3];
const SPEED: f64 = 165.0;
const END: f64 = 260.0e-6;
/// Length and radius of the face by independent finite elements, m \[C\]; accuracy 0.5 and 2 %.
const REFERENCE: [f64; 2] = [50.37e-3, 8.64e-3];

fn copper() -> Result<impl IntoMaterial<f64>, Failure> {
    Ok(library::copper_feng_2014().with_bulk_viscosity(0.06, 1.5)?)
}

/// Larger one of the relative errors of length and radius of the face.
pub fn error(way: Way, cells: u32) -> Result<f64, Failure> {
    let lattice = Lattice::new([0.0; 2], SIZE[0] / f64::from(cells))?;
    let [length, radius] = match way {
        Way::Contacts => contacts(lattice)?,
        Way::Linear => points(Method::new(Linear, Flip, Musl, Axisymmetric), lattice)?,
        Way::Gimp => points(Method::new(Gimp, Flip, Musl, Axisymmetric).compiled(), lattice)?,
    };
    Ok((length / REFERENCE[0] - 1.0).abs().max((radius / REFERENCE[1] - 1.0).abs()))
}

fn boundaries() -> [Boundary<2>; 2] {
    [
        Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above },
        Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 },
    ]
}

fn contacts(lattice: Lattice<2>) -> Result<[f64; 2], Failure> {
    let h = lattice.spacing();
    let packing = Packing::on_nodes(&Cuboid::new([0.0; 2], SIZE)?, &lattice)?;
    let method = pcmm::Method::consistent(Axisymmetric, LocalDelaunay::new(0.45 * h, 20.0)?);
    let mut bar = Pcmm::new(method, copper()?, &packing, |_| [0.0, -SPEED], Masses::FromElements)?;
    boundaries().into_iter().try_for_each(|b| bar.bound(b))?;
    bar.set_revision_interval(10)?;
    bar.run_until(END)?;
    let row = |at: f64| {
        let near = |n: &usize| (packing.positions[*n][1] - at).abs() < 0.5 * h;
        (0..packing.positions.len()).filter(near).collect::<Vec<_>>()
    };
    let (foot, top) = (row(0.0), row(SIZE[1]));
    let place = |n: &usize, d: usize| bar.particles()[*n].position[d];
    let mean = |list: &[usize]| list.iter().map(|n| place(n, 1)).sum::<f64>() / list.len() as f64;
    Ok([mean(&top) - mean(&foot), foot.iter().map(|n| place(n, 0)).fold(0.0, f64::max)])
}

fn points(method: impl IntoKernels<f64, 2>, lattice: Lattice<2>) -> Result<[f64; 2], Failure> {
    let seeds = fill(&Cuboid::new([0.0; 2], SIZE)?, &lattice, 2, &Filling::new().axisymmetric())?;
    let mut bar = Mpm::new(method, BlockGrid::new(lattice));
    bar.add("bar", copper()?, &seeds, |_| [0.0, -SPEED])?;
    for boundary in boundaries() {
        bar.bound(boundary)?;
    }
    bar.run_until(END)?;
    let mut places = vec![[f64::NAN; 2]; seeds.len()];
    bar.bodies()[0].for_each(&mut |p| places[p.number] = [p.position[0], p.position[1]]);
    Ok(sizes(&seeds, &places))
}

/// Extrapolate positions to the surface from the layer behind, since particles are a quarter of a cell below their
/// initial surface.
fn sizes(seeds: &Seeds<2>, places: &[[f64; 2]]) -> [f64; 2] {
    let size = 2.0 * seeds.half_size[1];
    let layer = |at: f64| {
        let near = |n: &usize| (seeds.positions[*n][1] - at).abs() < 0.25 * size;
        (0..seeds.len()).filter(near).collect::<Vec<usize>>()
    };
    let mean = |at: f64| {
        let list = layer(at);
        list.iter().map(|&n| places[n][1]).sum::<f64>() / list.len() as f64
    };
    let widest = |at: f64, column: f64| {
        let near = |n: &&usize| (seeds.positions[**n][0] - column).abs() < 0.25 * size;
        layer(at).iter().filter(near).map(|&n| places[n][0]).fold(f64::NAN, f64::max)
    };
    let beyond = |first: f64, second: f64| 1.5 * first - 0.5 * second;
    let edge = |at: f64| beyond(widest(at, SIZE[0] - 0.5 * size), widest(at, SIZE[0] - 1.5 * size));
    let (top, bottom) = (
        beyond(mean(SIZE[1] - 0.5 * size), mean(SIZE[1] - 1.5 * size)),
        beyond(mean(0.5 * size), mean(1.5 * size)),
    );
    [top - bottom, beyond(edge(0.5 * size), edge(1.5 * size))]
}
