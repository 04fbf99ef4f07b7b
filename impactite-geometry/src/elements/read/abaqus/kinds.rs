//! Abaqus element types. After the Abaqus Elements Guide and the CalculiX CrunchiX manual: the first nodes of a second-order element are
//! its corners.

use super::super::builder::Form;
use crate::elements::ElementKind::{Bar2, Hexa8, Quad4, Tetra4, Triangle3};

/// Stem of an element type, its form and number of nodes.
type Stem = (&'static str, Form, usize);

/// Letters after a stem that change integration, interpolation or fields, but not the form.
const SUFFIXES: &str = "RIMHTPES";

const STEMS: [Stem; 43] = [
    ("C3D4", Form::Whole(Tetra4), 4),
    ("C3D5", Form::Pyramid, 5),
    ("C3D6", Form::Wedge, 6),
    ("C3D8", Form::Whole(Hexa8), 8),
    ("C3D10", Form::Whole(Tetra4), 10),
    ("C3D15", Form::Wedge, 15),
    ("C3D20", Form::Whole(Hexa8), 20),
    ("CPS3", Form::Whole(Triangle3), 3),
    ("CPS4", Form::Whole(Quad4), 4),
    ("CPS6", Form::Whole(Triangle3), 6),
    ("CPS8", Form::Whole(Quad4), 8),
    ("CPE3", Form::Whole(Triangle3), 3),
    ("CPE4", Form::Whole(Quad4), 4),
    ("CPE6", Form::Whole(Triangle3), 6),
    ("CPE8", Form::Whole(Quad4), 8),
    ("CAX3", Form::Whole(Triangle3), 3),
    ("CAX4", Form::Whole(Quad4), 4),
    ("CAX6", Form::Whole(Triangle3), 6),
    ("CAX8", Form::Whole(Quad4), 8),
    ("S3", Form::Whole(Triangle3), 3),
    ("S4", Form::Whole(Quad4), 4),
    ("S4R5", Form::Whole(Quad4), 4),
    ("S4RSW", Form::Whole(Quad4), 4),
    ("S6", Form::Whole(Triangle3), 6),
    ("S8", Form::Whole(Quad4), 8),
    ("S8R5", Form::Whole(Quad4), 8),
    ("STRI3", Form::Whole(Triangle3), 3),
    ("STRI65", Form::Whole(Triangle3), 6),
    ("M3D3", Form::Whole(Triangle3), 3),
    ("M3D4", Form::Whole(Quad4), 4),
    ("M3D6", Form::Whole(Triangle3), 6),
    ("M3D8", Form::Whole(Quad4), 8),
    ("SFM3D3", Form::Whole(Triangle3), 3),
    ("SFM3D4", Form::Whole(Quad4), 4),
    ("SFM3D6", Form::Whole(Triangle3), 6),
    ("SFM3D8", Form::Whole(Quad4), 8),
    ("R3D3", Form::Whole(Triangle3), 3),
    ("R3D4", Form::Whole(Quad4), 4),
    ("T2D2", Form::Whole(Bar2), 2),
    ("T3D2", Form::Whole(Bar2), 2),
    ("B21", Form::Whole(Bar2), 2),
    ("B31", Form::Whole(Bar2), 2),
    ("B31OS", Form::Whole(Bar2), 2),
];

/// Number of nodes of an element in its data line.
#[derive(Clone, Copy)]
pub struct Listed {
    pub form: Form,
    pub nodes: usize,
    /// An additional node for the orientation of a beam is allowed.
    pub orientation: bool,
}

/// Return the form and number of nodes of an element type.
pub fn of_type(name: &str) -> Option<Listed> {
    let is = |stem: &str| {
        let suffix = name.strip_prefix(stem);
        suffix.is_some_and(|suffix| suffix.chars().all(|letter| SUFFIXES.contains(letter)))
    };
    let &(stem, form, nodes) = STEMS.iter().find(|(stem, ..)| is(stem))?;
    Some(Listed { form, nodes, orientation: stem.starts_with('B') })
}

/// List the supported types, in words.
pub fn known() -> String {
    let stems: Vec<&str> = STEMS.iter().map(|(stem, ..)| *stem).collect();
    format!("one of {}, also with letters as R, I, M, H or T after it", stems.join(", "))
}
