//! Distortion of elements, and division into particles.

use fem::ElementBody;
use impactite_geometry::ElementKind;
use nalgebra::Matrix3;

/// Maximum number of nodes of an element.
pub(crate) const NODES: usize = 8;

/// Columns dx/dxi of the Jacobian.
pub(crate) fn columns<const D: usize>(slopes: &[[f64; 3]], at: impl Fn(usize) -> [f64; D]) -> [[f64; D]; 3] {
    let mut columns = [[0.0; D]; 3];
    for (n, slope) in slopes.iter().enumerate() {
        let x = at(n);
        for (column, s) in columns.iter_mut().zip(slope) {
            (0..D).for_each(|d| column[d] += s * x[d]);
        }
    }
    columns
}

/// Jacobian matrix; in the plane with one along the third axis.
pub(crate) fn matrix<const D: usize>(columns: &[[f64; D]; 3]) -> Matrix3<f64> {
    let mut matrix = Matrix3::identity();
    for c in 0..D {
        (0..D).for_each(|d| matrix[(d, c)] = columns[c][d]);
    }
    matrix
}

/// Determinant of the Jacobian.
pub(crate) fn determinant<const D: usize>(columns: &[[f64; D]; 3]) -> f64 {
    matrix(columns).determinant()
}

/// Shape measures of an element: edge ratio (shortest over longest), and Jacobian at each corner (one for a simplex).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Form {
    pub aspect: f64,
    pub jacobians: [f64; NODES],
    corners: usize,
}

impl Form {
    #[inline]
    pub fn of<const D: usize>(kind: ElementKind, at: &[[f64; D]; NODES]) -> Self {
        let between = |a: usize, b: usize| -> [f64; D] { std::array::from_fn(|d| at[b][d] - at[a][d]) };
        let (mut least, mut most) = (f64::INFINITY, 0.0f64);
        for &[a, b] in kind.edges() {
            let square: f64 = between(a, b).iter().map(|x| x * x).sum();
            (least, most) = (least.min(square), most.max(square));
        }
        let corners = if kind.is_simplex() { 1 } else { kind.nodes() };
        let mut jacobians = [0.0; NODES];
        for (c, jacobian) in jacobians[..corners].iter_mut().enumerate() {
            *jacobian = determinant(&beside(kind, c).map(|n| between(c, n)));
        }
        Form { aspect: (least / most).sqrt(), jacobians, corners }
    }

    /// Smallest ratio of a corner Jacobian to that of the same corner at rest.
    pub fn least_jacobian(&self, rest: &Form) -> f64 {
        let pairs = self.jacobians[..self.corners].iter().zip(&rest.jacobians);
        pairs.map(|(now, rest)| now / rest).fold(f64::INFINITY, f64::min)
    }
}

/// Nodes along the edges from a corner, in the order of a right-handed frame or its mirror image.
#[inline]
fn beside(kind: ElementKind, c: usize) -> [usize; 3] {
    match kind {
        ElementKind::Quad4 => [(c + 1) % 4, (c + 3) % 4, 0],
        ElementKind::Hexa8 => [c / 4 * 4 + (c + 1) % 4, c / 4 * 4 + (c + 3) % 4, (c + 4) % 8],
        ElementKind::Triangle3 => [1, 2, 0],
        _ => [1, 2, 3],
    }
}

/// Bounding box of nodes: lower and upper corner, m.
pub(crate) fn box_around<const D: usize>(body: &ElementBody<D>, nodes: &[u32]) -> ([f64; D], [f64; D]) {
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for &n in nodes {
        let x = &body.nodes()[n as usize].position;
        for d in 0..D {
            (low[d], high[d]) = (low[d].min(x[d]), high[d].max(x[d]));
        }
    }
    (low, high)
}

/// Gather the node positions of an element.
#[inline]
pub(crate) fn gathered<const D: usize>(nodes: &[u32], at: impl Fn(u32) -> [f64; D]) -> [[f64; D]; NODES] {
    let mut list = [[0.0; D]; NODES];
    list.iter_mut().zip(nodes).for_each(|(to, &n)| *to = at(n));
    list
}

/// Divide an element into particles: positions in xi, with parts of the volume in xi and half edges in xi. `counts` are the numbers along
/// each axis; simplices are halved as often as the largest of them requires.
pub(crate) fn divided(kind: ElementKind, counts: [u32; 3]) -> Vec<([f64; 3], f64, [f64; 3])> {
    let dim = kind.dimensions();
    if kind.is_simplex() {
        let most = counts[..dim].iter().copied().max().unwrap_or(1);
        let levels = most.next_power_of_two().ilog2();
        let corners: Vec<[f64; 3]> =
            (0..=dim).map(|n| std::array::from_fn(|d| if d + 1 == n { 1.0 } else { 0.0 })).collect();
        let mut parts = vec![corners];
        for _ in 0..levels {
            parts = parts.iter().flat_map(|part| halved(part)).collect();
        }
        let share = 1.0 / parts.len() as f64;
        let half = 0.5 * share.powf(1.0 / dim as f64);
        let middle = |part: &Vec<[f64; 3]>| -> [f64; 3] {
            std::array::from_fn(|d| part.iter().map(|x| x[d]).sum::<f64>() / part.len() as f64)
        };
        return parts.iter().map(|part| (middle(part), share, [half; 3])).collect();
    }
    let counts: [u32; 3] = std::array::from_fn(|d| if d < dim { counts[d].max(1) } else { 1 });
    let half: [f64; 3] = std::array::from_fn(|d| 1.0 / f64::from(counts[d]));
    let all: u32 = counts.iter().product();
    let place = |n: u32| -> [f64; 3] {
        let at = [n % counts[0], n / counts[0] % counts[1], n / (counts[0] * counts[1])];
        std::array::from_fn(|d| if d < dim { (2 * at[d] + 1) as f64 * half[d] - 1.0 } else { 0.0 })
    };
    (0..all).map(|n| (place(n), 1.0 / f64::from(all), half)).collect()
}

/// Split a triangle into four, or a tetrahedron into eight parts of equal size.
fn halved(corners: &[[f64; 3]]) -> Vec<Vec<[f64; 3]>> {
    let between =
        |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|d| 0.5 * (corners[a][d] + corners[b][d])) };
    if corners.len() == 3 {
        let (ab, bc, ca) = (between(0, 1), between(1, 2), between(2, 0));
        return vec![
            vec![corners[0], ab, ca],
            vec![corners[1], bc, ab],
            vec![corners[2], ca, bc],
            vec![ab, bc, ca],
        ];
    }
    let [ab, ac, ad] = [between(0, 1), between(0, 2), between(0, 3)];
    let [bc, bd, cd] = [between(1, 2), between(1, 3), between(2, 3)];
    // Four at the corners, and four around the diagonal ac-bd of the inner octahedron.
    vec![
        vec![corners[0], ab, ac, ad],
        vec![ab, corners[1], bc, bd],
        vec![ac, bc, corners[2], cd],
        vec![ad, bd, cd, corners[3]],
        vec![ac, bd, ab, ad],
        vec![ac, bd, ad, cd],
        vec![ac, bd, cd, bc],
        vec![ac, bd, bc, ab],
    ]
}

/// Position in xi of an integration point out of `points`.
pub(crate) fn integration_point(kind: ElementKind, point: usize, points: usize) -> [f64; 3] {
    let dim = kind.dimensions();
    if kind.is_simplex() {
        return [1.0 / (dim as f64 + 1.0); 3];
    }
    if points == 1 {
        return [0.0; 3];
    }
    let gauss = 1.0 / 3f64.sqrt();
    std::array::from_fn(|d| match (d < dim, point >> d & 1) {
        (false, _) => 0.0,
        (true, 1) => gauss,
        (true, _) => -gauss,
    })
}
