//! Import graph of the library files, which must be free of cycles, and search for the field's terms in their headings.
//!
//! A file imports the files that define the items it names after `crate::`, `super::` or `self::`; re-exports are followed.
//! Tests within files and links in the documentation do not count.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

type Module = Vec<String>;

/// Return the files of a crate by module.
fn modules(folder: &Path) -> BTreeMap<Module, PathBuf> {
    let mut found = BTreeMap::new();
    let mut open = vec![(folder.to_path_buf(), Module::new())];
    while let Some((folder, module)) = open.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").flatten() {
            let path = entry.path();
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            let child = || module.iter().cloned().chain([name.clone()]).collect::<Module>();
            if path.is_dir() {
                open.push((path, child()));
            } else if path.extension().is_some_and(|e| e == "rs") && name != "main" {
                let own = if name == "lib" || name == "mod" { module.clone() } else { child() };
                found.insert(own, path);
            }
        }
    }
    found
}

/// Return the text of a file without comments, strings and tests.
fn code(path: &Path) -> String {
    let text = std::fs::read_to_string(path).expect("a file");
    let (text, mut out) = (text.as_str(), String::new());
    let text = text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let mut within = false;
    for line in text.lines() {
        let mut rest = line.split("//").next().unwrap_or_default();
        while let Some(place) = rest.find('"') {
            if !within {
                out.push_str(&rest[..place]);
            }
            within = !within;
            rest = &rest[place + 1..];
        }
        if !within {
            out.push_str(rest);
        }
        out.push('\n');
    }
    out
}

/// Collect the paths of a use statement without `use` and semicolon: `a::{b, c::d as e}` yields a::b, and a::c::d
/// as e.
fn leaves(tree: &str, before: &[String], out: &mut Vec<(String, Module)>) {
    let tree = tree.trim();
    if let Some(open) = tree.find('{') {
        let mut path = before.to_vec();
        path.extend(segments(&tree[..open]));
        let inner = &tree[open + 1..tree.rfind('}').unwrap_or(tree.len())];
        let (mut depth, mut start) = (0, 0);
        for (place, letter) in inner.char_indices() {
            match letter {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    leaves(&inner[start..place], &path, out);
                    start = place + 1;
                }
                _ => {}
            }
        }
        leaves(&inner[start..], &path, out);
    } else if !tree.is_empty() {
        let (path, name) = tree.split_once(" as ").unwrap_or((tree, ""));
        let mut whole = before.to_vec();
        whole.extend(segments(path));
        if whole.last().is_some_and(|s| s == "self") {
            whole.pop();
        }
        let name =
            if name.is_empty() { whole.last().cloned().unwrap_or_default() } else { name.trim().into() };
        out.push((name, whole));
    }
}

fn segments(path: &str) -> Module {
    path.split("::").map(|s| s.trim().to_string()).filter(|s| !s.is_empty()).collect()
}

/// Re-exports of a file by name, and all paths in it.
#[derive(Default)]
struct Names {
    exports: Vec<(String, Module)>,
    paths: Vec<Module>,
}

fn names(code: &str) -> Names {
    let mut names = Names::default();
    let mut rest = code;
    while let Some(place) = rest.find("use ") {
        let begins = rest[..place].trim_end().is_empty()
            || rest[..place].ends_with(['\n', ' ', ')'])
            || rest[..place].ends_with('\t');
        let Some(end) = rest[place..].find(';') else { break };
        if begins {
            let mut list = Vec::new();
            leaves(&rest[place + 4..place + end], &[], &mut list);
            let line = rest[..place].rsplit('\n').next().unwrap_or_default();
            if line.trim_start().starts_with("pub") {
                names.exports.extend(list);
            } else {
                names.paths.extend(list.into_iter().map(|(_, path)| path));
            }
        }
        rest = &rest[place + end..];
    }
    // Collect paths within the text.
    for start in ["crate::", "super::"] {
        for (place, _) in code.match_indices(start) {
            let before = code[..place].chars().next_back();
            if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':' || c == '$') {
                continue;
            }
            let end = code[place..].find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
            names.paths.push(segments(&code[place..place + end.unwrap_or(code.len() - place)]));
        }
    }
    names
}

struct Library {
    modules: BTreeMap<Module, PathBuf>,
    names: BTreeMap<Module, Names>,
}

impl Library {
    /// Return the module that defines the item of a path seen from module `from`; none for an item of another
    /// crate.
    fn find(&self, from: &[String], path: &[String], depth: usize) -> Option<Module> {
        let mut at = from.to_vec();
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" => {
                at.clear();
                rest = &rest[1..];
            }
            "self" => rest = &rest[1..],
            "super" => {
                while rest.first().is_some_and(|s| s == "super") {
                    at.pop()?;
                    rest = &rest[1..];
                }
            }
            first => {
                let mut child = at.clone();
                child.push(first.to_string());
                let exported = self.names.get(&at).is_some_and(|n| n.exports.iter().any(|(e, _)| e == first));
                if !self.modules.contains_key(&child) && !exported {
                    return None;
                }
            }
        }
        self.walk(at, rest, depth)
    }

    fn walk(&self, mut at: Module, mut rest: &[String], depth: usize) -> Option<Module> {
        if depth > 20 {
            return None;
        }
        while let Some(first) = rest.first() {
            let mut child = at.clone();
            child.push(first.clone());
            if self.modules.contains_key(&child) {
                (at, rest) = (child, &rest[1..]);
                continue;
            }
            let exports = &self.names.get(&at)?.exports;
            if let Some((_, target)) = exports.iter().find(|(name, _)| name == first) {
                let target: Module = target.iter().chain(&rest[1..]).cloned().collect();
                return self.find(&at, &target, depth + 1);
            }
            // Item of this module, or re-exported item of another crate.
            return Some(at);
        }
        Some(at)
    }

    /// Return the imported modules of every module.
    fn imports(&self) -> BTreeMap<Module, BTreeSet<Module>> {
        let mut all = BTreeMap::new();
        for (module, names) in &self.names {
            let found = names.paths.iter().filter_map(|path| self.find(module, path, 0));
            // A module that declares and re-exports submodules does not depend on them.
            all.insert(module.clone(), found.filter(|other| other != module).collect());
        }
        all
    }
}

/// Return the modules of every import cycle, i.e. strongly connected components by mutual reachability.
fn circles(imports: &BTreeMap<Module, BTreeSet<Module>>) -> Vec<Vec<String>> {
    let reach = |from: &Module| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(module) = open.pop() {
            for next in imports.get(&module).into_iter().flatten() {
                if seen.insert(next.clone()) {
                    open.push(next.clone());
                }
            }
        }
        seen
    };
    let reached: BTreeMap<&Module, BTreeSet<Module>> = imports.keys().map(|m| (m, reach(m))).collect();
    let mut found = BTreeSet::new();
    for (module, far) in &reached {
        let both = |other: &&Module| far.contains(*other) && reached[*other].contains(*module);
        let circle: Vec<String> = imports.keys().filter(both).map(|m| m.join("::")).collect();
        if far.contains(*module) {
            found.insert(circle);
        }
    }
    found.into_iter().collect()
}

/// Library crates, leaf first.
const LIBRARIES: [&str; 18] = [
    "impactite-simd",
    "impactite-solve",
    "mpm-materials",
    "impactite-geometry",
    "impactite-output",
    "impactite-scene",
    "impactite-report",
    "mpm-contact",
    "mpm-core",
    "pcmm",
    "fem",
    "sph",
    "fpm",
    "flow",
    "coupling",
    "impactite-scene-file",
    "impactite-input",
    "impactite-cli",
];

fn library(name: &str) -> Library {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the repository");
    let modules = modules(&root.join(name).join("src"));
    let names = modules.iter().map(|(module, path)| (module.clone(), names(&code(path)))).collect();
    Library { modules, names }
}

#[test]
fn no_library_has_a_circle_of_files() {
    let mut wrong = Vec::new();
    for name in LIBRARIES {
        let imports = library(name).imports();
        for circle in circles(&imports) {
            for file in &circle {
                let others = imports.iter().find(|(module, _)| module.join("::") == *file).map(|(_, o)| o);
                let others = others.into_iter().flatten().map(|o| o.join("::"));
                let others: Vec<String> = others.filter(|other| circle.contains(other)).collect();
                wrong.push(format!("{name}: {file} imports {}", others.join(", ")));
            }
        }
    }
    assert!(wrong.is_empty(), "files that import each other in circles:\n{}", wrong.join("\n"));
}

/// Libraries depend only on libraries below them; method libraries are independent of each other.
#[test]
fn libraries_depend_downwards() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the repository");
    for (n, name) in LIBRARIES.iter().enumerate() {
        let manifest = std::fs::read_to_string(root.join(name).join("Cargo.toml")).expect("a manifest");
        let dependencies = manifest.split("[dependencies]").nth(1).unwrap_or_default();
        let dependencies = dependencies.split("\n[").next().unwrap_or_default();
        for above in &LIBRARIES[n + 1..] {
            let named = dependencies
                .lines()
                .any(|l| l.starts_with(&format!("{above}.")) || l.starts_with(&format!("{above} ")));
            assert!(!named, "{name} depends on {above}, which stands above it");
        }
        if ["pcmm", "fem", "sph", "fpm", "flow"].contains(name) {
            let other = ["mpm-core", "pcmm"].iter().any(|method| dependencies.contains(method));
            assert!(!other, "a method depends on another one");
        }
    }
}

/// The search detects a cycle of two files and follows re-exports.
#[test]
fn circles_are_seen() {
    let folder = std::env::temp_dir().join(format!("impactite-imports-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("b")).expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("a file");
    write("lib.rs", "mod a;\nmod b;\nmod c;\npub use b::inner::{Item as Thing};\n");
    write("a.rs", "use crate::Thing;\n// use crate::c::C;\npub struct A;\n");
    write("b/mod.rs", "pub mod inner;\n");
    write("b/inner.rs", "use super::super::{a::A, c};\npub struct Item(A, c::C);\n");
    write("c.rs", "pub struct C;\nconst TEXT: &str = \"use crate::a::A;\";\n");
    let modules = modules(&folder);
    let names = modules.iter().map(|(module, path)| (module.clone(), names(&code(path)))).collect();
    let found = circles(&Library { modules, names }.imports());
    let _ = std::fs::remove_dir_all(&folder);
    assert_eq!(found, [["a".to_string(), "b::inner".to_string()]]);
}

/// Field's terms, and the library file that a search of the headings for them must find.
const TERMS: [(&str, &str); 10] = [
    ("velocity update", "mpm-core/src/step/nodes/node_update.rs"),
    ("strain rate", "mpm-materials/src/point.rs"),
    ("artificial viscosity", "mpm-materials/src/viscosity.rs"),
    ("contact normal", "mpm-contact/src/normal.rs"),
    ("hourglass control", "fem/src/technology.rs"),
    ("time step limit", "impactite-scene/src/control.rs"),
    ("checkpoint archive", "impactite-scene/src/archive.rs"),
    ("energy balance", "impactite-scene/src/balance.rs"),
    ("courant number", "impactite-scene/src/control.rs"),
    ("yield surface", "mpm-materials/src/strength.rs"),
];

/// Largest number of headings with a term: one of each method may have its own.
const HITS: usize = 4;

#[test]
fn terms_of_the_field_find_their_file_by_its_heading() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut headings = Vec::new();
    for entry in std::fs::read_dir(&root).expect("the repository").flatten() {
        let source = entry.path().join("src");
        if source.is_dir()
            && !["examples", "benchmarks", "tests"].contains(&&*entry.file_name().to_string_lossy())
        {
            for path in modules(&source).into_values() {
                let text = std::fs::read_to_string(&path).expect("a file");
                headings.push((path, text.lines().next().unwrap_or_default().to_lowercase()));
            }
        }
    }
    for (term, file) in TERMS {
        let found: Vec<&Path> =
            headings.iter().filter(|(_, heading)| heading.contains(term)).map(|(path, _)| &**path).collect();
        assert!(found.iter().any(|path| path.ends_with(file)), "{term}: {found:?}");
        assert!(found.len() <= HITS, "{term}: {found:?}");
    }
}
