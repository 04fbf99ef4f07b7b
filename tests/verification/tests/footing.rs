//! V18: the limit load of a strip footing, with and without what keeps it from locking; V24 is in `heat`.

mod heat;

use mpm_core::{Flip, Linear, Method, Musl, PlaneStrain};
use verification::problems::footing::{EXACT, press};

#[test]
fn v18_strip_footing() {
    let hats = || Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian();
    let own = press(hats(), 4, 4).expect("scene").loads;
    println!("own dilatation, 4 cells: {own:.3?}");
    for cells in [4, 8] {
        let mean = press(hats().mean_dilatation(), cells, 4).expect("scene").loads;
        println!("mean dilatation, {cells} cells: {mean:.3?}, {:.3} of (2 + pi) c", mean[3] / EXACT);
        assert!((mean[3] / EXACT - 1.0).abs() < 0.03, "{cells} cells: {mean:?}");
        // A plateau: the last quarter of the way changes nothing much.
        assert!((mean[3] / mean[2] - 1.0).abs() < 0.02, "{cells} cells: {mean:?}");
    }
    assert!(own[3] > 1.1 * EXACT, "no locking to cure: {own:?}");
}
