//! `kinora assemble`: it gives the bytes that `render` would write, or refuses and names every frame that is not right.

use crate::command::{BALL, contents, folder, kinora, refused};
use kinora::encode::Output;
use kinora::pipeline::assemble::{AssembleRequest, assemble};
use std::fs;
use std::path::Path;

const ALL: [&str; 5] = ["a.gif", "a.mp4", "a.apng", "a.webp", "a.y4m"];

/// Outputs of these names in a folder.
fn outputs(folder: &str) -> Vec<String> {
    ALL.iter().flat_map(|name| ["-o".to_owned(), format!("{folder}/{name}")]).collect()
}

fn with<'a>(words: &[&'a str], more: &'a [String]) -> Vec<&'a str> {
    words.iter().copied().chain(more.iter().map(String::as_str)).collect()
}

/// A folder with all frames of the ball.
fn rendered() -> tempfile::TempDir {
    let folder = folder();
    kinora(folder.path(), &["render", "ball.ron", "-o", "f_##.png"]);
    folder
}

/// What assembling is refused for, with and without the sequence; nothing is written.
fn refusals(folder: &Path) -> [String; 2] {
    let before = contents(folder);
    let printed = [&[][..], &["--of", "ball.ron"]].map(|of| {
        let all = outputs("new");
        refused(folder, &[&["assemble", "f_##.png"], of, &with(&[], &all)].concat())
    });
    assert!(contents(folder) == before && !folder.join("new").exists(), "something was written");
    printed
}

#[test]
fn missing_frames_are_named() {
    for (gone, named) in [(&[5][..], "5"), (&[11], "11"), (&[0], "0"), (&[0, 3, 4, 5, 10, 11], "0,3-5,10-11")]
    {
        let folder = rendered();
        for frame in gone {
            fs::remove_file(folder.path().join(format!("f_{frame:02}.png"))).expect("a frame");
        }
        let noun = if gone.len() == 1 { "frame" } else { "frames" };
        for printed in refusals(folder.path()) {
            assert!(printed.contains("error: f_##.png cannot be assembled:\n"), "{printed}");
            assert!(printed.contains(&format!("\n  {noun} {named}: missing\n")), "{printed}");
            assert!(printed.contains("--allow-gaps"), "{printed}");
        }
        for of in [&[][..], &["--of", "ball.ron"]] {
            let rest = ["--allow-gaps", "-o", "a.gif", "-o", "a.y4m"];
            let printed = kinora(folder.path(), &[&["assemble", "f_##.png"], of, &rest[..]].concat());
            assert!(printed.contains(&format!("frames  {} at 24", 12 - gone.len())), "{printed}");
            let verb = if gone.len() == 1 { "is" } else { "are" };
            assert!(
                printed.contains(&format!("note    {noun} {named} {verb} missing and left out\n")),
                "{printed}"
            );
        }
        // Who names frames means these alone.
        kinora(folder.path(), &["assemble", "f_##.png", "--frames", "6-9", "-o", "a.gif"]);
        kinora(
            folder.path(),
            &["assemble", "f_##.png", "--of", "ball.ron", "--frames", "6-9", "-o", "a.gif"],
        );
        let printed = refused(folder.path(), &["assemble", "f_##.png", "--frames", "0-13:1", "-o", "a.gif"]);
        assert!(
            printed.contains(&format!("frames {}", named.split(',').next().expect("a frame"))),
            "{printed}"
        );
    }
    let folder = rendered();
    let printed = refused(folder.path(), &["assemble", "f_##.png", "--frames", "9-13", "-o", "a.gif"]);
    assert!(printed.contains("frames 12-13: missing"), "{printed}");
    let printed = refused(
        folder.path(),
        &["assemble", "f_##.png", "--of", "ball.ron", "--frames", "9-13", "-o", "a.gif"],
    );
    assert!(printed.contains("there is no frame 13"), "{printed}");
    for frame in 0..12 {
        fs::remove_file(folder.path().join(format!("f_{frame:02}.png"))).expect("a frame");
    }
    let printed = refused(folder.path(), &["assemble", "f_##.png", "-o", "a.gif", "--allow-gaps"]);
    assert!(printed.contains("there are no frames f_##.png"), "{printed}");
    let printed =
        refused(folder.path(), &["assemble", "f_##.png", "--of", "ball.ron", "-o", "a.gif", "--allow-gaps"]);
    assert!(printed.contains("frames 0-11: missing"), "{printed}");
}

/// Two frames with their pixels exchanged: whole PNGs, each with the texts of the other.
fn exchange(one: &Path, other: &Path) {
    let (first, second) = (fs::read(one).expect("a frame"), fs::read(other).expect("a frame"));
    let data = |bytes: &[u8]| bytes.windows(4).position(|kind| kind == b"IDAT").expect("pixels") - 4;
    let (head, tail) = (&first[..data(&first)], &second[data(&second)..]);
    let exchanged = [head, tail].concat();
    image::load_from_memory(&exchanged).expect("a whole PNG");
    fs::write(one, exchanged).expect("a disk");
}

#[test]
fn damaged_frames_are_named() {
    let folder = rendered();
    let at = |name: &str| folder.path().join(name);
    exchange(&at("f_01.png"), &at("f_02.png"));
    let damage = |name: &str, with: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = fs::read(at(name)).expect(name);
        with(&mut bytes);
        fs::write(at(name), bytes).expect("a disk");
    };
    damage("f_03.png", &|bytes| bytes.truncate(bytes.len() - 5));
    damage("f_04.png", &|bytes| bytes.push(0));
    damage("f_05.png", &|bytes| *bytes.last_mut().expect("a byte") ^= 1);
    damage("f_06.png", &Vec::clear);
    damage("f_07.png", &|bytes| *bytes = b"no picture".to_vec());
    fs::remove_file(at("f_08.png")).expect("a frame");
    fs::create_dir(at("f_08.png")).expect("a disk");
    let [alone, of] = refusals(folder.path());
    for printed in [&alone, &of] {
        assert!(
            printed.contains("\n  frames 1,3-5: damaged: its bytes are not those that were written\n"),
            "{printed}"
        );
        assert!(printed.contains("\n  frame 8: damaged: it is a folder\n"), "{printed}");
    }
    assert!(alone.contains("\n  frames 6-7: damaged: it is not a picture"), "{alone}");
    assert!(of.contains("\n  frames 6-7: damaged: it is not a complete PNG\n"), "{of}");
    // Gaps are no damage.
    let printed = refused(folder.path(), &["assemble", "f_##.png", "--allow-gaps", "-o", "a.gif"]);
    assert!(printed.contains("frames 1,3-5: damaged"), "{printed}");
    // Render makes of it what there was.
    fs::remove_dir(at("f_08.png")).expect("a folder");
    let printed = kinora(folder.path(), &["render", "ball.ron", "-o", "f_##.png"]);
    assert!(printed.contains("12, 5 of them kept"), "{printed}");
}

#[test]
fn stale_frames_are_named() {
    let folder = rendered();
    let path = folder.path();
    // A ball that was white all the time is green from frame 6 on.
    let rendered_with = |name: &str, color: &str| {
        let text = BALL.replace("radius: 1)", &format!("radius: 1), material: (color: {color})"));
        assert!(text != BALL);
        fs::write(path.join(name), text).expect("a disk");
    };
    rendered_with("white.ron", "1");
    kinora(path, &["render", "white.ron", "-o", "w_##.png"]);
    rendered_with("green.ron", "[(0, 1, Step), (6, (0, 1, 0))]");
    let printed = refused(path, &["assemble", "w_##.png", "--of", "green.ron", "-o", "a.gif"]);
    assert!(printed.contains("\n  frames 6-11: stale: the sequence, its settings or"), "{printed}");
    let printed = refused(path, &["assemble", "f_##.png", "--of", "ball.ron", "-s", "64x36", "-o", "a.gif"]);
    assert!(printed.contains("\n  frames 0-11: stale"), "{printed}");
    // Frames without metadata are accepted; one that should have metadata is reported.
    kinora(path, &["render", "ball.ron", "--no-metadata", "-o", "n_##.png"]);
    fs::copy(path.join("n_04.png"), path.join("f_04.png")).expect("a disk");
    let printed = refused(path, &["assemble", "f_##.png", "--of", "ball.ron", "-o", "a.gif"]);
    assert!(printed.contains("\n  frame 4: without metadata, as --no-metadata"), "{printed}");
    let printed = kinora(path, &["assemble", "n_##.png", "--of", "ball.ron", "--no-metadata", "-o", "a.gif"]);
    assert!(printed.contains("note    frames without metadata do not say what they show"), "{printed}");
    // Others cannot say it.
    kinora(path, &["render", "ball.ron", "-o", "j_##.jpg", "-o", "d_##.png", "--bits", "16"]);
    let printed = refused(path, &["assemble", "j_##.jpg", "--of", "ball.ron", "-o", "a.gif"]);
    assert!(printed.contains("--of takes PNGs"), "{printed}");
    let printed = refused(path, &["assemble", "d_##.png", "--of", "ball.ron", "--bits", "16", "-o", "a.gif"]);
    assert!(printed.contains("PNGs of 8 bits"), "{printed}");
}

#[test]
fn inconsistent_frames_are_named() {
    let folder = rendered();
    let path = folder.path();
    let printed = |what: &str| {
        let printed = refused(path, &["assemble", "f_##.png", "-o", "a.gif"]);
        assert!(printed.contains(what), "{printed}");
        kinora(path, &["render", "ball.ron", "-o", "f_##.png", "--overwrite"]);
    };
    fs::copy(path.join("f_03.png"), path.join("f_05.png")).expect("a disk");
    printed("\n  frame 5: frame 3 under another number\n");
    fs::write(path.join("other.ron"), BALL).expect("a disk");
    kinora(path, &["render", "other.ron", "-o", "f_##.png", "--frames", "2-4", "--overwrite"]);
    printed("\n  frames 2-4: sequence other; most frames have ball\n");
    kinora(
        path,
        &["render", "ball.ron", "-o", "f_##.png", "--frames", "7,9", "--antialias", "3", "--overwrite"],
    );
    printed("\n  frames 7,9: antialias 3; most frames have 2\n");
    kinora(path, &["render", "ball.ron", "-o", "f_##.png", "--frames", "3-7", "-r", "25", "--overwrite"]);
    printed("\n  frames 3-7: rate 25; most frames have 24\n");
    // A version before had no digest.
    let unsealed = |name: &str| {
        let bytes = fs::read(path.join(name)).expect(name);
        let at = bytes.windows(15).position(|word| word == b"kinora:identity").expect("an identity") - 8;
        let length = u32::from_be_bytes(*bytes[at..].first_chunk().expect("a length")) as usize;
        let mut chunk = Vec::new();
        let text = String::from_utf8_lossy(&bytes[at + 24..at + 24 + 32]).into_owned();
        let text = png::text_metadata::TEXtChunk::new("kinora:identity", text);
        png::text_metadata::EncodableTextChunk::encode(&text, &mut chunk).expect("memory");
        let old = [&bytes[..at], &chunk, &bytes[at + 12 + length..]].concat();
        fs::write(path.join(name), old).expect("a disk");
    };
    unsealed("f_04.png");
    kinora(path, &["assemble", "f_##.png", "-o", "a.gif"]);
    let printed = refused(path, &["assemble", "f_##.png", "--of", "ball.ron", "-o", "a.gif"]);
    assert!(
        printed.contains(
            "\n  frame 4: without a digest of their pixels, as earlier versions of Kinora wrote them\n"
        ),
        "{printed}"
    );
    let printed = kinora(path, &["render", "ball.ron", "-o", "f_##.png"]);
    assert!(
        printed.contains("12, 11 of them kept") && printed.contains("note    1 frame of an earlier version"),
        "{printed}"
    );
}

#[test]
fn files_equal_those_of_render() {
    for (rest, own) in [
        (&[][..], &[][..]),
        (&["-s", "40x20", "-r", "12", "--exposure", "1"], &[]),
        (&["--transparent", "--quality", "30", "--max-size", "2kB"], &[]),
        (&["--caption", "{frame}/{frames}"], &["--frame-caption", "{frame}/{frames}"]),
        (&["--integrator", "path", "--samples", "2", "--seed", "3", "--no-metadata"], &[]),
        (&["--draft"], &[]),
    ] {
        let folder = folder();
        let (one, all) = (outputs("one"), outputs("all"));
        let settings = if own.is_empty() { rest } else { own };
        kinora(folder.path(), &[&["render", "ball.ron"], rest, &with(&[], &one)].concat());
        for shard in ["1/2", "2/2"] {
            let stills = ["--shard", shard, "-o", "f_##.png"];
            kinora(folder.path(), &[&["render", "ball.ron"], rest, &stills[..]].concat());
        }
        let assemble = ["assemble", "f_##.png", "--of", "ball.ron"];
        kinora(folder.path(), &[&assemble[..], settings, &with(&[], &all)].concat());
        let [one, all] = ["one", "all"].map(|name| contents(&folder.path().join(name)));
        assert_eq!(one.len(), 5);
        assert!(one == all, "{rest:?}");
    }
}

#[test]
fn the_time_limit_is_a_setting() {
    let folder = folder();
    let soft = BALL.replace("Point(position: (3, 4, 5))", "Sphere(center: (3, 4, 5), radius: 1)");
    fs::write(folder.path().join("soft.ron"), soft).expect("a disk");
    kinora(folder.path(), &["render", "soft.ron", "--time-limit", "1s", "-o", "f_##.png", "-o", "one/a.gif"]);
    let assemble = ["assemble", "f_##.png", "--of", "soft.ron", "-o", "all/a.gif"];
    kinora(folder.path(), &[&assemble[..], &["--time-limit", "1s"]].concat());
    assert!(contents(&folder.path().join("one")) == contents(&folder.path().join("all")));
    let printed = refused(folder.path(), &[&assemble[..], &["--time-limit", "2s"]].concat());
    assert!(printed.contains("no frame was rendered with this --time-limit"), "{printed}");
}

#[test]
fn frames_of_others_are_taken_as_they_are() {
    let folder = folder();
    let path = folder.path();
    for frame in 1..=4u32 {
        let picture = image::RgbImage::from_pixel(16, 8, image::Rgb([40 * frame as u8, 0, 0]));
        for extension in ["png", "jpg", "ppm"] {
            picture.save(path.join(format!("b_{frame}.{extension}"))).expect("a disk");
        }
    }
    for extension in ["png", "jpg", "ppm"] {
        let names = format!("b_#.{extension}");
        let printed = kinora(path, &["assemble", &names, "-r", "12", "-o", "b.gif"]);
        assert!(printed.contains("frames  4 at 12 per second"), "{printed}");
        let third = path.join(format!("b_3.{extension}"));
        let whole = fs::read(&third).expect("a frame");
        fs::write(&third, &whole[..whole.len() - 2]).expect("a disk");
        let printed = refused(path, &["assemble", &names, "-o", "b.gif"]);
        assert!(printed.contains("\n  frame 3: damaged: it "), "{printed}");
        fs::remove_file(&third).expect("a frame");
        let printed = refused(path, &["assemble", &names, "-o", "b.gif"]);
        assert!(printed.contains("\n  frame 3: missing\n"), "{printed}");
        fs::write(&third, whole).expect("a disk");
    }
    // Beside frames with metadata, a note counts those without.
    kinora(path, &["render", "ball.ron", "-o", "f_##.png"]);
    let plain = image::open(path.join("f_05.png")).expect("a frame");
    plain.save(path.join("f_05.png")).expect("a disk");
    let printed = kinora(path, &["assemble", "f_##.png", "-o", "b.gif"]);
    assert!(printed.contains("note    frames 5 do not say what they show, and the others do\n"), "{printed}");
    let printed = refused(path, &["assemble", "f_##.png", "-s", "8x8", "-o", "b.gif"]);
    assert!(printed.contains("name it with --of"), "{printed}");
}

/// Numbers may be times of day or identifiers, and no list of all between them fits into memory.
#[test]
fn frames_far_apart_have_to_be_named() {
    let folder = folder();
    let path = folder.path();
    for frame in ["7", "4000000000", "4294967295"] {
        let picture = image::RgbImage::from_pixel(16, 8, image::Rgb([9, 0, 0]));
        picture.save(path.join(format!("b_{frame}.png"))).expect("a disk");
    }
    for rest in [&[][..], &["--allow-gaps"]] {
        let printed = refused(path, &[&["assemble", "b_#.png", "-o", "b.gif"], rest].concat());
        assert!(printed.contains("b_#.png: frames 7 to 4294967295 are more than 10000000"), "{printed}");
    }
    let printed = kinora(path, &["assemble", "b_#.png", "--frames", "7,4000000000", "-o", "b.gif"]);
    assert!(printed.contains("frames  2 at 24"), "{printed}");
}

#[test]
fn frames_beyond_the_end_are_noted() {
    let folder = rendered();
    let path = folder.path();
    fs::write(path.join("ball.ron"), BALL.replace("frames: 12", "frames: 9")).expect("a disk");
    let printed = kinora(path, &["render", "ball.ron", "-o", "f_##.png"]);
    assert!(printed.contains("frames  9, 9 of them kept"), "{printed}");
    let note =
        "note    f_##.png: frames 9-11 exist, but the sequence has 9 frames; they are left as they are\n";
    assert!(printed.contains(note), "{printed}");
    assert_eq!(contents(path).len(), 13);
    let printed = kinora(path, &["assemble", "f_##.png", "--of", "ball.ron", "-o", "a.gif"]);
    assert!(printed.contains("frames  9 at 24") && printed.contains(note), "{printed}");
    // Longer again: they are still right, and none is missing.
    fs::write(path.join("ball.ron"), BALL).expect("a disk");
    let printed = kinora(path, &["render", "ball.ron", "-o", "f_##.png"]);
    assert!(
        printed.contains("frames  12, 12 of them kept") && !printed.contains("they are left"),
        "{printed}"
    );
}

#[test]
fn outputs_never_replace_input_frames() {
    let folder = rendered();
    let path = folder.path();
    let before = contents(path);
    for of in [&[][..], &["--of", "ball.ron"]] {
        for output in ["f_05.png", "./f_40.png", "f_##.png"] {
            let printed =
                refused(path, &[&["assemble", "f_##.png"], of, &["-o", "a.gif", "-o", output]].concat());
            assert!(printed.contains("it would replace one of its input frames f_##.png"), "{printed}");
            assert!(printed.contains(output.trim_end_matches("##.png")), "{printed}");
        }
    }
    assert!(contents(path) == before);
    kinora(path, &["assemble", "f_##.png", "-o", "f_5.png"]);
}

/// Whoever uses the library may call frames as they like, so that no pattern is there to compare with.
#[test]
fn the_library_replaces_no_frame_either() {
    let folder = rendered();
    let path = folder.path();
    let frames: Vec<_> = (0..12).map(|number| (number, path.join(format!("f_{number:02}.png")))).collect();
    let before = contents(path);
    let assembled = |output: &Path| {
        let outputs = ["a.gif".as_ref(), output].map(|name| path.join(name));
        let outputs = outputs.map(|output| Output::parse(output).expect("an output")).to_vec();
        assemble(&AssembleRequest { frames: frames.clone(), outputs, ..AssembleRequest::default() })
    };
    let mut names = vec!["f_05.png", "./f_05.png", "none/../f_05.png", "../{own}/f_05.png", "f_##.png"];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(".", path.join("link")).expect("a link");
        names.push("link/f_05.png");
    }
    let own = path.file_name().expect("a name").to_string_lossy();
    for name in names {
        let name = name.replace("{own}", &own);
        let printed = assembled(name.as_ref()).expect_err(&name).to_string();
        assert!(
            printed.contains("it would replace one of its input frames ")
                && printed.contains("name another file"),
            "{printed}"
        );
        assert!(contents(path) == before, "{name}: something was written");
    }
    assembled("f_5.png".as_ref()).expect("a filmstrip");
}

#[test]
fn frames_of_another_size_are_named() {
    let folder = folder();
    let path = folder.path();
    kinora(path, &["render", "ball.ron", "--no-metadata", "-o", "n_##.png", "-o", "j_##.jpg"]);
    for name in ["n_04.png", "n_07.png", "j_04.jpg", "j_07.jpg"] {
        let other = image::RgbImage::from_pixel(16, 8, image::Rgb([9, 0, 0]));
        other.save(path.join(name)).expect("a disk");
    }
    let before = contents(path);
    for (names, of, told_of) in [
        ("n_##.png", &["--of", "ball.ron", "--no-metadata"][..], "16x8 pixels, not 32x18"),
        ("n_##.png", &[], "size 16x8; most frames have 32x18"),
        ("j_##.jpg", &[], "size 16x8; most frames have 32x18"),
    ] {
        let printed = refused(path, &[&["assemble", names], of, &["-o", "a.gif", "-o", "a.y4m"]].concat());
        assert!(printed.contains(&format!("\n  frames 4,7: {told_of}\n")), "{printed}");
    }
    assert!(contents(path) == before);
}
