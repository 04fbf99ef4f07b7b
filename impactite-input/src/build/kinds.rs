//! Kinds of bodies, and the keys that each reads.

use super::wrong::{Made, Wrong};
use crate::model::SceneFile;
use crate::model::body::{Body, Mesh};
use crate::model::material::Library;
use crate::model::method::Method;

/// Kind of a body: what carries its matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Material points.
    Particles,
    /// Rigid body among material points.
    Rigid,
    /// Finite elements among material points.
    Elements,
    /// Particles in contact.
    Pcmm,
    /// Smoothed particles.
    Sph,
    /// Fragile points.
    Fpm,
    /// Finite elements.
    Fem,
    /// Incompressible liquid.
    Liquid,
    /// Rigid body in a liquid.
    Solid,
    /// Finite elements in a liquid.
    Deformable,
    /// Material points in a liquid.
    Submerged,
}
use Kind::{Deformable, Elements, Fem, Fpm, Liquid, Particles, Pcmm, Rigid, Solid, Sph, Submerged};

impl Kind {
    fn of(scene: &SceneFile, body: &Body) -> Kind {
        match &scene.method {
            Method::Mpm(_) if body.elements.is_some() => Elements,
            Method::Mpm(_) if body.rigid.is_some() => Rigid,
            Method::Mpm(_) => Particles,
            Method::Pcmm(_) => Pcmm,
            Method::Sph(_) => Sph,
            Method::Fpm(_) => Fpm,
            Method::Fem(_) => Fem,
            Method::Flow(_) if body.rigid.is_some() => Solid,
            Method::Flow(_) if body.mesh.is_some() => Deformable,
            Method::Flow(_) if is_solid(scene, body) => Submerged,
            Method::Flow(_) => Liquid,
        }
    }

    /// Name of the kind in messages.
    fn name(self) -> &'static str {
        match self {
            Particles => "particles of `mpm`",
            Rigid => "rigid bodies of `mpm`",
            Elements => "`elements` in `mpm`",
            Pcmm => "`pcmm`",
            Sph => "`sph`",
            Fpm => "`fpm`",
            Fem => "`fem`",
            Liquid => "liquids of `flow`",
            Solid => "rigid bodies of `flow`",
            Deformable => "finite elements in `flow`",
            Submerged => "material points in `flow`",
        }
    }
}

/// Key of a body that some kinds alone read.
struct Key {
    name: &'static str,
    /// True if the body has the key.
    used: fn(&Body) -> bool,
    /// Kinds that read it.
    kinds: &'static [Kind],
    /// Remedy for a body of another kind.
    instead: Option<&'static str>,
}

/// Keys that some kinds alone read. Other keys of bodies are read for every kind.
const KEYS: &[Key] = &[
    Key { name: "rigid", used: |b| b.rigid.is_some(), kinds: &[Rigid, Solid], instead: None },
    Key { name: "elements", used: |b| b.elements.is_some(), kinds: &[Elements], instead: None },
    Key {
        name: "material",
        used: |b| b.material.is_some(),
        kinds: &[Particles, Elements, Pcmm, Sph, Fpm, Fem, Liquid, Deformable, Submerged],
        instead: Some("a rigid body has `rigid.density` instead"),
    },
    Key { name: "deactivated", used: |b| b.deactivated, kinds: &[Particles], instead: None },
    Key { name: "split_at", used: |b| b.split_at.is_some(), kinds: &[Particles], instead: None },
    Key { name: "merge_above", used: |b| b.merge_above.is_some(), kinds: &[Particles], instead: None },
    Key {
        name: "body_force",
        used: |b| b.body_force.is_some(),
        kinds: &[Particles, Submerged, Liquid],
        instead: Some("`gravity` acts on all bodies, and may be formulas of time"),
    },
    Key { name: "lit", used: |b| !b.lit.is_empty(), kinds: &[Particles], instead: None },
    Key {
        name: "initial_stress",
        used: |b| b.initial_stress.is_some(),
        kinds: &[Particles, Sph, Submerged],
        instead: None,
    },
    Key {
        name: "traction",
        used: |b| !b.traction.0.is_empty(),
        kinds: &[Particles, Sph, Fpm, Fem, Deformable, Submerged],
        instead: Some("push it by another body, or by a condition `prescribed`"),
    },
    Key { name: "notches", used: |b| !b.notches.is_empty(), kinds: &[Fpm], instead: None },
    Key {
        name: "integration",
        used: |b| b.integration.is_some(),
        kinds: &[Fem, Elements, Deformable],
        instead: None,
    },
    Key { name: "erosion", used: |b| b.erosion.is_some(), kinds: &[Fem, Elements], instead: None },
    Key {
        name: "mesh",
        used: |b| b.mesh.is_some(),
        kinds: &[Fem, Fpm, Elements, Deformable],
        instead: Some("`elements = {}` beside it makes finite elements of a body of `mpm`"),
    },
];

/// True if a body has the material of a solid, or of the ground: of neither a liquid nor an explosive.
pub(crate) fn is_solid(scene: &SceneFile, body: &Body) -> bool {
    let spec = body.material.as_ref().and_then(|name| scene.materials.get(name));
    let named = [Library::Water, Library::WaterShocked, Library::Tnt].map(Some);
    spec.is_some_and(|spec| {
        spec.fluid.is_none() && spec.explosive.is_none() && !named.contains(&spec.library)
    })
}

/// Refuse keys of a body that its kind does not read.
pub(super) fn check(scene: &SceneFile, name: &str, body: &Body) -> Made<()> {
    let kind = Kind::of(scene, body);
    let refused = |key: &str, message: String, help: Option<&str>| {
        Err(Wrong { key: format!("bodies.{name}.{key}"), message, help: help.map(Into::into) })
    };
    if body.elements.is_some() && body.rigid.is_some() {
        return refused("rigid", "is not for `elements`: either of both".into(), None);
    }
    for key in KEYS {
        if (key.used)(body) && !key.kinds.contains(&kind) {
            let kinds: Vec<&str> = key.kinds.iter().map(|k| k.name()).collect();
            let message = format!("is for {}; not for {}", listed(&kinds), kind.name());
            return refused(key.name, message, key.instead);
        }
    }
    match &body.mesh {
        Some(Mesh::Gmsh(_) | Mesh::Abaqus(_) | Mesh::Bars(_)) if body.shape.is_some() => {
            refused("shape", "is not read: the `mesh` of the body says where it is".into(), None)
        }
        _ => Ok(()),
    }
}

/// Join names by commas and "and".
fn listed(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).into(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}
