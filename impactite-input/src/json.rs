//! Positions of values in a JSON text, for errors.

use std::collections::HashSet;
use std::ops::Range;

/// Value of a JSON text, with its position.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Place {
    /// Key, as `bodies.rod.velocity[2]`; empty for the whole text.
    pub key: String,
    /// Byte range.
    pub span: Range<usize>,
    /// Reason for which scenes do not allow the value.
    pub wrong: Option<Wrong>,
}

/// JSON that scenes do not allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wrong {
    /// Duplicate key in an object.
    Twice,
    /// Value `null`.
    Null,
}

/// Return all values of a valid JSON text, parents before their children.
pub(crate) fn places(text: &str) -> Vec<Place> {
    let mut scan = Scan { text, at: 0, found: Vec::new() };
    scan.value(String::new(), None);
    scan.found
}

struct Scan<'a> {
    text: &'a str,
    at: usize,
    found: Vec<Place>,
}

impl Scan<'_> {
    fn next(&mut self) -> Option<u8> {
        let bytes = self.text.as_bytes();
        while bytes.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
        bytes.get(self.at).copied()
    }

    /// Scan a string from its opening quotation mark.
    fn string(&mut self) -> String {
        let (bytes, start) = (self.text.as_bytes(), self.at);
        self.at += 1;
        while bytes.get(self.at).is_some_and(|&b| b != b'"') {
            self.at += if bytes[self.at] == b'\\' { 2 } else { 1 };
        }
        self.at = (self.at + 1).min(bytes.len());
        serde_json::from_str(self.text.get(start..self.at).unwrap_or_default()).unwrap_or_default()
    }

    fn value(&mut self, key: String, wrong: Option<Wrong>) {
        let Some(first) = self.next() else { return };
        let (start, place) = (self.at, self.found.len());
        self.found.push(Place { key: key.clone(), span: start..start, wrong });
        match first {
            b'{' | b'[' => self.members(&key, first == b'{'),
            b'"' => {
                self.string();
            }
            _ => {
                let rest = &self.text[start..];
                self.at += rest
                    .find(|c: char| c == ',' || c == '}' || c == ']' || c.is_whitespace())
                    .unwrap_or(rest.len());
                if first == b'n' {
                    self.found[place].wrong = Some(Wrong::Null);
                }
            }
        }
        self.found[place].span.end = self.at;
    }

    fn members(&mut self, key: &str, named: bool) {
        self.at += 1;
        let mut names = HashSet::new();
        let mut number = 0;
        while let Some(next) = self.next() {
            match next {
                b'}' | b']' => {
                    self.at += 1;
                    return;
                }
                b',' => self.at += 1,
                _ if named => {
                    let name = self.string();
                    self.next();
                    self.at += 1;
                    let inner = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                    let twice = (!names.insert(name)).then_some(Wrong::Twice);
                    self.value(inner, twice);
                }
                _ => {
                    self.value(format!("{key}[{number}]"), None);
                    number += 1;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_found_by_their_keys() {
        let text = r#"{"a": 1, "b\"": [2, {"c": "x, }"}, null], "a": {}}"#;
        let found = places(text);
        let said: Vec<(&str, &str, Option<Wrong>)> =
            found.iter().map(|p| (&*p.key, &text[p.span.clone()], p.wrong)).collect();
        assert_eq!(
            said[1..],
            [
                ("a", "1", None),
                ("b\"", r#"[2, {"c": "x, }"}, null]"#, None),
                ("b\"[0]", "2", None),
                ("b\"[1]", r#"{"c": "x, }"}"#, None),
                ("b\"[1].c", "\"x, }\"", None),
                ("b\"[2]", "null", Some(Wrong::Null)),
                ("a", "{}", Some(Wrong::Twice)),
            ]
        );
        assert_eq!(found[0].span, 0..text.len());
    }
}
