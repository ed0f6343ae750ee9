//! What there is of a job's frames.

use super::claim::{Holder, holder, path_of};
use super::error::EncodeError;
use super::job::Job;
use super::output::Output;
use crate::base::cancel::Stop;
use crate::base::digest::Digest;
use rayon::ThreadPool;
use std::collections::HashSet;
use std::time::SystemTime;

/// What there is of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// Its files are there, whole and as they would be made now; the last of them since then.
    Done(SystemTime),
    /// Some of its files are there, but not all of them as they would be made now.
    Stale,
    Missing,
}

/// Looks at the files of all frames, in the job's order.
///
/// # Errors
/// Outputs whose files do not say what they show.
pub fn found(job: &Job, pool: &ThreadPool) -> Result<Vec<Found>, EncodeError> {
    job.check()?;
    let right = job.kept(pool, &Stop::default()).frames;
    let mut frames = job.frames.clone();
    frames.sort_unstable();
    let there: HashSet<_> = job.outputs.iter().flat_map(|output| output.present(&frames)).collect();
    let look = |(&frame, right): (&u32, bool)| {
        let files =
            || job.outputs.iter().map(|output| output.path(frame)).filter(|path| there.contains(path));
        let made = files().filter_map(|path| path.metadata().and_then(|file| file.modified()).ok()).max();
        match made {
            Some(made) if right => Found::Done(made),
            None if files().next().is_none() => Found::Missing,
            _ => Found::Stale,
        }
    };
    Ok(job.frames.iter().zip(right).map(look).collect())
}

/// Who has the frames of a film in hand, if anybody still does.
pub fn in_hand(output: &Output, film: Digest) -> Option<Holder> {
    // What cannot be read is in nobody's hand that could be named.
    holder(&path_of(output, film)).ok().flatten().filter(|holder| !holder.is_gone())
}
