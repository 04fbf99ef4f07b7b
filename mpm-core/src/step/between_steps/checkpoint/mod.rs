//! Checkpoints: interrupted runs that are resumed.
//!
//! A checkpoint contains all that changes in a run: particles in their order, with their map to the grid; rigid
//! bodies; clocks and books; contact memory. A run is resumed by a scene that is set up as at its start: its
//! properties (method, laws with their constants, loads, boundaries, contact) are compared with those in the
//! checkpoint, and the error names a difference; time control and watch may differ. The resumed run makes the steps
//! of the original one, bit for bit, with any number of threads and any grid.

mod bodies;
mod constants;
mod contact;

use std::path::Path;

use impactite_scene::{Archive, CheckpointError, Solver};

use super::rest::KineticDamping;
use crate::step::mpm::Mpm;
use impactite_simd::Float;

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Write a checkpoint to the file `path`, which contains the old or the new one at any time, never a part
    /// ([`WholeFile`](impactite_output::WholeFile)).
    ///
    /// # Errors
    /// A path that is not a regular file; a file that cannot be written; a stopped run. The old file is kept.
    pub fn save(&mut self, path: impl AsRef<Path>) -> Result<(), CheckpointError> {
        Solver::save(self, path.as_ref())
    }

    /// Restore the state that was saved to `path` in this scene, which is set up as the saved one was at its start.
    /// The time control may differ. Observers begin again: let them write to another folder.
    ///
    /// ```
    /// # use mpm_core::{BlockGrid, Flip, Linear, Method, Mpm, Musl, PlaneStrain, geometry::*};
    /// # use mpm_materials::{LinearElastic, Moduli};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let lattice = Lattice::new([0.0; 2], 0.25)?;
    /// # let seeds = fill(&Cuboid::new([0.0; 2], [1.0, 1.0])?, &lattice, 2, &Filling::new())?;
    /// # let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.3)?)?;
    /// # let file = std::env::temp_dir().join("impactite-doc-checkpoint");
    /// # let scene = || -> Result<_, Box<dyn std::error::Error>> {
    /// # let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    /// # mpm.add("block", law, &seeds, |x| [0.1 * x[0], 0.0])?;
    /// # Ok(mpm) };
    /// let mut mpm = scene()?;
    /// mpm.run_until(1.0)?;
    /// mpm.save(&file)?;
    /// // Perhaps in another process:
    /// let mut again = scene()?.resumed(&file)?;
    /// assert_eq!(again.time(), mpm.time());
    /// # mpm.run_until(2.0)?;
    /// again.run_until(2.0)?;
    /// # assert_eq!(again.totals(), mpm.totals());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// A file that cannot be read or is damaged; another scene, by method, lattice, precision, contact, boundaries
    /// (functions of time by their values at the start and at the time of the checkpoint), loads, bodies, the
    /// constants of their laws or sizes of their particles; a grid with too little space.
    pub fn resumed(mut self, path: impl AsRef<Path>) -> Result<Self, CheckpointError> {
        Solver::resume(&mut self, path.as_ref())?;
        Ok(self)
    }

    pub(in crate::step) fn archive_here(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.recognise(file)?;
        self.archive_levels(file)?;
        self.clock.archive(file)?;
        self.compare_constants(file)?;
        file.numbers([&mut self.stepper.planned, &mut self.stepper.rate])?;
        file.option(&mut self.stepper.gershgorin, |file, (step, rate)| {
            file.word(step)?;
            file.real(rate)
        })?;
        file.option(&mut self.between_steps.kinetic_damping, |file, KineticDamping { most, now, stops }| {
            file.reals([most, now])?;
            file.word(stops)
        })?;
        file.flag(&mut self.stepper.mapped)?;
        self.ledger.archive(file)?;
        file.reals(self.stepper.acting.numbers_mut())?;
        for body in &mut self.scene.bodies {
            body.archive(file)?;
        }
        self.looks.watcher.archive(file)?;
        file.list(&mut self.looks.parts, &0, Archive::word)?;

        file.word(&mut self.grid.arranged)?;
        file.flag(&mut self.grid.ahead)?;
        self.grid.fields.exchange(file, self.scene.bodies.len())?;
        if file.reads() {
            let settled = self.grid.settle(&mut self.scene);
            settled.map_err(|outside| CheckpointError::NoRoom(outside.to_string()))?;
            self.arrange_planes();
        }
        self.have_walls();
        self.grid.walls.iter_mut().try_for_each(|wall| wall.archive(file))?;
        self.grid.contact.exchange(file, &self.grid.fields, self.scene.contact.remembers())?;
        self.hooks.archive(file)
    }

    /// Check that the file is of a scene like this one.
    fn recognise(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.same("bytes of a number", &size_of::<T>().to_string())?;
        file.same("lattice", &format!("{:?}", self.grid.lattice()))?;
        file.same(
            "kinetic damping",
            if self.between_steps.kinetic_damping.is_some() { "on" } else { "off" },
        )?;
        file.same(
            "null-space filter",
            &format!("{:?}", self.between_steps.filter.map(|filter| filter.every)),
        )?;
        file.same("number of bodies", &self.scene.bodies.len().to_string())?;
        for (n, body) in self.scene.bodies.iter().enumerate() {
            file.same(&format!("name of body {n}"), body.name())?;
            file.same(&format!("law of body `{}`", body.name()), body.law())?;
            let renewed = if body.renewed().is_some() { ", renewed density" } else { "" };
            let columns =
                format!("{} bytes, {}{renewed}", body.particle_bytes(), body.state_names().join(", "));
            file.same(&format!("particle of body `{}`", body.name()), &columns)?;
            let kind =
                body.rigid().map_or("deformable", |r| if r.is_prescribed() { "prescribed" } else { "free" });
            file.same(&format!("motion of body `{}`", body.name()), kind)?;
            let size = format!("half sizes {:?} m, lightest {:?} kg", body.half_size(), body.lightest());
            file.same(&format!("size of particles of body `{}`", body.name()), &size)?;
        }
        Ok(())
    }
}
