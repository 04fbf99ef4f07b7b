//! Crowds of bodies in one block of nodes, where each keeps only the nodes it reaches.

use crate::common::{H, cuboid, lattice, rubber};
use mpm_contact::{Frictionless, Gradients, Pairs, SurfaceDistance};
use mpm_core::{
    Apic, BlockGrid, Boundary, CpGimp, DenseGrid, Flip, Fmpm, FullSpace, GridContact, GridStorage,
    IntoKernels, Linear, Method, Mpm, Musl, PlaneStrain, PointView, QuadraticBSpline, Side, Team,
    TimeControl, Usf, Usl,
};

/// Return the corners of cubes of one cell, one cell apart: 2^D of them in every block of nodes.
fn corners<const D: usize>() -> Vec<[f64; D]> {
    (0..1 << D).map(|n| std::array::from_fn(|d| if n >> d & 1 == 0 { 0.0 } else { 2.0 * H })).collect()
}

/// Return the particles of `cubes` after a flight over three cells, in which each rotates and stretches.
fn fly<const D: usize>(
    method: impl IntoKernels<f64, D>,
    grid: impl GridStorage<f64, D> + 'static,
    cubes: &[[f64; D]],
    mirror: bool,
    threads: usize,
) -> Vec<Vec<PointView>> {
    // Surfaces would have to overlap by three cells: the test concerns the nodes of each body, and not contact.
    let never = SurfaceDistance::new(Gradients::default(), -3.0).expect("threshold");
    let contact = GridContact::new(never, Pairs::new(Frictionless));
    let mut mpm = Mpm::with_contact(method, grid, contact);
    for low in cubes {
        let seeds = cuboid(*low, low.map(|x| x + H));
        let turn = |x: [f64; D]| {
            let mut v = [0.0; D];
            let (a, b) = (x[0] - low[0] - 0.5 * H, x[1] - low[1] - 0.5 * H);
            (v[0], v[1]) = (1.0 - 2.0 * b + a, if mirror { 0.5 * (x[1] - low[1]) } else { 0.4 + 2.0 * a });
            v
        };
        let name = format!("cube {}", mpm.bodies().len());
        mpm.add(&name, rubber(), &seeds, turn).expect("body");
    }
    if mirror {
        mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).expect("plane");
    }
    mpm.set_team(Team::new(threads).expect("threads"));
    mpm.set_time_control(TimeControl::Fixed(4e-4)).expect("time control");
    mpm.run_until(0.15).expect("run");
    assert!(mpm.contacts().is_empty(), "the cubes met");
    mpm.bodies().iter().map(|body| body.points()).collect()
}

/// Check that every cube moves in a crowd as alone, to the last bit, with any number of threads and on any grid.
fn crowd_is_as_alone<const D: usize>(method: impl IntoKernels<f64, D> + Clone, mirror: bool) {
    let grid = || BlockGrid::new(lattice());
    let cubes = corners::<D>();
    let together = fly(method.clone(), grid(), &cubes, mirror, 1);
    for (cube, seen) in cubes.iter().zip(&together) {
        let alone = fly(method.clone(), grid(), &[*cube], mirror, 1);
        assert_eq!(&alone[0], seen, "cube at {cube:?}");
        let there = seen[0].position[0] - cube[0];
        assert!(there > 2.0 * H, "the cube flew {there} m");
    }
    assert_eq!(together, fly(method.clone(), grid(), &cubes, mirror, 3), "threads");
    let dense = DenseGrid::new(lattice(), [-8; D], [16; D]).expect("grid");
    assert_eq!(together, fly(method, dense, &cubes, mirror, 2), "dense grid");
}

#[test]
fn a_crowd_in_the_plane_is_as_its_members_alone() {
    for mirror in [false, true] {
        crowd_is_as_alone(Method::new(Linear, Flip, Musl, PlaneStrain), mirror);
        crowd_is_as_alone(Method::new(Linear, Flip, Usf, PlaneStrain).compiled(), mirror);
        crowd_is_as_alone(Method::new(CpGimp, Flip, Musl, PlaneStrain), mirror);
        crowd_is_as_alone(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), mirror);
        crowd_is_as_alone(Method::new(QuadraticBSpline, Fmpm::<2>, Usl, PlaneStrain).compiled(), mirror);
    }
}

#[test]
fn a_crowd_in_space_is_as_its_members_alone() {
    crowd_is_as_alone(Method::new(Linear, Flip, Musl, FullSpace), false);
    crowd_is_as_alone(Method::new(QuadraticBSpline, Apic, Usl, FullSpace), true);
}

/// Memory of crowds: fields of a few nodes each, not blocks.
#[test]
fn a_crowd_keeps_the_nodes_it_reaches() {
    let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    let method = Method::new(Linear, Flip, Musl, FullSpace);
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice()), contact);
    for low in corners::<3>() {
        // Away from the faces of blocks, each cube reaches 27 nodes in one block.
        let low = low.map(|x| x + 0.01 * H);
        let seeds = cuboid(low, low.map(|x| x + 0.98 * H));
        let name = format!("cube {}", mpm.bodies().len());
        mpm.add(&name, rubber(), &seeds, |_| [0.0; 3]).expect("body");
    }
    let reached = mpm.grid().nodes().len();
    assert!(reached <= 8 * 64, "{reached} nodes for 8 cubes of 8 to 27 nodes");
}
