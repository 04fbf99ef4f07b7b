//! Refinement: sizes that determine the resolution of a scene, and their scaling by one parameter.

use toml_edit::{Document, DocumentMut, Item, Table, TableLike, Value};

use crate::document::{Source, Step, steps_of, text_of};
use crate::error::{Fault, InputError};
use crate::model::SceneFile;
use crate::model::body::Mesh;
use crate::model::method::{Method, TimeStep};
use crate::quantity::Quantity;

/// Key of a size that determines the resolution.
#[derive(Clone, Debug, PartialEq)]
pub struct Size {
    /// Key, as `method.mpm.cell`.
    pub key: String,
    /// Value in SI units.
    pub value: f64,
    /// SI unit: `m` for cells, spacings and edges, `s` for steps.
    pub unit: &'static str,
}

/// Name of the parameter that scales sizes.
const FACTOR: &str = "size_factor";

impl Source {
    /// Return the sizes that are refined together: the cell or spacing of the method, the edges of regular meshes and bars, and the times
    /// bound to them, of a fixed step and of erosion by time step.
    ///
    /// # Errors
    /// Mesh from a file, whose edges are not defined in the scene; scene without any length.
    pub fn sizes(&self, scene: &SceneFile) -> Result<Vec<Size>, InputError> {
        let refused = |key: &str, why: &str, help: String| {
            InputError::from(Box::new(self.fault_at(key, why, Some(help))))
        };
        let size = |key: String, value, unit| Size { key, value, unit };
        let length = match &scene.method {
            Method::Mpm(m) if m.cell.fine.is_some() => None,
            Method::Mpm(m) => Some(("method.mpm.cell", Quantity::new(m.cell.value))),
            Method::Sph(m) => Some(("method.sph.spacing", m.spacing)),
            Method::Fpm(m) => Some(("method.fpm.spacing", m.spacing)),
            Method::Pcmm(m) => Some(("method.pcmm.spacing", m.spacing)),
            Method::Flow(m) => Some(("method.flow.cell", m.cell)),
            Method::Fem(_) => None,
        };
        let mut sizes: Vec<Size> =
            length.map(|(key, q)| size(key.into(), q.value, "m")).into_iter().collect();
        if let Method::Mpm(m) = &scene.method
            && let Some(fine) = m.cell.fine
        {
            sizes.push(size("method.mpm.cell.coarse".into(), m.cell.value, "m"));
            sizes.push(size("method.mpm.cell.fine".into(), fine, "m"));
        }
        if let Method::Flow(m) = &scene.method
            && let Some(solids) = &m.solids
        {
            sizes.push(size("method.flow.solids.cell".into(), solids.cell.value, "m"));
        }
        for (name, body) in &scene.bodies {
            let file = match &body.mesh {
                Some(Mesh::Edge(edge)) => {
                    sizes.push(size(format!("bodies.{name}.mesh.edge"), edge.value, "m"));
                    continue;
                }
                Some(Mesh::Bars(bars)) => {
                    sizes.push(size(format!("bodies.{name}.mesh.bars.edge"), bars.edge.value, "m"));
                    continue;
                }
                Some(Mesh::Gmsh(_)) => "gmsh",
                Some(Mesh::Abaqus(_)) => "abaqus",
                None => continue,
            };
            let key = format!("bodies.{name}.mesh.{file}");
            let help = format!(
                "`mesh.edge` makes regular meshes of boxes, balls, cylinders and tubes; of meshes of several sizes: `impactite sweep FILE --over \
                 {key}.file=COARSE,FINE`"
            );
            return Err(refused(&key, "a mesh from a file cannot be refined", help));
        }
        if sizes.is_empty() {
            let help = "`bodies.NAME.mesh.edge` is the size of finite elements".into();
            return Err(refused("method", "the scene has no size that could be refined", help));
        }
        for (name, body) in &scene.bodies {
            if let Some(step) = body.erosion.as_ref().and_then(|erosion| erosion.step) {
                sizes.push(size(format!("bodies.{name}.erosion.step"), step.value, "s"));
            }
        }
        if let Some(TimeStep::Fixed(step)) = &scene.time_step {
            sizes.push(size("time_step.fixed".into(), step.value, "s"));
        }
        Ok(sizes)
    }

    /// Copy in which the values at `keys` are multiplied by a new parameter of value 1; also return its name. With `"radius / cells"` at a
    /// key the copy has `"(radius / cells) * size_factor"`. Keys are those of [`Source::sizes`], or others with a unit.
    ///
    /// # Errors
    /// Key that the file does not have; a value that is no quantity; a formula; a number without a unit at a key that is no size.
    pub fn scaled(&self, sizes: &[Size], keys: &[String]) -> Result<(Self, String), InputError> {
        let mut document: DocumentMut = self.parse_text()?;
        let taken = |name: &str| document.get("parameters").and_then(|p| p.get(name)).is_some();
        let names = (1..).map(|n| if n == 1 { FACTOR.to_string() } else { format!("{FACTOR}_{n}") });
        let name = names.into_iter().find(|name| !taken(name)).unwrap_or_default();
        for key in keys {
            let refused = |why: &str| InputError::from(Box::new(self.fault_at(key, why, None)));
            let place = found(document.as_item_mut(), &steps_of(key))
                .ok_or_else(|| refused("the file has no such key, which is to be refined"))?;
            let unit = match sizes.iter().find(|size| size.key == *key) {
                Some(size) => Some(size.unit),
                None => key.starts_with("parameters.").then_some(""),
            };
            let text = text_of(place)
                .ok_or_else(|| refused("only a number or a text with a unit can be refined"))?;
            let expression = match (place.is_str(), unit) {
                (true, _) if text.trim_start().starts_with('=') => {
                    return Err(refused("a formula cannot be refined"));
                }
                (true, _) | (false, Some("")) => text,
                (false, Some(unit)) => format!("{text} {unit}"),
                (false, None) => {
                    return Err(refused("a number without a unit cannot be refined; write it with its unit"));
                }
            };
            if let Some(value) = place.as_value_mut() {
                let decor = value.decor().clone();
                *value = Value::from(format!("({expression}) * {name}"));
                *value.decor_mut() = decor;
            }
        }
        define_first(&mut document, &name);
        Ok((self.with_text(document.to_string()), name))
    }

    /// Return the parameters of the resolution that other keys use too, with those keys: a parameter that is itself a size, or a plain
    /// number in a size, as `cells` of `"radius / cells"`. Those other keys are unchanged when the sizes at `keys` are scaled.
    #[must_use]
    pub fn shared_parameters(&self, scene: &SceneFile, keys: &[String]) -> Vec<(String, Vec<String>)> {
        let Ok(document) = Document::parse(self.text.as_str()) else { return Vec::new() };
        let mut texts = Vec::new();
        collect(document.as_item(), "", &mut texts);
        texts.retain(|(_, text)| text.trim_start().starts_with('=') || scene.known.measure(text).is_ok());
        let is_refined = |key: &String| keys.contains(key);
        let sizes: Vec<&str> =
            texts.iter().filter(|(key, _)| is_refined(key)).map(|(_, text)| text.trim()).collect();
        let resolution = |name: &&String| {
            let plain = scene.known.unit(name).is_empty();
            sizes.iter().any(|size| size == name || plain && has_word(size, name))
        };
        let users = |name: &String| {
            let others = texts.iter().filter(|(key, text)| !is_refined(key) && has_word(text, name));
            others.map(|(key, _)| key.clone()).collect::<Vec<_>>()
        };
        let shared = scene.known.numbers().keys().filter(resolution).map(|name| (name.clone(), users(name)));
        shared.filter(|(_, users)| !users.is_empty()).collect()
    }

    fn parse_text(&self) -> Result<DocumentMut, Box<Fault>> {
        self.text.parse().map_err(|e: toml_edit::TomlError| Box::new(self.syntax(&e)))
    }
}

/// Return the item at the end of the steps, if it exists.
fn found<'a>(item: &'a mut Item, steps: &[Step]) -> Option<&'a mut Item> {
    let down = |here: &'a mut Item, step: &Step| match step {
        Step::Key(key) => here.as_table_like_mut()?.get_mut(key),
        Step::Number(n) => here.get_mut(*n),
    };
    steps.iter().try_fold(item, down)
}

/// Insert a parameter of value 1 before all others, which may then depend on it.
fn define_first(document: &mut DocumentMut, name: &str) {
    let parameters = document.entry("parameters").or_insert_with(|| Item::Table(Table::new()));
    let names = |table: &dyn TableLike| table.iter().map(|(name, _)| name.to_string()).collect::<Vec<_>>();
    match parameters {
        Item::Table(table) => {
            let rest: Vec<_> = names(table).iter().filter_map(|name| table.remove_entry(name)).collect();
            table.insert(name, toml_edit::value(1));
            rest.into_iter().for_each(|(key, item)| {
                table.insert_formatted(&key, item);
            });
        }
        Item::Value(Value::InlineTable(table)) => {
            let rest: Vec<_> = names(table).iter().filter_map(|name| table.remove_entry(name)).collect();
            table.insert(name, 1.into());
            rest.into_iter().for_each(|(key, value)| {
                table.insert_formatted(&key, value);
            });
        }
        _ => {}
    }
}

/// Collect all texts below an item, with their keys.
fn collect(item: &Item, key: &str, texts: &mut Vec<(String, String)>) {
    let below = |name: &str| if key.is_empty() { name.to_string() } else { format!("{key}.{name}") };
    if let Some(text) = item.as_str() {
        texts.push((key.into(), text.into()));
    } else if let Some(table) = item.as_table_like() {
        table.iter().for_each(|(name, item)| collect(item, &below(name), texts));
    } else {
        let count =
            item.as_array().map(|list| list.len()).or(item.as_array_of_tables().map(|list| list.len()));
        for n in 0..count.unwrap_or(0) {
            if let Some(item) = item.get(n) {
                collect(item, &format!("{key}[{n}]"), texts);
            }
        }
    }
}

/// True if the text contains the name as a whole word.
fn has_word(text: &str, name: &str) -> bool {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == name)
}
