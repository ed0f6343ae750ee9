//! Which file sees which names. Each name is kept once, with the file that defines it.

use std::collections::HashMap;
use std::ops::Range;

/// A set of files, by their indices.
#[derive(Clone, Debug, Default)]
pub struct FileSet(Vec<u64>);

impl FileSet {
    pub fn insert(&mut self, file: usize) {
        if self.0.len() <= file / 64 {
            self.0.resize(file / 64 + 1, 0);
        }
        self.0[file / 64] |= 1 << (file % 64);
    }

    pub fn contains(&self, file: usize) -> bool {
        self.0.get(file / 64).is_some_and(|bits| bits >> (file % 64) & 1 == 1)
    }

    /// Adds the files of another set.
    pub fn add(&mut self, other: &Self) {
        self.0.resize(self.0.len().max(other.0.len()), 0);
        self.0.iter_mut().zip(&other.0).for_each(|(bits, more)| *bits |= more);
    }

    fn meets(&self, other: &Self) -> bool {
        self.0.iter().zip(&other.0).any(|(a, b)| a & b != 0)
    }
}

/// What a file defines under a name.
pub struct Definition<T> {
    pub file: usize,
    /// The place of the name.
    pub place: Range<usize>,
    pub value: T,
}

/// What all files define, by name.
pub struct Definitions<T> {
    /// Nearly always one: two are a fault.
    by_name: HashMap<String, Vec<Definition<T>>>,
    /// The files whose section could not be read. Names that are missing may be theirs.
    unread: FileSet,
}

impl<T> Default for Definitions<T> {
    fn default() -> Self {
        Self { by_name: HashMap::new(), unread: FileSet::default() }
    }
}

impl<T> Definitions<T> {
    /// Adds a definition, instead of one of the same file. Returns the file and the place of the last one by another
    /// file.
    pub fn insert(&mut self, name: String, new: Definition<T>) -> Option<(usize, Range<usize>)> {
        // Most names are defined once, so that a list of one takes little memory.
        let all = self.by_name.entry(name).or_insert_with(|| Vec::with_capacity(1));
        all.retain(|known| known.file != new.file);
        let before = all.last().map(|known| (known.file, known.place.clone()));
        all.push(new);
        before
    }

    /// Notes that the definitions of a file could not be read.
    pub fn miss(&mut self, file: usize) {
        self.unread.insert(file);
    }

    /// The definitions of these files.
    pub fn seen<'d>(&'d self, files: &'d FileSet) -> Seen<'d, T> {
        Seen { definitions: self, files }
    }
}

/// The definitions that a file sees: its own, and those of the files that it includes.
pub struct Seen<'d, T> {
    definitions: &'d Definitions<T>,
    files: &'d FileSet,
}

impl<T> Clone for Seen<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Seen<'_, T> {}

impl<'d, T> Seen<'d, T> {
    pub fn get(&self, name: &str) -> Option<&'d T> {
        let all = self.definitions.by_name.get(name)?;
        all.iter().find(|known| self.files.contains(known.file)).map(|known| &known.value)
    }

    /// All names, in no order.
    pub fn names(&self) -> impl Iterator<Item = &'d str> + use<'d, T> {
        let files = self.files;
        let all = self.definitions.by_name.iter();
        all.filter(|(_, all)| all.iter().any(|known| files.contains(known.file)))
            .map(|(name, _)| name.as_str())
    }

    /// Whether names may be missing, because a section has a fault.
    pub fn is_partial(&self) -> bool {
        self.definitions.unread.meets(self.files)
    }
}

/// Names that a list in a message begins with, and that are compared with a wrong one.
const SORTED: usize = 2000;

/// Sorts as many names as messages need: the first ones.
pub fn sort_first(names: &mut [&str]) {
    if names.len() > SORTED {
        names.select_nth_unstable(SORTED);
        names[..SORTED].sort_unstable();
    } else {
        names.sort_unstable();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_see_the_definitions_of_their_set() {
        let mut all = Definitions::default();
        let definition = |file, value| Definition { file, place: file..file + 1, value };
        assert_eq!(all.insert("a".to_owned(), definition(70, 1)), None);
        assert_eq!(all.insert("b".to_owned(), definition(2, 2)), None);
        assert_eq!(all.insert("a".to_owned(), definition(2, 3)), Some((70, 70..71)));
        let mut files = FileSet::default();
        files.insert(2);
        assert_eq!((all.seen(&files).get("a"), all.seen(&files).get("b")), (Some(&3), Some(&2)));
        let mut other = FileSet::default();
        other.insert(70);
        assert_eq!((all.seen(&other).get("a"), all.seen(&other).get("b")), (Some(&1), None));
        other.add(&files);
        assert!(other.contains(2) && other.contains(70) && !other.contains(71));
        all.miss(70);
        assert!(all.seen(&other).is_partial() && !all.seen(&files).is_partial());
    }

    #[test]
    fn the_first_names_are_sorted() {
        let names: Vec<_> = (0..5000).map(|n| format!("{:04}", (n * 4999) % 5000)).collect();
        let mut some: Vec<_> = names.iter().map(String::as_str).collect();
        sort_first(&mut some);
        assert_eq!(some[..3], ["0000", "0001", "0002"]);
        assert_eq!(some[1999], "1999");
    }
}
