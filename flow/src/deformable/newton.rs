//! Quasi-Newton method for a fixed point S(W) = W by least squares over earlier changes (\[Degroote2009\]).
//!
//! With the residual r = S(W) - W and its changes V, and the changes U of S, the next iterate is S(W) + U c, where c minimises |V c + r|. Changes
//! that depend on newer ones are passed over. Changes of earlier steps are not used: with other step sizes and faces they cost iterations.

/// Part of a change, beside newer ones, below which it depends on them.
const DEPENDS: f64 = 1e-4;
/// Relaxation of an iteration without changes.
const RELAXATION: f64 = 0.3;

/// Changes of residual and answer between the iterates of a step, newest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Newton {
    list: Vec<Column>,
    last: Option<(Vec<f64>, Vec<f64>)>,
}

#[derive(Clone, Debug)]
struct Column {
    residual: Vec<f64>,
    answer: Vec<f64>,
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
fn change(to: &[f64], from: &[f64]) -> Vec<f64> {
    to.iter().zip(from).map(|(a, b)| a - b).collect()
}

impl Newton {
    /// Return the next iterate by the answer S(W) to the iterate W.
    pub fn next(&mut self, iterate: &[f64], answer: &[f64]) -> Vec<f64> {
        let residual = change(answer, iterate);
        if let Some((before, from)) = self.last.replace((residual.clone(), answer.to_vec())) {
            let column = Column { residual: change(&residual, &before), answer: change(answer, &from) };
            self.list.insert(0, column);
        }
        // Gram-Schmidt with each column twice.
        let (mut basis, mut rows, mut used): (Vec<Vec<f64>>, Vec<Vec<f64>>, Vec<usize>) = Default::default();
        for (n, column) in self.list.iter().enumerate().take(residual.len()) {
            let mut v = column.residual.clone();
            let length = product(&v, &v).sqrt();
            let mut row = vec![0.0; basis.len()];
            for _ in 0..2 {
                for (q, r) in basis.iter().zip(&mut row) {
                    let along = product(q, &v);
                    *r += along;
                    v.iter_mut().zip(q).for_each(|(v, q)| *v -= along * q);
                }
            }
            let rest = product(&v, &v).sqrt();
            if rest > DEPENDS * length {
                v.iter_mut().for_each(|v| *v /= rest);
                row.push(rest);
                basis.push(v);
                rows.push(row);
                used.push(n);
            }
        }
        if used.is_empty() {
            return iterate.iter().zip(&residual).map(|(w, r)| w + RELAXATION * r).collect();
        }
        // R c = -Q^T r, where `rows` has the columns of R.
        let mut c: Vec<f64> = basis.iter().map(|q| -product(q, &residual)).collect();
        for j in (0..c.len()).rev() {
            c[j] /= rows[j][j];
            for i in 0..j {
                c[i] -= rows[j][i] * c[j];
            }
        }
        let mut next = answer.to_vec();
        for (c, n) in c.iter().zip(used) {
            next.iter_mut().zip(&self.list[n].answer).for_each(|(x, u)| *x += c * u);
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_problem_of_n_unknowns_takes_n_iterations() {
        // S(W) = b - A W with the gains 0.5, 4, 30: plain iteration diverges.
        let gains = [0.5, 4.0, 30.0, 1.0];
        let answer = |w: &[f64]| -> Vec<f64> {
            let mixed = w[0] + w[1];
            vec![
                1.0 - gains[0] * mixed,
                2.0 - gains[1] * w[1],
                -3.0 - gains[2] * w[2] + 0.1 * w[0],
                0.3 - gains[3] * w[3],
            ]
        };
        let (mut newton, mut w) = (Newton::default(), vec![0.0; 4]);
        for n in 0..20 {
            let s = answer(&w);
            let r = change(&s, &w);
            if product(&r, &r).sqrt() < 1e-11 {
                assert!(n <= 6, "{n}");
                return;
            }
            w = newton.next(&w, &s);
        }
        panic!("{w:?}");
    }
}
