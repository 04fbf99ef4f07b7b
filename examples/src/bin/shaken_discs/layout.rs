//! Initial layout of the discs.

/// Radius of the small discs, m; all lengths are proportional to it.
pub const RADIUS: f64 = 8.0e-3;
/// Radius of the large discs, m: 1821 particles to 205 in \[Ma2010\].
pub const LARGE: f64 = 3.0 * RADIUS;
/// Inner dimensions of the container for 3 large and 207 small discs, m: with walls four particles thick it has 4832 particles, as in
/// \[Ma2010\].
const INSIDE: [f64; 2] = [236.0 / 8.0 * RADIUS, 360.0 / 8.0 * RADIUS];
/// Initial gap between discs, m.
const GAP: f64 = 0.06 * RADIUS;

/// Disc: centre and radius, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    pub centre: [f64; 2],
    pub radius: f64,
}

/// Inside of the container, from the origin, and its discs, large ones first.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    pub inside: [f64; 2],
    pub discs: Vec<Disc>,
    pub large: usize,
}

impl Layout {
    /// Place large discs in a row on the floor, and small ones in rows of alternating offset around and above them, from below.
    pub fn new(large: usize, small: usize) -> Self {
        // The width is proportional to the number of large discs, and the height increases with the number of small discs per large one.
        let full = (small as f64 / (69.0 * large as f64)).min(1.0);
        let inside = [INSIDE[0] * large as f64 / 3.0, INSIDE[1] * (0.35 + 0.65 * full)];
        let pitch = inside[0] / large as f64;
        let mut discs: Vec<Disc> = (0..large)
            .map(|n| Disc { centre: [(n as f64 + 0.5) * pitch, LARGE + GAP], radius: LARGE })
            .collect();
        let edge = 2.0 * RADIUS + GAP;
        let (columns, rise) = ((inside[0] / edge).floor(), edge * 0.75_f64.sqrt());
        let spare = inside[0] - columns * edge;
        for row in 0.. {
            let y = RADIUS + GAP + f64::from(row) * rise;
            if discs.len() == large + small || y + RADIUS > inside[1] {
                break;
            }
            let odd = row % 2 == 1;
            let in_row = if odd && spare < 0.5 * edge { columns - 1.0 } else { columns };
            for n in 0..in_row as usize {
                let x = (n as f64 + if odd { 1.0 } else { 0.5 }) * edge;
                let free = discs[..large]
                    .iter()
                    .all(|d| (d.centre[0] - x).hypot(d.centre[1] - y) > d.radius + RADIUS + GAP);
                if free && discs.len() < large + small {
                    discs.push(Disc { centre: [x, y], radius: RADIUS });
                }
            }
        }
        Layout { inside, discs, large }
    }
}
