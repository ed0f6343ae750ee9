//! The command line: one file or folder per command.
//!
//! In: the arguments of the process. Out: files, a summary on stdout, progress and errors on stderr, an exit code.
//! Uses all other rooms.

#[cfg(feature = "accuracy")]
mod accuracy;
mod assemble;
mod check;
mod completions;
mod convert;
mod expand;
mod explain;
mod export;
mod failure;
mod farm;
mod farm_forecast;
mod filmstrip;
#[cfg(test)]
mod fixture;
mod fmt;
mod forecast_text;
mod frame_selection;
mod headed;
mod image_options;
mod json;
pub mod keywords;
mod load;
mod loading;
mod manual;
mod observe;
mod options;
mod outputs;
mod overrides;
mod plan;
mod poster;
#[cfg(feature = "preview")]
mod preview;
mod progress;
mod renamed_options;
mod render;
mod schema;
mod sequence_file;
mod settings;
mod shell;
mod signals;
mod summary;
mod terminal;
mod time_limit;
mod turntable;
mod values;

use crate::base::escape;
use crate::base::lanes::forced_level;
use crate::sequence::listed;
use clap::builder::Styles;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};
use failure::Failure;
use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::OnceLock;

/// Ray traces keyframed animations from a text file into pictures, GIFs and videos.
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
    #[cfg(feature = "preview")]
    Preview(preview::Arguments),
    Assemble(assemble::Arguments),
    Turntable(turntable::Arguments),
    Check(check::Arguments),
    Expand(expand::Arguments),
    Explain(explain::Arguments),
    Fmt(fmt::Arguments),
    Convert(convert::Arguments),
    Schema(schema::Arguments),
    Export(export::Arguments),
    Plan(plan::Arguments),
    #[cfg(feature = "accuracy")]
    Accuracy(accuracy::Arguments),
    Farm(farm::Arguments),
    Completions(completions::Arguments),
    #[command(name = "man")]
    Manual(manual::Arguments),
}

const AFTER_HELP: &str = "\
Examples:
  kinora render sequences/hello.ron                  render a sequence into the files that it names
  kinora render sequences/hello.ron --draft          a fast preview at half the size
  kinora render sequences/hello.ron -o out/turn.gif  choose the file to write
  kinora render sequences/hello.ron -o out/turn.mp4  a video for browsers and slides
  kinora filmstrip sequences/hello.ron               several frames in one picture
  kinora poster sequences/hello.ron                  one frame
  kinora preview sequences/hello.ron --open          look at the sequence while you write it
  kinora turntable part.stl -o part.gif              one turn around a part, without a sequence file
  kinora check sequences/hello.ron                   report every mistake, render nothing
  kinora explain tonemap                             print what a field of the file means
  kinora fmt sequences/hello.ron                     lay the file out regularly; comments stay
  kinora expand sequences/hello.ron                  print what values, templates and includes come to
  kinora convert sequences/hello.ron -o hello.json   write the sequence as JSON
  kinora schema -o kinora.schema.json                write a schema for editors of JSON sequences
  kinora export sequences/hello.ron -o hello.glb     write the scene and its animation as glTF
  kinora plan sequences/light-show.ron               predict the time, the error and the rays
  kinora accuracy sequences/room.ron --quick         measure what accuracy costs in time
  kinora farm export slurm sequences/hello.ron       write a job for many machines
  kinora completions bash                            print a script that completes words in a shell

`kinora render --help` lists the options. Exit codes: 0 success; 2 a mistake in the command or the
sequence; 3 a frame or file could not be made, or the reader of `-o -` closed the pipe.";

/// The arguments of the command, if they are not those of the process.
static ARGUMENTS: OnceLock<Vec<OsString>> = OnceLock::new();

/// Runs the command of this process.
pub fn main() -> ExitCode {
    signals::survive_size_limits();
    ExitCode::from(run(std::env::args_os()))
}

/// Runs the only command of a process whose own arguments belong to another program, such as an interpreter. The first
/// argument is the program's name. Returns the exit code.
pub fn main_with(arguments: Vec<OsString>) -> u8 {
    signals::survive_size_limits();
    run(ARGUMENTS.get_or_init(|| arguments).clone())
}

/// The arguments of the command, for messages that repeat it.
fn arguments() -> Vec<OsString> {
    ARGUMENTS.get().cloned().unwrap_or_else(|| std::env::args_os().collect())
}

/// Runs a command. The first argument is the program's name. Returns the exit code.
fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match parse(arguments.into_iter().collect()) {
        Ok(arguments) => arguments,
        Err(code) => return code,
    };
    if let Err(error) = forced_level() {
        terminal::error(&error.to_string());
        return failure::BAD_INPUT;
    }
    match execute(arguments.command) {
        Ok(()) => failure::SUCCESS,
        Err(failure) => {
            terminal::failure(&failure);
            failure.code()
        }
    }
}

fn execute(command: Command) -> Result<(), Failure> {
    match command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Filmstrip(arguments) => filmstrip::run(&arguments),
        Command::Poster(arguments) => poster::run(&arguments),
        #[cfg(feature = "preview")]
        Command::Preview(arguments) => preview::run(&arguments),
        Command::Assemble(arguments) => assemble::run(&arguments),
        Command::Turntable(arguments) => turntable::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Expand(arguments) => expand::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Fmt(arguments) => fmt::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Schema(arguments) => schema::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        #[cfg(feature = "accuracy")]
        Command::Accuracy(arguments) => accuracy::run(&arguments),
        Command::Farm(arguments) => farm::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
        Command::Manual(arguments) => manual::run(&arguments),
    }
}

/// The definition of all commands and options.
fn program() -> clap::Command {
    Arguments::command()
}

/// Parses the arguments.
///
/// # Errors
/// The exit code, after it has printed an error, the help or the version.
fn parse(arguments: Vec<OsString>) -> Result<Arguments, u8> {
    let mut command = program();
    let (arguments, notes) = renamed_options::to_current(arguments, &command);
    // If an argument could steer a terminal, the message has no colours. Then all other control characters can be
    // escaped.
    let plain = arguments.iter().any(|argument| escape::path(argument).as_str() != argument);
    if plain {
        command = command.styles(Styles::plain());
    }
    let given = renamed_options::given_command(&arguments, &command).clone();
    let matches = command.try_get_matches_from_mut(arguments);
    if !matches.as_ref().is_ok_and(is_quiet) {
        notes.iter().for_each(|note| terminal::eprint_line(note));
    }
    let parsed = matches.and_then(|matches| Arguments::from_arg_matches(&matches));
    parsed.map_err(|message| explain(message.format(&mut command), &given, plain))
}

/// Whether the command has `--quiet`.
fn is_quiet(matches: &ArgMatches) -> bool {
    match matches.subcommand() {
        Some((_, matches)) => is_quiet(matches),
        None => matches.try_get_one("quiet").ok().flatten().is_some_and(|quiet: &bool| *quiet),
    }
}

/// Prints a message of clap about the arguments of a command, with hints. Returns the exit code.
fn explain(mut message: clap::Error, command: &clap::Command, plain: bool) -> u8 {
    let hint = hint_for_option(&mut message, command);
    if plain && message.use_stderr() {
        terminal::eprint_line(message.render().ansi().to_string().trim_end());
    } else {
        // This also prints --help and --version, with code 0. If printing fails, nobody reads the output.
        let _ = message.print();
    }
    if let Some(file) = missing_command(&message) {
        terminal::eprint_line(&format!("\nTo render this file: kinora render {file}"));
    }
    if let Some(hint) = hint {
        terminal::eprint_line(&format!("\n{hint}"));
    }
    if message.use_stderr() { failure::BAD_INPUT } else { failure::SUCCESS }
}

/// The sequence file that takes the place of the command.
fn missing_command(message: &clap::Error) -> Option<&str> {
    match message.get(ContextKind::InvalidSubcommand) {
        Some(ContextValue::String(word)) if word.ends_with(".ron") => Some(word),
        _ => None,
    }
}

/// For an unknown option: a hint that names the commands that have it, or its current name if it was renamed. Also
/// removes the tip to pass it as a value, because no file has the name of an option.
fn hint_for_option(message: &mut clap::Error, command: &clap::Command) -> Option<String> {
    let option = match message.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(option)) if message.kind() == ErrorKind::UnknownArgument => option.clone(),
        _ => return None,
    };
    if !option.starts_with("--") {
        return None;
    }
    if let Some(ContextValue::StyledStrs(mut tips)) = message.remove(ContextKind::Suggested) {
        tips.retain(|tip| !tip.to_string().contains(&format!("-- {option}")));
        if !tips.is_empty() {
            message.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
        }
    }
    let current = renamed_options::current_name(&option);
    let program = program();
    let owners =
        program.get_subcommands().filter(|owner| renamed_options::has(owner, current.unwrap_or(&option)));
    let owners: Vec<String> = owners.map(|owner| format!("kinora {}", owner.get_name())).collect();
    if !owners.is_empty() {
        let owners = listed(owners.iter().map(String::as_str));
        let renamed = current.map_or_else(String::new, |current| format!("now called {current}, "));
        return Some(format!("{option} is {renamed}an option of {owners}"));
    }
    let (old, current) = renamed_options::nearest_old_name(&option)?;
    renamed_options::has(command, current).then(|| format!("{old} is now called {current}"))
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
            _ => panic!("{order:?} is not a render command"),
        });
        assert_eq!(parsed[0], parsed[1]);
        assert_eq!(parsed[0], parsed[2]);
    }
}
