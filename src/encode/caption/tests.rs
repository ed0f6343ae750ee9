//! Captions in pictures, and their templates.

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
    assert_eq!(expanded("{date}"), Err(CaptionError::Unknown("date".into(), Vec::new())));
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
    let expected = "the caption has 1 line; pictures 4 pixels high have room for 0, and the rest is cut off";
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
