//! Geometric shapes from their specification.

use std::sync::Arc;

use impactite::geometry::{
    Ball, Compose, Cuboid, Cylinder, Frustum, HalfSpace, OgiveRod, Polygon, Shape, Shell, TriangleMesh, Tube,
};

use nalgebra::Rotation;

use super::wrong::{At, Folder, Made, wrong};
use crate::model::shape::{MovedShape, Shape as Spec};
use crate::model::{Vector, fixed};
use crate::quantity::Length;

type AnyShape<const D: usize> = Arc<dyn Shape<D>>;

/// Build the shape of a specification, in `D` dimensions.
pub(crate) fn build<const D: usize>(key: &str, spec: &Spec, folder: &Folder) -> Made<AnyShape<D>> {
    macro_rules! point {
        ($list:expr, $field:literal) => {
            fixed::<D, _>($list).at(format!("{key}.{}.{}", word(spec), $field))?
        };
    }
    let here = format!("{key}.{}", word(spec));
    Ok(match spec {
        Spec::Box(s) => Arc::new(Cuboid::new(point!(&s.from, "from"), point!(&s.to, "to")).at(here)?),
        Spec::Ball(s) => Arc::new(Ball::new(point!(&s.centre, "centre"), s.radius.value).at(here)?),
        Spec::Shell(s) => {
            Arc::new(Shell::new(point!(&s.centre, "centre"), s.inner.value, s.outer.value).at(here)?)
        }
        Spec::Cylinder(s) => {
            let (start, direction) = (point!(&s.start, "start"), point!(&s.direction, "direction"));
            Arc::new(Cylinder::new(start, direction, s.length.value, s.radius.value).at(here)?)
        }
        Spec::Tube(s) => {
            let (start, direction) = (point!(&s.start, "start"), point!(&s.direction, "direction"));
            Arc::new(Tube::new(start, direction, s.length.value, s.inner.value, s.outer.value).at(here)?)
        }
        Spec::Frustum(s) => {
            let (start, direction) = (point!(&s.start, "start"), point!(&s.direction, "direction"));
            let radii = s.radii.map(|r| r.value);
            Arc::new(Frustum::new(start, direction, s.length.value, radii).at(here)?)
        }
        Spec::OgiveRod(s) => {
            let (tail, direction) = (point!(&s.tail, "tail"), point!(&s.direction, "direction"));
            let rod = OgiveRod::new(tail, direction, s.diameter.value, s.length.value, s.crh.value);
            Arc::new(rod.at(here)?)
        }
        Spec::HalfSpace(s) => {
            Arc::new(HalfSpace::new(point!(&s.point, "point"), point!(&s.outward, "outward")).at(here)?)
        }
        Spec::Polygon(s) => {
            let corners = s.corners.iter().map(|c| c.map(|x| x.value)).collect();
            let polygon: AnyShape<2> = Arc::new(Polygon::new(corners).at(&here)?);
            of_dimension(polygon).ok_or(()).or_else(|()| wrong(here, "a polygon is a shape of the plane"))?
        }
        Spec::Surface(s) => {
            let path = folder.0.join(&s.file);
            let is = |ending| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
            let read = if is("obj") {
                TriangleMesh::read_obj(path, s.unit.value)
            } else if is("ply") {
                TriangleMesh::read_ply(path, s.unit.value)
            } else {
                TriangleMesh::read_stl(path, s.unit.value)
            };
            let surface: AnyShape<3> = Arc::new(read.at(&here)?);
            of_dimension(surface)
                .ok_or(())
                .or_else(|()| wrong(here, "a surface of triangles is a shape of space"))?
        }
        Spec::Union(list) => folded(&here, list, folder, |a, b| Arc::new(a.or(b)))?,
        Spec::Intersection(list) => folded(&here, list, folder, |a, b| Arc::new(a.and(b)))?,
        Spec::Difference(list) => folded(&here, list, folder, |a, b| Arc::new(a.minus(b)))?,
        Spec::Moved(s) => moved(&here, s, folder)?,
        Spec::Body(name) => {
            return wrong(here, format!("no body has the name `{name}` and a shape that is not its own"));
        }
    })
}

fn folded<const D: usize>(
    key: &str,
    list: &[Spec],
    folder: &Folder,
    join: impl Fn(AnyShape<D>, AnyShape<D>) -> AnyShape<D>,
) -> Made<AnyShape<D>> {
    let mut all = None;
    for (n, spec) in list.iter().enumerate() {
        let next = build(&format!("{key}[{n}]"), spec, folder)?;
        all = Some(match all {
            Some(before) => join(before, next),
            None => next,
        });
    }
    all.map_or_else(|| wrong(key, "needs at least one shape"), Ok)
}

fn moved<const D: usize>(key: &str, spec: &MovedShape, folder: &Folder) -> Made<AnyShape<D>> {
    let mut shape = build::<D>(&format!("{key}.shape"), &spec.shape, folder)?;
    if let Some(turn) = &spec.turn {
        let pivot = match &spec.about {
            Some(about) => fixed(about).at(format!("{key}.about"))?,
            None => [0.0; D],
        };
        shape = Arc::new(shape.rotated(rotation(key, spec, turn.value)?, pivot).at(key)?);
    } else if spec.axis.is_some() || spec.about.is_some() {
        return wrong(key, "`axis` and `about` are of a `turn`");
    }
    if let Some(by) = &spec.by {
        let by = fixed(by).at(format!("{key}.by"))?;
        shape = Arc::new(shape.translated(by).at(key)?);
    }
    Ok(shape)
}

/// Return the rotation of a moved shape by an angle, rad: from x to y in the plane, about an axis in space (Rodrigues' formula).
fn rotation<const D: usize>(key: &str, spec: &MovedShape, angle: f64) -> Made<Rotation<f64, D>> {
    let [x, y, z] = match (&spec.axis, D) {
        (None, 2) => [0.0, 0.0, 1.0],
        (Some(axis), 3) => {
            let axis: [f64; 3] = fixed(axis).at(format!("{key}.axis"))?;
            let length = axis.iter().map(|c| c * c).sum::<f64>().sqrt();
            if !(length > 0.0 && length.is_finite()) {
                return wrong(format!("{key}.axis"), "the axis needs a length");
            }
            axis.map(|c| c / length)
        }
        (Some(_), _) => return wrong(format!("{key}.axis"), "in the plane a turn needs no axis"),
        (None, _) => return wrong(key, "a turn in space needs an `axis`"),
    };
    let (s, c) = angle.sin_cos();
    let k = 1.0 - c;
    let matrix = [
        [c + x * x * k, x * y * k - z * s, x * z * k + y * s],
        [y * x * k + z * s, c + y * y * k, y * z * k - x * s],
        [z * x * k - y * s, z * y * k + x * s, c + z * z * k],
    ];
    Ok(Rotation::from_matrix_unchecked(nalgebra::SMatrix::from_fn(|i, j| matrix[i][j])))
}

/// Rigid motions of a shape, innermost first: rotation about a centre, and translation, m.
#[derive(Clone, Default)]
pub(super) struct Motion<const D: usize>(Vec<(Rotation<f64, D>, [f64; D], [f64; D])>);

impl<const D: usize> Motion<D> {
    /// Split a shape into the innermost one that is not moved, and its motion.
    pub fn of<'a>(key: &str, spec: &'a Spec) -> Made<(&'a Spec, Self)> {
        let Spec::Moved(moved) = spec else { return Ok((spec, Motion(Vec::new()))) };
        let (inner, mut motion) = Motion::of(&format!("{key}.moved.shape"), &moved.shape)?;
        let part = |list: &Option<Vector<Length>>| {
            list.as_ref().map_or(Ok([0.0; D]), |list| fixed::<D, _>(list).at(format!("{key}.moved")))
        };
        let rotation = match &moved.turn {
            Some(turn) => rotation(&format!("{key}.moved"), moved, turn.value)?,
            None => Rotation::identity(),
        };
        motion.0.push((rotation, part(&moved.about)?, part(&moved.by)?));
        Ok((inner, motion))
    }

    /// Map a position of the unmoved shape to the scene.
    pub fn place(&self, x: [f64; D]) -> [f64; D] {
        self.0.iter().fold(x, |x, (rotation, about, by)| {
            let arm = nalgebra::SVector::<f64, D>::from_fn(|d, _| x[d] - about[d]);
            let turned = rotation * arm;
            std::array::from_fn(|d| turned[d] + about[d] + by[d])
        })
    }
}

/// Box with its rigid motions.
pub(super) struct MovedBox<const D: usize> {
    pub low: [f64; D],
    pub high: [f64; D],
    moves: Motion<D>,
}

impl<const D: usize> MovedBox<D> {
    /// Create a box with edges along the axes.
    #[cfg(test)]
    pub fn along(low: [f64; D], high: [f64; D]) -> Self {
        MovedBox { low, high, moves: Motion(Vec::new()) }
    }

    /// Return the half sizes along the axes of the scene, m, of cells with the half sizes `half` along those of the box, m: exact for
    /// quarter turns, else of equal volume.
    pub fn turned(&self, half: [f64; D]) -> [f64; D] {
        if self.moves.0.is_empty() {
            return half;
        }
        let turn = self.moves.0.iter().fold(Rotation::<f64, D>::identity(), |turn, (next, ..)| next * turn);
        let wide: [f64; D] =
            std::array::from_fn(|i| (0..D).map(|j| turn.matrix()[(i, j)].abs() * half[j]).sum::<f64>());
        let part = half.iter().product::<f64>() / wide.iter().product::<f64>();
        wide.map(|w| w * part.powf(1.0 / D as f64))
    }

    /// Return the box of a shape; `None` for other shapes. Translations before the first rotation are those of the box.
    pub fn of(spec: &Spec) -> Option<Self> {
        let (inner, mut moves) = Motion::of("", spec).ok()?;
        let Spec::Box(spec) = inner else { return None };
        let (from, to): ([f64; D], [f64; D]) = (fixed(&spec.from).ok()?, fixed(&spec.to).ok()?);
        let mut low: [f64; D] = std::array::from_fn(|d| from[d].min(to[d]));
        let mut high: [f64; D] = std::array::from_fn(|d| from[d].max(to[d]));
        let turned = moves.0.iter().position(|(rotation, ..)| *rotation != Rotation::identity());
        for (_, _, by) in moves.0.drain(..turned.unwrap_or(moves.0.len())) {
            (0..D).for_each(|d| (low[d], high[d]) = (low[d] + by[d], high[d] + by[d]));
        }
        Some(MovedBox { low, high, moves })
    }

    /// True if the edges are along the axes.
    pub fn along_axes(&self) -> bool {
        self.moves.0.is_empty()
    }

    /// Map a position of the unmoved box to the scene.
    pub fn place(&self, x: [f64; D]) -> [f64; D] {
        self.moves.place(x)
    }
}

/// Convert a shape of `N` dimensions to `D` dimensions, which must be equal.
fn of_dimension<const N: usize, const D: usize>(shape: AnyShape<N>) -> Option<AnyShape<D>> {
    let any: Box<dyn std::any::Any> = Box::new(shape);
    any.downcast::<AnyShape<D>>().ok().map(|shape| *shape)
}

fn word(spec: &Spec) -> &'static str {
    match spec {
        Spec::Box(_) => "box",
        Spec::Ball(_) => "ball",
        Spec::Shell(_) => "shell",
        Spec::Cylinder(_) => "cylinder",
        Spec::Tube(_) => "tube",
        Spec::Frustum(_) => "frustum",
        Spec::OgiveRod(_) => "ogive_rod",
        Spec::Polygon(_) => "polygon",
        Spec::HalfSpace(_) => "half_space",
        Spec::Surface(_) => "surface",
        Spec::Union(_) => "union",
        Spec::Intersection(_) => "intersection",
        Spec::Difference(_) => "difference",
        Spec::Moved(_) => "moved",
        Spec::Body(_) => "body",
    }
}
