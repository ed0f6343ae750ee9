//! Whether a file of an earlier run can be kept.

/// The state of a file that an earlier run may have written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FileState {
    /// It is complete, and this run would write the same bytes.
    Current,
    /// Only its annotations differ, and it holds the picture without them.
    Redrawable,
    /// It has the right identity but no digest of its bytes, because an earlier version wrote it. So its pixels cannot
    /// be verified.
    NoDigest,
    /// It is missing or damaged, or this run would write other bytes.
    Stale,
}
