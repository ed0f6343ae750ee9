use super::*;
use proptest::prelude::*;

fn set(text: &str) -> FrameSet {
    text.parse().unwrap_or_else(|e| panic!("`{text}`: {e}"))
}

fn frames(text: &str) -> Vec<u32> {
    set(text).frames(100).unwrap_or_else(|e| panic!("`{text}`: {e}"))
}

fn fault(text: &str) -> FrameSetError {
    match text.parse::<FrameSet>() {
        Err(fault) => fault,
        Ok(set) => panic!("`{text}` is taken as {set:?}"),
    }
}

#[test]
fn ranges_lists_and_steps() {
    assert_eq!(frames("7"), [7]);
    assert_eq!(frames("3-6"), [3, 4, 5, 6]);
    assert_eq!(frames("3..6"), [3, 4, 5]);
    assert_eq!(frames("20,7,9"), [7, 9, 20]);
    assert_eq!(frames("1-8:3"), [1, 4, 7]);
    assert_eq!(frames("1-7x3"), [1, 4, 7]);
    assert_eq!(frames("1..7:3"), [1, 4]);
    assert_eq!(frames(" 5 - 6 , 2..4 "), [2, 3, 5, 6]);
    assert_eq!(frames("0-4,2-6,4,0-8:4"), [0, 1, 2, 3, 4, 5, 6, 8]);
    assert_eq!(frames("9-9:7"), [9]);
}

#[test]
fn faults_are_distinguished() {
    assert_eq!(fault(""), FrameSetError::Empty);
    assert_eq!(fault("  "), FrameSetError::Empty);
    for malformed in
        ["a", "1,,2", "1,", "..4", "4..", "3-", "1--", "-", "+3", "1..=4", "1-2-3", "1-4:", "1.5", "x", "x2"]
    {
        assert_eq!(
            fault(malformed),
            FrameSetError::Malformed(malformed.split(',').nth(1).unwrap_or(malformed).into())
        );
    }
    for negative in ["-5", "-5-3", "-5..3", "5--3", "1-4:-2"] {
        assert_eq!(fault(negative), FrameSetError::Negative(negative.into()));
    }
    assert_eq!(fault("0-4294967296"), FrameSetError::TooLarge("4294967296".into()));
    assert_eq!(fault("9-3"), FrameSetError::Backwards { part: "9-3".into(), first: 9, end: 3 });
    assert_eq!(fault("5..5"), FrameSetError::NoFrames { part: "5..5".into(), frame: 5 });
    assert_eq!(fault("0..0"), FrameSetError::NoFrames { part: "0..0".into(), frame: 0 });
    assert_eq!(fault("1-9:0"), FrameSetError::ZeroStep("1-9:0".into()));
    assert_eq!(fault("7x2"), FrameSetError::StepWithoutRange("7x2".into()));
}

#[test]
fn frames_beyond_the_end_name_those_there_are() {
    let fault = set("0-72").frames(72);
    assert_eq!(fault, Err(FrameSetError::Beyond { frame: 72, count: 72 }));
    let text = fault.map_err(|e| e.to_string()).err();
    assert_eq!(text.as_deref(), Some("there is no frame 72; the sequence has 72 frames, 0-71"));
    assert_eq!(set("0-72:5").frames(72).map(|f| f.len()), Ok(15), "a step may jump over the end");
    assert!(set("0").frames(0).is_err());
    assert_eq!(FrameSet::whole(0), None);
}

#[test]
fn sets_are_limited_by_frames_not_by_text() {
    assert!(matches!(set("0-4294967295").frames(72), Err(FrameSetError::Beyond { .. })));
    assert_eq!(set("0-4294967294").frames(u32::MAX), Err(FrameSetError::TooMany { max: MAX_FRAMES }));
    assert_eq!(set("0-4294967294:4294967294").frames(u32::MAX), Ok(vec![0, u32::MAX - 1]));
    assert_eq!(set(&vec!["0-99"; 10_000].join(",")), set("0-99"));
}

proptest! {
    #[test]
    fn any_text_is_a_set_or_a_fault(text in "[0-9.,:x -]{0,12}|\\PC{0,12}") {
        if let Err(fault) = text.parse::<FrameSet>() {
            prop_assert!(!fault.to_string().is_empty());
        }
    }

    #[test]
    fn a_set_is_the_union_of_its_ranges(ranges in prop::collection::vec((0u32..80, 0u32..80, 1u32..9, any::<bool>()), 1..6)) {
        let mut wanted = std::collections::BTreeSet::new();
        let mut parts = Vec::new();
        for (first, more, step, exclusive) in ranges {
            let last = first + more;
            wanted.extend((first..=last).step_by(step as usize));
            parts.push(if exclusive { format!("{first}..{}:{step}", last + 1) } else { format!("{first}-{last}x{step}") });
        }
        let found = set(&parts.join(",")).frames(200);
        prop_assert_eq!(found, Ok(wanted.into_iter().collect::<Vec<_>>()));
    }

    #[test]
    fn every_frame_exists(text in "[0-9]{1,3}(-[0-9]{1,3})?(:[1-9])?", count in 0u32..1000) {
        if let Ok(frames) = text.parse::<FrameSet>().and_then(|set| set.frames(count)) {
            prop_assert!(!frames.is_empty());
            prop_assert!(frames.iter().all(|&frame| frame < count));
            prop_assert!(frames.is_sorted_by(|a, b| a < b));
        }
    }
}

#[test]
fn sets_have_short_texts() {
    for (frames, expected) in [
        (&[][..], ""),
        (&[3], "3"),
        (&[0, 1, 2, 10, 12, 14, 20], "0-2,10-14:2,20"),
        (&[1, 5, 6, 7, 9], "1,5-7,9"),
        (&[0, 2, 3], "0,2-3"),
        (&[0, 48], "0,48"),
    ] {
        assert_eq!(text(frames), expected);
        let parsed: Option<FrameSet> = expected.parse().ok();
        assert_eq!(parsed.map_or(Ok(Vec::new()), |set| set.frames(50)), Ok(frames.to_vec()));
    }
}
