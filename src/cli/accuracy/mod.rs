//! `kinora accuracy`: how far results are off, and what each step of accuracy costs.

mod data;
mod price;

use super::failure::Failure;
use clap::Args;

/// Measure how accurate results are, and what accuracy costs.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = price::AFTER_HELP)]
pub struct Arguments {
    #[command(flatten)]
    price: price::Options,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    price::run(&arguments.price)
}
