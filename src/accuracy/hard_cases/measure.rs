//! Measures cases: the answers of every method, and the time of a call.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// The names of the four methods, in the order of a case's cells.
pub const METHODS: [&str; 4] = ["textbook f32", "textbook f64", "stable f32", "ours, f64"];

/// The amount of work of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Workload {
    /// Number of inputs of each case.
    pub inputs: u32,
    /// Rounds in which each method is timed once.
    pub rounds: u32,
}

impl Workload {
    pub const FULL: Self = Self { inputs: 20_000, rounds: 25 };
    pub const QUICK: Self = Self { inputs: 2_000, rounds: 5 };
}

/// The error of an answer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Verdict {
    /// The error; `None` if there is nothing to compare.
    pub off: Option<f64>,
    /// Whether the answer is wrong in kind, such as a missed hit or a NaN.
    pub wrong: bool,
}

impl Verdict {
    pub const RIGHT: Self = Self { off: None, wrong: false };
    pub const WRONG: Self = Self { off: None, wrong: true };

    /// An answer with this error; wrong if the error is infinite or NaN.
    pub fn off(off: f64) -> Self {
        if off.is_finite() { Self { off: Some(off), wrong: false } } else { Self::WRONG }
    }

    pub fn wrong_if(wrong: bool) -> Self {
        Self { off: None, wrong }
    }
}

/// A computation by four methods.
pub struct Case {
    /// The id in the catalogue of hard cases.
    pub id: &'static str,
    pub what: &'static str,
    /// What the errors measure, with their unit; empty if only wrong answers are counted.
    pub error: &'static str,
    /// Which answers count as wrong; empty if none can be.
    pub wrong: &'static str,
    /// In the order of [`METHODS`]; `None` if a method does not apply.
    pub methods: [Option<Box<dyn Method>>; 4],
}

/// One method of computing a case, with its inputs.
pub trait Method {
    fn answers(&self) -> Answers;

    /// The time of one call, as the mean over many inputs.
    fn time(&self) -> f64;
}

/// The errors of all answers of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answers {
    /// The largest error of all answers that can be compared.
    pub worst: Option<f64>,
    /// The fraction of wrong answers.
    pub wrong: f64,
}

/// The errors and the time of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    pub answers: Answers,
    /// Median time of one call, in nanoseconds.
    pub nanoseconds: f64,
}

/// The cells of a case, in the order of [`METHODS`].
pub type Cells = [Option<Cell>; 4];

struct TestedFunction<I, O, C: Fn(&I) -> O, J: Fn(&I, O) -> Verdict> {
    inputs: Vec<I>,
    call: C,
    judge: J,
}

/// The largest number of timed inputs: few enough to stay in the processor's cache.
const TIMED: usize = 512;
/// Minimum duration of a timing, so that the resolution of the clock does not matter.
const LONG_ENOUGH: Duration = Duration::from_micros(100);

impl<I, O, C: Fn(&I) -> O, J: Fn(&I, O) -> Verdict> Method for TestedFunction<I, O, C, J> {
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

/// Creates a method from its inputs, in its own precision; the function; and the judge, which compares an answer with
/// the true one.
pub fn method<I: 'static, O: 'static>(
    inputs: Vec<I>,
    call: impl Fn(&I) -> O + 'static,
    judge: impl Fn(&I, O) -> Verdict + 'static,
) -> Option<Box<dyn Method>> {
    Some(Box::new(TestedFunction { inputs, call, judge }))
}

impl Case {
    /// Measures the cells of the case. The methods are timed in turn, so that other load on the machine affects all
    /// of them.
    pub fn measured(&self, workload: Workload) -> Cells {
        let answers = self.methods.each_ref().map(|way| way.as_ref().map(|way| way.answers()));
        let mut times: [Vec<f64>; 4] = Default::default();
        for _ in 0..workload.rounds {
            for (times, way) in times.iter_mut().zip(&self.methods) {
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
        let way = method(vec![1.0, 4.0, -1.0, 0.0], |x: &f64| x.sqrt() + x, judge).expect("a method");
        assert_eq!(way.answers(), Answers { worst: Some(2.0), wrong: 0.25 });
        assert!(way.time() > 0.0);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
    }
}
