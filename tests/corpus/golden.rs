//! Golden images: each `tests/golden/NAME.ron` gives exactly the pixels of `tests/golden/NAME.png`, which shows its
//! frames side by side.

use crate::bless;
use crate::render::{pictures, read};
use image::{Rgb, RgbImage, imageops};
use kinora::sequence::load;
use libtest_mimic::Failed;
use std::path::Path;

pub fn check(path: &Path) -> Result<(), Failed> {
    let (actual, golden) = (rendered(path)?, path.with_extension("png"));
    if bless() {
        return Ok(actual.save(&golden)?);
    }
    let expected = if golden.exists() { read(&golden) } else { RgbImage::new(1, 1) };
    if expected == actual {
        return Ok(());
    }
    let name = path.file_stem().expect("a name").to_string_lossy();
    let shown = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("golden-{name}.png"));
    strip(&expected, &actual).save(&shown)?;
    let count = expected.pixels().zip(actual.pixels()).filter(|(e, a)| e != a).count();
    Err(format!("{count} pixels differ; expected, difference, actual: {}", shown.to_string_lossy()).into())
}

/// A sequence's frames side by side.
fn rendered(path: &Path) -> Result<RgbImage, Failed> {
    let sequence = load(path)?;
    let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
    let (width, height) = sequence.output.size;
    let mut sheet = RgbImage::new(width * frames.len() as u32, height);
    for (left, picture) in (0..).step_by(width as usize).zip(&pictures(&sequence, &frames).0) {
        imageops::replace(&mut sheet, picture, left, 0);
    }
    Ok(sheet)
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
