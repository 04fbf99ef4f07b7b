//! Metals of the library with a shock line, and the line of each from its source.

use mpm_materials::{MieGruneisen, library};

/// Metal and its shock line U_s = c0 + s u_p.
#[derive(Clone, Copy, Debug)]
pub struct Metal {
    /// Name.
    pub name: &'static str,
    /// Density, kg/m^3, of the source.
    pub density: f64,
    /// Bulk sound speed c0, m/s, of the source.
    pub sound_speed: f64,
    /// Slope s of the source.
    pub slope: f64,
    /// Source of the three numbers (book, "Material constants").
    pub source: &'static str,
    /// Equation of state of the library.
    pub law: MieGruneisen<f64>,
}

/// All metals. Weldox 460 E and Arne tool steel have a logarithmic law and no shock line; sets of one metal that differ in strength only
/// share one line.
pub fn all() -> [Metal; 7] {
    let of = |name, [density, sound_speed, slope]: [f64; 3], source, law: &MieGruneisen<f64>| Metal {
        name,
        density,
        sound_speed,
        slope,
        source,
        law: *law,
    };
    [
        of("6061-T6", [2700.0, 5386.0, 1.339], "Uintah [V]", library::aluminium_6061_t6().eos()),
        of("aluminium, Feng", [2703.0, 5350.0, 1.34], "Feng2014 [S]", library::aluminium_feng_2014().eos()),
        of("copper", [8930.0, 3940.0, 1.49], "MPM3D-F90 Taylor.mpm [V]", library::copper_ofhc().eos()),
        of(
            "copper casing",
            [8900.0, 3300.0, 1.49],
            "MPM3D-F90 TNT3D.mpm [V]",
            library::copper_casing().eos(),
        ),
        of("steel 4340", [7830.0, 3574.0, 1.92], "Uintah [V]", library::steel_4340().eos()),
        of("tungsten alloy", [18167.0, 4030.0, 1.237], "Steinberg1996 [V]", library::tungsten_alloy().eos()),
        of("lead", [11350.0, 2092.0, 1.45], "MPM3D-F90 lead deck [V]", library::lead().eos()),
    ]
}

/// State behind a steady shock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shocked {
    /// Speed of the front, m/s.
    pub front: f64,
    /// Pressure, Pa.
    pub pressure: f64,
    /// Compression mu = rho/rho0 - 1.
    pub compression: f64,
    /// Internal energy per reference volume, J/m^3.
    pub energy: f64,
}

impl Metal {
    /// Return the name for files.
    pub fn file_name(&self) -> String {
        self.name.replace(", ", "_").replace(' ', "_")
    }

    /// Return the state behind a shock into the metal at rest, by Rankine and Hugoniot: U_s = c0 + s u_p, p = rho0 U_s u_p, rho/rho0 =
    /// U_s/(U_s - u_p), e = p (1 - rho0/rho)/2 = rho0 u_p^2/2.
    pub fn shocked(&self, particle_speed: f64) -> Shocked {
        let front = self.sound_speed + self.slope * particle_speed;
        Shocked {
            front,
            pressure: self.density * front * particle_speed,
            compression: particle_speed / (front - particle_speed),
            energy: 0.5 * self.density * particle_speed * particle_speed,
        }
    }

    /// Return the pressure at V/V0 = 1 - eta without thermal part, Pa: rho0 c0^2 eta / (1 - s eta)^2 in compression, rho0 c0^2 eta V0/V in
    /// tension.
    pub fn pressure(&self, eta: f64) -> f64 {
        let modulus = self.density * self.sound_speed * self.sound_speed;
        let share = if eta > 0.0 { 1.0 / (1.0 - self.slope * eta).powi(2) } else { 1.0 / (1.0 - eta) };
        modulus * eta * share
    }
}
