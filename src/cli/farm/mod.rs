//! `kinora farm`: renders as jobs for engines that hand out work.

mod export;
mod job_outputs;
mod status;

use super::failure::Failure;
use clap::{Args, Subcommand};

/// Write jobs for render farms, and show their progress.
#[derive(Args, Debug, PartialEq)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug, PartialEq)]
enum Command {
    Export(export::Arguments),
    Status(status::Arguments),
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.command {
        Command::Export(arguments) => export::run(arguments),
        Command::Status(arguments) => status::run(arguments),
    }
}
