//! Recommended methods in scenes in which methods fail: a solid spinning without load, and hypervelocity impact at
//! several km/s.
//!
//! `cargo test --release -p impactite-tests --all-features --test step -- --ignored --nocapture of_methods` prints the tables of book, "Methods compared".

use std::f64::consts::TAU;

use mpm_core::geometry::{Ball, Compose, Cuboid, Filling, Lattice, fill};
use mpm_core::{
    Aflip, Apic, BlockGrid, Boundary, CpGimp, Flip, FullSpace, IntoKernels, Kernels, Linear, Method, Mls,
    Mpm, Musl, PlaneStrain, QuadraticBSpline, Side, Totals, Usf, Usl, Watch,
};
use mpm_materials::{IntoMaterial, library};

#[test]
fn shares_out_of_range_are_refused() {
    for share in [-0.01, 1.5, f64::NAN] {
        let message = Aflip::new(share).expect_err("refused").to_string();
        assert_eq!(message, format!("AFLIP: share = {share} is not allowed; it must be 0 to 1"));
    }
}

/// Result of a spinning disc.
struct Spun {
    /// Relative changes of energy and angular momentum.
    energy: f64,
    angular: f64,
    /// Largest plastic strain.
    plastic: f64,
    /// Largest stress, Pa.
    stress: f64,
}

/// Run a disc of 0.1 m that spins without load for some turns.
fn spin(
    method: Kernels<f64, 2>,
    law: impl IntoMaterial<f64>,
    rim: f64,
    [cells, turns]: [f64; 2],
) -> Result<Spun, String> {
    let radius = 0.1;
    let lattice = Lattice::new([0.003, -0.002], radius / cells).expect("lattice");
    let disc = Ball::new([0.0; 2], radius).expect("disc");
    let seeds = fill(&disc, &lattice, 2, &Filling::new()).expect("seeds");
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let spin = rim / radius;
    mpm.add("disc", law, &seeds, |x| [-spin * x[1], spin * x[0]]).expect("disc");
    // Warnings only, so that failing runs reach the end.
    mpm.set_watch(Watch::default().only_warn());
    let start = mpm.totals();
    mpm.run_until(turns * TAU / spin).map_err(|e| e.to_string())?;
    let end = mpm.totals();
    let plastic = mpm.bodies()[0].state_names().iter().position(|n| n == "plastic_strain");
    let mut spun = Spun {
        energy: (end.kinetic + end.internal) / (start.kinetic + start.internal) - 1.0,
        angular: end.angular_momentum[2] / start.angular_momentum[2] - 1.0,
        plastic: 0.0,
        stress: 0.0,
    };
    mpm.bodies()[0].for_each(&mut |p| {
        spun.plastic = spun.plastic.max(plastic.map_or(0.0, |n| p.state[n]));
        spun.stress = p.stress.iter().fold(spun.stress, |a, s| a.max(s.abs()));
    });
    Ok(spun)
}

/// The disc stays elastic: the exact stress is (3 + nu)/8 rho v^2, 8 MPa at 50 m/s and 130 MPa at 200 m/s.
#[test]
fn a_disc_that_spins_stays_whole() {
    let impact = || Method::impact(PlaneStrain).into_kernels();
    let apic = || Method::contact_at_rest(PlaneStrain).into_kernels();
    for (name, method) in [("impact", impact()), ("APIC", apic())] {
        for (rim, cells, turns) in [(200.0, 10.0, 1.0), (50.0, 6.0, 0.5)] {
            for law in [library::steel_4340().into_material(), library::arne_tool_steel().into_material()] {
                let Spun { energy, angular, plastic, .. } =
                    spin(method.clone(), law, rim, [cells, turns]).expect("run");
                let what = format!("{name}, {rim} m/s: energy {energy:e}, angular momentum {angular:e}");
                assert!(energy.abs() < 1e-3 && angular.abs() < 5e-4, "{what}");
                assert!(plastic < 1e-6, "{what}, plastic strain {plastic}");
            }
        }
    }
}

/// Run the impact of an aluminium ball of 2 mm radius (quarter model) on a plate of 2 mm, for the time of 12 mm of
/// free flight.
fn shoot(method: Kernels<f64, 3>, speed: f64) -> Result<[Totals; 2], String> {
    let h = 0.25e-3;
    let lattice = Lattice::new([0.0; 3], h).expect("lattice");
    let r = 2e-3;
    let quarter = Cuboid::new([0.0; 3], [r, r, 2.0 * r]).expect("quarter");
    let ball = Ball::new([0.0, 0.0, r], r).expect("ball").and(quarter);
    let plate = Cuboid::new([0.0, 0.0, -2e-3], [7e-3, 7e-3, 0.0]).expect("plate");
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let law = library::aluminium_6061_t6().with_bulk_viscosity(0.06, 1.5).expect("law");
    let seeds = fill(&ball, &lattice, 2, &Filling::new()).expect("seeds");
    mpm.add("ball", law, &seeds, |_| [0.0, 0.0, -speed]).expect("ball");
    mpm.add("plate", law, &fill(&plate, &lattice, 2, &Filling::new()).expect("seeds"), |_| [0.0; 3])
        .expect("plate");
    for axis in 0..2 {
        mpm.bound(Boundary::Symmetry { axis, at: 0.0, side: Side::Above }).expect("plane");
    }
    let start = mpm.totals();
    mpm.run_until(12e-3 / speed).map_err(|e| e.to_string())?;
    Ok([start, mpm.totals()])
}

#[test]
fn shots_at_several_kilometres_a_second_come_to_their_end() {
    for speed in [3e3, 9e3] {
        let [start, end] = shoot(Method::impact(FullSpace).into_kernels(), speed).expect("run");
        let energy = (end.kinetic + end.internal) / start.kinetic - 1.0;
        let momentum = end.momentum[2] / start.momentum[2] - 1.0;
        assert!(energy < 0.005 && energy > -0.08, "{speed} m/s: energy {energy}");
        assert!(momentum.abs() < 1e-12, "{speed} m/s: momentum {momentum:e}");
    }
}

#[test]
#[ignore = "a study of minutes, not a test"]
fn of_methods() {
    let plane: [(&str, Kernels<f64, 2>); 6] = [
        ("AFLIP", Method::new(QuadraticBSpline, Aflip::default(), Usl, PlaneStrain).into_kernels()),
        ("APIC", Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain).into_kernels()),
        ("MLS-APIC", Method::new(QuadraticBSpline, Mls, Usl, PlaneStrain).into_kernels()),
        ("quadratic FLIP MUSL", Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain).into_kernels()),
        ("cpGIMP FLIP MUSL", Method::new(CpGimp, Flip, Musl, PlaneStrain).into_kernels()),
        ("linear FLIP MUSL", Method::new(Linear, Flip, Musl, PlaneStrain).into_kernels()),
    ];
    for (name, method) in plane {
        for (rim, turns) in [(50.0, 4.0), (200.0, 4.0), (200.0, 20.0)] {
            match spin(method.clone(), library::arne_tool_steel(), rim, [10.0, turns]) {
                Ok(Spun { energy, angular, plastic, stress }) => println!(
                    "{name}, {rim} m/s, {turns} turns: energy {:+.3} %, angular momentum {:+.3} %, plastic strain {plastic:.1e}, stress {:.0} MPa",
                    100.0 * energy,
                    100.0 * angular,
                    stress / 1e6
                ),
                Err(e) => println!("{name}, {rim} m/s, {turns} turns: {e}"),
            }
        }
    }
    let space: [(&str, Kernels<f64, 3>); 6] = [
        ("AFLIP", Method::impact(FullSpace).into_kernels()),
        (
            "AFLIP USF",
            Method::new(QuadraticBSpline, Aflip::default(), Usf, FullSpace).compiled().into_kernels(),
        ),
        ("APIC", Method::new(QuadraticBSpline, Apic, Usl, FullSpace).into_kernels()),
        ("quadratic FLIP MUSL", Method::new(QuadraticBSpline, Flip, Musl, FullSpace).into_kernels()),
        ("cpGIMP FLIP MUSL", Method::new(CpGimp, Flip, Musl, FullSpace).into_kernels()),
        ("linear FLIP MUSL", Method::new(Linear, Flip, Musl, FullSpace).into_kernels()),
    ];
    for (name, method) in space {
        for speed in [3e3, 5e3, 7e3, 9e3] {
            match shoot(method.clone(), speed) {
                Ok([start, end]) => println!(
                    "{name}, {speed} m/s: energy {:+.2} %, kinetic energy left {:.1} %",
                    100.0 * ((end.kinetic + end.internal) / start.kinetic - 1.0),
                    100.0 * end.kinetic / start.kinetic
                ),
                Err(e) => println!("{name}, {speed} m/s: {e}"),
            }
        }
    }
}
