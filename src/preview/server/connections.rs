//! The open connections of the server. Their number is limited, and connections without the token are closed first. So slow
//! and silent clients cannot keep the page out.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use tokio::task::AbortHandle;

/// Maximum number of connections at a time. A browser opens six.
const MOST: usize = 32;

/// Open connections, the oldest first.
#[derive(Default)]
pub struct Connections(Vec<Connection>);

struct Connection {
    task: AbortHandle,
    /// Whether it has sent a request with the token.
    is_authorized: Arc<AtomicBool>,
}

impl Connections {
    /// Makes room for one more connection: closes the oldest one without the token if there are too many. Returns false
    /// if all of them have shown the token.
    pub fn make_room(&mut self) -> bool {
        self.0.retain(|connection| !connection.task.is_finished());
        if self.0.len() < MOST {
            return true;
        }
        let oldest = self.0.iter().position(|connection| !connection.is_authorized.load(Relaxed));
        oldest.map(|place| self.0.remove(place).task.abort()).is_some()
    }

    /// Adds a new connection, after [`Connections::make_room`].
    pub fn add(&mut self, task: AbortHandle, is_authorized: Arc<AtomicBool>) {
        self.0.push(Connection { task, is_authorized });
    }
}
