//! Parts, instances and sets of an Abaqus input file.

use std::collections::HashMap;

use nalgebra::{Point3, Rotation3, Unit, Vector3};

use super::super::builder::Form;
use super::text::{Data, fields, real, refuse};
use crate::cursor::ReadError;
use crate::vector::{add, sub};

/// Maximum number of corners of a form.
pub const MOST_CORNERS: usize = 8;

/// Element of a part, by the indices of its corner nodes in the part.
#[derive(Clone)]
pub struct Element {
    pub form: Form,
    pub corners: [u32; MOST_CORNERS],
    /// Element set of its `*ELEMENT` line.
    pub set: Option<u32>,
}

impl Element {
    pub fn nodes(&self) -> &[u32] {
        &self.corners[..self.form.corners()]
    }
}

/// Reference to a node or an element: owner (0: the part of the set itself; from 1: instance) and index in that owner.
pub type Member = (u32, u32);

/// Named sets in the order of first use; names are compared without regard to case.
#[derive(Clone, Default)]
pub struct Sets {
    pub names: Vec<String>,
    pub members: Vec<Vec<Member>>,
    place: HashMap<String, usize>,
}

impl Sets {
    /// Return the index of a set; add the set if there is none of this name.
    pub fn of(&mut self, name: &str) -> usize {
        let next = self.names.len();
        let place = *self.place.entry(name.to_ascii_uppercase()).or_insert(next);
        if place == next {
            self.names.push(name.into());
            self.members.push(Vec::new());
        }
        place
    }

    pub fn find(&self, name: &str) -> Option<&[Member]> {
        let place = self.place.get(&name.to_ascii_uppercase())?;
        Some(&self.members[*place])
    }
}

/// Type of the members of a set: nodes or elements.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Of {
    Nodes,
    Elements,
}

/// Nodes, elements and sets of a part, of the assembly, or of a file without parts.
#[derive(Clone, Default)]
pub struct Part {
    pub tags: Vec<u64>,
    pub positions: Vec<[f64; 3]>,
    pub elements: Vec<Element>,
    node: HashMap<u64, u32>,
    element: HashMap<u64, u32>,
    pub node_sets: Sets,
    pub element_sets: Sets,
}

impl Part {
    /// Add a node; `false` if the tag exists at another position.
    pub fn add_node(&mut self, tag: u64, x: [f64; 3]) -> bool {
        let next = self.positions.len() as u32;
        let number = *self.node.entry(tag).or_insert(next);
        if number == next {
            self.tags.push(tag);
            self.positions.push(x);
        }
        self.positions[number as usize] == x
    }

    /// Add an element; `false` if the tag exists already.
    pub fn add_element(&mut self, tag: u64, element: Element) -> bool {
        let new = self.element.insert(tag, self.elements.len() as u32).is_none();
        self.elements.push(element);
        new
    }

    pub fn sets(&self, of: Of) -> &Sets {
        match of {
            Of::Nodes => &self.node_sets,
            Of::Elements => &self.element_sets,
        }
    }

    pub fn sets_mut(&mut self, of: Of) -> &mut Sets {
        match of {
            Of::Nodes => &mut self.node_sets,
            Of::Elements => &mut self.element_sets,
        }
    }

    /// Return the index of a node or element by its tag.
    pub fn number(&self, of: Of, tag: u64) -> Option<u32> {
        self.numbers(of).get(&tag).copied()
    }

    fn numbers(&self, of: Of) -> &HashMap<u64, u32> {
        match of {
            Of::Nodes => &self.node,
            Of::Elements => &self.element,
        }
    }

    /// List the existing nodes or elements with tags from `first` to `last` by `step`.
    pub fn between(&self, of: Of, [first, last, step]: [u64; 3]) -> Vec<u32> {
        let numbers = self.numbers(of);
        // Choose the shorter loop: over the tags of the range, or over the existing tags.
        let count = (last - first) / step;
        if count < numbers.len() as u64 {
            return (0..=count).filter_map(|i| self.number(of, first + i * step)).collect();
        }
        let within = |tag: u64| (first..=last).contains(&tag) && (tag - first).is_multiple_of(step);
        numbers.iter().filter(|(tag, _)| within(**tag)).map(|(_, number)| *number).collect()
    }
}

/// Rigid motion of an instance: a translation, then a rotation about an axis.
#[derive(Clone)]
pub struct Motion {
    translation: [f64; 3],
    rotation: Option<([f64; 3], Rotation3<f64>)>,
}

impl Motion {
    /// Identity.
    pub const NONE: Motion = Motion { translation: [0.0; 3], rotation: None };

    /// Parse the data lines of *INSTANCE: a translation; two points of an axis, and an angle in degrees.
    pub fn of(data: &Data) -> Result<Self, ReadError> {
        let mut motion = Motion::NONE;
        let mut lines = data.lines();
        if let Some(line) = lines.next() {
            let values = numbers(line, "translation of *INSTANCE")?;
            if values.len() > 3 {
                let allowed = "three numbers of a translation; a rotation is on the line after it";
                return Err(refuse(line.0, "translation of *INSTANCE", line.1, allowed));
            }
            motion.translation.iter_mut().zip(values).for_each(|(x, value)| *x = value);
        }
        if let Some(line) = lines.next() {
            let key = "rotation of *INSTANCE";
            let wrong = || {
                let allowed = "two different points of the axis, three numbers each, and an angle in degrees";
                refuse(line.0, key, line.1, allowed)
            };
            let [ax, ay, az, bx, by, bz, degrees] =
                numbers(line, key)?.try_into().map_err(|_: Vec<f64>| wrong())?;
            let (start, end) = ([ax, ay, az], [bx, by, bz]);
            let axis = Unit::try_new(Vector3::from(sub(end, start)), 0.0).ok_or_else(wrong)?;
            motion.rotation = Some((start, Rotation3::from_axis_angle(&axis, degrees.to_radians())));
        }
        match lines.next() {
            Some(line) => Err(refuse(line.0, "data of *INSTANCE", line.1, "a translation and a rotation")),
            None => Ok(motion),
        }
    }

    pub fn place(&self, x: [f64; 3]) -> [f64; 3] {
        let moved = add(x, self.translation);
        match &self.rotation {
            Some((pivot, rotation)) => {
                let turned = rotation * Point3::from(sub(moved, *pivot));
                add(*pivot, turned.coords.into())
            }
            None => moved,
        }
    }
}

fn numbers(line: (super::text::At, &str), key: &str) -> Result<Vec<f64>, ReadError> {
    fields(line).map(|field| real(field, key)).collect()
}

/// Instance of a part.
pub struct Instance {
    pub name: String,
    pub part: std::rc::Rc<Part>,
    pub motion: Motion,
}
