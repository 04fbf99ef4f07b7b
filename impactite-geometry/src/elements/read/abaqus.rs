//! Abaqus input files. After the Abaqus Keywords Reference Manual: *NODE, *ELEMENT, *NSET, *ELSET.

use std::collections::HashMap;

use super::builder::Builder;
use super::cursor::{Cursor, Place, ReadError, shown};
use crate::elements::ElementKind;

const KINDS: [(&str, ElementKind); 12] = [
    ("C3D8", ElementKind::Hexa8),
    ("C3D8R", ElementKind::Hexa8),
    ("C3D4", ElementKind::Tetra4),
    ("CPE4", ElementKind::Quad4),
    ("CPE4R", ElementKind::Quad4),
    ("CAX4", ElementKind::Quad4),
    ("CAX4R", ElementKind::Quad4),
    ("CPE3", ElementKind::Triangle3),
    ("CAX3", ElementKind::Triangle3),
    ("T2D2", ElementKind::Bar2),
    ("T3D2", ElementKind::Bar2),
    ("B31", ElementKind::Bar2),
];

/// Keywords that would make a mesh other than the one that is read.
const REFUSED: [&str; 9] =
    ["NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "INCLUDE", "SUBSTRUCTURE GENERATE"];

/// A keyword with its parameters, names in capitals.
struct Keyword {
    line: usize,
    name: String,
    parameters: Vec<(String, Option<String>)>,
}

/// A comma-separated value, with its line.
type Field<'a> = (usize, &'a str);

fn refuse(line: usize, key: &str, found: impl ToString, allowed: impl ToString) -> ReadError {
    let place = Place::Line(line);
    ReadError::Found { place, key: key.into(), found: found.to_string(), allowed: allowed.to_string() }
}

impl Keyword {
    fn parse(line: usize, text: &str) -> Result<Self, ReadError> {
        let mut parts = text.trim_start_matches('*').split(',').map(str::trim);
        let upper = |s: &str| s.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
        let name = upper(parts.next().unwrap_or_default());
        let parameters = parts.filter(|p| !p.is_empty()).map(|p| match p.split_once('=') {
            Some((key, value)) => (upper(key), Some(value.trim().trim_matches('"').to_string())),
            None => (upper(p), None),
        });
        let keyword = Self { line, parameters: parameters.collect(), name };
        if keyword.name.is_empty() {
            return Err(refuse(line, "keyword", text, "a name after the star"));
        }
        Ok(keyword)
    }
    /// Refuses parameters other than these.
    fn allow(&self, allowed: &[&str]) -> Result<(), ReadError> {
        match self.parameters.iter().find(|(key, _)| !allowed.contains(&key.as_str())) {
            Some((key, _)) => {
                let what = format!("parameter of *{}", self.name);
                Err(refuse(self.line, &what, key, format!("one of {}", allowed.join(", "))))
            }
            None => Ok(()),
        }
    }
    fn get(&self, key: &str) -> Option<&str> {
        self.parameters.iter().find(|(k, _)| k == key)?.1.as_deref().filter(|v| !v.is_empty())
    }
    fn has(&self, key: &str) -> bool {
        self.parameters.iter().any(|(k, _)| k == key)
    }
    fn need(&self, key: &str) -> Result<&str, ReadError> {
        let missing = || refuse(self.line, &format!("*{}", self.name), "", format!("a parameter {key}=..."));
        self.get(key).ok_or_else(missing)
    }
}

struct Element {
    kind: ElementKind,
    nodes: Vec<u32>,
    /// The set of its *ELEMENT line.
    set: Option<usize>,
}

/// Named sets of tags in the order in which they are first named.
#[derive(Default)]
struct Sets {
    names: Vec<String>,
    members: Vec<Vec<u64>>,
    place: HashMap<String, usize>,
}

impl Sets {
    fn of(&mut self, name: &str) -> usize {
        let next = self.names.len();
        let place = *self.place.entry(name.to_ascii_uppercase()).or_insert(next);
        if place == next {
            self.names.push(name.into());
            self.members.push(Vec::new());
        }
        place
    }
    fn find(&self, name: &str) -> Option<usize> {
        self.place.get(&name.to_ascii_uppercase()).copied()
    }
}

#[derive(Default)]
struct File {
    builder: Builder,
    elements: Vec<Element>,
    element: HashMap<u64, usize>,
    node_sets: Sets,
    element_sets: Sets,
    parts: usize,
    instances: usize,
}

pub(super) fn read(bytes: &[u8]) -> Result<Builder, ReadError> {
    let mut lines = Vec::new();
    let mut cursor = Cursor::new(bytes);
    let mut number = 0;
    while cursor.at() < bytes.len() {
        number += 1;
        let line = cursor.line();
        let text = std::str::from_utf8(line).ok().filter(|text| !text.contains('\0'));
        let text = text.ok_or_else(|| refuse(number, "line", shown(line), "text"))?;
        if !text.is_empty() && !text.starts_with("**") {
            lines.push((number, text));
        }
    }
    let mut file = File::default();
    let mut rest = lines.as_slice();
    if let Some((line, text)) = rest.first().filter(|(_, text)| !text.starts_with('*')) {
        return Err(refuse(*line, "first line", shown(text.as_bytes()), "a keyword, as *HEADING or *NODE"));
    }
    while let Some(((line, text), mut after)) = rest.split_first() {
        // A keyword line that ends with a comma goes on.
        let mut text = text.to_string();
        while let (true, Some(((_, next), further))) = (text.ends_with(','), after.split_first()) {
            text.push_str(next);
            after = further;
        }
        let data = after.iter().position(|(_, text)| text.starts_with('*')).unwrap_or(after.len());
        let (data, further) = after.split_at(data);
        file.keyword(&Keyword::parse(*line, &text)?, data)?;
        rest = further;
    }
    file.finish()
}

/// A number of a field.
fn number<T: std::str::FromStr>((line, text): Field, key: &str, allowed: &str) -> Result<T, ReadError> {
    text.parse().map_err(|_| refuse(line, key, shown(text.as_bytes()), allowed))
}

const TAG: &str = "a whole number from 0 to 2^64 - 1";

fn fields<'a>(line: &(usize, &'a str)) -> impl Iterator<Item = Field<'a>> + use<'a> {
    let (number, text) = *line;
    let text = text.strip_suffix(',').unwrap_or(text);
    text.split(',').map(move |field| (number, field.trim()))
}

impl File {
    fn keyword(&mut self, keyword: &Keyword, data: &[(usize, &str)]) -> Result<(), ReadError> {
        let name = keyword.name.as_str();
        match name {
            "NODE" => self.nodes(keyword, data),
            "ELEMENT" => self.read_elements(keyword, data),
            "NSET" | "ELSET" => self.set(keyword, data),
            "PART" => {
                self.parts += 1;
                self.once(keyword, self.parts, "one part; write each part to a file, and join their meshes")
            }
            "INSTANCE" => {
                self.instances += 1;
                if let Some((line, text)) = data.first() {
                    let allowed = "no data: an instance that is neither moved nor rotated";
                    return Err(refuse(*line, "data of *INSTANCE", text, allowed));
                }
                self.once(keyword, self.instances, "one instance")
            }
            _ if REFUSED.contains(&name) => {
                let allowed = "nodes and elements that are written out";
                Err(refuse(keyword.line, "keyword", format!("*{name}"), allowed))
            }
            _ => Ok(()),
        }
    }

    fn once(&self, keyword: &Keyword, count: usize, allowed: &str) -> Result<(), ReadError> {
        if count == 1 {
            return Ok(());
        }
        Err(refuse(keyword.line, "keyword", format!("*{}", keyword.name), allowed))
    }

    fn nodes(&mut self, keyword: &Keyword, data: &[(usize, &str)]) -> Result<(), ReadError> {
        keyword.allow(&["NSET"])?;
        let set = keyword.get("NSET").map(|name| self.node_sets.of(name));
        for line in data {
            let mut values = fields(line);
            let tag = number(values.next().unwrap_or((line.0, "")), "node number", TAG)?;
            let mut x = [0.0; 3];
            let mut count = 0;
            for field in values {
                // Fortran writes 1.0D-3 as well.
                let text = field.1.replace(['d', 'D'], "e");
                let coordinate = match text.as_str() {
                    "" => Ok(0.0),
                    text => number((field.0, text), "coordinate", "a finite number"),
                };
                let coordinate: f64 = coordinate?;
                if !coordinate.is_finite() {
                    return Err(refuse(field.0, "coordinate", field.1, "a finite number"));
                }
                // Direction cosines of a normal may follow.
                if count < 3 {
                    x[count] = coordinate;
                }
                count += 1;
            }
            if !(1..=6).contains(&count) {
                return Err(refuse(line.0, "number of coordinates", count, "1 to 3, and those of a normal"));
            }
            if !self.builder.add_node(tag, x) {
                return Err(refuse(line.0, "node number", tag, "each number once"));
            }
            if let Some(set) = set {
                self.node_sets.members[set].push(tag);
            }
        }
        Ok(())
    }

    fn read_elements(&mut self, keyword: &Keyword, data: &[(usize, &str)]) -> Result<(), ReadError> {
        keyword.allow(&["TYPE", "ELSET"])?;
        let name = keyword.need("TYPE")?.to_ascii_uppercase();
        let Some(&(_, kind)) = KINDS.iter().find(|(known, _)| *known == name) else {
            let allowed = KINDS.map(|(name, _)| name).join(", ");
            return Err(refuse(keyword.line, "TYPE of *ELEMENT", name, format!("one of {allowed}")));
        };
        let set = keyword.get("ELSET").map(|name| self.element_sets.of(name));
        // An element may go on in the next line.
        let mut values = data.iter().flat_map(fields).peekable();
        while let Some(first) = values.next() {
            let tag: u64 = number(first, "element number", TAG)?;
            let mut nodes = Vec::with_capacity(kind.nodes());
            let mut line = first.0;
            for _ in 0..kind.nodes() {
                let field = values.next().ok_or_else(|| ReadError::End {
                    place: Place::Line(data.last().map_or(keyword.line, |l| l.0)),
                    expected: format!("node {} of element {tag} ({name})", nodes.len() + 1),
                })?;
                line = field.0;
                let node: u64 = number(field, "node of an element", TAG)?;
                let found = self.builder.node(node);
                nodes.push(found.ok_or_else(|| {
                    refuse(field.0, "node of an element", node, "the number of a node of *NODE before it")
                })?);
            }
            let last = values.peek().filter(|next| next.0 == line);
            if let Some((line, text)) = last {
                let allowed = format!("the {} nodes of a {name}", kind.nodes());
                return Err(refuse(*line, &format!("nodes of element {tag}"), text, allowed));
            }
            if self.element.insert(tag, self.elements.len()).is_some() {
                return Err(refuse(first.0, "element number", tag, "each number once"));
            }
            self.elements.push(Element { kind, nodes, set });
            if let Some(set) = set {
                self.element_sets.members[set].push(tag);
            }
        }
        Ok(())
    }

    fn set(&mut self, keyword: &Keyword, data: &[(usize, &str)]) -> Result<(), ReadError> {
        keyword.allow(&[&keyword.name, "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED"])?;
        let name = keyword.need(&keyword.name)?;
        let mut members = Vec::new();
        for line in data {
            if keyword.has("GENERATE") {
                self.generate(keyword, line, &mut members)?;
            } else {
                for field in fields(line).filter(|f| !f.1.is_empty()) {
                    self.member(keyword, field, &mut members)?;
                }
            }
        }
        let sets = if keyword.name == "NSET" { &mut self.node_sets } else { &mut self.element_sets };
        let place = sets.of(name);
        let set = &mut sets.members[place];
        set.extend(members);
        // Sets of sets would grow without bound.
        set.sort_unstable();
        set.dedup();
        Ok(())
    }

    fn exists(&self, keyword: &Keyword, tag: u64) -> bool {
        if keyword.name == "NSET" {
            self.builder.node(tag).is_some()
        } else {
            self.element.contains_key(&tag)
        }
    }

    /// First, last and increment. As in Abaqus, numbers between that do not exist are passed over; the first and the last must.
    fn generate(
        &self,
        keyword: &Keyword,
        line: &(usize, &str),
        members: &mut Vec<u64>,
    ) -> Result<(), ReadError> {
        let values = fields(line).map(|f| number(f, "GENERATE", TAG)).collect::<Result<Vec<u64>, _>>()?;
        let (first, last, step) = match values[..] {
            [first, last] => (first, last, 1),
            [first, last, step] => (first, last, step),
            _ => {
                let allowed = "the first number, the last one, and an increment";
                return Err(refuse(line.0, "GENERATE", line.1, allowed));
            }
        };
        if step == 0 || first > last {
            let allowed = "first <= last, and an increment of at least 1";
            return Err(refuse(line.0, "GENERATE", line.1, allowed));
        }
        for end in [first, last] {
            if !self.exists(keyword, end) {
                return Err(refuse(line.0, "GENERATE", end, "a number that was defined before"));
            }
        }
        // Whichever are fewer: numbers between, or numbers that exist.
        let count = (last - first) / step;
        if count < (self.builder.node_count() + self.elements.len()) as u64 {
            members.extend((0..=count).map(|i| first + i * step).filter(|&tag| self.exists(keyword, tag)));
        } else {
            let within = |tag: &u64| (first..=last).contains(tag) && (tag - first).is_multiple_of(step);
            match keyword.name.as_str() {
                "NSET" => members.extend(self.builder.tags().iter().copied().filter(within)),
                _ => members.extend(self.element.keys().copied().filter(within)),
            }
        }
        Ok(())
    }

    /// A number, or the name of a set before.
    fn member(&self, keyword: &Keyword, field: Field, members: &mut Vec<u64>) -> Result<(), ReadError> {
        let sets = if keyword.name == "NSET" { &self.node_sets } else { &self.element_sets };
        match field.1.parse() {
            Ok(tag) if self.exists(keyword, tag) => members.push(tag),
            _ => match sets.find(field.1.trim_matches('"')) {
                Some(set) => members.extend_from_slice(&sets.members[set]),
                None => {
                    let key = format!("member of *{}", keyword.name);
                    let allowed = "a number or a set that was defined before";
                    return Err(refuse(field.0, &key, shown(field.1.as_bytes()), allowed));
                }
            },
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Builder, ReadError> {
        let number = |element: &HashMap<u64, usize>, tag: &u64| element.get(tag).copied();
        // Elements read without a set belong to the first that has them.
        for (set, members) in self.element_sets.members.iter().enumerate() {
            for element in members.iter().filter_map(|tag| number(&self.element, tag)) {
                self.elements[element].set.get_or_insert(set);
            }
        }
        for element in &self.elements {
            let name = element.set.map_or("", |set| self.element_sets.names[set].as_str());
            self.builder.add_element(name, element.kind, &element.nodes);
        }
        for (name, members) in self.node_sets.names.iter().zip(&self.node_sets.members) {
            let nodes: Vec<u32> = members.iter().filter_map(|&tag| self.builder.node(tag)).collect();
            self.builder.add_to_set(name, nodes);
        }
        for (name, members) in self.element_sets.names.iter().zip(&self.element_sets.members) {
            if self.node_sets.find(name).is_none() {
                let elements = members.iter().filter_map(|tag| number(&self.element, tag));
                let nodes: Vec<u32> = elements.flat_map(|e| self.elements[e].nodes.iter().copied()).collect();
                self.builder.add_to_set(name, nodes);
            }
        }
        Ok(self.builder)
    }
}
