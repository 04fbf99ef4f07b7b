//! Quantities, formulas, keys and lists.

use impactite_input::Source;
use impactite_input::formula::{Coordinates, Formula};
use impactite_input::list::Topic;
use impactite_input::quantity::{Parameters, Speed};
use serde::Deserialize;
use serde::de::value::{Error, StrDeserializer};

fn length(text: &str) -> Result<f64, String> {
    Parameters::default().quantity(text, "m")
}

/// The bits of a literal in a program: decimal units are exact until the last step.
#[test]
fn units_are_exact() {
    assert_eq!(length("7.6 mm"), Ok(7.6e-3));
    assert_eq!(length("3.8mm"), Ok(3.8e-3));
    assert_eq!(length("25.4 mm"), Ok(25.4e-3));
    for inches in ["1 inch", "1 in", "1in", "(0.5 + 0.5) in"] {
        assert_eq!(length(inches), Ok(0.0254), "{inches}");
    }
    let p = Parameters::default();
    assert_eq!(p.quantity("80 us", "s"), Ok(80e-6));
    assert_eq!(p.quantity("2 min", "s"), Ok(120.0));
    assert_eq!(p.quantity("100 in/s^2", "m/s^2"), Ok(2.54));
    assert_eq!(p.quantity("sin(30 deg)", ""), Ok(0.5));
    assert_eq!(p.quantity("80 µs", "s"), Ok(80e-6));
    assert_eq!(p.quantity("-190 m/s", "m/s"), Ok(-190.0));
    assert_eq!(p.quantity("8.96 g/cm^3", "kg/m^3"), Ok(8960.0));
    assert_eq!(p.quantity("48 MPa", "Pa"), Ok(48e6));
    assert_eq!(p.quantity("383 J/(kg K)", "J/(kg K)"), Ok(383.0));
    assert_eq!(p.quantity("1/4", ""), Ok(0.25));
    assert!((p.quantity("30 deg", "rad").unwrap_or(0.0) - std::f64::consts::FRAC_PI_6).abs() < 2e-16);
    assert!((p.quantity("60 rpm", "rad/s").unwrap_or(0.0) - std::f64::consts::TAU).abs() < 1e-14);
}

#[test]
fn another_measure_is_refused_with_both() {
    let why = length("190 m/s").unwrap_err();
    assert!(why.contains("meter / second") && why.contains("meter"), "{why}");
    let why = length("7.6").unwrap_err();
    assert!(why.contains("unitless"), "{why}");
    assert!(Parameters::default().quantity("3 m", "").is_err());
}

/// The bound counts operations, so that the answer is the same on a busy machine.
#[test]
fn costly_and_malformed_texts_are_refused() {
    let costly = ["10^10^10 m", "1e999999999 m", "2^1.23456789 m", "10^(10^9) m"];
    for text in costly {
        let why = length(text).unwrap_err();
        assert!(why.contains("too many operations"), "{text}: {why}");
    }
    // A decimal comma is no separator of thousands.
    for text in ["3,8 m", "0,5 m", "1,000 m"] {
        let why = length(text).unwrap_err();
        assert!(why.contains("`,` is not allowed"), "{text}: {why}");
    }
    for text in [
        "(1e9)! m",
        "0/0 m",
        "1/0 m",
        "",
        "m m m (",
        "sin m",
        "a = 3 m",
        "3 m; 4 m",
        "ans",
        "_",
        "@debug 3 m",
    ] {
        assert!(length(text).is_err(), "{text}");
    }
    // Answers do not depend on what was evaluated before.
    let mut p = Parameters::default();
    p.define("radius", "2 mm").unwrap();
    assert_eq!(p.quantity("radius", "m"), Ok(2e-3));
    assert!(p.quantity("ans", "m").is_err() && p.quantity("radius + _", "m").is_err());
}

/// Parsers descend a level per parenthesis, sign, power and function; the stack of a thread bears what is allowed.
#[test]
fn deep_and_long_texts_are_refused_before_they_are_parsed() {
    let nested = |n: usize, open: &str, inner: &str, close: &str| open.repeat(n) + inner + &close.repeat(n);
    for (open, close) in [
        ("(", ")"),
        ("-", ""),
        ("", "^1"),
        ("sin ", ""),
        ("1 + 2 (", ")"),
        ("", " m"),
        ("2^(", ")"),
        ("1/(1+", ")"),
    ] {
        for n in [60, 1000, 20_000] {
            let text = nested(n, open, "1", close);
            let why = length(&text).unwrap_err();
            assert!(why.contains("are allowed"), "{open}: {why}");
            let formula = Formula::<Speed>::deserialize(StrDeserializer::<Error>::new(&format!("= {text}")));
            assert!(formula.is_err(), "{open}");
        }
    }
    let small = std::thread::Builder::new().stack_size(1 << 20).spawn(move || {
        for (n, open, close) in
            [(8, "(", ")"), (40, "-", ""), (40, "", "^1"), (8, "1 + 2 (", ")"), (200, "", "+ 1")]
        {
            let text = nested(n, open, "1", close);
            assert!(Parameters::default().quantity(&text, "").is_ok(), "{text}");
        }
    });
    small.expect("a thread").join().expect("no overflow");
}

/// The work per parameter does not grow with their number.
#[test]
fn thousands_of_parameters_are_defined() {
    let mut p = Parameters::default();
    p.define("a0", "1 mm").unwrap();
    for n in 1..3000 {
        p.define(&format!("a{n}"), &format!("a{} + 1 mm", n - 1)).unwrap();
    }
    assert_eq!(p.quantity("a2999", "m"), Ok(3.0));
}

#[test]
fn parameters_go_into_quantities_in_order() {
    let mut p = Parameters::default();
    p.define("radius", "3.8 mm").unwrap();
    p.define("cells", "10").unwrap();
    p.define("spacing", "radius / cells").unwrap();
    assert_eq!(p.quantity("spacing", "m"), Ok(0.38e-3));
    assert_eq!(p.numbers()["spacing"], 0.38e-3);
    // Units that nobody means; those that everybody means keep their names.
    for (name, value) in
        [("section", "2 cm^2"), ("half", "3 cm^2"), ("span", "4 cm^2"), ("rod", "5 cm^2"), ("link", "6 cm^2")]
    {
        p.define(name, value).unwrap_or_else(|why| panic!("{name}: {why}"));
        let number = p.quantity(value, "m^2");
        assert_eq!(p.quantity(name, "m^2"), number, "{name}");
        assert_eq!(p.quantity(&format!("2 * {name} / 2"), "m^2"), number, "{name}");
    }
    for name in ["mm", "MPa", "deg", "in", "inch", "sqrt", "m", "h", "x", "pi", "e"] {
        assert!(p.define(name, "1").is_err(), "{name}");
    }
    assert_eq!(p.quantity("2 * cells", ""), Ok(20.0));
    for (name, value) in
        [("m", "3"), ("x", "3"), ("2x", "3"), ("a-b", "3"), ("fine", "nonsense nobody knows")]
    {
        assert!(p.define(name, value).is_err(), "{name} = {value}");
    }
}

fn formula(text: &str) -> Result<Formula<Speed>, String> {
    let text = format!("= {text}");
    Formula::deserialize(StrDeserializer::<Error>::new(&text)).map_err(|e| e.to_string())
}

#[test]
fn formulas_see_place_time_and_parameters() {
    let mut p = Parameters::default();
    p.define("length", "25.4 mm").unwrap();
    let f = p.during(|| formula("-190 * (1 - z / length) + 0*t")).unwrap();
    assert_eq!(f.at(&[0.0, 0.0, 0.0127], false, 0.0), -95.0);
    assert_eq!(f.at(&[0.0, 0.0127], true, 0.0), -95.0);
    assert!(f.check(Coordinates::Space, true, true).is_ok());
    assert!(f.check(Coordinates::Plane, true, true).unwrap_err().contains("`z`"));
    assert!(f.check(Coordinates::Space, true, false).unwrap_err().contains("`t`"));
    assert!(f.check(Coordinates::Space, false, true).unwrap_err().contains("`z`"));
    let value = |text: &str| formula(text).map(|f| f.at(&[2.0, 3.0], false, 0.5));
    assert_eq!(value("3.2e6 * min(t / 2.5e-1, 1)"), Ok(3.2e6));
    assert_eq!(value("1E-3*x + .5 + 2.*y"), Ok(6.502));
    let why = formula("3 * speed").unwrap_err();
    assert!(why.contains("`speed`"), "{why}");
    assert!(formula("3 *").is_err());
    assert!(formula("").is_err());
}

#[test]
fn keys_are_set_in_tables_lists_and_where_there_were_none() {
    let source = Source::new("t", "a = 1\n[b]\nc = [1, 2]\n[[d]]\ne = 1\n");
    let set = |s: &str| source.set(s).map(|s| s.text);
    assert!(set("a=2").unwrap().contains("a = 2"));
    assert!(set("b.c[1]=\"3 m\"").unwrap().contains("c = [1, \"3 m\"]"));
    assert!(set("b.c[1]=3 m").unwrap().contains("\"3 m\""));
    assert!(set("d[0].e=5").unwrap().contains("e = 5"));
    let made = set("new.deep.key=600").unwrap();
    assert_eq!(made.parse::<toml_edit::DocumentMut>().unwrap()["new"]["deep"]["key"].as_integer(), Some(600));
    for (bad, why) in [
        ("a", "KEY=VALUE"),
        ("=3", "empty"),
        ("a.b=3", "no table"),
        ("b.c[7]=1", "list of 2"),
        ("a[0]=1", "no list"),
    ] {
        let said = source.set(bad).unwrap_err().to_string();
        assert!(said.contains(why), "{bad}: {said}");
    }
}

#[test]
fn every_list_has_lines_with_words() {
    for (topic, word) in Topic::ALL {
        let lines = topic.lines();
        assert!(lines.len() >= 3, "{word}: {lines:?}");
        assert!(lines.iter().all(|l| !l.what.is_empty()), "{word}: {lines:?}");
    }
    let friction = Topic::Conditions.lines().into_iter().find(|l| l.name == "wall").unwrap();
    let fields = ["axis", "at", "side?", "velocity?", "position?", "friction?", "name?"];
    assert_eq!(friction.fields, fields);
}

/// Parameters are written with those before them, and bodies are added as they stand there.
#[test]
fn keys_of_json_keep_their_order() {
    let json =
        r#"{"parameters": {"width": "2 m", "spacing": "width / 2"}, "bodies": {"second": {}, "first": {}}}"#;
    let text = Source::from_json("t", json).unwrap().text;
    let place = |word: &str| text.find(word).unwrap();
    assert!(place("width") < place("spacing") && place("second") < place("first"), "{text}");
}

/// Measures of masses, forces and energies are of what is computed.
#[test]
fn units_of_measures_say_what_they_are_per() {
    use impactite::scene::embedding::unit_of_part;
    use impactite_input::Source;
    use impactite_input::measured::columns;
    let text = r#"
title = "ball"
space = "SPACE"
end = "1 us"
method.mpm.cell = "1 mm"
materials.copper.library = "copper_taylor"
bodies.ball = { material = "copper", shape.ball = { centre = CENTRE, radius = "2 mm" } }
[measures]
mass = { mass = { body = "ball" } }
energy = { kinetic = { body = "ball" } }
momentum = { momentum = { body = "ball", axis = "z" } }
speed = { largest = { body = "ball", field = "speed" } }
"#;
    for (space, centre, axis, dimensions, revolved) in [
        ("axisymmetric", "[0, 0]", "z", 2, true),
        ("plane strain", "[0, 0]", "y", 2, false),
        ("3d", "[0, 0, 0]", "z", 3, false),
    ] {
        let text = text
            .replace("SPACE", space)
            .replace("CENTRE", centre)
            .replace("axis = \"z\"", &format!("axis = \"{axis}\""));
        let scene = Source::new("ball.toml", text).parse().expect("a scene");
        let found: Vec<String> = columns(&scene).into_iter().map(|(_, unit)| unit.to_string()).collect();
        let wanted = ["kg", "J", "kg m/s"].map(|unit| unit_of_part(unit, dimensions, revolved));
        assert_eq!(found, [&wanted[..], &["m/s".to_string()]].concat(), "{space}");
    }
}
