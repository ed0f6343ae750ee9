//! `--time-limit`: chooses the number of samples before anything is rendered, and reports it.

use super::failure::Failure;
use super::{terminal, values};
use crate::base::clock::TimeSource;
use crate::base::units::{percent, seconds};
use crate::pipeline::render::Request;
use crate::pipeline::time_limit::{Budget, Settled, settled};
use crate::sequence::Sequence;
use crate::sequence::quality::{Denoise, Quality};
use clap::Args;
use std::time::Duration;

#[derive(Args, Debug, PartialEq)]
pub struct TimeLimitOption {
    /// Maximum time for tracing, such as 60s or 10min; takes as many samples as fit
    ///
    /// A pilot traces a few patches of pixels to choose the number of samples. All frames get the
    /// same number, which is printed. --samples with that number gives the same pictures on any
    /// machine. With --noise, the run ends at the target error or at the time limit.
    #[arg(
        long, value_name = "TIME", value_parser = values::duration, allow_hyphen_values = true,
        conflicts_with_all = ["samples", "max_samples", "draft"], verbatim_doc_comment
    )]
    pub time_limit: Option<Duration>,
}

/// Sets the quality of the sequence to what fits into the time limit. Returns a note that names it, or None without a
/// limit.
pub fn apply(sequence: &mut Sequence, request: &Request, quiet: bool) -> Result<Option<String>, Failure> {
    let Some(limit) = request.time_limit else { return Ok(None) };
    let settled = settled(sequence, request, limit, TimeSource::Machine)?;
    sequence.quality = settled.quality();
    let note = match &settled {
        Settled::Now(budget) => budget_note(budget),
        Settled::Before(quality) => earlier_note(quality),
    };
    if !quiet {
        terminal::eprint_line(&note);
    }
    Ok(Some(note))
}

/// The note if existing frames determine the number of samples.
fn earlier_note(quality: &Quality) -> String {
    format!(
        "an earlier run with this time limit used {} samples a pixel{}, and a grid of {2}x{2} where nothing is random: \
         its frames are kept, and the others get as many samples; --overwrite chooses again",
        quality.samples,
        if quality.noise.is_some() { " at most" } else { "" },
        quality.antialias
    )
}

/// The note if a pilot has chosen: the samples, the expected time and error, and the option that gives the same
/// pictures.
fn budget_note(budget: &Budget) -> String {
    let quality = budget.quality;
    let (samples, option) = match (&quality.noise, budget.error) {
        (Some(target), Some(_)) if budget.reached => {
            (format!("the error of {}", percent(target.error)), format!("--noise {}", target.error))
        }
        (Some(target), Some(_)) => (
            format!("{} samples a pixel at most", target.most),
            format!("--noise {} --max-samples {}", target.error, target.most),
        ),
        (None, Some(_)) => {
            (format!("{} samples a pixel", quality.samples), format!("--samples {}", quality.samples))
        }
        (_, None) => {
            (format!("a grid of {0}x{0}", quality.antialias), format!("--antialias {}", quality.antialias))
        }
    };
    let mut note = format!("the time limit allows {samples}: tracing should take {}", seconds(budget.wall));
    if let Some(cpu) = budget.cpu {
        note += &format!(" ({} of processor time)", seconds(cpu));
    }
    if let Some(error) = budget.error {
        note += &format!(", and leave an error of about {} of the brightness", percent(error));
    }
    let denoise = match quality.denoise {
        Denoise::Off => "",
        Denoise::Auto => " --denoise",
        Denoise::Alone => " --denoise=alone",
    };
    note + &format!("; for the same pictures again: {option}{denoise}")
}
