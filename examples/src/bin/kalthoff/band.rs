//! A band of shear: cells that yielded until they bore no shear any more.

use examples::CaseError;
use mpm_core::output::Snapshot;

use crate::setup::{ROOM, Setup, TIP};

/// A band from the end of the notch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// How far its farthest cell ahead of the notch is from the end of that, m; zero without a band.
    pub length: f64,
    /// Where that is seen from the notch, degrees above the line of the notch.
    pub angle: f64,
    /// Largest rise of the temperature, K.
    pub rise: f64,
}

impl Band {
    /// Of a plate.
    pub fn of(setup: &Setup, snapshot: &Snapshot) -> Result<Self, CaseError> {
        let (strain, heat) = (snapshot.scalar("plastic_strain")?, snapshot.scalar("temperature")?);
        let rise = heat.iter().copied().fold(ROOM, f64::max) - ROOM;
        // Where the end of the notch is now: above it matter hardly moves.
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
