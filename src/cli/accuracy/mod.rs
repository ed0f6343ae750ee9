//! `kinora accuracy`: how far results are off, and what each step of accuracy costs.

mod hard_cases;

use super::failure::Failure;
use clap::Args;

/// Measure how accurate results are, and what accuracy costs.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = hard_cases::AFTER_HELP)]
pub struct Arguments {
    /// Compute the hard cases of numerics in four ways, and print the error and the time of each
    #[arg(long, required = true)]
    hard_cases: bool,

    #[command(flatten)]
    matrix: hard_cases::Options,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    hard_cases::run(&arguments.matrix)
}
