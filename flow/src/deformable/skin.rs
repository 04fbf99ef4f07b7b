//! Closed surface of facets: signed distance, and interpolation at the nearest point.

/// Largest number of facets of a leaf of the tree.
const LEAF: usize = 4;
/// Barycentric weight below which a nearest point is on an edge or a corner.
const ON_EDGE: f64 = 1e-9;

/// Box of a part of the facets.
#[derive(Clone, Debug)]
struct Branch<const D: usize> {
    low: [f64; D],
    high: [f64; D],
    /// First facet in the order of the tree, and number of facets.
    first: usize,
    count: usize,
    /// Index of the second child, the first one follows its parent; none for a leaf.
    second: Option<usize>,
}

/// Closed surface of segments (plane) or triangles (space), with a tree of boxes.
///
/// The sign of the distance is that of the component along the normal of the nearest facet, edge or corner, whose normals are the sums of those
/// of its facets, by the angles at a corner (\[Baerentzen2005\]).
#[derive(Clone, Debug)]
pub(crate) struct Skin<const D: usize> {
    /// Nodes of each facet; in the plane the surface is to the left of the matter, seen along a segment.
    facets: Vec<[u32; D]>,
    places: Vec<[f64; D]>,
    normals: Vec<[f64; D]>,
    corners: Vec<[f64; D]>,
    /// In space: normals of the edges of each facet, opposite to its nodes.
    edges: Vec<[[f64; D]; D]>,
    /// Facets beside each edge of each facet, opposite to its nodes; in space.
    beside: Vec<[usize; D]>,
    order: Vec<usize>,
    tree: Vec<Branch<D>>,
}

/// Nearest point of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest<const D: usize> {
    /// Signed distance, m: positive outside of the matter.
    pub gap: f64,
    pub facet: usize,
    /// Barycentric weights of the nodes of the facet.
    pub weights: [f64; D],
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|d| a[d] * b[d]).sum()
}
fn minus<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|d| a[d] - b[d])
}

/// Outward normal of a facet, whose length is its measure times (D - 1).
fn area_normal<const D: usize>(x: &[[f64; D]; D]) -> [f64; D] {
    let a = minus(&x[1], &x[0]);
    let mut normal = [0.0; D];
    if D == 2 {
        (normal[0], normal[1]) = (a[1], -a[0]);
    } else {
        let b = minus(&x[2], &x[0]);
        for d in 0..D {
            let (i, j) = ((d + 1) % D, (d + 2) % D);
            normal[d] = a[i] * b[j] - a[j] * b[i];
        }
    }
    normal
}

fn unit<const D: usize>(a: [f64; D]) -> [f64; D] {
    let length = dot(&a, &a).sqrt();
    if length > 0.0 { a.map(|x| x / length) } else { a }
}

/// Barycentric weights of the point of a segment nearest to `p`.
fn on_segment<const D: usize>(p: &[f64; D], a: &[f64; D], b: &[f64; D]) -> [f64; 2] {
    let along = minus(b, a);
    let square = dot(&along, &along);
    let t = if square > 0.0 { (dot(&minus(p, a), &along) / square).clamp(0.0, 1.0) } else { 0.0 };
    [1.0 - t, t]
}

/// Barycentric weights of the point of a facet nearest to `p`.
fn on_facet<const D: usize>(p: &[f64; D], x: &[[f64; D]; D]) -> [f64; D] {
    let mut weights = [0.0; D];
    if D == 2 {
        weights.copy_from_slice(&on_segment(p, &x[0], &x[1]));
        return weights;
    }
    // By the signs of the areas of the three triangles with the projection of `p`.
    let normal = area_normal(x);
    let square = dot(&normal, &normal);
    if square > 0.0 {
        for (k, weight) in weights.iter_mut().enumerate() {
            let mut part = *x;
            part[k] = *p;
            *weight = dot(&area_normal(&part), &normal) / square;
        }
        if weights.iter().all(|w| *w >= 0.0) {
            return weights;
        }
    }
    // On an edge: the nearest of the three.
    let mut least = f64::INFINITY;
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let [a, b] = on_segment(p, &x[i], &x[j]);
        let away: [f64; D] = std::array::from_fn(|d| a * x[i][d] + b * x[j][d] - p[d]);
        let distance = dot(&away, &away);
        if distance < least {
            least = distance;
            weights = [0.0; D];
            (weights[i], weights[j]) = (a, b);
        }
    }
    weights
}

impl<const D: usize> Skin<D> {
    /// Create the surface of these facets; [`Skin::place`] sets the places of its nodes. None unless it is closed: every edge (corner in
    /// the plane) between two facets.
    pub fn new(facets: Vec<[u32; D]>, places: Vec<[f64; D]>) -> Option<Self> {
        let beside = neighbours(&facets)?;
        let mut skin = Skin {
            order: (0..facets.len()).collect(),
            facets,
            places,
            normals: Vec::new(),
            corners: Vec::new(),
            edges: Vec::new(),
            beside,
            tree: Vec::new(),
        };
        if skin.volume() < 0.0 {
            return None;
        }
        let middle =
            |f: usize, d: usize| skin.facets[f].iter().map(|n| skin.places[*n as usize][d]).sum::<f64>();
        let mut order = std::mem::take(&mut skin.order);
        let mut tree = Vec::new();
        grow(&mut tree, &mut order, 0, &middle);
        (skin.order, skin.tree) = (order, tree);
        skin.shape();
        Some(skin)
    }

    /// Enclosed volume, m^3 (m^2 in the plane).
    pub fn volume(&self) -> f64 {
        let Some(from) = self.places.first() else { return 0.0 };
        let part = |f: &[u32; D]| {
            let x = f.map(|n| self.places[n as usize]);
            dot(&minus(&x[0], from), &area_normal(&x))
        };
        self.facets.iter().map(part).sum::<f64>() / if D == 2 { 2.0 } else { 6.0 }
    }

    /// Nodes of a facet.
    pub fn nodes(&self, facet: usize) -> &[u32; D] {
        &self.facets[facet]
    }
    pub fn facets(&self) -> usize {
        self.facets.len()
    }
    pub fn places(&self) -> &[[f64; D]] {
        &self.places
    }
    /// Length of a facet, m, or twice its area, m^2.
    pub fn measure(&self, facet: usize) -> f64 {
        let x = self.facets[facet].map(|n| self.places[n as usize]);
        let normal = area_normal(&x);
        dot(&normal, &normal).sqrt()
    }
    /// Centre of a facet, m, and its outward unit normal.
    pub fn facet(&self, facet: usize) -> ([f64; D], [f64; D]) {
        let x = self.facets[facet].map(|n| self.places[n as usize]);
        let centre = std::array::from_fn(|d| x.iter().map(|x| x[d]).sum::<f64>() / D as f64);
        (centre, self.normals[facet])
    }

    /// Set the places of the nodes, m.
    pub fn place(&mut self, places: Vec<[f64; D]>) {
        self.places = places;
        self.shape();
    }

    /// Find normals and boxes.
    fn shape(&mut self) {
        let all: Vec<[[f64; D]; D]> =
            self.facets.iter().map(|f| f.map(|n| self.places[n as usize])).collect();
        self.normals.clear();
        self.normals.extend(all.iter().map(|x| unit(area_normal(x))));
        self.corners.clear();
        self.corners.resize(self.places.len(), [0.0; D]);
        for (f, x) in all.iter().enumerate() {
            for k in 0..D {
                let angle = if D == 2 {
                    1.0
                } else {
                    let [a, b] = [1, 2].map(|by| unit(minus(&x[(k + by) % D], &x[k])));
                    dot(&a, &b).clamp(-1.0, 1.0).acos()
                };
                let sum = &mut self.corners[self.facets[f][k] as usize];
                (0..D).for_each(|d| sum[d] += angle * self.normals[f][d]);
            }
        }
        self.edges.clear();
        if D == 3 {
            let normals = &self.normals;
            self.edges.extend(self.beside.iter().enumerate().map(|(f, beside)| {
                beside.map(|other| std::array::from_fn(|d| normals[f][d] + normals[other][d]))
            }));
        }
        // Children follow their parents.
        for n in (0..self.tree.len()).rev() {
            let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
            let (first, count, second) = (self.tree[n].first, self.tree[n].count, self.tree[n].second);
            let mut hold = |x: &[f64; D]| {
                for d in 0..D {
                    (low[d], high[d]) = (low[d].min(x[d]), high[d].max(x[d]));
                }
            };
            if let Some(second) = second {
                for child in [n + 1, second] {
                    hold(&self.tree[child].low);
                    hold(&self.tree[child].high);
                }
            } else {
                self.order[first..first + count].iter().for_each(|f| all[*f].iter().for_each(&mut hold));
            }
            (self.tree[n].low, self.tree[n].high) = (low, high);
        }
    }

    /// Square of the distance from a point to a box.
    fn to_box(branch: &Branch<D>, x: &[f64; D]) -> f64 {
        (0..D).map(|d| (branch.low[d] - x[d]).max(x[d] - branch.high[d]).max(0.0).powi(2)).sum()
    }

    /// Find the nearest point of the surface.
    pub fn nearest(&self, x: &[f64; D]) -> Nearest<D> {
        let (mut best, mut square) =
            (Nearest { gap: f64::INFINITY, facet: 0, weights: [0.0; D] }, f64::INFINITY);
        let mut away = [0.0; D];
        let mut stack = vec![(0usize, 0.0f64)];
        while let Some((n, least)) = stack.pop() {
            if least >= square {
                continue;
            }
            let Some(branch) = self.tree.get(n) else { break };
            let Some(second) = branch.second else {
                for &f in &self.order[branch.first..branch.first + branch.count] {
                    let corners = self.facets[f].map(|n| self.places[n as usize]);
                    let weights = on_facet(x, &corners);
                    let to: [f64; D] = std::array::from_fn(|d| {
                        x[d] - weights.iter().zip(&corners).map(|(w, c)| w * c[d]).sum::<f64>()
                    });
                    let distance = dot(&to, &to);
                    if distance < square {
                        (square, away) = (distance, to);
                        (best.facet, best.weights) = (f, weights);
                    }
                }
                continue;
            };
            let mut children = [n + 1, second].map(|child| (child, Self::to_box(&self.tree[child], x)));
            if children[0].1 < children[1].1 {
                children.swap(0, 1);
            }
            stack.extend(children);
        }
        let out = dot(&away, &self.normal_at(&best)) >= 0.0;
        best.gap = if out { square.sqrt() } else { -square.sqrt() };
        best
    }

    /// Normal of the facet, edge or corner of a nearest point, of any length.
    fn normal_at(&self, at: &Nearest<D>) -> [f64; D] {
        let on = |k: &usize| at.weights[*k] > ON_EDGE;
        let count = (0..D).filter(on).count();
        match (0..D).find(on) {
            Some(k) if count == 1 => self.corners[self.facets[at.facet][k] as usize],
            _ if count < D && D == 3 => {
                let off = (0..D).find(|k| !on(k)).unwrap_or(0);
                self.edges[at.facet][off]
            }
            _ => self.normals[at.facet],
        }
    }

    /// Distance from a point to the box of the surface, m; zero within.
    pub fn outside_of_box(&self, x: &[f64; D]) -> f64 {
        self.tree.first().map_or(f64::INFINITY, |root| Self::to_box(root, x)).sqrt()
    }

    /// Largest extent of the box of the surface, m.
    pub fn size(&self) -> f64 {
        self.tree.first().map_or(0.0, |root| (0..D).map(|d| root.high[d] - root.low[d]).fold(0.0, f64::max))
    }

    pub fn bytes(&self) -> usize {
        let facet = size_of::<[u32; D]>()
            + size_of::<[f64; D]>()
            + size_of::<[[f64; D]; D]>()
            + size_of::<[usize; D]>();
        self.facets.capacity() * facet
            + self.places.capacity() * 2 * size_of::<[f64; D]>()
            + self.tree.capacity() * size_of::<Branch<D>>()
    }
}

/// Facet beyond each edge of each facet, opposite to its nodes; in the plane none is needed. None unless the surface is closed.
fn neighbours<const D: usize>(facets: &[[u32; D]]) -> Option<Vec<[usize; D]>> {
    let mut sides: Vec<([u32; 2], bool, usize, usize)> = Vec::with_capacity(facets.len() * D);
    for (f, nodes) in facets.iter().enumerate() {
        for k in 0..D {
            // In the plane an edge is a corner: once at the start, once at the end of a segment.
            let (a, b) = if D == 2 { (nodes[k], nodes[k]) } else { (nodes[(k + 1) % D], nodes[(k + 2) % D]) };
            let forth = if D == 2 { k == 0 } else { a < b };
            sides.push(([a.min(b), a.max(b)], forth, f, k));
        }
    }
    sides.sort_unstable();
    let mut beside = vec![[0; D]; facets.len()];
    for same in sides.chunk_by(|a, b| a.0 == b.0) {
        // As many in one sense as in the other: more than two where parts of a body touch in an edge.
        let forth = same.iter().filter(|side| side.1).count();
        if 2 * forth != same.len() {
            return None;
        }
        for (back, forth) in same[..forth].iter().zip(&same[forth..]) {
            beside[back.2][back.3] = forth.2;
            beside[forth.2][forth.3] = back.2;
        }
    }
    Some(beside)
}

/// Add the branch of a part of the facets that begins at `first`: halves by the widest extent of the centres.
fn grow<const D: usize>(
    tree: &mut Vec<Branch<D>>,
    order: &mut [usize],
    first: usize,
    middle: &impl Fn(usize, usize) -> f64,
) {
    let at = tree.len();
    let count = order.len();
    tree.push(Branch { low: [0.0; D], high: [0.0; D], first, count, second: None });
    if count <= LEAF {
        return;
    }
    let extent = |d: usize| {
        let (low, high) = order.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), f| {
            (low.min(middle(*f, d)), high.max(middle(*f, d)))
        });
        high - low
    };
    let axis = (0..D).fold(0, |best, d| if extent(d) > extent(best) { d } else { best });
    order.sort_by(|a, b| middle(*a, axis).total_cmp(&middle(*b, axis)).then(a.cmp(b)));
    let half = count / 2;
    let (low, high) = order.split_at_mut(half);
    grow(tree, low, first, middle);
    tree[at].second = Some(tree.len());
    grow(tree, high, first + half, middle);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Surface of a box of `n` squares an edge.
    fn square(n: u32) -> Skin<2> {
        let h = 1.0 / f64::from(n);
        let mut places = Vec::new();
        for [from, by] in [
            [[0.0, 0.0], [1.0, 0.0]],
            [[1.0, 0.0], [0.0, 1.0]],
            [[1.0, 1.0], [-1.0, 0.0]],
            [[0.0, 1.0], [0.0, -1.0]],
        ] {
            places.extend(
                (0..n).map(|i| [from[0] + by[0] * h * f64::from(i), from[1] + by[1] * h * f64::from(i)]),
            );
        }
        let count = places.len() as u32;
        let facets = (0..count).map(|i| [i, (i + 1) % count]).collect();
        Skin::new(facets, places).unwrap()
    }

    #[test]
    fn distances_to_a_square_are_exact() {
        let skin = square(7);
        assert!((skin.volume() - 1.0).abs() < 1e-14);
        let exact = |x: [f64; 2]| {
            let q = x.map(|x| (x - 0.5).abs() - 0.5);
            let out = q[0].max(0.0).hypot(q[1].max(0.0));
            out + q[0].max(q[1]).min(0.0)
        };
        for n in 0..900 {
            let x = [f64::from(n % 30) * 0.1 - 1.02, f64::from(n / 30) * 0.1 - 0.97];
            let at = skin.nearest(&x);
            assert!((at.gap - exact(x)).abs() < 1e-14, "{x:?}: {} is {}", at.gap, exact(x));
            assert!((at.weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!(skin.outside_of_box(&x) <= at.gap.max(0.0) + 1e-14);
        }
    }

    #[test]
    fn distances_to_a_cube_are_exact() {
        let places: Vec<[f64; 3]> =
            (0..8).map(|n| [f64::from(n & 1), f64::from(n >> 1 & 1), f64::from(n >> 2 & 1)]).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
        let facets = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect::<Vec<_>>();
        let skin = Skin::<3>::new(facets.clone(), places.clone()).unwrap();
        assert!((skin.volume() - 1.0).abs() < 1e-14);
        for n in 0..1000 {
            let x = [n % 10, n / 10 % 10, n / 100].map(|i| f64::from(i) * 0.31 - 0.83);
            let q = x.map(|x| (x - 0.5).abs() - 0.5);
            let out = q.iter().map(|q| q.max(0.0).powi(2)).sum::<f64>().sqrt();
            let exact = out + q[0].max(q[1]).max(q[2]).min(0.0);
            assert!((skin.nearest(&x).gap - exact).abs() < 1e-14, "{x:?}");
        }
        assert!(Skin::<3>::new(facets[1..].to_vec(), places.clone()).is_none(), "an open surface");
        let inside_out = facets.iter().map(|f| [f[0], f[2], f[1]]).collect();
        assert!(Skin::<3>::new(inside_out, places).is_none());
    }
}
