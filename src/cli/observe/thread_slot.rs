//! Numbers and names of threads in records.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::thread;

/// A number for a thread. When the thread ends, the next thread of the same name takes its number: the encoder starts a
/// thread for each file, and a timeline with a row for each would be unreadable.
struct ThreadSlot {
    number: u64,
    name: String,
}

/// Numbers that no thread has at present, by name, and how many there are in all.
static FREE: Mutex<(BTreeMap<String, Vec<u64>>, u64)> = Mutex::new((BTreeMap::new(), 0));

thread_local! {
    static SLOT: RefCell<Option<ThreadSlot>> = const { RefCell::new(None) };
}

impl ThreadSlot {
    fn take() -> Self {
        let name = thread::current().name().unwrap_or("worker").to_owned();
        let mut free = FREE.lock().unwrap_or_else(PoisonError::into_inner);
        let number = match free.0.get_mut(&name).and_then(Vec::pop) {
            Some(number) => number,
            None => {
                free.1 += 1;
                free.1
            }
        };
        Self { number, name }
    }
}

impl Drop for ThreadSlot {
    fn drop(&mut self) {
        let mut free = FREE.lock().unwrap_or_else(PoisonError::into_inner);
        free.0.entry(std::mem::take(&mut self.name)).or_default().push(self.number);
    }
}

/// The number and the name of this thread. Nothing while the thread ends.
pub fn current() -> (u64, String) {
    let slot = SLOT.try_with(|slot| {
        let mut slot = slot.borrow_mut();
        let slot = slot.get_or_insert_with(ThreadSlot::take);
        (slot.number, slot.name.clone())
    });
    slot.unwrap_or_default()
}
