//! The brackets of a file as a tree that holds all comments.

use super::tokens::Token;
use std::iter::Peekable;
use std::slice::Iter;

/// A whole file: one entry, and comments behind it.
pub struct Document<'s> {
    pub entry: Entry<'s>,
    pub comments: Vec<Comment<'s>>,
}

/// What stands between two commas.
#[derive(Default)]
pub struct Entry<'s> {
    /// Comments in the lines above it.
    pub above: Vec<Comment<'s>>,
    pub parts: Vec<Part<'s>>,
    /// Comments behind it, in the same line.
    pub behind: Vec<&'s str>,
    /// Whether it begins a line.
    pub begins_row: bool,
    /// Whether a blank line is in front of it, below the comments above it.
    pub is_apart: bool,
}

pub enum Part<'s> {
    /// A word, number or text.
    Atom(&'s str),
    Colon,
    Brackets(Brackets<'s>),
    Comment(&'s str),
}

/// An opening bracket, entries, and the closing bracket.
pub struct Brackets<'s> {
    pub open: &'s str,
    pub close: &'s str,
    pub entries: Vec<Entry<'s>>,
    /// Comments behind the last entry.
    pub comments: Vec<Comment<'s>>,
}

/// A comment in lines of its own.
pub struct Comment<'s> {
    pub text: &'s str,
    /// Whether a blank line is in front of it.
    pub is_apart: bool,
}

type Tokens<'t, 's> = Peekable<Iter<'t, Token<'s>>>;

impl<'s> Document<'s> {
    /// Reads tokens whose syntax is right.
    pub fn read(tokens: &[Token<'s>]) -> Self {
        let (mut entries, comments) = entries(&mut tokens.iter().peekable());
        let entry = if entries.is_empty() { Entry::default() } else { entries.remove(0) };
        Self { entry, comments }
    }
}

/// Reads up to a closing bracket or the end. Returns the entries, and the comments behind the last one.
fn entries<'s>(tokens: &mut Tokens<'_, 's>) -> (Vec<Entry<'s>>, Vec<Comment<'s>>) {
    let (mut entries, mut above): (Vec<Entry>, Vec<Comment>) = Default::default();
    // A blank line behind an opening bracket separates nothing.
    let mut is_first = true;
    while let Some(token) = tokens.next_if(|token| !token.is_close()) {
        let is_apart = token.breaks > 1 && !is_first;
        is_first = false;
        if token.is_comment() {
            let ends_row =
                |tokens: &mut Tokens| tokens.peek().is_none_or(|next| next.breaks > 0 || next.is_close());
            match entries.last_mut() {
                Some(entry)
                    if token.breaks == 0
                        && above.is_empty()
                        && (token.is_line_comment() || ends_row(tokens)) =>
                {
                    entry.behind.push(token.text);
                    continue;
                }
                _ if token.is_line_comment() || ends_row(tokens) => {
                    above.push(Comment { text: token.text, is_apart });
                    continue;
                }
                _ => {}
            }
        }
        let begins_row = token.breaks > 0 || !above.is_empty();
        let mut entry = Entry { above: std::mem::take(&mut above), begins_row, is_apart, ..Entry::default() };
        add(token, &mut entry, tokens);
        while !is_below_the_last(tokens)
            && let Some(token) = tokens.next_if(|token| !token.is_close() && token.text != ",")
        {
            add(token, &mut entry, tokens);
        }
        tokens.next_if(|token| token.text == ",");
        // Comments in front of the comma belong behind it.
        while let Some(Part::Comment(comment)) = entry.parts.pop_if(|part| matches!(part, Part::Comment(_))) {
            entry.behind.insert(0, comment);
        }
        entries.push(entry);
    }
    (entries, above)
}

/// Whether only comments in lines of their own are left in front of a closing bracket or the end.
fn is_below_the_last(tokens: &Tokens) -> bool {
    let mut rest = tokens.clone();
    let in_own_line = rest.peek().is_some_and(|token| token.is_comment() && token.breaks > 0);
    in_own_line && rest.find(|token| !token.is_comment()).is_none_or(|token| token.is_close())
}

/// Adds a token to an entry, with all between brackets if it opens some.
fn add<'s>(token: &Token<'s>, entry: &mut Entry<'s>, tokens: &mut Tokens<'_, 's>) {
    entry.parts.push(match token.text {
        ":" => Part::Colon,
        text if token.is_comment() => Part::Comment(text),
        open if token.is_open() => {
            let (entries, comments) = entries(tokens);
            let close = tokens.next().map_or("", |close| close.text);
            Part::Brackets(Brackets { open, close, entries, comments })
        }
        text => Part::Atom(text),
    });
}
