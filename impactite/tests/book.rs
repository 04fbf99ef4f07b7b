//! Consistency of the book and the other documents: table of contents, links, tested programs, and references of the code to the book.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Prefix of links that leave the book for files of this repository.
const REPOSITORY: &str = "https://github.com/impactite/impactite/";

fn root() -> PathBuf {
    normal(&Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
}

/// Return the path without `.` and `..`.
fn normal(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                out.pop();
            }
            Component::CurDir => {}
            other => out.push(other),
        }
    }
    out
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Collect all files below `folder` with this extension, in order; build output is skipped.
fn files(folder: &Path, extension: &str, out: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|p| !p.is_symlink())
        .collect();
    entries.sort();
    for path in entries {
        let name = path.file_name().unwrap().to_string_lossy();
        if path.is_dir() {
            let output = ["target", "out", ".git"].contains(&&*name) || path.ends_with("docs/book/book");
            if !output {
                files(&path, extension, out);
            }
        } else if path.extension().is_some_and(|e| e == extension) {
            out.push(path);
        }
    }
}

fn below(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut out = Vec::new();
    files(folder, extension, &mut out);
    out
}

/// Split a page into the lines outside of code blocks and the languages of the blocks.
fn split(page: &str) -> (String, Vec<String>) {
    let (mut prose, mut blocks, mut code) = (String::new(), Vec::new(), false);
    for line in page.lines() {
        if let Some(language) = line.trim_start().strip_prefix("```") {
            if !code {
                blocks.push(language.to_string());
            }
            code = !code;
        } else if !code {
            prose.push_str(line);
            prose.push('\n');
        }
    }
    (prose, blocks)
}

/// Return prose without code spans.
fn without_spans(prose: &str) -> String {
    prose.split('`').step_by(2).collect::<Vec<_>>().join(" ")
}

/// Return the link targets between `](` and `)`.
fn links(prose: &str) -> Vec<String> {
    let text = without_spans(prose);
    let ends = text.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    ends.map(|(target, _)| target.trim().to_string()).collect()
}

/// Return the values of `href="..."` and `src="..."`.
fn references(html: &str) -> Vec<String> {
    let attribute = |name: &'static str| {
        html.split(name).skip(1).filter_map(|rest| rest.split_once('"')).map(|(target, _)| target.to_string())
    };
    attribute(" href=\"").chain(attribute(" src=\"")).collect()
}

fn headings(prose: &str) -> Vec<String> {
    let heads = prose
        .lines()
        .filter_map(|line| line.trim_start_matches('#').strip_prefix(' ').filter(|_| line.starts_with('#')));
    heads.map(|h| h.trim().to_string()).collect()
}

/// Return the anchor of a heading, as mdBook and GitHub generate it.
fn anchor(heading: &str) -> String {
    let kept = heading
        .to_lowercase()
        .chars()
        .filter(|c| c.is_alphanumeric() || "-_ ".contains(*c))
        .collect::<String>();
    kept.replace(' ', "-")
}

/// Check that a link resolves from the folder of its page.
fn check(target: &str, folder: &Path, root: &Path) -> Result<(), String> {
    let (path, fragment) = target.split_once('#').map_or((target, None), |(p, f)| (p, Some(f)));
    let file = if let Some(inside) = path.strip_prefix(REPOSITORY) {
        let inside = inside.strip_prefix("blob/main/").or(inside.strip_prefix("tree/main/"));
        root.join(inside.ok_or("neither blob/main nor tree/main")?)
    } else if ["http://", "https://", "mailto:", "data:"].iter().any(|scheme| path.starts_with(scheme)) {
        return Ok(());
    } else {
        normal(&folder.join(path))
    };
    if !file.exists() {
        return Err("no such file".into());
    }
    match fragment {
        Some(fragment) if file.extension().is_some_and(|e| e == "md") => {
            let (prose, _) = split(&text(&file));
            let found = headings(&prose).iter().any(|h| anchor(h) == fragment);
            found.then_some(()).ok_or_else(|| "no such heading".into())
        }
        _ => Ok(()),
    }
}

#[test]
fn chapters_are_those_of_the_summary() {
    let source = root().join("docs/book/src");
    let (summary, _) = split(&text(&source.join("SUMMARY.md")));
    let listed: Vec<PathBuf> = links(&summary).iter().map(|link| source.join(link)).collect();
    let unique: BTreeSet<_> = listed.iter().cloned().collect();
    assert_eq!(listed.len(), unique.len(), "a chapter stands in SUMMARY.md twice");
    let written: BTreeSet<_> =
        below(&source, "md").into_iter().filter(|path| !path.ends_with("SUMMARY.md")).collect();
    assert_eq!(unique, written, "chapters of SUMMARY.md (left) and files (right)");
}

#[test]
fn links_resolve() {
    let root = root();
    let mut broken = Vec::new();
    let mut checked = 0;
    let mut look = |path: &Path, targets: Vec<String>| {
        for target in targets {
            // A bare anchor refers to the same page.
            let whole = if target.starts_with('#') { format!("{}{target}", path.display()) } else { target };
            checked += 1;
            if let Err(why) = check(&whole, path.parent().unwrap(), &root) {
                broken.push(format!("{}: {whole}: {why}", path.display()));
            }
        }
    };
    for path in below(&root, "md") {
        let (prose, _) = split(&text(&path));
        look(&path, links(&prose));
    }
    for path in below(&root.join("docs/report"), "html") {
        let targets = references(&text(&path)).into_iter().filter(|t| !t.starts_with('#')).collect();
        look(&path, targets);
    }
    assert!(checked > 100, "only {checked} links found");
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn programs_are_tested() {
    let root = root();
    let pages = text(&root.join("impactite/src/lib.rs"));
    for path in below(&root.join("docs/book/src"), "md") {
        let (_, blocks) = split(&text(&path));
        let has = blocks.iter().any(|b| b.starts_with("rust") && !b.contains("ignore"));
        let include = format!("include_str!(\"../../{}\")", path.strip_prefix(&root).unwrap().display());
        let included = pages.contains(&include);
        assert_eq!(
            has,
            included,
            "{}: has programs (left), is included by impactite/src/lib.rs (right)",
            path.display()
        );
    }
}

/// File names in the book, such as `tests/tests/step/books.rs`.
#[test]
fn files_that_the_book_names_exist() {
    let root = root();
    let folders: Vec<String> = fs::read_dir(&root)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_dir())
        .map(|path| path.file_name().unwrap().to_string_lossy().into_owned() + "/")
        .collect();
    let (mut missing, mut found) = (Vec::new(), 0);
    for path in below(&root.join("docs/book/src"), "md") {
        let (prose, _) = split(&text(&path));
        for span in prose.split('`').skip(1).step_by(2) {
            let is_path = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
            let output = span.starts_with("out/") || span.starts_with("target/");
            if span.chars().all(is_path) && folders.iter().any(|f| span.starts_with(f)) && !output {
                found += 1;
                if !root.join(span).exists() {
                    missing.push(format!("{}: {span}", path.display()));
                }
            }
        }
    }
    assert!(found > 30, "only {found} files found");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// Citation keys such as [Ma2010] are listed in REFERENCES.md.
#[test]
fn references_are_listed() {
    let root = root();
    let listed = text(&root.join("REFERENCES.md"));
    let mut missing = BTreeSet::new();
    for path in below(&root.join("docs/book/src"), "md") {
        let (prose, _) = split(&text(&path));
        for part in prose.replace('\\', "").split('[').skip(1) {
            let key = part.split(']').next().unwrap_or_default();
            let letters = key.trim_end_matches(|c: char| c.is_ascii_digit());
            let is_key = key.len() - letters.len() == 4
                && letters.starts_with(|c: char| c.is_ascii_alphabetic())
                && letters.chars().all(|c| c.is_ascii_alphabetic());
            if is_key && !listed.contains(&format!("[{key}]")) {
                missing.insert(format!("{}: [{key}]", path.display()));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

/// Comments cite headings as `book, "Heading"`.
#[test]
fn the_code_speaks_of_headings_that_exist() {
    let root = root();
    let mut known: BTreeMap<String, PathBuf> = BTreeMap::new();
    for path in below(&root.join("docs/book/src"), "md") {
        let (prose, _) = split(&text(&path));
        known.extend(headings(&prose).into_iter().map(|h| (h, path.clone())));
    }
    let (mut missing, mut found) = (Vec::new(), 0);
    for path in below(&root, "rs").into_iter().filter(|p| !p.ends_with("tests/book.rs")) {
        let code = text(&path).replace("\\\"", "\"");
        for rest in code.split("book, \"").skip(1) {
            // A heading may continue on the next line of a comment.
            let lines = rest.split('"').next().unwrap_or_default().lines();
            let plain = |line: &str| line.trim().trim_start_matches(['/', '!']).trim().to_string();
            let heading = lines.map(plain).collect::<Vec<_>>().join(" ");
            found += 1;
            if !known.contains_key(&heading) {
                missing.push(format!("{}: {heading}", path.display()));
            }
        }
    }
    assert!(found > 50, "only {found} references found");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}
