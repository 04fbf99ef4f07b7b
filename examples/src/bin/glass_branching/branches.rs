//! Number of branches of a crack, and time of branching.

use fpm::Crack;

use crate::setup::{SIZE, TIP};

/// Width of the strips across the plate, m.
const STRIP: f64 = 1e-3;
/// Distance of faces in a strip, m, beyond which they belong to different branches.
const APART: f64 = 2e-3;
/// Number of successive strips with two branches that make a branching; shorter branches are arrested attempts.
const LASTS: usize = 6;
/// Length of both branches when a branching is complete, m.
const COMPLETE: f64 = 0.01;

/// Branches of a crack that runs to the right from the tip of the notch, counted in strips across its path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Branches {
    /// First branching: distance from the tip of the notch, m, and arrival time of the crack there, s.
    pub first: Option<(f64, f64)>,
    /// Time at which two branches had grown by 10 mm, s.
    pub complete: Option<f64>,
    /// Maximum number of branches beside each other.
    pub most: usize,
}

impl Branches {
    /// Count the branches of faces without traction.
    pub fn of(cracks: &[Crack<2>]) -> Self {
        let strips = (((SIZE[0] - TIP[0]) / STRIP).round() as usize).max(1);
        let mut faces: Vec<Vec<[f64; 2]>> = vec![Vec::new(); strips];
        for crack in cracks {
            let strip = ((crack.reference[0] - TIP[0]) / STRIP).floor();
            if let (true, Some(time)) = (strip >= 0.0 && (strip as usize) < strips, crack.parted) {
                faces[strip as usize].push([crack.reference[1], time]);
            }
        }
        // Arrival times of the branches in each strip.
        let branches: Vec<Vec<f64>> = faces
            .into_iter()
            .map(|mut faces| {
                faces.sort_by(|a, b| a[0].total_cmp(&b[0]));
                let clusters = faces.chunk_by(|a, b| b[0] - a[0] <= APART);
                clusters.map(|c| c.iter().map(|f| f[1]).fold(f64::INFINITY, f64::min)).collect()
            })
            .collect();
        let two = |strip: &Vec<f64>| strip.len() > 1;
        let place = branches.windows(LASTS.min(strips)).position(|strips| strips.iter().all(two));
        let came = |strip: &Vec<f64>| strip.iter().copied().fold(f64::INFINITY, f64::min);
        let complete = place.and_then(|place| branches.get(place + (COMPLETE / STRIP) as usize));
        Branches {
            first: place.map(|place| (place as f64 * STRIP, came(&branches[place]))),
            complete: complete.filter(|s| two(s)).map(|strip| {
                let mut times = strip.clone();
                times.sort_by(f64::total_cmp);
                times[1]
            }),
            most: branches.iter().map(Vec::len).max().unwrap_or(0),
        }
    }
}
