//! Rotations and rigid motion.

/// Matrix of three rows.
pub(crate) type Matrix = [[f64; 3]; 3];

pub(crate) const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Cross product.
pub(crate) fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Scalar product.
pub(crate) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

pub(crate) fn transposed(a: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// Matrix times vector.
pub(crate) fn apply(a: &Matrix, x: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| dot(&a[i], x))
}

/// Inverse of a symmetric positive definite matrix.
pub(crate) fn inverse(a: &Matrix) -> Matrix {
    let rows = [cross(&a[1], &a[2]), cross(&a[2], &a[0]), cross(&a[0], &a[1])];
    let determinant = dot(&a[0], &rows[0]);
    transposed(&rows.map(|row| row.map(|x| x / determinant)))
}

/// Rotation by a vector: about its direction, by its length, rad (Rodrigues' formula).
pub(crate) fn rotation(by: &[f64; 3]) -> Matrix {
    let angle = dot(by, by).sqrt();
    if angle == 0.0 {
        return IDENTITY;
    }
    let axis = by.map(|x| x / angle);
    let (sin, cos) = angle.sin_cos();
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let mut unit = [0.0; 3];
            unit[j] = 1.0;
            cos * unit[i] + sin * cross(&axis, &unit)[i] + (1.0 - cos) * axis[i] * axis[j]
        })
    })
}

/// Place and orientation of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose<const D: usize> {
    /// Displacement, m.
    pub by: [f64; D],
    /// Point of the undisplaced shape about which it turned, m, and the rotation; none without.
    pub turn: Option<([f64; D], Matrix)>,
}

impl<const D: usize> Pose<D> {
    /// Place of a point in the frame of the shape.
    #[inline]
    pub fn back(&self, x: &[f64; D]) -> [f64; D] {
        let mut y: [f64; D] = std::array::from_fn(|d| x[d] - self.by[d]);
        if let Some((about, matrix)) = &self.turn {
            let from: [f64; D] = std::array::from_fn(|d| y[d] - about[d]);
            y = std::array::from_fn(|d| about[d] + (0..D).map(|e| matrix[e][d] * from[e]).sum::<f64>());
        }
        y
    }
    /// Place of a point of the shape.
    pub fn there(&self, x: &[f64; D]) -> [f64; D] {
        match &self.turn {
            None => std::array::from_fn(|d| x[d] + self.by[d]),
            Some((about, matrix)) => std::array::from_fn(|d| {
                about[d] + self.by[d] + (0..D).map(|e| matrix[d][e] * (x[e] - about[e])).sum::<f64>()
            }),
        }
    }
}

/// Rigid motion: velocity of a point, m/s, and angular velocity, rad/s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<const D: usize> {
    pub velocity: [f64; D],
    pub spin: [f64; 3],
    /// Point with this velocity, m.
    pub about: [f64; D],
}

impl<const D: usize> Motion<D> {
    /// Component of the velocity at a point, m/s.
    #[inline]
    pub fn component(&self, x: &[f64; D], d: usize) -> f64 {
        if self.spin == [0.0; 3] {
            return self.velocity[d];
        }
        let mut arm = [0.0; 3];
        (0..D).for_each(|e| arm[e] = x[e] - self.about[e]);
        self.velocity[d] + cross(&self.spin, &arm)[d]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_turn_there_and_back() {
        let matrix = rotation(&[0.3, -1.1, 0.7]);
        let one = times(&matrix, &transposed(&matrix));
        let pose = Pose { by: [0.1, 0.2, -0.3], turn: Some(([1.0, 2.0, 3.0], matrix)) };
        let x = [0.4, -0.2, 5.0];
        let y = pose.back(&pose.there(&x));
        for i in 0..3 {
            assert!((x[i] - y[i]).abs() < 1e-14);
            (0..3).for_each(|j| assert!((one[i][j] - IDENTITY[i][j]).abs() < 1e-15));
        }
        // A quarter turn about z takes x to y.
        let quarter = rotation(&[0.0, 0.0, std::f64::consts::FRAC_PI_2]);
        assert!((apply(&quarter, &[1.0, 0.0, 0.0])[1] - 1.0).abs() < 1e-15);
        let a = [[2.0, 0.5, 0.1], [0.5, 3.0, -0.2], [0.1, -0.2, 1.0]];
        let one = times(&a, &inverse(&a));
        (0..9).for_each(|n| assert!((one[n / 3][n % 3] - IDENTITY[n / 3][n % 3]).abs() < 1e-15));
    }
}
