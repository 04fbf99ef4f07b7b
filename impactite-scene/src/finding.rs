//! Findings of the checks of a run.

use std::fmt;

/// Warning of a run that continues.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("after step {step}, t = {time:.6e} s: {finding}")]
pub struct Warning {
    /// Number of steps.
    pub step: u64,
    /// Time, s.
    pub time: f64,
    /// Finding of the check.
    pub finding: Finding,
}

/// Likely sink of unexplained energy, and the remedy, in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loss {
    /// Likely sinks, such as "the filter of the transfer".
    pub by: &'static str,
    /// Components and parameters that conserve more energy, as an imperative.
    pub remedy: &'static str,
}

/// Energies that were dissipated and booked, J: they are not lost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Booked {
    /// Friction.
    pub friction: f64,
    /// Plastic impacts of points.
    pub impacts: f64,
    /// Local damping, kinetic damping and null-space filter.
    pub damping: f64,
    /// Numerical viscosity, and heat of the viscosity of laws.
    pub viscosity: f64,
}

impl fmt::Display for Booked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Booked { friction, impacts, damping, viscosity } = *self;
        let all =
            [(friction, "friction"), (impacts, "impacts"), (damping, "damping"), (viscosity, "viscosity")];
        let mut before = "";
        for (joules, name) in all.into_iter().filter(|(joules, _)| *joules != 0.0) {
            write!(f, "{before}{joules:.4e} J by {name}")?;
            before = ", ";
        }
        Ok(())
    }
}

/// Finding of a check. [`Display`](fmt::Display) is [`found`](Finding::found), a semicolon, and [`remedy`](Finding::remedy).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// Unexplained gain of energy.
    EnergyGain {
        /// Share of the largest energy so far.
        share: f64,
        /// Energy gained, J.
        joules: f64,
        /// Body with the strongest signs.
        body: String,
        /// Position, m.
        position: [f64; 3],
        /// Likely cause, and remedy.
        cause: GainCause,
    },
    /// Unexplained loss of energy.
    EnergyLoss {
        /// Share of the largest energy so far.
        share: f64,
        /// Energy lost, J.
        joules: f64,
        /// Upper bound of the loss by contact at grid nodes, J; 0 without such contact.
        contact: f64,
        /// Dissipated energy that the balance contains, J.
        booked: Booked,
        /// Likely sink, and remedy.
        loss: Loss,
    },
    /// Error of the energy balance at the end of a run of few steps.
    FewSteps {
        /// Number of steps.
        steps: u64,
        /// Share of the largest energy so far; negative for a loss.
        share: f64,
        /// Energy, J; negative for a loss.
        joules: f64,
    },
    /// Energy or momentum that is not finite.
    NotFinite {
        /// Name of the body.
        body: String,
    },
    /// Unexplained momentum.
    Momentum {
        /// Share of the largest sum of m |v|, or of all applied impulses.
        share: f64,
        /// Unexplained momentum along x, y, z, kg m/s.
        momentum: [f64; 3],
    },
    /// Numerical fracture: a body separated without a failed particle in the parts.
    Torn {
        /// Name of the body.
        body: String,
        /// Number of parts now.
        parts: usize,
        /// Number of parts when the body was added.
        before: usize,
        /// Share of the particles that are in parts without a failed one.
        share: f64,
    },
    /// Pressure oscillation from cell to cell.
    Locking {
        /// Name of the body.
        body: String,
        /// Root mean square of the oscillating part, Pa.
        pressure: f64,
        /// Share of the variation of the pressure.
        share: f64,
        /// Root mean square of the von Mises stress, Pa.
        von_mises: f64,
    },
    /// Hourglass energy: element modes without strain at the quadrature points have a large share of the energy.
    Hourglass {
        /// Name of the body.
        body: String,
        /// Share of the largest kinetic and internal energy of the body so far.
        share: f64,
        /// Hourglass energy, J.
        joules: f64,
        /// Position of the element with the largest part, m.
        position: [f64; 3],
    },
    /// Spacing of the points of a body of another discretisation above that of the grid nodes.
    WidePoints {
        /// Name of the body.
        body: String,
        /// Point spacing over node spacing.
        ratio: f64,
    },
    /// Failed particles without other failed ones in the surrounding cells.
    LoneFailure {
        /// Name of the body.
        body: String,
        /// Number of failed particles.
        failed: u64,
        /// Number of those without another one in the surrounding cells.
        alone: u64,
        /// Position of one of them, m.
        position: [f64; 3],
    },
    /// Weakly compressible liquid that is too fast for its speed of sound.
    Compressed {
        /// Name of the body.
        body: String,
        /// Share of its mass above 0.15 of the speed of sound.
        share: f64,
        /// Speed that 1 % of its mass exceeds, m/s.
        speed: f64,
        /// Speed of sound at rest, m/s.
        sound: f64,
        /// Speed of sound that is large enough, m/s.
        needed: f64,
    },
    /// Localisation of plastic strain in bands of one or two cells, or softening of a zone that has too few cells for bands to form.
    Localised {
        /// Name of the body.
        body: String,
        /// Share of the plastic strain of the body, integrated over its volume, in the bands or the zone.
        share: f64,
        /// Mean width of the bands, or of the zone at half its strain, m.
        width: f64,
        /// Mean width in cells (points of a Lagrangian method).
        cells: f64,
        /// Largest plastic strain of the body, and that from which its law softens in shear, for a zone that softens; none for bands.
        softens: Option<[f64; 2]>,
        /// Largest size of cells that resolve the bands, or within which they can form, m.
        needed: f64,
        /// Position of the largest plastic strain in the zone, m.
        position: [f64; 3],
    },
}

impl std::error::Error for Finding {}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; {}", self.found(), self.remedy())
    }
}

impl Finding {
    /// Return the finding and its likely cause, without the remedy.
    #[must_use]
    pub fn found(&self) -> String {
        let per_cent = |share: &f64| 100.0 * share;
        match self {
            Finding::EnergyGain { share, joules, body, position, cause } => format!(
                "{joules:.4e} J of energy came from nowhere, {:.1} % of the largest energy of the run, most likely in body `{body}` near \
                 {position:?} m: {}",
                per_cent(share),
                cause.found()
            ),
            Finding::EnergyLoss { share, joules, contact, booked, loss } => {
                let contact = if *contact > 0.0 {
                    format!(" (contact took at most {contact:.4e} J at nodes)")
                } else {
                    String::new()
                };
                let booked = match booked.to_string() {
                    none if none.is_empty() => none,
                    some => format!("; taken and booked, and not lost: {some}"),
                };
                format!(
                    "{joules:.4e} J of energy are lost, {:.1} % of the largest energy of the run, in {}{contact}{booked}",
                    per_cent(share),
                    loss.by
                )
            }
            Finding::FewSteps { steps, share, joules } => format!(
                "the energy balance is off by {joules:+.4e} J, {:+.1} % of the largest energy of the run, after {steps} steps: kinetic and \
                 internal energy belong to times half a step apart, which few steps do not average out",
                per_cent(share)
            ),
            Finding::NotFinite { body } => {
                format!("the energy or momentum of body `{body}` is not finite")
            }
            Finding::Momentum { share, momentum } => format!(
                "{momentum:?} kg m/s of momentum came from nowhere, {share:.1e} of what moves or was given: a contact, boundary or transfer \
                 whose forces are not pairs"
            ),
            Finding::Torn { body, parts, before, share } => format!(
                "body `{body}` is in {parts} parts and was in {before}, {:.2} % of its particles in parts where none failed: numerical \
                 fracture, particles drawn so far apart that they share no node",
                per_cent(share)
            ),
            Finding::Locking { body, pressure, share, von_mises } => format!(
                "the pressure of body `{body}` alternates from cell to cell by {pressure:.3e} Pa, {:.0} % of all that it varies, at a von \
                 Mises stress of {von_mises:.3e} Pa: volumetric locking or a pressure mode",
                per_cent(share)
            ),
            Finding::Hourglass { body, share, joules, position } => format!(
                "hourglass forces of body `{body}` hold {joules:.3e} J, {:.1} % of the largest energy that it had, most near {position:?} m: elements \
                 deform there in ways that one point of integration does not see",
                per_cent(share)
            ),
            Finding::WidePoints { body, ratio } => format!(
                "the points of body `{body}` are {ratio:.2} cells of the grid apart: particles slip through between them"
            ),
            Finding::LoneFailure { body, failed, alone, position } => format!(
                "{alone} of {failed} failed particles of body `{body}` have no failed particle in the cells around theirs, one near \
                 {position:?} m: stress noise fails points one by one where a crack would fail a surface"
            ),
            Finding::Compressed { body, share, speed, sound, needed } => format!(
                "{:.0} % of body `{body}` moves at up to {speed:.3} m/s, {:.2} of its speed of sound of {sound:.4} m/s: a weakly compressible liquid is \
                 denser there by about {:.0} %, and its pressure waves are as slow; this needs a speed of sound of {needed:.3} m/s",
                per_cent(share),
                speed / sound,
                50.0 * (speed / sound).powi(2)
            ),
            Finding::Localised { body, share, width, cells, softens: None, needed, position } => format!(
                "{:.0} % of the plastic strain of body `{body}` is in bands {width:.2e} m wide, {cells:.1} cells, near {position:?} m: their width is \
                 that of the cells, so that forces, speeds and depths are not converged, even if two resolutions agree; bands of this width need \
                 cells of at most {needed:.1e} m",
                per_cent(share)
            ),
            Finding::Localised {
                body,
                share,
                width,
                cells,
                softens: Some([largest, from]),
                needed,
                position,
            } => format!(
                "body `{body}` has a plastic strain of up to {largest:.2} in a zone near {position:?} m, {width:.2e} m or {cells:.0} cells wide, with {:.0} % \
                 of its plastic strain, and its law softens in shear from {from:.2} on: strain localises there in bands that these cells are too coarse \
                 for, so that forces, speeds and depths are not converged, even if two resolutions agree; bands need cells of about {needed:.1e} m",
                per_cent(share)
            ),
        }
    }

    /// Return the remedy, as an imperative. It names library calls; scene files have keys for them.
    #[must_use]
    pub fn remedy(&self) -> &'static str {
        match self {
            Finding::EnergyGain { cause, .. } => cause.remedy(),
            Finding::EnergyLoss { loss, .. } => loss.remedy,
            Finding::FewSteps { .. } => {
                "make more steps, by a later end or a smaller Courant factor, and see whether the error stays"
            }
            Finding::NotFinite { .. } => "lower the time step",
            Finding::Momentum { .. } => "check the contacts, boundaries and transfers of your own",
            Finding::Torn { .. } => {
                "give it a failure criterion, split its particles (`Splitting`), or take a wider shape function, CPDI or the \
                 total-Lagrangian frame"
            }
            Finding::Locking { .. } => "take `Method::mean_dilatation` or quadratic shape functions",
            Finding::Hourglass { .. } => {
                "refine the mesh, spread loads over several nodes, or integrate in full (`Technology::MeanDilatation`)"
            }
            Finding::WidePoints { .. } => {
                "take smaller elements or larger cells, or let particles meet the surface (`Elements::by_surface`)"
            }
            Finding::Localised { .. } => {
                "refine, and compare at least three resolutions (`impactite converge`); a law that softens without rates, conduction of heat or a \
                 length of its own has bands one cell wide at any resolution"
            }
            Finding::Compressed { .. } => {
                "take `Tait` with a larger speed of sound, ten times the largest speed"
            }
            Finding::LoneFailure { .. } => {
                "take `Method::impact`, a wider shape function, or a time-dependent criterion (`TulerButcher`, `CohesiveSpall`)"
            }
        }
    }
}

/// Likely cause of an energy gain. [`Display`](fmt::Display) is the cause, a semicolon, and the remedy.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum GainCause {
    /// Time step above the stability limit.
    TimeStep {
        /// Time step, s.
        dt: f64,
        /// Largest stable step by Gershgorin's bound, s.
        limit: f64,
    },
    /// Null-space motion: particle velocities that vanish at the nodes.
    Unseen {
        /// Kinetic energy of the null-space motion of all bodies, J.
        joules: f64,
    },
    /// Density above the data of the equation of state.
    OverCompressed {
        /// Number of particles.
        particles: usize,
    },
    /// Contact.
    Contact,
    /// Cell crossing of particles.
    Crossing,
    /// Cause of a specific method: the cause, a semicolon, and the remedy.
    Other(&'static str),
}

impl std::error::Error for GainCause {}

impl fmt::Display for GainCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; {}", self.found(), self.remedy())
    }
}

impl GainCause {
    /// Return the cause, without the remedy.
    #[must_use]
    pub fn found(&self) -> String {
        match self {
            GainCause::TimeStep { dt, limit } => format!(
                "the time step of {dt:.3e} s is longer than the {limit:.3e} s that the mesh and its wave speeds bear"
            ),
            GainCause::Unseen { joules } => format!(
                "{joules:.3e} J are in motion of particles against their cell that no node sees (the null space of FLIP and its kin)"
            ),
            GainCause::OverCompressed { particles } => {
                format!("{particles} particles are compressed beyond the data of their equation of state")
            }
            GainCause::Contact => "bodies are in contact there".into(),
            GainCause::Crossing => "stresses of particles that cross cells are the usual cause".into(),
            GainCause::Other(words) => words.split_once("; ").map_or(*words, |(cause, _)| cause).into(),
        }
    }

    /// Return the remedy, as an imperative.
    #[must_use]
    pub fn remedy(&self) -> &'static str {
        match self {
            GainCause::TimeStep { .. } => "lower the Courant factor or take `TimeControl::Gershgorin`",
            GainCause::Unseen { .. } => {
                "take `Method::impact` or `Method::contact_at_rest`, or filter it (`Mpm::set_null_space_filter`)"
            }
            GainCause::OverCompressed { .. } => {
                "take `Method::impact`, a shock viscosity, or a smaller Courant factor"
            }
            GainCause::Contact => {
                "take the default detector `SurfaceDistance` and `Method::contact_at_rest` or `Method::impact`, or smaller cells"
            }
            GainCause::Crossing => {
                "take `Method::impact`, a wider shape function or a smaller Courant factor"
            }
            GainCause::Other(words) => {
                words.split_once("; ").map_or("take a smaller Courant factor", |(_, remedy)| remedy)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_what_was_found_and_what_to_do() {
        let torn = Finding::Torn { body: "a; b".into(), parts: 3, before: 1, share: 0.5 };
        assert_eq!(torn.to_string(), format!("{}; {}", torn.found(), torn.remedy()));
        assert!(torn.found().contains("`a; b` is in 3 parts") && !torn.found().contains("Splitting"));
        let loss = Loss { by: "the filter of the transfer", remedy: "take smaller cells" };
        let booked = Booked::default();
        let lost = |contact| Finding::EnergyLoss { share: 0.12, joules: 3.0, contact, booked, loss };
        assert_eq!(
            lost(0.0).to_string(),
            "3.0000e0 J of energy are lost, 12.0 % of the largest energy of the run, in the filter of the transfer; take smaller cells"
        );
        assert!(lost(2.0).found().ends_with("(contact took at most 2.0000e0 J at nodes)"));
        let booked = Booked { friction: 1.0, viscosity: 0.5, ..booked };
        assert_eq!(booked.to_string(), "1.0000e0 J by friction, 5.0000e-1 J by viscosity");
        let found = Finding::EnergyLoss { share: 0.12, joules: 3.0, contact: 0.0, booked, loss };
        assert!(
            found.found().ends_with(
                "; taken and booked, and not lost: 1.0000e0 J by friction, 5.0000e-1 J by viscosity"
            )
        );
        let other = GainCause::Other("the nodes there are the fastest; take a finer mesh");
        assert_eq!(
            (other.found(), other.remedy()),
            ("the nodes there are the fastest".into(), "take a finer mesh")
        );
    }
}
