//! Distortion suite of the particle-contact meshfree method: scenes in which elements are distorted until they are deleted, with the
//! original rules and with the consistent ones.

mod scenes;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Check, Common, Report, Restart, Totals, case};
use mpm_core::output::picture::{ColourMap, FieldPicture, Panels, Quantity};

use scenes::{Outcome, Parts};

/// Bar at ten times its speed, shear flow, spinning disc, stretch to fracture, random packings: what fails with the
/// printed rules of the particle-contact method and what does not with ours.
///
/// What the printed rules fail at is declared and counts as missed; the exit code says whether all else holds.
#[derive(Debug, Parser)]
#[command(name = "pcmm_distortion", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Random packings, 1 to 1000 [default: 2, 10 or 100 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: Option<u32>,
}

const PARTS: [(Parts, &str); 2] = [(Parts::Printed, "printed"), (Parts::Consistent, "ours")];
const MOMENTUM_TOLERANCE: f64 = 1e-11;
/// Leap-frog velocities are half a step from the stresses; shocks are a few elements wide.
const ENERGY_TOLERANCE: f64 = 0.02;
const ADDED_TOLERANCE: f64 = 0.02;
/// Mass fraction without elements.
const COVER_TOLERANCE: f64 = 0.02;
/// Relative change of the deviators after a whole rotation.
const TURNED_TOLERANCE: f64 = 0.05;
/// Known failures of the original rules: check, largest number of cells, reason.
const PRINTED: [(&str, u32, &str); 9] = [
    (
        "spinning disc: energy error",
        8,
        "as printed, stress that does not turn does work: 2.3 % with 8 cells, 1.5 % with 10",
    ),
    ("shear flow: energy added", u32::MAX, "as printed, revisions add 12 % of the energy"),
    ("shear flow: mass", u32::MAX, "as printed, two thirds of the matter lose their elements"),
    ("deviators off", u32::MAX, "as printed, stress does not turn with the matter"),
    ("strip: stretch", u32::MAX, "as printed, the strip parts at 1.25"),
    ("strip: mass", u32::MAX, "as printed, two thirds of the matter lose their elements"),
    ("area uncovered", u32::MAX, "as printed, fans leave a quarter of the area uncovered"),
    ("area covered twice", u32::MAX, "as printed, fans cover most of the area twice"),
    ("packings, worst: energy added", u32::MAX, "as printed, revisions add 4 % of the energy"),
];
/// Rounding of areas.
const AREA_TOLERANCE: f64 = 1e-9;

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("pcmm_distortion")?;
    let seeds = options.seeds.unwrap_or(common.resolution.choose(2, 10, 100));
    let cells = common.resolution.choose(8, 10, 20);
    let clock = std::time::Instant::now();
    let (mut checks, mut totals, mut ends) = (Vec::new(), Totals::default(), Vec::new());
    let mut note = |outcome: &Outcome| {
        totals.steps += outcome.steps;
        totals.particles += outcome.snapshot.len();
        totals.updates += outcome.steps as f64 * outcome.snapshot.len() as f64;
    };
    for (parts, name) in PARTS {
        let mut list = List { parts, name, cells, checks: Vec::new() };
        let bar = scenes::fast_bar(parts, cells, restart)?;
        note(&bar);
        list.body("bar at 500 m/s", &bar);
        list.gate("bar at 500 m/s: mass in elements / at the start", bar.covered, 1.0, COVER_TOLERANCE);
        ends.push((format!("{name}: bar at 500 m/s"), bar.snapshot));
        let flow = scenes::shear_flow(parts, cells, restart)?;
        note(&flow);
        list.body("shear flow", &flow);
        list.gate("shear flow: mass in elements / at the start", flow.covered, 1.0, COVER_TOLERANCE);
        ends.push((format!("{name}: sheared by 4"), flow.snapshot));
        let (disc, turned) = scenes::spinning_disc(parts, cells, restart)?;
        note(&disc);
        list.body("spinning disc", &disc);
        list.gate("spinning disc: deviators off those turned", turned, 0.0, TURNED_TOLERANCE);
        let (strip, parted) = scenes::stretch(parts, cells, restart)?;
        note(&strip);
        list.least("strip: stretch at which it parts, or at the end", parted, 2.0);
        list.gate("strip: mass in elements / at the start", strip.covered, 1.0, COVER_TOLERANCE);
        ends.push((format!("{name}: stretched by {parted:.2}"), strip.snapshot));
        let mut worst = [0.0f64; 6];
        for seed in 0..seeds {
            let (outcome, cover) = scenes::random_packing(parts, u64::from(seed), restart)?;
            note(&outcome);
            let found = [
                cover.holes,
                cover.double,
                1.0 - outcome.reached,
                outcome.momentum,
                outcome.energy,
                outcome.added,
            ];
            for (worst, found) in worst.iter_mut().zip(found) {
                *worst = examples::worst([*worst, found]);
            }
        }
        let [holes, double, missed, momentum, energy, added] = worst;
        list.gate("random packings, worst: area uncovered", holes, 0.0, AREA_TOLERANCE);
        list.gate("random packings, worst: area covered twice", double, 0.0, AREA_TOLERANCE);
        list.gate("random packings, worst: part of the time not reached", missed, 0.0, 1e-9);
        list.gate("random packings, worst: momentum error", momentum, 0.0, MOMENTUM_TOLERANCE);
        list.gate("random packings, worst: energy error", energy, 0.0, ENERGY_TOLERANCE);
        list.gate("random packings, worst: energy added by revisions", added, 0.0, ADDED_TOLERANCE);
        checks.extend(list.checks);
    }
    totals.wall_seconds = clock.elapsed().as_secs_f64();
    let mut panels = Panels::new(3).title("Distorted bodies at their ends");
    for (title, end) in &ends {
        let speed = Quantity::component("velocity", 0).label("velocity along x").map(ColourMap::Viridis);
        panels = panels.panel(title.clone(), FieldPicture::new(430, 380).colour_by(speed).draw(end)?);
    }
    panels.compose()?.save(folder.join("ends.png"))?;
    let settings = serde_json::json!({ "cells": cells, "seeds": seeds });
    Report::new("pcmm_distortion", common.resolution, settings, &totals, checks).finish(common, &folder)
}

/// Checks of one set of parts.
struct List {
    parts: Parts,
    name: &'static str,
    cells: u32,
    checks: Vec<Check>,
}

impl List {
    fn push(&mut self, check: Check) {
        let printed = self.parts == Parts::Printed;
        let known = PRINTED
            .iter()
            .find(|(what, cells, _)| printed && self.cells <= *cells && check.name.contains(what));
        self.checks.push(match known {
            Some((_, _, reason)) => check.known_miss(reason),
            None => check,
        });
    }
    fn gate(&mut self, what: &str, value: f64, reference: f64, tolerance: f64) {
        let name = format!("{}: {what}", self.name);
        self.push(Check::gate(name, value, "-", reference, tolerance, "conservation"));
    }
    fn least(&mut self, what: &str, value: f64, reference: f64) {
        let name = format!("{}: {what}", self.name);
        self.push(Check::at_least(name, value, "-", reference, "no crack in the matter"));
    }
    fn body(&mut self, scene: &str, outcome: &Outcome) {
        let cause = outcome.broke.clone().unwrap_or_else(|| "the end".into());
        let name = format!("{}: {scene}: part of the time reached", self.name);
        self.push(Check::gate(name, outcome.reached, "-", 1.0, 1e-9, &cause));
        self.gate(&format!("{scene}: momentum error"), outcome.momentum, 0.0, MOMENTUM_TOLERANCE);
        self.gate(&format!("{scene}: energy error"), outcome.energy, 0.0, ENERGY_TOLERANCE);
        self.gate(&format!("{scene}: energy added by revisions"), outcome.added, 0.0, ADDED_TOLERANCE);
    }
}
