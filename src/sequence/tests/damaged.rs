//! Files and texts that are no sequences.

use super::{EVERYTHING, LARGER};
use crate::sequence::{load, parse};
use proptest::prelude::*;

#[test]
fn unreadable_files_are_faults_with_a_reason() {
    let directory = tempfile::tempdir().expect("a directory");
    let missing = directory.path().join("missing.ron");
    let message = load(&missing).expect_err("no file").to_string();
    assert!(message.contains("missing.ron") && message.contains("there is no such file"), "{message}");
    let latin = directory.path().join("latin.ron");
    std::fs::write(&latin, b"(\n// caf\xe9\n)").expect("a file");
    let message = load(&latin).expect_err("no text").to_string();
    assert!(message.contains("not UTF-8") && message.contains("line 2"), "{message}");
    assert!(load(directory.path()).is_err());
    std::fs::write(&latin, "\u{feff}(camera: (position: (3, 0, 0)))").expect("a file");
    assert_eq!(load(&latin).expect("a sequence").name, "latin");
}

#[test]
fn odd_texts_are_refused_calmly() {
    let many = format!("(objects: {{{}}})", "\"a\": (shape: Spher),".repeat(3000));
    let long_line = format!("(background: \"{}\")", "x".repeat(50_000));
    for text in [
        "",
        "(",
        ")",
        "\"",
        "é",
        "(é: é)",
        "(a: \"é",
        "/*",
        "//",
        "r#\"",
        "(a: 'é')",
        "(objects: {é: 1})",
        "Some(())",
        "(r#timeline: ())",
        "(camera: (position: (1, 2, 3)é))",
        "(background: b\"ab\")",
        "(camera: r\"x\")",
        "(timeline: (frames: 1..2))",
        "(timeline: (frames: 0x10))",
        "(background: 1.2.3)",
        "(\u{1b}[31m: 1)",
        "(objects: {\"\": (shape: Group), (): ()})",
        "{}",
        "[]",
        "3",
        "Sequence(objects: {})",
        "(timeline: inf)",
        "(camera: (path: [[[Orbit()]]]))",
        "(timeline: (duration: 1e-9, fps: 1e-6, keys: Frames))",
        "true",
        many.as_str(),
        long_line.as_str(),
    ] {
        if let Err(faults) = parse("odd.ron", text) {
            assert!(faults.len() > 0);
            let plain = faults.render(false);
            assert!(!plain.is_empty() && !plain.contains('\u{1b}'), "{plain}");
            assert!(faults.render(true).contains("\u{1b}["));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, ..ProptestConfig::default() })]

    #[test]
    fn mutations_never_panic(
        is_larger: bool,
        edits in prop::collection::vec((0usize..4000, 0usize..12, 0usize..4000, 0u8..4), 1..6),
    ) {
        let mut text: Vec<char> = if is_larger { LARGER } else { EVERYTHING }.chars().collect();
        for (at, len, other, kind) in edits {
            let (at, other) = (at % text.len(), other % text.len());
            let end = (at + len).min(text.len());
            match kind {
                0 => drop(text.drain(at..end)),
                1 => {
                    let piece = text[at..end].to_vec();
                    text.splice(other..other, piece);
                }
                2 => text.swap(at, other),
                _ => text[at] = ['(', ']', '"', 'é', '-', '9', ',', '\\'][len % 8],
            }
        }
        let text: String = text.into_iter().collect();
        if let Err(faults) = parse("mutated.ron", &text) {
            prop_assert!(!faults.render(true).is_empty());
        }
    }
}
