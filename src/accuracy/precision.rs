//! What the precision of numbers and formulas costs and spares, from the matrix of hard cases.

use super::hard_cases::{Cells, Effort, WAYS, cases};

/// One way of computing all hard cases that it applies to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    pub way: &'static str,
    pub cases: u32,
    /// Those of them in which some answers are wrong in kind: a hit that is missed, no number.
    pub failing: u32,
    /// Of a call, as a multiple of that of a textbook in f32: the geometric mean over the cases that both apply to.
    pub time: f64,
}

/// All ways. Errors are the same in every run, times are not.
pub fn precision() -> Vec<Precision> {
    let cells: Vec<Cells> = cases(Effort::QUICK).iter().map(|case| case.measured(Effort::QUICK)).collect();
    of_cells(&cells)
}

/// All ways, of cases that were measured.
pub fn of_cells(cells: &[Cells]) -> Vec<Precision> {
    WAYS.iter().enumerate().map(|(index, way)| of_way(way, index, cells)).collect()
}

/// In how many cases each way gives wrong answers, in one line.
pub fn wrong_answers(ways: &[Precision]) -> Option<String> {
    let of = |name: &str| ways.iter().find(|way| way.way == name);
    let (textbook, stable, ours) = (of("textbook f32")?, of("stable f32")?, of("ours, f64")?);
    Some(format!(
        "Wrong answers: textbook {} of {}, stable f32 {} of {}, Kinora {} of {}",
        textbook.failing, textbook.cases, stable.failing, stable.cases, ours.failing, ours.cases
    ))
}

fn of_way(way: &'static str, index: usize, cells: &[Cells]) -> Precision {
    let own = || cells.iter().filter_map(|cells| Some((cells[index]?, cells[0]?)));
    let ratios: Vec<f64> =
        own().map(|(cell, first)| libm::log(cell.nanoseconds / first.nanoseconds)).collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
    Precision {
        way,
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
        let of = |index| of_way("", index, &cells);
        assert_eq!((of(0).cases, of(0).failing, of(0).time), (2, 2, 1.0));
        assert_eq!((of(2).cases, of(2).failing), (1, 1));
        assert_eq!((of(3).cases, of(3).failing), (2, 0));
        let told = wrong_answers(&of_cells(&cells));
        assert_eq!(told.as_deref(), Some("Wrong answers: textbook 2 of 2, stable f32 1 of 1, Kinora 0 of 2"));
        assert!((of(3).time - 1.0).abs() < 1e-12 && (of(2).time - 2.0).abs() < 1e-12);
    }
}
