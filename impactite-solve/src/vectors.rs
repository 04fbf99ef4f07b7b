//! Vector operations with equal bits for any number of threads.

use impactite_simd::Team;

/// Length of the pieces of vectors: one task of a loop and one term of a sum each. A multiple of the slots of a block.
pub(crate) const PIECE: usize = 4096;

const _: () = assert!(PIECE.is_multiple_of(64), "pieces consist of whole blocks");

/// Return the sum over pieces of `term(start, end)`, each in a task, added in the order of the pieces.
pub(crate) fn sum_pieces<const N: usize>(
    team: &Team,
    length: usize,
    term: impl Fn(usize, usize) -> [f64; N] + Send + Sync,
) -> [f64; N] {
    let mut sums = vec![[0.0; N]; length.div_ceil(PIECE)];
    team.each(&mut sums, |i, sum| *sum = term(i * PIECE, ((i + 1) * PIECE).min(length)));
    total(&sums)
}

/// Return the sum of terms in their order.
pub(crate) fn total<const N: usize>(sums: &[[f64; N]]) -> [f64; N] {
    let mut total = [0.0; N];
    for sum in sums {
        for k in 0..N {
            total[k] += sum[k];
        }
    }
    total
}

/// Run `task(start, piece)` on the pieces of a vector, with a sum of the returned terms in the order of the pieces.
pub(crate) fn update<const N: usize>(
    team: &Team,
    y: &mut [f64],
    task: impl Fn(usize, &mut [f64]) -> [f64; N] + Send + Sync,
) -> [f64; N] {
    let mut sums = vec![[0.0; N]; y.len().div_ceil(PIECE)];
    team.each_piece(y, PIECE, &mut sums, |i, piece, sum| *sum = task(i * PIECE, piece));
    total(&sums)
}

/// Dot product of a piece, by eight partial sums.
#[inline(always)]
pub(crate) fn dot_piece(x: &[f64], y: &[f64]) -> f64 {
    let (mut sums, (xs, x_rest), (ys, y_rest)) = ([0.0; 8], x.as_chunks::<8>(), y.as_chunks::<8>());
    for (x, y) in xs.iter().zip(ys) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    let mut rest = 0.0;
    for (x, y) in x_rest.iter().zip(y_rest) {
        rest += x * y;
    }
    ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7])) + rest
}

/// Dot product x . y.
pub(crate) fn dot(team: &Team, x: &[f64], y: &[f64]) -> f64 {
    sum_pieces(team, x.len(), |start, end| [dot_piece(&x[start..end], &y[start..end])])[0]
}

/// Euclidean norm of x, scaled against overflow and underflow where squares leave the range of numbers.
pub(crate) fn norm(team: &Team, x: &[f64]) -> f64 {
    let square = dot(team, x, x);
    if square.is_finite() && square > 1e-280 {
        return square.sqrt();
    }
    if let Some(v) = x.iter().find(|v| !v.is_finite()) {
        return v.abs();
    }
    let largest = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if largest == 0.0 {
        return 0.0;
    }
    let sum: f64 = x.iter().map(|v| (v / largest) * (v / largest)).sum();
    largest * sum.sqrt()
}

/// y <- y + a x.
pub(crate) fn add(team: &Team, y: &mut [f64], a: f64, x: &[f64]) {
    update(team, y, |start, piece| {
        for (y, x) in piece.iter_mut().zip(&x[start..]) {
            *y += a * x;
        }
        []
    });
}

/// y <- b - y.
pub(crate) fn subtract_from(team: &Team, b: &[f64], y: &mut [f64]) {
    update(team, y, |start, piece| {
        for (y, b) in piece.iter_mut().zip(&b[start..]) {
            *y = b - *y;
        }
        []
    });
}

/// y <- a y.
pub(crate) fn scale(team: &Team, y: &mut [f64], a: f64) {
    update(team, y, |_, piece| {
        piece.iter_mut().for_each(|y| *y *= a);
        []
    });
}

/// Largest magnitude of the entries of x.
pub(crate) fn largest(team: &Team, x: &[f64]) -> f64 {
    let mut tops = vec![0.0; x.len().div_ceil(PIECE)];
    team.each(&mut tops, |i, top| {
        let piece = &x[i * PIECE..((i + 1) * PIECE).min(x.len())];
        let (chunks, rest) = piece.as_chunks::<8>();
        let mut most = [0.0_f64; 8];
        for chunk in chunks {
            for k in 0..8 {
                let v = chunk[k].abs();
                most[k] = if v > most[k] { v } else { most[k] };
            }
        }
        *top = most.iter().chain(rest).fold(0.0, |m: f64, v| m.max(v.abs()));
    });
    tops.iter().fold(0.0, |m, v| m.max(*v))
}
