//! Observer interface of a body, and checkpoints.

use impactite_scene::constants::over;
use impactite_scene::{Archive, Body, CheckpointError, Parts, PointView, Totals};

use crate::method::Composition;
use crate::open::OpenFace;
use crate::solver::{Fpm, HELD, TOUCHED};
use crate::step::wide;
use crate::sums::{BATCH, Batch};
use crate::vector::{along, apply, cofactor, difference, norm, scaled, with_identity, zero};

impl<const D: usize, M: Composition<D>> Fpm<D, M> {
    /// Return sums over cells: balanced totals, and their difference to totals at the time of the positions ([`Totals::staggered`]). The
    /// balanced momentum is that of the velocities v- in the middle of the last step. The balanced kinetic energy is the sum of
    /// m v- . v+ / 2, with v+ the velocities half a step after the present by faces: central differences conserve its sum with the internal
    /// energy. Velocity components set by conditions count with v- alone.
    pub fn totals(&self) -> Totals {
        let mut sum = Totals::default();
        let force = self.force_now();
        for i in 0..self.reference.len() {
            let velocities: [&[f64]; 2] = [&self.velocity[i], &self.velocity_at(i, &force)];
            sum.add_staggered(self.mass[i], &self.position(i), velocities, self.forced(i));
        }
        let state = &mut vec![0.0; self.virgin.len()];
        for (i, volume) in self.volume.iter().enumerate() {
            self.batches[i / BATCH].read(i % BATCH, state);
            sum.internal += volume * self.material.energy_of(state).unwrap_or(f64::NAN);
            sum.viscous_heat += volume * self.material.viscous_heat_of(state);
        }
        sum.internal += self.penalty_energy() + self.stored_in_cracks();
        sum
    }

    /// Velocity of a point at the time of its position, m/s: v = v- + lag a, with the velocity v- in the middle of the last step and the
    /// acceleration a by faces and body force. Components set by conditions or contact are those of v-.
    ///
    /// # Panics
    /// There is no such point.
    pub fn velocity_now(&self, i: usize) -> [f64; D] {
        self.velocity_at(i, &self.force_now())
    }

    /// Return the present acceleration of the body force, m/s^2.
    fn force_now(&self) -> [f64; D] {
        self.body_force.as_ref().map_or([0.0; D], |force| force(self.clock.time))
    }

    fn velocity_at(&self, i: usize, force: &[f64; D]) -> [f64; D] {
        let (v, a, held) =
            (&self.velocity[i], &self.acceleration[i], self.batches[i / BATCH].held[i % BATCH]);
        std::array::from_fn(|d| {
            let free = held & (HELD | TOUCHED) << d == 0;
            if free { v[d] + self.lag * (a[d] + force[d]) } else { v[d] }
        })
    }

    /// Force-dependent part of the staggered kinetic energy, (m/2) v- . (v+ - v-), J.
    pub(crate) fn forced(&self, i: usize) -> f64 {
        let held = self.batches[i / BATCH].held[i % BATCH];
        let free = (0..D).filter(|d| held & HELD << d == 0);
        free.map(|d| self.lag * self.mass[i] * self.velocity[i][d] * self.acceleration[i][d]).sum()
    }

    /// Internal energy of the law, J, without that of the penalty.
    pub fn internal_energy(&self) -> f64 {
        let mut state = vec![0.0; self.virgin.len()];
        let mut sum = 0.0;
        for (i, volume) in self.volume.iter().enumerate() {
            self.batches[i / BATCH].read(i % BATCH, &mut state);
            sum += volume * self.material.energy_of(&state).unwrap_or(f64::NAN);
        }
        sum
    }

    /// Energy of the penalty on jumps, J.
    pub fn penalty_energy(&self) -> f64 {
        self.batches.iter().map(|b| b.report.penalty).sum()
    }

    /// Energy in cohesive faces and closed cracks, J.
    pub fn stored_in_cracks(&self) -> f64 {
        self.cracks.iter().map(|c| c.stored).sum()
    }

    /// Displacement gradients of the laws, in sorted order.
    pub fn gradients(&self) -> Vec<[[f64; D]; D]> {
        self.batches.iter().flat_map(|b| &b.gradient).copied().collect()
    }

    /// Displacement by the trial function of a cell at a place of the reference configuration, m.
    ///
    /// # Panics
    /// There is no such cell.
    pub fn displacement_at(&self, i: usize, x: [f64; D]) -> [f64; D] {
        self.traces[i].at(&difference(&x, &self.reference[i]))
    }

    /// State variables of a cell, named by [`Body::state_names`]; `None` if there is no such cell.
    pub fn cell_state(&self, i: usize) -> Option<Vec<f64>> {
        let mut state = vec![0.0; self.virgin.len()];
        (i < self.reference.len()).then(|| {
            self.batches[i / BATCH].read(i % BATCH, &mut state);
            state
        })
    }

    /// Allocated memory, bytes, by own count.
    pub fn bytes(&self) -> usize {
        let batches: usize = self.batches.iter().map(Batch::bytes).sum();
        let vectors = 4 * self.reference.capacity();
        let tensors = self.traces.capacity() + self.stress.capacity() + self.loads.capacity();
        batches
            + self.sides.bytes()
            + 8 * D * (vectors + D * tensors + 2 * self.traces.capacity())
            + 16 * self.volume.capacity()
            + self.faces.capacity() * size_of::<crate::Face<D>>()
            + self.surface.capacity() * size_of::<crate::OuterFace<D>>()
            + self.cracks.capacity() * size_of::<OpenFace<D>>()
            + self.softening.bytes()
            + 4 * self.numbers.capacity()
    }

    /// Store the body in a checkpoint, or load it: method, law, conditions and state; as
    /// [`Solver::archive`](impactite_scene::Solver::archive), but without the watch.
    pub(crate) fn archive_body(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let name = self.name.clone();
        let of = |what: &str| format!("{what} of body `{name}`");
        file.same(&of("method"), &self.method.describe())?;
        file.same(&of("ingredients"), &format!("{:?}", self.method))?;
        file.same(&of("law"), self.material.name())?;
        file.same(&of("constants of the law"), &self.material.constants())?;
        file.same(&of("number of cells"), &self.reference.len().to_string())?;
        file.same(&of("number of faces"), &self.faces.len().to_string())?;
        file.same(&of("friction of cracks"), &self.friction.to_string())?;
        self.clock.archive(file)?;
        let times = [0.0, self.clock.time];
        let force = self.body_force.as_ref().map(|force| over(times, |t| force(t)));
        file.same(&of("body force"), &force.unwrap_or_default())?;
        file.same(&of("local damping"), &format!("{:?}", self.damping.coefficient()))?;
        self.boundaries.archive(file, times, &of)?;
        file.same(&of("number of loads"), &self.acting.len().to_string())?;
        for (n, load) in self.acting.iter_mut().enumerate() {
            load.archive(file, &format!("load {n} of body `{name}`"), self.clock.time)?;
        }
        let mut middle = [0.0; D];
        self.reference.iter().for_each(|x| middle = along(&middle, 1.0, x));
        file.same(&of("sum of the places of cells"), &format!("{middle:?}"))?;
        for list in [&mut self.displacement, &mut self.velocity] {
            file.reals(list.iter_mut().flatten())?;
        }
        for batch in &mut self.batches {
            archive_batch(batch, file)?;
        }
        self.archive_cracks(file)?;
        file.reals([&mut self.rate, &mut self.sharpness, &mut self.lag, &mut self.dissipated])?;
        self.exchange.archive(file)?;
        if file.reads() {
            self.go_on();
        }
        Ok(())
    }

    fn archive_cracks(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let mut count = self.cracks.len();
        file.count(&mut count)?;
        for n in 0..count {
            let mut face = self.cracks.get(n).map_or(0, |c| c.face);
            file.index(&mut face, self.faces.len())?;
            if n == self.cracks.len() {
                let cells = self.faces[face as usize].cells;
                let surface = self.sides.surface[self.side_of(face, cells[0])];
                self.note_crack(OpenFace::notch(face, cells, surface, self.contact_modulus()));
            }
            self.cracks[n].archive(file)?;
            self.faces[face as usize].open = !self.cracks[n].softens;
        }
        Ok(())
    }
}

fn archive_batch<const D: usize>(batch: &mut Batch<D>, file: &mut Archive) -> Result<(), CheckpointError> {
    for row in &mut batch.rows {
        file.reals(row.as_mut())?;
    }
    file.reals(batch.said.iter_mut().flatten())?;
    file.reals(batch.gradient.iter_mut().flatten().flatten())?;
    for held in &mut batch.held {
        let mut bits = u64::from(*held);
        file.word(&mut bits)?;
        *held = bits as u16;
    }
    for list in [&mut batch.rigid, &mut batch.jumps] {
        file.list(list, &(0, zero()), |file, (n, h)| {
            file.index(n, BATCH)?;
            file.reals(h.iter_mut().flatten())
        })?;
    }
    Ok(())
}

impl<const D: usize, M: Composition<D>> Body for Fpm<D, M> {
    fn name(&self) -> &str {
        &self.name
    }
    fn law(&self) -> &'static str {
        self.material.name()
    }
    fn is_plane_stress(&self) -> bool {
        self.material.is_plane_stress()
    }
    fn len(&self) -> usize {
        self.reference.len()
    }
    fn softens_from(&self, rate: f64) -> Option<f64> {
        mpm_materials::softening::softens_from(&*self.material, rate)
    }
    fn state_names(&self) -> Vec<String> {
        self.material.state_names()
    }
    fn totals(&self) -> Totals {
        Fpm::totals(self)
    }
    /// Area of the outer faces, and of both sides of open ones: Nanson's formula with the deformation gradients of their cells.
    fn surface_area(&self) -> Option<f64> {
        let area = |cell: u32, of: &[f64; D]| {
            norm(&apply(&cofactor(&with_identity(&self.traces[cell as usize].h)), of))
        };
        let outer: f64 = self.surface.iter().map(|f| area(f.cell, &scaled(&f.normal, f.area))).sum();
        let open = self.cracks.iter().filter(|crack| !crack.softens);
        let sides = open.flat_map(|crack| crack.cells.map(|cell| area(cell, &crack.surface.area)));
        Some(outer + sides.sum::<f64>())
    }
    /// Visit the cells in sorted order, with the numbers of their [`Cells`](crate::Cells).
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.for_each_with(Parts::ALL, visit);
    }
    fn for_each_with(&self, parts: Parts, visit: &mut dyn FnMut(&PointView)) {
        let (mut point, force) = (PointView::default(), self.force_now());
        point.state.resize(self.virgin.len(), 0.0);
        for (i, trace) in self.traces.iter().enumerate() {
            point.number = self.numbers[i] as usize;
            point.position = wide(&self.position(i));
            point.velocity = wide(&self.velocity_at(i, &force));
            point.mass = self.mass[i];
            let of = |x: &[f64; D]| wide(&along(x, 1.0, &trace.at(&difference(x, &self.reference[i]))));
            point.corners.clear();
            point.corners.extend(self.corners[i].iter().map(of));
            if !parts.size && !parts.law {
                visit(&point);
                continue;
            }
            let batch = &self.batches[i / BATCH];
            batch.read(i % BATCH, &mut point.state);
            let said = self.material.describe_point(&point.state);
            point.volume = self.volume[i] * said.as_ref().map_or(1.0, |said| said.volume_ratio);
            point.stress = said.as_ref().map_or([f64::NAN; 6], |said| said.stress);
            point.in_range = said.as_ref().is_none_or(|said| said.in_range);
            point.failed = said.as_ref().is_some_and(|said| said.failed);
            let (f, half) = (with_identity(&trace.h), 0.5 * self.sizes[i]);
            for d in 0..D {
                for c in 0..D {
                    point.half_edges[d][c] = half * f[c][d];
                }
            }
            visit(&point);
        }
    }
    fn bytes(&self) -> usize {
        Fpm::bytes(self)
    }
}
