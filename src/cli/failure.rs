//! The reason why a command failed, and its exit code.

use crate::encode::EncodeError;
use crate::pipeline::render::RenderError;

/// Exit code: everything is done.
pub const SUCCESS: u8 = 0;
/// Exit code: the command or the sequence is wrong. Nothing was written.
pub const BAD_INPUT: u8 = 2;
/// Exit code: rendering or writing failed on the way.
pub const INCOMPLETE: u8 = 3;

#[derive(Debug, PartialEq, Eq)]
pub enum Failure {
    /// The command is wrong, or the sequence cannot be rendered with it.
    Bad(String),
    /// The faults of a file, laid out with snippets of its text.
    Faults(String),
    /// The run failed on the way.
    Incomplete(String),
    /// A signal of this number stopped the run. An empty message is not printed.
    Stopped { signal: usize, message: String },
}

impl Failure {
    pub fn code(&self) -> u8 {
        match self {
            Self::Bad(_) | Self::Faults(_) => BAD_INPUT,
            Self::Incomplete(_) => INCOMPLETE,
            // The code that shells give to programs that a signal ends.
            Self::Stopped { signal, .. } => 128 + *signal as u8,
        }
    }

    /// The line that a runner of Open Job Description shows for a failed task.
    pub fn openjd(&self) -> String {
        let (Self::Bad(text)
        | Self::Faults(text)
        | Self::Incomplete(text)
        | Self::Stopped { message: text, .. }) = self;
        format!("openjd_fail: {}", text.split_whitespace().collect::<Vec<_>>().join(" "))
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        let message = error.to_string();
        match error {
            // Found before the first frame. Other arguments avoid it.
            RenderError::TooLarge { .. }
            | RenderError::Camera { .. }
            | RenderError::Encode(EncodeError::Job(_)) => Self::Bad(message),
            RenderError::Stopped { signal, .. } => Self::Stopped { signal, message },
            RenderError::Encode(_) | RenderError::Threads(_) | RenderError::Mesh { .. } => {
                Self::Incomplete(message)
            }
        }
    }
}
