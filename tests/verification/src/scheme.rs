//! Schemes: which method, named at run time.

use mpm_core::{
    AffineShape, Apic, CpGimp, Cpdi, Cpdi2, CubicBSpline, Embedding, FixedDomain, Flip, Fmpm, Gimp,
    IntoKernels, Kernels, Linear, Method, Musl, QuadraticBSpline, Scalar, ShapeFunction, Usl,
};

/// Shape functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kernel {
    /// Linear shape function.
    Linear,
    /// GIMP of fixed boxes.
    Gimp,
    /// GIMP of boxes that follow the stretch.
    CpGimp,
    /// CPDI: parallelograms that follow the deformation.
    Cpdi,
    /// CPDI-2: quadrilaterals whose corners follow the nodes.
    Cpdi2,
    /// Quadratic B-spline.
    Quadratic,
    /// Cubic B-spline.
    Cubic,
}

/// Transfer and stress update.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Velocity {
    /// FLIP, stress last.
    FlipUsl,
    /// FLIP, stress last from momentum mapped again.
    FlipMusl,
    /// APIC, stress last.
    ApicUsl,
    /// FMPM(4), stress last.
    Fmpm4Usl,
}

/// A method by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Scheme {
    /// Shape function.
    pub kernel: Kernel,
    /// Transfer and stress update.
    pub velocity: Velocity,
    /// In the reference configuration?
    pub total: bool,
}

impl Kernel {
    /// All.
    pub const ALL: [Kernel; 7] = [
        Kernel::Linear,
        Kernel::Gimp,
        Kernel::CpGimp,
        Kernel::Cpdi,
        Kernel::Cpdi2,
        Kernel::Quadratic,
        Kernel::Cubic,
    ];
    /// Nodes that a particle weighs on, in `d` dimensions.
    pub fn nodes(self, d: u32) -> u64 {
        match self {
            Kernel::Linear => 2u64.pow(d),
            Kernel::Gimp | Kernel::CpGimp | Kernel::Quadratic => 3u64.pow(d),
            Kernel::Cpdi | Kernel::Cpdi2 | Kernel::Cubic => 4u64.pow(d),
        }
    }
    /// Its short name.
    pub fn name(self) -> &'static str {
        match self {
            Kernel::Linear => "linear",
            Kernel::Gimp => "uGIMP",
            Kernel::CpGimp => "cpGIMP",
            Kernel::Cpdi => "CPDI",
            Kernel::Cpdi2 => "CPDI-2",
            Kernel::Quadratic => "quadratic",
            Kernel::Cubic => "cubic",
        }
    }
}

impl Velocity {
    /// All.
    pub const ALL: [Velocity; 4] =
        [Velocity::FlipUsl, Velocity::FlipMusl, Velocity::ApicUsl, Velocity::Fmpm4Usl];
    /// Its short name.
    pub fn name(self) -> &'static str {
        match self {
            Velocity::FlipUsl => "FLIP-USL",
            Velocity::FlipMusl => "FLIP-MUSL",
            Velocity::ApicUsl => "APIC",
            Velocity::Fmpm4Usl => "FMPM(4)",
        }
    }
}

impl Scheme {
    /// Updated Lagrangian.
    pub const fn moving(kernel: Kernel, velocity: Velocity) -> Self {
        Scheme { kernel, velocity, total: false }
    }
    /// Total Lagrangian.
    pub const fn total(kernel: Kernel, velocity: Velocity) -> Self {
        Scheme { kernel, velocity, total: true }
    }
    /// All that the compiler accepts.
    pub fn all() -> Vec<Scheme> {
        let mut list = Vec::new();
        for total in [false, true] {
            for kernel in Kernel::ALL {
                for velocity in Velocity::ALL {
                    let scheme = Scheme { kernel, velocity, total };
                    if scheme.is_legal() {
                        list.push(scheme);
                    }
                }
            }
        }
        list
    }
    /// Is it compiled here? There is none of the linear shape function and of CPDI with APIC, and CPDI is compiled with FLIP and USL alone; in
    /// the reference configuration cpGIMP is uGIMP, and that lies between the linear shape function and the quadratic spline.
    pub fn is_legal(self) -> bool {
        match self.kernel {
            Kernel::Linear => self.velocity != Velocity::ApicUsl,
            Kernel::Gimp | Kernel::CpGimp => !self.total,
            Kernel::Cpdi | Kernel::Cpdi2 => !self.total && self.velocity == Velocity::FlipUsl,
            Kernel::Quadratic | Kernel::Cubic => true,
        }
    }
    /// Its name, as in `TL quadratic APIC`.
    pub fn name(self) -> String {
        let frame = if self.total { "TL " } else { "" };
        format!("{frame}{} {}", self.kernel.name(), self.velocity.name())
    }
    /// The scheme of a name.
    pub fn named(name: &str) -> Option<Scheme> {
        Scheme::all().into_iter().find(|s| s.name() == name)
    }
}

/// The kernels of a scheme; `None` if there is no such one.
pub fn kernels<E: Embedding<D> + Default, const D: usize>(scheme: Scheme) -> Option<Kernels<f64, D>>
where
    f64: Scalar<D>,
    Linear: ShapeFunction<f64, D>,
    Gimp: ShapeFunction<f64, D>,
    CpGimp: ShapeFunction<f64, D>,
    Cpdi: ShapeFunction<f64, D>,
    Cpdi2: ShapeFunction<f64, D>,
    QuadraticBSpline: ShapeFunction<f64, D>,
    CubicBSpline: ShapeFunction<f64, D>,
{
    match (scheme.kernel, scheme.total) {
        (Kernel::Linear, _) => any::<E, Linear, D>(Linear, scheme),
        (Kernel::CpGimp, false) => moving::<E, CpGimp, D>(CpGimp, scheme),
        (Kernel::Cpdi, false) => plain::<E, Cpdi, D>(Cpdi, scheme),
        (Kernel::Cpdi2, false) => plain::<E, Cpdi2, D>(Cpdi2, scheme),
        (Kernel::Gimp | Kernel::CpGimp | Kernel::Cpdi | Kernel::Cpdi2, true) => None,
        (Kernel::Gimp, false) => moving::<E, Gimp, D>(Gimp, scheme),
        (Kernel::Quadratic, _) => affine::<E, QuadraticBSpline, D>(QuadraticBSpline, scheme),
        (Kernel::Cubic, _) => affine::<E, CubicBSpline, D>(CubicBSpline, scheme),
    }
}

/// Any shape function but one that carries its domain, transfers without an affine matrix.
fn any<E: Embedding<D> + Default, S: ShapeFunction<f64, D> + FixedDomain, const D: usize>(
    shape: S,
    scheme: Scheme,
) -> Option<Kernels<f64, D>>
where
    f64: Scalar<D>,
{
    let space = E::default();
    Some(match (scheme.velocity, scheme.total) {
        (Velocity::FlipUsl, false) => Method::new(shape, Flip, Usl, space).compiled().into_kernels(),
        (Velocity::FlipMusl, false) => Method::new(shape, Flip, Musl, space).compiled().into_kernels(),
        (Velocity::Fmpm4Usl, false) => Method::new(shape, Fmpm::<4>, Usl, space).compiled().into_kernels(),
        (Velocity::FlipUsl, true) => {
            Method::new(shape, Flip, Usl, space).total_lagrangian().compiled().into_kernels()
        }
        (Velocity::FlipMusl, true) => {
            Method::new(shape, Flip, Musl, space).total_lagrangian().compiled().into_kernels()
        }
        (Velocity::Fmpm4Usl, true) => {
            Method::new(shape, Fmpm::<4>, Usl, space).total_lagrangian().compiled().into_kernels()
        }
        (Velocity::ApicUsl, _) => return None,
    })
}

fn affine<E: Embedding<D> + Default, S: ShapeFunction<f64, D> + AffineShape + FixedDomain, const D: usize>(
    shape: S,
    scheme: Scheme,
) -> Option<Kernels<f64, D>>
where
    f64: Scalar<D>,
{
    if scheme.velocity != Velocity::ApicUsl {
        return any::<E, S, D>(shape, scheme);
    }
    let method = Method::new(shape, Apic, Usl, E::default());
    Some(if scheme.total {
        method.total_lagrangian().compiled().into_kernels()
    } else {
        method.compiled().into_kernels()
    })
}

/// FLIP and USL alone.
fn plain<E: Embedding<D> + Default, S: ShapeFunction<f64, D>, const D: usize>(
    shape: S,
    scheme: Scheme,
) -> Option<Kernels<f64, D>>
where
    f64: Scalar<D>,
{
    let flip = scheme.velocity == Velocity::FlipUsl;
    flip.then(|| Method::new(shape, Flip, Usl, E::default()).compiled().into_kernels())
}

fn moving<E: Embedding<D> + Default, S: ShapeFunction<f64, D> + AffineShape, const D: usize>(
    shape: S,
    scheme: Scheme,
) -> Option<Kernels<f64, D>>
where
    f64: Scalar<D>,
{
    let space = E::default();
    Some(match scheme.velocity {
        Velocity::FlipUsl => Method::new(shape, Flip, Usl, space).compiled().into_kernels(),
        Velocity::FlipMusl => Method::new(shape, Flip, Musl, space).compiled().into_kernels(),
        Velocity::Fmpm4Usl => Method::new(shape, Fmpm::<4>, Usl, space).compiled().into_kernels(),
        Velocity::ApicUsl => Method::new(shape, Apic, Usl, space).compiled().into_kernels(),
    })
}
