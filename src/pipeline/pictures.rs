//! Frames in memory, for programs that show them or compute with them, and files from such frames.

use super::drawings::drawings;
use super::memory;
use super::plan::{self, Plan, evaluate_until};
use super::render::{MemoryUse, RenderError, Reuse, Summary, pool, summary};
use super::schedule::{FilmSink, FrameLoop};
use crate::base::cancel::Stop;
use crate::base::color::Rgb;
use crate::base::stats::ProgressMeter;
use crate::drawing::Drawing;
use crate::encode::{
    AnimationAssembler, EncodeError, EncodeJob, Existing, Output, Picture, Report, ToneTable, write_picture,
};
use crate::film::{AovSet, Film};
use crate::sequence::Sequence;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

/// The frames to render into memory.
#[derive(Clone, Debug)]
pub struct PicturesRequest {
    /// Frame numbers in the order of rendering.
    pub frames: Vec<u32>,
    /// Whether frames have their linear radiance, too.
    pub radiance: bool,
    /// Number of tracing threads. If absent, one for each processor of the machine.
    pub threads: Option<NonZeroUsize>,
    /// Memory for films that frames share.
    pub reuse: Reuse,
}

/// A frame in memory.
#[derive(Clone, Debug)]
pub struct FramePicture {
    /// The number of the frame.
    pub frame: u32,
    /// The picture as files show it, with alpha if the sequence's background is transparent.
    pub picture: Picture,
    /// If requested: radiance before exposure, tone mapping and annotations, row by row from the top left pixel.
    pub radiance: Option<Vec<Rgb>>,
}

/// A sink that develops films and draws their annotations.
struct Developer {
    table: ToneTable,
    drawings: Vec<Arc<Drawing>>,
    radiance: bool,
    done: Vec<FramePicture>,
}

impl FilmSink for Developer {
    fn push(&mut self, frame: u32, film: Film) -> Result<(), EncodeError> {
        let mut picture = self.table.develop(&film).0;
        if let Some(drawing) = self.drawings.get(self.done.len()) {
            drawing.draw(&mut picture);
        }
        let radiance = self.radiance.then(|| film.radiance().collect());
        self.done.push(FramePicture { frame, picture, radiance });
        Ok(())
    }
}

/// Renders frames into memory. Another thread may watch `meter` meanwhile.
///
/// # Errors
/// Too little memory for all pictures, frames that cannot be rendered, and [`RenderError::Stopped`] if `stop` is set: the
/// run ends after the current frame, or with the current samples if a target error is set.
pub fn render_pictures(
    sequence: &Sequence,
    request: &PicturesRequest,
    meter: &Arc<ProgressMeter>,
    stop: &Stop,
) -> Result<(Vec<FramePicture>, Summary), RenderError> {
    let start = Instant::now();
    let _ = meter.stop.set(stop.clone());
    let (frames, count) = (&request.frames, request.frames.len());
    let aovs = AovSet::of_picture(sequence.output.transparent);
    let pictures = memory::for_pictures(sequence, count, request.radiance);
    MemoryUse::Pictures.check(memory::needed(sequence, aovs).saturating_add(pictures))?;
    let pool = pool(request.threads)?;
    let developer = Developer {
        table: ToneTable::new(sequence.output.tonemap),
        drawings: pool.install(|| drawings(sequence, frames)),
        radiance: request.radiance,
        done: Vec::new(),
    };
    let mut run = FrameLoop::with_aovs(sequence, aovs, developer, Arc::clone(meter));
    run.report_frames();
    let done = pool.install(|| {
        let states = evaluate_until(sequence, frames, stop);
        let plan = Plan::from_states(states, sequence, aovs, request.reuse.budget(sequence, aovs));
        meter.begin(0, Vec::new());
        plan::run(&plan, &mut run, || stop.signal().is_none())
    })?;
    if let Some(signal) = stop.signal().filter(|_| done < count) {
        let rest = frames[done..].to_vec();
        return Err(RenderError::Stopped { signal, done, files: Vec::new(), rest, keeps: false });
    }
    let stats = run.stats().clone();
    let done = run.into_sink().map_or_else(Vec::new, |developer| developer.done);
    let mut summary = summary(&stats, Report::default(), count as u32, start.elapsed());
    summary.notes.splice(..0, sequence.notes());
    Ok((done, summary))
}

/// Writes pictures of these frames of a sequence into files: an animation of all, or a still of each, of 8 bits per
/// channel. The pictures may have been changed since.
///
/// # Errors
/// Pictures of several sizes, formats that hold light instead of pictures, and files that cannot be written.
pub fn write_pictures(
    sequence: &Sequence,
    (frames, pictures): (&[u32], &[Picture]),
    output: &Output,
) -> Result<Report, RenderError> {
    let settings = &sequence.output;
    let pool = Arc::new(pool(None)?);
    let job = EncodeJob {
        outputs: vec![output.clone()],
        confined: false,
        existing: Existing::Replace,
        frames: frames.to_vec(),
        frame_keys: Vec::new(),
        rate: sequence.timeline.rate,
        size: pictures.first().map_or(settings.size, |picture| (picture.width, picture.height)),
        tonemap: settings.tonemap,
        transparent: pictures.iter().any(|picture| picture.alpha.is_some()),
        background_color: settings.background_color,
        drawings: pool.install(|| drawings(sequence, frames)),
        formats: settings.formats,
        info: sequence.about(),
    };
    let mut assembler = AnimationAssembler::start(job, pool)?;
    for (&frame, picture) in frames.iter().zip(pictures) {
        assembler.push(picture)?;
        if output.is_animation() {
            continue;
        }
        match output.takes_alpha() {
            true => write_picture(output, frame, picture, settings.formats)?,
            false => {
                write_picture(output, frame, &picture.over(settings.background_color), settings.formats)?
            }
        }
    }
    Ok(assembler.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::stats::ProgressMeter;
    use crate::encode::read_picture;
    use crate::pipeline::render::{Request, render};
    use crate::sequence::parse;
    use std::fs;

    /// A ball that moves, and stands still in the last frame; with a caption.
    const BALL: &str = r##"(
        timeline: (frames: 4, fps: 24, keys: Frames),
        output: (size: (40, 24), caption: (text: "{frame}"), exposure: 0.5),
        background: "#336699",
        camera: (position: (0, 0, 5)),
        lights: { "lamp": Point(position: (3, 4, 5)) },
        objects: { "ball": (shape: Sphere(), translation: [(0, (0, 0, 0)), (2, (1, 0, 0))]) },
    )"##;

    fn sequence(transparent: bool) -> Sequence {
        let mut sequence = parse("ball.ron", BALL).expect("a sequence");
        sequence.output.transparent = transparent;
        sequence
    }

    fn request(frames: &[u32]) -> PicturesRequest {
        PicturesRequest {
            frames: frames.to_vec(),
            radiance: true,
            threads: NonZeroUsize::new(2),
            reuse: Reuse::Share,
        }
    }

    fn rendered(sequence: &Sequence, frames: &[u32]) -> (Vec<FramePicture>, Summary) {
        render_pictures(sequence, &request(frames), &Arc::default(), &Stop::default()).expect("pictures")
    }

    #[test]
    fn pictures_and_files_made_from_them_are_those_of_a_render() {
        for transparent in [false, true] {
            let sequence = sequence(transparent);
            let folder = tempfile::tempdir().expect("a folder");
            let outputs = ["f_##.png", "f_##.jpg", "a.gif", "a.apng", "a.webp"];
            let output = |kind: &str, name: &str| {
                Output::parse(folder.path().join(kind).join(name)).expect("an output")
            };
            let wanted = outputs.iter().map(|name| output("wanted", name)).collect();
            let mut files = Request::new(&sequence, wanted);
            files.frames = vec![3, 0, 1];
            let done = render(&sequence, &files, &Arc::new(ProgressMeter::default())).expect("files");

            let (found, summary) = rendered(&sequence, &[3, 0, 1]);
            assert_eq!((summary.frames, summary.counts), (3, done.counts));
            let pictures: Vec<Picture> = found.iter().map(|frame| frame.picture.clone()).collect();
            for (frame, number) in found.iter().zip([3, 0, 1]) {
                let file = read_picture(&output("wanted", "f_##.png").path(number)).expect("a frame");
                assert_eq!((frame.frame, &frame.picture), (number, &file));
            }
            for name in outputs {
                write_pictures(&sequence, (&[3, 0, 1], &pictures), &output("found", name)).expect("a file");
                let [wanted, found] = ["wanted", "found"].map(|kind| output(kind, name).path(1));
                if name == "f_##.png" {
                    let [wanted, found] = [wanted, found].map(|path| read_picture(&path).expect("a frame"));
                    assert_eq!(wanted, found);
                } else {
                    let [wanted, found] = [wanted, found].map(|path| fs::read(path).expect("a file"));
                    assert!(wanted == found, "{name} differs");
                }
            }
        }
    }

    #[test]
    fn radiance_is_what_the_scene_sends_without_exposure_and_annotations() {
        let (found, _) = rendered(&sequence(false), &[0]);
        let radiance = found[0].radiance.as_ref().expect("radiance");
        assert_eq!(radiance.len(), 40 * 24);
        let background = crate::base::color::hex_color("#336699").expect("a colour");
        assert_eq!(radiance[0], background);
        assert!(radiance[12 * 40 + 20].max_element() > 0.1, "the ball");
        assert!(radiance.iter().all(|light| light.is_finite()));
    }

    #[test]
    fn a_stop_ends_the_run_between_frames() {
        let (stop, meter) = (Stop::default(), Arc::default());
        stop.flag().store(2, std::sync::atomic::Ordering::Relaxed);
        let stopped = render_pictures(&sequence(false), &request(&[0, 1, 2]), &meter, &stop);
        assert!(matches!(stopped, Err(RenderError::Stopped { signal: 2, done: 0, .. })), "{stopped:?}");
    }

    #[test]
    fn formats_of_light_are_refused() {
        let sequence = sequence(false);
        let (found, _) = rendered(&sequence, &[0]);
        let folder = tempfile::tempdir().expect("a folder");
        let output = Output::parse(folder.path().join("a.exr")).expect("an output");
        let refused = write_pictures(&sequence, (&[0], &[found[0].picture.clone()]), &output);
        assert!(refused.is_err_and(|error| error.to_string().contains("write .png, .jpg or .ppm")));
    }
}
