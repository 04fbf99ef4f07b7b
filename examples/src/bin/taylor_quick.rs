//! Quick look.
use mpm_core::geometry::*;
use mpm_core::*;
use mpm_materials::*;

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let cells: f64 = args[1].parse().unwrap();
    let m = args[2].as_str();
    let set = args[3].as_str();
    let axi = args[4] == "axi";
    let (r, l) = (3.8e-3, 25.4e-3);
    let h = r / cells;
    macro_rules! go {
        ($method:expr, $law:expr) => {
            if axi {
                let lattice = Lattice::new([0.0, 0.0], h).unwrap();
                let seeds = fill(
                    &Cuboid::new([0.0, 0.0], [r, l]).unwrap(),
                    &lattice,
                    2,
                    &Filling::new().axisymmetric(),
                )
                .unwrap();
                let mut mpm = Mpm::<f64, 2, _, _>::new($method(Axisymmetric), BlockGrid::new(lattice));
                mpm.add("bar", $law, &seeds, |_| [0.0, -190.0]).unwrap();
                mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
                mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
                run(mpm, &seeds, h, |x| (x[0], x[1]));
            }
        };
    }
    macro_rules! go3 {
        ($method:expr, $law:expr) => {
            if !axi {
                let lattice = Lattice::new([0.0, 0.0, 0.0], h).unwrap();
                let bar = Cylinder::new([0.0; 3], [0.0, 0.0, 1.0], l, r).unwrap();
                let quarter = bar.and(Cuboid::new([0.0; 3], [2.0 * r, 2.0 * r, l]).unwrap());
                let seeds = fill(&quarter, &lattice, 2, &Filling::new()).unwrap();
                let mut mpm = Mpm::<f64, 3, _, _>::new($method(FullSpace), BlockGrid::new(lattice));
                mpm.add("bar", $law, &seeds, |_| [0.0, 0.0, -190.0]).unwrap();
                mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
                mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).unwrap();
                mpm.bound(Boundary::Wall { axis: 2, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
                mpm.set_team(Team::new(2).unwrap());
                run(mpm, &seeds, h, |x| (x[0].hypot(x[1]), x[2]));
            }
        };
    }
    macro_rules! laws {
        ($go:ident, $method:expr) => {
            if set == "1" {
                $go!(
                    $method,
                    Solid::new(JohnsonCook::<f64>::copper_taylor(), MieGruneisen::copper())
                        .with_bulk_viscosity(0.06, 1.5)
                        .unwrap()
                )
            } else {
                $go!(
                    $method,
                    Solid::new(JohnsonCook::<f64>::copper(), MieGruneisen::copper())
                        .with_bulk_viscosity(0.06, 1.5)
                        .unwrap()
                )
            }
        };
    }
    match m {
        "musl" => {
            laws!(go, |e| Method::new(Linear, Flip, Musl, e));
            laws!(go3, |e| Method::new(Linear, Flip, Musl, e))
        }
        "gimp" => {
            laws!(go, |e| Method::new(Gimp, Flip, Usl, e));
            laws!(go3, |e| Method::new(Gimp, Flip, Usl, e))
        }
        "cpgimp" => {
            laws!(go, |e| Method::new(CpGimp, Flip, Usl, e));
            laws!(go3, |e| Method::new(CpGimp, Flip, Usl, e))
        }
        "quad" => {
            laws!(go, |e| Method::new(QuadraticBSpline, Apic, Usl, e));
            laws!(go3, |e| Method::new(QuadraticBSpline, Apic, Usl, e))
        }
        "bgimp" => {
            laws!(go, |e| Method::new(BoundaryModified(Gimp), Flip, Usl, e));
            laws!(go3, |e| Method::new(BoundaryModified(Gimp), Flip, Usl, e))
        }
        "bqmusl" => {
            laws!(go, |e| Method::new(BoundaryModified(QuadraticBSpline), Flip, Musl, e));
        }
        "qmusl" => {
            laws!(go, |e| Method::new(QuadraticBSpline, Flip, Musl, e));
        }
        "bqusl" => {
            laws!(go, |e| Method::new(BoundaryModified(QuadraticBSpline), Flip, Usl, e));
        }
        _ => panic!(),
    }
}

fn run<const D: usize, M: Composition<f64, D>, G: GridStorage<f64, D>>(
    mut mpm: Mpm<f64, D, M, G>,
    seeds: &Seeds<D>,
    h: f64,
    rz: impl Fn([f64; 3]) -> (f64, f64),
) {
    println!("{} {} particles", mpm.method().describe(), mpm.particles());
    let before = mpm.totals();
    let t = std::time::Instant::now();
    for k in 1..=16 {
        if let Err(e) = mpm.run_until(5e-6 * k as f64) {
            println!("{e}");
            return;
        }
    }
    let s = t.elapsed().as_secs_f64();
    let after = mpm.totals();
    let ledger = mpm.ledger();
    let (e0, e1) = (before.kinetic + before.internal, after.kinetic + after.internal);
    println!(
        "{} steps {s:.2} s {:.2} M/s; energy error {:.3e}, left kinetic {:.3e}; momentum error {:.2e}; bytes/p {:.0}",
        mpm.steps(),
        mpm.steps() as f64 * mpm.particles() as f64 / s / 1e6,
        (e1 - e0 - ledger.work) / e0,
        after.kinetic / e0,
        (after.momentum[D - 1] - before.momentum[D - 1] - ledger.impulse[D - 1] - ledger.dropped[D - 1])
            .abs()
            / before.momentum_scale,
        mpm.bytes() as f64 / mpm.particles() as f64
    );
    // profile
    let (big_r, big_l) = (3.8e-3, 25.4e-3);
    let layers = (big_l / (h / 2.0)).round() as usize;
    let mut fits = vec![[0.0f64; 7]; layers];
    mpm.bodies()[0].for_each(&mut |p| {
        let x0 = seeds.positions[p.number];
        let mut x = [0.0; 3];
        x[..D].copy_from_slice(&x0);
        let (r0, z0) = rz(x);
        let (r, z) = rz(p.position);
        let k = ((z0 / (h / 2.0)) - 0.5).round() as usize;
        let d = r0 - big_r;
        if d > -2.2 * h {
            let f = &mut fits[k];
            f[0] += 1.0;
            f[1] += d;
            f[2] += d * d;
            f[3] += r;
            f[4] += r * d;
            f[5] += z;
            f[6] += z * d;
        }
    });
    let prof: Vec<(f64, f64)> = fits
        .iter()
        .map(|f| {
            let det = f[0] * f[2] - f[1] * f[1];
            ((f[2] * f[3] - f[1] * f[4]) / det, (f[2] * f[5] - f[1] * f[6]) / det)
        })
        .collect();
    let ex = |a: (f64, f64), b: (f64, f64), c: (f64, f64)| {
        (1.875 * a.0 - 1.25 * b.0 + 0.375 * c.0, 1.875 * a.1 - 1.25 * b.1 + 0.375 * c.1)
    };
    let foot = ex(prof[0], prof[1], prof[2]);
    let n = layers;
    let top = ex(prof[n - 1], prof[n - 2], prof[n - 3]);
    let zw = 0.2 * big_l;
    let mut w = 0.0;
    for k in 0..n - 1 {
        let (a, b) = (prof[k], prof[k + 1]);
        if a.1 <= zw && b.1 > zw {
            w = a.0 + (b.0 - a.0) * (zw - a.1) / (b.1 - a.1);
        }
    }
    println!(
        "L {:.3} D {:.3} W {:.3}   foot z {:.3e} max D {:.3}",
        (top.1 - foot.1) * 1e3,
        foot.0 * 2e3,
        w * 2e3,
        foot.1,
        prof.iter().map(|p| p.0).fold(0.0, f64::max) * 2e3
    );
}
