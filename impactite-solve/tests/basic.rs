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

struct Dense(usize, Vec<f64>);
impl Operator for Dense {
    fn len(&self) -> usize {
        self.0
    }
    fn apply(&self, _: &Team, x: &[f64], y: &mut [f64]) {
        for i in 0..self.0 {
            y[i] = (0..self.0).map(|j| self.1[i * self.0 + j] * x[j]).sum();
        }
    }
}

#[test]
fn indefinite() {
    let n = 40;
    let mut m = vec![0.0; n * n];
    for i in 0..n {
        m[i * n + i] = if i % 2 == 0 { 2.0 + i as f64 } else { -1.0 - 0.3 * i as f64 };
        if i > 0 {
            m[i * n + i - 1] = 0.7;
            m[(i - 1) * n + i] = 0.7;
        }
    }
    let b: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
    let team = Team::one();
    let mut jac = Jacobi::new(&(0..n).map(|i| m[i * n + i].abs()).collect::<Vec<_>>());
    let stop = Stop { relative: 1e-12, ..Stop::default() };
    for pre in [false, true] {
        let op = Dense(n, m.clone());
        let mut x = vec![0.0; n];
        let mut y = vec![0.0; n];
        if pre {
            println!("{:?}", minres(&team, &op, &mut jac, &b, &mut x, &stop));
            println!("{:?}", gmres(&team, &op, &mut jac, &b, &mut y, 30, &stop));
        } else {
            println!("{:?}", minres(&team, &op, &mut Identity, &b, &mut x, &stop));
            println!("{:?}", gmres(&team, &op, &mut Identity, &b, &mut y, 30, &stop));
        }
        let e = x.iter().zip(&y).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        println!("{e:e}");
    }
}
