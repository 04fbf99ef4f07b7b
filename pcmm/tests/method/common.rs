//! Scenes, and a plain reference implementation of the method: loops over all pairs and elements, never optimised.

use impactite_geometry::{Cuboid, Lattice};
use impactite_scene::Embedding;
use mpm_materials::{
    Constitutive, Elastic, HughesWinget, JohnsonCook, Kinematics, Mat3, MieGruneisen, Moduli, Solid,
};
use pcmm::{Composition, Configuration, Dilatation, Packing, Particle, Pcmm};

/// Elastic steel with a Mie-Grueneisen equation of state: internal energy is a state variable.
pub fn steel() -> Solid<Elastic<f64>, MieGruneisen<f64>> {
    let moduli = Moduli::young_poisson(206e9, 0.3).unwrap();
    let eos = MieGruneisen::new(7850.0, 4500.0, 1.5, 2.0).unwrap();
    Solid::new(Elastic::new(moduli.shear).unwrap(), eos)
}

/// Copper with plastic flow.
pub fn copper() -> Solid<JohnsonCook<f64>, MieGruneisen<f64>> {
    Solid::new(JohnsonCook::copper_taylor(), MieGruneisen::copper())
}

/// Elastic steel with exact rotation of the stress.
pub fn turning_steel()
-> Solid<Elastic<f64>, MieGruneisen<f64>, mpm_materials::NoFailure, mpm_materials::NoViscosity, HughesWinget>
{
    steel().with_rate(HughesWinget)
}

/// Return a block of `nx` x `ny` spacings `h` with its corner at `corner`.
pub fn block(corner: [f64; 2], nx: u32, ny: u32, h: f64) -> Packing<2> {
    let far = [corner[0] + f64::from(nx) * h, corner[1] + f64::from(ny) * h];
    let shape = Cuboid::new(corner, far).unwrap();
    Packing::on_nodes(&shape, &Lattice::new(corner, h).unwrap()).unwrap()
}

/// Return a number in [0, 1) from a seed and a place.
pub fn random(seed: u64, place: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ place.wrapping_mul(0xD1B5_4A32_D192_ED03);
    for _ in 0..3 {
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z ^= z >> 27;
    }
    (z >> 11) as f64 / (1u64 << 53) as f64
}

/// Return a dense random packing with radii between `small` and `large`: circles are thrown at random into a square of edge 1 until `tries`
/// in a row find no room.
pub fn thrown(seed: u64, small: f64, large: f64, tries: u64) -> Packing<2> {
    let (mut positions, mut radii): (Vec<[f64; 2]>, Vec<f64>) = (Vec::new(), Vec::new());
    let (mut place, mut failed) = (0, 0);
    while failed < tries {
        let x = [random(seed, place), random(seed, place + 1)];
        let r = small + (large - small) * random(seed, place + 2);
        place += 3;
        let free = positions.iter().zip(&radii).all(|(y, s): (&[f64; 2], &f64)| {
            (x[0] - y[0]).powi(2) + (x[1] - y[1]).powi(2) >= (r + s).powi(2)
        });
        if free {
            positions.push(x);
            radii.push(r);
            failed = 0;
        } else {
            failed += 1;
        }
    }
    Packing::of_spheres(positions, radii)
}

/// Return neighbours by a loop over all pairs.
pub fn every_pair<const D: usize>(particles: &[Particle<D>], reach: f64) -> Vec<Vec<u32>> {
    let touch = |a: &Particle<D>, b: &Particle<D>| {
        let square: f64 = (0..D).map(|d| (a.position[d] - b.position[d]).powi(2)).sum();
        square <= (a.radius + b.radius + reach).powi(2)
    };
    (0..particles.len())
        .map(|i| {
            (0..particles.len())
                .filter(|&j| j != i && touch(&particles[i], &particles[j]))
                .map(|j| j as u32)
                .collect()
        })
        .collect()
}

/// Plain method on a fixed set of elements.
pub struct Plain<const D: usize, C: Constitutive<f64>> {
    pub law: C,
    pub particles: Vec<Particle<D>>,
    pub nodes: Vec<u32>,
    pub reference: Vec<f64>,
    pub states: Vec<C::State<f64>>,
    pub hoop: bool,
    pub back: f64,
    pub averaged: bool,
}

impl<const D: usize, C: Constitutive<f64>> Plain<D, C> {
    /// Create the same scene with virgin states.
    pub fn of<M: Composition<D>>(solver: &Pcmm<D, M>, law: C) -> Self {
        let particles = solver.particles().to_vec();
        let nodes = solver.element_nodes().to_vec();
        let hoop = M::Embedding::HOOP;
        let mut plain = Plain {
            particles,
            nodes,
            reference: Vec::new(),
            states: vec![law.virgin(); solver.elements()],
            law,
            hoop,
            back: M::Configuration::BACK,
            averaged: M::Dilatation::AVERAGED,
        };
        plain.reference = (0..solver.elements()).map(|e| plain.volume(e, 0.0)).collect();
        plain
    }

    fn corner(&self, e: usize, a: usize, back: f64) -> [f64; D] {
        let p = &self.particles[self.nodes[e * (D + 1) + a] as usize];
        let mut x = p.position;
        for d in 0..D {
            x[d] -= back * p.velocity[d];
        }
        x
    }

    /// Return the volume by the determinant of the edges, `back` seconds ago.
    fn volume(&self, e: usize, back: f64) -> f64 {
        let x: Vec<[f64; D]> = (0..=D).map(|a| self.corner(e, a, back)).collect();
        let mut m = [[0.0; 3]; 3];
        m[2][2] = 1.0;
        for k in 0..D {
            for i in 0..D {
                m[k][i] = x[k + 1][i] - x[0][i];
            }
        }
        let det = Mat3(m).determinant();
        let measure = if D == 2 { det / 2.0 } else { det / 6.0 };
        let radius = x.iter().map(|c| c[0]).sum::<f64>() / (D + 1) as f64;
        if self.hoop { measure * radius } else { measure }
    }

    /// Return the shape function gradients, by the derivative of the volume: dV/dx_a = V grad N_a.
    fn slopes(&self, e: usize, back: f64) -> Vec<[f64; 3]> {
        let x: Vec<[f64; D]> = (0..=D).map(|a| self.corner(e, a, back)).collect();
        let edge = |a: usize, b: usize| {
            let mut v = [0.0; 3];
            for i in 0..D {
                v[i] = x[b][i] - x[a][i];
            }
            v
        };
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        (0..=D)
            .map(|a| {
                let others: Vec<usize> = (0..=D).filter(|b| *b != a).collect();
                let normal = if D == 2 {
                    let along = edge(others[0], others[1]);
                    [along[1], -along[0], 0.0]
                } else {
                    cross(edge(others[0], others[1]), edge(others[0], others[2]))
                };
                let to = edge(others[0], a);
                let height: f64 = (0..3).map(|i| normal[i] * to[i]).sum();
                normal.map(|n| n / height)
            })
            .collect()
    }

    fn elements_at(&self, n: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let all = self.nodes.iter().enumerate().filter(move |(_, m)| **m as usize == n);
        all.map(|(at, _)| (at / (D + 1), at % (D + 1)))
    }

    /// Return the mean over the particles of `e` of the means over their elements.
    fn averaged(&self, e: usize, of: &[f64]) -> f64 {
        let at = |a: usize| {
            let n = self.nodes[e * (D + 1) + a] as usize;
            let (mut sum, mut weight) = (0.0, 0.0);
            for (k, _) in self.elements_at(n) {
                sum += self.reference[k] * of[k];
                weight += self.reference[k];
            }
            sum / weight
        };
        (0..=D).map(at).sum::<f64>() / (D + 1) as f64
    }

    /// Make one step.
    pub fn step(&mut self, dt: f64) {
        let elements = self.states.len();
        // Forces.
        let kirchhoff: Vec<f64> =
            self.states.iter().map(|s| self.law.stress(s).mean() * self.law.volume_ratio(s)).collect();
        let mut force = vec![[0.0; D]; self.particles.len()];
        for e in 0..elements {
            let j = self.law.volume_ratio(&self.states[e]);
            let mut stress = self.law.stress(&self.states[e]);
            if self.averaged {
                stress = stress.plus_isotropic(self.averaged(e, &kirchhoff) / j - stress.mean());
            }
            let volume = self.reference[e] * j;
            let slopes = self.slopes(e, 0.0);
            let radius = (0..=D).map(|a| self.corner(e, a, 0.0)[0]).sum::<f64>() / (D + 1) as f64;
            for a in 0..=D {
                let f = &mut force[self.nodes[e * (D + 1) + a] as usize];
                for i in 0..D {
                    for k in 0..D {
                        f[i] -= volume * stress.at(i, k) * slopes[a][k];
                    }
                }
                if self.hoop {
                    f[0] -= volume * stress.at(2, 2) / ((D + 1) as f64 * radius);
                }
            }
        }
        // Motion.
        for (p, f) in self.particles.iter_mut().zip(&force) {
            for d in 0..D {
                p.velocity[d] += dt * f[d] / p.mass;
                p.position[d] += dt * p.velocity[d];
            }
        }
        // Strain and stress.
        let ratios: Vec<f64> = (0..elements).map(|e| self.volume(e, 0.0) / self.volume(e, dt)).collect();
        let mut states = self.states.clone();
        for e in 0..elements {
            let back = dt * self.back;
            let slopes = self.slopes(e, back);
            let mut increment = Mat3::zero();
            let mut hoop = 0.0;
            let mut radius = 0.0;
            for a in 0..=D {
                let v = self.particles[self.nodes[e * (D + 1) + a] as usize].velocity;
                for i in 0..D {
                    for k in 0..D {
                        increment.0[i][k] += dt * v[i] * slopes[a][k];
                    }
                }
                hoop += v[0];
                radius += self.corner(e, a, back)[0];
            }
            if self.hoop {
                increment.0[2][2] = dt * hoop / radius;
            }
            if self.averaged {
                let ratio = self.averaged(e, &ratios);
                let whole = increment + Mat3::identity();
                let factor = (ratio / whole.determinant()).cbrt();
                increment = whole * factor;
                for i in 0..3 {
                    increment.0[i][i] -= 1.0;
                }
            }
            let measure = self.volume(e, 0.0).abs()
                / if self.hoop {
                    (0..=D).map(|a| self.corner(e, a, 0.0)[0]).sum::<f64>() / (D + 1) as f64
                } else {
                    1.0
                };
            let length = if D == 2 { (2.0 * measure).sqrt() } else { (6.0 * measure).cbrt() };
            states[e] = self.law.update(&Kinematics { increment, dt, length }, &self.states[e]).state;
        }
        self.states = states;
    }
}
