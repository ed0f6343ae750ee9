//! Lines in groups, each with a heading in front.

use crate::base::escape;

/// A heading, and the lines beside and below it.
pub type Group = (&'static str, Vec<String>);

/// The text of the groups. Those without lines are left out.
pub fn text(groups: &[Group]) -> String {
    let mut text = String::new();
    for (heading, lines) in groups {
        for (place, line) in lines.iter().enumerate() {
            let heading = if place == 0 { heading } else { "" };
            text += &format!("{heading:<7} {}\n", escape::line(line));
        }
    }
    text.truncate(text.trim_end().len());
    text
}
