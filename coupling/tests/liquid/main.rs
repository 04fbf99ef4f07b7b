//! Deformable bodies in an incompressible liquid, against closed-form solutions.

mod elements;
mod particles;

use std::f64::consts::{FRAC_PI_2, PI};

use flow::{Deformable, Flow, FlowOptions, Fluid, Wall};
use impactite_geometry::{Ball, Compose, Cuboid, Lattice};
use impactite_scene::Solver;

const GRAVITY: f64 = 9.81;
const WATER: f64 = 1000.0;

/// Mean position of some nodes along an axis, m.
fn mean<const D: usize>(flow: &Flow<D>, nodes: &[u32], axis: usize) -> f64 {
    let all = flow.deformable().unwrap();
    nodes.iter().map(|n| all.node(0, *n).0[axis]).sum::<f64>() / nodes.len() as f64
}

/// Layer on the floor of a tank 0.4 m wide, 0.2 m thick, under 0.4 m of water, with 16 cells across. `off` is the part of a cell by which the floor is
/// off a plane of the grid.
fn under_water(layer: impl Deformable<2> + 'static, off: f64) -> Flow<2> {
    let h = 0.4 / 16.0;
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0, -off * h], h).unwrap()));
    flow.add_wall(Wall::container(Cuboid::new([0.0; 2], [0.4, 1.0]).unwrap())).unwrap();
    flow.add_deformable(layer).unwrap();
    let water = Cuboid::new([0.0, 0.2], [0.4, 0.6]).unwrap();
    flow.add_shape("water", Fluid::new(WATER).unwrap(), &water, 2, |_| [0.0; 2]).unwrap();
    flow.set_body_force(|_| [0.0, -GRAVITY]);
    flow
}

/// Height of the top of the layer after `t` seconds, m, and its first period, s: modes of a bar with a mass at its end under a weight that acts
/// at once, x tan x = mass of the bar over that at its end.
fn exact(density: f64, modulus: f64, t: f64) -> (f64, f64) {
    let (length, water) = (0.2, 0.4 * WATER);
    let ratio = density * length / water;
    let (mut sum, mut period) = (length, 0.0);
    for n in 0..200 {
        let (mut low, mut high) = (f64::from(n) * PI, f64::from(n) * PI + FRAC_PI_2);
        for _ in 0..100 {
            let x = 0.5 * (low + high);
            if x * x.tan() < ratio { low = x } else { high = x }
        }
        let (sin, cos) = low.sin_cos();
        let mass = 0.5 * density * length * (1.0 - sin * cos / low) + water * sin * sin;
        let load = GRAVITY * (density * length * (1.0 - cos) / low + water * sin);
        let omega = low * (modulus / density).sqrt() / length;
        sum -= sin * load / (mass * omega * omega) * (1.0 - (omega * t).cos());
        if n == 0 {
            period = 2.0 * PI / omega;
        }
    }
    (sum, period)
}

/// Check the motion of the top of the layer, of so many nodes, over four periods. Returns a line of the result.
fn oscillates(mut flow: Flow<2>, nodes: usize, [density, modulus]: [f64; 2], allowed: f64) -> String {
    let all = flow.deformable().unwrap();
    let first = all.surface().into_iter().map(|f| f.nodes[0]);
    let top: Vec<u32> = first.filter(|n| all.node(0, *n).0[1] > 0.2 - 1e-9).collect();
    assert_eq!(top.len(), nodes);
    let period = exact(density, modulus, 0.0).1;
    let amplitude = 0.2 - exact(density, modulus, 0.5 * period).0;
    let mut worst = 0.0f64;
    while flow.time() < 4.0 * period {
        flow.step_at_most(1.0).unwrap();
        let off = mean(&flow, &top, 1) - exact(density, modulus, flow.time()).0;
        worst = worst.max((off / amplitude).abs());
    }
    assert!(worst < allowed, "{density} kg/m^3: {worst}");
    assert!(flow.warnings().is_empty(), "{:?}", flow.warnings());
    format!("{density} kg/m^3: {worst:.4} of the amplitude, {} steps", flow.clock().steps)
}

/// Weight along the second axis, m/s^2.
fn gravity<const D: usize>() -> [f64; D] {
    std::array::from_fn(|d| if d == 1 { -GRAVITY } else { 0.0 })
}

/// Corners of a block of this density, 0.3 m wide, `high` and `lifted` above its draught in a pool of 0.9 m by 0.5 m.
fn block<const D: usize>(density: f64, high: f64, lifted: f64) -> Cuboid<D> {
    let (mut from, mut to) = ([0.3; D], [0.6; D]);
    from[1] = 0.5 - high * density / WATER + lifted;
    to[1] = from[1] + high;
    Cuboid::new(from, to).unwrap()
}

/// Pool with cells of `h`, m, around a block.
fn pool<const D: usize>(h: f64, block: Cuboid<D>) -> Flow<D> {
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; D], h).unwrap()));
    let (mut tank, mut water) = ([0.9; D], [0.9; D]);
    (tank[1], water[1]) = (2.0, 0.5);
    flow.add_wall(Wall::container(Cuboid::new([0.0; D], tank).unwrap())).unwrap();
    let water = Cuboid::new([0.0; D], water).unwrap().minus(block);
    flow.add_shape("water", Fluid::new(WATER).unwrap(), &water, 2, |_| [0.0; D]).unwrap();
    flow.set_body_force(|_| gravity());
    flow
}

/// Centre of mass of the body, m.
fn centre<const D: usize>(flow: &Flow<D>) -> [f64; 3] {
    let (mut sum, mut mass) = ([0.0; 3], 0.0);
    flow.bodies()[1].for_each(&mut |p| {
        mass += p.mass;
        (0..3).for_each(|d| sum[d] += p.mass * p.position[d]);
    });
    sum.map(|x| x / mass)
}

/// Displacements of the centre of a body that floats until `end`, s, m: mean, largest, and that at the end.
fn drift<const D: usize>(flow: &mut Flow<D>, end: f64) -> [f64; 3] {
    let start = centre(flow)[1];
    let (mut sum, mut count, mut largest, mut off) = (0.0, 0, 0.0f64, 0.0);
    while flow.time() < end {
        flow.step_at_most(1.0).unwrap();
        off = centre(flow)[1] - start;
        (sum, count, largest) = (sum + off, count + 1, largest.max(off.abs()));
    }
    [sum / f64::from(count), largest, off]
}

/// Box that a drop of 0.1 m hits, which flies at 1 m/s without weight.
fn target<const D: usize>() -> Cuboid<D> {
    let (mut low, mut high) = ([-0.1; D], [0.1; D]);
    (low[0], high[0], high[1]) = (0.15, 0.3, 0.14);
    Cuboid::new(low, high).unwrap()
}

/// The drop, with cells of `h`, m.
fn thrown_at<const D: usize>(target: impl Deformable<D> + 'static, h: f64) -> Flow<D> {
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; D], h).unwrap()));
    flow.add_deformable(target).unwrap();
    let (mut centre, mut velocity) = ([0.0; D], [0.0; D]);
    (centre[0], velocity[0], velocity[1]) = (0.03, 1.0, 0.3);
    let drop = Ball::new(centre, 0.1).unwrap();
    flow.add_shape("water", Fluid::new(WATER).unwrap(), &drop, 2, |_| velocity).unwrap();
    flow
}

/// Check that momentum is conserved while the drop hits.
fn conserves_momentum(mut flow: Flow<2>) {
    let start = flow.totals().momentum;
    flow.run_until(0.045).unwrap();
    let (end, given) = (flow.totals().momentum, Solver::exchange(&flow));
    assert!(flow.bodies()[1].totals().momentum[0] > 0.15 * start[0], "the drop met the block");
    for d in 0..2 {
        let off = end[d] - start[d] - given.impulse[d] - given.load[d] - given.dropped[d];
        assert!(off.abs() < 1e-11 * start[0], "axis {d}: {off}");
        // In transit between the middle of a step and its end, and lost by the transfer.
        println!("axis {d}: dropped {:.2e} of {:.2e}", given.dropped[d], start[0]);
        assert!(given.dropped[d].abs() < 5e-3 * start[0], "axis {d}: {}", given.dropped[d]);
        let others = given.impulse[d].abs() + given.load[d].abs();
        assert!(others < 1e-11 * start[0], "axis {d}: {others}");
    }
}
