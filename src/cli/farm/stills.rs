//! Which files the frames of a job go into.

use crate::cli::failure::Failure;
use crate::cli::outputs::Run;
use crate::encode::{Output, Still};
use crate::sequence::Sequence;

/// What the command line asks for.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    pub outputs: &'a [Output],
    pub filmstrip: Option<&'a Output>,
    pub draft: bool,
}

impl Wanted<'_> {
    /// The frames' own files, and what is assembled of them.
    ///
    /// Tasks write stills. Where others are to be made of them, and none will do, there are PNGs besides.
    pub fn of(&self, sequence: &Sequence, frames: &[u32]) -> Result<(Vec<Output>, Vec<Output>), Failure> {
        let run = Run {
            own: &sequence.output.files,
            wanted: self.outputs,
            draft: self.draft,
            partial: frames.len() < sequence.timeline.frames as usize,
        };
        let (mut animations, mut stills): (Vec<_>, Vec<_>) =
            run.outputs().0.into_iter().partition(Output::is_animation);
        if animations.iter().any(Output::is_stream) {
            let message = "a job has no standard output to stream to; name files with -o";
            return Err(Failure::Bad(message.to_owned()));
        }
        if let Some(strip) = self.filmstrip
            && !matches!(strip, Output::Stills(Still::Png | Still::Jpeg | Still::Ppm, _))
        {
            return Err(Failure::Bad(format!(
                "a filmstrip is one picture; write .png, .jpg or .ppm, not {strip}"
            )));
        }
        let several = animations.first().or(self.filmstrip);
        if let Some(several) = several {
            let formats = &sequence.output.formats;
            if formats.png.deep {
                return Err(Failure::Bad(format!(
                    "{several} is assembled of PNGs of 8 bits; leave either out"
                )));
            }
            if source(&stills).is_none() {
                stills.push(beside(several)?);
            }
        }
        animations.dedup();
        Ok((stills, animations))
    }
}

/// Whether its files say what they show.
pub fn is_said(still: &Output, sequence: &Sequence) -> bool {
    matches!(still, Output::Stills(format, _) if format.is_said(&sequence.output.formats))
}

/// The stills that others are made of.
pub fn source(stills: &[Output]) -> Option<&Output> {
    stills.iter().find(|still| matches!(still, Output::Stills(Still::Png, _)))
}

/// Stills for a file that holds several frames, in a folder that is called as it is.
fn beside(file: &Output) -> Result<Output, Failure> {
    let path = file.path(0).with_extension("").join("frame_####.png");
    Output::parse(path).map_err(|error| Failure::Bad(error.to_string()))
}
