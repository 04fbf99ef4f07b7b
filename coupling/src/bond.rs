//! Bond with slip of bars within a body of particles: bond laws, and state variables of bar nodes.

use std::fmt::Debug;

use fem::Fem;
use impactite_geometry::ElementKind;
use impactite_scene::error::parameter;
use impactite_scene::{Archive, Body, CheckpointError, SceneError};

/// Cosine of the largest angle, 30 degrees, between bars at a node with slip.
const STRAIGHT: f64 = 0.866_025_403_784_438_6;
/// Safety factor on the central difference limit, which assumes heavy matter: matter may be a third as heavy as the bar.
const SAFETY: f64 = 0.5;

/// Part of the last stress increment that acts in advance. Matter responds to an elastic bond one step late, which would amplify its
/// vibrations; this part damps them. The stress of a sliding bond does not change.
const AHEAD: f64 = 0.25;

/// State variables of the bond at a node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BondState {
    /// Slip of zero stress, m.
    pub plastic: f64,
    /// Slip of the largest amount so far, m.
    pub reached: f64,
    /// True if the bond slid back since `reached` was set: friction is then the bound until that slip is reached again.
    pub slid: bool,
}

/// Bond stress tau as a function of the slip s of a bar along its axis: tau = k (s - s_p), bounded.
///
/// While the slip grows beyond all earlier values, |tau| is bounded by [`strength`](BondLaw::strength). Unloading has the stiffness k, and
/// backward sliding the stress [`friction`](BondLaw::friction), which then is the bound until the largest slip is reached again. The stored
/// energy is tau^2 / 2 k per surface; the rest is dissipated.
///
/// ```
/// use coupling::{BondLaw, BondState};
///
/// /// Friction alone, from the first slip on.
/// #[derive(Debug)]
/// struct Sleeve;
///
/// impl BondLaw for Sleeve {
///     fn stiffness(&self) -> f64 {
///         1e10
///     }
///     fn strength(&self, _: f64) -> f64 {
///         2e6
///     }
///     fn friction(&self, _: f64) -> f64 {
///         2e6
///     }
/// }
/// let mut state = BondState::default();
/// assert_eq!(Sleeve.stress(1e-4, &mut state), 1e6);
/// assert_eq!(Sleeve.stress(1e-3, &mut state), 2e6);
/// ```
pub trait BondLaw: Debug + Send + Sync {
    /// Stiffness k of initial loading and of unloading, Pa/m, positive: it limits the time step.
    fn stiffness(&self) -> f64;
    /// Bond strength, Pa, at a slip of this amount, m, larger than all before. It may drop at once, but else falls no faster than the
    /// stiffness.
    fn strength(&self, slip: f64) -> f64;
    /// Friction stress of backward sliding, Pa, by the largest amount of the slip so far, m: at most the strength there.
    fn friction(&self, reached: f64) -> f64;
    /// Update the bond stress, Pa, at a slip, m; the stress has the sign of the slip while the slip grows.
    fn stress(&self, slip: f64, state: &mut BondState) -> f64 {
        let stiffness = self.stiffness();
        let tried = stiffness * (slip - state.plastic);
        let grows = slip.abs() >= state.reached.abs();
        let bound = if grows {
            (state.reached, state.slid) = (slip, false);
            self.strength(slip.abs())
        } else if state.slid || tried * state.reached < 0.0 {
            self.friction(state.reached.abs())
        } else {
            self.strength(state.reached.abs())
        };
        if tried.abs() <= bound {
            return tried;
        }
        let stress = bound.copysign(tried);
        state.plastic = slip - stress / stiffness;
        state.slid = !grows;
        stress
    }
}

/// Linear bond: tau = k s, up to an optional strength, followed by friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearBond {
    stiffness: f64,
    /// Strength and friction, Pa.
    strength: Option<[f64; 2]>,
}

impl LinearBond {
    /// Create a bond of this stiffness, Pa/m, with unlimited strength.
    ///
    /// # Errors
    /// A stiffness that is not positive and finite.
    pub fn new(stiffness: f64) -> Result<Self, SceneError> {
        parameter(stiffness > 0.0, "linear bond", "stiffness", stiffness, "positive and finite")?;
        Ok(LinearBond { stiffness, strength: None })
    }
    /// Set the strength, Pa, and the friction after failure, Pa.
    ///
    /// # Errors
    /// A strength that is not positive and finite; friction that is negative, or more than the strength.
    pub fn with_strength(self, strength: f64, friction: f64) -> Result<Self, SceneError> {
        parameter(strength > 0.0, "linear bond", "strength", strength, "positive and finite")?;
        let holds = (0.0..=strength).contains(&friction);
        parameter(holds, "linear bond", "friction", friction, "0 to the strength")?;
        Ok(LinearBond { strength: Some([strength, friction]), ..self })
    }
}

impl BondLaw for LinearBond {
    fn stiffness(&self) -> f64 {
        self.stiffness
    }
    fn strength(&self, slip: f64) -> f64 {
        match self.strength {
            Some([strength, friction]) if slip * self.stiffness > strength => friction,
            Some([strength, _]) => strength,
            None => f64::INFINITY,
        }
    }
    fn friction(&self, reached: f64) -> f64 {
        self.strength(reached)
    }
}

/// Bond-slip curve of the Model Codes for ribbed bars \[CEB1990\], \[fib2010\], for a growing slip s:
///
/// ```text
/// tau = tau_max (s / s1)^alpha               s <= s1
///     = tau_max                              s1 <= s <= s2
///     = tau_max - (tau_max - tau_f) (s - s2) / (s3 - s2)
///     = tau_f                                s3 <= s
/// ```
///
/// Initial loading and unloading have a given stiffness, because the slope of the curve at zero is infinite. Backward sliding has the
/// stress tau_f, or less if less was reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelCodeBond {
    strength: f64,
    friction: f64,
    slips: [f64; 3],
    exponent: f64,
    stiffness: f64,
}

impl ModelCodeBond {
    /// Create the curve from the strength tau_max and the friction tau_f, Pa, slips s1 <= s2 < s3, m, the exponent alpha, 0 to 1, and the
    /// stiffness of unloading, Pa/m.
    ///
    /// # Errors
    /// Numbers outside these ranges; a stiffness that is less than that of the curve at s1, tau_max / s1, or of its descending branch.
    pub fn new(
        strength: f64,
        friction: f64,
        slips: [f64; 3],
        exponent: f64,
        stiffness: f64,
    ) -> Result<Self, SceneError> {
        let check =
            |holds, field, value, allowed| parameter(holds, "bond of the Model Codes", field, value, allowed);
        check(strength > 0.0, "strength", strength, "positive and finite")?;
        check((0.0..=strength).contains(&friction), "friction", friction, "0 to the strength")?;
        let [s1, s2, s3] = slips;
        check(s1 > 0.0, "s1", s1, "positive and finite")?;
        check(s2 >= s1, "s2", s2, "s1 or more, finite")?;
        check(s3 > s2, "s3", s3, "more than s2, finite")?;
        check((0.0..=1.0).contains(&exponent), "exponent", exponent, "0 to 1")?;
        let steepest = (strength / s1).max((strength - friction) / (s3 - s2));
        let allowed = "at least strength / s1 and (strength - friction) / (s3 - s2), finite";
        check(stiffness >= steepest, "stiffness", stiffness, allowed)?;
        Ok(ModelCodeBond { strength, friction, slips, exponent, stiffness })
    }
}

impl BondLaw for ModelCodeBond {
    fn stiffness(&self) -> f64 {
        self.stiffness
    }
    fn strength(&self, slip: f64) -> f64 {
        let [s1, s2, s3] = self.slips;
        if slip < s1 {
            self.strength * (slip / s1).powf(self.exponent)
        } else if slip <= s2 {
            self.strength
        } else if slip < s3 {
            self.strength - (self.strength - self.friction) * (slip - s2) / (s3 - s2)
        } else {
            self.friction
        }
    }
    fn friction(&self, reached: f64) -> f64 {
        self.friction.min(self.strength(reached))
    }
}

/// Node of a bar with bond.
#[derive(Clone, Debug)]
struct BondNode<const D: usize> {
    /// Nodes before and after it in its body; the node itself at an end.
    beside: [u32; 2],
    /// Surface of the bar at the node, m^2 at rest; zero if tied.
    surface: f64,
    /// Slip, m, and slip rate, m/s.
    slip: f64,
    rate: f64,
    state: BondState,
    /// Bond stress now, and one step before, Pa.
    stress: [f64; 2],
    /// Velocity relative to the matter, m/s.
    relative: [f64; D],
    /// Accelerations of the velocity shared with the matter in the last two steps, the last one first, m/s^2.
    accelerations: [[f64; D]; 2],
    /// Shared velocity before the step, and as tried in the step, m/s.
    shared: [[f64; D]; 2],
}

/// Bond with slip of bars along their axes.
///
/// The velocity of a node is v = v_c + r t: the velocity v_c shared with the matter, and the slip rate r along its tangent t. Along t its
/// own force f and the bond stress tau act, m (a . t + dr/dt) = f . t - tau A, with the acceleration a extrapolated from the last two
/// steps. The grid receives v_c and the force f - m d(r t)/dt, so that momentum is conserved for any a: the error of a in a step is
/// compensated in the next one.
#[derive(Debug)]
pub(crate) struct Bond<const D: usize> {
    law: Box<dyn BondLaw>,
    perimeter: f64,
    nodes: Vec<BondNode<D>>,
    /// Length of the last step, s, and dissipated energy, J.
    last: f64,
    dissipated: f64,
}

fn difference<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|d| a[d] - b[d])
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Unit vector from one point to another; zero between equal ones.
fn direction<const D: usize>(from: &[f64; D], to: &[f64; D]) -> [f64; D] {
    let along = difference(to, from);
    let length = dot(&along, &along).sqrt();
    if length > 0.0 { along.map(|x| x / length) } else { [0.0; D] }
}

impl<const D: usize> Bond<D> {
    pub fn new(fem: &Fem<D>, law: impl BondLaw + 'static, perimeter: f64) -> Result<Self, SceneError> {
        parameter(perimeter > 0.0, "bond", "perimeter", perimeter, "positive and finite")?;
        let mut nodes = Vec::new();
        for body in fem.element_bodies() {
            let mesh = body.mesh();
            if let Some(block) = mesh.blocks.iter().find(|b| b.kind != ElementKind::Bar2 && !b.is_empty()) {
                return Err(SceneError::NotWith {
                    what: format!("the elements {:?} of the body `{}`", block.kind, Body::name(body)),
                    method: "bond with slip".into(),
                    why: "it is along the axis of bars: give these a scene of elements of their own",
                });
            }
            // For each node the adjacent nodes of bars, and half the length of these bars.
            let mut at: Vec<(Vec<(u32, bool)>, f64)> = vec![(Vec::new(), 0.0); mesh.nodes.len()];
            for ends in mesh.blocks.iter().flat_map(|b| b.elements()) {
                let along = difference(&mesh.nodes[ends[1] as usize], &mesh.nodes[ends[0] as usize]);
                let half = 0.5 * dot(&along, &along).sqrt();
                for (n, other, before) in [(ends[0], ends[1], false), (ends[1], ends[0], true)] {
                    at[n as usize].0.push((other, before));
                    at[n as usize].1 += half;
                }
            }
            for (n, (others, half)) in at.into_iter().enumerate() {
                let own = n as u32;
                let away = |m: u32| direction(&mesh.nodes[n], &mesh.nodes[m as usize]);
                let beside = match others[..] {
                    [(a, before)] => Some(if before { [a, own] } else { [own, a] }),
                    [(a, before), (b, _)] if dot(&away(a), &away(b)) <= -STRAIGHT => {
                        Some(if before { [a, b] } else { [b, a] })
                    }
                    _ => None,
                };
                nodes.push(BondNode {
                    beside: beside.unwrap_or([own; 2]),
                    surface: if beside.is_some() { perimeter * half } else { 0.0 },
                    slip: 0.0,
                    rate: 0.0,
                    state: BondState::default(),
                    stress: [0.0; 2],
                    relative: [0.0; D],
                    accelerations: [[0.0; D]; 2],
                    shared: [[0.0; D]; 2],
                });
            }
        }
        Ok(Bond { law: Box::new(law), perimeter, nodes, last: 0.0, dissipated: 0.0 })
    }

    /// Description for checkpoints.
    pub fn constants(&self) -> String {
        format!("{:?} on a perimeter of {}", self.law, self.perimeter)
    }

    fn with_bodies<'a>(
        nodes: &'a mut [BondNode<D>],
        fem: &'a Fem<D>,
    ) -> impl Iterator<Item = (&'a mut BondNode<D>, &'a [fem::Node<D>], usize)> {
        let all = fem.element_bodies().iter().flat_map(|body| {
            let nodes = body.nodes();
            (0..nodes.len()).map(move |n| (nodes, n))
        });
        nodes.iter_mut().zip(all).map(|(node, (all, n))| (node, all, n))
    }

    /// Stable time step with bond, s, from that of the elements alone, s.
    pub fn stable_step(&self, fem: &Fem<D>, elements: f64) -> f64 {
        let masses = fem.element_bodies().iter().flat_map(|body| body.nodes());
        let stiffest = self
            .nodes
            .iter()
            .zip(masses)
            .filter(|(_, node)| node.mass > 0.0)
            .map(|(bond, node)| bond.surface / node.mass)
            .fold(0.0, f64::max);
        let square = self.law.stiffness() * stiffest * (0.5 / SAFETY).powi(2);
        1.0 / (1.0 / (elements * elements) + square).sqrt()
    }

    /// Store the shared velocities, before the elements move their nodes.
    pub fn remember(&mut self, fem: &Fem<D>) {
        for (bond, nodes, n) in Self::with_bodies(&mut self.nodes, fem) {
            bond.shared[0] = difference(&nodes[n].velocity, &bond.relative);
        }
    }

    /// Update the slip rates over a step of `dt` seconds, after [`Bond::remember`], and return the velocities for the grid, m/s.
    pub fn slip(&mut self, fem: &Fem<D>, dt: f64, velocities: &mut [[f64; 3]]) {
        // Velocities are those of half steps.
        let kick = 0.5 * (self.last + dt);
        let mut damped = 0.0;
        for ((bond, nodes, n), out) in Self::with_bodies(&mut self.nodes, fem).zip(velocities) {
            let node = &nodes[n];
            if bond.surface > 0.0 && node.mass > 0.0 {
                let [before, after] = bond.beside.map(|m| &nodes[m as usize].position);
                let (a, b) = (direction(before, &node.position), direction(&node.position, after));
                let tangent = direction(&[0.0; D], &std::array::from_fn(|d| a[d] + b[d]));
                let started: [f64; D] = std::array::from_fn(|d| bond.shared[0][d] + bond.relative[d]);
                let own = dot(&difference(&node.velocity, &started), &tangent);
                let [last, before] = &bond.accelerations;
                let matter: [f64; D] = std::array::from_fn(|d| 2.0 * last[d] - before[d]);
                let ahead = AHEAD * (bond.stress[0] - bond.stress[1]);
                let (impulse, rate) = (kick * bond.surface, bond.rate);
                bond.rate +=
                    own - impulse * (bond.stress[0] + ahead) / node.mass - dt * dot(&matter, &tangent);
                damped += impulse * ahead * 0.5 * (rate + bond.rate);
                bond.relative = tangent.map(|t| bond.rate * t);
            }
            bond.shared[1] = difference(&node.velocity, &bond.relative);
            out[..D].copy_from_slice(&bond.shared[1]);
        }
        (self.last, self.dissipated) = (dt, self.dissipated + damped);
    }

    /// Velocity of a node relative to the matter in this step, m/s.
    pub fn relative(&self, node: usize) -> [f64; D] {
        self.nodes[node].relative
    }

    /// End the step: update slip and stress. `changes` are the velocity changes by the grid, m/s, if any.
    pub fn end(&mut self, changes: Option<&Vec<[f64; 3]>>) {
        let stiffness = self.law.stiffness();
        let stored = |stress: f64| 0.5 * stress * stress / stiffness;
        for (n, bond) in self.nodes.iter_mut().enumerate() {
            let change = changes.map_or([0.0; 3], |changes| changes[n]);
            bond.accelerations[1] = bond.accelerations[0];
            bond.accelerations[0] =
                std::array::from_fn(|d| (bond.shared[1][d] + change[d] - bond.shared[0][d]) / self.last);
            if bond.surface == 0.0 {
                continue;
            }
            let (way, before) = (self.last * bond.rate, bond.stress[0]);
            bond.slip += way;
            let now = self.law.stress(bond.slip, &mut bond.state);
            bond.stress = [now, before];
            let work = 0.5 * (before + now) * way;
            self.dissipated += bond.surface * (work - stored(now) + stored(before));
        }
    }

    /// Stored energy, J.
    pub fn stored(&self) -> f64 {
        let sum: f64 = self.nodes.iter().map(|bond| bond.surface * bond.stress[0] * bond.stress[0]).sum();
        0.5 * sum / self.law.stiffness()
    }

    /// Dissipated energy since the start, J.
    pub fn dissipated(&self) -> f64 {
        self.dissipated
    }

    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<BondNode<D>>()
    }

    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.reals([&mut self.last, &mut self.dissipated])?;
        for bond in &mut self.nodes {
            let BondNode { slip, rate, state, stress, relative, accelerations, .. } = bond;
            let numbers = [slip, rate, &mut state.plastic, &mut state.reached];
            let vectors = accelerations.iter_mut().flatten().chain(relative);
            file.reals(numbers.into_iter().chain(stress).chain(vectors))?;
            file.flag(&mut state.slid)?;
        }
        Ok(())
    }
}
