//! Profiles: values of a field along a line.

use impactite::scene::PointView;

use crate::build::wrong::{Made, known, wrong};
use crate::model::SceneFile;
use crate::model::measure::{Profile, TakenOfBin};

/// Maximum number of bins.
const MOST: u32 = 1000;

/// Check the profiles of a scene.
pub(crate) fn check(scene: &SceneFile) -> Made<()> {
    for (name, profile) in &scene.profiles {
        let key = format!("profiles.{name}");
        let plain = |c: char| c.is_alphanumeric() || ['_', '-', ' '].contains(&c);
        if name.trim().is_empty() || !name.chars().all(plain) {
            return wrong(
                key,
                "the name is that of a file: letters, digits, `_`, `-` and blanks are allowed",
            );
        }
        known(&format!("{key}.body"), "body", &profile.body, scene.expanded.keys().map(String::as_str))?;
        let dimensions = scene.space.dimensions();
        for (word, place) in [("from", &profile.from), ("to", &profile.to)] {
            if place.len() != dimensions {
                let message =
                    format!("has {} components; the scene has {dimensions} dimensions", place.len());
                return wrong(format!("{key}.{word}"), message);
            }
        }
        if !(1..=MOST).contains(&profile.bins) {
            let message = format!("{} is not allowed; it must be 1 to {MOST}", profile.bins);
            return wrong(format!("{key}.bins"), message);
        }
        if Line::new(profile).length <= 0.0 {
            return wrong(format!("{key}.to"), "is `from` itself; the line needs a length");
        }
        for (word, value) in
            [("radius", profile.radius.map(|q| q.value)), ("every", profile.every.map(|q| q.value))]
        {
            if let Some(value) = value.filter(|value| *value <= 0.0) {
                return wrong(
                    format!("{key}.{word}"),
                    format!("{value} is not allowed; it must be positive"),
                );
            }
        }
    }
    Ok(())
}

/// Line of a profile.
#[derive(Clone, Copy, Debug)]
struct Line {
    from: [f64; 3],
    /// Unit vector from the start to the end.
    along: [f64; 3],
    /// Length, m.
    length: f64,
}

impl Line {
    fn new(profile: &Profile) -> Self {
        let place = |list: &[crate::quantity::Quantity<crate::quantity::Length>]| -> [f64; 3] {
            std::array::from_fn(|d| list.get(d).map_or(0.0, |q| q.value))
        };
        let (from, to) = (place(&profile.from), place(&profile.to));
        let way: [f64; 3] = std::array::from_fn(|d| to[d] - from[d]);
        let length = way.iter().map(|w| w * w).sum::<f64>().sqrt();
        Line { from, along: way.map(|w| w / length), length }
    }

    /// Return the bin of a point, if the point is beside the line and within `radius`, m.
    fn bin(&self, x: &[f64; 3], bins: usize, radius: f64) -> Option<usize> {
        let arm: [f64; 3] = std::array::from_fn(|d| x[d] - self.from[d]);
        let s: f64 = (0..3).map(|d| arm[d] * self.along[d]).sum();
        let across = (0..3).map(|d| (arm[d] - s * self.along[d]).powi(2)).sum::<f64>().sqrt();
        // False for a position that is no number.
        let within = (0.0..=self.length).contains(&s) && across <= radius;
        within.then(|| ((s / self.length * bins as f64) as usize).min(bins - 1))
    }
}

/// Return the distances of the centres of the bins from the start of the line, m.
pub(super) fn centres(profile: &Profile) -> impl Iterator<Item = f64> {
    let (length, bins) = (Line::new(profile).length, f64::from(profile.bins));
    (0..profile.bins).map(move |n| (f64::from(n) + 0.5) * length / bins)
}

/// Sums over the points of the bins of a profile.
pub(super) struct Bins<'a> {
    profile: &'a Profile,
    line: Line,
    radius: f64,
    /// Weight, weight times value, and the extreme of each bin.
    sums: Vec<[f64; 3]>,
    /// Sign of the values of which the largest is taken.
    sign: f64,
}

impl<'a> Bins<'a> {
    pub fn new(profile: &'a Profile) -> Self {
        let sign = if profile.take == TakenOfBin::Smallest { -1.0 } else { 1.0 };
        let radius = profile.radius.map_or(f64::INFINITY, |q| q.value);
        let sums = vec![[0.0, 0.0, f64::NAN]; profile.bins as usize];
        Bins { profile, line: Line::new(profile), radius, sums, sign }
    }

    /// Add the value of a point to its bin.
    pub fn add(&mut self, p: &PointView, value: f64) {
        let Some(bin) = self.line.bin(&p.position, self.sums.len(), self.radius) else { return };
        // The density is mass over volume: its mean has the weight volume.
        let weight = if self.profile.field == "density" { p.volume } else { p.mass };
        let [mass, sum, most] = &mut self.sums[bin];
        *mass += weight;
        *sum += weight * value;
        *most = most.max(self.sign * value);
    }

    /// Return a value a bin; NaN for a bin without points.
    pub fn values(&self) -> Vec<f64> {
        let of = |[mass, sum, most]: &[f64; 3]| match self.profile.take {
            TakenOfBin::Mean => sum / mass,
            TakenOfBin::Largest | TakenOfBin::Smallest => self.sign * most,
        };
        self.sums.iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_in_the_bins_of_the_line() {
        let line = Line { from: [1.0, 1.0, 0.0], along: [0.6, 0.8, 0.0], length: 5.0 };
        let at = |s: f64, across: f64| [1.0 + 0.6 * s - 0.8 * across, 1.0 + 0.8 * s + 0.6 * across, 0.0];
        assert_eq!(line.bin(&at(2.2, 0.0), 5, f64::INFINITY), Some(2));
        assert_eq!(line.bin(&at(2.2, 9.0), 5, f64::INFINITY), Some(2));
        assert_eq!(line.bin(&at(2.2, 9.0), 5, 8.0), None);
        assert_eq!(line.bin(&at(5.1, 0.0), 5, 1.0), None);
        assert_eq!(line.bin(&at(-0.1, 0.0), 5, 1.0), None);
        assert_eq!(line.bin(&[f64::NAN; 3], 5, 1.0), None);
    }
}
