//! Particles exactly on nodes and cell faces; bitwise reproducibility.

use mpm_core::geometry::Seeds;
use mpm_core::{
    Apic, BlockGrid, Deformable, Flip, IntoKernels, Linear as LinearShape, Method, Mpm, Musl, PlaneStrain,
    PointView, QuadraticBSpline, Team, TimeControl, Usl,
};
use mpm_materials::Mat3;
use mpm_materials::elastic::HyperelasticState;
use verification::Scheme;
use verification::problems::{box_of_planes, rubber};
use verification::scene::block;

use crate::stage::{
    ApicUsl, Cubic, FlipMusl, Fmpm4Usl, Linear, Quadratic, cells, particles, row_of_cells, solver, text, ul,
};
use crate::verdict::{Limit, Measured, Scene, Size, Stop};

/// Ends of the T29 bar: its first particles are on nodes, or midway between two nodes, at the edge of a quadratic
/// spline. The last ones are on nodes.
#[derive(Debug, Clone, Copy)]
enum Ends {
    OnNodes,
    BetweenNodes,
}

/// Measure the largest difference of positions and velocities between shifts by 1e-12 cells to either side. Without
/// a shift, round-off decides to which cell a particle on a node belongs, which differs between processors.
fn shifted<M: IntoKernels<f64, 2> + Copy>(method: M, ends: Ends) -> Result<Measured, String> {
    let begin = match ends {
        Ends::OnNodes => 0.75,
        Ends::BetweenNodes => 0.25,
    };
    let mut results: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut deformation = Mat3::identity();
    deformation.0[0][0] = 1.1;
    for shift in [0.0, 1e-12, -1e-12] {
        // Two particles per cell, one on a node, the other midway.
        let seeds = row_of_cells(12, 2, 0.25 + shift)?;
        let volume = seeds.volumes[0];
        let positions: Vec<_> = seeds.positions.into_iter().filter(|x| x[0] > begin).collect();
        let volumes = vec![volume; positions.len()];
        let seeds = Seeds::placed(positions, volumes, seeds.half_size);
        let mut mpm = Mpm::new(method, BlockGrid::new(cells()?));
        box_of_planes(1..2, 0.0, 1.0).into_iter().try_for_each(|b| mpm.bound(b)).map_err(text)?;
        mpm.set_time_control(TimeControl::Fixed(0.25)).map_err(text)?;
        let state = HyperelasticState { deformation };
        let bar = Deformable::new("bar", rubber(1.0, 1.0, 0.0)?, &seeds).moving(|_| [1.0, 0.0]);
        mpm.add_body(bar.in_state(|_| state)).map_err(text)?;
        for step in 0..STEPS {
            if let Err(e) = mpm.step() {
                let stop = Stop { step: e.step, what: e.to_string() };
                return Ok(Measured::new(f64::NAN, step).stopped(Some(stop)));
            }
        }
        let mut list = vec![[0.0; 2]; seeds.len()];
        mpm.bodies()[0].for_each(&mut |p| list[p.number] = [p.position[0], p.velocity[0]]);
        results.push(list);
    }
    let mut most = 0.0f64;
    for result in &results[1..] {
        for (a, b) in results[0].iter().zip(result) {
            most = most.max((a[0] - b[0]).abs()).max((a[1] - b[1]).abs());
        }
    }
    Ok(Measured::new(most, results.len() as u64 * STEPS))
}

const STEPS: u64 = 20;

/// T29: particles exactly on nodes.
pub fn lattice() -> Scene {
    fn trial<M: IntoKernels<f64, 2> + Copy>(
        method: M,
        ends: Ends,
    ) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| shifted(method, ends)
    }
    let space = PlaneStrain;
    Scene {
        id: "T29",
        name: "exactly on nodes",
        fails: "A bar that starts with 10 % of tension flies a quarter of a cell a step; half of its particles start exactly on nodes. The same run \
                shifted by 1e-12 cells to either side. The slope of the hat jumps at nodes: which side a particle is taken for decides its force. A free end on the knot of a \
                spline is nearly as bad: moved out by 1e-12, it is the only one to touch the next node, whose acceleration, slope over \
                weight, has no bound and comes back as a deformation. (The hat \
                with APIC, whose second moment vanishes there, is refused by the compiler.)",
        metric: "largest difference of places (cells) and velocities (c) after 20 steps",
        limit: Limit::AtMost(1e-10),
        rows: Vec::new(),
    }
    .fails("linear FLIP-MUSL", "slopes jump at nodes [I]", trial(Method::new(LinearShape, Flip, Musl, space), Ends::OnNodes))
    .holds("quadratic FLIP-MUSL", "list T29", trial(Method::new(QuadraticBSpline, Flip, Musl, space), Ends::OnNodes))
    .holds("quadratic APIC", "list T29", trial(Method::new(QuadraticBSpline, Apic, Usl, space), Ends::OnNodes))
    .holds(
        "TL quadratic FLIP-MUSL",
        "list T29",
        trial(Method::new(QuadraticBSpline, Flip, Musl, space).total_lagrangian().compiled(), Ends::OnNodes),
    )
    .fails(
        "quadratic FLIP-MUSL, end on a knot",
        "node of weight 5e-25 [I]",
        trial(Method::new(QuadraticBSpline, Flip, Musl, space), Ends::BetweenNodes),
    )
    .fails(
        "quadratic APIC, end on a knot",
        "node of weight 5e-25 [I]",
        trial(Method::new(QuadraticBSpline, Apic, Usl, space), Ends::BetweenNodes),
    )
}

/// Count the values that differ bitwise between one thread and more, after 100 steps of a rotating block that crosses
/// blocks.
fn bits(scheme: Scheme, kick: f64) -> Result<Measured, String> {
    let mut ends: Vec<Vec<u64>> = Vec::new();
    for threads in [1, 2, 3] {
        let mut mpm = solver(scheme, 0.3)?;
        mpm.set_team(Team::new(threads).map_err(text)?);
        let seeds = block(&cells()?, [-6; 2], [12; 2], 2);
        let kick = if threads == 1 { 0.0 } else { kick };
        let v = |x: [f64; 2]| [0.3 - 0.02 * x[1] + kick, 0.1 + 0.02 * x[0]];
        mpm.add("block", rubber(1.0, 1.0, 0.3)?, &seeds, v).map_err(text)?;
        for _ in 0..100 {
            if let Err(e) = mpm.step() {
                let stop = Stop { step: e.step, what: e.to_string() };
                return Ok(Measured::new(f64::NAN, e.step - 1).stopped(Some(stop)));
            }
        }
        let mut list = particles(&mpm);
        list.sort_by_key(|p| p.number);
        let numbers = |p: &PointView| {
            p.position.iter().chain(&p.velocity).chain(&p.stress).map(|x| x.to_bits()).collect::<Vec<_>>()
        };
        ends.push(list.iter().flat_map(numbers).collect());
    }
    let differ = |a: &[u64]| a.iter().zip(&ends[0]).filter(|(a, b)| a != b).count();
    Ok(Measured::new((differ(&ends[1]) + differ(&ends[2])) as f64, 300))
}

/// T30: bitwise equality for any number of threads.
pub fn threads() -> Scene {
    fn trial(scheme: Scheme, kick: f64) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| bits(scheme, kick)
    }
    Scene {
        id: "T30",
        name: "equal bits",
        fails: "A block turns and flies, with 1, 2 and 3 threads. Sums in the order in which threads arrive differ in the last bit, and trajectories part.",
        metric: "numbers whose bits differ from those of one thread, after 100 steps",
        limit: Limit::AtMost(0.0),
        rows: Vec::new(),
    }
    .fails("control: 1e-16 c faster with more threads", "control", trial(ul(Quadratic, ApicUsl), 1e-16))
    .holds("linear FLIP-MUSL", "list T30", trial(ul(Linear, FlipMusl), 0.0))
    .holds("quadratic APIC", "list T30", trial(ul(Quadratic, ApicUsl), 0.0))
    .holds("cubic FMPM(4)", "list T30", trial(ul(Cubic, Fmpm4Usl), 0.0))
}
