//! Schemes: methods named at run time.

use mpm_core::{
    AffineShape, Apic, CpGimp, Cpdi, Cpdi2, CubicBSpline, Embedding, FixedDomain, Flip, Fmpm, Gimp,
    IntoKernels, Kernels, Linear, Method, Musl, QuadraticBSpline, Scalar, ShapeFunction, Usl,
};

/// Shape function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kernel {
    /// Linear shape function.
    Linear,
    /// GIMP with fixed particle domains (uGIMP).
    Gimp,
    /// GIMP with particle domains that follow the stretch (cpGIMP).
    CpGimp,
    /// CPDI: parallelogram domains that follow the deformation.
    Cpdi,
    /// CPDI-2: quadrilateral domains whose corners follow the nodes.
    Cpdi2,
    /// Quadratic B-spline.
    Quadratic,
    /// Cubic B-spline.
    Cubic,
}

/// Transfer and stress update.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Velocity {
    /// FLIP, update stress last.
    FlipUsl,
    /// FLIP, update stress last from momentum mapped again.
    FlipMusl,
    /// APIC, update stress last.
    ApicUsl,
    /// FMPM(4), update stress last.
    Fmpm4Usl,
}

/// Material point method by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Scheme {
    /// Shape function.
    pub kernel: Kernel,
    /// Transfer and stress update.
    pub velocity: Velocity,
    /// Total Lagrangian: in the reference configuration.
    pub total: bool,
}

impl Kernel {
    /// All shape functions.
    pub const ALL: [Kernel; 7] = [
        Kernel::Linear,
        Kernel::Gimp,
        Kernel::CpGimp,
        Kernel::Cpdi,
        Kernel::Cpdi2,
        Kernel::Quadratic,
        Kernel::Cubic,
    ];
    /// Number of nodes of a particle in `d` dimensions.
    pub fn nodes(self, d: u32) -> u64 {
        match self {
            Kernel::Linear => 2u64.pow(d),
            Kernel::Gimp | Kernel::CpGimp | Kernel::Quadratic => 3u64.pow(d),
            Kernel::Cpdi | Kernel::Cpdi2 | Kernel::Cubic => 4u64.pow(d),
        }
    }
    /// Short name.
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
    /// All velocity updates.
    pub const ALL: [Velocity; 4] =
        [Velocity::FlipUsl, Velocity::FlipMusl, Velocity::ApicUsl, Velocity::Fmpm4Usl];
    /// Short name.
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
    /// Create an updated Lagrangian scheme.
    pub const fn moving(kernel: Kernel, velocity: Velocity) -> Self {
        Scheme { kernel, velocity, total: false }
    }
    /// Create a total Lagrangian scheme.
    pub const fn total(kernel: Kernel, velocity: Velocity) -> Self {
        Scheme { kernel, velocity, total: true }
    }
    /// List all compiled schemes.
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
    /// Return true if the scheme is compiled here. Linear shape functions and CPDI have no APIC, and CPDI is compiled with FLIP and USL
    /// only. In the reference configuration cpGIMP equals uGIMP, which is between the linear shape function and the quadratic spline and is
    /// omitted.
    pub fn is_legal(self) -> bool {
        match self.kernel {
            Kernel::Linear => self.velocity != Velocity::ApicUsl,
            Kernel::Gimp | Kernel::CpGimp => !self.total,
            Kernel::Cpdi | Kernel::Cpdi2 => !self.total && self.velocity == Velocity::FlipUsl,
            Kernel::Quadratic | Kernel::Cubic => true,
        }
    }
    /// Name, as in `TL quadratic APIC`.
    pub fn name(self) -> String {
        let frame = if self.total { "TL " } else { "" };
        format!("{frame}{} {}", self.kernel.name(), self.velocity.name())
    }
    /// Find a scheme by name.
    pub fn named(name: &str) -> Option<Scheme> {
        Scheme::all().into_iter().find(|s| s.name() == name)
    }
}

/// Return the kernels of a scheme; `None` if the scheme does not exist.
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

/// Return kernels of a shape function with fixed domain, for transfers without an affine matrix.
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

/// Return kernels for FLIP and USL only.
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
