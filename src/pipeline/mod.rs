//! From a sequence to files: the frame loop, the plan, and the library's entry points.
//!
//! In: a `Sequence` and a request.
//! Out: frames, passed to `encode`.
//! Uses all rooms above.

pub mod schedule;
pub mod drawings;
pub mod plan;
pub mod memory;
pub mod render;
pub mod time_limit;
pub mod filmstrip;
pub mod assemble;
pub mod pictures;
