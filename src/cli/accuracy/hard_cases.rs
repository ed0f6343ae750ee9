//! `kinora accuracy --hard-cases`: the table, a file for tools, and the pictures.

use crate::accuracy::hard_cases::{Case, Cell, Cells, Effort, WAYS, cases, pictures};
use crate::accuracy::{of_cells, wrong_answers};
use crate::base::escape;
use crate::cli::failure::Failure;
use crate::cli::json::Object;
use crate::cli::terminal;
use crate::encode::write_file;
use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug, PartialEq)]
pub struct Options {
    /// Write the table into this file as well, one line of JSON a case
    #[arg(long, value_name = "FILE", requires = "hard_cases")]
    json: Option<PathBuf>,

    /// Make pictures of the telling cases in this folder, instead of the table
    #[arg(long, value_name = "DIR", requires = "hard_cases", conflicts_with_all = ["quick", "json"])]
    pictures: Option<PathBuf>,
}

pub fn run(options: &Options, quick: bool) -> Result<(), Failure> {
    if let Some(folder) = &options.pictures {
        let written = pictures::write(folder).map_err(|error| Failure::Incomplete(error.to_string()))?;
        let files: Vec<_> = written.iter().map(|file| format!("wrote {}", escape::path(file))).collect();
        return terminal::say(&files.join("\n"));
    }
    let effort = if quick { Effort::QUICK } else { Effort::FULL };
    terminal::say(&heading())?;
    let (mut lines, mut all) = (String::new(), Vec::new());
    for case in cases(effort) {
        let cells = case.measured(effort);
        all.push(cells);
        terminal::say(&text(&case, &cells))?;
        lines += &json(&case, &cells);
        lines.push('\n');
    }
    if let Some(wrong) = wrong_answers(&of_cells(&all)) {
        terminal::say(&format!("\n{wrong} cases"))?;
    }
    match &options.json {
        Some(path) => {
            write_file(path, lines.as_bytes()).map_err(|error| Failure::Incomplete(error.to_string()))
        }
        None => Ok(()),
    }
}

/// Characters of a column.
const WIDTH: usize = 31;

fn heading() -> String {
    let explained = "\
Every case is computed in four ways. Below each: the largest error, of all answers that can be compared; the share of
wrong ones, where there are any; and the time of a call, in ns. u is 6.0e-8 in f32 and 1.1e-16 in f64.
";
    format!("{explained}\n{}", row(WAYS.map(str::to_owned)))
}

fn row(cells: [String; 4]) -> String {
    let cells = cells.map(|cell| format!("{cell:<WIDTH$}"));
    cells.concat().trim_end().to_owned()
}

fn text(case: &Case, cells: &Cells) -> String {
    let wrong = Some(format!("wrong: {}", case.wrong)).filter(|_| !case.wrong.is_empty());
    let error = Some(case.error.to_owned()).filter(|error| !error.is_empty());
    let measured = error.into_iter().chain(wrong).collect::<Vec<_>>().join("; ");
    let cells = cells.map(|cell| cell.map_or_else(|| "does not apply".to_owned(), |cell| shown(case, &cell)));
    format!("\n{}  {}\n  {measured}\n{}", case.id, case.what, row(cells))
}

fn shown(case: &Case, cell: &Cell) -> String {
    let worst = match cell.answers.worst {
        Some(worst) => number(worst),
        None if case.error.is_empty() => String::new(),
        None => "none".to_owned(),
    };
    let wrong = match cell.answers.wrong {
        _ if case.wrong.is_empty() => String::new(),
        0.0 if case.error.is_empty() => "none wrong".to_owned(),
        0.0 => String::new(),
        wrong => format!("{} % wrong", percent(100.0 * wrong)),
    };
    let time = format!("{:.0} ns", cell.nanoseconds);
    [worst, wrong, time].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
}

/// Two digits, and the exponent of what is small.
fn number(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        value if (0.01..1000.0).contains(&value) => format!("{value:.2}"),
        value => format!("{value:.1e}"),
    }
}

/// Two digits, but never 0 of what is more.
fn percent(value: f64) -> String {
    match value {
        value if value >= 10.0 => format!("{value:.0}"),
        value if value >= 0.1 => format!("{value:.1}"),
        value => format!("{value:.3}"),
    }
}

fn json(case: &Case, cells: &Cells) -> String {
    let object = Object::new()
        .text("id", case.id)
        .text("case", case.what)
        .text("error", case.error)
        .text("wrong", case.wrong);
    let measured = WAYS.iter().zip(cells).fold(Object::new(), |object, (way, cell)| match cell {
        Some(cell) => object.object(
            way,
            Object::new()
                .exact("worst_error", cell.answers.worst)
                .exact("wrong_share", Some(cell.answers.wrong))
                .exact("median_ns", Some(cell.nanoseconds)),
        ),
        None => object.exact(way, None),
    });
    object.object("ways", measured).finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::hard_cases::Answers;

    fn example() -> (Case, Cells) {
        let case = Case {
            id: "XX-01",
            what: "an example",
            error: "largest error of t",
            wrong: "missed",
            ways: [None, None, None, None],
        };
        let cell = |worst, wrong| Some(Cell { answers: Answers { worst, wrong }, nanoseconds: 12.34 });
        (case, [cell(Some(0.5), 0.123), cell(Some(1e-9), 0.0), None, cell(None, 0.0)])
    }

    #[test]
    fn people_read_aligned_cells() {
        let (case, cells) = example();
        let wanted = "
XX-01  an example
  largest error of t; wrong: missed
0.50, 12 % wrong, 12 ns        1.0e-9, 12 ns                  does not apply                 none, 12 ns";
        assert_eq!(text(&case, &cells), wanted);
    }

    #[test]
    fn programs_read_all_digits() {
        let (case, cells) = example();
        let wanted = concat!(
            r#"{"id":"XX-01","case":"an example","error":"largest error of t","wrong":"missed","ways":{"#,
            r#""textbook f32":{"worst_error":5e-1,"wrong_share":1.23e-1,"median_ns":1.234e1},"#,
            r#""textbook f64":{"worst_error":1e-9,"wrong_share":0e0,"median_ns":1.234e1},"stable f32":null,"#,
            r#""ours, f64":{"worst_error":null,"wrong_share":0e0,"median_ns":1.234e1}}}"#,
        );
        assert_eq!(json(&case, &cells), wanted);
    }
}
