//! Makes animations and filmstrips from frames that are already on disk.

use crate::base::color::Rgb;
use crate::base::frame_set::{self, MAX_FRAMES};
use crate::base::time::Rate;
use crate::drawing::Drawing;
use crate::encode::{
    AnimationAssembler, DEFAULT_BACKGROUND_COLOR, EncodeError, EncodeJob, Existing, Flaw, Formats, FrameInfo,
    FramePattern, JobError, Output, Report, SequenceInfo, Sheet, Template, Tonemap, check_size, inspect,
    inspect_job, prepare_picture, read_picture, same_file, sheet_columns, write_picture,
};
use crate::pipeline::drawings::drawings;
use crate::pipeline::memory;
use crate::pipeline::plan::evaluate;
use crate::pipeline::render::{self, MemoryUse, RenderError, pool};
use crate::sequence::Sequence;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Frames on disk, and the files to make from them.
#[derive(Clone, Debug)]
pub struct AssembleRequest {
    /// The frames' numbers and files, in order; at least one.
    pub frames: Vec<(u32, PathBuf)>,
    /// The sequence's name.
    pub name: String,
    /// Animations, and stills; each still becomes a filmstrip of all frames.
    pub outputs: Vec<Output>,
    pub rate: Rate,
    pub formats: Formats,
    /// What the frames show besides their light, in their order; empty if that is unknown. GIFs keep its colours.
    pub drawings: Vec<Arc<Drawing>>,
    /// Colour behind transparent frames in formats without alpha.
    pub background_color: Rgb,
    /// Text below each frame of a filmstrip, and the number of frames in a row.
    pub text: Template,
    pub columns: Option<u32>,
    pub threads: Option<NonZeroUsize>,
}

/// Frames to select from the files that a pattern names.
#[derive(Clone, Copy, Debug)]
pub struct FrameSelection<'a> {
    pub pattern: &'a FramePattern,
    /// Frame numbers, ascending. If absent, all frames of the sequence, if their number is known.
    pub numbers: Option<&'a [u32]>,
    /// Whether missing frames may be left out.
    pub gaps: bool,
}

/// Frames that exist and pass all checks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SelectedFrames {
    pub frames: Vec<(u32, PathBuf)>,
    /// The sequence's name and rate, from the frames' metadata.
    pub name: Option<String>,
    pub rate: Option<Rate>,
    /// The annotations of the frames, if their sequence is known.
    pub drawings: Vec<Arc<Drawing>>,
    /// Notes for the user.
    pub notes: Vec<String>,
}

/// Advice when frames do not fit together.
const WITHOUT_SEQUENCE: &str = "Choose frames with --frames, leave out missing frames with --allow-gaps, or check \
                                all against their sequence with --of SEQUENCE.";

/// Advice when the sequence says what the frames should be.
const WITH_SEQUENCE: &str = "Render these frames again, give the settings that they were rendered with, or leave out \
                             missing frames with --allow-gaps.";

/// Selects frames of a job. Compares each with what the sequence evaluates to.
///
/// # Errors
/// Lists all frames that are missing, damaged, or would be rendered differently now.
pub fn select_frames_of(
    sequence: &Sequence,
    request: &render::Request,
    selection: FrameSelection,
) -> Result<SelectedFrames, RenderError> {
    let pool = pool(request.threads)?;
    let states = pool.install(|| evaluate(sequence, &request.frames));
    let job = pool.install(|| render::job(sequence, request, &states));
    let flaws = inspect_job(&job, selection.pattern, &pool);
    let mut selected = selected(selection, &request.frames, flaws, WITH_SEQUENCE)?;
    selected.notes.extend(job.extra_frame_notes());
    if !job.can_keep_frames() {
        let note = "frames without metadata do not say what they show; they are complete, but may show another \
                    sequence";
        selected.notes.push(note.to_owned());
    }
    (selected.name, selected.rate) = (Some(sequence.name.clone()), Some(sequence.timeline.rate));
    let numbers: Vec<u32> = selected.frames.iter().map(|(number, _)| *number).collect();
    selected.drawings = pool.install(|| drawings(sequence, &numbers));
    Ok(selected)
}

/// Selects frames without their sequence, by their metadata alone. `there` lists the numbers of the files that exist.
///
/// # Errors
/// Lists all frames that are missing or damaged, and those whose metadata differs from that of most frames where one
/// run has one value.
pub fn select_frames(
    selection: FrameSelection,
    there: &[u32],
    threads: Option<NonZeroUsize>,
) -> Result<SelectedFrames, RenderError> {
    let named = |numbers: &[u32]| -> Vec<(u32, PathBuf)> {
        numbers.iter().map(|&number| (number, selection.pattern.path(number))).collect()
    };
    let found = inspect(&named(selection.numbers.unwrap_or(there)), &pool(threads)?);
    let numbers = match selection.numbers {
        Some(numbers) => numbers.to_vec(),
        None => whole(selection.pattern, there, found.frames)?,
    };
    let mut flaws = found.flaws;
    let absent = numbers.iter().filter(|number| there.binary_search(number).is_err());
    flaws.extend(absent.map(|&number| (number, Flaw::Missing)));
    flaws.sort();
    flaws.dedup();
    let mut selected = selected(selection, &numbers, flaws, WITHOUT_SEQUENCE)?;
    (selected.name, selected.rate) = (found.name, found.rate);
    if !found.without_metadata.is_empty() && found.without_metadata.len() < selected.frames.len() {
        let silent = frame_set::text(&found.without_metadata);
        selected.notes.push(format!("frames {silent} do not say what they show, and the others do"));
    }
    Ok(selected)
}

/// The numbers of all frames that should exist: the metadata gives the count; without it, the range from the first to
/// the last frame.
fn whole(pattern: &FramePattern, there: &[u32], count: Option<u32>) -> Result<Vec<u32>, EncodeError> {
    let (Some(first), Some(last)) = (there.first(), there.last()) else { return Ok(Vec::new()) };
    let (first, last) = count.map_or((*first, *last), |count| (0, count.saturating_sub(1).max(*last)));
    if (last - first) as usize >= MAX_FRAMES {
        return Err(JobError::Apart { names: pattern.to_string(), first, last }.into());
    }
    Ok((first..=last).collect())
}

fn selected(
    selection: FrameSelection,
    numbers: &[u32],
    flaws: Vec<(u32, Flaw)>,
    advice: &'static str,
) -> Result<SelectedFrames, RenderError> {
    let missing: Vec<u32> =
        flaws.iter().filter(|(_, flaw)| *flaw == Flaw::Missing).map(|(number, _)| *number).collect();
    let only_gaps = missing.len() == flaws.len() && missing.len() < numbers.len();
    let right = flaws.is_empty() || selection.gaps && only_gaps;
    if !right {
        let names = selection.pattern.to_string();
        return Err(EncodeError::from(JobError::Frames { names, flaws, advice }).into());
    }
    let there = numbers.iter().filter(|number| missing.binary_search(number).is_err());
    let note = |missing: &[u32]| match missing {
        [frame] => format!("frame {frame} is missing and left out"),
        frames => format!("frames {} are missing and left out", frame_set::text(frames)),
    };
    Ok(SelectedFrames {
        frames: there.map(|&number| (number, selection.pattern.path(number))).collect(),
        notes: (!missing.is_empty()).then(|| note(&missing)).into_iter().collect(),
        ..SelectedFrames::default()
    })
}

/// Refuses an output that would replace an input frame. `frame` returns the frame at a path, or the pattern of the
/// frames if the path is one of them.
///
/// # Errors
/// The first output that is an input frame.
pub fn check_outputs<'f>(
    outputs: &[Output],
    frame: impl Fn(&Path) -> Option<&'f Path>,
) -> Result<(), EncodeError> {
    for path in outputs.iter().filter(|output| !output.is_stream()).map(|output| output.path(0)) {
        if let Some(frames) = frame(&path).map(Path::to_owned) {
            return Err(JobError::OwnFrame { path, frames }.into());
        }
    }
    Ok(())
}

/// Writes the animations and filmstrips.
///
/// # Errors
/// Outputs that would replace a frame, before anything is written. Frames that cannot be read or differ in size, and
/// files that cannot be written.
pub fn assemble(request: &AssembleRequest) -> Result<Report, RenderError> {
    let frames = || request.frames.iter().map(|(_, frame)| frame.as_path());
    check_outputs(&request.outputs, |path| frames().find(|frame| same_file(frame, path)))?;
    let (animations, strips): (Vec<_>, Vec<_>) =
        request.outputs.iter().cloned().partition(Output::is_animation);
    let Some((_, path)) = request.frames.first() else {
        return Err(EncodeError::from(JobError::Empty).into());
    };
    let first = read_picture(path)?;
    let last = request.frames.iter().map(|(number, _)| *number).max().unwrap_or(0);
    let about = SequenceInfo {
        name: request.name.clone(),
        frames: last.saturating_add(1),
        ..SequenceInfo::default()
    };
    let size = (first.width, first.height);
    let job = EncodeJob {
        outputs: animations,
        confined: false,
        existing: Existing::Replace,
        frame_keys: Vec::new(),
        frames: request.frames.iter().map(|(number, _)| *number).collect(),
        rate: request.rate,
        size,
        tonemap: Tonemap::default(),
        transparent: first.alpha.is_some(),
        background_color: request.background_color,
        drawings: request.drawings.clone(),
        formats: request.formats,
        info: about.clone(),
    };
    let count = request.frames.len() as u32;
    let columns = request.columns.unwrap_or_else(|| sheet_columns(count, size));
    if !strips.is_empty() {
        let sheet = Sheet::size(count, columns, size, request.text.lines());
        MemoryUse::Filmstrip.check(memory::for_sheet(sheet))?;
        strips.iter().try_for_each(|strip| check_size(strip, 0, sheet)).map_err(EncodeError::from)?;
    }
    let _folders = strips.iter().map(prepare_picture).collect::<Result<Vec<_>, _>>()?;
    let mut sheet = (!strips.is_empty()).then(|| Sheet::new(count, columns, size, request.text.lines()));
    let mut assembly = AnimationAssembler::start(job, Arc::new(pool(request.threads)?))?;
    for (index, (number, path)) in (0..).zip(&request.frames) {
        let picture = read_picture(path)?;
        assembly.push(&picture)?;
        if let Some(sheet) = &mut sheet {
            let shown = FrameInfo { sequence: &about, frame: *number, rate: request.rate };
            sheet.put(index, &picture.over(request.background_color), &request.text.expand(&shown));
        }
    }
    let mut report = assembly.finish()?;
    if let Some(sheet) = sheet {
        let picture = sheet.finish();
        report.notes.extend(request.text.missing_glyphs_note(&about.name));
        for strip in &strips {
            write_picture(strip, 0, &picture, request.formats)?;
            report.files.push(strip.name().to_owned());
        }
    }
    Ok(report)
}

impl Default for AssembleRequest {
    fn default() -> Self {
        Self {
            frames: Vec::new(),
            name: String::new(),
            outputs: Vec::new(),
            rate: Rate::default(),
            formats: Formats::default(),
            drawings: Vec::new(),
            background_color: DEFAULT_BACKGROUND_COLOR,
            text: Template::default(),
            columns: None,
            threads: None,
        }
    }
}
