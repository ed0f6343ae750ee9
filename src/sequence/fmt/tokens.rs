//! The tokens of RON, with comments and the line breaks in front of them.

/// A word, number, text, bracket, comma, colon or comment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Token<'s> {
    pub text: &'s str,
    /// The number of line breaks since the token before.
    pub breaks: usize,
}

impl Token<'_> {
    pub fn is_comment(&self) -> bool {
        self.text.starts_with("//") || self.text.starts_with("/*")
    }

    pub fn is_line_comment(&self) -> bool {
        self.text.starts_with("//")
    }

    pub fn is_open(&self) -> bool {
        matches!(self.text, "(" | "[" | "{")
    }

    pub fn is_close(&self) -> bool {
        matches!(self.text, ")" | "]" | "}")
    }
}

/// The tokens of a text whose syntax is right.
pub fn tokens(text: &str) -> Vec<Token<'_>> {
    let (mut tokens, mut rest, mut breaks) = (Vec::new(), text, 0);
    while let Some(first) = rest.chars().next() {
        if is_blank(first) {
            breaks += usize::from(first == '\n');
            rest = &rest[first.len_utf8()..];
            continue;
        }
        let (token, after) = rest.split_at(length(rest, first));
        tokens.push(Token { text: token.trim_end(), breaks });
        (rest, breaks) = (after, 0);
    }
    tokens
}

/// Blanks of RON: those of Unicode, and marks of the direction of text.
fn is_blank(c: char) -> bool {
    c.is_whitespace() || matches!(c, '\u{200e}' | '\u{200f}')
}

/// The length of the token at the start of a text.
fn length(text: &str, first: char) -> usize {
    let until = |end: usize| if end == 0 { text.len() } else { end };
    match first {
        '/' if text.starts_with("//") => text.find('\n').unwrap_or(text.len()),
        '/' if text.starts_with("/*") => until(block_comment(text)),
        '"' => until(quoted(text)),
        '\'' => until(character(text)),
        '(' | '[' | '{' | ')' | ']' | '}' | ',' | ':' => 1,
        // Also of bytes: b"..", br"..".
        _ => {
            let at = text.bytes().take(2).take_while(|byte| b"br".contains(byte)).count();
            let (prefix, marked) = text.split_at(at);
            match marked.chars().next() {
                Some('"' | '#') if matches!(prefix, "r" | "br") => until(raw(text, at)),
                Some('"') if prefix == "b" => 1 + quoted(marked),
                Some('\'') if prefix == "b" => 1 + character(marked),
                _ => {
                    let ends = |c: char| is_blank(c) || "()[]{},:\"/".contains(c);
                    text[first.len_utf8()..].find(ends).map_or(text.len(), |end| end + first.len_utf8())
                }
            }
        }
    }
}

/// The end of a comment, which may contain others. 0 if it has none.
fn block_comment(text: &str) -> usize {
    let (mut at, mut depth) = (0, 0usize);
    loop {
        let rest = &text[at..];
        match (rest.find("/*"), rest.find("*/")) {
            (Some(open), Some(close)) if open < close => (at, depth) = (at + open + 2, depth + 1),
            (_, Some(close)) => (at, depth) = (at + close + 2, depth.saturating_sub(1)),
            (_, None) => return 0,
        }
        if depth == 0 {
            return at;
        }
    }
}

/// The end of a text in quotes. 0 if it has none.
fn quoted(text: &str) -> usize {
    let mut is_escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    0
}

/// The end of a character in quotes. 0 if it has none.
fn character(text: &str) -> usize {
    let skipped = if text[1..].starts_with('\\') { 2 } else { 1 };
    text.char_indices().skip(skipped + 1).find(|(_, c)| *c == '\'').map_or(0, |(at, _)| at + 1)
}

/// The end of a raw text whose marks begin at `at`. 0 if it has none.
fn raw(text: &str, at: usize) -> usize {
    let marks = text[at..].bytes().take_while(|byte| *byte == b'#').count();
    let start = at + marks + 1;
    let end = format!("\"{}", "#".repeat(marks));
    text.get(start..).and_then(|inner| inner.find(&end)).map_or(0, |found| start + found + end.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<&str> {
        tokens(text).iter().map(|token| token.text).collect()
    }

    #[test]
    fn texts_hide_their_content() {
        assert_eq!(
            texts(r##"a:"(\",",r#"]"#,'\'',')'"##),
            ["a", ":", r#""(\",""#, ",", r##"r#"]"#"##, ",", r"'\''", ",", "')'"]
        );
        assert_eq!(texts(r#"b"(",b'(',br")""#), [r#"b"(""#, ",", "b'('", ",", r#"br")""#]);
        assert_eq!(texts("radius:-1.5e-3"), ["radius", ":", "-1.5e-3"]);
    }

    #[test]
    fn comments_are_tokens() {
        assert_eq!(texts("1// a\r\n/* /* b */ */2"), ["1", "// a", "/* /* b */ */", "2"]);
        let breaks: Vec<usize> = tokens("a\n\n// b\nc d").iter().map(|token| token.breaks).collect();
        assert_eq!(breaks, [0, 2, 1, 0]);
    }
}
