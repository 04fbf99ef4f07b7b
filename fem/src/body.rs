//! Bodies of elements: definition and state.

use std::collections::BTreeMap;
use std::sync::Arc;

use impactite_geometry::{ElementKind, ElementMesh, Facet};
use impactite_scene::boundary::VelocityHistory;
use impactite_scene::error::parameter;
use impactite_scene::{Exchange, SceneError};
use mpm_materials::IntoMaterial;
use mpm_materials::material::Material;

use crate::erosion::{Erosion, Resolved};
use crate::law::Probe;
use crate::leaving::Converting;
use crate::load::SurfaceLoad;
use crate::pace::Pace;
use crate::push::Push;
use crate::set::{Making, Set};
use crate::surface::surface_of;
use crate::sweep::Record;
use crate::technology::Technology;

/// Node of a mesh: position, velocity and lumped mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Velocity, m/s: between steps that at the middle of the last step, in a [`Trial`](crate::Trial) the trial velocity.
    pub velocity: [f64; D],
    /// Lumped mass, kg: the integral of density times shape function. Per metre of depth in plane strain, per radian around an axis.
    pub mass: f64,
    /// Bit set of the directions in which conditions, contact or couplings moved the node in the last step: [`Node::HELD`],
    /// [`Node::TOUCHED`].
    pub(crate) held: u8,
}

impl<const D: usize> Node<D> {
    /// Bit of the first direction for motion by conditions or couplings.
    pub(crate) const HELD: u8 = 1;
    /// Bit of the first direction for motion by contact in the scene alone.
    pub(crate) const TOUCHED: u8 = 8;

    /// True if conditions or couplings moved the node in direction `d`.
    pub(crate) fn is_held(&self, d: usize) -> bool {
        self.held & Self::HELD << d != 0
    }
    /// True if contact in the scene moved the node in direction `d`, and neither conditions nor couplings did.
    pub(crate) fn is_touched(&self, d: usize) -> bool {
        self.held & Self::TOUCHED << d != 0
    }
    /// True if neither conditions, couplings nor contact moved the node in direction `d`.
    pub(crate) fn is_free(&self, d: usize) -> bool {
        !self.is_held(d) && !self.is_touched(d)
    }
}

type Velocity<const D: usize> = Box<dyn Fn([f64; D]) -> [f64; D] + Send + Sync>;

/// Definition of a body, to be added to a scene ([`Fem::add`](crate::Fem::add)).
pub struct MeshBody<const D: usize> {
    name: String,
    mesh: ElementMesh<D>,
    material: Arc<dyn Material<f64>>,
    velocity: Velocity<D>,
    technologies: BTreeMap<ElementKind, Technology>,
    erosion: Erosion,
    section: f64,
}

impl<const D: usize> MeshBody<D> {
    /// Create a body at rest, with the technologies of [`Technology::default_of`] and without erosion.
    pub fn new(name: impl Into<String>, mesh: ElementMesh<D>, law: impl IntoMaterial<f64>) -> Self {
        MeshBody {
            name: name.into(),
            mesh,
            material: law.into_material(),
            velocity: Box::new(|_| [0.0; D]),
            technologies: BTreeMap::new(),
            erosion: Erosion::none(),
            section: 1.0,
        }
    }
    /// Set the initial velocity, m/s, as a function of the position, m.
    #[must_use]
    pub fn moving(self, velocity: impl Fn([f64; D]) -> [f64; D] + Send + Sync + 'static) -> Self {
        MeshBody { velocity: Box::new(velocity), ..self }
    }
    /// Set the integration technology of a kind of element.
    #[must_use]
    pub fn with(mut self, kind: ElementKind, technology: Technology) -> Self {
        self.technologies.insert(kind, technology);
        self
    }
    /// Set the erosion criteria.
    #[must_use]
    pub fn eroding(self, erosion: Erosion) -> Self {
        MeshBody { erosion, ..self }
    }
    /// Set the cross-section of bars at rest, m^2 (in plane strain per metre of depth, m); default 1.
    #[must_use]
    pub fn section(self, section: f64) -> Self {
        MeshBody { section, ..self }
    }

    fn check(&self, hoop: bool) -> Result<(), SceneError> {
        let MeshBody { name, mesh, .. } = self;
        if mesh.blocks.iter().all(|b| b.is_empty()) {
            return Err(SceneError::Empty(name.clone()));
        }
        parameter(self.section > 0.0, "bars", "section", self.section, "positive and finite")?;
        let most = u32::MAX as usize / 32;
        if mesh.nodes.len() >= most {
            return Err(SceneError::TooMany { body: name.clone(), count: mesh.nodes.len(), most: most - 1 });
        }
        for (n, x) in mesh.nodes.iter().enumerate() {
            for &value in x {
                if !value.is_finite() {
                    let (body, field, allowed) = (name.clone(), "position of node", "finite");
                    return Err(SceneError::Seed { body, particle: n, field, value, allowed });
                }
            }
            if hoop && x[0] < 0.0 {
                return Err(SceneError::BehindAxis { body: name.clone(), r: x[0] });
            }
        }
        for block in &mesh.blocks {
            self.check_kind(block.kind, hoop)?;
            for (element, nodes) in block.elements().enumerate() {
                let beyond = nodes.iter().find(|&&n| n as usize >= mesh.nodes.len());
                if let Some(&n) = beyond {
                    return Err(SceneError::Element {
                        body: name.clone(),
                        element,
                        field: "node",
                        value: f64::from(n),
                        allowed: "one of the nodes of the mesh",
                    });
                }
            }
        }
        Ok(())
    }

    fn check_kind(&self, kind: ElementKind, hoop: bool) -> Result<(), SceneError> {
        self.technology(kind, hoop).check(kind)?;
        let why = match kind {
            ElementKind::Bar2 if hoop => "around an axis a bar is a shell: take quadrilaterals",
            ElementKind::Bar2 => return Ok(()),
            _ if kind.dimensions() != D => {
                "elements other than bars must fill space: their dimensions are those of the scene"
            }
            _ => return Ok(()),
        };
        let method = format!("{D} dimensions{}", if hoop { ", axisymmetric" } else { "" });
        Err(SceneError::NotWith { what: format!("{kind:?}"), method, why })
    }

    fn technology(&self, kind: ElementKind, hoop: bool) -> Technology {
        self.technologies.get(&kind).copied().unwrap_or_else(|| Technology::default_of(kind, hoop))
    }

    /// Build the body.
    pub(crate) fn build(self, hoop: bool) -> Result<ElementBody<D>, SceneError> {
        self.check(hoop)?;
        let probe = Probe::of(&*self.material)?;
        let virgin = self.material.virgin();
        let mut kinds: BTreeMap<ElementKind, Vec<(u32, &[u32])>> = BTreeMap::new();
        let mut number = 0;
        for block in &self.mesh.blocks {
            let list = kinds.entry(block.kind).or_default();
            for nodes in block.elements() {
                list.push((number, nodes));
                number += 1;
            }
        }
        let nodes = &self.mesh.nodes;
        let making =
            Making { body: &self.name, nodes, virgin: &virgin, probe: &probe, hoop, section: self.section };
        let (mut masses, mut sets, mut slots) = (vec![0.0; nodes.len()], Vec::new(), 0);
        for (kind, elements) in kinds.into_iter().filter(|(_, list)| !list.is_empty()) {
            let mut set = Set::new(kind, self.technology(kind, hoop), elements, &making, &mut masses)?;
            set.first = slots;
            slots = set.slots().end;
            sets.push(set);
        }
        let nodes = self.nodes(&masses)?;
        let incidence = Incidence::of(&sets, nodes.len());
        let erosion = self.erosion.resolve(&*self.material)?;
        let size = |set: &Set| {
            set.batches.iter().map(|b| crate::sweep::lane(&b.sizes[0][0], 0)).fold(f64::INFINITY, f64::min)
        };
        let spacing = sets.iter().map(size).fold(f64::INFINITY, f64::min);
        let surface = surface_of(&self.mesh, &|_| true);
        Ok(ElementBody {
            name: self.name,
            mesh: self.mesh,
            material: self.material,
            probe,
            virgin,
            nodes,
            sets,
            slots: vec![[0.0; 4]; slots],
            incidence,
            averages: Vec::new(),
            elements: number as usize,
            half_thickness: half_thickness::<D>(self.section),
            hoop,
            spacing,
            extents: Vec::new(),
            pace: Pace::default(),
            rate: 0.0,
            first_rate: 0.0,
            acceleration: [0.0; D],
            exchange: Exchange::default(),
            pushed: Exchange::default(),
            touched: Exchange::default(),
            erosion,
            eroded: Eroded::default(),
            largest_energy: 0.0,
            debris: Vec::new(),
            surface,
            revision: 0,
            prescribed: Vec::new(),
            loads: Vec::new(),
            pushes: Vec::new(),
            from: Vec::new(),
            flow: Vec::new(),
            carried: Vec::new(),
            converting: None,
        })
    }

    fn nodes(&self, masses: &[f64]) -> Result<Vec<Node<D>>, SceneError> {
        let mut nodes = Vec::with_capacity(masses.len());
        for (n, (&position, &mass)) in self.mesh.nodes.iter().zip(masses).enumerate() {
            if !(mass > 0.0 && mass.is_finite()) {
                let why = "it is a node of no element; leave it out of the mesh";
                let (body, position) = (self.name.clone(), position.to_vec());
                return Err(SceneError::NoMass { body, particle: n, position, why });
            }
            let velocity = (self.velocity)(position);
            for value in velocity {
                if !value.is_finite() {
                    let (body, field, allowed) = (self.name.clone(), "velocity of node", "finite");
                    return Err(SceneError::Seed { body, particle: n, field, value, allowed });
                }
            }
            nodes.push(Node { position, velocity, mass, held: 0 });
        }
        Ok(nodes)
    }
}

/// Half thickness of a bar, m: of a plate in the plane, of a round bar in space.
fn half_thickness<const D: usize>(section: f64) -> f64 {
    if D == 3 { (section / std::f64::consts::PI).sqrt() } else { 0.5 * section }
}

/// Incidence of nodes and slots: for each node the slots of its element contributions, ascending.
#[derive(Clone, Debug, Default)]
pub(crate) struct Incidence {
    starts: Vec<u32>,
    slots: Vec<u32>,
}

impl Incidence {
    fn of(sets: &[Set], nodes: usize) -> Self {
        let all = || sets.iter().flat_map(|set| set.batches.iter().flat_map(|b| &b.nodes));
        let mut starts = vec![0u32; nodes + 1];
        for &n in all() {
            starts[n as usize + 1] += 1;
        }
        for n in 0..nodes {
            starts[n + 1] += starts[n];
        }
        let (mut next, mut slots) = (starts.clone(), vec![0; all().count()]);
        for (slot, &n) in all().enumerate() {
            slots[next[n as usize] as usize] = slot as u32;
            next[n as usize] += 1;
        }
        Incidence { starts, slots }
    }
    #[inline]
    pub fn slots_of(&self, n: usize) -> &[u32] {
        &self.slots[self.starts[n] as usize..self.starts[n + 1] as usize]
    }
    pub fn bytes(&self) -> usize {
        4 * (self.starts.capacity() + self.slots.capacity())
    }
}

/// Totals of the elements eroded since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Eroded {
    /// Number of elements.
    pub elements: u64,
    /// Mass of these elements, which stays on the nodes, kg.
    pub mass: f64,
    /// Internal energy removed with them, hourglass energy included, J.
    pub energy: f64,
    /// Hourglass energy removed with them, J.
    pub hourglass: f64,
}

/// Node set with a prescribed velocity.
pub(crate) struct Prescribed {
    pub set: String,
    pub nodes: Vec<u32>,
    pub velocity: VelocityHistory,
}

/// Body of finite elements in a scene.
pub struct ElementBody<const D: usize> {
    pub(crate) name: String,
    /// Mesh in the reference configuration: node positions at rest.
    pub(crate) mesh: ElementMesh<D>,
    pub(crate) material: Arc<dyn Material<f64>>,
    pub(crate) probe: Probe,
    pub(crate) virgin: Vec<f64>,
    pub(crate) nodes: Vec<Node<D>>,
    pub(crate) sets: Vec<Set>,
    /// Contributions of the elements of each batch to its nodes: internal forces, N.
    pub(crate) slots: Vec<Record>,
    pub(crate) incidence: Incidence,
    /// Nodal averages, for averaged volumes.
    pub(crate) averages: Vec<f64>,
    pub(crate) elements: usize,
    /// Half thickness of bars, m.
    pub(crate) half_thickness: f64,
    /// Length scale of geometric tolerances, m: least size of the first elements of the batches.
    pub(crate) spacing: f64,
    /// Mean extent of the elements around each node along the axes, m; empty unless a condition needs it.
    pub(crate) extents: Vec<[f64; D]>,
    pub(crate) pace: Pace,
    /// Half the largest frequency bound of the elements, 1/s.
    pub(crate) rate: f64,
    /// Half the largest frequency bound in the initial states, 1/s.
    pub(crate) first_rate: f64,
    /// Acceleration by the body force in the present step, m/s^2.
    pub(crate) acceleration: [f64; D],
    pub(crate) exchange: Exchange,
    /// Part of `exchange` by impulses of couplings.
    pub(crate) pushed: Exchange,
    /// Exchange by contact in the scene, not included in `exchange`.
    pub(crate) touched: Exchange,
    pub(crate) erosion: Resolved,
    pub(crate) eroded: Eroded,
    /// Largest energy of the body at a check, J: kinetic and internal, without hourglass energy.
    pub(crate) largest_energy: f64,
    /// Mass of eroded elements by node, kg; empty before the first erosion.
    pub(crate) debris: Vec<f64>,
    pub(crate) surface: Vec<Facet>,
    pub(crate) revision: u64,
    pub(crate) prescribed: Vec<Prescribed>,
    pub(crate) loads: Vec<SurfaceLoad<D>>,
    /// True around an axis of revolution.
    pub(crate) hoop: bool,
    /// Impulses of couplings, contact and loads in the present step.
    pub(crate) pushes: Vec<Push<D>>,
    /// Positions at the start of a subcycled step, m; `flow`: velocities that strain elements in place of the nodes' own, m/s.
    pub(crate) from: Vec<[f64; D]>,
    pub(crate) flow: Vec<[f64; D]>,
    /// Velocity of the matter that carries a node in this step, m/s, by node; empty if no node is carried.
    pub(crate) carried: Vec<Option<[f64; D]>>,
    /// Conversion of elements; boxed, because most bodies have none.
    pub(crate) converting: Option<Box<Converting<D>>>,
}

impl<const D: usize> ElementBody<D> {
    /// Nodes of the body.
    pub fn nodes(&self) -> &[Node<D>] {
        &self.nodes
    }
    /// Mesh in the reference configuration, with the positions at rest.
    pub fn mesh(&self) -> &ElementMesh<D> {
        &self.mesh
    }
    /// Surface facets of the remaining elements; none for bars.
    pub fn surface(&self) -> &[Facet] {
        &self.surface
    }
    /// Number of changes of the surface.
    pub fn surface_revision(&self) -> u64 {
        self.revision
    }
    /// Material law.
    pub fn material(&self) -> &dyn Material<f64> {
        &*self.material
    }
    /// Shared pointer to the material law.
    pub fn shared_material(&self) -> Arc<dyn Material<f64>> {
        self.material.clone()
    }
    /// Totals of the eroded elements.
    pub fn eroded(&self) -> Eroded {
        self.eroded
    }
    /// Critical time step of the elements, s.
    pub fn stable_step(&self) -> f64 {
        1.0 / self.rate
    }
    /// Exchange with boundaries, body forces, contact and couplings since the start: impulses to the time of the velocities, work to the
    /// time of the positions.
    pub fn exchange(&self) -> Exchange {
        self.given().plus(&self.touched())
    }
    /// Exchange without contact in the scene.
    pub(crate) fn given(&self) -> Exchange {
        Exchange { work: self.exchange.work + self.work_to_come(Node::is_held), ..self.exchange }
    }
    /// Part of [`ElementBody::exchange`] by contact in the scene ([`Fem::touch`](crate::Fem::touch)): impulses and their work, frictional
    /// heat and impact losses included.
    pub fn touched(&self) -> Exchange {
        Exchange { work: self.touched.work + self.work_to_come(Node::is_touched), ..self.touched }
    }
    /// Part of [`ElementBody::exchange`] by impulses of couplings ([`ElementBody::add_impulse`]).
    pub fn pushed(&self) -> Exchange {
        self.pushed
    }
    /// True if elements may erode.
    pub fn erodes(&self) -> bool {
        self.erosion.is_on()
    }
    /// Hourglass energy, J: a part of the internal energy.
    pub fn hourglass_energy(&self) -> f64 {
        self.sets.iter().flat_map(|s| s.alive().map(|(b, e, _)| s.hourglass(b, e))).sum()
    }
    /// Update the largest energy, the reference of the hourglass energy check.
    pub(crate) fn note_energy(&mut self) {
        let totals = self.totals();
        let energy = totals.kinetic.max(totals.kinetic + totals.internal - self.hourglass_energy());
        self.largest_energy = self.largest_energy.max(energy);
    }
    /// Internal force on a node, N: sum over its elements.
    ///
    /// # Panics
    /// There is no such node.
    #[inline]
    pub fn force(&self, n: usize) -> [f64; D] {
        let mut sum = [0.0; D];
        for &slot in self.incidence.slots_of(n) {
            let f = &self.slots[slot as usize];
            for d in 0..D {
                sum[d] += f[d];
            }
        }
        sum
    }
}
