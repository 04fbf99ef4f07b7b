//! Primitive shapes.

use std::f64::consts::PI;

use super::bounds::Bounds;
use super::error::{Check, GeometryError};
use super::shape::Shape;
use super::vector::{along, dot, norm, sub};

/// Signed distance to a box with half edges `half` about the origin.
#[inline]
fn box_distance<const D: usize>(x: [f64; D], half: [f64; D]) -> f64 {
    let (mut outside, mut inside) = (0.0, f64::NEG_INFINITY);
    for i in 0..D {
        let q = x[i].abs() - half[i];
        let positive = q.max(0.0);
        outside += positive * positive;
        inside = inside.max(q);
    }
    if outside > 0.0 { outside.sqrt() } else { inside }
}

/// Axis-aligned box: an interval, rectangle or cuboid. Exact distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid<const D: usize> {
    min: [f64; D],
    max: [f64; D],
}

impl<const D: usize> Cuboid<D> {
    /// Create the box between two opposite corners (m), in any order.
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the corners are finite and differ in every coordinate.
    pub fn new(corner: [f64; D], opposite: [f64; D]) -> Result<Self, GeometryError> {
        let check = Check("Cuboid");
        check.point("corner", corner)?;
        check.point("opposite", opposite)?;
        let b = Bounds::around([corner, opposite]);
        for i in 0..D {
            check.that(
                b.max[i] > b.min[i],
                "opposite",
                opposite[i],
                "different from `corner` in every coordinate",
            )?;
        }
        Ok(Self { min: b.min, max: b.max })
    }
    /// Corner of smallest coordinates (m).
    pub fn min(&self) -> [f64; D] {
        self.min
    }
    /// Corner of largest coordinates (m).
    pub fn max(&self) -> [f64; D] {
        self.max
    }
}

impl<const D: usize> Shape<D> for Cuboid<D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        // Measured from the faces, not from centre and half edges: the distance on a face is exactly zero.
        let (mut outside, mut inside) = (0.0, f64::NEG_INFINITY);
        for i in 0..D {
            let q = (self.min[i] - x[i]).max(x[i] - self.max[i]);
            let positive = q.max(0.0);
            outside += positive * positive;
            inside = inside.max(q);
        }
        if outside > 0.0 { outside.sqrt() } else { inside }
    }
    fn bounds(&self) -> Bounds<D> {
        Bounds { min: self.min, max: self.max }
    }
    fn exact_distance(&self) -> bool {
        true
    }
    fn measure(&self) -> Option<f64> {
        let mut v = 1.0;
        for i in 0..D {
            v *= self.max[i] - self.min[i];
        }
        Some(v)
    }
    fn centroid(&self) -> Option<[f64; D]> {
        let mut c = [0.0; D];
        for i in 0..D {
            c[i] = 0.5 * (self.min[i] + self.max[i]);
        }
        Some(c)
    }
    fn revolved_measure(&self) -> Option<f64> {
        if D != 2 {
            return None;
        }
        let (inner, outer) = (self.min[0].max(0.0), self.max[0].max(0.0));
        Some(0.5 * (outer - inner) * (outer + inner) * (self.max[1] - self.min[1]))
    }
    fn convex(&self) -> bool {
        true
    }
}

/// Ball: a disc in 2D, a sphere in 3D. Exact distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball<const D: usize> {
    centre: [f64; D],
    radius: f64,
}

/// Disc (2D).
pub type Disc = Ball<2>;
/// Sphere (3D).
pub type Sphere = Ball<3>;

impl<const D: usize> Ball<D> {
    /// Create the ball about `centre` (m) of this `radius` (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the radius is positive and both are finite.
    pub fn new(centre: [f64; D], radius: f64) -> Result<Self, GeometryError> {
        let check = Check("Ball");
        Ok(Self { centre: check.point("centre", centre)?, radius: check.positive("radius", radius)? })
    }
    /// Centre (m).
    pub fn centre(&self) -> [f64; D] {
        self.centre
    }
    /// Radius (m).
    pub fn radius(&self) -> f64 {
        self.radius
    }
}

fn ball_measure<const D: usize>(radius: f64) -> Option<f64> {
    match D {
        1 => Some(2.0 * radius),
        2 => Some(PI * radius * radius),
        3 => Some(4.0 / 3.0 * PI * radius * radius * radius),
        _ => None,
    }
}

/// Integral of r over the part r > 0 of a disc about r = `centre`.
fn revolved_disc(centre: f64, radius: f64) -> f64 {
    if centre >= radius {
        PI * radius * radius * centre
    } else if centre <= -radius {
        0.0
    } else {
        let height = ((radius - centre) * (radius + centre)).sqrt();
        let area = radius * radius * (0.5 * PI + (centre / radius).asin()) + centre * height;
        centre * area + 2.0 / 3.0 * height.powi(3)
    }
}

impl<const D: usize> Shape<D> for Ball<D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        norm(sub(x, self.centre)) - self.radius
    }
    fn bounds(&self) -> Bounds<D> {
        Bounds { min: self.centre.map(|c| c - self.radius), max: self.centre.map(|c| c + self.radius) }
    }
    fn exact_distance(&self) -> bool {
        true
    }
    fn measure(&self) -> Option<f64> {
        ball_measure::<D>(self.radius)
    }
    fn centroid(&self) -> Option<[f64; D]> {
        Some(self.centre)
    }
    fn revolved_measure(&self) -> Option<f64> {
        if D == 2 { Some(revolved_disc(self.centre[0], self.radius)) } else { None }
    }
    fn convex(&self) -> bool {
        true
    }
}

/// Shell between two concentric balls: a ring in 2D, a hollow sphere in 3D. Exact distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shell<const D: usize> {
    pub(super) centre: [f64; D],
    pub(super) inner: f64,
    pub(super) outer: f64,
}

/// Plane ring, an annulus (2D). Its 3D counterpart is [`Tube`].
pub type Ring = Shell<2>;

impl<const D: usize> Shell<D> {
    /// Create the shell about `centre` (m) between the radii `inner` and `outer` (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless `0 < inner < outer` and all values are finite.
    pub fn new(centre: [f64; D], inner: f64, outer: f64) -> Result<Self, GeometryError> {
        let check = Check("Shell");
        check.point("centre", centre)?;
        check.positive("inner", inner)?;
        check.that(outer > inner, "outer", outer, "larger than `inner`, and finite")?;
        Ok(Self { centre, inner, outer })
    }
}

impl<const D: usize> Shape<D> for Shell<D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        let r = norm(sub(x, self.centre));
        (r - self.outer).max(self.inner - r)
    }
    fn bounds(&self) -> Bounds<D> {
        Bounds { min: self.centre.map(|c| c - self.outer), max: self.centre.map(|c| c + self.outer) }
    }
    fn exact_distance(&self) -> bool {
        true
    }
    fn measure(&self) -> Option<f64> {
        Some(ball_measure::<D>(self.outer)? - ball_measure::<D>(self.inner)?)
    }
    fn centroid(&self) -> Option<[f64; D]> {
        Some(self.centre)
    }
    fn revolved_measure(&self) -> Option<f64> {
        let c = self.centre.first().copied()?;
        if D == 2 { Some(revolved_disc(c, self.outer) - revolved_disc(c, self.inner)) } else { None }
    }
}

/// Half-space on one side of a plane (3D) or line (2D). Unbounded: combine it with a bounded shape.
/// Exact distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace<const D: usize> {
    point: [f64; D],
    normal: [f64; D],
}

impl<const D: usize> HalfSpace<D> {
    /// Create the half-space bounded by the plane through `point` (m), with the outward normal `outward` (any length).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless `outward` is not zero and all values are finite.
    pub fn new(point: [f64; D], outward: [f64; D]) -> Result<Self, GeometryError> {
        let check = Check("half-space");
        Ok(Self { point: check.point("point", point)?, normal: check.direction("outward", outward)? })
    }
}

impl<const D: usize> Shape<D> for HalfSpace<D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        dot(sub(x, self.point), self.normal)
    }
    fn bounds(&self) -> Bounds<D> {
        let mut b = Bounds::EVERYTHING;
        for i in 0..D {
            if self.normal[i] == 1.0 {
                b.max[i] = self.point[i];
            } else if self.normal[i] == -1.0 {
                b.min[i] = self.point[i];
            }
        }
        b
    }
    fn exact_distance(&self) -> bool {
        true
    }
    fn convex(&self) -> bool {
        true
    }
}

/// Axis of a rod: start point and unit direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axis<const D: usize> {
    pub(super) start: [f64; D],
    pub(super) direction: [f64; D],
}

impl<const D: usize> Axis<D> {
    /// Axial and radial coordinate of `x`, the latter not negative.
    #[inline]
    fn meridian(&self, x: [f64; D]) -> [f64; 2] {
        let from_start = sub(x, self.start);
        let z = dot(from_start, self.direction);
        [z, norm(along(from_start, -z, self.direction))]
    }
    fn at(&self, z: f64) -> [f64; D] {
        along(self.start, z, self.direction)
    }
    /// Bounding box of a body of revolution with the support function `support(cos, sin)` in the meridian plane: the maximum of
    /// `z cos + r sin` over the body.
    fn bounds(&self, support: impl Fn(f64, f64) -> f64) -> Bounds<D> {
        let mut b = Bounds { min: self.start, max: self.start };
        for i in 0..D {
            let cos = self.direction[i];
            let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
            b.max[i] += support(cos, sin);
            b.min[i] -= support(-cos, sin);
        }
        b
    }
    /// Volume per radian of a body of revolution of this `volume` about this axis, if this is the axis r = 0
    /// of the plane (r, z); else from area and centroid.
    fn revolved(&self, volume: f64, shape: &impl Shape<D>) -> Option<f64> {
        if D != 2 {
            None
        } else if self.start[0] == 0.0 && self.direction[0] == 0.0 {
            Some(volume / (2.0 * PI))
        } else if shape.bounds().min[0] >= 0.0 {
            Some(shape.measure()? * shape.centroid()?[0])
        } else {
            None
        }
    }
}

/// Right circular cylinder about any axis. In 2D its axial section: a rectangle at any angle, which
/// about the axis r = 0 of axisymmetric coordinates represents the cylinder. Exact distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder<const D: usize> {
    pub(super) axis: Axis<D>,
    pub(super) length: f64,
    pub(super) radius: f64,
}

impl<const D: usize> Cylinder<D> {
    /// Create it from the centre of one end (m), the direction of the axis (any length), length and radius (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless length and radius are positive, `direction` is not zero and all values are
    /// finite.
    pub fn new(
        start: [f64; D],
        direction: [f64; D],
        length: f64,
        radius: f64,
    ) -> Result<Self, GeometryError> {
        let check = Check("Cylinder");
        Ok(Self {
            axis: Axis {
                start: check.point("start", start)?,
                direction: check.direction("direction", direction)?,
            },
            length: check.positive("length", length)?,
            radius: check.positive("radius", radius)?,
        })
    }
    fn volume(&self) -> f64 {
        PI * self.radius * self.radius * self.length
    }
}

impl<const D: usize> Shape<D> for Cylinder<D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        let [z, r] = self.axis.meridian(x);
        box_distance([z - 0.5 * self.length, r], [0.5 * self.length, self.radius])
    }
    fn bounds(&self) -> Bounds<D> {
        self.axis.bounds(|cos, sin| (self.length * cos).max(0.0) + self.radius * sin)
    }
    fn exact_distance(&self) -> bool {
        true
    }
    fn measure(&self) -> Option<f64> {
        match D {
            2 => Some(2.0 * self.radius * self.length),
            3 => Some(self.volume()),
            _ => None,
        }
    }
    fn centroid(&self) -> Option<[f64; D]> {
        Some(self.axis.at(0.5 * self.length))
    }
    fn revolved_measure(&self) -> Option<f64> {
        self.axis.revolved(self.volume(), self)
    }
    fn convex(&self) -> bool {
        true
    }
}

/// Straight tube about any axis; in 2D its axial section, two parallel bars. Exact distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tube<const D: usize> {
    pub(super) axis: Axis<D>,
    pub(super) length: f64,
    pub(super) inner: f64,
    pub(super) outer: f64,
}

impl<const D: usize> Tube<D> {
    /// Create it from the centre of one end (m), the direction of the axis (any length), length and radii (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the length is positive, `0 < inner < outer`, `direction` is not
    /// zero and all values are finite.
    pub fn new(
        start: [f64; D],
        direction: [f64; D],
        length: f64,
        inner: f64,
        outer: f64,
    ) -> Result<Self, GeometryError> {
        let check = Check("Tube");
        Ok(Self {
            axis: Axis {
                start: check.point("start", start)?,
                direction: check.direction("direction", direction)?,
            },
            length: check.positive("length", length)?,
            inner: check.positive("inner", inner)?,
            outer: check.that(outer > inner, "outer", outer, "larger than `inner`, and finite")?,
        })
    }
    fn volume(&self) -> f64 {
        PI * (self.outer - self.inner) * (self.outer + self.inner) * self.length
    }
}

impl<const D: usize> Shape<D> for Tube<D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        let [z, r] = self.axis.meridian(x);
        let (mean, half) = (0.5 * (self.inner + self.outer), 0.5 * (self.outer - self.inner));
        box_distance([z - 0.5 * self.length, r - mean], [0.5 * self.length, half])
    }
    fn bounds(&self) -> Bounds<D> {
        self.axis.bounds(|cos, sin| (self.length * cos).max(0.0) + self.outer * sin)
    }
    fn exact_distance(&self) -> bool {
        true
    }
    fn measure(&self) -> Option<f64> {
        match D {
            2 => Some(2.0 * (self.outer - self.inner) * self.length),
            3 => Some(self.volume()),
            _ => None,
        }
    }
    fn centroid(&self) -> Option<[f64; D]> {
        Some(self.axis.at(0.5 * self.length))
    }
    fn revolved_measure(&self) -> Option<f64> {
        self.axis.revolved(self.volume(), self)
    }
}

/// Truncated cone about any axis, or a full cone if one radius is zero; in 2D its axial section.
/// Exact distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum<const D: usize> {
    axis: Axis<D>,
    length: f64,
    radii: [f64; 2],
}

impl<const D: usize> Frustum<D> {
    /// Create it from the centre of the first end (m), the direction towards the second (any length), length, and the
    /// radius at each end (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the length is positive, the radii are not negative and not both
    /// zero, `direction` is not zero and all values are finite.
    pub fn new(
        start: [f64; D],
        direction: [f64; D],
        length: f64,
        radii: [f64; 2],
    ) -> Result<Self, GeometryError> {
        let check = Check("Frustum");
        for radius in radii {
            check.that(radius >= 0.0, "radii", radius, "zero or positive, and finite")?;
        }
        check.that(radii[0] + radii[1] > 0.0, "radii", radii[1], "positive at one end at least")?;
        Ok(Self {
            axis: Axis {
                start: check.point("start", start)?,
                direction: check.direction("direction", direction)?,
            },
            length: check.positive("length", length)?,
            radii,
        })
    }
    fn volume(&self) -> f64 {
        let [a, b] = self.radii;
        PI / 3.0 * self.length * (a * a + a * b + b * b)
    }
}

/// Distance from `p` to the segment from `a` to `b`.
pub(super) fn segment_distance<const D: usize>(p: [f64; D], a: [f64; D], b: [f64; D]) -> f64 {
    let (ap, ab) = (sub(p, a), sub(b, a));
    let square = dot(ab, ab);
    let t = if square > 0.0 { (dot(ap, ab) / square).clamp(0.0, 1.0) } else { 0.0 };
    norm(along(ap, -t, ab))
}

impl<const D: usize> Shape<D> for Frustum<D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        let p = self.axis.meridian(x);
        let (l, [a, b]) = (self.length, self.radii);
        let distance = segment_distance(p, [0.0, 0.0], [0.0, a])
            .min(segment_distance(p, [0.0, a], [l, b]))
            .min(segment_distance(p, [l, b], [l, 0.0]));
        let inside = p[0] > 0.0 && p[0] < l && p[1] * l < a * (l - p[0]) + b * p[0];
        if inside { -distance } else { distance }
    }
    fn bounds(&self) -> Bounds<D> {
        let [a, b] = self.radii;
        self.axis.bounds(|cos, sin| (a * sin).max(self.length * cos + b * sin))
    }
    fn exact_distance(&self) -> bool {
        true
    }
    fn measure(&self) -> Option<f64> {
        match D {
            2 => Some((self.radii[0] + self.radii[1]) * self.length),
            3 => Some(self.volume()),
            _ => None,
        }
    }
    fn centroid(&self) -> Option<[f64; D]> {
        let [a, b] = self.radii;
        let fraction = match D {
            2 => (a + 2.0 * b) / (3.0 * (a + b)),
            3 => (a * a + 2.0 * a * b + 3.0 * b * b) / (4.0 * (a * a + a * b + b * b)),
            _ => return None,
        };
        Some(self.axis.at(fraction * self.length))
    }
    fn revolved_measure(&self) -> Option<f64> {
        self.axis.revolved(self.volume(), self)
    }
    fn convex(&self) -> bool {
        true
    }
}

/// Rod with a tangent ogive nose, about any axis; in 2D its axial section, which about the axis r = 0 of
/// axisymmetric coordinates represents the rod. Exact distance.
///
/// The nose is an arc of radius `crh * diameter` (calibre-radius-head), tangent to the shank;
/// its length is `diameter / 2 * sqrt(4 crh - 1)`. A `crh` of one half gives a hemispherical nose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OgiveRod<const D: usize> {
    pub(super) axis: Axis<D>,
    /// Radius of the shank.
    pub(super) radius: f64,
    /// Length of the shank.
    pub(super) shank: f64,
    /// Length of the nose.
    pub(super) nose: f64,
    /// Radius of the arc.
    pub(super) arc: f64,
}

impl<const D: usize> OgiveRod<D> {
    /// Create it from the centre of the flat tail (m), the direction of flight (any length), diameter, length from tail
    /// to tip (m), and calibre-radius-head.
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the diameter is positive, `crh` at least one half, the length at least that
    /// of the nose, `direction` is not zero and all values are finite.
    pub fn new(
        tail: [f64; D],
        direction: [f64; D],
        diameter: f64,
        length: f64,
        crh: f64,
    ) -> Result<Self, GeometryError> {
        let check = Check("ogive rod");
        check.positive("diameter", diameter)?;
        check.that(crh >= 0.5, "crh", crh, "at least 1/2, and finite")?;
        let radius = 0.5 * diameter;
        let nose = radius * (4.0 * crh - 1.0).sqrt();
        // The length of a rod without shank may differ from that of its nose by rounding.
        check.that(
            length >= nose * (1.0 - 1e-12),
            "length",
            length,
            "at least the length of the nose, diameter / 2 * sqrt(4 crh - 1), and finite",
        )?;
        Ok(Self {
            axis: Axis {
                start: check.point("tail", tail)?,
                direction: check.direction("direction", direction)?,
            },
            radius,
            shank: (length - nose).max(0.0),
            nose,
            arc: crh * diameter,
        })
    }
    /// Length of the nose (m).
    pub fn nose_length(&self) -> f64 {
        self.nose
    }
    /// Position of the tip (m).
    pub fn tip(&self) -> [f64; D] {
        self.axis.at(self.shank + self.nose)
    }
    /// Distance of the centre of the arc beyond the axis.
    pub(super) fn beyond(&self) -> f64 {
        self.arc - self.radius
    }
    /// Integral of the height of the arc over the nose, both relative to the centre of the arc.
    fn arc_area(&self) -> f64 {
        let (l, c) = (self.nose, self.beyond());
        0.5 * (l * c + self.arc * self.arc * (l / self.arc).min(1.0).asin())
    }
    fn volume(&self) -> f64 {
        let (l, c) = (self.nose, self.beyond());
        let nose = (self.arc * self.arc + c * c) * l - l * l * l / 3.0 - 2.0 * c * self.arc_area();
        PI * (self.radius * self.radius * self.shank + nose)
    }
}

impl<const D: usize> Shape<D> for OgiveRod<D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        let p @ [z, r] = self.axis.meridian(x);
        let shoulder = [self.shank, self.radius];
        let tip = [self.shank + self.nose, 0.0];
        // Relative to the centre of the arc.
        let (dz, dr) = (z - self.shank, r + self.beyond());
        let from_centre = dz.hypot(dr);
        let in_sector = dz >= 0.0 && dz * self.beyond() <= dr * self.nose;
        let to_arc = if in_sector {
            (from_centre - self.arc).abs()
        } else {
            norm(sub(p, shoulder)).min(norm(sub(p, tip)))
        };
        let mut distance = to_arc.min(segment_distance(p, [0.0, 0.0], [0.0, self.radius]));
        if self.shank > 0.0 {
            distance = distance.min(segment_distance(p, [0.0, self.radius], shoulder));
        }
        let inside = z > 0.0 && if dz <= 0.0 { r < self.radius } else { from_centre < self.arc };
        if inside { -distance } else { distance }
    }
    fn bounds(&self) -> Bounds<D> {
        let c = self.beyond();
        self.axis.bounds(|cos, sin| {
            let tail = self.radius * sin;
            let tip = (self.shank + self.nose) * cos;
            // The direction (cos, sin) is normal to the arc between shoulder and tip.
            let nose = if cos >= 0.0 && cos * c <= sin * self.nose {
                self.shank * cos + self.arc - c * sin
            } else {
                self.shank * cos + self.radius * sin
            };
            tail.max(tip).max(nose)
        })
    }
    fn exact_distance(&self) -> bool {
        true
    }
    fn measure(&self) -> Option<f64> {
        match D {
            2 => Some(2.0 * (self.radius * self.shank + self.arc_area() - self.beyond() * self.nose)),
            3 => Some(self.volume()),
            _ => None,
        }
    }
    fn centroid(&self) -> Option<[f64; D]> {
        let (l, c, arc) = (self.nose, self.beyond(), self.arc);
        // First moments of the nose about its shoulder, and of the whole rod about the tail.
        let (half_size, moment) = match D {
            2 => {
                let size = self.arc_area() - c * l;
                let first = (arc.powi(3) - c.powi(3)) / 3.0 - 0.5 * c * l * l;
                (size, (self.shank, self.radius, first))
            }
            3 => {
                let size = (arc * arc + c * c) * l - l.powi(3) / 3.0 - 2.0 * c * self.arc_area();
                let first = 0.5 * (arc * arc + c * c) * l * l
                    - 0.25 * l.powi(4)
                    - 2.0 / 3.0 * c * (arc.powi(3) - c.powi(3));
                (size, (self.shank, self.radius * self.radius, first))
            }
            _ => return None,
        };
        let (shank, section, first) = moment;
        let total = half_size + section * shank;
        let z = (first + half_size * shank + 0.5 * section * shank * shank) / total;
        Some(self.axis.at(z))
    }
    fn revolved_measure(&self) -> Option<f64> {
        self.axis.revolved(self.volume(), self)
    }
    fn convex(&self) -> bool {
        true
    }
}

/// Shape defined by a function, for shapes without a type of their own.
#[derive(Clone, Copy, Debug)]
pub struct Implicit<F, const D: usize> {
    distance: F,
    bounds: Bounds<D>,
}

impl<F: Fn([f64; D]) -> f64 + Send + Sync, const D: usize> Implicit<F, D> {
    /// Create the shape of the points where `distance` is negative, all of them within `bounds`. The function must satisfy the contract of
    /// [`Shape::signed_distance`].
    pub fn new(bounds: Bounds<D>, distance: F) -> Self {
        Self { distance, bounds }
    }
}

impl<F: Fn([f64; D]) -> f64 + Send + Sync, const D: usize> Shape<D> for Implicit<F, D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        (self.distance)(x)
    }
    fn bounds(&self) -> Bounds<D> {
        self.bounds
    }
}
