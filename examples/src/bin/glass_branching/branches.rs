//! How many branches a crack has, and since when.

use fpm::Crack;

use crate::setup::{SIZE, TIP};

/// Width of the strips of the plate that are looked at, m.
const STRIP: f64 = 1e-3;
/// Faces of a strip that are farther apart than this, m, are of different branches.
const APART: f64 = 2e-3;
/// So many strips after each other with two branches are a branching: what is shorter is a try that came to nothing.
const LASTS: usize = 6;
/// How far behind a branching both branches are when it is complete, m.
const COMPLETE: f64 = 0.01;

/// A crack that runs from the end of the notch to the right, seen in strips across its way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Branches {
    /// Where the first branching is, m from the end of the notch, and when the crack was there, s.
    pub first: Option<(f64, f64)>,
    /// When two branches had gone on by 10 mm, s.
    pub complete: Option<f64>,
    /// The most branches beside each other.
    pub most: usize,
}

impl Branches {
    /// Of the faces that bear nothing any more.
    pub fn of(cracks: &[Crack<2>]) -> Self {
        let strips = (((SIZE[0] - TIP[0]) / STRIP).round() as usize).max(1);
        let mut faces: Vec<Vec<[f64; 2]>> = vec![Vec::new(); strips];
        for crack in cracks {
            let strip = ((crack.reference[0] - TIP[0]) / STRIP).floor();
            if let (true, Some(time)) = (strip >= 0.0 && (strip as usize) < strips, crack.parted) {
                faces[strip as usize].push([crack.reference[1], time]);
            }
        }
        // Of each strip, its branches: when each came there.
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
