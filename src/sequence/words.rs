//! Words that stand for values or start them, and names that nothing goes by.

use super::fault::Fault;
use super::node::Node;
use super::suggest::{either, listed, nearest, shortened};

/// Words and the decoders of the values that start with them.
pub type Variants<'s, T> = [(&'static str, fn(Node<'s>) -> Option<T>)];

/// Decodes a value that starts with a word by the decoder of that word.
pub fn variant<'s, T>(node: Node<'s>, what: &str, table: &Variants<'s, T>) -> Option<T> {
    let known = table.iter().map(|(name, _)| *name);
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

/// The word that a value starts with, if it is one of `known`.
pub fn known_word(node: Node<'_>, what: &str, known: &'static [&'static str]) -> Option<&'static str> {
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

/// Reports a value where one of a few words was expected.
fn report_no_word<'n>(node: Node<'_>, known: impl Iterator<Item = &'n str> + Clone) {
    let fault = node.mismatch(either(known.clone()));
    let quoted = node.is_text() && known.into_iter().any(|name| node.text().trim_matches('"') == name);
    node.fault(if quoted { fault.help("write it without quotes") } else { fault });
}

/// Decodes a word that stands for a value.
pub fn word<T: Copy>(node: Node<'_>, what: &str, table: &[(&'static str, T)]) -> Option<T> {
    let known = table.iter().map(|(name, _)| *name);
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

/// Which name may have been meant.
pub fn suggestion<'n>(node: Node<'_>, wrong: &str, candidates: impl IntoIterator<Item = &'n str>) -> String {
    // A file with this many faults needs something else than suggestions, which take their time.
    let meant = if node.file.fault_count() < 1000 { nearest(wrong, candidates) } else { None };
    meant.map_or_else(|| "unknown".to_owned(), |name| format!("did you mean `{}`?", shortened(name)))
}

/// The fault of an unknown name at `node`, with the nearest of the known ones.
pub fn unknown<'n>(
    node: Node<'_>,
    what: &str,
    wrong: &str,
    known: impl IntoIterator<Item = &'n str>,
) -> Fault {
    let title = format!("there is no {what} `{}`", shortened(wrong));
    let span = if node.word().is_empty() { node.span() } else { node.head() };
    Fault::new(span, title, suggestion(node, wrong, known))
}

/// Reports an unknown name together with all that are known.
pub fn report_unknown<'n, C>(node: Node<'_>, what: &str, wrong: &str, known: C)
where
    C: IntoIterator<Item = &'n str> + Clone,
{
    let all = listed(known.clone());
    let help =
        if all == "nothing" { format!("the file has no {what}") } else { format!("known here: {all}") };
    node.fault(unknown(node, what, wrong, known).help(help));
}

/// Words of the notation itself.
pub fn is_literal(word: &str) -> bool {
    matches!(word, "true" | "false" | "inf" | "NaN" | "None")
}
