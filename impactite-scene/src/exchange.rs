//! Exchange of momentum and energy: boundaries, loads, contact and numerical dissipation.

use crate::archive::{Archive, CheckpointError};

/// Number of accounts of single boundary conditions in an [`Exchange`].
pub const ACCOUNTS: usize = 8;

/// Impulse and work of a boundary condition on the material since the start of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Booking {
    /// Impulse on the material, N s.
    pub impulse: [f64; 3],
    /// Work on the material, J.
    pub work: f64,
}

/// Momentum and energy that a scene exchanged with its surroundings since the start of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exchange {
    /// Impulse of the boundaries on the material, N s.
    pub impulse: [f64; 3],
    /// Impulse of body forces and loads, N s.
    pub load: [f64; 3],
    /// Work on the material, J, of boundaries (impulse times velocity of the boundary: zero at rest), loads and body forces.
    pub work: f64,
    /// Momentum removed at grid nodes with too little mass, kg m/s.
    pub dropped: [f64; 3],
    /// Work of friction between bodies and on walls, J: heat that is not added to a point.
    pub friction: f64,
    /// Kinetic energy lost in plastic impacts of points on points or walls, beside friction, J.
    pub impacts: f64,
    /// Energy dissipated by damping, J: local damping, kinetic damping, null-space filter.
    pub damping: f64,
    /// Energy dissipated by numerical viscosity, J: stabilisations outside of the material laws. The viscosity of a law heats its points
    /// instead.
    pub viscosity: f64,
    /// Energy added by points that were split, merged, created or removed, J.
    pub conversion: f64,
    /// Kinetic energy of grid nodes dissipated by contact beside friction, J. Forces separate the velocities of the bodies at a node in
    /// every step and contact equalises them, so that this is more than the loss of the points. It is in no balance.
    pub node_contact: f64,
    /// Parts of `impulse` and `work` by the boundary conditions with an account ([`BoundaryEntry::with_account`]).
    ///
    /// [`BoundaryEntry::with_account`]: crate::BoundaryEntry::with_account
    pub accounts: [Booking; ACCOUNTS],
}

impl Exchange {
    /// Add another exchange.
    pub fn add(&mut self, o: &Exchange) {
        for d in 0..3 {
            self.impulse[d] += o.impulse[d];
            self.load[d] += o.load[d];
            self.dropped[d] += o.dropped[d];
        }
        self.work += o.work;
        self.friction += o.friction;
        self.impacts += o.impacts;
        self.damping += o.damping;
        self.viscosity += o.viscosity;
        self.conversion += o.conversion;
        self.node_contact += o.node_contact;
        self.add_accounts(1.0, o);
    }

    /// Add a share of the accounts of another exchange.
    pub fn add_accounts(&mut self, share: f64, o: &Exchange) {
        for (booking, other) in self.accounts.iter_mut().zip(&o.accounts) {
            (0..3).for_each(|d| booking.impulse[d] += share * other.impulse[d]);
            booking.work += share * other.work;
        }
    }

    /// Return the sum with another exchange.
    #[must_use]
    pub fn plus(mut self, o: &Exchange) -> Exchange {
        self.add(o);
        self
    }

    /// Write or read the exchange.
    ///
    /// # Errors
    /// I/O error; damaged file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let Exchange {
            impulse,
            load,
            work,
            dropped,
            friction,
            impacts,
            damping,
            viscosity,
            conversion,
            node_contact,
            accounts,
        } = self;
        let vectors = impulse.iter_mut().chain(load).chain(dropped);
        file.reals(vectors.chain([work, friction, impacts, damping, viscosity, conversion, node_contact]))?;
        accounts
            .iter_mut()
            .try_for_each(|booking| file.reals(booking.impulse.iter_mut().chain([&mut booking.work])))
    }
}
