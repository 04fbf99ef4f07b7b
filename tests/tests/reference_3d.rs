//! Comparison of the fast step with the plain reference within round-off: three dimensions.

use impactite_tests::compare::compare;
use impactite_tests::reference::{Order, Rule};
use impactite_tests::scene::{self, metal, rubber};
use mpm_core::{
    Aflip, Apic, CpGimp, Cpdi, Cpdi2, CubicBSpline, Flip, Fmpm, FullSpace, Gimp, Linear, Method, Mls, Musl,
    QuadraticBSpline, Usf, Usl,
};

/// Allowed difference: as in two dimensions.
const TOLERANCE: f64 = 1e-11;

macro_rules! table {
    ($($name:ident: $shape:expr, $transfer:expr, $rule:expr, $order:ident, $(.$compiled:ident(),)? [$($scene:expr),*], $law:expr;)*) => {$(
        #[test]
        fn $name() {
            let method = Method::new($shape, $transfer, $order, FullSpace)$(.$compiled())?;
            $(
                let scene = $scene;
                let found = compare(method, $shape, $rule, Order::$order, &scene, &$law);
                println!("{}: {found:?}", scene.name);
                assert!(found.worst() < TOLERANCE, "{}: {found:?}", scene.name);
            )*
        }
    )*};
}

table! {
    linear_flip_musl: Linear, Flip, Rule::Flip, Musl, [scene::flow(), scene::slide(), scene::bar(), scene::collision()], rubber();
    gimp_flip_usl: Gimp, Flip, Rule::Flip, Usl, .compiled(), [scene::flow(), scene::bar(), scene::collision()], metal();
    cpgimp_flip_usf: CpGimp, Flip, Rule::Flip, Usf, .compiled(), [scene::flow(), scene::bar()], rubber();
    cpdi_flip_usl: Cpdi, Flip, Rule::Flip, Usl, .compiled(), [scene::flow()], rubber();
    cpdi2_flip_musl: Cpdi2, Flip, Rule::Flip, Musl, .compiled(), [scene::flow()], rubber();
    quadratic_aflip_usl: QuadraticBSpline, Aflip::default(), Rule::Aflip(0.01), Usl, [scene::flow(), scene::slide(), scene::bar()], metal();
    quadratic_mls_usl: QuadraticBSpline, Mls, Rule::Mls, Usl, [scene::flow(), scene::slide(), scene::bar(), scene::collision()], rubber();
    quadratic_fmpm2_usl: QuadraticBSpline, Fmpm::<2>, Rule::Fmpm(2), Usl, .compiled(), [scene::flow(), scene::bar()], metal();
    cubic_apic_usf: CubicBSpline, Apic, Rule::Apic, Usf, .compiled(), [scene::flow(), scene::slide(), scene::bar()], rubber();
}
