//! Bodies that own their data, and meshes of simple shapes.

use impactite_geometry::Facet;
use impactite_simd::Team;
use mpm_contact::mesh::{ContactBody, MeshContact, MeshStep};

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body<const D: usize> {
    pub x: Vec<[f64; D]>,
    pub v: Vec<[f64; D]>,
    pub m: Vec<f64>,
    pub half: Vec<f64>,
    pub facets: Vec<Facet>,
}

pub fn facet(nodes: &[u32]) -> Facet {
    let mut all = [Facet::NONE; 4];
    all[..nodes.len()].copy_from_slice(nodes);
    Facet { nodes: all, block: 0, element: 0 }
}

impl<const D: usize> Body<D> {
    pub fn points(x: Vec<[f64; D]>, mass: f64, half: f64) -> Self {
        let n = x.len();
        Body { x, v: vec![[0.0; D]; n], m: vec![mass; n], half: vec![half; n], facets: Vec::new() }
    }
    pub fn mesh(x: Vec<[f64; D]>, mass: f64, facets: Vec<Facet>) -> Self {
        let n = x.len();
        Body { x, v: vec![[0.0; D]; n], m: vec![mass; n], half: Vec::new(), facets }
    }
    pub fn moving(mut self, v: [f64; D]) -> Self {
        self.v.fill(v);
        self
    }
    pub fn view(&self) -> ContactBody<'_, D> {
        let Body { x, v, m, half, facets } = self;
        match (facets.is_empty(), half.is_empty()) {
            (true, _) => ContactBody::of_points("points", x, v, m, half),
            (false, true) => ContactBody::of_mesh("mesh", x, v, m, facets),
            (false, false) => ContactBody::of_mesh("mesh", x, v, m, facets).with_half_sizes(half),
        }
    }
    pub fn kinetic(&self) -> f64 {
        let each = self.v.iter().zip(&self.m).filter(|(_, m)| m.is_finite());
        each.map(|(v, m)| 0.5 * m * v.iter().map(|c| c * c).sum::<f64>()).sum()
    }
    pub fn momentum(&self) -> [f64; D] {
        let each = self.v.iter().zip(&self.m).filter(|(_, m)| m.is_finite());
        each.fold([0.0; D], |p, (v, m)| std::array::from_fn(|d| p[d] + m * v[d]))
    }
    /// Angular momentum about the origin.
    pub fn angular(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for ((x, v), m) in self.x.iter().zip(&self.v).zip(&self.m).filter(|(_, m)| m.is_finite()) {
            let (mut r, mut w) = ([0.0; 3], [0.0; 3]);
            r[..D].copy_from_slice(x);
            w[..D].copy_from_slice(v);
            for d in 0..3 {
                let (e, f) = ((d + 1) % 3, (d + 2) % 3);
                sum[d] += m * (r[e] * w[f] - r[f] * w[e]);
            }
        }
        sum
    }
}

/// Apply the impulses of a step to velocities; positions stay.
pub fn collide<const D: usize>(
    contact: &mut MeshContact<D>,
    bodies: &mut [Body<D>],
    dt: f64,
    team: &Team,
) -> MeshStep {
    let views: Vec<_> = bodies.iter().map(Body::view).collect();
    let step = contact.step(&views, 0.0, dt, team).expect("a step");
    for (n, body) in bodies.iter_mut().enumerate() {
        for push in contact.impulses(n) {
            let i = push.point as usize;
            for d in 0..D {
                body.v[i][d] += push.impulse[d] / body.m[i];
            }
        }
    }
    step
}

/// Make a whole step.
pub fn advance<const D: usize>(contact: &mut MeshContact<D>, bodies: &mut [Body<D>], dt: f64) -> MeshStep {
    let step = collide(contact, bodies, dt, &Team::one());
    for body in bodies {
        for (x, v) in body.x.iter_mut().zip(&body.v) {
            for d in 0..D {
                x[d] += v[d] * dt;
            }
        }
    }
    step
}

/// Pseudorandom numbers in -1..1.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (self.0 ^ (self.0 >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
        (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
    pub fn vector<const D: usize>(&mut self) -> [f64; D] {
        std::array::from_fn(|_| self.next())
    }
}

/// Outline of a box of `counts` edges, counter-clockwise.
pub fn outline(low: [f64; 2], high: [f64; 2], counts: [usize; 2]) -> Body<2> {
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
    let mut x = Vec::new();
    for side in 0..4 {
        let (a, b, n) = (corners[side], corners[(side + 1) % 4], counts[side % 2]);
        for i in 0..n {
            let s = i as f64 / n as f64;
            x.push([0, 1].map(|d| a[d] + s * (b[d] - a[d])));
        }
    }
    let n = x.len() as u32;
    Body::mesh(x, 1.0, (0..n).map(|i| facet(&[i, (i + 1) % n])).collect())
}

/// Sheet of quadrilaterals in the plane z = 0, from -half to half, outside above; or of two triangles each.
pub fn sheet(half: f64, counts: usize, triangles: bool) -> Body<3> {
    let edge = 2.0 * half / counts as f64;
    let mut x = Vec::new();
    for j in 0..=counts {
        for i in 0..=counts {
            x.push([-half + edge * i as f64, -half + edge * j as f64, 0.0]);
        }
    }
    let mut facets = Vec::new();
    for j in 0..counts {
        for i in 0..counts {
            let a = (j * (counts + 1) + i) as u32;
            let [b, c, d] = [a + 1, a + counts as u32 + 2, a + counts as u32 + 1];
            if triangles {
                facets.extend([facet(&[a, b, c]), facet(&[a, c, d])]);
            } else {
                facets.push(facet(&[a, b, c, d]));
            }
        }
    }
    Body::mesh(x, 1.0, facets)
}

/// Surface of a box of `counts` quadrilaterals along each axis.
pub fn brick(low: [f64; 3], high: [f64; 3], counts: [usize; 3]) -> Body<3> {
    use std::collections::BTreeMap;
    let mut numbers: BTreeMap<[usize; 3], u32> = BTreeMap::new();
    let mut x = Vec::new();
    let mut node = |at: [usize; 3]| {
        *numbers.entry(at).or_insert_with(|| {
            x.push(std::array::from_fn(|d| low[d] + (high[d] - low[d]) * at[d] as f64 / counts[d] as f64));
            x.len() as u32 - 1
        })
    };
    let mut facets = Vec::new();
    for axis in 0..3 {
        let (e, f) = ((axis + 1) % 3, (axis + 2) % 3);
        for (end, turn) in [(0, true), (counts[axis], false)] {
            for i in 0..counts[e] {
                for j in 0..counts[f] {
                    let mut nodes = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[a, b]| {
                        let mut at = [0; 3];
                        (at[axis], at[e], at[f]) = (end, i + a, j + b);
                        node(at)
                    });
                    if turn {
                        nodes.reverse();
                    }
                    facets.push(facet(&nodes));
                }
            }
        }
    }
    Body::mesh(x, 1.0, facets)
}

pub fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}
