//! Particle seeding of shapes.

use std::sync::atomic::{AtomicU64, Ordering};

use super::error::{Check, GeometryError};
use super::lattice::Lattice;
use super::shape::{Metric, Shape};
use super::vector::{norm, sum};
use impactite_simd::Team;
use impactite_simd::memory::{Budget, MOST_BYTES};

/// Maximum number of candidate sites of a filling.
const MOST_SITES: f64 = 1e12;
/// Columns of cells per task. Constant, so that results do not depend on the number of threads.
const COLUMNS_PER_TASK: usize = 16;

/// Criterion for seeding a site, and volume of its particle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Edge {
    /// Seed sites whose particle centre is inside, with the whole volume.
    Centre,
    /// Seed every site that the shape overlaps, with the fraction of the volume that is inside.
    Partial { subsamples: usize, drop_below: f64 },
}

/// Options for filling a shape. Default: Cartesian, one particle at every site whose centre is inside, the outermost layer
/// moved to half a particle below the surface ([`Filling::at_sites`] disables this), volumes corrected to the exact
/// measure of the shape.
///
/// ```
/// use impactite_geometry::Filling;
/// let filling = Filling::new().axisymmetric().partial(8, 0.1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filling {
    metric: Metric,
    edge: Edge,
    jitter: Option<(u64, f64)>,
    correct: bool,
    fit: bool,
    memory: u64,
}

impl Default for Filling {
    fn default() -> Self {
        Self {
            metric: Metric::Cartesian,
            edge: Edge::Centre,
            jitter: None,
            correct: true,
            fit: true,
            memory: MOST_BYTES,
        }
    }
}

impl Filling {
    /// Create the default options.
    pub fn new() -> Self {
        Self::default()
    }
    /// Set the metric of volumes.
    pub fn metric(mut self, metric: Metric) -> Self {
        self.metric = metric;
        self
    }
    /// Use coordinates (r, z) and volumes per radian (m3). Only r > 0 is filled.
    pub fn axisymmetric(self) -> Self {
        self.metric(Metric::Axisymmetric)
    }
    /// Give particles at the surface the fraction of their volume that is inside, sampled with `subsamples` points
    /// per axis. Particles below the fraction `drop_below` of a whole particle are dropped, and their volume
    /// goes to the largest neighbour. Particles stay at their sites, even if the site is outside.
    pub fn partial(mut self, subsamples: usize, drop_below: f64) -> Self {
        self.edge = Edge::Partial { subsamples, drop_below };
        self
    }
    /// Displace each particle at random by up to `amount` (0 to 1) of half its edge along every axis, before the
    /// inside test. The same `seed` gives the same particles; the displacement of a site does not depend
    /// on the shape.
    pub fn jittered(mut self, seed: u64, amount: f64) -> Self {
        self.jitter = Some((seed, amount));
        self
    }
    /// Leave all particles at their sites. By default, particles of the outermost layer that are neither jittered nor
    /// [partial](Filling::partial) are moved along the normal to half a particle below the surface. The displacement is at most half a
    /// particle (at edges, where two surfaces act, a whole one). A curved or oblique surface is then as smooth as the shape; a staircase
    /// would catch sliding bodies and start contact too early or too late. Where a surface is already midway between sites, nothing moves.
    pub fn at_sites(mut self) -> Self {
        self.fit = false;
        self
    }
    /// Leave the volumes uncorrected, instead of scaling them to the measure of the shape.
    pub fn uncorrected(mut self) -> Self {
        self.correct = false;
        self
    }
    /// Set the memory limit of the filling in bytes; default [`MOST_BYTES`].
    pub fn memory(mut self, bytes: u64) -> Self {
        self.memory = bytes;
        self
    }
}

/// Seeded particles, ready to become a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Seeds<const D: usize> {
    /// Positions (m), sorted by cell and by site within a cell; the first axis varies slowest in both.
    pub positions: Vec<[f64; D]>,
    /// Volumes: m3 in 3D, m2 in 2D, m3 per radian in axisymmetric use.
    pub volumes: Vec<f64>,
    /// Half the edge of a particle along each axis (m).
    pub half_size: [f64; D],
    /// Sum of the volumes before correction.
    pub raw_measure: f64,
    /// Exact measure of the shape, where known.
    pub exact_measure: Option<f64>,
    /// Sampled measure of the shape, where the exact one is unknown and a correction is requested.
    pub sampled_measure: Option<f64>,
    /// Correction factor of the volumes: target measure over raw measure; 1 without correction.
    pub correction: f64,
}

impl<const D: usize> Seeds<D> {
    /// Create particles at these positions, m, of these volumes and this half size, m, without filling a shape. The values are checked
    /// when the particles are added to a scene.
    pub fn placed(positions: Vec<[f64; D]>, volumes: Vec<f64>, half_size: [f64; D]) -> Self {
        let raw_measure = sum(volumes.iter().copied());
        Seeds {
            positions,
            volumes,
            half_size,
            raw_measure,
            exact_measure: None,
            sampled_measure: None,
            correction: 1.0,
        }
    }
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.positions.len()
    }
    /// True if there are no particles.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }
    /// Sum of the volumes.
    pub fn measure(&self) -> f64 {
        sum(self.volumes.iter().copied())
    }
    /// Centroid of the particles (m).
    pub fn centroid(&self) -> [f64; D] {
        let total = self.measure();
        let mut c = [0.0; D];
        for i in 0..D {
            c[i] = sum(self.positions.iter().zip(&self.volumes).map(|(x, v)| x[i] * v)) / total;
        }
        c
    }
}

/// Candidate sites: a range of cells, and the number of sites per cell edge.
struct Sites<'a, const D: usize> {
    lattice: &'a Lattice<D>,
    parts: usize,
    low: [i64; D],
    count: [usize; D],
}

impl<const D: usize> Sites<'_, D> {
    /// Number of columns of cells along the last axis.
    fn columns(&self) -> usize {
        self.count.iter().take(D.saturating_sub(1)).product()
    }
    /// Number of rows of sites in a column.
    fn rows(&self) -> usize {
        self.parts.pow(D.saturating_sub(1) as u32)
    }
    /// Return the cell of a column; its last index is that of the lowest cell.
    fn column_cell(&self, column: usize) -> [i64; D] {
        let (mut cell, mut rest) = (self.low, column);
        for i in (0..D.saturating_sub(1)).rev() {
            cell[i] += (rest % self.count[i]) as i64;
            rest /= self.count[i];
        }
        cell
    }
    /// Return the site index within a cell along each axis but the last.
    fn row_part(&self, row: usize) -> [usize; D] {
        let (mut part, mut rest) = ([0; D], row);
        for i in (0..D.saturating_sub(1)).rev() {
            part[i] = rest % self.parts;
            rest /= self.parts;
        }
        part
    }
    fn site(&self, cell: [i64; D], part: [usize; D]) -> [f64; D] {
        let mut x = [0.0; D];
        for i in 0..D {
            x[i] = self.lattice.site(i, cell[i], part[i], self.parts);
        }
        x
    }
}

/// Particle below the volume fraction `drop_below`, whose volume goes to a neighbour.
struct Sliver<const D: usize> {
    cell: [i64; D],
    part: [usize; D],
    volume: f64,
}

/// Particles found by a task.
struct Found<const D: usize> {
    positions: Vec<[f64; D]>,
    volumes: Vec<f64>,
    /// Cell and site of each particle, for the neighbour search of slivers.
    keys: Vec<([i64; D], [usize; D])>,
    slivers: Vec<Sliver<D>>,
}

impl<const D: usize> Found<D> {
    fn new() -> Self {
        Self { positions: Vec::new(), volumes: Vec::new(), keys: Vec::new(), slivers: Vec::new() }
    }
    /// Release unused capacity.
    fn shrink(&mut self) {
        self.positions.shrink_to_fit();
        self.volumes.shrink_to_fit();
        self.keys.shrink_to_fit();
        self.slivers.shrink_to_fit();
    }
}

/// Memory estimate of a filling, bytes.
#[derive(Clone, Copy)]
struct Cost {
    /// Number of sites within the bounds.
    points: f64,
    /// Bytes of working memory for the sites, independent of the result.
    sites: f64,
    /// Bytes per particle, in the list of a task and in the combined list; `sliver` likewise.
    particle: u64,
    sliver: u64,
}

impl Cost {
    fn of<const D: usize>(sites: &Sites<'_, D>, filling: &Filling) -> Self {
        let count = sites.count.map(|n| n as f64);
        let parts = sites.parts as f64;
        let rows = parts.powi(D as i32 - 1);
        let row = count.last().copied().unwrap_or(0.0) * parts;
        let columns = count.iter().take(D.saturating_sub(1)).product::<f64>();
        let tasks = (columns / COLUMNS_PER_TASK as f64).ceil();
        let threads = (Team::ambient().threads() as f64).min(tasks);
        // Per thread: the volume fractions of a column, the inside flags of a row, the list of rows, and the buffers of transformed and
        // combined shapes for a row. Shared: the coordinates of a row; the tasks.
        let thread =
            (rows * row + row) * size_of::<f64>() as f64 + 2.0 * row + rows * size_of::<[usize; D]>() as f64;
        let shared = row * size_of::<f64>() as f64 + tasks * size_of::<Found<D>>() as f64;
        let dropping = matches!(filling.edge, Edge::Partial { drop_below, .. } if drop_below > 0.0);
        let key = if dropping { size_of::<([i64; D], [usize; D])>() } else { 0 };
        Self {
            points: columns * rows * row,
            sites: threads * thread + shared,
            particle: 2 * (size_of::<[f64; D]>() + size_of::<f64>() + key) as u64,
            sliver: 2 * size_of::<Sliver<D>>() as u64 + size_of::<(usize, f64)>() as u64,
        }
    }
}

/// Advance the splitmix64 generator: mix 64 bits.
fn mix(x: u64) -> u64 {
    let mut z = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Pseudorandom displacement in (-1, 1), determined by seed, cell and site.
fn displacement<const D: usize>(seed: u64, cell: [i64; D], part: [usize; D]) -> [f64; D] {
    let mut state = mix(seed);
    for i in 0..D {
        state = mix(state ^ cell[i] as u64);
        state = mix(state ^ part[i] as u64);
    }
    let mut u = [0.0; D];
    for c in &mut u {
        state = mix(state);
        // Midpoint of one of 2^52 equal intervals.
        *c = ((state >> 12) as f64 + 0.5) / (1u64 << 51) as f64 - 1.0;
    }
    u
}

/// Fill a shape with particles: `per_axis` particles along each axis of a lattice cell, at the centres
/// of equal parts of the cell.
///
/// Volumes are those of the parts (times r in axisymmetric use), scaled by one factor so that their
/// sum equals the exact measure of the shape, or a sampled one where that is unknown; the result includes the
/// factor. Positions are free of accumulated rounding, and results are identical for any number of threads.
///
/// ```
/// use impactite_geometry::{Disc, Filling, Lattice, fill};
/// let lattice = Lattice::new([0.0, 0.0], 0.02)?;
/// let seeds = fill(&Disc::new([0.3, 0.5], 0.1)?, &lattice, 2, &Filling::new())?;
/// assert!((seeds.measure() - 0.0314159265).abs() < 1e-10);
/// assert!((seeds.correction - 1.0).abs() < 0.02);
/// # Ok::<(), impactite_geometry::GeometryError>(())
/// ```
///
/// Memory: twice that of the particles (32 bytes each in space, 80 if slivers are dropped), and a number for every site of a column of
/// cells, for as many columns as there are threads.
///
/// # Errors
/// [`GeometryError`] if an option is out of range, the shape is unbounded, there are no particles, or the memory exceeds
/// [`Filling::memory`].
pub fn fill<const D: usize>(
    shape: &(impl Shape<D> + ?Sized),
    lattice: &Lattice<D>,
    per_axis: usize,
    filling: &Filling,
) -> Result<Seeds<D>, GeometryError> {
    let check = Check("Filling");
    check.that((1..=64).contains(&per_axis), "per_axis", per_axis as f64, "from 1 to 64")?;
    if let Edge::Partial { subsamples, drop_below } = filling.edge {
        check.that((2..=64).contains(&subsamples), "subsamples", subsamples as f64, "from 2 to 64")?;
        check.that(
            (0.0..=0.5).contains(&drop_below),
            "drop_below",
            drop_below,
            "from 0 to 1/2 of a particle",
        )?;
    }
    if let Some((_, amount)) = filling.jitter {
        check.that((0.0..=1.0).contains(&amount), "amount of jitter", amount, "from 0 to 1")?;
    }
    let sites = find_sites(shape, lattice, per_axis, filling.metric)?;
    let edge = lattice.spacing() / per_axis as f64;
    check.that(
        edge.powi(D as i32).is_normal(),
        "spacing of the lattice",
        lattice.spacing(),
        "such that the volume of a particle is a number that is not zero",
    )?;
    let budget = Budget {
        what: "the filling of the shape",
        allowed: filling.memory,
        remedy: "use a coarser lattice or fewer particles per cell, look at the units of shape and lattice, or allow more by `Filling::memory`",
    };
    let cost = Cost::of::<D>(&sites, filling);
    // A known measure gives an estimate of the number of particles.
    let known = shape.measure().map(|m| m / edge.powi(D as i32)).filter(|n| *n >= 0.0);
    budget.holds(cost.sites + known.map_or(0.0, |n| n.min(cost.points) * cost.particle as f64))?;
    let last: Vec<f64> = (0..sites.count.last().copied().unwrap_or(0) * per_axis)
        .map(|i| lattice.site(D - 1, sites.low[D - 1] + (i / per_axis) as i64, i % per_axis, per_axis))
        .collect();

    let columns = sites.columns();
    let held = AtomicU64::new(0);
    let beyond = |held: u64| budget.holds(cost.sites + held as f64).is_err();
    let mut tasks: Vec<Found<D>> = (0..columns.div_ceil(COLUMNS_PER_TASK)).map(|_| Found::new()).collect();
    Team::ambient().each(&mut tasks, |task, found| {
        let mut parts = vec![0.0; sites.rows() * last.len()];
        let mut inside = vec![false; last.len()];
        for column in task * COLUMNS_PER_TASK..((task + 1) * COLUMNS_PER_TASK).min(columns) {
            column_parts(shape, &sites, column, &last, filling, &mut inside, &mut parts);
            let before = [found.positions.len(), found.slivers.len()];
            emit(&sites, column, &parts, filling, edge, found);
            let new = (found.positions.len() - before[0]) as u64 * cost.particle
                + (found.slivers.len() - before[1]) as u64 * cost.sliver;
            // Integers, whose sum does not depend on the order. Above the limit, particles are counted for the error message but
            // not stored.
            if beyond(held.fetch_add(new, Ordering::Relaxed).saturating_add(new)) {
                *found = Found::new();
            }
        }
        found.shrink();
    });
    budget.holds(cost.sites + held.into_inner() as f64)?;

    let total = tasks.iter().map(|t| t.positions.len()).sum();
    let (mut positions, mut volumes) = (budget.room(total)?, budget.room(total)?);
    let mut keys = budget.room(tasks.iter().map(|t| t.keys.len()).sum())?;
    let mut slivers = budget.room(tasks.iter().map(|t| t.slivers.len()).sum())?;
    for task in tasks {
        positions.extend(task.positions);
        volumes.extend(task.volumes);
        keys.extend(task.keys);
        slivers.extend(task.slivers);
    }
    if positions.is_empty() {
        return Err(GeometryError::NoParticles { particle_edge: edge });
    }
    if filling.fit && filling.edge == Edge::Centre && filling.jitter.is_none() {
        let axis = filling.metric == Metric::Axisymmetric;
        Team::ambient().each(&mut positions, |_, x: &mut [f64; D]| {
            let fitted = fit(shape, *x, edge);
            if !axis || fitted[0] > 0.0 {
                *x = fitted;
            }
        });
    }
    let raw_measure = sum(volumes.iter().copied().chain(slivers.iter().map(|s| s.volume)));
    let homeless = merge(&slivers, &keys, &mut volumes, per_axis);

    let exact_measure = filling.metric.measure(shape);
    let mut sampled = None;
    // The volume of slivers without neighbours is distributed over all particles.
    let kept = raw_measure - homeless;
    let (correction, scale) = if filling.correct {
        let target = match exact_measure {
            Some(exact) => exact,
            None => {
                let fine = sampled_measure(shape, filling.metric, 0.125 * edge)?;
                sampled = Some(fine);
                fine
            }
        };
        check.that(target > 0.0, "measure of the shape", target, "positive and finite")?;
        (target / raw_measure, target / kept)
    } else {
        (1.0, raw_measure / kept)
    };
    if scale != 1.0 {
        for v in &mut volumes {
            *v *= scale;
        }
    }
    Ok(Seeds {
        positions,
        volumes,
        half_size: [0.5 * edge; D],
        raw_measure,
        exact_measure,
        sampled_measure: sampled,
        correction,
    })
}

/// Maximum number of moves of a particle: first for the nearest surface, then for others that are still too near, as at edges.
const FITS: usize = 4;

/// Return the fitted position of a particle of this edge at `x`: half an edge below the surface, if it is in the outermost layer.
fn fit<const D: usize>(shape: &(impl Shape<D> + ?Sized), x: [f64; D], edge: f64) -> [f64; D] {
    let (half, step) = (0.5 * edge, 1e-4 * edge);
    let mut place = x;
    for pass in 0..FITS {
        let depth = -shape.signed_distance_within(place, 1.1 * edge);
        if depth >= edge || (depth - half).abs() <= 1e-6 * edge {
            break;
        }
        let mut normal = [0.0; D];
        let mut square = 0.0;
        for i in 0..D {
            let [mut low, mut high] = [place; 2];
            low[i] -= step;
            high[i] += step;
            let rise = shape.signed_distance_within(high, 2.0 * edge)
                - shape.signed_distance_within(low, 2.0 * edge);
            normal[i] = rise / (2.0 * step);
            square += normal[i] * normal[i];
        }
        // Midway between two surfaces the normal is undefined.
        if (square - 1.0).abs() > 0.1 {
            break;
        }
        // Along the axis closest to the normal, sites are an edge apart: one site of each row is in this layer.
        let steepest = normal.iter().fold(0.0_f64, |a, n| a.max(n.abs()));
        let outermost = if pass == 0 { depth < steepest * edge * (1.0 - 1e-9) } else { depth < half };
        let beyond: [f64; D] = std::array::from_fn(|i| place[i] + normal[i] * (depth + 0.1 * edge));
        if !outermost || shape.contains(beyond) {
            break;
        }
        for i in 0..D {
            place[i] += normal[i] * (depth - half);
        }
    }
    let way: f64 = (0..D).map(|i| (place[i] - x[i]).powi(2)).sum();
    if way <= edge * edge && shape.contains(place) { place } else { x }
}

/// Find the range of cells within the bounds of the shape.
fn find_sites<'a, const D: usize>(
    shape: &(impl Shape<D> + ?Sized),
    lattice: &'a Lattice<D>,
    parts: usize,
    metric: Metric,
) -> Result<Sites<'a, D>, GeometryError> {
    let edge = lattice.spacing() / parts as f64;
    let mut bounds = shape.bounds();
    for axis in 0..D {
        if bounds.min[axis].is_nan() || bounds.max[axis].is_nan() {
            return Err(GeometryError::Unbounded { axis });
        }
    }
    if metric == Metric::Axisymmetric {
        let check = Check("Filling");
        check.that(D == 2, "dimension of an axisymmetric filling", D as f64, "2, the coordinates (r, z)")?;
        if bounds.min[0] < 0.5 * edge {
            let offset = lattice.origin()[0] / edge;
            check.that(
                (offset - offset.round()).abs() < 1e-9 * offset.abs().max(1.0),
                "origin[0] of the lattice",
                lattice.origin()[0],
                "a whole number of particle edges away from the axis r = 0 that the shape touches",
            )?;
        }
        bounds.min[0] = bounds.min[0].max(0.0);
    }
    if D == 0 || bounds.is_empty() {
        return Err(GeometryError::NoParticles { particle_edge: edge });
    }
    let (mut low, mut count, mut points) = ([0; D], [0; D], 1.0);
    for i in 0..D {
        if !(bounds.min[i].is_finite() && bounds.max[i].is_finite()) {
            return Err(GeometryError::Unbounded { axis: i });
        }
        let first = lattice.coordinate(i, bounds.min[i]).floor();
        let cells = lattice.coordinate(i, bounds.max[i]).floor() - first + 1.0;
        points *= cells * parts as f64;
        // Beyond this limit, a floating-point number does not resolve a position within a cell.
        let furthest = first.abs().max((first + cells).abs());
        if !(points <= MOST_SITES && furthest <= 1e12) {
            return Err(GeometryError::TooFine { points: points.max(furthest), allowed: MOST_SITES });
        }
        low[i] = first as i64;
        count[i] = cells as usize;
    }
    Ok(Sites { lattice, parts, low, count })
}

/// Compute the inside fraction of each site of a column, row by row.
fn column_parts<const D: usize>(
    shape: &(impl Shape<D> + ?Sized),
    sites: &Sites<'_, D>,
    column: usize,
    last: &[f64],
    filling: &Filling,
    inside: &mut [bool],
    parts: &mut [f64],
) {
    let cell = sites.column_cell(column);
    let edge = sites.lattice.spacing() / sites.parts as f64;
    let diagonal = 0.5 * edge * (D as f64).sqrt();
    for (row, out) in parts.chunks_mut(last.len()).enumerate() {
        let part = sites.row_part(row);
        let mut x = sites.site(cell, part);
        if filling.metric == Metric::Axisymmetric && x[0] <= 0.0 {
            out.fill(0.0);
            continue;
        }
        match (filling.edge, filling.jitter) {
            (Edge::Centre, None) => {
                shape.contains_row(x, last, inside);
                for (o, i) in out.iter_mut().zip(inside.iter()) {
                    *o = if *i { 1.0 } else { 0.0 };
                }
            }
            (Edge::Centre, Some((seed, amount))) => {
                for i in 0..last.len() {
                    let (at, within) = (site_cell(sites, cell, i), site_part(sites, part, i));
                    x = jitter(sites.site(at, within), seed, amount, at, within, edge);
                    out[i] = if shape.contains(x) { 1.0 } else { 0.0 };
                }
            }
            (Edge::Partial { subsamples, .. }, _) => {
                let mut i = 0;
                while i < last.len() {
                    x[D - 1] = last[i];
                    let distance = shape.signed_distance_within(x, 8.0 * diagonal);
                    let sure = distance.abs() - diagonal;
                    if sure < 0.0 {
                        out[i] = part_inside(shape, x, edge, subsamples, filling.metric);
                        i += 1;
                        continue;
                    }
                    // The distance bound also holds for the centres of the following particles.
                    let value = if distance < 0.0 { 1.0 } else { 0.0 };
                    let leap = last[i] + sure * (1.0 - 1e-9);
                    out[i] = value;
                    i += 1;
                    while i < last.len() && last[i] < leap {
                        out[i] = value;
                        i += 1;
                    }
                }
            }
        }
    }
}

/// Return the cell of site `i` of a row.
fn site_cell<const D: usize>(sites: &Sites<'_, D>, mut cell: [i64; D], i: usize) -> [i64; D] {
    cell[D - 1] += (i / sites.parts) as i64;
    cell
}

/// Return the index within its cell of site `i` of a row.
fn site_part<const D: usize>(sites: &Sites<'_, D>, mut part: [usize; D], i: usize) -> [usize; D] {
    part[D - 1] = i % sites.parts;
    part
}

fn jitter<const D: usize>(
    mut x: [f64; D],
    seed: u64,
    amount: f64,
    cell: [i64; D],
    part: [usize; D],
    edge: f64,
) -> [f64; D] {
    let u = displacement(seed, cell, part);
    for i in 0..D {
        x[i] += 0.5 * edge * amount * u[i];
    }
    x
}

/// Volume fraction of the cube of this edge about `x` that is inside the shape, sampled at `n^D` points.
fn part_inside<const D: usize>(
    shape: &(impl Shape<D> + ?Sized),
    x: [f64; D],
    edge: f64,
    n: usize,
    metric: Metric,
) -> f64 {
    let offset = |k: usize| ((k as f64 + 0.5) / n as f64 - 0.5) * edge;
    let mut last = [0.0; 64];
    let mut inside = [false; 64];
    let (last, inside) = (&mut last[..n], &mut inside[..n]);
    for (k, c) in last.iter_mut().enumerate() {
        *c = x[D - 1] + offset(k);
    }
    let (mut hits, mut all) = (0.0, 0.0);
    for row in 0..n.pow(D as u32 - 1) {
        let (mut y, mut rest) = (x, row);
        for i in 0..D - 1 {
            y[i] += offset(rest % n);
            rest /= n;
        }
        let weight = if metric == Metric::Axisymmetric { y[0].max(0.0) } else { 1.0 };
        shape.contains_row(y, last, inside);
        hits += weight * inside.iter().filter(|i| **i).count() as f64;
        all += weight * n as f64;
    }
    if all > 0.0 { hits / all } else { 0.0 }
}

/// Create particles from the inside fractions of a column, cell by cell.
fn emit<const D: usize>(
    sites: &Sites<'_, D>,
    column: usize,
    parts: &[f64],
    filling: &Filling,
    edge: f64,
    found: &mut Found<D>,
) {
    let (n, cells) = (sites.parts, sites.count[D - 1]);
    let mut cell = sites.column_cell(column);
    let whole = edge.powi(D as i32);
    let drop_below = match filling.edge {
        Edge::Centre => 0.0,
        Edge::Partial { drop_below, .. } => drop_below,
    };
    let rows: Vec<[usize; D]> = (0..sites.rows()).map(|row| sites.row_part(row)).collect();
    for k in 0..cells {
        for (row, row_part) in rows.iter().enumerate() {
            for within in 0..n {
                let inside = parts[row * cells * n + k * n + within];
                if inside <= 0.0 {
                    continue;
                }
                let mut part = *row_part;
                part[D - 1] = within;
                let mut x = sites.site(cell, part);
                let mut volume = whole * inside;
                if filling.metric == Metric::Axisymmetric {
                    // Integral of r over the part, whatever the final position of the particle.
                    volume *= x[0];
                }
                if inside < drop_below {
                    found.slivers.push(Sliver { cell, part, volume });
                    continue;
                }
                if let Some((seed, amount)) = filling.jitter {
                    x = jitter(x, seed, amount, cell, part, edge);
                }
                found.positions.push(x);
                found.volumes.push(volume);
                if drop_below > 0.0 {
                    found.keys.push((cell, part));
                }
            }
        }
        cell[D - 1] += 1;
    }
}

/// Add the volume of each sliver to its largest face neighbour, or else to its largest edge or corner
/// neighbour; return the volume of slivers without a neighbour.
fn merge<const D: usize>(
    slivers: &[Sliver<D>],
    keys: &[([i64; D], [usize; D])],
    volumes: &mut [f64],
    parts: usize,
) -> f64 {
    let neighbour = |s: &Sliver<D>, offset: [i64; D]| {
        let mut key = (s.cell, s.part);
        for i in 0..D {
            let global = s.part[i] as i64 + offset[i];
            key.0[i] += global.div_euclid(parts as i64);
            key.1[i] = global.rem_euclid(parts as i64) as usize;
        }
        keys.binary_search(&key).ok()
    };
    // Select the neighbours before any volume is added, so that the result does not depend on the order.
    let mut gifts = Vec::with_capacity(slivers.len());
    let mut homeless = 0.0;
    for s in slivers {
        let (mut best, mut fewest) = (None, usize::MAX);
        for code in 0..3usize.pow(D as u32) {
            let (mut offset, mut rest, mut steps) = ([0; D], code, 0);
            for o in &mut offset {
                *o = (rest % 3) as i64 - 1;
                steps += usize::from(*o != 0);
                rest /= 3;
            }
            // Face neighbours take precedence.
            let rank = if steps <= 1 { 1 } else { 2 };
            if steps == 0 || rank > fewest {
                continue;
            }
            if let Some(index) = neighbour(s, offset) {
                let better = match best {
                    None => true,
                    Some(b) => rank < fewest || volumes[index] > volumes[b],
                };
                if better {
                    (best, fewest) = (Some(index), rank);
                }
            }
        }
        match best {
            Some(index) => gifts.push((index, s.volume)),
            None => homeless += s.volume,
        }
    }
    for (index, volume) in gifts {
        volumes[index] += volume;
    }
    homeless
}

/// Sample the signed distance of a bounded shape to compute its measure where the exact one is unknown.
///
/// Boxes that the distance proves to be wholly inside or outside are not subdivided; the others are, down to
/// an edge of about `resolution` (m) or less (limited to about a million boxes). Richardson extrapolation
/// removes the error of second order in that edge. The result is identical for any number of threads.
///
/// # Errors
/// [`GeometryError`] if the shape is unbounded or empty, `resolution` is not positive, or a distance or the measure is NaN.
pub fn sampled_measure<const D: usize>(
    shape: &(impl Shape<D> + ?Sized),
    metric: Metric,
    resolution: f64,
) -> Result<f64, GeometryError> {
    let check = Check("sampled measure");
    check.positive("resolution", resolution)?;
    let mut b = shape.bounds();
    if metric == Metric::Axisymmetric {
        check.that(D == 2, "dimension of an axisymmetric measure", D as f64, "2, the coordinates (r, z)")?;
        b.min[0] = b.min[0].max(0.0);
    }
    let (mut longest, mut shortest) = (0.0f64, f64::INFINITY);
    for axis in 0..D {
        let extent = b.max[axis] - b.min[axis];
        if !extent.is_finite() && extent != f64::NEG_INFINITY {
            return Err(GeometryError::Unbounded { axis });
        }
        if extent <= 0.0 {
            return Ok(0.0);
        }
        longest = longest.max(extent);
        shortest = shortest.min(extent);
    }
    // Fine relative to lattice and shape, with a limit on the number of boxes at the surface.
    // Finer in the plane, where there are few boxes at the surface.
    let finest = if D <= 2 { 2048.0 } else { 256.0 };
    let mut leaf = resolution.min(longest / finest).min(shortest / 64.0);
    let most = 1e6;
    let mut faces = 0.0;
    for i in 0..D {
        faces += 2.0 * (0..D).filter(|j| *j != i).map(|j| b.max[j] - b.min[j]).product::<f64>();
    }
    if D > 1 {
        leaf = leaf.max((faces / most).powf(1.0 / (D as f64 - 1.0)));
    }
    // Initial division into nearly cubic boxes, about 16 along the longest side.
    let (mut count, mut size) = ([1usize; D], [0.0; D]);
    for i in 0..D {
        let extent = b.max[i] - b.min[i];
        count[i] = (16.0 * extent / longest).ceil().max(1.0) as usize;
        size[i] = extent / count[i] as f64;
    }
    let depth = (longest / 16.0 / leaf).log2().ceil().clamp(1.0, 30.0) as u32;
    let boxes: usize = count.iter().product();
    let mut measures = vec![[0.0; 2]; boxes];
    Team::ambient().each(&mut measures, |index, measure| {
        let (mut centre, mut rest) = ([0.0; D], index);
        for i in 0..D {
            centre[i] = b.min[i] + ((rest % count[i]) as f64 + 0.5) * size[i];
            rest /= count[i];
        }
        *measure = box_measure(shape, centre, size, depth, metric);
    });
    let [fine, coarse] = [0, 1].map(|i| sum(measures.iter().map(|m| m[i])));
    check.that(true, "measure", fine + (fine - coarse) / 3.0, "finite")
}

/// Measure of the shape within a box, from boxes after `depth` subdivisions and from those twice as large.
fn box_measure<const D: usize>(
    shape: &(impl Shape<D> + ?Sized),
    centre: [f64; D],
    size: [f64; D],
    depth: u32,
    metric: Metric,
) -> [f64; 2] {
    let diagonal = norm(size);
    let distance = shape.signed_distance_within(centre, diagonal);
    if distance >= 0.5 * diagonal {
        return [0.0; 2];
    }
    // A distance of NaN: subdivision is useless.
    if distance.is_nan() {
        return [f64::NAN; 2];
    }
    let mut whole = size.iter().product::<f64>();
    if metric == Metric::Axisymmetric {
        whole *= centre[0];
    }
    if distance <= -0.5 * diagonal {
        return [whole; 2];
    }
    if depth == 0 {
        return [whole * part_below(shape, centre, size, distance); 2];
    }
    let half = size.map(|s| 0.5 * s);
    let [mut fine, mut coarse] = [0.0; 2];
    for bits in 0..1usize << D {
        let mut c = centre;
        for i in 0..D {
            c[i] += if bits >> i & 1 == 1 { 0.5 * half[i] } else { -0.5 * half[i] };
        }
        let parts = box_measure(shape, c, half, depth - 1, metric);
        fine += parts[0];
        coarse += parts[1];
    }
    if depth == 1 {
        coarse = whole * part_below(shape, centre, size, distance);
    }
    [fine, coarse]
}

/// Volume fraction of a small box that is inside, with the surface approximated by a plane at this distance from its centre.
/// Exact for planes parallel to the faces; otherwise errors cancel along the surface.
pub(crate) fn part_below<const D: usize>(
    shape: &(impl Shape<D> + ?Sized),
    centre: [f64; D],
    size: [f64; D],
    distance: f64,
) -> f64 {
    // The extent of the box along any normal is at most its diagonal.
    let diagonal = norm(size);
    if distance.abs() >= 0.5 * diagonal {
        return if distance < 0.0 { 1.0 } else { 0.0 };
    }
    let mut normal = [0.0; D];
    for i in 0..D {
        let (mut x, step) = (centre, 1e-3 * size[i]);
        x[i] += step;
        normal[i] = (shape.signed_distance_within(x, diagonal) - distance) / step;
    }
    let length = norm(normal);
    // Extent of the box along the normal. On a ridge, where the normal is undefined, any estimate suffices.
    let mut extent = diagonal / (D as f64).sqrt();
    if length > 0.1 {
        extent = (0..D).map(|i| normal[i].abs() / length * size[i]).sum();
    }
    (0.5 - distance / extent).clamp(0.0, 1.0)
}
