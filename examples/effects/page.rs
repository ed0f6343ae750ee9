//! The page of prices.

use super::cases::Case;
use super::{ROUNDS, SIZE, SMALL};
use std::fmt::Write as _;

/// What an effect takes.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    pub case: &'static Case,
    pub rays: u64,
    /// Of one processor, if it was measured.
    pub seconds: Option<f64>,
    /// Of a small picture, if there is valgrind.
    pub instructions: Option<u64>,
}

impl Found {
    fn row(&self, plain: &Self) -> String {
        let Case { name, about, .. } = self.case;
        let time = self.seconds.zip(plain.seconds).map_or(String::new(), |(a, b)| format!("{:.2}", a / b));
        let instructions = self.instructions.zip(plain.instructions);
        let instructions = instructions.map_or(String::new(), |(a, b)| format!("{:.2}", ratio(a, b)));
        let (rays, share) = (self.rays, ratio(self.rays, plain.rays));
        format!(
            "| ![{name}](images/effects/{name}.png) | {about} | {time} | {share:.2} | {rays} | {instructions} |\n"
        )
    }
}

fn ratio(ours: u64, theirs: u64) -> f64 {
    ours as f64 / theirs as f64
}

/// The page, of what was found of each effect, the plain scene first; and of those of no strength the instructions.
pub fn page(found: &[Found], idle: &[(&Case, Option<u64>)]) -> String {
    let Some(plain) = found.first() else { return String::new() };
    let rows: String = found.iter().map(|found| found.row(plain)).collect();
    let mut nothing = String::new();
    for (case, instructions) in idle {
        let more = instructions.zip(plain.instructions).map(|(a, b)| 100.0 * (ratio(a, b) - 1.0));
        let more = more.map_or(String::new(), |more| format!("{more:+.2} %"));
        // Writing to a string cannot fail.
        _ = writeln!(nothing, "| {} | {more} |", case.about);
    }
    format!(
        "# Cost of effects\n\n\
        An effect of zero strength gives the bytes, and takes the rays, of a scene without it; [Cost of unused\n\
        effects](#cost-of-unused-effects) counts what remains. This page prices effects that are in use, one at a time on one\n\
        scene: a ball on a floor, {} by {} pixels with 16 samples each, on one thread. The numbers are ratios to the plain\n\
        scene in the first row: processor time, as the median of {ROUNDS} rounds that each trace every scene once; rays of all kinds,\n\
        with their number; and instructions of a picture of {} by {} pixels, including reading the sequence and writing the\n\
        file. With `-- --counts`, the page has only rays.\n\n\
        `kinora plan FILE` lists the effects of a sequence, and what causes each.\n\n\
        ```sh\n\
        cargo run --release --example effects      # writes this page and its pictures\n\
        ```\n\n| | effect | time | rays | number of rays | instructions |\n|---|---|---|---|---|---|\n{rows}\n\
        ## Cost of unused effects\n\n\
        The same small picture with an effect of zero strength: how many more instructions it takes than the plain scene. The\n\
        rest is the work of reading the effect's fields and finding that they have no effect; in the last row, of finding at\n\
        each of sixteen moments that nothing moves while the shutter is open.\n\n| effect | instructions |\n|---|---|\n{nothing}",
        SIZE.0, SIZE.1, SMALL.0, SMALL.1,
    )
}
