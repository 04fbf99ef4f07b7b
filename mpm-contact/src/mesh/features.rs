//! Features of a surface near a point: faces, edges and corners at which its distance is least.

use impactite_geometry::Facet;

use super::closest::Closest;
use crate::vector::{difference, dot, length, sum, times, unit};

/// Relative tolerance of equal distances to two facets.
const EQUALLY: f64 = 1e-9;
/// Distance to an edge or corner, over the facet's size, below which the mean normal of the facets there is used: the direction to the
/// point is noise.
const UPON: f64 = 1e-7;
/// Sine of the angle by which a facet rises before its neighbour at a concave edge.
const CONCAVE: f64 = 1e-3;
/// Cosine of the angle between the normals of a point and a facet above which the facet hardly faces it, and least reduction of it by a
/// neighbour that does.
const TURNED: [f64; 2] = [-0.25, 0.5];
/// Cosine of the angle between outward normals of one surface above which both belong to the same sheet.
const SAME_SHEET: f64 = 0.5;

/// Facet near a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// Number of the facet.
    pub facet: u32,
    pub nodes: [u32; 4],
    /// Centre: mean of the corners, m.
    pub centre: [f64; 3],
    /// Radius of the bounding sphere, m.
    pub size: f64,
    pub closest: Closest,
    /// True if the facet is turned away from the point ([`turn_away`]).
    pub turned: bool,
}

/// Mark facets that are turned away from a node of a mesh with this normal: a neighbour beyond a convex edge, no farther than `back` (m),
/// opposes it. A node of a flat surface under an edge is below one face, and not before the other, however near that is. A protruding part
/// there is another node, in contact with facets of the flat surface.
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

/// Possible contact of a point with a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Feature {
    pub facet: u32,
    pub nodes: [u32; 4],
    pub weights: [f64; 4],
    /// Unit normal out of the surface.
    pub normal: [f64; 3],
    /// Signed distance along the normal, m; negative inside.
    pub height: f64,
    /// Closest point, and centre of the facet, m.
    pub at: [f64; 3],
    pub centre: [f64; 3],
}

/// Side information of a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// True if the surface encloses a volume, so that a point nearest to its inside is inside.
    pub closed: bool,
    /// Largest depth behind a facet at which a point counts as having passed through, m.
    pub back: f64,
    /// Nodes of the facet of the last contact.
    pub held: Option<[u32; 4]>,
    /// Number and normal of a node of the same surface.
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

/// Find the feature of `near[n]`, and the number of facets that share it, if the distance is least there among these facets and this facet
/// determines the side. With `every`, accept any place of the facets, nearest or not, before which the point is. None beyond an end of the
/// facet whose neighbour is turned away: `beyond` is then reduced to that distance, m.
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
            // Before a corner that opens towards it, the point is in contact with every side.
            concave |= upon && dot(difference(other.centre, at), normal) > CONCAVE * other.size;
            if concave {
                continue;
            }
            // A face has priority over its edge, an edge over its end: the same place but for rounding.
            if other.feature().count() > this.feature().count() {
                return None;
            }
            // For a point on their edge or corner one facet represents all: the distances are rounding.
            if distance <= UPON * this.size.max(other.size) {
                if m < n {
                    return None;
                }
                normals = sum(normals, other.closest.normal);
                continue;
            }
            // The facet with the farthest plane determines the side \[BaerentzenAanaes2005\].
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

/// Find all features of possible contact of a point at `x`, into `out`: those before which it is; if it is behind the nearest one, that one
/// and those with it at a corner. With `every`, each place before which it is: all that a ball larger than facets may press.
pub(super) fn features(x: [f64; 3], near: &[Near], side: &Side, every: bool, out: &mut Vec<Feature>) {
    out.clear();
    let mut before = f64::INFINITY;
    // Nearest feature behind which the point is; facets near the held one have priority.
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
        // The point is before the nearest feature, or before its last contact: the feature behind is the far side of a sheet.
        if shallow > 0 {
            out.retain(|feature| feature.height >= 0.0);
        }
        return;
    }
    // At a concave corner the point is behind two sides; at a convex one, of a thin body too, it passed through the nearer one.
    out.retain(|feature| {
        let rise = dot(difference(feature.centre, nearest.at), nearest.normal);
        let concave = rise > CONCAVE * length(difference(feature.centre, nearest.at));
        feature.facet != nearest.facet
            && (feature.height >= 0.0 || (concave && share(&feature.nodes, &nearest.nodes)))
    });
    out.push(nearest);
}
