//! A filmstrip: several frames of a sequence in one picture, each with its number and time.

use crate::base::color::Rgb;
use crate::base::stats::ProgressMeter;
use crate::base::time::Rate;
use crate::drawing::Drawing;
use crate::encode::{
    EncodeError, FrameInfo, Output, Report, SequenceInfo, Sheet, Template, ToneTable, check_size,
    prepare_picture, write_picture,
};
use crate::film::{AovSet, Film, Noise};
use crate::pipeline::drawings::drawings;
use crate::pipeline::memory;
use crate::pipeline::plan::{self, Plan};
use crate::pipeline::render::{MemoryUse, RenderError, Reuse, Summary, pool, summary};
use crate::pipeline::schedule::{FilmSink, FrameLoop};
use crate::sequence::Sequence;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

/// The frames of a filmstrip, and the file to write. Frames have the sequence's size.
#[derive(Clone, Debug)]
pub struct FilmstripRequest {
    pub frames: Vec<u32>,
    /// A still whose name has no place for a frame number. EXR is not supported.
    pub output: Output,
    pub columns: u32,
    /// Text below each frame.
    pub text: Template,
    pub threads: Option<NonZeroUsize>,
}

/// A sink that develops films and draws them into their cells.
struct Cells {
    sheet: Sheet,
    table: ToneTable,
    background_color: Rgb,
    about: SequenceInfo,
    rate: Rate,
    text: Template,
    drawings: Vec<Arc<Drawing>>,
    next: u32,
    noise: Vec<(u32, Noise)>,
}

impl FilmSink for Cells {
    fn push(&mut self, frame: u32, film: Film) -> Result<(), EncodeError> {
        let mut picture = self.table.develop(&film).0;
        if let Some(drawing) = self.drawings.get(self.next as usize) {
            drawing.draw(&mut picture);
        }
        let picture = picture.over(self.background_color);
        let shown = FrameInfo { sequence: &self.about, frame, rate: self.rate };
        self.sheet.put(self.next, &picture, &self.text.expand(&shown));
        self.next += 1;
        self.noise.extend(film.noise.map(|noise| (frame, noise)));
        Ok(())
    }
}

/// Renders the filmstrip. Another thread may watch `meter` meanwhile.
pub fn filmstrip(
    sequence: &Sequence,
    request: &FilmstripRequest,
    meter: &Arc<ProgressMeter>,
) -> Result<Summary, RenderError> {
    let start = Instant::now();
    let aovs = AovSet::of_picture(sequence.output.transparent);
    let count = request.frames.len() as u32;
    let sheet = Sheet::size(count, request.columns, sequence.output.size, request.text.lines());
    MemoryUse::Filmstrip.check(memory::needed(sequence, aovs).saturating_add(memory::for_sheet(sheet)))?;
    check_size(&request.output, 0, sheet).map_err(EncodeError::from)?;
    let _folders = prepare_picture(&request.output)?;
    let pool = pool(request.threads)?;
    let cells = Cells {
        sheet: Sheet::new(count, request.columns, sequence.output.size, request.text.lines()),
        table: ToneTable::new(sequence.output.tonemap),
        background_color: sequence.output.background_color,
        about: sequence.about(),
        rate: sequence.timeline.rate,
        text: request.text.clone(),
        drawings: pool.install(|| drawings(sequence, &request.frames)),
        next: 0,
        noise: Vec::new(),
    };
    let mut frames = FrameLoop::with_aovs(sequence, aovs, cells, Arc::clone(meter));
    frames.report_frames();
    let budget = Reuse::Share.budget(sequence, aovs);
    pool.install(|| {
        let plan = Plan::new(sequence, &request.frames, aovs, budget);
        plan::run(&plan, &mut frames, || true)
    })?;
    let stats = frames.stats().clone();
    let files = vec![request.output.name().to_owned()];
    let mut report = Report { files, ..Report::default() };
    if let Some(cells) = frames.into_sink() {
        write_picture(&request.output, 0, &cells.sheet.finish(), sequence.output.formats)?;
        report.noise = cells.noise;
    }
    report.notes.extend(request.text.missing_glyphs_note(&sequence.name));
    Ok(summary(&stats, report, count, start.elapsed()))
}

/// `count` frame numbers, evenly spaced from the first to the last of `frames`.
pub fn spread(frames: u32, count: u32) -> Vec<u32> {
    let (last, steps) = (u64::from(frames.max(1) - 1), u64::from(count.clamp(1, frames.max(1)) - 1));
    let at = |step: u64| if steps == 0 { 0 } else { (2 * step * last + steps) / (2 * steps) };
    (0..=steps).map(|step| at(step) as u32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_spread_from_the_first_to_the_last() {
        assert_eq!(spread(72, 4), [0, 24, 47, 71]);
        assert_eq!(spread(3, 8), [0, 1, 2]);
        assert_eq!((spread(1, 5), spread(9, 1)), (vec![0], vec![0]));
    }
}
