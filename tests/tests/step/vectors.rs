//! Bitwise equality of vector instructions of this processor and portable packs, for every exact lane operation.

use impactite_tests::scene::Numbers;
use mpm_core::parallel::{Arch, Float, Kernel, Pack, Vectors};
use mpm_materials::{Lane, Mask};

/// All lane operations on three rows of eight numbers, with `functions` optional; one row of results per operation.
struct Operations<'a, T: Float> {
    of: &'a [[T::Row; 2]; 3],
    functions: bool,
}

/// Result rows, group by group; masks as bits, as lanes, and as any-lane flag; and records.
type Results<T> = (Vec<<T as Float>::Row>, Vec<[u32; 3]>, Vec<[T; 4]>);

fn same<T: Float>(x: T, y: T) -> bool {
    x == y || (x.to_double().is_nan() && y.to_double().is_nan())
}

impl<T: Float> Kernel<T> for Operations<'_, T> {
    const VECTORS: Vectors = Vectors::Avx512;
    type Output = [Results<T>; 2];

    #[inline(always)]
    fn run<A: Arch<T>>(self) -> Self::Output {
        let mut results = [(vec![], vec![], vec![]), (vec![], vec![], vec![])];
        // Lanes of a group in a vector: all, or one after the other.
        let width = A::Batch::WIDTH.min(T::GROUP);
        let places = (0..2).step_by(A::Batch::GROUPS);
        for (first, lane) in
            places.flat_map(|first| (0..T::GROUP).step_by(width).map(move |lane| (first, lane)))
        {
            let [a, b, c] = self.of.map(|rows| A::Batch::from_rows([&rows[first], &rows[1]], lane));
            let mut replaced = a;
            if (lane..lane + width).contains(&1) {
                for group in 0..A::Batch::GROUPS {
                    let at = group * width + 1 - lane;
                    let next = if width > 1 { b.lane(at + 1) } else { self.of[1][first].as_ref()[lane + 1] };
                    replaced = replaced.with_lane(at, next);
                }
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
                // Inexact functions come last, see below.
                let positive = a.abs() + A::Batch::of(1e-3);
                values.extend([a.mul_add(b, c), a.exp(), positive.ln(), positive.powf(b)]);
            }
            let masks = [a.lt(b), a.le(b), a.gt(b), a.ge(b), a.is_finite(), !a.lt(b)];
            let mut records = vec![[T::default(); 4]; A::Batch::WIDTH];
            A::Batch::records(a, b, c, a, &mut records);
            for group in 0..A::Batch::GROUPS {
                let (rows, bits, own) = &mut results[first + group];
                rows.resize(values.len(), T::Row::default());
                bits.resize(masks.len(), [0; 3]);
                let start = group * width;
                for (value, row) in values.iter().zip(rows) {
                    value.to_row(group, row, lane);
                    let mut numbers = <A::Batch as Pack<T>>::Numbers::default();
                    value.store(&mut numbers);
                    let again = A::Batch::load(&numbers);
                    for n in 0..width {
                        let (x, stored) = (row.as_ref()[lane + n], numbers.as_ref()[start + n]);
                        assert!(
                            same(x, stored) && same(x, again.lane(start + n)),
                            "lane {n} of group {group}"
                        );
                    }
                }
                for (mask, found) in masks.into_iter().zip(bits) {
                    found[0] |= (A::Batch::bits(mask) >> start & ((1 << width) - 1)) << lane;
                    for n in 0..width {
                        found[1] |= u32::from(mask.lane(start + n)) << (lane + n);
                    }
                    if A::Batch::GROUPS == 1 {
                        found[2] |= u32::from(mask.any());
                    } else {
                        found[2] |= u32::from((start..start + width).any(|lane| mask.lane(lane)));
                        assert_eq!(mask.any(), A::Batch::bits(mask) != 0);
                    }
                }
                own.extend_from_slice(&records[start..start + width]);
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
        // Functions accept finite numbers only.
        check::<f64>(&inputs, false, 0.0);
        check::<f32>(&inputs, false, 0.0);
    }
}
