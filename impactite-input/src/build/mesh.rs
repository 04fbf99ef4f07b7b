//! Meshes of bodies.

use impactite::fem::{Erosion, Hourglass, MeshBody, Technology};
use impactite::geometry::structured::{
    Butterfly, ball_mesh, box_mesh, cylinder_mesh, half_disc_mesh, tube_mesh,
};
use impactite::geometry::{Ball, Cuboid, Cylinder, ElementBlock, ElementKind, ElementMesh, Metric, Tube};

use super::common::{World, centre_of_mass};
use super::shape::Motion;
use super::wrong::{At, Folder, Made, Wrong, wrong};
use crate::model::body::{Bars, Body, HOURGLASS_STIFFNESS, Integration, Mesh, MeshFile};
use crate::model::fixed;
use crate::model::shape::Shape;
use crate::quantity::{Length, Quantity};

/// Return the mesh of a body.
pub(super) fn of<const D: usize>(world: &World<'_, D>, key: &str, body: &Body) -> Made<ElementMesh<D>> {
    match &body.mesh {
        None => wrong(key, "needs a `mesh`: a file, or `edge` with a `shape`"),
        Some(Mesh::Bars(spec)) => bars(&format!("{key}.mesh.bars"), spec),
        Some(Mesh::Gmsh(file)) => read(world, key, "gmsh", file, ElementMesh::read_gmsh),
        Some(Mesh::Abaqus(file)) => read(world, key, "abaqus", file, ElementMesh::read_abaqus),
        Some(Mesh::Edge(edge)) => match &body.shape {
            Some(shape) => {
                let (shape, motion) = Motion::<D>::of(&format!("{key}.shape"), shape)?;
                if world.revolved() && matches!(shape, Shape::Ball(_)) {
                    let radius =
                        |r: f64| motion.place(std::array::from_fn(|d| if d == 0 { r } else { 0.0 }))[0];
                    if radius(0.0) != 0.0 || radius(1.0) != 1.0 {
                        let message = "a meshed ball stays on the axis: it moves along it alone";
                        return wrong(format!("{key}.shape"), message);
                    }
                }
                let mut mesh = regular(world, &format!("{key}.mesh"), shape, edge)?;
                mesh.nodes.iter_mut().for_each(|x| *x = motion.place(*x));
                Ok(mesh)
            }
            None => wrong(key, "a mesh by its `edge` is of a `shape`"),
        },
    }
}

/// Generate a mesh of bars, each with nodes of its own.
fn bars<const D: usize>(key: &str, spec: &Bars) -> Made<ElementMesh<D>> {
    let (edge, most) = (spec.edge.value, 1e6);
    if edge <= 0.0 {
        return wrong(format!("{key}.edge"), format!("{edge} m is not allowed; it must be positive"));
    }
    let (mut nodes, mut links) = (Vec::new(), Vec::new());
    for (n, [from, to]) in spec.lines.iter().enumerate() {
        let key = format!("{key}.lines[{n}]");
        let (from, to): ([f64; D], [f64; D]) = (fixed(from).at(&key)?, fixed(to).at(&key)?);
        let length = (0..D).map(|d| (to[d] - from[d]).powi(2)).sum::<f64>().sqrt();
        let parts = (length / edge).round().max(1.0);
        if length == 0.0 || parts > most {
            return wrong(key, format!("is {length} m long, {parts} elements; 1 to {most} are allowed"));
        }
        for n in 0..=parts as u32 {
            let part = f64::from(n) / parts;
            if n > 0 {
                let last = nodes.len() as u32;
                links.extend([last - 1, last]);
            }
            nodes.push(std::array::from_fn(|d| from[d] + part * (to[d] - from[d])));
        }
    }
    if links.is_empty() {
        return wrong(format!("{key}.lines"), "needs a bar");
    }
    let block = ElementBlock { name: "bars".into(), kind: ElementKind::Bar2, nodes: links };
    Ok(ElementMesh { nodes, blocks: vec![block], ..ElementMesh::default() })
}

fn read<const D: usize>(
    world: &World<'_, D>,
    key: &str,
    word: &str,
    file: &MeshFile,
    read: impl Fn(std::path::PathBuf, f64) -> Result<ElementMesh<D>, impactite::geometry::GeometryError>,
) -> Made<ElementMesh<D>> {
    let key = format!("{key}.mesh.{word}");
    let mesh = read(world.folder.0.join(&file.file), file.unit.value).at(&key)?;
    let key = format!("{key}.groups");
    match file.groups.as_deref() {
        None => Ok(mesh),
        Some([]) => wrong(key, "needs the name of a group; without the key the body has all elements"),
        Some(names) => mesh.only_groups(names).at(key),
    }
}

/// Return the groups of a mesh file that divide its elements completely, if the body selects no group: the file may have several materials.
pub(crate) fn divided<const D: usize>(folder: &Folder, mesh: &Mesh) -> Option<(&'static str, Vec<String>)> {
    let (word, file) = match mesh {
        Mesh::Gmsh(file) => ("gmsh", file),
        Mesh::Abaqus(file) => ("abaqus", file),
        Mesh::Edge(_) | Mesh::Bars(_) => return None,
    };
    if file.groups.is_some() {
        return None;
    }
    let path = folder.0.join(&file.file);
    let mesh = match mesh {
        Mesh::Gmsh(_) => ElementMesh::<D>::read_gmsh(path, file.unit.value),
        _ => ElementMesh::<D>::read_abaqus(path, file.unit.value),
    };
    let mesh = mesh.ok()?;
    let elements = mesh.elements();
    let parts: Vec<String> = mesh
        .groups()
        .into_iter()
        .filter(|(_, count)| *count < elements)
        .map(|(name, _)| name.into())
        .collect();
    let together = mesh.only_groups(&parts).ok()?.elements();
    (parts.len() > 1 && together == elements).then_some((word, parts))
}

/// Generate a regular mesh with edges of about this length.
fn regular<const D: usize>(
    world: &World<'_, D>,
    key: &str,
    shape: &Shape,
    edge: &Quantity<Length>,
) -> Made<ElementMesh<D>> {
    let edge = edge.value;
    if edge <= 0.0 {
        return wrong(format!("{key}.edge"), format!("{edge} m is not allowed; it must be positive"));
    }
    let count = |length: f64| (length / edge).round().clamp(1.0, 1e9) as usize;
    match (shape, D) {
        (Shape::Box(s), _) => {
            let (from, to): ([f64; D], [f64; D]) = (fixed(&s.from).at(key)?, fixed(&s.to).at(key)?);
            let cuboid = Cuboid::new(from, to).at(key)?;
            let counts: [usize; D] = std::array::from_fn(|d| count(cuboid.max()[d] - cuboid.min()[d]));
            box_mesh(&cuboid, counts).at(key)
        }
        (Shape::Ball(s), 2) if world.revolved() => {
            let ball = Ball::new(fixed::<2, _>(&s.centre).at(key)?, s.radius.value).at(key)?;
            let section = Butterfly::of_edge(s.radius.value, edge).at(key)?;
            same(key, half_disc_mesh(&ball, section).at(key)?)
        }
        (Shape::Ball(s), _) => {
            let ball = Ball::<D>::new(fixed(&s.centre).at(key)?, s.radius.value).at(key)?;
            ball_mesh(&ball, Butterfly::of_edge(s.radius.value, edge).at(key)?).at(key)
        }
        (Shape::Cylinder(s), 3) => {
            let (start, direction) = (fixed(&s.start).at(key)?, fixed(&s.direction).at(key)?);
            let rod = Cylinder::<3>::new(start, direction, s.length.value, s.radius.value).at(key)?;
            let section = Butterfly::of_edge(s.radius.value, edge).at(key)?;
            same(key, cylinder_mesh(&rod, section, count(s.length.value)).at(key)?)
        }
        (Shape::Tube(s), 3) => {
            let (start, direction) = (fixed(&s.start).at(key)?, fixed(&s.direction).at(key)?);
            let tube =
                Tube::<3>::new(start, direction, s.length.value, s.inner.value, s.outer.value).at(key)?;
            let around = count(std::f64::consts::PI * (s.inner.value + s.outer.value)).max(3);
            let section = [count(s.outer.value - s.inner.value), around];
            same(key, tube_mesh(&tube, section, count(s.length.value)).at(key)?)
        }
        _ => wrong(
            key,
            "regular meshes are of `box` and `ball`, in space also of `cylinder` and `tube`, each of them also `moved`; others come from files of Gmsh or Abaqus",
        ),
    }
}

/// Convert a mesh of `N` dimensions to `D` dimensions, which must be equal.
fn same<const N: usize, const D: usize>(key: &str, mesh: ElementMesh<N>) -> Made<ElementMesh<D>> {
    let any: Box<dyn std::any::Any> = Box::new(mesh);
    match any.downcast() {
        Ok(mesh) => Ok(*mesh),
        Err(_) => wrong(key, format!("is of {N} dimensions")),
    }
}

/// Build a body of finite elements.
pub(super) fn body<const D: usize>(world: &World<'_, D>, name: &str, body: &Body) -> Made<MeshBody<D>> {
    let key = format!("bodies.{name}");
    let mesh = of(world, &key, body)?;
    let velocity = world.velocity(&key, body, || lumped_centre(&key, &mesh))?;
    // Bars have a uniaxial strain and no choice of integration.
    let kinds: Vec<ElementKind> =
        mesh.blocks.iter().map(|block| block.kind).filter(|kind| *kind != ElementKind::Bar2).collect();
    let mut made = MeshBody::new(name, mesh, world.law(&key, body)?.material).moving(move |x| velocity(x));
    if let Some(Mesh::Bars(spec)) = &body.mesh {
        made = made.section(spec.section.value);
    }
    let made = match &body.integration {
        Some(integration) => kinds.iter().try_fold(made, |made, &kind| {
            Ok::<_, Wrong>(made.with(kind, technology(&format!("{key}.integration"), integration)?))
        })?,
        None => made,
    };
    let Some(spec) = &body.erosion else { return Ok(made) };
    let mut erosion = Erosion::none();
    if let Some(strain) = spec.plastic_strain {
        erosion = erosion
            .or(impactite::fem::Criterion::State { name: "plastic_strain".into(), at_least: strain.value });
    }
    if spec.failed {
        erosion = erosion.or(impactite::fem::Criterion::Failed);
    }
    if let Some(volume) = spec.volume {
        erosion = erosion.or(impactite::fem::Criterion::Volume(volume.value));
    }
    if let Some(step) = spec.step {
        erosion = erosion.or(impactite::fem::Criterion::Step(step.value));
    }
    Ok(made.eroding(erosion))
}

/// Return the integration technology of elements.
fn technology(key: &str, integration: &Integration) -> Made<Technology> {
    Ok(match integration {
        Integration::Full => Technology::Full,
        Integration::MeanDilatation => Technology::MeanDilatation,
        Integration::AveragedVolumes => Technology::AveragedVolumes,
        Integration::OnePoint(control) => {
            Technology::OnePoint(match (control.stiffness, control.viscosity) {
                (Some(_), Some(_)) => {
                    return wrong(format!("{key}.one_point"), "either `stiffness` or `viscosity`");
                }
                (None, Some(viscosity)) => Hourglass::Viscous(viscosity.value),
                (stiffness, None) => Hourglass::Stiffness(stiffness.map_or(HOURGLASS_STIFFNESS, |q| q.value)),
            })
        }
    })
}

/// Return the centre of mass of a mesh whose elements distribute their mass to their nodes equally, m.
fn lumped_centre<const D: usize>(key: &str, mesh: &ElementMesh<D>) -> Made<[f64; D]> {
    let measures = mesh.measures(Metric::Cartesian).at(key)?;
    let elements = mesh.blocks.iter().flat_map(|block| block.nodes.chunks(block.kind.nodes()));
    Ok(centre_of_mass(elements.zip(measures).flat_map(|(nodes, measure)| {
        let part = measure / nodes.len() as f64;
        nodes.iter().map(move |&n| (mesh.nodes[n as usize], part))
    })))
}
