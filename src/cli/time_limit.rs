//! `--time-limit`: settles how many samples there are before anything is rendered, and says so.

use super::failure::Failure;
use super::{terminal, values};
use crate::accuracy::{Budget, Clock, Settled, percent, seconds, settled};
use crate::pipeline::render::Request;
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;
use clap::Args;
use std::time::Duration;

/// The option.
#[derive(Args, Debug, PartialEq)]
pub struct TimeLimit {
    /// How long tracing may take, such as 60s or 10min: as many samples as fit
    ///
    /// A pilot of a few blocks of pixels finds out; all frames then have the same number of
    /// samples, which is told. The same again on any machine: --samples with that number.
    /// With --noise, the error or the time ends the run, whichever comes first.
    #[arg(
        long, value_name = "TIME", value_parser = values::duration, allow_hyphen_values = true,
        conflicts_with_all = ["samples", "max_samples", "draft"], verbatim_doc_comment
    )]
    pub time_limit: Option<Duration>,
}

/// Gives the sequence the samples that fit into the limit of time, if there is one, and says which.
pub fn settle(sequence: &mut Sequence, request: &Request, quiet: bool) -> Result<Option<String>, Failure> {
    let Some(limit) = request.time_limit else { return Ok(None) };
    let settled = settled(sequence, request, limit, Clock::Machine)?;
    sequence.quality = settled.quality();
    let note = match &settled {
        Settled::Now(budget) => budget_note(budget),
        Settled::Before(quality) => kept_note(quality),
    };
    if !quiet {
        terminal::complain(&note);
    }
    Ok(Some(note))
}

/// Says that frames that are there have settled it.
fn kept_note(quality: &Quality) -> String {
    format!(
        "an earlier run with this limit has settled on {} samples a pixel{}, and a grid of {2}x{2} where nothing is \
         random: its frames are kept, and the others get as many; --overwrite settles anew",
        quality.samples,
        if quality.noise.is_some() { " at most" } else { "" },
        quality.antialias
    )
}

/// Says what fits into the time, what to expect of it, and how to have the same again.
fn budget_note(budget: &Budget) -> String {
    let quality = budget.quality;
    let (samples, flag) = match (&quality.noise, budget.error) {
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
    let mut note = format!("into the time fit {samples}: tracing should take {}", seconds(budget.wall));
    if let Some(cpu) = budget.cpu {
        note += &format!(" ({} of processors)", seconds(cpu));
    }
    if let Some(error) = budget.error {
        note += &format!(", and leave an error of about {} of the brightness", percent(error));
    }
    note + &format!("; the same again: {flag}")
}
