//! Meshes of discs, balls, cylinders, rings and tubes.

use std::f64::consts::{FRAC_PI_4, TAU};

use super::{Spacing, box_mesh, room};
use crate::elements::{ElementBlock, ElementKind, ElementMesh};
use crate::error::{Check, GeometryError};
use crate::primitives::{Axis, Ball, Cuboid, Cylinder, Disc, Ring, Tube};
use crate::vector::{along, cross, dot, norm};

/// Half width of the core over the radius.
const CORE: f64 = 0.6;
/// Bulge of the core: 0 for a square, 1 for a disc, whose corners would be straight angles.
const BULGE: f64 = 0.6;

/// Butterfly mesh (O-grid) of a round section: a core of squares in the middle, and rings of elements between it and the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Butterfly {
    /// Elements along each edge of the core: four times as many around the section.
    pub core: usize,
    /// Elements between core and surface.
    pub rings: usize,
}

impl Butterfly {
    /// Choose the numbers of elements for an element `edge` (m) and a section `radius` (m); the core has an even number of elements per
    /// edge, so that there are nodes on the axis.
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless both are positive and the radius is at most 1e6 edges.
    pub fn of_edge(radius: f64, edge: f64) -> Result<Self, GeometryError> {
        let check = Check("Butterfly");
        check.positive("radius", radius)?;
        check.positive("edge", edge)?;
        check.that(radius / edge <= 1e6, "radius over edge", radius / edge, "at most 1e6")?;
        let count = |length: f64| (length * radius / edge).round().max(1.0) as usize;
        // An edge of the core is 2 * 0.6 radii long, a quarter of the circle 1.57.
        Ok(Self { core: 2 * count(0.5 * (CORE + FRAC_PI_4)), rings: count(1.0 - CORE) })
    }

    fn check(self, owner: &'static str) -> Result<(), GeometryError> {
        let check = Check(owner);
        check.that(self.core > 0, "core", self.core as f64, "at least 1")?;
        check.that(self.rings > 0, "rings", self.rings as f64, "at least 1")?;
        Ok(())
    }

    /// Check for an even core, which places nodes on the axis for bodies that end there.
    pub(super) fn check_even(self, owner: &'static str) -> Result<(), GeometryError> {
        let even = self.core > 0 && self.core.is_multiple_of(2);
        Check(owner).that(even, "core", self.core as f64, "even, and at least 2")?;
        self.check(owner)
    }

    /// Mesh the unit disc or ball; its node set `side` is on the surface.
    pub(super) fn ball<const D: usize>(self, owner: &'static str) -> Result<ElementMesh<D>, GeometryError> {
        self.check(owner)?;
        let counts = [self.core, self.rings].map(|c| c as f64);
        let around = 2.0 * D as f64 * (counts[0] + 1.0).powi(D as i32 - 1);
        room((counts[0] + 1.0).powi(D as i32) + around * counts[1], around * counts[1], 1 << D)?;

        let mut mesh = box_mesh(&Cuboid::new([-1.0; D], [1.0; D])?, [self.core; D])?;
        mesh.node_sets.clear();
        let facets = mesh.surface()?;
        // Nodes of the surface of the core, each once, and the index of each among them.
        let mut inner: Vec<u32> = facets.iter().flat_map(|f| f.nodes().iter().copied()).collect();
        inner.sort_unstable();
        inner.dedup();
        let mut place = vec![0u32; mesh.nodes.len()];
        for (number, &node) in (0u32..).zip(&inner) {
            place[node as usize] = number;
        }
        let first = mesh.nodes.len() as u32;
        let number = |layer: usize, node: u32| match layer {
            0 => node,
            _ => first + ((layer - 1) * inner.len()) as u32 + place[node as usize],
        };
        let cube = mesh.nodes.clone();
        for x in &mut mesh.nodes {
            *x = core(*x);
        }
        for layer in 1..=self.rings {
            let t = layer as f64 / self.rings as f64;
            mesh.nodes
                .extend(inner.iter().map(|&n| between(core(cube[n as usize]), surface(cube[n as usize]), t)));
        }
        let mut outer = Vec::with_capacity((facets.len() * self.rings) << D);
        for layer in 0..self.rings {
            for facet in &facets {
                let [below, above] =
                    [layer, layer + 1].map(|l| facet.nodes().iter().map(move |&n| number(l, n)));
                match facet.nodes() {
                    [a, b] => outer.extend([
                        number(layer, *a),
                        number(layer + 1, *a),
                        number(layer + 1, *b),
                        number(layer, *b),
                    ]),
                    _ => outer.extend(below.chain(above)),
                }
            }
        }
        let side = inner.iter().map(|&n| number(self.rings, n)).collect();
        mesh.node_sets.insert("side".into(), side);
        mesh.blocks[0].nodes.extend(outer);
        Ok(mesh)
    }
}

/// Map a point `u` of the cube from -1 to 1 to the core: between the cube and the ball; the bulge is under the root.
fn core<const D: usize>(u: [f64; D]) -> [f64; D] {
    std::array::from_fn(|i| {
        let (mut squares, mut product) = (0.0, 1.0);
        for j in (0..D).filter(|&j| j != i) {
            squares += u[j] * u[j];
            product *= u[j] * u[j];
        }
        let both = if D == 3 { BULGE * BULGE * product / 3.0 } else { 0.0 };
        CORE * u[i] * (1.0 - 0.5 * BULGE * squares + both).sqrt()
    })
}

/// Map a point of the surface of the cube to the surface of the unit ball, at equal angles along the edges of the cube.
fn surface<const D: usize>(u: [f64; D]) -> [f64; D] {
    let t = u.map(|c| (c * FRAC_PI_4).tan());
    let length = norm(t);
    t.map(|c| c / length)
}

pub(super) fn between<const D: usize>(a: [f64; D], b: [f64; D], t: f64) -> [f64; D] {
    std::array::from_fn(|i| (1.0 - t) * a[i] + t * b[i])
}

/// Extract the elements whose centre has a positive coordinate along `axis`.
pub(super) fn positive<const D: usize>(
    mesh: &ElementMesh<D>,
    axis: usize,
) -> Result<ElementMesh<D>, GeometryError> {
    mesh.part(&|block, element| mesh.centre(block, element)[axis] > 0.0)
}

/// Mesh a disc by quadrilaterals, or a ball by bricks. The node set `side` is its surface.
///
/// # Errors
/// [`GeometryError::Parameter`] unless there are two or three dimensions and counts are positive; [`GeometryError::Memory`] for too many
/// elements.
pub fn ball_mesh<const D: usize>(
    ball: &Ball<D>,
    section: Butterfly,
) -> Result<ElementMesh<D>, GeometryError> {
    Check("ball mesh").that(D == 2 || D == 3, "number of dimensions", D as f64, "2 or 3")?;
    section.ball("ball mesh")?.mapped(|x| along(ball.centre(), ball.radius(), x))
}

/// Mesh the half r > 0 of a disc on the axis r = 0, a ball in axisymmetric coordinates (r, z), by quadrilaterals, none of them
/// collapsed on the axis. Node sets: `axis`, and `side`, the sphere.
///
/// # Errors
/// [`GeometryError::Parameter`] unless the centre is at r = 0, counts are positive and that of the core even; [`GeometryError::Memory`]
/// for too many elements.
pub fn half_disc_mesh(disc: &Disc, section: Butterfly) -> Result<ElementMesh<2>, GeometryError> {
    let owner = "half disc mesh";
    section.check_even(owner)?;
    let centre = disc.centre();
    Check(owner).that(centre[0] == 0.0, "r of the centre", centre[0], "0: on the axis")?;
    let half = positive(&section.ball::<2>(owner)?, 0)?.mapped(|x| along(centre, disc.radius(), x))?;
    let axis = half.nodes_where(|x| x[0] == 0.0);
    half.with_node_set("axis", axis)
}

/// Mesh a ring by quadrilaterals: `counts` are radial (at least one) and circumferential (at least three). Node sets: `inner`, `outer`.
///
/// # Errors
/// [`GeometryError::Parameter`] unless the counts are large enough; [`GeometryError::Memory`] for too many elements.
pub fn ring_mesh(ring: &Ring, counts: [usize; 2]) -> Result<ElementMesh<2>, GeometryError> {
    ring_of(ring.centre, [ring.inner, ring.outer], counts, "ring mesh")
}

fn ring_of(
    centre: [f64; 2],
    [inner, outer]: [f64; 2],
    [radial, around]: [usize; 2],
    owner: &'static str,
) -> Result<ElementMesh<2>, GeometryError> {
    let check = Check(owner);
    check.that(radial > 0, "elements across", radial as f64, "at least 1")?;
    check.that(around > 2, "elements around", around as f64, "at least 3")?;
    room((radial as f64 + 1.0) * around as f64, radial as f64 * around as f64, 4)?;
    let radii = Spacing::uniform(radial).nodes(inner, outer);
    let angle = |k: usize| TAU * k as f64 / around as f64;
    let circle = |r: f64| (0..around).map(move |k| along(centre, r, [angle(k).cos(), angle(k).sin()]));
    let number = |j: usize, k: usize| (j * around + k % around) as u32;
    let quad = |j, k| [number(j, k), number(j + 1, k), number(j + 1, k + 1), number(j, k + 1)];
    let nodes = (0..radial).flat_map(|j| (0..around).flat_map(move |k| quad(j, k))).collect();
    let mesh = ElementMesh {
        nodes: radii.into_iter().flat_map(circle).collect(),
        blocks: vec![ElementBlock { name: String::new(), kind: ElementKind::Quad4, nodes }],
        node_sets: [("inner", 0), ("outer", radial)]
            .map(|(name, j)| (name.to_string(), (0..around).map(|k| number(j, k)).collect()))
            .into(),
        ..ElementMesh::default()
    };
    mesh.check()?;
    Ok(mesh)
}

/// Transform a mesh extruded along the third axis to an axis in space.
pub(super) fn placed(mesh: ElementMesh<3>, axis: &Axis<3>) -> Result<ElementMesh<3>, GeometryError> {
    let along_axis = axis.direction;
    // The part of the first or second coordinate axis that is perpendicular to the axis.
    let helper = if along_axis[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let across = along(helper, -dot(helper, along_axis), along_axis);
    let length = norm(across);
    let across = across.map(|c| c / length);
    let third = cross(along_axis, across);
    mesh.mapped(|[x, y, z]| along(along(along(axis.start, x, across), y, third), z, along_axis))
}

/// Mesh a cylinder by bricks: an extruded disc with `along` elements on the axis (a number, or a graded [`Spacing`]). Node sets: `side`,
/// and the ends `start` and `end`.
///
/// # Errors
/// [`GeometryError::Parameter`] unless counts are positive, [`GeometryError::Memory`] for too many elements.
pub fn cylinder_mesh(
    body: &Cylinder<3>,
    section: Butterfly,
    along: impl Into<Spacing>,
) -> Result<ElementMesh<3>, GeometryError> {
    let owner = "cylinder mesh";
    let heights = along.into().check(owner)?.nodes(0.0, body.length);
    let disc = section.ball::<2>(owner)?.scaled(body.radius, [0.0; 2])?;
    placed(disc.extruded(&heights)?, &body.axis)
}

/// Mesh a tube by bricks: an extruded ring with `section` elements across its wall and around it, and `along` its axis. Node sets:
/// `inner`, `outer`, and the ends `start` and `end`.
///
/// # Errors
/// Errors of [`ring_mesh`] and [`cylinder_mesh`].
pub fn tube_mesh(
    body: &Tube<3>,
    section: [usize; 2],
    along: impl Into<Spacing>,
) -> Result<ElementMesh<3>, GeometryError> {
    let owner = "tube mesh";
    let heights = along.into().check(owner)?.nodes(0.0, body.length);
    let ring = ring_of([0.0; 2], [body.inner, body.outer], section, owner)?;
    placed(ring.extruded(&heights)?, &body.axis)
}
