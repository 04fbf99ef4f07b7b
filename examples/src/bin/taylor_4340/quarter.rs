//! Quarter of the bar in three dimensions.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use sph::Layout;

use crate::scene::{LENGTH, RADIUS};

/// Generate layers of rings, so that the mantle is smooth. Layers are on both ends, with half of the volume, and no particle is on a plane
/// of symmetry. Ring width equals the spacing, and particles are about as long.
pub fn layout(h: f64) -> Layout<3> {
    let (rings, layers) = ((RADIUS / h).round() as u32, (LENGTH / h).round() as u32);
    let (mut positions, mut volumes) = (Vec::new(), Vec::new());
    for layer in 0..=layers {
        let height = if layer == 0 || layer == layers { 0.5 * h } else { h };
        for ring in 0..rings {
            let (r, area) = (h * (f64::from(ring) + 0.5), FRAC_PI_4 * h * h * f64::from(2 * ring + 1));
            let parts = (FRAC_PI_2 * r / h).round().max(1.0) as u32;
            for part in 0..parts {
                let (sin, cos) = (FRAC_PI_2 * (f64::from(part) + 0.5) / f64::from(parts)).sin_cos();
                positions.push([r * cos, r * sin, h * f64::from(layer)]);
                volumes.push(area * height / f64::from(parts));
            }
        }
    }
    let spacings = vec![h; positions.len()];
    Layout { positions, volumes, spacings, surface: 0.0 }
}
