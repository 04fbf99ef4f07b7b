//! Agreement of all instruction sets of the processor.

use crate::lane::{Lane, Mask};

use super::{Arch, Band, Float, Kernel, Pack, Quad};

struct Functions<T>(Vec<T>);
macro_rules! kernel {
    ($t:ty) => {
        impl Kernel<$t> for Functions<$t> {
            type Output = Vec<[$t; 2]>;
            #[inline(always)]
            fn run<A: Arch<$t>>(self) -> Self::Output {
                let one = |x: $t| {
                    let v = A::Batch::splat(x);
                    [v.ln().lane(0), v.min(A::Batch::of(80.0)).exp().lane(1)]
                };
                self.0.into_iter().map(one).collect()
            }
        }
    };
}
kernel!(f64);
kernel!(f32);

#[test]
fn logarithm_and_exponential_are_accurate() {
    let x: Vec<f64> = (1..4000).map(|i| 1e-6 * f64::from(i) * f64::from(i) * 1.01).collect();
    for found in f64::each(|| Functions(x.clone())) {
        for (x, [ln, exp]) in x.iter().zip(found) {
            assert!((ln - x.ln()).abs() <= 4e-16 * x.ln().abs().max(1e-3), "ln {x}: {ln}");
            assert!((exp / x.min(80.0).exp() - 1.0).abs() < 5e-16, "exp {x}: {exp}");
        }
    }
    let x: Vec<f32> = x.iter().map(|&x| x as f32).collect();
    for found in f32::each(|| Functions(x.clone())) {
        for (x, [ln, exp]) in x.iter().zip(found) {
            assert!((ln - x.ln()).abs() <= 3e-7 * x.ln().abs().max(1e-1), "ln {x}: {ln}");
            assert!((exp / x.min(80.0).exp() - 1.0).abs() < 6e-7, "exp {x}: {exp}");
        }
    }
}

struct Orders;
impl Kernel<f64> for Orders {
    type Output = ();
    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let mut v = [A::Batch::zero(); 4];
        for i in 0..4 {
            for j in 0..A::Batch::WIDTH {
                v[i] = v[i].with_lane(j, (10 * i + j) as f64);
            }
        }
        let mut out = [[0.0; 4]; 8];
        A::Batch::records(v[0], v[1], v[2], v[3], &mut out);
        for j in 0..A::Batch::WIDTH {
            assert_eq!(out[j], [j as f64, 10.0 + j as f64, 20.0 + j as f64, 30.0 + j as f64]);
        }
        let nan = A::Batch::of(f64::NAN);
        let two = A::Batch::of(2.0);
        assert_eq!(two.min(nan).lane(1), 2.0);
        assert_eq!(two.max(nan).lane(1), 2.0);
        assert!(!nan.lt(two).any() && !two.le(nan).any());
        assert!((!two.lt(two)).all() && two.le(two).all());
    }
}

struct Sums;
macro_rules! sums {
    ($t:ty) => {
        impl Kernel<$t> for Sums {
            type Output = ();
            #[inline(always)]
            fn run<A: Arch<$t>>(self) {
                let mut of = [A::Batch::zero(); 4];
                let mut expected = [0.0; 4];
                for i in 0..4 {
                    for j in 0..A::Batch::WIDTH {
                        // Each lane has its own digit, so that no lane can replace another.
                        let x = ((i + 1) << (3 * j)) as $t;
                        of[i] = of[i].with_lane(j, x);
                        expected[i] += x;
                    }
                }
                let mut sums = [0.0; 4];
                A::sums(of).store(&mut sums);
                assert_eq!(sums, expected);
            }
        }
    };
}
sums!(f64);
sums!(f32);

struct Bands;
macro_rules! bands {
    ($t:ty) => {
        impl Kernel<$t> for Bands {
            type Output = ();
            #[inline(always)]
            fn run<A: Arch<$t>>(self) {
                let mut numbers = A::Batch::zero();
                let mut records = [[0.0; 4]; 8];
                for lane in 0..A::Batch::WIDTH {
                    numbers = numbers.with_lane(lane, (lane + 1) as $t);
                    for c in 0..4 {
                        records[lane][c] = (1 << (2 * lane + c)) as $t;
                    }
                }
                let mut weights = <A::Batch as Pack<$t>>::Numbers::default();
                numbers.store(&mut weights);
                for lane in (0..A::Batch::WIDTH).step_by(A::Band::RECORDS) {
                    let mut expected = records[lane];
                    for c in 0..4 {
                        expected[c] *= (lane + 1) as $t;
                        if A::Band::RECORDS == 2 {
                            expected[c] += (lane + 2) as $t * records[lane + 1][c];
                        }
                    }
                    let (mut sum, mut one) = ([0.0; 4], [0.0; 4]);
                    (A::Band::weights(&weights, lane) * A::Band::load(&records[lane..]))
                        .fold()
                        .store(&mut sum);
                    assert_eq!(sum, expected);
                    A::Band::widen(A::Quad::load(&records[lane])).fold().store(&mut one);
                    assert_eq!(one, records[lane]);
                }
            }
        }
    };
}
bands!(f64);
bands!(f32);

#[test]
fn bands_weigh_each_record_by_its_own_particle() {
    f64::each(|| Bands);
    f32::each(|| Bands);
}

#[test]
fn sums_take_every_lane_once() {
    f64::each(|| Sums);
    f32::each(|| Sums);
}

#[test]
fn vectors_and_plain_rust_agree_on_order_and_nan() {
    f64::each(|| Orders);
}
