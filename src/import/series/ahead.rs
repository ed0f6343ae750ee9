//! Reads the file that is likely to be needed next while the threads trace.

use crate::geometry::mesh::MeshData;
use std::mem;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// The data of a step; none if it could not be read.
type Read = Option<MeshData>;

/// Reads steps ahead of their time, at most one.
#[derive(Debug, Default)]
pub struct Ahead {
    /// The step that was needed last.
    last: Option<usize>,
    desk: Arc<Desk>,
}

/// Where a thread leaves what it has read.
#[derive(Debug, Default)]
struct Desk {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
enum State {
    #[default]
    Empty,
    /// No thread has begun to read this step.
    Waiting(usize),
    Reading,
    Done(usize, Box<Read>),
}

impl Ahead {
    /// The data of a step if it was read ahead. Then a thread of this pool starts to read the step that follows if steps
    /// are needed in even distances: first that of the step before, among `steps`.
    pub fn take(
        &mut self,
        step: usize,
        steps: usize,
        read: impl FnOnce(usize) -> Read + Send + 'static,
    ) -> Read {
        let found = self.desk.take(step);
        let next = self.last.replace(step).and_then(|last| (2 * step).checked_sub(last));
        // A thread outside of a pool would start another pool.
        if let Some(next) = next.filter(|next| *next != step && *next < steps)
            && rayon::current_thread_index().is_some()
        {
            *self.desk.state() = State::Waiting(next);
            let desk = Arc::clone(&self.desk);
            rayon::spawn(move || desk.fill(next, read));
        }
        found
    }
}

impl Desk {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads a step unless it is not wanted any more.
    fn fill(&self, step: usize, read: impl FnOnce(usize) -> Read) {
        {
            let mut state = self.state();
            match *state {
                State::Waiting(wanted) if wanted == step => *state = State::Reading,
                _ => return,
            }
        }
        let data = read(step);
        *self.state() = State::Done(step, Box::new(data));
        self.changed.notify_all();
    }

    /// The data of a step if a thread has read it or is reading it. Afterwards the desk is empty, and no thread reads.
    fn take(&self, step: usize) -> Read {
        let mut state = self.state();
        while matches!(*state, State::Reading) {
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        match mem::take(&mut *state) {
            State::Done(read, data) if read == step => *data,
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(step: usize) -> MeshData {
        MeshData { triangles: vec![[step as u32; 3]], ..MeshData::default() }
    }

    /// What was read ahead of the steps that are needed one after the other.
    fn found(needed: &[usize], threads: usize) -> Vec<Option<usize>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut ahead = Ahead::default();
            let mut take = |step: usize| {
                let data = ahead.take(step, 20, |step| (step != 13).then(|| mesh(step)));
                // Until the thread has read it, as frames are traced meanwhile.
                while threads > 1 && matches!(*ahead.desk.state(), State::Waiting(_)) {
                    std::thread::yield_now();
                }
                data.map(|data| data.triangles[0][0] as usize)
            };
            needed.iter().map(|step| take(*step)).collect()
        })
    }

    #[test]
    fn even_distances_are_read_ahead() {
        assert_eq!(found(&[1, 2, 3, 4], 2), [None, None, Some(3), Some(4)]);
        assert_eq!(found(&[2, 5, 8, 9, 10], 2), [None, None, Some(8), None, Some(10)]);
        assert_eq!(found(&[6, 4, 2, 0], 2), [None, None, Some(2), Some(0)]);
        assert_eq!(found(&[0, 18, 19, 1], 2), [None; 4]);
        // What cannot be read is read again, to report why.
        assert_eq!(found(&[11, 12, 13, 14], 2), [None, None, None, Some(14)]);
    }

    /// A single thread that never waits reads nothing ahead.
    #[test]
    fn nobody_waits_for_a_thread_that_is_not_reading() {
        assert_eq!(found(&[1, 2, 3, 4], 1), [None; 4]);
    }
}
