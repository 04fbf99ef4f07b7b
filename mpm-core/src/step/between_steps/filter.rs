//! What nodes do not see of the particles' velocities, taken out cell by cell.

use nalgebra::{DMatrix, DVector};

use super::operations::NullSpaceFilter;
use crate::dim::block_nodes;
use crate::particles::{Block, Columns, Place};
use crate::step::bodies::particle_body::ParticleBody;
use crate::step::mpm::Mpm;
use crate::step::nodes::footprint::NodeWeight;
use impactite_scene::error::SceneError;
use impactite_simd::{Float, Team};

/// Steps of the singular value decomposition of a cell; more than it ever takes.
const MOST_STEPS: usize = 1000;

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Take out of every cell what its nodes do not see; the kinetic energy of that, J.
    pub(in crate::step) fn filter_cells(&mut self, team: &Team) -> f64 {
        let mut slots = std::mem::take(&mut self.slots);
        let mut sums = vec![0.0; slots.len()];
        let body = &*self;
        team.each_piece(&mut slots, 1, &mut sums, |_, slot, sum| {
            for bin in 0..block_nodes(D) {
                *sum += body.filter_cell(&mut slot[0].block, bin);
            }
        });
        self.slots = slots;
        sums.iter().sum()
    }

    fn filter_cell(&self, block: &mut Block<T, D>, bin: usize) -> f64 {
        let places: Vec<Place> = block.bin_places(bin).collect();
        if places.len() < 2 {
            return 0.0;
        }
        // sqrt(m) N, so that masses are the metric.
        let mut nodes: Vec<NodeWeight<D>> = Vec::new();
        let mut numbers = Vec::new();
        let mut roots = Vec::with_capacity(places.len());
        for &at in &places {
            self.node_weights(block, bin, at, &mut nodes);
            let root = self.mass_at(block, at).to_double().sqrt();
            numbers.extend(nodes.iter().map(|w| root * w.value));
            roots.push(root);
        }
        let weights = DMatrix::from_row_slice(places.len(), nodes.len(), &numbers);
        let smallest = T::default_epsilon().to_double().sqrt();
        let Some(svd) = weights.try_svd(true, false, f64::EPSILON, MOST_STEPS) else { return 0.0 };
        let Some(seen) = svd.u else { return 0.0 };
        let largest = svd.singular_values.max();
        let rank = svd.singular_values.iter().filter(|s| **s > smallest * largest).count();
        if rank == places.len() {
            return 0.0;
        }
        let mut lost = 0.0;
        for d in 0..D {
            let column = Columns::velocity(D) + d;
            let velocity =
                places.iter().zip(&roots).map(|(&at, root)| root * block.get(at, column).to_double());
            let before = DVector::from_iterator(places.len(), velocity);
            let mut after = DVector::zeros(places.len());
            for (s, direction) in svd.singular_values.iter().zip(seen.column_iter()) {
                if *s > smallest * largest {
                    after += direction * direction.dot(&before);
                }
            }
            lost += 0.5 * (before.norm_squared() - after.norm_squared());
            for (n, &at) in places.iter().enumerate() {
                block.set(at, column, T::of(after[n] / roots[n]));
            }
        }
        lost
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Every so many steps take out of the particles' velocities what the nodes of their cell do not see (Gritton and
    /// Berzins 2017): with the weights N of the n particles of a cell and body on its nodes, velocities become their
    /// projection, by mass, on the range of N, found by singular values. The momentum of every node stays as it is to
    /// rounding, and so does the next step; what changes is the noise that FLIP would carry along, and that its
    /// particles would move with into other cells. Its energy is booked as damping.
    ///
    /// **A cell needs more particles than its stencil has nodes** for anything to be taken out, unless they lie in a row:
    /// five for linear shape functions in two dimensions and nine in three, ten and twenty-eight for the quadratic spline. With two
    /// particles an axis nothing is. What such cells hide from the nodes they hide together; filters of the whole
    /// grid see that, [`Fmpm`](crate::Fmpm) and [`Blend`](crate::Blend).
    ///
    /// A filtered step takes some microseconds a particle more.
    ///
    /// # Errors
    /// No steps; a transfer whose velocities come from the nodes alone, and hide nothing.
    pub fn set_null_space_filter(&mut self, every: u64) -> Result<(), SceneError> {
        if every == 0 {
            return Err(SceneError::FilterSteps);
        }
        if !self.facts().reads_increment {
            return Err(SceneError::NothingToFilter(self.facts().description.clone()));
        }
        self.check_clients("a null-space filter")?;
        self.between_steps.filter = Some(NullSpaceFilter { every });
        Ok(())
    }
}
