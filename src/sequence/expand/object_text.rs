//! Rewrites the fields of an object: shifted from copy to copy, or as a part of a template.

use super::super::fault::Fault;
use super::super::node::{Node, NodeContent};
use super::super::values::text;
use super::count::Steps;
use super::expression::Expression;
use super::parts::{Part, is_expression};
use super::source::quoted;
use super::state::{Context, State};
use super::template::{TEMPLATE, WITH};

/// The text of an object with changed fields.
pub struct ObjectText<'o, 's> {
    pub state: &'o State<'s>,
    pub node: Node<'s>,
    pub fields: &'o [(&'s str, Node<'s>)],
    pub context: &'o Context<'o>,
}

impl<'s> ObjectText<'_, 's> {
    /// The parts of the object: shifted from copy to copy, below the group of its template, and as the group of its own
    /// template.
    pub fn parts(&self, shift: Option<&Steps>, is_group: bool) -> Option<Vec<Part<'s>>> {
        let (node, file) = (self.node, self.node.file);
        let made = |text: String| Part::Made(text, node.head());
        let has = |name| self.fields.iter().any(|(found, _)| *found == name);
        let mut parts = vec![made("(".to_owned())];
        if is_group {
            parts.push(made("shape: Group, ".to_owned()));
        }
        if let (Some(group), false) = (self.context.group, has("parent")) {
            parts.push(made(format!("parent: {}, ", quoted(group))));
        }
        if let Some(shift) = shift {
            if let Some((name, _)) = self.fields.iter().find(|(name, _)| *name == "poses") {
                let fault = Fault::new(
                    shift.place.clone(),
                    "`step` cannot move objects with `poses`",
                    "one too many",
                );
                node.fault(fault.also(file.span_of(name), "the places of the object are given here"));
                return None;
            }
            if !has("translation") {
                parts.extend(shift.translation());
            }
        }
        let mut separator = "";
        for (name, value) in
            self.fields.iter().filter(|(name, _)| !is_group || ![TEMPLATE, WITH].contains(name))
        {
            let start = file.span_of(name).start;
            parts.push(made(separator.to_owned()));
            separator = ", ";
            let (from, to) = (start - node.span().start, value.span().start - node.span().start);
            match (*name, shift) {
                ("parent", _) => {
                    parts.push(Part::Copy(&node.text()[from..to], start));
                    self.parent(*value, &mut parts);
                }
                ("translation", Some(shift)) => {
                    parts.push(Part::Copy(&node.text()[from..to], start));
                    self.shifted(*value, shift, &mut parts)?;
                }
                _ => {
                    let text = &node.text()[from..to + value.text().len()];
                    parts.extend(self.state.parts_of(text, start, self.context.used));
                }
            }
        }
        parts.push(made(")".to_owned()));
        parts.retain(|part| !matches!(part, Part::Made(text, _) if text.is_empty()));
        Some(parts)
    }

    /// The parent of an object of a template is another object of it.
    fn parent(&self, node: Node<'s>, parts: &mut Vec<Part<'s>>) {
        match self.context.group {
            Some(_) if node.is_text() && !is_expression(node.text()) => {
                if let Some(name) = text(node) {
                    parts.push(Part::Made(quoted(&self.context.full_name(&name)), node.span()));
                }
            }
            _ => parts.extend(self.state.parts(node, self.context.used)),
        }
    }

    /// A constant or keyed translation, shifted from copy to copy.
    fn shifted(&self, node: Node<'s>, shift: &Steps, parts: &mut Vec<Part<'s>>) -> Option<()> {
        let (text, start) = (node.text(), node.span().start);
        let vectors = vectors(node)?;
        let mut at = 0;
        for coordinates in vectors {
            for (axis, coordinate) in coordinates.into_iter().enumerate() {
                let place = coordinate.span();
                let value = self.operand(coordinate)?;
                parts.extend(self.state.parts_of(
                    &text[at..place.start - start],
                    start + at,
                    self.context.used,
                ));
                parts.push(Part::Value(shift.coordinate(axis, value), place.clone()));
                at = place.end - start;
            }
        }
        parts.extend(self.state.parts_of(&text[at..], start + at, self.context.used));
        Some(())
    }

    fn operand(&self, node: Node<'s>) -> Option<Expression> {
        let operand = self.state.operand(node, self.context.used);
        if operand.is_none() && !is_expression(node.text()) {
            node.expected("a number");
        }
        operand
    }
}

/// The coordinates of a constant vector, or of the vectors of all keys.
fn vectors<'s>(node: Node<'s>) -> Option<Vec<Vec<Node<'s>>>> {
    let wrong = || {
        let fault = node.mismatch("numbers (x, y, z), or keys of them");
        node.fault(fault.help("`step` adds to each coordinate, so all of them must be written here"));
    };
    let values = match (node.content()?, node.word()) {
        (NodeContent::Tuple(items), "") if items.len() == 3 => return Some(vec![items]),
        (NodeContent::List(keys), "") => keys.into_iter().map(key_value).collect::<Option<Vec<_>>>(),
        (NodeContent::Fields(fields), "Track") => {
            return match fields.into_iter().find(|(name, _)| *name == "keys") {
                Some((_, keys)) => vectors(keys),
                // The decoder reports that they are missing.
                None => Some(Vec::new()),
            };
        }
        _ => None,
    };
    let Some(values) = values else {
        wrong();
        return None;
    };
    let vectors: Vec<_> = values.into_iter().map(vectors).collect();
    vectors.into_iter().collect::<Option<Vec<_>>>().map(|vectors| vectors.concat())
}

/// The value of a key: `(time, value)`, with or without an easing, or `(t: time, v: value)`.
fn key_value<'s>(node: Node<'s>) -> Option<Node<'s>> {
    match node.content()? {
        NodeContent::Tuple(items) if node.word().is_empty() => items.get(1).copied(),
        NodeContent::Fields(fields) => {
            fields.into_iter().find(|(name, _)| *name == "v").map(|(_, value)| value)
        }
        _ => None,
    }
}
