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
    /// Compare Kinora's numerics with textbook and stable formulas: error and time
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
        false => {
            arguments.hard_case_options.check_absent()?;
            measure::run(&arguments.measure_options, arguments.quick)
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct TestCommand {
        #[command(flatten)]
        arguments: Arguments,
    }

    #[test]
    fn options_of_the_hard_cases_are_refused_with_a_file() {
        for option in ["--json", "--pictures"] {
            let words = ["x", "no/such/file.ron", option, "out"];
            let parsed = TestCommand::try_parse_from(words).expect("options").arguments;
            let Err(Failure::Bad(message)) = run(&parsed) else { panic!("{option} is accepted") };
            assert!(message.starts_with(&format!("{option} needs --hard-cases")), "{message}");
        }
        assert!(TestCommand::try_parse_from(["x", "--json", "out"]).is_err());
        assert!(TestCommand::try_parse_from(["x", "--hard-cases", "--json", "out"]).is_ok());
    }
}
