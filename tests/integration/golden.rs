//! Golden images: each `tests/golden/NAME.ron`, rendered to PNGs as users do, gives exactly the pixels of
//! `tests/golden/NAME.png`, which shows its frames side by side. `KINORA_BLESS=1` writes them as they are now.

use image::{Rgb, RgbImage, imageops};
use kinora::base::stats::Meter;
use kinora::encode::{Existing, Output};
use kinora::pipeline::render::{Request, Reuse, render};
use kinora::sequence::load;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// All golden sequences, in order of their names.
pub fn sequences() -> Vec<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let entries = std::fs::read_dir(directory).expect("tests/golden");
    let mut files: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "ron"));
    files.sort();
    files
}

/// A sequence's frames, rendered to files and read again, side by side.
fn rendered(path: &Path) -> RgbImage {
    let sequence = load(path).unwrap_or_else(|error| panic!("{error}"));
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let pattern = folder.path().join("##.png").to_string_lossy().into_owned();
    let output = Output::parse(&pattern).expect("a pattern");
    let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
    let request = Request {
        frames: frames.clone(),
        outputs: vec![output.clone()],
        confined: false,
        existing: Existing::Replace,
        threads: None,
        reuse: Reuse::Share,
        time_limit: None,
    };
    render(&sequence, &request, &Arc::new(Meter::default())).unwrap_or_else(|error| panic!("{error}"));
    let pictures: Vec<_> = frames.iter().map(|&frame| read(&output.path(frame))).collect();
    let (width, height) = sequence.output.size;
    let mut sheet = RgbImage::new(width * frames.len() as u32, height);
    for (left, picture) in (0..).step_by(width as usize).zip(&pictures) {
        imageops::replace(&mut sheet, picture, left, 0);
    }
    sheet
}

fn read(path: &Path) -> RgbImage {
    image::open(path).unwrap_or_else(|error| panic!("{path:?}: {error}")).into_rgb8()
}

/// Expected, difference and actual, one below the other. Differences are stretched, so that one code shows.
fn strip(expected: &RgbImage, actual: &RgbImage) -> RgbImage {
    let (width, height) = (expected.width().max(actual.width()), expected.height().max(actual.height()));
    let at = |picture: &RgbImage, x, y| picture.get_pixel_checked(x, y).map_or([0; 3], |pixel| pixel.0);
    let difference = RgbImage::from_fn(width, height, |x, y| {
        let (e, a) = (at(expected, x, y), at(actual, x, y));
        let stretched = |i: usize| match e[i].abs_diff(a[i]) {
            0 => 0,
            difference => difference.saturating_add(63),
        };
        Rgb([stretched(0), stretched(1), stretched(2)])
    });
    let mut strip = RgbImage::new(width, 3 * height);
    for (row, picture) in [expected, &difference, actual].into_iter().enumerate() {
        imageops::replace(&mut strip, picture, 0, (row as u32 * height).into());
    }
    strip
}

#[test]
fn golden_images_have_not_changed() {
    let bless = std::env::var_os("KINORA_BLESS").is_some();
    let sequences = sequences();
    assert!(sequences.len() >= 5, "the golden sequences have shrunk to {}", sequences.len());
    let mut wrong = Vec::new();
    for path in sequences {
        let (actual, golden) = (rendered(&path), path.with_extension("png"));
        if bless {
            actual.save(&golden).expect("a writable tests/golden");
            continue;
        }
        let expected = if golden.exists() { read(&golden) } else { RgbImage::new(1, 1) };
        if expected != actual {
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            let shown = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("golden-{name}.png"));
            strip(&expected, &actual).save(&shown).expect("the folder is writable");
            let count = expected.pixels().zip(actual.pixels()).filter(|(e, a)| e != a).count();
            wrong.push(format!(
                "{name}: {count} pixels; expected, difference, actual: {}",
                shown.to_string_lossy()
            ));
        }
    }
    assert!(wrong.is_empty(), "golden images differ\n{}", wrong.join("\n"));
}
