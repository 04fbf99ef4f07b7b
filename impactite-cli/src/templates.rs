//! Template scene files: those of the repository's folders `scenes/templates` and `scenes`.

use std::path::{Path, PathBuf};

use crate::CliError;

macro_rules! templates {
    ($($name:literal in $folder:literal: $what:literal,)*) => {
        /// Name, description and text.
        pub const TEMPLATES: &[(&str, &str, &str)] =
            &[$(($name, $what, include_str!(concat!("../", $folder, "/", $name, ".toml"))),)*];
    };
}

templates! {
    "plate_perforation" in "scenes/templates": "mpm: a steel sphere perforates an aluminium plate that breaks; axisymmetric",
    "rigid_piston" in "scenes/templates": "mpm: a rigid piston hits a bar; contact",
    "water_column" in "scenes/templates": "mpm: a column of water collapses; fluid, gravity",
    "soil_slope" in "scenes/templates": "mpm: a bank of clay slides down; Mohr-Coulomb",
    "stl_part" in "scenes/templates": "mpm: a part from an STL file hits a wall; three dimensions",
    "fem_bar" in "scenes/templates": "fem: a copper bar on a wall, axisymmetric; a mesh of a shape",
    "fem_mesh_file" in "scenes/templates": "fem: a beam from a mesh file of Gmsh bends under its weight",
    "sph_bars" in "scenes/templates": "sph: a bar hits another one; contact",
    "fpm_spall" in "scenes/templates": "fpm: a pulse of pressure spalls a bar; traction, cracks",
    "elastic_bar" in "scenes": "pcmm: an elastic bar on a wall",
    "copper_bar" in "scenes": "pcmm: a copper bar on a wall",
    "taylor_bar" in "scenes": "mpm: a copper bar hits a wall; a quarter in three dimensions",
    "refined_bar" in "scenes": "mpm: a copper bar hits a wall; cells are halved near the wall",
    "rings" in "scenes": "mpm: two rubber rings collide",
    "rolling_cylinder" in "scenes": "mpm: a cylinder rolls down an incline: friction, gravity over time",
    "pressed_balls" in "scenes": "mpm: balls in a container are pressed: repeated bodies, traction",
    "reinforced_bar" in "scenes": "mpm with fem: line elements in a bar of concrete: waves of both together",
    "oblique_penetration" in "scenes": "mpm: an ogive rod through a plate, obliquely",
    "concrete_perforation" in "scenes": "mpm: a rod through concrete, axisymmetric",
    "debris_cloud" in "scenes": "mpm: a sphere on a plate at several km/s",
    "tnt" in "scenes": "mpm: a detonation",
    "granular_column" in "scenes": "mpm: a column of bars collapses",
    "elastic_gate" in "scenes": "flow and elements: water bends a rubber gate and leaves under it",
    "dam_break" in "scenes": "flow: a column of water falls and runs up a wall",
}

/// Files that templates read: template, file name, and text.
pub const FILES: &[(&str, &str, &str)] = &[
    ("stl_part", "bracket.stl", include_str!("../scenes/templates/bracket.stl")),
    ("fem_mesh_file", "beam.msh", include_str!("../scenes/templates/beam.msh")),
];

/// Write a template and the files that it reads. Existing files are not overwritten.
///
/// # Errors
/// Unknown template; file that exists or cannot be written.
pub fn write(template: &str, path: &Path) -> Result<Vec<PathBuf>, CliError> {
    let Some((_, _, text)) = TEMPLATES.iter().find(|t| t.0 == template) else {
        let names: Vec<&str> = TEMPLATES.iter().map(|t| t.0).collect();
        let why = format!("there is no template `{template}`; there are {}", names.join(", "));
        return Err(CliError::option("new", why));
    };
    let mut files = vec![(path.to_path_buf(), *text)];
    let beside = FILES.iter().filter(|(of, ..)| *of == template);
    files.extend(beside.map(|(_, name, text)| (path.with_file_name(name), *text)));
    if let Some((path, _)) = files.iter().find(|(path, _)| path.exists()) {
        return Err(CliError::option("new", format!("`{}` is there already", path.display())));
    }
    for (path, text) in &files {
        std::fs::write(path, text).map_err(CliError::file(path))?;
    }
    Ok(files.into_iter().map(|(path, _)| path).collect())
}
