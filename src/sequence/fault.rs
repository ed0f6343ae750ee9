//! Faults of a file: the place, the expected value, and suggestions.

use crate::base::escape;
use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use std::fmt;
use std::ops::Range;

/// A fault at one place of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Bytes of the source that the fault is about.
    pub span: Range<usize>,
    title: Title,
    label: String,
    /// A related place.
    also: Option<(Range<usize>, String)>,
    help: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Title {
    /// A complete sentence.
    Text(String),
    /// "`field`: expected `what`". The decoder of the field fills in its name.
    Expected { what: String, field: Option<String> },
}

impl Fault {
    pub fn new(span: Range<usize>, title: impl Into<String>, label: impl Into<String>) -> Self {
        Self { span, title: Title::Text(title.into()), label: label.into(), also: None, help: Vec::new() }
    }

    /// A value that its field does not accept.
    pub fn expected(span: Range<usize>, what: impl Into<String>, found: impl Into<String>) -> Self {
        let title = Title::Expected { what: what.into(), field: None };
        Self { span, title, label: found.into(), also: None, help: Vec::new() }
    }

    /// Replaces the label at the place.
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help.push(help.into());
        self
    }

    pub fn also(mut self, span: Range<usize>, label: impl Into<String>) -> Self {
        self.also = Some((span, label.into()));
        self
    }

    /// Sets the field's name, unless an inner field has set it already.
    pub fn name_field(&mut self, name: &str) {
        if let Title::Expected { field: field @ None, .. } = &mut self.title {
            *field = Some(name.to_owned());
        }
    }

    fn title(&self) -> String {
        match &self.title {
            Title::Text(text) => text.clone(),
            Title::Expected { what, field: None } => format!("expected {what}"),
            Title::Expected { what, field: Some(field) } => format!("`{field}`: expected {what}"),
        }
    }
}

/// All faults of a file, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Faults {
    name: String,
    source: String,
    faults: Vec<Fault>,
}

/// Maximum number of displayed faults. The others are counted.
const SHOWN: usize = 100;

/// Maximum length of a quoted line in bytes.
const LONGEST_LINE: usize = 10_000;

/// Maximum distance in bytes of two places that are quoted together.
const FARTHEST: usize = 100_000;

impl Faults {
    pub(super) fn new(name: &str, source: &str, mut faults: Vec<Fault>) -> Self {
        faults.sort_by_key(|fault| (fault.span.start, fault.span.end));
        Self { name: name.to_owned(), source: source.to_owned(), faults }
    }

    /// Number of faults; at least one.
    #[expect(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.faults.len()
    }

    /// The faults as text for a terminal, with or without ANSI colours.
    pub fn render(&self, color: bool) -> String {
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        let renderer = renderer.decor_style(DecorStyle::Ascii);
        let mut lines = LineCounter::new(&self.source);
        let mut text = String::new();
        for fault in self.faults.iter().take(SHOWN) {
            let groups = [self.group(fault, &mut lines)];
            text.push_str(renderer.render(&groups).trim_end());
            text.push_str("\n\n");
        }
        match self.faults.len().saturating_sub(SHOWN) {
            0 => text.truncate(text.trim_end().len()),
            1 => text.push_str("... and one more fault"),
            more => text.push_str(&format!("... and {more} more faults")),
        }
        text
    }

    fn group<'a>(&'a self, fault: &'a Fault, lines: &mut LineCounter<'a>) -> Group<'a> {
        let title = Level::ERROR.primary_title(clean(&fault.title()));
        let (first_line, line) = lines.line_of(fault.span.start);
        let mut group = if line.len() > LONGEST_LINE {
            let column = self.source[line.start..fault.span.start].chars().count() + 1;
            let place = Origin::path(escape::line(&self.name)).line(first_line).char_column(column);
            title.element(place).element(Level::NOTE.message(clean(&fault.label)))
        } else {
            title.element(self.snippet(fault, first_line, line))
        };
        for help in &fault.help {
            group = group.element(Level::HELP.message(clean(help)));
        }
        group
    }

    /// The quoted lines of a fault, and of the related place if it is near.
    fn snippet<'a>(
        &'a self,
        fault: &'a Fault,
        number: usize,
        line: Range<usize>,
    ) -> Snippet<'a, Annotation<'a>> {
        let near = |span: &Range<usize>| span.start.abs_diff(fault.span.start) <= FARTHEST;
        let also = fault.also.as_ref().filter(|(span, _)| near(span));
        let also = also.map(|(span, label)| (self.first_line_of(span), label));
        let (mut start, mut end, mut number) = (line.start, line.end, number);
        if let Some((span, _)) = &also {
            let other = line_around(&self.source, span.start);
            if other.start < start {
                number -= self.source[other.start..start].matches('\n').count();
            }
            (start, end) = (start.min(other.start), end.max(other.end));
        }
        let piece = &self.source[start..end];
        let place = |at: usize| shown(piece, at - start).len();
        let inside = |span: Range<usize>| place(span.start)..place(span.end);
        let main = AnnotationKind::Primary.span(inside(self.first_line_of(&fault.span)));
        let mut snippet = Snippet::source(shown(piece, piece.len()))
            .path(escape::line(&self.name))
            .line_start(number)
            .annotation(main.label(clean(&fault.label)));
        if let Some((span, label)) = also {
            snippet = snippet.annotation(AnnotationKind::Context.span(inside(span)).label(clean(label)));
        }
        snippet
    }

    /// Cuts a span at the end of its first line.
    fn first_line_of(&self, span: &Range<usize>) -> Range<usize> {
        let end = line_around(&self.source, span.start).end.min(span.end);
        let text = &self.source[span.start..end];
        span.start..span.start + text.trim_end().len()
    }
}

type Annotation<'a> = annotate_snippets::Annotation<'a>;

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for Faults {}

/// Escapes text from the file, so that it cannot control the terminal or break a line.
fn clean(text: &str) -> String {
    escape::line(&text.replace(['\n', '\r', '\t'], " ")).into_owned()
}

/// The displayed source up to byte `end`. Keeps line breaks and tabs, and escapes other control characters.
fn shown(source: &str, end: usize) -> String {
    let mut shown = String::with_capacity(end);
    for (at, c) in source.char_indices().take_while(|(at, _)| *at < end) {
        match c {
            '\r' if matches!(source.as_bytes().get(at + 1), None | Some(b'\n')) => {}
            '\n' | '\t' => shown.push(c),
            c if escape::must_escape(c) => shown.extend(c.escape_unicode()),
            c => shown.push(c),
        }
    }
    shown
}

fn line_around(source: &str, at: usize) -> Range<usize> {
    let start = source[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let end = source[at..].find('\n').map_or(source.len(), |newline| at + newline);
    start..end
}

/// Counts lines in one direction, because faults are sorted.
struct LineCounter<'a> {
    source: &'a str,
    counted: usize,
    number: usize,
}

impl<'a> LineCounter<'a> {
    fn new(source: &'a str) -> Self {
        Self { source, counted: 0, number: 1 }
    }

    /// The line number from 1, and the bytes of the line around `at`.
    fn line_of(&mut self, at: usize) -> (usize, Range<usize>) {
        self.number += self.source[self.counted..at].matches('\n').count();
        self.counted = at;
        (self.number, line_around(self.source, at))
    }
}
