//! Single-point curves of the laws for docs/book/src/theory/curves.md.
//!
//! Run with `cargo run --release -p mpm-materials --example laws`. Each table is one point on one path; `tests/`
//! compares the curves with closed forms.

use std::error::Error;

use mpm_materials::driver::{Path, Step, Table, run};
use mpm_materials::{
    CohesiveSpall, Cone, Constitutive, DruckerPrager, Explosive, Fluid, Ground, JohnsonCookDamage, Jwl,
    Kinematics, Mat3, Moduli, MohrCoulomb, PlasticStrainLimit, Porous, Solid, library,
};
use mpm_materials::{J2, LogarithmicBulk, MieGruneisen};

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// Pressure and equivalent stress, MPa, in row `k`.
fn invariants(table: &Table<f64>, k: usize) -> (f64, f64) {
    let stress = &table.rows[k].stress;
    (-stress.mean() / 1e6, stress.deviator().equivalent() / 1e6)
}

fn column(table: &Table<f64>, name: &str) -> Outcome<Vec<f64>> {
    table.column(name).ok_or_else(|| format!("no column {name}").into())
}

/// Drive a point to the strain `end` at `rate` in 1000 steps.
fn drive<M: Constitutive<f64>>(
    law: &M,
    path: fn(f64) -> Path<f64>,
    end: f64,
    rate: f64,
) -> Outcome<Table<f64>> {
    let path = path(rate * end.signum());
    Ok(run(law, &path, Step { dt: end.abs() / rate / 1000.0, steps: 1000 })?)
}

fn uniaxial_strain(rate: f64) -> Path<f64> {
    Path::UniaxialStrain { rate }
}
fn uniaxial_stress(rate: f64) -> Path<f64> {
    Path::UniaxialStress { rate }
}
fn simple_shear(rate: f64) -> Path<f64> {
    Path::SimpleShear { rate }
}

fn metals() -> Outcome {
    println!(
        "## Metals: tension at 1000 /s\n\nAxial stress, MPa, by logarithmic strain; the point leaves the table when it fails.\n"
    );
    let aluminium = library::aluminium_6061_t6().with_failure(JohnsonCookDamage::aluminium_6061());
    let steel = library::steel_4340().with_failure(JohnsonCookDamage::steel_4340());
    let weldox = library::weldox_460_e();
    let tables = [
        ("6061-T6", drive(&aluminium, uniaxial_stress, 1.0, 1e3)?),
        ("4340", drive(&steel, uniaxial_stress, 1.0, 1e3)?),
        ("4340 Steinberg", drive(&library::steel_4340_steinberg(), uniaxial_stress, 1.0, 1e3)?),
        ("Weldox 460 E", drive(&weldox, uniaxial_stress, 1.0, 1e3)?),
        ("tungsten alloy", drive(&library::tungsten_alloy(), uniaxial_stress, 1.0, 1e3)?),
    ];
    let names: Vec<_> = tables.iter().map(|(name, _)| *name).collect();
    println!("| strain | {} |\n|---|{}", names.join(" | "), "---|".repeat(names.len()));
    for k in [5, 10, 20, 50, 100, 200, 300, 500, 800, 1000] {
        let stress = |table: &Table<f64>| {
            let axial = table.rows[k].stress.0[0] / 1e6;
            if axial > 1.0 { format!("{axial:.0}") } else { "-".into() }
        };
        let row: Vec<_> = tables.iter().map(|(_, table)| stress(table)).collect();
        println!("| {:.3} | {} |", k as f64 * 1e-3, row.join(" | "));
    }
    Ok(())
}

fn concrete() -> Outcome {
    println!("\n## Concrete of 48 MPa: compressed in uniaxial strain, 100 /s\n");
    let law = library::concrete_48();
    let table = drive(&law, uniaxial_strain, -0.25, 100.0)?;
    let (volume, damage) = (column(&table, "volume_ratio")?, column(&table, "damage")?);
    println!("| mu | pressure, MPa | equivalent stress, MPa | damage |\n|---|---|---|---|");
    for k in [2, 4, 10, 20, 50, 100, 200, 300, 400, 500, 700, 1000] {
        let (p, q) = invariants(&table, k);
        println!("| {:.4} | {p:.1} | {q:.1} | {:.3} |", 1.0 / volume[k] - 1.0, damage[k]);
    }
    Ok(())
}

fn soil() -> Outcome {
    println!("\n## Soil: unconfined compression, phi 30 degrees, c 10 kPa\n");
    let moduli = Moduli::young_poisson(70e6, 0.3)?;
    let (phi, c) = (30.0_f64.to_radians(), 10e3);
    let pyramid = Ground::new(MohrCoulomb::new(2100.0, moduli, phi, c, 0.0)?);
    println!("Axial stress, kPa. Mohr-Coulomb's strength is 2 c cos phi/(1 - sin phi) = 34.64 kPa.\n");
    println!(
        "| strain | Mohr-Coulomb | outer cone | inner cone | plane-strain cone |\n|---|---|---|---|---|"
    );
    let mut tables = vec![drive(&pyramid, uniaxial_stress, -2e-3, 1.0)?];
    for cone in [Cone::Outer, Cone::Inner, Cone::PlaneStrain] {
        let law = Ground::new(DruckerPrager::matching(2100.0, moduli, cone, phi, c, 0.0)?);
        tables.push(drive(&law, uniaxial_stress, -2e-3, 1.0)?);
    }
    for k in [100, 150, 200, 250, 300, 500, 1000] {
        let row: Vec<_> = tables.iter().map(|t| format!("{:.2}", t.rows[k].stress.0[0] / 1e3)).collect();
        println!("| {:.1e} | {} |", k as f64 * 2e-6, row.join(" | "));
    }
    Ok(())
}

fn explosive() -> Outcome {
    println!("\n## TNT\n\nA point that the wave reaches at 1 microsecond, at rest, in a cell of 1 mm:\n");
    let charge = Explosive::tnt();
    let mut state = charge.lit_after(1e-6)?;
    println!("| microseconds | burnt | pressure, GPa |\n|---|---|---|");
    for k in 1..=130 {
        let still = Kinematics { increment: Mat3::zero(), dt: 1e-8, length: 1e-3 };
        state = charge.update(&still, &state).state;
        if k % 5 == 0 && k >= 95 {
            let pressure = -charge.stress(&state).mean() / 1e9;
            println!("| {:.2} | {:.3} | {pressure:.2} |", f64::from(k) * 1e-2, state.burn_fraction);
        }
    }
    println!(
        "\nProducts burnt at constant volume, expanding:\n\n| V | pressure, GPa | energy left, GJ/m^3 |\n|---|---|---|"
    );
    let products = Fluid::new(Jwl::<f64>::tnt());
    let table = run(&products, &Path::Isotropic { rate: 1.0 }, Step { dt: 2.5e-3, steps: 1000 })?;
    let (volume, energy) = (column(&table, "volume_ratio")?, column(&table, "energy")?);
    for k in [0, 40, 80, 160, 280, 440, 640, 920] {
        println!("| {:.2} | {:.3} | {:.2} |", volume[k], invariants(&table, k).0 / 1e3, energy[k] / 1e9);
    }
    Ok(())
}

fn porous() -> Outcome {
    println!("\n## A porous solid, alpha_0 1.6, p_e 10 MPa, p_s 2 GPa: compressed and released\n");
    let solid = MieGruneisen::new(2650.0, 4000.0, 1.5, 1.0)?;
    let law = Porous::new(J2::linear(1e9, 1e6, 0.0)?, solid, 1.6, 1e7, 2e9)?;
    let squeeze = Mat3::identity() * -0.2;
    let there_and_back = Path::Tabulated(vec![(0.0, squeeze), (1.0, squeeze * -0.25)]);
    let table = run(&law, &there_and_back, Step { dt: 1e-3, steps: 1500 })?;
    let (volume, alpha) = (column(&table, "volume_ratio")?, column(&table, "distension")?);
    println!("| J | distension | pressure, MPa |\n|---|---|---|");
    for k in [10, 50, 100, 200, 400, 600, 700, 800, 900, 1000, 1050, 1200, 1400] {
        println!("| {:.3} | {:.3} | {:.1} |", volume[k], alpha[k], invariants(&table, k).0);
    }
    Ok(())
}

fn failure() -> Outcome {
    println!("\n## A sheared point that fails at a plastic strain of 0.2\n");
    let law = Solid::new(J2::linear(26e9, 300e6, 0.0)?, MieGruneisen::aluminium_6061())
        .with_failure(PlasticStrainLimit::new(0.2)?);
    let table = drive(&law, simple_shear, 0.6, 1.0)?;
    println!("| shear | stress, MPa | energy, MJ/m^3 |\n|---|---|---|");
    for k in [10, 100, 300, 500, 550, 600, 650, 700, 1000] {
        let row = &table.rows[k];
        println!("| {:.3} | {:.1} | {:.2} |", k as f64 * 6e-4, row.stress.0[5] / 1e6, row.energy / 1e6);
    }
    Ok(())
}

fn crack() -> Outcome {
    println!(
        "\n## Cracks of 1 GPa and 5 kJ/m^2 in cells of 10, 100 and 500 micrometres, pulled to all sides\n"
    );
    let spall = CohesiveSpall::of_work(1e9, 5e3)?;
    let law = Solid::new(J2::linear(26e9_f64, 300e6, 0.0)?, LogarithmicBulk::new(2700.0, 74e9)?)
        .with_failure(spall);
    let mut columns = Vec::new();
    for length in [1e-5_f64, 1e-4, 5e-4] {
        let step = Kinematics { increment: Mat3::identity() * 1e-7, dt: 1e-9, length };
        let (mut state, mut curve) = (law.virgin(), Vec::new());
        while !law.failed(&state) {
            state = law.update(&step, &state).state;
            curve.push((
                length * state.failure.crack_volume,
                law.stress(&state).mean(),
                length * law.energy(&state),
            ));
        }
        columns.push(curve);
    }
    println!(
        "| opening, micrometres | tension, MPa | energy an area, kJ/m^2: 10 | 100 | 500 |\n|---|---|---|---|---|"
    );
    for tenth in 0..10 {
        let opening = 1e-6 * f64::from(tenth);
        let at =
            |curve: &[(f64, f64, f64)]| curve.iter().copied().find(|c| c.0 > opening).unwrap_or_default();
        let [small, middle, large] = [&columns[0], &columns[1], &columns[2]].map(|c| at(c));
        let energies = [small.2, middle.2, large.2].map(|e| format!("{:.2}", e / 1e3)).join(" | ");
        println!("| {tenth} | {:.0} | {energies} |", middle.1 / 1e6);
    }
    let left =
        columns.iter().filter_map(|c| c.last()).map(|c| format!("{:.2}", c.2 / 1e3)).collect::<Vec<_>>();
    println!("| failed | 0 | {} |", left.join(" | "));
    Ok(())
}

fn main() -> Outcome {
    println!("# Single-point curves\n");
    println!(
        "Printed by `cargo run --release -p mpm-materials --example laws`. The laws are described where they are"
    );
    println!("defined, their equations [here](laws.md), their constants [here](constants.md).\n");
    metals()?;
    concrete()?;
    soil()?;
    explosive()?;
    porous()?;
    failure()?;
    crack()
}
