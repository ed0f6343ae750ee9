//! The unit in which a file gives the times of keys.

use crate::base::time::Rate;

/// The unit of key times.
#[derive(Clone, Copy, Debug, Default)]
pub enum KeyClock {
    #[default]
    Seconds,
    /// Frame numbers at this rate.
    Frames(Rate),
}
