//! Splitting of particles: what is stretched too far is cut in two along its longest direction.
//!
//! A cell that no particle is in any more is empty: the material breaks there, though nothing in its law says so. In
//! jets and debris clouds particles part until that happens. The remedy (Ma et al. 2009, in \[Zhang2017\]): when the
//! accumulated stretch of a particle reaches a limit, two particles half as long take its place.

use mpm_materials::{Check, Material, ParameterError};
use nalgebra::{Matrix3, Vector3};

use super::merging::Merging;
use crate::particles::Columns;
use crate::step::passes::spread::MAX_LANES;
use impactite_simd::Float;

/// When the particles of a body are split: [`Deformable::with_splitting`](crate::step::Deformable::with_splitting). Its law must keep the
/// stretch: [`mpm_materials::Stretching`]. A body without pays nothing for this.
///
/// A particle whose largest stretch lambda has reached a limit is cut at the end of the stage that moves it. Its length
/// along the stretched direction n is then L = 2 l lambda, l its half size at the start. Two children take its place,
/// at x +- (L/4) n, with half of its mass each and its law's state; the stretch they remember along n is half of the
/// parent's. They have its velocity +- (L/4) (n . grad v n) n: part at the rate of the stretch. So, to rounding,
///
/// - mass, momentum and internal energy stay what they were, and angular momentum, too: the velocities differ along
///   the line that joins the children, which makes no moment;
/// - kinetic energy grows by that of the motion within the parent, m/2 (L/4)^2 (n . grad v n)^2, which no sum over
///   particles held before. It is booked ([`SplitBook`]). Children that kept the parent's velocity would leave it as it
///   is, and FLIP would carry their error for good: strips drawn out to ten times their length break then.
/// - what the parent would have mapped to the grid, force and affine velocity (APIC) included, the children map, half
///   each, from their places.
///
/// The first child keeps its parent's number, the second one gets the number plus the number of seeds times two to the
/// power of the cuts before: so every number is unique, the same for any number of threads, and its remainder by the
/// number of seeds is the seed that it comes from.
///
/// In two dimensions directions out of the plane are left alone. About an axis a particle is not cut across it. Children
/// of a particle next to a plane of symmetry that is cut normal to it lie within half of the parent's domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splitting {
    stretch: f64,
    generations: u32,
    merging: Option<Merging>,
}

impl Splitting {
    /// Most generations: numbers stay exact.
    const MOST: u32 = 16;
    /// Most cuts that numbers keep count of, where merging takes some back.
    pub(in crate::step) const DEEPEST: u32 = 40;

    /// Split at this stretch, which is a length over that at the start or after the last cut.
    ///
    /// With two particles an axis and cell one is a cell long at a stretch of 2.
    ///
    /// # Errors
    /// A stretch that is not above 1 or above 4.
    pub fn at(stretch: f64) -> Result<Self, ParameterError> {
        let holds = stretch > 1.0 && stretch <= 4.0;
        Check("splitting").that(holds, "stretch", stretch, "above 1 and at most 4")?;
        Ok(Splitting { stretch, generations: 6, merging: None })
    }

    /// Cut a seed and its descendants at most so many times, 6 unless told: the lightest particle has this many halves
    /// of a seed's mass. What flies apart in all directions is stretched for ever. Where particles merge, halves are counted by
    /// the volume of a particle, not by its cuts.
    ///
    /// # Errors
    /// Zero, or more than 16.
    pub fn at_most(self, generations: u32) -> Result<Self, ParameterError> {
        let holds = (1..=Self::MOST).contains(&generations);
        Check("splitting").that(holds, "generations", f64::from(generations), "from 1 to 16")?;
        Ok(Splitting { generations, ..self })
    }

    /// Merge particles, too, where cells hold more than they need.
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

    /// How particles are merged, if they are.
    pub(in crate::step) fn merging(self) -> Option<Merging> {
        self.merging
    }
    /// The stretch to split at.
    pub(in crate::step) fn stretch(self) -> f64 {
        self.stretch
    }
    /// Most cuts of a seed.
    pub(in crate::step) fn generations(self) -> u32 {
        self.generations
    }
    /// Mass of the lightest particle over that of its seed.
    pub(in crate::step) fn lightest(self) -> f64 {
        0.5f64.powi(self.generations as i32)
    }
}

/// What splitting did to a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SplitBook {
    /// Particles cut in two.
    pub cuts: u64,
    /// Kinetic energy of the motion within them that their children show, J.
    pub kinetic: f64,
}

/// The numbers of a [`Splitting`] that a pass needs; all zero, and never read, without one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Splitter<T> {
    /// Are particles split?
    pub(in crate::step) on: bool,
    /// Place of b = F F^T in the law's state.
    pub place: usize,
    /// The square of the stretch to split at.
    pub square: T,
    /// Most cuts.
    pub(in crate::step) generations: T,
    /// Parts of a seed that are not cut any more, where particles merge: generations say nothing there. Else none.
    pub(in crate::step) finest: Option<f64>,
    /// Number of seeds.
    pub(in crate::step) seeds: T,
    /// Half size of a seed, in units of h.
    pub(in crate::step) half: T,
    /// Node spacing h, m.
    pub(in crate::step) spacing: T,
    /// Rows of the domain: where they begin, and how many they are.
    pub(in crate::step) domain: (usize, usize),
    /// Row of the mass.
    pub(in crate::step) mass: usize,
    /// First and end of the rows of loaded areas.
    pub(in crate::step) areas: [usize; 2],
    /// Is the body one of revolution?
    pub(in crate::step) hoop: bool,
}

/// A symmetric tensor of these components xx, yy, zz, yz, xz, xy.
pub(in crate::step) fn symmetric([xx, yy, zz, yz, xz, xy]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// The largest principal value of b in the coordinates of the scene, and its direction.
pub(in crate::step) fn longest<T: Float, const D: usize>(b: [T; 6]) -> (f64, Vector3<f64>) {
    let [xx, yy, zz, yz, xz, xy] = b.map(|x| x.to_double());
    let b = symmetric(if D == 3 { [xx, yy, zz, yz, xz, xy] } else { [xx, yy, 0.0, 0.0, 0.0, xy] });
    let principal = b.symmetric_eigen();
    let (at, value) = principal.eigenvalues.argmax();
    (value, principal.eigenvectors.column(at).into_owned())
}

impl<T: Float> Splitter<T> {
    /// Are particles split?
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

    /// Is the particle to be cut of which `number` gives the number in a row? `axis` is the radius of the bin's centre in units of h, in
    /// a body of revolution.
    pub(in crate::step) fn is_long<const D: usize>(
        &self,
        number: impl Fn(usize) -> T,
        material: &dyn Material<T>,
        axis: T,
    ) -> bool {
        let state = |row: usize| number(Columns::state(D) + self.place + row);
        // The largest principal value is at most the sum of all.
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
        // A particle of k cuts is of 2^-k of the volume that its seed has at this volume ratio.
        let fine = |finest: f64| {
            let numbers: Vec<T> = (0..material.numbers()).map(|n| number(Columns::state(D) + n)).collect();
            let part = symmetric(b.map(|x| x.to_double())).determinant().sqrt();
            let ratio = material.describe_point(&numbers).map_or(0.0, |p| p.volume_ratio.to_double());
            ratio >= finest * part
        };
        !self.finest.is_some_and(fine)
    }

    /// Make two of the particle whose numbers begin at `first` and end the list: the second one follows it. Lane
    /// `lane` of `gradient` holds its velocity gradient, 1/s. Returns the kinetic energy gained, J.
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
        // b loses three quarters of its largest principal value: half of the stretch is left.
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
            // Edges or corners of a domain that convects: half as far along the direction.
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
        // Each half of the parent moves as its middle does.
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
