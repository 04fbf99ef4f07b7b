//! Splitting of particles: a particle that is stretched too far is cut in two along its longest direction.
//!
//! A cell that the last particle leaves is empty: the material breaks there (numerical fracture), without a cause in
//! its law. In jets and debris clouds particles separate until that happens. The remedy (Ma et al. 2009, in
//! \[Zhang2017\]): when the accumulated stretch of a particle reaches a limit, two particles half as long replace it.

use mpm_materials::{Check, Material, ParameterError};
use nalgebra::{Matrix3, Vector3};

use super::merging::Merging;
use crate::particles::Columns;
use crate::step::passes::spread::MAX_LANES;
use impactite_simd::Float;

/// Criterion of particle splitting in a body:
/// [`Deformable::with_splitting`](crate::step::Deformable::with_splitting). Its law must store the stretch:
/// [`mpm_materials::Stretching`]. A body without splitting has no cost of it.
///
/// A particle whose largest stretch lambda has reached a limit is cut at the end of the stage that moves it. Its
/// length along the stretched direction n is then L = 2 l lambda, l its half size at the start. Two children replace
/// it, at x +- (L/4) n, each with half of its mass and with its law's state; their stored stretch along n is half of
/// the parent's. Their velocities are that of the parent +- (L/4) (n . grad v n) n: they separate at the rate of the
/// stretch. To rounding,
///
/// - mass, momentum, internal energy and angular momentum are conserved: the velocities differ along the line that
///   joins the children, which makes no moment;
/// - kinetic energy grows by that of the motion within the parent, m/2 (L/4)^2 (n . grad v n)^2, which no sum over
///   particles contained before. It is booked ([`SplitBook`]). Children with the velocity of the parent would
///   conserve it, and FLIP would keep their error permanently: strips drawn out to ten times their length break then;
/// - the children map what the parent would have mapped to the grid, force and affine velocity (APIC) included, half
///   each, from their positions.
///
/// The first child keeps the number of its parent; the second one gets this number plus the number of seeds times two
/// to the power of the earlier cuts. Every number is thus unique, the same for any number of threads, and its
/// remainder by the number of seeds is the seed of origin.
///
/// In two dimensions stretch out of the plane is ignored. About an axis a particle is not cut across it. Children of
/// a particle next to a plane of symmetry that is cut normal to it are within half of the parent's domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splitting {
    stretch: f64,
    generations: u32,
    merging: Option<Merging>,
}

impl Splitting {
    /// Maximum number of generations, for which numbers stay exact.
    const MOST: u32 = 16;
    /// Maximum number of cuts that numbers can count, where merging reverses some.
    pub(in crate::step) const DEEPEST: u32 = 40;

    /// Split at this stretch: a length over that at the start or after the last cut.
    ///
    /// With two particles an axis and cell, a particle is a cell long at a stretch of 2.
    ///
    /// # Errors
    /// A stretch of 1 or less, or above 4.
    pub fn at(stretch: f64) -> Result<Self, ParameterError> {
        let holds = stretch > 1.0 && stretch <= 4.0;
        Check("splitting").that(holds, "stretch", stretch, "above 1 and at most 4")?;
        Ok(Splitting { stretch, generations: 6, merging: None })
    }

    /// Limit the cuts of a seed and its descendants, 6 by default: the mass of the lightest particle is that of a
    /// seed halved as often. Material that expands in all directions is stretched without end. Where particles merge,
    /// halves are counted by the volume of a particle, not by its cuts.
    ///
    /// # Errors
    /// Zero, or more than 16.
    pub fn at_most(self, generations: u32) -> Result<Self, ParameterError> {
        let holds = (1..=Self::MOST).contains(&generations);
        Check("splitting").that(holds, "generations", f64::from(generations), "from 1 to 16")?;
        Ok(Splitting { generations, ..self })
    }

    /// Also merge particles, where cells contain more than they need.
    ///
    /// ```
    /// # use mpm_core::{BlockGrid, Deformable, Flip, Linear, Merging, Method, Mpm, Musl, PlaneStrain, Splitting};
    /// # use mpm_core::geometry::*;
    /// # use mpm_materials::{Constitutive, Stretching, library};
    /// # let lattice = Lattice::new([0.0; 2], 1e-3).unwrap();
    /// # let seeds = fill(&Ball::new([0.0; 2], 5e-3).unwrap(), &lattice, 2, &Filling::new()).unwrap();
    /// # let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    /// let splitting = Splitting::at(2.0).unwrap().with_merging(Merging::above(8).unwrap());
    /// let lead = Stretching::new(library::lead::<f64>()).compiled();
    /// mpm.add_body(Deformable::new("ball", lead, &seeds).with_splitting(splitting)).unwrap();
    /// ```
    #[must_use]
    pub fn with_merging(self, merging: Merging) -> Self {
        Splitting { merging: Some(merging), ..self }
    }

    /// Merging of particles, if enabled.
    pub(in crate::step) fn merging(self) -> Option<Merging> {
        self.merging
    }
    /// Stretch at which to split.
    pub(in crate::step) fn stretch(self) -> f64 {
        self.stretch
    }
    /// Maximum number of cuts of a seed.
    pub(in crate::step) fn generations(self) -> u32 {
        self.generations
    }
    /// Mass of the lightest particle over that of its seed.
    pub(in crate::step) fn lightest(self) -> f64 {
        0.5f64.powi(self.generations as i32)
    }
}

/// Book of the splitting in a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SplitBook {
    /// Number of particles cut in two.
    pub cuts: u64,
    /// Kinetic energy of the motion within parents that their children resolve, J.
    pub kinetic: f64,
}

/// Parameters of a [`Splitting`] in a pass; all zero, and never read, without one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Splitter<T> {
    /// True if particles are split.
    pub(in crate::step) on: bool,
    /// Index of b = F F^T in the law's state.
    pub place: usize,
    /// Square of the stretch at which to split.
    pub square: T,
    /// Maximum number of cuts.
    pub(in crate::step) generations: T,
    /// Parts of a seed beyond which particles are not cut, where particles merge and generations do not count. Else none.
    pub(in crate::step) finest: Option<f64>,
    /// Number of seeds.
    pub(in crate::step) seeds: T,
    /// Half size of a seed, in units of h.
    pub(in crate::step) half: T,
    /// Node spacing h, m.
    pub(in crate::step) spacing: T,
    /// First row of the domain, and number of its rows.
    pub(in crate::step) domain: (usize, usize),
    /// Row of the mass.
    pub(in crate::step) mass: usize,
    /// First and end row of the loaded areas.
    pub(in crate::step) areas: [usize; 2],
    /// True if the body is axisymmetric.
    pub(in crate::step) hoop: bool,
}

/// Create a symmetric tensor from its components xx, yy, zz, yz, xz, xy.
pub(in crate::step) fn symmetric([xx, yy, zz, yz, xz, xy]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// Return the largest principal value of b in the coordinates of the scene, and its direction.
pub(in crate::step) fn longest<T: Float, const D: usize>(b: [T; 6]) -> (f64, Vector3<f64>) {
    let [xx, yy, zz, yz, xz, xy] = b.map(|x| x.to_double());
    let b = symmetric(if D == 3 { [xx, yy, zz, yz, xz, xy] } else { [xx, yy, 0.0, 0.0, 0.0, xy] });
    let principal = b.symmetric_eigen();
    let (at, value) = principal.eigenvalues.argmax();
    (value, principal.eigenvectors.column(at).into_owned())
}

impl<T: Float> Splitter<T> {
    /// True if particles are split.
    #[inline(always)]
    pub(in crate::step) fn is_on(&self) -> bool {
        self.on
    }
    /// Number of seeds.
    pub(in crate::step) fn seeds(&self) -> u64 {
        self.seeds.to_double() as u64
    }

    /// Offset of the children, L/4 n in units of h; half a cell at most.
    fn offset(&self, square: f64, direction: &Vector3<f64>) -> Vector3<f64> {
        let quarter = 0.5 * self.half.to_double() * square.sqrt();
        direction * quarter.min(0.5)
    }

    /// True if a particle must be cut; `number` returns its value in a row. `axis` is the radius of the bin centre in
    /// units of h, in an axisymmetric body.
    pub(in crate::step) fn is_long<const D: usize>(
        &self,
        number: impl Fn(usize) -> T,
        material: &dyn Material<T>,
        axis: T,
    ) -> bool {
        let state = |row: usize| number(Columns::state(D) + self.place + row);
        // The largest principal value is at most the trace.
        let mut trace = state(0);
        for d in 1..D {
            trace += state(d);
        }
        // False for a value that is not a number.
        let may = self.square <= trace;
        if !may || state(6) >= self.generations {
            return false;
        }
        let b = [0, 1, 2, 3, 4, 5].map(state);
        let (square, direction) = longest::<T, D>(b);
        let across = self.hoop && {
            let radius = (axis + number(Columns::position())).to_double();
            self.offset(square, &direction)[0].abs() >= radius
        };
        if square < self.square.to_double() || across {
            return false;
        }
        // A particle of k cuts has 2^-k of the volume of its seed at this volume ratio.
        let fine = |finest: f64| {
            let numbers: Vec<T> = (0..material.numbers()).map(|n| number(Columns::state(D) + n)).collect();
            let part = symmetric(b.map(|x| x.to_double())).determinant().sqrt();
            let ratio = material.describe_point(&numbers).map_or(0.0, |p| p.volume_ratio.to_double());
            ratio >= finest * part
        };
        !self.finest.is_some_and(fine)
    }

    /// Cut the particle whose values begin at `first` and end the list in two: the second one is appended. Lane
    /// `lane` of `gradient` contains its velocity gradient, 1/s. Return the kinetic energy gained, J.
    pub(in crate::step) fn cut<const D: usize>(
        &self,
        list: &mut Vec<T>,
        first: usize,
        gradient: &[[T; MAX_LANES]; 9],
        lane: usize,
    ) -> T {
        let parent = &mut list[first..];
        let state = Columns::state(D) + self.place;
        let b = [0, 1, 2, 3, 4, 5].map(|i| parent[state + i]);
        let (square, direction) = longest::<T, D>(b);
        let offset = self.offset(square, &direction);

        parent[self.mass] *= T::of(0.5);
        for area in &mut parent[self.areas[0]..self.areas[1]] {
            *area *= T::of(0.5);
        }
        // b loses three quarters of its largest principal value: half of the stretch remains.
        let n = direction;
        let outer = [n[0] * n[0], n[1] * n[1], n[2] * n[2], n[1] * n[2], n[0] * n[2], n[0] * n[1]];
        for i in 0..6 {
            parent[state + i] = b[i] - T::of(0.75 * square * outer[i]);
        }
        let (from, numbers) = self.domain;
        if numbers == D {
            for d in 0..D {
                let left = (parent[state + d] / b[d]).max(T::default()).sqrt();
                parent[from + d] *= left;
            }
        } else {
            // Edges or corners of a domain that convects: half as long along the direction.
            for vector in parent[from..from + numbers].chunks_exact_mut(D) {
                let mut along = 0.0;
                for d in 0..D {
                    along += vector[d].to_double() * n[d];
                }
                for d in 0..D {
                    vector[d] -= T::of(0.5 * along * n[d]);
                }
            }
        }
        let cuts = parent[state + 6].to_double();
        parent[state + 6] = T::of(cuts + 1.0);
        let columns = parent.len();
        list.extend_from_within(first..);
        for d in 0..D {
            list[first + Columns::position() + d] -= T::of(offset[d]);
            list[first + columns + Columns::position() + d] += T::of(offset[d]);
        }
        let number = first + 2 * columns - 1;
        list[number] += self.seeds * T::of(2.0f64.powf(cuts));
        // Each half of the parent has the velocity of its middle.
        let mut rate = 0.0;
        for i in 0..D * D {
            rate += direction[i / D] * gradient[i][lane].to_double() * direction[i % D];
        }
        let mut square = T::default();
        for d in 0..D {
            let w = T::of(rate * self.spacing.to_double() * offset[d]);
            list[first + Columns::velocity(D) + d] -= w;
            list[first + columns + Columns::velocity(D) + d] += w;
            square += w * w;
        }
        list[first + self.mass] * square
    }
}
