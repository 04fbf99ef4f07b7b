//! Comparison of neighbour searches on the point sets of smoothed particle benchmarks.

use benchmarks::search::{NAMES, Searched, searched};
use benchmarks::{Cloud, bar, lattice};
use examples::CaseError;
use examples::plug::Plug;
use mpm_core::Team;
use mpm_core::geometry::search::Reach;

use crate::page::{asked, table};

/// Indices in [`NAMES`].
const CELLS: usize = 0;
const STRIPS: usize = 4;
/// Linearity limit: time per point of a million points over that of a tenth of them.
const LINEAR: f64 = 1.15;

/// Requirements for a set: maximum nanoseconds per point for cells, and minimum ratio of strips to cells.
#[derive(Clone, Copy, Default)]
struct Bars {
    nanoseconds: Option<f64>,
    faster: Option<f64>,
}

/// Point set with its search results.
struct Row {
    name: String,
    points: usize,
    found: Searched,
    bars: Bars,
}

impl Row {
    fn of<const D: usize>(name: &str, cloud: &Cloud<D>, rounds: u32, bars: Bars) -> Result<Self, CaseError> {
        eprintln!("  {name}");
        let found = searched(cloud, Reach::sum(0.0), (NAMES.len(), rounds), &Team::one())
            .map_err(|error| CaseError::Other(format!("{name}: {error}")))?;
        Ok(Row { name: name.into(), points: cloud.positions.len(), found, bars })
    }

    /// Time per point, ns.
    fn each(&self, kind: usize) -> f64 {
        1e9 * self.found.seconds[kind] / self.points as f64
    }

    fn cells(&self) -> Vec<String> {
        let mut cells =
            vec![self.name.clone(), self.points.to_string(), format!("{:.1}", self.found.neighbours)];
        cells.extend((0..NAMES.len()).map(|kind| format!("{:.0}", self.each(kind))));
        let most = self.bars.nanoseconds.map(|most| asked(most, self.each(CELLS) <= most));
        cells.push(most.unwrap_or("-".into()));
        let ratio = self.each(STRIPS) / self.each(CELLS);
        cells.push(format!("{ratio:.1}"));
        let least = self.bars.faster.map(|least| asked(least, ratio >= least));
        cells.push(least.unwrap_or("-".into()));
        cells
    }
}

/// Axisymmetric Taylor bar of 20 x 200 particles.
fn taylor() -> Result<Cloud<2>, CaseError> {
    let spacing = bar::SIZE[0] / bar::PRINTED as f64;
    let mut cloud = lattice([bar::PRINTED, 10 * bar::PRINTED], 1);
    cloud.positions.as_flattened_mut().iter_mut().for_each(|x| *x *= spacing);
    cloud.radii.iter_mut().for_each(|radius| *radius *= spacing);
    Ok(cloud)
}

/// Projectile and plate of the plug case as published.
fn plug() -> Result<Cloud<2>, CaseError> {
    let layout = Plug::PRINTED.projectile()?.and(Plug::PRINTED.plate()?);
    Ok(Cloud::smoothed(&layout.positions, &layout.spacings, 2))
}

/// Measure the time per point of all searches on all sets, ns.
pub fn times(quick: bool) -> Result<Option<String>, CaseError> {
    let rounds = if quick { 3 } else { 7 };
    let uniform = |side: usize| lattice([side; 2], 3);
    let flat = Bars { nanoseconds: Some(80.0), faster: Some(4.0) };
    let graded = Bars { nanoseconds: Some(220.0), faster: Some(2.5) };
    let space = Bars { nanoseconds: Some(400.0), faster: None };
    let rows = [
        // More rounds, since a search takes a fraction of a millisecond.
        Row::of("Taylor bar, 20 x 200", &taylor()?, 10 * rounds, Bars::default())?,
        Row::of("graded plate and projectile, radii 1 to 10", &plug()?, rounds, graded)?,
        Row::of("uniform, plane", &uniform(316), rounds, flat)?,
        Row::of("uniform, plane", &uniform(1000), rounds, flat)?,
        Row::of("the same in random order", &uniform(1000).shuffled(4), rounds, Bars::default())?,
        Row::of("uniform, space", &lattice([46; 3], 5), rounds, space)?,
    ];
    let growth = rows[3].each(CELLS) / rows[2].each(CELLS);
    let mut head = vec!["points", "number", "neighbours"];
    head.extend(NAMES);
    head.extend(["asked of cells", "strip PIB / cells", "asked"]);
    let cells: Vec<Vec<String>> = rows.iter().map(Row::cells).collect();
    Ok(Some(format!(
        "## Search for neighbours\n\nNanoseconds of processor time a point on one thread, structure and lists of both sides together, the \
         fastest of several in alternation: sorted cells with a level for each power of two of the range, cells of one level, a tree, points \
         in boxes (PIB) and in strips of them. Sets are particles with smoothing lengths of 1.3 spacings, each moved by up to a tenth of \
         one, in the order of their lattice unless told otherwise; the graded one is the plug case, smoothing lengths differ \
         tenfold. All searches find the same lists, or the program ends here. From 10^5 to 10^6 points in the plane the time a point by \
         cells grows to {growth:.2} times (linear is asked, {LINEAR} at most: {}).\n\n{}",
        if growth <= LINEAR { "met" } else { "missed" },
        table(head, &cells)
    )))
}
