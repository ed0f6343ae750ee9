//! The file of commands that read a sequence and render nothing.

use super::failure::Failure;
use super::load;
use super::loading::LoadingReporter;
use super::progress::ProgressMode;
use crate::sequence::Sequence;
use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug, PartialEq)]
pub struct SequenceFile {
    /// The sequence file (.ron or .json)
    file: PathBuf,

    /// Allow files outside of the sequence's root folder, as in `render`
    #[arg(long)]
    allow_outside: bool,
}

impl SequenceFile {
    pub fn load(&self) -> Result<Sequence, Failure> {
        load::sequence(&self.file, self.allow_outside, reporter())
    }

    /// The sequence as one plain file.
    pub fn expanded(&self) -> Result<String, Failure> {
        load::expanded(&self.file, self.allow_outside, reporter())
    }

    /// The sequence in the other notation.
    pub fn converted(&self) -> Result<String, Failure> {
        load::converted(&self.file, self.allow_outside)
    }
}

fn reporter() -> LoadingReporter {
    LoadingReporter::new(ProgressMode::Auto, false)
}
