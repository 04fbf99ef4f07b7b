//! Public view of bodies for the run loop and observers, for any method.

use crate::exchange::Exchange;

/// Sums over the points of a body or a scene. Per radian in axisymmetric scenes, per metre of depth in plane strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Number of points with mass.
    pub particles: usize,
    /// Mass, kg.
    pub mass: f64,
    /// Momentum, kg m/s: the balanced one, see [`Totals::staggered`].
    pub momentum: [f64; 3],
    /// Angular momentum about the origin, kg m^2/s.
    pub angular_momentum: [f64; 3],
    /// Sum of m |v|, kg m/s: the scale for errors of the momentum.
    pub momentum_scale: f64,
    /// Kinetic energy, J: the balanced one, see [`Totals::staggered`].
    pub kinetic: f64,
    /// Internal energy, plastic work and heat included, J.
    pub internal: f64,
    /// Heat of viscosity since the start, J, part of the internal energy; 0 if the law does not track it.
    pub viscous_heat: f64,
    /// Corrections of schemes whose velocities are half a step behind the positions (leap-frog).
    pub staggered: Staggered,
}

/// Corrections of a leap-frog scheme: quantities at the time of the positions minus the balanced ones. Velocities v- belong to the middle
/// of the last step; those at the time of the positions are v = v- + lag a, with the acceleration a at that time. The balanced quantities
/// are the momentum m v-, to which impulses are booked, and the energy m v- . v+ / 2, which central differences conserve together with the
/// internal energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Staggered {
    /// Sum of m (v - v-), kg m/s.
    pub momentum: [f64; 3],
    /// Sum of m v . v / 2 minus the balanced kinetic energy, J.
    pub energy: f64,
}

impl Totals {
    /// Return the sum with the totals of another body.
    #[must_use]
    pub fn plus(mut self, o: &Totals) -> Totals {
        self.particles += o.particles;
        self.mass += o.mass;
        for d in 0..3 {
            self.momentum[d] += o.momentum[d];
            self.angular_momentum[d] += o.angular_momentum[d];
        }
        self.momentum_scale += o.momentum_scale;
        self.kinetic += o.kinetic;
        self.internal += o.internal;
        self.viscous_heat += o.viscous_heat;
        self.staggered.energy += o.staggered.energy;
        (0..3).for_each(|d| self.staggered.momentum[d] += o.staggered.momentum[d]);
        self
    }

    /// Add a point of this mass (kg), position (m) and velocity (m/s). Add its internal energy separately.
    pub fn add_point(&mut self, mass: f64, position: &[f64], velocity: &[f64]) {
        let (mut x, mut v) = ([0.0; 3], [0.0; 3]);
        x[..position.len()].copy_from_slice(position);
        v[..velocity.len()].copy_from_slice(velocity);
        let square: f64 = v.iter().map(|c| c * c).sum();
        self.particles += 1;
        self.mass += mass;
        self.kinetic += 0.5 * mass * square;
        self.momentum_scale += mass * square.sqrt();
        for d in 0..3 {
            let (i, j) = ((d + 1) % 3, (d + 2) % 3);
            self.momentum[d] += mass * v[d];
            self.angular_momentum[d] += mass * (x[i] * v[j] - x[j] * v[i]);
        }
    }

    /// Momentum at the time of the positions, kg m/s.
    #[must_use]
    pub fn momentum_now(&self) -> [f64; 3] {
        std::array::from_fn(|d| self.momentum[d] + self.staggered.momentum[d])
    }

    /// Kinetic energy at the time of the positions, J.
    #[must_use]
    pub fn kinetic_now(&self) -> f64 {
        self.kinetic + self.staggered.energy
    }

    /// Add a point of a leap-frog scheme with this mass (kg), position (m), velocity v- of the last step and velocity at its end (m/s). The
    /// balanced kinetic energy is m v- . v- / 2 plus `lagged_work` (J), the work lag v- . f of the internal forces f until then.
    pub fn add_staggered(
        &mut self,
        mass: f64,
        position: &[f64],
        [behind, now]: [&[f64]; 2],
        lagged_work: f64,
    ) {
        self.add_point(mass, position, behind);
        self.kinetic += lagged_work;
        let mut change = -lagged_work;
        for (d, (b, n)) in behind.iter().zip(now).enumerate() {
            self.staggered.momentum[d] += mass * (n - b);
            change += 0.5 * mass * (n - b) * (n + b);
        }
        self.staggered.energy += change;
    }

    /// True if energies and momentum are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        (self.kinetic + self.internal + self.momentum_scale).is_finite()
    }
}

/// Public view of a point of a body (a particle, an element, or a free node of eroded elements), in SI units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointView {
    /// Number in the body, constant over a run.
    pub number: usize,
    /// Position, m.
    pub position: [f64; 3],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Mass, kg.
    pub mass: f64,
    /// Volume, m^3 (per radian or metre of depth in two dimensions).
    pub volume: f64,
    /// Drawn width, m, if it does not follow from the volume.
    pub width: Option<f64>,
    /// Corners of an element, m, in the order of the VTK file format; empty for a particle.
    pub corners: Vec<[f64; 3]>,
    /// Half edges of the particle domain, m, if the method has domains: of the initial box along the axes, stretched (cpGIMP) or sheared
    /// and rotated (CPDI, and all methods in the reference configuration).
    pub half_edges: [[f64; 3]; 3],
    /// Cauchy stress xx, yy, zz, yz, xz, xy, Pa.
    pub stress: [f64; 6],
    /// True if the state is within the data of the law. False for a point so dense that its equation of state is extrapolated.
    pub in_range: bool,
    /// True if the point has failed ([`mpm_materials::Constitutive::failed`]).
    pub failed: bool,
    /// State variables of the law, in the order of [`Body::state_names`].
    pub state: Vec<f64>,
}

impl PointView {
    /// Pressure, compression positive: -tr(sigma) / 3, Pa.
    #[must_use]
    pub fn pressure(&self) -> f64 {
        -(self.stress[0] + self.stress[1] + self.stress[2]) / 3.0
    }

    /// Von Mises equivalent stress, Pa.
    #[must_use]
    pub fn von_mises(&self) -> f64 {
        let (s, mean) = (&self.stress, -self.pressure());
        let d = [s[0] - mean, s[1] - mean, s[2] - mean];
        let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        let shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
        (1.5 * (square + 2.0 * shear)).sqrt()
    }

    /// Return the drawn width, m: [`PointView::width`], or the edge of a cube of the point's volume (of a square in two dimensions, at its
    /// radius in axisymmetric scenes).
    #[must_use]
    pub fn drawn_width(&self, dimensions: usize, axisymmetric: bool) -> f64 {
        let size = match (self.width, dimensions, axisymmetric) {
            (Some(width), ..) => width,
            (None, 3, _) => self.volume.cbrt(),
            (None, _, true) => (self.volume / self.position[0]).sqrt(),
            (None, _, false) => self.volume.sqrt(),
        };
        if size.is_finite() && size > 0.0 { size } else { f64::MIN_POSITIVE }
    }

    /// True if [`PointView::drawn_width`] exceeds `than`, m; computed without a root. False for a point without a width.
    #[must_use]
    pub fn is_wider(&self, than: f64, dimensions: usize, axisymmetric: bool) -> bool {
        if than <= 0.0 {
            return true;
        }
        match (self.width, dimensions, axisymmetric) {
            (Some(width), ..) => width > than,
            (None, 3, _) => self.volume > than * than * than,
            (None, _, true) => self.volume / self.position[0] > than * than,
            (None, _, false) => self.volume > than * than,
        }
    }
}

/// Optional parts of a [`PointView`] that are costly to compute. Number, position, velocity and corners are always set; parts that are not
/// requested may have the values of another point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parts {
    /// Compute [`PointView::mass`].
    pub mass: bool,
    /// Compute [`PointView::volume`], [`PointView::width`] and [`PointView::half_edges`].
    pub size: bool,
    /// Compute the results of the law: stress, range, failure and state.
    pub law: bool,
}

impl Parts {
    /// All parts.
    pub const ALL: Parts = Parts { mass: true, size: true, law: true };
    /// No part.
    pub const NONE: Parts = Parts { mass: false, size: false, law: false };
    /// Mass only.
    pub const MASS: Parts = Parts { mass: true, ..Parts::NONE };
    /// Size only.
    pub const SIZE: Parts = Parts { size: true, ..Parts::NONE };
}

/// Axis-aligned bounding box, extended point by point, for [`Body::bounds`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
}

impl Default for Bounds {
    fn default() -> Self {
        Bounds { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] }
    }
}

impl Bounds {
    /// Extend the box by a position, m, and its surroundings within `reach`, m.
    pub fn hold_place(&mut self, place: &[f64; 3], reach: f64) {
        for d in 0..3 {
            self.low[d] = self.low[d].min(place[d] - reach);
            self.high[d] = self.high[d].max(place[d] + reach);
        }
    }
    /// Extend the box by a particle of its drawn width, or by the corners of an element.
    pub fn hold(&mut self, p: &PointView, dimensions: usize, axisymmetric: bool) {
        if !p.corners.is_empty() {
            p.corners.iter().for_each(|corner| self.hold_place(corner, 0.0));
            return;
        }
        // Roots are computed only for points that may extend the box.
        let inside = |d: usize| (p.position[d] - self.low[d]).min(self.high[d] - p.position[d]);
        let room = (0..dimensions.min(3)).map(inside).fold(f64::INFINITY, f64::min);
        // Reduced by the rounding of widths.
        if room <= 0.0 || p.is_wider(2.0 * room * (1.0 - 1e-12), dimensions, axisymmetric) {
            self.hold_place(&p.position, 0.5 * p.drawn_width(dimensions, axisymmetric));
        }
    }
    /// Extend the box by another one.
    pub fn join(&mut self, other: &Bounds) {
        for d in 0..3 {
            self.low[d] = self.low[d].min(other.low[d]);
            self.high[d] = self.high[d].max(other.high[d]);
        }
    }
    /// Return the lowest and highest corner, m; none for an empty box.
    #[must_use]
    pub fn corners(&self) -> Option<[[f64; 3]; 2]> {
        (self.low[0] <= self.high[0]).then_some([self.low, self.high])
    }
}

/// Public view of a body of any method for the run loop and observers.
pub trait Body {
    /// Name, unique in the scene.
    fn name(&self) -> &str;
    /// Name of the material law; empty without one.
    fn law(&self) -> &'static str;
    /// True if the law has zero stress across the plane (plane stress).
    fn is_plane_stress(&self) -> bool {
        false
    }
    /// Number of points; 0 for a wall.
    fn len(&self) -> usize;
    /// True if the body has no points.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Names of the state variables in [`PointView::state`].
    fn state_names(&self) -> Vec<String>;
    /// Return the plastic strain from which the law softens in shear at this rate, 1/s ([`mpm_materials::softening::softens_from`]); none if it
    /// does not, and for bodies without a law.
    fn softens_from(&self, rate: f64) -> Option<f64> {
        let _ = rate;
        None
    }
    /// Speed of sound at rest, m/s, of a weakly compressible liquid, a number that is chosen for its speeds
    /// ([`mpm_materials::chosen_sound_speed`]); none for other bodies.
    fn chosen_sound_speed(&self) -> Option<f64> {
        None
    }
    /// Sums over the points of the body.
    fn totals(&self) -> Totals;
    /// Return the exchange with other bodies since the start, if the body stores it, such as elements in contact with particles. A contact
    /// force is the time derivative of its impulse.
    fn given_by_others(&self) -> Option<Exchange> {
        None
    }
    /// Call `visit` for every point, in an order that depends on the scene only.
    fn for_each(&self, visit: &mut dyn FnMut(&PointView));
    /// Call `visit` for every point, as [`Body::for_each`], with at least these parts computed.
    fn for_each_with(&self, parts: Parts, visit: &mut dyn FnMut(&PointView)) {
        let _ = parts;
        self.for_each(visit);
    }
    /// Return the lowest and highest corner of the axis-aligned bounding box, m: of particles with their drawn width, of elements up to
    /// their nodes. None without points.
    fn bounds(&self, dimensions: usize, axisymmetric: bool) -> Option<[[f64; 3]; 2]> {
        let mut held = Bounds::default();
        self.for_each_with(Parts::SIZE, &mut |p| held.hold(p, dimensions, axisymmetric));
        held.corners()
    }
    /// Return all points, sorted by number.
    fn points(&self) -> Vec<PointView> {
        let mut all = Vec::with_capacity(self.len());
        self.for_each(&mut |p| all.push(p.clone()));
        all.sort_by_key(|p| p.number);
        all
    }
    /// Return the area of the present surface, m^2 (per metre of depth, or per radian), faces on planes of symmetry included. None for
    /// bodies without faces, as particles, or without elements that have a surface, as bars.
    fn surface_area(&self) -> Option<f64> {
        None
    }
    /// Memory in bytes, scratch included.
    fn bytes(&self) -> usize;
}
