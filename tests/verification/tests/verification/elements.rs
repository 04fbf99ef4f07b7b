//! Orders of convergence of finite elements.

use verification::problems::elements::{Elements, Wave, pulsating, standing};
use verification::stored::order;

/// Displacement errors over three meshes, and their order.
fn orders(name: &str, cells: [usize; 3], error: impl Fn(usize) -> Result<f64, String>) -> (f64, f64) {
    let list = cells.map(|cells| (cells, error(cells).expect("run")));
    let order = order(&list);
    println!("{name}: order {order:.2}, {list:?}");
    (order, list[2].1)
}

/// Second-order convergence of the displacement on distorted meshes, for pressure and shear waves.
#[test]
fn standing_waves_converge_with_second_order() {
    for wave in Wave::ALL {
        for elements in Elements::ALL {
            let name = format!("{wave:?}, {elements:?}");
            let (order, finest) = orders(&name, [16, 32, 64], |cells| standing(elements, wave, cells));
            assert!(order > 1.8, "{name}: {order}");
            assert!(finest < 0.02, "{name}: {finest}");
        }
    }
}

/// V3: second-order convergence at axis-aligned strains of 31 %.
#[test]
fn v3_converges_with_second_order() {
    for elements in Elements::ALL {
        let name = format!("V3, {elements:?}");
        let (order, finest) = orders(&name, [16, 32, 64], |cells| pulsating(elements, cells));
        assert!(order > 1.8, "{name}: {order}");
        // Tolerance: nodal averages of triangles smooth fields that quadrilaterals resolve.
        let most = if matches!(elements, Elements::Triangles(_)) { 0.006 } else { 0.0015 };
        assert!(finest < most, "{name}: {finest}");
    }
}
