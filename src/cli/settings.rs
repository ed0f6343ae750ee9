//! Options of `render` about how it renders, which travel with a job to where it is done.

use super::look::Look;
use super::options::Options;
use super::overrides::Overrides;
use super::values;
use crate::pipeline::render::Reuse;
use clap::{ArgMatches, Args, Command, Error, FromArgMatches, parser::ValueSource};

#[derive(Args, Debug, PartialEq)]
pub struct Settings {
    #[command(flatten)]
    pub options: Options,

    #[command(flatten)]
    look: Look,

    /// Quality of JPEGs and of MP4 video, 1 to 100 [default: as the sequence says]
    #[arg(long, value_name = "N", value_parser = values::encode_quality, allow_hyphen_values = true)]
    quality: Option<u8>,

    /// How large a GIF may become, such as 5MB
    ///
    /// It loses colours, then pixels, then frames until it fits; a note says which.
    #[arg(long, value_name = "SIZE", value_parser = values::file_size, allow_hyphen_values = true)]
    max_size: Option<u64>,

    /// Memory for films that later frames are made of, such as 2GB [default: a share]
    ///
    /// What is traced once serves all frames in which the same is seen, or only lights are
    /// switched and faded. `kinora plan` says how much memory that takes.
    #[arg(long, value_name = "SIZE", value_parser = values::file_size, verbatim_doc_comment)]
    memory: Option<u64>,

    /// Trace every frame by itself; the files are the same, to the byte
    #[arg(long, conflicts_with = "memory")]
    no_reuse: bool,

    /// PNGs and EXR files without text about the frame
    #[arg(long)]
    pub no_metadata: bool,
}

impl Settings {
    /// What they change in a sequence.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            max_size: self.max_size,
            encode_quality: self.quality,
            no_metadata: self.no_metadata,
            ..self.look.with(self.options.overrides())
        }
    }

    /// What `--no-reuse` and `--memory` say.
    pub fn reuse(&self) -> Reuse {
        if self.no_reuse { Reuse::Off } else { self.memory.map_or(Reuse::Share, Reuse::Within) }
    }
}

/// Settings together with the words that say them.
#[derive(Debug, PartialEq)]
pub struct Spoken {
    pub settings: Settings,
    /// Each option that was given as one word, `--name` or `--name=value`, in the order of the options.
    pub words: Vec<String>,
}

/// Those that are about the process that is told them, not about what it makes.
const OWN: [&str; 3] = ["quiet", "progress", "threads"];

fn words(matches: &ArgMatches) -> Vec<String> {
    let command = Settings::augment_args(Command::new(""));
    let mut words = Vec::new();
    for option in command.get_arguments() {
        let id = option.get_id().as_str();
        let given = matches.value_source(id) == Some(ValueSource::CommandLine) && !OWN.contains(&id);
        let Some(name) = option.get_long().filter(|_| given) else { continue };
        if option.get_action().takes_values() {
            let values = matches.get_raw(id).into_iter().flatten();
            words.extend(values.map(|value| format!("--{name}={}", value.to_string_lossy())));
        } else {
            words.push(format!("--{name}"));
        }
    }
    words
}

impl Args for Spoken {
    fn augment_args(command: Command) -> Command {
        Settings::augment_args(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Settings::augment_args_for_update(command)
    }
}

impl FromArgMatches for Spoken {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        Ok(Self { settings: Settings::from_arg_matches(matches)?, words: words(matches) })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Heard {
        #[command(flatten)]
        spoken: Spoken,
    }

    fn heard(words: &[&str]) -> Spoken {
        let words = ["x"].iter().chain(words);
        Heard::try_parse_from(words).expect("options").spoken
    }

    /// Whatever is said can be said again with the words that are kept of it.
    #[test]
    fn what_is_said_can_be_said_again() {
        let said = heard(&[
            "-s",
            "4x3",
            "-r30",
            "-t",
            "2",
            "--draft",
            "--exposure",
            "-1.5",
            "-q",
            "--caption",
            "a {frame}",
            "--bits",
            "16",
            "--progress",
            "json",
            "--memory=2GB",
            "--transparent",
        ]);
        let words: Vec<&str> = said.words.iter().map(String::as_str).collect();
        let expected = [
            "--size=4x3",
            "--fps=30",
            "--exposure=-1.5",
            "--draft",
            "--transparent",
            "--caption=a {frame}",
            "--bits=16",
            "--memory=2GB",
        ];
        assert_eq!(words, expected);
        let again = heard(&words);
        assert_eq!(again.words, said.words);
        assert_eq!(again.settings.overrides(), said.settings.overrides());
        assert!(heard(&[]).words.is_empty());
    }
}
