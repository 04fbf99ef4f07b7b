//! Suggestions for misspelt keys and words.

use crate::keys;

/// Maximum number of keys in a suggestion.
const NAMED: usize = 3;

/// Return a message of serde and a suggestion: the key or word most similar to the unknown one, or the paths of keys with this name.
pub(crate) fn helped(message: &str) -> (String, Option<String>) {
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let unknown = ["unknown field", "unknown variant"].iter().any(|start| message.starts_with(start));
    let (Some((&wrong, right)), true) = (names.split_first(), unknown) else { return (message.into(), None) };
    let alike = near(wrong, right.iter().copied()).map(|name| format!("did you mean `{name}`?"));
    (message.into(), alike.or_else(|| elsewhere(wrong)))
}

/// Return the paths of keys with this name.
fn elsewhere(name: &str) -> Option<String> {
    let mut paths: Vec<String> = keys::all().into_iter().map(|key| key.path).collect();
    paths.retain(|path| path.rsplit('.').next() == Some(name));
    paths.sort_by_cached_key(|path| (path.matches('.').count(), path.clone()));
    paths.dedup();
    paths.truncate(NAMED);
    let list = paths.iter().map(|path| format!("`{path}`")).collect::<Vec<_>>().join(", ");
    (!list.is_empty()).then(|| format!("`{name}` is a key elsewhere: {list}"))
}

/// Return the most similar name, if it is close enough.
pub(crate) fn near<'a>(wrong: &str, right: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let alike = |name: &&str| strsim::damerau_levenshtein(&wrong.to_lowercase(), &name.to_lowercase());
    let best = right.into_iter().min_by_key(alike)?;
    (alike(&best) <= 1 + wrong.chars().count() / 4).then_some(best)
}
