//! Description of a scene's properties in words, for comparison with a checkpoint: constants by their `Debug` output,
//! functions of time and place by samples.

use impactite_scene::constants::{Constant, over, region};
use impactite_scene::{Archive, CheckpointError};

use crate::step::bodies::load::Loads;
use crate::step::bodies::particle_body::ParticleBody;
use crate::step::mpm::Mpm;
use crate::step::rigid::motion::RigidState;
use impactite_simd::Float;

impl<const D: usize> Loads<D> {
    fn constants(&self, at: &[f64; D], times: [f64; 2]) -> String {
        let mut words = Vec::new();
        for load in &self.tractions {
            let (axis, turned) = (load.axis, if load.revolved { ", revolved" } else { "" });
            let history = over(times, |t| (load.history)(t));
            words.push(format!("traction {history} Pa on axis {axis}{turned}, {}", region(&*load.region)));
        }
        if let Some(field) = &self.field {
            words.push(format!("field {} m/s^2", over(times, |t| (field.acceleration)(at, t))));
        }
        words.join("; ")
    }
}

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Describe law, loads and splitting.
    pub(in crate::step) fn constants_at(&self, times: [f64; 2]) -> Vec<Constant> {
        let at = self.starts.first().copied().unwrap_or([0.0; D]);
        vec![
            ("constants of the law".into(), self.material.constants()),
            ("loads".into(), self.loads.constants(&at, times)),
            ("splitting".into(), format!("{:?}", self.splitting)),
        ]
    }
}

impl<const D: usize> RigidState<D> {
    /// Describe the properties that are constant in a run.
    pub(in crate::step) fn constants_at(&self, times: [f64; 2]) -> Vec<Constant> {
        let motion = self.prescribed.as_ref().map(|motion| over(times, |t| motion(t)));
        let (mass, inertia, held) = (self.mass, self.inertia.as_slice(), self.held);
        vec![
            ("mass and inertia".into(), format!("{mass:?} kg, {inertia:?} kg m^2, held {held:?}")),
            ("prescribed motion".into(), motion.unwrap_or_default()),
        ]
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Check that laws, loads, boundaries and contact of the file are those of this scene. Called after the clock was read.
    pub(super) fn compare_constants(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let times = [0.0, self.clock.time];
        file.same("contact", &format!("{:?}", self.scene.contact))?;
        let gravity = self.scene.conditions.gravity.as_ref().map(|g| over(times, |t| g(t)));
        file.same("body force at the start and now", &gravity.unwrap_or_default())?;
        file.same("local damping", &format!("{:?}", self.scene.conditions.damping.coefficient()))?;
        self.scene.conditions.boundaries.archive(file, times, &str::to_string)?;
        for body in &self.scene.bodies {
            for (what, is) in body.constants(times) {
                file.same(&format!("{what} of body `{}`", body.name()), &is)?;
            }
        }
        Ok(())
    }
}
