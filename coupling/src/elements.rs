//! A scene of finite elements as a body of a scene of material points.

use fem::{ContactSurface, Fem};
use impactite_scene::constants::Constant;
use impactite_scene::error::parameter;
use impactite_scene::{
    Archive, Body, CheckpointError, Exchange, PointView, SceneError, Solver, StepError, Stopped, Totals,
    Watch,
};
use impactite_simd::Team;
use mpm_contact::ContactLaw;
use mpm_contact::mesh::MeshContact;
use mpm_core::{ClientPoint, GridClient, SurfaceClient};

use crate::cells::SweptBoxes;

/// Part of the smallest edge that a node on the grid is wide: it lies on the surface.
const WIDTH: f64 = 1e-3;
/// Of a step, what is rounding.
const ROUNDING: f64 = 1e-12;

/// Most steps of elements that particles meet by surface in one of the scene, unless said otherwise.
const SUBCYCLES: u32 = 8;

/// Bodies of finite elements in a scene of material points: [`Mpm::add_client`](mpm_core::Mpm::add_client) takes them.
///
/// On the grid the elements make the steps of the scene, whose length their own stable step bounds. By surface they make one or several
/// equal steps in one of the scene, as many as their own stable step asks for, and meet particles in each of them
/// ([`Elements::with_subcycles`]). Conditions and body forces of the elements are those of their own [`Fem`].
pub struct Elements<const D: usize> {
    pub(crate) fem: Fem<D>,
    name: String,
    embedding: &'static str,
    /// Shortest edge of the elements, and the mean one of the body with the longest, m.
    edges: [f64; 2],
    way: Way<D>,
    /// Most steps of the elements in one of the scene; how many there are in this one, and the length of each, s.
    most: u32,
    steps: u32,
    pub(crate) step: f64,
    /// How many of them are over.
    made: u32,
}

/// How elements meet particles.
enum Way<const D: usize> {
    Grid,
    /// As a part of the body of this name.
    Within(String),
    Surface(Box<PointToSurface<D>>),
}

/// Contact of particles with the surfaces.
pub(crate) struct PointToSurface<const D: usize> {
    pub(crate) contact: MeshContact<D>,
    pub(crate) swept: SweptBoxes<D>,
    /// Of each body, as the elements' step was begun.
    pub(crate) surfaces: Vec<ContactSurface<D>>,
}

impl<const D: usize> Elements<D> {
    /// Their nodes act on the grid as particles do, and meet others by the contact algorithm of the scene.
    ///
    /// # Errors
    /// No body, or several: on the grid they would stick to each other; elements that erode.
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

    /// They are a part of a body of particles of the scene, which was added before: bars and stirrups in concrete, a stiff core in rubber
    /// (HFEMP, \[Lian2011b\]). Their nodes act on the grid with mass, momentum and force as particles of that body do, and move with its
    /// matter (perfect bond): what meets the body meets both. Where elements are, particles may be, too; the mass and stiffness of both
    /// add up.
    ///
    /// Elements may be larger than cells, which tie them at their nodes alone, or smaller. Where they erode, bars have failed: their mass stays
    /// with the body's matter.
    ///
    /// # Errors
    /// No body; conditions, velocities of nodes and a body force of their own: those of the scene hold and move what moves with it.
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
        // What matter carries along has no balance of its own; the scene watches over both.
        fem.set_watch(Watch::off());
        Self::new(fem, Way::Within(body.into()))
    }

    /// Particles meet their surfaces one by one, with a law.
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
        Ok(Elements { fem, name, embedding, edges, way, most, steps: 1, step: 0.0, made: 0 })
    }

    /// At most so many steps of the elements in one of the scene, by default 8; with 1 the scene makes those of the elements where they are
    /// shorter. Each finds contact anew: an impulse stops no more than a facet's nodes, and what is behind them comes after in the time
    /// that sound takes through an element.
    ///
    /// # Errors
    /// [`SceneError::Parameter`] for none; more than one on the grid, where contact is found once a step.
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

    /// The elements.
    pub fn fem(&self) -> &Fem<D> {
        &self.fem
    }

    fn nodes(&self) -> impl Iterator<Item = &fem::Node<D>> {
        self.fem.element_bodies().iter().flat_map(|body| body.nodes())
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
        Solver::totals(&self.fem)
    }
    fn given_by_others(&self) -> Option<Exchange> {
        // What matter carries along gets work that no impulse and velocity of its nodes tell.
        if matches!(self.way, Way::Within(_)) {
            return None;
        }
        let mut sum = Exchange::default();
        self.fem.element_bodies().iter().for_each(|body| sum.add(&body.pushed()));
        Some(sum)
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        let mut before = 0;
        for body in self.fem.element_bodies() {
            body.for_each(&mut |point| visit(&PointView { number: before + point.number, ..point.clone() }));
            before += Body::len(body);
        }
    }
    fn bytes(&self) -> usize {
        let surface = match &self.way {
            Way::Grid | Way::Within(_) => 0,
            Way::Surface(surface) => {
                let surfaces = surface.surfaces.iter().map(ContactSurface::bytes).sum::<usize>();
                surface.contact.bytes() + surface.swept.bytes() + surfaces
            }
        };
        Solver::bytes(&self.fem) + surface
    }
}

impl<const D: usize> GridClient<f64, D> for Elements<D> {
    fn constants(&self, _: [f64; 2]) -> Vec<Constant> {
        let way = match &self.way {
            Way::Grid => "on the grid".to_string(),
            Way::Within(body) => format!("within {body}"),
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
        match self.way {
            Way::Grid | Way::Within(_) => self.nodes().map(|node| (node.mass, node.velocity)).collect(),
            Way::Surface(_) => Vec::new(),
        }
    }
    fn place(&mut self, points: &mut [ClientPoint]) {
        let mut half_edges = [[0.0; 3]; 3];
        (0..D).for_each(|d| half_edges[d][d] = 0.5 * WIDTH * self.edges[0]);
        for (point, node) in points.iter_mut().zip(self.nodes()) {
            point.position[..D].copy_from_slice(&node.position);
            point.half_edges = half_edges;
        }
    }
    fn stable_step(&self) -> f64 {
        f64::from(self.most) * self.fem.next_time_step()
    }
    fn open(&mut self, dt: f64, velocities: &mut [[f64; 3]], team: &Team) -> Result<(), Stopped> {
        self.fem.set_team(team.clone());
        let steps = (dt / self.fem.next_time_step() * (1.0 - ROUNDING)).ceil();
        self.steps = (steps as u32).clamp(1, self.most);
        (self.step, self.made) = (dt / f64::from(self.steps), 0);
        self.begin()?;
        match &mut self.way {
            Way::Grid | Way::Within(_) => {
                let nodes = self.fem.element_bodies().iter().flat_map(|body| body.nodes());
                for (out, node) in velocities.iter_mut().zip(nodes) {
                    out[..D].copy_from_slice(&node.velocity);
                }
            }
            Way::Surface(surface) => surface.sweep(dt),
        }
        Ok(())
    }
    fn advance(&mut self, _: f64, changes: Option<&mut Vec<[f64; 3]>>, _: &Team) -> Result<(), Stopped> {
        if let Some(changes) = changes {
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
            _ => None,
        }
    }
    fn carry(&mut self, velocities: &[[f64; 3]]) {
        let mut before = 0;
        for number in 0..self.fem.element_bodies().len() {
            let body = self.fem.body_mut(number);
            let own = &velocities[before..][..body.nodes().len()];
            before += own.len();
            body.carry(own.iter().map(|v| std::array::from_fn(|d| v[d])));
        }
    }
    fn surface(&mut self) -> Option<&mut dyn SurfaceClient<f64, D>> {
        match self.way {
            Way::Grid | Way::Within(_) => None,
            Way::Surface(_) => Some(self),
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
                // What contact gave to elements, of what it took from particles.
                given.impacts -= pushed.work;
            }
        }
        given
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        Solver::archive(&mut self.fem, file)?;
        match &mut self.way {
            Way::Grid | Way::Within(_) => Ok(()),
            Way::Surface(surface) => surface.contact.archive(file),
        }
    }
}

impl<const D: usize> Elements<D> {
    /// Contact of particles with the surfaces, beside the elements.
    pub(crate) fn parts(&mut self) -> Option<(&mut Fem<D>, &mut PointToSurface<D>)> {
        match &mut self.way {
            Way::Grid | Way::Within(_) => None,
            Way::Surface(surface) => Some((&mut self.fem, surface)),
        }
    }

    /// Is this step of the elements the last one in that of the scene?
    pub(crate) fn is_last(&self) -> bool {
        self.made + 1 >= self.steps
    }

    /// Begin a step of the elements.
    fn begin(&mut self) -> Result<(), Stopped> {
        self.fem.begin(self.step).map_err(what)?;
        match &mut self.way {
            Way::Grid | Way::Within(_) => Ok(()),
            Way::Surface(surface) => self.fem.surfaces(&mut surface.surfaces).map_err(what),
        }
    }

    /// End a step of the elements that is not the last in that of the scene, and begin the one after.
    pub(crate) fn next(&mut self) -> Result<(), Stopped> {
        self.fem.finish().map_err(what)?;
        self.made += 1;
        self.begin()
    }

    /// Where the surfaces are in this step.
    pub(crate) fn swept(&self) -> Option<&SweptBoxes<D>> {
        match &self.way {
            Way::Grid | Way::Within(_) => None,
            Way::Surface(surface) => Some(&surface.swept),
        }
    }
}
