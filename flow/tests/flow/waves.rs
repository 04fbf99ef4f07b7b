//! Waves in a tank.

use impactite_scene::Solver;

use crate::common::{centroid, energy, tank};

/// Period and ratio of successive amplitudes of the first mode of a standing wave.
fn standing_wave(cells: usize, periods: usize) -> [f64; 2] {
    const EXACT: f64 = 1.181_816;
    let mut flow = tank(1.0, 0.5, cells, |x| 0.005 * (std::f64::consts::PI * x).cos());
    let at = |flow: &flow::Flow<2>| centroid(&flow.points())[0] - 0.5;
    let first = energy(&flow);
    let rest = energy(&tank(1.0, 0.5, cells, |_| 0.0));
    let (mut crossings, mut peaks, mut last, mut peak) = (Vec::new(), vec![at(&flow).abs()], (0.0, at(&flow)), 0.0f64);
    while !flow.reached((periods as f64 + 0.1) * EXACT) {
        flow.step_towards((periods as f64 + 0.1) * EXACT).unwrap();
        let now = (flow.time(), at(&flow));
        peak = peak.max(now.1.abs());
        if now.1 * last.1 < 0.0 {
            crossings.push(last.0 + (now.0 - last.0) * last.1 / (last.1 - now.1));
            peaks.push(peak);
            peak = 0.0;
        }
        last = now;
    }
    println!("steps {} peaks {peaks:?} energy {first} {} {}", flow.steps(), energy(&flow), rest);
    let count = crossings.len() - 1;
    let period = 2.0 * (crossings[count] - crossings[0]) / count as f64;
    [period / EXACT - 1.0, peaks[peaks.len() - 1] / peaks[1]]
}

#[test]
fn a_standing_wave_has_its_period_and_keeps_its_amplitude() {
    for cells in [16, 32, 64] {
        println!("{cells}: {:?}", standing_wave(cells, 4));
    }
}
