//! Particle domains, and weights that are not tensor products.

use mpm_materials::{Lane, Real};

use super::{ShapeFunction, node_offset};
use crate::dim::{Array, Stencil};

/// Particle domain: data that each particle stores, in units of h.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// No data: all particles of a body keep their initial box.
    Fixed,
    /// Half sizes of a box, which follow the strain along each axis ([`ShapeFunction::stretch`]).
    Axes,
    /// Half edges r_k of a parallelogram (parallelepiped), which follow the deformation: r += dt grad v . r.
    Edges,
    /// Corners of a quadrilateral (hexahedron), relative to the particle; each moves with the nodal velocity interpolated
    /// to it.
    Corners,
}

/// Maximum number of values of a domain: eight corners in 3D.
pub const MOST_NUMBERS: usize = 24;
/// Maximum number of corners.
const MOST_CORNERS: usize = 8;
/// Largest distance of a corner from the particle along an axis, in cells: the reach of the stencil of four nodes from
/// anywhere in its bin. Larger domains are scaled down for the weights \[Homel2016\].
const FARTHEST: f64 = 1.0;

impl Domain {
    /// Number of values that a particle stores in `d` dimensions.
    pub const fn numbers(self, d: usize) -> usize {
        match self {
            Domain::Fixed => 0,
            Domain::Axes => d,
            Domain::Edges => d * d,
            Domain::Corners => d << d,
        }
    }
    /// Return true if particles store their domain.
    pub const fn carried(self) -> bool {
        !matches!(self, Domain::Fixed)
    }
    /// Return true if the domain rotates and shears with the material; weights are then those of linear shape functions at
    /// its corners.
    pub const fn convects(self) -> bool {
        matches!(self, Domain::Edges | Domain::Corners)
    }

    /// Return the values of a box with these half sizes.
    pub fn of_box<L: Lane, const D: usize>(self, half: [L; 3]) -> [L; MOST_NUMBERS] {
        let mut edges = [[L::zero(); 3]; 3];
        for d in 0..D {
            edges[d][d] = half[d];
        }
        self.of_edges::<L, D>(&edges)
    }

    /// Return the values of a parallelogram (parallelepiped) with these half edges; box domains get the root of the sum of
    /// squares along each axis as half size.
    pub fn of_edges<L: Lane, const D: usize>(self, edges: &[[L; 3]; 3]) -> [L; MOST_NUMBERS] {
        let mut numbers = [L::zero(); MOST_NUMBERS];
        for k in 0..D {
            match self {
                // Exact for a cube in any orientation, and for one that is stretched along the axes.
                Domain::Fixed | Domain::Axes => {
                    let mut square = L::zero();
                    for edge in &edges[..D] {
                        square = edge[k].mul_add(edge[k], square);
                    }
                    numbers[k] = square.sqrt();
                }
                Domain::Edges => numbers[k * D..][..D].copy_from_slice(&edges[k][..D]),
                Domain::Corners => {
                    for c in 0..1 << D {
                        for d in 0..D {
                            numbers[c * D + d] = edges[k][d].mul_add(L::of(side(c, k)), numbers[c * D + d]);
                        }
                    }
                }
            }
        }
        numbers
    }

    /// Return the extent of the domain from the particle along a unit vector: that of the ellipse (ellipsoid) that touches
    /// its faces, without corners.
    #[inline(always)]
    pub fn half_along<L: Lane, const D: usize>(self, numbers: &[L; MOST_NUMBERS], n: &[L; 3]) -> L {
        let mut square = L::zero();
        let edges = if self.convects() { self.half_edges::<L, D>(numbers) } else { [[L::zero(); 3]; 3] };
        for k in 0..D {
            let mut l = numbers[k] * n[k];
            if self.convects() {
                l = L::zero();
                for d in 0..D {
                    l = edges[k][d].mul_add(n[d], l);
                }
            }
            square = l.mul_add(l, square);
        }
        square.sqrt()
    }

    /// Return the half edges; for a quadrilateral (hexahedron) those through its centre.
    #[inline(always)]
    pub fn half_edges<L: Lane, const D: usize>(self, numbers: &[L; MOST_NUMBERS]) -> [[L; 3]; 3] {
        let mut edges = [[L::zero(); 3]; 3];
        for k in 0..D {
            if !self.convects() {
                edges[k][k] = numbers[k];
                continue;
            }
            for d in 0..D {
                if self == Domain::Edges {
                    edges[k][d] = numbers[k * D + d];
                    continue;
                }
                for c in 0..1 << D {
                    edges[k][d] =
                        numbers[c * D + d].mul_add(L::of(side(c, k) / (1 << D) as f64), edges[k][d]);
                }
            }
        }
        edges
    }
}

/// Return the side of corner `c` along axis `d` of the undeformed domain: -1 or 1.
#[inline(always)]
const fn side(c: usize, d: usize) -> f64 {
    if c >> d & 1 == 0 { -1.0 } else { 1.0 }
}

/// Corners of a domain. A field interpolated between them has the mean sum_c value_c f_c over the domain, and the mean
/// gradient sum_c slope_c f_c.
#[derive(Clone, Copy)]
pub struct Corners<L> {
    /// Offsets from the particle, in cells, scaled down if out of reach of the stencil.
    pub offset: [[L; 3]; MOST_CORNERS],
    /// Scale factor of the offsets.
    pub scale: L,
    value: [L; MOST_CORNERS],
    /// Gradient weights, per cell.
    slope: [[L; 3]; MOST_CORNERS],
    /// Signed volume: positive unless most of the domain is inverted.
    pub volume: L,
}

impl<L: Lane> Corners<L> {
    /// Compute the corners of a convected domain.
    #[inline(always)]
    pub fn of<const D: usize>(kind: Domain, numbers: &[L; MOST_NUMBERS]) -> Self {
        let zero = L::zero();
        let mut corners = Corners {
            offset: [[zero; 3]; MOST_CORNERS],
            scale: zero,
            value: [zero; MOST_CORNERS],
            slope: [[zero; 3]; MOST_CORNERS],
            volume: zero,
        };
        for c in 0..1 << D {
            for d in 0..D {
                if kind == Domain::Corners {
                    corners.offset[c][d] = numbers[c * D + d];
                    continue;
                }
                for k in 0..D {
                    let edge = numbers[k * D + d];
                    let to = &mut corners.offset[c][d];
                    *to = if side(c, k) < 0.0 { *to - edge } else { *to + edge };
                }
            }
        }
        let mut far = L::of(FARTHEST);
        for c in 0..1 << D {
            for d in 0..D {
                far = far.max(corners.offset[c][d].abs());
            }
        }
        corners.scale = L::of(FARTHEST) / far;
        for c in 0..1 << D {
            for d in 0..D {
                corners.offset[c][d] = corners.offset[c][d] * corners.scale;
            }
        }
        if kind == Domain::Corners {
            corners.integrate::<D>();
        } else {
            let edges = kind.half_edges::<L, D>(numbers);
            let (volume, dual) = cofactors::<L, D>(&edges);
            let (each, per) = (1.0 / (1 << D) as f64, (volume * corners.scale).recip());
            for c in 0..1 << D {
                corners.value[c] = L::of(each);
                for d in 0..D {
                    let mut sum = zero;
                    for k in 0..D {
                        sum = if side(c, k) < 0.0 { sum - dual[k][d] } else { sum + dual[k][d] };
                    }
                    corners.slope[c][d] = sum * per * L::of(each);
                }
            }
            corners.volume = volume;
        }
        corners
    }

    /// Integrate the means of fields that are linear along each edge over a quadrilateral (hexahedron), with two Gauss
    /// points along each edge: exact, since Jacobian and cofactors are of second order at most along an edge.
    #[inline(always)]
    fn integrate<const D: usize>(&mut self) {
        let mut volume = L::zero();
        for point in 0..1 << D {
            let along = |d: usize| side(point, d) / 3f64.sqrt();
            // Shape functions of the corners at the Gauss point, and factors of their derivatives.
            let shape = |c: usize, but: usize| {
                (0..D).filter(|d| *d != but).fold(1.0, |m, d| m * 0.5 * (1.0 + side(c, d) * along(d)))
            };
            let mut jacobian = [[L::zero(); 3]; 3];
            for c in 0..1 << D {
                for k in 0..D {
                    let derivative = L::of(0.5 * side(c, k) * shape(c, k));
                    for d in 0..D {
                        jacobian[k][d] = self.offset[c][d].mul_add(derivative, jacobian[k][d]);
                    }
                }
            }
            let (det, dual) = cofactors::<L, D>(&jacobian);
            for c in 0..1 << D {
                self.value[c] = det.mul_add(L::of(shape(c, D)), self.value[c]);
                for k in 0..D {
                    let derivative = L::of(0.5 * side(c, k) * shape(c, k));
                    for d in 0..D {
                        self.slope[c][d] = dual[k][d].mul_add(derivative, self.slope[c][d]);
                    }
                }
            }
            volume = volume + det;
        }
        self.volume = volume;
        let per = volume.recip();
        // In a folded domain a corner weight, and with it a nodal mass, may be negative: all weights are then moved towards
        // their mean until the lowest is zero.
        let mean = L::of(1.0 / (1 << D) as f64);
        let mut low = L::zero();
        for c in 0..1 << D {
            self.value[c] = self.value[c].mul_add(per, -mean);
            low = low.min(self.value[c]);
        }
        let keep = mean / mean.max(-low);
        for c in 0..1 << D {
            self.value[c] = self.value[c].mul_add(keep, mean);
            for d in 0..D {
                self.slope[c][d] = self.slope[c][d] * per;
            }
        }
    }

    /// Return the centroid of the domain relative to the particle, in cells, scaled as offsets are: linear fields are
    /// reproduced there.
    pub fn middle<const D: usize>(&self) -> [L; 3] {
        let mut sum = [L::zero(); 3];
        for c in 0..1 << D {
            for d in 0..D {
                sum[d] = self.value[c].mul_add(self.offset[c][d], sum[d]);
            }
        }
        sum
    }

    /// Evaluate the linear shape functions along the axes at corner `c` of a particle at `xi`.
    #[inline(always)]
    pub fn linear_weights<E: Stencil, const D: usize>(&self, c: usize, xi: &[L; 3]) -> [E::Axis<L>; 3] {
        let mut hats = [E::Axis::<L>::filled(L::zero()); 3];
        for d in 0..D {
            let x = xi[d] + self.offset[c][d];
            for a in 0..E::NODES {
                hats[d][a] = (L::one() - (x - L::of(node_offset::<E>(a))).abs()).max(L::zero());
            }
        }
        hats
    }
}

/// Return the determinant of the D x D matrix of these rows, and its cofactors: rows of the transposed inverse times it.
#[inline(always)]
fn cofactors<L: Lane, const D: usize>(m: &[[L; 3]; 3]) -> (L, [[L; 3]; 3]) {
    let mut dual = [[L::zero(); 3]; 3];
    if D == 2 {
        dual[0] = [m[1][1], -m[1][0], L::zero()];
        dual[1] = [-m[0][1], m[0][0], L::zero()];
        return (m[0][0] * m[1][1] - m[0][1] * m[1][0], dual);
    }
    for k in 0..3 {
        let (a, b) = (&m[(k + 1) % 3], &m[(k + 2) % 3]);
        for d in 0..3 {
            let (e, f) = ((d + 1) % 3, (d + 2) % 3);
            dual[k][d] = a[e] * b[f] - a[f] * b[e];
        }
    }
    (m[0][0] * dual[0][0] + m[0][1] * dual[0][1] + m[0][2] * dual[0][2], dual)
}

/// Weights of a particle with a convected domain on all nodes of a stencil, x fastest.
#[derive(Clone, Copy)]
pub struct Table<L: Lane, E: Stencil> {
    /// N: the weight of each node.
    pub value: E::Nodes<L>,
    /// h dN/dx along each axis.
    pub slope: [E::Nodes<L>; 3],
}

impl<L: Lane, E: Stencil> Table<L, E> {
    /// Return zero weights.
    #[inline(always)]
    pub fn zero() -> Self {
        Table { value: Array::filled(L::zero()), slope: [Array::filled(L::zero()); 3] }
    }

    /// Sum the linear shape functions of all corners of a particle at `xi`, with the corner weights.
    #[inline(always)]
    pub fn of<const D: usize>(corners: &Corners<L>, xi: &[L; 3]) -> Self {
        let mut table = Self::zero();
        for c in 0..1 << D {
            let hats = corners.linear_weights::<E, D>(c, xi);
            for k in 0..E::LAYERS {
                for j in 0..E::NODES {
                    let jk = if D == 3 { hats[1][j] * hats[2][k] } else { hats[1][j] };
                    for i in 0..E::NODES {
                        let (node, hat) = ((k * E::NODES + j) * E::NODES + i, hats[0][i] * jk);
                        table.value[node] = corners.value[c].mul_add(hat, table.value[node]);
                        for d in 0..D {
                            table.slope[d][node] = corners.slope[c][d].mul_add(hat, table.slope[d][node]);
                        }
                    }
                }
            }
        }
        table
    }
}

/// Compute the weights of a particle at `xi` with this domain, for a shape function with convected domains.
#[inline(always)]
pub fn table<T, L, S, const D: usize>(xi: &[L; 3], domain: &[L; MOST_NUMBERS]) -> Table<L, S::Extent>
where
    T: Real,
    L: Lane<Real = T>,
    S: ShapeFunction<T, D>,
{
    Table::of::<D>(&Corners::of::<D>(S::DOMAIN, domain), xi)
}
