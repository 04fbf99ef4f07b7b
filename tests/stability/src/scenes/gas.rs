//! Strong shocks.

use mpm_core::{Boundary, Deformable, Side, TimeControl};
use mpm_materials::{Fluid, IdealGas, Nothing};
use verification::Scheme;
use verification::empty::{GasState, empty_gas_scene};
use verification::problems::{box_of_planes, lattice};
use verification::scene::{block, worse};

use crate::stage::{
    ApicUsl, CpGimp, Cubic, FlipMusl, FlipUsl, Fmpm4Usl, Linear, Quadratic, bound, particles, steps, text, ul,
};
use crate::verdict::{Limit, Measured, Scene, Size};

/// Gas that hits a plane at speed 1, and the state behind the reflected shock.
#[derive(Clone, Copy)]
struct Shock {
    gamma: f64,
    pressure: f64,
    /// State behind the shock: density, pressure, and shock speed away from the plane.
    density: f64,
    behind: f64,
    speed: f64,
}

/// Noh's planar problem: cold gas, gamma 5/3.
const NOH: Shock =
    Shock { gamma: 5.0 / 3.0, pressure: 1e-6, density: 4.0, behind: 4.0 / 3.0, speed: 1.0 / 3.0 };

/// Shock of Mach 10, gamma 1.4 (Rankine-Hugoniot: rho = 2.4 M^2 / (0.4 M^2 + 2), p = p0 (1 + 2.8/2.4 (M^2 - 1)), and the
/// speed behind it, 1, is c0 (M - 1/M) / 1.2).
fn mach_ten() -> Shock {
    let m: f64 = 10.0;
    let sound = 1.2 / (m - 1.0 / m);
    let pressure = sound * sound / 1.4;
    Shock {
        gamma: 1.4,
        pressure,
        density: 2.4 * m * m / (0.4 * m * m + 2.0),
        behind: pressure * (1.0 + 2.8 / 2.4 * (m * m - 1.0)),
        speed: m * sound - 1.0,
    }
}

/// Measure of a shock.
#[derive(Clone, Copy)]
enum Asked {
    /// Profile error, the worse of: density error of the plateau over 3 %, pressure overshoot over 5 %.
    Profile,
    /// Wall heating: error of the specific internal energy in the first cell.
    Heating,
}

fn run(asked: Asked, shock: Shock, scheme: Scheme, q: (f64, f64)) -> Result<Measured, String> {
    let cells = 200;
    let h = 1.0 / cells as f64;
    let lattice = lattice([0.0; 2], h)?;
    // The linear term of q uses the sound speed of the reference state: that behind the shock, since it is almost zero ahead.
    let gas = IdealGas::new(1.0, shock.gamma, shock.behind / shock.density).map_err(text)?;
    let law = Fluid::new(gas).with_bulk_viscosity(q.0, q.1).map_err(text)?;
    let seeds = block(&lattice, [0; 2], [cells, 1], 2);
    let mut mpm = empty_gas_scene(scheme, lattice).ok_or("no such composition")?;
    let energy = shock.pressure / (shock.gamma - 1.0);
    let state = |_: [f64; 2]| GasState {
        volume_ratio: 1.0,
        energy,
        viscous_stress: Nothing,
        viscous_pressure: 0.0,
        viscous_heat: Nothing,
    };
    mpm.add_body(Deformable::new("gas", law, &seeds).moving(|_| [-1.0, 0.0]).in_state(state))
        .map_err(text)?;
    bound(&mut mpm, vec![Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }])?;
    bound(&mut mpm, box_of_planes(1..2, 0.0, h))?;
    let start = mpm.totals();
    let (end, dt) = (0.6, 0.2 * h);
    mpm.set_time_control(TimeControl::Fixed(dt)).map_err(text)?;
    let count = (end / dt).round() as u64;
    let stop = steps(&mut mpm, count, |_, _| {});
    if stop.is_some() {
        return Ok(Measured::new(f64::NAN, count).stopped(stop));
    }
    let t = mpm.totals();
    let lost = (t.kinetic + t.internal - start.kinetic - start.internal) / start.kinetic;
    let front = shock.speed * end;
    let (mut density, mut n, mut most, mut heat, mut first) = (0.0, 0.0, 0.0f64, 0.0, 0.0);
    for p in particles(&mpm) {
        let x = p.position[0];
        let pressure = p.pressure();
        if x > 0.3 * front && x < 0.8 * front {
            density += p.mass / p.volume;
            n += 1.0;
        }
        // First cell excluded: its measure is wall heating.
        if x > 2.0 * h && x < 0.9 * front {
            most = most.max(pressure);
        }
        if x < h {
            // Specific internal energy by the equation of state, p / (gamma - 1) rho.
            heat += pressure / ((shock.gamma - 1.0) * p.mass / p.volume);
            first += 1.0;
        }
    }
    let plateau = (density / n / shock.density - 1.0).abs();
    let overshoot = most / shock.behind - 1.0;
    let heating = heat / first / (shock.behind / ((shock.gamma - 1.0) * shock.density)) - 1.0;
    let text = format!(
        "plateau off by {:.1} %, overshoot {:.1} %, first cell {:+.1} %, energy {:+.1} %",
        100.0 * plateau,
        100.0 * overshoot,
        100.0 * heating,
        100.0 * lost
    );
    let value = match asked {
        Asked::Profile => worse(plateau / 0.03, overshoot / 0.05),
        Asked::Heating => heating.abs(),
    };
    Ok(Measured::new(value, count).since(Some(text)))
}

fn trial(shock: Shock, scheme: Scheme, q: (f64, f64)) -> impl Fn(Size) -> Result<Measured, String> {
    move |_| run(Asked::Profile, shock, scheme, q)
}

/// T26: wall heating.
pub fn heating() -> Scene {
    fn trial(shock: Shock, scheme: Scheme) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| run(Asked::Heating, shock, scheme, (0.5, 2.0))
    }
    const WHY: &str = "list T26: wants artificial conduction, which is not there";
    Scene {
        id: "T26h",
        name: "heating at a plane",
        fails: "The same shocks, by their first cell. While the shock forms there, bulk viscosity makes too much heat, and nothing carries it away.",
        metric: "error of the energy per mass in the cell at the plane",
        limit: Limit::AtMost(0.15),
        rows: Vec::new(),
    }
    .fails("Noh, linear FLIP-MUSL", WHY, trial(NOH, ul(Linear, FlipMusl)))
    .fails("Noh, quadratic APIC", WHY, trial(NOH, ul(Quadratic, ApicUsl)))
    .fails("Noh, cubic APIC", WHY, trial(NOH, ul(Cubic, ApicUsl)))
    .fails("Mach 10, quadratic APIC", WHY, trial(mach_ten(), ul(Quadratic, ApicUsl)))
    .fails("Mach 10, cubic APIC", WHY, trial(mach_ten(), ul(Cubic, ApicUsl)))
}

const RINGS: &str = "rings at q within the range of the list; the density is right to 3 %";
const APIC: &str = "APIC takes 2 to 6 % of the kinetic energy and makes no heat of it, so that the gas is too dense; and rings by 5 to 14 %";

/// T26: Noh's shock.
pub fn noh() -> Scene {
    Scene {
        id: "T26n",
        name: "Noh's shock",
        fails: "Cold gas runs at a plane. The shock is a cell or two wide; without bulk viscosity it rings and passes through itself.",
        metric: "worse of error of the plateau of density / 3 % and overshoot of the pressure / 5 %",
        limit: Limit::AtMost(1.0),
        rows: Vec::new(),
    }
    .fails("quadratic FLIP-USL, no q", "list T26", trial(NOH, ul(Quadratic, FlipUsl), (0.0, 0.0)))
    .fails("cubic APIC, no q", "list T26", trial(NOH, ul(Cubic, ApicUsl), (0.0, 0.0)))
    .fails("linear FLIP-MUSL, q 0.5, 2", "book, Verification [C]", trial(NOH, ul(Linear, FlipMusl), (0.5, 2.0)))
    .holds("quadratic APIC, q 0.5, 2", "list T26", trial(NOH, ul(Quadratic, ApicUsl), (0.5, 2.0)))
    .but(|row| row.noted(APIC))
    .holds("quadratic APIC, q 1, 2", "list T26", trial(NOH, ul(Quadratic, ApicUsl), (1.0, 2.0)))
    .holds("cubic APIC, q 0.5, 2", "list T26", trial(NOH, ul(Cubic, ApicUsl), (0.5, 2.0)))
    .but(|row| row.noted(APIC))
    .holds("quadratic FLIP-USL, q 0.5, 2", "list T26", trial(NOH, ul(Quadratic, FlipUsl), (0.5, 2.0)))
    .but(|row| row.noted(RINGS))
    .holds("cpGIMP FLIP-USL, q 0.5, 2", "list T26", trial(NOH, ul(CpGimp, FlipUsl), (0.5, 2.0)))
    .but(|row| row.noted(RINGS))
}

/// T26: shock of Mach 10.
pub fn piston() -> Scene {
    Scene {
        id: "T26",
        name: "shock of Mach 10",
        fails: "The same with gas that has a pressure: a piston at Mach 10, seen from the piston.",
        metric: "worse of error of the plateau of density / 3 % and overshoot of the pressure / 5 %",
        limit: Limit::AtMost(1.0),
        rows: Vec::new(),
    }
    .fails("quadratic FLIP-USL, no q", "list T26", trial(mach_ten(), ul(Quadratic, FlipUsl), (0.0, 0.0)))
    .fails("cubic APIC, no q", "list T26", trial(mach_ten(), ul(Cubic, ApicUsl), (0.0, 0.0)))
    .holds("quadratic APIC, q 0.5, 2", "list T26", trial(mach_ten(), ul(Quadratic, ApicUsl), (0.5, 2.0)))
    .but(|row| row.noted(APIC))
    .holds("quadratic APIC, q 1, 2", "list T26", trial(mach_ten(), ul(Quadratic, ApicUsl), (1.0, 2.0)))
    .but(|row| row.noted(APIC))
    .holds("quadratic FMPM(4), q 0.5, 2", "list T26", trial(mach_ten(), ul(Quadratic, Fmpm4Usl), (0.5, 2.0)))
    .but(|row| row.noted(RINGS))
    .holds("cubic APIC, q 0.5, 2", "list T26", trial(mach_ten(), ul(Cubic, ApicUsl), (0.5, 2.0)))
    .but(|row| row.noted(APIC))
}
