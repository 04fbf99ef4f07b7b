//! Remedies in messages: phrases of the libraries, and the corresponding keys of scene files.
//!
//! Messages of the libraries contain Rust calls as remedies. [`in_scene_files`] replaces them by keys for authors of scene files.

/// Phrase of a library message, and its replacement for scene files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Remedy {
    /// Text of the library.
    pub library: &'static str,
    /// Text with keys of scene files, `NAME` for names of bodies and materials; without features that scene files do not have.
    pub scene_file: &'static str,
}

const fn remedy(library: &'static str, scene_file: &'static str) -> Remedy {
    Remedy { library, scene_file }
}

/// All phrases to replace. At the same position the longest match counts.
pub const REMEDIES: &[Remedy] = &[
    // Methods and their parts.
    remedy("`Method::impact`", "`method.mpm.for = \"impact\"`"),
    remedy("`Method::contact_at_rest`", "`method.mpm.for = \"contact at rest\"`"),
    remedy(
        "`Method::mean_dilatation` or quadratic shape functions",
        "quadratic shape functions (`method.mpm.parts.shape_function = \"quadratic_b_spline\"`)",
    ),
    remedy("`Method::total_lagrangian`", "`method.sph.form = \"total_lagrangian\"`"),
    remedy(
        "take `Tait` with a larger speed of sound, ten times the largest speed",
        "take a larger `materials.NAME.fluid.tait.sound_speed`, ten times the largest speed",
    ),
    remedy(
        "take a smaller Courant factor, or a larger speed of sound of the liquid",
        "take a smaller `time_step.factor`, or a larger `materials.NAME.fluid.tait.sound_speed`",
    ),
    remedy("`Method::symmetric`", "`method.fpm.flux = \"symmetric\"`"),
    remedy("take `Method::consistent`, or smaller particles", "take a smaller `method.pcmm.spacing`"),
    remedy(
        "take `Method::consistent`, a smaller Courant factor, or revise more often",
        "take a smaller `time_step.factor`",
    ),
    remedy("a wider shape function", "a wider `method.mpm.parts.shape_function`"),
    remedy(
        "take FLIP, MUSL or USF",
        "take `method.mpm.for = \"impact\"` or `method.mpm.parts.transfer = \"flip\"`",
    ),
    remedy("it needs FLIP or a blend", "it needs `method.mpm.parts.transfer = \"flip\"` or `\"blend\"`"),
    remedy("take FLIP or a blend", "take `method.mpm.parts.transfer = \"flip\"` or `\"blend\"`"),
    remedy(
        "FLIP with MUSL where nothing spins, AFLIP with USF",
        "FLIP with MUSL where nothing spins (`method.mpm.for = \"machine parts\"` or, instead of `method.mpm.for`, `method.mpm.parts = { shape_function = \"linear\", \
         transfer = \"flip\", stress_update = \"musl\" }`)",
    ),
    remedy(
        "take `QuadraticBSpline` or `CubicBSpline`",
        "take `method.mpm.for = \"impact\"` or `method.mpm.parts.shape_function = \"quadratic_b_spline\"`",
    ),
    remedy(
        "take `Apic` or `Aflip`",
        "take `method.mpm.for = \"impact\"` or `method.mpm.parts.transfer = \"apic\"`",
    ),
    remedy("take `BlockGrid`", "remove `method.mpm.grid`"),
    remedy(
        "remove the refined regions",
        "remove `method.mpm.refine`, and write one length for `method.mpm.cell`",
    ),
    remedy(
        "prescribe its motion, or halve cells by criteria (`Mpm::refine_where`) instead of regions",
        "write `bodies.NAME.rigid.prescribed = true`, or give `method.mpm.cell` as a range instead of `method.mpm.refine`",
    ),
    remedy("or the refined regions", "or `method.mpm.refine` and the smaller length of `method.mpm.cell`"),
    remedy(
        "leave out the null-space filter (`Mpm::set_null_space_filter`)",
        "remove `method.mpm.null_space_filter`",
    ),
    remedy(" (`Material::state_names`)", ""),
    remedy(
        "return false from `Hook::needs_nodes`, or remove the refined regions",
        "scene files have no such part: please report it as an error of the program",
    ),
    remedy("take `Gimp`, `Linear` or a B-spline", "take another `method.mpm.parts.shape_function`"),
    remedy(
        "or filter it (`Mpm::set_null_space_filter`)",
        "or filter it (`method.mpm.null_space_filter = 10`)",
    ),
    remedy("a larger penalty", "a larger `method.fpm.penalty`"),
    remedy("take the staggered scheme", "leave `method.flow.semi_staggered` out"),
    remedy("or the staggered scheme", "or leave `method.flow.semi_staggered` out"),
    remedy("a smaller share of PIC", "a smaller `method.flow.semi_staggered.pic`"),
    remedy("take a body force over time for all", "take `gravity`, which may be formulas of time"),
    remedy("a smaller density correction", "a smaller `method.flow.density_correction`"),
    // Time.
    remedy("lower the time step", "lower `time_step.factor`"),
    remedy("lower the Courant factor", "lower `time_step.factor`"),
    remedy("a smaller Courant factor", "a smaller `time_step.factor`"),
    remedy("a later end", "a later `end`"),
    remedy("or fix the step (`TimeControl::Fixed`)", "or set `time_step.fixed`"),
    remedy("`TimeControl::Gershgorin`", "`time_step.gershgorin`"),
    remedy("as `Gershgorin` needs", "as `time_step.gershgorin` needs"),
    remedy("take `Courant`", "take `time_step.factor`"),
    remedy(": let it start at an earlier time (`Mpm::set_time`)", ""),
    // Contact.
    remedy(
        "a contact algorithm, and the scene has none: make it by `Mpm::with_contact`",
        "contact, and the scene has none: write a `contact`",
    ),
    remedy("the default detector `SurfaceDistance`", "`contact.detector = \"surface_distance\"`"),
    remedy(" (`Coulomb`)", " (`contact.law.friction`)"),
    remedy("give all laws at once (`Pairs::with`)", "write all laws into `contact.pairs`"),
    remedy("ask for contact (`Fem::touch`) before", "write a `contact`"),
    remedy(
        "check the contacts, boundaries and transfers of your own",
        "scene files have no such part: please report it as an error of the program",
    ),
    // Materials.
    remedy(
        "give it a failure criterion, split its particles (`Splitting`), or take a wider shape function, CPDI or the total-Lagrangian frame",
        "give its material a criterion (`materials.NAME.failure`), split its particles (`bodies.NAME.split_at`), or take a wider \
         `method.mpm.parts.shape_function` or, if it neither breaks nor flows, `method.mpm.for = \"large elastic\"`",
    ),
    remedy(
        ", a wider shape function, or a time-dependent criterion (`TulerButcher`, `CohesiveSpall`)",
        " or a wider `method.mpm.parts.shape_function`",
    ),
    remedy("a shock viscosity", "`materials.NAME.bulk_viscosity`"),
    remedy("a law with bulk viscosity", "a material with `materials.NAME.bulk_viscosity`"),
    remedy("; wrap it: `Stretching::new(law)`", "; leave out `bodies.NAME.split_at`"),
    // Elements.
    remedy("(`Elements::on_the_grid`)", "(`bodies.NAME.elements.by = \"grid\"`)"),
    remedy("finite elements (`Fem::touch`)", "finite elements (`method.fem`)"),
    remedy("(`Elements::by_surface`)", "(`bodies.NAME.elements.by = \"surface\"`)"),
    remedy("(`Elements::within`)", "(`bodies.NAME.elements.within`)"),
    remedy("(`MeshBody::eroding(Erosion::volume(..))`)", "(`bodies.NAME.erosion.volume`)"),
    remedy("(`MeshBody::eroding(Erosion::step(..))`)", "(`bodies.NAME.erosion.step`)"),
    remedy(
        "integrate in full (`Technology::MeanDilatation`)",
        "integrate in full (`bodies.NAME.integration = \"mean_dilatation\"`)",
    ),
    remedy("take `Technology::Full`", "take `bodies.NAME.integration = \"full\"`"),
    remedy(
        "take `AveragedVolumes`, or `Full`",
        "take `bodies.NAME.integration = \"averaged_volumes\"`, or `\"full\"`",
    ),
    remedy("take `AveragedVolumes`", "take `bodies.NAME.integration = \"averaged_volumes\"`"),
    remedy(
        "take `MeanDilatation` or `OnePoint`",
        "take `bodies.NAME.integration = \"mean_dilatation\"`, or `integration.one_point`",
    ),
    remedy(
        "nodes in the order of `ElementKind`",
        "nodes in the order that the format of the mesh prescribes",
    ),
    remedy(" (`Fem::finish`)", ""),
    remedy(" (`Fem::begin`)", ""),
    // Files.
    remedy(
        "read it by `TriangleMesh::read_stl`",
        "give it to the body as `bodies.NAME.shape.surface`, by a name that ends with .stl",
    ),
    remedy(
        "read it by `TriangleMesh::read_obj`",
        "give it to the body as `bodies.NAME.shape.surface`, by a name that ends with .obj",
    ),
    remedy(
        "read it by `TriangleMesh::read_ply`",
        "give it to the body as `bodies.NAME.shape.surface`, by a name that ends with .ply",
    ),
    remedy("read it by `ElementMesh::read_gmsh`", "give it to the body as `bodies.NAME.mesh.gmsh`"),
    remedy("read it by `ElementMesh::read_abaqus`", "give it to the body as `bodies.NAME.mesh.abaqus`"),
    // Conditions.
    remedy("take `Boundary::Wall`", "take `conditions.wall`"),
    // Memory.
    remedy(
        "look at the units of shape and lattice, or allow more by `Filling::memory`",
        "or look at the units of the shape and of the cells",
    ),
    remedy(
        "a block grid, which holds only nodes that matter reaches, or allow more by `DenseGrid::within`",
        "or `method.mpm.grid = \"blocks\"`, which holds only nodes that matter reaches",
    ),
    remedy("; a snapshot in space is drawn by ParticlePicture", ""),
];

/// Replace the remedies in a library message by keys of scene files ([`REMEDIES`]).
///
/// ```
/// use impactite_scene_file::remedy::in_scene_files;
/// let shown = in_scene_files("the pressure alternates; take `Method::impact`, or a smaller Courant factor");
/// assert_eq!(shown, "the pressure alternates; take `method.mpm.for = \"impact\"`, or a smaller `time_step.factor`");
/// ```
#[must_use]
pub fn in_scene_files(message: &str) -> String {
    let (mut shown, mut rest) = (String::with_capacity(message.len()), message);
    while let Some(first) = rest.chars().next() {
        let here = REMEDIES.iter().filter(|r| rest.starts_with(r.library));
        match here.max_by_key(|r| r.library.len()) {
            Some(found) => {
                shown += found.scene_file;
                rest = &rest[found.library.len()..];
            }
            None => {
                shown.push(first);
                rest = &rest[first.len_utf8()..];
            }
        }
    }
    shown
}
