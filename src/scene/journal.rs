//! The slots of a geometry that were rewritten, for readers that follow it at their own pace.

/// A list of slots that only grows at its end, until its beginning is forgotten.
#[derive(Clone, Debug, Default)]
pub struct Journal {
    /// Number of entries that were forgotten.
    forgotten: u64,
    slots: Vec<u32>,
}

impl Journal {
    pub fn note(&mut self, slot: u32) {
        self.slots.push(slot);
    }

    /// The number of entries that were ever made. It names the state behind the last one.
    pub fn revision(&self) -> u64 {
        self.forgotten + self.slots.len() as u64
    }

    /// The entries since a revision. None if some of them were forgotten.
    pub fn since(&self, revision: u64) -> Option<&[u32]> {
        let first = revision.checked_sub(self.forgotten)?;
        self.slots.get(first as usize..)
    }

    /// Forgets all entries if there are more than `most`.
    pub fn forget(&mut self, most: usize) {
        if self.slots.len() > most {
            self.forgotten = self.revision();
            self.slots.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readers_get_what_they_have_not_seen() {
        let mut journal = Journal::default();
        let start = journal.revision();
        (0..5).for_each(|slot| journal.note(slot));
        assert_eq!(journal.since(start), Some(&[0, 1, 2, 3, 4][..]));
        assert_eq!(journal.since(3), Some(&[3, 4][..]));
        journal.forget(5);
        assert_eq!(journal.since(start).map(<[u32]>::len), Some(5));
        let seen = journal.revision();
        journal.forget(4);
        assert_eq!((journal.since(start), journal.since(seen)), (None, Some(&[][..])));
        journal.note(9);
        assert_eq!((journal.since(seen), journal.since(4), journal.revision()), (Some(&[9][..]), None, 6));
    }
}
