//! Domains that particles carry, and weights that are no products along the axes.

use mpm_materials::{Lane, Real};

use super::{ShapeFunction, node_offset};
use crate::dim::{Array, Stencil};

/// What of its own domain a particle carries. Numbers are in units of h.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// Nothing: all particles of a body keep the box they start with.
    Fixed,
    /// Half sizes of a box, which follow the strain along each axis ([`ShapeFunction::stretch`]).
    Axes,
    /// Half edges r_k of a parallelogram (parallelepiped), which follow the deformation: r += dt grad v . r.
    Edges,
    /// Corners of a quadrilateral (hexahedron), from the particle's position: each moves with the nodes' velocity there.
    Corners,
}

/// Most numbers of a domain: eight corners in space.
pub const MOST_NUMBERS: usize = 24;
/// Most corners.
const MOST_CORNERS: usize = 8;
/// How far a corner is taken from the particle along an axis, in cells: as far as the stencil of four nodes reaches from
/// anywhere in its bin. Larger domains are scaled down for the weights \[Homel2016\].
const FARTHEST: f64 = 1.0;

impl Domain {
    /// Numbers a particle carries in `d` dimensions.
    pub const fn numbers(self, d: usize) -> usize {
        match self {
            Domain::Fixed => 0,
            Domain::Axes => d,
            Domain::Edges => d * d,
            Domain::Corners => d << d,
        }
    }
    /// Has a particle any?
    pub const fn carried(self) -> bool {
        !matches!(self, Domain::Fixed)
    }
    /// Does it turn and shear with the material? Then weights are those of linear shape functions at its corners.
    pub const fn convects(self) -> bool {
        matches!(self, Domain::Edges | Domain::Corners)
    }

    /// The numbers of a box of these half sizes.
    pub fn of_box<L: Lane, const D: usize>(self, half: [L; 3]) -> [L; MOST_NUMBERS] {
        let mut edges = [[L::zero(); 3]; 3];
        for d in 0..D {
            edges[d][d] = half[d];
        }
        self.of_edges::<L, D>(&edges)
    }

    /// The numbers of a parallelogram (parallelepiped) of these half edges; of the box with as much of them along each axis, if that
    /// is all that is carried.
    pub fn of_edges<L: Lane, const D: usize>(self, edges: &[[L; 3]; 3]) -> [L; MOST_NUMBERS] {
        let mut numbers = [L::zero(); MOST_NUMBERS];
        for k in 0..D {
            match self {
                // Exact for a cube in any turn, and for one that is stretched along the axes.
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

    /// How far the domain reaches from the particle along a unit vector: of the ellipse (ellipsoid) that touches its
    /// faces, so that corners do not count.
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

    /// Half edges; of a quadrilateral (hexahedron) those through its middle.
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

/// On which side corner `c` lies along axis `d` of the undeformed domain: -1 or 1.
#[inline(always)]
const fn side(c: usize, d: usize) -> f64 {
    if c >> d & 1 == 0 { -1.0 } else { 1.0 }
}

/// The corners of a domain. A field that is interpolated between them has the mean sum_c value_c f_c over the domain, and
/// the mean gradient sum_c slope_c f_c.
#[derive(Clone, Copy)]
pub struct Corners<L> {
    /// From the particle's position, in cells, scaled down where they would be out of reach.
    pub offset: [[L; 3]; MOST_CORNERS],
    /// What offsets were multiplied with.
    pub scale: L,
    value: [L; MOST_CORNERS],
    /// Per cell.
    slope: [[L; 3]; MOST_CORNERS],
    /// By its sign: positive unless more of the domain is inside out than not.
    pub volume: L,
}

impl<L: Lane> Corners<L> {
    /// Of a domain that convects.
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

    /// Means over a quadrilateral (hexahedron) of what is linear along each of its edges, with two Gauss points along each:
    /// exact, for Jacobian and cofactors are of second order at most along an edge.
    #[inline(always)]
    fn integrate<const D: usize>(&mut self) {
        let mut volume = L::zero();
        for point in 0..1 << D {
            let along = |d: usize| side(point, d) / 3f64.sqrt();
            // Shape functions of the corners there, and their derivatives.
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
        // Where a domain is folded a corner may weigh less than nothing, and masses of nodes would be negative: then all
        // are drawn to their mean until it weighs nothing.
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

    /// The middle of the domain from the particle's position, in cells, scaled as offsets are: where linear fields are
    /// reproduced.
    pub fn middle<const D: usize>(&self) -> [L; 3] {
        let mut sum = [L::zero(); 3];
        for c in 0..1 << D {
            for d in 0..D {
                sum[d] = self.value[c].mul_add(self.offset[c][d], sum[d]);
            }
        }
        sum
    }

    /// Linear shape functions along the axes at corner `c` of a particle at `xi`.
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

/// Determinant of the D x D matrix of these rows, and its cofactors: rows of the transposed inverse times it.
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

/// Weights on all nodes of a stencil, x fastest, of a particle whose domain convects.
#[derive(Clone, Copy)]
pub struct Table<L: Lane, E: Stencil> {
    /// N: the weight of each node.
    pub value: E::Nodes<L>,
    /// h dN/dx along each axis.
    pub slope: [E::Nodes<L>; 3],
}

impl<L: Lane, E: Stencil> Table<L, E> {
    /// All zero.
    #[inline(always)]
    pub fn zero() -> Self {
        Table { value: Array::filled(L::zero()), slope: [Array::filled(L::zero()); 3] }
    }

    /// Of a particle at `xi` with these corners. The linear shape functions of all corners, with what each of them counts.
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

/// The table of a particle at `xi` with this domain, of a shape function whose domains convect.
#[inline(always)]
pub fn table<T, L, S, const D: usize>(xi: &[L; 3], domain: &[L; MOST_NUMBERS]) -> Table<L, S::Extent>
where
    T: Real,
    L: Lane<Real = T>,
    S: ShapeFunction<T, D>,
{
    Table::of::<D>(&Corners::of::<D>(S::DOMAIN, domain), xi)
}
