//! What a look at a run finds.

/// Something that may be wrong with a run that goes on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("after step {step}, t = {time:.6e} s: {finding}")]
pub struct Warning {
    /// Steps made.
    pub step: u64,
    /// Time, s.
    pub time: f64,
    /// What was found.
    pub finding: Finding,
}

/// What a look at a run found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Finding {
    /// Energy that nothing explains.
    #[error(
        "{joules:.4e} J of energy came from nowhere, {:.1} % of the largest energy of the run, most likely in body `{body}` near {position:?} m: {cause}",
        100.0 * share
    )]
    EnergyGain {
        /// Of the largest energy so far.
        share: f64,
        /// Energy, J.
        joules: f64,
        /// The body where the signs are strongest.
        body: String,
        /// Where, m.
        position: [f64; 3],
        /// What most likely brought it about, and what to do.
        cause: GainCause,
    },
    /// Energy that went where no balance has it.
    #[error("{joules:.4e} J of energy are gone, {:.1} % of the largest energy of the run, {remedy}", 100.0 * share)]
    EnergyLoss {
        /// Of the largest energy so far.
        share: f64,
        /// Energy, J.
        joules: f64,
        /// Where it most likely went, and what keeps more.
        remedy: &'static str,
    },
    /// An energy or momentum that is no number.
    #[error("the energy or momentum of body `{body}` is not finite; lower the time step")]
    NotFinite {
        /// The body.
        body: String,
    },
    /// Momentum that nothing explains.
    #[error(
        "{momentum:?} kg m/s of momentum came from nowhere, {share:.1e} of what moves or was given: a contact, boundary or \
         transfer of one's own that is no pair of forces"
    )]
    Momentum {
        /// Of the largest sum of m |v|, or of all impulses given.
        share: f64,
        /// Along x, y, z, kg m/s.
        momentum: [f64; 3],
    },
    /// A body came apart though no particle of the parts failed.
    #[error(
        "body `{body}` is in {parts} parts and was in {before}, {:.2} % of its particles in parts where none failed: numerical fracture, particles drawn so far apart \
         that they share no node; give it a failure criterion, split its particles (`Splitting`), or take a wider shape function, CPDI or the total-Lagrangian frame",
        100.0 * share
    )]
    Torn {
        /// The body.
        body: String,
        /// Parts now.
        parts: usize,
        /// Parts when it was added.
        before: usize,
        /// Share of the particles in parts without a failed one.
        share: f64,
    },
    /// A pressure that changes its sign from cell to cell.
    #[error(
        "the pressure of body `{body}` alternates from cell to cell by {pressure:.3e} Pa, {:.0} % of all that it varies, at a von Mises stress of {von_mises:.3e} Pa: \
         volumetric locking or a pressure mode; take `Method::mean_dilatation` or quadratic shape functions",
        100.0 * share
    )]
    Locking {
        /// The body.
        body: String,
        /// Root mean square of what alternates, Pa.
        pressure: f64,
        /// Of the variation of the pressure.
        share: f64,
        /// Root mean square of the von Mises stress, Pa.
        von_mises: f64,
    },
    /// Motion of elements that their integration points do not see takes a large part of the energy.
    #[error(
        "hourglass forces of body `{body}` hold {joules:.3e} J, {:.1} % of its internal energy, most near {position:?} m: elements deform there in ways that one point \
         of integration does not see; refine the mesh, spread loads over several nodes, or integrate in full (`Technology::MeanDilatation`)",
        100.0 * share
    )]
    Hourglass {
        /// The body.
        body: String,
        /// Of the internal energy of its law.
        share: f64,
        /// Energy, J.
        joules: f64,
        /// The element with most of it, m.
        position: [f64; 3],
    },
    /// Points of a body of another discretisation that are further apart than the nodes of the grid that they act on.
    #[error(
        "the points of body `{body}` are {ratio:.2} cells of the grid apart: particles slip through between them; take smaller elements or larger cells, or let \
         particles meet the surface (`Elements::by_surface`)"
    )]
    WidePoints {
        /// The body.
        body: String,
        /// Distance of points over that of nodes.
        ratio: f64,
    },
    /// Particles that failed without any in the cells around theirs.
    #[error(
        "{alone} of {failed} failed particles of body `{body}` have no failed particle in the cells around theirs, one near {position:?} m: stress noise fails points one by one where \
         a crack would fail a surface; take `Method::impact`, a wider shape function, or a time-dependent criterion (`TulerButcher`, `CohesiveSpall`)"
    )]
    LoneFailure {
        /// The body.
        body: String,
        /// Particles that failed.
        failed: u64,
        /// Those without one in the cells around.
        alone: u64,
        /// Where one is, m.
        position: [f64; 3],
    },
}

/// What most likely made energy.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GainCause {
    /// A step beyond the limit of stability.
    #[error(
        "the time step of {dt:.3e} s is longer than the {limit:.3e} s that the mesh and its wave speeds bear; lower the Courant factor or take `TimeControl::Gershgorin`"
    )]
    TimeStep {
        /// The step, s.
        dt: f64,
        /// The longest stable one by Gershgorin's bound, s.
        limit: f64,
    },
    /// Motion that no node sees.
    #[error(
        "{joules:.3e} J are in motion of particles against their cell that no node sees (the null space of FLIP and its kin); take `Method::impact` or \
         `Method::contact_at_rest`, or filter it (`Mpm::set_null_space_filter`)"
    )]
    Unseen {
        /// Kinetic energy of such motion in all bodies, J.
        joules: f64,
    },
    /// Matter denser than the data of its equation of state.
    #[error(
        "{particles} particles are compressed beyond the data of their equation of state; take `Method::impact`, a shock viscosity, or a smaller Courant factor"
    )]
    OverCompressed {
        /// How many.
        particles: usize,
    },
    /// A contact.
    #[error(
        "bodies meet there; take the default detector `SurfaceDistance` and `Method::contact_at_rest` or `Method::impact`, or smaller cells"
    )]
    Contact,
    /// Particles that cross cells.
    #[error(
        "stresses of particles that cross cells are the usual cause; take `Method::impact`, a wider shape function or a smaller Courant factor"
    )]
    Crossing,
    /// What else a method knows, in words with the remedy.
    #[error("{0}")]
    Other(&'static str),
}
