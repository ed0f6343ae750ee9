//! Decodes colours in all notations.

use super::keys::keyed;
use super::node::Node;
use super::suggest::listed;
use super::values::{between, each, not_negative, number, text, tuple};
use super::words::{Variants, is_literal, unknown, variant};
use crate::base::color::{Rgb, hex_color, srgb_to_linear};
use crate::track::Animated;

const WAYS: &str =
    "colours are (r, g, b), one number for grey, \"#rrggbb\", Srgb(r, g, b) or Linear8(r, g, b)";

/// Decodes a colour over time, or a value that starts with one of the table's words.
pub fn color_or<'s, T: From<Animated<Rgb>>>(
    node: Node<'s>,
    what: &str,
    table: &Variants<'s, T>,
) -> Option<T> {
    let node = node.as_word();
    let known = table.iter().map(|(word, _)| *word);
    node.ask_words(what, known.clone());
    let is_color = ["Srgb", "Linear8", "Track"].into_iter().any(|word| node.begins_with(word));
    if is_color || node.word().is_empty() || is_literal(node.word()) {
        return keyed(color)(node).map(T::from);
    }
    if known.clone().any(|word| word == node.word()) {
        return variant(node, what, table);
    }
    let help = format!("besides colours there are {}", listed(known.clone()));
    node.fault(unknown(node, what, node.word(), known).help(help).help(WAYS));
    None
}

/// A linear colour without negative components.
pub fn color(node: Node<'_>) -> Option<Rgb> {
    if node.begins_with("Srgb") {
        return codes(node, "Srgb(r, g, b) with three numbers from 0 to 255", srgb_to_linear);
    }
    if node.begins_with("Linear8") {
        return codes(node, "Linear8(r, g, b) with three numbers from 0 to 255", |shown| shown);
    }
    match node.word() {
        "" if node.is_text() => hex(node),
        "" if node.opens_with('(') => {
            let parts = each(tuple(node, "a colour (red, green, blue)")?, not_negative)?;
            Some(Rgb::from_array(parts.map(|part| part as f32)))
        }
        "" if !node.opens_with('[') && !node.opens_with('{') => {
            number(node).and_then(|_| not_negative(node)).map(|grey| Rgb::splat(grey as f32))
        }
        _ => {
            node.fault(node.mismatch("a colour").help(WAYS));
            None
        }
    }
}

/// Three codes of 0..=255, scaled to 0..=1 and decoded.
fn codes(node: Node<'_>, what: &str, decode: impl Fn(f64) -> f64) -> Option<Rgb> {
    let parts = each(tuple(node, what)?, between(0.0..=255.0))?;
    Some(Rgb::from_array(parts.map(|code| decode(code / 255.0) as f32)))
}

/// `"#rrggbb"` or `"#rgb"`, in sRGB.
fn hex(node: Node<'_>) -> Option<Rgb> {
    let text = text(node)?;
    let color = hex_color(&text);
    if color.is_none() {
        node.fault(node.mismatch("a colour such as \"#ff8800\" or \"#f80\"").help(WAYS));
    }
    color
}
