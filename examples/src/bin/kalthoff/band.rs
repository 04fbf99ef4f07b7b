//! Adiabatic shear band: cells whose plastic strain exceeds the limit of shear strength.

use examples::CaseError;
use mpm_core::output::Snapshot;

use crate::setup::{ROOM, Setup, TIP};

/// Shear band that starts at the notch tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Distance of the farthest band cell ahead of the notch tip, m; zero without a band.
    pub length: f64,
    /// Angle of that cell as seen from the notch tip, degrees above the line of the notch.
    pub angle: f64,
    /// Largest temperature rise, K.
    pub rise: f64,
}

impl Band {
    /// Find the shear band in a plate.
    pub fn of(setup: &Setup, snapshot: &Snapshot) -> Result<Self, CaseError> {
        let (strain, heat) = (snapshot.scalar("plastic_strain")?, snapshot.scalar("temperature")?);
        let rise = heat.iter().copied().fold(ROOM, f64::max) - ROOM;
        // Current position of the notch tip: the matter above it hardly moves.
        let mut band = Band { length: 0.0, angle: f64::NAN, rise };
        for (x, strain) in snapshot.positions().iter().zip(strain) {
            let way = [x[0] - TIP[0], x[1] - TIP[1]];
            let length = way[0].hypot(way[1]);
            if *strain >= setup.collapse && way[0] > 0.0 && length > band.length {
                band.length = length;
                band.angle = way[1].atan2(way[0]).to_degrees();
            }
        }
        Ok(band)
    }
}
