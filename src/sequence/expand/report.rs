//! Faults that are found while a sequence is expanded.

use super::super::fault::Fault;
use super::writer::Ledger;
use std::cell::RefCell;
use std::collections::HashSet;
use std::ops::Range;

/// The faults so far. A place that is copied reports each of its faults once.
#[derive(Default)]
pub struct Report {
    known: RefCell<HashSet<(Range<usize>, String)>>,
    faults: RefCell<Vec<Fault>>,
}

impl Report {
    /// Adds a fault within a use.
    pub fn push(&self, fault: Fault, ledger: &Ledger, used: u32) {
        if self.known.borrow_mut().insert((fault.span.clone(), fault.title())) {
            let uses = ledger.notes(used);
            self.faults.borrow_mut().push(fault.relocated(|span| span, uses));
        }
    }

    pub fn into_faults(self) -> Vec<Fault> {
        self.faults.into_inner()
    }
}
