//! Meshes of rods with ogive noses.

use super::round::{Butterfly, placed, positive};
use super::{Spacing, box_mesh};
use crate::elements::ElementMesh;
use crate::error::{Check, GeometryError};
use crate::primitives::{Cuboid, OgiveRod};
use crate::vector::norm;

/// Welding tolerance over the shortest edge: above the rounding differences between nodes of shank and nose.
const WELD: f64 = 1e-6;

/// Mapping of half a ball to the nose of a rod.
struct Nose {
    radius: f64,
    length: f64,
    /// Radius of the arc of the meridian; `beyond` is the distance of its centre beyond the axis.
    arc: f64,
    beyond: f64,
}

impl Nose {
    fn of<const D: usize>(rod: &OgiveRod<D>) -> Self {
        Self { radius: rod.radius, length: rod.nose, arc: rod.arc, beyond: rod.beyond() }
    }

    /// Map a point of the unit half ball, whose last coordinate is along the axis: spheres become ogives at the surface and ellipsoids
    /// towards the centre, where ellipsoids avoid the pointed tip.
    fn place<const D: usize>(&self, x: [f64; D], start: f64) -> [f64; D] {
        let mut across = x;
        across[D - 1] = 0.0;
        let (r, z, size) = (norm(across), x[D - 1], norm(x));
        if size == 0.0 {
            across[D - 1] = start;
            return across;
        }
        let latitude = z.atan2(r);
        let turn = (self.length / self.arc).min(1.0).asin() * latitude / std::f64::consts::FRAC_PI_2;
        let (sin, cos) = turn.sin_cos();
        let ogive = [self.arc * cos - self.beyond, self.arc * sin];
        let ellipse = [self.radius * latitude.cos(), self.length * latitude.sin()];
        let share = size;
        let [radial, axial] = [0, 1].map(|i| size * ((1.0 - share) * ellipse[i] + share * ogive[i]));
        let mut place = if r > 0.0 { across.map(|c| c / r * radial) } else { across };
        place[D - 1] = start + axial;
        place
    }
}

/// Join shank and nose into one body.
fn weld<const D: usize>(
    shank: ElementMesh<D>,
    nose: &ElementMesh<D>,
) -> Result<ElementMesh<D>, GeometryError> {
    let shortest = shank.edge_lengths()?.min.min(nose.edge_lengths()?.min);
    let mut rod = shank.joined(nose)?.welded(WELD * shortest)?;
    // Merge both blocks into one.
    let nose = rod.blocks.split_off(1);
    rod.blocks[0].nodes.extend(nose.into_iter().flat_map(|b| b.nodes));
    Ok(rod)
}

/// Mesh a rod with an ogive or hemispherical nose by bricks. The shank is an extruded disc with `shank` elements along it (a number, or a
/// graded [`Spacing`]; ignored for a rod without shank), the nose the image of half a ball. All outer nodes are on the surface of
/// the rod, one at its tip. Node sets: `start` (the tail), `side` (of the shank) and `nose`.
///
/// # Errors
/// [`GeometryError::Parameter`] unless counts are positive and that of the core even; [`GeometryError::Memory`] for too many elements.
pub fn ogive_rod_mesh(
    rod: &OgiveRod<3>,
    section: Butterfly,
    shank: impl Into<Spacing>,
) -> Result<ElementMesh<3>, GeometryError> {
    let owner = "ogive rod mesh";
    section.check_even(owner)?;
    let shape = Nose::of(rod);
    let half = positive(&section.ball::<3>(owner)?, 2)?;
    let base = half.nodes_where(|x| x[2] == 0.0);
    let mut nose = half.mapped(|x| shape.place(x, rod.shank))?;
    rename(&mut nose, "side", "nose");
    if rod.shank == 0.0 {
        return placed(nose.with_node_set("start", base)?, &rod.axis);
    }
    let heights = shank.into().check(owner)?.nodes(0.0, rod.shank);
    let disc = section.ball::<2>(owner)?.scaled(rod.radius, [0.0; 2])?;
    let mut body = disc.extruded(&heights)?;
    body.node_sets.remove("end");
    placed(weld(body, &nose)?, &rod.axis)
}

/// Mesh the section r > 0 of a rod with an ogive or hemispherical nose in axisymmetric coordinates (r, z) by quadrilaterals, none of them
/// collapsed: half of the axial section of [`ogive_rod_mesh`], with half the core elements across. Node sets: `axis`,
/// `start` (the tail), `side` (of the shank) and `nose`.
///
/// ```
/// use impactite_geometry::structured::{Butterfly, ogive_rod_section_mesh};
/// use impactite_geometry::{Metric, OgiveRod, Shape};
/// let rod = OgiveRod::new([0.0, 0.1], [0.0, -1.0], 7.11e-3, 88.9e-3, 3.0)?;
/// let mesh = ogive_rod_section_mesh(&rod, Butterfly { core: 8, rings: 3 }, 60)?;
/// let (found, exact) = (mesh.measure(Metric::Axisymmetric)?, rod.revolved_measure().unwrap_or(0.0));
/// assert!((found / exact - 1.0).abs() < 0.003);
/// # Ok::<(), impactite_geometry::GeometryError>(())
/// ```
///
/// # Errors
/// Errors of [`ogive_rod_mesh`], and a rod that is not on the axis r = 0.
pub fn ogive_rod_section_mesh(
    rod: &OgiveRod<2>,
    section: Butterfly,
    shank: impl Into<Spacing>,
) -> Result<ElementMesh<2>, GeometryError> {
    let owner = "section of an ogive rod mesh";
    section.check_even(owner)?;
    let ([r, tail], [across, forward]) = (rod.axis.start, rod.axis.direction);
    Check(owner).that(r == 0.0, "r of the tail", r, "0: on the axis")?;
    Check(owner).that(across == 0.0, "r of the direction", across, "0: along the axis")?;

    let quarter = positive(&positive(&section.ball::<2>(owner)?, 0)?, 1)?;
    let base = quarter.nodes_where(|x| x[1] == 0.0);
    let mut radii: Vec<f64> = base.iter().map(|&n| quarter.nodes[n as usize][0] * rod.radius).collect();
    radii.sort_unstable_by(f64::total_cmp);
    let shape = Nose::of(rod);
    let mut mesh = quarter.mapped(|x| shape.place(x, rod.shank))?;
    rename(&mut mesh, "side", "nose");
    if rod.shank > 0.0 {
        let along = shank.into().check(owner)?;
        let across = radii.len() - 1;
        let size = Cuboid::new([0.0; 2], [across as f64, rod.shank])?;
        let mut body = box_mesh(&size, [Spacing::uniform(across), along])?;
        // Replace uniform radii by those of the base of the nose.
        for x in &mut body.nodes {
            x[0] = radii[x[0].round() as usize];
        }
        body.node_sets.retain(|name, _| name == "x_max" || name == "y_min");
        rename(&mut body, "x_max", "side");
        rename(&mut body, "y_min", "start");
        mesh = weld(body, &mesh)?;
    } else {
        mesh = mesh.with_node_set("start", base)?;
    }
    if forward < 0.0 {
        mesh = mesh.mirrored(1, 0.0)?;
    }
    let axis = mesh.nodes_where(|x| x[0] == 0.0);
    mesh.with_node_set("axis", axis)?.translated([0.0, tail])
}

fn rename<const D: usize>(mesh: &mut ElementMesh<D>, from: &str, to: &str) {
    if let Some(nodes) = mesh.node_sets.remove(from) {
        mesh.node_sets.insert(to.into(), nodes);
    }
}
