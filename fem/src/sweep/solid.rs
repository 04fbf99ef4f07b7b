//! Passes over a batch of triangles, quadrilaterals, tetrahedra or bricks.

use std::marker::PhantomData;

use impactite_simd::Float;

use super::average::{Locate, MeanStress, Stretch};
use super::batch::{Batch, Left, OCTET, Reason, Record, Report, Rows, Trouble, lane_mut};
use super::give::{Give, Given};
use super::rule::{Rule, Solid};
use super::strain::{Check, Strain, Strained};
use super::work::{Leaving, Measure, Of, Pass, Scratch, Sweep};
use crate::shape::{Gradient, Shape};

impl<S: Shape, R: Rule, const HOOP: bool> Solid<S, R, HOOP> {
    /// Assemble internal forces at the corners and frequency bounds of a batch; repeat without the removed elements.
    fn give(
        of: &Of<'_>,
        batch: &mut Batch,
        scratch: &mut Scratch,
        slots: &mut [Record],
        leaving: Leaving<'_>,
    ) {
        let mut give = |batch: &Batch, scratch: &mut Scratch| {
            slots.fill([0.0; 4]);
            let Scratch { modes, rates, closing, averages, low, response, .. } = scratch;
            let (slots, kind) = (&mut slots[..], PhantomData::<(S, R)>);
            let out = Given { rates, low, slots };
            f64::dispatch(Give::<S, R, HOOP> { of, batch, modes, closing, averages, response, out, kind })
        };
        let mut rate = give(batch, scratch);
        if let Some(octet) = scratch.low.iter().position(|low| *low != 0) {
            let e = octet * OCTET + scratch.low[octet].trailing_zeros() as usize;
            // In the same element a failure of the law comes before inversion.
            batch.report.trouble =
                batch.report.trouble.filter(|(broken, _)| *broken <= e).or(Some((e, Trouble::Inverted)));
        }
        let gone = leaving(batch, scratch);
        if !gone.is_empty() {
            for (e, reason) in gone {
                Self::remove(of, batch, e, reason);
            }
            rate = give(batch, scratch);
        }
        batch.report.rate = rate;
    }

    /// Remove an element.
    fn remove(of: &Of<'_>, batch: &mut Batch, e: usize, reason: Reason) {
        let (mut energy, mut state) = (0.0, vec![0.0; of.numbers]);
        for point in 0..Self::POINTS {
            batch.read(e, (point, Self::POINTS), &mut state);
            let volume = lane_mut(&mut batch.reference[e / OCTET * Self::POINTS + point], e % OCTET);
            energy += *volume * of.material.energy_of(&state).unwrap_or_default();
            *volume = 0.0;
        }
        let mut hourglass = 0.0;
        for k in 0..Self::KEPT {
            let kept = lane_mut(&mut batch.kept[e / OCTET * Self::KEPT + k], e % OCTET);
            hourglass = std::mem::take(kept);
        }
        batch.report.left.push(Left { element: e, energy: energy + hourglass, hourglass, reason });
    }

    /// Erode elements with a collapsed integration point before the law is evaluated, if a volume criterion is set.
    fn thin(of: &Of<'_>, batch: &mut Batch, scratch: &mut Scratch) {
        if of.least == 0.0 {
            return;
        }
        let Scratch { moving, low, .. } = &mut *scratch;
        let least = of.least;
        f64::dispatch(Check::<S, R, HOOP> { least, batch, moving, low, kind: PhantomData });
        for octet in 0..batch.octets() {
            let low = std::mem::take(&mut scratch.low[octet]);
            for k in (0..OCTET).filter(|k| low >> k & 1 == 1) {
                Self::remove(of, batch, octet * OCTET + k, Reason::Erosion);
            }
        }
    }
}

impl<S: Shape, R: Rule, const HOOP: bool> Sweep for Solid<S, R, HOOP> {
    fn nodes(&self) -> usize {
        S::NODES
    }
    fn points(&self) -> usize {
        Self::POINTS
    }
    fn kept(&self) -> usize {
        Self::KEPT
    }
    fn averaged(&self) -> bool {
        R::AVERAGED
    }
    fn energy_place(&self) -> Option<usize> {
        R::CONTROL.then_some(Self::KEPT.wrapping_sub(1))
    }

    fn sweep(
        &self,
        pass: Pass,
        of: &Of<'_>,
        batch: &mut Batch,
        scratch: &mut Scratch,
        slots: &mut [Record],
        leaving: Leaving<'_>,
    ) {
        let groups = batch.octets() * Self::POINTS * 2;
        scratch.fit(batch.octets(), Self::POINTS);
        let kind = PhantomData::<(S, R)>;
        if pass != Pass::Force || !R::AVERAGED {
            batch.report = Report::default();
        }
        match pass {
            Pass::Stretch => {
                slots.fill([0.0; 4]);
                let moving = &*scratch.moving;
                f64::dispatch(Stretch::<S, HOOP> { of, batch, moving, slots, kind: PhantomData });
            }
            Pass::Stress => {
                Self::thin(of, batch, scratch);
                let Scratch { moving, modes, deformations, lengths, closing, .. } = &mut *scratch;
                let Batch { corners, sizes, reference, kept, .. } = &mut *batch;
                let out = Strained { modes, deformations, lengths, closing, kept };
                f64::dispatch(Strain::<S, R, HOOP> { of, corners, sizes, reference, moving, out, kind });
                scratch.advance(of, &mut batch.rows, groups);
                batch.report.trouble = scratch.first_fault(batch, Self::POINTS);
                if R::AVERAGED {
                    slots.fill([0.0; 4]);
                    f64::dispatch(MeanStress::<S> {
                        batch,
                        response: &scratch.response,
                        slots,
                        kind: PhantomData,
                    });
                } else {
                    Self::give(of, batch, scratch, slots, leaving);
                }
            }
            Pass::Force => {
                let Scratch { moving, modes, averages, closing, .. } = &mut *scratch;
                closing.fill(Rows::default());
                f64::dispatch(Locate::<S> { batch, moving, modes, averages, kind: PhantomData });
                scratch.describe(of, &batch.rows, groups);
                Self::give(of, batch, scratch, slots, leaving);
            }
        }
    }

    fn measure(&self, corners: &[[f64; 3]]) -> Measure {
        let mut nodal = [[0.0; 3]; 8];
        nodal[..S::NODES].copy_from_slice(corners);
        let x = S::modes(&nodal);
        let volume = |g: Gradient<f64>| g.volume * S::SCALE;
        let volumes: Vec<f64> = (0..Self::POINTS).map(|p| volume(Self::gradient(&x, p))).collect();
        // Integrals of the shape functions: by full integration; for a simplex in closed form.
        let mut shares = vec![0.0; S::NODES];
        if S::POINTS == 1 {
            let whole = volumes[0];
            for (c, share) in shares.iter_mut().enumerate() {
                let part = if HOOP {
                    (nodal[c][0] + 3.0 * x[0][0]) / (12.0 * x[0][0])
                } else {
                    1.0 / S::NODES as f64
                };
                *share = whole * part;
            }
        } else {
            for point in 0..S::POINTS {
                let part = volume(S::at(&x, point, HOOP));
                let at = [0, 1, 2].map(|axis| crate::shape::sign(point, axis));
                for (c, share) in shares.iter_mut().enumerate() {
                    *share += part * crate::shape::weight(S::DIM, c, at);
                }
            }
        }
        let flat: f64 = (0..S::POINTS).map(|p| volume(S::at(&x, p, false))).sum();
        let size = if S::POINTS == 1 { flat * [2.0, 6.0][S::DIM - 2] } else { flat };
        let size = size.max(0.0).powf(1.0 / S::DIM as f64);
        let half_edges = (S::POINTS > 1).then(|| {
            let third = if S::DIM == 3 { x[3] } else { [0.0; 3] };
            [x[1], x[2], third].map(|edge| edge.map(|c| c / S::UNIT))
        });
        Measure { volumes, shares, size, half_edges }
    }
}
