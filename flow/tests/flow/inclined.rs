//! Liquid at rest between inclined and curved walls.

use flow::{Flow, FlowOptions, Fluid, Wall};
use impactite_geometry::{Ball, Compose, Cuboid, Implicit, Lattice, Polygon, Shape};

use crate::common::{GRAVITY, centroid};

/// What liquid at rest does in two seconds, with cells of `h` metres.
struct Rest {
    /// Largest speed of a particle after the first second over sqrt(g H).
    speed: f64,
    /// Largest deviation of the volume, relative.
    volume: f64,
    /// Largest shift of the centroid, in cells.
    shift: f64,
}

fn rest<const D: usize>(tank: impl Shape<D> + Clone + 'static, depth: f64, h: f64) -> Rest {
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; D], h).unwrap()));
    flow.add_wall(Wall::container(tank.clone())).unwrap();
    let (mut low, mut high, mut gravity) = ([-10.0; D], [10.0; D], [0.0; D]);
    (low[1], high[1], gravity[1]) = (-10.0, depth, -GRAVITY);
    let water = tank.and(Cuboid::new(low, high).unwrap());
    flow.add_shape("water", Fluid::new(1000.0).unwrap(), &water, 2, |_| [0.0; D]).unwrap();
    flow.set_body_force(move |_| gravity);
    let start = centroid(&flow.points())[1];
    let total: f64 = flow.points().iter().map(|p| p.volume).sum();
    let mut found = Rest { speed: 0.0, volume: 0.0, shift: 0.0 };
    for n in 1..=20 {
        flow.run_until(0.1 * f64::from(n)).unwrap();
        let points = flow.points();
        let speeds = points.iter().map(|p| p.velocity.iter().map(|v| v * v).sum::<f64>().sqrt());
        if n > 10 {
            found.speed = found.speed.max(speeds.fold(0.0, f64::max) / (GRAVITY * depth).sqrt());
        }
        found.volume = found.volume.max((flow.liquid_volume() / total - 1.0).abs());
        found.shift = found.shift.max((centroid(&points)[1] - start).abs() / h);
    }
    found
}

/// Tank between walls of this slope.
fn vee(slope: f64) -> Polygon {
    let width = 1.0 / slope;
    Polygon::new(vec![[0.0, 0.0], [width, 1.0], [width, 2.0], [-width, 2.0], [-width, 1.0]]).unwrap()
}

/// The centroid moves as particles fill the cells beside the walls; of the places of a fill on a slope of 1 a whole row is on the wall.
#[test]
fn liquid_rests_between_inclined_walls() {
    let h = 1.0 / 40.0;
    // Particles at the thin edge of the surface, with less than half a kernel of liquid around them, move more than the liquid.
    for (slope, speed, volume) in [(2.0, 1e-3, 1e-3), (1.0, 0.1, 1e-2), (0.5, 0.1, 5e-3)] {
        let found = rest(vee(slope), 0.5, h);
        println!(
            "slope {slope}: speed {:.2e}, volume {:.2e}, shift {:.3} cells",
            found.speed, found.volume, found.shift
        );
        assert!(found.speed < speed && found.volume < volume && found.shift < 0.1);
    }
    let found = rest(Ball::<2>::new([0.01, 0.5], 0.5).unwrap(), 0.5, h);
    println!("disc: speed {:.2e}, volume {:.2e}, shift {:.3} cells", found.speed, found.volume, found.shift);
    assert!(found.speed < 1e-2 && found.volume < 5e-3 && found.shift < 0.02);
}

#[test]
fn liquid_rests_between_inclined_walls_in_space() {
    let h = 1.0 / 20.0;
    let plane = vee(2.0);
    let bounds = impactite_geometry::Bounds { min: [-0.5, 0.0, 0.0], max: [0.5, 2.0, 0.4] };
    let trough = Implicit::new(bounds, move |x: [f64; 3]| {
        plane.signed_distance([x[0], x[1]]).max((x[2] - 0.2).abs() - 0.2)
    });
    let found = rest(trough, 0.5, h);
    println!(
        "trough: speed {:.2e}, volume {:.2e}, shift {:.3} cells",
        found.speed, found.volume, found.shift
    );
    // Ten cells deep.
    assert!(found.speed < 1e-2 && found.volume < 5e-3 && found.shift < 0.05);
}
