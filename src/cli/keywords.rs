//! The options of `render` for other languages, which have them as keyword arguments.

use super::overrides;
use super::settings::Settings;
use crate::base::escape;
use crate::base::frame_set::FrameSet;
use crate::pipeline::render::Reuse;
use crate::sequence::Sequence;
use clap::error::{ContextKind, ContextValue};
use clap::{Args, Command, FromArgMatches};
use std::error::Error;
use std::num::NonZeroUsize;

/// Parsed options of `render` about how it renders.
#[derive(Debug)]
pub struct Keywords(Settings);

/// Why a keyword was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KeywordError {
    /// There is no such option. Holds the message.
    Unknown(String),
    /// The value is wrong, or other options exclude it. Holds the message.
    Value(String),
}

impl Keywords {
    /// Parses options with their values, such as `("max-samples", Some("64"))`. Switches have no value.
    ///
    /// # Errors
    /// The first option that is unknown or has a wrong value. Messages write names with underscores, as keywords have
    /// them.
    pub fn parse(options: &[(String, Option<String>)]) -> Result<Self, KeywordError> {
        let words = options.iter().map(|(name, value)| match value {
            Some(value) => format!("--{name}={value}"),
            None => format!("--{name}"),
        });
        let mut command = Settings::augment_args(Command::new("render").no_binary_name(true));
        let parsed = command.try_get_matches_from_mut(words);
        parsed
            .and_then(|matches| Settings::from_arg_matches(&matches))
            .map(Self)
            .map_err(|error| refusal(&error))
    }

    /// Number of tracing threads.
    pub fn threads(&self) -> Option<NonZeroUsize> {
        self.0.options.threads
    }

    /// Memory for films that frames share.
    pub fn reuse(&self) -> Reuse {
        self.0.reuse()
    }

    /// Whether the sequence may name files outside of its root.
    pub fn allow_outside(&self) -> bool {
        self.0.options.allow_outside
    }

    /// The sequence with these settings.
    ///
    /// # Errors
    /// As [`overrides::apply`].
    pub fn apply(&self, sequence: Sequence) -> Result<Sequence, String> {
        overrides::apply(sequence, &self.0.overrides())
    }
}

/// The frames of a set in the notation of `--frames`.
///
/// # Errors
/// A text that is no set, and frames that the sequence does not have.
pub fn frames_of(set: &str, sequence: &Sequence) -> Result<Vec<u32>, String> {
    let set: FrameSet = set.parse().map_err(|error| format!("{error}"))?;
    set.frames(sequence.timeline.frames).map_err(|error| error.to_string())
}

/// Why clap refused an option, in terms of its keyword.
fn refusal(error: &clap::Error) -> KeywordError {
    let texts = |kind: ContextKind| match error.get(kind) {
        Some(ContextValue::String(text)) => vec![text.clone()],
        Some(ContextValue::Strings(texts)) => texts.clone(),
        _ => Vec::new(),
    };
    let keywords =
        |kind: ContextKind| -> Vec<String> { texts(kind).iter().map(|text| keyword(text)).collect() };
    let Some(name) = keywords(ContextKind::InvalidArg).into_iter().next() else {
        return KeywordError::Value(error.kind().to_string());
    };
    if let Some(why) = error.source() {
        let value = texts(ContextKind::InvalidValue).concat();
        return KeywordError::Value(format!("{name}={}: {why}", escape::line(&value)));
    }
    if let [other, ..] = &keywords(ContextKind::PriorArg)[..] {
        return KeywordError::Value(format!("{name} cannot be used with {other}"));
    }
    match error.kind() {
        clap::error::ErrorKind::UnknownArgument => {
            let similar = keywords(ContextKind::SuggestedArg);
            let hint = similar.first().map_or_else(String::new, |name| format!("; did you mean {name}?"));
            KeywordError::Unknown(format!("there is no keyword {}{hint}", escape::line(&name)))
        }
        kind => KeywordError::Value(format!("{name}: {kind}")),
    }
}

/// The keyword of an option as clap writes it: `--max-samples <N>`.
fn keyword(option: &str) -> String {
    let name = option.split([' ', '=']).next().unwrap_or_default();
    name.trim_start_matches('-').replace('-', "_")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::fixture::sequence;

    fn parsed(options: &[(&str, Option<&str>)]) -> Result<Keywords, KeywordError> {
        let owned = |(name, value): &(&str, Option<&str>)| (name.to_string(), value.map(str::to_owned));
        Keywords::parse(&options.iter().map(owned).collect::<Vec<_>>())
    }

    #[test]
    fn keywords_are_the_options_of_render() {
        let keywords = parsed(&[
            ("size", Some("32x18")),
            ("samples", Some("7")),
            ("transparent", None),
            ("threads", Some("3")),
            ("no-reuse", None),
            ("exposure", Some("-1.5")),
        ]);
        let keywords = keywords.expect("keywords");
        let found = keywords.apply(sequence()).expect("a sequence");
        assert_eq!((found.output.size, found.quality.samples), ((32, 18), 7));
        assert!(found.output.transparent && found.output.exposure == (-1.5).into());
        assert_eq!((keywords.threads(), keywords.reuse()), (NonZeroUsize::new(3), Reuse::Off));
        assert!(!keywords.allow_outside());
        assert_eq!(parsed(&[]).expect("no keywords").apply(sequence()), Ok(sequence()));
    }

    #[test]
    fn messages_name_keywords() {
        let value = |text: &str| KeywordError::Value(text.to_owned());
        let refused = |options: &[(&str, Option<&str>)]| parsed(options).expect_err("refused");
        assert_eq!(
            refused(&[("max-samples", Some("0"))]),
            value("max_samples=0: write a whole number of samples, 1 to 16777216, such as 256")
        );
        assert_eq!(
            refused(&[("noise", Some("0.1")), ("samples", Some("4"))]),
            value("noise cannot be used with samples")
        );
        let unknown = refused(&[("max-sample", Some("4"))]);
        let expected = "there is no keyword max_sample; did you mean max_samples?";
        assert_eq!(unknown, KeywordError::Unknown(expected.to_owned()));
        let KeywordError::Value(text) = refused(&[("draft", Some("1"))]) else {
            panic!("an error of a value")
        };
        assert!(text.starts_with("draft: "), "{text}");
        let KeywordError::Value(text) = refused(&[("size", None)]) else { panic!("an error of a value") };
        assert!(text.starts_with("size"), "{text}");
    }

    #[test]
    fn sets_of_frames_are_checked() {
        let count = sequence().timeline.frames;
        assert_eq!(frames_of("1,0", &sequence()), Ok(vec![0, 1]));
        let refused = frames_of(&count.to_string(), &sequence()).expect_err("beyond the end");
        assert!(refused.contains(&count.to_string()), "{refused}");
        assert!(frames_of("x", &sequence()).is_err());
    }
}
