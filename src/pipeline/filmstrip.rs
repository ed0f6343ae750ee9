//! A figure of a sequence: several of its frames in one picture, each with its number and time.

use crate::base::color::Rgb;
use crate::base::stats::Meter;
use crate::base::time::Rate;
use crate::encode::{
    About, EncodeError, Output, Report, Sheet, Shown, Template, ToneTable, check_size, prepare_picture,
    write_picture,
};
use crate::film::{Extras, Film, Noise};
use crate::pipeline::memory;
use crate::pipeline::plan::{self, Plan};
use crate::pipeline::render::{Large, RenderError, Reuse, Summary, pool, summary};
use crate::pipeline::schedule::{FilmSink, FrameLoop};
use crate::sequence::Sequence;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

/// What is shown of a sequence, and where it goes. Frames have the sequence's size.
#[derive(Clone, Debug)]
pub struct Request {
    pub frames: Vec<u32>,
    /// A still without a place for frame numbers, but no EXR.
    pub output: Output,
    pub columns: u32,
    /// What stands below each frame.
    pub text: Template,
    pub threads: Option<NonZeroUsize>,
}

/// Where films go: developed, and put into their cells.
struct Cells {
    sheet: Sheet,
    table: ToneTable,
    matte: Rgb,
    about: About,
    rate: Rate,
    text: Template,
    next: u32,
    noise: Vec<(u32, Noise)>,
}

impl FilmSink for Cells {
    fn push(&mut self, frame: u32, film: Film) -> Result<(), EncodeError> {
        let picture = self.table.develop(&film).0.over(self.matte);
        let shown = Shown { about: &self.about, frame, rate: self.rate };
        self.sheet.put(self.next, &picture, &self.text.told(&shown));
        self.next += 1;
        self.noise.extend(film.noise.map(|noise| (frame, noise)));
        Ok(())
    }
}

/// Renders the filmstrip. `meter` may be watched from another thread meanwhile.
pub fn filmstrip(sequence: &Sequence, request: &Request, meter: &Arc<Meter>) -> Result<Summary, RenderError> {
    let start = Instant::now();
    let extras = Extras { coverage: sequence.output.transparent, guides: false };
    let count = request.frames.len() as u32;
    let sheet = Sheet::size(count, request.columns, sequence.output.size, request.text.lines());
    Large::Filmstrip.check(memory::needed(sequence, extras).saturating_add(memory::for_sheet(sheet)))?;
    check_size(&request.output, 0, sheet).map_err(EncodeError::from)?;
    let _folders = prepare_picture(&request.output)?;
    let cells = Cells {
        sheet: Sheet::new(count, request.columns, sequence.output.size, request.text.lines()),
        table: ToneTable::new(sequence.output.tonemap),
        matte: sequence.output.matte,
        about: sequence.about(),
        rate: sequence.timeline.rate,
        text: request.text.clone(),
        next: 0,
        noise: Vec::new(),
    };
    let mut frames = FrameLoop::with_extras(sequence, extras, cells, Arc::clone(meter));
    let budget = Reuse::Share.budget(sequence, extras);
    pool(request.threads)?.install(|| {
        let plan = Plan::new(sequence, &request.frames, extras, budget);
        plan::run(&plan, &mut frames, || true)
    })?;
    let tally = frames.tally().clone();
    let files = vec![request.output.name().to_owned()];
    let mut report = Report { files, ..Report::default() };
    if let Some(cells) = frames.into_sink() {
        write_picture(&request.output, &cells.sheet.finish(), sequence.output.formats)?;
        report.noise = cells.noise;
    }
    report.notes.extend(request.text.note(&sequence.name));
    Ok(summary(&tally, report, count, start.elapsed()))
}

/// `count` frames spread evenly over a sequence of `frames`, from the first to the last.
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
