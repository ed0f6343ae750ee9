//! Frames of a sequence, rendered to PNGs as users do.

use image::RgbImage;
use kinora::base::stats::ProgressMeter;
use kinora::encode::{Existing, Output};
use kinora::pipeline::render::{Request, Reuse, Summary, render};
use kinora::sequence::Sequence;
use std::path::Path;
use std::sync::Arc;

/// The pictures of some frames, and what the run did.
pub fn pictures(sequence: &Sequence, frames: &[u32]) -> (Vec<RgbImage>, Summary) {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let pattern = folder.path().join("##.png").to_string_lossy().into_owned();
    let output = Output::parse(&pattern).expect("a pattern");
    let request = Request {
        frames: frames.to_vec(),
        outputs: vec![output.clone()],
        confined: false,
        existing: Existing::Replace,
        threads: None,
        reuse: Reuse::Share,
        time_limit: None,
    };
    let summary = render(sequence, &request, &Arc::new(ProgressMeter::default()))
        .unwrap_or_else(|error| panic!("{error}"));
    (frames.iter().map(|&frame| read(&output.path(frame))).collect(), summary)
}

pub fn read(path: &Path) -> RgbImage {
    image::open(path).unwrap_or_else(|error| panic!("{path:?}: {error}")).into_rgb8()
}
