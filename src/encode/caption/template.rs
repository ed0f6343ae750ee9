//! Text with placeholders for values of the frame.

use crate::encode::info::FrameInfo;
use crate::encode::text::missing_glyphs;
use std::fmt;

/// Letters that one note names at most.
const MAX_NOTE_LETTERS: usize = 12;

/// Text with placeholders for values of the frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Template(Vec<Part>);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Part {
    Text(String),
    Field(Field),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Field {
    Frame,
    Frames,
    Time,
    Name,
}

const FIELDS: [(&str, Field); 4] =
    [("frame", Field::Frame), ("frames", Field::Frames), ("time", Field::Time), ("name", Field::Name)];

/// Why a text is not a template. The message says what is wrong and what would be right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CaptionError {
    Unknown(String),
    Unclosed,
}

impl fmt::Display for CaptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(name) => write!(
                f,
                "there is no `{{{name}}}`; known are {{frame}}, {{frames}}, {{time}} and {{name}}, and {{{{ is a brace"
            ),
            Self::Unclosed => f.write_str("a `{` has no `}`; write {{ for a brace"),
        }
    }
}

impl std::error::Error for CaptionError {}

impl Template {
    /// Parses a text with the placeholders `{frame}`, `{frames}`, `{time}` and `{name}`.
    pub fn parse(text: &str) -> Result<Self, CaptionError> {
        let (mut parts, mut plain, mut rest) = (Vec::new(), String::new(), text);
        while let Some(at) = rest.find(['{', '}']) {
            plain.push_str(&rest[..at]);
            let brace = &rest[at..at + 1];
            rest = &rest[at + 1..];
            if let Some(after) = rest.strip_prefix(brace) {
                plain.push_str(brace);
                rest = after;
            } else if brace == "}" {
                plain.push('}');
            } else {
                let (name, after) = rest.split_once('}').ok_or(CaptionError::Unclosed)?;
                let field = FIELDS.iter().find(|(known, _)| *known == name);
                let field = field.ok_or_else(|| CaptionError::Unknown(name.to_owned()))?.1;
                parts.extend([Part::Text(std::mem::take(&mut plain)), Part::Field(field)]);
                rest = after;
            }
        }
        plain.push_str(rest);
        parts.push(Part::Text(plain));
        Ok(Self(parts))
    }

    /// A note that names the letters that the font lacks and captions leave out. `None` if it has all. `name` is the
    /// name of the sequence.
    pub fn missing_glyphs_note(&self, name: &str) -> Option<String> {
        let fixed = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Field(Field::Name) => name.to_owned(),
            // Numbers, whose digits the font has.
            Part::Field(Field::Frame | Field::Frames | Field::Time) => String::new(),
        };
        let text = self.0.iter().map(fixed).collect::<String>();
        let letters = missing_glyphs(&text.lines().collect::<String>());
        let (shown, more) = letters.split_at(letters.len().min(MAX_NOTE_LETTERS));
        let shown: Vec<String> = shown.iter().map(|letter| format!("`{}`", letter.escape_debug())).collect();
        let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
        let shown = shown.join(", ");
        (!letters.is_empty())
            .then(|| format!("captions are without {shown}{more}, which the font does not have"))
    }

    /// Number of lines of the text.
    pub fn lines(&self) -> u32 {
        let plain = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Field(_) => "0".to_owned(),
        };
        self.0.iter().map(plain).collect::<String>().lines().count().max(1) as u32
    }

    /// The text for a frame.
    pub fn expand(&self, info: &FrameInfo) -> String {
        let part = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Field(Field::Frame) => info.padded(),
            Part::Field(Field::Frames) => info.sequence.frames.to_string(),
            Part::Field(Field::Time) => info.seconds(),
            Part::Field(Field::Name) => info.sequence.name.clone(),
        };
        self.0.iter().map(part).collect()
    }
}
