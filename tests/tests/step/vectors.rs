//! The vector instructions of this processor and the portable packs compute the same: every operation of a
//! lane, bit for bit where it is exact.

use impactite_tests::scene::Numbers;
use mpm_core::parallel::{Arch, Float, Kernel, Pack};
use mpm_materials::{Lane, Mask};

/// All operations on three rows; a row of results each.
struct Operations<'a, T: Float>([&'a T::Row; 3]);

impl<T: Float> Kernel<T> for Operations<'_, T> {
    type Output = (Vec<T::Row>, Vec<u32>, Vec<[T; 4]>);

    #[inline(always)]
    fn run<A: Arch<T>>(self) -> Self::Output {
        let [a, b, c] = self.0.map(A::Pack::load);
        let rows = [
            a + b,
            a - b,
            a * b,
            a / b,
            -a,
            a.abs(),
            a.abs().sqrt(),
            a.min(b),
            a.max(b),
            A::Pack::select(a.lt(b), c, a),
            A::Pack::select(a.le(b) & b.lt(c), a, c),
            A::Pack::select(a.le(b) | !b.lt(c), a, c),
            a.clamp(b.min(c), b.max(c)),
            a.with_lane(1, T::of(0.5)),
            A::Pack::splat(b.lane(2)),
            // Not exact: last, see below.
            a.mul_add(b, c),
            a.exp(),
            (a.abs() + A::Pack::of(1e-3)).ln(),
            (a.abs() + A::Pack::of(1e-3)).powf(b),
        ];
        let bits = vec![
            A::Pack::bits(a.lt(b)),
            A::Pack::bits(a.is_finite()),
            A::Pack::bits(!(a.ge(b))),
            u32::from(a.lt(b).any()),
            u32::from(a.lt(b).lane(3)),
        ];
        let mut records = vec![[T::default(); 4]; A::Pack::WIDTH];
        A::Pack::records(a, b, c, a, &mut records);
        let rows = rows.map(|x| {
            let mut row = T::Row::default();
            x.store(&mut row);
            row
        });
        (rows.to_vec(), bits, records)
    }
}

const INEXACT: usize = 4;

fn check<T: Float>(inputs: &[[f64; 3]], tolerance: f64) {
    let mut rows = [T::Row::default(); 3];
    for lane in 0..T::GROUP {
        for k in 0..3 {
            rows[k].as_mut()[lane] = T::of(inputs[lane % inputs.len()][k]);
        }
    }
    let with = || Operations::<T>([&rows[0], &rows[1], &rows[2]]);
    let (fast, plain) = (T::dispatch(with()), T::portable(with()));
    assert_eq!(fast.1, plain.1, "masks for {inputs:?}");
    for (a, b) in fast.2.iter().flatten().zip(plain.2.iter().flatten()) {
        assert!(a == b || (a.to_double().is_nan() && b.to_double().is_nan()), "records for {inputs:?}");
    }
    let exact = fast.0.len() - INEXACT;
    for (n, (a, b)) in fast.0.iter().zip(&plain.0).enumerate() {
        for (lane, (x, y)) in a.as_ref().iter().zip(b.as_ref()).enumerate() {
            let same = x == y || (x.to_double().is_nan() && y.to_double().is_nan());
            let (p, q) = (x.to_double(), y.to_double());
            let near = (p - q).abs() <= tolerance * p.abs().max(q.abs()).max(1.0);
            assert!(same || (n >= exact && near), "operation {n}, lane {lane}: {p} against {q}; {inputs:?}");
        }
    }
}

#[test]
fn operations_agree() {
    let mut random = Numbers::new(3);
    for _ in 0..2000 {
        let mut inputs = [[0.0; 3]; 8];
        for x in inputs.iter_mut().flatten() {
            *x = 5.0 * random.draw();
        }
        check::<f64>(&inputs, 1e-14);
        check::<f32>(&inputs, 2e-6);
    }
}

#[test]
fn special_values_agree() {
    let special = [0.0, -0.0, 1.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e-300, 0.5];
    let mut random = Numbers::new(4);
    for _ in 0..500 {
        let mut inputs = [[0.0; 3]; 8];
        for x in inputs.iter_mut().flatten() {
            *x = special[((random.draw() + 1.0) * 4.5) as usize % special.len()];
        }
        // ln and exp are for finite numbers only.
        let finite = inputs.iter().all(|i| i.iter().all(|x| x.is_finite()));
        if finite {
            check::<f64>(&inputs, 1e-14);
        }
        compare_comparisons(&inputs);
    }
}

/// Minimum, maximum, comparison and selection with values that are not numbers.
fn compare_comparisons(inputs: &[[f64; 3]; 8]) {
    struct Compare<'a>([&'a <f64 as Float>::Row; 3]);
    impl Kernel<f64> for Compare<'_> {
        type Output = (Vec<<f64 as Float>::Row>, Vec<u32>);
        #[inline(always)]
        fn run<A: Arch<f64>>(self) -> Self::Output {
            let [a, b, c] = self.0.map(A::Pack::load);
            let rows =
                [a.min(b), a.max(b), A::Pack::select(a.lt(b), c, a), a.abs(), -a, a * b, a.clamp(b, c)];
            let bits = [a.lt(b), a.le(b), a.gt(b), a.ge(b), a.is_finite(), !a.lt(b)].map(A::Pack::bits);
            let rows = rows.map(|x| {
                let mut row = Default::default();
                x.store(&mut row);
                row
            });
            (rows.to_vec(), bits.to_vec())
        }
    }
    let mut rows = [<f64 as Float>::Row::default(); 3];
    for lane in 0..4 {
        for k in 0..3 {
            rows[k].as_mut()[lane] = inputs[lane][k];
        }
    }
    let with = || Compare([&rows[0], &rows[1], &rows[2]]);
    let (fast, plain) = (f64::dispatch(with()), f64::portable(with()));
    assert_eq!(fast.1, plain.1, "masks for {inputs:?}");
    for (n, (a, b)) in fast.0.iter().zip(&plain.0).enumerate() {
        for (x, y) in a.as_ref().iter().zip(b.as_ref()) {
            assert!(x == y || (x.is_nan() && y.is_nan()), "operation {n}: {x} against {y}; {inputs:?}");
        }
    }
}
