//! Faces of elements by their identifiers. After the Abaqus Elements Guide.

use super::super::builder::Form;
use crate::elements::ElementKind::{Bar2, Hexa8, Quad4, Tetra4, Triangle3};

/// Corners of the faces S1, S2, ... of an element, by place among its corners.
fn faces(form: Form) -> &'static [&'static [usize]] {
    match form {
        Form::Whole(Bar2) => &[],
        Form::Whole(Triangle3) => &[&[0, 1], &[1, 2], &[2, 0]],
        Form::Whole(Quad4) => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
        Form::Whole(Tetra4) => &[&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]],
        Form::Whole(Hexa8) => {
            &[&[0, 1, 2, 3], &[4, 7, 6, 5], &[0, 4, 5, 1], &[1, 5, 6, 2], &[2, 6, 7, 3], &[3, 7, 4, 0]]
        }
        Form::Wedge => &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]],
        Form::Pyramid => &[&[0, 1, 2, 3], &[0, 4, 1], &[1, 4, 2], &[2, 4, 3], &[3, 4, 0]],
    }
}

/// Return the corners of a face of an element by its identifier, `S1` or `s1`; `None` if the element has no such face.
pub fn face(form: Form, name: &str) -> Option<&'static [usize]> {
    let number: usize = name.trim().strip_prefix(['S', 's'])?.parse().ok()?;
    faces(form).get(number.checked_sub(1)?).copied()
}
