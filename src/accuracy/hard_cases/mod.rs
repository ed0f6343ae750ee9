//! The matrix of hard cases: the same computation by four methods, each with its error and its time.
//!
//! - **textbook f32, textbook f64**: the formulas of textbooks and of most ray tracers, with their usual epsilons;
//! - **stable f32**: a numerically stable formula in the precision of graphics cards;
//! - **ours, f64**: Kinora's own functions.
//!
//! Inputs are first rounded to the precision of the method. The true answers for the rounded inputs come from
//! double-double arithmetic ([`crate::base::math::exact`]) or from closed forms, never from the code under test. Errors
//! are the same in every run; times are not.

mod cameras;
mod clocks;
mod fog;
mod input_rng;
mod maps;
mod measure;
pub(super) mod number;
pub mod pictures;
mod samples;
pub(super) mod solids;
pub(super) mod spawning;
pub(super) mod spheres;
mod surfaces;
pub(super) mod tori;
pub(super) mod triangles;

pub use measure::{Answers, Case, Cell, Cells, METHODS, Method, Verdict, Workload, method};

/// All cases, in the order of the table.
pub fn cases(workload: Workload) -> Vec<Case> {
    [
        spheres::cases(workload),
        solids::cases(workload),
        tori::cases(workload),
        triangles::cases(workload),
        spawning::cases(workload),
        surfaces::cases(workload),
        fog::cases(workload),
        maps::cases(workload),
        cameras::cases(workload),
        clocks::cases(workload),
        samples::cases(workload),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Kinora's answers are never wrong, and their errors are never larger than those of the textbook in f32 unless
    /// that is wrong.
    #[test]
    fn ours_is_right_in_every_case_and_the_textbooks_are_not() {
        let (mut failing, mut cases_seen) = (0, 0);
        for case in cases(Workload::QUICK) {
            let [textbook, .., ours] =
                case.methods.each_ref().map(|way| way.as_ref().map(|way| way.answers()));
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
