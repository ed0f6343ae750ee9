//! The files of a run. A draft or a part of the frames never replaces a finished animation.

use crate::encode::Output;

/// Everything that determines the files of a run.
#[derive(Clone, Copy, Debug)]
pub struct OutputChoice<'a> {
    /// The files that the sequence names.
    pub own: &'a [Output],
    /// The files of the command line. If there are any, they replace the others.
    pub wanted: &'a [Output],
    pub draft: bool,
    /// Whether the run omits some frames of the sequence.
    pub partial: bool,
}

impl OutputChoice<'_> {
    /// The files, and a note for the user.
    ///
    /// The names of a draft's files start with `draft_`. A part of the frames is written to the usual stills. If there
    /// are only animations, their names start with `part_`.
    pub fn resolve(self) -> (Vec<Output>, Option<String>) {
        if !self.wanted.is_empty() {
            return (self.wanted.to_vec(), None);
        }
        let prefix = if self.draft { "draft_" } else { "" };
        let named = |output: &Output| if self.draft { output.prefixed(prefix) } else { output.clone() };
        if !self.partial {
            return (self.own.iter().map(named).collect(), None);
        }
        let stills: Vec<_> = self.own.iter().filter(|output| !output.is_animation()).map(named).collect();
        if stills.is_empty() {
            let part = |output: &Output| named(output).prefixed("part_");
            return (self.own.iter().map(part).collect(), None);
        }
        let skipped = self.own.iter().find(|output| output.is_animation());
        let note = |output| {
            format!(
                "{output} holds all frames and is left as it is; for an animation of these frames, add -o"
            )
        };
        (stills, skipped.map(note))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::fixture::output;

    fn names(own: &[&str], wanted: &[&str], draft: bool, partial: bool) -> Vec<String> {
        let parsed = |names: &[&str]| names.iter().map(|name| output(name)).collect::<Vec<_>>();
        let (own, wanted) = (parsed(own), parsed(wanted));
        let choice = OutputChoice { own: &own, wanted: &wanted, draft, partial };
        choice.resolve().0.iter().map(ToString::to_string).collect()
    }

    const OWN: [&str; 2] = ["o/t/f_##.png", "o/t.gif"];

    #[test]
    fn all_frames_go_into_the_files_of_the_sequence() {
        assert_eq!(names(&OWN, &[], false, false), OWN);
        assert_eq!(names(&OWN, &["x.gif"], true, true), ["x.gif"]);
    }

    #[test]
    fn drafts_are_marked() {
        assert_eq!(names(&OWN, &[], true, false), ["o/t/draft_f_##.png", "o/draft_t.gif"]);
    }

    #[test]
    fn a_part_leaves_the_animation_alone() {
        assert_eq!(names(&OWN, &[], false, true), ["o/t/f_##.png"]);
        assert_eq!(names(&["t.gif"], &[], false, true), ["part_t.gif"]);
        assert_eq!(names(&["t.gif"], &[], true, true), ["part_draft_t.gif"]);
    }
}
