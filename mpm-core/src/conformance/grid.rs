//! Conformance of grids.

use mpm_materials::Constitutive;

use super::method::{Body, Probe};
use super::{Broken, within};
use crate::dim::block_nodes;
use crate::grid::{BlockGrid, GridStorage, Node};
use crate::method::Method;
use crate::scheme::Usl;
use crate::shape::QuadraticBSpline;
use crate::step::{Mpm, Scalar};
use crate::transfer::Flip;
use impactite_geometry::Lattice;
use impactite_scene::{PointView, TimeControl};

/// Check the contract of a grid: requested blocks are found at their index in `blocks`, with 4^D nodes each; nodes
/// are zero after a change of the blocks, and keep their values without one; a scene computes the same bits as on a
/// [`BlockGrid`]. `make` must create a grid with space for node indices -24 to 40 along every axis.
///
/// # Errors
/// The first violated property.
pub fn grid<G, const D: usize>(make: impl Fn(Lattice<D>) -> G) -> Result<(), Broken>
where
    G: GridStorage<f64, D> + 'static,
    f64: Scalar<D>,
    Embedded<D>: impactite_scene::embedding::Embedding<D>,
    QuadraticBSpline: crate::shape::ShapeFunction<f64, D>,
{
    let name = std::any::type_name::<G>();
    let lattice = Lattice::new([0.1; D], 0.5).map_err(|e| broken(name, "a lattice", e.to_string()))?;
    let mut grid = make(lattice);
    let wanted = |list: &[i32]| -> Vec<[i32; D]> {
        let mut blocks: Vec<[i32; D]> = list
            .iter()
            .map(|&i| {
                let mut c = [1; D];
                c[0] = i;
                c[D - 1] += i / 2;
                c
            })
            .collect();
        blocks.sort_unstable();
        blocks
    };
    for list in [&[0, 1, 2][..], &[-3, -2, 4, 5], &[1]] {
        let blocks = wanted(list);
        grid.arrange(&blocks).map_err(|e| broken(name, "room for blocks", e.to_string()))?;
        check_blocks(name, &grid, &blocks)?;
        let any = grid.nodes().iter().any(|n| *n != Node::default());
        within(name, "nodes that are zero after a change", f64::from(u8::from(any)), 0.0, || {
            format!("{list:?}")
        })?;
        for (n, node) in grid.nodes_mut().iter_mut().enumerate() {
            node.first[0] = n as f64;
        }
        grid.arrange(&blocks).map_err(|e| broken(name, "room for blocks", e.to_string()))?;
        let kept = grid.nodes().iter().enumerate().all(|(n, node)| node.first[0] == n as f64);
        within(
            name,
            "nodes that stay as they are without a change",
            f64::from(u8::from(!kept)),
            0.0,
            || format!("{list:?}"),
        )?;
        for node in grid.nodes_mut() {
            *node = Node::default();
        }
    }
    let (ours, theirs) = (run(name, Box::new(BlockGrid::new(lattice)))?, run(name, Box::new(make(lattice)))?);
    for (a, b) in ours.iter().zip(&theirs) {
        within(name, "the bits of a block grid", f64::from(u8::from(a != b)), 0.0, || {
            format!("{a:?} against {b:?}")
        })?;
    }
    within(name, "all particles", (ours.len() as f64 - theirs.len() as f64).abs(), 0.0, String::new)
}

/// Embedding of a plain scene in `D` dimensions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Embedded<const D: usize>;
impl impactite_scene::embedding::Embedding<2> for Embedded<2> {
    const NAME: &'static str = "plane strain";
}
impl impactite_scene::embedding::Embedding<3> for Embedded<3> {
    const NAME: &'static str = "3D";
}

fn broken(subject: &str, property: &'static str, detail: String) -> Broken {
    Broken { subject: subject.into(), property, detail }
}

fn check_blocks<G: GridStorage<f64, D>, const D: usize>(
    name: &str,
    grid: &G,
    wanted: &[[i32; D]],
) -> Result<(), Broken> {
    let nodes = grid.blocks().len() * block_nodes(D);
    let error = (grid.nodes().len() as f64 - nodes as f64).abs();
    within(name, "4^D nodes a block", error, 0.0, || format!("{} blocks", grid.blocks().len()))?;
    for c in wanted {
        let found = grid.find(c).and_then(|place| grid.blocks().get(place));
        if found != Some(c) {
            return Err(broken(name, "finding a block where it is stored", format!("{c:?}: {found:?}")));
        }
    }
    for (place, c) in grid.blocks().iter().enumerate() {
        if grid.find(c) != Some(place) {
            return Err(broken(name, "finding every block that is stored", format!("{c:?}")));
        }
    }
    let far = [1 << 20; D];
    if let Some(place) = grid.find(&far) {
        return Err(broken(name, "not finding a block that is not stored", format!("{far:?} at {place}")));
    }
    Ok(())
}

/// Run a body that flies through several blocks of nodes, with negative indices on its way.
fn run<const D: usize>(name: &str, grid: Box<dyn GridStorage<f64, D>>) -> Result<Vec<PointView>, Broken>
where
    f64: Scalar<D>,
    Embedded<D>: impactite_scene::embedding::Embedding<D>,
    QuadraticBSpline: crate::shape::ShapeFunction<f64, D>,
{
    let stop = |e: String| broken(name, "a run", e);
    let body = Body::<D>::new(*grid.lattice(), -6, 3);
    let mut mpm = Mpm::new(Method::new(QuadraticBSpline, Flip, Usl, Embedded::<D>).compiled(), grid);
    mpm.set_time_control(TimeControl::Fixed(0.05)).map_err(|e| stop(e.to_string()))?;
    mpm.add("block", Probe::new([0.0; 6]).compiled(), &body.seeds, |x| body.velocity(x, 3.0, 0.4))
        .map_err(|e| stop(e.to_string()))?;
    for _ in 0..60 {
        mpm.step().map_err(|e| stop(e.to_string()))?;
    }
    Ok(mpm.bodies()[0].points())
}
