//! Scratch.
mod common;
use common::{H, lattice, rubber};
use mpm_contact::*;
use mpm_core::geometry::{Ball, Cuboid, Filling, Shape, fill};
use mpm_core::*;
fn go<const D: usize, M: Composition<f64, D>, K: mpm_core::Contact<f64, D>>(name: &str, method: M, contact: K, planes: &[usize]) {
    let mut mpm = Mpm::<f64, D, _, _, _>::with_contact(method, BlockGrid::new(lattice()), contact);
    let mut c = [0.0; D]; c[0] = 0.2; if !planes.contains(&1) { c[1] = 0.3; }
    if D == 3 && !planes.contains(&2) { c[2] = 0.3; }
    let mut lo = [-0.5; D]; let mut hi = [0.6; D]; lo[0] = 0.42; hi[0] = 0.6;
    for &p in planes { lo[p] = 0.0; hi[p] = 0.5; }
    let half = { let mut a = [-5.0; D]; let b = [5.0; D]; for &p in planes { a[p] = 0.0; } Cuboid::new(a, b).unwrap() };
    let ball = fill(&Ball::new(c, 0.2).unwrap().and(half), &lattice(), 2, &Filling::new()).unwrap();
    let plate = fill(&Cuboid::new(lo, hi).unwrap(), &lattice(), 2, &Filling::new()).unwrap();
    mpm.add("ball", rubber(), &ball, |_| { let mut v = [0.0; D]; v[0] = 3.0; v }).unwrap();
    mpm.add("plate", rubber(), &plate, |_| [0.0; D]).unwrap();
    for &axis in planes { mpm.bound(Boundary::Symmetry { axis, at: 0.0, side: Side::Above }).unwrap(); }
    let s = mpm.totals();
    let mut worst = [0.0f64; 3];
    for _ in 0..120 { mpm.step().unwrap(); let t = mpm.totals(); let l = mpm.ledger();
      for d in 0..D { worst[d] = worst[d].max((t.momentum[d] - s.momentum[d] - l.impulse[d] - l.load[d] - l.dropped[d]).abs() / s.momentum_scale); } }
    eprintln!("{name} {D} {planes:?} {worst:?} nodes {}", mpm.contacts().iter().map(|p| p.nodes).sum::<usize>());
}
#[test]
fn scratch() {
    let d = || GridContact::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    go::<2, _, _>("hat", Method::new(Linear, Flip, Musl, PlaneStrain), d(), &[1]);
    go::<2, _, _>("quad", Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain), d(), &[1]);
    go::<2, _, _>("quad free", Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain), d(), &[]);
    go::<2, _, _>("cpgimp", Method::new(CpGimp, Flip, Musl, PlaneStrain), d(), &[1]);
    go::<2, _, _>("cpgimp reg", Method::new(CpGimp, Flip, Musl, PlaneStrain), GridContact::new(Regression, Pairs::new(Frictionless)), &[1]);
    go::<3, _, _>("quad", Method::new(QuadraticBSpline, Flip, Musl, FullSpace), d(), &[1]);
    go::<3, _, _>("quad", Method::new(QuadraticBSpline, Flip, Musl, FullSpace), d(), &[1, 2]);
    go::<3, _, _>("quad apic", Method::new(QuadraticBSpline, Apic, Usl, FullSpace), d(), &[1]);
    go::<3, _, _>("cpgimp free", Method::new(CpGimp, Flip, Musl, FullSpace), d(), &[]);
    go::<3, _, _>("cpgimp", Method::new(CpGimp, Flip, Musl, FullSpace), d(), &[1]);
    go::<3, _, _>("cpgimp reg", Method::new(CpGimp, Flip, Musl, FullSpace), GridContact::new(Regression, Pairs::new(Frictionless)), &[1]);
}
