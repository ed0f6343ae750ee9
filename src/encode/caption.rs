//! Captions that are drawn into a corner of every picture.

use super::info::FrameInfo;
use super::picture::{Code, Picture};
use super::text::{Align, TextMask, line_height, missing_glyphs};
use crate::base::units::counted;
use std::fmt;

/// The text of a caption and its position.
#[derive(Clone, Debug, PartialEq)]
pub struct Caption {
    pub text: Template,
    pub corner: Corner,
    /// Height of the letters relative to the picture's height.
    pub size: f32,
}

/// The corner of a caption.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Corner {
    TopLeft,
    TopRight,
    #[default]
    BottomLeft,
    BottomRight,
}

impl Corner {
    /// All corners with the names that users write.
    pub const NAMED: [(&'static str, Self); 4] = [
        ("TopLeft", Self::TopLeft),
        ("TopRight", Self::TopRight),
        ("BottomLeft", Self::BottomLeft),
        ("BottomRight", Self::BottomRight),
    ];

    fn is_right(self) -> bool {
        matches!(self, Self::TopRight | Self::BottomRight)
    }

    fn is_bottom(self) -> bool {
        matches!(self, Self::BottomLeft | Self::BottomRight)
    }
}

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

    /// A note that names the letters that the font lacks and captions leave out. None if it has all. `name` is the name
    /// of the sequence.
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

/// Letters that one note names at most.
const MAX_NOTE_LETTERS: usize = 12;

/// Minimum height of letters in pixels, for legibility.
const MIN_HEIGHT: f32 = 9.0;
/// Opacity of the black background behind the letters.
const BACKGROUND_OPACITY: f64 = 0.55;
/// Space around the letters, relative to their height.
const PADDING: f32 = 0.3;

impl Caption {
    /// A caption in the default corner and size.
    pub fn new(text: Template) -> Self {
        Self { text, corner: Corner::default(), size: 0.045 }
    }

    /// A warning if the caption has more lines than fit into pictures of this height.
    pub fn overflow_warning(&self, height: u32) -> Option<String> {
        let (size, lines) = (self.letter_height(height), u64::from(self.text.lines()));
        let room = (height as usize).saturating_sub(padding(size) / 2);
        let fit = room.checked_div(line_height(size))? as u64;
        (fit < lines).then(|| {
            let lines = counted(lines, "line");
            format!(
                "the caption has {lines}; pictures {height} pixels high have room for {fit}, and the rest is cut off"
            )
        })
    }

    /// The height of the letters in a picture of this height, in pixels.
    fn letter_height(&self, height: u32) -> f32 {
        (self.size * height as f32).max(MIN_HEIGHT)
    }

    /// Draws the caption of a frame into its picture: white letters on a translucent black background.
    pub fn draw<C: Code>(&self, picture: &mut Picture<C>, info: &FrameInfo) {
        let size = self.letter_height(picture.height);
        let align = if self.corner.is_right() { Align::Right } else { Align::Left };
        let line = TextMask::block(&self.text.expand(info), size, align);
        if line.width == 0 {
            return;
        }
        let padding = padding(size);
        let (width, height) = (line.width + 2 * padding, line.height + padding);
        let left = if self.corner.is_right() { (picture.width as usize).saturating_sub(width) } else { 0 };
        let top = if self.corner.is_bottom() { (picture.height as usize).saturating_sub(height) } else { 0 };
        for y in 0..height.min(picture.height as usize) {
            for x in 0..width.min(picture.width as usize) {
                let at = (top + y) * picture.width as usize + left + x;
                blend(picture, at, 0.0, BACKGROUND_OPACITY);
                let letter = (x.checked_sub(padding), y.checked_sub(padding / 2));
                if let (Some(x), Some(y)) = letter
                    && x < line.width
                    && y < line.height
                {
                    blend(picture, at, 1.0, line.coverage[y * line.width + x].into());
                }
            }
        }
    }
}

/// Space around letters of this height, in pixels.
fn padding(size: f32) -> usize {
    (PADDING * size).round() as usize
}

/// Composites a grey over a pixel with an opacity. It blends display values, because captions are not light.
fn blend<C: Code>(picture: &mut Picture<C>, at: usize, grey: f64, opacity: f64) {
    let below = picture.alpha.as_ref().map_or(1.0, |alpha| alpha[at].displayed());
    let whole = opacity + below * (1.0 - opacity);
    if opacity == 0.0 || whole == 0.0 {
        return;
    }
    for code in &mut picture.rgb[3 * at..3 * at + 3] {
        *code = C::of((opacity * grey + below * (1.0 - opacity) * code.displayed()) / whole);
    }
    if let Some(alpha) = &mut picture.alpha {
        alpha[at] = C::of(whole);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::time::Rate;
    use crate::encode::SequenceInfo;

    fn sequence() -> SequenceInfo {
        SequenceInfo { name: "turn".into(), frames: 120, ..SequenceInfo::default() }
    }

    fn info(sequence: &SequenceInfo) -> FrameInfo<'_> {
        FrameInfo { sequence, frame: 6, rate: Rate::new(24, 1).expect("a rate") }
    }

    #[test]
    fn placeholders_are_expanded() {
        let sequence = sequence();
        let expanded = |text| Template::parse(text).map(|template| template.expand(&info(&sequence)));
        assert_eq!(expanded("{name}: {frame} of {frames}, {time} s"), Ok("turn: 006 of 120, 0.25 s".into()));
        assert_eq!(expanded("{{plain}} }"), Ok("{plain} }".into()));
        assert_eq!(expanded("{date}"), Err(CaptionError::Unknown("date".into())));
        assert_eq!(expanded("{frame"), Err(CaptionError::Unclosed));
    }

    #[test]
    fn missing_letters_are_named_once() {
        let note = |text, name| Template::parse(text).expect("a template").missing_glyphs_note(name);
        let expected = "captions are without `漢`, `字`, which the font does not have";
        assert_eq!(note("{name} 漢字 漢 {frame}", "turn").as_deref(), Some(expected));
        assert_eq!(note("{name}", "漢字").as_deref(), Some(expected));
        assert_eq!(note("zoë {frame}", "漢字"), None);
        assert_eq!(note("zoë\n{frame}\r\n{time}", ""), None);
        let many: String = ('一'..'丏').collect();
        assert!(note(&many, "").is_some_and(|note| note.contains("and 3 more")));
    }

    #[test]
    fn a_caption_changes_its_corner_only() {
        let sequence = sequence();
        for (name, corner) in Corner::NAMED {
            let mut picture: Picture<u8> = Picture::filled(200, 100, [100, 150, 200]);
            let text = Template::parse("{frame}").expect("a template");
            Caption { text, corner, size: 0.2 }.draw(&mut picture, &info(&sequence));
            let changed = |x: usize, y: usize| picture.rgb[3 * (y * 200 + x)..][..3] != [100, 150, 200];
            let corners = [(0, 0), (199, 0), (0, 99), (199, 99)].map(|(x, y)| changed(x, y));
            assert_eq!(corners.iter().filter(|changed| **changed).count(), 1, "{name}");
            assert!(!changed(100, 50));
            assert!(picture.rgb.contains(&255), "{name} has white letters");
        }
    }

    #[test]
    fn lines_of_a_caption_are_below_each_other() {
        let sequence = sequence();
        let rows = |text: &str| {
            let mut picture: Picture<u8> = Picture::filled(200, 200, [100, 150, 200]);
            let caption = Caption { size: 0.1, ..Caption::new(Template::parse(text).expect("a template")) };
            caption.draw(&mut picture, &info(&sequence));
            picture.rgb.chunks(3 * 200).filter(|row| row[..3] != [100, 150, 200]).count()
        };
        assert_eq!((rows("{frame}"), rows("{frame}\nof {frames}"), rows("a\n\nb\n")), (26, 46, 66));
        assert_eq!(
            ["", "{frame}", "a\nb", "{name}\n{frame}\n"]
                .map(|text| { Template::parse(text).expect("a template").lines() }),
            [1, 1, 2, 2]
        );
    }

    #[test]
    fn lines_that_do_not_fit_are_reported() {
        let caption = |text: &str| Caption { size: 0.1, ..Caption::new(Template::parse(text).expect(text)) };
        let nine = "a\nb\nc\nd\ne\nf\ng\nh\n{frame}";
        assert_eq!(caption(nine).overflow_warning(200), None);
        let warning = caption(&format!("{nine}\nj")).overflow_warning(200);
        let expected =
            "the caption has 10 lines; pictures 200 pixels high have room for 9, and the rest is cut off";
        assert_eq!(warning.as_deref(), Some(expected));
        // Letters have a minimum height.
        let expected =
            "the caption has 2 lines; pictures 18 pixels high have room for 1, and the rest is cut off";
        assert_eq!(caption("a\nb").overflow_warning(18).as_deref(), Some(expected));
        let expected =
            "the caption has 1 line; pictures 4 pixels high have room for 0, and the rest is cut off";
        assert_eq!(caption("a").overflow_warning(4).as_deref(), Some(expected));
    }

    #[test]
    fn a_caption_shows_on_transparent_pixels() {
        let mut picture: Picture<u16> = Picture::filled(100, 50, [0; 3]);
        picture.alpha = Some(vec![0; 5000]);
        let sequence = sequence();
        Caption::new(Template::parse("a").expect("a template")).draw(&mut picture, &info(&sequence));
        let alpha = picture.alpha.expect("alpha");
        assert_eq!((alpha[0], alpha[99 + 49 * 100]), (0, 0));
        assert_eq!(alpha[49 * 100], u16::of(BACKGROUND_OPACITY));
    }
}
