//! Energy balance, and balances of mass and momentum: what loads and conditions do not explain.

use crate::archive::{Archive, CheckpointError};
use crate::body::Totals;
use crate::exchange::Exchange;

impl Totals {
    /// Write or read the totals.
    ///
    /// # Errors
    /// I/O error; damaged file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let Totals { particles, mass, momentum, angular_momentum, momentum_scale, kinetic, internal, .. } =
            self;
        let (viscous_heat, staggered) = (&mut self.viscous_heat, &mut self.staggered);
        file.count(particles)?;
        let rest = [mass, momentum_scale, kinetic, internal, viscous_heat, &mut staggered.energy];
        file.reals(rest.into_iter().chain(momentum).chain(angular_momentum).chain(&mut staggered.momentum))
    }
}

/// Balance of a run since its first entry.
#[derive(Clone, Copy, Debug, Default)]
pub struct Books {
    start: Option<(Totals, Exchange)>,
    /// Largest energy so far ([`Account::energy_scale`]), J.
    energy_scale: f64,
    /// Largest sum of m |v| so far, kg m/s.
    momentum_scale: f64,
    /// Largest kinetic energy that counts as rest, J; 0 if unknown.
    rest: f64,
}

/// Balance at one time. Per radian in axisymmetric scenes, per metre of depth in plane strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Account {
    /// Kinetic energy of the particles and free rigid bodies, J: the balanced one, see `staggered`.
    pub kinetic: f64,
    /// Internal energy, plastic work and heat included, J.
    pub internal: f64,
    /// Work of boundaries, loads and body forces on the material since the first entry, J.
    pub work: f64,
    /// Work of friction between bodies and on walls since the first entry, J: heat that is not added to a particle.
    pub friction: f64,
    /// Kinetic energy lost in plastic impacts of points since the first entry, J.
    pub impacts: f64,
    /// Energy dissipated by local damping, kinetic damping and the null-space filter since the first entry, J.
    pub damping: f64,
    /// Energy dissipated by numerical viscosity since the first entry, J: stabilisations outside of the laws.
    pub viscosity: f64,
    /// Heat of the viscosity of laws since the first entry, J. It is part of the internal energy.
    pub viscous_heat: f64,
    /// Energy added by points that were split, merged, created or removed since the first entry, J.
    pub conversion: f64,
    /// Kinetic energy at the time of the positions minus `kinetic`, J: [`Staggered::energy`](crate::body::Staggered::energy). 0 for methods
    /// whose velocities and positions belong to one time.
    pub staggered: f64,
    /// Energy error, J: change since the first entry of kinetic + internal - work + friction + impacts + damping + viscosity - conversion.
    /// Negative if the method lost energy, as transfers with a filter (PIC, APIC) and closing contacts do.
    pub unexplained: f64,
    /// Momentum error, kg m/s: change since the first entry minus the impulses of boundaries, loads and body forces and the momentum
    /// dropped at nodes with too little mass. In axisymmetric scenes along the axis only, since hoop stresses push outwards.
    pub momentum: [f64; 3],
    /// Largest energy so far, J: kinetic energy, sum of kinetic and internal energy, or work of damping or viscosity.
    pub energy_scale: f64,
    /// Largest sum of m |v| so far, kg m/s.
    pub momentum_scale: f64,
    /// Energy below which the scene is at rest, J: all mass at 1e-6 of the wave speed. 0 before the first check.
    pub rest: f64,
}

impl Account {
    /// Return the sum that is constant if energy is conserved, J: kinetic + internal - work + friction + impacts + damping + viscosity -
    /// conversion.
    #[must_use]
    pub fn total(&self) -> f64 {
        let taken = self.friction + self.impacts + self.damping + self.viscosity;
        self.kinetic + self.internal - self.work + taken - self.conversion
    }
    /// Return `unexplained` over `energy_scale`; 0 if nothing [moves](Account::moves), since that quotient is rounding only.
    #[must_use]
    pub fn energy_error(&self) -> f64 {
        energy_error(self.unexplained, self.energy_scale, self.rest)
    }
    /// True if the largest energy so far exceeds that of rest.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.energy_scale > self.rest
    }
    /// Return the magnitude of the momentum error, kg m/s.
    #[must_use]
    pub fn missing(&self) -> f64 {
        self.momentum.iter().map(|p| p * p).sum::<f64>().sqrt()
    }
}

impl Books {
    /// Enter the totals and the exchange since the start of the run. The first entry opens the balance.
    pub fn enter(&mut self, now: &Totals, given: &Exchange, axisymmetric: bool) -> Account {
        let (first, before) = *self.start.get_or_insert((*now, *given));
        let [work, friction] = [given.work - before.work, given.friction - before.friction];
        let [impacts, conversion] = [given.impacts - before.impacts, given.conversion - before.conversion];
        let [damping, viscosity] = [given.damping - before.damping, given.viscosity - before.viscosity];
        // The energies of an explosive have opposite signs: their sum does not measure their size.
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

    /// Enter an energy below which the scene is at rest, J; the largest one applies.
    pub fn enter_rest(&mut self, energy: f64) {
        self.rest = self.rest.max(energy);
    }

    /// True if the largest energy so far exceeds that of rest: [`Account::moves`] of the last entry.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.energy_scale > self.rest
    }

    /// Mass at the first entry, kg.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.start.map_or(0.0, |(totals, _)| totals.mass)
    }

    /// Return the largest energy so far, J, and the largest sum of m |v|, kg m/s.
    #[must_use]
    pub fn scales(&self) -> [f64; 2] {
        [self.energy_scale, self.momentum_scale]
    }

    /// Return an unexplained energy, J, over the largest energy so far; 0 if nothing [moves](Account::moves).
    #[must_use]
    pub fn energy_error(&self, unexplained: f64) -> f64 {
        energy_error(unexplained, self.energy_scale, self.rest)
    }

    /// Energy below which the scene is at rest, J; 0 if unknown.
    #[must_use]
    pub fn rest(&self) -> f64 {
        self.rest
    }

    /// Write or read the balance.
    ///
    /// # Errors
    /// I/O error; damaged file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.option(&mut self.start, |file, (totals, given)| {
            totals.archive(file)?;
            given.archive(file)
        })?;
        file.reals([&mut self.energy_scale, &mut self.momentum_scale, &mut self.rest])
    }
}

/// Return `error / scale`, with 0 / 0 = 0.
#[must_use]
pub fn share(error: f64, scale: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / scale }
}

/// Return `unexplained` over `scale` (both J); 0 if `scale` is at most `rest`, so that it is rounding only.
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
