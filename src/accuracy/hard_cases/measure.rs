//! How a case is measured: what every way of computing it answers, and how long that takes.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// The four ways, in the order of a case's cells.
pub const WAYS: [&str; 4] = ["textbook f32", "textbook f64", "stable f32", "ours, f64"];

/// How much work goes into the measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Inputs of every case.
    pub inputs: u32,
    /// Rounds in which each way is timed once.
    pub rounds: u32,
}

impl Effort {
    pub const FULL: Self = Self { inputs: 20_000, rounds: 25 };
    pub const QUICK: Self = Self { inputs: 2_000, rounds: 5 };
}

/// What an answer is worth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Verdict {
    /// How far it is off; none where there is nothing to compare.
    pub off: Option<f64>,
    /// Whether it is wrong in kind: a hit that is missed, no number.
    pub wrong: bool,
}

impl Verdict {
    pub const RIGHT: Self = Self { off: None, wrong: false };
    pub const WRONG: Self = Self { off: None, wrong: true };

    /// An answer that is off by this much; wrong if that is no number.
    pub fn off(off: f64) -> Self {
        if off.is_finite() { Self { off: Some(off), wrong: false } } else { Self::WRONG }
    }

    pub fn wrong_if(wrong: bool) -> Self {
        Self { off: None, wrong }
    }
}

/// A computation that is done in four ways.
pub struct Case {
    /// The id in the catalogue of hard cases.
    pub id: &'static str,
    pub what: &'static str,
    /// What the errors are, with their unit; empty where only wrong answers are counted.
    pub error: &'static str,
    /// Which answers are wrong; empty where none can be.
    pub wrong: &'static str,
    /// As in [`WAYS`]; none where a way does not apply.
    pub ways: [Option<Box<dyn Way>>; 4],
}

/// One way of computing a case.
pub trait Way {
    fn answers(&self) -> Answers;

    /// The time of one call, as the mean over many inputs.
    fn time(&self) -> f64;
}

/// What a way's answers are worth together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answers {
    /// The largest error of those that can be compared.
    pub worst: Option<f64>,
    /// The share of wrong ones.
    pub wrong: f64,
}

/// A way's answers and its price.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    pub answers: Answers,
    /// Median nanoseconds of one call.
    pub nanoseconds: f64,
}

/// A case's cells, as in [`WAYS`].
pub type Cells = [Option<Cell>; 4];

struct Tried<I, O, C: Fn(&I) -> O, J: Fn(&I, O) -> Verdict> {
    inputs: Vec<I>,
    call: C,
    judge: J,
}

/// Inputs that are timed: so few that they stay in the processor's cache.
const TIMED: usize = 512;
/// Shorter times than this say little about a clock's ticks.
const LONG_ENOUGH: Duration = Duration::from_micros(100);

impl<I, O, C: Fn(&I) -> O, J: Fn(&I, O) -> Verdict> Way for Tried<I, O, C, J> {
    fn answers(&self) -> Answers {
        let verdicts = self.inputs.iter().map(|input| (self.judge)(input, (self.call)(input)));
        let (mut worst, mut wrong) = (None, 0);
        for verdict in verdicts {
            wrong += u32::from(verdict.wrong);
            worst = verdict.off.into_iter().chain(worst).reduce(f64::max);
        }
        Answers { worst, wrong: f64::from(wrong) / self.inputs.len() as f64 }
    }

    fn time(&self) -> f64 {
        let inputs = &self.inputs[..self.inputs.len().min(TIMED)];
        let (start, mut calls) = (Instant::now(), 0);
        loop {
            for input in inputs {
                black_box((self.call)(black_box(input)));
            }
            calls += inputs.len();
            let time = start.elapsed();
            if time >= LONG_ENOUGH {
                return time.as_secs_f64() * 1e9 / calls as f64;
            }
        }
    }
}

/// A way: its inputs, in its own precision; the function; and the judge, who knows the true answer.
pub fn way<I: 'static, O: 'static>(
    inputs: Vec<I>,
    call: impl Fn(&I) -> O + 'static,
    judge: impl Fn(&I, O) -> Verdict + 'static,
) -> Option<Box<dyn Way>> {
    Some(Box::new(Tried { inputs, call, judge }))
}

impl Case {
    /// The cells of the case. The ways are timed in turn, so that what slows the machine for a while slows all.
    pub fn measured(&self, effort: Effort) -> Cells {
        let answers = self.ways.each_ref().map(|way| way.as_ref().map(|way| way.answers()));
        let mut times: [Vec<f64>; 4] = Default::default();
        for _ in 0..effort.rounds {
            for (times, way) in times.iter_mut().zip(&self.ways) {
                times.extend(way.as_ref().map(|way| way.time()));
            }
        }
        let mut times = times.into_iter();
        answers.map(|answers| {
            let nanoseconds = median(times.next().unwrap_or_default());
            answers.map(|answers| Cell { answers, nanoseconds })
        })
    }
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_error_and_the_share_of_wrong_answers() {
        let judge = |input: &f64, answer: f64| Verdict::off(answer - input);
        let way = way(vec![1.0, 4.0, -1.0, 0.0], |x: &f64| x.sqrt() + x, judge).expect("a way");
        assert_eq!(way.answers(), Answers { worst: Some(2.0), wrong: 0.25 });
        assert!(way.time() > 0.0);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
    }
}
