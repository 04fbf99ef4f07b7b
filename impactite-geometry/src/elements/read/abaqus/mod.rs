//! Reader of Abaqus input files. After the Abaqus Keywords Reference Guide: *NODE, *ELEMENT, *NSET, *ELSET, *SURFACE, *PART, *INSTANCE,
//! *INCLUDE.

mod kinds;
mod parts;
mod surfaces;
mod text;

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::rc::Rc;

use super::builder::{Builder, MOST};
use crate::cursor::{ReadError, shown};
use parts::{Element, Instance, MOST_CORNERS, Member, Motion, Of, Part, Sets};
use text::{At, Data, Field, Keyword, Text, end, fields, number, real, refuse, unquoted};

/// Unsupported keywords that generate or move nodes and elements.
const REFUSED: [&str; 8] =
    ["NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SUBSTRUCTUREGENERATE"];

/// Read the bytes of a file; `path` is the path of the file, from which included files are located.
pub(super) fn read(bytes: &[u8], path: Option<&Path>) -> Result<Builder, ReadError> {
    let mut text = Text::default();
    let model = text.load(bytes, path).and_then(|()| {
        let mut model = Model::default();
        text.blocks().try_for_each(|(keyword, data)| model.keyword(keyword, &data))?;
        Ok(model)
    });
    model.and_then(Model::finish).map_err(|error| text.named(error))
}

const TAG: &str = "a whole number from 0 to 2^64 - 1";

/// Part or instance that is not closed yet.
struct Open {
    at: At,
    name: String,
    part: Rc<Part>,
    /// Motion of an instance; `None` for a part.
    motion: Option<Motion>,
}

#[derive(Default)]
struct Model {
    /// Nodes, elements and sets outside parts: of the assembly, or of a file without parts.
    root: Part,
    open: Option<Open>,
    /// Parts by name in capitals.
    parts: BTreeMap<String, Rc<Part>>,
    instances: Vec<Instance>,
    /// Instance number, from 1, by name in capitals.
    instance: HashMap<String, u32>,
}

impl Model {
    fn keyword(&mut self, keyword: &Keyword, data: &Data) -> Result<(), ReadError> {
        if keyword.is("NODE") {
            self.nodes(keyword, data)
        } else if keyword.is("ELEMENT") {
            self.elements(keyword, data)
        } else if keyword.is("NSET") {
            self.set(keyword, "NSET", Of::Nodes, data)
        } else if keyword.is("ELSET") {
            self.set(keyword, "ELSET", Of::Elements, data)
        } else if keyword.is("SURFACE") {
            self.surface(keyword, data);
            Ok(())
        } else if keyword.is("PART") {
            self.begin_part(keyword)
        } else if keyword.is("ENDPART") {
            let open = self.close(keyword, "*PART", false)?;
            self.parts.insert(open.name.to_ascii_uppercase(), open.part);
            Ok(())
        } else if keyword.is("INSTANCE") {
            self.begin_instance(keyword, data)
        } else if keyword.is("ENDINSTANCE") {
            let open = self.close(keyword, "*INSTANCE", true)?;
            self.instances.push(Instance {
                name: open.name.clone(),
                part: open.part,
                motion: open.motion.unwrap_or(Motion::NONE),
            });
            self.instance.insert(open.name.to_ascii_uppercase(), self.instances.len() as u32);
            Ok(())
        } else if REFUSED.contains(&keyword.name.as_str()) {
            let allowed = "nodes and elements that are written out";
            Err(refuse(keyword.at, "keyword", format!("*{}", keyword.name), allowed))
        } else {
            Ok(())
        }
    }

    fn outside(&self, keyword: &Keyword) -> Result<(), ReadError> {
        match &self.open {
            Some(open) => {
                let kind = if open.motion.is_some() { "INSTANCE" } else { "PART" };
                let allowed = format!("*END {kind} of `{}` before it", open.name);
                Err(refuse(keyword.at, "keyword", format!("*{}", keyword.name), allowed))
            }
            None => Ok(()),
        }
    }

    fn begin_part(&mut self, keyword: &Keyword) -> Result<(), ReadError> {
        self.outside(keyword)?;
        let name = keyword.need("NAME")?;
        if self.parts.contains_key(&name.to_ascii_uppercase()) {
            return Err(refuse(keyword.at, "NAME of *PART", name, "each name once"));
        }
        let part = Rc::default();
        self.open = Some(Open { at: keyword.at, name: name.into(), part, motion: None });
        Ok(())
    }

    fn begin_instance(&mut self, keyword: &Keyword, data: &Data) -> Result<(), ReadError> {
        self.outside(keyword)?;
        keyword.allow(&["NAME", "PART"])?;
        let (name, part) = (keyword.need("NAME")?, keyword.need("PART")?);
        if self.instance.contains_key(&name.to_ascii_uppercase()) {
            return Err(refuse(keyword.at, "NAME of *INSTANCE", name, "each name once"));
        }
        let Some(part) = self.parts.get(&part.to_ascii_uppercase()) else {
            return Err(refuse(keyword.at, "PART of *INSTANCE", part, "the name of a *PART before it"));
        };
        let motion = Some(Motion::of(data)?);
        self.open = Some(Open { at: keyword.at, name: name.into(), part: Rc::clone(part), motion });
        Ok(())
    }

    /// Close the open part or instance and return it.
    fn close(&mut self, keyword: &Keyword, begin: &str, instance: bool) -> Result<Open, ReadError> {
        let open = self.open.take_if(|open| open.motion.is_some() == instance);
        let allowed = || format!("{begin} before it");
        open.ok_or_else(|| refuse(keyword.at, "keyword", format!("*{}", keyword.name), allowed()))
    }

    /// Part that the current keyword adds nodes, elements and sets to.
    fn part(&mut self) -> &mut Part {
        match &mut self.open {
            // Copy on write: instances share a part until one of them adds to it.
            Some(open) => Rc::make_mut(&mut open.part),
            None => &mut self.root,
        }
    }

    /// Return the part that owns a [`Member`].
    fn owner(&self, owner: u32) -> &Part {
        match owner.checked_sub(1) {
            Some(instance) => &self.instances[instance as usize].part,
            None => self.open.as_ref().map_or(&self.root, |open| &open.part),
        }
    }

    fn nodes(&mut self, keyword: &Keyword, data: &Data) -> Result<(), ReadError> {
        keyword.allow(&["NSET", "SYSTEM", "INPUT"])?;
        let cylindrical = match keyword.get("SYSTEM").map(str::to_ascii_uppercase).as_deref() {
            None | Some("R") => false,
            Some("C") => true,
            Some(other) => {
                let allowed = "R (rectangular) or C (cylindrical)";
                return Err(refuse(keyword.at, "SYSTEM of *NODE", other, allowed));
            }
        };
        let part = self.part();
        let set = keyword.get("NSET").map(|name| part.node_sets.of(name));
        for line in data.lines() {
            let mut values = fields(line);
            let tag = number(values.next().unwrap_or((line.0, "")), "node number", TAG)?;
            let mut x = [0.0; 3];
            let mut count = 0;
            for field in values {
                let coordinate = real(field, "coordinate")?;
                // Direction cosines of a normal may follow.
                if count < 3 {
                    x[count] = coordinate;
                }
                count += 1;
            }
            if !(1..=6).contains(&count) {
                let allowed = "1 to 3, and those of a normal";
                return Err(refuse(line.0, "number of coordinates", count, allowed));
            }
            if cylindrical {
                let (sin, cos) = x[1].to_radians().sin_cos();
                x = [x[0] * cos, x[0] * sin, x[2]];
            }
            if part.positions.len() >= MOST {
                return Err(refuse(line.0, "number of nodes", MOST + 1, format!("at most {MOST}")));
            }
            if !part.add_node(tag, x) {
                return Err(refuse(line.0, "node number", tag, "each number once"));
            }
            if let (Some(set), Some(node)) = (set, part.number(Of::Nodes, tag)) {
                part.node_sets.members[set].push((0, node));
            }
        }
        Ok(())
    }

    fn elements(&mut self, keyword: &Keyword, data: &Data) -> Result<(), ReadError> {
        keyword.allow(&["TYPE", "ELSET", "INPUT"])?;
        let name = keyword.need("TYPE")?.to_ascii_uppercase();
        let Some(listed) = kinds::of_type(&name) else {
            return Err(refuse(keyword.at, "TYPE of *ELEMENT", name, kinds::known()));
        };
        let part = self.part();
        let set = keyword.get("ELSET").map(|name| part.element_sets.of(name));
        // The data of an element may continue in the next line.
        let mut values = data.lines().flat_map(fields).peekable();
        while let Some(first) = values.next() {
            let tag: u64 = number(first, "element number", TAG)?;
            let mut corners = [0; MOST_CORNERS];
            let mut at = first.0;
            for n in 0..listed.nodes {
                let expected = || format!("node {} of element {tag} ({name})", n + 1);
                let field = values.next();
                let field = field.ok_or_else(|| end(data.last().unwrap_or(keyword.at), expected()))?;
                at = field.0;
                let node: u64 = number(field, "node of an element", TAG)?;
                let found = part.number(Of::Nodes, node).ok_or_else(|| {
                    refuse(at, "node of an element", node, "the number of a node of *NODE before it")
                })?;
                // Mid-side nodes follow the corners.
                if let Some(corner) = corners.get_mut(n) {
                    *corner = found;
                }
            }
            if listed.orientation {
                values.next_if(|next| next.0.same_line(at));
            }
            if let Some((at, text)) = values.peek().filter(|next| next.0.same_line(at)) {
                let allowed = format!("the {} nodes of a {name}", listed.nodes);
                return Err(refuse(*at, &format!("nodes of element {tag}"), text, allowed));
            }
            let element = Element { form: listed.form, corners, set: set.map(|set| set as u32) };
            if !part.add_element(tag, element) {
                return Err(refuse(first.0, "element number", tag, "each number once"));
            }
            if let Some(set) = set {
                let number = part.elements.len() as u32 - 1;
                part.element_sets.members[set].push((0, number));
            }
        }
        Ok(())
    }

    fn set(&mut self, keyword: &Keyword, key: &str, of: Of, data: &Data) -> Result<(), ReadError> {
        keyword.allow(match of {
            Of::Nodes => &["NSET", "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED", "ELSET"],
            Of::Elements => &["ELSET", "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED"],
        })?;
        let name = keyword.need(key)?;
        let owner = match keyword.get("INSTANCE") {
            Some(instance) => {
                self.outside(keyword)?;
                let found = self.instance.get(&instance.to_ascii_uppercase()).copied();
                found.ok_or_else(|| {
                    let allowed = "the name of an *INSTANCE before it";
                    refuse(keyword.at, &format!("INSTANCE of *{key}"), instance, allowed)
                })?
            }
            None => 0,
        };
        let mut members = Vec::new();
        if let (Of::Nodes, Some(elements)) = (of, keyword.get("ELSET")) {
            let found = self.owner(owner).element_sets.find(elements);
            let found = found.ok_or_else(|| {
                refuse(keyword.at, "ELSET of *NSET", elements, "a set that was defined before")
            })?;
            for (inner, element) in found.iter().map(|&member| within(owner, member)) {
                let nodes = self.owner(inner).elements[element as usize].nodes();
                members.extend(nodes.iter().map(|&node| (inner, node)));
            }
        }
        let mut room = 1 << 16;
        for line in data.lines() {
            if keyword.has("GENERATE") {
                self.generate(owner, of, line, &mut members)?;
            } else {
                for field in fields(line).filter(|f| !f.1.is_empty()) {
                    self.member(owner, of, key, field, &mut members)?;
                    // Remove duplicates as the list grows: a set may be listed repeatedly.
                    if members.len() > room {
                        members.sort_unstable();
                        members.dedup();
                        room = 2 * members.len().max(room / 2);
                    }
                }
            }
        }
        let sets = self.part().sets_mut(of);
        let place = sets.of(name);
        let set = &mut sets.members[place];
        set.extend(members);
        // Remove duplicates: sets of sets would grow without bound.
        set.sort_unstable();
        set.dedup();
        Ok(())
    }

    /// Add the nodes of a surface, of faces of elements (`set, S1`) or of node sets (TYPE=NODE), as a node set of its name. A surface that
    /// is described otherwise, or that has the name of a node set, is skipped.
    fn surface(&mut self, keyword: &Keyword, data: &Data) {
        let Some(name) = keyword.get("NAME").map(unquoted) else { return };
        let of_nodes = keyword.get("TYPE").is_some_and(|kind| kind.eq_ignore_ascii_case("NODE"));
        let of = if of_nodes { Of::Nodes } else { Of::Elements };
        let mut nodes = Vec::new();
        for line in data.lines() {
            let mut values = fields(line);
            let (Some(set), face) = (values.next(), values.next()) else { continue };
            let mut members = Vec::new();
            if self.member(0, of, "SURFACE", set, &mut members).is_err() {
                return;
            }
            if of_nodes {
                nodes.extend(members);
                continue;
            }
            for (owner, number) in members {
                let element = &self.owner(owner).elements[number as usize];
                let corners = face.and_then(|face| surfaces::face(element.form, face.1));
                let Some(corners) = corners else { return };
                nodes.extend(corners.iter().map(|&c| (owner, element.corners[c])));
            }
        }
        nodes.sort_unstable();
        nodes.dedup();
        let sets = self.part().sets_mut(Of::Nodes);
        if sets.find(name).is_none() {
            let place = sets.of(name);
            sets.members[place] = nodes;
        }
    }

    /// Parse the first and last number and the increment. As in Abaqus, numbers in between may be missing; the first and last must exist.
    fn generate(&self, owner: u32, of: Of, line: Field, members: &mut Vec<Member>) -> Result<(), ReadError> {
        let values = fields(line).map(|f| number(f, "GENERATE", TAG)).collect::<Result<Vec<u64>, _>>()?;
        let (first, last, step) = match values[..] {
            [first] => (first, first, 1),
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
        let part = self.owner(owner);
        for tag in [first, last] {
            if part.number(of, tag).is_none() {
                return Err(refuse(line.0, "GENERATE", tag, "a number that was defined before"));
            }
        }
        members.extend(part.between(of, [first, last, step]).into_iter().map(|number| (owner, number)));
        Ok(())
    }

    /// Parse a member: a number, or the name of a previous set, optionally after the name of an instance and a point.
    fn member(
        &self,
        owner: u32,
        of: Of,
        key: &str,
        field: Field,
        members: &mut Vec<Member>,
    ) -> Result<(), ReadError> {
        let name = unquoted(field.1);
        let of_instance = || {
            let (instance, name) = name.split_once('.').filter(|_| owner == 0 && self.open.is_none())?;
            let owner = *self.instance.get(&instance.to_ascii_uppercase())?;
            self.members(owner, of, unquoted(name))
        };
        let found = self.members(owner, of, name).or_else(of_instance);
        let found = found.ok_or_else(|| {
            let allowed = "a number or a set that was defined before";
            refuse(field.0, &format!("member of *{key}"), shown(field.1.as_bytes()), allowed)
        })?;
        members.extend(found);
        Ok(())
    }

    /// Resolve a number or the name of a set of this owner to its members.
    fn members(&self, owner: u32, of: Of, name: &str) -> Option<Vec<Member>> {
        let part = self.owner(owner);
        if let Some(number) = name.parse().ok().and_then(|tag| part.number(of, tag)) {
            return Some(vec![(owner, number)]);
        }
        Some(part.sets(of).find(name)?.iter().map(|&member| within(owner, member)).collect())
    }

    fn finish(mut self) -> Result<Builder, ReadError> {
        if let Some(open) = &self.open {
            let kind = if open.motion.is_some() { "INSTANCE" } else { "PART" };
            let expected = format!("*END {kind} of `{}`, which begins in this line,", open.name);
            return Err(end(open.at, expected));
        }
        if self.instances.is_empty() {
            if self.parts.len() > 1 {
                let names: Vec<&str> = self.parts.keys().map(String::as_str).collect();
                let what = format!("the parts {} have no *INSTANCE", names.join(", "));
                let allowed = "one part, or an *ASSEMBLY with instances of parts";
                return Err(ReadError::Whole { what, allowed });
            }
            let parts = std::mem::take(&mut self.parts).into_values();
            let alone = |part| Instance { name: String::new(), part, motion: Motion::NONE };
            self.instances.extend(parts.map(alone));
        }
        Assembly::new(&self)?.finish()
    }
}

/// Convert a member of a set of an instance to a member of a set of the assembly.
fn within(owner: u32, (inner, number): Member) -> Member {
    (if owner == 0 { inner } else { owner }, number)
}

/// Assembly of all instances.
struct Assembly<'a> {
    /// Nodes and elements of the assembly itself, then the instances, with their names.
    owners: Vec<(&'a str, &'a Part)>,
    /// Index of the first node of each owner.
    first_node: Vec<u32>,
    /// Number of owners with a set of this name, by name in capitals.
    uses: HashMap<String, usize>,
    builder: Builder,
}

impl<'a> Assembly<'a> {
    fn new(model: &'a Model) -> Result<Self, ReadError> {
        let instances = model.instances.iter().map(|i| (i.name.as_str(), &*i.part, &i.motion));
        let owners: Vec<_> = [("", &model.root, &Motion::NONE)].into_iter().chain(instances).collect();
        let total = |count: fn(&Part) -> usize| owners.iter().map(|o| count(o.1)).sum::<usize>();
        // An element is split into three at most.
        if total(|part| part.positions.len()).max(3 * total(|part| part.elements.len())) > MOST {
            let what = "the instances have too many nodes or elements".into();
            return Err(ReadError::Whole { what, allowed: "2^32 - 2 nodes and a third as many elements" });
        }
        let (mut builder, mut first_node) = (Builder::default(), Vec::new());
        let mut uses = HashMap::new();
        for (_, part, motion) in &owners {
            first_node.push(builder.node_count() as u32);
            for (&tag, &x) in part.tags.iter().zip(&part.positions) {
                builder.push_node(tag, motion.place(x));
            }
            let names = part.node_sets.names.iter().chain(&part.element_sets.names);
            let mut names: Vec<String> = names.map(|name| name.to_ascii_uppercase()).collect();
            names.sort_unstable();
            names.dedup();
            for name in names {
                *uses.entry(name).or_default() += 1;
            }
        }
        let owners = owners.into_iter().map(|(name, part, _)| (name, part)).collect();
        Ok(Self { owners, first_node, uses, builder })
    }

    /// Name of a set of a part: unchanged if no other owner has a set of this name, else prefixed with the name of the instance.
    fn name(&self, owner: usize, name: &str) -> String {
        let instance = self.owners[owner].0;
        if instance.is_empty() || self.uses.get(&name.to_ascii_uppercase()) == Some(&1) {
            name.into()
        } else {
            format!("{instance}.{name}")
        }
    }

    fn finish(mut self) -> Result<Builder, ReadError> {
        let elements = || self.owners.iter().flat_map(|(_, part)| &part.elements);
        let highest = elements().map(|e| e.form.dimensions()).max().unwrap_or(0);
        // Surface elements of a mesh in space become node sets; bars are reinforcement.
        let is_kept = |element: &Element| !(highest == 3 && element.form.dimensions() == 2);
        let mut made = Vec::with_capacity(self.owners.len());
        for owner in 0..self.owners.len() {
            let (instance, part) = self.owners[owner];
            let names: Vec<String> = part.element_sets.names.iter().map(|n| self.name(owner, n)).collect();
            // Elements without a set on their *ELEMENT line belong to the first set that contains them.
            let mut sets: Vec<Option<u32>> = part.elements.iter().map(|e| e.set).collect();
            for (set, members) in (0u32..).zip(&part.element_sets.members) {
                for &(_, element) in members.iter().filter(|member| member.0 == 0) {
                    sets[element as usize].get_or_insert(set);
                }
            }
            let first = self.first_node[owner];
            let mut of_part = Vec::with_capacity(part.elements.len());
            for (element, set) in part.elements.iter().zip(sets) {
                let nodes: Vec<u32> = element.nodes().iter().map(|n| first + n).collect();
                let block = set.map_or(instance, |set| names[set as usize].as_str());
                let kept = is_kept(element).then(|| self.builder.add_element(block, element.form, &nodes));
                of_part.push(kept.transpose()?);
            }
            made.push(of_part);
        }
        for owner in 0..self.owners.len() {
            let (instance, part) = self.owners[owner];
            for (set, members) in named(&part.node_sets) {
                let nodes = members.iter().map(|&member| self.node(within(owner as u32, member)));
                let nodes: Vec<u32> = nodes.collect();
                let name = self.name(owner, set);
                self.builder.add_to_node_set(&name, nodes);
            }
            for (set, members) in named(&part.element_sets) {
                let name = self.name(owner, set);
                let mut nodes = Vec::new();
                for member in members.iter().map(|&member| within(owner as u32, member)) {
                    let (inner, element) = (member.0 as usize, member.1 as usize);
                    let corners = self.owners[inner].1.elements[element].nodes();
                    nodes.extend(corners.iter().map(|n| self.first_node[inner] + n));
                    if let Some(elements) = made[inner][element] {
                        self.builder.add_to_element_set(&name, elements);
                    }
                }
                if part.node_sets.find(set).is_none() {
                    self.builder.add_to_node_set(&name, nodes);
                }
            }
            if !instance.is_empty() && !self.uses.contains_key(&instance.to_ascii_uppercase()) {
                let kept = made[owner].iter().flatten();
                kept.for_each(|&elements| self.builder.add_to_element_set(instance, elements));
            }
        }
        Ok(self.builder)
    }

    fn node(&self, (owner, number): Member) -> u32 {
        self.first_node[owner as usize] + number
    }
}

fn named(sets: &Sets) -> impl Iterator<Item = (&String, &Vec<Member>)> {
    sets.names.iter().zip(&sets.members)
}
