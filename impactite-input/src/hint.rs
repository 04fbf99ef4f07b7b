//! Hints at what was probably meant.

use crate::keys;

/// Keys elsewhere that a hint names at most.
const NAMED: usize = 3;

/// A message of serde, and what was probably meant: the key or word most like the unknown one, or the keys of this name that stand elsewhere.
pub(crate) fn helped(message: &str) -> (String, Option<String>) {
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let unknown = ["unknown field", "unknown variant"].iter().any(|start| message.starts_with(start));
    let (Some((&wrong, right)), true) = (names.split_first(), unknown) else { return (message.into(), None) };
    let alike = near(wrong, right.iter().copied()).map(|name| format!("did you mean `{name}`?"));
    (message.into(), alike.or_else(|| elsewhere(wrong)))
}

/// Where keys of this name stand.
fn elsewhere(name: &str) -> Option<String> {
    let mut paths: Vec<String> = keys::all().into_iter().map(|key| key.path).collect();
    paths.retain(|path| path.rsplit('.').next() == Some(name));
    paths.sort_by_cached_key(|path| (path.matches('.').count(), path.clone()));
    paths.dedup();
    paths.truncate(NAMED);
    let list = paths.iter().map(|path| format!("`{path}`")).collect::<Vec<_>>().join(", ");
    (!list.is_empty()).then(|| format!("`{name}` is a key elsewhere: {list}"))
}

/// The name that is most like another one, if it is much.
pub(crate) fn near<'a>(wrong: &str, right: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let alike = |name: &&str| strsim::damerau_levenshtein(&wrong.to_lowercase(), &name.to_lowercase());
    let best = right.into_iter().min_by_key(alike)?;
    (alike(&best) <= 1 + wrong.chars().count() / 4).then_some(best)
}
