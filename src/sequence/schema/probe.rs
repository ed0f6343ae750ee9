//! Documents with a place for one value, and what decoders ask of the values that are put there.

use super::{Ask, Watch};
use crate::base::files::Root;
use crate::sequence::document;
use crate::sequence::source_file::File;
use crate::sequence::syntax;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::LazyLock;

/// Values of all forms. Decoders look at the form of a value before they ask for more, so each of these gets to other
/// questions. One of the texts looks like a word, which it may stand for.
const FORMS: [&str; 15] = [
    "1",
    "true",
    "\"probe\"",
    "\"#\"",
    "{}",
    "{\"probe\": 1}",
    "{\"Probe\": {}}",
    "{\"Probe\": [1]}",
    "[1]",
    "[1, 1]",
    "[1, 1, 1]",
    "[1, 1, 1, 1]",
    "[[1, 1]]",
    "[\"probe\"]",
    "[{}]",
];

/// A folder without files: what files hold must not change the schema.
const FOLDER: &str = "kinora-schema";

static ROOT: LazyLock<Root> = LazyLock::new(|| Root::of(Path::new(FOLDER)));

/// A place for a value in a document: the text around it. Without any text it is the document.
#[derive(Default)]
pub struct Place {
    before: String,
    after: String,
}

impl Place {
    /// The place within a value at this place, with the text around it.
    pub fn within(&self, before: &str, after: &str) -> Self {
        Self { before: format!("{}{before}", self.before), after: format!("{after}{}", self.after) }
    }

    /// What decoders ask of a value at this place.
    pub fn asked(&self, value: &str) -> BTreeSet<Ask> {
        let text = format!("{}{value}{}", self.before, self.after);
        let (is_common, _) = syntax::checked(&text);
        let mut file = File::new(&text, Path::new(FOLDER), ROOT.clone(), is_common);
        file.is_json = true;
        file.watch = Some(Watch::at(self.before.len()));
        document::sequence(file.root(), FOLDER);
        file.watch.map(Watch::into_asked).unwrap_or_default()
    }

    /// What decoders ask of values of all forms at this place, with `before` and `after` around each of them.
    pub fn asked_of_forms(&self, before: &str, after: &str) -> BTreeSet<Ask> {
        FORMS.par_iter().flat_map_iter(|form| self.asked(&format!("{before}{form}{after}"))).collect()
    }
}
