//! Why a command did not succeed: what to print, and the exit code that tells scripts.

use super::terminal;
use crate::encode::EncodeError;
use crate::pipeline::render::RenderError;

/// The command or the sequence is at fault; nothing was written.
pub const BAD_INPUT: u8 = 2;
/// Rendering or writing failed on the way.
pub const INCOMPLETE: u8 = 3;

#[derive(Debug, PartialEq, Eq)]
pub enum Failure {
    /// Usage, or a sequence that cannot be rendered as asked.
    Bad(String),
    /// The faults of a file, already laid out with their snippets.
    Faults(String),
    /// The run broke off.
    Incomplete(String),
    /// A signal of this number has stopped it. There is nothing to tell of that if the message is empty.
    Stopped { signal: usize, message: String },
}

impl Failure {
    pub fn code(&self) -> u8 {
        match self {
            Self::Bad(_) | Self::Faults(_) => BAD_INPUT,
            Self::Incomplete(_) => INCOMPLETE,
            // What shells give for programs that a signal ends.
            Self::Stopped { signal, .. } => 128 + *signal as u8,
        }
    }

    /// The same as the one line that a runner of Open Job Description shows of a task that has failed.
    pub fn openjd(&self) -> String {
        let (Self::Bad(text)
        | Self::Faults(text)
        | Self::Incomplete(text)
        | Self::Stopped { message: text, .. }) = self;
        format!("openjd_fail: {}", text.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    pub fn print(&self) {
        match self {
            Self::Bad(message) | Self::Incomplete(message) => terminal::error(message),
            Self::Stopped { message, .. } if message.is_empty() => {}
            Self::Stopped { message, .. } => terminal::complain(message),
            Self::Faults(text) => terminal::faults(text),
        }
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        let message = error.to_string();
        match error {
            // Known before the first frame, and mended by other arguments.
            RenderError::TooLarge { .. }
            | RenderError::Camera { .. }
            | RenderError::Encode(EncodeError::Job(_)) => Self::Bad(message),
            RenderError::Stopped { signal, .. } => Self::Stopped { signal, message },
            RenderError::Encode(_) | RenderError::Threads(_) => Self::Incomplete(message),
        }
    }
}
