//! Values of the file as text with a place, decoded level by level.
//!
//! ron parses everything. Nested values stay raw text that is borrowed from the source. So every value keeps its
//! place, and a wrong value does not stop the others from being decoded.

use super::fault::Fault;
use super::json;
use super::outline;
use super::raw_value::{ContentVisitor, MapVisitor, RawContent};
use super::schema::Ask;
use super::source_file::{File, Form};
use super::suggest::shortened;
use ron::value::RawValue;
use serde::de::{Deserialize, Deserializer, IgnoredAny};
use std::ops::Range;

/// A value: its text without surrounding blanks, split into a leading word and the rest.
#[derive(Clone, Copy)]
pub struct Node<'s> {
    pub file: &'s File<'s>,
    text: &'s str,
    word: &'s str,
    body: &'s str,
}

/// The content of a value, one level deep.
pub enum NodeContent<'s> {
    /// `(a: 1, b: 2)`
    Fields(Vec<(&'s str, Node<'s>)>),
    /// `(1, 2)`
    Tuple(Vec<Node<'s>>),
    /// `[1, 2]`
    List(Vec<Node<'s>>),
    /// `{ "a": 1, "b": 2 }`
    Map(Vec<(Node<'s>, Node<'s>)>),
    /// A number, a text or a single word.
    Plain,
}

impl File<'_> {
    /// The whole file as one value. Its syntax has been checked.
    pub fn root(&self) -> Node<'_> {
        match outline::trimmed(self.source).filter(|_| self.is_common) {
            Some(text) => Node::of_text(self, text),
            None => Node::new(self, self.source),
        }
    }
}

impl<'s> Node<'s> {
    fn new(file: &'s File<'s>, raw: &'s str) -> Self {
        Self::of_text(file, without_blanks(raw))
    }

    /// A value without surrounding blanks.
    fn of_text(file: &'s File<'s>, text: &'s str) -> Self {
        if file.is_json
            && text.starts_with('{')
            && let Some((word, body)) = json::leading_word(text)
        {
            return Self { file, text, word, body };
        }
        let (word, body) = split_word(text);
        let text = if body.is_empty() { word } else { text };
        Self { file, text, word, body }
    }

    pub fn text(&self) -> &'s str {
        self.text
    }

    pub fn span(&self) -> Range<usize> {
        self.file.span_of(self.text)
    }

    /// The leading word or, without one, the opening bracket.
    pub fn head(&self) -> Range<usize> {
        if !self.word.is_empty() {
            return self.file.span_of(self.word);
        }
        let start = self.span().start;
        start..start + self.text.chars().next().map_or(0, char::len_utf8)
    }

    /// `Sphere` in `Sphere(radius: 2)`. Empty if the value has no word.
    pub fn word(&self) -> &'s str {
        self.word
    }

    /// The word if the value consists of it alone.
    pub fn bare_word(&self) -> Option<&'s str> {
        (self.body.is_empty() && !self.word.is_empty()).then_some(self.word)
    }

    /// The value where no text can stand: in JSON, a text that looks like a word is one.
    pub fn as_word(self) -> Self {
        let inner = self.text.strip_prefix('"').and_then(|text| text.strip_suffix('"'));
        match inner.filter(|inner| self.file.is_json && json::is_word(inner)) {
            Some(word) => {
                self.note_form(Form::Word);
                Self { word, body: "", ..self }
            }
            None => self,
        }
    }

    /// Whether the value begins with a bracket. In JSON, `{` also begins what RON writes `(name: value)`, and `[` begins
    /// a tuple if [`json::is_tuple`] says so.
    pub fn opens_with(&self, bracket: char) -> bool {
        if !self.file.is_json {
            return self.word.is_empty() && self.text.starts_with(bracket);
        }
        match (bracket, self.text.chars().next()) {
            // A map may have a single entry, whose name looks like a word.
            ('{', Some('{')) => true,
            ('(', Some('{')) => self.word.is_empty(),
            ('(', Some('[')) => json::is_tuple(&self.json_items()),
            ('[', Some('[')) => !json::is_tuple(&self.json_items()),
            (bracket, first) => self.word.is_empty() && first == Some(bracket),
        }
    }

    fn json_items(&self) -> Vec<Node<'s>> {
        match self.read_bracket(self.text) {
            Ok(NodeContent::List(items)) => items,
            _ => Vec::new(),
        }
    }

    /// Notes what a decoder takes a value of a JSON file for.
    pub fn note_form(&self, form: Form) {
        if self.file.is_json {
            self.file.note_form(self.span().start, form);
        }
    }

    /// Notes what a decoder accepts here, for the schema. Whoever looks at a value itself instead of calling the decoders
    /// of `values`, `words`, `fields`, `names` and `keys` must say so.
    pub fn ask(&self, ask: impl FnOnce() -> Ask) {
        if let Some(watch) = &self.file.watch {
            watch.note(self.span().start, ask);
        }
    }

    /// Notes that a decoder accepts these words, alone or in front of brackets.
    pub fn ask_words<W: AsRef<str>>(&self, what: &str, words: impl IntoIterator<Item = W>) {
        if self.file.watch.is_some() {
            for word in words {
                self.ask(|| Ask::Word { what: what.to_owned(), word: word.as_ref().to_owned() });
            }
        }
    }

    /// Whether the value begins with a word that the decoder accepts.
    pub fn begins_with(&self, word: &str) -> bool {
        self.ask_words("", [word]);
        self.word == word
    }

    /// The entries of a map.
    pub fn map(&self) -> Option<Vec<(Node<'s>, Node<'s>)>> {
        if self.file.is_json && self.text.starts_with('{') {
            return match self.read_bracket(self.text) {
                Ok(NodeContent::Map(entries)) => Some(entries),
                _ => None,
            };
        }
        match self.content()? {
            NodeContent::Map(entries) if self.word.is_empty() => Some(entries),
            _ => None,
        }
    }

    pub fn is_text(&self) -> bool {
        if !self.file.is_json && !self.word.is_empty() {
            self.file.note_form(self.span().start, Form::WordOrText);
        }
        self.word.is_empty() && (self.text.starts_with('"') || self.text.starts_with('r'))
    }

    /// Decodes one level of the value.
    pub fn content(&self) -> Option<NodeContent<'s>> {
        match self.read() {
            Ok(content) => Some(content),
            // The syntax is already checked. If ron still fails, report it.
            Err(error) => {
                self.fault(Fault::new(self.span(), "this cannot be read", error.to_string()));
                None
            }
        }
    }

    fn read(&self) -> Result<NodeContent<'s>, ron::Error> {
        let content =
            match self.file.is_json && !self.word.is_empty() && !self.body.starts_with(['{', '[', '(']) {
                // The only part of what RON writes `Word(part)`.
                true if !self.body.is_empty() => {
                    return Ok(NodeContent::Tuple(vec![Node::of_text(self.file, self.body)]));
                }
                _ => self.read_bracket(self.body)?,
            };
        if !self.file.is_json {
            return Ok(content);
        }
        let content = match content {
            NodeContent::Map(_) if !self.word.is_empty() && json::leading_word(self.body).is_some() => {
                NodeContent::Tuple(vec![Node::of_text(self.file, self.body)])
            }
            NodeContent::Map(entries) => NodeContent::Fields(
                entries.into_iter().map(|(key, value)| (json::name(key.text), value)).collect(),
            ),
            NodeContent::List(items) if !self.word.is_empty() || json::is_tuple(&items) => {
                NodeContent::Tuple(items)
            }
            content => content,
        };
        match content {
            _ if !self.word.is_empty() => {}
            NodeContent::Fields(_) => self.note_form(Form::Fields),
            NodeContent::Tuple(_) => self.note_form(Form::LikelyTuple),
            NodeContent::List(_) => self.note_form(Form::LikelyList),
            _ => {}
        }
        Ok(content)
    }

    /// Reads a text that begins with a bracket, as RON.
    fn read_bracket(&self, body: &'s str) -> Result<NodeContent<'s>, ron::Error> {
        if self.file.is_common
            && let Some(entries) = outline::entries(body)
        {
            return Ok(self.of_entries(body, entries));
        }
        let node = |raw: &'s RawValue| Node::new(self.file, raw.get_ron());
        let mut reader = ron::Deserializer::from_str(body)?;
        Ok(match body.chars().next() {
            Some('(') => match reader.deserialize_any(ContentVisitor)? {
                RawContent::Fields(fields) => {
                    NodeContent::Fields(fields.into_iter().map(|(name, raw)| (name, node(raw))).collect())
                }
                RawContent::Items(items) => NodeContent::Tuple(items.into_iter().map(node).collect()),
            },
            Some('[') => match reader.deserialize_seq(ContentVisitor)? {
                RawContent::Items(items) => NodeContent::List(items.into_iter().map(node).collect()),
                RawContent::Fields(_) => NodeContent::Plain,
            },
            Some('{') => {
                let entries = reader.deserialize_map(MapVisitor)?;
                NodeContent::Map(entries.into_iter().map(|(key, value)| (node(key), node(value))).collect())
            }
            _ => NodeContent::Plain,
        })
    }

    fn of_entries(&self, body: &'s str, entries: outline::Entries<'s>) -> NodeContent<'s> {
        let node = |text: &'s str| Node::of_text(self.file, text);
        let named = entries.iter().filter_map(|(name, value)| Some(((*name)?, *value)));
        match body.as_bytes()[0] {
            b'{' => NodeContent::Map(named.map(|(key, value)| (node(key), node(value))).collect()),
            b'(' if entries.iter().any(|(name, _)| name.is_some()) => {
                NodeContent::Fields(named.map(|(name, value)| (name, node(value))).collect())
            }
            open => {
                let values = entries.iter().map(|(_, value)| node(value)).collect();
                if open == b'(' { NodeContent::Tuple(values) } else { NodeContent::List(values) }
            }
        }
    }

    pub fn fault(&self, fault: Fault) {
        self.file.push(fault);
    }

    /// Reports that another value was expected here.
    pub fn expected(&self, what: impl Into<String>) {
        self.fault(self.mismatch(what));
    }

    /// The fault of [`Node::expected`], to which help can be added.
    pub fn mismatch(&self, what: impl Into<String>) -> Fault {
        // Fields with keys read them before their value.
        let keys = if self.looks_like_keys() { "; this field takes no keys" } else { "" };
        Fault::expected(self.span(), what, format!("found {}{keys}", self.describe()))
    }

    /// Whether the value is a list of pairs, or triples, that begin with a number.
    fn looks_like_keys(&self) -> bool {
        let is_key = |item: &Node<'_>| match item.read() {
            Ok(NodeContent::Tuple(parts)) if (2..=3).contains(&parts.len()) => {
                parts[0].text.starts_with(|c: char| c.is_ascii_digit())
            }
            _ => false,
        };
        if !self.opens_with('[') {
            return self.word == "Track";
        }
        matches!(self.read(), Ok(NodeContent::List(items)) if !items.is_empty() && items.iter().all(is_key))
    }

    /// A description of the value for messages.
    pub fn describe(&self) -> String {
        let first = self.text.chars().next().unwrap_or(' ');
        match (self.bare_word(), first) {
            (Some(word), _) => format!("`{}`", shortened(word)),
            (None, _) if !self.word.is_empty() => format!("`{}(...)`", shortened(self.word)),
            (None, '0'..='9' | '-' | '+' | '.') => shortened(self.text),
            (None, '"') => format!("the text {}", shortened(self.text)),
            (None, '[') => "a list".to_owned(),
            (None, '{') => "a map".to_owned(),
            (None, '(') => match self.read() {
                Ok(NodeContent::Tuple(items)) if items.len() == 1 => "one value in parentheses".to_owned(),
                Ok(NodeContent::Tuple(items)) if items.is_empty() => "empty parentheses".to_owned(),
                Ok(NodeContent::Tuple(items)) => format!("{} values in parentheses", items.len()),
                _ => "named fields".to_owned(),
            },
            _ => format!("`{}`", shortened(self.text)),
        }
    }
}

/// The value in `raw` without surrounding blanks and comments.
fn without_blanks(raw: &str) -> &str {
    if is_plain(raw) {
        return raw.trim();
    }
    // A new reader starts at the first character that is not blank, and ends right behind a value.
    let Ok(mut reader) = ron::Deserializer::from_str(raw) else { return raw };
    let start = reader.remainder();
    match IgnoredAny::deserialize(&mut reader) {
        Ok(_) => start[..start.len() - reader.remainder().len()].trim_end(),
        Err(_) => start,
    }
}

/// Whether the text contains no comment, no attribute and only ASCII blanks. On those, ron and Rust agree.
fn is_plain(text: &str) -> bool {
    text.bytes().all(|byte| byte.is_ascii() && byte != b'/' && byte != b'#')
}

/// A leading word, and the text behind it and any blanks.
fn split_word(text: &str) -> (&str, &str) {
    let letter = |c: char| c == '_' || c.is_alphanumeric();
    if !text.starts_with(|c: char| letter(c) && !c.is_ascii_digit()) {
        return ("", text);
    }
    let (word, rest) = text.split_at(text.find(|c| !letter(c)).unwrap_or(text.len()));
    // r"..", r#".."#, b".." and b'.' are not words.
    if rest.starts_with(['"', '\'', '#']) {
        return ("", text);
    }
    if rest.is_empty() || rest.starts_with('(') {
        return (word, rest);
    }
    let rest = match is_plain(rest) {
        true => rest.trim_start(),
        false => ron::Deserializer::from_str(rest).map_or(rest, |reader| reader.remainder()),
    };
    (word, if rest.starts_with('(') { rest } else { "" })
}
