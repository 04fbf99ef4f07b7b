//! Size of a scene before it is built: number of points and memory.

use impactite::geometry::Shape as _;

use super::common::World;
use super::kinds::is_solid;
use super::wrong::{Made, Wrong};
use crate::model::SceneFile;
use crate::model::body::{Body, Mesh};
use crate::model::method::{Method, Mpm};

/// Memory per point of a body with scratch and nodes, bytes: lower bounds from solvers for squares and cubes of 1000 to 300 000 points of
/// copper. A run needs more, so that no scene that fits is refused.
#[must_use]
pub fn bytes_a_point(method: &Method, dimensions: usize) -> f64 {
    match (method, dimensions) {
        (Method::Mpm(_), _) => 180.0,
        (Method::Fem(_), 3) => 450.0,
        (Method::Fem(_), _) => 260.0,
        (Method::Sph(_), 3) => 1700.0,
        (Method::Sph(_), _) => 1000.0,
        (Method::Fpm(_), 3) => 2500.0,
        (Method::Fpm(_), _) => 1100.0,
        (Method::Pcmm(_), _) => 400.0,
        (Method::Flow(_), _) => 100.0,
    }
}

/// Refuse a scene whose points exceed the free memory of this machine, before they are created.
pub(super) fn check<const D: usize>(world: &World<'_, D>) -> Made<()> {
    let Some(free) = free_memory() else { return Ok(()) };
    let mut points = 0.0;
    for (name, body) in &world.scene.expanded {
        points += points_of(world, name, body)?;
    }
    let (method, key) = match &world.scene.method {
        // The method refuses this number of particles per cell, with its own key.
        Method::Mpm(m) if m.particles_per_cell > 8 => return Ok(()),
        method @ Method::Mpm(_) => (method, "method.mpm.cell".to_string()),
        method @ Method::Sph(_) => (method, "method.sph.spacing".into()),
        method @ Method::Fpm(_) => (method, "method.fpm.spacing".into()),
        method @ Method::Pcmm(_) => (method, "method.pcmm.spacing".into()),
        Method::Flow(m) if m.particles_per_cell > 8 => return Ok(()),
        method @ Method::Flow(_) => (method, "method.flow.cell".into()),
        method @ Method::Fem(_) => {
            let finest = world.scene.expanded.iter().max_by(|a, b| {
                let edge = |body: &Body| edge_of(body).map_or(0.0, |e| 1.0 / e);
                edge(a.1).total_cmp(&edge(b.1))
            });
            (method, finest.map_or("bodies".into(), |(name, _)| format!("bodies.{name}.mesh.edge")))
        }
    };
    let bytes = points * bytes_a_point(method, D);
    // A size of zero is refused by the method, with its own key.
    if bytes <= free || bytes.is_infinite() {
        return Ok(());
    }
    let coarser = (bytes / free).powf(1.0 / D as f64) * 1.05;
    Err(Wrong {
        key,
        message: format!(
            "makes about {points:.3e} points, which take {} of memory or more; {} are free",
            size(bytes),
            size(free)
        ),
        help: Some(format!(
            "use a {coarser:.2} times larger value, model a part by `symmetry`, or look at the units of shapes"
        )),
    })
}

fn edge_of(body: &Body) -> Option<f64> {
    match &body.mesh {
        Some(Mesh::Edge(edge)) => Some(edge.value),
        _ => None,
    }
}

/// Return the point spacing of a body, m; `None` if it follows from a file.
pub(crate) fn spacing(scene: &SceneFile, body: &Body) -> Option<f64> {
    let of_particles = |m: &Mpm| Some(m.cell.value / f64::from(m.particles_per_cell.max(1)));
    match (&scene.method, edge_of(body)) {
        (Method::Mpm(_) | Method::Fem(_) | Method::Flow(_), Some(edge)) => Some(edge),
        (Method::Mpm(m), None) => of_particles(m),
        (Method::Sph(m), _) => Some(m.spacing.value),
        (Method::Fpm(m), _) => Some(m.spacing.value),
        (Method::Pcmm(m), _) => Some(m.spacing.value),
        (Method::Flow(m), None) if is_solid(scene, body) => of_particles(&m.method_of_solids()),
        (Method::Flow(m), None) => Some(m.cell.value / f64::from(m.particles_per_cell.max(1))),
        (Method::Fem(_), None) => None,
    }
}

/// Estimate the number of points of a body; 0 if it follows from a file.
fn points_of<const D: usize>(world: &World<'_, D>, name: &str, body: &Body) -> Made<f64> {
    let (true, Some(spacing)) = (body.shape.is_some(), spacing(world.scene, body)) else {
        return Ok(0.0);
    };
    let shape = world.shape(&format!("bodies.{name}"), body)?;
    let measure = shape.measure().or_else(|| sampled(&*shape)).unwrap_or(0.0);
    let points = measure.max(0.0) / spacing.powi(D as i32);
    Ok(if points.is_nan() { 0.0 } else { points })
}

/// Estimate the measure of a shape by sampling its bounds; `None` for infinite bounds.
fn sampled<const D: usize>(shape: &dyn impactite::geometry::Shape<D>) -> Option<f64> {
    const SAMPLES: usize = 16;
    let bounds = shape.bounds();
    let edges: [f64; D] = std::array::from_fn(|d| bounds.max[d] - bounds.min[d]);
    if edges.iter().any(|e| !e.is_finite()) {
        return None;
    }
    let all = SAMPLES.pow(D as u32);
    let inside = (0..all).filter(|n| {
        let place = |d: usize| (n / SAMPLES.pow(d as u32) % SAMPLES) as f64 + 0.5;
        shape.contains(std::array::from_fn(|d| bounds.min[d] + edges[d] * place(d) / SAMPLES as f64))
    });
    Some(inside.count() as f64 / all as f64 * edges.iter().product::<f64>())
}

/// Format a memory size with a suitable unit.
pub(crate) fn size(bytes: f64) -> String {
    let (unit, factor) = match bytes {
        b if b < 1e6 => ("kB", 1e3),
        b if b < 1e9 => ("MB", 1e6),
        b if b < 1e12 => ("GB", 1e9),
        _ => ("TB", 1e12),
    };
    format!("{:.1} {unit}", bytes / factor)
}

/// Return the memory that this process may still allocate, bytes: limits of machine, control group and address space. `None` without
/// `/proc`.
fn free_memory() -> Option<f64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let field = |text: &str, name: &str| -> Option<f64> {
        text.lines().find_map(|l| l.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
    };
    let machine = field(&read("/proc/meminfo")?, "MemAvailable:")? * 1024.0;
    let number = |path: &str| -> Option<f64> { read(path)?.trim().parse().ok() };
    let group = [
        ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
        ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"),
    ];
    let group = group.iter().filter_map(|(most, now)| Some(number(most)? - number(now)?));
    let addresses = read("/proc/self/limits").and_then(|limits| field(&limits, "Max address space"));
    let taken =
        read("/proc/self/status").and_then(|status| field(&status, "VmSize:")).unwrap_or(0.0) * 1024.0;
    let own = addresses.map(|most| most - taken);
    Some(group.chain(own).fold(machine, f64::min).max(0.0))
}
