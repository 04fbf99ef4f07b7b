//! What a sweep over a batch is.

use mpm_materials::Breakdown;
use mpm_materials::material::{Deformation, Length, Material, Motion, Response, States, StatesMut};

use super::batch::{
    Batch, GROUP, MOST_GROUPS, MOST_NODES, Moving, Nodes, OCTET, Reason, Record, Row, Rows, Trouble,
};
use crate::law::Probe;

/// The groups of a batch, by place.
const GROUPS: [u32; MOST_GROUPS] = {
    let mut groups = [0; MOST_GROUPS];
    let mut n = 0;
    while n < groups.len() {
        groups[n] = n as u32;
        n += 1;
    }
    groups
};

/// What a sweep does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// Changes of volume, to be averaged over nodes.
    Stretch,
    /// Strain and law; then forces or, where mean stresses are averaged, those.
    Stress,
    /// Forces of the states as they are.
    Force,
}

/// What a sweep over a batch works with.
pub(crate) struct Of<'a> {
    pub material: &'a dyn Material<f64>,
    pub numbers: usize,
    pub probe: &'a Probe,
    /// kappa G and kappa rho0 c of hourglass springs and dashpots.
    pub control: [f64; 2],
    /// Part of its reference volume at which a point counts as gone: zero, but with erosion.
    pub least: f64,
    pub dt: f64,
}

/// Memory of a thread for elements on their way through their law.
#[derive(Debug)]
pub(crate) struct Scratch {
    /// The nodes of the batch.
    pub moving: Box<Nodes>,
    /// Modes of the positions, octet by octet.
    pub modes: Vec<Rows>,
    pub deformations: Vec<Deformation<Row>>,
    pub lengths: Vec<Row>,
    /// Rates at which points close, 1/s.
    pub closing: Vec<Rows>,
    /// Averages over the nodes of each element.
    pub averages: Vec<Rows>,
    /// Frequency bounds of the elements.
    pub rates: Vec<Rows>,
    /// Elements of each octet that are inside out, or at most [`Of::least`] of their volume, a bit each.
    pub low: Vec<u32>,
    pub response: Response<f64>,
    /// States before a step.
    pub before: Vec<Row>,
}

impl Default for Scratch {
    fn default() -> Self {
        Scratch {
            moving: Box::new([Moving::default(); MOST_NODES]),
            modes: Vec::new(),
            deformations: Vec::new(),
            lengths: Vec::new(),
            closing: Vec::new(),
            averages: Vec::new(),
            rates: Vec::new(),
            low: Vec::new(),
            response: Response::default(),
            before: Vec::new(),
        }
    }
}

impl Scratch {
    /// Be long enough.
    pub fn fit(&mut self, octets: usize, points: usize) {
        let grow = |list: &mut Vec<Rows>, n: usize| {
            if list.len() < n {
                list.resize(n, Rows::default());
            }
        };
        grow(&mut self.modes, octets * 24);
        grow(&mut self.closing, octets * points);
        grow(&mut self.averages, octets);
        grow(&mut self.rates, octets);
        self.low.clear();
        self.low.resize(octets, 0);
        self.deformations.resize(octets * points, Deformation::default());
        self.lengths.resize(octets * points * 2, Row::default());
    }

    /// Lead the states of a batch through a step.
    pub fn advance(&mut self, of: &Of<'_>, rows: &mut [Row], groups: usize) {
        let (length, dt) = (Length::Each(&self.lengths), of.dt);
        let motion = Motion { deformation: &self.deformations, dt, length };
        let states = StatesMut { all: rows, stride: of.numbers, first: 0, groups: &GROUPS[..groups] };
        of.material.advance(&motion, states, true, &mut self.response);
    }

    /// What the law says of states as they stand.
    pub fn describe(&mut self, of: &Of<'_>, rows: &[Row], groups: usize) {
        let states = States { all: rows, stride: of.numbers, first: 0, groups: &GROUPS[..groups] };
        // Viscous stresses, which bound a step by the size of elements, come with the first strain.
        of.material.describe(states, f64::INFINITY, &mut self.response);
    }

    /// The first point of an element that is there whose law broke down.
    pub fn first_fault(&self, batch: &Batch, points: usize) -> Option<(usize, Trouble)> {
        let element = |group: usize, lane: usize| group / 2 / points * OCTET + group % 2 * GROUP + lane;
        let faults = self.response.faults().iter().map(|f| (element(f.group, f.lane), f.cause));
        let (e, cause) = faults.filter(|(e, _)| batch.alive(*e, points)).min_by_key(|(e, _)| *e)?;
        let inverted = cause == Breakdown::InvertedVolume;
        Some((e, if inverted { Trouble::Inverted } else { Trouble::Law(cause) }))
    }
}

/// Says which elements of a batch leave after a sweep, by place, and why.
pub(crate) type Leaving<'a> = &'a dyn Fn(&Batch, &Scratch) -> Vec<(usize, Reason)>;

/// Elements of one kind and technology.
pub(crate) trait Sweep: Send + Sync {
    /// Nodes of an element.
    fn nodes(&self) -> usize;
    /// Its integration points.
    fn points(&self) -> usize;
    /// Numbers it keeps beside states.
    fn kept(&self) -> usize;
    /// Are volumes and mean stresses averaged over nodes?
    fn averaged(&self) -> bool {
        false
    }
    /// Where among the numbers kept the energy of hourglass forces is.
    fn energy_place(&self) -> Option<usize> {
        None
    }
    /// Sweep a batch, whose node numbers are in the scratch; sums over its elements go to `slots`, one a node.
    fn sweep(
        &self,
        pass: Pass,
        of: &Of<'_>,
        batch: &mut Batch,
        scratch: &mut Scratch,
        slots: &mut [Record],
        leaving: Leaving<'_>,
    );
    /// Reference volumes of the points of an element with these corners, parts of its volume that its corners weigh by, its size and
    /// half edges, m.
    fn measure(&self, corners: &[[f64; 3]]) -> Measure;
}

/// What an element measures.
#[derive(Clone, Debug, Default)]
pub(crate) struct Measure {
    /// Volume of each point.
    pub volumes: Vec<f64>,
    /// Integral of the shape function of each corner.
    pub shares: Vec<f64>,
    /// The edge of a square (cube) of its area (volume), m.
    pub size: f64,
    /// Half edges, m; none of simplices and bars.
    pub half_edges: Option<[[f64; 3]; 3]>,
}
