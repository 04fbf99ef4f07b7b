//! Plain reference implementation: shape functions in their usual form, Gauss points, a loop over elements, one point of the law at a time.
//! Never optimised.

use std::marker::PhantomData;

use fem::{Fem, Hourglass, MeshBody, Technology};
use impactite_geometry::ElementKind::{self, Hexa8, Quad4, Tetra4, Triangle3};
use impactite_geometry::ElementMesh;
use impactite_scene::{Axisymmetric, Embedding, FullSpace, PlaneStrain, TimeControl};
use mpm_materials::{Constitutive, Kinematics, Mat3, with_volume};
use nalgebra::Matrix3;

use crate::common::{Flowing, distorted, flowing, mesh};

const G: f64 = 0.577_350_269_189_625_8;
const KAPPA: f64 = 0.05;

/// Corners of a quadrilateral or brick on the square or cube of edge 2.
fn corner(c: usize) -> [f64; 3] {
    [[-1.0, 1.0, 1.0, -1.0][c % 4], [-1.0, -1.0, 1.0, 1.0][c % 4], if c < 4 { -1.0 } else { 1.0 }]
}

/// Integration point: gradients of the shape functions, their contributions to u_r / r, and the volume.
#[derive(Clone)]
struct Point<const D: usize> {
    slopes: Vec<[f64; D]>,
    hoops: Vec<f64>,
    volume: f64,
}

/// Points of full integration of an element with these corners.
fn gauss<const D: usize>(x: &[[f64; D]], hoop: bool) -> Vec<Point<D>> {
    let n = x.len();
    if n == D + 1 {
        return vec![at(x, hoop, [1.0 / 3.0; 3], if D == 2 { 0.5 } else { 1.0 / 6.0 })];
    }
    let places = (0..1usize << D).map(|p| std::array::from_fn(|d| if p >> d & 1 == 1 { G } else { -G }));
    places.map(|xi| at(x, hoop, xi, 1.0)).collect()
}

/// Integration point at xi with the weight.
fn at<const D: usize>(x: &[[f64; D]], hoop: bool, xi: [f64; 3], weight: f64) -> Point<D> {
    let n = x.len();
    let (mut shape, mut local) = (vec![0.0; n], vec![[0.0; 3]; n]);
    for c in 0..n {
        if n == D + 1 {
            shape[c] = 1.0 / n as f64;
            for d in 0..D {
                local[c][d] = if c == 0 { -1.0 } else { f64::from(u8::from(c == d + 1)) };
            }
        } else {
            let factor = |d: usize| 0.5 * (1.0 + corner(c)[d] * xi[d]);
            shape[c] = (0..D).map(factor).product();
            for d in 0..D {
                local[c][d] = 0.5 * corner(c)[d] * (0..D).filter(|e| *e != d).map(factor).product::<f64>();
            }
        }
    }
    let mut jacobian = Matrix3::<f64>::identity();
    for i in 0..D {
        for j in 0..D {
            jacobian[(i, j)] = (0..n).map(|c| x[c][i] * local[c][j]).sum();
        }
    }
    let inverse = jacobian.try_inverse().unwrap();
    let slopes =
        local.iter().map(|l| std::array::from_fn(|j| (0..D).map(|k| l[k] * inverse[(k, j)]).sum())).collect();
    let radius: f64 = (0..n).map(|c| shape[c] * x[c][0]).sum();
    let hoops = shape.iter().map(|s| if hoop { s / radius } else { 0.0 }).collect();
    Point { slopes, hoops, volume: weight * jacobian.determinant() * if hoop { radius } else { 1.0 } }
}

/// Mean gradient over the element, as one point.
fn mean<const D: usize>(points: &[Point<D>]) -> Vec<Point<D>> {
    let volume: f64 = points.iter().map(|p| p.volume).sum();
    let n = points[0].hoops.len();
    let over = |of: &dyn Fn(&Point<D>) -> f64| points.iter().map(|p| p.volume * of(p)).sum::<f64>() / volume;
    let slopes = (0..n).map(|c| std::array::from_fn(|d| over(&|p| p.slopes[c][d]))).collect();
    let hoops = (0..n).map(|c| over(&|p| p.hoops[c])).collect();
    vec![Point { slopes, hoops, volume }]
}

/// gamma of the hourglass modes at the corners, original formulation of Flanagan and Belytschko.
fn gammas<const D: usize>(x: &[[f64; D]], point: &Point<D>) -> Vec<Vec<f64>> {
    let n = x.len();
    let products: &[&[usize]] = if D == 2 { &[&[0, 1]] } else { &[&[1, 2], &[2, 0], &[0, 1], &[0, 1, 2]] };
    let mode = |axes: &&[usize]| -> Vec<f64> {
        let h: Vec<f64> = (0..n).map(|c| axes.iter().map(|&d| corner(c)[d]).product()).collect();
        let along: [f64; D] = std::array::from_fn(|j| (0..n).map(|c| h[c] * x[c][j]).sum());
        let less = |c: usize| (0..D).map(|j| along[j] * point.slopes[c][j]).sum::<f64>();
        (0..n).map(|c| (h[c] - less(c)) / n as f64).collect()
    };
    products.iter().map(mode).collect()
}

type State = <Flowing as Constitutive<f64>>::State<f64>;

struct Plain<const D: usize, E> {
    law: Flowing,
    technology: Technology,
    mesh: ElementMesh<D>,
    x: Vec<[f64; D]>,
    v: Vec<[f64; D]>,
    mass: Vec<f64>,
    force: Vec<[f64; D]>,
    /// Reference volumes, states and hourglass forces of the elements.
    volumes: Vec<Vec<f64>>,
    states: Vec<Vec<State>>,
    held: Vec<Vec<[f64; D]>>,
    sizes: Vec<f64>,
    last: f64,
    space: PhantomData<E>,
}

impl<const D: usize, E: Embedding<D>> Plain<D, E> {
    fn new(
        law: Flowing,
        technology: Technology,
        mesh: ElementMesh<D>,
        velocity: impl Fn([f64; D]) -> [f64; D],
    ) -> Self {
        let (x, n) = (mesh.nodes.clone(), mesh.nodes.len());
        let mut plain = Plain {
            law,
            technology,
            v: x.iter().map(|x| velocity(*x)).collect(),
            mass: vec![0.0; n],
            force: vec![[0.0; D]; n],
            volumes: Vec::new(),
            states: Vec::new(),
            held: Vec::new(),
            sizes: Vec::new(),
            last: 0.0,
            space: PhantomData,
            x,
            mesh,
        };
        for nodes in plain.mesh.blocks[0].elements() {
            let corners: Vec<_> = nodes.iter().map(|&n| plain.x[n as usize]).collect();
            let points = gauss(&corners, E::HOOP);
            let density = plain.law.density();
            if nodes.len() == D + 1 {
                let mean: f64 = corners.iter().map(|x| x[0]).sum::<f64>() / nodes.len() as f64;
                for (&n, x) in nodes.iter().zip(&corners) {
                    let part =
                        if E::HOOP { (x[0] + 3.0 * mean) / (12.0 * mean) } else { 1.0 / nodes.len() as f64 };
                    plain.mass[n as usize] += density * points[0].volume * part;
                }
            } else {
                for (p, point) in points.iter().enumerate() {
                    for (c, &n) in nodes.iter().enumerate() {
                        let xi = |d: usize| if p >> d & 1 == 1 { G } else { -G };
                        let shape: f64 = (0..D).map(|d| 0.5 * (1.0 + corner(c)[d] * xi(d))).product();
                        plain.mass[n as usize] += density * point.volume * shape;
                    }
                }
            }
            let flat: f64 = gauss(&corners, false).iter().map(|p| p.volume).sum();
            let times = if nodes.len() == D + 1 { [2.0, 6.0][D - 2] } else { 1.0 };
            plain.sizes.push((flat * times).powf(1.0 / D as f64));
            let points = plain.points(&corners);
            plain.volumes.push(points.iter().map(|p| p.volume).collect());
            plain.states.push(vec![plain.law.virgin(); points.len()]);
            plain.held.push(vec![[0.0; D]; if D == 2 { 1 } else { 4 }]);
        }
        plain
    }

    fn points(&self, corners: &[[f64; D]]) -> Vec<Point<D>> {
        let points = gauss(corners, E::HOOP);
        if matches!(self.technology, Technology::OnePoint(_)) { mean(&points) } else { points }
    }

    fn corners(&self, nodes: &[u32], back: f64) -> Vec<[f64; D]> {
        let place = |&n: &u32| std::array::from_fn(|d| self.x[n as usize][d] - back * self.v[n as usize][d]);
        nodes.iter().map(place).collect()
    }

    fn step(&mut self, dt: f64) {
        let kick = 0.5 * (self.last + dt);
        for n in 0..self.x.len() {
            for d in 0..D {
                self.v[n][d] += kick * self.force[n][d] / self.mass[n];
                self.x[n][d] += dt * self.v[n][d];
            }
        }
        self.last = dt;
        self.force.fill([0.0; D]);
        let list: Vec<Vec<u32>> = self.mesh.blocks[0].elements().map(<[u32]>::to_vec).collect();
        let averaged = self.technology == Technology::AveragedVolumes;
        let rates = averaged.then(|| {
            let change = |nodes: &Vec<u32>| {
                let volume = |back| gauss(&self.corners(nodes, back), E::HOOP)[0].volume;
                2.0 * (volume(0.0) - volume(dt)) / (volume(0.0) + volume(dt))
            };
            self.averaged(&list, &list.iter().map(change).collect::<Vec<_>>())
        });
        let mut stresses = Vec::new();
        for (e, nodes) in list.iter().enumerate() {
            stresses.push(self.strain(e, nodes, dt, rates.as_ref().map(|r| r[e])));
        }
        let pressures = averaged.then(|| {
            let mean = |e: usize| stresses[e][0].trace() / 3.0 * self.states[e][0].volume_ratio;
            self.averaged(&list, &(0..list.len()).map(mean).collect::<Vec<_>>())
        });
        for (e, nodes) in list.iter().enumerate() {
            self.pull(e, nodes, &stresses[e], pressures.as_ref().map(|p| p[e]));
        }
    }

    /// Average element values at the nodes, weighted by mass, and then over the nodes of each element.
    fn averaged(&self, list: &[Vec<u32>], of: &[f64]) -> Vec<f64> {
        let (mut sum, mut weight) = (vec![0.0; self.x.len()], vec![0.0; self.x.len()]);
        for (e, nodes) in list.iter().enumerate() {
            for &n in nodes {
                sum[n as usize] += self.volumes[e][0] * of[e];
                weight[n as usize] += self.volumes[e][0];
            }
        }
        let mean = |nodes: &Vec<u32>| {
            nodes.iter().map(|&n| sum[n as usize] / weight[n as usize]).sum::<f64>() / nodes.len() as f64
        };
        list.iter().map(mean).collect()
    }

    /// Update the stresses of an element over a step.
    fn strain(&mut self, e: usize, nodes: &[u32], dt: f64, rate: Option<f64>) -> Vec<Matrix3<f64>> {
        let middle = self.corners(nodes, 0.5 * dt);
        let points = self.points(&middle);
        let u: Vec<[f64; D]> = nodes.iter().map(|&n| self.v[n as usize].map(|v| v * dt)).collect();
        let mut gradients: Vec<Matrix3<f64>> = points
            .iter()
            .map(|p| {
                let mut a = Matrix3::zeros();
                for (c, u) in u.iter().enumerate() {
                    for i in 0..D {
                        for j in 0..D {
                            a[(i, j)] += u[i] * p.slopes[c][j];
                        }
                    }
                    a[(2, 2)] += p.hoops[c] * u[0];
                }
                a
            })
            .collect();
        if let Technology::OnePoint(_) = self.technology {
            self.hold(e, &middle, &points[0], &gradients[0], &u, dt);
        }
        if self.technology == Technology::MeanDilatation {
            let volume: f64 = points.iter().map(|p| p.volume).sum();
            let mean = points.iter().zip(&gradients).map(|(p, a)| p.volume * a.trace()).sum::<f64>() / volume;
            for a in &mut gradients {
                *a += Matrix3::identity() * ((mean - a.trace()) / 3.0);
            }
        }
        let mut stresses = Vec::new();
        for (p, a) in gradients.iter().enumerate() {
            let x = a * (Matrix3::identity() - a * 0.5).try_inverse().unwrap();
            let mut increment = Mat3(std::array::from_fn(|i| std::array::from_fn(|j| x[(i, j)])));
            if let Some(rate) = rate {
                increment = with_volume(&increment, (1.0 + 0.5 * rate) / (1.0 - 0.5 * rate));
            }
            let new =
                self.law.update(&Kinematics { increment, dt, length: self.sizes[e] }, &self.states[e][p]);
            assert!(!new.fault.any());
            self.states[e][p] = new.state;
            stresses.push(Matrix3::from_fn(|i, j| new.stress.at(i, j)));
        }
        stresses
    }

    /// Hourglass control.
    fn hold(
        &mut self,
        e: usize,
        x: &[[f64; D]],
        point: &Point<D>,
        a: &Matrix3<f64>,
        u: &[[f64; D]],
        dt: f64,
    ) {
        let shear = mpm_materials::Moduli::young_poisson(117e9, 0.35).unwrap().shear;
        let square: f64 = point.slopes.iter().flatten().map(|b| b * b).sum();
        // kappa G V sum B^2 times the number of corners, since gamma has the length of one over its root.
        let mut stiffness = KAPPA * shear * point.volume * square * x.len() as f64;
        let mut keep = 1.0;
        if let Technology::OnePoint(Hourglass::Viscous(kappa)) = self.technology {
            let moduli = mpm_materials::Moduli::young_poisson(117e9, 0.35).unwrap();
            let speed = (moduli.p_wave() / self.law.density()).sqrt();
            let mass = self.law.density() * self.volumes[e][0];
            (stiffness, keep) = (kappa * mass * speed * square.sqrt() / dt, 0.0);
        }
        let w = (a - a.transpose()) * 0.5;
        let turn = (Matrix3::identity() - w * 0.5).try_inverse().unwrap() * (Matrix3::identity() + w * 0.5);
        for (gamma, held) in gammas(x, point).iter().zip(&mut self.held[e]) {
            let old = *held;
            for i in 0..D {
                let q: f64 = gamma.iter().zip(u).map(|(g, u)| g * u[i]).sum();
                held[i] = keep * (0..D).map(|j| turn[(i, j)] * old[j]).sum::<f64>() + stiffness * q;
            }
        }
    }

    /// Assemble the internal forces of an element.
    fn pull(&mut self, e: usize, nodes: &[u32], stresses: &[Matrix3<f64>], pressure: Option<f64>) {
        let corners = self.corners(nodes, 0.0);
        let points = self.points(&corners);
        let by_law: Vec<f64> =
            self.states[e].iter().zip(&self.volumes[e]).map(|(s, v)| s.volume_ratio * v).collect();
        let whole: f64 = points.iter().map(|p| p.volume).sum();
        let mean = stresses.iter().zip(&by_law).map(|(s, v)| s.trace() / 3.0 * v).sum::<f64>() / whole;
        for (p, point) in points.iter().enumerate() {
            let (mut stress, mut volume) = (stresses[p], point.volume);
            let deviator = stress - Matrix3::identity() * (stress.trace() / 3.0);
            if self.technology == Technology::MeanDilatation {
                stress = deviator * (by_law[p] / volume) + Matrix3::identity() * mean;
            }
            if let Some(pressure) = pressure {
                stress = deviator + Matrix3::identity() * (pressure / self.states[e][p].volume_ratio);
                volume = by_law[p];
            }
            for (c, &n) in nodes.iter().enumerate() {
                for i in 0..D {
                    let along: f64 = (0..D).map(|j| stress[(i, j)] * point.slopes[c][j]).sum();
                    self.force[n as usize][i] -= volume * along;
                }
                self.force[n as usize][0] -= volume * stress[(2, 2)] * point.hoops[c];
            }
        }
        if let Technology::OnePoint(_) = self.technology {
            for (gamma, held) in gammas(&corners, &points[0]).iter().zip(&self.held[e]) {
                for (c, &n) in nodes.iter().enumerate() {
                    for i in 0..D {
                        self.force[n as usize][i] -= gamma[c] * held[i];
                    }
                }
            }
        }
    }
}

/// Compare both codes over steps in which a body rotates, yields and oscillates.
fn compare<const D: usize, E: Embedding<D>>(space: E, kind: ElementKind, technology: Technology) {
    let law = flowing(8930.0, 117e9, 0.35, 200e6);
    // More than one batch, and not whole octets.
    let counts: [usize; D] = std::array::from_fn(|d| if D == 2 { [11, 7][d] } else { [5, 4, 3][d] });
    let high = counts.map(|n| n as f64 * 1e-3);
    let mesh = distorted(mesh(kind, [0.0; D], high, counts), 0.2, 1e-3);
    let velocity = |x: [f64; D]| -> [f64; D] {
        let spin = if E::HOOP { 0.0 } else { 2e4 };
        let along = [
            60.0 * (900.0 * x[1]).sin() - spin * x[1],
            80.0 * (700.0 * x[0]).cos() + spin * x[0],
            50.0 * (800.0 * x[0]).sin(),
        ];
        std::array::from_fn(|d| if E::HOOP && d == 0 { along[0] * x[0] * 300.0 } else { along[d] })
    };
    let mut fem = Fem::new(space);
    fem.add(MeshBody::new("body", mesh.clone(), law).with(kind, technology).moving(velocity)).unwrap();
    let dt = 0.6 * fem.next_time_step();
    fem.set_time_control(TimeControl::Fixed(dt)).unwrap();
    let mut plain = Plain::<D, E>::new(law, technology, mesh, velocity);
    for step in 0..60 {
        // Steps of two sizes.
        let dt = if step % 7 == 3 { 0.5 * dt } else { dt };
        fem.trial(dt).unwrap().finish().unwrap();
        plain.step(dt);
    }
    let nodes = fem.body(0).nodes();
    let (mut off, mut most, mut flowed) = ([0.0f64; 3], [0.0f64; 3], 0);
    for n in 0..nodes.len() {
        let force = fem.body(0).force(n);
        assert!((nodes[n].mass / plain.mass[n] - 1.0).abs() < 1e-13);
        for d in 0..D {
            let pairs = [
                (nodes[n].position[d], plain.x[n][d]),
                (nodes[n].velocity[d], plain.v[n][d]),
                (force[d], plain.force[n][d]),
            ];
            for (k, (a, b)) in pairs.into_iter().enumerate() {
                off[k] = off[k].max((a - b).abs());
                most[k] = most[k].max(b.abs());
            }
        }
    }
    for state in plain.states.iter().flatten() {
        flowed += usize::from(state.strength.plastic_strain > 0.0);
    }
    assert!(flowed > 10, "{flowed}");
    // The shear modulus of the springs is found by straining a point.
    let within = if matches!(technology, Technology::OnePoint(_)) { 1e-7 } else { 1e-9 };
    for k in 0..3 {
        assert!(off[k] < within * most[k], "{} {kind:?} {technology:?}: {off:?} of {most:?}", E::NAME);
    }
}

#[test]
fn kernels_do_what_plain_loops_do() {
    let springs = Technology::OnePoint(Hourglass::Stiffness(KAPPA));
    let dashpots = Technology::OnePoint(Hourglass::Viscous(0.1));
    for technology in [springs, dashpots, Technology::Full, Technology::MeanDilatation] {
        compare(PlaneStrain, Quad4, technology);
        compare(Axisymmetric, Quad4, technology);
        compare(FullSpace, Hexa8, technology);
    }
    for technology in [Technology::Full, Technology::AveragedVolumes] {
        compare(PlaneStrain, Triangle3, technology);
        compare(Axisymmetric, Triangle3, technology);
        compare(FullSpace, Tetra4, technology);
    }
}
