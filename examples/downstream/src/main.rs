//! Rebound of a viscoelastic disk from a wall: fraction of energy returned.

use downstream::{StandardLinearSolid, tent_apic};
use impactite::mpm::geometry::{Ball, Filling, Lattice, fill};
use impactite::mpm::{BlockGrid, Boundary, Mpm, Side};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let lattice = Lattice::new([0.0, 0.0], 0.005)?;
    let disk = fill(&Ball::new([0.0, 0.06], 0.05)?, &lattice, 2, &Filling::new())?;
    println!("{:>12} {:>12} {:>10}", "tau, s", "rebound, m/s", "energy");
    for relaxation_time in [1.0e-5, 1.0e-3, 1.0e-1] {
        let rubber = StandardLinearSolid::new(1000.0, 2.0e7, 1.0e6, 2.0e6, relaxation_time)?;
        let mut mpm = Mpm::new(tent_apic(), BlockGrid::new(lattice));
        mpm.add("disk", rubber.material(), &disk, |_| [0.0, -5.0])?;
        mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
        let before = mpm.totals();
        mpm.run_until(0.015)?;
        let after = mpm.totals();
        let rebound = after.momentum[1] / after.mass;
        let returned = after.kinetic / before.kinetic;
        println!("{relaxation_time:>12.0e} {rebound:>12.3} {:>9.1}%", 100.0 * returned);
    }
    Ok(())
}
