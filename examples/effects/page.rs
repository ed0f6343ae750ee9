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
        "# What effects cost\n\n\
        What a scene does not call for takes no work: an effect of zero strength gives the bytes, and takes the rays, of a\n\
        scene without it. What it does call for is priced here, one effect at a time on one scene: a ball on a floor, {} by {}\n\
        pixels with 16 samples each, on one thread. The numbers are ratios to the plain scene in the first row: time of the\n\
        processor, the middle of {ROUNDS} rounds in each of which every scene was traced once; rays of all kinds, and how many\n\
        that are; and instructions of a picture of {} by {} pixels, which count reading the sequence and writing the file as\n\
        well. With `-- --counts`, only rays are told.\n\n\
        `kinora plan FILE` tells which effects a sequence calls for, and who does.\n\n\
        ```sh\ncargo run --release --example effects      # this page and its pictures\n```\n\n\
        | | effect | time | rays | | instructions |\n|---|---|---|---|---|---|\n{rows}\n\
        ## What no effect costs\n\n\
        The same scene with an effect that is written down and has no strength: how many instructions more than without a\n\
        word of it, of the same small picture. What is left is reading the words, and finding that they ask for nothing;\n\
        in the last row, that nothing moves while the shutter is open, at each of its sixteen moments.\n\n\
        | effect | instructions |\n|---|---|\n{nothing}",
        SIZE.0, SIZE.1, SMALL.0, SMALL.1,
    )
}
