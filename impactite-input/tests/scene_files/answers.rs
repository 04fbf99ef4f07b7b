//! Scenes whose answers are known, by keys of files: loads, damping, contact force, points, integration of elements.

use impactite::observe::RunView;
use impactite::scene::{Solver, StepLimit};
use impactite_input::measured::Measures;
use impactite_input::{SceneFile, Source};

struct Ready {
    scene: SceneFile,
    solver: Box<dyn Solver>,
    measures: Measures,
}

fn set_up(text: &str) -> Result<Ready, String> {
    let source = Source::new("scene.toml", text);
    let scene = source.parse().map_err(|e| e.to_string())?;
    let solver = source.build(&scene).map_err(|e| e.to_string())?;
    let measures = Measures::new(&source, &scene, &*solver).map_err(|e| e.to_string())?;
    Ok(Ready { scene, solver, measures })
}

/// The measures at the end, by name.
fn end_of(text: &str) -> impl Fn(&str) -> f64 + use<> {
    let mut ready = set_up(text).unwrap_or_else(|e| panic!("{e}"));
    let Ready { scene, solver, measures } = &mut ready;
    while !solver.reached(scene.end.value) {
        solver.step_towards(scene.end.value).unwrap_or_else(|e| panic!("{e}"));
        measures.look(&RunView::of(&**solver)).unwrap_or_else(|e| panic!("{e}"));
        if measures.ended(&RunView::of(&**solver)).unwrap_or_else(|e| panic!("{e}")).is_some() {
            break;
        }
    }
    let values = ready.measures.take(&RunView::of(&*ready.solver)).unwrap_or_else(|e| panic!("{e}"));
    let names: Vec<String> = ready.scene.measures.keys().cloned().collect();
    move |name| values[names.iter().position(|n| n == name).expect("a measure")]
}

/// A column of 1 m, 1000 kg/m^3, 1 MPa and no lateral strain, that is let go under 10 m/s^2.
const COLUMN: &str = r#"
title = "a column that settles"
space = "plane strain"
end = "4 s"
gravity = [0, -10]
materials.soft.elastic = { density = 1000, young = "1 MPa", poisson = 0 }
conditions = [
    { fixed = { axis = "y", at = 0 } },
    { symmetry = { axis = "x", at = 0 } },
    { symmetry = { axis = "x", at = "0.2 m", side = "below" } },
]
[bodies.column]
material = "soft"
shape.box = { from = [0, 0], to = ["0.2 m", "1 m"] }
[measures]
top = { position_at = { body = "column", at = ["0.1 m", "1 m"], axis = "y" } }
foot = { value_at = { body = "column", at = ["0.1 m", 0], field = "pressure" } }
speed = { largest = { body = "column", field = "speed" } }
[method.mpm]
cell = "0.1 m"
parts = { shape_function = "linear", transfer = "flip", stress_update = "musl" }
"#;

#[test]
fn damped_columns_settle_under_their_weight() {
    for damping in ["local_damping = 0.7", "kinetic_damping = true"] {
        let at = end_of(&format!("{COLUMN}{damping}\n"));
        // rho g H^2 / 2 E = 5 mm at the top; the outermost particle lies a quarter of a cell within.
        let seen = 1.0 - 0.025 - at("top");
        let wanted = 1000.0 * 10.0 / 1e6 * (0.975 - 0.975f64.powi(2) / 2.0);
        assert!((seen / wanted - 1.0).abs() < 0.03, "{damping}: the top sinks by {seen} m, not {wanted} m");
        // Without lateral strain and Poisson's ratio stress is along y alone: a third of rho g (H - y).
        let pressure = 1000.0 * 10.0 * 0.975 / 3.0;
        assert!(
            (at("foot") / pressure - 1.0).abs() < 0.06,
            "{damping}: {} Pa, not {pressure} Pa",
            at("foot")
        );
        assert!(at("speed") < 0.01, "{damping}: still at {} m/s", at("speed"));
    }
}

/// A block alone.
fn block(method: &str, more: &str) -> String {
    format!(
        r#"
title = "a block"
space = "plane strain"
end = "2 s"
materials.soft.elastic = {{ density = 1000, young = "1 MPa", poisson = 0.2 }}
{method}
[bodies.block]
material = "soft"
shape.box = {{ from = [0, 0], to = ["0.4 m", "0.4 m"] }}
{more}
[measures]
velocity = {{ velocity_at = {{ body = "block", at = ["0.1 m", "0.1 m"], axis = "x" }} }}
place = {{ position_at = {{ body = "block", at = ["0.1 m", "0.1 m"], axis = "x" }} }}
"#
    )
}

#[test]
fn a_body_force_of_time_moves_a_block_as_its_integrals() {
    let text = block("method.mpm = { cell = \"0.1 m\" }", "body_force = [\"= 3 * t\", 0]");
    let at = end_of(&text);
    // 3 t^2 / 2 and t^3 / 2, from a particle at 75 or 125 mm.
    assert!((at("velocity") / 6.0 - 1.0).abs() < 5e-3, "{}", at("velocity"));
    let start = [0.075, 0.125].map(|x| (at("place") - x) / 4.0 - 1.0);
    assert!(start.iter().any(|off| off.abs() < 5e-3), "{}", at("place"));
}

#[test]
fn a_dense_grid_gives_the_same_bits() {
    let text = |grid: &str| {
        block(&format!("method.mpm = {{ cell = \"0.1 m\", grid{grid} }}"), "velocity = [1, 0]\nspin = [2]")
    };
    let (blocks, dense) = (
        end_of(&text(" = \"blocks\"")),
        end_of(&text(".dense = { from = [\"-1 m\", \"-1 m\"], to = [\"4 m\", \"2 m\"] }")),
    );
    assert_eq!(
        ["velocity", "place"].map(|n| blocks(n).to_bits()),
        ["velocity", "place"].map(|n| dense(n).to_bits())
    );
    let small = text(".dense = { from = [\"-1 m\", \"-1 m\"], to = [\"1 m\", \"1 m\"] }");
    let mut small = set_up(&small).unwrap_or_else(|e| panic!("{e}"));
    let said = small.solver.run_until(2.0).expect_err("it leaves the box").to_string();
    assert!(said.contains("block"), "{said}");
}

#[test]
fn what_rests_on_another_body_presses_it_with_its_weight() {
    let at = end_of(
        r#"
title = "a block on a table"
space = "plane strain"
end = "1.5 s"
gravity = [0, -10]
contact.law.friction = 0.3
materials.soft.elastic = { density = 1000, young = "1 MPa", poisson = 0.2 }
conditions = [{ fixed = { axis = "y", at = 0 } }]
[method.mpm]
cell = "0.05 m"
local_damping = 0.7
parts = { shape_function = "linear", transfer = "flip", stress_update = "musl" }
[bodies.table]
material = "soft"
shape.box = { from = [0, 0], to = ["1 m", "0.2 m"] }
[bodies.block]
material = "soft"
shape.box = { from = ["0.3 m", "0.2 m"], to = ["0.7 m", "0.6 m"] }
[measures]
up = { contact_force = { between = ["table", "block"], axis = "y" } }
down = { contact_force = { between = ["block", "table"], axis = "y" } }
"#,
    );
    // Per metre of depth, 1000 kg/m^3 of 0.16 m^2. With wide shape functions (cpGIMP, splines) local damping never rests, and the force
    // is 1641 to 1678 N.
    assert!((at("up") / 1600.0 - 1.0).abs() < 0.02, "{} N", at("up"));
    assert_eq!(at("down"), -at("up"));
}

/// A cantilever of nearly incompressible rubber under its weight, two elements thick.
fn cantilever(integration: &str) -> f64 {
    let text = format!(
        r#"
title = "a cantilever of rubber"
space = "plane strain"
end = "0.22 s"
gravity = [0, -0.2]
materials.rubber.elastic = {{ density = 1000, young = "1 MPa", poisson = 0.4999 }}
conditions = [{{ fixed = {{ axis = "x", at = 0 }} }}]
method.fem = {{}}
[bodies.beam]
material = "rubber"
shape.box = {{ from = [0, 0], to = ["0.4 m", "0.04 m"] }}
mesh.edge = "0.02 m"
{integration}
[measures]
tip = {{ position_at = {{ body = "beam", at = ["0.4 m", "0.02 m"], axis = "y" }} }}
"#
    );
    let mut ready = set_up(&text).unwrap_or_else(|e| panic!("{integration}: {e}"));
    let start = ready.measures.take(&RunView::of(&*ready.solver)).expect("a place")[0];
    let mut lowest = start;
    for n in 1..=20 {
        ready.solver.run_until(0.011 * f64::from(n)).unwrap_or_else(|e| panic!("{integration}: {e}"));
        lowest = lowest.min(ready.measures.take(&RunView::of(&*ready.solver)).expect("a place")[0]);
    }
    start - lowest
}

#[test]
fn integration_decides_whether_rubber_locks() {
    // Twice the deflection at rest, w L^4 / 8 E' I, is where a beam that is let go comes to; E' = E / (1 - nu^2).
    let (weight, section) = (1000.0 * 0.2 * 0.04, 0.04f64.powi(3) / 12.0);
    let most = 2.0 * weight * 0.4f64.powi(4) / (8.0 * 1e6 / (1.0 - 0.4999f64.powi(2)) * section);
    let [usual, mean, full] =
        ["", "integration = \"mean_dilatation\"", "integration = \"full\""].map(cantilever);
    assert!(full < 0.2 * most, "full integration locks: {full} of {most} m");
    for (name, seen) in [("as their kind asks for", usual), ("mean dilatation", mean)] {
        assert!(seen > 0.5 * most && seen < 1.6 * most, "{name}: {seen} of {most} m");
    }
    let stiff = cantilever("integration.one_point = { stiffness = 1 }");
    assert!(stiff < usual, "stiffer hourglass control: {stiff} and {usual} m");
}

#[test]
fn what_does_not_go_together_is_refused() {
    for (text, wanted) in [
        (block("method.mpm = { cell = \"0.1 m\" }", "merge_above = 9"), "split_at"),
        (block("method.mpm = { cell = \"0.1 m\" }", "integration = \"full\""), "bodies.block.integration"),
        (block("method.fem = {}", "mesh.edge = \"0.1 m\"\nintegration = \"averaged_volumes\""), "simplices"),
        (block("method.fem = {}", "mesh.edge = \"0.1 m\"\nbody_force = [0, 0]"), "bodies.block.body_force"),
        (block("method.mpm = { cell = \"0.1 m\", local_damping = 1.5 }", ""), "method.mpm.local_damping"),
        (block("method.mpm = { cell = \"0.1 m\" }", "body_force = [\"= z\", 0]"), "z"),
        (block("method.fem = { subcycles = 0 }", "mesh.edge = \"0.1 m\""), "method.fem.subcycles"),
    ] {
        let said = set_up(&text).err().unwrap_or_else(|| panic!("{wanted}: not refused"));
        assert!(said.contains(wanted) && said.contains("scene.toml:"), "{wanted}: {said}");
    }
}

#[test]
fn steps_by_the_circles_of_gershgorin_are_limited_by_nodes() {
    let text = block(
        "method.mpm = { cell = \"0.1 m\", parts = { shape_function = \"linear\", transfer = \"flip\", stress_update = \"musl\" } }\n\
         time_step.gershgorin = { factor = 0.8 }",
        "",
    );
    let mut ready = set_up(&text).unwrap_or_else(|e| panic!("{e}"));
    for _ in 0..3 {
        ready.solver.step_at_most(f64::INFINITY).unwrap_or_else(|e| panic!("{e}"));
    }
    assert_eq!(ready.solver.limited_by(), Some(StepLimit::Nodes));
}

/// A steel sphere through plates of named sets: with `failure = "library"` each breaks, without it only those that fail by their own law.
#[test]
fn plates_of_named_sets_break_by_the_failure_of_their_source() {
    let path =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/templates/plate_perforation.toml");
    // The scenes are not in the package.
    let Ok(text) = std::fs::read_to_string(path) else { return };
    let run = |set: &str, failure: bool| {
        let mut source = Source::new("plate.toml", text.replace("checks]]", "unused]]"));
        source.text = source.text.split("[[unused]]").next().unwrap_or_default().to_string();
        source = source.set(&format!("materials.aluminium.library={set}")).unwrap_or_else(|e| panic!("{e}"));
        if !failure {
            source.text = source.text.replace("failure = \"library\"", "");
        }
        end_of(&source.text)
    };
    let density = |set: &str| match set {
        "lead" => 11350.0,
        "copper_ofhc" => 8930.0,
        "aluminium_6061_t6" | "aluminium_2024_t3" => 2700.0,
        _ => 7830.0,
    };
    for set in [
        "aluminium_6061_t6",
        "aluminium_2024_t3",
        "copper_ofhc",
        "steel_4340",
        "weldox_460_e",
        "weldox_460_e_uncoupled",
        "lead",
    ] {
        let broken = run(set, true);
        let residual = -broken("residual");
        assert!(broken("failed") > 0.01 && broken("failed") < 0.6, "{set}: {} failed", broken("failed"));
        // Through the plate, and slower than by Newton's drag alone: strength takes the rest.
        let drag = 1000.0 * (-0.5 * density(set) / 7830.0 * 0.75 * 2.0 / 3.0_f64).exp();
        assert!(residual > 0.5 * drag && residual < drag, "{set}: {residual} m/s, drag alone {drag}");
        let whole = run(set, false);
        if set.starts_with("weldox") {
            assert_eq!(whole("residual").to_bits(), broken("residual").to_bits(), "{set}");
        } else {
            assert_eq!(whole("failed"), 0.0, "{set}");
            // Of lead, which fails at a strain of 3, so few fail that it hardly matters.
            assert!(residual > -0.999 * whole("residual"), "{set}: {residual} and {}", whole("residual"));
        }
    }
}

#[test]
fn failure_by_a_named_set_is_refused_where_there_is_none() {
    let text = |material: &str| {
        format!("{}\nmaterials.other = {{ {material} }}", block("method.mpm = { cell = \"0.1 m\" }", ""))
            .replace("material = \"soft\"", "material = \"other\"")
    };
    for (material, words) in [
        ("library = \"tungsten_alloy\", failure = \"library\"", ["steel_4340", "failure.plastic_strain"]),
        ("library = \"water\", failure = \"library\"", ["no failure constants", "lead"]),
        ("library = \"weldox_460_e\", failure.damage.limit = 1.5", ["critical damage", "at most 1"]),
        (
            "strength.elastic.shear_modulus = 1e9, eos.logarithmic_bulk = { density = 1000, bulk_modulus = 1e9 }, failure = \"library\"",
            ["named set", "failure.johnson_cook"],
        ),
    ] {
        // Keys of tables come before those of bodies.
        let text = text(material);
        let (head, tail) = text.rsplit_once("materials.other").expect("the material");
        let text = head.replacen("materials.soft", &format!("materials.other{tail}\nmaterials.soft"), 1);
        let said = set_up(&text).err().unwrap_or_else(|| panic!("{material}: not refused"));
        assert!(said.contains("materials.other.failure"), "{material}: {said}");
        assert!(words.iter().all(|w| said.contains(w)), "{material}: {said}");
    }
}

#[test]
fn keys_without_effect_on_a_material_are_refused() {
    let steel = "eos.logarithmic_bulk = { density = 7850, bulk_modulus = 172e9 }";
    let elastic = format!("strength.elastic.shear_modulus = 79e9, {steel}");
    let damage = "failure.johnson_cook = { d = [0.05, 3.44, -2.12, 0.002, 0.61], reference = 1 }";
    let j2 = format!("strength.j2 = {{ shear_modulus = 79e9, yield = 350e6 }}, {steel}");
    for (material, key, words) in [
        (format!("{elastic}, failure.plastic_strain.limit = 1"), "failure.plastic_strain", "plastic flow"),
        (format!("{elastic}, {damage}"), "failure.johnson_cook", "plastic flow"),
        (format!("{j2}, failure.damage.limit = 0.3"), "failure.damage", "strength.borvik"),
        (format!("{j2}, failure.post_failure = \"pressure\""), "failure", "criterion"),
        (
            "fluid.incompressible.density = 1000, bingham = { yield = 1, viscosity = 1, creep_rate = 1 }"
                .into(),
            "bingham",
            "fluid.incompressible",
        ),
    ] {
        let text = block("method.mpm = { cell = \"0.1 m\" }", "")
            .replace("materials.soft", &format!("materials.other = {{ {material} }}\nmaterials.soft"));
        let said = set_up(&text).err().unwrap_or_else(|| panic!("{material}: not refused"));
        assert!(
            said.contains(&format!("materials.other.{key}")) && said.contains(words),
            "{material}: {said}"
        );
    }
    let lit = block("method.mpm = { cell = \"0.1 m\" }", "lit = [{ at = [0, 0] }]\nsplit_at = 1.5")
        .replace("materials.soft", "materials.charge.library = \"tnt\"\nmaterials.soft")
        .replace("material = \"soft\"", "material = \"charge\"");
    let said = set_up(&lit).err().expect("a lit explosive that is split");
    assert!(said.contains("split_at") && said.contains("lit"), "{said}");
}

/// The density of Steinberg and Guinan's law is that of the material. With that of the solid a porous body would be expanded, and
/// molten: here at 175 K instead of 400 K.
#[test]
fn steinberg_and_guinan_have_the_density_of_the_material_with_its_pores() {
    let law = "strength.steinberg_guinan = { shear_modulus = 50e9, pressure = 2e-11, temperature = 4e-4, yield = 1e8, largest = 6e8, beta = 36, n = 0.45, \
               room = 300, melt = 400, gruneisen = 2, correction = 1.5, capacity = 383 }, eos.logarithmic_bulk = { density = 8930, bulk_modulus = 140e9 }";
    for pores in ["", ", porous = { distension = 1.25, elastic_limit = 1e7, full_compaction = 1e8 }"] {
        let text = COLUMN
            .replace("materials.soft", &format!("materials.metal = {{ {law}{pores} }}\nmaterials.soft"))
            .replace("material = \"soft\"", "material = \"metal\"")
            .replace("end = \"4 s\"", "end = \"0.2 ms\"")
            .replace(
                "speed = {",
                "mises = { largest = { body = \"column\", field = \"von_mises\" } }\nspeed = {",
            );
        let mises = end_of(&text)("mises");
        assert!(mises > 1e3, "{pores}: {mises} Pa");
    }
}
