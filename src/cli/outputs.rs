//! Where a run writes when the command line does not say it all: never over the sequence's finished film.

use crate::encode::Output;

/// What decides about the outputs of a run.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// The sequence's own files.
    pub own: &'a [Output],
    /// Those of the command line; they go before all else.
    pub wanted: &'a [Output],
    pub draft: bool,
    /// Whether some frames of the sequence are left out.
    pub partial: bool,
}

impl Run<'_> {
    /// The outputs, and what to tell about them.
    ///
    /// A draft's files are marked as such. A part of the frames writes its stills where they belong, but no
    /// animation in the place of the whole one.
    pub fn outputs(self) -> (Vec<Output>, Option<String>) {
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
        let left_out = self.own.iter().find(|output| output.is_animation());
        let note = |output| {
            format!("{output} holds all frames and is left as it is; name an animation of these with -o")
        };
        (stills, left_out.map(note))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::fixture::output;

    fn names(own: &[&str], wanted: &[&str], draft: bool, partial: bool) -> Vec<String> {
        let parsed = |names: &[&str]| names.iter().map(|name| output(name)).collect::<Vec<_>>();
        let (own, wanted) = (parsed(own), parsed(wanted));
        let run = Run { own: &own, wanted: &wanted, draft, partial };
        run.outputs().0.iter().map(ToString::to_string).collect()
    }

    const OWN: [&str; 2] = ["o/t/f_##.png", "o/t.gif"];

    #[test]
    fn the_whole_goes_where_the_sequence_says() {
        assert_eq!(names(&OWN, &[], false, false), OWN);
        assert_eq!(names(&OWN, &["x.gif"], true, true), ["x.gif"]);
    }

    #[test]
    fn drafts_are_marked() {
        assert_eq!(names(&OWN, &[], true, false), ["o/t/draft_f_##.png", "o/draft_t.gif"]);
    }

    #[test]
    fn a_part_leaves_the_film_alone() {
        assert_eq!(names(&OWN, &[], false, true), ["o/t/f_##.png"]);
        assert_eq!(names(&["t.gif"], &[], false, true), ["part_t.gif"]);
        assert_eq!(names(&["t.gif"], &[], true, true), ["part_draft_t.gif"]);
    }
}
