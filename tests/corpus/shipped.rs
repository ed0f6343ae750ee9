//! The sequences of the repository load, and a small version of them renders.

use crate::meshes;
use crate::render::pictures;
use image::RgbImage;
use kinora::pipeline::render::Summary;
use kinora::sequence::load;
use libtest_mimic::Failed;
use std::path::Path;

/// Pixels of a small picture.
const SIZE: (u32, u32) = (32, 24);

/// The first frame and the one in the middle show something.
pub fn check(path: &Path) -> Result<(), Failed> {
    render(path, SIZE).map(drop)
}

/// Bench sequences also trace the camera rays that the scripts of other renderers ask for.
pub fn check_bench(path: &Path) -> Result<(), Failed> {
    let samples = match path.file_stem().expect("a name").to_str() {
        Some("glazed" | "mesh") => 1,
        Some("weekend" | "mesh-path") => 16,
        name => {
            return Err(format!("how many samples other renderers take is not known here: {name:?}").into());
        }
    };
    let summary = render(path, SIZE)?;
    let expected = u64::from(SIZE.0 * SIZE.1 * samples) * u64::from(summary.frames - summary.reused);
    match summary.counts.rays.camera {
        rays if rays == expected => Ok(()),
        rays => Err(format!("{rays} camera rays in place of {expected}").into()),
    }
}

fn render(path: &Path, size: (u32, u32)) -> Result<Summary, Failed> {
    meshes::make();
    let mut sequence = load(path)?;
    sequence.output.size = size;
    let mut frames = vec![0, sequence.timeline.frames / 2];
    frames.dedup();
    let (pictures, summary) = pictures(&sequence, &frames);
    match pictures.iter().position(is_uniform) {
        Some(at) => Err(format!("frame {} shows nothing", frames[at]).into()),
        None => Ok(summary),
    }
}

/// Whether all pixels have one colour.
fn is_uniform(picture: &RgbImage) -> bool {
    picture.pixels().all(|pixel| pixel == picture.get_pixel(0, 0))
}
