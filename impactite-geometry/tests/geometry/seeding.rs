//! Seeding: positions, order, exact mass, partial volumes, axisymmetric measure.

use std::f64::consts::PI;

use impactite_geometry::*;
use nalgebra::Rotation2;
use proptest::prelude::*;

fn plain_sum(seeds: &Seeds<3>) -> f64 {
    seeds.volumes.iter().sum()
}

#[test]
fn a_block_on_the_lattice_is_filled_exactly() {
    let lattice = Lattice::new([0.1, -0.2, 0.3], 0.1).unwrap();
    let block = Cuboid::new([0.2, 0.0, 0.4], [0.4, 0.1, 0.7]).unwrap();
    let seeds = fill(&block, &lattice, 2, &Filling::new()).unwrap();
    assert_eq!(seeds.len(), 2 * 3 * 8);
    assert!((seeds.correction - 1.0).abs() < 1e-13);
    assert_eq!(seeds.half_size, [0.025; 3]);
    assert!((plain_sum(&seeds) / 0.006 - 1.0).abs() < 1e-13);
    // Order by cell and by part, the first axis slowest; positions are exact to the last bit.
    let mut n = 0;
    for cell in [[1, 2], [2, 2]].into_iter().flat_map(|[i, j]| (1..4).map(move |k| [i, j, k])) {
        for part in 0..8usize {
            let parts = [part >> 2 & 1, part >> 1 & 1, part & 1];
            for axis in 0..3 {
                let expected =
                    lattice.origin()[axis] + (f64::from(cell[axis]) + (parts[axis] as f64 + 0.5) / 2.0) * 0.1;
                assert_eq!(seeds.positions[n][axis], expected);
            }
            n += 1;
        }
    }
}

#[test]
fn the_aluminium_balls_have_552_particles() {
    // Diameter of ten spacings, centre on a corner of the particle cells, two particles per cell and axis.
    let lattice = Lattice::new([0.0; 3], 2.0).unwrap();
    let seeds = fill(&Sphere::new([5.0; 3], 5.0).unwrap(), &lattice, 2, &Filling::new()).unwrap();
    assert_eq!(seeds.len(), 552);
    assert_eq!(seeds.raw_measure, 552.0);
    assert!((seeds.correction - 4.0 / 3.0 * PI * 125.0 / 552.0).abs() < 1e-14);
    // The centroid coincides with that of the ball by symmetry.
    let c = seeds.centroid();
    assert!(c.iter().all(|x| (x - 5.0).abs() < 1e-13), "{c:?}");
}

#[test]
fn the_taylor_bar_is_given_its_exact_mass() {
    // R 3.8 mm, L 25.4 mm, particles of 0.38 mm.
    let bar = Cylinder::new([0.0; 3], [0.0, 0.0, 1.0], 25.4e-3, 3.8e-3).unwrap();
    let lattice = Lattice::new([0.0; 3], 0.76e-3).unwrap();
    let seeds = fill(&bar, &lattice, 2, &Filling::new()).unwrap();
    let exact = PI * 3.8e-3 * 3.8e-3 * 25.4e-3;
    assert!((plain_sum(&seeds) / exact - 1.0).abs() < 1e-12);
    assert!((seeds.measure() / exact - 1.0).abs() < 1e-14);
    assert_eq!(seeds.exact_measure, bar.measure());
    assert!((seeds.raw_measure * seeds.correction / exact - 1.0).abs() < 1e-14);
    assert!((seeds.correction - 1.0).abs() < 0.02);
    let raw = fill(&bar, &lattice, 2, &Filling::new().uncorrected()).unwrap();
    assert_eq!(raw.correction, 1.0);
    assert_eq!(raw.positions, seeds.positions);
    assert!(raw.volumes.iter().all(|v| (v / 0.38e-3f64.powi(3) - 1.0).abs() < 1e-14));
}

#[test]
fn an_unknown_measure_is_sampled() {
    let block = Cuboid::new([0.0; 3], [2.0; 3]).unwrap();
    let cutting = Sphere::new([2.0; 3], 0.9).unwrap();
    let exact = 8.0 - 4.0 / 3.0 * PI * 0.9f64.powi(3) / 8.0;
    let lattice = Lattice::new([0.0; 3], 0.13).unwrap();
    let seeds = fill(&block.minus(cutting), &lattice, 2, &Filling::new()).unwrap();
    assert_eq!(seeds.exact_measure, None);
    assert!((seeds.sampled_measure.unwrap() / exact - 1.0).abs() < 1e-5);
    assert!((plain_sum(&seeds) / seeds.sampled_measure.unwrap() - 1.0).abs() < 1e-12);
}

#[test]
fn axisymmetric_volumes_are_per_radian() {
    let (radius, length) = (0.3, 2.0);
    let cylinder = Cuboid::new([0.0, 1.0], [radius, 1.0 + length]).unwrap();
    let lattice = Lattice::new([0.0, 0.0], 0.1).unwrap();
    let seeds = fill(&cylinder, &lattice, 2, &Filling::new().axisymmetric()).unwrap();
    let exact = radius * radius * length / 2.0;
    assert_eq!(seeds.len(), 3 * 20 * 4);
    // On a matching lattice the sum of r A is exact without correction.
    assert!((seeds.correction - 1.0).abs() < 1e-13);
    assert!((seeds.volumes.iter().sum::<f64>() / exact - 1.0).abs() < 1e-12);
    for (x, v) in seeds.positions.iter().zip(&seeds.volumes) {
        assert!((v / (x[0] * 0.05 * 0.05) - 1.0).abs() < 1e-13);
    }
    // Sphere on the axis, on a lattice that also has cells at r < 0.
    let lattice = Lattice::new([-0.8, 0.03], 0.1).unwrap();
    let ball = Disc::new([0.0, 1.0], 0.55).unwrap();
    for filling in [Filling::new(), Filling::new().partial(8, 0.1)] {
        let seeds = fill(&ball, &lattice, 3, &filling.axisymmetric()).unwrap();
        assert!(seeds.positions.iter().all(|x| x[0] > 0.0));
        assert!((seeds.measure() / (2.0 / 3.0 * 0.55f64.powi(3)) - 1.0).abs() < 1e-12);
        assert!((seeds.correction - 1.0).abs() < 0.01, "{}", seeds.correction);
    }
    // A lattice that does not match the axis is an error only if the shape reaches the axis.
    let shifted = Lattice::new([0.03, 0.0], 0.1).unwrap();
    let refused = fill(&ball, &shifted, 2, &Filling::new().axisymmetric()).unwrap_err();
    assert!(matches!(refused, GeometryError::Parameter { field: "origin[0] of the lattice", .. }));
    let ring = Disc::new([1.0, 0.0], 0.3).unwrap();
    let seeds = fill(&ring, &shifted, 2, &Filling::new().axisymmetric()).unwrap();
    assert!((seeds.measure() / (PI * 0.09) - 1.0).abs() < 1e-12);
}

#[test]
fn partial_volumes_conserve_the_total() {
    let disc = Disc::new([0.31, 0.47], 0.2).unwrap();
    let lattice = Lattice::new([0.0; 2], 0.02).unwrap();
    let exact = disc.measure().unwrap();
    let centre = fill(&disc, &lattice, 2, &Filling::new().uncorrected()).unwrap();
    let all = fill(&disc, &lattice, 2, &Filling::new().partial(8, 0.0).uncorrected()).unwrap();
    let merged = fill(&disc, &lattice, 2, &Filling::new().partial(8, 0.2).uncorrected()).unwrap();
    // Partial volumes are far more accurate than whole particles.
    assert!((all.raw_measure / exact - 1.0).abs() < 1e-3, "{}", all.raw_measure / exact);
    assert!((centre.raw_measure / exact - 1.0).abs() > (all.raw_measure / exact - 1.0).abs());
    assert!(merged.len() < all.len());
    assert!((merged.measure() / all.measure() - 1.0).abs() < 1e-13);
    let whole = 1e-4;
    let least = merged.volumes.iter().copied().fold(f64::INFINITY, f64::min);
    let most = merged.volumes.iter().copied().fold(0.0, f64::max);
    assert!(least >= 0.2 * whole * (1.0 - 1e-12) && most < 1.6 * whole, "{least} {most}");
    for seeds in [&all, &merged] {
        let c = seeds.centroid();
        assert!((c[0] - 0.31).abs() < 1e-4 && (c[1] - 0.47).abs() < 1e-4, "{c:?}");
    }
    // Same check in 3D, with correction.
    let rod = OgiveRod::new([0.0; 3], [1.0, 0.3, 0.2], 0.2, 0.6, 3.0).unwrap();
    let lattice = Lattice::new([0.0; 3], 0.04).unwrap();
    let seeds = fill(&rod, &lattice, 2, &Filling::new().partial(4, 0.15)).unwrap();
    assert!((plain_sum(&seeds) / rod.measure().unwrap() - 1.0).abs() < 1e-12);
    assert!((seeds.correction - 1.0).abs() < 2e-3, "{}", seeds.correction);
    let c = rod.centroid().unwrap();
    assert!((0..3).all(|i| (seeds.centroid()[i] - c[i]).abs() < 2e-3));
}

#[test]
fn lonely_slivers_are_not_lost() {
    // A wire in the corner of one particle cell, and a remote block: the wire has no neighbour.
    let wire = Cuboid::new([0.0, 0.0], [0.01, 0.05]).unwrap();
    let block = Cuboid::new([0.5, 0.5], [0.6, 0.6]).unwrap();
    let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
    for filling in [Filling::new().partial(20, 0.3), Filling::new().partial(20, 0.3).uncorrected()] {
        let seeds = fill(&wire.or(block), &lattice, 2, &filling).unwrap();
        assert_eq!(seeds.len(), 4);
        assert!((seeds.measure() / 0.0105 - 1.0).abs() < 1e-12);
    }
}

#[test]
fn jitter_is_reproducible_and_bounded() {
    let block = Cuboid::new([0.0; 2], [1.0; 2]).unwrap();
    let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
    let regular = fill(&block, &lattice, 3, &Filling::new()).unwrap();
    let a = fill(&block, &lattice, 3, &Filling::new().jittered(7, 0.8)).unwrap();
    let b = fill(&block, &lattice, 3, &Filling::new().jittered(7, 0.8)).unwrap();
    let c = fill(&block, &lattice, 3, &Filling::new().jittered(8, 0.8)).unwrap();
    assert_eq!(a, b);
    assert_ne!(a.positions, c.positions);
    assert_eq!(a.len(), regular.len());
    let limit = 0.8 * a.half_size[0] * (1.0 + 1e-12);
    let (mut mean, mut square, mut mixed) = (0.0, 0.0, 0.0);
    for (x, y) in a.positions.iter().zip(&regular.positions) {
        let u = [(x[0] - y[0]) / limit, (x[1] - y[1]) / limit];
        assert!(u.iter().all(|c| c.abs() <= 1.0));
        mean += (u[0] + u[1]) / 1800.0;
        square += (u[0] * u[0] + u[1] * u[1]) / 1800.0;
        mixed += u[0] * u[1] / 900.0;
    }
    assert!(mean.abs() < 0.05 && (square - 1.0 / 3.0).abs() < 0.03 && mixed.abs() < 0.05);
    // Displacements do not depend on the shape: half of it gives the same ones.
    let half = Cuboid::new([0.5, 0.0], [1.0; 2]).unwrap();
    let h = fill(&half, &lattice, 3, &Filling::new().jittered(7, 0.8)).unwrap();
    assert_eq!(h.positions[..], a.positions[450..]);
}

#[test]
fn one_dimension_is_served() {
    let bar = Cuboid::new([0.1], [1.3]).unwrap();
    let seeds = fill(&bar, &Lattice::new([0.0], 0.1).unwrap(), 2, &Filling::new()).unwrap();
    assert_eq!(seeds.len(), 24);
    assert!((seeds.measure() - 1.2).abs() < 1e-14);
    let partial =
        fill(&bar, &Lattice::new([0.03], 0.1).unwrap(), 2, &Filling::new().partial(10, 0.3)).unwrap();
    assert!((partial.measure() - 1.2).abs() < 1e-14);
}

#[test]
fn what_is_cut_in_two_is_shared_out_without_loss() {
    // The cut passes through the centres of particles.
    let disc = Disc::new([0.5, 0.5], 0.4).unwrap();
    let knife = HalfSpace::new([0.525, 0.0], [1.0, 0.0]).unwrap();
    let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
    let options = Filling::new().uncorrected();
    let whole = fill(&disc, &lattice, 2, &options).unwrap();
    let left = fill(&disc.and(knife), &lattice, 2, &options).unwrap();
    let right = fill(&disc.minus(knife), &lattice, 2, &options).unwrap();
    assert_eq!(whole.len(), left.len() + right.len());
}

#[test]
fn bad_requests_are_refused() {
    let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
    let disc = Disc::new([0.5, 0.5], 0.4).unwrap();
    let plain = Filling::new();
    let refused = |e: GeometryError, f: &str| match e {
        GeometryError::Parameter { field, .. } => assert_eq!(field, f),
        other => panic!("{other}"),
    };
    refused(fill(&disc, &lattice, 0, &plain).unwrap_err(), "per_axis");
    refused(fill(&disc, &lattice, 2, &plain.partial(1, 0.1)).unwrap_err(), "subsamples");
    refused(fill(&disc, &lattice, 2, &plain.partial(4, 0.9)).unwrap_err(), "drop_below");
    refused(fill(&disc, &lattice, 2, &plain.jittered(1, f64::NAN)).unwrap_err(), "amount of jitter");
    let ball = Sphere::new([0.0; 3], 1.0).unwrap();
    let space = Lattice::new([0.0; 3], 0.1).unwrap();
    refused(
        fill(&ball, &space, 2, &plain.axisymmetric()).unwrap_err(),
        "dimension of an axisymmetric filling",
    );
    let below = HalfSpace::new([0.0, 0.0], [0.0, 1.0]).unwrap();
    assert_eq!(fill(&below, &lattice, 2, &plain), Err(GeometryError::Unbounded { axis: 0 }));
    let nothing = fill(&disc.and(Disc::new([9.0, 0.0], 1.0).unwrap()), &lattice, 2, &plain);
    assert!(matches!(nothing, Err(GeometryError::NoParticles { .. })));
    let speck = fill(&Disc::new([0.2, 0.2], 0.01).unwrap(), &lattice, 2, &plain);
    assert_eq!(speck, Err(GeometryError::NoParticles { particle_edge: 0.05 }));
    let units = fill(&Sphere::new([0.0; 3], 1.0).unwrap(), &Lattice::new([0.0; 3], 1e-6).unwrap(), 2, &plain);
    assert!(matches!(units, Err(GeometryError::TooFine { .. })));
    let far = fill(&Disc::new([1e30, 0.0], 1.0).unwrap(), &lattice, 2, &plain);
    assert!(matches!(far, Err(GeometryError::TooFine { .. })));
}

#[test]
fn threads_do_not_matter() {
    let plate = Cuboid::new([-0.5, -0.5, 0.0], [0.5, 0.5, 0.1]).unwrap();
    let bore = Cylinder::new([0.0, 0.0, -1.0], [0.1, 0.0, 1.0], 3.0, 0.2).unwrap();
    let shape = plate.minus(bore);
    let lattice = Lattice::new([0.0; 3], 0.03).unwrap();
    let options = Filling::new().partial(4, 0.1).jittered(3, 0.5);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fill(&shape, &lattice, 2, &options).unwrap())
    };
    let one = run(1);
    for threads in [2, 3, 7] {
        assert_eq!(run(threads), one);
    }
}

/// Benchmark: three million particles in less than two seconds. `cargo test --release -- --ignored`.
#[test]
#[ignore = "a measurement of seconds, which a busy machine fails"]
fn three_million_particles_are_quick() {
    let lattice = Lattice::new([0.0; 3], 2.0 / 179.0).unwrap();
    let ball = Sphere::new([0.01, 0.02, 0.03], 1.0).unwrap();
    let cut = ball.minus(Cylinder::new([0.0, 0.0, -2.0], [0.0, 0.1, 1.0], 4.0, 0.1).unwrap());
    let rod = OgiveRod::new([0.0; 3], [1.0, 1.0, 0.2], 0.7, 4.4, 3.0).unwrap();
    for options in [Filling::new(), Filling::new().partial(4, 0.1), Filling::new().jittered(1, 0.5)] {
        for shape in [&ball as &dyn Shape<3>, &cut, &rod] {
            let start = std::time::Instant::now();
            let seeds = fill(shape, &lattice, 1, &options).unwrap();
            let fine = fill(shape, &Lattice::new([0.0; 3], 2.0 / 90.0).unwrap(), 2, &options).unwrap();
            println!("{} + {} particles, {:?}: {options:?}", seeds.len(), fine.len(), start.elapsed());
            assert!(start.elapsed().as_secs_f64() < 4.0);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mass_is_exact_and_order_is_kept(
        centre in prop::array::uniform2(-1.0..1.0f64), angle in -3.0..3.0f64,
        origin in prop::array::uniform2(-1.0..1.0f64), h in 0.03..0.2f64, n in 1..4usize, partial: bool,
    ) {
        let lattice = Lattice::new(origin, h).unwrap();
        let options = if partial { Filling::new().partial(5, 0.2) } else { Filling::new().at_sites() };
        let ring = Ring::new(centre, 0.3, 0.6).unwrap();
        let bar = OgiveRod::new([centre[0], 0.0], [0.3, 1.0], 0.5, 1.0, 2.0).unwrap()
            .rotated(Rotation2::new(angle), centre).unwrap();
        let shapes: [&dyn Shape<2>; 2] = [&ring, &bar];
        for shape in shapes {
            let seeds = fill(shape, &lattice, n, &options).unwrap();
            let total: f64 = seeds.volumes.iter().sum();
            prop_assert!((total / shape.measure().unwrap() - 1.0).abs() < 1e-12);
            let cells: Vec<[i64; 2]> = seeds.positions.iter().map(|x| lattice.cell_of(*x).unwrap()).collect();
            prop_assert!(cells.is_sorted());
            for i in 1..cells.len() {
                if cells[i] == cells[i - 1] {
                    prop_assert!(seeds.positions[i - 1] < seeds.positions[i]);
                }
            }
            if !partial {
                prop_assert!(seeds.positions.iter().all(|x| shape.contains(*x)));
            }
        }
    }
}

/// The outermost particles of curved and oblique surfaces are half a particle below the surface, for any position of the lattice.
#[test]
fn the_outermost_layer_follows_the_surface() {
    let lattice = Lattice::new([0.013, -0.007], 0.05).unwrap();
    let edge = 0.5 * lattice.spacing();
    let disc = Ball::new([0.31, 0.17], 0.4).unwrap();
    let block =
        Cuboid::new([-0.7, -0.2], [0.6, 0.3]).unwrap().rotated(Rotation2::new(0.6), [0.1, 0.0]).unwrap();
    let shapes: [&dyn Shape<2>; 2] = [&disc, &block];
    for shape in shapes {
        let sites = fill(shape, &lattice, 2, &Filling::new().at_sites()).unwrap();
        let fitted = fill(shape, &lattice, 2, &Filling::new()).unwrap();
        assert_eq!(fitted.volumes, sites.volumes);
        let depth = |x: &[f64; 2]| -shape.signed_distance(*x);
        let nearest = |s: &Seeds<2>| s.positions.iter().map(depth).fold(f64::INFINITY, f64::min);
        assert!(nearest(&sites) < 0.2 * edge, "the stair comes near the surface");
        assert!((nearest(&fitted) / (0.5 * edge) - 1.0).abs() < 1e-6, "{} of {edge}", nearest(&fitted));
        for (a, b) in sites.positions.iter().zip(&fitted.positions) {
            let way = (a[0] - b[0]).hypot(a[1] - b[1]);
            assert!(way <= edge && (way == 0.0 || depth(a) < edge), "moved by {way}");
        }
        // No hole: the distance of any point inside to a particle is at most the diagonal of a cell.
        for i in 0..400 {
            let x = [-1.0 + 0.05 * f64::from(i % 40), -1.0 + 0.1 * f64::from(i / 40 * 2)];
            let far = fitted
                .positions
                .iter()
                .map(|p| (p[0] - x[0]).hypot(p[1] - x[1]))
                .fold(f64::INFINITY, f64::min);
            assert!(!shape.contains(x) || far < lattice.spacing(), "hole of {far} at {x:?}");
        }
    }
    // A surface that coincides with the lattice moves no particle, to the last bit.
    let block = Cuboid::new([0.013, -0.007], [0.513, 0.243]).unwrap();
    let still = [Filling::new(), Filling::new().at_sites()].map(|f| fill(&block, &lattice, 2, &f).unwrap());
    assert_eq!(still[0], still[1]);
}
