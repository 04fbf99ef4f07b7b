//! Softening of a law in shear: the plastic strain at the peak of its stress.

use impactite_simd::{Float, RowPair};

use crate::material::{Deformation, Length, Material, Motion, Response, StatesMut};

/// Name of the state variable.
const STRAIN: &str = "plastic_strain";
/// Increment of the shear strain, and number of increments.
const INCREMENT: f64 = 0.02;
const INCREMENTS: usize = 300;
/// Fall of the stress below its peak that is softening, over the peak.
const FALLS: f64 = 0.02;

/// Return the plastic strain at which the von Mises stress is largest in adiabatic simple shear at constant volume, at this rate of the plastic strain,
/// 1/s. From there on a shear zone of the law may localise \[ZenerHollomon1944\]. None if the stress does not fall by 2 % up to a plastic
/// strain of 3.4, and for a law without the state variable `plastic_strain`.
pub fn softens_from<T: Float>(material: &dyn Material<T>, rate: f64) -> Option<f64> {
    let strain = material.state_names().iter().position(|name| name == STRAIN)?;
    let row = |x: f64| {
        let mut row = T::Row::default();
        row.as_mut().fill(T::of(x));
        row
    };
    let mut rows: Vec<T::Row> = material.virgin().into_iter().map(|x| row(x.to_double())).collect();
    // Simple shear dv_x/dy: the rate of the equivalent strain is 1 / sqrt(3) of it.
    let shear = 3f64.sqrt() * rate;
    let dt = INCREMENT / shear;
    if !(dt.is_finite() && dt > 0.0) {
        return None;
    }
    let pair = |x: f64| RowPair([row(x), row(x)]);
    let gradient = std::array::from_fn(|n| pair(if n == 1 { shear } else { 0.0 }));
    let deformation = [Deformation { gradient, step: pair(dt) }];
    let motion = Motion { deformation: &deformation, dt: T::of(dt), length: Length::Same(T::of(1.0)) };
    let (mut response, mut peak) = (Response::default(), (0.0, 0.0));
    for _ in 0..INCREMENTS {
        let states = StatesMut { all: &mut rows, stride: material.numbers(), first: 0, groups: &[0] };
        material.advance(&motion, states, false, &mut response);
        if response.faults().iter().any(|fault| fault.lane == 0) {
            break;
        }
        let output = response.outputs().first()?;
        let s: [f64; 6] = std::array::from_fn(|n| output.stress[n].0[0].as_ref()[0].to_double());
        let mean = (s[0] + s[1] + s[2]) / 3.0;
        let square: f64 = s[..3].iter().map(|s| (s - mean) * (s - mean)).sum();
        let shears: f64 = s[3..].iter().map(|s| s * s).sum();
        let stress = (1.5 * (square + 2.0 * shears)).sqrt();
        if stress > peak.0 {
            peak = (stress, rows[strain].as_ref()[0].to_double());
        }
        if stress < (1.0 - FALLS) * peak.0 {
            return Some(peak.1);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library;
    use crate::material::Compiled;

    /// Peak of (90 + 292 e^0.31) (1 + 0.025 ln 1e4) (1 - T*^1.09) MPa for adiabatic heating of OFHC copper from 294 K: 90 % of the plastic work, rho c =
    /// 8930 x 383 J/(m^3 K), melting at 1356 K. Integrated with small steps, by its own loop.
    fn copper_peak() -> f64 {
        let (mut heat, mut peak, mut e) = (0.0, (0.0, 0.0), 0.0);
        let de = 1e-4;
        while e < 4.0 {
            e += de;
            let rate = 1.0 + 0.025 * 1e4f64.ln();
            let stress =
                (90e6 + 292e6 * f64::powf(e, 0.31)) * rate * (1.0 - f64::powf(heat / (1356.0 - 294.0), 1.09));
            heat += 0.9 * stress * de / (8930.0 * 383.0);
            peak = if stress > peak.0 { (stress, e) } else { peak };
        }
        peak.1
    }

    #[test]
    fn copper_softens_from_the_peak_of_its_adiabatic_curve() {
        let (found, due) =
            (softens_from(&Compiled::new(library::copper_ofhc::<f64>()), 1e4).unwrap(), copper_peak());
        // The peak is flat: increments of 0.012 in plastic strain find it to a few of them.
        assert!((found / due - 1.0).abs() < 0.05, "{found}, {due}");
    }

    #[test]
    fn laws_soften_by_damage_and_not_while_they_harden() {
        assert_eq!(softens_from(&Compiled::new(library::arne_tool_steel::<f64>()), 1e3), None);
        assert_eq!(softens_from(&Compiled::new(library::copper_taylor::<f64>()), 1e3), None);
        let weldox = softens_from(&Compiled::new(library::weldox_460_e::<f64>()), 1e3).unwrap();
        assert!((0.1..1.0).contains(&weldox), "{weldox}");
        assert_eq!(softens_from(&Compiled::new(library::steel_elastic::<f64>()), 1e3), None);
    }
}
