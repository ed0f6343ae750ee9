//! Executes a plan together with other processes: the first process to claim a film renders its frames. Films that share
//! samples of views, or of neighbours in time, are claimed together.

use super::evaluate::FrameStates;
use super::render_plan::Plan;
use super::run::run;
use super::work_groups::{WorkGroup, work_groups};
use crate::base::digest::Digest;
use crate::encode::{Encoder, FrameLease};
use crate::film::AovSet;
use crate::pipeline::schedule::{FrameError, FrameLoop, FrameState};
use crate::sequence::Sequence;
use std::thread::sleep;
use std::time::Duration;

/// Pause before checking again whether other processes have finished their films.
const PAUSE: Duration = Duration::from_millis(500);

/// The result of a shared run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SharedRun {
    /// Number of frames that this process began.
    pub done: usize,
    /// Whether all frames exist, whichever process rendered them.
    pub complete: bool,
}

/// Renders film after film while `on` returns true, except those that other processes render. Then waits for those,
/// and takes over any that nobody renders any more. Calls `there` with the number of frames that others rendered.
pub fn run_shared(
    states: &FrameStates,
    (sequence, aovs, budget): (&Sequence, AovSet, u64),
    frames: &mut FrameLoop<Encoder>,
    on: impl Fn() -> bool,
    there: impl Fn(usize),
) -> Result<SharedRun, FrameError> {
    let of_group = |group: WorkGroup| {
        let states = group.frames.iter().map(|&index| states.frames[index].clone()).collect();
        (group.name, states)
    };
    let mut open: Vec<(Digest, Vec<FrameState>)> =
        work_groups(&states.frames).into_iter().map(of_group).collect();
    let mut done = 0;
    loop {
        let before = open.len();
        let mut theirs = Vec::new();
        for (name, group) in open {
            if !on() {
                return Ok(SharedRun { done, complete: false });
            }
            let numbers: Vec<u32> = group.iter().map(|state| state.frame).collect();
            let lease = frames
                .with_sink(|encoder| encoder.lease_frames(name, &numbers))
                .map_err(FrameError::Encode)?;
            let missing = match lease {
                FrameLease::HeldBy(_) => {
                    theirs.push((name, group));
                    continue;
                }
                FrameLease::Done => Vec::new(),
                FrameLease::Acquired(missing) => missing,
            };
            there(numbers.len() - missing.len());
            let states: Vec<FrameState> =
                group.into_iter().filter(|state| missing.contains(&state.frame)).collect();
            let wanted = states.len();
            let plan = Plan::from_states(FrameStates { frames: states }, sequence, aovs, budget);
            let begun = run(&plan.without_shared_paths(), frames, &on)?;
            done += begun;
            if begun < wanted {
                return Ok(SharedRun { done, complete: false });
            }
        }
        if theirs.is_empty() {
            return Ok(SharedRun { done, complete: true });
        }
        if theirs.len() == before {
            tracing::debug_span!("wait for other processes").in_scope(|| sleep(PAUSE));
        }
        open = theirs;
    }
}
