//! Animations and filmstrips of frames that are rendered already.

use crate::color::Rgb;
use crate::encode::{
    About, Assembly, EncodeError, Existing, Formats, Job, MATTE, Output, Report, Sheet, Shown, Template,
    Tonemap, check_size, frame_texts, prepare_picture, read_picture, sheet_columns, write_picture,
};
use crate::memory;
use crate::render::{Large, RenderError, pool};
use crate::time::Rate;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Frames on disk, and what is made of them.
#[derive(Clone, Debug)]
pub struct Request {
    /// The frames' numbers and files, in order; at least one.
    pub frames: Vec<(u32, PathBuf)>,
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

/// What a frame's file tells about it, if it is one of ours: its sequence's name, and the rate.
pub fn told_by(path: &Path, frame: u32) -> (Option<String>, Option<Rate>) {
    let texts = frame_texts(path);
    let of = |key: &str| texts.iter().find(|(keyword, _)| keyword == key).map(|(_, text)| text.clone());
    let parts = |text: String| -> Option<Rate> {
        let (seconds, whole) = text.split_once('/').unwrap_or((&text, "1"));
        // Frame k shows at k / rate.
        Rate::new(i128::from(frame) * whole.parse::<i128>().ok()?, seconds.parse().ok()?)
    };
    (of("Title"), of("kinora:time").and_then(parts))
}

/// Makes the animations and filmstrips.
pub fn assemble(request: &Request) -> Result<Report, RenderError> {
    let (animations, strips): (Vec<_>, Vec<_>) =
        request.outputs.iter().cloned().partition(Output::is_animation);
    let (first, name) = match request.frames.first() {
        Some((number, path)) => (read_picture(path)?, told_by(path, *number).0),
        None => return Err(EncodeError::from(crate::encode::JobError::Empty).into()),
    };
    let last = request.frames.iter().map(|(number, _)| *number).max().unwrap_or(0);
    let about = About { name: name.unwrap_or_default(), frames: last + 1, ..About::default() };
    let size = (first.width, first.height);
    let job = Job {
        outputs: animations,
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
            report.files.push(PathBuf::from(strip.to_string()));
        }
    }
    Ok(report)
}

impl Default for Request {
    fn default() -> Self {
        Self {
            frames: Vec::new(),
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
