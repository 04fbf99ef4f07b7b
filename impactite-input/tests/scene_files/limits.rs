//! What limits the step of scenes of every method: the body whose waves cross its cells soonest.

use impactite::scene::StepLimit;
use impactite_input::Source;

/// Two blocks that do not meet, of which the second has the faster waves.
fn scene(method: &str, contact: &str, mesh: &str) -> String {
    format!(
        r#"
title = "two blocks"
space = "plane strain"
end = "1 us"
{method}
{contact}
materials.soft.elastic = {{ density = 7800, young = "50 GPa", poisson = 0.3 }}
materials.stiff.elastic = {{ density = 7800, young = "200 GPa", poisson = 0.3 }}
[bodies.soft]
material = "soft"
shape.box = {{ from = [0, 0], to = ["10 mm", "10 mm"] }}
velocity = ["1 m/s", 0]
{mesh}
[bodies.stiff]
material = "stiff"
shape.box = {{ from = ["20 mm", 0], to = ["30 mm", "10 mm"] }}
velocity = ["1 m/s", 0]
{mesh}
"#
    )
}

#[test]
fn every_method_names_the_body_that_limits_the_step() {
    let contact = "contact.law.friction = 0.2";
    for (method, contact, mesh) in [
        ("method.mpm = { cell = \"1 mm\", for = \"impact\" }", "contact = \"none\"", ""),
        ("method.fem = {}", contact, "mesh.edge = \"1 mm\""),
        ("method.sph = { spacing = \"1 mm\" }", contact, ""),
        ("method.pcmm = { spacing = \"1 mm\" }", contact, ""),
        ("method.fpm = { spacing = \"1 mm\" }", contact, ""),
    ] {
        let source = Source::new("blocks.toml", scene(method, contact, mesh));
        let parsed = source.parse().unwrap_or_else(|e| panic!("{method}: {e}"));
        let mut solver = source.build(&parsed).unwrap_or_else(|e| panic!("{method}: {e}"));
        for _ in 0..4 {
            solver.step_at_most(f64::INFINITY).unwrap_or_else(|e| panic!("{method}: {e}"));
        }
        assert_eq!(solver.limited_by(), Some(StepLimit::Body(1)), "{method}");
    }
}
