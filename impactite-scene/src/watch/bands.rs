//! Localisation of plastic strain in bands that the resolution does not resolve.

use std::collections::HashMap;

use crate::body::{Body, Parts};
use crate::clock::Clock;
use crate::finding::Finding;
use crate::watch::Watcher;

/// Name of the state variable.
const STRAIN: &str = "plastic_strain";
/// Plastic strain below which a cell is in no band.
const LEAST: f64 = 0.05;
/// Ratio of the plastic strain two cells beside a band to that in it, on both sides, below which the band is not resolved. A Gaussian profile
/// has this ratio at a width at half height of 2.6 cells.
const FALLS: f64 = 0.2;
/// Share of the plastic strain of a body, integrated over its volume, in such cells above which it is a finding.
const SHARE: f64 = 0.2;
/// Number of such cells below which it is none.
const FEW: usize = 4;
/// Number of cells across a band that resolve it.
const RESOLVE: f64 = 4.0;
/// Share of the strain from which a law softens, above which a zone softens or would do so with finer cells, that smear its strain less. In the
/// plate of [`RESOLVES_SOFTENING`] the largest strain is 0.7 of it with 8 cells across the zone, and 1.2 with 16.
const NEAR: f64 = 0.4;
/// Share of the plastic strain of a body in a softening zone above which it is a finding.
const SHARE_SOFTENING: f64 = 0.05;
/// Number of cells across a softening zone within which bands can form: eight bands of [`RESOLVE`] cells. An estimate: the zone of 10 mm in a plate of
/// Weldox steel forms none with 8, 16 and 25 cells across it.
const RESOLVES_SOFTENING: f64 = 8.0 * RESOLVE;

/// Plastic strain of a body in cells of the resolution.
#[derive(Clone, Debug, Default)]
struct Cells {
    places: HashMap<[i32; 3], u32>,
    cells: Vec<Cell>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    at: [i32; 3],
    volume: f64,
    /// Plastic strain times volume, m^3.
    strain: f64,
    /// Volume of failed points.
    failed: f64,
}

/// Zone of a body whose plastic strain localises.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Zone {
    /// Share of the plastic strain of the body, integrated over its volume.
    share: f64,
    /// Mean width, m.
    width: f64,
    /// Centre of the cell of the largest plastic strain, m.
    position: [f64; 3],
}

/// Sums over the cells of a zone.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    cells: usize,
    strain: f64,
    /// Strain times width in cells.
    width: f64,
    largest: f64,
    at: [i32; 3],
}

impl Sums {
    fn add(&mut self, cell: &Cell, width: f64) {
        self.cells += 1;
        self.strain += cell.strain;
        self.width += cell.strain * width;
        if cell.mean() > self.largest {
            (self.largest, self.at) = (cell.mean(), cell.at);
        }
    }

    /// Zone of at least [`FEW`] cells with at least this share of the strain `all`.
    fn zone(&self, all: f64, least: f64, dimensions: usize, size: f64) -> Option<Zone> {
        let centre = |d: usize| if d < dimensions { (f64::from(self.at[d]) + 0.5) * size } else { 0.0 };
        (self.cells >= FEW && self.strain > least * all).then(|| Zone {
            share: self.strain / all,
            width: size * self.width / self.strain,
            position: std::array::from_fn(centre),
        })
    }
}

impl Cell {
    /// Mean plastic strain.
    fn mean(&self) -> f64 {
        self.strain / self.volume
    }
}

impl Cells {
    /// Sort the points of a body into cells of edge `size`, m. `strain` is the index of the plastic strain in the state.
    fn of(body: &dyn Body, strain: usize, size: f64) -> Self {
        let mut made = Cells::default();
        let parts = Parts { size: true, law: true, ..Parts::NONE };
        body.for_each_with(parts, &mut |p| {
            if p.volume.is_nan() || p.volume <= 0.0 {
                return;
            }
            let at = p.position.map(|x| (x / size).floor() as i32);
            let next = made.cells.len() as u32;
            let n = *made.places.entry(at).or_insert(next);
            if n == next {
                made.cells.push(Cell { at, ..Cell::default() });
            }
            let cell = &mut made.cells[n as usize];
            cell.volume += p.volume;
            cell.strain += p.volume * p.state.get(strain).map_or(0.0, |e| e.max(0.0));
            cell.failed += if p.failed { p.volume } else { 0.0 };
        });
        made
    }

    /// Mean plastic strain of the cell `by` cells along an axis from another; none without points.
    fn beside(&self, cell: &Cell, axis: usize, by: i32) -> Option<f64> {
        let mut at = cell.at;
        at[axis] += by;
        Some(self.cells[*self.places.get(&at)? as usize].mean())
    }

    /// Width of the profile across a cell along an axis, cells, if it falls on both sides within two cells.
    fn narrow(&self, cell: &Cell, axis: usize) -> Option<f64> {
        let here = cell.mean();
        let mut sum = here;
        for side in [-1, 1] {
            let (near, far) = (self.beside(cell, axis, side)?, self.beside(cell, axis, 2 * side)?);
            if far > FALLS * here || near > here {
                return None;
            }
            sum += near + far;
        }
        Some(sum / here)
    }

    /// Width at half height of the profile across a cell along an axis, cells, if it falls to half on both sides.
    fn half(&self, cell: &Cell, axis: usize) -> Option<f64> {
        let here = cell.mean();
        let mut width = 1;
        for side in [-1, 1] {
            let mut by = 1;
            while self.beside(cell, axis, by * side)? > 0.5 * here {
                by += 1;
                if 2 * by > RESOLVES_SOFTENING as i32 {
                    return None;
                }
            }
            width += by - 1;
        }
        Some(f64::from(width))
    }

    /// Return the sum of the plastic strain times volume, m^3, and the cells for which the narrowest `width` over the axes exists.
    fn zone(&self, dimensions: usize, from: f64, width: impl Fn(&Cell, usize) -> Option<f64>) -> (f64, Sums) {
        let all = self.cells.iter().map(|cell| cell.strain).sum();
        let mut sums = Sums::default();
        for cell in self
            .cells
            .iter()
            .filter(|cell| cell.strain >= from * cell.volume && 2.0 * cell.failed < cell.volume)
        {
            let widths = (0..dimensions).filter_map(|axis| width(cell, axis));
            let narrowest = widths.fold(f64::INFINITY, f64::min);
            if narrowest.is_finite() {
                sums.add(cell, narrowest);
            }
        }
        (all, sums)
    }

    /// Bands of one or two cells.
    fn bands(&self, dimensions: usize, size: f64) -> Option<Zone> {
        let (all, sums) = self.zone(dimensions, LEAST, |cell, axis| self.narrow(cell, axis));
        sums.zone(all, SHARE, dimensions, size)
    }

    /// Zone with at least the plastic strain `from`, that is not much wider than its cells.
    fn softening(&self, from: f64, dimensions: usize, size: f64) -> Option<Zone> {
        let (all, sums) = self.zone(dimensions, from.max(LEAST), |cell, axis| self.half(cell, axis));
        sums.zone(all, SHARE_SOFTENING, dimensions, size)
    }
}

/// Measure the points that have plastic strain: width, weighted by strain and volume, m, and the largest strain. None without any.
fn points(body: &dyn Body, strain: usize, (dimensions, axisymmetric): (usize, bool)) -> Option<(f64, f64)> {
    let (mut sum, mut weight, mut largest) = (0.0, 0.0, 0.0f64);
    let parts = Parts { size: true, law: true, ..Parts::NONE };
    body.for_each_with(parts, &mut |p| {
        let e = p.state.get(strain).map_or(0.0, |e| e.max(0.0));
        let by = p.volume * e;
        if by > 0.0 {
            sum += by * p.drawn_width(dimensions, axisymmetric);
            weight += by;
            largest = largest.max(e);
        }
    });
    (weight > 0.0).then(|| (sum / weight, largest))
}

impl Watcher {
    /// Warn of bodies whose plastic strain localises, once a body: in bands of one or two cells, or in a zone that softens; and of weakly
    /// compressible liquids that are too fast for their speed of sound. `cell` is the edge of the cells of the method, m; none for the width
    /// of the points. Checked at checks 1, 2, 4, 8, with the bodies, and at the end.
    pub fn look_at_fields(
        &mut self,
        clock: &Clock,
        bodies: &[&dyn Body],
        space: (usize, bool),
        cell: Option<f64>,
    ) {
        if !self.looks_for_bands(clock.steps) {
            return;
        }
        self.look_for_compression(clock, bodies);
        for body in bodies {
            let known = |f: &Finding| matches!(f, Finding::Localised { body: b, .. } if b == body.name());
            let Some(strain) = body.state_names().iter().position(|name| name == STRAIN) else { continue };
            if self.knows(known) {
                continue;
            }
            let Some((width, largest)) = points(*body, strain, space).filter(|(_, largest)| *largest > LEAST)
            else {
                continue;
            };
            let (size, dimensions) = (cell.unwrap_or(width), space.0);
            let cells = Cells::of(*body, strain, size);
            let rate = largest / clock.time;
            let softens = || body.softens_from(rate).filter(|from| NEAR * from < largest);
            let found = cells.bands(dimensions, size).map(|zone| (zone, None, RESOLVE));
            let found = found.or_else(|| {
                let from = softens()?;
                Some((cells.softening(NEAR * from, dimensions, size)?, Some(from), RESOLVES_SOFTENING))
            });
            let Some((Zone { share, width, position }, softens, cells)) = found else { continue };
            let (body, needed) = (body.name().to_string(), width / cells);
            let finding = Finding::Localised {
                body,
                share,
                width,
                cells: width / size,
                softens: softens.map(|from| [largest, from]),
                needed,
                position,
            };
            self.warn_once(clock, finding, |_| false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{PointView, Totals};

    /// Points on a square lattice of spacing 0.5, with a plastic strain for each place.
    struct Sheet<F>(F);

    impl<F: Fn(f64, f64) -> f64> Body for Sheet<F> {
        fn name(&self) -> &str {
            "sheet"
        }
        fn law(&self) -> &'static str {
            ""
        }
        fn len(&self) -> usize {
            60 * 60
        }
        fn state_names(&self) -> Vec<String> {
            vec!["temperature".into(), STRAIN.into()]
        }
        fn totals(&self) -> Totals {
            Totals::default()
        }
        fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
            for (i, j) in (0..60).flat_map(|i| (0..60).map(move |j| (i, j))) {
                let (x, y) = (0.25 + 0.5 * f64::from(i), 0.25 + 0.5 * f64::from(j));
                let state = vec![300.0, (self.0)(x, y)];
                visit(&PointView { position: [x, y, 0.0], volume: 0.25, state, ..PointView::default() });
            }
        }
        fn bytes(&self) -> usize {
            0
        }
    }

    fn found(strain: impl Fn(f64, f64) -> f64) -> Option<Zone> {
        Cells::of(&Sheet(strain), 1, 1.0).bands(2, 1.0)
    }
    /// Gaussian profile of this width at half height.
    fn gaussian(distance: f64, width: f64) -> f64 {
        (-4.0 * 2f64.ln() * (distance / width).powi(2)).exp()
    }

    #[test]
    fn bands_of_two_cells_are_found_in_any_direction_and_wide_ones_are_none() {
        for degrees in [0.0f64, 20.0, 45.0, 70.0, 90.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let band =
                |width: f64| move |x: f64, y: f64| gaussian((x - 15.3) * cos + (y - 14.8) * sin, width);
            for width in [0.8, 1.5] {
                let bands = found(band(width)).unwrap_or_else(|| panic!("{degrees} degrees, {width} cells"));
                // The integral of the profile over its height is 1.06 of the width; cells smear it, and cut it slantwise.
                assert!(
                    bands.share > 0.3 && (0.9..2.8).contains(&bands.width),
                    "{degrees}, {width}: {bands:?}"
                );
                let [x, y, _] = bands.position;
                assert!(((x - 15.3) * cos + (y - 14.8) * sin).abs() < 1.0, "{bands:?}");
            }
            assert_eq!(found(band(5.0)), None, "{degrees} degrees");
        }
    }

    #[test]
    fn strain_at_a_surface_or_spread_or_small_is_no_band() {
        assert_eq!(found(|x, _| (-x / 1.5).exp()), None);
        assert_eq!(found(|_, _| 0.3), None);
        assert_eq!(found(|x, _| 0.5 * LEAST * gaussian(x - 15.3, 1.0)), None);
        // A band with a small part of the strain of its body.
        assert_eq!(found(|x, _| if x < 10.0 { 0.5 } else { 0.5 * gaussian(x - 20.3, 1.0) }), None);
        // Three cells alone.
        assert_eq!(
            found(|x, y| if (15.0..16.0).contains(&x) && (15.0..18.0).contains(&y) { 1.0 } else { 0.0 }),
            None
        );
    }

    #[test]
    fn zones_that_soften_are_found_unless_wide_or_hardening() {
        let softening = |width: f64, from: f64| {
            Cells::of(&Sheet(|x: f64, _: f64| gaussian(x - 15.3, width)), 1, 1.0).softening(from, 2, 1.0)
        };
        for width in [3.0, 6.0, 12.0] {
            let zone = softening(width, 0.6).unwrap();
            // Cells beside the crest have profiles of half their own height, which are wider.
            assert!((0.9 * width - 1.0..1.5 * width + 1.0).contains(&zone.width), "{width}: {zone:?}");
            assert!((zone.position[0] - 15.3).abs() < 1.0, "{zone:?}");
        }
        assert_eq!(softening(6.0, 1.1), None);
        assert_eq!(softening(40.0, 0.6), None);
    }

    #[test]
    fn a_body_is_warned_of_once() {
        let sheet = Sheet(|x: f64, _: f64| gaussian(x - 15.3, 1.0));
        let bodies: [&dyn Body; 1] = [&sheet];
        let mut watcher = Watcher::default();
        let mut clock = Clock::default();
        watcher.open(0, &Totals::default(), &crate::exchange::Exchange::default(), false);
        for steps in [16, 255, 256, 257, 512] {
            clock.steps = steps;
            watcher.look_at_fields(&clock, &bodies, (2, false), Some(1.0));
        }
        let [warning] = watcher.warnings() else { panic!("{:?}", watcher.warnings()) };
        let Finding::Localised { body, cells, needed, .. } = &warning.finding else { panic!("{warning}") };
        assert!(body == "sheet" && *needed == 0.25 * cells, "{warning}");
    }
}
