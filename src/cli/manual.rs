//! `kinora man`: writes manual pages.

use super::failure::Failure;
use super::{program, terminal};
use crate::base::escape;
use crate::base::units::counted;
use crate::encode::write_file;
use clap::{Args, Command};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};
use std::fs;
use std::io;
use std::path::PathBuf;

/// Write manual pages: one for the program, and one for each command.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = "\
Examples:
  kinora man -o ~/.local/share/man/man1
  man kinora-render

Pages that exist are replaced.")]
pub struct Arguments {
    /// The folder of the pages. It is created if necessary
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let folder = &arguments.output;
    let cannot = |error: io::Error| {
        Failure::Incomplete(format!("cannot write manual pages into {}: {error}", escape::path(folder)))
    };
    let pages = pages().map_err(cannot)?;
    fs::create_dir_all(folder).map_err(cannot)?;
    for ManualPage { name, text } in &pages {
        write_file(&folder.join(name), text).map_err(|error| Failure::Incomplete(error.to_string()))?;
    }
    let count = counted(pages.len() as u64, "manual page");
    terminal::print_line(&format!("wrote {count} into {}", escape::path(folder)))
}

struct ManualPage {
    /// The name of the file.
    name: String,
    /// Its content, for `troff`.
    text: Vec<u8>,
}

/// The pages of the program and of all its commands.
fn pages() -> io::Result<Vec<ManualPage>> {
    let mut program = program().disable_help_subcommand(true);
    program.build();
    let mut pages = Vec::new();
    add_pages(&program, &mut pages)?;
    Ok(pages)
}

fn add_pages(command: &Command, pages: &mut Vec<ManualPage>) -> io::Result<()> {
    let source = format!("kinora {}", env!("CARGO_PKG_VERSION"));
    let page = Man::new(command.clone()).source(source).manual("Kinora");
    let mut text = Vec::new();
    page.render_title(&mut text)?;
    page.render_name_section(&mut text)?;
    page.render_synopsis_section(&mut text)?;
    page.render_description_section(&mut text)?;
    page.render_options_section(&mut text)?;
    if command.has_subcommands() {
        page.render_subcommands_section(&mut text)?;
    }
    examples(command).to_writer(&mut text)?;
    pages.push(ManualPage { name: page.get_filename(), text });
    command
        .get_subcommands()
        .filter(|command| !command.is_hide_set())
        .try_for_each(|command| add_pages(command, pages))
}

/// The text below the options of `--help`, line by line as there.
fn examples(command: &Command) -> Roff {
    let mut section = Roff::default();
    let Some(text) = command.get_after_long_help().or(command.get_after_help()) else { return section };
    section.control("SH", ["EXAMPLES"]);
    section.control("nf", []);
    let text = text.to_string();
    for line in text.lines().filter(|line| !matches!(line.trim(), "Example:" | "Examples:")) {
        section.text([roman(line)]);
    }
    section.control("fi", []);
    section
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page() {
        let pages = pages().expect("in memory");
        let names: Vec<&str> = pages.iter().map(|page| page.name.as_str()).collect();
        for name in ["kinora.1", "kinora-render.1", "kinora-farm.1", "kinora-farm-export.1"] {
            assert!(names.contains(&name), "{names:?}");
        }
        assert!(names.iter().all(|name| !name.contains("help")), "{names:?}");
        let page = pages.iter().find(|page| page.name == "kinora-check.1").expect("a page");
        let text = String::from_utf8_lossy(&page.text);
        for part in [
            ".TH kinora-check 1",
            ".SH EXAMPLES\n.nf\n  kinora check sequences/hello.ron\n",
            "\\-\\-allow\\-outside",
        ] {
            assert!(text.contains(part), "{part:?} in {text}");
        }
    }
}
