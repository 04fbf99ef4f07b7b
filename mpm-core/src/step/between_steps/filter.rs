//! Null-space filter: cell-by-cell removal of particle velocities that nodes do not resolve.

use nalgebra::{DMatrix, DVector};

use super::operations::NullSpaceFilter;
use crate::dim::block_nodes;
use crate::particles::{Block, Columns, Place};
use crate::step::bodies::particle_body::ParticleBody;
use crate::step::mpm::Mpm;
use crate::step::nodes::footprint::NodeWeight;
use impactite_scene::error::SceneError;
use impactite_simd::{Float, Team};

/// Maximum number of iterations of the singular value decomposition of a cell; more than needed.
const MOST_STEPS: usize = 1000;

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Remove velocity components that the nodes do not resolve from every cell, and return their kinetic energy, J.
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
    /// Every `every` steps remove the particle velocities that the nodes of their cell do not resolve (Gritton and
    /// Berzins 2017). With the weights N of the n particles of a cell and body on its nodes, velocities are
    /// projected, by mass, on the range of N, found by singular values. The momentum of every node is unchanged to
    /// rounding, and so is the next step. The filter removes the noise that FLIP would keep, and with which its
    /// particles would move into other cells. Its energy is booked as damping.
    ///
    /// **The filter needs more particles in a cell than its stencil has nodes** to remove anything, unless they are
    /// in a row: five for linear shape functions in two dimensions and nine in three, ten and twenty-eight for the
    /// quadratic spline. With two particles an axis it removes nothing. Noise that several such cells hide together
    /// is removed by filters of the whole grid, [`Fmpm`](crate::Fmpm) and [`Blend`](crate::Blend).
    ///
    /// A filtered step costs some microseconds a particle more.
    ///
    /// # Errors
    /// Zero steps; a transfer whose velocities are those of the nodes alone, so that there is nothing to filter.
    pub fn set_null_space_filter(&mut self, every: u64) -> Result<(), SceneError> {
        if every == 0 {
            return Err(SceneError::FilterSteps);
        }
        if !self.facts().reads_increment {
            return Err(SceneError::NothingToFilter(self.facts().description.clone()));
        }
        self.check_clients("a null-space filter")?;
        self.check_levels("a null-space filter")?;
        self.between_steps.filter = Some(NullSpaceFilter { every });
        Ok(())
    }
}
