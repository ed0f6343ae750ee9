//! How many hard cases each numerical method fails, and what the method costs.

use super::hard_cases::{Cells, METHODS, Workload, cases};

/// The results of one numerical method over all hard cases that it applies to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodSummary {
    pub method: &'static str,
    pub cases: u32,
    /// Cases with at least one answer that is wrong in kind, such as a missed hit or a NaN.
    pub failing: u32,
    /// Time of a call relative to the textbook method in f32: the geometric mean over the cases that both apply to.
    pub time: f64,
}

/// Measures all methods. Errors are the same in every run, times are not.
pub fn precision() -> Vec<MethodSummary> {
    let cells: Vec<Cells> =
        cases(Workload::QUICK).iter().map(|case| case.measured(Workload::QUICK)).collect();
    method_summaries(&cells)
}

/// All ways, of cases that were measured.
pub fn method_summaries(cells: &[Cells]) -> Vec<MethodSummary> {
    METHODS.iter().enumerate().map(|(index, way)| summarize(way, index, cells)).collect()
}

/// One line with the number of cases in which each method gives wrong answers.
pub fn wrong_answers(methods: &[MethodSummary]) -> Option<String> {
    let of = |name: &str| methods.iter().find(|way| way.method == name);
    let (textbook, stable, ours) = (of("textbook f32")?, of("stable f32")?, of("ours, f64")?);
    Some(format!(
        "Wrong answers: textbook {} of {}, stable f32 {} of {}, Kinora {} of {}",
        textbook.failing, textbook.cases, stable.failing, stable.cases, ours.failing, ours.cases
    ))
}

fn summarize(way: &'static str, index: usize, cells: &[Cells]) -> MethodSummary {
    let own = || cells.iter().filter_map(|cells| Some((cells[index]?, cells[0]?)));
    let ratios: Vec<f64> =
        own().map(|(cell, first)| libm::log(cell.nanoseconds / first.nanoseconds)).collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
    MethodSummary {
        method: way,
        cases: ratios.len() as u32,
        failing: own().filter(|(cell, _)| cell.answers.wrong > 0.0).count() as u32,
        time: libm::exp(mean),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::hard_cases::{Answers, Cell};

    #[test]
    fn ways_are_compared_where_both_apply() {
        let cell = |nanoseconds, wrong| Some(Cell { answers: Answers { worst: None, wrong }, nanoseconds });
        let cells = [
            [cell(10.0, 0.5), None, cell(20.0, 0.1), cell(20.0, 0.0)],
            [cell(10.0, 0.5), None, None, cell(5.0, 0.0)],
        ];
        let of = |index| summarize("", index, &cells);
        assert_eq!((of(0).cases, of(0).failing, of(0).time), (2, 2, 1.0));
        assert_eq!((of(2).cases, of(2).failing), (1, 1));
        assert_eq!((of(3).cases, of(3).failing), (2, 0));
        let line = wrong_answers(&method_summaries(&cells));
        assert_eq!(line.as_deref(), Some("Wrong answers: textbook 2 of 2, stable f32 1 of 1, Kinora 0 of 2"));
        assert!((of(3).time - 1.0).abs() < 1e-12 && (of(2).time - 2.0).abs() < 1e-12);
    }
}
