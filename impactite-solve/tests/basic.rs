//! Smoke test.
use impactite_simd::Team;
use impactite_solve::*;
use std::sync::Arc;

#[test]
fn poisson() {
    let n = 16;
    let list: Vec<[i32; 3]> = (0..n * n * n).map(|i| [i % n, i / n % n, i / n / n]).collect();
    let cells = Arc::new(CellBlocks::of_cells(list.iter().copied()));
    let team = Team::one();
    for closed in [false, true] {
        let mut w = [0, 1, 2].map(|_| vec![0.0; cells.cells()]);
        let mut d = vec![0.0; cells.cells()];
        for c in &list {
            let s = cells.find(*c).unwrap();
            for a in 0..3 {
                for up in [false, true] {
                    let mut m = *c;
                    m[a] += if up { 1 } else { -1 };
                    let inside = (0..n).contains(&m[a]);
                    if inside && up {
                        w[a][s] = 1.0;
                    }
                    d[s] += if inside {
                        1.0
                    } else if closed {
                        0.0
                    } else {
                        2.0
                    };
                }
            }
        }
        let a = Stencil::new(&team, cells.clone(), w, d).unwrap();
        assert_eq!((a.singular_regions(), a.unknowns()), (usize::from(closed), 4096));
        let mut b: Vec<f64> = (0..cells.cells()).map(|i| (i as f64).sin()).collect();
        a.project(&team, &mut b);
        let mut x = vec![0.0; b.len()];
        let mut m = Multigrid::new(&team, &a);
        let s = conjugate_gradients(&team, &a, &mut m, &b, &mut x, &Stop::default()).unwrap();
        println!("{s:?}");
        assert!(s.iterations < 90);
    }
}
