//! `kinora accuracy --hard-cases`: a table, a file for tools, and pictures.

use crate::accuracy::hard_cases::{Case, Cell, Cells, METHODS, Workload, cases, pictures};
use crate::accuracy::{method_summaries, wrong_answers};
use crate::base::escape;
use crate::cli::failure::Failure;
use crate::cli::json::line;
use crate::cli::terminal;
use crate::encode::write_file;
use clap::Args;
use serde_json::{Map, Value};
use std::path::PathBuf;

#[derive(Args, Debug, PartialEq)]
pub struct HardCaseOptions {
    /// With --hard-cases: also write the table into this file, one line of JSON per case
    #[arg(long, value_name = "FILE", requires = "hard_cases")]
    json: Option<PathBuf>,

    /// With --hard-cases: instead of the table, write pictures of some cases into this folder
    #[arg(long, value_name = "DIR", requires = "hard_cases", conflicts_with_all = ["quick", "json"])]
    pictures: Option<PathBuf>,
}

impl HardCaseOptions {
    /// Fails if an option is given without `--hard-cases`. clap does not check `requires` of options that conflict with
    /// each other.
    pub fn check_absent(&self) -> Result<(), Failure> {
        let message = match self {
            Self { json: Some(_), .. } => {
                "--json needs --hard-cases; the numbers of a sequence file are in data.json in the folder of its report"
            }
            Self { pictures: Some(_), .. } => {
                "--pictures needs --hard-cases; the plots of a sequence file are in the folder of its report"
            }
            Self { json: None, pictures: None } => return Ok(()),
        };
        Err(Failure::Bad(message.to_owned()))
    }
}

pub fn run(options: &HardCaseOptions, quick: bool) -> Result<(), Failure> {
    if let Some(folder) = &options.pictures {
        let written = pictures::write(folder).map_err(|error| Failure::Incomplete(error.to_string()))?;
        let files: Vec<_> = written.iter().map(|file| format!("wrote {}", escape::path(file))).collect();
        return terminal::print_line(&files.join("\n"));
    }
    let workload = if quick { Workload::QUICK } else { Workload::FULL };
    terminal::print_line(&heading())?;
    let (mut lines, mut all) = (String::new(), Vec::new());
    for case in cases(workload) {
        let cells = case.measured(workload);
        all.push(cells);
        terminal::print_line(&text(&case, &cells))?;
        lines += &json(&case, &cells);
        lines.push('\n');
    }
    if let Some(wrong) = wrong_answers(&method_summaries(&all)) {
        terminal::print_line(&format!("\n{wrong} cases"))?;
    }
    match &options.json {
        Some(path) => {
            write_file(path, lines.as_bytes()).map_err(|error| Failure::Incomplete(error.to_string()))
        }
        None => Ok(()),
    }
}

/// Width of a column in characters.
const WIDTH: usize = 31;

fn heading() -> String {
    let explanation = "\
Each case is computed in four ways. Each cell shows the largest error of the comparable answers, the share of wrong
answers if there are any, and the time of a call in ns. u is 6.0e-8 in f32 and 1.1e-16 in f64.
";
    format!("{explanation}\n{}", row(METHODS.map(str::to_owned)))
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

/// Two digits, with an exponent for small and large numbers.
fn number(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        value if (0.01..1000.0).contains(&value) => format!("{value:.2}"),
        value => format!("{value:.1e}"),
    }
}

/// Two digits, or three decimals below 0.1.
fn percent(value: f64) -> String {
    match value {
        value if value >= 10.0 => format!("{value:.0}"),
        value if value >= 0.1 => format!("{value:.1}"),
        value => format!("{value:.3}"),
    }
}

fn json(case: &Case, cells: &Cells) -> String {
    let measured = |cell: &Cell| {
        serde_json::json!({
            "worst_error": cell.answers.worst,
            "wrong_share": cell.answers.wrong,
            "median_ns": cell.nanoseconds,
        })
    };
    let ways = METHODS.iter().zip(cells);
    let ways: Map<String, Value> =
        ways.map(|(way, cell)| ((*way).to_owned(), cell.as_ref().map(measured).into())).collect();
    line(serde_json::json!({
        "id": case.id,
        "case": case.what,
        "error": case.error,
        "wrong": case.wrong,
        "ways": ways,
    }))
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
            methods: [None, None, None, None],
        };
        let cell = |worst, wrong| Some(Cell { answers: Answers { worst, wrong }, nanoseconds: 12.34 });
        (case, [cell(Some(0.5), 0.123), cell(Some(1e-9), 0.0), None, cell(None, 0.0)])
    }

    #[test]
    fn the_text_has_aligned_cells() {
        let (case, cells) = example();
        let wanted = "
XX-01  an example
  largest error of t; wrong: missed
0.50, 12 % wrong, 12 ns        1.0e-9, 12 ns                  does not apply                 none, 12 ns";
        assert_eq!(text(&case, &cells), wanted);
    }

    #[test]
    fn the_json_has_all_digits() {
        let (case, cells) = example();
        let wanted = concat!(
            r#"{"id":"XX-01","case":"an example","error":"largest error of t","wrong":"missed","ways":{"#,
            r#""textbook f32":{"worst_error":0.5,"wrong_share":0.123,"median_ns":12.34},"#,
            r#""textbook f64":{"worst_error":1e-9,"wrong_share":0.0,"median_ns":12.34},"stable f32":null,"#,
            r#""ours, f64":{"worst_error":null,"wrong_share":0.0,"median_ns":12.34}}}"#,
        );
        assert_eq!(json(&case, &cells), wanted);
    }
}
