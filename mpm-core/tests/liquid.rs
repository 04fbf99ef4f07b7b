//! Weakly compressible liquids whose density is renewed from positions.

use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::scene::error::SceneError;
use mpm_core::{BlockGrid, Boundary, Deformable, Method, Mpm, PlaneStrain, Side, Team};
use mpm_materials::{Constitutive, Fluid, IdealGas, Lane, Tait};

type Failed = Box<dyn std::error::Error>;

const GRAVITY: f64 = 9.81;
const DENSITY: f64 = 1000.0;
/// Depth of the water, m.
const DEPTH: f64 = 0.5;

/// How the liquid is bounded.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bounds {
    Symmetry,
    Walls,
}

/// Water in a tank of length `length`, m, with a surface of slope -`slope`, under the pressure of its depth.
fn tank(cells: usize, length: f64, slope: f64, bounds: Bounds, renewed: bool) -> Result<Mpm<2>, Failed> {
    let sound = 10.0 * (GRAVITY * DEPTH).sqrt();
    let law = Fluid::new(Tait::new(DENSITY, sound)?);
    let lattice = Lattice::new([0.0; 2], DEPTH / cells as f64)?;
    let top = move |x: f64| DEPTH + slope * (0.5 * length - x);
    let mut seeds: Seeds<2> =
        fill(&Cuboid::new([0.0; 2], [length, 1.5 * DEPTH])?, &lattice, 2, &Filling::new())?;
    let inside: Vec<bool> = seeds.positions.iter().map(|x| x[1] < top(x[0])).collect();
    let mut keep = inside.iter();
    seeds.positions.retain(|_| keep.next() == Some(&true));
    let mut keep = inside.iter();
    seeds.volumes.retain(|_| keep.next() == Some(&true));
    let state = move |x: [f64; 2]| {
        let pressure = DENSITY * GRAVITY * (top(x[0]) - x[1]);
        let ratio = (1.0 + 7.0 * pressure / (DENSITY * sound * sound)).powf(-1.0 / 7.0);
        let mut state = law.virgin();
        state.volume_ratio = Lane::splat(ratio);
        state
    };
    let mut mpm = Mpm::new(Method::contact_at_rest(PlaneStrain), BlockGrid::new(lattice));
    let body = Deformable::new("water", law, &seeds).in_state(state);
    mpm.add_body(if renewed { body.with_renewed_density() } else { body })?;
    for (axis, at, side) in [(0, 0.0, Side::Above), (0, length, Side::Below), (1, 0.0, Side::Above)] {
        mpm.bound(match bounds {
            Bounds::Symmetry => Boundary::Symmetry { axis, at, side },
            Bounds::Walls => Boundary::Wall { axis, at, side, velocity: 0.0 },
        })?;
    }
    mpm.set_body_force(|_| [0.0, -GRAVITY]);
    Ok(mpm)
}

/// Height of the centre of mass, m, and root mean square of the deviation from the hydrostatic pressure over rho g H.
fn look(mpm: &Mpm<2>) -> (f64, f64) {
    let (mut mass, mut moment, mut square, mut count) = (0.0, 0.0, 0.0, 0.0);
    mpm.bodies()[0].for_each(&mut |p| {
        mass += p.mass;
        moment += p.mass * p.position[1];
        let exact = DENSITY * GRAVITY * (DEPTH - p.position[1]);
        square += ((p.pressure() - exact) / (DENSITY * GRAVITY * DEPTH)).powi(2);
        count += 1.0;
    });
    (moment / mass, f64::sqrt(square / count))
}

#[test]
fn water_at_rest_stays_at_rest() -> Result<(), Failed> {
    for cells in [8, 16] {
        let mut mpm = tank(cells, DEPTH, 0.0, Bounds::Symmetry, true)?;
        let start = look(&mpm).0;
        mpm.run_until(1.0)?;
        let (height, noise) = look(&mpm);
        let kinetic = mpm.totals().kinetic / (mpm.totals().mass * GRAVITY * DEPTH);
        // The task of the method: one per cent of the pressure at the floor and of the height.
        assert!(noise < 0.01, "{cells} cells: {noise}");
        assert!((height / start - 1.0).abs() < 0.01, "{cells} cells: {height} of {start}");
        assert!(kinetic < 1e-6, "{cells} cells: {kinetic}");
    }
    Ok(())
}

#[test]
fn sloshing_water_keeps_its_volume() -> Result<(), Failed> {
    // The first mode has the period 1.18 s. Without renewal the centre falls by percents in five periods.
    let mut mpm = tank(16, 1.0, 0.1, Bounds::Symmetry, true)?;
    let start = look(&mpm).0;
    let wave = 0.1f64.powi(2) / (24.0 * DEPTH);
    mpm.run_until(3.6)?;
    let height = look(&mpm).0;
    // Half a per cent; the wave raises the centre by slope^2 L^2 / (24 H) at most.
    assert!((height - start).abs() < 0.005 * start + wave, "{height} of {start}");
    Ok(())
}

#[test]
fn renewed_liquids_have_the_same_bits_for_any_number_of_threads_and_after_a_restart() -> Result<(), Failed> {
    let file = std::env::temp_dir().join("impactite-renewed-liquid");
    let bits = |mpm: &Mpm<2>| {
        let mut list = Vec::new();
        mpm.bodies()[0].for_each(&mut |p| {
            list.push((
                p.number,
                p.position.map(f64::to_bits),
                p.state.iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
            ));
        });
        list.sort();
        list
    };
    let mut one = tank(8, 1.0, 0.2, Bounds::Walls, true)?;
    one.run_until(0.1)?;
    one.save(&file)?;
    one.run_until(0.2)?;
    let mut three = tank(8, 1.0, 0.2, Bounds::Walls, true)?;
    three.set_team(Team::new(3)?);
    three.run_until(0.1)?;
    three.run_until(0.2)?;
    assert!(bits(&one) == bits(&three), "threads");
    let mut again = tank(8, 1.0, 0.2, Bounds::Walls, true)?.resumed(&file)?;
    again.run_until(0.2)?;
    assert!(bits(&one) == bits(&again), "restart");
    let other = tank(8, 1.0, 0.2, Bounds::Walls, false)?.resumed(&file);
    assert!(other.is_err(), "a scene without renewal continued one with it");
    Ok(())
}

#[test]
fn other_laws_and_methods_are_refused() -> Result<(), Failed> {
    let lattice = Lattice::new([0.0; 2], 0.25)?;
    let seeds = fill(&Cuboid::new([0.0; 2], [1.0; 2])?, &lattice, 2, &Filling::new())?;
    let refused = |added: Result<(), SceneError>| matches!(added, Err(SceneError::NoRenewal(..)));
    let mut mpm = Mpm::new(Method::contact_at_rest(PlaneStrain), BlockGrid::new(lattice));
    let gas = Deformable::new("gas", Fluid::new(IdealGas::<f64>::air()), &seeds).with_renewed_density();
    assert!(refused(mpm.add_body(gas)));
    let mut mpm = Mpm::new(Method::machine_parts(PlaneStrain), BlockGrid::new(lattice));
    let water = Fluid::new(Tait::new(DENSITY, 10.0)?);
    assert!(refused(mpm.add_body(Deformable::new("water", water, &seeds).with_renewed_density())));
    Ok(())
}
