//! Outputs as users write them.

use super::*;

#[test]
fn the_extension_selects_the_format() {
    for (text, format) in [
        ("a/b_####.png", StillFormat::Png),
        ("A.JPEG", StillFormat::Jpeg),
        ("a_####.ppm", StillFormat::Ppm),
        ("a.exr", StillFormat::Exr),
    ] {
        assert!(matches!(Output::parse(text), Ok(Output::Stills(found, _)) if found == format), "{text}");
    }
    for (name, format) in MOVING {
        let text = format!("a/b.{name}");
        assert_eq!(Output::parse(&text), Ok(Output::Movie(format, text.into())));
    }
    assert_eq!(Output::parse("-"), Ok(Output::Stream(StreamFormat::Y4m)));
}

#[test]
fn displays_as_the_user_wrote_it() {
    for text in ["./a//b_%04d.png", "b.GIF", "b.png", "-"] {
        assert_eq!(Output::parse(text).expect(text).to_string(), text);
    }
}

#[test]
fn only_stills_of_several_frames_need_a_placeholder() {
    let needs = |text, frames| Output::parse(text).expect(text).needs_placeholder(frames);
    assert!(needs("a.png", 2) && needs("a.exr", 2));
    assert!(!needs("a.png", 1));
    assert!(!needs("a_#.png", 2));
    assert!(!needs("a.gif", 2) && !needs("-", 2));
}

#[test]
fn outputs_with_the_same_file_are_found() {
    let shared = |a: &str, b: &str, frames: &[u32]| {
        let parsed = |text| Output::parse(text).expect(text);
        let path = parsed(a).shared_with(&parsed(b), frames);
        path.map(escape::path)
    };
    assert_eq!(shared("a_#.png", "./a_##.png", &[3, 9]), None);
    assert_eq!(shared("a_#.png", "./a_##.png", &[3, 9, 10]), Some("a_10.png".into()));
    assert_eq!(shared("a_#.png", "b/a_#.png", &[3]), None);
    assert_eq!(shared("a_#.png", "a_3.png", &[3]), Some("a_3.png".into()));
    assert_eq!(shared("a.gif", "./a.gif", &[0, 1]), Some("a.gif".into()));
    assert_eq!(shared("a.gif", "none/../a.gif", &[0, 1]), Some("a.gif".into()));
    assert_eq!(shared("a.gif", "a.apng", &[0, 1]), None);
    assert_eq!(shared("-", "a.y4m", &[0]), None);
    assert_eq!(shared("-", "-", &[0]), Some("-".into()));
}

#[test]
fn errors_suggest_a_correction() {
    for (text, part) in [
        ("a.tiff", "known are .png"),
        ("a", "known are .png"),
        ("a.webm", "write .mp4, or .y4m"),
        ("a_##.mp4", "leave the place out"),
        ("a_##.gif", "leave the place out"),
        ("a_##_#.png", "keep one run of #"),
        ("a_%4d.png", "write %04d"),
    ] {
        let message = Output::parse(text).expect_err(text).to_string();
        assert!(message.contains(part) && message.contains(text), "{message}");
    }
}
