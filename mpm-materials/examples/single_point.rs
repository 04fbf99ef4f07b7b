//! Single-point test of a law: Johnson-Cook curves of copper from the driver.
//!
//! Run with `cargo run --release -p mpm-materials --example single_point`; add `csv` for the whole table.
//!
//! Check a law here before its use in a simulation. One point is pulled in x while its sides stay free of stress, as in
//! a tension test. The curves show the elastic slope, the hardening, and the effects of rate and temperature.

use mpm_materials::driver::{Path, Step, run};
use mpm_materials::{JohnsonCook, MieGruneisen, Solid};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 1. A solid is strength + equation of state (+ failure, + bulk viscosity).
    let taylor = Solid::new(JohnsonCook::<f64>::copper_taylor(), MieGruneisen::copper());
    let standard = Solid::new(JohnsonCook::<f64>::copper(), MieGruneisen::copper());

    // 2. A path: one hundred percent of logarithmic strain in 2000 steps, slowly and fast.
    let steps = 2000;
    let pull =
        |rate: f64| (Path::UniaxialStress { rate }, Step { dt: 1.0 / rate / f64::from(steps), steps: 2000 });
    let (slow, slow_step) = pull(1.0);
    let (fast, fast_step) = pull(1.0e4);

    // 3. The result is a table, one row per time.
    let taylor_curve = run(&taylor, &slow, slow_step)?;
    let cold = run(&standard, &slow, slow_step)?;
    let hot = run(&standard, &fast, fast_step)?;
    if std::env::args().any(|a| a == "csv") {
        print!("{}", hot.to_csv());
        return Ok(());
    }

    // 4. State variables are found by name.
    let temperature = hot.column("temperature").ok_or("this law has no temperature")?;
    println!("axial stress of copper, MPa, and temperature at 1e4 /s, K");
    println!("{:>8} {:>12} {:>12} {:>12} {:>8}", "strain", "Taylor fit", "1 /s", "1e4 /s", "K");
    for k in [0, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000] {
        println!(
            "{:8.4} {:12.2} {:12.2} {:12.2} {:8.1}",
            hot.rows[k].strain.0[0],
            taylor_curve.rows[k].stress.0[0] / 1e6,
            cold.rows[k].stress.0[0] / 1e6,
            hot.rows[k].stress.0[0] / 1e6,
            temperature[k],
        );
    }
    Ok(())
}
