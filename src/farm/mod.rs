//! Renders as jobs for engines that hand out work to many machines.
//!
//! In: a sequence and frame numbers. Out: the files of a job, and the command that submits them.
//! Uses `pipeline/` and the rooms above it.
//!
//! ```text
//! Sequence, frames ──▶ Plan ──chunks──▶ Job ──OpenJd, Slurm, HyperQueue, Shell──▶ Export: files, submit command
//! ```
//!
//! A frame depends only on the sequence, its number and the settings, so Kinora needs no server of its own. A job is a
//! list of chunks of frames. Each chunk is one `kinora render`. After them, one `kinora assemble` makes each file that
//! holds several frames. The text of a job depends on the fields of [`Job`] only.

mod chunk;
mod fingerprint;
mod forecast;
mod hyperqueue;
mod job;
mod makespan;
mod openjd;
mod shell;
mod shell_words;
mod slurm;
mod status;
mod unit_costs;

pub use chunk::{Chunk, CostClass, FilmCosts, cost_classes};
pub use fingerprint::Fingerprint;
pub use forecast::JobForecast;
pub use hyperqueue::HyperQueue;
pub use job::{AssembleStep, Engine, Export, Job, JobFile, MARK};
pub use makespan::{Scaling, makespan};
pub use openjd::OpenJd;
pub use shell::Shell;
pub use shell_words::{shell_command, shell_quote};
pub use slurm::Slurm;
pub use status::{JobFrame, JobStatus};
pub use unit_costs::UnitCosts;
