//! Interface of the sweeps over batches, and their scratch memory.

use mpm_materials::Breakdown;
use mpm_materials::material::{Deformation, Length, Material, Motion, Response, States, StatesMut};

use super::batch::{
    Batch, GROUP, MOST_GROUPS, MOST_NODES, Moving, Nodes, OCTET, Reason, Record, Row, Rows, Trouble,
};
use crate::law::Probe;

/// Indices of the groups of a batch.
const GROUPS: [u32; MOST_GROUPS] = {
    let mut groups = [0; MOST_GROUPS];
    let mut n = 0;
    while n < groups.len() {
        groups[n] = n as u32;
        n += 1;
    }
    groups
};

/// Pass of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// Volume changes, to be averaged over nodes.
    Stretch,
    /// Strains and stresses; then internal forces or, with averaged volumes, mean stresses at the nodes.
    Stress,
    /// Internal forces of the present states.
    Force,
}

/// Parameters of a sweep over a batch.
pub(crate) struct Of<'a> {
    pub material: &'a dyn Material<f64>,
    pub numbers: usize,
    pub probe: &'a Probe,
    /// Hourglass coefficients: kappa G of springs, Pa, and kappa rho0 c of dashpots, Pa s/m.
    pub control: [f64; 2],
    /// Volume ratio at which a point erodes its element; zero without erosion.
    pub least: f64,
    pub dt: f64,
}

/// Scratch memory of a thread for the elements of a batch.
#[derive(Debug)]
pub(crate) struct Scratch {
    /// Nodes of the batch.
    pub moving: Box<Nodes>,
    /// Modes of the positions, octet by octet.
    pub modes: Vec<Rows>,
    pub deformations: Vec<Deformation<Row>>,
    pub lengths: Vec<Row>,
    /// Compression rates of the points, 1/s.
    pub closing: Vec<Rows>,
    /// Element means of the nodal averages.
    pub averages: Vec<Rows>,
    /// Half the frequency bounds of the elements, 1/s.
    pub rates: Vec<Rows>,
    /// Bit set for each octet: elements that are inside out, or have at most [`Of::least`] of their volume.
    pub low: Vec<u32>,
    pub response: Response<f64>,
    /// States before the step.
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
    /// Resize the buffers.
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

    /// Integrate the states of a batch over a step.
    pub fn advance(&mut self, of: &Of<'_>, rows: &mut [Row], groups: usize) {
        let (length, dt) = (Length::Each(&self.lengths), of.dt);
        let motion = Motion { deformation: &self.deformations, dt, length };
        let states = StatesMut { all: rows, stride: of.numbers, first: 0, groups: &GROUPS[..groups] };
        of.material.advance(&motion, states, true, &mut self.response);
    }

    /// Evaluate the law in the present states.
    pub fn describe(&mut self, of: &Of<'_>, rows: &[Row], groups: usize) {
        let states = States { all: rows, stride: of.numbers, first: 0, groups: &GROUPS[..groups] };
        // Viscous stresses, which limit the time step by the element size, enter with the first strain.
        of.material.describe(states, f64::INFINITY, &mut self.response);
    }

    /// First remaining element with a breakdown of the law at a point, and the cause.
    pub fn first_fault(&self, batch: &Batch, points: usize) -> Option<(usize, Trouble)> {
        let element = |group: usize, lane: usize| group / 2 / points * OCTET + group % 2 * GROUP + lane;
        let faults = self.response.faults().iter().map(|f| (element(f.group, f.lane), f.cause));
        let (e, cause) = faults.filter(|(e, _)| batch.alive(*e, points)).min_by_key(|(e, _)| *e)?;
        let inverted = cause == Breakdown::InvertedVolume;
        Some((e, if inverted { Trouble::Inverted } else { Trouble::Law(cause) }))
    }
}

/// Selection of the elements of a batch to remove after a sweep, by index, with the reason.
pub(crate) type Leaving<'a> = &'a dyn Fn(&Batch, &Scratch) -> Vec<(usize, Reason)>;

/// Sweep over elements of one kind and technology.
pub(crate) trait Sweep: Send + Sync {
    /// Number of nodes of an element.
    fn nodes(&self) -> usize;
    /// Number of integration points of an element.
    fn points(&self) -> usize;
    /// Number of history variables of an element beside the states.
    fn kept(&self) -> usize;
    /// True if volumes and mean stresses are averaged over nodes.
    fn averaged(&self) -> bool {
        false
    }
    /// Index of the hourglass energy among the history variables.
    fn energy_place(&self) -> Option<usize> {
        None
    }
    /// Sweep over a batch, whose node data are in the scratch; scatter sums over its elements to `slots`, one a node.
    fn sweep(
        &self,
        pass: Pass,
        of: &Of<'_>,
        batch: &mut Batch,
        scratch: &mut Scratch,
        slots: &mut [Record],
        leaving: Leaving<'_>,
    );
    /// Measure an element with these corners: reference volumes of the points, volumes lumped at the corners, size and half edges, m.
    fn measure(&self, corners: &[[f64; 3]]) -> Measure;
}

/// Measures of an element.
#[derive(Clone, Debug, Default)]
pub(crate) struct Measure {
    /// Volume of each integration point.
    pub volumes: Vec<f64>,
    /// Integral of the shape function of each corner.
    pub shares: Vec<f64>,
    /// Element size, m: edge of a square (cube) of its area (volume), of twice (six times) this for simplices.
    pub size: f64,
    /// Half edges, m; none for simplices and bars.
    pub half_edges: Option<[[f64; 3]; 3]>,
}
