//! Particle domains that are convected with the motion.

use mpm_materials::{Lane, Mat3};

use super::gather::{Wanted, gather};
use crate::dim::Stencil;
use crate::shape::domain::{Corners, MOST_NUMBERS};
use crate::shape::{Basis, Domain, ShapeFunction};
use impactite_simd::Float;

/// Motion of a group of particles in a step.
pub(in crate::step) struct Moved<'a, P> {
    /// Positions before the step, in cells from the bin's centre.
    pub(in crate::step) xi: &'a [P; 3],
    /// Interpolated nodal velocity, m/s.
    pub(in crate::step) nodal: &'a [P; 3],
    /// Velocity gradient with respect to xi, m/s.
    pub(in crate::step) gradient: &'a Mat3<P>,
    /// Displacement in cells per velocity: dt / h, s/m.
    pub(in crate::step) cells: P,
}

impl<P: Lane> Moved<'_, P> {
    /// Update the domains; corners move with the velocity of the `nodes` interpolated to them.
    #[inline(always)]
    pub(in crate::step) fn domain<T, S, const D: usize>(
        &self,
        shape: &S,
        nodes: &<S::Extent as Stencil>::Nodes<[T; 4]>,
        domain: &mut [P; MOST_NUMBERS],
    ) where
        T: Float,
        P: Lane<Real = T>,
        S: ShapeFunction<T, D>,
    {
        let Moved { xi, nodal, gradient, cells } = *self;
        match S::DOMAIN {
            Domain::Fixed => {}
            Domain::Axes => {
                for d in 0..D {
                    domain[d] = shape.stretch(domain[d], gradient.0[d][d] * cells);
                }
            }
            Domain::Edges => {
                for edge in domain.chunks_exact_mut(D).take(D) {
                    let mut new = [P::zero(); 3];
                    for d in 0..D {
                        let mut change = P::zero();
                        for e in 0..D {
                            change = gradient.0[d][e].mul_add(edge[e], change);
                        }
                        new[d] = cells.mul_add(change, edge[d]);
                    }
                    edge.copy_from_slice(&new[..D]);
                }
            }
            Domain::Corners => {
                let corners = Corners::of::<D>(S::DOMAIN, domain);
                // Extrapolate the relative velocity from scaled corners to the true ones.
                let cells = cells / corners.scale;
                for c in 0..1 << D {
                    let hats = corners.linear_weights::<S::Extent, D>(c, xi);
                    let mut basis = [Basis::zero(); 3];
                    for d in 0..D {
                        basis[d].value = hats[d];
                    }
                    for d in 0..D {
                        let wanted = Wanted { slope: false, fit: false };
                        let there = gather::<T, D, P, S>(nodes, &basis, d, wanted).value;
                        domain[c * D + d] = cells.mul_add(there - nodal[d], domain[c * D + d]);
                    }
                }
            }
        }
    }
}
