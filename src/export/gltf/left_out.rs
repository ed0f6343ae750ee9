//! What a glTF file cannot hold, or holds approximately.

use crate::base::units::counted;
use std::collections::BTreeMap;

/// Features with the number of their users.
#[derive(Default)]
pub struct LeftOut(BTreeMap<(&'static str, &'static str), u64>);

impl LeftOut {
    /// Notes a feature of the whole sequence.
    pub fn note(&mut self, what: &'static str) {
        self.0.entry((what, "")).or_default();
    }

    /// Notes one more user of a feature: a "light" or an "object".
    pub fn note_of(&mut self, what: &'static str, user: &'static str) {
        *self.0.entry((what, user)).or_default() += 1;
    }

    /// All notes, such as "the attenuation of 2 lights".
    pub fn listed(self) -> Vec<String> {
        let text = |((what, user), count): ((&str, &str), u64)| match user {
            "" => what.to_owned(),
            user => format!("{what} of {}", counted(count, user)),
        };
        self.0.into_iter().map(text).collect()
    }
}
