//! All faults of a sequence as a message: each with the quoted lines of its places.

use super::expand::source::{Source, Sources};
use super::fault::Fault;
use crate::base::escape;
use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use std::collections::HashMap;
use std::fmt;
use std::ops::Range;

/// All faults of a sequence, in the order of its files.
#[derive(Clone, Debug, PartialEq, Eq)]
#[warn(missing_docs)]
pub struct Faults {
    sources: Box<Sources>,
    faults: Vec<Fault>,
    /// For each fault: how many more copies of its place have it.
    copies: Vec<usize>,
}

/// The place of a fault, and what is wrong there.
#[derive(Clone, Debug, PartialEq, Eq)]
#[warn(missing_docs)]
pub struct FaultPlace {
    /// The file as messages name it: an included file has its own name.
    pub file: String,
    /// The line, counted from 1.
    pub line: usize,
    /// The character within the line, counted from 1.
    pub column: usize,
    /// The field whose value is wrong, if the fault is one of a field's value.
    pub field: Option<String>,
    /// What was expected, and what was found.
    pub message: String,
}

/// Maximum number of displayed faults. The others are counted.
const SHOWN: usize = 100;

/// Maximum length of a quoted line in bytes.
const LONGEST_LINE: usize = 10_000;

/// Maximum distance in bytes of two places that are quoted together.
const FARTHEST: usize = 100_000;

#[warn(missing_docs)]
impl Faults {
    /// Faults at places in these sources. Several copies of one place have its fault once.
    pub(super) fn new(sources: Sources, mut all: Vec<Fault>) -> Self {
        all.sort_by_key(|fault| (fault.span.start, fault.span.end));
        let (mut faults, mut copies): (Vec<Fault>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut at_this_place = HashMap::new();
        let mut place = 0..0;
        for fault in all {
            if fault.span != place {
                place = fault.span.clone();
                at_this_place.clear();
            }
            // Places that are used once have each of their faults.
            let known = at_this_place.entry(fault.title.clone()).or_insert(faults.len());
            match copies.get_mut(*known) {
                Some(more) if !fault.notes.uses.is_empty() => *more += 1,
                // Objects that share a description, such as instances, find the same fault in it.
                Some(_) if faults[*known] == fault => {}
                _ => {
                    faults.push(fault);
                    copies.push(0);
                }
            }
        }
        Self { sources: Box::new(sources), faults, copies }
    }

    /// Number of faults; at least one.
    #[expect(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.faults.len()
    }

    /// The place of each fault and what is wrong there, in the order of the files.
    pub fn places(&self) -> Vec<FaultPlace> {
        let place = |fault: &Fault| {
            let source = self.sources.of(fault.span.start);
            let start = within(&fault.span, source).start;
            let line = line_around(&source.text, start);
            FaultPlace {
                file: source.name.clone(),
                line: source.line(fault.span.start),
                column: source.text[line.start..start].chars().count() + 1,
                field: fault.field().map(str::to_owned),
                message: format!("{}: {}", fault.title(), fault.label),
            }
        };
        self.faults.iter().map(place).collect()
    }

    /// The faults as text for a terminal, with or without ANSI colours.
    pub fn render(&self, color: bool) -> String {
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        let renderer = renderer.decor_style(DecorStyle::Ascii);
        let mut lines = LineCounter::new(self.sources.get(0));
        let mut text = String::new();
        for (fault, copies) in self.faults.iter().zip(&self.copies).take(SHOWN) {
            let groups = [self.group(fault, *copies, &mut lines)];
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

    fn group<'a>(&'a self, fault: &'a Fault, copies: usize, lines: &mut LineCounter<'a>) -> Group<'a> {
        let title = Level::ERROR.primary_title(clean(&fault.title()));
        let source = self.sources.of(fault.span.start);
        if source.base != lines.source.base {
            *lines = LineCounter::new(source);
        }
        let start = fault.span.start - source.base;
        let (first_line, line) = lines.line_of(start);
        let mut group = if line.len() > LONGEST_LINE {
            let column = source.text[line.start..start].chars().count() + 1;
            let place = Origin::path(escape::line(&source.name)).line(first_line).char_column(column);
            title.element(place).element(Level::NOTE.message(clean(&fault.label)))
        } else {
            title.element(self.snippet(fault, first_line, line))
        };
        if let Some((span, label)) = &fault.notes.also
            && self.sources.of(span.start).base != source.base
        {
            group = self.with_place(group, span, label);
        }
        for (span, label) in &fault.notes.uses {
            group = self.with_place(group, span, label);
        }
        match copies {
            0 => {}
            1 => group = group.element(Level::NOTE.message("another copy has the same mistake")),
            more => {
                group =
                    group.element(Level::NOTE.message(format!("{more} more copies have the same mistake")))
            }
        }
        for help in &fault.notes.help {
            group = group.element(Level::HELP.message(clean(help)));
        }
        group
    }

    /// Adds the quoted line of another place, with its file. Long lines are not quoted.
    fn with_place<'a>(&'a self, group: Group<'a>, span: &Range<usize>, label: &'a str) -> Group<'a> {
        let source = self.sources.of(span.start);
        let (number, span) = (source.line(span.start), within(span, source));
        let line = line_around(&source.text, span.start);
        let path = escape::line(&source.name);
        if line.len() > LONGEST_LINE {
            let column = source.text[line.start..span.start].chars().count() + 1;
            let place = Origin::path(path).line(number).char_column(column);
            return group.element(place).element(Level::NOTE.message(clean(label)));
        }
        let span = first_line_of(&source.text, &span);
        let piece = &source.text[line.clone()];
        let place = |at: usize| shown(piece, (at - line.start).min(piece.len())).len();
        let annotation = AnnotationKind::Context.span(place(span.start)..place(span.end));
        group.element(
            Snippet::source(shown(piece, piece.len()))
                .path(path)
                .line_start(number)
                .annotation(annotation.label(clean(label))),
        )
    }

    /// The quoted lines of a fault, and of the related place if it is near.
    fn snippet<'a>(
        &'a self,
        fault: &'a Fault,
        number: usize,
        line: Range<usize>,
    ) -> Snippet<'a, Annotation<'a>> {
        let source = self.sources.of(fault.span.start);
        let own = within(&fault.span, source);
        let near = |span: &Range<usize>| {
            self.sources.of(span.start).base == source.base
                && span.start.abs_diff(fault.span.start) <= FARTHEST
        };
        let also = fault.notes.also.as_ref().filter(|(span, _)| near(span));
        let also = also.map(|(span, label)| (first_line_of(&source.text, &within(span, source)), label));
        let (mut start, mut end, mut number) = (line.start, line.end, number);
        if let Some((span, _)) = &also {
            let other = line_around(&source.text, span.start);
            if other.start < start {
                number -= source.text[other.start..start].matches('\n').count();
            }
            (start, end) = (start.min(other.start), end.max(other.end));
        }
        let piece = &source.text[start..end];
        let place = |at: usize| shown(piece, at - start).len();
        let inside = |span: Range<usize>| place(span.start)..place(span.end);
        let main = AnnotationKind::Primary.span(inside(first_line_of(&source.text, &own)));
        let mut snippet = Snippet::source(shown(piece, piece.len()))
            .path(escape::line(&source.name))
            .line_start(number)
            .annotation(main.label(clean(&fault.label)));
        if let Some((span, label)) = also {
            snippet = snippet.annotation(AnnotationKind::Context.span(inside(span)).label(clean(label)));
        }
        snippet
    }
}

/// A span as bytes of its source.
fn within(span: &Range<usize>, source: &Source) -> Range<usize> {
    let inside = |at: usize| at.saturating_sub(source.base).min(source.text.len());
    inside(span.start)..inside(span.end)
}

/// Cuts a span at the end of its first line.
fn first_line_of(source: &str, span: &Range<usize>) -> Range<usize> {
    let end = line_around(source, span.start).end.min(span.end).max(span.start);
    let text = &source[span.start..end];
    span.start..span.start + text.trim_end().len()
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
    source: &'a Source,
    counted: usize,
    number: usize,
}

impl<'a> LineCounter<'a> {
    fn new(source: &'a Source) -> Self {
        Self { source, counted: 0, number: 1 }
    }

    /// The line number from 1, and the bytes of the line around `at`.
    fn line_of(&mut self, at: usize) -> (usize, Range<usize>) {
        self.number += self.source.text[self.counted..at].matches('\n').count();
        self.counted = at;
        (self.number, line_around(&self.source.text, at))
    }
}
