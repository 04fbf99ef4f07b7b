//! Bodies of elements: how they are given, and what they hold.

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

/// A node: a place, a velocity and a mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Velocity, m/s: between steps that of the middle of the last one, in a [`Trial`](crate::Trial) the one tried.
    pub velocity: [f64; D],
    /// Lumped mass, kg: the integral of density times shape function. Per metre of depth in plane strain, per radian around an axis.
    pub mass: f64,
    /// Directions in which something else than elements and body forces moved it in the last step, a bit each: [`Node::HELD`],
    /// [`Node::TOUCHED`].
    pub(crate) held: u8,
}

impl<const D: usize> Node<D> {
    /// The first direction, where conditions or others moved it.
    pub(crate) const HELD: u8 = 1;
    /// The first direction, where only contact in the scene did.
    pub(crate) const TOUCHED: u8 = 8;

    /// Did conditions or others move it in a direction?
    pub(crate) fn is_held(&self, d: usize) -> bool {
        self.held & Self::HELD << d != 0
    }
    /// Did only contact in the scene, beside elements and body forces?
    pub(crate) fn is_touched(&self, d: usize) -> bool {
        self.held & Self::TOUCHED << d != 0
    }
    /// Did only elements and body forces?
    pub(crate) fn is_free(&self, d: usize) -> bool {
        !self.is_held(d) && !self.is_touched(d)
    }
}

type Velocity<const D: usize> = Box<dyn Fn([f64; D]) -> [f64; D] + Send + Sync>;

/// What a body is made of, to be added to a scene ([`Fem::add`](crate::Fem::add)).
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
    /// A body of this name, at rest, with the technologies of [`Technology::default_of`] and without erosion.
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
    /// Move at first with this velocity, m/s, of the position, m.
    #[must_use]
    pub fn moving(self, velocity: impl Fn([f64; D]) -> [f64; D] + Send + Sync + 'static) -> Self {
        MeshBody { velocity: Box::new(velocity), ..self }
    }
    /// Integrate elements of a kind so.
    #[must_use]
    pub fn with(mut self, kind: ElementKind, technology: Technology) -> Self {
        self.technologies.insert(kind, technology);
        self
    }
    /// Let elements leave.
    #[must_use]
    pub fn eroding(self, erosion: Erosion) -> Self {
        MeshBody { erosion, ..self }
    }
    /// Section of bars at rest, m^2 (in plane strain per metre of depth, m); 1 unless told.
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

    /// The body.
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

/// How far the surface of a bar with a section is from its middle, m: in the plane it is a plate, in space it is round.
fn half_thickness<const D: usize>(section: f64) -> f64 {
    if D == 3 { (section / std::f64::consts::PI).sqrt() } else { 0.5 * section }
}

/// For each node the slots that hold what elements give it, ascending.
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

/// What erosion took since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Eroded {
    /// Elements.
    pub elements: u64,
    /// Their mass, which stays on nodes, kg.
    pub mass: f64,
    /// Internal energy that went with them, that of hourglass forces included, J.
    pub energy: f64,
    /// That of hourglass forces, J.
    pub hourglass: f64,
}

/// Nodes with a velocity that is prescribed.
pub(crate) struct Prescribed {
    pub set: String,
    pub nodes: Vec<u32>,
    pub velocity: VelocityHistory,
}

/// A body of elements in a scene.
pub struct ElementBody<const D: usize> {
    pub(crate) name: String,
    /// As it was given: node positions are those at rest.
    pub(crate) mesh: ElementMesh<D>,
    pub(crate) material: Arc<dyn Material<f64>>,
    pub(crate) probe: Probe,
    pub(crate) virgin: Vec<f64>,
    pub(crate) nodes: Vec<Node<D>>,
    pub(crate) sets: Vec<Set>,
    /// What the elements of each batch give to its nodes: forces, N.
    pub(crate) slots: Vec<Record>,
    pub(crate) incidence: Incidence,
    /// A number a node, where volumes are averaged.
    pub(crate) averages: Vec<f64>,
    pub(crate) elements: usize,
    /// Of bars, m.
    pub(crate) half_thickness: f64,
    /// Smallest of some element sizes: what is small against it lies on a plane.
    pub(crate) spacing: f64,
    /// How far elements reach around each node along the axes, m; empty unless a condition asks.
    pub(crate) extents: Vec<[f64; D]>,
    pub(crate) pace: Pace,
    /// Half the largest frequency bound of the elements, 1/s.
    pub(crate) rate: f64,
    /// The same in the states that it was given, 1/s.
    pub(crate) first_rate: f64,
    /// Of the body force in the present step, m/s^2.
    pub(crate) acceleration: [f64; D],
    pub(crate) exchange: Exchange,
    /// What of it came by impulses of others.
    pub(crate) pushed: Exchange,
    /// What came by contact in the scene, which is not in `exchange`.
    pub(crate) touched: Exchange,
    pub(crate) erosion: Resolved,
    pub(crate) eroded: Eroded,
    /// The largest energy that it had at a look: kinetic and internal, without that of hourglass forces, J.
    pub(crate) largest_energy: f64,
    /// Mass of elements that left, by node; empty before the first does.
    pub(crate) debris: Vec<f64>,
    pub(crate) surface: Vec<Facet>,
    pub(crate) revision: u64,
    pub(crate) prescribed: Vec<Prescribed>,
    pub(crate) loads: Vec<SurfaceLoad<D>>,
    /// Impulses of others and of contact in the present step.
    pub(crate) pushes: Vec<Push<D>>,
    /// Positions at the start of a step that is made of several, and mean velocities over it.
    pub(crate) from: Vec<[f64; D]>,
    pub(crate) flow: Vec<[f64; D]>,
    /// Velocities that nodes move with in this step in place of their own, m/s, of those that do; empty where none does.
    pub(crate) carried: Vec<Option<[f64; D]>>,
    /// What makes elements become something else; boxed, for most bodies have none.
    pub(crate) converting: Option<Box<Converting<D>>>,
}

impl<const D: usize> ElementBody<D> {
    /// The nodes.
    pub fn nodes(&self) -> &[Node<D>] {
        &self.nodes
    }
    /// The mesh as it was given, with the positions at rest.
    pub fn mesh(&self) -> &ElementMesh<D> {
        &self.mesh
    }
    /// The facets of the surface of the elements that are left; none of bars.
    pub fn surface(&self) -> &[Facet] {
        &self.surface
    }
    /// How often the surface changed.
    pub fn surface_revision(&self) -> u64 {
        self.revision
    }
    /// The law.
    pub fn material(&self) -> &dyn Material<f64> {
        &*self.material
    }
    /// The same, to be shared.
    pub fn shared_material(&self) -> Arc<dyn Material<f64>> {
        self.material.clone()
    }
    /// What erosion took.
    pub fn eroded(&self) -> Eroded {
        self.eroded
    }
    /// The largest stable step of its elements, s.
    pub fn stable_step(&self) -> f64 {
        1.0 / self.rate
    }
    /// What boundaries, body forces, contact and others gave to it since the start: impulses to the time of the velocities, work to that
    /// of the positions.
    pub fn exchange(&self) -> Exchange {
        self.given().plus(&self.touched())
    }
    /// The same without contact in the scene.
    pub(crate) fn given(&self) -> Exchange {
        Exchange { work: self.exchange.work + self.work_to_come(Node::is_held), ..self.exchange }
    }
    /// What of [`ElementBody::exchange`] came by contact in the scene ([`Fem::touch`](crate::Fem::touch)): impulses and their work on
    /// velocities, heat of friction and what impacts take included.
    pub fn touched(&self) -> Exchange {
        Exchange { work: self.touched.work + self.work_to_come(Node::is_touched), ..self.touched }
    }
    /// What of [`ElementBody::exchange`] came by impulses of others ([`ElementBody::add_impulse`]).
    pub fn pushed(&self) -> Exchange {
        self.pushed
    }
    /// May its elements erode?
    pub fn erodes(&self) -> bool {
        self.erosion.is_on()
    }
    /// Energy in hourglass forces, J: a part of the internal energy.
    pub fn hourglass_energy(&self) -> f64 {
        self.sets.iter().flat_map(|s| s.alive().map(|(b, e, _)| s.hourglass(b, e))).sum()
    }
    /// Note its energy, if it never had more: what hourglass forces are measured against.
    pub(crate) fn note_energy(&mut self) {
        let totals = self.totals();
        let energy = totals.kinetic.max(totals.kinetic + totals.internal - self.hourglass_energy());
        self.largest_energy = self.largest_energy.max(energy);
    }
    /// The sum of the forces of the elements on a node, N.
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
