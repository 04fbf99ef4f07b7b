//! Three stacked blocks come to rest and stay at rest.
//!
//! `cargo test --release -p mpm-core --test contact -- --ignored --nocapture stacks_by_method` prints the table of
//! book, "Methods compared".

use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
use mpm_core::{
    Aflip, Apic, BlockGrid, CpGimp, Flip, GridContact, IntoKernels, Kernels, Linear, Method, Mls, Mpm, Musl,
    PlaneStrain, QuadraticBSpline, Rigid, Twist, Usl, Watch,
};

use crate::common::{cuboid, lattice, rubber};

/// Return the kinetic energy over its scale, 0.57 J a metre, after some steps.
fn stack(method: Kernels<f64, 2>, steps: [u64; 4]) -> Result<Vec<f64>, String> {
    let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3).expect("law")));
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice()), contact);
    for i in 0..3 {
        let low = 0.2 * f64::from(i);
        mpm.add(&format!("block {i}"), rubber(), &cuboid([0.0, low], [0.4, low + 0.2]), |_| [0.0; 2])
            .expect("block");
    }
    let still = Rigid::prescribed(1000.0, |_| Twist::along([0.0; 2])).expect("rigid");
    mpm.add_rigid("floor", &still, &cuboid([-0.2, -0.2], [0.6, 0.0])).expect("floor");
    // A weight applied at once would make the stack vibrate.
    mpm.set_body_force(|t| [0.0, -9.81 * t.min(1.0)]);
    // Failing runs continue to their end.
    mpm.set_watch(Watch::default().only_warn());
    let mut energies = Vec::new();
    for count in steps {
        while mpm.steps() < count {
            mpm.step().map_err(|e| e.to_string())?;
        }
        energies.push(mpm.totals().kinetic / 0.57);
    }
    Ok(energies)
}

#[test]
fn a_stack_comes_to_rest() {
    let apic =
        stack(Method::contact_at_rest(PlaneStrain).into_kernels(), [2000, 4000, 8000, 16_000]).expect("run");
    assert!(apic[3] < 1e-6, "kinetic energy {apic:?}");
    let impact = stack(Method::impact(PlaneStrain).into_kernels(), [2000, 4000, 8000, 16_000]).expect("run");
    assert!(impact[3] < 1e-4, "kinetic energy {impact:?}");
}

#[test]
#[ignore = "a study of minutes, not a test"]
fn stacks_by_method() {
    for (name, method) in [
        ("AFLIP", Method::new(QuadraticBSpline, Aflip::default(), Usl, PlaneStrain).into_kernels()),
        ("APIC", Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain).into_kernels()),
        ("MLS-APIC", Method::new(QuadraticBSpline, Mls, Usl, PlaneStrain).into_kernels()),
        ("quadratic FLIP MUSL", Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain).into_kernels()),
        ("cpGIMP FLIP MUSL", Method::new(CpGimp, Flip, Musl, PlaneStrain).into_kernels()),
        ("linear FLIP MUSL", Method::new(Linear, Flip, Musl, PlaneStrain).into_kernels()),
    ] {
        match stack(method, [1000, 10_000, 30_000, 100_000]) {
            Ok(energies) => println!(
                "{name}: kinetic energy over the scale {}",
                energies.iter().map(|e| format!("{e:.1e}")).collect::<Vec<_>>().join(", ")
            ),
            Err(e) => println!("{name}: {e}"),
        }
    }
}
