//! Rewrites the fields of an object: shifted from copy to copy, or as a part of a template.

use super::super::fault::Fault;
use super::super::node::{Node, NodeContent};
use super::super::shape::INSTANCES;
use super::super::values::text;
use super::count::Steps;
use super::expression::Expression;
use super::object_source::ObjectSource;
use super::parts::{Part, is_expression};
use super::source::quoted_value;
use super::state::{Context, Meaning, State};
use super::template::{TEMPLATE, WITH};
use std::collections::HashSet;
use std::ops::Range;

/// The name of the object that instances show.
fn object_of_instances(shape: Node<'_>) -> Option<Node<'_>> {
    if shape.word() != INSTANCES {
        return None;
    }
    let Some(NodeContent::Fields(fields)) = shape.content() else { return None };
    fields.into_iter().find(|(name, _)| *name == "of").map(|(_, name)| name)
}

/// The text of an object with changed fields.
pub struct ObjectText<'o, 's> {
    pub state: &'o State<'s>,
    pub node: Node<'o>,
    pub fields: &'o [(&'o str, Node<'o>)],
    pub source: &'o ObjectSource,
    pub context: &'o Context<'o>,
}

impl<'s> ObjectText<'_, 's> {
    /// The parts of the object: shifted from copy to copy, below the group of its template, and as the group of its own
    /// template.
    pub fn parts(&self, shift: Option<&Steps>, is_group: bool) -> Option<Vec<Part<'s>>> {
        let (node, file) = (self.node, self.node.file);
        let head = self.source.place(node.head());
        let made = |text: String| Part::Made(text, head.clone());
        let has = |name| self.fields.iter().any(|(found, _)| *found == name);
        let mut parts = vec![made("(".to_owned())];
        if is_group {
            parts.push(made("shape: Group, ".to_owned()));
        }
        if let (Some(group), false) = (self.context.group, has("parent")) {
            parts.push(made(format!("parent: {}, ", quoted_value(group))));
        }
        if let Some(shift) = shift {
            if let Some((name, _)) = self.fields.iter().find(|(name, _)| *name == "poses") {
                let title = "`step` cannot move objects with `poses`";
                let fault = Fault::new(shift.place.clone(), title, "one too many");
                let poses = self.source.place(file.span_of(name));
                let fault = fault.also(poses, "the places of the object are given here");
                self.state.fault(fault, self.context.used);
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
            let (start, place) = (file.span_of(name).start, value.span());
            parts.push(made(separator.to_owned()));
            separator = ", ";
            match (*name, shift) {
                ("parent", _) => {
                    parts.extend(self.copied(start..place.start));
                    parts.extend(self.parent(*value)?);
                }
                ("shape", _) if let Some(of) = object_of_instances(*value) => {
                    parts.extend(self.copied(start..of.span().start));
                    parts.extend(self.parent(of)?);
                    parts.extend(self.copied(of.span().end..place.end));
                }
                ("translation", Some(shift)) => {
                    parts.extend(self.copied(start..place.start));
                    parts.extend(self.translation(*value, shift)?);
                }
                _ => parts.extend(self.copied(start..place.end)),
            }
        }
        parts.push(made(")".to_owned()));
        parts.retain(|part| !matches!(part, Part::Made(text, _) if text.is_empty()));
        Some(parts)
    }

    /// The parts of a place of the text.
    fn copied(&self, span: Range<usize>) -> Vec<Part<'s>> {
        self.source.parts(self.state, span, self.context)
    }

    /// The parent of an object of a template is another object of it, and so is what its instances show. A value may also
    /// name one of the whole sequence.
    fn parent(&self, node: Node<'_>) -> Option<Vec<Part<'s>>> {
        let as_written = || Some(self.copied(node.span()));
        let (Some(_), Some(open)) = (self.context.group, self.context.open) else { return as_written() };
        let (name, is_written) = match (self.state.meaning(node, self.context), self.source) {
            (Meaning::Faulty, _) => return None,
            (Meaning::Value(value), _) => {
                (self.state.decoded(value, "parent", &node.span(), self.context, text)?, false)
            }
            (Meaning::Itself, _) if !node.is_text() || is_expression(node.text()) => return as_written(),
            (Meaning::Itself, source) => (text(node)?, matches!(source, ObjectSource::File)),
        };
        if !is_written && !names_one_of(&name, open.objects) {
            return as_written();
        }
        let place = self.source.place(node.span());
        Some(vec![Part::Made(quoted_value(&self.context.full_name(&name)), place)])
    }

    /// A constant or keyed translation, shifted from copy to copy.
    fn translation(&self, node: Node<'_>, shift: &Steps) -> Option<Vec<Part<'s>>> {
        match self.state.meaning(node, self.context) {
            Meaning::Itself => self.shifted(node, self.source, shift),
            Meaning::Value(value) => {
                let source = ObjectSource::Value(value.clone(), node.span());
                let shifted = |node: Node<'_>| self.shifted(node, &source, shift);
                self.state.decoded(value, "translation", &node.span(), self.context, shifted)
            }
            Meaning::Faulty => None,
        }
    }

    fn shifted(&self, node: Node<'_>, source: &ObjectSource, shift: &Steps) -> Option<Vec<Part<'s>>> {
        let mut parts = Vec::new();
        let vectors = vectors(node)?;
        let mut at = node.span().start;
        for coordinates in vectors {
            for (axis, coordinate) in coordinates.into_iter().enumerate() {
                let place = coordinate.span();
                let value = self.operand(coordinate)?;
                parts.extend(source.parts(self.state, at..place.start, self.context));
                at = place.end;
                parts.push(Part::Value(shift.coordinate(axis, value), source.place(place)));
            }
        }
        parts.extend(source.parts(self.state, at..node.span().end, self.context));
        Some(parts)
    }

    fn operand(&self, node: Node<'_>) -> Option<Expression> {
        let operand = self.state.operand(node, self.context.used);
        if operand.is_none() && !is_expression(node.text()) {
            node.expected("a number");
        }
        operand
    }
}

/// Whether a name is that of an object of a template, of a copy of it, or of an object below it.
fn names_one_of(name: &str, objects: &HashSet<String>) -> bool {
    let ends = name.match_indices(['[', '/']).map(|(at, _)| at).chain([name.len()]);
    ends.into_iter().any(|end| objects.contains(&name[..end]))
}

/// The coordinates of a constant vector, or of the vectors of all keys.
fn vectors(node: Node<'_>) -> Option<Vec<Vec<Node<'_>>>> {
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
fn key_value(node: Node<'_>) -> Option<Node<'_>> {
    match node.content()? {
        NodeContent::Tuple(items) if node.word().is_empty() => items.get(1).copied(),
        NodeContent::Fields(fields) => {
            fields.into_iter().find(|(name, _)| *name == "v").map(|(_, value)| value)
        }
        _ => None,
    }
}
