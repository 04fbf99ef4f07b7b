//! Scene files that are wrong: each gives an error with its place, and none a panic.

use std::collections::BTreeMap;
use std::panic::catch_unwind;

use impactite_input::{InputError, Source};

/// A generator of numbers (splitmix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self, below: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % below as u64) as usize
    }
    fn of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.next(list.len())]
    }
}

fn scenes() -> Vec<(String, String)> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let mut list = Vec::new();
    for entry in std::fs::read_dir(folder).expect("the folder `scenes`") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|e| e == "toml") {
            list.push((path.display().to_string(), std::fs::read_to_string(&path).expect("a text")));
        }
    }
    list.sort();
    list
}

/// What replaces a value.
const VALUES: &[&str] = &[
    "-1",
    "0",
    "1e300",
    "nan",
    "inf",
    "true",
    "\"\"",
    "\"7 parsecs/fortnight\"",
    "\"3 kg\"",
    "\"= x *\"",
    "\"= speed + q\"",
    "[]",
    "{}",
    "\"10^10^10 m\"",
    "[1, 2]",
    "[1, 2, 3, 4]",
    "\"none\"",
    "1979-05-27",
    "\"-190 m/s\"",
    "\"1 um\"",
    "\"éß\"",
    "'''a\nb'''",
];

fn mutated(text: &str, numbers: &mut Numbers) -> String {
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    let n = numbers.next(lines.len());
    match numbers.next(9) {
        0 => drop(lines.remove(n)),
        1 => lines.insert(n, lines[n].clone()),
        2 => {
            if let Some((key, _)) = lines[n].split_once('=') {
                lines[n] = format!("{key}= {}", numbers.of(VALUES));
            }
        }
        // A letter fewer, or another one, in the first word.
        3 | 4 => {
            let letters: Vec<usize> =
                lines[n].char_indices().filter(|(_, c)| c.is_alphabetic()).map(|(i, _)| i).collect();
            if let Some(&at) = letters.get(numbers.next(letters.len().max(1))) {
                let with = if numbers.next(2) == 0 { "" } else { "q" };
                let next = lines[n][at..].chars().next().map_or(1, char::len_utf8);
                lines[n].replace_range(at..at + next, with);
            }
        }
        5 => {
            // A digit becomes another one, or a sign.
            let digits: Vec<usize> =
                lines[n].char_indices().filter(|(_, c)| c.is_ascii_digit()).map(|(i, _)| i).collect();
            if let Some(&at) = digits.get(numbers.next(digits.len().max(1))) {
                let with = *numbers.of(&["-", "0", "9", "e", "."]);
                lines[n].replace_range(at..=at, with);
            }
        }
        6 => {
            let units = [" mm", " m/s", " us", " MPa", " kg", " K"];
            let (from, to) = (*numbers.of(&units), *numbers.of(&units));
            lines[n] = lines[n].replace(from, to);
        }
        7 => {
            let at = numbers.next(lines[n].chars().count() + 1);
            let at = lines[n].char_indices().nth(at).map_or(lines[n].len(), |(i, _)| i);
            let with = *numbers.of(&["\"", "[", "]", "{", "}", "=", "#", ",", "."]);
            lines[n].insert_str(at, with);
        }
        _ => lines.truncate(n),
    }
    lines.join("\n") + "\n"
}

/// The kind of an error, for the table.
fn kind(message: &str) -> &'static str {
    let kinds = [
        ("no TOML", "no TOML"),
        ("too many operations", "a quantity, its unit or measure"),
        ("are allowed", "a quantity, its unit or measure"),
        ("unknown field", "a key that there is not"),
        ("unknown variant", "a word that there is not"),
        ("missing field", "a key that is missing"),
        ("invalid type", "another kind of value"),
        ("invalid length", "another kind of value"),
        ("invalid value", "another kind of value"),
        ("wanted", "another kind of value"),
        ("is no formula", "a formula"),
        ("is no ", "a quantity, its unit or measure"),
        ("unknown identifier", "a quantity, its unit or measure"),
        ("has the name", "a name that there is not"),
        ("components", "a number of components"),
        ("there is no axis", "an axis that there is not"),
        ("is not allowed", "a value out of its range"),
    ];
    kinds.iter().find(|(start, _)| message.contains(start)).map_or("what does not go together", |k| k.1)
}

/// The seed and the number of wrong files: 39 and 1000, or `IMPACTITE_MUTATIONS=SEED,COUNT`.
fn seed_and_count() -> (u64, usize) {
    let said = std::env::var("IMPACTITE_MUTATIONS").unwrap_or_default();
    let numbers =
        said.split_once(',').and_then(|(seed, count)| Some((seed.parse().ok()?, count.parse().ok()?)));
    numbers.unwrap_or((39, 1000))
}

#[test]
fn a_thousand_wrong_files_give_each_an_error_with_its_place() {
    let scenes = scenes();
    let (seed, most) = seed_and_count();
    let mut numbers = Numbers(seed);
    let mut table: BTreeMap<&str, (usize, String)> = BTreeMap::new();
    let (mut wrong, mut right, mut placed) = (0, 0, 0);
    while wrong < most {
        let (name, text) = numbers.of(&scenes);
        let text = mutated(text, &mut numbers);
        let source = Source::new(name.clone(), text.clone());
        // Setting up a scene of a million particles is no error, and takes its time: what parses is set up where it is small.
        let read = catch_unwind(|| match source.parse() {
            Ok(scene) if wrong % 8 == 0 || scene.bodies.is_empty() => {
                source.build(&scene).and_then(|mut solver| source.estimate(&scene, &mut *solver)).map(|_| ())
            }
            other => other.map(|_| ()),
        });
        match read {
            Err(_) => panic!("a panic by {name}:\n{text}"),
            Ok(Ok(())) => right += 1,
            Ok(Err(error)) => {
                wrong += 1;
                let InputError::At(fault) = &error else { panic!("{error} has no place:\n{text}") };
                assert!(!fault.message.is_empty(), "{text}");
                placed += usize::from(fault.line.is_some());
                let entry = table.entry(kind(&fault.message)).or_insert((0, fault.to_string()));
                entry.0 += 1;
            }
        }
        assert!(right < 4 * most, "mutations that change nothing");
    }
    for (kind, (count, example)) in &table {
        println!("{count:4} {kind}\n{example}\n");
    }
    println!("{wrong} wrong, {placed} with a line; {right} still scenes");
    // A file that was cut may lack a key as a whole: there is no line to show.
    assert!(placed * 100 >= wrong * 90, "{placed} of {wrong}");
    assert!(table.len() >= 8, "{table:?}");
}
