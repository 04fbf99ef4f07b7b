//! Bond with slip of bars within a body of particles: laws, and what nodes of bars remember.

use std::fmt::Debug;

use fem::Fem;
use impactite_geometry::ElementKind;
use impactite_scene::error::parameter;
use impactite_scene::{Archive, Body, CheckpointError, SceneError};

/// Cosine of the angle, 30 degrees, that bars may turn by at a node that slips.
const STRAIGHT: f64 = 0.866_025_403_784_438_6;
/// Of the limit of central differences, which holds where matter is heavy, what is taken: matter may be a third as heavy as the bar.
const SAFETY: f64 = 0.5;

/// Part of the last change of stress that acts in advance. Matter answers to a bond that is elastic a step late, which would feed its
/// vibrations; this damps them. Where the bond slides its stress does not change.
const AHEAD: f64 = 0.25;

/// What the bond at a node remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BondState {
    /// Slip at which it would have no stress, m.
    pub plastic: f64,
    /// The slip of the largest amount so far, m.
    pub reached: f64,
    /// Did it slide since that was reached? Then friction alone holds until it is reached again.
    pub slid: bool,
}

/// The stress tau that bond has by the slip s of a bar along its axis: tau = k (s - s_p), bounded.
///
/// While the slip grows beyond all before, |tau| is bounded by [`strength`](BondLaw::strength); it unloads with the stiffness k, and slides back by
/// [`friction`](BondLaw::friction), which then bounds it until the largest slip is reached again. What it stores is tau^2 / 2 k per
/// surface; all else is dissipated.
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
    /// Stiffness k of loading at first and of unloading, Pa/m, positive: it bounds the stable step.
    fn stiffness(&self) -> f64;
    /// The largest stress, Pa, at a slip of this amount, m, that is larger than all before. It falls nowhere faster than the stiffness, but at once.
    fn strength(&self, slip: f64) -> f64;
    /// Stress, Pa, that it slides back with, by the largest amount of the slip so far, m: at most the strength there.
    fn friction(&self, reached: f64) -> f64;
    /// Stress, Pa, at a slip, m; the stress has its sign while that grows.
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

/// tau = k s, up to a strength if it has one, and friction from then on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearBond {
    stiffness: f64,
    /// And friction, Pa.
    strength: Option<[f64; 2]>,
}

impl LinearBond {
    /// Of this stiffness, Pa/m, without end.
    ///
    /// # Errors
    /// A stiffness that is not positive and finite.
    pub fn new(stiffness: f64) -> Result<Self, SceneError> {
        parameter(stiffness > 0.0, "linear bond", "stiffness", stiffness, "positive and finite")?;
        Ok(LinearBond { stiffness, strength: None })
    }
    /// Broken at this stress, Pa, with a friction, Pa, left.
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

/// The curve of the Model Codes for ribbed bars \[CEB1990\], \[fib2010\] of the slip s that grows:
///
/// ```text
/// tau = tau_max (s / s1)^alpha               s <= s1
///     = tau_max                              s1 <= s <= s2
///     = tau_max - (tau_max - tau_f) (s - s2) / (s3 - s2)
///     = tau_f                                s3 <= s
/// ```
///
/// At first, and where it unloads, it is as stiff as it is said to be: the curve alone begins infinitely so. It slides back with
/// tau_f, or less where less was reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelCodeBond {
    strength: f64,
    friction: f64,
    slips: [f64; 3],
    exponent: f64,
    stiffness: f64,
}

impl ModelCodeBond {
    /// Of the strength tau_max and the friction tau_f, Pa, slips s1 <= s2 < s3, m, the exponent alpha, 0 to 1, and the stiffness of unloading, Pa/m.
    ///
    /// # Errors
    /// Numbers that are not so; a stiffness that is less than that of the curve at s1, tau_max / s1, or of its fall.
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

/// A node of a bar.
#[derive(Clone, Debug)]
struct BondNode<const D: usize> {
    /// The nodes before and after it, in its body; itself at an end.
    beside: [u32; 2],
    /// Surface of the bar that is its own, m^2 at rest; none where it is tied.
    surface: f64,
    /// m, and m/s.
    slip: f64,
    rate: f64,
    state: BondState,
    /// Now, and a step before, Pa.
    stress: [f64; 2],
    /// Velocity against matter, m/s.
    relative: [f64; D],
    /// Accelerations of the velocity that it shares with matter in the last two steps, the last one first, m/s^2.
    accelerations: [[f64; D]; 2],
    /// That velocity before the step, and as the step was tried, m/s.
    shared: [[f64; D]; 2],
}

/// Bars that slip along their axes.
///
/// The velocity of a node is v = v_c + r t: what it shares with matter, and the rate r of its slip along its tangent t. Along this its own
/// force f and the bond move it, m (a . t + dr/dt) = f . t - tau A, with the acceleration a that those with matter in the last two steps lead to. The grid sees
/// v_c and the force f - m d(r t)/dt, so that momentum is kept whatever a was: what a is wrong by in a step comes back in the next one.
#[derive(Debug)]
pub(crate) struct Bond<const D: usize> {
    law: Box<dyn BondLaw>,
    perimeter: f64,
    nodes: Vec<BondNode<D>>,
    /// Length of the last step, s, and what was dissipated, J.
    last: f64,
    dissipated: f64,
}

fn difference<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|d| a[d] - b[d])
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The unit vector from one point to another; none between equal ones.
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
            // Of each node what bars go on to, and half their lengths.
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

    /// What it is, in words.
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

    /// Of a longest step of the elements alone, s, that with bond.
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

    /// Before elements move their nodes.
    pub fn remember(&mut self, fem: &Fem<D>) {
        for (bond, nodes, n) in Self::with_bodies(&mut self.nodes, fem) {
            bond.shared[0] = difference(&nodes[n].velocity, &bond.relative);
        }
    }

    /// Then: slip in a step of `dt` seconds, and the velocities that the grid sees, m/s.
    pub fn slip(&mut self, fem: &Fem<D>, dt: f64, velocities: &mut [[f64; 3]]) {
        // Velocities belong to the middle of steps.
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

    /// The velocity of a node against matter in this step, m/s.
    pub fn relative(&self, node: usize) -> [f64; D] {
        self.nodes[node].relative
    }

    /// End the step: the grid changed what it saw by `changes`, m/s, if at all.
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

    /// What it stores, J.
    pub fn stored(&self) -> f64 {
        let sum: f64 = self.nodes.iter().map(|bond| bond.surface * bond.stress[0] * bond.stress[0]).sum();
        0.5 * sum / self.law.stiffness()
    }

    /// What it dissipated since the start, J.
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
