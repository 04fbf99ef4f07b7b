//! The vector instructions of this processor and the portable packs compute the same: every operation of a
//! lane, bit for bit where it is exact.

use impactite_tests::scene::Numbers;
use mpm_core::parallel::{Arch, Float, Kernel, Pack};
use mpm_materials::{Lane, Mask};

/// All operations on three rows of eight numbers, with `functions` too; a row of results each.
struct Operations<'a, T: Float> {
    of: &'a [[T::Row; 2]; 3],
    functions: bool,
}

/// Rows of results, one group after the other, masks and records.
type Results<T> = (Vec<<T as Float>::Row>, Vec<u32>, Vec<[T; 4]>);

impl<T: Float> Kernel<T> for Operations<'_, T> {
    type Output = [Results<T>; 2];

    #[inline(always)]
    fn run<A: Arch<T>>(self) -> Self::Output {
        let mut results = [(vec![], vec![], vec![]), (vec![], vec![], vec![])];
        for first in (0..2).step_by(A::Batch::GROUPS) {
            let [a, b, c] = self.of.map(|rows| {
                let groups = [rows[first], rows[1]].map(|row| <A::Batch as Pack<T>>::Group::load(&row));
                A::Batch::join(groups)
            });
            let mut replaced = a;
            for lane in (1..A::Batch::WIDTH).step_by(T::GROUP) {
                replaced = replaced.with_lane(lane, b.lane(lane + 1));
            }
            let mut values = vec![
                a + b,
                a - b,
                a * b,
                a / b,
                -a,
                a.abs(),
                a.abs().sqrt(),
                a.min(b),
                a.max(b),
                A::Batch::select(a.lt(b), c, a),
                A::Batch::select(a.le(b) & b.lt(c), a, c),
                A::Batch::select(a.le(b) | !b.lt(c), a, c),
                a.clamp(b.min(c), b.max(c)),
                replaced,
                A::Batch::splat(T::of(0.3)),
            ];
            if self.functions {
                // Not exact: last, see below.
                let positive = a.abs() + A::Batch::of(1e-3);
                values.extend([a.mul_add(b, c), a.exp(), positive.ln(), positive.powf(b)]);
            }
            let masks = [a.lt(b), a.le(b), a.gt(b), a.ge(b), a.is_finite(), !a.lt(b)];
            let mut records = vec![[T::default(); 4]; A::Batch::WIDTH];
            A::Batch::records(a, b, c, a, &mut records);
            for group in 0..A::Batch::GROUPS {
                let (rows, bits, own) = &mut results[first + group];
                for value in &values {
                    let mut row = T::Row::default();
                    value.part()[group].store(&mut row);
                    rows.push(row);
                }
                let lanes = group * T::GROUP..(group + 1) * T::GROUP;
                for mask in masks {
                    bits.push(A::Batch::bits(mask) >> lanes.start & ((1 << T::GROUP) - 1));
                    bits.extend(lanes.clone().map(|lane| u32::from(mask.lane(lane))));
                    if A::Batch::GROUPS == 1 {
                        bits.push(u32::from(mask.any()));
                    } else {
                        bits.push(u32::from(lanes.clone().any(|lane| mask.lane(lane))));
                        assert_eq!(mask.any(), A::Batch::bits(mask) != 0);
                    }
                }
                own.extend_from_slice(&records[lanes]);
            }
        }
        results
    }
}

const INEXACT: usize = 4;

fn check<T: Float>(inputs: &[[f64; 3]; 16], functions: bool, tolerance: f64) {
    let mut of = [[T::Row::default(); 2]; 3];
    for lane in 0..2 * T::GROUP {
        for k in 0..3 {
            of[k][lane / T::GROUP].as_mut()[lane % T::GROUP] = T::of(inputs[lane][k]);
        }
    }
    let found = T::each(|| Operations { of: &of, functions });
    let same = |x: T, y: T| x == y || (x.to_double().is_nan() && y.to_double().is_nan());
    for (fast, plain) in found[1..].iter().flat_map(|fast| fast.iter().zip(&found[0])) {
        assert_eq!(fast.1, plain.1, "masks for {inputs:?}");
        for (a, b) in fast.2.iter().flatten().zip(plain.2.iter().flatten()) {
            assert!(same(*a, *b), "records for {inputs:?}");
        }
        let exact = fast.0.len() - if functions { INEXACT } else { 0 };
        for (n, (a, b)) in fast.0.iter().zip(&plain.0).enumerate() {
            for (lane, (&x, &y)) in a.as_ref().iter().zip(b.as_ref()).enumerate() {
                let (p, q) = (x.to_double(), y.to_double());
                let near = (p - q).abs() <= tolerance * p.abs().max(q.abs()).max(1.0);
                let fine = same(x, y) || (n >= exact && near);
                assert!(fine, "operation {n}, lane {lane}: {p} against {q}; {inputs:?}");
            }
        }
    }
}

#[test]
fn operations_agree() {
    let mut random = Numbers::new(3);
    for _ in 0..2000 {
        let mut inputs = [[0.0; 3]; 16];
        for x in inputs.iter_mut().flatten() {
            *x = 5.0 * random.draw();
        }
        check::<f64>(&inputs, true, 1e-14);
        check::<f32>(&inputs, true, 2e-6);
    }
}

#[test]
fn special_values_agree() {
    let special = [0.0, -0.0, 1.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e-300, 0.5];
    let mut random = Numbers::new(4);
    for _ in 0..500 {
        let mut inputs = [[0.0; 3]; 16];
        for x in inputs.iter_mut().flatten() {
            *x = special[((random.draw() + 1.0) * 4.5) as usize % special.len()];
        }
        // Functions are for finite numbers only.
        check::<f64>(&inputs, false, 0.0);
        check::<f32>(&inputs, false, 0.0);
    }
}
