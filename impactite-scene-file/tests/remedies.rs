//! Library messages as displayed to authors of scene files: no Rust call, and no key that the schema does not have.

use std::path::{Path, PathBuf};

use impactite_scene_file::remedy::{REMEDIES, in_scene_files};
use serde_json::Value;

/// Crates whose messages the program displays.
const CRATES: &[&str] = &[
    "coupling",
    "fem",
    "flow",
    "fpm",
    "impactite-cli",
    "impactite-geometry",
    "impactite-input",
    "impactite-output",
    "impactite-report",
    "impactite-scene",
    "impactite-scene-file",
    "impactite-simd",
    "impactite-solve",
    "mpm-contact",
    "mpm-core",
    "mpm-materials",
    "pcmm",
    "sph",
];

/// Literals with names similar to Rust that are no messages: file formats, doc comments in macros, debug text.
const OTHERS: &[&str] = &[
    "VTKFile",
    "NumberOf",
    "DataArray",
    "ParticleSize",
    "TimeValue",
    "$Mesh",
    "FrictionWall(",
    "](ElementMesh::",
    "MshFileVersion",
    "DataSet",
    "WebP",
    "NaN",
    "PolyData",
    "AppendedData",
    "CellData",
    "PointData",
    "ComponentName",
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Return the string literals of a source, without those of comments, compiler messages and tests.
fn literals(text: &str) -> Vec<String> {
    let text = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let bytes = text.as_bytes();
    let (mut found, mut n) = (Vec::new(), 0);
    while n < bytes.len() {
        let rest = &text[n..];
        if rest.starts_with("//") {
            n += rest.find('\n').unwrap_or(rest.len());
        } else if rest.starts_with("#[diagnostic::on_unimplemented(") {
            n += rest.find(")]\n").unwrap_or(rest.len());
        } else if let Some(raw) = rest.strip_prefix("r#\"") {
            n += 3 + raw.find("\"#").unwrap_or(raw.len()) + 2;
        } else if rest.starts_with("'\"'") || rest.starts_with("'\\") {
            n += if rest.starts_with("'\"'") {
                3
            } else {
                1 + rest[1..].find('\'').map_or(1, |end| end.max(2)) + 1
            };
        } else if rest.starts_with('"') {
            let mut end = 1;
            while end < rest.len() && rest.as_bytes()[end] != b'"' {
                end += if rest.as_bytes()[end] == b'\\' { 2 } else { 1 };
            }
            // A trailing backslash joins lines without the leading blanks of the next one.
            let mut joined = String::new();
            for (k, line) in rest[1..end.min(rest.len())].split("\\\n").enumerate() {
                joined += if k == 0 { line } else { line.trim_start() };
            }
            found.push(joined);
            n += end + 1;
        } else {
            n += rest.chars().next().map_or(1, char::len_utf8);
        }
        while !text.is_char_boundary(n.min(text.len())) {
            n += 1;
        }
    }
    found
}

/// Return a Rust path or type name in a message; `None` for plain words.
fn rust_of(message: &str) -> Option<String> {
    let word = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let is_rust = |w: &str| {
        let path = w.split("::").filter(|part| !part.is_empty()).count() > 1;
        let letters: Vec<char> = w.chars().collect();
        // `CamelCase`, but not `FLIP` or `AVX2`.
        let hump = |n: usize| letters[n].is_uppercase() && n > 0 && letters[n - 1].is_lowercase();
        path || letters.first().is_some_and(|c| c.is_uppercase()) && (1..letters.len()).any(hump)
    };
    let found = message.split(|c| !word(c)).find(|w| is_rust(w)).map(String::from);
    // A single-word type in backquotes, as `Linear`.
    let quoted = || {
        let mut inside = message.split('`').skip(1).step_by(2);
        inside
            .find(|q| q.starts_with(char::is_uppercase) && q.chars().all(char::is_alphanumeric))
            .map(String::from)
    };
    found.or_else(quoted)
}

fn messages() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    CRATES.iter().for_each(|name| sources(&root.join(name).join("src"), &mut files));
    files.retain(|f| {
        // The table itself and the page of keys are no messages.
        let apart = ["impactite-scene-file/src/remedy.rs", "impactite-input/src/keys/page.rs"];
        !apart.iter().any(|name| f.ends_with(name)) && !f.iter().any(|part| part == "conformance")
    });
    let of = |file: PathBuf| {
        let text = std::fs::read_to_string(&file).expect("a source");
        literals(&text).into_iter().map(move |message| (file.clone(), message))
    };
    files.into_iter().flat_map(of).collect()
}

#[test]
fn no_message_names_rust_to_users_of_scene_files() {
    let all = messages();
    assert!(all.len() > 2000, "{} literals are not all there are", all.len());
    // A message contains several words.
    let shown = all.iter().filter(|(_, m)| m.trim().contains(' ') && !OTHERS.iter().any(|o| m.contains(o)));
    let named: Vec<String> = shown
        .filter_map(|(file, m)| {
            let rust = rust_of(&in_scene_files(m))?;
            Some(format!("{}: `{rust}` in {m:?}", file.display()))
        })
        .collect();
    assert!(named.is_empty(), "add to `REMEDIES` what these are in scene files:\n{}", named.join("\n"));
}

#[test]
fn every_remedy_is_of_a_message() {
    let all = messages();
    for remedy in REMEDIES {
        let used = all.iter().any(|(_, m)| m.contains(remedy.library));
        assert!(used, "no message says {:?}", remedy.library);
        assert_eq!(in_scene_files(remedy.scene_file), remedy.scene_file, "it is changed twice");
        assert_eq!(rust_of(remedy.scene_file), None);
    }
}

/// Return the schemas of a key of an object, through references and alternatives.
fn down<'a>(schema: &'a Value, of: &'a Value, key: &str) -> Vec<&'a Value> {
    let mut found = Vec::new();
    if let Some(target) = of["$ref"].as_str().and_then(|r| r.strip_prefix("#/$defs/")) {
        found.extend(down(schema, &schema["$defs"][target], key));
    }
    for word in ["oneOf", "anyOf", "allOf"] {
        of[word].as_array().into_iter().flatten().for_each(|one| found.extend(down(schema, one, key)));
    }
    if of["items"].is_object() {
        found.extend(down(schema, &of["items"], key));
    }
    found.extend(of["properties"].get(key));
    if key == "NAME" && of["additionalProperties"].is_object() {
        found.push(&of["additionalProperties"]);
    }
    found
}

/// True if the word is a value of the schema.
fn takes(schema: &Value, of: &Value, word: &str) -> bool {
    let target = of["$ref"].as_str().and_then(|r| r.strip_prefix("#/$defs/"));
    target.is_some_and(|name| takes(schema, &schema["$defs"][name], word))
        || of["const"] == word
        || of["enum"].as_array().into_iter().flatten().any(|v| v == word)
        || ["oneOf", "anyOf", "allOf"]
            .iter()
            .any(|list| of[list].as_array().into_iter().flatten().any(|one| takes(schema, one, word)))
}

#[test]
fn every_key_of_a_remedy_is_one_of_scene_files() {
    let schema = impactite_scene_file::schema().to_value();
    let mut keys = 0;
    for Remedied { text, key, value } in REMEDIES.iter().flat_map(|r| keys_of(r.scene_file)) {
        let mut here = vec![&schema];
        for part in key.split('.') {
            here = here.into_iter().flat_map(|of| down(&schema, of, part)).collect();
            assert!(!here.is_empty(), "scene files have no `{part}` of `{key}`: {text}");
        }
        if let Some(word) = value {
            assert!(here.iter().any(|of| takes(&schema, of, &word)), "`{key}` cannot be {word:?}: {text}");
        }
        keys += 1;
    }
    assert!(keys > 30, "{keys} keys");
}

struct Remedied {
    text: &'static str,
    key: String,
    value: Option<String>,
}

/// Return the keys in backquotes, with their text values.
fn keys_of(text: &'static str) -> impl Iterator<Item = Remedied> {
    text.split('`').skip(1).step_by(2).filter(|quoted| !quoted.starts_with('"')).map(move |quoted| {
        let (key, value) = quoted.split_once(" = ").map_or((quoted, None), |(key, value)| (key, Some(value)));
        let value = value.and_then(|v| v.strip_prefix('"')?.strip_suffix('"')).map(String::from);
        // Keys of a table that was named before.
        let key =
            if key.starts_with("integration.") { format!("bodies.NAME.{key}") } else { key.to_string() };
        Remedied { text, key, value }
    })
}
