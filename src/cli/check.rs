//! `kinora check`: finds every mistake that `render` would find, without rendering.

use super::failure::Failure;
use super::sequence_file::SequenceFile;
use super::terminal;
use crate::base::escape;
use crate::base::units::counted;
use crate::encode::Existing;
use crate::pipeline::render::{self, Request, Reuse};
use crate::sequence::Sequence;
use clap::Args;

/// Find every mistake in a sequence file; render and write nothing.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = "\
Example:
  kinora check sequences/hello.ron
Kinora prints one line about the sequence, or every mistake with its line (exit code 2).")]
pub struct Arguments {
    #[command(flatten)]
    sequence: SequenceFile,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let sequence = arguments.sequence.load()?;
    render::check(&sequence, &request(&sequence))?;
    terminal::print_line(&line(&sequence))?;
    let note = |note: &String| terminal::print_line(&format!("note: {}", escape::line(note)));
    sequence.notes().iter().try_for_each(note)
}

/// The request of `kinora render` without options.
pub(super) fn request(sequence: &Sequence) -> Request {
    Request {
        outputs: sequence.output.files.clone(),
        confined: true,
        existing: Existing::Keep,
        frames: (0..sequence.timeline.frames).collect(),
        threads: None,
        reuse: Reuse::Share,
        time_limit: None,
    }
}

/// An overview of the sequence in one line.
fn line(sequence: &Sequence) -> String {
    let timeline = &sequence.timeline;
    let (width, height) = sequence.output.size;
    let number = |count: usize, noun| counted(count as u64, noun);
    let facts = [
        number(timeline.frames as usize, "frame"),
        format!("{} s at {} fps", decimal(timeline.duration), decimal(timeline.rate.per_second())),
        format!("{width}x{height}"),
        objects(sequence),
        number(sequence.lights.len(), "light"),
        number(sequence.materials.len(), "material"),
        number(sequence.cameras.len(), "camera"),
        sequence.output.files.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
    ];
    format!("{}: {}", escape::line(&sequence.name), facts.join(" · "))
}

/// The number of objects, and of the triangles in their meshes.
fn objects(sequence: &Sequence) -> String {
    let objects = counted(sequence.objects.len() as u64, "object");
    match sequence.meshes().iter().map(|(_, mesh)| mesh.triangles().len() as u64).sum() {
        0 => objects,
        triangles => format!("{objects} with {}", counted(triangles, "triangle")),
    }
}

/// A number with at most three decimals, without trailing zeros.
pub(super) fn decimal(number: crate::base::time::Time) -> String {
    let value = *number.numer() as f64 / *number.denom() as f64;
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::time::Rate;
    use crate::cli::fixture::sequence;

    #[test]
    fn the_overview_is_one_line() {
        assert_eq!(
            line(&sequence()),
            "nothing: 72 frames · 3 s at 24 fps · 641x361 · 0 objects · 1 light · 0 materials · 1 camera · \
             output/nothing_####.png, output/nothing.gif"
        );
    }

    #[test]
    fn rates_are_decimal() {
        let rate = Rate::new(30000, 1001).map(|rate| decimal(rate.per_second()));
        assert_eq!(rate.as_deref(), Some("29.97"));
    }
}
