//! Reference solution of a long TNT charge in a copper case, independent of the library's grid and particles:
//! one-dimensional finite differences along the radius (von Neumann and Richtmyer), each zone with its own mass. Equations
//! and constants are written out here.

/// Density of TNT and of the case, kg/m^3.
const DENSITY: [f64; 2] = [1630.0, 8900.0];
/// Chemical energy of TNT, J/m^3.
const CHEMICAL: f64 = 6.993e9;
/// JWL constants of TNT's products: A, B, Pa; R1, R2, omega; detonation speed, m/s; V_CJ.
const JWL: [f64; 7] = [371.2e9, 3.21e9, 4.15, 0.95, 0.30, 6930.0, 0.7318];
/// Constants of the case: c0, m/s, s, gamma0; shear modulus, yield stress, hardening, Pa; hardening exponent.
const METAL: [f64; 7] = [3300.0, 1.49, 1.96, 117e9 / 2.62, 90e6, 392e6, 0.5];
/// Linear and quadratic coefficient of the bulk viscosity: low, since the zones are many.
const VISCOSITY: [f64; 2] = [0.1, 1.5];
/// Width of the burn front, m, independent of the number of zones.
const BURN: f64 = 0.4e-3;
const FACTOR: f64 = 0.25;

#[derive(Clone, Copy, Default)]
struct Zone {
    metal: bool,
    mass: f64,
    volume: f64,
    middle: f64,
    energy: f64,
    pressure: f64,
    viscous: f64,
    /// Deviatoric stress, Pa: radial, hoop, axial.
    deviator: [f64; 3],
    plastic: f64,
    burnt: f64,
}

impl Zone {
    fn density(&self) -> f64 {
        DENSITY[usize::from(self.metal)]
    }
    /// Return a and b of p = a + b e at volume ratio v.
    fn terms(&self, v: f64) -> [f64; 2] {
        if self.metal {
            let [c0, s, gamma, ..] = METAL;
            let (bulk, eta) = (DENSITY[1] * c0 * c0, 1.0 - v);
            let cold = if eta > 0.0 {
                bulk * eta * (1.0 - 0.5 * gamma * eta) / (1.0 - s * eta).powi(2)
            } else {
                bulk * eta / v
            };
            return [cold, gamma];
        }
        let [a, b, r1, r2, omega, ..] = JWL;
        let of = |a: f64, r: f64| a * (1.0 - omega / (r * v)) * (-r * v).exp();
        [self.burnt * (of(a, r1) + of(b, r2)), self.burnt * omega / v]
    }
    fn sound(&self, v: f64) -> f64 {
        let at = |v: f64, e: f64| {
            let [a, b] = self.terms(v);
            a + b * e
        };
        let d = 1e-5 * v;
        let slope = (at(v - d, self.energy + self.pressure * d) - at(v + d, self.energy - self.pressure * d))
            / (2.0 * d);
        let shear = if self.metal { 4.0 / 3.0 * METAL[3] / DENSITY[1] * v } else { 0.0 };
        (slope.max(0.0) * v * v / self.density() + shear).sqrt()
    }
}

/// Cylindrical charge in a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cased {
    /// Radius of the charge, m.
    pub charge: f64,
    /// Thickness of the case, m.
    pub case: f64,
    /// True if the charge burns from its axis outwards, false if all at once at the start.
    pub from_axis: bool,
    /// Number of zones along the radius of the charge; those of the case have the same width.
    pub zones: usize,
}

impl Cased {
    /// Compute the mean speed of the case until `end`, s: rows of time, s, speed, m/s, and outer radius over that at the start.
    #[must_use]
    pub fn speeds(&self, end: f64) -> Vec<[f64; 3]> {
        cylinder(self, end)
    }
}

fn cylinder(setup: &Cased, end: f64) -> Vec<[f64; 3]> {
    let &Cased { charge, case, from_axis, zones } = setup;
    let step = charge / zones as f64;
    let shell = (case / step).round() as usize;
    let mut r: Vec<f64> = (0..=zones + shell).map(|i| i as f64 * step).collect();
    let mut v: Vec<f64> = vec![0.0; r.len()];
    let mut all: Vec<Zone> = (0..zones + shell)
        .map(|j| {
            let metal = j >= zones;
            let volume = 0.5 * (r[j + 1] * r[j + 1] - r[j] * r[j]);
            let mass = DENSITY[usize::from(metal)] * volume;
            let energy = if metal { 0.0 } else { CHEMICAL };
            let burnt = if metal || from_axis { 0.0 } else { 1.0 };
            Zone { metal, mass, volume, middle: 0.5 * (r[j] + r[j + 1]), energy, burnt, ..Zone::default() }
        })
        .collect();
    let mut time = 0.0;
    let mut rows = Vec::new();
    while time < end {
        let mut dt = (end - time).max(1e-15);
        for (j, z) in all.iter().enumerate() {
            let (now, first) = (0.5 * (r[j + 1] * r[j + 1] - r[j] * r[j]), z.mass / z.density());
            // Unburnt zones must be stable when the detonation arrives: at least its speed.
            let c = z.sound(now / first).max(if z.metal { 0.0 } else { JWL[5] });
            dt = dt.min(FACTOR * (r[j + 1] - r[j]) / (c + (v[j + 1] - v[j]).abs()));
        }
        // Nodal forces by virtual work: r dr (sigma_r d(dv/dr) + sigma_h d(v/r)).
        let mut force = vec![0.0; r.len()];
        let mut mass = vec![0.0; r.len()];
        for (j, z) in all.iter().enumerate() {
            let (middle, width) = (0.5 * (r[j] + r[j + 1]), r[j + 1] - r[j]);
            let total = z.pressure + z.viscous;
            let [radial, hoop] = [z.deviator[0] - total, z.deviator[1] - total];
            force[j] += middle * radial - 0.5 * width * hoop;
            force[j + 1] -= middle * radial + 0.5 * width * hoop;
            mass[j] += 0.5 * z.mass;
            mass[j + 1] += 0.5 * z.mass;
        }
        for i in 1..r.len() {
            v[i] += dt * force[i] / mass[i];
            r[i] += dt * v[i];
        }
        time += dt;
        for (j, z) in all.iter_mut().enumerate() {
            advance(z, [r[j], r[j + 1]], [v[j], v[j + 1]], time, dt);
        }
        let shell = all.iter().enumerate().filter(|(_, z)| z.metal);
        let (m, p) =
            shell.fold((0.0, 0.0), |(m, p), (j, z)| (m + z.mass, p + 0.5 * z.mass * (v[j] + v[j + 1])));
        rows.push([time, p / m, r[r.len() - 1] / (charge + case)]);
    }
    rows
}

fn advance(z: &mut Zone, r: [f64; 2], v: [f64; 2], time: f64, dt: f64) {
    let first = z.mass / z.density();
    let volume = 0.5 * (r[1] * r[1] - r[0] * r[0]);
    let (ratio, change) = (volume / first, (volume - z.volume) / first);
    let (width, middle) = (r[1] - r[0], 0.5 * (r[0] + r[1]));
    let rate = (volume - z.volume) / (dt * 0.5 * (volume + z.volume));
    let c = z.sound(ratio);
    z.viscous = 0.0;
    if rate < 0.0 {
        let [linear, quadratic] = VISCOSITY;
        let squeeze = -rate * width;
        z.viscous = z.density() / ratio * squeeze * (quadratic * quadratic * squeeze + linear * c);
    }
    if !z.metal {
        let [.., speed, jouguet] = JWL;
        let ordered = (time * speed - z.middle) / BURN;
        let squeezed = (1.0 - ratio) / (1.0 - jouguet);
        z.burnt = z.burnt.max(ordered.max(squeezed).clamp(0.0, 1.0));
    }
    let mut work = 0.0;
    if z.metal {
        let strain = [(v[1] - v[0]) / width * dt, 0.5 * (v[0] + v[1]) / middle * dt, 0.0];
        let mean = (strain[0] + strain[1]) / 3.0;
        let old = z.deviator;
        let [.., shear, a, b, n] = METAL;
        for i in 0..3 {
            z.deviator[i] += 2.0 * shear * (strain[i] - mean);
        }
        let equivalent = (1.5 * z.deviator.iter().map(|s| s * s).sum::<f64>()).sqrt();
        // Return mapping to the yield stress A + B eps^n by Newton's method.
        let mut more = 0.0;
        if equivalent > a + b * z.plastic.powf(n) {
            for _ in 0..30 {
                let eps: f64 = (z.plastic + more).max(1e-9);
                let excess = equivalent - 3.0 * shear * more - a - b * eps.powf(n);
                more += excess / (3.0 * shear + b * n * eps.powf(n - 1.0));
                more = more.max(0.0);
            }
            z.plastic += more;
            for s in &mut z.deviator {
                *s *= 1.0 - 3.0 * shear * more / equivalent;
            }
        }
        work = (0..3).map(|i| 0.5 * (old[i] + z.deviator[i]) * (strain[i] - mean)).sum::<f64>() * ratio;
    }
    let worked = z.energy + work - (0.5 * z.pressure + z.viscous) * change;
    let [cold, thermal] = z.terms(ratio);
    z.pressure = (cold + thermal * worked) / (1.0 + 0.5 * thermal * change);
    z.energy = worked - 0.5 * z.pressure * change;
    z.volume = volume;
}
