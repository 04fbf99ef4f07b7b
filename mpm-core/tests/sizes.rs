//! Inputs that would need huge memory are refused before allocation, or stay small.

use mpm_core::geometry::*;
use mpm_core::{DenseGrid, DenseGridError, GridStorage, MemoryError};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn lattice<const D: usize>(spacing: f64) -> Lattice<D> {
    Lattice::new([0.0; D], spacing).unwrap()
}

#[test]
fn a_dense_grid_beyond_memory_is_refused() {
    let grid = |low, high| DenseGrid::<f64, 3>::new(lattice(1.0), low, high);
    let refused = grid([0; 3], [4095; 3]).unwrap_err();
    // 1024^3 blocks of 64 nodes of 64 bytes, and of three coordinates of 4.
    let bytes = 1024f64.powi(3) * (64.0 * 64.0 + 12.0);
    assert!(
        matches!(refused, DenseGridError::Memory(MemoryError::Limit { bytes: b, .. }) if b == bytes),
        "{refused}"
    );
    let text = refused.to_string();
    assert!(text.contains("4.4109e12 bytes") && text.contains("at most 17179869184"), "{text}");
    assert!(text.contains("DenseGrid::within"), "{text}");
    assert!(matches!(grid([i32::MIN; 3], [i32::MAX; 3]), Err(DenseGridError::Memory(_))));
    assert!(matches!(grid([3, 0, 0], [3, 9, 9]), Err(DenseGridError::Empty { axis: 0, low: 3, high: 3 })));
    let within = |bytes| DenseGrid::<f64, 2>::within(lattice(1.0), [0; 2], [15; 2], bytes);
    let needs = 16 * (16 * 64 + 8);
    assert!(within(needs - 1).is_err());
    assert_eq!(within(needs).unwrap().bytes() as u64, needs);
    // Far corners: indices do not overflow.
    let end = DenseGrid::<f64, 2>::new(lattice(1.0), [i32::MAX - 9; 2], [i32::MAX; 2]).unwrap();
    assert_eq!(end.find(&[i32::MIN; 2]), None);
    assert!(end.find(&[i32::MAX / 4; 2]).is_some());
    // A failed allocation is an error, too.
    let all = DenseGrid::<f64, 3>::within(lattice(1.0), [i32::MIN; 3], [i32::MAX; 3], u64::MAX);
    assert!(matches!(all, Err(DenseGridError::Memory(_))));
}

#[test]
fn a_filling_beyond_memory_is_refused() {
    let limit = |r: Result<Seeds<3>, GeometryError>| match r.unwrap_err() {
        GeometryError::Memory(e @ MemoryError::Limit { bytes, .. }) => (bytes, e.to_string()),
        other => panic!("{other}"),
    };
    // 8e9 particles of 64 bytes.
    let cube = Cuboid::new([0.0; 3], [1.0; 3]).unwrap();
    let (bytes, text) = limit(fill(&cube, &lattice(1e-3), 2, &Filling::new()));
    assert!((bytes / (8e9 * 64.0) - 1.0).abs() < 0.05, "{text}");
    assert!(text.contains("Filling::memory"), "{text}");
    // A column of 1e11 sites with one particle across.
    let wire = Cuboid::new([0.0; 3], [1.0, 1.0, 1e11]).unwrap();
    let (bytes, _) = limit(fill(&wire, &lattice(1.0), 1, &Filling::new()));
    assert!(bytes > 16e11 && bytes < 1e13, "{bytes:e}");
    // Columns without particles.
    let plate = Cuboid::new([0.0; 3], [1e5, 1e5, 0.1]).unwrap();
    limit(fill(&plate, &lattice(1.0), 1, &Filling::new().memory(1 << 20)));
    // Without a known measure the particles found count, equally for any number of threads.
    let cut = cube.minus(Sphere::new([1.0; 3], 0.5).unwrap());
    let found = |threads, bytes| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fill(&cut, &lattice(0.05), 2, &Filling::new().memory(bytes)))
    };
    assert_eq!(cut.measure(), None);
    let seeds = found(1, 1 << 30).unwrap();
    let (bytes, _) = limit(found(1, 100_000));
    assert!(bytes > seeds.len() as f64 * 64.0 && bytes < seeds.len() as f64 * 64.0 + 50_000.0, "{bytes}");
    assert_eq!(found(3, bytes as u64 + 50_000).unwrap(), seeds);
    for partial in [0.0, 0.3] {
        let tight = fill(&cut, &lattice(0.05), 2, &Filling::new().partial(3, partial).memory(300_000));
        assert!(matches!(tight, Err(GeometryError::Memory(_))));
    }
}

#[test]
fn numbers_that_leave_no_volume_are_refused() {
    let field = |r: Result<Seeds<3>, GeometryError>| match r.unwrap_err() {
        GeometryError::Parameter { field, .. } => field,
        other => panic!("{other}"),
    };
    let ball = Sphere::new([0.0; 3], 1e-150).unwrap();
    assert_eq!(field(fill(&ball, &lattice(1e-151), 1, &Filling::new())), "spacing of the lattice");
    let huge = Sphere::new([0.0; 3], 1e150).unwrap();
    assert_eq!(field(fill(&huge, &lattice(1e149), 1, &Filling::new())), "spacing of the lattice");
    let nowhere =
        Implicit::new(
            Bounds { min: [0.0; 3], max: [1.0; 3] },
            |x: [f64; 3]| {
                if x[0] < 0.5 { -0.01 } else { f64::NAN }
            },
        );
    assert_eq!(field(fill(&nowhere, &lattice(0.1), 2, &Filling::new())), "measure");
    let wide = [[-1e154, -1e154], [1e154, -1e154], [1e154, 1e154], [-1e154, 1e154]];
    assert!(Polygon::new(wide.to_vec()).is_err());
    assert_eq!(lattice::<1>(1e-3).cell_of([1e300]), None);
    assert_eq!(lattice::<1>(1.0).cell_bounds([i64::MAX]).max, [2f64.powi(63)]);
}

#[test]
fn rings_beyond_memory_are_refused() {
    for count in [20_000, 1 << 40, usize::MAX] {
        let refused = rings([0.0; 2], 1.0, count).unwrap_err();
        assert!(matches!(refused, GeometryError::Memory(_)), "{refused}");
        assert!(refused.to_string().contains("use fewer rings"));
    }
    for radius in [1e200, 1e-200] {
        let refused = rings([0.0; 2], radius, 9).unwrap_err();
        assert!(matches!(refused, GeometryError::Parameter { field: "radius", .. }), "{refused}");
    }
    let disc = rings([0.0; 2], 2.0, 40).unwrap();
    assert!((disc.measure() / (std::f64::consts::PI * 4.0) - 1.0).abs() < 1e-14);
}

/// Strategy for any floating-point number, of all orders of magnitude.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-1.0..1.0f64, -320..309i32).prop_map(|(m, e)| m * 10f64.powi(e)),
        2 => -3.0..3.0f64,
        1 => prop_oneof![Just(0.0), Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(f64::MAX), Just(-f64::MAX)],
    ]
}

fn point<const D: usize>() -> impl Strategy<Value = [f64; D]> {
    prop::collection::vec(number(), D).prop_map(|v| std::array::from_fn(|i| v[i]))
}

fn index() -> impl Strategy<Value = i32> {
    prop_oneof![any::<i32>(), -40..40i32, Just(i32::MIN), Just(i32::MAX)]
}

const SMALL: u64 = 1 << 20;

fn modest<const D: usize>(seeds: Result<Seeds<D>, GeometryError>) -> Result<(), TestCaseError> {
    if let Ok(seeds) = seeds {
        prop_assert!(seeds.len() * 8 * (D + 1) <= SMALL as usize);
        prop_assert!(seeds.volumes.iter().all(|v| v.is_finite() && *v > 0.0), "{:?}", seeds.volumes);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 1000, failure_persistence: None, rng_seed: RngSeed::Fixed(7), ..ProptestConfig::default()
    })]

    #[test]
    fn any_box_is_a_small_grid_or_an_error(low in prop::array::uniform3(index()), high in prop::array::uniform3(index())) {
        if let Ok(grid) = DenseGrid::<f32, 3>::within(lattice(1.0), low, high, SMALL) {
            prop_assert!(grid.bytes() as u64 <= SMALL);
        }
        if let Ok(grid) = DenseGrid::<f64, 2>::within(lattice(1.0), [low[0], low[1]], [high[0], high[1]], SMALL) {
            prop_assert!(grid.bytes() as u64 <= SMALL);
            prop_assert!(grid.find(&[low[2], high[2]]).is_none_or(|i| i < grid.blocks().len()));
        }
    }

    #[test]
    fn any_filling_is_small_or_an_error(
        a in point::<3>(), b in point::<3>(), origin in point::<3>(), spacing in number(), radius in number(),
        per_axis in prop_oneof![0..4usize, 0..70usize], mode in 0..4,
        exponent in prop_oneof![-90.0..90.0f64, -320.0..300.0f64], fraction in 0.05..1.0f64,
        near in prop::array::uniform4(prop::array::uniform3(-1.5..1.5f64)),
    ) {
        let mode = match mode {
            0 => Filling::new().at_sites(),
            1 => Filling::new().partial(per_axis.min(3), 0.1),
            2 => Filling::new().jittered(1, 0.5),
            _ => Filling::new(),
        }.memory(SMALL);
        // Arbitrary numbers, and numbers of one magnitude from which bodies can be made.
        let scale = 10f64.powf(exponent);
        let [p, q, o, r] = near.map(|x| x.map(|c| c * scale));
        let cases = [(a, b, origin, spacing, radius), (p, q, o, fraction * scale, r[0].abs())];
        for (a, b, origin, spacing, radius) in cases {
            if let Ok(space) = Lattice::new(origin, spacing) {
                let _ = (space.cell_of(a), space.cell_of(b), space.local(b));
                if let Ok(block) = Cuboid::new(a, b) { modest(fill(&block, &space, per_axis, &mode))? }
                if let Ok(ball) = Sphere::new(a, radius) { modest(fill(&ball, &space, per_axis, &mode))? }
            }
            let flat = |x: [f64; 3]| [x[0], x[1]];
            if let (Ok(plane), Ok(block)) = (Lattice::new(flat(origin), spacing), Cuboid::new(flat(a), flat(b))) {
                modest(fill(&block, &plane, per_axis, &mode))?;
                modest(fill(&block, &plane, per_axis, &mode.axisymmetric()))?;
            }
            let _ = Polygon::new(vec![flat(a), flat(b), flat(origin)]).map(|p| (p.bounds(), p.signed_distance(flat(a))));
            let _ = TriangleMesh::from_soup(&[[a, b, origin], [a, origin, b]]);
            let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
            if let Ok(solid) = TriangleMesh::new(&[a, b, origin, [radius, spacing, 1.0]], &tetrahedron) {
                let _ = (solid.contains(a), solid.signed_distance(b));
            }
        }
    }

    #[test]
    fn any_rings_are_few_or_an_error(centre in point::<2>(), radius in number(), count in prop_oneof![0..50usize, 20_000..usize::MAX]) {
        if let Ok(seeds) = rings(centre, radius, count) {
            prop_assert!(seeds.volumes.iter().all(|v| v.is_finite() && *v > 0.0));
        }
    }
}
