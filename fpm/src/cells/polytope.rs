//! Convex cells: polygons and polyhedra, cut by planes.

use crate::vector::{along, difference, dot, norm};

/// Neighbour across a facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Beyond {
    /// Another cell, by number.
    Cell(u32),
    /// No cell: the facet is on this plane of the domain.
    Outside(u32),
}

/// Facet of a cell: in the plane an edge of two corners with the cell on its left; in space a polygon, counter-clockwise from outside.
#[derive(Clone, Debug)]
pub(crate) struct Facet<const D: usize> {
    pub beyond: Beyond,
    pub corners: Vec<[f64; D]>,
}

/// Convex cell; in the plane its facets are in sequence.
#[derive(Clone, Debug)]
pub(crate) struct Polytope<const D: usize> {
    pub facets: Vec<Facet<D>>,
}

/// Tolerance of a cut over the size of a cell: corners where more than D + 1 cells meet stay corners.
const ON_PLANE: f64 = 1e-12;

impl<const D: usize> Facet<D> {
    /// Return area times outward normal (length in the plane), and centroid.
    pub fn measure(&self) -> ([f64; D], [f64; D]) {
        measure(&self.corners)
    }
}

/// Return area times normal of a facet of these corners, and its centroid.
pub(crate) fn measure<const D: usize>(corners: &[[f64; D]]) -> ([f64; D], [f64; D]) {
    let mut area = [0.0; D];
    let first = &corners[0];
    if D == 2 {
        let edge = difference(&corners[1], first);
        (area[0], area[1]) = (edge[1], -edge[0]);
        return (area, along(first, 0.5, &edge));
    }
    // Fan of triangles about the first corner.
    let triangles = || {
        corners[1..].windows(2).map(|pair| {
            let (a, b) = (difference(&pair[0], first), difference(&pair[1], first));
            let mut half = [0.0; D];
            for i in 0..D {
                let (j, k) = ((i + 1) % D, (i + 2) % D);
                half[i] = 0.5 * (a[j] * b[k] - a[k] * b[j]);
            }
            (half, a, b)
        })
    };
    for (half, ..) in triangles() {
        area = along(&area, 1.0, &half);
    }
    let square = dot(&area, &area);
    let mut centroid = *first;
    for (half, a, b) in triangles() {
        let share = if square > 0.0 { dot(&half, &area) / square } else { 0.0 };
        for d in 0..D {
            centroid[d] += share * (a[d] + b[d]) / 3.0;
        }
    }
    (area, centroid)
}

impl<const D: usize> Polytope<D> {
    /// Create a box. Its facets are on planes 2 d (low) and 2 d + 1 (high) along axis d.
    pub fn cuboid(low: &[f64; D], high: &[f64; D]) -> Self {
        let corner = |bits: usize| -> [f64; D] {
            std::array::from_fn(|d| if bits >> d & 1 == 1 { high[d] } else { low[d] })
        };
        let plane: [(u32, &[usize]); 4] = [(2, &[0, 1]), (1, &[1, 3]), (3, &[3, 2]), (0, &[2, 0])];
        let space: [(u32, &[usize]); 6] = [
            (0, &[0, 4, 6, 2]),
            (1, &[1, 3, 7, 5]),
            (2, &[0, 1, 5, 4]),
            (3, &[2, 6, 7, 3]),
            (4, &[0, 2, 3, 1]),
            (5, &[4, 5, 7, 6]),
        ];
        let list = if D == 2 { &plane[..] } else { &space[..] };
        let facet = |(n, bits): &(u32, &[usize])| Facet {
            beyond: Beyond::Outside(*n),
            corners: bits.iter().map(|&b| corner(b)).collect(),
        };
        Polytope { facets: list.iter().map(facet).collect() }
    }

    /// All corners, most of them more than once.
    pub fn corners(&self) -> impl Iterator<Item = &[f64; D]> {
        self.facets.iter().flat_map(|f| &f.corners)
    }

    /// Return the largest distance of a corner from `x`.
    pub fn reach(&self, x: &[f64; D]) -> f64 {
        self.corners().map(|c| norm(&difference(c, x))).fold(0.0, f64::max)
    }

    /// Return volume and centroid, summed about `x`, preferably within the cell.
    pub fn volume_and_centroid(&self, x: &[f64; D]) -> (f64, [f64; D]) {
        let (mut volume, mut moment) = (0.0, [0.0; D]);
        for facet in &self.facets {
            let (area, centre) = facet.measure();
            let from = difference(&centre, x);
            let cone = dot(&area, &from) / D as f64;
            volume += cone;
            moment = along(&moment, cone * D as f64 / (D as f64 + 1.0), &from);
        }
        (volume, along(x, 1.0 / volume, &moment))
    }

    /// Cut the cell: keep n . x <= offset, with `beyond` behind the plane. `size` is that of the cell, m.
    pub fn cut(&mut self, normal: &[f64; D], offset: f64, size: f64, beyond: Beyond) {
        let least = ON_PLANE * size * norm(normal);
        let height = |x: &[f64; D]| dot(normal, x) - offset;
        if self.corners().all(|x| height(x) <= least) {
            return;
        }
        if D == 2 {
            self.cut_polygon(height, least, beyond);
        } else {
            self.cut_polyhedron(normal, height, least, beyond);
        }
        // Remove facets without area, where the plane touches a corner or an edge.
        let flat = ON_PLANE * size.powi(D as i32 - 1);
        self.facets.retain(|f| norm(&f.measure().0) > flat);
    }

    fn cut_polygon(&mut self, height: impl Fn(&[f64; D]) -> f64, least: f64, beyond: Beyond) {
        let mut kept: Vec<Facet<D>> = Vec::with_capacity(self.facets.len() + 1);
        let (mut out, mut back) = (None, None);
        for facet in &self.facets {
            let (a, b) = (facet.corners[0], facet.corners[1]);
            let (at_a, at_b) = (height(&a), height(&b));
            let edge = |corners| Facet { beyond: facet.beyond, corners };
            match (at_a <= least, at_b <= least) {
                (true, true) => kept.push(edge(vec![a, b])),
                (true, false) => {
                    let p = crossing(&a, at_a, &b, at_b);
                    kept.push(edge(vec![a, p]));
                    out = Some((kept.len(), p));
                }
                (false, true) => {
                    let p = crossing(&a, at_a, &b, at_b);
                    back = Some(p);
                    kept.push(edge(vec![p, b]));
                }
                (false, false) => {}
            }
        }
        if let (Some((place, p)), Some(q)) = (out, back) {
            kept.insert(place, Facet { beyond, corners: vec![p, q] });
        }
        self.facets = kept;
    }

    fn cut_polyhedron(
        &mut self,
        normal: &[f64; D],
        height: impl Fn(&[f64; D]) -> f64,
        least: f64,
        beyond: Beyond,
    ) {
        let mut rim: Vec<[f64; D]> = Vec::new();
        for facet in &mut self.facets {
            let corners = std::mem::take(&mut facet.corners);
            for (i, a) in corners.iter().enumerate() {
                let b = &corners[(i + 1) % corners.len()];
                let (at_a, at_b) = (height(a), height(b));
                if at_a <= least {
                    facet.corners.push(*a);
                }
                if (at_a <= least) != (at_b <= least) {
                    let p = crossing(a, at_a, b, at_b);
                    facet.corners.push(p);
                    // A corner of the rim is on two facets, and leaves the kept side on one of them only.
                    if at_a <= least {
                        rim.push(p);
                    }
                }
            }
        }
        self.facets.retain(|f| f.corners.len() > 2);
        if rim.len() > 2 && !self.facets.is_empty() {
            sort_around(&mut rim, normal);
            self.facets.push(Facet { beyond, corners: rim });
        }
    }
}

/// Return the intersection of an edge with the plane, bitwise identical from both ends.
fn crossing<const D: usize>(a: &[f64; D], at_a: f64, b: &[f64; D], at_b: f64) -> [f64; D] {
    let swap = at_a > at_b;
    let (a, at_a, b, at_b) = if swap { (b, at_b, a, at_a) } else { (a, at_a, b, at_b) };
    // A corner that is kept may be beyond the plane by rounding.
    let part = (-at_a / (at_b - at_a)).clamp(0.0, 1.0);
    along(a, part, &difference(b, a))
}

/// Sort corners of a convex polygon counter-clockwise about the normal.
fn sort_around<const D: usize>(corners: &mut [[f64; D]], normal: &[f64; D]) {
    let mut middle = [0.0; D];
    corners.iter().for_each(|c| middle = along(&middle, 1.0 / corners.len() as f64, c));
    // Two directions in the plane of the polygon, right-handed with the normal.
    let least = (0..D).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(0);
    let (mut u, mut v) = ([0.0; D], [0.0; D]);
    u[least] = 1.0;
    u = along(&u, -normal[least] / dot(normal, normal), normal);
    for i in 0..D {
        let (j, k) = ((i + 1) % D, (i + 2) % D);
        v[i] = normal[j] * u[k] - normal[k] * u[j];
    }
    let (length, width) = (norm(&u), norm(&v));
    let angle = |c: &[f64; D]| {
        let from = difference(c, &middle);
        (dot(&from, &v) / width).atan2(dot(&from, &u) / length)
    };
    corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_cut_off_a_box_is_missing() {
        let mut square = Polytope::cuboid(&[0.0; 2], &[2.0, 1.0]);
        assert_eq!(square.volume_and_centroid(&[0.5, 0.5]), (2.0, [1.0, 0.5]));
        // Cut off a corner of area 1/8.
        square.cut(&[1.0, 1.0], 2.5, 1.0, Beyond::Cell(7));
        let (area, _) = square.volume_and_centroid(&[0.5, 0.5]);
        assert!((area - 1.875).abs() < 1e-15 && square.facets.len() == 5);
        let new = square.facets.iter().find(|f| f.beyond == Beyond::Cell(7)).expect("a facet");
        let (normal, centre) = new.measure();
        assert!((normal[0] - 0.5).abs() < 1e-15 && (normal[1] - 0.5).abs() < 1e-15);
        assert!((centre[0] - 1.75).abs() < 1e-15 && (centre[1] - 0.75).abs() < 1e-15);

        let mut cube = Polytope::cuboid(&[0.0; 3], &[1.0; 3]);
        assert_eq!(cube.volume_and_centroid(&[0.2; 3]).0, 1.0);
        // Cut off a corner tetrahedron of edges 1/2, then half of the rest.
        cube.cut(&[1.0, 1.0, 1.0], 2.5, 1.0, Beyond::Cell(1));
        let (volume, _) = cube.volume_and_centroid(&[0.2; 3]);
        assert!((volume - (1.0 - 1.0 / 48.0)).abs() < 1e-15, "{volume}");
        cube.cut(&[0.0, 0.0, 1.0], 0.5, 1.0, Beyond::Cell(2));
        let (volume, centre) = cube.volume_and_centroid(&[0.2; 3]);
        assert!((volume - 0.5).abs() < 1e-15 && (centre[2] - 0.25).abs() < 1e-15);
        let closed = cube.facets.iter().fold([0.0; 3], |sum, f| along(&sum, 1.0, &f.measure().0));
        assert!(norm(&closed) < 1e-15);
        // Cut off everything.
        cube.cut(&[0.0, 0.0, 1.0], -1.0, 1.0, Beyond::Cell(3));
        assert!(cube.facets.is_empty());
    }

    #[test]
    fn a_plane_through_corners_cuts_nothing() {
        let mut square = Polytope::cuboid(&[0.0; 2], &[1.0; 2]);
        square.cut(&[1.0, 1.0], 2.0 - 1e-14, 1.0, Beyond::Cell(0));
        assert_eq!(square.facets.len(), 4);
    }
}
