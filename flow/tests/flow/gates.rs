//! Measures of exact cases, in any scheme.

use std::f64::consts::PI;

use flow::{Flow, FlowOptions, Fluid, SemiStaggered, Wall};
use impactite_geometry::{Ball, Cuboid, Disc, Filling, HalfSpace, Lattice, fill};
use impactite_scene::{Solver, StepError, TimeControl, Watch};

use crate::common::{GRAVITY, box_of_particles, centroid, tank};

/// Choice of a scheme: what it makes of options.
pub type Scheme = fn(FlowOptions<2>) -> FlowOptions<2>;

/// The default.
pub fn staggered(options: FlowOptions<2>) -> FlowOptions<2> {
    options
}

/// Staggered, without reflection: of first order in time, as the semi-staggered scheme is.
pub fn first_order(options: FlowOptions<2>) -> FlowOptions<2> {
    options.without_reflection()
}

/// Semi-staggered, as printed.
pub fn semi_staggered(options: FlowOptions<2>) -> FlowOptions<2> {
    options.semi_staggered(SemiStaggered::default())
}

fn options(scheme: Scheme, h: f64) -> FlowOptions<2> {
    scheme(FlowOptions::new(Lattice::new([0.0; 2], h).unwrap()))
}

/// Water of a depth of 8 cells and `theta` of a cell in a tank of 16 cells, and its depth.
pub fn resting(scheme: Scheme, theta: f64) -> (Flow<2>, f64) {
    const H: f64 = 1.0 / 16.0;
    let depth = (8.0 + theta) * H;
    let mut flow = Flow::new(options(scheme, H));
    flow.add_wall(Wall::container(Cuboid::new([0.0; 2], [1.0, 1.0]).unwrap())).unwrap();
    let seeds = box_of_particles([0.0; 2], [1.0, depth], H, 2);
    flow.add_fluid("water", Fluid::new(1000.0).unwrap(), &seeds, |_| [0.0; 2]).unwrap();
    flow.set_body_force(|_| [0.0, -GRAVITY]);
    (flow, depth)
}

/// Water of a depth of 8 cells and `theta` of a cell in a tank of 16 cells: largest error of the pressure of particles after the first step,
/// and largest speed until 2 s, over rho g H and sqrt(g H).
pub fn hydrostatic(scheme: Scheme, theta: f64) -> Result<[f64; 2], StepError> {
    let (mut flow, depth) = resting(scheme, theta);
    let before = flow.points();
    flow.step_at_most(1e-4)?;
    let mut error = 0.0f64;
    for (p, q) in before.iter().zip(flow.points()) {
        // The row at the surface interpolates to air.
        if p.position[1] < depth - 1.0 / 16.0 {
            error = error.max((q.pressure() / (1000.0 * GRAVITY) - (depth - p.position[1])).abs() / depth);
        }
    }
    flow.run_until(2.0)?;
    let speed = flow.points().iter().map(|p| p.velocity[0].hypot(p.velocity[1])).fold(0.0, f64::max);
    Ok([error, speed / (GRAVITY * depth).sqrt()])
}

/// Column of water as wide as high, of this many cells, released in front: errors of the impulse of the wall and of the mean acceleration in the first
/// step, over rho g H^2 / 2 and g.
pub fn column(scheme: Scheme, cells: usize) -> Result<[f64; 2], StepError> {
    let h = 1.0 / cells as f64;
    let mut flow = Flow::new(options(scheme, h));
    for n in [[1.0, 0.0], [0.0, 1.0]] {
        flow.add_wall(Wall::solid(HalfSpace::new([0.0; 2], n.map(|x| x)).unwrap())).unwrap();
    }
    let seeds = box_of_particles([0.0; 2], [1.0; 2], h, 2);
    flow.add_fluid("water", Fluid::new(1000.0).unwrap(), &seeds, |_| [0.0; 2]).unwrap();
    flow.set_body_force(|_| [0.0, -GRAVITY]);
    flow.step_at_most(1e-4)?;
    // The forces of leap-frog act to the middle of the first step.
    let kick = flow.exchange().load[1] / (-GRAVITY * flow.totals().mass);
    let force = flow.exchange().impulse[0] / kick / (0.5 * 1000.0 * GRAVITY);
    let mean = flow.totals().momentum[0] / flow.totals().mass / kick / GRAVITY;
    Ok([force - 0.58937, mean - 0.29469])
}

/// Period of the first mode of a standing wave over the exact one less 1, and ratio of successive amplitudes after `periods`.
pub fn standing_wave(scheme: Scheme, cells: usize, periods: usize) -> Result<[f64; 2], StepError> {
    const EXACT: f64 = 1.181_816;
    let mut flow = tank(scheme, 1.0, 0.5, cells, |x| 0.005 * (PI * x).cos());
    let at = |flow: &Flow<2>| centroid(&flow.points())[0] - 0.5;
    let (mut crossings, mut peaks, mut last, mut peak) =
        (Vec::new(), vec![at(&flow).abs()], (0.0, at(&flow)), 0.0f64);
    while !flow.reached((periods as f64 + 0.1) * EXACT) {
        flow.step_towards((periods as f64 + 0.1) * EXACT)?;
        let now = (flow.time(), at(&flow));
        peak = peak.max(now.1.abs());
        if now.1 * last.1 < 0.0 {
            crossings.push(last.0 + (now.0 - last.0) * last.1 / (last.1 - now.1));
            peaks.push(peak);
            peak = 0.0;
        }
        last = now;
    }
    let count = crossings.len() - 1;
    let period = 2.0 * (crossings[count] - crossings[0]) / count as f64;
    Ok([period / EXACT - 1.0, peaks[peaks.len() - 1] / peaks[1]])
}

/// Errors of the axes a and b and of the energy of a drop of `cells` cells radius that stretches, at A0 t = 0.5, 1, 1.5, 2.
pub fn elliptic_drop(scheme: Scheme, cells: f64) -> Result<Vec<[f64; 3]>, StepError> {
    // A0 t, a / R.
    const EXACT: [[f64; 2]; 4] = [[0.5, 1.59476], [1.0, 2.27552], [1.5, 2.97486], [2.0, 3.67899]];
    let mut flow = Flow::new(options(scheme, 1.0 / cells));
    let disc = Disc::new([0.0; 2], 1.0).unwrap();
    flow.add_shape("drop", Fluid::new(1000.0).unwrap(), &disc, 2, |x| [x[0], -x[1]]).unwrap();
    let before = flow.totals();
    let mut errors = Vec::new();
    for [t, a] in EXACT {
        flow.run_until(t)?;
        // Second moment of an ellipse: a^2 / 4.
        let points = flow.points();
        let volume: f64 = points.iter().map(|p| p.volume).sum();
        let axis = |d: usize| {
            2.0 * (points.iter().map(|p| p.volume * p.position[d].powi(2)).sum::<f64>() / volume).sqrt()
        };
        let now = flow.totals();
        errors.push([axis(0) / a - 1.0, axis(1) * a - 1.0, now.kinetic / before.kinetic - 1.0]);
        let momentum: f64 = now.momentum.iter().map(|p| p * p).sum::<f64>().sqrt();
        assert!(momentum < 1e-9 * now.momentum_scale, "{momentum}");
    }
    Ok(errors)
}

/// Error of the mean speed of Taylor-Green vortices after L / U at a Reynolds number of 100, over its exact value.
pub fn taylor_green(scheme: Scheme, cells: usize) -> Result<f64, StepError> {
    let h = 1.0 / cells as f64;
    let mut options = options(scheme, h);
    for axis in 0..2 {
        options = options.periodic(axis, cells).unwrap();
    }
    let mut flow = Flow::new(options);
    let fluid = Fluid::new(1.0).unwrap().with_viscosity(0.01).unwrap();
    let k = 2.0 * PI;
    let exact = |x: [f64; 2]| [(k * x[0]).sin() * (k * x[1]).cos(), -(k * x[0]).cos() * (k * x[1]).sin()];
    flow.add_fluid("fluid", fluid, &box_of_particles([0.0; 2], [1.0; 2], h, 2), exact).unwrap();
    flow.set_time_control(TimeControl::Courant { factor: 0.5, growth: 1.1 }).unwrap();
    flow.run_until(1.0)?;
    let now = flow.time() - flow.velocity_lag();
    let (mut onto, mut norm) = (0.0, 0.0);
    for p in flow.points() {
        let e = exact([p.position[0], p.position[1]]);
        onto += e[0] * p.velocity[0] + e[1] * p.velocity[1];
        norm += e[0] * e[0] + e[1] * e[1];
    }
    Ok(onto / norm / (-2.0 * 0.01 * k * k * now).exp() - 1.0)
}

/// Speed in the middle of plane channel flow from rest over its final value and the exact one, at nu t / H^2 = 0.05, 0.1, 0.2, in
/// steps of at most `longest` H^2 / nu.
pub fn poiseuille(
    scheme: Scheme,
    cells: usize,
    viscosity: f64,
    longest: f64,
) -> Result<Vec<[f64; 2]>, StepError> {
    let start = |t: f64| {
        let term = |n: f64| {
            let sign = if (n as usize / 2).is_multiple_of(2) { 1.0 } else { -1.0 };
            32.0 / (n * PI).powi(3) * sign * (-n * n * PI * PI * t).exp()
        };
        1.0 - (0..20).map(|m| term(2.0 * f64::from(m) + 1.0)).sum::<f64>()
    };
    assert!((start(0.1) - 0.61535).abs() < 1e-5);
    let h = 1.0 / cells as f64;
    let mut flow = Flow::new(options(scheme, h).periodic(0, 8).unwrap());
    for (y, n) in [(0.0, 1.0), (1.0, -1.0)] {
        flow.add_wall(Wall::solid(HalfSpace::new([0.0, y], [0.0, n]).unwrap()).no_slip()).unwrap();
    }
    let fluid = Fluid::new(1.0).unwrap().with_viscosity(viscosity).unwrap();
    flow.add_fluid("fluid", fluid, &box_of_particles([0.0; 2], [8.0 * h, 1.0], h, 2), |_| [0.0; 2]).unwrap();
    // Final speed 1 in the middle.
    flow.set_body_force(move |_| [8.0 * viscosity, 0.0]);
    // Steps of 1/100 of the time, since the speed sets none at first.
    flow.set_time_control(TimeControl::Fixed(0.002f64.min(longest) / viscosity)).unwrap();
    let mut found = Vec::new();
    for time in [0.05, 0.1, 0.2] {
        flow.run_until(time / viscosity)?;
        let exact = start((flow.time() - flow.velocity_lag()) * viscosity);
        // Mean over the particles beside the middle, and the profile from there.
        let (mut sum, mut count) = (0.0, 0.0);
        for p in flow.points().iter().filter(|p| (p.position[1] - 0.5).abs() < 0.6 * h) {
            let y = p.position[1] - 0.5;
            sum += p.velocity[0] + 4.0 * exact * y * y;
            count += 1.0;
        }
        found.push([sum / count, exact]);
    }
    Ok(found)
}

/// Water drop of radius 5 mm of `cells` cells at rest: errors of the mean pressure within half of the radius in the first step and at `end`,
/// and the largest speed then, m/s.
pub fn drop_at_rest(scheme: Scheme, cells: f64, end: f64) -> Result<[f64; 3], StepError> {
    const RADIUS: f64 = 5.0e-3;
    let h = RADIUS / cells;
    // Not centred at a node.
    let lattice = Lattice::new([0.37 * h; 2], h).unwrap();
    let fluid = Fluid::new(1000.0).unwrap().with_surface_tension(0.072).unwrap();
    let mut flow = Flow::new(scheme(FlowOptions::new(lattice)));
    let seeds = fill(&Ball::new([0.0; 2], RADIUS).unwrap(), &lattice, 2, &Filling::new()).unwrap();
    flow.add_fluid("drop", fluid.with_viscosity(1e-3).unwrap(), &seeds, |_| [0.0; 2]).unwrap();
    flow.set_watch(Watch::off());
    let pressure = |flow: &Flow<2>| {
        let points = flow.points();
        let inner = points.iter().filter(|p| p.position[0].hypot(p.position[1]) < 0.5 * RADIUS);
        let list: Vec<_> = inner.map(|p| p.pressure()).collect();
        list.iter().sum::<f64>() / list.len() as f64 / 14.4 - 1.0
    };
    flow.step_at_most(f64::INFINITY)?;
    let first = pressure(&flow);
    flow.run_until(end)?;
    let fastest = flow.points().iter().map(|p| p.velocity[0].hypot(p.velocity[1])).fold(0.0, f64::max);
    Ok([first, pressure(&flow), fastest])
}

/// A tank that sways near resonance for 6 s and sloshes until `end`: least and largest volume over that after half a second, largest divergence
/// over v/h, energy not explained over that of the motion, height of the centroid over that at the start.
pub fn sloshing(scheme: Scheme, cells: usize, end: f64) -> Result<[f64; 5], StepError> {
    let mut flow = tank(scheme, 1.0, 0.5, cells, |_| 0.0);
    let omega = 0.95 * 5.31655;
    flow.set_body_force(move |t| [if t < 6.0 { -0.2 * (omega * t).sin() } else { 0.0 }, -GRAVITY]);
    let before = centroid(&flow.points())[1];
    let (mut least, mut most, mut divergence, mut first) = (f64::INFINITY, 0.0f64, 0.0f64, None);
    for part in 1..=(2.0 * end) as usize {
        flow.run_until(0.5 * part as f64)?;
        let volume = flow.liquid_volume();
        let share = volume / *first.get_or_insert(volume);
        (least, most) = (least.min(share), most.max(share));
        divergence = divergence.max(flow.largest_divergence() / 0.3);
    }
    let account = flow.account();
    let height = centroid(&flow.points())[1] / before;
    Ok([least, most, divergence, account.unexplained / account.energy_scale, height])
}

/// Ratios of the amplitude of a capillary wave in deep liquid to that at the start, at w0 t = pi, 2 pi, 4 pi, 6 pi; `damping` is nu k^2 / w0, and
/// `cells` are on half of a wave.
pub fn capillary_wave(
    scheme: Scheme,
    cells: usize,
    damping: f64,
    periodic: bool,
) -> Result<[f64; 4], StepError> {
    let (h, amp) = (1.0 / cells as f64, 0.02);
    let options = options(scheme, h);
    let options = if periodic { options.periodic(0, 2 * cells).unwrap() } else { options };
    let mut flow = Flow::new(options);
    let mut seeds = box_of_particles([0.0; 2], [if periodic { 2.0 } else { 1.0 }, 1.5], h, 2);
    if periodic {
        flow.add_wall(Wall::solid(HalfSpace::new([0.0; 2], [0.0, 1.0]).unwrap())).unwrap();
    } else {
        flow.add_wall(Wall::container(Cuboid::new([0.0; 2], [1.0, 3.0]).unwrap())).unwrap();
    }
    for (x, volume) in seeds.positions.iter_mut().zip(&mut seeds.volumes) {
        let stretch = 1.0 + amp / 1.5 * (PI * x[0]).cos();
        (x[1], *volume) = (x[1] * stretch, *volume * stretch);
    }
    // w0 = 1 at k = pi.
    let fluid = Fluid::new(1.0).unwrap().with_surface_tension(PI.powi(-3)).unwrap();
    let fluid = fluid.with_viscosity(damping / (PI * PI)).unwrap();
    flow.add_fluid("liquid", fluid, &seeds, |_| [0.0; 2]).unwrap();
    flow.set_watch(Watch::off());
    let at =
        |flow: &Flow<2>| flow.points().iter().map(|p| p.volume * (PI * p.position[0]).cos()).sum::<f64>();
    let first = at(&flow);
    let mut found = [0.0; 4];
    for (found, periods) in found.iter_mut().zip([0.5, 1.0, 2.0, 3.0]) {
        flow.run_until(2.0 * PI * periods)?;
        *found = at(&flow) / first;
    }
    Ok(found)
}

/// Dam of the depth 1 with `cells` cells that breaks onto liquid of the depth 0.1, at `end` sqrt(H / g): mean depth behind the bore, and speed of the
/// bore over sqrt(g H), where the depth is the mean of both sides.
pub fn wet_bed(scheme: Scheme, cells: usize, end: f64) -> Result<[f64; 2], StepError> {
    const LEFT: f64 = 20.0;
    const RIGHT: f64 = 26.0;
    const COLUMN: f64 = 0.25;
    let h = 1.0 / cells as f64;
    let mut flow = Flow::new(options(scheme, h));
    flow.add_wall(Wall::container(Cuboid::new([-LEFT, 0.0], [RIGHT, 3.0]).unwrap())).unwrap();
    let fluid = Fluid::new(1000.0).unwrap();
    for (name, low, high) in [("dam", -LEFT, [0.0, 1.0]), ("bed", 0.0, [RIGHT, 0.1])] {
        let seeds = box_of_particles([low, 0.0], high, h, 2);
        flow.add_fluid(name, fluid, &seeds, |_| [0.0; 2]).unwrap();
    }
    flow.set_body_force(|_| [0.0, -1.0]);
    flow.run_until(end)?;
    let mut depths = vec![0.0; ((LEFT + RIGHT) / COLUMN) as usize];
    for p in flow.points() {
        depths[((p.position[0] + LEFT) / COLUMN) as usize] += p.volume / COLUMN;
    }
    let of = |x: f64| ((x + LEFT) / COLUMN) as usize;
    let behind = &depths[of(0.25 * end)..of(0.83 * end)];
    let mean = behind.iter().sum::<f64>() / behind.len() as f64;
    let bore = (0..depths.len()).rev().find(|n| depths[*n] > 0.25).map_or(f64::NAN, |n| {
        let share = (depths[n] - 0.25) / (depths[n] - depths[n + 1]);
        (n as f64 + 0.5 + share) * COLUMN - LEFT
    });
    Ok([mean, bore / end])
}
