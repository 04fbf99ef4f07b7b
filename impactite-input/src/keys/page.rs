//! Page of the book with all keys of scene files.

use std::fmt::Write;

use super::{Key, all};
use crate::build::kernels::{PARTS, PURPOSES, word};
use crate::quantity::Parameters;

/// Tables of the page: path and heading.
const TABLES: &[(&str, &str)] = &[
    ("", "The scene"),
    ("parameters", "Parameters"),
    ("method", "Methods"),
    ("method.mpm", "Material point method"),
    ("method.fem", "Finite elements"),
    ("method.sph", "Smoothed particles"),
    ("method.fpm", "Fragile points"),
    ("method.pcmm", "Particle-contact method"),
    ("materials.NAME", "Materials"),
    ("bodies.NAME", "Bodies"),
    ("bodies.NAME.shape", "Shapes"),
    ("contact", "Contact"),
    ("conditions[]", "Boundary conditions"),
    ("time_step", "Time step"),
    ("measures.NAME", "Measures"),
    ("checks[]", "Checks"),
    ("output", "Output"),
];

/// Head of the page.
const HEAD: &str = "\
# All keys of scene files

`impactite list keys PREFIX` prints this page, or a part of it, in the terminal: `impactite list keys bodies.plate.shape`. `NAME` stands for any
name, `[]` for an element of a list: `bodies.NAME.shape` is the key `shape` of the table `[bodies.plate]`, `conditions[].wall` the key `wall`
of an entry `[[conditions]]`. Dots may be written instead of tables, and inline tables as well: `shape.ball = { centre = [0, 0], radius = \"5 mm\" }`.

A quantity is a number in the SI unit of the column \"value\", or a text with a unit, or arithmetic with [parameters](scene-files.md#numbers). A
formula is a text that begins with `=`. A key without default has no effect unless it is given, or its description says what holds then.
Examples are relative to the table that contains the key.

This page is made from the types that read scene files: `cargo run --release -- list keys --markdown > docs/book/src/keys.md`.
";

/// Generate the page of the book.
#[must_use]
pub fn markdown() -> String {
    let keys = all();
    let mut page = String::from(HEAD);
    for (table, heading) in TABLES {
        let _ = write!(page, "\n## {heading}\n\n");
        if let Some(key) = keys.iter().find(|key| key.path == *table) {
            let _ = writeln!(
                page,
                "`{}`: {} {}Example: `{}`\n",
                key.path,
                sentence(&key.what),
                said(key),
                key.example
            );
        }
        if let Some(list) = table.strip_suffix("[]")
            && let Some(key) = keys.iter().find(|key| key.path == list)
        {
            let _ = writeln!(page, "`[[{list}]]`: {}\n", sentence(&key.what));
        }
        let rows: Vec<&Key> =
            keys.iter().filter(|key| key.path != *table && table_of(&key.path) == *table).collect();
        if !rows.is_empty() {
            page += "| key | value | default | description | example |\n|---|---|---|---|---|\n";
        }
        for key in rows {
            let path = key.path.strip_prefix(table).unwrap_or(&key.path).trim_start_matches('.');
            let default = match (&key.default, key.required) {
                (_, true) => "**required**".into(),
                (Some(default), _) => format!("`{default}`"),
                (None, _) => String::new(),
            };
            let _ = writeln!(
                page,
                "| `{path}` | {} | {default} | {} | `{}` |",
                cell(&key.value()),
                cell(&key.what),
                cell(&key.example)
            );
            for (word, what) in key.words.iter().filter(|(_, what)| !what.is_empty()) {
                let _ = writeln!(page, "| | `\"{word}\"` | | {} | |", cell(what));
            }
        }
        match *table {
            "parameters" => page += &names_of_parameters(),
            "method.mpm" => page += &parts_of_mpm(),
            _ => {}
        }
    }
    page
}

/// Return the table of the page that contains a key.
fn table_of(path: &str) -> &'static str {
    let within = |table: &str| {
        table.is_empty()
            || path.strip_prefix(table).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    TABLES
        .iter()
        .map(|t| t.0)
        .filter(|table| within(table))
        .max_by_key(|table| table.len())
        .unwrap_or_default()
}

fn said(key: &Key) -> String {
    match key.value() {
        value if value.is_empty() || value == "table" => String::new(),
        value => format!("({value}) "),
    }
}

fn sentence(what: &str) -> String {
    if what.is_empty() || what.ends_with('.') { what.into() } else { format!("{what}.") }
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// List the names that parameters cannot have.
fn names_of_parameters() -> String {
    let refused = |name: &str| Parameters::default().define(name, "1").is_err();
    let letters = |all: &mut dyn Iterator<Item = char>, free: bool| -> String {
        let list: Vec<String> =
            all.map(|c| c.to_string()).filter(|c| refused(c) != free).map(|c| format!("`{c}`")).collect();
        list.join(", ")
    };
    let capital = letters(&mut ('A'..='Z'), true);
    let small = letters(&mut ('a'..='z'), true);
    let free: Vec<String> = [small, capital].into_iter().filter(|s| !s.is_empty()).collect();
    format!(
        "\nA name is a letter, then letters, digits and `_`. A parameter cannot have a name that means something in a quantity or a formula:\n\n\
         | refused | because |\n|---|---|\n\
         | `x`, `y`, `z`, `r`, `t` | coordinates and time of formulas |\n\
         | other single letters but {} | symbols of units and constants: `m` metre, `s` second, `h` hour, `g` gram, `e` Euler's number |\n\
         | `mm`, `kg`, `us`, `Pa`, `pi` and other units of two letters | units and constants |\n\
         | `MPa`, `deg`, `rpm`, `inch` and other usual units | units |\n\
         | `sqrt`, `sin`, `exp` and other functions | functions |\n\n\
         Take words: `radius`, `cells`, `speed`.\n",
        if free.is_empty() { "none".into() } else { free.join(", ") }
    )
}

/// Describe the parts of each purpose, and the compiled combinations of parts.
fn parts_of_mpm() -> String {
    let mut page = String::from(
        "\nWhat `for` chooses:\n\n| `for` | shape function | transfer | stress update | frame |\n|---|---|---|---|---|\n",
    );
    for (purpose, shape, transfer, update, frame) in PURPOSES {
        let _ = writeln!(
            page,
            "| `{}` | `{}` | `{}` | `{}` | {frame} |",
            word(purpose),
            word(shape),
            word(transfer),
            word(update)
        );
    }
    page += "\nCombinations of `parts` that are compiled in the program, all in the updated Lagrangian frame:\n\n\
             | shape function | transfer | stress update |\n|---|---|---|\n";
    for (shape, transfer, update) in PARTS {
        let _ = writeln!(page, "| `{}` | `{}` | `{}` |", word(shape), word(transfer), word(update));
    }
    page
}
