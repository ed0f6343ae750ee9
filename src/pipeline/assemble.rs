//! Animations and filmstrips of frames that are rendered already.

use crate::base::color::Rgb;
use crate::base::frame_set::{self, MOST_FRAMES};
use crate::base::time::Rate;
use crate::encode::{
    About, Assembly, EncodeError, Existing, Flaw, Formats, FramePattern, Job, JobError, MATTE, Output,
    Report, Sheet, Shown, Template, Tonemap, check_size, inspect, inspect_job, prepare_picture, read_picture,
    same_file, sheet_columns, write_picture,
};
use crate::pipeline::memory;
use crate::pipeline::plan::survey;
use crate::pipeline::render::{self, Large, RenderError, pool};
use crate::sequence::Sequence;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Frames on disk, and what is made of them.
#[derive(Clone, Debug)]
pub struct Request {
    /// The frames' numbers and files, in order; at least one.
    pub frames: Vec<(u32, PathBuf)>,
    /// The sequence's name.
    pub name: String,
    /// Animations, and stills, which become filmstrips of all these frames.
    pub outputs: Vec<Output>,
    pub rate: Rate,
    pub formats: Formats,
    /// What stands behind transparent frames in formats without alpha.
    pub matte: Rgb,
    /// What stands below the frames of a filmstrip, and how many of them are in a row.
    pub text: Template,
    pub columns: Option<u32>,
    pub threads: Option<NonZeroUsize>,
}

/// Which frames are wanted of those that are called like this.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    pub pattern: &'a FramePattern,
    /// Their numbers, in order. If absent, those of the whole sequence, as far as that is known.
    pub numbers: Option<&'a [u32]>,
    /// Whether those may be left out that are missing.
    pub gaps: bool,
}

/// Frames that are there and right, as far as that can be known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chosen {
    pub frames: Vec<(u32, PathBuf)>,
    /// The name that they tell of their sequence, and its rate.
    pub name: Option<String>,
    pub rate: Option<Rate>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// What helps where frames do not fit.
const WITHOUT_SEQUENCE: &str = "choose frames with --frames, leave out those that are missing with --allow-gaps, or check \
                                all against their sequence with --of SEQUENCE";

/// What helps where a sequence says what frames should be.
const WITH_SEQUENCE: &str = "render them, give the settings that they were rendered with, or leave out what is missing \
                             with --allow-gaps";

/// The frames that are wanted of a job, each compared with what the sequence evaluates to.
///
/// # Errors
/// All frames that are missing, damaged, or would be made otherwise now.
pub fn choose_of(
    sequence: &Sequence,
    request: &render::Request,
    wanted: Wanted,
) -> Result<Chosen, RenderError> {
    let pool = pool(request.threads)?;
    let survey = pool.install(|| survey(sequence, &request.frames));
    let job = render::job(sequence, request, &survey);
    let flaws = inspect_job(&job, wanted.pattern, &pool);
    let mut chosen = chosen(wanted, &request.frames, flaws, WITH_SEQUENCE)?;
    chosen.notes.extend(job.beyond());
    if !job.keeps() {
        let note = "frames without metadata do not say what they show: they are whole, and nobody knows whether they \
                    are those of the sequence";
        chosen.notes.push(note.to_owned());
    }
    (chosen.name, chosen.rate) = (Some(sequence.name.clone()), Some(sequence.timeline.rate));
    Ok(chosen)
}

/// The frames that are wanted of those that are `there`, of which nothing is known but what they tell.
///
/// # Errors
/// All frames that are missing or damaged, and those that differ from most in what frames of one run share.
pub fn choose(wanted: Wanted, there: &[u32], threads: Option<NonZeroUsize>) -> Result<Chosen, RenderError> {
    let named = |numbers: &[u32]| -> Vec<(u32, PathBuf)> {
        numbers.iter().map(|&number| (number, wanted.pattern.path(number))).collect()
    };
    let found = inspect(&named(wanted.numbers.unwrap_or(there)), &pool(threads)?);
    let numbers = match wanted.numbers {
        Some(numbers) => numbers.to_vec(),
        None => whole(wanted.pattern, there, found.frames)?,
    };
    let mut flaws = found.flaws;
    let absent = numbers.iter().filter(|number| there.binary_search(number).is_err());
    flaws.extend(absent.map(|&number| (number, Flaw::Missing)));
    flaws.sort();
    flaws.dedup();
    let mut chosen = chosen(wanted, &numbers, flaws, WITHOUT_SEQUENCE)?;
    (chosen.name, chosen.rate) = (found.name, found.rate);
    if !found.silent.is_empty() && found.silent.len() < chosen.frames.len() {
        let silent = frame_set::text(&found.silent);
        chosen.notes.push(format!("frames {silent} do not say what they show, and the others do"));
    }
    Ok(chosen)
}

/// All frames that should be there: as many as the metadata gives, or else those from the first to the last.
fn whole(pattern: &FramePattern, there: &[u32], count: Option<u32>) -> Result<Vec<u32>, EncodeError> {
    let (Some(first), Some(last)) = (there.first(), there.last()) else { return Ok(Vec::new()) };
    let (first, last) = count.map_or((*first, *last), |count| (0, count.saturating_sub(1).max(*last)));
    if (last - first) as usize >= MOST_FRAMES {
        return Err(JobError::Apart { names: pattern.to_string(), first, last }.into());
    }
    Ok((first..=last).collect())
}

fn chosen(
    wanted: Wanted,
    numbers: &[u32],
    flaws: Vec<(u32, Flaw)>,
    advice: &'static str,
) -> Result<Chosen, RenderError> {
    let missing: Vec<u32> =
        flaws.iter().filter(|(_, flaw)| *flaw == Flaw::Missing).map(|(number, _)| *number).collect();
    let only_gaps = missing.len() == flaws.len() && missing.len() < numbers.len();
    let right = flaws.is_empty() || wanted.gaps && only_gaps;
    if !right {
        let names = wanted.pattern.to_string();
        return Err(EncodeError::from(JobError::Frames { names, flaws, advice }).into());
    }
    let there = numbers.iter().filter(|number| missing.binary_search(number).is_err());
    let note = |missing| format!("frames {} are missing and left out", frame_set::text(missing));
    Ok(Chosen {
        frames: there.map(|&number| (number, wanted.pattern.path(number))).collect(),
        notes: (!missing.is_empty()).then(|| note(&missing)).into_iter().collect(),
        ..Chosen::default()
    })
}

/// Refuses to replace frames by what is made of them. `frame` gives the frame that lies at a path, or the
/// pattern of the frames that it is one of.
///
/// # Errors
/// The first output that would be a frame.
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

/// Makes the animations and filmstrips.
///
/// # Errors
/// Outputs that would replace a frame, before anything is written; frames that cannot be read or differ in size; and
/// files that cannot be written.
pub fn assemble(request: &Request) -> Result<Report, RenderError> {
    let frames = || request.frames.iter().map(|(_, frame)| frame.as_path());
    check_outputs(&request.outputs, |path| frames().find(|frame| same_file(frame, path)))?;
    let (animations, strips): (Vec<_>, Vec<_>) =
        request.outputs.iter().cloned().partition(Output::is_animation);
    let Some((_, path)) = request.frames.first() else {
        return Err(EncodeError::from(JobError::Empty).into());
    };
    let first = read_picture(path)?;
    let last = request.frames.iter().map(|(number, _)| *number).max().unwrap_or(0);
    let about = About { name: request.name.clone(), frames: last.saturating_add(1), ..About::default() };
    let size = (first.width, first.height);
    let job = Job {
        outputs: animations,
        confined: false,
        existing: Existing::Replace,
        seen: Vec::new(),
        frames: request.frames.iter().map(|(number, _)| *number).collect(),
        rate: request.rate,
        size,
        tonemap: Tonemap::default(),
        transparent: first.alpha.is_some(),
        matte: request.matte,
        caption: None,
        formats: request.formats,
        about: about.clone(),
    };
    let count = request.frames.len() as u32;
    let columns = request.columns.unwrap_or_else(|| sheet_columns(count, size));
    if !strips.is_empty() {
        let sheet = Sheet::size(count, columns, size, request.text.lines());
        Large::Filmstrip.check(memory::for_sheet(sheet))?;
        strips.iter().try_for_each(|strip| check_size(strip, 0, sheet)).map_err(EncodeError::from)?;
    }
    let _folders = strips.iter().map(prepare_picture).collect::<Result<Vec<_>, _>>()?;
    let mut sheet = (!strips.is_empty()).then(|| Sheet::new(count, columns, size, request.text.lines()));
    let mut assembly = Assembly::start(job, Arc::new(pool(request.threads)?))?;
    for (index, (number, path)) in (0..).zip(&request.frames) {
        let picture = read_picture(path)?;
        assembly.push(&picture)?;
        if let Some(sheet) = &mut sheet {
            let shown = Shown { about: &about, frame: *number, rate: request.rate };
            sheet.put(index, &picture.over(request.matte), &request.text.told(&shown));
        }
    }
    let mut report = assembly.finish()?;
    if let Some(sheet) = sheet {
        let picture = sheet.finish();
        report.notes.extend(request.text.note(&about.name));
        for strip in &strips {
            write_picture(strip, &picture, request.formats)?;
            report.files.push(strip.name().to_owned());
        }
    }
    Ok(report)
}

impl Default for Request {
    fn default() -> Self {
        Self {
            frames: Vec::new(),
            name: String::new(),
            outputs: Vec::new(),
            rate: Rate::default(),
            formats: Formats::default(),
            matte: MATTE,
            text: Template::default(),
            columns: None,
            threads: None,
        }
    }
}
