//! Finite elements as a body of a material point scene.

use fem::{ContactSurface, Fem};
use impactite_scene::constants::Constant;
use impactite_scene::error::parameter;
use impactite_scene::{
    Archive, Body, BoundaryEntry, Bounds, CheckpointError, Exchange, Parts, PointView, SceneError, Solver,
    StepError, Stopped, Totals, Watch,
};
use impactite_simd::Team;
use mpm_contact::ContactLaw;
use mpm_contact::mesh::MeshContact;
use mpm_core::{ClientPoint, GridClient, Matter, NewParticles, SurfaceClient, Surroundings};

use crate::bond::{Bond, BondLaw};
use crate::cells::SweptBoxes;
use crate::conversion::{Conversion, ConversionLog, Particles, Rules};
use crate::element::{Form, box_around};
use crate::particles::particles_of;
use crate::tied::Tied;

/// Width of a node on the grid, over the smallest edge: nodes are on the surface.
const WIDTH: f64 = 1e-3;
/// Rounding tolerance, over the step.
const ROUNDING: f64 = 1e-12;

/// Default maximum number of element steps in one step of the scene, with contact by surface.
const SUBCYCLES: u32 = 8;

/// Bodies of finite elements in a scene of material points, added by [`Mpm::add_client`](mpm_core::Mpm::add_client).
///
/// On the grid the elements make the steps of the scene, limited by their own stable time step. By surface they make one or several equal
/// steps in one of the scene, as their own stable time step requires, with contact in each of them ([`Elements::with_subcycles`]). Boundary
/// conditions and body forces of the elements are those of their own [`Fem`].
pub struct Elements<const D: usize> {
    pub(crate) fem: Fem<D>,
    name: String,
    embedding: &'static str,
    /// Shortest edge of the elements, and the largest mean edge of a body, m.
    edges: [f64; 2],
    way: Way<D>,
    /// Bond with slip of bars within a body.
    bond: Option<Bond<D>>,
    /// Maximum number of element steps in one step of the scene; number in the present one, and length of each, s.
    most: u32,
    steps: u32,
    pub(crate) step: f64,
    /// Number of element steps already made.
    made: u32,
}

/// Coupling of elements and particles.
enum Way<const D: usize> {
    Grid,
    /// Embedded in the body of this name.
    Within(String),
    Converting(Box<Converting<D>>),
    Surface(Box<PointToSurface<D>>),
}

/// Body of elements that is converted to particles, element by element.
struct Converting<const D: usize> {
    /// Name of the body of particles.
    body: String,
    rules: Rules<D>,
    tied: Tied<D>,
    /// Least mass of a particle, kg, and half its size, m.
    lightest: f64,
    half_size: f64,
    /// Mean edge of the elements at rest, and cell size of the grid to which they were tied, m.
    edge: f64,
    spacing: f64,
}

/// Point-to-surface contact of particles.
pub(crate) struct PointToSurface<const D: usize> {
    pub(crate) contact: MeshContact<D>,
    pub(crate) swept: SweptBoxes<D>,
    /// Contact surface of each body, at the start of the elements' step.
    pub(crate) surfaces: Vec<ContactSurface<D>>,
}

impl<const D: usize> Elements<D> {
    /// Couple on the grid: mesh nodes contribute to the grid like particles, with the contact algorithm of the scene.
    ///
    /// # Errors
    /// No body, or several, which would stick to each other on the grid; elements that erode.
    pub fn on_the_grid(fem: Fem<D>) -> Result<Self, SceneError> {
        if fem.element_bodies().len() != 1 {
            return Err(SceneError::NotOneBody(fem.element_bodies().len()));
        }
        let body = &fem.element_bodies()[0];
        if body.erodes() {
            return Err(SceneError::NotWith {
                what: format!("the body `{}`, whose elements erode,", body.name()),
                method: "contact of elements on the grid".into(),
                why: "what is eroded would stay on the grid: let particles meet the surface (`Elements::by_surface`)",
            });
        }
        Self::new(fem, Way::Grid)
    }

    /// Embed elements in a body of particles of the scene, which was added before: bars and stirrups in concrete, a stiff core in rubber
    /// (HFEMP, \[Lian2011b\]). Their nodes contribute mass, momentum and force to the grid like particles of that body, and move with its
    /// matter (perfect bond): contact of the body acts on both. Elements and particles may overlap; their mass and stiffness add up.
    ///
    /// Elements may be smaller than cells, or larger, and are then tied at their nodes only. Erosion is failure of bars: their mass stays
    /// with the body's matter.
    ///
    /// # Errors
    /// No body; boundary conditions, prescribed velocities or a body force of the elements: those of the scene act on them.
    pub fn within(mut fem: Fem<D>, body: impl Into<String>) -> Result<Self, SceneError> {
        if fem.element_bodies().is_empty() {
            return Err(SceneError::NoBodies);
        }
        let refuse = |what: String, why| {
            Err(SceneError::NotWith { what, method: "elements within a body of particles".into(), why })
        };
        if !fem.boundaries().is_empty() || fem.prescribes() {
            return refuse(
                "a condition of the elements".into(),
                "they move with the body that they are within: give conditions to the scene",
            );
        }
        if fem.has_body_force() {
            return refuse(
                "a body force of the elements".into(),
                "that of the scene acts on all matter: give it to the scene",
            );
        }
        // Carried matter has no balance of its own; the scene checks that of both.
        fem.set_watch(Watch::off());
        Self::new(fem, Way::Within(body.into()))
    }

    /// Enable slip of bars [within](Self::within) a body along their axes by a bond law, on a perimeter, m (in plane strain per metre of
    /// depth, without a unit). Across their axes bond is perfect. Nodes where bars meet at an angle of more than 30 degrees, and nodes of
    /// three or more bars, are tied: hooks and crossings.
    ///
    /// Bars must be inside the body: there is no slip without matter around them. Stored energy of the bond is internal energy of the bars;
    /// dissipated energy is booked as friction ([`Exchange::friction`]).
    ///
    /// # Errors
    /// Elements that are not within a body, or are not bars; a perimeter that is not positive and finite.
    pub fn with_bond(mut self, law: impl BondLaw + 'static, perimeter: f64) -> Result<Self, SceneError> {
        if !matches!(self.way, Way::Within(_)) {
            return Err(SceneError::NotWith {
                what: "bond with slip".into(),
                method: "elements that are not within a body of particles".into(),
                why: "bars slip against the matter around them: make them a part of it (`Elements::within`)",
            });
        }
        self.bond = Some(Bond::new(&self.fem, law, perimeter)?);
        Ok(self)
    }

    /// Convert elements to particles, element by element, by the rules of a [`Conversion`]: by criteria (AFEMP), or from the start in a
    /// region (MPFEM). The particles belong to a body of this name, which the scene creates; they inherit mass, momentum and states, and
    /// are never converted back. Remaining elements are tied to the particles beside them, like bars [within](Self::within) a body; their
    /// other nodes are not on the grid, which exists only around particles.
    ///
    /// Boundary conditions are those of the scene, which also act on the elements. A body force of the scene is refused.
    ///
    /// The log reports conversions while the elements are in the scene.
    ///
    /// # Errors
    /// Not exactly one body; bars; boundary conditions or a body force of the elements; invalid rules.
    pub fn converting(
        mut fem: Fem<D>,
        body: impl Into<String>,
        conversion: Conversion<D>,
    ) -> Result<(Self, ConversionLog), SceneError> {
        if fem.element_bodies().len() != 1 {
            return Err(SceneError::NotOneBody(fem.element_bodies().len()));
        }
        let refuse = |what: &str, why| {
            let (what, method) = (what.into(), "elements that become particles".into());
            Err(SceneError::NotWith { what, method, why })
        };
        if !fem.boundaries().is_empty() {
            return refuse(
                "a condition of the elements",
                "those of the scene hold elements and particles: give it to the scene",
            );
        }
        if fem.has_body_force() {
            return refuse("a body force of the elements", "particles would not have it");
        }
        fem.set_watch(Watch::off());
        let most = f64::from(match conversion.particles() {
            Particles::Each(count) => count,
            _ => 2,
        });
        let rules = conversion.of(&mut fem)?;
        let elements = &fem.element_bodies()[0];
        let least = elements.nodes().iter().map(|node| node.mass).fold(f64::INFINITY, f64::min);
        let Ok(lengths) = elements.mesh().edge_lengths() else {
            return Err(SceneError::Empty(elements.name().into()));
        };
        let converting = Converting {
            body: body.into(),
            lightest: 1e-3 * least / most.powi(D as i32),
            half_size: 0.5 * lengths.mean / most,
            rules,
            tied: Tied::default(),
            edge: lengths.mean,
            spacing: 0.0,
        };
        let log = converting.rules.log.clone();
        Ok((Self::new(fem, Way::Converting(Box::new(converting)))?, log))
    }

    /// Couple by surface: point-to-surface contact of particles, by a contact law.
    ///
    /// # Errors
    /// No body, or one without facets (bars).
    pub fn by_surface(fem: Fem<D>, law: impl ContactLaw<f64>) -> Result<Self, SceneError> {
        let bodies = fem.element_bodies();
        if bodies.is_empty() {
            return Err(SceneError::NoBodies);
        }
        if let Some(bars) = bodies.iter().find(|body| body.surface().is_empty()) {
            return Err(SceneError::NotWith {
                what: format!("the body `{}`, which has no facets,", bars.name()),
                method: "contact of particles with surfaces".into(),
                why: "bars have no surface: let them act on the grid",
            });
        }
        let mut contact = MeshContact::new(law);
        for body in 0..bodies.len() {
            contact = contact.between(body, bodies.len());
        }
        if fem.axisymmetric() {
            contact = contact.axisymmetric();
        }
        let way = PointToSurface { contact, swept: SweptBoxes::default(), surfaces: Vec::new() };
        Self::new(fem, Way::Surface(Box::new(way)))
    }

    fn new(fem: Fem<D>, way: Way<D>) -> Result<Self, SceneError> {
        let names: Vec<&str> = fem.element_bodies().iter().map(|body| body.name()).collect();
        let (name, embedding) = (names.join(" + "), fem.embedding());
        let mut edges = [f64::INFINITY, 0.0f64];
        for body in fem.element_bodies() {
            let Ok(lengths) = body.mesh().edge_lengths() else { return Err(SceneError::Empty(name)) };
            edges = [edges[0].min(lengths.min), edges[1].max(lengths.mean)];
        }
        let most = if matches!(way, Way::Surface(_)) { SUBCYCLES } else { 1 };
        Ok(Elements { fem, name, embedding, edges, way, bond: None, most, steps: 1, step: 0.0, made: 0 })
    }

    /// Set the maximum number of element steps in one step of the scene, by default 8; with 1 the scene makes the steps of the elements if
    /// they are shorter. Each element step solves contact anew: an impulse stops only the nodes of a facet, and the matter behind them
    /// follows in the travel time of sound through an element.
    ///
    /// # Errors
    /// [`SceneError::Parameter`] for zero; more than one on the grid, where contact is solved once a step.
    pub fn with_subcycles(mut self, most: u32) -> Result<Self, SceneError> {
        parameter(most > 0, "Elements", "most steps in one of the scene", f64::from(most), "at least 1")?;
        if most > 1 && !matches!(self.way, Way::Surface(_)) {
            return Err(SceneError::NotWith {
                what: "several steps of the elements in one of the scene".into(),
                method: "contact of elements on the grid".into(),
                why: "contact is found once a step there: let particles meet the surface (`Elements::by_surface`)",
            });
        }
        self.most = most;
        Ok(self)
    }

    /// Finite element solver of the elements.
    pub fn fem(&self) -> &Fem<D> {
        &self.fem
    }

    fn nodes(&self) -> impl Iterator<Item = &fem::Node<D>> {
        self.fem.element_bodies().iter().flat_map(|body| body.nodes())
    }
}

impl<const D: usize> Converting<D> {
    /// Convert removed elements to particles, and mark the next ones. Returns the previous number of each point on the grid, if the points
    /// changed.
    fn convert(
        &mut self,
        fem: &mut Fem<D>,
        around: &Surroundings<D>,
        new: &mut NewParticles<f64, D>,
    ) -> Result<Option<Vec<u32>>, Stopped> {
        let first = Solver::clock(fem).steps == 0;
        self.rules.mark(fem.body_mut(0), around);
        let mut joined = false;
        if first {
            fem.convert_marked();
            joined = self.tied.join(fem.body(0), around).map_err(Stopped::Scene)?;
        }
        let left = fem.body_mut(0).take_converted();
        if left.is_empty() && !joined {
            return Ok(None);
        }
        self.spacing = around.spacing();
        let (particles, hoop) = (self.rules.particles(), fem.axisymmetric());
        let law = fem.body(0).shared_material();
        let energy = |state: &[f64]| law.energy_of(state).unwrap_or_default();
        let mut total = 0.0;
        for element in &left {
            let became = particles_of(element, (particles, self.spacing, hoop), law.density(), &energy, new);
            let appeared = became.kinetic + became.internal - element.hourglass;
            total += appeared;
            self.rules.log.change(|book| {
                book.elements += 1;
                book.particles += became.particles;
                book.mass += became.mass;
                book.energy += appeared;
                book.hourglass -= element.hourglass;
                let share = &mut book.by[element.criterion].1;
                share.elements += 1;
                share.energy += appeared;
                let form = |at: &[[f64; D]]| {
                    Form::of(element.kind, &std::array::from_fn(|n| at[n.min(at.len() - 1)]))
                };
                let jacobian = form(&element.positions).least_jacobian(&form(&element.rest));
                book.least_jacobian = Some(book.least_jacobian.map_or(jacobian, |least| least.min(jacobian)));
            });
        }
        fem.body_mut(0).book_conversion(total);
        self.tied.add(&left);
        Ok(Some(self.tied.find(fem.body(0), [self.spacing, self.edge])))
    }

    fn archive(&mut self, body: &fem::ElementBody<D>, file: &mut Archive) -> Result<(), CheckpointError> {
        let mut touched = self.tied.touched();
        file.list(&mut touched, &0, |file, n| {
            let mut word = u64::from(*n);
            file.word(&mut word)?;
            *n = u32::try_from(word).map_err(|_| file.damaged(format!("{word} is no node")))?;
            Ok(())
        })?;
        file.real(&mut self.spacing)?;
        file.word(self.rules.looks_mut())?;
        let mut book = self.rules.log.book();
        for word in [&mut book.elements, &mut book.particles] {
            file.word(word)?;
        }
        file.reals([&mut book.mass, &mut book.energy, &mut book.hourglass])?;
        for (_, share) in &mut book.by {
            file.word(&mut share.elements)?;
            file.real(&mut share.energy)?;
        }
        file.option(&mut book.least_jacobian, Archive::real)?;
        if file.reads() {
            self.rules.log.change(|old| *old = book);
            let nodes = body.nodes().len() as u32;
            if touched.iter().any(|n| *n >= nodes) {
                return Err(file.damaged("a tied node is none of the mesh"));
            }
            self.tied = Tied::of(touched);
            self.tied.find(body, [self.spacing, self.edge]);
        }
        Ok(())
    }
}

fn what(error: StepError) -> Stopped {
    error.what
}

impl<const D: usize> Body for Elements<D> {
    fn name(&self) -> &str {
        &self.name
    }
    fn law(&self) -> &'static str {
        self.fem.element_bodies()[0].law()
    }
    fn len(&self) -> usize {
        self.fem.element_bodies().iter().map(Body::len).sum()
    }
    fn state_names(&self) -> Vec<String> {
        self.fem.element_bodies()[0].state_names()
    }
    fn totals(&self) -> Totals {
        let mut totals = Solver::totals(&self.fem);
        totals.internal += self.bond.as_ref().map_or(0.0, Bond::stored);
        totals
    }
    fn given_by_others(&self) -> Option<Exchange> {
        // Work on carried matter does not follow from the impulses and velocities of its nodes.
        if matches!(self.way, Way::Within(_) | Way::Converting(_)) {
            return None;
        }
        let mut sum = Exchange::default();
        self.fem.element_bodies().iter().for_each(|body| sum.add(&body.pushed()));
        Some(sum)
    }
    fn surface_area(&self) -> Option<f64> {
        self.fem.element_bodies().iter().map(Body::surface_area).sum()
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.for_each_with(Parts::ALL, visit);
    }
    fn bounds(&self, dimensions: usize, axisymmetric: bool) -> Option<[[f64; 3]; 2]> {
        let mut held = Bounds::default();
        for corners in self.fem.element_bodies().iter().filter_map(|b| b.bounds(dimensions, axisymmetric)) {
            corners.iter().for_each(|corner| held.hold_place(corner, 0.0));
        }
        held.corners()
    }
    fn for_each_with(&self, parts: Parts, visit: &mut dyn FnMut(&PointView)) {
        let mut before = 0;
        for body in self.fem.element_bodies() {
            body.for_each_with(parts, &mut |point| {
                visit(&PointView { number: before + point.number, ..point.clone() })
            });
            before += Body::len(body);
        }
    }
    fn bytes(&self) -> usize {
        let surface = match &self.way {
            Way::Grid | Way::Within(_) => 0,
            Way::Converting(converting) => converting.tied.bytes(),
            Way::Surface(surface) => {
                let surfaces = surface.surfaces.iter().map(ContactSurface::bytes).sum::<usize>();
                surface.contact.bytes() + surface.swept.bytes() + surfaces
            }
        };
        Solver::bytes(&self.fem) + surface + self.bond.as_ref().map_or(0, Bond::bytes)
    }
}

impl<const D: usize> GridClient<f64, D> for Elements<D> {
    fn constants(&self, _: [f64; 2]) -> Vec<Constant> {
        let way = match &self.way {
            Way::Grid => "on the grid".to_string(),
            Way::Within(body) => match &self.bond {
                Some(bond) => format!("within {body}, bond {}", bond.constants()),
                None => format!("within {body}"),
            },
            Way::Converting(converting) => {
                format!("converted into {}: {}", converting.body, converting.rules.what.constants())
            }
            Way::Surface(surface) => format!("by surface: {:?}", surface.contact.laws()),
        };
        vec![("elements".into(), way), ("most steps in one of the scene".into(), self.most.to_string())]
    }
    fn embedding(&self) -> &'static str {
        self.embedding
    }
    fn half_size(&self) -> [f64; D] {
        [0.5 * WIDTH * self.edges[0]; D]
    }
    fn spacing(&self) -> f64 {
        self.edges[1]
    }
    fn mass_points(&self) -> Vec<(f64, [f64; D])> {
        match &self.way {
            Way::Grid | Way::Within(_) => self.nodes().map(|node| (node.mass, node.velocity)).collect(),
            Way::Converting(converting) => converting.tied.mass_points(self.fem.body(0)),
            Way::Surface(_) => Vec::new(),
        }
    }
    fn place(&mut self, points: &mut [ClientPoint]) {
        let mut half_edges = [[0.0; 3]; 3];
        (0..D).for_each(|d| half_edges[d][d] = 0.5 * WIDTH * self.edges[0]);
        let mut set = |positions: &mut dyn Iterator<Item = [f64; D]>| {
            for (point, position) in points.iter_mut().zip(positions) {
                point.position[..D].copy_from_slice(&position);
                point.half_edges = half_edges;
            }
        };
        match &self.way {
            Way::Converting(converting) => set(&mut converting.tied.positions(self.fem.body(0))),
            _ => set(&mut self.nodes().map(|node| node.position)),
        }
    }
    fn stable_step(&self) -> f64 {
        let step = f64::from(self.most) * self.fem.next_time_step();
        self.bond.as_ref().map_or(step, |bond| bond.stable_step(&self.fem, step))
    }
    fn open(&mut self, dt: f64, velocities: &mut [[f64; 3]], team: &Team) -> Result<(), Stopped> {
        self.fem.set_team(team.clone());
        let steps = (dt / self.fem.next_time_step() * (1.0 - ROUNDING)).ceil();
        self.steps = (steps as u32).clamp(1, self.most);
        (self.step, self.made) = (dt / f64::from(self.steps), 0);
        if let Way::Converting(converting) = &mut self.way {
            converting.tied.remember(self.fem.body(0));
        }
        if let Some(bond) = &mut self.bond {
            bond.remember(&self.fem);
            self.fem.begin(self.step).map_err(what)?;
            bond.slip(&self.fem, dt, velocities);
            return Ok(());
        }
        self.begin()?;
        match &mut self.way {
            Way::Grid | Way::Within(_) => {
                let nodes = self.fem.element_bodies().iter().flat_map(|body| body.nodes());
                for (out, node) in velocities.iter_mut().zip(nodes) {
                    out[..D].copy_from_slice(&node.velocity);
                }
            }
            Way::Converting(converting) => converting.tied.velocities(self.fem.body(0), velocities),
            Way::Surface(surface) => surface.sweep(dt),
        }
        Ok(())
    }
    fn advance(&mut self, _: f64, changes: Option<&mut Vec<[f64; 3]>>, _: &Team) -> Result<(), Stopped> {
        if let Some(bond) = &mut self.bond {
            bond.end(changes.as_deref());
        }
        if let Way::Converting(converting) = &self.way {
            let none = Vec::new();
            converting.tied.push(self.fem.body_mut(0), changes.map_or(&none, |changes| changes));
        } else if let Some(changes) = changes {
            let mut before = 0;
            for number in 0..self.fem.element_bodies().len() {
                let body = self.fem.body_mut(number);
                let own = changes[before..][..body.nodes().len()].iter().enumerate();
                before += body.nodes().len();
                for (n, change) in own.filter(|(_, change)| **change != [0.0; 3]) {
                    let mass = body.nodes()[n].mass;
                    body.add_impulse(n, std::array::from_fn(|d| mass * change[d]));
                }
            }
        }
        while !self.is_last() {
            self.next()?;
        }
        self.made += 1;
        self.fem.finish().map_err(what)
    }
    fn within(&self) -> Option<&str> {
        match &self.way {
            Way::Within(body) => Some(body),
            Way::Converting(converting) => Some(&converting.body),
            _ => None,
        }
    }
    fn carry(&mut self, velocities: &[[f64; 3]]) {
        if let Way::Converting(converting) = &self.way {
            return converting.tied.carry(self.fem.body_mut(0), velocities);
        }
        let mut before = 0;
        for number in 0..self.fem.element_bodies().len() {
            let body = self.fem.body_mut(number);
            let (first, own) = (before, &velocities[before..][..body.nodes().len()]);
            before += own.len();
            for (n, v) in own.iter().enumerate() {
                let slips = self.bond.as_ref().map_or([0.0; D], |bond| bond.relative(first + n));
                body.carry(n, std::array::from_fn(|d| v[d] + slips[d]));
            }
        }
    }
    fn matter(&self) -> Option<Matter<f64, D>> {
        let Way::Converting(converting) = &self.way else { return None };
        let law = self.fem.body(0).shared_material();
        Some(Matter { law, half_size: [converting.half_size; D], lightest: converting.lightest })
    }
    fn velocities(&self, velocities: &mut [[f64; 3]]) {
        if let Way::Converting(converting) = &self.way {
            converting.tied.velocities(self.fem.body(0), velocities);
        }
    }
    fn bound(&mut self, boundary: &BoundaryEntry<D>) -> Result<(), SceneError> {
        self.fem.bound(boundary.clone())
    }
    fn convert(
        &mut self,
        around: &Surroundings<D>,
        new: &mut NewParticles<f64, D>,
    ) -> Result<Option<Vec<u32>>, Stopped> {
        let Way::Converting(converting) = &mut self.way else { return Ok(None) };
        converting.convert(&mut self.fem, around, new)
    }
    fn each_box(&self, visit: &mut dyn FnMut(&[f64; D], &[f64; D])) {
        for body in self.fem.element_bodies() {
            for facet in body.surface() {
                let (low, high) = box_around(body, facet.nodes());
                visit(&low, &high);
            }
            if body.surface().is_empty() {
                body.nodes().iter().for_each(|node| visit(&node.position, &node.position));
            }
        }
    }
    fn surface(&mut self) -> Option<&mut dyn SurfaceClient<f64, D>> {
        match self.way {
            Way::Surface(_) => Some(self),
            _ => None,
        }
    }
    fn given(&self) -> Exchange {
        let mut given = Solver::exchange(&self.fem);
        for body in self.fem.element_bodies() {
            let pushed = body.pushed();
            for d in 0..3 {
                given.impulse[d] -= pushed.impulse[d];
            }
            given.work -= pushed.work;
            if matches!(self.way, Way::Surface(_)) {
                // Energy transferred by contact from particles to elements.
                given.impacts -= pushed.work;
            }
        }
        given.friction += self.bond.as_ref().map_or(0.0, Bond::dissipated);
        given
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        Solver::archive(&mut self.fem, file)?;
        if let Some(bond) = &mut self.bond {
            bond.archive(file)?;
        }
        match &mut self.way {
            Way::Grid | Way::Within(_) => Ok(()),
            Way::Converting(converting) => converting.archive(self.fem.body(0), file),
            Way::Surface(surface) => surface.contact.archive(file),
        }
    }
}

impl<const D: usize> Elements<D> {
    /// Elements, with their point-to-surface contact.
    pub(crate) fn parts(&mut self) -> Option<(&mut Fem<D>, &mut PointToSurface<D>)> {
        match &mut self.way {
            Way::Surface(surface) => Some((&mut self.fem, surface)),
            _ => None,
        }
    }

    /// True if this element step is the last one in the step of the scene.
    pub(crate) fn is_last(&self) -> bool {
        self.made + 1 >= self.steps
    }

    /// Begin a step of the elements.
    fn begin(&mut self) -> Result<(), Stopped> {
        self.fem.begin(self.step).map_err(what)?;
        match &mut self.way {
            Way::Surface(surface) => self.fem.surfaces(&mut surface.surfaces).map_err(what),
            _ => Ok(()),
        }
    }

    /// End an element step that is not the last one in the step of the scene, and begin the next one.
    pub(crate) fn next(&mut self) -> Result<(), Stopped> {
        self.fem.finish().map_err(what)?;
        self.made += 1;
        self.begin()
    }

    /// Boxes swept by the surfaces in this step.
    pub(crate) fn swept(&self) -> Option<&SweptBoxes<D>> {
        match &self.way {
            Way::Surface(surface) => Some(&surface.swept),
            _ => None,
        }
    }
}
