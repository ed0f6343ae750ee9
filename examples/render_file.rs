// Loads a sequence file and renders some of its frames into a GIF.

use kinora::{Output, ProgressMeter, Request, load, render};
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn Error>> {
    // A file with mistakes gives an error that shows all of them, each with its place.
    let mut sequence = load(Path::new("sequences/hello.ron"))?;
    sequence.output.size = (64, 36);

    // The extension says the format. A pattern such as "frame_####.png" makes a file per frame.
    let folder = tempfile::tempdir()?;
    let animation = folder.path().join("hello.gif");
    let mut request = Request::new(&sequence, vec![Output::parse(&animation)?]);
    request.frames = (0..sequence.timeline.frames).step_by(24).collect();

    // Another thread may watch the meter meanwhile.
    let meter = Arc::new(ProgressMeter::default());
    let summary = render(&sequence, &request, &meter)?;
    assert_eq!((summary.frames, summary.files), (3, vec![animation.clone()]));
    assert!(animation.exists());
    Ok(())
}
