//! The command line: one dispatch, one file per command.
//!
//! Arguments in; files, a summary on stdout, progress and errors on stderr, and an exit code out.

mod accuracy;
mod assemble;
mod check;
mod failure;
mod farm;
mod filmstrip;
#[cfg(test)]
mod fixture;
mod json;
mod load;
mod loading;
mod look;
mod options;
mod outlook;
mod outputs;
mod overrides;
mod plan;
mod plan_films;
mod poster;
mod progress;
mod render;
mod scaling;
mod settings;
mod share;
mod shell;
mod signals;
mod summary;
mod terminal;
mod time_limit;
mod values;

use crate::base::escape;
use crate::base::lanes::forced_level;
use clap::builder::Styles;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;

/// Renders keyframed animations from one text file into pictures, GIFs and videos, ray traced.
#[derive(Parser)]
#[command(version, arg_required_else_help = true, after_help = AFTER_HELP)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Render(render::Arguments),
    Filmstrip(filmstrip::Arguments),
    Poster(poster::Arguments),
    Assemble(assemble::Arguments),
    Check(check::Arguments),
    Plan(plan::Arguments),
    Accuracy(accuracy::Arguments),
    Farm(farm::Arguments),
}

const AFTER_HELP: &str = "\
Examples:
  kinora render sequences/hello.ron                  render a sequence into the files that it names
  kinora render sequences/hello.ron --draft          a quick look, at half the size
  kinora render sequences/hello.ron -o out/turn.gif  choose the file to write
  kinora render sequences/hello.ron -o out/turn.mp4  a video for browsers and slides
  kinora filmstrip sequences/hello.ron               some frames in one picture, for a page
  kinora poster sequences/hello.ron                  one frame
  kinora check sequences/hello.ron                   find every mistake, render nothing
  kinora plan sequences/light-show.ron               what a render would trace, and what it would not
  kinora accuracy sequences/room.ron --quick         what accuracy costs in time
  kinora farm export slurm sequences/hello.ron       the same on many machines

`kinora render --help` lists the options. Exit codes: 0 done, 2 a mistake in the command or the sequence,
3 frames or files could not be made, or nobody reads the standard output of `-o -`.";

/// Runs the command that the process was started with.
pub fn main() -> ExitCode {
    signals::survive_size_limits();
    run(std::env::args_os())
}

/// Runs a command; `arguments` start with the program's name.
fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    // What could steer a terminal is told without colours, so that all that is left of its kind can be escaped.
    let plain = arguments.iter().any(|argument| escape::path(argument).as_str() != argument);
    let mut command = Arguments::command();
    if plain {
        command = command.styles(Styles::plain());
    }
    let parsed = command.try_get_matches_from_mut(arguments);
    let parsed = parsed.and_then(|matches| Arguments::from_arg_matches(&matches));
    let arguments = match parsed.map_err(|message| message.format(&mut command)) {
        Ok(arguments) => arguments,
        Err(mut message) => {
            let owners = owners_of_option(&mut message);
            if plain && message.use_stderr() {
                terminal::complain(message.render().ansi().to_string().trim_end());
            } else {
                // Also the way of --help and --version, with code 0. Nobody is left to tell if printing fails.
                let _ = message.print();
            }
            if let Some(file) = forgotten_command(&message) {
                terminal::complain(&format!("\nTo render this file: kinora render {file}"));
            }
            if let Some(owners) = owners {
                terminal::complain(&format!("\n{owners}"));
            }
            return if message.use_stderr() { ExitCode::from(failure::BAD_INPUT) } else { ExitCode::SUCCESS };
        }
    };
    if let Err(error) = forced_level() {
        terminal::error(&error.to_string());
        return ExitCode::from(failure::BAD_INPUT);
    }
    let done = match arguments.command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Filmstrip(arguments) => filmstrip::run(&arguments),
        Command::Poster(arguments) => poster::run(&arguments),
        Command::Assemble(arguments) => assemble::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Accuracy(arguments) => accuracy::run(&arguments),
        Command::Farm(arguments) => farm::run(&arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print();
            ExitCode::from(failure.code())
        }
    }
}

/// The sequence file that stands where the command should.
fn forgotten_command(message: &clap::Error) -> Option<&str> {
    match message.get(ContextKind::InvalidSubcommand) {
        Some(ContextValue::String(word)) if word.ends_with(".ron") => Some(word),
        _ => None,
    }
}

/// Where an option is refused: says which commands have it, if any. The tip to pass it as a value goes, since no file is
/// called like an option.
fn owners_of_option(message: &mut clap::Error) -> Option<String> {
    let option = match message.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(option)) if message.kind() == ErrorKind::UnknownArgument => option.clone(),
        _ => return None,
    };
    let name = option.strip_prefix("--")?;
    if let Some(ContextValue::StyledStrs(mut tips)) = message.remove(ContextKind::Suggested) {
        tips.retain(|tip| !tip.to_string().contains(&format!("-- {option}")));
        if !tips.is_empty() {
            message.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
        }
    }
    let command = Arguments::command();
    let has = |command: &&clap::Command| command.get_arguments().any(|arg| arg.get_long() == Some(name));
    let owners: Vec<String> =
        command.get_subcommands().filter(has).map(|owner| format!("`kinora {}`", owner.get_name())).collect();
    (!owners.is_empty()).then(|| format!("{option} is an option of {}", owners.join(" and ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn argument_order_does_not_matter() {
        let orders = [
            &["kinora", "render", "a.ron", "-o", "b.gif", "--draft", "-s", "4x3", "-o", "c.gif"][..],
            &["kinora", "render", "-s4x3", "-o", "b.gif", "-o", "c.gif", "--draft", "a.ron"],
            &["kinora", "render", "--draft", "--output=b.gif", "a.ron", "--size=4x3", "-oc.gif"],
        ];
        let parsed = orders.map(|order| match Arguments::try_parse_from(order).map(|a| a.command) {
            Ok(Command::Render(arguments)) => arguments,
            _ => panic!("{order:?} is no render command"),
        });
        assert_eq!(parsed[0], parsed[1]);
        assert_eq!(parsed[0], parsed[2]);
    }
}
