//! From a sequence to files: the frame loop, the plan of what is traced, and the front door.
//!
//! In: a `Sequence` and a request. Out: frames, handed to `encode`. Uses all rooms above.

pub mod schedule;
pub mod plan;
pub mod memory;
pub mod render;
pub mod filmstrip;
pub mod assemble;
