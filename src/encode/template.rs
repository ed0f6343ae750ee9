//! Text with placeholders for values of the frame.

use super::number_format::NumberFormat;
use crate::base::time::Fraction;
use crate::drawing::Font;
use crate::encode::info::FrameInfo;
use crate::track::{Animate, Modes};
use std::fmt;

/// Letters that one note names at most.
const MAX_NOTE_LETTERS: usize = 12;

/// Text with placeholders for values of the frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Template(Vec<Part>);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Part {
    Text(String),
    Field(Field, Option<NumberFormat>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Field {
    Frame,
    Frames,
    Time,
    Name,
    /// A value by its index.
    Value(usize),
}

const FIELDS: [(&str, Field); 4] =
    [("frame", Field::Frame), ("frames", Field::Frames), ("time", Field::Time), ("name", Field::Name)];

/// Why a text is not a template. The message says what is wrong and what would be right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TemplateError {
    /// A name, and the names of the values that are known.
    Unknown(String, Vec<String>),
    /// A format of a placeholder.
    Format(String),
    Unclosed,
}

impl fmt::Display for TemplateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(name, values) => {
                let values: String = values.iter().map(|value| format!("{{{value}}}, ")).collect();
                write!(
                    f,
                    "there is no `{{{name}}}`; known are {values}{{frame}}, {{frames}}, {{time}} and {{name}}, and \
                     {{{{ is a brace"
                )
            }
            Self::Format(format) => write!(
                f,
                "`{format}` is not the format of a number; write {{time:.3}} for three decimals, {{time:+.1}} for a \
                 sign, {{time:6.2}} for at least six characters, or {{frame:04}} for zeros in front"
            ),
            Self::Unclosed => f.write_str("a `{` has no `}`; write {{ for a brace"),
        }
    }
}

impl std::error::Error for TemplateError {}

impl Template {
    /// Whether placeholders have this name in every template.
    pub fn knows(name: &str) -> bool {
        FIELDS.iter().any(|(known, _)| *known == name)
    }

    /// Parses a text with the placeholders `{frame}`, `{frames}`, `{time}` and `{name}`.
    pub fn parse(text: &str) -> Result<Self, TemplateError> {
        Self::with_values(text, &[])
    }

    /// [`Template::parse`] with placeholders for values of these names, too.
    pub fn with_values(text: &str, values: &[&str]) -> Result<Self, TemplateError> {
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
                let (name, after) = rest.split_once('}').ok_or(TemplateError::Unclosed)?;
                parts.extend([Part::Text(std::mem::take(&mut plain)), field(name, values)?]);
                rest = after;
            }
        }
        plain.push_str(rest);
        parts.push(Part::Text(plain));
        Ok(Self(parts))
    }

    /// A note that names the letters that the program's font lacks and captions leave out. `None` if it has all. `name`
    /// is the name of the sequence.
    pub fn missing_glyphs_note(&self, name: &str) -> Option<String> {
        missing_glyphs_note(&self.missing_glyphs(name, &Font::default()))
    }

    /// The letters that a font lacks.
    pub fn missing_glyphs(&self, name: &str, font: &Font) -> Vec<char> {
        let fixed = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Field(Field::Name, _) => name.to_owned(),
            Part::Field(..) => "0123456789.−+".to_owned(),
        };
        let text = self.0.iter().map(fixed).collect::<String>();
        font.missing_glyphs(&text.lines().collect::<String>())
    }

    /// The same template with a text after it.
    pub fn followed_by(mut self, text: &str) -> Self {
        self.0.push(Part::Text(text.to_owned()));
        self
    }

    /// Number of lines of the text.
    pub fn lines(&self) -> u32 {
        let plain = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Field(..) => "0".to_owned(),
        };
        self.0.iter().map(plain).collect::<String>().lines().count().max(1) as u32
    }

    /// The text for a frame.
    pub fn expand(&self, info: &FrameInfo) -> String {
        self.expand_with(info, &[])
    }

    /// The text for a frame with these values.
    pub fn expand_with(&self, info: &FrameInfo, values: &[f64]) -> String {
        let part = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Field(Field::Name, _) => info.sequence.name.clone(),
            Part::Field(Field::Frame, None) => info.padded(),
            Part::Field(Field::Frames, None) => info.sequence.frames.to_string(),
            Part::Field(Field::Time, None) => info.seconds(),
            Part::Field(field, format) => {
                let value = match field {
                    Field::Frame => f64::from(info.frame),
                    Field::Frames => f64::from(info.sequence.frames),
                    Field::Value(index) => values.get(*index).copied().unwrap_or(f64::NAN),
                    Field::Time | Field::Name => info.time_value(),
                };
                let format = format.unwrap_or_default();
                let is_count = matches!(field, Field::Frame | Field::Frames);
                if is_count { format.or_decimals(0) } else { format }.write(value)
            }
        };
        self.0.iter().map(part).collect()
    }
}

/// The placeholder `NAME` or `NAME:FORMAT`.
fn field(text: &str, values: &[&str]) -> Result<Part, TemplateError> {
    let (name, format) = text.split_once(':').map_or((text, None), |(name, format)| (name, Some(format)));
    let value = values.iter().position(|known| *known == name).map(Field::Value);
    let field = value.or_else(|| FIELDS.iter().find(|(known, _)| *known == name).map(|(_, field)| *field));
    let unknown =
        || TemplateError::Unknown(name.to_owned(), values.iter().map(|v| (*v).to_owned()).collect());
    let field = field.ok_or_else(unknown)?;
    let format = match format {
        Some(format) => {
            let bad = || TemplateError::Format(format.to_owned());
            Some(NumberFormat::parse(format).filter(|_| field != Field::Name).ok_or_else(bad)?)
        }
        None => None,
    };
    Ok(Part::Field(field, format))
}

/// A note that names the letters that captions leave out. None if there are none.
pub fn missing_glyphs_note(letters: &[char]) -> Option<String> {
    let letters = listed(letters)?;
    Some(format!("captions are without {letters}, which the font does not have"))
}

/// Names letters. None if there are none.
pub fn listed(letters: &[char]) -> Option<String> {
    let (shown, more) = letters.split_at(letters.len().min(MAX_NOTE_LETTERS));
    let shown: Vec<String> = shown.iter().map(|letter| format!("`{}`", letter.escape_debug())).collect();
    let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
    (!letters.is_empty()).then(|| format!("{}{more}", shown.join(", ")))
}

/// Texts change only at their keys.
impl Animate for Template {
    const MODES: Modes = Modes::Step;

    fn mix(a: &Self, _: &Self, _: Fraction) -> Self {
        a.clone()
    }
}
