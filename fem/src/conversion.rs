//! Conversion of elements to particles by a coupling: removal from the mesh.

use impactite_geometry::{ElementKind, ElementMesh, Facet};
use impactite_scene::SceneError;
use impactite_scene::error::parameter;

use crate::body::ElementBody;
use crate::erosion::{Criterion, test};
use crate::leaving::{ConvertedElement, Converting};
use crate::set::wide;
use crate::solver::Fem;
use crate::sweep::{BATCH, Left};

/// Maximum number of facets of an element.
const MOST_FACETS: usize = 6;

/// Find the neighbour across each facet of each element.
fn beyond<const D: usize>(mesh: &ElementMesh<D>, elements: usize) -> Vec<Option<(u32, u8)>> {
    let (mut keyed, mut number) = (Vec::new(), 0);
    for block in &mesh.blocks {
        for nodes in block.elements() {
            for (n, places) in block.kind.facets().iter().enumerate() {
                let mut key = [Facet::NONE; 4];
                key.iter_mut().zip(*places).for_each(|(to, &place)| *to = nodes[place]);
                key.sort_unstable();
                keyed.push((key, (number, n as u8)));
            }
            number += 1;
        }
    }
    keyed.sort_unstable();
    let mut beyond = vec![None; elements * MOST_FACETS];
    for pair in keyed.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 2) {
        for (here, there) in [(pair[0].1, pair[1].1), (pair[1].1, pair[0].1)] {
            beyond[here.0 as usize * MOST_FACETS + here.1 as usize] = Some(there);
        }
    }
    beyond
}

impl<const D: usize> Fem<D> {
    /// Enable conversion of elements of a body: at the end of a step, elements that satisfy one of these criteria, or are marked
    /// ([`ElementBody::mark`]), leave the mesh with their mass, momentum and energy. The caller must collect them
    /// ([`ElementBody::take_converted`]).
    ///
    /// # Errors
    /// No such body; a body with criteria already, or with bars; criteria on state variables that its law does not have.
    pub fn convert_by(&mut self, body: usize, criteria: &[Criterion]) -> Result<(), SceneError> {
        let there = body < self.bodies.len();
        parameter(there, "conversion", "body", body as f64, "the number of a body of the scene")?;
        let body = &mut self.bodies[body];
        let refuse = |why| {
            let what = format!("conversion of the elements of `{}`", body.name);
            Err(SceneError::NotWith { what, method: "a body of elements".into(), why })
        };
        if body.converting.is_some() {
            return refuse("it has its criteria");
        }
        if body.sets.iter().any(|set| set.kind == ElementKind::Bar2) {
            return refuse("bars have no volume that particles could fill");
        }
        let names = body.material.state_names();
        let tests = criteria.iter().map(|c| test(c, &names, body.material.name(), "conversion"));
        let tests = tests.collect::<Result<Vec<_>, _>>()?;
        let beyond = beyond(&body.mesh, body.elements);
        body.converting = Some(Box::new(Converting { tests, beyond, ..Converting::default() }));
        body.count_elements();
        Ok(())
    }

    /// Convert the marked elements at once, before a run, instead of at the end of the next step.
    pub fn convert_marked(&mut self) {
        let (team, memory) = (self.team.clone(), self.memory.clone());
        for body in self.bodies.iter_mut().filter(|b| b.converting.is_some()) {
            body.forces_of_states(&team, &memory);
        }
    }
}

impl<const D: usize> ElementBody<D> {
    /// Mark an element for conversion by the criterion of this number, at the end of the next step.
    ///
    /// # Panics
    /// There is no such element, or conversion of the body is not enabled ([`Fem::convert_by`]).
    pub fn mark(&mut self, element: usize, criterion: usize) {
        assert!(element < self.elements, "element {element} of {}", self.elements);
        let converting = self.converting.as_mut().expect("a body whose elements leave");
        converting.marks.resize(self.elements, 0);
        converting.marks[element] = criterion as u32 + 1;
        converting.marked = true;
    }

    /// Take the elements converted since the last call, sorted by number.
    pub fn take_converted(&mut self) -> Vec<ConvertedElement<D>> {
        let mut left = self.converting.as_mut().map_or(Vec::new(), |c| std::mem::take(&mut c.left));
        left.sort_by_key(|element| element.number);
        left
    }

    /// Book energy gained or lost in the conversion of elements, J, as conversion.
    pub fn book_conversion(&mut self, joules: f64) {
        self.exchange.conversion += joules;
    }

    /// Number of elements at a node; zero if conversion of the body is not enabled.
    pub fn elements_at(&self, node: usize) -> usize {
        self.converting.as_ref().map_or(0, |c| c.elements_at.get(node).map_or(0, |&n| n as usize))
    }

    /// True if conversion of the body is enabled ([`Fem::convert_by`]) and the element was not removed.
    pub fn is_there(&self, element: usize) -> bool {
        self.converting.as_ref().is_some_and(|c| c.gone.get(element) == Some(&false))
    }

    /// Number in the body of the element of a facet.
    pub fn element_of(&self, facet: &Facet) -> usize {
        let before: usize = self.mesh.blocks[..facet.block as usize].iter().map(|block| block.len()).sum();
        before + facet.element as usize
    }

    /// Update the surface after the removal of elements; the result equals that of [`find_surface`](Self::find_surface).
    pub(crate) fn uncover(&mut self, left: &[u32]) {
        let Some(mut converting) = self.converting.take() else { return self.find_surface() };
        left.iter().for_each(|&number| converting.gone[number as usize] = true);
        let starts: Vec<u32> = self
            .mesh
            .blocks
            .iter()
            .scan(0, |sum, block| Some(std::mem::replace(sum, *sum + block.len() as u32)))
            .collect();
        let mut keyed: Vec<((u32, u8), Facet)> = Vec::with_capacity(self.surface.len());
        for facet in &self.surface {
            let number = starts[facet.block as usize] + facet.element;
            if converting.gone[number as usize] {
                continue;
            }
            let block = &self.mesh.blocks[facet.block as usize];
            let nodes = &block.nodes[facet.element as usize * block.kind.nodes()..][..block.kind.nodes()];
            let is = |places: &&[usize]| places.iter().map(|&p| nodes[p]).eq(facet.nodes().iter().copied());
            let n = block.kind.facets().iter().position(is).unwrap_or(0);
            keyed.push(((number, n as u8), *facet));
        }
        // Facets of remaining neighbours become surface facets.
        for &number in left {
            for (there, n) in
                converting.beyond[number as usize * MOST_FACETS..][..MOST_FACETS].iter().flatten().copied()
            {
                if converting.gone[there as usize] {
                    continue;
                }
                let b = starts.partition_point(|&start| start <= there) - 1;
                let (block, element) = (&self.mesh.blocks[b], there - starts[b]);
                let nodes = &block.nodes[element as usize * block.kind.nodes()..][..block.kind.nodes()];
                let mut facet = Facet { nodes: [Facet::NONE; 4], block: b as u32, element };
                let places = block.kind.facets()[n as usize];
                facet.nodes.iter_mut().zip(places).for_each(|(to, &place)| *to = nodes[place]);
                keyed.push(((there, n), facet));
            }
        }
        keyed.sort_unstable_by_key(|(key, _)| *key);
        self.surface = keyed.into_iter().map(|(_, facet)| facet).collect();
        self.converting = Some(converting);
    }

    pub(crate) fn count_elements(&mut self) {
        let Some(mut converting) = self.converting.take() else { return };
        converting.elements_at.clear();
        converting.elements_at.resize(self.nodes.len(), 0);
        converting.gone.clear();
        converting.gone.resize(self.elements, true);
        for set in &self.sets {
            for (batch, e, number) in set.alive() {
                converting.gone[number as usize] = false;
                set.nodes_of(batch, e).for_each(|n| converting.elements_at[n as usize] += 1);
            }
        }
        self.converting = Some(converting);
    }

    /// Convert an element of a set: subtract its mass from its nodes; a node without elements keeps only the mass of eroded ones.
    pub(crate) fn convert(&mut self, s: usize, b: usize, left: Left, criterion: u32) {
        let Some(mut converting) = self.converting.take() else { return };
        let (set, e) = (&self.sets[s], left.element);
        let batch = &set.batches[b];
        let nodes: Vec<u32> = set.nodes_of(batch, e).collect();
        let rest: Vec<[f64; D]> = nodes.iter().map(|&n| self.mesh.nodes[n as usize]).collect();
        let measure = set.sweep.measure(&rest.iter().map(wide).collect::<Vec<_>>());
        let masses: Vec<f64> = measure.shares.iter().map(|share| share * self.probe.density).collect();
        let (points, mut states) = (set.sweep.points(), Vec::new());
        let mut state = vec![0.0; self.virgin.len()];
        for point in 0..points {
            batch.read(e, (point, points), &mut state);
            states.extend_from_slice(&state);
        }
        let number = set.numbers[b * BATCH + e] as usize;
        let of = |value: &dyn Fn(&crate::Node<D>) -> [f64; D]| -> Vec<[f64; D]> {
            nodes.iter().map(|&n| value(&self.nodes[n as usize])).collect()
        };
        let (positions, velocities) = (of(&|n| n.position), of(&|n| n.velocity));
        for (&n, mass) in nodes.iter().zip(&masses) {
            let (n, node) = (n as usize, &mut self.nodes[n as usize]);
            node.mass -= mass;
            converting.elements_at[n] -= 1;
            if converting.elements_at[n] == 0 {
                // The remaining mass is rounding, or that of eroded elements.
                node.mass = self.debris.get(n).copied().unwrap_or(0.0);
                if node.mass == 0.0 {
                    (node.velocity, node.held) = ([0.0; D], 0);
                }
            }
        }
        if let Some(mark) = converting.marks.get_mut(number) {
            *mark = 0;
        }
        let (kind, volumes, criterion) = (set.kind, measure.volumes, criterion as usize);
        let Left { energy, hourglass, .. } = left;
        converting.left.push(ConvertedElement {
            number,
            kind,
            criterion,
            nodes,
            rest,
            positions,
            velocities,
            masses,
            volumes,
            states,
            energy,
            hourglass,
        });
        self.converting = Some(converting);
    }
}
