//! Notched glass plate in tension: crack as a picture and a ParaView series, with checkpoints every five seconds.
//!
//! `plate [CHECKPOINT]` resumes from a checkpoint.

use std::time::{Duration, Instant};

use downstream::peridynamics::{Brittle, Plate};
use impactite::output::picture::{ParticlePicture, Quantity as Field};
use impactite::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let h = 0.5e-3;
    let shape = Cuboid::new([0.0; 2], [0.1, 0.04])?;
    let seeds = fill(&shape, &Lattice::new([0.0; 2], h)?, 1, &Filling::new())?;
    let glass = Brittle { density: 2450.0, young: 72.0e9, critical: 1.0e-3 };
    let mut plate = Plate::new(glass, &seeds, 3.015 * h, |x| [0.0, if x[1] > 0.02 { 4.0 } else { -4.0 }])?;
    plate.cut(|x, y| (x[1] < 0.02) != (y[1] < 0.02) && 0.5 * (x[0] + y[0]) < 0.03);
    plate.set_team(Team::new(2)?);

    std::fs::create_dir_all("out")?;
    let mut ledger = Ledger::new(Pace::interval(1.0e-6)?).with_csv("out/plate.csv")?;
    let mut frames = VtkSeries::create("out/plate", "plate", Pace::interval(5.0e-6)?)?;
    let mut bar = Progress::new("plate");
    let run = Run::new(&mut plate).observe(&mut ledger).observe(&mut frames).observe(&mut bar);
    let mut run = run.checkpoint_by_clock("out/plate.checkpoint", Duration::from_secs(5), Instant::now());
    if let Some(file) = std::env::args().nth(1) {
        run = run.resume(file)?;
    }
    run.until(40.0e-6)?;
    let picture = ParticlePicture::new(900, 420).colour_by(Field::scalar("damage"));
    picture.draw(&plate.snapshot()?)?.save("out/plate.png")?;
    println!("energy within {:.1e}", ledger.worst_energy_error());
    Ok(())
}
