//! Dam break in space: particles per second, and time per particle of each stage.
use flow::{Flow, FlowOptions, Fluid, Wall};
use impactite_geometry::{Cuboid, Lattice};
use impactite_scene::{Solver, Watch};
use impactite_simd::Team;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: f64| arguments.next().map_or(Ok(default), |s| s.parse());
    let (cells, steps, threads) = (number(50.0)?, number(10.0)? as usize, number(1.0)? as usize);
    let h = 1.0 / cells;
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; 3], h)?));
    flow.add_wall(Wall::container(Cuboid::new([0.0; 3], [2.0, 1.0, 1.5])?))?;
    let column = Cuboid::new([0.0; 3], [1.0; 3])?;
    flow.add_shape("water", Fluid::new(1000.0)?, &column, 2, |_| [0.0; 3])?;
    flow.set_body_force(|_| [0.0, 0.0, -9.81]);
    flow.set_team(Team::new(threads)?);
    flow.set_watch(Watch::off());
    let count = flow.totals().particles as f64;
    for _ in 0..3 {
        flow.step_at_most(f64::INFINITY)?;
    }
    flow.measure_times();
    let start = std::time::Instant::now();
    for _ in 0..steps {
        flow.step_at_most(f64::INFINITY)?;
    }
    let seconds = start.elapsed().as_secs_f64();
    let rate = count * steps as f64 / seconds;
    println!("{count} particles, {rate:.3e} particle-steps/s, iterations {:?}", flow.iterations());
    if let Some(t) = flow.times() {
        let stages = [
            ("sort", t.sort),
            ("scatter", t.scatter),
            ("surface", t.surface),
            ("forces", t.forces),
            ("pressure", t.pressure),
            ("density correction", t.density),
            ("extrapolation", t.extrapolation),
            ("gather", t.gather),
        ];
        for (stage, time) in stages {
            println!("{stage:<20} {:8.2} ns a particle and step", time * 1e9 / count / steps as f64);
        }
    }
    Ok(())
}
