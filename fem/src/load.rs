//! Tractions and pressures on facets of the surface.

use std::sync::Arc;

use impactite_geometry::Facet;

/// Traction history: Pa at a time in s.
pub type TractionHistory<const D: usize> = Arc<dyn Fn(f64) -> [f64; D] + Send + Sync>;

/// Pressure history: Pa, compression positive, at a time in s.
pub type PressureHistory = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// Load on facets.
#[derive(Clone)]
pub(crate) enum Loading<const D: usize> {
    /// Dead load: a traction history on nodes with their shares of the initial area, m^2 (per metre of depth or per radian).
    Traction { areas: Vec<(u32, f64)>, history: TractionHistory<D> },
    /// Pressure along the present normals on the present areas of facets.
    Pressure { facets: Vec<Facet>, history: PressureHistory },
}

/// Load on a part of the surface of a body.
#[derive(Clone)]
pub(crate) struct SurfaceLoad<const D: usize> {
    /// Description of the loaded facets, for checkpoints.
    pub facets: String,
    /// Initial area, m^2.
    pub area: f64,
    pub loading: Loading<D>,
    /// Forces on nodes in the last step, N, by ascending node.
    pub acting: Vec<(u32, [f64; D])>,
}

impl<const D: usize> SurfaceLoad<D> {
    /// Update the forces to a time, s, and nodes at `positions`, m.
    pub fn act(&mut self, time: f64, positions: &impl Fn(u32) -> [f64; D], hoop: bool) {
        self.acting.clear();
        match &self.loading {
            Loading::Traction { areas, history } => {
                let traction = history(time);
                self.acting.extend(areas.iter().map(|(node, area)| (*node, traction.map(|t| area * t))));
            }
            Loading::Pressure { facets, history } => {
                let pressure = history(time);
                for facet in facets {
                    let (view, shares) = of_nodes(facet, positions, hoop);
                    for (&node, share) in facet.nodes().iter().zip(shares) {
                        self.acting.push((node, view.normal.map(|n| -pressure * share * n)));
                    }
                }
                add_up(&mut self.acting);
            }
        }
    }

    /// Keep a pressure on the facets of the remaining surface alone.
    pub fn keep(&mut self, surface: &[Facet]) {
        if let Loading::Pressure { facets, .. } = &mut self.loading {
            let key = |f: &Facet| (f.block, f.element, f.nodes);
            let mut there: Vec<_> = surface.iter().map(key).collect();
            there.sort_unstable();
            facets.retain(|f| there.binary_search(&key(f)).is_ok());
        }
    }

    /// Describe the load at the start, for checkpoints.
    pub fn describe(&self) -> String {
        let start = match &self.loading {
            Loading::Traction { history, .. } => format!("{:?}", history(0.0)),
            Loading::Pressure { history, .. } => format!("a pressure of {:?}", history(0.0)),
        };
        format!("{start} Pa at the start on {}, {:?} m^2", self.facets, self.area)
    }

    /// Force on a node in the last step, N.
    pub fn on(&self, node: u32) -> Option<&[f64; D]> {
        let at = self.acting.binary_search_by_key(&node, |(node, _)| *node).ok()?;
        Some(&self.acting[at].1)
    }
}

/// Sort forces by node, and add up those of each node in their order.
fn add_up<const D: usize>(forces: &mut Vec<(u32, [f64; D])>) {
    forces.sort_by_key(|(node, _)| *node);
    forces.dedup_by(|next, sum| {
        let same = next.0 == sum.0;
        if same {
            (0..D).for_each(|d| sum.1[d] += next.1[d]);
        }
        same
    });
}

/// Compute the present centre, normal and area of a facet, and the nodal shares of the area.
pub(crate) fn of_nodes<const D: usize>(
    facet: &Facet,
    positions: &impl Fn(u32) -> [f64; D],
    hoop: bool,
) -> (SurfaceFacet<D>, [f64; 4]) {
    let (mut x, mut own) = ([[0.0; D]; 4], *facet);
    for (n, &node) in facet.nodes().iter().enumerate() {
        (x[n], own.nodes[n]) = (positions(node), n as u32);
    }
    view(&x, &own, hoop)
}

/// Surface facet in the initial configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceFacet<const D: usize> {
    /// Centre: mean of the node positions, m.
    pub centre: [f64; D],
    /// Outward unit normal.
    pub normal: [f64; D],
    /// Area, m^2 (per metre of depth or per radian).
    pub area: f64,
    /// Nodes of the facet in the mesh.
    pub nodes: [Option<u32>; 4],
}

/// Compute centre, normal and area of a facet, and the nodal shares of the area: integrals of the shape functions.
pub(crate) fn view<const D: usize>(
    nodes: &[[f64; D]],
    facet: &Facet,
    hoop: bool,
) -> (SurfaceFacet<D>, [f64; 4]) {
    let x: Vec<[f64; D]> = facet.nodes().iter().map(|n| nodes[*n as usize]).collect();
    let centre = std::array::from_fn(|d| x.iter().map(|x| x[d]).sum::<f64>() / x.len() as f64);
    let (mut normal, mut shares) = ([0.0; D], [0.0; 4]);
    if D == 3 {
        // A quadrilateral is the mean of its two pairs of triangles.
        let fans: &[[usize; 3]] = match x.len() {
            3 => &[[0, 1, 2]],
            _ => &[[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]],
        };
        let part = if x.len() == 3 { 1.0 } else { 0.5 };
        for fan in fans {
            let [a, b, c] = fan.map(|n| x[n]);
            let edge = |to: [f64; D], d: usize| to[d] - a[d];
            let cross: [f64; 3] = std::array::from_fn(|d| {
                let (i, j) = ((d + 1) % 3, (d + 2) % 3);
                0.5 * part * (edge(b, i) * edge(c, j) - edge(b, j) * edge(c, i))
            });
            let area = cross.iter().map(|n| n * n).sum::<f64>().sqrt();
            fan.iter().for_each(|n| shares[*n] += area / 3.0);
            (0..D).for_each(|d| normal[d] += cross[d]);
        }
    } else if let [a, b] = x[..] {
        let along: [f64; D] = std::array::from_fn(|d| b[d] - a[d]);
        let length = along.iter().map(|e| e * e).sum::<f64>().sqrt();
        let radius = |near: f64, far: f64| if hoop { (2.0 * near + far) / 3.0 } else { 1.0 };
        shares[0] = 0.5 * length * radius(a[0], b[0]);
        shares[1] = 0.5 * length * radius(b[0], a[0]);
        (normal[0], normal[1]) = (along[1], -along[0]);
    }
    let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
    let (normal, area) = (normal.map(|n| n / length), shares.iter().sum());
    let facet = SurfaceFacet { centre, normal, area, nodes: [None; 4] };
    (facet, shares)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::surface_of;
    use impactite_geometry::Cuboid;
    use impactite_geometry::structured::box_mesh;

    /// Surfaces of a box: areas and outward normals, and moments of the shares about the axis.
    #[test]
    fn facets_of_boxes_have_their_areas_and_normals() {
        let mesh =
            box_mesh(&Cuboid::new([0.0; 3], [1.0, 2.0, 3.0]).expect("a box"), [2, 3, 4]).expect("a mesh");
        let mut sums = [[0.0; 2]; 3];
        for facet in surface_of(&mesh, &|_| true) {
            let (view, shares) = view(&mesh.nodes, &facet, false);
            assert!((shares.iter().sum::<f64>() - view.area).abs() < 1e-12);
            let d = (0..3).find(|&d| view.normal[d].abs() > 0.99).expect("along an axis");
            let outside = view.normal[d] > 0.0;
            assert_eq!(view.centre[d], if outside { [1.0, 2.0, 3.0][d] } else { 0.0 });
            sums[d][usize::from(outside)] += view.area;
        }
        for (sum, area) in sums.iter().zip([6.0, 3.0, 2.0]) {
            assert!(sum.iter().all(|s| (s - area).abs() < 1e-12), "{sum:?}");
        }
        let ring = box_mesh(&Cuboid::new([1.0, 0.0], [3.0, 1.0]).expect("a box"), [2, 1]).expect("a mesh");
        let top = surface_of(&ring, &|_| true).into_iter().map(|f| view(&ring.nodes, &f, true).0);
        let area: f64 = top.filter(|f| f.normal[1] > 0.9).map(|f| f.area).sum();
        assert!((area - 4.0).abs() < 1e-12, "(9 - 1) / 2 per radian: {area}");
    }
}
