//! The time that several workers take for tasks of known durations.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::num::NonZeroUsize;
use std::time::Duration;

/// The time when the last worker is done, if each free worker takes the longest remaining task (longest processing time
/// first). The best assignment takes at least 3/4 of that time (R. L. Graham, "Bounds on multiprocessing timing
/// anomalies", SIAM Journal on Applied Mathematics 17, 1969: at most 4/3 - 1/(3 N) times the best for N workers).
pub fn makespan(tasks: &[Duration], workers: NonZeroUsize) -> Duration {
    let mut tasks = tasks.to_vec();
    tasks.sort_unstable_by_key(|&task| Reverse(task));
    let at_work = workers.get().min(tasks.len());
    let mut free = BinaryHeap::from(vec![Reverse(Duration::ZERO); at_work]);
    let mut last = Duration::ZERO;
    for task in tasks {
        if let Some(mut first) = free.peek_mut() {
            first.0 += task;
            last = last.max(first.0);
        }
    }
    last
}

/// How fast a number of workers finishes a job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaling {
    pub workers: NonZeroUsize,
    /// From the start of the first task to the end of the last.
    pub makespan: Duration,
    /// The time of one process that renders everything, divided by the makespan.
    pub speedup: f64,
    /// The speed-up divided by the number of workers.
    pub efficiency: f64,
}

impl Scaling {
    /// For tasks of these durations. One process takes `alone` for everything.
    pub fn of(tasks: &[Duration], alone: Duration, workers: NonZeroUsize) -> Self {
        let makespan = makespan(tasks, workers);
        let speedup = if makespan.is_zero() { 1.0 } else { alone.as_secs_f64() / makespan.as_secs_f64() };
        Self { workers, makespan, speedup, efficiency: speedup / workers.get() as f64 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4 tasks take 3 s each, and 1 s of it is the start.
    #[test]
    fn the_start_of_every_task_costs_efficiency() {
        let tasks = [Duration::from_secs(3); 4];
        let scaling = |workers| {
            let workers = NonZeroUsize::new(workers).expect("a worker");
            let scaling = Scaling::of(&tasks, Duration::from_secs(9), workers);
            (scaling.makespan.as_secs(), scaling.speedup, scaling.efficiency)
        };
        assert_eq!(scaling(1), (12, 0.75, 0.75));
        assert_eq!(scaling(3), (6, 1.5, 0.5));
        assert_eq!(scaling(10_000), (3, 3.0, 3.0 / 10_000.0));
        assert_eq!(Scaling::of(&[], Duration::ZERO, NonZeroUsize::MIN).efficiency, 1.0);
    }

    fn makespan_of(tasks: &[u64], workers: usize) -> u64 {
        let tasks: Vec<Duration> = tasks.iter().map(|&task| Duration::from_secs(task)).collect();
        makespan(&tasks, NonZeroUsize::new(workers).expect("a worker")).as_secs()
    }

    /// The best makespan, found by trying all assignments.
    fn best(tasks: &[u64], loads: &mut [u64]) -> u64 {
        let Some((task, rest)) = tasks.split_first() else { return loads.iter().copied().max().unwrap_or(0) };
        let tried = (0..loads.len()).map(|worker| {
            loads[worker] += task;
            let ended = best(rest, loads);
            loads[worker] -= task;
            ended
        });
        tried.collect::<Vec<_>>().into_iter().min().unwrap_or(0)
    }

    #[test]
    fn makespans_range_from_the_sum_to_the_longest_task() {
        let tasks = [3, 1, 4, 1, 5];
        assert_eq!(makespan_of(&tasks, 1), 14);
        assert_eq!([5, 6, 10_000].map(|workers| makespan_of(&tasks, workers)), [5; 3]);
        assert_eq!([1, 10_000].map(|workers| makespan_of(&[], workers)), [0; 2]);
    }

    /// In the given order, the last task would end at 9.
    #[test]
    fn the_longest_are_taken_first() {
        assert_eq!(makespan_of(&[1, 1, 2, 2, 6], 2), 6);
        assert_eq!(makespan_of(&[2; 12], 5), 6);
    }

    /// Graham's example of 2 N + 1 tasks on N workers reaches the bound.
    #[test]
    fn the_bound_is_tight_for_known_examples() {
        assert_eq!((makespan_of(&[3, 3, 2, 2, 2], 2), best(&[3, 3, 2, 2, 2], &mut [0; 2])), (7, 6));
        assert_eq!(
            (makespan_of(&[5, 5, 4, 4, 3, 3, 3], 3), best(&[5, 5, 4, 4, 3, 3, 3], &mut [0; 3])),
            (11, 9)
        );
    }

    #[test]
    fn makespans_stay_within_the_bound() {
        for case in 0..300u64 {
            let workers = 2 + case % 3;
            let digit = |place: u64| 1 + (case * 2_654_435_761 + place * 40_503 * (case + 7)) / 97 % 23;
            let tasks: Vec<u64> = (0..4 + case % 5).map(digit).collect();
            let (found, best) =
                (makespan_of(&tasks, workers as usize), best(&tasks, &mut vec![0; workers as usize]));
            assert!(
                best <= found && 3 * workers * found <= (4 * workers - 1) * best,
                "{tasks:?}: {found}, {best}"
            );
        }
    }

    #[test]
    fn ten_thousand_workers_share_equal_tasks() {
        assert_eq!(makespan_of(&[7; 10_000], 10_000), 7);
        assert_eq!(makespan_of(&[7; 10_001], 10_000), 14);
        assert_eq!(makespan_of(&[1; 1_000_000], 10_000), 100);
    }
}
