//! Elements of one kind in a body.

use impactite_geometry::ElementKind;
use impactite_scene::{Archive, CheckpointError, SceneError};

use crate::law::Probe;
use crate::sweep::{BATCH, Batch, Measure, OCTET, Row, Rows, Sweep, lane, lane_mut, sweep_of};
use crate::technology::{Hourglass, Technology};

/// Input for the construction of element sets.
pub(crate) struct Making<'a, const D: usize> {
    pub body: &'a str,
    pub nodes: &'a [[f64; D]],
    pub virgin: &'a [f64],
    pub probe: &'a Probe,
    pub hoop: bool,
    pub section: f64,
}

/// Elements of one kind, in batches of neighbours.
pub(crate) struct Set {
    pub kind: ElementKind,
    pub technology: Technology,
    pub sweep: Box<dyn Sweep>,
    /// Element numbers in the body, in the order of the batches.
    pub numbers: Vec<u32>,
    pub batches: Vec<Batch>,
    /// Offset of the nodes of each batch among the slots of the set.
    pub starts: Vec<u32>,
    /// Offset of the set among the slots of the body.
    pub first: usize,
    /// Hourglass coefficients: kappa G of springs, Pa, and kappa rho0 c of dashpots, Pa s/m.
    pub control: [f64; 2],
}

impl Set {
    /// Build a set from elements, given by number in the body and nodes; add their lumped masses to `masses`.
    pub fn new<const D: usize>(
        kind: ElementKind,
        technology: Technology,
        mut elements: Vec<(u32, &[u32])>,
        making: &Making<'_, D>,
        masses: &mut [f64],
    ) -> Result<Self, SceneError> {
        let sweep = sweep_of(kind, technology, making.hoop, making.section);
        neighbours_together(&mut elements, making.nodes);
        let control = match technology {
            Technology::OnePoint(Hourglass::Stiffness(k)) => [k * making.probe.hourglass_modulus(), 0.0],
            Technology::OnePoint(Hourglass::Viscous(k)) => {
                [0.0, k * making.probe.density * making.probe.speed]
            }
            _ => [0.0; 2],
        };
        let mut set = Set {
            kind,
            technology,
            numbers: elements.iter().map(|(number, _)| *number).collect(),
            batches: Vec::new(),
            starts: vec![0],
            first: 0,
            control,
            sweep,
        };
        let mut places = vec![u16::MAX; making.nodes.len()];
        for elements in elements.chunks(BATCH) {
            let batch = set.batch(elements, making, &mut places, masses)?;
            let end = set.starts.last().copied().unwrap_or(0) + batch.nodes.len() as u32;
            set.starts.push(end);
            set.batches.push(batch);
        }
        Ok(set)
    }

    /// Build a batch; `places` is restored at the end.
    fn batch<const D: usize>(
        &self,
        elements: &[(u32, &[u32])],
        making: &Making<'_, D>,
        places: &mut [u16],
        masses: &mut [f64],
    ) -> Result<Batch, SceneError> {
        let (points, octets, n) = (self.sweep.points(), elements.len().div_ceil(OCTET), self.sweep.nodes());
        let numbers = making.virgin.len();
        let mut batch = Batch {
            elements: elements.len(),
            corners: vec![0; octets * n * OCTET],
            sizes: vec![[Rows::default(); 2]; octets],
            reference: vec![Rows::default(); octets * points],
            rows: vec![Row::default(); octets * points * 2 * numbers],
            kept: vec![Rows::default(); octets * self.sweep.kept()],
            ..Batch::default()
        };
        for (at, row) in batch.rows.iter_mut().enumerate() {
            row.as_mut().fill(making.virgin[at % numbers]);
        }
        for octet in 0..octets {
            for k in 0..OCTET {
                // Lanes without an element repeat the last one, without mass.
                let e = (octet * OCTET + k).min(elements.len() - 1);
                let (number, nodes) = elements[e];
                for (c, &node) in nodes.iter().enumerate() {
                    let place = &mut places[node as usize];
                    if *place == u16::MAX {
                        *place = batch.nodes.len() as u16;
                        batch.nodes.push(node);
                    }
                    batch.corners[(octet * n + c) * OCTET + k] = *place;
                }
                let measure = measured(self.kind, &*self.sweep, number, nodes, making)?;
                let lightest = measure.shares.iter().fold(f64::INFINITY, |m, s| m.min(*s));
                *lane_mut(&mut batch.sizes[octet][0], k) = measure.size;
                *lane_mut(&mut batch.sizes[octet][1], k) = lightest * making.probe.density;
                if octet * OCTET + k >= elements.len() {
                    continue;
                }
                for (point, volume) in measure.volumes.iter().enumerate() {
                    *lane_mut(&mut batch.reference[octet * points + point], k) = *volume;
                }
                for (&node, share) in nodes.iter().zip(&measure.shares) {
                    masses[node as usize] += share * making.probe.density;
                }
                if self.kind == ElementKind::Bar2 {
                    // Initial ratio of lateral to axial strain: minus Poisson's ratio.
                    let Probe { bulk, shear, .. } = making.probe;
                    let ratio = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear);
                    *lane_mut(&mut batch.kept[octet], k) = -ratio;
                }
            }
        }
        for &node in &batch.nodes {
            places[node as usize] = u16::MAX;
        }
        Ok(batch)
    }

    /// Range of the slots of all batches.
    pub fn slots(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.starts.last().map_or(0, |&end| end as usize)
    }
    /// Remaining elements: batch, index in the batch, and number in the body.
    pub fn alive(&self) -> impl Iterator<Item = (&Batch, usize, u32)> {
        let points = self.sweep.points();
        self.batches.iter().zip(self.numbers.chunks(BATCH)).flat_map(move |(batch, numbers)| {
            (0..batch.elements).filter(move |&e| batch.alive(e, points)).map(move |e| (batch, e, numbers[e]))
        })
    }
    /// Nodes of an element of a batch.
    pub fn nodes_of<'a>(&self, batch: &'a Batch, e: usize) -> impl Iterator<Item = u32> + use<'a> {
        let n = self.sweep.nodes();
        (0..n).map(move |c| batch.nodes[batch.corners[(e / OCTET * n + c) * OCTET + e % OCTET] as usize])
    }
    /// Reference volume of an element.
    pub fn volume(&self, batch: &Batch, e: usize) -> f64 {
        let points = self.sweep.points();
        (0..points).map(|p| lane(&batch.reference[e / OCTET * points + p], e % OCTET)).sum()
    }
    /// Hourglass energy of an element, J.
    pub fn hourglass(&self, batch: &Batch, e: usize) -> f64 {
        let place = self.sweep.energy_place();
        place.map_or(0.0, |k| lane(&batch.kept[e / OCTET * self.sweep.kept() + k], e % OCTET))
    }
    pub fn bytes(&self) -> usize {
        let batches: usize = self.batches.iter().map(|b| b.bytes() + size_of::<Batch>()).sum();
        batches + (self.numbers.capacity() + self.starts.capacity()) * 4
    }

    /// Store or load the checkpoint data.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        for batch in &mut self.batches {
            let pairs = batch.reference.iter_mut().chain(&mut batch.kept).flat_map(|pair| &mut pair.0);
            for row in pairs.chain(&mut batch.rows) {
                file.reals(row.as_mut())?;
            }
        }
        Ok(())
    }
}

/// Measure an element, and check that volumes and lumped masses are positive and finite.
fn measured<const D: usize>(
    kind: ElementKind,
    sweep: &dyn Sweep,
    number: u32,
    nodes: &[u32],
    making: &Making<'_, D>,
) -> Result<Measure, SceneError> {
    let corners: Vec<[f64; 3]> = nodes.iter().map(|&n| wide(&making.nodes[n as usize])).collect();
    let measure = sweep.measure(&corners);
    let least = measure.volumes.iter().chain(&measure.shares).fold(f64::INFINITY, |m, v| m.min(*v));
    if least > 0.0 && least.is_finite() {
        return Ok(measure);
    }
    let field = if kind == ElementKind::Bar2 { "length" } else { "volume at an integration point" };
    Err(SceneError::Element {
        body: making.body.into(),
        element: number as usize,
        field,
        value: least,
        allowed: "positive and finite, nodes in the order of `ElementKind`",
    })
}

/// Pad a vector with zeros to three dimensions.
pub(crate) fn wide<const D: usize>(x: &[f64; D]) -> [f64; 3] {
    let mut wide = [0.0; 3];
    wide[..D].copy_from_slice(x);
    wide
}

/// Sort elements along a space-filling curve (Morton), so that those of a batch share most of their nodes.
fn neighbours_together<const D: usize>(elements: &mut [(u32, &[u32])], nodes: &[[f64; D]]) {
    let centre = |of: &[u32]| -> [f64; D] {
        std::array::from_fn(|d| of.iter().map(|&n| nodes[n as usize][d]).sum::<f64>() / of.len() as f64)
    };
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for (_, of) in elements.iter() {
        let c = centre(of);
        for d in 0..D {
            (low[d], high[d]) = (low[d].min(c[d]), high[d].max(c[d]));
        }
    }
    // Cell size of about one element, at least 2^-20 of the longest side.
    let longest = (0..D).map(|d| high[d] - low[d]).fold(0.0, f64::max);
    let volume: f64 = (0..D).map(|d| (high[d] - low[d]).max(1e-3 * longest)).product();
    let cell = (volume / elements.len() as f64).powf(1.0 / D as f64).max(longest / f64::from(1u32 << 20));
    elements.sort_by_cached_key(|(number, of)| {
        let c = centre(of);
        let mut key = 0u64;
        for d in 0..D {
            let along = ((c[d] - low[d]) / cell + 0.5) as u64;
            for bit in 0..21 {
                key |= (along >> bit & 1) << (bit * D + d).min(63);
            }
        }
        (key, *number)
    });
}
