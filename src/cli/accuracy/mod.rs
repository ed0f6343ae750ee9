//! `kinora accuracy`: measures errors, and what each step of accuracy costs in time.

mod data;
mod hard_cases;
mod measure;
mod progress;

use super::failure::Failure;
use clap::Args;

/// Measure how accurate the results are, and what accuracy costs in time.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Compute hard numerical cases in four ways; print the error and the time of each
    #[arg(
        long,
        conflicts_with_all = ["file", "output", "frames", "time", "size", "max_samples", "threads", "allow_outside"],
    )]
    hard_cases: bool,

    /// Take less time for a rough answer
    ///
    /// For a file: under a minute, with small pictures and few settings. For the hard cases:
    /// about a second.
    #[arg(long, verbatim_doc_comment)]
    quick: bool,

    #[command(flatten)]
    hard_case_options: hard_cases::HardCaseOptions,

    #[command(flatten)]
    measure_options: measure::MeasureOptions,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match arguments.hard_cases {
        true => hard_cases::run(&arguments.hard_case_options, arguments.quick),
        false => measure::run(&arguments.measure_options, arguments.quick),
    }
}

const AFTER_HELP: &str = "\
Examples:
  kinora accuracy turn.ron --quick                   what accuracy costs, in under a minute
  kinora accuracy turn.ron -o report                 the middle frame, in about five minutes
  kinora accuracy turn.ron --frames 0-71:24 --time 30min -s 320x180
  kinora accuracy --hard-cases                       hard numerical cases, in about ten seconds
  kinora accuracy --hard-cases --quick               fewer inputs, in about a second
  kinora accuracy --hard-cases --json cases.jsonl    for tools, one line of JSON per case
  kinora accuracy --hard-cases --pictures output     pictures of some of the errors

Every run gives the same errors; times vary. docs/accuracy.md explains the report,
docs/numerics.md the cases.";
