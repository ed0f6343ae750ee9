//! Faults that are found while a sequence is expanded.

use super::super::fault::Fault;
use super::writer::Ledger;
use std::cell::{Cell, RefCell};
use std::collections::HashSet;
use std::ops::Range;

/// The faults so far. A place that is copied reports each of its faults once.
#[derive(Default)]
pub struct Report {
    known: RefCell<HashSet<(Range<usize>, String)>>,
    faults: RefCell<Vec<Fault>>,
    found: Cell<usize>,
}

impl Report {
    /// Adds a fault within a use.
    pub fn push(&self, fault: Fault, ledger: &Ledger, used: u32) {
        self.found.set(self.found.get() + 1);
        if self.known.borrow_mut().insert((fault.span.clone(), fault.title())) {
            let uses = ledger.notes(used);
            self.faults.borrow_mut().push(fault.relocated(|span| span, uses));
        }
    }

    /// Whether the fault with this title has been reported at this place. It is then found again.
    pub fn repeats(&self, place: &Range<usize>, title: String) -> bool {
        let is_known = self.known.borrow().contains(&(place.clone(), title));
        self.found.set(self.found.get() + usize::from(is_known));
        is_known
    }

    /// How often faults were found.
    pub fn found(&self) -> usize {
        self.found.get()
    }

    /// How many different faults were found.
    pub fn len(&self) -> usize {
        self.faults.borrow().len()
    }

    pub fn into_faults(self) -> Vec<Fault> {
        self.faults.into_inner()
    }
}
