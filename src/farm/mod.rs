//! Past one machine: a sequence as a job for engines that hand out work.
//!
//! ```text
//! Sequence, frames ──▶ Plan ──chunks──▶ Job ──openjd, slurm, hyperqueue, shell──▶ Export: files, and how to submit them
//! ```
//!
//! A frame is a function of the sequence, its number and the settings, so nothing of ours has to coordinate anything:
//! a job is a list of chunks of frames, each of them one `kinora render`, and after them one `kinora assemble` for
//! every file that holds several frames. Everything here is pure: what a job says depends on nothing but its fields.

mod chunk;
mod fingerprint;
mod forecast;
mod hyperqueue;
mod job;
mod makespan;
mod openjd;
mod price;
mod shell;
mod slurm;
mod status;
mod words;

pub use chunk::{Chunk, Class, Films, classes};
pub use fingerprint::Fingerprint;
pub use forecast::Forecast;
pub use job::{Assembly, Engine, Export, Job, JobFile, MARK};
pub use makespan::{Scaling, makespan};
pub use price::Price;
pub use status::{Frame, Status};
pub use words::{command, quoted};
