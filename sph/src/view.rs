//! Observer interface of a body.

use impactite_scene::{Body, Parts, PointView, Totals};
use mpm_contact::vector::wide;

use crate::load::Outer;
use crate::method::Composition;
use crate::solver::{HELD, Sph, TOUCHED};
use crate::sums::BATCH;

impl<const D: usize, M: Composition<D>> Sph<D, M> {
    /// Return sums over particles: balanced totals, and their difference to totals at the time of the positions ([`Totals::staggered`]).
    /// The balanced momentum is that of the velocities v- in the middle of the last step. The balanced kinetic energy is the sum of
    /// m v- . v+ / 2, with v+ the velocities half a step after the present by neighbours: central differences conserve its sum with the
    /// internal energy. Velocity components set by conditions count with v- alone.
    pub fn totals(&self) -> Totals {
        let mut sum = Totals::default();
        let outer = self.outer_now();
        for (i, x) in self.positions.iter().enumerate() {
            let (mass, velocity) = (self.mass(i), self.velocity(i));
            let mut lagged = 0.0;
            for d in (0..D).filter(|d| self.held[i] & HELD << d == 0) {
                lagged += self.lag * mass * velocity[d] * self.acceleration[i][d];
            }
            sum.add_staggered(mass, x, [&velocity, &self.velocity_at(i, &outer)], lagged);
        }
        let state = &mut vec![0.0; self.virgin.len()];
        for (i, volume) in self.reference.iter().enumerate() {
            self.batches[i / BATCH].read(i % BATCH, state);
            sum.internal += volume * self.material.energy_of(state).unwrap_or(f64::NAN);
            sum.viscous_heat += volume * self.material.viscous_heat_of(state);
        }
        sum.internal += self.penalty_energy();
        sum
    }

    /// Velocity of a particle at the time of its position, m/s: v = v- + lag a, with the velocity v- in the middle of the last step and the
    /// acceleration a by neighbours and body force. Components set by conditions or contact are those of v-.
    ///
    /// # Panics
    /// There is no such particle.
    pub fn velocity_now(&self, i: usize) -> [f64; D] {
        self.velocity_at(i, &self.outer_now())
    }

    /// Return the external accelerations at the present time.
    fn outer_now(&self) -> Outer<'_, D> {
        let force = self.body_force.as_ref().map_or([0.0; D], |force| force(self.clock.time));
        Outer::new(force, &self.loads, &self.numbers, self.clock.time)
    }

    fn velocity_at(&self, i: usize, outer: &Outer<'_, D>) -> [f64; D] {
        let (v, a, held) = (&self.records.velocity[i], &self.acceleration[i], self.held[i]);
        let force = outer.at(i, v[3]);
        std::array::from_fn(|d| {
            let free = held & (HELD | TOUCHED) << d == 0;
            if free { v[d] + self.lag * (a[d] + force[d]) } else { v[d] }
        })
    }

    /// Internal energy of the law, J, without that of the zero-energy penalty.
    pub fn internal_energy(&self) -> f64 {
        let mut state = vec![0.0; self.virgin.len()];
        let mut sum = 0.0;
        for (i, volume) in self.reference.iter().enumerate() {
            self.batches[i / BATCH].read(i % BATCH, &mut state);
            sum += volume * self.material.energy_of(&state).unwrap_or(f64::NAN);
        }
        sum
    }

    /// Energy of the springs of the zero-energy penalty, J.
    pub fn penalty_energy(&self) -> f64 {
        if !Self::HAS.penalty {
            return 0.0;
        }
        let (records, first) = (&self.records, if D == 2 { 2 } else { 0 });
        let mut sum = 0.0;
        for i in 0..self.positions.len() {
            let batch = &self.batches[i / BATCH];
            let f = &batch.deformation[i % BATCH];
            let (index, slope) = batch.near.of(i % BATCH);
            let (place, now) = (&records.place[i], &records.now[i]);
            let mut own = 0.0;
            for (&j, &s) in index.iter().zip(slope) {
                let (other, there) = (&records.place[j as usize], &records.now[j as usize]);
                let mut square = 0.0;
                for a in 0..D {
                    let mut left = there[first + a] - now[first + a];
                    for c in 0..D {
                        left -= f[a][c] * (other[c] - place[c]);
                    }
                    square += left * left;
                }
                own += s * other[3] * square;
            }
            sum += 0.5 * records.bias[i] * place[3] * own;
        }
        sum
    }

    /// State variables of a particle, named by [`Body::state_names`]; `None` if there is no such particle.
    pub fn particle_state(&self, i: usize) -> Option<Vec<f64>> {
        let mut state = vec![0.0; self.virgin.len()];
        (i < self.positions.len()).then(|| {
            self.batches[i / BATCH].read(i % BATCH, &mut state);
            state
        })
    }

    /// Allocated memory, bytes, by own count.
    pub fn bytes(&self) -> usize {
        let batches: usize = self.batches.iter().map(|b| b.bytes()).sum();
        batches
            + self.records.bytes()
            + self.images.bytes()
            + self.lists.lists().bytes()
            + self.acceleration.capacity() * 32
            + (self.positions.capacity() + self.points.capacity()) * size_of::<[f64; D]>()
            + 8 * (self.reference.capacity() + self.spacing.capacity())
            + 4 * self.numbers.capacity()
            + self.held.capacity()
            + self.skin.bytes()
    }
}

impl<const D: usize, M: Composition<D>> Body for Sph<D, M> {
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
        self.positions.len()
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
        Sph::totals(self)
    }
    /// Visit the particles in sorted order, with the numbers of the layout.
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.for_each_with(Parts::ALL, visit);
    }
    fn for_each_with(&self, parts: Parts, visit: &mut dyn FnMut(&PointView)) {
        let (mut point, outer) = (PointView::default(), self.outer_now());
        point.state.resize(self.virgin.len(), 0.0);
        for (i, x) in self.positions.iter().enumerate() {
            point.number = self.numbers[i] as usize;
            point.position = wide(x);
            point.velocity = wide(&self.velocity_at(i, &outer));
            point.mass = self.mass(i);
            if !parts.size && !parts.law {
                visit(&point);
                continue;
            }
            let batch = &self.batches[i / BATCH];
            batch.read(i % BATCH, &mut point.state);
            let said = self.material.describe_point(&point.state);
            point.volume = self.reference[i] * said.as_ref().map_or(1.0, |said| said.volume_ratio);
            point.stress = said.as_ref().map_or([f64::NAN; 6], |said| said.stress);
            point.in_range = said.as_ref().is_none_or(|said| said.in_range);
            point.failed = said.as_ref().is_some_and(|said| said.failed);
            if let Some(f) = batch.whole(i % BATCH, D) {
                for d in 0..D {
                    for c in 0..D {
                        point.half_edges[d][c] = 0.5 * self.spacing[i] * f[c][d];
                    }
                }
            }
            visit(&point);
        }
    }
    fn bytes(&self) -> usize {
        Sph::bytes(self)
    }
}
