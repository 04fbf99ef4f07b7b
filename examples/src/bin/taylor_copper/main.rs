//! wip
mod scene;
use examples::*;
use scene::*;
fn main() -> Result<(), CaseError> {
    let a: Vec<String> = std::env::args().collect();
    let cells: u32 = a[1].parse().unwrap();
    let folder = std::path::Path::new("/tmp/wcout/tc");
    std::fs::create_dir_all(folder).unwrap();
    for (name, space, parts, hardening) in [
        ("axi", Space::Axisymmetric, Parts::Consistent, 291.64e6),
        ("axi_lock", Space::Axisymmetric, Parts::Locking, 291.64e6),
        ("plane", Space::PlaneStrain, Parts::Consistent, 291.64e6),
        ("plane_lock", Space::PlaneStrain, Parts::Locking, 291.64e6),
        ("axi45", Space::Axisymmetric, Parts::Consistent, 45e6),
        ("printed", Space::PlaneStrain, Parts::Printed, 291.64e6),
        ("printed45", Space::PlaneStrain, Parts::Printed, 45e6),
    ] {
        if !a[2..].iter().any(|x| x == name) { continue; }
        let s = Setup { name, space, parts, hardening, cells, threads: 1 };
        let o = impact(&s, Files { folder, frames: 0 })?;
        println!("{name}: L {:.2} R {:.2} t {:.1} broke {:?} covered {:.4} de {:.4} dp {:.1e} steps {} wall {:.1}\n   {:?} added {:.4}",
            1e3*o.sizes[0], 1e3*o.sizes[1], 1e6*o.time, o.broke, o.covered, o.totals.energy_error, o.totals.momentum_error, o.totals.steps, o.totals.wall_seconds, o.audit, o.audit.energy_added()/o.start);
    }
    Ok(())
}
