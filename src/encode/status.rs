//! The status of a job's frames on disk.

use super::error::EncodeError;
use super::job::EncodeJob;
use super::lease::{LeaseHolder, holder, path_of};
use super::output::Output;
use crate::base::cancel::Stop;
use crate::base::digest::Digest;
use rayon::ThreadPool;
use std::collections::HashSet;
use std::time::SystemTime;

/// The status of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameStatus {
    /// All files are complete and current; with the time when the last of them was written.
    Done(SystemTime),
    /// Some files exist, but not all are complete and current.
    Stale,
    Missing,
}

/// The status of all frames, in the job's order.
///
/// # Errors
/// The job is invalid; a shared job must have outputs that hold an identity.
pub fn frame_statuses(job: &EncodeJob, pool: &ThreadPool) -> Result<Vec<FrameStatus>, EncodeError> {
    job.check()?;
    let current = job.find_kept(pool, &Stop::default()).frames;
    let mut frames = job.frames.clone();
    frames.sort_unstable();
    let existing: HashSet<_> = job.outputs.iter().flat_map(|output| output.existing_files(&frames)).collect();
    let status = |(&frame, current): (&u32, bool)| {
        let files =
            || job.outputs.iter().map(|output| output.path(frame)).filter(|path| existing.contains(path));
        let written = files().filter_map(|path| path.metadata().and_then(|file| file.modified()).ok()).max();
        match written {
            Some(written) if current => FrameStatus::Done(written),
            None if files().next().is_none() => FrameStatus::Missing,
            _ => FrameStatus::Stale,
        }
    };
    Ok(job.frames.iter().zip(current).map(status).collect())
}

/// The holder of the lease of a film's frames, if the lease is valid.
pub fn lease_holder(output: &Output, film: Digest) -> Option<LeaseHolder> {
    // A lease that cannot be read has no holder that could be named.
    holder(&path_of(output, film)).ok().flatten().filter(|holder| !holder.is_gone())
}
