//! Solvers in the plane behind one interface: schemes chosen at run time, compiled once, here.

use mpm_core::geometry::{Lattice, Seeds};
use mpm_core::step::SceneError;
use mpm_core::{
    BlockGrid, Body, Boundary, Deformable, FieldForce, Mpm, PlaneStrain, StepError, Team, TimeControl,
    Totals, Watch,
};
use mpm_materials::fluid::FluidState;
use mpm_materials::{BulkViscosity, Fluid, IdealGas, Inviscid, NeoHookean, Nothing};

use crate::scene::Drive;
use crate::scheme::{Kernel, Scheme, Velocity, kernels};

/// Ideal gas with bulk viscosity.
pub type Gas = Fluid<IdealGas<f64>, Inviscid, BulkViscosity<f64>>;

/// State of the gas: volume over reference volume, energy per reference volume (J/m^3).
pub type GasState = FluidState<f64, f64, Nothing, f64>;

/// A solver in plane strain, bodies of rubber.
pub trait Machine {
    /// Add a body with an initial velocity (m/s) and, if any, an acceleration (m/s^2) by where a particle started.
    ///
    /// # Errors
    /// As [`Mpm::add_body`].
    fn add(
        &mut self,
        name: &str,
        law: NeoHookean<f64>,
        seeds: &Seeds<2>,
        velocity: &dyn Fn([f64; 2]) -> [f64; 2],
        drive: Option<Drive<2>>,
    ) -> Result<(), SceneError>;
    /// Add a boundary.
    ///
    /// # Errors
    /// As [`Mpm::bound`].
    fn bound(&mut self, boundary: Boundary<2>) -> Result<(), SceneError>;
    /// Choose the time step.
    ///
    /// # Errors
    /// As [`Mpm::set_time_control`].
    fn control(&mut self, control: TimeControl) -> Result<(), SceneError>;
    /// Choose the threads.
    fn team(&mut self, team: Team);
    /// Make a step, and say how long it was, s.
    ///
    /// # Errors
    /// What stopped it.
    fn step(&mut self) -> Result<f64, StepError>;
    /// Time, s.
    fn time(&self) -> f64;
    /// The bodies.
    fn bodies(&self) -> &[Box<dyn Body<f64, 2>>];
    /// Totals over all particles.
    fn totals(&self) -> Totals;
    /// Memory, grid and scratch included, bytes.
    fn bytes(&self) -> usize;
}

impl Machine for Mpm<2> {
    fn add(
        &mut self,
        name: &str,
        law: NeoHookean<f64>,
        seeds: &Seeds<2>,
        velocity: &dyn Fn([f64; 2]) -> [f64; 2],
        drive: Option<Drive<2>>,
    ) -> Result<(), SceneError> {
        let mut body = Deformable::new(name, law, seeds).moving(velocity);
        if let Some(acceleration) = drive {
            body = body.with_field_force(FieldForce { acceleration });
        }
        self.add_body(body)
    }
    fn bound(&mut self, boundary: Boundary<2>) -> Result<(), SceneError> {
        Mpm::bound(self, boundary)
    }
    fn control(&mut self, control: TimeControl) -> Result<(), SceneError> {
        self.set_time_control(control)
    }
    fn team(&mut self, team: Team) {
        self.set_team(team);
    }
    fn step(&mut self) -> Result<f64, StepError> {
        Mpm::step(self)
    }
    fn time(&self) -> f64 {
        Mpm::time(self)
    }
    fn bodies(&self) -> &[Box<dyn Body<f64, 2>>] {
        Mpm::bodies(self)
    }
    fn totals(&self) -> Totals {
        Mpm::totals(self)
    }
    fn bytes(&self) -> usize {
        Mpm::bytes(self)
    }
}

/// A solver in plane strain, bodies of gas.
pub trait GasMachine: Machine {
    /// Add a body of gas with an initial velocity (m/s) and state by position (m).
    ///
    /// # Errors
    /// As [`Mpm::add_body`].
    fn add_gas(
        &mut self,
        name: &str,
        law: Gas,
        seeds: &Seeds<2>,
        velocity: &dyn Fn([f64; 2]) -> [f64; 2],
        state: &dyn Fn([f64; 2]) -> GasState,
    ) -> Result<(), SceneError>;
}

impl GasMachine for Mpm<2> {
    fn add_gas(
        &mut self,
        name: &str,
        law: Gas,
        seeds: &Seeds<2>,
        velocity: &dyn Fn([f64; 2]) -> [f64; 2],
        state: &dyn Fn([f64; 2]) -> GasState,
    ) -> Result<(), SceneError> {
        self.add_body(Deformable::new(name, law, seeds).moving(velocity).in_state(state))
    }
}

/// A solver of a scheme on an empty lattice; `None` if there is no such scheme.
pub fn machine(scheme: Scheme, lattice: Lattice<2>) -> Option<Box<dyn Machine>> {
    Some(Box::new(empty(scheme, lattice)?))
}

fn empty(scheme: Scheme, lattice: Lattice<2>) -> Option<Mpm<2>> {
    let mut mpm = Mpm::new(kernels::<PlaneStrain, 2>(scheme)?, BlockGrid::new(lattice));
    // Where and how schemes fail is what such runs measure, to their end.
    mpm.set_watch(Watch::off());
    Some(mpm)
}

/// The schemes that gas is run by.
pub fn gas_schemes() -> Vec<Scheme> {
    vec![
        Scheme::moving(Kernel::Linear, Velocity::FlipMusl),
        Scheme::moving(Kernel::CpGimp, Velocity::FlipUsl),
        Scheme::moving(Kernel::Quadratic, Velocity::FlipUsl),
        Scheme::moving(Kernel::Quadratic, Velocity::ApicUsl),
        Scheme::moving(Kernel::Quadratic, Velocity::Fmpm4Usl),
        Scheme::moving(Kernel::Cubic, Velocity::ApicUsl),
    ]
}

/// A solver of a scheme for gas; `None` if it is none of [`gas_schemes`].
pub fn gas_machine(scheme: Scheme, lattice: Lattice<2>) -> Option<Box<dyn GasMachine>> {
    if !gas_schemes().contains(&scheme) {
        return None;
    }
    Some(Box::new(empty(scheme, lattice)?))
}
