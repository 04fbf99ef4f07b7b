//! Expressions of formulas: precedence, functions, errors.

use impactite_scene_file::expression::{self, Expression};
use impactite_scene_file::quantity::Parameters;

fn value(text: &str) -> f64 {
    let parsed = Expression::parse(text).unwrap_or_else(|why| panic!("{text}: {why}"));
    let values: Vec<f64> = parsed.names().iter().map(|name| f64::from(name.len() as u32)).collect();
    parsed.value(&values)
}

#[test]
fn precedence_is_that_of_mathematics() {
    // Variables have the length of their name as value: x = 1, ab = 2, abc = 3.
    let cases = [
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("-ab^2", -4.0),
        ("3 - -ab^2", 7.0),
        ("exp(-((abc - x) / ab)^2)", (-1.0_f64).exp()),
        ("2 * 3^2", 18.0),
        ("-2 * -3", 6.0),
        ("8 / 4 / 2", 1.0),
        ("8 / 4 * 2", 4.0),
        ("8 * 4 / 2", 16.0),
        ("1 - 2 - 3", -4.0),
        ("1 - 2 + 3", 2.0),
        ("1 - (2 + 3)", -4.0),
        ("+3 + +2", 5.0),
        ("--2", 2.0),
        ("1e3 + 1.5E-1 + .5 + 2.", 1002.65),
        ("min(3, ab, abc) + max(1, 2)", 4.0),
        ("atan2(1, -1)", 0.75 * std::f64::consts::PI),
        ("sin(pi / 2) + cos(PI) + 2 * pi - TAU", 0.0),
        ("ln(e) + log10(100) + log2(8)", 6.0),
        ("signum(-3) + abs(-3) + fract(2.25) + floor(-0.5)", 1.25),
        ("x^0.5^ab", 1.0),
    ];
    for (text, wanted) in cases {
        assert!((value(text) - wanted).abs() <= 1e-15 * wanted.abs(), "{text}: {} for {wanted}", value(text));
    }
    assert!(value("min(0 / 0, 1)").is_nan());
    assert!(value("sqrt(-1)").is_nan());
}

#[test]
fn errors_name_the_place() {
    let cases = [
        ("", "at the end"),
        ("3 *", "at the end"),
        ("2 x", "before `x`"),
        ("(1 + 2", "`)` is missing"),
        ("1 + 2)", "without `(`"),
        ("1,5", "decimals are written with a point"),
        ("sin x", "write `sin(...)`"),
        ("sin(1, 2)", "one argument"),
        ("atan2(1)", "two arguments"),
        ("log(10)", "`ln` or `log10`"),
        ("foo(1)", "not a function"),
        ("x ** 2", "x^2"),
        ("1 + $", "before `$`"),
        (".", "not a number"),
    ];
    for (text, part) in cases {
        let why = Expression::parse(text).unwrap_err();
        assert!(why.contains(part), "{text}: {why}");
    }
    let deep = "(1 + ".repeat(65) + "1" + &")".repeat(65);
    assert!(Expression::parse(&deep).is_err());
}

/// The page of the book lists every function and constant of formulas, and none of them names a parameter or variable.
#[test]
fn functions_and_constants_are_in_the_book() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/book/src/scene-files.md");
    let page = std::fs::read_to_string(page).expect("the page of scene files");
    for name in expression::reserved().filter(|name| name.is_ascii()) {
        assert!(page.contains(&format!("`{name}`")), "{name}");
        assert!(Parameters::default().define(name, &name.len().to_string()).is_err(), "{name}");
    }
}
