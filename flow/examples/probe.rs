//! Tank at rest.
use flow::{Flow, FlowOptions, Fluid, Wall};
use impactite_geometry::{Cuboid, Lattice};
use impactite_scene::{Solver, Watch};
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let corr: f64 = std::env::args().nth(1).unwrap().parse()?;
    let depth: f64 = std::env::args().nth(2).unwrap().parse()?;
    let h = 1.0 / 16.0;
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0, 0.0], h)?).density_correction(corr)?);
    flow.add_wall(Wall::container(Cuboid::new([0.0, 0.0], [1.0, 1.0])?))?;
    flow.add_shape("water", Fluid::new(1000.0)?, &Cuboid::new([0.0, 0.0], [1.0, depth])?, 2, |_| [0.0; 2])?;
    flow.set_body_force(|_| [0.0, -9.81]);
    flow.set_watch(Watch::off());
    let first = flow.points();
    for n in 0..40 {
        flow.step_at_most(f64::INFINITY)?;
        let now = flow.points();
        let (k, far) = first.iter().zip(&now).enumerate().map(|(k, (a, b))| (k, (a.position[1] - b.position[1]).abs().max((a.position[0] - b.position[0]).abs()))).fold((0, 0.0), |m, x| if x.1 > m.1 { x } else { m });
        if n % 4 == 0 { println!("{n} {:.4} it {:?} moved {far:.3e} of {k} at {:?} -> {:?} v {:?} kinetic {:.3e}", flow.time(), flow.iterations(), first[k].position, now[k].position, now[k].velocity, flow.totals().kinetic); }
    }
    Ok(())
}
