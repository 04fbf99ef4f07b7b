//! Convected particle domain interpolation: fields are linear between the corners of a particle's domain, and interpolated
//! from the nodes to the corners with linear shape functions.

use mpm_materials::{Lane, Real};

use super::{Domain, ShapeFunction, Weights, node_offset};
use crate::dim::{Extent, Stencil};

/// CPDI \[Sadeghirad2011\]: the domain is a parallelogram (parallelepiped) that follows the deformation at the particle: it
/// stretches, shears and rotates. Domains overlap or separate if neighbours deform differently. Domains with corners more
/// than a cell away, along an axis, are scaled down for the weights \[Homel2016\].
///
/// Not a tensor product, with four nodes per axis: three times the cost of [`super::CpGimp`] in 2D, ten times in 3D (book,
/// "Convected particle domains").
#[derive(Clone, Copy, Debug, Default)]
pub struct Cpdi;

/// CPDI-2 \[Sadeghirad2013\]: the domain is a quadrilateral (hexahedron) whose corners move with the nodal velocity
/// interpolated to them. Initially shared corners of neighbours stay shared, so that domains tile under any motion. Motion
/// that bends within a domain may cross its straight edges: parts count by the sign of their volume, weights are kept from
/// becoming negative, and the run ends when the total volume vanishes (book, "Convected particle domains").
#[derive(Clone, Copy, Debug, Default)]
pub struct Cpdi2;

/// Compute the axis weights of a box along the axes, whose weights are products: the mean of the linear shape functions at
/// its two ends, and their difference over its length.
#[inline(always)]
fn weights<L: Lane, E: Stencil>(xi: L, half: L) -> Weights<L, E> {
    let mut w: Weights<L, E> = Weights::zero();
    let per_length = half.recip() * L::of(0.5);
    for a in 0..E::NODES {
        let hat = |x: L| (L::one() - (x - L::of(node_offset::<E>(a))).abs()).max(L::zero());
        let (left, right) = (hat(xi - half), hat(xi + half));
        w.value[a] = (left + right) * L::of(0.5);
        w.slope[a] = (right - left) * per_length;
    }
    w
}

macro_rules! convected {
    ($name:ident, $domain:expr, $title:literal) => {
        impl<T: Real, const D: usize> ShapeFunction<T, D> for $name
        where
            Extent<D, 4>: Stencil,
        {
            type Extent = Extent<D, 4>;
            const DOMAIN: Domain = $domain;
            const USL_LIMIT: f64 = 0.5;
            const NAME: &'static str = $title;

            #[inline(always)]
            fn weights<L: Lane<Real = T>>(&self, xi: L, half: L) -> Weights<L, Self::Extent> {
                weights(xi, half)
            }
        }
    };
}
convected!(Cpdi, Domain::Edges, "CPDI");
convected!(Cpdi2, Domain::Corners, "CPDI-2");
