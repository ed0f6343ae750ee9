//! The connections of the server: only so many, and those that never showed the token make room for others. So slow and
//! silent clients cannot keep the page out.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use tokio::task::AbortHandle;

/// Most connections at a time. A browser opens six.
const MOST_CONNECTIONS: usize = 32;

/// Open connections, the oldest first.
#[derive(Default)]
pub struct Guests(Vec<Guest>);

struct Guest {
    connection: AbortHandle,
    /// Whether it has sent a request with the token.
    is_known: Arc<AtomicBool>,
}

impl Guests {
    /// Makes room for one more connection: closes the oldest of those without the token if there are too many. Returns
    /// false if all of them have shown it.
    pub fn make_room(&mut self) -> bool {
        self.0.retain(|guest| !guest.connection.is_finished());
        if self.0.len() < MOST_CONNECTIONS {
            return true;
        }
        let stranger = self.0.iter().position(|guest| !guest.is_known.load(Relaxed));
        stranger.map(|place| self.0.remove(place).connection.abort()).is_some()
    }

    /// Notes a new connection, for which there is room.
    pub fn add(&mut self, connection: AbortHandle, is_known: Arc<AtomicBool>) {
        self.0.push(Guest { connection, is_known });
    }
}
