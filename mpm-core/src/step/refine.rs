//! Set-up of cells of several sizes.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::criteria::{Adaptive, touches};
use super::mpm::Mpm;
use crate::dim::{BLOCK, centre};
use crate::grid::levels::{FURTHEST_BLOCK, Lattices, MOST_LEVELS, offset_of_levels};
use crate::grid::{Halving, Levels};
use impactite_geometry::{Filling, GeometryError, Lattice, Seeds, Shape, fill};
use impactite_scene::boundary::Boundary;
use impactite_scene::condition::Condition;
use impactite_scene::error::SceneError;
use impactite_simd::Float;

/// Largest number of blocks that a region is compared with.
const MOST_BLOCKS: f64 = 1e7;

/// Region with smaller cells: the cells of all blocks that it touches are halved `halvings` times.
#[derive(Clone)]
pub struct Refinement<const D: usize> {
    /// Region, bounded.
    pub region: Arc<dyn Shape<D>>,
    /// Number of halvings of the cells, from 1 to 7.
    pub halvings: usize,
}

impl<const D: usize> Refinement<D> {
    /// Halve the cells in a region once or several times.
    pub fn new(region: impl Shape<D> + 'static, halvings: usize) -> Self {
        Refinement { region: Arc::new(region), halvings }
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Use smaller cells in regions: blocks of four cells an axis that a region touches, and around regions of several halvings
    /// a block of each size between; at the start, empty blocks around bodies in a region, too, so that their surfaces have nodes of
    /// the small cells. Regions of earlier calls remain. They are at rest. Particles are seeded by [`Mpm::fill`]; a particle that enters
    /// smaller cells is divided in two along every axis, one that leaves them keeps its size.
    ///
    /// Available for B-splines with an affine transfer ([`Apic`](crate::Apic), [`Aflip`](crate::Aflip)), which reproduce a
    /// linear velocity field across the borders (module documentation of the grid's levels). The time step is that of the
    /// smallest cells.
    ///
    /// ```
    /// use mpm_core::geometry::{Cuboid, Filling, Lattice};
    /// use mpm_core::{Apic, BlockGrid, Method, Mpm, PlaneStrain, QuadraticBSpline, Refinement, Usl};
    /// # use mpm_materials::{LinearElastic, Moduli};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    /// let mut mpm = Mpm::new(method, BlockGrid::new(Lattice::new([0.0; 2], 0.1)?));
    /// mpm.refine(&[Refinement::new(Cuboid::new([1.2, 0.0], [1.6, 0.4])?, 1)])?;
    /// let seeds = mpm.fill(&Cuboid::new([0.0; 2], [2.4, 0.8])?, 2, &Filling::new())?;
    /// let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.3)?)?;
    /// mpm.add("bar", law, &seeds, |_| [0.0; 2])?;
    /// // 24 x 8 cells of four particles, some of them divided.
    /// assert!((769..4 * 768).contains(&seeds.len()));
    /// # mpm.run_until(0.1)?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// A scene with bodies; another method; a grid of limited size; periodic planes and conditions with a surface; a region
    /// that is empty, unbounded or too large; a number of halvings outside 1 to 7.
    pub fn refine(&mut self, regions: &[Refinement<D>]) -> Result<(), SceneError> {
        let halving = self.check_refinement()?;
        let facts = self.facts();
        let present = self.grid.fields.levels().map_or(&[][..], |levels| levels.refined());
        let mut refined: Vec<BTreeSet<[i32; D]>> =
            present.iter().map(|blocks| blocks.iter().copied().collect()).collect();
        let lattices = Lattices::several(*self.grid.lattice(), offset_of_levels(halving));
        for Refinement { region, halvings } in regions {
            if !(1..=MOST_LEVELS).contains(halvings) {
                return Err(SceneError::Refinement {
                    field: "halvings",
                    value: *halvings as f64,
                    allowed: "from 1 to 7",
                });
            }
            let level = halvings - 1;
            refined.resize_with(refined.len().max(*halvings), BTreeSet::new);
            let found = blocks_of(&**region, &lattices, level, centre(facts.nodes))?;
            refined[level].extend(found);
        }
        let refined = refined.into_iter().map(|blocks| blocks.into_iter().collect()).collect();
        let levels = Levels::new(*self.grid.lattice(), (halving, facts.nodes), refined);
        if levels.count() > 1 {
            self.adaptive.get_or_insert_with(Adaptive::default).regions = format!("{:?}", levels.refined());
            self.grid.fields.set_levels(Arc::new(levels));
        }
        Ok(())
    }

    /// Return the refinement relation of the shape function, if the scene can have cells of several sizes.
    pub(super) fn check_refinement(&self) -> Result<Halving, SceneError> {
        let what = "cells of several sizes";
        if !self.scene.bodies.is_empty() {
            return Err(self.not_with(what, "regions are set before bodies are added"));
        }
        let facts = self.facts();
        let Some(halving) = facts.halving.filter(|_| !facts.boundary_modified) else {
            return Err(self.not_with(what, "take `QuadraticBSpline` or `CubicBSpline`"));
        };
        if !facts.affine || facts.least_squares {
            let why = "particles must map an affine velocity field: take `Apic` or `Aflip`; others do not \
                       reproduce a uniform velocity gradient at the border of a region";
            return Err(self.not_with(what, why));
        }
        if self.between_steps.filter.is_some() {
            return Err(self.not_with(what, "leave out the null-space filter (`Mpm::set_null_space_filter`)"));
        }
        if size_of::<T>() < size_of::<f64>() {
            return Err(
                self.not_with(what, "take double precision, which counts the parts of divided particles")
            );
        }
        if facts.total {
            return Err(self.not_with(what, "take the updated Lagrangian frame"));
        }
        if !self.grid.storage.is_unbounded() {
            return Err(self.not_with(what, "take `BlockGrid`"));
        }
        self.check_boundaries_of_levels(&self.scene.conditions.boundaries)?;
        Ok(halving)
    }

    /// Fill a shape with particles, `per_axis` along an edge of a cell, of the cells at their place.
    ///
    /// # Errors
    /// A shape that cannot be filled.
    pub fn fill(
        &self,
        shape: &(impl Shape<D> + ?Sized),
        per_axis: usize,
        filling: &Filling,
    ) -> Result<Seeds<D>, GeometryError> {
        let lattices = self.seed_lattices();
        let all = lattices.iter().map(|lattice| fill(shape, lattice, per_axis, filling));
        Ok(self.seeds_of_levels(&all.collect::<Result<Vec<_>, _>>()?))
    }

    /// Lattices whose cells particles fill, from the largest cells to the smallest: all have the origin of the scene.
    pub fn seed_lattices(&self) -> Vec<Lattice<D>> {
        let base = *self.grid.lattice();
        let of = |spacing| Lattice::new(base.origin(), spacing).unwrap_or(base);
        self.cell_sizes().into_iter().map(of).collect()
    }

    /// Return the particles of a shape from those of every lattice of [`Mpm::seed_lattices`]: each where its cells are.
    /// The volumes add up to that on the largest cells.
    pub fn seeds_of_levels(&self, all: &[Seeds<D>]) -> Seeds<D> {
        match self.grid.fields.levels() {
            Some(levels) => levels.select(all),
            None => all.first().cloned().unwrap_or_else(|| Seeds::placed(Vec::new(), Vec::new(), [0.0; D])),
        }
    }

    /// Sizes of the cells, m, from the largest to the smallest.
    pub fn cell_sizes(&self) -> Vec<f64> {
        self.sizes_of(self.grid.fields.levels().map_or(1, |levels| levels.count()))
    }

    /// Sizes of the cells, m, from the largest to the smallest that criteria may ask for, each with the number of particles there.
    pub fn points_by_cell(&self) -> Vec<(f64, usize)> {
        let sizes = self.all_cell_sizes();
        let mut counts = vec![0; sizes.len()];
        self.scene.bodies.iter().for_each(|body| body.presence().count_by_level(&mut counts));
        sizes.into_iter().zip(counts).collect()
    }

    /// Sizes of the cells, m, those included that criteria may ask for.
    pub(in crate::step) fn all_cell_sizes(&self) -> Vec<f64> {
        let now = self.grid.fields.levels().map_or(1, |levels| levels.count());
        self.sizes_of(now.max(self.most_halvings() + 1))
    }

    fn sizes_of(&self, count: usize) -> Vec<f64> {
        let lattices = self.grid.fields.lattices();
        (0..count).map(|level| lattices.of(level).spacing()).collect()
    }

    /// Size of the smallest cells, m.
    pub(in crate::step) fn smallest_cell(&self) -> f64 {
        let count = self.grid.fields.levels().map_or(1, |levels| levels.count());
        self.grid.fields.lattices().of(count - 1).spacing()
    }

    /// Refuse a feature that is not available with cells of several sizes.
    pub(in crate::step) fn check_levels(&self, what: &str) -> Result<(), SceneError> {
        if self.grid.fields.levels().is_none() {
            return Ok(());
        }
        Err(self.not_with(what, "the scene has cells of several sizes: remove the refined regions"))
    }

    /// Refuse a rigid body whose surface and inertia would be those of particles of one size, with regions of smaller ones.
    pub(in crate::step) fn check_rigid_levels(&self, prescribed: bool) -> Result<(), SceneError> {
        if prescribed || self.grid.fields.levels().is_none_or(|levels| levels.count() == 1) {
            return Ok(());
        }
        let why = "its surface is that of particles of one size: prescribe its motion, or halve cells by criteria \
                   (`Mpm::refine_where`) instead of regions";
        Err(self.not_with("a free rigid body beside refined regions", why))
    }

    /// Refuse conditions that are not available with cells of several sizes.
    pub(in crate::step) fn check_boundaries_of_levels<'a>(
        &self,
        boundaries: impl IntoIterator<Item = &'a Boundary<D>>,
    ) -> Result<(), SceneError> {
        for boundary in boundaries {
            let what = match boundary {
                Boundary::Periodic { .. } => "a periodic condition beside cells of several sizes",
                other if Condition::surface(other).is_some() => {
                    "a condition on a surface (absorbing planes) beside cells of several sizes"
                }
                _ => continue,
            };
            return Err(self.not_with(what, "remove the condition, or the refined regions"));
        }
        Ok(())
    }

    fn not_with(&self, what: &str, why: &'static str) -> SceneError {
        SceneError::NotWith { what: what.into(), method: self.facts().description.clone(), why }
    }
}

/// Return the blocks of bins of a level that a region touches.
fn blocks_of<const D: usize>(
    region: &dyn Shape<D>,
    lattices: &Lattices<D>,
    level: usize,
    centre: f64,
) -> Result<Vec<[i32; D]>, SceneError> {
    let lattice = lattices.of(level);
    let (h, origin, bounds) = (lattice.spacing(), lattice.origin(), region.bounds());
    let size = BLOCK as f64 * h;
    // Lower corner of block zero: bins are cells around their centres.
    let corner = origin.map(|x| x + (centre - 0.5) * h);
    let (mut first, mut count, mut all) = ([0i32; D], [0usize; D], 1.0);
    for d in 0..D {
        let ends = [bounds.min[d], bounds.max[d]].map(|x| ((x - corner[d]) / size).floor());
        if !ends.iter().all(|x| x.abs() < f64::from(FURTHEST_BLOCK)) {
            return Err(SceneError::Refinement {
                field: "region",
                value: bounds.max[d],
                allowed: "bounded, within 2^24 blocks of the origin: intersect it with a cuboid",
            });
        }
        first[d] = ends[0] as i32;
        count[d] = (ends[1] - ends[0]).max(0.0) as usize + 1;
        all *= count[d] as f64;
    }
    if all > MOST_BLOCKS {
        let allowed = "of at most 1e7 blocks of four cells an axis: take larger cells or a smaller region";
        return Err(SceneError::Refinement { field: "region", value: all, allowed });
    }
    let touches = |block: &[i32; D]| {
        let low: [f64; D] = std::array::from_fn(|d| corner[d] + size * f64::from(block[d]));
        touches(region, &low, &low.map(|x| x + size))
    };
    let blocks = (0..count.iter().product()).map(|n: usize| {
        let mut rest = n;
        std::array::from_fn(|d| {
            let at = first[d] + (rest % count[d]) as i32;
            rest /= count[d];
            at
        })
    });
    let blocks: Vec<[i32; D]> = blocks.filter(touches).collect();
    if blocks.is_empty() {
        let allowed = "at least as large as a ninth of four cells of the size that it halves";
        return Err(SceneError::Refinement {
            field: "region",
            value: bounds.max[0] - bounds.min[0],
            allowed,
        });
    }
    Ok(blocks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Apic, BlockGrid, CubicBSpline, FullSpace, IntoKernels, Method, PlaneStrain, QuadraticBSpline, Usl,
    };
    use impactite_geometry::Cuboid;
    use impactite_scene::TimeControl;
    use mpm_materials::{LinearElastic, Moduli};

    /// Largest deviation of particle velocities from a linear field, after three short steps with refined regions.
    fn deviation<const D: usize>(method: impl IntoKernels<f64, D>, halvings: usize) -> f64
    where
        f64: crate::Scalar<D>,
    {
        let mut mpm = Mpm::new(method, BlockGrid::new(Lattice::new([0.03; D], 0.1).unwrap()));
        let region = Cuboid::new([0.9; D], [1.3; D]).unwrap();
        mpm.refine(&[Refinement::new(region, halvings)]).unwrap();
        let all = Cuboid::new([0.0; D], [2.0; D]).unwrap();
        let seeds = mpm.fill(&all, 2, &Filling::new().jittered(7, 0.9)).unwrap();
        let law = LinearElastic::new(1.0, Moduli::young_poisson(1e-9, 0.3).unwrap()).unwrap();
        let gradient = [[0.3, -0.2, 0.1], [0.5, -0.1, 0.25], [-0.3, 0.15, 0.2]];
        let field = move |x: [f64; D]| {
            std::array::from_fn(|c| 0.7 + (0..D).map(|d| gradient[c][d] * x[d]).sum::<f64>())
        };
        mpm.add("block", law, &seeds, field).unwrap();
        mpm.stepper.refits = 120;
        mpm.set_time_control(TimeControl::Fixed(1e-12)).unwrap();
        let before = mpm.bodies()[0].totals();
        (0..3).for_each(|_| {
            mpm.step().unwrap();
        });
        let after = mpm.bodies()[0].totals();
        assert!((after.mass / before.mass - 1.0).abs() < 1e-14);
        for d in 0..D {
            assert!((after.momentum[d] - before.momentum[d]).abs() < 1e-13 * before.momentum_scale);
            let turned = (after.angular_momentum[d] - before.angular_momentum[d]).abs();
            assert!(turned < 1e-12 * before.momentum_scale, "{turned:e}");
        }
        let mut worst = 0.0f64;
        mpm.bodies()[0].for_each(&mut |p| {
            let due = field(std::array::from_fn(|d| p.position[d]));
            (0..D).for_each(|c| worst = worst.max((p.velocity[c] - due[c]).abs()));
        });
        worst
    }

    /// A linear velocity field of randomly placed particles is exact across borders and corners of regions.
    #[test]
    fn linear_fields_are_exact_across_borders() {
        for halvings in [1, 2] {
            let quadratic = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain).compiled();
            let cubic = Method::new(CubicBSpline, Apic, Usl, PlaneStrain).compiled();
            for found in [deviation(quadratic, halvings), deviation(cubic, halvings)] {
                assert!(found < 1e-11, "{halvings}: {found:e}");
            }
        }
        let space = Method::new(QuadraticBSpline, Apic, Usl, FullSpace).compiled();
        let found = deviation(space, 1);
        assert!(found < 1e-11, "in space: {found:e}");
    }

    /// Functions of a coarse node are the sums of those of the finer nodes that depend on it.
    #[test]
    fn coefficients_are_those_of_the_functions() {
        for (halving, nodes) in [(Halving::Quadratic, 3), (Halving::Cubic, 4)] {
            let base = Lattice::new([0.0; 2], 1.0).unwrap();
            let levels = Levels::new(base, (halving, nodes), vec![vec![[0, 0]]]);
            let mut sums = std::collections::BTreeMap::new();
            for n in 0..400 {
                let node = [n % 20 - 10, n / 20 - 10];
                let (mut sum, mut x) = (0.0, [0.0; 2]);
                levels.parents(&node, &mut |parent| {
                    sum += parent.weight;
                    (0..2).for_each(|d| x[d] += parent.weight * parent.offset[d]);
                    *sums.entry(parent.node).or_insert(0.0) += parent.weight;
                    let [fine, coarse] = [(1, node), (0, parent.node)]
                        .map(|(level, node)| levels.lattices().of(level).node(node.map(i64::from)));
                    for d in 0..2 {
                        assert!((coarse[d] - fine[d] - 0.5 * parent.offset[d]).abs() < 1e-12);
                    }
                });
                assert!((sum - 1.0).abs() < 1e-15 && x == [0.0; 2], "{node:?}: {sum} {x:?}");
            }
            // Away from the ends of the list each function is the sum of its parts.
            assert!((sums[&[0, 0]] - 4.0).abs() < 1e-15);
        }
    }
}
