//! Escaping of untrusted text for a terminal or a page.

use std::borrow::Cow;

/// Escape control characters and bidirectional marks of a text as `\u{1b}`. Line feeds
/// and tabs are kept; a carriage return before a line feed is dropped.
///
/// Titles, names and files are untrusted: they must not move the cursor, change colours, or hide a part of a line.
///
/// ```
/// use impactite_output::printable;
/// assert_eq!(printable("two\nlines, 20 µs"), "two\nlines, 20 µs");
/// assert_eq!(printable("\u{1b}[31mred\0"), "\\u{1b}[31mred\\u{0}");
/// ```
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.chars().any(steers) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(text.len() + 8);
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            // Windows line ending.
            '\r' if rest.peek() == Some(&'\n') => {}
            c if steers(c) => safe.extend(c.escape_unicode()),
            c => safe.push(c),
        }
    }
    Cow::Owned(safe)
}

/// True for control characters, and for marks of bidirectional text.
fn steers(c: char) -> bool {
    let turns =
        matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{61c}');
    (c.is_control() && c != '\n' && c != '\t') || turns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_steers_a_terminal() {
        for c in (0..=0x10_ffff).filter_map(char::from_u32).filter(|c| *c != '\n' && *c != '\t') {
            let shown = printable(c.encode_utf8(&mut [0; 4])).into_owned();
            assert!(!shown.chars().any(char::is_control), "{c:?}");
        }
        assert_eq!(printable("\u{202e}gpj.exe"), "\\u{202e}gpj.exe");
        assert_eq!(printable("one\r\ntwo\rthree"), "one\ntwo\\u{d}three");
        assert!(matches!(printable("Grüße, 漢字"), Cow::Borrowed(_)));
    }
}
