//! Liquids: walls of images, weight at rest, waves, viscous flow, splashes.

use std::f64::consts::PI;
use std::sync::Arc;

use impactite_scene::{
    Axisymmetric, Boundary, BoundaryEntry, Embedding, FullSpace, PlaneStrain, Side, Solver,
};
use impactite_simd::Team;
use mpm_materials::{Constitutive as _, Fluid, Newtonian, Tait};
use sph::{Composition, Kernel, Method, Sph, WendlandC2};

use crate::common::{block, noise};

const GRAVITY: f64 = 9.81;
const DENSITY: f64 = 1000.0;

type Water = Fluid<Tait<f64>>;

fn water(sound: f64) -> Water {
    Fluid::new(Tait::new(DENSITY, sound).unwrap())
}

/// Volume ratio at a pressure, Pa.
fn ratio(pressure: f64, sound: f64) -> f64 {
    (1.0 + 7.0 * pressure / (DENSITY * sound * sound)).powf(-1.0 / 7.0)
}

fn wall<const D: usize>(axis: usize, at: f64, side: Side) -> Boundary<D> {
    Boundary::Wall { axis, at, side, velocity: 0.0 }
}

/// Water of depth `deep` in a tank of width `wide`, in its hydrostatic pressure.
fn at_rest<const D: usize, E: Embedding<D> + std::fmt::Debug>(
    space: E,
    (wide, deep, h, sound): (f64, f64, f64, f64),
) -> Sph<D, impl Composition<D>> {
    let mut size = [wide; D];
    size[if D == 3 { 2 } else { 1 }] = deep;
    let up = if D == 3 { 2 } else { 1 };
    let layout = block([0.0; D], size, h, false);
    let mut body = Sph::new(Method::liquid(space), water(sound), &layout, |_| [0.0; D]).unwrap();
    for axis in (0..D).filter(|axis| *axis != up) {
        body.bound(wall(axis, 0.0, Side::Above)).unwrap();
        body.bound(wall(axis, wide, Side::Below)).unwrap();
    }
    body.bound(BoundaryEntry::from(wall(up, 0.0, Side::Above)).with_account(0).unwrap()).unwrap();
    body.set_body_force(Arc::new(move |_| std::array::from_fn(|d| if d == up { -GRAVITY } else { 0.0 })));
    body.set_states::<Water>(|x, mut state| {
        state.volume_ratio = ratio(DENSITY * GRAVITY * (deep - x[up]), sound);
        state
    })
    .unwrap();
    body
}

/// Largest speed over sqrt(g H), root mean square of the pressure error over rho g H, relative error of the force on the floor in the mean
/// over the second half of `end` seconds, and relative error of the energy balance.
fn unrest<const D: usize, M: Composition<D>>(body: &mut Sph<D, M>, deep: f64, end: f64) -> [f64; 4] {
    let up = if D == 3 { 2 } else { 1 };
    let before = body.account();
    body.run_until(0.5 * end).unwrap();
    let half = body.exchange().accounts[0].impulse[up];
    body.run_until(end).unwrap();
    let force = (body.exchange().accounts[0].impulse[up] - half) / (0.5 * end);
    let (mut fastest, mut squares, mut mass) = (0.0f64, 0.0, 0.0);
    let count = body.positions().len();
    for (i, x) in body.positions().iter().enumerate() {
        let state = body.particle_state(i).unwrap();
        let stress = body.material().describe_point(&state).unwrap().stress;
        let pressure = -(stress[0] + stress[1] + stress[2]) / 3.0;
        squares += (pressure - DENSITY * GRAVITY * (deep - x[up])).powi(2);
        fastest = fastest.max(body.velocity(i).iter().map(|v| v * v).sum::<f64>().sqrt());
        mass += body.mass(i);
    }
    let noise = (squares / count as f64).sqrt() / (DENSITY * GRAVITY * deep);
    let after = body.account();
    let unexplained = (after.unexplained - before.unexplained) / (mass * GRAVITY * 0.5 * deep);
    [fastest / (GRAVITY * deep).sqrt(), noise, force / (mass * GRAVITY) - 1.0, unexplained]
}

#[test]
fn water_stays_at_rest_in_a_tank() {
    // Two seconds are nine times sqrt(H / g); the waves of the liquid cross it 100 times.
    let mut plane = at_rest(PlaneStrain, (1.0, 0.5, 0.02, 25.0));
    let mut space = at_rest(FullSpace, (0.3, 0.3, 0.03, 20.0));
    for (name, [speed, noise, force, energy]) in
        [("plane", unrest(&mut plane, 0.5, 2.0)), ("space", unrest(&mut space, 0.3, 1.0))]
    {
        println!("{name}: speed {speed:.1e}, pressure {noise:.1e}, force {force:.1e}, energy {energy:.1e}");
        assert!(speed < 2e-3, "{name}: {speed} sqrt(g H)");
        assert!(noise < 1e-2, "{name}: {noise} rho g H");
        assert!(force.abs() < 2e-3, "{name}: force on the floor {force}");
        assert!(energy.abs() < 1e-3, "{name}: energy {energy}");
    }
}

/// Accelerations of particles at rest by every pair of particles and images at walls below x_d = 0, by the formulas of the book: scaled
/// gradients of the pressures, and the weight of the liquid between particles and images.
fn plain<const D: usize, M: Composition<D>>(
    body: &Sph<D, M>,
    kernel: &impl Kernel,
    gravity: [f64; D],
) -> Vec<[f64; D]> {
    let count = body.positions().len();
    let h = kernel.ratio();
    let scale = {
        let reach = -4..=4i32;
        let deep = if D == 3 { -4..=4i32 } else { 0..=0 };
        let mut sum = 0.0;
        for (x, y) in reach.clone().flat_map(|x| reach.clone().map(move |y| (x, y))) {
            for z in deep.clone() {
                let r = f64::from(x * x + y * y + z * z).sqrt();
                if r > 0.0 && r < 2.0 * h {
                    sum -= kernel.slope(r / h) * r * r;
                }
            }
        }
        D as f64 / (sum * kernel.norm(D) / h.powi(D as i32 + 2))
    };
    let of = |i: usize| body.material().describe_point(&body.particle_state(i).unwrap()).unwrap();
    let volume = |i: usize| of(i).volume_ratio * body.mass(i) / DENSITY;
    let pressure = |i: usize| -of(i).stress[0];
    let sums = |i: usize| {
        let x = body.positions()[i];
        let mut force = [0.0; D];
        for j in 0..count {
            for images in 0..1usize << D {
                let y: [f64; D] = std::array::from_fn(|d| {
                    let y = body.positions()[j][d];
                    if images >> d & 1 == 1 { -y } else { y }
                });
                let r = (0..D).map(|d| (y[d] - x[d]).powi(2)).sum::<f64>().sqrt();
                if r == 0.0 || r >= 2.0 * h {
                    continue;
                }
                let slope = -kernel.norm(D) * kernel.slope(r / h) / h.powi(D as i32 + 2);
                let weight: f64 = (0..D).map(|d| gravity[d] * (y[d] - body.positions()[j][d])).sum();
                let push = pressure(i) + pressure(j) + body.mass(j) / volume(j) * weight;
                let size = scale * volume(i) * volume(j) * slope * push / body.mass(i);
                (0..D).for_each(|d| force[d] -= size * (y[d] - x[d]));
            }
        }
        force
    };
    (0..count).map(sums).collect()
}

fn forces_are_the_plain_sums<const D: usize, E: Embedding<D> + std::fmt::Debug>(space: E) {
    let mut layout = block([0.0; D], [6.0; D], 1.0, false);
    for (n, x) in layout.positions.iter_mut().enumerate() {
        let shift = noise(*x, n as f64);
        (0..D).for_each(|d| x[d] += 0.15 * shift[d]);
    }
    let mut body = Sph::new(Method::liquid(space), water(10.0), &layout, |_| [0.0; D]).unwrap();
    let gravity: [f64; D] = std::array::from_fn(|d| -1.0 - d as f64);
    (0..D).for_each(|axis| body.bound(wall(axis, 0.0, Side::Above)).unwrap());
    body.set_body_force(Arc::new(move |_| gravity));
    body.set_states::<Water>(|x, mut state| {
        state.volume_ratio = 1.0 - 0.01 * (1.0 + noise(x, 3.0)[0]);
        state
    })
    .unwrap();
    let wanted = plain(&body, &WendlandC2::WIDE, gravity);
    let largest = wanted.iter().flatten().fold(0.0f64, |most, a| most.max(a.abs()));
    for (i, wanted) in wanted.iter().enumerate() {
        for d in 0..D {
            let off = (body.acceleration(i)[d] - wanted[d]).abs() / largest;
            assert!(off < 1e-12, "particle {i}, axis {d}: {off:e}");
        }
    }
}

#[test]
fn forces_of_particles_and_images_are_the_plain_sums() {
    forces_are_the_plain_sums::<2, _>(PlaneStrain);
    forces_are_the_plain_sums::<3, _>(FullSpace);
}

/// Particles of a box whose surface is at depth + surface(x), at rest.
fn tank(
    (length, depth, h, sound): (f64, f64, f64, f64),
    left: impl Into<BoundaryEntry<2>>,
    surface: impl Fn(f64) -> f64,
) -> Sph<2, impl Composition<2>> {
    let mut layout = block([0.0; 2], [length, depth], h, false);
    for (x, volume) in layout.positions.iter_mut().zip(&mut layout.volumes) {
        let stretch = 1.0 + surface(x[0]) / depth;
        (x[1], *volume) = (x[1] * stretch, *volume * stretch);
    }
    let mut body = Sph::new(Method::liquid(PlaneStrain), water(sound), &layout, |_| [0.0; 2]).unwrap();
    body.bound(left).unwrap();
    body.bound(wall(0, length, Side::Below)).unwrap();
    body.bound(wall(1, 0.0, Side::Above)).unwrap();
    body.set_body_force(Arc::new(|_| [0.0, -GRAVITY]));
    body.set_states::<Water>(|x, mut state| {
        let top = depth + surface(x[0]);
        state.volume_ratio = ratio(DENSITY * GRAVITY * (top - x[1]), sound);
        state
    })
    .unwrap();
    body
}

fn centre<M: Composition<2>>(body: &Sph<2, M>) -> [f64; 2] {
    let mass: f64 = (0..body.positions().len()).map(|i| body.mass(i)).sum();
    let mut sum = [0.0; 2];
    for (i, x) in body.positions().iter().enumerate() {
        (0..2).for_each(|d| sum[d] += body.mass(i) * x[d] / mass);
    }
    sum
}

#[test]
fn a_standing_wave_has_its_period() {
    // T = 2 pi / sqrt(g k tanh(k H)), k = pi / L.
    const EXACT: f64 = 1.181_816;
    let mut body = tank((1.0, 0.5, 0.0125, 25.0), wall(0, 0.0, Side::Above), |x| 0.02 * (PI * x).cos());
    let start = centre(&body);
    let (mut crossings, mut last, mut peak) = (Vec::new(), (0.0, start[0] - 0.5), 0.0f64);
    let end = 2.1 * EXACT;
    while body.time() < end {
        body.step_at_most(end - body.time()).unwrap();
        let now = (body.time(), centre(&body)[0] - 0.5);
        if now.1 * last.1 < 0.0 {
            crossings.push(last.0 + (now.0 - last.0) * last.1 / (last.1 - now.1));
        }
        if now.0 > 1.9 * EXACT {
            peak = peak.max(now.1.abs());
        }
        last = now;
    }
    let count = crossings.len() - 1;
    let period = 2.0 * (crossings[count] - crossings[0]) / count as f64;
    let kept = peak / (start[0] - 0.5).abs();
    let sunk = centre(&body)[1] / start[1] - 1.0;
    println!(
        "period {:+.2e}, amplitude {kept:.3} after two periods, height {sunk:+.1e}",
        period / EXACT - 1.0
    );
    assert!((period / EXACT - 1.0).abs() < 0.01, "{period} for {EXACT} s");
    assert!((0.85..1.02).contains(&kept), "amplitude {kept}");
    assert!(sunk.abs() < 2e-3, "height {sunk}");
}

#[test]
fn a_flow_between_fixed_planes_starts_as_it_must() {
    // u / u_max = 1 - sum_odd 32 / (n pi)^3 (-1)^((n-1)/2) exp(-n^2 pi^2 nu t / H^2) in the middle, u_max = g H^2 / (8 nu).
    let exact = |t: f64| {
        let term = |n: f64, sign: f64| sign * 32.0 / (n * PI).powi(3) * (-n * n * PI * PI * t).exp();
        1.0 - (0..20).map(|m| term(f64::from(2 * m + 1), if m % 2 == 0 { 1.0 } else { -1.0 })).sum::<f64>()
    };
    for (axis, rows, tolerance) in [(0, 12, 0.02), (1, 24, 0.006)] {
        let h = 1.0 / f64::from(rows);
        let mut size = [1.0; 2];
        size[axis] = 12.0 * h;
        let layout = block([0.0; 2], size, h, false);
        let law = water(10.0).with_shear_viscosity(Newtonian::new(10.0).unwrap()).compiled();
        let mut body = Sph::new(Method::liquid(PlaneStrain), law, &layout, |_| [0.0; 2]).unwrap();
        body.bound(Boundary::Periodic { axis, low: 0.0, high: size[axis] }).unwrap();
        body.bound(Boundary::Fixed { axis: 1 - axis, at: 0.0, side: Side::Above }).unwrap();
        let lid = Boundary::Fixed { axis: 1 - axis, at: 1.0, side: Side::Below };
        body.bound(BoundaryEntry::from(lid).with_account(0).unwrap()).unwrap();
        body.set_body_force(Arc::new(move |_| std::array::from_fn(|d| if d == axis { 0.08 } else { 0.0 })));
        for t in [5.0, 10.0, 20.0] {
            body.run_until(t).unwrap();
            let fastest = (0..body.positions().len()).map(|i| body.velocity(i)[axis]).fold(0.0, f64::max);
            let off = fastest / exact(0.01 * t) - 1.0;
            println!("{rows} rows along axis {axis}, nu t / H^2 = {:.2}: {off:+.4}", 0.01 * t);
            assert!(off.abs() < tolerance, "{rows} rows at {t} s: {fastest}");
        }
        // Pressures and shear stresses at the plates do the work of their forces.
        let account = body.account();
        assert!(account.unexplained.abs() < 1e-3 * account.work, "{account:?}");
        assert!(body.positions().iter().all(|x| (0.0..=size[axis]).contains(&x[axis])));
        // Both plates take the weight that has not become momentum: each of them half.
        let momentum: f64 = (0..body.positions().len()).map(|i| body.mass(i) * body.velocity(i)[axis]).sum();
        let given = body.exchange().load[axis] + body.exchange().impulse[axis];
        assert!((momentum - given).abs() < 1e-9 * body.exchange().load[axis], "{momentum} and {given}");
        let share = body.exchange().accounts[0].impulse[axis] / body.exchange().impulse[axis];
        assert!((share - 0.5).abs() < 0.01, "share of one plate {share}");
    }
}

#[test]
fn a_wall_that_moves_lifts_the_liquid_by_its_work() {
    let build = |threads: usize| {
        let path = Arc::new(|t: f64| 0.05 * (1.0 - (PI * t.min(2.0) / 2.0).cos()));
        let piston = BoundaryEntry::from(wall(0, 0.0, Side::Above)).with_position(path).unwrap();
        let mut body = tank((0.5, 0.2, 0.0125, 20.0), piston.with_account(0).unwrap(), |_| 0.0);
        body.set_team(Team::new(threads).unwrap());
        body
    };
    let mut body = build(1);
    let start = centre(&body);
    body.run_until(1.0).unwrap();
    // A checkpoint, resumed with other threads, has the bits of the run.
    let path = std::env::temp_dir().join(format!("liquid-{}.cp", std::process::id()));
    body.save(&path).unwrap();
    let mut resumed = build(2);
    resumed.resume(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    body.run_until(2.5).unwrap();
    resumed.run_until(2.5).unwrap();
    assert_eq!(body.positions(), resumed.positions());
    let mass: f64 = (0..body.positions().len()).map(|i| body.mass(i)).sum();
    let lifted = mass * GRAVITY * (centre(&body)[1] - start[1]);
    let work = body.exchange().accounts[0].work;
    let account = body.account();
    println!(
        "level {:.4}, work over weight {:.4}, unexplained {:.1e}",
        centre(&body)[1],
        work / lifted,
        account.unexplained / lifted
    );
    assert!((centre(&body)[1] / 0.125 - 1.0).abs() < 0.01);
    assert!((work / lifted - 1.0).abs() < 0.05, "{work} for {lifted} J");
    assert!(account.unexplained.abs() < 1e-3 * lifted, "{} J", account.unexplained);
}

#[test]
fn a_dam_break_hits_the_far_wall_without_gaining_energy() {
    let layout = block([0.0; 2], [1.0, 0.5], 0.02, false);
    let mut body = Sph::new(Method::liquid(PlaneStrain), water(45.0), &layout, |_| [0.0; 2]).unwrap();
    body.bound(wall(0, 0.0, Side::Above)).unwrap();
    body.bound(wall(0, 3.0, Side::Below)).unwrap();
    body.bound(wall(1, 0.0, Side::Above)).unwrap();
    body.set_body_force(Arc::new(|_| [0.0, -GRAVITY]));
    let mass: f64 = (0..body.positions().len()).map(|i| body.mass(i)).sum();
    let energy = |body: &Sph<2, _>| {
        let totals = body.totals();
        totals.kinetic + totals.internal + mass * GRAVITY * centre(body)[1]
    };
    let mut last = energy(&body);
    for n in 1..=15 {
        body.run_until(0.1 * f64::from(n)).unwrap();
        let now = energy(&body);
        assert!(now < last + 2e-3 * mass * GRAVITY * 0.25, "at {} s: {last} to {now} J", body.time());
        last = now;
    }
    // Incompressible flow on the same cells is at 1.801 m.
    let across = centre(&body)[0];
    println!("centre of mass {across:.4} m, energy {last:.1} J");
    assert!((across / 1.801 - 1.0).abs() < 0.03, "{across}");
}

#[test]
fn conditions_that_a_liquid_has_not_are_refused() {
    let layout = block([0.0; 2], [1.0, 1.0], 0.2, false);
    let made = || Sph::new(Method::liquid(PlaneStrain), water(10.0), &layout, |_| [0.0; 2]).unwrap();
    let said = |boundary: Boundary<2>| made().bound(boundary).unwrap_err().to_string();
    assert!(said(Boundary::Periodic { axis: 0, low: 0.0, high: 1.0 }).contains("eight spacings"));
    assert!(said(wall(0, 0.5, Side::Above)).contains("in front of the walls"));
    // Particles of 0.2 m reach 0.62 m.
    let thin = block([0.0; 2], [0.4, 1.0], 0.2, false);
    let mut narrow = Sph::new(Method::liquid(PlaneStrain), water(10.0), &thin, |_| [0.0; 2]).unwrap();
    narrow.bound(wall(0, 0.0, Side::Above)).unwrap();
    let gap = narrow.bound(wall(0, 0.4, Side::Below)).unwrap_err().to_string();
    assert!(gap.contains("a quarter of it"), "{gap}");
    // A press that closes stops the run before that.
    let wide = block([0.0; 2], [1.0, 1.0], 0.2, false);
    let mut pressed = Sph::new(Method::liquid(PlaneStrain), water(10.0), &wide, |_| [0.0; 2]).unwrap();
    pressed.bound(Boundary::Wall { axis: 0, at: 0.0, side: Side::Above, velocity: 1.0 }).unwrap();
    pressed.bound(wall(0, 1.0, Side::Below)).unwrap();
    let stopped = pressed.run_until(1.0).unwrap_err();
    assert!(
        (0.3..0.4).contains(&stopped.time) && stopped.to_string().contains("a quarter of it"),
        "{stopped}"
    );
    let round = block([0.0; 2], [1.0, 1.0], 0.1, true);
    let error = Sph::new(Method::liquid(Axisymmetric), water(10.0), &round, |_| [0.0; 2]).err().unwrap();
    assert!(error.to_string().contains("axisymmetric"), "{error}");
}
