//! Operators through the particles between fields at the nodes: values, gradients and their transposes.

/// Particle of a [`PointOperator`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperatorPoint {
    /// Index of the body.
    pub body: usize,
    /// Number of the particle in its body.
    pub number: usize,
    /// Mass, kg (per metre of depth or radian).
    pub mass: f64,
    /// Volume, m^3 (per metre of depth or radian), of the configuration of the gradients.
    pub volume: f64,
    /// Volume times stress, J: v sigma, or v sigma F^-T in the reference configuration.
    pub stress: [[f64; 3]; 3],
    /// Inverse of the distance from the axis, 1/m; 0 unless axisymmetric.
    pub per_radius: f64,
}

/// Weight of a particle on a node of the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperatorWeight<const D: usize> {
    /// Index of the node in [`TrialNodes::nodes`](crate::TrialNodes::nodes).
    pub node: usize,
    /// Weight N.
    pub value: f64,
    /// Gradient grad N, 1/m; in the reference configuration if the method is total Lagrangian.
    pub gradient: [f64; D],
    /// Factors of vector components: -1 for the normal component if the node stands for its mirror image.
    pub sign: [f64; D],
}

/// Particles of deformable bodies with their weights on the listed nodes, as operators y = B x between node fields and particle fields.
///
/// Node fields have an entry for each node of [`TrialNodes::nodes`](crate::TrialNodes::nodes), particle fields one for each of
/// [`points`](Self::points). Sums are in the order of the particles. A hook whose [`Hook::needs_points`](crate::Hook::needs_points) is true
/// gets it from [`TrialNodes::points`](crate::TrialNodes::points), assembled particle by particle at some ten times the cost of a step.
/// Velocity gradients are 3 x 3: L_cd = dv_c/dx_d, with v_r / r at the hoop place in axisymmetric scenes.
#[derive(Clone, Debug, Default)]
pub struct PointOperator<const D: usize> {
    nodes: usize,
    points: Vec<OperatorPoint>,
    /// First weight of each particle, and the number of all.
    starts: Vec<usize>,
    weights: Vec<OperatorWeight<D>>,
}

impl<const D: usize> PointOperator<D> {
    /// Create without particles, for this number of nodes.
    pub(in crate::step) fn new(nodes: usize) -> Self {
        PointOperator { nodes, starts: vec![0], ..PointOperator::default() }
    }
    /// Append a particle.
    pub(in crate::step) fn push(
        &mut self,
        point: OperatorPoint,
        weights: impl Iterator<Item = OperatorWeight<D>>,
    ) {
        self.points.push(point);
        self.weights.extend(weights);
        self.starts.push(self.weights.len());
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.nodes
    }
    /// Particles.
    pub fn points(&self) -> &[OperatorPoint] {
        &self.points
    }
    /// Weights of particle `p`. A node may occur twice, as itself and as its mirror image.
    ///
    /// # Panics
    /// A `p` outside of the particles.
    pub fn weights(&self, p: usize) -> &[OperatorWeight<D>] {
        &self.weights[self.starts[p]..self.starts[p + 1]]
    }

    /// Velocity of each particle, m/s, by velocities `u` of nodes: sum_i N_ip u_i.
    ///
    /// # Panics
    /// A length of `u` other than the number of nodes.
    pub fn interpolate(&self, u: &[[f64; D]]) -> Vec<[f64; D]> {
        self.check(u);
        let at = |p| {
            let mut v = [0.0; D];
            for w in self.weights(p) {
                (0..D).for_each(|c| v[c] += w.sign[c] * w.value * u[w.node][c]);
            }
            v
        };
        (0..self.points.len()).map(at).collect()
    }
    /// Add vectors `f` of particles to those of nodes, `y`: y_i += sum_p N_ip f_p, the transpose of [`interpolate`](Self::interpolate).
    ///
    /// # Panics
    /// A length of `f` other than the number of particles, of `y` other than that of nodes.
    pub fn spread(&self, f: &[[f64; D]], y: &mut [[f64; D]]) {
        self.check(y);
        assert_eq!(f.len(), self.points.len(), "vectors of particles");
        for (p, f) in f.iter().enumerate() {
            for w in self.weights(p) {
                (0..D).for_each(|c| y[w.node][c] += w.sign[c] * w.value * f[c]);
            }
        }
    }
    /// Velocity gradient at each particle, 1/s, by velocities `u` of nodes, m/s: L = sum_i u_i (grad N_ip)^T.
    ///
    /// # Panics
    /// A length of `u` other than the number of nodes.
    pub fn gradient(&self, u: &[[f64; D]]) -> Vec<[[f64; 3]; 3]> {
        self.check(u);
        (0..self.points.len()).map(|p| self.gradient_at(p, u)).collect()
    }
    /// Divergence of the velocity at each particle, 1/s.
    ///
    /// # Panics
    /// A length of `u` other than the number of nodes.
    pub fn divergence(&self, u: &[[f64; D]]) -> Vec<f64> {
        self.check(u);
        let trace = |p| {
            let l = self.gradient_at(p, u);
            l[0][0] + l[1][1] + l[2][2]
        };
        (0..self.points.len()).map(trace).collect()
    }
    /// Add forces of stresses `s` of particles (volume times stress, J) to those of nodes, `y`, N: y_i += sum_p s_p grad N_ip, the transpose
    /// of [`gradient`](Self::gradient). The internal force is the negative of it.
    ///
    /// # Panics
    /// A length of `s` other than the number of particles, of `y` other than that of nodes.
    pub fn transposed_gradient(&self, s: &[[[f64; 3]; 3]], y: &mut [[f64; D]]) {
        self.check(y);
        assert_eq!(s.len(), self.points.len(), "stresses of particles");
        s.iter().enumerate().for_each(|(p, s)| self.add_force(p, s, y));
    }
    /// Add K u to `y`, with K = sum_p B_p^T C_p B_p: `law(p, L)` returns volume times stress for the velocity gradient of particle `p`, J.
    ///
    /// # Panics
    /// A length of `u` or `y` other than the number of nodes.
    pub fn stiffness(
        &self,
        law: impl Fn(usize, &[[f64; 3]; 3]) -> [[f64; 3]; 3],
        u: &[[f64; D]],
        y: &mut [[f64; D]],
    ) {
        self.check(u);
        self.check(y);
        for p in 0..self.points.len() {
            self.add_force(p, &law(p, &self.gradient_at(p, u)), y);
        }
    }
    /// Diagonal of the matrix of [`stiffness`](Self::stiffness) with a linear law, without products between a node and its own image.
    pub fn diagonal(&self, law: impl Fn(usize, &[[f64; 3]; 3]) -> [[f64; 3]; 3]) -> Vec<[f64; D]> {
        let mut diagonal = vec![[0.0; D]; self.nodes];
        for p in 0..self.points.len() {
            for w in self.weights(p) {
                for c in 0..D {
                    let (mut unit, mut l) = ([0.0; D], [[0.0; 3]; 3]);
                    unit[c] = 1.0;
                    self.add_gradient(p, w, &unit, &mut l);
                    diagonal[w.node][c] += self.force(p, w, &law(p, &l))[c];
                }
            }
        }
        diagonal
    }
    /// Mass of each node without that of its images, kg: sum_p N_ip m_p.
    pub fn mass(&self) -> Vec<f64> {
        let mut mass = vec![0.0; self.nodes];
        for (p, point) in self.points.iter().enumerate() {
            self.weights(p).iter().for_each(|w| mass[w.node] += w.value * point.mass);
        }
        mass
    }

    fn check(&self, u: &[[f64; D]]) {
        assert_eq!(u.len(), self.nodes, "vectors of nodes");
    }
    fn gradient_at(&self, p: usize, u: &[[f64; D]]) -> [[f64; 3]; 3] {
        let mut l = [[0.0; 3]; 3];
        for w in self.weights(p) {
            self.add_gradient(p, w, &u[w.node], &mut l);
        }
        l
    }
    fn add_gradient(&self, p: usize, w: &OperatorWeight<D>, u: &[f64; D], l: &mut [[f64; 3]; 3]) {
        for c in 0..D {
            for d in 0..D {
                l[c][d] += w.sign[c] * u[c] * w.gradient[d];
            }
        }
        l[2][2] += self.points[p].per_radius * w.sign[0] * w.value * u[0];
    }
    fn add_force(&self, p: usize, s: &[[f64; 3]; 3], y: &mut [[f64; D]]) {
        for w in self.weights(p) {
            let force = self.force(p, w, s);
            (0..D).for_each(|c| y[w.node][c] += force[c]);
        }
    }
    fn force(&self, p: usize, w: &OperatorWeight<D>, s: &[[f64; 3]; 3]) -> [f64; D] {
        let mut force: [f64; D] =
            std::array::from_fn(|c| w.sign[c] * (0..D).map(|d| s[c][d] * w.gradient[d]).sum::<f64>());
        force[0] += self.points[p].per_radius * w.sign[0] * w.value * s[2][2];
        force
    }
}
