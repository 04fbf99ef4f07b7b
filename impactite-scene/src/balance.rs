//! Balances: what a scene had, has and was given, and energy and momentum that nothing accounts for.

use crate::archive::{Archive, CheckpointError};
use crate::body::Totals;
use crate::exchange::Exchange;

impl Totals {
    /// To a file, or from one.
    ///
    /// # Errors
    /// The file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let Totals { particles, mass, momentum, angular_momentum, momentum_scale, kinetic, internal, .. } =
            self;
        let (viscous_heat, staggered) = (&mut self.viscous_heat, &mut self.staggered);
        file.count(particles)?;
        let rest = [mass, momentum_scale, kinetic, internal, viscous_heat, &mut staggered.energy];
        file.reals(rest.into_iter().chain(momentum).chain(angular_momentum).chain(&mut staggered.momentum))
    }
}

/// The books of a run since their first entry.
#[derive(Clone, Copy, Debug, Default)]
pub struct Books {
    start: Option<(Totals, Exchange)>,
    /// [`Account::energy_scale`], J.
    energy_scale: f64,
    /// The largest sum of m |v| so far, kg m/s.
    momentum_scale: f64,
    /// Largest energy of motion that counts as rest, J; 0 where that is not known.
    rest: f64,
}

/// The books at one time. Per radian in axisymmetric scenes, per metre of depth in plane strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Account {
    /// Kinetic energy of the particles and free rigid bodies, J: the balanced one, see `staggered`.
    pub kinetic: f64,
    /// Internal energy, plastic work and heat included, J.
    pub internal: f64,
    /// Work that boundaries, loads and body forces did on the material since the first entry, J.
    pub work: f64,
    /// Work of friction between bodies and on walls since the first entry, J: heat that no particle gets.
    pub friction: f64,
    /// Kinetic energy that plastic impacts of points took since the first entry, J.
    pub impacts: f64,
    /// Energy that local damping, kinetic damping and the null-space filter took since the first entry, J.
    pub damping: f64,
    /// Energy that numerical viscosity took since the first entry, J: that of stabilisations, which no law has.
    pub viscosity: f64,
    /// Heat of the viscosity of laws since the first entry, J. It is part of the internal energy.
    pub viscous_heat: f64,
    /// Energy that came with points split, merged, made or removed since the first entry, J.
    pub conversion: f64,
    /// Kinetic energy at the time of the positions less `kinetic`, J: [`Staggered::energy`](crate::body::Staggered::energy). 0 of methods whose
    /// velocities and positions belong to one time.
    pub staggered: f64,
    /// Change since the first entry of kinetic + internal - work + friction + impacts + damping + viscosity - conversion, J: what
    /// nothing explains. Negative: the method lost energy, as transfers with a filter (PIC, APIC) and contacts that close do.
    pub unexplained: f64,
    /// Momentum that nothing explains, kg m/s: the change since the first entry less the impulses of boundaries, loads and body
    /// forces and what was dropped at nodes too light. In axisymmetric scenes along the axis only: hoop stresses push outwards.
    pub momentum: [f64; 3],
    /// The largest energy so far, J: kinetic energy, sum of kinetic and internal energy, or work of damping or viscosity.
    pub energy_scale: f64,
    /// The largest sum of m |v| so far, kg m/s.
    pub momentum_scale: f64,
    /// Energy below which nothing moves, J: that of all mass at 1e-6 of the speed of waves. 0 where no look was made yet.
    pub rest: f64,
}

impl Account {
    /// Sum that is constant if energy is conserved, J: kinetic + internal - work + friction + impacts + damping + viscosity -
    /// conversion.
    #[must_use]
    pub fn total(&self) -> f64 {
        let taken = self.friction + self.impacts + self.damping + self.viscosity;
        self.kinetic + self.internal - self.work + taken - self.conversion
    }
    /// `unexplained` over `energy_scale`; 0 where nothing [moves](Account::moves), since that quotient is of rounding alone.
    #[must_use]
    pub fn energy_error(&self) -> f64 {
        energy_error(self.unexplained, self.energy_scale, self.rest)
    }
    /// Was there ever more energy than that of rounding?
    #[must_use]
    pub fn moves(&self) -> bool {
        self.energy_scale > self.rest
    }
    /// Amount of the momentum that nothing explains, kg m/s.
    #[must_use]
    pub fn missing(&self) -> f64 {
        self.momentum.iter().map(|p| p * p).sum::<f64>().sqrt()
    }
}

impl Books {
    /// Enter what there is and what was given since the start of the run. The first entry opens the books.
    pub fn enter(&mut self, now: &Totals, given: &Exchange, axisymmetric: bool) -> Account {
        let (first, before) = *self.start.get_or_insert((*now, *given));
        let [work, friction] = [given.work - before.work, given.friction - before.friction];
        let [impacts, conversion] = [given.impacts - before.impacts, given.conversion - before.conversion];
        let [damping, viscosity] = [given.damping - before.damping, given.viscosity - before.viscosity];
        // An explosive's energies are opposite: their sum says nothing about their size.
        self.energy_scale = self.energy_scale.max((now.kinetic + now.internal).abs()).max(now.kinetic);
        self.energy_scale = self.energy_scale.max(damping.abs()).max(viscosity.abs());
        self.momentum_scale = self.momentum_scale.max(now.momentum_scale);
        let mut momentum = [0.0; 3];
        for d in if axisymmetric { 1..2 } else { 0..3 } {
            let impulses = given.impulse[d] - before.impulse[d] + (given.load[d] - before.load[d]);
            momentum[d] =
                now.momentum[d] - first.momentum[d] - impulses - (given.dropped[d] - before.dropped[d]);
        }
        Account {
            kinetic: now.kinetic,
            internal: now.internal,
            work,
            friction,
            impacts,
            damping,
            viscosity,
            viscous_heat: now.viscous_heat - first.viscous_heat,
            conversion,
            staggered: now.staggered.energy,
            unexplained: now.kinetic + now.internal - work + (friction + impacts + damping + viscosity)
                - conversion
                - first.kinetic
                - first.internal,
            momentum,
            energy_scale: self.energy_scale,
            momentum_scale: self.momentum_scale,
            rest: self.rest,
        }
    }

    /// Enter an energy, J, below which nothing moves; the largest one counts.
    pub fn enter_rest(&mut self, energy: f64) {
        self.rest = self.rest.max(energy);
    }

    /// Was there ever more energy than that of rounding? [`Account::moves`] of the last entry.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.energy_scale > self.rest
    }

    /// Mass at the first entry, kg.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.start.map_or(0.0, |(totals, _)| totals.mass)
    }

    /// The largest energy so far, J, and the largest sum of m |v|, kg m/s.
    #[must_use]
    pub fn scales(&self) -> [f64; 2] {
        [self.energy_scale, self.momentum_scale]
    }

    /// An unexplained energy, J, over the largest energy so far; 0 where nothing [moves](Account::moves).
    #[must_use]
    pub fn energy_error(&self, unexplained: f64) -> f64 {
        energy_error(unexplained, self.energy_scale, self.rest)
    }

    /// Energy below which nothing moves, J; 0 where it is not known yet.
    #[must_use]
    pub fn rest(&self) -> f64 {
        self.rest
    }

    /// To a file, or from one.
    ///
    /// # Errors
    /// The file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.option(&mut self.start, |file, (totals, given)| {
            totals.archive(file)?;
            given.archive(file)
        })?;
        file.reals([&mut self.energy_scale, &mut self.momentum_scale, &mut self.rest])
    }
}

/// `error / scale`. 0 / 0 is 0: nothing is missing of nothing.
#[must_use]
pub fn share(error: f64, scale: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / scale }
}

/// `unexplained` over `scale`, J; 0 where `scale` is of rounding alone, as that of matter at rest.
pub(crate) fn energy_error(unexplained: f64, scale: f64, rest: f64) -> f64 {
    let rests = rest > 0.0 && scale <= rest && !unexplained.is_nan();
    if rests { 0.0 } else { share(unexplained, scale) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_energy_error_of_matter_at_rest_is_none() {
        let mut books = Books::default();
        let totals = |kinetic| Totals { mass: 2.0, kinetic, ..Totals::default() };
        books.enter(&totals(0.0), &Exchange::default(), false);
        let account = books.enter(&totals(1e-20), &Exchange::default(), false);
        assert!(account.moves() && account.energy_error() == 1.0, "nobody said yet what is rest");
        books.enter_rest(1e-6);
        let account = books.enter(&totals(1e-20), &Exchange::default(), false);
        assert!(!account.moves() && account.energy_error() == 0.0 && account.rest == 1e-6);
        let account = books.enter(&totals(1e-3), &Exchange::default(), false);
        assert!(account.moves() && account.energy_error() == 1.0);
        let broken = books.enter(&totals(f64::NAN), &Exchange::default(), false);
        assert!(broken.energy_error().is_nan(), "what is no number is not hidden");
    }
}
