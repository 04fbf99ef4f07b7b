//! Dam break in a tank: front, energy balance, iterations.
use flow::{Flow, FlowOptions, Fluid, Wall};
use impactite_geometry::{Cuboid, Lattice};
use impactite_scene::Solver;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cells: f64 = std::env::args().nth(1).map_or(Ok(32.0), |s| s.parse())?;
    let end: f64 = std::env::args().nth(2).map_or(Ok(1.0), |s| s.parse())?;
    let h = 0.6 / cells;
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0, 0.0], h)?));
    flow.add_wall(Wall::container(Cuboid::new([0.0, 0.0], [3.22, 1.8])?))?;
    flow.add_shape("water", Fluid::new(1000.0)?, &Cuboid::new([0.0, 0.0], [1.2, 0.6])?, 2, |_| [0.0; 2])?;
    flow.set_body_force(|_| [0.0, -9.81]);
    let mut next = 0.0;
    let start = std::time::Instant::now();
    while !flow.reached(end) {
        flow.step_towards(end)?;
        if flow.time() >= next || flow.reached(end) {
            next += end / 20.0;
            let front = flow.points().iter().map(|p| p.position[0]).fold(0.0, f64::max);
            let high = flow.points().iter().map(|p| p.position[1]).fold(0.0, f64::max);
            let a = flow.account();
            let e = flow.exchange();
            println!(
                "t {:.3} step {} front {front:.3} high {high:.3} kinetic {:.1} unexplained {:.2} dropped {:.2} {:.2} momentum {:.3} {:.3} it {:?} div {:.1e}",
                flow.time(),
                flow.steps(),
                a.kinetic,
                a.unexplained,
                e.dropped[0],
                e.dropped[1],
                flow.totals().momentum[0],
                flow.totals().momentum[1],
                flow.iterations(),
                flow.largest_divergence()
            );
        }
    }
    for w in flow.warnings() {
        println!("{w}");
    }
    println!("{:.2} s, {} particles", start.elapsed().as_secs_f64(), flow.points().len());
    Ok(())
}
