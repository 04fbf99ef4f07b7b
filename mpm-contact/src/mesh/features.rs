//! Which features of a surface a point faces: faces, edges and corners at which its distance is least.

use impactite_geometry::Facet;

use super::closest::Closest;
use crate::vector::{difference, dot, length, sum, times, unit};

/// A part of the distance within which two facets are equally near.
const EQUALLY: f64 = 1e-9;
/// A point this near to an edge or corner, as a part of the facet's size, has the mean normal of the facets there: the direction to it is noise.
const UPON: f64 = 1e-7;
/// Sine of the angle by which a facet rises before its neighbour where their edge is concave.
const CONCAVE: f64 = 1e-3;
/// The cosine of the angle between the normals of a point and a facet above which the facet hardly faces it, and how much less that of a
/// neighbour must be which does.
const TURNED: [f64; 2] = [-0.25, 0.5];
/// Cosine of the angle between outward normals of one surface above which both belong to the same sheet.
const SAME_SHEET: f64 = 0.5;

/// A facet near a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// Its number.
    pub facet: u32,
    pub nodes: [u32; 4],
    /// Mean of its corners, m.
    pub centre: [f64; 3],
    /// Radius of the sphere around it, m.
    pub size: f64,
    pub closest: Closest,
    /// Is it turned away from the point ([`turn_away`])?
    pub turned: bool,
}

/// Mark facets that are turned away from a node of a mesh with this normal: where a neighbour beyond a convex edge, no farther than `back`
/// (m), opposes it. A node of a flat surface under an edge is below the one face, and not before the other, however near that is. What
/// sticks out there is another node, which meets facets of the flat surface.
pub(super) fn turn_away(near: &mut [Near], normal: [f64; 3], back: f64) {
    for n in 0..near.len() {
        let this = near[n];
        let faces = dot(normal, this.closest.normal);
        if faces <= TURNED[0] {
            continue;
        }
        near[n].turned = near.iter().any(|other| {
            let beside = difference(other.centre, this.centre);
            other.closest.distance <= back
                && dot(normal, other.closest.normal) < faces - TURNED[1]
                && share(&this.nodes, &other.nodes)
                && dot(beside, this.closest.normal) <= CONCAVE * length(beside)
        });
    }
}

/// Where a point may touch a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Feature {
    pub facet: u32,
    pub nodes: [u32; 4],
    pub weights: [f64; 4],
    /// Unit direction out of the surface.
    pub normal: [f64; 3],
    /// Signed distance along it, m; negative inside.
    pub height: f64,
    /// The closest point and the middle of the facet, m.
    pub at: [f64; 3],
    pub centre: [f64; 3],
}

/// What is known of a point beside its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// Does the surface enclose a volume, so that a point nearest to its inside is inside?
    pub closed: bool,
    /// How deep behind a facet a point may be and still count as having come through it, m.
    pub back: f64,
    /// The nodes of the facet that it touched last.
    pub held: Option<[u32; 4]>,
    /// Of a node of the same surface: its number and normal.
    pub own: Option<(u32, [f64; 3])>,
}

fn there(nodes: &[u32; 4]) -> impl Iterator<Item = u32> + '_ {
    nodes.iter().copied().filter(|&n| n != Facet::NONE)
}

fn share(a: &[u32; 4], b: &[u32; 4]) -> bool {
    there(a).any(|n| b.contains(&n))
}

impl Near {
    /// Nodes of the face, edge or corner on which the closest point lies.
    fn feature(&self) -> impl Iterator<Item = u32> + '_ {
        there(&self.nodes).zip(self.closest.weights).filter(|(_, w)| *w > 0.0).map(|(n, _)| n)
    }
    fn is_within(&self) -> bool {
        there(&self.nodes).zip(self.closest.weights).all(|(_, w)| w > 0.0)
    }
}

/// The feature of `near[n]`, if the distance is least there among all facets that share it, and if this facet is the one that tells its
/// sides apart. With how many facets share it.
/// With `every` place of the facets, be it the nearest or not, before which the point lies.
/// None beyond an end of the facet where its neighbour is turned away: `beyond` is then at most how far that is, m.
fn feature_of(
    x: [f64; 3],
    near: &[Near],
    n: usize,
    every: bool,
    beyond: &mut f64,
) -> Option<(Feature, usize)> {
    let this = &near[n];
    let Closest { weights, at, distance, mut normal } = this.closest;
    if normal == [0.0; 3] || this.turned {
        return None;
    }
    let away = difference(x, at);
    let mut height = dot(away, normal);
    let mut sharing = 1;
    if !this.is_within() {
        let margin = EQUALLY * (distance + this.size);
        let upon = distance <= UPON * this.size;
        let (mut normals, mut concave) = (normal, false);
        for (m, other) in near.iter().enumerate() {
            if m == n || !this.feature().all(|node| other.nodes.contains(&node)) {
                continue;
            }
            if other.turned && !upon {
                *beyond = beyond.min(distance);
                return None;
            }
            if other.turned {
                sharing += 1;
                continue;
            }
            if other.closest.distance < distance - margin {
                if every && height > 0.0 {
                    continue;
                }
                return None;
            }
            sharing += 1;
            // Before a corner that opens towards it, it touches every side.
            concave |= upon && dot(difference(other.centre, at), normal) > CONCAVE * other.size;
            if concave {
                continue;
            }
            // A face knows better than its edge, an edge than its end: the same place but for rounding.
            if other.feature().count() > this.feature().count() {
                return None;
            }
            // Of a point on their edge or corner one of them speaks for all: what it is away from each is rounding.
            if distance <= UPON * this.size.max(other.size) {
                if m < n {
                    return None;
                }
                normals = sum(normals, other.closest.normal);
                continue;
            }
            // The facet whose plane is farthest knows the side \[BaerentzenAanaes2005\].
            let here = dot(away, other.closest.normal).abs();
            if here > height.abs() || (here == height.abs() && m < n) {
                return None;
            }
            normals = sum(normals, other.closest.normal);
        }
        if !upon {
            let outward = if height < 0.0 { -1.0 } else { 1.0 };
            normal = times(away, outward / length(away));
            height = outward * distance;
        } else if !concave {
            normal = unit(normals).unwrap_or(normal);
            height = dot(away, normal);
        }
    }
    Some((
        Feature { facet: this.facet, nodes: this.nodes, weights, normal, height, at, centre: this.centre },
        sharing,
    ))
}

/// All features that a point at `x` may touch, into `out`: those before which it lies; or if it lies behind the nearest one, that one
/// and those with it at a corner. Or `every` place before which it lies: all that a ball larger than facets may press.
pub(super) fn features(x: [f64; 3], near: &[Near], side: &Side, every: bool, out: &mut Vec<Feature>) {
    out.clear();
    let mut before = f64::INFINITY;
    // The nearest one behind which it lies: of the facets near the held one, if there is any.
    let mut behind: Option<(bool, Feature)> = None;
    let mut shallow = 0;
    let is_held = |feature: &Feature| side.held.is_some_and(|nodes| share(&nodes, &feature.nodes));
    let mut before_held = false;
    for n in 0..near.len() {
        if side.own.is_some_and(|(node, _)| near[n].nodes.contains(&node)) {
            continue;
        }
        let Some((feature, sharing)) = feature_of(x, near, n, every, &mut before) else { continue };
        if side.own.is_some_and(|(_, normal)| dot(normal, feature.normal) > SAME_SHEET) {
            continue;
        }
        if feature.height >= 0.0 {
            before = before.min(feature.height);
            before_held |= is_held(&feature);
            out.push(feature);
            continue;
        }
        let held = is_held(&feature);
        let closed = side.closed && side.own.is_none();
        if !held && !closed && (-feature.height > side.back || (sharing < 2 && !near[n].is_within())) {
            continue;
        }
        let nearer = |(by, best): &(bool, Feature)| (held, feature.height) > (*by, best.height);
        if behind.as_ref().is_none_or(nearer) {
            behind = Some((held, feature));
        }
        if -feature.height <= side.back {
            shallow += 1;
            out.push(feature);
        }
    }
    let Some((held, nearest)) = behind else { return };
    if before < -nearest.height && (before_held || !held) {
        // It is before the nearest feature, or before what it touched, and what it is behind of is the far side of a sheet.
        if shallow > 0 {
            out.retain(|feature| feature.height >= 0.0);
        }
        return;
    }
    // It is behind two sides at a concave corner; at a convex one, of something thin too, it came through the nearer one.
    out.retain(|feature| {
        let rise = dot(difference(feature.centre, nearest.at), nearest.normal);
        let concave = rise > CONCAVE * length(difference(feature.centre, nearest.at));
        feature.facet != nearest.facet
            && (feature.height >= 0.0 || (concave && share(&feature.nodes, &nearest.nodes)))
    });
    out.push(nearest);
}
