//! Templates of texts.

use super::{FrameInfo, SequenceInfo, Template, TemplateError};
use crate::base::time::Rate;

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
    assert_eq!(
        expanded("{frame:05} {frame:.1} {frames:6}"),
        Ok("00006 6.0 \u{2007}\u{2007}\u{2007}120".into())
    );
    assert_eq!(expanded("{date}"), Err(TemplateError::Unknown("date".into(), Vec::new())));
    assert_eq!(expanded("{frame"), Err(TemplateError::Unclosed));
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
fn lines_of_templates_are_counted() {
    assert_eq!(
        ["", "{frame}", "a\nb", "{name}\n{frame}\n"]
            .map(|text| { Template::parse(text).expect("a template").lines() }),
        [1, 1, 2, 2]
    );
}
