//! Denoised frames: what they gain, and whether the error that they state is true.

use crate::command::{contents, folder, kinora, refused};
use crate::noise::{film, references, stated, true_error};
use crate::support::{Shot, sequence, shoot};
use kinora::sequence::Sequence;
use kinora::sequence::quality::Denoise;
use std::fs;

/// A room with a lamp, a mirror ball and a glass ball, by paths. Two lights have keys.
fn room(quality: &str) -> String {
    format!(
        r##"(output: (size: (64, 48)), quality: (integrator: Path(), bounces: 4, {quality}), background: 0.05,
        timeline: (frames: 4, keys: Frames), camera: (position: (0, 3, 8), target: (0, 1, 0)),
        lights: {{ "panel": Rectangle(corner: (-1, 4, -1), u: (2, 0, 0), v: (0, 0, 2), intensity: [(0, 6), (3, 1)]),
            "side": Sphere(center: (3, 2, 1), radius: 0.3, intensity: [(0, 1), (3, 20)], color: (1, 0.8, 0.5)) }},
        objects: {{
            "floor": (shape: Plane(), material: Lambertian(color: Checker(a: "#777", b: "#ccc"))),
            "wall": (shape: Box(min: (-4, 0, -3), max: (4, 5, -2.8)), material: Lambertian(color: (0.7, 0.5, 0.4))),
            "mirror": (shape: Sphere(center: (-1.3, 1, 0)), material: Metal(color: 0.9)),
            "glass": (shape: Sphere(center: (1.2, 0.8, 1), radius: 0.8), material: Dielectric(ior: 1.5)),
            "matt": (shape: Sphere(center: (0, 0.5, 2), radius: 0.5), material: Lambertian(color: (0.2, 0.6, 0.8))) }})"##
    )
}

fn both(quality: &str) -> [Sequence; 2] {
    let denoised = sequence(&room(quality));
    let mut plain = denoised.clone();
    plain.quality.denoise = Denoise::Off;
    [plain, denoised]
}

/// The squared error falls by three tenths at least here, where half of the picture is glass, mirrors and a pattern, and
/// nothing is larger than a few pixels.
#[test]
fn denoising_lowers_the_error() {
    let [plain, denoised] = both("samples: 16, denoise: Auto");
    let references = references(&plain, 0, 1024);
    let square = |sequence: &Sequence| -> f64 {
        let errors = (0..8).map(|seed| true_error(&film(sequence, 0, seed), &references));
        errors.map(|error| error * error).sum()
    };
    let (before, after) = (square(&plain), square(&denoised));
    assert!(after < 0.7 * before, "{before} {after}");
}

/// The stated error holds for every frame that shares the film, whatever the brightness of its lights.
fn hold_the_truth(cases: &[(u32, u32)], (runs, reference): (u32, u32), at_least: f64) {
    for (samples, frame) in cases {
        let sequence = sequence(&room(&format!("samples: {samples}, denoise: Auto")));
        let (inside, above, mean) = stated(&sequence, *frame, 0..runs, reference);
        assert!(inside >= at_least, "{samples} samples, frame {frame}: {inside}, {above} above, {mean}");
    }
}

/// Of 40 frames with a chance of 95 %, fewer than 34 are one case in 300.
#[test]
fn stated_errors_of_denoised_frames_are_true() {
    hold_the_truth(&[(16, 3)], (40, 1024), 0.85);
}

/// Of 200 frames with a chance of 95 %, fewer than 180 are one case in 900.
#[test]
#[ignore = "takes minutes; cargo test --release --test integration frames_are_true_over_200_seeds -- --ignored"]
fn stated_errors_of_denoised_frames_are_true_over_200_seeds() {
    hold_the_truth(&[(16, 0), (16, 3), (64, 1)], (200, 4096), 0.9);
}

/// Samples are added until the error of every frame that shares the film is below the target with its interval.
#[test]
fn targets_hold_for_denoised_frames() {
    let sequence = sequence(&room("noise: 0.05, denoise: Auto"));
    let (_, above, mean) = stated(&sequence, 3, 0..3, 1024);
    assert!(above <= 0.25 && mean < 0.05, "{above} {mean}");
}

/// A picture whose noise is in few pixels: a lamp seen through a ball of glass, and its caustic. Samples where the noise is
/// reach a target sooner than samples everywhere, denoised or not.
fn caustic(quality: &str) -> String {
    format!(
        r##"(output: (size: (96, 54)), quality: (integrator: Path(), bounces: 3, {quality}),
        camera: (position: (0, 2, 6), target: (0, 0.8, 0)),
        lights: {{ "lamp": Sphere(center: (2, 3, 1), radius: 0.4, intensity: 20) }},
        objects: {{ "floor": (shape: Plane(), material: (color: 0.6)),
            "ball": (shape: Sphere(center: (0, 1, 0)), material: Dielectric()),
            "box": (shape: Box(min: (1, 0, -1), max: (2, 1, 0)), material: (color: "#c04020")) }})"##
    )
}

/// The rays of a frame, its mean samples per pixel and its stated error.
fn work(text: &str) -> (u64, f64, f64) {
    let Shot { film, work } = shoot(&sequence(text), [0]).remove(0);
    let noise = film.noise.expect("a stated error");
    let rays = work.camera + work.mirror + work.transmitted + work.scattered + work.shadow;
    (rays, noise.samples, noise.error)
}

/// Asking for a denoised frame is never much dearer than asking for its samples alone: by the audits of the first rounds, four
/// samples a pixel or a few more. Without the comparison it takes fourteen times as many rays here.
#[test]
fn a_target_takes_hardly_more_work_with_the_denoiser_than_without() {
    for error in [0.1, 0.05, 0.02] {
        let [(alone, drawn, _), (denoised, samples, stated)] =
            ["Off", "Auto"].map(|denoise| work(&caustic(&format!("noise: {error}, denoise: {denoise}"))));
        let audits = 8.0 / drawn;
        let most = (1.1 + audits) * alone as f64;
        assert!(denoised as f64 <= most, "{error}: {alone} rays alone, {denoised} denoised, {drawn} samples");
        assert!(stated <= error && samples >= 16.0, "{error}: {samples} samples, {stated}");
    }
}

/// A picture that the denoiser smooths well.
fn smooth(size: (u32, u32), quality: &str) -> String {
    format!(
        r##"(output: (size: {size:?}), quality: (integrator: Path(), bounces: 3, {quality}),
        camera: (position: (0, 2, 6), target: (0, 1, 0)), background: 1, objects: {{
        "floor": (shape: Plane(), material: Lambertian(color: 0.7)),
        "ball": (shape: Sphere(center: (0, 1, 0)), material: Lambertian(color: (0.2, 0.5, 0.8))),
        "wall": (shape: Box(min: (-9, 0, -3), max: (9, 9, -2.8)), material: Lambertian(color: 0.5)) }})"##
    )
}

/// Where the denoiser wins, it is still used: with fewer samples than there are without.
#[test]
fn a_target_takes_less_work_where_the_denoiser_helps() {
    let [(alone, ..), (denoised, ..)] =
        ["Off", "Auto"].map(|denoise| work(&smooth((160, 100), &format!("noise: 0.03, denoise: {denoise}"))));
    assert!(denoised < alone, "{alone} rays alone, {denoised} denoised");
}

/// A limit of samples that both ways would reach does not decide for samples alone.
#[test]
fn a_limit_of_samples_leaves_the_denoiser_where_it_helps() {
    let at = |limit: u32, denoise: &str| {
        let quality = format!("noise: 0.01, max_samples: {limit}, denoise: {denoise}");
        work(&smooth((96, 64), &quality)).2
    };
    for limit in [64, 256] {
        let (alone, denoised) = (at(limit, "Off"), at(limit, "Auto"));
        assert!(denoised < 0.7 * alone, "{limit}: {alone} alone, {denoised} denoised");
    }
    // Below one round of both, the better film counts, whatever the limit is.
    for limit in [7, 16, 31, 40] {
        for error in [0.3, 0.15] {
            let quality = |denoise: &str| format!("noise: {error}, max_samples: {limit}, denoise: {denoise}");
            let [alone, denoised] = ["Off", "Auto"].map(|denoise| work(&caustic(&quality(denoise))).2);
            assert!(
                denoised < 1.15 * alone || denoised < error,
                "{limit}: {alone} alone, {denoised} denoised"
            );
        }
    }
}

/// A frame that goes on without the denoiser has the same bytes for any threads and shards, with a shutter, too.
#[test]
fn frames_that_go_on_without_the_denoiser_are_deterministic() {
    let folder = folder();
    let at = folder.path();
    let moving = caustic("noise: 0.1, denoise: Auto, shutter_steps: 4")
        .replace("(output:", "(timeline: (frames: 2, fps: 4), output:");
    let moving = moving.replace("target: (0, 0.8, 0))", "target: (0, 0.8, 0), shutter: 0.5)");
    let moving = moving.replace(
        "Sphere(center: (0, 1, 0))",
        "Sphere(center: (0, 1, 0)), translation: [(0, (0, 0, 0)), (1, (0.3, 0, 0))]",
    );
    // Rounds of all films would draw 20, 40 or 80 samples in every pixel.
    let (_, samples, _) = work(&moving);
    assert!(![20.0, 40.0, 80.0].contains(&samples), "{samples}");
    fs::write(at.join("a.ron"), moving).expect("the folder is writable");
    kinora(at, &["render", "a.ron", "--threads", "2", "-o", "a_#.png"]);
    kinora(at, &["render", "a.ron", "--threads", "1", "--shard", "2/2", "-o", "b_#.png"]);
    let files = contents(at);
    assert_eq!(files["a_1.png"], files["b_1.png"]);
}

/// The same bytes for any threads, shards and reuse; files state the error; and the next run keeps them.
#[test]
fn bytes_and_files() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("room.ron"), room("samples: 8, denoise: Auto")).expect("the folder is writable");
    let all = kinora(at, &["render", "room.ron", "--threads", "2", "-o", "a_##.png"]);
    assert!(all.contains("with 95 % confidence"), "{all}");
    let alone = ["--no-reuse", "--frames", "3"];
    kinora(at, &[&["render", "room.ron", "--threads", "1", "-o", "b_##.png"], &alone[..]].concat());
    kinora(at, &["render", "room.ron", "--shard", "1/2", "-o", "c_##.png"]);
    let files = contents(at);
    assert_eq!(files["a_03.png"], files["b_03.png"]);
    for (name, bytes) in files.iter().filter(|(name, _)| name.starts_with("c_")) {
        assert_eq!(*bytes, files[&name.replace('c', "a")]);
    }
    let text = String::from_utf8_lossy(&files["a_03.png"]).into_owned();
    assert!(text.contains("kinora:error") && text.contains("kinora:denoise"));
    let again = kinora(at, &["render", "room.ron", "-o", "a_##.png"]);
    assert!(again.contains("with 95 % confidence") && again.contains("4 of them kept"), "{again}");
    let noisy = kinora(at, &["render", "room.ron", "--frames", "3", "-o", "d_##.png", "--samples", "12"]);
    // 12, and two for each audit.
    assert!(noisy.contains("16 samples a pixel"), "{noisy}");
}

/// Four frames in two different rooms: a bright one that is smooth, and a dark one with a ball of glass.
const TWO_ROOMS: &str = "(timeline: (frames: 4, keys: Frames), output: (size: (96, 64)),
    quality: (integrator: Path(), bounces: 3, noise: 0.03, denoise: Auto),
    camera: (position: (0, 2, 6), target: (0, 1, 0)), background: [(0, 1), (2, 0, Step)],
    lights: { \"lamp\": Sphere(center: (2, 3, 1), radius: 0.4, intensity: 20, on: [(0, false), (2, true)]) },
    objects: { \"floor\": (shape: Plane(), material: (color: 0.7)),
        \"ball\": (shape: Sphere(center: (0, 1, 0)), visible: [(0, true), (2, false)]),
        \"glass\": (shape: Sphere(center: (0, 1, 0)), material: Dielectric(), visible: [(0, false), (2, true)]),
        \"wall\": (shape: Box(min: (-9, 0, -3), max: (9, 9, -2.8)), material: (color: 0.5)) })";

/// Frames that kept their samples are named in the summary, in files, and again where files are kept.
#[test]
fn frames_that_kept_their_samples_are_named() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("rooms.ron"), TWO_ROOMS).expect("the folder is writable");
    let render = |more: &[&str]| kinora(at, &[&["render", "rooms.ron"], more].concat());
    let outputs = ["-o", "a_#.png", "-o", "a_#.exr"];
    let first = render(&outputs);
    let named = "denoised 2 of 4 frames; frames 2-3 kept their samples";
    assert!(first.contains(named), "{first}");
    for (frame, denoised) in [(0, true), (1, true), (2, false), (3, false)] {
        let texts = kinora::encode::frame_texts(&at.join(format!("a_{frame}.png")));
        let stated = texts.iter().find(|(keyword, _)| keyword == "kinora:error");
        let word = format!(" denoised={denoised}");
        assert!(stated.is_some_and(|(_, text)| text.ends_with(&word)), "{frame}: {texts:?}");
        let exr = fs::read(at.join(format!("a_{frame}.exr"))).expect("a frame");
        assert!(exr.windows(word.len()).any(|window| window == word.as_bytes()), "{frame}");
    }
    let again = render(&outputs);
    assert!(again.contains(named) && again.contains("4 of them kept"), "{again}");
    let json = render(&[&outputs[..], &["--progress", "json"]].concat());
    assert_eq!(
        [true, false].map(|denoised| json.matches(&format!("\"denoised\":{denoised}")).count()),
        [2, 2]
    );
    let all = render(&["-o", "b_#.png", "--samples", "8"]);
    assert!(all.contains("denoised all 4 frames"), "{all}");
    let without = render(&["-o", "c_#.png", "--no-denoise", "--noise", "0.2"]);
    assert!(!without.contains("denoised"), "{without}");
}

/// Frames without random samples are the same with and without the denoiser.
#[test]
fn exact_frames_stay_as_they_are() {
    let folder = folder();
    let at = folder.path();
    kinora(at, &["render", "ball.ron", "--frames", "5", "-o", "a_##.png"]);
    kinora(at, &["render", "ball.ron", "--frames", "5", "--denoise", "-o", "b_##.png"]);
    let files = contents(at);
    assert_eq!(files["a_05.png"], files["b_05.png"]);
}

#[test]
fn other_words_are_refused() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("bad.ron"), room("denoise: On")).expect("the folder is writable");
    let message = refused(at, &["check", "bad.ron"]);
    assert!(message.contains("`Off` or `Auto`") || message.contains("`Auto`"), "{message}");
}
