//! Captions that are burnt into every picture: what a frame is, at a corner.

use super::about::Shown;
use super::picture::{Code, Picture};
use super::text::{Align, Line, lacking, line_height};
use crate::base::units::counted;
use std::fmt;

/// What is written into pictures, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Caption {
    pub text: Template,
    pub corner: Corner,
    /// Height of the letters as a share of the picture's height.
    pub size: f32,
}

/// Where a caption stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Corner {
    TopLeft,
    TopRight,
    #[default]
    BottomLeft,
    BottomRight,
}

impl Corner {
    /// All of them with the names that users write.
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

/// Text with places for what differs from frame to frame.
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

/// Why a text is no template. Displays as what is wrong and what would be right.
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
    /// Reads a text in which `{frame}`, `{frames}`, `{time}` and `{name}` stand for their values.
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

    /// Which letters the font lacks, and captions therefore leave out; nothing if it has them all. `name` is the
    /// sequence's.
    pub fn note(&self, name: &str) -> Option<String> {
        let fixed = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Field(Field::Name) => name.to_owned(),
            // Numbers.
            Part::Field(Field::Frame | Field::Frames | Field::Time) => String::new(),
        };
        let text = self.0.iter().map(fixed).collect::<String>();
        let letters = lacking(&text.lines().collect::<String>());
        let (shown, more) = letters.split_at(letters.len().min(MOST_LETTERS));
        let shown: Vec<String> = shown.iter().map(|letter| format!("`{}`", letter.escape_debug())).collect();
        let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
        let shown = shown.join(", ");
        (!letters.is_empty())
            .then(|| format!("captions are without {shown}{more}, which the font does not have"))
    }

    /// Lines of the text, by its own line breaks.
    pub fn lines(&self) -> u32 {
        let plain = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Field(_) => "0".to_owned(),
        };
        self.0.iter().map(plain).collect::<String>().lines().count().max(1) as u32
    }

    /// The text of a frame.
    pub fn told(&self, shown: &Shown) -> String {
        let part = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Field(Field::Frame) => shown.padded(),
            Part::Field(Field::Frames) => shown.about.frames.to_string(),
            Part::Field(Field::Time) => shown.seconds(),
            Part::Field(Field::Name) => shown.about.name.clone(),
        };
        self.0.iter().map(part).collect()
    }
}

/// Letters that one note tells.
const MOST_LETTERS: usize = 12;

/// Letters are at least this high in pixels, or nobody can read them.
const LOWEST: f32 = 9.0;
/// How dark the ground behind the letters is.
const GROUND: f64 = 0.55;
/// Space around the letters, as shares of their height.
const PADDING: f32 = 0.3;

impl Caption {
    /// A caption at its usual place, in its usual size.
    pub fn new(text: Template) -> Self {
        Self { text, corner: Corner::default(), size: 0.045 }
    }

    /// A warning, if pictures of this height have too little room for all lines of the caption.
    pub fn cut(&self, height: u32) -> Option<String> {
        let (size, lines) = (self.letters(height), u64::from(self.text.lines()));
        let room = (height as usize).saturating_sub(padding(size) / 2);
        let fit = room.checked_div(line_height(size))? as u64;
        (fit < lines).then(|| {
            let lines = counted(lines, "line");
            format!(
                "the caption has {lines}; pictures {height} pixels high have room for {fit}, and the rest is cut off"
            )
        })
    }

    /// The height of the letters in a picture of this height.
    fn letters(&self, height: u32) -> f32 {
        (self.size * height as f32).max(LOWEST)
    }

    /// Writes the caption of a frame into its picture: white on a dark ground.
    pub fn draw<C: Code>(&self, picture: &mut Picture<C>, shown: &Shown) {
        let size = self.letters(picture.height);
        let align = if self.corner.is_right() { Align::Right } else { Align::Left };
        let line = Line::block(&self.text.told(shown), size, align);
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
                lay(picture, at, 0.0, GROUND);
                let letter = (x.checked_sub(padding), y.checked_sub(padding / 2));
                if let (Some(x), Some(y)) = letter
                    && x < line.width
                    && y < line.height
                {
                    lay(picture, at, 1.0, line.cover[y * line.width + x].into());
                }
            }
        }
    }
}

/// Pixels around letters of this height.
fn padding(size: f32) -> usize {
    (PADDING * size).round() as usize
}

/// Lays a grey over a pixel, as far as it covers it. Codes are mixed: letters are no light.
fn lay<C: Code>(picture: &mut Picture<C>, at: usize, grey: f64, cover: f64) {
    let below = picture.alpha.as_ref().map_or(1.0, |alpha| alpha[at].displayed());
    let whole = cover + below * (1.0 - cover);
    if cover == 0.0 || whole == 0.0 {
        return;
    }
    for code in &mut picture.rgb[3 * at..3 * at + 3] {
        *code = C::of((cover * grey + below * (1.0 - cover) * code.displayed()) / whole);
    }
    if let Some(alpha) = &mut picture.alpha {
        alpha[at] = C::of(whole);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::time::Rate;
    use crate::encode::About;

    fn about() -> About {
        About { name: "turn".into(), frames: 120, ..About::default() }
    }

    fn shown(about: &About) -> Shown<'_> {
        Shown { about, frame: 6, rate: Rate::new(24, 1).expect("a rate") }
    }

    #[test]
    fn places_are_filled_in() {
        let about = about();
        let told = |text| Template::parse(text).map(|template| template.told(&shown(&about)));
        assert_eq!(told("{name}: {frame} of {frames}, {time} s"), Ok("turn: 006 of 120, 0.25 s".into()));
        assert_eq!(told("{{plain}} }"), Ok("{plain} }".into()));
        assert_eq!(told("{date}"), Err(CaptionError::Unknown("date".into())));
        assert_eq!(told("{frame"), Err(CaptionError::Unclosed));
    }

    #[test]
    fn letters_that_cannot_be_shown_are_told_once() {
        let note = |text, name| Template::parse(text).expect("a template").note(name);
        let told = "captions are without `漢`, `字`, which the font does not have";
        assert_eq!(note("{name} 漢字 漢 {frame}", "turn").as_deref(), Some(told));
        assert_eq!(note("{name}", "漢字").as_deref(), Some(told));
        assert_eq!(note("zoë {frame}", "漢字"), None);
        assert_eq!(note("zoë\n{frame}\r\n{time}", ""), None);
        let many: String = ('一'..'丏').collect();
        assert!(note(&many, "").is_some_and(|note| note.contains("and 3 more")));
    }

    #[test]
    fn a_caption_stands_in_its_corner_alone() {
        let about = about();
        for (name, corner) in Corner::NAMED {
            let mut picture: Picture<u8> = Picture::filled(200, 100, [100, 150, 200]);
            let text = Template::parse("{frame}").expect("a template");
            Caption { text, corner, size: 0.2 }.draw(&mut picture, &shown(&about));
            let changed = |x: usize, y: usize| picture.rgb[3 * (y * 200 + x)..][..3] != [100, 150, 200];
            let corners = [(0, 0), (199, 0), (0, 99), (199, 99)].map(|(x, y)| changed(x, y));
            assert_eq!(corners.iter().filter(|changed| **changed).count(), 1, "{name}");
            assert!(!changed(100, 50));
            assert!(picture.rgb.contains(&255), "{name} has white letters");
        }
    }

    #[test]
    fn lines_of_a_caption_stand_below_each_other() {
        let about = about();
        let rows = |text: &str| {
            let mut picture: Picture<u8> = Picture::filled(200, 200, [100, 150, 200]);
            let caption = Caption { size: 0.1, ..Caption::new(Template::parse(text).expect("a template")) };
            caption.draw(&mut picture, &shown(&about));
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
    fn lines_that_have_no_room_are_told() {
        let caption = |text: &str| Caption { size: 0.1, ..Caption::new(Template::parse(text).expect(text)) };
        let nine = "a\nb\nc\nd\ne\nf\ng\nh\n{frame}";
        assert_eq!(caption(nine).cut(200), None);
        let told = caption(&format!("{nine}\nj")).cut(200);
        let expected =
            "the caption has 10 lines; pictures 200 pixels high have room for 9, and the rest is cut off";
        assert_eq!(told.as_deref(), Some(expected));
        // Letters are not smaller than they can be read.
        let expected =
            "the caption has 2 lines; pictures 18 pixels high have room for 1, and the rest is cut off";
        assert_eq!(caption("a\nb").cut(18).as_deref(), Some(expected));
        let expected =
            "the caption has 1 line; pictures 4 pixels high have room for 0, and the rest is cut off";
        assert_eq!(caption("a").cut(4).as_deref(), Some(expected));
    }

    #[test]
    fn a_caption_shows_where_nothing_else_is() {
        let mut picture: Picture<u16> = Picture::filled(100, 50, [0; 3]);
        picture.alpha = Some(vec![0; 5000]);
        let about = about();
        Caption::new(Template::parse("a").expect("a template")).draw(&mut picture, &shown(&about));
        let alpha = picture.alpha.expect("alpha");
        assert_eq!((alpha[0], alpha[99 + 49 * 100]), (0, 0));
        assert_eq!(alpha[49 * 100], u16::of(GROUND));
    }
}
