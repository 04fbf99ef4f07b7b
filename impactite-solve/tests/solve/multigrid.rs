//! Iterations of the multigrid preconditioner, and equal bits for any number of threads.

use impactite_simd::Team;
use impactite_solve::{Multigrid, Operator, Preconditioner, Stop, conjugate_gradients};

use crate::domains;

/// Iterations for a noisy and for a smooth right-hand side.
fn iterations<const D: usize>(team: &Team, name: &str, n: i32) -> usize {
    let stencil = domains::stencil::<D>(team, name, n);
    let mut multigrid = Multigrid::new(team, &stencil);
    let solve = |smooth| {
        let b = domains::source(team, &stencil, n, smooth);
        let mut x = vec![0.0; b.len()];
        let solved = conjugate_gradients(team, &stencil, &mut multigrid, &b, &mut x, &Stop::default());
        solved.unwrap_or_else(|e| panic!("{D}D {name} {n}: {e}")).iterations
    };
    [false, true].map(solve).into_iter().max().expect("two")
}

#[test]
fn iterations_do_not_depend_on_the_size() {
    let team = Team::ambient();
    for name in domains::FLUIDS {
        for n in [16, 32, 64] {
            let count = iterations::<3>(&team, name, n);
            assert!(count <= 10, "3D {name} {n}: {count} iterations");
        }
        for n in [32, 128, 256] {
            let count = iterations::<2>(&team, name, n);
            assert!(count <= 11, "2D {name} {n}: {count} iterations");
        }
    }
}

#[test]
fn jumps_of_the_density_take_a_few_more_iterations() {
    let team = Team::ambient();
    for n in [16, 64] {
        let count = iterations::<3>(&team, "jump 1000", n);
        assert!(count <= 12, "3D {n}: {count} iterations");
    }
    for n in [32, 256] {
        let count = iterations::<2>(&team, "jump 1000", n);
        assert!(count <= 14, "2D {n}: {count} iterations");
    }
}

/// Bits of a solution, and the number of iterations.
fn bits<const D: usize>(threads: usize, name: &str, n: i32) -> (Vec<u64>, usize) {
    let team = Team::new(threads).expect("threads");
    let stencil = domains::stencil::<D>(&team, name, n);
    let b = domains::source(&team, &stencil, n, false);
    let mut x = vec![0.0; b.len()];
    let mut multigrid = Multigrid::new(&team, &stencil);
    let solved = conjugate_gradients(&team, &stencil, &mut multigrid, &b, &mut x, &Stop::default())
        .expect("a solution");
    (x.iter().map(|x| x.to_bits()).collect(), solved.iterations)
}

#[test]
fn solutions_have_equal_bits_for_any_number_of_threads() {
    for name in ["closed tank", "splash"] {
        let one = (bits::<2>(1, name, 200), bits::<3>(1, name, 40));
        for threads in [2, 3, 5] {
            assert!(
                (bits::<2>(threads, name, 200), bits::<3>(threads, name, 40)) == one,
                "{name}: {threads} threads"
            );
        }
    }
}

#[test]
fn memory_of_another_operator_leaves_no_trace() {
    let team = Team::one();
    let stencils = [("obstacle", 40), ("splash", 64), ("ball", 12)]
        .map(|(name, n)| domains::stencil::<3>(&team, name, n));
    let mut renewed = Multigrid::new(&team, &stencils[0]);
    for stencil in stencils.iter().cycle().take(5) {
        let b = domains::source(&team, stencil, 40, false);
        let apply = |multigrid: &mut Multigrid<3>| {
            let mut z = vec![f64::NAN; b.len()];
            multigrid.apply(&team, &b, &mut z);
            z
        };
        renewed.renew(&team, stencil);
        assert!(apply(&mut renewed) == apply(&mut Multigrid::new(&team, stencil)));
    }
}

#[test]
fn the_cycle_is_symmetric_and_positive() {
    let team = Team::one();
    for name in domains::NAMES {
        let stencil = domains::stencil::<2>(&team, name, 100);
        let mut multigrid = Multigrid::new(&team, &stencil);
        let [a, b] = [false, true].map(|smooth| domains::source(&team, &stencil, 100, smooth));
        let mut apply = |r: &[f64]| {
            let mut z = vec![0.0; r.len()];
            multigrid.apply(&team, r, &mut z);
            stencil.project(&team, &mut z);
            z
        };
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        let (za, zb) = (apply(&a), apply(&b));
        let (ab, ba, size) = (dot(&a, &zb), dot(&b, &za), (dot(&a, &za) * dot(&b, &zb)).sqrt());
        // Round-off of single precision, eps = 6e-8, in some ten operations of each cell.
        assert!(
            dot(&a, &za) > 0.0 && dot(&b, &zb) > 0.0 && (ab - ba).abs() < 1e-6 * size,
            "{name}: {ab:e} {ba:e} {size:e}"
        );
    }
}
