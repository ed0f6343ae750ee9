//! The foundation of all rooms: numbers, lanes, colours, times, digests, files and the machine.
//!
//! In: nothing.
//! Out: values and small services that know nothing of scenes.
//! May use: no other room.

pub mod digest;
pub mod time;
pub mod lanes;
pub mod math;
pub mod color;
pub mod stats;
pub mod units;
pub mod escape;
pub mod lists;
pub mod cancel;
pub mod frame_set;
pub mod machine;
pub mod clock;
pub mod process;
pub mod files;
