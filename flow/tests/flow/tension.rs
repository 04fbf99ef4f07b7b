//! Surface tension.

use flow::{Flow, FlowOptions, Fluid};
use impactite_geometry::{Ball, Lattice};
use impactite_scene::{Solver, Watch};

use crate::gates::{drop_at_rest, staggered};

const RADIUS: f64 = 5.0e-3;
const TENSION: f64 = 0.072;
const DENSITY: f64 = 1000.0;

/// Drop of radius 5 mm of `cells` cells, of water with this viscosity, stretched along x by 1 + `stretch`.
fn drop<const D: usize>(cells: f64, viscosity: f64, stretch: f64) -> Flow<D> {
    let h = RADIUS / cells;
    // Not centred at a node.
    let lattice = Lattice::new([0.37 * h; D], h).unwrap();
    let fluid = Fluid::new(DENSITY).unwrap().with_surface_tension(TENSION).unwrap();
    let fluid = fluid.with_viscosity(viscosity).unwrap();
    let mut flow = Flow::new(FlowOptions::new(lattice));
    let filling = impactite_geometry::Filling::new();
    let ball = Ball::new([0.0; D], RADIUS).unwrap();
    let mut seeds = impactite_geometry::fill(&ball, &lattice, 2, &filling).unwrap();
    for x in &mut seeds.positions {
        x[0] *= 1.0 + stretch;
        let across = (1.0 + stretch).powf(-1.0 / (D as f64 - 1.0));
        (1..D).for_each(|d| x[d] *= across);
    }
    flow.add_fluid("drop", fluid, &seeds, |_| [0.0; D]).unwrap();
    flow.set_watch(Watch::off());
    flow
}

/// Mean pressure within half of the radius, Pa.
fn pressure<const D: usize>(flow: &Flow<D>) -> f64 {
    let points = flow.points();
    let inner: Vec<_> = points
        .iter()
        .filter(|p| p.position.iter().map(|x| x * x).sum::<f64>() < 0.25 * RADIUS * RADIUS)
        .collect();
    inner.iter().map(|p| p.pressure()).sum::<f64>() / inner.len() as f64
}

/// The pressure is sigma / R in the plane and 2 sigma / R in space. Speeds at rest come from the noise of the particles: they do not fall with
/// the cells, since the filters of the curvature are some cells wide.
#[test]
fn a_drop_at_rest_has_its_pressure() {
    for (cells, allowed) in [(8.0, 0.01), (16.0, 0.005)] {
        let [first, last, fastest] = drop_at_rest(staggered, cells, 0.01).unwrap();
        println!(
            "{cells} cells: errors of the pressure {first:.1e}, {last:.1e} after 10 ms; speed {fastest:.1e} m/s"
        );
        assert!(first.abs() < allowed && last.abs() < 5.0 * allowed, "{cells}: {first} {last}");
        // A tenth of sqrt(sigma / (rho R)), 0.12 m/s.
        assert!(fastest < 0.02, "{cells}: {fastest}");
    }
    let mut flow = drop::<3>(6.0, 1e-3, 0.0);
    flow.step_at_most(f64::INFINITY).unwrap();
    let error = pressure(&flow) / 28.8 - 1.0;
    println!("6 cells in space: error of the pressure {error:.1e}");
    assert!(error.abs() < 0.03, "{error}");
}

/// Small drops oscillate slowly, since the filters of the curvature, 1.9 cells wide, weaken it by (1.9 / R)^2 in cells: 11 % at 6 cells.
#[test]
fn a_drop_oscillates_with_its_period() {
    for (cells, slow) in [(6.0, 0.12), (12.0, 0.04)] {
        let mut flow = drop::<2>(cells, 1e-3, 0.05);
        const EXACT: f64 = 0.10688;
        let at = |flow: &Flow<2>| {
            let points = flow.points();
            let sum = |d: usize| points.iter().map(|p| p.volume * p.position[d].powi(2)).sum::<f64>();
            (sum(0) / sum(1)).ln() / 4.0
        };
        let (mut last, mut crossings, mut peak) = ((0.0, at(&flow)), Vec::new(), vec![0.0f64]);
        while !flow.reached(1.3 * EXACT) {
            flow.step_towards(1.3 * EXACT).unwrap();
            let now = (flow.time(), at(&flow));
            let n = peak.len() - 1;
            peak[n] = peak[n].max(now.1.abs());
            if now.1 * last.1 < 0.0 {
                crossings.push(last.0 + (now.0 - last.0) * last.1 / (last.1 - now.1));
                peak.push(0.0);
            }
            last = now;
        }
        let late = 2.0 * (crossings[1] - crossings[0]) / EXACT - 1.0;
        println!("{cells} cells: period {late:+.3}, peaks {peak:.4?} in {} steps", flow.steps());
        assert!(late.abs() < slow, "{cells}: {late}");
        // Viscosity takes 3 % in half a period.
        assert!(peak[1] / peak[0] > 0.9 && peak[1] < peak[0], "{peak:?}");
    }
}
