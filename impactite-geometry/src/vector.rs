//! Vector functions on `[f64; D]`.

pub(super) fn sub<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    let mut c = a;
    for i in 0..D {
        c[i] -= b[i];
    }
    c
}

pub(super) fn add<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    let mut c = a;
    for i in 0..D {
        c[i] += b[i];
    }
    c
}

/// `a + s b`.
pub(super) fn along<const D: usize>(a: [f64; D], s: f64, b: [f64; D]) -> [f64; D] {
    let mut c = a;
    for i in 0..D {
        c[i] += s * b[i];
    }
    c
}

pub(super) fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    let mut s = 0.0;
    for i in 0..D {
        s += a[i] * b[i];
    }
    s
}

pub(super) fn norm<const D: usize>(a: [f64; D]) -> f64 {
    dot(a, a).sqrt()
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Compensated sum (Neumaier): the rounding error does not grow with the number of terms.
pub(super) fn sum(terms: impl IntoIterator<Item = f64>) -> f64 {
    let (mut total, mut lost) = (0.0f64, 0.0f64);
    for x in terms {
        let next = total + x;
        lost += if total.abs() >= x.abs() { (total - next) + x } else { (x - next) + total };
        total = next;
    }
    total + lost
}
