//! Cells of several sizes: motion across borders, waves that meet a border, planes and walls, bits.

use super::*;
use impactite_simd::Team;
use mpm_core::geometry::Ball;
use mpm_core::{Apic, Criterion, Flip, NearContact, StateAbove, WithBody};
use mpm_core::{DenseGrid, Linear, Method, Musl, PlaneStrain, QuadraticBSpline, Refinement, Usl};

/// Edge of the largest cells, m.
const H: f64 = 0.1;

/// Opposite corners of a region, m, and number of halvings of its cells.
type Region = ([f64; 2], [f64; 2], usize);

fn scene(regions: &[Region]) -> Mpm<2> {
    let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(Lattice::new([0.0; 2], H).unwrap()));
    let refine = |&(low, high, halvings): &Region| Refinement::new(Cuboid::new(low, high).unwrap(), halvings);
    if !regions.is_empty() {
        mpm.refine(&regions.iter().map(refine).collect::<Vec<_>>()).unwrap();
    }
    mpm
}

fn fill_box(mpm: &Mpm<2>, low: [f64; 2], high: [f64; 2]) -> Seeds<2> {
    mpm.fill(&Cuboid::new(low, high).unwrap(), 2, &Filling::new()).unwrap()
}

/// A block that flies through regions of cells of a half and of a quarter keeps its velocity, without any stress.
#[test]
fn a_block_flies_through_borders() {
    let mut mpm = scene(&[([0.9, -0.2], [1.5, 0.5], 2), ([2.0, 0.3], [2.6, 2.0], 1)]);
    assert_eq!(mpm.cell_sizes(), [H, H / 2.0, H / 4.0]);
    let seeds = fill_box(&mpm, [0.0, 0.0], [0.8, 0.7]);
    mpm.add("block", law(), &seeds, |_| [1.0, 0.13]).unwrap();
    let before = mpm.bodies()[0].totals();
    assert!((before.mass - 0.56 * DENSITY).abs() < 1e-10 * DENSITY);
    mpm.run_until(3.0).unwrap();
    let after = mpm.bodies()[0].totals();
    assert!(after.particles > 2 * before.particles, "{} particles of {}", after.particles, before.particles);
    for (now, then) in [(after.mass, before.mass), (after.kinetic, before.kinetic)] {
        assert!((now / then - 1.0).abs() < 1e-12, "{now} for {then}");
    }
    mpm.bodies()[0].for_each(&mut |p| {
        assert!((p.velocity[0] - 1.0).abs().max((p.velocity[1] - 0.13).abs()) < 1e-12, "{:?}", p.velocity);
        assert!(p.stress.iter().all(|s| s.abs() < 1e-9 * YOUNG), "{:?}", p.stress);
    });
    let mut numbers = Vec::new();
    mpm.bodies()[0].for_each(&mut |p| numbers.push(p.number));
    let all = numbers.len();
    numbers.sort_unstable();
    numbers.dedup();
    assert_eq!(numbers.len(), all, "a number for each particle");
}

/// A disc that spins across a border keeps its angular momentum and its energy as well as one on equal cells.
#[test]
fn a_disc_spins_across_a_border() {
    let mut mpm = scene(&[([0.0, -1.0], [1.0, 1.0], 1)]);
    let seeds = mpm.fill(&Ball::new([0.0; 2], 1.0).unwrap(), 2, &Filling::new()).unwrap();
    mpm.add("disc", law(), &seeds, |x| [-0.2 * x[1], 0.2 * x[0]]).unwrap();
    let before = mpm.bodies()[0].totals();
    mpm.run_until(2.0 * std::f64::consts::PI / 0.2 / 4.0).unwrap();
    let after = mpm.bodies()[0].totals();
    let kept = after.angular_momentum[2] / before.angular_momentum[2] - 1.0;
    let energy = (after.kinetic + after.internal) / (before.kinetic + before.internal) - 1.0;
    assert!(kept.abs() < 1e-3 && energy.abs() < 5e-3, "angular momentum {kept:e}, energy {energy:e}");
    for d in 0..2 {
        assert!((after.momentum[d] - before.momentum[d]).abs() < 1e-12 * before.momentum_scale);
    }
}

/// Return the energy of waves between a packet of waves of `cells` of the larger cells, which goes to the left, and the place
/// of a border that its mirror image has met, over the energy of the packet.
fn behind(cells: f64, border: bool) -> f64 {
    let (length, c) = (cells * H, longitudinal());
    let (from, width) = (8.0 * length, 3.0 * length);
    let (left, right) = ((33.0 * cells).round() * H, (17.0 * cells).round() * H);
    let region = ([0.0, -1.0], [right + 1.0, 2.0], 1);
    let mut mpm = scene(if border { std::slice::from_ref(&region) } else { &[] });
    for (at, side) in [(0.0, Side::Above), (4.0 * H, Side::Below)] {
        mpm.bound(Boundary::Symmetry { axis: 1, at, side }).unwrap();
    }
    let seeds = fill_box(&mpm, [-left, 0.0], [right, 4.0 * H]);
    let k = 2.0 * std::f64::consts::PI / length;
    let shape = move |x: f64| 1e-5 * c * (-((x + from) / width).powi(2)).exp() * (k * (x + from)).cos();
    mpm.add("bar", law(), &seeds, move |x| [shape(x[0]), 0.0]).unwrap();
    mpm.run_until(2.1 * from / c).unwrap();
    let (mut back, mut away) = (0.0, 0.0);
    mpm.bodies()[0].for_each(&mut |p| {
        let energy = p.mass * p.velocity[0].powi(2);
        if p.position[0] < -2.0 * from {
            away += energy;
        } else if p.position[0] < -0.2 * from {
            back += energy;
        }
    });
    back / away
}

/// Waves of 8, 10 and 16 larger cells are reflected by no more than a single frequency is by the truncated basis with lumped
/// masses: 4.3, 2.32 and 0.78 % of the amplitude. The packet leaves slower waves behind, without a border, too.
#[test]
fn borders_reflect_little() {
    for (cells, due) in [(8.0, 0.043), (10.0, 0.0232), (16.0, 0.0078)] {
        let found = (behind(cells, true) - behind(cells, false)).abs().sqrt();
        assert!(found < due, "{cells} cells: {found}");
        assert!(found > 0.1 * due, "{cells} cells: {found}, as if there were no border");
    }
}

/// A bar of refined and unrefined cells between planes of symmetry hits a wall.
fn impact(threads: usize) -> Mpm<2> {
    let mut mpm = scene(&[([-0.1, -0.2], [0.5, 0.4], 2)]);
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
    mpm.set_team(Team::new(threads).unwrap());
    let seeds = fill_box(&mpm, [0.0, 0.0], [1.0, 2.0]);
    mpm.add("bar", law(), &seeds, |_| [0.0, -3.0]).unwrap();
    mpm
}

#[test]
fn threads_and_checkpoints_change_no_bit_of_levels() {
    let mut plain = impact(1);
    plain.run_until(0.05).unwrap();
    assert!(plain.bodies()[0].totals().particles > fill_box(&impact(1), [0.0, 0.0], [1.0, 2.0]).len());
    for threads in 2..=4 {
        let mut other = impact(threads);
        other.run_until(0.05).unwrap();
        assert!(bits(&plain) == bits(&other), "{threads} threads");
        assert_eq!(plain.exchange(), other.exchange(), "{threads} threads");
    }
    let file = std::env::temp_dir().join(format!("impactite-levels-{}", std::process::id()));
    let mut saved = impact(2);
    while saved.time() < 0.02 {
        saved.step_towards(0.05).unwrap();
    }
    saved.save(&file).unwrap();
    let mut resumed = impact(3).resumed(&file).unwrap();
    let other = scene(&[([-0.1, -0.2], [0.5, 0.4], 1)]);
    let refused = other.resumed(&file).map(|_| ()).unwrap_err().to_string();
    std::fs::remove_file(&file).unwrap();
    resumed.run_until(0.05).unwrap();
    assert!(bits(&plain) == bits(&resumed), "resumed");
    assert!(refused.contains("cells of"), "{refused}");
}

/// A bar that bounces off a wall in smaller cells between planes of symmetry is mirrored exactly: momentum across the planes
/// is that of their impulses, and the energy is that of the uniform grid.
#[test]
fn walls_and_planes_act_on_smaller_cells() {
    let energy = |mut mpm: Mpm<2>| {
        mpm.run_until(0.1).unwrap();
        let totals = mpm.bodies()[0].totals();
        let given = mpm.exchange().impulse;
        let start = [0.0, -3.0 * totals.mass];
        for d in 0..2 {
            let found = (totals.momentum[d] - start[d] - given[d]).abs();
            assert!(found < 1e-9 * totals.mass, "axis {d}: {found:e}");
        }
        let mut lowest = f64::INFINITY;
        mpm.bodies()[0].for_each(&mut |p| {
            lowest = lowest.min(p.position[1] - p.half_edges[1][1]).min(p.position[0] - p.half_edges[0][0]);
        });
        assert!(lowest > -0.02 * H, "behind the wall by {lowest}");
        (totals.kinetic + totals.internal) / (4.5 * totals.mass)
    };
    let fine = energy(impact(1));
    let mut plain = scene(&[]);
    plain.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    plain.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
    let seeds = fill_box(&plain, [0.0, 0.0], [1.0, 2.0]);
    plain.add("bar", law(), &seeds, |_| [0.0, -3.0]).unwrap();
    let coarse = energy(plain);
    assert!((fine - coarse).abs() < 0.03 && fine > 0.9, "{fine} beside {coarse}");
}

/// A bar whose cells are halved near the wall, and where it is deformed, while it runs.
fn adaptive(threads: usize) -> Mpm<2> {
    let mut mpm = scene(&[]);
    let strained = StateAbove { state: "stress_xx".into(), least: 1e4 };
    mpm.refine_where(vec![Box::new(NearContact::default()), Box::new(strained)], 2).unwrap();
    mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
    mpm.set_team(Team::new(threads).unwrap());
    let seeds = fill_box(&mpm, [0.0, 0.3], [1.0, 2.0]);
    mpm.add("bar", law(), &seeds, |_| [0.0, -3.0]).unwrap();
    mpm
}

/// The bar gets its cells when it comes to the wall, and not before; mass and momentum are kept to rounding, and bits for any
/// number of threads and after a restart at any time.
#[test]
fn cells_become_smaller_near_a_wall() {
    let mut plain = adaptive(1);
    let before = plain.bodies()[0].totals();
    let mut sizes = vec![plain.cell_sizes().len()];
    let file = std::env::temp_dir().join(format!("impactite-adaptive-{}", std::process::id()));
    let end = 0.2;
    let mut restarts = Vec::new();
    while plain.time() < end {
        plain.step_towards(end).unwrap();
        sizes.push(plain.cell_sizes().len());
        if sizes[sizes.len() - 1] > sizes[sizes.len() - 2] {
            plain.save(&file).unwrap();
            restarts.push(adaptive(2).resumed(&file).unwrap());
        }
    }
    std::fs::remove_file(&file).unwrap();
    assert!(sizes[0] == 1 && sizes[sizes.len() - 1] == 3, "{sizes:?}");
    assert!(sizes.windows(2).all(|pair| pair[0] <= pair[1]));
    let after = plain.bodies()[0].totals();
    assert!(after.particles > 2 * before.particles);
    assert!((after.mass / before.mass - 1.0).abs() < 1e-13);
    let given = plain.exchange().impulse;
    for d in 0..2 {
        let found = (after.momentum[d] - before.momentum[d] - given[d]).abs();
        assert!(found < 1e-10 * before.momentum_scale, "axis {d}: {found:e}");
    }
    let energy = (after.kinetic + after.internal) / before.kinetic;
    assert!((0.9..1.005).contains(&energy), "{energy}");
    for mut resumed in restarts {
        resumed.run_until(end).unwrap();
        assert!(bits(&plain) == bits(&resumed), "resumed");
    }
    let mut other = adaptive(3);
    other.run_until(end).unwrap();
    assert!(bits(&plain) == bits(&other), "three threads");
    assert_eq!(plain.exchange(), other.exchange());
}

/// Velocity and energies of a block after its bounce off a wall, m/s and J/m.
fn bounced(mut mpm: Mpm<2>) -> [f64; 3] {
    mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
    let seeds = fill_box(&mpm, [0.0, 0.1], [0.8, 0.5]);
    mpm.add("block", law(), &seeds, |_| [0.3, -1.0]).unwrap();
    mpm.run_until(0.1 + 5.0 * 0.4 / longitudinal()).unwrap();
    let totals = mpm.bodies()[0].totals();
    [totals.momentum[1] / totals.mass, totals.kinetic, totals.internal]
}

/// A body that is refined as a whole has the surface of small cells: it bounces as on equal ones, whose nodes are at the same places.
#[test]
fn a_body_of_small_cells_alone_has_their_surface() {
    let mut adaptive = scene(&[]);
    adaptive.refine_where(vec![Box::new(NearContact::default())], 1).unwrap();
    let small = Lattice::new([-0.25 * H; 2], 0.5 * H).unwrap();
    let equal = bounced(Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(small)));
    let [coarse, found] = [scene(&[]), adaptive].map(bounced);
    assert!(equal[0] > 0.5, "{equal:?}");
    for (n, scale) in [equal[0], equal[1], equal[1]].into_iter().enumerate() {
        let [one, other] = [found[n], coarse[n]].map(|x| (x - equal[n]).abs() / scale);
        assert!(one < 0.005 && one < 0.3 * other, "{n}: {found:?} for {equal:?}, {coarse:?} on large cells");
    }
}

/// Return the error of the standing wave of a bar between planes of symmetry after 0.9 periods, over its amplitude, with `cells` on its
/// length, the middle third of them halved if asked.
fn standing_wave(cells: f64, halved: bool) -> f64 {
    let (length, c) = (12.0 * H, longitudinal());
    let h = length / cells;
    let lattice = Lattice::new([0.0; 2], h).unwrap();
    let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
    if halved {
        let middle = Cuboid::new([length / 3.0, -1.0], [2.0 * length / 3.0, 2.0]).unwrap();
        mpm.refine(&[Refinement::new(middle, 1)]).unwrap();
    }
    for (axis, at, side) in
        [(1, 0.0, Side::Above), (1, 4.0 * h, Side::Below), (0, 0.0, Side::Above), (0, length, Side::Below)]
    {
        mpm.bound(Boundary::Symmetry { axis, at, side }).unwrap();
    }
    let seeds = fill_box(&mpm, [0.0, 0.0], [length, 4.0 * h]);
    let (k, v) = (2.0 * std::f64::consts::PI / length, 1e-6 * c);
    mpm.add("bar", law(), &seeds, |x| [v * (k * x[0]).sin(), 0.0]).unwrap();
    let end = 0.9 * length / c;
    mpm.run_until(end).unwrap();
    let (mut error, mut mass) = (0.0, 0.0);
    mpm.bodies()[0].for_each(&mut |p| {
        let exact = v * (k * p.position[0]).sin() * (k * c * end).cos();
        error += p.mass * (p.velocity[0] - exact).powi(2);
        mass += 0.5 * p.mass * v * v;
    });
    (error / mass).sqrt()
}

/// Borders keep the order of convergence: the error stays in proportion to that of small cells everywhere.
#[test]
fn a_standing_wave_converges_across_borders() {
    for cells in [24.0, 48.0, 96.0] {
        let [large, halved, small] =
            [(cells, false), (cells, true), (2.0 * cells, false)].map(|(n, halved)| standing_wave(n, halved));
        assert!(halved < 1.6 * small && halved < large, "{cells}: {large:e}, {halved:e}, {small:e}");
    }
}

/// A criterion of one's own: cells to the right of a place.
struct Right(f64);
impl Criterion<f64, 2> for Right {
    fn mark(&self, view: &mpm_core::RegridView<'_, f64, 2>, marked: &mut [bool]) {
        for (block, marked) in view.blocks().iter().zip(marked) {
            *marked |= block.high[0] > self.0;
        }
    }
    fn describe(&self) -> String {
        format!("right of {}", self.0)
    }
}

#[test]
fn a_criterion_of_ones_own_marks_blocks() {
    let mut mpm = scene(&[]);
    mpm.refine_where(vec![Box::new(Right(1.3))], 1).unwrap();
    let seeds = fill_box(&mpm, [0.0, 0.0], [2.0, 0.4]);
    mpm.add("bar", law(), &seeds, |_| [0.1, 0.0]).unwrap();
    (0..3).for_each(|_| {
        mpm.step().unwrap();
    });
    // Blocks of cells end at 1.15 and 1.55 m.
    let mut wrong = 0;
    mpm.bodies()[0].for_each(&mut |p| {
        let small = p.half_edges[0][0] < 0.2 * H;
        wrong += usize::from(small != (p.position[0] > 1.15));
    });
    assert_eq!(wrong, 0);
}

/// Regions and criteria add up, in any order, each with its halvings.
#[test]
fn regions_and_criteria_add_up() {
    let region = |from: f64| Refinement::new(Cuboid::new([from, -0.2], [from + 0.4, 0.6]).unwrap(), 1);
    let mut mpm = scene(&[]);
    mpm.refine(&[region(0.0)]).unwrap();
    mpm.refine_where(vec![Box::new(Right(3.0))], 2).unwrap();
    mpm.refine(&[region(1.2)]).unwrap();
    let seeds = fill_box(&mpm, [0.0, 0.0], [4.0, 0.4]);
    mpm.add("bar", law(), &seeds, |_| [0.0, 0.0]).unwrap();
    (0..4).for_each(|_| {
        mpm.step().unwrap();
    });
    mpm.bodies()[0].for_each(&mut |p| {
        // Places within the blocks of each.
        let due = match p.position[0] {
            x if x < 0.7 || (1.2..1.9).contains(&x) => 0.5,
            x if (0.8..1.1).contains(&x) || (2.0..2.3).contains(&x) => 1.0,
            x if x > 3.2 => 0.25,
            _ => return,
        };
        let size = p.half_edges[0][0] / (0.25 * H);
        assert!((size - due).abs() < 0.02, "{size} at {:?}", p.position);
    });
}

/// A region follows the body that it moves with: the cells around a moving punch become smaller along its way, those elsewhere do not.
#[test]
fn a_region_moves_with_a_body() {
    let mut mpm = scene(&[]);
    let region = Cuboid::new([0.0, -0.3], [0.4, 0.9]).unwrap();
    mpm.refine_where(vec![Box::new(WithBody::new(region, "leader"))], 1).unwrap();
    let leader = fill_box(&mpm, [0.0, 2.0], [0.4, 2.4]);
    let bar = fill_box(&mpm, [0.0, 0.0], [4.0, 0.4]);
    mpm.add_together(|mpm| {
        mpm.add("leader", law(), &leader, |_| [10.0, 0.0])?;
        mpm.add("bar", law(), &bar, |_| [0.0, 0.0])
    })
    .unwrap();
    mpm.run_until(0.2).unwrap();
    let mut thin = scene(&[]);
    let sheet = Cuboid::new([0.0, 0.0], [4.0, 0.02]).unwrap();
    thin.refine_where(vec![Box::new(WithBody::new(sheet, "bar"))], 1).unwrap();
    let seeds = fill_box(&thin, [0.0, 0.0], [4.0, 0.4]);
    thin.add("bar", law(), &seeds, |_| [0.0, 0.0]).unwrap();
    assert!(thin.step().unwrap_err().to_string().contains("smaller than a ninth of four cells"));
    // The region has gone 2 m: from 0 to 2.4 m, and a block of 0.4 m at its front.
    let (mut small, mut large) = (Vec::new(), Vec::new());
    mpm.bodies()[1].for_each(&mut |p| {
        if p.half_edges[0][0] < 0.2 * H { small.push(p.position[0]) } else { large.push(p.position[0]) }
    });
    let far = small.iter().fold(0.0, |a: f64, x| a.max(*x));
    let near = large.iter().fold(4.0, |a: f64, x| a.min(*x));
    assert!((2.2..=2.9).contains(&far) && near >= 2.2, "{far}, {near}");
    assert!(mpm.bodies()[0].totals().particles == leader.len(), "the leader is outside of the region");
    let counts = mpm.points_by_cell();
    assert_eq!(counts.iter().map(|(_, n)| *n).collect::<Vec<_>>(), [large.len() + leader.len(), small.len()]);
}

/// A body that fills a region of smaller cells has their surface from the start.
#[test]
fn a_region_as_large_as_a_body_gives_it_small_cells_at_its_surface() {
    let region = ([0.0, -0.3], [0.8, 0.5], 1);
    let small = Lattice::new([-0.25 * H; 2], 0.5 * H).unwrap();
    let equal = bounced(Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(small)));
    let found = bounced(scene(&[region]));
    for (n, scale) in [equal[0], equal[1], equal[1]].into_iter().enumerate() {
        assert!((found[n] - equal[n]).abs() < 0.005 * scale, "{n}: {found:?} for {equal:?}");
    }
}

/// A traction on smaller particles, and on particles that are divided, is the same force.
#[test]
fn tractions_act_on_particles_of_any_size() {
    for (regions, flies) in
        [(&[][..], 0.0), (&[([1.6, -1.0], [3.0, 2.0], 2)], 0.0), (&[([2.4, -1.0], [3.2, 2.0], 1)], 4.0)]
    {
        let mut mpm = scene(regions);
        let seeds = fill_box(&mpm, [0.0, 0.0], [2.0, 0.8]);
        let finest = H * 0.5f64.powi(mpm.cell_sizes().len() as i32 - 1);
        let layer = if flies > 0.0 { 0.4 * H } else { 0.4 * finest };
        let traction = mpm_core::Traction {
            region: std::sync::Arc::new(Cuboid::new([2.0 - layer, -1.0], [2.1, 2.0]).unwrap()),
            axis: 0,
            history: std::sync::Arc::new(|_| [500.0, 0.0]),
            revolved: false,
        };
        let bar = mpm_core::Deformable::new("bar", law(), &seeds)
            .moving(move |_| [flies, 0.0])
            .with_traction(traction);
        mpm.add_body(bar).unwrap();
        let before = mpm.bodies()[0].totals();
        mpm.run_until(0.2).unwrap();
        let after = mpm.bodies()[0].totals();
        let gained = after.momentum[0] - before.momentum[0];
        assert!((gained / (500.0 * 0.8 * 0.2) - 1.0).abs() < 0.01, "{regions:?}: {gained}");
        assert_eq!(after.particles > before.particles, flies > 0.0);
    }
}

#[test]
fn what_levels_do_not_support_is_refused() {
    let region = || [Refinement::new(Cuboid::new([0.0; 2], [0.4; 2]).unwrap(), 1)];
    let lattice = Lattice::new([0.0; 2], H).unwrap();
    let refused = |error: mpm_core::SceneError, part: &str| {
        let text = error.to_string();
        assert!(text.contains(part), "{text}");
    };
    let mut flip =
        Mpm::new(Method::new(QuadraticBSpline, Flip, Usl, PlaneStrain).compiled(), BlockGrid::new(lattice));
    refused(flip.refine(&region()).unwrap_err(), "`Apic` or `Aflip`");
    let mut linear = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    refused(linear.refine(&region()).unwrap_err(), "`QuadraticBSpline`");
    let apic = || Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let mut dense = Mpm::new(apic(), DenseGrid::new(lattice, [0; 2], [20; 2]).unwrap());
    refused(dense.refine(&region()).unwrap_err(), "`BlockGrid`");
    let mut late = Mpm::new(apic(), BlockGrid::new(lattice));
    late.add("block", law(), &fill_box(&late, [0.0; 2], [0.4; 2]), |_| [0.0; 2]).unwrap();
    refused(late.refine(&region()).unwrap_err(), "before bodies");
    let mut mpm = Mpm::new(apic(), BlockGrid::new(lattice));
    for halvings in [0, 8] {
        let region = [Refinement::new(Cuboid::new([0.0; 2], [0.4; 2]).unwrap(), halvings)];
        refused(mpm.refine(&region).unwrap_err(), "from 1 to 7");
    }
    let half_space = mpm_core::geometry::HalfSpace::new([0.0; 2], [1.0, 0.0]).unwrap();
    refused(mpm.refine(&[Refinement::new(half_space, 1)]).unwrap_err(), "bounded");
    mpm.refine(&region()).unwrap();
    let periodic = Boundary::Periodic { axis: 0, low: 0.0, high: 16.0 * H };
    refused(mpm.bound(periodic).unwrap_err(), "periodic");
    let contact = || {
        mpm_core::GridContact::new(
            mpm_contact::SurfaceDistance::default(),
            mpm_contact::Pairs::new(mpm_contact::Frictionless),
        )
    };
    let mut rigid = Mpm::with_contact(apic(), BlockGrid::new(lattice), contact());
    rigid.refine(&region()).unwrap();
    let seeds = fill_box(&rigid, [0.0; 2], [0.4; 2]);
    let error = rigid.add_rigid("ram", &mpm_core::Rigid::free(1.0).unwrap(), &seeds).unwrap_err();
    refused(error, "`Mpm::refine_where`");
    let still = mpm_core::Twist { velocity: [0.0; 2], spin: [0.0; 3] };
    rigid.add_rigid("ram", &mpm_core::Rigid::prescribed(1.0, move |_| still).unwrap(), &seeds).unwrap();
    let unknown = StateAbove { state: "love".into(), least: 1.0 };
    let mut other = scene(&[]);
    other.refine_where(vec![Box::new(unknown)], 1).unwrap();
    other.add("block", law(), &fill_box(&other, [0.0; 2], [0.4; 2]), |_| [0.0; 2]).unwrap();
    let error = other.step().unwrap_err().to_string();
    assert!(error.contains("`love from 1`") && error.contains("state variable"), "{error}");
    let absorbing = Boundary::Absorbing {
        axis: 0,
        at: 0.0,
        side: Side::Above,
        longitudinal: longitudinal(),
        shear: shear(),
    };
    refused(mpm.bound(absorbing).unwrap_err(), "surface");
}
