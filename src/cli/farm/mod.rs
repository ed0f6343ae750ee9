//! `kinora farm`: renders as jobs for other programs that hand out work.

mod export;
mod status;
mod stills;

use super::failure::Failure;
use clap::{Args, Subcommand};

/// Write jobs for engines that hand out work to many machines.
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
