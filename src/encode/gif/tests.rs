//! GIFs read back with the `gif` crate.

use super::*;
use crate::base::time::Rate;
use crate::encode::{
    AnimationFormat, DEFAULT_BACKGROUND_COLOR, Formats, GifSettings, Output, SequenceInfo, Tonemap,
};
use ::gif::{ColorOutput, DecodeOptions, DisposalMethod, Repeat};
use std::collections::HashMap;
use std::fs;

const SETTINGS: GifSettings = GifSettings { loop_count: None, colors: 256, dither: true, max_size: None };

/// A GIF as a viewer shows it.
struct Shown {
    size: (u16, u16),
    repeat: Repeat,
    delays: Vec<u64>,
    /// RGB per composed frame.
    frames: Vec<Vec<[u8; 3]>>,
    /// Pixels per stored frame.
    stored: Vec<usize>,
    colors: usize,
}

fn show(path: &Path) -> Shown {
    let mut options = DecodeOptions::new();
    options.set_color_output(ColorOutput::RGBA);
    let mut decoder = options.read_info(fs::File::open(path).expect("a file")).expect("a GIF");
    let size = (decoder.width(), decoder.height());
    let width = usize::from(size.0);
    let colors = decoder.global_palette().expect("a palette").len() / 3;
    let mut canvas = vec![[0; 3]; width * usize::from(size.1)];
    let mut shown =
        Shown { size, repeat: Repeat::default(), delays: vec![], frames: vec![], stored: vec![], colors };
    while let Some(frame) = decoder.read_next_frame().expect("a frame") {
        assert_eq!(frame.dispose, DisposalMethod::Keep);
        let pixels = frame.buffer.as_chunks::<4>().0;
        for (i, &[r, g, b, a]) in pixels.iter().enumerate() {
            let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
            if a > 0 {
                canvas[(y + usize::from(frame.top)) * width + x + usize::from(frame.left)] = [r, g, b];
            }
        }
        shown.delays.push(u64::from(frame.delay));
        shown.frames.push(canvas.clone());
        shown.stored.push(pixels.len());
    }
    shown.repeat = decoder.repeat();
    shown
}

/// A GIF with transparent pixels as a viewer shows it: None where a pixel is transparent.
fn show_clear(path: &Path) -> Vec<(Vec<Option<[u8; 3]>>, u64)> {
    let mut options = DecodeOptions::new();
    options.set_color_output(ColorOutput::RGBA);
    let mut decoder = options.read_info(fs::File::open(path).expect("a file")).expect("a GIF");
    let (width, height) = (usize::from(decoder.width()), usize::from(decoder.height()));
    let mut shown = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("a frame") {
        // Every frame is cleared before the next, so each starts with a transparent canvas.
        assert_eq!(frame.dispose, DisposalMethod::Background);
        let mut canvas = vec![None; width * height];
        for (i, &[r, g, b, a]) in frame.buffer.as_chunks::<4>().0.iter().enumerate() {
            let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
            let place = (y + usize::from(frame.top)) * width + x + usize::from(frame.left);
            canvas[place] = (a > 0).then_some([r, g, b]);
        }
        shown.push((canvas, u64::from(frame.delay)));
    }
    shown
}

/// A block of 3x2 pixels that moves over a transparent background, stays, and disappears.
#[test]
fn transparent_pixels_stay_transparent() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.gif");
    let picture = |place: Option<usize>| {
        let opaque = |i: usize| {
            place.is_some_and(|left| (left..left + 3).contains(&(i % 16)) && (2..4).contains(&(i / 16)))
        };
        let rgb = (0..160).flat_map(|i| if opaque(i) { [200, i as u8, 0] } else { [255; 3] }).collect();
        let alpha = (0..160).map(|i| if opaque(i) { 255 } else { 0 }).collect();
        Picture { alpha: Some(alpha), ..Picture::opaque(16, 10, rgb) }
    };
    let pictures = [Some(1), Some(9), Some(9), None, Some(0)].map(picture);
    for colors in [256, 4] {
        let gif = GifSettings { colors, dither: false, ..SETTINGS };
        let job = EncodeJob { transparent: true, ..job(&path, &pictures, (10, 1), gif) };
        let mut animation = Animation::new(&path, &job).expect("a GIF");
        pictures.iter().for_each(|picture| animation.count(picture));
        animation.write(|index| Ok(pictures[index].clone())).expect("written");
        let shown = show_clear(&path);
        assert_eq!(shown.iter().map(|(_, delay)| *delay).collect::<Vec<_>>(), [10, 20, 10, 10]);
        for (shown, picture) in shown.iter().map(|(shown, _)| shown).zip([0, 1, 3, 4].map(|i| &pictures[i])) {
            let pixels = picture.rgb.as_chunks::<3>().0.iter().zip(picture.alpha.iter().flatten());
            for (shown, (color, alpha)) in shown.iter().zip(pixels) {
                assert_eq!(shown.is_some(), *alpha == 255);
                assert!(colors == 4 || shown.is_none_or(|shown| shown == *color), "{shown:?} {color:?}");
            }
        }
    }
    // A delay that is too long for one frame.
    let gif = GifSettings { colors: 256, ..SETTINGS };
    let job = EncodeJob { transparent: true, ..job(&path, &pictures[..1], (1, 1000), gif) };
    let mut animation = Animation::new(&path, &job).expect("a GIF");
    animation.count(&pictures[0]);
    animation.write(|_| Ok(pictures[0].clone())).expect("written");
    let shown = show_clear(&path);
    assert_eq!(shown.iter().map(|(_, delay)| delay).sum::<u64>(), 100_000);
    assert!(shown.len() > 1 && shown.iter().all(|(canvas, _)| *canvas == shown[0].0));
}

fn job(path: &Path, pictures: &[Picture], rate: (i128, i128), gif: GifSettings) -> EncodeJob {
    EncodeJob {
        confined: false,
        existing: crate::encode::Existing::default(),
        frame_keys: Vec::new(),
        outputs: vec![Output::Movie(AnimationFormat::Gif, path.to_path_buf())],
        frames: (0..pictures.len() as u32).collect(),
        rate: Rate::new(rate.0, rate.1).expect("a rate"),
        size: (pictures[0].width, pictures[0].height),
        tonemap: Tonemap::Srgb,
        transparent: false,
        background_color: DEFAULT_BACKGROUND_COLOR,
        drawings: Vec::new(),
        formats: Formats { gif, ..Formats::default() },
        info: SequenceInfo::default(),
    }
}

fn write(path: &Path, job: &EncodeJob, pictures: &[Picture]) -> Option<String> {
    let mut animation = Animation::new(path, job).expect("a fitting job");
    for (index, picture) in pictures.iter().enumerate() {
        if animation.shows(index) {
            animation.count(picture);
        }
    }
    animation.write(|index| Ok(pictures[index].clone())).expect("written")
}

fn make(pictures: &[Picture], rate: (i128, i128), gif: GifSettings) -> Shown {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.gif");
    write(&path, &job(&path, pictures, rate, gif), pictures);
    show(&path)
}

fn picture(width: u32, height: u32, color: impl Fn(u32, u32) -> [u8; 3]) -> Picture {
    let rgb = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Picture::opaque(width, height, rgb.flat_map(|(x, y)| color(x, y)).collect())
}

/// A square that moves over one colour: few colours.
fn moving(frame: u32) -> Picture {
    let inside = move |x: u32, y: u32| (frame..frame + 4).contains(&x) && (3..7).contains(&y);
    picture(20, 12, move |x, y| if inside(x, y) { [255, 9, 0] } else { [0, (y % 2) as u8, 40] })
}

/// A gradient in which a part moves: many colours.
fn gradient(frame: u32) -> Picture {
    picture(96, 64, move |x, y| {
        let inside = (30 + frame..50 + frame).contains(&x) && (20..40).contains(&y);
        let shift = if inside { 3 * frame } else { 0 };
        [(x * 2 + shift) as u8, (y * 3) as u8, ((x + y) / 2) as u8]
    })
}

fn pixels(picture: &Picture) -> &[[u8; 3]] {
    picture.rgb.as_chunks::<3>().0
}

#[test]
fn few_colors_are_kept_exactly() {
    let pictures: Vec<_> = (0..10).map(moving).collect();
    for colors in [2, 3, 4, 16, 256] {
        let shown = make(&pictures, (24, 1), GifSettings { colors, ..SETTINGS });
        assert_eq!(shown.size, (20, 12));
        assert_eq!(shown.delays, [4, 4, 5, 4, 4, 4, 4, 4, 5, 4]);
        let exact = shown.frames.iter().zip(&pictures).all(|(frame, picture)| frame == pixels(picture));
        assert_eq!(exact, colors >= 3, "{colors} colours");
        assert!(shown.colors <= usize::from(colors).next_power_of_two());
        assert!(colors < 3 || shown.stored[1..].iter().all(|&stored| stored == 5 * 4));
    }
}

#[test]
fn many_colors_come_close_and_do_not_shimmer() {
    let pictures: Vec<_> = (0..12).map(gradient).collect();
    for dither in [true, false] {
        let shown = make(&pictures, (30, 1), GifSettings { dither, ..SETTINGS });
        assert_eq!(shown.frames.len(), pictures.len());
        let mut seen = HashMap::new();
        let mut error = 0.0;
        for (frame, picture) in shown.frames.iter().zip(&pictures) {
            for (place, (got, wanted)) in frame.iter().zip(pixels(picture)).enumerate() {
                assert_eq!(seen.entry((place, wanted)).or_insert(got), &got, "shimmer at {place}");
                error += got.iter().zip(wanted).map(|(g, w)| f64::from(g.abs_diff(*w))).sum::<f64>();
            }
        }
        let mean = error / (12.0 * 96.0 * 64.0 * 3.0);
        assert!(mean < if dither { 9.0 } else { 5.0 }, "mean error {mean}, dither {dither}");
        assert!(shown.stored[1..].iter().all(|&stored| stored <= 21 * 20));
    }
}

#[test]
fn dithering_preserves_the_light_of_areas() {
    let pictures = [gradient(0)];
    let shown = make(&pictures, (24, 1), GifSettings { colors: 64, ..SETTINGS });
    let linear = |code: u8| crate::base::color::srgb_to_linear(f64::from(code) / 255.0);
    for block in 0..24 {
        let (left, top) = (block % 6 * 16, block / 6 * 16);
        let places = || (0..256).map(|i| (top + i / 16) * 96 + left + i % 16);
        for channel in 0..3 {
            let got: f64 = places().map(|p| linear(shown.frames[0][p][channel])).sum();
            let wanted: f64 = places().map(|p| linear(pixels(&pictures[0])[p][channel])).sum();
            assert!((got - wanted).abs() / 256.0 < 0.06, "block {block} channel {channel}: {got} {wanted}");
        }
    }
}

#[test]
fn loop_counts() {
    let pictures: Vec<_> = (0..2).map(moving).collect();
    let repeat = |loop_count| make(&pictures, (24, 1), GifSettings { loop_count, ..SETTINGS }).repeat;
    assert_eq!(repeat(None), Repeat::Infinite);
    assert_eq!(repeat(Some(1)), Repeat::Finite(0));
    assert_eq!(repeat(Some(2)), Repeat::Finite(1));
    assert_eq!(repeat(Some(u16::MAX)), Repeat::Finite(u16::MAX - 1));
}

#[test]
fn equal_frames_become_one_longer_frame() {
    let pictures: Vec<_> = [0, 0, 0, 5, 5, 6].into_iter().map(moving).collect();
    let shown = make(&pictures, (24, 1), SETTINGS);
    assert_eq!(shown.delays, [13, 8, 4]);
}

#[test]
fn long_holds_are_split_without_a_change() {
    let shown = make(&[moving(0), moving(0), moving(4)], (1, 1000), SETTINGS);
    assert_eq!(shown.delays, [50_000; 6]);
    assert!(shown.frames[..4].iter().all(|frame| frame == pixels(&moving(0))));
    assert!(shown.frames[4..].iter().all(|frame| frame == pixels(&moving(4))));
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let pictures: Vec<_> = (0..9).map(gradient).collect();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let shown = pool.install(|| make(&pictures, (30, 1), SETTINGS));
        (shown.frames, shown.stored, shown.delays)
    };
    assert!(with(1) == with(4));
}

#[test]
fn the_smallest_pictures() {
    for colors in [2, 256] {
        let pictures: Vec<_> = (0..3u8).map(|k| picture(1, 1, move |_, _| [k * 100; 3])).collect();
        let shown = make(&pictures, (10, 1), GifSettings { colors, ..SETTINGS });
        assert_eq!(shown.size, (1, 1));
        assert_eq!(shown.delays.iter().sum::<u64>(), 30);
    }
}

#[test]
fn the_maximum_size_is_kept_and_the_loss_is_noted() {
    let pictures: Vec<_> = (0..12).map(gradient).collect();
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.gif");
    let written = |max_size| {
        let job = job(&path, &pictures, (24, 1), GifSettings { max_size, ..SETTINGS });
        let note = write(&path, &job, &pictures);
        (fs::metadata(&path).expect("a file").len(), note)
    };
    let (whole, note) = written(None);
    assert_eq!((note, written(Some(whole)).1), (None, None));
    for share in [0.8, 0.4, 0.1] {
        let most = (whole as f64 * share) as u64;
        let (size, note) = written(Some(most));
        let note = note.expect("a note");
        assert!(size <= most && size as f64 > 0.2 * most as f64, "{size} of {most}: {note}");
        assert!(note.contains("would have") && note.contains("instead of"), "{note}");
        let shown = show(&path);
        assert_eq!(shown.delays.iter().sum::<u64>(), 50);
    }
    let (_, note) = written(Some(100));
    assert!(note.expect("a note").contains("cannot be made as small as"));
}
