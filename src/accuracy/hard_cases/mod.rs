//! The hard-case matrix: the same computation in four ways, each with its error and its price.
//!
//! - **textbook f32, textbook f64**: short and honest versions of what textbooks and usual ray tracers do, with their
//!   epsilon where they have one;
//! - **stable f32**: the stable formula in the precision of graphics cards;
//! - **ours, f64**: the product's own functions.
//!
//! Inputs are rounded to the precision of the way first. What is true of these comes from arithmetic of twice the
//! precision of f64 ([`crate::accuracy::exact`]) or from closed forms, never from what is tried. Errors are the same in
//! every run; times are not.

mod air;
mod cameras;
mod clocks;
mod draw;
mod maps;
mod measure;
pub mod pictures;
pub(super) mod real;
mod samples;
pub(super) mod solids;
pub(super) mod spawning;
pub(super) mod spheres;
mod surfaces;
pub(super) mod tori;
pub(super) mod triangles;

pub use measure::{Answers, Case, Cell, Cells, Effort, Verdict, WAYS, Way, way};

/// All cases, in the order of the table.
pub fn cases(effort: Effort) -> Vec<Case> {
    [
        spheres::cases(effort),
        solids::cases(effort),
        tori::cases(effort),
        triangles::cases(effort),
        spawning::cases(effort),
        surfaces::cases(effort),
        air::cases(effort),
        maps::cases(effort),
        cameras::cases(effort),
        clocks::cases(effort),
        samples::cases(effort),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the table is there to show: ours is never worse than a textbook in f32 by kind, and wrong nowhere.
    #[test]
    fn ours_is_right_in_every_case_and_the_textbooks_are_not() {
        let (mut failing, mut cases_seen) = (0, 0);
        for case in cases(Effort::QUICK) {
            let [textbook, .., ours] = case.ways.each_ref().map(|way| way.as_ref().map(|way| way.answers()));
            let (textbook, ours) = (textbook.expect("a textbook"), ours.expect("ours"));
            assert_eq!(ours.wrong, 0.0, "{}: {}", case.id, case.what);
            assert!(
                ours.worst <= textbook.worst || textbook.wrong > 0.0,
                "{}: {ours:?} {textbook:?}",
                case.what
            );
            failing += u32::from(textbook.wrong > 0.0);
            cases_seen += 1;
        }
        assert!(failing >= 15 && cases_seen >= 30, "{failing} of {cases_seen}");
    }
}
