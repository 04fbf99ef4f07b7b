//! Heap allocations of a step in a running scene: none, unless a block of bins or of nodes needs more memory than any
//! block before.

use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::{
    Apic, BlockGrid, Boundary, Flip, Fmpm, FullSpace, IntoKernels, Linear, Method, Mpm, Musl,
    QuadraticBSpline, Side, Usf, Usl,
};
use mpm_materials::{LinearElastic, Moduli};

#[global_allocator]
static ALLOCATOR: dhat::Alloc = dhat::Alloc;

const H: f64 = 0.1;
const STEPS: u64 = 60;

/// Count allocations of [`STEPS`] steps of a vibrating cube on a symmetry plane, moving at `drift`, m/s, after 150
/// steps.
fn allocations<M: IntoKernels<f64, 3>>(method: M, drift: f64) -> u64 {
    let lattice = Lattice::new([0.0; 3], H).expect("lattice");
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let law = LinearElastic::new(1000.0, Moduli::young_poisson(1.0e6, 0.3).expect("moduli")).expect("law");
    let cube = Cuboid::new([0.0; 3], [4.0 * H; 3]).expect("cube");
    let seeds = fill(&cube, &lattice, 2, &Filling::new()).expect("seeds");
    mpm.add("cube", law, &seeds, |x| [drift + 1e-3 * (3.0 * x[0]).sin(), 0.0, 0.0]).expect("body");
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).expect("plane");
    for _ in 0..150 {
        mpm.step().expect("step");
    }
    let before = dhat::HeapStats::get().total_blocks;
    for _ in 0..STEPS {
        mpm.step().expect("step");
    }
    dhat::HeapStats::get().total_blocks - before
}

#[test]
fn a_step_allocates_nothing() {
    let _profiler = dhat::Profiler::builder().testing().build();
    let all = |drift| {
        [
            allocations(Method::new(Linear, Flip, Musl, FullSpace), drift),
            allocations(Method::new(Linear, Flip, Usf, FullSpace).compiled(), drift),
            allocations(Method::new(QuadraticBSpline, Apic, Usl, FullSpace), drift),
            allocations(Method::new(QuadraticBSpline, Fmpm::<2>, Usl, FullSpace).compiled(), drift),
        ]
    };
    assert_eq!(all(0.0), [0; 4]);
    // At a tenth of a cell per step through fresh cells, filling bins allocate 0.6 to 2.1 times per step.
    let moving = all(3.0);
    assert!(moving.iter().all(|&n| n < 3 * STEPS), "{moving:?}");
}
