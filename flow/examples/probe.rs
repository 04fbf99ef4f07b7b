//! Sloshing.
use flow::{Flow, FlowOptions, Fluid, Wall};
use impactite_geometry::{Cuboid, Lattice};
use impactite_scene::{Solver, Watch};
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let a: Vec<f64> = std::env::args().skip(1).map(|s| s.parse().unwrap()).collect();
    let (cells, corr, refl, end) = (a[0], a[1], a[2], a[3]);
    let h = 1.0 / cells;
    let mut o = FlowOptions::<2>::new(Lattice::new([0.0; 2], h)?).density_correction(corr)?;
    if refl == 0.0 { o = o.without_reflection(); }
    let mut flow = Flow::new(o);
    flow.add_wall(Wall::container(Cuboid::new([0.0, 0.0], [1.0, 1.0])?))?;
    flow.add_shape("f", Fluid::new(1000.0)?, &Cuboid::new([0.0; 2], [1.0, 0.5])?, 2, |_| [0.0; 2])?;
    flow.set_watch(Watch::off().only_warn());
    let omega = 0.95 * 5.31655;
    flow.set_body_force(move |t| [if t < 6.0 { -0.2 * (omega * t).sin() } else { 0.0 }, -9.81]);
    let (mut work0, mut k0) = (0.0, 0.0);
    let mut e = Vec::new();
    for n in 1..=10 {
        flow.run_until(end / 10.0 * n as f64)?;
        let t = flow.totals();
        let y: f64 = flow.points().iter().map(|p| p.mass * p.position[1]).sum::<f64>() * 9.81;
        if n == 1 { work0 = y; k0 = t.kinetic; }
        e.push(format!("{:.2}", y + t.kinetic - 1226.25));
        let _ = (work0, k0);
    }
    println!("{a:?} steps {} energy {} unexplained {:.2} volume {}", flow.steps(), e.join(" "), flow.totals().kinetic - flow.exchange().work, flow.liquid_volume());
    Ok(())
}
