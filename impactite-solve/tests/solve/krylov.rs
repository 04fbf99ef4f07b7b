//! MINRES and GMRES on systems of their own, and verdicts on solves that fail.

use std::sync::Arc;

use faer::Mat;
use faer::linalg::solvers::Solve;
use impactite_simd::Team;
use impactite_solve::{
    CellBlocks, Identity, Jacobi, Multigrid, Operator, Preconditioner, SolveError, Stencil, StencilError,
    Stop, conjugate_gradients, gmres, minres,
};

use crate::domains;
use crate::domains::hash;

/// Dense matrix.
struct Dense(Mat<f64>);

impl Operator for Dense {
    fn len(&self) -> usize {
        self.0.nrows()
    }
    fn apply(&self, _: &Team, x: &[f64], y: &mut [f64]) {
        for (i, y) in y.iter_mut().enumerate() {
            *y = x.iter().enumerate().map(|(j, x)| self.0[(i, j)] * x).sum();
        }
    }
}

impl Dense {
    fn error(&self, b: &[f64], x: &[f64]) -> f64 {
        let exact = self.0.partial_piv_lu().solve(Mat::from_fn(b.len(), 1, |i, _| b[i]));
        let size = (0..b.len()).fold(0.0, |m: f64, i| m.max(exact[(i, 0)].abs()));
        (0..b.len()).fold(0.0, |m: f64, i| m.max((exact[(i, 0)] - x[i]).abs())) / size
    }
}

fn noise(n: usize) -> Vec<f64> {
    (0..n).map(|i| hash(i as u64) - 0.5).collect()
}

fn stop(relative: f64, iterations: usize) -> Stop {
    Stop { relative, iterations, ..Stop::default() }
}

/// Saddle point matrix [A B^T; B 0]: A tridiagonal of `n` rows, B of `m` rows.
fn saddle(n: usize, m: usize) -> Dense {
    Dense(Mat::from_fn(n + m, n + m, |i, j| match (i.max(j), i.min(j)) {
        (a, b) if a < n => [2.5, -1.0].get(a - b).copied().unwrap_or(0.0) * (1.0 + 0.1 * (b % 7) as f64),
        (a, b) if b < n && a - n == b % m => 1.0 + hash(b as u64),
        _ => 0.0,
    }))
}

/// Preconditioner of a saddle point matrix: A and the Schur complement B A^-1 B^T.
struct Blocks(Mat<f64>);

impl Blocks {
    fn of(matrix: &Dense, n: usize) -> Self {
        let m = matrix.len() - n;
        let a = matrix.0.submatrix(0, 0, n, n);
        let b = matrix.0.submatrix(n, 0, m, n);
        let schur = b * a.llt(faer::Side::Lower).expect("positive definite").solve(b.transpose());
        Blocks(Mat::from_fn(n + m, n + m, |i, j| match (i < n, j < n) {
            (true, true) => a[(i, j)],
            (false, false) => schur[(i - n, j - n)],
            _ => 0.0,
        }))
    }
}

impl Preconditioner for Blocks {
    fn apply(&mut self, _: &Team, r: &[f64], z: &mut [f64]) {
        let solution = self.0.llt(faer::Side::Lower).expect("positive definite").solve(Mat::from_fn(
            r.len(),
            1,
            |i, _| r[i],
        ));
        (0..r.len()).for_each(|i| z[i] = solution[(i, 0)]);
    }
}

#[test]
fn minres_solves_saddle_points() {
    let (team, matrix) = (Team::one(), saddle(60, 20));
    let b = noise(80);
    let mut preconditioner =
        Jacobi::new(&(0..80).map(|i| if i < 60 { matrix.0[(i, i)] } else { 2.0 }).collect::<Vec<_>>());
    let mut x = noise(80);
    let solved =
        minres(&team, &matrix, &mut preconditioner, &b, &mut x, &stop(1e-12, 200)).expect("a solution");
    let error = matrix.error(&b, &x);
    // Condition number some 20.
    assert!(error < 2e-11, "{error:e} {solved:?}");
    // [MurphyGolubWathen2000]: the preconditioned matrix has the eigenvalues 1 and (1 +- sqrt(5)) / 2.
    x.fill(0.0);
    let solved = minres(&team, &matrix, &mut Blocks::of(&matrix, 60), &b, &mut x, &stop(1e-12, 200))
        .expect("a solution");
    assert_eq!(solved.iterations, 3);
    let indefinite =
        conjugate_gradients(&team, &matrix, &mut Identity, &b, &mut vec![0.0; 80], &stop(1e-12, 200));
    assert!(matches!(indefinite, Err(SolveError::Curvature { value, .. }) if value <= 0.0), "{indefinite:?}");
}

#[test]
fn minres_takes_an_iteration_for_each_eigenvalue() {
    let team = Team::one();
    let eigenvalues = [-3.0, -0.5, 1.0, 7.0];
    let matrix = Dense(Mat::from_fn(40, 40, |i, j| if i == j { eigenvalues[i % 4] } else { 0.0 }));
    let (b, mut x) = (noise(40), vec![0.0; 40]);
    let solved = minres(&team, &matrix, &mut Identity, &b, &mut x, &stop(1e-12, 40)).expect("a solution");
    assert_eq!(solved.iterations, 4);
    assert!((0..40).all(|i| (x[i] * eigenvalues[i % 4] - b[i]).abs() < 1e-13));
    // An exact inverse in magnitude leaves the eigenvalues 1 and -1.
    let mut magnitude = Jacobi::new(&(0..40).map(|i| f64::abs(eigenvalues[i % 4])).collect::<Vec<_>>());
    x.fill(0.0);
    let solved = minres(&team, &matrix, &mut magnitude, &b, &mut x, &stop(1e-12, 40)).expect("a solution");
    assert_eq!(solved.iterations, 2);
}

#[test]
fn minres_solves_a_closed_tank() {
    let team = Team::one();
    let stencil = domains::stencil::<2>(&team, "closed tank", 40);
    let b = domains::source(&team, &stencil, 40, true);
    let mut multigrid = Multigrid::new(&team, &stencil);
    let [mut x, mut y] = [0, 1].map(|_| vec![3.0; b.len()]);
    let solved = minres(&team, &stencil, &mut multigrid, &b, &mut x, &stop(1e-10, 40)).expect("a solution");
    conjugate_gradients(&team, &stencil, &mut multigrid, &b, &mut y, &stop(1e-10, 40)).expect("a solution");
    let (top, error) = x
        .iter()
        .zip(&y)
        .fold((0.0, 0.0), |(t, e): (f64, f64), (x, y)| (t.max(x.abs()), e.max((x - y).abs())));
    assert!(error < 1e-8 * top && solved.iterations < 15, "{error:e} {top:e} {solved:?}");
}

/// Advection and diffusion on a square of n^2 cells, central differences at a cell Peclet number.
fn advection(n: usize, peclet: f64) -> Dense {
    Dense(Mat::from_fn(n * n, n * n, |i, j| {
        let d = |k: u32| (i / n.pow(k) % n) as i64 - (j / n.pow(k) % n) as i64;
        match (d(0), d(1)) {
            (0, 0) => 4.0,
            (1, 0) => -1.0 - peclet,
            (-1, 0) => -1.0 + peclet,
            (0, 1) => -1.0 - 0.5 * peclet,
            (0, -1) => -1.0 + 0.5 * peclet,
            _ => 0.0,
        }
    }))
}

#[test]
fn gmres_solves_advection_and_diffusion() {
    let team = Team::one();
    for (peclet, restart) in [(0.5, 100), (0.9, 20), (3.0, 60)] {
        let matrix = advection(12, peclet);
        let (b, mut x) = (noise(144), noise(144));
        let solved =
            gmres(&team, &matrix, &mut Identity, &b, &mut x, restart, &stop(1e-12, 400)).expect("a solution");
        let error = matrix.error(&b, &x);
        assert!(error < 2e-11 && solved.residual < 1e-12 * 4.0, "{peclet}: {error:e} {solved:?}");
    }
}

#[test]
fn gmres_on_a_cyclic_shift_takes_all_dimensions_or_stagnates() {
    let team = Team::one();
    let matrix = Dense(Mat::from_fn(24, 24, |i, j| if (j + 1) % 24 == i { 1.0 } else { 0.0 }));
    let mut b = vec![0.0; 24];
    b[0] = 1.0;
    let mut x = vec![0.0; 24];
    let solved = gmres(&team, &matrix, &mut Identity, &b, &mut x, 24, &stop(1e-12, 100)).expect("a solution");
    assert_eq!((solved.iterations, x[23]), (24, 1.0));
    x.fill(0.0);
    let failed =
        gmres(&team, &matrix, &mut Identity, &b, &mut x, 23, &stop(1e-12, 1000)).expect_err("stagnation");
    assert!(
        matches!(failed, SolveError::NotReached { residual, iterations, .. } if residual == 1.0 && iterations < 100),
        "{failed}"
    );
}

/// Preconditioner that is not positive.
struct Negative;

impl Preconditioner for Negative {
    fn apply(&mut self, _: &Team, r: &[f64], z: &mut [f64]) {
        (0..r.len()).for_each(|i| z[i] = -r[i]);
    }
}

#[test]
fn solves_that_fail_say_why() {
    let team = Team::one();
    let stencil = domains::stencil::<2>(&team, "closed tank", 16);
    let b = domains::source(&team, &stencil, 16, true);
    let mut multigrid = Multigrid::new(&team, &stencil);
    let mut solve = |b: &[f64], stop: Stop| {
        conjugate_gradients(&team, &stencil, &mut multigrid, b, &mut vec![0.0; b.len()], &stop)
    };
    let pushed: Vec<f64> = b.iter().map(|b| b + 0.01).collect();
    let failed = solve(&pushed, Stop::default()).expect_err("sources of a closed tank");
    assert!(
        matches!(failed, SolveError::Incompatible { removed, .. } if (removed - 0.16).abs() < 1e-12),
        "{failed}"
    );
    assert!(failed.to_string().contains("closed tank"));
    let removed = solve(&pushed, Stop { incompatible: 0.1, ..Stop::default() }).expect("a solution").removed;
    assert!((removed - 0.16).abs() < 1e-12);
    let mut broken = b.clone();
    broken[37] = f64::NAN;
    let failed = solve(&broken, Stop::default()).expect_err("a NaN");
    assert!(matches!(failed, SolveError::NotFinite { field: "b", index: 37, .. }), "{failed}");
    let ball = domains::stencil::<2>(&team, "ball", 16);
    let outside = ball.diagonal().iter().position(|d| *d == 0.0).expect("a slot without an unknown");
    let mut beside = vec![0.0; ball.len()];
    beside[outside] = 1.0;
    let failed = minres(&team, &ball, &mut Identity, &beside, &mut vec![0.0; ball.len()], &Stop::default());
    assert_eq!(failed, Err(SolveError::NoUnknown { value: 1.0, index: outside }));
    let failed = solve(&b[1..], Stop::default()).expect_err("a short vector");
    assert_eq!(failed, SolveError::Length { field: "b", value: 255, unknowns: 256 });
    let failed = solve(&b, stop(1e-12, 2)).expect_err("few iterations");
    assert!(
        matches!(failed, SolveError::NotReached { iterations: 2, residual, tolerance, .. } if residual > tolerance),
        "{failed}"
    );
    let failed = solve(&b, stop(1e-25, 100)).expect_err("round-off");
    assert!(failed.to_string().contains("round-off"), "{failed}");
    for (field, stop) in [
        ("relative", stop(f64::NAN, 9)),
        ("relative", stop(1.0, 9)),
        ("absolute", Stop { absolute: -1.0, ..Stop::default() }),
        ("iterations", stop(0.1, 0)),
        ("incompatible", Stop { incompatible: 2.0, ..Stop::default() }),
    ] {
        let failed = solve(&b, stop).expect_err(field);
        assert!(matches!(failed, SolveError::Setting { field: f, .. } if f == field), "{failed}");
    }
    let mut x = vec![0.0; b.len()];
    let failed = conjugate_gradients(&team, &stencil, &mut Negative, &b, &mut x, &Stop::default());
    assert!(matches!(failed, Err(SolveError::Preconditioner { value, .. }) if value < 0.0), "{failed:?}");
    let failed = minres(&team, &stencil, &mut Negative, &b, &mut x, &Stop::default());
    assert!(matches!(failed, Err(SolveError::Preconditioner { value, .. }) if value < 0.0), "{failed:?}");
    let failed = gmres(&team, &stencil, &mut Identity, &b, &mut x, 0, &Stop::default());
    assert!(matches!(failed, Err(SolveError::Setting { field: "restart", .. })), "{failed:?}");
}

#[test]
fn nothing_to_solve_is_solved() {
    let team = Team::one();
    let stencil = domains::stencil::<3>(&team, "ball", 16);
    let mut multigrid = Multigrid::new(&team, &stencil);
    let mut x = vec![0.0; stencil.len()];
    let zero = x.clone();
    let solved =
        conjugate_gradients(&team, &stencil, &mut multigrid, &zero, &mut x, &Stop::default()).expect("zero");
    assert_eq!((solved.iterations, solved.residual), (0, 0.0));
    let cells = Arc::new(CellBlocks::<2>::of_cells([]));
    let empty = Stencil::new(&team, cells, Default::default(), Vec::new()).expect("no cells");
    let mut multigrid = Multigrid::new(&team, &empty);
    let solved =
        conjugate_gradients(&team, &empty, &mut multigrid, &[], &mut [], &Stop::default()).expect("nothing");
    assert_eq!(solved.iterations, 0);
}

#[test]
fn invalid_stencils_are_refused() {
    let team = Team::one();
    let cells = Arc::new(CellBlocks::of_cells([[1, 1], [2, 1]]));
    let [a, b] = [[1, 1], [2, 1]].map(|c| cells.find(c).expect("a cell"));
    let create = |weight: f64, place: usize, diagonal: [f64; 2]| {
        let (mut w, mut d) = ([vec![0.0; 16], vec![0.0; 16]], vec![0.0; 16]);
        w[0][place] = weight;
        (d[a], d[b]) = (diagonal[0], diagonal[1]);
        Stencil::new(&team, cells.clone(), w, d)
    };
    assert_eq!(create(1.0, a, [1.0, 1.5]).expect("a pair").singular_regions(), 0);
    assert_eq!(create(1.0, a, [1.0, 1.0]).expect("a closed pair").singular_regions(), 1);
    for (name, place, found) in [
        ("weight", [1, 1], create(-1.0, a, [1.0, 1.0])),
        ("weight", [1, 1], create(f64::NAN, a, [1.0, 1.0])),
        ("weight", [2, 1], create(1.0, b, [1.0, 1.0])),
        ("diagonal", [2, 1], create(1.0, a, [1.0, 0.9])),
        ("diagonal", [1, 1], create(0.0, a, [f64::INFINITY, 1.0])),
        ("diagonal", [2, 1], create(0.0, a, [1.0, -1.0])),
    ] {
        let said = found.expect_err(name);
        assert!(
            matches!(&said, StencilError::Entry { field, cell, .. } if *field == name && *cell == place),
            "{said}"
        );
    }
    let short = Stencil::new(&team, cells.clone(), [vec![0.0; 16], vec![0.0; 15]], vec![0.0; 16]);
    assert_eq!(short.expect_err("a length"), StencilError::Length { field: "weights", value: 15, cells: 16 });
}
