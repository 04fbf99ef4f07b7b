//! Stationary crack under a step of tension (gate 4.5): stress intensity over time, before waves return.

use std::f64::consts::PI;
use std::sync::Arc;

use fpm::{Cells, Fpm, Method};
use impactite_geometry::Cuboid;
use impactite_geometry::structured::{Spacing, box_mesh};
use impactite_scene::PlaneStrain;
use mpm_materials::{LinearElastic, Moduli};

const YOUNG: f64 = 210e9;
const POISSON: f64 = 0.3;
const DENSITY: f64 = 8000.0;
/// Half the height of the plate, and crack length, half the length of the plate, m.
const HEIGHT: f64 = 2.0;
const CRACK: f64 = 5.0;
const TENSION: f64 = 500e6;

fn speed() -> f64 {
    (Moduli::young_poisson(YOUNG, POISSON).unwrap().p_wave() / DENSITY).sqrt()
}

/// Return the stress intensity \[Freund1990\], Pa sqrt(m), after the arrival of the wave from above at the crack.
fn exact(t: f64) -> f64 {
    let since = t - HEIGHT / speed();
    2.0 * TENSION / (1.0 - POISSON) * (speed() * since * (1.0 - 2.0 * POISSON) / PI).sqrt()
}

/// Return the upper half of the plate, of rectangular cells of size `h` at the tip and eight times as large at the ends.
fn cells(h: f64) -> Cells<2> {
    let count = |length: f64| (length * 8f64.ln() / (7.0 * h)).round() as usize;
    let part = |from: f64, to: f64, ratio: f64| {
        let half = Cuboid::new([from, 0.0], [to, HEIGHT]).unwrap();
        let along = Spacing::graded(count(CRACK), ratio);
        box_mesh(&half, [along, Spacing::graded(count(HEIGHT), 8.0)]).unwrap()
    };
    let plate = part(0.0, CRACK, 0.125).joined(&part(CRACK, 2.0 * CRACK, 8.0)).unwrap();
    Cells::of_mesh(&plate.welded(1e-6).unwrap()).unwrap()
}

/// Return stress intensities over the exact ones at 1.5, 2, 2.5 and 3 times the travel time of the wave to the crack. Half the tension acts
/// above and below, so that both waves together are that of the closed-form solution. K is from the opening behind the tip,
/// u_y = 4 (1 - nu^2) K / E sqrt(r / 2 pi), extrapolated linearly to the tip.
fn intensities(h: f64) -> [f64; 4] {
    let cells = cells(h);
    let law = LinearElastic::new(DENSITY, Moduli::young_poisson(YOUNG, POISSON).unwrap()).unwrap();
    let mut plate = Fpm::new(Method::symmetric(PlaneStrain), law, &cells, |_| [0.0; 2]).unwrap();
    plate
        .hold_faces(|f| f.normal[1] < -0.5 && f.centroid[0] > CRACK, Arc::new(|_| [None, Some(0.0)]))
        .unwrap();
    plate.load_faces(|f| f.normal[1] > 0.5, Arc::new(|_| [0.0, 0.5 * TENSION])).unwrap();
    let faces: Vec<(usize, f64)> = plate
        .reference()
        .iter()
        .enumerate()
        .filter(|(_, x)| x[1] < h / 1.5 && (0.05..0.45).contains(&(CRACK - x[0])))
        .map(|(i, x)| (i, x[0]))
        .collect();
    [1.5, 2.0, 2.5, 3.0].map(|part| {
        let t = part * HEIGHT / speed();
        plate.run_until(t).unwrap();
        let points: Vec<[f64; 2]> = faces
            .iter()
            .map(|&(i, x)| {
                let (r, u) = (CRACK - x, plate.displacement_at(i, [x, 0.0])[1]);
                [r, u * YOUNG / (4.0 * (1.0 - POISSON * POISSON)) * (2.0 * PI / r).sqrt()]
            })
            .collect();
        let count = points.len() as f64;
        let [r, k] = [0, 1].map(|d| points.iter().map(|p| p[d]).sum::<f64>() / count);
        let along: f64 = points.iter().map(|p| (p[0] - r) * (p[1] - k)).sum();
        let square: f64 = points.iter().map(|p| (p[0] - r).powi(2)).sum();
        (k - r * along / square) / exact(t)
    })
}

#[test]
fn the_stress_intensity_of_a_crack_that_stays_follows_the_closed_form() {
    let grids = [0.05, 0.025, 0.0125].map(intensities);
    grids.iter().for_each(|k| println!("{k:.4?}"));
    let worst = |k: &[f64; 4]| k[1..].iter().map(|k| (k - 1.0).abs()).fold(0.0, f64::max);
    assert!(worst(&grids[2]) < 0.05, "{grids:?}");
    assert!(worst(&grids[2]) < worst(&grids[0]), "{grids:?}");
}
