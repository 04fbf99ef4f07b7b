//! Error and cost of a flow by three methods: incompressible flow, weakly compressible material points and smoothed particles.

use std::sync::Arc;

use flow::{Flow, FlowOptions, Fluid, Wall};
use mpm_core::geometry::{Cuboid, Lattice, Seeds};
use mpm_core::output::picture::{Axis, Chart, Marker, Picture, Series, palette};
use mpm_core::{BlockGrid, Boundary, Deformable, Method, Mpm, PlaneStrain, Side, Solver, Watch};
use mpm_materials::{Fluid as Compressible, Tait};
use serde::Serialize;
use sph::{Layout, Sph};

use crate::{CaseError, Check, Totals, Water};

/// Method of a liquid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Incompressible flow.
    Flow,
    /// Weakly compressible material points.
    Mpm,
    /// Weakly compressible smoothed particles.
    Sph,
}

impl Kind {
    /// All methods.
    pub const ALL: [Kind; 3] = [Kind::Flow, Kind::Mpm, Kind::Sph];

    /// Name in tables and file names.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Kind::Flow => "flow",
            Kind::Mpm => "mpm",
            Kind::Sph => "sph",
        }
    }
}

/// Inviscid water in an open tank in the plane, from (0, 0), at rest at the start.
pub struct Tank<'a> {
    /// Length and height, m; walls without friction.
    pub size: [f64; 2],
    /// Cell size, m, twice the distance of particles.
    pub spacing: f64,
    /// Gravity, m/s^2.
    pub gravity: f64,
    /// Sound speed of compressible water, m/s.
    pub sound: f64,
    /// Particles on a lattice of this spacing, m, with this number of them along an edge of a cell.
    pub seeds: &'a dyn Fn(f64, usize) -> Result<Seeds<2>, CaseError>,
    /// Pressure of incompressible water at the start, Pa, from which compressible water starts.
    pub pressure: &'a dyn Fn([f64; 2]) -> f64,
}

impl Tank<'_> {
    /// Build the scene of a method, on one thread.
    ///
    /// # Errors
    /// Invalid constants.
    pub fn solver(&self, kind: Kind) -> Result<Box<dyn Solver>, CaseError> {
        let Tank { size, spacing, gravity, .. } = *self;
        let water = Water::of(self.sound);
        let walls = [(0, 0.0, Side::Above), (0, size[0], Side::Below), (1, 0.0, Side::Above)];
        Ok(match kind {
            Kind::Flow => {
                let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; 2], spacing)?));
                flow.add_wall(Wall::container(Cuboid::new([0.0; 2], size)?))?;
                let seeds = (self.seeds)(spacing, 2)?;
                flow.add_fluid("water", Fluid::new(Water::DENSITY)?, &seeds, |_| [0.0; 2])?;
                flow.set_body_force(move |_| [0.0, -gravity]);
                flow.set_watch(Watch::default().only_warn());
                Box::new(flow)
            }
            Kind::Mpm => {
                let (law, seeds) = (water.law()?, (self.seeds)(spacing, 2)?);
                let grid = BlockGrid::new(Lattice::new([0.0; 2], spacing)?);
                let mut mpm = Mpm::new(Method::contact_at_rest(PlaneStrain), grid);
                let body = Deformable::new("water", law, &seeds)
                    .in_state(|x| water.under(&law, (self.pressure)(x)))
                    .with_renewed_density();
                mpm.add_body(body)?;
                for (axis, at, side) in walls {
                    mpm.bound(Boundary::Symmetry { axis, at, side })?;
                }
                mpm.set_body_force(move |_| [0.0, -gravity]);
                mpm.set_watch(Watch::default().only_warn());
                Box::new(mpm)
            }
            Kind::Sph => {
                let layout = Layout::of_seeds(&(self.seeds)(0.5 * spacing, 1)?);
                let method = sph::Method::liquid(PlaneStrain);
                let mut sph = Sph::new(method, water.law()?, &layout, |_| [0.0; 2])?;
                for (axis, at, side) in walls {
                    sph.bound(Boundary::Wall { axis, at, side, velocity: 0.0 })?;
                }
                sph.set_body_force(Arc::new(move |_| [0.0, -gravity]));
                sph.set_states::<Compressible<Tait<f64>>>(|x, mut state| {
                    state.volume_ratio = water.ratio((self.pressure)(x));
                    state
                })?;
                sph.set_watch(Watch::default().only_warn());
                Box::new(sph)
            }
        })
    }
}

/// Error and cost of a run on one thread.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Cost {
    /// Method.
    pub kind: Kind,
    /// Cells over the length or depth.
    pub cells: u32,
    /// Relative error.
    pub error: f64,
    /// Totals of the run.
    #[serde(skip)]
    pub totals: Totals,
}

/// Core-seconds of a method at an error, by a power law between two runs of increasing resolution; none if no run has a smaller error.
fn seconds_at(costs: &[Cost], kind: Kind, error: f64) -> Option<f64> {
    let runs: Vec<&Cost> = costs.iter().filter(|c| c.kind == kind).collect();
    let first = runs.iter().position(|c| c.error <= error)?;
    let fine = runs[first];
    let Some(coarse) = first.checked_sub(1).map(|n| runs[n]) else { return Some(fine.totals.wall_seconds) };
    let part = (error / coarse.error).ln() / (fine.error / coarse.error).ln();
    let [from, to] = [coarse, fine].map(|c| c.totals.wall_seconds.ln());
    Some((from + part * (to - from)).exp())
}

/// Show error and core-seconds of all runs, and core-seconds of the methods at the error `at`.
#[must_use]
pub fn rows(costs: &[Cost], reference: &str, at: f64) -> Vec<Check> {
    let mut rows = Vec::new();
    for Cost { kind, cells, error, totals } in costs {
        let name = |what: &str| format!("cost, {}, {cells} cells: {what}", kind.name());
        rows.push(Check::unreferenced(name("error"), 100.0 * error, "%", reference));
        rows.push(Check::unreferenced(
            name("core-seconds"),
            totals.wall_seconds,
            "s",
            "steps, on one thread",
        ));
    }
    for kind in Kind::ALL {
        if let Some(seconds) = seconds_at(costs, kind, at) {
            let name = format!("cost, {}: core-seconds at an error of {} %", kind.name(), 100.0 * at);
            rows.push(Check::unreferenced(name, seconds, "s", "between two runs"));
        }
    }
    rows
}

/// Plot errors over core-seconds, one line a method.
///
/// # Errors
/// An error that is not positive.
pub fn chart(costs: &[Cost], error: &str) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 460)
        .x(Axis::new("core-seconds").logarithmic())
        .y(Axis::new(error).unit("%", 100.0).logarithmic());
    for (n, kind) in Kind::ALL.into_iter().enumerate() {
        let runs = costs.iter().filter(|c| c.kind == kind);
        let (seconds, errors): (Vec<f64>, Vec<f64>) = runs.map(|c| (c.totals.wall_seconds, c.error)).unzip();
        if !seconds.is_empty() {
            let line = Series::new(kind.name(), &seconds, &errors)?.marker(Marker::Circle);
            chart = chart.series(line.colour(palette(n)));
        }
    }
    Ok(chart.draw()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn core_seconds_at_an_error_follow_the_power_law_of_the_runs() {
        let run = |kind, cells, error, wall_seconds| Cost {
            kind,
            cells,
            error,
            totals: Totals { wall_seconds, ..Totals::default() },
        };
        let costs =
            [run(Kind::Flow, 8, 0.04, 1.0), run(Kind::Flow, 16, 0.0025, 16.0), run(Kind::Mpm, 8, 0.04, 1.0)];
        // Half of the way between both, in logarithms.
        assert!((seconds_at(&costs, Kind::Flow, 0.01).expect("reached") - 4.0).abs() < 1e-12);
        assert_eq!(seconds_at(&costs, Kind::Flow, 0.05), Some(1.0));
        assert_eq!(seconds_at(&costs, Kind::Mpm, 0.01), None);
    }
}
