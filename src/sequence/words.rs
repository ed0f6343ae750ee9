//! Decodes words that stand for values or begin them, and reports unknown names.

use super::fault::Fault;
use super::node::Node;
use super::suggest::{either, listed, nearest, shortened, synonym};

/// Words, each with the decoder of the values that start with it.
pub type Variants<'s, T> = [(&'static str, fn(Node<'s>) -> Option<T>)];

/// Decodes a value by its leading word.
pub fn variant<'s, T>(node: Node<'s>, what: &str, table: &Variants<'s, T>) -> Option<T> {
    let node = node.as_word();
    let known = table.iter().map(|(name, _)| *name);
    node.ask_words(what, known.clone());
    if node.word().is_empty() || is_literal(node.word()) {
        report_no_word(node, known);
        return None;
    }
    let Some((_, decode)) = table.iter().find(|(name, _)| *name == node.word()) else {
        report_unknown(node, what, node.word(), known.collect::<Vec<_>>());
        return None;
    };
    decode(node)
}

/// The leading word of a value, if it is one of `known`.
pub fn known_word(node: Node<'_>, what: &str, known: &'static [&'static str]) -> Option<&'static str> {
    let node = node.as_word();
    node.ask_words(what, known);
    if node.word().is_empty() || is_literal(node.word()) {
        report_no_word(node, known.iter().copied());
        return None;
    }
    let found = known.iter().copied().find(|name| *name == node.word());
    if found.is_none() {
        report_unknown(node, what, node.word(), known.iter().copied());
    }
    found
}

/// Reports a word in front of the brackets of a whole file.
pub fn report_word(root: Node<'_>) {
    if !root.word().is_empty() {
        let title = format!("expected ( ... ) around the whole file, without `{}` in front", root.word());
        root.fault(Fault::new(root.head(), title, "remove this word"));
    }
}

/// Reports a value without a word where one of `known` was expected.
fn report_no_word<'n>(node: Node<'_>, known: impl Iterator<Item = &'n str> + Clone) {
    let fault = node.mismatch(either(known.clone()));
    let quoted = node.is_text() && known.into_iter().any(|name| node.text().trim_matches('"') == name);
    node.fault(if quoted { fault.help("write it without quotes") } else { fault });
}

/// Decodes a word that stands for a value.
pub fn word<T: Copy>(node: Node<'_>, what: &str, table: &[(&'static str, T)]) -> Option<T> {
    let node = node.as_word();
    let known = table.iter().map(|(name, _)| *name);
    node.ask_words(what, known.clone());
    let Some(word) = node.bare_word() else {
        report_no_word(node, known);
        return None;
    };
    let found = table.iter().find(|(name, _)| *name == word).map(|(_, value)| *value);
    if found.is_none() {
        report_unknown(node, what, word, known.collect::<Vec<_>>());
    }
    found
}

/// A suggestion of the intended name. Each candidate is a name as it may be written, and the name to suggest for it.
pub fn suggestion<'n>(
    node: Node<'_>,
    wrong: &str,
    candidates: impl IntoIterator<Item = (&'n str, &'n str)>,
) -> String {
    // In files with this many faults, suggestions would take too long.
    let candidates = candidates.into_iter().take(if node.file.fault_count() < 1000 { usize::MAX } else { 0 });
    let candidates: Vec<_> = candidates.collect();
    let written = || candidates.iter().map(|(written, _)| *written);
    let meant = synonym(wrong, written()).or_else(|| nearest(wrong, written()));
    let name = candidates.iter().find(|(written, _)| Some(*written) == meant).map(|(_, name)| *name);
    name.map_or_else(|| "unknown".to_owned(), |name| format!("did you mean `{}`?", shortened(name)))
}

/// The fault of an unknown name at `node`, with a suggestion.
pub fn unknown<'n>(
    node: Node<'_>,
    what: &str,
    wrong: &str,
    known: impl IntoIterator<Item = &'n str>,
) -> Fault {
    let title = format!("there is no {what} `{}`", shortened(wrong));
    let span = if node.word().is_empty() { node.span() } else { node.head() };
    Fault::new(span, title, suggestion(node, wrong, known.into_iter().map(|name| (name, name))))
}

/// Reports an unknown name, and lists all known names.
pub fn report_unknown<'n, C>(node: Node<'_>, what: &str, wrong: &str, known: C)
where
    C: IntoIterator<Item = &'n str> + Clone,
{
    let all = listed(known.clone());
    // Only names of the entries of a section can be missing altogether.
    let help = match all.as_str() {
        "nothing" => format!("the section `{what}s` has no entries"),
        _ => format!("known here: {all}"),
    };
    node.fault(unknown(node, what, wrong, known).help(help));
}

/// Words of RON itself.
pub fn is_literal(word: &str) -> bool {
    matches!(word, "true" | "false" | "inf" | "NaN" | "None")
}
