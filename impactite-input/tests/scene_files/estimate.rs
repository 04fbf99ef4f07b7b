//! Looks ahead: memory, and what points fill of their shapes.

use impactite_input::{SceneEstimate, Source, bytes_a_point};

fn ahead(text: &str) -> (SceneEstimate, f64) {
    let source = Source::new("scene.toml", text);
    let scene = source.parse().unwrap_or_else(|e| panic!("{e}"));
    let mut solver = source.build(&scene).unwrap_or_else(|e| panic!("{e}"));
    let ahead = source.estimate(&scene, &mut *solver).unwrap_or_else(|e| panic!("{e}"));
    let estimated = bytes_a_point(&scene.method, scene.space.dimensions());
    (ahead, estimated)
}

fn body(space: &str, method: &str, shape: &str, more: &str) -> String {
    format!(
        "title = \"b\"\nspace = \"{space}\"\nend = \"1 us\"\n{method}\nmaterials.copper.library = \"copper_taylor\"\n\
         [bodies.b]\nmaterial = \"copper\"\nshape.{shape}\n{more}\n"
    )
}

/// The estimate before a scene is set up is below what its solver takes, and no less than half of it.
#[test]
fn memory_is_estimated_from_below() {
    for (space, method, more) in [
        ("plane strain", "method.mpm = { cell = \"2 mm\" }", ""),
        ("3d", "method.mpm = { cell = \"8 mm\" }", ""),
        ("plane strain", "method.fem = {}", "mesh.edge = \"1 mm\""),
        ("3d", "method.fem = {}", "mesh.edge = \"5 mm\""),
        ("plane strain", "method.sph = { spacing = \"1 mm\" }", ""),
        ("3d", "method.sph = { spacing = \"5 mm\" }", ""),
        ("plane strain", "method.fpm = { spacing = \"2 mm\" }", ""),
        ("3d", "method.fpm = { spacing = \"10 mm\" }", ""),
        ("plane strain", "method.pcmm = { spacing = \"1 mm\" }", ""),
    ] {
        let cube = if space == "3d" {
            "box = { from = [0, 0, 0], to = [0.1, 0.1, 0.1] }"
        } else {
            "box = { from = [0, 0], to = [0.1, 0.1] }"
        };
        let (ahead, estimated) = ahead(&body(space, method, cube, more));
        let taken = ahead.bytes as f64 / ahead.bodies[0].points as f64;
        println!("{space}, {method}: {estimated} of {taken:.0} bytes a point");
        assert!(estimated <= taken && 2.0 * estimated >= taken, "{space}, {method}: {estimated} and {taken}");
    }
}

/// Particles of a lattice are scaled to the volume of their shape; the factor is that of the shape over as many cells.
#[test]
fn volume_factors_are_those_of_the_filling() {
    let (radius, part) = (0.0113f64, 0.001);
    for method in ["method.mpm = { cell = \"2 mm\" }", "method.sph = { spacing = \"1 mm\" }"] {
        let disc = body("plane strain", method, "ball = { centre = [0, 0], radius = 0.0113 }", "");
        let disc = &ahead(&disc).0.bodies[0];
        let factor = std::f64::consts::PI * radius * radius / (disc.points as f64 * part * part);
        let seen = disc.volume_factor.expect("a factor");
        assert!((seen - factor).abs() < 1e-12 && (seen - 1.0).abs() > 1e-4, "{method}: {seen}, {factor}");
    }
    // Half a ball around an axis: pi r^2 of its section, times the distance of each particle from the axis.
    let ball = "intersection = [{ ball = { centre = [0, 0], radius = 0.0113 } }, { half_space = { point = [0, 0], outward = [-1, 0] } }]";
    let ball = body("axisymmetric", "method.mpm = { cell = \"2 mm\" }", ball, "");
    let factor = ahead(&ball).0.bodies[0].volume_factor.expect("a factor");
    assert!((factor - 1.0).abs() < 0.1 && (factor - 1.0).abs() > 1e-5, "{factor}");
    // Off the lattice a body of the particle-contact method has its particles on the surface, and all of its mass.
    let off = "polygon = { corners = [[\"0.3 mm\", \"0.3 mm\"], [\"10.3 mm\", \"0.3 mm\"], [\"10.3 mm\", \"10.3 mm\"], [\"0.3 mm\", \"10.3 mm\"]] }";
    let (off, _) = ahead(&body("plane strain", "method.pcmm = { spacing = \"1 mm\" }", off, ""));
    let (factor, mass) = (off.bodies[0].volume_factor.expect("a factor"), off.bodies[0].mass);
    assert!((factor - 1.0).abs() < 1e-9 && (mass - 8930.0 * 1e-4).abs() < 1e-9, "{factor}, {mass} kg/m");
    // Boxes are where they are put, in all methods.
    let off = "box = { from = [\"0.3 mm\", \"0.3 mm\"], to = [\"10.3 mm\", \"10.3 mm\"] }";
    for method in
        ["mpm = { cell = \"2 mm\" }", "sph = { spacing = \"1 mm\" }", "pcmm = { spacing = \"1 mm\" }"]
    {
        let (off, _) = ahead(&body("plane strain", &format!("method.{method}"), off, ""));
        assert!(
            (off.bodies[0].mass / (8930.0 * 1e-4) - 1.0).abs() < 1e-9,
            "{method}: {} kg/m",
            off.bodies[0].mass
        );
    }
}
