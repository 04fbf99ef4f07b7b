//! Bodies as the run loop and observers see them, whatever their method.

use crate::exchange::Exchange;

/// Sums over the points of a body or a scene. Per radian in axisymmetric scenes, per metre of depth in plane strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Points that carry mass.
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
    /// Heat of viscosity since the start, J, which is part of the internal energy: where a law knows it.
    pub viscous_heat: f64,
    /// Of schemes whose velocities are half a step behind positions (leap-frog).
    pub staggered: Staggered,
}

/// Quantities of a leap-frog scheme at the time of the positions less the balanced ones. Velocities v- belong to the middle of the last step;
/// those of the time of the positions are v = v- + lag a, with the acceleration a there. Balanced are the momentum m v-, to which impulses were
/// booked, and the energy m v- . v+ / 2, which central differences conserve together with the internal energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Staggered {
    /// Sum of m (v - v-), kg m/s.
    pub momentum: [f64; 3],
    /// Sum of m v . v / 2 less the balanced kinetic energy, J.
    pub energy: f64,
}

impl Totals {
    /// Sum with another body's.
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

    /// Add a point of this mass (kg), position (m) and velocity (m/s); its internal energy is added apart.
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

    /// Add a point of a leap-frog scheme of this mass (kg) at a position (m) that moved with the velocity v- (m/s) in the last step and has
    /// another one (m/s) at its end. The balanced kinetic energy is m v- . v- / 2 with the work (J) that its inner forces f do until then,
    /// lag v- . f.
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

    /// Are energies and momentum finite numbers?
    #[must_use]
    pub fn is_finite(&self) -> bool {
        (self.kinetic + self.internal + self.momentum_scale).is_finite()
    }
}

/// A point of a body (a particle, or a node of elements) as others see it, in SI units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointView {
    /// Its number in the body, which stays the same over a run.
    pub number: usize,
    /// Position, m.
    pub position: [f64; 3],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Mass, kg.
    pub mass: f64,
    /// Volume, m^3 (per radian or metre of depth in two dimensions).
    pub volume: f64,
    /// How wide it is drawn, m, where its volume does not say it.
    pub width: Option<f64>,
    /// Corners of its cell, m, in the order of the VTK file format, where it is an element; none of a particle.
    pub corners: Vec<[f64; 3]>,
    /// Half edges of its domain, m, where it has one: of the box along the axes that it started with, stretched (cpGIMP), sheared
    /// and turned (CPDI, and all in the reference configuration) as its method has it.
    pub half_edges: [[f64; 3]; 3],
    /// Cauchy stress xx, yy, zz, yz, xz, xy, Pa.
    pub stress: [f64; 6],
    /// Is it within the range of the data of its law? False of one so dense that its equation of state is continued.
    pub in_range: bool,
    /// Has it failed ([`mpm_materials::Constitutive::failed`])?
    pub failed: bool,
    /// The law's state, by [`Body::state_names`].
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

    /// How wide it is drawn, m: the edge of a cube (square in two dimensions, at its radius where those are (r, z)) of its volume,
    /// or its own [`PointView::width`].
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

    /// Is it drawn wider than that, m? As [`PointView::drawn_width`] says, without a root; what has no width is not.
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

/// Parts of a [`PointView`] that cost something to find out. Number, position, velocity and corners are always there; parts that are not asked
/// for may be those of another point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parts {
    /// [`PointView::mass`].
    pub mass: bool,
    /// [`PointView::volume`], [`PointView::width`] and [`PointView::half_edges`].
    pub size: bool,
    /// What the law says: stress, range, failure and state.
    pub law: bool,
}

impl Parts {
    /// All of them.
    pub const ALL: Parts = Parts { mass: true, size: true, law: true };
    /// None of them.
    pub const NONE: Parts = Parts { mass: false, size: false, law: false };
    /// The mass.
    pub const MASS: Parts = Parts { mass: true, ..Parts::NONE };
    /// The size.
    pub const SIZE: Parts = Parts { size: true, ..Parts::NONE };
}

/// Axis-aligned bounding box that grows with the points that it holds, for [`Body::bounds`].
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
    /// Hold a place, m, and what is so far from it.
    pub fn hold_place(&mut self, place: &[f64; 3], reach: f64) {
        for d in 0..3 {
            self.low[d] = self.low[d].min(place[d] - reach);
            self.high[d] = self.high[d].max(place[d] + reach);
        }
    }
    /// Hold a particle as wide as it is drawn, or the corners of an element.
    pub fn hold(&mut self, p: &PointView, dimensions: usize, axisymmetric: bool) {
        if !p.corners.is_empty() {
            p.corners.iter().for_each(|corner| self.hold_place(corner, 0.0));
            return;
        }
        // Roots only of what may reach out.
        let inside = |d: usize| (p.position[d] - self.low[d]).min(self.high[d] - p.position[d]);
        let room = (0..dimensions.min(3)).map(inside).fold(f64::INFINITY, f64::min);
        // A little less, as widths are rounded.
        if room <= 0.0 || p.is_wider(2.0 * room * (1.0 - 1e-12), dimensions, axisymmetric) {
            self.hold_place(&p.position, 0.5 * p.drawn_width(dimensions, axisymmetric));
        }
    }
    /// Its lowest and highest corner, m; none of an empty one.
    #[must_use]
    pub fn corners(&self) -> Option<[[f64; 3]; 2]> {
        (self.low[0] <= self.high[0]).then_some([self.low, self.high])
    }
}

/// A body of any method, as the run loop and observers see it.
pub trait Body {
    /// Its name, which no other body of the scene has.
    fn name(&self) -> &str;
    /// Its law's name; empty without one.
    fn law(&self) -> &'static str;
    /// Is the stress across the plane zero by its law?
    fn is_plane_stress(&self) -> bool {
        false
    }
    /// How many points it has; none of a wall.
    fn len(&self) -> usize;
    /// Has it no points?
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Names of the numbers in [`PointView::state`].
    fn state_names(&self) -> Vec<String>;
    /// Sums over its points.
    fn totals(&self) -> Totals;
    /// What other bodies gave to it since the start, where it keeps that: elements, which particles push, do; a force is the change of that
    /// impulse over time.
    fn given_by_others(&self) -> Option<Exchange> {
        None
    }
    /// Call `visit` for every point, in an order that depends on nothing but the scene.
    fn for_each(&self, visit: &mut dyn FnMut(&PointView));
    /// [`Body::for_each`] of which `visit` reads these parts alone: the others need not be found out.
    fn for_each_with(&self, parts: Parts, visit: &mut dyn FnMut(&PointView)) {
        let _ = parts;
        self.for_each(visit);
    }
    /// Lowest and highest corner, m, of the axis-aligned bounding box of its matter: particles as wide as they are drawn, elements up to their nodes. None
    /// without a point.
    fn bounds(&self, dimensions: usize, axisymmetric: bool) -> Option<[[f64; 3]; 2]> {
        let mut held = Bounds::default();
        self.for_each_with(Parts::SIZE, &mut |p| held.hold(p, dimensions, axisymmetric));
        held.corners()
    }
    /// All points, by number.
    fn points(&self) -> Vec<PointView> {
        let mut all = Vec::with_capacity(self.len());
        self.for_each(&mut |p| all.push(p.clone()));
        all.sort_by_key(|p| p.number);
        all
    }
    /// Bytes of memory held, scratch included.
    fn bytes(&self) -> usize;
}
