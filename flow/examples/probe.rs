//! Taylor-Green vortices.
use flow::{Flow, FlowOptions, Fluid};
use impactite_geometry::{Cuboid, Lattice};
use impactite_scene::{Solver, TimeControl, Watch};
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let a: Vec<f64> = std::env::args().skip(1).map(|s| s.parse().unwrap()).collect();
    let (cells, nu, corr, cfl) = (a[0] as usize, a[1], a[2], a[3]);
    let h = 1.0 / cells as f64;
    let mut o = FlowOptions::<2>::new(Lattice::new([0.0; 2], h)?)
        .density_correction(corr)?
        .periodic(0, cells)?
        .periodic(1, cells)?;
    if a[4] == 0.0 {
        o = o.without_reflection();
    }
    let mut flow = Flow::new(o);
    let k = 2.0 * std::f64::consts::PI;
    let exact = |x: [f64; 2]| [(k * x[0]).sin() * (k * x[1]).cos(), -(k * x[0]).cos() * (k * x[1]).sin()];
    flow.add_shape("f", Fluid::new(1.0)?.with_viscosity(nu)?, &Cuboid::new([0.0; 2], [1.0; 2])?, 2, exact)?;
    flow.set_time_control(TimeControl::Courant { factor: cfl, growth: 1.1 })?;
    flow.set_watch(Watch::off());
    for n in 1..=8 {
        flow.run_until(0.125 * n as f64)?;
        let now = flow.time() - flow.velocity_lag();
        let (mut onto, mut norm, mut vol) = (0.0, 0.0, 0.0);
        let mut kin = 0.0;
        for p in flow.points() {
            let e = exact([p.position[0], p.position[1]]);
            onto += e[0] * p.velocity[0] + e[1] * p.velocity[1];
            norm += e[0] * e[0] + e[1] * e[1];
            vol += 1.0;
            kin += p.velocity[0].powi(2) + p.velocity[1].powi(2);
        }
        let d = (-2.0 * nu * k * k * now).exp();
        println!(
            "t {:.3} steps {} amplitude {:.5} kinetic {:.5} norm {:.5}",
            now,
            flow.steps(),
            onto / norm / d,
            kin / norm / d / d,
            norm / vol
        );
    }
    Ok(())
}
