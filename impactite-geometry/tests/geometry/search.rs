//! Neighbour searches: all agree with the brute-force search, and reject invalid input.

use impactite_geometry::search::*;
use impactite_simd::Team;
use proptest::prelude::*;

/// Set of points with radii.
#[derive(Clone, Debug)]
struct Set<const D: usize> {
    positions: Vec<[f64; D]>,
    radii: Vec<f64>,
}

impl<const D: usize> Set<D> {
    fn points(&self) -> Points<'_, D> {
        Points::new(&self.positions, &self.radii).unwrap()
    }
}

/// Spatial distribution of points.
#[derive(Clone, Copy, Debug)]
enum Lie {
    /// Random in a box.
    Spread,
    /// Coincident with one of a few positions.
    Coincident,
    /// On a line along an axis.
    Straight,
    /// On a diagonal line across all axes.
    Oblique,
    /// On a lattice: many pairs exactly at their range.
    Lattice,
    /// Two distant clusters, and one point far from both.
    Crowds,
    /// Sparse lattice: its cells fold onto each other.
    Sparse,
}

/// Distribution of radii.
#[derive(Clone, Copy, Debug)]
enum Sizes {
    Alike,
    /// Logarithmic over four decades.
    Graded,
    /// One large radius, all others small, some zero.
    OneLarge,
    None,
}

fn lies() -> impl Strategy<Value = Lie> {
    prop_oneof![
        Just(Lie::Spread),
        Just(Lie::Coincident),
        Just(Lie::Straight),
        Just(Lie::Oblique),
        Just(Lie::Lattice),
        Just(Lie::Crowds),
        Just(Lie::Sparse),
    ]
}

fn sizes() -> impl Strategy<Value = Sizes> {
    prop_oneof![Just(Sizes::Alike), Just(Sizes::Graded), Just(Sizes::OneLarge), Just(Sizes::None)]
}

fn offsets() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(-0.3), Just(1e6), Just(-1e12)]
}

/// Strategy for up to `most` points with coordinates of order one, times a scale.
fn sets<const D: usize>(most: usize) -> impl Strategy<Value = Set<D>> {
    let numbers = prop::collection::vec(prop::array::uniform4(0.0..1.0f64), 0..most);
    (numbers, lies(), sizes(), offsets(), prop_oneof![Just(1.0), Just(1e-9), Just(1e7)]).prop_map(
        |(numbers, lie, sizes, offset, scale)| {
            let count = numbers.len();
            let place = |n: usize, d: usize| -> f64 {
                let u = numbers[n];
                match lie {
                    Lie::Spread => u[d],
                    Lie::Coincident => numbers[n % 3.min(count)][d],
                    Lie::Straight => f64::from(u8::from(d == D - 1)) * u[0],
                    Lie::Oblique => u[0] * (1.0 + d as f64),
                    Lie::Lattice => (8.0 * u[d]).floor() / 8.0,
                    Lie::Crowds if n == 0 => -3e7,
                    Lie::Crowds => u[d] + if u[3] < 0.5 { 1e4 } else { 0.0 },
                    Lie::Sparse => (64.0 * u[d]).floor() * 1e5,
                }
            };
            let spacing = 1.0 / (count.max(1) as f64).powf(1.0 / D as f64);
            let radius = |n: usize| match sizes {
                Sizes::Alike => spacing * (0.4 + 0.2 * numbers[n][3]),
                Sizes::Graded => 0.5 * 1e4f64.powf(-numbers[n][3]),
                Sizes::OneLarge if n == count / 2 => 0.4,
                Sizes::OneLarge => 1e-3 * (numbers[n][3] - 0.5).max(0.0),
                Sizes::None => 0.0,
            };
            let position = |n: usize| std::array::from_fn(|d| scale * (place(n, d) + offset));
            Set {
                positions: (0..count).map(position).collect(),
                radii: (0..count).map(|n| scale * radius(n)).collect(),
            }
        },
    )
}

/// Return a reach of a kind, with lengths of the order of the spacing.
fn reach_of(kind: usize, set: &[f64], wide: f64) -> Reach {
    let largest = set.iter().fold(0.0, |m: f64, &r| m.max(r));
    match kind {
        0 => Reach::sum(0.0),
        1 => Reach::Sum { factor: 1.5, tolerance: 0.3 * wide * largest },
        2 => Reach::larger(0.0),
        3 => Reach::Larger { factor: 2.0, tolerance: wide * largest },
        4 => Reach::uniform(0.0),
        _ => Reach::uniform(wide * largest),
    }
}

fn agree<const D: usize>(set: &Set<D>, other: &Set<D>, reach: Reach, u: [f64; 3]) {
    let (points, others) = (set.points(), other.points());
    let plain = EveryPair::new(&points, reach).unwrap();
    let wanted = plain.neighbours(&Team::one()).unwrap();
    let wanted_of = plain.neighbours_of(&others, &Team::one()).unwrap();
    assert_eq!((wanted.len(), wanted_of.len()), (points.len(), others.len()));
    for i in 0..wanted.len() {
        assert!(wanted.of(i).windows(2).all(|w| w[0] < w[1]), "ascending");
        assert!(wanted.of(i).iter().all(|&j| wanted.of(j as usize).contains(&(i as u32))), "symmetric");
    }
    // Query positions: some of the points, positions beside them, midpoints, and remote positions.
    let mut places = vec![[0.0; D], [-3.0 * u[0]; D], [1e20 * u[1]; D]];
    for i in (0..points.len()).step_by(1 + points.len() / 4) {
        let (x, y) = (set.positions[i], set.positions[points.len() - 1 - i]);
        places.push(x);
        places.push(std::array::from_fn(|d| x[d] + (u[d] - 0.5) * set.radii[i]));
        places.push(std::array::from_fn(|d| 0.5 * x[d] + 0.5 * y[d]));
    }
    for method in SearchMethod::ALL {
        let name = method.name();
        let search = method.sort(&points, reach).unwrap();
        assert_eq!(search.len(), points.len());
        assert_eq!(search.neighbours(&Team::one()).unwrap(), wanted, "{name}");
        assert_eq!(search.neighbours_of(&others, &Team::one()).unwrap(), wanted_of, "{name}, two sets");
        for x in &places {
            let ball = reach.of(set.radii.first().copied().unwrap_or(0.0), 0.0);
            assert_eq!(search.nearest(x).unwrap(), plain.nearest(x).unwrap(), "{name}, nearest to {x:?}");
            assert_eq!(
                search.within(x, ball).unwrap(),
                plain.within(x, ball).unwrap(),
                "{name} around {x:?}"
            );
        }
    }
    let cells = SortedCells::new(&points, reach).unwrap();
    let mut pairs = Vec::new();
    cells.each_pair(|i, j| pairs.push([i.min(j), i.max(j)]));
    pairs.sort_unstable();
    let above = |i: usize| wanted.of(i).iter().filter(move |&&j| j > i as u32).map(move |&j| [i as u32, j]);
    assert_eq!(pairs, (0..wanted.len()).flat_map(above).collect::<Vec<_>>(), "each pair once");
    assert!(cells.cells() <= 4 * points.len() + 64 * cells.levels(), "{} cells", cells.cells());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, rng_seed: proptest::test_runner::RngSeed::Fixed(17), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn all_searches_agree_on_a_line(set in sets::<1>(120), other in sets::<1>(60), kind in 0usize..6, u in prop::array::uniform3(0.0..1.0f64)) {
        agree(&set, &other, reach_of(kind, &set.radii, u[2]), u);
    }

    #[test]
    fn all_searches_agree_in_a_plane(set in sets::<2>(160), other in sets::<2>(60), kind in 0usize..6, u in prop::array::uniform3(0.0..1.0f64)) {
        agree(&set, &other, reach_of(kind, &set.radii, u[2]), u);
    }

    #[test]
    fn all_searches_agree_in_space(set in sets::<3>(200), other in sets::<3>(60), kind in 0usize..6, u in prop::array::uniform3(0.0..1.0f64)) {
        agree(&set, &other, reach_of(kind, &set.radii, u[2]), u);
    }

    /// Verlet lists contain all points within reach, and none beyond two skins, while points move, shrink, grow, appear and vanish.
    #[test]
    fn kept_lists_miss_nothing(set in sets::<2>(80), kind in 0usize..6, seed in prop::array::uniform3(0.0..1.0f64), wide in 0.0..1.0f64) {
        let reach = reach_of(kind, &set.radii, seed[2]);
        let largest = set.radii.iter().fold(0.0, |m: f64, &r| m.max(r));
        let skin = wide * largest;
        let mut lists = VerletLists::<2>::new(reach, skin).unwrap();
        let mut now = set.clone();
        for step in 0..12usize {
            if step == 8 {
                now.positions.pop();
                now.radii.pop();
            }
            for n in 0..now.radii.len() {
                let toss = |k: usize| (seed[k % 3] * ((n * 31 + step * 7 + k + 1) as f64) * 97.0).fract() - 0.5;
                for d in 0..2 {
                    now.positions[n][d] += 0.2 * skin * toss(d);
                }
                now.radii[n] = (now.radii[n] * (1.0 + 0.05 * toss(2))).max(0.0);
            }
            lists.update(&now.points(), &Team::one()).unwrap();
            let near = EveryPair::new(&now.points(), reach).unwrap().neighbours(&Team::one()).unwrap();
            prop_assert_eq!(lists.lists().len(), now.radii.len());
            for i in 0..now.radii.len() {
                prop_assert!(lists.of(i).is_sorted());
                prop_assert!(near.of(i).iter().all(|j| lists.of(i).contains(j)), "step {}: one of {} is missing", step, i);
            }
        }
    }
}

/// Pseudorandom number in [0, 1) from an index.
fn random(place: usize) -> f64 {
    let mut z = (place as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Create enough points for many tasks.
fn crowd<const D: usize>(count: usize, ratio: f64) -> Set<D> {
    let at = |n: usize, d: usize| random(n * 4 + d);
    let spacing = (count as f64).powf(-1.0 / D as f64);
    Set {
        positions: (0..count).map(|n| std::array::from_fn(|d| at(n, d))).collect(),
        radii: (0..count).map(|n| 0.7 * spacing * ratio.powf(-at(n, 3))).collect(),
    }
}

#[test]
fn lists_are_the_same_for_any_number_of_threads_and_any_origin() {
    fn check<const D: usize>(ratio: f64) {
        let set = crowd::<D>(4000, ratio);
        let reach = Reach::sum(0.0);
        let search = SortedCells::new(&set.points(), reach).unwrap();
        let lists = search.neighbours(&Team::one()).unwrap();
        assert_eq!(lists, EveryPair::new(&set.points(), reach).unwrap().neighbours(&Team::one()).unwrap());
        assert!(lists.list().len() > 100, "{} neighbours", lists.list().len());
        let other = crowd::<D>(1500, 2.0 * ratio);
        let between = search.neighbours_of(&other.points(), &Team::one()).unwrap();
        for threads in [2, 3, 7] {
            let team = Team::new(threads).unwrap();
            for method in SearchMethod::ALL {
                let search = method.sort(&set.points(), reach).unwrap();
                assert_eq!(search.neighbours(&team).unwrap(), lists);
                assert_eq!(search.neighbours_of(&other.points(), &team).unwrap(), between);
            }
        }
        // One more point, out of reach of all, shifts the origin of the cells.
        for away in [-0.3, -7.7, -1e5] {
            let mut moved = set.clone();
            moved.positions.push([away; D]);
            moved.radii.push(0.0);
            let more = SortedCells::new(&moved.points(), reach).unwrap().neighbours(&Team::one()).unwrap();
            assert_eq!(more.list(), lists.list());
            assert_eq!(more.starts()[..lists.starts().len()], *lists.starts());
        }
    }
    check::<1>(1.5);
    check::<2>(1.5);
    check::<2>(100.0);
    check::<3>(1.5);
    check::<3>(1e4);
}

#[test]
fn levels_follow_the_powers_of_two_of_radii() {
    let levels = |radii: &[f64]| {
        let positions: Vec<[f64; 2]> = (0..radii.len()).map(|n| [n as f64, 0.0]).collect();
        let points = Points::new(&positions, radii).unwrap();
        SortedCells::new(&points, Reach::sum(0.0)).unwrap().levels()
    };
    assert_eq!(levels(&[]), 0);
    assert_eq!(levels(&[1.0]), 1);
    assert_eq!(levels(&[0.0, 0.0]), 1);
    assert_eq!(levels(&[1.0, 0.5]), 1);
    assert_eq!(levels(&[1.0, 0.5, 0.49]), 2);
    assert_eq!(levels(&[1e150 / 4.0, 1.0, 1e-20, 0.0]), 2);
    let powers: Vec<f64> = (0..10).map(|n| 0.5f64.powi(n)).collect();
    assert_eq!(levels(&powers), 10);
}

#[test]
fn what_no_search_can_use_is_refused() {
    let said = |e: SearchError| e.to_string();
    for (value, shown) in [(f64::NAN, "NaN"), (f64::INFINITY, "inf"), (-f64::INFINITY, "-inf")] {
        let positions = [[0.0, 0.0, 0.0], [1.0, value, 2.0]];
        let e = Points::new(&positions, &[1.0, 1.0]).map(|_| ()).unwrap_err();
        let expected = format!(
            "search: y of point 1 = {shown} is not allowed; it must be finite, between -1e150 and 1e150"
        );
        assert_eq!(said(e), expected);
    }
    for (value, shown) in [(-1.0, "-1"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        let e = Points::new(&[[0.0], [1.0]], &[0.0, value]).map(|_| ()).unwrap_err();
        let expected = format!(
            "search: radius of point 1 = {shown} is not allowed; it must be zero or positive, and at most 1e150"
        );
        assert_eq!(said(e), expected);
    }
    let e = Points::new(&[[0.0], [1.0]], &[0.0]).map(|_| ()).unwrap_err();
    assert_eq!(e, SearchError::Lengths { positions: 2, radii: 1 });
    assert!(Points::of_positions(&[[1e151]]).is_err());

    let (positions, radii) = ([[0.0, 0.0], [1e150, -1e150]], [0.0, 1e150]);
    let points = Points::new(&positions, &radii).unwrap();
    for method in SearchMethod::ALL {
        for reach in [
            Reach::sum(-1.0),
            Reach::sum(f64::NAN),
            Reach::larger(f64::INFINITY),
            Reach::uniform(-0.1),
            Reach::Sum { factor: -1.0, tolerance: 0.0 },
            // A range of 2e150 is too large.
            Reach::sum(0.0),
        ] {
            assert!(method.sort(&points, reach).is_err(), "{} takes {reach:?}", method.name());
        }
        let search = method.sort(&points, Reach::larger(0.0)).unwrap();
        assert!(search.neighbours(&Team::one()).unwrap().of(0).is_empty());
        for x in [[f64::NAN, 0.0], [0.0, f64::INFINITY], [-1e200, 0.0]] {
            assert!(search.nearest(&x).is_err() && search.within(&x, 1.0).is_err());
        }
        assert!(search.within(&[0.0; 2], -1.0).is_err() && search.within(&[0.0; 2], f64::NAN).is_err());
        assert_eq!(search.within(&[0.0; 2], 1e150).unwrap(), [0]);
    }
    assert!(VerletLists::<2>::new(Reach::sum(0.0), -1.0).is_err());
    assert!(VerletLists::<2>::new(Reach::uniform(f64::NAN), 0.0).is_err());
}

#[test]
fn crowds_that_would_fill_the_memory_are_refused() {
    // 4e8 neighbours.
    let positions = vec![[0.5, 0.5]; 20_000];
    let points = Points::of_positions(&positions).unwrap();
    let cells = SortedCells::new(&points, Reach::uniform(1.0)).unwrap();
    for threads in [1, 2] {
        let e = cells.neighbours(&Team::new(threads).unwrap()).unwrap_err();
        assert_eq!(e, SearchError::Neighbours { points: 20_000, allowed: 1 << 26 });
    }
    let mut lists = VerletLists::<2>::new(Reach::uniform(1.0), 0.0).unwrap();
    assert!(lists.update(&points, &Team::one()).is_err());
    assert!(lists.of(19_999).is_empty());
}

#[test]
fn radii_that_grow_use_up_the_skin() {
    let positions = [[0.0], [1.0]];
    let mut lists = VerletLists::<1, BoxTree<1>>::new(Reach::sum(0.0), 0.2).unwrap();
    let mut update = |radii: [f64; 2]| {
        lists.update(&Points::new(&positions, &radii).unwrap(), &Team::one()).unwrap();
        (lists.searches(), lists.of(0).len())
    };
    assert_eq!(update([0.35, 0.35]), (1, 0));
    assert_eq!(update([0.44, 0.44]), (1, 0));
    assert_eq!(update([0.2, 0.44]), (1, 0));
    assert_eq!(update([0.46, 0.35]), (2, 1));
    lists.forget();
    assert!(lists.update(&Points::of_positions(&positions).unwrap(), &Team::one()).unwrap());
}
