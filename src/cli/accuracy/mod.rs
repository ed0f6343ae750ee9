//! `kinora accuracy`: how far results are off, and what each step of accuracy costs.

mod data;
mod hard_cases;
mod price;

use super::failure::Failure;
use clap::Args;

/// Measure how accurate results are, and what accuracy costs.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Compute the hard cases of numerics in four ways, and print the error and the time of each
    #[arg(long, conflicts_with_all = ["file", "output", "frames", "time", "size", "most_samples", "threads"])]
    hard_cases: bool,

    /// A first answer
    ///
    /// In under a minute of a file, with small pictures and few settings; in about a second
    /// of the hard cases.
    #[arg(long, verbatim_doc_comment)]
    quick: bool,

    #[command(flatten)]
    matrix: hard_cases::Options,

    #[command(flatten)]
    price: price::Options,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match arguments.hard_cases {
        true => hard_cases::run(&arguments.matrix, arguments.quick),
        false => price::run(&arguments.price, arguments.quick),
    }
}

const AFTER_HELP: &str = "\
Examples:
  kinora accuracy turn.ron --quick                   what accuracy costs, in under a minute
  kinora accuracy turn.ron -o report                 the frame in the middle, in about five minutes
  kinora accuracy turn.ron --frames 0-71:24 --time 30min -s 320x180
  kinora accuracy --hard-cases                       hard cases of numerics, in about ten seconds
  kinora accuracy --hard-cases --quick               fewer inputs, in about a second
  kinora accuracy --hard-cases --json cases.jsonl    for tools, one line of JSON a case
  kinora accuracy --hard-cases --pictures output     what some of the errors look like

Errors are the same in every run, times are not. docs/accuracy.md explains the report,
docs/numerics.md the cases.";
