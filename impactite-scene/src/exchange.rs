//! What a scene was given, and what contact took.

use crate::archive::{Archive, CheckpointError};

/// What a scene exchanged with what is outside of its points since the start of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exchange {
    /// Impulse of the boundaries on the material, N s.
    pub impulse: [f64; 3],
    /// Impulse of body forces and loads, N s.
    pub load: [f64; 3],
    /// Work on the material, J: of boundaries (impulse times the velocity of the boundary: none where that rests), loads and body forces.
    pub work: f64,
    /// Momentum that was dropped, kg m/s: at nodes of a grid too light to carry it.
    pub dropped: [f64; 3],
    /// Work of friction, J, between bodies and on walls: heat that no point gets.
    pub friction: f64,
    /// Kinetic energy that impulses between points, or of points on walls, took beside friction, J: plastic impacts of points.
    pub impacts: f64,
    /// Energy that damping took, J: local damping, kinetic damping, null-space filter.
    pub damping: f64,
    /// Energy that numerical viscosity took, J: of stabilisations whose work no law has. Viscosity of a law heats its points instead.
    pub viscosity: f64,
    /// Energy that came with points split, merged, made or removed, J.
    pub conversion: f64,
    /// Kinetic energy of nodes of a grid that contact took beside friction, J, where forces tear their velocities apart in every
    /// step and contact joins them: more than what the points lose, and so in no balance.
    pub node_contact: f64,
}

impl Exchange {
    /// Add another one.
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
    }

    /// The sum with another one.
    #[must_use]
    pub fn plus(mut self, o: &Exchange) -> Exchange {
        self.add(o);
        self
    }

    /// To a file, or from one.
    ///
    /// # Errors
    /// The file.
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
        } = self;
        let vectors = impulse.iter_mut().chain(load).chain(dropped);
        file.reals(vectors.chain([work, friction, impacts, damping, viscosity, conversion, node_contact]))
    }
}
