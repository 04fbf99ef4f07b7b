//! Reader of Gmsh files of versions 2 to 4. After the manual, <https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format>.

use std::collections::{BTreeMap, HashMap};

use super::builder::{Builder, Elements, Form};
use crate::cursor::{Cursor, Encoding, ReadError, shown};
use crate::elements::ElementKind;

/// Entity: dimension and tag.
type Entity = (i32, i32);

/// Elements of one entity and form.
struct Group {
    entity: Entity,
    /// Form of the elements; `None` for points.
    form: Option<Form>,
    nodes: Vec<u32>,
}

#[derive(Default)]
struct File {
    version: Version,
    names: HashMap<Entity, String>,
    /// Physical groups of each entity.
    physical: BTreeMap<Entity, Vec<i32>>,
    has_entities: bool,
    builder: Option<Builder>,
    groups: Option<Vec<Group>>,
}

/// Return the form and number of nodes of an element type by its Gmsh number; corners come first. Of second-order elements the
/// corners only are read. The form is `None` for points.
fn form(number: i32) -> Option<(Option<Form>, usize)> {
    let (form, nodes) = match number {
        1 => (Form::Whole(ElementKind::Bar2), 2),
        2 => (Form::Whole(ElementKind::Triangle3), 3),
        3 => (Form::Whole(ElementKind::Quad4), 4),
        4 => (Form::Whole(ElementKind::Tetra4), 4),
        5 => (Form::Whole(ElementKind::Hexa8), 8),
        6 => (Form::Wedge, 6),
        7 => (Form::Pyramid, 5),
        8 => (Form::Whole(ElementKind::Bar2), 3),
        9 => (Form::Whole(ElementKind::Triangle3), 6),
        10 => (Form::Whole(ElementKind::Quad4), 9),
        11 => (Form::Whole(ElementKind::Tetra4), 10),
        12 => (Form::Whole(ElementKind::Hexa8), 27),
        13 => (Form::Wedge, 18),
        14 => (Form::Pyramid, 14),
        15 => return Some((None, 1)),
        16 => (Form::Whole(ElementKind::Quad4), 8),
        17 => (Form::Whole(ElementKind::Hexa8), 20),
        18 => (Form::Wedge, 15),
        19 => (Form::Pyramid, 13),
        _ => return None,
    };
    Some((Some(form), nodes))
}

const FORMS: &str = "points, lines, triangles, quadrilaterals, tetrahedra, bricks, prisms and pyramids of first or second order (1 to 19)";

/// Format version of the sections.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Version {
    /// 2.0 to 2.2: nodes and elements one by one, with the tags of their groups.
    Two,
    /// 4.0: blocks of entities, the tag of a node before its coordinates.
    Four,
    /// 4.1: blocks of entities, tags first.
    #[default]
    FourOne,
}

pub(super) fn read(bytes: &[u8]) -> Result<Builder, ReadError> {
    let mut cursor = Cursor::new(bytes);
    let mut file = File { version: header(&mut cursor)?, ..File::default() };
    while !cursor.is_done() {
        file.section(&mut cursor)?;
    }
    file.finish()
}

/// Parse the section `$MeshFormat`: version and encoding of the other sections.
fn header(cursor: &mut Cursor) -> Result<Version, ReadError> {
    expect(cursor, "$MeshFormat")?;
    let (at, version) = cursor.word("the version")?;
    let version = match version {
        b"2" | b"2.0" | b"2.1" | b"2.2" => Version::Two,
        b"4" | b"4.0" => Version::Four,
        b"4.1" => Version::FourOne,
        _ => {
            let allowed = "2.0 to 2.2, 4.0 or 4.1 (Gmsh: Mesh.MshFileVersion = 4.1)";
            return Err(cursor.refuse(at, "version", shown(version), allowed));
        }
    };
    let (at, coding) = cursor.word("the file type")?;
    let binary = match coding {
        b"0" => false,
        b"1" => true,
        _ => return Err(cursor.refuse(at, "file type", shown(coding), "0 (ASCII) or 1 (binary)")),
    };
    let (at, size) = cursor.word("the data size")?;
    let long = match size {
        b"8" => true,
        b"4" => false,
        _ => return Err(cursor.refuse(at, "data size", shown(size), "4 or 8")),
    };
    if binary {
        cursor.line();
        let at = cursor.at();
        cursor.encoding = Encoding::Binary { big_endian: false, long };
        let one = cursor.int("the number 1 that tells the order of bytes")?;
        if one != 1 && one.swap_bytes() != 1 {
            return Err(cursor.refuse(at, "number that tells the order of bytes", one, "1"));
        }
        cursor.encoding = Encoding::Binary { big_endian: one != 1, long };
    }
    expect(cursor, "$EndMeshFormat")?;
    Ok(version)
}

/// Read a word and require that it is `word`.
fn expect(cursor: &mut Cursor, word: &str) -> Result<(), ReadError> {
    let (at, found) = cursor.word(word)?;
    if found == word.as_bytes() { Ok(()) } else { Err(cursor.refuse(at, "word", shown(found), word)) }
}

impl File {
    fn section(&mut self, cursor: &mut Cursor) -> Result<(), ReadError> {
        let (at, word) = cursor.word("a section")?;
        let again = |cursor: &Cursor| Err(cursor.refuse(at, "section", shown(word), "each section once"));
        cursor.line();
        match word {
            b"$PhysicalNames" => self.names(cursor),
            b"$Entities" if self.has_entities => again(cursor),
            b"$Entities" => self.entities(cursor),
            b"$Nodes" if self.builder.is_some() => again(cursor),
            b"$Nodes" => {
                self.builder = Some(match self.version {
                    Version::Two => plain_nodes(cursor)?,
                    version => nodes(cursor, version)?,
                });
                Ok(())
            }
            b"$Elements" if self.groups.is_some() => again(cursor),
            b"$Elements" => match &self.builder {
                Some(builder) => {
                    let groups = match self.version {
                        Version::Two => plain_elements(cursor, builder)?,
                        version => elements(cursor, builder, version)?,
                    };
                    if self.version == Version::Two {
                        // In version 2, entities are physical groups.
                        let physical = groups.iter().map(|g| g.entity).filter(|entity| entity.1 != 0);
                        self.physical.extend(physical.map(|entity| (entity, vec![entity.1])));
                    }
                    self.groups = Some(groups);
                    Ok(())
                }
                None => Err(cursor.refuse(at, "section", shown(word), "$Nodes before it")),
            },
            b"$PartitionedEntities" => {
                Err(cursor.refuse(at, "section", shown(word), "a mesh that is not partitioned"))
            }
            [b'$', name @ ..] if !name.starts_with(b"End") && !name.is_empty() => {
                cursor.skip_past(&[b"$End", name].concat())
            }
            _ => Err(cursor.refuse(at, "section", shown(word), "a word of the form $Nodes")),
        }
    }

    /// Read the names of physical groups, which are text in binary files too.
    fn names(&mut self, cursor: &mut Cursor) -> Result<(), ReadError> {
        let encoding = std::mem::replace(&mut cursor.encoding, Encoding::Text);
        let count = cursor.size("the number of physical names")?;
        for _ in 0..count {
            let dimension = cursor.int("the dimension of a physical group")?;
            let tag = cursor.int("the tag of a physical group")?;
            let at = cursor.at();
            let line = cursor.line();
            let name = line.strip_prefix(b"\"").and_then(|l| l.strip_suffix(b"\""));
            let name = name.filter(|n| !n.is_empty() && !n.contains(&b'"'));
            let Some(name) = name.and_then(|n| std::str::from_utf8(n).ok()) else {
                return Err(cursor.refuse(at, "physical name", shown(line), "a name in double quotes"));
            };
            if self.names.insert((dimension, tag), name.into()).is_some() {
                return Err(cursor.refuse(at, "physical group", tag, "each group once"));
            }
        }
        expect(cursor, "$EndPhysicalNames")?;
        cursor.encoding = encoding;
        Ok(())
    }

    fn entities(&mut self, cursor: &mut Cursor) -> Result<(), ReadError> {
        self.has_entities = true;
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = cursor.size("the number of entities")?;
        }
        for (dimension, count) in (0..).zip(counts) {
            for _ in 0..count {
                let tag = cursor.int("the tag of an entity")?;
                let numbers = if dimension == 0 && self.version == Version::FourOne { 3 } else { 6 };
                for _ in 0..numbers {
                    cursor.double("a bound of an entity")?;
                }
                let mut groups = Vec::new();
                for _ in 0..cursor.size("the number of physical groups of an entity")? {
                    groups.push(cursor.int("the tag of a physical group")?.saturating_abs());
                }
                if dimension > 0 {
                    for _ in 0..cursor.size("the number of bounding entities")? {
                        cursor.int("the tag of a bounding entity")?;
                    }
                }
                self.physical.insert((dimension, tag), groups);
            }
        }
        expect(cursor, "$EndEntities")
    }

    fn name(&self, (dimension, tag): Entity) -> String {
        self.names.get(&(dimension, tag)).cloned().unwrap_or_else(|| format!("physical {tag}"))
    }

    fn finish(self) -> Result<Builder, ReadError> {
        let missing = |section: &str| ReadError::Whole {
            what: format!("there is no section {section}"),
            allowed: "a file with $MeshFormat, $Nodes and $Elements",
        };
        let mut builder = self.builder.ok_or_else(|| missing("$Nodes"))?;
        let groups = self.groups.as_ref().ok_or_else(|| missing("$Elements"))?;
        let dimension = |g: &Group| g.form.map_or(0, Form::dimensions);
        let highest = groups.iter().map(dimension).max().unwrap_or(0);
        // Builder and groups are moved out to allow lookup of names while the builder changes.
        let file = File { builder: None, groups: None, ..self };
        // Version 2 repeats an element for every physical group that contains it.
        let repeats = file.version == Version::Two;
        let mut known: HashMap<(Form, &[u32]), Elements> = HashMap::new();
        for group in self.groups.iter().flatten() {
            let physical = file.physical.get(&group.entity).map(Vec::as_slice).unwrap_or_default();
            let names: Vec<String> = physical.iter().map(|&tag| file.name((group.entity.0, tag))).collect();
            for name in &names {
                builder.add_to_node_set(name, group.nodes.iter().copied());
            }
            let Some(form) = group.form.filter(|form| form.dimensions() == highest) else { continue };
            let block = names.first().map_or("", String::as_str);
            for nodes in group.nodes.chunks_exact(form.corners()) {
                let elements = match known.get(&(form, nodes)) {
                    Some(&elements) => elements,
                    None => builder.add_element(block, form, nodes)?,
                };
                if repeats {
                    known.insert((form, nodes), elements);
                }
                names.iter().for_each(|name| builder.add_to_element_set(name, elements));
            }
        }
        Ok(builder)
    }
}

/// Check that a declared total equals the sum of the blocks.
fn check_total(cursor: &Cursor, at: usize, key: &str, said: u64, found: u64) -> Result<(), ReadError> {
    if said == found {
        Ok(())
    } else {
        Err(cursor.refuse(at, key, said, format!("{found}, as the blocks have")))
    }
}

/// Read nodes one by one, format version 2.
fn plain_nodes(cursor: &mut Cursor) -> Result<Builder, ReadError> {
    let mut builder = Builder::default();
    for _ in 0..plain_count(cursor, "the number of nodes")? {
        cursor.skip_text_blanks();
        let at = cursor.at();
        let tag = cursor.int("the tag of a node")?;
        let mut x = [0.0; 3];
        for c in &mut x {
            *c = cursor.double("a coordinate of a node")?;
        }
        if tag < 1 || !builder.add_node(tag as u64, x) {
            return Err(cursor.refuse(at, "tag of a node", tag, "1 or more, each tag once"));
        }
    }
    expect(cursor, "$EndNodes")?;
    Ok(builder)
}

/// Read a count of format version 2, which is a line of text in binary files too.
fn plain_count(cursor: &mut Cursor, key: &str) -> Result<u64, ReadError> {
    let encoding = std::mem::replace(&mut cursor.encoding, Encoding::Text);
    let count = cursor.size(key)?;
    if encoding != Encoding::Text {
        cursor.line();
    }
    cursor.encoding = encoding;
    Ok(count)
}

/// Read elements one by one, format version 2, and sort them by physical group.
fn plain_elements(cursor: &mut Cursor, builder: &Builder) -> Result<Vec<Group>, ReadError> {
    let count = plain_count(cursor, "the number of elements")?;
    let text = cursor.encoding == Encoding::Text;
    let (mut groups, mut found): (Vec<Group>, u64) = (Vec::new(), 0);
    while found < count {
        if text {
            cursor.int("the number of an element")?;
        }
        cursor.skip_text_blanks();
        let at = cursor.at();
        let number = cursor.int("the type of an element")?;
        let (form, own) =
            form(number).ok_or_else(|| cursor.refuse(at, "type of an element", number, FORMS))?;
        // In binary files, a header with the element type precedes several elements.
        let following = if text { 1 } else { cursor.int("the number of elements of a type")? };
        cursor.skip_text_blanks();
        let at = cursor.at();
        let tags = cursor.int("the number of tags of an element")?;
        if following < 1 || tags < 0 || found + following as u64 > count {
            return Err(cursor.refuse(at, "number of elements or tags", tags, "as many as the section has"));
        }
        for _ in 0..following {
            if !text {
                cursor.int("the number of an element")?;
            }
            let mut physical = 0;
            for n in 0..tags {
                let tag = cursor.int("a tag of an element")?;
                physical = if n == 0 { tag.saturating_abs() } else { physical };
            }
            let entity = (form.map_or(0, |f| f.dimensions() as i32), physical);
            let corners = corners(cursor, builder, (form, own), int_tag)?;
            match groups.last_mut().filter(|g| (g.entity, g.form) == (entity, form)) {
                Some(group) => group.nodes.extend(corners),
                None => groups.push(Group { entity, form, nodes: corners }),
            }
            found += 1;
        }
    }
    expect(cursor, "$EndElements")?;
    Ok(groups)
}

/// Read a tag of type `int`, format versions 2 and 4.0.
fn int_tag(cursor: &mut Cursor, key: &str) -> Result<u64, ReadError> {
    // Tags are not negative; 0 is no node.
    Ok(cursor.int(key)?.max(0) as u64)
}

/// Read a tag of type `size_t`, format version 4.1.
fn size_tag(cursor: &mut Cursor, key: &str) -> Result<u64, ReadError> {
    cursor.size(key)
}

/// Read the nodes of an element and return its corners.
fn corners(
    cursor: &mut Cursor,
    builder: &Builder,
    (form, own): (Option<Form>, usize),
    tag_of: fn(&mut Cursor, &str) -> Result<u64, ReadError>,
) -> Result<Vec<u32>, ReadError> {
    let mut corners = Vec::with_capacity(own);
    for _ in 0..own {
        cursor.skip_text_blanks();
        let at = cursor.at();
        let tag = tag_of(cursor, "a node of an element")?;
        corners.push(builder.node(tag).ok_or_else(|| {
            cursor.refuse(at, "node of an element", tag, "the tag of a node of the section $Nodes")
        })?);
    }
    corners.truncate(form.map_or(1, Form::corners));
    Ok(corners)
}

/// Read nodes in blocks, format version 4.
fn nodes(cursor: &mut Cursor, version: Version) -> Result<Builder, ReadError> {
    let beside = version == Version::Four;
    let read_tag = if beside { int_tag } else { size_tag };
    let mut builder = Builder::default();
    cursor.skip_text_blanks();
    let start = cursor.at();
    let blocks = cursor.size("the number of blocks of nodes")?;
    let total = cursor.size("the number of nodes")?;
    if !beside {
        cursor.size("the smallest tag of a node")?;
        cursor.size("the largest tag of a node")?;
    }
    for _ in 0..blocks {
        cursor.skip_text_blanks();
        let at = cursor.at();
        let (dimension, _) = entity(cursor, version)?;
        if !(0..=3).contains(&dimension) {
            return Err(cursor.refuse(at, "dimension of an entity", dimension, "0 to 3"));
        }
        let at = cursor.at();
        let parametric = cursor.int("whether nodes have parameters")?;
        if !(0..=1).contains(&parametric) {
            return Err(cursor.refuse(at, "whether nodes have parameters", parametric, "0 or 1"));
        }
        let count = cursor.size("the number of nodes of a block")?;
        let tag_of = |cursor: &mut Cursor| {
            cursor.skip_text_blanks();
            let at = cursor.at();
            let tag = read_tag(cursor, "the tag of a node")?;
            if tag == 0 {
                return Err(cursor.refuse(at, "tag of a node", tag, "1 or more"));
            }
            Ok((at, tag))
        };
        let mut tags = Vec::new();
        for _ in 0..if beside { 0 } else { count } {
            tags.push(tag_of(cursor)?);
        }
        for n in 0..count {
            let (at, tag) = if beside { tag_of(cursor)? } else { tags[n as usize] };
            let mut x = [0.0; 3];
            for c in &mut x {
                *c = cursor.double("a coordinate of a node")?;
            }
            for _ in 0..parametric * dimension {
                cursor.double("a parameter of a node")?;
            }
            if !builder.add_node(tag, x) {
                return Err(cursor.refuse(
                    at,
                    "tag of a node",
                    tag,
                    "each tag once, at most 4294967294 nodes",
                ));
            }
        }
    }
    check_total(cursor, start, "number of blocks and nodes", total, builder.node_count() as u64)?;
    expect(cursor, "$EndNodes")?;
    Ok(builder)
}

/// Read dimension and tag of an entity; version 4.0 stores the tag first.
fn entity(cursor: &mut Cursor, version: Version) -> Result<Entity, ReadError> {
    let (dimension, tag) = ("the dimension of an entity", "the tag of an entity");
    if version == Version::Four {
        let tag = cursor.int(tag)?;
        return Ok((cursor.int(dimension)?, tag));
    }
    Ok((cursor.int(dimension)?, cursor.int(tag)?))
}

/// Read elements in blocks, format version 4.
fn elements(cursor: &mut Cursor, builder: &Builder, version: Version) -> Result<Vec<Group>, ReadError> {
    let tag_of = if version == Version::Four { int_tag } else { size_tag };
    let mut groups = Vec::new();
    cursor.skip_text_blanks();
    let start = cursor.at();
    let blocks = cursor.size("the number of blocks of elements")?;
    let total = cursor.size("the number of elements")?;
    if version == Version::FourOne {
        cursor.size("the smallest tag of an element")?;
        cursor.size("the largest tag of an element")?;
    }
    let mut found = 0u64;
    for _ in 0..blocks {
        let entity = entity(cursor, version)?;
        cursor.skip_text_blanks();
        let at = cursor.at();
        let number = cursor.int("the type of elements")?;
        let (form, own) = form(number).ok_or_else(|| cursor.refuse(at, "type of elements", number, FORMS))?;
        if form.map_or(0, |f| f.dimensions() as i32) != entity.0 {
            let allowed = format!("one of {} dimensions, as its entity", entity.0);
            return Err(cursor.refuse(at, "type of elements", number, allowed));
        }
        let count = cursor.size("the number of elements of a block")?;
        let mut nodes = Vec::new();
        for _ in 0..count {
            tag_of(cursor, "the tag of an element")?;
            nodes.extend(corners(cursor, builder, (form, own), tag_of)?);
        }
        found += count;
        groups.push(Group { entity, form, nodes });
    }
    check_total(cursor, start, "number of blocks and elements", total, found)?;
    expect(cursor, "$EndElements")?;
    Ok(groups)
}
