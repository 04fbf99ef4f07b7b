//! View of a body for observers: points are its elements, and nodes with mass of eroded elements.

use impactite_scene::{Archive, Body, Bounds, CheckpointError, Exchange, Parts, PointView, Totals};

use crate::body::{ElementBody, Node};
use crate::load::of_nodes;
use crate::set::{Set, wide};
use crate::sweep::Batch;

impl<const D: usize> ElementBody<D> {
    /// Totals over nodes and elements, and their corrections from staggered to present time ([`Totals::staggered`]). Momentum is that of
    /// the velocities v- at the middle of the last step. Kinetic energy is the sum of m v- . v+ / 2 with the velocities v+ that the
    /// internal forces cause half a step after the present: with the internal energy, central differences conserve it in linear motion.
    /// Directions held by conditions or contact have v+ = v-.
    pub fn totals(&self) -> Totals {
        let (mut sum, lag) = (Totals::default(), self.pace.lag());
        for (n, node) in self.nodes.iter().enumerate() {
            let mut lagged = 0.0;
            if lag != 0.0 {
                let force = self.force(n);
                for d in (0..D).filter(|&d| node.is_free(d)) {
                    lagged += lag * node.velocity[d] * force[d];
                }
            }
            let velocities: [&[f64]; 2] = [&node.velocity, &self.velocity_now(n)];
            sum.add_staggered(node.mass, &node.position, velocities, lagged);
        }
        let [internal, viscous_heat] = self.energies_of_law();
        sum.internal = internal + self.hourglass_energy();
        sum.viscous_heat = viscous_heat;
        sum
    }

    /// Velocity of a node at the time of its position, m/s: v = v- + lag (f / m + g), with the velocity v- at the middle of the last step,
    /// the force f of elements and loads, and the body force g. Directions moved by conditions, contact or couplings have v-.
    ///
    /// # Panics
    /// There is no such node.
    pub fn velocity_now(&self, n: usize) -> [f64; D] {
        let (node, lag) = (&self.nodes[n], self.pace.lag());
        if lag == 0.0 || node.mass == 0.0 {
            return node.velocity;
        }
        let (force, load) = (self.force(n), self.loaded_by(n));
        std::array::from_fn(|d| {
            let more = lag * ((force[d] + load[d]) / node.mass + self.acceleration[d]);
            if node.is_free(d) { node.velocity[d] + more } else { node.velocity[d] }
        })
    }

    /// Work of conditions, contact and couplings since the time of the velocities, J, in the directions selected by `holds`: the elements
    /// are strained up to the time of the positions.
    pub(crate) fn work_to_come(&self, holds: impl Fn(&Node<D>, usize) -> bool) -> f64 {
        let (mut sum, lag) = (0.0, self.pace.lag());
        for (n, node) in self.nodes.iter().enumerate().filter(|(_, node)| node.held != 0) {
            let force = self.force(n);
            for d in (0..D).filter(|&d| holds(node, d)) {
                sum -= lag * node.velocity[d] * force[d];
            }
        }
        sum
    }

    /// Internal energy by the law, J, without hourglass energy.
    pub fn internal_energy(&self) -> f64 {
        self.energies_of_law()[0]
    }

    /// Internal energy by the law, and viscous heat in it, J.
    fn energies_of_law(&self) -> [f64; 2] {
        let (mut sum, mut state) = ([0.0; 2], vec![0.0; self.virgin.len()]);
        for set in &self.sets {
            let points = set.sweep.points();
            for (batch, e, _) in set.alive() {
                for p in 0..points {
                    batch.read(e, (p, points), &mut state);
                    let volume = crate::sweep::lane(&batch.reference[e / 8 * points + p], e % 8);
                    sum[0] += volume * self.material.energy_of(&state).unwrap_or(f64::NAN);
                    sum[1] += volume * self.material.viscous_heat_of(&state);
                }
            }
        }
        sum
    }

    /// Largest hourglass energy of an element, J, and the centre of this element, m.
    pub(crate) fn worst_hourglass(&self) -> (f64, [f64; 3]) {
        let mut worst = (0.0, [0.0; 3]);
        for set in &self.sets {
            for (batch, e, _) in set.alive() {
                let energy = set.hourglass(batch, e);
                if energy > worst.0 {
                    worst = (energy, self.centre(set, batch, e));
                }
            }
        }
        worst
    }

    /// Centre of an element: mean of its node positions, m.
    pub(crate) fn centre(&self, set: &Set, batch: &Batch, e: usize) -> [f64; 3] {
        let (mut centre, share) = ([0.0; 3], 1.0 / set.sweep.nodes() as f64);
        for n in set.nodes_of(batch, e) {
            let x = wide(&self.nodes[n as usize].position);
            (0..3).for_each(|d| centre[d] += share * x[d]);
        }
        centre
    }

    /// Visit the nodes with mass of eroded elements.
    fn for_each_debris(&self, visit: &mut dyn FnMut(&PointView)) {
        for (n, &mass) in self.debris.iter().enumerate().filter(|(_, mass)| **mass > 0.0) {
            visit(&PointView {
                number: self.elements + n,
                position: wide(&self.nodes[n].position),
                velocity: wide(&self.velocity_now(n)),
                mass,
                volume: mass / self.probe.density,
                in_range: true,
                failed: true,
                state: self.virgin.clone(),
                ..PointView::default()
            });
        }
    }

    /// Write the requested parts of an element as a point.
    fn point(
        &self,
        set: &Set,
        batch: &Batch,
        (e, number, parts): (usize, u32, Parts),
        state: &mut [f64],
        to: &mut PointView,
    ) {
        let points = set.sweep.points();
        let n = set.sweep.nodes() as f64;
        (to.number, to.width) = (number as usize, None);
        (to.position, to.velocity, to.stress) = (self.centre(set, batch, e), [0.0; 3], [0.0; 6]);
        (to.in_range, to.failed) = (true, false);
        for node in set.nodes_of(batch, e) {
            let v = wide(&self.velocity_now(node as usize));
            (0..3).for_each(|d| to.velocity[d] += v[d] / n);
        }
        to.corners.clear();
        to.corners.extend(set.nodes_of(batch, e).map(|n| wide(&self.nodes[n as usize].position)));
        if parts == Parts::NONE {
            return;
        }
        let volume = set.volume(batch, e);
        to.mass = volume * self.probe.density;
        if parts == Parts::MASS {
            return;
        }
        to.state.iter_mut().for_each(|x| *x = 0.0);
        let mut ratio = 0.0;
        for p in 0..points {
            batch.read(e, (p, points), state);
            to.state.iter_mut().zip(&*state).for_each(|(sum, x)| *sum += x / points as f64);
            let Some(said) = self.material.describe_point(state) else { continue };
            (0..6).for_each(|i| to.stress[i] += said.stress[i] / points as f64);
            ratio += said.volume_ratio / points as f64;
            to.in_range &= said.in_range;
            to.failed |= said.failed;
        }
        to.volume = volume * ratio;
        if parts.size {
            to.half_edges = set.sweep.measure(&to.corners).half_edges.unwrap_or_default();
        }
    }

    /// Store or load the checkpoint data, and check the definition of the body.
    pub(crate) fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let of = |what: &str| format!("{what} of body `{}`", self.name);
        file.same("name of a body", &self.name)?;
        file.same(&of("law"), self.material.name())?;
        file.same(&of("constants of the law"), &self.material.constants())?;
        file.same(&of("number of nodes"), &self.nodes.len().to_string())?;
        let kinds = self.sets.iter().map(|s| (s.numbers.len(), s.kind, s.technology));
        file.same(&of("elements"), &format!("{:?}", kinds.collect::<Vec<_>>()))?;
        file.same(&of("erosion"), &format!("{:?}", self.erosion))?;
        file.same(&of("conversion"), if self.converting.is_some() { "some" } else { "none" })?;
        let sets: Vec<_> = self.prescribed.iter().map(|p| (&p.set, p.nodes.len())).collect();
        file.same(&of("sets with a prescribed velocity"), &format!("{sets:?}"))?;
        for load in &self.loads {
            file.same(&of("traction"), &load.describe())?;
        }
        for node in &mut self.nodes {
            file.reals(node.position.iter_mut().chain(&mut node.velocity).chain([&mut node.mass]))?;
            let mut held = u32::from(node.held);
            file.index(&mut held, 64)?;
            node.held = held as u8;
        }
        for set in &mut self.sets {
            set.archive(file)?;
        }
        file.reals(self.slots.iter_mut().flatten())?;
        file.reals(self.pace.numbers())?;
        file.index(&mut self.pace.ratio, usize::MAX)?;
        file.index(&mut self.pace.made, usize::MAX)?;
        file.reals(self.acceleration.iter_mut().chain([&mut self.rate]))?;
        file.list(&mut self.from, &[0.0; D], |file, x| file.reals(x))?;
        file.list(&mut self.debris, &0.0, Archive::real)?;
        if let Some(converting) = &mut self.converting {
            file.list(&mut converting.marks, &0, |file, mark| file.index(mark, usize::MAX))?;
            converting.see_marks();
        }
        file.word(&mut self.eroded.elements)?;
        file.reals([&mut self.eroded.mass, &mut self.eroded.energy, &mut self.eroded.hourglass])?;
        file.real(&mut self.largest_energy)?;
        file.word(&mut self.revision)?;
        self.exchange.archive(file)?;
        self.pushed.archive(file)?;
        self.touched.archive(file)?;
        if file.reads() {
            self.pushes.clear();
            self.find_surface();
            self.count_elements();
        }
        Ok(())
    }
}

impl<const D: usize> Body for ElementBody<D> {
    fn name(&self) -> &str {
        &self.name
    }
    fn law(&self) -> &'static str {
        self.material.name()
    }
    fn is_plane_stress(&self) -> bool {
        self.material.is_plane_stress()
    }
    /// Number of elements, and of nodes with mass of eroded elements.
    fn len(&self) -> usize {
        let elements: usize = self.sets.iter().map(|s| s.alive().count()).sum();
        elements + self.debris.iter().filter(|mass| **mass > 0.0).count()
    }
    fn softens_from(&self, rate: f64) -> Option<f64> {
        mpm_materials::softening::softens_from(&*self.material, rate)
    }
    fn chosen_sound_speed(&self) -> Option<f64> {
        mpm_materials::chosen_sound_speed(&*self.material)
    }
    fn state_names(&self) -> Vec<String> {
        self.material.state_names()
    }
    fn totals(&self) -> Totals {
        ElementBody::totals(self)
    }
    fn given_by_others(&self) -> Option<Exchange> {
        Some(self.pushed)
    }
    fn surface_area(&self) -> Option<f64> {
        let area = |facet| of_nodes(facet, &|n| self.nodes[n as usize].position, self.hoop).0.area;
        (!self.surface.is_empty()).then(|| self.surface.iter().map(area).sum())
    }
    /// Visit the elements, by kind and in computation order, with means over their integration points and nodes; then the nodes with mass
    /// of eroded elements, with numbers beyond those of the elements, without stress.
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.for_each_with(Parts::ALL, visit);
    }
    fn bounds(&self, dimensions: usize, axisymmetric: bool) -> Option<[[f64; 3]; 2]> {
        let mut held = Bounds::default();
        let mut hold = |n: u32| held.hold_place(&wide(&self.nodes[n as usize].position), 0.0);
        for set in &self.sets {
            let points = set.sweep.points();
            for batch in &set.batches {
                let alive = |e: &usize| batch.alive(*e, points);
                if (0..batch.elements).all(|e| alive(&e)) {
                    batch.nodes.iter().for_each(|n| hold(*n));
                } else {
                    (0..batch.elements)
                        .filter(alive)
                        .for_each(|e| set.nodes_of(batch, e).for_each(&mut hold));
                }
            }
        }
        self.for_each_debris(&mut |p| held.hold(p, dimensions, axisymmetric));
        held.corners()
    }
    fn for_each_with(&self, parts: Parts, visit: &mut dyn FnMut(&PointView)) {
        let mut state = vec![0.0; self.virgin.len()];
        let mut point = PointView { state: state.clone(), ..PointView::default() };
        for set in &self.sets {
            for (batch, e, number) in set.alive() {
                self.point(set, batch, (e, number, parts), &mut state, &mut point);
                visit(&point);
            }
        }
        self.for_each_debris(visit);
    }
    fn bytes(&self) -> usize {
        self.sets.iter().map(Set::bytes).sum::<usize>()
            + self.nodes.capacity() * size_of::<crate::Node<D>>()
            + self.mesh.nodes.capacity() * size_of::<[f64; D]>()
            + self.mesh.blocks.iter().map(|b| b.nodes.capacity() * 4).sum::<usize>()
            + self.slots.capacity() * size_of::<crate::sweep::Record>()
            + self.incidence.bytes()
            + (self.averages.capacity() + self.debris.capacity()) * 8
            + self.carried.capacity() * size_of::<Option<[f64; D]>>()
            + self.converting.as_ref().map_or(0, |c| c.bytes())
            + (self.from.capacity() + self.flow.capacity() + self.extents.capacity()) * size_of::<[f64; D]>()
            + self.surface.capacity() * size_of::<impactite_geometry::Facet>()
    }
}
