//! Options of `render` that describe how it renders. Jobs of a farm record them for their tasks.

use super::image_options::ImageOptions;
use super::options::RenderOptions;
use super::overrides::Overrides;
use super::values;
use crate::pipeline::render::Reuse;
use clap::{ArgMatches, Args, Command, Error, FromArgMatches, parser::ValueSource};

#[derive(Args, Debug, PartialEq)]
pub struct Settings {
    #[command(flatten)]
    pub options: RenderOptions,

    #[command(flatten)]
    image: ImageOptions,

    /// Quality of JPEGs and of MP4 video, 1 to 100 [default: as in the sequence]
    #[arg(long, value_name = "N", value_parser = values::encode_quality, allow_hyphen_values = true)]
    quality: Option<u8>,

    /// Maximum size of a GIF, such as 5MB
    ///
    /// Kinora reduces colours, then size, then frame rate until it fits, and prints a note.
    #[arg(long, value_name = "SIZE", value_parser = values::file_size, allow_hyphen_values = true)]
    max_size: Option<u64>,

    /// Memory for films that later frames reuse: 2GB, or 0 [default: a quarter of free memory]
    ///
    /// A film is the light traced for a frame. Frames that show the same scene, or in which only
    /// lights change their brightness, share one. `kinora plan` prints the memory that they take.
    #[arg(long, value_name = "SIZE", value_parser = values::cache_size, allow_hyphen_values = true,
        verbatim_doc_comment)]
    film_cache: Option<u64>,

    /// Trace every frame on its own; the files have the same bytes
    #[arg(long, conflicts_with = "film_cache")]
    no_reuse: bool,

    /// Write PNG and EXR files without metadata about the frame
    #[arg(long)]
    pub no_metadata: bool,
}

impl Settings {
    /// The settings of the sequence that they replace.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            max_size: self.max_size,
            encode_quality: self.quality,
            no_metadata: self.no_metadata,
            ..self.image.with(self.options.overrides())
        }
    }

    /// The meaning of `--no-reuse` and `--film-cache`.
    pub fn reuse(&self) -> Reuse {
        if self.no_reuse { Reuse::Off } else { self.film_cache.map_or(Reuse::Share, Reuse::Within) }
    }
}

/// Settings, and the arguments that gave them.
#[derive(Debug, PartialEq)]
pub struct RecordedSettings {
    pub settings: Settings,
    /// One word for each given option: `--name` or `--name=value`. In the order of the options' definitions.
    pub arguments: Vec<String>,
}

/// Options that affect only this process.
const PROCESS_ONLY: [&str; 3] = ["quiet", "progress", "threads"];

fn recorded(matches: &ArgMatches) -> Vec<String> {
    let command = Settings::augment_args(Command::new(""));
    let mut words = Vec::new();
    for option in command.get_arguments() {
        let id = option.get_id().as_str();
        let given = matches.value_source(id) == Some(ValueSource::CommandLine) && !PROCESS_ONLY.contains(&id);
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

impl Args for RecordedSettings {
    fn augment_args(command: Command) -> Command {
        Settings::augment_args(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Settings::augment_args_for_update(command)
    }
}

impl FromArgMatches for RecordedSettings {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        Ok(Self { settings: Settings::from_arg_matches(matches)?, arguments: recorded(matches) })
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
    struct TestCommand {
        #[command(flatten)]
        recorded: RecordedSettings,
    }

    fn parsed(words: &[&str]) -> RecordedSettings {
        let words = ["x"].iter().chain(words);
        TestCommand::try_parse_from(words).expect("options").recorded
    }

    /// The recorded arguments give the same settings when they are parsed again.
    #[test]
    fn recorded_arguments_give_the_same_settings() {
        let first = parsed(&[
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
            "--film-cache=2GB",
            "--transparent",
        ]);
        let words: Vec<&str> = first.arguments.iter().map(String::as_str).collect();
        let expected = [
            "--size=4x3",
            "--fps=30",
            "--exposure=-1.5",
            "--draft",
            "--transparent",
            "--caption=a {frame}",
            "--bits=16",
            "--film-cache=2GB",
        ];
        assert_eq!(words, expected);
        let again = parsed(&words);
        assert_eq!(again.arguments, first.arguments);
        assert_eq!(again.settings.overrides(), first.settings.overrides());
        assert!(parsed(&[]).arguments.is_empty());
    }
}
