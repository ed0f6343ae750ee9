//! The files of a job: stills that its tasks write, and files that are assembled from them.

use crate::cli::failure::Failure;
use crate::cli::outputs::OutputChoice;
use crate::encode::{Output, StillFormat};
use crate::sequence::Sequence;

/// The outputs that the command line requests.
#[derive(Clone, Copy, Debug)]
pub struct JobOutputs<'a> {
    pub outputs: &'a [Output],
    pub filmstrip: Option<&'a Output>,
    pub draft: bool,
}

impl JobOutputs<'_> {
    /// The stills of the tasks, and the animations that are assembled from them.
    ///
    /// Tasks write stills. If there are animations or a filmstrip but no PNGs, PNG frames are added for them.
    pub fn resolve(
        &self,
        sequence: &Sequence,
        frames: &[u32],
    ) -> Result<(Vec<Output>, Vec<Output>), Failure> {
        let choice = OutputChoice {
            own: &sequence.output.files,
            wanted: self.outputs,
            draft: self.draft,
            partial: frames.len() < sequence.timeline.frames as usize,
        };
        let (mut animations, mut stills): (Vec<_>, Vec<_>) =
            choice.resolve().0.into_iter().partition(Output::is_animation);
        if animations.iter().any(Output::is_stream) {
            let message = "a job has no standard output to stream to; name files with -o";
            return Err(Failure::Bad(message.to_owned()));
        }
        if let Some(strip) = self.filmstrip
            && !matches!(strip, Output::Stills(StillFormat::Png | StillFormat::Jpeg | StillFormat::Ppm, _))
        {
            return Err(Failure::Bad(format!(
                "a filmstrip is one picture; write .png, .jpg or .ppm, not {strip}"
            )));
        }
        let assembled = animations.first().or(self.filmstrip);
        if let Some(file) = assembled {
            let formats = &sequence.output.formats;
            if formats.png.deep {
                return Err(Failure::Bad(format!(
                    "{file} is assembled of PNGs of 8 bits; leave out that file, or the 16 bits"
                )));
            }
            if assembly_source(&stills).is_none() {
                stills.push(frames_beside(file)?);
            }
        }
        animations.dedup();
        Ok((stills, animations))
    }
}

/// Whether the files have metadata that identifies their contents.
pub fn has_identity(still: &Output, sequence: &Sequence) -> bool {
    matches!(still, Output::Stills(format, _) if format.has_identity(&sequence.output.formats))
}

/// The stills from which animations and filmstrips are assembled.
pub fn assembly_source(stills: &[Output]) -> Option<&Output> {
    stills.iter().find(|still| matches!(still, Output::Stills(StillFormat::Png, _)))
}

/// PNG frames for an assembled file, in a folder with the name of the file.
fn frames_beside(file: &Output) -> Result<Output, Failure> {
    let path = file.path(0).with_extension("").join("frame_####.png");
    Output::parse(path).map_err(|error| Failure::Bad(error.to_string()))
}
