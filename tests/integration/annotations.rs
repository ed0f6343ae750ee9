//! Annotations in files: what they cover, that they cost no light, and what changes when they change.

use crate::command::{contents, folder, kinora, run};
use image::{Rgb, RgbImage};
use kinora::sequence::{load, parse};
use std::fs;
use std::path::Path;

/// A still scene of two colours with annotations.
fn scene(annotations: &str) -> String {
    format!(
        r#"(
            timeline: (frames: 3, fps: 10),
            output: (size: (160, 90), files: ["f_#.png"]),
            quality: (antialias: 1),
            background: Srgb(64, 96, 128),
            camera: (position: (0, 0, 10), projection: Orthographic(height: 10)),
            objects: {{
                "sheet": (
                    shape: Box(min: (-3, -2, -1), max: (3, 2, 0)),
                    material: Unlit(color: Scalar(of: X, map: Viridis, range: (-2, 6))),
                ),
            }},
            annotations: {{ {annotations} }},
        )"#
    )
}

fn render(folder: &Path, text: &str, more: &[&str]) -> String {
    fs::write(folder.join("a.ron"), text).expect("written");
    let output = run(folder, &[&["render", "a.ron"], more].concat());
    let words = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
    assert_eq!(output.status.code(), Some(0), "{words}");
    words
}

/// Whether a summary counts rays from the camera.
fn traces(words: &str) -> bool {
    words.contains("camera  ") && !words.contains("camera  0")
}

fn picture(folder: &Path, name: &str) -> RgbImage {
    image::open(folder.join(name)).expect(name).into_rgb8()
}

const CLOCK: &str = r##""clock": Clock(backdrop: None, color: "#ff0000", size: 0.2),"##;

/// Frames that share a film share it with different texts, too.
#[test]
fn texts_do_not_divide_films() {
    let folder = folder();
    let words = render(folder.path(), &scene(CLOCK), &[]);
    assert!(words.contains("2 reuse another frame's film"), "{words}");
    let [a, b] = ["f_0.png", "f_1.png"].map(|name| picture(folder.path(), name));
    let differ: Vec<_> = a.enumerate_pixels().filter(|(x, y, code)| *code != b.get_pixel(*x, *y)).collect();
    assert!(!differ.is_empty(), "the time is another one");
    assert!(differ.iter().all(|(x, y, _)| *x > 80 && *y < 30), "only the clock differs");
}

/// A label edit draws again, traces nothing, and gives the bytes that a new render gives.
#[test]
fn edited_labels_trace_nothing() {
    let label = |text: &str| format!(r#""a": Label(text: "{text}", at: (0, 0, 0), leader: true), {CLOCK}"#);
    for transparent in [&[][..], &["--transparent"]] {
        let (edited, fresh) = (folder(), folder());
        let outputs = [&["-o", "f_#.png", "-o", "a.gif", "-o", "a.mp4"], transparent].concat();
        render(edited.path(), &scene(&label("before")), &outputs);
        let before = contents(edited.path());
        let words = render(edited.path(), &scene(&label("after")), &outputs);
        assert!(words.contains("3 frames of an earlier run got other annotations"), "{words}");
        assert!(!traces(&words), "no ray was traced: {words}");
        render(fresh.path(), &scene(&label("after")), &outputs);
        let (after, expected) = (contents(edited.path()), contents(fresh.path()));
        for name in ["f_0.png", "f_1.png", "f_2.png", "a.gif", "a.mp4"] {
            assert!(after[name] == expected[name], "{name} differs from a new render");
            assert!(after[name] != before[name], "{name} shows the old label");
        }
        // From annotated to plain and back.
        render(edited.path(), &scene(""), &outputs);
        let words = render(edited.path(), &scene(&label("after")), &outputs);
        assert!(words.contains("got other annotations"), "{words}");
        assert!(contents(edited.path())["f_1.png"] == expected["f_1.png"]);
        // What changes the light is rendered.
        let moved = scene(&label("after")).replace("max: (3, 2, 0)", "max: (2, 2, 0)");
        let words = render(edited.path(), &moved, &outputs);
        assert!(traces(&words) && !words.contains("got other annotations"), "{words}");
    }
}

/// The colours of a bar are those of its map, within one code, and its ends are where its range ends.
#[test]
fn color_bars_show_their_map() {
    for (vertical, place) in [(true, "Right"), (false, "Top")] {
        let folder = folder();
        let bar = format!(
            r#""bar": ColorBar(object: "sheet", vertical: {vertical}, length: 0.6, place: {place}, backdrop: None)"#
        );
        let text = scene(&bar).replace("(160, 90)", "(1280, 720)");
        render(folder.path(), &text, &["--frames", "0"]);
        let shown = picture(folder.path(), "f_0.png");
        let map = |t: f64| {
            let map = kinora::appearance::texture::ColorMap::named(
                kinora::appearance::texture::NamedMap::Viridis,
                256,
            );
            map.color(t)
                .to_array()
                .map(|part| (kinora::base::color::linear_to_srgb(part.into()) * 255.0 + 0.5) as u8)
        };
        let length: usize = if vertical { 432 } else { 768 };
        let expected: Vec<[u8; 3]> = (0..length).map(|i| map((i as f64 + 0.5) / length as f64)).collect();
        let line = |at: u32| -> Vec<[u8; 3]> {
            match vertical {
                true => (0..720).rev().map(|y| shown.get_pixel(at, y).0).collect(),
                false => (0..1280).map(|x| shown.get_pixel(x, at).0).collect(),
            }
        };
        let close = |a: &[u8; 3], b: &[u8; 3]| a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 1);
        let holds = |line: &[[u8; 3]]| {
            line.windows(length).any(|part| part.iter().zip(&expected).all(|(a, b)| close(a, b)))
        };
        let lines = if vertical { 1280 } else { 720 };
        let found = (0..lines).filter(|at| holds(&line(*at))).count();
        assert_eq!(found, 25, "thickness of the bar in pixels");
    }
}

/// Rays decide which labels are hidden; the own object of a label does not hide it.
#[test]
fn rays_hide_labels() {
    let folder = folder();
    let label = |at: &str, behind: &str| {
        let text = format!(
            r##""a": Label(text: "MMMM", at: {at}, behind: {behind}, size: 0.2, backdrop: None, color: "#f00")"##
        );
        render(folder.path(), &scene(&text), &["--frames", "0", "--overwrite"]);
        picture(folder.path(), "f_0.png").pixels().filter(|code| code.0 == [255, 0, 0]).count()
    };
    let shown = label("(0, 0, 1)", "Hide");
    assert!(shown > 10, "in front of the sheet");
    assert_eq!(label("(0, 0, -2)", "Hide"), 0, "behind it");
    assert_eq!(label("(0, 0, -2)", "Fade"), 0, "no pure red");
    assert_eq!(label("(0, 0, -2)", "Show"), shown);
    assert_eq!(label("(0, 0, 0)", "Hide"), shown, "on its surface");
    assert_eq!(label(r#"Object("sheet")"#, "Hide"), shown, "within its own object");
}

/// Annotations in GIFs have their exact colours, and pixels that are not dithered.
#[test]
fn gifs_keep_the_colors_of_annotations() {
    let folder = folder();
    let text = scene(
        r##""a": Label(text: "MMMM", size: 0.2, at: Screen(0.5, 0.2), color: "#ff8001", backdrop: Box(color: "#123456", opacity: 1))"##,
    );
    // Noise needs more colours than there are.
    let text = text.replace(
        "background: Srgb(64, 96, 128)",
        "background: Gradient(bottom: (0.1, 0.9, 0.3), top: (0.9, 0.1, 0.8))",
    );
    render(
        folder.path(),
        &text.replace("(160, 90)", "(320, 180)"),
        &["-o", "f_#.png", "-o", "a.gif", "--frames", "0"],
    );
    let still = picture(folder.path(), "f_0.png");
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let file = fs::File::open(folder.path().join("a.gif")).expect("a GIF");
    let mut decoder = options.read_info(file).expect("a GIF");
    let frame = decoder.read_next_frame().expect("a frame").expect("a frame");
    let shown = image::RgbaImage::from_raw(320, 180, frame.buffer.to_vec()).expect("its pixels");
    for solid in [Rgb([255, 128, 1]), Rgb([0x12, 0x34, 0x56])] {
        let places: Vec<_> = still.enumerate_pixels().filter(|(.., code)| **code == solid).collect();
        assert!(places.len() > 20, "{solid:?}");
        assert!(places.iter().all(|(x, y, _)| shown.get_pixel(*x, *y).0[..3] == solid.0), "{solid:?}");
    }
}

/// EXR files hold the light as it is, and annotations beside it.
#[test]
fn exr_files_hold_annotations_as_a_layer() {
    use exr::prelude::*;
    let folder = folder();
    render(folder.path(), &scene(CLOCK), &["-o", "f_#.exr", "--frames", "0"]);
    let plain = crate::command::folder();
    render(plain.path(), &scene(""), &["-o", "f_#.exr", "--frames", "0"]);
    let channels = |folder: &Path| -> Vec<(String, Vec<f32>)> {
        let image = read_all_flat_layers_from_file(folder.join("f_0.exr")).expect("an EXR file");
        let list = &image.layer_data[0].channel_data.list;
        list.iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
    };
    let (with, without) = (channels(folder.path()), channels(plain.path()));
    let names: Vec<&str> = with.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["B", "G", "R", "annotations.A", "annotations.B", "annotations.G", "annotations.R"]);
    for (name, values) in &without {
        let same = with.iter().find(|(other, _)| other == name).expect("a channel");
        assert!(same.1 == *values, "{name}");
    }
    assert!(with[3].1.contains(&1.0) && with[3].1.contains(&0.0));
    // A changed label makes the file again.
    let words = render(folder.path(), &scene(""), &["-o", "f_#.exr", "--frames", "0"]);
    assert!(traces(&words), "{words}");
}

/// A caption of the output is the annotation of the same text, by either of its notations, and on the command line.
#[test]
fn captions_are_annotations() {
    let with_output =
        |caption: &str| scene("").replacen("output: (", &format!("output: (caption: {caption}, "), 1);
    let frame = |text: &str, more: &[&str]| {
        let folder = folder();
        render(folder.path(), text, &[&["-o", "f_#.png", "--frames", "0", "--no-metadata"], more].concat());
        fs::read(folder.path().join("f_0.png")).expect("a frame")
    };
    let expected = frame(&scene(r#""c": Caption("{name} {frame}")"#), &[]);
    assert_ne!(expected, frame(&scene(""), &[]));
    assert_eq!(expected, frame(&with_output(r#""{name} {frame}""#), &[]));
    assert_eq!(expected, frame(&with_output(r#"(text: "{name} {frame}")"#), &[]));
    assert_eq!(expected, frame(&scene(""), &["--caption", "{name} {frame}"]));
    // The place and the style stay if the command line changes the text.
    let styled = |text: &str| format!(r##"(text: "{text}", place: Top, color: "#fa0", size: 0.1)"##);
    let expected = frame(&with_output(&styled("b")), &[]);
    assert_eq!(expected, frame(&with_output(&styled("a")), &["--caption", "b"]));
    assert_ne!(expected, frame(&with_output(&styled("a")), &[]));
    // The former name of the place.
    let folder = folder();
    let former = with_output(r#"(text: "b", corner: TopRight)"#);
    let words = render(folder.path(), &former, &["-o", "f_#.png", "--frames", "0"]);
    assert!(words.contains("the field `corner` is now called `place`"), "{words}");
}

#[test]
fn letters_are_solids() {
    let text = |fields: &str| {
        format!(
            "(timeline: (frames: 1), output: (size: (64, 64), transparent: true),
             camera: (position: (0, 0.35, 5), target: (0, 0.35, 0), projection: Orthographic(height: 1.2)),
             objects: {{ \"text\": (shape: Text({fields})) }})"
        )
    };
    let shown = |fields: &str| {
        let folder = folder();
        render(folder.path(), &text(fields), &["-o", "f_#.png"]);
        let image = image::open(folder.path().join("f_0.png")).expect("a picture").to_rgba8();
        image.pixels().filter(|pixel| pixel.0[3] > 127).count()
    };
    let (one, two) = (shown(r#""l""#), shown(r#""ll""#));
    assert!(one > 50 && two.abs_diff(2 * one) < one / 5, "{one} {two}");
    assert!(shown(r#"text: "l", size: 0.5, depth: 0"#).abs_diff(one / 4) < one / 10);
    for (fields, part) in [
        (r#""""#, "no letters that can be seen"),
        (r#"" ""#, "no letters that can be seen"),
        (r#""漢""#, "does not have `漢`"),
        (r#"text: "a", depth: -1"#, "`depth`"),
        ("size: 2", "has no `text`"),
        (r#"text: "a", font: "no.ttf""#, "cannot read the font"),
    ] {
        let message = parse("a.ron", &text(fields)).expect_err(fields).to_string();
        assert!(message.contains("a.ron:") && message.contains(part), "{fields}: {message}");
    }
}

#[test]
fn filmstrips_show_annotations() {
    let folder = folder();
    fs::write(folder.path().join("a.ron"), scene(CLOCK)).expect("written");
    kinora(folder.path(), &["filmstrip", "a.ron", "-o", "strip.png"]);
    assert!(picture(folder.path(), "strip.png").pixels().any(|code| code.0 == [255, 0, 0]));
}

#[test]
fn mistakes_name_their_place() {
    for (annotations, parts) in [
        (
            r#""a": Label(text: "a", at: Object("shet"))"#,
            &["there is no object `shet`", "did you mean `sheet`?"][..],
        ),
        (
            r#""a": Lable(text: "a", at: (0, 0, 0))"#,
            &["there is no annotation `Lable`", "did you mean `Label`?"],
        ),
        (r#""a": Label(text: "{angle}", at: (0, 0, 0))"#, &["there is no `{angle}`", "values: {"]),
        (r#""a": Label(text: "{time:x}", at: (0, 0, 0))"#, &["`x` is not the format of a number"]),
        (r#""a": Label(at: (0, 0, 0))"#, &["a label has no `text`"]),
        (r#""a": Label(text: "a", at: "sheet")"#, &["write Object(\"sheet\")"]),
        (r#""a": ColorBar(material: "none")"#, &["there is no material `none`"]),
        (r#""a": Label(text: "a", at: (0, 0, 0), font: "no.ttf")"#, &["cannot read the font \"no.ttf\""]),
        (r#""a": Trail(Screen(0.5, 0.5))"#, &["a point of the world"]),
        (r#""a": Plot(series: {"y": Column(file: "no.csv", column: "y")})"#, &["cannot read the table"]),
        (r#""a": Axes(titles: ("a", "b", "c"))"#, &["axes stand around an `object`"]),
        (r#""a": ColorBar(title: "p")"#, &["of an `object` or of a `material`", "needs one of them"]),
        (r#""a": ColorBar(object: "sheet", material: "none")"#, &["one too many"]),
        (r#""a": Grid(step: 0.001)"#, &["at most 1000 lines a side", "a longer `step`"]),
        (r#""a": Card(text: "below")"#, &["a card has no `title`"]),
    ] {
        let message = parse("a.ron", &scene(annotations)).expect_err(annotations).to_string();
        assert!(message.contains("a.ron:"), "{message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{annotations}: {message}");
    }
}

#[test]
fn missing_glyphs_are_named() {
    let folder = folder();
    fs::write(folder.path().join("a.ron"), scene(r#""note": Label(text: "漢 a", at: (0, 0, 0))"#))
        .expect("written");
    let output = run(folder.path(), &["check", "a.ron"]);
    let words = [output.stdout, output.stderr].concat();
    let words = String::from_utf8_lossy(&words);
    assert!(words.contains("the annotation \"note\" is without `漢`"), "{words}");
}

/// No text of the shipped examples is cut off or lies on another one, in pictures of twenty sizes.
#[test]
fn shipped_texts_have_room() {
    let sizes = [
        (160, 90),
        (176, 144),
        (240, 135),
        (320, 180),
        (320, 240),
        (400, 300),
        (480, 270),
        (480, 480),
        (640, 360),
        (640, 480),
        (800, 450),
        (800, 600),
        (960, 540),
        (1024, 768),
        (1280, 720),
        (1440, 900),
        (1920, 1080),
        (2560, 1440),
        (3440, 1440),
        (3840, 2160),
    ];
    for name in ["annotated-crank", "annotated-waves", "annotated-pendulum"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("sequences/{name}.ron"));
        let mut sequence = load(&path).unwrap_or_else(|error| panic!("{error}"));
        for size in sizes {
            sequence.output.size = size;
            let last = sequence.timeline.frames - 1;
            let frames = [0, 1, last / 4, last / 2, 3 * last / 4, last];
            for (drawing, frame) in
                kinora::pipeline::drawings::drawings(&sequence, &frames).iter().zip(frames)
            {
                let texts: Vec<_> = drawing.text_boxes().collect();
                assert!(texts.len() > 3, "{name}, frame {frame}");
                for (index, (text, [corner, extent])) in texts.iter().enumerate() {
                    let place = format!("{name}, frame {frame}, {size:?}: {:?}", text.text);
                    let end = *corner + *extent;
                    let within = corner.min_element() >= 0.0
                        && end.x <= f64::from(size.0)
                        && end.y <= f64::from(size.1);
                    assert!(within, "{place} is cut off");
                    for (other, [there, reach]) in &texts[..index] {
                        let apart = corner.cmpge(*there + *reach) | end.cmple(*there);
                        assert!(apart.any(), "{place} lies on {:?}", other.text);
                    }
                }
            }
        }
    }
}
